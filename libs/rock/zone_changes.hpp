// Derivatives of zones of elastic rock (rock/zones.hpp) by a parameter. A parameter is a factor. Changes are of the
// first order, per unit of its logarithm.

#pragma once

#include "rock/zones.hpp"

namespace jointcreep::rock
{

// Changes of the arrays of Zones: {xx, yy, xy} of stresses, and of the shear modulus in their stiffness; the bulk
// modulus does not change [Pa].
struct ZoneChanges {
    std::vector<Vector3d> initial_stress, stress;
    std::vector<double> shear_modulus;
};

// Changes of zones before the in-situ equilibrium: by a parameter that zones do not have (all 0), and by the factor on
// the horizontal in-situ stress.
ZoneChanges unchanged(const Zones& zones);
ZoneChanges changed_by_horizontal_stress(const Zones& zones);

// Changes of the stresses at fixed displacements of the gridpoints [m].
std::vector<Vector3d> stresses_at_fixed_gridpoints(const Zones& zones, const ZoneChanges& changes,
                                                   std::span<const Vector2d> displacement);

// Adds the effect of changed displacements [m] on the stresses.
void take_response(const Zones& zones, std::span<const Vector2d> displacement,
                   std::span<const Vector2d> displacement_change, ZoneChanges& changes);

// Adds the forces of zones with these stresses [Pa] to the forces on gridpoints [N/m].
void add_forces(const Zones& zones, const std::vector<Vector3d>& stress, std::vector<Vector2d>& force);

// The derivative of start_from_here(zones).
void start_from_here(ZoneChanges& changes);

} // namespace jointcreep::rock
