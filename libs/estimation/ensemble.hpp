// Inversion by an ensemble: parameters with a prior, by a model without derivatives (ensemble Kalman smoother, iterated).
//
// The prior is independent normal, mean m_0 and covariance P_0. Minimised is |r(x)|^2 + (x - m_0)^T P_0^-1 (x - m_0), r the residuals
// over their deviations. In each round the model is called at members x + P^(1/2) z_j. The z_j are normal draws with the mean 0 and the
// covariance 1 exactly. By least squares over the members, r = r_0 + J (x_j - x). Then
//     P = (t J^T J + P_0^-1)^-1 ,     x <- x - P (t J^T r_0 + P_0^-1 (x - m_0)) .
// t grows from 1/4 to 1 in the first four rounds. The first derivatives are inaccurate, because they are means over the wide
// prior. A small t shortens these steps. Raanes, Stordal and Evensen, Nonlinear Processes in Geophysics 26 (2019), with the
// tempering of Emerick and Reynolds, Computers & Geosciences 55 (2013). For a linear model mean and covariance are exact.
// P is the covariance by readings and prior together.

#pragma once

#include "estimation/least_squares.hpp"

#include <cstdint>

namespace jointcreep::estimation
{

struct Prior {
    VectorXd mean, deviation; // of each parameter
};

// The fewest members for so many parameters.
constexpr Eigen::Index least_members(Eigen::Index parameters)
{
    return 2 * parameters + 2;
}

struct EnsembleSearch {
    int members;
    std::uint64_t seed = 1;
    int most_rounds = 12;
};

// Residuals of the model, each over its deviation; nothing where it has no answer. And what makes them independent, with their
// derivatives.
using Residuals = std::function<std::optional<VectorXd>(const VectorXd& parameters)>;
using Independent = std::function<Evaluation(const Evaluation& raw)>;

struct Inversion {
    VectorXd mean;
    MatrixXd covariance; // of the parameters, by readings and prior
    Evaluation raw;      // residuals at the mean, and their derivatives by the last members
    VectorXd step;       // the last one
    int rounds = 0;
    bool is_converged =
        false; // what is left is within a tenth of a standard error in every direction, or 1e-5
};

// Throws input_error where members are fewer than least_members(), and where so few have an answer.
Inversion invert(const Residuals& model, const Independent& independent, const Prior& prior,
                 const EnsembleSearch& search);

} // namespace jointcreep::estimation
