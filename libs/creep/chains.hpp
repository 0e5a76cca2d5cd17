// The chains of one kind of force, and their weights in a step (creep/scheme.hpp).

#pragma once

#include "creep/scheme.hpp"
#include "model/network.hpp"

#include <limits>
#include <string>
#include <vector>

namespace jointcreep::creep
{

// Whether a chain creeps: a smooth joint has no shear traction that could.
bool creeps(const Chain& chain);

// Where a chain is among others, as a new one if it is not there; -1 if it does not creep.
Index number_of(const Chain& chain, std::vector<Chain>& chains);

// The largest relaxation_rate [1/s]; 0 without chains.
double fastest_rate(const std::vector<Chain>& chains);

std::vector<StepWeights> steps_of(const std::vector<Chain>& chains, CreepScheme scheme, double duration);

// The longest stable step of the published scheme [s] and what sets it, in words; infinite if nothing does.
struct StepLimit {
    double step = std::numeric_limits<double>::infinity();
    std::string set_by{};
};
// Lowers the limit to that of a chain, if it is lower; `words()` are those of what the chain belongs to.
template <class Words>
void lower(StepLimit& limit, const Chain& chain, const Words& words)
{
    if (!creeps(chain) || is_stable(chain, limit.step))
        return;
    if (const double step = longest_stable_step(chain); step < limit.step)
        limit = {step, words()};
}

// Chains, their weights in a step, and what both change by to first order.
struct StepChanges {
    std::vector<Chain> chain_change;
    std::vector<StepWeights> step, step_change;
};
// For a duration [s] that changes by `duration_change` [s].
StepChanges step_changes(const std::vector<Chain>& chains, std::vector<Chain> chain_change,
                         CreepScheme scheme, double duration, double duration_change);

// A unit at the start of a step: its displacement d_0 or strain, and the force F_0 on it.
template <class Value>
struct AtStart {
    Value d, F;
};

// Change of a d_0 + c_0 F_0 by the product rule: weights times changed values, plus changed weights times values.
template <class Value>
Value change_by_start(const StepWeights::OfUnit& one, const AtStart<Value>& of_one,
                      const StepWeights::OfUnit& other, const AtStart<Value>& of_other)
{
    return one.decay * of_one.d + other.decay * of_other.d + one.first * of_one.F + other.first * of_other.F;
}

} // namespace jointcreep::creep
