// Distributions of the laws that joints are drawn from, and the tests that ask a sample whether it follows
// one. Boost.Math has the standard ones.

#pragma once

#include "model/probability_law.hpp"

#include <cstddef>
#include <vector>

namespace jointcreep::statistics
{

// P(X <= x) of the law as it is: angles.
double distribution(const ProbabilityLaw& law, double x);

// P(X <= x) of the law's values above 0, as lengths and spacings are drawn.
double positive_distribution(const ProbabilityLaw& law, double x);

// The value below which X lies with the probability p, 0 < p < 1; of the laws of angles: constant, normal and
// uniform.
double quantile(const ProbabilityLaw& law, double p);

// Fourth central moment over the square of the second; of the laws of angles: normal and uniform.
double kurtosis(const ProbabilityLaw& law);

// Moments of the law's values above 0.
struct Moments {
    double mean;              // in the unit of the values
    double squared_variation; // variance / mean^2 [-]
    double third;             // third central moment / mean^3 [-]
};
Moments positive_moments(const ProbabilityLaw& law);

// How well a sample fits that by its law is uniform in [0, 1], by Kolmogorov and Smirnov; and one on a circle
// of circumference 1, by Kuiper. Limit distributions with the correction of Stephens 1970 for small samples.
struct Fit {
    double distance; // the largest between the two distributions; Kuiper: above plus below [-]
    double p_value;  // [-]
};
Fit kolmogorov_smirnov(std::vector<double> uniforms);
Fit kuiper(std::vector<double> uniforms);

// Two-sided p-values.
double normal_p(double deviate);
double student_p(double t, double degrees);
double chi_squared_p(double value, double degrees);
double fisher_f_p(double value, double degrees_above, double degrees_below); // upper tail only
double chi_squared_above(double value, double degrees);                      // upper tail only

// Where the upper tail has the probability p.
double student_quantile(double p, double degrees);
double chi_squared_quantile(double p, double degrees);
double fisher_f_quantile(double p, double degrees_above, double degrees_below);

// How many points of a stationary renewal process lie on a scanline.
struct Renewal {
    double mean;              // of the intervals [m]
    double squared_variation; // of the intervals: variance / mean^2 [-]
    double third;             // third central moment / mean^3 [-]
    double blur = 0;          // variance of the count by points that move across the scanline's ends [-]
};

// P(at least n points on `length`), n >= 1: that the n-th point comes before the end. The sum of the
// intervals up to it is taken to be gamma distributed, which is exact for negative exponential intervals. The
// first one is a remaining one: its mean and variance are the stationary process's (Cox 1962).
double at_least(double n, double length, const Renewal& renewal);

// Two-sided mid-p-value of a count, and the interval of means with p-values above 1 - confidence.
double count_p(std::size_t n, double length, const Renewal& renewal);
struct Range {
    double low, high;
};
Range mean_range(std::size_t n, double length, const Renewal& renewal, double confidence);

// Variance of the count: (sigma/mu)^2 t/mu + 1/6 + (sigma/mu)^4/2 - third/3 for t much longer than an interval (Cox
// 1962, section 4.5).
double count_variance(double length, const Renewal& renewal);

} // namespace jointcreep::statistics
