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
    double tolerance = 0; // a sum of squares below the least one by more than this is a better minimum's [-]
    int most_runs = 60;   // calls of the model for an end
};

// Parameters with a smaller sum of squares than the minimum has, so that it is not the least.
struct Better {
    VectorXd parameters;
    double sum_of_squares;
};

struct ProfileEnd {
    double at;                      // of the parameter
    std::optional<double> beyond{}; // where runs were too few: `at` is infinite, and the end is beyond this
    std::optional<Better> better{}; // where one was found: `at` is infinite
};

// One end of an interval: where the profile of parameter i, over the others within their bounds, reaches `limit`, on that side of the
// minimum on which the guess is. It is infinite where the profile is below the limit up to the parameter's bound or to `widest`, and where
// the model has no answer, or no minimum over the others is found, or calls of the model are too few, before it reaches the limit.
ProfileEnd profile_end(const Model& model, const VectorXd& minimum, double least_sum, double limit,
                       Eigen::Index i, const VectorXd& guess, const Bounds& bounds,
                       const ProfileSearch& search);

// An end that was not found with the most runs, and is infinite.
struct NotFound {
    bool is_high, is_with_all;
    double beyond; // the end is
};

struct Profile {
    Interval interval, with_all; // 95 percent, by itself and all parameters together
    std::vector<NotFound> not_found{};
};

struct Profiles {
    std::vector<Profile> of_each; // parameter
    std::optional<Better> better{};
};

// Of all parameters around a minimum that was found within these bounds. A parameter without effect has infinite intervals. One at a
// bound has an interval too, with the noise that it would have were it free: its profile rises from the bound at least as fast as from a
// minimum, so that the interval is not too short. Intervals of all together are as many as there are parameters with an effect
// (Bonferroni: Miller, Simultaneous Statistical Inference, 1981, section 1.3).
//
// Where a profile is less than the least sum by more than a minimum may be off, a tenth of a standard error, the search ends, all
// intervals are infinite, and `better` is where that is.
Profiles profiles(const Model& model, const Minimum& minimum, const Confidence& confidence,
                  const Bounds& bounds, int most_runs = ProfileSearch{}.most_runs);

} // namespace jointcreep::estimation
