// Springs and dashpots of joints times a factor: the unknowns of back-analysis.

#pragma once

#include "model/network.hpp"
#include "model/scaled.hpp"

namespace jointcreep::joint
{

// What `scaled` names; nothing by the in-situ stress.
void multiply(EquivalentJoints& joints, const Scaled& scaled, double factor);

} // namespace jointcreep::joint
