// The JSON Schema of a scene, from the declarations of the keys.

#include "scene/scene.hpp"
#include "scene/scene_keys.hpp"

#include <nlohmann/json.hpp>

#include <charconv>

namespace jointcreep::scene
{
namespace
{

using namespace keys;
using Json = nlohmann::ordered_json;

Json list_of(Json items, int least)
{
    return {{"type", "array"}, {"items", std::move(items)}, {"minItems", least}};
}

// A number, or a text with names of [variables].
Json number_in(const char* type, const std::optional<Range>& range)
{
    // A text has a letter at least: a number is written without quotes.
    Json number{{"type", {type, "string"}}, {"pattern", "^[-+*/(). 0-9]*[A-Za-z][-+*/(). 0-9A-Za-z_]*$"}};
    if (range) {
        number[range->least_open ? "exclusiveMinimum" : "minimum"] = range->least;
        number[range->most_open ? "exclusiveMaximum" : "maximum"] = range->most;
    }
    return number;
}

Json point_in(const std::optional<Range>& range)
{
    Json point = list_of(number_in("number", range), 2);
    point["maxItems"] = 2;
    return point;
}

Json closed(Json properties, Json required)
{
    return {{"type", "object"},
            {"properties", std::move(properties)},
            {"required", std::move(required)},
            {"additionalProperties", false}};
}

Json sides()
{
    return number_in("integer", from(1).to(1000));
}

// Corners, and arcs between them.
Json corners_in(const std::optional<Range>& range, int least)
{
    const Json arc = closed({{"through_m", point_in(range)}, {"to_m", point_in(range)}, {"sides", sides()}},
                            {"through_m", "to_m"});
    return list_of({{"anyOf", {point_in(range), arc}}}, least);
}

Json polygon_in(const std::optional<Range>& range)
{
    const Json circle = closed({{"center_m", point_in(range)},
                                {"radius_m", number_in("number", above(0).to(farthest_metre))},
                                {"sides", sides()}},
                               {"center_m", "radius_m"});
    return {{"anyOf", {corners_in(range, 2), circle}}};
}

// The words of a kind that lists them: "x" | "y".
Json words_of(const std::string& kind)
{
    Json words = Json::array();
    for (std::size_t from = kind.find('"'); from != std::string::npos;) {
        const std::size_t to = kind.find('"', from + 1);
        words.push_back(kind.substr(from + 1, to - from - 1));
        from = kind.find('"', to + 1);
    }
    return words;
}

// What a key may have as its value. `inside` is the name of the table that may stand there.
Json value_of(const KeyInfo& key, const std::string& inside)
{
    Json table{{"$ref", "#/$defs/" + inside}};
    if (key.kind == "number" || key.kind == "integer")
        return number_in(key.kind.c_str(), key.range);
    if (key.kind == "text" || key.kind == "file text")
        return {{"type", "string"}};
    if (key.kind == "date")
        return {{"type", {"string", "number"}}};
    if (key.kind == "names")
        return list_of({{"type", "string"}}, 0);
    if (key.kind == "point")
        return point_in(key.range);
    if (key.kind == "polyline")
        return corners_in(key.range, 2);
    if (key.kind == "polygon")
        return polygon_in(key.range);
    if (key.kind == "polygons")
        return list_of(polygon_in(key.range), 1);
    if (key.kind == "load history" || key.kind == "poles")
        return list_of(point_in(std::nullopt), 1);
    if (key.kind == "law" || key.kind == "density")
        return table;
    if (key.kind == "Kelvin units" || key.kind == "levels" || key.kind == "rocks and materials")
        return list_of(table, 1);
    return {{"enum", words_of(key.kind)}};
}

Json described(Json value, const KeyInfo& key)
{
    value["description"] = key.doc +
                           (key.unit.symbol.empty() ? "" : " [" + std::string(key.unit.symbol) + "]") +
                           (key.otherwise.empty() ? "" : " Default: " + key.otherwise + ".");
    return value;
}

Json object_of(const Part<Scene>& part)
{
    Json properties = Json::object(), required = Json::array();
    for (const KeyInfo& key : part.keys) {
        properties[key.name] = described(value_of(key, part.info.name + "." + key.name), key);
        if (key.need == Need::required)
            required.push_back(key.name);
    }
    Json object{{"type", "object"},
                {"description", part.info.doc},
                {"properties", std::move(properties)},
                {"additionalProperties", false}};
    if (part.keys.empty()) // names of the scene's own
        object["additionalProperties"] = number_in("number", std::nullopt);
    if (!required.empty())
        object["required"] = std::move(required);
    return object;
}

} // namespace

std::string scene_schema()
{
    Json schema{{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", "A scene of jointcreep"}};
    Json defs = Json::object(), tables = Json::object(), required = Json::array();
    for (const Part<Scene>& part : scene_parts()) {
        const TableInfo& table = part.info;
        Json object = object_of(part);
        if (table.name.empty()) {
            for (auto& [key, value] : object["properties"].items())
                tables[key] = value;
            continue;
        }
        defs[table.name] = std::move(object);
        if (table.written == Written::inside)
            continue;
        const Json one{{"$ref", "#/$defs/" + table.name}};
        tables[table.name] = table.written == Written::once ? one : list_of(one, 0);
        if (table.need == Need::required)
            required.push_back(table.name);
    }
    schema["type"] = "object";
    schema["properties"] = std::move(tables);
    schema["additionalProperties"] = false;
    schema["required"] = std::move(required);
    schema["$defs"] = std::move(defs);
    return schema.dump(1) + "\n";
}

} // namespace jointcreep::scene
