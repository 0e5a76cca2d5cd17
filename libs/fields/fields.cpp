#include "fields/fields.hpp"

#include "model/error.hpp"

#include <cmath>

namespace jointcreep::fields
{

Limits any()
{
    return {};
}

Limits positive()
{
    return {.positive = true};
}

Limits at_least(double least)
{
    return {.least = least};
}

Limits between(double least, double most)
{
    return {.least = least, .most = most};
}

Limits index_of(std::string dimension)
{
    return {.index_of = std::move(dimension)};
}

Limits index_or_none(std::string dimension)
{
    return {.index_of = std::move(dimension), .or_none = true};
}

Limits ascending()
{
    return {.least = 0, .ascending = true};
}

Limits rows_in(std::string dimension)
{
    return {.least = 0, .ascending = true, .rows_of = std::move(dimension)};
}

std::string wanted(const Limits& limits)
{
    if (!limits.index_of.empty())
        return "index of " + limits.index_of + (limits.or_none ? " or -1" : "");
    if (!limits.rows_of.empty())
        return "0, not decreasing, up to the number of " + limits.rows_of + "s";
    std::string text = "finite";
    if (limits.positive)
        text = "> 0";
    else if (std::isfinite(limits.least) && std::isfinite(limits.most))
        text = shown(limits.least) + " to " + shown(limits.most);
    else if (std::isfinite(limits.least))
        text = ">= " + shown(limits.least);
    return limits.ascending ? text + ", not decreasing" : text;
}

namespace
{

template <int rows>
std::span<double> spread(std::vector<Eigen::Matrix<double, rows, 1>>& values)
{
    static_assert(sizeof values[0] == rows * sizeof(double));
    return {reinterpret_cast<double*>(values.data()), rows * values.size()};
}

template <std::size_t size>
std::span<Index> spread(std::vector<std::array<Index, size>>& values)
{
    static_assert(sizeof values[0] == size * sizeof(Index));
    return {reinterpret_cast<Index*>(values.data()), size * values.size()};
}

template <class Value>
std::span<Value> spread(std::vector<Value>& values)
{
    return values;
}

template <class Value>
std::span<Value> spread(Value& value)
{
    return {&value, 1};
}

template <class Value>
void resize_array(std::vector<Value>& values, std::size_t count)
{
    values.resize(count);
}

template <class Value>
void resize_array(Value&, std::size_t)
{
    // a single value
}

template <class Value>
inline constexpr std::size_t components_in = 1;
template <int rows>
inline constexpr std::size_t components_in<std::vector<Eigen::Matrix<double, rows, 1>>> = rows;
template <std::size_t size>
inline constexpr std::size_t components_in<std::vector<std::array<Index, size>>> = size;

} // namespace

Flat flat(const Values& values)
{
    return std::visit([](auto* place) -> Flat { return spread(*place); }, values);
}

std::size_t components(const Values& values)
{
    return std::visit([](auto* place) { return components_in<std::remove_reference_t<decltype(*place)>>; },
                      values);
}

std::size_t rows(const Values& values)
{
    return std::visit([](auto span) { return span.size(); }, flat(values)) / components(values);
}

void resize(const Values& values, std::size_t count)
{
    std::visit([count](auto* place) { resize_array(*place, count); }, values);
}

} // namespace jointcreep::fields
