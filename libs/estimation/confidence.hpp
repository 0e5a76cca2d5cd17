// Confidence in parameters found by least squares.
//
// Assumed: the model is right, and readings have independent normal errors, with the standard deviations that
// residuals were divided by times one factor. The factor is either 1, the deviations being known, or found
// from the residuals, s^2 = sum of squares / (readings - parameters). With the Jacobian J at the minimum the
// parameters then have nearly a normal distribution, of the covariance s^2 (J^T J)^-1, and intervals are by
// Student's t where s was found from residuals. Where deviations are known and the fit is worse than chance
// allows (p below 0.05 by chi squared), s is taken from the residuals all the same: intervals become wider.

#pragma once

#include "estimation/least_squares.hpp"

#include <limits>
#include <string>

namespace jointcreep::estimation
{

struct Interval {
    double low, high; // in the unit of the estimate
};

struct Confidence {
    Eigen::Index readings = 0, parameters = 0; // the latter that are free
    double sum_of_squares = 0;                 // chi squared where deviations are known [-]
    double p_value = 1;                        // of so much or more; 1 where deviations are not known [-]
    double noise_factor = 1;                   // s [-]
    bool is_noise_from_residuals = false;

    MatrixXd covariance;  // of all parameters; those at a bound, or without effect, have none: 0
    MatrixXd correlation; // the same
    std::vector<bool> is_fixed;
    VectorXd
        error_if_free; // standard errors, also of parameters at a bound, as if they were free there; 0 without effect

    double quantile = 0; // standard errors on each side of one parameter's interval of 95 percent [-]
    // Of intervals that hold all together with 95 percent: Bonferroni, over those that there are [-].
    double quantile_all = 0;
    double quantile_of_all(Eigen::Index intervals) const; // of so many intervals [-]

    // For J with its columns scaled to length 1: similar effects on the readings make it small.
    double smallest_eigenvalue = 1; // of their products with each other [-]
    double condition_number = 1;    // of J so scaled [-]

    double standard_error(Eigen::Index i) const;
    // 95 percent, of one parameter by itself or of all together; without bounds where the data have none.
    Interval interval(double value, Eigen::Index i, bool all_together = false) const;
    // Standard error of a quantity with this gradient over the parameters.
    double standard_error(const VectorXd& gradient) const;
};

Confidence confidence_of(const Minimum& minimum, bool deviations_are_known);
// (J^T J)^-1, the covariance where residuals have unit variance. Rows and columns of parameters without effect are 0.
MatrixXd unit_covariance(const MatrixXd& jacobian);
// The same with normal priors of these deviations: no parameter is without an interval. All have been free.
Confidence with_prior(Confidence confidence, const Minimum& minimum, const VectorXd& deviations);

// The combination of free parameters that the data know least, if they know it badly: by less than a factor of 2 up
// and down (parameters are logarithms), or 10 times less than if each parameter were fitted alone
// (smallest_eigenvalue below 0.01).
struct WeakCombination {
    VectorXd direction;    // its largest entry is 1 [-]
    double standard_error; // along it [-]
    bool is_alike_effects; // of several parameters
};
std::optional<WeakCombination> weak_combination(const Minimum& minimum, const Confidence& confidence);

// Which parameters, being logarithms, the data know: their interval of 95 percent is within a factor of 10 up and down,
// were all parameters free, those at a bound, too.
std::vector<bool> resolved(const Minimum& minimum, const Confidence& confidence);

} // namespace jointcreep::estimation
