// Scene keys of what holds, moves or loads the outline, and what is
// checked of them alone. Units and ranges are declared with each key.

#pragma once

#include "keys/part.hpp"
#include "model/scene.hpp"

namespace jointcreep::boundary
{

keys::ForceKeys<Scene> scene_keys();

} // namespace jointcreep::boundary
