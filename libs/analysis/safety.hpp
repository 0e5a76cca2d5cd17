// Factor of safety by strength reduction: the largest factor F that strengths can be divided by before the rock fails
// (libs/joint/strength_factor.hpp). The result is a bracket of F, by whole runs.
//
// Rock fails where there is no equilibrium, or where its displacement grows without bound. Zones that lock in
// plastic flow carry more than the rock does, and are in equilibrium long after it would have collapsed. The measure
// is the largest displacement over that of the same run with strengths 64 times as large, in which hardly anything
// slips or yields.

#pragma once

#include "analysis/analysis.hpp"
#include "model/result.hpp"

#include <functional>
#include <optional>
#include <stop_token>
#include <string>

namespace jointcreep::analysis
{

// How a run ends: every equilibrium found; rock seen to slide or fall; or undecided within the limits of the search.
enum class Ending { stands, moves, undecided };

struct Outcome {
    Ending ending;
    double largest_displacement = 0;   // since the in-situ equilibrium [m]
    double largest_plastic_strain = 0; // shear strain of a zone [-]
};

// An analysis with strengths divided by a factor [-].
class Trial
{
public:
    // The run fails where the largest displacement is more than `most_displacement` [m].
    Trial(const Scene& scene, const Network& network, const EquivalentJoints& joints, double factor,
          double most_displacement, int threads, const Recording& recording, const Observer& observe);

    // The same as in Analysis, once. Without an equilibrium they end with a message, also where the observer stops them.
    void run();
    void go_on(Result so_far, Checkpoint kept);

    Outcome outcome() const;
    const std::string& message() const { return message_; } // why it fails; empty: it stands
    bool is_stopped() const { return is_stopped_; }         // by the observer
    const Scene& scene() const { return scene_; }
    double factor() const { return factor_; }
    const Analysis& analysis() const { return analysis_; }

private:
    void attempt(const std::function<void()>& work);

    double factor_;
    Scene scene_;
    EquivalentJoints joints_;
    Analysis analysis_;
    std::string message_;
    bool is_stopped_ = false;
};

struct Bracket {
    std::optional<double> stands;    // largest factor of a run that did not fail [-]; none if all failed
    std::optional<double> not_above; // smallest factor of a run that failed; none if none failed
    Safety trials;                   // in the order they were made

    bool fails() const; // the run at not_above, which there must be; otherwise it is undecided
};

// The bracket after these runs.
Bracket bracket_of(Safety trials);

// How a bracket is searched for. First a run with strengths 64 times as large. Then the factor is doubled or halved
// from 1, to 64 or 1/64 at most. Near a known factor it goes up or down from there, by a twentieth and then by steps
// twice as large each. Then the bracket is halved. Undecided runs count as without equilibrium.
struct Search {
    double width;                 // the bracket is no wider than this, over its lower end [-]
    double runs_away;             // displacement that counts as failure, over that of the first run [-]
    std::optional<double> near{}; // the known factor [-]

    // The factor of the run after these; none: the search has ended.
    std::optional<double> next_factor(const Safety& so_far) const;
    // Runs after these, at most; none as long as the bracket has no upper end.
    std::optional<int> runs_left(Safety so_far) const;
    // A run after these fails if its displacement is more than that [m].
    double most_displacement(const Safety& so_far) const;
};

// The runs of a search.
class Runs
{
public:
    virtual ~Runs() = default;
    // A run, which fails if its displacement is more than that [m]. Where several are made at once, each has a thread of
    // its own. Once it is asked to stop, its outcome is of no use: it may throw anything.
    virtual Outcome run(double factor, double most_displacement, const std::stop_token& stop) = 0;
    // The search will use the outcome of this run, which comes after those of `before`. The run may be waiting, running or
    // finished.
    virtual void is_next(double /*factor*/, const Safety& /*before*/) {}
    // The last of these runs has ended.
    virtual void has_ended(const Safety& /*so_far*/) {}
    // The outcome of that run will not be used.
    virtual void is_dropped(double /*factor*/) {}
};

// Makes the runs of a search, after those made before. Beside the next run it makes those that may come after it, up to
// `at_once` in all. Which runs count, and their order, do not depend on that.
Bracket bracket_by(const Search& search, Runs& runs, int at_once = 1, Safety made_before = {});

} // namespace jointcreep::analysis
