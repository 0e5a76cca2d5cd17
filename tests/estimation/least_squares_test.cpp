// Minima that are known, bounds, and what is said of them.

#include "estimation/confidence.hpp"
#include "model/error.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace least_squares_test
{

using namespace jointcreep;
using namespace jointcreep::estimation;

namespace
{

const double none = 1e9;

VectorXd vector(std::initializer_list<double> values)
{
    VectorXd v(static_cast<Eigen::Index>(values.size()));
    std::copy(values.begin(), values.end(), v.begin());
    return v;
}

// Rosenbrock's valley: 100 (y - x^2)^2 + (1 - x)^2.
std::optional<Evaluation> valley(const VectorXd& p)
{
    Evaluation at{VectorXd(2), MatrixXd(2, 2)};
    at.residual << 10 * (p[1] - p[0] * p[0]), 1 - p[0];
    at.jacobian << -20 * p[0], 10, -1, 0;
    return at;
}

// Readings y of a straight line a + b x.
Model line(const VectorXd& x, const VectorXd& y, double deviation = 1)
{
    return [=](const VectorXd& p) -> std::optional<Evaluation> {
        Evaluation at{(p[0] + p[1] * x.array() - y.array()) / deviation, MatrixXd(x.size(), 2)};
        at.jacobian.col(0).setConstant(1 / deviation);
        at.jacobian.col(1) = x / deviation;
        return at;
    };
}

} // namespace

TEST(least_squares, finds_the_end_of_a_bent_valley)
{
    const Minimum found = minimise(valley, vector({-1.2, 1}), vector({-none, -none}), vector({none, none}));
    EXPECT_TRUE(found.is_converged);
    EXPECT_NEAR(found.parameters[0], 1, 1e-6);
    EXPECT_NEAR(found.parameters[1], 1, 1e-6);
    EXPECT_LT(found.evaluations, 60);
    EXPECT_EQ(found.at_bound, (std::vector<AtBound>{AtBound::no, AtBound::no}));
}

// On the bound x = 0.5 the least sum is at y = x^2.
TEST(least_squares, stops_at_bounds_and_says_so)
{
    const Minimum found = minimise(valley, vector({-1.2, 1}), vector({-none, -none}), vector({0.5, none}));
    EXPECT_TRUE(found.is_converged);
    EXPECT_EQ(found.parameters[0], 0.5);
    EXPECT_NEAR(found.parameters[1], 0.25, 1e-5);
    EXPECT_EQ(found.at_bound, (std::vector<AtBound>{AtBound::high, AtBound::no}));
    const Minimum low = minimise(valley, vector({3, 3}), vector({2, -none}), vector({none, 3.5}));
    EXPECT_EQ(low.parameters, vector({2, 3.5}));
    EXPECT_EQ(low.at_bound, (std::vector<AtBound>{AtBound::low, AtBound::high}));
}

// With a at most 1 the line goes on with b alone: b = sum of x (y - 1) / sum of x^2 = 54 / 55. Cutting the
// step at the bound without turning it would go uphill.
TEST(least_squares, turns_along_a_bound)
{
    const VectorXd x = vector({1, 2, 3, 4, 5}), y = vector({2, 3, 5, 4, 6});
    const Minimum found =
        minimise(line(x, y), vector({0.99, 1}), vector({-none, -none}), vector({1, none}), 100, 1e-15);
    EXPECT_EQ(found.at_bound, (std::vector<AtBound>{AtBound::high, AtBound::no}));
    EXPECT_EQ(found.parameters[0], 1);
    EXPECT_NEAR(found.parameters[1], 54. / 55, 1e-6);
}

// Three parameters with nearly the same effect: often two of them reach bounds that only one of them ends at.
TEST(least_squares, finds_the_best_point_between_bounds)
{
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    const VectorXd high = VectorXd::Constant(3, 0.7), low = -high;
    int at_bounds = 0;
    for (int trial = 0; trial < 500; ++trial) {
        MatrixXd J(30, 3);
        VectorXd y(30);
        for (Eigen::Index i = 0; i < 30; ++i) {
            const double common = normal(random);
            for (Eigen::Index k = 0; k < 3; ++k)
                J(i, k) = common + 0.15 * normal(random);
            y[i] = normal(random);
        }
        const Model model = [&](const VectorXd& p) -> std::optional<Evaluation> {
            return Evaluation{J * p - y, J};
        };
        const Minimum found = minimise(model, VectorXd::Zero(3), low, high, 100, 1e-12);
        EXPECT_TRUE(found.is_converged) << trial;
        const VectorXd downhill = -J.transpose() * found.there.residual;
        for (Eigen::Index k = 0; k < 3; ++k) {
            const AtBound at = found.at_bound[static_cast<std::size_t>(k)];
            at_bounds += at != AtBound::no ? 1 : 0;
            if (at == AtBound::no) {
                EXPECT_NEAR(downhill[k], 0, 1e-3) << trial;
                EXPECT_LT(std::abs(found.parameters[k]), 0.7) << trial;
            } else {
                EXPECT_EQ(found.parameters[k], at == AtBound::low ? -0.7 : 0.7) << trial;
            }
        }
    }
    EXPECT_GT(at_bounds, 200);
}

// The line above at its bound a = 1. Of b the data know what they know of it in a free line: variance 1 / sum of (x - mean)^2
// = 1 / 10, and not 1 / sum of x^2 = 1 / 55, as if a were known.
TEST(confidence, a_parameter_at_a_bound_is_not_known_to_the_others)
{
    const VectorXd x = vector({1, 2, 3, 4, 5}), y = vector({2, 3, 5, 4, 6});
    const Minimum found =
        minimise(line(x, y), vector({0.99, 1}), vector({-none, -none}), vector({1, none}), 100, 1e-15);
    const Confidence confidence = confidence_of(found, true);
    EXPECT_TRUE(confidence.is_fixed[0]);
    EXPECT_EQ(confidence.covariance(0, 0), 0);
    EXPECT_EQ(confidence.covariance(0, 1), 0);
    EXPECT_NEAR(confidence.covariance(1, 1), 0.1, 1e-12);
}

TEST(least_squares, goes_round_where_there_is_no_answer)
{
    int refused = 0;
    const auto holed = [&](const VectorXd& p) -> std::optional<Evaluation> {
        if (p[1] < -0.2) {
            ++refused;
            return {};
        }
        return valley(p);
    };
    const Minimum found = minimise(holed, vector({-1.2, 1}), vector({-none, -none}), vector({none, none}));
    EXPECT_NEAR(found.parameters[0], 1, 1e-5);
    const auto nowhere = [](const VectorXd&) { return std::optional<Evaluation>(); };
    EXPECT_THROW(minimise(nowhere, vector({0, 0}), vector({-1, -1}), vector({1, 1})), input_error);
}

TEST(least_squares, too_few_evaluations_are_no_end)
{
    const Minimum found =
        minimise(valley, vector({-1.2, 1}), vector({-none, -none}), vector({none, none}), 3);
    EXPECT_EQ(found.evaluations, 3);
    EXPECT_FALSE(found.is_converged);
    EXPECT_FALSE(found.has_stalled);
    EXPECT_GT(found.left.norm(), 0.1);
}

// A line whose derivatives have the wrong sign, and one that has an answer at its start alone: no step
// lessens the sum, though it is not the least.
TEST(least_squares, standing_still_is_no_end)
{
    const VectorXd x = vector({1, 2, 3, 4, 5}), y = vector({2, 3, 5, 4, 6});
    const Model right = line(x, y),
                turned =
                    [&](const VectorXd&p) {
                        std::optional<Evaluation> at = right(p);
                        at->jacobian *= -1;
                        return at;
                    },
                alone = [&](const VectorXd&p) { return p.isZero() ? right(p) : std::nullopt; };
    for (const Model& model : {turned, alone}) {
        const Minimum found = minimise(model, vector({0, 0}), vector({-9, -9}), vector({9, 9}));
        EXPECT_FALSE(found.is_converged);
        EXPECT_TRUE(found.has_stalled);
        EXPECT_EQ(found.parameters, vector({0, 0}));
    }
}

// Steps below a tenth of a standard error may fail by the model's roughness.
TEST(least_squares, roughness_within_a_tenth_of_a_standard_error_is_an_end)
{
    const VectorXd x = vector({1, 2, 3, 4, 5}), y = vector({2, 3, 5, 4, 6});
    for (const double off : {0.02, 2.0}) {
        const Minimum best = minimise(line(x, y), vector({0, 0}), vector({-9, -9}), vector({9, 9}));
        const VectorXd start = best.parameters + vector({off, 0});
        const Model rough = [&](const VectorXd& p) -> std::optional<Evaluation> {
            std::optional<Evaluation> at = line(x, y)(p);
            if (p != start)
                at->residual *= 10;
            return at;
        };
        const Minimum found = minimise(rough, start, vector({-9, -9}), vector({9, 9}));
        EXPECT_EQ(found.is_converged, off < 1);
        EXPECT_EQ(found.has_stalled, off > 1);
    }
}

TEST(least_squares, leaves_alone_what_has_no_effect)
{
    const auto flat = [](const VectorXd& p) -> std::optional<Evaluation> {
        Evaluation at{VectorXd(3), MatrixXd::Zero(3, 2)};
        at.residual << p[0] - 1, p[0] - 2, p[0] - 3;
        at.jacobian.col(0).setOnes();
        return at;
    };
    const Minimum found = minimise(flat, vector({0, 0.25}), vector({-9, -9}), vector({9, 9}), 100, 1e-15);
    EXPECT_NEAR(found.parameters[0], 2, 1e-9);
    EXPECT_EQ(found.parameters[1], 0.25);
    const Confidence confidence = confidence_of(found, false);
    EXPECT_EQ(confidence.is_fixed, (std::vector<bool>{false, true}));
    EXPECT_NEAR(confidence.standard_error(Eigen::Index{0}), 1 / std::sqrt(3.0), 1e-9); // s = 1
    EXPECT_EQ(confidence.interval(0.25, 1).low, -std::numeric_limits<double>::infinity());
}

// Textbook: the regression line through (1,2) (2,3) (3,5) (4,4) (5,6): slope 0.9, s^2 = 1.9 / 3, the slope's
// variance s^2 / 10, the intercept's s^2 (1/5 + 9/10), their correlation -3 / sqrt(11), t(3) = 3.182446.
TEST(confidence, is_that_of_linear_regression)
{
    const VectorXd x = vector({1, 2, 3, 4, 5}), y = vector({2, 3, 5, 4, 6});
    const Minimum found =
        minimise(line(x, y), vector({0, 0}), vector({-none, -none}), vector({none, none}), 100, 1e-15);
    EXPECT_NEAR(found.parameters[1], 0.9, 1e-7);
    const Confidence confidence = confidence_of(found, false);
    const double s2 = 1.9 / 3;
    EXPECT_NEAR(confidence.noise_factor, std::sqrt(s2), 1e-9);
    EXPECT_NEAR(confidence.standard_error(Eigen::Index{1}), std::sqrt(s2 / 10), 1e-9);
    EXPECT_NEAR(confidence.standard_error(Eigen::Index{0}), std::sqrt(s2 * 1.1), 1e-9);
    EXPECT_NEAR(confidence.correlation(0, 1), -3 / std::sqrt(11.0), 1e-9);
    EXPECT_NEAR(confidence.quantile, 3.182446, 1e-6);
    EXPECT_NEAR(confidence.quantile_all, 4.176535, 1e-6); // t(3) beyond 0.0125
    EXPECT_NEAR(confidence.interval(0.9, 1).high, 0.9 + 3.182446 * std::sqrt(s2 / 10), 1e-6);

    // With deviations known the residuals do not matter, unless they are too large for them.
    const Confidence known = confidence_of(
        minimise(line(x, y, 1), vector({0, 0}), vector({-none, -none}), vector({none, none})), true);
    EXPECT_FALSE(known.is_noise_from_residuals);
    // Of 3 degrees of freedom, beyond x: erfc(sqrt(x / 2)) + sqrt(2 x / pi) exp(-x / 2); 0.593 at 1.9.
    const double x2 = 1.9, pi = 3.14159265358979;
    EXPECT_NEAR(known.p_value, std::erfc(std::sqrt(x2 / 2)) + std::sqrt(2 * x2 / pi) * std::exp(-x2 / 2),
                1e-6);
    EXPECT_NEAR(known.p_value, 0.593, 1e-3);
    EXPECT_NEAR(known.standard_error(Eigen::Index{1}), std::sqrt(0.1), 1e-9);
    const Confidence exceeded = confidence_of(
        minimise(line(x, y, 0.1), vector({0, 0}), vector({-none, -none}), vector({none, none})), true);
    EXPECT_TRUE(exceeded.is_noise_from_residuals);
    EXPECT_LT(exceeded.p_value, 1e-9);
    EXPECT_NEAR(exceeded.standard_error(Eigen::Index{1}), std::sqrt(s2 / 10), 1e-9);
}

TEST(confidence, names_the_combination_that_readings_leave_open)
{
    // x hardly varies: a + b x knows a + 5 b only.
    const VectorXd x = vector({5, 5.01, 4.99, 5, 5.005}), y = vector({1, 2, 1.5, 1.2, 1.4});
    const Minimum found = minimise(line(x, y), vector({0, 0}), vector({-none, -none}), vector({none, none}));
    const Confidence confidence = confidence_of(found, false);
    const auto weak = weak_combination(found, confidence);
    ASSERT_TRUE(weak);
    EXPECT_TRUE(weak->is_alike_effects);
    EXPECT_NEAR(weak->direction[0], 1, 1e-9);
    EXPECT_NEAR(weak->direction[1], -0.2, 1e-3);
    EXPECT_GT(weak->standard_error, 10);
    EXPECT_LT(confidence.smallest_eigenvalue, 1e-4);

    const VectorXd wide = vector({-1, 1, -1, 1, 0}), good = vector({-1.001, 1, -0.999, 1, 0});
    const Minimum clear =
        minimise(line(wide, good), vector({0, 0}), vector({-none, -none}), vector({none, none}));
    EXPECT_FALSE(weak_combination(clear, confidence_of(clear, false)));
}

TEST(confidence, needs_more_readings_than_parameters)
{
    const Minimum found =
        minimise(line(vector({1, 2}), vector({3, 4})), vector({0, 0}), vector({-9, -9}), vector({9, 9}));
    EXPECT_THROW(confidence_of(found, false), input_error);
}

} // namespace least_squares_test
