#include "back_analysis/back_analysis.hpp"

#include "joint/equivalent.hpp"
#include "model/error.hpp"
#include "model/units.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace jointcreep::back_analysis
{

using estimation::Evaluation;
using estimation::VectorXd;

namespace
{

constexpr double usual_deviation = 1e-3; // where none is given: all alike [m]

// Shares of rows of the history in a value.
using Rows = std::vector<std::pair<std::size_t, double>>;

[[noreturn]] void refuse(const Scene& scene, const scene::Measurement& measurement, const std::string& why)
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

// Error of linear interpolation between two rows, estimated by second differences at the row before [m].
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

double deviation_of(const scene::Measurement& measurement)
{
    return measurement.deviation.value_or(usual_deviation);
}

bool is_first(const Scene& scene, const scene::Measurement& measurement)
{
    constexpr double rounding = 1e-3; // [s]
    return std::abs(measurement.time - scene.points[measurement.point].first_reading) < rounding &&
           !measurement.is_before_stage;
}

// The measurements that count, and their series. Of those that count from a first one, which is 0 by definition and does
// not count, the others share its error: that of the first reading where it is listed, or else of the next. The sum of
// squares is then that with a free offset of each point and direction, the first reading, 0, being among the readings.
struct Chosen {
    std::vector<std::size_t> measurement;
    std::vector<Series> series;
    estimation::Readings readings;
};

Chosen chosen(const Scene& scene, const std::vector<scene::Measurement>& measurements,
              bool since_first_reading)
{
    Chosen found;
    std::map<std::pair<std::size_t, int>, std::size_t> places;
    std::vector<std::size_t> earliest; // of each series
    for (std::size_t m = 0; m < measurements.size(); ++m) {
        const scene::Measurement& measurement = measurements[m];
        const auto [place, is_new] =
            places.insert({{measurement.point, measurement.component}, found.series.size()});
        if (is_new) {
            found.series.push_back({measurement.point, measurement.component});
            earliest.push_back(m);
        } else if (std::size_t& first = earliest[place->second];
                   measurement.time < measurements[first].time) {
            first = m;
        }
        if (since_first_reading && is_first(scene, measurement)) {
            if (std::abs(measurement.displacement) > 1e-9)
                refuse(scene, measurement,
                       "it is the first reading, from which measurements count, and " +
                           shown(measurement.displacement) + " m; expected 0");
            continue;
        }
        found.measurement.push_back(m);
        found.readings.time.push_back(measurement.time);
        found.readings.series.push_back(place->second);
        found.readings.deviation.push_back(deviation_of(measurement));
    }
    if (since_first_reading)
        for (const std::size_t m : found.measurement)
            found.readings.shared.push_back(
                deviation_of(
                    measurements[earliest[places.at({measurements[m].point, measurements[m].component})]]) /
                deviation_of(measurements[m]));
    found.readings.knows_deviations = !measurements.empty() && measurements.front().deviation.has_value();
    return found;
}

} // namespace

Prediction predict(const Scene& scene, const History& history,
                   const std::vector<std::vector<Eigen::Vector2d>>& sensitivities,
                   const std::vector<scene::Measurement>& measurements, bool since_first_reading)
{
    const std::size_t points = history.point.size();
    Prediction found;
    found.sensitivity.resize(static_cast<Eigen::Index>(measurements.size()),
                             static_cast<Eigen::Index>(sensitivities.size()));
    for (std::size_t m = 0; m < measurements.size(); ++m) {
        const scene::Measurement& measurement = measurements[m];
        const double day = measurement.time / unit::day;
        Rows rows = rows_at(history, day, measurement.is_before_stage);
        for (const auto& [row, share] : rows)
            if (history.present[row * points + measurement.point] == 0)
                refuse(scene, measurement, "the rock that the point is in has been removed by then");
        found.interpolation_error.push_back(bend(history, rows, measurement.point, measurement.component));
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

namespace
{

std::vector<double> factors_at(const VectorXd& logarithms)
{
    std::vector<double> factors;
    for (const double logarithm : logarithms)
        factors.push_back(std::exp(logarithm));
    return factors;
}

// Runs of the section by factors, and what they gave.
class Runs
{
public:
    struct Done {
        VectorXd logarithms;                                   // of the factors
        std::vector<double> displacement, interpolation_error; // of each measurement [m]
    };

    Runs(const Scene& scene, const Section& section, const std::vector<scene::Measurement>& measurements,
         const Settings& settings, const RunObserver& observe)
        : scene_(scene), section_(section), measurements_(measurements), settings_(settings),
          observe_(observe), chosen_(chosen(scene, measurements, settings.since_first_reading))
    {
        if (chosen_.measurement.empty())
            throw input_error("all readings are first readings, from which measurements count");
    }

    int count() const { return count_; }
    const Chosen& readings() const { return chosen_; }
    const Done& first() const { return done_.front(); }
    const Done& at(const VectorXd& logarithms) const
    {
        return *std::find_if(done_.begin(), done_.end(),
                             [&](const Done& run) { return run.logarithms == logarithms; });
    }
    const std::vector<WithoutAnswer>& without_answer() const { return without_answer_; }

    // None where the section has no equilibrium; the first run must have one.
    std::optional<Evaluation> evaluate(const VectorXd& logarithms)
    {
        const bool is_first = count_ == 0;
        const std::vector<double> factors = factors_at(logarithms);
        if (observe_)
            observe_(count_, factors);
        ++count_;
        try {
            Prediction found = predicted(factors);
            Evaluation at = compared(found);
            // Before the first stage nothing moves, whatever the factors.
            if (is_first && !settings_.ensemble && at.jacobian.norm() == 0)
                throw input_error("no factor changes any of the readings; expected readings from the first "
                                  "stage on that depend on the factors");
            done_.push_back(
                {logarithms, std::move(found.displacement), std::move(found.interpolation_error)});
            return at;
        } catch (const equilibrium_error& error) {
            if (is_first)
                throw;
            without_answer_.push_back({factors, error.what()});
        } catch (const analysis::unstable_step& error) {
            if (is_first)
                throw;
            without_answer_.push_back({factors, error.what()});
        }
        return {};
    }

private:
    Prediction predicted(const std::vector<double>& factors) const
    {
        const Run run = section_(factors);
        return predict(scene_, run.history, run.sensitivities, measurements_, settings_.since_first_reading);
    }

    // Residuals over the deviations of the readings, and their derivatives.
    Evaluation compared(const Prediction& found) const
    {
        const auto rows = static_cast<Eigen::Index>(chosen_.measurement.size());
        Evaluation at{VectorXd(rows), estimation::MatrixXd(rows, found.sensitivity.cols())};
        for (Eigen::Index row = 0; row < rows; ++row) {
            const std::size_t m = chosen_.measurement[static_cast<std::size_t>(row)];
            const double deviation = deviation_of(measurements_[m]);
            at.residual[row] = (found.displacement[m] - measurements_[m].displacement) / deviation;
            at.jacobian.row(row) = found.sensitivity.row(static_cast<Eigen::Index>(m)) / deviation;
        }
        return at;
    }

    const Scene& scene_;
    const Section& section_;
    const std::vector<scene::Measurement>& measurements_;
    const Settings& settings_;
    const RunObserver& observe_;
    Chosen chosen_;
    int count_ = 0;
    std::vector<Done> done_;
    std::vector<WithoutAnswer> without_answer_;
};

} // namespace

namespace
{

// Whether residuals are more than errors of the computation, so that they can be asked whether they are noise.
bool are_noisy(const Found& found, const std::vector<scene::Measurement>& measurements)
{
    double largest = 0, residual = 0;
    for (std::size_t m = 0; m < measurements.size(); ++m) {
        largest = std::max(largest, std::abs(measurements[m].displacement));
        residual = std::max(residual, std::abs(found.computed[m].at_end + found.instrument[m] -
                                               measurements[m].displacement));
    }
    return residual > 1e-4 * largest;
}

constexpr double in_95_percent = 1.959964; // standard errors, on each side

// Bounds are the 95 percent interval of a normal law.
estimation::Prior prior_of(const estimation::Bounds& bounds)
{
    return {(bounds.low + bounds.high) / 2, (bounds.high - bounds.low) / 2 / in_95_percent};
}

// The search by an ensemble, as a minimum that was found: no bound stops a parameter.
struct ByMembers {
    estimation::InstrumentFit fitted;
    std::vector<estimation::AtBound> disagrees; // with the prior: what the readings want is below or above it
    std::string failure;
};

ByMembers by_members(Runs& runs, const estimation::Instruments& instruments, const estimation::Prior& prior,
                     const estimation::EnsembleSearch& search)
{
    using estimation::AtBound;
    estimation::Inversion inversion = estimation::invert(
        [&runs](const VectorXd& logarithms) -> std::optional<VectorXd> {
            const std::optional<Evaluation> at = runs.evaluate(logarithms);
            return at ? std::optional(at->residual) : std::nullopt;
        },
        [&instruments](const Evaluation& raw) { return instruments.independent(raw); }, prior, search);
    ByMembers found;
    found.fitted.minimum = {.parameters = inversion.mean,
                            .there = instruments.independent(inversion.raw),
                            .at_bound = std::vector(static_cast<std::size_t>(prior.mean.size()), AtBound::no),
                            .left = inversion.step,
                            .evaluations = runs.count(),
                            .is_converged = inversion.is_converged};
    for (const double by : estimation::disagreement(inversion, prior))
        found.disagrees.push_back(by < -in_95_percent  ? AtBound::low
                                  : by > in_95_percent ? AtBound::high
                                                       : AtBound::no);
    found.fitted.raw = std::move(inversion.raw);
    found.failure = std::move(inversion.failure);
    return found;
}

// A factor is known where both ends are within a factor of 10, and its standard error, which knows no bounds of the others, too.
void add_profiles(Found& found, Runs& runs, const estimation::Instruments& instruments,
                  const estimation::Bounds& bounds, int most_runs)
{
    const int before = runs.count();
    estimation::Profiles profiles = estimation::profiles(
        [&](const VectorXd& logarithms) -> std::optional<Evaluation> {
            const std::optional<Evaluation> raw = runs.evaluate(logarithms);
            return raw ? std::optional(instruments.independent(*raw)) : std::nullopt;
        },
        found.minimum, found.confidence, bounds, most_runs);
    found.profiles = std::move(profiles.of_each);
    found.better = std::move(profiles.better);
    found.profile_runs = runs.count() - before;
    for (std::size_t i = 0; i < found.profiles.size(); ++i) {
        const auto [low, high] = found.profiles[i].interval;
        const double at = found.minimum.parameters[static_cast<Eigen::Index>(i)];
        found.is_resolved[i] = found.is_resolved[i] && std::max(at - low, high - at) < std::log(10.0);
    }
}

} // namespace

estimation::Interval Found::interval(std::size_t factor, bool with_all) const
{
    if (!profiles.empty())
        return with_all ? profiles[factor].with_all : profiles[factor].interval;
    const auto i = static_cast<Eigen::Index>(factor);
    return confidence.interval(minimum.parameters[i], i, with_all);
}

Section section_of(const Scene& scene, const Network& network, const EquivalentJoints& joints,
                   const Settings& settings)
{
    EquivalentJoints own = joints;
    std::vector<Scaled> factors_on;
    for (const Factor& factor : settings.factors) {
        Scaled scaled = factor.scaled;
        if (!factor.material.empty()) {
            const auto material =
                std::ranges::find(scene.joint_materials, factor.material, &JointMaterial::name);
            if (material == scene.joint_materials.end())
                throw input_error("the scene has no joint material \"" + factor.material + '"');
            scaled.material = static_cast<Index>(material - scene.joint_materials.begin());
            own.material = joint::materials_of(scene, network);
        }
        factors_on.push_back(scaled);
    }
    analysis::Recording recording;
    if (!settings.ensemble)
        recording.parameters = factors_on;
    return [&scene, &network, own, factors_on, recording,
            threads = settings.threads](const std::vector<double>& factors) {
        Scene changed = scene;
        EquivalentJoints stiffer = own;
        for (std::size_t i = 0; i < factors.size(); ++i)
            sensitivity::scale(stiffer, changed.in_situ_stress, factors_on[i], factors[i]);
        analysis::Analysis analysis(changed, network, stiffer, threads, recording,
                                    [](const analysis::Progress&) {});
        analysis.run();
        return Run{analysis.result().history, analysis.sensitivities()};
    };
}

Found fit(const Scene& scene, const Network& network, const EquivalentJoints& joints,
          const std::vector<scene::Measurement>& measurements, const Settings& settings,
          const RunObserver& observe)
{
    return fit(scene, section_of(scene, network, joints, settings), measurements, settings, observe);
}

Found fit(const Scene& scene, const Section& section, const std::vector<scene::Measurement>& measurements,
          const Settings& settings, const RunObserver& observe)
{
    const auto n = static_cast<Eigen::Index>(settings.factors.size());
    VectorXd start(n), low(n), high(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const Factor& factor = settings.factors[static_cast<std::size_t>(i)];
        start[i] = std::log(factor.start);
        low[i] = std::log(factor.low);
        high[i] = std::log(factor.high);
    }
    Runs runs(scene, section, measurements, settings, observe);

    Found found;
    const Chosen& readings = runs.readings();
    estimation::Instruments instruments(readings.readings, settings.errors);
    if (const std::size_t wanted = settings.factors.size() + instruments.unknowns();
        readings.measurement.size() <= wanted)
        throw input_error(std::to_string(readings.measurement.size()) + " readings for " +
                          std::to_string(settings.factors.size()) + " factors and " +
                          std::to_string(instruments.unknowns()) +
                          " unknown errors of instruments; expected more readings, or fewer of both");
    const estimation::Bounds bounds{low, high};
    estimation::InstrumentFit fitted;
    std::optional<estimation::Prior> prior;
    std::vector<estimation::AtBound> disagrees;
    if (settings.ensemble) {
        prior = prior_of(bounds);
        ByMembers of = by_members(runs, instruments, *prior, *settings.ensemble);
        fitted = std::move(of.fitted);
        disagrees = std::move(of.disagrees);
        found.failure = std::move(of.failure);
        found.members = settings.ensemble->members;
    } else {
        // A step that would win a hundredth of a standard error is not worth a run.
        fitted = estimation::minimise(
            [&runs](const VectorXd& logarithms) { return runs.evaluate(logarithms); }, instruments, start,
            low, high, settings.most_runs, 1e-4 / static_cast<double>(readings.measurement.size()));
    }
    found.minimum = std::move(fitted.minimum);
    found.is_settled = fitted.is_settled;
    found.factors = factors_at(found.minimum.parameters);
    found.confidence = instruments.confidence(fitted.raw, found.minimum);
    if (prior)
        found.confidence =
            estimation::with_prior(std::move(found.confidence), found.minimum, prior->deviation);
    found.is_resolved = estimation::resolved(found.minimum, found.confidence);
    if (settings.profile_intervals && found.minimum.is_converged)
        add_profiles(found, runs, instruments, bounds, settings.most_profile_runs);
    found.without_answer = runs.without_answer();
    found.series = readings.series;
    const Runs::Done& best = runs.at(found.minimum.parameters);
    found.interpolation_error = best.interpolation_error;
    for (std::size_t m = 0; m < measurements.size(); ++m)
        found.computed.push_back({runs.first().displacement[m], best.displacement[m]});
    found.errors = instruments.errors(fitted.raw, found.confidence);
    found.correlation_time = instruments.correlation_time();
    found.outliers = instruments.outliers(fitted.raw);
    for (estimation::Outlier& outlier : found.outliers)
        outlier.reading = readings.measurement[outlier.reading];
    found.instrument.assign(measurements.size(), 0.0);
    const std::vector<double> added = instruments.added(fitted.raw);
    for (std::size_t i = 0; i < added.size(); ++i)
        found.instrument[readings.measurement[i]] = added[i];
    if (are_noisy(found, measurements))
        found.doubts = instruments.doubts(fitted.raw, found.minimum);
    for (estimation::Doubt& doubt : found.doubts)
        doubt.reading = readings.measurement[doubt.reading];
    if (prior) {
        found.minimum.at_bound = std::move(disagrees);
        for (Eigen::Index i = 0; i < n; ++i) {
            const double alone = found.confidence.error_if_free[i]; // 0 without effect
            found.is_by_bounds.push_back(!(alone > 0) || alone > prior->deviation[i]);
        }
    }
    return found;
}

} // namespace jointcreep::back_analysis
