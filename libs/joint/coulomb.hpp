// A joint's instantaneous law: springs along the normal and along the joint, no tension beyond the strength
// of its bonds, Coulomb friction, and dilation by slip.
//
//     sigma_n = sigma_0 + k_n (u_n - dilation)   up to the tensile strength; beyond, the joint opens
//     tau     = tau_0   + k_s (u_s - slip)       with |tau| <= c - sigma_n tan(phi)
//     d(dilation) = tan(psi) |d(slip)|           whichever way it slips
//
// with psi at most phi, or slip would give energy. That is the plastic flow of Coulomb's law with a potential
// of its own, psi in place of phi. A joint that is open shears without dilating. Where an end is given, the
// slip that has dilated, dilation / tan(psi), goes up to it and no farther; beyond it slip dilates no more.
//
// Opening breaks the joint's bonds: its cohesion and tensile strength are lost for good. (A cohesion that
// came back on closing would let a contact flicker between open and closed.) Slip alone leaves them, but
// where the joint `weakens`: then the first slip breaks them too, and what is left at once, by either way, is
// the residual cohesion and friction, c_r <= c and tan(phi_r) <= tan(phi), with tan(psi) <= tan(phi_r). Signs
// as in model/signs.hpp: tension and opening positive.

#pragma once

#include "model/result.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace jointcreep::joint
{

struct Coulomb {
    double k_n, k_s;         // [Pa/m]
    double cohesion;         // [Pa]
    double tan_phi;          // [-]
    double tensile_strength; // [Pa]
    double tan_psi = 0;      // of the dilation angle [-]
    bool weakens = false;    // by slip; without it a broken joint has no cohesion, and the friction it had
    double residual_cohesion = 0; // [Pa]
    double residual_tan_phi = 0;  // [-]
    double dilation_until = 0;    // slip at which dilation ends; 0: it does not [m]

    double cohesion_of(bool is_broken) const { return is_broken ? residual_cohesion : cohesion; }
    double tan_phi_of(bool is_broken) const { return is_broken && weakens ? residual_tan_phi : tan_phi; }
    double dilation_end() const // [m]
    {
        return dilation_until > 0 ? tan_psi * dilation_until : std::numeric_limits<double>::infinity();
    }
};

// What the joint remembers.
struct CoulombState {
    double slip = 0;     // [m]
    double dilation = 0; // opening by slip [m]
    bool is_broken = false;
};

struct Response {
    double sigma_n, tau; // [Pa]
    ContactStatus status;
};

// The traction at displacements u_n, u_s [m] from a state of traction sigma_0, tau_0 [Pa]; takes slip,
// dilation and breaking into `state`. The slip is found at once, with the traction it ends with (backward
// Euler). sigma_0 may be above the tensile strength: the joint is open then, by sigma_0 / k_n.
inline Response respond(const Coulomb& law, CoulombState& state, double sigma_0, double tau_0, double u_n,
                        double u_s)
{
    const double sigma_trial = sigma_0 + law.k_n * (u_n - state.dilation);
    const double tau_trial = tau_0 + law.k_s * (u_s - state.slip);
    const double give = law.k_s > 0 ? 1 / law.k_s : 0.0;
    // Slip presses a joint that dilates together, by this times itself, and its strength grows with that;
    // where it has none to begin with, under tension, it slips until no shear is left at most.
    const double left = std::max(0.0, law.dilation_end() - state.dilation);
    const double pressing = law.k_s > 0 && left > 0 ? law.k_n * law.tan_psi : 0.0;
    double cohesion = law.cohesion_of(state.is_broken), tan_phi = law.tan_phi_of(state.is_broken);
    const auto slipped = [&] {
        const double excess = std::abs(tau_trial) - (cohesion - sigma_trial * tan_phi),
                     most = std::abs(tau_trial) * give;
        const double slip = std::clamp(excess / (law.k_s + pressing * tan_phi), 0.0, most);
        if (slip * law.tan_psi <= left)
            return slip;
        return std::clamp((excess - law.k_n * left * tan_phi) / law.k_s, 0.0,
                          most); // dilation ends on the way
    };
    const auto pressed_by = [&](double slip) {
        return sigma_trial - (slip * law.tan_psi <= left ? pressing * slip : law.k_n * left);
    };
    const auto pressed = [&] { return pressing > 0 ? pressed_by(slipped()) : sigma_trial; };

    const bool opens = pressed() > (state.is_broken ? 0.0 : law.tensile_strength);
    const bool weakens = law.weakens && std::abs(tau_trial) > std::max(0.0, cohesion - sigma_trial * tan_phi);
    if (opens || weakens) {
        state.is_broken = true;
        cohesion = law.cohesion_of(true);
        tan_phi = law.tan_phi_of(true);
        if (pressed() > 0) {
            state.slip += tau_trial * give; // the joint closes again without shear
            return {0, 0, ContactStatus::open};
        }
    }
    const double limit = std::max(0.0, cohesion - sigma_trial * tan_phi);
    // A joint at its limit counts as slipping, also while it stands still there.
    if (std::abs(tau_trial) < (1 - 1e-6) * limit || tau_trial == 0)
        return {sigma_trial, tau_trial, ContactStatus::stuck};
    if (pressing == 0) {
        const double tau = std::copysign(std::min(limit, std::abs(tau_trial)), tau_trial);
        state.slip += (tau_trial - tau) * give;
        return {sigma_trial, tau, ContactStatus::slipping};
    }
    const double slip = slipped();
    state.slip += std::copysign(slip, tau_trial);
    state.dilation = std::min(state.dilation + slip * law.tan_psi, law.dilation_end());
    return {pressed_by(slip), std::copysign(std::abs(tau_trial) - law.k_s * slip, tau_trial),
            ContactStatus::slipping};
}

// Whether its stiffness is that of its springs, whatever the traction; its bonds [Pa]; what slip does to it.
inline bool is_linear(const Coulomb&)
{
    return true;
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

} // namespace jointcreep::joint
