// Rows in files of joints: equivalent properties, contacts in the mesh and in states, and the state of contacts and of
// pairs of faces. Paths, units and ranges are declared with each row.

#pragma once

#include "fields/force.hpp"

namespace jointcreep::joint
{

fields::ForceFields fields_in_files();

} // namespace jointcreep::joint
