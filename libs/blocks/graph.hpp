// A planar graph, from the lines of a scene to blocks: vertices, straight edges with the lines of the scene that
// they lie on, and faces. Inside libs/blocks only.

#pragma once

#include "model/grouped.hpp"
#include "model/network.hpp"
#include "model/scene.hpp"

#include <Eigen/Core>

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

namespace jointcreep::blocks
{

// A line of the scene that edges can lie on.
struct Source {
    enum class Kind { outline, bonded, joint };
    Kind kind;
    Index index; // side of the outline and its holes; side of a stage or region polygon; joint
};

// The lines of a scene, and the sets of them that lie on one edge. A set is named by a number: that of its
// only line, or one past all lines, given out as sets are met. The same lines are always the same number.
class Sources
{
public:
    explicit Sources(std::vector<Source> lines = {});

    const Source& operator[](Index line) const { return lines_[line]; }
    Index count() const { return static_cast<Index>(lines_.size()); }

    Index united(std::vector<Index> sets);            // of at least one
    std::span<const Index> lines_of(Index set) const; // ascending
    bool has_outline(Index set) const { return has_[set] & bit(Source::Kind::outline); }
    bool has_bonded(Index set) const { return has_[set] & bit(Source::Kind::bonded); }
    bool has_joint(Index set) const { return has_[set] & bit(Source::Kind::joint); }

private:
    static unsigned char bit(Source::Kind kind)
    {
        return static_cast<unsigned char>(1 << static_cast<int>(kind));
    }
    Index number_of(std::vector<Index> lines, unsigned char has);
    Index united_pair(Index low, Index high);

    std::vector<Source> lines_;
    std::vector<Index> own_;                        // 0, 1, 2 ...: a line as the set of itself
    std::vector<unsigned char> has_;                // of each set, by kind
    std::vector<const std::vector<Index>*> sets_;   // of several lines
    std::map<std::vector<Index>, Index> number_of_; // of these
    std::unordered_map<std::uint64_t, Index> known_;
};

struct Edge {
    Index first, second;     // vertices
    Index sources;           // a set of Sources
    bool is_settled = false; // known to have nothing but ends in common with any other settled edge
};

// One edge in place of some with the same ends, at least one.
Edge united(std::span<const Edge> edges, Sources& sources);

struct Graph {
    std::vector<Eigen::Vector2d> vertex; // [m]
    std::vector<Edge> edge;
};

// The planar arrangement of a graph's edges, which may cross, overlap and touch: every crossing becomes a
// vertex, overlapping pieces become one edge with the sources of all. What crosses what is decided exactly;
// each vertex is the exact one rounded to the nearest doubles, and vertices that round to one place are one.
// Vertices come out in lexicographic order, edges by their ends, first < second, so the result depends on the
// edges alone and not on their order. An edge that comes out as it went in is settled; two that were settled
// before are not compared again.
//
// Rounding moves a vertex by half a unit of its last place at most. Where other edges pass that near the
// result may cross itself; crosses_nowhere() tells.
//
// What lies outside a window, if one is given, need not be arranged: crossings there may be left out, and
// what is called settled is so inside only.
struct Box {
    Eigen::Vector2d low, high; // [m]
};
Graph arrange(const Graph& lines, Sources& sources, const std::optional<Box>& window = {});

// The same by CGAL's Arrangement_2, without a window; no edge is settled. Vertices that no edge has are left out.
// Throws input_error where the library was built without it.
Graph arrange_with_cgal(const Graph& lines, Sources& sources);

// Whether edges meet at common ends only; exact. Two settled ones are not compared again.
bool crosses_nowhere(const Graph& graph);

// What a graph's faces are made of. A ring runs with its face on the left: the first of a face is the outer
// one, counter-clockwise, the others are holes, clockwise. No ring visits a vertex twice; rings may touch at
// vertices.
struct Faces {
    std::vector<double> area;      // of bounded faces [m2]
    std::vector<Index> first_ring; // [faces + 1] of each face
    std::vector<Index> ring_start; // [rings + 1] into ring_vertex
    std::vector<Index> ring_vertex;
    std::vector<std::array<Index, 2>> sides; // of each edge: face on its {left, right}; -1: the unbounded one

    std::size_t size() const { return area.size(); }
    std::span<const Index> ring(Index r) const
    {
        return {ring_vertex.data() + ring_start[r], ring_vertex.data() + ring_start[r + 1]};
    }
};

// Whether each edge of a planar graph without crossings has one face on both sides.
std::vector<char> slits(const Graph& graph);

// Faces of a planar graph without crossings, in the order of their first edges.
Faces trace_faces(const Graph& graph);

// Calls visit(ring, area) for the outer ring of each face that has one of the chosen edges on its outer
// border; rings as they run, through a vertex more than once where they touch themselves. Areas are without
// holes [m2].
void for_outer_rings(const Graph& graph, const std::vector<char>& is_chosen,
                     const std::function<void(std::span<const Index>, double)>& visit);

// Removes faces; they then belong to the unbounded one.
void remove_faces(Faces& faces, const std::vector<char>& is_gone);

// Area inside a closed ring, positive if counter-clockwise, taken about one of its own vertices so that small
// blocks far from the origin keep their digits [m2].
double ring_area(const std::vector<Eigen::Vector2d>& vertex, std::span<const Index> ring);

// Tells which places are inside a polygon, exactly; places on its border count as inside. Asks only sides at about the
// height of the place.
class Inside
{
public:
    explicit Inside(const Polygon& polygon);
    bool holds(const Eigen::Vector2d& place) const;

private:
    Index strip_of(double y) const;
    std::array<Index, 2> strips_of(std::size_t side) const; // {first, last}

    Polygon polygon_;
    Eigen::Vector2d low_, high_; // [m]
    Index strips_ = 1;           // of equal height
    Grouped<Index> sides_;       // of each strip, by their first corners
};

// A place well inside a face, found from its rings alone.
Eigen::Vector2d place_inside(const std::vector<Eigen::Vector2d>& vertex, const Faces& faces, Index face);

} // namespace jointcreep::blocks
