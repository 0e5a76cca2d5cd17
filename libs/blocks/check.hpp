// The last look at blocks before they leave. Inside libs/blocks only.

#pragma once

#include "blocks/graph.hpp"

namespace jointcreep::blocks
{

// Throws input_error unless the faces are blocks of a section: edges meet at common ends only (exactly),
// every edge has another face on each side and at most one none, every face has an area, an outer ring that
// runs counter-clockwise and no ring that visits a vertex twice, Euler's formula holds with the section's
// holes, and the areas add up to the section's [m2] to a relative 1e-9. What meets all of it holds no
// inverted, overlapping or double block.
void check_faces(const Graph& graph, const Faces& faces, double section_area, std::size_t section_holes);

} // namespace jointcreep::blocks
