#include "creepfit_words.hpp"

#include <cmath>
#include <sstream>

namespace jointcreep::creepfit
{

using estimation::Confidence;
using estimation::Interval;

std::string rounded(double value, int digits)
{
    std::ostringstream text;
    text.precision(digits);
    text << value;
    return text.str();
}

std::string shown_interval(const Interval& interval)
{
    return rounded(interval.low) + " to " +
           (std::isfinite(interval.high) ? rounded(interval.high) : "infinity");
}

std::string mm(double metres)
{
    return rounded(metres / 1e-3);
}

double root_mean_square(std::span<const double> values)
{
    double squares = 0;
    for (const double value : values)
        squares += value * value;
    return std::sqrt(squares / static_cast<double>(values.size()));
}

std::string noise_in_words(const Confidence& confidence, bool knows_deviations,
                           const estimation::Errors& errors)
{
    if (errors.correlated)
        return "normal, correlated in time within each point and direction, as large as the residuals";
    if (errors.robust)
        return "independent, normal but for outliers, as large as the residuals";
    std::string words = "independent and normal, ";
    if (!knows_deviations)
        return words + "equal for all readings, as large as the residuals";
    if (!confidence.is_noise_from_residuals)
        return words + "with the readings' sigma";
    return words + "with the readings' sigma times " + rounded(confidence.noise_factor, 3) +
           ": the fit is worse than these allow, so intervals are wider";
}

} // namespace jointcreep::creepfit
