// Numbers and remarks in creepfit's summaries.

#pragma once

#include "estimation/instrument.hpp"

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

std::string noise_in_words(const estimation::Confidence& confidence, bool knows_deviations,
                           const estimation::Errors& errors);

} // namespace jointcreep::creepfit
