#include "mechanics/assembly.hpp"

#include "model/signs.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace jointcreep::mechanics
{

namespace
{

constexpr Index zones_of_part = 1024; // some hundred gridpoints are in two parts then, of thousands

void add_zones(Assembly& assembly, const Scene& scene, const Network& network, const Mesh& mesh)
{
    Zones& zones = assembly.zones;
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
    }
    zones.stress = zones.initial_stress;
}

void add_contacts(Assembly& assembly, const Scene& scene, const EquivalentJoints& joints, const Mesh& mesh)
{
    Contacts& contacts = assembly.contacts;
    const std::size_t n = mesh.contact_edge.size();
    contacts.gridpoint = mesh.contact_gridpoint;
    contacts.normal = mesh.contact_normal;
    contacts.length = mesh.contact_length;
    for (std::size_t c = 0; c < n; ++c) {
        const Index e = mesh.contact_edge[c];
        contacts.law.push_back(joint::law_of(joints, static_cast<std::size_t>(e)));
        const Vector3d stress = scene.in_situ_stress.at(mesh.contact_centre[c]);
        const Vector2d normal = mesh.contact_normal[c], tangent = along(normal);
        const Vector2d pull(stress[0] * normal.x() + stress[2] * normal.y(),
                            stress[2] * normal.x() + stress[1] * normal.y());
        contacts.initial_traction.emplace_back(pull.dot(normal), pull.dot(tangent));
    }
    contacts.state.resize(n);
    contacts.offset.assign(n, Vector2d::Zero());
    contacts.traction = contacts.initial_traction;
    contacts.relative_displacement.assign(n, Vector2d::Zero());
    contacts.status.assign(n, ContactStatus::stuck);
    contacts.work.assign(n, 0.0);
}

Vector3d stress_of_yielding(Zones& zones, std::size_t z, const Vector3d& strain)
{
    YieldingZone& zone = zones.yielding[zones.yielding_number[z]];
    if (!zones.holds_yield)
        return yielded(zone, zones.stiffness[z], zones.initial_stress[z], zones.stress[z], strain);
    const Eigen::Vector4d s = elastic_stress(zone, zones.stiffness[z], zones.initial_stress[z], strain);
    zone.stress_zz = s[3];
    return s.head<3>();
}

// What a contact's springs hold at a traction [J/m].
double stored_in(const joint::Law& law, const Vector2d& traction, double length)
{
    return length * joint::stored(law, traction.x(), traction.y());
}

// Lists of (item, corner) per gridpoint, in the order of items.
template <std::size_t N>
void list_by_gridpoint(const std::vector<std::array<Index, N>>& gridpoints, std::size_t n_gridpoints,
                       std::vector<Index>& start, std::vector<Index>& entry)
{
    start.assign(n_gridpoints + 1, 0);
    for (const auto& item : gridpoints)
        for (const Index g : item)
            ++start[g + 1];
    for (std::size_t g = 0; g < n_gridpoints; ++g)
        start[g + 1] += start[g];
    entry.resize(N * gridpoints.size());
    std::vector<Index> next(start.begin(), start.end() - 1);
    for (std::size_t i = 0; i < gridpoints.size(); ++i)
        for (std::size_t k = 0; k < N; ++k)
            entry[next[gridpoints[i][k]]++] = static_cast<Index>(N * i + k);
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
void pull_zones(Assembly& assembly)
{
    Zones& zones = assembly.zones;
    const Incidence& incidence = assembly.incidence;
    const auto n = static_cast<Index>(zones.gridpoint.size());
    const auto n_parts = static_cast<Index>(incidence.part_start.size()) - 1;
    // Plain pointers: through the arrays themselves, what is written might always be what is read next.
    const Vector2d* const displacement = assembly.displacement.data();
    const std::array<Index, 3>*const gridpoint = zones.gridpoint.data(), *const slot =
                                                                             incidence.zone_slot.data();
    const std::array<Vector2d, 3>* const gradient = zones.gradient.data();
    const Vector3d *const stiffness = zones.stiffness.data(), *const initial = zones.initial_stress.data();
    const double* const area = zones.area.data();
    const char* const is_present = zones.is_present.data();
    Vector3d *const stress = zones.stress.data(), *const last_stress = zones.last_stress.data();
    Vector2d* __restrict const force = assembly.slot_force.data();
    double* const magnitudes = assembly.slot_magnitudes.data();
    const double damping = assembly.stiffness_damping_rate;
#pragma omp for schedule(static) nowait
    for (Index part = 0; part < n_parts; ++part) {
        std::fill(force + incidence.part_start[part], force + incidence.part_start[part + 1], Vector2d(0, 0));
        if (!forces_alone)
            std::fill(magnitudes + incidence.part_start[part], magnitudes + incidence.part_start[part + 1],
                      0.0);
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

void pull_contacts(Assembly& assembly)
{
    Contacts& contacts = assembly.contacts;
    const auto n = static_cast<Index>(contacts.gridpoint.size());
    const Vector2d* u = assembly.displacement.data();
    const double damping = assembly.stiffness_damping_rate;
#pragma omp for schedule(static) nowait
    for (Index c = 0; c < n; ++c) {
        if (contacts.status[c] == ContactStatus::removed)
            continue;
        const auto [a, b] = contacts.gridpoint[c];
        const Vector2d normal = contacts.normal[c], tangent = along(normal);
        const Vector2d apart = u[b] - u[a], relative_displacement(apart.dot(normal), apart.dot(tangent));
        const Vector2d sprung = relative_displacement - contacts.offset[c];
        const joint::Response response =
            joint::respond(contacts.law[c], contacts.state[c], contacts.initial_traction[c].x(),
                           contacts.initial_traction[c].y(), sprung.x(), sprung.y());
        const Vector2d traction(response.sigma_n, response.tau), last = contacts.traction[c];
        const double length = contacts.length[c];
        contacts.work[c] +=
            length / 2 * (last + traction).dot(relative_displacement - contacts.relative_displacement[c]);
        contacts.relative_displacement[c] = relative_displacement;
        contacts.traction[c] = traction;
        contacts.status[c] = response.status;
        Vector2d acting = traction;
        if (damping > 0 && response.status == ContactStatus::stuck)
            acting += damping * (traction - last); // dashpots; none where it slips or is open
        assembly.contact_force[c] = length * (acting.x() * normal + acting.y() * tangent);
    }
}

void add_up_forces(Assembly& assembly)
{
    const Incidence& incidence = assembly.incidence;
    const auto n = static_cast<Index>(assembly.position.size());
    const Index n_chunks = chunks_of(assembly);
    const Vector2d *in_slot = assembly.slot_force.data(), *of_contact = assembly.contact_force.data();
#pragma omp for schedule(static) nowait
    for (Index k = 0; k < n_chunks; ++k)
        for (Index g = k * chunk; g < std::min(n, (k + 1) * chunk); ++g) {
            Vector2d force = assembly.load[g] + assembly.applied[g];
            for (Index i = incidence.slot_start[g]; i < incidence.slot_start[g + 1]; ++i)
                force += in_slot[incidence.slot[i]];
            for (Index i = incidence.contact_start[g]; i < incidence.contact_start[g + 1]; ++i) {
                const Index side = incidence.contact_side[i];
                force += (1 - 2 * (side & 1)) * of_contact[side >> 1]; // a product is quicker than a branch
            }
            assembly.force[g] = force;
        }
}

} // namespace

Assembly assemble(const Scene& scene, const Network& network, const EquivalentJoints& equivalent,
                  const Mesh& mesh)
{
    Assembly assembly;
    const std::size_t n = mesh.gridpoint.size();
    assembly.position = mesh.gridpoint;
    assembly.displacement.assign(n, Vector2d::Zero());
    assembly.force.assign(n, Vector2d::Zero());
    assembly.load.assign(n, Vector2d::Zero());
    assembly.applied.assign(n, Vector2d::Zero());
    for (const Index held : mesh.gridpoint_fixed)
        assembly.is_free_untied.emplace_back((held & 1) != 0 ? 0.0 : 1.0, (held & 2) != 0 ? 0.0 : 1.0);
    add_zones(assembly, scene, network, mesh);
    add_contacts(assembly, scene, equivalent, mesh);
    find_incidence(assembly);
    for (std::size_t z = 0; z < assembly.zones.gridpoint.size(); ++z)
        for (const Index g : assembly.zones.gridpoint[z])
            assembly.load[g].y() -= assembly.zones.weight[z] / 3;
    for (std::size_t t = 0; t < mesh.tie_stage.size(); ++t)
        assembly.ties.push_back({mesh.tie_gridpoint[t], mesh.tie_stage[t]});
    part_ties(assembly, -1);
    return assembly;
}

void find_incidence(Assembly& assembly)
{
    const std::size_t n = assembly.position.size();
    Incidence& incidence = assembly.incidence;
    const auto& zones = assembly.zones.gridpoint;
    list_by_gridpoint(zones, n, incidence.zone_start, incidence.zone_corner);
    list_by_gridpoint(assembly.contacts.gridpoint, n, incidence.contact_start, incidence.contact_side);

    std::vector<std::array<Index, 1>> gridpoint_of_slot;
    std::vector<Index> slot_of(n, -1); // in this part; less than its first one where it has none yet
    incidence.part_start.assign(1, 0);
    incidence.zone_slot.resize(zones.size());
    for (std::size_t z = 0; z < zones.size(); ++z) {
        if (z > 0 && z % zones_of_part == 0)
            incidence.part_start.push_back(static_cast<Index>(gridpoint_of_slot.size()));
        for (int i = 0; i < 3; ++i) {
            Index& slot = slot_of[zones[z][i]];
            if (slot < incidence.part_start.back()) {
                slot = static_cast<Index>(gridpoint_of_slot.size());
                gridpoint_of_slot.push_back({zones[z][i]});
            }
            incidence.zone_slot[z][i] = slot;
        }
    }
    incidence.part_start.push_back(static_cast<Index>(gridpoint_of_slot.size()));
    list_by_gridpoint(gridpoint_of_slot, n, incidence.slot_start, incidence.slot);
    assembly.slot_force.assign(gridpoint_of_slot.size(), Vector2d::Zero());
    assembly.slot_magnitudes.assign(gridpoint_of_slot.size(), 0.0);
    assembly.contact_force.assign(assembly.contacts.gridpoint.size(), Vector2d::Zero());
}

void part_ties(Assembly& assembly, Index stage)
{
    std::erase_if(assembly.ties, [&](const Assembly::Tie& tie) { return tie.stage <= stage; });
    std::map<Index, Index> leader; // union-find over the few gridpoints that are tied
    const auto root = [&](Index g) {
        for (auto found = leader.find(g); found != leader.end() && found->second != g; found = leader.find(g))
            g = found->second;
        return g;
    };
    for (const Assembly::Tie& tie : assembly.ties) {
        const auto [low, high] = std::minmax({root(tie.gridpoint[0]), root(tie.gridpoint[1])});
        leader[high] = low;
    }
    assembly.tied.clear();
    for (const auto& [follower, next] : leader)
        assembly.tied.push_back({follower, root(next)});
    assembly.is_free = assembly.is_free_untied;
    for (const auto& [follower, first] : assembly.tied)
        assembly.is_free[first] = assembly.is_free[first].cwiseMin(assembly.is_free[follower]);
}

void find_forces(Assembly& assembly)
{
#pragma omp parallel num_threads(assembly.threads) if (assembly.threads > 1)
    find_forces_in_team(assembly, false);
}

void find_forces_in_team(Assembly& assembly, bool forces_alone)
{
    if (!assembly.tied.empty()) {
#pragma omp single
        for (const auto& [follower, leader] : assembly.tied)
            assembly.displacement[follower] = assembly.displacement[leader];
    }
    if (!assembly.zones.yielding.empty())
        forces_alone ? pull_zones<true, true>(assembly) : pull_zones<true, false>(assembly);
    else
        forces_alone ? pull_zones<false, true>(assembly) : pull_zones<false, false>(assembly);
    pull_contacts(assembly);
#pragma omp barrier
    add_up_forces(assembly);
    if (!assembly.tied.empty()) {
#pragma omp barrier
#pragma omp single
        for (const auto& [follower, leader] : assembly.tied) {
            assembly.force[leader] += assembly.force[follower];
            assembly.force[follower].setZero();
        }
    }
}

Index chunks_of(const Assembly& assembly)
{
    return (static_cast<Index>(assembly.position.size()) + chunk - 1) / chunk;
}

Index weakest_zone(const Assembly& assembly)
{
    const Zones& zones = assembly.zones;
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

void forget_work(Assembly& assembly)
{
    std::fill(assembly.contacts.work.begin(), assembly.contacts.work.end(), 0.0);
    for (YieldingZone& zone : assembly.zones.yielding)
        zone.dissipated = 0;
}

double work_on_contacts(const Assembly& assembly)
{
    return std::accumulate(assembly.contacts.work.begin(), assembly.contacts.work.end(), 0.0);
}

double dissipated_in_zones(const Assembly& assembly)
{
    double sum = 0;
    for (std::size_t z = 0; z < assembly.zones.yielding_number.size(); ++z)
        if (const Index number = assembly.zones.yielding_number[z]; number >= 0)
            sum += assembly.zones.area[z] * assembly.zones.yielding[number].dissipated;
    return sum;
}

double stored_energy(const Assembly& assembly)
{
    const Zones& zones = assembly.zones;
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
    return energy + energy_stored_in_contacts(assembly);
}

double energy_stored_in_contacts(const Assembly& assembly)
{
    const Contacts& contacts = assembly.contacts;
    double energy = 0;
    for (std::size_t c = 0; c < contacts.gridpoint.size(); ++c)
        if (contacts.status[c] != ContactStatus::removed)
            energy += stored_in(contacts.law[c], contacts.traction[c], contacts.length[c]);
    return energy;
}

Balance balance_of(const Assembly& assembly)
{
    const Incidence& incidence = assembly.incidence;
    struct Part {
        double largest = 0, sum = 0;
        Index worst = 0, n = 0;
    };
    const auto n = static_cast<Index>(assembly.position.size());
    const Index n_chunks = chunks_of(assembly);
    std::vector<Part> parts(n_chunks);
#pragma omp parallel for schedule(static) num_threads(assembly.threads) if (assembly.threads > 1)
    for (Index k = 0; k < n_chunks; ++k) {
        Part part;
        for (Index g = k * chunk; g < std::min(n, (k + 1) * chunk); ++g) {
            const double force = assembly.force[g].cwiseProduct(assembly.is_free[g]).norm();
            if (!(force <= part.largest)) { // also what is no number, and stays so
                part.largest = force;
                part.worst = g;
                if (!std::isfinite(force))
                    break;
            }
            double magnitudes = assembly.load[g].norm() + assembly.applied[g].norm();
            for (Index i = incidence.slot_start[g]; i < incidence.slot_start[g + 1]; ++i)
                magnitudes += assembly.slot_magnitudes[incidence.slot[i]];
            for (Index i = incidence.contact_start[g]; i < incidence.contact_start[g + 1]; ++i)
                magnitudes += assembly.contact_force[incidence.contact_side[i] / 2].norm();
            if (magnitudes > 0) {
                part.sum += magnitudes;
                ++part.n;
            }
        }
        parts[k] = part;
    }
    Part all;
    for (const Part& part : parts) {
        if (!std::isfinite(part.largest))
            return {part.largest, part.worst, 1};
        if (part.largest > all.largest) {
            all.largest = part.largest;
            all.worst = part.worst;
        }
        all.sum += part.sum;
        all.n += part.n;
    }
    return {all.largest, all.worst, all.n > 0 ? all.sum / all.n : 0.0};
}

Balance balance_of(const Assembly& assembly, double stiffest, double farthest, double tolerance)
{
    for (const Vector2d& u : assembly.displacement)
        farthest = std::max(farthest, u.norm());
    Balance balance = balance_of(assembly);
    balance.mean = std::max(balance.mean, 1e-15 * stiffest * farthest / tolerance);
    return balance;
}

double size_of(const Assembly& assembly)
{
    Vector2d low = assembly.position[0], high = low;
    for (const Vector2d& p : assembly.position) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    return (high - low).norm();
}

// The largest of n lengths, or the first that is no number.
template <class Length>
static std::pair<double, std::size_t> farthest_of(std::size_t n, const Length& length)
{
    std::pair<double, std::size_t> farthest(0, 0);
    for (std::size_t g = 0; g < n; ++g) {
        const double moved = length(g);
        if (!std::isfinite(moved))
            return {moved, g};
        farthest = std::max(farthest, {moved, g});
    }
    return farthest;
}

std::pair<double, std::size_t> farthest_move(const std::vector<Vector2d>& from,
                                             const std::vector<Vector2d>& to)
{
    return farthest_of(from.size(), [&](std::size_t g) { return (to[g] - from[g]).norm(); });
}

std::pair<double, std::size_t> farthest_displacement(const Assembly& assembly)
{
    return farthest_of(assembly.displacement.size(),
                       [&](std::size_t g) { return assembly.displacement[g].norm(); });
}

double work_of_loads(const Assembly& assembly, const std::vector<Vector2d>& start)
{
    double work = 0;
    for (std::size_t g = 0; g < start.size(); ++g)
        work += (assembly.load[g] + assembly.applied[g]).dot(assembly.displacement[g] - start[g]);
    return work;
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

void start_from_here(Assembly& assembly)
{
    find_forces(assembly);
    Contacts& contacts = assembly.contacts;
    for (std::size_t c = 0; c < contacts.gridpoint.size(); ++c) {
        // An open contact keeps its gap as the tension its spring would have.
        const double normal = joint::normal_traction(contacts.law[c], contacts.initial_traction[c].x(),
                                                     contacts.relative_displacement[c].x() -
                                                         contacts.offset[c].x() - contacts.state[c].dilation);
        contacts.initial_traction[c] = {normal, contacts.traction[c].y()};
        contacts.state[c].slip = contacts.state[c].dilation = 0;
        contacts.offset[c].setZero();
    }
    assembly.zones.initial_stress = assembly.zones.stress;
    for (YieldingZone& zone : assembly.zones.yielding) {
        zone.initial_zz = zone.stress_zz;
        zone.plastic.setZero();
    }
    assembly.displacement.assign(assembly.displacement.size(), Vector2d::Zero());
    find_forces(assembly);
}

namespace
{

// Each member of a State with its place in the assembly.
template <class OfState, class OfAssembly, class Copy>
void for_each_member(OfState& state, OfAssembly& assembly, const Copy& copy)
{
    copy(state.displacement, assembly.displacement);
    copy(state.offset, assembly.contacts.offset);
    copy(state.traction, assembly.contacts.traction);
    copy(state.relative_displacement, assembly.contacts.relative_displacement);
    copy(state.joint, assembly.contacts.state);
    copy(state.status, assembly.contacts.status);
    copy(state.stress, assembly.zones.stress);
    copy(state.yielding, assembly.zones.yielding);
}
static_assert(sizeof(State) == 8 * sizeof(std::vector<double>), "for_each_member() has all of them");

} // namespace

State state_of(const Assembly& assembly)
{
    State state;
    for_each_member(state, assembly, [](auto& kept, const auto& live) { kept = live; });
    return state;
}

void go_back(Assembly& assembly, const State& state)
{
    for_each_member(state, assembly, [](const auto& kept, auto& live) { live = kept; });
}

// What is not passed on is as in a new assembly, or found anew before it is used.
void transfer(const Transfer& to, Assembly& assembly, Checkpoint& kept)
{
    Zones& zones = assembly.zones;
    Contacts& contacts = assembly.contacts;
    to.values(assembly.displacement, kept.displacement);
    to.values(assembly.is_free_untied, kept.is_free);
    to.values(assembly.load, kept.load);
    if (to.restores())
        part_ties(assembly, kept.stage - 1);

    to.values(zones.is_present, kept.zone_present);
    to.values(zones.stress, kept.stress);
    to.values(zones.initial_stress, kept.initial_stress);
    to.values(zones.stiffness, kept.stiffness);
    to.values(zones.yielding, kept.plastic_strain, &YieldingZone::plastic);
    to.values(zones.yielding, kept.stress_zz, &YieldingZone::stress_zz);
    to.values(zones.yielding, kept.initial_zz, &YieldingZone::initial_zz);

    to.values(contacts.status, kept.contact_status);
    to.values(contacts.traction, kept.traction);
    to.values(contacts.initial_traction, kept.initial_traction);
    to.values(contacts.relative_displacement, kept.relative_displacement);
    to.values(contacts.offset, kept.offset);
    to.values(contacts.state, kept.slip, &joint::State::slip);
    to.values(contacts.state, kept.dilation, &joint::State::dilation);
    to.values(contacts.state, kept.is_broken, &joint::State::is_broken);
    const auto memory = [](std::size_t i) {
        return [i](joint::State& one) -> double& { return one.memory[i]; };
    };
    to.values(contacts.state, kept.first_memory, memory(0));
    to.values(contacts.state, kept.second_memory, memory(1));
    to.values(contacts.state, kept.third_memory, memory(2));
}

std::vector<double> stiffness_row_sums(const Assembly& assembly)
{
    const Zones& zones = assembly.zones;
    const Contacts& contacts = assembly.contacts;
    std::vector<Vector2d> sums(assembly.position.size(), Vector2d::Zero());
    for (std::size_t z = 0; z < zones.gridpoint.size(); ++z) {
        if (!zones.is_present[z])
            continue;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                sums[zones.gridpoint[z][i]] +=
                    zones.area[z] * stiffness_between(zones, z, i, j).cwiseAbs().rowwise().sum();
    }
    for (std::size_t c = 0; c < contacts.gridpoint.size(); ++c) {
        if (contacts.status[c] == ContactStatus::removed)
            continue;
        const Vector2d n = contacts.normal[c].cwiseAbs(), t(n.y(), n.x());
        const joint::Slopes law = joint::slopes(contacts.law[c], contacts.state[c], contacts.traction[c].x());
        const double k_n = (joint::is_linear(contacts.law[c]) ? 1 : room_to_stiffen) * law.k_n;
        const Vector2d row =
            2 * contacts.length[c] * (k_n * n * (n.x() + n.y()) + law.k_s * t * (t.x() + t.y()));
        for (const Index g : contacts.gridpoint[c])
            sums[g] += row;
    }
    for (const auto& [follower, leader] : assembly.tied)
        sums[leader] += sums[follower];
    std::vector<double> larger;
    for (const Vector2d& s : sums)
        larger.push_back(s.maxCoeff());
    return larger;
}

std::vector<double> lumped_masses(const Assembly& assembly)
{
    std::vector<double> mass(assembly.position.size(), 0.0);
    for (std::size_t z = 0; z < assembly.zones.gridpoint.size(); ++z)
        if (assembly.zones.is_present[z])
            for (const Index g : assembly.zones.gridpoint[z])
                mass[g] += assembly.zones.mass[z] / 3;
    for (const auto& [follower, leader] : assembly.tied)
        mass[leader] += mass[follower];
    return mass;
}

} // namespace jointcreep::mechanics
