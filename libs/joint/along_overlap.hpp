// A joint law along an overlap of two faces with linear closing: the law at a point, integrated with five Gauss points.
// For laws without an exact integral of their own.

#pragma once

#include "joint/response.hpp"

#include <algorithm>
#include <array>

namespace jointcreep::joint
{

// `law` gives the pressure p at a closing, its stiffness(p), stored(p) and strength(p, state); closing in m,
// per depth of the section.
template <class Law>
AlongOverlap along_by_quadrature(const Law& law, const State& state, const std::array<double, 2>& closing,
                                 double length)
{
    constexpr std::array<std::array<double, 2>, 5> points{{{0.046910077030668, 0.118463442528095},
                                                           {0.230765344947158, 0.239314335249683},
                                                           {0.5, 0.284444444444444},
                                                           {0.769234655052842, 0.239314335249683},
                                                           {0.953089922969332, 0.118463442528095}}};
    State broken = state;
    broken.is_broken = true;
    AlongOverlap sum{};
    for (const auto& [at, weight] : points) {
        const double p = law.pressure(closing[0] + at * (closing[1] - closing[0]));
        sum.force += weight * p;
        sum.force_on_ends[0] += weight * ((1 - at) * p);
        sum.force_on_ends[1] += weight * (at * p);
        sum.strength[0] += weight * law.strength(p, state);
        sum.strength[1] += weight * law.strength(p, broken);
        sum.stored += weight * law.stored(p);
    }
    for (double* const one : {&sum.force, &sum.force_on_ends[0], &sum.force_on_ends[1], &sum.strength[0],
                              &sum.strength[1], &sum.stored})
        *one *= length;
    sum.stiffness = law.stiffness(law.pressure((closing[0] + closing[1]) / 2));
    sum.stiffest = law.stiffness(law.pressure(std::max(closing[0], closing[1])));
    return sum;
}

} // namespace jointcreep::joint
