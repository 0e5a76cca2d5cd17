#include "analysis/safety.hpp"

#include "joint/strength_factor.hpp"
#include "model/error.hpp"
#include "rock/strength_factor.hpp"

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <deque>
#include <exception>
#include <limits>
#include <map>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace jointcreep::analysis
{

namespace
{

// The scene with strengths divided by a factor, and a limit of displacement.
Scene trial_of(Scene scene, double factor, double most_displacement)
{
    if (factor != 1) {
        scene.rocks = rock::with_strength_divided(std::move(scene.rocks), factor);
        scene.joint_materials = joint::with_strength_divided(std::move(scene.joint_materials), factor);
    }
    scene.equilibrium.largest_displacement = most_displacement;
    return scene;
}

} // namespace

Trial::Trial(const Scene& scene, const Network& network, const EquivalentJoints& joints, double factor,
             double most_displacement, int threads, const Recording& recording, const Observer& observe)
    : factor_(factor), scene_(trial_of(scene, factor, most_displacement)),
      joints_(factor == 1 ? joints : joint::with_strength_divided(joints, factor)),
      analysis_(scene_, network, joints_, threads, recording, observe)
{
}

void Trial::attempt(const std::function<void()>& work)
{
    try {
        try {
            work();
        } catch (const Stopped&) {
            is_stopped_ = true;
            analysis_.give_up("stopped by a signal");
        }
    } catch (const equilibrium_error& error) {
        message_ = error.what();
    }
}

void Trial::run()
{
    attempt([&] { analysis_.run(); });
}

void Trial::go_on(Result so_far, Checkpoint kept)
{
    attempt([&] { analysis_.go_on(std::move(so_far), std::move(kept)); });
}

Outcome Trial::outcome() const
{
    const Ending ending = message_.empty()                           ? Ending::stands
                          : analysis_.result().failure.moves_on != 0 ? Ending::moves
                                                                     : Ending::undecided;
    return {ending, analysis_.largest_displacement(),
            rock::largest_plastic_strain(analysis_.assembly().zones)};
}

bool Bracket::fails() const
{
    const auto at = std::find(trials.factor.begin(), trials.factor.end(), *not_above);
    return trials.stands[at - trials.factor.begin()] == 0;
}

Bracket bracket_of(Safety trials)
{
    Bracket bracket{{}, {}, std::move(trials)};
    for (std::size_t i = 0; i < bracket.trials.factor.size(); ++i)
        (bracket.trials.stands[i] > 0 ? bracket.stands : bracket.not_above) = bracket.trials.factor[i];
    return bracket;
}

namespace
{

constexpr double most_factor = 64; // and its inverse

void add(Safety& trials, double factor, const Outcome& outcome)
{
    trials.factor.push_back(factor);
    trials.stands.push_back(outcome.ending == Ending::stands ? 1 : outcome.ending == Ending::moves ? 0 : -1);
    trials.largest_displacement.push_back(outcome.largest_displacement);
    trials.largest_plastic_strain.push_back(outcome.largest_plastic_strain);
}

} // namespace

std::optional<double> Search::next_factor(const Safety& so_far) const
{
    const auto& stands = so_far.stands;
    const std::size_t n = stands.size();
    if (n == 0)
        return 1 / most_factor;
    if (stands[0] <= 0)
        return std::nullopt;
    if (n == 1)
        return near.value_or(1);
    const bool up = stands[1] > 0;
    if (std::all_of(stands.begin() + 1, stands.end(), [&](Index stood) { return (stood > 0) == up; })) {
        double factor = so_far.factor.back();
        if (near)
            factor += (up ? 1 : -1) * std::ldexp(*near / 20, static_cast<int>(n) - 2);
        else
            factor *= up ? 2 : 0.5;
        if (factor <= most_factor && factor > 1 / most_factor)
            return factor;
    }
    const Bracket bracket = bracket_of(so_far);
    if (!bracket.not_above || *bracket.not_above - *bracket.stands <= width * *bracket.stands)
        return std::nullopt;
    return (*bracket.stands + *bracket.not_above) / 2;
}

std::optional<int> Search::runs_left(Safety so_far) const
{
    if (const Bracket bracket = bracket_of(so_far); !bracket.stands || !bracket.not_above)
        return std::nullopt;
    int left = 0; // most of them if all fail: the width is over the lower end
    for (std::optional<double> factor; (factor = next_factor(so_far)); ++left)
        add(so_far, *factor, {Ending::moves});
    return left;
}

double Search::most_displacement(const Safety& so_far) const
{
    const auto& displacement = so_far.largest_displacement;
    return displacement.empty() || displacement[0] <= 0 ? std::numeric_limits<double>::infinity()
                                                        : runs_away * displacement[0];
}

namespace
{

// Runs in threads of their own.
class SideBySide
{
public:
    SideBySide(const Search& search, Runs& runs, int at_once)
        : search_(search), runs_(runs), at_once_(static_cast<std::size_t>(at_once))
    {
    }

    Outcome outcome_of_next(double factor, const Safety& before)
    {
        keep_only(before);
        Made& next = made_.at(factor);
        while (!has_ended(next)) {
            wait();
            keep_only(before);
        }
        next.thread.join();
        const Made ended = std::move(next);
        made_.erase(factor);
        if (ended.error)
            std::rethrow_exception(ended.error);
        return *ended.outcome;
    }

private:
    struct Made {
        std::optional<Outcome> outcome{};
        std::exception_ptr error{};
        std::jthread thread{};
    };

    // Runs that are wanted: the next one, and beside it what comes after it if it stands or falls. The likelier of both
    // comes first: until a run has failed, that runs stand; then, that they fail, which takes longer to see.
    std::vector<double> wanted(const Safety& before)
    {
        std::vector<double> factors, reached;
        std::deque<Safety> ways{before};
        for (std::size_t ways_left = 64; !ways.empty() && ways_left > 0 && factors.size() < at_once_;
             --ways_left, ways.pop_front()) {
            const auto factor = search_.next_factor(ways.front());
            if (!factor)
                continue;
            const auto go = [&](const Outcome& outcome) {
                ways.push_back(ways.front());
                add(ways.back(), *factor, outcome);
            };
            const auto found = made_.find(*factor);
            if (found != made_.end() && has_ended(found->second)) {
                reached.push_back(*factor);
                if (found->second.outcome)
                    go(*found->second.outcome);
                continue;
            }
            factors.push_back(*factor);
            if (before.factor.empty()) // the limit of displacement is that run's
                break;
            const bool none_failed = std::count(before.stands.begin(), before.stands.end(), 1) ==
                                     static_cast<std::ptrdiff_t>(before.stands.size());
            go({none_failed ? Ending::stands : Ending::moves});
            go({none_failed ? Ending::moves : Ending::stands});
        }
        factors.insert(factors.end(), reached.begin(), reached.end());
        return factors;
    }

    // Stops runs that are not wanted, and begins those that are.
    void keep_only(const Safety& before)
    {
        const std::vector<double> factors = wanted(before);
        const auto is_wanted = [&](double factor) {
            return std::find(factors.begin(), factors.end(), factor) != factors.end();
        };
        for (auto& [factor, made] : made_)
            if (!is_wanted(factor))
                made.thread.request_stop();
        for (auto entry = made_.begin(); entry != made_.end();) {
            const double factor = entry->first;
            if (is_wanted(factor)) {
                ++entry;
                continue;
            }
            entry = made_.erase(entry); // waits until it has ended
            runs_.is_dropped(factor);
        }
        for (const double factor : factors)
            if (!made_.contains(factor))
                begin(factor, search_.most_displacement(before));
    }

    void begin(double factor, double most_displacement)
    {
        Made& made = made_[factor];
        made.thread = std::jthread([this, &made, factor, most_displacement](const std::stop_token& stop) {
            std::optional<Outcome> outcome;
            std::exception_ptr error;
            try {
                outcome = runs_.run(factor, most_displacement, stop);
            } catch (...) {
                error = std::current_exception();
            }
            const std::lock_guard lock(mutex_);
            made.outcome = outcome;
            made.error = error;
            ended_.notify_one();
            ++n_ended_;
        });
    }

    bool has_ended(const Made& made)
    {
        const std::lock_guard lock(mutex_);
        return made.outcome || made.error;
    }

    // Until one more run has ended.
    void wait()
    {
        std::unique_lock lock(mutex_);
        ended_.wait(lock, [&] { return n_ended_ > n_seen_; });
        n_seen_ = n_ended_;
    }

    const Search& search_;
    Runs& runs_;
    std::size_t at_once_;
    std::mutex mutex_;
    std::condition_variable ended_;
    std::size_t n_ended_ = 0, n_seen_ = 0;
    std::map<double, Made> made_; // going on or ended, not yet used
};

} // namespace

Bracket bracket_by(const Search& search, Runs& runs, int at_once, Safety made_before)
{
    Safety so_far = std::move(made_before);
    std::optional<SideBySide> side_by_side;
    if (at_once > 1)
        side_by_side.emplace(search, runs, at_once);
    while (const auto factor = search.next_factor(so_far)) {
        runs.is_next(*factor, so_far);
        add(so_far, *factor,
            side_by_side ? side_by_side->outcome_of_next(*factor, so_far)
                         : runs.run(*factor, search.most_displacement(so_far), {}));
        runs.has_ended(so_far);
    }
    return bracket_of(std::move(so_far));
}

} // namespace jointcreep::analysis
