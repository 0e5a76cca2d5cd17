// Brackets of a factor of safety, around thresholds that are known.

#include "analysis/safety.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <thread>

namespace safety_test
{

using namespace jointcreep;
using namespace jointcreep::analysis;

namespace
{

constexpr double runs_away = 10;

// Runs whose outcome is a function of the factor and the limit of displacement [m].
class RunsOf : public Runs
{
public:
    using Function = std::function<Outcome(double factor, double most_displacement)>;
    RunsOf(Function outcome) : outcome_(std::move(outcome)) {}

    Outcome run(double factor, double most_displacement, const std::stop_token& stop) override
    {
        const int now = ++going_on_;
        for (int most = most_at_once; now > most && !most_at_once.compare_exchange_weak(most, now);)
            ;
        if (slow) // the longer, the more a factor is above it: those that fail take longer
            for (int i = 0; i < (factor > *slow ? 40 : 10) && !stop.stop_requested(); ++i)
                std::this_thread::sleep_for(std::chrono::microseconds(100));
        --going_on_;
        if (stop.stop_requested())
            throw std::runtime_error("stopped");
        ++n_runs;
        return outcome_(factor, most_displacement);
    }
    void is_next(double factor, const Safety& before) override
    {
        next.push_back(factor);
        EXPECT_EQ(before.factor.size() + 1, next.size());
    }
    void has_ended(const Safety& so_far) override { EXPECT_EQ(so_far.factor, next); }

    std::optional<double> slow{};
    std::vector<double> next{};
    std::atomic<int> n_runs = 0, most_at_once = 0;

private:
    Function outcome_;
    std::atomic<int> going_on_ = 0;
};

auto moves_above(double threshold)
{
    return [=](double factor, double /*most_displacement*/) {
        return Outcome{factor <= threshold ? Ending::stands : Ending::moves, 0.001 * factor};
    };
}

Bracket found(RunsOf::Function outcome, double width = 0.01)
{
    RunsOf runs(std::move(outcome));
    return bracket_by({width, runs_away}, runs);
}

} // namespace

RC_GTEST_PROP(bracket_by, holds_the_threshold_and_is_as_narrow_as_wanted, ())
{
    const double threshold = std::exp(*rc::gen::inRange(-3000, 3000) / 1000.0);
    const double width = std::pow(10, -*rc::gen::inRange(0, 5));
    const Bracket bracket = found(moves_above(threshold), width);
    RC_ASSERT(bracket.stands.has_value() && bracket.not_above.has_value());
    RC_ASSERT(*bracket.stands <= threshold && threshold < *bracket.not_above);
    RC_ASSERT(*bracket.not_above - *bracket.stands <= width * *bracket.stands);
    // 1/64, 1, at most five doublings and no run twice.
    RC_ASSERT(bracket.trials.factor.size() <= 8 + std::ceil(std::log2(1 / width)));
    RC_ASSERT(bracket.trials.factor.size() == bracket.trials.stands.size());
}

RC_GTEST_PROP(bracket_by, has_the_same_runs_side_by_side_and_after_an_interruption, ())
{
    const double threshold = std::exp(*rc::gen::inRange(-3000, 3000) / 1000.0);
    const double width = std::pow(10, -*rc::gen::inRange(1, 4));
    Search search{width, runs_away};
    if (*rc::gen::arbitrary<bool>())
        search.near = threshold * std::exp(*rc::gen::inRange(-300, 300) / 1000.0);
    RunsOf alone(moves_above(threshold)), beside(moves_above(threshold)), continued(moves_above(threshold));
    if (*rc::gen::arbitrary<bool>())
        beside.slow = threshold;
    const Safety all = bracket_by(search, alone).trials;
    const int at_once = *rc::gen::inRange(2, 6);
    const Bracket bracket = bracket_by(search, beside, at_once);
    RC_ASSERT(bracket.trials.factor == all.factor && bracket.trials.stands == all.stands);
    RC_ASSERT(bracket.trials.largest_displacement == all.largest_displacement);
    RC_ASSERT(beside.most_at_once <= at_once);

    Safety begun = all;
    const auto n = static_cast<std::size_t>(*rc::gen::inRange(0, static_cast<int>(all.factor.size()) + 1));
    begun.factor.resize(n), begun.stands.resize(n);
    begun.largest_displacement.resize(n), begun.largest_plastic_strain.resize(n);
    continued.next = begun.factor;
    RC_ASSERT(bracket_by(search, continued, 1, begun).trials.factor == all.factor);
    RC_ASSERT(continued.n_runs + n == all.factor.size());
}

TEST(bracket_by, makes_runs_side_by_side)
{
    RunsOf runs(moves_above(1.7));
    runs.slow = 1.7;
    bracket_by({0.01, runs_away}, runs, 2);
    EXPECT_EQ(runs.most_at_once, 2);
}

TEST(bracket_by, passes_on_what_the_next_run_throws)
{
    const auto refuses = [](double factor, double /*most_displacement*/) -> Outcome {
        if (factor == 1.5)
            throw std::invalid_argument("one and a half");
        return {factor > 1.7 ? Ending::moves : Ending::stands};
    };
    RunsOf alone(refuses), beside(refuses);
    EXPECT_THROW(bracket_by({0.01, runs_away}, alone), std::invalid_argument);
    EXPECT_THROW(bracket_by({0.01, runs_away}, beside, 3), std::invalid_argument);
    // A run beside the next one that is not used after all
    RunsOf unused([](double factor, double /*most_displacement*/) -> Outcome {
        if (factor == 0.5)
            throw std::invalid_argument("a half");
        return {factor > 1.7 ? Ending::moves : Ending::stands};
    });
    EXPECT_EQ(bracket_by({0.5, runs_away}, unused, 4).stands, 1.5);
}

TEST(bracket_by, says_where_everything_or_nothing_stands)
{
    const Bracket strong = found(moves_above(1e6)), weak = found(moves_above(1e-6));
    EXPECT_EQ(strong.stands, 64);
    EXPECT_FALSE(strong.not_above);
    EXPECT_EQ(weak.not_above, 1.0 / 64);
    EXPECT_FALSE(weak.stands);
}

TEST(bracket_by, goes_up_or_down_from_a_known_factor)
{
    RunsOf up(moves_above(1.2)), down(moves_above(0.8));
    EXPECT_EQ(bracket_by({0.5, runs_away, 1.0}, up).trials.factor,
              (std::vector<double>{1. / 64, 1, 1 + 0.05, 1 + 0.05 + 0.1, 1 + 0.05 + 0.1 + 0.2}));
    EXPECT_EQ(bracket_by({0.5, runs_away, 1.0}, down).trials.factor,
              (std::vector<double>{1. / 64, 1, 1 - 0.05, 1 - 0.05 - 0.1, 1 - 0.05 - 0.1 - 0.2}));
}

TEST(bracket_by, takes_what_is_undecided_as_not_standing_and_says_so)
{
    const Bracket bracket = found(
        [](double factor, double /*most_displacement*/) {
            return Outcome{factor < 1.2 ? Ending::stands : factor < 1.7 ? Ending::undecided : Ending::moves};
        },
        0.1);
    EXPECT_EQ(bracket.trials.factor, (std::vector<double>{1. / 64, 1, 2, 1.5, 1.25, 1.125, 1.1875}));
    EXPECT_EQ(bracket.trials.stands, (std::vector<Index>{1, 1, 0, -1, -1, 1, 1}));
    EXPECT_EQ(bracket.stands, 1.1875);
    EXPECT_EQ(bracket.not_above, 1.25);
}

TEST(bracket_by, ends_where_displacement_runs_away)
{
    const auto displacement = [](double factor) {
        return 0.01 * std::exp(factor);
    }; // [m], no failure of its own
    const Bracket bracket = found([&](double factor, double most) {
        return Outcome{displacement(factor) <= most ? Ending::stands : Ending::moves, displacement(factor),
                       factor};
    });
    const double threshold = std::log(runs_away * std::exp(1. / 64));
    EXPECT_LE(*bracket.stands, threshold);
    EXPECT_GT(*bracket.not_above, threshold);
    for (std::size_t i = 0; i < bracket.trials.factor.size(); ++i) {
        EXPECT_EQ(bracket.trials.largest_displacement[i], displacement(bracket.trials.factor[i]));
        EXPECT_EQ(bracket.trials.largest_plastic_strain[i], bracket.trials.factor[i]);
    }
}

} // namespace safety_test
