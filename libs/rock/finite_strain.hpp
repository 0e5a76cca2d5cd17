// Strain and stress of a zone at large displacements: F = R U, Biot's strain U - 1 and Biot's stress in the frame that
// rotates with the zone. Stresses are {xx, yy, xy} [Pa], strains {xx, yy, 2 xy}; tension and extension positive.
// Inside libs/rock only.

#pragma once

#include "model/network.hpp"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <array>
#include <cmath>
#include <vector>

namespace jointcreep::rock
{

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// From the stiffness {C11, C12, C33} [Pa].
inline Vector3d stress_of(const Vector3d& stiffness, const Vector3d& strain)
{
    return {stiffness[0] * strain[0] + stiffness[1] * strain[1],
            stiffness[1] * strain[0] + stiffness[0] * strain[1], stiffness[2] * strain[2]};
}

inline Matrix2d tensor(const Vector3d& stress)
{
    return (Matrix2d() << stress[0], stress[2], stress[2], stress[1]).finished();
}

// The stretch from the shape without stress at which Cauchy's stress has the given value. In principal axes Biot's
// stress is Cauchy's times the other stretch.
inline Matrix2d stretch_for(const Vector3d& stiffness, const Vector3d& stress)
{
    const Eigen::SelfAdjointEigenSolver<Matrix2d> principal(tensor(stress));
    const Vector2d& cauchy = principal.eigenvalues();
    const Matrix2d elastic =
        (Matrix2d() << stiffness[0], stiffness[1], stiffness[1], stiffness[0]).finished();
    Vector2d stretch = Vector2d::Ones();
    for (int i = 0; i < 30; ++i)
        stretch =
            Vector2d::Ones() + elastic.inverse() * Vector2d(cauchy[0] * stretch[1], cauchy[1] * stretch[0]);
    return principal.eigenvectors() * stretch.asDiagonal() * principal.eigenvectors().transpose();
}

// F = rotation * stretch, in plain numbers: faster than matrices, which go through memory.
struct Polar {
    double cos, sin;       // of the rotation
    double xx, xy, yx, yy; // of the stretch; xy and yx differ by rounding only

    Matrix2d rotation() const { return (Matrix2d() << cos, -sin, sin, cos).finished(); }
    Matrix2d stretch() const { return (Matrix2d() << xx, xy, yx, yy).finished(); }
};

// F of a zone, from the inverse of its edges in the shape without stress.
inline Polar polar_of(const std::array<Index, 3>& g, const std::vector<Vector2d>& place,
                      const Matrix2d& inverse)
{
    const Vector2d one = place[g[1]] - place[g[0]], two = place[g[2]] - place[g[0]];
    const double xx = one.x() * inverse(0, 0) + two.x() * inverse(1, 0),
                 xy = one.x() * inverse(0, 1) + two.x() * inverse(1, 1),
                 yx = one.y() * inverse(0, 0) + two.y() * inverse(1, 0),
                 yy = one.y() * inverse(0, 1) + two.y() * inverse(1, 1);
    const double c = xx + yy, s = yx - xy, r = std::hypot(c, s), cos = c / r, sin = s / r;
    return {cos, sin, cos * xx + sin * yx, cos * xy + sin * yy, -sin * xx + cos * yx, -sin * xy + cos * yy};
}

// The part of R' P (P: first Piola-Kirchhoff stress) that does no work on the stretch U but keeps Cauchy's stress
// symmetric: the skew W with W U + U W = U T - T U. It is 0 where Biot's stress T has the axes of U, as without plastic
// strain.
inline Matrix2d skew_part(const Matrix2d& stretch, const Matrix2d& stress)
{
    const double w = (stretch * stress - stress * stretch)(1, 0) / stretch.trace();
    return (Matrix2d() << 0, -w, w, 0).finished();
}

// The edges {1 - 0, 2 - 0} of a zone [m].
inline Matrix2d edges_of(const std::array<Index, 3>& g, const std::vector<Vector2d>& place)
{
    Matrix2d edges;
    edges << place[g[1]] - place[g[0]], place[g[2]] - place[g[0]];
    return edges;
}

} // namespace jointcreep::rock
