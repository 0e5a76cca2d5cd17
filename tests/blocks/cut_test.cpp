// Small sections whose blocks can be counted by hand.

#include "section.hpp"

#include "blocks/extend.hpp"
#include "model/polygon.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace cut_test
{

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

// As they are equal, files of the same section would differ.
TEST(cut, minus_zero_becomes_zero)
{
    const Scene scene = section({{-0.0, -0.0}, {10, -0.0}, {10, 10}, {-0.0, 10}}, 0.1);
    Joints joints;
    add_joint(joints, {-0.0, 4}, {10, 4});
    const Blocks blocks = blocks::cut(scene, joints);
    EXPECT_EQ(faults(scene, blocks), "");
    for (const Vector2d& v : blocks.vertex)
        for (const double x : v)
            EXPECT_FALSE(x == 0 && std::signbit(x));
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

// Two columns with a step between their feet and one between their heads: what divides them ends at corners
// of the outline, whose sides go on where it ends. In doubles these hardly ever lie on one line.
TEST(cut, a_joint_that_ends_at_corners_in_line_with_their_sides_divides_the_rock)
{
    for (int degrees = 1; degrees < 360; degrees += 7) {
        const double angle = degrees * std::numbers::pi / 180;
        const auto turned = [&](double x, double y) {
            const double exact[] = {x * std::cos(angle) - y * std::sin(angle),
                                    x * std::sin(angle) + y * std::cos(angle)};
            return Vector2d(std::round(exact[0] * 1e9) / 1e9, std::round(exact[1] * 1e9) / 1e9);
        };
        const Scene scene = section({turned(0, 0), turned(10, 0), turned(10, 1), turned(20, 1),
                                     turned(20, 36), turned(10, 36), turned(10, 31), turned(0, 31)},
                                    0.1);
        Joints joints;
        add_joint(joints, turned(10, 1), turned(10, 31));
        const Blocks blocks = blocks::cut(scene, joints);
        EXPECT_EQ(faults(scene, blocks), "");
        EXPECT_EQ(blocks.block_area.size(), 2u) << degrees;
        EXPECT_EQ(blocks.report.pruned_length, 0) << degrees;
    }
}

// A joint of the scene with four others that lie on it, with a gap, in any order: each replaces its part. Their ends are rounded to 1e-9 m,
// so they are not exactly on it.
TEST(cut, joints_on_a_joint_replace_its_parts_in_any_order)
{
    const double ends[][2] = {{2, 3.5}, {3.5, 5}, {6, 7.5}, {7.5, 9}};
    for (int degrees = 1; degrees < 90; degrees += 4) {
        const double angle = degrees * std::numbers::pi / 180;
        const Vector2d along(std::cos(angle), std::sin(angle)), from(-10, -10);
        const auto at = [&](double s) {
            const Vector2d exact = from + 2 * s * along;
            return Vector2d(std::round(exact.x() * 1e9) / 1e9, std::round(exact.y() * 1e9) / 1e9);
        };
        Scene scene = section({{-20, -20}, {20, -20}, {20, 20}, {-20, 20}}, 0.01);
        scene.joints.resize(6);
        std::vector<int> order = {0, 1, 2, 3};
        do {
            Joints joints;
            add_joint(joints, at(-20), at(40));
            for (const int part : order)
                add_joint(joints, at(ends[part][0]), at(ends[part][1]));
            const Vector2d across(-along.y(), along.x()); // no end in the rock
            add_joint(joints, at(5.5) - 60 * across, at(5.5) + 60 * across);
            const Blocks blocks = blocks::cut(scene, joints);
            ASSERT_EQ(faults(scene, blocks), "");
            ASSERT_EQ(blocks.block_area.size(), 4u) << degrees;
            ASSERT_EQ(blocks.report.pruned_length, 0) << degrees;
            std::vector<double> length(6);
            for (std::size_t e = 0; e < blocks.edge_joint.size(); ++e)
                if (const Index joint = blocks.edge_joint[e]; joint >= 0)
                    length[static_cast<std::size_t>(joint)] +=
                        (blocks.vertex[blocks.edge_vertex[e][1]] - blocks.vertex[blocks.edge_vertex[e][0]])
                            .norm();
            for (std::size_t i = 0; i < order.size(); ++i)
                ASSERT_NEAR(length[1 + i], 2 * (ends[order[i]][1] - ends[order[i]][0]), 1e-6) << degrees;
        } while (std::next_permutation(order.begin(), order.end()));
    }
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

TEST(cut, stage_outlines_and_rock_borders_are_bonded)
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

    scene.boundaries[1].to = {0.5, 7};
    try {
        blocks::cut(scene, joints);
        ADD_FAILURE() << "a boundary inside the section";
    } catch (const std::runtime_error& error) {
        EXPECT_EQ(std::string(error.what())
                      .find("boundary 2: its end [0.5, 7] m lies 0.5 m off the section's outline"),
                  0u)
            << error.what();
    }
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

// A joint that cuts off less than the limit at a corner of the outline, the first or another one, becomes this corner.
TEST(cut, a_joint_that_cuts_off_a_corner_becomes_the_corner)
{
    for (std::size_t first = 0; first < square.size(); ++first)
        for (const Vector2d& corner : square) {
            Polygon outline = square;
            std::rotate(outline.begin(), outline.begin() + static_cast<std::ptrdiff_t>(first), outline.end());
            const Scene scene = section(outline, 0.5);
            const Vector2d in(corner.x() > 5 ? -1 : 1, corner.y() > 5 ? -1 : 1);
            Joints joints;
            add_joint(joints, corner + Vector2d(1.25 * in.x(), -in.y()),
                      corner + Vector2d(-in.x(), 1.25 * in.y()));
            const Blocks blocks = blocks::cut(scene, joints);
            EXPECT_EQ(faults(scene, blocks), "");
            EXPECT_EQ(blocks.block_area, std::vector<double>{100}) << corner.transpose() << ' ' << first;
        }
}

// A joint that meets the outline nearer than the limit to a corner, the first or another one, ends in this corner.
TEST(cut, a_joint_that_meets_the_outline_beside_a_corner_ends_in_it)
{
    for (std::size_t first = 0; first < square.size(); ++first)
        for (const Vector2d& corner : square)
            for (const bool is_transposed : {false, true}) {
                Polygon outline = square;
                std::rotate(outline.begin(), outline.begin() + static_cast<std::ptrdiff_t>(first),
                            outline.end());
                const Scene scene = section(outline, 0.5);
                const auto place = [&](double along, double across) {
                    const Vector2d in(corner.x() > 5 ? -1 : 1, corner.y() > 5 ? -1 : 1);
                    return Vector2d(corner + in.cwiseProduct(is_transposed ? Vector2d(across, along)
                                                                           : Vector2d(along, across)));
                };
                Joints joints;
                add_joint(joints, place(0.3, 0), place(5.3, 10));
                const Blocks blocks = blocks::cut(scene, joints);
                EXPECT_EQ(faults(scene, blocks), "");
                ASSERT_EQ(blocks.block_area.size(), 2u);
                EXPECT_NEAR(std::min(blocks.block_area[0], blocks.block_area[1]), 10 * 5.3 / 2, 1e-9)
                    << corner.transpose() << ' ' << first << ' ' << is_transposed;
                EXPECT_NEAR(blocks.report.largest_move, 0.3, 1e-9);
                EXPECT_EQ(blocks.report.merged_vertices, 1);
            }
}

// A corner that points at a joint, in every part of it. The joint then goes through the corner, and what is above it are two blocks.
TEST(cut, a_joint_close_to_a_corner_goes_through_it)
{
    for (const double end : {10.0, 200.0})
        for (int i = 0; i < 20; ++i)
            for (const bool is_reversed : {false, true}) {
                const double x = end * (0.1 + i * 0.042); // the joint's ends are at 0 and there
                const Scene scene = section(
                    {{0, 0}, {end, 0}, {end, 10}, {x + 0.4, 10}, {x, 5.2}, {x - 0.4, 10}, {0, 10}}, 0.5);
                Joints joints;
                add_joint(joints, {is_reversed ? end + 1 : -1.0, 5}, {is_reversed ? -1.0 : end + 1, 5});
                const Blocks blocks = blocks::cut(scene, joints);
                EXPECT_EQ(faults(scene, blocks), "");
                EXPECT_EQ(blocks.block_area.size(), 3u) << x;
                EXPECT_NEAR(blocks.report.largest_move, 0.2, 1e-12);
            }
}

// Two joints from one place, half a degree apart where the limit is 1 degree, from 50 to 200 m long: the far end of one moves to
// the other if it is not farther than five shortest edges.
TEST(cut, a_narrow_wedge_is_closed_unless_its_end_is_too_wide)
{
    for (const double length : {50.0, 56.0, 59.0, 200.0}) {
        const Scene scene = section({{0, 0}, {length, 0}, {length, 100}, {0, 100}}, 0.1);
        const double wide = length * std::tan(0.5 * std::numbers::pi / 180);
        Joints joints;
        add_joint(joints, {0, 50}, {length, 50});
        add_joint(joints, {0, 50}, {length, 50 + wide});
        const Blocks blocks = blocks::cut(scene, joints);
        EXPECT_EQ(faults(scene, blocks), "");
        const bool is_closed = wide < 0.5;
        EXPECT_EQ(blocks.block_area.size(), is_closed ? 2u : 3u) << wide;
        EXPECT_NEAR(blocks.report.smallest_angle * 180 / std::numbers::pi, is_closed ? 90 - 0.5 : 0.5,
                    is_closed ? 0.51 : 1e-9);
    }
}

// Blocks whose angles are all different, the narrowest behind wide ones.
TEST(cut, the_smallest_angle_is_the_narrowest_of_all_corners)
{
    for (const double narrow : {50.0, 60.0, 70.0, 80.0})
        for (const double scale : {0.3, 1.0, 40.0}) {
            // A quadrilateral with angles of 85, 100, `narrow` degrees and the rest, one corner after the other the first.
            const auto direction = [](double degrees) {
                return Vector2d(std::cos(degrees * std::numbers::pi / 180),
                                std::sin(degrees * std::numbers::pi / 180));
            };
            const Vector2d a(0, 0), b(10, 0), c = b + 12 * direction(80);
            // From c to the line through a at 85 degrees, so that the angle at c is `narrow`.
            const Vector2d along_ad = direction(85), along_cd = direction(260 - narrow);
            const double s = cross(c - a, along_cd) / cross(along_ad, along_cd);
            ASSERT_GT(s, 0);
            std::vector<Vector2d> corners{a, b, c, a + s * along_ad};
            for (int first = 0; first < 4; ++first) {
                Polygon outline;
                for (int i = 0; i < 4; ++i)
                    outline.push_back(scale * corners[(first + i) % 4]);
                const Blocks blocks = blocks::cut(section(outline, 0.01), {});
                EXPECT_NEAR(blocks.report.smallest_angle * 180 / std::numbers::pi, narrow, 1e-9);
            }
        }
}

// Crossings are rounded to doubles, which is no move: also in a section of a kilometre.
TEST(cut, nothing_moves_where_nothing_is_close)
{
    const Scene scene = section({{0, 0}, {1000, 0}, {1000, 1000}, {0, 1000}}, 0.1);
    Joints joints;
    for (int i = 1; i < 8; ++i) {
        add_joint(joints, {-10, 100.0 * i + std::sqrt(i)}, {1010, 100.0 * i - std::sqrt(i)});
        add_joint(joints, {100.0 * i + std::sqrt(2 * i), -10}, {100.0 * i - std::sqrt(i), 1010});
    }
    const Blocks blocks = blocks::cut(scene, joints);
    EXPECT_EQ(faults(scene, blocks), "");
    EXPECT_EQ(blocks.block_area.size(), 64u);
    EXPECT_EQ(blocks.report.largest_move, 0);
}

TEST(cut, a_joint_that_ends_inside_a_block_may_be_carried_on_as_rock_bridge)
{
    Scene scene = section(square, 0.1);
    scene.cutting.dangling_ends = DanglingEnds::extend;
    Joints joints;
    add_joint(joints, {0, 5}, {10, 5});
    add_joint(joints, {4, 0}, {4, 8}); // 2 m on to the outline
    add_joint(joints, {6, 7}, {8, 9}); // to the second and the outline
    const Blocks blocks = blocks::cut(scene, joints);
    EXPECT_EQ(faults(scene, blocks), "");
    EXPECT_EQ(blocks.block_area.size(), 5u);
    const JointFates& fates = blocks.fates;
    EXPECT_EQ(fates.dangling_end, std::vector<double>(3, 0.0));
    EXPECT_NEAR(fates.extended[0], 0, 1e-12);
    EXPECT_NEAR(fates.extended[1], 2, 1e-12);
    EXPECT_NEAR(fates.extended[2], 2 * std::sqrt(2.0) + std::sqrt(2.0), 1e-12); // to (4, 5) and to (9, 10)
    // A rock bridge is no joint: of the piece of the second joint above the first, 3 m of 5 are.
    for (std::size_t e = 0; e < blocks.edge_vertex.size(); ++e) {
        const Vector2d &a = blocks.vertex[blocks.edge_vertex[e][0]],
                       &b = blocks.vertex[blocks.edge_vertex[e][1]];
        if (blocks.edge_joint[e] == 1 && std::max(a.y(), b.y()) > 9) {
            EXPECT_NEAR(blocks.edge_joint_fraction[e], 3.0 / 5, 1e-12);
        }
        if (blocks.edge_joint[e] == 2) {
            EXPECT_NEAR(blocks.edge_joint_fraction[e], 2.0 / 5, 1e-12);
        }
    }
}

TEST(cut, a_joint_that_meets_another_is_not_carried_on)
{
    Scene scene = section(square, 0.1);
    scene.cutting.dangling_ends = DanglingEnds::extend;
    Joints joints;
    add_joint(joints, {0, 5}, {10, 5});
    add_joint(joints, {4, 0}, {4, 5 - 1e-9}); // but for a hair
    add_joint(joints, {-3, 8}, {7, 8});       // from outside
    const Blocks blocks = blocks::cut(scene, joints);
    EXPECT_EQ(faults(scene, blocks), "");
    EXPECT_EQ(blocks.block_area.size(), 4u);
    EXPECT_EQ(blocks.fates.extended[1], 0);
    EXPECT_NEAR(blocks.fates.extended[2], 3, 1e-12);
}

TEST(cut, what_becomes_of_each_joint_is_told_in_metres)
{
    const Scene scene = section(square, 0.1);
    Joints joints;
    add_joint(joints, {-2, 5}, {13, 5});      // 5 m outside
    add_joint(joints, {4, 0}, {4, 8});        // 3 m dangling end
    add_joint(joints, {6, 7}, {8, 9});        // nothing but dangling end
    add_joint(joints, {2, 5}, {4, 5});        // on the first
    add_joint(joints, {3, 10}, {9, 10});      // on the outline
    add_joint(joints, {11, 1}, {12, 3});      // outside
    add_joint(joints, {0, 5.04}, {10, 5.04}); // so near to the first that they become one
    add_joint(joints, {7, 0}, {7, 5});        // simply there
    const Blocks blocks = blocks::cut(scene, joints);
    EXPECT_EQ(faults(scene, blocks), "");
    const JointFates& fates = blocks.fates;
    const auto code = [](JointFate fate) { return static_cast<Index>(fate); };
    EXPECT_EQ(fates.fate,
              (std::vector<Index>{code(JointFate::clipped), code(JointFate::trimmed),
                                  code(JointFate::dropped), code(JointFate::kept), code(JointFate::dropped),
                                  code(JointFate::dropped), code(JointFate::kept), code(JointFate::kept)}));
    const auto expect_near = [](const std::vector<double>& lengths, const std::vector<double>& wanted) {
        ASSERT_EQ(lengths.size(), wanted.size());
        for (std::size_t j = 0; j < wanted.size(); ++j)
            EXPECT_NEAR(lengths[j], wanted[j], 0.1) << "joint " << j;
    };
    expect_near(fates.kept, {10, 5, 0, 0, 0, 0, 0, 5});
    expect_near(fates.shared, {0, 0, 0, 2, 0, 0, 10, 0});
    expect_near(fates.outside, {5, 0, 0, 0, 0, std::sqrt(5.0), 0, 0});
    expect_near(fates.on_outline, {0, 0, 0, 0, 6, 0, 0, 0});
    expect_near(fates.dangling_end, {0, 3, std::sqrt(8.0), 0, 0, 0, 0, 0});
    expect_near(fates.merged, {0, 0, 0, 0, 0, 0, 0, 0});
    EXPECT_EQ(fates.extended, std::vector<double>(8, 0.0));

    // The joints of the edge from x = 2 to x = 4: its own first, and none lost.
    bool found = false;
    for (std::size_t e = 0; e < blocks.edge_vertex.size(); ++e) {
        const Index first = blocks.edge_share[e], end = blocks.edge_share[e + 1];
        EXPECT_EQ(end > first, blocks.edge_joint[e] >= 0);
        if (end > first) {
            EXPECT_EQ(blocks.share_joint[first], blocks.edge_joint[e]);
            EXPECT_EQ(blocks.share_fraction[first], blocks.edge_joint_fraction[e]);
        }
        if (end - first == 3) {
            found = true;
            EXPECT_EQ(
                std::vector<Index>(blocks.share_joint.begin() + first, blocks.share_joint.begin() + end),
                (std::vector<Index>{0, 3, 6}));
        }
    }
    EXPECT_TRUE(found);
}

TEST(cut, a_section_may_have_holes)
{
    Scene scene = section({{0, 0}, {20, 0}, {20, 20}, {12, 20}, {12, 12}, {8, 12}, {8, 20}, {0, 20}}, 0.1);
    scene.holes = {{{4, 4}, {7, 4}, {7, 7}, {4, 7}}, {{13, 4}, {13, 8}, {17, 8}, {17, 4}}};
    scene.boundaries = {{{4, 7}, {7, 7}, true, true, ""}};
    Joints joints;
    add_joint(joints, {-1, 5}, {21, 5}); // through both
    add_joint(joints, {2, 10}, {18, 10});
    add_joint(joints, {2, 8}, {2, 12}); // with nothing to hold on to
    const Blocks blocks = blocks::cut(scene, joints);
    EXPECT_EQ(faults(scene, blocks), "");
    EXPECT_EQ(blocks.block_area.size(), 2u);
    EXPECT_NEAR(total_area(blocks), 400 - 32 - 9 - 16, 1e-9);
    EXPECT_NEAR(blocks.fates.outside[0], 2 + 3 + 4, 1e-9);
    EXPECT_EQ(count(blocks, EdgeKind::joint), 3u);
    EXPECT_EQ(std::count(blocks.edge_boundary.begin(), blocks.edge_boundary.end(), 0), 1);
    Joints across;
    add_joint(across, {2, 5}, {5, 5}); // from nowhere into a hole: no edge
    EXPECT_EQ(blocks::cut(scene, across).block_area.size(), 1u);
    scene.cutting.dangling_ends = DanglingEnds::extend; // carried on to the outline, it alone parts nothing
    EXPECT_EQ(blocks::cut(scene, across).block_area.size(), 1u);
}

// A block that hangs in another by one corner: the outer one's ring would touch itself there.
TEST(cut, a_block_that_touches_the_border_of_another_in_one_corner_is_a_hole_in_it)
{
    const Scene scene = section(square, 0.1);
    Joints joints;
    add_joint(joints, {0, 5}, {10, 5});
    add_joint(joints, {5, 5}, {3, 9});
    add_joint(joints, {5, 5}, {7, 9});
    add_joint(joints, {3, 8}, {7, 8});
    const Blocks blocks = blocks::cut(scene, joints);
    EXPECT_EQ(faults(scene, blocks), "");
    ASSERT_EQ(blocks.block_area.size(), 3u);
    Index with_hole = -1;
    for (Index b = 0; b < 3; ++b)
        if (blocks.block_ring[b + 1] - blocks.block_ring[b] == 2)
            with_hole = b;
    ASSERT_GE(with_hole, 0);
    EXPECT_NEAR(blocks.block_area[with_hole], 50 - 4.5, 0.1);
}

// Beside the nearest of all lines, one after another.
TEST(cut, extensions_end_at_the_nearest_line)
{
    std::mt19937 random(11);
    std::uniform_real_distribution<double> place(0, 100), length(1, 12), turn(0, 2 * std::numbers::pi);
    std::vector<blocks::Segment> lines;
    for (int i = 0; i < 500; ++i) {
        const double angle = turn(random);
        const Vector2d from(place(random), place(random));
        lines.push_back({from, from + length(random) * Vector2d(std::cos(angle), std::sin(angle))});
    }
    const double reach = 0.01;
    const auto extended = blocks::extensions_to_next(lines, 0, reach, [](const Vector2d&) { return true; });
    int far = 0;
    for (std::size_t i = 0; i < lines.size(); ++i)
        for (const bool beyond : {false, true}) {
            const Vector2d end = beyond ? lines[i].to : lines[i].from,
                           along = (end - (beyond ? lines[i].from : lines[i].to)).normalized();
            const Vector2d start = end - 2 * reach * along;
            double nearest = 1e9;
            for (std::size_t j = 0; j < lines.size(); ++j) {
                const Vector2d d = lines[j].to - lines[j].from, o = lines[j].from - start;
                const double below = along.x() * d.y() - along.y() * d.x();
                const double ahead = (o.x() * d.y() - o.y() * d.x()) / below,
                             on_line = (o.x() * along.y() - o.y() * along.x()) / below;
                if (j != i && ahead >= 0 && on_line >= 0 && on_line <= 1)
                    nearest = std::min(nearest, ahead);
            }
            const double wanted = nearest > 1e8 || nearest <= 2 * reach ? 0 : nearest - reach;
            ASSERT_NEAR(beyond ? extended[i].beyond : extended[i].before, wanted, 1e-9) << i;
            far += wanted > 10;
        }
    EXPECT_GT(far, 50);
}

} // namespace cut_test
