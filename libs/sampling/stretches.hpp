// Where lines run inside the section and where a set exists. Inside libs/sampling only.

#pragma once

#include "model/polygon.hpp"
#include "model/scene.hpp"

#include <vector>

namespace jointcreep::sampling
{

// Length by which joints go past their end: 1e-6 of the polygon's size [m].
double overshoot_of(const Polygon& polygon);

// The stretches of a line in a set's region or rocks, each with its overshoot; in the section, if it has
// neither, without.
std::vector<Interval> where_set_exists(const JointSet& set, const Scene& scene, const Line& line);

// A polygon that holds all of where the set exists: its region, or the section's outline.
const Polygon& bounds_of(const JointSet& set, const Scene& scene);

// What stretches in order have in common with another.
std::vector<Interval> overlap(const std::vector<Interval>& stretches, const Interval& with);

// Stretches as the line's other direction counts.
std::vector<Interval> turned_round(const std::vector<Interval>& stretches);

} // namespace jointcreep::sampling
