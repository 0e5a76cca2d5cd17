// Places, lines and polygons of a section.

#pragma once

#include <Eigen/Core>

#include <vector>

namespace jointcreep
{

using Polygon = std::vector<Eigen::Vector2d>; // corners in order, either way round, not closed [m]

// A stretch of a line, by distance from the line's point, or of an axis through the origin [m].
struct Interval {
    double low, high;
};

struct Line {
    Eigen::Vector2d point, direction; // [m], unit vector [-]
    Eigen::Vector2d at(double distance) const { return point + distance * direction; }
};

inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b)
{
    return a.x() * b.y() - a.y() * b.x();
}

// The extent of a polygon along a unit vector.
Interval extent(const Polygon& polygon, const Eigen::Vector2d& direction);

// The stretches of a line inside a polygon. A corner on the line counts as left of it, so that crossings pair
// up.
std::vector<Interval> inside(const Polygon& polygon, const Line& line);

// Whether a place is inside a polygon; on its sides either may be said.
bool covers(const Polygon& polygon, const Eigen::Vector2d& place);

// Distance of a place from the nearest side [m].
double distance_to_sides(const Polygon& polygon, const Eigen::Vector2d& place);

// About a corner of its own, whichever way round the polygon runs; or positive if counter-clockwise [m2].
double area_of(const Polygon& polygon);
double signed_area_of(const Polygon& polygon);

double perimeter_of(const Polygon& polygon); // [m]

} // namespace jointcreep
