// Files that creepfit reads and writes, and the names that it refuses.

#pragma once

#include "program.hpp"

#include "model/error.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace jointcreep::creepfit
{

// Throws file_error.
std::string text_of(const std::string& path);

// Whatever refuses what is in a file names the file.
template <class Read>
auto of_file(const std::string& path, const Read& read)
{
    try {
        return read();
    } catch (const input_error& error) {
        const std::string_view message = error.what();
        throw input_error(path + (message.starts_with("line ") ? ", " : ": ") + error.what());
    }
}

// The same, where other things may be refused, too.
template <class Read>
auto of_lines_of_file(const std::string& path, const Read& read)
{
    try {
        return read();
    } catch (const input_error& error) {
        if (const std::string_view message = error.what(); message.starts_with("line "))
            throw input_error(path + ", " + error.what());
        throw;
    }
}

// Where to write the readings. Throws where it, or the output, could not be written, or one of them, or what is kept
// of a search that `may_fail`, would be written over a file that is read, or over each other.
std::optional<std::string> readings_file(const Arguments& arguments, bool may_fail);

// Refuses options that go with something else.
void refuse_options(const Arguments& arguments, const std::vector<Option>& options,
                    const std::string& goes_with);

} // namespace jointcreep::creepfit
