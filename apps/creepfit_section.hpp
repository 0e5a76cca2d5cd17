// creepfit of all joints of a section, through the solver (libs/back_analysis).

#pragma once

#include "program.hpp"

#include <vector>

namespace jointcreep::creepfit
{

// Its options alone.
std::vector<Option> section_options();

// Reads joints.h5 and the measurements, writes FOUND.csv and prints the summary. If the search does not converge it
// writes FOUND.failed.csv, and throws fit_error.
void fit_section(const Arguments& arguments);

} // namespace jointcreep::creepfit
