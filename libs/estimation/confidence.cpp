#include "estimation/confidence.hpp"

#include "model/error.hpp"
#include "statistics/distribution.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace jointcreep::estimation
{

namespace
{

constexpr double significance = 0.05; // of each or of all intervals together

std::vector<Eigen::Index> free_of(const std::vector<bool>& is_fixed)
{
    std::vector<Eigen::Index> free;
    for (std::size_t i = 0; i < is_fixed.size(); ++i)
        if (!is_fixed[i])
            free.push_back(static_cast<Eigen::Index>(i));
    return free;
}

std::vector<bool> without_effect(const MatrixXd& J)
{
    std::vector<bool> found;
    for (const auto& column : J.colwise())
        found.push_back(column.norm() == 0);
    return found;
}

// J^T J of some columns, divided by their lengths so that inverting loses few digits.
struct Parts {
    VectorXd length, values;
    MatrixXd vectors;
};

Parts parts_of(const MatrixXd& J, const std::vector<Eigen::Index>& of)
{
    const MatrixXd columns = J(Eigen::all, of);
    const VectorXd length = columns.colwise().norm();
    const MatrixXd scaled = columns * length.cwiseInverse().asDiagonal();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> parts(scaled.transpose() * scaled);
    return {length, parts.eigenvalues(), parts.eigenvectors()};
}

MatrixXd inverse_of(const Parts& parts)
{
    const MatrixXd inverse =
        parts.vectors * parts.values.cwiseMax(1e-15).cwiseInverse().asDiagonal() * parts.vectors.transpose();
    return parts.length.cwiseInverse().asDiagonal() * inverse * parts.length.cwiseInverse().asDiagonal();
}

} // namespace

double Confidence::standard_error(Eigen::Index i) const
{
    return std::sqrt(covariance(i, i));
}

double Confidence::standard_error(const VectorXd& gradient) const
{
    return std::sqrt(std::max(0.0, gradient.dot(covariance * gradient)));
}

double Confidence::quantile_of_all(Eigen::Index intervals) const
{
    const double degrees =
        is_noise_from_residuals ? static_cast<double>(readings - parameters) : 1e6; // nearly normal
    return statistics::student_quantile(
        significance / 2 / std::max<double>(1, static_cast<double>(intervals)), degrees);
}

Interval Confidence::interval(double value, Eigen::Index i, bool all_together) const
{
    if (is_fixed[static_cast<std::size_t>(i)])
        return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    const double half = (all_together ? quantile_all : quantile) * standard_error(i);
    return {value - half, value + half};
}

Confidence confidence_of(const Minimum& minimum, bool deviations_are_known)
{
    const MatrixXd& J = minimum.there.jacobian;
    const Eigen::Index n = J.cols();
    Confidence found;
    found.readings = J.rows();
    found.sum_of_squares = minimum.sum_of_squares();
    found.covariance = MatrixXd::Zero(n, n);
    found.correlation = MatrixXd::Identity(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
        found.is_fixed.push_back(minimum.at_bound[static_cast<std::size_t>(i)] != AtBound::no ||
                                 J.col(i).norm() == 0);
    const std::vector<Eigen::Index> free = free_of(found.is_fixed);
    found.parameters = static_cast<Eigen::Index>(free.size());
    const auto degrees = static_cast<double>(found.readings - found.parameters);
    if (degrees < 1)
        throw input_error(std::to_string(found.readings) + " readings for " +
                          std::to_string(found.parameters) + " parameters; expected more readings");

    if (deviations_are_known && found.sum_of_squares > 0)
        found.p_value = statistics::chi_squared_above(found.sum_of_squares, degrees);
    found.is_noise_from_residuals = !deviations_are_known || found.p_value < significance;
    if (found.is_noise_from_residuals)
        found.noise_factor = std::sqrt(found.sum_of_squares / degrees);
    found.quantile = found.quantile_of_all(1);
    found.quantile_all = found.quantile_of_all(found.parameters);
    const MatrixXd covariance = found.noise_factor * found.noise_factor * unit_covariance(J);
    found.error_if_free = covariance.diagonal().cwiseSqrt();
    if (free.empty())
        return found;

    const Parts parts = parts_of(J, free);
    found.smallest_eigenvalue = std::max(parts.values[0], 1e-15);
    found.condition_number = std::sqrt(parts.values[parts.values.size() - 1] / found.smallest_eigenvalue);
    // A parameter at a bound is not known. The others have the covariance that they have when it is free.
    found.covariance(free, free) = MatrixXd(covariance(free, free));
    const VectorXd error = found.covariance(free, free).diagonal().cwiseSqrt();
    found.correlation(free, free) = error.cwiseInverse().asDiagonal() * MatrixXd(covariance(free, free)) *
                                    error.cwiseInverse().asDiagonal();
    return found;
}

MatrixXd unit_covariance(const MatrixXd& jacobian)
{
    const std::vector<Eigen::Index> moving = free_of(without_effect(jacobian));
    MatrixXd covariance = MatrixXd::Zero(jacobian.cols(), jacobian.cols());
    if (!moving.empty())
        covariance(moving, moving) = inverse_of(parts_of(jacobian, moving));
    return covariance;
}

Confidence with_prior(Confidence confidence, const Minimum& minimum, const VectorXd& deviations)
{
    const MatrixXd J = minimum.there.jacobian / confidence.noise_factor;
    MatrixXd information = J.transpose() * J;
    information.diagonal() += deviations.array().square().inverse().matrix();
    confidence.covariance = information.llt().solve(MatrixXd::Identity(J.cols(), J.cols()));
    const VectorXd inverse_error = confidence.covariance.diagonal().cwiseSqrt().cwiseInverse();
    confidence.correlation = inverse_error.asDiagonal() * confidence.covariance * inverse_error.asDiagonal();
    confidence.is_fixed.assign(confidence.is_fixed.size(), false);
    confidence.quantile_all = confidence.quantile_of_all(J.cols());
    return confidence;
}

std::optional<WeakCombination> weak_combination(const Minimum& minimum, const Confidence& confidence)
{
    const std::vector<Eigen::Index> free = free_of(confidence.is_fixed);
    if (free.empty())
        return {};
    const Eigen::SelfAdjointEigenSolver<MatrixXd> parts(MatrixXd(confidence.covariance(free, free)));
    WeakCombination weak{VectorXd::Zero(minimum.parameters.size()), 0,
                         free.size() > 1 && confidence.smallest_eigenvalue < 0.01};
    VectorXd direction = parts.eigenvectors().col(parts.eigenvectors().cols() - 1);
    Eigen::Index largest = 0;
    direction.cwiseAbs().maxCoeff(&largest);
    weak.standard_error =
        std::sqrt(parts.eigenvalues()[parts.eigenvalues().size() - 1]) * std::abs(direction[largest]);
    weak.direction(free) = direction / direction[largest];
    if (!weak.is_alike_effects && confidence.quantile * weak.standard_error < std::log(2.0))
        return {};
    return weak;
}

std::vector<bool> resolved(const Minimum& minimum, const Confidence& confidence)
{
    const MatrixXd& J = minimum.there.jacobian;
    std::vector<bool> found = without_effect(J);
    const std::vector<Eigen::Index> some = free_of(found);
    found.flip();
    if (some.empty())
        return found;
    const VectorXd variance = unit_covariance(J).diagonal();
    for (const Eigen::Index i : some) {
        const double alone = confidence.noise_factor * std::sqrt(variance[i]),
                     error = std::max(alone, confidence.error_if_free[i]);
        found[static_cast<std::size_t>(i)] = confidence.quantile * error < std::log(10.0);
    }
    return found;
}

} // namespace jointcreep::estimation
