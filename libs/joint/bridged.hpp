// The springs and Kelvin constants of a joint whose traces are separated by rock bridges.
//
// Traces of length L, as far apart as the persistence k says, lie along a line with period 2 b = L / k in
// rock of E' = E / (1 - nu^2). A joint of the stiffness K_j [Pa/m] fills them. The mean displacement across
// the line is that of one continuous joint of the stiffness K_eq [Pa/m], normal and shear alike, each with
// its own K_j:
//
//     K_0 + K_j / k  <=  K_eq  <=  K_0 + 1.081 K_j / k ,     K_0 = pi E' / (8 b ln sec(pi k / 2))
//
// K_0 is that of empty traces (Koiter 1959; Tada, Paris, Irwin: Stress Analysis of Cracks Handbook). The
// bounds are those of least energy: the springs' share is least where all of a trace opens alike, and an
// empty trace alone opens as an ellipse, for which the mean square is (2 / 3) / (pi / 4)^2 = 1.081 of the
// square of the mean.

#pragma once

#include "model/scene.hpp"

#include <vector>

namespace jointcreep::joint
{

enum class Direction { normal, shear };

// A line of traces and bridges among its like.
struct BridgedLine {
    double persistence;   // k, above 0 and below 1 [-]
    double trace_length;  // L [m]
    double spacing;       // of parallel lines, S [m]; only the staggered rule asks for it
    double plane_modulus; // E' [Pa]
};

// K_eq = bridges + share K_j.
struct Bridging {
    double bridges = 0; // spring of the rock bridges, beside the joint [Pa/m]
    double share = 1;   // of the joint's own stiffness [-]
};

// By one of the rules; `stiffness` is K_j [Pa/m], on which the share of the staggered rule hangs a little. By
// that rule lines with a persistence below 0.01 are taken as alone.
Bridging bridging(StiffnessRule rule, const BridgedLine& line, double stiffness, Direction direction);

// K_eq L / (k E') of staggered lines: of parallel lines the spacing S apart, each shifted by b against its
// neighbours; `stiffness` is K_j L / (k E'), `spacing` S k / L. Their traces open as
//     D(x) = sum over j of a_j sqrt(1 - xi^2) U_2j(xi) ,     xi = 2 x / L ,
// with Chebyshev's polynomials U of the second kind and the a_j of least energy (Galerkin's method). A wave
// of the opening, of amplitude D and wave number q, puts -(E' / 4) q D (1 +- q y) exp(-q y) on the plane y
// away,
// + for the normal and - for the shear traction; the sum over all lines is closed. Eight terms are exact to
// 1e-3 where `spacing` is at least 1/8.
double staggered_stiffness(double persistence, double spacing, double stiffness, Direction direction);

// What acts along one direction of a joint: a spring, and in series Kelvin units and a Maxwell dashpot. All
// are those of JointMaterial; a viscosity of 0 is no dashpot.
struct JointChain {
    struct KelvinUnit {
        double stiffness; // [Pa/m]
        double viscosity; // [Pa s/m]
    };
    double spring; // [Pa/m]
    std::vector<KelvinUnit> units;
    double maxwell_viscosity; // [Pa s/m]
};

// The chain that creeps just as the spring `bridges` beside `share` times the joint does. The compliance of
// both is a sum of the same kind (its poles lie between those of the joint), so that this is exact: a Kelvin
// unit for every one of the joint, and one for its Maxwell dashpot, whose flow the bridges bring to an end.
JointChain bridged(const JointChain& joint, const Bridging& bridging);

} // namespace jointcreep::joint
