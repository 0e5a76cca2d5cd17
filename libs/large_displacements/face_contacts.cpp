#include "large_displacements/face_contacts.hpp"

#include "large_displacements/in_chunks.hpp"
#include "model/disjoint_sets.hpp"
#include "model/error.hpp"
#include "model/signs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <tuple>
#include <unordered_map>

namespace jointcreep::large_displacements
{

namespace
{

constexpr double rounding = 0.01; // of the shorter face: where two corners meet
constexpr double deepest = 0.5;   // overlap over the depth of the thinner zone, at most
constexpr double deepest_new =
    0.1; // the same where two faces come to touch; farther in, one lies behind the other, or has slid on
constexpr double same_way = 0.7; // cosine between the normals of contacts of which one goes on as the other
constexpr double least_facing = 0.02; // cosine between a face's normal and the other's, turned round

// The overlap of two faces, seen along one line.
struct Overlap {
    Vector2d tangent;            // along a
    std::array<double, 2> on_a;  // ends of the overlap in order along the line, as fractions of a
    std::array<double, 2> on_b;  // and of b
    std::array<double, 2> gap;   // along the normal from a to b [m]
    std::array<double, 2> inset; // at each end: how far the end of a is inside b; below 0: that of b in a [m]
    double length;               // [m]

    Vector2d normal() const { return {tangent.y(), -tangent.x()}; }
    // Everywhere deeper in each other than they overlap: it is other faces of the two corners that touch.
    bool is_behind() const { return -std::max(gap[0], gap[1]) > length; }
    double sunk() const { return -std::min(gap[0], gap[1]); } // the deepest that they are in each other [m]
};

std::optional<Overlap> overlap_along(const Vector2d& tangent, const std::array<Vector2d, 2>& a,
                                     const std::array<Vector2d, 2>& b)
{
    std::optional<Overlap> overlap;
    const std::array<double, 2> along_a{0, (a[1] - a[0]).dot(tangent)},
        along_b{(b[0] - a[0]).dot(tangent), (b[1] - a[0]).dot(tangent)}; // runs the other way
    if (along_a[1] <= 0 || along_b[0] <= along_b[1])
        return overlap;
    // Each end of the overlap is one of a or of b: of the fractions only that of the other is divided for.
    const bool starts_with_a = along_b[1] <= 0, ends_with_a = along_a[1] <= along_b[0];
    const std::array<double, 2> at{starts_with_a ? 0 : along_b[1], ends_with_a ? along_a[1] : along_b[0]};
    if (at[1] <= at[0])
        return overlap;
    Overlap& found = overlap.emplace();
    found.tangent = tangent;
    found.inset = {along_a[0] - along_b[1], along_b[0] - along_a[1]};
    found.length = at[1] - at[0];
    const Vector2d normal = found.normal();
    const auto over = [&](bool is_of_a, double end) {
        return (is_of_a ? end - along_b[0] : end) / (is_of_a ? along_b[1] - along_b[0] : along_a[1]);
    };
    const double first = over(starts_with_a, at[0]), last = over(ends_with_a, at[1]);
    found.on_a = {starts_with_a ? 0 : first, ends_with_a ? 1 : last};
    found.on_b = {starts_with_a ? first : 1, ends_with_a ? last : -0.0};
    for (int i = 0; i < 2; ++i) {
        found.gap[i] =
            (b[0] + found.on_b[i] * (b[1] - b[0]) - a[0] - found.on_a[i] * (a[1] - a[0])).dot(normal);
    }
    return overlap;
}

std::array<Vector2d, 2> ends_of(const std::array<Index, 2>& face, const std::vector<Vector2d>& place)
{
    return {place[face[0]], place[face[1]]};
}

// Seen in the plane of the contact; none where the faces do not look at each other or nothing overlaps.
[[gnu::flatten]] std::optional<Overlap> overlap_of(const FacePair& pair, const Faces& faces,
                                                   const std::vector<FaceShape>& shapes,
                                                   const std::vector<Vector2d>& place)
{
    const FaceShape &shape_a = shapes[pair.a], &shape_b = shapes[pair.b];
    const Vector2d along_a = shape_a.along, along_b = -shape_b.along;
    if (along_a.dot(along_b) < least_facing)
        return {};
    const auto a = ends_of(faces.gridpoint[pair.a], place), b = ends_of(faces.gridpoint[pair.b], place);
    const auto between = overlap_along((along_a + along_b).normalized(), a, b);
    if (!between)
        return {};
    // Which of the two ends that meet at the deeper side lies inside the other face, and whether it is a
    // corner: an end where the outline runs on straight belongs to a face that something sinks into farther
    // on.
    const int deep = between->gap[1] < between->gap[0] ? 1 : 0;
    const double is_end_of_a = std::clamp(
        0.5 + between->inset[deep] / (2 * rounding * std::min(shape_a.length, shape_b.length)), 0.0, 1.0);
    const double of_b = is_end_of_a * shape_a.sharp[deep] + (1 - is_end_of_a) * (1 - shape_b.sharp[1 - deep]);
    return overlap_along((of_b * along_b + (1 - of_b) * along_a).normalized(), a, b);
}

// Whether two faces do not look at each other, or do not overlap by more than rounding: then there is no
// overlap_of() them. Most pairs that are near each other are like that.
bool are_apart(const FacePair& pair, const Faces& faces, const std::vector<FaceShape>& shapes,
               const std::vector<Vector2d>& place)
{
    const Vector2d along_a = shapes[pair.a].along, along_b = -shapes[pair.b].along;
    if (along_a.dot(along_b) < least_facing)
        return true;
    const Vector2d between = along_a + along_b;
    const auto a = ends_of(faces.gridpoint[pair.a], place), b = ends_of(faces.gridpoint[pair.b], place);
    const double end_of_a = (a[1] - a[0]).dot(between), first_of_b = (b[1] - a[0]).dot(between),
                 last_of_b = (b[0] - a[0]).dot(between);
    return std::min(end_of_a, last_of_b) - std::max(0.0, first_of_b) <= -1e-9 * end_of_a;
}

Vector2d at(const std::array<Vector2d, 2>& ends, double fraction)
{
    return ends[0] + fraction * (ends[1] - ends[0]);
}

} // namespace

FaceContacts::FaceContacts(std::vector<joint::Law> laws, std::vector<Index> material, const Vector2d& origin)
    : laws_(std::move(laws)), material_(std::move(material)), origin_(origin)
{
    material_.resize(laws_.size(), -1);
    for (const joint::Law& law : laws_) {
        stiffest_open_ = std::max({stiffest_open_, joint::k_n(law), joint::k_s(law)});
        stiffens_ = stiffens_ || !joint::is_linear(law);
        dilates_ = dilates_ || joint::dilates(law);
    }
    stiffest_ = stiffest_open_;
}

void FaceContacts::set_faces(Faces faces, std::vector<FacePair> known, const std::vector<Vector2d>& place)
{
    faces_ = std::move(faces);
    faces_.law.resize(faces_.gridpoint.size(), laws_.size() - 1);
    std::sort(known.begin(), known.end(),
              [](const FacePair& p, const FacePair& q) { return std::pair(p.a, p.b) < std::pair(q.a, q.b); });
    pairs_ = std::move(known);
    for (FacePair& pair : pairs_)
        pair.sigma = 0; // of the last update, which a checkpoint does not have
    std::vector<double> lengths;
    for (const auto& [from, to] : faces_.gridpoint)
        lengths.push_back((place[to] - place[from]).norm());
    stiffest_ = stiffest_open_;
    most_lead_ = 0;
    for (const FacePair& pair : pairs_)
        if (pair.is_closed)
            most_lead_ = std::max({most_lead_, pair.lead[0], pair.lead[1]});
    skin_ = 0;
    if (!lengths.empty()) {
        const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
        std::nth_element(lengths.begin(), middle, lengths.end());
        skin_ = *middle / 4;
    }
    find_shapes(place, 1);
    seek(place, std::vector<Vector2d>(place.size(), Vector2d::Zero()));
}

void FaceContacts::find_shapes(const std::vector<Vector2d>& place, int threads)
{
    shapes_.resize(faces_.gridpoint.size());
    for_each(static_cast<Index>(shapes_.size()), threads, [&](Index f) {
        const Vector2d way = place[faces_.gridpoint[f][1]] - place[faces_.gridpoint[f][0]];
        shapes_[f].length = way.norm();
        shapes_[f].along = way / shapes_[f].length;
    });
}

void FaceContacts::find_corners(const std::vector<Vector2d>& place)
{
    constexpr double corner = 0.35; // a turn by that much, 20 degrees, and more is a corner [rad]
    std::unordered_multimap<Index, Index> starting; // faces, by their first gridpoint
    for (std::size_t f = 0; f < faces_.gridpoint.size(); ++f)
        starting.emplace(faces_.gridpoint[f][0], static_cast<Index>(f));
    for (FaceShape& shape : shapes_)
        shape.sharp = {1, 1}; // also where the outline of a ground ends
    DisjointSets sides(faces_.gridpoint.size());
    for (std::size_t f = 0; f < faces_.gridpoint.size(); ++f) {
        const auto p = ends_of(faces_.gridpoint[f], place);
        const Vector2d one = p[1] - p[0];
        // Where outlines touch at a gridpoint, this one goes on by the sharpest turn to the left: that is
        // where its rock is.
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

// All pairs of faces that bear something, and those whose boxes come within the skin of each other, by a grid
// of cells; what pairs of before remember stays. A box covers the way of the last step, and reaches as far
// again as its face is in another one, or off one that it is bonded to: there lies the next one to slide on
// to.
void FaceContacts::seek(const std::vector<Vector2d>& place, const std::vector<Vector2d>& move)
{
    ++searches_;
    sought_at_ = place;
    find_corners(place);
    is_sought_ = true;
    farthest_ = raised_ = 0;
    reach_.assign(faces_.gridpoint.size(), skin_ / 2);
    std::vector<std::pair<Index, Index>> near;
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
    const double cell = 8 * skin_;
    struct Entry {
        std::int64_t x, y;
        Index face;
        bool operator<(const Entry& other) const
        {
            return std::tie(x, y, face) < std::tie(other.x, other.y, other.face);
        }
    };
    std::vector<Entry> entries;
    std::vector<std::array<Vector2d, 2>> box;
    const auto cell_of = [&](double at) { return static_cast<std::int64_t>(std::floor(at / cell)); };
    for (std::size_t f = 0; f < faces_.gridpoint.size(); ++f) {
        const auto ends = ends_of(faces_.gridpoint[f], place), way = ends_of(faces_.gridpoint[f], move);
        const Vector2d beyond = Vector2d::Constant(reach_[f]);
        box.push_back(
            {ends[0].cwiseMin(ends[1]).cwiseMin(ends[0] - way[0]).cwiseMin(ends[1] - way[1]) - beyond,
             ends[0].cwiseMax(ends[1]).cwiseMax(ends[0] - way[0]).cwiseMax(ends[1] - way[1]) + beyond});
        for (std::int64_t x = cell_of(box[f][0].x()); x <= cell_of(box[f][1].x()); ++x)
            for (std::int64_t y = cell_of(box[f][0].y()); y <= cell_of(box[f][1].y()); ++y)
                entries.push_back({x, y, static_cast<Index>(f)});
    }
    std::sort(entries.begin(), entries.end());
    for (std::size_t i = 0; i < entries.size(); ++i)
        for (std::size_t j = i + 1;
             j < entries.size() && entries[j].x == entries[i].x && entries[j].y == entries[i].y; ++j) {
            const auto a = entries[i].face, b = entries[j].face;
            if ((box[a][0].array() <= box[b][1].array()).all() &&
                (box[b][0].array() <= box[a][1].array()).all())
                near.emplace_back(a, b);
        }
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());

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
    of_face_.assign(faces_.gridpoint.size(), {});
    for (std::size_t p = 0; p < pairs_.size(); ++p)
        for (const Index f : {pairs_[p].a, pairs_[p].b})
            of_face_[f].push_back(static_cast<Index>(p));
    closes_.assign(pairs_.size(), 0);
    active_.resize(pairs_.size());
    std::iota(active_.begin(), active_.end(), 0);
    joints_.clear();
    if (!dilates_)
        return;
    std::map<std::pair<Index, Index>, std::vector<Index>> joints;
    for (std::size_t p = 0; p < pairs_.size(); ++p)
        joints[std::minmax({side_[pairs_[p].a], side_[pairs_[p].b]})].push_back(static_cast<Index>(p));
    for (auto& [sides, joint] : joints) {
        // What has come near is raised as the rest of its joint is, but for what is nearer than that.
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

// Raises the joints that dilate, for the slip of this step: by x = sum of F tan(psi) slip(x) over sum of F,
// with the forces F that press the pairs of a joint, and the slip of each that leaves it the shear that it
// bears once it is raised. The right side falls with x.
void FaceContacts::dilate(const std::vector<Vector2d>& place, const std::vector<Vector2d>& move)
{
    struct Sheared {
        double share;         // of the work, F tan(psi) [N/m]
        double trial, bears;  // without slip, and the strength, where it is not raised [N/m]
        double rises, shears; // the strength by x, the shear by slip [Pa]
    };
    for (FacePair& pair : pairs_)
        pair.raised = 0;
    std::vector<Sheared> sheared;
    double most = 0;
    for (const std::vector<Index>& joint : joints_) {
        sheared.clear();
        double all = 0, left = 0;
        for (const Index p : joint) {
            const FacePair& pair = pairs_[p];
            const double pressed = -pair.sigma * pair.length;
            if (!pair.is_closed || pressed <= 0)
                continue;
            all += pressed;
            const joint::Law& law = laws_[pair.law];
            const joint::Slopes slopes = joint::slopes(law, pair.state(), pair.sigma);
            if (slopes.tan_psi == 0 || slopes.k_s == 0)
                continue;
            left = std::max(left, joint::dilation_end(law) - pair.dilation);
            const auto a = ends_of(faces_.gridpoint[pair.a], place),
                       b = ends_of(faces_.gridpoint[pair.b], place),
                       move_a = ends_of(faces_.gridpoint[pair.a], move),
                       move_b = ends_of(faces_.gridpoint[pair.b], move);
            const auto middle = [](const auto& of_ends, const std::array<double, 2>& fractions) {
                return at(of_ends, (fractions[0] + fractions[1]) / 2);
            };
            const Vector2d parted = middle(move_b, pair.on_b) - middle(move_a, pair.on_a),
                           apart = middle(b, pair.on_b) - middle(a, pair.on_a) - parted;
            const auto turn = [](const auto& ends, const auto& way) {
                const Vector2d face = ends[1] - ends[0], by = way[1] - way[0];
                return (face.x() * by.y() - face.y() * by.x()) / face.squaredNorm();
            };
            // What turns together does not slip, as in evaluate(), where the normal turns by this.
            const double turned = -apart.dot(pair.normal) * (turn(a, move_a) + turn(b, move_b)) / 2,
                         slid = parted.dot(along(pair.normal)) - turned;
            const double trial = std::abs(pair.tau + slopes.k_s * slid) * pair.length,
                         presses = pressed - slopes.k_n * pair.length * parted.dot(pair.normal);
            const auto slopes_if = [&](bool is_broken) {
                joint::State state = pair.state();
                state.is_broken = is_broken;
                return joint::slopes(law, state, pair.sigma);
            };
            const auto strength = [&](const joint::Slopes& now) {
                return now.cohesion * pair.length + presses * now.tan_phi;
            };
            const bool is_broken = pair.is_broken || (joint::weakens_by_slip(law) &&
                                                      trial > std::max(0.0, strength(slopes_if(false))));
            const joint::Slopes now = slopes_if(is_broken);
            sheared.push_back({pressed * slopes.tan_psi, trial, strength(now),
                               now.tan_phi * slopes.k_n * pair.length, slopes.k_s * pair.length});
        }
        // The right side, and how fast it falls.
        const auto raising = [&](double x) {
            std::array<double, 2> sum{0, 0};
            for (const Sheared& one : sheared) {
                const double excess = one.trial - one.bears - one.rises * x;
                sum[0] += one.share / all * std::clamp(excess, 0.0, one.trial) / one.shears;
                if (excess > 0 && excess < one.trial)
                    sum[1] += one.share / all * one.rises / one.shears;
            }
            return sum;
        };
        double low = 0, high = sheared.empty() ? 0.0 : raising(0)[0], x = 0;
        if (high == 0)
            continue;
        for (int i = 0; i < 100; ++i) { // Newton's, which ends as soon as it is on the right straight piece
            const auto [raised, slope] = raising(x);
            (raised > x ? low : high) = x;
            double next = (raised + slope * x) / (1 + slope);
            if (!(next >= low && next <= high))
                next = (low + high) / 2;
            const double change = std::abs(next - x);
            x = next;
            if (change <= 1e-15 * x)
                break;
        }
        x = std::min(x, left);
        most = std::max(most, x);
        for (const Index p : joint) {
            pairs_[p].raised = x;
            pairs_[p].raise(x);
        }
    }
    raised_ += most;
}

// Of all pairs, those that may bear anything before faces are sought again, and how far gridpoints have to go
// for that at least. Until then none is farther than half the skin from where it was, so that faces turn
// little, and come no nearer than by twice the way; and where one is in another, or comes to be, others come
// out no farther than that. The pairs that are left out have been seen once, are open, and would stay as they
// are.
void FaceContacts::find_active()
{
    double most_lead = 0; // that an unknown pair may inherit
    for (const FacePair& pair : pairs_)
        if (pair.is_known)
            most_lead = std::max({most_lead, pair.lead[0], pair.lead[1]});
    const auto turn = [&](const Vector2d& way) { // of a face, at most
        return std::asin(std::min(1.0, skin_ / way.norm()));
    };
    const auto way_to = [&](const FacePair& pair) {
        constexpr double never = std::numeric_limits<double>::infinity();
        const auto a = ends_of(faces_.gridpoint[pair.a], sought_at_),
                   b = ends_of(faces_.gridpoint[pair.b], sought_at_);
        const Vector2d along_a = a[1] - a[0], along_b = b[0] - b[1];
        // How far apart the faces are at least: seen along and across either.
        double apart = 0;
        for (const Vector2d& axis : {along_a, along(along_a), along_b, along(along_b)}) {
            const double p = (b[0] - a[0]).dot(axis), q = (b[1] - a[0]).dot(axis),
                         end = (a[1] - a[0]).dot(axis);
            apart = std::max(
                apart, std::max(std::min(p, q) - std::max(0.0, end), std::min(0.0, end) - std::max(p, q)) /
                           axis.norm());
        }
        const double lead = std::max({0.0, pair.lead[0], pair.lead[1]}) + (pair.is_known ? 0.0 : most_lead);
        if (apart > (reach_[pair.a] + reach_[pair.b] + lead) * (1 + 1e-9))
            return never;
        const double between =
            std::atan2(std::abs(along_a.x() * along_b.y() - along_a.y() * along_b.x()), along_a.dot(along_b));
        if (between - turn(along_a) - turn(along_b) > std::acos(least_facing) + 1e-9)
            return never;
        return (apart * (1 - 1e-9) - (reach_[pair.a] + reach_[pair.b] - skin_) - lead) / 4;
    };
    active_.clear();
    way_to_.clear();
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
        const double way = pairs_[p].is_closed || pairs_[p].is_bonded() ? 0.0 : way_to(pairs_[p]);
        if (way > skin_ / 2)
            continue;
        active_.push_back(static_cast<Index>(p));
        way_to_.push_back(way);
    }

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
    for (std::size_t i = 0; i < active_.size(); ++i)
        take_forces(static_cast<Index>(i));
}

// The longest closed contact from which a face of this pair slides on to the next one, pressing in about the
// same direction; none if there is none. The pair's normal is given.
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
    return pair.a == before.a || pair.a == before.b ? of_b : of_a; // of the face that is next
}

void FaceContacts::update(const std::vector<Vector2d>& place, const std::vector<Vector2d>& move, double dt,
                          double viscosity, int threads)
{
    struct Farthest {
        double squared = 0; // [m2]

        void operator+=(const Farthest& other) { squared = std::max(squared, other.squared); }
    };
    const double squared =
        sum_in_chunks<Farthest>(static_cast<Index>(place.size()), threads, [&](Index g, Farthest& some) {
            some += {(place[g] - sought_at_[g]).squaredNorm()};
        }).squared;
    find_shapes(place, threads);
    farthest_ = std::max(farthest_, std::sqrt(squared));
    if (std::sqrt(squared) + raised_ > skin_ / 2)
        seek(place, move);
    if (dilates_)
        dilate(place, move);

    const auto n = static_cast<Index>(pairs_.size());
    Index too_deep = n;
    const double most_lead = most_lead_;
    const auto depth_of = [&](const FacePair& pair) {
        return std::min(faces_.depth[pair.a], faces_.depth[pair.b]);
    };
    // Gaps at these ends a step before, and how far the faces have slid since.
    struct Gaps {
        std::array<double, 2> gap;
        double slid;
    };
    const auto gaps_before = [&](const FacePair& pair, const Overlap& found) {
        const auto move_a = ends_of(faces_.gridpoint[pair.a], move),
                   move_b = ends_of(faces_.gridpoint[pair.b], move);
        Gaps before{found.gap, 0};
        for (int i = 0; i < 2; ++i) {
            const Vector2d parted = at(move_b, found.on_b[i]) - at(move_a, found.on_a[i]);
            before.gap[i] -= parted.dot(found.normal());
            before.slid = std::max(before.slid, std::abs(parted.dot(found.tangent)));
        }
        return before;
    };
    // Whether faces are too far in each other to have come to touch in this step.
    const auto is_deep = [&](const FacePair& pair, const Overlap& found) {
        const auto before = gaps_before(pair, found).gap;
        return std::min(found.sunk(), -std::min(before[0], before[1])) > deepest_new * depth_of(pair);
    };
    const auto evaluate = [&](FacePair& pair, Index index, bool may_close) {
        pair.is_slipping = false;
        pair.friction = pair.damped = 0;
        const auto move_a = ends_of(faces_.gridpoint[pair.a], move),
                   move_b = ends_of(faces_.gridpoint[pair.b], move);
        const auto parted_at = [&](int i) -> Vector2d {
            return at(move_b, pair.on_b[i]) - at(move_a, pair.on_a[i]);
        };
        // Between two moments a force works as the mean of both: here with the first one's half. What
        // dilation opens, neither springs nor dashpots do, and friction pays for it.
        for (int i = 0; i < 2; ++i)
            pair.damped += pair.held[i].dot(parted_at(i) - pair.raised * pair.normal) / 2;
        const auto raising = [&] { // work of it
            return pair.is_closed && pair.raised > 0
                       ? -(pair.force[0] + pair.force[1]).dot(pair.normal) * pair.raised / 2
                       : 0.0;
        };
        const double raised_before = raising();
        pair.held = {Vector2d::Zero(), Vector2d::Zero()};
        const Vector2d last_normal = pair.normal;
        const double last_length = pair.length, last_tau = pair.tau, last_pressed_in = pair.pressed_in,
                     last_sheared_in = pair.sheared_in;
        pair.pressed_in = pair.sheared_in = 0;
        const auto open = [&] {
            pair.friction = last_sheared_in - raised_before;
            pair.is_closed = false;
            if (pair.is_known)
                pair.is_broken = true;
            pair.tau = pair.length = pair.sigma = 0;
        };
        const auto found = overlap_of(pair, faces_, shapes_, place);
        if (!found) {
            open();
            pair.friction += last_pressed_in; // where rock slides off an edge
            return;
        }
        const joint::Law& law = laws_[pair.law];
        const double k_n = joint::k_n(law), k_s = joint::k_s(law);
        std::array<double, 2> closing{};
        for (int i = 0; i < 2; ++i)
            closing[i] = pair.lead[0] + found->on_a[i] * (pair.lead[1] - pair.lead[0]) - found->gap[i];
        const bool is_too_deep = found->sunk() > deepest * depth_of(pair), is_bonded = pair.is_bonded();
        // One that is not known yet may have a lead to inherit.
        const double most = std::max(closing[0], closing[1]) + (pair.is_known ? 0.0 : most_lead);
        if (!pair.is_closed && !is_bonded && (most <= 0 || (is_too_deep && is_deep(pair, *found)))) {
            open();
            return;
        }
        if (is_too_deep) {
#pragma omp critical
            too_deep = std::min(too_deep, index);
            return;
        }
        if (!pair.is_closed && !is_bonded && !may_close) {
            closes_[index] = 1; // if it may
            return;
        }
        std::array<double, 2> part{0, 1}; // of the overlap that is closed
        double in_bonds = 0;              // what springs hold that is lost with the bonds, if they break now
        const auto leave_bonds = [&] {
            const double zero = closing[0] / (closing[0] - closing[1]);
            if (closing[0] < 0)
                part[0] = zero;
            else if (closing[1] < 0)
                part[1] = zero;
            closing = {std::max(closing[0], 0.0), std::max(closing[1], 0.0)};
        };
        if (!pair.is_broken && -k_n * std::min(closing[0], closing[1]) > joint::tensile_strength(law)) {
            pair.is_broken = true;
            in_bonds = along_overlap(law, pair.state(), closing, found->length).stored;
        }
        if (pair.is_broken) {
            if (std::max(closing[0], closing[1]) <= 0) {
                open();
                pair.friction += in_bonds;
                return;
            }
            leave_bonds();
        }
        const bool was_closed = pair.is_closed;
        pair.is_closed = true;
        pair.length = (part[1] - part[0]) * found->length;
        pair.normal = found->normal();
        const auto fraction = [&](const std::array<double, 2>& ends, double at) {
            return ends[0] + at * (ends[1] - ends[0]);
        };
        for (int i = 0; i < 2; ++i) {
            pair.on_a[i] = fraction(found->on_a, part[i]);
            pair.on_b[i] = fraction(found->on_b, part[i]);
        }
        const Vector2d tangent = along(pair.normal);
        const joint::AlongOverlap closed = along_overlap(law, pair.state(), closing, pair.length);

        // Two points a gap apart that turn together move along each other, too; that is no slip.
        const double gap = fraction(found->gap, (part[0] + part[1]) / 2);
        const double turned =
            pair.is_new || last_length == 0 ? 0.0 : gap * (pair.normal - last_normal).dot(tangent);
        const double slid = (parted_at(0) + parted_at(1)).dot(tangent) / 2 - turned;
        // A part that opens takes along the shear that it has; one that closes has none yet.
        const double last_shear = pair.is_new ? 0.0 : last_tau * last_length;
        const double kept = last_tau * (pair.is_new ? pair.length : std::min(last_length, pair.length));
        const double trial = kept + k_s * slid * pair.length;
        const bool was_broken = pair.is_broken;
        const bool weakens =
            !was_broken && joint::weakens_by_slip(law) && std::abs(trial) > closed.strength[0];
        if (weakens) {
            pair.is_broken = true;
            in_bonds = along_overlap(law, pair.state(), closing, found->length).stored;
        }

        // Forces on the ends that are as the traction between them. In the step in which it closes, and in
        // the one before it opens, a contact is closed for a part of the time that its force acts.
        const std::array<double, 2> opening{parted_at(0).dot(pair.normal), parted_at(1).dot(pair.normal)};
        const double deep = (closing[0] + closing[1]) / 2, way = (opening[0] + opening[1]) / 2 - pair.raised;
        double acts = 1;
        if (was_broken && !was_closed && deep < -way)
            acts = (1 - deep / way) / 2;
        else if (was_broken && was_closed && way > 0) {
            const double next = way + (way - pair.way) * deep / (deep + way); // forces go with the closing
            if (next > deep)
                acts = (way + deep) / (way + next);
        }
        pair.way = way;
        for (int i = 0; i < 2; ++i) {
            const double pressed = acts * closed.force_on_ends[i];
            double held = viscosity / dt * closed.stiffness * pair.length / 2 * (opening[i] - pair.raised);
            if (was_broken)
                held = std::min(held, pressed);
            pair.force[i] = (held - pressed) * pair.normal;
            pair.held[i] = held * pair.normal;
        }
        pair.sigma = pair.length > 0 ? -closed.force / pair.length : 0.0;
        pair.stiffest = closed.stiffest;

        const double limit = closed.strength[pair.is_broken ? 1 : 0], shear = [&] {
            if (!joint::remembers(law) || !(pair.length > 0))
                return std::clamp(trial, -limit, limit);
            joint::State state = pair.state();
            const double tau = joint::shear(law, state, kept / pair.length, slid, limit / pair.length);
            pair.memory = state.memory;
            return tau * pair.length;
        }();
        pair.is_slipping = shear != trial;
        const auto sheared_in = [&](double force, double length) {
            return k_s > 0 && length > 0 ? force * force / (2 * k_s * length) : 0.0;
        };
        if (!pair.is_new)
            pair.friction = last_sheared_in - sheared_in(kept, pair.length) + (last_shear - kept) / 2 * slid;
        if (pair.is_slipping && k_s > 0 && pair.length > 0)
            pair.friction += (kept + shear) / 2 * (trial - shear) / (k_s * pair.length);
        pair.is_new = false;
        pair.tau = pair.length > 0 ? shear / pair.length : 0.0;
        double held = 0;
        if (!pair.is_slipping)
            held = std::clamp(shear + viscosity / dt * k_s * pair.length * slid, -limit, limit) - shear;
        for (int i = 0; i < 2; ++i) {
            pair.force[i] += (shear + held) / 2 * tangent;
            pair.held[i] += held / 2 * tangent;
            pair.damped += pair.held[i].dot(parted_at(i) - pair.raised * pair.normal) / 2;
        }
        pair.friction -= raised_before + raising();
        if (weakens)
            leave_bonds();
        pair.pressed_in =
            weakens ? along_overlap(law, pair.state(), closing, (part[1] - part[0]) * found->length).stored
                    : closed.stored;
        if (in_bonds > 0)
            pair.friction += in_bonds - pair.pressed_in;
        pair.sheared_in = sheared_in(shear, pair.length);
    };
    // An open pair that has been seen as such, and whose faces do not face each other: nothing more happens.
    const auto is_idle = [&](const FacePair& pair) {
        return !is_sought_ && !pair.is_closed && !pair.is_bonded() && are_apart(pair, faces_, shapes_, place);
    };
    struct Sum {
        PairEnergy energy;
        double stiffest = 0, most_lead = 0;
        bool closes = false;

        void take(const FacePair& pair)
        {
            energy += {pair.stored(), pair.friction, pair.damped};
            if (!pair.is_closed)
                return;
            stiffest = std::max(stiffest, pair.stiffest);
            most_lead = std::max({most_lead, pair.lead[0], pair.lead[1]});
        }
        void operator+=(const Sum& other)
        {
            energy += other.energy;
            stiffest = std::max(stiffest, other.stiffest);
            most_lead = std::max(most_lead, other.most_lead);
            closes = closes || other.closes;
        }
    };
    Sum sum = sum_in_chunks<Sum>(static_cast<Index>(active_.size()), threads, [&](Index i, Sum& some) {
        if (!is_sought_ && farthest_ + raised_ < way_to_[i])
            return;
        const Index p = active_[i];
        FacePair& pair = pairs_[p];
        if (is_idle(pair)) {
            pair.is_slipping = false;
            pair.friction = pair.damped = 0;
            return;
        }
        const bool was_closed = pair.is_closed;
        evaluate(pair, p, false);
        some.take(pair);
        if (!is_sought_ && (was_closed || pair.is_closed))
            take_forces(i);
        some.closes = some.closes || closes_[p];
    });
    if (too_deep < n)
        throw equilibrium_error(
            "two pieces of rock overlap at " +
            shown(Vector2d(origin_ + place[faces_.gridpoint[pairs_[too_deep].a][0]])) +
            " by more than half the depth of a zone; the joint's normal stiffness is too small "
            "for what presses on it");
    const auto sunk_of = [&](const FacePair& pair) {
        const auto found = overlap_of(pair, faces_, shapes_, place);
        return found ? found->sunk() : 0.0;
    };
    // Those that lie behind come last: what they may have slid on from must have closed.
    for (const bool is_behind : {false, true})
        for (std::size_t i = 0; sum.closes && i < active_.size(); ++i) {
            const Index p = active_[i];
            if (!closes_[p])
                continue;
            FacePair& pair = pairs_[p];
            const auto found = overlap_of(pair, faces_, shapes_, place);
            if (found->is_behind() != is_behind)
                continue;
            closes_[p] = 0;
            const FacePair* const before = contact_before(pair, found->normal(), place);
            if (is_deep(pair, *found) &&
                (before == nullptr || found->sunk() > sunk_of(*before) + deepest_new * depth_of(pair)))
                continue; // another face behind
            if (before == nullptr && (is_behind || (!pair.is_known && -found->sunk() >= pair.lead[0])))
                continue;
            if (before != nullptr && !pair.is_known) {
                // What slides on takes along what its joint remembers. A pair's sides may change
                // places: a's first end looks at b's second one, and `along` turns round with the normal
                // twice over, so that the shear traction keeps its sign. What was nearer than it is raised
                // before it slid on to there, is raised no farther than that.
                const double unraised = (before->lead[0] + before->lead[1]) / 2 - before->dilation;
                const Gaps last = gaps_before(pair, *found);
                const double room = last.slid < found->length ? std::min(last.gap[0], last.gap[1]) - unraised
                                                              : before->dilation;
                pair.dilation = std::max(pair.dilation, std::clamp(room, 0.0, before->dilation));
                pair.law = law_slid_on_to(pair, *before);
                pair.tau = before->tau;
                pair.memory = before->memory;
                pair.lead = {unraised + pair.dilation, unraised + pair.dilation};
            }
            pair.is_known = true;
            evaluate(pair, p, true);
            sum.take(pair);
            if (!is_sought_)
                take_forces(static_cast<Index>(i));
        }
    energy_ = sum.energy;
    most_lead_ = sum.most_lead;
    stiffest_ = std::max(stiffest_open_, sum.stiffest);
    if (is_sought_)
        find_active();
    is_sought_ = false;
}

void FaceContacts::transfer(const Transfer& to, DynamicsState& kept)
{
    to.size(pairs_, kept.pair);
    for (FacePair& pair :
         pairs_) // all members, lest a new one is forgotten; those not passed on are of one update alone
        [[maybe_unused]] auto& [a, b, law, lead, dilation, tau, is_known, is_new, is_closed, is_broken,
                                memory, is_slipping, on_a, on_b, force, normal, raised, way, length, sigma,
                                stiffest, held, pressed_in, sheared_in, friction, damped] = pair;
    std::vector<std::array<Index, 2>> faces;
    for (const FacePair& pair : pairs_)
        faces.push_back({pair.a, pair.b});
    to.values(faces, kept.pair);
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
        pairs_[p].a = faces[p][0];
        pairs_[p].b = faces[p][1];
    }
    to.values(pairs_, kept.law, &FacePair::law);
    to.values(pairs_, kept.first_lead, [](FacePair& pair) -> double& { return pair.lead[0]; });
    to.values(pairs_, kept.second_lead, [](FacePair& pair) -> double& { return pair.lead[1]; });
    to.values(pairs_, kept.dilation, &FacePair::dilation);
    to.values(pairs_, kept.tau, &FacePair::tau);
    to.values(pairs_, kept.is_known, &FacePair::is_known);
    to.values(pairs_, kept.is_new, &FacePair::is_new);
    to.values(pairs_, kept.is_closed, &FacePair::is_closed);
    to.values(pairs_, kept.is_broken, &FacePair::is_broken);
    to.values(pairs_, kept.normal, &FacePair::normal);
    to.values(pairs_, kept.first_memory, [](FacePair& pair) -> double& { return pair.memory[0]; });
    to.values(pairs_, kept.second_memory, [](FacePair& pair) -> double& { return pair.memory[1]; });
    to.values(pairs_, kept.third_memory, [](FacePair& pair) -> double& { return pair.memory[2]; });
    to.values(pairs_, kept.length, &FacePair::length);
    to.values(pairs_, kept.pressed_in, &FacePair::pressed_in);
    to.values(pairs_, kept.sheared_in, &FacePair::sheared_in);
}

void FaceContacts::take_forces(Index active)
{
    const FacePair& pair = pairs_[active_[active]];
    const Index* const at = corner_place_.data() + 4 * static_cast<std::ptrdiff_t>(active);
    for (int end = 0; end < 2; ++end) {
        const Vector2d force = pair.is_closed ? pair.force[end] : Vector2d(Vector2d::Zero());
        corner_force_[at[0]][end] = (1 - pair.on_a[end]) * force;
        corner_force_[at[1]][end] = pair.on_a[end] * force;
        corner_force_[at[2]][end] = -(1 - pair.on_b[end]) * force;
        corner_force_[at[3]][end] = -pair.on_b[end] * force;
    }
}

void FaceContacts::add_forces(std::vector<Vector2d>& force, int threads) const
{
    for_each(static_cast<Index>(touched_.size()), threads, [&](Index i) {
        Vector2d sum = force[touched_[i]];
        for (Index k = touched_start_[i]; k < touched_start_[i + 1]; ++k)
            for (const Vector2d& one : corner_force_[k])
                sum += one;
        force[touched_[i]] = sum;
    });
}

} // namespace jointcreep::large_displacements
