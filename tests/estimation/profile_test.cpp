// Profile intervals beside those of linear models, of one exponential, and of a ratio (Fieller).

#include "estimation/profile.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace profile_test
{

using namespace jointcreep::estimation;

namespace
{

constexpr double infinity = std::numeric_limits<double>::infinity(), z = 1.9599639845; // of 95 percent

struct Fit {
    Minimum minimum;
    Confidence confidence;
    std::vector<Profile> profiles;
    std::optional<Better> better{};
};

// Deviations are known, to be those that residuals were divided by.
Fit fit(const Model& model, const VectorXd& start, double widest = 20, int most_runs = 60)
{
    const Bounds bounds{VectorXd::Constant(start.size(), -widest), VectorXd::Constant(start.size(), widest)};
    Fit found{minimise(model, start, bounds.low, bounds.high), {}, {}};
    found.confidence = confidence_of(found.minimum, true);
    Profiles of = profiles(model, found.minimum, found.confidence, bounds, most_runs);
    found.profiles = std::move(of.of_each);
    found.better = std::move(of.better);
    return found;
}

} // namespace

TEST(profile, of_a_linear_model_is_by_the_standard_error)
{
    const VectorXd x = VectorXd::LinSpaced(20, 0, 2), y = (3 * x).array() + (7 * x).array().sin();
    const Model line = [&](const VectorXd& p) -> std::optional<Evaluation> {
        Evaluation at{p[0] + p[1] * x.array() - y.array(), MatrixXd(x.size(), 2)};
        at.jacobian.col(0).setOnes();
        at.jacobian.col(1) = x;
        return at;
    };
    const Fit found = fit(line, VectorXd::Zero(2));
    for (const int i : {0, 1})
        for (const bool all : {false, true}) {
            const Interval one = found.confidence.interval(found.minimum.parameters[i], i, all),
                           its = all ? found.profiles.at(i).with_all : found.profiles.at(i).interval;
            EXPECT_NEAR(its.low, one.low, 1e-4) << i << all;
            EXPECT_NEAR(its.high, one.high, 1e-4) << i << all;
        }
}

// Readings m_k of exp(p), each with the deviation s: exp(p) is in their mean +- z s / sqrt(n). Where that contains 0, p has no lower
// end.
TEST(profile, of_a_logarithm_is_that_of_the_quantity)
{
    for (const double s : {.1, .5, 1.0, 2.0, 4.0}) {
        const VectorXd readings = VectorXd::Constant(4, 2);
        const Model model = [&](const VectorXd& p) -> std::optional<Evaluation> {
            return Evaluation{(std::exp(p[0]) - readings.array()) / s,
                              MatrixXd::Constant(4, 1, std::exp(p[0]) / s)};
        };
        const Interval found = fit(model, VectorXd::Zero(1)).profiles.at(0).interval;
        const auto off = [&](double end) {
            return 2 * std::abs(std::exp(end) - 2) / s;
        }; // standard errors of the mean
        EXPECT_NEAR(off(found.high), z, .01 * z) << s;
        if (z * s / 2 < 2)
            EXPECT_NEAR(off(found.low), z, .01 * z) << s;
        else
            EXPECT_EQ(found.low, -infinity) << s;
    }
}

// Readings m of a and b, a = exp(p0 + p1), b = exp(p1), two of each. The sum of squares with the ratio r = exp(p0) fixed is
// 2 (m_a - r m_b)^2 / (1 + r^2) / s^2 at least: r is where that is z^2 (Fieller 1954).
TEST(profile, of_a_ratio_is_fiellers)
{
    const double m_a = 3, m_b = 2;
    for (const double s : {.05, .2, .5, 1.0, 1.6}) {
        const Model model = [&](const VectorXd& p) -> std::optional<Evaluation> {
            const double a = std::exp(p[0] + p[1]), b = std::exp(p[1]);
            Evaluation at{VectorXd(4), MatrixXd(4, 2)};
            at.residual << a - m_a, a - m_a, b - m_b, b - m_b;
            at.jacobian << a, a, a, a, 0, b, 0, b;
            at.residual /= s;
            at.jacobian /= s;
            return at;
        };
        const Interval found = fit(model, VectorXd::Zero(2)).profiles.at(0).interval;
        const auto off = [&](double end) {
            const double r = std::exp(end);
            return std::sqrt(2 / (1 + r * r)) * std::abs(m_a - r * m_b) / s;
        };
        EXPECT_NEAR(off(-infinity) > z ? off(found.low) : z, z, .01 * z) << s;
        EXPECT_NEAR(off(20) > z ? off(found.high) : z, z, .01 * z) << s;
        EXPECT_EQ(std::isinf(found.low), off(-infinity) < z) << s;
        EXPECT_EQ(std::isinf(found.high), off(20) < z) << s;
    }
}

// An end beyond a bound of the search, or where the model has no answer.
TEST(profile, ends_at_bounds_and_where_there_is_no_answer)
{
    double last = infinity; // up to which the model has an answer
    const Model model = [&](const VectorXd& p) -> std::optional<Evaluation> {
        if (p[0] > last)
            return {};
        return Evaluation{VectorXd::Constant(1, p[0]), MatrixXd::Ones(1, 1)};
    };
    VectorXd guess(1);
    guess << 2;
    const auto end = [&](double bound) {
        const Bounds bounds{VectorXd::Constant(1, -bound), VectorXd::Constant(1, bound)};
        return profile_end(model, VectorXd::Zero(1), 0, 9, 0, guess, bounds, {}).at;
    };
    EXPECT_NEAR(end(10), 3, .03);
    EXPECT_EQ(end(2.9), infinity);
    EXPECT_EQ(end(1), infinity);
    last = 1.3;
    EXPECT_EQ(end(10), infinity);
    last = 3.5;
    EXPECT_NEAR(end(10), 3, .03);
    guess << -2;
    EXPECT_NEAR(end(10), -3, .03);
}

// Two parameters with the same effect: neither has an end. One without effect, too.
TEST(profile, of_what_readings_do_not_determine_is_infinite)
{
    const Model model = [](const VectorXd& p) -> std::optional<Evaluation> {
        Evaluation at{VectorXd(5), MatrixXd::Zero(5, 3)};
        for (Eigen::Index k = 0; k < 5; ++k)
            at.residual[k] = p[0] + p[1] - static_cast<double>(k);
        at.jacobian.leftCols(2).setOnes();
        return at;
    };
    for (const Profile& profile : fit(model, VectorXd::Zero(3)).profiles)
        for (const Interval& one : {profile.interval, profile.with_all}) {
            EXPECT_EQ(one.low, -infinity);
            EXPECT_EQ(one.high, infinity);
        }
}

// Valleys one beside the other, as deep as the first or deeper. The hills between them are within the limit.
TEST(profile, of_a_minimum_that_is_not_the_least_says_where_less_is)
{
    for (const double tilt : {0., .3}) {
        const Model model = [tilt](const VectorXd& p) -> std::optional<Evaluation> {
            const double angle = std::numbers::pi * p[0];
            Evaluation at{VectorXd(2), MatrixXd(2, 1)};
            at.residual << 1.5 * std::sin(angle), 1 - tilt * p[0];
            at.jacobian << 1.5 * std::numbers::pi * std::cos(angle), -tilt;
            return at;
        };
        const Fit found = fit(model, VectorXd::Zero(1), 1.9);
        EXPECT_NEAR(found.minimum.parameters[0], 0, .05);
        EXPECT_EQ(found.better.has_value(), tilt > 0);
        if (found.better) {
            EXPECT_LT(found.better->sum_of_squares, found.minimum.sum_of_squares() - .01);
            EXPECT_EQ(found.better->sum_of_squares, model(found.better->parameters)->residual.squaredNorm());
            EXPECT_GT(std::abs(found.better->parameters[0]), .5);
        }
        for (const Interval& one : {found.profiles.at(0).interval, found.profiles.at(0).with_all}) {
            EXPECT_EQ(one.low, -infinity);
            EXPECT_EQ(one.high, infinity);
        }
    }
}

// Of one logarithm, as above: a few runs do not find an end, and say how far they came.
TEST(profile, has_no_end_where_runs_are_too_few)
{
    int calls = 0;
    const Model model = [&](const VectorXd& p) -> std::optional<Evaluation> {
        ++calls;
        return Evaluation{(std::exp(p[0]) - VectorXd::Constant(4, 2).array()) / 1.5,
                          MatrixXd::Constant(4, 1, std::exp(p[0]) / 1.5)};
    };
    const Profile exact = fit(model, VectorXd::Zero(1)).profiles.at(0);
    EXPECT_TRUE(exact.not_found.empty());
    const Fit minimum = fit(model, VectorXd::Zero(1), 20, 1);
    calls = 0;
    const Fit few = fit(model, minimum.minimum.parameters, 20, 2);
    EXPECT_LE(calls, 3 + 2 * 2);
    const Profile& found = few.profiles.at(0);
    EXPECT_EQ(found.interval.low, -infinity);
    EXPECT_EQ(found.interval.high, infinity);
    ASSERT_EQ(found.not_found.size(), 4U); // each by itself and with all: the same, of one parameter
    for (std::size_t k = 0; k < 4; ++k) {
        const NotFound& one = found.not_found[k];
        EXPECT_EQ(one.is_high, k >= 2);
        EXPECT_EQ(one.is_with_all, k % 2 == 1);
        EXPECT_GT(one.beyond, exact.interval.low);
        EXPECT_LT(one.beyond, exact.interval.high);
    }
    EXPECT_LT(found.not_found[0].beyond, few.minimum.parameters[0] - .5);
}

// Means a and b of m readings each, with known deviations; a is stopped by its upper bound c. Its interval is where
// m (a - mean)^2 <= m (c - mean)^2 + q^2, and it is one of two that hold together: q is 2.2414 there (0.0125 on each side), for b, too. By
// standard errors a has no interval, and that of b is alone.
TEST(profile, of_a_parameter_at_its_bound_is_one_of_all)
{
    constexpr int m = 9;
    constexpr double mean_a = 1, mean_b = 2, c = .8, two = 2.241402728;
    const Model model = [](const VectorXd& p) -> std::optional<Evaluation> {
        Evaluation at{VectorXd(2 * m), MatrixXd::Zero(2 * m, 2)};
        at.residual.head(m).setConstant(p[0] - mean_a);
        at.residual.tail(m).setConstant(p[1] - mean_b);
        for (int k = 0; k < m - 1; ++k) { // means stay
            at.residual[k] += k % 2 == 0 ? .5 : -.5;
            at.residual[m + k] += k % 2 == 0 ? .5 : -.5;
        }
        at.jacobian.col(0).head(m).setOnes();
        at.jacobian.col(1).tail(m).setOnes();
        return at;
    };
    Bounds bounds{VectorXd::Constant(2, -20), VectorXd::Constant(2, 20)};
    bounds.high[0] = c;
    const Minimum minimum = minimise(model, VectorXd::Zero(2), bounds.low, bounds.high);
    ASSERT_EQ(minimum.at_bound[0], AtBound::high);
    const Confidence confidence = confidence_of(minimum, true);
    EXPECT_EQ(confidence.readings - confidence.parameters, 2 * m - 1);
    EXPECT_NEAR(confidence.quantile_all, z, 1e-4);
    const Profiles found = profiles(model, minimum, confidence, bounds);
    const auto low = [&](double q) { return mean_a - std::sqrt((c - mean_a) * (c - mean_a) + q * q / m); };
    const Profile &a = found.of_each.at(0), &b = found.of_each.at(1);
    EXPECT_NEAR(a.interval.low, low(z), .01);
    EXPECT_NEAR(a.with_all.low, low(two), .01);
    EXPECT_EQ(a.interval.high, infinity);
    EXPECT_NEAR(b.interval.high, mean_b + z / 3, .01);
    EXPECT_NEAR(b.with_all.high, mean_b + two / 3, .01);
    EXPECT_NEAR(b.with_all.low, mean_b - two / 3, .01);
}

} // namespace profile_test
