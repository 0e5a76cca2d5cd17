// Increments chosen by error. Slip and yield depend on the path. Where a load comes at once, dynamic relaxation
// overshoots, and slip that it leaves behind stays: the error decreases as one over the number of increments.

#pragma once

#include "model/result.hpp"

namespace jointcreep::analysis
{

// How far two results of the same section and the same states differ, the largest of [-]:
//   - the largest difference of a displacement, over the largest displacement of `finer`;
//   - the difference of normal tractions of contacts, over their change since the first state of `finer`, both as the root
//     of the sum of length times square; a change below a tenth of that of both tractions counts as this tenth;
//   - the same of shear tractions.
// Results with other numbers of states are compared in their last ones.
double change_between(const Result& coarser, const Result& finer);

} // namespace jointcreep::analysis
