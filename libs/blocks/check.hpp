// Checks of the finished blocks. Inside libs/blocks only.

#pragma once

#include "blocks/graph.hpp"

namespace jointcreep::blocks
{

// Throws input_error unless the faces are blocks of a section. Edges meet at common ends only (exactly). Every edge
// has another face on each side, and at most one side without. Every face has an area, an outer ring that runs
// counter-clockwise, and no ring that visits a vertex twice. Euler's formula holds with the section's holes. The
// areas add up to the section's [m2] to a relative 1e-9. So no block is inverted, double or over another one.
void check_faces(const Graph& graph, const Faces& faces, double section_area, std::size_t section_holes);

} // namespace jointcreep::blocks
