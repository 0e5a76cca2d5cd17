// Records points and gauges between steps of dynamic relaxation: every so many steps, counted over all
// equilibria.

#pragma once

#include "analysis/section.hpp"

namespace jointcreep::analysis
{

class StepRecorder
{
public:
    StepRecorder(Section& section, std::uint64_t every) : section_(section), every_(every) {}

    bool is_wanted() const { return every_ > 0; }

    // Dynamic relaxation for an equilibrium at `time` since start [s]; each step with the solver's time since
    // then [s].
    void begin(double time)
    {
        time_ = time;
        since_begin_ = 0;
    }
    void step(double since_begin)
    {
        since_begin_ = since_begin;
        if (++steps_ % every_ == 0)
            section_.recorder.record_step(section_.result, time_, solver_time_ + since_begin,
                                          section_.assembly);
    }
    void end() { solver_time_ += since_begin_; }
    void pass(Tape& tape) { tape(steps_); } // in the middle of it

    // What a checkpoint keeps. Steps count from the last recorded one.
    void transfer(const Transfer& to, Checkpoint& kept)
    {
        to.value(solver_time_, kept.solver_time);
        if (is_wanted())
            steps_ %= every_;
        to.value(steps_, kept.steps_since_record);
    }

private:
    Section& section_;
    std::uint64_t every_;
    std::uint64_t steps_ = 0;           // over all equilibria
    double solver_time_ = 0;            // over all equilibria that have been found [s]
    double time_ = 0, since_begin_ = 0; // of the present one [s]
};

} // namespace jointcreep::analysis
