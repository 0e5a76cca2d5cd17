#include "scene/field_data.hpp"

#include "model/error.hpp"
#include "model/units.hpp"
#include "scene/keys.hpp"

#include <nlohmann/json.hpp>

#include <charconv>
#include <cmath>
#include <set>

namespace jointcreep
{

namespace
{

using Eigen::Vector2d;
using nlohmann::json;

constexpr std::int64_t largest_id = 2097151; // 2^31 / mapped_step - 1 (sampling/joint_sets.hpp)

struct Row {
    std::size_t line;
    std::vector<std::string_view> field;
};

std::string_view trimmed(std::string_view text)
{
    const auto is_space = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
    while (!text.empty() && is_space(text.front()))
        text.remove_prefix(1);
    while (!text.empty() && is_space(text.back()))
        text.remove_suffix(1);
    return text;
}

[[noreturn]] void refuse(std::size_t line, const std::string& what)
{
    throw input_error("line " + std::to_string(line) + ": " + what);
}

std::vector<std::string_view> fields_of(std::string_view line, std::size_t number)
{
    std::vector<std::string_view> fields;
    while (true) {
        line = trimmed(line);
        std::string_view field;
        if (line.starts_with('"')) {
            const auto end = line.find('"', 1);
            if (end == std::string_view::npos)
                refuse(number, "a field begins with \" and does not end");
            field = line.substr(1, end - 1);
            line = trimmed(line.substr(end + 1));
            if (!line.empty() && line.front() != ',')
                refuse(number, "wanted a comma after a field in double quotes");
        } else {
            field = trimmed(line.substr(0, line.find(',')));
            line.remove_prefix(std::min(line.size(), line.find(',')));
        }
        fields.push_back(field);
        if (line.empty())
            return fields;
        line.remove_prefix(1);
    }
}

// A table of text with named columns.
class Csv
{
public:
    explicit Csv(std::string_view text)
    {
        if (text.starts_with("\xef\xbb\xbf")) // a byte order mark
            text.remove_prefix(3);
        for (std::size_t line = 1; !text.empty(); ++line) {
            const std::string_view whole = text.substr(0, text.find('\n'));
            text.remove_prefix(std::min(text.size(), whole.size() + 1));
            if (trimmed(whole).empty() || trimmed(whole).front() == '#')
                continue;
            Row row{line, fields_of(whole, line)};
            if (columns_.empty()) {
                columns_ = std::move(row.field);
                head_ = line;
            } else {
                if (row.field.size() != columns_.size())
                    refuse(line, "has " + std::to_string(row.field.size()) + " fields; wanted " +
                                     std::to_string(columns_.size()) + ", as in line " +
                                     std::to_string(head_));
                rows.push_back(std::move(row));
            }
        }
        if (rows.empty())
            throw input_error("wanted a line of column names, and rows");
        for (const std::string_view name : columns_)
            if (std::count(columns_.begin(), columns_.end(), name) > 1)
                refuse(head_, "has the column " + std::string(name) + " more than once");
    }

    // Refuses a column that has none of these names.
    void allow_only(const std::vector<std::string>& names) const
    {
        for (const std::string_view column : columns_)
            if (std::find(names.begin(), names.end(), column) == names.end()) {
                std::string all;
                for (const std::string& name : names)
                    all += (all.empty() ? "" : ", ") + name;
                refuse(head_, "has a column " + std::string(column) + "; wanted none but " + all);
            }
    }

    bool has(std::string_view name) const
    {
        return std::find(columns_.begin(), columns_.end(), name) != columns_.end();
    }

    std::size_t column(std::string_view name) const
    {
        const auto found = std::find(columns_.begin(), columns_.end(), name);
        if (found == columns_.end())
            refuse(head_, "wanted a column " + std::string(name));
        return static_cast<std::size_t>(found - columns_.begin());
    }

    double number(const Row& row, std::string_view name, const Range& range) const
    {
        const std::string_view field = row.field[column(name)];
        double value = 0;
        const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
        if (error != std::errc{} || end != field.data() + field.size() || !range.holds(value))
            refuse(row.line, std::string(name) + " is \"" + std::string(field) + "\"; wanted a number in " +
                                 shown(range, Unit{""}));
        return value;
    }

    std::vector<Row> rows;

private:
    std::vector<std::string_view> columns_;
    std::size_t head_ = 0;
};

// A trace on its way, with what the file says of its id.
struct FoundTrace {
    std::optional<std::int64_t> id;
    std::int64_t place; // in the file
    std::vector<Polygon> polylines;
    std::string where; // for messages
};

std::optional<std::int64_t> id_of(std::string_view text)
{
    std::int64_t id = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
    if (error != std::errc{} || end != text.data() + text.size())
        return {};
    return id;
}

constexpr Range coordinate = within(farthest_metre);

std::vector<FoundTrace> traces_in_csv(const Csv& csv, const TraceFilter& filter)
{
    const auto taken = [&](const Row& row) {
        return filter.property.empty() || row.field[csv.column(filter.property)] == filter.value;
    };
    std::vector<FoundTrace> found;
    if (csv.has("x1_m")) {
        std::int64_t place = 0;
        for (const Row& row : csv.rows) {
            if (taken(row)) {
                const auto at = [&](std::string_view x, std::string_view y) {
                    return Vector2d(csv.number(row, x, coordinate), csv.number(row, y, coordinate));
                };
                found.push_back({csv.has("id") ? id_of(row.field[csv.column("id")]) : std::nullopt,
                                 place,
                                 {{at("x1_m", "y1_m"), at("x2_m", "y2_m")}},
                                 "line " + std::to_string(row.line)});
            }
            ++place;
        }
        return found;
    }
    const std::size_t id = csv.column("id");
    std::int64_t place = -1;
    const Row* before = nullptr;
    std::set<std::string_view> seen;
    for (const Row& row : csv.rows) {
        const bool begins = !before || before->field[id] != row.field[id];
        if (begins) {
            ++place;
            if (!seen.insert(row.field[id]).second)
                refuse(row.line, "id \"" + std::string(row.field[id]) +
                                     "\" comes again; wanted the rows of a trace together");
        }
        if (taken(row)) {
            if (begins)
                found.push_back(
                    {id_of(row.field[id]), place, {Polygon{}}, "line " + std::to_string(row.line)});
            else if (!taken(*before))
                refuse(row.line, "a trace has more than one " + filter.property);
            found.back().polylines[0].emplace_back(csv.number(row, "x_m", coordinate),
                                                   csv.number(row, "y_m", coordinate));
        } else if (!begins && taken(*before)) {
            refuse(row.line, "a trace has more than one " + filter.property);
        }
        before = &row;
    }
    return found;
}

Polygon polyline_of(const json& coordinates, const std::string& where)
{
    Polygon polyline;
    if (!coordinates.is_array())
        throw input_error(where + " has no coordinates");
    for (const json& place : coordinates) {
        if (!place.is_array() || place.size() < 2 || place.size() > 3 || !place[0].is_number() ||
            !place[1].is_number())
            throw input_error(
                where + " has the coordinates " + place.dump().substr(0, 60) +
                "; wanted [x, y], in metres of the section (a third one, the height, is not used)");
        const Vector2d at(place[0].get<double>(), place[1].get<double>());
        if (!coordinate.holds(at.x()) || !coordinate.holds(at.y()))
            throw input_error(where + " has the coordinates " + place.dump().substr(0, 60) +
                              "; wanted numbers in " + shown(coordinate, metres));
        polyline.push_back(at);
    }
    return polyline;
}

// A member of an object, or null.
const json& member(const json& object, const char* name)
{
    static const json none;
    const auto found = object.is_object() ? object.find(name) : object.end();
    return object.is_object() && found != object.end() ? *found : none;
}

std::vector<FoundTrace> traces_in_geojson(std::string_view text, const TraceFilter& filter)
{
    constexpr int deepest = 32; // a feature's coordinates are at 6
    const auto not_too_deep = [](int depth, json::parse_event_t, const json&) {
        if (depth > deepest)
            throw input_error("is nested too deeply; wanted GeoJSON");
        return true;
    };
    json all;
    try {
        all = json::parse(text, not_too_deep);
    } catch (const json::exception& error) {
        throw input_error(std::string("is not JSON: ") + error.what());
    }
    const json& collection = member(all, "features");
    const json one = collection.is_array() ? json() : json::array({all});
    const json& features = collection.is_array() ? collection : one;

    std::vector<FoundTrace> found;
    for (std::size_t i = 0; i < features.size(); ++i) {
        const json& feature = features[i];
        const std::string where = "feature " + std::to_string(i);
        if (!filter.property.empty()) {
            const json& value = member(member(feature, "properties"), filter.property.c_str());
            if ((value.is_string() ? value.get<std::string>() : value.dump()) != filter.value)
                continue;
        }
        const json& geometry = member(feature, "type") == "Feature" ? member(feature, "geometry") : feature;
        const json &kind = member(geometry, "type"), &coordinates = member(geometry, "coordinates");
        FoundTrace trace{{}, static_cast<std::int64_t>(i), {}, where};
        if (kind == "LineString") {
            trace.polylines.push_back(polyline_of(coordinates, where));
        } else if (kind == "MultiLineString") {
            if (!coordinates.is_array())
                throw input_error(where + " has no coordinates");
            for (const json& line : coordinates)
                trace.polylines.push_back(polyline_of(line, where));
        } else {
            throw input_error(where + " is of the type " + kind.dump().substr(0, 60) +
                              "; wanted a LineString or a MultiLineString");
        }
        for (const json& id : {member(feature, "id"), member(member(feature, "properties"), "id")})
            if (!trace.id && id.is_number_integer())
                trace.id = id.get<std::int64_t>();
        found.push_back(std::move(trace));
    }
    return found;
}

} // namespace

std::vector<MeasuredPole> poles_in_csv(std::string_view text)
{
    const Csv csv(text);
    for (const char* needed : {"dip_deg", "dip_direction_deg"})
        csv.column(needed);
    csv.allow_only({"dip_deg", "dip_direction_deg", "weight"});
    std::vector<MeasuredPole> poles;
    for (const Row& row : csv.rows)
        poles.push_back({csv.number(row, "dip_deg", from(0).to(90)) * unit::deg,
                         csv.number(row, "dip_direction_deg", from(0).to(360)) * unit::deg,
                         csv.has("weight") ? csv.number(row, "weight", above(0).to(1e6)) : 1.0});
    return poles;
}

std::vector<MappedTrace> mapped_traces(std::string_view text, const TraceFilter& filter)
{
    const auto begin = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
    const bool is_json = begin != std::string_view::npos && text[begin] == '{';
    const std::vector<FoundTrace> found =
        is_json ? traces_in_geojson(text, filter) : traces_in_csv(Csv(text), filter);
    if (found.empty())
        throw input_error(filter.property.empty()
                              ? "has no traces"
                              : "has no trace whose " + filter.property + " is \"" + filter.value + "\"");
    const bool have_ids = std::all_of(found.begin(), found.end(), [](const FoundTrace& trace) {
        return trace.id && *trace.id >= 0 && *trace.id <= largest_id;
    });
    std::set<std::int64_t> ids;
    std::vector<MappedTrace> traces;
    for (const FoundTrace& trace : found) {
        const std::int64_t id = have_ids ? *trace.id : trace.place;
        if (id > largest_id)
            throw input_error("has more than " + std::to_string(largest_id + 1) + " traces");
        if (!ids.insert(id).second)
            throw input_error(trace.where + ": another trace has the id " + std::to_string(id) + ", too");
        if (trace.polylines.empty())
            throw input_error(trace.where + " has no coordinates");
        for (const Polygon& polyline : trace.polylines)
            if (std::all_of(polyline.begin(), polyline.end(),
                            [&](const Vector2d& place) { return place == polyline.front(); }))
                throw input_error(trace.where + ": a trace needs two places at least");
        traces.push_back({static_cast<std::int32_t>(id), trace.polylines});
    }
    return traces;
}

// Along north, east and up; the upward normal of a plane leans towards its dip direction.
void correct_for_scanline(std::vector<MeasuredPole>& poles, const Scanline& scanline, double blind_zone)
{
    for (MeasuredPole& pole : poles) {
        const double along =
            std::sin(pole.dip) * std::cos(scanline.plunge) * std::cos(pole.dip_direction - scanline.trend) -
            std::cos(pole.dip) * std::sin(scanline.plunge);
        pole.weight /= std::max(std::abs(along), std::sin(blind_zone));
    }
}

} // namespace jointcreep
