// Networks that break cutters: near-parallel joints, many joints through one point, joints on the boundary
// and on each other, gaps of a nanometre, slanting outlines. Nothing crashes, no area is lost, no edge is
// shorter than the limit but between corners of the outline itself.

#include "section.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <random>

namespace hard_networks_test
{

using namespace jointcreep;
using namespace jointcreep::test;
using Eigen::Vector2d;

namespace
{

const Polygon slope = {{0, 0}, {100, 0}, {100, 37}, {71.3, 39.1}, {52.7, 80.9}, {0, 83.3}};

void expect_sound(const Scene& scene, const Joints& joints, const std::string& what)
{
    const Blocks blocks = blocks::cut(scene, joints);
    EXPECT_EQ(faults(scene, blocks), "") << what;
    EXPECT_GE(blocks.report.shortest_edge, scene.cutting.shortest_edge * (1 - 1e-9)) << what;
    EXPECT_EQ(lost_length(joints, blocks), "") << what;
}

} // namespace

TEST(hard_networks, near_parallel_joints)
{
    const Scene scene = section(slope, 0.05);
    for (const double angle : {1e-1, 1e-3, 1e-6, 1e-9, 1e-12}) {
        Joints joints;
        for (int i = 0; i < 20; ++i)
            add_joint(joints, {-5, 20 + 0.01 * i}, {105, 20 + 0.01 * i + 110 * angle * i});
        expect_sound(scene, joints, "angle " + std::to_string(angle));
    }
}

TEST(hard_networks, fifty_joints_through_one_point)
{
    const Scene scene = section(slope, 0.05);
    Joints joints;
    for (int i = 0; i < 50; ++i) {
        const double a = std::numbers::pi * i / 50;
        const Vector2d d(std::cos(a), std::sin(a));
        add_joint(joints, Vector2d(30.3, 40.4) - 200 * d, Vector2d(30.3, 40.4) + 200 * d);
    }
    expect_sound(scene, joints, "star");
}

TEST(hard_networks, joints_on_the_outline_and_on_each_other)
{
    const Scene scene = section(slope, 0.05);
    Joints joints;
    for (std::size_t i = 0; i < slope.size(); ++i)
        add_joint(joints, slope[i], slope[(i + 1) % slope.size()]);
    add_joint(joints, {52.7, 80.9}, {20, 0});
    add_joint(joints, {52.7, 80.9}, {20, 0});
    add_joint(joints, (Vector2d(52.7, 80.9) + Vector2d(20, 0)) / 2, {20, 0});
    // From the middle of the slanting face, which no double lies on exactly.
    add_joint(joints, (slope[3] + slope[4]) / 2, {0, 11});
    expect_sound(scene, joints, "outline");
    EXPECT_EQ(blocks::cut(scene, joints).block_area.size(), 4u);
}

TEST(hard_networks, a_joint_along_a_slanting_side_of_the_outline_but_for_rounding)
{
    // Beyond its ends the joint is drawn a little longer, and then no longer lies on the side exactly.
    const Scene scene = section(slope, 0.1);
    Joints joints;
    add_joint(joints, {34.9991928, 64.9993439}, {30, 105});
    add_joint(joints, {40, 5}, {40, 90});
    add_joint(joints, {0, 83.3}, {52.7, 80.9});
    expect_sound(scene, joints, "along the top");
}

// Turned by any angle the joint lies on the side but for rounding, and comes out of it at the corner, or
// beside it.
TEST(hard_networks, a_joint_along_a_side_goes_on_into_the_rock)
{
    for (int degrees = 0; degrees < 360; ++degrees) {
        const Eigen::Rotation2Dd turn(degrees * std::numbers::pi / 180);
        Polygon step;
        for (const Vector2d& corner :
             {Vector2d(0, 0), {14, 0}, {14, 2}, {4, 2}, {4, 4}, {1, 4}, {1, 2}, {0, 2}})
            step.push_back(turn * corner);
        const Scene scene = section(step, 0.04);
        Joints joints;
        add_joint(joints, turn * Vector2d(0.5, 2), turn * Vector2d(6, 2));
        const std::string what = std::to_string(degrees) + " degrees";
        expect_sound(scene, joints, what);
        const Blocks blocks = blocks::cut(scene, joints);
        EXPECT_EQ(blocks.block_area.size(), 2u) << what;
        EXPECT_NEAR(blocks.fates.kept[0], 3, 1e-9) << what;
    }
}

// Joints along both sides of a sharp notch cross these at its tip, where rounding lets the two sides share a
// piece. The corner must stay: merging would then close the notch.
TEST(hard_networks, joints_along_both_sides_of_a_sharp_notch)
{
    std::mt19937 random(11);
    std::uniform_real_distribution<double> unit(0, 1);
    for (const double wide : {0.1, 1.0, 10.0, 30.0})
        for (const double shortest_edge : {1e-6, 0.02, 0.1, 0.5, 1.5})
            for (int i = 0; i < 40; ++i) {
                const Vector2d tip = i % 4 == 0 ? Vector2d(50, 30)
                                                : Vector2d(45 + unit(random), 30 + unit(random)),
                               left(tip.x() - wide, 100), right(tip.x() + wide, 100);
                Scene scene =
                    section({{0, 0}, {100, 0}, {100, 100}, right, tip, left, {0, 100}}, shortest_edge);
                scene.cutting.dangling_ends = i % 2 == 0 ? DanglingEnds::prune : DanglingEnds::extend;
                Joints joints;
                add_joint(joints, tip, left);
                add_joint(joints, right, tip);
                for (int j = 0; j < i % 8; ++j) {
                    const Vector2d side = j % 2 == 0 ? left : right, from = tip + unit(random) * (side - tip);
                    if (j % 4 < 2)
                        add_joint(joints, from, side);
                    else
                        add_joint(joints, from, {100 * unit(random), 100 * unit(random)});
                }
                const std::string what = std::to_string(wide) + " m, limit " + std::to_string(shortest_edge) +
                                         " m, " + std::to_string(i);
                const Blocks blocks = blocks::cut(scene, joints);
                EXPECT_EQ(faults(scene, blocks), "") << what;
                EXPECT_EQ(lost_length(joints, blocks), "") << what;
                for (const Vector2d& corner : scene.outline)
                    EXPECT_EQ(std::ranges::count(blocks.vertex, corner), 1) << what;
            }
}

TEST(hard_networks, gaps_of_a_nanometre)
{
    const Scene scene = section(slope, 0.05);
    Joints joints;
    for (int i = 0; i < 10; ++i) {
        add_joint(joints, {10.0 + i, 20}, {10.0 + i, 60 - 1e-9 * i});
        add_joint(joints, {5, 60 + 1e-9 * i}, {30, 60});
        add_joint(joints, {5, 20 - 1e-9}, {30, 20});
    }
    expect_sound(scene, joints, "gaps");
}

RC_GTEST_PROP(hard_networks, random_lines_of_all_kinds, ())
{
    const Scene scene = section(slope, *rc::gen::element(0.02, 0.1, 0.5));
    const int n = *rc::gen::inRange(1, 60);
    std::mt19937 random(*rc::gen::arbitrary<unsigned>());
    std::uniform_real_distribution<double> x(-10, 110), nudge(-1e-3, 1e-3);
    Joints joints;
    for (int i = 0; i < n; ++i) {
        // Places on a coarse lattice, so that joints meet, overlap and run along the outline, often by a
        // hair.
        const auto place = [&] {
            Vector2d p(std::round(x(random) / 5) * 5, std::round(x(random) / 5) * 5);
            if (random() % 2 == 0)
                p += Vector2d(nudge(random), nudge(random));
            return random() % 8 == 0 ? slope[random() % slope.size()] : p;
        };
        const Vector2d a = place(), b = place();
        if ((a - b).norm() > 1)
            add_joint(joints, a, b);
    }
    const Blocks blocks = blocks::cut(scene, joints);
    RC_ASSERT(faults(scene, blocks) == "");
    RC_ASSERT(blocks.report.shortest_edge >= scene.cutting.shortest_edge * (1 - 1e-9));
    RC_ASSERT(lost_length(joints, blocks) == "");
}

// With next to no merging the lengths must add up by themselves, and what is merged away is next to nothing.
RC_GTEST_PROP(hard_networks, no_metre_of_a_joint_is_lost, ())
{
    Scene scene = section(slope, 1e-6);
    scene.cutting.smallest_angle = 0;
    scene.cutting.dangling_ends = *rc::gen::element(DanglingEnds::prune, DanglingEnds::extend);
    const int n = *rc::gen::inRange(1, 40);
    std::mt19937 random(*rc::gen::arbitrary<unsigned>());
    std::uniform_real_distribution<double> x(-10, 110);
    Joints joints;
    for (int i = 0; i < n; ++i)
        add_joint(joints, {x(random), x(random)}, {x(random), x(random)});
    const Blocks blocks = blocks::cut(scene, joints);
    RC_ASSERT(faults(scene, blocks) == "");
    RC_ASSERT(lost_length(joints, blocks) == "");
    const JointFates& fates = blocks.fates;
    double on_edges = 0;
    for (std::size_t j = 0; j < fates.fate.size(); ++j) {
        RC_ASSERT(fates.merged[j] < 1e-4);
        on_edges += fates.kept[j] + fates.extended[j];
        if (scene.cutting.dangling_ends == DanglingEnds::extend)
            RC_ASSERT(fates.dangling_end[j] < 1e-4);
    }
    double edges = 0;
    for (std::size_t e = 0; e < blocks.edge_vertex.size(); ++e)
        if (blocks.edge_joint[e] >= 0)
            edges +=
                (blocks.vertex[blocks.edge_vertex[e][0]] - blocks.vertex[blocks.edge_vertex[e][1]]).norm();
    RC_ASSERT(std::abs(edges - on_edges) < 1e-3);
}

// Two sides of a narrow wedge as long as each other, and a narrow strip with its diagonal: what closes one
// must not open the next.
TEST(hard_networks, narrow_wedges_and_strips_settle)
{
    const Scene scene = section({{0, 0}, {100, 0}, {100, 100}, {0, 100}}, 0.05);
    for (const double wide : {0.06, 0.1, 0.16, 0.2}) {
        Joints wedge, strip;
        add_joint(wedge, {0, 50}, {100, 50 - wide});
        add_joint(wedge, {0, 50}, {100, 50 + wide});
        expect_sound(scene, wedge, "wedge");
        for (const double y : {50.0, 50 + wide})
            add_joint(strip, {0, y}, {100, y});
        add_joint(strip, {0, 50 + wide}, {100, 50});
        expect_sound(scene, strip, "strip");
    }
}

TEST(hard_networks, a_hundred_thousand_joints)
{
    const Scene scene = section({{0, 0}, {1000, 0}, {1000, 600}, {500, 1000}, {0, 1000}}, 0.02);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> x(0, 1000), length(5, 15), nudge(-0.1, 0.1);
    Joints joints;
    for (int i = 0; i < 100'000; ++i) {
        const double angle = (i % 3) * std::numbers::pi / 3 + nudge(random);
        const Vector2d from(x(random), x(random));
        add_joint(joints, from, from + length(random) * Vector2d(std::cos(angle), std::sin(angle)));
    }
    const Blocks blocks = blocks::cut(scene, joints);
    EXPECT_EQ(faults(scene, blocks), "");
    EXPECT_EQ(lost_length(joints, blocks), "");
    EXPECT_GT(blocks.block_area.size(), 150'000u);
}

TEST(hard_networks, the_order_of_joints_does_not_change_the_blocks)
{
    const Scene scene = section(slope, 0.1);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> x(-10, 110);
    Joints joints;
    for (int i = 0; i < 40; ++i)
        add_joint(joints, {x(random), -10}, {x(random), 110});
    Joints reversed;
    for (int i = 39; i >= 0; --i)
        add_joint(reversed, joints.from[i], joints.to[i]);
    const Blocks a = blocks::cut(scene, joints), b = blocks::cut(scene, reversed);
    EXPECT_EQ(a.vertex, b.vertex);
    EXPECT_EQ(a.block_area, b.block_area);
}

} // namespace hard_networks_test
