// Do records keep to the schema? Asked of records that are to be written as well as of those just read.

#pragma once

#include "store/schema.hpp"

#include <map>
#include <optional>

namespace jointcreep::store::schema
{

// What is wrong, as a message without the file's name; nothing if all is well.
using Fault = std::optional<std::string>;

// Sizes of the dimensions. The first array that has a dimension fixes its size.
class Dimensions
{
public:
    // Is `size` right for the field's axis?
    Fault fault(const fields::Field& field, std::size_t axis, std::size_t size);
    std::size_t size(const std::string& dimension) const { return sizes_.at(dimension); }
    bool has(const std::string& dimension) const { return sizes_.contains(dimension); }

private:
    std::map<std::string, std::size_t> sizes_;
};

// The first fault in sizes, then in values, then between values. Fills `dimensions`.
Fault fault_in(const std::vector<fields::Field>& fields, const std::vector<fields::Invariant>& invariants,
               Dimensions& dimensions);

} // namespace jointcreep::store::schema
