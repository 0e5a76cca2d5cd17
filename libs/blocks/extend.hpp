// Carries joints that end inside a block on to the next line. Inside libs/blocks only.

#pragma once

#include "blocks/segment_grid.hpp"

#include <functional>
#include <vector>

namespace jointcreep::blocks
{

// How far a line is carried on at each end; 0 where it meets a line there [m].
struct Extension {
    double before, beyond;
};

// For every line from number `first` on: how far each end must go on, in the line's own direction, to cross
// the line that it meets next, by `reach`. Lines are as drawn, by `reach` longer than what they stand for at
// both ends; an end is free if no line crosses it within `reach` of that. An end outside the section
// (is_in_section false), or with nothing ahead, stays.
std::vector<Extension> extensions_to_next(const std::vector<Segment>& lines, std::size_t first, double reach,
                                          const std::function<bool(const Eigen::Vector2d&)>& is_in_section);

} // namespace jointcreep::blocks
