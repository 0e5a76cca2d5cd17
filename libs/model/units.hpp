// Every number inside the programs is in SI base units; angles are radians.
// A number in another unit exists only at the border, in a scene key or a printed line, and says its unit.
//
//     const double k_n = 690 * MPa / m;
//     print(stress / MPa, "MPa");

#pragma once

#include <numbers>

namespace jointcreep::unit
{

inline constexpr double m = 1.0, mm = 1e-3 * m;
inline constexpr double s = 1.0, day = 86400 * s;
inline constexpr double kg = 1.0;
inline constexpr double Pa = 1.0, MPa = 1e6 * Pa, GPa = 1e9 * Pa;
inline constexpr double deg = std::numbers::pi / 180.0;

} // namespace jointcreep::unit
