// The text that a record was read from, for checks beyond the range of each key: it knows the lines of tables
// and keys, and which keys were given.

#pragma once

#include "keys/keys.hpp"
#include "model/polygon.hpp"

#include <set>
#include <string>
#include <vector>

namespace jointcreep::keys
{

// The table that a record was read from.
struct Given {
    const Reading& reading;
    const TomlValue& table;
    std::string title; // "[[rock]] "granite""

    const TomlValue* find(std::string_view key) const { return table.find(key); }

    // "[[joint]] "F1" material = "gouge": what is wrong", and its line: the key's, or the table's if it is missing.
    std::string told(const std::string& key, const std::string& what) const;
    std::int64_t line_of(const std::string& key) const;
    // Throws input_error with both.
    [[noreturn]] void refuse(const std::string& key, const std::string& what) const;
    // The same where the checks after it do not need this one: where all faults are told, it returns.
    void report(const std::string& key, const std::string& what) const;
};

struct Source {
    const TomlValue& root; // of the whole text
    const Reading& reading;

    Given once(const std::string& table) const;                   // the root where it is not given
    Given in_list(const std::string& table, std::size_t i) const; // it must be there

    // Refuses a name that occurs twice in all of these lists of tables.
    void check_unique(const std::vector<std::string>& tables) const;
};

template <class Record>
std::set<std::string> names_of(const std::vector<Record>& records)
{
    std::set<std::string> names;
    for (const Record& record : records)
        names.insert(record.name);
    return names;
}

// Refuses a key whose name is not among those known; `what` is what these are: "[[rock]]".
void check_reference(const Given& given, const std::string& key, const std::string& name,
                     const std::set<std::string>& known, const std::string& what);

// Refuses a polygon that is not simple.
void check_polygon(const Given& given, const std::string& key, const Polygon& polygon);

} // namespace jointcreep::keys
