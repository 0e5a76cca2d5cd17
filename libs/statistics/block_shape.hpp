// Size and shape of blocks.
//
// Kalenchuk, Diederichs, McKinnon, Characterizing block geometry in jointed rockmasses, 2006, take chords
// between all corners of a block:
//     alpha = A_s l / (7.7 V) ,   beta = 10 (sum (a . b)^2 / sum |a|^2 |b|^2)^2 ,
// A_s surface, l mean chord, V volume, a and b all pairs of the chords not shorter than the median one. In a
// section surface is outline and volume is area, and 7.7, which makes alpha 1 for a cube, becomes 4.5523 =
// 4 (4 + 2 sqrt(2)) / 6, which makes it 1 for a square. alpha grows with flatness; beta is 10 for a needle
// and 2.5 for chords in all directions of the plane (1.1 for those in space).

#pragma once

#include "model/network.hpp"

#include <vector>

namespace jointcreep::statistics
{

// Shapes of all blocks, in order.
struct BlockShapes {
    std::vector<double> aspect; // of the ellipse of the same second moments of area, long over short axis [-]
    std::vector<double> alpha;  // [-]
    std::vector<double> beta;   // [-]
    std::vector<Index> corners; // of the outer ring, where it turns by more than 1 degree
};
BlockShapes block_shapes(const Blocks& blocks);

// The value that a share p of the total weight does not exceed; values need not be in order. Empty: 0.
double weighted_quantile(const std::vector<double>& values, const std::vector<double>& weights, double p);

} // namespace jointcreep::statistics
