// Taking rock away.

#pragma once

#include "mechanics/assembly.hpp"
#include "mechanics/loading.hpp"

namespace jointcreep::mechanics
{

// Removes the blocks of a stage. Zones leave, contacts with a side on them end, tractions on them too,
// gridpoints without any zone left are held where they are. Returns the forces that what has gone exerted on
// the gridpoints that stay [N/m]: added to the load they keep what is left in balance, and fading them out
// unloads it gradually.
std::vector<Vector2d> excavate(Assembly& assembly, const Blocks& blocks, const Mesh& mesh,
                               const Loading& loading, Index stage);

} // namespace jointcreep::mechanics
