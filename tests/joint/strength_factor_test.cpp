// Strengths divided by a factor.

#include "joint/strength_factor.hpp"

#include "model/units.hpp"

#include <gtest/gtest.h>

#include <cmath>

using namespace jointcreep;
using namespace jointcreep::unit;

// On whatever traction, the joint bears 1/F of what it bore: (c - sigma tan(phi)) / F.
TEST(with_strength_divided, divides_what_the_joint_bears_and_leaves_the_rest)
{
    EquivalentJoints joints;
    joints.normal_stiffness = {5e9, 1e9};
    joints.cohesion = {1e5, 0};
    joints.friction_angle = {38 * deg, 0};
    joints.tensile_strength = {3e4, 0};
    joints.dilation_angle = {38 * deg, 0};
    joints.residual_cohesion = {4e4, 0};
    joints.residual_friction_angle = {31 * deg, 0};
    const double F = 1.37;
    const EquivalentJoints reduced = joint::with_strength_divided(joints, F);
    for (const double sigma : {0.0, -1e5, -3e6}) {
        const double borne = joints.cohesion[0] - sigma * std::tan(joints.friction_angle[0]);
        EXPECT_NEAR(reduced.cohesion[0] - sigma * std::tan(reduced.friction_angle[0]), borne / F,
                    1e-12 * borne);
        const double left = joints.residual_cohesion[0] - sigma * std::tan(joints.residual_friction_angle[0]);
        EXPECT_NEAR(reduced.residual_cohesion[0] - sigma * std::tan(reduced.residual_friction_angle[0]),
                    left / F, 1e-12 * left);
    }
    EXPECT_DOUBLE_EQ(reduced.tensile_strength[0], 3e4 / F);
    EXPECT_DOUBLE_EQ(reduced.dilation_angle[0],
                     reduced.friction_angle[0]); // still at most the friction angle
    EXPECT_EQ(reduced.normal_stiffness, joints.normal_stiffness);
    EXPECT_EQ(reduced.cohesion[1] + reduced.friction_angle[1] + reduced.tensile_strength[1], 0);
}
