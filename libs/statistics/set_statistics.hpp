// One joint set against its laws: orientation, spacing, persistence, trace length and densities.
//
// What is looked at, so that no edge and no angle is favoured:
// - The scanline: the longest line along the set's mean normal inside the section, or inside the set's
//   region. A joint meets it whatever its orientation, so the joints that cross it have the orientations of
//   the law (libs/sampling/joint_sets.hpp). Their number gives the mean spacing and P10, with the variance of a
//   stationary renewal process.
// - The places of the lines, /joints/point, along the mean normal: the intervals between lines that follow
//   each other by number have the law of spacing, also where scatter of the angles hides it on a scanline.
// - All traces inside: P21 is their length over the area, P20 half the number of their ends over the area,
//   the mean trace length the one over the other (Mauldon, Dunne, Rohrbaugh 2001). Half an end is what an edge
//   leaves of a trace on average, so none of the three is biased by it.
// - Traces and intervals that begin and end inside have by law the distribution F(x) / F(r), where r is how
//   far the window continues from their beginning. Taken so, they follow each other as uniform numbers, and
//   Kolmogorov and Smirnov's test applies.
// - A circle inside, by the joint traces that cross it (n) and their ends in it (m): P21 = n / (4 r), P20 =
//   m / (2 pi r^2), mean length pi r n / (2 m) (Mauldon et al.; Zhang and Einstein 1998).
// - Segments and discs: those whose own point, /joints/point, is inside.

#pragma once

#include "model/grouped.hpp"
#include "model/network.hpp"
#include "model/scene.hpp"

namespace jointcreep::statistics
{

// Angles from the mean trace to traces, so many that each stands for the same share of the set's law [rad].
std::vector<double> turns_by_law(const Scene& scene, const JointSet& set);

// Unit vector along the mean trace, and the length of the mean normal's part in the section, |n_p| [-].
struct MeanTrace {
    Eigen::Vector2d along;
    double normal_part;
    Eigen::Vector2d across() const { return {-along.y(), along.x()}; }
};
MeanTrace mean_trace(const Scene& scene, const JointSet& set);

// Adds the rows of a set.
void add_set(Statistics& statistics, const Scene& scene, const Joints& joints, const Grouped<Index>& traces,
             Index set);

} // namespace jointcreep::statistics
