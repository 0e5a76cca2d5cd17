// Tables of text with named columns, as field data come: a line of column names, then rows; fields are separated
// by commas, and may stand in double quotes; empty lines and those that begin with # are left out. Errors are
// input_error that name the line; the caller says which file.

#pragma once

#include "model/quantity.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace jointcreep::scene
{

[[noreturn]] void refuse_line(std::size_t line, const std::string& what);

class Csv
{
public:
    // Views into `text`, which must outlive it.
    explicit Csv(std::string_view text);

    // Refuses a column that has none of these names.
    void allow_only(const std::vector<std::string>& names) const;

    bool has(std::string_view name) const;
    std::size_t column(std::string_view name) const; // refuses if there is none
    const std::vector<std::string_view>& columns() const { return columns_; }
    std::size_t head() const { return head_; } // the line of column names

    struct Row {
        std::size_t line;
        std::vector<std::string_view> field;
    };
    double number(const Row& row, std::string_view name, const Range& range) const;

    std::vector<Row> rows;

private:
    std::vector<std::string_view> columns_;
    std::size_t head_ = 0;
};

} // namespace jointcreep::scene
