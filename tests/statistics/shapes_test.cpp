// Blocks and nodes of sections worked out by hand, and closed forms of random ones.

#include "scenes.hpp"

#include "blocks/cut.hpp"
#include "sampling/joint_sets.hpp"
#include "statistics/block_shape.hpp"
#include "statistics/nodes.hpp"
#include "statistics/statistics.hpp"

#include <gtest/gtest.h>

#include <random>

namespace shapes_test
{

using namespace jointcreep;
using namespace jointcreep::statistics;
using namespace jointcreep::unit;
using Eigen::Vector2d;

namespace
{

// One block with these rings.
Blocks block_of(const std::vector<Polygon>& rings)
{
    Blocks blocks;
    blocks.block_ring = {0, static_cast<Index>(rings.size())};
    blocks.ring_start = {0};
    double area = 0;
    for (const Polygon& ring : rings) {
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const Vector2d &a = ring[i], &b = ring[(i + 1) % ring.size()];
            area += (a.x() * b.y() - a.y() * b.x()) / 2;
            blocks.ring_vertex.push_back(static_cast<Index>(blocks.vertex.size()));
            blocks.vertex.push_back(a);
        }
        blocks.ring_start.push_back(static_cast<Index>(blocks.ring_vertex.size()));
    }
    blocks.block_area = {area};
    return blocks;
}

Polygon rectangle(double width, double height, double turn = 0)
{
    Polygon corners = {{5, 3}, {5 + width, 3}, {5 + width, 3 + height}, {5, 3 + height}};
    for (Vector2d& corner : corners)
        corner = {corner.x() * std::cos(turn) - corner.y() * std::sin(turn),
                  corner.x() * std::sin(turn) + corner.y() * std::cos(turn)};
    return corners;
}

void add_trace(Joints& joints, const Vector2d& from, const Vector2d& to)
{
    joints.trace_joint.push_back(static_cast<Index>(joints.set.size()));
    joints.trace_from.push_back(from);
    joints.trace_to.push_back(to);
    joints.set.push_back(0);
}

} // namespace

TEST(BlockShape, OfASquareIsOne)
{
    const BlockShapes shapes = block_shapes(block_of({rectangle(2, 2, .3)}));
    EXPECT_NEAR(shapes.alpha[0], 1, 1e-12);
    EXPECT_NEAR(shapes.aspect[0], 1, 1e-9);
    EXPECT_EQ(shapes.corners[0], 4);
    // Chords: 4 sides and 2 diagonals, all but no shorter than the median, a side. Of the 15 pairs 2 are
    // equal sides (1), 4 at right angles (0), 8 side and diagonal (1), 1 two diagonals (0): sum 10; |a|^2
    // |b|^2 summed: 6 + 8 * 2 + 4 = 26.
    EXPECT_NEAR(shapes.beta[0], 10 * std::pow(10.0 / 26, 2), 1e-9);
}

TEST(BlockShape, OfARectangleIsThatOfItsSides)
{
    const BlockShapes shapes = block_shapes(block_of({rectangle(6, 2, 1)}));
    EXPECT_NEAR(shapes.aspect[0], 3, 1e-9);
    const double chord = (2 * 6 + 2 * 2 + 2 * std::sqrt(40.0)) / 6;
    EXPECT_NEAR(shapes.alpha[0], 16 * chord / (4.5523 * 12), 1e-4);
    EXPECT_GT(block_shapes(block_of({rectangle(60, 1)})).beta[0], 9.9);
}

// A vertex on a straight side is no corner; a hole counts with its outline and area.
TEST(BlockShape, KnowsStraightVerticesAndHoles)
{
    Polygon outer = {{0, 0}, {2, 0}, {4, 0}, {4, 4}, {0, 4}};
    EXPECT_EQ(block_shapes(block_of({outer})).corners[0], 4);
    const BlockShapes holed = block_shapes(block_of({outer, {{1, 1}, {1, 3}, {3, 3}, {3, 1}}}));
    EXPECT_NEAR(holed.aspect[0], 1, 1e-9);
    const double chord = (4 * 4 + 2 * std::sqrt(32.0)) / 6;
    EXPECT_NEAR(holed.alpha[0], (16 + 8) * chord / (4.5523 * 12), 1e-4);
}

TEST(BlockShape, QuantilesAreWeighted)
{
    EXPECT_EQ(weighted_quantile({3, 1, 2}, {1, 1, 1}, .5), 2);
    EXPECT_EQ(weighted_quantile({3, 1, 2}, {10, 1, 1}, .5), 3);
    EXPECT_EQ(weighted_quantile({3, 1, 2}, {1, 1, 1}, .01), 1);
    EXPECT_EQ(weighted_quantile({}, {}, .5), 0);
}

// A cross, a T, an end on the outline, one outside, and two collinear ones of the same joint.
TEST(Nodes, OfAFewTraces)
{
    const Polygon outline = rectangle(10, 10);
    Joints joints;
    add_trace(joints, {6, 6}, {10, 10});
    add_trace(joints, {6, 10}, {10, 6});      // X with the first
    add_trace(joints, {8, 4}, {8, 8 + 1e-9}); // ends at the crossing of both: one end at a joint
    add_trace(joints, {7, 12}, {7, 20});      // leaves the section: one end
    const Nodes nodes = count_nodes(joints, outline, 1e-6);
    EXPECT_EQ(nodes.x, 1);
    EXPECT_EQ(nodes.y, 1);
    EXPECT_EQ(nodes.i, 4 + 1 + 1);
    EXPECT_DOUBLE_EQ(nodes.branches(), (4 + 3 + 6) / 2.0);
    EXPECT_DOUBLE_EQ(nodes.connections_per_branch(), 7 / 6.5);
}

// An end near a border of the grid at a trace: the trace is in the cell of the end, too. Once the trace is steep, and there is a border of
// rows, too; once it ends just before the border of columns.
TEST(Nodes, AtBordersOfTheGrid)
{
    const Polygon outline = {{0, 0}, {10, 0}, {10, 10}, {0, 10}};
    const double border = std::sqrt(10 * 10 / (2 * 2 + 1.)), tolerance = .01; // of a grid for two traces
    const Vector2d steep(.4, 4);
    for (const double side : {1, -1}) {
        const Vector2d end(border + side * .0005, border - side * .05), across(side * 4, 0);
        Joints at_a_steep_one, end_to_end;
        add_trace(at_a_steep_one, end - steep, end + steep);
        add_trace(at_a_steep_one, end, end + across);
        const Nodes nodes = count_nodes(at_a_steep_one, outline, tolerance);
        EXPECT_EQ(nodes.x, 0) << side;
        EXPECT_EQ(nodes.y, 1) << side;
        EXPECT_EQ(nodes.i, 3) << side;

        const Vector2d gap(side * .001, 0), place(border, 6);
        add_trace(end_to_end, place - across, place - gap);
        add_trace(end_to_end, place + gap, place + across + Vector2d(0, 2));
        const Nodes two = count_nodes(end_to_end, outline, tolerance);
        EXPECT_EQ(two.x, 0) << side;
        EXPECT_EQ(two.y, 2) << side;
        EXPECT_EQ(two.i, 2) << side;
    }
}

// The grid finds what all pairs find.
TEST(Nodes, AreThoseOfAllPairs)
{
    std::mt19937_64 random(1);
    const auto any = [&random] { return std::uniform_real_distribution<double>(-2, 12)(random); };
    const Polygon outline = {{0, 0}, {10, 0}, {10, 4}, {4, 4}, {4, 10}, {0, 10}};
    for (int round = 0; round < 20; ++round) {
        Joints joints;
        for (int i = 0; i < 150; ++i) {
            const Vector2d from(any(), any());
            const double scale = round % 2 ? 1 : .1;
            add_trace(joints, from, from + scale * Vector2d(any(), round == 4 ? 0 : any()));
        }
        const auto inside = [](const Vector2d& p) {
            return p.x() > 0 && p.y() > 0 && ((p.x() < 10 && p.y() < 4) || (p.x() < 4 && p.y() < 10));
        };
        std::int64_t crossings = 0, ends = 0;
        for (std::size_t a = 0; a < 150; ++a) {
            ends += inside(joints.trace_from[a]) + inside(joints.trace_to[a]);
            for (std::size_t b = 0; b < a; ++b) {
                const Vector2d u = joints.trace_to[a] - joints.trace_from[a],
                               v = joints.trace_to[b] - joints.trace_from[b],
                               w = joints.trace_from[b] - joints.trace_from[a];
                const double sine = u.x() * v.y() - u.y() * v.x();
                const double s = (w.x() * v.y() - w.y() * v.x()) / sine,
                             t = (w.x() * u.y() - w.y() * u.x()) / sine;
                if (s > 0 && s < 1 && t > 0 && t < 1)
                    crossings += inside(joints.trace_from[a] + s * u);
            }
        }
        const Nodes nodes = count_nodes(joints, outline, 1e-9);
        EXPECT_EQ(nodes.x, crossings) << round;
        EXPECT_EQ(nodes.i + nodes.y, ends) << round;
        EXPECT_EQ(nodes.y, 0);
    }
}

// Two sets at right angles with negative exponential spacings cut a box into (1 + n) (1 + m) blocks, n and m of Poisson's law. The
// interval is that of their error to first order.
TEST(Blocks, TheirNumberHasTheErrorOfTwoCounts)
{
    Scene scene = examples()[1].scene; // of another section
    scene.outline = box();             // 100 m x 60 m
    scene.cutting = {1e-6, 1e-6};
    scene.joint_sets[0].persistence = 1;
    scene.joint_sets[0].trace_angle = ProbabilityLaw{Kind::constant, 0, 0};
    scene.joint_sets[0].spacing = {Kind::negative_exponential, 4, 4};
    scene.joint_sets.push_back(scene.joint_sets[0]);
    scene.joint_sets[1].name = "others";
    scene.joint_sets[1].trace_angle = ProbabilityLaw{Kind::constant, 90 * deg, 0};
    scene.joint_sets[1].spacing = {Kind::negative_exponential, 5, 5};
    Network network;
    network.joints = sampling::sample_joints(scene, 3, 0);
    network.blocks = blocks::cut(scene, network.joints);
    const Statistics rows = statistics_of(scene, network);
    const std::size_t i = row_of(rows, "blocks", "number");
    const double n = 60. / 4, m = 100. / 5,
                 error = std::sqrt(n * (1 + m) * (1 + m) + m * (1 + n) * (1 + n)) / ((1 + n) * (1 + m));
    EXPECT_NEAR(rows.target[i], (1 + n) * (1 + m), 1e-9);
    EXPECT_NEAR(std::log(rows.high[i] / rows.achieved[i]), 1.96 * error, 1e-9);
    EXPECT_NEAR(std::log(rows.achieved[i] / rows.low[i]), 1.96 * error, 1e-9);
}

// Lines of one set with angles a even between -w and w cut a box into 1 + p + c blocks: with a frequency f, a width of 100 |sin a| + 60
// |cos a| across a line, and f / cos a lines of it a metre, p = f (60 - 100 log(cos w) / w); two lines cross where
// |sin(a - b)| / (cos a cos b) = |tan a - tan b|, c = area f^2 / 2 times its mean.
TEST(Blocks, TheirNumberWithAnglesThatScatter)
{
    Scene scene = examples()[1].scene;
    scene.outline = box();
    scene.cutting = {1e-6, 1e-6};
    const double w = 40 * deg, f = .25;
    scene.joint_sets[0].persistence = 1;
    scene.joint_sets[0].trace_angle = uniform_law(-w, w);
    scene.joint_sets[0].spacing = {Kind::negative_exponential, 1 / f, 1 / f};
    Network network;
    network.joints = sampling::sample_joints(scene, 3, 0);
    network.blocks = blocks::cut(scene, network.joints);
    const Statistics rows = statistics_of(scene, network);
    double mean = 0; // of |tan a - tan b|
    const int n = 400;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            mean += std::abs(std::tan(w * (2 * i + 1 - n) / n) - std::tan(w * (2 * j + 1 - n) / n)) / (n * n);
    const double pieces = f * (60 - 100 * std::log(std::cos(w)) / w), crossings = 6000 * f * f / 2 * mean;
    EXPECT_NEAR(rows.target[row_of(rows, "blocks", "number")], 1 + pieces + crossings,
                2e-3 * (1 + pieces + crossings));
}

// Two sets without bridges: number of blocks and of crossings, mean area, on average what they should be
// (network of parallelograms), and their stated errors right.
TEST(Blocks, AreAsManyAsExpected)
{
    Scene scene = examples()[1].scene;
    scene.cutting = {1e-6, 1e-6};
    scene.joint_sets[0].persistence = 1;
    scene.joint_sets.push_back(scene.joint_sets[0]);
    scene.joint_sets[1].name = "others";
    scene.joint_sets[1].trace_angle = ProbabilityLaw{Kind::normal, 30 * deg, 8 * deg};
    scene.joint_sets[1].spacing = {Kind::negative_exponential, 5, 5};
    const int realizations = 200;
    double number = 0, number_target = 0, square = 0, crossings = 0, crossings_target = 0;
    int holding = 0;
    for (int r = 0; r < realizations; ++r) {
        Network network;
        network.joints = sampling::sample_joints(scene, 3, r);
        network.blocks = blocks::cut(scene, network.joints);
        const Statistics rows = statistics_of(scene, network);
        const std::size_t i = row_of(rows, "blocks", "number"), x = row_of(rows, "nodes", "X, crossings");
        ASSERT_EQ(rows.has_target[i], 1);
        number += rows.achieved[i] / realizations;
        square += rows.achieved[i] * rows.achieved[i] / realizations;
        number_target = rows.target[i];
        holding += rows.low[i] <= rows.target[i] && rows.target[i] <= rows.high[i];
        crossings += rows.achieved[x] / realizations;
        crossings_target = rows.target[x];
        EXPECT_NEAR(rows.achieved[row_of(rows, "blocks", "area, mean")] * rows.achieved[i], 5000, 1e-6);
    }
    const double error = std::sqrt((square - number * number) / realizations);
    EXPECT_NEAR(number, number_target, 3.3 * error);
    EXPECT_NEAR(crossings, crossings_target, 3.3 * error);
    EXPECT_GE(holding, .95 * realizations - 3.3 * std::sqrt(.95 * .05 * realizations));
}

} // namespace shapes_test
