// What creeps along one direction of an equivalent joint.

#pragma once

#include "model/chain.hpp"
#include "model/network.hpp"
#include "model/scene.hpp"

namespace jointcreep::joint
{

// The chain of an edge; direction 0 normal, 1 shear. A Maxwell dashpot comes last.
Chain chain_of(const EquivalentJoints& joints, std::size_t edge, int direction);

// That of a joint without rock bridges; `number` is that of its material.
Chain chain_of(const JointMaterial& material, Index number, int direction);

} // namespace jointcreep::joint
