// Layers and histories as tables for spreadsheets and scripts: comma-separated, one line of
// headings with units, names in quotes where they need it (RFC 4180) or begin as a formula does, every number
// so that it reads back as the same double. Indices are those of the records; a field without a value (an edge
// without a joint) is empty.

#pragma once

#include "exchange/layers.hpp"
#include "model/network.hpp"
#include "model/result.hpp"

#include <string>

namespace jointcreep::exchange
{

// Text as one field of such a table. Quotes do not change what is read. Spreadsheets can be told to take fields in
// quotes as text; without quotes, one that begins with = + - @ or a tab may be taken for a formula.
std::string csv_field(const std::string& text);

// One row a row of the layers, which have the same attributes: attributes, and coordinates after the leading ones.
// Lines have x1_m, y1_m, x2_m, y2_m, polygons their centroid x_m, y_m, in space east_m, north_m, up_m.
std::string layers_csv(std::span<const Layer> layers);

// One row a recorded time: time_day, event, and for each point A: A_x_m, A_y_m (displacement since the
// in-situ equilibrium), A_present (0 once removed).
std::string histories_csv(const History& history);

// Why a run ended early: one row a block that moves, the fastest first: block, x_m, y_m (its middle), area_m2,
// displacement_x_m, displacement_y_m in the last `steps` steps of the solver, steps, moves_on (1 it slides or falls, 0
// undecided), stage, time_day, reason. Without such blocks one row, which lacks the first columns.
std::string failure_csv(const Failure& failure, const Blocks& blocks);

} // namespace jointcreep::exchange
