// An HDF5 file of plain arrays in one group, as formats of other programs have them.

#pragma once

#include "model/statistics.hpp"

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace jointcreep::store
{

using PlainValues = std::variant<std::span<const double>, std::span<const Index>,
                                 std::span<const std::int64_t>, std::span<const unsigned char>>;
struct PlainArray {
    std::string path;
    std::size_t components; // above 1: a second dimension
    PlainValues values;
};

// The bytes of the file, the same for the same arrays. Attributes are those of the group.
std::string hdf5_of(const std::vector<PlainArray>& arrays, const std::string& group,
                    const std::map<std::string, std::string>& texts,
                    const std::map<std::string, std::vector<std::int64_t>>& numbers);

} // namespace jointcreep::store
