// creepfit: find creep constants from what was measured.
//
//   creepfit curve.csv --stiffness 690 -o constants.csv                 of one joint, from one curve
//   creepfit joints.h5 --measurements readings.csv --fit kelvin-stiffness,joint-stiffness -o factors.csv
//                                                                       of all joints, through the solver
//
// Reads   curve.csv, or joints.h5 (from strength-averaging) and readings.csv
// Writes  a table of what was found, and one of the readings on request   (docs/programs.md)
//
//         factors.failed.csv   where the search did not come to its end: the best so far
//
// The curve is in libs/estimation, the way through the solver in libs/back_analysis.

#include "program.hpp"

#include "back_analysis/back_analysis.hpp"
#include "estimation/creep_curve.hpp"
#include "model/error.hpp"
#include "model/units.hpp"
#include "scene/measurements.hpp"
#include "scene/scene.hpp"
#include "store/files.hpp"
#include "store/save.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <span>
#include <sstream>

using namespace jointcreep;
using estimation::AtBound;
using estimation::Confidence;
using estimation::Interval;
using sensitivity::Parameter;

namespace
{

const Program program{
    .name = "creepfit",
    .summary = "Finds creep constants of joints from measured displacements.",
    .input = "CURVE.csv|joints.h5",
    .output = "FOUND.csv",
    .options =
        {{"readings", "FILE.csv", "write measured and computed displacements, too"},
         {"stiffness", "MPA_PER_M", "of a curve: K of the joint, to give E and eta as such, not over K"},
         {"elastic-mm", "MM", "of a curve: what the joint did at once, if known (default: found)"},
         {"load-day", "DAY",
          "of a curve: when the load changed (default: day of the first reading); the mean of readings "
          "before it is taken as 0"},
         {"converged-day", "DAY",
          "of a curve: when creep is taken to be over, for the closed estimate (default: last reading)"},
         {"measurements", "FILE.csv", "through the solver: displacements of the scene's points"},
         {"fit", "NAMES",
          "through the solver: factors to find, of kelvin-stiffness, kelvin-viscosity, joint-stiffness and "
          "horizontal-stress, parted by commas, each with bounds if wanted: joint-stiffness=0.5:2 (default "
          "bounds: 0.05:20); kelvin-viscosity is that of Maxwell dashpots, too; the search starts from 1, or "
          "from the root of low times high where that is out of bounds"},
         {"since-first-reading", "",
          "through the solver: measurements count from each point's first reading, and share its error"},
         {"runs", "N",
          "through the solver: at most so many runs (default 60); where they are too few the exit code is 3, "
          "and the best so far is in FOUND.failed.csv"},
         {"threads", "N", "through the solver: threads (default 1)"}},
    .example = "creepfit joints.h5 --measurements readings.csv --fit kelvin-stiffness,kelvin-viscosity -o "
               "factors.csv",
    .columns =
        "  CURVE.csv       time_day, displacement_mm; if wanted sigma_mm\n"
        "  --measurements  a row a reading: time_day, point, component (x or y), displacement_mm;\n"
        "                  if wanted sigma_mm, event\n"
        "                  or a row a time, as jointexport writes it: time_day, event, and A_x_m, A_y_m,\n"
        "                  A_present of a point A; if wanted A_x_sigma_m, A_y_sigma_m\n"
        "  A length may be in _m, _cm or _mm, as its name says.\n",
};

struct Name {
    std::string_view option, words;
    Parameter parameter;
};
constexpr std::array<Name, 4> names{
    {{"kelvin-stiffness", "Kelvin stiffness E", Parameter::kelvin_stiffness},
     {"kelvin-viscosity", "Kelvin viscosity eta", Parameter::kelvin_viscosity},
     {"joint-stiffness", "joint stiffness K", Parameter::joint_stiffness},
     {"horizontal-stress", "horizontal stress", Parameter::horizontal_stress}}};

const Name& name_of(Parameter parameter)
{
    return *std::find_if(names.begin(), names.end(),
                         [&](const Name& name) { return name.parameter == parameter; });
}

std::string rounded(double value, int digits = 4)
{
    std::ostringstream text;
    text.precision(digits);
    text << value;
    return text.str();
}

std::string shown_interval(const Interval& interval)
{
    return rounded(interval.low) + " to " +
           (std::isfinite(interval.high) ? rounded(interval.high) : "infinity");
}

std::string mm(double metres)
{
    return rounded(metres / 1e-3);
}

std::string text_of(const std::string& path)
{
    if (std::error_code none; std::filesystem::is_directory(path, none))
        throw file_error(path + ": is a folder");
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    if (!file)
        throw file_error(path + ": cannot be read");
    return text.str();
}

// Whatever refuses what is in a file names the file.
template <class Read>
auto of_file(const std::string& path, const Read& read)
{
    try {
        return read();
    } catch (const input_error& error) {
        const std::string_view message = error.what();
        throw input_error(path + (message.starts_with("line ") ? ", " : ": ") + error.what());
    }
}

// The same, where other things may be refused, too.
template <class Read>
auto of_lines_of_file(const std::string& path, const Read& read)
{
    try {
        return read();
    } catch (const input_error& error) {
        if (const std::string_view message = error.what(); message.starts_with("line "))
            throw input_error(path + ", " + error.what());
        throw;
    }
}

void write(const std::string& path, const std::string& text)
{
    try {
        store::save(path, std::as_bytes(std::span(text)));
    } catch (const file_error& error) {
        throw file_error(path + ": " + error.what());
    }
}

bool is_same_file(const std::string& one, const std::string& other)
{
    std::error_code absent;
    return one == other || std::filesystem::equivalent(one, other, absent);
}

// Refuses names where what has failed would be written over a file that is read, or found.
void refuse_loss(const std::string& failed, const std::vector<std::string>& others)
{
    for (const std::string& other : others)
        if (is_same_file(failed, other))
            throw input_error(
                other +
                ": a search that does not come to its end would be written there; wanted another name");
}

// Where to write the readings; refuses what would lose another file.
std::optional<std::string> readings_file(const Arguments& arguments)
{
    std::optional<std::string> path = arguments.text("readings");
    if (!path)
        return {};
    for (const std::string& other :
         {arguments.input(), arguments.output(), arguments.text("measurements").value_or("")})
        if (is_same_file(*path, other))
            throw input_error("--readings: " + *path + " is used already; give it another name");
    store::check_writable(*path);
    return path;
}

void refuse_options(const Arguments& arguments, const std::string& why,
                    std::initializer_list<const char*> options)
{
    for (const char* option : options)
        if (arguments.has(option))
            throw input_error("--" + std::string(option) + " goes with " + why);
}

std::string noise_in_words(const Confidence& confidence, bool knows_deviations)
{
    std::string words = "independent and normal, ";
    if (!knows_deviations)
        return words + "alike for all readings, as large as the residuals are";
    if (!confidence.is_noise_from_residuals)
        return words + "with the readings' sigma";
    return words + "with the readings' sigma times " + rounded(confidence.noise_factor, 3) +
           ": the fit is worse than these allow, so intervals are wider";
}

// What says that intervals are too narrow: residuals that follow each other.
void warn_of_lag(Summary& summary, const std::string& label, double lag_one, std::size_t readings)
{
    if (lag_one > 2 / std::sqrt(static_cast<double>(readings)))
        summary.add(
            "warning: residuals follow each other" + label,
            "correlation of neighbours " + rounded(lag_one, 2) +
                ": the noise is not independent, or the model is not right, and intervals are too narrow");
}

// --- one curve -------------------------------------------------------------------------------------------

struct Row {
    std::string quantity, unit;
    double value;
    std::optional<Interval> interval;
};

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

void fit_curve(const Arguments& arguments)
{
    refuse_options(arguments, "joints.h5 and --measurements",
                   {"fit", "since-first-reading", "runs", "threads"});
    const std::string& input = arguments.input();
    const std::optional<double> stiffness = arguments.number("stiffness", scene::joint_stiffnesses, "MPa/m");
    const std::optional<std::string> readings_path = readings_file(arguments);
    store::check_writable(arguments.output());
    const std::string text = text_of(input);
    if (text.starts_with("\x89HDF"))
        throw input_error("--measurements is not given, and " + input + " is no curve");
    const std::vector<scene::Measurement> measurements =
        of_file(input, [&] { return scene::creep_curve_in_csv(text); });

    const double load =
        arguments.number("load-day").value_or(measurements.front().time / unit::day) * unit::day;
    // The mean of what was read before the load changed is where displacements count from.
    std::size_t before = 0;
    double zero = 0, weights = 0;
    for (const scene::Measurement& m : measurements)
        if (m.time < load) {
            const double weight = m.deviation ? 1 / (*m.deviation * *m.deviation) : 1.0;
            zero += weight * m.displacement;
            weights += weight;
            ++before;
        }
    if (before > 0)
        zero /= weights;
    estimation::CreepCurve curve;
    for (const scene::Measurement& m : measurements) {
        if (m.time < load)
            continue;
        curve.time.push_back(m.time - load);
        curve.displacement.push_back(m.displacement - zero);
        if (m.deviation)
            curve.deviation.push_back(*m.deviation);
    }
    if (const auto elastic = arguments.number("elastic-mm")) {
        require(std::abs(*elastic) > 0 && std::abs(*elastic) <= 1e6, "--elastic-mm", *elastic, "mm",
                "must not be 0, and at most 1e6");
        curve.elastic_part = *elastic * 1e-3;
    }
    if (curve.time.empty())
        throw input_error("--load-day is " + shown(load / unit::day) + "; " + input +
                          " has no reading from then on");
    const double end =
        arguments.number("converged-day").value_or((load + curve.time.back()) / unit::day) * unit::day - load;
    const estimation::CurveFit fit = of_file(input, [&] { return estimation::fit_curve(curve); });
    const estimation::ClosedEstimate closed =
        of_file(input, [&] { return estimation::closed_estimate(curve, end); });

    // What is still to come when Eq. 14 takes creep to be over. With much of it the equation says nothing.
    constexpr double most_left = 0.2;
    const double left = std::exp(-end / fit.retardation_time);

    // E and eta in MPa/m and MPa day/m, or over K.
    const double K = stiffness.value_or(1);
    const std::string unit_E = stiffness ? "MPa/m" : "K", unit_eta = stiffness ? "MPa day/m" : "K day";
    const auto times = [](const Interval& i, double by) { return Interval{i.low * by, i.high * by}; };
    const auto estimate = [&](const std::string& quantity, const std::string& unit,
                              const estimation::Estimate& e, double by) {
        return Row{quantity, unit, e.value * by, times(e.interval, by)};
    };
    const auto closed_row = [&](const std::string& quantity, const std::string& unit,
                                const estimation::Estimate& e, double by) {
        Row row = estimate(quantity, unit, e, by);
        if (left > most_left)
            row.interval.reset();
        return row;
    };
    const double per_day = K / unit::day;
    const std::vector<Row> rows{
        {"elastic part", "mm", fit.elastic_part * 1e3,
         curve.elastic_part ? std::nullopt : std::optional(times(fit.elastic_interval, 1e3))},
        {"creep part", "mm", fit.creep_part * 1e3, times(fit.creep_interval, 1e3)},
        estimate("retardation time", "day", fit.time, 1 / unit::day),
        estimate("Kelvin stiffness E", unit_E, fit.stiffness, K),
        estimate("Kelvin viscosity eta", unit_eta, fit.viscosity, per_day),
        closed_row("E by Eq. 14", unit_E, closed.stiffness, K),
        closed_row("eta by least squares with that E", unit_eta, closed.viscosity, per_day)};
    if (readings_path) {
        std::string table = "time_day,measured_mm,computed_mm,residual_mm\n";
        for (std::size_t i = 0; i < curve.time.size(); ++i)
            table += shown((load + curve.time[i]) / unit::day) + ',' +
                     shown((curve.displacement[i] + zero) * 1e3) + ',' +
                     shown((fit.computed[i] + zero) * 1e3) + ',' +
                     shown((fit.computed[i] - curve.displacement[i]) * 1e3) + '\n';
        write(*readings_path, table);
    }
    write(arguments.output(), table_of(rows));
    if (arguments.quiet())
        return;

    Summary summary;
    summary.add("readings", curve.time.size());
    if (before > 0)
        summary.add("readings before the load",
                    std::to_string(before) + ", mean " + mm(zero) +
                        " mm: taken off the others as their zero, and as free of error");
    summary.add("days since the load", curve.time.back() / unit::day);
    for (const Row& row : rows)
        summary.add(row.quantity, rounded(row.value) +
                                      (row.interval ? " (95 %: " + shown_interval(*row.interval) + ")" : "") +
                                      ' ' + row.unit);
    summary.add("correlation of ln E and ln eta", fit.correlation);
    const bool knows = !curve.deviation.empty();
    double squares = 0;
    for (std::size_t i = 0; i < fit.computed.size(); ++i)
        squares += std::pow(fit.computed[i] - curve.displacement[i], 2);
    summary.add("residuals, root mean square",
                mm(std::sqrt(squares / static_cast<double>(fit.computed.size()))) + " mm");
    if (knows)
        summary.add("chi squared", rounded(fit.confidence.sum_of_squares) + " of " +
                                       std::to_string(fit.confidence.readings - fit.confidence.parameters) +
                                       " degrees of freedom");
    summary.add("noise taken as", noise_in_words(fit.confidence, knows));
    if (fit.is_too_short)
        summary.add(
            "warning: record too short",
            "it is " + rounded(fit.record_length, 2) +
                " retardation times long: it tells how fast creep begins, about 1 / eta, but not where "
                "it ends, 1 / E");
    else if (fit.is_stiffness_open)
        summary.add("warning: E hardly known",
                    "its interval goes beyond a factor of 2, though the record is " +
                        rounded(fit.record_length, 2) +
                        " retardation times long: noise, or too few readings");
    // Where it is given there is no interval to look at.
    if (const Interval& of = fit.elastic_interval; !curve.elastic_part && of.low <= 0 && of.high >= 0)
        summary.add("warning: elastic part",
                    "is not told apart from 0, nor are E and eta; displacements count from before the "
                    "load, not from a reading after it");
    if (fit.is_too_coarse)
        summary.add(
            "warning: readings too coarse",
            "creep is all but over at the first reading after the load: eta is at most what is found");
    if (left > 0.02)
        summary.add("warning: creep not over",
                    rounded(100 * left, 2) + " percent of it is left at the end that Eq. 14 takes: " +
                        (left > most_left
                             ? "that is no end, and what it gives has no interval"
                             : "its E is too high, about " + rounded(1 / (1 - left), 3) + " times"));
    if (const double share = curve.time.front() / fit.retardation_time; !curve.elastic_part && share > 0.1)
        summary.add("warning: first reading late",
                    rounded(curve.time.front() / unit::day) + " days after the load, with " +
                        rounded(-100 * std::expm1(-share), 2) +
                        " percent of creep in it, which Eq. 14 takes for elastic");
    warn_of_lag(summary, "", fit.lag_one, fit.computed.size());
    summary.print();
}

// --- through the solver ----------------------------------------------------------------------------------

std::string trimmed(const std::string& text)
{
    const std::size_t begin = text.find_first_not_of(" \t"), end = text.find_last_not_of(" \t");
    return begin == std::string::npos ? std::string() : text.substr(begin, end - begin + 1);
}

std::vector<back_analysis::Factor> factors_in(const std::string& text)
{
    std::vector<back_analysis::Factor> factors;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        const std::string item = trimmed(text.substr(begin, end - begin));
        begin = end + 1;
        if (item.empty())
            throw input_error(trimmed(text).empty()
                                  ? "--fit is empty; wanted one factor at least"
                                  : "--fit: \"" + text + "\" has nothing before or after a comma");
        const std::string option = trimmed(item.substr(0, item.find('=')));
        const auto name =
            std::find_if(names.begin(), names.end(), [&](const Name& n) { return n.option == option; });
        if (name == names.end())
            throw input_error("--fit: \"" + option +
                              "\" is none of kelvin-stiffness, kelvin-viscosity, "
                              "joint-stiffness, horizontal-stress");
        for (const back_analysis::Factor& other : factors)
            if (other.parameter == name->parameter)
                throw input_error("--fit: " + option + " is given twice");
        back_analysis::Factor factor{name->parameter};
        if (const std::size_t equals = item.find('='); equals != std::string::npos) {
            double low = 0, high = 0;
            char colon = 0, rest = 0;
            std::istringstream bounds(item.substr(equals + 1));
            if (!(bounds >> low >> colon >> high) || colon != ':' || bounds >> rest || !(low > 0) ||
                !(low < high) || low < 1e-6 || high > 1e6)
                throw input_error("--fit: the bounds of " + option + " are \"" + item.substr(equals + 1) +
                                  "\"; wanted two factors LOW:HIGH, 1e-6 at least, rising, 1e6 at most");
            factor.low = low;
            factor.high = high;
            factor.start = low <= 1 && 1 <= high ? 1 : std::sqrt(low * high);
        }
        factors.push_back(factor);
    }
    return factors;
}

std::string found_table(const back_analysis::Found& found, const std::vector<back_analysis::Factor>& factors,
                        bool knows_deviations)
{
    const Confidence& confidence = found.confidence;
    const auto weak = estimation::weak_combination(found.minimum, confidence);
    // Of the whole fit: the same in every row.
    const std::string of_fit = std::string(found.minimum.is_converged ? "yes" : "no") + ',' +
                               std::to_string(found.minimum.evaluations) + ',' +
                               (knows_deviations ? shown(confidence.sum_of_squares) : "") + ',' +
                               std::to_string(confidence.readings - confidence.parameters) + ',' +
                               shown(confidence.condition_number);
    std::string table =
        "factor,value,low_95,high_95,low_95_all,high_95_all,standard_error_of_logarithm,at_bound,"
        "weak_combination_times,converged,runs,chi_squared,degrees_of_freedom,condition_number";
    for (const back_analysis::Factor& factor : factors)
        table += ",correlation_" + std::string(name_of(factor.parameter).option);
    table += '\n';
    const auto bounded = [](double logarithm) {
        return std::isfinite(logarithm) ? shown(std::exp(logarithm)) : std::string();
    };
    for (std::size_t i = 0; i < factors.size(); ++i) {
        const auto index = static_cast<Eigen::Index>(i);
        const double logarithm = found.minimum.parameters[index];
        const Interval each = confidence.interval(logarithm, index),
                       all = confidence.interval(logarithm, index, true);
        const AtBound at = found.minimum.at_bound[i];
        table += std::string(name_of(factors[i].parameter).option) + ',' + shown(found.factors[i]) + ',' +
                 bounded(each.low) + ',' + bounded(each.high) + ',' + bounded(all.low) + ',' +
                 bounded(all.high) + ',' +
                 (confidence.is_fixed[i] ? "" : shown(confidence.standard_error(index))) + ',' +
                 (at == AtBound::no    ? "no"
                  : at == AtBound::low ? "low"
                                       : "high") +
                 ',' +
                 (weak ? shown(std::exp(weak->direction[index] * confidence.quantile * weak->standard_error))
                       : "") +
                 ',' + of_fit;
        for (Eigen::Index j = 0; j < confidence.correlation.cols(); ++j)
            table += ',' + shown(confidence.correlation(index, j));
        table += '\n';
    }
    return table;
}

std::string in_quotes(const std::string& name)
{
    if (name.find_first_of(",\"\r\n") == std::string::npos)
        return name;
    std::string quoted = "\"";
    for (const char c : name)
        quoted.append(c == '"' ? 2 : 1, c);
    return quoted + '"';
}

std::string readings_table(const back_analysis::Found& found,
                           const std::vector<scene::Measurement>& measurements, const Scene& scene)
{
    const bool knows = measurements.front().deviation.has_value();
    std::string table =
        "time_day,stages,point,component,measured_mm,computed_mm,residual_mm,computed_at_start_mm";
    table += knows ? ",sigma_mm\n" : "\n";
    for (std::size_t m = 0; m < measurements.size(); ++m) {
        const scene::Measurement& measured = measurements[m];
        const auto& [at_start, at_end] = found.computed[m];
        const auto stages = std::count_if(scene.stages.begin(), scene.stages.end(), [&](const Stage& stage) {
            return measured.is_before_stage ? stage.time < measured.time : stage.time <= measured.time;
        });
        table += shown(measured.time / unit::day) + ',' + std::to_string(stages) + ',' +
                 in_quotes(scene.points[measured.point].name) + ',' + (measured.component == 0 ? "x" : "y") +
                 ',' + shown(measured.displacement * 1e3) + ',' + shown(at_end * 1e3) + ',' +
                 shown((at_end - measured.displacement) * 1e3) + ',' + shown(at_start * 1e3);
        if (knows)
            table += ',' + shown(*measured.deviation * 1e3);
        table += '\n';
    }
    return table;
}

void report_points(Summary& summary, const back_analysis::Found& found,
                   const std::vector<scene::Measurement>& measurements, const Scene& scene,
                   bool share_an_error)
{
    for (std::size_t p = 0; p < scene.points.size(); ++p)
        for (const int component : {0, 1}) {
            std::vector<std::pair<double, double>> residuals; // by time
            double sum = 0, squares = 0;
            for (std::size_t m = 0; m < measurements.size(); ++m) {
                if (measurements[m].point != p || measurements[m].component != component)
                    continue;
                const double residual = found.computed[m].at_end - measurements[m].displacement;
                residuals.emplace_back(measurements[m].time, residual);
                sum += residual;
                squares += residual * residual;
            }
            if (residuals.empty())
                continue;
            const std::string label = scene.points[p].name + (component == 0 ? ", x" : ", y");
            const auto n = static_cast<double>(residuals.size());
            summary.add("residuals of " + label, "mean " + mm(sum / n) + " mm, root mean square " +
                                                     mm(std::sqrt(squares / n)) + " mm, " +
                                                     std::to_string(residuals.size()) + " readings");
            std::stable_sort(residuals.begin(), residuals.end(),
                             [](const auto& a, const auto& b) { return a.first < b.first; });
            std::vector<double> in_time;
            for (const auto& [time, residual] : residuals)
                in_time.push_back(share_an_error ? residual - sum / n : residual);
            if (in_time.size() > 3)
                warn_of_lag(summary, ", " + label, estimation::lag_one_correlation(in_time), in_time.size());
        }
}

// What a combination of factors changes, in words: "kelvin-stiffness x 1.1 with joint-stiffness x 0.95".
std::string combination_in_words(const Eigen::VectorXd& direction, double by,
                                 const std::vector<back_analysis::Factor>& factors)
{
    std::string words;
    for (std::size_t i = 0; i < factors.size(); ++i) {
        const double share = direction[static_cast<Eigen::Index>(i)];
        if (std::abs(share) < 0.1)
            continue;
        words += (words.empty() ? "" : " with ") + std::string(name_of(factors[i].parameter).option) + " x " +
                 rounded(std::exp(share * by), 3);
    }
    return words;
}

void print_stress(const InSituStress& stress, double factor)
{
    if (stress.profile.empty()) {
        std::cout << "\nIn the scene:\n[in_situ_stress]\ncompression_xx_MPa = "
                  << rounded(stress.compression_xx * factor / unit::MPa, 6)
                  << "\ncompression_xx_gradient_MPa_per_m = "
                  << rounded(stress.gradient_xx * factor / unit::MPa, 6) << '\n';
        return;
    }
    std::cout << "\nIn the scene: times " << rounded(factor, 6)
              << " all compression_xx_MPa of the profile of [in_situ_stress]:";
    for (const InSituStress::Level& level : stress.profile)
        std::cout << ' ' << rounded(level.compression_xx * factor / unit::MPa, 6);
    std::cout << ".\n";
}

// What to write into the scene. A factor that does not change the readings says nothing of it.
void print_for_the_scene(const back_analysis::Found& found, const Scene& scene,
                         const std::vector<back_analysis::Factor>& factors)
{
    double E = 1, eta = 1, K = 1;
    for (std::size_t i = 0; i < factors.size(); ++i) {
        if (found.confidence.is_fixed[i] && found.minimum.at_bound[i] == AtBound::no)
            continue;
        const double f = found.factors[i];
        switch (factors[i].parameter) {
        case Parameter::kelvin_stiffness:
            E *= f;
            break;
        case Parameter::kelvin_viscosity:
            eta *= f;
            break;
        case Parameter::joint_stiffness:
            K *= f;
            E *= f;
            eta *= f;
            break;
        case Parameter::horizontal_stress:
            print_stress(scene.in_situ_stress, f);
        }
    }
    // Of joint materials, where joints have their constants.
    if (scene.averaging.stiffness != StiffnessRule::joint || (E == 1 && eta == 1 && K == 1))
        return;
    std::cout << "\nIn the scene: times " << rounded(K, 6) << " all stiffnesses of joint materials, times "
              << rounded(E, 6) << " their Kelvin stiffnesses, times " << rounded(eta, 6)
              << " their Kelvin and Maxwell viscosities.\n";
}

std::string factors_in_words(const std::vector<back_analysis::Factor>& factors,
                             const std::vector<double>& values)
{
    std::string words;
    for (std::size_t i = 0; i < factors.size(); ++i)
        words += (i > 0 ? ", " : "") + std::string(name_of(factors[i].parameter).option) + ' ' +
                 rounded(values[i]);
    return words;
}

// How many, and where the last one was.
std::string shown_without_answer(const back_analysis::Found& found,
                                 const std::vector<back_analysis::Factor>& factors)
{
    const back_analysis::WithoutAnswer& last = found.without_answer.back();
    std::string reason = last.reason;
    std::replace(reason.begin(), reason.end(), '\n', ' ');
    return std::to_string(found.without_answer.size()) + ", the last at " +
           factors_in_words(factors, last.factors) + ": " + reason;
}

// What ended a search before its end, and what helps.
std::string why_not_converged(const back_analysis::Found& found,
                              const std::vector<back_analysis::Factor>& factors)
{
    const estimation::Minimum& minimum = found.minimum;
    std::vector<double> wanted;
    for (std::size_t i = 0; i < factors.size(); ++i)
        wanted.push_back(found.factors[i] * std::exp(minimum.left[static_cast<Eigen::Index>(i)]));
    std::string why = "no fit was found in " + std::to_string(minimum.evaluations) + " runs: the best is " +
                      factors_in_words(factors, found.factors) + ", and the readings still want " +
                      factors_in_words(factors, wanted);
    if (minimum.has_stalled)
        why += ", but no run on the way there was better";
    if (!found.without_answer.empty())
        why += "\nruns without an answer: " + shown_without_answer(found, factors);
    return why + (minimum.has_stalled ? "\nwanted other bounds in --fit, or fewer factors"
                                      : "\nwanted more --runs");
}

void report(const back_analysis::Found& found, const std::vector<scene::Measurement>& measurements,
            const Scene& scene, const back_analysis::Settings& settings)
{
    const Confidence& confidence = found.confidence;
    const auto& factors = settings.factors;
    Summary summary;
    summary.add("readings", measurements.size());
    summary.add("runs", found.minimum.evaluations);
    if (!found.without_answer.empty())
        summary.add("runs without an answer", shown_without_answer(found, factors));
    for (std::size_t i = 0; i < factors.size(); ++i) {
        const auto index = static_cast<Eigen::Index>(i);
        const auto exponential = [](const Interval& of) {
            return Interval{std::exp(of.low), std::exp(of.high)};
        };
        const double logarithm = found.minimum.parameters[index];
        std::string words = rounded(found.factors[i]);
        if (found.minimum.at_bound[i] != AtBound::no)
            words += std::string(": at its ") +
                     (found.minimum.at_bound[i] == AtBound::low ? "lower" : "upper") +
                     " bound; the readings want it beyond";
        else if (confidence.is_fixed[i])
            words += ": it does not change these readings";
        else
            words += " (95 %: " + shown_interval(exponential(confidence.interval(logarithm, index))) +
                     "; all together: " +
                     shown_interval(exponential(confidence.interval(logarithm, index, true))) + ")";
        summary.add("factor on " + std::string(name_of(factors[i].parameter).words), words);
    }
    for (std::size_t i = 0; i < factors.size(); ++i)
        for (std::size_t j = i + 1; j < factors.size(); ++j)
            if (!confidence.is_fixed[i] && !confidence.is_fixed[j])
                summary.add("correlation of " + std::string(name_of(factors[i].parameter).option) + " and " +
                                std::string(name_of(factors[j].parameter).option),
                            rounded(confidence.correlation(static_cast<Eigen::Index>(i),
                                                           static_cast<Eigen::Index>(j)),
                                    3));
    const auto degrees = confidence.readings - confidence.parameters;
    const bool knows = measurements.front().deviation.has_value();
    if (knows)
        summary.add("chi squared", rounded(confidence.sum_of_squares) + " of " + std::to_string(degrees) +
                                       " degrees of freedom, p " + rounded(confidence.p_value, 2));
    else
        summary.add("standard deviation of residuals", mm(1e-3 * confidence.noise_factor) + " mm");
    summary.add("noise taken as", noise_in_words(confidence, knows));
    if (settings.since_first_reading)
        summary.add("first readings",
                    std::string("have such noise, too, which is in all that count from them"));
    report_points(summary, found, measurements, scene, settings.since_first_reading);
    if (confidence.parameters > 1)
        summary.add("condition number of the scaled sensitivities", rounded(confidence.condition_number, 3));
    if (const auto weak = estimation::weak_combination(found.minimum, confidence)) {
        const double half = confidence.quantile * weak->standard_error;
        summary.add(weak->is_alike_effects ? "warning: hardly told apart" : "warning: hardly known",
                    combination_in_words(weak->direction, half, factors) +
                        (weak->is_alike_effects ? " changes the readings by no more than their noise"
                                                : " is still within the readings' noise"));
    }
    double between_steps = 0;
    for (std::size_t m = 0; m < measurements.size(); ++m)
        if (const double error = found.interpolation_error[m];
            error > 0.2 * measurements[m].deviation.value_or(1e-3 * confidence.noise_factor))
            between_steps = std::max(between_steps, error);
    if (between_steps > 0)
        summary.add("warning: readings between steps",
                    "may be off by " + mm(between_steps) +
                        " mm, the history being straight between creep steps; shorter steps help");
    summary.print();
    print_for_the_scene(found, scene, factors);
}

void fit_section(const Arguments& arguments)
{
    refuse_options(arguments, "a curve, not with --measurements",
                   {"stiffness", "elastic-mm", "load-day", "converged-day"});
    const std::string& input = arguments.input();
    const std::string measured = *arguments.text("measurements");
    if (!arguments.has("fit"))
        throw input_error("--fit is not given; wanted the factors to find");
    back_analysis::Settings settings;
    settings.factors = factors_in(*arguments.text("fit"));
    settings.since_first_reading = arguments.has("since-first-reading");
    settings.threads = static_cast<int>(arguments.whole_number("threads", 1, 1024).value_or(1));
    settings.most_runs = static_cast<int>(arguments.whole_number("runs", 1, 100000).value_or(60));
    const std::optional<std::string> readings_path = readings_file(arguments);
    store::check_writable(arguments.output());
    for (const std::string& path : {arguments.output(), readings_path.value_or(arguments.output())})
        refuse_loss(failed_name(path), {input, measured, arguments.output(), readings_path.value_or("")});

    const store::JointsFile file = store::read_joints(input);
    const Scene scene = scene::parse_scene(file.provenance.scene, input + ": /scene");
    const std::string text = text_of(measured);
    const std::vector<scene::Measurement> measurements =
        of_file(measured, [&] { return scene::measurements_in_csv(text, scene); });
    if (measurements.size() <= settings.factors.size())
        throw input_error(measured + ": " + std::to_string(measurements.size()) + " readings for " +
                          std::to_string(settings.factors.size()) + " factors; wanted more readings");
    std::optional<Progress> progress(arguments.quiet());
    const back_analysis::Found found = of_lines_of_file(measured, [&] {
        return back_analysis::fit(scene, file.network, file.equivalent, measurements, settings,
                                  [&](int run, const std::vector<double>& factors) {
                                      std::string words = "run " + std::to_string(run + 1) + ":";
                                      for (const double factor : factors)
                                          words += ' ' + rounded(factor, 3);
                                      progress->show(1 - std::pow(0.8, run), words);
                                  });
    });
    progress.reset();
    const auto name = [&](const std::string& path) {
        return found.minimum.is_converged ? path : failed_name(path);
    };
    if (readings_path)
        write(name(*readings_path), readings_table(found, measurements, scene));
    write(name(arguments.output()),
          found_table(found, settings.factors, measurements.front().deviation.has_value()));
    if (!found.minimum.is_converged)
        throw fit_error(why_not_converged(found, settings.factors) + "\nthe best so far is in " +
                        name(arguments.output()));
    if (!arguments.quiet())
        report(found, measurements, scene, settings);
}

void fit_and_write(const Arguments& arguments)
{
    arguments.output(); // refuse early
    if (arguments.has("measurements"))
        fit_section(arguments);
    else
        fit_curve(arguments);
}

} // namespace

int main(int argc, char** argv)
{
    return run(program, argc, argv, fit_and_write);
}
