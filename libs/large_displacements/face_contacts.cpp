#include "large_displacements/face_contacts.hpp"

#include "large_displacements/face_overlap.hpp"
#include "large_displacements/in_chunks.hpp"
#include "model/error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace jointcreep::large_displacements
{

// Of pairs.
struct FaceContacts::Sum {
    PairEnergy energy;
    double stiffest = 0, most_lead = 0;
    bool is_undecided = false;                          // any of them
    Index too_deep = std::numeric_limits<Index>::max(); // the first one

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
        is_undecided = is_undecided || other.is_undecided;
        too_deep = std::min(too_deep, other.too_deep);
    }
};

FaceContacts::FaceContacts(std::vector<joint::Law> laws, std::vector<Index> material, const Vector2d& origin)
    : laws_(std::move(laws)), material_(std::move(material)), origin_(origin)
{
    material_.resize(laws_.size(), -1);
    for (const joint::Law& law : laws_) {
        stiffest_open_ = std::max({stiffest_open_, joint::k_n(law), joint::k_s(law)});
        stiffens_ = stiffens_ || joint::stiffens(law);
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
        pair.sigma = 0; // of the last update; not in a checkpoint
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

// Largest distance of a gridpoint from its position at the last search for pairs [m].
double FaceContacts::farthest_since_search(const std::vector<Vector2d>& place, int threads) const
{
    struct Farthest {
        double squared = 0; // [m2]

        void operator+=(const Farthest& other) { squared = std::max(squared, other.squared); }
    };
    const auto farthest =
        sum_in_chunks<Farthest>(static_cast<Index>(place.size()), threads, [&](Index g, Farthest& some) {
            some += {(place[g] - sought_at_[g]).squaredNorm()};
        });
    return std::sqrt(farthest.squared);
}

void FaceContacts::update(const std::vector<Vector2d>& place, const std::vector<Vector2d>& move, double dt,
                          double viscosity, int threads)
{
    const double farthest = farthest_since_search(place, threads);
    find_shapes(place, threads);
    farthest_ = std::max(farthest_, farthest);
    if (farthest + raised_ > skin_ / 2)
        seek(place, move);
    if (dilates_)
        dilate(place, move);

    const TimeStep step{place, move, dt, viscosity};
    Sum sum = find_forces(step, threads);
    if (sum.is_undecided)
        find_forces_of_undecided(step, sum);
    if (sum.too_deep < static_cast<Index>(pairs_.size()))
        throw equilibrium_error(
            "two pieces of rock overlap at " +
            shown(Vector2d(origin_ + place[faces_.gridpoint[pairs_[sum.too_deep].a][0]])) +
            " by more than half the depth of a zone; the joint's normal stiffness is too small "
            "for what presses on it");
    energy_ = sum.energy;
    most_lead_ = sum.most_lead;
    stiffest_ = std::max(stiffest_open_, sum.stiffest);
    if (is_sought_)
        find_active();
    is_sought_ = false;
}

// Forces of active pairs; those that other pairs decide on are marked only.
FaceContacts::Sum FaceContacts::find_forces(const TimeStep& step, int threads)
{
    return sum_in_chunks<Sum>(static_cast<Index>(active_.size()), threads, [&](Index i, Sum& some) {
        if (!is_sought_ && farthest_ + raised_ < clearance_[i])
            return;
        const Index p = active_[i];
        FacePair& pair = pairs_[p];
        // An open pair, found open before, whose faces do not face each other: no force.
        if (!is_sought_ && !pair.is_closed && !pair.is_bonded() &&
            are_apart(pair, faces_, shapes_, step.place)) {
            pair.is_slipping = false;
            pair.friction = pair.damped = 0;
            return;
        }
        const bool was_closed = pair.is_closed;
        const Touch touch = find_force(pair, step, Decision::none);
        if (touch == Touch::too_deep)
            some.too_deep = std::min(some.too_deep, p);
        else if (touch != Touch::settled) {
            touch_[p] = touch;
            some.is_undecided = true;
            return;
        }
        some.take(pair);
        if (!is_sought_ && (was_closed || pair.is_closed))
            take_forces(i);
    });
}

// Forces of pairs that come to touch, or lie behind. Those that lie behind are last: the pairs they may continue must be
// closed first.
void FaceContacts::find_forces_of_undecided(const TimeStep& step, Sum& sum)
{
    for (const bool is_behind : {false, true})
        for (std::size_t i = 0; i < active_.size(); ++i) {
            const Index p = active_[i];
            FacePair& pair = pairs_[p];
            if (touch_[p] == Touch::settled)
                continue;
            const auto found = overlap_of(pair, faces_, shapes_, step.place);
            if (found->is_behind() != is_behind)
                continue;
            const bool comes = std::exchange(touch_[p], Touch::settled) == Touch::comes_about;
            if (comes ? comes_to_touch(pair, *found, step)
                      : !lies_behind(*found, contact_before(pair, found->normal(), step.place), step)) {
                if (find_force(pair, step, Decision::touches) == Touch::too_deep)
                    sum.too_deep = std::min(sum.too_deep, p);
            } else if (!comes)
                find_force(pair, step, Decision::ends);
            sum.take(pair);
            if (!is_sought_)
                take_forces(static_cast<Index>(i));
        }
}

// The other members of pairs are of one update alone.
void FaceContacts::transfer(const Transfer& to, DynamicsState& kept)
{
    if (to.restores())
        pairs_.clear();
    to.size(pairs_, kept.pair);
    std::vector<std::array<Index, 2>> faces;
    for (const FacePair& pair : pairs_)
        faces.push_back({pair.a, pair.b});
    to.values(faces, kept.pair);
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
        pairs_[p].a = faces[p][0];
        pairs_[p].b = faces[p][1];
    }
    to.values(pairs_, kept.law, &FacePair::law);
    for (const FacePair& pair : pairs_)
        if (pair.law >= laws_.size())
            throw input_error("the state kept is that of another section");
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
    to.values(pairs_, kept.first_reference,
              [](FacePair& pair) -> double& { return pair.creep.reference[0]; });
    to.values(pairs_, kept.second_reference,
              [](FacePair& pair) -> double& { return pair.creep.reference[1]; });
    to.values(pairs_, kept.shear_reference,
              [](FacePair& pair) -> double& { return pair.creep.reference[2]; });
    std::vector<double> crept;
    for (FacePair& pair : pairs_) {
        pair.creep.crept.resize(creep_units(pair.law), 0.0);
        crept.insert(crept.end(), pair.creep.crept.begin(), pair.creep.crept.end());
    }
    to.values(crept, kept.pair_crept);
    auto from = crept.begin();
    for (FacePair& pair : pairs_)
        for (double& one : pair.creep.crept)
            one = *from++;
    to.values(pairs_, kept.pressed_in, &FacePair::pressed_in);
    to.values(pairs_, kept.sheared_in, &FacePair::sheared_in);
}

// The other members are as set_faces() makes them, or of one update alone.
void FaceContacts::pass(Tape& tape)
{
    const std::size_t n_faces = faces_.gridpoint.size();
    tape(stiffest_, farthest_, raised_, is_sought_, most_lead_, energy_.stored, energy_.friction,
         energy_.damped, searches_, sought_at_);
    for (FaceShape& shape : shapes_)
        tape(shape.along, shape.length, shape.sharp);
    pairs_.resize(tape.size(pairs_.size()), FacePair{.a = 0, .b = 0});
    for (FacePair& pair : pairs_) {
        tape.index(pair.a, n_faces);
        tape.index(pair.b, n_faces);
        tape.index(pair.law, laws_.size());
        tape(pair.lead, pair.dilation, pair.tau, pair.is_known, pair.is_new, pair.is_closed, pair.is_broken,
             pair.memory, pair.is_slipping, pair.on_a, pair.on_b, pair.force, pair.normal, pair.raised,
             pair.opened, pair.length, pair.sigma, pair.stiffest, pair.held, pair.pressed_in, pair.sheared_in,
             pair.friction, pair.damped, pair.closing, pair.creep.reference);
        tape.list_of(creep_units(pair.law), pair.creep.crept);
    }
    tape.list_of(n_faces, reach_);
    if (tape.reads())
        list_pairs();
    tape.indices(side_, n_faces);
    joints_.resize(tape.size(joints_.size()));
    for (std::vector<Index>& joint : joints_)
        tape.indices(joint, pairs_.size());
    tape.indices(active_, pairs_.size());
    tape.list(clearance_);
    Tape::check(side_.size() == n_faces && (clearance_.empty() || clearance_.size() == active_.size()));
    if (tape.reads())
        find_touched();
    tape(corner_force_);
}

void FaceContacts::take_forces(Index active)
{
    const FacePair& pair = pairs_[active_[active]];
    const Index* const at = corner_place_.data() + 4 * static_cast<std::ptrdiff_t>(active);
    for (int end = 0; end < 2; ++end) {
        const auto shares =
            pair.on_gridpoints(end, pair.is_closed ? pair.force[end] : Vector2d(Vector2d::Zero()));
        for (int corner = 0; corner < 4; ++corner)
            corner_force_[at[corner]][end] = shares[corner];
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

void FaceContacts::add_forces_of_dashpots(std::vector<Vector2d>& force) const
{
    for (const Index p : active_) {
        const FacePair& pair = pairs_[p];
        if (!pair.is_closed)
            continue;
        const auto &a = faces_.gridpoint[pair.a], &b = faces_.gridpoint[pair.b];
        for (int end = 0; end < 2; ++end) {
            const auto shares = pair.on_gridpoints(end, pair.held[end]);
            force[a[0]] += shares[0];
            force[a[1]] += shares[1];
            force[b[0]] += shares[2];
            force[b[1]] += shares[3];
        }
    }
}

} // namespace jointcreep::large_displacements
