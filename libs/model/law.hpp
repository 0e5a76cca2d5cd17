// Probability laws of one quantity. A law's mean and deviation are those of the quantity itself, in SI units,
// never of its logarithm.

#pragma once

#include <cmath>
#include <numbers>

namespace jointcreep
{

struct Law {
    enum class Kind { constant, normal, lognormal, negative_exponential, uniform };
    Kind kind = Kind::constant;
    double mean = 0;
    double deviation = 0;       // standard deviation; 0 for a constant, the mean for the negative exponential
    double least = 0, most = 0; // ends of the uniform law
};

// Every value from `least` to `most` as likely as another.
inline Law uniform_law(double least, double most)
{
    return {Law::Kind::uniform, (least + most) / 2, (most - least) / (2 * std::numbers::sqrt3), least, most};
}

// Poles of planes about a mean pole: the density per solid angle at the angle t from it falls as
// exp(concentration cos(t)) (Fisher 1953).
struct FisherLaw {
    double dip;           // of the plane of the mean pole, below the horizontal [rad]
    double dip_direction; // of that plane, clockwise from north [rad]
    double concentration; // > 0; about the inverse square of the angles' scatter in radians [-]
};

} // namespace jointcreep
