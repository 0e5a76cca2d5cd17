// What a scene must hold beyond the range of each key: names, references, polygons, order in time, and keys
// that ask for others.

#pragma once

#include "scene/keys.hpp"

namespace jointcreep::scene
{

// `root` is the text the scene was read from: it knows lines, and which keys were given. Throws input_error.
void check_scene(const Scene& scene, const TomlValue& root, const Reading& reading);

} // namespace jointcreep::scene
