#include "blocks/predicates.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>

#include <cstdint>
#include <cstring>
#include <limits>

namespace jointcreep::blocks
{

namespace
{

using Eigen::Vector2d;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel; // predicates only
using Rational = CGAL::Exact_rational;

// The sum of two doubles, the second at most half a unit of the last place of the first: about 106 bits (T.
// J. Dekker, A floating-point technique for extending the available precision, 1971).
struct Double2 {
    double high, low;
};

Double2 two_sum(double a, double b) // exact
{
    const double s = a + b, t = s - a;
    return {s, (a - (s - t)) + (b - t)};
}

Double2 quick_two_sum(double a, double b) // exact if |a| >= |b|
{
    const double s = a + b;
    return {s, b - (s - a)};
}

Double2 two_product(double a, double b) // exact but for underflow
{
    const auto halves = [](double x) {
        const double c = 134217729.0 * x, high = c - (c - x); // 2^27 + 1
        return std::pair(high, x - high);
    };
    const auto [ah, al] = halves(a);
    const auto [bh, bl] = halves(b);
    const double p = a * b;
    return {p, ((ah * bh - p) + ah * bl + al * bh) + al * bl};
}

Double2 operator+(const Double2& a, const Double2& b)
{
    Double2 s = two_sum(a.high, b.high);
    const Double2 t = two_sum(a.low, b.low);
    s = quick_two_sum(s.high, s.low + t.high);
    return quick_two_sum(s.high, s.low + t.low);
}

Double2 operator-(const Double2& a)
{
    return {-a.high, -a.low};
}

Double2 operator*(const Double2& a, const Double2& b)
{
    const Double2 p = two_product(a.high, b.high);
    return quick_two_sum(p.high, p.low + (a.high * b.low + a.low * b.high));
}

Double2 operator/(const Double2& a, const Double2& b)
{
    const double first = a.high / b.high;
    const Double2 rest = a + -(b * Double2{first, 0});
    const double second = rest.high / b.high;
    const Double2 last = rest + -(b * Double2{second, 0});
    return quick_two_sum(first, second) + Double2{last.high / b.high, 0};
}

double size(const Double2& a)
{
    return std::abs(a.high);
}

// More than the relative error of any of the operations above.
constexpr double unit_error = 0x1p-98;

// Whether every number within `error` of `a` has a.high as its nearest double.
bool is_nearest_for_all(const Double2& a, double error)
{
    const double reach = error + 0x1p-50 * std::abs(a.low); // of the sums below
    return a.high + (a.low + reach) == a.high && a.high + (a.low - reach) == a.high;
}

double nearest_double(const Rational& value)
{
    auto [low, high] = CGAL::to_interval(value);
    constexpr double infinity = std::numeric_limits<double>::infinity();
    // Neighbours, should the interval be wider.
    while (low < high && Rational(std::nextafter(low, infinity)) <= value)
        low = std::nextafter(low, infinity);
    while (low < high && Rational(std::nextafter(high, -infinity)) >= value)
        high = std::nextafter(high, -infinity);
    if (low == high)
        return low;
    const Rational above_low = value - Rational(low), below_high = Rational(high) - value;
    if (above_low != below_high)
        return above_low < below_high ? low : high;
    std::uint64_t bits = 0;
    std::memcpy(&bits, &low, sizeof bits);
    return bits % 2 == 0 ? low : high;
}

} // namespace

int exact_turn(const Vector2d& a, const Vector2d& b, const Vector2d& c)
{
    const auto point = [](const Vector2d& v) { return Kernel::Point_2(v.x(), v.y()); };
    return static_cast<int>(CGAL::orientation(point(a), point(b), point(c)));
}

Vector2d rational_crossing(const Vector2d& p0, const Vector2d& p1, const Vector2d& q0, const Vector2d& q1)
{
    const auto difference = [](double a, double b) -> Rational { return Rational(a) - Rational(b); };
    const Rational px = difference(p1.x(), p0.x()), py = difference(p1.y(), p0.y());
    const Rational qx = difference(q1.x(), q0.x()), qy = difference(q1.y(), q0.y());
    const Rational t =
        (difference(q0.x(), p0.x()) * qy - difference(q0.y(), p0.y()) * qx) / (px * qy - py * qx);
    return {nearest_double(Rational(p0.x()) + t * px), nearest_double(Rational(p0.y()) + t * py)};
}

Vector2d crossing(const Vector2d& p0, const Vector2d& p1, const Vector2d& q0, const Vector2d& q1)
{
    const Double2 px = two_sum(p1.x(), -p0.x()), py = two_sum(p1.y(), -p0.y());
    const Double2 qx = two_sum(q1.x(), -q0.x()), qy = two_sum(q1.y(), -q0.y());
    const Double2 ox = two_sum(q0.x(), -p0.x()), oy = two_sum(q0.y(), -p0.y());
    const Double2 a = ox * qy, b = oy * qx, c = px * qy, d = py * qx;
    const Double2 above = a + -b, below = c + -d;
    const Double2 t = above / below;
    // Relative: of differences of products, whose terms may cancel, and of the quotient.
    const double error_of_t =
        unit_error * (1 + 2 * (size(a) + size(b)) / size(above) + 2 * (size(c) + size(d)) / size(below));
    const auto along = [&](double from, const Double2& step, double& place) {
        const Double2 offset = t * step;
        const Double2 sum = Double2{from, 0} + offset;
        place = sum.high;
        return is_nearest_for_all(sum,
                                  2 * size(offset) * (error_of_t + unit_error) + unit_error * std::abs(from));
    };
    Vector2d place;
    if (along(p0.x(), px, place.x()) && along(p0.y(), py, place.y()))
        return place;
    return rational_crossing(p0, p1, q0, q1);
}

} // namespace jointcreep::blocks
