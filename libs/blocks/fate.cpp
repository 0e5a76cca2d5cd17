#include "blocks/fate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace jointcreep::blocks
{

using Eigen::Vector2d;

void FateRecord::add(Index joint, Fate fate, const Vector2d& from, const Vector2d& to)
{
    const Vector2d along = (joints_.to[joint] - joints_.from[joint]).normalized();
    const auto [low, high] =
        std::minmax({(from - joints_.from[joint]).dot(along), (to - joints_.from[joint]).dot(along)});
    pieces_.push_back({joint, fate, low, high});
}

void FateRecord::extend(Index joint)
{
    is_extended_.resize(joints_.set.size(), 0);
    is_extended_[joint] = 1;
}

// Lengths of the pieces of a joint of the length `length`. Where pieces overlap, the first of their fates counts.
FateRecord::Lengths FateRecord::lengths_of(std::span<const Piece> pieces, double length)
{
    struct End {
        double place; // [m]
        std::size_t fate;
        int change; // of how many pieces with that fate there are
    };
    std::vector<End> ends;
    Lengths sum;
    for (const auto& [joint, fate, low, high] : pieces) {
        if (fate == Fate::kept || fate == Fate::shared)
            sum.extended +=
                std::max(0.0, std::min(high, 0.0) - low) + std::max(0.0, high - std::max(low, length));
        const double from = std::clamp(low, 0.0, length), to = std::clamp(high, 0.0, length);
        if (from < to) {
            ends.push_back({from, static_cast<std::size_t>(fate), 1});
            ends.push_back({to, static_cast<std::size_t>(fate), -1});
        }
    }
    std::sort(ends.begin(), ends.end(), [](const End& a, const End& b) { return a.place < b.place; });
    std::array<int, fates> open{};
    double place = 0;
    for (const End& end : ends) {
        const auto first = std::find_if(open.begin(), open.end(), [](int n) { return n > 0; });
        if (first != open.end()) {
            sum.by_fate[static_cast<std::size_t>(first - open.begin())] += end.place - place;
            sum.covered += end.place - place;
        }
        open[end.fate] += end.change;
        place = end.place;
    }
    return sum;
}

JointFates FateRecord::table(double tolerance) const
{
    const std::size_t count = joints_.set.size();
    JointFates table;
    for (auto* column : {&table.kept, &table.shared, &table.on_outline, &table.outside, &table.dangling_end,
                         &table.merged, &table.extended})
        column->assign(count, 0);
    table.fate.assign(count, 0);

    const Grouped<Piece> pieces(count, [&](auto add) {
        for (const Piece& piece : pieces_)
            add(piece.joint, piece);
    });
    for (std::size_t j = 0; j < count; ++j) {
        const double length = (joints_.to[j] - joints_.from[j]).norm();
        const Lengths sum = lengths_of(pieces[j], length);
        const auto of = [&](Fate fate) { return sum.by_fate[static_cast<std::size_t>(fate)]; };
        table.kept[j] = of(Fate::kept);
        table.shared[j] = of(Fate::shared);
        table.on_outline[j] = of(Fate::on_outline);
        table.outside[j] = of(Fate::outside);
        table.dangling_end[j] = of(Fate::dangling_end);
        table.merged[j] = std::max(0.0, length - sum.covered);
        // Elsewhere it is the overlap at its ends, or merging has moved an end.
        if (!is_extended_.empty() && is_extended_[j])
            table.extended[j] = sum.extended;

        JointFate fate = JointFate::kept;
        if (of(Fate::kept) + of(Fate::shared) == 0)
            fate = JointFate::dropped;
        else if (of(Fate::dangling_end) > tolerance)
            fate = JointFate::trimmed;
        else if (table.merged[j] > tolerance)
            fate = JointFate::merged;
        else if (of(Fate::outside) + of(Fate::on_outline) > tolerance)
            fate = JointFate::clipped;
        table.fate[j] = static_cast<Index>(fate);
    }
    return table;
}

TracesAlong::TracesAlong(const Joints& joints)
    : joints_(joints), stretches_(joints.set.size(), [&](auto add) {
          for (std::size_t t = 0; t < joints.trace_joint.size(); ++t) {
              const Index j = joints.trace_joint[t];
              const Vector2d along = (joints.to[j] - joints.from[j]).normalized();
              const auto place = [&](const Vector2d& x) { return (x - joints.from[j]).dot(along); };
              const auto [low, high] = std::minmax({place(joints.trace_from[t]), place(joints.trace_to[t])});
              add(j, {low, high, high});
          }
      })
{
    for (std::size_t j = 0; j < stretches_.size(); ++j) {
        const std::span<Stretch> stretches = stretches_[j];
        std::ranges::stable_sort(stretches, {}, &Stretch::low);
        double highest = -std::numeric_limits<double>::infinity();
        for (Stretch& stretch : stretches)
            stretch.highest_yet = highest = std::max(highest, stretch.high);
    }
}

void TracesAlong::end_before(Index joint, bool first_end, bool second_end)
{
    if (ends_.empty())
        ends_.assign(joints_.set.size(), {false, false});
    ends_[joint] = {first_end, second_end};
}

double TracesAlong::fraction(Index j, const Vector2d& p, const Vector2d& q, double overlap) const
{
    const Vector2d along = (joints_.to[j] - joints_.from[j]).normalized();
    const double total = (joints_.to[j] - joints_.from[j]).norm();
    const auto place = [&](const Vector2d& x) { return (x - joints_.from[j]).dot(along); };
    const auto [low, high] = std::minmax({place(p), place(q)});
    const std::array<bool, 2> ends = ends_.empty() ? std::array<bool, 2>{} : ends_[j];
    double open = 0;
    const std::span<const Stretch> stretches = stretches_[j];
    auto s = std::ranges::lower_bound(stretches, low - overlap, {}, &Stretch::highest_yet);
    for (; s != stretches.end() && s->low <= high + overlap; ++s) {
        double from = s->low, to = s->high;
        if (from <= 1e-9 * total && !ends[0])
            from -= overlap;
        if (to >= (1 - 1e-9) * total && !ends[1])
            to += overlap;
        open += std::max(0.0, std::min(high, to) - std::max(low, from));
    }
    return high > low ? std::min(1.0, open / (high - low)) : 0.0;
}

} // namespace jointcreep::blocks
