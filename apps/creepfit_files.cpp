#include "creepfit_files.hpp"

#include "store/files.hpp"
#include "store/save.hpp"

#include <filesystem>
#include <fstream>
#include <span>
#include <sstream>

namespace jointcreep::creepfit
{

namespace
{

bool is_same_file(const std::string& one, const std::string& other)
{
    std::error_code absent;
    return one == other || std::filesystem::equivalent(one, other, absent);
}

} // namespace

std::string text_of(const std::string& path)
{
    if (std::error_code none; std::filesystem::is_directory(path, none))
        throw file_error(path + ": is a folder");
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    if (!file)
        throw file_error(path + ": cannot be read");
    return text.str();
}

void write(const std::string& path, const std::string& text)
{
    try {
        store::save(path, std::as_bytes(std::span(text)));
    } catch (const file_error& error) {
        throw file_error(path + ": " + error.what());
    }
}

std::optional<std::string> readings_file(const Arguments& arguments)
{
    std::optional<std::string> path = arguments.text("readings");
    if (!path)
        return {};
    for (const std::string& other :
         {arguments.input(), arguments.output(), arguments.text("measurements").value_or("")})
        if (is_same_file(*path, other))
            throw input_error("--readings: " + *path + " is used already; give it another name");
    store::check_writable(*path);
    return path;
}

void refuse_loss(const std::string& failed, const std::vector<std::string>& others)
{
    for (const std::string& other : others)
        if (is_same_file(failed, other))
            throw input_error(
                other +
                ": a search that does not come to its end would be written there; wanted another name");
}

void refuse_options(const Arguments& arguments, const std::vector<Option>& options,
                    const std::string& goes_with)
{
    for (const Option& option : options)
        if (arguments.has(option.name))
            throw input_error("--" + option.name + " goes with " + goes_with);
}

} // namespace jointcreep::creepfit
