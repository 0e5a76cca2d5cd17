// Numbers and remarks in creepfit's summaries.

#pragma once

#include "program.hpp"

#include "estimation/confidence.hpp"

#include <cstddef>
#include <span>
#include <string>

namespace jointcreep::creepfit
{

std::string rounded(double value, int digits = 4);
// "0.9 to 1.2", or "0.9 to infinity".
std::string shown_interval(const estimation::Interval& interval);
// A length, without its unit.
std::string mm(double metres);
double root_mean_square(std::span<const double> values);

std::string noise_in_words(const estimation::Confidence& confidence, bool knows_deviations);

// Warns where residuals are correlated: intervals are then too narrow. `lag_one` is the correlation of neighbours
// [-].
void warn_of_lag(Summary& summary, const std::string& label, double lag_one, std::size_t readings);

} // namespace jointcreep::creepfit
