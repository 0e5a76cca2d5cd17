#include "creepfit_errors.hpp"

#include "creepfit_words.hpp"

#include "model/error.hpp"
#include "model/units.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace jointcreep::creepfit
{

using estimation::Doubt;
using estimation::Error;

namespace
{

bool is_worse_than_sigma(const estimation::Confidence& confidence)
{
    return confidence.p_value < bad_fit;
}

std::string words_of_doubt(const Doubt& doubt, const ErrorsFound& found)
{
    const std::string p = " (p " + rounded(doubt.p_value, 2) + ")";
    switch (doubt.kind) {
    case Error::offset:
        return "an offset of " + mm(doubt.value) + " mm of " + found.series(doubt.series) + p;
    case Error::drift:
        return "a drift of " + mm(doubt.value * unit::day) + " mm/day of " + found.series(doubt.series) + p;
    case Error::step:
        return "a step of " + mm(doubt.value) + " mm of " + found.series(doubt.series) + " before day " +
               rounded(doubt.time / unit::day, 6) + p;
    case Error::single:
        return "an outlier of " + mm(doubt.value) + " mm, " + found.reading(doubt.reading) + p;
    case Error::lasting:
        break;
    }
    return "lasting errors, with a correlation of neighbours of " + rounded(doubt.value, 2) + p;
}

} // namespace

std::vector<Option> error_options()
{
    return {
        {"offset", "", "errors of instruments: an unknown zero of every point and direction"},
        {"drift", "", "errors of instruments: an unknown constant rate from the first reading on"},
        {"steps", "DAYS",
         "errors of instruments: an unknown step on each of these days, separated by commas, of all readings of a point "
         "and direction from that day on"},
        {"robust", "", "readings far from the others have less weight, or none, and are named"},
        {"correlated-noise", "",
         "errors of neighbouring readings are alike: their correlation is fitted, too"}};
}

std::vector<double> steps_in(const std::string& text)
{
    std::vector<double> steps;
    std::istringstream days(text);
    for (std::string item; std::getline(days, item, ',') || item.empty();) {
        std::istringstream number(item);
        double day = 0;
        char rest = 0;
        if (!(number >> day) || number >> rest || !(std::abs(day) <= 1e7) || text.ends_with(','))
            throw input_error("--steps is \"" + text +
                              "\"; expected days separated by commas, as in 12,30.5");
        steps.push_back(day * unit::day);
        if (days.eof())
            break;
    }
    std::sort(steps.begin(), steps.end());
    if (const auto twice = std::adjacent_find(steps.begin(), steps.end()); twice != steps.end())
        throw input_error("--steps has day " + shown(*twice / unit::day) + " twice; expected each once");
    return steps;
}

estimation::Errors errors_in(const Arguments& arguments)
{
    estimation::Errors errors{.offset = arguments.has("offset"),
                              .drift = arguments.has("drift"),
                              .robust = arguments.has("robust"),
                              .correlated = arguments.has("correlated-noise")};
    if (errors.robust && errors.correlated)
        throw input_error("--robust and --correlated-noise do not go together; expected one of them");
    if (const auto steps = arguments.text("steps"))
        errors.steps = steps_in(*steps);
    return errors;
}

ErrorWords words_of(const estimation::FoundError& error, const std::string& series)
{
    const std::string of = series.empty() ? "" : ", " + series;
    switch (error.kind) {
    case Error::offset:
        return {"offset" + of, "mm", 1e-3};
    case Error::drift:
        return {"drift" + of, "mm/day", 1e-3 / unit::day};
    default:
        return {"step on day " + rounded(error.time / unit::day, 6) + of, "mm", 1e-3};
    }
}

void add_errors(Summary& summary, const ErrorsFound& found)
{
    for (const estimation::FoundError& error : found.errors) {
        const ErrorWords words = words_of(error, found.series(error.series));
        summary.add(words.name, rounded(error.value / words.in_si) + " (95 %: " +
                                    shown_interval({error.interval.low / words.in_si,
                                                    error.interval.high / words.in_si}) +
                                    ") " + words.unit);
    }
}

void add_outliers_and_lasting(Summary& summary, const ErrorsFound& found, const estimation::Errors& asked)
{
    if (asked.robust)
        summary.add("outliers", found.outliers.empty() ? "none" : std::to_string(found.outliers.size()));
    for (const estimation::Outlier& outlier : found.outliers)
        summary.add("outlier",
                    found.reading(outlier.reading) + ": residual " + rounded(outlier.residual, 3) + " sigma");
    if (asked.correlated)
        summary.add("errors last", found.correlation_time / unit::day,
                    found.correlation_time > 0 ? "days: their correlation falls by e in this time"
                                               : "days: they are independent");
}

bool is_doubtful(const ErrorsFound& found)
{
    return !found.doubts.empty() || is_worse_than_sigma(found.confidence);
}

void warn_of_doubts(Summary& summary, const ErrorsFound& found)
{
    if (is_worse_than_sigma(found.confidence))
        summary.warn("the fit is worse than the readings' sigma allow (p " +
                     rounded(found.confidence.p_value, 2) +
                     "): the model is not right, or sigma is too small");
    std::string words;
    for (const Doubt& doubt : found.doubts)
        words += (words.empty() ? "" : "; or ") + words_of_doubt(doubt, found);
    if (!words.empty())
        summary.warn(
            "residuals are no noise: they look like " + words +
            ". Intervals are not right. See --offset, --drift, --steps, --robust, --correlated-noise; or the "
            "model is not right");
}

} // namespace jointcreep::creepfit
