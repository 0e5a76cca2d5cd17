// Brackets of a factor of safety, around thresholds that are known.

#include "analysis/safety.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

namespace safety_test
{

using namespace jointcreep;
using namespace jointcreep::analysis;

namespace
{

constexpr double runs_away = 10;

auto falls_above(double threshold)
{
    return [=](double factor, double /*most_displacement*/, const Safety&) {
        return Outcome{factor <= threshold ? Ending::stands : Ending::falls};
    };
}

} // namespace

RC_GTEST_PROP(bracket_of, holds_the_threshold_and_is_as_narrow_as_wanted, ())
{
    const double threshold = std::exp(*rc::gen::inRange(-3000, 3000) / 1000.0);
    const double width = std::pow(10, -*rc::gen::inRange(0, 5));
    const Bracket bracket = bracket_of(falls_above(threshold), width, runs_away);
    RC_ASSERT(bracket.stands.has_value() && bracket.not_above.has_value());
    RC_ASSERT(*bracket.stands <= threshold && threshold < *bracket.not_above);
    RC_ASSERT(*bracket.not_above - *bracket.stands <= width * *bracket.stands);
    // 1/64, 1, at most five doublings and no run twice.
    RC_ASSERT(bracket.trials.factor.size() <= 8 + std::ceil(std::log2(1 / width)));
    RC_ASSERT(bracket.trials.factor.size() == bracket.trials.stands.size());
}

TEST(bracket_of, says_where_everything_or_nothing_stands)
{
    const Bracket strong = bracket_of(falls_above(1e6), 0.01, runs_away),
                  weak = bracket_of(falls_above(1e-6), 0.01, runs_away);
    EXPECT_EQ(strong.stands, 64);
    EXPECT_FALSE(strong.not_above);
    EXPECT_EQ(weak.not_above, 1.0 / 64);
    EXPECT_FALSE(weak.stands);
}

TEST(bracket_of, takes_what_is_undecided_as_not_standing_and_says_so)
{
    const Bracket bracket = bracket_of(
        [](double factor, double /*most_displacement*/, const Safety&) {
            return Outcome{factor < 1.2 ? Ending::stands : factor < 1.7 ? Ending::undecided : Ending::falls};
        },
        0.1, runs_away);
    EXPECT_EQ(bracket.trials.factor, (std::vector<double>{1. / 64, 1, 2, 1.5, 1.25, 1.125, 1.1875}));
    EXPECT_EQ(bracket.trials.stands, (std::vector<Index>{1, 1, 0, -1, -1, 1, 1}));
    EXPECT_EQ(bracket.stands, 1.1875);
    EXPECT_EQ(bracket.not_above, 1.25);
}

TEST(bracket_of, ends_where_displacement_runs_away)
{
    const auto displacement = [](double factor) {
        return 0.01 * std::exp(factor);
    }; // [m], no failure of its own
    const Bracket bracket = bracket_of(
        [&](double factor, double most, const Safety&) {
            return Outcome{displacement(factor) <= most ? Ending::stands : Ending::falls,
                           displacement(factor), factor};
        },
        0.01, runs_away);
    const double threshold = std::log(runs_away * std::exp(1. / 64));
    EXPECT_LE(*bracket.stands, threshold);
    EXPECT_GT(*bracket.not_above, threshold);
    for (std::size_t i = 0; i < bracket.trials.factor.size(); ++i) {
        EXPECT_EQ(bracket.trials.largest_displacement[i], displacement(bracket.trials.factor[i]));
        EXPECT_EQ(bracket.trials.largest_plastic_strain[i], bracket.trials.factor[i]);
    }
}

} // namespace safety_test
