// Common part of laws with friction only, without bonds and dilation. Such a law gives the pressure p at a closing, its
// stiffness(p), the energy stored(p) and the strength(p, state).

#pragma once

#include "joint/along_overlap.hpp"
#include "joint/coulomb.hpp"

#include <string>
#include <string_view>

namespace jointcreep::joint
{

template <class Law>
concept FrictionOnly = requires(const Law& law, double number, const State& state)
{
    law.pressure(number);
    law.stiffness(number);
    law.stored(number);
    law.strength(number, state);
};

// The error for a material of this law with bonds or dilation.
inline std::optional<Complaint> complaint_of_more_than_friction(std::string_view law, const ValueOf& value)
{
    using namespace parameters;
    for (const Parameter& none :
         {parameters::cohesion, parameters::tensile_strength, dilation_angle, parameters::dilation_until})
        if (value(none) != 0)
            return Complaint{none, "expected 0 of a " + std::string(law) + " joint, which has none"};
    return {};
}

inline double stored(const FrictionOnly auto& law, double sigma_n, double tau)
{
    return law.stored(-sigma_n) + (law.k_s > 0 ? tau * tau / law.k_s / 2 : 0.0);
}
inline AlongOverlap along_overlap(const FrictionOnly auto& law, const State& state,
                                  const std::array<double, 2>& closing, double length)
{
    return along_by_quadrature(law, state, closing, length);
}
inline double cohesion(const FrictionOnly auto&)
{
    return 0;
}
inline double tensile_strength(const FrictionOnly auto&)
{
    return 0;
}
inline bool weakens_by_slip(const FrictionOnly auto&)
{
    return false;
}
inline bool dilates(const FrictionOnly auto&)
{
    return false;
}
inline double dilation_end(const FrictionOnly auto&)
{
    return 0;
}
template <FrictionOnly Law>
Law unbonded(const Law& law)
{
    return law;
}

} // namespace jointcreep::joint
