// The summary of a run of demsolve.

#pragma once

#include "program.hpp"

#include "analysis/safety.hpp"
#include "model/network.hpp"
#include "model/scene.hpp"

#include <string>
#include <vector>

namespace jointcreep::demsolve
{

// The mesh, how equilibria were found, and warnings.
void add_run(Summary& summary, const Network& network, const analysis::Trial& run);

// The bracket of the factor of safety, and the blocks that move at its upper end.
void add_safety(Summary& summary, const analysis::Bracket& bracket, const std::string& what_moves);

// The warnings of a run; and as lines that end a message, each after a line break.
std::vector<std::string> warnings_of(const analysis::Trial& run);
std::string warning_lines(const analysis::Trial& run);

// Where a checkpoint is in the analysis: stage "A", day 3.
std::string place_of(const Checkpoint& kept, const Scene& scene);

} // namespace jointcreep::demsolve
