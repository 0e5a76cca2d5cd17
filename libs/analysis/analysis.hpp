// Analysis of a section: in-situ equilibrium, excavation in stages, creep, to the scene's end.
//
// Here is the schedule of stages and steps. Equilibria are found by analysis/engines.hpp, creep steps made by
// analysis/creep_steps.hpp, dynamic analyses by analysis/dynamic_stage.hpp. Recording, checkpoints, guards
// and sensitivities are watchers (analysis/watcher.hpp).

#pragma once

#include "analysis/checkpoints.hpp"
#include "analysis/creep_steps.hpp"
#include "analysis/dynamic_stage.hpp"
#include "analysis/engines.hpp"
#include "analysis/guards.hpp"
#include "analysis/records.hpp"
#include "analysis/section.hpp"
#include "analysis/sensitivities.hpp"
#include "analysis/step_recorder.hpp"
#include "analysis/watcher.hpp"

#include <optional>
#include <vector>

namespace jointcreep::analysis
{

class Analysis
{
public:
    // Throws input_error for what the section does not allow, unstable_step among them.
    Analysis(const Scene& scene, const Network& network, const EquivalentJoints& joints, int threads,
             const Recording& recording, const Observer& observe);

    // From the in-situ state to the scene's end, by the steps numbered in the source; once. Throws equilibrium_error
    // where there is no equilibrium. result() then ends with the last one, and `failure` says what moves. (Without an
    // in-situ equilibrium its row and state are those given.)
    void run();

    // The same from a checkpoint, with the result up to there. The result is that of the run that wrote it. `kept` is
    // moved from. Throws input_error where the sizes are not those of this section.
    void go_on(Result so_far, Checkpoint kept);

    // After an observer has thrown Stopped: throws equilibrium_error, and result() has the failure, as where there is no
    // equilibrium.
    [[noreturn]] void give_up(const std::string& reason) { fail(section_, {.reason = reason}, section_.now); }

    const Result& result() const { return section_.result; }
    // Sensitivities of the histories' displacements, [parameter][time, point]: per unit of the parameter's
    // logarithm [m].
    const std::vector<std::vector<Vector2d>>& sensitivities() const { return section_.sensitivities; }
    const mechanics::Assembly& assembly() const { return section_.assembly; }
    double largest_displacement() const
    {
        return mechanics::largest_displacement(section_.assembly).first;
    } // in situ is 0 [m]
    EngineChoice engine() const { return section_.engine; }
    const Findings& findings() const { return section_.findings; }
    Findings::Counts yielded() const { return yielded_zones(section_); } // zones by rock, up to now
    bool creeps() const { return creep_.creeps(); }
    const std::optional<StableLimit>& stable_limit() const { return creep_.stable_limit(); }
    std::optional<double> end_of_creep() const { return creep_.end(); } // where the stop rate ended it [s]

private:
    void settle_in_situ();
    void follow_schedule(double after);
    void go_to(double last, double date);
    void excavate_stages_of(double date);
    void excavate(const Stage& stage);
    void complete(const Stage& stage);
    void unload();
    void transfer(const Transfer& to, Checkpoint& kept);

    Section section_;
    StepRecorder step_recorder_;
    Engines engines_;
    Guards guards_;
    Records records_;
    std::optional<Sensitivities> sensitivities_;
    Checkpoints checkpoints_;
    Watchers watchers_;
    CreepSteps creep_;
    std::optional<DynamicStage> dynamics_;
    bool is_in_situ_ = false;    // before the in-situ equilibrium
    std::size_t next_stage_ = 0; // to be excavated
    // The forces of the rock that this stage excavates, while they are unloaded: how many of the finest increments
    // are done, and how many the next one is.
    std::vector<Vector2d> released_; // [N/m]
    int unloaded_ = 0, increment_ = 0;
};

} // namespace jointcreep::analysis
