// Scene keys of rock, of the regions it fills, and of the stress in it before excavation, and what is
// checked of them alone. Units and ranges are declared with each key.

#pragma once

#include "keys/part.hpp"
#include "model/scene.hpp"

namespace jointcreep::rock
{

keys::ForceKeys<Scene> scene_keys();

} // namespace jointcreep::rock
