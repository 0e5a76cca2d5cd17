#include "zoning/zone.hpp"

#include "model/disjoint_sets.hpp"
#include "model/signs.hpp"
#include "zoning/size.hpp"
#include "zoning/triangulation.hpp"

#include <algorithm>
#include <limits>
#include <map>

namespace jointcreep::zoning
{

namespace
{

Index corner_at(const std::array<Index, 3>& triangle, Index vertex)
{
    return static_cast<Index>(std::find(triangle.begin(), triangle.end(), vertex) - triangle.begin());
}

// Which corners of zones are one gridpoint. Corner i of zone z is 3 z + i.
//
// Two corners at one vertex are connected where their zones share a side there that is no joint, as long as both
// zones are present. Such links are taken in order, the longest-lived first. A link may join two groups that both
// outlive it. Then each group keeps its own gridpoint, and a tie joins them until the link's stage: excavated rock
// must not leave one gridpoint to what it connected. Otherwise the two groups become one gridpoint.
class Corners
{
public:
    struct Tie {
        Index a, b; // corners
        Index stage;
    };

    Corners(const Triangulation& t, const Blocks& blocks)
        : same_(3 * t.triangle.size()), linked_(3 * t.triangle.size())
    {
        const Index for_good = std::numeric_limits<Index>::max();
        const auto life_of = [&](Index z) {
            const Index stage = blocks.block_stage[t.block[z]];
            return stage < 0 ? for_good : stage;
        };
        for (std::size_t z = 0; z < t.triangle.size(); ++z)
            life_.insert(life_.end(), 3, life_of(static_cast<Index>(z)));

        struct Link {
            Index life, a, b;
        };
        std::vector<Link> links;
        const auto link = [&](Index zone_a, Index zone_b, Index vertex) {
            links.push_back({std::min(life_of(zone_a), life_of(zone_b)),
                             3 * zone_a + corner_at(t.triangle[zone_a], vertex),
                             3 * zone_b + corner_at(t.triangle[zone_b], vertex)});
        };
        for (Index z = 0; z < static_cast<Index>(t.triangle.size()); ++z)
            for (Index i = 0; i < 3; ++i)
                if (const Index other = t.neighbour[z][i]; other > z)
                    for (const Index v : {t.triangle[z][(i + 1) % 3], t.triangle[z][(i + 2) % 3]})
                        link(z, other, v);
        for (const Side& side : t.side)
            if (blocks.edge_kind[side.edge] == static_cast<Index>(EdgeKind::bonded))
                for (const Index v : side.vertex)
                    link(side.triangle[0], side.triangle[1], v);
        std::stable_sort(links.begin(), links.end(),
                         [](const Link& p, const Link& q) { return p.life > q.life; });

        for (const Link& l : links) {
            const Index a = same_.root(l.a), b = same_.root(l.b);
            if (a == b || linked_.root(l.a) == linked_.root(l.b))
                continue;
            linked_.join(l.a, l.b);
            if (life_[a] > l.life && life_[b] > l.life) {
                ties_.push_back({l.a, l.b, l.life});
                continue;
            }
            const Index life = std::max(life_[a], life_[b]);
            same_.join(a, b);
            life_[same_.root(a)] = life;
        }
    }

    Index gridpoint(Index corner) const
    {
        return same_.root(corner);
    } // the same number for corners that are one
    const std::vector<Tie>& ties() const { return ties_; }

private:
    DisjointSets same_, linked_; // one gridpoint; connected by links so far
    std::vector<Index> life_;    // stage that ends the longest-lived corner of a group; at its root
    std::vector<Tie> ties_;
};

// Puts a gridpoint in the middle of each side of a zone, two where a joint runs between.
void add_middles(Mesh& mesh, const Triangulation& t, const Blocks& blocks)
{
    const auto place_of = [&t](Index z, Index a, Index b) { // of the side {a, b} of vertices in its zone
        const Index i = corner_at(t.triangle[z], a), j = corner_at(t.triangle[z], b);
        return static_cast<std::size_t>((i + 1) % 3 == j ? i : j);
    };
    for (const auto& corners : t.triangle)
        for (int i = 0; i < 3; ++i)
            mesh.stress_point.push_back(
                (4 * t.vertex[corners[i]] + t.vertex[corners[(i + 1) % 3]] + t.vertex[corners[(i + 2) % 3]]) /
                6);
    mesh.zone_middle.assign(t.triangle.size(), {-1, -1, -1});
    std::vector<std::array<Index, 3>> across(t.triangle.size(),
                                             {-1, -1, -1}); // {zone across each side}, if it holds together
    for (std::size_t z = 0; z < t.triangle.size(); ++z)
        for (int i = 0; i < 3; ++i)
            across[z][(i + 1) % 3] = t.neighbour[z][i];
    for (const Side& side : t.side)
        if (blocks.edge_kind[side.edge] == static_cast<Index>(EdgeKind::bonded))
            for (int i = 0; i < 2; ++i)
                across[side.triangle[i]][place_of(side.triangle[i], side.vertex[0], side.vertex[1])] =
                    side.triangle[1 - i];
    for (Index z = 0; z < static_cast<Index>(t.triangle.size()); ++z)
        for (std::size_t i = 0; i < 3; ++i) {
            if (mesh.zone_middle[z][i] >= 0)
                continue;
            const Index a = t.triangle[z][i], b = t.triangle[z][(i + 1) % 3];
            const auto middle = static_cast<Index>(mesh.gridpoint.size());
            mesh.gridpoint.push_back((t.vertex[a] + t.vertex[b]) / 2);
            mesh.zone_middle[z][i] = middle;
            if (const Index other = across[z][i]; other >= 0)
                mesh.zone_middle[other][place_of(other, a, b)] = middle;
        }
}

// What a side of a zone gives to its ends and, if there is one, its middle, where a traction is linear along it: a share of
// its length, and the place where the traction has its mean over that share.
struct OfSide {
    double share;
    double end, other_end; // weights of the two ends in the place
};
constexpr OfSide linear_end{1. / 2, 2, 1}, quadratic_end{1. / 6, 1, 0}, quadratic_middle{4. / 6, 1, 1};

} // namespace

Mesh zone(const Scene& scene, const Blocks& blocks)
{
    const ZoneSize size(scene, blocks);
    const Triangulation t = triangulate(blocks, scene.smallest_zone_size(),
                                        [&size](const Eigen::Vector2d& place) { return size.at(place); });
    const auto n_zones = static_cast<Index>(t.triangle.size());

    const Corners corners(t, blocks);
    const auto root = [&](Index c) { return corners.gridpoint(c); };

    Mesh mesh;
    std::vector<Index> gridpoint(3 * t.triangle.size(), -1);
    for (Index z = 0; z < n_zones; ++z) {
        std::array<Index, 3> of_zone{};
        for (Index i = 0; i < 3; ++i) {
            Index& g = gridpoint[root(3 * z + i)];
            if (g < 0) {
                g = static_cast<Index>(mesh.gridpoint.size());
                mesh.gridpoint.push_back(t.vertex[t.triangle[z][i]]);
            }
            of_zone[i] = g;
        }
        mesh.zone_gridpoint.push_back(of_zone);
        mesh.zone_block.push_back(t.block[z]);
    }
    if (scene.zones_are_quadratic)
        add_middles(mesh, t, blocks);
    mesh.gridpoint_fixed.assign(mesh.gridpoint.size(), 0);
    for (const auto& tie : corners.ties()) {
        mesh.tie_gridpoint.push_back({gridpoint[root(tie.a)], gridpoint[root(tie.b)]});
        mesh.tie_stage.push_back(tie.stage);
    }

    const auto gridpoint_of = [&](Index z, Index vertex) {
        return gridpoint[root(3 * z + corner_at(t.triangle[z], vertex))];
    };
    // The middle of a side of the triangulation, in a zone beside it.
    const auto middle_of = [&](Index z, const Side& side) {
        const Index i = corner_at(t.triangle[z], side.vertex[0]),
                    j = corner_at(t.triangle[z], side.vertex[1]);
        return mesh.zone_middle[z][(i + 1) % 3 == j ? i : j];
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
            if (mesh.is_quadratic())
                mesh.gridpoint_fixed[middle_of(side.triangle[0], side)] |= held;
        }
        if (boundary >= 0) {
            mesh.side_gridpoint.push_back({gridpoint_of(side.triangle[0], side.vertex[0]),
                                           gridpoint_of(side.triangle[0], side.vertex[1])});
            if (mesh.is_quadratic())
                mesh.side_middle.push_back(middle_of(side.triangle[0], side));
            mesh.side_zone.push_back(side.triangle[0]);
            mesh.side_boundary.push_back(boundary);
        }
        if (blocks.edge_kind[e] != static_cast<Index>(EdgeKind::joint) && !rests_on_joint)
            continue;
        const auto [first, second] = blocks.edge_vertex[e];
        const Eigen::Vector2d normal = normal_of(tangent_of(blocks.vertex[first], blocks.vertex[second]));
        const Eigen::Vector2d from = t.vertex[side.vertex[0]], to = t.vertex[side.vertex[1]];
        const double length = (to - from).norm();
        // A contact of the gridpoint `b` to `a`, or to the ground below it, at `place`.
        const auto add = [&](Index a, Index b, const Eigen::Vector2d& place, const Eigen::Vector2d& other,
                             const OfSide& of_side) {
            if (a == b)
                return; // the tip of a joint: the rock holds together there
            const auto [found, is_new] =
                contact_of.try_emplace({e, a, b}, static_cast<Index>(mesh.contact_edge.size()));
            const Index c = found->second;
            if (is_new) {
                Index ground = a;
                if (rests_on_joint) {
                    ground = static_cast<Index>(mesh.gridpoint.size());
                    mesh.gridpoint.push_back(mesh.gridpoint[b]);
                    mesh.gridpoint_fixed.push_back(3);
                }
                mesh.contact_gridpoint.push_back({ground, b});
                mesh.contact_edge.push_back(e);
                mesh.contact_normal.push_back(normal);
                mesh.contact_length.push_back(0);
                mesh.contact_centre.push_back(Eigen::Vector2d::Zero());
            }
            const Eigen::Vector2d centre =
                (of_side.end * place + of_side.other_end * other) / (of_side.end + of_side.other_end);
            const double part = of_side.share * length, total = mesh.contact_length[c] + part;
            mesh.contact_centre[c] =
                (mesh.contact_length[c] * mesh.contact_centre[c] + part * centre) / total;
            mesh.contact_length[c] = total;
        };
        const OfSide& end = mesh.is_quadratic() ? quadratic_end : linear_end;
        for (int i = 0; i < 2; ++i)
            add(rests_on_joint ? -1 : gridpoint_of(side.triangle[1], side.vertex[i]),
                gridpoint_of(side.triangle[0], side.vertex[i]), i == 0 ? from : to, i == 0 ? to : from, end);
        if (mesh.is_quadratic())
            add(rests_on_joint ? -1 : middle_of(side.triangle[1], side), middle_of(side.triangle[0], side),
                from, to, quadratic_middle);
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
