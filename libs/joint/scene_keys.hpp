// Scene keys of strength averaging, and of joint materials, which follow from the list of joint laws
// (joint/law.hpp), and their checks that need no other part of the scene. Units and ranges are declared with each
// key.

#pragma once

#include "keys/part.hpp"
#include "model/scene.hpp"

namespace jointcreep::joint
{

keys::ForceKeys<Scene> scene_keys();

} // namespace jointcreep::joint
