// Curves made by the formula, with noise: the constants that made them lie in their intervals as often as
// these say.

#include "estimation/creep_curve.hpp"
#include "model/error.hpp"
#include "model/units.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace creep_curve_test
{

using namespace jointcreep;
using namespace jointcreep::estimation;

namespace
{

constexpr double day = unit::day;
// The paper's Table 2, normal direction: E 480 MPa/m, eta 57600 MPa day/m; K 690 MPa/m.
constexpr double elastic = 4e-3, stiffness = 480. / 690, viscosity = 57600. / 690 * day;
constexpr double tau = viscosity / stiffness, creep = elastic / stiffness;

// Readings every `step` days until `record`.
CreepCurve curve(double record, double step, double noise, std::mt19937_64& random)
{
    std::normal_distribution<double> error(0, 1);
    CreepCurve made;
    for (double t = 0; t <= record * (1 + 1e-9); t += step * day) {
        made.time.push_back(t);
        made.displacement.push_back(elastic - creep * std::expm1(-t / tau) + noise * error(random));
    }
    return made;
}

bool holds(const Interval& interval, double value)
{
    return interval.low <= value && value <= interval.high;
}

struct Coverage {
    int stiffness = 0, viscosity = 0, time = 0, too_short = 0;
};

// How many of `trials` fits hold the truth in their intervals; intervals times `widened`.
Coverage coverage(int trials, double record, bool knows_elastic, bool knows_noise, double widened = 1)
{
    std::mt19937_64 random(20030501);
    Coverage count;
    const double noise = 2e-4;
    for (int i = 0; i < trials; ++i) {
        CreepCurve made = curve(record, record < tau ? 1 : 7, noise, random);
        if (knows_elastic)
            made.elastic_part = elastic;
        if (knows_noise)
            made.deviation.assign(made.time.size(), noise);
        const CurveFit fit = fit_curve(made);
        count.too_short += fit.is_too_short ? 1 : 0;
        const auto wider = [&](const Estimate& e) {
            return Interval{e.value * std::pow(e.interval.low / e.value, widened),
                            e.value * std::pow(e.interval.high / e.value, widened)};
        };
        count.stiffness += holds(wider(fit.stiffness), stiffness) ? 1 : 0;
        count.viscosity += holds(wider(fit.viscosity), viscosity) ? 1 : 0;
        count.time += holds(wider(fit.time), tau) ? 1 : 0;
    }
    return count;
}

} // namespace

TEST(creep_curve, without_noise_gives_back_what_made_it)
{
    std::mt19937_64 random(1);
    for (const double record : {0.5, 1.0, 3.0, 20.0}) {
        const CurveFit fit = fit_curve(curve(record * tau, 7, 0, random));
        EXPECT_NEAR(fit.stiffness.value / stiffness, 1, 1e-6) << record;
        EXPECT_NEAR(fit.viscosity.value / viscosity, 1, 1e-6) << record;
        EXPECT_NEAR(fit.elastic_part / elastic, 1, 1e-6) << record;
        EXPECT_FALSE(fit.is_too_short) << record;
    }
}

TEST(creep_curve, truth_lies_in_its_interval_in_90_of_100_trials)
{
    for (const bool knows_elastic : {false, true})
        for (const bool knows_noise : {false, true}) {
            const Coverage count = coverage(100, 365 * day, knows_elastic, knows_noise);
            EXPECT_GE(count.stiffness, 90);
            EXPECT_GE(count.viscosity, 90);
            EXPECT_GE(count.time, 90);
        }
}

// 600 trials: 95 percent within 3 standard deviations of a binomial count, 2.7 percent. Records of a third of
// tau, which do not tell E at all, among them.
TEST(creep_curve, intervals_are_neither_too_narrow_nor_too_wide)
{
    for (const double record : {365 * day, tau / 3}) {
        const Coverage count = coverage(600, record, record < tau, false);
        for (const int held : {count.stiffness, count.viscosity, count.time}) {
            EXPECT_GT(held, 600 * 0.923) << record / day;
            EXPECT_LT(held, 600 * 0.977) << record / day;
        }
        EXPECT_EQ(count.too_short > 300, record < tau);
    }
    // The control: without the noise's scale, or with half of it, the same count would not hold.
    EXPECT_LT(coverage(100, 365 * day, false, false, 0.5).stiffness, 90);
    EXPECT_LT(coverage(100, 365 * day, false, false, 0.5).viscosity, 90);
}

TEST(creep_curve, a_short_record_tells_viscosity_but_not_stiffness)
{
    std::mt19937_64 random(7);
    const CurveFit fit = fit_curve(curve(0.3 * tau, 1, 2e-4, random));
    EXPECT_TRUE(fit.is_too_short);
    const auto width = [](const Estimate& e) { return e.interval.high / e.interval.low; };
    EXPECT_GT(width(fit.stiffness), 4);
    EXPECT_LT(width(fit.viscosity), width(fit.stiffness) / 2);
    EXPECT_LT(fit.record_length, 1);
    EXPECT_TRUE(holds(fit.viscosity.interval, viscosity));
    // A straight line has no end at all.
    CreepCurve line;
    for (int i = 0; i < 30; ++i) {
        line.time.push_back(i * day);
        line.displacement.push_back(1e-3 + 1e-5 * i);
    }
    EXPECT_TRUE(fit_curve(line).is_too_short);
    // With long ones and much noise it is the noise, but for the odd one that looks like a straight line.
    int open = 0, too_short = 0;
    for (int i = 0; i < 40; ++i) {
        CreepCurve loud = curve(8 * tau, 60, 1.5e-3, random);
        loud.displacement.front() = elastic; // so that parts go the same way
        const CurveFit loud_fit = fit_curve(loud);
        open += loud_fit.is_stiffness_open ? 1 : 0;
        too_short += loud_fit.is_too_short ? 1 : 0;
        EXPECT_TRUE(!loud_fit.is_too_short || loud_fit.record_length < 2);
    }
    EXPECT_GT(open, 20);
    EXPECT_LT(too_short, 4);
    // Over before the second reading.
    CreepCurve late;
    for (int i = 0; i < 30; ++i) {
        late.time.push_back(i * 1000 * tau);
        late.displacement.push_back(elastic + (i > 0 ? creep : 0) + 1e-6 * (i % 3));
    }
    EXPECT_TRUE(fit_curve(late).is_too_coarse);
}

// Eq. 14 takes E from d(T_c): after a year, 3.04 tau, 4.8 percent of creep are still to come, and E is too
// high by as much.
TEST(creep_curve, closed_estimate_is_the_papers)
{
    std::mt19937_64 random(3);
    const CreepCurve made = curve(365 * day, 1, 0, random);
    const ClosedEstimate found = closed_estimate(made, 365 * day);
    EXPECT_NEAR(found.stiffness.value, elastic / (made.displacement.back() - elastic), 1e-12);
    EXPECT_NEAR(found.stiffness.value / stiffness, 1 / (1 - std::exp(-365 * day / tau)), 1e-9);
    EXPECT_NEAR(found.viscosity.value / viscosity, 1, 0.07);
    const CreepCurve longer = curve(20 * tau, 7, 0, random);
    const ClosedEstimate at_end = closed_estimate(longer, longer.time.back());
    EXPECT_NEAR(at_end.stiffness.value / stiffness, 1, 1e-6);
    EXPECT_NEAR(at_end.viscosity.value / viscosity, 1, 1e-6);
    // Its intervals hold the truth where creep is over.
    int stiffnesses = 0, viscosities = 0;
    for (int i = 0; i < 200; ++i) {
        const CreepCurve noisy = curve(8 * tau, 7, 2e-4, random);
        const ClosedEstimate trial = closed_estimate(noisy, noisy.time.back());
        stiffnesses += holds(trial.stiffness.interval, stiffness) ? 1 : 0;
        viscosities += holds(trial.viscosity.interval, viscosity) ? 1 : 0;
    }
    EXPECT_GE(stiffnesses, 180);
    EXPECT_GE(viscosities, 180);
}

TEST(creep_curve, sign_does_not_matter)
{
    std::mt19937_64 random(5);
    CreepCurve made = curve(365 * day, 7, 2e-4, random);
    const CurveFit up = fit_curve(made);
    for (double& d : made.displacement)
        d = -d;
    const CurveFit down = fit_curve(made);
    EXPECT_NEAR(up.stiffness.value, down.stiffness.value, 1e-9);
    EXPECT_NEAR(up.viscosity.interval.high / down.viscosity.interval.high, 1, 1e-9);
    EXPECT_NEAR(up.elastic_part, -down.elastic_part, 1e-12);
}

TEST(creep_curve, what_is_none_is_refused)
{
    EXPECT_THROW(fit_curve({.time = {0, day, 2 * day}, .displacement = {1, 2, 3}}), input_error);
    CreepCurve back; // goes back after the elastic part
    for (int i = 0; i < 30; ++i) {
        back.time.push_back(i * day);
        back.displacement.push_back(1e-3 + 1e-3 * std::exp(-i / 5.0));
    }
    EXPECT_THROW(fit_curve(back), input_error);
    std::mt19937_64 random(5);
    EXPECT_THROW(closed_estimate(curve(365 * day, 7, 0, random), 400 * day), input_error);
}

} // namespace creep_curve_test
