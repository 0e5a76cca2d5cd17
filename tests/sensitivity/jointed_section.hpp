// A small section with joints that creep, excavated in two stages.

#pragma once

#include "../mechanics/sections.hpp"

#include "model/units.hpp"

namespace jointcreep::test
{

// 20 m x 10 m on three joints that creep, along the normal with K / E = 4 at a rate of 1 / 2 days, in shear
// with K / E = 1 at 1 / 8 days. Its right side leaves in two stages.
struct JointedSection {
    Scene scene;
    Network network;
    EquivalentJoints joints;

    explicit JointedSection(std::optional<double> friction_angle = {})
    {
        scene = section({{0, 0}, {20, 0}, {20, 10}, {0, 10}}, 0.05);
        scene.zone_size = 2.5;
        scene.gravity = 9.81;
        scene.in_situ_stress.elevation = 10;
        scene.in_situ_stress.gradient_yy = 2700 * 9.81;
        scene.in_situ_stress.compression_xx = 5e4;
        scene.in_situ_stress.gradient_xx = 0.7 * 2700 * 9.81;
        scene.boundaries = {{.from = {0, 0}, .to = {20, 0}, .fix_x = true, .fix_y = true},
                            {.from = {0, 0}, .to = {0, 10}, .fix_x = true},
                            {.from = {20, 0}, .to = {20, 10}, .fix_x = true}};
        scene.points = {{"top", {5, 10}, 0}, {"toe", {12.5, 2}, 0}, {"gone", {15, 9}, 0}};
        scene.end = 20 * unit::day;
        scene.creep.emplace().step = unit::day;
        scene.creep->scheme = CreepScheme::fitted;
        scene.equilibrium = {.tolerance = 1e-12, .unloading_increments = 1, .most_steps = 400000};
        scene.stages = {{"upper", unit::day, {{{13, 6}, {21, 6}, {21, 11}, {13, 11}}}},
                        {"lower", 5 * unit::day, {{{13, 3}, {21, 3}, {21, 6}, {13, 6}}}}};
        add_joint(network.joints, {-1, 3}, {21, 4});
        add_joint(network.joints, {6, -1}, {9, 11});
        add_joint(network.joints, {11.5, -1}, {12, 11});
        network.names = names_of(scene);
        network.names.joint_set = {"joint"};
        network.blocks = blocks::cut(scene, network.joints);
        joints = joints_everywhere(scene, network.blocks, 1e9, 4e8, friction_angle);
        for (std::size_t e = 0; e < joints.normal_stiffness.size(); ++e) {
            joints.normal_kelvin_stiffness[e] = joints.normal_stiffness[e] / 4;
            joints.shear_kelvin_stiffness[e] = joints.shear_stiffness[e];
            joints.normal_kelvin_viscosity[e] = joints.normal_kelvin_stiffness[e] * 2 * unit::day;
            joints.shear_kelvin_viscosity[e] = joints.shear_kelvin_stiffness[e] * 8 * unit::day;
        }
    }
};

} // namespace jointcreep::test
