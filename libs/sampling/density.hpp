// How much of a set a section holds: from its spacing, or from a target that was measured otherwise.
//
// With the set's rose of all joints in space by area (orientations.hpp), means over it, and unit vectors v
// along a scanline, m normal to the mean trace in the section, n_m along the mean pole:
//     P21 = P32 <|n_p|>        P10(v) = P32 <|n.v|>
//     discs:     P32 = P30 pi E[D^2] / 4,   P20 = P30 E[D] <|n_p|>,   P21 / P20 = pi E[D^2] / (4 E[D])
//     segments:  P21 = P20 E[l]
//     lines:     P21 = k L,  L = <|n_p|> / (s' <|n.m|>),  k persistence, s' mean spacing along m
// (Terzaghi 1965; Warburton 1980; Dershowitz and Herda 1992.) For a set without scatter they are Terzaghi's
// correction of a scanline at the angle d to the normal, P10 = cos(d) / s, and s' = s / |n_p|. A bootstrap's
// true spacing s gives s' = s <|n.n_m|> / <|n.m|>; the other laws of lines are laws along m in the section
// already, and theirs gives s' = s / |n_p| of the mean plane.

#pragma once

#include "model/scene.hpp"

#include <Eigen/Core>

namespace jointcreep::sampling
{

// Expected densities of a set's joint traces in the section and, where the set has an orientation in space,
// in space; before any termination.
struct SetDensity {
    double p21 = 0;     // [1/m]
    double p20 = 0;     // of segments and discs [1/m2]
    double p32 = 0;     // in space [1/m]
    double p30 = 0;     // of discs [1/m3]
    double spacing = 0; // of lines: mean along the normal of the mean trace, in the section [m]
};

// Throws input_error as Orientations does, and where a target asks what the set's kind has not, or a scanline
// that meets next to none of its joints.
SetDensity density_of(const JointSet& set, const Scene& scene);

// Joint traces that a scanline along a unit vector of the section's frame meets, per length [1/m].
double expected_p10(const JointSet& set, const Scene& scene, const Eigen::Vector3d& direction);

} // namespace jointcreep::sampling
