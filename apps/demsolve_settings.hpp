// The options of demsolve, and what they change in the scene.

#pragma once

#include "program.hpp"

#include "analysis/section.hpp"
#include "model/scene.hpp"

#include <optional>
#include <string>
#include <vector>

namespace jointcreep::demsolve
{

// All options, in the order of the help.
std::vector<Option> options();

// A word of an engine: "auto".
std::string name_of(EngineChoice engine);

// The longest side of zones [m]; that of zones at faces changes in proportion.
void set_zone_size(Scene& scene, double size);

// Puts the command line's settings in place of the scene's. Returns these options, and those of recording, as the
// result file records them.
std::string replace_settings(const Arguments& arguments, Scene& scene);

// Lets the scene end on the day of --until, if given; returns that option as the result file records it.
std::string end_scene(const Arguments& arguments, Scene& scene);

// How a factor of safety is searched for.
struct SafetySearch {
    double width;     // of the bracket, over the factor [-]
    double runs_away; // displacement that counts as failure, over that with strengths 64 times as large [-]
    bool estimates_mesh; // what the mesh adds to the factor, by zones twice as large
    int at_once = 1;     // runs side by side
};

// Strength reduction factor.
struct StrengthReduction {
    double factor = 1;                    // [-]
    std::optional<SafetySearch> search{}; // none: one run, with the factor

    // As files record it.
    std::string text() const;
};
StrengthReduction strength_reduction(const Arguments& arguments, const Scene& scene);

// Without what keeps checkpoints.
analysis::Recording recording(const Arguments& arguments);

} // namespace jointcreep::demsolve
