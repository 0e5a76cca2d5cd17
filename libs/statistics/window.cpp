#include "statistics/window.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace jointcreep::statistics
{

using Eigen::Vector2d;

namespace
{

std::vector<Interval> common(const std::vector<Interval>& a, const std::vector<Interval>& b)
{
    std::vector<Interval> both;
    for (const Interval& x : a)
        for (const Interval& y : b)
            if (const Interval part{std::max(x.low, y.low), std::min(x.high, y.high)}; part.low < part.high)
                both.push_back(part);
    return both;
}

double distance_to_side(const Vector2d& place, const Vector2d& from, const Vector2d& to)
{
    const Vector2d side = to - from;
    const double along = std::clamp((place - from).dot(side) / side.squaredNorm(), 0.0, 1.0);
    return (place - from - along * side).norm();
}

// Distance to the boundary, negative outside.
double depth(const Polygon& polygon, const Vector2d& place)
{
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < polygon.size(); ++i)
        nearest = std::min(nearest, distance_to_side(place, polygon[i], polygon[(i + 1) % polygon.size()]));
    return covers(polygon, place) ? nearest : -nearest;
}

} // namespace

std::vector<Interval> Window::stretches(const Line& line) const
{
    std::vector<Interval> stretches = inside(polygons_[0], line);
    for (std::size_t i = 1; i < polygons_.size(); ++i)
        stretches = common(stretches, inside(polygons_[i], line));
    return stretches;
}

Interval Window::extent(const Vector2d& direction) const
{
    Interval extent{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    for (const Polygon& polygon : polygons_) {
        const Interval of_polygon = jointcreep::extent(polygon, direction);
        extent = {std::max(extent.low, of_polygon.low), std::min(extent.high, of_polygon.high)};
    }
    return extent;
}

// By level lines, so that it holds for two polygons too: exact between corners for one, and good to 1e-3 for
// two, where it only serves for densities.
double Window::area() const
{
    if (polygons_.size() == 1)
        return area_of(polygons_[0]);
    const Interval y = extent(Vector2d::UnitY());
    const int levels = 2000;
    double area = 0;
    for (int i = 0; i < levels; ++i)
        for (const Interval& stretch :
             stretches({{0, y.low + (i + 0.5) / levels * (y.high - y.low)}, Vector2d::UnitX()}))
            area += (stretch.high - stretch.low) * (y.high - y.low) / levels;
    return area;
}

bool Window::contains(const Vector2d& place) const
{
    return std::all_of(polygons_.begin(), polygons_.end(),
                       [&place](const Polygon& polygon) { return depth(polygon, place) > 0; });
}

double Window::stretches_per_density(const Vector2d& direction) const
{
    double seen = 0;
    const Polygon& polygon = polygons_[0];
    for (std::size_t i = 0; i < polygon.size(); ++i)
        seen += std::abs(cross(direction, polygon[(i + 1) % polygon.size()] - polygon[i]));
    return seen / 2;
}

Circle Window::circle() const
{
    const Interval x = extent(Vector2d::UnitX()), y = extent(Vector2d::UnitY());
    Vector2d centre((x.low + x.high) / 2, (y.low + y.high) / 2),
        reach = Vector2d(x.high - x.low, y.high - y.low) / 2;
    Circle best{centre, 0};
    const int cells = 8;
    for (int pass = 0; pass < 8; ++pass, reach /= 3, centre = best.centre)
        for (int i = -cells; i <= cells; ++i)
            for (int j = -cells; j <= cells; ++j) {
                const Vector2d place = centre + Vector2d(i * reach.x(), j * reach.y()) / cells;
                double radius = depth(polygons_[0], place);
                for (std::size_t p = 1; p < polygons_.size(); ++p)
                    radius = std::min(radius, depth(polygons_[p], place));
                if (radius > best.radius)
                    best = {place, radius};
            }
    return best;
}

} // namespace jointcreep::statistics
