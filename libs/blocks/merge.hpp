// Keeps edges and angles above stated limits: vertices that lie close together become one, and edges that
// pass close by a vertex go through it. Inside libs/blocks only.

#pragma once

#include "blocks/graph.hpp"

namespace jointcreep::blocks
{

struct MergeLimits {
    // Vertices closer than this to each other, or than half of it to an edge, merge [m].
    double shortest_edge;
    // Wedges narrower than this are closed if that moves no vertex by more than `farthest_closing` shortest edges
    // [rad].
    double smallest_angle;
    static constexpr double farthest_closing = 5; // [-]
};

// One pass of merging over a planar graph. Vertices move in this order: a vertex between joints moves to
// a stage outline or rock border, and both move to the section's outline; corners of the outlines never move,
// and vertices on a side of the outline stay on it. The result may cross itself where much moved: arrange()
// it again, and repeat until a pass changes nothing (returns false).
bool merge_pass(Graph& graph, Sources& sources, const std::vector<Polygon>& outlines,
                const MergeLimits& limits, CuttingReport& report);

} // namespace jointcreep::blocks
