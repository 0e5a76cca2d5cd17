// Whether every piece of rock is in equilibrium, not only the section as a whole. Beside large forces elsewhere the
// weight of a small block does not count in the unbalanced force ratio, and it would fall unseen.

#pragma once

#include "mechanics/assembly.hpp"

namespace jointcreep::mechanics
{

// From the tolerance of the unbalanced force ratio: the largest remaining displacement over the displacement, and the
// largest unbalanced force of a piece over its own loads, at equilibrium [-].
double enough(double tolerance);

struct RemainingDisplacement {
    double displacement = 0; // [m]
    Index gridpoint = 0;     // of the piece that has it
};

// Largest displacement that contacts do not yet balance, by estimate. A piece is connected rock. Its unbalanced
// force and moment count where they are more than `share` of the piece's own weight and tractions, and more than
// `rounding` [N/m]. A piece without weight and tractions does not count.
//
// The displacement is that of rigid pieces on the present contacts; open and slipping contacts have a billionth of
// their springs. It is micrometres where springs carry the piece, and out of all bounds where it falls. 0 if no
// piece counts. Contact forces and forces on gridpoints are the present ones.
RemainingDisplacement largest_remaining_displacement(const Assembly& assembly, double share, double rounding);

} // namespace jointcreep::mechanics
