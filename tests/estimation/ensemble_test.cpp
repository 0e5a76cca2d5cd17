// Inversion by an ensemble beside exact posteriors of linear models, and beside minima with a prior.

#include "estimation/confidence.hpp"
#include "estimation/ensemble.hpp"
#include "model/error.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace ensemble_test
{

using namespace jointcreep::estimation;

namespace
{

Evaluation as_they_are(const Evaluation& raw)
{
    return raw;
}

// r = A x - b, random.
struct Linear {
    MatrixXd A;
    VectorXd b;

    Linear(Eigen::Index readings, Eigen::Index parameters) : A(readings, parameters), b(readings)
    {
        std::mt19937 random(4);
        std::normal_distribution<double> normal;
        A = MatrixXd::NullaryExpr(readings, parameters, [&] { return normal(random); });
        b = VectorXd::NullaryExpr(readings, [&] { return 3 * normal(random); });
    }
    std::optional<VectorXd> operator()(const VectorXd& x) const { return A * x - b; }
};

// Readings that decay, exp(p0 - exp(p1) t), with the deviation s.
Residuals decay(double s)
{
    return [s](const VectorXd& p) -> std::optional<VectorXd> {
        const Eigen::ArrayXd t = Eigen::ArrayXd::LinSpaced(20, 0, 4);
        const Eigen::ArrayXd read = 2 * (-.7 * t).exp() + s * (9 * t).sin();
        return ((p[0] - std::exp(p[1]) * t).exp() - read).matrix() / s;
    };
}

} // namespace

// More parameters than readings, too: the prior has the rest.
TEST(ensemble, of_a_linear_model_is_the_posterior)
{
    for (const Eigen::Index readings : {3, 40}) {
        const Linear model(readings, 6);
        const VectorXd mean = VectorXd::LinSpaced(6, -1, 1), deviation = VectorXd::LinSpaced(6, .5, 3);
        const MatrixXd information = deviation.array().square().inverse().matrix().asDiagonal();
        const MatrixXd covariance = (model.A.transpose() * model.A + information).inverse();
        const VectorXd exact = covariance * (model.A.transpose() * model.b + information * mean);
        for (const int members : {14, 50}) {
            const Inversion found = invert(model, as_they_are, {mean, deviation}, {.members = members});
            EXPECT_TRUE(found.is_converged);
            EXPECT_LE(found.rounds, 5);
            EXPECT_LT((found.mean - exact).norm(), 1e-9);
            EXPECT_LT((found.covariance - covariance).norm(), 1e-9);
            EXPECT_LT((found.raw.jacobian - model.A).norm(), 1e-9);
        }
    }
}

// The minimum is that of least squares with the prior as two more readings; the covariance that of its derivatives.
TEST(ensemble, of_a_bent_model_is_at_the_minimum)
{
    for (const double s : {.003, .05}) {
        const Residuals model = decay(s);
        const Prior prior{VectorXd::Zero(2), VectorXd::Constant(2, 1.5)};
        const Inversion found = invert(model, as_they_are, prior, {.members = 40});
        EXPECT_TRUE(found.is_converged);
        const Model with_prior = [&](const VectorXd& p) -> std::optional<Evaluation> {
            Evaluation at{VectorXd(22), MatrixXd(22, 2)};
            at.residual << *model(p), p / 1.5;
            for (int i = 0; i < 2; ++i) {
                VectorXd more = p, less = p;
                more[i] += 1e-6;
                less[i] -= 1e-6;
                at.jacobian.col(i).head(20) = (*model(more) - *model(less)) / 2e-6;
            }
            at.jacobian.bottomRows(2) = MatrixXd::Identity(2, 2) / 1.5;
            return at;
        };
        const VectorXd far = VectorXd::Constant(2, 9);
        const Minimum minimum = minimise(with_prior, VectorXd::Zero(2), -far, far);
        const MatrixXd covariance = (minimum.there.jacobian.transpose() * minimum.there.jacobian).inverse();
        for (int i = 0; i < 2; ++i) {
            const double error = std::sqrt(covariance(i, i));
            EXPECT_NEAR(found.mean[i], minimum.parameters[i], .15 * error) << s;
            EXPECT_NEAR(std::sqrt(found.covariance(i, i)), error, .05 * error) << s;
        }
    }
}

TEST(ensemble, goes_on_without_members_that_have_no_answer)
{
    const Linear linear(30, 3);
    const Prior prior{VectorXd::Zero(3), VectorXd::Ones(3)};
    int calls = 0, answers = 0;
    const Residuals model = [&](const VectorXd& x) -> std::optional<VectorXd> {
        if (++calls % 5 == 0 && calls < 60)
            return {};
        ++answers;
        return linear(x);
    };
    const VectorXd exact = (linear.A.transpose() * linear.A + MatrixXd::Identity(3, 3))
                               .ldlt()
                               .solve(linear.A.transpose() * linear.b);
    EXPECT_LT((invert(model, as_they_are, prior, {.members = 15}).mean - exact).norm(), 1e-9);
    EXPECT_LT(answers, calls - 10);
    const Residuals hardly = [&](const VectorXd& x) { return ++calls % 4 == 0 ? linear(x) : std::nullopt; };
    calls = 3; // the prior's mean has an answer
    const Inversion failed = invert(hardly, as_they_are, prior, {.members = 15});
    EXPECT_FALSE(failed.is_converged);
    EXPECT_EQ(failed.failure, "only 3 of 15 members have an answer; expected 8 or more");
    // The best of the four that had one.
    EXPECT_EQ(failed.raw.residual, *linear(failed.mean));
    const auto sum = [&](const VectorXd& x) { return linear(x)->squaredNorm() + x.squaredNorm(); };
    EXPECT_LE(sum(failed.mean), sum(prior.mean));
    const Residuals never = [](const VectorXd&) { return std::optional<VectorXd>(); };
    EXPECT_THROW(invert(never, as_they_are, prior, {.members = 15}), jointcreep::input_error);
    EXPECT_THROW(invert(linear, as_they_are, prior, {.members = 7}), jointcreep::input_error);
}

// One reading y of x with deviation s, prior of mean 0 and deviation 1: the shift of the mean is y / (1 + s^2), and of the variance
// 1 / (1 + s^2) over all y that the prior allows.
TEST(ensemble, disagreement_is_that_of_the_reading_with_what_the_prior_expects)
{
    const Prior prior{VectorXd::Zero(2), VectorXd::Ones(2)};
    for (const double s : {.1, 1., 10.})
        for (const double y : {.5, -3., 20.}) {
            const Residuals model = [&](const VectorXd& x) -> std::optional<VectorXd> {
                return VectorXd::Constant(1, (x[0] - y) / s); // nothing of the second parameter
            };
            const Inversion found = invert(model, as_they_are, prior, {.members = 8});
            const VectorXd by = disagreement(found, prior);
            EXPECT_NEAR(by[0], y / std::sqrt(1 + s * s), 1e-6 * std::abs(y));
            EXPECT_EQ(by[1], 0);
        }
}

// A mean of m readings that scatter k times as much as their deviations say, and a prior with deviation d: the variance is
// 1 / (m / s^2 + 1 / d^2), s^2 the sum of squares over m - 1.
TEST(ensemble, intervals_have_the_noise_of_the_residuals_where_it_is_more)
{
    constexpr int m = 20;
    constexpr double d = .5;
    const Prior prior{VectorXd::Zero(1), VectorXd::Constant(1, d)};
    for (const double k : {1., 4.}) {
        const Residuals model = [k](const VectorXd& x) -> std::optional<VectorXd> {
            VectorXd r = VectorXd::Constant(m, x[0]);
            for (int i = 0; i < m; ++i)
                r[i] += i % 2 == 0 ? k : -k;
            return r;
        };
        const Inversion found = invert(model, as_they_are, prior, {.members = 6});
        const Minimum minimum{
            .parameters = found.mean, .there = found.raw, .at_bound = {AtBound::no}, .left = found.step};
        const Confidence confidence = with_prior(confidence_of(minimum, true), minimum, prior.deviation);
        const double s2 = k > 1 ? k * k * m / (m - 1) : 1;
        EXPECT_NEAR(confidence.noise_factor, std::sqrt(s2), 1e-9);
        EXPECT_NEAR(confidence.covariance(0, 0), 1 / (m / s2 + 1 / d / d), 1e-9);
    }
}

// All parameters have intervals, by the prior those without effect, too: Bonferroni over three, 0.05 / 6 on each side.
TEST(ensemble, intervals_of_all_together_are_those_of_all_parameters)
{
    const Linear linear(20, 2);
    const Prior prior{VectorXd::Zero(3), VectorXd::Ones(3)};
    const Residuals model = [&](const VectorXd& x) { return linear(.05 * x.head(2)); };
    const Inversion found = invert(model, as_they_are, prior, {.members = 10});
    Minimum minimum{.parameters = found.mean,
                    .there = found.raw,
                    .at_bound = std::vector(3, AtBound::no),
                    .left = found.step};
    minimum.there.residual *= .3;
    minimum.there.jacobian.col(2).setZero(); // but rounding
    const Confidence confidence = with_prior(confidence_of(minimum, true), minimum, prior.deviation);
    EXPECT_NEAR(confidence.quantile_all, 2.393980, 1e-4);
    EXPECT_NEAR(confidence.interval(0, 2, true).high, 2.393980, 1e-4);
}

TEST(ensemble, is_the_same_by_the_same_seed)
{
    const Prior prior{VectorXd::Zero(2), VectorXd::Constant(2, 1.5)};
    const auto mean = [&](std::uint64_t seed) {
        return invert(decay(.05), as_they_are, prior, {.members = 10, .seed = seed}).mean;
    };
    EXPECT_EQ(mean(1), mean(1));
    EXPECT_NE(mean(1), mean(2));
}

} // namespace ensemble_test
