#include "rock/zones.hpp"

#include "model/signs.hpp"

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

// A number of one zone and the same of the next: two zones at a time go through one instruction. Every one of
// the two is rounded as it would be alone.
using Two = double __attribute__((vector_size(16)));

Two xs_of(const Vector2d& one, const Vector2d& next)
{
    return Two{one.x(), next.x()};
}
Two ys_of(const Vector2d& one, const Vector2d& next)
{
    return Two{one.y(), next.y()};
}

template <bool any_yields, bool forces_alone> // branches less for each zone
void pull(Zones& zones, Slots& slots, std::span<const Vector2d> displacements, double damping)
{
    const auto n = static_cast<Index>(zones.gridpoint.size());
    const auto n_parts = static_cast<Index>(slots.part_start.size()) - 1;
    // Plain pointers: through the arrays themselves, what is written might always be what is read next.
    const Vector2d* const displacement = displacements.data();
    const std::array<Index, 3>*const gridpoint = zones.gridpoint.data(), *const slot = slots.of_zone.data();
    const std::array<Vector2d, 3>* const gradient = zones.gradient.data();
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
            std::array<Two, 3> ux, uy, bx, by; // of the corners
            for (int i = 0; i < 3; ++i) {
                const Vector2d &u = displacement[gridpoint[both[0]][i]],
                               &v = displacement[gridpoint[both[1]][i]];
                ux[i] = xs_of(u, v);
                uy[i] = ys_of(u, v);
                bx[i] = xs_of(gradient[both[0]][i], gradient[both[1]][i]);
                by[i] = ys_of(gradient[both[0]][i], gradient[both[1]][i]);
            }
            const auto of_both = [&](const Vector3d* of, int i) {
                return Two{of[both[0]][i], of[both[1]][i]};
            };
            const Two exx = bx[0] * ux[0] + bx[1] * ux[1] + bx[2] * ux[2];
            const Two eyy = by[0] * uy[0] + by[1] * uy[1] + by[2] * uy[2];
            const Two gxy = (by[0] * ux[0] + bx[0] * uy[0]) + (by[1] * ux[1] + bx[1] * uy[1]) +
                            (by[2] * ux[2] + bx[2] * uy[2]);
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
            if (any_yields || !forces_alone) // the account of what yielding takes wants the last stress
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
            std::array<Two, 3> x, y;
            for (int i = 0; i < 3; ++i) {
                x[i] = xx * bx[i] + xy * by[i];
                y[i] = xy * bx[i] + yy * by[i];
            }
            for (int k = 0; k < 2; ++k)
                if (is_there[k])
                    for (int i = 0; i < 3; ++i) {
                        const Index s = slot[both[k]][i];
                        force[s].x() += x[i][k];
                        force[s].y() += y[i][k];
                        if (!forces_alone)
                            magnitudes[s] += std::sqrt(x[i][k] * x[i][k] + y[i][k] * y[i][k]);
                    }
        }
    }
}

} // namespace

Zones zones_of(const Scene& scene, const Network& network, const Mesh& mesh)
{
    Zones zones;
    const std::size_t n = mesh.zone_gridpoint.size();
    zones.gridpoint = mesh.zone_gridpoint;
    zones.is_present.assign(n, 1);
    const bool any_yields = std::any_of(scene.rocks.begin(), scene.rocks.end(),
                                        [](const Rock& rock) { return rock.law == RockLaw::mohr_coulomb; });
    for (std::size_t z = 0; z < n; ++z) {
        std::array<Vector2d, 3> p;
        for (int i = 0; i < 3; ++i)
            p[i] = mesh.gridpoint[mesh.zone_gridpoint[z][i]];
        const Vector2d d1 = p[1] - p[0], d2 = p[2] - p[0];
        const double twice_area = d1.x() * d2.y() - d1.y() * d2.x();
        std::array<Vector2d, 3> gradient;
        for (int i = 0; i < 3; ++i) {
            const Vector2d opposite = p[(i + 2) % 3] - p[(i + 1) % 3];
            gradient[i] = normal_of(opposite) / twice_area;
        }
        const Rock& rock = scene.rocks[network.blocks.block_rock[mesh.zone_block[z]]];
        const double E = rock.youngs_modulus, nu = rock.poissons_ratio;
        const double factor = E / ((1 + nu) * (1 - 2 * nu));
        zones.gradient.push_back(gradient);
        zones.area.push_back(twice_area / 2);
        zones.mass.push_back(rock.density * twice_area / 2);
        zones.weight.push_back(rock.density * twice_area / 2 * scene.gravity);
        zones.stiffness.emplace_back(factor * (1 - nu), factor * nu, E / (2 * (1 + nu)));
        const Vector3d initial = scene.in_situ_stress.at((p[0] + p[1] + p[2]) / 3);
        zones.initial_stress.push_back(initial);
        const bool yields = rock.law == RockLaw::mohr_coulomb;
        if (any_yields)
            zones.yielding_number.push_back(yields ? static_cast<Index>(zones.yielding.size()) : -1);
        // No scene says what acts across the section: the mean is never the largest or the smallest.
        if (yields)
            zones.yielding.push_back(
                {.law = MohrCoulomb::of(rock.strength->cohesion, rock.strength->friction_angle,
                                        rock.strength->tensile_strength, rock.dilation_angle),
                 .initial_zz = (initial[0] + initial[1]) / 2});
        if (scene.creep && (rock.kelvin || rock.maxwell_viscosity))
            zones.creeping.push_back(static_cast<Index>(z));
    }
    zones.stress = zones.initial_stress;
    return zones;
}

Slots slots_of(const Zones& zones, std::size_t n_gridpoints, std::vector<std::array<Index, 1>>& gridpoint)
{
    Slots slots;
    std::vector<Index> slot_of(n_gridpoints,
                               -1); // in this part; less than its first one where it has none yet
    slots.part_start.assign(1, 0);
    slots.of_zone.resize(zones.gridpoint.size());
    for (std::size_t z = 0; z < zones.gridpoint.size(); ++z) {
        if (z > 0 && z % zones_of_part == 0)
            slots.part_start.push_back(static_cast<Index>(gridpoint.size()));
        for (int i = 0; i < 3; ++i) {
            Index& slot = slot_of[zones.gridpoint[z][i]];
            if (slot < slots.part_start.back()) {
                slot = static_cast<Index>(gridpoint.size());
                gridpoint.push_back({zones.gridpoint[z][i]});
            }
            slots.of_zone[z][i] = slot;
        }
    }
    slots.part_start.push_back(static_cast<Index>(gridpoint.size()));
    slots.force.assign(gridpoint.size(), Vector2d::Zero());
    slots.magnitudes.assign(gridpoint.size(), 0.0);
    return slots;
}

void find_forces_in_team(Zones& zones, Slots& slots, std::span<const Vector2d> displacement, double damping,
                         bool forces_alone)
{
    if (!zones.yielding.empty())
        forces_alone ? pull<true, true>(zones, slots, displacement, damping)
                     : pull<true, false>(zones, slots, displacement, damping);
    else
        forces_alone ? pull<false, true>(zones, slots, displacement, damping)
                     : pull<false, false>(zones, slots, displacement, damping);
}

Eigen::Matrix2d stiffness_between(const Zones& zones, std::size_t z, int i, int j)
{
    const Vector3d& c = zones.stiffness[z];
    const Vector2d &p = zones.gradient[z][i], &q = zones.gradient[z][j];
    Eigen::Matrix2d block;
    block << c[0] * p.x() * q.x() + c[2] * p.y() * q.y(), c[1] * p.x() * q.y() + c[2] * p.y() * q.x(),
        c[1] * p.y() * q.x() + c[2] * p.x() * q.y(), c[0] * p.y() * q.y() + c[2] * p.x() * q.x();
    return block;
}

Vector3d stress_by(const Zones& zones, std::size_t z, std::span<const Vector2d> displacement,
                   const Vector3d& stiffness)
{
    double exx = 0, eyy = 0, gxy = 0;
    for (int i = 0; i < 3; ++i) {
        const Vector2d &u = displacement[zones.gridpoint[z][i]], &gradient = zones.gradient[z][i];
        exx += gradient.x() * u.x();
        eyy += gradient.y() * u.y();
        gxy += gradient.y() * u.x() + gradient.x() * u.y();
    }
    const Vector3d& c = stiffness;
    return {c[0] * exx + c[1] * eyy, c[1] * exx + c[0] * eyy, c[2] * gxy};
}

void add_force(const Zones& zones, std::size_t z, const Vector3d& stress, std::vector<Vector2d>& force)
{
    for (int i = 0; i < 3; ++i) {
        const Vector2d& gradient = zones.gradient[z][i];
        force[zones.gridpoint[z][i]] -=
            zones.area[z] * Vector2d(stress[0] * gradient.x() + stress[2] * gradient.y(),
                                     stress[2] * gradient.x() + stress[1] * gradient.y());
    }
}

void add_row_sums(const Zones& zones, std::vector<Vector2d>& sums)
{
    for (std::size_t z = 0; z < zones.gridpoint.size(); ++z) {
        if (!zones.is_present[z])
            continue;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                sums[zones.gridpoint[z][i]] +=
                    zones.area[z] * stiffness_between(zones, z, i, j).cwiseAbs().rowwise().sum();
    }
}

void add_masses(const Zones& zones, std::vector<double>& mass)
{
    for (std::size_t z = 0; z < zones.gridpoint.size(); ++z)
        if (zones.is_present[z])
            for (const Index g : zones.gridpoint[z])
                mass[g] += zones.mass[z] / 3;
}

double stored_energy(const Zones& zones)
{
    double energy = 0;
    for (std::size_t z = 0; z < zones.gridpoint.size(); ++z) {
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

double dissipated(const Zones& zones)
{
    double sum = 0;
    for (std::size_t z = 0; z < zones.yielding_number.size(); ++z)
        if (const Index number = zones.yielding_number[z]; number >= 0)
            sum += zones.area[z] * zones.yielding[number].dissipated;
    return sum;
}

void forget_dissipated(Zones& zones)
{
    for (YieldingZone& zone : zones.yielding)
        zone.dissipated = 0;
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
    states.stress.insert(states.stress.end(), zones.stress.begin(), zones.stress.end());
    states.zone_present.insert(states.zone_present.end(), zones.is_present.begin(), zones.is_present.end());
    states.yielding_zone.clear();
    for (std::size_t z = 0; z < zones.yielding_number.size(); ++z)
        if (const Index number = zones.yielding_number[z]; number >= 0) {
            const YieldingZone& zone = zones.yielding[number];
            states.yielding_zone.push_back(static_cast<Index>(z));
            states.plastic_strain.emplace_back(zone.plastic[0], zone.plastic[1], zone.plastic[3] / 2);
            states.stress_zz.push_back(zone.stress_zz);
        }
    // Creep takes 2 G times its strain off the stress at zero displacement, which is that of the first state.
    states.creeping_zone = zones.creeping;
    for (const Index z : zones.creeping)
        states.crept_strain.emplace_back((states.stress[z] - zones.initial_stress[z]) /
                                         (2 * zones.stiffness[z][2]));
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

} // namespace jointcreep::rock
