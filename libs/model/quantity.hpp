// What is known of a number that a person writes or reads: its unit and the values it may have. Scene keys
// (libs/keys/keys.hpp) and parameters of joint laws (libs/joint/parameter.hpp) are declared with these.

#pragma once

#include "model/units.hpp"

#include <string_view>

namespace jointcreep
{

// A unit as the user sees it, and what one of it is in SI units.
struct KeyUnit {
    std::string_view symbol; // "" without unit
    double in_si = 1;
    std::string_view si = "1"; // the SI unit, as files write it
};

// Allowed values, in the unit that goes with it: from(0) and above(0), then .to(1) or .below(1). Every range
// is finite.
struct Range {
    double least = 0, most = 0;
    bool least_open = false, most_open = false;

    constexpr Range to(double bound) const { return {least, bound, least_open, false}; }
    constexpr Range below(double bound) const { return {least, bound, least_open, true}; }
    constexpr bool holds(double value) const // false for NaN
    {
        return (least_open ? value > least : value >= least) && (most_open ? value < most : value <= most);
    }
};
constexpr Range from(double bound)
{
    return {bound, bound, false, false};
}
constexpr Range above(double bound)
{
    return {bound, bound, true, false};
}
constexpr Range within(double bound)
{
    return from(-bound).to(bound);
}

// Units of keys.
inline constexpr KeyUnit no_unit{}, degrees{"deg", unit::deg, "rad"}, days{"days", unit::day, "s"},
    metres{"m", unit::m, "m"}, millimetres{"mm", unit::mm, "m"}, MPa{"MPa", unit::MPa, "Pa"},
    MPa_per_m{"MPa/m", unit::MPa / unit::m, "Pa/m"};

} // namespace jointcreep
