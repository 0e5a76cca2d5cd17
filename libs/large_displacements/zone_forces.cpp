#include "large_displacements/dynamics.hpp"
#include "large_displacements/finite_strain.hpp"
#include "large_displacements/in_chunks.hpp"
#include "model/error.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace jointcreep::large_displacements
{

namespace
{

constexpr double most_strain = 0.5; // of a zone that yields [-]

} // namespace

Dynamics::Yielding* Dynamics::yielding(std::size_t z)
{
    if (yielding_.empty() || rock_.zones.yielding_number[z] < 0)
        return nullptr;
    return &yielding_[rock_.zones.yielding_number[z]];
}

// Zones with the stress that they have in the assembly, in the shape that they have there.
void Dynamics::make_zones()
{
    for (std::size_t z = 0; z < rock_.zones.size(); ++z) {
        const Vector3d& stiffness = rock_.zones.stiffness[z];
        const Matrix2d stretch = stretch_for(stiffness, rock_.zones.stress[z]);
        Zone zone;
        std::copy_n(rock_.zones.gridpoints(z).begin(), 3, zone.gridpoint.begin());
        zone.inverse = edges_of(zone.gridpoint, place_).inverse() * stretch;
        zone.area = rock_.zones.area[z] / stretch.determinant();
        zone.stiffness = stiffness;
        zone.strain = {stretch(0, 0) - 1, stretch(1, 1) - 1, 2 * stretch(0, 1)};
        zones_.push_back(zone);
        if (rock_.zones.yielding.empty() || rock_.zones.yielding_number[z] < 0)
            continue;
        rock::YieldingZone yielding = rock_.zones.yielding[rock_.zones.yielding_number[z]];
        yielding.plastic.setZero(); // is in the shape without stress
        yielding.dissipated = 0;
        yielding.initial_zz = yielding.stress_zz - stiffness[1] * (zone.strain[0] + zone.strain[1]);
        yielding_.push_back({yielding, stress_of(stiffness, zone.strain)});
    }
}

// `acting`: Biot's stress with that of dashpots [Pa].
inline void Dynamics::take_corner_forces(Index z, const Polar& polar, const Vector3d& acting, bool yields)
{
    const Zone& zone = zones_[z];
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
    Vector2d* const force = corner_force_.data() + 3 * static_cast<std::ptrdiff_t>(z);
    force[0] = one + two;
    force[1] = -one;
    force[2] = -two;
}

// Stress and corner forces of one zone at the present places; adds its energies. `viscosity`: of dashpots over
// springs, by strains in this step [-].
inline void Dynamics::find_zone_force(Index z, double viscosity, ZoneSums& sums)
{
    Zone& zone = zones_[z];
    const Polar polar = polar_of(zone.gridpoint, place_, zone.inverse);
    const Vector3d strain(polar.xx - 1, polar.yy - 1, 2 * polar.xy);
    Vector3d stress, held;
    Yielding* const yields = yielding(z);
    if (yields != nullptr) {
        const Vector3d last = yields->stress;
        yields->zone.dissipated = 0;
        stress = yielded(yields->zone, zone.stiffness, Vector3d::Zero(), last, strain);
        held = viscosity * (stress - last);
        yields->stress = stress;
        if (sums.torn < 0 && !(strain.cwiseAbs().maxCoeff() <= most_strain))
            sums.torn = z;
        sums.friction += zone.area * yields->zone.dissipated;
        sums.stored += zone.area * rock::stored(zone.stiffness, stress, yields->zone.stress_zz);
    } else {
        stress = stress_of(zone.stiffness, strain);
        held = viscosity * stress_of(zone.stiffness, strain - zone.strain);
        sums.stored += zone.area / 2 * stress.dot(strain);
    }
    sums.damped += zone.area / 2 * (zone.held + held).dot(strain - zone.strain); // as of contacts
    zone.held = held;
    zone.strain = strain;
    take_corner_forces(z, polar, stress + held, yields != nullptr);
}

// Corner forces and energies of all zones, at the present places.
void Dynamics::find_zone_forces()
{
    if (!any_deforms_)
        return;
    const double viscosity = settings_.stiffness_damping / dt_;
    const double lost_before = in_zones_.friction; // at the start
    in_zones_ = sum_in_chunks<ZoneSums>(static_cast<Index>(zones_.size()), rock_.threads,
                                        [&](Index z, ZoneSums& sums) {
                                            if (deforms(z))
                                                find_zone_force(z, viscosity, sums);
                                        });
    in_zones_.friction += lost_before;
}

// Refuses rock that yields too far.
void Dynamics::check_strain() const
{
    if (in_zones_.torn >= 0)
        throw equilibrium_error("dynamic analysis: rock that yields at " +
                                shown(Vector2d(middle_ + place_[zones_[in_zones_.torn].gridpoint[0]])) +
                                " is strained by more than " + shown(100 * most_strain) +
                                " percent, more than a zone can be");
}

// Cauchy's stress, and plastic strain, into the assembly.
void Dynamics::put_back_zone(std::size_t z)
{
    const Zone& zone = zones_[z];
    const Polar polar = polar_of(zone.gridpoint, place_, zone.inverse);
    const Matrix2d rotation = polar.rotation(), stretch = polar.stretch();
    const Yielding* const yields = yielding(z);
    Matrix2d biot = tensor(yields != nullptr ? yields->stress : stress_of(zone.stiffness, zone.strain));
    if (yields != nullptr) {
        biot += skew_part(stretch, biot);
        const Eigen::Vector4d& p = yields->zone.plastic;
        const Matrix2d plastic = rotation * tensor({p[0], p[1], p[3] / 2}) * rotation.transpose();
        rock::YieldingZone& seen = rock_.zones.yielding[rock_.zones.yielding_number[z]];
        seen.plastic = {plastic(0, 0), plastic(1, 1), p[2], 2 * plastic(0, 1)};
        seen.stress_zz = yields->zone.stress_zz;
    }
    const Matrix2d stress = rotation * biot * stretch * rotation.transpose() / stretch.determinant();
    rock_.zones.stress[z] = {stress(0, 0), stress(1, 1), (stress(0, 1) + stress(1, 0)) / 2};
}

} // namespace jointcreep::large_displacements
