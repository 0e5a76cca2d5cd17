// Barton and Bandis's joint: the more it is closed the stiffer it is, and the more it is pressed the less
// friction it has.
//
//     p     = k_ni v / (1 - v / V_m)                                      (Bandis, Lumsden, Barton 1983)
//     |tau| <= p tan(phi_r + JRC log10(JCS / p)),  the angle at most 70 degrees and at least phi_r
//                                                                         (Barton, Choubey 1977)
//
// with the pressure p = -sigma_n and the closure v, counted from where it bears nothing. k_ni is the
// stiffness there, V_m the largest closure, JRC the roughness and JCS the strength of the walls, both for
// joints as long as those of the section. It unloads along the curve it was loaded along: that of the first
// cycle. At p = JCS the walls are crushed; from there on the curve goes straight on, as stiff as it is there.
// Shear is a spring k_s up to that limit, without dilation, cohesion or tension. Where strengths are divided
// (strength_factor.hpp) the limit is; closing stays as it is. Signs as in model/signs.hpp.

#pragma once

#include "joint/coulomb.hpp"

#include <numbers>

namespace jointcreep::joint
{

struct BartonBandis {
    double k_n, k_s;        // k_ni and k_s [Pa/m]
    double largest_closure; // V_m [m]
    double residual_angle;  // phi_r [rad]
    double roughness;       // JRC [-]
    double wall_strength;   // JCS [Pa]
    double divisor = 1;     // of the shear strength, above 0 [-]

    // dp/dv at a pressure p [Pa/m].
    double stiffness(double p) const
    {
        const double growth = 1 + std::clamp(p, 0.0, wall_strength) / (k_n * largest_closure);
        return k_n * growth * growth;
    }
    // Closure at a pressure; a negative one is a gap, which counts as k_n times that [m].
    double closure(double p) const
    {
        if (p < 0)
            return p / k_n;
        const double on_curve = std::min(p, wall_strength);
        return on_curve * largest_closure / (k_n * largest_closure + on_curve) +
               (p - on_curve) / stiffness(wall_strength);
    }
    double pressure(double v) const
    {
        if (v < 0)
            return k_n * v;
        const double crushed = closure(wall_strength);
        return v < crushed ? k_n * v / (1 - v / largest_closure)
                           : wall_strength + stiffness(wall_strength) * (v - crushed);
    }
    // The friction angle at a pressure above 0, of the undivided strength [rad].
    double friction_angle(double p) const
    {
        constexpr double deg = std::numbers::pi / 180, steepest = 70 * deg;
        return std::min(residual_angle + roughness * deg * std::max(0.0, std::log10(wall_strength / p)),
                        std::max(steepest, residual_angle));
    }
    double strength(double p) const { return p > 0 ? p * std::tan(friction_angle(p)) / divisor : 0.0; }
    // d(strength)/dp [-].
    double friction(double p) const
    {
        constexpr double deg = std::numbers::pi / 180, steepest = 70 * deg;
        if (!(p > 0))
            return std::tan(std::max(steepest, residual_angle)) / divisor;
        const double angle = friction_angle(p), tan = std::tan(angle);
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
};

// As for Coulomb's law.
inline Response respond(const BartonBandis& law, CoulombState& state, double sigma_0, double tau_0,
                        double u_n, double u_s)
{
    const double p = law.pressure(law.closure(-sigma_0) - u_n);
    const double tau_trial = tau_0 + law.k_s * (u_s - state.slip);
    const double give = law.k_s > 0 ? 1 / law.k_s : 0.0;
    if (p < 0) {
        state.slip += tau_trial * give; // the joint closes again without shear
        return {0, 0, ContactStatus::open};
    }
    const double limit = law.strength(p);
    if (std::abs(tau_trial) < (1 - 1e-6) * limit || tau_trial == 0)
        return {-p, tau_trial, ContactStatus::stuck};
    const double tau = std::copysign(std::min(limit, std::abs(tau_trial)), tau_trial);
    state.slip += (tau_trial - tau) * give;
    return {-p, tau, ContactStatus::slipping};
}

inline bool is_linear(const BartonBandis&)
{
    return false;
}
inline double cohesion(const BartonBandis&)
{
    return 0;
}
inline double tensile_strength(const BartonBandis&)
{
    return 0;
}
inline bool weakens_by_slip(const BartonBandis&)
{
    return false;
}
inline bool dilates(const BartonBandis&)
{
    return false;
}

} // namespace jointcreep::joint
