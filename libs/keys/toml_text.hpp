// TOML text as a tree of values that know their line. Its source is the only place that sees toml++.

#pragma once

#include "model/error.hpp"

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace jointcreep::keys
{

struct TomlEntry;

struct TomlValue {
    struct Time {
    }; // a time of day, or a date with one: no key wants it
    using Date = std::chrono::year_month_day;
    using List = std::vector<TomlValue>;
    using Table = std::vector<TomlEntry>; // sorted by key

    std::variant<bool, std::int64_t, double, std::string, Date, Time, List, Table> content;
    std::int64_t line = 1;
    // Of a value behind a key or in a list: where it stands in the text, the byte past it excluded.
    std::size_t first = 0, past = 0;

    // The value of a key, or null if this is no table or has no such key.
    const TomlValue* find(std::string_view key) const;
};

struct TomlEntry {
    std::string key;
    TomlValue value;
};

// The value as messages show it: short, on one line.
std::string shown(const TomlValue& value);
using jointcreep::shown; // of numbers

// Throws input_error naming the line on anything that is not TOML. On a text that makes toml++ stop itself, ends the
// process with exit code 2.
TomlValue parse_toml(std::string_view text, const std::string& name);

} // namespace jointcreep::keys
