// Back analysis: the factors on joint constants and in-situ stress that fit measured displacements.
//
// Each evaluation is an analysis from the in-situ state to the scene's end, with sensitivities found along
// with it (libs/sensitivity); least squares (libs/estimation) over the factors' logarithms. Or by an ensemble, without
// sensitivities: also of joints and rock that have none.

#pragma once

#include "analysis/analysis.hpp"
#include "estimation/ensemble.hpp"
#include "estimation/instrument.hpp"
#include "estimation/profile.hpp"
#include "scene/measurements.hpp"

namespace jointcreep::back_analysis
{

struct Factor {
    Scaled scaled;
    double start = 1, low = 0.05, high = 20; // [-]
    std::string material{}; // name of the joint material that `scaled` is of; empty: as it says
};

struct Settings {
    std::vector<Factor> factors;
    // Measurements count from each point's first reading, not from the start. It has been subtracted from all
    // displacements of a point in a direction, so that all of them have its error.
    bool since_first_reading = false;
    // Of the measurements. Not offsets, robust weights or lasting errors together with since_first_reading, and not
    // both of the latter two.
    estimation::Errors errors{};
    int threads = 1;
    int most_runs = 60;             // of the search
    bool profile_intervals = false; // by 10 to 90 more runs for each factor as a rule
    int most_profile_runs = 60;     // for an end of an interval; a factor has four
    // By an ensemble. The factors' bounds are then the 95 percent interval of a normal prior of the logarithm. Measurements need
    // deviations; not with robust weights, lasting errors or profile intervals.
    std::optional<estimation::EnsembleSearch> ensemble{};
};

struct Computed {
    double at_start, at_end; // at the factors that the search started from, and at those found [m]
};

// The readings of a point in a direction.
struct Series {
    std::size_t point;
    int component; // 0 x, 1 y
};

// A run that had no answer: no equilibrium, or a creep step that is too long for its constants.
struct WithoutAnswer {
    std::vector<double> factors;
    std::string reason;
};

struct Found {
    std::vector<double> factors;
    // Over logarithms; residuals over deviations, or over 1 mm where there are none, made independent where they
    // share a first reading's error. With an ensemble `at_bound` is where readings and prior disagree: the readings shift the mean
    // by more than the 95 percent that the prior allows (estimation::disagreement), to lower or higher values.
    estimation::Minimum minimum;
    estimation::Confidence confidence;
    // Of the factors' logarithms, where they are asked for and the search has converged; the runs that they took.
    std::vector<estimation::Profile> profiles;
    int profile_runs = 0;
    // Where a profile has a smaller sum of squares than the minimum: the search has ended at another minimum. No factor then has an
    // interval, and none is resolved.
    std::optional<estimation::Better> better;
    int members = 0;                // of the ensemble, if it was searched by one
    std::string failure;            // of the ensemble, why its search ended early; empty: it did not
    std::vector<Computed> computed; // of the measurements
    // Error of linear interpolation between the steps of the analysis, by estimate [m].
    std::vector<double> interpolation_error;
    std::vector<WithoutAnswer> without_answer; // in the search

    // Errors of the measurements. Series are numbered as in `series`, readings are measurements.
    std::vector<Series> series;
    std::vector<estimation::FoundError> errors;
    std::vector<estimation::Outlier> outliers;
    std::vector<estimation::Doubt> doubts;
    double correlation_time = 0;    // of lasting errors [s]
    bool is_settled = true;         // else weights or correlation change with every repetition
    std::vector<double> instrument; // what errors add to `computed`, of the measurements [m]
    std::vector<bool>
        is_resolved; // factors that the measurements know better than by a factor of 10 up and down
    // With an ensemble: factors of which the measurements alone know less than the bounds; else empty.
    std::vector<bool> is_by_bounds;

    // 95 percent of a factor's logarithm, by itself or with all: by its profile if there is one, else by its standard error.
    estimation::Interval interval(std::size_t factor, bool with_all = false) const;
};

// Called before every run, with its factors.
using RunObserver = std::function<void(int run, const std::vector<double>& factors)>;

// Throws input_error where the measurements are not of what the section has (removed rock, times before a first
// reading, a first reading that is not 0), where they are not more than factors and unknown errors of instruments, and
// where no factor changes any of them. Throws equilibrium_error where
// there is no equilibrium at the start. Elsewhere the search avoids factors without equilibrium, and factors with
// which the scene's creep step is not stable. Anything else that a run refuses ends the search.
Found fit(const Scene& scene, const Network& network, const EquivalentJoints& joints,
          const std::vector<scene::Measurement>& measurements, const Settings& settings,
          const RunObserver& observe = {});

// A run of a section: its history, and the sensitivities of its displacements, [factor][time, point]: per unit of the
// factor's logarithm [m].
struct Run {
    History history;
    std::vector<std::vector<Eigen::Vector2d>> sensitivities;
};
// What a section does by factors.
using Section = std::function<Run(const std::vector<double>& factors)>;
// By an analysis, whose scene and network must outlive it.
Section section_of(const Scene& scene, const Network& network, const EquivalentJoints& joints,
                   const Settings& settings);
// The fit above, of what the section does.
Found fit(const Scene& scene, const Section& section, const std::vector<scene::Measurement>& measurements,
          const Settings& settings, const RunObserver& observe = {});

// The measurements as an analysis computes them [m], and their sensitivities, [measurement, parameter].
struct Prediction {
    std::vector<double> displacement;
    estimation::MatrixXd sensitivity;
    std::vector<double> interpolation_error; // as in Found
};
Prediction predict(const Scene& scene, const History& history,
                   const std::vector<std::vector<Eigen::Vector2d>>& sensitivities,
                   const std::vector<scene::Measurement>& measurements, bool since_first_reading);

} // namespace jointcreep::back_analysis
