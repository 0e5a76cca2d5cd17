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

    // The same number for corners that are one.
    Index gridpoint(Index corner) const { return same_.root(corner); }
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
    // The zone across each side, if the rock holds together there.
    std::vector<std::array<Index, 3>> across(t.triangle.size(), {-1, -1, -1});
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

// What a side of a zone gives to its ends and, if there is one, its middle, where a traction is linear along it: a
// share of its length, and the place where the traction has its mean over that share.
struct OfSide {
    double share;          // [-]
    double end, other_end; // weights of the two ends in the place [-]
};
constexpr OfSide linear_end{1. / 2, 2, 1}, quadratic_end{1. / 6, 1, 0}, quadratic_middle{4. / 6, 1, 1};

// A mesh while it is made of a triangulation.
class Meshing
{
public:
    Meshing(const Scene& scene, const Blocks& blocks, const Triangulation& t)
        : scene_(scene), blocks_(blocks), t_(t), corners_(t, blocks), gridpoint_(3 * t.triangle.size(), -1)
    {
    }

    Mesh mesh()
    {
        add_zones();
        if (scene_.zones_are_quadratic())
            add_middles(mesh_, t_, blocks_);
        mesh_.gridpoint_fixed.assign(mesh_.gridpoint.size(), 0);
        for (const auto& tie : corners_.ties()) {
            mesh_.tie_gridpoint.push_back({gridpoint_at(tie.a), gridpoint_at(tie.b)});
            mesh_.tie_stage.push_back(tie.stage);
        }
        for (const Side& side : t_.side) {
            if (blocks_.edge_boundary[side.edge] >= 0)
                add_boundary(side);
            if (blocks_.edge_kind[side.edge] == static_cast<Index>(EdgeKind::joint) || rests_on_joint(side))
                add_contacts(side);
        }
        return std::move(mesh_);
    }

private:
    // Of the corner 3 z + i; numbered once add_zones() has come by.
    Index& gridpoint_at(Index corner) { return gridpoint_[corners_.gridpoint(corner)]; }
    Index gridpoint_of(Index z, Index vertex)
    {
        return gridpoint_at(3 * z + corner_at(t_.triangle[z], vertex));
    }
    // The middle of a side of the triangulation, in a zone beside it.
    Index middle_of(Index z, const Side& side) const
    {
        const Index i = corner_at(t_.triangle[z], side.vertex[0]),
                    j = corner_at(t_.triangle[z], side.vertex[1]);
        return mesh_.zone_middle[z][(i + 1) % 3 == j ? i : j];
    }
    bool rests_on_joint(const Side& side) const
    {
        const Index boundary = blocks_.edge_boundary[side.edge];
        return boundary >= 0 && !scene_.boundaries[boundary].joint.empty();
    }

    void add_zones();
    void add_boundary(const Side& side);
    void add_contacts(const Side& side);
    void add_contact(const Side& side, Index a, Index b, const Eigen::Vector2d& place,
                     const Eigen::Vector2d& other, const OfSide& of_side);

    const Scene& scene_;
    const Blocks& blocks_;
    const Triangulation& t_;
    const Corners corners_;
    std::vector<Index> gridpoint_; // of each group of corners, at its root
    Mesh mesh_;
    std::map<std::tuple<Index, Index, Index>, Index> contact_of_; // {edge, a or -1 for the ground, b}
};

void Meshing::add_zones()
{
    for (Index z = 0; z < static_cast<Index>(t_.triangle.size()); ++z) {
        std::array<Index, 3> of_zone{};
        for (Index i = 0; i < 3; ++i) {
            Index& g = gridpoint_at(3 * z + i);
            if (g < 0) {
                g = static_cast<Index>(mesh_.gridpoint.size());
                mesh_.gridpoint.push_back(t_.vertex[t_.triangle[z][i]]);
            }
            of_zone[i] = g;
        }
        mesh_.zone_gridpoint.push_back(of_zone);
        mesh_.zone_block.push_back(t_.block[z]);
    }
}

// A side on a boundary: what its boundary condition fixes, unless it rests on a joint.
void Meshing::add_boundary(const Side& side)
{
    const Index boundary = blocks_.edge_boundary[side.edge], z = side.triangle[0];
    if (!rests_on_joint(side)) {
        const Index fixed =
            (scene_.boundaries[boundary].fix_x ? 1 : 0) | (scene_.boundaries[boundary].fix_y ? 2 : 0);
        for (const Index v : side.vertex)
            mesh_.gridpoint_fixed[gridpoint_of(z, v)] |= fixed;
        if (mesh_.is_quadratic())
            mesh_.gridpoint_fixed[middle_of(z, side)] |= fixed;
    }
    mesh_.side_gridpoint.push_back({gridpoint_of(z, side.vertex[0]), gridpoint_of(z, side.vertex[1])});
    if (mesh_.is_quadratic())
        mesh_.side_middle.push_back(middle_of(z, side));
    mesh_.side_zone.push_back(z);
    mesh_.side_boundary.push_back(boundary);
}

void Meshing::add_contacts(const Side& side)
{
    const bool on_ground = rests_on_joint(side);
    const Eigen::Vector2d from = t_.vertex[side.vertex[0]], to = t_.vertex[side.vertex[1]];
    const OfSide& end = mesh_.is_quadratic() ? quadratic_end : linear_end;
    for (int i = 0; i < 2; ++i)
        add_contact(side, on_ground ? -1 : gridpoint_of(side.triangle[1], side.vertex[i]),
                    gridpoint_of(side.triangle[0], side.vertex[i]), i == 0 ? from : to, i == 0 ? to : from,
                    end);
    if (mesh_.is_quadratic())
        add_contact(side, on_ground ? -1 : middle_of(side.triangle[1], side),
                    middle_of(side.triangle[0], side), from, to, quadratic_middle);
}

// The share of a side in the contact of the gridpoint `b`, at `place`, to `a`, or to the ground below it.
void Meshing::add_contact(const Side& side, Index a, Index b, const Eigen::Vector2d& place,
                          const Eigen::Vector2d& other, const OfSide& of_side)
{
    if (a == b)
        return; // the tip of a joint: the rock holds together there
    const auto [found, is_new] =
        contact_of_.try_emplace({side.edge, a, b}, static_cast<Index>(mesh_.contact_edge.size()));
    const Index c = found->second;
    if (is_new) {
        Index ground = a;
        if (rests_on_joint(side)) {
            ground = static_cast<Index>(mesh_.gridpoint.size());
            mesh_.gridpoint.push_back(mesh_.gridpoint[b]);
            mesh_.gridpoint_fixed.push_back(3);
        }
        const auto [first, second] = blocks_.edge_vertex[side.edge];
        mesh_.contact_gridpoint.push_back({ground, b});
        mesh_.contact_edge.push_back(side.edge);
        mesh_.contact_normal.push_back(normal_of(tangent_of(blocks_.vertex[first], blocks_.vertex[second])));
        mesh_.contact_length.push_back(0);
        mesh_.contact_centre.push_back(Eigen::Vector2d::Zero());
    }
    const double length = (t_.vertex[side.vertex[1]] - t_.vertex[side.vertex[0]]).norm();
    const Eigen::Vector2d centre =
        (of_side.end * place + of_side.other_end * other) / (of_side.end + of_side.other_end);
    const double part = of_side.share * length, total = mesh_.contact_length[c] + part;
    mesh_.contact_centre[c] = (mesh_.contact_length[c] * mesh_.contact_centre[c] + part * centre) / total;
    mesh_.contact_length[c] = total;
}

} // namespace

Mesh zone(const Scene& scene, const Blocks& blocks)
{
    const ZoneSize size(scene, blocks);
    const Triangulation t = triangulate(blocks, scene.smallest_zone_size(),
                                        [&size](const Eigen::Vector2d& place) { return size.at(place); });
    return Meshing(scene, blocks, t).mesh();
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
