#include "creep/scheme.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace jointcreep::creep
{

namespace
{

// Lengths of a step in times 1 / lam, 1 / rho beyond which nothing changes any more.
constexpr double for_ever = 1e12;

// The mean of exp(-y s) over 0 <= s <= 1.
double mean_decay(double y)
{
    return y == 0 ? 1 : -std::expm1(-y) / y;
}

// Integral over 0 <= s <= 1 of exp(-x (1 - s)) phi(s), phi = (1 - exp(-r s)) / (1 - exp(-r)), for r = 0 its
// limit phi = s. The closed form loses its digits where x and r are small.
double fitted_weight(double x, double r)
{
    if (x < 0.5 && r < 0.5) { // Gauss's quadrature of 5 points: exact to rounding here
        constexpr std::array<std::array<double, 2>, 5> rule{{{0.046910077030668004, 0.11846344252809454},
                                                             {0.23076534494715845, 0.23931433524968324},
                                                             {0.5, 0.28444444444444444},
                                                             {0.76923465505284155, 0.23931433524968324},
                                                             {0.953089922969332, 0.11846344252809454}}};
        double sum = 0;
        for (const auto& [s, weight] : rule)
            sum += weight * std::exp(-x * (1 - s)) * (r == 0 ? s : std::expm1(-r * s) / std::expm1(-r));
        return sum;
    }
    if (r < 1e-5) { // phi = s + r (s - s^2) / 2
        const double m1 = (1 - mean_decay(x)) / x, m2 = (1 - 2 * m1) / x;
        return m1 + r / 2 * (m1 - m2);
    }
    return (mean_decay(x) - std::exp(-std::min(x, r)) * mean_decay(std::abs(x - r))) / -std::expm1(-r);
}

// Part of the integral over 0 <= s <= 1 of exp(-x (1 - s)) that goes with the force at the end.
double last_weight(CreepScheme scheme, double x, double r)
{
    switch (scheme) {
    case CreepScheme::published:
        return 0;
    case CreepScheme::backward:
        return mean_decay(x);
    case CreepScheme::linear_force:
        return fitted_weight(x, 0);
    case CreepScheme::fitted:
        return fitted_weight(x, r);
    }
    return 0;
}

} // namespace

double relaxation_rate(const Chain& chain)
{
    double fluidity = 0, slowing = 0;
    for (const Unit& unit : chain.units) {
        fluidity += 1 / unit.viscosity;
        slowing += unit.stiffness / unit.viscosity / unit.viscosity;
    }
    return fluidity == 0 ? 0 : chain.spring * fluidity + slowing / fluidity;
}

bool is_second_order(CreepScheme scheme)
{
    return scheme == CreepScheme::linear_force || scheme == CreepScheme::fitted;
}

Step step_of(const Chain& chain, CreepScheme scheme, double duration)
{
    const CreepScheme other =
        scheme == CreepScheme::linear_force ? CreepScheme::fitted : CreepScheme::linear_force;
    const double r = std::min(relaxation_rate(chain) * duration, for_ever);
    Step step{{}, 0, 0, 0};
    double others = 0;
    for (const Unit& unit : chain.units) {
        double x = unit.stiffness / unit.viscosity * duration, flow = duration / unit.viscosity;
        if (x > for_ever) {
            x = for_ever;
            flow = for_ever / unit.stiffness;
        }
        const double last = last_weight(scheme, x, r);
        step.units.push_back({std::exp(-x), flow * (mean_decay(x) - last), flow * last});
        step.compliance += flow * last;
        others += flow * last_weight(other, x, r);
    }
    step.acting_stiffness = 1 / (1 / chain.spring + step.compliance);
    step.doubt = std::abs(step.compliance - others);
    return step;
}

bool is_stable(const Chain& chain, double duration)
{
    double sum = 0;
    for (const Unit& unit : chain.units)
        sum += unit.stiffness > 0 ? std::tanh(unit.stiffness / unit.viscosity * duration / 2) / unit.stiffness
                                  : duration / 2 / unit.viscosity;
    return chain.spring * sum < 1;
}

double longest_stable_step(const Chain& chain)
{
    double most = 0;
    for (const Unit& unit : chain.units)
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
