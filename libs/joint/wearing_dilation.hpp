// Coulomb's joint whose dilation wears off with the plastic work of slip (Plesha 1987: Constitutive models for
// rock discontinuities with dilatancy and surface degradation).
//
//     d(dilation) = tan(psi) exp(-w W) |d(slip)|,     dW = |tau| |d(slip)|
//
// with the wear w [m2/J] and the work W per area [J/m2]. Under a constant shear traction the joint opens by
// tan(psi) / (w |tau|) in all. Everything else is as in joint/coulomb.hpp.

#pragma once

#include "joint/coulomb.hpp"

namespace jointcreep::joint
{

namespace parameters
{

inline const Parameter dilation_wear{
    "dilation_wear",
    "dilation_wear_m2_per_MJ",
    KeyUnit{"m2/MJ", 1e-6, "m2/J"},
    above(0).to(1e6),
    WithBridges::own,
    WithStrengthDivided::same,
    "Wear w. With it dilation wears off: the tangent of the dilation angle is multiplied by exp(-w W), with "
    "the work W of slip per area."};

} // namespace parameters

// Dilation that decreases with the work of slip.
template <class T>
struct DilationThatWears {
    double tan_psi; // [-]
    double wear;    // [m2/J]
    T work;         // until now [J/m2]

    bool dilates() const { return tan_psi > 0; }

    // Opening by slip under a constant shear traction tau [m].
    T opening_by(const T& slip, const T& tau) const
    {
        using std::exp, std::expm1;
        const T worn = wear * tau * slip;
        const T mean = value_of(worn) > 1e-8 ? T(-expm1(-worn) / worn) : T(1 - worn / 2); // of exp(-worn)
        return tan_psi * exp(-wear * work) * mean * slip;
    }
    // Excess of the shear traction over the strength after slip x: slip leaves the shear traction k_s (most - x), and
    // presses the joint together.
    T excess_after(const T& x, const T& excess, const T& most, const T& k_n, const T& k_s,
                   double tan_phi) const
    {
        return excess - k_s * x - k_n * tan_phi * opening_by(x, k_s * (most - x));
    }
    T slip(const T& excess, const T& most, const T& k_n, const T& k_s, double tan_phi) const
    {
        if (excess <= 0)
            return 0;
        const double last = value_of(most);
        const DilationThatWears<Dual> with_slope{tan_psi, wear, value_of(work)};
        const auto at = [&](double x) {
            return with_slope.excess_after(Dual(x, 1), value_of(excess), last, value_of(k_n), value_of(k_s),
                                           tan_phi);
        };
        if (at(last).value >= 0)
            return most;
        double low = 0, high = last, x = std::min(last, value_of(excess) / value_of(k_s)), slope = 0;
        for (int i = 0; i < 100; ++i) { // Newton's method between bounds
            const Dual now = at(x);
            slope = now.slope;
            (now.value > 0 ? low : high) = x;
            double next = x - now.value / now.slope;
            if (!(next >= low && next <= high))
                next = (low + high) / 2;
            const double change = std::abs(next - x);
            x = next;
            if (change <= 1e-15 * last)
                break;
        }
        // One more step, for the derivatives.
        return x - excess_after(x, excess, most, k_n, k_s, tan_phi) / slope;
    }
    T press(const T& slip, const T& tau, const T& k_n) const { return k_n * opening_by(slip, tau); }
    void raise(StateOf<T>& state, const T& slip, const T& tau) const
    {
        state.dilation += opening_by(slip, tau);
        state.memory[0] += tau * slip;
    }
};

// memory[0] is the work W [J/m2].
template <class T = double>
struct WearingDilationOf : CoulombOf<T> {
    double wear; // w [m2/J]

    DilationThatWears<T> dilation(const StateOf<T>& state) const
    {
        return {this->tan_psi, wear, state.memory[0]};
    }
    template <class U>
    WearingDilationOf<U> with_springs(const U& normal, const U& shear) const
    {
        return {CoulombOf<T>::template with_springs<U>(normal, shear), wear};
    }
    static WearingDilationOf from(const ValueOf& value, double divisor)
    {
        return {CoulombOf<T>::from(value, divisor), value(parameters::dilation_wear)};
    }
    static const LawInfo& info()
    {
        using namespace parameters;
        static const LawInfo info{.name = "wearing dilation",
                                  .about = "Coulomb whose dilation wears off with the work of slip",
                                  .parameters = of_all_joints_and({dilation_wear}),
                                  .own = {"dilation_wear"},
                                  .check = [](const ValueOf& value) -> std::optional<Complaint> {
                                      if (value(parameters::dilation_until) != 0)
                                          return Complaint{parameters::dilation_until,
                                                           "expected 0 of a joint whose dilation wears off"};
                                      return CoulombOf<T>::check(value);
                                  }};
        return info;
    }
};
using WearingDilation = WearingDilationOf<>;

template <class T>
ResponseOf<T> respond(const WearingDilationOf<T>& law, StateOf<T>& state, const Value<T>& sigma_0,
                      const Value<T>& tau_0, const Value<T>& u_n, const Value<T>& u_s)
{
    return respond_by_coulomb(law, state, sigma_0, tau_0, u_n, u_s);
}

inline Slopes slopes(const WearingDilation& law, const State& state, double sigma_n)
{
    Slopes now = slopes(static_cast<const Coulomb&>(law), state, sigma_n);
    now.tan_psi *= std::exp(-law.wear * state.memory[0]);
    return now;
}
inline double shear(const WearingDilation& law, State& state, double last, double slid, double strength)
{
    const double tau = spring_traction(law.k_s, last, slid, strength);
    if (law.k_s > 0)
        state.memory[0] += tau * (last + law.k_s * slid - tau) / law.k_s;
    return tau;
}

} // namespace jointcreep::joint
