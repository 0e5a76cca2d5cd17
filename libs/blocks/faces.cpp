#include "blocks/graph.hpp"
#include "blocks/predicates.hpp"

#include <algorithm>
#include <cmath>

namespace jointcreep::blocks
{

namespace
{

using Eigen::Vector2d;

// Half-edge 2 e runs from an edge's first vertex to its second, 2 e + 1 back.
class HalfEdges
{
public:
    explicit HalfEdges(const Graph& graph)
        : graph_(graph), next_(2 * graph.edge.size()), has_fan_(graph.vertex.size(), 0),
          leaving_(graph.vertex.size(), [&](auto add) {
              for (Index h = 0; h < count(); ++h)
                  add(start(h), h);
          })
    {
    }

    Index count() const { return static_cast<Index>(next_.size()); }
    Index start(Index h) const { return h % 2 == 0 ? graph_.edge[h / 2].first : graph_.edge[h / 2].second; }
    Index end(Index h) const { return start(h ^ 1); }

    // The next half-edge of the face on the left.
    Index next(Index h)
    {
        if (const Index v = end(h); !has_fan_[v])
            make_fan(v);
        return next_[h];
    }

private:
    // Puts the half-edges that leave a vertex in order.
    void make_fan(Index v)
    {
        has_fan_[v] = 1;
        const std::span<Index> fan = leaving_[v];
        const Vector2d& centre = graph_.vertex[v];
        std::sort(fan.begin(), fan.end(), [&](Index g, Index h) {
            const Vector2d &a = graph_.vertex[end(g)], &b = graph_.vertex[end(h)];
            const bool a_right = is_before(centre, a), b_right = is_before(centre, b);
            return a_right != b_right ? a_right : turn(centre, a, b) > 0;
        });
        // With the face on the left, take the half-edge just before the reversed one, counter-clockwise.
        for (std::size_t i = 0; i < fan.size(); ++i)
            next_[fan[i] ^ 1] = fan[i == 0 ? fan.size() - 1 : i - 1];
    }

    const Graph& graph_;
    std::vector<Index> next_;
    std::vector<char> has_fan_;
    Grouped<Index> leaving_; // half-edges, by the vertex
};

// Closed rings of vertices, one after the other.
struct Rings {
    std::vector<Index> start{0}, vertex;

    Index count() const { return static_cast<Index>(start.size()) - 1; }
    std::span<const Index> operator[](Index r) const
    {
        return {vertex.data() + start[r], vertex.data() + start[r + 1]};
    }
    void add(std::span<const Index> ring)
    {
        vertex.insert(vertex.end(), ring.begin(), ring.end());
        start.push_back(static_cast<Index>(vertex.size()));
    }
    void clear()
    {
        start.resize(1);
        vertex.clear();
    }
};

// Finds the half-edge that a leftward ray from a vertex meets first, just above the vertex's y so that it
// passes no vertex.
class LeftwardRays
{
public:
    explicit LeftwardRays(const Graph& graph) : graph_(graph)
    {
        low_ = high_ = graph.vertex[0].y();
        for (const Vector2d& v : graph.vertex) {
            low_ = std::min(low_, v.y());
            high_ = std::max(high_, v.y());
        }
        strips_ = std::max<Index>(1, static_cast<Index>(std::sqrt(static_cast<double>(graph.edge.size()))));
        edges_ = {static_cast<std::size_t>(strips_), [&](auto add) {
                      for (Index e = 0; e < static_cast<Index>(graph_.edge.size()); ++e) {
                          const auto [below, above] = upward(e);
                          for (Index s = strip_of(below.y()); s <= strip_of(above.y()); ++s)
                              add(s, e);
                      }
                  }};
    }

    // The half-edge with the ray's face on its left; -1 if the ray meets none. Edges of the vertex's own
    // component must lie to its right.
    Index first_met(Index vertex) const
    {
        const Vector2d& from = graph_.vertex[vertex];
        Index nearest = -1;
        for (const Index e : edges_[strip_of(from.y())]) {
            const auto [below, above] = upward(e);
            if (!(below.y() <= from.y() && from.y() < above.y()) || turn(below, above, from) >= 0)
                continue; // off the ray, or not left of the vertex
            if (nearest < 0 || is_left_of(nearest, e))
                nearest = e;
        }
        if (nearest < 0)
            return -1;
        const Edge& e = graph_.edge[nearest]; // downward, what is on its left is on the right of the page
        return graph_.vertex[e.first].y() < graph_.vertex[e.second].y() ? 2 * nearest + 1 : 2 * nearest;
    }

private:
    Index strip_of(double y) const
    {
        const double strip = high_ > low_ ? (y - low_) / (high_ - low_) * strips_ : 0;
        return std::min(static_cast<Index>(strip), strips_ - 1);
    }
    std::pair<Vector2d, Vector2d> upward(Index e) const
    {
        const Vector2d &p = graph_.vertex[graph_.edge[e].first], &q = graph_.vertex[graph_.edge[e].second];
        return p.y() < q.y() ? std::pair(p, q) : std::pair(q, p);
    }
    // Order of two edges that the ray meets and that do not cross.
    bool is_left_of(Index e, Index f) const
    {
        const auto [a, b] = upward(e);
        const auto [c, d] = upward(f);
        // The higher of the lower ends is beside the other edge; at a common lower end the upper ends decide.
        if (a == c)
            return turn(a, b, d) < 0;
        if (a.y() < c.y()) {
            const int side = turn(a, b, c);
            return side != 0 ? side < 0 : turn(a, b, d) < 0;
        }
        const int side = turn(c, d, a);
        return side != 0 ? side > 0 : turn(c, d, b) > 0;
    }

    const Graph& graph_;
    double low_, high_;
    Index strips_;
    Grouped<Index> edges_; // of each strip
};

// Whether a ring is the rim of a component, seen from outside it; exact. At the ring's first vertex from the
// left all edges go to the right, and of the ring's corners there only a rim's has the left within: it turns
// right, or back.
bool is_rim(const std::vector<Vector2d>& vertex, std::span<const Index> ring)
{
    Index first = ring[0];
    for (const Index v : ring)
        if (is_before(vertex[v], vertex[first]))
            first = v;
    const std::size_t n = ring.size();
    for (std::size_t i = 0; i < n; ++i)
        if (ring[i] == first && turn(vertex[ring[i > 0 ? i - 1 : n - 1]], vertex[first],
                                     vertex[ring[i + 1 < n ? i + 1 : 0]]) <= 0)
            return true;
    return false;
}

// Splits a ring into rings that visit no vertex twice: what lies between two visits is a ring of its own.
// `visited_at`, -1 for every vertex, and `path` are work space.
void split_at_pinches(std::span<const Index> ring, std::vector<Index>& visited_at, std::vector<Index>& path,
                      Rings& simple)
{
    path.clear();
    for (const Index v : ring) {
        if (visited_at[v] >= 0) {
            const auto from = static_cast<std::size_t>(visited_at[v]);
            simple.add(std::span(path).subspan(from));
            for (std::size_t i = from + 1; i < path.size(); ++i)
                visited_at[path[i]] = -1;
            path.resize(from + 1);
            continue;
        }
        visited_at[v] = static_cast<Index>(path.size());
        path.push_back(v);
    }
    simple.add(path);
    for (const Index v : path)
        visited_at[v] = -1;
}

} // namespace

double ring_area(const std::vector<Vector2d>& vertex, std::span<const Index> ring)
{
    const Vector2d& origin = vertex[ring[0]];
    double twice = 0;
    for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
        const Vector2d a = vertex[ring[i]] - origin, b = vertex[ring[i + 1]] - origin;
        twice += a.x() * b.y() - a.y() * b.x();
    }
    return twice / 2;
}

Inside::Inside(const Polygon& polygon) : polygon_(polygon), low_(polygon[0]), high_(polygon[0])
{
    double climb = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        low_ = low_.cwiseMin(polygon[i]);
        high_ = high_.cwiseMax(polygon[i]);
        climb += std::abs(polygon[i + 1 < polygon.size() ? i + 1 : 0].y() - polygon[i].y());
    }
    // As many as there are sides, but a side of average height is in five of them at most.
    if (climb > 0)
        strips_ += static_cast<Index>(static_cast<double>(polygon.size()) *
                                      std::min(1.0, 4 * (high_.y() - low_.y()) / climb));
    sides_ = {static_cast<std::size_t>(strips_), [&](auto add) {
                  for (std::size_t i = 0; i < polygon.size(); ++i)
                      for (auto [strip, last] = strips_of(i); strip <= last; ++strip)
                          add(strip, static_cast<Index>(i));
              }};
}

Index Inside::strip_of(double y) const
{
    const double height = high_.y() - low_.y(), strip = height > 0 ? (y - low_.y()) / height * strips_ : 0;
    return std::min(static_cast<Index>(strip), strips_ - 1);
}

std::array<Index, 2> Inside::strips_of(std::size_t side) const
{
    const Vector2d &p = polygon_[side], &q = polygon_[side + 1 < polygon_.size() ? side + 1 : 0];
    const auto [low, high] = std::minmax({strip_of(p.y()), strip_of(q.y())});
    return {low, high};
}

bool Inside::holds(const Vector2d& place) const
{
    if (!((place.array() >= low_.array()).all() && (place.array() <= high_.array()).all()))
        return false;
    bool inside = false;
    for (const Index side : sides_[strip_of(place.y())]) {
        const auto i = static_cast<std::size_t>(side);
        const Vector2d &p = polygon_[i], &q = polygon_[i + 1 < polygon_.size() ? i + 1 : 0];
        const bool p_above = p.y() > place.y(), q_above = q.y() > place.y();
        if (p_above == q_above) {
            // Neither crosses the ray to the right; but the place may be on a level side, or at a corner.
            if (p.y() == place.y() && q.y() == place.y() && std::min(p.x(), q.x()) <= place.x() &&
                place.x() <= std::max(p.x(), q.x()))
                return true;
            if (p == place || q == place)
                return true;
            continue;
        }
        const int turned = p_above ? turn(q, p, place) : turn(p, q, place);
        if (turned == 0)
            return true;
        inside ^= turned > 0;
    }
    return inside;
}

std::vector<char> slits(const Graph& graph)
{
    HalfEdges half(graph);
    std::vector<Index> ring_of(half.count(), -1);
    for (Index first = 0; first < half.count(); ++first)
        for (Index h = first; ring_of[h] < 0; h = half.next(h))
            ring_of[h] = first;
    std::vector<char> is_slit(graph.edge.size());
    for (std::size_t e = 0; e < graph.edge.size(); ++e)
        is_slit[e] = ring_of[2 * e] == ring_of[2 * e + 1];
    return is_slit;
}

namespace
{

// The rings of a graph: the walks along half-edges with a face on their left.
struct Traced {
    Rings rings;
    std::vector<Index> ring_of; // of each half-edge
};

Traced traced_rings(const Graph& graph)
{
    HalfEdges half(graph);
    Traced traced;
    traced.rings.vertex.reserve(half.count());
    traced.ring_of.assign(half.count(), -1);
    for (Index first = 0; first < half.count(); ++first) {
        if (traced.ring_of[first] >= 0)
            continue;
        for (Index h = first; traced.ring_of[h] < 0; h = half.next(h)) {
            traced.ring_of[h] = traced.rings.count();
            traced.rings.vertex.push_back(half.start(h));
        }
        traced.rings.start.push_back(static_cast<Index>(traced.rings.vertex.size()));
    }
    return traced;
}

// The face that each ring bounds: as its outer ring, or as the rim of what lies in a hole of it.
struct RingFaces {
    Index n_faces = 0;
    std::vector<double> area;              // of each ring, negative of a rim [m2]
    std::vector<char> is_outer;            // not a rim
    std::vector<Index> face;               // of each ring; -1 of the rims of all
    std::vector<std::vector<Index>> holes; // rims in each face; empty if there are none
};

// A rim is a hole in the face around it, or the rim of all.
void place_rims(RingFaces& found, const std::vector<Index>& rims, const Graph& graph, const Traced& traced)
{
    found.holes.resize(found.n_faces);
    const LeftwardRays rays(graph);
    std::vector<std::pair<Index, Index>> by_tip; // vertex farthest left, rim
    for (const Index r : rims)
        by_tip.emplace_back(*std::ranges::min_element(traced.rings[r],
                                                      [&](Index a, Index b) {
                                                          return is_before(graph.vertex[a], graph.vertex[b]);
                                                      }),
                            r);
    std::ranges::sort(by_tip, [&](const auto& a, const auto& b) {
        return is_before(graph.vertex[a.first], graph.vertex[b.first]);
    });
    // From the left: the rim that a ray meets has been placed before.
    for (const auto& [tip, r] : by_tip)
        if (const Index met = rays.first_met(tip); met >= 0)
            found.face[r] = found.face[traced.ring_of[met]];
    for (const Index r : rims)
        if (found.face[r] >= 0)
            found.holes[found.face[r]].push_back(r);
}

RingFaces faces_of_rings(const Graph& graph, const Traced& traced)
{
    const Rings& rings = traced.rings;
    RingFaces found;
    found.area.resize(rings.count());
    found.is_outer.assign(rings.count(), 1);
    found.face.assign(rings.count(), -1);
    std::vector<Index> rims;
    for (Index r = 0; r < rings.count(); ++r) {
        found.area[r] = ring_area(graph.vertex, rings[r]);
        if (is_rim(graph.vertex, rings[r])) {
            rims.push_back(r);
            found.is_outer[r] = 0;
        } else {
            found.face[r] = found.n_faces++;
        }
    }
    if (rims.size() > 1)
        place_rims(found, rims, graph, traced);
    return found;
}

// Faces with their areas and rings, the outer one first; a ring visits no vertex twice.
Faces faces_with_rings(const Graph& graph, const Rings& rings, const RingFaces& found)
{
    Faces faces;
    faces.area.reserve(found.n_faces);
    faces.first_ring = {0};
    faces.ring_start = {0};
    faces.ring_vertex.reserve(rings.vertex.size());
    std::vector<Index> visited_at(graph.vertex.size(), -1), path;
    Rings simple;
    const auto add_ring = [&](std::span<const Index> ring) {
        faces.ring_vertex.insert(faces.ring_vertex.end(), ring.begin(), ring.end());
        faces.ring_start.push_back(static_cast<Index>(faces.ring_vertex.size()));
    };
    for (Index r = 0; r < rings.count(); ++r) {
        if (!found.is_outer[r])
            continue;
        double area = found.area[r];
        simple.clear();
        split_at_pinches(rings[r], visited_at, path, simple);
        if (!found.holes.empty())
            for (const Index hole : found.holes[found.face[r]]) {
                split_at_pinches(rings[hole], visited_at, path, simple);
                area += found.area[hole];
            }
        Index outer = 0;
        for (Index i = 1; i < simple.count() && ring_area(graph.vertex, simple[outer]) <= 0; ++i)
            outer = i;
        add_ring(simple[outer]);
        for (Index i = 0; i < simple.count(); ++i)
            if (i != outer)
                add_ring(simple[i]);
        faces.area.push_back(area);
        faces.first_ring.push_back(static_cast<Index>(faces.ring_start.size()) - 1);
    }
    return faces;
}

} // namespace

Faces trace_faces(const Graph& graph)
{
    const Traced traced = traced_rings(graph);
    const RingFaces found = faces_of_rings(graph, traced);
    Faces faces = faces_with_rings(graph, traced.rings, found);
    faces.sides.resize(graph.edge.size());
    for (std::size_t e = 0; e < graph.edge.size(); ++e)
        faces.sides[e] = {found.face[traced.ring_of[2 * e]], found.face[traced.ring_of[2 * e + 1]]};
    return faces;
}

void for_outer_rings(const Graph& graph, const std::vector<char>& is_chosen,
                     const std::function<void(std::span<const Index>, double)>& visit)
{
    HalfEdges half(graph);
    std::vector<char> is_done(half.count(), 0);
    std::vector<Index> ring;
    for (Index first = 0; first < half.count(); ++first) {
        if (is_done[first] || !is_chosen[first / 2])
            continue;
        ring.clear();
        for (Index h = first; !is_done[h]; h = half.next(h)) {
            is_done[h] = 1;
            ring.push_back(half.start(h));
        }
        if (!is_rim(graph.vertex, ring))
            visit(ring, ring_area(graph.vertex, ring));
    }
}

void remove_faces(Faces& faces, const std::vector<char>& is_gone)
{
    Faces left;
    left.first_ring = left.ring_start = {0};
    std::vector<Index> number(faces.size(), -1);
    for (Index face = 0; face < static_cast<Index>(faces.size()); ++face) {
        if (is_gone[face])
            continue;
        number[face] = static_cast<Index>(left.size());
        left.area.push_back(faces.area[face]);
        for (Index r = faces.first_ring[face]; r < faces.first_ring[face + 1]; ++r) {
            const std::span<const Index> ring = faces.ring(r);
            left.ring_vertex.insert(left.ring_vertex.end(), ring.begin(), ring.end());
            left.ring_start.push_back(static_cast<Index>(left.ring_vertex.size()));
        }
        left.first_ring.push_back(static_cast<Index>(left.ring_start.size()) - 1);
    }
    for (const auto& [a, b] : faces.sides)
        left.sides.push_back({a < 0 ? -1 : number[a], b < 0 ? -1 : number[b]});
    faces = std::move(left);
}

Vector2d place_inside(const std::vector<Vector2d>& vertex, const Faces& faces, Index face)
{
    // At the lowest, leftmost corner the ring turns left. The middle of the triangle it makes with its
    // neighbours is inside, unless other vertices are in that triangle: then the middle between the corner
    // and the one farthest from the opposite side is.
    const std::span<const Index> ring = faces.ring(faces.first_ring[face]);
    const std::size_t n = ring.size();
    std::size_t lowest = 0;
    for (std::size_t i = 1; i < n; ++i) {
        const auto &v = vertex[ring[i]], &w = vertex[ring[lowest]];
        if (std::pair(v.y(), v.x()) < std::pair(w.y(), w.x()))
            lowest = i;
    }
    const Vector2d &a = vertex[ring[(lowest + n - 1) % n]], &b = vertex[ring[lowest]],
                   &c = vertex[ring[(lowest + 1) % n]];
    const Vector2d across = c - a;
    const auto distance = [&](const Vector2d& p) {
        return across.x() * (a.y() - p.y()) - across.y() * (a.x() - p.x());
    };
    double farthest = 0;
    Vector2d opposite = (a + c) / 2;
    for (Index r = faces.first_ring[face]; r < faces.first_ring[face + 1]; ++r)
        for (const Index i : faces.ring(r)) {
            const Vector2d& p = vertex[i];
            if (p == a || p == b || p == c)
                continue;
            if (turn(a, b, p) < 0 || turn(b, c, p) < 0 || turn(c, a, p) < 0)
                continue;
            const double d = std::abs(distance(p));
            if (d > farthest) {
                farthest = d;
                opposite = p;
            }
        }
    return (b + opposite) / 2;
}

} // namespace jointcreep::blocks
