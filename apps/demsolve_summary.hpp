// What demsolve says of a run at its end.

#pragma once

#include "program.hpp"

#include "analysis/safety.hpp"
#include "model/network.hpp"
#include "model/scene.hpp"

#include <string>

namespace jointcreep::demsolve
{

// What the run is of, how its equilibria were found, and what there is to warn of.
void add_run(Summary& summary, const Network& network, const Scene& scene, const analysis::Analysis& run);

// What a bracket is, and what moves at its upper end.
void add_safety(Summary& summary, const analysis::Bracket& bracket, const std::string& what_moves);

// Lines that end a message, each after a line break.
std::string warnings_of(const analysis::Findings& findings);

} // namespace jointcreep::demsolve
