// Questions about places in doubles, and the crossing of two segments, answered without rounding error.
// Inside libs/blocks only.

#pragma once

#include <Eigen/Core>

#include <cmath>
#include <utility>

namespace jointcreep::blocks
{

// turn() when doubles cannot tell; CGAL's exact predicate.
int exact_turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c);

// +1 if a -> b -> c turns left, -1 if right, 0 if the three lie on one line; exact. The bound is Shewchuk's
// ccwerrboundA (Adaptive precision floating-point arithmetic, 1997).
inline int turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c)
{
    const double left = (a.x() - c.x()) * (b.y() - c.y()), right = (a.y() - c.y()) * (b.x() - c.x());
    const double twice_area = left - right;
    const double bound = 3.3306690738754716e-16 * (std::abs(left) + std::abs(right));
    if (twice_area > bound)
        return 1;
    if (twice_area < -bound)
        return -1;
    if (a == c || b == c || a == b)
        return 0;
    return exact_turn(a, b, c);
}

// Order of places by x, then by y.
inline bool is_before(const Eigen::Vector2d& a, const Eigen::Vector2d& b)
{
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
}

// Whether a place that lies on the line through `a` and `b` lies strictly between them.
inline bool is_between(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& place)
{
    return is_before(a, b) ? is_before(a, place) && is_before(place, b)
                           : is_before(b, place) && is_before(place, a);
}

// Where the lines through p[0], p[1] and through q[0], q[1] cross, each coordinate rounded to the nearest
// double (halfway cases to even). Computed in twice the precision of doubles with a bound of its error, and
// in rationals where the bound leaves open which double is the nearest. As rounding keeps order, crossings
// along a segment are in the order of their rounded places, and crossings at one place have one rounded
// place. The lines must not be parallel.
Eigen::Vector2d crossing(const Eigen::Vector2d& p0, const Eigen::Vector2d& p1, const Eigen::Vector2d& q0,
                         const Eigen::Vector2d& q1);

// The same in rationals alone: what crossing() falls back on.
Eigen::Vector2d rational_crossing(const Eigen::Vector2d& p0, const Eigen::Vector2d& p1,
                                  const Eigen::Vector2d& q0, const Eigen::Vector2d& q1);

} // namespace jointcreep::blocks
