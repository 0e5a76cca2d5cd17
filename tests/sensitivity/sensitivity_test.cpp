// Sensitivities of whole analyses against central differences of whole runs.

#include "../mechanics/sections.hpp"

#include "analysis/analysis.hpp"
#include "model/units.hpp"

#include <gtest/gtest.h>

#include <iostream>

using namespace jointcreep;
using namespace jointcreep::test;
using Eigen::Vector2d;
using sensitivity::Parameter;

namespace
{

constexpr double day = unit::day;

const std::vector<Parameter> all{Parameter::kelvin_stiffness, Parameter::kelvin_viscosity,
                                 Parameter::joint_stiffness, Parameter::horizontal_stress};

// 20 m x 10 m on three joints that creep, along the normal with K / E = 4 at a rate of 1 / 2 days, in shear
// with K / E = 1 at 1 / 8 days. Its right side leaves in two stages.
struct Study {
    Scene scene;
    Network network;
    EquivalentJoints joints;

    explicit Study(std::optional<double> friction_angle = {})
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
        scene.end = 20 * day;
        scene.creep.emplace().step = day;
        scene.creep->scheme = CreepScheme::fitted;
        scene.equilibrium = {.tolerance = 1e-12, .unloading_increments = 1, .most_steps = 400000};
        scene.stages = {{"upper", day, {{{13, 6}, {21, 6}, {21, 11}, {13, 11}}}},
                        {"lower", 5 * day, {{{13, 3}, {21, 3}, {21, 6}, {13, 6}}}}};
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
            joints.normal_kelvin_viscosity[e] = joints.normal_kelvin_stiffness[e] * 2 * day;
            joints.shear_kelvin_viscosity[e] = joints.shear_kelvin_stiffness[e] * 8 * day;
        }
    }

    struct Found {
        History history;
        std::vector<std::vector<Vector2d>> sensitivities;
        Index slipping = 0, open = 0;
    };
    Found run(bool with_sensitivities, Parameter parameter = {}, double logarithm = 0) const
    {
        Scene changed = scene;
        EquivalentJoints stiffer = joints;
        sensitivity::scale(stiffer, changed.in_situ_stress, parameter, std::exp(logarithm));
        const Recording recording{0, 0, with_sensitivities ? all : std::vector<Parameter>{}};
        Analysis analysis(changed, network, stiffer, 1, recording, [](double, const std::string&) {});
        analysis.run();
        Found found{analysis.result().history, analysis.sensitivities()};
        const std::vector<Index>& status = analysis.result().states.contact_status;
        found.slipping = static_cast<Index>(
            std::count(status.begin(), status.end(), static_cast<Index>(ContactStatus::slipping)));
        found.open = static_cast<Index>(
            std::count(status.begin(), status.end(), static_cast<Index>(ContactStatus::open)));
        return found;
    }

    // The largest difference over rows and points between a sensitivity and the central difference of runs,
    // over the largest sensitivity to the parameter; and that is at least `least` [m].
    double error(Parameter parameter, double h, double least) const
    {
        const Found middle = run(true), below = run(false, parameter, -h), above = run(false, parameter, h);
        if (middle.history.time.size() != below.history.time.size() ||
            middle.history.time.size() != above.history.time.size())
            return 1e9;
        const auto p = static_cast<std::size_t>(std::find(all.begin(), all.end(), parameter) - all.begin());
        double largest = 0, difference = 0;
        for (std::size_t i = 0; i < middle.sensitivities[p].size(); ++i) {
            const Vector2d by_runs =
                (above.history.displacement[i] - below.history.displacement[i]) / (2 * h);
            largest = std::max(largest, by_runs.norm());
            difference = std::max(difference, (middle.sensitivities[p][i] - by_runs).norm());
        }
        std::cout << "parameter " << p << " largest " << largest << " error " << difference / largest
                  << " slip " << middle.slipping << " open " << middle.open << '\n';
        return largest < least ? 1e9 : difference / largest;
    }
};

} // namespace

TEST(sensitivity, of_linear_joints_is_that_of_whole_runs)
{
    for (const CreepScheme scheme :
         {CreepScheme::published, CreepScheme::backward, CreepScheme::linear_force, CreepScheme::fitted}) {
        Study study;
        study.scene.creep->scheme = scheme;
        study.scene.creep->step = 0.5 * day;
        for (const Parameter parameter : all)
            EXPECT_LT(study.error(parameter, 3e-4, 1e-5), 1e-6);
    }
}

TEST(sensitivity, slip)
{
    for (double phi : {0.8, 0.6, 0.5}) {
        Study study(phi);
        for (const Parameter parameter : all)
            EXPECT_LT(study.error(parameter, 1e-6, 1e-5), 1e-6);
    }
}
