// A planar graph on its way to becoming blocks: straight edges between vertices, each edge knowing which
// lines of the scene it lies on. Inside libs/blocks only.

#pragma once

#include "model/network.hpp"
#include "model/scene.hpp"

#include <Eigen/Core>

#include <vector>

namespace jointcreep::blocks
{

// A line of the scene that edges can lie on.
struct Source {
    enum class Kind { outline, welded, joint };
    Kind kind;
    Index index; // side of the outline; stage or region polygon; joint
};

struct Edge {
    Index first, second;        // vertices
    std::vector<Index> sources; // into the list of sources; sorted, no duplicates
};

struct Graph {
    std::vector<Eigen::Vector2d> vertex; // [m]
    std::vector<Edge> edge;
};

// The exact planar arrangement of a graph's edges, which may cross, overlap and touch: every crossing becomes
// a vertex, overlapping pieces become one edge with the sources of all. Computed with exact arithmetic; only
// the resulting vertices are rounded to doubles. Vertices come out in lexicographic order, edges by their
// ends, so the result depends on the edges alone and not on their order.
Graph arrange(const Graph& crossing);

// What a graph's faces are made of. A ring runs with its face on the left.
struct Face {
    std::vector<std::vector<Index>> rings; // vertices; the outer ring first, counter-clockwise; then holes
    double area;                           // [m2]
};

struct Faces {
    std::vector<Face> face; // bounded faces
    std::vector<std::array<Index, 2>>
        sides; // of each edge: face on its {left, right}; -1 is the unbounded one
};

// Faces of a planar graph without crossings.
Faces trace_faces(const Graph& graph);

// Area inside a closed ring, positive if counter-clockwise, taken about one of its own vertices so that small
// blocks far from the origin keep their digits [m2].
double ring_area(const std::vector<Eigen::Vector2d>& vertex, const std::vector<Index>& ring);

// Whether a place is inside a polygon, exactly; places on its border count as inside.
bool is_inside(const Polygon& polygon, const Eigen::Vector2d& place);

// A place well inside a face, found from its rings alone.
Eigen::Vector2d place_inside(const std::vector<Eigen::Vector2d>& vertex, const Face& face);

} // namespace jointcreep::blocks
