// Zones of rock and their force on gridpoints, at small strain.

#pragma once

#include "model/checkpoint.hpp"
#include "model/network.hpp"
#include "model/result.hpp"
#include "model/scene.hpp"
#include "rock/mohr_coulomb.hpp"

#include <Eigen/Core>

#include <array>
#include <span>
#include <vector>

namespace jointcreep::rock
{

using Eigen::Vector2d;
using Eigen::Vector3d;

// Zones: constant-strain triangles, elastic or yielding, plane strain, small strain.
struct Zones {
    std::vector<std::array<Index, 3>> gridpoint;
    std::vector<std::array<Vector2d, 3>> gradient; // of each corner's shape function [1/m]
    std::vector<double> area;                      // [m2]
    std::vector<double> weight;                    // area x density x gravity, downward [N/m]
    std::vector<double> mass;                      // [kg/m]
    std::vector<Vector3d> stiffness;               // {C11, C12, C33} of the rock [Pa]
    std::vector<Vector3d> initial_stress;          // {xx, yy, xy} at zero displacement [Pa]
    std::vector<Vector3d> stress;                  // now [Pa]
    std::vector<Vector3d> last_stress;             // before; kept only with stiffness damping [Pa]
    std::vector<char> is_present;

    // Of rock that yields; empty where none does.
    std::vector<Index> yielding_number; // into yielding, of every zone; -1 elastic
    std::vector<YieldingZone> yielding;
    bool holds_yield = false; // all rock is elastic for now, from the plastic strain it has

    std::vector<Index> creeping; // zones of rock that creeps
};

// All zones of a mesh, under the scene's in-situ stress, at zero displacement.
Zones zones_of(const Scene& scene, const Network& network, const Mesh& mesh);

// Where zones add their forces, in an order that is the same for any number of threads: zones that follow each other make
// a part, and add their forces into slots, one for each gridpoint of the part.
struct Slots {
    std::vector<Index> part_start; // [parts + 1] the slots of each part
    std::vector<std::array<Index, 3>> of_zone;
    std::vector<Vector2d> force;    // [N/m]
    std::vector<double> magnitudes; // sums of the magnitudes of what zones add [N/m]
};

// The slots of some zones; takes the gridpoint of each slot into `gridpoint`.
Slots slots_of(const Zones& zones, std::size_t n_gridpoints, std::vector<std::array<Index, 1>>& gridpoint);

// Stresses and forces at the displacements of all gridpoints [m]. By a team of threads that is at work already: each calls
// it, in an OpenMP parallel region, and forces are there after a barrier. `damping` is the rate of stiffness damping over
// the step [-]. Forces alone leave out the stresses of elastic zones and the magnitudes.
void find_forces_in_team(Zones& zones, Slots& slots, std::span<const Vector2d> displacement, double damping,
                         bool forces_alone);

// Stiffness of a zone between its corners i and j, per area [Pa/m2].
Eigen::Matrix2d stiffness_between(const Zones& zones, std::size_t z, int i, int j);

// Stress {xx, yy, xy} of a zone by elasticity of stiffness {C11, C12, C33} at the displacements of all gridpoints [Pa].
Vector3d stress_by(const Zones& zones, std::size_t z, std::span<const Vector2d> displacement,
                   const Vector3d& stiffness);

// Adds the forces of a zone with that stress to those on its gridpoints [N/m].
void add_force(const Zones& zones, std::size_t z, const Vector3d& stress, std::vector<Vector2d>& force);

// Adds the row sums of the magnitudes of the zones' stiffness {x, y} to those of their gridpoints [Pa].
void add_row_sums(const Zones& zones, std::vector<Vector2d>& sums);

// Adds a third of each present zone's mass to its gridpoints [kg/m].
void add_masses(const Zones& zones, std::vector<double>& mass);

// Energy that present zones have stored [J/m]; only differences mean anything. What yielding zones have lost since this was
// forgotten [J/m].
double stored_energy(const Zones& zones);
double dissipated(const Zones& zones);
void forget_dissipated(Zones& zones);

// The zone that is farthest beyond its strength; -1 if none is.
Index weakest(const Zones& zones);

// Makes the present stresses those at zero displacement.
void start_from_here(Zones& zones);

// Appends the present stresses and strains to the states of a result.
void record_state(const Zones& zones, States& states);

// What differs from new zones of the same section when a stage begins.
void transfer(const Transfer& to, Zones& zones, Checkpoint& kept);

} // namespace jointcreep::rock
