// What demsolve says of a run at its end.

#pragma once

#include "program.hpp"

#include "analysis/safety.hpp"
#include "model/network.hpp"
#include "model/scene.hpp"

#include <string>
#include <vector>

namespace jointcreep::demsolve
{

// What the run is of, how its equilibria were found, and what there is to warn of.
void add_run(Summary& summary, const Network& network, const analysis::Trial& run);

// What a bracket is, and what moves at its upper end.
void add_safety(Summary& summary, const analysis::Bracket& bracket, const std::string& what_moves);

// What there is to warn of in a run; and as lines that end a message, each after a line break.
std::vector<std::string> warnings_of(const analysis::Trial& run);
std::string warning_lines(const analysis::Trial& run);

} // namespace jointcreep::demsolve
