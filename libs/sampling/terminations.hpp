// Where a joint trace ends at others. Inside libs/sampling only.

#pragma once

#include "model/network.hpp"
#include "sampling/streams.hpp"
#include "sampling/stretches.hpp"

#include <memory>

namespace jointcreep::sampling
{

// Joint traces, found by place.
class TraceIndex
{
public:
    explicit TraceIndex(const std::vector<const Joints*>& sets);
    ~TraceIndex();

    bool empty() const;

    // How far a trace comes that goes from the line's point along it, `reach` at most [m]: in order, each
    // crossing with a trace of the index that lies within `where` ends it with the given probability, each by
    // a draw of its own. The end is on the other trace, to rounding.
    double end_of(const Line& line, double reach, double probability, const std::vector<Interval>& where,
                  Stream& stream) const;

private:
    struct Tree;
    std::unique_ptr<Tree> tree_;
};

} // namespace jointcreep::sampling
