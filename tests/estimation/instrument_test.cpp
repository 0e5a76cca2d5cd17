// Errors of instruments, on straight lines of readings: what is found, how often intervals hold it, and how often a
// model without the error is doubted.

#include "estimation/instrument.hpp"
#include "estimation/profile.hpp"
#include "model/error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>
#include <random>

namespace instrument_test
{

using namespace jointcreep;
using namespace jointcreep::estimation;

namespace
{

// Readings of a + b sqrt(t) by two instruments at uneven times.
struct Line {
    Readings readings;

    explicit Line(std::mt19937_64& random, double noise = 1, double correlation = 0)
    {
        std::normal_distribution<double> error(0, 1);
        for (std::size_t s = 0; s < 2; ++s) {
            double lasting = error(random);
            for (int i = 0; i < 25; ++i) {
                readings.time.push_back(i + (i % 3 == 0 ? 0.4 : 0.0));
                readings.series.push_back(s);
                readings.deviation.push_back(2);
                if (i > 0) {
                    const double distance = readings.time.back() - readings.time[readings.time.size() - 2],
                                 c = correlation > 0 ? std::pow(correlation, distance) : 0.0;
                    lasting = c * lasting + std::sqrt(1 - c * c) * error(random);
                }
                values.push_back(a + b * std::sqrt(readings.time.back()) + noise * lasting);
            }
        }
    }
    Model model()
    {
        return [this](const VectorXd& p) -> std::optional<Evaluation> {
            const auto n = static_cast<Eigen::Index>(values.size());
            Evaluation at{VectorXd(n), MatrixXd(n, 2)};
            for (Eigen::Index i = 0; i < n; ++i) {
                const auto k = static_cast<std::size_t>(i);
                at.jacobian(i, 0) = 1 / readings.deviation[k];
                at.jacobian(i, 1) = std::sqrt(readings.time[k]) / readings.deviation[k];
                at.residual[i] = at.jacobian.row(i).dot(p) - values[k] / readings.deviation[k];
            }
            return at;
        };
    }

    static constexpr double a = 3, b = 1.5;
    std::vector<double> values;
};

struct Result {
    InstrumentFit fit;
    Confidence confidence;
    std::vector<FoundError> errors;
    std::vector<Outlier> outliers;
    std::vector<Doubt> doubts;
    double correlation_time;
};

Result fitted(Line line, const Errors& errors, double most_a = 1e3)
{
    Instruments instruments(line.readings, errors);
    Result found;
    VectorXd high = VectorXd::Constant(2, 1e3);
    high[0] = most_a;
    found.fit =
        minimise(line.model(), instruments, VectorXd::Zero(2), VectorXd::Constant(2, -1e3), high, 100, 1e-12);
    found.confidence = instruments.confidence(found.fit.raw, found.fit.minimum);
    found.errors = instruments.errors(found.fit.raw, found.confidence);
    found.outliers = instruments.outliers(found.fit.raw);
    found.doubts = instruments.doubts(found.fit.raw, found.fit.minimum);
    found.correlation_time = instruments.correlation_time();
    return found;
}

bool is_covered(const Result& result, Eigen::Index i, double truth)
{
    const Interval interval = result.confidence.interval(result.fit.minimum.parameters[i], i);
    return interval.low <= truth && truth <= interval.high;
}

// Of 600 fits, how many hold b in their interval, and how many are doubted.
struct Count {
    int held = 0, doubted = 0;
};
Count count(const Errors& errors, double correlation, const std::function<void(Line&)>& spoil)
{
    std::mt19937_64 random(20030501);
    Count counted;
    for (int trial = 0; trial < 600; ++trial) {
        Line line(random, 1, correlation);
        spoil(line);
        const Result result = fitted(line, errors);
        counted.held += is_covered(result, 1, Line::b) ? 1 : 0;
        counted.doubted += result.doubts.empty() ? 0 : 1;
    }
    return counted;
}

const auto nothing = [](Line&) {};
const auto step = [](Line& line) {
    for (std::size_t i = 10; i < 25; ++i)
        line.values[i] += 4;
};
const auto drift = [](Line& line) {
    for (std::size_t i = 25; i < 50; ++i)
        line.values[i] += 0.2 * (line.readings.time[i] - 0.4); // from the first reading on
};
const auto offset = [](Line& line) {
    for (std::size_t i = 0; i < 25; ++i)
        line.values[i] += 3;
};
const auto outlier = [](Line& line) { line.values[30] += 10; };

// 95 percent within three standard deviations of a binomial count of 600.
void expect_95(int held)
{
    EXPECT_GT(held, 600 * 0.923);
    EXPECT_LT(held, 600 * 0.977);
}

} // namespace

TEST(instrument, steps_drift_and_offsets_are_found_as_they_were_made)
{
    std::mt19937_64 random(1);
    Line line(random, 0);
    step(line);
    drift(line);
    const Result result = fitted(line, {.drift = true, .steps = {line.readings.time[10]}});
    ASSERT_EQ(result.errors.size(), 4U); // a drift and a step of each series
    const std::vector<double> wanted{0, 4, 0.2, 0};
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_NEAR(result.errors[i].value, wanted[i], 1e-9) << i;
    EXPECT_NEAR(result.fit.minimum.parameters[0], Line::a, 1e-9);
    EXPECT_NEAR(result.fit.minimum.parameters[1], Line::b, 1e-9);
}

// The same sum of squares and covariance as with the unknowns among the parameters.
TEST(instrument, unknowns_are_those_of_a_fit_of_all_parameters_together)
{
    std::mt19937_64 random(2);
    Line line(random);
    const Result result = fitted(line, {.drift = true});
    const Model model = line.model();
    const Model with = [&](const VectorXd& p) -> std::optional<Evaluation> {
        Evaluation at = *model(p.head(2));
        at.jacobian.conservativeResize(Eigen::NoChange, 4);
        for (Eigen::Index i = 0; i < at.residual.size(); ++i) {
            const auto k = static_cast<std::size_t>(i);
            for (Eigen::Index s = 0; s < 2; ++s)
                at.jacobian(i, 2 + s) = line.readings.series[k] == static_cast<std::size_t>(s)
                                            ? (line.readings.time[k] - 0.4) / line.readings.deviation[k]
                                            : 0.0;
        }
        at.residual += at.jacobian.rightCols(2) * p.tail(2);
        return at;
    };
    const Minimum all = minimise(with, VectorXd::Zero(4), VectorXd::Constant(4, -1e3),
                                 VectorXd::Constant(4, 1e3), 100, 1e-14);
    const Confidence confidence = confidence_of(all, false);
    EXPECT_NEAR(result.fit.minimum.sum_of_squares() / all.sum_of_squares(), 1, 1e-9);
    EXPECT_EQ(result.confidence.readings - result.confidence.parameters,
              confidence.readings - confidence.parameters);
    for (Eigen::Index i = 0; i < 2; ++i) {
        EXPECT_NEAR(result.fit.minimum.parameters[i], all.parameters[i], 1e-6);
        EXPECT_NEAR(result.confidence.standard_error(i) / confidence.standard_error(i), 1, 1e-6);
        const FoundError& error = result.errors[static_cast<std::size_t>(i)];
        EXPECT_NEAR(error.value, all.parameters[2 + i], 1e-6);
        EXPECT_NEAR((error.interval.high - error.value) /
                        (confidence.quantile * confidence.standard_error(2 + i)),
                    1, 1e-6);
    }
}

TEST(instrument, truth_lies_in_95_percent_of_intervals_where_the_error_is_looked_for)
{
    expect_95(count({}, 0, nothing).held);
    expect_95(count({.steps = {10}}, 0, step).held);
    expect_95(count({.drift = true}, 0, drift).held);
    expect_95(count({.offset = true}, 0, offset).held);
    expect_95(count({.robust = true}, 0, nothing).held);
    expect_95(count({.robust = true}, 0, outlier).held);
    expect_95(count({.correlated = true}, 0.6, nothing).held);
    // Without it intervals are wrong.
    EXPECT_LT(count({}, 0, step).held, 600 * 0.9);
    EXPECT_LT(count({}, 0, drift).held, 600 * 0.9);
    EXPECT_LT(count({}, 0.6, nothing).held, 600 * 0.9);
}

// A bound that a only just reaches changes nothing in what the readings know of b.
TEST(instrument, a_parameter_at_a_bound_is_not_known_to_the_others)
{
    std::mt19937_64 random(4);
    const Line line(random, 1, 0.6);
    for (const Errors& errors : {Errors{}, Errors{.robust = true}, Errors{.correlated = true}}) {
        const Result within = fitted(line, errors),
                     at_bound = fitted(line, errors, within.fit.minimum.parameters[0] - 1e-4);
        ASSERT_FALSE(within.confidence.is_fixed[0]);
        ASSERT_TRUE(at_bound.confidence.is_fixed[0]);
        EXPECT_NEAR(at_bound.confidence.standard_error(1) / within.confidence.standard_error(1), 1, 0.1)
            << errors.robust << errors.correlated;
    }
}

// The same of a's profile: its end is that without the bound. The noise of the plain fit is another.
TEST(instrument, the_profile_of_a_parameter_at_a_bound_has_the_noise_of_its_errors)
{
    for (const Errors& errors : {Errors{}, Errors{.robust = true}, Errors{.correlated = true}}) {
        std::mt19937_64 random(3);
        Line line(random, 1, errors.correlated ? 0.6 : 0.0);
        if (errors.robust)
            for (const std::size_t i : {3, 14, 22, 29, 37, 41})
                line.values[i] += i % 2 == 0 ? 7 : -7;
        const double best = fitted(line, errors).fit.minimum.parameters[0];
        const auto half = [&](double most_a) {
            Instruments instruments(line.readings, errors);
            Bounds bounds{VectorXd::Constant(2, -1e3), VectorXd::Constant(2, 1e3)};
            bounds.high[0] = most_a;
            const InstrumentFit fit =
                minimise(line.model(), instruments, VectorXd::Zero(2), bounds.low, bounds.high, 100, 1e-12);
            const Model independent = [&](const VectorXd& p) -> std::optional<Evaluation> {
                return instruments.independent(*line.model()(p));
            };
            const Confidence confidence = instruments.confidence(fit.raw, fit.minimum);
            EXPECT_EQ(confidence.is_fixed[0], most_a < 1e3);
            const double plain =
                confidence.noise_factor * std::sqrt(unit_covariance(fit.minimum.there.jacobian)(0, 0));
            if (errors.any()) {
                EXPECT_GT(std::abs(confidence.error_if_free[0] / plain - 1), .04);
            }
            const Profiles found = profiles(independent, fit.minimum, confidence, bounds);
            EXPECT_FALSE(found.better);
            const double its =
                (fit.minimum.parameters[0] - found.of_each.at(0).interval.low) / confidence.quantile;
            EXPECT_NEAR(its / confidence.error_if_free[0], 1, .015) << errors.robust << errors.correlated;
            return its;
        };
        EXPECT_NEAR(half(best - 1e-4) / half(1e3), 1, .04) << errors.robust << errors.correlated;
    }
}

TEST(instrument, residuals_that_are_no_noise_are_doubted)
{
    EXPECT_LT(count({}, 0, nothing).doubted, 600 * 0.02); // 1 percent, and three standard deviations
    for (const auto& spoil : {std::function<void(Line&)>(step), std::function<void(Line&)>(drift),
                              std::function<void(Line&)>(offset), std::function<void(Line&)>(outlier)})
        EXPECT_GT(count({}, 0, spoil).doubted, 600 * 0.95);
    EXPECT_GT(count({}, 0.8, nothing).doubted, 600 * 0.95);
    EXPECT_LT(count({.steps = {10}}, 0, step).doubted, 600 * 0.02);
    EXPECT_LT(count({.robust = true}, 0, outlier).doubted, 600 * 0.02);
    EXPECT_LT(count({.correlated = true}, 0.8, nothing).doubted, 600 * 0.02);
}

TEST(instrument, outliers_are_named)
{
    std::mt19937_64 random(3);
    Line line(random);
    outlier(line);
    const Result result = fitted(line, {.robust = true});
    ASSERT_EQ(result.outliers.size(), 1U);
    EXPECT_EQ(result.outliers[0].reading, 30U);
    EXPECT_LT(result.outliers[0].residual, -6);
    EXPECT_GT(result.outliers[0].residual, -20);
    const Result plain = fitted(line, {});
    ASSERT_FALSE(plain.doubts.empty());
    EXPECT_EQ(plain.doubts[0].kind, Error::single);
    EXPECT_EQ(plain.doubts[0].reading, 30U);
}

TEST(instrument, a_step_is_named_with_its_day_and_size)
{
    std::mt19937_64 random(4);
    Line line(random, 0.2);
    step(line);
    const Result result = fitted(line, {});
    ASSERT_FALSE(result.doubts.empty());
    EXPECT_EQ(result.doubts[0].kind, Error::step);
    EXPECT_EQ(result.doubts[0].series, 0U);
    EXPECT_EQ(result.doubts[0].time, line.readings.time[10]);
    EXPECT_NEAR(result.doubts[0].value, 4, 0.6);
}

// Ten readings want p = 0, twenty p = 1, where these hardly depend on p. Made linear near p = 1 all agree, in between the ten
// are outliers.
TEST(instrument, weights_without_end_are_no_fit)
{
    Readings readings{
        .time = {}, .series = std::vector<std::size_t>(30, 0), .deviation = std::vector<double>(30, 1.0)};
    for (int i = 0; i < 30; ++i)
        readings.time.push_back(i);
    const Model model = [](const VectorXd& p) -> std::optional<Evaluation> {
        Evaluation at{VectorXd(30), MatrixXd(30, 1)};
        for (Eigen::Index i = 0; i < 30; ++i) {
            const double noise = i % 2 == 0 ? 0.02 : -0.02, left = p[0] - 1;
            at.residual[i] = noise + (i < 10 ? p[0] : 3 * left * left);
            at.jacobian(i, 0) = i < 10 ? 1 : 6 * left;
        }
        return at;
    };
    Instruments instruments(readings, {.robust = true});
    const InstrumentFit fit = minimise(model, instruments, VectorXd::Constant(1, 0.5),
                                       VectorXd::Constant(1, -10), VectorXd::Constant(1, 10), 1000, 1e-12);
    EXPECT_FALSE(fit.is_settled);
    EXPECT_FALSE(fit.minimum.is_converged);
    std::mt19937_64 random(6);
    EXPECT_TRUE(fitted(Line(random), {.robust = true}).fit.is_settled);
}

TEST(instrument, a_step_needs_readings_on_both_sides)
{
    std::mt19937_64 random(5);
    const Line line(random);
    EXPECT_THROW(Instruments(line.readings, {.steps = {0}}), input_error);
    EXPECT_THROW(Instruments(line.readings, {.steps = {99}}), input_error);
}

} // namespace instrument_test
