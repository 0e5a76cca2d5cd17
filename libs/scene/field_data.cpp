#include "scene/field_data.hpp"

#include "keys/keys.hpp"
#include "model/error.hpp"
#include "model/units.hpp"
#include "model/utf8.hpp"
#include "scene/csv.hpp"

#include <nlohmann/json.hpp>

#include <charconv>
#include <cmath>
#include <set>

namespace jointcreep::scene
{

namespace
{

using Eigen::Vector2d;
using nlohmann::json;

constexpr std::int64_t largest_id = 2097151; // 2^31 / mapped_step - 1 (sampling/joint_sets.hpp)

// A trace as it is read, with what the file says of its id.
struct FoundTrace {
    std::optional<std::int64_t> id;
    std::int64_t place; // in the file
    std::vector<Polygon> polylines;
    std::string where; // for messages
    std::string value; // of the filter's property
};

std::optional<std::int64_t> id_of(std::string_view text)
{
    std::int64_t id = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
    if (error != std::errc{} || end != text.data() + text.size())
        return {};
    return id;
}

constexpr Range coordinate_range = keys::coordinates;

std::vector<FoundTrace> traces_in_csv(const Csv& csv, const TraceFilter& filter)
{
    if (!filter.layer.empty())
        throw input_error("is CSV, which has no layers; expected no layer");
    const auto value_of = [&](const Csv::Row& row) {
        return filter.property.empty() ? std::string() : std::string(row.field[csv.column(filter.property)]);
    };
    const auto taken = [&](const Csv::Row& row) {
        return filter.property.empty() || !filter.value || value_of(row) == *filter.value;
    };
    std::vector<FoundTrace> found;
    if (csv.has("x1_m")) {
        std::int64_t place = 0;
        for (const Csv::Row& row : csv.rows) {
            if (taken(row)) {
                const auto at = [&](std::string_view x, std::string_view y) {
                    return Vector2d(csv.number(row, x, coordinate_range),
                                    csv.number(row, y, coordinate_range));
                };
                found.push_back({csv.has("id") ? id_of(row.field[csv.column("id")]) : std::nullopt,
                                 place,
                                 {{at("x1_m", "y1_m"), at("x2_m", "y2_m")}},
                                 "line " + std::to_string(row.line),
                                 value_of(row)});
            }
            ++place;
        }
        return found;
    }
    const std::size_t id = csv.column("id");
    std::int64_t place = -1;
    const Csv::Row* before = nullptr;
    std::set<std::string_view> seen;
    for (const Csv::Row& row : csv.rows) {
        const bool begins = !before || before->field[id] != row.field[id];
        if (begins) {
            ++place;
            if (!seen.insert(row.field[id]).second)
                refuse_line(row.line, "id \"" + std::string(row.field[id]) +
                                          "\" comes again; expected the rows of a trace together");
        }
        if (taken(row)) {
            if (begins)
                found.push_back({id_of(row.field[id]),
                                 place,
                                 {Polygon{}},
                                 "line " + std::to_string(row.line),
                                 value_of(row)});
            else if (value_of(row) != value_of(*before))
                refuse_line(row.line, "a trace has more than one " + filter.property);
            found.back().polylines[0].emplace_back(csv.number(row, "x_m", coordinate_range),
                                                   csv.number(row, "y_m", coordinate_range));
        } else if (!begins && taken(*before)) {
            refuse_line(row.line, "a trace has more than one " + filter.property);
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
                "; expected [x, y], in metres of the section (a third one, the height, is not used)");
        const Vector2d at(place[0].get<double>(), place[1].get<double>());
        if (!coordinate_range.holds(at.x()) || !coordinate_range.holds(at.y()))
            throw input_error(where + " has the coordinates " + place.dump().substr(0, 60) +
                              "; expected numbers in " + keys::shown(coordinate_range, metres));
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

// The layer to take, of a text of layers; empty of other texts.
std::string chosen_layer(const json& layers, const TraceFilter& filter)
{
    if (!layers.is_object()) {
        if (!filter.layer.empty())
            throw input_error("is GeoJSON, which has no layers; expected no layer");
        return {};
    }
    std::string names;
    for (const auto& [name, content] : layers.items())
        names += (names.empty() ? "\"" : ", \"") + name + '"';
    if (filter.layer.empty() && layers.size() == 1)
        return layers.begin().key();
    if (filter.layer.empty())
        throw input_error("has lines in several layers; expected layer = one of " + names);
    if (!layers.contains(filter.layer))
        throw input_error("has no lines in a layer \"" + filter.layer + "\"; it has some in " + names);
    return filter.layer;
}

std::vector<FoundTrace> traces_in_geojson(std::string_view text, const TraceFilter& filter)
{
    constexpr int deepest = 32; // a feature's coordinates are at 6
    const auto not_too_deep = [](int depth, json::parse_event_t, const json&) {
        if (depth > deepest)
            throw input_error("is nested too deeply; expected GeoJSON");
        return true;
    };
    json all;
    try {
        all = json::parse(text, not_too_deep);
    } catch (const json::exception& error) {
        throw input_error(std::string("is not JSON: ") + error.what());
    }
    const json& layers = member(all, "layers");
    const std::string layer = chosen_layer(layers, filter);
    const json& content = layers.is_object() ? layers[layer] : all;
    const json& collection = member(content, "features");
    const json one = collection.is_array() ? json() : json::array({content});
    const json& features = collection.is_array() ? collection : one;

    std::vector<FoundTrace> found;
    for (std::size_t i = 0; i < features.size(); ++i) {
        const json& feature = features[i];
        const std::string where = (layers.is_object() ? "layer \"" + layer + "\", " : std::string()) +
                                  "feature " + std::to_string(i);
        std::string of_property;
        if (!filter.property.empty()) {
            const json& value = member(member(feature, "properties"), filter.property.c_str());
            of_property = value.is_string() ? value.get<std::string>() : value.dump();
            if (filter.value && of_property != *filter.value)
                continue;
        }
        const json& geometry = member(feature, "type") == "Feature" ? member(feature, "geometry") : feature;
        const json &kind = member(geometry, "type"), &coordinates = member(geometry, "coordinates");
        FoundTrace trace{{}, static_cast<std::int64_t>(i), {}, where, of_property};
        if (kind == "LineString") {
            trace.polylines.push_back(polyline_of(coordinates, where));
        } else if (kind == "MultiLineString") {
            if (!coordinates.is_array())
                throw input_error(where + " has no coordinates");
            for (const json& line : coordinates)
                trace.polylines.push_back(polyline_of(line, where));
        } else {
            throw input_error(where + " is of the type " + kind.dump().substr(0, 60) +
                              "; expected a LineString or a MultiLineString");
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
    for (const Csv::Row& row : csv.rows)
        poles.push_back({csv.number(row, "dip_deg", from(0).to(90)) * unit::deg,
                         csv.number(row, "dip_direction_deg", from(0).to(360)) * unit::deg,
                         csv.has("weight") ? csv.number(row, "weight", above(0).to(1e6)) : 1.0});
    return poles;
}

std::vector<MappedTrace> mapped_traces(std::string_view text, const TraceFilter& filter)
{
    return traces_of_file(text, filter).trace;
}

TracesOfFile traces_of_file(std::string_view text, const TraceFilter& filter)
{
    text = without_byte_order_mark(text);
    const auto begin = text.find_first_not_of(" \t\r\n");
    const bool is_json = begin != std::string_view::npos && text[begin] == '{';
    const std::vector<FoundTrace> found =
        is_json ? traces_in_geojson(text, filter) : traces_in_csv(Csv(text), filter);
    if (found.empty())
        throw input_error(!filter.value
                              ? "has no traces"
                              : "has no trace whose " + filter.property + " is \"" + *filter.value + "\"");
    const bool have_ids = std::all_of(found.begin(), found.end(), [](const FoundTrace& trace) {
        return trace.id && *trace.id >= 0 && *trace.id <= largest_id;
    });
    std::set<std::int64_t> ids;
    TracesOfFile traces;
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
        traces.trace.push_back({static_cast<std::int32_t>(id), trace.polylines});
        traces.value.push_back(trace.value);
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

} // namespace jointcreep::scene
