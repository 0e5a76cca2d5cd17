// What creeps along one direction of an equivalent joint.

#pragma once

#include "model/chain.hpp"
#include "model/network.hpp"

namespace jointcreep::joint
{

// The chain of an edge; direction 0 normal, 1 shear. A Maxwell dashpot comes last.
Chain chain_of(const EquivalentJoints& joints, std::size_t edge, int direction);

} // namespace jointcreep::joint
