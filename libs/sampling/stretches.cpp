#include "sampling/stretches.hpp"

#include <algorithm>
#include <cmath>

namespace jointcreep::sampling
{

using Eigen::Vector2d;

namespace
{

// Adds `stretch` with its overshoot, joined to the last one where they meet.
void add_widened(std::vector<Interval>& pieces, const Interval& stretch, double overshoot)
{
    const Interval piece{stretch.low - overshoot, stretch.high + overshoot};
    if (!pieces.empty() && piece.low <= pieces.back().high)
        pieces.back().high = piece.high;
    else
        pieces.push_back(piece);
}

std::vector<Interval> inside_region(const Polygon& region, const Line& line)
{
    const double overshoot = overshoot_of(region);
    std::vector<Interval> pieces;
    for (const Interval& stretch : inside(region, line))
        if (stretch.high - stretch.low > overshoot) // else it only touches a corner
            add_widened(pieces, stretch, overshoot);
    return pieces;
}

// The name of the rock at a distance along a line; `stretches` are those inside each region, which later
// ones cover.
const std::string& rock_at(const Scene& scene, const std::vector<std::vector<Interval>>& stretches,
                           double distance)
{
    for (std::size_t i = stretches.size(); i-- > 0;)
        for (const Interval& stretch : stretches[i])
            if (distance > stretch.low && distance < stretch.high)
                return scene.regions[i].rock;
    return scene.rock;
}

std::vector<Interval> inside_rocks(const JointSet& set, const Scene& scene, const Line& line)
{
    const double overshoot = overshoot_of(scene.outline);
    std::vector<std::vector<Interval>> regions;
    std::vector<double> borders;
    const auto add_borders = [&](const std::vector<Interval>& stretches) {
        for (const Interval& stretch : stretches)
            borders.insert(borders.end(), {stretch.low, stretch.high});
    };
    for (const Region& region : scene.regions)
        add_borders(regions.emplace_back(inside(region.outline, line)));
    const std::vector<Interval> section = inside(scene.outline, line);
    add_borders(section);
    std::sort(borders.begin(), borders.end());

    std::vector<Interval> pieces;
    for (std::size_t i = 0; i + 1 < borders.size(); ++i) {
        const double middle = (borders[i] + borders[i + 1]) / 2;
        const bool in_section = std::any_of(section.begin(), section.end(), [&](const Interval& stretch) {
            return middle > stretch.low && middle < stretch.high;
        });
        if (borders[i + 1] - borders[i] > overshoot && in_section &&
            std::count(set.rocks.begin(), set.rocks.end(), rock_at(scene, regions, middle)) > 0)
            add_widened(pieces, {borders[i], borders[i + 1]}, overshoot);
    }
    return pieces;
}

} // namespace

double overshoot_of(const Polygon& polygon)
{
    const Interval x = extent(polygon, Vector2d::UnitX()), y = extent(polygon, Vector2d::UnitY());
    return 1e-6 * std::hypot(x.high - x.low, y.high - y.low);
}

std::vector<Interval> where_set_exists(const JointSet& set, const Scene& scene, const Line& line)
{
    if (set.region)
        return inside_region(*set.region, line);
    if (!set.rocks.empty())
        return inside_rocks(set, scene, line);
    return inside(scene.outline, line);
}

const Polygon& bounds_of(const JointSet& set, const Scene& scene)
{
    return set.region ? *set.region : scene.outline;
}

std::vector<Interval> overlap(const std::vector<Interval>& stretches, const Interval& with)
{
    std::vector<Interval> common;
    for (const Interval& stretch : stretches)
        if (const Interval both{std::max(stretch.low, with.low), std::min(stretch.high, with.high)};
            both.low < both.high)
            common.push_back(both);
    return common;
}

std::vector<Interval> turned_round(const std::vector<Interval>& stretches)
{
    std::vector<Interval> turned;
    for (std::size_t i = stretches.size(); i-- > 0;)
        turned.push_back({-stretches[i].high, -stretches[i].low});
    return turned;
}

} // namespace jointcreep::sampling
