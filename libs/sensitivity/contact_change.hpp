// What the traction, slip and dilation of a contact change by, to first order, when its springs, its state at
// the start, and its displacement change: the derivative of joint/coulomb.hpp on the branch that the contact
// is on. At the border between two branches there are two derivatives, and this is one of them.
//
// With sigma = sigma_0 + k_n (u_n - dilation) and tau_trial = tau_0 + k_s (u_s - slip), slip and dilation
// being those at the start,
//     open       sigma_n = tau = 0;   slip + tau_trial / k_s
//     stuck      sigma_n = sigma,   tau = tau_trial
//     slipping   by delta = (|tau_trial| - c + sigma tan(phi)) / (k_s + k_n tan(phi) tan(psi)), or, where no
//                strength is left, |tau_trial| / k_s:   slip + -delta, dilation + delta tan(psi),
//                sigma_n = sigma - k_n delta tan(psi),   tau = +-(|tau_trial| - k_s delta) .

#pragma once

#include "implicit/stiffness.hpp"
#include "joint/coulomb.hpp"

namespace jointcreep::sensitivity
{

using Eigen::Vector2d;

enum class Branch : char { removed, open, stuck, slips, slips_without_strength };

// Pairs are {normal, shear}.
struct ContactNow {
    joint::Coulomb law; // its friction that of now, also where its bonds are broken
    Branch branch;
    double sign;           // of the slip
    Vector2d spring;       // u_n, u_s: the relative displacement less the offset [m]
    double initial_shear;  // tau_0 [Pa]
    double slip, dilation; // at the start [m]
    double slipped;        // delta [m]
};

struct ContactChange {
    Vector2d stiffness, initial_traction, spring;
    double slip, dilation; // at the start
};

struct ResponseChange {
    Vector2d traction;
    double slip, dilation; // at the end
};

inline ResponseChange respond(const ContactNow& now, const ContactChange& by)
{
    const joint::Coulomb& law = now.law;
    const double sigma = by.initial_traction.x() + by.stiffness.x() * (now.spring.x() - now.dilation) +
                         law.k_n * (by.spring.x() - by.dilation),
                 tau_trial = by.initial_traction.y() + by.stiffness.y() * (now.spring.y() - now.slip) +
                             law.k_s * (by.spring.y() - by.slip);
    switch (now.branch) {
    case Branch::removed:
        return {Vector2d::Zero(), by.slip, by.dilation};
    case Branch::stuck:
        return {{sigma, tau_trial}, by.slip, by.dilation};
    case Branch::open: {
        const double slip =
            law.k_s == 0
                ? 0.0
                : by.spring.y() +
                      (by.initial_traction.y() - now.initial_shear / law.k_s * by.stiffness.y()) / law.k_s;
        return {Vector2d::Zero(), slip, by.dilation};
    }
    default:
        break;
    }
    const bool has_strength = now.branch == Branch::slips;
    const double firmness = has_strength ? law.k_s + law.k_n * law.tan_phi * law.tan_psi : law.k_s,
                 firmness_change =
                     by.stiffness.y() + (has_strength ? by.stiffness.x() * law.tan_phi * law.tan_psi : 0.0),
                 excess_change = now.sign * tau_trial + (has_strength ? sigma * law.tan_phi : 0.0);
    const double slipped = (excess_change - now.slipped * firmness_change) / firmness;
    return {{sigma - (by.stiffness.x() * now.slipped + law.k_n * slipped) * law.tan_psi,
             tau_trial - now.sign * (by.stiffness.y() * now.slipped + law.k_s * slipped)},
            by.slip + now.sign * slipped,
            by.dilation + slipped * law.tan_psi};
}

// Change of its traction over change of its relative displacement.
inline implicit::Tangent tangent_of(const ContactNow& now)
{
    const joint::Coulomb& law = now.law;
    switch (now.branch) {
    case Branch::stuck:
        return {law.k_n, law.k_s, 0, 0};
    case Branch::slips: {
        const double k = law.k_n * law.k_s / (law.k_s + law.k_n * law.tan_phi * law.tan_psi);
        return {k, k * law.tan_phi * law.tan_psi, -now.sign * k * law.tan_phi, -now.sign * k * law.tan_psi};
    }
    case Branch::slips_without_strength:
        return {law.k_n, 0, 0, -now.sign * law.k_n * law.tan_psi};
    default:
        return {0, 0, 0, 0};
    }
}

} // namespace jointcreep::sensitivity
