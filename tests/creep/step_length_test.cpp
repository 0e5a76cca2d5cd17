// Lengths of creep steps, of a fixed length and by their error.

#include "creep/step_length.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <limits>

namespace step_length_test
{

using namespace jointcreep;
using creep::StepLength;

namespace
{

constexpr double infinite = std::numeric_limits<double>::infinity();

CreepSettings fixed(double step)
{
    CreepSettings settings;
    settings.step = step;
    return settings;
}

CreepSettings tolerant(CreepScheme scheme = CreepScheme::fitted)
{
    CreepSettings settings;
    settings.tolerance = 1e-5;
    settings.first_step = 1;
    settings.shortest_step = 0.01;
    settings.longest_step = 50;
    settings.scheme = scheme;
    return settings;
}

} // namespace

RC_GTEST_PROP(step_length, fixed_ones_are_equal_up_to_a_date, ())
{
    const double step = *rc::gen::inRange(1, 1000) / 100., date = *rc::gen::inRange(1, 100000) / 1000.;
    StepLength length(fixed(step), 1, infinite);
    double now = 0;
    int n = 0;
    const double first = length.next(date, infinite);
    while (date - now > 1e-9 * date) {
        const double next = length.next(date - now, infinite);
        RC_ASSERT(std::abs(next - first) < 1e-9 * first);
        RC_ASSERT(length.stands(next, 1)); // whatever the error
        now += next;
        ++n;
    }
    RC_ASSERT(n == static_cast<int>(std::ceil(date / step * (1 - 1e-12))));
    RC_ASSERT(first <= step * (1 + 1e-11));
}

TEST(step_length, no_step_is_longer_than_the_caller_allows)
{
    EXPECT_DOUBLE_EQ(StepLength(fixed(10), 1, infinite).next(12, 5), 4);
    EXPECT_DOUBLE_EQ(StepLength(tolerant(), 1, infinite).next(100, 0.1), 0.1);
}

// Two steps before a date they are made equal: no last one is tiny.
TEST(step_length, the_last_two_before_a_date_are_equal)
{
    const StepLength length(tolerant(), 1, infinite);
    EXPECT_EQ(length.next(10, infinite), 1);
    EXPECT_EQ(length.next(1.001, infinite), 1.001 / 2);
    EXPECT_EQ(length.next(1, infinite), 1);
    EXPECT_EQ(length.next(0.3, infinite), 0.3);
}

TEST(step_length, grows_and_shrinks_with_the_error)
{
    for (const CreepScheme scheme : {CreepScheme::fitted, CreepScheme::backward}) {
        const double order = scheme == CreepScheme::fitted ? 3 : 2;
        StepLength length(tolerant(scheme), 1, infinite);
        EXPECT_TRUE(length.stands(1, 5e-6));
        EXPECT_NEAR(length.next(1000, infinite), 0.9 * std::pow(2, 1 / order), 1e-12);
        EXPECT_TRUE(length.stands(1, 1e-12));
        EXPECT_NEAR(length.next(1000, infinite), 3, 1e-12); // at most
        EXPECT_FALSE(length.stands(3, 2e-5));
        EXPECT_NEAR(length.next(1000, infinite), 3 * 0.9 * std::pow(0.5, 1 / order), 1e-12);
        EXPECT_FALSE(length.stands(2, 1));
        EXPECT_NEAR(length.next(1000, infinite), 0.4, 1e-12); // at least
    }
}

TEST(step_length, stays_between_shortest_and_longest)
{
    StepLength length(tolerant(), 1, infinite);
    for (int i = 0; i < 20; ++i)
        length.stands(length.next(1e6, infinite), 0);
    EXPECT_EQ(length.next(1e6, infinite), 50);
    length.start_afresh();
    EXPECT_EQ(length.next(1e6, infinite), 1);
    for (int i = 0; i < 20 && !length.stands(length.next(1e6, infinite), 1); ++i)
        ;
    EXPECT_EQ(length.next(1e6, infinite), 0.01);
    EXPECT_TRUE(length.stands(0.01, 1)); // the shortest stands whatever its error
    length.start_afresh();
    EXPECT_EQ(length.next(1e6, infinite), 0.01); // nothing speaks for a longer one yet
}

TEST(step_length, a_step_cut_by_a_date_says_nothing_against_a_longer_one)
{
    StepLength length(tolerant(), 1, infinite);
    length.stands(1, 0);
    EXPECT_EQ(length.next(1000, infinite), 3);
    EXPECT_TRUE(length.stands(0.1, 1e-9));
    EXPECT_EQ(length.next(1000, infinite), 3);
    EXPECT_TRUE(length.stands(0.1, 9.9e-6)); // but if its error was nearly too large it does
    EXPECT_LT(length.next(1000, infinite), 0.1);
}

TEST(step_length, without_settings_begins_with_a_tenth_of_the_fastest_time)
{
    CreepSettings settings;
    settings.tolerance = 1e-5;
    EXPECT_DOUBLE_EQ(StepLength(settings, 4, infinite).next(1000, infinite), 0.1 / 4);
}

// The published scheme's stable length is never reached, whatever the scene says.
TEST(step_length, stays_below_what_is_stable)
{
    CreepSettings settings = tolerant(CreepScheme::published);
    StepLength length(settings, 1, 20);
    for (int i = 0; i < 20; ++i)
        length.stands(length.next(1e6, infinite), 0);
    EXPECT_DOUBLE_EQ(length.next(1e6, infinite), 0.99 * 20);
    StepLength short_of_shortest(settings, 1, 0.005);
    EXPECT_LT(short_of_shortest.next(1e6, infinite), 0.005);
    short_of_shortest.stands(0.004, 1);
    EXPECT_LT(short_of_shortest.next(1e6, infinite), 0.005);
    settings.shortest_step.reset();
    settings.first_step = 30;
    EXPECT_LT(StepLength(settings, 1, 20).next(1e6, infinite), 20);
}

} // namespace step_length_test
