// Barton and Bandis's joint: its stiffness grows with closure, and its friction angle falls with pressure.
//
//     p     = k_ni v / (1 - v / V_m)                                      (Bandis, Lumsden, Barton 1983)
//     |tau| <= p tan(phi_r + JRC log10(JCS / p)),  the angle at most 70 degrees and at least phi_r
//                                                                         (Barton, Choubey 1977)
//
// with the pressure p = -sigma_n and the closure v from the point without load. k_ni is the stiffness there and V_m the
// largest closure. JRC is the roughness and JCS the strength of the walls, both for joints as long as those of the
// section. Unloading follows the loading curve: that of the first cycle. At p = JCS the walls are crushed; beyond it
// the curve is linear, with the stiffness at that point. Shear is a spring k_s up to the limit, without dilation,
// cohesion or tension. A strength factor (strength_factor.hpp) divides the limit; closing does not change. Signs as in
// model/signs.hpp.

#pragma once

#include "joint/friction_only.hpp"

#include <numbers>

namespace jointcreep::joint
{

namespace parameters
{

inline const Parameter roughness{
    "roughness",
    "joint_roughness_coefficient",
    no_unit,
    from(0).to(30),
    WithBridges::refused,
    WithStrengthDivided::same,
    "JRC, the roughness of the joint. JRC, JCS and V_m together select Barton and Bandis's law. The normal "
    "stiffness is then the initial one, at zero normal stress, and the friction angle is the residual one. "
    "Cohesion, tensile strength and dilation angle are 0."};
inline const Parameter wall_strength{"wall_strength",
                                     "joint_wall_strength_MPa",
                                     MPa,
                                     above(0).to(1e4),
                                     WithBridges::refused,
                                     WithStrengthDivided::same,
                                     "JCS, the compressive strength of the joint walls."};
inline const Parameter largest_closure{"largest_closure",
                                       "largest_closure_mm",
                                       millimetres,
                                       above(0).to(1000),
                                       WithBridges::refused,
                                       WithStrengthDivided::same,
                                       "V_m, the largest closure of the joint."};

} // namespace parameters

template <class T = double>
struct BartonBandisOf {
    T k_n, k_s;             // k_ni and k_s [Pa/m]
    double largest_closure; // V_m [m]
    double residual_angle;  // phi_r [rad]
    double roughness;       // JRC [-]
    double wall_strength;   // JCS [Pa]
    double divisor = 1;     // of the shear strength, above 0 [-]

    static constexpr double deg = std::numbers::pi / 180, steepest = 70 * deg;

    // dp/dv at a pressure p [Pa/m].
    T stiffness(const T& p) const
    {
        const T growth = 1 + std::clamp<T>(p, 0, wall_strength) / (k_n * largest_closure);
        return k_n * growth * growth;
    }
    // Closure at a pressure [m]; for a tension it is negative, a gap of tension over k_n.
    T closure(const T& p) const
    {
        if (p < 0)
            return p / k_n;
        const T on_curve = std::min<T>(p, wall_strength);
        return on_curve * largest_closure / (k_n * largest_closure + on_curve) +
               (p - on_curve) / stiffness(wall_strength);
    }
    T pressure(const T& v) const
    {
        if (v < 0)
            return k_n * v;
        const T crushed = closure(wall_strength);
        return v < crushed ? k_n * v / (1 - v / largest_closure)
                           : wall_strength + stiffness(wall_strength) * (v - crushed);
    }
    // The friction angle at a pressure above 0, of the undivided strength [rad].
    T friction_angle(const T& p) const
    {
        using std::log10;
        return std::min<T>(residual_angle + roughness * deg * std::max<T>(0, log10(wall_strength / p)),
                           std::max(steepest, residual_angle));
    }
    T strength(const T& p, const State& = {}) const
    {
        using std::tan;
        return p > 0 ? p * tan(friction_angle(p)) / divisor : T(0);
    }
    // d(strength)/dp [-].
    double friction(double p) const
    {
        if (!(p > 0))
            return std::tan(std::max(steepest, residual_angle)) / divisor;
        const double angle = value_of(friction_angle(p)), tan = std::tan(angle);
        const bool changes = p < wall_strength && angle < steepest;
        return (tan - (changes ? roughness * deg / std::numbers::ln10 * (1 + tan * tan) : 0.0)) / divisor;
    }
    // Work of closing it to p [J/m2].
    double stored(double p) const
    {
        if (!(p > 0))
            return 0;
        const double on_curve = std::min(p, wall_strength), v = closure(on_curve), beyond = p - on_curve;
        return -k_n * largest_closure * (v + largest_closure * std::log1p(-v / largest_closure)) +
               beyond * (on_curve + beyond / 2) / stiffness(wall_strength);
    }

    template <class U>
    BartonBandisOf<U> with_springs(const U& normal, const U& shear) const
    {
        return {normal, shear, largest_closure, residual_angle, roughness, wall_strength, divisor};
    }

    static BartonBandisOf from(const ValueOf& value, double divisor)
    {
        using namespace parameters;
        return {value(normal_stiffness),
                value(shear_stiffness),
                value(parameters::largest_closure),
                value(parameters::friction_angle),
                value(parameters::roughness),
                value(parameters::wall_strength),
                divisor};
    }
    static const LawInfo& info()
    {
        using namespace parameters;
        // phi_r alone is not the strength: the strength as a whole is divided.
        static const LawInfo info{
            .name = "Barton-Bandis",
            .about =
                "Barton-Bandis, whose friction angle is phi_r and whose normal stiffness is that without pressure",
            .parameters = {normal_stiffness, shear_stiffness, parameters::cohesion,
                           changed(parameters::friction_angle, WithBridges::refused,
                                   WithStrengthDivided::same),
                           parameters::tensile_strength, dilation_angle, dilation_until,
                           parameters::roughness, parameters::wall_strength, parameters::largest_closure},
            .own = {"roughness", "wall_strength", "largest_closure"},
            .creeps = false,
            .no_sensitivities = "their normal stiffness depends on the pressure",
            .check = [](const ValueOf& value) -> std::optional<Complaint> {
                if (auto complaint = complaint_of_more_than_friction("Barton-Bandis", value))
                    return complaint;
                if (value(parameters::friction_angle) >= steepest)
                    return Complaint{parameters::friction_angle,
                                     "expected less than 70 of a Barton-Bandis joint"};
                return {};
            }};
        return info;
    }
};
using BartonBandis = BartonBandisOf<>;

template <class T>
ResponseOf<T> respond(const BartonBandisOf<T>& law, StateOf<T>& state, const Value<T>& sigma_0,
                      const Value<T>& tau_0, const Value<T>& u_n, const Value<T>& u_s)
{
    using std::abs, std::copysign;
    const T p = law.pressure(law.closure(-sigma_0) - u_n);
    const T tau_trial = tau_0 + law.k_s * (u_s - state.slip);
    const T give = law.k_s > 0 ? 1 / law.k_s : T(0);
    if (!(p > 0)) {
        state.slip += tau_trial * give; // the joint closes again without shear
        return {0, 0, ContactStatus::open};
    }
    const T limit = law.strength(p);
    if (abs(tau_trial) < (1 - 1e-6) * limit || tau_trial == 0)
        return {-p, tau_trial, ContactStatus::stuck};
    const T tau = copysign(std::min<T>(limit, abs(tau_trial)), tau_trial);
    state.slip += (tau_trial - tau) * give;
    return {-p, tau, ContactStatus::slipping};
}
inline Slopes slopes(const BartonBandis& law, const State&, double sigma_n)
{
    const double p = -sigma_n, friction = law.friction(p);
    return {law.stiffness(p), law.k_s, friction, 0, law.strength(p) - friction * p};
}
template <class T>
T normal_traction(const BartonBandisOf<T>& law, const Value<T>& sigma_0, const Value<T>& u)
{
    return -law.pressure(law.closure(-sigma_0) - u);
}
template <class T>
T opening(const BartonBandisOf<T>& law, const Value<T>& sigma_0)
{
    return -law.closure(-sigma_0);
}
inline bool stiffens(const BartonBandis&)
{
    return true;
}

} // namespace jointcreep::joint
