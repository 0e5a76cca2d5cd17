// Along a joint, traces and rock bridges in turn: where they lie inside the section.

#pragma once

#include "model/network.hpp"
#include "model/scene.hpp"

namespace jointcreep::joint
{

// The pieces of all joints inside the section, its outline without its holes, in the joints' order and along
// each from `from` to `to`. Traces that overlap are one piece. A line that leaves the section and comes back,
// or crosses a hole, has pieces on both sides of the gap. Ends and gaps shorter than 1e-9 of the line are
// rounding and are left out.
Pieces pieces_of(const Joints& joints, const Polygon& outline, const std::vector<Polygon>& holes);

// Expected standard error of the persistence of lines with the lengths `line_length` [m], on which traces by
// the law `length` alternate with negative exponential bridges: traces and bridges are an alternating renewal
// process, and so the variance on a line of length T tends to
//     (Var L E[G]^2 + Var G E[L]^2) / ((E[L] + E[G])^3 T)        (Cox, Renewal Theory, 1962, ch. 7)
// and never exceeds k (1 - k), which it has on a line that is short beside them. 0 < persistence < 1.
double persistence_error(const ProbabilityLaw& length, double persistence,
                         const std::vector<double>& line_length);

} // namespace jointcreep::joint
