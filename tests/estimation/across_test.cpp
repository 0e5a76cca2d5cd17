// Draws of a model fitted to readings of a further draw: intervals hold the truth as often as they say.

#include "estimation/across.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace across_test
{

using namespace jointcreep::estimation;

namespace
{

// A model that says p + a with an unknown a of its own, fitted to one mean of readings with noise.
OfOneModel fitted(double reading, double own, double noise)
{
    OfOneModel one{VectorXd::Constant(1, reading - own), {}};
    one.confidence.is_fixed = {false};
    one.confidence.covariance = MatrixXd::Constant(1, 1, noise * noise);
    one.confidence.readings = 100;
    one.confidence.parameters = 1;
    return one;
}

double covered(std::size_t models, double scatter, double noise)
{
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal(0, 1);
    constexpr int trials = 4000;
    constexpr double truth = 0.3;
    int held = 0;
    for (int trial = 0; trial < trials; ++trial) {
        const double reading = truth + scatter * normal(random) + noise * normal(random);
        std::vector<OfOneModel> all;
        for (std::size_t k = 0; k < models; ++k)
            all.push_back(fitted(reading, scatter * normal(random), noise));
        const Across found = *across(all, true)[0];
        held += found.interval.low <= truth && truth <= found.interval.high ? 1 : 0;
    }
    return static_cast<double>(held) / trials;
}

} // namespace

// Three standard deviations of a count of 4000 are 0.0103. With both kinds of variance intervals are approximate.
TEST(across, truth_lies_in_95_percent_of_intervals)
{
    for (const std::size_t models : {2, 3, 5, 20}) {
        EXPECT_NEAR(covered(models, 1, 1e-3), 0.95, 0.0103) << models;
        EXPECT_NEAR(covered(models, 1e-3, 1), 0.95, 0.0103) << models;
        EXPECT_NEAR(covered(models, 1, 0.5), 0.95, 0.025) << models;
    }
}

TEST(across, is_by_hand_for_two)
{
    const std::vector<OfOneModel> two{fitted(1, 0, 0), fitted(1, 0.2, 0)};
    const Across found = *across(two, true)[0];
    EXPECT_NEAR(found.value, 0.9, 1e-12);
    EXPECT_NEAR(found.scatter, std::sqrt(0.02), 1e-12);
    EXPECT_NEAR(found.standard_error, std::sqrt(0.03), 1e-12);
    EXPECT_NEAR(found.interval.high - 0.9, 12.7062047 * std::sqrt(0.03), 1e-6);
}

// A fit that is worse than the deviations allow is what the draws do: it counts once, by their scatter.
TEST(across, misfit_counts_only_where_noise_is_not_known)
{
    std::vector<OfOneModel> two{fitted(1, 0, 0.6), fitted(1, 0, 0.6)};
    for (OfOneModel& one : two)
        one.confidence.noise_factor = 3;
    EXPECT_NEAR(across(two, true)[0]->standard_error, 0.2, 1e-12);
    EXPECT_NEAR(across(two, false)[0]->standard_error, 0.6, 1e-12);
    two[1].confidence.is_fixed = {true};
    EXPECT_FALSE(across(two, true)[0]);
}

} // namespace across_test
