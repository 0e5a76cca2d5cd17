#include "statistics/distribution.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/lognormal.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/gamma.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace jointcreep::statistics
{

namespace
{

// Integral of t^-exponent from 1 to x over that from 1 to r.
double power_share(double exponent, double x, double r)
{
    const double q = 1 - exponent;
    return q == 0 ? std::log(x) / std::log(r) : std::expm1(q * std::log(x)) / std::expm1(q * std::log(r));
}

double lognormal_distribution(const ProbabilityLaw& law, double x)
{
    const double ratio = law.deviation / law.mean, variance = std::log1p(ratio * ratio);
    const boost::math::lognormal normal_logarithm(std::log(law.mean) - variance / 2, std::sqrt(variance));
    return x > 0 ? cdf(normal_logarithm, x) : 0;
}

// The third central moment over the cube of the mean, from moments about zero.
Moments from_moments(double first, double second, double third)
{
    const double central = third - 3 * first * second + 2 * first * first * first;
    return {first, std::max(0.0, second / (first * first) - 1), central / (first * first * first)};
}

Moments of_normal_above_zero(const ProbabilityLaw& law)
{
    // E[X^k] = mean E[X^(k-1)] + (k - 1) deviation^2 E[X^(k-2)] for k >= 2: what integration by parts leaves
    // at 0 vanishes.
    const boost::math::normal normal(law.mean, law.deviation);
    const double variance = law.deviation * law.deviation;
    const double above = cdf(complement(normal, 0.0));
    const double first = law.mean + variance * pdf(normal, 0.0) / above;
    const double second = law.mean * first + variance;
    return from_moments(first, second, law.mean * second + 2 * variance * first);
}

double two_sided(double lower, double upper)
{
    return std::min(1.0, 2 * std::min(lower, upper));
}

} // namespace

double distribution(const ProbabilityLaw& law, double x)
{
    switch (law.kind) {
    case ProbabilityLaw::Kind::constant:
        break;
    case ProbabilityLaw::Kind::normal:
        return law.deviation > 0 ? cdf(boost::math::normal(law.mean, law.deviation), x) : x >= law.mean;
    case ProbabilityLaw::Kind::lognormal:
        return law.deviation > 0 ? lognormal_distribution(law, x) : x >= law.mean;
    case ProbabilityLaw::Kind::negative_exponential:
        return x > 0 ? -std::expm1(-x / law.mean) : 0;
    case ProbabilityLaw::Kind::uniform:
        return law.most > law.least ? std::clamp((x - law.least) / (law.most - law.least), 0.0, 1.0)
                                    : x >= law.mean;
    case ProbabilityLaw::Kind::power:
        return power_share(law.exponent, std::clamp(x, law.least, law.most) / law.least,
                           law.most / law.least);
    }
    return x >= law.mean ? 1 : 0;
}

double positive_distribution(const ProbabilityLaw& law, double x)
{
    if (law.kind != ProbabilityLaw::Kind::normal || law.deviation == 0)
        return distribution(law, x);
    const double at_zero = distribution(law, 0);
    return std::max(0.0, (distribution(law, x) - at_zero) / (1 - at_zero));
}

double quantile(const ProbabilityLaw& law, double p)
{
    if (law.kind == ProbabilityLaw::Kind::normal && law.deviation > 0)
        return boost::math::quantile(boost::math::normal(law.mean, law.deviation), p);
    if (law.kind == ProbabilityLaw::Kind::uniform)
        return law.least + p * (law.most - law.least);
    return law.mean;
}

double kurtosis(const ProbabilityLaw& law)
{
    return law.kind == ProbabilityLaw::Kind::uniform ? 1.8 : 3;
}

Moments positive_moments(const ProbabilityLaw& law)
{
    switch (law.kind) {
    case ProbabilityLaw::Kind::constant:
        break;
    case ProbabilityLaw::Kind::normal:
        return law.deviation > 0 ? of_normal_above_zero(law) : Moments{law.mean, 0, 0};
    case ProbabilityLaw::Kind::lognormal: {
        const double c = law.deviation * law.deviation / (law.mean * law.mean);
        return {law.mean, c, c * c * (c + 3)};
    }
    case ProbabilityLaw::Kind::negative_exponential:
        return {law.mean, 1, 2};
    case ProbabilityLaw::Kind::uniform:
        return {law.mean, law.deviation * law.deviation / (law.mean * law.mean), 0};
    case ProbabilityLaw::Kind::power: {
        const auto moment = [&law](double order) {
            return std::pow(law.least, order) * power_moment(law.exponent, law.least, law.most, order);
        };
        return from_moments(moment(1), moment(2), moment(3));
    }
    }
    return {law.mean, 0, 0};
}

// Q(x) = 2 sum (-1)^(k-1) exp(-2 k^2 x^2).
Fit kolmogorov_smirnov(std::vector<double> uniforms)
{
    std::sort(uniforms.begin(), uniforms.end());
    const auto n = static_cast<double>(uniforms.size());
    double farthest = 0;
    for (std::size_t i = 0; i < uniforms.size(); ++i)
        farthest = std::max({farthest, uniforms[i] - static_cast<double>(i) / n,
                             static_cast<double>(i + 1) / n - uniforms[i]});
    const double x = (std::sqrt(n) + 0.12 + 0.11 / std::sqrt(n)) * farthest;
    if (x < 0.2)
        return {farthest, 1};
    double sum = 0, sign = 1;
    for (int k = 1; k <= 100; ++k, sign = -sign)
        sum += sign * std::exp(-2 * k * k * x * x);
    return {farthest, std::clamp(2 * sum, 0.0, 1.0)};
}

// Q(x) = 2 sum (4 k^2 x^2 - 1) exp(-2 k^2 x^2).
Fit kuiper(std::vector<double> uniforms)
{
    std::sort(uniforms.begin(), uniforms.end());
    const auto n = static_cast<double>(uniforms.size());
    double above = 0, below = 0;
    for (std::size_t i = 0; i < uniforms.size(); ++i) {
        below = std::max(below, uniforms[i] - static_cast<double>(i) / n);
        above = std::max(above, static_cast<double>(i + 1) / n - uniforms[i]);
    }
    const double x = (std::sqrt(n) + 0.155 + 0.24 / std::sqrt(n)) * (above + below);
    if (x < 0.4)
        return {above + below, 1};
    double sum = 0;
    for (int k = 1; k <= 100; ++k)
        sum += (4 * k * k * x * x - 1) * std::exp(-2 * k * k * x * x);
    return {above + below, std::clamp(2 * sum, 0.0, 1.0)};
}

double normal_p(double deviate)
{
    return std::erfc(std::abs(deviate) / std::numbers::sqrt2);
}

double student_p(double t, double degrees)
{
    return 2 * cdf(complement(boost::math::students_t(degrees), std::abs(t)));
}

double chi_squared_p(double value, double degrees)
{
    const boost::math::chi_squared law(degrees);
    return two_sided(cdf(law, value), cdf(complement(law, value)));
}

double chi_squared_above(double value, double degrees)
{
    return cdf(complement(boost::math::chi_squared(degrees), value));
}

double fisher_f_p(double value, double degrees_above, double degrees_below)
{
    return cdf(complement(boost::math::fisher_f(degrees_above, degrees_below), value));
}

double student_quantile(double p, double degrees)
{
    return boost::math::quantile(complement(boost::math::students_t(degrees), p));
}

double chi_squared_quantile(double p, double degrees)
{
    return boost::math::quantile(complement(boost::math::chi_squared(degrees), p));
}

double fisher_f_quantile(double p, double degrees_above, double degrees_below)
{
    return boost::math::quantile(complement(boost::math::fisher_f(degrees_above, degrees_below), p));
}

double at_least(double n, double length, const Renewal& renewal)
{
    const double c = renewal.squared_variation;
    const double remaining = (1 + c) / 2; // mean of the remaining interval, over that of the intervals
    const double remaining_square = (1 + 3 * c + renewal.third) / 3;
    const double mean = n - 1 + remaining;
    const double variance = (n - 1) * c + remaining_square - remaining * remaining + renewal.blur;
    return boost::math::gamma_p(mean * mean / variance, length / renewal.mean * mean / variance);
}

namespace
{

// P(more than n) + P(n) / 2.
double upper_mid(std::size_t n, double length, const Renewal& renewal)
{
    const auto count = static_cast<double>(n);
    const double here = n == 0 ? 1 : at_least(count, length, renewal);
    return (here + at_least(count + 1, length, renewal)) / 2;
}

// The mean interval with which so many or more points come with the probability p; it falls with p.
double mean_where(double p, std::size_t n, double length, Renewal renewal)
{
    double low = std::log(length / (1000.0 + 10.0 * static_cast<double>(n))), high = std::log(1000 * length);
    for (int i = 0; i < 60; ++i) {
        const double middle = (low + high) / 2;
        renewal.mean = std::exp(middle);
        (upper_mid(n, length, renewal) > p ? low : high) = middle;
    }
    return std::exp((low + high) / 2);
}

} // namespace

double count_p(std::size_t n, double length, const Renewal& renewal)
{
    const double upper = upper_mid(n, length, renewal);
    return two_sided(upper, 1 - upper);
}

Range mean_range(std::size_t n, double length, const Renewal& renewal, double confidence)
{
    const double tail = (1 - confidence) / 2;
    return {mean_where(1 - tail, n, length, renewal), mean_where(tail, n, length, renewal)};
}

double count_variance(double length, const Renewal& renewal)
{
    const double c = renewal.squared_variation, points = length / renewal.mean;
    const double of_renewal = c * points + 1.0 / 6 + c * c / 2 - renewal.third / 3;
    return std::max(1.0 / 6, of_renewal) + renewal.blur;
}

} // namespace jointcreep::statistics
