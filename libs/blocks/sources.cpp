#include "blocks/graph.hpp"

#include <algorithm>
#include <iterator>
#include <numeric>

namespace jointcreep::blocks
{

Sources::Sources(std::vector<Source> lines)
    : lines_(std::move(lines)), own_(lines_.size()), has_(lines_.size())
{
    std::iota(own_.begin(), own_.end(), 0);
    std::transform(lines_.begin(), lines_.end(), has_.begin(),
                   [](const Source& line) { return bit(line.kind); });
}

std::span<const Index> Sources::lines_of(Index set) const
{
    if (set < count())
        return {&own_[set], 1};
    return *sets_[set - count()];
}

// All at once: one by one, a thousand lines on an edge would be a thousand sets.
Index Sources::united(std::vector<Index> sets)
{
    std::sort(sets.begin(), sets.end());
    sets.erase(std::unique(sets.begin(), sets.end()), sets.end());
    if (sets.size() == 1)
        return sets[0];
    if (sets.size() == 2)
        return united_pair(sets[0], sets[1]);
    std::vector<Index> all;
    unsigned char has = 0;
    for (const Index set : sets) {
        std::ranges::copy(lines_of(set), std::back_inserter(all));
        has |= has_[set];
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return number_of(std::move(all), has);
}

Index Sources::number_of(std::vector<Index> lines, unsigned char has)
{
    const auto [found, is_new] = number_of_.try_emplace(std::move(lines), static_cast<Index>(has_.size()));
    if (is_new) {
        sets_.push_back(&found->first);
        has_.push_back(has);
    }
    return found->second;
}

Index Sources::united_pair(Index low, Index high)
{
    const auto key = static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint64_t>(high);
    if (const auto known = known_.find(key); known != known_.end())
        return known->second;
    std::vector<Index> both;
    std::ranges::set_union(lines_of(low), lines_of(high), std::back_inserter(both));
    return known_[key] = number_of(std::move(both), has_[low] | has_[high]);
}

Edge united(std::span<const Edge> edges, Sources& sources)
{
    Edge one = edges[0];
    if (edges.size() == 1)
        return one;
    std::vector<Index> sets;
    for (const Edge& edge : edges) {
        sets.push_back(edge.sources);
        one.is_settled = one.is_settled && edge.is_settled;
    }
    one.sources = sources.united(std::move(sets));
    return one;
}

} // namespace jointcreep::blocks
