// Strength reduction: how far rock and joints are from failing is asked by dividing all strengths by one
// factor F (Zienkiewicz, Humpheson and Lewis 1975), until the rock finds no equilibrium.
//
//     c / F,   tan(phi) / F,   T / F,   tan(psi) / F,   and residual strengths alike
//
// and the shear strength that Barton and Bandis's law gives at each pressure (as curved
// envelopes are divided: Hammah, Yacoub, Corkum and Curran 2005). The dilation angle is no strength. It goes
// along so that psi stays at most phi, and where the two were equal they stay so.

#pragma once

#include "model/network.hpp"
#include "model/scene.hpp"

namespace jointcreep::joint
{

// The equivalent joints with strengths divided by `factor` [-], which is positive; below 1 they grow.
// Stiffness, creep and what was averaged stay.
EquivalentJoints with_strength_divided(EquivalentJoints joints, double factor);

// The scene with the strength of rock divided, for rock that yields, and the friction of joint materials,
// which contacts have that form in a dynamic analysis.
Scene with_strength_divided(Scene scene, double factor);

} // namespace jointcreep::joint
