#include "keys/keys.hpp"

#include "model/error.hpp"
#include "model/utf8.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

namespace jointcreep::keys
{
namespace
{

constexpr std::size_t most_corners = 10000; // of a polygon
constexpr std::size_t longest_text = 200;   // [byte]
constexpr std::size_t most_tables = 10000;  // in a list

const TomlValue::List* as_list(const TomlValue& value)
{
    return std::get_if<TomlValue::List>(&value.content);
}

std::optional<double> as_number(const TomlValue& value)
{
    if (const auto* const integer = std::get_if<std::int64_t>(&value.content))
        return static_cast<double>(*integer);
    if (const auto* const number = std::get_if<double>(&value.content))
        return *number;
    return {};
}

std::optional<std::chrono::sys_days> as_date(const TomlValue& value)
{
    if (const auto* const date = std::get_if<TomlValue::Date>(&value.content))
        return std::chrono::sys_days(*date);
    return {};
}

// Changes of one letter that turn `a` into `b`, looking at their first letters only: names can be long.
std::size_t letters_between(std::string_view a, std::string_view b)
{
    a = a.substr(0, 60);
    b = b.substr(0, 60);
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = row[0]++;
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i] != b[j]);
            diagonal = row[j + 1];
            row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
        }
    }
    return row.back();
}

} // namespace

std::string TableInfo::shown() const
{
    if (written == Written::once)
        return "[" + name + "]";
    const auto dot = name.find('.');
    const auto inner = dot == std::string::npos ? "" : " " + name.substr(dot + 1);
    if (written == Written::inside && outer == Written::once)
        return "[" + name.substr(0, dot) + "]" + inner;
    return "[[" + name.substr(0, dot) + "]]" + inner;
}

std::string lower_bound(const Range& range)
{
    return (range.least_open ? "(" : "[") + shown(range.least);
}

std::string upper_bound(const Range& range)
{
    return shown(range.most) + (range.most_open ? ")" : "]");
}

std::string shown(const Range& range, const KeyUnit& unit)
{
    const auto text = lower_bound(range) + ", " + upper_bound(range);
    return unit.symbol.empty() ? text : text + " " + std::string(unit.symbol);
}

std::string KeyInfo::wanted() const
{
    if (!asked_for.empty())
        return asked_for;
    const auto in_range = range ? " in " + shown(*range, unit) : "";
    if (kind == "number")
        return "a number" + in_range;
    if (kind == "integer")
        return "an integer" + in_range;
    if (kind == "text")
        return "a text of 1 to " + std::to_string(longest_text) + " bytes without control characters";
    if (kind == "date")
        return "a date such as 1994-06-15, or a number" + in_range;
    if (kind == "point")
        return "a point [x, y] of numbers" + in_range;
    if (kind == "polyline")
        return "a line [[x, y], [x, y], ...] of numbers" + in_range + " from left to right";
    if (kind == "polygon")
        return "a polygon [[x, y], [x, y], [x, y], ...] of numbers" + in_range;
    if (kind == "polygons")
        return "a list of polygons [[[x, y], [x, y], [x, y], ...], ...] of numbers" + in_range;
    if (kind == "names")
        return "a list of names, [\"first\", ...]";
    return kind;
}

void Place::refuse(std::int64_t line, const std::string& what) const
{
    throw refusal(line, reading.name + ", line " + std::to_string(line) + ": " + what);
}

void Place::refuse(const KeyInfo& key, const TomlValue& value, const std::string& more) const
{
    const bool has_unit = !key.unit.symbol.empty() && as_number(value);
    refuse(value.line, table + (table.empty() ? "" : " ") + key.name + " = " + shown(value) +
                           (has_unit ? " " + std::string(key.unit.symbol) : "") + ": expected " +
                           key.wanted() + (more.empty() ? "" : "; " + more));
}

double read_number(const KeyInfo& key, const TomlValue& value, const Place& place)
{
    const auto number = as_number(value);
    if (!number || !key.range->holds(*number))
        place.refuse(key, value);
    return *number * key.unit.in_si;
}

std::int64_t read_integer(const KeyInfo& key, const TomlValue& value, const Place& place)
{
    const auto* const integer = std::get_if<std::int64_t>(&value.content);
    if (!integer || !key.range->holds(static_cast<double>(*integer)))
        place.refuse(key, value);
    return *integer;
}

std::string read_text(const KeyInfo& key, const TomlValue& value, const Place& place)
{
    const auto* const text = std::get_if<std::string>(&value.content);
    if (!text || text->empty() || text->size() > longest_text || !is_plain_text(*text))
        place.refuse(key, value);
    return *text;
}

std::vector<std::string> read_names(const KeyInfo& key, const TomlValue& value, const Place& place)
{
    constexpr std::size_t most_names = 1000;
    const auto* const list = as_list(value);
    if (!list || list->empty() || list->size() > most_names)
        place.refuse(key, value);
    std::vector<std::string> names;
    for (const TomlValue& one : *list) {
        names.push_back(read_text(key, one, place));
        if (std::count(names.begin(), names.end(), names.back()) > 1)
            place.refuse(key, value, "each name once");
    }
    return names;
}

double read_date(const KeyInfo& key, const TomlValue& value, const Place& place)
{
    const Calendar& calendar = place.reading.calendar;
    if (const auto date = as_date(value)) {
        if (!calendar.start_date)
            place.refuse(key, value, "a date needs a date as [schedule] start");
        const auto since_start = static_cast<double>((*date - *calendar.start_date).count());
        if (!key.range->holds(since_start))
            place.refuse(key, value);
        return since_start * unit::day;
    }
    return read_number(key, value, place) - calendar.start;
}

Calendar read_start(const KeyInfo& key, const TomlValue& value, const Place& place)
{
    if (const auto date = as_date(value))
        return {date, 0};
    return {{}, read_number(key, value, place)};
}

Eigen::Vector2d read_point(const KeyInfo& key, const TomlValue& value, const Place& place)
{
    const auto* const list = as_list(value);
    if (!list || list->size() != 2)
        place.refuse(key, value);
    return {read_number(key, list->front(), place), read_number(key, list->back(), place)};
}

std::vector<Eigen::Vector2d> read_polyline(const KeyInfo& key, const TomlValue& value, const Place& place)
{
    const auto* const list = as_list(value);
    if (!list || list->size() < 2)
        place.refuse(key, value, "at least 2 corners");
    if (list->size() > most_corners)
        place.refuse(key, value, "at most " + std::to_string(most_corners) + " corners");
    std::vector<Eigen::Vector2d> corners;
    for (const TomlValue& corner : *list) {
        corners.push_back(read_point(key, corner, place));
        if (corners.size() > 1 && !(corners.back().x() > corners[corners.size() - 2].x()))
            place.refuse(key, value, "x increasing from corner to corner");
    }
    return corners;
}

Polygon read_polygon(const KeyInfo& key, const TomlValue& value, const Place& place)
{
    const auto* const list = as_list(value);
    if (!list || list->size() < 3)
        place.refuse(key, value, "at least 3 corners");
    if (list->size() > most_corners)
        place.refuse(key, value, "at most " + std::to_string(most_corners) + " corners");
    Polygon corners;
    for (const TomlValue& corner : *list)
        corners.push_back(read_point(key, corner, place));
    return corners;
}

std::vector<Polygon> read_polygons(const KeyInfo& key, const TomlValue& value, const Place& place)
{
    const auto* const list = as_list(value);
    if (!list || list->empty())
        place.refuse(key, value);
    std::vector<Polygon> all;
    for (const TomlValue& one : *list)
        all.push_back(read_polygon(key, one, place));
    return all;
}

// A key that is not among those known.
[[noreturn]] void refuse_key(const TomlEntry& entry, const std::vector<const KeyInfo*>& known,
                             const std::vector<std::string>& names, const Place& place)
{
    const std::string key = shown(TomlValue{.content = entry.key});
    const auto now = std::ranges::find_if(
        known, [&](const KeyInfo* one) { return !one->formerly.empty() && one->formerly == entry.key; });
    if (now != known.end())
        place.refuse(entry.value.line, place.table + " has no key " + key + ": it is now called " +
                                           (*now)->name + ". Rename it in the " + place.reading.whole);
    const auto meant = nearest(entry.key, names);
    std::string all;
    for (const auto& name : names)
        all += (all.empty() ? "" : ", ") + name;
    place.refuse(entry.value.line,
                 place.table + " has no key " + key +
                     (meant.empty() ? " (its keys: " + all + ")" : "; did you mean " + meant + "?"));
}

void check_keys(const TomlValue& value, const std::vector<const KeyInfo*>& known, const Place& place)
{
    const auto* const entries = std::get_if<TomlValue::Table>(&value.content);
    if (!entries)
        place.refuse(value.line, place.table + " is " + shown(value) + ": expected a table");
    std::vector<std::string> names;
    for (const KeyInfo* const key : known)
        names.push_back(key->name);
    for (const TomlEntry& entry : *entries)
        if (std::find(names.begin(), names.end(), entry.key) == names.end())
            attempt(place.reading, [&] { refuse_key(entry, known, names, place); });
}

void check_present(const TomlValue& value, const std::vector<const KeyInfo*>& known, const Place& place)
{
    std::map<std::string, std::string> given; // one key of every group
    std::set<std::string> elsewhere;          // groups in whose place another key stands
    std::vector<std::string> names;
    for (const KeyInfo* const key : known) {
        names.push_back(key->name);
        if (key->need == Need::together && value.find(key->name))
            given[key->group] = key->name;
        if (!key->in_place_of.empty() && value.find(key->name))
            elsewhere.insert(key->in_place_of);
    }
    std::set<std::string> misspelt; // check_keys refuses these already
    for (const TomlEntry& entry : std::get<TomlValue::Table>(value.content))
        if (std::ranges::find(names, entry.key) == names.end())
            misspelt.insert(nearest(entry.key, names));
    const auto check = [&](const KeyInfo& key) {
        const TomlValue* const found = value.find(key.name);
        if (found && !key.in_place_of.empty() && given.contains(key.in_place_of))
            place.refuse(found->line, place.table + " " + key.name + " = " + shown(*found) +
                                          ": expected either " + key.name + " or the " + key.in_place_of +
                                          " keys (" + given[key.in_place_of] + ", ...), not both");
        if (found || misspelt.contains(key.name))
            return;
        const auto missing = place.table + " has no " + key.name + ": expected " + key.wanted();
        if (key.need == Need::required)
            place.refuse(value.line, missing);
        if (key.need == Need::together && given.contains(key.group) && !elsewhere.contains(key.group))
            place.refuse(value.line, missing + ", as it comes together with " + given[key.group]);
    };
    for (const KeyInfo* const key : known)
        attempt(place.reading, [&] { check(*key); });
}

const TomlValue::List& list_of(const TableInfo& info, const TomlValue& root, const Reading& reading)
{
    static const TomlValue::List none;
    const Place place{reading, info.shown()};
    const TomlValue* const value = root.find(info.name);
    const std::string the_whole = "the " + reading.whole;
    if (!value && info.need == Need::optional)
        return none;
    if (!value)
        place.refuse(1, the_whole + " has no " + info.shown() + ": expected one at least");
    const auto* const list = std::get_if<TomlValue::List>(&value->content);
    if (!list || list->empty())
        place.refuse(value->line,
                     info.name + " is " + shown(*value) + ": expected tables under " + info.shown());
    if (list->size() > most_tables)
        place.refuse(value->line, the_whole + " has " + std::to_string(list->size()) + " " + info.shown() +
                                      ": expected at most " + std::to_string(most_tables));
    return *list;
}

std::string nearest(const std::string& name, const std::vector<std::string>& known)
{
    for (const auto& candidate : known) // without its unit
        if (!name.empty() && candidate.starts_with(name + '_'))
            return candidate;
    std::string best;
    std::size_t fewest = std::max<std::size_t>(2, name.size() / 3) + 1; // further ones are another word
    for (const auto& candidate : known)
        if (const auto changes = letters_between(name, candidate); changes < fewest) {
            fewest = changes;
            best = candidate;
        }
    return best;
}

} // namespace jointcreep::keys
