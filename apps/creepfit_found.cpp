#include "creepfit_found.hpp"

#include "creepfit_errors.hpp"
#include "creepfit_words.hpp"

#include "exchange/csv.hpp"
#include "model/error.hpp"
#include "model/units.hpp"
#include "program.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <numeric>

namespace jointcreep::creepfit
{

using back_analysis::Found;
using estimation::AtBound;
using estimation::Confidence;
using estimation::Interval;
using Measurements = std::vector<scene::Measurement>;

namespace
{

// "A, y".
std::string name_of(const back_analysis::Series& series, const Scene& scene)
{
    return scene.points[series.point].name + (series.component == 0 ? ", x" : ", y");
}

ErrorsFound errors_of(const Found& found, const Measurements& measurements, const Scene& scene)
{
    return {found.errors,
            found.outliers,
            found.doubts,
            found.correlation_time,
            found.confidence,
            [&](std::size_t series) { return name_of(found.series[series], scene); },
            [&](std::size_t reading) {
                const scene::Measurement& m = measurements[reading];
                return name_of({m.point, m.component}, scene) + " on day " + rounded(m.time / unit::day, 6);
            }};
}

// Names of the factors for whose number this holds, separated by commas.
template <class Holds>
std::string names_where(const Factors& factors, const Holds& holds)
{
    std::string names;
    for (std::size_t i = 0; i < factors.size(); ++i)
        if (holds(i))
            names += (names.empty() ? "" : ", ") + option_of(factors[i]);
    return names;
}

// The bound of a factor, from its logarithm; empty where there is none.
std::string shown_bound(double logarithm)
{
    return std::isfinite(logarithm) ? shown(std::exp(logarithm)) : std::string();
}

std::string word_of(AtBound at)
{
    return at == AtBound::no ? "no" : at == AtBound::low ? "low" : "high";
}

std::string word_of(estimation::Error kind)
{
    switch (kind) {
    case estimation::Error::offset:
        return "offset";
    case estimation::Error::drift:
        return "drift";
    case estimation::Error::step:
        return "step";
    case estimation::Error::single:
        return "outlier";
    case estimation::Error::lasting:
        break;
    }
    return "correlation";
}

// How many, and where the last one was.
std::string shown_without_answer(const Found& found, const Factors& factors)
{
    const back_analysis::WithoutAnswer& last = found.without_answer.back();
    std::string reason = last.reason;
    std::replace(reason.begin(), reason.end(), '\n', ' ');
    return std::to_string(found.without_answer.size()) + ", the last at " + in_words(factors, last.factors) +
           ": " + reason;
}

// A factor with its intervals, or why it has none.
std::string shown_factor(const Found& found, std::size_t i)
{
    const auto shown_range = [&](bool with_all) {
        const Interval of = found.interval(i, with_all);
        return shown_interval({std::exp(of.low), std::exp(of.high)});
    };
    const std::string value = rounded(found.factors[i]) +
                              (found.is_resolved[i] ? "" : ": not resolved by these readings"),
                      intervals =
                          " (95 %: " + shown_range(false) + "; all together: " + shown_range(true) + ")";
    if (found.better)
        return rounded(found.factors[i]) + ": no intervals, because a better fit was found";
    if (const AtBound at = found.minimum.at_bound[i]; at != AtBound::no) {
        const std::string bound = at == AtBound::low ? "lower bound" : "upper bound";
        return found.members > 0
                   ? value + ": the readings and the bounds do not agree, they want it beyond its " + bound
                   : value + ": at its " + bound + "; the readings fit better beyond it" +
                         (found.profiles.empty() ? "" : intervals);
    }
    if (found.confidence.is_fixed[i])
        return rounded(found.factors[i]) + ": not resolved: it does not change these readings";
    return value + intervals;
}

void add_factors(Summary& summary, const Found& found, const Factors& factors)
{
    for (std::size_t i = 0; i < factors.size(); ++i)
        summary.add("factor on " + words_of(factors[i]), shown_factor(found, i));
    const Confidence& confidence = found.confidence;
    for (std::size_t i = 0; i < factors.size(); ++i)
        for (std::size_t j = i + 1; j < factors.size(); ++j)
            if (!confidence.is_fixed[i] && !confidence.is_fixed[j])
                summary.add("correlation of " + option_of(factors[i]) + " and " + option_of(factors[j]),
                            rounded(confidence.correlation(static_cast<Eigen::Index>(i),
                                                           static_cast<Eigen::Index>(j)),
                                    3));
}

void add_noise(Summary& summary, const Confidence& confidence, bool knows_deviations,
               const estimation::Errors& errors)
{
    if (knows_deviations && !errors.robust && !errors.correlated)
        summary.add("chi squared", rounded(confidence.sum_of_squares) + " of " +
                                       std::to_string(confidence.readings - confidence.parameters) +
                                       " degrees of freedom, p " + rounded(confidence.p_value, 2));
    else if (knows_deviations)
        summary.add("noise over the readings' sigma", rounded(confidence.noise_factor));
    else
        summary.add("standard deviation of residuals", mm(1e-3 * confidence.noise_factor) + " mm");
    summary.add("noise taken as", noise_in_words(confidence, knows_deviations, errors));
}

void add_points(Summary& summary, const Found& found, const Measurements& measurements, const Scene& scene)
{
    for (const back_analysis::Series& series : found.series) {
        std::vector<double> residuals;
        for (std::size_t m = 0; m < measurements.size(); ++m)
            if (measurements[m].point == series.point && measurements[m].component == series.component)
                residuals.push_back(found.computed[m].at_end + found.instrument[m] -
                                    measurements[m].displacement);
        const double mean =
            std::accumulate(residuals.begin(), residuals.end(), 0.0) / static_cast<double>(residuals.size());
        summary.add("residuals of " + name_of(series, scene),
                    "mean " + mm(mean) + " mm, root mean square " + mm(root_mean_square(residuals)) +
                        " mm, " + std::to_string(residuals.size()) + " readings");
    }
}

// What a combination of factors changes, in words: "kelvin-stiffness x 1.1 with joint-stiffness x 0.95".
std::string combination_in_words(const Eigen::VectorXd& direction, double by, const Factors& factors)
{
    std::string words;
    for (std::size_t i = 0; i < factors.size(); ++i) {
        const double share = direction[static_cast<Eigen::Index>(i)];
        if (std::abs(share) < 0.1)
            continue;
        words += (words.empty() ? "" : " with ") + option_of(factors[i]) + " x " +
                 rounded(std::exp(share * by), 3);
    }
    return words;
}

void warn_of_weak_combination(Summary& summary, const Found& found, const Factors& factors)
{
    const auto weak = estimation::weak_combination(found.minimum, found.confidence);
    if (!weak)
        return;
    const double half = found.confidence.quantile * weak->standard_error;
    summary.warn((weak->is_alike_effects ? "hardly distinguished: " : "hardly known: ") +
                 combination_in_words(weak->direction, half, factors) +
                 (weak->is_alike_effects ? " changes the readings by no more than their noise"
                                         : " is still within the readings' noise"));
}

// A profile search that found a smaller sum of squares.
void warn_of_better(Summary& summary, const Found& found, const Factors& factors)
{
    if (!found.better)
        return;
    std::string from;
    for (std::size_t i = 0; i < factors.size(); ++i)
        from += (i > 0 ? "," : "") + option_of(factors[i]) + '=' + shown(factors[i].low) + ':' +
                shown(std::clamp(std::exp(found.better->parameters[static_cast<Eigen::Index>(i)]),
                                 factors[i].low, factors[i].high)) +
                ':' + shown(factors[i].high);
    summary.warn("this fit is not the best: its sum of squares is " +
                 rounded(found.minimum.sum_of_squares()) + ", and the runs of profile intervals found " +
                 rounded(found.better->sum_of_squares) +
                 ". Factors have no intervals. Start from there: --fit \"" + from + '"');
}

void warn_of_ends_not_found(Summary& summary, const Found& found, const back_analysis::Settings& settings)
{
    for (std::size_t i = 0; i < found.profiles.size(); ++i)
        for (const estimation::NotFound& end : found.profiles[i].not_found)
            summary.warn(std::string("the ") + (end.is_high ? "upper" : "lower") +
                         " end of the interval of " + option_of(settings.factors[i]) +
                         (end.is_with_all ? ", all together," : "") + " was not found in " +
                         std::to_string(settings.most_profile_runs) + " runs: it is " +
                         (end.is_high ? "above " : "below ") + rounded(std::exp(end.beyond)) +
                         ". The interval is shown without this end");
}

// Factors whose prior and readings disagree.
void warn_of_disagreement(Summary& summary, const Found& found, const Factors& factors)
{
    std::string words;
    for (std::size_t i = 0; i < factors.size(); ++i)
        if (const AtBound at = found.minimum.at_bound[i]; found.members > 0 && at != AtBound::no)
            words += (words.empty() ? "" : ", ") + option_of(factors[i]) +
                     (at == AtBound::low ? " below" : " above");
    if (!words.empty())
        summary.warn(
            "readings and bounds do not agree: the readings want " + words +
            " its bounds. Values are between both, and the intervals may not contain the truth. Give wider bounds");
}

// Factors whose intervals are hardly more than what the bounds say.
void warn_of_bounds(Summary& summary, const Found& found, const Factors& factors)
{
    if (found.is_by_bounds.empty())
        return;
    const std::string names =
        names_where(factors, [&](std::size_t i) { return found.is_by_bounds[i] && found.is_resolved[i]; });
    if (!names.empty())
        summary.warn("the bounds determine more than the readings: " + names +
                     ". The interval is right only if the bounds are");
}

// Names of the columns with ends that were not found: "low_95 low_95_all".
std::string ends_not_found(const Found& found, std::size_t i)
{
    std::string names;
    if (!found.profiles.empty())
        for (const estimation::NotFound& end : found.profiles[i].not_found)
            names += (names.empty() ? "" : " ") + std::string(end.is_high ? "high_95" : "low_95") +
                     (end.is_with_all ? "_all" : "");
    return names;
}

// Between creep steps the history is interpolated linearly.
void warn_of_interpolation(Summary& summary, const Found& found, const Measurements& measurements)
{
    double between_steps = 0;
    for (std::size_t m = 0; m < measurements.size(); ++m)
        if (const double error = found.interpolation_error[m];
            error > 0.2 * measurements[m].deviation.value_or(1e-3 * found.confidence.noise_factor))
            between_steps = std::max(between_steps, error);
    if (between_steps > 0)
        summary.warn("readings between steps may be off by " + mm(between_steps) +
                     " mm: histories are linear between creep steps. Use shorter steps");
}

void print_stress(const InSituStress& stress, double factor)
{
    if (stress.horizontal_ratio) {
        std::cout << "\nIn the scene:\n[in_situ_stress]\nhorizontal_stress_ratio = "
                  << rounded(*stress.horizontal_ratio * factor, 6) << '\n';
        return;
    }
    if (stress.profile.empty()) {
        std::cout << "\nIn the scene:\n[in_situ_stress]\ncompression_xx_MPa = "
                  << rounded(stress.compression_xx * factor / unit::MPa, 6)
                  << "\ncompression_xx_gradient_MPa_per_m = "
                  << rounded(stress.gradient_xx * factor / unit::MPa, 6) << '\n';
        return;
    }
    std::cout << "\nIn the scene: multiply all compression_xx_MPa of the profile of [in_situ_stress] by "
              << rounded(factor, 6) << ':';
    for (const InSituStress::Level& level : stress.profile)
        std::cout << ' ' << rounded(level.compression_xx * factor / unit::MPa, 6);
    std::cout << ".\n";
}

// What to write into the scene. Factors that do not change the readings are left out.
void print_for_the_scene(const Found& found, const Scene& scene, const Factors& factors)
{
    struct Constants {
        double E = 1, eta = 1, K = 1;
        bool operator==(const Constants&) const = default;
    };
    // Of each material, normal and shear.
    std::vector<std::array<Constants, 2>> materials(scene.joint_materials.size());
    for (std::size_t i = 0; i < factors.size(); ++i) {
        if (found.confidence.is_fixed[i] && found.minimum.at_bound[i] == AtBound::no)
            continue;
        const double f = found.factors[i];
        const Scaled& scaled = factors[i].scaled;
        if (scaled.quantity == Scaled::horizontal_stress)
            print_stress(scene.in_situ_stress, f);
        for (std::size_t m = 0; m < materials.size(); ++m)
            for (int direction = 0; direction < 2; ++direction) {
                if ((!factors[i].material.empty() && factors[i].material != scene.joint_materials[m].name) ||
                    !scaled.is_of(direction, Scaled::all))
                    continue;
                auto& [E, eta, K] = materials[m][static_cast<std::size_t>(direction)];
                const bool all = scaled.quantity == Scaled::joint_stiffness;
                if (all)
                    K *= f;
                if (all || scaled.quantity == Scaled::kelvin_stiffness)
                    E *= f;
                if (all || scaled.quantity == Scaled::kelvin_viscosity)
                    eta *= f;
            }
    }
    // Advice for joint materials: only where joints have their constants.
    if (scene.averaging.stiffness != StiffnessRule::joint)
        return;
    const auto say = [](const std::string& of, const std::string& direction, const Constants& by) {
        if (by != Constants{})
            std::cout << "\nIn the scene: multiply all " << direction << "stiffnesses of " << of << " by "
                      << rounded(by.K, 6) << ", their Kelvin stiffnesses by " << rounded(by.E, 6)
                      << ", and their Kelvin and Maxwell viscosities by " << rounded(by.eta, 6) << ".\n";
    };
    const std::array<Constants, 2>& first = materials.empty() ? std::array<Constants, 2>{} : materials[0];
    if (std::ranges::all_of(materials, [&](const auto& one) { return one == first; }) &&
        first[0] == first[1]) {
        say("joint materials", "", first[0]);
        return;
    }
    for (std::size_t m = 0; m < materials.size(); ++m) {
        say("joint material \"" + scene.joint_materials[m].name + '"', "normal ", materials[m][0]);
        say("joint material \"" + scene.joint_materials[m].name + '"', "shear ", materials[m][1]);
    }
}

} // namespace

std::string found_table(const Found& found, const Factors& factors, bool knows_deviations)
{
    const Confidence& confidence = found.confidence;
    const auto weak = estimation::weak_combination(found.minimum, confidence);
    // Columns of the whole fit: the same in every row.
    const std::string of_fit = std::string(found.minimum.is_converged ? "yes" : "no") + ',' +
                               std::to_string(found.minimum.evaluations) + ',' +
                               (knows_deviations ? shown(confidence.sum_of_squares) : "") + ',' +
                               std::to_string(confidence.readings - confidence.parameters) + ',' +
                               shown(confidence.condition_number);
    std::string table =
        "factor,value,low_95,high_95,low_95_all,high_95_all,standard_error_of_logarithm,at_bound,"
        "weak_combination_times,converged,runs,chi_squared,degrees_of_freedom,condition_number,resolved,doubt,"
        "doubt_p_value,better_value,ends_not_found";
    for (const back_analysis::Factor& factor : factors)
        table += ',' + exchange::csv_field("correlation_" + option_of(factor));
    table += '\n';
    for (std::size_t i = 0; i < factors.size(); ++i) {
        const auto index = static_cast<Eigen::Index>(i);
        const Interval each = found.interval(i), all = found.interval(i, true);
        table += exchange::csv_field(option_of(factors[i])) + ',' + shown(found.factors[i]) + ',' +
                 shown_bound(each.low) + ',' + shown_bound(each.high) + ',' + shown_bound(all.low) + ',' +
                 shown_bound(all.high) + ',' +
                 (confidence.is_fixed[i] ? "" : shown(confidence.standard_error(index))) + ',' +
                 word_of(found.minimum.at_bound[i]) + ',' +
                 (weak ? shown(std::exp(weak->direction[index] * confidence.quantile * weak->standard_error))
                       : "") +
                 ',' + of_fit + ',' + (found.is_resolved[i] ? "yes" : "no") + ',' +
                 (found.doubts.empty()
                      ? ","
                      : word_of(found.doubts.front().kind) + ',' + shown(found.doubts.front().p_value)) +
                 ',' + (found.better ? shown(std::exp(found.better->parameters[index])) : "") + ',' +
                 ends_not_found(found, i);
        for (Eigen::Index j = 0; j < confidence.correlation.cols(); ++j)
            table += ',' + shown(confidence.correlation(index, j));
        table += '\n';
    }
    return table;
}

std::string readings_table(const Found& found, const Measurements& measurements, const Scene& scene)
{
    const bool knows = measurements.front().deviation.has_value();
    std::string table =
        "time_day,stages,point,component,measured_mm,computed_mm,residual_mm,computed_at_start_mm,instrument_mm";
    table += knows ? ",sigma_mm\n" : "\n";
    for (std::size_t m = 0; m < measurements.size(); ++m) {
        const scene::Measurement& measured = measurements[m];
        const auto& [at_start, at_end] = found.computed[m];
        const auto stages = std::count_if(scene.stages.begin(), scene.stages.end(), [&](const Stage& stage) {
            return measured.is_before_stage ? stage.time < measured.time : stage.time <= measured.time;
        });
        table += shown(measured.time / unit::day) + ',' + std::to_string(stages) + ',' +
                 exchange::csv_field(scene.points[measured.point].name) + ',' +
                 (measured.component == 0 ? "x" : "y") + ',' + shown(measured.displacement * 1e3) + ',' +
                 shown(at_end * 1e3) + ',' +
                 shown((at_end + found.instrument[m] - measured.displacement) * 1e3) + ',' +
                 shown(at_start * 1e3) + ',' + shown(found.instrument[m] * 1e3);
        if (knows)
            table += ',' + shown(*measured.deviation * 1e3);
        table += '\n';
    }
    return table;
}

std::string why_not_converged(const Found& found, const Factors& factors)
{
    const estimation::Minimum& minimum = found.minimum;
    if (!found.is_settled)
        return "no fit was found: " + std::string(not_settled);
    if (!found.failure.empty())
        return "no fit was found in " + std::to_string(minimum.evaluations) + " runs: " + found.failure +
               "; the best is " + in_words(factors, found.factors) +
               (found.without_answer.empty()
                    ? ""
                    : "\nruns without an answer: " + shown_without_answer(found, factors)) +
               "\nexpected narrower bounds in --fit, or a larger --ensemble";
    std::vector<double> wanted;
    for (std::size_t i = 0; i < factors.size(); ++i)
        wanted.push_back(found.factors[i] * std::exp(minimum.left[static_cast<Eigen::Index>(i)]));
    std::string why = "no fit was found in " + std::to_string(minimum.evaluations) + " runs: the best is " +
                      in_words(factors, found.factors) + "; the next step would be to " +
                      in_words(factors, wanted);
    if (minimum.has_stalled)
        why += ", but no run in that direction was better";
    if (!found.without_answer.empty())
        why += "\nruns without an answer: " + shown_without_answer(found, factors);
    return why + (found.members > 0
                      ? "\nexpected a larger --ensemble, narrower bounds in --fit, or fewer factors"
                  : minimum.has_stalled ? "\nexpected other bounds in --fit, or fewer factors"
                                        : "\nexpected more --runs");
}

void report(const Arguments& arguments, const Found& found, const Measurements& measurements,
            const Scene& scene, const back_analysis::Settings& settings)
{
    const Factors& factors = settings.factors;
    Summary summary;
    summary.add("readings", measurements.size());
    summary.add("runs",
                std::to_string(found.minimum.evaluations) +
                    (found.members > 0 ? ", by an ensemble of " + std::to_string(found.members) : ""));
    if (!found.profiles.empty())
        summary.add("runs of profile intervals", found.profile_runs);
    if (!found.without_answer.empty())
        summary.add("runs without an answer", shown_without_answer(found, factors));
    add_factors(summary, found, factors);
    const ErrorsFound of_instruments = errors_of(found, measurements, scene);
    add_errors(summary, of_instruments);
    add_outliers_and_lasting(summary, of_instruments, settings.errors);
    add_noise(summary, found.confidence, measurements.front().deviation.has_value(), settings.errors);
    if (settings.since_first_reading)
        summary.add("first readings", "have the same noise; it is in all readings that count from them");
    add_points(summary, found, measurements, scene);
    if (found.confidence.parameters > 1)
        summary.add("condition number of the scaled sensitivities",
                    rounded(found.confidence.condition_number, 3));
    warn_of_weak_combination(summary, found, factors);
    warn_of_interpolation(summary, found, measurements);
    warn_of_better(summary, found, factors);
    warn_of_ends_not_found(summary, found, settings);
    warn_of_disagreement(summary, found, factors);
    warn_of_bounds(summary, found, factors);
    const std::string not_resolved =
        names_where(factors, [&](std::size_t i) { return !found.is_resolved[i]; });
    if (!not_resolved.empty() && !found.better)
        summary.warn(
            "not resolved by these readings: " + not_resolved +
            (found.profiles.empty()
                 ? ", which may be 10 times as large or as small. Fit fewer factors"
                 : ", whose interval extends to a bound or by a factor of 10. Fit fewer factors, or give "
                   "wider bounds"));
    warn_of_doubts(summary, of_instruments);
    // One without any effect stays as it is in the scene.
    bool may_advise = !is_doubtful(of_instruments);
    for (std::size_t i = 0; i < factors.size(); ++i)
        may_advise = may_advise &&
                     (found.is_resolved[i] ||
                      (found.confidence.is_fixed[i] && found.minimum.at_bound[i] == AtBound::no)) &&
                     (found.members == 0 || found.minimum.at_bound[i] == AtBound::no);
    if (!may_advise)
        summary.add("values for the scene", "none, because of the warnings");
    summary.print(arguments);
    if (!arguments.quiet() && may_advise)
        print_for_the_scene(found, scene, factors);
}

Networks networks_of(std::vector<Found> found, const std::vector<std::string>& files, const Factors& factors,
                     bool knows_deviations)
{
    std::vector<estimation::OfOneModel> models;
    for (const Found& one : found)
        models.push_back({one.minimum.parameters, one.confidence});
    Networks networks{std::move(found), files, estimation::across(models, knows_deviations)};
    for (std::size_t i = 0; i < factors.size(); ++i)
        if (const auto& of = networks.across[i]; of && of->interval.high - of->value > std::log(10.0))
            networks.across[i].reset(); // not resolved
    return networks;
}

std::string networks_table(const Networks& networks, const Factors& factors)
{
    std::string table = "factor,value,low_95,high_95,low_95_all,high_95_all,standard_error_of_logarithm,"
                        "scatter_of_logarithm,networks,resolved";
    for (std::size_t k = 0; k < networks.found.size(); ++k)
        table += ",value_" + std::to_string(k + 1);
    table += '\n';
    for (std::size_t i = 0; i < factors.size(); ++i) {
        table += exchange::csv_field(option_of(factors[i])) + ',';
        const auto& of = networks.across[i];
        if (of)
            table += shown(std::exp(of->value)) + ',' + shown(std::exp(of->interval.low)) + ',' +
                     shown(std::exp(of->interval.high)) + ',' + shown(std::exp(of->with_all.low)) + ',' +
                     shown(std::exp(of->with_all.high)) + ',' + shown(of->standard_error) + ',' +
                     shown(of->scatter);
        else
            table += ",,,,,,";
        table += ',' + std::to_string(networks.found.size()) + ',' + (of ? "yes" : "no");
        for (const Found& found : networks.found)
            table += ',' + shown(found.factors[i]);
        table += '\n';
    }
    return table;
}

void report_networks(const Arguments& arguments, const Networks& networks, const Factors& factors)
{
    Summary summary;
    summary.add("networks", networks.found.size());
    for (std::size_t k = 0; k < networks.found.size(); ++k)
        summary.add(networks.file[k], in_words(factors, networks.found[k].factors));
    const std::string not_resolved = names_where(factors, [&](std::size_t i) { return !networks.across[i]; });
    for (std::size_t i = 0; i < factors.size(); ++i) {
        const auto& of = networks.across[i];
        if (!of)
            continue;
        const auto times = [](const Interval& by) {
            return shown_interval({std::exp(by.low), std::exp(by.high)});
        };
        summary.add("factor on " + words_of(factors[i]),
                    rounded(std::exp(of->value)) + " (95 %: " + times(of->interval) + "; all together: " +
                        times(of->with_all) + "); between networks x/ " + rounded(std::exp(of->scatter)));
    }
    const auto doubted = std::ranges::count_if(networks.found, [](const Found& found) {
        return !found.doubts.empty() || found.confidence.p_value < 0.01;
    });
    summary.add("residuals are no noise",
                std::to_string(doubted) + " of the networks; no network is that of the site");
    if (!not_resolved.empty())
        summary.warn(
            "not resolved by these readings and networks: " + not_resolved +
            ", which may be 10 times as large or as small. Fit fewer factors, or give more networks");
    summary.print(arguments);
}

} // namespace jointcreep::creepfit
