// The entries of a list, by the gridpoint that each belongs to.

#pragma once

#include "model/network.hpp"

#include <span>
#include <vector>

namespace jointcreep
{

struct ByGridpoint {
    std::vector<Index> start; // [gridpoints + 1] into `entry`
    std::vector<Index> entry; // places in the list; those of a gridpoint are in the list's order

    ByGridpoint() = default;
    // From the gridpoint of each entry, each below `n_gridpoints`.
    ByGridpoint(std::span<const Index> gridpoint_of, std::size_t n_gridpoints) : start(n_gridpoints + 1, 0)
    {
        for (const Index g : gridpoint_of)
            ++start[g + 1];
        for (std::size_t g = 0; g < n_gridpoints; ++g)
            start[g + 1] += start[g];
        entry.resize(gridpoint_of.size());
        std::vector<Index> next(start.begin(), start.end() - 1);
        for (std::size_t i = 0; i < gridpoint_of.size(); ++i)
            entry[next[gridpoint_of[i]]++] = static_cast<Index>(i);
    }

    std::span<const Index> at(std::size_t gridpoint) const
    {
        return {entry.data() + start[gridpoint], entry.data() + start[gridpoint + 1]};
    }
};

} // namespace jointcreep
