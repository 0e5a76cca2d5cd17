#include "sampling/laws.hpp"

#include "model/error.hpp"
#include "statistics.hpp"

#include <gtest/gtest.h>

using namespace jointcreep;
using namespace jointcreep::statistics;

namespace
{

using Kind = Law::Kind;
using Draw = std::function<double(Stream&)>;

constexpr int draws = 100000;

Samples sample(const Draw& draw)
{
    Stream stream({20030601, 0, set_key("laws")}, 0, Purpose::spacing);
    Samples samples;
    for (int i = 0; i < draws; ++i)
        samples.push_back(draw(stream));
    return samples;
}

double normal_distribution(double z)
{
    return std::erfc(-z / std::numbers::sqrt2) / 2;
}

Distribution closed_form(const Law& law)
{
    return [law](double x) {
        const double s2 = std::log(1 + std::pow(law.deviation / law.mean, 2));
        switch (law.kind) {
        case Kind::normal:
            return normal_distribution((x - law.mean) / law.deviation);
        case Kind::lognormal:
            return x <= 0 ? 0 : normal_distribution((std::log(x / law.mean) + s2 / 2) / std::sqrt(s2));
        case Kind::negative_exponential:
            return x <= 0 ? 0 : -std::expm1(-x / law.mean);
        case Kind::constant:
            break;
        }
        return x < law.mean ? 0.0 : 1.0;
    };
}

bool obeys(const Law& law, const Draw& draw)
{
    const Samples samples = sample(draw);
    return follow(samples, closed_form(law)) && have_mean(samples, law.mean) &&
           have_deviation(samples, law.deviation);
}

bool obeys_size_biased(const Law& law, const Draw& draw)
{
    return follow(sample(draw), size_biased_distribution(law));
}

const Law normal{Kind::normal, 5, 1.5}, wide_normal{Kind::normal, 2, 2}, lognormal{Kind::lognormal, 5, 3},
    exponential{Kind::negative_exponential, 4, 4}, constant{Kind::constant, 3, 0};

} // namespace

TEST(Draw, FollowsTheLaw)
{
    for (const Law& law : {normal, wide_normal, lognormal, exponential})
        EXPECT_TRUE(obeys(law, [&](Stream& stream) { return draw(law, stream); }));
    EXPECT_EQ(sample([](Stream& stream) { return draw(constant, stream); }), Samples(draws, 3.0));
}

TEST(Draw, WouldBeCaughtTakingALognormalsParametersForThoseOfItsLogarithm)
{
    const Law of_logarithm{Kind::normal, std::log(lognormal.mean), lognormal.deviation / lognormal.mean};
    EXPECT_FALSE(obeys(lognormal, [&](Stream& stream) { return std::exp(draw(of_logarithm, stream)); }));
    const Law median_for_mean{Kind::normal, std::log(lognormal.mean), std::sqrt(std::log(1 + .36))};
    EXPECT_FALSE(obeys(lognormal, [&](Stream& stream) { return std::exp(draw(median_for_mean, stream)); }));
}

TEST(Draw, WouldBeCaughtOnePercentOff)
{
    EXPECT_FALSE(obeys(normal, [](Stream& stream) { return 1.01 * draw(normal, stream); }));
}

TEST(DrawPositive, CutsOffTheLowerTail)
{
    for (const Law& law : {normal, wide_normal, lognormal, exponential}) {
        const Samples samples = sample([&](Stream& stream) { return draw_positive(law, stream); });
        EXPECT_TRUE(follow(samples, positive_distribution(law)));
        EXPECT_TRUE(have_mean(samples, mean_of_positive(law)));
        EXPECT_GT(*std::min_element(samples.begin(), samples.end()), 0);
    }
}

TEST(DrawPositive, MovesTheMeanOfANormalAsStated)
{
    // 2 + 2 phi(1) / Phi(1)
    EXPECT_NEAR(mean_of_positive(wide_normal), 2 + 2 * .24197072451914337 / .84134474606854293, 1e-14);
    EXPECT_FALSE(have_mean(sample([](Stream& stream) { return draw_positive(wide_normal, stream); }), 2));
    EXPECT_LT(mean_of_positive({Kind::normal, 1, .28}) - 1, 2e-4);
}

TEST(DrawPositive, RefusesALawWithoutPositiveValues)
{
    Stream stream({1, 0, 0}, 0, Purpose::spacing);
    for (const Law& law : {Law{Kind::normal, -10, 1}, Law{Kind::constant, 0, 0}}) {
        EXPECT_THROW(draw_positive(law, stream), input_error);
    }
}

TEST(DrawSizeBiased, FollowsXTimesTheDensity)
{
    for (const Law& law : {normal, wide_normal, lognormal, exponential})
        EXPECT_TRUE(obeys_size_biased(law, [&](Stream& stream) { return draw_size_biased(law, stream); }));
    EXPECT_EQ(sample([](Stream& stream) { return draw_size_biased(constant, stream); }), Samples(draws, 3.0));
}

TEST(DrawSizeBiased, WouldBeCaughtWithoutTheBias)
{
    for (const Law& law : {normal, wide_normal, lognormal, exponential})
        EXPECT_FALSE(obeys_size_biased(law, [&](Stream& stream) { return draw_positive(law, stream); }));
}
