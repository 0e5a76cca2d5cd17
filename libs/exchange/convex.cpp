#include "exchange/convex.hpp"

#include "model/error.hpp"
#include "model/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace jointcreep::exchange
{

namespace
{

using Eigen::Vector2d;

Vector2d at(const Layer& layer, Index corner)
{
    return layer.point[corner].head<2>();
}

// Twice the area of a triangle, over the product of its two sides at b: the sine of the turn.
double turn(const Vector2d& a, const Vector2d& b, const Vector2d& c)
{
    const double sides = (b - a).norm() * (c - b).norm();
    return sides > 0 ? cross(b - a, c - b) / sides : 0;
}

constexpr double rounding = 1e-12; // of a turn

bool is_convex(const Layer& layer, const std::vector<Index>& ring)
{
    for (std::size_t i = 0, n = ring.size(); i < n; ++i)
        if (turn(at(layer, ring[i]), at(layer, ring[(i + 1) % n]), at(layer, ring[(i + 2) % n])) < -rounding)
            return false;
    return true;
}

// Whether no other corner of the ring is in the triangle of the corner i and its neighbours.
bool is_ear(const Layer& layer, const std::vector<Index>& ring, std::size_t i)
{
    const std::size_t n = ring.size();
    const Index ia = ring[(i + n - 1) % n], ib = ring[i], ic = ring[(i + 1) % n];
    const Vector2d a = at(layer, ia), b = at(layer, ib), c = at(layer, ic);
    if (!(turn(a, b, c) > rounding))
        return false;
    return std::none_of(ring.begin(), ring.end(), [&](Index other) {
        if (other == ia || other == ib || other == ic)
            return false;
        const Vector2d p = at(layer, other);
        return cross(b - a, p - a) >= 0 && cross(c - b, p - b) >= 0 && cross(a - c, p - c) >= 0;
    });
}

std::vector<std::vector<Index>> triangles_of(const Layer& layer, std::size_t row, std::vector<Index> ring)
{
    std::vector<std::vector<Index>> triangles;
    while (ring.size() > 3 && !is_convex(layer, ring)) {
        // The widest ear: thin ones are left for last.
        std::size_t best = ring.size();
        double widest = 0;
        for (std::size_t i = 0, n = ring.size(); i < n; ++i) {
            const Vector2d a = at(layer, ring[(i + n - 1) % n]), b = at(layer, ring[i]),
                           c = at(layer, ring[(i + 1) % n]);
            const double wide = turn(a, b, c);
            if (wide > widest && is_ear(layer, ring, i)) {
                widest = wide;
                best = i;
            }
        }
        if (best == ring.size())
            throw input_error("block " + std::to_string(row) +
                              " could not be divided into convex parts: its corners are too close to one "
                              "line. Set a larger shortest_edge_m in [cutting] of the scene");
        const std::size_t n = ring.size();
        triangles.push_back({ring[(best + n - 1) % n], ring[best], ring[(best + 1) % n]});
        ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(best));
    }
    triangles.push_back(ring);
    return triangles;
}

// Two parts as one over a side that they share, from corner i of the first; empty where that is not convex.
std::vector<Index> joined(const Layer& layer, const std::vector<Index>& one, std::size_t i,
                          const std::vector<Index>& other)
{
    const Index from = one[i], to = one[(i + 1) % one.size()];
    const auto found = std::find(other.begin(), other.end(), to);
    if (found == other.end())
        return {};
    const auto j = static_cast<std::size_t>(found - other.begin());
    if (other[(j + 1) % other.size()] != from)
        return {};
    std::vector<Index> ring;
    for (std::size_t k = 0; k < one.size(); ++k)
        ring.push_back(one[(i + 1 + k) % one.size()]); // to ... from
    for (std::size_t k = 2; k < other.size(); ++k)
        ring.push_back(other[(j + k) % other.size()]);
    return is_convex(layer, ring) ? ring : std::vector<Index>();
}

bool is_before(const Vector2d& a, const Vector2d& b)
{
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
}

// The first side of a ring, counter-clockwise, that a ray from a place inside to the right meets: the farther right
// of its two ends, and where it is met.
struct SideInSight {
    std::size_t end;
    Vector2d met;
};
SideInSight side_in_sight(const Layer& layer, std::size_t row, const std::vector<Index>& ring,
                          const Vector2d& place)
{
    const std::size_t n = ring.size();
    SideInSight seen{n, {std::numeric_limits<double>::infinity(), place.y()}};
    for (std::size_t i = 0; i < n; ++i) {
        const Vector2d a = at(layer, ring[i]), b = at(layer, ring[(i + 1) % n]);
        if (!(a.y() <= place.y() && place.y() < b.y())) // upward, as such a side has the inside on its left
            continue;
        const double x = a.x() + (place.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
        if (x >= place.x() && x < seen.met.x()) {
            seen.met.x() = x;
            seen.end = a.x() > b.x() ? i : (i + 1) % n;
        }
    }
    if (seen.end == n)
        throw input_error("block " + std::to_string(row) + " has a hole that is not inside it");
    return seen;
}

// Whether the way from corner i of a ring, counter-clockwise, to a place begins inside.
bool looks_at(const Layer& layer, const std::vector<Index>& ring, std::size_t i, const Vector2d& place)
{
    const std::size_t n = ring.size();
    const Vector2d a = at(layer, ring[(i + n - 1) % n]), b = at(layer, ring[i]),
                   c = at(layer, ring[(i + 1) % n]);
    const bool left_of_first = cross(b - a, place - b) > 0, left_of_second = cross(c - b, place - b) > 0;
    return cross(b - a, c - b) > 0 ? left_of_first && left_of_second : left_of_first || left_of_second;
}

// A corner of a ring that a place inside sees, to the right of it (Eberly 2015, Triangulation by ear clipping,
// section 3): the end of the side in sight, or, where corners are between, the one nearest to the ray. A corner at
// which bridges begin comes more than once in a ring; the one that looks at the place is taken.
std::size_t corner_in_sight(const Layer& layer, std::size_t row, const std::vector<Index>& ring,
                            const Vector2d& place)
{
    const auto [best, met] = side_in_sight(layer, row, ring, place);
    const Vector2d end = at(layer, ring[best]);
    const double side = end.y() > place.y() ? 1 : -1;
    std::size_t seen = best;
    double least = std::numeric_limits<double>::infinity(), nearest = least;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Vector2d p = at(layer, ring[i]);
        const bool is_between = side * cross(met - place, p - place) >= 0 &&
                                side * cross(end - met, p - met) >= 0 &&
                                side * cross(place - end, p - end) >= 0;
        if (!is_between || !looks_at(layer, ring, i, place))
            continue;
        const double distance = (p - place).norm(), slope = std::abs(p.y() - place.y()) / distance;
        if (slope < least || (slope == least && distance < nearest)) {
            least = slope;
            nearest = distance;
            seen = i;
        }
    }
    return seen;
}

double area_of_ring(const Layer& layer, std::span<const Index> ring)
{
    Polygon polygon;
    for (const Index corner : ring)
        polygon.push_back(at(layer, corner));
    return area_of(polygon);
}

// Refuses parts that do not add up to their polygon.
void check_areas(const Layer& layer, std::size_t row, const std::vector<std::vector<Index>>& parts)
{
    double wanted = 0, found = 0;
    for (Index r = layer.first_ring[row]; r < layer.first_ring[row + 1]; ++r)
        wanted += (r == layer.first_ring[row] ? 1 : -1) * area_of_ring(layer, layer.ring(r));
    for (const std::vector<Index>& part : parts)
        found += area_of_ring(layer, part);
    if (!(std::abs(found - wanted) <= 1e-9 * wanted))
        throw input_error("block " + std::to_string(row) +
                          " could not be divided into convex parts: they have " + shown(found) +
                          " m2, and the block has " + shown(wanted) +
                          " m2. Make the file again from its scene");
}

} // namespace

std::vector<Index> with_bridges(const Layer& layer, std::size_t row)
{
    const auto ring = [&](Index r) {
        const auto corners = layer.ring(r);
        return std::vector<Index>(corners.begin(), corners.end());
    };
    std::vector<Index> around = ring(layer.first_ring[row]);
    std::vector<std::vector<Index>> holes;
    for (Index r = layer.first_ring[row] + 1; r < layer.first_ring[row + 1]; ++r) {
        std::vector<Index>& hole = holes.emplace_back(ring(r));
        const auto rightmost = std::ranges::max_element(
            hole, [&](Index a, Index b) { return is_before(at(layer, a), at(layer, b)); });
        std::rotate(hole.begin(), rightmost, hole.end());
    }
    // From the right: what is right of a hole's rightmost corner is joined in already.
    std::ranges::sort(
        holes, [&](const auto& a, const auto& b) { return is_before(at(layer, b[0]), at(layer, a[0])); });
    for (std::vector<Index>& hole : holes) {
        const std::size_t from = corner_in_sight(layer, row, around, at(layer, hole[0]));
        // ... from, then the hole round to where it began, then from again ...
        hole.push_back(hole.front());
        hole.push_back(around[from]);
        around.insert(around.begin() + static_cast<std::ptrdiff_t>(from) + 1, hole.begin(), hole.end());
    }
    return around;
}

std::vector<std::vector<Index>> convex_parts(const Layer& layer, std::size_t row)
{
    const std::vector<Index> around = with_bridges(layer, row);
    if (is_convex(layer, around))
        return {around};
    std::vector<std::vector<Index>> parts = triangles_of(layer, row, around);
    check_areas(layer, row, parts);
    // Sides that two parts share, once each; a side is where it was after others are gone.
    for (std::size_t p = 0; p < parts.size(); ++p)
        for (bool any = true; any;) {
            any = false;
            for (std::size_t i = 0; i < parts[p].size() && !any; ++i)
                for (std::size_t q = 0; q < parts.size() && !any; ++q)
                    if (q != p)
                        if (const std::vector<Index> ring = joined(layer, parts[p], i, parts[q]);
                            !ring.empty()) {
                            parts[p] = ring;
                            parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(q));
                            if (q < p)
                                --p;
                            any = true;
                        }
        }
    return parts;
}

} // namespace jointcreep::exchange
