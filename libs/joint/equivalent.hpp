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

// The equivalent joint of each edge. k is the joint fraction of the edge, or the persistence of its line or of its set
// inside the section, as the scene's averaging says. If the joint of an edge was extended beyond its ends, the
// persistence of line or set counts for the part between these ends; the rest is rock. The rock is the weaker one on
// the two sides of the edge, separately for cohesion, friction angle, tensile strength and dilation angle. Rows in the
// law's table give the rules for parameters that rock does not have (joint/parameter.hpp). Dilation ends where the
// joint's own does. Residual strengths:
//     c_res = k c_j,res,   tan(phi_res) = tan(phi_j,res):
// bridges break at the first slip and lose their cohesion. The residual friction is the joint's, or the mean friction
// if that is less.
//
// Stiffnesses and creep constants are the joint's own, or by another rule those of libs/joint/bridged.hpp, for
//  - the trace length: sum of L^2 / sum of L over the traces of the line (with averages over lines), or of
//    the set;
//  - the spacing: the area of the blocks where the set may be / length of its lines inside the section.
//    These blocks are those of the set's rocks; or those with the centroid of their outer ring in its region (if
//    there are none, the area is the region's); or else all blocks;
//  - the rock: 1/E' is the mean of the rocks on the two sides of the edge.
// The limit of a stiffness is ten times the stiffness of a zone beside the edge, E (1 - nu) / ((1 + nu) (1 - 2 nu))
// over the zone size, or the joint's own if that is more: rock bridges alone would be infinitely stiff. An edge that is
// all joint has the joint's stiffness by every rule. So has a boundary edge that rests on a joint; it has the joint's
// strength, too. Throws input_error for a joint with bridges if its law has no average with rock, if the rock of the
// bridges has no strength, or if the law does not allow the equivalent joint; and for names that are not in the scene.
EquivalentJoints average_strength(const Scene& scene, const Network& network);

// The material of the joint on an edge, one of the scene's joint materials: that of its set for the rock there; between
// two rocks the softer one in normal direction; or the one that a boundary rests on.
const JointMaterial& material_of(const Scene& scene, const Network& network, std::size_t edge);

// That of every edge, into Scene::joint_materials; 0 without joint.
std::vector<Index> materials_of(const Scene& scene, const Network& network);

// The name of an edge's joint: its set, or the material of the joint that a boundary rests on.
std::string joint_name(const Scene& scene, const Network& network, Index edge);

} // namespace jointcreep::joint
