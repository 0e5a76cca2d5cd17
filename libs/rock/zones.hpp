// Zones of rock and their force on gridpoints, at small strain.

#pragma once

#include "model/checkpoint.hpp"
#include "model/disjoint_sets.hpp"
#include "model/grouped.hpp"
#include "model/network.hpp"
#include "model/result.hpp"
#include "model/scene.hpp"
#include "model/tape.hpp"
#include "rock/mohr_coulomb.hpp"

#include <Eigen/Core>

#include <array>
#include <span>
#include <vector>

namespace jointcreep::rock
{

using Eigen::Vector2d;
using Eigen::Vector3d;

// Sums of the forces of zones in an order that does not depend on the number of threads. Consecutive zones make a part.
// A part adds its forces into slots, one for each of its gridpoints.
struct Slots {
    std::vector<Index> part_start;  // [parts + 1] the slots of each part
    std::vector<Index> of_zone;     // [stress point, gridpoint of its zone]
    std::vector<Vector2d> force;    // [N/m]
    std::vector<double> magnitudes; // sums of the magnitudes of the zones' forces [N/m]
    Grouped<Index> by_gridpoint;    // slots
};

// Zones: triangles in plane strain and small strain, elastic or yielding. A zone of constant strain has three
// gridpoints and one stress. A quadratic zone has six gridpoints, its corners and then the middles of its sides, and
// three stress points; each stress point has a third of the area (Zienkiewicz and Taylor, The Finite Element Method,
// volume 1: exact for straight sides). All arrays below but `gridpoint` and `gradient` have a row for each stress
// point. The stress points of a zone follow each other.
struct Zones {
    int gridpoints_of_zone = 3, points_of_zone = 1;
    std::vector<Index> gridpoint;         // [stress point, gridpoint of its zone]
    std::vector<Vector2d> gradient;       // [the same] gradient of each gridpoint's shape function [1/m]
    std::vector<double> area;             // [m2]
    std::vector<double> weight;           // area x density x gravity, downward [N/m]
    std::vector<double> mass;             // [kg/m]
    std::vector<Vector3d> stiffness;      // {C11, C12, C33} of the rock [Pa]
    std::vector<Vector3d> initial_stress; // {xx, yy, xy} at zero displacement [Pa]
    std::vector<Vector3d> stress;         // now [Pa]
    std::vector<Vector3d> last_stress;    // before; kept only with stiffness damping [Pa]
    std::vector<char> is_present;

    std::size_t size() const { return area.size(); } // stress points
    std::span<const Index> gridpoints(std::size_t z) const
    {
        return {gridpoint.data() + z * gridpoints_of_zone, static_cast<std::size_t>(gridpoints_of_zone)};
    }
    std::span<const Vector2d> gradients(std::size_t z) const
    {
        return {gradient.data() + z * gridpoints_of_zone, static_cast<std::size_t>(gridpoints_of_zone)};
    }
    std::size_t zone_of(std::size_t z) const { return z / points_of_zone; } // in the mesh
    std::size_t first_point_of(std::size_t zone) const { return zone * points_of_zone; }

    // For rock that yields; empty where none yields.
    std::vector<Index> yielding_number; // index into `yielding` for each stress point; -1 elastic
    std::vector<YieldingZone> yielding;
    bool holds_yield = false; // no yielding for now: plastic strain stays as it is

    std::vector<char> creeps; // whether the rock of a stress point creeps

    // Filled by find_incidence.
    Grouped<Index> corners; // places in `gridpoint`
    Slots slots;            // their forces are filled by find_forces_in_team
};

// What equilibria and creep change in Zones.
struct ZonesState {
    std::vector<Vector3d> stress;
    std::vector<YieldingZone> yielding;
};
ZonesState state_of(const Zones& zones);
void go_back(Zones& zones, const ZonesState& state);

// Whether rock may yield now.
bool yields(const Zones& zones);

// All zones of a mesh under the scene's in-situ stress, at zero displacement.
Zones zones_of(const Scene& scene, const Network& network, const Mesh& mesh);

// Finds which zones are at each gridpoint.
void find_incidence(Zones& zones, std::size_t n_gridpoints);

// Whether a gridpoint has present zones; whether it had zones, and all are excavated.
bool has_rock(const Zones& zones, Index gridpoint);
bool has_lost_rock(const Zones& zones, Index gridpoint);

// Stresses and forces at the displacements of all gridpoints [m]. Call it from every thread of an OpenMP parallel
// region; the forces are complete after a barrier. `damping` is the rate of stiffness damping over the step [-]. With
// forces alone, stresses of elastic zones and magnitudes are left out.
void find_forces_in_team(Zones& zones, std::span<const Vector2d> displacement, double damping,
                         bool forces_alone);

// The forces whose change the convergence report has: those of contacts.
inline std::span<const Vector2d> reported_forces(const Zones&)
{
    return {};
}

// Adds the forces of the zones at a gridpoint [N/m], or their magnitudes.
inline void add_force_on(const Zones& zones, Index gridpoint, Vector2d& force)
{
    for (const Index slot : zones.slots.by_gridpoint[gridpoint])
        force += zones.slots.force[slot];
}
inline void add_magnitudes_on(const Zones& zones, Index gridpoint, double& magnitudes)
{
    for (const Index slot : zones.slots.by_gridpoint[gridpoint])
        magnitudes += zones.slots.magnitudes[slot];
}

// Strain {xx, yy, gamma_xy} at a stress point at the displacements of all gridpoints [-].
Vector3d strain_at(const Zones& zones, std::size_t z, std::span<const Vector2d> displacement);

// Adds the row sums of the magnitudes of the zones' stiffness {x, y} to those of their gridpoints [Pa].
void add_row_sums(const Zones& zones, std::span<const Vector2d> displacement, std::vector<Vector2d>& sums);

// Adds the masses of present zones to their gridpoints [kg/m]: a third of a zone of constant strain to each; of a
// quadratic one 1/19 to its corners and 16/57 to the middles of its sides, in proportion to the diagonal of its mass
// matrix (Hinton, Rock and Zienkiewicz 1976).
void add_masses(const Zones& zones, std::vector<double>& mass);

// Adds `share` times the weight of a stress point to the loads of its gridpoints [N/m]: a third to each. For a
// quadratic zone only to the middles of the sides, by its shape functions.
void add_weight(const Zones& zones, std::size_t z, double share, std::vector<Vector2d>& load);

// Of joints only (joint/contacts.hpp): rock does not grow stiffer as it deforms.
struct Stiffening {
};
inline std::vector<Stiffening> stiffening_of(const Zones&, std::span<const Vector2d>)
{
    return {};
}
inline bool are_beyond(const Zones&, std::span<const Vector2d>, const std::vector<Stiffening>&)
{
    return false;
}
inline void pass(Tape&, std::vector<Stiffening>&) {}

// Energy stored in present zones [J/m]; only differences have a meaning.
double stored_energy(const Zones& zones);
// What they would store beyond that if plastic strain were still that at the start [J/m].
double returned_energy(const Zones& zones, const ZonesState& start);

// Before a search for equilibrium: counts dissipated energy from here. `damps_stiffness`: the search has stiffness
// damping.
void begin_search(Zones& zones, bool damps_stiffness);
// Energy lost by yielding since then [J/m]: along the path; or straight from the state at the start, under the stress at the
// end.
double dissipated(const Zones& zones);
double dissipated(const Zones& zones, const ZonesState& start);

// Whether a present zone of the mesh has yielded, at any of its stress points.
bool has_yielded(const Zones& zones, std::size_t zone);

// The largest plastic shear strain in the section at a present stress point [-].
double largest_plastic_strain(const Zones& zones);

// The stress point most beyond its strength; -1 if none is beyond.
Index weakest(const Zones& zones);

// A search for equilibrium is quicker if rock may not yield in it. It has found what it should if no rock is beyond its
// strength then.
inline void hold_yield(Zones& zones, bool held)
{
    zones.holds_yield = held;
}
bool is_within_strength(const Zones& zones);

// Whether stresses are finite numbers.
bool is_finite(const Zones& zones);

// Removes the rock of the stress points for which `is_removed` is set, and its weight from the loads [N/m].
void excavate(Zones& zones, const std::vector<char>& is_removed, std::vector<Vector2d>& load);

// Rock goes by blocks, see excavate().
inline void remove_at(Zones&, const std::vector<char>& /*lost_a_side*/) {}

// Joins the gridpoints of each present zone.
void join(const Zones& zones, DisjointSets& gridpoints);

// Makes the present stresses those at zero displacement.
void start_from_here(Zones& zones);

// Appends the present stresses and strains to the states of a result. For a quadratic zone these are means over its
// stress points; the stresses at the points are appended, too.
void record_state(const Zones& zones, States& states);

// State at the start of a stage that new zones of the same section do not have.
void transfer(const Transfer& to, Zones& zones, Checkpoint& kept);

// What a search for equilibrium changes.
void pass(Tape& tape, Zones& zones);

} // namespace jointcreep::rock
