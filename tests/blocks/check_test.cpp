// The last look at blocks: what it must refuse, by hand; and what it lets pass has no crossing even where
// edges known to be clear of each other are compared again.

#include "blocks/check.hpp"
#include "model/error.hpp"
#include "section.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace check_test
{

using namespace jointcreep;
using namespace jointcreep::test;
using blocks::Faces;
using blocks::Graph;
using Eigen::Vector2d;

namespace
{

Graph graph_of(std::vector<Vector2d> vertex, const std::vector<std::array<Index, 2>>& edges)
{
    Graph graph{.vertex = std::move(vertex), .edge = {}};
    for (const auto& [a, b] : edges)
        graph.edge.push_back({std::min(a, b), std::max(a, b), 0});
    return graph;
}

// A square of 4 m with one diagonal: two triangles of 8 m2.
const std::vector<Vector2d> corners = {{0, 0}, {0, 4}, {4, 0}, {4, 4}};
const std::vector<std::array<Index, 2>> with_diagonal = {{0, 1}, {1, 3}, {2, 3}, {0, 2}, {0, 3}};

Graph square()
{
    return graph_of(corners, with_diagonal);
}

std::string refusal(const Graph& graph, const Faces& faces, double area = 16, std::size_t holes = 0)
{
    try {
        blocks::check_faces(graph, faces, area, holes);
    } catch (const input_error& error) {
        return error.what();
    }
    return "";
}

void expect_refused(const std::string& refusal, const std::string& why)
{
    EXPECT_NE(refusal.find(why), std::string::npos) << "refused for: \"" << refusal << "\"";
}

} // namespace

TEST(check, sound_blocks_pass)
{
    const Graph graph = square();
    EXPECT_EQ(refusal(graph, blocks::trace_faces(graph)), "");
}

TEST(check, edges_that_meet_but_at_common_ends_are_refused)
{
    const Faces faces = blocks::trace_faces(square());
    const std::string why = "edges cross after rounding";

    Graph crossing = square();
    crossing.edge.push_back({1, 2, 0});
    expect_refused(refusal(crossing, faces), why);

    Graph tee = square(); // an end on the diagonal
    tee.vertex.emplace_back(2, 2);
    tee.edge.push_back({1, 4, 0});
    expect_refused(refusal(tee, faces), why);
    tee.vertex.back() = {std::nextafter(2.0, 0.0), 2}; // the next double short of it
    EXPECT_TRUE(blocks::crosses_nowhere(tee));
    tee.vertex.back() = {std::nextafter(2.0, 3.0), 2}; // and beyond it
    expect_refused(refusal(tee, faces), why);

    Graph overlap = square(); // on a part of the diagonal
    overlap.vertex.emplace_back(2, 2);
    overlap.edge.push_back({0, 4, 0});
    expect_refused(refusal(overlap, faces), why);
}

TEST(check, only_what_is_settled_on_both_sides_is_not_compared)
{
    for (const bool one : {false, true})
        for (const bool other : {false, true}) {
            Graph crossing = square();
            crossing.edge.push_back({1, 2, 0, one});
            crossing.edge[4].is_settled = other;
            EXPECT_EQ(blocks::crosses_nowhere(crossing), one && other);
        }
}

TEST(check, an_edge_within_a_block_is_refused)
{
    Graph graph = square();
    graph.vertex.emplace_back(1, 2);
    graph.edge.push_back({1, 4, 0});
    expect_refused(refusal(graph, blocks::trace_faces(graph)), "an edge has one block on both sides");
}

TEST(check, inverted_blocks_and_odd_rings_are_refused)
{
    const Graph graph = square();
    const Faces sound = blocks::trace_faces(graph);
    const std::string without_area = "a block without area";

    Faces faces = sound;
    std::reverse(faces.ring_vertex.begin() + faces.ring_start[1], faces.ring_vertex.end());
    expect_refused(refusal(graph, faces), without_area);
    for (const double area : {-8.0, 0.0, std::nan("")}) {
        faces = sound;
        faces.area[1] = area;
        expect_refused(refusal(graph, faces), without_area);
    }

    faces = sound; // a hole of two corners in the last block
    faces.ring_vertex.insert(faces.ring_vertex.end(), {0, 1});
    faces.ring_start.push_back(static_cast<Index>(faces.ring_vertex.size()));
    ++faces.first_ring.back();
    expect_refused(refusal(graph, faces), "a ring of fewer than three corners");

    faces = sound; // round one triangle twice
    const std::vector<Index> last(faces.ring(1).begin(), faces.ring(1).end());
    faces.ring_vertex.insert(faces.ring_vertex.end(), last.begin(), last.end());
    faces.ring_start.back() = static_cast<Index>(faces.ring_vertex.size());
    expect_refused(refusal(graph, faces), "a ring touches itself");
}

TEST(check, a_missing_block_and_a_missing_area_are_refused)
{
    const Graph graph = square();
    const std::string not_fitting = "vertices, edges and blocks do not fit each other",
                      areas = "areas add up to";
    const Faces sound = blocks::trace_faces(graph);
    expect_refused(refusal(graph, sound, 16, 1), not_fitting);
    expect_refused(refusal(graph, sound, 16 * (1 + 2e-9)), areas);
    expect_refused(refusal(graph, sound, std::nan("")), areas);

    Faces faces = sound; // a triangle on the rim: its sides belong to none
    blocks::remove_faces(faces, {0, 1});
    expect_refused(refusal(graph, faces), "an edge has one block on both sides");

    // A block within another.
    const Graph nested = graph_of({{0, 0}, {0, 4}, {4, 0}, {4, 4}, {1, 1}, {1, 2}, {2, 1}},
                                  {{0, 1}, {1, 3}, {2, 3}, {0, 2}, {4, 5}, {5, 6}, {4, 6}});
    faces = blocks::trace_faces(nested);
    EXPECT_EQ(refusal(nested, faces), "");
    blocks::remove_faces(faces, {0, 1});
    expect_refused(refusal(nested, faces), not_fitting);
    EXPECT_EQ(refusal(nested, faces, 15.5, 1), ""); // a hole
    expect_refused(refusal(nested, faces, 16, 1), areas);
}

TEST(check, blocks_cross_nowhere_with_every_edge_compared)
{
    std::mt19937 random(3);
    std::uniform_real_distribution<double> x(-5, 105), reach(-25, 25);
    std::size_t most_blocks = 0;
    for (int i = 0; i < 120; ++i) {
        Scene scene = section({{0, 0}, {100, 0}, {100, 100}, {60, 100}, {50, 30}, {40, 100}, {0, 100}},
                              std::array{1e-6, 0.02, 0.5, 2.0}[i % 4]);
        scene.holes = {{{30, 15}, {38, 14}, {41, 20}, {33, 24}}, {{60, 8}, {70, 8}, {70, 18}, {60, 18}}};
        scene.rocks.push_back({"other", 2700, 3e10, 0.25, std::nullopt});
        scene.regions.resize(1);
        scene.regions[0].rock = "other";
        scene.regions[0].outline = {{-3, 42}, {80, 38}, {120, 60}, {0, 60}};
        scene.cutting.dangling_ends = i / 4 % 2 == 0 ? DanglingEnds::prune : DanglingEnds::extend;
        Joints joints;
        for (int j = 0; j < 20 + 2 * i; ++j) {
            const Vector2d from(x(random), x(random));
            add_joint(joints, from, from + Vector2d(reach(random), reach(random)));
        }
        const Blocks blocks = blocks::cut(scene, joints);
        EXPECT_TRUE(blocks::crosses_nowhere(graph_of(blocks.vertex, blocks.edge_vertex))) << i;
        EXPECT_EQ(faults(scene, blocks), "") << i;
        most_blocks = std::max(most_blocks, blocks.block_area.size());
    }
    EXPECT_GT(most_blocks, 500u);
}

} // namespace check_test
