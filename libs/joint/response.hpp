// Input and state of a joint law. `T` is double, or Dual for derivatives.

#pragma once

#include "joint/dual.hpp"
#include "model/result.hpp"

#include <algorithm>
#include <array>
#include <type_traits>

namespace jointcreep::joint
{

// A number of the law's kind: any number converts to it.
template <class T>
using Value = std::type_identity_t<T>;

// The state of a joint.
template <class T = double>
struct StateOf {
    T slip = 0;     // [m]
    T dilation = 0; // opening by slip [m]
    bool is_broken = false;
    std::array<T, 3> memory{}; // of the law; defined in its header
};
using State = StateOf<>;

template <class T = double>
struct ResponseOf {
    T sigma_n, tau; // [Pa]
    ContactStatus status;
};
using Response = ResponseOf<>;

// Shear traction of a spring [Pa] after a slide of `slid` [m] from the traction `last`, limited by the strength.
inline double spring_traction(double k_s, double last, double slid, double strength)
{
    return std::clamp(last + k_s * slid, -strength, strength);
}

// Change of a contact's traction for a small displacement: its springs; and where it slips, the change of strength over
// change of pressure, and of dilation over slip.
struct Slopes {
    double k_n, k_s;         // [Pa/m]
    double tan_phi, tan_psi; // [-]
    double cohesion;         // strength at no pressure [Pa]
};

// A law along an overlap with linear closing, per depth of the section; for a closed part alone.
struct AlongOverlap {
    double force;                        // normal force [N/m]
    std::array<double, 2> force_on_ends; // its parts on the ends, by the traction between them [N/m]
    std::array<double, 2> strength;      // shear strength: bonded, broken [N/m]
    double stored;                       // in the normal springs [J/m]
    double stiffness, stiffest;          // of the normal springs: in the middle, and the largest [Pa/m]
};

} // namespace jointcreep::joint
