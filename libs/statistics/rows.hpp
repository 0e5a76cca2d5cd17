// The rows of a report while it is made.

#pragma once

#include "model/statistics.hpp"
#include "statistics/distribution.hpp"

#include <optional>
#include <string>

namespace jointcreep::statistics
{

inline constexpr double confidence = 0.95;       // of the intervals
inline constexpr double false_alarm_rate = 0.01; // of a run
inline constexpr std::size_t least_sample = 10;  // for a verdict

struct Row {
    std::string quantity;
    std::string unit; // of achieved value, target and interval
    double achieved = 0;
    std::size_t sample_size = 0;
    std::optional<double> target{};
    std::optional<Range> interval{};
    std::optional<double> p_value{}; // judged by it [-]; or
    std::optional<bool> is_exact{};  // a target that leaves nothing to chance is met
    bool is_judged = false;          // too few, if neither is there

    // By a test of its law.
    void judge(const Fit& fit)
    {
        achieved = fit.distance;
        p_value = fit.p_value;
    }
};

void add(Statistics& statistics, const std::string& subject, const Row& row);

// Verdicts of all tested rows. A row fails where its p-value is below the false-alarm rate over the number of
// tested rows (Bonferroni). So a right network fails anywhere at most at that rate, even where rows are correlated.
void judge(Statistics& statistics);

} // namespace jointcreep::statistics
