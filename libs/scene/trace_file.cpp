#include "scene/trace_file.hpp"

#include "model/error.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <filesystem>

namespace jointcreep::scene
{

namespace
{

constexpr const char* module_name = "jointcreep_gdal.so";

// Beside the program, as in a build, or in the folder of libraries, as installed.
std::filesystem::path find_module()
{
    std::error_code ignored;
    const std::filesystem::path folder =
        std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path();
    for (const std::filesystem::path& path :
         {folder / module_name, folder.parent_path() / JOINTCREEP_MODULES / module_name})
        if (std::filesystem::exists(path, ignored))
            return path;
    throw input_error(
        "is a GeoPackage, a Shapefile or a DXF file. They need GDAL, which was not found when the programs were built. "
        "Install libgdal-dev (sh pipelines/setup.sh exchange) and build again, or make it GeoJSON");
}

} // namespace

bool is_trace_file(const std::string& path)
{
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    constexpr std::array<const char*, 3> known{".gpkg", ".shp", ".dxf"};
    return std::find(known.begin(), known.end(), extension) != known.end();
}

std::string lines_of_trace_file(const std::string& path)
{
    const std::filesystem::path module = find_module();
    void* const loaded = dlopen(module.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!loaded)
        throw file_error(std::string("GDAL cannot be loaded: ") + dlerror());
    using Lines = void (*)(const std::string& path, std::string& text);
    const auto lines = reinterpret_cast<Lines>(dlsym(loaded, "jointcreep_lines_of_trace_file"));
    if (!lines)
        throw file_error(module.string() + ": is of another version; build the programs again");
    std::string text;
    lines(path, text);
    return text;
}

} // namespace jointcreep::scene
