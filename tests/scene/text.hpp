// Scenes as text, and how a broken one is refused.

#pragma once

#include "model/error.hpp"
#include "scene/scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace jointcreep::scene
{

inline std::string every_key_text()
{
    return read_scene_text(SOURCE_FOLDER "tests/pipeline/every_key.toml");
}

// The text with the first `old` replaced; `old` must be there.
inline std::string replaced(std::string text, const std::string& old, const std::string& by)
{
    const auto at = text.find(old);
    EXPECT_NE(at, std::string::npos) << "no such text: " << old;
    return at == std::string::npos ? text : text.replace(at, old.size(), by);
}

// Number of the line that `part` begins in.
inline std::string line_of(const std::string& text, const std::string& part)
{
    const auto at = text.find(part);
    EXPECT_NE(at, std::string::npos) << "no such text: " << part;
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(at, text.size()));
    return "line " + std::to_string(1 + std::count(text.begin(), end, '\n')) + ":";
}

// The message a text is refused with, or "accepted".
inline std::string refusal(const std::string& text)
{
    try {
        parse_scene(text, "scene.toml");
        return "accepted";
    } catch (const input_error& error) {
        return error.what();
    }
}

inline void expect_part(const std::string& message, const std::string& part)
{
    EXPECT_NE(message.find(part), std::string::npos) << "message: " << message << "\nexpected in it: " << part;
}

} // namespace jointcreep::scene
