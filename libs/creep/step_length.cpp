#include "creep/step_length.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace jointcreep::creep
{

namespace
{

constexpr double safety = 0.9, most_growth = 3, most_cut = 0.2;

} // namespace

StepLength::StepLength(const CreepSettings& settings, double fastest_rate, double longest_stable)
    : settings_(settings), first_(settings.first_step.value_or(0.1 / fastest_rate)),
      shortest_(settings.shortest_step.value_or(1e-3 * first_)),
      longest_(std::min(settings.longest_step.value_or(std::numeric_limits<double>::infinity()),
                        0.99 * longest_stable)),
      order_(is_second_order(settings.scheme) ? 3 : 2), wanted_(first_)
{
    shortest_ = std::min(shortest_, longest_);
}

double StepLength::next(double remaining, double longest) const
{
    longest = std::min(longest, settings_.step ? *settings_.step : std::clamp(wanted_, shortest_, longest_));
    const double n = std::ceil(remaining / longest * (1 - 1e-12));
    return settings_.step || n <= 2 ? remaining / n : longest;
}

bool StepLength::stands(double step, double error)
{
    if (settings_.step)
        return true;
    const double growth =
        error > 0 ? safety * std::pow(*settings_.tolerance / error, 1 / order_) : most_growth;
    const bool stands = error <= *settings_.tolerance || step <= shortest_;
    // A step shortened by a date does not shorten the next one.
    const double chosen = step * std::clamp(growth, most_cut, most_growth);
    wanted_ = std::clamp(stands && growth > 1 ? std::max(chosen, wanted_) : chosen, shortest_, longest_);
    return stands;
}

void StepLength::start_afresh()
{
    wanted_ = std::min(wanted_, first_);
}

double StepLength::closing_tolerance() const
{
    return settings_.tolerance ? *settings_.tolerance / 10 : 1e-6;
}

} // namespace jointcreep::creep
