// Whether every piece of rock rests, not only the section as a whole: beside large forces elsewhere the
// weight of a small block is nothing, and it would fall unseen.

#pragma once

#include "mechanics/assembly.hpp"

namespace jointcreep::mechanics
{

// What an equilibrium may be short of, for a tolerance of the unbalanced force ratio: of displacements, and
// of a piece's own loads [-].
double enough(double tolerance);

struct RemainingDisplacement {
    double displacement = 0; // [m]
    Index gridpoint = 0;     // of the piece that has it
};

// How far rock would still move that its contacts do not support. A piece is rock that holds together; the
// unbalanced force and moment on it count where they are more than `share` of the piece's own
// weight and tractions and more than `rounding` [N/m]; rock without any of these is driven by nothing of its
// own. The displacement is that of rigid pieces on contacts as they are now, where those that are open or
// slip have a billionth of their springs: micrometres where springs take it up, and out of all bounds where
// rock falls. 0 if nothing counts. Contact forces and those on gridpoints are the present ones.
RemainingDisplacement largest_remaining_displacement(const Assembly& assembly, double share, double rounding);

} // namespace jointcreep::mechanics
