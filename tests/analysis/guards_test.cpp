// Guards: each finds a fault that is put in, and a run with one ends there.

#include "../mechanics/sections.hpp"

#include "analysis/analysis.hpp"
#include "model/error.hpp"
#include "model/units.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace guards_test
{

using namespace jointcreep;
using namespace jointcreep::test;
using analysis::Analysis;
using analysis::energy_error;

namespace
{

constexpr double day = unit::day;

using Fault = std::function<void(mechanics::Assembly&)>;

// 8 m x 4 m on a joint. The right half of what lies on it leaves on day 1.
struct Study {
    Scene scene;
    Network network;
    EquivalentJoints joints;

    Study()
    {
        scene = section({{0, 0}, {8, 0}, {8, 4}, {0, 4}}, 0.05);
        scene.zone_size = 1;
        scene.gravity = 9.81;
        scene.in_situ_stress.elevation = 4;
        scene.in_situ_stress.gradient_yy = 2700 * 9.81;
        scene.boundaries = {{.from = {0, 0}, .to = {8, 0}, .fix_x = true, .fix_y = true},
                            {.from = {0, 0}, .to = {0, 4}, .fix_x = true}};
        scene.points = {{"top", {1, 4}, 0}};
        scene.end = 2 * day;
        scene.equilibrium = {.tolerance = 1e-6, .unloading_increments = 1, .most_steps = 400000};
        scene.stages = {{"right half", day, {{{4, 1.5}, {9, 1.5}, {9, 5}, {4, 5}}}}};
        add_joint(network.joints, {-1, 1}, {9, 1});
        network.names = names_of(scene);
        network.names.joint_set = {"joint"};
        network.blocks = blocks::cut(scene, network.joints);
        joints = joints_everywhere(scene, network.blocks, 1e9, 4e8, 0.6);
    }

    // The message of a run with a fault put in before the stage; empty if it ends well. The result is in `result`.
    std::string run(const Fault& fault)
    {
        Analysis* running = nullptr;
        Analysis analysed(scene, network, joints, 1, {}, [&](const analysis::Progress& now) {
            if (now.what == "right half" && now.search == nullptr && fault)
                fault(const_cast<mechanics::Assembly&>(running->assembly()));
        });
        running = &analysed;
        std::string message;
        try {
            analysed.run();
        } catch (const equilibrium_error& error) {
            message = error.what();
        }
        result = analysed.result();
        return message;
    }
    Result result{};
};

} // namespace

TEST(guards, a_run_without_a_fault_keeps_to_all)
{
    for (const EngineChoice engine : {EngineChoice::implicit, EngineChoice::relaxation}) {
        Study study;
        study.scene.equilibrium.engine = engine;
        EXPECT_EQ(study.run({}), "");
        const GuardHistory& guards = study.result.guards;
        EXPECT_EQ(guards.penetration.size(), study.result.states.time.size());
        for (std::size_t s = 0; s < guards.penetration.size(); ++s) {
            EXPECT_LT(guards.area_error[s], 1e-12);
            EXPECT_LT(guards.weight_error[s], 1e-12);
            EXPECT_LT(guards.penetration[s], 1e-15);
        }
    }
}

TEST(guards, a_run_with_a_fault_ends_there)
{
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<std::pair<Fault, std::string>> faults{
        {[](mechanics::Assembly& rock) { rock.load[rock.load.size() / 2].y() *= 1.01; }, "loads are off"},
        {[](mechanics::Assembly& rock) { rock.zones.area[3] *= 1.0001; }, "areas of zones are off"},
        {[](mechanics::Assembly& rock) {
             for (std::size_t z = 0; z < rock.zones.size(); ++z) // nothing computes it again
                 if (!rock.zones.is_present[z])
                     rock.zones.stress[z].x() = nan;
         },
         "not finite"}};
    for (const auto& [fault, expected] : faults) {
        Study study;
        const std::string message = study.run(fault);
        EXPECT_NE(message.find("the result is wrong: "), std::string::npos) << expected;
        EXPECT_NE(message.find(expected), std::string::npos) << message;
        EXPECT_EQ(study.result.failure.reason.find("the result is wrong"), 0u);
        EXPECT_EQ(study.result.failure.moves_on, 0);
        EXPECT_EQ(study.result.states.time.size(), study.result.guards.penetration.size());
        EXPECT_EQ(study.result.states.time.back(), 1); // before the stage
    }
}

TEST(guards, contacts_and_equilibria_are_guarded)
{
    Study study;
    Analysis analysed(study.scene, study.network, study.joints, 1, {}, [](const analysis::Progress&) {});
    analysed.run();
    const double size = mechanics::size_of(analysed.assembly());
    analysis::GuardedState state;
    EXPECT_EQ(broken_guard(state, size), "");
    state.penetration = 1e-6;
    EXPECT_NE(broken_guard(state, size).find("closed by"), std::string::npos);
    state.penetration = std::numeric_limits<double>::quiet_NaN();
    EXPECT_NE(broken_guard(state, size), "");

    EXPECT_EQ(analysis::broken_guard(1e-6, 1e-7, 1e-6), "");
    EXPECT_NE(analysis::broken_guard(1.1e-6, 0, 1e-6).find("unbalanced"), std::string::npos);
    EXPECT_NE(analysis::broken_guard(1e-6, 1e-5, 1e-6).find("energy"), std::string::npos);
    mechanics::Convergence balance{.work_of_loads = 10, .stored = 6, .dissipated = 3, .damped = 1};
    EXPECT_EQ(energy_error(balance, 100), 0);
    balance.damped = 0;
    EXPECT_NEAR(energy_error(balance, 100), 1.0 / 19, 1e-9);
    EXPECT_EQ(energy_error({.stored = 1e-12}, 10), 0); // rounding of what is stored
    balance = {.work_of_loads = 10, .stored = 6, .dissipated = 3, .damped = 1, .created = 1e-4};
    EXPECT_NEAR(energy_error(balance, 100), 1e-4 / 20, 1e-9);
    balance.damped = std::numeric_limits<double>::quiet_NaN();
    EXPECT_NE(analysis::broken_guard(0, energy_error(balance, 100), 1e-6), "");
}

} // namespace guards_test
