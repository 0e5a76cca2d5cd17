// Convex parts of a polygon, for formats whose blocks must be convex or have no holes. Inside libs/exchange only.

#pragma once

#include "exchange/layers.hpp"

namespace jointcreep::exchange
{

// The parts of a polygon of a layer, counter-clockwise, by indices of its points: the polygon itself where it is
// convex. Ears are cut off it, its holes joined in, and triangles put together again while they stay convex (Hertel
// and Mehlhorn 1983: at most four times as many parts as needed). Corners on a straight side stay. Throws
// input_error that names the block where the parts do not add up to its area.
std::vector<std::vector<Index>> convex_parts(const Layer& layer, std::size_t row);

// The corners around a polygon, its holes joined in by bridges between corners, there and back, that cross
// neither it nor another hole.
std::vector<Index> with_bridges(const Layer& layer, std::size_t row);

} // namespace jointcreep::exchange
