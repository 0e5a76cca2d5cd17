// Every table and key of a scene.

#pragma once

#include "keys/part.hpp"
#include "model/scene.hpp"

namespace jointcreep::scene
{

// The tables in the order they are documented, those of forces (scene/forces.hpp) among them.
const std::vector<keys::Part<Scene>>& scene_parts();

// Whether a scene may name a file so: it is in the scene's folder, or in a folder there.
bool is_beside_scene(const std::string& file);

} // namespace jointcreep::scene
