// Derivatives of contacts (joint/contacts.hpp) by a parameter. They are computed by the joint law itself in numbers
// with derivatives (joint/dual.hpp), on its present branch. A parameter is a factor. Changes are of the first order,
// per unit of its logarithm.

#pragma once

#include "joint/contacts.hpp"

namespace jointcreep::joint
{

// Changes of the arrays of Contacts with the same names. Pairs are {normal, shear}.
struct ContactChanges {
    std::vector<Vector2d> stiffness;                  // of the laws' springs [Pa/m]
    std::vector<Vector2d> initial_traction, traction; // [Pa]
    std::vector<Vector2d> offset;                     // [m]
    // Changes of the states.
    std::vector<double> slip, dilation; // [m]
    std::vector<std::array<double, 3>> memory;
};

// Throws input_error where springs are not constant: the derivative by their stiffness is not defined then.
void check_sensitivities(const Contacts& contacts);

// Changes of contacts before the in-situ equilibrium: by a parameter that contacts do not have, by the factor on joint
// stiffness, and by the factor on the horizontal in-situ stress.
ContactChanges unchanged(const Contacts& contacts);
ContactChanges changed_by_stiffness(const Contacts& contacts);
ContactChanges changed_by_horizontal_stress(const Contacts& contacts, const InSituStress& stress,
                                            const Mesh& mesh);

// Changes of the tractions at fixed gridpoints [Pa]. `start`: the states at the start of this equilibrium.
std::vector<Vector2d> tractions_at_fixed_gridpoints(const Contacts& contacts, const ContactChanges& changes,
                                                    const std::vector<State>& start);

// Adds the effect of changed displacements [m] of the gridpoints on tractions and on the states of contacts.
void take_response(const Contacts& contacts, const std::vector<State>& start,
                   std::span<const Vector2d> displacement, ContactChanges& changes);

// Adds the forces of contacts with these tractions {normal, shear} [Pa] to the forces on gridpoints [N/m].
void add_forces(const Contacts& contacts, const std::vector<Vector2d>& traction,
                std::vector<Vector2d>& force);

// The derivative of start_from_here(contacts); call it before that.
void start_from_here(const Contacts& contacts, std::span<const Vector2d> displacement,
                     ContactChanges& changes);

// Change of opening_of(contacts, c) [m].
double change_of_opening(const Contacts& contacts, const ContactChanges& changes,
                         std::span<const Vector2d> displacement, std::size_t c);

} // namespace jointcreep::joint
