#include "estimation/profile.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace jointcreep::estimation
{

namespace
{

constexpr double infinity = std::numeric_limits<double>::infinity();

} // namespace

ProfileEnd profile_end(const Model& model, const VectorXd& minimum, double least_sum, double limit,
                       Eigen::Index i, const VectorXd& guess, const Bounds& bounds,
                       const ProfileSearch& search)
{
    constexpr int most_evaluations = 100; // of a value of the profile
    const double side = guess[i] < minimum[i] ? -1 : 1, wanted = std::sqrt(limit - least_sum),
                 bound = side < 0 ? bounds.low[i] : bounds.high[i],
                 reach = std::min(search.widest, std::abs(bound - minimum[i]));
    VectorXd last = guess; // the others go on in the direction in which they went
    int runs_left = search.most_runs;
    std::optional<Better> better;
    bool is_cut = false; // the last value may be less with more runs

    // The root of how much the least sum over the others is above the least of all: linear in the distance where the model is.
    // Infinite where it is not known.
    const auto profile = [&](double distance) {
        const double before = std::abs(last[i] - minimum[i]);
        VectorXd start =
            (minimum + (last - minimum) * (distance / before)).cwiseMax(bounds.low).cwiseMin(bounds.high);
        start[i] = minimum[i] + side * distance;
        Bounds fixed = bounds;
        fixed.low[i] = fixed.high[i] = start[i];
        std::optional<Evaluation> first = model(start);
        if (!first) {
            --runs_left;
            return infinity;
        }
        const double gain =
            search.least_gain * (limit - least_sum) / std::max(first->residual.squaredNorm(), limit);
        const Minimum least = minimise(
            [&](const VectorXd& parameters) {
                return first ? std::exchange(first, std::nullopt) : model(parameters);
            },
            start, fixed.low, fixed.high, std::min(most_evaluations, runs_left), gain);
        runs_left -= least.evaluations;
        is_cut = !least.is_converged && runs_left <= 0;
        if (least.sum_of_squares() < least_sum - search.tolerance &&
            (least.parameters - minimum).lpNorm<Eigen::Infinity>() > converged_step)
            better = Better{least.parameters, least.sum_of_squares()};
        if (least.sum_of_squares() > limit && !least.is_converged)
            return infinity; // perhaps it is less
        last = least.parameters;
        return std::sqrt(std::max(0.0, least.sum_of_squares() - least_sum));
    };

    if (!(reach > 0))
        return {side * infinity};
    if (!(wanted > 0))
        return {minimum[i]}; // exact
    double within = 0, beyond = infinity, at_within = 0, at_beyond = infinity;
    double distance = std::min(std::abs(guess[i] - minimum[i]), reach);
    while (runs_left > 0) {
        const double found = profile(distance);
        if (better)
            return {.at = side * infinity, .better = better};
        if (!is_cut && std::abs(found - wanted) <= search.share * wanted)
            return {minimum[i] + side * distance};
        if (found < wanted) {
            if (distance >= reach)
                return {side * infinity};
            within = distance;
            at_within = found;
        } else if (std::isfinite(found) || runs_left > 0) {
            beyond = distance;
            at_beyond = found;
        }
        if (std::isfinite(beyond) && beyond - within <= search.share * beyond)
            return {std::isfinite(at_beyond) ? minimum[i] + side * (within + beyond) / 2 : side * infinity};
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
    return {.at = side * infinity, .beyond = minimum[i] + side * within};
}

Profiles profiles(const Model& model, const Minimum& minimum, const Confidence& confidence,
                  const Bounds& bounds, int most_runs)
{
    const MatrixXd inverse = unit_covariance(minimum.there.jacobian);
    const VectorXd unit_errors = inverse.diagonal().cwiseSqrt();
    const double quantile_all = confidence.quantile_of_all((unit_errors.array() > 0).count()),
                 more = quantile_all / confidence.quantile;
    const Profile none{{-infinity, infinity}, {-infinity, infinity}};
    Profiles found;
    for (Eigen::Index i = 0; i < inverse.cols(); ++i) {
        Profile& profile = found.of_each.emplace_back(none);
        if (!(unit_errors[i] > 0))
            continue;
        // An error may have more than the noise: that weights or a correlation are not known.
        const double error = confidence.error_if_free[i], noise = error / unit_errors[i];
        const VectorXd along = inverse.col(i) / inverse(i, i); // where the others are best, of a linear model
        const ProfileSearch search{.tolerance = std::pow(converged_errors * noise, 2),
                                   .most_runs = most_runs};
        // An end from the guess of its distance.
        const auto end = [&](int side, double quantile, double distance, bool is_with_all) {
            const double reach = quantile * noise;
            const ProfileEnd its = profile_end(
                model, minimum.parameters, minimum.sum_of_squares(), minimum.sum_of_squares() + reach * reach,
                i, minimum.parameters + side * std::min(distance, search.widest) * along, bounds, search);
            if (its.better)
                found.better = its.better;
            if (its.beyond)
                profile.not_found.push_back({side > 0, is_with_all, *its.beyond});
            return its.at;
        };
        const auto ends = [&](int side) {
            const double one = end(side, confidence.quantile, confidence.quantile * error, false),
                         distance = std::abs(one - minimum.parameters[i]);
            double with_all = one;
            if (std::isfinite(one) && more > 1)
                with_all = end(side, quantile_all, more * distance, true);
            else if (!profile.not_found.empty() && profile.not_found.back().is_high == (side > 0))
                profile.not_found.push_back({side > 0, true, profile.not_found.back().beyond});
            return std::pair(one, with_all);
        };
        for (const int side : {-1, 1}) {
            const auto [one, with_all] = ends(side);
            if (found.better) {
                found.of_each.assign(static_cast<std::size_t>(inverse.cols()), none);
                return found;
            }
            (side < 0 ? profile.interval.low : profile.interval.high) = one;
            (side < 0 ? profile.with_all.low : profile.with_all.high) = with_all;
        }
    }
    return found;
}

} // namespace jointcreep::estimation
