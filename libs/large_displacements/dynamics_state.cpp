#include "large_displacements/dynamics.hpp"
#include "model/signs.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <vector>

namespace jointcreep::large_displacements
{

// At two gridpoints.
struct Dynamics::Carried {
    Vector2d force{0, 0};            // {normal, shear} [N/m]
    double length = 0, slipping = 0; // of all faces, and of those that slip [m]
    double broken = 0;               // of those without bonds [m]
    double dilation = 0;             // times length [m2]
    Vector2d crept{0, 0};            // {opening, shear}, times length [m2]
};

void Dynamics::transfer(const Transfer& to, DynamicsState& kept)
{
    to.values(origin_, kept.origin);
    to.values(now_.place, kept.place);
    for (std::size_t g = 0; g < origin_.size(); ++g)
        assembly_.position[g] = middle_ + origin_[g];
    rock::transfer(to, zones_, kept);
    to.size(face_of_mesh_, kept.face);
    to.values(face_of_mesh_, kept.face);
    contacts_.transfer(to, kept);
    to.value(now_.fastest, kept.fastest);
    to.value(now_.ratio, kept.unbalanced_force_ratio);
    to.value(now_.largest_mean, kept.largest_mean_force);
}

void Dynamics::Movement::pass(Tape& tape)
{
    const std::size_t n = place.size();
    tape(place, velocity, force, lost, inverse_mass, dt, last_dt, time, time_lost, stiffest_allowed,
         starts_from_rest, has_moved, last_kinetic, stiffest, largest_mean, ratio, force_change, fastest,
         checks_in_balance);
    tape(energy.work, energy.kinetic, energy.stored, energy.friction, energy.damped);
    tape.index(fastest_gridpoint, n);
    tape.index(stiffest_gridpoint, n);
    tape.list_of(n, last_contact_force);
}

// What is not passed on is as start() makes it, or of one step alone.
void Dynamics::pass(Tape& tape)
{
    tape(contacts_);
    for (Body& body : bodies_)
        tape(body.centre, body.velocity, body.lost, body.angle, body.spin);
    rock::pass(tape, zones_);
    now_.pass(tape);
    tape(in_zones_.stored, in_zones_.friction, in_zones_.damped);
}

void Dynamics::count_from_here()
{
    origin_ = now_.place;
    contacts_.count_creep_from_here();
    for (std::size_t g = 0; g < now_.place.size(); ++g)
        assembly_.position[g] = middle_ + now_.place[g];
    put_back();
}

std::vector<Touching> Dynamics::touching() const
{
    std::vector<Touching> found;
    for (const FacePair& pair : contacts_.pairs()) {
        if (!pair.is_closed)
            continue;
        const auto &a = contacts_.faces().gridpoint[pair.a], &b = contacts_.faces().gridpoint[pair.b];
        std::array<Vector2d, 2> between;
        for (int i = 0; i < 2; ++i)
            between[i] = middle_ + (now_.place[a[0]] + pair.on_a[i] * (now_.place[a[1]] - now_.place[a[0]]) +
                                    now_.place[b[0]] + pair.on_b[i] * (now_.place[b[1]] - now_.place[b[0]])) /
                                       2;
        found.push_back({{zone_of_face_[pair.a], zone_of_face_[pair.b]},
                         between,
                         pair.normal,
                         {pair.sigma, pair.tau},
                         -joint::opening(contacts_.laws()[pair.law], pair.sigma),
                         pair.is_slipping});
    }
    return found;
}

void Dynamics::put_back()
{
    for (std::size_t g = 0; g < now_.place.size(); ++g)
        assembly_.displacement[g] = now_.place[g] - origin_[g];
    put_back_forces();
    for (std::size_t z = 0; z < assembly_.zones.size(); ++z)
        if (assembly_.zones.is_present[z]) {
            if (is_rigid_[z])
                assembly_.zones.stress[z].setZero(); // unknown
            else
                rock::put_back(zones_, static_cast<Index>(z), now_.place, assembly_.zones);
        }
    put_back_contacts();
}

// Forces of all pairs of faces that meet at two gridpoints, over their length. They include neighbours that overlap
// after shear of the joint. By gridpoints {lower, higher}.
std::map<std::array<Index, 2>, Dynamics::Carried> Dynamics::carried_by_pairs() const
{
    std::map<std::array<Index, 2>, Carried> carried;
    for (const FacePair& pair : contacts_.pairs())
        if (pair.is_closed && pair.length > 0)
            for (const Index a : face_of_mesh_[pair.a])
                for (const Index b : face_of_mesh_[pair.b]) {
                    Carried& there = carried[{std::min(a, b), std::max(a, b)}];
                    there.force += pair.length * Vector2d(pair.sigma, pair.tau);
                    there.length += pair.length;
                    there.slipping += pair.is_slipping ? pair.length : 0.0;
                    there.broken += pair.is_broken ? pair.length : 0.0;
                    there.dilation += pair.length * pair.dilation;
                    there.crept += pair.length * contacts_.crept(pair);
                }
    return carried;
}

void Dynamics::put_back_contacts()
{
    const std::vector<Index> leader = leaders();
    joint::Contacts& contacts = assembly_.contacts;
    const std::map<std::array<Index, 2>, Carried> carried = carried_by_pairs();
    contacts.state_by_faces = contacts.state;
    for (std::size_t c = 0; c < contacts.gridpoint.size(); ++c) {
        if (contacts.status[c] == ContactStatus::removed)
            continue;
        const auto [a, b] = contacts.gridpoint[c];
        const Vector2d relative = assembly_.displacement[b] - assembly_.displacement[a];
        contacts.relative_displacement[c] = {relative.dot(contacts.normal[c]),
                                             relative.dot(along(contacts.normal[c]))};
        const auto found = carried.find({std::min(a, b), std::max(a, b)});
        if (found == carried.end()) {
            if (leader[a] == leader[b]) // tied so far: no change
                continue;
            contacts.traction[c].setZero();
            contacts.status[c] = ContactStatus::open;
            contacts.state_by_faces[c] = {.slip = slip_beside_springs(contacts, c), .is_broken = true};
            continue;
        }
        contacts.traction[c] = found->second.force / found->second.length;
        contacts.offset[c] = found->second.crept / found->second.length;
        contacts.state_by_faces[c] = {.slip = slip_beside_springs(contacts, c),
                                      .dilation = found->second.dilation / found->second.length,
                                      .is_broken = 2 * found->second.broken > found->second.length};
        contacts.status[c] = 2 * found->second.slipping > found->second.length ? ContactStatus::slipping
                                                                               : ContactStatus::stuck;
    }
}

} // namespace jointcreep::large_displacements
