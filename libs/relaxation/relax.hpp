// Dynamic relaxation: gridpoints move by the central difference of the paper's Eqs. 1 and 2 until forces
// balance.
//
//     v <- (v (1 - alpha dt / 2) + F / m dt) / (1 + alpha dt / 2),    u <- u + v dt
//
// Masses are the real ones or scaled: for a state of rest only the forces matter, so every gridpoint may have
// the mass that just allows the common step (dt = 1 s then; solver time means nothing). Damping is one of
//   adaptive  alpha = 2 w, critical for the lowest frequency w that the present movement shows (Rayleigh
//             quotient)
//   kinetic   none, but whenever the kinetic energy has passed a peak (Cundall 1976), all gridpoints go back to their
//             places at the peak, and start from rest there (Barnes 1999)
//   local     a fraction of the unbalanced force, against the velocity (Cundall 1987)
//   combined  half of that against the velocity, half along the change of force: it also damps vibration
//             about a steady movement
//   mass      alpha as given: as in the paper

#pragma once

#include "mechanics/assembly.hpp"
#include "model/tape.hpp"

#include <functional>

namespace jointcreep::relaxation
{

// Called after every step with the solver time since this equilibrium began [s].
using StepObserver = std::function<void(double solver_time)>;

// Moves the assembly to equilibrium. There, in each of the last 5 checks, 20 steps apart:
//   - the unbalanced force ratio is at most the tolerance;
// and over these 100 steps:
//   - no contact force has changed by more than the tolerance times the mean force on a gridpoint;
//   - the remaining displacement, by estimate, is at most 1000 times the tolerance, or a tenth, of the displacement of
//     this equilibrium, or of a tenth of the whole displacement if that is more; unless it is rounding.
// Starts from rest. A state in balance to rounding is left as it is, after 0 steps.
//
// Throws no_equilibrium when a gridpoint has moved by a tenth of the section's size, in this equilibrium or since
// the in-situ state, or by more than settings.largest_displacement since then; when rock moves steadily while the
// unbalanced forces do not decrease; when displacements or forces are no longer finite; and after settings.most_steps.
// Throws input_error for mass damping of scaled masses.
//
// With a keeper, it may be kept after every 100 steps, and continued from there: all numbers are then the same. `tell` is
// called at every check.
mechanics::Convergence relax(mechanics::Assembly& assembly, const Equilibrium& settings,
                             const StepObserver& observe = {}, SearchKeeper* keeper = nullptr,
                             const mechanics::SearchObserver& tell = {});

} // namespace jointcreep::relaxation
