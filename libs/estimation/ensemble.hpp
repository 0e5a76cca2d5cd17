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
#include <string>

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
        false;             // what is left is within a tenth of a standard error in every direction, or 1e-5
    std::string failure{}; // why the search ended without convergence before its most rounds
};

// Where fewer members than least_members() have an answer, or the mean has none, the search ends. The mean is then
// the place with the least sum of squares, prior and all, that has an answer: the prior's mean, a member or a mean.
// Throws input_error where members are fewer than least_members(), and where the prior's mean has no answer.
Inversion invert(const Residuals& model, const Independent& independent, const Prior& prior,
                 const EnsembleSearch& search);

// Of each parameter, the shift of its mean from the prior's over the deviation that this has if the prior is right: it has the variance
// P_0 - P, without the readings' noise in P_0 + C of their own estimate. Beyond 1.96 prior and readings disagree with 95 percent, and the
// mean is right for neither. With exact readings it is how far the mean is off the prior's, over the prior's deviation. For a
// linear model exact. 0 where the readings know nothing. Evans and Moshonov, Bayesian Analysis 1 (2006): checking for prior-data conflict.
VectorXd disagreement(const Inversion& found, const Prior& prior);

} // namespace jointcreep::estimation
