// Statistical checks, each wrong about a right sampler once in a thousand times. Seeds are fixed, so that a
// check that has passed goes on passing until the sampler changes.

#pragma once

#include "model/scene.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace jointcreep::statistics
{

using Samples = std::vector<double>;
using Distribution = std::function<double(double)>;

inline double mean(const Samples& samples)
{
    double sum = 0;
    for (const double x : samples)
        sum += x;
    return sum / static_cast<double>(samples.size());
}

inline double variance(const Samples& samples)
{
    const double m = mean(samples);
    double sum = 0;
    for (const double x : samples)
        sum += (x - m) * (x - m);
    return sum / static_cast<double>(samples.size() - 1);
}

// Kolmogorov-Smirnov, level 1e-3: sqrt(n) D < sqrt(-ln(.0005) / 2) = 1.95.
inline bool follow(Samples samples, const Distribution& cdf)
{
    std::sort(samples.begin(), samples.end());
    const auto n = static_cast<double>(samples.size());
    double worst = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const double p = cdf(samples[i]);
        worst = std::max({worst, p - static_cast<double>(i) / n, static_cast<double>(i + 1) / n - p});
    }
    return std::sqrt(n) * worst < 1.95;
}

// Normal approximation, level 1e-3: 3.29 standard errors.
inline bool have_mean(const Samples& samples, double expected)
{
    const double error = std::sqrt(variance(samples) / static_cast<double>(samples.size()));
    return std::abs(mean(samples) - expected) < 3.29 * error;
}

inline bool have_deviation(const Samples& samples, double expected)
{
    const double m = mean(samples);
    Samples squares;
    for (const double x : samples)
        squares.push_back((x - m) * (x - m));
    return have_mean(squares, expected * expected);
}

// Density of a law, not normalised.
inline double density(const ProbabilityLaw& law, double x)
{
    const auto bell = [](double z) { return std::exp(-z * z / 2); };
    switch (law.kind) {
    case ProbabilityLaw::Kind::normal:
        return bell((x - law.mean) / law.deviation);
    case ProbabilityLaw::Kind::lognormal: {
        const double s2 = std::log(1 + law.deviation * law.deviation / (law.mean * law.mean));
        return x > 0 ? bell((std::log(x) - std::log(law.mean) + s2 / 2) / std::sqrt(s2)) / x : 0;
    }
    case ProbabilityLaw::Kind::negative_exponential:
        return x >= 0 ? std::exp(-x / law.mean) : 0;
    case ProbabilityLaw::Kind::uniform:
        return x >= law.least && x <= law.most ? 1 : 0;
    case ProbabilityLaw::Kind::power:
        return x >= law.least && x <= law.most ? std::pow(x, -law.exponent) : 0;
    case ProbabilityLaw::Kind::constant:
        break;
    }
    return 0;
}

// Angles between poles and the mean pole by Fisher's law: of density kappa sin(t) exp(kappa cos(t)) / (2
// sinh(kappa)).
inline Distribution fisher_distribution(double concentration)
{
    return [concentration](double t) {
        const double half = std::sin(t / 2); // 1 - cos(t) = 2 half^2
        return std::expm1(-2 * concentration * half * half) / std::expm1(-2 * concentration);
    };
}

// Mean of cos(t) by Fisher's law, the length of the mean resultant: coth(kappa) - 1 / kappa.
inline double fisher_resultant(double concentration)
{
    return 1 / std::tanh(concentration) - 1 / concentration;
}

// Where densities of a law's positive values are integrated: evenly from 0, but for the power law evenly by
// the logarithm from its sharp lower cut-off.
inline std::vector<double> grid(const ProbabilityLaw& law)
{
    const int steps = 40000;
    std::vector<double> places;
    if (law.kind == ProbabilityLaw::Kind::power) {
        places = {0, law.least * (1 - 1e-12)};
        for (int i = 0; i <= steps; ++i)
            places.push_back(law.least * std::pow(law.most / law.least, double(i) / steps));
        return places;
    }
    const double end = law.kind == ProbabilityLaw::Kind::uniform ? law.most : law.mean + 40 * law.deviation;
    for (int i = 0; i <= steps; ++i)
        places.push_back(end * i / steps);
    return places;
}

// Distribution of a density, by the trapezoidal rule.
inline Distribution integrated(const std::function<double(double)>& density, const std::vector<double>& grid)
{
    std::vector<double> sum(grid.size(), 0.0);
    for (std::size_t i = 1; i < grid.size(); ++i)
        sum[i] = sum[i - 1] + (grid[i] - grid[i - 1]) * (density(grid[i - 1]) + density(grid[i])) / 2;
    const double total = sum.back();
    for (double& value : sum)
        value /= total;
    return [sum, grid](double x) {
        const auto after = std::upper_bound(grid.begin(), grid.end(), x);
        if (after == grid.begin() || after == grid.end())
            return after == grid.begin() ? 0.0 : 1.0;
        const auto i = static_cast<std::size_t>(after - grid.begin());
        return sum[i - 1] + (x - grid[i - 1]) / (grid[i] - grid[i - 1]) * (sum[i] - sum[i - 1]);
    };
}

// Of a law's values above 0.
inline Distribution positive_distribution(const ProbabilityLaw& law)
{
    return integrated([law](double x) { return density(law, x); }, grid(law));
}

// Of density x f(x) / m: intervals as a point sees them.
inline Distribution size_biased_distribution(const ProbabilityLaw& law)
{
    return integrated([law](double x) { return x * density(law, x); }, grid(law));
}

// Of density (1 - F(x)) / m: what is left of an interval beyond a point.
inline Distribution residual_distribution(const ProbabilityLaw& law)
{
    const Distribution cdf = positive_distribution(law);
    return integrated([cdf](double x) { return 1 - cdf(x); }, grid(law));
}

} // namespace jointcreep::statistics
