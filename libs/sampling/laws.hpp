// Draws from the probability laws of a scene (model/probability_law.hpp).

#pragma once

#include "model/probability_law.hpp"
#include "sampling/streams.hpp"

#include <Eigen/Core>

namespace jointcreep::sampling
{

// Uniform in [0, 1).
double uniform(Stream& stream);

// Negative exponential of the given mean, > 0.
double draw_exponential(double mean, Stream& stream);

// Poisson of the given mean, >= 0.
std::int64_t draw_poisson(double mean, Stream& stream);

// A draw from the law as it is, in the law's unit.
double draw(const ProbabilityLaw& law, Stream& stream);

// A draw from the law's values above 0, as lengths and spacings have to be: the lower tail of a normal law is drawn
// again. Throws input_error if the law has next to no values above 0.
double draw_positive(const ProbabilityLaw& law, Stream& stream);

// E[x^order] of draw_positive; order 0 to 4.
double moment_of_positive(const ProbabilityLaw& law, int order);

// Mean of draw_positive. It is the law's own but for a normal law, which loses its lower tail: it is 1e-4
// higher where the deviation is 0.27 times the mean, 3 percent at 0.5.
double mean_of_positive(const ProbabilityLaw& law);

// A unit vector by Fisher's law about the unit vector `mean`; every turn about it is as likely as another.
// concentration > 0.
Eigen::Vector3d draw_fisher(const Eigen::Vector3d& mean, double concentration, Stream& stream);

// A draw from the density x f(x) / mean, f being the density of values above 0: the length of the interval that
// contains a random point of a line made of such intervals.
double draw_size_biased(const ProbabilityLaw& law, Stream& stream);

// A draw from the density x^order f(x) / E[x^order]; order 0 is draw_positive, order 1 draw_size_biased.
double draw_biased(const ProbabilityLaw& law, int order, Stream& stream);

} // namespace jointcreep::sampling
