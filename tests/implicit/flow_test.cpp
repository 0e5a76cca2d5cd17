// Rock that yields under a load it can carry, and under one it cannot.

#include "../mechanics/sections.hpp"

#include "implicit/equilibrium.hpp"
#include "mechanics/loading.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace flow_test
{

using namespace jointcreep;
using namespace jointcreep::test;

namespace
{

constexpr double cohesion = 1e5; // [Pa]

// Clay without weight or friction on a rigid base, 4 m by 2 m, pressed on its left half by `pressure` [Pa]. With a smooth
// side wall this is half of a strip of 4 m: it carries between (2 + pi) c and what two blocks that slide at 45 degrees carry.
Section pressed(double pressure)
{
    Scene scene = section({{0, 0}, {8, 0}, {8, 4}, {2, 4}, {0, 4}}, 0.01);
    scene.zone_size = 0.5;
    scene.asks_for_quadratic_zones = true;
    scene.gravity = 0;
    Rock& clay = scene.rocks[0];
    clay.youngs_modulus = 5e7;
    clay.poissons_ratio = 0.3;
    clay.strength = RockStrength{cohesion, 0, 100 * cohesion};
    clay.law = RockLaw::mohr_coulomb;
    scene.boundaries = {{.from = {0, 0}, .to = {8, 0}, .fix_x = true, .fix_y = true},
                        {.from = {0, 0}, .to = {0, 4}, .fix_x = true},
                        {.from = {8, 0}, .to = {8, 4}, .fix_x = true},
                        {.from = {0, 4}, .to = {2, 4}, .traction = Eigen::Vector2d(0, -pressure)}};
    Section s = assembled(std::move(scene), {}, 1e9, 1e9);
    mechanics::Loading(s.scene, s.mesh).apply(s.assembly, 0);
    return s;
}

const Equilibrium settings{.tolerance = 1e-6, .unloading_increments = 1, .most_steps = 1000};

} // namespace

TEST(flow, comes_to_rest_under_a_load_that_clay_carries)
{
    Section s = pressed(4.9 * cohesion);
    implicit::Solver solver;
    const auto found = solver.equilibrate(s.assembly, settings);
    ASSERT_TRUE(found) << solver.reason();
    EXPECT_FALSE(solver.collapse());
    EXPECT_LE(found->unbalanced_force_ratio, settings.tolerance);
    EXPECT_GT(rock::largest_plastic_strain(s.assembly.zones), 1e-3);
}

TEST(flow, moves_on_under_a_load_that_clay_does_not_carry)
{
    for (const double times : {5.7, 8.0, 30.0}) {
        Section s = pressed(times * cohesion);
        implicit::Solver solver;
        EXPECT_FALSE(solver.equilibrate(s.assembly, settings));
        ASSERT_TRUE(solver.collapse()) << times << ": " << solver.reason();
        EXPECT_TRUE(solver.collapse()->moves_on);
        EXPECT_GT(mechanics::largest_displacement(s.assembly).first, mechanics::size_of(s.assembly) / 10);
        // Under the load it sinks, and beside it rises.
        const auto& motion = solver.collapse()->motion;
        double sinks = 0, rises = 0;
        for (std::size_t g = 0; g < motion.size(); ++g) {
            sinks = std::min(sinks, motion[g].y());
            rises = std::max(rises, motion[g].y());
        }
        EXPECT_LT(sinks, -0.01);
        EXPECT_GT(rises, 0.001);
        EXPECT_LT(solver.factorisations(), 120) << times;
    }
}

// The limit of displacement that a factor of safety gives ends the search earlier.
TEST(flow, ends_at_the_largest_displacement)
{
    Section s = pressed(5.7 * cohesion);
    Equilibrium limited = settings;
    limited.largest_displacement = 0.1;
    implicit::Solver solver;
    EXPECT_FALSE(solver.equilibrate(s.assembly, limited));
    ASSERT_TRUE(solver.collapse());
    EXPECT_GT(mechanics::largest_displacement(s.assembly).first, limited.largest_displacement);
    // A load that is carried within it is not one that fails.
    s = pressed(2 * cohesion);
    EXPECT_TRUE(solver.equilibrate(s.assembly, limited)) << solver.reason();
    EXPECT_FALSE(solver.collapse());
}

} // namespace flow_test
