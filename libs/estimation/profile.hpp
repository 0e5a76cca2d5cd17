// Profile intervals of parameters found by nonlinear least squares.
//
// The profile of a parameter is the least sum of squares over all other parameters, with this one fixed. Its interval of 95 percent
// has the values at which the profile exceeds the least sum of all by no more than (q s)^2: q is the number of standard errors in an
// interval, s the noise factor (confidence.hpp). Venzon and Moolgavkar, Applied Statistics 37 (1988); Bates and Watts, Nonlinear
// Regression Analysis and Its Applications (1988), section 6.1. For a linear model it is the interval by the standard error.

#pragma once

#include "estimation/confidence.hpp"

namespace jointcreep::estimation
{

struct Bounds {
    VectorXd low, high; // of all parameters
};

struct ProfileSearch {
    double share = 0.01;      // of q s, to which the profile of an end is met [-]
    double widest = 7;        // an end farther away is infinite: a factor of 1000 of a logarithm
    double least_gain = 1e-3; // steps of the other parameters that gain less of (q s)^2 are not taken [-]
};

// One end of an interval: where the profile of parameter i, over the others within their bounds, reaches `limit`, on that side of the
// minimum on which the guess is. It is infinite where the profile is below the limit up to the parameter's bound or to `widest`, and where
// the model has no answer, or no minimum over the others is found, before it reaches the limit.
double profile_end(const Model& model, const VectorXd& minimum, double least_sum, double limit,
                   Eigen::Index i, const VectorXd& guess, const Bounds& bounds, const ProfileSearch& search);

struct Profile {
    Interval interval, with_all; // 95 percent, by itself and all parameters together
};

// Of all parameters around a minimum that was found within these bounds. A parameter without effect has infinite intervals.
std::vector<Profile> profiles(const Model& model, const Minimum& minimum, const Confidence& confidence,
                              const Bounds& bounds);

} // namespace jointcreep::estimation
