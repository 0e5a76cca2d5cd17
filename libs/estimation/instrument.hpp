// What real readings have beside the model and independent normal errors: unknown zeros of instruments, steps, drift,
// outliers, and errors that last.
//
// Offsets, steps and drift are linear: a reading of series s at time t is
//     d(t) + o_s + r_s (t - t_s) + sum over the given times T with T <= t of j_sT + error,
// t_s the first time of the series. With the columns N of these unknowns, residuals and derivatives are multiplied by
// the rows of an orthogonal matrix that are perpendicular to N: the sum of squares is then the least over the unknowns,
// whatever the other parameters, and there are as many residuals as readings less unknowns.
//
// Robust: readings have weights by Tukey's biweight (zero beyond 4.685 scales), found by repeated least squares. The scale
// is the median of the sizes of residuals over .6745, by Huber's weights (1.345) before. A reading of the weight 0
// counts as missing. Intervals are by Huber's pseudo-values s psi(e / s) / mean psi' (Robust Statistics, 1981, 7.6).
//
// Lasting errors: within a series the correlation is exp(-|t - t'| / T), which is autoregressive of order 1 with any
// times. T is by restricted maximum likelihood. Intervals contain that T is not known: they average over the correlation
// of readings at the median distance in time, taken as equally likely between 0 and 1 beforehand.

#pragma once

#include "estimation/confidence.hpp"

#include <cstddef>
#include <vector>

namespace jointcreep::estimation
{

struct Readings {
    std::vector<double> time{};        // [s]
    std::vector<std::size_t> series{}; // of one instrument in one direction: numbers from 0
    std::vector<double> deviation{};   // what residuals are divided by [m]
    bool knows_deviations = false;
    // Deviation of an error that the series has in all its readings, over that of the reading; empty: none [-]. Readings
    // that count from a first one share its error.
    std::vector<double> shared{};
};

struct Errors {
    bool offset = false, drift = false;
    std::vector<double> steps{}; // times [s]
    bool robust = false, correlated = false;

    bool any() const { return offset || drift || robust || correlated || !steps.empty(); }
};

enum class Error { offset, drift, step, single, lasting };

// An error that was looked for, with its 95 percent.
struct FoundError {
    Error kind; // offset, drift or step
    std::size_t series;
    double time;       // of a step [s]
    double value;      // [m]; of a drift [m/s]
    Interval interval; // in the same unit
};

struct Outlier {
    std::size_t reading;
    double residual; // computed less measured, over the noise [-]
};

// An error that residuals look like, though it was not looked for: the most significant one of its kind.
struct Doubt {
    Error kind;
    std::size_t series = 0;  // not of lasting errors
    double time = 0;         // of a step [s]
    std::size_t reading = 0; // a single one
    double value = 0;        // [m], of a drift [m/s]; of lasting errors the correlation of neighbours [-]
    double p_value = 1;      // that chance makes any error look so significant [-]
};

class Instruments
{
public:
    // Throws input_error where a step has no series with readings before and after it.
    Instruments(Readings readings, Errors errors);

    // How many unknown errors there are. Those that others of their series contain do not count.
    std::size_t unknowns() const { return unknowns_.size(); }

    // From residuals (model less reading, over deviations) to independent ones without the unknown errors.
    Evaluation independent(const Evaluation& raw) const;

    // Weights and correlation from the residuals at a minimum of independent(). Whether they have changed, so that the
    // minimum must be found again.
    bool update(const Evaluation& raw, const std::vector<AtBound>& at_bound);

    // At the minimum of independent(), where no update() is wanted any more.
    Confidence confidence(const Evaluation& raw, const Minimum& minimum) const;
    std::vector<FoundError> errors(const Evaluation& raw, const Confidence& confidence) const;
    // What must be added to the model by the errors found, of each reading [m].
    std::vector<double> added(const Evaluation& raw) const;
    // Residuals of more than 4 scales, where weights are robust.
    std::vector<Outlier> outliers(const Evaluation& raw) const;
    // Time in which the correlation of lasting errors falls by e, 0 if they are independent [s].
    double correlation_time() const { return correlation_time_; }
    // Whether confidence() has more than the minimum has.
    bool changes_errors() const { return errors_.robust || errors_.correlated; }
    // Reasons to doubt that residuals are noise: those with a p-value below `significance`, the smallest first.
    // Each offset, drift, step and single error that the model lacks is tested by Student's t. Its p-value is multiplied by
    // the number of such tests. Neighbouring residuals of a series are tested for correlation, with the moments of Durbin and
    // Watson (Biometrika 1950).
    std::vector<Doubt> doubts(const Evaluation& raw, const Minimum& minimum,
                              double significance = 0.01) const;

private:
    struct Unknown {
        Error kind;
        std::size_t series;
        double time;
    };
    MatrixXd weighted(const MatrixXd& columns) const;
    MatrixXd whitened(MatrixXd columns, double correlation_time) const;
    VectorXd column_of(const Unknown& unknown) const;
    bool separates(const std::vector<std::size_t>& series, double time) const;
    std::vector<std::size_t> kept() const;
    MatrixXd effects(const Evaluation& raw, const std::vector<bool>& is_free) const;
    bool update_weights(const Evaluation& raw, const std::vector<bool>& is_free);
    // Of each correlation: its share of the likelihood.
    VectorXd likelihood(const Evaluation& raw, const std::vector<bool>& is_free) const;
    // Of each parameter that moves, with lasting errors.
    VectorXd variance_if_free(const Evaluation& raw, const std::vector<bool>& is_moving) const;

    Readings readings_;
    Errors errors_;
    std::vector<std::vector<std::size_t>> series_; // readings of each, by time
    std::vector<Unknown> unknowns_;
    MatrixXd unknown_columns_;  // [reading, unknown]
    VectorXd weight_;           // of readings [-]
    double scale_ = 1;          // robust, of residuals over deviations [-]
    std::vector<double> times_; // of correlation that are tried; the first is 0 [s]
    double correlation_time_ = 0;
};

// The minimum by a model of raw residuals, with repetitions for weights and correlation. The model is called once for
// the same parameters.
struct InstrumentFit {
    Minimum minimum;        // of independent residuals
    Evaluation raw;         // at the minimum
    bool is_settled = true; // else weights or correlation change with every repetition: not converged
};
InstrumentFit minimise(const Model& raw, Instruments& instruments, const VectorXd& start, const VectorXd& low,
                       const VectorXd& high, int most_evaluations, double relative);

} // namespace jointcreep::estimation
