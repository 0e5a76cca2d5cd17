#include "large_displacements/dynamics.hpp"
#include "model/signs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace jointcreep::large_displacements
{

namespace
{

using Gridpoints = std::array<Index, 2>;
using ContactsBetween = std::map<Gridpoints, std::vector<std::size_t>>; // gridpoints {lower, higher}

Gridpoints in_order(Index a, Index b)
{
    return {std::min(a, b), std::max(a, b)};
}

// A number that is highest for the contact at both ends of a side and along it. `others`: contacts at its other end.
double fit(std::size_t c, const std::vector<std::size_t>& others, const Mesh& mesh, const Vector2d& normal)
{
    const bool is_at_both = std::ranges::any_of(
        others, [&](std::size_t d) { return mesh.contact_edge[d] == mesh.contact_edge[c]; });
    return std::abs(mesh.contact_normal[c].dot(normal)) + (is_at_both ? 1 : 0);
}

} // namespace

// The fixed ground below boundaries with a joint, along all of them, whether rock is there or not.
void Dynamics::find_ground()
{
    const joint::Contacts& contacts = assembly_.contacts;
    std::map<Index, std::vector<std::size_t>> on_ground; // contacts of a gridpoint
    for (std::size_t c = 0; c < contacts.gridpoint.size(); ++c) {
        const auto [a, b] = contacts.gridpoint[c];
        if (assembly_.zones.corners[a].empty())
            on_ground[b].push_back(c);
    }
    for (std::size_t s = 0; s < mesh_.side_gridpoint.size(); ++s) {
        auto [from, to] = mesh_.side_gridpoint[s];
        const auto& corners = mesh_.zone_gridpoint[mesh_.side_zone[s]];
        const auto first = std::find(corners.begin(), corners.end(), from) - corners.begin();
        if (corners[(first + 1) % 3] != to)
            std::swap(from, to);
        if (!on_ground.contains(from) || !on_ground.contains(to))
            continue;
        for (const std::size_t c : on_ground[from])
            for (const std::size_t d : on_ground[to])
                if (mesh_.contact_edge[c] == mesh_.contact_edge[d])
                    ground_.push_back({contacts.gridpoint[d][0], contacts.gridpoint[c][0]});
    }
}

// The laws of the joints along sides of zones and of the ground, whether rock is there or not.
void Dynamics::find_walls()
{
    ContactsBetween between;
    for (std::size_t c = 0; c < mesh_.contact_gridpoint.size(); ++c)
        between[in_order(mesh_.contact_gridpoint[c][0], mesh_.contact_gridpoint[c][1])].push_back(c);
    const auto contacts_of = [&](Index a, Index b) {
        const auto there = between.find(in_order(a, b));
        return there == between.end() ? std::vector<std::size_t>() : there->second;
    };
    std::map<std::array<double, 4>, std::array<Index, 2>> side_at; // {from, to}
    const auto take = [&](Index from, Index to) {
        const Vector2d &p = mesh_.gridpoint[from], &q = mesh_.gridpoint[to];
        side_at[{p.x(), p.y(), q.x(), q.y()}] = {from, to};
        const auto opposite = side_at.find({q.x(), q.y(), p.x(), p.y()});
        if (opposite == side_at.end())
            return;
        // Both ends are on the edge; the tip of a joint has no contact.
        const Vector2d normal = normal_of(tangent_of(p, q));
        const std::vector<std::size_t> first = contacts_of(from, opposite->second[1]),
                                       second = contacts_of(to, opposite->second[0]);
        std::size_t best = 0;
        double most = 0;
        for (const auto& [some, others] : {std::pair(&first, &second), std::pair(&second, &first)})
            for (const std::size_t c : *some)
                if (const double fits = fit(c, *others, mesh_, normal); fits > most) {
                    most = fits;
                    best = c;
                }
        if (most > 0)
            wall_law_[{from, to}] = wall_law_[opposite->second] = law_of_edge_[mesh_.contact_edge[best]];
    };
    for (std::size_t z = 0; z < assembly_.zones.size(); ++z) {
        const auto corners = assembly_.zones.gridpoints(z);
        for (int i = 0; i < 3; ++i)
            take(corners[i], corners[(i + 1) % 3]);
    }
    for (const auto& [from, to] : ground_)
        take(from, to);
}

// The faces of the present rock and of the ground. Two new faces on the two sides of a joint of the mesh become a pair.
// Other pairs do not change.
void Dynamics::find_faces()
{
    std::vector<std::array<Index, 2>> of_mesh;
    Faces faces = faces_now(of_mesh);
    std::vector<FacePair> known = known_pairs(of_mesh);
    add_pairs_on_joints(of_mesh, known);
    face_of_mesh_ = std::move(of_mesh);
    contacts_.set_faces(std::move(faces), std::move(known), now_.place);
}

// `of_mesh`: receives their own gridpoints, not those of leaders().
Faces Dynamics::faces_now(std::vector<std::array<Index, 2>>& of_mesh)
{
    std::vector<Index> leader = leaders();
    std::map<std::array<double, 2>, Index> ground_at; // each side has its own gridpoints there
    for (const auto& side : ground_)
        for (const Index g : side)
            leader[g] =
                ground_at.try_emplace({mesh_.gridpoint[g].x(), mesh_.gridpoint[g].y()}, g).first->second;

    std::map<std::array<Index, 2>, int> sides; // by leaders
    const auto key = [&](Index from, Index to) { return std::array<Index, 2>{leader[from], leader[to]}; };
    for (std::size_t z = 0; z < assembly_.zones.size(); ++z)
        if (assembly_.zones.is_present[z])
            for (int i = 0; i < 3; ++i)
                ++sides[key(assembly_.zones.gridpoints(z)[i], assembly_.zones.gridpoints(z)[(i + 1) % 3])];
    Faces faces;
    zone_of_face_.clear();
    const auto add = [&](Index from, Index to, Index zone, double depth) {
        zone_of_face_.push_back(zone);
        of_mesh.push_back({from, to});
        faces.gridpoint.push_back(key(from, to));
        faces.depth.push_back(depth);
        const auto wall = wall_law_.find({from, to});
        faces.law.push_back(wall == wall_law_.end() ? contacts_.laws().size() - 1 : wall->second);
    };
    for (std::size_t z = 0; z < assembly_.zones.size(); ++z)
        if (assembly_.zones.is_present[z])
            for (int i = 0; i < 3; ++i) {
                const Index from = assembly_.zones.gridpoints(z)[i],
                            to = assembly_.zones.gridpoints(z)[(i + 1) % 3];
                if (!sides.contains(key(to, from)))
                    add(from, to, static_cast<Index>(z),
                        2 * assembly_.zones.area[z] / (origin_[to] - origin_[from]).norm());
            }
    for (const auto& [from, to] : ground_)
        add(from, to, -1, (mesh_.gridpoint[to] - mesh_.gridpoint[from]).norm());
    return faces;
}

// The earlier pairs whose faces are still present.
std::vector<FacePair> Dynamics::known_pairs(const std::vector<std::array<Index, 2>>& of_mesh) const
{
    std::map<std::array<Index, 2>, Index> face_of; // by gridpoints of the mesh
    for (std::size_t f = 0; f < of_mesh.size(); ++f)
        face_of[of_mesh[f]] = static_cast<Index>(f);
    std::vector<FacePair> known;
    for (const FacePair& pair : contacts_.pairs()) {
        const auto a = face_of.find(face_of_mesh_[pair.a]), b = face_of.find(face_of_mesh_[pair.b]);
        if (!pair.is_known || a == face_of.end() || b == face_of.end())
            continue;
        FacePair kept = pair;
        kept.a = a->second;
        kept.b = b->second;
        if (kept.a > kept.b) {
            std::swap(kept.a, kept.b);
            std::swap(kept.lead[0], kept.lead[1]);
            contacts_.swap_ends(kept.creep, kept.law);
        }
        known.push_back(kept);
    }
    return known;
}

// Adds the pairs of new faces on the two sides of a joint.
void Dynamics::add_pairs_on_joints(const std::vector<std::array<Index, 2>>& of_mesh,
                                   std::vector<FacePair>& known) const
{
    const std::set<std::array<Index, 2>> before(face_of_mesh_.begin(), face_of_mesh_.end());
    const joint::Contacts& contacts = assembly_.contacts;
    ContactsBetween between;
    for (std::size_t c = 0; c < contacts.gridpoint.size(); ++c)
        if (contacts.status[c] != ContactStatus::removed)
            between[in_order(contacts.gridpoint[c][0], contacts.gridpoint[c][1])].push_back(c);
    std::map<std::array<double, 4>, Index> new_at; // {from, to}, at the start
    for (std::size_t f = 0; f < of_mesh.size(); ++f) {
        const auto [from, to] = of_mesh[f];
        if (before.contains(of_mesh[f]))
            continue;
        const Vector2d &p = mesh_.gridpoint[from], &q = mesh_.gridpoint[to];
        new_at[{p.x(), p.y(), q.x(), q.y()}] = static_cast<Index>(f);
        const auto opposite = new_at.find({q.x(), q.y(), p.x(), p.y()});
        if (opposite == new_at.end())
            continue;
        if (const auto pair = pair_on_joint(opposite->second, static_cast<Index>(f), of_mesh, between))
            known.push_back(*pair);
    }
}

// Takes closing and shear from the joint's contacts at both ends; none without contacts.
std::optional<FacePair> Dynamics::pair_on_joint(Index f, Index g,
                                                const std::vector<std::array<Index, 2>>& of_mesh,
                                                const ContactsBetween& between) const
{
    const joint::Contacts& contacts = assembly_.contacts;
    FacePair pair{.a = f, .b = g, .is_known = true};
    const auto [from, to] = of_mesh[g];
    const Vector2d normal = normal_of(tangent_of(mesh_.gridpoint[from], mesh_.gridpoint[to]));
    int n = 0;
    std::array<bool, 2> has_lead{};
    for (int end = 0; end < 2; ++end) {
        const Index a = of_mesh[pair.a][end], b = of_mesh[pair.b][1 - end];
        const auto there = between.find(in_order(a, b));
        if (there == between.end())
            continue; // the tip of a joint
        const std::size_t c =
            *std::max_element(there->second.begin(), there->second.end(), [&](std::size_t i, std::size_t j) {
                return std::abs(contacts.normal[i].dot(normal)) < std::abs(contacts.normal[j].dot(normal));
            });
        pair.law = law_of_edge_[mesh_.contact_edge[c]];
        pair.lead[end] =
            contacts.state[c].dilation - joint::opening(contacts.law[c], contacts.initial_traction[c].x());
        pair.creep.reference[end] = -contacts.traction[c].x();
        has_lead[end] = true;
        pair.tau += contacts.traction[c].y();
        pair.is_broken = n == 0 ? contacts.state[c].is_broken : pair.is_broken || contacts.state[c].is_broken;
        if (n == 0)
            pair.memory = contacts.state[c].memory;
        ++n;
    }
    if (n == 0)
        return {};
    if (joint::has_friction_only(contacts_.laws()[pair.law]))
        pair.is_broken = true; // it never had bonds
    pair.tau /= n;
    pair.creep.reference[2] = pair.tau;
    for (int end = 0; end < 2; ++end)
        if (!has_lead[end]) {
            pair.lead[end] = pair.lead[1 - end];
            pair.creep.reference[end] = pair.creep.reference[1 - end];
        }
    return pair;
}

} // namespace jointcreep::large_displacements
