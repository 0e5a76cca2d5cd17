#include "creepfit_curve.hpp"

#include "creepfit_errors.hpp"
#include "creepfit_files.hpp"
#include "creepfit_words.hpp"

#include "estimation/creep_curve.hpp"
#include "joint/coulomb.hpp"
#include "model/error.hpp"
#include "model/units.hpp"
#include "scene/measurements.hpp"

#include <cmath>
#include <optional>
#include <string>

namespace jointcreep::creepfit
{

using estimation::Interval;

namespace
{

// Largest share of creep that may be left at the end that Eq. 14 assumes. Above it Eq. 14 has no meaning.
constexpr double most_left = 0.2;

// Readings from the change of load on.
struct Curve {
    estimation::CreepCurve readings; // time from `load`, displacement from `zero`
    double load;                     // when it changed [s]
    double zero = 0;                 // mean of the readings before it [m]
    std::size_t before = 0;          // number of readings before the load
};

struct Fit {
    estimation::CurveFit by_curve;
    estimation::ClosedEstimate closed; // by Eq. 14
    double left;                       // share of creep left when Eq. 14 takes it as over [-]
    double before;            // share of creep before the first reading, which Eq. 14 takes for elastic [-]
    bool has_closed_interval; // of Eq. 14
};

// A row of the table of results.
struct Row {
    std::string quantity, unit;
    double value;
    std::optional<Interval> interval;
};

Curve curve_from(double load, const std::vector<scene::Measurement>& measurements)
{
    Curve curve{.readings = {}, .load = load};
    double weights = 0;
    for (const scene::Measurement& m : measurements)
        if (m.time < load) {
            const double weight = m.deviation ? 1 / (*m.deviation * *m.deviation) : 1.0;
            curve.zero += weight * m.displacement;
            weights += weight;
            ++curve.before;
        }
    if (curve.before > 0)
        curve.zero /= weights;
    for (const scene::Measurement& m : measurements) {
        if (m.time < load)
            continue;
        curve.readings.time.push_back(m.time - load);
        curve.readings.displacement.push_back(m.displacement - curve.zero);
        if (m.deviation)
            curve.readings.deviation.push_back(*m.deviation);
    }
    return curve;
}

Curve read_curve(const Arguments& arguments)
{
    const std::string& input = arguments.input();
    if (arguments.inputs().size() > 1)
        throw input_error(
            "several files are given, and --measurements is not; expected one curve, or networks with "
            "--measurements");
    const std::string text = text_of(input);
    if (text.starts_with("\x89HDF"))
        throw input_error("--measurements is not given, and " + input + " is no curve");
    const std::vector<scene::Measurement> measurements =
        of_file(input, [&] { return scene::creep_curve_in_csv(text); });
    const double load =
        arguments.number("load-day").value_or(measurements.front().time / unit::day) * unit::day;
    Curve curve = curve_from(load, measurements);
    if (const auto elastic = arguments.number("elastic-mm")) {
        require(std::abs(*elastic) > 0 && std::abs(*elastic) <= 1e6, "--elastic-mm", *elastic, "mm",
                "must not be 0, and at most 1e6");
        curve.readings.elastic_part = *elastic * 1e-3;
    }
    if (curve.readings.time.empty())
        throw input_error("--load-day is " + shown(load / unit::day) + "; " + input +
                          " has no reading from then on");
    return curve;
}

Fit fit_of(const Arguments& arguments, const Curve& curve, const estimation::Errors& errors)
{
    const estimation::CreepCurve& readings = curve.readings;
    const double last = (curve.load + readings.time.back()) / unit::day;
    const double end = arguments.number("converged-day").value_or(last) * unit::day - curve.load;
    Fit fit{of_file(arguments.input(), [&] { return estimation::fit_curve(readings, errors); }),
            of_file(arguments.input(), [&] { return estimation::closed_estimate(readings, end); }), 0, 0,
            false};
    for (estimation::FoundError& error : fit.by_curve.errors)
        error.time += curve.load;
    for (estimation::Doubt& doubt : fit.by_curve.doubts)
        doubt.time += curve.load;
    const double tau = fit.by_curve.retardation_time;
    fit.left = std::exp(-end / tau);
    fit.before = readings.elastic_part ? 0.0 : -std::expm1(-readings.time.front() / tau);
    // What Eq. 14 leaves out makes ln E wrong by this much. A quarter of a standard error costs one percent of coverage.
    const double ratio = fit.by_curve.creep_part / fit.by_curve.elastic_part;
    const double bias = fit.before * (1 + ratio) / (1 - fit.before) + fit.left / (1 - fit.left);
    fit.has_closed_interval =
        fit.left <= most_left && bias <= 0.25 * fit.closed.stiffness_error && !errors.any();
    return fit;
}

Interval times(const Interval& interval, double by)
{
    return {interval.low * by, interval.high * by};
}

Row row_of(const std::string& quantity, const std::string& unit, const estimation::Estimate& estimate,
           double by)
{
    return {quantity, unit, estimate.value * by, times(estimate.interval, by)};
}

// E and eta in MPa/m and MPa day/m, or over K where its stiffness is not given.
std::vector<Row> rows_of(const Fit& fit, bool knows_elastic_part, std::optional<double> stiffness)
{
    const estimation::CurveFit& by_curve = fit.by_curve;
    const double K = stiffness.value_or(1), per_day = K / unit::day;
    const std::string unit_E = stiffness ? "MPa/m" : "K", unit_eta = stiffness ? "MPa day/m" : "K day";
    const auto closed_row = [&](const std::string& quantity, const std::string& unit,
                                const estimation::Estimate& estimate, double by) {
        Row row = row_of(quantity, unit, estimate, by);
        if (!fit.has_closed_interval)
            row.interval.reset();
        return row;
    };
    std::vector<Row> rows{
        {"elastic part", "mm", by_curve.elastic_part * 1e3,
         knows_elastic_part ? std::nullopt : std::optional(times(by_curve.elastic_interval, 1e3))},
        {"creep part", "mm", by_curve.creep_part * 1e3, times(by_curve.creep_interval, 1e3)},
        row_of("retardation time", "day", by_curve.time, 1 / unit::day),
        row_of("Kelvin stiffness E", unit_E, by_curve.stiffness, K),
        row_of("Kelvin viscosity eta", unit_eta, by_curve.viscosity, per_day),
        closed_row("E by Eq. 14", unit_E, fit.closed.stiffness, K),
        closed_row("eta by least squares with that E", unit_eta, fit.closed.viscosity, per_day)};
    for (const estimation::FoundError& error : by_curve.errors) {
        const ErrorWords words = words_of(error, "");
        rows.push_back(
            {words.name, words.unit, error.value / words.in_si, times(error.interval, 1 / words.in_si)});
    }
    return rows;
}

std::string table_of(const std::vector<Row>& rows)
{
    std::string table = "quantity,unit,value,low_95,high_95\n";
    for (const Row& row : rows) {
        table += row.quantity + ',' + row.unit + ',' + shown(row.value) + ',';
        if (row.interval)
            table += shown(row.interval->low);
        table += ',';
        if (row.interval && std::isfinite(row.interval->high))
            table += shown(row.interval->high);
        table += '\n';
    }
    return table;
}

std::string readings_table(const Curve& curve, const estimation::CurveFit& fit)
{
    const auto& [readings, load, zero, before] = curve;
    std::string table = "time_day,measured_mm,computed_mm,residual_mm,instrument_mm\n";
    for (std::size_t i = 0; i < readings.time.size(); ++i)
        table += shown((load + readings.time[i]) / unit::day) + ',' +
                 shown((readings.displacement[i] + zero) * 1e3) + ',' +
                 shown((fit.computed[i] + zero) * 1e3) + ',' +
                 shown((fit.computed[i] + fit.instrument[i] - readings.displacement[i]) * 1e3) + ',' +
                 shown(fit.instrument[i] * 1e3) + '\n';
    return table;
}

void add_residuals(Summary& summary, const Curve& curve, const estimation::CurveFit& fit,
                   const estimation::Errors& errors)
{
    std::vector<double> residuals;
    for (std::size_t i = 0; i < fit.computed.size(); ++i)
        residuals.push_back(fit.computed[i] + fit.instrument[i] - curve.readings.displacement[i]);
    summary.add("residuals, root mean square", mm(root_mean_square(residuals)) + " mm");
    const bool knows = !curve.readings.deviation.empty();
    if (knows)
        summary.add("chi squared", rounded(fit.confidence.sum_of_squares) + " of " +
                                       std::to_string(fit.confidence.readings - fit.confidence.parameters) +
                                       " degrees of freedom");
    summary.add("noise taken as", noise_in_words(fit.confidence, knows, errors));
}

// Warns of what the record is too short, or too coarse, to give.
void warn_of_record(Summary& summary, const Curve& curve, const estimation::CurveFit& fit)
{
    if (fit.is_too_short)
        summary.warn("record too short: it is " + rounded(fit.record_length, 2) +
                     " retardation times long: it tells how fast creep begins, about 1 / eta, but not where "
                     "it ends, 1 / E");
    else if (fit.is_stiffness_open)
        summary.warn("E hardly known: its interval is wider than a factor of 2, though the record is " +
                     rounded(fit.record_length, 2) + " retardation times long: noise, or too few readings");
    // A given elastic part has no interval.
    if (const Interval& of = fit.elastic_interval;
        !curve.readings.elastic_part && of.low <= 0 && of.high >= 0)
        summary.warn(
            "the elastic part cannot be distinguished from 0, nor can E and eta; count displacements from before "
            "the load, not from a reading after it");
    if (fit.is_too_coarse)
        summary.warn(
            "readings too coarse: creep is nearly over at the first reading after the load: the eta found is an upper limit");
}

// Warns where an assumption of Eq. 14 does not hold.
void warn_of_closed_estimate(Summary& summary, const Curve& curve, const Fit& fit)
{
    if (fit.left > 0.02)
        summary.warn("creep not over: " + rounded(100 * fit.left, 2) +
                     " percent of it is left at the end that Eq. 14 takes: " +
                     (fit.left > most_left
                          ? "too much for Eq. 14; its results have no interval"
                          : "its E is too high, by a factor of about " + rounded(1 / (1 - fit.left), 3)));
    if (fit.before > 0.1)
        summary.warn("first reading late: " + rounded(curve.readings.time.front() / unit::day) +
                     " days after the load, with " + rounded(100 * fit.before, 2) +
                     " percent of creep in it, which Eq. 14 takes for elastic");
    if (!fit.has_closed_interval && fit.left <= most_left)
        summary.add("intervals of Eq. 14",
                    "none: it leaves out more than its noise; see those of the fit of all readings");
}

ErrorsFound errors_of(const Curve& curve, const estimation::CurveFit& fit)
{
    return {fit.errors,
            fit.outliers,
            fit.doubts,
            fit.correlation_time,
            fit.confidence,
            [](std::size_t) { return std::string("the curve"); },
            [&curve](std::size_t reading) {
                return "on day " + rounded((curve.load + curve.readings.time[reading]) / unit::day, 6);
            }};
}

void report(const Arguments& arguments, const Curve& curve, const Fit& fit, const std::vector<Row>& rows,
            const estimation::Errors& errors)
{
    Summary summary;
    summary.add("readings", curve.readings.time.size());
    if (curve.before > 0)
        summary.add("readings before the load", std::to_string(curve.before) + ", mean " + mm(curve.zero) +
                                                    " mm: subtracted from the others, and taken as exact");
    summary.add("days since the load", curve.readings.time.back() / unit::day);
    for (const Row& row : rows)
        summary.add(row.quantity, rounded(row.value) +
                                      (row.interval ? " (95 %: " + shown_interval(*row.interval) + ")" : "") +
                                      ' ' + row.unit);
    summary.add("correlation of ln E and ln eta", fit.by_curve.correlation);
    add_residuals(summary, curve, fit.by_curve, errors);
    const ErrorsFound of_instrument = errors_of(curve, fit.by_curve);
    add_outliers_and_lasting(summary, of_instrument, errors);
    warn_of_record(summary, curve, fit.by_curve);
    warn_of_closed_estimate(summary, curve, fit);
    warn_of_doubts(summary, of_instrument);
    summary.print(arguments);
}

} // namespace

std::vector<Option> curve_options()
{
    return {
        {"stiffness", "MPA_PER_M", "of a curve: joint stiffness K; without it E and eta are given over K"},
        {"elastic-mm", "MM", "of a curve: elastic displacement, if known (default: fitted)"},
        {"load-day", "DAY",
         "of a curve: when the load changed (default: day of the first reading); the mean of readings "
         "before it is taken as 0"},
        {"converged-day", "DAY",
         "of a curve: day when creep is taken as ended, for Eq. 14 (default: last reading)"}};
}

void fit_curve(const Arguments& arguments)
{
    const std::optional<double> stiffness =
        arguments.number("stiffness", joint::parameters::normal_stiffness.range, "MPa/m");
    const std::optional<std::string> readings_path = readings_file(arguments, false);

    // 1. The readings, from the change of load on.
    const Curve curve = read_curve(arguments);
    estimation::Errors errors = errors_in(arguments);
    if (errors.offset && !curve.readings.elastic_part)
        throw input_error(
            "--offset of a curve is the elastic part's; expected --elastic-mm with it, or no --offset");
    for (double& step : errors.steps) {
        step -= curve.load;
        if (!(step > curve.readings.time.front() && step <= curve.readings.time.back()))
            throw input_error(arguments.input() + ": no readings before and after the step on day " +
                              shown((step + curve.load) / unit::day) + " and from the load on");
    }

    // 2. E and eta, by least squares and by Eq. 14.
    const Fit fit = fit_of(arguments, curve, errors);

    if (!fit.by_curve.is_settled)
        throw fit_error("no fit was found: " + std::string(not_settled));

    // 3. What was found.
    const std::vector<Row> rows = rows_of(fit, curve.readings.elastic_part.has_value(), stiffness);
    std::vector<TextFile> files;
    if (readings_path)
        files.push_back({*readings_path, readings_table(curve, fit.by_curve)});
    files.push_back({arguments.output(), table_of(rows)});
    write_texts(files);
    report(arguments, curve, fit, rows, errors);
}

} // namespace jointcreep::creepfit
