// The search for a factor of safety: runs with strengths divided by different factors, one by one or several at once.

#pragma once

#include "demsolve_files.hpp"
#include "demsolve_settings.hpp"
#include "demsolve_summary.hpp"
#include "program.hpp"

#include "analysis/safety.hpp"
#include "store/files.hpp"

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

namespace jointcreep::demsolve
{

// A run that is wanted.
struct RunOf {
    const Scene& scene;
    double factor = 1; // strengths are divided by it [-]
    double most_displacement =
        std::numeric_limits<double>::infinity();                  // it fails where rock moves farther [m]
    std::optional<store::CheckpointFile> from{};                  // it continues from there
    std::function<void(const Result&, const Checkpoint&)> keep{}; // gets its checkpoints
    std::function<std::optional<Which>()> which = [] {
        return Which{};
    };                      // before its progress; none: not shown
    std::stop_token stop{}; // then it ends by Dropped
};
struct Dropped {
};

using RunWith = std::function<std::unique_ptr<analysis::Trial>(RunOf)>;

// Writes and returns the run of the largest factor at which every equilibrium is found. Writes the run of the next
// larger factor as failed. Runs that an earlier search has made are not made again, but for these two, from their last
// checkpoint.
std::unique_ptr<analysis::Trial> bracket_safety(const StrengthReduction& reduction, const Scene& scene,
                                                const RunWith& run_with, Files& files,
                                                std::optional<store::CheckpointFile> kept, Summary& summary);

} // namespace jointcreep::demsolve
