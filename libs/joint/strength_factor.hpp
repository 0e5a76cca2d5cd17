// Strength reduction of joints (model/strength_factor.hpp).

#pragma once

#include "model/network.hpp"
#include "model/scene.hpp"

#include <vector>

namespace jointcreep::joint
{

// The equivalent joints with strengths divided by `factor` [-], above 0; a factor below 1 increases them. Stiffness,
// creep and averages do not change.
EquivalentJoints with_strength_divided(EquivalentJoints joints, double factor);

// The same of joint materials. A dynamic analysis makes new contacts of them.
std::vector<JointMaterial> with_strength_divided(std::vector<JointMaterial> materials, double factor);

} // namespace jointcreep::joint
