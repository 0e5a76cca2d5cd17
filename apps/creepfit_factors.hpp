// The factors that creepfit finds, as the command line and the summary name them.

#pragma once

#include "back_analysis/back_analysis.hpp"

#include <string>
#include <vector>

namespace jointcreep::creepfit
{

using Factors = std::vector<back_analysis::Factor>;

// The name for --fit: "kelvin-stiffness", or "normal-kelvin-stiffness@fault".
std::string option_of(const back_analysis::Factor& factor);
// "Kelvin stiffness E", or "normal Kelvin stiffness E of fault".
std::string words_of(const back_analysis::Factor& factor);
// All that --fit may have, with `last` before the last one: "kelvin-stiffness, ... and horizontal-stress".
std::string all_options(const std::string& last);

// What --fit asks for: names, of joints perhaps with normal- or shear- before and @MATERIAL behind them, separated by
// commas, each with bounds LOW:HIGH or LOW:START:HIGH if given. Throws input_error.
Factors factors_in(const std::string& text);

// Where a search starts without START: from 1, or from the geometric mean of the bounds if 1 is outside them.
double usual_start(double low, double high);

// "kelvin-stiffness 1.1, joint-stiffness 0.95".
std::string in_words(const Factors& factors, const std::vector<double>& values);

} // namespace jointcreep::creepfit
