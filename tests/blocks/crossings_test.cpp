// The number of crossings is known before they are found.

#include "blocks/crossings.hpp"
#include "blocks/cut.hpp"

#include "model/error.hpp"

#include "section.hpp"

#include <gtest/gtest.h>

#include <random>

namespace crossings_test
{

using namespace jointcreep;
using namespace jointcreep::test;

namespace
{

// A square with joints of two sets: level ones, and upright ones that are as many and as long.
struct Grid {
    Scene scene = section({{0, 0}, {100, 0}, {100, 100}, {0, 100}}, 0.01);
    Joints joints;

    Grid(int each, double length)
    {
        scene.joint_sets.resize(1);
        scene.joint_sets[0].name = "level";
        scene.joints = {{"upright", "joint", {0, 0}, {0, 1}}};
        std::mt19937 random(7);
        std::uniform_real_distribution<double> place(0, 100), start(0, 100 - length);
        for (int i = 0; i < each; ++i) {
            const double x = start(random), y = place(random);
            add_joint(joints, {x, y}, {x + length, y}, 0);
            add_joint(joints, {y, x}, {y, x + length}, 1);
        }
    }
};

const blocks::Box box{{0, 0}, {100, 100}};

std::string refusal_of(const Grid& grid)
{
    try {
        blocks::check_crossings(grid.scene, grid.joints, box);
    } catch (const input_error& error) {
        return error.what();
    }
    return "";
}

} // namespace

TEST(crossings, of_lines_through_the_section)
{
    const Grid grid(10000, 100); // each level one meets each upright one
    EXPECT_NEAR(blocks::expected_crossings(grid.joints, box).number, 1e8, 5e6);
    EXPECT_NEAR(blocks::expected_crossings(grid.joints, {{0, 0}, {50, 50}}).number, 0.25e8, 2e6);
}

TEST(crossings, cost_is_told_before_cutting)
{
    const Grid grid(1225, 100);
    const blocks::CuttingCost cost = blocks::expected_cost(grid.scene, grid.joints);
    EXPECT_NEAR(cost.crossings, 1.5e6, 0.1e6);
    EXPECT_NEAR(cost.seconds, 6, 0.4);
    const auto has_none = [&](const Grid& other) {
        return blocks::expected_cost(grid.scene, other.joints).seconds == 0;
    };
    EXPECT_TRUE(has_none(Grid(1, 100)));
    EXPECT_TRUE(has_none(Grid(300, 100)));   // little
    EXPECT_TRUE(has_none(Grid(10000, 100))); // refused
}

TEST(crossings, too_many_are_refused_before_cutting)
{
    Grid grid(10000, 100);
    EXPECT_NE(refusal_of(grid).find("about 1e+08 crossings of joints in the section; expected at most 5e+07"),
              std::string::npos)
        << refusal_of(grid);
    for (int more = 0; more < 5000; ++more) // cross each other and all upright ones
        add_joint(grid.joints, {0, 0.02 * more}, {100, 100 - 0.02 * more}, 0);
    EXPECT_NE(refusal_of(grid).find("joint set \"level\". Increase its spacing"), std::string::npos)
        << refusal_of(grid);
    grid.scene.joint_sets[0].kind = SetKind::segments;
    EXPECT_NE(refusal_of(grid).find("Reduce its density or its length"), std::string::npos)
        << refusal_of(grid);
    EXPECT_THROW(blocks::cut(grid.scene, grid.joints), input_error);
}

TEST(crossings, short_joints_are_as_many_as_they_cross_few)
{
    EXPECT_EQ(refusal_of(Grid(100000, 1)), "");
}

} // namespace crossings_test
