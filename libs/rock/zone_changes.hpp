// What zones of elastic rock change by, to first order, when a parameter does: the derivatives of rock/zones.hpp. A parameter
// is a factor, and changes are per unit of its logarithm.

#pragma once

#include "rock/zones.hpp"

namespace jointcreep::rock
{

// What the arrays of Zones change by: {xx, yy, xy} of stresses, and the shear modulus in their stiffness, the bulk modulus
// being what it is [Pa].
struct ZoneChanges {
    std::vector<Vector3d> initial_stress, stress;
    std::vector<double> shear_modulus;
};

// Of zones before the in-situ equilibrium: by a parameter that they do not have, and by the factor on the horizontal in-situ
// stress.
ZoneChanges unchanged(const Zones& zones);
ZoneChanges changed_by_horizontal_stress(const Zones& zones);

// What stresses would change by if all gridpoints stayed where they are, at their displacements [m].
std::vector<Vector3d> stresses_at_fixed_gridpoints(const Zones& zones, const ZoneChanges& changes,
                                                   std::span<const Vector2d> displacement);

// Gridpoints move: what their displacements change by [m]. Takes what stresses then change by.
void take_response(const Zones& zones, std::span<const Vector2d> displacement,
                   std::span<const Vector2d> displacement_change, ZoneChanges& changes);

// Adds the forces of zones with these stresses [Pa] to those on gridpoints [N/m].
void add_forces(const Zones& zones, const std::vector<Vector3d>& stress, std::vector<Vector2d>& force);

// As start_from_here(zones).
void start_from_here(ZoneChanges& changes);

} // namespace jointcreep::rock
