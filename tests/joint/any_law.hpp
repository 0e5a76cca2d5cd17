// Any joint law, for what must hold of all of them.

#pragma once

#include "joint/law.hpp"

#include <rapidcheck.h>

#include <map>

namespace jointcreep::test
{

// A law with parameters within their ranges, by its place in the list.
inline joint::Law some_law(Index place)
{
    const std::map<std::string_view, double> values{
        {"normal_stiffness", 1e9},       {"shear_stiffness", 5e8},         {"cohesion", 1e5},
        {"friction_angle", 0.5},         {"tensile_strength", 5e4},        {"dilation_angle", 0.1},
        {"residual_cohesion", 2e4},      {"residual_friction_angle", 0.3}, {"roughness", 10},
        {"wall_strength", 1e8},          {"largest_closure", 5e-3},        {"dilation_wear", 5e-4},
        {"initial_friction_angle", 0.7}, {"roughness_length", 2.0371e-3}};
    return joint::law_of(
        place,
        [&](const joint::Parameter& parameter) {
            const auto found = values.find(parameter.name);
            return found == values.end() ? 0.0 : found->second;
        },
        1);
}

// Such a joint is not elastic below its strength.
inline bool yields_from_the_first_shear(const joint::Law& law)
{
    return std::holds_alternative<joint::ContinuouslyYielding>(law);
}

inline Index places()
{
    return static_cast<Index>(joint::laws().size());
}

// From all of the range in every case; by itself rapidcheck begins with a small part of it.
inline Index any_in(Index from, Index to)
{
    return *rc::gen::resize(rc::kNominalSize, rc::gen::inRange(from, to));
}

// Between -scale and scale, of its unit.
inline double any_number(double scale)
{
    return scale * any_in(-1000, 1001) / 1000.0;
}

} // namespace jointcreep::test
