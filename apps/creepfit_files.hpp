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

// As of_file(). But only messages of lines are the file's.
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

// The file for the readings, if asked for. Throws where it, or the output, cannot be written. Throws where an output
// would overwrite an input or another output; those of a search that `may_fail` count too.
std::optional<std::string> readings_file(const Arguments& arguments, bool may_fail);

// Refuses these options if they are given: they go with something else.
void refuse_options(const Arguments& arguments, const std::vector<Option>& options,
                    const std::string& goes_with);

} // namespace jointcreep::creepfit
