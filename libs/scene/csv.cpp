#include "scene/csv.hpp"

#include "keys/keys.hpp"
#include "model/error.hpp"
#include "model/utf8.hpp"

#include <algorithm>
#include <charconv>

namespace jointcreep::scene
{

namespace
{

std::string_view trimmed(std::string_view text)
{
    const auto is_space = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
    while (!text.empty() && is_space(text.front()))
        text.remove_prefix(1);
    while (!text.empty() && is_space(text.back()))
        text.remove_suffix(1);
    return text;
}

std::vector<std::string_view> fields_of(std::string_view line, std::size_t number)
{
    std::vector<std::string_view> fields;
    while (true) {
        line = trimmed(line);
        std::string_view field;
        if (line.starts_with('"')) {
            const auto end = line.find('"', 1);
            if (end == std::string_view::npos)
                refuse_line(number, "a field begins with \" and does not end");
            field = line.substr(1, end - 1);
            line = trimmed(line.substr(end + 1));
            if (!line.empty() && line.front() != ',')
                refuse_line(number, "expected a comma after a field in double quotes");
        } else {
            field = trimmed(line.substr(0, line.find(',')));
            line.remove_prefix(std::min(line.size(), line.find(',')));
        }
        fields.push_back(field);
        if (line.empty())
            return fields;
        line.remove_prefix(1);
    }
}

} // namespace

void refuse_line(std::size_t line, const std::string& what)
{
    throw input_error("line " + std::to_string(line) + ": " + what);
}

Csv::Csv(std::string_view text)
{
    text = without_byte_order_mark(text);
    for (std::size_t line = 1; !text.empty(); ++line) {
        const std::string_view whole = text.substr(0, text.find('\n'));
        text.remove_prefix(std::min(text.size(), whole.size() + 1));
        if (trimmed(whole).empty() || trimmed(whole).front() == '#')
            continue;
        Row row{line, fields_of(whole, line)};
        if (columns_.empty()) {
            columns_ = std::move(row.field);
            head_ = line;
        } else {
            if (row.field.size() != columns_.size())
                refuse_line(line, "has " + std::to_string(row.field.size()) + " fields; expected " +
                                      std::to_string(columns_.size()) + ", as in line " +
                                      std::to_string(head_));
            rows.push_back(std::move(row));
        }
    }
    if (rows.empty())
        throw input_error("expected a line of column names, and rows");
    for (const std::string_view name : columns_)
        if (std::count(columns_.begin(), columns_.end(), name) > 1)
            refuse_line(head_, "has the column " + std::string(name) + " more than once");
}

void Csv::allow_only(const std::vector<std::string>& names) const
{
    for (const std::string_view column : columns_)
        if (std::find(names.begin(), names.end(), column) == names.end()) {
            std::string all;
            for (const std::string& name : names)
                all += (all.empty() ? "" : ", ") + name;
            refuse_line(head_, "has a column " + std::string(column) + "; expected none but " + all);
        }
}

bool Csv::has(std::string_view name) const
{
    return std::find(columns_.begin(), columns_.end(), name) != columns_.end();
}

std::size_t Csv::column(std::string_view name) const
{
    const auto found = std::find(columns_.begin(), columns_.end(), name);
    if (found == columns_.end())
        refuse_line(head_, "expected a column " + std::string(name));
    return static_cast<std::size_t>(found - columns_.begin());
}

double Csv::number(const Row& row, std::string_view name, const Range& range) const
{
    const std::string_view field = row.field[column(name)];
    std::string_view digits = field;
    if (digits.starts_with('+') && !digits.starts_with("+-")) // as spreadsheets may write
        digits.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc{} || end != digits.data() + digits.size() || !range.holds(value))
        refuse_line(row.line, std::string(name) + " is \"" + std::string(field) +
                                  "\"; expected a number in " + keys::shown(range, no_unit));
    return value;
}

} // namespace jointcreep::scene
