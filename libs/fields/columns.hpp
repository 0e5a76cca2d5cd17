// Columns of exports: a number for each edge, zone or contact, which a kind of force gives by name. Each format
// writes them in its own form.
//
//     fields::ForceColumns columns_in_exports()
//     {
//         return {.of_zones = zone_columns};
//     }

#pragma once

#include "model/network.hpp"
#include "model/result.hpp"

#include <functional>
#include <string>
#include <vector>

namespace jointcreep::fields
{

// A column; of one state, where rows have several. It refers to the record.
struct Column {
    std::string name;
    std::string units; // SI: "Pa", "Pa s/m"; "1" for numbers without one
    std::function<double(std::size_t row)> value;
    bool is_integer = false;
    // Where a result file has it, for formats that only point there: [state, row], or one of several components
    // [state, row, component]. Empty if no dataset has a value for every row.
    std::string dataset{};
    std::size_t components = 1, component = 0;
};

// A component of the vectors in a dataset [state, row]; those of the state begin at `first`.
template <class Vector>
Column component_column(const std::string& name, const std::string& units, const std::string& dataset,
                        const std::vector<Vector>& values, std::size_t first, int component)
{
    return {.name = name,
            .units = units,
            .value = [&values, first, component](std::size_t row) { return values[first + row][component]; },
            .dataset = dataset,
            .components = static_cast<std::size_t>(Vector::RowsAtCompileTime),
            .component = static_cast<std::size_t>(component)};
}

template <class... Records>
using ColumnsOf = std::vector<Column> (*)(Records...);

// The columns that one kind of force has; any may be none.
struct ForceColumns {
    ColumnsOf<const EquivalentJoints&> of_edges = nullptr;       // all edges, with their joint properties
    ColumnsOf<const Result&, std::size_t> of_zones = nullptr;    // all zones, in a state
    ColumnsOf<const Result&, std::size_t> of_contacts = nullptr; // all contacts, in a state
};

} // namespace jointcreep::fields
