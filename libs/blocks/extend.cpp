#include "blocks/extend.hpp"

#include "model/polygon.hpp"

#include <cmath>
#include <limits>

namespace jointcreep::blocks
{

namespace
{

using Eigen::Vector2d;

constexpr double none = std::numeric_limits<double>::infinity();

// Distance from `start` in direction `along` (unit) to the nearest other line ahead.
double distance_to_next(const std::vector<Segment>& lines, const SegmentGrid& grid, Index own,
                        const Vector2d& start, const Vector2d& along)
{
    const double stride = 2 * grid.cell(), farthest = 2 * grid.extent();
    for (double from = 0; from < farthest; from += stride) {
        double nearest = none;
        const auto try_line = [&](Index i) {
            if (i == own)
                return;
            const Vector2d d = lines[i].to - lines[i].from, o = lines[i].from - start;
            const double below = cross(along, d);
            if (std::abs(below) < 1e-12 * d.norm())
                return; // parallel
            const double ahead = cross(o, d) / below, on_line = cross(o, along) / below;
            if (ahead >= 0 && on_line >= 0 && on_line <= 1)
                nearest = std::min(nearest, ahead);
        };
        grid.for_columns({start + from * along, start + (from + stride) * along},
                         [&](Index column, Index first, Index last) {
                             for (Index row = first; row <= last; ++row)
                                 for (const Index i : grid.at(column, row))
                                     try_line(i);
                         });
        if (nearest <= from + stride)
            return nearest;
    }
    return none;
}

} // namespace

std::vector<Extension> extensions_to_next(const std::vector<Segment>& lines, std::size_t first, double reach,
                                          const std::function<bool(const Vector2d&)>& is_in_section)
{
    const SegmentGrid grid(lines);
    const auto at_end = [&](std::size_t i, const Vector2d& end, const Vector2d& along) {
        const Vector2d tip = end - reach * along; // end of the joint
        if (!is_in_section(tip))
            return 0.0;
        // From as far behind the tip as the line reaches beyond it.
        const double next = distance_to_next(lines, grid, static_cast<Index>(i), tip - reach * along, along);
        return next <= 2 * reach || next == none ? 0.0 : next - reach;
    };
    std::vector<Extension> extensions;
    for (std::size_t i = first; i < lines.size(); ++i) {
        const Vector2d along = (lines[i].to - lines[i].from).normalized();
        extensions.push_back({at_end(i, lines[i].from, -along), at_end(i, lines[i].to, along)});
    }
    return extensions;
}

} // namespace jointcreep::blocks
