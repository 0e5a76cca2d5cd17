// A scene's TOML text -> Scene, in SI units and checked. The keys are declared in scene_keys.cpp
// and by each kind of force (scene/forces.hpp); docs/scene.md and the table below are made from the same
// declarations.

#pragma once

#include "model/network.hpp"
#include "model/scene.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace jointcreep::scene
{

// Reads and checks a whole scene. `name` is what messages call the text: a file, or a file and its dataset.
// Throws input_error naming the line, key, value, unit and what was wanted. On a text that makes toml++ stop
// itself, ends the process with exit code 2.
Scene parse_scene(std::string_view text, const std::string& name);

// The same of the text in /scene of a file of the chain, whose name messages begin with. Refuses a scene that does not
// fit the network of that file, as the text was changed.
Scene parse_scene_of_file(std::string_view text, const std::string& path, const Network& network);

// What the scene may say, and a scene of rock rarely does: numbers that look like those of another unit, a stress that is
// not the weight of the rock, a point that is excavated. Each with its line, the value and what was expected. `scene` was
// parsed from the text.
std::vector<std::string> doubts_about(const Scene& scene, std::string_view text, const std::string& name);

// The text of a scene file without byte order mark, with numbers in place of names and with the corners of circles and arcs
// (scene/shorthand.hpp), and with the files beside it that it names behind it, each as a table [[file]]: so the text says
// everything, wherever it goes, and to every reader.
struct SceneText {
    std::string text;
    std::vector<std::string> files; // paths of those that it names
};

// Throws file_error if it cannot be read, input_error if it is empty, UTF-16 or, with those files, larger than 16 MiB, or
// if what is written in short cannot be read.
SceneText read_scene(const std::string& path);
std::string read_scene_text(const std::string& path);

// The text of a file of poles or traces as a scene holds it, whatever its format.
std::string read_field_data(const std::string& path);

// docs/scene.md, whole.
std::string scene_keys_markdown();

// One row a key, separated by tabs, with a head: table, key, kind, unit, required, minimum, maximum, default.
// Bounds are written with their bracket, "[0" closed and "(0" open; "-" means none; tables inside a table are
// written joint_set.spacing; required is yes, no or together (all keys marked so in one table, or none).
std::string scene_keys_tsv();

// The JSON Schema (draft 7) of a scene. What depends on several keys is not in it.
std::string scene_schema();

} // namespace jointcreep::scene
