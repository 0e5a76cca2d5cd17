// The continuously yielding joint (Cundall and Hart 1984; Cundall and Lemos 1990: Numerical simulation of fault
// instabilities with the continuously yielding joint model). It yields from the first shear on, and shear makes it
// smooth.
//
//     d(tau) = F k_s d(u_s),    F = (1 - tau / tau_m) / (1 - r) <= 1,   tau_m = p tan(phi_m), along d(u_s)
//     phi_m  = phi + (phi_i - phi) exp(-u_p / R),                       d(u_p) = (1 - F) |d(u_s)|
//
// The limit |tau| <= tau_m also holds where tau_m falls. The pressure is p = -sigma_n, phi the friction angle of the
// smooth joint, phi_i that of the rough joint at the start, and R the roughness, a length. r is tau / tau_m at the last
// reversal of shear, at most 0.75, and 0 before the first one. At a reversal the joint is as stiff as its spring. The
// springs are constant (the exponents of Cundall and Lemos are 0). The joint has no dilation, cohesion or tensile
// strength.
//
// Creep changes the spring of the response. It does not change the plastic part of the displacement:
//
//     d(u_s) = d(tau) / k_s + d(u_p),    d(u_p) = (1 / F - 1) d(tau) / k_p,    k_p the spring without creep
//
// The path is integrated in parts shorter than a fortieth of R (1000 at most), each exactly, with phi_m at its middle.

#pragma once

#include "joint/friction_only.hpp"

namespace jointcreep::joint
{

namespace parameters
{

inline const Parameter initial_friction_angle{
    "initial_friction_angle",
    "initial_friction_angle_deg",
    degrees,
    frictions,
    WithBridges::refused,
    WithStrengthDivided::tangent,
    "Friction angle of the rough joint before the first slip, at least the friction angle. It and the "
    "roughness length R select the continuously yielding law (Cundall and Lemos 1990). Cohesion, tensile "
    "strength and dilation angle are then 0."};
inline const Parameter roughness_length{
    "roughness_length",
    "roughness_length_mm",
    millimetres,
    above(0).to(1e4),
    WithBridges::refused,
    WithStrengthDivided::same,
    "Roughness length R. The friction angle decreases from the initial one to that of the smooth joint. The "
    "difference is in proportion to exp(-u_p / R), with the plastic shear displacement u_p."};

} // namespace parameters

// memory: u_p [m]; the last tau [Pa]; the direction of shear, 1 or -1, times 2 + r [-], or 0 before any shear: tau is
// then the initial one.
template <class T = double>
struct ContinuouslyYieldingOf {
    T k_n, k_s;              // [Pa/m]
    double plastic_k_s;      // k_p [Pa/m]
    double friction_angle;   // phi [rad]
    double initial_angle;    // phi_i [rad]
    double roughness_length; // R [m]

    T tan_phi_m(const T& u_p) const
    {
        using std::exp, std::tan;
        return tan(friction_angle + (initial_angle - friction_angle) * exp(-u_p / roughness_length));
    }
    // Of a closed joint.
    T stiffness(const T&) const { return k_n; }
    T pressure(const T& closing) const { return k_n * closing; }
    double stored(double p) const { return p > 0 ? p * p / k_n / 2 : 0.0; }
    double strength(double p, const State& state) const
    {
        return p > 0 ? p * tan_phi_m(state.memory[0]) : 0.0;
    }

    // The traction along the shear after `by` [m] more, from `tau`, with constant tau_m.
    T after(const T& tau, const T& by, const T& tau_m, const T& r) const
    {
        using std::exp;
        if (tau >= tau_m)
            return tau_m;
        const T elastic = std::max<T>(0, r * tau_m - tau); // before it, F would be above 1
        if (elastic >= k_s * by)
            return tau + k_s * by;
        // by = (1 / k_s - 1 / k_p) d(tau) + (1 - r) tau_m / k_p  y,   y = -log(1 - d(tau) / left)
        const T from = tau + elastic, left = tau_m - from, rest = by - elastic / k_s;
        const T gives = std::max<T>(0, 1 / k_s - 1 / plastic_k_s) * left,
                bends = (1 - r) * tau_m / plastic_k_s;
        T y = rest / (gives + bends); // below the root; Newton's steps stay there
        for (int i = 0; i < 20 && value_of(gives) > 0; ++i) {
            const T e = exp(-y), step = (rest - gives * (1 - e) - bends * y) / (gives * e + bends);
            y += step;
            if (value_of(step) <= 1e-15 * value_of(y))
                break;
        }
        return tau_m - left * exp(-y);
    }

    // tau after shear by u from `last`, under the pressure p > 0.
    T sheared(std::array<T, 3>& memory, const T& last, const T& u, const T& p) const
    {
        using std::abs, std::copysign;
        T& u_p = memory[0];
        const T most = p * tan_phi_m(u_p); // the pressure may have fallen
        const bool is_beyond = abs(last) > most;
        const T tau = is_beyond ? T(copysign(most, last)) : last;
        if (is_beyond) {
            memory[1] = tau;
            if (value_of(memory[2]) == 0)
                memory[2] = value_of(last) > 0 ? 2 : -2;
        }
        const double sense = value_of(u) > 0 ? 1 : -1;
        const bool turns = value_of(memory[2]) * sense <= 0; // or the first shear
        // So small a reversal is an error of equilibria, not a reversal: it is elastic.
        if (turns && value_of(abs(u) * k_s) <= 1e-4 * value_of(most))
            return std::clamp<T>(tau + k_s * u, -most, most);
        if (turns) {
            const T ratio = sense * tau / most;
            memory[2] = sense * (2 + (value_of(memory[2]) == 0 ? T(0) : std::min<T>(ratio, 0.75)));
        }
        const T r = sense * memory[2] - 2;
        const int parts =
            static_cast<int>(std::min(999.0, 40 * std::abs(value_of(u)) / roughness_length)) + 1;
        const T by = sense * u / parts;
        T along = sense * tau;
        for (int i = 0; i < parts; ++i) {
            const T half = by / 2, to_middle = after(along, half, p * tan_phi_m(u_p), r),
                    in_middle = u_p + std::max<T>(0, half - (to_middle - along) / k_s),
                    next = after(along, by, p * tan_phi_m(in_middle), r);
            u_p += std::max<T>(0, by - (next - along) / k_s);
            along = next;
            // Returns to tau_m, which falls in turn: the displacements are increased until they fit.
            const T so_far = u_p;
            for (int k = 0; k < 100 && along > p * tan_phi_m(u_p); ++k) {
                along = p * tan_phi_m(u_p);
                u_p = so_far + (next - along) / k_s;
            }
            along = std::min<T>(along, p * tan_phi_m(u_p));
        }
        return memory[1] = sense * along;
    }

    template <class U>
    ContinuouslyYieldingOf<U> with_springs(const U& normal, const U& shear) const
    {
        return {normal, shear, plastic_k_s, friction_angle, initial_angle, roughness_length};
    }
    static ContinuouslyYieldingOf from(const ValueOf& value, double)
    {
        const double k_s = value(parameters::shear_stiffness);
        return {value(parameters::normal_stiffness),
                k_s,
                k_s,
                value(parameters::friction_angle),
                value(parameters::initial_friction_angle),
                value(parameters::roughness_length)};
    }
    static const LawInfo& info()
    {
        using namespace parameters;
        static const LawInfo info{
            .name = "continuously yielding",
            .about = "continuously yielding (Cundall and Lemos)",
            .parameters = of_all_joints_and({initial_friction_angle, parameters::roughness_length}),
            .own = {"initial_friction_angle", "roughness_length"},
            .no_sensitivities = "their plastic displacement has a shear stiffness that is not differentiated",
            .check = [](const ValueOf& value) -> std::optional<Complaint> {
                if (auto complaint = complaint_of_more_than_friction("continuously yielding", value))
                    return complaint;
                for (const Parameter& some : {shear_stiffness, parameters::friction_angle})
                    if (value(some) == 0)
                        return Complaint{some, "expected more than 0 of a continuously yielding joint"};
                if (value(initial_friction_angle) < value(parameters::friction_angle))
                    return Complaint{initial_friction_angle, "expected at least friction_angle_deg"};
                return {};
            }};
        return info;
    }
};
using ContinuouslyYielding = ContinuouslyYieldingOf<>;

template <class T>
ResponseOf<T> respond(const ContinuouslyYieldingOf<T>& law, StateOf<T>& state, const Value<T>& sigma_0,
                      const Value<T>& tau_0, const Value<T>& u_n, const Value<T>& u_s)
{
    using std::abs;
    const T p = -sigma_0 - law.k_n * u_n, trial = tau_0 + law.k_s * (u_s - state.slip);
    if (!(p > 0)) {
        state.slip += trial / law.k_s; // the joint closes again without shear
        state.memory[1] = 0;
        state.memory[2] = 2;
        return {0, 0, ContactStatus::open};
    }
    const T last = value_of(state.memory[2]) == 0 ? tau_0 : state.memory[1];
    const T tau = law.sheared(state.memory, last, (trial - last) / law.k_s, p);
    state.slip += (trial - tau) / law.k_s;
    // A joint within a thousandth of its strength counts as slipping.
    const bool slips = value_of(abs(tau)) > 0.999 * value_of(p * law.tan_phi_m(state.memory[0]));
    return {-p, tau, slips ? ContactStatus::slipping : ContactStatus::stuck};
}

// The springs are those on unloading.
inline Slopes slopes(const ContinuouslyYielding& law, const State& state, double)
{
    return {law.k_n, law.k_s, law.tan_phi_m(state.memory[0]), 0, 0};
}
template <class T>
T normal_traction(const ContinuouslyYieldingOf<T>& law, const Value<T>& sigma_0, const Value<T>& u)
{
    return sigma_0 + law.k_n * u;
}
template <class T>
T opening(const ContinuouslyYieldingOf<T>& law, const Value<T>& sigma_0)
{
    return sigma_0 / law.k_n;
}
inline bool stiffens(const ContinuouslyYielding&)
{
    return false;
}
// At the pressure for which the strength is the given one.
inline double shear(const ContinuouslyYielding& law, State& state, double last, double slid, double strength)
{
    const double p = strength / law.tan_phi_m(state.memory[0]);
    if (!(p > 0))
        return 0;
    // A displacement too small for a reversal is added to the next one. A traction far from the kept one is the initial
    // one, or that of another overlap.
    if (std::abs(last - state.memory[1]) > 1e-4 * strength)
        state.memory[1] = last;
    const double kept = state.memory[1];
    return law.sheared(state.memory, kept, slid + (last - kept) / law.k_s, p);
}

} // namespace jointcreep::joint
