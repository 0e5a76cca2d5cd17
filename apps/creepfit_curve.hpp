// creepfit of one joint, from one curve (estimation/creep_curve.hpp).

#pragma once

#include "program.hpp"

#include <vector>

namespace jointcreep::creepfit
{

// Its options alone.
std::vector<Option> curve_options();

// Reads CURVE.csv, writes FOUND.csv and prints the summary.
void fit_curve(const Arguments& arguments);

} // namespace jointcreep::creepfit
