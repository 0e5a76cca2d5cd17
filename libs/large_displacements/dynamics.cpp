#include "large_displacements/dynamics.hpp"

#include "large_displacements/in_chunks.hpp"
#include "large_displacements/kahan.hpp"
#include "model/error.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

namespace jointcreep::large_displacements
{

namespace
{

constexpr double safety = 0.9;   // of the largest stable step
constexpr double impacts = 4;    // steps are so much shorter for rigid bodies: what one step misses of an
                                 // impact's beginning is an error of energy
constexpr double at_rest = 1e-4; // [m/s]
constexpr double rounding_of_place = 1e-15; // of positions, over their distance from the section's middle [-]
constexpr double most_rounding = 1e-3;      // of the mean force on a gridpoint
constexpr double slow = 0.01; // below this speed everywhere, motion is stopped at its peaks [m/s]

} // namespace

// Results of moving the rock by one step: energies [J/m] and the largest speed.
struct Dynamics::MovedRock {
    double kinetic = 0, damped = 0;
    double fastest = 0; // [m2/s2]
    Index fastest_gridpoint = -1;

    void see(const Vector2d& velocity, Index g)
    {
        if (velocity.squaredNorm() > fastest) {
            fastest = velocity.squaredNorm();
            fastest_gridpoint = g;
        }
    }
    void operator+=(const MovedRock& other)
    {
        kinetic += other.kinetic;
        damped += other.damped;
        if (other.fastest > fastest) {
            fastest = other.fastest;
            fastest_gridpoint = other.fastest_gridpoint;
        }
    }
};

// Work of loads in a step [J/m].
struct Dynamics::Work {
    double work = 0;
    bool is_gone = false; // any gridpoint farther out than the section's diagonal

    void operator+=(const Work& other)
    {
        work += other.work;
        is_gone = is_gone || other.is_gone;
    }
};

// Factors of a step.
struct Dynamics::Leap {
    double keep; // of velocities [-]
    double gain; // velocity over force per mass [s]
};

struct Dynamics::Balance {
    double largest = 0;  // unbalanced force [N/m]
    double without = 0;  // the same without the forces of dashpots [N/m]
    double mean = 0;     // summed magnitudes of forces, mean of loaded gridpoints [N/m]
    double farthest = 0; // place of a gridpoint from the section's middle [m]
    double change = 0;   // of the contacts' force on a gridpoint since the last check, the largest [N/m]
};

Dynamics::Dynamics(mechanics::Assembly& assembly, const Mesh& mesh, const std::vector<Index>& material,
                   std::vector<char> is_rigid, const joint::Law& found, const Settings& settings)
    : assembly_(assembly), mesh_(mesh), settings_(settings), contacts_({}), is_rigid_(std::move(is_rigid))
{
    low_ = high_ = mesh.gridpoint[0];
    for (const Vector2d& p : mesh.gridpoint) {
        low_ = low_.cwiseMin(p);
        high_ = high_.cwiseMax(p);
    }
    middle_ = (low_ + high_) / 2;
    make_contacts(material, found);

    origin_ = assembly.position;
    for (Vector2d& p : origin_)
        p -= middle_;
    now_.place = origin_;
    for (std::size_t g = 0; g < now_.place.size(); ++g)
        now_.place[g] += assembly.displacement[g];
    now_.velocity.assign(now_.place.size(), Vector2d::Zero());
    zones_ = moving_zones_of(assembly.zones, now_.place);
    const Vector2d diagonal = Vector2d::Constant((high_ - low_).norm());
    low_ -= middle_ + diagonal;
    high_ += diagonal - middle_;
    find_ground();
    find_walls();
    start();
}

// With one law for every edge with contacts.
void Dynamics::make_contacts(const std::vector<Index>& material, const joint::Law& found)
{
    std::vector<joint::Law> laws;
    std::vector<Index> material_of_law;
    law_of_edge_.assign(mesh_.contact_edge.empty()
                            ? 0
                            : *std::max_element(mesh_.contact_edge.begin(), mesh_.contact_edge.end()) + 1,
                        0);
    std::vector<char> has_law(law_of_edge_.size(), 0);
    for (std::size_t c = 0; c < mesh_.contact_edge.size(); ++c) {
        const Index e = mesh_.contact_edge[c];
        if (!has_law[e]) {
            has_law[e] = 1;
            law_of_edge_[e] = laws.size();
            laws.push_back(assembly_.contacts.law[c]);
            material_of_law.push_back(material[c]);
        }
    }
    laws.push_back(found);
    contacts_ = FaceContacts(std::move(laws), std::move(material_of_law), middle_);
}

void Dynamics::start()
{
    released_.assign(now_.place.size(), Vector2d::Zero());
    now_.lost.assign(now_.place.size(), Vector2d::Zero());
    now_.time = now_.time_lost = 0;
    now_.energy = {};
    now_.starts_from_rest = true;
    now_.has_moved = false;
    now_.last_kinetic = 0;
    now_.checks_in_balance = 0;
    now_.last_contact_force.clear();
    in_zones_ = {};
    zones_.corner_force.assign(3 * zones_.zone.size(), Vector2d::Zero());
    now_.velocity.assign(now_.place.size(), Vector2d::Zero());
    now_.force.assign(now_.place.size(), Vector2d::Zero());
    any_deforms_ = false;
    for (std::size_t z = 0; z < assembly_.zones.size(); ++z)
        any_deforms_ = any_deforms_ || deforms(z);
    find_faces();
    find_bodies();
    find_pieces();
    find_time_step(true);
    find_forces(now_.velocity);
    if (contacts_.stiffest() > now_.stiffest_allowed)
        find_time_step(true);
    if (settings_.release > 0) // the excavated rock carried the present unbalanced forces
        for (std::size_t g = 0; g < now_.place.size(); ++g)
            released_[g] = -now_.force[g];
    find_forces(now_.velocity);
    stored_at_start_ = stored();
}

void Dynamics::creep_by(const EquivalentJoints& joints, const std::array<Chain, 2>& of_new_contacts)
{
    std::vector<std::array<Chain, 2>> chains(contacts_.laws().size());
    for (const Index e : mesh_.contact_edge)
        for (int direction = 0; direction < 2; ++direction)
            chains[law_of_edge_[e]][direction] =
                joint::chain_of(joints, static_cast<std::size_t>(e), direction);
    chains.back() = of_new_contacts;
    contacts_.creep_by(std::move(chains));
}

void Dynamics::begin_creep(CreepScheme scheme, double duration)
{
    start();
    contacts_.begin_creep(scheme, duration);
    is_creeping_ = true;
    released_.assign(now_.place.size(), Vector2d::Zero());
    find_forces(now_.velocity);
    stored_at_start_ = stored();
}

double Dynamics::end_creep()
{
    is_creeping_ = false;
    return contacts_.end_creep();
}

void Dynamics::leave_creep()
{
    is_creeping_ = false;
    contacts_.leave_creep();
}

bool Dynamics::slides() const
{
    return now_.time > 2 * settings_.release && now_.fastest > slow;
}

// The leader of each gridpoint: the gridpoint itself, or the one it is tied to.
std::vector<Index> Dynamics::leaders() const
{
    std::vector<Index> leader(now_.place.size());
    std::iota(leader.begin(), leader.end(), 0);
    for (const auto& [follower, first] : assembly_.tied)
        leader[follower] = first;
    return leader;
}

// Sums of the magnitudes of the stiffness blocks of contacts in the rows of gridpoints (Gershgorin) [Pa].
std::vector<double> Dynamics::contact_sums() const
{
    std::vector<double> sums(now_.place.size(), 0.0);
    for (const auto& [from, to] : contacts_.faces().gridpoint)
        for (const Index g : {from, to})
            sums[g] += now_.stiffest_allowed * (now_.place[to] - now_.place[from]).norm();
    for (const auto& [follower, leader] : assembly_.tied)
        sums[leader] += sums[follower];
    return sums;
}

// The same of all blocks. Rotation does not change them.
std::vector<double> Dynamics::stiffness_sums(const std::vector<double>& of_contacts) const
{
    std::vector<double> sums(now_.place.size(), 0.0);
    for (std::size_t z = 0; z < assembly_.zones.size(); ++z)
        if (deforms(z))
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j)
                    sums[assembly_.zones.gridpoints(z)[i]] +=
                        assembly_.zones.area[z] * stiffness_between(assembly_.zones, z, i, j).norm();
    for (const auto& [follower, leader] : assembly_.tied)
        sums[leader] += sums[follower];
    for (std::size_t g = 0; g < sums.size(); ++g)
        sums[g] += of_contacts[g];
    return sums;
}

void Dynamics::find_time_step(bool begins)
{
    // For joints that grow stiffer as they close, with a margin.
    now_.stiffest_allowed =
        contacts_.stiffens() ? joint::room_to_stiffen * contacts_.stiffest() : contacts_.stiffest();
    const std::vector<double> of_contacts = contact_sums(), sums = stiffness_sums(of_contacts);
    const auto stiffest = std::max_element(sums.begin(), sums.end());
    now_.stiffest = *stiffest;
    now_.stiffest_gridpoint = static_cast<Index>(stiffest - sums.begin());

    now_.inverse_mass = lumped_masses(assembly_);
    for (const auto& tie : assembly_.tied)
        now_.inverse_mass[tie[0]] = 0; // moves with the other, which has its mass
    double highest = 0;                // frequency squared
    for (const Body& body : bodies_) {
        double sum = 0;
        for (std::size_t k = 0; k < body.gridpoint.size(); ++k) {
            sum += sums[body.gridpoint[k]] * (1 / body.mass + body.arm[k].squaredNorm() / body.inertia);
            now_.inverse_mass[body.gridpoint[k]] = 0; // moves with the body
        }
        if (!body.is_held())
            highest = std::max(highest, impacts * impacts * sum);
    }
    for (std::size_t g = 0; g < sums.size(); ++g)
        if (double& mass = now_.inverse_mass[g]; mass > 0) {
            highest = std::max(highest, sums[g] / mass);
            mass = 1 / mass;
        }
    if (begins)
        leave_stiff_pieces(highest, impacts, of_contacts);
    const double without = highest;
    for (const Piece& piece : pieces_)
        highest = std::max(highest, frequency_with(piece, without, impacts, of_contacts));
    // Stiffness damping shortens the stable step: (2 / w) (sqrt(1 + xi^2) - xi), xi = beta w / 2.
    const double xi = settings_.stiffness_damping * std::sqrt(highest) / 2;
    now_.dt = highest == 0 ? 1e-3 // all rock is fixed
                           : safety * 2 / std::sqrt(highest) * (std::sqrt(1 + xi * xi) - xi);
}

// Share of a time step that the force at its beginning acts on the velocity before: half of this step and half of the
// last one.
double Dynamics::first_half() const
{
    return now_.starts_from_rest ? 0.5 : (now_.last_dt + now_.dt) / (2 * now_.dt);
}

double Dynamics::release_factor() const
{
    return settings_.release > 0 ? std::max(0.0, 1 - now_.time / settings_.release) : 0.0;
}

void Dynamics::find_forces(const std::vector<Vector2d>& move)
{
    for (const auto& [follower, leader] : assembly_.tied)
        now_.place[follower] = now_.place[leader];
    find_zone_forces();
    contacts_.update(now_.place, move, now_.dt, settings_.stiffness_damping, assembly_.threads);
    const double held = release_factor();
    for_each(static_cast<Index>(now_.place.size()), assembly_.threads, [&](Index g) {
        Vector2d force = assembly_.load[g] + assembly_.applied[g] + held * released_[g];
        if (any_deforms_)
            for (const Index corner : assembly_.zones.corners[g])
                force += zones_.corner_force[corner];
        now_.force[g] = force;
    });
    contacts_.add_forces(now_.force, assembly_.threads);
    give_forces_to_leaders(assembly_, now_.force);
}

// Forces of dashpots on gridpoints, of zones and contacts; those of ties are at their leaders [N/m].
std::vector<Vector2d> Dynamics::forces_of_dashpots() const
{
    std::vector<Vector2d> force(now_.place.size(), Vector2d::Zero());
    contacts_.add_forces_of_dashpots(force);
    if (any_deforms_) {
        std::vector<Vector2d> on_corners(zones_.corner_force.size(), Vector2d::Zero());
        for_each(static_cast<Index>(zones_.zone.size()), assembly_.threads, [&](Index z) {
            if (deforms(z))
                rock::take_corner_forces_of_dashpots(assembly_.zones, zones_, z, now_.place, on_corners);
        });
        for_each(static_cast<Index>(force.size()), assembly_.threads, [&](Index g) {
            for (const Index corner : assembly_.zones.corners[g])
                force[g] += on_corners[corner];
        });
    }
    give_forces_to_leaders(assembly_, force);
    return force;
}

double Dynamics::stored() const
{
    return in_zones_.stored + contacts_.energy().stored;
}

// One step of a gridpoint or body, from velocities half a step before to half a step after: `keep` times the former
// [-], plus `gain` over the mass times the force between [s].
Dynamics::Leap Dynamics::leap(double first_half_of_step) const
{
    const double alpha = settings_.mass_damping;
    return {(1 - alpha * now_.dt / 2) / (1 + alpha * now_.dt / 2),
            first_half_of_step * now_.dt / (1 + alpha * now_.dt / 2)};
}

// Newton's law: velocities, and positions at the end of the step.
Dynamics::MovedRock Dynamics::move_rock()
{
    const auto n = static_cast<Index>(now_.place.size());
    const double alpha = settings_.mass_damping;
    const auto [keep, gain] = leap(first_half());
    move_.resize(n);
    const std::vector<Turn> turning = turns();
    MovedRock moved = sum_in_chunks<MovedRock>(
        n, assembly_.threads, [&, keep = keep, gain = gain](Index g, MovedRock& some) {
            if (now_.inverse_mass[g] == 0) {
                move_[g].setZero();
                return;
            }
            Vector2d& v = now_.velocity[g];
            const Vector2d last = v;
            v = keep * v + gain * now_.inverse_mass[g] * now_.force[g].cwiseProduct(assembly_.is_free[g]);
            if (const Index p = piece_of_[g]; p >= 0)
                v += gain * turning[p].g * turning[p].moment * rotation(now_.place[g] - turning[p].centre);
            const Vector2d now = now_.starts_from_rest ? last : Vector2d((last + v) / 2);
            some.kinetic += last.dot(v) / (2 * now_.inverse_mass[g]);
            some.damped += alpha * now_.dt * now.squaredNorm() / now_.inverse_mass[g];
            some.see(v, g);
            move_[g] = now_.dt * v;
            add(move_[g], now_.place[g], now_.lost[g]);
        });
    moved += sum_in_chunks<MovedRock>(static_cast<Index>(bodies_.size()), assembly_.threads,
                                      [&, keep = keep, gain = gain](Index b, MovedRock& some) {
                                          const double before = move(bodies_[b], keep, gain);
                                          some.kinetic += before;
                                          some.damped += 2 * alpha * now_.dt * before;
                                          for (const Index g : bodies_[b].gridpoint)
                                              some.see(now_.velocity[g], g);
                                      });
    // What lumped masses have too much, see turning_pieces.cpp.
    for (std::size_t p = 0; p < turning.size(); ++p) {
        const auto& [centre, last, moment, b, g] = turning[p];
        const double next = keep * last + gain * moment / pieces_[p].share,
                     now = now_.starts_from_rest ? last : (last + next) / 2;
        moved.kinetic -= (keep * b * last * last + gain * g * moment * last) / 2;
        moved.damped -= alpha * now_.dt * b * now * now;
    }
    return moved;
}

// Work in this step of loads and of the forces of excavated rock still applied; `held` is their mean share in it.
Dynamics::Work Dynamics::work_of_loads(double held) const
{
    return sum_in_chunks<Work>(
        static_cast<Index>(now_.place.size()), assembly_.threads, [&](Index g, Work& some) {
            some.work += (assembly_.load[g] + assembly_.applied[g] + held * released_[g]).dot(move_[g]);
            if (!((now_.place[g].array() > low_.array()).all() &&
                  (now_.place[g].array() < high_.array()).all()))
                some.is_gone = true;
        });
}

void Dynamics::step()
{
    const double held_before = release_factor();
    const MovedRock moved = move_rock();
    now_.energy.damped += moved.damped;
    if (moved.fastest_gridpoint >= 0)
        now_.fastest_gridpoint = moved.fastest_gridpoint;
    // After a stop, the kinetic energy is the product of this velocity and its opposite (see energy()).
    if (now_.starts_from_rest && now_.time > 0)
        now_.energy.damped += half_step_energy();
    now_.starts_from_rest = false;
    for (const auto& [follower, leader] : assembly_.tied) {
        move_[follower] = move_[leader];
        now_.velocity[follower] = now_.velocity[leader];
    }
    now_.fastest = std::sqrt(moved.fastest);
    now_.has_moved = now_.has_moved || now_.fastest > slow;
    add(now_.dt, now_.time, now_.time_lost);
    now_.last_dt = now_.dt;
    const Work worked = work_of_loads((held_before + release_factor()) / 2);
    now_.energy.work += worked.work;
    if (!std::isfinite(now_.fastest) || !std::isfinite(moved.kinetic))
        throw equilibrium_error("dynamic analysis: the velocity of rock is no number; it was at " +
                                shown(assembly_.position[now_.fastest_gridpoint]));
    if (worked.is_gone)
        throw moves_on("rock has left the section, and is as far from it as the section is large");
    if (is_creeping_)
        contacts_.creep_to(std::min(1.0, now_.time / settings_.release));
    find_forces(move_);
    check_strain();
    now_.energy.stored = stored() - stored_at_start_;
    now_.energy.damped += in_zones_.damped + contacts_.energy().damped;
    now_.energy.friction += in_zones_.friction + contacts_.energy().friction;
    in_zones_.friction = 0;
    stop_at_peak(moved.kinetic);
    if (contacts_.stiffest() > now_.stiffest_allowed)
        find_time_step();
}

// Kinetic energy that rounding errors of positions may give or take in a step [J/m]. Each gridpoint has an impulse from springs
// and dashpots, at most that of the stiffest one. The errors are independent, so their sum grows with the root of the number of
// gridpoints. For each, stiffness squared over mass is at most the largest stiffness times the highest frequency squared. No place
// is farther from the middle than high_.
double Dynamics::energy_of_rounding() const
{
    const double beta = settings_.stiffness_damping, half = now_.dt / (2 * safety);
    const double impulse = std::sqrt(static_cast<double>(now_.place.size())) * rounding_of_place *
                           high_.norm() * now_.stiffest * (now_.dt + beta); // [N s/m]
    const double one_over_mass = now_.stiffest > 0 ? 1 / (now_.stiffest * half * (half + beta)) : 0.0;
    return impulse * (now_.fastest + impulse * one_over_mass / 2);
}

// Rock near rest oscillates about it. If it is stopped where its kinetic energy is largest, it stops near rest. Rock
// that moves on has no such peak until it is slow. Peaks of rounding errors do not count: rock that begins to move would
// be stopped at each of them, and stay where it is not in equilibrium.
void Dynamics::stop_at_peak(double kinetic)
{
    if (now_.fastest >= slow) {
        now_.last_kinetic = kinetic;
        return;
    }
    now_.last_kinetic = std::max(now_.last_kinetic, kinetic);
    if (kinetic + energy_of_rounding() >= now_.last_kinetic)
        return;
    now_.energy.damped += energy().kinetic;
    for (Body& body : bodies_) {
        body.velocity.setZero();
        body.spin = 0;
    }
    now_.last_kinetic = 0;
    now_.velocity.assign(now_.place.size(), Vector2d::Zero());
    now_.starts_from_rest = true;
}

// Kinetic energy of the present velocities, half a step ago [J/m].
double Dynamics::half_step_energy() const
{
    auto sum = sum_in_chunks<double>(
        static_cast<Index>(now_.place.size()), assembly_.threads, [&](Index g, double& some) {
            if (now_.inverse_mass[g] > 0)
                some += now_.velocity[g].squaredNorm() / (2 * now_.inverse_mass[g]);
        });
    for (const Body& body : bodies_)
        sum += (body.mass * body.velocity.squaredNorm() + body.inertia * body.spin * body.spin) / 2;
    for (const Turn& turn : turns())
        sum -= turn.b * turn.momentum * turn.momentum / 2;
    return sum;
}

// Velocities are known half a step before and half a step after now. With their product as the square, the work of
// forces equals the kinetic energy within rounding.
Energy Dynamics::energy() const
{
    Energy energy = now_.energy;
    const auto [keep, gain] = leap(1);
    energy.kinetic +=
        sum_in_chunks<double>(static_cast<Index>(now_.place.size()), assembly_.threads,
                              [&, keep = keep, gain = gain](Index g, double& some) {
                                  if (now_.inverse_mass[g] == 0)
                                      return;
                                  const Vector2d next = keep * now_.velocity[g] +
                                                        gain * now_.inverse_mass[g] *
                                                            now_.force[g].cwiseProduct(assembly_.is_free[g]);
                                  some += now_.velocity[g].dot(next) / (2 * now_.inverse_mass[g]);
                              });
    for (const Turn& turn : turns())
        energy.kinetic -= keep * turn.b * turn.momentum * turn.momentum / 2;
    for (const Body& body : bodies_)
        if (!body.is_held()) {
            const auto [force, moment] = load_on(body, now_.force);
            energy.kinetic +=
                (keep * body.mass * body.velocity.squaredNorm() + gain * body.velocity.dot(force) +
                 keep * body.inertia * body.spin * body.spin + gain * body.spin * moment) /
                2;
        }
    // Shear gains and loses energy as contacts change length. Without slip the sum is 0 within rounding.
    if (energy.friction < 0 &&
        -energy.friction < 1e-12 * std::max({energy.kinetic, std::abs(energy.work), energy.stored}))
        energy.friction = 0;
    return energy;
}

mechanics::no_equilibrium Dynamics::moves_on(const std::string& why) const
{
    mechanics::no_equilibrium error(why);
    error.moves_on = true;
    error.steps = check_every;
    error.seconds = check_every * now_.dt;
    for (const Vector2d& velocity : now_.velocity)
        error.motion.emplace_back(error.seconds * velocity);
    return error;
}

// The largest of these forces on gridpoints, and of theirs on bodies, where rock is free [N/m].
double Dynamics::largest_of(const std::vector<Vector2d>& force) const
{
    double largest = 0;
    for (std::size_t g = 0; g < force.size(); ++g)
        if (body_of_[g] < 0)
            largest = std::max(largest, force[g].cwiseProduct(assembly_.is_free[g]).norm());
    for (const Body& body : bodies_)
        if (!body.is_held()) {
            const auto [sum, moment] = load_on(body, force);
            largest = std::max({largest, sum.norm(), std::abs(moment) / std::sqrt(body.inertia / body.mass)});
        }
    return largest;
}

// Unbalanced forces, and forces on gridpoints, with these forces of contacts [N/m].
Dynamics::Balance Dynamics::balance(const std::vector<Vector2d>& contact_force) const
{
    Balance found;
    found.largest = found.without = largest_of(now_.force);
    if (settings_.stiffness_damping > 0) {
        std::vector<Vector2d> without = forces_of_dashpots();
        for (std::size_t g = 0; g < without.size(); ++g)
            without[g] = now_.force[g] - without[g];
        found.without = largest_of(without);
    }
    double sum = 0;
    Index n = 0;
    for (std::size_t g = 0; g < now_.place.size(); ++g) {
        found.farthest = std::max(found.farthest, now_.place[g].norm());
        double all = assembly_.load[g].norm() + assembly_.applied[g].norm() + contact_force[g].norm();
        for (const Index corner : assembly_.zones.corners[g])
            all += zones_.corner_force[corner].norm();
        if (all > 0) {
            sum += all;
            ++n;
        }
        if (!now_.last_contact_force.empty())
            found.change = std::max(found.change, (contact_force[g] - now_.last_contact_force[g]).norm());
    }
    found.mean = n > 0 ? sum / n : 0.0;
    return found;
}

// Throws if rounding errors of forces are not small beside the mean force: those of springs, and those with dashpots
// [N/m].
void Dynamics::check_rounding(double of_springs, double rounding) const
{
    if (now_.largest_mean <= of_springs || rounding <= most_rounding * now_.largest_mean)
        return;
    const std::string where = "; the stiffest gridpoint is at " +
                              shown(assembly_.position[now_.stiffest_gridpoint]) + ": expected ";
    if (of_springs > most_rounding * now_.largest_mean)
        throw equilibrium_error(
            "dynamic analysis: forces by rounding errors of positions are not small compared with the mean "
            "force on a gridpoint, " +
            shown(now_.largest_mean) + " N/m" + where + "more load, softer joints, or larger zones there");
    throw equilibrium_error("dynamic analysis: with a step of " + shown(now_.dt) +
                            " s and stiffness damping of " + shown(settings_.stiffness_damping) +
                            " s, damping forces by rounding errors are not small compared with the forces of "
                            "the rock" +
                            where + "less damping there, or larger zones");
}

bool Dynamics::is_at_rest()
{
    std::vector<Vector2d> contact_force(now_.place.size(), Vector2d::Zero());
    contacts_.add_forces(contact_force, assembly_.threads);
    const Balance found = balance(contact_force);
    // Forces near 0 are rounding errors of stiffness times position. Forces no larger than these mean no load. Dashpots
    // multiply the errors by damping time over step time: too much for very small zones, whose forces are then not
    // usable. So forces have to be in balance with those of dashpots, as far as the errors allow, and without them.
    const double of_springs = rounding_of_place * now_.stiffest * found.farthest;
    const double rounding = of_springs * (1 + settings_.stiffness_damping / now_.dt);
    now_.largest_mean = std::max(now_.largest_mean, found.mean);
    check_rounding(of_springs, rounding);
    const auto over_mean = [&](double force, double its_rounding) {
        return force / (found.mean > 0 ? std::max(found.mean, its_rounding / settings_.tolerance) : 1.0);
    };
    now_.ratio = std::max(over_mean(found.largest, rounding), over_mean(found.without, of_springs));
    const bool has_last = !now_.last_contact_force.empty();
    now_.force_change = over_mean(found.change, rounding);
    now_.last_contact_force = std::move(contact_force);
    const bool is_balanced = now_.fastest <= at_rest && now_.ratio <= settings_.tolerance && has_last &&
                             now_.force_change <= settings_.tolerance && release_factor() == 0;
    now_.checks_in_balance = is_balanced ? now_.checks_in_balance + 1 : 0;
    return now_.checks_in_balance >= 2;
}

} // namespace jointcreep::large_displacements
