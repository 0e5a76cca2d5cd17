// Excavation.

#pragma once

#include "mechanics/assembly.hpp"
#include "mechanics/loading.hpp"

namespace jointcreep::mechanics
{

// Removes the blocks of a stage, with their zones. Contacts and tractions on them end. Gridpoints without any zone
// left are fixed. Returns the forces of the removed rock on the gridpoints that stay [N/m]. Added to the load,
// these forces keep the remaining rock in balance; reducing them to 0 unloads it gradually.
std::vector<Vector2d> excavate(Assembly& assembly, const Blocks& blocks, const Mesh& mesh,
                               const Loading& loading, Index stage);

} // namespace jointcreep::mechanics
