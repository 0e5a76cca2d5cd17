// Scenes and joints for tests of cutting, and what every cut section must hold.

#pragma once

#include "blocks/cut.hpp"
#include "model/network.hpp"
#include "model/scene.hpp"

#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <vector>

namespace jointcreep::test
{

inline Scene section(Polygon outline, double shortest_edge)
{
    Scene scene;
    scene.outline = std::move(outline);
    scene.rock = "rock";
    scene.rocks = {{"rock", 2700, 3e10, 0.25, std::nullopt}};
    scene.cutting = {shortest_edge, 1 * std::numbers::pi / 180};
    scene.asks_for_quadratic_zones = false;
    return scene;
}

inline void add_joint(Joints& joints, const Eigen::Vector2d& from, const Eigen::Vector2d& to, Index set = 0)
{
    const auto j = static_cast<Index>(joints.set.size());
    joints.set.push_back(set);
    joints.number.push_back(j);
    joints.material.push_back(0);
    joints.from.push_back(from);
    joints.to.push_back(to);
    joints.trace_joint.push_back(j);
    joints.trace_from.push_back(from);
    joints.trace_to.push_back(to);
}

inline double area_of(const Polygon& polygon)
{
    double twice = 0;
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
        const Eigen::Vector2d a = polygon[i] - polygon[0], b = polygon[i + 1] - polygon[0];
        twice += a.x() * b.y() - a.y() * b.x();
    }
    return std::abs(twice) / 2;
}

inline double total_area(const Blocks& blocks)
{
    double sum = 0;
    for (const double area : blocks.block_area)
        sum += area;
    return sum;
}

inline bool properly_cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                           const Eigen::Vector2d& d)
{
    // Distance of r from the line through p and q; what is within a micrometre of it is on it.
    const auto side = [](const Eigen::Vector2d& p, const Eigen::Vector2d& q, const Eigen::Vector2d& r) {
        const Eigen::Vector2d u = (q - p).normalized(), v = r - p;
        const double distance = u.x() * v.y() - u.y() * v.x();
        return std::abs(distance) < 1e-6 ? 0.0 : distance;
    };
    return side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0;
}

// All that is wrong with a cut section, "" if nothing is.
inline std::string faults(const Scene& scene, const Blocks& blocks)
{
    std::string faults;
    double area = area_of(scene.outline);
    for (const Polygon& hole : scene.holes)
        area -= area_of(hole);
    if (std::abs(total_area(blocks) - area) > 1e-12 * area)
        faults += "areas do not add up; ";
    for (const double a : blocks.block_area)
        if (!(a > 0))
            faults += "a block without area; ";

    // Every edge has a block on its left, another or none on its right; a joint edge its joint.
    std::map<std::pair<Index, Index>, Index> left_of; // directed edge -> block
    for (std::size_t e = 0; e < blocks.edge_vertex.size(); ++e) {
        const auto [a, b] = blocks.edge_vertex[e];
        const auto [left, right] = blocks.edge_block[e];
        if (left < 0 || left == right)
            faults += "an edge that separates nothing; ";
        const bool is_boundary = blocks.edge_kind[e] == static_cast<Index>(EdgeKind::boundary);
        if (is_boundary != (right < 0))
            faults += "a boundary edge inside, or another outside; ";
        const bool is_joint = blocks.edge_kind[e] == static_cast<Index>(EdgeKind::joint);
        if (is_joint != (blocks.edge_joint[e] >= 0))
            faults += "a joint edge without joint, or the other way round; ";
        if (!left_of.emplace(std::pair(a, b), left).second ||
            (right >= 0 && !left_of.emplace(std::pair(b, a), right).second))
            faults += "an edge twice; ";
    }
    // The rings are made of just these edges, each with its block on the left, and touch themselves nowhere.
    std::size_t ring_edges = 0;
    for (std::size_t block = 0; block + 1 < blocks.block_ring.size(); ++block)
        for (Index r = blocks.block_ring[block]; r < blocks.block_ring[block + 1]; ++r) {
            const Index start = blocks.ring_start[r], n = blocks.ring_start[r + 1] - start;
            std::set<Index> seen;
            for (Index i = 0; i < n; ++i) {
                const Index a = blocks.ring_vertex[start + i], b = blocks.ring_vertex[start + (i + 1) % n];
                const auto found = left_of.find({a, b});
                if (found == left_of.end() || found->second != static_cast<Index>(block))
                    faults += "a ring off its edges; ";
                if (!seen.insert(a).second)
                    faults += "a ring that touches itself; ";
                ++ring_edges;
            }
            if (n < 3)
                faults += "a ring of fewer than three corners; ";
        }
    if (ring_edges != left_of.size())
        faults += "edges on no ring; ";
    // No two edges cross.
    for (std::size_t e = 0; e < blocks.edge_vertex.size() && blocks.edge_vertex.size() < 3000; ++e)
        for (std::size_t f = 0; f < e; ++f) {
            const auto [a, b] = blocks.edge_vertex[e];
            const auto [c, d] = blocks.edge_vertex[f];
            if (a != c && a != d && b != c && b != d &&
                properly_cross(blocks.vertex[a], blocks.vertex[b], blocks.vertex[c], blocks.vertex[d]))
                faults += "edges cross; ";
        }
    return faults;
}

// "" if every metre of every joint has its fate.
inline std::string lost_length(const Joints& joints, const Blocks& blocks)
{
    const JointFates& fates = blocks.fates;
    for (std::size_t j = 0; j < joints.set.size(); ++j) {
        const double length = (joints.to[j] - joints.from[j]).norm();
        const double sum = fates.kept[j] + fates.shared[j] + fates.on_outline[j] + fates.outside[j] +
                           fates.dangling_end[j] + fates.merged[j];
        if (!(std::abs(sum - length) <= 1e-9 * length))
            return "of joint " + std::to_string(j) + " with " + std::to_string(length) + " m there are " +
                   std::to_string(sum);
        if ((fates.fate[j] == static_cast<Index>(JointFate::dropped)) !=
            (fates.kept[j] + fates.shared[j] == 0))
            return "joint " + std::to_string(j) + " is dropped, but has edges, or the other way round";
    }
    return {};
}

} // namespace jointcreep::test
