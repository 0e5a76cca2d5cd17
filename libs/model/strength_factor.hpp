// Strength reduction. The factor of safety of rock and joints is found by dividing all strengths by one factor F
// (Zienkiewicz, Humpheson and Lewis 1975), until there is no equilibrium.
//
//     c / F,   tan(phi) / F,   T / F,   tan(psi) / F,   and residual strengths alike
//
// and the shear strength of Barton and Bandis's law at each pressure (as curved envelopes are divided: Hammah, Yacoub,
// Corkum and Curran 2005). The dilation angle is no strength. It is reduced, too, so that psi stays at most phi. Where
// psi and phi are equal, they stay equal.
//
// Each kind of force divides its own strengths: rock/strength_factor.hpp, joint/strength_factor.hpp.

#pragma once

#include <cmath>

namespace jointcreep
{

// Divides the tangent of an angle [rad] by a factor [-].
inline void divide_tangent(double& angle, double factor)
{
    angle = std::atan(std::tan(angle) / factor);
}

} // namespace jointcreep
