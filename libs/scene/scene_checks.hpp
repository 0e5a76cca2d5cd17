// What a scene must hold beyond the range of each key: names, references, polygons, order in time, and keys
// that ask for others. What concerns one kind of force alone is checked by its own keys (scene/forces.hpp).

#pragma once

#include "keys/source.hpp"
#include "model/network.hpp"
#include "model/scene.hpp"

namespace jointcreep::scene
{

// Throws input_error naming the line, key, value and what was wanted of each fault. `refusals` are those of the source.
void check_scene(const Scene& scene, const keys::Source& source, keys::Refusals& refusals);

// That the scene is the one that a network was made from: its names, boundaries and area. Throws input_error naming the
// line and what was wanted.
void check_network(const Scene& scene, const keys::Source& source, const Network& network);

} // namespace jointcreep::scene
