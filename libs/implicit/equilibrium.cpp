#include "implicit/equilibrium.hpp"

#include "mechanics/rest.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace jointcreep::implicit
{

using mechanics::Balance;
using mechanics::Convergence;

namespace
{

constexpr int most_corrections = 80, most_corrections_to_mend = 20;
constexpr int patience = 15; // iterations with an old factor: a new one costs 10 to 20 of them
constexpr int most_leaps = 5;
constexpr int most_without_gain = 15, most_without_gain_with_flow = 4;        // corrections
constexpr int most_trials = 50, most_trials_with_flow = 4, most_halvings = 6; // along a correction
constexpr double least_kept_share = 1e-2;

bool any_closes(const std::vector<ContactStatus>& before, const std::vector<ContactStatus>& now)
{
    for (std::size_t c = 0; c < now.size(); ++c)
        if (before[c] == ContactStatus::open && now[c] != ContactStatus::open)
            return true;
    return false;
}

} // namespace

// Finds forces at the present displacements, as reached straight from the start. Returns the merit: the
// squared unbalanced forces, each over the stiffness against which it acts.
double Solver::evaluate(Assembly& assembly, const State& start)
{
    for_each_force(
        [](auto& force, const auto& its_start, const auto& active) { active.restart(force, its_start); },
        assembly, start, active_);
    find_forces(assembly);
    force_ = stiffness_.gathered(assembly, assembly.force);
    return force_.cwiseQuotient(scale_).dot(force_);
}

// Tangents for what forces do. Contacts that are open or slip keep the share `soft` of their springs.
Tangents Solver::tangents(const Assembly& assembly, const State& start, double soft) const
{
    Tangents found;
    for_each_force(
        [&](const auto& force, const auto& its_start, const auto& active, auto& of_force) {
            of_force = active.tangents(force, assembly.displacement, its_start, soft);
        },
        assembly, start, active_, found);
    return found;
}

void Solver::take(const Assembly& assembly, const State& start, bool first)
{
    for_each_force(
        [&](const auto& force, const auto& its_start, auto& active) { active.take(force, its_start, first); },
        assembly, start, active_);
}

bool Solver::break_bonds(const Assembly& assembly, const State& start)
{
    bool any = false;
    for_each_force([&](const auto& force, const auto& its_start,
                       auto& active) { any = active.break_bonds(force, its_start) || any; },
                   assembly, start, active_);
    return any;
}

bool Solver::mend_bonds(const Assembly& assembly)
{
    bool any = false;
    for_each_force([&](const auto& force, auto& active) { any = active.mend_bonds(force) || any; }, assembly,
                   active_);
    return any;
}

// The displacement that balances `force` to `enough` [N/m], if open and slipping contacts keep the share
// `kept_share` of their springs.
VectorXd Solver::correction(const Assembly& assembly, const State& start, const VectorXd& force,
                            double enough, double kept_share)
{
    const Tangents acting = tangents(assembly, start, std::max(soft_in_factor, kept_share));
    if (yields(assembly)) {
        ++factorisations_;
        ++solves_;
        return stiffness_.solve_yielding(assembly, acting, dashpots_, force);
    }
    const auto product = [&](const VectorXd& x) { return stiffness_.times(assembly, acting, x); };
    const auto precondition = [&](const VectorXd& x) {
        ++solves_;
        return stiffness_.solve(x);
    };
    if (acting != acting_) {
        const Stiffness::Change change = stiffness_.change(assembly, acting_, acting);
        space_.follow(change.unknowns, [&](const auto& x, auto y) {
            stiffness_.add_change(assembly, change, acting_, acting, x, y);
        });
        acting_ = acting;
    }
    VectorXd x;
    if (stiffness_.has_factor() && space_.solve(product, precondition, force, enough, patience, x) <= enough)
        return x;
    if (!stiffness_.factorise(assembly, acting))
        return {};
    ++factorisations_;
    space_.solve(product, precondition, force, enough, 2 * patience, x);
    return x;
}

// Moves along a correction, by too_far_ at most. First all of it is tried; then the point where forces do no more
// work along it; then part of it, until forces come nearer to balance. (A block that moves until it touches loses
// no force before, and its balance there is narrow.)
Solver::Advance Solver::go_along(Assembly& assembly, const State& start, const VectorXd& correction,
                                 double merit)
{
    const std::vector<Vector2d> from = assembly.displacement;
    const double work = force_.dot(correction);
    double best_share = 0, best_merit = std::numeric_limits<double>::infinity(), failed_share = 0;
    const auto is_good = [&](double share) {
        assembly.displacement = from;
        stiffness_.add_to(assembly.displacement, correction, share);
        const double found = evaluate(assembly, start);
        if (found < best_merit) {
            best_merit = found;
            best_share = share;
        }
        const bool good = found < (1 - 1e-4 * share) * merit;
        if (!good && (failed_share == 0 || share < failed_share))
            failed_share = share;
        return good;
    };
    const auto at_best = [&](double share) {
        if (share != best_share)
            is_good(best_share);
        return Advance{best_merit, failed_share};
    };

    double share = std::min(1.0, too_far_ / correction.lpNorm<Eigen::Infinity>());
    const bool good_at_once = is_good(share);
    double low = 0, work_low = work, high = share, work_high = force_.dot(correction);
    if (good_at_once || (best_merit < 1.01 * merit && work_high > work / 2))
        return {best_merit, 0}; // also a block that touches nothing yet
    const int trials = yields(assembly) ? most_trials_with_flow : most_trials;
    for (int i = 0; i < trials && work_low > 0 && work_high < 0; ++i) {
        // Bisection for the kink where it touches, regula falsi for the balance there, in turn.
        share = i % 2 == 0 ? (low + high) / 2 : low + (high - low) * work_low / (work_low - work_high);
        const bool good = is_good(share);
        const double here = force_.dot(correction);
        if (std::abs(here) < 0.1 * work) {
            if (good)
                return at_best(share);
            break;
        }
        (here > 0 ? low : high) = share;
        (here > 0 ? work_low : work_high) = here;
    }
    for (int halving = 0; halving < most_halvings; ++halving) {
        share /= 2;
        if (is_good(share))
            break;
    }
    return at_best(share);
}

// The largest change of a contact's force that a displacement would bring [N/m].
double Solver::force_change(const Assembly& assembly, const State& start, const VectorXd& displacement) const
{
    std::vector<Vector2d> u(assembly.position.size(), Vector2d::Zero());
    stiffness_.add_to(u, displacement, 1);
    double largest = 0;
    for_each_force(
        [&](const auto& force, const auto& its_start, const auto& active) {
            largest = std::max(largest, active.largest_force_change(force, its_start, u));
        },
        assembly, start, active_);
    return largest;
}

// Whether a correction is there to go along; else reason_.
bool Solver::is_usable(const VectorXd& correction)
{
    if (correction.size() > 0 && correction.allFinite())
        return true;
    reason_ = "some rock has no support";
    return false;
}

// Whether displacements are beyond their limits: reason_. Increments must not add up to more than one may be, either.
bool Solver::is_too_far(const Assembly& assembly, const Equilibrium& settings)
{
    const double largest = largest_displacement(assembly).first;
    if (largest > settings.largest_displacement)
        reason_ = "displacement grows without bound";
    else if (largest > too_far_)
        reason_ = "rock would move by more than a tenth of the section";
    return largest > std::min(settings.largest_displacement, too_far_);
}

// After a correction, from displacements `from`, that gained almost nothing. Bonds that hinder it break. If there
// are none, contacts that slip or are open keep more of their springs; once they keep all, displacements leap on,
// even if forces grow. False if that does not help: reason_.
bool Solver::get_past(Assembly& assembly, const State& start, const std::vector<Vector2d>& from,
                      const VectorXd& correction_made, const Advance& advance, double enough, Course& course)
{
    const std::vector<Vector2d> reached = assembly.displacement;
    assembly.displacement = from;
    stiffness_.add_to(assembly.displacement, correction_made, advance.failed_share);
    evaluate(assembly, start);
    const bool breaks = break_bonds(assembly, start);
    const bool leaps = !breaks && course.kept_share == 1;
    const bool goes_back = breaks || advance.merit >= course.merit || leaps;
    assembly.displacement = goes_back ? from : reached;
    course.merit = evaluate(assembly, start);
    if (leaps) {
        if (++course.leaps > most_leaps) {
            reason_ = "forces do not come into balance";
            return false;
        }
        const VectorXd leap = correction(assembly, start, force_, enough, 0);
        if (!is_usable(leap))
            return false;
        const double largest = mechanics::largest_move(start.displacement, assembly.displacement).first;
        stiffness_.add_to(assembly.displacement, leap,
                          std::min(1.0, largest / leap.lpNorm<Eigen::Infinity>()));
        course.merit = evaluate(assembly, start);
    }
    if (!breaks)
        course.kept_share = leaps ? 0 : std::clamp(10 * course.kept_share, least_kept_share, 1.0);
    if (breaks || leaps)
        course.least_merit = course.merit;
    return true;
}

void Solver::report(Convergence& convergence, double unbalanced_force_ratio) const
{
    convergence.steps = corrections_;
    convergence.unbalanced_force_ratio = unbalanced_force_ratio;
    if (observer_)
        observer_(convergence);
}

// Looks for equilibrium from the present displacements in at most so many corrections. False if it finds
// none: reason_.
bool Solver::converge(Assembly& assembly, const State& start, const Equilibrium& settings,
                      int most_corrections, Convergence& convergence)
{
    const Index first = corrections_;
    Course course;
    course.merit = course.least_merit = evaluate(assembly, start);
    for (;;) {
        const Balance balance = balance_of(assembly, stiffest_, 0, settings.tolerance);
        report(convergence, balance.ratio());
        const bool is_balanced = balance.ratio() <= settings.tolerance;
        if (is_balanced && is_at_rest(assembly, start, balance.mean, settings.tolerance, convergence))
            return true;
        if (corrections_ - first == most_corrections ||
            course.since_least == (yields(assembly) ? most_without_gain_with_flow : most_without_gain)) {
            reason_ = unsupported_ < 0 ? "forces do not come into balance"
                                       : "contacts do not carry the weight and the loads of the rock at " +
                                             shown(assembly.position[unsupported_]);
            return false;
        }

        const double enough = is_balanced
                                  ? 0.1 * force_.norm()
                                  : std::max(0.5 * settings.tolerance * balance.mean, 1e-2 * force_.norm());
        const VectorXd du = correction(assembly, start, force_, enough, course.kept_share);
        ++corrections_;
        if (!is_usable(du))
            return false;
        const std::vector<Vector2d> from = assembly.displacement;
        const Advance advance = go_along(assembly, start, du, course.merit);
        if (advance.failed_share > 0 && advance.merit > 0.99 * course.merit) {
            if (!get_past(assembly, start, from, du, advance, enough, course))
                return false;
        } else {
            course.merit = advance.merit;
            course.kept_share = course.kept_share <= least_kept_share ? 0 : course.kept_share / 3;
        }
        take(assembly, start, false);
        if (is_too_far(assembly, settings))
            return false;
        course.since_least = course.merit < course.least_merit ? 0 : course.since_least + 1;
        course.least_merit = std::min(course.merit, course.least_merit);
    }
}

// Whether one more correction would leave contact forces unchanged, and contacts support every piece of rock. A rough
// correction is asked first: it is rather too large, except where contacts are open.
bool Solver::is_at_rest(const Assembly& assembly, const State& start, double mean_force, double tolerance,
                        Convergence& convergence)
{
    unsupported_ = -1;
    if (mean_force == 0) { // no force anywhere
        convergence.contact_force_change = convergence.remaining_displacement = 0;
        return true;
    }
    const auto take = [&](const VectorXd& du) {
        convergence.contact_force_change = force_change(assembly, start, du) / mean_force;
        std::vector<Vector2d> u(assembly.position.size(), Vector2d::Zero());
        stiffness_.add_to(u, du, 1);
        convergence.remaining_displacement = 0;
        for (const Vector2d& one : u)
            convergence.remaining_displacement = std::max(convergence.remaining_displacement, one.norm());
    };
    if (!yields(assembly)) {
        ++solves_;
        take(stiffness_.solve(force_));
    }
    if (yields(assembly) || convergence.contact_force_change > tolerance) {
        const VectorXd du = correction(assembly, start, force_, 0.1 * force_.norm(), 0);
        if (du.size() > 0)
            take(du);
        else if (yields(assembly))
            return false;
    }
    if (convergence.contact_force_change > tolerance)
        return false;
    // The springs that open contacts keep in the factor may support rock that nothing else supports.
    const double largest = largest_displacement(assembly).first, enough = mechanics::enough(tolerance);
    const mechanics::RemainingDisplacement left =
        largest_remaining_displacement(assembly, enough, 1e-15 * stiffest_ * largest);
    const double moved =
        std::max(mechanics::largest_move(start.displacement, assembly.displacement).first, largest / 10);
    unsupported_ = left.displacement > enough * moved ? left.gridpoint : -1;
    convergence.remaining_displacement = std::max(convergence.remaining_displacement, left.displacement);
    return unsupported_ < 0;
}

// Restores bonds that need not have broken, if there is equilibrium with them.
void Solver::restore_bonds(Assembly& assembly, const State& start, const Equilibrium& settings,
                           Convergence& convergence)
{
    for (;;) {
        const std::vector<Vector2d> displacement = assembly.displacement;
        const mechanics::ActiveForces before = active_;
        const Convergence with_them = convergence;
        if (!mend_bonds(assembly))
            return;
        if (converge(assembly, start, settings, most_corrections_to_mend, convergence))
            continue;
        assembly.displacement = displacement;
        for_each_force([](auto& active, const auto& its_before) { active.break_again(its_before); }, active_,
                       before);
        convergence = with_them;
        return;
    }
}

std::optional<Convergence> Solver::equilibrate(Assembly& assembly, const Equilibrium& settings,
                                               const std::vector<Vector2d>& guess)
{
    begin_search(assembly);
    const State start = state_of(assembly);
    const auto give_up = [&] {
        go_back(assembly, start);
        return std::nullopt;
    };
    prepare(assembly);
    Convergence convergence;
    convergence.is_implicit = true;
    const double merit = evaluate(assembly, start);
    if (!std::isfinite(merit)) {
        reason_ = "forces are no finite numbers";
        return give_up();
    }
    const std::vector<ContactStatus> status_at_start = assembly.contacts.status;
    const double stored_at_start = stored_energy(assembly) + returned_energy(assembly, start);
    const bool is_balanced =
        balance_of(assembly, stiffest_, 0, settings.tolerance).ratio() <= settings.tolerance;
    if (!guess.empty() && !is_balanced) {
        for (std::size_t g = 0; g < guess.size(); ++g)
            assembly.displacement[g] += free_part(assembly, g, guess[g]);
        if (evaluate(assembly, start) > merit) {
            assembly.displacement = start.displacement;
            evaluate(assembly, start);
        }
    }
    take(assembly, start, true);
    if (!stiffness_.has_factor()) {
        space_.forget();
        linear_space_.forget();
        acting_ = tangents(assembly, start, soft_in_factor);
        ++factorisations_;
        if (!stiffness_.factorise(assembly, acting_)) {
            reason_ = "some rock has no support";
            return give_up();
        }
    }
    if (!converge(assembly, start, settings, most_corrections, convergence) &&
        !(yields(assembly) && flow_to_rest(assembly, start, settings, convergence))) {
        if (collapse_)
            return std::nullopt;
        return give_up();
    }
    if (is_balanced && corrections_ == 0)
        return convergence;
    restore_bonds(assembly, start, settings, convergence);

    convergence.steps = corrections_;
    evaluate(assembly, start);
    convergence.stored = stored_energy(assembly) - stored_at_start;
    convergence.dissipated = dissipated(assembly, start);
    convergence.work_of_loads = work_of_loads(assembly, start.displacement);
    convergence.damped = convergence.work_of_loads - convergence.stored - convergence.dissipated;
    if (!any_closes(status_at_start, assembly.contacts.status))
        convergence.created = created_energy(assembly, start, convergence.damped);
    return convergence;
}

double created_energy(const Assembly& assembly, const mechanics::State& start, double damped)
{
    double released = damped;
    for (std::size_t g = 0; g < assembly.displacement.size(); ++g)
        released -= assembly.force[g].dot(assembly.displacement[g] - start.displacement[g]);
    return std::max(0.0, -released);
}

// What a search needs to know of the assembly.
void Solver::prepare(const Assembly& assembly)
{
    stiffness_.follow(assembly);
    const std::vector<double> row_sums = stiffness_row_sums(assembly);
    stiffest_ = *std::max_element(row_sums.begin(), row_sums.end());
    too_far_ = size_of(assembly) / 10;
    std::vector<Vector2d> scales;
    for (std::size_t g = 0; g < row_sums.size(); ++g)
        scales.emplace_back(row_sums[g] * (is_on_rollers(assembly, g) ? assembly.along[g] : Vector2d(1, 1)));
    scale_ = stiffness_.gathered(assembly, scales);
    for_each_force([](const auto& force, auto& active) { active.begin(force); }, assembly, active_);
    collapse_.reset();
    corrections_ = factorisations_ = solves_ = 0;
}

} // namespace jointcreep::implicit
