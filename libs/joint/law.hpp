// The joint laws: this is the one list of them. Each has a file of its own, with its parameters and
// respond().

#pragma once

#include "joint/barton_bandis.hpp"
#include "joint/coulomb.hpp"

#include <variant>

namespace jointcreep::joint
{

using Law = std::variant<Coulomb, BartonBandis>;

// What a contact would do for a small displacement from where it is: its springs; and where it slips, the
// change of strength over that of pressure, and of dilation over slip.
struct Slopes {
    double k_n, k_s;         // [Pa/m]
    double tan_phi, tan_psi; // [-]
};

inline Slopes slopes(const Coulomb& law, const CoulombState& state, double)
{
    return {law.k_n, law.k_s, law.tan_phi_of(state.is_broken),
            state.dilation < law.dilation_end() ? law.tan_psi : 0.0};
}
inline Slopes slopes(const BartonBandis& law, const CoulombState&, double sigma_n)
{
    return {law.stiffness(-sigma_n), law.k_s, law.friction(-sigma_n), 0};
}

// Normal traction at an opening u [m] since it was sigma_0; positive where the joint is open, by it / k_n.
inline double normal_traction(const Coulomb& law, double sigma_0, double u)
{
    return sigma_0 + law.k_n * u;
}
inline double normal_traction(const BartonBandis& law, double sigma_0, double u)
{
    return -law.pressure(law.closure(-sigma_0) - u);
}

// The opening at which a contact of the traction sigma_0 would just touch: below 0 where it is closed [m].
inline double opening(const Coulomb& law, double sigma_0)
{
    return sigma_0 / law.k_n;
}
inline double opening(const BartonBandis& law, double sigma_0)
{
    return -law.closure(-sigma_0);
}

// What the springs hold, per area [J/m2].
inline double stored(const Coulomb& law, double sigma_n, double tau)
{
    return (sigma_n * sigma_n / law.k_n + (law.k_s > 0 ? tau * tau / law.k_s : 0.0)) / 2;
}
inline double stored(const BartonBandis& law, double sigma_n, double tau)
{
    return law.stored(-sigma_n) + (law.k_s > 0 ? tau * tau / law.k_s / 2 : 0.0);
}

// Of any of them; Coulomb's first, as nearly all are.
inline Response respond(const Law& law, CoulombState& state, double sigma_0, double tau_0, double u_n,
                        double u_s)
{
    if (const auto* const coulomb = std::get_if<Coulomb>(&law))
        return respond(*coulomb, state, sigma_0, tau_0, u_n, u_s);
    return respond(std::get<BartonBandis>(law), state, sigma_0, tau_0, u_n, u_s);
}
inline Slopes slopes(const Law& law, const CoulombState& state, double sigma_n)
{
    return std::visit([&](const auto& one) { return slopes(one, state, sigma_n); }, law);
}
inline double normal_traction(const Law& law, double sigma_0, double u)
{
    return std::visit([&](const auto& one) { return normal_traction(one, sigma_0, u); }, law);
}
inline double opening(const Law& law, double sigma_0)
{
    return std::visit([&](const auto& one) { return opening(one, sigma_0); }, law);
}
inline double stored(const Law& law, double sigma_n, double tau)
{
    if (const auto* const coulomb = std::get_if<Coulomb>(&law))
        return stored(*coulomb, sigma_n, tau);
    return stored(std::get<BartonBandis>(law), sigma_n, tau);
}

// A spring as given, normal or shear; the normal one of Barton and Bandis is that without pressure [Pa/m].
template <class AnyLaw>
auto& k_n(AnyLaw& law)
{
    return std::visit(
        [](auto& one) -> auto& { return one.k_n; }, law);
}
template <class AnyLaw>
auto& k_s(AnyLaw& law)
{
    return std::visit(
        [](auto& one) -> auto& { return one.k_s; }, law);
}

// Whether its stiffness is that of its springs, whatever the traction.
inline bool is_linear(const Law& law)
{
    return std::holds_alternative<Coulomb>(law);
}
inline double cohesion(const Law& law)
{
    const auto* const coulomb = std::get_if<Coulomb>(&law);
    return coulomb ? coulomb->cohesion : 0.0;
}
inline double tensile_strength(const Law& law)
{
    const auto* const coulomb = std::get_if<Coulomb>(&law);
    return coulomb ? coulomb->tensile_strength : 0.0;
}
inline bool weakens_by_slip(const Law& law)
{
    const auto* const coulomb = std::get_if<Coulomb>(&law);
    return coulomb && coulomb->weakens;
}

} // namespace jointcreep::joint
