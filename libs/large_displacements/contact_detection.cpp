#include "large_displacements/face_contacts.hpp"
#include "large_displacements/face_overlap.hpp"
#include "model/disjoint_sets.hpp"
#include "model/signs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

namespace jointcreep::large_displacements
{

namespace
{

constexpr double same_way = 0.7; // cosine between the normals of contacts where one continues the other

using Box = std::array<Vector2d, 2>; // lowest and highest corner [m]
using NearFaces = std::vector<std::pair<Index, Index>>;

bool boxes_overlap(const Box& a, const Box& b)
{
    return (a[0].array() <= b[1].array()).all() && (b[0].array() <= a[1].array()).all();
}

// Adds the pairs of boxes that overlap, found by a grid of square cells of this size [m].
void add_overlapping(const std::vector<Box>& box, double cell, NearFaces& near)
{
    struct Entry {
        std::int64_t x, y;
        Index face;
        bool operator<(const Entry& other) const
        {
            return std::tie(x, y, face) < std::tie(other.x, other.y, other.face);
        }
    };
    std::vector<Entry> entries;
    const auto cell_of = [&](double at) { return static_cast<std::int64_t>(std::floor(at / cell)); };
    for (std::size_t f = 0; f < box.size(); ++f)
        for (std::int64_t x = cell_of(box[f][0].x()); x <= cell_of(box[f][1].x()); ++x)
            for (std::int64_t y = cell_of(box[f][0].y()); y <= cell_of(box[f][1].y()); ++y)
                entries.push_back({x, y, static_cast<Index>(f)});
    std::sort(entries.begin(), entries.end());
    for (std::size_t i = 0; i < entries.size(); ++i)
        for (std::size_t j = i + 1;
             j < entries.size() && entries[j].x == entries[i].x && entries[j].y == entries[i].y; ++j)
            if (boxes_overlap(box[entries[i].face], box[entries[j].face]))
                near.emplace_back(entries[i].face, entries[j].face);
}

// A lower bound of the distance of two faces: seen along and across each of them [m].
double least_distance(const std::array<Vector2d, 2>& a, const std::array<Vector2d, 2>& b)
{
    const Vector2d along_a = a[1] - a[0], along_b = b[0] - b[1];
    double apart = 0;
    for (const Vector2d& axis : {along_a, along(along_a), along_b, along(along_b)}) {
        const double p = (b[0] - a[0]).dot(axis), q = (b[1] - a[0]).dot(axis), end = (a[1] - a[0]).dot(axis);
        apart = std::max(apart,
                         std::max(std::min(p, q) - std::max(0.0, end), std::min(0.0, end) - std::max(p, q)) /
                             axis.norm());
    }
    return apart;
}

} // namespace

// Sharpness of the outlines at the ends of faces, and the faces that make a straight side.
void FaceContacts::find_corners(const std::vector<Vector2d>& place)
{
    constexpr double corner = 0.35; // a turn of this much, 20 degrees, or more is a corner [rad]
    std::unordered_multimap<Index, Index> starting; // faces, by their first gridpoint
    for (std::size_t f = 0; f < faces_.gridpoint.size(); ++f)
        starting.emplace(faces_.gridpoint[f][0], static_cast<Index>(f));
    for (FaceShape& shape : shapes_)
        shape.sharp = {1, 1}; // also where the outline of a ground ends
    DisjointSets sides(faces_.gridpoint.size());
    for (std::size_t f = 0; f < faces_.gridpoint.size(); ++f) {
        const auto p = ends_of(faces_.gridpoint[f], place);
        const Vector2d one = p[1] - p[0];
        // Where several outlines touch at a gridpoint, this one continues by the sharpest turn to the left: its rock is
        // there.
        Index next = -1;
        double most = 0;
        for (auto [it, end] = starting.equal_range(faces_.gridpoint[f][1]); it != end; ++it) {
            const auto q = ends_of(faces_.gridpoint[it->second], place);
            const Vector2d two = q[1] - q[0];
            const double turn = std::atan2(one.x() * two.y() - one.y() * two.x(), one.dot(two));
            if (next < 0 || turn > most) {
                next = it->second;
                most = turn;
            }
        }
        if (next >= 0)
            shapes_[f].sharp[1] = shapes_[next].sharp[0] = std::clamp(most / corner, 0.0, 1.0);
        if (next >= 0 && std::abs(most) < corner)
            sides.join(static_cast<Index>(f), next);
    }
    side_.clear();
    for (std::size_t f = 0; f < faces_.gridpoint.size(); ++f)
        side_.push_back(sides.root(static_cast<Index>(f)));
}

// Finds all pairs of faces that carry load, and those whose boxes are within the skin of each other. Earlier pairs keep
// their state.
void FaceContacts::seek(const std::vector<Vector2d>& place, const std::vector<Vector2d>& move)
{
    ++searches_;
    sought_at_ = place;
    find_corners(place);
    is_sought_ = true;
    farthest_ = raised_ = 0;
    NearFaces near = find_reach(place);
    std::vector<Box> box;
    for (std::size_t f = 0; f < faces_.gridpoint.size(); ++f) {
        const auto ends = ends_of(faces_.gridpoint[f], place), by = ends_of(faces_.gridpoint[f], move);
        const Vector2d beyond = Vector2d::Constant(reach_[f]);
        box.push_back(
            {ends[0].cwiseMin(ends[1]).cwiseMin(ends[0] - by[0]).cwiseMin(ends[1] - by[1]) - beyond,
             ends[0].cwiseMax(ends[1]).cwiseMax(ends[0] - by[0]).cwiseMax(ends[1] - by[1]) + beyond});
    }
    add_overlapping(box, 8 * skin_, near);
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    take_pairs(near);
    find_joints(place);
}

// Finds how far the box of a face reaches beyond it: its depth in another face, or its distance from a face that it is
// bonded to, as it may slide on to the face beside that one. Returns these pairs.
std::vector<std::pair<Index, Index>> FaceContacts::find_reach(const std::vector<Vector2d>& place)
{
    reach_.assign(faces_.gridpoint.size(), skin_ / 2);
    NearFaces near;
    for (const FacePair& pair : pairs_) {
        if (!pair.is_closed && !pair.is_bonded())
            continue;
        near.emplace_back(pair.a, pair.b);
        const auto found = overlap_of(pair, faces_, shapes_, place);
        if (found)
            for (const Index f : {pair.a, pair.b})
                reach_[f] = std::max(reach_[f],
                                     skin_ / 2 + std::max(std::abs(found->gap[0]), std::abs(found->gap[1])));
    }
    return near;
}

// Makes these the pairs, in order; earlier pairs keep their state.
void FaceContacts::take_pairs(const NearFaces& near)
{
    std::vector<FacePair> pairs;
    auto old = pairs_.begin();
    for (const auto& [a, b] : near) {
        while (old != pairs_.end() && std::pair(old->a, old->b) < std::pair(a, b))
            ++old;
        if (old != pairs_.end() && old->a == a && old->b == b)
            pairs.push_back(*old);
        else
            pairs.push_back({.a = a, .b = b, .law = laws_.size() - 1});
    }
    pairs_ = std::move(pairs);
    list_pairs();
}

// The pairs of each face; all of them active.
void FaceContacts::list_pairs()
{
    of_face_.assign(faces_.gridpoint.size(), {});
    for (std::size_t p = 0; p < pairs_.size(); ++p)
        for (const Index f : {pairs_[p].a, pairs_[p].b})
            of_face_[f].push_back(static_cast<Index>(p));
    touch_.assign(pairs_.size(), Touch::settled);
    active_.resize(pairs_.size());
    std::iota(active_.begin(), active_.end(), 0);
}

// Finds the joints that rise as one, if any law dilates. A pair that has come near is raised as the rest of its joint,
// unless its faces are nearer than that.
void FaceContacts::find_joints(const std::vector<Vector2d>& place)
{
    joints_.clear();
    if (!dilates_)
        return;
    std::map<std::pair<Index, Index>, std::vector<Index>> joints;
    for (std::size_t p = 0; p < pairs_.size(); ++p)
        joints[std::minmax({side_[pairs_[p].a], side_[pairs_[p].b]})].push_back(static_cast<Index>(p));
    for (auto& [sides, joint] : joints) {
        double most = 0;
        for (const Index p : joint)
            most = std::max(most, pairs_[p].is_known ? pairs_[p].dilation : 0.0);
        for (const Index p : joint)
            if (!pairs_[p].is_known && pairs_[p].dilation < most) {
                const auto found = overlap_of(pairs_[p], faces_, shapes_, place);
                if (!found || -found->sunk() > most)
                    pairs_[p].raise(most - pairs_[p].dilation);
            }
        joints_.push_back(std::move(joint));
    }
}

// Finds the pairs that may carry load before the next search, and the least displacement of gridpoints before that. The
// other pairs have been checked once, are open, and would stay as they are.
void FaceContacts::find_active()
{
    double most_lead = 0; // largest that a new pair may inherit
    for (const FacePair& pair : pairs_)
        if (pair.is_known)
            most_lead = std::max({most_lead, pair.lead[0], pair.lead[1]});
    active_.clear();
    clearance_.clear();
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
        const double way =
            pairs_[p].is_closed || pairs_[p].is_bonded() ? 0.0 : distance_to_touch(pairs_[p], most_lead);
        if (way > skin_ / 2)
            continue;
        active_.push_back(static_cast<Index>(p));
        clearance_.push_back(way);
    }
    find_touched();
    for (std::size_t i = 0; i < active_.size(); ++i)
        take_forces(static_cast<Index>(i));
}

// The least displacement of gridpoints before an open pair touches [m]. Between two searches no gridpoint moves by more
// than half the skin. So faces turn little, and approach each other by at most twice the displacement. If a face is in
// another one, or gets into it, faces slide out of it no farther than that.
double FaceContacts::distance_to_touch(const FacePair& pair, double most_lead) const
{
    constexpr double never = std::numeric_limits<double>::infinity();
    const auto turn = [&](const Vector2d& face) { // at most
        return std::asin(std::min(1.0, skin_ / face.norm()));
    };
    const auto a = ends_of(faces_.gridpoint[pair.a], sought_at_),
               b = ends_of(faces_.gridpoint[pair.b], sought_at_);
    const Vector2d along_a = a[1] - a[0], along_b = b[0] - b[1];
    const double apart = least_distance(a, b);
    const double lead = std::max({0.0, pair.lead[0], pair.lead[1]}) + (pair.is_known ? 0.0 : most_lead);
    if (apart > (reach_[pair.a] + reach_[pair.b] + lead) * (1 + 1e-9))
        return never;
    const double between =
        std::atan2(std::abs(along_a.x() * along_b.y() - along_a.y() * along_b.x()), along_a.dot(along_b));
    if (between - turn(along_a) - turn(along_b) > std::acos(least_facing) + 1e-9)
        return never;
    return (apart * (1 - 1e-9) - (reach_[pair.a] + reach_[pair.b] - skin_) - lead) / 4;
}

// Finds the gridpoints of active pairs, and the positions of their corners' forces.
void FaceContacts::find_touched()
{
    std::vector<std::array<Index, 2>> corners; // {gridpoint, 4 active + corner}
    for (std::size_t i = 0; i < active_.size(); ++i) {
        const auto &a = faces_.gridpoint[pairs_[active_[i]].a], &b = faces_.gridpoint[pairs_[active_[i]].b];
        auto corner = static_cast<Index>(4 * i);
        for (const Index g : {a[0], a[1], b[0], b[1]})
            corners.push_back({g, corner++});
    }
    std::sort(corners.begin(), corners.end());
    corner_force_.resize(corners.size());
    corner_place_.resize(corners.size());
    touched_.clear();
    touched_start_.clear();
    for (std::size_t k = 0; k < corners.size(); ++k) {
        const auto [g, corner] = corners[k];
        corner_place_[corner] = static_cast<Index>(k);
        if (k > 0 && corners[k - 1][0] == g)
            continue;
        touched_.push_back(g);
        touched_start_.push_back(static_cast<Index>(k));
    }
    touched_start_.push_back(static_cast<Index>(corners.size()));
}

// The longest closed contact that this pair continues: a face slides on from its face to the next one, with about the
// same normal. None if there is none. The pair's normal is given.
const FacePair* FaceContacts::contact_before(const FacePair& pair, const Vector2d& normal,
                                             const std::vector<Vector2d>& place) const
{
    const auto is_next_to = [&](Index f, Index g) {
        const auto p = ends_of(faces_.gridpoint[f], place), q = ends_of(faces_.gridpoint[g], place);
        const double reach = 1e-3 * std::min((p[1] - p[0]).norm(), (q[1] - q[0]).norm());
        return (p[1] - q[0]).norm() <= reach || (p[0] - q[1]).norm() <= reach;
    };
    const FacePair* from = nullptr;
    for (const Index own : {pair.a, pair.b})
        for (const Index p : of_face_[own]) {
            const FacePair& other = pairs_[p];
            if (&other == &pair || !other.is_closed)
                continue;
            const Index partner = other.a == own ? other.b : other.a, next = own == pair.a ? pair.b : pair.a;
            const double same =
                (own == other.a ? 1 : -1) * (own == pair.a ? 1 : -1) * other.normal.dot(normal);
            if (same > same_way && is_next_to(partner, next) &&
                (from == nullptr || other.length > from->length))
                from = &other;
        }
    return from;
}

std::size_t FaceContacts::law_slid_on_to(const FacePair& pair, const FacePair& before) const
{
    const std::size_t of_a = faces_.law[pair.a], of_b = faces_.law[pair.b];
    if (material_[of_a] < 0 || material_[of_a] != material_[of_b])
        return laws_.size() - 1;
    if (material_[before.law] == material_[of_a])
        return before.law;
    return pair.a == before.a || pair.a == before.b ? of_b : of_a; // of the next face
}

} // namespace jointcreep::large_displacements
