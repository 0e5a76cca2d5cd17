// One fit from several models that are draws of the same kind, as joint networks of one scene are.
//
// Measurements are of a further draw, which none of the models is. Let each model j give the parameters p_j from the same
// readings. To first order p_j is the truth plus what the measured draw does, less what draw j does. Over K models
//     p = mean of p_j,     variance = S (1 + 1/K) + N ,
// S the variance of the p_j and N the mean variance by noise: by the readings' deviations where they are known, because
// that a fit is worse than these allow is what the draws do, else by the residuals. An interval's half width is t_(K-1) sqrt(S (1 + 1/K)) and
// t sqrt(N), their squares added.

#pragma once

#include "estimation/confidence.hpp"

#include <optional>
#include <vector>

namespace jointcreep::estimation
{

// The fit of one model: parameters, and what is known of them.
struct OfOneModel {
    VectorXd parameters;
    Confidence confidence;
};

struct Across {
    double value;                // of the parameter
    double scatter;              // standard deviation between models
    double standard_error;       // with noise
    Interval interval, with_all; // 95 percent, by itself and all parameters together
};

// Of each parameter; nothing where a model has it fixed. Two models at least.
std::vector<std::optional<Across>> across(const std::vector<OfOneModel>& models, bool deviations_are_known);

} // namespace jointcreep::estimation
