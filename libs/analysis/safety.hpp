// Factor of safety by strength reduction: the largest factor F that strengths can be divided by with every equilibrium
// found (libs/joint/strength_factor.hpp). The result is a bracket of F, by whole runs.

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

// An analysis with strengths divided by a factor [-].
class Trial
{
public:
    Trial(const Scene& scene, const Network& network, const EquivalentJoints& joints, double factor,
          int threads, const Recording& recording, const Observer& observe);

    // The same as in Analysis, once. Without an equilibrium they end with a message.
    void run();
    void go_on(Result so_far, Checkpoint kept);

    Ending ending() const;
    const std::string& message() const { return message_; } // why there is no equilibrium; empty: there is
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
    std::optional<double> stands;    // largest factor with every equilibrium [-]; none if no run has
    std::optional<double> not_above; // smallest factor without; none if all runs have
    Safety trials;                   // in the order they were made
};

// Doubles or halves the factor from 1, to 64 or 1/64 at most. Then halves the bracket until it is no wider than
// `width` times its lower end. Undecided runs count as without equilibrium.
Bracket bracket_of(const std::function<Ending(double factor)>& trial, double width);

} // namespace jointcreep::analysis
