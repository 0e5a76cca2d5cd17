#include "model/utf8.hpp"

#include "model/error.hpp"

namespace jointcreep
{

std::optional<std::size_t> utf8_length(std::string_view text)
{
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const auto first = byte(0);
    const std::size_t length = first < 0x80   ? 1
                               : first < 0xc2 ? 0
                               : first < 0xe0 ? 2
                               : first < 0xf0 ? 3
                               : first < 0xf5 ? 4
                                              : 0;
    if (length == 0 || text.size() < length)
        return {};
    for (std::size_t i = 1; i < length; ++i)
        if ((byte(i) & 0xc0) != 0x80)
            return {};
    const bool overlong = (first == 0xe0 && byte(1) < 0xa0) || (first == 0xf0 && byte(1) < 0x90);
    const bool outside = (first == 0xed && byte(1) > 0x9f) || (first == 0xf4 && byte(1) > 0x8f);
    if (overlong || outside)
        return {};
    return length;
}

std::string_view without_byte_order_mark(std::string_view text)
{
    const bool is_marked = text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff");
    const bool has_zero = text.size() > 1 && (text[0] == '\0') != (text[1] == '\0'); // ASCII in UTF-16
    if (is_marked || has_zero)
        throw input_error("the text is UTF-16; expected UTF-8. Save the file as UTF-8");
    if (text.starts_with("\xef\xbb\xbf"))
        text.remove_prefix(3);
    return text;
}

bool is_plain_text(std::string_view text)
{
    while (!text.empty()) {
        const auto length = utf8_length(text);
        if (!length)
            return false;
        const std::string_view character = text.substr(0, *length);
        const auto first = static_cast<unsigned char>(character[0]);
        if (first < 0x20 || first == 0x7f ||
            (first == 0xc2 && static_cast<unsigned char>(character[1]) < 0xa0) ||
            character == "\xef\xbf\xbe" || character == "\xef\xbf\xbf")
            return false;
        text.remove_prefix(*length);
    }
    return true;
}

} // namespace jointcreep
