// Divides blocks into zones and splits the gridpoints that a joint runs through.

#pragma once

#include "model/network.hpp"
#include "model/result.hpp"
#include "model/scene.hpp"

namespace jointcreep::zoning
{

// Zones, gridpoints and contacts of the section.
//
// All blocks are triangulated together, so the zones on the two sides of any edge match. Then every gridpoint on a
// joint is split into one for each piece of rock around it; blocks on a bonded edge share theirs. Pieces that are
// connected at a gridpoint only by rock that will be excavated get one each, tied until then. A contact joins two
// gridpoints that were one, with half of each piece of the block edge beside them. A boundary edge that rests on a
// joint gets contacts to gridpoints of the fixed ground, which no zone uses and which are fixed.
Mesh zone(const Scene& scene, const Blocks& blocks);

// What decides cost and quality of a mesh.
struct MeshQuality {
    double shortest_side;     // [m]
    double smallest_altitude; // of a zone: proportional to the time step with real masses [m]
    double smallest_angle;    // [rad]
};
MeshQuality quality_of(const Mesh& mesh);

} // namespace jointcreep::zoning
