#include "estimation/confidence.hpp"

#include "model/error.hpp"
#include "statistics/distribution.hpp"

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

} // namespace

double Confidence::standard_error(Eigen::Index i) const
{
    return std::sqrt(covariance(i, i));
}

double Confidence::standard_error(const VectorXd& gradient) const
{
    return std::sqrt(std::max(0.0, gradient.dot(covariance * gradient)));
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
                          std::to_string(found.parameters) + " parameters; wanted more readings");

    if (deviations_are_known && found.sum_of_squares > 0)
        found.p_value = statistics::chi_squared_above(found.sum_of_squares, degrees);
    found.is_noise_from_residuals = !deviations_are_known || found.p_value < significance;
    if (found.is_noise_from_residuals)
        found.noise_factor = std::sqrt(found.sum_of_squares / degrees);
    const double t_degrees = found.is_noise_from_residuals ? degrees : 1e6; // nearly normal
    const auto quantile = [&](double p) { return statistics::student_quantile(p, t_degrees); };
    found.quantile = quantile(significance / 2);
    found.quantile_all = quantile(significance / 2 / std::max<double>(1, static_cast<double>(free.size())));
    if (free.empty())
        return found;

    // Columns are divided by their lengths, so that inverting loses few digits.
    const MatrixXd columns = J(Eigen::all, free);
    const VectorXd length = columns.colwise().norm();
    const MatrixXd scaled = columns * length.cwiseInverse().asDiagonal();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> parts(scaled.transpose() * scaled);
    found.smallest_eigenvalue = std::max(parts.eigenvalues()[0], 1e-15);
    found.condition_number =
        std::sqrt(parts.eigenvalues()[parts.eigenvalues().size() - 1] / found.smallest_eigenvalue);
    const MatrixXd inverse = parts.eigenvectors() *
                             parts.eigenvalues().cwiseMax(1e-15).cwiseInverse().asDiagonal() *
                             parts.eigenvectors().transpose();
    const MatrixXd covariance =
        found.noise_factor * found.noise_factor *
        (length.cwiseInverse().asDiagonal() * inverse * length.cwiseInverse().asDiagonal());
    found.covariance(free, free) = covariance;
    const VectorXd error = inverse.diagonal().cwiseSqrt();
    found.correlation(free, free) =
        error.cwiseInverse().asDiagonal() * inverse * error.cwiseInverse().asDiagonal();
    return found;
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
    std::vector<bool> has_effect;
    for (Eigen::Index i = 0; i < J.cols(); ++i)
        has_effect.push_back(J.col(i).norm() > 0);
    std::vector<bool> without_effect = has_effect;
    without_effect.flip();
    const std::vector<Eigen::Index> some = free_of(without_effect);
    std::vector<bool> found(has_effect);
    if (some.empty())
        return found;
    const MatrixXd columns = J(Eigen::all, some);
    const VectorXd length = columns.colwise().norm();
    const MatrixXd scaled = columns * length.cwiseInverse().asDiagonal();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> parts(scaled.transpose() * scaled);
    const VectorXd variance =
        parts.eigenvectors().cwiseAbs2() * parts.eigenvalues().cwiseMax(1e-15).cwiseInverse();
    for (std::size_t k = 0; k < some.size(); ++k) {
        const auto i = static_cast<Eigen::Index>(k);
        const double alone = confidence.noise_factor * std::sqrt(variance[i]) / length[i],
                     error = confidence.is_fixed[static_cast<std::size_t>(some[k])]
                                 ? alone
                                 : std::max(alone, confidence.standard_error(some[k]));
        found[static_cast<std::size_t>(some[k])] = confidence.quantile * error < std::log(10.0);
    }
    return found;
}

} // namespace jointcreep::estimation
