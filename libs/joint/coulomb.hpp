// Coulomb's joint: springs along the normal and along the joint, no tension beyond the strength of its bonds,
// Coulomb friction, and dilation by slip.
//
//     sigma_n = sigma_0 + k_n (u_n - dilation)   up to the tensile strength; beyond, the joint opens
//     tau     = tau_0   + k_s (u_s - slip)       with |tau| <= c - sigma_n tan(phi)
//     d(dilation) = tan(psi) |d(slip)|           in both directions of slip
//
// psi is at most phi: otherwise slip would create energy. This is the plastic flow of Coulomb's law, non-associated:
// with psi in place of phi in the potential. An open joint shears without dilating. With a limit of dilation, slip
// dilates until dilation / tan(psi) has reached it.
//
// Opening breaks the bonds of the joint: cohesion and tensile strength are lost for good. (With cohesion restored at
// closing, a contact could alternate between open and closed.) Slip alone does not break bonds, unless the joint
// `weakens` (joint/residual_strength.hpp): then the first slip breaks them, too. In both cases the residual cohesion
// and friction are left at once, c_r <= c and tan(phi_r) <= tan(phi), with tan(psi) <= tan(phi_r). Signs as in
// model/signs.hpp: tension and opening positive.

#pragma once

#include "joint/parameter.hpp"
#include "joint/response.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace jointcreep::joint
{

// Parameters of all joints (their values are members of JointMaterial and EquivalentJoints).
namespace parameters
{

inline constexpr Range strengths = from(0).to(1e4), frictions = from(0).below(90); // [MPa], [deg]

inline const Parameter normal_stiffness{"normal_stiffness",
                                        "normal_stiffness_MPa_per_m",
                                        MPa_per_m,
                                        above(0).to(1e9),
                                        WithBridges::spring,
                                        WithStrengthDivided::same,
                                        "Normal stiffness.",
                                        {},
                                        &JointMaterial::normal_stiffness,
                                        &EquivalentJoints::normal_stiffness};
inline const Parameter shear_stiffness{"shear_stiffness",
                                       "shear_stiffness_MPa_per_m",
                                       MPa_per_m,
                                       from(0).to(1e9),
                                       WithBridges::spring,
                                       WithStrengthDivided::same,
                                       "Shear stiffness; 0 is a smooth joint.",
                                       {},
                                       &JointMaterial::shear_stiffness,
                                       &EquivalentJoints::shear_stiffness};
inline const Parameter cohesion{"cohesion",
                                "cohesion_MPa",
                                MPa,
                                strengths,
                                WithBridges::mean,
                                WithStrengthDivided::value,
                                "Cohesion.",
                                {},
                                &JointMaterial::cohesion,
                                &EquivalentJoints::cohesion};
inline const Parameter friction_angle{"friction_angle",
                                      "friction_angle_deg",
                                      degrees,
                                      frictions,
                                      WithBridges::mean,
                                      WithStrengthDivided::tangent,
                                      "Friction angle.",
                                      {},
                                      &JointMaterial::friction_angle,
                                      &EquivalentJoints::friction_angle};
inline const Parameter tensile_strength{"tensile_strength",
                                        "tensile_strength_MPa",
                                        MPa,
                                        strengths,
                                        WithBridges::mean,
                                        WithStrengthDivided::value,
                                        "Tensile strength, a positive number.",
                                        {},
                                        &JointMaterial::tensile_strength,
                                        &EquivalentJoints::tensile_strength};
inline const Parameter dilation_angle{
    "dilation_angle",
    "dilation_angle_deg",
    degrees,
    frictions,
    WithBridges::mean,
    WithStrengthDivided::tangent,
    "Dilation angle, at most the friction angle: a joint that slips opens by its tangent times the slip.",
    0.0,
    &JointMaterial::dilation_angle,
    &EquivalentJoints::dilation_angle};
inline const Parameter dilation_until{
    "dilation_until",
    "dilation_until_m",
    metres,
    from(0).to(1000),
    WithBridges::own,
    WithStrengthDivided::same,
    "Slip at which dilation ends; also for rock bridges. 0: it does not end.",
    0.0,
    &JointMaterial::dilation_until,
    &EquivalentJoints::dilation_until};

inline std::vector<Parameter> of_all_joints()
{
    return {normal_stiffness, shear_stiffness, cohesion,      friction_angle,
            tensile_strength, dilation_angle,  dilation_until};
}
inline std::vector<Parameter> of_all_joints_and(std::vector<Parameter> own)
{
    std::vector<Parameter> all = of_all_joints();
    all.insert(all.end(), own.begin(), own.end());
    return all;
}

} // namespace parameters

// Dilation in proportion to slip, by tan(psi), up to an end.
template <class T>
struct DilationInProportion {
    double tan_psi; // [-]
    double end;     // of the dilation [m]
    T left;         // dilation left until there [m]

    bool dilates() const { return tan_psi > 0 && left > 0; }

    // Slip after which the shear traction is at the strength, from an `excess` above it. Slip x increases the pressure,
    // and leaves the excess - k_s x - tan(phi) press(x). At most `most` [m].
    T slip(const T& excess, const T& most, const T& k_n, const T& k_s, double tan_phi) const
    {
        const T slip = std::clamp<T>(excess / (k_s + k_n * tan_psi * tan_phi), 0, most);
        if (slip * tan_psi <= left)
            return slip;
        return std::clamp<T>((excess - k_n * left * tan_phi) / k_s, 0, most); // dilation ends before
    }
    // Change of normal traction by slip to the shear traction tau [Pa].
    T press(const T& slip, const T& /*tau*/, const T& k_n) const
    {
        return slip * tan_psi <= left ? k_n * tan_psi * slip : k_n * left;
    }
    // Adds the dilation by slip to the shear traction tau to `state`.
    void raise(StateOf<T>& state, const T& slip, const T& /*tau*/) const
    {
        state.dilation = std::min<T>(state.dilation + slip * tan_psi, end);
    }
};

template <class T = double>
struct CoulombOf {
    T k_n, k_s;                   // [Pa/m]
    double cohesion;              // [Pa]
    double tan_phi;               // [-]
    double tensile_strength;      // [Pa]
    double tan_psi = 0;           // of the dilation angle [-]
    bool weakens = false;         // by slip; else a broken joint keeps its friction, without cohesion
    double residual_cohesion = 0; // [Pa]
    double residual_tan_phi = 0;  // [-]
    double dilation_until = 0;    // slip at which dilation ends; 0: it does not [m]

    double cohesion_of(bool is_broken) const { return is_broken ? residual_cohesion : cohesion; }
    double tan_phi_of(bool is_broken) const { return is_broken && weakens ? residual_tan_phi : tan_phi; }
    double dilation_end() const // [m]
    {
        return dilation_until > 0 ? tan_psi * dilation_until : std::numeric_limits<double>::infinity();
    }
    DilationInProportion<T> dilation(const StateOf<T>& state) const
    {
        const double end = dilation_end();
        return {tan_psi, end, std::max<T>(0, end - state.dilation)};
    }
    // Present tan(psi) [-].
    double tan_psi_at(const State& state) const { return state.dilation < dilation_end() ? tan_psi : 0.0; }

    static CoulombOf from(const ValueOf& value, double)
    {
        using namespace parameters;
        return {.k_n = value(normal_stiffness),
                .k_s = value(shear_stiffness),
                .cohesion = value(parameters::cohesion),
                .tan_phi = std::tan(value(friction_angle)),
                .tensile_strength = value(parameters::tensile_strength),
                .tan_psi = std::tan(value(dilation_angle)),
                .dilation_until = value(parameters::dilation_until)};
    }
    static const LawInfo& info()
    {
        static const LawInfo info{.name = "Coulomb",
                                  .about = "Coulomb, whose bonds break by opening",
                                  .parameters = parameters::of_all_joints(),
                                  .own = {},
                                  .check = check};
        return info;
    }
    // For any law with Coulomb's strength.
    static std::optional<Complaint> check(const ValueOf& value)
    {
        using namespace parameters;
        if (value(dilation_angle) > value(friction_angle))
            return Complaint{dilation_angle, "expected at most friction_angle_deg"};
        if (value(dilation_angle) > 0 && value(shear_stiffness) == 0)
            return Complaint{dilation_angle, "expected 0 of a smooth joint, which has no shear stiffness"};
        return {};
    }

    template <class U>
    CoulombOf<U> with_springs(const U& normal, const U& shear) const
    {
        return {normal,  shear,   cohesion,          tan_phi,          tensile_strength,
                tan_psi, weakens, residual_cohesion, residual_tan_phi, dilation_until};
    }
};
using Coulomb = CoulombOf<>;

// The traction at displacements u_n, u_s [m] from a state with traction sigma_0, tau_0 [Pa]; updates slip, dilation and
// breaking in `state`. Slip and the final traction are solved together (backward Euler). sigma_0 may be above the
// tensile strength: the joint is then open, by sigma_0 / k_n. For any law with Coulomb's strength and a dilation().
template <class T, class Law>
ResponseOf<T> respond_by_coulomb(const Law& law, StateOf<T>& state, const Value<T>& sigma_0,
                                 const Value<T>& tau_0, const Value<T>& u_n, const Value<T>& u_s)
{
    using std::abs, std::copysign;
    const T sigma_trial = sigma_0 + law.k_n * (u_n - state.dilation);
    const T tau_trial = tau_0 + law.k_s * (u_s - state.slip);
    const auto give = [&] { return law.k_s > 0 ? T(1 / law.k_s) : T(0); }; // needed only where it slips
    // Slip presses a dilating joint together, which increases its strength. If it has no strength to begin with, under
    // tension, it slips at most until no shear is left.
    const auto dilation = law.dilation(state);
    const bool dilates = law.k_s > 0 && dilation.dilates();
    double cohesion = law.cohesion_of(state.is_broken), tan_phi = law.tan_phi_of(state.is_broken);
    const auto slipped = [&]() -> T {
        return dilation.slip(T(abs(tau_trial) - (cohesion - sigma_trial * tan_phi)),
                             T(abs(tau_trial) * give()), law.k_n, law.k_s, tan_phi);
    };
    const auto pressed = [&]() -> T {
        if (!dilates)
            return sigma_trial;
        const T slip = slipped();
        return sigma_trial - dilation.press(slip, abs(tau_trial) - law.k_s * slip, law.k_n);
    };

    const bool opens = pressed() > (state.is_broken ? 0.0 : law.tensile_strength);
    const bool weakens = law.weakens && abs(tau_trial) > std::max<T>(0, cohesion - sigma_trial * tan_phi);
    if (opens || weakens) {
        state.is_broken = true;
        cohesion = law.cohesion_of(true);
        tan_phi = law.tan_phi_of(true);
        if (pressed() > 0) {
            state.slip += tau_trial * give(); // the joint closes again without shear
            return {0, 0, ContactStatus::open};
        }
    }
    const T limit = std::max<T>(0, cohesion - sigma_trial * tan_phi);
    // A joint at its limit counts as slipping, even without motion.
    if (abs(tau_trial) < (1 - 1e-6) * limit || tau_trial == 0)
        return {sigma_trial, tau_trial, ContactStatus::stuck};
    if (!dilates) {
        const T tau = copysign(std::min<T>(limit, abs(tau_trial)), tau_trial);
        state.slip += (tau_trial - tau) * give();
        return {sigma_trial, tau, ContactStatus::slipping};
    }
    const T slip = slipped(), size = abs(tau_trial) - law.k_s * slip;
    state.slip += copysign(slip, tau_trial);
    dilation.raise(state, slip, size);
    return {sigma_trial - dilation.press(slip, size, law.k_n), copysign(size, tau_trial),
            ContactStatus::slipping};
}

template <class T>
ResponseOf<T> respond(const CoulombOf<T>& law, StateOf<T>& state, const Value<T>& sigma_0,
                      const Value<T>& tau_0, const Value<T>& u_n, const Value<T>& u_s)
{
    return respond_by_coulomb(law, state, sigma_0, tau_0, u_n, u_s);
}

inline Slopes slopes(const Coulomb& law, const State& state, double)
{
    return {law.k_n, law.k_s, law.tan_phi_of(state.is_broken), law.tan_psi_at(state),
            law.cohesion_of(state.is_broken)};
}

// Normal traction at an opening u [m] since the traction sigma_0; where positive, the joint is open, by it / k_n.
template <class T>
T normal_traction(const CoulombOf<T>& law, const Value<T>& sigma_0, const Value<T>& u)
{
    return sigma_0 + law.k_n * u;
}

// The opening at which a contact with the traction sigma_0 just touches; negative where it is closed [m].
template <class T>
T opening(const CoulombOf<T>& law, const Value<T>& sigma_0)
{
    return sigma_0 / law.k_n;
}

// Energy stored in the springs, per area [J/m2].
inline double stored(const Coulomb& law, double sigma_n, double tau)
{
    return (sigma_n * sigma_n / law.k_n + (law.k_s > 0 ? tau * tau / law.k_s : 0.0)) / 2;
}

// Along an overlap with linear closing, from closing[0] to closing[1] [m]; exact.
inline AlongOverlap along_overlap(const Coulomb& law, const State&, const std::array<double, 2>& closing,
                                  double length)
{
    const double deep = (closing[0] + closing[1]) / 2, force = law.k_n * length * deep;
    const auto on_end = [&](int end) { return law.k_n * length * (2 * closing[end] + closing[1 - end]) / 6; };
    const auto strength = [&](bool is_broken) {
        return std::max(0.0, law.cohesion_of(is_broken) * length + force * law.tan_phi_of(is_broken));
    };
    return {force,
            {on_end(0), on_end(1)},
            {strength(false), strength(true)},
            law.k_n * length * (closing[0] * closing[0] + closing[0] * closing[1] + closing[1] * closing[1]) /
                6,
            law.k_n,
            law.k_n};
}

// Whether its normal spring grows stiffer as it closes; its bonds [Pa]; effects of slip.
inline bool stiffens(const Coulomb&)
{
    return false;
}
inline double cohesion(const Coulomb& law)
{
    return law.cohesion;
}
inline double tensile_strength(const Coulomb& law)
{
    return law.tensile_strength;
}
inline bool weakens_by_slip(const Coulomb& law)
{
    return law.weakens;
}
inline bool dilates(const Coulomb& law)
{
    return law.tan_psi > 0;
}
inline double dilation_end(const Coulomb& law)
{
    return law.dilation_end();
}
inline Coulomb unbonded(const Coulomb& law)
{
    return {law.k_n, law.k_s, 0, law.weakens ? law.residual_tan_phi : law.tan_phi, 0};
}

} // namespace jointcreep::joint
