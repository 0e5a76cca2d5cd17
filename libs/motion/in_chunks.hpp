// Sums over many things by several threads, with the same bits for any number of them: things that follow
// each other make a chunk, a chunk is one thread's, and the sums of chunks are added in their order.

#pragma once

#include "model/network.hpp"

#include <algorithm>
#include <vector>

namespace jointcreep::motion
{

constexpr Index chunk = 128;

// Does `one(i, sum)` for i from 0 to n, which adds to the sum of its chunk.
template <class Sum, class Function>
Sum sum_in_chunks(Index n, int threads, const Function& one)
{
    const Index n_chunks = (n + chunk - 1) / chunk;
    std::vector<Sum> sums(n_chunks);
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
    for (Index k = 0; k < n_chunks; ++k) {
        Sum sum{};
        for (Index i = k * chunk; i < std::min(n, (k + 1) * chunk); ++i)
            one(i, sum);
        sums[k] = sum;
    }
    Sum all{};
    for (const Sum& sum : sums)
        all += sum;
    return all;
}

} // namespace jointcreep::motion
