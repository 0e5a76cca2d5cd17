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
#include <string>

namespace jointcreep::analysis
{

// How a run ends: every equilibrium found; rock seen to slide or fall; or undecided within the limits of the search.
enum class Ending { stands, falls, undecided };

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

    // The same as in Analysis, once. Without an equilibrium they end with a message.
    void run();
    void go_on(Result so_far, Checkpoint kept);

    Outcome outcome() const;
    const std::string& message() const { return message_; } // why it fails; empty: it stands
    const Scene& scene() const { return scene_; }
    double factor() const { return factor_; }
    const Analysis& analysis() const { return analysis_; }

private:
    double factor_;
    Scene scene_;
    EquivalentJoints joints_;
    Analysis analysis_;
    std::string message_;
};

struct Bracket {
    std::optional<double> stands;    // largest factor of a run that did not fail [-]; none if all failed
    std::optional<double> not_above; // smallest factor of a run that failed; none if none failed
    Safety trials;                   // in the order they were made
};

// A run with a factor, which fails if its displacement is more than that [m]; after these.
using RunWith = std::function<Outcome(double factor, double most_displacement, const Safety& so_far)>;

// Run i of those.
Outcome outcome_of(const Safety& trials, std::size_t i);

// First a run with strengths 64 times as large; the displacement of others may be `runs_away` times as large as its
// own. Then doubles or halves the factor from 1, to 64 or 1/64 at most. Then halves the bracket until it is no wider
// than `width` times its lower end. Undecided runs count as without equilibrium.
Bracket bracket_of(const RunWith& run_with, double width, double runs_away);

// The same near a known factor: after the first run it goes up or down from there, by a twentieth and then by steps twice
// as large each, until it has a bracket.
Bracket bracket_near(double known, const RunWith& run_with, double width, double runs_away);

} // namespace jointcreep::analysis
