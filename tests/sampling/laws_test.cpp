#include "sampling/laws.hpp"

#include "model/error.hpp"
#include "statistics.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace laws_test
{

using namespace jointcreep;
using namespace jointcreep::sampling;
using namespace jointcreep::statistics;

namespace
{

using Kind = ProbabilityLaw::Kind;
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

Distribution closed_form(const ProbabilityLaw& law)
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
        case Kind::uniform:
            return std::clamp((x - law.least) / (law.most - law.least), 0.0, 1.0);
        case Kind::power: {
            const double q = 1 - law.exponent, t = std::clamp(x, law.least, law.most) / law.least,
                         r = law.most / law.least;
            return q == 0 ? std::log(t) / std::log(r) : (1 - std::pow(t, q)) / (1 - std::pow(r, q));
        }
        case Kind::constant:
            break;
        }
        return x < law.mean ? 0.0 : 1.0;
    };
}

bool obeys(const ProbabilityLaw& law, const Draw& draw)
{
    const Samples samples = sample(draw);
    return follow(samples, closed_form(law)) && have_mean(samples, law.mean) &&
           have_deviation(samples, law.deviation);
}

bool obeys_size_biased(const ProbabilityLaw& law, const Draw& draw)
{
    return follow(sample(draw), size_biased_distribution(law));
}

const ProbabilityLaw normal{Kind::normal, 5, 1.5}, wide_normal{Kind::normal, 2, 2},
    lognormal{Kind::lognormal, 5, 3}, exponential{Kind::negative_exponential, 4, 4},
    constant{Kind::constant, 3, 0}, uniform_lengths = uniform_law(2, 7),
                                    uniform_angles = uniform_law(-.3, .1), uniform_from_0 = uniform_law(0, 3);

const std::vector<ProbabilityLaw> power_laws{power_law(0, 1, 4),    power_law(1, 1, 20),
                                             power_law(2, 1, 20),   power_law(2.5, .5, 40),
                                             power_law(3, 2, 1000), power_law(20, 1, 1e6)};

std::vector<ProbabilityLaw> with_power_laws(std::vector<ProbabilityLaw> laws)
{
    laws.insert(laws.end(), power_laws.begin(), power_laws.end());
    return laws;
}

const std::vector<ProbabilityLaw> positive_laws =
    with_power_laws({normal, wide_normal, lognormal, exponential, uniform_lengths, uniform_from_0});

using DrawPole = std::function<Eigen::Vector3d(const Eigen::Vector3d& mean, double concentration, Stream&)>;

const std::vector<Eigen::Vector3d> mean_poles{
    {0, 1, 0}, {-1, 0, 0}, {.48, .6, .64}, Eigen::Vector3d(-1, 2, -1e-9).normalized()};

// Whether poles are unit vectors by Fisher's law: the angle from the mean pole, the turn about it, and the
// mean resultant, which points along the mean pole with the length that the concentration says.
bool obeys_fisher(const Eigen::Vector3d& mean_pole, double concentration, const DrawPole& draw)
{
    const Eigen::Vector3d across = mean_pole.unitOrthogonal(), third = mean_pole.cross(across);
    Stream stream({20030601, 0, set_key("Fisher")}, 0, Purpose::orientation);
    Samples angles, turns, along, sideways, upward;
    for (int i = 0; i < draws; ++i) {
        const Eigen::Vector3d pole = draw(mean_pole, concentration, stream);
        if (std::abs(pole.norm() - 1) > 1e-12)
            return false;
        const double x = pole.dot(across), y = pole.dot(third), z = pole.dot(mean_pole);
        angles.push_back(std::atan2(std::hypot(x, y), z));
        turns.push_back(std::atan2(y, x) / (2 * std::numbers::pi) + .5);
        along.push_back(z);
        sideways.push_back(x);
        upward.push_back(y);
    }
    return follow(angles, fisher_distribution(concentration)) &&
           follow(turns, [](double turn) { return turn; }) &&
           have_mean(along, fisher_resultant(concentration)) && have_mean(sideways, 0) &&
           have_mean(upward, 0);
}

// A pole at this angle from the mean pole, turned at random about it.
Eigen::Vector3d pole_at(double angle, const Eigen::Vector3d& mean_pole, Stream& stream)
{
    const Eigen::AngleAxisd turn(2 * std::numbers::pi * uniform(stream), mean_pole);
    return turn * Eigen::Vector3d(std::cos(angle) * mean_pole + std::sin(angle) * mean_pole.unitOrthogonal());
}

} // namespace

TEST(Draw, FollowsTheLaw)
{
    for (const ProbabilityLaw& law :
         with_power_laws({normal, wide_normal, lognormal, exponential, uniform_lengths, uniform_angles}))
        EXPECT_TRUE(obeys(law, [&](Stream& stream) { return draw(law, stream); }));
    EXPECT_EQ(sample([](Stream& stream) { return draw(constant, stream); }), Samples(draws, 3.0));
}

TEST(Draw, WouldBeCaughtTakingALognormalsParametersForThoseOfItsLogarithm)
{
    const ProbabilityLaw of_logarithm{Kind::normal, std::log(lognormal.mean),
                                      lognormal.deviation / lognormal.mean};
    EXPECT_FALSE(obeys(lognormal, [&](Stream& stream) { return std::exp(draw(of_logarithm, stream)); }));
    const ProbabilityLaw median_for_mean{Kind::normal, std::log(lognormal.mean),
                                         std::sqrt(std::log(1 + .36))};
    EXPECT_FALSE(obeys(lognormal, [&](Stream& stream) { return std::exp(draw(median_for_mean, stream)); }));
}

TEST(Draw, WouldBeCaughtTakingAUniformLawsDeviationForItsHalfWidth)
{
    const ProbabilityLaw narrow = uniform_law(uniform_angles.mean - uniform_angles.deviation,
                                              uniform_angles.mean + uniform_angles.deviation);
    EXPECT_FALSE(obeys(uniform_angles, [&](Stream& stream) { return draw(narrow, stream); }));
}

TEST(Draw, WouldBeCaughtOnePercentOff)
{
    EXPECT_FALSE(obeys(normal, [](Stream& stream) { return 1.01 * draw(normal, stream); }));
}

TEST(Draw, WouldBeCaughtTakingAPowerLawsExponentForThatOfTheNumberOfLongerOnes)
{
    for (const ProbabilityLaw& law : power_laws) {
        const ProbabilityLaw steeper = power_law(law.exponent + 1, law.least, law.most);
        EXPECT_FALSE(obeys(law, [&](Stream& stream) { return draw(steeper, stream); }));
    }
}

TEST(Draw, WouldBeCaughtWithoutAPowerLawsUpperCutOff)
{
    const ProbabilityLaw law = power_law(2.5, .5, 40);
    EXPECT_FALSE(obeys(law, [&](Stream& stream) { return .5 * std::pow(1 - uniform(stream), -1 / 1.5); }));
    EXPECT_FALSE(obeys(law, [&](Stream& stream) {
        return std::min(40., .5 * std::pow(1 - uniform(stream), -1 / 1.5)); // put on the cut-off
    }));
}

TEST(PowerLaw, HasItsMomentsInClosedForm)
{
    for (const ProbabilityLaw& law : power_laws) {
        // Simpson's rule in y = log(x), with dx = x dy.
        const int steps = 20000;
        const double step = std::log(law.most / law.least) / steps;
        double moments[3] = {};
        for (int i = 0; i <= steps; ++i) {
            const double y = i * step, weight = i == 0 || i == steps ? 1 : i % 2 == 1 ? 4 : 2;
            for (int order = 0; order < 3; ++order)
                moments[order] += weight * std::exp((order + 1 - law.exponent) * y);
        }
        const double mean = law.least * moments[1] / moments[0];
        EXPECT_NEAR(law.mean, mean, 1e-9 * mean) << law.exponent;
        const double square = law.least * law.least * moments[2] / moments[0];
        EXPECT_NEAR(law.deviation, std::sqrt(square - mean * mean), 1e-6 * law.deviation) << law.exponent;
    }
    // As in the limits of a uniform law and of no cut-off.
    EXPECT_NEAR(power_law(0, 1, 4).mean, 2.5, 1e-14);
    EXPECT_NEAR(power_law(0, 1, 4).deviation, std::sqrt(.75), 1e-14);
    EXPECT_NEAR(power_law(5, 1, 1e6).mean, 4 / 3., 1e-12);
    // Through the exponents at which an integral is a logarithm.
    for (const double exponent : {1., 2., 3.}) {
        const ProbabilityLaw at = power_law(exponent, 1, 50), beside = power_law(exponent + 1e-9, 1, 50);
        EXPECT_NEAR(at.mean, beside.mean, 1e-7);
        EXPECT_NEAR(at.deviation, beside.deviation, 1e-7);
    }
}

TEST(DrawFisher, FollowsFishersLaw)
{
    for (const Eigen::Vector3d& mean_pole : mean_poles)
        for (const double concentration : {.5, 5.0, 60.0, 1e6})
            EXPECT_TRUE(obeys_fisher(mean_pole, concentration, draw_fisher)) << concentration;
}

TEST(DrawFisher, WouldBeCaughtWithoutTheSineOfTheAngle)
{
    // The density exp(-kappa t^2 / 2) of the angle itself.
    const DrawPole wrong = [](const Eigen::Vector3d& mean_pole, double concentration, Stream& stream) {
        const ProbabilityLaw angle{Kind::normal, 0, 1 / std::sqrt(concentration)};
        return pole_at(std::abs(draw(angle, stream)), mean_pole, stream);
    };
    EXPECT_FALSE(obeys_fisher(mean_poles[2], 60, wrong));
}

TEST(DrawFisher, WouldBeCaughtWithoutTheOtherEndOfTheSphere)
{
    // Without exp(-2 kappa) in the logarithm; angles beyond pi are pi.
    const DrawPole wrong = [](const Eigen::Vector3d& mean_pole, double concentration, Stream& stream) {
        const double cosine = 1 + std::log1p(-uniform(stream)) / concentration;
        return pole_at(std::acos(std::max(cosine, -1.0)), mean_pole, stream);
    };
    EXPECT_FALSE(obeys_fisher(mean_poles[2], .5, wrong));
}

TEST(DrawFisher, WouldBeCaughtTwoPercentOffOrTurnedOneSidedly)
{
    const DrawPole too_near = [](const Eigen::Vector3d& mean_pole, double concentration, Stream& stream) {
        return draw_fisher(mean_pole, 1.02 * concentration, stream);
    };
    EXPECT_FALSE(obeys_fisher(mean_poles[2], 60, too_near));
    const DrawPole one_sided = [](const Eigen::Vector3d& mean_pole, double concentration, Stream& stream) {
        const Eigen::Vector3d across = mean_pole.unitOrthogonal(),
                              pole = draw_fisher(mean_pole, concentration, stream);
        return Eigen::Vector3d(pole - 2 * std::min(0.0, pole.dot(across)) * across);
    };
    EXPECT_FALSE(obeys_fisher(mean_poles[2], 60, one_sided));
}

TEST(DrawPositive, CutsOffTheLowerTail)
{
    for (const ProbabilityLaw& law : positive_laws) {
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
    for (const ProbabilityLaw& law :
         {ProbabilityLaw{Kind::normal, -10, 1}, ProbabilityLaw{Kind::constant, 0, 0}}) {
        EXPECT_THROW(draw_positive(law, stream), input_error);
    }
}

TEST(DrawSizeBiased, FollowsXTimesTheDensity)
{
    for (const ProbabilityLaw& law : positive_laws)
        EXPECT_TRUE(obeys_size_biased(law, [&](Stream& stream) { return draw_size_biased(law, stream); }));
    EXPECT_EQ(sample([](Stream& stream) { return draw_size_biased(constant, stream); }), Samples(draws, 3.0));
}

TEST(DrawSizeBiased, WouldBeCaughtWithoutTheBias)
{
    for (const ProbabilityLaw& law : positive_laws)
        EXPECT_FALSE(obeys_size_biased(law, [&](Stream& stream) { return draw_positive(law, stream); }));
}

TEST(DrawBiased, FollowsAPowerOfXTimesTheDensity)
{
    for (const ProbabilityLaw& law : positive_laws)
        for (const int order : {0, 1, 2, 3}) {
            const Distribution right =
                integrated([&](double x) { return std::pow(x, order) * density(law, x); }, grid(law));
            EXPECT_TRUE(
                follow(sample([&](Stream& stream) { return draw_biased(law, order, stream); }), right))
                << static_cast<int>(law.kind) << ", order " << order;
            EXPECT_FALSE(
                follow(sample([&](Stream& stream) { return draw_biased(law, order + 1, stream); }), right));
        }
    EXPECT_EQ(sample([](Stream& stream) { return draw_biased(constant, 2, stream); }), Samples(draws, 3.0));
}

TEST(MomentOfPositive, IsTheIntegral)
{
    for (const ProbabilityLaw& law : positive_laws)
        for (const int order : {0, 1, 2, 3, 4}) {
            const std::vector<double> places = grid(law);
            double sum = 0, total = 0; // by the trapezoidal rule
            for (std::size_t i = 1; i < places.size(); ++i) {
                const double a = density(law, places[i - 1]), b = density(law, places[i]);
                total += (places[i] - places[i - 1]) * (a + b);
                sum += (places[i] - places[i - 1]) *
                       (std::pow(places[i - 1], order) * a + std::pow(places[i], order) * b);
            }
            EXPECT_NEAR(moment_of_positive(law, order) / (sum / total), 1, 3e-4)
                << static_cast<int>(law.kind) << ", order " << order;
        }
    EXPECT_EQ(moment_of_positive(constant, 3), 27);
    EXPECT_NEAR(moment_of_positive(wide_normal, 1), mean_of_positive(wide_normal), 1e-14);
}

TEST(DrawPoisson, HasItsMeanAndVariance)
{
    for (const double expected : {.3, 7., 4000.}) {
        const Samples counts =
            sample([&](Stream& stream) { return static_cast<double>(draw_poisson(expected, stream)); });
        EXPECT_TRUE(have_mean(counts, expected));
        EXPECT_TRUE(have_deviation(counts, std::sqrt(expected)));
    }
    Stream stream({1, 0, 0}, 0, Purpose::count);
    EXPECT_EQ(draw_poisson(0, stream), 0);
}

} // namespace laws_test
