// The joint laws: this is the one list of them. Each law has a header of its own, with a table of its parameters, its
// response to a displacement at a point, and the other functions required of a law. A law that lacks one of these does
// not compile.
//
// To add a law: write its header, and add it to the list. Scene keys, datasets, columns of exports, strength
// averaging, strength reduction, checkpoints, the engines and sensitivities follow.

#pragma once

#include "joint/barton_bandis.hpp"
#include "joint/continuously_yielding.hpp"
#include "joint/coulomb.hpp"
#include "joint/residual_strength.hpp"
#include "joint/wearing_dilation.hpp"

#include <concepts>
#include <variant>

namespace jointcreep::joint
{

// Files name a law by its place here: new ones come last.
using Law = std::variant<Coulomb, ResidualStrength, BartonBandis, WearingDilation, ContinuouslyYielding>;

// All of them, in that order.
const std::vector<LawInfo>& laws();

// The parameters of all laws, without repetition.
const std::vector<Parameter>& all_parameters();

// The law of a joint, by its place in the list, with its parameters [SI] and the divisor of all strengths.
Law law_of(Index law, const ValueOf& value, double strength_divisor);
Law law_of(const JointMaterial& material);
Law law_of(const EquivalentJoints& joints, std::size_t edge);

// The list itself, not one law. Otherwise a law that lacks a function would convert to the list, whose function would
// call itself without end.
template <class Any>
concept AnyLaw = std::same_as<Any, Law>;

// For any law; Coulomb's first, as it is the most frequent.
inline Response respond(const AnyLaw auto& law, State& state, double sigma_0, double tau_0, double u_n,
                        double u_s)
{
    if (const auto* const coulomb = std::get_if<Coulomb>(&law))
        return respond(*coulomb, state, sigma_0, tau_0, u_n, u_s);
    return std::visit([&](const auto& one) { return respond(one, state, sigma_0, tau_0, u_n, u_s); }, law);
}
// Calls `ask` for the law in numbers with derivatives, with k_n and k_s in place of its own springs.
template <class Ask>
auto with_derivatives(const AnyLaw auto& law, const Dual& k_n, const Dual& k_s, const Ask& ask)
{
    return std::visit([&](const auto& one) { return ask(one.template with_springs<Dual>(k_n, k_s)); }, law);
}
inline Slopes slopes(const AnyLaw auto& law, const State& state, double sigma_n)
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
inline AlongOverlap along_overlap(const AnyLaw auto& law, const State& state,
                                  const std::array<double, 2>& closing, double length)
{
    if (const auto* const coulomb = std::get_if<Coulomb>(&law))
        return along_overlap(*coulomb, state, closing, length);
    return std::visit([&](const auto& one) { return along_overlap(one, state, closing, length); }, law);
}

// A spring as given, normal or shear; for Barton and Bandis, the normal one at no pressure [Pa/m].
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
inline bool stiffens(const AnyLaw auto& law)
{
    return std::visit([](const auto& one) { return stiffens(one); }, law);
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
// Whether the law has friction only: no bonds that could break.
inline bool has_friction_only(const AnyLaw auto& law)
{
    return std::visit([]<class One>(const One&) { return FrictionOnly<One>; }, law);
}
// Whether its shear traction depends on the path by more than slip: such a law has its own shear().
template <class One>
concept Remembers = requires(const One& law, State& state, double number)
{
    shear(law, state, number, number, number);
};
inline bool remembers(const AnyLaw auto& law)
{
    return std::visit([]<class One>(const One&) { return Remembers<One>; }, law);
}
// The mean shear traction along an overlap [Pa] after a slide of `slid` [m] from the traction `last`, with the present
// shear strength; updates the law's memory in `state`.
inline double shear(const AnyLaw auto& law, State& state, double last, double slid, double strength)
{
    return std::visit(
        [&]<class One>(const One& one) {
            if constexpr (Remembers<One>)
                return shear(one, state, last, slid, strength);
            else
                return spring_traction(one.k_s, last, slid, strength);
        },
        law);
}
// Whether its bonds break by slip, with this shear load and strength without slip (both tractions or both forces).
inline bool breaks_by_slip(const AnyLaw auto& law, bool is_broken, double trial, double strength)
{
    return !is_broken && weakens_by_slip(law) && std::abs(trial) > std::max(0.0, strength);
}
// The law without bonds: for contacts that form between moving blocks.
inline Law unbonded(const AnyLaw auto& law)
{
    return std::visit([](const auto& one) -> Law { return unbonded(one); }, law);
}
inline double dilation_end(const AnyLaw auto& law) // [m]
{
    return std::visit([](const auto& one) { return dilation_end(one); }, law);
}

} // namespace jointcreep::joint
