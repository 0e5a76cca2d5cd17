// What creepfit found through the solver: its tables (docs/programs.md), the summary, and messages.

#pragma once

#include "creepfit_factors.hpp"

#include "estimation/across.hpp"
#include "scene/measurements.hpp"

#include "program.hpp"

#include <string>
#include <vector>

namespace jointcreep::creepfit
{

// One row per factor.
std::string found_table(const back_analysis::Found& found, const Factors& factors, bool knows_deviations);

// One row per measurement.
std::string readings_table(const back_analysis::Found& found,
                           const std::vector<scene::Measurement>& measurements, const Scene& scene);

// Why a search did not converge, and what to do.
std::string why_not_converged(const back_analysis::Found& found, const Factors& factors);

// Prints the summary, and what to write into the scene.
void report(const Arguments& arguments, const back_analysis::Found& found,
            const std::vector<scene::Measurement>& measurements, const Scene& scene,
            const back_analysis::Settings& settings);

// Of several networks (estimation/across.hpp).
struct Networks {
    std::vector<back_analysis::Found> found;               // of each
    std::vector<std::string> file;                         // of each
    std::vector<std::optional<estimation::Across>> across; // of each factor
};
Networks networks_of(std::vector<back_analysis::Found> found, const std::vector<std::string>& files,
                     const Factors& factors, bool knows_deviations);
// One row per factor.
std::string networks_table(const Networks& networks, const Factors& factors);
void report_networks(const Arguments& arguments, const Networks& networks, const Factors& factors);

} // namespace jointcreep::creepfit
