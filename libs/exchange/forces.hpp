// The kinds of force that have columns in exports: this is the one list of them. Each has a folder of its own.
//
// To add one: write its columns_in_exports(), and add it to the list. All formats follow.

#pragma once

#include "joint/columns.hpp"
#include "rock/columns.hpp"

#include <type_traits>

namespace jointcreep::exchange
{

// In the order in which their columns are written.
inline const std::vector<fields::ForceColumns>& forces()
{
    static const std::vector<fields::ForceColumns> all{rock::columns_in_exports(),
                                                       joint::columns_in_exports()};
    return all;
}

// The columns of all forces: columns_of(&ForceColumns::of_zones, result, state). They refer to the records.
template <class... Records>
std::vector<fields::Column> columns_of(fields::ColumnsOf<Records...> fields::ForceColumns::*part,
                                       std::type_identity_t<Records>... records)
{
    std::vector<fields::Column> all;
    for (const fields::ForceColumns& force : forces())
        if (force.*part)
            for (fields::Column& column : (force.*part)(records...))
                all.push_back(std::move(column));
    return all;
}

} // namespace jointcreep::exchange
