// Springs and dashpots of all joints times one factor, in normal and shear direction alike: the unknowns of
// back-analysis.

#pragma once

#include "model/network.hpp"

namespace jointcreep::joint
{

// Joint stiffness K, with E / K and eta / E kept: all elastic and creep constants.
void multiply_stiffness(EquivalentJoints& joints, double factor);

// E of Kelvin units.
void multiply_kelvin_stiffness(EquivalentJoints& joints, double factor);

// eta of Kelvin units and Maxwell dashpots.
void multiply_viscosity(EquivalentJoints& joints, double factor);

} // namespace jointcreep::joint
