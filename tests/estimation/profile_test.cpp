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
};

// Deviations are known, to be those that residuals were divided by.
Fit fit(const Model& model, const VectorXd& start, double widest = 20)
{
    const Bounds bounds{VectorXd::Constant(start.size(), -widest), VectorXd::Constant(start.size(), widest)};
    Fit found{minimise(model, start, bounds.low, bounds.high), {}, {}};
    found.confidence = confidence_of(found.minimum, true);
    found.profiles = profiles(model, found.minimum, found.confidence, bounds);
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
        return profile_end(model, VectorXd::Zero(1), 0, 9, 0, guess, bounds, {});
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
    for (const auto& [interval, with_all] : fit(model, VectorXd::Zero(3)).profiles)
        for (const Interval& one : {interval, with_all}) {
            EXPECT_EQ(one.low, -infinity);
            EXPECT_EQ(one.high, infinity);
        }
}

} // namespace profile_test
