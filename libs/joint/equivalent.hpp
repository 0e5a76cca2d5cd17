// Strength averaging: joint traces and the rock bridges between them become one equivalent continuous joint
// (Jin, Zhang, Wang, Wang: Creep Modeling in Excavation Analysis of a High Rock Slope, ASCE 2003; Jennings
// 1970).

#pragma once

#include "model/network.hpp"
#include "model/scene.hpp"

namespace jointcreep
{

struct Strength {
    double cohesion;         // [Pa]
    double friction_angle;   // [rad]
    double tensile_strength; // [Pa]
};

// Weighted by length, k = persistence, the fraction that is joint:
//     c = k c_j + (1 - k) c_r,   tan(phi) = k tan(phi_j) + (1 - k) tan(phi_r),   T = k T_j + (1 - k) T_r
Strength average(const Strength& joint, const Strength& rock, double persistence);

// The equivalent joint of every edge, by that edge's own joint fraction. The rock is the weaker of the two on
// its sides, in cohesion, friction angle and tensile strength each by itself. Stiffnesses and the constants
// of creep are the joint's own. A boundary edge that rests on a joint has that joint's material whole.
// Throws input_error where bridges run through rock without strength, or names are not in the scene.
EquivalentJoints average_strength(const Scene& scene, const Network& network);

} // namespace jointcreep
