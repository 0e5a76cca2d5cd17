// A factor of safety by strength reduction: the factor F that strengths can be divided by before the rock has
// no equilibrium any more (libs/joint/strength_factor.hpp). What is found is a bracket, by whole runs.

#pragma once

#include "model/result.hpp"

#include <functional>
#include <optional>

namespace jointcreep::analysis
{

// How a run ends: every equilibrium found; rock seen to slide or fall; or the search for one given up.
enum class Ending { stands, falls, undecided };

struct Bracket {
    std::optional<double> stands;    // the largest factor that stood [-]; none if nothing stood
    std::optional<double> not_above; // the smallest one that did not; none if everything stood
    Safety trials;                   // in the order they were made
};

// Doubles or halves the factor from 1, to 64 or 1/64 at most, then halves the bracket until it is no wider
// than `width` times its lower end. What is undecided counts as not standing.
Bracket bracket_of(const std::function<Ending(double factor)>& trial, double width);

} // namespace jointcreep::analysis
