// What a network is like, beside what its scene asked for: the report of a run.
//
// Rows of each joint set (set_statistics.hpp), of the blocks' sizes and shapes (block_shape.hpp) and of the
// nodes (nodes.hpp). Where a law or a density is the target there are a confidence interval and a p-value,
// from formulas that know nothing of how the network was made but its laws. What a p-value is worth is said
// by judge() in rows.hpp.

#pragma once

#include "model/network.hpp"
#include "model/scene.hpp"

#include <string>

namespace jointcreep::statistics
{

// Without blocks there are no rows of them.
Statistics statistics_of(const Scene& scene, const Network& network);

// The statistics as a text table, angles in degrees, with a last line for the verdict.
std::string table(const Statistics& statistics);

// What the statistics leave out, in a line; empty if there is nothing.
std::string left_out(const Scene& scene);

} // namespace jointcreep::statistics
