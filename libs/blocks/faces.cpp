#include "blocks/graph.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_2_algorithms.h>

#include <algorithm>
#include <limits>
#include <numeric>

namespace jointcreep::blocks
{

namespace
{

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel; // predicates only
using Point = Kernel::Point_2;

Point point(const Eigen::Vector2d& v)
{
    return {v.x(), v.y()};
}

// +1 left turn, -1 right turn, 0 straight on; exact.
int turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c)
{
    return static_cast<int>(CGAL::orientation(point(a), point(b), point(c)));
}

// Whether direction centre -> a comes before centre -> b, counter-clockwise from +x; exact.
bool is_before(const Eigen::Vector2d& centre, const Eigen::Vector2d& a, const Eigen::Vector2d& b)
{
    const auto is_upper = [&](const Eigen::Vector2d& v) {
        return v.y() > centre.y() || (v.y() == centre.y() && v.x() > centre.x());
    };
    if (is_upper(a) != is_upper(b))
        return is_upper(a);
    return turn(centre, a, b) > 0;
}

} // namespace

double ring_area(const std::vector<Eigen::Vector2d>& vertex, const std::vector<Index>& ring)
{
    const Eigen::Vector2d& origin = vertex[ring[0]];
    double twice = 0;
    for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
        const Eigen::Vector2d a = vertex[ring[i]] - origin, b = vertex[ring[i + 1]] - origin;
        twice += a.x() * b.y() - a.y() * b.x();
    }
    return twice / 2;
}

bool is_inside(const Polygon& polygon, const Eigen::Vector2d& place)
{
    std::vector<Point> corners;
    corners.reserve(polygon.size());
    for (const Eigen::Vector2d& v : polygon)
        corners.push_back(point(v));
    return CGAL::bounded_side_2(corners.begin(), corners.end(), point(place), Kernel()) !=
           CGAL::ON_UNBOUNDED_SIDE;
}

Faces trace_faces(const Graph& graph)
{
    // Half-edge 2 e runs from an edge's first vertex to its second, 2 e + 1 back.
    const auto n_half = static_cast<Index>(2 * graph.edge.size());
    const auto start = [&](Index h) {
        return h % 2 == 0 ? graph.edge[h / 2].first : graph.edge[h / 2].second;
    };
    const auto end = [&](Index h) { return start(h ^ 1); };

    std::vector<std::vector<Index>> leaving(graph.vertex.size());
    for (Index h = 0; h < n_half; ++h)
        leaving[start(h)].push_back(h);
    std::vector<Index> place_in_fan(n_half);
    for (std::size_t v = 0; v < leaving.size(); ++v) {
        std::sort(leaving[v].begin(), leaving[v].end(), [&](Index g, Index h) {
            return is_before(graph.vertex[v], graph.vertex[end(g)], graph.vertex[end(h)]);
        });
        for (std::size_t i = 0; i < leaving[v].size(); ++i)
            place_in_fan[leaving[v][i]] = static_cast<Index>(i);
    }
    // With the face on the left, turn as sharply right as possible... that is, take the half-edge just before
    // the way back, counter-clockwise.
    const auto next = [&](Index h) {
        const auto& fan = leaving[end(h)];
        const Index back = place_in_fan[h ^ 1];
        return fan[(back + static_cast<Index>(fan.size()) - 1) % static_cast<Index>(fan.size())];
    };

    std::vector<Index> ring_of(n_half, -1);
    std::vector<std::vector<Index>> rings;
    for (Index first = 0; first < n_half; ++first) {
        if (ring_of[first] >= 0)
            continue;
        std::vector<Index> ring;
        for (Index h = first; ring_of[h] < 0; h = next(h)) {
            ring_of[h] = static_cast<Index>(rings.size());
            ring.push_back(start(h));
        }
        rings.push_back(std::move(ring));
    }

    Faces faces;
    std::vector<Index> face_of_ring(rings.size(), -1);
    for (std::size_t r = 0; r < rings.size(); ++r) {
        const double area = ring_area(graph.vertex, rings[r]);
        if (area > 0) {
            face_of_ring[r] = static_cast<Index>(faces.face.size());
            faces.face.push_back({{rings[r]}, area});
        }
    }

    // A clockwise ring is the rim of a connected part: a hole in the smallest face around it, or the rim of
    // all.
    std::vector<Index> part(graph.vertex.size());
    std::iota(part.begin(), part.end(), 0);
    const auto root = [&](Index v) {
        while (part[v] != v)
            v = part[v] = part[part[v]];
        return v;
    };
    for (const Edge& e : graph.edge)
        part[root(e.first)] = root(e.second);
    std::vector<std::size_t> rims;
    for (std::size_t r = 0; r < rings.size(); ++r)
        if (face_of_ring[r] < 0)
            rims.push_back(r);
    for (const std::size_t r : rims) {
        if (rims.size() == 1)
            break; // one connected part has no holes
        double smallest = std::numeric_limits<double>::infinity();
        for (std::size_t f = 0; f < faces.face.size(); ++f) {
            const auto& outer = faces.face[f].rings[0];
            if (root(outer[0]) == root(rings[r][0]))
                continue;
            const double area = ring_area(graph.vertex, outer);
            if (area >= smallest)
                continue;
            Polygon polygon;
            for (const Index v : outer)
                polygon.push_back(graph.vertex[v]);
            if (is_inside(polygon, graph.vertex[rings[r][0]])) {
                smallest = area;
                face_of_ring[r] = static_cast<Index>(f);
            }
        }
        if (face_of_ring[r] >= 0) {
            Face& face = faces.face[face_of_ring[r]];
            face.rings.push_back(rings[r]);
            face.area += ring_area(graph.vertex, rings[r]);
        }
    }

    faces.sides.resize(graph.edge.size());
    for (std::size_t e = 0; e < graph.edge.size(); ++e)
        faces.sides[e] = {face_of_ring[ring_of[2 * e]], face_of_ring[ring_of[2 * e + 1]]};
    return faces;
}

Eigen::Vector2d place_inside(const std::vector<Eigen::Vector2d>& vertex, const Face& face)
{
    // At the lowest, leftmost corner the ring turns left. The middle of the triangle it makes with its
    // neighbours is inside, unless other vertices are in that triangle: then the middle between the corner
    // and the one farthest from the opposite side is.
    const auto& ring = face.rings[0];
    const std::size_t n = ring.size();
    std::size_t lowest = 0;
    for (std::size_t i = 1; i < n; ++i) {
        const auto &v = vertex[ring[i]], &w = vertex[ring[lowest]];
        if (std::pair(v.y(), v.x()) < std::pair(w.y(), w.x()))
            lowest = i;
    }
    const Eigen::Vector2d &a = vertex[ring[(lowest + n - 1) % n]], &b = vertex[ring[lowest]],
                          &c = vertex[ring[(lowest + 1) % n]];
    const Eigen::Vector2d across = c - a;
    const auto distance = [&](const Eigen::Vector2d& p) {
        return across.x() * (a.y() - p.y()) - across.y() * (a.x() - p.x());
    };
    double farthest = 0;
    Eigen::Vector2d opposite = (a + c) / 2;
    for (const auto& r : face.rings)
        for (const Index i : r) {
            const Eigen::Vector2d& p = vertex[i];
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
