#include "zoning/zone.hpp"

#include "model/signs.hpp"
#include "zoning/triangulation.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

namespace jointcreep::zoning
{

namespace
{

Index corner_at(const std::array<Index, 3>& triangle, Index vertex)
{
    return static_cast<Index>(std::find(triangle.begin(), triangle.end(), vertex) - triangle.begin());
}

} // namespace

Mesh zone(const Scene& scene, const Blocks& blocks)
{
    const Triangulation t = triangulate(blocks, scene.zone_size);
    const auto n_zones = static_cast<Index>(t.triangle.size());

    // Corners of zones that hold together are one gridpoint: those across a side that is no joint.
    std::vector<Index> same(3 * t.triangle.size());
    std::iota(same.begin(), same.end(), 0);
    const auto root = [&](Index c) {
        while (same[c] != c)
            c = same[c] = same[same[c]];
        return c;
    };
    const auto join = [&](Index zone_a, Index zone_b, Index vertex) {
        const Index a = root(3 * zone_a + corner_at(t.triangle[zone_a], vertex)),
                    b = root(3 * zone_b + corner_at(t.triangle[zone_b], vertex));
        same[std::max(a, b)] = std::min(a, b);
    };
    for (Index z = 0; z < n_zones; ++z)
        for (Index i = 0; i < 3; ++i)
            if (const Index other = t.neighbour[z][i]; other > z)
                for (const Index v : {t.triangle[z][(i + 1) % 3], t.triangle[z][(i + 2) % 3]})
                    join(z, other, v);
    for (const Side& side : t.side)
        if (blocks.edge_kind[side.edge] == static_cast<Index>(EdgeKind::welded))
            for (const Index v : side.vertex)
                join(side.triangle[0], side.triangle[1], v);

    Mesh mesh;
    std::vector<Index> gridpoint(same.size(), -1);
    for (Index z = 0; z < n_zones; ++z) {
        std::array<Index, 3> corners{};
        for (Index i = 0; i < 3; ++i) {
            Index& g = gridpoint[root(3 * z + i)];
            if (g < 0) {
                g = static_cast<Index>(mesh.gridpoint.size());
                mesh.gridpoint.push_back(t.vertex[t.triangle[z][i]]);
            }
            corners[i] = g;
        }
        mesh.zone_gridpoint.push_back(corners);
        mesh.zone_block.push_back(t.block[z]);
    }
    mesh.gridpoint_fixed.assign(mesh.gridpoint.size(), 0);

    const auto gridpoint_of = [&](Index z, Index vertex) {
        return gridpoint[root(3 * z + corner_at(t.triangle[z], vertex))];
    };
    std::map<std::tuple<Index, Index, Index>, Index> contact_of; // {edge, a or -1 for the ground, b}
    for (const Side& side : t.side) {
        const Index e = side.edge;
        const Index boundary = blocks.edge_boundary[e];
        const bool rests_on_joint = boundary >= 0 && !scene.boundaries[boundary].joint.empty();
        if (boundary >= 0 && !rests_on_joint) {
            const Index held =
                (scene.boundaries[boundary].fix_x ? 1 : 0) | (scene.boundaries[boundary].fix_y ? 2 : 0);
            for (const Index v : side.vertex)
                mesh.gridpoint_fixed[gridpoint_of(side.triangle[0], v)] |= held;
        }
        if (boundary >= 0) {
            mesh.side_gridpoint.push_back({gridpoint_of(side.triangle[0], side.vertex[0]),
                                           gridpoint_of(side.triangle[0], side.vertex[1])});
            mesh.side_zone.push_back(side.triangle[0]);
            mesh.side_boundary.push_back(boundary);
        }
        if (blocks.edge_kind[e] != static_cast<Index>(EdgeKind::joint) && !rests_on_joint)
            continue;
        const auto [first, second] = blocks.edge_vertex[e];
        const Eigen::Vector2d normal = normal_of(tangent_of(blocks.vertex[first], blocks.vertex[second]));
        const double half = (t.vertex[side.vertex[1]] - t.vertex[side.vertex[0]]).norm() / 2;
        for (int i = 0; i < 2; ++i) {
            const Index v = side.vertex[i];
            const Index b = gridpoint_of(side.triangle[0], v);
            const Index a = rests_on_joint ? -1 : gridpoint_of(side.triangle[1], v);
            if (a == b)
                continue; // the tip of a joint: the rock holds together there
            const auto [found, is_new] =
                contact_of.try_emplace({e, a, b}, static_cast<Index>(mesh.contact_edge.size()));
            const Index c = found->second;
            if (is_new) {
                Index ground = a;
                if (rests_on_joint) {
                    ground = static_cast<Index>(mesh.gridpoint.size());
                    mesh.gridpoint.push_back(t.vertex[v]);
                    mesh.gridpoint_fixed.push_back(3);
                }
                mesh.contact_gridpoint.push_back({ground, b});
                mesh.contact_edge.push_back(e);
                mesh.contact_normal.push_back(normal);
                mesh.contact_length.push_back(0);
                mesh.contact_centre.push_back(Eigen::Vector2d::Zero());
            }
            // What a traction linear along the side gives to this end, it has at a third of the way.
            const Eigen::Vector2d centre = (2 * t.vertex[v] + t.vertex[side.vertex[1 - i]]) / 3;
            const double total = mesh.contact_length[c] + half;
            mesh.contact_centre[c] =
                (mesh.contact_length[c] * mesh.contact_centre[c] + half * centre) / total;
            mesh.contact_length[c] = total;
        }
    }
    return mesh;
}

MeshQuality quality_of(const Mesh& mesh)
{
    constexpr double infinity = std::numeric_limits<double>::infinity();
    MeshQuality quality{infinity, infinity, infinity};
    for (const auto& corners : mesh.zone_gridpoint)
        for (int i = 0; i < 3; ++i) {
            const Eigen::Vector2d at = mesh.gridpoint[corners[i]],
                                  a = mesh.gridpoint[corners[(i + 1) % 3]] - at,
                                  b = mesh.gridpoint[corners[(i + 2) % 3]] - at;
            const double twice_area = a.x() * b.y() - a.y() * b.x();
            quality.shortest_side = std::min(quality.shortest_side, a.norm());
            quality.smallest_altitude = std::min(quality.smallest_altitude, twice_area / (b - a).norm());
            quality.smallest_angle = std::min(quality.smallest_angle, std::atan2(twice_area, a.dot(b)));
        }
    return quality;
}

} // namespace jointcreep::zoning
