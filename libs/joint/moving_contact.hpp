// A joint between two faces at large displacements, in one time step.
//
// The closing is linear along the overlap of the faces. Springs and strength are integrated over the closed part
// (along_overlap() of the law). Forces are per depth of the section. Forces on the two ends follow from the traction
// between them. Positions of the faces and the direction of the normal are not known here.

#pragma once

#include "joint/law.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace jointcreep::joint
{

// The part of an overlap that is closed.
struct ClosedPart {
    std::array<double, 2> closing;       // at its ends [m]
    std::array<double, 2> ends = {0, 1}; // as fractions of the overlap

    // Without bonds, only where closing is positive.
    void leave_bonds()
    {
        const double zero = closing[0] / (closing[0] - closing[1]);
        if (closing[0] < 0)
            ends[0] = zero;
        else if (closing[1] < 0)
            ends[1] = zero;
        closing = {std::max(closing[0], 0.0), std::max(closing[1], 0.0)};
    }
};

// Whether bonds are pulled apart at an end of the overlap.
inline bool breaks(const Law& law, const std::array<double, 2>& closing)
{
    return -k_n(law) * std::min(closing[0], closing[1]) > tensile_strength(law);
}

// Motion of a closed part along its normal in a step.
struct NormalMove {
    std::array<double, 2> opening; // of its ends [m]
    double raised;                 // of that, by dilation: not counted for springs and dashpots [m]
    double opened_before;          // of its middle in the step before, without dilation [m]
    bool was_closed;               // in the step before

    double opened() const { return (opening[0] + opening[1]) / 2 - raised; } // its middle [m]

    // A contact is closed for only a part of a step if it closes in this step, or opens in the next. `deep`: its
    // closing in the middle [m].
    double part_of_time(double deep) const
    {
        const double now = opened();
        if (!was_closed && deep < -now)
            return (1 - deep / now) / 2;
        if (was_closed && now > 0) {
            const double next = now + (now - opened_before) * deep / (deep + now); // as forces do
            if (next > deep)
                return (now + deep) / (now + next);
        }
        return 1;
    }
};

// Forces on each end: of springs, which press, and of dashpots [N/m].
struct NormalForce {
    std::array<double, 2> pressed, held;
};

// `dashpots`: over springs, by displacements in this step [-]; `closed`: the law on this part.
inline NormalForce normal_force(const AlongOverlap& closed, const ClosedPart& part, double length,
                                const NormalMove& move, double dashpots, bool is_bonded)
{
    const double acts = is_bonded ? 1.0 : move.part_of_time((part.closing[0] + part.closing[1]) / 2);
    NormalForce force{};
    for (int i = 0; i < 2; ++i) {
        force.pressed[i] = acts * closed.force_on_ends[i];
        force.held[i] = dashpots * closed.stiffness * length / 2 * (move.opening[i] - move.raised);
        if (!is_bonded)
            force.held[i] = std::min(force.held[i], force.pressed[i]);
    }
    return force;
}

// The shear force of a closed part in a step.
struct ShearMove {
    double length; // of the part [m]
    double slid;   // [m]
    double last;   // force a step before [N/m]
    double kept;   // of that, on the part still closed [N/m]
    double trial;  // force without slip [N/m]
};

// From the traction `tau` [Pa] on the part that was closed a step before.
inline ShearMove shear_move(const Law& law, double tau, double last_length, double length, double slid)
{
    // A part that opens loses its shear force; a part that closes starts with none.
    const double kept = tau * std::min(last_length, length);
    return {length, slid, tau * last_length, kept, kept + k_s(law) * slid * length};
}
// For a pair that has not carried a force yet, but has the traction `tau` [Pa].
inline ShearMove first_shear_move(const Law& law, double tau, double length, double slid)
{
    const double kept = tau * length;
    return {length, slid, 0, kept, kept + k_s(law) * slid * length};
}

// The shear force, limited by the strength [N/m]; updates the joint's memory in `state`.
inline double shear_force(const Law& law, State& state, const ShearMove& move, double limit)
{
    if (!remembers(law) || !(move.length > 0))
        return std::clamp(move.trial, -limit, limit);
    const double tau = shear(law, state, move.kept / move.length, move.slid, limit / move.length);
    const double force = tau * move.length;
    return std::abs(force - move.trial) <= 1e-12 * limit ? move.trial : force; // equal within rounding
}

// Force of dashpots to add to it [N/m]; 0 where it slips.
inline double shear_held(const Law& law, const ShearMove& move, double force, double limit, double dashpots)
{
    if (force != move.trial)
        return 0;
    return std::clamp(force + dashpots * k_s(law) * move.length * move.slid, -limit, limit) - force;
}

// Energy of the shear springs at a force [N/m] along a length [J/m].
inline double stored_in_shear(const Law& law, double force, double length)
{
    return k_s(law) > 0 && length > 0 ? force * force / (2 * k_s(law) * length) : 0.0;
}

// Energy lost by slip to this force [J/m].
inline double taken_by_slip(const Law& law, const ShearMove& move, double force)
{
    return force != move.trial && k_s(law) > 0 && move.length > 0
               ? (move.kept + force) / 2 * (move.trial - force) / (k_s(law) * move.length)
               : 0.0;
}

// Energy lost with the part that opens, of the energy `sheared_in` of the shear springs [J/m].
inline double taken_by_opening(const Law& law, const ShearMove& move, double sheared_in)
{
    return sheared_in - stored_in_shear(law, move.kept, move.length) +
           (move.last - move.kept) / 2 * move.slid;
}

} // namespace jointcreep::joint
