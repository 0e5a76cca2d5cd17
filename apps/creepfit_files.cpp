#include "creepfit_files.hpp"

#include "store/files.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>
#include <utility>

namespace jointcreep::creepfit
{

std::string text_of(const std::string& path)
{
    if (std::error_code none; std::filesystem::is_directory(path, none))
        throw file_error(path + ": is a folder");
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    if (!file)
        throw file_error(path + ": cannot be read: " + std::strerror(errno));
    if (!text.view().starts_with("\x89HDF") && text.view().find("[section]") != std::string_view::npos)
        throw input_error(
            path +
            ": this is a scene; expected a table of readings (.csv). Run jointgen and strength-averaging "
            "first, and give joints.h5 with --measurements READINGS.csv");
    return std::move(text).str();
}

std::optional<std::string> readings_file(const Arguments& arguments, bool may_fail)
{
    std::vector<NamedFile> written = arguments.files({"output", "readings"}), failed;
    for (const auto& [path, name] : written) {
        store::check_writable(path);
        const std::string kept = failed_name(path);
        failed.push_back({kept, kept + ", which a search that fails writes,"});
    }
    if (may_fail)
        written.insert(written.end(), failed.begin(), failed.end());
    refuse_overwriting(arguments.files({"input", "measurements"}), written);
    return arguments.text("readings");
}

void refuse_options(const Arguments& arguments, const std::vector<Option>& options,
                    const std::string& goes_with)
{
    for (const Option& option : options)
        if (arguments.has(option.name))
            throw input_error("--" + option.name + " goes with " + goes_with);
}

} // namespace jointcreep::creepfit
