// Small sections whose blocks can be counted by hand.

#include "section.hpp"

#include <gtest/gtest.h>

using namespace jointcreep;
using namespace jointcreep::test;
using Eigen::Vector2d;

namespace
{

const Polygon square = {{0, 0}, {10, 0}, {10, 10}, {0, 10}};

std::size_t count(const Blocks& blocks, EdgeKind kind)
{
    std::size_t n = 0;
    for (const Index k : blocks.edge_kind)
        n += k == static_cast<Index>(kind) ? 1 : 0;
    return n;
}

} // namespace

TEST(cut, a_section_without_joints_is_one_block)
{
    const Scene scene = section(square, 0.1);
    const Blocks blocks = blocks::cut(scene, {});
    EXPECT_EQ(faults(scene, blocks), "");
    ASSERT_EQ(blocks.block_area.size(), 1u);
    EXPECT_EQ(blocks.block_area[0], 100);
    EXPECT_EQ(blocks.edge_vertex.size(), 4u);
}

TEST(cut, a_clockwise_outline_gives_the_same_blocks)
{
    const Scene scene = section({{0, 10}, {10, 10}, {10, 0}, {0, 0}}, 0.1);
    EXPECT_EQ(faults(scene, blocks::cut(scene, {})), "");
}

TEST(cut, two_crossing_joints_make_four_blocks)
{
    const Scene scene = section(square, 0.1);
    Joints joints;
    add_joint(joints, {-1, 4}, {11, 4});
    add_joint(joints, {3, 12}, {3, -2});
    const Blocks blocks = blocks::cut(scene, joints);
    EXPECT_EQ(faults(scene, blocks), "");
    EXPECT_EQ(blocks.block_area.size(), 4u);
    EXPECT_EQ(count(blocks, EdgeKind::joint), 4u);
    for (std::size_t e = 0; e < blocks.edge_joint.size(); ++e) {
        if (blocks.edge_joint[e] < 0)
            continue;
        EXPECT_EQ(blocks.edge_joint_fraction[e], 1);
        // Joint edges run the way their joint runs.
        const Vector2d along =
            blocks.vertex[blocks.edge_vertex[e][1]] - blocks.vertex[blocks.edge_vertex[e][0]];
        EXPECT_GT(along.dot(joints.to[blocks.edge_joint[e]] - joints.from[blocks.edge_joint[e]]), 0);
    }
}

TEST(cut, a_joint_that_ends_inside_a_block_is_cut_back_and_reported)
{
    const Scene scene = section(square, 0.1);
    Joints joints;
    add_joint(joints, {0, 5}, {10, 5});
    add_joint(joints, {4, 0}, {4, 8}); // reaches 3 m beyond the first
    add_joint(joints, {6, 7}, {8, 9}); // free at both ends: gone
    const Blocks blocks = blocks::cut(scene, joints);
    EXPECT_EQ(faults(scene, blocks), "");
    EXPECT_EQ(blocks.block_area.size(), 3u);
    EXPECT_NEAR(blocks.report.pruned_length, 3 + std::sqrt(8.0), 3 * 0.1 + 1e-9); // their overlaps with it
}

TEST(cut, an_edge_knows_how_much_of_it_is_joint)
{
    const Scene scene = section(square, 0.1);
    Joints joints;
    add_joint(joints, {-1, 5}, {11, 5});
    joints.trace_joint = {0, 0};
    joints.trace_from = {{1, 5}, {6, 5}};
    joints.trace_to = {{3, 5}, {11, 5}};
    add_joint(joints, {4, -1}, {4, 11});
    const Blocks blocks = blocks::cut(scene, joints);
    EXPECT_EQ(faults(scene, blocks), "");
    std::vector<double> fractions;
    for (std::size_t e = 0; e < blocks.edge_joint.size(); ++e)
        if (blocks.edge_joint[e] == 0)
            fractions.push_back(blocks.edge_joint_fraction[e]);
    std::sort(fractions.begin(), fractions.end());
    ASSERT_EQ(fractions.size(), 2u);
    EXPECT_NEAR(fractions[0], 2.0 / 4, 1e-12); // x 0..4: trace 1..3
    EXPECT_NEAR(fractions[1], 4.0 / 6, 1e-12); // x 4..10: trace 6..10
}

TEST(cut, stage_outlines_and_rock_borders_are_welded)
{
    Scene scene = section(square, 0.1);
    scene.rocks.push_back({"weak", 2600, 1e10, 0.25, std::nullopt});
    scene.regions.push_back({"weak", {{-1, 6}, {11, 6}, {11, 11}, {-1, 11}}});
    scene.stages.push_back({"cut", 1, {{{5, 3}, {12, 3}, {12, 12}, {5, 12}}}});
    Joints joints;
    add_joint(joints, {0, 1}, {10, 1});
    const Blocks blocks = blocks::cut(scene, joints);
    EXPECT_EQ(faults(scene, blocks), "");
    ASSERT_EQ(blocks.block_area.size(), 5u);
    EXPECT_EQ(count(blocks, EdgeKind::joint), 1u);
    double weak = 0, removed = 0, both = 0;
    for (std::size_t b = 0; b < 5; ++b) {
        weak += blocks.block_rock[b] == 1 ? blocks.block_area[b] : 0;
        removed += blocks.block_stage[b] == 0 ? blocks.block_area[b] : 0;
        both += blocks.block_rock[b] == 1 && blocks.block_stage[b] == 0 ? blocks.block_area[b] : 0;
    }
    EXPECT_NEAR(weak, 40, 1e-12);
    EXPECT_NEAR(removed, 35, 1e-12);
    EXPECT_NEAR(both, 20, 1e-12);
}

TEST(cut, a_block_within_a_block_is_a_hole_in_it)
{
    Scene scene = section(square, 0.1);
    scene.stages.push_back({"tunnel", 1, {{{4, 4}, {6, 4}, {6, 6}, {4, 6}}}});
    const Blocks blocks = blocks::cut(scene, {});
    EXPECT_EQ(faults(scene, blocks), "");
    ASSERT_EQ(blocks.block_area.size(), 2u);
    const Index outer = blocks.block_area[0] > blocks.block_area[1] ? 0 : 1;
    EXPECT_NEAR(blocks.block_area[outer], 96, 1e-12);
    EXPECT_EQ(blocks.block_ring[outer + 1] - blocks.block_ring[outer], 2);
    EXPECT_EQ(blocks.block_stage[outer], -1);
    EXPECT_EQ(blocks.block_stage[1 - outer], 0);
}

TEST(cut, boundary_conditions_find_their_edges)
{
    Scene scene = section(square, 0.1);
    scene.boundaries = {{{0, 0}, {10, 0}, false, true, ""}, {{0, 2}, {0, 7}, true, false, ""}};
    Joints joints;
    add_joint(joints, {5, -1}, {5, 11});
    const Blocks blocks = blocks::cut(scene, joints);
    EXPECT_EQ(faults(scene, blocks), "");
    std::array<double, 2> held{};
    for (std::size_t e = 0; e < blocks.edge_vertex.size(); ++e)
        if (blocks.edge_boundary[e] >= 0)
            held[blocks.edge_boundary[e]] +=
                (blocks.vertex[blocks.edge_vertex[e][0]] - blocks.vertex[blocks.edge_vertex[e][1]]).norm();
    EXPECT_NEAR(held[0], 10, 1e-12);
    EXPECT_NEAR(held[1], 5, 1e-12);

    scene.boundaries[0].to = {10, 1};
    EXPECT_THROW(blocks::cut(scene, joints), std::runtime_error);
}

TEST(cut, vertices_closer_than_the_limit_are_merged_and_the_outline_keeps_its_corners)
{
    const Scene scene = section(square, 0.5);
    Joints joints;
    add_joint(joints, {0.2, -1}, {0.2, 11}); // along the left side, 0.2 m inside: becomes part of it
    add_joint(joints, {-1, 5}, {11, 5});
    add_joint(joints, {-1, 5.3}, {11, 5.3}); // one joint with the last
    const Blocks blocks = blocks::cut(scene, joints);
    EXPECT_EQ(faults(scene, blocks), "");
    EXPECT_EQ(blocks.block_area.size(), 2u);
    EXPECT_GE(blocks.report.shortest_edge, 0.5);
    EXPECT_LE(blocks.report.largest_move, 0.5);
    EXPECT_NEAR(blocks.report.merged_block_area, 0.2 * 9.7 + 0.3 * 10, 0.2);
    for (const Vector2d& corner : square)
        EXPECT_NE(std::find(blocks.vertex.begin(), blocks.vertex.end(), corner), blocks.vertex.end());
}
