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

// The bracket that zones twice as large give, and their number over that of the others. The error of the factor is
// proportional to the size of zones: what the mesh adds to it is about the difference of both.
struct MeshEstimate {
    analysis::Bracket coarse;
    double share_of_zones;
};
void add_mesh_estimate(Summary& summary, const analysis::Bracket& bracket, const MeshEstimate& estimate);
// For runs with reduced strengths: that merged blocks may be those that slide; or "".
std::string merging_warning(const Scene& scene, const Blocks& blocks);

// A warning if the mesh's share is much; else "".
std::string mesh_warning(const analysis::Bracket& bracket, const MeshEstimate& estimate);

// The warnings of a run; and as lines that end a message, each after a line break.
std::vector<std::string> warnings_of(const analysis::Trial& run);
std::string warning_lines(const analysis::Trial& run);

// Which run is shown; both forms may be "".
struct Which {
    std::string whole; // "strengths / 1.5 (factor of safety at least 1, below 2), "
    std::string brief; // "F 1.5 (1 to 2), "
};

// What a run does at the moment: "bench 2, day 200: 400 steps, unbalanced force ratio 3e-04 (expected 1e-06)". On a terminal
// "bench 2, day 200, ratio 3e-4 of 1e-6", with a shorter name of the stage where it is wider than `most` columns.
std::string what_is_done(const Which& which, const analysis::Progress& progress, bool has_days,
                         std::size_t most);

// Where a checkpoint is in the analysis: stage "A", day 3.
std::string place_of(const Checkpoint& kept, const Scene& scene);

} // namespace jointcreep::demsolve
