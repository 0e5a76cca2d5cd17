// Makes joints, and the traces on them, from a scene's joint sets, single joints and mapped sets. Orientations are
// in orientations.hpp, densities in density.hpp.
//
// Sets of lines. Their places along the set's mean normal in the section are a stationary renewal process:
// the intervals are the set's spacings over |n_p|, or of the mean that density.hpp says, and of the one
// around the scene's origin (0, 0), which is drawn by its size-biased law, the origin takes a uniform point.
// Lines are numbered outward from there: 0, 1, 2, ... along the normal, -1, -2, ... against it. A line turns
// about a point of its own, uniform along the mean trace over a window: the extent of the region (of the
// outline, for a set without one) widened to multiples of the least power of two of metres above its length.
// So scatter does not fan out from one point, and a scanline along the mean normal meets 1/spacing lines a
// metre, whatever the scatter. Left out are lines from so far outside that they would have to lie 5 standard
// deviations, or 85 degrees, off.
//
// Traces on a line alternate with rock bridges from the line's own point outward. The point is in a trace
// with the probability `persistence`, and takes a uniform point of a size-biased one; bridges are negative
// exponential of mean E[L] (1 - persistence) / persistence, so that the alternation is stationary.
//
// Sets of segments and of discs are traces about Poisson points of the section, their midpoints. A segment
// takes its length from the law. The trace of a disc is the chord at a uniform distance from the centre of a
// disc of size-biased diameter, as a section meets it (Warburton 1980). Diameter and centre are kept: the disc's plane
// and the chord fix where the centre is, on one side of the section or the other. Midpoints outside the section are
// drawn as far away as traces come in from, so densities are the same up to the section's edge (density.hpp).
// A trace is one joint with one joint trace covering it whole, also where it reaches out of the section; a
// region or rock cuts it off, with an overshoot.
//
// Terminations. A trace grows from its midpoint in both directions, and at each crossing, inside the section, with a
// joint trace (not a rock bridge) of a set in `terminates_at` it ends with `termination_probability`. It ends
// on the other trace, to rounding: blocks::cut makes joints longer by its shortest edge at both ends before
// it looks for crossings, and removes overlap that crosses nothing, so that the end becomes a T node. A trace
// whose midpoint is outside the section is not ended out there, where joints are not all known: near the
// section's edges a few more traces go through. Density targets are those before terminations.
//
// What stays the same, byte for byte:
// - all joints of a set, whatever happens to other sets, to single joints and to their order in the scene;
//   but its traces end where those of its `terminates_at` are;
// - the lines of a set, whatever happens to its lengths and persistence;
// - its lines and traces, whatever happens to its region or the outline, while the window stays the same (but
//   these end them where they do). With another window lines turn about other points and have other traces;
//   without scatter of the orientation they are still the same lines, to rounding;
// - segments and discs likewise, while their own window stays the same: the bounding box, each side widened
//   to multiples of an eighth of the least power of two above its length;
// - everything, between machines of IEEE arithmetic whose exp, log, sin and cos round the same way.

#pragma once

#include "model/network.hpp"
#include "model/scene.hpp"
#include "sampling/orientations.hpp"

#include <cstdint>

namespace jointcreep::sampling
{

// A set's region may cut a line into pieces, each a joint of its own: number = line + piece * this, pieces
// counting from 0 along the line. |line| stays below half of it.
inline constexpr Index piece_step = Index{1} << 25;

// The straight pieces of a mapped trace are joints of their own: number = id of the trace * this + piece,
// pieces counting from 0 along the trace and on through its polylines.
inline constexpr Index mapped_step = 1024;

// The sets by their rows, each after those it terminates at. Throws input_error where they go in a circle.
std::vector<std::size_t> sampling_order(const std::vector<JointSet>& sets);

// All joints of the scene: those of its joint sets in order, then every single joint as a set of its own,
// number 0, its one trace covering it whole, then the mapped sets, each straight piece likewise. Joints of a
// set without region reach beyond the outline at both ends; those of a set with a region reach beyond the
// region by 1e-6 of its size. Throws input_error: a material or an angle is missing, two sets' names share a
// key, a set is parallel to the section, its spacing or length is too small for the section or its density
// too large, the origin is too many spacings away, or sets end at each other in a circle.
Joints sample_joints(const Scene& scene, std::uint64_t seed, std::int32_t realization);

} // namespace jointcreep::sampling
