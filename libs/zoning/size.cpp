#include "zoning/size.hpp"

#include "model/polygon.hpp"

#include <algorithm>

namespace jointcreep::zoning
{

using Eigen::Vector2d;

namespace
{

// Size over distance from where it is smallest: neighbours differ by a fifth at most.
constexpr double grading = 0.3;

} // namespace

Eigen::AlignedBox2d bounding_box(const ZoneSize::Stretch& stretch)
{
    return Eigen::AlignedBox2d(stretch.from).extend(stretch.to);
}

struct ZoneSize::DistanceFrom {
    using Scalar = double;
    Vector2d place;

    double minimumOnVolume(const Eigen::AlignedBox2d& box) const { return box.exteriorDistance(place); }
    double minimumOnObject(const Stretch& stretch) const
    {
        const Vector2d along = stretch.to - stretch.from, off = place - stretch.from;
        const double length = along.norm();
        if (length == 0)
            return off.norm();
        return (off - std::clamp(off.dot(along) / length, 0.0, length) / length * along).norm();
    }
};

ZoneSize::ZoneSize(const Scene& scene, const Blocks& blocks) : scene_(scene)
{
    if (!scene.zone_size_at_faces)
        return;
    std::vector<Stretch> fine;
    // A face is between excavated rock and rock that stays, or rock of two stages.
    for (std::size_t e = 0; e < blocks.edge_vertex.size(); ++e) {
        const auto [left, right] = blocks.edge_block[e];
        if (right >= 0 && blocks.block_stage[left] != blocks.block_stage[right])
            fine.push_back(
                {blocks.vertex[blocks.edge_vertex[e][0]], blocks.vertex[blocks.edge_vertex[e][1]]});
    }
    for (const MonitoringPoint& point : scene.points)
        fine.push_back({point.at, point.at});
    for (const Gauge& gauge : scene.gauges)
        fine.push_back({gauge.at, gauge.at});
    fine_.init(fine.begin(), fine.end());
}

double ZoneSize::at(const Vector2d& place) const
{
    double size = scene_.zone_size;
    if (scene_.fine_zones && !covers(*scene_.fine_zones, place))
        size *= 1 + distance_to_sides(*scene_.fine_zones, place) / scene_.zone_coarsening;
    if (scene_.zone_size_at_faces) {
        DistanceFrom from{place};
        size = std::min(size, *scene_.zone_size_at_faces + grading * Eigen::BVMinimize(fine_, from));
    }
    return size;
}

double ZoneSize::steepest() const
{
    return std::max(scene_.fine_zones ? scene_.zone_size / scene_.zone_coarsening : 0.0,
                    scene_.zone_size_at_faces ? grading : 0.0);
}

} // namespace jointcreep::zoning
