// What contacts change by, to first order, when a parameter does: the derivatives of joint/contacts.hpp, by the joint law
// itself in numbers with derivatives (joint/dual.hpp), on the branch that it is on. A parameter is a factor, and changes are
// per unit of its logarithm.

#pragma once

#include "joint/contacts.hpp"

namespace jointcreep::joint
{

// What the arrays of Contacts of the same names change by. Pairs are {normal, shear}.
struct ContactChanges {
    std::vector<Vector2d> stiffness;                  // of the laws' springs [Pa/m]
    std::vector<Vector2d> initial_traction, traction; // [Pa]
    std::vector<Vector2d> offset;                     // [m]
    // Of the states.
    std::vector<double> slip, dilation; // [m]
    std::vector<std::array<double, 3>> memory;
};

// Throws input_error where springs are not constant: there is no derivative by their stiffness then.
void check_sensitivities(const Contacts& contacts);

// Of contacts before the in-situ equilibrium: by a parameter that they do not have, by the factor on joint stiffness, and by
// that on the horizontal in-situ stress.
ContactChanges unchanged(const Contacts& contacts);
ContactChanges changed_by_stiffness(const Contacts& contacts);
ContactChanges changed_by_horizontal_stress(const Contacts& contacts, const InSituStress& stress,
                                            const Mesh& mesh);

// What tractions would change by if all gridpoints stayed where they are [Pa]. `start`: the states at the start of this
// equilibrium.
std::vector<Vector2d> tractions_at_fixed_gridpoints(const Contacts& contacts, const ContactChanges& changes,
                                                    const std::vector<State>& start);

// Gridpoints move: what their displacements change by [m]. Takes what tractions, and what joints remember, then change by.
void take_response(const Contacts& contacts, const std::vector<State>& start,
                   std::span<const Vector2d> displacement, ContactChanges& changes);

// Adds the forces of contacts with these tractions {normal, shear} [Pa] to those on gridpoints [N/m].
void add_forces(const Contacts& contacts, const std::vector<Vector2d>& traction,
                std::vector<Vector2d>& force);

// As start_from_here(contacts), and before it.
void start_from_here(const Contacts& contacts, std::span<const Vector2d> displacement,
                     ContactChanges& changes);

// What opening_of(contacts, c) changes by [m].
double change_of_opening(const Contacts& contacts, const ContactChanges& changes,
                         std::span<const Vector2d> displacement, std::size_t c);

} // namespace jointcreep::joint
