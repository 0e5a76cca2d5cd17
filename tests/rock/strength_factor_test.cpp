// Strength reduction of rock that yields.

#include "rock/strength_factor.hpp"

#include "model/units.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace strength_factor_of_rock_test
{

using namespace jointcreep;
using unit::deg;

TEST(with_strength_divided, divides_the_strength_of_rock)
{
    std::vector<Rock> rocks(2);
    rocks[0].strength = RockStrength{2e6, 40 * deg, 1e6};
    rocks[0].dilation_angle = 40 * deg;
    const double F = 1.37;
    const std::vector<Rock> reduced = rock::with_strength_divided(rocks, F);
    const RockStrength& strength = *reduced[0].strength;
    EXPECT_DOUBLE_EQ(strength.cohesion, 2e6 / F);
    EXPECT_DOUBLE_EQ(strength.tensile_strength, 1e6 / F);
    EXPECT_DOUBLE_EQ(std::tan(strength.friction_angle), std::tan(40 * deg) / F);
    EXPECT_DOUBLE_EQ(reduced[0].dilation_angle, strength.friction_angle);
    EXPECT_FALSE(reduced[1].strength);
}

} // namespace strength_factor_of_rock_test
