// Tangents of zones and their part of a stiffness matrix. Where rock is elastic the stiffness is constant, until it
// creeps.

#pragma once

#include "rock/zones.hpp"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace jointcreep::rock
{

// Change of the stress {xx, yy, xy} at a stress point over change of its strain {xx, yy, gamma_xy} [Pa].
using Tangent = Eigen::Matrix3d;

// The tangent at the displacements of all gridpoints [m]; the strain path is straight from the state at the start.
// Of all stress points, 0 for those that are removed.
Tangent tangent_at(const Zones& zones, std::size_t z, std::span<const Vector2d> displacement,
                   const ZonesState& start);
std::vector<Tangent> tangents_of(const Zones& zones, std::span<const Vector2d> displacement,
                                 const ZonesState& start);

// Those of sensitivities: none, rock is elastic there and has its constant stiffness.
inline std::vector<Tangent> tangents_of_responses(const Zones&, const ZonesState& /*start*/)
{
    return {};
}

// Elastic rock has stiffness everywhere.
inline std::vector<Tangent> without_zeros(const Zones&, std::vector<Tangent> tangents, double /*soft*/)
{
    return tangents;
}

// Stiffness of a zone between its gridpoints i and j, at a stress point, per area [Pa/m2]: elastic, or with a tangent.
Eigen::Matrix2d stiffness_between(const Zones& zones, std::size_t z, int i, int j);
Eigen::Matrix2d stiffness_between(const Zones& zones, std::size_t z, int i, int j, const Tangent& tangent);

// The zones of the mesh that are there; each couples its gridpoints.
std::vector<Index> present(const Zones& zones);
inline std::span<const Index> coupled_by(const Zones& zones, Index zone)
{
    return zones.gridpoints(zones.first_point_of(zone));
}

// What the constant stiffness depends on, beside the zones that are there.
inline const std::vector<Vector3d>& constants(const Zones& zones)
{
    return zones.stiffness;
}

// Calls add(zone, i, j, block) with the stiffness between gridpoints i and j of each zone that is `there` [Pa], for
// each of its stress points; between(z, i, j) is that of a stress point per area.
template <class Between, class Add>
void add_points(const Zones& zones, const std::vector<Index>& there, const Between& between, const Add& add)
{
    for (const Index zone : there)
        for (std::size_t z = zones.first_point_of(zone); z < zones.first_point_of(zone + 1); ++z)
            for (int i = 0; i < zones.gridpoints_of_zone; ++i)
                for (int j = 0; j < zones.gridpoints_of_zone; ++j)
                    add(zone, i, j, Eigen::Matrix2d(zones.area[z] * between(z, i, j)));
}

template <class Add>
void add_constant_stiffness(const Zones& zones, const std::vector<Index>& there, const Add& add)
{
    add_points(
        zones, there, [&zones](std::size_t z, int i, int j) { return stiffness_between(zones, z, i, j); },
        add);
}

template <class Add>
void add_stiffness(const Zones& zones, const std::vector<Index>& there, const std::vector<Tangent>& tangents,
                   const Add& add)
{
    add_points(
        zones, there,
        [&](std::size_t z, int i, int j) { return stiffness_between(zones, z, i, j, tangents[z]); }, add);
}

// Adds no springs between bodies of rock: joints have them. Returns 0, the stiffest one [Pa].
template <class Add>
double add_springs(const Zones&, double /*soft*/, const Add&)
{
    return 0;
}

} // namespace jointcreep::rock
