// Where joint traces and rock bridges lie along joints, and how exactly their share is known.

#include "joint/pieces.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

namespace pieces_test
{

using namespace jointcreep;
using namespace jointcreep::joint;

namespace
{

const Polygon square = {{0, 0}, {10, 0}, {10, 10}, {0, 10}};
// The square, without what is above y = 4 between x = 4 and 6.
const Polygon notched = {{0, 0}, {10, 0}, {10, 10}, {6, 10}, {6, 4}, {4, 4}, {4, 10}, {0, 10}};

struct Trace {
    Index joint;
    double from, to; // x
};

// Level joints through these heights, from x = -2 to 12.
Joints level(const std::vector<double>& heights, const std::vector<Trace>& traces)
{
    Joints joints;
    for (std::size_t i = 0; i < heights.size(); ++i) {
        joints.set.push_back(0);
        joints.number.push_back(static_cast<Index>(i));
        joints.material.push_back(0);
        joints.from.emplace_back(-2, heights[i]);
        joints.to.emplace_back(12, heights[i]);
    }
    for (const Trace& trace : traces) {
        joints.trace_joint.push_back(trace.joint);
        joints.trace_from.emplace_back(trace.from, heights[trace.joint]);
        joints.trace_to.emplace_back(trace.to, heights[trace.joint]);
    }
    return joints;
}

void expect_pieces(const Pieces& pieces, const std::vector<Trace>& wanted,
                   const std::vector<Index>& is_bridge)
{
    ASSERT_EQ(pieces.joint.size(), wanted.size());
    EXPECT_EQ(pieces.is_bridge, is_bridge);
    std::vector<Index> bridges;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        EXPECT_EQ(pieces.joint[i], wanted[i].joint);
        EXPECT_NEAR(pieces.from[i].x(), wanted[i].from, 1e-9) << i;
        EXPECT_NEAR(pieces.to[i].x(), wanted[i].to, 1e-9) << i;
        EXPECT_NEAR(pieces.length[i], wanted[i].to - wanted[i].from, 1e-9) << i;
        if (is_bridge[i] == 1)
            bridges.push_back(static_cast<Index>(i));
    }
    EXPECT_EQ(pieces.bridge, bridges);
}

} // namespace

TEST(Pieces, AlternateInsideTheSection)
{
    // The first trace comes in from outside, the last one is outside.
    const Pieces pieces = pieces_of(level({5}, {{0, 6, 8}, {0, -1, 3}, {0, 10.5, 11}}), square, {});
    expect_pieces(pieces, {{0, 0, 3}, {0, 3, 6}, {0, 6, 8}, {0, 8, 10}}, {0, 1, 0, 1});
    EXPECT_NEAR(pieces.line_length[0], 10, 1e-9);
    EXPECT_NEAR(pieces.line_persistence[0], .5, 1e-9);
}

TEST(Pieces, AreInterruptedWhereTheLineIsOutside)
{
    const Pieces pieces = pieces_of(level({7, 2, 20}, {{0, 1, 9}, {1, -5, 15}}), notched, {});
    expect_pieces(pieces, {{0, 0, 1}, {0, 1, 4}, {0, 6, 9}, {0, 9, 10}, {1, 0, 10}}, {1, 0, 0, 1, 0});
    EXPECT_NEAR(pieces.line_length[0], 8, 1e-9);
    EXPECT_NEAR(pieces.line_persistence[0], 6. / 8, 1e-9);
    EXPECT_EQ(pieces.line_persistence[1], 1);
    EXPECT_EQ(pieces.line_length[2], 0); // beside the section
    EXPECT_EQ(pieces.line_persistence[2], 0);
}

TEST(Pieces, AreInterruptedByHoles)
{
    const std::vector<Polygon> holes = {{{3, 4}, {5, 4}, {5, 8}, {3, 8}}, {{8, 4}, {9, 4}, {9, 8}, {8, 8}}};
    const Pieces pieces = pieces_of(level({5, 2}, {{0, 1, 6}}), square, holes);
    expect_pieces(pieces, {{0, 0, 1}, {0, 1, 3}, {0, 5, 6}, {0, 6, 8}, {0, 9, 10}, {1, 0, 10}},
                  {1, 0, 0, 1, 1, 1});
    EXPECT_NEAR(pieces.line_length[0], 7, 1e-9);
    EXPECT_NEAR(pieces.line_persistence[0], 3. / 7, 1e-9);
}

TEST(Pieces, OfTracesThatOverlapAreOne)
{
    const Pieces pieces = pieces_of(level({5}, {{0, 1, 4}, {0, 3, 6}, {0, 6, 7}, {0, 6.2, 6.5}}), square, {});
    expect_pieces(pieces, {{0, 0, 1}, {0, 1, 7}, {0, 7, 10}}, {1, 0, 1});
}

TEST(Pieces, OfALineWithoutTracesAreOneBridge)
{
    const Pieces pieces = pieces_of(level({5}, {}), square, {});
    expect_pieces(pieces, {{0, 0, 10}}, {1});
    EXPECT_EQ(pieces.line_persistence[0], 0);
}

TEST(PersistenceError, IsWhatAHandFinds)
{
    // Constant traces of 2 m, bridges with mean and deviation 1 m: variance (0 + 1 * 4) / (27 * 300).
    const ProbabilityLaw two{ProbabilityLaw::Kind::constant, 2, 0};
    EXPECT_NEAR(persistence_error(two, 2. / 3, {100, 200}), std::sqrt(4. / (27 * 300)), 1e-12);
    // Exponential both: 2 * 4 * 1 / (27 * 300).
    const ProbabilityLaw exponential{ProbabilityLaw::Kind::negative_exponential, 2, 2};
    EXPECT_NEAR(persistence_error(exponential, 2. / 3, {300}), std::sqrt(8. / (27 * 300)), 1e-12);
    // On lines shorter than anything, all joint or all bridge.
    EXPECT_NEAR(persistence_error(exponential, 2. / 3, {1e-6, 1e-6}), std::sqrt(2. / 9 / 2), 1e-9);
    EXPECT_EQ(persistence_error(exponential, 2. / 3, {}), 0);
}

TEST(PersistenceError, IsWhatManyLinesShow)
{
    // Exponential traces and bridges: a Markov chain, drawn here line by line. 4000 sums over 5 lines of 60
    // m; the standard deviation of a deviation is 1 / sqrt(2 n), 1.1 percent; 4 of these, and 1 percent for
    // what is left of the lines' ends.
    const double k = .6, trace = 3, bridge = trace * (1 - k) / k;
    std::mt19937_64 random(20260501);
    std::vector<double> found(4000);
    for (double& persistence : found) {
        double joint = 0;
        for (int line = 0; line < 5; ++line) {
            bool is_trace = std::bernoulli_distribution(k)(random);
            for (double at = 0; at < 60; is_trace = !is_trace) {
                const double length =
                    std::exponential_distribution<>(1 / (is_trace ? trace : bridge))(random);
                joint += is_trace ? std::min(length, 60 - at) : 0;
                at += length;
            }
        }
        persistence = joint / 300;
    }
    const double mean = std::accumulate(found.begin(), found.end(), 0.0) / 4000;
    double squares = 0;
    for (const double persistence : found)
        squares += (persistence - mean) * (persistence - mean);
    const double wanted = persistence_error({ProbabilityLaw::Kind::negative_exponential, trace, trace}, k,
                                            std::vector<double>(5, 60.0));
    EXPECT_NEAR(mean, k, 4 * wanted / std::sqrt(4000));
    EXPECT_NEAR(std::sqrt(squares / 3999) / wanted, 1, .055);
}

} // namespace pieces_test
