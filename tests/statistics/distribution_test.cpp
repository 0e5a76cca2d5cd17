// Against tables, closed forms and plain integration.

#include "statistics/distribution.hpp"

#include "model/units.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace distribution_test
{

using namespace jointcreep;
using namespace jointcreep::statistics;

namespace
{

using Kind = ProbabilityLaw::Kind;

const std::vector<ProbabilityLaw> positive_laws = {
    {Kind::negative_exponential, 4, 4},
    {Kind::lognormal, 4, 3},
    {Kind::normal, 4, 3},
    uniform_law(1, 7),
    power_law(2.5, 1.5, 40),
    power_law(1, 1, 10),
};

// Moments from the distribution alone: E[X^p] = integral of p x^(p-1) (1 - F(x)).
double moment(const ProbabilityLaw& law, double order)
{
    const int steps = 400000;
    const double end = law.kind == Kind::power || law.kind == Kind::uniform ? law.most : 60 * law.mean;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
        const double x = end * (i + 0.5) / steps;
        sum += order * std::pow(x, order - 1) * (1 - positive_distribution(law, x)) * end / steps;
    }
    return sum;
}

} // namespace

TEST(Distribution, HasTheMomentsOfItsLaw)
{
    for (const ProbabilityLaw& law : positive_laws) {
        const double first = moment(law, 1), second = moment(law, 2), third = moment(law, 3);
        const Moments closed = positive_moments(law);
        EXPECT_NEAR(closed.mean / first, 1, 1e-4);
        EXPECT_NEAR(closed.squared_variation, second / (first * first) - 1, 1e-3);
        const double central = third - 3 * first * second + 2 * first * first * first;
        EXPECT_NEAR(closed.third, central / (first * first * first), 2e-2 * (1 + closed.third));
    }
}

TEST(Distribution, IsTheInverseOfTheQuantile)
{
    for (const ProbabilityLaw& law : {ProbabilityLaw{Kind::normal, -.3, .2}, uniform_law(-1, 2)})
        for (const double p : {.001, .3, .5, .99})
            EXPECT_NEAR(distribution(law, quantile(law, p)), p, 1e-12);
}

// Tables of Stephens 1970: sqrt(n) D (corrected) of 1.358 and V of 1.747 have the probability 0.05.
TEST(Distribution, FitsAsInTables)
{
    const std::size_t n = 10000;
    std::vector<double> even;
    for (std::size_t i = 0; i < n; ++i)
        even.push_back((double(i) + .5) / double(n));
    std::vector<double> shifted = even;
    for (double& x : shifted)
        x = std::min(1.0, x + 1.358 / (100 + .12 + .0011) - .5 / double(n));
    EXPECT_NEAR(kolmogorov_smirnov(shifted).p_value, .05, .0005);
    EXPECT_EQ(kolmogorov_smirnov(even).p_value, 1);

    std::vector<double> gapped; // V is the gap
    const double gap = 1.747 / (100 + .155 + .0024) - 1 / double(n);
    for (const double x : even)
        gapped.push_back(x * (1 - gap));
    const Fit fit = kuiper(gapped);
    EXPECT_NEAR(fit.p_value, .05, .002);
    for (double& x : gapped) // wherever the circle begins
        x = std::fmod(x + .3, 1.0);
    EXPECT_NEAR(kuiper(gapped).p_value, fit.p_value, 1e-9);
}

// Negative exponential intervals make a Poisson number.
TEST(Counts, ArePoissonsForExponentialIntervals)
{
    const Renewal renewal{4, 1, 2};
    double term = std::exp(-5.0), below = 0;
    for (int n = 1; n < 15; ++n) {
        below += term;
        term *= 5.0 / n;
        EXPECT_NEAR(at_least(n, 20, renewal), 1 - below, 1e-12) << n;
    }
    EXPECT_NEAR(count_variance(20, renewal), 5, 1e-12);
    // Garwood's interval of a Poisson mean for a count of 10 is 4.80 to 18.39; mid-p is a little narrower.
    const Range range = mean_range(10, 20, renewal, .95);
    EXPECT_NEAR(20 / range.high, 5.1, .1);
    EXPECT_NEAR(20 / range.low, 17.8, .1);
    EXPECT_NEAR(count_p(5, 20, renewal), 1, .2);
}

// With constant intervals the number is known but for the place of the first point.
TEST(Counts, AreSureForConstantIntervals)
{
    const Renewal renewal{4, 0, 0};
    EXPECT_GT(count_p(5, 20, renewal), .5);
    EXPECT_LT(count_p(8, 20, renewal), 1e-6);
    EXPECT_LT(count_p(2, 20, renewal), 1e-6);
    EXPECT_NEAR(count_variance(20, renewal), 1.0 / 6, 1e-12);
}

// The same tables, with the correction for 10 values.
TEST(Distribution, FitsOfSmallSamplesAsInTables)
{
    const double n = 10, root = std::sqrt(n);
    const auto short_of = [&](double missing) { // the largest value is so much below 1
        std::vector<double> uniforms;
        for (int i = 1; i <= 10; ++i)
            uniforms.push_back(i / n * (1 - missing));
        return uniforms;
    };
    const double above = 1.358 / (root + 0.12 + 0.11 / root);
    const Fit one = kolmogorov_smirnov(short_of(above));
    EXPECT_NEAR(one.distance, above, 1e-12);
    EXPECT_NEAR(one.p_value, 0.05, 5e-4);
    const double both = 1.747 / (root + 0.155 + 0.24 / root); // above, and (1 - above) / n below
    const Fit round = kuiper(short_of((n * both - 1) / (n - 1)));
    EXPECT_NEAR(round.distance, both, 1e-12);
    EXPECT_NEAR(round.p_value, 0.05, 5e-4);
}

} // namespace distribution_test
