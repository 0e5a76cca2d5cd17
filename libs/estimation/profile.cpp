#include "estimation/profile.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace jointcreep::estimation
{

namespace
{

constexpr double infinity = std::numeric_limits<double>::infinity();

} // namespace

double profile_end(const Model& model, const VectorXd& minimum, double least_sum, double limit,
                   Eigen::Index i, const VectorXd& guess, const Bounds& bounds, const ProfileSearch& search)
{
    constexpr int most_values = 60, most_evaluations = 100;
    const double side = guess[i] < minimum[i] ? -1 : 1, wanted = std::sqrt(limit - least_sum),
                 bound = side < 0 ? bounds.low[i] : bounds.high[i],
                 reach = std::min(search.widest, std::abs(bound - minimum[i]));
    VectorXd last = guess; // the others go on in the direction in which they went

    // The root of how much the least sum over the others is above the least of all: linear in the distance where the model is.
    const auto profile = [&](double distance) {
        const double before = std::abs(last[i] - minimum[i]);
        VectorXd start =
            (minimum + (last - minimum) * (distance / before)).cwiseMax(bounds.low).cwiseMin(bounds.high);
        start[i] = minimum[i] + side * distance;
        Bounds fixed = bounds;
        fixed.low[i] = fixed.high[i] = start[i];
        std::optional<Evaluation> first = model(start);
        if (!first)
            return infinity;
        const double gain =
            search.least_gain * (limit - least_sum) / std::max(first->residual.squaredNorm(), limit);
        const Minimum least = minimise(
            [&](const VectorXd& parameters) {
                return first ? std::exchange(first, std::nullopt) : model(parameters);
            },
            start, fixed.low, fixed.high, most_evaluations, gain);
        if (least.sum_of_squares() > limit && !least.is_converged)
            return infinity; // perhaps it is less
        last = least.parameters;
        return std::sqrt(std::max(0.0, least.sum_of_squares() - least_sum));
    };

    if (!(reach > 0))
        return side * infinity;
    if (!(wanted > 0))
        return minimum[i]; // exact
    double within = 0, beyond = infinity, at_within = 0, at_beyond = infinity;
    double distance = std::min(std::abs(guess[i] - minimum[i]), reach);
    for (int n = 0; n < most_values; ++n) {
        const double found = profile(distance);
        if (std::abs(found - wanted) <= search.share * wanted)
            return minimum[i] + side * distance;
        if (found < wanted) {
            if (distance >= reach)
                return side * infinity;
            within = distance;
            at_within = found;
        } else {
            beyond = distance;
            at_beyond = found;
        }
        if (std::isfinite(beyond) && beyond - within <= search.share * beyond)
            break;
        // Straight on from the nearest value; between the two where that leads beyond the other one.
        const double next = found > 0 && std::isfinite(found) ? distance * wanted / found : infinity;
        if (!std::isfinite(beyond))
            distance = std::min({next, 3 * within, reach});
        else if (next > within && next < beyond)
            distance = next;
        else
            distance = std::isfinite(at_beyond)
                           ? within + (beyond - within) *
                                          std::clamp((wanted - at_within) / (at_beyond - at_within), 0.1, 0.9)
                           : (within + beyond) / 2;
    }
    return std::isfinite(at_beyond) ? minimum[i] + side * (within + beyond) / 2 : side * infinity;
}

std::vector<Profile> profiles(const Model& model, const Minimum& minimum, const Confidence& confidence,
                              const Bounds& bounds)
{
    const MatrixXd inverse = unit_covariance(minimum.there.jacobian);
    std::vector<Profile> found;
    for (Eigen::Index i = 0; i < inverse.cols(); ++i) {
        Profile& profile = found.emplace_back(Profile{{-infinity, infinity}, {-infinity, infinity}});
        if (!(inverse(i, i) > 0))
            continue;
        const double unit_error = std::sqrt(inverse(i, i)), error = confidence.standard_error(i);
        // An error may have more than the noise: that weights or a correlation are not known. None at a bound.
        const double noise = error > 0 ? error / unit_error : confidence.noise_factor;
        const VectorXd along = inverse.col(i) / inverse(i, i); // where the others are best, of a linear model
        // An end from the guess of its distance.
        const auto end = [&](int side, double quantile, double distance) {
            const double reach = quantile * noise;
            return profile_end(model, minimum.parameters, minimum.sum_of_squares(),
                               minimum.sum_of_squares() + reach * reach, i,
                               minimum.parameters + side * std::min(distance, ProfileSearch{}.widest) * along,
                               bounds, {});
        };
        const double quantile = confidence.quantile, more = confidence.quantile_all / quantile;
        const auto ends = [&](int side) {
            const double one = end(side, quantile, quantile * noise * unit_error),
                         distance = std::abs(one - minimum.parameters[i]);
            return std::pair(one, std::isfinite(one) && more > 1 ? end(side, more * quantile, more * distance)
                                                                 : one);
        };
        std::tie(profile.interval.low, profile.with_all.low) = ends(-1);
        std::tie(profile.interval.high, profile.with_all.high) = ends(1);
    }
    return found;
}

} // namespace jointcreep::estimation
