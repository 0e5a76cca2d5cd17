// Things that are joined pair by pair into sets (union-find).

#pragma once

#include "model/network.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

namespace jointcreep
{

class DisjointSets
{
public:
    explicit DisjointSets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }

    // The lowest number of the set that i is in.
    Index root(Index i) const
    {
        while (parent_[i] != i)
            i = parent_[i] = parent_[parent_[i]];
        return i;
    }

    void join(Index i, Index j)
    {
        const auto [low, high] = std::minmax({root(i), root(j)});
        parent_[high] = low;
    }

private:
    mutable std::vector<Index> parent_; // paths to the roots get shorter with each use
};

} // namespace jointcreep
