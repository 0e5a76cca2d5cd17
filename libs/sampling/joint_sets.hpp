// From a scene's joint sets and single joints to joints: lines through the section, and the traces on them.
//
// Lines of a set. Their places along the set's mean normal in the section are a stationary renewal process:
// the intervals are the set's spacings over |n_p| (below), and of the one around the scene's origin
// (0, 0), which is drawn by its size-biased law, the origin takes a uniform point. Lines are numbered outward
// from there: 0, 1, 2, ... along the normal, -1, -2, ... against it. A line turns about a point of its own,
// uniform along the mean trace over a window: the extent of the region (of the outline, for a set without
// one) widened to multiples of the least power of two of metres above its length. So scatter does not fan out
// from one point, and a scanline along the mean normal meets 1/spacing lines a metre, whatever the scatter.
// Left out are lines from so far outside that they would have to lie 5 standard deviations, or 85 degrees,
// off.
//
// Traces on a line alternate with rock bridges from the line's own point outward. The point is in a trace
// with the probability `persistence`, and takes a uniform point of a size-biased one; bridges are negative
// exponential of mean E[L] (1 - persistence) / persistence, so that the alternation is stationary.
//
// What stays the same, byte for byte:
// - all joints of a set, whatever happens to other sets, to single joints and to their order in the scene;
// - the lines of a set, whatever happens to its lengths and persistence;
// - its lines and traces, whatever happens to its region or the outline, while the window stays the same (but
//   these end them where they do). With another window lines turn about other points and have other traces;
//   without scatter of the orientation they are still the same lines, to rounding;
// - everything, between machines of IEEE arithmetic whose exp, log, sin and cos round the same way.

#pragma once

#include "model/network.hpp"
#include "model/scene.hpp"

#include <cstdint>

namespace jointcreep
{

// A set's region may cut a line into pieces, each a joint of its own: number = line + piece * this, pieces
// counting from 0 along the line. |line| stays below half of it.
inline constexpr Index piece_step = Index{1} << 25;

// The part in the section of a joint plane's upward unit normal: n_p = n - (n . e_z) e_z, in the section's x
// and y. |n_p| is the sine of the angle between plane and section; joints of true spacing s are s / |n_p|
// apart in it. Angles [rad]: dip below the horizontal, dip direction and azimuth of +x clockwise from north.
Eigen::Vector2d section_normal(double dip, double dip_direction, double azimuth);

// The trace of such a plane in the section, counter-clockwise from +x, in [-pi/2, pi/2] for dips up to pi/2
// [rad]; meaningless for a plane parallel to the section, where n_p = 0.
double trace_angle(double dip, double dip_direction, double azimuth);

// All joints of the scene: those of its joint sets in order, then every single joint as a set of its own,
// number 0, its one trace covering it whole. Joints of a set without region reach beyond the outline at both
// ends; those of a set with a region reach beyond the region by 1e-6 of its size. Throws input_error: a
// material or an angle is missing, two sets' names share a key, a set is parallel to the section, its spacing
// or length is too small for the section, or the origin is too many spacings away.
Joints sample_joints(const Scene& scene, std::uint64_t seed, std::int32_t realization);

} // namespace jointcreep
