// GMRES, preconditioned from the right, without restart: what it minimises is the residual itself, and that
// is what decides whether forces balance.

#pragma once

#include <Eigen/Core>

#include <cmath>
#include <vector>

namespace jointcreep::implicit
{

// Improves `x` towards product(x) = right until the residual's norm is at most `enough`, or for `most`
// iterations, each with one product and one application of the preconditioner. Returns the norm reached, by
// the recurrence.
template <class Product, class Precondition>
double gmres(const Product& product, const Precondition& precondition, const Eigen::VectorXd& right,
             double enough, int most, Eigen::VectorXd& x)
{
    using Eigen::VectorXd;
    constexpr double rounding = 1e-14; // what is left of a product beside the basis, if nothing new is in it
    VectorXd residual = x.isZero(0) ? right : VectorXd(right - product(x));
    double norm = residual.norm();
    if (!(norm > enough))
        return norm;
    std::vector<VectorXd> basis{residual / norm}, directions;
    Eigen::MatrixXd hessenberg = Eigen::MatrixXd::Zero(most + 1, most);
    VectorXd cosine(most), sine(most), reduced = VectorXd::Zero(most + 1);
    reduced[0] = norm;
    int n = 0;
    while (n < most && norm > enough) {
        directions.push_back(precondition(basis.back()));
        VectorXd next = product(directions.back());
        const double nothing = rounding * next.norm();
        auto column = hessenberg.col(n);
        for (int i = 0; i <= n; ++i) {
            column[i] = basis[i].dot(next);
            next -= column[i] * basis[i];
        }
        column[n + 1] = next.norm();
        const double beyond = column[n + 1];
        for (int i = 0; i < n; ++i) { // the rotations so far
            const double upper = cosine[i] * column[i] + sine[i] * column[i + 1];
            column[i + 1] = cosine[i] * column[i + 1] - sine[i] * column[i];
            column[i] = upper;
        }
        const double length = std::hypot(column[n], column[n + 1]);
        if (!(length > nothing) || !std::isfinite(length))
            break; // the product is singular: this direction changes nothing
        cosine[n] = column[n] / length;
        sine[n] = column[n + 1] / length;
        column[n] = length;
        column[n + 1] = 0;
        reduced[n + 1] = -sine[n] * reduced[n];
        reduced[n] *= cosine[n];
        norm = std::abs(reduced[n + 1]);
        ++n;
        if (!(beyond > nothing))
            break;
        basis.push_back(next / beyond);
    }
    if (n > 0) {
        const VectorXd weights =
            hessenberg.topLeftCorner(n, n).triangularView<Eigen::Upper>().solve(reduced.head(n));
        for (int i = 0; i < n; ++i)
            x += weights[i] * directions[i];
    }
    return norm;
}

} // namespace jointcreep::implicit
