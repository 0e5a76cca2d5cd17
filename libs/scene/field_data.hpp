// What was measured in the field, from the files that a scene names: poles, and mapped traces.
//
// CSV: a line of column names, then rows; fields are separated by commas, and may stand in double quotes; empty
// lines and those that begin with # are left out. GeoJSON (RFC 7946): LineString and MultiLineString, with
// coordinates in metres of the section. Other files of traces come as text of layers (scene/trace_file.hpp). Errors are
// input_error that name the layer and line or feature; the caller says which file.

#pragma once

#include "model/scene.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace jointcreep::scene
{

// Columns dip_deg, dip_direction_deg and, if wanted, weight.
std::vector<MeasuredPole> poles_in_csv(std::string_view text);

// Which traces of a file to take: those whose property, in CSV a column, has a value, or any value if none is given.
// Without property all. Of a file whose lines are in several layers, those of one.
struct TraceFilter {
    std::string property{};
    std::optional<std::string> value{};
    std::string layer{};
};

struct TracesOfFile {
    std::vector<MappedTrace> trace;
    std::vector<std::string> value; // of the property that the filter names, of each trace; empty without one
};

// GeoJSON if the text begins with {; else CSV of single pieces (columns x1_m, y1_m, x2_m, y2_m and, if
// wanted, id) or of the places of polylines (columns id, x_m, y_m, the rows of a trace in order and
// together). A trace has the id that the file gives, a feature's own or that among its properties; where not
// all taken traces have a whole number there, each has its place in the file, or in its layer, from 0.
TracesOfFile traces_of_file(std::string_view text, const TraceFilter& filter);
std::vector<MappedTrace> mapped_traces(std::string_view text, const TraceFilter& filter);

// Multiplies weights by Terzaghi's 1 / |n.v|, v along the scanline; planes nearer to it than `blind_zone`
// [rad] as if they were just that near.
void correct_for_scanline(std::vector<MeasuredPole>& poles, const Scanline& scanline, double blind_zone);

} // namespace jointcreep::scene
