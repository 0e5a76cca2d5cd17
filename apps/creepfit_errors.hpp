// Errors of instruments (estimation/instrument.hpp): the options that ask for them, and what was found.

#pragma once

#include "program.hpp"

#include "estimation/instrument.hpp"

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace jointcreep::creepfit
{

std::vector<Option> error_options();
// What the options ask for. Throws input_error.
estimation::Errors errors_in(const Arguments& arguments);
// Days separated by commas, as times [s]. Throws input_error.
std::vector<double> steps_in(const std::string& text);

// Why there is no fit where weights or correlation change with every repetition, and what to do.
inline constexpr std::string_view not_settled =
    "weights of readings, or their correlation, change with every repetition of the fit\nexpected no --robust or "
    "--correlated-noise, fewer factors, or readings without those that cannot be right";

// What a fit found, and how its series and readings are called: "A, y" and "A, y on day 12".
struct ErrorsFound {
    const std::vector<estimation::FoundError>& errors;
    const std::vector<estimation::Outlier>& outliers;
    const std::vector<estimation::Doubt>& doubts;
    double correlation_time; // [s]
    const estimation::Confidence& confidence;
    std::function<std::string(std::size_t series)> series;
    std::function<std::string(std::size_t reading)> reading;
};

// "step on day 12, A, y", and its unit: "mm" or "mm/day", of which SI has `in_si`.
struct ErrorWords {
    std::string name, unit;
    double in_si;
};
ErrorWords words_of(const estimation::FoundError& error, const std::string& series);

// Lines for offsets, drifts and steps found; and for outliers and lasting errors, where they were asked for.
void add_errors(Summary& summary, const ErrorsFound& found);
void add_outliers_and_lasting(Summary& summary, const ErrorsFound& found, const estimation::Errors& asked);
// Warns where the residuals are no noise.
void warn_of_doubts(Summary& summary, const ErrorsFound& found);
constexpr double bad_fit = 0.01; // p-value of a chi squared that is warned of
// Whether there is such a warning: the model or the noise is not right.
bool is_doubtful(const ErrorsFound& found);

} // namespace jointcreep::creepfit
