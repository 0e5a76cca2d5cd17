// How many zones a section will have, before they are made.
//
//     expected zones = 1/share integral over the section of dA / size^2  +  sum over blocks of corners * c
//     c = 1/2 + 5/2 (area of the block / size^2), at most 3
//
// `size` is that of [zones] at a place [m]. The triangulation aims at a longest side, and its mean zone has the area
// share * size^2. Corners of blocks ask for smaller zones around them; a block much smaller than a zone should be
// has few. The numbers are fitted to the sections of data/: tests/zoning/cost_test.cpp holds the result to what is
// made.

#pragma once

#include "model/network.hpp"
#include "model/scene.hpp"

#include <string>

namespace jointcreep::zoning
{

inline constexpr double most_zones = 2e7; // more are refused
inline constexpr double many_zones = 1e6; // more are warned of

double expected_zones(const Scene& scene, const Blocks& blocks);

// Throws input_error where more than `most_zones` are expected. A warning with what they cost if more than `many_zones`
// are, otherwise "". Both name `file`, which the scene is in.
std::string check_cost(const Scene& scene, const Blocks& blocks, const std::string& file);

} // namespace jointcreep::zoning
