// What a joint law is asked for and what it remembers. `T` is double, or Dual for derivatives.

#pragma once

#include "joint/dual.hpp"
#include "model/result.hpp"

#include <algorithm>
#include <array>
#include <type_traits>

namespace jointcreep::joint
{

// A number of the kind that the law has: any number converts to it.
template <class T>
using Value = std::type_identity_t<T>;

// What a joint remembers.
template <class T = double>
struct StateOf {
    T slip = 0;     // [m]
    T dilation = 0; // opening by slip [m]
    bool is_broken = false;
    std::array<T, 3> memory{}; // of the law's own; what it means is in its header
};
using State = StateOf<>;

template <class T = double>
struct ResponseOf {
    T sigma_n, tau; // [Pa]
    ContactStatus status;
};
using Response = ResponseOf<>;

// Shear traction of a spring [Pa] after it slid by `slid` [m] from the traction `last`, within the strength.
inline double spring_traction(double k_s, double last, double slid, double strength)
{
    return std::clamp(last + k_s * slid, -strength, strength);
}

// How a contact changes for a small displacement from where it is: its springs; and where it slips, the
// change of strength over that of pressure, and of dilation over slip.
struct Slopes {
    double k_n, k_s;         // [Pa/m]
    double tan_phi, tan_psi; // [-]
    double cohesion;         // strength that this leaves at no pressure [Pa]
};

// A law along an overlap on which the closing is linear, per depth of the section; of a closed part alone.
struct AlongOverlap {
    double force;                        // that presses [N/m]
    std::array<double, 2> force_on_ends; // the parts of it on the ends: as the traction between them [N/m]
    std::array<double, 2> strength;      // shear force that it carries: bonded, broken [N/m]
    double stored;                       // in the normal springs [J/m]
    double stiffness, stiffest;          // of the normal springs: in the middle, where it is largest [Pa/m]
};

} // namespace jointcreep::joint
