// What checks ask of polygons and lines.

#pragma once

#include "model/polygon.hpp"

#include <string>

namespace jointcreep::keys
{

// What is wrong with a polygon, in words, or "": it wants three corners at least, none twice, and sides that
// meet only at their common corners.
std::string polygon_fault(const Polygon& polygon);

// Diagonal of the bounding box [m].
double polygon_size(const Polygon& polygon);

// Points and lines this near a section's outline are on it [m].
double outline_tolerance(const Polygon& outline);

// Whether a point lies inside a simple polygon, or within `tolerance` [m] of its sides.
bool covers(const Polygon& polygon, const Eigen::Vector2d& point, double tolerance);

// Whether sides of two polygons cross, or come within `tolerance` [m] of each other.
bool sides_come_near(const Polygon& a, const Polygon& b, double tolerance);

// Length [m] of the line from `from` to `to` that runs along sides of the polygon, within `tolerance` [m].
double length_on_sides(const Polygon& polygon, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                       double tolerance);

// Length [m] that the line `c` to `d` has in common with the line `a` to `b`, 0 unless `c` and `d` are within
// `tolerance` [m] of the first line's straight extension.
double common_length(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                     const Eigen::Vector2d& d, double tolerance);

} // namespace jointcreep::keys
