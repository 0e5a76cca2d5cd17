#include "scene/scene.hpp"

#include "joint/law.hpp"
#include "model/error.hpp"
#include "scene/scene_checks.hpp"
#include "scene/scene_keys.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

namespace jointcreep::scene
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

void read_held_files(const TomlValue& root, Reading& reading)
{
    const Table<HeldFile>& table = scene_tables().file;
    const auto& list = list_of(table.info, root, reading);
    const auto files = read_list(table, root, reading);
    for (std::size_t i = 0; i < files.size(); ++i)
        if (!reading.files.try_emplace(files[i].name, files[i].text).second)
            Place{reading, table.info.shown()}.refuse(list[i].find("name")->line,
                                                      "[[file]] name = " + shown(*list[i].find("name")) +
                                                          ": the name is taken by another file");
}

std::vector<MappedSet> read_mapped(const TomlValue& root, const Reading& reading)
{
    const Table<WrittenMapped>& table = scene_tables().mapped;
    const auto& list = list_of(table.info, root, reading);
    const auto written = read_list(table, root, reading);
    std::vector<MappedSet> sets;
    for (std::size_t i = 0; i < written.size(); ++i)
        sets.push_back(mapped_set(written[i], list[i],
                                  {reading, table.info.shown() + " " + shown(*list[i].find("name"))}));
    return sets;
}

// The names of files that a scene asks for.
std::vector<std::string> named_files(const TomlValue& root)
{
    std::vector<std::string> names;
    const auto take = [&](const TomlValue* value) {
        if (const auto* const name = value ? std::get_if<std::string>(&value->content) : nullptr)
            if (!name->empty() && std::find(names.begin(), names.end(), *name) == names.end())
                names.push_back(*name);
    };
    const auto in_list = [&root](std::string_view table) {
        const TomlValue* const value = root.find(table);
        const auto* const list = value ? std::get_if<TomlValue::List>(&value->content) : nullptr;
        return list ? *list : TomlValue::List{};
    };
    for (const TomlValue& set : in_list("joint_set"))
        if (const TomlValue* const orientation = set.find("orientation"))
            take(orientation->find("poles"));
    for (const TomlValue& mapped : in_list("mapped"))
        take(mapped.find("file"));
    for (const TomlValue& held : in_list("file"))
        if (const TomlValue* const name = held.find("name"))
            std::erase_if(names, [&](const std::string& known) {
                return std::get_if<std::string>(&name->content) &&
                       known == std::get<std::string>(name->content);
            });
    return names;
}

// As a TOML string, a line for each of the text, the first after `begin`.
std::string as_toml(const std::string& text, const std::string& begin = "\n")
{
    std::string out = "\"\"\"" + begin;
    for (const char c : text) {
        constexpr const char* digits = "0123456789abcdef";
        const auto code = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\')
            out += std::string("\\") + c;
        else if (c == '\n')
            out += c;
        else if (code < 0x20 || code == 0x7f)
            out += std::string("\\u00") + digits[code / 16] + digits[code % 16];
        else
            out += c;
    }
    return out + "\"\"\"\n";
}

// The text of a file of the given kind, at most so large.
std::string read_text_file(const std::string& path, const std::string& wanted)
{
    if (std::error_code ignored; std::filesystem::is_directory(path, ignored))
        throw file_error(path + ": is a directory; wanted " + wanted);
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
    if (!file)
        throw file_error(path + ": cannot be opened: " + std::strerror(errno));
    std::string text;
    std::array<char, 65536> part;
    while (const std::size_t count = std::fread(part.data(), 1, part.size(), file.get())) {
        text.append(part.data(), count);
        if (text.size() > largest_text)
            throw input_error(path + ": is larger than 16 MiB; wanted " + wanted);
    }
    if (std::ferror(file.get()))
        throw file_error(path + ": cannot be read: " + std::strerror(errno));
    return text;
}

// What the scene at `path` asks for: names and paths. Files that are not there are left out: parse_scene names the
// key that asks for them.
struct FileBeside {
    std::string name, path;
};
std::vector<FileBeside> files_beside(const std::string& path, const std::string& scene)
{
    std::vector<std::string> names;
    try {
        names = named_files(parse_toml(scene, path));
    } catch (const input_error&) { // parse_scene says the same again, in its place
    }
    std::vector<FileBeside> files;
    for (const std::string& name : names) {
        const std::filesystem::path beside = std::filesystem::path(path).parent_path() / name;
        if (std::error_code ignored; std::filesystem::is_regular_file(beside, ignored))
            files.push_back({name, beside.string()});
    }
    return files;
}

// A table [[file]].
std::string table_of(const FileBeside& file)
{
    const std::string text = read_text_file(file.path, "poles or traces of a scene");
    if (text.find_first_not_of(" \t\r\n") == std::string::npos)
        throw input_error(file.path + ": is empty; wanted poles or traces of a scene");
    parse_toml("text = " + as_toml(text, ""), file.path); // names the line of what is not UTF-8
    return "\n[[file]] # as it was beside the scene\nname = " + as_toml(file.name) +
           "text = " + as_toml(text);
}

} // namespace

Scene parse_scene(std::string_view text, const std::string& name)
{
    const TomlValue root = parse_toml(text, name);
    const SceneTables& tables = scene_tables();
    Reading reading{name};
    check_tables(root, reading);
    read_held_files(root, reading);

    Scene scene;
    fill(tables.top, root, {reading, ""}, scene);
    read_once(tables.section, root, reading, scene);
    scene.rocks = read_list(tables.rock, root, reading);
    scene.regions = read_list(tables.region, root, reading);
    scene.joint_materials = read_list(tables.joint_material, root, reading);
    for (JointMaterial& material : scene.joint_materials)
        for (std::size_t law = 0; law < joint::laws().size(); ++law) // by the keys that are given
            if (std::ranges::any_of(joint::laws()[law].own,
                                    [&](std::string_view own) { return material.own.contains(own); }))
                material.law = static_cast<Index>(law);
    scene.joints = read_list(tables.joint, root, reading);
    scene.joint_sets = read_list(tables.joint_set, root, reading);
    scene.mapped = read_mapped(root, reading);
    read_once(tables.in_situ_stress, root, reading, scene.in_situ_stress);

    Schedule schedule{reading.calendar};
    read_once(tables.schedule, root, reading, schedule);
    scene.end = schedule.end;
    // From here on what has dates.
    scene.boundaries = read_list(tables.boundary, root, reading);
    scene.stages = read_list(tables.stage, root, reading);
    scene.points = read_list(tables.point, root, reading);
    scene.gauges = read_list(tables.gauge, root, reading);

    if (CreepSettings creep; read_once(tables.creep, root, reading, creep))
        scene.creep = creep;
    if (LargeDisplacements settings; read_once(tables.large_displacements, root, reading, settings))
        scene.large_displacements = settings;
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

SceneText read_scene(const std::string& path)
{
    SceneText scene{read_text_file(path, "a scene file"), {}};
    if (scene.text.empty())
        throw input_error(path + ": is empty; wanted a scene");
    for (const FileBeside& file : files_beside(path, scene.text)) {
        scene.text += table_of(file);
        scene.files.push_back(file.path);
    }
    if (scene.text.size() > largest_text)
        throw input_error(path + ": is larger than 16 MiB with the files that it names; wanted a scene");
    return scene;
}

std::string read_scene_text(const std::string& path)
{
    return read_scene(path).text;
}

} // namespace jointcreep::scene
