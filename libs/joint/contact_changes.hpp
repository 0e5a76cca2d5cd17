// Derivatives of contacts (joint/contacts.hpp) by a factor. They are computed by the joint law itself in numbers
// with derivatives (joint/dual.hpp), on its present branch. Changes are of the first order, per unit of the factor's
// logarithm.

#pragma once

#include "joint/contacts.hpp"
#include "model/scaled.hpp"

namespace jointcreep::joint
{

// Changes of the arrays of Contacts with the same names. Pairs are {normal, shear}.
struct ContactChanges {
    std::vector<Vector2d> stiffness{};                    // of the laws' springs [Pa/m]
    std::vector<Vector2d> initial_traction{}, traction{}; // [Pa]
    std::vector<Vector2d> offset{};                       // [m]
    // Changes of the states.
    std::vector<double> slip{}, dilation{}; // [m]
    std::vector<std::array<double, 3>> memory{};
};

// The functions of a kind of force that sensitivities call (mechanics/forces.hpp).

// Throws input_error where springs are not constant: the derivative by their stiffness is not defined then.
void check_sensitivities(const Contacts& contacts, const Scene& scene);

// Changes before the in-situ equilibrium.
ContactChanges changed_by(const Contacts& contacts, Scaled scaled, const Scene& scene, const Mesh& mesh);

// Adds the changes of forces on gridpoints [N/m]: those there are, and those at fixed gridpoints. `start`: the states
// at the start of this equilibrium.
void add_forces(const Contacts& contacts, const ContactChanges& changes, std::vector<Vector2d>& force);
void add_forces_at_fixed_gridpoints(const Contacts& contacts, const ContactChanges& changes,
                                    const ContactsState& start, std::span<const Vector2d> displacement,
                                    std::vector<Vector2d>& force);

// Adds the effect of changed displacements [m] of the gridpoints on tractions and on the states of contacts.
void take_response(const Contacts& contacts, const ContactsState& start,
                   std::span<const Vector2d> displacement, std::span<const Vector2d> displacement_change,
                   ContactChanges& changes);

// The derivative of start_from_here(contacts); call it before that. Slip in `start` is forgotten, too.
void start_changes_from_here(const Contacts& contacts, std::span<const Vector2d> displacement_change,
                             ContactChanges& changes, ContactsState& start);

// Change of opening_of(contacts, c) [m].
double change_of_opening(const Contacts& contacts, const ContactChanges& changes,
                         std::span<const Vector2d> displacement, std::size_t c);

} // namespace jointcreep::joint
