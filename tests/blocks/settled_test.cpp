// Edges that are settled are not compared again. Pass after pass of arranging and merging, as a network is
// cut, the result is held to the one with every edge compared with every other.

#include "blocks/graph.hpp"
#include "blocks/merge.hpp"
#include "blocks/predicates.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <set>

namespace settled_test
{

using namespace jointcreep;
using blocks::Edge;
using blocks::Graph;
using blocks::Source;
using Eigen::Vector2d;

namespace
{

Graph all_unsettled(Graph graph)
{
    for (Edge& e : graph.edge)
        e.is_settled = false;
    return graph;
}

void expect_same(const Graph& a, const blocks::Sources& of_a, const Graph& b, const blocks::Sources& of_b)
{
    ASSERT_EQ(a.vertex, b.vertex);
    ASSERT_EQ(a.edge.size(), b.edge.size());
    for (std::size_t e = 0; e < a.edge.size(); ++e) {
        ASSERT_EQ(a.edge[e].first, b.edge[e].first);
        ASSERT_EQ(a.edge[e].second, b.edge[e].second);
        ASSERT_TRUE(std::ranges::equal(of_a.lines_of(a.edge[e].sources), of_b.lines_of(b.edge[e].sources)));
    }
}

// A square with a bonded line in it, and short joints.
struct Lines {
    Polygon outline{{0, 0}, {100, 0}, {100, 100}, {0, 100}};
    Graph graph;
    std::vector<Source> lines;

    Lines(int joints, std::mt19937& random)
    {
        for (Index i = 0; i < 4; ++i)
            add(outline[i], outline[(i + 1) % 4], {Source::Kind::outline, i});
        add({0, 47}, {100, 51}, {Source::Kind::bonded, 0});
        std::uniform_real_distribution<double> place(0, 100), reach(-15, 15);
        for (Index j = 0; j < joints; ++j) {
            const Vector2d from(place(random), place(random)), along(reach(random), reach(random));
            add(from, from + along, {Source::Kind::joint, j});
        }
    }
    void add(const Vector2d& from, const Vector2d& to, Source source)
    {
        const auto n = static_cast<Index>(graph.vertex.size());
        graph.vertex.insert(graph.vertex.end(), {from, to});
        graph.edge.push_back({n, n + 1, static_cast<Index>(lines.size())});
        lines.push_back(source);
    }
};

// The settled edges by the places of their ends.
std::set<std::array<double, 4>> settled_in(const Graph& graph)
{
    std::set<std::array<double, 4>> places;
    for (const Edge& e : graph.edge)
        if (e.is_settled) {
            const auto [a, b] = std::minmax(graph.vertex[e.first], graph.vertex[e.second], blocks::is_before);
            places.insert({a.x(), a.y(), b.x(), b.y()});
        }
    return places;
}

// Settled edges alone, to be compared all.
Graph only_settled(Graph graph)
{
    std::erase_if(graph.edge, [](const Edge& e) { return !e.is_settled; });
    return all_unsettled(std::move(graph));
}

// Moves some vertices by up to 5 m, and unsettles what ends there.
void shake(Graph& graph, int vertices, std::mt19937& random)
{
    std::uniform_real_distribution<double> by(-5, 5);
    for (int i = 0; i < vertices; ++i) {
        const auto moved = static_cast<Index>(random() % graph.vertex.size());
        graph.vertex[moved] += Vector2d(by(random), by(random));
        for (Edge& e : graph.edge)
            if (e.first == moved || e.second == moved)
                e.is_settled = false;
    }
}

} // namespace

TEST(settled, edges_need_no_second_look)
{
    std::mt19937 random(7);
    int with_most_settled = 0, of_these_with_crossings = 0, merged = 0;
    for (int i = 0; i < 60; ++i) {
        const Lines drawn(i % 2 == 0 ? 60 : 250, random);
        blocks::Sources sources(drawn.lines);
        Graph graph = drawn.graph;
        for (int pass = 0; pass < 8; ++pass) {
            blocks::Sources others = sources;
            const Graph wanted = blocks::arrange(all_unsettled(graph), others);
            const bool cross = !blocks::crosses_nowhere(all_unsettled(graph));
            ASSERT_EQ(!blocks::crosses_nowhere(graph), cross);
            if (3 * std::ranges::count(graph.edge, true, &Edge::is_settled) > 2 * std::ssize(graph.edge)) {
                ++with_most_settled;
                of_these_with_crossings += cross;
            }
            graph = blocks::arrange(graph, sources);
            expect_same(graph, sources, wanted, others);
            ASSERT_TRUE(blocks::crosses_nowhere(only_settled(graph)));

            const auto before = settled_in(graph);
            CuttingReport report{};
            merged += blocks::merge_pass(graph, sources, {drawn.outline}, {1.0, 0.05}, report);
            ASSERT_TRUE(std::ranges::includes(before, settled_in(graph))) << "a moved edge is called settled";
            shake(graph, pass % 3, random);
        }
    }
    EXPECT_GT(with_most_settled, 100);
    EXPECT_GT(of_these_with_crossings, 50);
    EXPECT_GT(merged, 100);
}

// Where doubles are as coarse as the gaps between lines, pieces of them cross again.
TEST(settled, pieces_with_a_rounded_end_get_a_second_look)
{
    std::mt19937 random(8);
    std::uniform_real_distribution<double> unit(0, 1);
    int crossed_again = 0;
    for (int i = 0; i < 200; ++i) {
        Graph graph;
        std::vector<Source> lines(30, {Source::Kind::joint, 0});
        for (Index j = 0; j < 30; ++j) {
            graph.vertex.insert(graph.vertex.end(), {{1e5, 2e5 + 1e-9 * unit(random)},
                                                     {1e5 + 1e-8 * unit(random), 2e5 + 1e-9 * unit(random)}});
            graph.edge.push_back({2 * j, 2 * j + 1, j});
        }
        blocks::Sources sources(lines);
        for (int pass = 0; pass < 3; ++pass) {
            graph = blocks::arrange(graph, sources);
            const bool cross = !blocks::crosses_nowhere(all_unsettled(graph));
            ASSERT_EQ(!blocks::crosses_nowhere(graph), cross);
            ASSERT_TRUE(blocks::crosses_nowhere(only_settled(graph)));
            crossed_again += cross;
        }
    }
    EXPECT_GT(crossed_again, 20);
}

} // namespace settled_test
