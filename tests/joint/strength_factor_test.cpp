// Strengths divided by a factor.

#include "joint/strength_factor.hpp"

#include "joint/barton_bandis.hpp"

#include "model/units.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace strength_factor_test
{

using namespace jointcreep;
using namespace jointcreep::unit;

// On whatever traction, the joint bears 1/F of what it bore: (c - sigma tan(phi)) / F.
TEST(with_strength_divided, divides_what_the_joint_bears_and_leaves_the_rest)
{
    EquivalentJoints joints;
    joints.law.assign(2, 1); // residual strength
    joints.normal_stiffness = {5e9, 1e9};
    joints.cohesion = {1e5, 0};
    joints.friction_angle = {38 * deg, 0};
    joints.tensile_strength = {3e4, 0};
    joints.dilation_angle = {38 * deg, 0};
    std::vector<double>&left_cohesion = joints.own["residual_cohesion"],
    &left_friction = joints.own["residual_friction_angle"];
    left_cohesion = {4e4, 0};
    left_friction = {31 * deg, 0};
    const double F = 1.37;
    EquivalentJoints reduced = joint::with_strength_divided(joints, F);
    for (const double sigma : {0.0, -1e5, -3e6}) {
        const double borne = joints.cohesion[0] - sigma * std::tan(joints.friction_angle[0]);
        EXPECT_NEAR(reduced.cohesion[0] - sigma * std::tan(reduced.friction_angle[0]), borne / F,
                    1e-12 * borne);
        const double left = left_cohesion[0] - sigma * std::tan(left_friction[0]);
        EXPECT_NEAR(reduced.own["residual_cohesion"][0] -
                        sigma * std::tan(reduced.own["residual_friction_angle"][0]),
                    left / F, 1e-12 * left);
    }
    EXPECT_DOUBLE_EQ(reduced.tensile_strength[0], 3e4 / F);
    EXPECT_DOUBLE_EQ(reduced.dilation_angle[0],
                     reduced.friction_angle[0]); // still at most the friction angle
    EXPECT_EQ(reduced.normal_stiffness, joints.normal_stiffness);
    EXPECT_EQ(reduced.cohesion[1] + reduced.friction_angle[1] + reduced.tensile_strength[1], 0);
}

// Of Barton and Bandis's law the factor divides the strength at every pressure, and nothing else.
TEST(with_strength_divided, divides_the_strength_of_barton_and_bandis)
{
    EquivalentJoints joints;
    joints.law = {2}; // Barton-Bandis
    joints.friction_angle = {30 * deg};
    joints.own["roughness"] = {10};
    EquivalentJoints reduced = joint::with_strength_divided(joints, 1.37);
    EXPECT_DOUBLE_EQ(reduced.friction_angle[0], 30 * deg);
    EXPECT_DOUBLE_EQ(reduced.own["roughness"][0], 10);
    EXPECT_DOUBLE_EQ(reduced.strength_divisor, 1.37);
    JointMaterial material;
    material.friction_angle = 30 * deg;
    material.law = 2;
    material.own = {{"roughness", 10}, {"wall_strength", 1e8}, {"largest_closure", 2e-4}};
    const JointMaterial new_contacts = joint::with_strength_divided(std::vector{material}, 1.37)[0];
    EXPECT_DOUBLE_EQ(new_contacts.friction_angle, 30 * deg);
    EXPECT_DOUBLE_EQ(new_contacts.strength_divisor, 1.37);

    joint::BartonBandis law{1e10, 1e9, 2e-4, 30 * deg, 10, 1e8};
    const joint::BartonBandis whole = law;
    law.divisor = 1.37;
    for (const double p : {0.0, 1e3, 1e6, 4e7, 2e8}) {
        EXPECT_DOUBLE_EQ(law.strength(p), whole.strength(p) / 1.37);
        EXPECT_DOUBLE_EQ(law.friction(p), whole.friction(p) / 1.37);
        EXPECT_DOUBLE_EQ(law.stiffness(p), whole.stiffness(p));
    }
}

TEST(with_strength_divided, divides_the_friction_of_new_contacts)
{
    JointMaterial material;
    material.friction_angle = 30 * deg;
    material.law = 1; // residual strength
    material.own = {{"residual_cohesion", 0}, {"residual_friction_angle", 20 * deg}};
    const double F = 1.37;
    const JointMaterial reduced = joint::with_strength_divided(std::vector{material}, F)[0];
    EXPECT_DOUBLE_EQ(std::tan(reduced.friction_angle), std::tan(30 * deg) / F);
    EXPECT_DOUBLE_EQ(std::tan(reduced.own.at("residual_friction_angle")), std::tan(20 * deg) / F);
}

} // namespace strength_factor_test
