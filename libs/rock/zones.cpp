#include "rock/zones.hpp"

#include "model/signs.hpp"
#include "rock/zone_stiffness.hpp"

#include <algorithm>
#include <cmath>

namespace jointcreep::rock
{

namespace
{

constexpr Index zones_of_part = 1024; // some hundred gridpoints are in two parts then, of thousands

Vector3d stress_of_yielding(Zones& zones, std::size_t z, const Vector3d& strain)
{
    YieldingZone& zone = zones.yielding[zones.yielding_number[z]];
    if (!zones.holds_yield)
        return yielded(zone, zones.stiffness[z], zones.initial_stress[z], zones.stress[z], strain);
    const Eigen::Vector4d s = elastic_stress(zone, zones.stiffness[z], zones.initial_stress[z], strain);
    zone.stress_zz = s[3];
    return s.head<3>();
}

// A number of one zone and the same number of the next zone, for instructions on two numbers at once. Each is rounded
// as it would be alone.
using Two = double __attribute__((vector_size(16)));

Two xs_of(const Vector2d& one, const Vector2d& next)
{
    return Two{one.x(), next.x()};
}
Two ys_of(const Vector2d& one, const Vector2d& next)
{
    return Two{one.y(), next.y()};
}

template <int n_gridpoints, bool any_yields, bool forces_alone> // branches less for each zone
void pull(Zones& zones, std::span<const Vector2d> displacements, double damping)
{
    Slots& slots = zones.slots;
    const auto n = static_cast<Index>(zones.size());
    const auto n_parts = static_cast<Index>(slots.part_start.size()) - 1;
    // Plain pointers, so that the compiler need not assume that a write changes the arrays read next.
    const Vector2d* const displacement = displacements.data();
    const Index *const gridpoint = zones.gridpoint.data(), *const slot = slots.of_zone.data();
    const Vector2d* const gradient = zones.gradient.data();
    const Vector3d *const stiffness = zones.stiffness.data(), *const initial = zones.initial_stress.data();
    const double* const area = zones.area.data();
    const char* const is_present = zones.is_present.data();
    Vector3d *const stress = zones.stress.data(), *const last_stress = zones.last_stress.data();
    Vector2d* __restrict const force = slots.force.data();
    double* const magnitudes = slots.magnitudes.data();
#pragma omp for schedule(static) nowait
    for (Index part = 0; part < n_parts; ++part) {
        std::fill(force + slots.part_start[part], force + slots.part_start[part + 1], Vector2d(0, 0));
        if (!forces_alone)
            std::fill(magnitudes + slots.part_start[part], magnitudes + slots.part_start[part + 1], 0.0);
        const Index end = std::min(n, (part + 1) * zones_of_part);
        for (Index z = part * zones_of_part; z < end; z += 2) {
            const std::array<Index, 2> both{z, std::min(z + 1, end - 1)};
            const std::array<bool, 2> is_there{is_present[z] != 0, z + 1 < end && is_present[z + 1] != 0};
            if (!is_there[0] && !is_there[1])
                continue;
            std::array<Two, n_gridpoints> ux, uy, bx, by;
            const Index first = n_gridpoints * both[0], second = n_gridpoints * both[1];
            for (int i = 0; i < n_gridpoints; ++i) {
                const Vector2d &u = displacement[gridpoint[first + i]],
                               &v = displacement[gridpoint[second + i]];
                ux[i] = xs_of(u, v);
                uy[i] = ys_of(u, v);
                bx[i] = xs_of(gradient[first + i], gradient[second + i]);
                by[i] = ys_of(gradient[first + i], gradient[second + i]);
            }
            const auto of_both = [&](const Vector3d* of, int i) {
                return Two{of[both[0]][i], of[both[1]][i]};
            };
            Two exx = bx[0] * ux[0], eyy = by[0] * uy[0], gxy = by[0] * ux[0] + bx[0] * uy[0];
            for (int i = 1; i < n_gridpoints; ++i) {
                exx += bx[i] * ux[i];
                eyy += by[i] * uy[i];
                gxy += by[i] * ux[i] + bx[i] * uy[i];
            }
            const Two c11 = of_both(stiffness, 0), c12 = of_both(stiffness, 1), c33 = of_both(stiffness, 2);
            Two xx = of_both(initial, 0) + (c11 * exx + c12 * eyy),
                yy = of_both(initial, 1) + (c12 * exx + c11 * eyy), xy = of_both(initial, 2) + c33 * gxy;
            if constexpr (any_yields)
                for (int k = 0; k < 2; ++k)
                    if (is_there[k] && zones.yielding_number[both[k]] >= 0) {
                        const Vector3d now = stress_of_yielding(zones, both[k], {exx[k], eyy[k], gxy[k]});
                        xx[k] = now[0];
                        yy[k] = now[1];
                        xy[k] = now[2];
                    }
            if (any_yields || !forces_alone) // the energy of yielding needs the last stress
                for (int k = 0; k < 2; ++k)
                    if (is_there[k])
                        stress[both[k]] = {xx[k], yy[k], xy[k]};
            if (damping > 0)
                for (int k = 0; k < 2; ++k) {
                    if (!is_there[k])
                        continue;
                    const Vector3d now(xx[k], yy[k], xy[k]),
                        acting = now + damping * (now - last_stress[both[k]]);
                    last_stress[both[k]] = now;
                    xx[k] = acting[0];
                    yy[k] = acting[1];
                    xy[k] = acting[2];
                }
            const Two pull = Two{-area[both[0]], -area[both[1]]};
            xx *= pull;
            yy *= pull;
            xy *= pull;
            std::array<Two, n_gridpoints> x, y;
            for (int i = 0; i < n_gridpoints; ++i) {
                x[i] = xx * bx[i] + xy * by[i];
                y[i] = xy * bx[i] + yy * by[i];
            }
            for (int k = 0; k < 2; ++k)
                if (is_there[k])
                    for (int i = 0; i < n_gridpoints; ++i) {
                        const Index s = slot[n_gridpoints * both[k] + i];
                        force[s].x() += x[i][k];
                        force[s].y() += y[i][k];
                        if (!forces_alone)
                            magnitudes[s] += std::sqrt(x[i][k] * x[i][k] + y[i][k] * y[i][k]);
                    }
        }
    }
}

// A stress point of a zone of this rock, without its gridpoints.
void add_point(Zones& zones, const Scene& scene, const Rock& rock, double area, const Vector2d& place,
               bool any_yields)
{
    zones.area.push_back(area);
    zones.mass.push_back(rock.density * area);
    zones.weight.push_back(rock.density * area * scene.gravity);
    zones.stiffness.push_back(elasticity_of(rock));
    zones.creeps.push_back(scene.creep && (rock.kelvin || rock.maxwell_viscosity) ? 1 : 0);
    const Vector3d initial = scene.in_situ_stress.at(place);
    zones.initial_stress.push_back(initial);
    const bool yields = rock.law == RockLaw::mohr_coulomb;
    if (any_yields)
        zones.yielding_number.push_back(yields ? static_cast<Index>(zones.yielding.size()) : -1);
    // Scenes do not give the stress across the section: the mean is never the largest or the smallest.
    if (yields)
        zones.yielding.push_back(
            {.law = MohrCoulomb::of(rock.strength->cohesion, rock.strength->friction_angle,
                                    rock.strength->tensile_strength, rock.dilation_angle),
             .initial_zz = (initial[0] + initial[1]) / 2});
}

} // namespace

ZonesState state_of(const Zones& zones)
{
    return {zones.stress, zones.yielding};
}

void go_back(Zones& zones, const ZonesState& state)
{
    zones.stress = state.stress;
    zones.yielding = state.yielding;
}

bool yields(const Zones& zones)
{
    return !zones.holds_yield && !zones.yielding.empty();
}

Zones zones_of(const Scene& scene, const Network& network, const Mesh& mesh)
{
    Zones zones;
    const std::size_t n = mesh.zone_gridpoint.size();
    const bool is_quadratic = !mesh.zone_middle.empty(), any_yields = scene.has_rock_that_yields();
    if (is_quadratic) {
        zones.gridpoints_of_zone = 6;
        zones.points_of_zone = 3;
    }
    for (std::size_t z = 0; z < n; ++z) {
        const auto& corners = mesh.zone_gridpoint[z];
        std::array<Vector2d, 3> p;
        for (int i = 0; i < 3; ++i)
            p[i] = mesh.gridpoint[corners[i]];
        const Vector2d d1 = p[1] - p[0], d2 = p[2] - p[0];
        const double twice_area = d1.x() * d2.y() - d1.y() * d2.x();
        std::array<Vector2d, 3> gradient; // of each corner's shape function
        for (int i = 0; i < 3; ++i) {
            const Vector2d opposite = p[(i + 2) % 3] - p[(i + 1) % 3];
            gradient[i] = normal_of(opposite) / twice_area;
        }
        const Rock& rock = scene.rocks[network.blocks.block_rock[mesh.zone_block[z]]];
        if (!is_quadratic) {
            zones.gridpoint.insert(zones.gridpoint.end(), corners.begin(), corners.end());
            zones.gradient.insert(zones.gradient.end(), gradient.begin(), gradient.end());
            add_point(zones, scene, rock, twice_area / 2, (p[0] + p[1] + p[2]) / 3, any_yields);
            continue;
        }
        for (int point = 0; point < 3; ++point) {
            std::array<double, 3> share{1. / 6, 1. / 6, 1. / 6}; // corners' shape functions at the point
            share[point] = 2. / 3;
            zones.gridpoint.insert(zones.gridpoint.end(), corners.begin(), corners.end());
            zones.gridpoint.insert(zones.gridpoint.end(), mesh.zone_middle[z].begin(),
                                   mesh.zone_middle[z].end());
            for (int i = 0; i < 3; ++i)
                zones.gradient.emplace_back((4 * share[i] - 1) * gradient[i]);
            for (int i = 0; i < 3; ++i) {
                const int j = (i + 1) % 3;
                zones.gradient.emplace_back(4 * (share[i] * gradient[j] + share[j] * gradient[i]));
            }
            add_point(zones, scene, rock, twice_area / 6, mesh.stress_point[3 * z + point], any_yields);
        }
    }
    zones.stress = zones.initial_stress;
    zones.is_present.assign(zones.size(), 1);
    return zones;
}

void find_incidence(Zones& zones, std::size_t n_gridpoints)
{
    zones.corners = grouped(zones.gridpoint, n_gridpoints);
    zones.slots = {};
    Slots& slots = zones.slots;
    std::vector<Index> gridpoint; // of each slot
    std::vector<Index> slot_of(n_gridpoints,
                               -1); // in this part; less than its first one where it has none yet
    slots.part_start.assign(1, 0);
    for (std::size_t z = 0; z < zones.size(); ++z) {
        if (z > 0 && z % zones_of_part == 0)
            slots.part_start.push_back(static_cast<Index>(gridpoint.size()));
        for (const Index g : zones.gridpoints(z)) {
            Index& slot = slot_of[g];
            if (slot < slots.part_start.back()) {
                slot = static_cast<Index>(gridpoint.size());
                gridpoint.push_back(g);
            }
            slots.of_zone.push_back(slot);
        }
    }
    slots.part_start.push_back(static_cast<Index>(gridpoint.size()));
    slots.force.assign(gridpoint.size(), Vector2d::Zero());
    slots.magnitudes.assign(gridpoint.size(), 0.0);
    slots.by_gridpoint = grouped(gridpoint, n_gridpoints);
}

bool has_rock(const Zones& zones, Index gridpoint)
{
    return std::ranges::any_of(zones.corners[gridpoint], [&](Index corner) {
        return zones.is_present[corner / zones.gridpoints_of_zone] != 0;
    });
}

bool has_lost_rock(const Zones& zones, Index gridpoint)
{
    return !zones.corners[gridpoint].empty() && !has_rock(zones, gridpoint);
}

namespace
{

template <int n_gridpoints>
void find_forces_of(Zones& zones, std::span<const Vector2d> displacement, double damping, bool forces_alone)
{
    if (!zones.yielding.empty())
        forces_alone ? pull<n_gridpoints, true, true>(zones, displacement, damping)
                     : pull<n_gridpoints, true, false>(zones, displacement, damping);
    else
        forces_alone ? pull<n_gridpoints, false, true>(zones, displacement, damping)
                     : pull<n_gridpoints, false, false>(zones, displacement, damping);
}

} // namespace

void find_forces_in_team(Zones& zones, std::span<const Vector2d> displacement, double damping,
                         bool forces_alone)
{
    if (zones.gridpoints_of_zone == 3)
        find_forces_of<3>(zones, displacement, damping, forces_alone);
    else
        find_forces_of<6>(zones, displacement, damping, forces_alone);
}

Vector3d strain_at(const Zones& zones, std::size_t z, std::span<const Vector2d> displacement)
{
    double exx = 0, eyy = 0, gxy = 0;
    for (int i = 0; i < zones.gridpoints_of_zone; ++i) {
        const Vector2d &u = displacement[zones.gridpoints(z)[i]], &gradient = zones.gradients(z)[i];
        exx += gradient.x() * u.x();
        eyy += gradient.y() * u.y();
        gxy += gradient.y() * u.x() + gradient.x() * u.y();
    }
    return {exx, eyy, gxy};
}

void add_row_sums(const Zones& zones, std::span<const Vector2d> /*displacement*/, std::vector<Vector2d>& sums)
{
    for (std::size_t z = 0; z < zones.size(); ++z) {
        if (!zones.is_present[z])
            continue;
        for (int i = 0; i < zones.gridpoints_of_zone; ++i)
            for (int j = 0; j < zones.gridpoints_of_zone; ++j)
                sums[zones.gridpoints(z)[i]] +=
                    zones.area[z] * stiffness_between(zones, z, i, j).cwiseAbs().rowwise().sum();
    }
}

void add_masses(const Zones& zones, std::vector<double>& mass)
{
    for (std::size_t z = 0; z < zones.size(); ++z) {
        if (!zones.is_present[z])
            continue;
        const auto gridpoints = zones.gridpoints(z);
        if (gridpoints.size() == 3)
            for (const Index g : gridpoints)
                mass[g] += zones.mass[z] / 3;
        else
            for (std::size_t i = 0; i < gridpoints.size(); ++i)
                mass[gridpoints[i]] += zones.mass[z] * (i < 3 ? 1. / 19 : 16. / 57);
    }
}

void add_weight(const Zones& zones, std::size_t z, double share, std::vector<Vector2d>& load)
{
    const auto gridpoints = zones.gridpoints(z);
    for (const Index g : gridpoints.last(3)) // all, or the middles of the sides
        load[g].y() -= share * (zones.weight[z] / 3);
}

double stored_energy(const Zones& zones)
{
    double energy = 0;
    for (std::size_t z = 0; z < zones.size(); ++z) {
        if (!zones.is_present[z])
            continue;
        if (!zones.yielding.empty() && zones.yielding_number[z] >= 0) {
            energy += zones.area[z] * stored(zones.stiffness[z], zones.stress[z],
                                             zones.yielding[zones.yielding_number[z]].stress_zz);
            continue;
        }
        // s . C^-1 s / 2, plane strain.
        const Vector3d &s = zones.stress[z], &c = zones.stiffness[z];
        const double determinant = c[0] * c[0] - c[1] * c[1];
        energy += zones.area[z] / 2 *
                  ((c[0] * (s[0] * s[0] + s[1] * s[1]) - 2 * c[1] * s[0] * s[1]) / determinant +
                   s[2] * s[2] / c[2]);
    }
    return energy;
}

double returned_energy(const Zones& zones, const ZonesState& start)
{
    double energy = 0;
    for (std::size_t z = 0; z < zones.yielding_number.size(); ++z)
        if (const Index number = zones.yielding_number[z]; number >= 0 && zones.is_present[z]) {
            const YieldingZone& zone = zones.yielding[number];
            const Eigen::Vector4d more = zone.plastic - start.yielding[number].plastic;
            const Vector3d &now = zones.stress[z], &c = zones.stiffness[z];
            const Vector3d held(now[0] + c[0] * more[0] + c[1] * (more[1] + more[2]),
                                now[1] + c[0] * more[1] + c[1] * (more[0] + more[2]),
                                now[2] + c[2] * more[3]);
            const double held_zz = zone.stress_zz + c[0] * more[2] + c[1] * (more[0] + more[1]);
            energy += zones.area[z] * (stored(c, held, held_zz) - stored(c, now, zone.stress_zz));
        }
    return energy;
}

void begin_search(Zones& zones, bool damps_stiffness)
{
    for (YieldingZone& zone : zones.yielding)
        zone.dissipated = 0;
    if (damps_stiffness)
        zones.last_stress = zones.stress;
}

double dissipated(const Zones& zones, const ZonesState& start)
{
    double sum = 0;
    for (std::size_t z = 0; z < zones.yielding_number.size(); ++z)
        if (const Index number = zones.yielding_number[z]; number >= 0) {
            const YieldingZone& zone = zones.yielding[number];
            const Vector3d& now = zones.stress[z];
            const Eigen::Vector4d more = zone.plastic - start.yielding[number].plastic;
            sum += zones.area[z] * (now.dot(Vector3d(more[0], more[1], more[3])) + zone.stress_zz * more[2]);
        }
    return sum;
}

double dissipated(const Zones& zones)
{
    double sum = 0;
    for (std::size_t z = 0; z < zones.yielding_number.size(); ++z)
        if (const Index number = zones.yielding_number[z]; number >= 0)
            sum += zones.area[z] * zones.yielding[number].dissipated;
    return sum;
}

bool has_yielded(const Zones& zones, std::size_t zone)
{
    if (zones.yielding.empty())
        return false;
    for (int i = 0; i < zones.points_of_zone; ++i) {
        const std::size_t z = zones.first_point_of(zone) + i;
        const Index number = zones.yielding_number[z];
        if (number >= 0 && zones.is_present[z] && !zones.yielding[number].plastic.isZero(0))
            return true;
    }
    return false;
}

double largest_plastic_strain(const Zones& zones)
{
    double largest = 0;
    for (std::size_t z = 0; z < zones.yielding_number.size(); ++z)
        if (const Index number = zones.yielding_number[z]; number >= 0 && zones.is_present[z]) {
            const Eigen::Vector4d& plastic = zones.yielding[number].plastic;
            largest = std::max(largest, std::hypot(plastic[0] - plastic[1], plastic[3]));
        }
    return largest;
}

Index weakest(const Zones& zones)
{
    Index weakest = -1;
    double most = 0;
    for (std::size_t z = 0; z < zones.yielding_number.size(); ++z) {
        if (zones.yielding_number[z] < 0 || !zones.is_present[z])
            continue;
        const YieldingZone& zone = zones.yielding[zones.yielding_number[z]];
        const Vector3d& s = zones.stress[z];
        if (const double beyond = excess(zone.law, {s[0], s[1], s[2], zone.stress_zz}); beyond > most) {
            most = beyond;
            weakest = static_cast<Index>(z);
        }
    }
    return weakest;
}

bool is_within_strength(const Zones& zones)
{
    return weakest(zones) < 0;
}

bool is_finite(const Zones& zones)
{
    return std::ranges::all_of(zones.stress, [](const Vector3d& stress) { return stress.allFinite(); });
}

void excavate(Zones& zones, const std::vector<char>& is_removed, std::vector<Vector2d>& load)
{
    for (std::size_t z = 0; z < zones.size(); ++z)
        if (is_removed[z]) {
            add_weight(zones, z, -1, load);
            zones.is_present[z] = 0;
            zones.stress[z].setZero();
        }
}

void join(const Zones& zones, DisjointSets& gridpoints)
{
    for (std::size_t z = 0; z < zones.size(); ++z)
        if (zones.is_present[z])
            for (const Index g : zones.gridpoints(z))
                gridpoints.join(g, zones.gridpoints(z)[0]);
}

void start_from_here(Zones& zones)
{
    zones.initial_stress = zones.stress;
    for (YieldingZone& zone : zones.yielding) {
        zone.initial_zz = zone.stress_zz;
        zone.plastic.setZero();
    }
}

void record_state(const Zones& zones, States& states)
{
    const auto mean_over = [&zones](std::size_t zone, const auto& value) { // stress points
        const std::size_t first = zones.first_point_of(zone);
        auto sum = value(first);
        for (int i = 1; i < zones.points_of_zone; ++i)
            sum += value(first + i);
        return decltype(sum)(sum / zones.points_of_zone);
    };
    const std::size_t n = zones.zone_of(zones.size());
    states.yielding_zone.clear();
    states.creeping_zone.clear();
    for (std::size_t zone = 0; zone < n; ++zone) {
        const std::size_t first = zones.first_point_of(zone);
        states.stress.push_back(mean_over(zone, [&](std::size_t z) { return zones.stress[z]; }));
        states.zone_present.push_back(zones.is_present[first]);
        if (!zones.yielding.empty() && zones.yielding_number[first] >= 0) {
            const auto of = [&](std::size_t z) -> const YieldingZone& {
                return zones.yielding[zones.yielding_number[z]];
            };
            states.yielding_zone.push_back(static_cast<Index>(zone));
            states.plastic_strain.push_back(mean_over(zone, [&](std::size_t z) {
                return Vector3d(of(z).plastic[0], of(z).plastic[1], of(z).plastic[3] / 2);
            }));
            states.stress_zz.push_back(mean_over(zone, [&](std::size_t z) { return of(z).stress_zz; }));
        }
        if (zones.creeps[first]) {
            states.creeping_zone.push_back(static_cast<Index>(zone));
            const Vector3d initial = mean_over(zone, [&](std::size_t z) { return zones.initial_stress[z]; });
            // Creep subtracts 2 G times its strain from the stress at zero displacement, which the first state has.
            states.crept_strain.emplace_back((states.stress[zone] - initial) /
                                             (2 * zones.stiffness[first][2]));
        }
    }
    if (zones.points_of_zone > 1)
        states.point_stress.insert(states.point_stress.end(), zones.stress.begin(), zones.stress.end());
}

void transfer(const Transfer& to, Zones& zones, Checkpoint& kept)
{
    to.values(zones.is_present, kept.zone_present);
    to.values(zones.stress, kept.stress);
    to.values(zones.initial_stress, kept.initial_stress);
    to.values(zones.stiffness, kept.stiffness);
    to.values(zones.yielding, kept.plastic_strain, &YieldingZone::plastic);
    to.values(zones.yielding, kept.stress_zz, &YieldingZone::stress_zz);
    to.values(zones.yielding, kept.initial_zz, &YieldingZone::initial_zz);
}

void pass(Tape& tape, Zones& zones)
{
    tape(zones.stress, zones.last_stress);
    for (YieldingZone& one : zones.yielding)
        tape(one.plastic, one.stress_zz, one.dissipated);
}

} // namespace jointcreep::rock
