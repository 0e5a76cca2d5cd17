#include "relaxation/relax.hpp"

#include "mechanics/failure.hpp"
#include "mechanics/rest.hpp"
#include "model/error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

namespace jointcreep::relaxation
{

using Eigen::Vector2d;
using mechanics::Assembly;
using mechanics::Balance;
using mechanics::chunk;
using mechanics::Convergence;
using mechanics::enough;
using mechanics::no_equilibrium;

namespace
{

constexpr Index check_every = 20, window = 100; // [steps]
constexpr Index patience = 5000;                // between checks whether blocks are moving [steps]
constexpr Index looks_enough = 3;               // checks in a row that find it sliding or falling
constexpr double safety = 0.9;                  // of the largest stable step
constexpr double rounding = 1e-11;              // of the unbalanced force ratio: nothing is nearer to balance

std::string shown_length(double length)
{
    return rounded(length, 3) + " m";
}

std::string shown_place(const Vector2d& place)
{
    return '[' + rounded(place.x()) + ", " + rounded(place.y()) + "] m";
}

// Patience with the remaining displacement, once forces are in balance. It ends where the remaining displacement
// has not shrunk by a tenth in a third of all steps, and in 5000. What is left then is rounding.
class Patience
{
public:
    bool ends(double share, Index steps)
    {
        if (steps < until_)
            return false;
        const bool stands_still = until_ > 0 && share >= 0.9 * last_share_;
        last_share_ = share;
        until_ = steps + std::max(patience, steps / 2);
        return stands_still;
    }
    void pass(Tape& tape) { tape(until_, last_share_); }

private:
    Index until_ = 0;
    double last_share_ = 0;
};

// Reported forces, those of contacts, at the last few checks.
class ForceMemory
{
public:
    // Takes the present forces and returns the largest change over the last `window` steps, infinite before.
    double change_since_window(const Assembly& assembly)
    {
        std::vector<Vector2d>& oldest = kept_[n_ % kept_.size()];
        std::vector<Vector2d> now;
        for_each_force(
            [&](const auto& one) {
                const auto forces = reported_forces(one);
                now.insert(now.end(), forces.begin(), forces.end());
            },
            assembly);
        double change = std::numeric_limits<double>::infinity();
        if (n_ >= kept_.size()) {
            change = 0;
            for (std::size_t i = 0; i < now.size(); ++i)
                change = std::max(change, (now[i] - oldest[i]).norm());
        }
        oldest.swap(now);
        ++n_;
        return change;
    }
    void pass(Tape& tape)
    {
        const std::size_t n = kept_[0].size(); // there since the start
        for (std::vector<Vector2d>& kept : kept_)
            tape.list_of(n, kept);
        tape(n_);
    }

private:
    std::array<std::vector<Vector2d>, window / check_every> kept_;
    std::size_t n_ = 0;
};

class Relaxation
{
public:
    Relaxation(Assembly& assembly, const Equilibrium& settings, const std::vector<double>& row_sums)
        : a_(assembly), settings_(settings), velocity_(assembly.position.size(), Vector2d::Zero()),
          start_(assembly.displacement),
          patience_ago_(assembly.displacement), older_{0, assembly.displacement, assembly.force, 0},
          newer_(older_), row_sums_(row_sums)
    {
        if (settings.damping == Damping::mass && settings.masses == Masses::scaled)
            throw input_error("equilibrium: damping \"mass\" needs masses = \"real\"; scaled masses have no "
                              "frequency of their own");
        take_stiffness();
        too_far_ = size_of(assembly) / 10;
        sums_.resize(chunks_of(assembly));
        begin_search(assembly, settings.stiffness_damping > 0);
        stored_at_start_ = stored_energy(assembly);
        if (settings.damping == Damping::adaptive || settings.damping == Damping::combined)
            last_force_ = assembly.force;
    }

    // Time of the solver since the start [s].
    double time() const { return time_before_ + steps_since_ * dt_; }

    // Moves by so many steps. The threads stay together for all of them, and wait for each other twice a
    // step: when all gridpoints have moved, and when all zones and contacts have been pulled.
    void move(Index steps)
    {
        const bool may_stiffen = has_any(stiffening_); // asked here: a thread may replace it below
        if (may_stiffen)
            remember_before_step();
#pragma omp parallel num_threads(a_.threads) if (a_.threads > 1)
        {
            double alpha = settings_.damping == Damping::mass ? settings_.mass_damping : alpha_;
            double work = work_;
            double last_energy = last_energy_;
            bool starts_from_rest = starts_from_rest_;
            for (Index i = 0; i < steps; ++i) {
                step_in_team(alpha, starts_from_rest);
                while (may_stiffen && stiffens_too_far_in_team())
                    step_in_team(alpha, starts_from_rest);
#pragma omp master
                ++steps_since_;
                Sums sums; // every thread adds them up for itself, before the next step writes new ones
                for (const Sums& some : sums_) {
                    sums.energy += some.energy;
                    sums.answer += some.answer;
                    sums.work += some.work;
                }
                work += sums.work;
                if (settings_.damping == Damping::adaptive)
                    alpha = sums.energy > 0 && sums.answer > 0
                                ? std::min(2 * std::sqrt(sums.answer / (dt_ * sums.energy)), 1.9 / dt_)
                                : 0.0;
                starts_from_rest = settings_.damping == Damping::kinetic && sums.energy < last_energy;
                last_energy = starts_from_rest ? 0.0 : sums.energy;
                if (starts_from_rest)
                    work += go_back_to_peak_in_team(may_stiffen);
                find_forces_in_team(a_, i + 1 < steps);
            }
#pragma omp barrier
#pragma omp single
            {
                alpha_ = alpha;
                work_ = work;
                starts_from_rest_ = starts_from_rest;
                last_energy_ = last_energy;
            }
        }
    }

    // Throws if rock is moving: too far already, or steadily.
    void check_movement(Index steps)
    {
        const auto [moved, g] = mechanics::largest_move(start_, a_.displacement);
        if (!std::isfinite(moved))
            throw no_equilibrium("the rock at " + shown_place(a_.position[g]) +
                                 " has moved without bound; does anything support it?");
        if (moved > too_far_)
            give_up("the rock at " + shown_place(a_.position[g]) + " has moved " + shown_length(moved) +
                        " and is still moving; does anything support it?",
                    true, steps);
        const auto [in_all, h] = largest_displacement(a_);
        if (in_all > settings_.largest_displacement)
            give_up("the displacement of the rock at " + shown_place(a_.position[h]) +
                        " exceeds the limit of " + shown_length(settings_.largest_displacement) +
                        " (--safety-displacement)",
                    true, steps);
        if (in_all > too_far_)
            give_up("the rock at " + shown_place(a_.position[h]) + " has moved " + shown_length(in_all) +
                        " since the in-situ state, by more than a tenth of the section: too far for small "
                        "displacements",
                    false, steps);
        if (steps % patience != 0)
            return;
        const auto [lately, k] = mechanics::largest_move(patience_ago_, a_.displacement);
        checks_in_movement_ = blocks_are_moving() ? checks_in_movement_ + 1 : 0;
        if (checks_in_movement_ == looks_enough)
            give_up("the rock at " + shown_place(a_.position[k]) + " is moving: " + shown_length(lately) +
                        " in the last " + std::to_string(patience) +
                        " steps, and the unbalanced forces do not decrease enough "
                        "to stop it",
                    true, steps);
    }

    // From here check_movement() and give_up() count displacements.
    void begin_interval()
    {
        patience_ago_ = a_.displacement;
    }

    // The remaining displacement, by estimate, over the displacement since the start, or over a tenth of the whole
    // displacement if that is more: roots of sums over mass times length squared. Between two moments, the quotient
    // of the change of forces to the displacement is w^2 of the softest mode in this displacement. The unbalanced
    // force over mass is w^2 times the remaining displacement. Stiffer modes in the force make the estimate too
    // large. In the displacement they make it too small; so the moments are a quarter of all steps apart or more,
    // in which these modes die out.
    double remaining_share() const
    {
        double force = 0, answer = 0, between = 0, gone = 0, whole = 0;
        for (std::size_t g = 0; g < mass_.size(); ++g) {
            const Vector2d now = free_part(a_, g, a_.force[g]);
            const Vector2d moved = a_.displacement[g] - older_.displacement[g];
            force += inverse_mass_[g] * now.squaredNorm();
            answer -= moved.dot(now - free_part(a_, g, older_.force[g]));
            between += mass_[g] * moved.squaredNorm();
            gone += mass_[g] * (a_.displacement[g] - start_[g]).squaredNorm();
            whole += mass_[g] * a_.displacement[g].squaredNorm();
        }
        gone = std::max(gone, whole / 100);
        if (force == 0)
            return 0;
        return answer > 0 && gone > 0 ? std::sqrt(force / gone) * between / answer
                                      : std::numeric_limits<double>::infinity();
    }

    // Keeps the present moment for remaining_share if it is time.
    void remember(Index steps)
    {
        if (3 * steps < 4 * newer_.steps)
            return;
        older_ = std::move(newer_);
        newer_ = {steps, a_.displacement, a_.force, work_};
    }

    // What the share is of: the largest displacement since the start, or a tenth of the largest whole displacement
    // [m].
    double reference_displacement() const
    {
        return std::max(mechanics::largest_move(start_, a_.displacement).first,
                        largest_displacement(a_).first / 10);
    }

    // Throws, with the displacements since the last check whether blocks are moving.
    [[noreturn]] void give_up(const std::string& why, bool moves_on, Index steps) const
    {
        no_equilibrium error(why);
        error.moves_on = moves_on;
        error.steps = (steps - 1) % patience + 1;
        error.seconds = settings_.masses == Masses::real ? error.steps * dt_ : 0.0;
        for (std::size_t g = 0; g < a_.displacement.size(); ++g)
            error.motion.emplace_back(a_.displacement[g] - patience_ago_[g]);
        throw error;
    }

    // Calls a check of the forces of springs alone. Dashpots of stiffness damping balance springs that still move
    // slowly.
    bool without_dashpots(const std::function<bool()>& check)
    {
        if (settings_.stiffness_damping == 0)
            return check();
        const std::vector<Vector2d> with = a_.force;
        find_forces(a_); // nothing moves since the last time, so that dashpots have no force
        const bool passed = check();
        a_.force = with;
        return passed;
    }

    // All that has changed since the start; the assembly's too.
    void pass(Tape& tape)
    {
        mechanics::pass(tape, a_);
        tape(velocity_, patience_ago_, last_force_, older_, newer_, row_sums_, mass_, work_of_changes_, work_,
             time_before_, steps_since_, dt_, alpha_, checks_in_movement_, last_energy_, starts_from_rest_);
        mechanics::pass(tape, stiffening_);
        follow_masses_and_step();
    }

    // Ends the movement and settles the energy balance. The end takes what kinetic energy is left, as damping does.
    void finish(Convergence& convergence)
    {
        a_.stiffness_damping_rate = 0;
        find_forces(a_);
        convergence.stored = stored_energy(a_) - stored_at_start_;
        convergence.dissipated = mechanics::dissipated(a_);
        convergence.work_of_loads = work_of_loads(a_, start_);
        // Stiffness damping works inside zones and contacts, unseen by the gridpoints: it takes what
        // is missing.
        convergence.damped = settings_.stiffness_damping > 0
                                 ? convergence.work_of_loads - convergence.stored - convergence.dissipated
                                 : work_ + work_of_changes_ + work_of_half_a_step();
    }

private:
    // Rock stops where springs take up the force that drives it. Moving blocks find no such springs.
    // Since the older moment the unbalanced forces have done `work`, and over the same displacement they have
    // decreased by `answer`. If at this rate they do not vanish within a tenth of the section, blocks are moving.
    // With springs `answer` is twice the energy that the displacement would store in them; vibration does not make
    // it less.
    bool blocks_are_moving() const
    {
        const double work = work_ - older_.work;
        const double moved = mechanics::largest_move(older_.displacement, a_.displacement).first;
        double answer = 0;
        for (std::size_t g = 0; g < a_.force.size(); ++g)
            answer -= (a_.displacement[g] - older_.displacement[g])
                          .dot(free_part(a_, g, a_.force[g] - older_.force[g]));
        return work > 0 && work * moved > answer * too_far_;
    }

    // Masses and step for row_sums_, and all that follows from them.
    void take_stiffness()
    {
        const double local = 1 + local_damping();
        time_before_ = time();
        steps_since_ = 0;
        if (settings_.masses == Masses::real) {
            mass_ = lumped_masses(a_);
            double highest = 0; // frequency squared
            for (std::size_t g = 0; g < mass_.size(); ++g)
                if (mass_[g] > 0)
                    highest = std::max(highest, row_sums_[g] / mass_[g]);
            // Stiffness damping shortens the stable step: (2 / w) (sqrt(1 + xi^2) - xi), xi = beta w / 2.
            const double xi = settings_.stiffness_damping * std::sqrt(highest) / 2;
            dt_ = safety * 2 / std::sqrt(highest * local) * (std::sqrt(1 + xi * xi) - xi);
        } else {
            dt_ = 1;
            mass_.clear();
            for (const double sum : row_sums_)
                mass_.push_back(sum * local / (4 * safety * safety));
        }
        follow_masses_and_step();
        stiffening_ = stiffening_of(a_);
    }

    // Inverse masses, and the rate of stiffness damping over a step.
    void follow_masses_and_step()
    {
        inverse_mass_.clear();
        for (const double m : mass_)
            inverse_mass_.push_back(m > 0 ? 1 / m : 0.0); // gridpoints without any rock do not move
        a_.stiffness_damping_rate = settings_.stiffness_damping / dt_;
    }

    // Whether joints would be stiffer after the step than masses, or its length, are stable for. If so, undoes it before
    // forces follow, and takes masses or a length for that stiffness.
    bool stiffens_too_far_in_team()
    {
#pragma omp single
        {
            undoes_step_ = are_beyond(a_, stiffening_);
            if (undoes_step_)
                undo_step();
            else
                remember_before_step();
        }
        return undoes_step_;
    }

    void remember_before_step()
    {
        last_velocity_ = velocity_;
        force_before_ = last_force_;
    }

    // Velocities keep the kinetic energy, or energies would not balance.
    void undo_step()
    {
        const std::vector<double> mass = mass_;
        const double last_dt = dt_;
        const std::vector<double> now = stiffness_row_sums(a_);
        for (std::size_t g = 0; g < now.size(); ++g) // joints that have opened may close again
            row_sums_[g] = std::max(row_sums_[g], now[g]);
        take_stiffness();
        last_force_ = force_before_;
        for (std::size_t g = 0; g < mass.size(); ++g) {
            if (!(mass[g] > 0))
                continue;
            a_.displacement[g] -= last_dt * velocity_[g];
            velocity_[g] = std::sqrt(mass[g] / mass_[g]) * last_velocity_[g];
            // The step takes half of the last one's work to be that of this velocity.
            work_of_changes_ +=
                free_part(a_, g, a_.force[g]).dot(last_dt * last_velocity_[g] - dt_ * velocity_[g]) / 2;
            last_velocity_[g] = velocity_[g];
        }
    }

    struct Moment {
        Index steps;
        std::vector<Vector2d> displacement, force;
        double work = 0; // of the unbalanced forces, since the start [J/m]

        void pass(Tape& tape) { tape(steps, displacement, force, work); }
    };

    // Over gridpoints, in one step.
    struct Sums {
        double energy = 0, answer = 0; // of the Rayleigh quotient: kinetic, and the change of forces by it
        double work = 0;               // of the unbalanced forces [J/m]
    };

    void step_in_team(double alpha, bool starts_from_rest)
    {
        const auto n = static_cast<Index>(velocity_.size());
        const auto n_chunks = static_cast<Index>(sums_.size());
        const double keep = (1 - alpha * dt_ / 2) / (1 + alpha * dt_ / 2);
        // Velocities live half a step before displacements: from rest the first one gets half a step's gain.
        // With a whole one the stiffest parts would overshoot, and stopping them again and again would blow
        // them up.
        const double interval = (starts_from_rest ? 0.5 : 1.0) * dt_;
        const double gain = interval / (1 + alpha * dt_ / 2);
        const double local = local_damping();
        const bool adaptive = settings_.damping == Damping::adaptive;
        const bool combined = settings_.damping == Damping::combined;
        const bool kinetic = settings_.damping == Damping::kinetic;
        const bool has_rollers = !a_.along.empty(); // inclined ones; asked once, not at each gridpoint
#pragma omp for schedule(static)
        for (Index k = 0; k < n_chunks; ++k) {
            Vector2d energy(0, 0), answer(0, 0), work(0, 0); // in x and y apart: one sum a number is slower
            for (Index g = k * chunk; g < std::min(n, (k + 1) * chunk); ++g) {
                const Vector2d free_force = has_rollers ? free_part(a_, g, a_.force[g])
                                                        : Vector2d(a_.force[g].cwiseProduct(a_.is_free[g])),
                               last = velocity_[g];
                Vector2d force = free_force, change = Vector2d::Zero(); // in the last step
                if (adaptive || combined) {
                    change = force - last_force_[g];
                    last_force_[g] = force;
                }
                if (adaptive) {
                    answer -= last.cwiseProduct(change);
                    energy += mass_[g] * last.cwiseAbs2();
                }
                const Vector2d before = starts_from_rest ? Vector2d(Vector2d::Zero()) : last;
                if (combined)
                    force += local / 2 * force.cwiseAbs().cwiseProduct(signs_of(change) - signs_of(before));
                else if (local > 0)
                    force -= local * force.cwiseAbs().cwiseProduct(signs_of(before));
                Vector2d v = keep * before + gain * inverse_mass_[g] * force;
                if (has_rollers) // damping by components, and rounding, lead off them
                    v = free_part(a_, g, v);
                if (kinetic)
                    energy += mass_[g] * v.cwiseAbs2();
                work += free_force.cwiseProduct(v + last);
                velocity_[g] = v;
                a_.displacement[g] += dt_ * v;
            }
            sums_[k] = {energy.sum(), answer.sum(), work.sum() / 2 * dt_};
        }
    }

    // Replaces the step, in which the kinetic energy has decreased, by half of the step before it, backwards: to the
    // place of the peak (Barnes 1999, Int. J. Space Structures 14, 89). The next step starts from rest there. In linear
    // rock every vibration keeps at most cos(p / 2) of its amplitude, one alone at most sin(p) / 2, with the phase p of a
    // step. Without this, gridpoints would stop one or two steps after the peak: vibrations with periods near six or
    // eight steps would stop at the other end of their path, with their whole amplitude.
    // Returns the change of the work [J/m].
    double go_back_to_peak_in_team(bool may_stiffen)
    {
        const auto n = static_cast<Index>(velocity_.size());
        const auto n_chunks = static_cast<Index>(sums_.size());
#pragma omp barrier // all have read the sums of the step
#pragma omp for schedule(static)
        for (Index k = 0; k < n_chunks; ++k) {
            double work = 0;
            for (Index g = k * chunk; g < std::min(n, (k + 1) * chunk); ++g) {
                const Vector2d force = free_part(a_, g, a_.force[g]);
                const Vector2d last = velocity_[g] - dt_ * inverse_mass_[g] * force; // in the step before
                const Vector2d change = -last / 2 - velocity_[g];
                work += force.dot(change);
                velocity_[g] += change;
                a_.displacement[g] += dt_ * change;
            }
            sums_[k].work = work / 2 * dt_;
        }
        if (may_stiffen) {
#pragma omp single
            remember_before_step();
        }
        double work = 0;
        for (const Sums& some : sums_)
            work += some.work;
        return work;
    }

    // Each step counts half of its displacement under the forces at its start and half under those at its end, which
    // the next step adds; no step follows the last one [J/m].
    double work_of_half_a_step() const
    {
        double work = 0;
        for (std::size_t g = 0; g < velocity_.size(); ++g)
            work += free_part(a_, g, a_.force[g]).dot(velocity_[g]) * dt_ / 2;
        return work;
    }

    double local_damping() const
    {
        return settings_.damping == Damping::local || settings_.damping == Damping::combined
                   ? settings_.local_damping
                   : 0.0;
    }

    // -1, 0 or 1 in x and y.
    static Vector2d signs_of(const Vector2d& v)
    {
        return v.array().sign();
    }

    Assembly& a_;
    const Equilibrium& settings_;
    std::vector<Vector2d> velocity_;
    std::vector<Vector2d> start_, patience_ago_, last_force_;
    std::vector<Vector2d> last_velocity_, force_before_; // before the step, where joints stiffen
    bool undoes_step_ = false;
    Moment older_, newer_;                    // a quarter of all steps ago or more
    std::vector<double> row_sums_;            // the largest so far [Pa]
    std::vector<double> mass_, inverse_mass_; // for these: [kg/m], [m/kg]
    std::vector<Sums> sums_;                  // of each chunk
    double work_of_changes_ = 0;              // of the step, apart as every thread adds up work_ for itself
    double work_ = 0, stored_at_start_ = 0;
    mechanics::Stiffening stiffening_; // for which mass_ and dt_ are stable
    double time_before_ = 0;           // at the last change of the step [s]
    Index steps_since_ = 0;
    double dt_ = 0, too_far_ = 0, alpha_ = 0;
    Index checks_in_movement_ = 0; // in a row, every `patience` steps
    double last_energy_ = 0;       // twice the kinetic energy, with kinetic damping [J/m]
    bool starts_from_rest_ = true;
};

// Whether equilibrium is reached, and the convergence report.
class ConvergenceCheck
{
public:
    ConvergenceCheck(const Assembly& assembly, const Equilibrium& settings, double stiffest)
        : assembly_(assembly), settings_(settings), stiffest_(stiffest)
    {
    }

    Convergence report;

    // Before the first step: whether forces are in balance but for rounding.
    bool is_balanced_already()
    {
        report.unbalanced_force_ratio = balance_for(settings_.tolerance).ratio();
        return is_rounding();
    }

    void begin() { memory_.change_since_window(assembly_); }

    // Every `check_every` steps.
    bool is_passed(Relaxation& relaxation)
    {
        const Balance balance = balance_for(settings_.tolerance);
        report.unbalanced_force_ratio = balance.ratio();
        report.contact_force_change = memory_.change_since_window(assembly_) / balance.mean;
        if (!std::isfinite(report.unbalanced_force_ratio))
            throw no_equilibrium("forces are no longer finite numbers after " + std::to_string(report.steps) +
                                 " steps");
        const bool is_balanced = report.unbalanced_force_ratio <= settings_.tolerance;
        steps_in_balance_ = is_balanced ? steps_in_balance_ + check_every : 0;
        if (is_balanced)
            remaining_share_[report.steps / check_every % remaining_share_.size()] =
                relaxation.remaining_share();
        relaxation.remember(report.steps);
        if (steps_in_balance_ < window || report.contact_force_change > settings_.tolerance)
            return false;
        return is_near(relaxation) && report.steps >= look_again_ && is_supported(relaxation);
    }

    // What is not as it should be, after all steps.
    std::string reason(const Relaxation& relaxation) const
    {
        std::string text = "after " + std::to_string(report.steps) + " steps the unbalanced force ratio is " +
                           rounded(report.unbalanced_force_ratio) + ", expected " +
                           shown(settings_.tolerance);
        if (report.remaining_displacement > 0)
            text += ", and by estimate " + shown_length(report.remaining_displacement) +
                    " of displacement remain, expected " +
                    shown_length(enough(settings_.tolerance) * relaxation.reference_displacement());
        if (unsupported_.displacement > 0)
            text += "; contacts do not carry the weight and the loads of the rock at " +
                    shown(assembly_.position[unsupported_.gridpoint]);
        return text + "; the largest unbalanced force is at " +
               shown(assembly_.position[balance_of(assembly_).worst]);
    }

    void pass(Tape& tape)
    {
        tape(memory_, steps_in_balance_, remaining_share_, with_remaining_, unsupported_.displacement,
             look_again_, largest_);
        tape.index(unsupported_.gridpoint, assembly_.position.size());
        tape(report.steps, report.unbalanced_force_ratio, report.contact_force_change,
             report.remaining_displacement);
    }

private:
    Balance balance_for(double tolerance)
    {
        for (const Vector2d& u : assembly_.displacement)
            largest_ = std::max(largest_, u.norm());
        return balance_of(assembly_, stiffest_, largest_, tolerance);
    }
    bool is_rounding() { return balance_for(rounding).ratio() <= rounding; }

    // Whether little displacement remains, by the last checks.
    bool is_near(const Relaxation& relaxation)
    {
        const double share = *std::max_element(remaining_share_.begin(), remaining_share_.end());
        report.remaining_displacement =
            (std::isfinite(share) ? share : 1) * relaxation.reference_displacement();
        return share <= enough(settings_.tolerance) || is_rounding() ||
               with_remaining_.ends(share, report.steps);
    }

    // Whether contacts support all pieces of rock.
    bool is_supported(const Relaxation& relaxation)
    {
        unsupported_ = largest_remaining_displacement(assembly_, enough(settings_.tolerance),
                                                      1e-15 * stiffest_ * largest_);
        if (unsupported_.displacement > enough(settings_.tolerance) * relaxation.reference_displacement()) {
            look_again_ = report.steps + report.steps / 10;
            return false;
        }
        report.remaining_displacement = std::max(report.remaining_displacement, unsupported_.displacement);
        return true;
    }

    const Assembly& assembly_;
    const Equilibrium& settings_;
    double stiffest_;
    double largest_ = 0; // displacement so far [m]
    ForceMemory memory_;
    Index steps_in_balance_ = 0;
    std::array<double, window / check_every> remaining_share_{}; // at the last checks
    Patience with_remaining_;
    mechanics::RemainingDisplacement unsupported_; // at the last look at pieces
    Index look_again_ = 0;                         // at them [steps]
};

} // namespace

Convergence relax(Assembly& assembly, const Equilibrium& settings, const StepObserver& observe,
                  SearchKeeper* keeper, const mechanics::SearchObserver& tell)
{
    find_forces(assembly);
    const std::vector<double> row_sums = stiffness_row_sums(assembly);
    ConvergenceCheck check(assembly, settings, *std::max_element(row_sums.begin(), row_sums.end()));
    Convergence& report = check.report;
    if (check.is_balanced_already())
        return report;

    Relaxation relaxation(assembly, settings, row_sums);
    check.begin();
    const auto pass = [&](Tape& tape) { tape(relaxation, check); };
    if (keeper != nullptr)
        keeper->search_begins(pass);
    while (report.steps < settings.most_steps) {
        if (report.steps % patience == 0)
            relaxation.begin_interval();
        if (keeper != nullptr && report.steps % window == 0)
            keeper->search_goes_on(pass);
        const Index steps =
            observe ? 1
                    : std::min(check_every - report.steps % check_every, settings.most_steps - report.steps);
        relaxation.move(steps);
        report.steps += steps;
        if (observe)
            observe(relaxation.time());
        if (report.steps % check_every != 0)
            continue;
        relaxation.check_movement(report.steps);
        if (relaxation.without_dashpots([&] { return check.is_passed(relaxation); })) {
            relaxation.finish(report);
            return report;
        }
        if (tell)
            tell(report);
    }
    relaxation.give_up(check.reason(relaxation), false, report.steps);
}

} // namespace jointcreep::relaxation
