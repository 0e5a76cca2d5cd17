// How many zones a section will have, before they are made.
//
//     expected zones = 1/share integral over the section of dA / size^2  +  sum over blocks of corners * c
//                      +  sum over thin blocks of (perimeter^2 / (4 area) - 6)
//     c = 1/2 + 5/2 (area of the block / size^2), at most 3
//
// `size` is that of [zones] at a place [m]. The triangulation aims at a longest side, and its mean zone has the area
// share * size^2. Corners of blocks ask for smaller zones around them; a block much smaller than a zone should be
// has few. A block is thin if twice its area is less than size times its perimeter; then its zones are about as long as
// it is thick. The numbers are fitted to the sections of data/: tests/zoning/cost_test.cpp holds the result to what is
// made.

#pragma once

#include "model/network.hpp"
#include "model/scene.hpp"

#include <string>

namespace jointcreep::zoning
{

inline constexpr double most_zones = 2e7; // more are refused

double expected_zones(const Scene& scene, const Blocks& blocks);

// Throws input_error where more than `most_zones` are expected. A warning with what they cost if they need more
// than some 2 GB (a million zones of constant strain), otherwise "". Both name `file`, which the scene is in.
std::string check_cost(const Scene& scene, const Blocks& blocks, const std::string& file);

} // namespace jointcreep::zoning
