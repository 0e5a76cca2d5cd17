// Extends joints that end inside a block to the next line. Inside libs/blocks only.

#pragma once

#include "blocks/segment_grid.hpp"

#include <functional>
#include <vector>

namespace jointcreep::blocks
{

// Length of the extension at each end; 0 where it meets a line there [m].
struct Extension {
    double before, beyond;
};

// For every line from number `first` on: the extension of each end, in the line's own direction, that crosses the
// next line by `reach`. Lines are as drawn: by `reach` longer at both ends than their joint. An end is free if no
// line crosses it within `reach` of the joint's end. An end outside the section (is_in_section false), or with
// nothing ahead, is not extended.
std::vector<Extension> extensions_to_next(const std::vector<Segment>& lines, std::size_t first, double reach,
                                          const std::function<bool(const Eigen::Vector2d&)>& is_in_section);

} // namespace jointcreep::blocks
