// Joint traces and rock bridges along a joint: where they are inside the section.

#pragma once

#include "model/network.hpp"
#include "model/scene.hpp"

namespace jointcreep::joint
{

// The pieces of all joints inside the section (its outline without its holes), in the order of the joints and along
// each joint from `from` to `to`. Traces that overlap are one piece. A line that leaves the section and returns, or
// crosses a hole, has pieces on both sides of the gap. Ends and gaps shorter than 1e-9 of the line are rounding, and
// left out.
Pieces pieces_of(const Joints& joints, const Polygon& outline, const std::vector<Polygon>& holes);

// Expected standard error of the persistence of lines with the lengths `line_length` [m]. Traces by the law `length`
// alternate with negative exponential bridges. Both form an alternating renewal process. So the variance on a line of
// length T tends to
//     (Var L E[G]^2 + Var G E[L]^2) / ((E[L] + E[G])^3 T)        (Cox, Renewal Theory, 1962, ch. 7)
// and never exceeds k (1 - k), its value on a line much shorter than traces and bridges. 0 < persistence < 1.
double persistence_error(const ProbabilityLaw& length, double persistence,
                         const std::vector<double>& line_length);

} // namespace jointcreep::joint
