// Probability laws of one quantity. A law's mean and deviation are those of the quantity itself, in SI units,
// never of its logarithm.

#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

namespace jointcreep
{

// Values in the unit of what the law is of: m of lengths and spacings, rad of angles.
struct ProbabilityLaw {
    enum class Kind { constant, normal, lognormal, negative_exponential, uniform, power };
    Kind kind = Kind::constant;
    double mean = 0;
    double deviation = 0;       // standard deviation; 0 for a constant, the mean for the negative exponential
    double least = 0, most = 0; // ends of the uniform and the power law
    double exponent = 0;        // of the power law, whose density falls as x^-exponent [-]
};

// Every value from `least` to `most` as likely as another.
inline ProbabilityLaw uniform_law(double least, double most)
{
    return {ProbabilityLaw::Kind::uniform, (least + most) / 2, (most - least) / (2 * std::numbers::sqrt3),
            least, most};
}

// E[(x / least)^order] by the power law, from the integral of t^q / t over t from 1 to most / least, which is
// expm1(q log(most / least)) / q. 0 < least < most.
inline double power_moment(double exponent, double least, double most, double order)
{
    const double range = std::log(most / least);
    const auto integral = [range](double q) { return q == 0 ? range : std::expm1(q * range) / q; };
    return integral(order + 1 - exponent) / integral(1 - exponent);
}

// A density that falls as x^-exponent from `least` to `most`, cut off at both; 0 < least < most. (The number
// of values above x then falls as x^(1 - exponent), far from the cut-offs.)
inline ProbabilityLaw power_law(double exponent, double least, double most)
{
    const double first = power_moment(exponent, least, most, 1),
                 second = power_moment(exponent, least, most, 2);
    const double variance = std::max(0.0, second - first * first);
    return {ProbabilityLaw::Kind::power, least * first, least * std::sqrt(variance), least, most, exponent};
}

// Poles of planes about a mean pole: the density per solid angle at the angle t from it falls as
// exp(concentration cos(t)) (Fisher 1953).
struct FisherLaw {
    double dip;           // of the plane of the mean pole, below the horizontal [rad]
    double dip_direction; // of that plane, clockwise from north [rad]
    double concentration; // > 0; about the inverse square of the angles' scatter in radians [-]
};

} // namespace jointcreep
