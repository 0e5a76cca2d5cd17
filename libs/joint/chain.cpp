#include "joint/chain.hpp"

#include "joint/bridged.hpp"

namespace jointcreep::joint
{

Chain chain_of(const EquivalentJoints& joints, std::size_t edge, int direction)
{
    const bool normal = direction == 0;
    const auto& stiffness = normal ? joints.normal_kelvin_stiffness : joints.shear_kelvin_stiffness;
    const auto& viscosity = normal ? joints.normal_kelvin_viscosity : joints.shear_kelvin_viscosity;
    Chain chain{normal ? joints.normal_stiffness[edge] : joints.shear_stiffness[edge], {}};
    chain.constants = direction + (joints.material.empty() ? 0 : 2 * static_cast<int>(joints.material[edge]));
    const std::size_t units = joints.kelvin_units();
    for (std::size_t unit = edge * units; unit < (edge + 1) * units; ++unit)
        if (stiffness[unit] > 0)
            chain.units.push_back({stiffness[unit], viscosity[unit]});
    const double maxwell =
        normal ? joints.normal_maxwell_viscosity[edge] : joints.shear_maxwell_viscosity[edge];
    if (maxwell > 0)
        chain.units.push_back({0, maxwell});
    return chain;
}

Chain chain_of(const JointMaterial& material, Index number, int direction)
{
    const JointChain joint = joint_chain_of(material, direction == 0 ? Direction::normal : Direction::shear);
    Chain chain{joint.spring, joint.units, direction + 2 * static_cast<int>(number)};
    if (joint.maxwell_viscosity > 0)
        chain.units.push_back({0, joint.maxwell_viscosity});
    return chain;
}

} // namespace jointcreep::joint
