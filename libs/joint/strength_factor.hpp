// Strength reduction. The factor of safety of rock and joints is found by dividing all strengths by one factor F
// (Zienkiewicz, Humpheson and Lewis 1975), until there is no equilibrium.
//
//     c / F,   tan(phi) / F,   T / F,   tan(psi) / F,   and residual strengths alike
//
// and the shear strength of Barton and Bandis's law at each pressure (as curved envelopes are divided: Hammah, Yacoub,
// Corkum and Curran 2005). The dilation angle is no strength. It is reduced, too, so that psi stays at most phi. Where
// psi and phi are equal, they stay equal.

#pragma once

#include "model/network.hpp"
#include "model/scene.hpp"

namespace jointcreep::joint
{

// The equivalent joints with strengths divided by `factor` [-], above 0; a factor below 1 increases them. Stiffness,
// creep and averages do not change.
EquivalentJoints with_strength_divided(EquivalentJoints joints, double factor);

// The scene with divided strengths of rock that yields, and divided friction of joint materials, which a dynamic
// analysis uses for contacts.
Scene with_strength_divided(Scene scene, double factor);

} // namespace jointcreep::joint
