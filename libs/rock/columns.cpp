#include "rock/columns.hpp"

#include <array>

namespace jointcreep::rock
{

namespace
{

std::vector<fields::Column> zone_columns(const Result& result, std::size_t state)
{
    const std::array<std::string, 3> axes = {"xx", "yy", "xy"};
    const States& states = result.states;
    const std::size_t zones = result.mesh.zone_block.size(), yielding = states.yielding_zone.size();
    std::vector<fields::Column> all;
    for (int i = 0; i < 3; ++i)
        all.push_back(fields::component_column("stress_" + axes[i], "Pa", "/states/stress", states.stress,
                                               state * zones, i));
    if (yielding == 0)
        return all;
    std::vector<Index> number(zones, -1); // of a zone among those that yield
    for (std::size_t i = 0; i < yielding; ++i)
        number[states.yielding_zone[i]] = static_cast<Index>(i);
    for (int i = 0; i < 3; ++i)
        all.push_back({.name = "plastic_strain_" + axes[i],
                       .units = "1",
                       .value = [&states, number, first = state * yielding, i](std::size_t zone) {
                           return number[zone] < 0 ? 0.0 : states.plastic_strain[first + number[zone]][i];
                       }});
    return all;
}

} // namespace

fields::ForceColumns columns_in_exports()
{
    return {.of_zones = zone_columns};
}

} // namespace jointcreep::rock
