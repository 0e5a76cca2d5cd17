#include "scene/scene.hpp"

#include "model/error.hpp"
#include "model/utf8.hpp"
#include "scene/scene_checks.hpp"
#include "scene/scene_keys.hpp"
#include "scene/shorthand.hpp"
#include "scene/trace_file.hpp"

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

using namespace keys;

constexpr std::size_t largest_text = 1 << 24; // [byte]

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
    for (const TomlValue& file : in_list("file"))
        if (const TomlValue* const name = file.find("name"))
            std::erase_if(names, [&](const std::string& known) {
                return std::get_if<std::string>(&name->content) &&
                       known == std::get<std::string>(name->content);
            });
    return names;
}

// The text as a TOML string with the same lines, the first after `begin`.
std::string as_toml(const std::string& text, const std::string& begin = "\n")
{
    std::string out = "\"\"\"" + begin;
    for (const char c : text) {
        constexpr const char* digits = "0123456789abcdef";
        const auto code = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\')
            out += std::string("\\") + c;
        else if (c != '\n' && (code < 0x20 || code == 0x7f))
            out += std::string("\\u00") + digits[code / 16] + digits[code % 16];
        else
            out += c;
    }
    return out + "\"\"\"\n";
}

// The text of a file of the given kind, at most so large, without a byte order mark.
std::string read_text_file(const std::string& path, const std::string& wanted)
{
    if (std::error_code ignored; std::filesystem::is_directory(path, ignored))
        throw file_error(path + ": is a directory; expected " + wanted);
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
    if (!file)
        throw file_error(path + ": cannot be opened: " + std::strerror(errno));
    std::string text;
    std::array<char, 65536> part;
    while (const std::size_t count = std::fread(part.data(), 1, part.size(), file.get())) {
        text.append(part.data(), count);
        if (text.starts_with("\x89HDF\r\n"))
            throw input_error(path + ": this is an HDF5 file; expected " + wanted + ", which is text");
        if (text.size() > largest_text)
            throw input_error(path + ": is larger than 16 MiB; expected " + wanted);
    }
    if (std::ferror(file.get()))
        throw file_error(path + ": cannot be read: " + std::strerror(errno));
    try {
        return std::string(without_byte_order_mark(text));
    } catch (const input_error& error) {
        throw input_error(path + ": " + error.what());
    }
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
        if (!is_beside_scene(name)) // parse_scene refuses it
            continue;
        const std::filesystem::path beside = std::filesystem::path(path).parent_path() / name;
        if (std::error_code ignored; std::filesystem::is_regular_file(beside, ignored))
            files.push_back({name, beside.string()});
    }
    return files;
}

// A table [[file]].
std::string table_of(const FileBeside& file)
{
    const std::string text = read_field_data(file.path);
    parse_toml("text = " + as_toml(text, ""), file.path); // names the line of what is not UTF-8
    return std::string("\n[[file]] # ") + (is_trace_file(file.path) ? "the lines of that" : "as it was") +
           " beside the scene\nname = " + as_toml(file.name) + "text = " + as_toml(text);
}

// Checked against the network that was made from it, too, if there is one.
Scene parsed(std::string_view text, const std::string& name, const Network* network)
{
    const TomlValue root = parse_toml(text, name);
    Refusals refusals;
    Reading reading{.name = name, .whole = "scene", .refusals = &refusals};
    Scene scene;
    read_parts(scene_parts(), root, reading, scene);
    refusals.end();
    const Source source{root, reading};
    check_scene(scene, source, refusals);
    if (network)
        check_network(scene, source, *network);
    return scene;
}

// Refuses blocks whose corners do not enclose their area: triangulation would not survive them.
void check_areas(const std::string& path, const Blocks& blocks)
{
    for (std::size_t block = 0; block < blocks.block_area.size(); ++block) {
        double area = 0, perimeter = 0; // of the outline less holes; of all rings
        for (Index ring = blocks.block_ring[block]; ring < blocks.block_ring[block + 1]; ++ring) {
            const Polygon corners = ring_of(blocks, ring);
            area += (ring == blocks.block_ring[block] ? 1 : -1) * area_of(corners);
            perimeter += perimeter_of(corners);
        }
        const double stored = blocks.block_area[block];
        if (!(std::abs(area - stored) <= 1e-6 * stored + 1e-9 * perimeter))
            throw input_error(path + ": /blocks/area[" + std::to_string(block) + "] is " + shown(stored) +
                              " m2; expected " + shown(area) + " m2, which its corners enclose");
    }
}

} // namespace

Scene parse_scene(std::string_view text, const std::string& name)
{
    return parsed(text, name, nullptr);
}

Scene parse_scene_of_file(std::string_view text, const std::string& path, const Network& network)
{
    check_areas(path, network.blocks);
    return parsed(text, path + ": /scene", &network);
}

SceneText read_scene(const std::string& path)
{
    SceneText scene{read_text_file(path, "a scene file (.toml)"), {}};
    if (scene.text.empty())
        throw input_error(path + ": is empty; expected a scene");
    scene.text = written_out(scene.text, path);
    for (const FileBeside& file : files_beside(path, scene.text)) {
        scene.text += table_of(file);
        scene.files.push_back(file.path);
    }
    if (scene.text.size() > largest_text)
        throw input_error(path + ": is larger than 16 MiB with the files that it names; expected a scene");
    return scene;
}

std::string read_field_data(const std::string& path)
{
    if (std::error_code ignored; is_trace_file(path) && std::filesystem::is_regular_file(path, ignored))
        try {
            return lines_of_trace_file(path);
        } catch (const input_error& error) {
            throw input_error(path + ": " + error.what());
        }
    std::string text = read_text_file(path, "poles or traces of a scene");
    if (text.find_first_not_of(" \t\r\n") == std::string::npos)
        throw input_error(path + ": is empty; expected poles or traces of a scene");
    return text;
}

std::string read_scene_text(const std::string& path)
{
    return read_scene(path).text;
}

} // namespace jointcreep::scene
