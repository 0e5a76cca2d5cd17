#include "sampling/laws.hpp"

#include "model/error.hpp"

#include <boost/random/exponential_distribution.hpp>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_01.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace jointcreep
{

namespace
{

constexpr int most_tries = 10000;

double draw_normal(double mean, double deviation, Stream& stream)
{
    return mean + deviation * boost::random::normal_distribution<double>()(stream);
}

// Of the normal law that a lognormal quantity's logarithm follows.
struct LogParameters {
    double mean, deviation;
};

LogParameters log_parameters(const Law& law)
{
    const double ratio = law.deviation / law.mean;
    const double variance = std::log1p(ratio * ratio);
    return {std::log(law.mean) - variance / 2, std::sqrt(variance)};
}

[[noreturn]] void refuse(const Law& law)
{
    throw input_error("a law of mean " + shown(law.mean) + " and deviation " + shown(law.deviation) +
                      " has next to no values above 0, which a length or spacing has to be");
}

// By the inverse of its distribution function, (1 - t^q) / (1 - r^q) with q = 1 - exponent, t = x / least and
// r = most / least.
double draw_power(double exponent, double least, double most, Stream& stream)
{
    const double q = 1 - exponent, range = std::log(most / least), u = uniform(stream);
    const double logarithm = q == 0 ? u * range : std::log1p(u * std::expm1(q * range)) / q;
    return std::clamp(least * std::exp(logarithm), least, most);
}

// The density x exp(-(x - mean)^2 / (2 deviation^2)) has its mode at the positive root m of
// m^2 - mean m - deviation^2 = 0. Because x <= m exp(x/m - 1) it lies under a multiple of the normal density
// of mean m, from which values are taken with probability x/m exp(1 - x/m).
double draw_size_biased_normal(const Law& law, Stream& stream)
{
    const double mode = (law.mean + std::hypot(law.mean, 2 * law.deviation)) / 2;
    if (mode > 0)
        for (int i = 0; i < most_tries; ++i) {
            const double x = draw_normal(mode, law.deviation, stream);
            if (uniform(stream) < x / mode * std::exp(1 - x / mode))
                return x;
        }
    refuse(law);
}

} // namespace

double uniform(Stream& stream)
{
    return boost::random::uniform_01<double>()(stream);
}

double draw_exponential(double mean, Stream& stream)
{
    return mean * boost::random::exponential_distribution<double>()(stream);
}

double draw(const Law& law, Stream& stream)
{
    switch (law.kind) {
    case Law::Kind::constant:
        break;
    case Law::Kind::normal:
        return draw_normal(law.mean, law.deviation, stream);
    case Law::Kind::lognormal: {
        const LogParameters log = log_parameters(law);
        return std::exp(draw_normal(log.mean, log.deviation, stream));
    }
    case Law::Kind::negative_exponential:
        return draw_exponential(law.mean, stream);
    case Law::Kind::uniform:
        return law.least + uniform(stream) * (law.most - law.least);
    case Law::Kind::power:
        return draw_power(law.exponent, law.least, law.most, stream);
    }
    return law.mean;
}

// The angle t from the mean pole has, with u uniform, cos(t) = 1 + ln(1 - u (1 - exp(-2 kappa))) / kappa
// (Fisher, Lewis, Embleton: Statistical analysis of spherical data, 1987). 1 - cos(t) keeps its figures where
// kappa is large.
Eigen::Vector3d draw_fisher(const Eigen::Vector3d& mean, double concentration, Stream& stream)
{
    const double w =
        std::min(2.0, -std::log1p(uniform(stream) * std::expm1(-2 * concentration)) / concentration);
    const double sine = std::sqrt(w * (2 - w)), turn = 2 * std::numbers::pi * uniform(stream);
    Eigen::Index least = 0;
    mean.cwiseAbs().minCoeff(&least);
    const Eigen::Vector3d first = mean.cross(Eigen::Vector3d::Unit(least)).normalized(),
                          second = mean.cross(first);
    return (1 - w) * mean + sine * (std::cos(turn) * first + std::sin(turn) * second);
}

double draw_positive(const Law& law, Stream& stream)
{
    for (int i = 0; i < most_tries; ++i)
        if (const double x = draw(law, stream); x > 0)
            return x;
    refuse(law);
}

double mean_of_positive(const Law& law)
{
    if (law.kind != Law::Kind::normal || law.deviation == 0)
        return law.mean;
    const double a = law.mean / law.deviation;
    const double density = std::exp(-a * a / 2) / std::sqrt(2 * std::numbers::pi);
    const double above = std::erfc(-a / std::numbers::sqrt2) / 2;
    return law.mean + law.deviation * density / above;
}

double draw_size_biased(const Law& law, Stream& stream)
{
    switch (law.kind) {
    case Law::Kind::constant:
        break;
    case Law::Kind::normal:
        return draw_size_biased_normal(law, stream);
    case Law::Kind::lognormal: {
        const LogParameters log = log_parameters(law);
        return std::exp(draw_normal(log.mean + log.deviation * log.deviation, log.deviation, stream));
    }
    case Law::Kind::negative_exponential: { // gamma of shape 2
        const double first = draw_exponential(law.mean, stream);
        return first + draw_exponential(law.mean, stream);
    }
    case Law::Kind::uniform: {
        const double least2 = law.least * law.least, most2 = law.most * law.most;
        return std::sqrt(least2 + uniform(stream) * (most2 - least2));
    }
    case Law::Kind::power:
        return draw_power(law.exponent - 1, law.least, law.most, stream);
    }
    return law.mean;
}

} // namespace jointcreep
