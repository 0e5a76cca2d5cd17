#include "mechanics/loading.hpp"

namespace jointcreep::mechanics
{

Loading::Loading(const Scene& scene, const Mesh& mesh) : boundary_(scene.boundaries)
{
    for (std::size_t s = 0; s < mesh.side_zone.size(); ++s) {
        const auto [a, b] = mesh.side_gridpoint[s];
        side_.push_back({mesh.side_gridpoint[s], mesh.side_zone[s],
                         (mesh.gridpoint[a] - mesh.gridpoint[b]).norm(), mesh.side_boundary[s]});
    }
}

void Loading::apply(Assembly& assembly, double time)
{
    time_ = time;
    leave_removed(assembly);
    for (const Side& side : side_) {
        const Boundary& boundary = boundary_[side.boundary];
        if (!boundary.displacement || !assembly.zones.is_present[side.zone])
            continue;
        const Vector2d u =
            (boundary.load_history.at(time) - boundary.load_history.at(0)) * *boundary.displacement;
        for (const Index g : side.gridpoint) {
            if (boundary.fix_x)
                assembly.displacement[g].x() = u.x();
            if (boundary.fix_y)
                assembly.displacement[g].y() = u.y();
        }
    }
    // What follows has its place from the one it is tied to.
    for (const auto& [follower, leader] : assembly.tied)
        for (int i = 0; i < 2; ++i)
            if (assembly.is_free_untied[follower][i] == 0 && assembly.is_free_untied[leader][i] > 0)
                assembly.displacement[leader][i] = assembly.displacement[follower][i];
}

void Loading::leave_removed(Assembly& assembly) const
{
    assembly.applied.assign(assembly.applied.size(), Vector2d::Zero());
    for (const Side& side : side_) {
        const Boundary& boundary = boundary_[side.boundary];
        if (!boundary.traction || !assembly.zones.is_present[side.zone])
            continue;
        for (const Index g : side.gridpoint)
            assembly.applied[g] += boundary.load_history.at(time_) * side.length / 2 * *boundary.traction;
    }
}

bool Loading::changes(double from, double to) const
{
    for (const Boundary& boundary : boundary_)
        if ((boundary.traction || boundary.displacement) &&
            boundary.load_history.at(from) != boundary.load_history.at(to))
            return true;
    return false;
}

std::set<double> Loading::corners() const
{
    std::set<double> times;
    for (const Boundary& boundary : boundary_)
        for (const auto& [time, factor] : boundary.load_history.points)
            times.insert(time);
    return times;
}

} // namespace jointcreep::mechanics
