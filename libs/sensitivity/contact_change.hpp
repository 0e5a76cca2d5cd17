// What the traction and the slip of a contact change by, to first order, when its springs, its state at the
// start, and its displacement change: the derivative of joint/coulomb.hpp on the branch that the contact is
// on. At the border between two branches there are two derivatives, and this is one of them.
//
//     open      sigma_n = tau = 0                                   slip = u_s + tau_0 / k_s
//     stuck     sigma_n = sigma_0 + k_n u_n,   tau = tau_0 + k_s (u_s - slip)
//     slipping  sigma_n the same,  tau = +-(c - sigma_n tan(phi))    slip = u_s + (tau_0 - tau) / k_s
//
// Open and slipping contacts forget the slip that they had before.

#pragma once

#include "implicit/stiffness.hpp"
#include "joint/coulomb.hpp"

namespace jointcreep::sensitivity
{

using Eigen::Vector2d;

enum class Branch : char { removed, open, stuck, slips_forward, slips_backward };

// Pairs are {normal, shear}.
struct ContactNow {
    joint::Coulomb law;
    Branch branch;
    Vector2d initial_traction; // sigma_0, tau_0 [Pa]
    Vector2d spring;           // u_n, u_s: the jump less the offset [m]
    Vector2d traction;         // [Pa]
    double slip;               // [m]
    bool has_strength = true;  // slipping below a limit above 0
};

struct ContactChange {
    Vector2d stiffness, initial_traction, spring;
    double slip; // at the start
};

struct ResponseChange {
    Vector2d traction;
    double slip;
};

inline ResponseChange respond(const ContactNow& now, const ContactChange& by)
{
    const Vector2d stiffness(now.law.k_n, now.law.k_s);
    const double slip = now.branch == Branch::stuck ? by.slip : 0.0;
    // As long as it holds.
    Vector2d traction = by.initial_traction;
    traction.x() += by.stiffness.x() * now.spring.x() + stiffness.x() * by.spring.x();
    traction.y() += by.stiffness.y() * (now.spring.y() - now.slip) + stiffness.y() * (by.spring.y() - slip);
    switch (now.branch) {
    case Branch::removed:
        return {Vector2d::Zero(), by.slip};
    case Branch::stuck:
        return {traction, by.slip};
    case Branch::open:
        traction.setZero();
        break;
    case Branch::slips_forward:
    case Branch::slips_backward:
        traction.y() = now.has_strength
                           ? (now.branch == Branch::slips_forward ? -1 : 1) * now.law.tan_phi * traction.x()
                           : 0.0;
    }
    if (stiffness.y() == 0) // smooth: slip means nothing
        return {traction, 0};
    return {traction, by.spring.y() + (by.initial_traction.y() - traction.y()) / stiffness.y() -
                          (now.initial_traction.y() - now.traction.y()) / (stiffness.y() * stiffness.y()) *
                              by.stiffness.y()};
}

// Change of its traction over change of its jump.
inline implicit::Tangent tangent_of(const ContactNow& now)
{
    switch (now.branch) {
    case Branch::stuck:
        return {now.law.k_n, now.law.k_s, 0};
    case Branch::slips_forward:
    case Branch::slips_backward:
        return {now.law.k_n, 0,
                now.has_strength
                    ? (now.branch == Branch::slips_forward ? -1 : 1) * now.law.tan_phi * now.law.k_n
                    : 0.0};
    default:
        return {0, 0, 0};
    }
}

} // namespace jointcreep::sensitivity
