// Words of earlier versions that a scene may still hold. They are refused by a message that has the new name.

#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace jointcreep::scene
{

struct Renamed {
    std::string_view before, now;
};

inline constexpr std::array<Renamed, 4> renamed_words{{
    {"motion", "large_displacements"}, // a table
    {"course", "load_history"},        // a key
    {"dead_ends", "dangling_ends"},    // a key
    {"explicit", "relaxation"},        // a value of equilibrium.engine
}};

// "" for any other word.
inline std::string_view new_name_of(std::string_view word)
{
    const auto* const found = std::find_if(renamed_words.begin(), renamed_words.end(),
                                           [&](const Renamed& one) { return one.before == word; });
    return found == renamed_words.end() ? std::string_view() : found->now;
}

} // namespace jointcreep::scene
