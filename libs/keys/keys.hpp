// How keys of a text are declared and read. One call declares a key with its unit, range, need, documentation
// and the member it fills; reading, the check for unknown keys, the page of keys and the key list follow from
// it.
//
//     number("poissons_ratio", &Rock::poissons_ratio, no_unit, from(0).below(0.5), "Poisson's ratio.")
//     number("azimuth_deg", &Scene::azimuth, degrees, from(0).to(360), "Bearing of +x.").optional()

#pragma once

#include "keys/bounds.hpp"
#include "keys/refusals.hpp"
#include "keys/toml_text.hpp"
#include "model/polygon.hpp"
#include "model/quantity.hpp"
#include "model/units.hpp"

#include <algorithm>
#include <concepts>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <type_traits>
#include <utility>

namespace jointcreep::keys
{

// "[0", "0.5)" and both with the unit, "[0, 0.5) MPa".
std::string lower_bound(const Range& range);
std::string upper_bound(const Range& range);
std::string shown(const Range& range, const KeyUnit& unit);

enum class Need { required, optional, together }; // together: all keys of one group of a table, or none

// What is known of a key without knowing the record it fills.
struct KeyInfo {
    std::string name;
    std::string kind{}; // number, integer, text, names, date, point, polyline, polygon, polygons, the allowed
                        // words, or a kind of its own
    KeyUnit unit{};
    std::optional<Range> range{};
    std::string doc{};
    Need need = Need::required;
    std::string otherwise{};               // the default as text
    std::string group{};                   // of keys that come together
    std::string in_place_of{};             // a group of keys that do not go with it
    std::string asked_for{};               // of a kind of its own: what messages ask for
    std::string formerly{};                // its name in earlier versions: refused, with the new name
    std::string former_word{}, word_now{}; // of a choice: a word of earlier versions, likewise

    std::string wanted() const; // "a number in [0, 0.5)"
};

// Start of time: a date, or a number of days on the axis that all dates then share.
struct Calendar {
    std::optional<std::chrono::sys_days> start_date;
    double start = 0; // [s], without start_date
};

// What reading carries along.
struct Reading {
    std::string name;  // of the text
    std::string whole; // what messages call all that it describes: "scene"
    Calendar calendar{};
    std::map<std::string, std::string> files{}; // texts that it holds, by name
    Refusals* refusals =
        nullptr; // where all faults are to be told; without it the first one ends the reading
};

// A step of reading or checking, after which the next one may be tried.
template <class Step>
void attempt(const Reading& reading, Step step)
{
    if (reading.refusals)
        reading.refusals->attempt(step);
    else
        step();
}

// Steps that make one thing: it must not be used if one of them was refused.
template <class Steps>
void attempt_all(const Reading& reading, Steps steps)
{
    const auto count = [&] { return reading.refusals ? reading.refusals->count() : 0; };
    const std::size_t before = count();
    steps();
    if (count() > before)
        throw already_refused{};
}

// Where a value stands: for messages.
struct Place {
    const Reading& reading;
    std::string table; // as the user writes it: "[section]", "[[rock]]", "[[joint_set]] spacing"

    [[noreturn]] void refuse(std::int64_t line, const std::string& what) const;
    // "[[rock]] poissons_ratio = 0.7: expected a number in [0, 0.5)", with more words behind the key's own.
    [[noreturn]] void refuse(const KeyInfo& key, const TomlValue& value, const std::string& more = "") const;
};

// Reading one value of a kind, in SI units. They throw input_error through Place::refuse.
double read_number(const KeyInfo& key, const TomlValue& value, const Place& place);
std::int64_t read_integer(const KeyInfo& key, const TomlValue& value, const Place& place);
std::string read_text(const KeyInfo& key, const TomlValue& value, const Place& place);
std::vector<std::string> read_names(const KeyInfo& key, const TomlValue& value, const Place& place);
double read_date(const KeyInfo& key, const TomlValue& value, const Place& place); // since start [s]
Calendar read_start(const KeyInfo& key, const TomlValue& value, const Place& place);
Eigen::Vector2d read_point(const KeyInfo& key, const TomlValue& value, const Place& place);
// A line from left to right: x increases.
std::vector<Eigen::Vector2d> read_polyline(const KeyInfo& key, const TomlValue& value, const Place& place);
Polygon read_polygon(const KeyInfo& key, const TomlValue& value, const Place& place);
std::vector<Polygon> read_polygons(const KeyInfo& key, const TomlValue& value, const Place& place);

template <class Record>
struct Key {
    KeyInfo info;
    std::function<void(Record&, const KeyInfo&, const TomlValue&, const Place&)> read;
    std::optional<TomlValue> fallback; // read in place of a missing value

    Key optional(std::string otherwise = "") &&
    {
        info.need = Need::optional;
        info.otherwise = std::move(otherwise);
        return std::move(*this);
    }
    Key together(std::string group) &&
    {
        info.need = Need::together;
        info.group = std::move(group);
        return std::move(*this);
    }
    Key in_place_of(std::string group) &&
    {
        info.in_place_of = std::move(group);
        return std::move(*this);
    }
    Key asks_for(std::string what) &&
    {
        info.asked_for = std::move(what);
        return std::move(*this);
    }
    Key formerly(std::string name) &&
    {
        info.formerly = std::move(name);
        return std::move(*this);
    }
    Key former_word(std::string before, std::string now) &&
    {
        info.former_word = std::move(before);
        info.word_now = std::move(now);
        return std::move(*this);
    }
    template <class Default>
    Key or_else(Default value) &&
    {
        fallback = TomlValue{.content = value};
        return std::move(*this).optional(shown(*fallback));
    }
};

// A table that fills one Record: once in a text, in a list of any length, or inside another table.
enum class Written { once, in_list, inside };

struct TableInfo {
    std::string name; // "section", "rock"; inside another table "joint_set.spacing"
    Written written = Written::once;
    Need need = Need::required;
    std::string doc{};
    Written outer = Written::in_list; // of a table inside another: how that one is written
    std::string formerly{};           // its name in earlier versions

    std::string shown() const; // "[section]", "[[rock]]", "[[joint_set]] spacing"
};

template <class Record>
struct Table {
    TableInfo info;
    std::vector<Key<Record>> keys;
};

// A member of an optional member of a record; reading it makes the optional one.
template <auto Optional, auto Member>
constexpr auto in_optional = [](auto& record) -> double& {
    auto& all = record.*Optional;
    if (!all)
        all.emplace();
    return (*all).*Member;
};

// --- Declaring keys ---------------------------------------------------------------------------------------

// `member` is a pointer to the member of Record that the key fills, an optional one included, or a function
// Record& -> reference to what it fills; then Record is named: number<Rock>(...).

template <class Record, class Member, class Read>
Key<Record> key_of(KeyInfo info, Member member, Read read)
{
    return {std::move(info),
            [member, read](Record& record, const KeyInfo& key, const TomlValue& value, const Place& place) {
                auto& slot = std::invoke(member, record);
                slot = static_cast<std::remove_reference_t<decltype(slot)>>(read(key, value, place));
            },
            {}};
}

template <class Member, class Record>
concept MemberOf = std::invocable<Member, Record&>;

template <class Record, MemberOf<Record> Member>
Key<Record> number(std::string name, Member member, KeyUnit unit, Range range, std::string doc)
{
    return key_of<Record>({std::move(name), "number", unit, range, std::move(doc)}, member, read_number);
}
template <class Record, class Value>
Key<Record> number(std::string name, Value Record::*member, KeyUnit unit, Range range, std::string doc)
{
    return number<Record, Value Record::*>(std::move(name), member, unit, range, std::move(doc));
}

template <class Record, class Value>
Key<Record> integer(std::string name, Value Record::*member, Range range, std::string doc)
{
    return key_of<Record>({std::move(name), "integer", {}, range, std::move(doc)}, member, read_integer);
}

template <class Record>
Key<Record> text(std::string name, std::string Record::*member, std::string doc)
{
    return key_of<Record>({std::move(name), "text", {}, {}, std::move(doc)}, member, read_text);
}

template <class Record>
Key<Record> names(std::string name, std::vector<std::string> Record::*member, std::string doc)
{
    return key_of<Record>({std::move(name), "names", {}, {}, std::move(doc)}, member, read_names);
}

template <class Record>
Key<Record> date(std::string name, double Record::*member, std::string doc)
{
    return key_of<Record>({std::move(name), "date", days, within(farthest_day), std::move(doc)}, member,
                          read_date);
}

template <class Record>
Key<Record> point(std::string name, Eigen::Vector2d Record::*member, std::string doc)
{
    return key_of<Record>({std::move(name), "point", metres, within(farthest_metre), std::move(doc)}, member,
                          read_point);
}

// Two numbers, {x, y}.
template <class Record, class Value>
Key<Record> vector(std::string name, Value Record::*member, KeyUnit unit, Range range, std::string doc)
{
    return key_of<Record>({std::move(name), "point", unit, range, std::move(doc)}, member, read_point);
}

template <class Record>
Key<Record> polyline(std::string name, std::vector<Eigen::Vector2d> Record::*member, std::string doc)
{
    return key_of<Record>({std::move(name), "polyline", metres, within(farthest_metre), std::move(doc)},
                          member, read_polyline);
}

template <class Record, class Value>
Key<Record> polygon(std::string name, Value Record::*member, std::string doc)
{
    return key_of<Record>({std::move(name), "polygon", metres, within(farthest_metre), std::move(doc)},
                          member, read_polygon);
}

template <class Record>
Key<Record> polygons(std::string name, std::vector<Polygon> Record::*member, std::string doc)
{
    return key_of<Record>({std::move(name), "polygons", metres, within(farthest_metre), std::move(doc)},
                          member, read_polygons);
}

// One of some words, each standing for a value, which assign(record, value) stores.
template <class Record, class Value, std::invocable<Record&, Value> Assign>
Key<Record> choice(std::string name, Assign assign, Words<Value> words, std::string doc)
{
    std::string kind;
    for (const auto& [word, meaning] : words)
        kind += (kind.empty() ? "\"" : " | \"") + std::string(word) + '"';
    return {{std::move(name), kind, {}, {}, std::move(doc)},
            [assign, words](Record& record, const KeyInfo& key, const TomlValue& value, const Place& place) {
                const auto* const given = std::get_if<std::string>(&value.content);
                const auto found = std::find_if(words.begin(), words.end(), [&](const auto& word) {
                    return given && word.first == *given;
                });
                if (found == words.end() && given && !given->empty() && *given == key.former_word)
                    place.refuse(key, value, '"' + *given + "\" is now called \"" + key.word_now + '"');
                if (found == words.end())
                    place.refuse(key, value);
                assign(record, found->second);
            },
            {}};
}
template <class Record, class Value>
Key<Record> choice(std::string name, Value Record::*member, Words<Value> words, std::string doc)
{
    const auto assign = [member](Record& record, Value value) { record.*member = value; };
    return choice<Record, Value>(std::move(name), assign, std::move(words), std::move(doc));
}

// --- Reading a table --------------------------------------------------------------------------------------

// Refuses what is no table, and keys that are not among `known`.
void check_keys(const TomlValue& value, const std::vector<const KeyInfo*>& known, const Place& place);
// Refuses a required key that is missing, one missing of those that come together, and a key beside those that it stands
// in place of. `value` is a table. A key that is only misspelt is check_keys' matter.
void check_present(const TomlValue& value, const std::vector<const KeyInfo*>& known, const Place& place);

template <class Record>
std::vector<const KeyInfo*> key_infos(const Table<Record>& table)
{
    std::vector<const KeyInfo*> infos;
    for (const Key<Record>& key : table.keys)
        infos.push_back(&key.info);
    return infos;
}

// Fills the record from what is given, and from defaults.
template <class Record>
void fill(const Table<Record>& table, const TomlValue& value, const Place& place, Record& record)
{
    for (const Key<Record>& key : table.keys)
        attempt(place.reading, [&] {
            if (const TomlValue* const given = value.find(key.info.name))
                key.read(record, key.info, *given, place);
            else if (key.fallback)
                key.read(record, key.info, *key.fallback, place);
        });
}

template <class Record>
void read_table(const Table<Record>& table, const TomlValue& value, const Place& place, Record& record)
{
    const auto infos = key_infos(table);
    attempt_all(place.reading, [&] {
        check_keys(value, infos, place);
        check_present(value, infos, place);
        fill(table, value, place, record);
    });
}

// The tables of a list, one a record; none if an optional list is missing.
const TomlValue::List& list_of(const TableInfo& info, const TomlValue& root, const Reading& reading);

template <class Record>
std::vector<Record> read_list(const Table<Record>& table, const TomlValue& root, const Reading& reading)
{
    std::vector<Record> records;
    attempt_all(reading, [&] {
        for (const TomlValue& one : list_of(table.info, root, reading)) {
            const TomlValue* const name = one.find("name");
            const Place place{reading, table.info.shown() + (name ? " " + shown(*name) : "")};
            attempt(reading, [&] { read_table(table, one, place, records.emplace_back()); });
        }
    });
    return records;
}

// Fills `record`, with defaults alone if an optional table is missing. Returns whether it is there.
template <class Record>
bool read_once(const Table<Record>& table, const TomlValue& root, const Reading& reading, Record& record)
{
    const Place place{reading, table.info.shown()};
    const TomlValue* const value = root.find(table.info.name);
    if (value)
        read_table(table, *value, place, record);
    else if (table.info.need == Need::required)
        place.refuse(1, "the " + reading.whole + " has no " + table.info.shown());
    else
        fill(table, TomlValue{.content = TomlValue::Table{}}, place, record);
    return value != nullptr;
}

// A list of inline tables, at least `least` and at most `most` of them.
template <class Row>
std::vector<Row> read_rows(const Table<Row>& table, std::size_t least, std::size_t most, const KeyInfo& key,
                           const TomlValue& value, const Place& outer)
{
    const auto* const list = std::get_if<TomlValue::List>(&value.content);
    if (!list || list->size() < least || list->size() > most)
        outer.refuse(key, value,
                     (least > 1 ? std::to_string(least) + " of them at least, and " : "") + "at most " +
                         std::to_string(most));
    const Place place{outer.reading, table.info.shown()};
    std::vector<Row> rows(list->size());
    attempt_all(outer.reading, [&] {
        for (std::size_t i = 0; i < list->size(); ++i)
            attempt(outer.reading, [&] { read_table(table, (*list)[i], place, rows[i]); });
    });
    return rows;
}

// The name among `known` that is most like `name`, or "" if none is near; for "did you mean".
std::string nearest(const std::string& name, const std::vector<std::string>& known);

} // namespace jointcreep::keys
