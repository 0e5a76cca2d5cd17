#include "keys/polygon.hpp"

#include "model/polygon.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace jointcreep::keys
{
namespace
{

using Point = Eigen::Vector2d;

// Twice the area of the triangle a b c, positive if it turns left.
double turn(const Point& a, const Point& b, const Point& c)
{
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

bool in_box(const Point& a, const Point& b, const Point& p)
{
    return std::min(a.x(), b.x()) <= p.x() && p.x() <= std::max(a.x(), b.x()) &&
           std::min(a.y(), b.y()) <= p.y() && p.y() <= std::max(a.y(), b.y());
}

int sign(double value)
{
    return (value > 0) - (value < 0);
}

// Whether the closed lines a b and c d have a point in common.
bool meet(const Point& a, const Point& b, const Point& c, const Point& d)
{
    const int c_side = sign(turn(a, b, c)), d_side = sign(turn(a, b, d));
    const int a_side = sign(turn(c, d, a)), b_side = sign(turn(c, d, b));
    if (c_side * d_side < 0 && a_side * b_side < 0)
        return true;
    return (c_side == 0 && in_box(a, b, c)) || (d_side == 0 && in_box(a, b, d)) ||
           (a_side == 0 && in_box(c, d, a)) || (b_side == 0 && in_box(c, d, b));
}

bool folds_back(const Point& a, const Point& b, const Point& c)
{
    return turn(a, b, c) == 0 && (b - a).dot(c - b) < 0;
}

std::string place(const Point& p)
{
    const auto text = [](double value) {
        std::string digits = std::to_string(value);
        digits.erase(digits.find_last_not_of('0') + 1);
        return digits.ends_with('.') ? digits + "0" : digits;
    };
    return "[" + text(p.x()) + ", " + text(p.y()) + "]";
}

std::string repeated_corner(const Polygon& polygon)
{
    if (polygon.front() == polygon.back())
        return "its last corner repeats its first; it closes by itself";
    std::vector<std::size_t> order(polygon.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto key = [&](std::size_t i) { return std::pair(polygon[i].x(), polygon[i].y()); };
    std::sort(order.begin(), order.end(), [&](auto i, auto j) { return key(i) < key(j); });
    for (std::size_t k = 1; k < order.size(); ++k)
        if (key(order[k - 1]) == key(order[k]))
            return "corner " + place(polygon[order[k]]) + " comes twice";
    return {};
}

// Sides in order of their left ends: a side can only meet those that begin before it ends.
std::string crossing_sides(const Polygon& polygon)
{
    const std::size_t n = polygon.size();
    const auto end = [&](std::size_t i) -> const Point& { return polygon[(i + 1) % n]; };
    const auto left = [&](std::size_t i) { return std::min(polygon[i].x(), end(i).x()); };
    const auto right = [&](std::size_t i) { return std::max(polygon[i].x(), end(i).x()); };
    std::vector<std::size_t> order(n);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](auto i, auto j) { return left(i) < left(j); });
    for (std::size_t k = 0; k < n; ++k)
        for (std::size_t l = k + 1; l < n && left(order[l]) <= right(order[k]); ++l) {
            const std::size_t i = order[k], j = order[l];
            const bool neighbours = (i + 1) % n == j || (j + 1) % n == i;
            const std::size_t first = (i + 1) % n == j ? i : j;
            const bool bad = neighbours ? folds_back(polygon[first], end(first), end((first + 1) % n))
                                        : meet(polygon[i], end(i), polygon[j], end(j));
            if (bad)
                return "its sides " + place(polygon[i]) + " to " + place(end(i)) + " and " +
                       place(polygon[j]) + " to " + place(end(j)) + " meet";
        }
    return {};
}

} // namespace

std::string polygon_fault(const Polygon& polygon)
{
    if (polygon.size() < 3)
        return "it has " + std::to_string(polygon.size()) + " corners";
    auto fault = repeated_corner(polygon);
    if (fault.empty())
        fault = crossing_sides(polygon);
    return fault;
}

double outline_tolerance(const Polygon& outline)
{
    constexpr double same_place = 1e-9; // of its size
    return same_place * polygon_size(outline);
}

double polygon_size(const Polygon& polygon)
{
    Point low = polygon.front(), high = polygon.front();
    for (const Point& corner : polygon) {
        low = low.cwiseMin(corner);
        high = high.cwiseMax(corner);
    }
    return (high - low).norm();
}

bool sides_come_near(const Polygon& a, const Polygon& b, double tolerance)
{
    // Where no sides cross, a corner is as near to the other polygon as anything.
    for (const Point& corner : a)
        if (distance_to_sides(b, corner) <= tolerance)
            return true;
    for (const Point& corner : b)
        if (distance_to_sides(a, corner) <= tolerance)
            return true;
    for (std::size_t i = 0; i < a.size(); ++i)
        for (std::size_t j = 0; j < b.size(); ++j)
            if (meet(a[i], a[(i + 1) % a.size()], b[j], b[(j + 1) % b.size()]))
                return true;
    return false;
}

bool covers(const Polygon& polygon, const Point& point, double tolerance)
{
    bool inside = false;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Point &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double along = std::clamp((point - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
        if ((a + along * (b - a) - point).norm() <= tolerance)
            return true;
        const bool passes = (a.y() > point.y()) != (b.y() > point.y());
        if (passes && point.x() < a.x() + (point.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
            inside = !inside;
    }
    return inside;
}

double common_length(const Point& a, const Point& b, const Point& c, const Point& d, double tolerance)
{
    const double length = (b - a).norm();
    const Point t = (b - a) / length;
    const auto off = [&](const Point& p) { return std::abs(t.x() * (p - a).y() - t.y() * (p - a).x()); };
    if (off(c) > tolerance || off(d) > tolerance)
        return 0;
    const double at_c = t.dot(c - a), at_d = t.dot(d - a);
    return std::max(0.0, std::min(length, std::max(at_c, at_d)) - std::max(0.0, std::min(at_c, at_d)));
}

double length_on_sides(const Polygon& polygon, const Point& from, const Point& to, double tolerance)
{
    double sum = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i)
        sum += common_length(from, to, polygon[i], polygon[(i + 1) % polygon.size()], tolerance);
    return sum;
}

} // namespace jointcreep::keys
