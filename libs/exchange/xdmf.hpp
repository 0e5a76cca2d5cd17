// All states of a result as one XDMF file, for ParaView: a few lines of XML a state, and the numbers stay in
// result.h5. Pure functions from records to the text of the file. Written for ParaView's "XDMF Reader", that
// of XDMF 2. Its two readers of XDMF 3 do not take hyperslabs, and ParaView 5.11 ends when they are tried; of
// a file named .xdmf2 it does not offer them. SI units and the signs of model/signs.hpp. Columns of forces are those
// that the result file has as datasets (exchange/forces.hpp).
//
// Removed zones and contacts are hidden by the cell array vtkGhostType, VTK's convention: 32 hides a cell, 0
// shows it. A reader that does not know it shows them; zone_present and status tell them apart.
//
// Times are in days. XDMF has one state a time, so one that has the next state's time, being the one just
// before a stage, is given 0.001 day less.

#pragma once

#include "model/result.hpp"

#include <string>

namespace jointcreep::exchange
{

// The zones, at their positions at the start. `result_file` is where readers find result.h5: a path relative
// to the folder of the XDMF file, so that both can move together. A result without states throws input_error, and so
// does a name that XML cannot have.
// Points: displacement [m]. Cells: the columns of forces, zone_present, block, vtkGhostType.
std::string zones_xdmf(const Result& result, const std::string& result_file);

// The contacts as points, at their centres at the start. Points: the columns of forces, length [m]. Cells:
// vtkGhostType. A result without contacts throws input_error too.
std::string contacts_xdmf(const Result& result, const std::string& result_file);

} // namespace jointcreep::exchange
