// Columns in exports: of edges, their equivalent joint properties; of contacts, traction, relative displacement
// and status.

#pragma once

#include "fields/columns.hpp"

namespace jointcreep::joint
{

fields::ForceColumns columns_in_exports();

} // namespace jointcreep::joint
