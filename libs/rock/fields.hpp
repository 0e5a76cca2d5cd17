// Rows in files of zones of rock: corners, stress, plastic strain, creep. Paths, units and ranges are declared
// with each row.

#pragma once

#include "fields/force.hpp"

namespace jointcreep::rock
{

fields::ForceFields fields_in_files();

} // namespace jointcreep::rock
