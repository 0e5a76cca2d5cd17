#include "sampling/terminations.hpp"

#include "sampling/laws.hpp"

#include <boost/geometry.hpp>
#include <boost/geometry/index/rtree.hpp>

#include <algorithm>
#include <iterator>

namespace jointcreep
{

namespace
{

namespace bg = boost::geometry;
using Eigen::Vector2d;
using Point = bg::model::point<double, 2, bg::cs::cartesian>;
using Box = bg::model::box<Point>;

struct Trace {
    Vector2d from, to;
};
using Entry = std::pair<Box, Trace>;

Box box_of(const Vector2d& a, const Vector2d& b)
{
    const Vector2d low = a.cwiseMin(b), high = a.cwiseMax(b);
    return {Point(low.x(), low.y()), Point(high.x(), high.y())};
}

double cross(const Vector2d& a, const Vector2d& b)
{
    return a.x() * b.y() - a.y() * b.x();
}

} // namespace

struct TraceIndex::Tree {
    bg::index::rtree<Entry, bg::index::quadratic<16>> entries;
};

TraceIndex::TraceIndex() : tree_(std::make_unique<Tree>()) {}
TraceIndex::~TraceIndex() = default;

// Long traces go in by pieces: the box about a slanting one holds far more than the trace.
void TraceIndex::add(const Joints& joints)
{
    for (std::size_t t = 0; t < joints.trace_from.size(); ++t) {
        const Vector2d &from = joints.trace_from[t], &to = joints.trace_to[t];
        const int parts = 16;
        for (int i = 0; i < parts; ++i)
            tree_->entries.insert(
                {box_of(from + double(i) / parts * (to - from), from + double(i + 1) / parts * (to - from)),
                 {from, to}});
    }
}

bool TraceIndex::empty() const
{
    return tree_->entries.empty();
}

double TraceIndex::end_of(const Line& line, double reach, double probability,
                          const std::vector<Interval>& where, Stream& stream) const
{
    std::vector<Entry> near;
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

} // namespace jointcreep
