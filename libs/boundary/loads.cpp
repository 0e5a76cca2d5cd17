#include "boundary/loads.hpp"

namespace jointcreep::boundary
{

Loads::Loads(const Scene& scene, const Mesh& mesh) : boundary_(scene.boundaries)
{
    for (std::size_t s = 0; s < mesh.side_zone.size(); ++s) {
        const auto [a, b] = mesh.side_gridpoint[s];
        Side side{.gridpoint = {a, b},
                  .share = {0.5, 0.5},
                  .stress_point = mesh.side_zone[s] * mesh.stress_points_of_zone(),
                  .length = (mesh.gridpoint[a] - mesh.gridpoint[b]).norm(),
                  .boundary = mesh.side_boundary[s]};
        if (mesh.is_quadratic()) { // Simpson's rule: shares by the shape functions
            side.gridpoint.push_back(mesh.side_middle[s]);
            side.share = {1. / 6, 1. / 6, 4. / 6};
        }
        side_.push_back(side);
    }
}

void Loads::displace(std::vector<Vector2d>& displacement, const std::vector<char>& is_present,
                     double time) const
{
    for (const Side& side : side_) {
        const Boundary& boundary = boundary_[side.boundary];
        if (!boundary.displacement || !is_present[side.stress_point])
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

void Loads::add_forces(std::vector<Vector2d>& force, const std::vector<char>& is_present, double time) const
{
    for (const Side& side : side_) {
        const Boundary& boundary = boundary_[side.boundary];
        if (!boundary.traction || !is_present[side.stress_point])
            continue;
        for (std::size_t i = 0; i < side.gridpoint.size(); ++i)
            force[side.gridpoint[i]] +=
                boundary.load_history.at(time) * (side.share[i] * side.length) * *boundary.traction;
    }
}

std::vector<Vector2d> Loads::fixed(std::size_t gridpoints, const std::vector<char>& is_present) const
{
    std::vector<Vector2d> fixed(gridpoints, Vector2d::Zero());
    for (const Side& side : side_)
        if (is_present[side.stress_point])
            for (const Index g : side.gridpoint) {
                if (boundary_[side.boundary].fix_x)
                    fixed[g].x() = 1;
                if (boundary_[side.boundary].fix_y)
                    fixed[g].y() = 1;
            }
    return fixed;
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
