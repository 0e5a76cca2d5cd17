#include "estimation/least_squares.hpp"

#include "model/error.hpp"

#include <Eigen/Cholesky>

#include <algorithm>

namespace jointcreep::estimation
{

Minimum minimise(const Model& model, const VectorXd& start, const VectorXd& low, const VectorXd& high,
                 int most_evaluations, double relative)
{
    constexpr double smallest_step = 1e-10, least_gain = 1e-4, largest_lambda = 1e10;
    const auto n = static_cast<std::size_t>(start.size());
    Minimum best{.parameters = start.cwiseMax(low).cwiseMin(high), .there = {}, .at_bound = {}};
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
        for (;;) {
            VectorXd step = VectorXd::Zero(start.size());
            if (!free.empty()) {
                MatrixXd damped = information(free, free);
                damped.diagonal() *= 1 + lambda;
                const VectorXd found_step = damped.ldlt().solve(VectorXd(downhill(free)));
                step(free) = found_step;
            }
            const VectorXd next = (best.parameters + step).cwiseMax(low).cwiseMin(high);
            step = next - best.parameters;
            const double predicted = sum - (r + J * step).squaredNorm();
            if (!(predicted > relative * sum) || step.lpNorm<Eigen::Infinity>() < smallest_step ||
                lambda > largest_lambda) {
                best.is_converged = true;
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
            lambda *= growth;
            growth *= 2;
        }
    }
}

} // namespace jointcreep::estimation
