// Keeps the state before every stage, so that another run can continue from there.

#pragma once

#include "analysis/section.hpp"
#include "analysis/watcher.hpp"

namespace jointcreep::analysis
{

class Checkpoints : public Watcher
{
public:
    using Keep = std::function<void(const Result&, const Checkpoint&)>;

    // `take` makes a checkpoint of the analysis as it is.
    Checkpoints(const Section& section, Keep keep, std::function<Checkpoint()> take)
        : section_(section), keep_(std::move(keep)), take_(std::move(take))
    {
    }

    // The stage that the analysis continues from has its checkpoint already.
    void skip_next() { skips_next_ = true; }

    void stage_begins() override
    {
        if (!std::exchange(skips_next_, false))
            keep_(section_.result, take_());
    }

private:
    const Section& section_;
    Keep keep_;
    std::function<Checkpoint()> take_;
    bool skips_next_ = false;
};

} // namespace jointcreep::analysis
