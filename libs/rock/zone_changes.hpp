// Derivatives of zones of elastic rock (rock/zones.hpp) by a factor. Changes are of the first order, per unit of its
// logarithm.

#pragma once

#include "model/scaled.hpp"
#include "rock/zones.hpp"

namespace jointcreep::rock
{

// Changes of the arrays of Zones: {xx, yy, xy} of stresses, and of the shear modulus in their stiffness; the bulk
// modulus does not change [Pa].
struct ZoneChanges {
    std::vector<Vector3d> initial_stress{}, stress{};
    std::vector<double> shear_modulus{};
};

// The functions of a kind of force that sensitivities call (mechanics/forces.hpp).

// Throws input_error where rock is not elastic.
void check_sensitivities(const Zones& zones, const Scene& scene);

// Changes before the in-situ equilibrium.
ZoneChanges changed_by(const Zones& zones, Scaled scaled, const Scene& scene, const Mesh& mesh);

// Adds the changes of forces on gridpoints [N/m]: those there are, and those at fixed displacements of the gridpoints
// [m].
void add_forces(const Zones& zones, const ZoneChanges& changes, std::vector<Vector2d>& force);
void add_forces_at_fixed_gridpoints(const Zones& zones, const ZoneChanges& changes, const ZonesState& start,
                                    std::span<const Vector2d> displacement, std::vector<Vector2d>& force);

// Adds the effect of changed displacements [m] on the stresses.
void take_response(const Zones& zones, const ZonesState& start, std::span<const Vector2d> displacement,
                   std::span<const Vector2d> displacement_change, ZoneChanges& changes);

// The derivative of start_from_here(zones).
void start_changes_from_here(const Zones& zones, std::span<const Vector2d> displacement_change,
                             ZoneChanges& changes, ZonesState& start);

} // namespace jointcreep::rock
