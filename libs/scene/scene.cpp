#include "scene/scene.hpp"

#include "model/error.hpp"
#include "scene/scene_checks.hpp"
#include "scene/scene_keys.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

namespace jointcreep
{
namespace
{

constexpr std::size_t largest_text = 1 << 24; // [byte]
constexpr std::size_t most_tables = 10000;    // in a list
constexpr double usual_shortest_edge = 0.02;  // of the zone size
constexpr double usual_local_damping = 0.8;

void check_tables(const TomlValue& root, const Reading& reading)
{
    const SceneTables& tables = scene_tables();
    std::vector<KeyInfo> infos;
    tables.each([&](const auto& table) {
        if (!table.info.name.empty() && table.info.written != Written::inside)
            infos.push_back({.name = table.info.name});
    });
    auto known = key_infos(tables.top);
    for (const KeyInfo& info : infos)
        known.push_back(&info);
    check_keys(root, known, {reading, "the scene"});
}

// The tables of a list, one a record.
const TomlValue::List& list_of(const TableInfo& info, const TomlValue& root, const Reading& reading)
{
    static const TomlValue::List none;
    const Place place{reading, info.shown()};
    const TomlValue* const value = root.find(info.name);
    if (!value && info.need == Need::optional)
        return none;
    if (!value)
        place.refuse(1, "the scene has no " + info.shown() + ": wanted one at least");
    const auto* const list = std::get_if<TomlValue::List>(&value->content);
    if (!list || list->empty())
        place.refuse(value->line,
                     info.name + " is " + shown(*value) + ": wanted tables under " + info.shown());
    if (list->size() > most_tables)
        place.refuse(value->line, "the scene has " + std::to_string(list->size()) + " " + info.shown() +
                                      ": wanted at most " + std::to_string(most_tables));
    return *list;
}

template <class Record>
std::vector<Record> read_list(const Table<Record>& table, const TomlValue& root, const Reading& reading)
{
    std::vector<Record> records;
    for (const TomlValue& one : list_of(table.info, root, reading)) {
        const TomlValue* const name = one.find("name");
        const Place place{reading, table.info.shown() + (name ? " " + shown(*name) : "")};
        read_table(table, one, place, records.emplace_back());
    }
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
        place.refuse(1, "the scene has no " + table.info.shown());
    else
        fill(table, TomlValue{.content = TomlValue::Table{}}, place, record);
    return value != nullptr;
}

} // namespace

Scene parse_scene(std::string_view text, const std::string& name)
{
    const TomlValue root = parse_toml(text, name);
    const SceneTables& tables = scene_tables();
    Reading reading{name, {}};
    check_tables(root, reading);

    Scene scene;
    fill(tables.top, root, {reading, ""}, scene);
    read_once(tables.section, root, reading, scene);
    scene.rocks = read_list(tables.rock, root, reading);
    scene.regions = read_list(tables.region, root, reading);
    scene.joint_materials = read_list(tables.joint_material, root, reading);
    scene.joints = read_list(tables.joint, root, reading);
    scene.joint_sets = read_list(tables.joint_set, root, reading);
    read_once(tables.in_situ_stress, root, reading, scene.in_situ_stress);

    Schedule schedule{reading.calendar};
    read_once(tables.schedule, root, reading, schedule);
    scene.end = schedule.end;
    // From here on what has dates.
    scene.boundaries = read_list(tables.boundary, root, reading);
    scene.stages = read_list(tables.stage, root, reading);
    scene.points = read_list(tables.point, root, reading);
    scene.gauges = read_list(tables.gauge, root, reading);

    if (Creep creep; read_once(tables.creep, root, reading, creep))
        scene.creep = creep;
    read_once(tables.zones, root, reading, scene);
    scene.cutting.shortest_edge = usual_shortest_edge * scene.zone_size;
    read_once(tables.cutting, root, reading, scene.cutting);
    read_once(tables.averaging, root, reading, scene.averaging);
    scene.equilibrium.local_damping = usual_local_damping;
    read_once(tables.equilibrium, root, reading, scene.equilibrium);
    read_once(tables.random, root, reading, scene);

    check_scene(scene, root, reading);
    return scene;
}

std::string read_scene_text(const std::string& path)
{
    if (std::error_code ignored; std::filesystem::is_directory(path, ignored))
        throw file_error(path + ": is a directory; wanted a scene file");
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
    if (!file)
        throw file_error(path + ": cannot be opened: " + std::strerror(errno));
    std::string text;
    std::array<char, 65536> part;
    while (const std::size_t count = std::fread(part.data(), 1, part.size(), file.get())) {
        text.append(part.data(), count);
        if (text.size() > largest_text)
            throw input_error(path + ": is larger than 16 MiB; wanted a scene");
    }
    if (std::ferror(file.get()))
        throw file_error(path + ": cannot be read: " + std::strerror(errno));
    if (text.empty())
        throw input_error(path + ": is empty; wanted a scene");
    return text;
}

} // namespace jointcreep
