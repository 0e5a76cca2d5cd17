// Dilation of a joint at large displacements, in one time step.
//
// Slip raises a joint that dilates by x, the same along the whole joint. x = sum of F tan(psi) slip(x) over sum of F,
// where F are the normal forces of its closed parts, and slip(x) reduces the shear force of a part to its strength
// after the rise. The right side falls with x.
//
// For laws whose dilation wears off, tan(psi) is the mean over the parts: the joint is raised as a whole. With a
// tan(psi) for each part, the rise would depend on where the pressure is. A block that rocks would then rock ever
// more.

#pragma once

#include "joint/law.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace jointcreep::joint
{

// A closed part of a joint.
struct ClosedPartOfJoint {
    const Law* law;
    State state;
    double length;     // [m]
    double sigma, tau; // mean tractions before the step [Pa]

    double pressed() const { return -sigma * length; } // [N/m]
};

// Relative displacement of the middle of a part in a step [m].
struct Moved {
    double opened, slid;
};

class RisingJoint
{
public:
    // Counts a part for the mean tan(psi) of laws whose dilation wears off. All parts come before the first add().
    void count(const ClosedPartOfJoint& part)
    {
        if (!wears(*part.law))
            return;
        worn_ += part.length * slopes(*part.law, part.state, part.sigma).tan_psi;
        worn_length_ += part.length;
    }

    // Adds a part; `find_move` is called for its Moved where it dilates.
    template <class FindMove>
    void add(const ClosedPartOfJoint& part, const FindMove& find_move)
    {
        if (part.pressed() <= 0)
            return;
        pressed_ += part.pressed();
        Slopes slopes = joint::slopes(*part.law, part.state, part.sigma);
        if (wears(*part.law))
            slopes.tan_psi = worn_length_ > 0 ? worn_ / worn_length_ : 0.0;
        if (slopes.tan_psi == 0 || slopes.k_s == 0)
            return;
        left_ = std::max(left_, dilation_end(*part.law) - part.state.dilation);
        sheared_.push_back(sheared(part, slopes, find_move()));
    }

    // The rise in this step [m].
    double rise() const
    {
        double low = 0, high = sheared_.empty() ? 0.0 : raising(0)[0], x = 0;
        if (high == 0)
            return 0;
        for (int i = 0; i < 100; ++i) { // Newton's method; exact once it is on the right straight piece
            const auto [raised, slope] = raising(x);
            (raised > x ? low : high) = x;
            double next = (raised + slope * x) / (1 + slope);
            if (!(next >= low && next <= high))
                next = (low + high) / 2;
            const double change = std::abs(next - x);
            x = next;
            if (change <= 1e-15 * x)
                break;
        }
        return std::min(x, left_);
    }

private:
    // A part that slips, or may slip, if its joint rises by x.
    struct Sheared {
        double share;          // F tan(psi), for the work [N/m]
        double trial, carries; // shear force without slip, and strength, at x = 0 [N/m]
        double rises, shears;  // strength over x, shear force over slip [Pa]
    };

    static bool wears(const Law& law) { return dilates(law) && remembers(law); }

    static Sheared sheared(const ClosedPartOfJoint& part, const Slopes& before, const Moved& moved)
    {
        const double trial = std::abs(part.tau + before.k_s * moved.slid) * part.length,
                     presses = part.pressed() - before.k_n * part.length * moved.opened;
        const auto strength = [&](const Slopes& now) {
            return now.cohesion * part.length + presses * now.tan_phi;
        };
        Slopes now = before;
        if (breaks_by_slip(*part.law, part.state.is_broken, trial, strength(before))) {
            State broken = part.state;
            broken.is_broken = true;
            now = slopes(*part.law, broken, part.sigma);
        }
        return {part.pressed() * before.tan_psi, trial, strength(now), now.tan_phi * before.k_n * part.length,
                before.k_s * part.length};
    }

    // sum of F tan(psi) slip(x) over sum of F [m], and the rate at which it falls [-].
    std::array<double, 2> raising(double x) const
    {
        std::array<double, 2> sum{0, 0};
        for (const Sheared& one : sheared_) {
            const double excess = one.trial - one.carries - one.rises * x;
            sum[0] += one.share / pressed_ * std::clamp(excess, 0.0, one.trial) / one.shears;
            if (excess > 0 && excess < one.trial)
                sum[1] += one.share / pressed_ * one.rises / one.shears;
        }
        return sum;
    }

    std::vector<Sheared> sheared_;
    double pressed_ = 0;                // sum of F [N/m]
    double left_ = 0;                   // dilation left until asperities are sheared off [m]
    double worn_ = 0, worn_length_ = 0; // sums of length tan(psi), and of length, of laws that wear [m]
};

} // namespace jointcreep::joint
