// What demsolve adds: the zoned section, its histories, its states, and the history of the solver's steps on
// request. Arrays with several dimensions are flat, the last dimension running fastest.

#pragma once

#include "model/network.hpp"

namespace jointcreep
{

enum class ContactStatus : Index {
    removed = 0, // one of its sides has been excavated
    stuck = 1,
    slipping = 2,
    open = 3
};

// Zones (triangles), the gridpoints that carry them, and the contacts between gridpoints that
// a joint has split.
struct Mesh {
    std::vector<Eigen::Vector2d> gridpoint;           // position at the start [m]
    std::vector<Index> gridpoint_fixed;               // 0 free, 1 fixed in x, 2 in y, 3 in both
    std::vector<std::array<Index, 3>> zone_gridpoint; // counter-clockwise
    // Gridpoints in the middles of its sides 0-1, 1-2, 2-0; none where strain is constant.
    std::vector<std::array<Index, 3>> zone_middle;
    std::vector<Eigen::Vector2d> stress_point; // of quadratic zones, three a zone [m]
    std::vector<Index> zone_block;             // into Blocks
    // Ties: two gridpoints that move as one until a stage excavates the rock that connects them (at a joint's tip,
    // for example).
    std::vector<std::array<Index, 2>> tie_gridpoint;
    std::vector<Index> tie_stage;                     // into Names::stage
    std::vector<std::array<Index, 2>> side_gridpoint; // zone sides on a boundary condition
    std::vector<Index> side_middle; // gridpoints in their middles; none where strain is constant
    std::vector<Index> side_zone;
    std::vector<Index> side_boundary;                    // into the scene's [[boundary]]
    std::vector<std::array<Index, 2>> contact_gridpoint; // {on side a, on side b}
    std::vector<Index> contact_edge;                     // into Blocks' edges
    std::vector<Eigen::Vector2d> contact_normal;         // unit, from side a to side b
    std::vector<double> contact_length;                  // tributary length [m]
    std::vector<Eigen::Vector2d> contact_centre;         // where a traction linear in space has its mean [m]

    bool is_quadratic() const { return !zone_middle.empty(); }
    Index stress_points_of_zone() const { return is_quadratic() ? 3 : 1; }
};

// Displacements of the monitoring points, one row a recorded time: the start, the two sides of every stage,
// every creep step and every first reading.
struct History {
    std::vector<double> time;                    // since start [day], the one unit in files that is not SI
    std::vector<std::string> event;              // name of the stage that this row is the first after, or ""
    std::vector<std::string> point;              // names
    std::vector<Eigen::Vector2d> point_position; // [m]
    std::vector<Index> first_reading_row;        // [point] the row a point's own readings count from
    std::vector<Eigen::Vector2d> displacement;   // [time, point] since the in-situ equilibrium [m]
    std::vector<Index> present; // [time, point] 0 once removed; the last displacement is kept
    // [time] The row that displacements are to count from since the last reset, 0 before one.
    std::vector<Index> reset_row;
};

// The whole section at chosen times: the in-situ equilibrium, after every stage, before the next, the end.
struct States {
    std::vector<double> time;                  // since start [day]
    std::vector<std::string> event;            // as in History
    std::vector<Eigen::Vector2d> displacement; // [state, gridpoint] since the in-situ equilibrium [m]
    std::vector<Eigen::Vector2d> reaction;     // [state, gridpoint] of supports on the rock {x, y} [N/m]
    std::vector<Eigen::Vector3d> stress;       // [state, zone] {xx, yy, xy} [Pa]
    std::vector<Index> zone_present;           // [state, zone] 0 or 1
    std::vector<Eigen::Vector2d> traction;     // [state, contact] {normal, shear} [Pa]
    // [state, contact] Displacement of side b minus side a {normal, shear} [m].
    std::vector<Eigen::Vector2d> relative_displacement;
    std::vector<Index> contact_status;  // [state, contact] ContactStatus
    std::vector<double> slip, dilation; // [state, contact] since the in-situ equilibrium [m]
    std::vector<Index> bond_broken;     // [state, contact] 0 or 1
    std::vector<Eigen::Vector2d> crept; // [state, contact] of the relative displacement {normal, shear} [m]
    std::vector<double> initial_gap;    // [contact] at the in-situ equilibrium; 0 where closed [m]
    std::vector<Index> yielding_zone;   // zones of rock that yields
    // [state, yielding zone] {xx, yy, xy} since the in-situ equilibrium [-].
    std::vector<Eigen::Vector3d> plastic_strain;
    std::vector<Eigen::Vector3d> point_stress; // [state, stress point of quadratic zones] {xx, yy, xy} [Pa]
    std::vector<double> stress_zz;             // [state, yielding zone] across the section [Pa]
    std::vector<Index> creeping_zone;          // zones of rock that creeps
    // [state, creeping zone] deviatoric {xx, yy, xy} since the in-situ equilibrium [-].
    std::vector<Eigen::Vector3d> crept_strain;
    std::vector<Index> reset_state; // [state] the state displacements are to count from, as in History
};

// How every equilibrium was reached, one row each.
struct Equilibria {
    std::vector<double> time;       // since start [day]
    std::vector<Index> is_implicit; // 1 by the implicit engine, 0 by dynamic relaxation
    // The cost of the equilibrium, with the rejected and failed searches before it.
    std::vector<Index> searches; // for equilibrium, by either engine
    std::vector<Index> steps;    // of dynamic relaxation, and corrections of the implicit engine
    std::vector<Index> factorisations, solves;  // of the implicit engine; solves are back-substitutions
    std::vector<double> unbalanced_force_ratio; // [-]
    // Over the last 100 steps or by one more correction, over the mean force [-].
    std::vector<double> contact_force_change;
    std::vector<double> remaining_displacement; // largest, by estimate [m]
    // Energy balance: work_of_loads = stored + dissipated + damped [J/m].
    std::vector<double> work_of_loads, stored_energy, dissipated_energy, damped_energy;
};

// Every n-th step of the solver, on request.
struct StepHistory {
    std::vector<double> time;                  // since start [day]
    std::vector<double> solver_time;           // accumulated over all equilibria [s]
    std::vector<Eigen::Vector2d> displacement; // [row, point] as in History [m]
    std::vector<std::string> gauge;            // names
    std::vector<Index> gauge_contact;          // [gauge] into Mesh
    std::vector<Eigen::Vector2d> traction;     // [row, gauge] {normal, shear} [Pa]
};

// Dynamic analyses with large displacements, a row whenever a state is recorded during one. Energies since
// its start: work_of_loads = kinetic + stored + friction + damped, but for the error of time steps.
struct DynamicsHistory {
    std::vector<double> time;         // of the stage, since start [day]
    std::vector<double> dynamic_time; // since the dynamic analysis began [s]
    std::vector<Index> state;         // into States
    std::vector<double> work_of_loads, kinetic_energy, stored_energy, friction_energy, damped_energy; // [J/m]
    std::vector<double> fastest;                // gridpoint's speed [m/s]
    std::vector<double> unbalanced_force_ratio; // [-]

    // Contacts at these moments; those of moment m begin at row first_contact[m].
    std::vector<Index> first_contact{0};                   // [moment + 1]
    std::vector<std::array<Index, 2>> contact_block;       // {a, b}; -1 the ground
    std::vector<Eigen::Vector2d> contact_from, contact_to; // ends of the part that touches [m]
    std::vector<Eigen::Vector2d> contact_normal;           // from a to b
    std::vector<Eigen::Vector2d> contact_traction;         // {normal, shear} of its springs [Pa]
    std::vector<double> contact_closing;                   // mean [m]
    std::vector<Index> contact_slips;                      // 0 or 1
};

// How far each recorded state is off what must hold of it (analysis/guards.hpp).
struct GuardHistory {
    std::vector<double> area_error, weight_error; // [state] [-]
    std::vector<double> penetration;              // [state] [m]
};

// The end of a run without equilibrium. Blocks are those that move, or those without support.
struct Failure {
    std::string reason{};                  // the message; empty: the run was completed
    std::string stage{};                   // whose rock had just been excavated, or ""
    double time = 0;                       // since start [day]
    Index moves_on = 0;                    // 1 blocks slide or fall, 0 undecided
    double seconds = 0;                    // that the next stand for with real masses, or 0 [s]
    Index steps = 0;                       // the last ones of the engine
    std::vector<Index> block{};            // the fastest first
    std::vector<Eigen::Vector2d> place{};  // centroid, at the start [m]
    std::vector<Eigen::Vector2d> motion{}; // displacement in these steps [m]
};

// Runs by which a factor of safety was found, beside the result of the run with the largest factor in equilibrium.
struct Safety {
    std::vector<double> factor{}; // that strengths were divided by [-]
    std::vector<Index> stands{};  // 1 every equilibrium was found, 0 blocks are moving, -1 undecided
    std::vector<double> largest_displacement{};   // since the in-situ equilibrium, at the end [m]
    std::vector<double> largest_plastic_strain{}; // shear strain of a zone, at the end [-]

    // The same with zones twice as large, which tell what the mesh adds to the factor; empty where not asked for.
    std::vector<double> coarse_factor{};
    std::vector<Index> coarse_stands{};
    std::vector<double> coarse_largest_displacement{};
};

struct Result {
    Mesh mesh;
    History history;
    States states;
    Equilibria equilibria;
    StepHistory step_history;
    DynamicsHistory dynamics;
    GuardHistory guards{};
    Failure failure{};
};

} // namespace jointcreep
