// Rows in files of joints: their equivalent properties, contacts in the mesh and in states, what contacts and
// pairs of faces remember. Paths, units and ranges are declared
// with each row.

#pragma once

#include "fields/force.hpp"

namespace jointcreep::joint
{

fields::ForceFields fields_in_files();

} // namespace jointcreep::joint
