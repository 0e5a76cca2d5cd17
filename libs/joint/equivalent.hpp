// Strength averaging: joint traces and the rock bridges between them become one equivalent continuous joint
// (Jin, Zhang, Wang, Wang: Creep Modeling in Excavation Analysis of a High Rock Slope, ASCE 2003; Jennings
// 1970).

#pragma once

#include "model/network.hpp"
#include "model/scene.hpp"

namespace jointcreep::joint
{

struct Strength {
    double cohesion;         // [Pa]
    double friction_angle;   // [rad]
    double tensile_strength; // [Pa]
    double dilation_angle;   // [rad]
};

// Weighted by length, k = persistence, the fraction that is joint:
//     c = k c_j + (1 - k) c_r,   tan(phi) = k tan(phi_j) + (1 - k) tan(phi_r),   T = k T_j + (1 - k) T_r
// and tan(psi), of the dilation, as tan(phi).
Strength average(const Strength& joint, const Strength& rock, double persistence);

// The equivalent joint of every edge, with the joint fraction of that edge, or the persistence of its line or
// of its set inside the section, as the scene's averaging says. Of an edge on which its joint was carried on
// beyond its ends, the persistence of line or set counts for the part between these ends, and the rest is
// rock. The rock is the weaker of the two on the edge's sides, in cohesion, friction angle, tensile
// strength and dilation angle each by itself. Parameters that rock does not have go by their rows in the law's
// table (joint/parameter.hpp). Dilation ends where the joint's own does. Of residual strengths
//     c_res = k c_j,res,   tan(phi_res) = tan(phi_j,res):
// bridges break at the first slip, and lose their cohesion; the friction that is left is the joint's, or that
// of the mean if it is less. Stiffnesses and the
// constants of creep are the joint's own, or by another rule those of libs/joint/bridged.hpp, for
//  - the trace length: sum of L^2 / sum of L over the traces of the line (with averages over lines), or of
//    the set;
//  - the spacing: the area of the blocks where the set may be / length of its lines inside the section.
//    These blocks are those of its rocks; those with the centroid of their outer ring in its region (if
//    there are none, the area is the region's); or else all blocks;
//  - the rock: 1/E' the mean of the rocks' on the edge's sides.
// A stiffness is at most ten times that of a zone beside the edge, E (1 - nu) / ((1 + nu) (1 - 2 nu)) over
// the zone size, or the joint's own: rock bridges alone would be infinitely stiff. An edge that is all joint
// has the joint's stiffness whatever the rule, and so has a boundary edge that rests on a joint, with its
// strength too. Throws input_error where a joint has bridges whose law has no average with rock, where
// bridges run through rock without strength, where they make a joint that its law does not allow, or names are
// not in the scene.
EquivalentJoints average_strength(const Scene& scene, const Network& network);

// What the joint of an edge is made of, one of the scene's joint materials: its set's for the rock there,
// between two rocks the softer of both in normal direction; or what a boundary rests on.
const JointMaterial& material_of(const Scene& scene, const Network& network, std::size_t edge);

} // namespace jointcreep::joint
