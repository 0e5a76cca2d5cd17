// What a scene may write in short: names of [variables] and sums of them in place of numbers, circles and arcs in place of
// corners. Everything downstream reads numbers and corners.

#pragma once

#include <string>

namespace jointcreep::scene
{

// The text with numbers and corners in place of what is written in short; all else as it was, and each key in its line.
// `name` is what messages call the text. Throws input_error naming the line, key and what was wanted. What is no scene is
// returned as far as it can be read: parse_scene refuses it.
std::string written_out(const std::string& text, const std::string& name);

} // namespace jointcreep::scene
