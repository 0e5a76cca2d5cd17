#include "blocks/check.hpp"

#include "model/error.hpp"

#include <cmath>
#include <numeric>

namespace jointcreep::blocks
{

namespace
{

// Vertices in use less edges plus faces less connected parts: 0 in the plane.
std::int64_t euler(const Graph& graph, const Faces& faces)
{
    std::vector<Index> parent(graph.vertex.size());
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](Index v) {
        while (parent[v] != v)
            v = parent[v] = parent[parent[v]];
        return v;
    };
    std::vector<char> used(graph.vertex.size(), 0);
    std::int64_t used_count = 0, joins = 0;
    for (const Edge& e : graph.edge) {
        for (const Index v : {e.first, e.second})
            if (!used[v]) {
                used[v] = 1;
                ++used_count;
            }
        if (const Index a = root(e.first), b = root(e.second); a != b) {
            parent[a] = b;
            ++joins;
        }
    }
    return used_count - static_cast<std::int64_t>(graph.edge.size()) +
           static_cast<std::int64_t>(faces.size()) - (used_count - joins);
}

} // namespace

void check_faces(const Graph& graph, const Faces& faces, double section_area, std::size_t section_holes)
{
    const auto refuse = [](const std::string& what) {
        throw input_error("cutting: " + what + "; try another shortest_edge_m");
    };
    const auto near = [&](Index v) { return " near " + shown(graph.vertex[v]); };
    if (!crosses_nowhere(graph))
        refuse("edges cross after rounding");
    for (std::size_t e = 0; e < graph.edge.size(); ++e)
        if (const auto [left, right] = faces.sides[e]; left == right)
            refuse("an edge has one block on both sides" + near(graph.edge[e].first));
    std::vector<Index> visitor(graph.vertex.size(), -1);
    for (Index face = 0; face < static_cast<Index>(faces.size()); ++face) {
        const Index outer = faces.first_ring[face];
        if (!(faces.area[face] > 0) || !(ring_area(graph.vertex, faces.ring(outer)) > 0))
            refuse("a block without area" + near(faces.ring(outer)[0]));
        for (Index r = outer; r < faces.first_ring[face + 1]; ++r) {
            if (faces.ring(r).size() < 3)
                refuse("a ring of fewer than three corners" + near(faces.ring(r)[0]));
            for (const Index v : faces.ring(r)) {
                if (visitor[v] == r)
                    refuse("a ring touches itself" + near(v));
                visitor[v] = r;
            }
        }
    }
    if (euler(graph, faces) + static_cast<std::int64_t>(section_holes) != 0)
        refuse("vertices, edges and blocks do not fit each other");
    const double total = std::accumulate(faces.area.begin(), faces.area.end(), 0.0);
    if (!(std::abs(total - section_area) <= 1e-9 * section_area))
        refuse("the blocks' areas add up to " + shown(total) + " m2 instead of the section's " +
               shown(section_area));
}

} // namespace jointcreep::blocks
