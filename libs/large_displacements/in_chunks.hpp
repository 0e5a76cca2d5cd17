// Loops and sums over many things by several threads, with the same bits for any number of them: things that
// follow each other make a chunk, a chunk is one thread's, and the sums of chunks are added in their order.

#pragma once

#include "model/network.hpp"

#include <algorithm>
#include <vector>

namespace jointcreep::large_displacements
{

constexpr Index chunk = 128;

// Does `one(from, to)` for every chunk of n things.
template <class Function>
void in_chunks(Index n, int threads, const Function& one)
{
    const Index n_chunks = (n + chunk - 1) / chunk;
    const auto of = [&](Index k) { one(k * chunk, std::min(n, (k + 1) * chunk)); };
    if (threads > 1 && n_chunks > 1) {
#pragma omp parallel for schedule(static) num_threads(threads)
        for (Index k = 0; k < n_chunks; ++k)
            of(k);
    } else // a team of one would cost a call of the system
        for (Index k = 0; k < n_chunks; ++k)
            of(k);
}

// Does `one(i)` for i from 0 to n.
template <class Function>
void for_each(Index n, int threads, const Function& one)
{
    in_chunks(n, threads, [&](Index from, Index to) {
        for (Index i = from; i < to; ++i)
            one(i);
    });
}

// Does `one(i, sum)` for i from 0 to n, which adds to the sum of its chunk.
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
