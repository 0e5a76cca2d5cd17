// Sections with joints of one material, zoned and assembled.

#pragma once

#include "../blocks/section.hpp"

#include "joint/law.hpp"
#include "mechanics/assembly.hpp"
#include "zoning/zone.hpp"

namespace jointcreep::test
{

// A joint that neither slips nor opens, or does so by `friction_angle` [rad] if that is given.
inline EquivalentJoints joints_everywhere(const Scene& scene, const Blocks& blocks, double k_n, double k_s,
                                          std::optional<double> friction_angle = {})
{
    EquivalentJoints joints;
    for (std::size_t e = 0; e < blocks.edge_vertex.size(); ++e) {
        const Index boundary = blocks.edge_boundary[e];
        const bool jointed =
            blocks.edge_joint[e] >= 0 || (boundary >= 0 && !scene.boundaries[boundary].joint.empty());
        const double there = jointed ? 1 : 0;
        joints.normal_stiffness.push_back(there * k_n);
        joints.shear_stiffness.push_back(there * k_s);
        joints.cohesion.push_back(friction_angle ? 0 : there * 1e12);
        joints.friction_angle.push_back(there * friction_angle.value_or(0.5));
        joints.tensile_strength.push_back(friction_angle ? 0 : there * 1e12);
    }
    const std::vector<double> none(blocks.edge_vertex.size(), 0.0);
    joints.dilation_angle = joints.dilation_until = none;
    for (const joint::Parameter& parameter : joint::all_parameters())
        if (std::vector<double>& values = parameter.in(joints); values.empty())
            values = none;
    joints.law.assign(none.size(), 0);
    joints.normal_kelvin_stiffness = joints.shear_kelvin_stiffness = none;
    joints.normal_kelvin_viscosity = joints.shear_kelvin_viscosity = none;
    joints.normal_maxwell_viscosity = joints.shear_maxwell_viscosity = none;
    return joints;
}

// Of contacts that all have Coulomb's law.
inline std::vector<std::reference_wrapper<joint::Coulomb>> coulomb(std::vector<joint::Law>& laws)
{
    std::vector<std::reference_wrapper<joint::Coulomb>> all;
    for (joint::Law& law : laws)
        all.emplace_back(std::get<joint::Coulomb>(law));
    return all;
}

struct Section {
    Scene scene;
    Network network;
    EquivalentJoints equivalent;
    Mesh mesh;
    mechanics::Assembly assembly;
};

inline Section assembled(Scene scene, const Joints& joints, double k_n, double k_s,
                         std::optional<double> friction_angle = {})
{
    Section s;
    s.network.joints = joints;
    s.network.blocks = blocks::cut(scene, joints);
    s.equivalent = joints_everywhere(scene, s.network.blocks, k_n, k_s, friction_angle);
    s.mesh = zoning::zone(scene, s.network.blocks);
    s.assembly = mechanics::assemble(scene, s.network, s.equivalent, s.mesh);
    s.scene = std::move(scene);
    return s;
}

// 20 m x 10 m of rock with three joints through it, free all round, weightless and unstressed.
inline Section jointed_plate()
{
    Scene scene = section({{0, 0}, {20, 0}, {20, 10}, {0, 10}}, 0.05);
    scene.zone_size = 1.5;
    Joints joints;
    add_joint(joints, {-1, 3}, {21, 5});
    add_joint(joints, {6, -1}, {9, 11});
    add_joint(joints, {21, 2}, {11, 11});
    return assembled(std::move(scene), joints, 5e9, 2e9);
}

//        ___________
//       /          /   a thin block (10 m x 1 m) on a joint that dips at `dip`, on a block that is held
//      /__________/
//     /__________/
inline Section incline(double dip, double friction)
{
    const Eigen::Vector2d along(std::cos(dip), -std::sin(dip)), up(std::sin(dip), std::cos(dip));
    const auto at = [&](double x, double y) { return Eigen::Vector2d(x * along + y * up); };
    Scene scene = section({at(0, -1), at(10, -1), at(10, 1), at(0, 1)}, 0.01);
    scene.zone_size = 0.5;
    scene.gravity = 9.81;
    scene.boundaries = {{at(0, -1), at(10, -1), true, true, ""}};
    Joints joints;
    add_joint(joints, at(0, 0), at(10, 0));
    return assembled(std::move(scene), joints, 1e8, 4e7, friction);
}

} // namespace jointcreep::test
