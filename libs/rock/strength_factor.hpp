// Strength reduction of rock that yields (model/strength_factor.hpp).

#pragma once

#include "model/scene.hpp"

#include <vector>

namespace jointcreep::rock
{

// The rocks with strengths and the tangent of the dilation angle divided by `factor` [-], above 0.
std::vector<Rock> with_strength_divided(std::vector<Rock> rocks, double factor);

} // namespace jointcreep::rock
