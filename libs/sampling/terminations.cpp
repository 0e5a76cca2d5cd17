#include "sampling/terminations.hpp"

#include "sampling/laws.hpp"

#include <boost/geometry.hpp>
#include <boost/geometry/index/rtree.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace jointcreep::sampling
{

namespace bg = boost::geometry;
using Eigen::Vector2d;
using Point = bg::model::point<double, 2, bg::cs::cartesian>;
using Box = bg::model::box<Point>;

namespace
{

Box box_of(const Vector2d& a, const Vector2d& b)
{
    const Vector2d low = a.cwiseMin(b), high = a.cwiseMax(b);
    return {Point(low.x(), low.y()), Point(high.x(), high.y())};
}

} // namespace

struct TraceIndex::Tree {
    struct Trace {
        Vector2d from, to;
    };
    using Entry = std::pair<Box, Trace>;

    bg::index::rtree<Entry, bg::index::quadratic<16>> entries;
};

// Long traces go in by pieces: the box about a slanting one holds far more than the trace.
TraceIndex::TraceIndex(const std::vector<const Joints*>& sets) : tree_(std::make_unique<Tree>())
{
    const double pieces_across = 64;
    Eigen::AlignedBox2d all;
    for (const Joints* const joints : sets)
        for (std::size_t t = 0; t < joints->trace_from.size(); ++t)
            all.extend(joints->trace_from[t]).extend(joints->trace_to[t]);
    std::vector<Tree::Entry> entries;
    for (const Joints* const joints : sets)
        for (std::size_t t = 0; t < joints->trace_from.size(); ++t) {
            const Vector2d &from = joints->trace_from[t], run = joints->trace_to[t] - from;
            const double parts = std::ceil(pieces_across * run.norm() / all.diagonal().norm());
            for (double i = 0; i < parts; ++i)
                entries.push_back({box_of(from + i / parts * run, from + (i + 1) / parts * run),
                                   {from, joints->trace_to[t]}});
        }
    tree_->entries = decltype(tree_->entries)(entries);
}

TraceIndex::~TraceIndex() = default;

bool TraceIndex::empty() const
{
    return tree_->entries.empty();
}

double TraceIndex::end_of(const Line& line, double reach, double probability,
                          const std::vector<Interval>& where, Stream& stream) const
{
    std::vector<Tree::Entry> near;
    tree_->entries.query(bg::index::intersects(box_of(line.point, line.at(reach))), std::back_inserter(near));
    std::vector<double> crossings;
    for (const auto& [box, trace] : near) {
        const double a = cross(line.direction, trace.from - line.point),
                     b = cross(line.direction, trace.to - line.point);
        if ((a < 0) == (b < 0))
            continue;
        const double place =
            (trace.from + a / (a - b) * (trace.to - trace.from) - line.point).dot(line.direction);
        const bool counts = std::any_of(where.begin(), where.end(), [&](const Interval& stretch) {
            return place >= stretch.low && place <= stretch.high;
        });
        if (place > 0 && place <= reach && counts)
            crossings.push_back(place);
    }
    std::sort(crossings.begin(), crossings.end());
    crossings.erase(std::unique(crossings.begin(), crossings.end()), crossings.end()); // met in two pieces
    for (const double place : crossings)
        if (uniform(stream) < probability)
            return place;
    return reach;
}

} // namespace jointcreep::sampling
