// Rock that yields: the search for equilibrium where Newton's method finds none, and failure.

#include "implicit/equilibrium.hpp"

#include <algorithm>
#include <cmath>

namespace jointcreep::implicit
{

namespace
{

constexpr int most_steps = 60;
constexpr double first_step = 16, least_step = 1e-3; // over the time in which dashpots answer like springs
constexpr double much_worse = 4;                     // merit of a step that is taken back, over the last one
constexpr double diverged = 20;                      // merit with which steps were too long, over the least

} // namespace

// Every gridpoint moves against a dashpot, by implicit steps that grow without bound: (K + D / t) du = unbalanced
// force, with D the stiffness against which it acts (pseudo-transient continuation: Kelley and Keyes, SIAM J. Numer.
// Anal. 35, 1998). With an equilibrium, forces fade and the steps become Newton's. Without one, the part of the forces
// that nothing balances stays and displacement grows with the steps: collapse_ has the last one. Where forces have
// grown with displacement the steps were too long, and nothing is known.
bool Solver::flow_to_rest(Assembly& assembly, const State& start, const Equilibrium& settings,
                          mechanics::Convergence& convergence)
{
    assembly.displacement = start.displacement;
    double merit = evaluate(assembly, start), least = merit, time = first_step;
    take(assembly, start, true);
    const double most = std::min(settings.largest_displacement, too_far_);
    for (int step = 0; step < most_steps; ++step) {
        const mechanics::Balance balance = balance_of(assembly, stiffest_, 0, settings.tolerance);
        report(convergence, balance.ratio());
        if (balance.ratio() <= settings.tolerance &&
            is_at_rest(assembly, start, balance.mean, settings.tolerance, convergence))
            return true;
        dashpots_ = scale_ / time;
        const VectorXd du = correction(assembly, start, force_, 0, 0);
        dashpots_.resize(0);
        ++corrections_;
        if (du.size() == 0)
            break;
        const std::vector<Vector2d> from = assembly.displacement;
        stiffness_.add_to(assembly.displacement, du, 1);
        const double found = evaluate(assembly, start);
        if (!(found <= much_worse * merit)) {
            assembly.displacement = from;
            evaluate(assembly, start);
            if ((time /= 8) < least_step)
                break;
            continue;
        }
        time *= found < merit / 100 ? 16 : 2;
        merit = found;
        least = std::min(least, merit);
        take(assembly, start, false);
        if (largest_displacement(assembly).first > most) {
            if (merit > diverged * least)
                break;
            const std::size_t at = largest_displacement(assembly).second;
            collapse_.emplace("the displacement of the rock at " + shown(assembly.position[at]) +
                              " grows without bound: no equilibrium with displacements up to " +
                              rounded(most) + " m");
            collapse_->moves_on = true;
            collapse_->steps = 1;
            for (std::size_t g = 0; g < from.size(); ++g)
                collapse_->motion.emplace_back(assembly.displacement[g] - from[g]);
            reason_ = "displacement grows without bound";
            return false;
        }
    }
    reason_ = "forces do not come into balance";
    return false;
}

} // namespace jointcreep::implicit
