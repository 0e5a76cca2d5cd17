// Displacements that were measured, from CSV (scene/csv.hpp): what a model is fitted to. Columns name their
// unit, _m, _cm or _mm. Errors are input_error that name line, column and value; the caller says which file.

#pragma once

#include "model/scene.hpp"

#include <optional>
#include <string_view>

namespace jointcreep::scene
{

struct Measurement {
    std::size_t point;               // into Scene::points
    int component;                   // 0 x, 1 y
    double time;                     // since start [s]
    bool is_before_stage = false;    // of the two at a stage's time, the first
    double displacement;             // [m]
    std::optional<double> deviation; // standard deviation of its error [m]
    std::size_t line;                // in the file
};

// One row a reading: time_day, point, component (x or y), displacement_mm and, if wanted, sigma_mm and event.
// Or one row a time, as jointexport writes histories: time_day, event, then A_x_m, A_y_m, and if wanted
// A_x_sigma_m, A_y_sigma_m and A_present (0: no reading) for any of the points; an empty field is no
// reading. A point has one reading of a component at a time and event. Either all readings have a deviation
// or none. With a column event, a reading at a stage's time without an event is of the moment before it;
// without the column it is of the moment after.
std::vector<Measurement> measurements_in_csv(std::string_view text, const Scene& scene);

// One curve: columns time_day, displacement_mm and, if wanted, sigma_mm; the reading's point means nothing.
// Times rise.
std::vector<Measurement> creep_curve_in_csv(std::string_view text);

} // namespace jointcreep::scene
