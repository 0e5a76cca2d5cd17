// Rows in files of boundary conditions: the edges, gridpoints and sides of zones they act on. Paths, units and ranges
// are declared with each row.

#pragma once

#include "fields/force.hpp"

namespace jointcreep::boundary
{

fields::ForceFields fields_in_files();

} // namespace jointcreep::boundary
