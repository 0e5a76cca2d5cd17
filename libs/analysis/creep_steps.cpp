#include "analysis/creep_steps.hpp"

#include "model/units.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace jointcreep::analysis
{

namespace
{

// How often a step is halved where the implicit engine finds no equilibrium at its end. After that the whole step is
// tried by dynamic relaxation.
constexpr int most_halvings_of_a_step = 5;

// How often one creep step is cut where contacts close. In rock full of open joints some close all the time.
constexpr int most_cuts = 6;

// After so many steps what the implicit engine has learnt is forgotten (model/checkpoint.hpp). A new factor costs less
// than two steps.
constexpr Index steps_to_forgetting = 50;

// Throws if a fixed step length gives too many steps.
void check_number_of_steps(double from, double to, const CreepSettings& creep)
{
    constexpr double most = 1e6;
    if (creep.step && (to - from) / *creep.step > most)
        throw input_error("creep step of " + shown(*creep.step / unit::day) + " day: that makes " +
                          shown(std::ceil((to - from) / *creep.step)) + " steps from day " +
                          shown(from / unit::day) + " to day " + shown(to / unit::day) +
                          "; expected at most " + shown(most));
}

// The published scheme is stable below a step length that depends on joints and rocks; beyond it results are wrong. A
// longer fixed step is refused; chosen steps stay below.
std::optional<StableLimit> limit_of_published(const Section& section)
{
    const Scene& scene = section.scene;
    if (!scene.creep || scene.creep->scheme != CreepScheme::published)
        return {};
    const creep::StepLimit limit = mechanics::longest_stable_step(scene, section.network, section.joints);
    if (limit.set_by.empty())
        return {};
    if (scene.creep->step && *scene.creep->step >= limit.step)
        throw unstable_step("creep step of " + shown(*scene.creep->step / unit::day) +
                            " day: the published scheme is stable only below " +
                            shown(limit.step / unit::day) + " day, the limit of " + limit.set_by);
    return StableLimit{limit.step, limit.set_by};
}

} // namespace

CreepSteps::CreepSteps(Section& section, Engines& engines, const Watchers& watchers,
                       std::uint64_t state_every)
    : section_(section), engines_(engines), watchers_(watchers), state_every_(state_every),
      stable_limit_(limit_of_published(section))
{
}

void CreepSteps::begin(DynamicStage* dynamics)
{
    dynamics_ = dynamics;
    const std::optional<CreepSettings>& settings = section_.scene.creep;
    if (!settings)
        return;
    creep_.emplace(section_.scene, section_.network, section_.joints, section_.mesh(), section_.assembly);
    watchers_.tell(&Watcher::creep_begins, *creep_);
    if (!creep_->anything_creeps())
        return;
    length_.emplace(*settings, creep_->fastest_rate(),
                    stable_limit_ ? stable_limit_->step : std::numeric_limits<double>::infinity());
    if (creep::is_second_order(settings->scheme) && dynamics_ == nullptr)
        closing_.emplace(length_->closing_tolerance()); // the others are of first order anyway
}

void CreepSteps::go_to(double last, double date, bool may_stop)
{
    double& now = section_.now;
    const bool is_loaded = section_.loading.changes(last, date);
    const double longest =
        is_loaded ? (date - last) / section_.scene.equilibrium.unloading_increments : date - last;
    if (is_loaded && now == last)
        start_afresh();
    if (creeps())
        check_number_of_steps(last, date, *section_.scene.creep);
    while (now < date && !end_) {
        forget_now_and_then();
        section_.say("");
        const double target = next_target(date, longest);
        if (!creeps() && !is_loaded)
            now = target;
        else if (!reaches(target, may_stop))
            continue; // by shorter steps
        ++steps_since_forgetting_;
        watchers_.tell(&Watcher::row_is_due, "");
        if (state_every_ > 0 && creeps() && ++steps_ % state_every_ == 0 && now < date)
            watchers_.tell(&Watcher::state_is_due, "");
    }
    watchers_.tell(&Watcher::state_is_due, "");
}

void CreepSteps::forget_now_and_then()
{
    if (steps_since_forgetting_ >= steps_to_forgetting)
        engines_.forget();
    if (engines_.has_learnt() || section_.settled.effort.steps > 0) // of a step that was rejected
        return;
    steps_since_forgetting_ = 0;
    last_move_.clear();
    watchers_.tell(&Watcher::may_continue_here);
}

// Where the next step is to end, no longer than `longest` [s].
double CreepSteps::next_target(double date, double longest) const
{
    const double remaining = date - section_.now;
    const double step = creeps() ? length_->next(remaining, longest) : std::min(remaining, longest);
    return step < (1 - 1e-12) * remaining ? section_.now + step : date;
}

// One step, or several where contacts close before its end. The times of rows do not depend on contacts. False if the
// error of a step is too large.
bool CreepSteps::reaches(double target, bool may_stop)
{
    int cuts_left = most_cuts;
    while (section_.now < target && !end_) {
        if (!(dynamics_ != nullptr ? step_by_dynamics(target) : step_to(target, cuts_left)))
            return false;
        const std::optional<double> stop_rate =
            may_stop && creeps() ? section_.scene.creep->stop_rate : std::nullopt;
        if (stop_rate && is_slower_than(*stop_rate))
            end_ = section_.now;
    }
    return true;
}

// One step of creep and loading, to the target, or to where an open contact closes before it. False if its error is
// too large: then only the length of the next step has changed.
bool CreepSteps::step_to(double target, int& cuts_left)
{
    mechanics::Assembly& assembly = section_.assembly;
    const mechanics::State start = state_of(assembly);
    const std::optional<mechanics::Creep> creep_at_start = creep_;
    if (closing_)
        closing_->start(assembly.contacts);
    watchers_.tell(&Watcher::step_begins);
    const Step step = settle(target, start, cuts_left);
    watchers_.tell(&Watcher::step_settles, step);
    if (creeps() && !length_->stands(step.duration, creep_->end(assembly))) {
        go_back(assembly, start);
        creep_ = creep_at_start;
        section_.loading.apply(assembly, section_.now);
        watchers_.tell(&Watcher::step_is_rejected);
        return false;
    }
    if (closing_)
        closing_->finish(assembly.contacts, step.duration);
    end_step(step, start.displacement);
    return true;
}

void CreepSteps::end_step(const Step& step, const std::vector<Vector2d>& displacement_before)
{
    last_duration_ = step.duration;
    last_move_ = section_.assembly.displacement;
    for (std::size_t g = 0; g < last_move_.size(); ++g)
        last_move_[g] -= displacement_before[g];
    section_.now = step.end;
    watchers_.tell(&Watcher::step_ends, step);
    if (!step.is_whole && length_)
        length_->start_afresh();
}

// The same with large displacements. A step in which rock slides is halved; what slides in the shortest one is followed
// until it rests.
bool CreepSteps::step_by_dynamics(double target)
{
    const CreepScheme scheme = creep::scheme_of_step(section_.scene.creep->scheme, false);
    const std::vector<Vector2d> before = section_.assembly.displacement;
    const double start = section_.now;
    double end = target;
    bool slides = false;
    for (int halvings = 0; !slides && !dynamics_->creeps_to_rest(scheme, end - start); ++halvings) {
        slides = halvings == most_halvings_of_a_step;
        if (!slides)
            end = start + (end - start) / 2;
    }
    if (slides)
        dynamics_->creep_and_slide(scheme, end);
    else if (length_->stands(end - start, dynamics_->end_creep()))
        dynamics_->accept_creep();
    else {
        dynamics_->undo_creep();
        return false;
    }
    end_step({end, end - start, end == target && !slides, nullptr, nullptr}, before);
    return true;
}

// Finds an equilibrium at the end of a step from now: at the target, before it where the implicit engine
// finds none, and before that where contacts close.
Step CreepSteps::settle(double target, const mechanics::State& start, int& cuts_left)
{
    double end = target;
    int halvings = section_.engine == EngineChoice::relaxation ? most_halvings_of_a_step : 0;
    for (;;) {
        const double duration = end - section_.now;
        if (!settles_at(end, halvings == most_halvings_of_a_step, start)) {
            // Rock that flows on without bound at the end of the step does so after smaller ones, too.
            halvings = engines_.implicit_engine().collapse() ? most_halvings_of_a_step : halvings + 1;
            end = halvings < most_halvings_of_a_step ? section_.now + duration / 2 : target;
            watchers_.tell(&Watcher::step_is_halved);
            continue;
        }
        const Step step{end, duration, end == target, creeps() ? &*creep_ : nullptr,
                        closing_ ? &*closing_ : nullptr};
        const double longest = closing_ && cuts_left > 0
                                   ? closing_->longest_step(section_.assembly.contacts, duration)
                                   : duration;
        if (longest >= duration || longest < 1e-9 * (target - section_.now))
            return step;
        --cuts_left;
        watchers_.tell(&Watcher::step_is_cut, step);
        go_back(section_.assembly, start);
        end = section_.now + longest;
    }
}

// Whether there is an equilibrium nearby at the end of a step from now [s]. If there is none at all, the
// state at its start is recorded.
bool CreepSteps::settles_at(double end, bool by_relaxation, const mechanics::State& start)
{
    const double duration = end - section_.now;
    if (creeps())
        creep_->begin(duration, section_.assembly, section_.loading.changes(section_.now, end));
    section_.loading.apply(section_.assembly, end);
    try {
        if (!by_relaxation)
            return engines_.settles_nearby(guess(duration));
        engines_.settle_by_relaxation(end);
        return true;
    } catch (const equilibrium_error&) {
        if (creeps())
            creep_->cancel(section_.assembly);
        go_back(section_.assembly, start);
        watchers_.tell(&Watcher::state_is_due, "");
        throw;
    }
}

// A guess of the displacements in the next step [m]: creep slows down.
std::vector<Vector2d> CreepSteps::guess(double duration) const
{
    std::vector<Vector2d> guess = last_move_;
    for (Vector2d& move : guess)
        move *= 0.9 * duration / last_duration_;
    return guess;
}

// Whether every gridpoint moved more slowly in the last step [m/s].
bool CreepSteps::is_slower_than(double rate) const
{
    return std::all_of(last_move_.begin(), last_move_.end(),
                       [&](const Vector2d& move) { return move.norm() < rate * last_duration_; });
}

void CreepSteps::start_afresh()
{
    last_move_.clear();
    steps_since_forgetting_ = 0;
    if (length_)
        length_->start_afresh();
    if (closing_)
        closing_->start_afresh();
    watchers_.tell(&Watcher::loads_change);
}

void CreepSteps::transfer(const Transfer& to, Checkpoint& kept)
{
    if (creep_)
        creep_->transfer(to, kept);
    if (length_)
        length_->transfer(to, kept);
    if (closing_)
        closing_->transfer(to, kept);
    // Steps count from the last recorded state.
    steps_ %= std::max<std::uint64_t>(state_every_, 1);
    to.value(steps_, kept.steps_since_state);
}

} // namespace jointcreep::analysis
