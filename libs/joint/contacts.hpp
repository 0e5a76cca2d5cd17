// Contacts of joints between zones and their force on gridpoints, at small displacements.

#pragma once

#include "joint/law.hpp"
#include "model/checkpoint.hpp"
#include "model/disjoint_sets.hpp"
#include "model/grouped.hpp"
#include "model/network.hpp"
#include "model/result.hpp"
#include "model/scene.hpp"
#include "model/tape.hpp"

#include <Eigen/Core>

#include <array>
#include <span>
#include <vector>

namespace jointcreep::joint
{

using Eigen::Vector2d;

// Contacts: springs between two gridpoints split by a joint. Pairs are {normal, shear}.
struct Contacts {
    std::vector<std::array<Index, 2>> gridpoint; // {on side a, on side b}
    std::vector<Index> edge;                     // of the network
    std::vector<Vector2d> normal;                // unit, from a to b
    std::vector<double> length;                  // [m]
    std::vector<Law> law;
    std::vector<Index> material; // as EquivalentJoints::material, or empty
    std::vector<State> state;
    // At zero displacement; where open, the normal part is k_n x gap [Pa].
    std::vector<Vector2d> initial_traction;
    std::vector<Vector2d> offset;                // displacement with the initial spring traction: creep [m]
    std::vector<Vector2d> traction;              // now [Pa]
    std::vector<Vector2d> relative_displacement; // displacement of b minus that of a, now [m]
    std::vector<ContactStatus> status;           // now; removed once a side is excavated
    std::vector<Vector2d> force;                 // on side a; filled with the tractions [N/m]
    // In place of `state` in records: states from a dynamic analysis with large displacements; else empty.
    std::vector<State> state_by_faces;

    // Of the search for equilibrium, since begin_search: work on each contact by the trapezoidal rule, and what all
    // of them had stored before [J/m].
    std::vector<double> work;
    double stored_before = 0;

    Grouped<Index> sides; // 2 contact + side (0 a, 1 b); filled by find_incidence
};

// What equilibria and creep change in Contacts.
struct ContactsState {
    std::vector<Vector2d> offset, traction, relative_displacement;
    std::vector<State> state;
    std::vector<ContactStatus> status;
};
ContactsState state_of(const Contacts& contacts);
void go_back(Contacts& contacts, const ContactsState& state);

// All contacts of a mesh, with the scene's in-situ stress at their centres, at zero displacement.
Contacts contacts_of(const Scene& scene, const EquivalentJoints& joints, const Mesh& mesh);

// Finds which contacts are at each gridpoint.
void find_incidence(Contacts& contacts, std::size_t n_gridpoints);

// Tractions and forces at the displacements of all gridpoints [m]. Call it from every thread of an OpenMP parallel
// region; the forces are complete after a barrier. Slip and breaking are updated in the states; a second call changes
// nothing. `damping` is the rate of stiffness damping over the step [-]. `forces_alone` is not used: everything is
// computed in any case.
void find_forces_in_team(Contacts& contacts, std::span<const Vector2d> displacement, double damping,
                         bool forces_alone);

// The forces whose change the convergence report has [N/m].
inline std::span<const Vector2d> reported_forces(const Contacts& contacts)
{
    return contacts.force;
}

// Adds the forces of the contacts at a gridpoint [N/m], or their magnitudes.
inline void add_force_on(const Contacts& contacts, Index gridpoint, Vector2d& force)
{
    for (const Index side : contacts.sides[gridpoint])
        force += (1 - 2 * (side & 1)) * contacts.force[side >> 1]; // a product is quicker than a branch
}
inline void add_magnitudes_on(const Contacts& contacts, Index gridpoint, double& magnitudes)
{
    for (const Index side : contacts.sides[gridpoint])
        magnitudes += contacts.force[side / 2].norm();
}

// Opening of a contact beyond the point where it touches; if negative, its closing, springs included [m].
double opening_of(const Contacts& contacts, std::size_t c);

// Changes of the input of a contact's response: its springs, initial traction, the stretch of its springs, and its
// state. Pairs are {normal, shear}.
struct ContactChange {
    Vector2d stiffness{0, 0}, initial_traction{0, 0}, spring{0, 0};
    double slip = 0, dilation = 0;
    std::array<double, 3> memory{}; // of State
};
// The resulting changes of its traction and of its final state.
struct ContactResponse {
    Vector2d traction;
    double slip, dilation;
    std::array<double, 3> memory;
};
// Response from the state `start`, on a straight path to the present displacement, by the law in numbers with
// derivatives. A bond broken during the search counts as broken from the start.
ContactResponse respond(const Contacts& contacts, std::size_t c, const State& start, const ContactChange& by);

// For joints that grow stiffer as they close, the normal stiffness is taken as this many times the present one.
inline constexpr double room_to_stiffen = 2;

// Adds the row sums of the magnitudes of the contacts' stiffness {x, y}, at displacements of the gridpoints, to the sums
// of their gridpoints [Pa].
void add_row_sums(const Contacts& contacts, std::span<const Vector2d> displacement,
                  std::vector<Vector2d>& sums);

// Contacts that grow stiffer as they close, with the normal stiffness up to which row sums at these displacements hold
// [Pa/m].
struct Stiffening {
    std::size_t contact;
    double most;
};
std::vector<Stiffening> stiffening_of(const Contacts& contacts, std::span<const Vector2d> displacement);
// Whether any of them is stiffer at these displacements.
bool are_beyond(const Contacts& contacts, std::span<const Vector2d> displacement,
                const std::vector<Stiffening>& stiffening);
void pass(Tape& tape, std::vector<Stiffening>& stiffening);

// Energy stored in contacts [J/m]; only differences have a meaning.
double stored_energy(const Contacts& contacts);
// What their springs would store beyond that if slip and dilation were still those of the states at the start [J/m].
double returned_energy(const Contacts& contacts, const ContactsState& start);

// Before a search for equilibrium: counts dissipated energy from here. Contacts need not know of stiffness damping.
void begin_search(Contacts& contacts, bool damps_stiffness);
// Energy lost by slip and dilation since then [J/m]: along the path; or straight from the states at the start, under
// the present tractions (backward Euler).
double dissipated(const Contacts& contacts);
double dissipated(const Contacts& contacts, const ContactsState& start);

// Joins the gridpoints of each contact that is there.
void join(const Contacts& contacts, DisjointSets& gridpoints);

// Removes the contacts on the edges of the network that have lost a side. At the end of such an edge both gridpoints may
// stay: rock that stays can have them, too.
void remove_at(Contacts& contacts, const std::vector<char>& lost_a_side);

// Shear displacement that is neither in the shear springs nor creep [m]; 0 for a smooth joint.
double slip_beside_springs(const Contacts& contacts, std::size_t c);

// The deepest that a contact is closed beyond its normal traction over its stiffness [m].
double penetration(const Contacts& contacts);

// Whether tractions are finite numbers.
bool is_finite(const Contacts& contacts);

// Of rock only (rock/zones.hpp): contacts slip in every search.
inline bool yields(const Contacts&)
{
    return false;
}
inline void hold_yield(Contacts&, bool /*held*/) {}
inline bool is_within_strength(const Contacts&)
{
    return true;
}

// Makes the present tractions those at zero displacement.
void start_from_here(Contacts& contacts);
// Sets slip and dilation to 0 in states; see start_from_here().
void forget_slip(std::vector<State>& states);

// Appends the present tractions and states of contacts to the states of a result.
void record_state(const Contacts& contacts, States& states);

// State at the start of a stage that new contacts of the same section do not have.
void transfer(const Transfer& to, Contacts& contacts, Checkpoint& kept);

// What a search for equilibrium changes.
void pass(Tape& tape, Contacts& contacts);

} // namespace jointcreep::joint
