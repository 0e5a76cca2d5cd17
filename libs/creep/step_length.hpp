// How long creep steps are: fixed by the scene, or chosen by the estimated error of each.

#pragma once

#include "creep/scheme.hpp"
#include "model/checkpoint.hpp"

namespace jointcreep::creep
{

class StepLength
{
public:
    // `fastest_rate` of relaxation [1/s] and the `longest_stable` step [s], infinite if there is none.
    StepLength(const CreepSettings& settings, double fastest_rate, double longest_stable);

    // The step to try next, no longer than `remaining` [s] (to the next date) and `longest` [s]. Steps of a fixed
    // length up to a date are equal, none longer than the scene's.
    double next(double remaining, double longest) const;

    // Whether a step with this estimate of its error [m] is accepted. The next length follows from the error in
    // both cases. Steps of a fixed length are always accepted, and so is one of the shortest length.
    bool stands(double step, double error);

    // To be called after a sudden change of loads, or a change of contacts: begins with the first step again.
    void start_afresh();

    void transfer(const Transfer& to, Checkpoint& kept) { to.value(wanted_, kept.creep_step); }

    // The error that a re-closing contact may be left with [m] (joint/closing.hpp).
    double closing_tolerance() const;

private:
    CreepSettings settings_;
    double first_, shortest_, longest_; // [s]
    double order_;                      // of the local error in the step
    double wanted_;                     // [s]
};

} // namespace jointcreep::creep
