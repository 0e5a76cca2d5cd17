// One creep step of a spring in series with Kelvin units, by any of the schemes.
//
// Under the force F (a traction, or a stress) a unit's displacement d (or strain) follows
//     d' = (F - E d) / eta,     lam = E / eta;     without a spring, E = 0, it is a Maxwell dashpot.
// During a step of length dT the force is taken to go from F_0 at its start to F_1 at its end as
//     F(t) = F_0 + (F_1 - F_0) phi(t / dT),
//     published      phi = 0                      first order, stable below longest_stable_step only
//     backward       phi = 1                      first order
//     linear force   phi = s                      second order; the force can oscillate if K is much larger than E
//     fitted         phi = (1 - exp(-rho dT s)) / (1 - exp(-rho dT))      second order, no oscillation
//     automatic      fitted, or linear force where loads change during the step
// so that
//     d_1 = a d_0 + c_0 F_0 + c_1 F_1 .
// rho is the initial rate at which the force between fixed walls decreases. With one unit the rate stays the same, so the
// fitted scheme is exact between fixed walls. Every scheme is exact at constant force.

#pragma once

#include "model/chain.hpp"
#include "model/scene.hpp"

#include <vector>

namespace jointcreep::creep
{

// The weights of a step.
struct StepWeights {
    struct OfUnit {
        double decay;       // a [-]
        double first, last; // c_0, c_1 [m/Pa]
    };
    std::vector<OfUnit> units;
    double compliance;       // sum of all c_1 [m/Pa]
    double acting_stiffness; // 1 / (1 / K + compliance): that of the chain during the step [Pa/m]
    // What the compliance differs by from that of linear force, or with linear force from that of fitted [m/Pa].
    double doubt;
};

// Whether a scheme is of second order in the step's length; the others are of first.
bool is_second_order(CreepScheme scheme);

// What the scene's scheme is in a step; not automatic, as the functions below want it.
CreepScheme scheme_of_step(CreepScheme scheme, bool loads_change);

StepWeights step_of(const Chain& chain, CreepScheme scheme, double duration);

// What the weights of a step, its compliance and acting stiffness change by, to first order, where spring and
// units change by `change`, which has the chain's units, and the duration by `duration_change` [s]; doubt is
// 0.
StepWeights change_of_step(const Chain& chain, const Chain& change, CreepScheme scheme, double duration,
                           double duration_change = 0);

// rho [1/s].
double relaxation_rate(const Chain& chain);

// The longest step with which the published scheme is stable [s]; infinite if it always is. Where chains make up a
// system with any elastic surroundings, F = F_0 - S d, 0 <= S <= K, it is stable if this holds for each:
//     K sum of tanh(lam dT / 2) / E < 1 ,   for one unit   (1 - exp(-lam dT)) (1 + K / E) < 2 .
double longest_stable_step(const Chain& chain);

// Whether it is stable at that length.
bool is_stable(const Chain& chain, double duration);

} // namespace jointcreep::creep
