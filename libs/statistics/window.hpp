// The part of the section in which a set is looked at: inside the outline, and inside the set's region if it
// has one.

#pragma once

#include "model/polygon.hpp"

#include <Eigen/Core>

#include <vector>

namespace jointcreep::statistics
{

struct Circle {
    Eigen::Vector2d centre;
    double radius; // [m]
};

class Window
{
public:
    explicit Window(const Polygon& outline) : polygons_{outline} {}
    Window(const Polygon& outline, const Polygon& region) : polygons_{outline, region} {}

    // The stretches of a line inside, by distance from its point, in order [m].
    std::vector<Interval> stretches(const Line& line) const;

    // Extent of its corners in a direction [m].
    Interval extent(const Eigen::Vector2d& direction) const;

    double area() const; // [m2]
    bool contains(const Eigen::Vector2d& place) const;

    // Mean number of stretches that lines of this direction leave inside, per line and metre across them:
    // half the length of the boundary as seen along them (Crofton); the width of a convex window [m].
    double stretches_per_density(const Eigen::Vector2d& direction) const;

    // The largest circle inside, or nearly so.
    Circle circle() const;

private:
    std::vector<Polygon> polygons_;
};

} // namespace jointcreep::statistics
