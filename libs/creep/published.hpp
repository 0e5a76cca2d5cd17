// Creep of joints by the paper's step (Eqs. 6-10), over any way of finding equilibrium.
//
// In series with its springs every contact has a Kelvin element per direction, whose displacement d follows
//     d' = (F - F_0 - E d) / eta,     lam = E / eta,  F the traction, F_0 the one under which it has long
//     crept.
// The step takes F as constant over dT at its value at the start,
//     d <- d exp(-lam dT) + (F - F_0) / E (1 - exp(-lam dT)),
// and then equilibrium follows with the springs' rest moved to the new d. For constant dT that is the same as
// the paper's force increments -K (d_new - d_old) (Eqs. 7-10), but it may change dT from step to step. On an
// open contact F is 0 and d goes on relaxing; no force comes of it.
//
// The step is exact where equilibrium fixes F. Where it does not, its first-order error grows without bound
// beyond longest_step.

#pragma once

#include "creep/creep.hpp"
#include "model/network.hpp"
#include "model/result.hpp"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace jointcreep::creep
{

class Published
{
public:
    // Contacts have long crept under `traction` [Pa], {normal, shear} each: creep counts from there.
    Published(const Mesh& mesh, const EquivalentJoints& joints, const std::vector<Eigen::Vector2d>& traction);

    // Lets the Kelvin elements creep for `duration` [s] under `traction` [Pa] and moves `offset` [m], the
    // rest of the contacts' springs, with them. The caller finds equilibrium.
    void advance(double duration, const std::vector<Eigen::Vector2d>& traction,
                 std::vector<Eigen::Vector2d>& offset);

private:
    struct Direction {
        double stiffness; // E [Pa/m]; 0 if it does not creep
        double viscosity; // eta [Pa s/m]
    };
    std::vector<std::array<Direction, 2>> contact_; // {normal, shear}
    std::vector<Eigen::Vector2d> first_traction_;
};

// Whether any joint creeps at all.
bool creeps(const EquivalentJoints& joints);

} // namespace jointcreep::creep
