// The joint laws: this is the one list of them. Each has a file of its own, with its parameters, respond()
// and what is asked of any law. A law that lacks one of these functions does not compile; nor do, until it is
// thought of there, the places that pick laws by hand (number_of_laws).

#pragma once

#include "joint/barton_bandis.hpp"
#include "joint/coulomb.hpp"

#include <concepts>
#include <variant>

namespace jointcreep::joint
{

using Law = std::variant<Coulomb, BartonBandis>;
// To be asserted where laws are picked by hand.
inline constexpr std::size_t number_of_laws = std::variant_size_v<Law>;
// The list itself, and not one of the laws: that would turn into it where a function of its own is missing,
// which would call itself for ever.
template <class Any>
concept AnyLaw = std::same_as<Any, Law>;

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
inline Response respond(const AnyLaw auto& law, CoulombState& state, double sigma_0, double tau_0, double u_n,
                        double u_s)
{
    if (const auto* const coulomb = std::get_if<Coulomb>(&law))
        return respond(*coulomb, state, sigma_0, tau_0, u_n, u_s);
    return std::visit([&](const auto& one) { return respond(one, state, sigma_0, tau_0, u_n, u_s); }, law);
}
inline Slopes slopes(const AnyLaw auto& law, const CoulombState& state, double sigma_n)
{
    return std::visit([&](const auto& one) { return slopes(one, state, sigma_n); }, law);
}
inline double normal_traction(const AnyLaw auto& law, double sigma_0, double u)
{
    return std::visit([&](const auto& one) { return normal_traction(one, sigma_0, u); }, law);
}
inline double opening(const AnyLaw auto& law, double sigma_0)
{
    return std::visit([&](const auto& one) { return opening(one, sigma_0); }, law);
}
inline double stored(const AnyLaw auto& law, double sigma_n, double tau)
{
    if (const auto* const coulomb = std::get_if<Coulomb>(&law))
        return stored(*coulomb, sigma_n, tau);
    return std::visit([&](const auto& one) { return stored(one, sigma_n, tau); }, law);
}

// A spring as given, normal or shear; the normal one of Barton and Bandis is that without pressure [Pa/m].
template <class Any>
auto& k_n(Any& law)
{
    return std::visit(
        [](auto& one) -> auto& { return one.k_n; }, law);
}
template <class Any>
auto& k_s(Any& law)
{
    return std::visit(
        [](auto& one) -> auto& { return one.k_s; }, law);
}

// As for each of them.
inline bool is_linear(const AnyLaw auto& law)
{
    return std::visit([](const auto& one) { return is_linear(one); }, law);
}
inline double cohesion(const AnyLaw auto& law)
{
    return std::visit([](const auto& one) { return cohesion(one); }, law);
}
inline double tensile_strength(const AnyLaw auto& law)
{
    return std::visit([](const auto& one) { return tensile_strength(one); }, law);
}
inline bool weakens_by_slip(const AnyLaw auto& law)
{
    return std::visit([](const auto& one) { return weakens_by_slip(one); }, law);
}
inline bool dilates(const AnyLaw auto& law)
{
    return std::visit([](const auto& one) { return dilates(one); }, law);
}

} // namespace jointcreep::joint
