// Loops and sums by several threads, with bitwise the same result for any number of threads. Consecutive items make a
// chunk. One thread does a chunk. The sums of chunks are added in their order.

#pragma once

#include "model/network.hpp"

#include <algorithm>
#include <vector>

namespace jointcreep::large_displacements
{

constexpr Index chunk = 128;

// Calls `one(from, to)` for each chunk of n items.
template <class Function>
void in_chunks(Index n, int threads, const Function& one)
{
    const Index n_chunks = (n + chunk - 1) / chunk;
    const auto of = [&](Index k) { one(k * chunk, std::min(n, (k + 1) * chunk)); };
    if (threads > 1 && n_chunks > 1) {
#pragma omp parallel for schedule(static) num_threads(threads)
        for (Index k = 0; k < n_chunks; ++k)
            of(k);
    } else // with one thread, a team would cost a system call
        for (Index k = 0; k < n_chunks; ++k)
            of(k);
}

// Calls `one(i)` for i from 0 to n - 1.
template <class Function>
void for_each(Index n, int threads, const Function& one)
{
    in_chunks(n, threads, [&](Index from, Index to) {
        for (Index i = from; i < to; ++i)
            one(i);
    });
}

// Calls `one(i, sum)` for i from 0 to n - 1, which adds to the sum of its chunk.
template <class Sum, class Function>
Sum sum_in_chunks(Index n, int threads, const Function& one)
{
    std::vector<Sum> sums((n + chunk - 1) / chunk, Sum{});
    in_chunks(n, threads, [&](Index from, Index to) {
        Sum sum{};
        for (Index i = from; i < to; ++i)
            one(i, sum);
        sums[from / chunk] = sum;
    });
    Sum all{};
    for (const Sum& sum : sums)
        all += sum;
    return all;
}

} // namespace jointcreep::large_displacements
