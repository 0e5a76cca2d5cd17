// A section on its way through excavation and creep: the method, from the in-situ state to the scene's end.

#pragma once

#include "creep/closing.hpp"
#include "creep/creep.hpp"
#include "creep/step_length.hpp"
#include "implicit/equilibrium.hpp"
#include "large_displacements/dynamics.hpp"
#include "mechanics/assembly.hpp"
#include "mechanics/failure.hpp"
#include "mechanics/loading.hpp"
#include "mechanics/recorder.hpp"
#include "model/checkpoint.hpp"
#include "model/error.hpp"
#include "sensitivity/sensitivity.hpp"

#include <functional>
#include <map>
#include <optional>
#include <string>

namespace jointcreep::analysis
{

// What is to be recorded besides histories and the states at dates; 0 is never.
struct Recording {
    std::uint64_t state_every = 0;        // creep steps
    std::uint64_t step_history_every = 0; // solver steps
    // Whose sensitivities are found along with the histories: by the implicit engine alone.
    std::vector<sensitivity::Parameter> parameters{};
    // Told before every stage what it begins with, and the result so far.
    std::function<void(const Result&, const Checkpoint&)> keep{};
};

// A fixed creep step is not below the published scheme's limit, which goes with the joints' constants.
struct unstable_step : input_error {
    using input_error::input_error;
};

// The longest stable creep step, and what sets it: a joint or rock, by name.
struct StableLimit {
    double step; // [s]
    std::string of;
};

// Told how far an analysis is, from 0 to 1, and what is being done.
using Observer = std::function<void(double fraction, const std::string& what)>;

// A section on its way through excavation and creep.
class Analysis
{
public:
    Analysis(const Scene& scene, const Network& network, const EquivalentJoints& joints, int threads,
             const Recording& recording, const Observer& observe);

    // From the in-situ state to the scene's end, by the steps numbered below; once. Throws equilibrium_error
    // where there is no equilibrium: result() then goes up to the last one, and says in `failure` what moves.
    // (If it is the in-situ one that is missing, its row and state are those given.)
    void run();

    // The same from a checkpoint on, with the result up to there: as if the run that was kept had gone on.
    // What was kept is moved from. Throws input_error where the sizes are not those of this section.
    void go_on(Result so_far, Checkpoint kept);

    const Result& result() const { return result_; }
    // Of the histories' displacements, [parameter][time, point]: per unit of the parameter's logarithm [m].
    const std::vector<std::vector<mechanics::Vector2d>>& sensitivities() const { return sensitivities_; }
    const mechanics::Assembly& rock() const { return rock_; }
    EngineChoice engine() const { return engine_; }
    bool creeps() const { return step_.has_value(); }
    const std::optional<StableLimit>& stable_limit() const
    {
        return stable_limit_;
    }                                                                    // of the published scheme
    std::optional<double> end_of_creep() const { return end_of_creep_; } // where the stop rate ended it [s]
    const std::map<std::string, Index>& beyond_strength() const { return beyond_strength_; }
    // Zones by rock: where it had yielded in situ, and where it has since.
    const std::map<std::string, Index>& yielded_in_situ() const { return yielded_in_situ_; }
    std::map<std::string, Index> yielded() const;
    const std::map<std::string, Index>& given_up() const { return given_up_; }
    // By how many percent of its largest part the account of energy is off, by stages where it does not
    // close.
    const std::map<std::string, Index>& energy_off() const { return energy_off_; }

private:
    void prepare_creep();
    void follow_schedule(bool is_at_stage);
    void transfer(const Transfer& to, Checkpoint& kept);
    void settle_in_situ();
    void creep_until(double date, bool may_stop);
    void rest_until(double date);
    bool step_to(double target, bool is_loaded);
    bool is_slower_than(double rate) const;
    void excavate(const Stage& stage, Index number);
    void prepare_dynamics();
    void start_dynamics();
    bool follow_dynamics(double until);
    void move(const Stage& stage);
    [[noreturn]] void give_up_dynamics(const mechanics::no_equilibrium& error);
    void record_dynamics();
    void check_energy();
    bool settles_nearby(const std::vector<mechanics::Vector2d>& guess, double time);
    void settle_by_relaxation(double time,
                              const std::string& reason = {}); // without one the implicit engine's
    void yield_by_relaxation(double time, Index zone);
    void check_held();
    [[noreturn]] void fail(Failure failure, double time);
    void record_equilibrium();
    void record(const std::string& event, bool with_state);
    void start_afresh();

    const Scene& scene_;
    const Network& network_;
    const EquivalentJoints& joints_;
    const Recording& recording_;
    Observer observe_;
    EngineChoice engine_;
    Result result_;
    mechanics::Assembly rock_;
    mechanics::Loading loading_;
    mechanics::Recorder recorder_;
    implicit::Solver implicit_;
    std::optional<large_displacements::Dynamics> dynamics_;
    std::optional<creep::Creep> creep_;
    std::optional<creep::StepLength> step_;
    std::optional<creep::Closing> closing_;
    std::optional<sensitivity::Sensitivity> sensitivity_;
    std::vector<std::vector<mechanics::Vector2d>> sensitivities_;

    double now_ = 0;         // since start [s]
    Index next_stage_ = 0;   // to be excavated
    std::string stage_;      // being excavated, or ""
    double solver_time_ = 0; // of dynamic relaxation, over all equilibria [s]
    std::uint64_t solver_steps_ = 0, creep_steps_ = 0;
    mechanics::Convergence convergence_;         // of the last equilibrium
    mechanics::Effort effort_;                   // since the last one that was recorded
    std::vector<mechanics::Vector2d> last_move_; // in the last creep step [m]; none after a sudden change
    int cuts_left_ = 0;                          // of this creep step
    double last_step_ = 0;                       // [s]
    std::optional<StableLimit> stable_limit_;
    std::optional<double> end_of_creep_;           // [s]
    std::map<std::string, Index> beyond_strength_; // contacts by joint: what the in-situ stress breaks
    std::map<std::string, Index> yielded_in_situ_;
    std::map<std::string, Index> given_up_;   // equilibria by the implicit engine's reason
    std::map<std::string, Index> energy_off_; // by stage [percent]
    double largest_error_ = 0;  // of this dynamic analysis's energy balance, at recorded moments [J/m]
    double largest_energy_ = 0; // of its parts
};

} // namespace jointcreep::analysis
