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

Index Sources::united_sets(Index a, Index b)
{
    const auto [low, high] = std::minmax(a, b);
    const auto key = static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint64_t>(high);
    if (const auto known = known_.find(key); known != known_.end())
        return known->second;
    std::vector<Index> both;
    std::ranges::set_union(lines_of(a), lines_of(b), std::back_inserter(both));
    const auto [found, is_new] = number_of_.try_emplace(std::move(both), static_cast<Index>(has_.size()));
    if (is_new) {
        sets_.push_back(&found->first);
        has_.push_back(has_[a] | has_[b]);
    }
    return known_[key] = found->second;
}

} // namespace jointcreep::blocks
