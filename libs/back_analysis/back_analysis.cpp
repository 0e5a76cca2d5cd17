#include "back_analysis/back_analysis.hpp"

#include "model/error.hpp"
#include "model/units.hpp"

#include <algorithm>
#include <cmath>

namespace jointcreep::back_analysis
{

using estimation::Evaluation;
using estimation::VectorXd;

namespace
{

constexpr double usual_deviation = 1e-3; // where none is given: all alike [m]

// Shares of rows of the history in a value.
using Rows = std::vector<std::pair<std::size_t, double>>;

[[noreturn]] void refuse(const Scene& scene, const Measurement& measurement, const std::string& why)
{
    throw input_error("line " + std::to_string(measurement.line) + ": point \"" +
                      scene.points[measurement.point].name + "\" on day " +
                      shown(measurement.time / unit::day) + ": " + why);
}

// The rows at or around a time. Of several at one time the first, or the last.
Rows rows_at(const History& history, double day, bool first)
{
    const auto begin = history.time.begin(), end = history.time.end();
    const double rounding = 1e-9 * (1 + day);
    const auto not_before = std::lower_bound(begin, end, day - rounding);
    if (not_before == end)
        return {{history.time.size() - 1, 1.0}}; // creep has ended before
    const auto after = std::upper_bound(begin, end, day + rounding);
    if (not_before != after)
        return {{static_cast<std::size_t>((first ? not_before : after - 1) - begin), 1.0}};
    const double share = (day - *(after - 1)) / (*after - *(after - 1));
    const auto row = static_cast<std::size_t>(after - begin);
    return {{row - 1, 1 - share}, {row, share}};
}

// How far the straight way between two rows may be off, by the bend of the row before: second differences.
double bend(const History& history, const Rows& rows, std::size_t point, int component)
{
    if (rows.size() < 2 || rows[0].first == 0)
        return 0;
    const std::size_t points = history.point.size(), r = rows[0].first;
    const auto u = [&](std::size_t row) { return history.displacement[row * points + point][component]; };
    const double before = history.time[r] - history.time[r - 1],
                 after = history.time[r + 1] - history.time[r];
    if (!(before > 0))
        return 0; // a stage
    const double second = 2 * ((u(r + 1) - u(r)) / after - (u(r) - u(r - 1)) / before) / (before + after);
    return std::abs(second) / 2 * rows[0].second * rows[1].second * after * after;
}

} // namespace

Prediction predict(const Scene& scene, const History& history,
                   const std::vector<std::vector<Eigen::Vector2d>>& sensitivities,
                   const std::vector<Measurement>& measurements, bool since_first_reading)
{
    const std::size_t points = history.point.size();
    Prediction found;
    found.sensitivity.resize(static_cast<Eigen::Index>(measurements.size()),
                             static_cast<Eigen::Index>(sensitivities.size()));
    for (std::size_t m = 0; m < measurements.size(); ++m) {
        const Measurement& measurement = measurements[m];
        const double day = measurement.time / unit::day;
        Rows rows = rows_at(history, day, measurement.is_before_stage);
        for (const auto& [row, share] : rows)
            if (history.present[row * points + measurement.point] == 0)
                refuse(scene, measurement, "the rock that the point is in has been removed by then");
        found.interpolation_error = std::max(found.interpolation_error,
                                             bend(history, rows, measurement.point, measurement.component));
        if (since_first_reading) {
            const double first = scene.points[measurement.point].first_reading;
            if (measurement.time < first)
                refuse(scene, measurement,
                       "its first reading is on day " + shown(first / unit::day) +
                           ", and measurements count from there");
            rows.emplace_back(history.first_reading_row[measurement.point], -1.0);
        }
        const auto value = [&](const std::vector<Eigen::Vector2d>& of) {
            double sum = 0;
            for (const auto& [row, share] : rows)
                sum += share * of[row * points + measurement.point][measurement.component];
            return sum;
        };
        found.displacement.push_back(value(history.displacement));
        for (std::size_t p = 0; p < sensitivities.size(); ++p)
            found.sensitivity(static_cast<Eigen::Index>(m), static_cast<Eigen::Index>(p)) =
                value(sensitivities[p]);
    }
    return found;
}

Found fit(const Scene& scene, const Network& network, const EquivalentJoints& joints,
          const std::vector<Measurement>& measurements, const Settings& settings, const RunObserver& observe)
{
    const auto n = static_cast<Eigen::Index>(settings.factors.size());
    VectorXd start(n), low(n), high(n);
    Recording recording;
    for (Eigen::Index i = 0; i < n; ++i) {
        const Factor& factor = settings.factors[static_cast<std::size_t>(i)];
        recording.parameters.push_back(factor.parameter);
        start[i] = std::log(factor.start);
        low[i] = std::log(factor.low);
        high[i] = std::log(factor.high);
    }
    const bool knows_deviations = !measurements.empty() && measurements.front().deviation.has_value();
    const auto factors_at = [&](const VectorXd& logarithms) {
        std::vector<double> factors;
        for (const double logarithm : logarithms)
            factors.push_back(std::exp(logarithm));
        return factors;
    };

    int runs = 0;
    std::vector<double> at_start;
    double interpolation_error = 0; // of the last run
    const estimation::Model model = [&](const VectorXd& logarithms) -> std::optional<Evaluation> {
        const bool is_first = runs == 0;
        const std::vector<double> factors = factors_at(logarithms);
        if (observe)
            observe(runs, factors);
        ++runs;
        Scene changed = scene;
        EquivalentJoints stiffer = joints;
        for (std::size_t i = 0; i < factors.size(); ++i)
            sensitivity::scale(stiffer, changed.in_situ_stress, settings.factors[i].parameter, factors[i]);
        try {
            Analysis analysis(changed, network, stiffer, settings.threads, recording,
                              [](double, const std::string&) {});
            analysis.run();
            const Prediction found = predict(scene, analysis.result().history, analysis.sensitivities(),
                                             measurements, settings.since_first_reading);
            interpolation_error = found.interpolation_error;
            if (is_first)
                at_start = found.displacement;
            Evaluation at{VectorXd(found.sensitivity.rows()), found.sensitivity};
            for (std::size_t m = 0; m < measurements.size(); ++m) {
                const auto row = static_cast<Eigen::Index>(m);
                const double deviation = measurements[m].deviation.value_or(usual_deviation);
                at.residual[row] = (found.displacement[m] - measurements[m].displacement) / deviation;
                at.jacobian.row(row) /= deviation;
            }
            return at;
        } catch (const equilibrium_error&) {
            if (is_first)
                throw;
        } catch (const input_error&) { // the published scheme's limit, which goes with the factors
            if (is_first)
                throw;
        }
        return {};
    };

    Found found;
    // A step that would win a thousandth of a standard error is not worth a run.
    found.minimum = estimation::minimise(model, start, low, high, settings.most_runs,
                                         1e-6 / static_cast<double>(measurements.size()));
    found.factors = factors_at(found.minimum.parameters);
    found.confidence = estimation::confidence_of(found.minimum, knows_deviations);
    found.interpolation_error = interpolation_error;
    for (std::size_t m = 0; m < measurements.size(); ++m)
        found.computed.push_back(
            {at_start[m],
             measurements[m].displacement + found.minimum.there.residual[static_cast<Eigen::Index>(m)] *
                                                measurements[m].deviation.value_or(usual_deviation)});
    return found;
}

} // namespace jointcreep::back_analysis
