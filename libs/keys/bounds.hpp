// What keys and the command line share: how far times and places may be, and the words of a choice. The
// bounds are far above any rock: they catch slips of unit, and keep all products finite.

#pragma once

#include "model/quantity.hpp"

#include <string_view>
#include <utility>
#include <vector>

namespace jointcreep::keys
{

constexpr double farthest_day = 1e6, farthest_metre = 1e6; // from the start, from the origin

inline constexpr Range coordinates = within(farthest_metre);  // [m]
inline constexpr Range lengths = above(0).to(farthest_metre); // [m]
inline constexpr Range stresses = within(1e4);                // [MPa]

// The words of a choice, each with what it stands for.
template <class Value>
using Words = std::vector<std::pair<std::string_view, Value>>;

} // namespace jointcreep::keys
