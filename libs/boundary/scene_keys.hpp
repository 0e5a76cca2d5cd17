// Scene keys of boundary conditions, and their checks that need no other part of the scene.
// Units and ranges are declared with each key.

#pragma once

#include "keys/part.hpp"
#include "model/scene.hpp"

namespace jointcreep::boundary
{

keys::ForceKeys<Scene> scene_keys();

} // namespace jointcreep::boundary
