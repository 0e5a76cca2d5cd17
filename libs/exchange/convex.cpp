#include "exchange/convex.hpp"

#include "model/error.hpp"
#include "model/polygon.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <map>

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

std::vector<std::vector<Index>> triangles_of(const Layer& layer, std::vector<Index> ring)
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
            throw input_error(
                "a block could not be divided into convex parts: its corners are too close to one "
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

} // namespace

std::vector<Index> with_bridges(const Layer& layer, std::size_t row)
{
    const auto ring = [&](Index r) {
        const auto corners = layer.ring(r);
        return std::vector<Index>(corners.begin(), corners.end());
    };
    std::vector<Index> around = ring(layer.first_ring[row]);
    for (Index r = layer.first_ring[row] + 1; r < layer.first_ring[row + 1]; ++r) {
        std::vector<Index> hole = ring(r);
        std::size_t from = 0, to = 0;
        double nearest = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < around.size(); ++i)
            for (std::size_t j = 0; j < hole.size(); ++j) {
                const double distance = (layer.point[around[i]] - layer.point[hole[j]]).squaredNorm();
                if (distance < nearest) {
                    nearest = distance;
                    from = i;
                    to = j;
                }
            }
        // ... from, then the hole from `to` round to `to`, then from again ...
        std::rotate(hole.begin(), hole.begin() + static_cast<std::ptrdiff_t>(to), hole.end());
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
    std::vector<std::vector<Index>> parts = triangles_of(layer, around);
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
