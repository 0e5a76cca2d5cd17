#include "model/polygon.hpp"

#include <algorithm>
#include <cmath>

namespace jointcreep
{

using Eigen::Vector2d;

Interval extent(const Polygon& polygon, const Vector2d& direction)
{
    Interval extent{polygon[0].dot(direction), polygon[0].dot(direction)};
    for (const Vector2d& corner : polygon) {
        extent.low = std::min(extent.low, corner.dot(direction));
        extent.high = std::max(extent.high, corner.dot(direction));
    }
    return extent;
}

std::vector<Interval> inside(const Polygon& polygon, const Line& line)
{
    std::vector<double> crossings;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vector2d &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
        const double a = cross(line.direction, from - line.point), b = cross(line.direction, to - line.point);
        if ((a < 0) != (b < 0))
            crossings.push_back((from + a / (a - b) * (to - from) - line.point).dot(line.direction));
    }
    std::sort(crossings.begin(), crossings.end());
    std::vector<Interval> stretches;
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2)
        stretches.push_back({crossings[i], crossings[i + 1]});
    return stretches;
}

bool covers(const Polygon& polygon, const Vector2d& place)
{
    bool is_inside = false;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vector2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        if ((a.y() > place.y()) != (b.y() > place.y()) && (cross(b - a, place - a) > 0) == (b.y() > a.y()))
            is_inside = !is_inside;
    }
    return is_inside;
}

double distance_to_sides(const Polygon& polygon, const Vector2d& place)
{
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vector2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double along = std::clamp((place - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
        nearest = std::min(nearest, (a + along * (b - a) - place).norm());
    }
    return nearest;
}

double signed_area_of(const Polygon& polygon)
{
    double twice = 0;
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
        twice += cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
    return twice / 2;
}

double area_of(const Polygon& polygon)
{
    return std::abs(signed_area_of(polygon));
}

double perimeter_of(const Polygon& polygon)
{
    double sum = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i)
        sum += (polygon[i] - polygon[(i + 1) % polygon.size()]).norm();
    return sum;
}

} // namespace jointcreep
