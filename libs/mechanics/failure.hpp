// Rock without equilibrium: what an engine found, which blocks move, and rock without support, which is known before
// any step.

#pragma once

#include "mechanics/assembly.hpp"
#include "model/error.hpp"

#include <string>

namespace jointcreep::mechanics
{

// Thrown by an engine that finds no equilibrium.
struct no_equilibrium : equilibrium_error {
    explicit no_equilibrium(const std::string& why) : equilibrium_error("no equilibrium: " + why) {}

    bool moves_on = false;          // seen to slide or fall; false: the search ended undecided
    Index steps = 0;                // the last ones
    double seconds = 0;             // that these stand for; 0 with scaled masses, whose time means nothing
    std::vector<Vector2d> motion{}; // displacement of gridpoints in these steps [m]; or empty
};

// Blocks that moved by more than a tenth of what the fastest one did, the fastest first. The displacement of a
// block is the mean of its zones. Without error.motion there are no blocks.
Failure failure_of(const no_equilibrium& error, const Mesh& mesh, const Assembly& assembly);

// Blocks without support: connected rock with a resultant of weight and tractions above 1e-9 of its forces in x or
// y, and no gridpoint fixed in that direction. Connected by contacts, too. In order of their number; each with its
// place and no displacement.
Failure failure_of_unsupported(const Mesh& mesh, const Assembly& assembly);

// "block 3 at [2.5, 7.1] m by [0.12, -0.2] m; ...", of the first few.
std::string shown_blocks(const Failure& failure);

} // namespace jointcreep::mechanics
