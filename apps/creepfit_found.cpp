#include "creepfit_found.hpp"

#include "creepfit_words.hpp"

#include "exchange/csv.hpp"
#include "model/error.hpp"
#include "model/units.hpp"
#include "program.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
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

// The bound of a factor, from its logarithm; empty where there is none.
std::string shown_bound(double logarithm)
{
    return std::isfinite(logarithm) ? shown(std::exp(logarithm)) : std::string();
}

std::string word_of(AtBound at)
{
    return at == AtBound::no ? "no" : at == AtBound::low ? "low" : "high";
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
    const std::string value = rounded(found.factors[i]);
    if (const AtBound at = found.minimum.at_bound[i]; at != AtBound::no)
        return value + ": at its " + (at == AtBound::low ? "lower" : "upper") +
               " bound; the readings fit better beyond it";
    if (found.confidence.is_fixed[i])
        return value + ": it does not change these readings";
    const auto index = static_cast<Eigen::Index>(i);
    const auto shown_range = [&](bool all_together) {
        const Interval of = found.confidence.interval(found.minimum.parameters[index], index, all_together);
        return shown_interval({std::exp(of.low), std::exp(of.high)});
    };
    return value + " (95 %: " + shown_range(false) + "; all together: " + shown_range(true) + ")";
}

void add_factors(Summary& summary, const Found& found, const Factors& factors)
{
    for (std::size_t i = 0; i < factors.size(); ++i)
        summary.add("factor on " + words_of(factors[i].scaled), shown_factor(found, i));
    const Confidence& confidence = found.confidence;
    for (std::size_t i = 0; i < factors.size(); ++i)
        for (std::size_t j = i + 1; j < factors.size(); ++j)
            if (!confidence.is_fixed[i] && !confidence.is_fixed[j])
                summary.add("correlation of " + option_of(factors[i].scaled) + " and " +
                                option_of(factors[j].scaled),
                            rounded(confidence.correlation(static_cast<Eigen::Index>(i),
                                                           static_cast<Eigen::Index>(j)),
                                    3));
}

void add_noise(Summary& summary, const Confidence& confidence, bool knows_deviations)
{
    if (knows_deviations)
        summary.add("chi squared", rounded(confidence.sum_of_squares) + " of " +
                                       std::to_string(confidence.readings - confidence.parameters) +
                                       " degrees of freedom, p " + rounded(confidence.p_value, 2));
    else
        summary.add("standard deviation of residuals", mm(1e-3 * confidence.noise_factor) + " mm");
    summary.add("noise taken as", noise_in_words(confidence, knows_deviations));
}

struct Residual {
    double time;  // of the reading [s]
    double value; // computed less measured [m]
};

// Residuals of a point in one direction.
std::vector<Residual> residuals_of(std::size_t point, int component, const Found& found,
                                   const Measurements& measurements)
{
    std::vector<Residual> residuals;
    for (std::size_t m = 0; m < measurements.size(); ++m)
        if (measurements[m].point == point && measurements[m].component == component)
            residuals.push_back(
                {measurements[m].time, found.computed[m].at_end - measurements[m].displacement});
    return residuals;
}

void add_residuals(Summary& summary, const std::string& label, std::vector<Residual> residuals,
                   bool share_an_error)
{
    std::vector<double> values(residuals.size());
    std::transform(residuals.begin(), residuals.end(), values.begin(), std::mem_fn(&Residual::value));
    const double mean =
        std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
    summary.add("residuals of " + label, "mean " + mm(mean) + " mm, root mean square " +
                                             mm(root_mean_square(values)) + " mm, " +
                                             std::to_string(values.size()) + " readings");
    std::stable_sort(residuals.begin(), residuals.end(),
                     [](const Residual& a, const Residual& b) { return a.time < b.time; });
    std::transform(residuals.begin(), residuals.end(), values.begin(), [&](const Residual& residual) {
        return share_an_error ? residual.value - mean : residual.value;
    });
    if (values.size() > 3)
        warn_of_lag(summary, ", " + label, estimation::lag_one_correlation(values), values.size());
}

void add_points(Summary& summary, const Found& found, const Measurements& measurements, const Scene& scene,
                bool share_an_error)
{
    for (std::size_t p = 0; p < scene.points.size(); ++p)
        for (const int component : {0, 1})
            if (const auto residuals = residuals_of(p, component, found, measurements); !residuals.empty())
                add_residuals(summary, scene.points[p].name + (component == 0 ? ", x" : ", y"), residuals,
                              share_an_error);
}

// What a combination of factors changes, in words: "kelvin-stiffness x 1.1 with joint-stiffness x 0.95".
std::string combination_in_words(const Eigen::VectorXd& direction, double by, const Factors& factors)
{
    std::string words;
    for (std::size_t i = 0; i < factors.size(); ++i) {
        const double share = direction[static_cast<Eigen::Index>(i)];
        if (std::abs(share) < 0.1)
            continue;
        words += (words.empty() ? "" : " with ") + option_of(factors[i].scaled) + " x " +
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
    double E = 1, eta = 1, K = 1;
    for (std::size_t i = 0; i < factors.size(); ++i) {
        if (found.confidence.is_fixed[i] && found.minimum.at_bound[i] == AtBound::no)
            continue;
        const double f = found.factors[i];
        switch (factors[i].scaled) {
        case Scaled::kelvin_stiffness:
            E *= f;
            break;
        case Scaled::kelvin_viscosity:
            eta *= f;
            break;
        case Scaled::joint_stiffness:
            K *= f;
            E *= f;
            eta *= f;
            break;
        case Scaled::horizontal_stress:
            print_stress(scene.in_situ_stress, f);
        }
    }
    // Advice for joint materials: only where joints have their constants.
    if (scene.averaging.stiffness != StiffnessRule::joint || (E == 1 && eta == 1 && K == 1))
        return;
    std::cout << "\nIn the scene: multiply all stiffnesses of joint materials by " << rounded(K, 6)
              << ", their Kelvin stiffnesses by " << rounded(E, 6)
              << ", and their Kelvin and Maxwell viscosities by " << rounded(eta, 6) << ".\n";
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
        "weak_combination_times,converged,runs,chi_squared,degrees_of_freedom,condition_number";
    for (const back_analysis::Factor& factor : factors)
        table += ",correlation_" + option_of(factor.scaled);
    table += '\n';
    for (std::size_t i = 0; i < factors.size(); ++i) {
        const auto index = static_cast<Eigen::Index>(i);
        const double logarithm = found.minimum.parameters[index];
        const Interval each = confidence.interval(logarithm, index),
                       all = confidence.interval(logarithm, index, true);
        table += option_of(factors[i].scaled) + ',' + shown(found.factors[i]) + ',' + shown_bound(each.low) +
                 ',' + shown_bound(each.high) + ',' + shown_bound(all.low) + ',' + shown_bound(all.high) +
                 ',' + (confidence.is_fixed[i] ? "" : shown(confidence.standard_error(index))) + ',' +
                 word_of(found.minimum.at_bound[i]) + ',' +
                 (weak ? shown(std::exp(weak->direction[index] * confidence.quantile * weak->standard_error))
                       : "") +
                 ',' + of_fit;
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
        "time_day,stages,point,component,measured_mm,computed_mm,residual_mm,computed_at_start_mm";
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
                 shown(at_end * 1e3) + ',' + shown((at_end - measured.displacement) * 1e3) + ',' +
                 shown(at_start * 1e3);
        if (knows)
            table += ',' + shown(*measured.deviation * 1e3);
        table += '\n';
    }
    return table;
}

std::string why_not_converged(const Found& found, const Factors& factors)
{
    const estimation::Minimum& minimum = found.minimum;
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
    return why + (minimum.has_stalled ? "\nwanted other bounds in --fit, or fewer factors"
                                      : "\nwanted more --runs");
}

void report(const Arguments& arguments, const Found& found, const Measurements& measurements,
            const Scene& scene, const back_analysis::Settings& settings)
{
    const Factors& factors = settings.factors;
    Summary summary;
    summary.add("readings", measurements.size());
    summary.add("runs", found.minimum.evaluations);
    if (!found.without_answer.empty())
        summary.add("runs without an answer", shown_without_answer(found, factors));
    add_factors(summary, found, factors);
    add_noise(summary, found.confidence, measurements.front().deviation.has_value());
    if (settings.since_first_reading)
        summary.add("first readings", "have the same noise; it is in all readings that count from them");
    add_points(summary, found, measurements, scene, settings.since_first_reading);
    if (found.confidence.parameters > 1)
        summary.add("condition number of the scaled sensitivities",
                    rounded(found.confidence.condition_number, 3));
    warn_of_weak_combination(summary, found, factors);
    warn_of_interpolation(summary, found, measurements);
    summary.print(arguments);
    if (!arguments.quiet())
        print_for_the_scene(found, scene, factors);
}

} // namespace jointcreep::creepfit
