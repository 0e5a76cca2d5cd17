// What a factor scales: properties of all joints, in normal and shear direction alike, or the in-situ stress. Back
// analysis looks for such factors, and sensitivities are by their logarithms.

#pragma once

namespace jointcreep
{

enum class Scaled {
    kelvin_stiffness,  // E
    kelvin_viscosity,  // eta, of Kelvin units and Maxwell dashpots
    joint_stiffness,   // K, with E / K and eta / E kept
    horizontal_stress, // in situ: sigma_xx and its gradient
};

} // namespace jointcreep
