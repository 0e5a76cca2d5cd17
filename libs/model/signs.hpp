// The one sign convention, in all code and all files:
//
//   tension +, extension +, opening +, angles counter-clockwise, x to the right, y up.
//
// An edge runs from its first vertex to its second. Its tangent points along it, its normal to its left:
//
//              side b (left)   ^ normal
//      first  -------------------------> tangent   second
//              side a (right)
//
// The displacement of a joint is that of side b minus that of side a:
//   u_n = normal . (u_b - u_a)    > 0 opening       u_s = tangent . (u_b - u_a)
// and its traction is the one that side b exerts on side a, which is what pulls u_n and u_s back:
//   sigma_n > 0 tension,  |tau| <= c - sigma_n tan(phi).
// Scene keys that speak of compression say so in their name.

#pragma once

#include <Eigen/Core>

namespace jointcreep
{

// Unit vector along the edge from `first` to `second`; the two must differ.
inline Eigen::Vector2d tangent_of(const Eigen::Vector2d& first, const Eigen::Vector2d& second)
{
    return (second - first).normalized();
}

// The tangent turned a quarter counter-clockwise: from side a to side b.
inline Eigen::Vector2d normal_of(const Eigen::Vector2d& tangent)
{
    return {-tangent.y(), tangent.x()};
}

// The other way round: the tangent of an edge with this normal.
inline Eigen::Vector2d along(const Eigen::Vector2d& normal)
{
    return {normal.y(), -normal.x()};
}

} // namespace jointcreep
