#include "boundary/loads.hpp"

namespace jointcreep::boundary
{

Loads::Loads(const Scene& scene, const Mesh& mesh) : boundary_(scene.boundaries)
{
    for (std::size_t s = 0; s < mesh.side_zone.size(); ++s) {
        const auto [a, b] = mesh.side_gridpoint[s];
        side_.push_back({mesh.side_gridpoint[s], mesh.side_zone[s],
                         (mesh.gridpoint[a] - mesh.gridpoint[b]).norm(), mesh.side_boundary[s]});
    }
}

void Loads::displace(std::vector<Vector2d>& displacement, const std::vector<char>& zone_is_present,
                     double time) const
{
    for (const Side& side : side_) {
        const Boundary& boundary = boundary_[side.boundary];
        if (!boundary.displacement || !zone_is_present[side.zone])
            continue;
        const Vector2d u =
            (boundary.load_history.at(time) - boundary.load_history.at(0)) * *boundary.displacement;
        for (const Index g : side.gridpoint) {
            if (boundary.fix_x)
                displacement[g].x() = u.x();
            if (boundary.fix_y)
                displacement[g].y() = u.y();
        }
    }
}

void Loads::add_forces(std::vector<Vector2d>& force, const std::vector<char>& zone_is_present,
                       double time) const
{
    for (const Side& side : side_) {
        const Boundary& boundary = boundary_[side.boundary];
        if (!boundary.traction || !zone_is_present[side.zone])
            continue;
        for (const Index g : side.gridpoint)
            force[g] += boundary.load_history.at(time) * side.length / 2 * *boundary.traction;
    }
}

bool Loads::changes(double from, double to) const
{
    for (const Boundary& boundary : boundary_)
        if ((boundary.traction || boundary.displacement) &&
            boundary.load_history.at(from) != boundary.load_history.at(to))
            return true;
    return false;
}

std::set<double> Loads::corners() const
{
    std::set<double> times;
    for (const Boundary& boundary : boundary_)
        for (const auto& [time, factor] : boundary.load_history.points)
            times.insert(time);
    return times;
}

} // namespace jointcreep::boundary
