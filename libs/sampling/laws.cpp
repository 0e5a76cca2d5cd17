#include "sampling/laws.hpp"

#include "model/error.hpp"

#include <boost/random/exponential_distribution.hpp>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/poisson_distribution.hpp>
#include <boost/random/uniform_01.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace jointcreep::sampling
{

namespace
{

constexpr int most_tries = 10000;

double draw_normal(double mean, double deviation, Stream& stream)
{
    return mean + deviation * boost::random::normal_distribution<double>()(stream);
}

// The normal law of a lognormal quantity's logarithm.
struct LogParameters {
    double mean, deviation;
};

LogParameters log_parameters(const ProbabilityLaw& law)
{
    const double ratio = law.deviation / law.mean;
    const double variance = std::log1p(ratio * ratio);
    return {std::log(law.mean) - variance / 2, std::sqrt(variance)};
}

[[noreturn]] void refuse(const ProbabilityLaw& law)
{
    throw input_error("a law of mean " + shown(law.mean) + " and deviation " + shown(law.deviation) +
                      " has next to no values above 0, which a length or spacing has to be");
}

double power(double x, int order)
{
    double product = 1;
    for (int i = 0; i < order; ++i)
        product *= x;
    return product;
}

// A draw by the inverse of the distribution function, (1 - t^q) / (1 - r^q) with q = 1 - exponent, t = x / least and
// r = most / least.
double draw_power(double exponent, double least, double most, Stream& stream)
{
    const double q = 1 - exponent, range = std::log(most / least), u = uniform(stream);
    const double logarithm = q == 0 ? u * range : std::log1p(u * std::expm1(q * range)) / q;
    return std::clamp(least * std::exp(logarithm), least, most);
}

// The density x^n exp(-(x - mean)^2 / (2 deviation^2)) has its mode at the positive root m of
// m^2 - mean m - n deviation^2 = 0. Because x <= m exp(x/m - 1) it lies under a multiple of the normal
// density of mean m, from which values are taken with probability (x/m exp(1 - x/m))^n.
double draw_biased_normal(const ProbabilityLaw& law, int order, Stream& stream)
{
    const double mode = (law.mean + std::hypot(law.mean, 2 * std::sqrt(order) * law.deviation)) / 2;
    if (mode > 0)
        for (int i = 0; i < most_tries; ++i) {
            const double x = draw_normal(mode, law.deviation, stream);
            const double take = x > 0 ? x / mode * std::exp(1 - x / mode) : 0;
            if (uniform(stream) < power(take, order))
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

std::int64_t draw_poisson(double mean, Stream& stream)
{
    return mean > 0 ? boost::random::poisson_distribution<std::int64_t, double>(mean)(stream) : 0;
}

double draw(const ProbabilityLaw& law, Stream& stream)
{
    switch (law.kind) {
    case ProbabilityLaw::Kind::constant:
        break;
    case ProbabilityLaw::Kind::normal:
        return draw_normal(law.mean, law.deviation, stream);
    case ProbabilityLaw::Kind::lognormal: {
        const LogParameters log = log_parameters(law);
        return std::exp(draw_normal(log.mean, log.deviation, stream));
    }
    case ProbabilityLaw::Kind::negative_exponential:
        return draw_exponential(law.mean, stream);
    case ProbabilityLaw::Kind::uniform:
        return law.least + uniform(stream) * (law.most - law.least);
    case ProbabilityLaw::Kind::power:
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

double draw_positive(const ProbabilityLaw& law, Stream& stream)
{
    for (int i = 0; i < most_tries; ++i)
        if (const double x = draw(law, stream); x > 0)
            return x;
    refuse(law);
}

double mean_of_positive(const ProbabilityLaw& law)
{
    if (law.kind != ProbabilityLaw::Kind::normal || law.deviation == 0)
        return law.mean;
    const double a = law.mean / law.deviation;
    const double density = std::exp(-a * a / 2) / std::sqrt(2 * std::numbers::pi);
    const double above = std::erfc(-a / std::numbers::sqrt2) / 2;
    return law.mean + law.deviation * density / above;
}

double moment_of_positive(const ProbabilityLaw& law, int order)
{
    switch (law.kind) {
    case ProbabilityLaw::Kind::constant:
        break;
    case ProbabilityLaw::Kind::
        normal: { // by parts: E[x^n] = mean E[x^(n-1)] + (n - 1) deviation^2 E[x^(n-2)], n > 1
        double before = 1, moment = mean_of_positive(law);
        if (order == 0)
            return 1;
        for (int n = 2; n <= order; ++n)
            before =
                std::exchange(moment, law.mean * moment + (n - 1) * law.deviation * law.deviation * before);
        return moment;
    }
    case ProbabilityLaw::Kind::lognormal: {
        const LogParameters log = log_parameters(law);
        return std::exp(order * (log.mean + order * log.deviation * log.deviation / 2));
    }
    case ProbabilityLaw::Kind::negative_exponential:
        return power(law.mean, order) * std::tgamma(order + 1);
    case ProbabilityLaw::Kind::uniform: { // (b^(n+1) - a^(n+1)) / (b - a) = sum of a^i b^(n-i)
        double sum = 0;
        for (int i = 0; i <= order; ++i)
            sum += power(law.least, i) * power(law.most, order - i);
        return sum / (order + 1);
    }
    case ProbabilityLaw::Kind::power:
        return power(law.least, order) * power_moment(law.exponent, law.least, law.most, order);
    }
    return power(law.mean, order);
}

double draw_size_biased(const ProbabilityLaw& law, Stream& stream)
{
    return draw_biased(law, 1, stream);
}

double draw_biased(const ProbabilityLaw& law, int order, Stream& stream)
{
    if (order == 0)
        return draw_positive(law, stream);
    switch (law.kind) {
    case ProbabilityLaw::Kind::constant:
        break;
    case ProbabilityLaw::Kind::normal:
        return draw_biased_normal(law, order, stream);
    case ProbabilityLaw::Kind::lognormal: {
        const LogParameters log = log_parameters(law);
        return std::exp(
            draw_normal(log.mean + order * (log.deviation * log.deviation), log.deviation, stream));
    }
    case ProbabilityLaw::Kind::negative_exponential: { // gamma of shape order + 1
        double sum = 0;
        for (int i = 0; i <= order; ++i)
            sum += draw_exponential(law.mean, stream);
        return sum;
    }
    case ProbabilityLaw::Kind::uniform: {
        const double least = power(law.least, order + 1), most = power(law.most, order + 1);
        const double x = least + uniform(stream) * (most - least);
        return order == 1 ? std::sqrt(x) : std::pow(x, 1. / (order + 1));
    }
    case ProbabilityLaw::Kind::power:
        return draw_power(law.exponent - order, law.least, law.most, stream);
    }
    return law.mean;
}

} // namespace jointcreep::sampling
