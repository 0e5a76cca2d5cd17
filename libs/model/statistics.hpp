// What a network is like, against the laws that its joints were drawn from: one row for each quantity of a
// set, of the blocks and of the nodes (libs/statistics makes them). Flat arrays, the same in memory and in a
// file.

#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace jointcreep
{

using Index = std::int32_t;

enum class Verdict : Index {
    none = 0,    // not judged: there is no target, or another row judges it
    too_few = 1, // no verdict: the sample is too small
    pass = 2,
    fail = 3
};

struct Statistics {
    std::vector<std::string> subject;  // a joint set, "blocks", "block size", "nodes"
    std::vector<std::string> quantity; // "trace length, mean"
    std::vector<std::string> unit;     // of target, achieved and interval: SI, "1" for plain numbers
    std::vector<Index> has_target;     // 0 or 1
    std::vector<double> target;        // by the laws of the scene; 0 where there is none
    std::vector<double> achieved;      // by the network, in the same unit
    std::vector<Index> has_interval;   // 0 or 1
    std::vector<double> low, high;     // of the confidence interval; both `achieved` where there is none
    std::vector<Index> sample_size;
    std::vector<Index> is_tested; // 0 or 1: the verdict follows from the p-value
    std::vector<double> p_value;  // of the target; 1 where not tested [-]
    std::vector<Index> verdict;   // Verdict
    double confidence = 0;        // of the intervals [-]
    double false_alarm_rate = 0;  // at most, of a right network: that any of its tested rows fails [-]
};

} // namespace jointcreep
