// Text as the programs read and write it: UTF-8.

#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace jointcreep
{

// Length in bytes of the character that a text, not empty, begins with; none if it is not UTF-8.
std::optional<std::size_t> utf8_length(std::string_view text);

// The text without a byte order mark. Throws input_error, without the file's name, on UTF-16.
std::string_view without_byte_order_mark(std::string_view text);

// Whether a text can be part of any file, XML among them: UTF-8 without control characters, U+FFFE and U+FFFF.
bool is_plain_text(std::string_view text);

} // namespace jointcreep
