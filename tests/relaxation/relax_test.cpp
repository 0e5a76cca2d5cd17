// Equilibria with a closed form, by every kind of damping.

#include "../mechanics/sections.hpp"

#include "mechanics/failure.hpp"
#include "mechanics/loading.hpp"
#include "mechanics/recorder.hpp"
#include "model/error.hpp"
#include "relaxation/relax.hpp"

#include <gtest/gtest.h>

namespace relax_test
{

using namespace jointcreep;
using namespace jointcreep::test;
using Eigen::Vector2d;
using mechanics::Convergence;

namespace
{

Equilibrium settings(Damping damping, Masses masses = Masses::scaled)
{
    return {.tolerance = 1e-7,
            .masses = masses,
            .damping = damping,
            .mass_damping = 20,
            .local_damping = 0.8,
            .unloading_increments = 1,
            .most_steps = 200000};
}

const double deg = std::numbers::pi / 180;

} // namespace

class relax_with : public testing::TestWithParam<std::pair<Damping, Masses>>
{
};

// The paper's column under its own weight, put on at once: settlement of a block's centre over its base
// joint.
//   u = -sum over the joints below (weight above / K) - integral of (stress above) (1 - nu^2) / E dy
TEST_P(relax_with, column_settles_under_its_weight)
{
    Scene scene = section({{0, 0}, {10, 0}, {10, 40}, {0, 40}}, 0.1);
    scene.rocks = {{"rock", 2750, 4e10, 0.22, std::nullopt}};
    scene.zone_size = 2.5;
    scene.gravity = 9.81;
    scene.boundaries = {{{0, 0}, {10, 0}, false, false, "joint"}};
    Joints joints;
    for (const double y : {10.0, 20.0, 30.0})
        add_joint(joints, {0, y}, {10, y});
    for (const double y : {5.0, 15.0, 25.0, 35.0})
        scene.points.push_back({"block", {5, y}, 0});
    const double K = 6.9e8;
    Section s = assembled(std::move(scene), joints, K, 0); // smooth joints: free to widen
    relaxation::relax(s.assembly, settings(GetParam().first, GetParam().second));

    Result result;
    mechanics::Recorder(s.scene, s.network.blocks, s.mesh).record_history(result, 0, "", s.assembly);
    const double weight = 2750 * 9.81;
    for (int block = 0; block < 4; ++block) {
        const double y = 10 * block + 5;
        double exact = 0;
        for (int joint = 0; joint <= block; ++joint)
            exact -= weight * (40 - 10 * joint) / K;
        exact -= weight * (40 * y - y * y / 2) * (1 - 0.22 * 0.22) / 4e10;
        EXPECT_NEAR(result.history.displacement[block].y(), exact, 1e-3 * std::abs(exact))
            << "block " << block;
    }
}

// W sin(b) / (A K_s) along the joint, W cos(b) / (A K_n) into it.
TEST_P(relax_with, a_block_on_an_incline_rests_below_the_friction_angle)
{
    const double dip = 25 * deg;
    Section s = incline(dip, 30 * deg);
    const Convergence convergence =
        relaxation::relax(s.assembly, settings(GetParam().first, GetParam().second));
    EXPECT_LE(convergence.unbalanced_force_ratio, 1e-7);
    EXPECT_LE(convergence.contact_force_change, 1e-7);
    // Energy: what the weight has done is stored, lost in the joint or damped.
    EXPECT_NEAR(convergence.work_of_loads, convergence.stored + convergence.dissipated + convergence.damped,
                1e-6 * convergence.work_of_loads);
    EXPECT_GE(convergence.dissipated, -1e-6 * convergence.work_of_loads);
    EXPECT_GT(convergence.damped, 0);
    double shear = 0, normal = 0, length = 0;
    for (std::size_t c = 0; c < s.mesh.contact_edge.size(); ++c) {
        shear += s.assembly.contacts.length[c] * s.assembly.contacts.traction[c].y();
        normal += s.assembly.contacts.length[c] * s.assembly.contacts.traction[c].x();
        length += s.assembly.contacts.length[c];
    }
    const double weight = 2700 * 9.81 * 10;
    EXPECT_NEAR(length, 10, 1e-9);
    EXPECT_NEAR(std::abs(shear), weight * std::sin(dip), 1e-5 * weight);
    EXPECT_NEAR(normal, -weight * std::cos(dip), 1e-5 * weight);
    // The middle of the joint slides by tau / K_s. (Mass and combined damping let the weight, put on at once,
    // overshoot and slip.)
    if (GetParam().first == Damping::mass || GetParam().first == Damping::combined)
        return;
    for (std::size_t c = 0; c < s.mesh.contact_edge.size(); ++c)
        if ((s.mesh.contact_centre[c] - 5 * Vector2d(std::cos(dip), -std::sin(dip))).norm() < 0.3) {
            const double exact = weight * std::sin(dip) / 10 / 4e7;
            EXPECT_NEAR(std::abs(s.assembly.contacts.relative_displacement[c].y()), exact, 0.01 * exact);
        }
}

// However early a search ends: what is still moving then is stopped, and its energy counts as damped.
TEST_P(relax_with, energy_balances_where_the_search_ends_early)
{
    Section s = incline(25 * deg, 30 * deg);
    Equilibrium how = settings(GetParam().first, GetParam().second);
    how.tolerance = 1e-2;
    const Convergence convergence = relaxation::relax(s.assembly, how);
    EXPECT_GT(convergence.unbalanced_force_ratio, 1e-7);
    EXPECT_NEAR(convergence.work_of_loads, convergence.stored + convergence.dissipated + convergence.damped,
                1e-10 * convergence.work_of_loads);
}

// A block is put on a joint that becomes 1e4 times as stiff as it closes. It comes to rest where the joint carries its
// weight.
TEST(relax, a_block_on_a_joint_that_stiffens)
{
    const double weight = 2700 * 9.81, largest_closure = 5e-3;
    const joint::BartonBandis law{weight / 99 / largest_closure, 1e5, largest_closure, 30 * deg, 10, 1e8};
    for (const Damping damping : {Damping::adaptive, Damping::kinetic})
        for (const Masses masses : {Masses::scaled, Masses::real}) {
            Scene scene = section({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 0.01);
            scene.rocks = {{"rock", 2700, 1e9, 0, std::nullopt}};
            scene.zone_size = 1;
            scene.gravity = 9.81;
            scene.boundaries = {{.from = {0, 0}, .to = {1, 0}, .joint = "joint"},
                                {.from = {0, 0}, .to = {0, 1}, .fix_x = true},
                                {.from = {1, 0}, .to = {1, 1}, .fix_x = true}};
            Section s = assembled(std::move(scene), {}, 1e9, 1e8);
            for (joint::Law& one : s.assembly.contacts.law)
                one = law;
            const Convergence convergence = relaxation::relax(s.assembly, settings(damping, masses));
            EXPECT_NEAR(convergence.work_of_loads,
                        convergence.stored + convergence.dissipated + convergence.damped,
                        1e-9 * convergence.work_of_loads);
            double carried = 0;
            for (std::size_t c = 0; c < s.assembly.contacts.law.size(); ++c) {
                const double pressure = -s.assembly.contacts.traction[c].x();
                carried += s.assembly.contacts.length[c] * pressure;
                EXPECT_NEAR(s.assembly.contacts.relative_displacement[c].x(), -law.closure(pressure),
                            1e-9 * largest_closure);
            }
            EXPECT_NEAR(carried, weight, 1e-6 * weight);
        }
}

constexpr Index n = 60;                                                 // cubes of a tall stack
constexpr double tall_stack_stiffness = 5e9, tall_stack_modulus = 2e10; // [Pa/m], [Pa]

// Cubes on each other, at rest under their weight. This takes long, so once for all tests.
const Section& tall_stack()
{
    static const Section at_rest = [] {
        Scene scene = section({{0, 0}, {1, 0}, {1, double(n)}, {0, double(n)}}, 0.01);
        scene.rocks = {{"rock", 2700, tall_stack_modulus, 0, std::nullopt}};
        scene.zone_size = 2;
        scene.gravity = 9.81;
        scene.boundaries = {{.from = {0, 0}, .to = {1, 0}, .joint = "joint"}};
        Joints joints;
        for (Index i = 1; i < n; ++i)
            add_joint(joints, {0, double(i)}, {1, double(i)});
        for (Index i = 0; i < n; ++i)
            scene.points.push_back({"cube", {0.5, i + 0.5}, 0});
        Section s = assembled(std::move(scene), joints, tall_stack_stiffness, 2e9);
        Equilibrium how = settings(Damping::adaptive);
        how.tolerance = 1e-11;
        relaxation::relax(s.assembly, how);
        return s;
    }();
    return at_rest;
}

// A stack of 60 cubes under its weight, and then 1e-4 of the weight of all on its top, displacements counting from there; or 0.3 of the weight,
// beside the displacements before. What is unbalanced
// is small beside the forces there are long before the stack has gone down as far as it must,
//   u = P ((i + 1) / K + y / E)       of the cube i, y up to its middle.
// The estimate of the remaining displacement is near what is left, or above where damping lets the stack
// swing.
TEST_P(relax_with, a_small_load_on_a_tall_stack)
{
    const double K = tall_stack_stiffness, E = tall_stack_modulus;
    for (const bool starts_anew : {true, false}) {
        Section s = tall_stack();
        if (starts_anew)
            mechanics::start_from_here(s.assembly);
        const auto displacements = [&] {
            Result result;
            mechanics::Recorder(s.scene, s.network.blocks, s.mesh).record_history(result, 0, "", s.assembly);
            return result.history.displacement;
        };
        const std::vector<Vector2d> before = displacements();
        const double P = (starts_anew ? 1e-4 : 0.3) * n * 2700 * 9.81;
        for (std::size_t g = 0; g < s.assembly.position.size(); ++g)
            if (s.assembly.position[g].y() > n - 1e-6)
                s.assembly.load[g].y() -= P / 2;
        Equilibrium how = settings(GetParam().first, GetParam().second);
        how.tolerance = 1e-6;
        how.mass_damping = 70; // about critical
        const Convergence convergence = relaxation::relax(s.assembly, how);

        const std::vector<Vector2d> after = displacements();
        double left = 0, farthest = 0;
        for (Index i = 0; i < n; ++i) {
            const double exact = -P * ((i + 1) / K + (i + 0.5) / E);
            left = std::max(left, std::abs(after[i].y() - before[i].y() - exact));
            farthest = std::max(farthest, -exact);
        }
        EXPECT_LT(left, 1e-3 * farthest);
        EXPECT_GT(convergence.remaining_displacement, 0.9 * left);
        EXPECT_LT(convergence.remaining_displacement,
                  1.01e-3 * farthest); // its farthest gridpoint is above a middle
    }
}

// A stack of 60 cubes that gets all of its weight at once, also on soft joints, where its top goes down by a metre, and another one, at
// rest under it, that is pushed sideways at its top: slow ways to rest, on which local damping keeps the cubes trembling. None slides.
TEST_P(relax_with, a_tall_stack_that_comes_to_rest_slowly_is_not_said_to_slide)
{
    for (const auto& [pushed, K] : {std::pair(false, 5e9), {false, 5e7}, {true, 5e9}}) {
        if (K < 1e9 && GetParam().first != Damping::mass)
            continue; // faster to rest
        Scene scene = section({{0, 0}, {1, 0}, {1, double(n)}, {0, double(n)}}, 0.01);
        scene.rocks = {{"rock", 2700, 2e10, 0, std::nullopt}};
        scene.zone_size = 2;
        scene.gravity = pushed ? 0 : 9.81;
        scene.boundaries = {{.from = {0, 0}, .to = {1, 0}, .joint = "joint"}};
        Joints joints;
        for (Index i = 1; i < n; ++i)
            add_joint(joints, {0, double(i)}, {1, double(i)});
        Section s = assembled(std::move(scene), joints, K, 2e9);
        if (pushed)
            for (std::size_t g = 0; g < s.assembly.position.size(); ++g)
                if (s.assembly.position[g].y() > n - 1e-6)
                    s.assembly.load[g].x() -= 50;
        Equilibrium how = settings(GetParam().first, GetParam().second);
        how.mass_damping = 70;
        how.tolerance = 1e-9;
        how.most_steps = 150000;
        try {
            relaxation::relax(s.assembly, how);
        } catch (const mechanics::no_equilibrium& error) {
            EXPECT_FALSE(error.moves_on) << error.what();
        }
    }
}

INSTANTIATE_TEST_SUITE_P(
    every_damping, relax_with,
    testing::Values(std::pair(Damping::adaptive, Masses::scaled), std::pair(Damping::adaptive, Masses::real),
                    std::pair(Damping::kinetic, Masses::scaled), std::pair(Damping::kinetic, Masses::real),
                    std::pair(Damping::local, Masses::scaled), std::pair(Damping::combined, Masses::scaled),
                    std::pair(Damping::mass, Masses::real)));

// Two blocks on a joint between platens that close by u0: the traction is u0 over the sum of the compliances,
// through a whole cycle of loading; what the joint gives back when it opens is nothing.
//     u0 = -sigma_n (H (1 + nu)(1 - 2 nu) / (E (1 - nu)) + 1 / K)        (no strain sideways: smooth rigid
//     sides)
TEST(relax, platens_cycle)
{
    Scene scene = section({{0, 0}, {2, 0}, {2, 4}, {0, 4}}, 0.01);
    scene.zone_size = 1;
    const LoadHistory cycle{{{0, 0}, {10, 1}, {30, -1}, {40, 0}}};
    scene.boundaries = {{.from = {0, 0}, .to = {2, 0}, .fix_y = true},
                        {.from = {0, 4},
                         .to = {2, 4},
                         .fix_y = true,
                         .displacement = Vector2d(0, -1e-3),
                         .load_history = cycle},
                        {.from = {0, 0}, .to = {0, 4}, .fix_x = true},
                        {.from = {2, 0}, .to = {2, 4}, .fix_x = true}};
    Joints joints;
    add_joint(joints, {0, 2}, {2, 2});
    const double K = 1e9;
    Section s = assembled(std::move(scene), joints, K, 1e9, 0.6);
    mechanics::Loading loading(s.scene, s.mesh);
    EXPECT_EQ(loading.corners(), (std::set<double>{0, 10, 30, 40}));
    EXPECT_TRUE(loading.changes(0, 5));
    EXPECT_FALSE(loading.changes(50, 60));
    const double E = s.scene.rocks[0].youngs_modulus, nu = s.scene.rocks[0].poissons_ratio;
    const double compliance = 4 * (1 + nu) * (1 - 2 * nu) / (E * (1 - nu)) + 1 / K;
    for (const double time : {5.0, 10.0, 17.5, 25.0, 35.0, 40.0}) {
        loading.apply(s.assembly, time);
        relaxation::relax(s.assembly, settings(Damping::adaptive));
        const double closing = 1e-3 * cycle.at(time);
        for (const Vector2d& traction : s.assembly.contacts.traction)
            EXPECT_NEAR(traction.x(), -std::max(0.0, closing) / compliance, 1e-5 * 1e-3 / compliance) << time;
    }
}

// A bar of 10 m x 1 m, fixed at one end, pulled at the other by q = 2 MPa.
Section pulled_bar()
{
    Scene scene = section({{0, 0}, {10, 0}, {10, 1}, {0, 1}}, 0.01);
    scene.zone_size = 0.5;
    scene.points = {{"end", {10, 0.5}, 0}};
    scene.boundaries = {{.from = {0, 0}, .to = {0, 1}, .fix_x = true},
                        {.from = {10, 0}, .to = {10, 1}, .traction = Vector2d(2e6, 0)},
                        {.from = {0, 0}, .to = {10, 0}, .fix_y = true}};
    Section s = assembled(std::move(scene), {}, 1e9, 1e9);
    mechanics::Loading(s.scene, s.mesh).apply(s.assembly, 0);
    return s;
}

// u = q L (1 - nu^2) / E, and half of the energy that a constant load brings is stored. Stiffness damping
// does not change where it rests; it takes fast motion out and brings it to rest sooner.
TEST(relax, a_bar_under_traction)
{
    double last_time = std::numeric_limits<double>::infinity();
    for (const auto& [mass_damping, stiffness_damping] :
         {std::pair(100.0, 0.0), {100.0, 2e-4}, {0.0, 1e-3}}) {
        Section s = pulled_bar();
        Equilibrium how = settings(Damping::mass, Masses::real);
        how.mass_damping = mass_damping;
        how.stiffness_damping = stiffness_damping;
        double time = 0;
        const Convergence convergence = relaxation::relax(s.assembly, how, [&](double t) { time = t; });
        Result result;
        mechanics::Recorder(s.scene, s.network.blocks, s.mesh).record_history(result, 0, "", s.assembly);
        const double exact = 2e6 * 10 * (1 - 0.25 * 0.25) / 3e10;
        EXPECT_NEAR(result.history.displacement[0].x(), exact, 1e-5 * exact);
        EXPECT_NEAR(convergence.work_of_loads, 2e6 * exact, 1e-5 * 2e6 * exact);
        EXPECT_NEAR(convergence.stored, 1e6 * exact, 1e-5 * 2e6 * exact);
        EXPECT_NEAR(convergence.damped, 1e6 * exact, 1e-5 * 2e6 * exact);
        EXPECT_LT(time, 0.8 * last_time);
        last_time = time;
    }
}

// A block of stiff rock, 1 m x 1 m, on a joint of normal stiffness K [Pa/m], which can only move up and down. Its mass is in
// kg/m.
Section block_on_joint(double K, double mass)
{
    Scene scene = section({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 0.01);
    scene.rocks = {{"rock", mass, 1e12, 0, std::nullopt}};
    scene.zone_size = 2;
    scene.gravity = 9.81;
    scene.boundaries = {{.from = {0, 0}, .to = {1, 0}, .joint = "joint"},
                        {.from = {0, 0}, .to = {0, 1}, .fix_x = true},
                        {.from = {1, 0}, .to = {1, 1}, .fix_x = true}};
    return assembled(std::move(scene), {}, K, 0);
}

// A gridpoint on its top.
std::size_t on_top(const Section& s)
{
    std::size_t top = 0;
    while (s.assembly.position[top].y() < 1)
        ++top;
    return top;
}

// This block, its weight put on at once, is an oscillator, whose dashpots are alpha times its mass and the contacts' beta
// times their springs.
//   u = -m g / K (1 - exp(-z w t) (cos w_d t + z w / w_d sin w_d t)),
//   w = sqrt(K / m),  z = alpha / (2 w) + beta w / 2,  w_d = w sqrt(1 - z^2)
TEST(relax, the_dashpots_of_contacts)
{
    const double K = 1e8, mass = 2700, w = std::sqrt(K / mass);
    for (const auto& [alpha, beta] : {std::pair(4.0, 0.0), {4.0, 1e-4}, {4.0, 5e-4}, {0.0, 5e-4}}) {
        Section s = block_on_joint(K, mass);
        Equilibrium how = settings(Damping::mass, Masses::real);
        how.mass_damping = alpha;
        how.stiffness_damping = beta;
        how.most_steps = 20'000'000;
        how.tolerance = 1e-2;
        const double z = alpha / (2 * w) + beta * w / 2, damped_w = w * std::sqrt(1 - z * z);
        const double rest = -mass * 9.81 / K;
        const std::size_t top = on_top(s);
        double worst = 0;
        relaxation::relax(s.assembly, how, [&](double t) {
            const double u = s.assembly.displacement[top].y();
            const double exact =
                rest * (1 - std::exp(-z * w * t) *
                                (std::cos(damped_w * t) + z * w / damped_w * std::sin(damped_w * t)));
            worst = std::max(worst, std::abs(u - exact));
        });
        EXPECT_LT(worst, 1e-3 * std::abs(rest)) << beta;
    }
}

// Adaptive damping finds the frequency w of this oscillator, so that its damping is critical.
//   u = -m g / K (1 - (1 + w t) exp(-w t))
TEST(relax, adaptive_damping_is_critical)
{
    const double K = 1e8, mass = 2700, w = std::sqrt(K / mass), rest = -mass * 9.81 / K;
    Section s = block_on_joint(K, mass);
    Equilibrium how = settings(Damping::adaptive, Masses::real);
    how.tolerance = 1e-2;
    const std::size_t top = on_top(s);
    double worst = 0;
    relaxation::relax(s.assembly, how, [&](double t) {
        const double exact = rest * (1 - (1 + w * t) * std::exp(-w * t));
        worst = std::max(worst, std::abs(s.assembly.displacement[top].y() - exact));
    });
    EXPECT_LT(worst, 0.02 * std::abs(rest));
}

// The same block without dashpots: moving away from rest it is held back by (1 + b) K u, towards it driven by
// (1 - b) K u. So with damping "local" its amplitude falls by sqrt((1 - b) / (1 + b)) every half cycle; with
// "combined" by the same, as its force changes against its velocity. With "kinetic" it stops at rest at once.
TEST(relax, a_block_that_swings_on_its_joint)
{
    for (const Damping damping : {Damping::local, Damping::combined, Damping::kinetic}) {
        const double K = 1e8, mass = 2700;
        Section s = block_on_joint(K, mass);
        Equilibrium how = settings(damping, Masses::real);
        how.local_damping = 0.5;
        how.tolerance = 1e-2;
        const double rest = -mass * 9.81 / K;
        std::vector<double> turns; // over the first amplitude, from rest
        double last = 0, before = 0;
        relaxation::relax(s.assembly, how, [&](double) {
            double now = 0, moving = 0; // the ground's gridpoints do not move
            for (std::size_t g = 0; g < s.assembly.displacement.size(); ++g)
                if (s.assembly.is_free[g].y() > 0) {
                    now += s.assembly.displacement[g].y();
                    ++moving;
                }
            now /= moving;
            if ((now - last) * (last - before) < 0)
                turns.push_back(last / rest - 1);
            before = last;
            last = now;
        });
        ASSERT_GE(turns.size(), 1U);
        if (damping == Damping::kinetic) {
            EXPECT_NEAR(turns[0], 0, 0.02);
            continue;
        }
        ASSERT_GE(turns.size(), 2U);
        const double share = std::sqrt(0.5 / 1.5), least = std::sqrt(0.75 / 1.25);
        if (damping == Damping::local) {
            EXPECT_NEAR(turns[0], share, 0.02);
            EXPECT_NEAR(turns[1], -share * share, 0.02);
        } else { // The stiff rock trembles, and the sign of its forces' change with it: half of the damping
                 // is left.
            EXPECT_NEAR(turns[0], least, 0.02);
        }
    }
}

// A block in free fall, all numbers powers of two and thirds of them, so that its force does not change at
// all: local damping leaves 1 - b of its acceleration, combined damping 1 - b / 2, and kinetic damping never
// finds a peak.
TEST(relax, a_block_that_falls)
{
    const double b = 0.5;
    for (const auto& [damping, left] :
         {std::pair(Damping::local, 1 - b), std::pair(Damping::combined, 1 - b / 2),
          std::pair(Damping::kinetic, 1.0)}) {
        Scene scene = section({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 0.01);
        scene.rocks = {{"rock", 2048, 1 << 30, 0, std::nullopt}};
        scene.zone_size = 2;
        scene.gravity = 8;
        Section s = assembled(std::move(scene), {}, 1e9, 1e9);
        Equilibrium how = settings(damping, Masses::real);
        how.local_damping = b;
        double time = 0;
        try {
            relaxation::relax(s.assembly, how, [&](double t) { time = t; });
            FAIL();
        } catch (const mechanics::no_equilibrium& error) {
            EXPECT_TRUE(error.moves_on);
            EXPECT_NEAR(s.assembly.displacement[0].y(), -left * 8 * time * time / 2,
                        0.02 * 8 * time * time / 2);
            EXPECT_NEAR(error.seconds, time, 1e-12); // since the start: it was not long ago
            EXPECT_EQ(error.motion[0], s.assembly.displacement[0]);
        }
    }
}

TEST_P(relax_with, a_block_on_an_incline_slides_above_the_friction_angle)
{
    Section s = incline(35 * deg, 30 * deg);
    try {
        relaxation::relax(s.assembly, settings(GetParam().first, GetParam().second));
        FAIL();
    } catch (const mechanics::no_equilibrium& error) {
        EXPECT_TRUE(error.moves_on);
        EXPECT_EQ(error.seconds > 0, GetParam().second == Masses::real);
        // It alone moves, down the dip.
        const Failure failure = failure_of(error, s.mesh, s.assembly);
        ASSERT_EQ(failure.block.size(), 1U);
        EXPECT_GT(failure.place[0].y(), -5 * std::sin(35 * deg)); // the upper one of the two
        // Displacements are those of the last steps, as the message has the largest one.
        const std::string what = error.what(), says = " is moving: ";
        if (const std::size_t place = what.find(says); place != std::string::npos) {
            double largest = 0;
            for (const Vector2d& motion : error.motion)
                largest = std::max(largest, motion.norm());
            const double said = std::stod(what.substr(place + says.size()));
            EXPECT_NEAR(largest, said, 1e-3 * said);
        }
        const Vector2d along(std::cos(35 * deg), -std::sin(35 * deg));
        EXPECT_NEAR(failure.motion[0].dot(along), failure.motion[0].norm(), 1e-2 * failure.motion[0].norm());
    }
}

TEST(relax, a_block_held_by_nothing_has_no_equilibrium)
{
    Scene scene = section({{0, 0}, {10, 0}, {10, 10}, {0, 10}}, 0.1);
    scene.zone_size = 3;
    scene.gravity = 9.81;
    Section s = assembled(std::move(scene), {}, 1e9, 1e9);
    EXPECT_THROW(relaxation::relax(s.assembly, settings(Damping::adaptive)), equilibrium_error);
}

TEST(relax, a_state_in_balance_stays_as_it_is)
{
    Section s = jointed_plate();
    const Convergence convergence = relaxation::relax(s.assembly, settings(Damping::adaptive));
    EXPECT_EQ(convergence.steps, 0);
}

TEST(relax, mass_damping_needs_real_masses)
{
    Section s = incline(25 * deg, 30 * deg);
    EXPECT_THROW(relaxation::relax(s.assembly, settings(Damping::mass, Masses::scaled)), input_error);
}

TEST(relax, gives_up_after_the_steps_allowed_and_says_how_far_it_was)
{
    Section s = incline(25 * deg, 30 * deg);
    Equilibrium impatient = settings(Damping::adaptive);
    impatient.most_steps = 40;
    try {
        relaxation::relax(s.assembly, impatient);
        FAIL();
    } catch (const equilibrium_error& error) {
        EXPECT_NE(std::string(error.what()).find("after 40 steps"), std::string::npos);
    }
}

} // namespace relax_test
