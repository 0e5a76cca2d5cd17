#include "joint/pieces.hpp"

#include "model/polygon.hpp"

#include <algorithm>
#include <cmath>

namespace jointcreep::joint
{

namespace
{

using Eigen::Vector2d;

constexpr double line_rounding = 1e-9; // of a line's length

// Appends an interval, or lengthens the last one where they touch.
void append(std::vector<Interval>& intervals, const Interval& next)
{
    if (next.high - next.low <= line_rounding)
        return;
    if (!intervals.empty() && next.low <= intervals.back().high + line_rounding)
        intervals.back().high = std::max(intervals.back().high, next.high);
    else
        intervals.push_back(next);
}

// Appends where a line crosses a polygon's sides, as fractions of the line.
void append_crossings(std::vector<double>& cuts, const Polygon& polygon, const Vector2d& from,
                      const Vector2d& along)
{
    for (std::size_t i = 0, j = polygon.empty() ? 0 : polygon.size() - 1; i < polygon.size(); j = i++) {
        const Vector2d side = polygon[i] - polygon[j], reach = polygon[j] - from;
        const double turn = cross(along, side);
        if (turn == 0)
            continue;
        const double on_side = cross(reach, along) / turn, on_line = cross(reach, side) / turn;
        if (on_side >= -line_rounding && on_side <= 1 + line_rounding && on_line > 0 && on_line < 1)
            cuts.push_back(on_line);
    }
}

// By fractions of the line.
std::vector<Interval> inside(const Polygon& outline, const std::vector<Polygon>& holes, const Vector2d& from,
                             const Vector2d& to)
{
    const Vector2d along = to - from;
    std::vector<Interval> intervals;
    if (along.isZero())
        return intervals;
    std::vector<double> cuts = {0, 1};
    append_crossings(cuts, outline, from, along);
    for (const Polygon& hole : holes)
        append_crossings(cuts, hole, from, along);
    std::sort(cuts.begin(), cuts.end());
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        const Vector2d middle = from + (cuts[i] + cuts[i + 1]) / 2 * along;
        if (covers(outline, middle) && std::none_of(holes.begin(), holes.end(), [&](const Polygon& hole) {
                return covers(hole, middle);
            }))
            append(intervals, {cuts[i], cuts[i + 1]});
    }
    return intervals;
}

} // namespace

Pieces pieces_of(const Joints& joints, const Polygon& outline, const std::vector<Polygon>& holes)
{
    std::vector<std::vector<Interval>> traces(joints.from.size());
    for (std::size_t t = 0; t < joints.trace_joint.size(); ++t) {
        const Index joint = joints.trace_joint[t];
        const Vector2d along = joints.to[joint] - joints.from[joint];
        const auto place = [&](const Vector2d& end) {
            return (end - joints.from[joint]).dot(along) / along.squaredNorm();
        };
        const auto [low, high] = std::minmax({place(joints.trace_from[t]), place(joints.trace_to[t])});
        traces[joint].push_back({low, high});
    }

    Pieces pieces;
    for (std::size_t joint = 0; joint < joints.from.size(); ++joint) {
        std::sort(traces[joint].begin(), traces[joint].end(),
                  [](const Interval& a, const Interval& b) { return a.low < b.low; });
        std::vector<Interval> open;
        for (const Interval& trace : traces[joint])
            append(open, trace);

        const Vector2d from = joints.from[joint], along = joints.to[joint] - from;
        double line = 0, joint_length = 0;
        const auto add = [&](double low, double high, bool is_bridge) {
            if (high - low <= line_rounding)
                return;
            const double length = (high - low) * along.norm();
            line += length;
            if (is_bridge)
                pieces.bridge.push_back(static_cast<Index>(pieces.joint.size()));
            else
                joint_length += length;
            pieces.joint.push_back(static_cast<Index>(joint));
            pieces.is_bridge.push_back(is_bridge ? 1 : 0);
            pieces.from.emplace_back(from + low * along);
            pieces.to.emplace_back(from + high * along);
            pieces.length.push_back(length);
        };
        for (const Interval& stretch : inside(outline, holes, from, joints.to[joint])) {
            double done = stretch.low;
            for (const Interval& trace : open) {
                const double low = std::max(trace.low, stretch.low),
                             high = std::min(trace.high, stretch.high);
                if (high - low <= line_rounding)
                    continue;
                add(done, low, true);
                add(low, high, false);
                done = high;
            }
            add(done, stretch.high, true);
        }
        pieces.line_length.push_back(line);
        pieces.line_persistence.push_back(line > 0 ? std::min(1.0, joint_length / line) : 0.0);
    }
    return pieces;
}

double persistence_error(const ProbabilityLaw& length, double persistence,
                         const std::vector<double>& line_length)
{
    const double k = persistence, trace = length.mean, bridge = trace * (1 - k) / k;
    const double spread =
        (std::pow(length.deviation * bridge, 2) + std::pow(bridge * trace, 2)) / std::pow(trace + bridge, 3);
    double variance = 0, total = 0;
    for (const double line : line_length) {
        variance += line * std::min(spread, k * (1 - k) * line);
        total += line;
    }
    return total > 0 ? std::sqrt(variance) / total : 0.0;
}

} // namespace jointcreep::joint
