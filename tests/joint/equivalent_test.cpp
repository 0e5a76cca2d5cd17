#include "joint/equivalent.hpp"

#include "model/error.hpp"
#include "model/units.hpp"

#include <gtest/gtest.h>

#include <cmath>

using namespace jointcreep;
using namespace jointcreep::unit;

namespace
{

constexpr Strength joint{.1 * MPa, 30 * deg, 0};
constexpr Strength rock{2 * MPa, 50 * deg, 1 * MPa};

// Two unit squares of two rocks on top of each other, the joint between them the first edge; the second edge
// is the lower one's base, the third its left side, the fourth a welded one.
struct Section {
    Scene scene;
    Network network;

    explicit Section(double joint_fraction)
    {
        scene.rocks = {{"lower", 2700, 30 * GPa, .2, RockStrength{2 * MPa, 50 * deg, 3 * MPa}},
                       {"upper", 2700, 30 * GPa, .2, RockStrength{4 * MPa, 40 * deg, 1 * MPa}}};
        scene.joint_materials = {
            {"smooth", 1e9, 2e8, 0, 20 * deg, 0, {}},
            {"rough", 6.9e8, 2.8e8, .1 * MPa, 30 * deg, .05 * MPa, {Kelvin{1e9, 2e15, 3e8, 4e15}}}};
        scene.boundaries = {{{0, 0}, {1, 0}, false, false, "smooth"}, {{0, 0}, {0, 1}, true, false, ""}};

        // Not in the scene's order, which may not matter.
        network.names = {{"upper", "lower"}, {"rough", "smooth"}, {"bedding"}, {}};
        network.joints = {{0}, {7}, {0}, {{-1, 1}}, {{2, 1}}, {}, {}, {}};
        Blocks& blocks = network.blocks;
        blocks.vertex = {{0, 1}, {1, 1}, {0, 0}, {1, 0}};
        blocks.edge_vertex = {{0, 1}, {2, 3}, {0, 2}, {0, 3}};
        blocks.edge_block = {{0, 1}, {1, -1}, {1, -1}, {1, 1}};
        blocks.edge_kind = {1, 0, 0, 2};
        blocks.edge_joint = {0, -1, -1, -1};
        blocks.edge_joint_fraction = {joint_fraction, 0, 0, 0};
        blocks.edge_boundary = {-1, 0, 1, -1};
        blocks.block_rock = {0, 1};
    }
};

std::string refusal(const Section& section)
{
    try {
        average_strength(section.scene, section.network);
    } catch (const input_error& error) {
        return error.what();
    }
    return "";
}

} // namespace

TEST(Average, IsTheJointAtPersistence1AndTheRockAt0)
{
    const Strength whole = average(joint, rock, 1), none = average(joint, rock, 0);
    EXPECT_DOUBLE_EQ(whole.cohesion, joint.cohesion);
    EXPECT_DOUBLE_EQ(whole.friction_angle, joint.friction_angle);
    EXPECT_DOUBLE_EQ(whole.tensile_strength, joint.tensile_strength);
    EXPECT_DOUBLE_EQ(none.cohesion, rock.cohesion);
    EXPECT_DOUBLE_EQ(none.friction_angle, rock.friction_angle);
    EXPECT_DOUBLE_EQ(none.tensile_strength, rock.tensile_strength);
}

TEST(Average, IsWhatAHandFinds)
{
    // k = 0.25: c = .025 + 1.5, T = .75 MPa, tan(phi) = .25 * .577350 + .75 * 1.191754 = 1.038153
    const Strength quarter = average(joint, rock, .25);
    EXPECT_NEAR(quarter.cohesion, 1.525 * MPa, 1e-6);
    EXPECT_NEAR(std::tan(quarter.friction_angle), 1.038153, 1e-6);
    EXPECT_NEAR(quarter.tensile_strength, .75 * MPa, 1e-6);
}

TEST(Average, FallsWithPersistenceUnderAWeakerJoint)
{
    Strength last = average(joint, rock, 0);
    for (int i = 1; i <= 100; ++i) {
        const Strength next = average(joint, rock, i / 100.0);
        EXPECT_LT(next.cohesion, last.cohesion);
        EXPECT_LT(next.friction_angle, last.friction_angle);
        EXPECT_LT(next.tensile_strength, last.tensile_strength);
        last = next;
    }
}

TEST(AverageStrength, TakesTheWeakerRockInEachStrengthByItself)
{
    const Section section(.4);
    const EquivalentJoints joints = average_strength(section.scene, section.network);
    EXPECT_NEAR(joints.cohesion[0], (.4 * .1 + .6 * 2) * MPa, 1e-6);          // of the lower rock
    EXPECT_NEAR(joints.tensile_strength[0], (.4 * .05 + .6 * 1) * MPa, 1e-6); // of the upper
    EXPECT_NEAR(std::tan(joints.friction_angle[0]), .4 * std::tan(30 * deg) + .6 * std::tan(40 * deg), 1e-12);
}

TEST(AverageStrength, LeavesStiffnessAndCreepTheJointsOwn)
{
    const Section section(.4);
    const EquivalentJoints joints = average_strength(section.scene, section.network);
    EXPECT_EQ(joints.normal_stiffness[0], 6.9e8);
    EXPECT_EQ(joints.shear_stiffness[0], 2.8e8);
    EXPECT_EQ(joints.normal_kelvin_stiffness[0], 1e9);
    EXPECT_EQ(joints.normal_kelvin_viscosity[0], 2e15);
    EXPECT_EQ(joints.shear_kelvin_stiffness[0], 3e8);
    EXPECT_EQ(joints.shear_kelvin_viscosity[0], 4e15);
}

TEST(AverageStrength, TakesTheJointOfABoundaryWhole)
{
    const Section section(.4);
    const EquivalentJoints joints = average_strength(section.scene, section.network);
    EXPECT_EQ(joints.normal_stiffness[1], 1e9);
    EXPECT_EQ(joints.shear_stiffness[1], 2e8);
    EXPECT_EQ(joints.cohesion[1], 0);
    EXPECT_EQ(joints.friction_angle[1], 20 * deg);
    EXPECT_EQ(joints.normal_kelvin_stiffness[1], 0); // the material does not creep
    EXPECT_EQ(joints.normal_kelvin_viscosity[1], 0);
}

TEST(AverageStrength, IsZeroWithoutAJoint)
{
    const Section section(.4);
    const EquivalentJoints joints = average_strength(section.scene, section.network);
    for (const auto& column :
         {joints.normal_stiffness, joints.shear_stiffness, joints.cohesion, joints.friction_angle,
          joints.tensile_strength, joints.normal_kelvin_stiffness, joints.shear_kelvin_stiffness,
          joints.normal_kelvin_viscosity, joints.shear_kelvin_viscosity}) {
        ASSERT_EQ(column.size(), 4);
        EXPECT_EQ(column[2], 0);
        EXPECT_EQ(column[3], 0);
    }
}

TEST(AverageStrength, NeedsTheRocksStrengthOnlyWhereThereAreBridges)
{
    for (const double fraction : {1.0, 1 - 1e-12, 1 + 1e-12}) {
        Section whole(fraction);
        for (Rock& each : whole.scene.rocks)
            each.strength.reset();
        const EquivalentJoints joints = average_strength(whole.scene, whole.network);
        EXPECT_EQ(joints.cohesion[0], .1 * MPa);
        EXPECT_EQ(joints.friction_angle[0], 30 * deg);
    }

    Section bridged(.75);
    bridged.scene.rocks[1].strength.reset();
    const std::string message = refusal(bridged);
    for (const char* part : {"\"upper\"", "\"bedding\"", "0.25", "[0, 1] to [1, 1] m"})
        EXPECT_NE(message.find(part), std::string::npos) << message;
}

TEST(AverageStrength, RefusesWhatIsNotInTheScene)
{
    Section section(.5);
    section.network.names.joint_material[0] = "unknown";
    EXPECT_NE(refusal(section).find("joint material \"unknown\""), std::string::npos);
    for (const double fraction : {-.1, 1.1, std::nan("")})
        EXPECT_NE(refusal(Section(fraction)).find("edge_joint_fraction"), std::string::npos);
}
