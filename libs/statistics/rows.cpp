#include "statistics/rows.hpp"

#include <algorithm>
#include <cmath>

namespace jointcreep::statistics
{

void add(Statistics& statistics, const std::string& subject, const Row& row)
{
    const Range interval = row.interval.value_or(Range{row.achieved, row.achieved});
    const bool has_interval = row.interval && std::isfinite(interval.low) && std::isfinite(interval.high);
    statistics.subject.push_back(subject);
    statistics.quantity.push_back(row.quantity);
    statistics.unit.push_back(row.unit);
    statistics.has_target.push_back(row.target.has_value());
    statistics.target.push_back(row.target.value_or(0));
    statistics.achieved.push_back(row.achieved);
    statistics.has_interval.push_back(has_interval);
    statistics.low.push_back(has_interval ? interval.low : row.achieved);
    statistics.high.push_back(has_interval ? interval.high : row.achieved);
    statistics.sample_size.push_back(static_cast<Index>(row.sample_size));
    const bool is_tested = row.p_value && std::isfinite(*row.p_value);
    statistics.is_tested.push_back(is_tested);
    statistics.p_value.push_back(is_tested ? std::clamp(*row.p_value, 0.0, 1.0) : 1);
    Verdict verdict = row.is_judged ? Verdict::too_few : Verdict::none;
    if (row.is_exact)
        verdict = *row.is_exact ? Verdict::pass : Verdict::fail;
    statistics.verdict.push_back(static_cast<Index>(verdict));
}

void judge(Statistics& statistics)
{
    statistics.confidence = confidence;
    statistics.false_alarm_rate = false_alarm_rate;
    const auto tests = std::count(statistics.is_tested.begin(), statistics.is_tested.end(), 1);
    for (std::size_t row = 0; row < statistics.p_value.size(); ++row)
        if (statistics.is_tested[row] == 1)
            statistics.verdict[row] = static_cast<Index>(
                statistics.p_value[row] < false_alarm_rate / static_cast<double>(tests) ? Verdict::fail
                                                                                        : Verdict::pass);
}

} // namespace jointcreep::statistics
