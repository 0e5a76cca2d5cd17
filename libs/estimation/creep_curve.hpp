// Creep of one joint, from one curve of displacement after one change of load (the paper's Eqs. 11 to 14 and
// its Fig. 12):
//     d(t) = d_e + d_c (1 - exp(-t / tau)),      d_e = F / K,   d_c = F / E,   tau = eta / E .
// With K known,  E = K d_e / d_c,  eta = E tau. d_e is the elastic displacement of the joint. Subtract that
// of the rock beside it before.

#pragma once

#include "estimation/instrument.hpp"

namespace jointcreep::estimation
{

struct CreepCurve {
    std::vector<double> time;             // since the load changed, 0 or later, rising [s]
    std::vector<double> displacement;     // [m]
    std::vector<double> deviation{};      // standard deviations [m]; empty: alike, and not known
    std::optional<double> elastic_part{}; // d_e, where it is known [m]
};

// A value above 0 with its interval of 95 percent, in the same unit.
struct Estimate {
    double value;
    Interval interval;
};

// The fit by least squares over d_e (unless known), d_c and tau. Intervals of tau, E and eta are those of the
// profile: where the least sum of squares with that value fixed exceeds the least of all by no more than
// chance (Student's t, squared). In short records these are far from even; an end may be 0 or infinite.
struct CurveFit {
    double elastic_part, creep_part, retardation_time; // d_e [m], d_c [m], tau [s]
    Interval elastic_interval, creep_interval;         // [m]
    Estimate time;                                     // tau [s]
    Estimate stiffness, viscosity;                     // E / K [-], eta / K [s]
    double correlation;                                // of the logarithms of E and eta [-]
    Confidence confidence;
    std::vector<double> computed; // without errors of the instrument [m]

    // Errors of the instrument; readings are numbered as the curve's.
    std::vector<FoundError> errors;
    std::vector<Outlier> outliers;
    std::vector<Doubt> doubts;
    double correlation_time = 0;    // of lasting errors [s]
    std::vector<double> instrument; // what errors add to `computed` [m]
    bool is_settled = true;         // else weights or correlation change with every repetition: no fit

    // What the record does not give.
    bool is_stiffness_open = false; // E: its interval is wider than a factor of 2 up or down,
    bool is_too_short = false;      // and the record is below 2 tau, so that it need not be the noise
    bool is_too_coarse = false;     // tau: creep is nearly over at the first reading after the load
    double record_length;           // over tau [-]
};

// Throws input_error where the curve is none of creep: not more readings than parameters and unknown errors, or no creep
// in the direction of the elastic part. An offset is the elastic part's: it is wanted only where that is known.
CurveFit fit_curve(const CreepCurve& curve, const Errors& errors = {});

// The paper's estimate: E by Eq. 14 from d(T_c), T_c being when creep is taken to be over; then tau by least
// squares with E fixed. d_e is the known one, or the first reading. Intervals contain the noise of the readings of
// d_e and d(T_c), and of all others in tau. They contain neither creep after T_c nor creep before the first reading.
struct ClosedEstimate {
    double elastic_part, creep_part; // [m]
    double end;                      // T_c [s]
    Estimate stiffness, viscosity;   // E / K [-], eta / K [s]
    double stiffness_error;          // standard error of the logarithm of E [-]
};
ClosedEstimate closed_estimate(const CreepCurve& curve, double end);

} // namespace jointcreep::estimation
