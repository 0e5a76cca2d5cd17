#include "joint/equivalent.hpp"

#include "model/error.hpp"

#include <algorithm>
#include <cmath>

namespace jointcreep
{

namespace
{

// An edge's joint fraction is a sum of lengths over a length: closer to 1 it is 1.
constexpr double rounding = 1e-9;

template <class Named>
const Named& by_name(const std::vector<Named>& all, const std::string& name, const std::string& kind)
{
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const Named& one) { return one.name == name; });
    if (found == all.end())
        throw input_error("there is no " + kind + " \"" + name + "\" in the scene");
    return *found;
}

Strength strength_of(const JointMaterial& material)
{
    return {material.cohesion, material.friction_angle, material.tensile_strength};
}

Strength weaker(const Strength& one, const Strength& other)
{
    return {std::min(one.cohesion, other.cohesion), std::min(one.friction_angle, other.friction_angle),
            std::min(one.tensile_strength, other.tensile_strength)};
}

std::string place_of(const Blocks& blocks, std::size_t edge)
{
    const Eigen::Vector2d &from = blocks.vertex[blocks.edge_vertex[edge][0]],
                          &to = blocks.vertex[blocks.edge_vertex[edge][1]];
    return "edge " + std::to_string(edge) + " from [" + shown(from.x()) + ", " + shown(from.y()) + "] to [" +
           shown(to.x()) + ", " + shown(to.y()) + "] m";
}

std::string set_name(const Network& network, std::size_t edge)
{
    return network.names.joint_set[network.joints.set[network.blocks.edge_joint[edge]]];
}

Strength bridge_strength(const Scene& scene, const Network& network, std::size_t edge)
{
    std::optional<Strength> weakest;
    for (const Index block : network.blocks.edge_block[edge]) {
        if (block < 0)
            continue;
        const Rock& rock = by_name(scene.rocks, network.names.rock[network.blocks.block_rock[block]], "rock");
        if (!rock.strength)
            throw input_error(
                "rock \"" + rock.name + "\" has no strength, but joint set \"" + set_name(network, edge) +
                "\" leaves bridges of it: " + shown(1 - network.blocks.edge_joint_fraction[edge]) + " of " +
                place_of(network.blocks, edge) +
                "; it needs a cohesion, a friction angle and a tensile strength");
        const Strength strength{rock.strength->cohesion, rock.strength->friction_angle,
                                rock.strength->tensile_strength};
        weakest = weakest ? weaker(*weakest, strength) : strength;
    }
    if (!weakest)
        throw input_error(place_of(network.blocks, edge) + " is a joint but has no block on either side");
    return *weakest;
}

Strength edge_strength(const Scene& scene, const Network& network, std::size_t edge,
                       const JointMaterial& material)
{
    const double fraction = network.blocks.edge_joint_fraction[edge];
    if (!(fraction >= 0 && fraction <= 1 + rounding))
        throw input_error("edge_joint_fraction is " + shown(fraction) + " on " +
                          place_of(network.blocks, edge) + "; it must be from 0 to 1");
    if (fraction >= 1 - rounding)
        return strength_of(material);
    return average(strength_of(material), bridge_strength(scene, network, edge), fraction);
}

EquivalentJoints without_joints(std::size_t edges, std::size_t kelvin_units)
{
    const std::vector<double> none(edges, 0.0), no_units(edges * kelvin_units, 0.0);
    return {none, none, none, none, none, no_units, no_units, no_units, no_units, none, none};
}

std::size_t most_kelvin_units(const Scene& scene)
{
    std::size_t most = 0;
    for (const JointMaterial& material : scene.joint_materials)
        most = std::max(most, material.kelvin.size());
    return most;
}

void set_joint(EquivalentJoints& joints, std::size_t edge, const JointMaterial& material,
               const Strength& strength)
{
    joints.normal_stiffness[edge] = material.normal_stiffness;
    joints.shear_stiffness[edge] = material.shear_stiffness;
    joints.cohesion[edge] = strength.cohesion;
    joints.friction_angle[edge] = strength.friction_angle;
    joints.tensile_strength[edge] = strength.tensile_strength;
    std::size_t row = edge * joints.kelvin_units();
    for (const Kelvin& unit : material.kelvin) {
        joints.normal_kelvin_stiffness[row] = unit.normal_stiffness;
        joints.shear_kelvin_stiffness[row] = unit.shear_stiffness;
        joints.normal_kelvin_viscosity[row] = unit.normal_viscosity;
        joints.shear_kelvin_viscosity[row] = unit.shear_viscosity;
        ++row;
    }
    if (material.maxwell) {
        joints.normal_maxwell_viscosity[edge] = material.maxwell->normal_viscosity;
        joints.shear_maxwell_viscosity[edge] = material.maxwell->shear_viscosity;
    }
}

} // namespace

Strength average(const Strength& joint, const Strength& rock, double persistence)
{
    const double k = persistence;
    return {k * joint.cohesion + (1 - k) * rock.cohesion,
            std::atan(k * std::tan(joint.friction_angle) + (1 - k) * std::tan(rock.friction_angle)),
            k * joint.tensile_strength + (1 - k) * rock.tensile_strength};
}

EquivalentJoints average_strength(const Scene& scene, const Network& network)
{
    const Blocks& blocks = network.blocks;
    EquivalentJoints joints = without_joints(blocks.edge_kind.size(), most_kelvin_units(scene));
    for (std::size_t edge = 0; edge < blocks.edge_kind.size(); ++edge) {
        if (blocks.edge_kind[edge] == static_cast<Index>(EdgeKind::joint)) {
            const Index row = network.joints.material[blocks.edge_joint[edge]];
            const JointMaterial& material =
                by_name(scene.joint_materials, network.names.joint_material[row], "joint material");
            set_joint(joints, edge, material, edge_strength(scene, network, edge, material));
        } else if (blocks.edge_kind[edge] == static_cast<Index>(EdgeKind::boundary) &&
                   blocks.edge_boundary[edge] >= 0) {
            const std::string& name = scene.boundaries[blocks.edge_boundary[edge]].joint;
            if (name.empty())
                continue;
            const JointMaterial& material = by_name(scene.joint_materials, name, "joint material");
            set_joint(joints, edge, material, strength_of(material));
        }
    }
    return joints;
}

} // namespace jointcreep
