#include "rock/zone_stiffness.hpp"

namespace jointcreep::rock
{

Eigen::Matrix2d stiffness_between(const Zones& zones, std::size_t z, int i, int j)
{
    const Vector3d& c = zones.stiffness[z];
    const Vector2d &p = zones.gradients(z)[i], &q = zones.gradients(z)[j];
    Eigen::Matrix2d block;
    block << c[0] * p.x() * q.x() + c[2] * p.y() * q.y(), c[1] * p.x() * q.y() + c[2] * p.y() * q.x(),
        c[1] * p.y() * q.x() + c[2] * p.x() * q.y(), c[0] * p.y() * q.y() + c[2] * p.x() * q.x();
    return block;
}

Eigen::Matrix2d stiffness_between(const Zones& zones, std::size_t z, int i, int j, const Tangent& tangent)
{
    const auto strain_of = [&](int corner) { // for a displacement of the gridpoint
        const Vector2d& p = zones.gradients(z)[corner];
        return (Eigen::Matrix<double, 3, 2>() << p.x(), 0, 0, p.y(), p.y(), p.x()).finished();
    };
    return strain_of(i).transpose() * tangent * strain_of(j);
}

Tangent tangent_at(const Zones& zones, std::size_t z, std::span<const Vector2d> displacement,
                   const ZonesState& start)
{
    const Vector3d& c = zones.stiffness[z];
    if (start.yielding.empty() || zones.yielding_number[z] < 0 || zones.holds_yield)
        return (Eigen::Matrix3d() << c[0], c[1], 0, c[1], c[0], 0, 0, 0, c[2]).finished();
    return tangent_of_yield(start.yielding[zones.yielding_number[z]], c, zones.initial_stress[z],
                            strain_at(zones, z, displacement));
}

std::vector<Tangent> tangents_of(const Zones& zones, std::span<const Vector2d> displacement,
                                 const ZonesState& start)
{
    std::vector<Tangent> tangents(zones.size(), Tangent::Zero());
    for (std::size_t z = 0; z < zones.size(); ++z)
        if (zones.is_present[z])
            tangents[z] = tangent_at(zones, z, displacement, start);
    return tangents;
}

std::vector<Index> present(const Zones& zones)
{
    std::vector<Index> there;
    for (std::size_t zone = 0; zone < zones.zone_of(zones.size()); ++zone)
        if (zones.is_present[zones.first_point_of(zone)])
            there.push_back(static_cast<Index>(zone));
    return there;
}

} // namespace jointcreep::rock
