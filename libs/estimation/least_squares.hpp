// Nonlinear least squares within bounds, by Levenberg and Marquardt: the parameters that make the sum of
// squared residuals least.
//
// Each step solves (J^T J + lambda diag(J^T J)) step = -J^T r for the parameters that no bound stops. Those
// that would go beyond a bound stop there, and the others take the best step then. lambda follows Nielsen
// (1999) by the ratio of the achieved to the predicted decrease. Eigen's own (unsupported/Eigen/LevenbergMarquardt)
// knows no bounds, and no place where a model has no answer.

#pragma once

#include <Eigen/Core>

#include <functional>
#include <optional>
#include <vector>

namespace jointcreep::estimation
{

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Evaluation {
    VectorXd residual; // model less reading, each over its standard deviation [-]
    MatrixXd jacobian; // of the residuals, [reading, parameter]
};

// Nothing where the model has no answer; the search then avoids that place.
using Model = std::function<std::optional<Evaluation>(const VectorXd& parameters)>;

enum class AtBound { no, low, high };

// What a minimum may still be off: so many standard errors, or so much of a parameter.
constexpr double converged_errors = 0.1, converged_step = 1e-5;

struct Minimum {
    VectorXd parameters;
    Evaluation there;
    std::vector<AtBound> at_bound; // where the sum would decrease beyond it
    VectorXd left;                 // the step that the derivatives there still ask for
    int evaluations = 0;
    bool is_converged = false; // else it ran out of evaluations, or
    bool has_stalled = false;  // no step that was tried lessened the sum, though what is left is not small

    double sum_of_squares() const { return there.residual.squaredNorm(); }
};

// The minimum nearest to the start. Throws input_error if the model has no answer at the start. It stops
// where the next step would lessen the sum by less than `relative` of itself, or change no parameter by
// 1e-10; where a step has failed and what is left is small; or out of evaluations. Converged: what is left is
// small, at most a tenth of a standard error (by the residuals), or 1e-5. Smaller steps may fail by the
// model's roughness.
Minimum minimise(const Model& model, const VectorXd& start, const VectorXd& low, const VectorXd& high,
                 int most_evaluations = 100, double relative = 1e-9);

} // namespace jointcreep::estimation
