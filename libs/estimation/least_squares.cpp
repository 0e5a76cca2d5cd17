#include "estimation/least_squares.hpp"

#include "model/error.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <optional>

namespace jointcreep::estimation
{

namespace
{

// The step of the free parameters: straight to where they are best. The first that reaches a bound stays there, and the
// others go on from there. So the sum of squares of the linear model falls all the way.
VectorXd step_within(const MatrixXd& information, const VectorXd& downhill, double lambda,
                     std::vector<Eigen::Index> free, const VectorXd& low, const VectorXd& high)
{
    VectorXd step = VectorXd::Zero(downhill.size());
    MatrixXd damped = information;
    damped.diagonal() *= 1 + lambda;
    while (!free.empty()) {
        const VectorXd right = (downhill - damped * step)(free);
        const VectorXd more = MatrixXd(damped(free, free)).ldlt().solve(right);
        double share = 1, bound = 0;
        std::optional<std::size_t> first;
        for (std::size_t k = 0; k < free.size(); ++k) {
            const Eigen::Index i = free[k];
            const double wanted = more[static_cast<Eigen::Index>(k)], end = wanted < 0 ? low[i] : high[i];
            if (std::abs(wanted) * share > std::abs(end - step[i])) {
                share = std::abs((end - step[i]) / wanted);
                bound = end;
                first = k;
            }
        }
        for (std::size_t k = 0; k < free.size(); ++k)
            step[free[k]] += share * more[static_cast<Eigen::Index>(k)];
        if (!first)
            return step;
        step[free[*first]] = bound;
        free.erase(free.begin() + static_cast<std::ptrdiff_t>(*first));
    }
    return step;
}

// A step to a bound ends there, whatever rounding.
VectorXd after(const VectorXd& parameters, const VectorXd& step, const VectorXd& low, const VectorXd& high)
{
    VectorXd next = (parameters + step).cwiseMax(low).cwiseMin(high);
    for (Eigen::Index i = 0; i < next.size(); ++i)
        if (step[i] < 0 && step[i] == low[i] - parameters[i])
            next[i] = low[i];
        else if (step[i] > 0 && step[i] == high[i] - parameters[i])
            next[i] = high[i];
    return next;
}

// Whether the step left is within a tenth of a standard error, whatever its direction: by the quadratic form
// of the covariance's inverse, J^T J / s^2.
bool is_small(const VectorXd& left, const Evaluation& there)
{
    const auto degrees = static_cast<double>(std::max<Eigen::Index>(1, there.residual.size() - left.size()));
    return left.lpNorm<Eigen::Infinity>() <= converged_step ||
           (there.jacobian * left).squaredNorm() <=
               converged_errors * converged_errors * there.residual.squaredNorm() / degrees;
}

} // namespace

Minimum minimise(const Model& model, const VectorXd& start, const VectorXd& low, const VectorXd& high,
                 int most_evaluations, double relative)
{
    constexpr double smallest_step = 1e-10, least_gain = 1e-4, largest_lambda = 1e10, undamped = 1e-9;
    const auto n = static_cast<std::size_t>(start.size());
    Minimum best{.parameters = start.cwiseMax(low).cwiseMin(high), .there = {}, .at_bound = {}, .left = {}};
    std::optional<Evaluation> found = model(best.parameters);
    best.evaluations = 1;
    if (!found)
        throw input_error("the model has no answer where the search starts");
    best.there = std::move(*found);
    double lambda = 1e-3, growth = 2;
    for (;;) {
        const VectorXd& r = best.there.residual;
        const MatrixXd& J = best.there.jacobian;
        const VectorXd downhill = -J.transpose() * r;
        const MatrixXd information = J.transpose() * J;
        best.at_bound.assign(n, AtBound::no);
        std::vector<Eigen::Index> free; // and not without effect
        for (std::size_t k = 0; k < n; ++k) {
            const auto i = static_cast<Eigen::Index>(k);
            if (best.parameters[i] <= low[i] && downhill[i] < 0)
                best.at_bound[k] = AtBound::low;
            else if (best.parameters[i] >= high[i] && downhill[i] > 0)
                best.at_bound[k] = AtBound::high;
            else if (information(i, i) > 0)
                free.push_back(i);
        }
        const double sum = r.squaredNorm();
        best.left =
            step_within(information, downhill, undamped, free, low - best.parameters, high - best.parameters);
        best.is_converged = is_small(best.left, best.there);
        for (;;) {
            const VectorXd step = step_within(information, downhill, lambda, free, low - best.parameters,
                                              high - best.parameters);
            const VectorXd next = after(best.parameters, step, low, high);
            const double predicted = sum - (r + J * step).squaredNorm();
            if (!(predicted > relative * sum) || step.lpNorm<Eigen::Infinity>() < smallest_step ||
                lambda > largest_lambda) {
                best.has_stalled = !best.is_converged;
                return best;
            }
            if (best.evaluations == most_evaluations)
                return best;
            found = model(next);
            ++best.evaluations;
            const double gain = found ? (sum - found->residual.squaredNorm()) / predicted : -1.0;
            if (gain > least_gain) {
                best.parameters = next;
                best.there = std::move(*found);
                lambda *= std::max(1. / 3, 1 - (2 * gain - 1) * (2 * gain - 1) * (2 * gain - 1));
                growth = 2;
                break;
            }
            if (best.is_converged)
                return best;
            lambda *= growth;
            growth *= 2;
        }
    }
}

} // namespace jointcreep::estimation
