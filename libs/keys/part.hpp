// The tables of a whole text, such as a scene, as one list: what each is called, its keys, how it is read into
// the whole's record, and what is checked of it. A kind of force gives its tables as ForceKeys; the text's
// owner puts all of them in the order in which they are read and documented.
//
//     keys::ForceKeys<Scene> scene_keys()
//     {
//         auto rocks = part_in_list(rock_table(), &Scene::rocks);
//         rocks.has_names = true;
//         rocks.values = check_rocks;
//         return {.materials = {rocks}};
//     }

#pragma once

#include "keys/keys.hpp"
#include "keys/source.hpp"

namespace jointcreep::keys
{

// When a table is read. In one turn the order of the list counts.
enum class Turn {
    files,    // texts that later tables name
    plain,    // without dates
    calendar, // what dates count from
    dated,    // with dates, after the calendar
    settings  // numerical settings
};

template <class Whole>
struct Part {
    TableInfo info;
    std::vector<KeyInfo> keys{};
    Turn turn = Turn::plain;
    // Reads the table, where it is given, into the whole; none: the table that holds it does. Throws
    // input_error naming the line, key, value, unit and what was wanted.
    std::function<void(const TomlValue& root, Reading&, Whole&)> read{};

    // What must hold beyond the range of each key, in this order. They throw input_error.
    using Check = std::function<void(const Whole&, const Source&)>;
    bool has_names = false; // "name" is a key, and each name occurs once in the list
    Check references{};     // names of other tables
    Check shapes{};         // polygons
    Check values{};         // all else; may rely on the shapes of all tables
};

// The tables of one kind of force.
template <class Whole>
struct ForceKeys {
    std::vector<Part<Whole>> materials{}; // what the ground and what is in it are made of
    std::vector<Part<Whole>> loads{};     // what acts on it
    std::vector<Part<Whole>> settings{};  // how it is computed
};

// --- Making a part ----------------------------------------------------------------------------------------

// A part: a table that `read` reads.
template <class Whole, class Record, class Read>
Part<Whole> part_read_by(const Table<Record>& table, Read read)
{
    Part<Whole> one{.info = table.info, .read = std::move(read)};
    for (const Key<Record>& key : table.keys)
        one.keys.push_back(key.info);
    return one;
}

// A table inside another, which reads it. It is documented at its place in the list.
template <class Whole, class Record>
Part<Whole> part_inside(const Table<Record>& table)
{
    return part_read_by<Whole>(table, nullptr);
}

// A list of tables, one per record.
template <class Whole, class Record>
Part<Whole> part_in_list(const Table<Record>& table, std::vector<Record> Whole::*member)
{
    return part_read_by<Whole>(table, [table, member](const TomlValue& root, Reading& reading, Whole& whole) {
        whole.*member = read_list(table, root, reading);
    });
}

// A table that occurs once and fills `member`: a pointer to a member, or a function Whole& -> Record&.
// Without the table the defaults fill it.
template <class Whole, class Record, class Member>
Part<Whole> part_once(const Table<Record>& table, Member member)
{
    return part_read_by<Whole>(table, [table, member](const TomlValue& root, Reading& reading, Whole& whole) {
        read_once(table, root, reading, std::invoke(member, whole));
    });
}

// A table that occurs once, or not at all: then there is no record.
template <class Whole, class Record>
Part<Whole> part_if_given(const Table<Record>& table, std::optional<Record> Whole::*member)
{
    return part_read_by<Whole>(table, [table, member](const TomlValue& root, Reading& reading, Whole& whole) {
        if (Record record; read_once(table, root, reading, record))
            whole.*member = std::move(record);
    });
}

// --- Reading and checking all of them ---------------------------------------------------------------------

// Fills the whole from all tables, each in its turn. Throws input_error, or keeps all faults (Reading::refusals).
template <class Whole>
void read_parts(const std::vector<Part<Whole>>& parts, const TomlValue& root, Reading& reading, Whole& whole)
{
    std::vector<const Part<Whole>*> in_turn;
    std::vector<KeyInfo> tables;
    std::vector<const KeyInfo*> known;
    for (const Part<Whole>& part : parts) {
        in_turn.push_back(&part);
        if (part.info.name.empty()) // keys outside any table
            for (const KeyInfo& key : part.keys)
                known.push_back(&key);
        else if (part.info.written != Written::inside)
            tables.push_back({.name = part.info.name, .formerly = part.info.formerly});
    }
    for (const KeyInfo& table : tables)
        known.push_back(&table);
    check_keys(root, known, {reading, "the " + reading.whole});
    std::ranges::stable_sort(in_turn, {}, &Part<Whole>::turn);
    for (const Part<Whole>* const part : in_turn) {
        const std::size_t before = reading.refusals ? reading.refusals->count() : 0;
        if (part->read)
            attempt(reading, [&] { part->read(root, reading, whole); });
        const bool others_need_it = part->turn == Turn::files || part->turn == Turn::calendar;
        if (others_need_it && reading.refusals && reading.refusals->count() > before)
            return;
    }
}

// The checks of some parts that concern names, or one of Part's checks.
template <class Whole>
void check_names(const std::vector<Part<Whole>>& parts, const Source& source)
{
    for (const Part<Whole>& part : parts)
        if (part.has_names)
            attempt(source.reading, [&] { source.check_unique({part.info.name}); });
}
template <class Whole>
void check_parts(const std::vector<Part<Whole>>& parts, typename Part<Whole>::Check Part<Whole>::*check,
                 const Whole& whole, const Source& source)
{
    for (const Part<Whole>& part : parts)
        if (part.*check)
            attempt(source.reading, [&] { (part.*check)(whole, source); });
}

} // namespace jointcreep::keys
