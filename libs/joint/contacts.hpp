// Contacts of joints between zones and their force on gridpoints, at small displacements.

#pragma once

#include "joint/law.hpp"
#include "model/checkpoint.hpp"
#include "model/network.hpp"
#include "model/result.hpp"
#include "model/scene.hpp"

#include <Eigen/Core>

#include <array>
#include <span>
#include <vector>

namespace jointcreep::joint
{

using Eigen::Vector2d;

// Contacts: springs between two gridpoints that a joint has split. Pairs are {normal, shear}.
struct Contacts {
    std::vector<std::array<Index, 2>> gridpoint; // {on side a, on side b}
    std::vector<Vector2d> normal;                // unit, from a to b
    std::vector<double> length;                  // [m]
    std::vector<Law> law;
    std::vector<State> state;
    std::vector<Vector2d>
        initial_traction;           // at zero displacement; where open, the normal part is k_n x gap [Pa]
    std::vector<Vector2d> offset;   // displacement at which the springs are as at the start: creep [m]
    std::vector<Vector2d> traction; // now [Pa]
    std::vector<Vector2d> relative_displacement; // displacement of b minus that of a, now [m]
    std::vector<ContactStatus> status;           // now; removed once a side is gone
    std::vector<double> work;    // done on it since this was last set to 0, by the trapezoidal rule [J/m]
    std::vector<Vector2d> force; // on side a; filled with the tractions [N/m]
    // In place of `state` in records: what a dynamic analysis with large displacements has found; else empty.
    std::vector<State> state_by_faces;
};

// All contacts of a mesh, with the scene's in-situ stress at their centres, at zero displacement.
Contacts contacts_of(const Scene& scene, const EquivalentJoints& joints, const Mesh& mesh);

// Tractions and forces at the displacements of all gridpoints [m]. By a team of threads that is at work already: each calls
// it, in an OpenMP parallel region, and forces are there after a barrier. Slip and breaking are taken into the states:
// calling it again changes nothing more. `damping` is the rate of stiffness damping over the step [-].
void find_forces_in_team(Contacts& contacts, std::span<const Vector2d> displacement, double damping);

// How far a contact is open beyond where it touches; below 0: how much it is closed, springs and all [m].
double opening_of(const Contacts& contacts, std::size_t c);

// What the response of a contact starts with changes by this: its springs, initial traction, the stretch of its springs,
// and what it remembers. Pairs are {normal, shear}.
struct ContactChange {
    Vector2d stiffness{0, 0}, initial_traction{0, 0}, spring{0, 0};
    double slip = 0, dilation = 0;
    std::array<double, 3> memory{}; // of State
};
// So its traction, and what it remembers at the end, change by this.
struct ContactResponse {
    Vector2d traction;
    double slip, dilation;
    std::array<double, 3> memory;
};
// From the state `start`, straight to where the contact is, by its law in numbers with derivatives. A bond that has broken on
// the way has been broken from the start.
ContactResponse respond(const Contacts& contacts, std::size_t c, const State& start, const ContactChange& by);

// Change of a contact's traction over change of its relative displacement [Pa/m]: {normal over normal, shear
// over shear, shear over normal, normal over shear}.
struct Tangent {
    double normal, shear, friction, dilation;

    bool operator==(const Tangent&) const = default;

    // Change of {normal, shear} traction [Pa] for one of the {normal, shear} relative displacement [m].
    Vector2d times(const Vector2d& relative) const
    {
        return {normal * relative.x() + dilation * relative.y(),
                shear * relative.y() + friction * relative.x()};
    }
};

// That of the response: for laws whose traction goes with more than springs and a strength.
Tangent tangent_of_response(const Contacts& contacts, std::size_t c, const State& start);

// Where joints grow stiffer as they close the normal stiffness is taken as this many times that of now.
inline constexpr double room_to_stiffen = 2;

// Adds the row sums of the magnitudes of the contacts' stiffness {x, y} to those of their gridpoints [Pa].
void add_row_sums(const Contacts& contacts, std::vector<Vector2d>& sums);

// Energy that contacts have stored [J/m]; only differences mean anything. Work on them since this was forgotten [J/m].
double stored_energy(const Contacts& contacts);
double work_on(const Contacts& contacts);
void forget_work(Contacts& contacts);

// Makes the present tractions those at zero displacement.
void start_from_here(Contacts& contacts);
// What states lose then.
void forget_slip(std::vector<State>& states);

// Appends the present tractions, and what contacts remember, to the states of a result.
void record_state(const Contacts& contacts, States& states);

// What differs from new contacts of the same section when a stage begins.
void transfer(const Transfer& to, Contacts& contacts, Checkpoint& kept);

} // namespace jointcreep::joint
