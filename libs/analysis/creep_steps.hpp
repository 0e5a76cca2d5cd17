// Creep of joints and rock, and the loading of the outline over time, step by step.

#pragma once

#include "analysis/dynamic_stage.hpp"
#include "analysis/engines.hpp"
#include "analysis/section.hpp"
#include "analysis/watcher.hpp"
#include "creep/step_length.hpp"
#include "joint/closing.hpp"
#include "mechanics/creep.hpp"
#include "model/error.hpp"

#include <optional>
#include <string>

namespace jointcreep::analysis
{

// A fixed creep step is not below the published scheme's limit, which depends on the joints' constants.
struct unstable_step : input_error {
    using input_error::input_error;
};

// The longest stable creep step, and the joint or rock that limits it, by name.
struct StableLimit {
    double step; // [s]
    std::string of;
};

class CreepSteps
{
public:
    // Every `state_every` creep steps a state is due; 0: at dates only. Throws unstable_step.
    CreepSteps(Section& section, Engines& engines, const Watchers& watchers, std::uint64_t state_every);

    // To be called after the in-situ equilibrium: creep under the in-situ stress has long ended. At large displacements
    // `dynamics` makes the steps.
    void begin(DynamicStage* dynamics);

    // Steps to a date from the last one [s], or from now between them. If it `may_stop` creep ends where the scene's
    // stop rate is reached.
    void go_to(double last, double date, bool may_stop);

    // To be called after a sudden change of loads: what earlier steps showed no longer holds.
    void start_afresh();

    // What a checkpoint keeps of it.
    void transfer(const Transfer& to, Checkpoint& kept);

    bool creeps() const { return length_.has_value(); }
    // The limit of the published scheme.
    const std::optional<StableLimit>& stable_limit() const { return stable_limit_; }
    // Where the stop rate ended it, since start [s].
    std::optional<double> end() const { return end_; }

private:
    void forget_now_and_then();
    double next_target(double date, double longest) const;
    bool reaches(double target, bool may_stop);
    bool step_to(double target, int& cuts_left);
    bool step_by_dynamics(double target);
    void end_step(const Step& step, const std::vector<Vector2d>& displacement_before);
    Step settle(double target, const mechanics::State& start, int& cuts_left);
    bool settles_at(double end, bool by_relaxation, const mechanics::State& start);
    std::vector<Vector2d> guess(double duration) const;
    bool is_slower_than(double rate) const;

    Section& section_;
    Engines& engines_;
    const Watchers& watchers_;
    DynamicStage* dynamics_ = nullptr; // with large displacements
    std::uint64_t state_every_;
    std::optional<StableLimit> stable_limit_;
    std::optional<mechanics::Creep> creep_;
    std::optional<creep::StepLength> length_;
    std::optional<joint::Closing> closing_;
    std::vector<Vector2d> last_move_; // of gridpoints in the last step [m]; none after a sudden change
    double last_duration_ = 0;        // of the last step [s]
    std::uint64_t steps_ = 0;         // of creep, whole ones
    Index steps_since_forgetting_ = 0;
    std::optional<double> end_;
};

} // namespace jointcreep::analysis
