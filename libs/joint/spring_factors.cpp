#include "joint/spring_factors.hpp"

namespace jointcreep::joint
{

void multiply(EquivalentJoints& joints, const Scaled& scaled, double factor)
{
    // Lists have one or several values for each edge.
    const std::size_t edges = joints.normal_stiffness.size();
    const auto multiply_list = [&](int direction, std::vector<double>& list) {
        const std::size_t each = edges > 0 ? list.size() / edges : 0;
        for (std::size_t i = 0; i < each * edges; ++i)
            if (scaled.is_of(direction, joints.material.empty() ? 0 : joints.material[i / each]))
                list[i] *= factor;
    };
    const bool all = scaled.quantity == Scaled::joint_stiffness;
    if (all) {
        multiply_list(0, joints.normal_stiffness);
        multiply_list(1, joints.shear_stiffness);
    }
    if (all || scaled.quantity == Scaled::kelvin_stiffness) {
        multiply_list(0, joints.normal_kelvin_stiffness);
        multiply_list(1, joints.shear_kelvin_stiffness);
    }
    if (all || scaled.quantity == Scaled::kelvin_viscosity) {
        multiply_list(0, joints.normal_kelvin_viscosity);
        multiply_list(1, joints.shear_kelvin_viscosity);
        multiply_list(0, joints.normal_maxwell_viscosity);
        multiply_list(1, joints.shear_maxwell_viscosity);
    }
}

} // namespace jointcreep::joint
