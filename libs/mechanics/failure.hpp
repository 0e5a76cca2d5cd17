// Rock without equilibrium: what an engine has seen of it, which blocks that are, and rock that nothing
// holds, which is known before any step.

#pragma once

#include "mechanics/assembly.hpp"
#include "model/error.hpp"

#include <string>

namespace jointcreep::mechanics
{

// Thrown by an engine that finds no equilibrium.
struct no_equilibrium : equilibrium_error {
    explicit no_equilibrium(const std::string& why) : equilibrium_error("no equilibrium: " + why) {}

    bool moves_on = false;          // seen to slide or fall; if not, the search has ended without an answer
    Index steps = 0;                // the last ones
    double seconds = 0;             // that these stand for; 0 with scaled masses, whose time means nothing
    std::vector<Vector2d> motion{}; // of gridpoints in these steps [m]; empty if there is nothing to say
};

// Blocks that moved by more than a tenth of what the fastest one did, the fastest first; a block moves by the
// mean of its zones. No blocks without motion.
Failure failure_of(const no_equilibrium& error, const Mesh& mesh, const Assembly& assembly);

// Blocks whose weight and tractions push them where neither a boundary nor a contact, be it by way of other
// blocks, could ever hold them: rock that hangs together, has a resultant above 1e-9 of its forces in x or y,
// and no gridpoint held in that direction. In order of their number; each with its place and no motion.
Failure failure_of_unheld(const Mesh& mesh, const Assembly& assembly);

// "block 3 at [2.5, 7.1] m by [0.12, -0.2] m; ...", of the first few.
std::string shown_blocks(const Failure& failure);

} // namespace jointcreep::mechanics
