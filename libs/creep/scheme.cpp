#include "creep/scheme.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace jointcreep::creep
{

namespace
{

// Lengths of a step in times 1 / lam, 1 / rho beyond which nothing changes any more.
constexpr double for_ever = 1e12;

// A number with what it changes by: the weights below are found with their derivatives by the same formulas.
struct Changing {
    double value, change = 0;

    Changing(double v) : value(v) {} // a constant
    Changing(double v, double c) : value(v), change(c) {}

    friend Changing operator+(Changing a, Changing b) { return {a.value + b.value, a.change + b.change}; }
    friend Changing operator-(Changing a, Changing b) { return {a.value - b.value, a.change - b.change}; }
    friend Changing operator-(Changing a) { return {-a.value, -a.change}; }
    friend Changing operator*(Changing a, Changing b)
    {
        return {a.value * b.value, a.change * b.value + a.value * b.change};
    }
    friend Changing operator/(Changing a, Changing b)
    {
        return {a.value / b.value, (a.change - a.value / b.value * b.change) / b.value};
    }
    friend bool operator<(Changing a, Changing b) { return a.value < b.value; }
    friend bool operator>(Changing a, Changing b) { return a.value > b.value; }
    friend bool operator==(Changing a, Changing b) { return a.value == b.value; }
    friend Changing exp(Changing a) { return {std::exp(a.value), std::exp(a.value) * a.change}; }
    friend Changing expm1(Changing a) { return {std::expm1(a.value), std::exp(a.value) * a.change}; }
    friend Changing abs(Changing a) { return a.value < 0 ? -a : a; }
};

using std::abs;
using std::exp;
using std::expm1;

// The mean of exp(-y s) over 0 <= s <= 1.
template <class Number>
Number mean_decay(Number y)
{
    return y == 0 ? Number(1) : -expm1(-y) / y;
}

// Integral over 0 <= s <= 1 of exp(-x (1 - s)) phi(s), phi = (1 - exp(-r s)) / (1 - exp(-r)), for r = 0 its
// limit phi = s. The closed form loses its digits where x and r are small.
template <class Number>
Number fitted_weight(Number x, Number r)
{
    if (x < 0.5 && r < 0.5) { // Gauss's quadrature of 5 points: exact to rounding here
        constexpr std::array<std::array<double, 2>, 5> rule{{{0.046910077030668004, 0.11846344252809454},
                                                             {0.23076534494715845, 0.23931433524968324},
                                                             {0.5, 0.28444444444444444},
                                                             {0.76923465505284155, 0.23931433524968324},
                                                             {0.953089922969332, 0.11846344252809454}}};
        Number sum = 0;
        for (const auto& [s, weight] : rule)
            sum = sum + weight * exp(-x * (1 - s)) * (r == 0 ? Number(s) : expm1(-r * s) / expm1(-r));
        return sum;
    }
    if (r < 1e-5) { // phi = s + r (s - s^2) / 2
        const Number m1 = (1 - mean_decay(x)) / x, m2 = (1 - 2 * m1) / x;
        return m1 + r / 2 * (m1 - m2);
    }
    return (mean_decay(x) - exp(-std::min(x, r)) * mean_decay(abs(x - r))) / -expm1(-r);
}

// Share of the integral over 0 <= s <= 1 of exp(-x (1 - s)) that goes with the force at the end.
template <class Number>
Number last_weight(CreepScheme scheme, Number x, Number r)
{
    switch (scheme) {
    case CreepScheme::published:
        return 0;
    case CreepScheme::backward:
        return mean_decay(x);
    case CreepScheme::linear_force:
        return fitted_weight(x, Number(0));
    case CreepScheme::fitted:
        return fitted_weight(x, r);
    case CreepScheme::automatic:
        break;
    }
    return 0;
}

// StepWeights::OfUnit, of numbers that may have a change.
template <class Number>
struct WeightsOf {
    Number decay, first, last;
};

template <class Number>
WeightsOf<Number> weights_of(Number stiffness, Number viscosity, Number rate, CreepScheme scheme,
                             Number duration)
{
    Number x = stiffness / viscosity * duration, flow = duration / viscosity;
    if (x > for_ever) {
        x = for_ever;
        flow = for_ever / stiffness;
    }
    const Number r = std::min(rate * duration, Number(for_ever));
    const Number last = last_weight(scheme, x, r);
    return {exp(-x), flow * (mean_decay(x) - last), flow * last};
}

template <class Number>
Number relaxation_rate(Number spring, const std::vector<std::pair<Number, Number>>& units)
{
    Number fluidity = 0, slowing = 0;
    for (const auto& [stiffness, viscosity] : units) {
        fluidity = fluidity + 1 / viscosity;
        slowing = slowing + stiffness / viscosity / viscosity;
    }
    return fluidity == 0 ? Number(0) : spring * fluidity + slowing / fluidity;
}

} // namespace

double relaxation_rate(const Chain& chain)
{
    std::vector<std::pair<double, double>> units;
    for (const KelvinUnit& unit : chain.units)
        units.emplace_back(unit.stiffness, unit.viscosity);
    return relaxation_rate(chain.spring, units);
}

bool is_second_order(CreepScheme scheme)
{
    return scheme != CreepScheme::published && scheme != CreepScheme::backward;
}

CreepScheme scheme_of_step(CreepScheme scheme, bool loads_change)
{
    if (scheme != CreepScheme::automatic)
        return scheme;
    return loads_change ? CreepScheme::linear_force : CreepScheme::fitted;
}

StepWeights step_of(const Chain& chain, CreepScheme scheme, double duration)
{
    const CreepScheme other =
        scheme == CreepScheme::linear_force ? CreepScheme::fitted : CreepScheme::linear_force;
    const double rate = relaxation_rate(chain);
    StepWeights step{{}, 0, 0, 0};
    double others = 0;
    for (const KelvinUnit& unit : chain.units) {
        const auto weights = weights_of(unit.stiffness, unit.viscosity, rate, scheme, duration);
        step.units.push_back({weights.decay, weights.first, weights.last});
        step.compliance += weights.last;
        others += weights_of(unit.stiffness, unit.viscosity, rate, other, duration).last;
    }
    step.acting_stiffness = 1 / (1 / chain.spring + step.compliance);
    step.doubt = std::abs(step.compliance - others);
    return step;
}

StepWeights change_of_step(const Chain& chain, const Chain& change, CreepScheme scheme, double duration,
                           double duration_change)
{
    const Changing spring(chain.spring, change.spring);
    std::vector<std::pair<Changing, Changing>> units;
    for (std::size_t u = 0; u < chain.units.size(); ++u)
        units.push_back({{chain.units[u].stiffness, change.units[u].stiffness},
                         {chain.units[u].viscosity, change.units[u].viscosity}});
    const Changing rate = relaxation_rate(spring, units);
    StepWeights step{{}, 0, 0, 0};
    Changing compliance = 0;
    for (const auto& [stiffness, viscosity] : units) {
        const auto weights =
            weights_of(stiffness, viscosity, rate, scheme, Changing(duration, duration_change));
        step.units.push_back({weights.decay.change, weights.first.change, weights.last.change});
        compliance = compliance + weights.last;
    }
    step.compliance = compliance.change;
    step.acting_stiffness = (1 / (1 / spring + compliance)).change;
    return step;
}

bool is_stable(const Chain& chain, double duration)
{
    double sum = 0;
    for (const KelvinUnit& unit : chain.units)
        sum += unit.stiffness > 0 ? std::tanh(unit.stiffness / unit.viscosity * duration / 2) / unit.stiffness
                                  : duration / 2 / unit.viscosity;
    return chain.spring * sum < 1;
}

double longest_stable_step(const Chain& chain)
{
    double most = 0;
    for (const KelvinUnit& unit : chain.units)
        most += unit.stiffness > 0 ? 1 / unit.stiffness : std::numeric_limits<double>::infinity();
    if (chain.spring * most <= 1)
        return std::numeric_limits<double>::infinity();
    double stable = 0, unstable = 1 / relaxation_rate(chain);
    while (is_stable(chain, unstable))
        unstable *= 2;
    for (double middle = (stable + unstable) / 2; stable < middle && middle < unstable;
         middle = (stable + unstable) / 2)
        (is_stable(chain, middle) ? stable : unstable) = middle;
    return stable;
}

} // namespace jointcreep::creep
