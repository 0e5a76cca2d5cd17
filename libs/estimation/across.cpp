#include "estimation/across.hpp"

#include "statistics/distribution.hpp"

#include <algorithm>
#include <cmath>

namespace jointcreep::estimation
{

std::vector<std::optional<Across>> across(const std::vector<OfOneModel>& models, bool deviations_are_known)
{
    const auto K = static_cast<double>(models.size());
    const Eigen::Index n = models.front().parameters.size();
    std::vector<std::optional<Across>> found(static_cast<std::size_t>(n));
    for (Eigen::Index i = 0; i < n; ++i) {
        if (std::any_of(models.begin(), models.end(), [i](const OfOneModel& model) {
                return model.confidence.is_fixed[static_cast<std::size_t>(i)];
            }))
            continue;
        double mean = 0, noise = 0, squares = 0, degrees = 0;
        for (const OfOneModel& model : models) {
            mean += model.parameters[i] / K;
            const double factor = deviations_are_known ? model.confidence.noise_factor : 1.0;
            noise += model.confidence.covariance(i, i) / (factor * factor) / K;
            degrees += static_cast<double>(model.confidence.readings - model.confidence.parameters) / K;
        }
        for (const OfOneModel& model : models)
            squares += (model.parameters[i] - mean) * (model.parameters[i] - mean);
        const double S = squares / (K - 1), by_models = S * (1 + 1 / K), variance = by_models + noise;
        const double error = std::sqrt(variance);
        const auto half_at = [&](double tail) {
            return std::hypot(statistics::student_quantile(tail, K - 1) * std::sqrt(by_models),
                              statistics::student_quantile(tail, std::max(1.0, degrees)) * std::sqrt(noise));
        };
        const double half = half_at(0.025), half_all = half_at(0.025 / static_cast<double>(n));
        found[static_cast<std::size_t>(i)] = {
            mean, std::sqrt(S), error, {mean - half, mean + half}, {mean - half_all, mean + half_all}};
    }
    return found;
}

} // namespace jointcreep::estimation
