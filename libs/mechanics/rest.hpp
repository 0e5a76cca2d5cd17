// Whether every piece of rock rests, not only the section as a whole: beside large forces elsewhere the
// weight of a small block is nothing, and it would fall unseen.

#pragma once

#include "mechanics/assembly.hpp"

namespace jointcreep::mechanics
{

// What an equilibrium may be short of, for a tolerance of the out-of-balance ratio: of displacements, and of
// a piece's own loads [-].
double enough(double tolerance);

struct ToGo {
    double way = 0;      // [m]
    Index gridpoint = 0; // of the piece that has it
};

// How far rock would still go that its contacts do not bear. A piece is rock that hangs together; what is out
// of balance on it, as a force or about its middle, counts where it is more than `share` of the piece's own
// weight and tractions and more than `rounding` [N/m]; rock without any of these is driven by nothing of its
// own. The way is that of rigid pieces on contacts as they are now, where those that are open or slip have a
// billionth of their springs: micrometres where springs take it up, and out of all bounds where rock falls. 0
// if nothing counts. Contact forces and those on gridpoints are the present ones.
ToGo farthest_to_go(const Assembly& assembly, double share, double rounding);

} // namespace jointcreep::mechanics
