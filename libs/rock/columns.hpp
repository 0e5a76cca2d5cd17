// Columns in exports of zones of rock: stress and plastic strain.

#pragma once

#include "fields/columns.hpp"

namespace jointcreep::rock
{

fields::ForceColumns columns_in_exports();

} // namespace jointcreep::rock
