// Scene keys of what joints are made of, which follow from the list of joint laws (joint/law.hpp), and what is
// checked of them alone. Units and ranges are declared with each key.

#pragma once

#include "keys/part.hpp"
#include "model/scene.hpp"

namespace jointcreep::joint
{

keys::ForceKeys<Scene> scene_keys();

} // namespace jointcreep::joint
