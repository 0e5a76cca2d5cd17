#include "keys/toml_text.hpp"

#include "model/error.hpp"
#include "model/utf8.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>

// toml++ 3.3 meets some broken texts with an assertion, or with "cannot be reached", inside functions that
// may not throw. Both become a clear end of the process here, and assertions stay on in every kind of build.
namespace
{

thread_local std::string text_name;

[[noreturn]] void give_up()
{
    std::fprintf(stderr, "%s: cannot be read as TOML\n", text_name.c_str());
    std::fflush(stderr);
    std::_Exit(2);
}

} // namespace

#undef NDEBUG
#define TOML_ASSERT(condition) (static_cast<bool>(condition) ? void() : give_up())
#define TOML_MAX_NESTED_VALUES 16
#define TOML_ENABLE_FORMATTERS 0
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#include <toml++/impl/preprocessor.h>
#undef TOML_UNREACHABLE
#define TOML_UNREACHABLE give_up()
#include <toml++/toml.h>
#pragma GCC diagnostic pop

namespace jointcreep::keys
{
namespace
{

constexpr int most_dots = 8; // in one key: deep tables would be destroyed by deep recursion
constexpr std::size_t most_brackets = TOML_MAX_NESTED_VALUES; // inside each other
constexpr std::size_t longest_shown = 200;                    // of a value or a parser's message

[[noreturn]] void refuse(const std::string& name, std::int64_t line, const std::string& why)
{
    throw input_error(name + ", line " + std::to_string(line) + ": " + why);
}

std::string shortened(std::string text)
{
    if (text.size() > longest_shown) {
        std::size_t cut = longest_shown;
        while ((text[cut] & 0xc0) == 0x80) // not inside a character
            --cut;
        text.replace(cut, std::string::npos, "...");
    }
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
            c = '?';
    return text;
}

// Refuses what toml++ cannot be trusted with: control characters, what is not UTF-8, characters beyond ASCII
// outside strings and comments, keys of very many parts, and table headers that do not begin with a name.
// Follows strings, comments and brackets as TOML has them.
class TextCheck
{
public:
    TextCheck(std::string_view text, const std::string& name) : rest_(text), name_(name) {}

    void check()
    {
        while (!rest_.empty()) {
            const std::size_t length = check_character();
            const char c = rest_.front();
            rest_.remove_prefix(std::max(length, pass()));
            if (c == '\n')
                ++line_;
        }
    }

private:
    enum class In { plain, comment, basic, literal, long_basic, long_literal };

    std::string_view rest_;
    const std::string& name_;
    In in_ = In::plain;
    std::int64_t line_ = 1;
    int dots_ = 0;              // in the key at hand
    std::string closing_;       // of the open brackets, the innermost last
    bool at_line_start_ = true; // nothing but blanks so far

    bool at_line_end() const { return rest_.front() == '\n' || rest_.starts_with("\r\n"); }

    // Length of the next character in bytes.
    std::size_t check_character() const
    {
        const auto length = utf8_length(rest_);
        if (!length)
            refuse(name_, line_, "a byte that is not UTF-8; expected UTF-8 text");
        const char c = rest_.front();
        if (!at_line_end() && ((c >= 0 && c < 0x20 && c != '\t') || c == 0x7f))
            refuse(name_, line_, "a control character (code " + std::to_string(c) + "); expected text");
        if (*length > 1 && in_ == In::plain)
            refuse(name_, line_,
                   "the character " + std::string(rest_.substr(0, *length)) +
                       " outside a string or comment; keys and numbers are ASCII");
        return *length;
    }

    // Takes account of what comes next; its length in bytes, at least 1.
    std::size_t pass()
    {
        switch (in_) {
        case In::plain:
            return pass_plain();
        case In::comment:
            if (at_line_end()) {
                in_ = In::plain;
                return pass_plain();
            }
            return 1;
        case In::basic:
            return pass_string('"');
        case In::literal:
            return pass_string('\'');
        case In::long_basic:
            return pass_long_string('"');
        case In::long_literal:
            return pass_long_string('\'');
        }
        return 1;
    }

    std::size_t pass_plain()
    {
        const char c = rest_.front();
        if (at_line_start_ && closing_.empty() && c == '[')
            check_header();
        if (c == '\n')
            at_line_start_ = true;
        else if (c != ' ' && c != '\t' && c != '\r')
            at_line_start_ = false;

        if (rest_.starts_with("\"\"\"") || rest_.starts_with("'''")) {
            in_ = c == '"' ? In::long_basic : In::long_literal;
            return 3;
        }
        if (c == '"' || c == '\'')
            in_ = c == '"' ? In::basic : In::literal;
        else if (c == '#')
            in_ = In::comment;
        else if (c == '.' && ++dots_ > most_dots)
            refuse(name_, line_, "a key with too many parts");
        else if (std::string_view("=,[]{}\n").find(c) != std::string_view::npos)
            dots_ = 0;
        pass_bracket(c);
        return 1;
    }

    void pass_bracket(char c)
    {
        if (c == '[' || c == '{') {
            closing_ += c == '[' ? ']' : '}';
            if (closing_.size() > most_brackets)
                refuse(name_, line_, "brackets nested too deep");
        } else if (c == ']' || c == '}') {
            if (closing_.empty() || closing_.back() != c)
                refuse(name_, line_, std::string("a ") + c + " that closes nothing");
            closing_.pop_back();
        }
    }

    void check_header() const
    {
        const auto is_name = [](char c) {
            return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
                   c == '-' || c == '"' || c == '\'';
        };
        auto inside = rest_.substr(rest_.starts_with("[[") ? 2 : 1);
        inside.remove_prefix(std::min(inside.find_first_not_of(" \t"), inside.size()));
        if (inside.empty() || !is_name(inside.front()))
            refuse(name_, line_, "a table without a name; expected [name] or [[name]]");
    }

    std::size_t pass_string(char quote)
    {
        if (at_line_end())
            refuse(name_, line_, "a string without its closing quote");
        if (rest_.front() == quote)
            in_ = In::plain;
        return escape_length(quote);
    }

    std::size_t pass_long_string(char quote)
    {
        if (!rest_.starts_with(std::string(3, quote)))
            return escape_length(quote);
        in_ = In::plain;
        std::size_t quotes = 3; // the string itself may end in two more
        while (quotes < 5 && quotes < rest_.size() && rest_[quotes] == quote)
            ++quotes;
        return quotes;
    }

    // 2 for an escape that could hide the closing quote; only strings in double quotes have escapes.
    std::size_t escape_length(char quote) const
    {
        const bool escapes = quote == '"' && (rest_.starts_with("\\\"") || rest_.starts_with("\\\\"));
        return escapes ? 2 : 1;
    }
};

// Bytes of a text by line and column, both from 1; a column is a character.
class Positions
{
public:
    explicit Positions(std::string_view text) : text_(text), line_{{0, true}}
    {
        for (std::size_t i = 0; i < text.size(); ++i) {
            if (static_cast<unsigned char>(text[i]) >= 0x80)
                line_.back().is_ascii = false;
            if (text[i] == '\n')
                line_.push_back({i + 1, true});
        }
    }
    std::size_t of(const toml::source_position& place) const
    {
        if (place.line < 1 || place.line > line_.size())
            return text_.size();
        const Line& line = line_[place.line - 1];
        const std::size_t column = std::max<std::size_t>(place.column, 1);
        std::size_t at = line.first;
        if (line.is_ascii)
            at += column - 1;
        else
            for (std::size_t passed = 1; passed < column && at < text_.size(); ++passed)
                at += utf8_length(text_.substr(at)).value_or(1);
        return std::min(at, text_.size());
    }

private:
    struct Line {
        std::size_t first; // [byte]
        bool is_ascii;     // a character is a byte
    };
    std::string_view text_;
    std::vector<Line> line_;
};

TomlValue converted(const toml::node& node, const Positions& positions)
{
    TomlValue value;
    value.line = node.source().begin.line;
    value.first = positions.of(node.source().begin);
    value.past = positions.of(node.source().end);
    if (const auto* const flag = node.as_boolean())
        value.content = flag->get();
    else if (const auto* const integer = node.as_integer())
        value.content = integer->get();
    else if (const auto* const number = node.as_floating_point())
        value.content = number->get();
    else if (const auto* const text = node.as_string())
        value.content = text->get();
    else if (const auto* const date = node.as_date())
        value.content =
            TomlValue::Date{std::chrono::year(date->get().year), std::chrono::month(date->get().month),
                            std::chrono::day(date->get().day)};
    else if (const auto* const array = node.as_array()) {
        auto& list = value.content.emplace<TomlValue::List>();
        list.reserve(array->size());
        for (const toml::node& element : *array)
            list.push_back(converted(element, positions));
    } else if (const auto* const entries = node.as_table()) {
        auto& table = value.content.emplace<TomlValue::Table>();
        for (const auto& [key, element] : *entries)
            table.push_back({std::string(key.str()), converted(element, positions)});
    } else
        value.content = TomlValue::Time{};
    return value;
}

} // namespace

const TomlValue* TomlValue::find(std::string_view key) const
{
    if (const auto* const table = std::get_if<Table>(&content))
        for (const TomlEntry& entry : *table)
            if (entry.key == key)
                return &entry.value;
    return nullptr;
}

std::string shown(const TomlValue& value)
{
    struct Shower {
        std::string operator()(bool flag) const { return flag ? "true" : "false"; }
        std::string operator()(std::int64_t integer) const { return std::to_string(integer); }
        std::string operator()(double number) const { return shown(number); }
        std::string operator()(const std::string& text) const { return '"' + shortened(text) + '"'; }
        std::string operator()(const TomlValue::Date& date) const
        {
            std::array<char, 16> text{};
            std::snprintf(text.data(), text.size(), "%04d-%02u-%02u", static_cast<int>(date.year()),
                          static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()));
            return text.data();
        }
        std::string operator()(const TomlValue::Time&) const { return "a time"; }
        std::string operator()(const TomlValue::List& list) const
        {
            const auto is_number = [](const TomlValue& one) {
                return std::holds_alternative<std::int64_t>(one.content) ||
                       std::holds_alternative<double>(one.content);
            };
            if (list.size() == 2 && std::ranges::all_of(list, is_number))
                return "[" + keys::shown(list[0]) + ", " + keys::shown(list[1]) + "]";
            return "a list of " + std::to_string(list.size());
        }
        std::string operator()(const TomlValue::Table&) const { return "a table"; }
    };
    return std::visit(Shower(), value.content);
}

TomlValue parse_toml(std::string_view text, const std::string& name)
{
    try {
        text = without_byte_order_mark(text);
    } catch (const input_error& error) {
        refuse(name, 1, error.what());
    }
    TextCheck(text, name).check();
    text_name = name;
    try {
        return converted(toml::parse(text), Positions(text));
    } catch (const toml::parse_error& error) {
        std::string what = shortened(std::string(error.description()));
        if (what.ends_with("saw ','"))
            what += ". (A decimal number has a point: 0.2, not 0,2. A list is in brackets: [0, 2])";
        else if (what.find("parsing date") != std::string::npos || what.ends_with("exponent, saw '.'"))
            what += ". (A date has year, month, day: 1994-06-15)";
        else if (what.ends_with("could not determine value type"))
            what += ". (A text, also a name of [variables], has double quotes: \"granite\")";
        refuse(name, error.source().begin.line, what);
    }
}

} // namespace jointcreep::keys
