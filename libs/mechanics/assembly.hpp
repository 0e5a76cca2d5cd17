// A zoned section in mechanical terms: what moves, what resists, and how far from equilibrium it is. Both the
// dynamic relaxation and the implicit engine work on this.

#pragma once

#include "mechanics/forces.hpp"
#include "model/checkpoint.hpp"
#include "model/network.hpp"
#include "model/result.hpp"
#include "model/scene.hpp"

#include <Eigen/Core>

#include <array>
#include <functional>
#include <utility>
#include <vector>

namespace jointcreep::mechanics
{

using Eigen::Vector2d;
using Eigen::Vector3d;

// The forces on gridpoints, and the gridpoints.
struct Assembly : Forces {
    std::vector<Vector2d> position;       // at the start [m]
    std::vector<Vector2d> displacement;   // [m]
    std::vector<Vector2d> is_free_untied; // 1 or 0 in {x, y}: not fixed by a boundary, not removed
    std::vector<Vector2d> is_free;        // 1 or 0 in {x, y}: and not tied to a fixed one
    std::vector<Vector2d>
        along; // where rollers leave one direction free, neither x nor y: unit vector, else 0; or empty
    std::vector<Vector2d> load;    // weight, and forces of excavated rock still applied [N/m]
    std::vector<Vector2d> applied; // from tractions on the outline [N/m]
    std::vector<Vector2d> force;   // unbalanced, also where fixed; filled by find_forces [N/m]

    // Gridpoints that move as one with another until a stage; force and load of {one, other} act on the
    // other.
    struct Tie {
        std::array<Index, 2> gridpoint;
        Index stage;
    };
    std::vector<Tie> ties;

    // A gridpoint of a zone side on rollers, with the side's direction. It is on them while there is rock in the zone.
    struct Roller {
        Index gridpoint;
        Vector2d along; // unit vector
        std::size_t stress_point;
    };
    std::vector<Roller> rollers;
    std::vector<std::array<Index, 2>> tied; // from the ties still there: {follower, leader}

    // beta / dt: forces grow by this times their change since the last step [-].
    double stiffness_damping_rate = 0;
    int threads = 1;
};

// What equilibria and creep change, for going back to it.
struct State : ForcesState {
    std::vector<Vector2d> displacement, force;
};

// The assembly under the scene's in-situ stress, at zero displacement, all rock present. Contact tractions
// are the in-situ ones at the contacts' centres.
Assembly assemble(const Scene& scene, const Network& network, const EquivalentJoints& equivalent,
                  const Mesh& mesh);

// Finds which zones and contacts are at each gridpoint; part of assemble.
void find_incidence(Assembly& assembly);

// Whether rollers leave the gridpoint one direction that is neither x nor y.
inline bool is_on_rollers(const Assembly& assembly, std::size_t g)
{
    return !assembly.along.empty() && !assembly.along[g].isZero(0);
}

// The part of a force on a gridpoint that no support takes, or of its displacement that none prevents.
inline Vector2d free_part(const Assembly& assembly, std::size_t g, const Vector2d& of)
{
    return is_on_rollers(assembly, g) ? Vector2d(assembly.along[g].dot(of) * assembly.along[g])
                                      : Vector2d(of.cwiseProduct(assembly.is_free[g]));
}

// Ends the ties that a stage separates, and finds what supports leave free.
void part_ties(Assembly& assembly, Index stage);

// Adds the forces on followers of ties to those on their leaders; followers keep none [N/m].
void give_forces_to_leaders(const Assembly& assembly, std::vector<Vector2d>& force);

// Stresses, tractions and forces at the present displacements. Slip and breaking of contacts are taken into
// their states: calling it again changes nothing more.
void find_forces(Assembly& assembly);

// The same by a team of threads that is at work already: each calls it, in an OpenMP parallel region. When it
// returns, the forces are there of the gridpoints that this thread has in a loop over chunks_of(assembly)
// with a static schedule; of the others, after a barrier. Forces alone leave out the zones' stresses and what
// balance_of needs.
void find_forces_in_team(Assembly& assembly, bool forces_alone);

// Gridpoints that are worked on, and summed over, together, whatever the number of threads.
constexpr Index chunk = 512;
Index chunks_of(const Assembly& assembly);

// Energy that all kinds of force have stored [J/m]; only differences mean anything.
double stored_energy(const Assembly& assembly);
// What they would have stored beyond that if nothing had slipped, dilated or yielded since the start [J/m].
double returned_energy(const Assembly& assembly, const State& start);

// Whether anything may yield now, so that its tangents are found anew for each correction of the implicit engine.
bool yields(const Assembly& assembly);

// Before a search for equilibrium: counts dissipated energy from here.
void begin_search(Assembly& assembly, bool damps_stiffness = false);
// Energy dissipated since then [J/m]: along the path; or straight from the state at the start.
double dissipated(const Assembly& assembly);
double dissipated(const Assembly& assembly, const State& start);

struct Balance {
    double largest; // unbalanced force on a free gridpoint [N/m]
    Index worst;    // that gridpoint
    double mean;    // over gridpoints: summed magnitudes of the forces of zones, contacts and load [N/m]
    double ratio() const { return mean == 0 ? 0.0 : largest / mean; } // not a number if a force is not
};

// How far the forces of the last find_forces are from equilibrium.
Balance balance_of(const Assembly& assembly);

// The same, allowing for rounding. Where rock is almost without stress, forces are rounding errors of stiffness
// times displacement; those are in balance, too. So the mean is at least what `tolerance` requires for these
// errors, with the `stiffest` row sum and the largest displacement, present or `largest` [m] during the search.
Balance balance_of(const Assembly& assembly, double stiffest, double largest, double tolerance);

// The largest of the moves between two lists of displacements [m], and its gridpoint; a move that is no
// number first of all.
std::pair<double, std::size_t> largest_move(const std::vector<Vector2d>& from,
                                            const std::vector<Vector2d>& to);

// The same of the displacements since the in-situ state.
std::pair<double, std::size_t> largest_displacement(const Assembly& assembly);

// Work of load and applied forces between the displacements `start` and the present ones [J/m].
double work_of_loads(const Assembly& assembly, const std::vector<Vector2d>& start);

// Diagonal of the box around all gridpoints [m].
double size_of(const Assembly& assembly);

// Makes the present state the one displacements count from.
void start_from_here(Assembly& assembly);

// For going back to it.
State state_of(const Assembly& assembly);
void go_back(Assembly& assembly, const State& state);

// What differs from a new assembly of the same section when a stage begins.
void transfer(const Transfer& to, Assembly& assembly, Checkpoint& kept);

// What a search for equilibrium changes.
void pass(Tape& tape, Assembly& assembly);

// Appends the present state of the forces to the states of a result.
void record_state(const Assembly& assembly, States& states);

// Row sums of the stiffness matrix's magnitudes at the present displacement, the larger of x and y, of every gridpoint
// [Pa]: no eigenvalue of stiffness over mass is above the largest row sum over its mass (Gershgorin). Joints that grow
// stiffer as they close count with joint::room_to_stiffen.
std::vector<double> stiffness_row_sums(const Assembly& assembly);

// Forces that grow stiffer as they deform, with the stiffness up to which row sums at the present displacement hold;
// whether there are any, and whether one is stiffer at the displacement there is now. Forces need not know of it yet.
Stiffening stiffening_of(const Assembly& assembly);
bool has_any(const Stiffening& stiffening);
bool are_beyond(const Assembly& assembly, const Stiffening& stiffening);
void pass(Tape& tape, Stiffening& stiffening);

// Mass of every gridpoint: its shares of the present zones around it [kg/m]; see rock::add_masses.
std::vector<double> lumped_masses(const Assembly& assembly);

// The cost of an equilibrium, with the rejected and failed searches before it.
struct Effort {
    Index searches = 0;                   // for equilibrium, by either engine
    Index steps = 0;                      // of dynamic relaxation, and corrections
    Index factorisations = 0, solves = 0; // of the implicit engine; solves are back-substitutions
};

// How an equilibrium was reached, and how well: the convergence report.
struct Convergence {
    bool is_implicit = false;
    Index steps = 0; // of dynamic relaxation, or corrections
    double unbalanced_force_ratio = 0;
    // Largest over the last 100 steps, or by one more correction; over the mean force on a gridpoint [-].
    double contact_force_change = 0;
    double remaining_displacement = 0; // largest, by estimate [m]
    // Energy balance: work of loads = stored in zones and contacts + dissipated by both + taken by damping [J/m].
    double work_of_loads = 0, stored = 0, dissipated = 0, damped = 0;
    // By the implicit engine: energy that has no source [J/m]; see implicit::created_energy.
    double created = 0;
};

// Called now and then in a search for equilibrium, with the steps so far and the unbalanced force ratio.
using SearchObserver = std::function<void(const Convergence& so_far)>;

} // namespace jointcreep::mechanics
