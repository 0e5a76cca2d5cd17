#include "statistics/nodes.hpp"

#include "model/grouped.hpp"
#include "model/polygon.hpp"

#include <algorithm>
#include <cmath>

namespace jointcreep::statistics
{

using Eigen::Vector2d;

namespace
{

struct Segment {
    Vector2d from, to;
    double distance(const Vector2d& place) const
    {
        const Vector2d along = to - from;
        const double at = std::clamp((place - from).dot(along) / along.squaredNorm(), 0.0, 1.0);
        return (place - from - at * along).norm();
    }
};

// Square cells over the section, about two a trace, each with the traces that pass through it or close by.
class Grid
{
public:
    Grid(const Polygon& outline, std::size_t traces, double tolerance) : margin_(tolerance)
    {
        low_ = high_ = outline[0];
        for (const Vector2d& corner : outline) {
            low_ = low_.cwiseMin(corner);
            high_ = high_.cwiseMax(corner);
        }
        const Vector2d size = high_ - low_;
        cell_ = std::max(std::sqrt(size.x() * size.y() / (2.0 * static_cast<double>(traces) + 1)),
                         1e-3 * size.norm());
        columns_ = static_cast<Index>(size.x() / cell_) + 1;
        rows_ = static_cast<Index>(size.y() / cell_) + 1;
    }

    Index column(double x) const
    {
        return static_cast<Index>(std::clamp((x - low_.x()) / cell_, 0.0, columns_ - 1.0));
    }
    Index row(double y) const
    {
        return static_cast<Index>(std::clamp((y - low_.y()) / cell_, 0.0, rows_ - 1.0));
    }
    std::size_t cell(Index column, Index row) const
    {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
               static_cast<std::size_t>(column);
    }

    // visit(cell) for those that the segment, widened by the tolerance, passes through.
    template <class Visit>
    void for_cells(const Segment& segment, Visit visit) const
    {
        const Vector2d &left = segment.from.x() < segment.to.x() ? segment.from : segment.to,
                       &right = segment.from.x() < segment.to.x() ? segment.to : segment.from;
        if (right.x() < low_.x() - margin_ || left.x() > high_.x() + margin_)
            return;
        const double slope = right.x() > left.x() ? (right.y() - left.y()) / (right.x() - left.x()) : 0;
        const Index last = column(right.x() + margin_);
        for (Index c = column(left.x() - margin_); c <= last; ++c) {
            const double begin = std::clamp(low_.x() + c * cell_ - margin_, left.x(), right.x()),
                         end = std::clamp(low_.x() + (c + 1) * cell_ + margin_, left.x(), right.x());
            double y0 = left.y() + slope * (begin - left.x()), y1 = left.y() + slope * (end - left.x());
            if (right.x() == left.x()) {
                y0 = left.y();
                y1 = right.y();
            }
            const double bottom = std::min(y0, y1) - margin_, top = std::max(y0, y1) + margin_;
            if (top < low_.y() || bottom > high_.y())
                continue;
            for (Index r = row(bottom); r <= row(top); ++r)
                visit(cell(c, r));
        }
    }

    void fill(const std::vector<Segment>& segments)
    {
        segments_ = {static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), [&](auto add) {
                         for (std::size_t s = 0; s < segments.size(); ++s)
                             for_cells(segments[s], [&](std::size_t at) { add(at, static_cast<Index>(s)); });
                     }};
    }

    std::size_t cells() const { return segments_.size(); }
    std::span<const Index> segments(std::size_t cell) const { return segments_[cell]; }
    std::size_t cell_of(const Vector2d& place) const { return cell(column(place.x()), row(place.y())); }

private:
    Vector2d low_, high_;
    double cell_ = 1, margin_;
    Index columns_ = 1, rows_ = 1;
    Grouped<Index> segments_; // of each cell
};

} // namespace

Nodes count_nodes(const Joints& joints, const Polygon& outline, double tolerance)
{
    std::vector<Segment> segments;
    for (std::size_t t = 0; t < joints.trace_joint.size(); ++t)
        segments.push_back({joints.trace_from[t], joints.trace_to[t]});
    Grid grid(outline, segments.size(), tolerance);
    grid.fill(segments);

    Nodes nodes;
    const auto may_meet = [&](std::size_t a, std::size_t b) {
        return joints.trace_joint[a] != joints.trace_joint[b];
    };
    // Crossings, each in the cell that it lies in.
    for (std::size_t cell = 0; cell < grid.cells(); ++cell) {
        const std::span<const Index> here = grid.segments(cell);
        for (std::size_t i = 0; i < here.size(); ++i)
            for (const Index b : here.first(i)) {
                const Index a = here[i];
                if (!may_meet(a, b))
                    continue;
                const Segment &s = segments[a], &o = segments[b];
                const Vector2d along = s.to - s.from, other = o.to - o.from;
                const double sine = cross(along, other);
                if (sine == 0)
                    continue;
                const double at = cross(o.from - s.from, other) / sine,
                             on = cross(o.from - s.from, along) / sine;
                if (at < 0 || at > 1 || on < 0 || on > 1)
                    continue;
                const Vector2d place = s.from + at * along;
                if (grid.cell_of(place) != cell || !covers(outline, place))
                    continue;
                const bool is_at_end = o.distance(s.from) <= tolerance || o.distance(s.to) <= tolerance ||
                                       s.distance(o.from) <= tolerance || s.distance(o.to) <= tolerance;
                if (!is_at_end)
                    ++nodes.x;
            }
    }
    // Ends.
    for (std::size_t a = 0; a < segments.size(); ++a)
        for (const Vector2d& end : {segments[a].from, segments[a].to}) {
            if (!covers(outline, end))
                continue;
            const bool is_at_other = std::ranges::any_of(grid.segments(grid.cell_of(end)), [&](Index b) {
                return may_meet(a, b) && segments[b].distance(end) <= tolerance;
            });
            ++(is_at_other ? nodes.y : nodes.i);
        }
    return nodes;
}

} // namespace jointcreep::statistics
