#include "rock/moving_zones.hpp"

#include "rock/finite_strain.hpp"

#include <algorithm>

namespace jointcreep::rock
{

namespace
{

// Null where the zone is elastic.
template <class Yielding>
auto* yield_of(const Zones& zones, Yielding& yielding, Index z)
{
    return yielding.empty() || zones.yielding_number[z] < 0 ? nullptr : &yielding[zones.yielding_number[z]];
}

// `acting`: Biot's stress with the stress of dashpots [Pa]. `force`: on the three corners.
inline void take_corner_forces(const MovingZone& zone, const Polar& polar, const Vector3d& acting,
                               bool yields, Vector2d* force)
{
    double xy = acting[2], yx = acting[2];
    if (yields) {
        const double w = skew_part(polar.stretch(), tensor(acting))(1, 0);
        xy -= w;
        yx += w;
    }
    // First Piola-Kirchhoff stress, times the area.
    const double c = zone.area * polar.cos, s = zone.area * polar.sin;
    const Vector2d of_x(c * acting[0] - s * yx, s * acting[0] + c * yx),
        of_y(c * xy - s * acting[1], s * xy + c * acting[1]);
    const Vector2d one = zone.inverse(0, 0) * of_x + zone.inverse(0, 1) * of_y,
                   two = zone.inverse(1, 0) * of_x + zone.inverse(1, 1) * of_y;
    force[0] = one + two;
    force[1] = -one;
    force[2] = -two;
}

} // namespace

MovingZones moving_zones_of(const Zones& zones, const std::vector<Vector2d>& place)
{
    MovingZones moving;
    for (std::size_t z = 0; z < zones.size(); ++z) {
        const Vector3d& stiffness = zones.stiffness[z];
        const Matrix2d stretch = stretch_for(stiffness, zones.stress[z]);
        MovingZone zone;
        std::copy_n(zones.gridpoints(z).begin(), 3, zone.gridpoint.begin());
        zone.inverse = edges_of(zone.gridpoint, place).inverse() * stretch;
        zone.area = zones.area[z] / stretch.determinant();
        zone.stiffness = stiffness;
        zone.strain = {stretch(0, 0) - 1, stretch(1, 1) - 1, 2 * stretch(0, 1)};
        moving.zone.push_back(zone);
        const YieldingZone* const yields = yield_of(zones, zones.yielding, static_cast<Index>(z));
        if (yields == nullptr)
            continue;
        YieldingZone yielding = *yields;
        yielding.plastic.setZero(); // is part of the shape without stress
        yielding.dissipated = 0;
        yielding.initial_zz = yielding.stress_zz - stiffness[1] * (zone.strain[0] + zone.strain[1]);
        moving.yielding.push_back({yielding, stress_of(stiffness, zone.strain)});
    }
    return moving;
}

void find_force(const Zones& zones, MovingZones& moving, Index z, const std::vector<Vector2d>& place,
                double viscosity, ZoneSums& sums)
{
    MovingZone& zone = moving.zone[z];
    const Polar polar = polar_of(zone.gridpoint, place, zone.inverse);
    const Vector3d strain(polar.xx - 1, polar.yy - 1, 2 * polar.xy);
    Vector3d stress, held;
    MovingYieldingZone* const yields = yield_of(zones, moving.yielding, z);
    if (yields != nullptr) {
        const Vector3d last = yields->stress;
        yields->zone.dissipated = 0;
        stress = yielded(yields->zone, zone.stiffness, Vector3d::Zero(), last, strain);
        held = viscosity * (stress - last);
        yields->stress = stress;
        if (sums.torn < 0 && !(strain.cwiseAbs().maxCoeff() <= most_strain))
            sums.torn = z;
        sums.friction += zone.area * yields->zone.dissipated;
        sums.stored += zone.area * stored(zone.stiffness, stress, yields->zone.stress_zz);
    } else {
        stress = stress_of(zone.stiffness, strain);
        held = viscosity * stress_of(zone.stiffness, strain - zone.strain);
        sums.stored += zone.area / 2 * stress.dot(strain);
    }
    sums.damped += zone.area / 2 * (zone.held + held).dot(strain - zone.strain); // as of contacts
    zone.held = held;
    zone.strain = strain;
    take_corner_forces(zone, polar, stress + held, yields != nullptr,
                       moving.corner_force.data() + 3 * static_cast<std::ptrdiff_t>(z));
}

void take_corner_forces_of_dashpots(const Zones& zones, const MovingZones& moving, Index z,
                                    const std::vector<Vector2d>& place, std::vector<Vector2d>& corner_force)
{
    const MovingZone& zone = moving.zone[z];
    take_corner_forces(zone, polar_of(zone.gridpoint, place, zone.inverse), zone.held,
                       yield_of(zones, moving.yielding, z) != nullptr,
                       corner_force.data() + 3 * static_cast<std::ptrdiff_t>(z));
}

void put_back(const MovingZones& moving, Index z, const std::vector<Vector2d>& place, Zones& zones)
{
    const MovingZone& zone = moving.zone[z];
    const Polar polar = polar_of(zone.gridpoint, place, zone.inverse);
    const Matrix2d rotation = polar.rotation(), stretch = polar.stretch();
    const MovingYieldingZone* const yields = yield_of(zones, moving.yielding, z);
    Matrix2d biot = tensor(yields != nullptr ? yields->stress : stress_of(zone.stiffness, zone.strain));
    if (yields != nullptr) {
        biot += skew_part(stretch, biot);
        const Eigen::Vector4d& p = yields->zone.plastic;
        const Matrix2d plastic = rotation * tensor({p[0], p[1], p[3] / 2}) * rotation.transpose();
        YieldingZone& seen = *yield_of(zones, zones.yielding, z);
        seen.plastic = {plastic(0, 0), plastic(1, 1), p[2], 2 * plastic(0, 1)};
        seen.stress_zz = yields->zone.stress_zz;
    }
    const Matrix2d stress = rotation * biot * stretch * rotation.transpose() / stretch.determinant();
    zones.stress[z] = {stress(0, 0), stress(1, 1), (stress(0, 1) + stress(1, 0)) / 2};
}

void transfer(const Transfer& to, MovingZones& moving, DynamicsState& kept)
{
    std::vector<Eigen::Vector4d> inverse;
    for (const MovingZone& zone : moving.zone)
        inverse.emplace_back(zone.inverse.reshaped());
    to.values(inverse, kept.inverse);
    for (std::size_t z = 0; z < moving.zone.size(); ++z)
        moving.zone[z].inverse = inverse[z].reshaped(2, 2);
    to.values(moving.zone, kept.area, &MovingZone::area);
    to.values(moving.zone, kept.strain, &MovingZone::strain);
    const auto of_zone = [](auto member) {
        return [member](MovingYieldingZone & one) -> auto&
        {
            return one.zone.*member;
        };
    };
    to.values(moving.yielding, kept.plastic_strain, of_zone(&YieldingZone::plastic));
    to.values(moving.yielding, kept.initial_zz, of_zone(&YieldingZone::initial_zz));
    to.values(moving.yielding, kept.stress_zz, of_zone(&YieldingZone::stress_zz));
    to.values(moving.yielding, kept.stress, &MovingYieldingZone::stress);
}

void pass(Tape& tape, MovingZones& moving)
{
    for (MovingZone& one : moving.zone)
        tape(one.strain, one.held);
    for (MovingYieldingZone& one : moving.yielding)
        tape(one.zone.plastic, one.zone.stress_zz, one.zone.dissipated, one.stress);
    tape(moving.corner_force);
}

} // namespace jointcreep::rock
