// Scene keys of rock, of its regions and of the in-situ stress, and their checks that need no other part of the scene.
// Units and ranges are declared with each key.

#pragma once

#include "keys/part.hpp"
#include "model/scene.hpp"

namespace jointcreep::rock
{

keys::ForceKeys<Scene> scene_keys();

} // namespace jointcreep::rock
