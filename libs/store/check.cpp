#include "store/check.hpp"

#include "model/error.hpp"

#include <cmath>

namespace jointcreep::store::schema
{

namespace
{

using namespace fields;

// A name in a field's dimensions: "block" or, with one element more, "block+1".
struct Axis {
    std::string dimension;
    std::size_t more;
};

Axis axis_of(const std::string& name)
{
    if (name.ends_with("+1"))
        return {name.substr(0, name.size() - 2), 1};
    return {name, 0};
}

// In memory an array with several dimensions shows only the product of their sizes. So other arrays fix these
// sizes, or all except that of the last dimension.
Fault size_fault(const Field& field, Dimensions& dimensions)
{
    const std::size_t count = rows(field.values);
    if (field.dimensions.size() == 1)
        return dimensions.fault(field, 0, count);
    std::size_t expected = 1;
    std::string shape;
    for (const std::string& name : field.dimensions) {
        if (!dimensions.has(name)) {
            if (count > 0 && (expected == 0 || count % expected != 0))
                return field.path + " has " + std::to_string(count) + " rows; expected a multiple of " +
                       std::to_string(expected) + " (" + shape + ")";
            return dimensions.fault(field, field.dimensions.size() - 1, count == 0 ? 0 : count / expected);
        }
        expected *= dimensions.size(name);
        shape += (shape.empty() ? "" : " x ") + name;
    }
    if (count == expected)
        return {};
    return field.path + " has " + std::to_string(count) + " rows; expected " + std::to_string(expected) +
           " (" + shape + ")";
}

// "[row, column]" of a value in the flat array.
std::string position(const Field& field, const Dimensions& dimensions, std::size_t at)
{
    std::vector<std::size_t> extents;
    if (field.dimensions.empty())
        return "";
    for (const std::string& name : field.dimensions)
        extents.push_back(dimensions.size(axis_of(name).dimension) + axis_of(name).more);
    if (components(field.values) > 1)
        extents.push_back(components(field.values));
    std::vector<std::size_t> place(extents.size());
    for (std::size_t axis = extents.size(); axis-- > 0; at /= extents[axis])
        place[axis] = at % extents[axis];
    std::string text;
    for (const std::size_t index : place)
        text.append(text.empty() ? "[" : ", ").append(std::to_string(index));
    return text.append("]");
}

struct Bounds {
    double least, most;
};

Bounds bounds(const Limits& limits, const Dimensions& dimensions)
{
    if (!limits.index_of.empty())
        return {limits.or_none ? -1.0 : 0.0, static_cast<double>(dimensions.size(limits.index_of)) - 1};
    if (limits.positive)
        return {std::numeric_limits<double>::denorm_min(), limits.most};
    return {limits.least, limits.most};
}

template <class Number>
Fault value_fault(const Field& field, const Dimensions& dimensions, std::span<Number> values)
{
    const Limits& limits = field.limits;
    const auto [least, most] = bounds(limits, dimensions);
    const auto fault = [&](std::size_t at) {
        std::string text = field.path + position(field, dimensions, at) + " is " + shown(values[at]) +
                           "; expected " + wanted(limits);
        if (!limits.index_of.empty())
            text += " (there are " + std::to_string(dimensions.size(limits.index_of)) + ")";
        if (limits.ascending && at > 0)
            text += "; the value before is " + shown(values[at - 1]);
        return text;
    };
    for (std::size_t at = 0; at < values.size(); ++at) {
        const double value = values[at];
        if (!std::isfinite(value) || value < least || value > most)
            return fault(at);
        if (limits.ascending && at > 0 && values[at] < values[at - 1])
            return fault(at);
    }
    if (limits.rows_of.empty())
        return {};
    if (values.front() != 0)
        return fault(0);
    if (static_cast<std::size_t>(values.back()) != dimensions.size(limits.rows_of))
        return fault(values.size() - 1) + " (" + std::to_string(dimensions.size(limits.rows_of)) + ")";
    return {};
}

Fault value_fault(const Field& field, const Dimensions& dimensions, std::span<std::string> values)
{
    for (std::size_t at = 0; at < values.size(); ++at)
        if (values[at].find('\0') != std::string::npos)
            return field.path + position(field, dimensions, at) + " holds a zero byte; expected text";
    return {};
}

} // namespace

Fault Dimensions::fault(const Field& field, std::size_t axis, std::size_t size)
{
    const auto [dimension, more] = axis_of(field.dimensions[axis]);
    const auto message = [&](const std::string& expected) {
        return field.path + " has " + std::to_string(size) + " rows along " + field.dimensions[axis] +
               "; expected " + expected;
    };
    if (size < more)
        return message("at least " + std::to_string(more));
    const std::size_t expected = sizes_.try_emplace(dimension, size - more).first->second + more;
    if (size != expected)
        return message(std::to_string(expected));
    return {};
}

Fault fault_in(const std::vector<Field>& fields, const std::vector<Invariant>& invariants,
               Dimensions& dimensions)
{
    for (const Field& field : fields)
        if (Fault fault = size_fault(field, dimensions))
            return fault;
    for (const Field& field : fields)
        if (Fault fault = std::visit([&](auto values) { return value_fault(field, dimensions, values); },
                                     flat(field.values)))
            return fault;
    for (const Invariant& invariant : invariants) {
        const std::size_t count = dimensions.size(invariant.dimension);
        for (std::size_t row = 0; row < count; ++row)
            if (!invariant.holds(row))
                return invariant.path + ", row " + std::to_string(row) + ": it must hold that " +
                       invariant.sentence;
    }
    return {};
}

} // namespace jointcreep::store::schema
