// The springs and Kelvin constants of a joint whose traces are separated by rock bridges.
//
// Traces of length L lie along a line with period 2 b = L / k, where k is the persistence, in rock of E' = E / (1 -
// nu^2). They are filled by a joint of the stiffness K_j [Pa/m]. The equivalent continuous joint has the stiffness K_eq
// [Pa/m] and the same mean displacement across the line, in normal and in shear direction, each with its own K_j:
//
//     K_0 + K_j / k  <=  K_eq  <=  K_0 + 1.081 K_j / k ,     K_0 = pi E' / (8 b ln sec(pi k / 2))
//
// K_0 is that of empty traces (Koiter 1959; Tada, Paris, Irwin: Stress Analysis of Cracks Handbook). Both bounds are of
// least energy. The energy of the springs is least for uniform opening of a trace. An empty trace alone opens as an
// ellipse, whose mean square is (2 / 3) / (pi / 4)^2 = 1.081 times the square of the mean.

#pragma once

#include "model/chain.hpp"
#include "model/scene.hpp"

#include <vector>

namespace jointcreep::joint
{

enum class Direction { normal, shear };

// A line of traces and bridges among parallel lines.
struct BridgedLine {
    double persistence;   // k, above 0 and below 1 [-]
    double trace_length;  // L [m]
    double spacing;       // of parallel lines, S [m]; used by the staggered rule only
    double plane_modulus; // E' [Pa]
};

// K_eq = bridges + share K_j.
struct Bridging {
    double bridges = 0; // spring of the rock bridges, beside the joint [Pa/m]
    double share = 1;   // of the joint's own stiffness [-]
};

// By one of the rules. `stiffness` is K_j [Pa/m]; the share of the staggered rule depends slightly on it. By that rule
// lines with a persistence below 0.01 count as single lines.
Bridging bridging(StiffnessRule rule, const BridgedLine& line, double stiffness, Direction direction);

// K_eq L / (k E') of staggered lines: parallel lines at the spacing S, each shifted by b against its neighbours;
// `stiffness` is K_j L / (k E'), `spacing` S k / L. Their traces open as
//     D(x) = sum over j of a_j sqrt(1 - xi^2) U_2j(xi) ,     xi = 2 x / L ,
// with Chebyshev's polynomials U of the second kind and the a_j of least energy (Galerkin's method). A wave of the
// opening, of amplitude D and wave number q, exerts the traction -(E' / 4) q D (1 +- q y) exp(-q y) on a plane at the
// distance y, + for the normal and - for the shear traction. The sum over all lines has a closed form. Eight terms are
// exact to 1e-3 where `spacing` is at least 1/8.
double staggered_stiffness(double persistence, double spacing, double stiffness, Direction direction);

// Elements along one direction of a joint: a spring, in series with Kelvin units and a Maxwell dashpot. All are those
// of JointMaterial; a viscosity of 0 means no dashpot.
struct JointChain {
    double spring; // [Pa/m]
    std::vector<KelvinUnit> units;
    double maxwell_viscosity; // [Pa s/m]
};

// That of a joint without rock bridges.
JointChain joint_chain_of(const JointMaterial& material, Direction direction);

// The chain with the same creep as the spring `bridges` beside `share` times the joint. The compliance of both is a sum
// of the same kind (its poles are between those of the joint), so this is exact. It has a Kelvin unit for each one of
// the joint, and one for its Maxwell dashpot, whose flow the bridges stop.
JointChain bridged(const JointChain& joint, const Bridging& bridging);

} // namespace jointcreep::joint
