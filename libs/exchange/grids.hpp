// Blocks, joints, zones and contacts as unstructured grids of VTK, for ParaView and everything else that reads VTK.
// SI units and the signs of model/signs.hpp.
//
// Codes that stand for a name (rock, stage, joint set) count from 0 in the field data array of names beside them: block
// 3 with rock = 1 is of the second rock of "rock_names". -1 means none. Where there are "columns of forces", each kind
// of force declares its own, with name and unit (exchange/forces.hpp).

#pragma once

#include "exchange/grid.hpp"
#include "exchange/layers.hpp"
#include "model/network.hpp"
#include "model/result.hpp"

#include <cstddef>

namespace jointcreep::exchange
{

// One cell a row of a layer, in its order. Of a polygon holes are joined to the outer ring by a bridge without
// width, there and back between two corners. VTK draws a concave polygon as if it were convex: for a true picture
// apply ParaView's filter Tetrahedralize first, which however leaves out polygons with a hole. Cells: the layer's
// attributes by their names without units; a name is a code, and NAME_names has what it stands for.
Grid layer_grid(const Layer& layer);

// The zones present in a state, one triangle each, at their positions at the start. `state` is a row of
// result.states; one that does not exist throws input_error. Its time [day] is the field data array
// TimeValue. Points: gridpoint, displacement [m]; after a stage that resets displacements, displacement_since_reset
// [m]. Cells: zone, block, rock, stage, where the run failed moving_block (1 in blocks of the failure), then the columns of
// forces.
Grid zones_grid(const Network& network, const Result& result, std::size_t state);

// The contacts present in a state, one point each, at their centres at the start.
// Points: contact, edge, normal (from side a to side b), length [m], displacement (mean of the two sides)
// [m], then the columns of forces.
Grid contacts_grid(const Result& result, std::size_t state);

} // namespace jointcreep::exchange
