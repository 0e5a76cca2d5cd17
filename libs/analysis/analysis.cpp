#include "analysis/analysis.hpp"

#include "mechanics/excavation.hpp"
#include "model/error.hpp"

#include <algorithm>
#include <limits>
#include <set>

namespace jointcreep::analysis
{

namespace
{

// How often a stage's increment is halved where the implicit engine finds no equilibrium at its end.
constexpr int most_halvings_of_an_increment = 5;

constexpr const char* of_another = "the state kept is that of another section";

// The times when something other than creep happens: stages, corners of the loading, first readings, the end.
std::set<double> dates_of(const Section& section)
{
    const Scene& scene = section.scene;
    std::set<double> dates{scene.end};
    for (const double time : section.loading.corners())
        if (time > 0 && time < scene.end)
            dates.insert(time);
    for (const Stage& stage : scene.stages)
        dates.insert(stage.time);
    for (const MonitoringPoint& point : scene.points)
        if (point.first_reading > 0)
            dates.insert(point.first_reading);
    return dates;
}

// The time of the last event; after it only creep remains [s].
double last_event_of(const Section& section)
{
    const std::vector<Stage>& stages = section.scene.stages;
    const std::set<double> corners = section.loading.corners();
    return std::max(stages.empty() ? 0.0 : stages.back().time, corners.empty() ? 0.0 : *corners.rbegin());
}

} // namespace

// 1. Divide the blocks into zones and load them with the in-situ stress.
Analysis::Analysis(const Scene& scene, const Network& network, const EquivalentJoints& joints, int threads,
                   const Recording& recording, const Observer& observe)
    : section_(scene, network, joints, threads, recording, observe),
      step_recorder_(section_, recording.step_history_every), engines_(section_, step_recorder_),
      guards_(section_), records_(section_), checkpoints_(section_, step_recorder_, recording,
                                                          [this] {
                                                              Checkpoint kept;
                                                              transfer(Transfer(Transfer::Way::keep), kept);
                                                              return kept;
                                                          }),
      creep_(section_, engines_, watchers_, recording.state_every)
{
    watchers_.add(checkpoints_);
    if (!recording.parameters.empty())
        watchers_.add(sensitivities_.emplace(recording.parameters, section_, engines_.implicit_engine()));
    watchers_.add(guards_);
    watchers_.add(records_);
}

void Analysis::run()
{
    is_in_situ_ = true;
    watchers_.tell(&Watcher::may_continue_here);
    is_in_situ_ = false;
    settle_in_situ();
    if (section_.scene.large_displacements)
        dynamics_.emplace(section_, watchers_).settle_in_situ();
    creep_.begin(dynamics_ ? &*dynamics_ : nullptr);
    follow_schedule(-std::numeric_limits<double>::infinity());
}

void Analysis::go_on(Result so_far, Checkpoint kept)
{
    const std::vector<Stage>& stages = section_.scene.stages;
    if (kept.stage < 0 || static_cast<std::size_t>(kept.stage) > stages.size())
        throw input_error(of_another);
    if (kept.search.empty()) {
        so_far.mesh = std::move(section_.result.mesh);
        section_.result = std::move(so_far);
        so_far = {};
    }
    checkpoints_.continue_from(kept, std::move(so_far));
    if (kept.is_in_situ != 0) {
        run();
        return;
    }
    if (section_.scene.large_displacements)
        dynamics_.emplace(section_, watchers_);
    creep_.begin(dynamics_ ? &*dynamics_ : nullptr);
    transfer(Transfer(Transfer::Way::restore), kept);
    const bool is_at_stage = next_stage_ < stages.size() && stages[next_stage_].time == section_.now;
    if (unloaded_ > 0) {
        if (!is_at_stage || dynamics_ || released_.size() != section_.assembly.load.size() || increment_ < 1)
            throw input_error(of_another);
        complete(stages[next_stage_]);
        ++next_stage_;
    }
    if (is_at_stage)
        excavate_stages_of(section_.now);
    follow_schedule(section_.now);
}

// 2. The in-situ equilibrium. Displacements count from here.
void Analysis::settle_in_situ()
{
    section_.say("in-situ equilibrium");
    const mechanics::State given = state_of(section_.assembly);
    try {
        engines_.check_supported();
        engines_.settle(0);
    } catch (const equilibrium_error&) {
        go_back(section_.assembly, given);
        watchers_.row_and_state_are_due("");
        throw;
    }
    section_.findings.yielded_in_situ = yielded_zones(section_);
    section_.findings.at_yield_in_situ = contacts_at_yield(section_);
    watchers_.tell(&Watcher::equilibrium_ends, 0.0);
    watchers_.tell(&Watcher::displacements_start);
    start_from_here(section_.assembly);
    section_.loading.apply(section_.assembly, 0);
    watchers_.row_and_state_are_due("");
}

// The scene's dates after a time [s].
void Analysis::follow_schedule(double after)
{
    double last = 0;
    for (const double date : dates_of(section_)) {
        if (date > after) {
            if (creep_.end())
                break;
            go_to(last, date);
            excavate_stages_of(date);
        }
        last = date;
    }
    for (const MonitoringPoint& point : section_.scene.points)
        if (point.first_reading > section_.now) // creep has ended before: nothing moves until then
            section_.recorder.start_readings(section_.result, point.first_reading);
}

// 3. Creep and changes of load, from the last date to the next. With large displacements no loads change.
void Analysis::go_to(double last, double date)
{
    if (!dynamics_ || creep_.creeps())
        creep_.go_to(last, date, section_.now >= last_event_of(section_));
    else if (date != section_.now) {
        section_.now = date;
        watchers_.row_and_state_are_due("");
    }
}

// The stages of a date, and the first readings after them.
void Analysis::excavate_stages_of(double date)
{
    const std::vector<Stage>& stages = section_.scene.stages;
    for (; next_stage_ < stages.size() && stages[next_stage_].time == date; ++next_stage_)
        excavate(stages[next_stage_]);
    section_.recorder.start_readings(section_.result, section_.now);
}

// 4. Excavate the rock of a stage, and unload what is left. With large displacements: a dynamic analysis until rest.
void Analysis::excavate(const Stage& stage)
{
    engines_.forget();
    watchers_.tell(&Watcher::stage_begins);
    released_ = mechanics::excavate(section_.assembly, section_.network.blocks, section_.mesh(),
                                    section_.loading, static_cast<Index>(next_stage_));
    watchers_.tell(&Watcher::rock_is_removed);
    increment_ = section_.engine == EngineChoice::relaxation ? 1 : 1 << most_halvings_of_an_increment;
    complete(stage);
}

// From where its rock is removed.
void Analysis::complete(const Stage& stage)
{
    section_.stage = stage.name;
    section_.say(stage.name);
    if (dynamics_) {
        dynamics_->run(&stage == &section_.scene.stages.back());
        creep_.start_afresh();
    } else {
        unload();
        creep_.start_afresh();
        watchers_.row_and_state_are_due(stage.name);
    }
    unloaded_ = increment_ = 0;
    released_.clear();
    if (stage.reset_displacements)
        mechanics::Recorder::reset(section_.result);
    section_.stage.clear();
}

// In the scene's increments. In smaller ones where the implicit engine finds no equilibrium nearby.
void Analysis::unload()
{
    engines_.check_supported();
    const std::vector<Vector2d> load = section_.assembly.load;
    const int finest = section_.engine == EngineChoice::relaxation ? 1 : 1 << most_halvings_of_an_increment;
    const int n = finest * section_.scene.equilibrium.unloading_increments;
    while (unloaded_ < n) {
        if (unloaded_ > 0 && !engines_.has_learnt()) {
            section_.assembly.load = load;
            watchers_.tell(&Watcher::may_continue_here);
        }
        const double still_applied = 1 - static_cast<double>(unloaded_ + increment_) / n;
        for (std::size_t g = 0; g < load.size(); ++g)
            section_.assembly.load[g] = load[g] + still_applied * released_[g];
        if (!engines_.settles_nearby({})) {
            if (increment_ > 1 && !engines_.implicit_engine().collapse()) {
                increment_ /= 2;
                continue;
            }
            engines_.settle_by_relaxation(section_.now);
        }
        unloaded_ += increment_;
        watchers_.tell(&Watcher::equilibrium_ends, still_applied);
    }
}

// The state at a moment from which another run can continue, part by part. Everything else is made from the scene, or
// found anew.
void Analysis::transfer(const Transfer& to, Checkpoint& kept)
{
    to.value(is_in_situ_, kept.is_in_situ);
    to.value(next_stage_, kept.stage);
    to.size(released_, kept.released);
    to.values(released_, kept.released);
    to.value(unloaded_, kept.unloaded);
    to.value(increment_, kept.increment);
    section_.transfer(to, kept);
    step_recorder_.transfer(to, kept);
    creep_.transfer(to, kept);
    if (dynamics_)
        dynamics_->transfer(to, kept);
}

} // namespace jointcreep::analysis
