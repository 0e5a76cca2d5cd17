// Things by the group that each belongs to, all in one list: those of a gridpoint, of a cell of a grid, of a joint.

#pragma once

#include "model/network.hpp"

#include <cstddef>
#include <numeric>
#include <span>
#include <vector>

namespace jointcreep
{

template <class Entry>
class Grouped
{
public:
    Grouped() = default;

    // `each` is called twice, and each time calls add(group, entry) for all entries, in one order. Groups are below
    // `groups`. Entries of a group stay in that order.
    template <class Each>
    Grouped(std::size_t groups, Each&& each) : start_(groups + 1, 0)
    {
        each([&](auto group, const Entry&) { ++start_[static_cast<std::size_t>(group) + 1]; });
        std::partial_sum(start_.begin(), start_.end(), start_.begin());
        entry_.resize(start_.back());
        std::vector<std::size_t> next = start_;
        each(
            [&](auto group, const Entry& entry) { entry_[next[static_cast<std::size_t>(group)]++] = entry; });
    }

    std::size_t size() const { return start_.empty() ? 0 : start_.size() - 1; } // groups

    std::span<const Entry> operator[](std::size_t group) const
    {
        return {entry_.data() + start_[group], entry_.data() + start_[group + 1]};
    }
    std::span<Entry> operator[](std::size_t group)
    {
        return {entry_.data() + start_[group], entry_.data() + start_[group + 1]};
    }

    std::span<const Entry> all() const { return entry_; } // by group

private:
    std::vector<std::size_t> start_; // [groups + 1] into `entry_`
    std::vector<Entry> entry_;
};

// Places in a list, by the group of what is there.
inline Grouped<Index> grouped(std::span<const Index> group_of, std::size_t groups)
{
    return {groups, [&](auto add) {
                for (std::size_t i = 0; i < group_of.size(); ++i)
                    add(group_of[i], static_cast<Index>(i));
            }};
}

} // namespace jointcreep
