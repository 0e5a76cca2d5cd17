#include "mechanics/assembly.hpp"

#include "model/signs.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace jointcreep::mechanics
{

namespace
{

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
    assembly.zone_force.resize(n);
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
        if (joints.law[e] == static_cast<Index>(JointLaw::barton_bandis))
            contacts.law.push_back(joint::BartonBandis{joints.normal_stiffness[e], joints.shear_stiffness[e],
                                                       joints.largest_closure[e], joints.friction_angle[e],
                                                       joints.roughness[e], joints.wall_strength[e]});
        else
            contacts.law.push_back(joint::Coulomb{
                joints.normal_stiffness[e], joints.shear_stiffness[e], joints.cohesion[e],
                std::tan(joints.friction_angle[e]), joints.tensile_strength[e],
                std::tan(joints.dilation_angle[e]), joints.law[e] == static_cast<Index>(JointLaw::residual),
                joints.residual_cohesion[e], std::tan(joints.residual_friction_angle[e])});
        const Vector3d stress = scene.in_situ_stress.at(mesh.contact_centre[c]);
        const Vector2d normal = mesh.contact_normal[c], tangent = along(normal);
        const Vector2d pull(stress[0] * normal.x() + stress[2] * normal.y(),
                            stress[2] * normal.x() + stress[1] * normal.y());
        contacts.initial_traction.emplace_back(pull.dot(normal), pull.dot(tangent));
    }
    contacts.state.resize(n);
    contacts.offset.assign(n, Vector2d::Zero());
    contacts.traction = contacts.initial_traction;
    contacts.jump.assign(n, Vector2d::Zero());
    contacts.status.assign(n, ContactStatus::stuck);
    contacts.dissipated.assign(n, 0.0);
    assembly.contact_force.resize(n);
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
        assembly.is_free.emplace_back((held & 1) != 0 ? 0.0 : 1.0, (held & 2) != 0 ? 0.0 : 1.0);
    add_zones(assembly, scene, network, mesh);
    add_contacts(assembly, scene, equivalent, mesh);
    list_by_gridpoint(assembly.zones.gridpoint, n, assembly.incidence.zone_start,
                      assembly.incidence.zone_corner);
    list_by_gridpoint(assembly.contacts.gridpoint, n, assembly.incidence.contact_start,
                      assembly.incidence.contact_side);
    for (std::size_t z = 0; z < assembly.zones.gridpoint.size(); ++z)
        for (const Index g : assembly.zones.gridpoint[z])
            assembly.load[g].y() -= assembly.zones.weight[z] / 3;
    for (std::size_t t = 0; t < mesh.tie_stage.size(); ++t)
        assembly.ties.push_back({mesh.tie_gridpoint[t], mesh.tie_stage[t]});
    part_ties(assembly, -1);
    return assembly;
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
    for (const auto& [follower, first] : assembly.tied)
        assembly.is_free[first] = assembly.is_free[first].cwiseMin(assembly.is_free[follower]);
}

void find_forces(Assembly& assembly)
{
    for (const auto& [follower, leader] : assembly.tied)
        assembly.displacement[follower] = assembly.displacement[leader];
    Zones& zones = assembly.zones;
    Contacts& contacts = assembly.contacts;
    const auto n_zones = static_cast<Index>(zones.gridpoint.size());
    const auto n_contacts = static_cast<Index>(contacts.gridpoint.size());
    const auto n_gridpoints = static_cast<Index>(assembly.position.size());
    const Incidence& incidence = assembly.incidence;
    const std::vector<Vector2d>& u = assembly.displacement;
    const double damping = assembly.stiffness_damping_rate;
    const bool any_yields = !zones.yielding.empty();

#pragma omp parallel num_threads(assembly.threads) if (assembly.threads > 1)
    {
#pragma omp for schedule(static) nowait
        for (Index z = 0; z < n_zones; ++z) {
            if (!zones.is_present[z])
                continue;
            const auto& g = zones.gridpoint[z];
            const auto& gradient = zones.gradient[z];
            double exx = 0, eyy = 0, gxy = 0;
            for (int i = 0; i < 3; ++i) {
                const Vector2d& ui = u[g[i]];
                exx += gradient[i].x() * ui.x();
                eyy += gradient[i].y() * ui.y();
                gxy += gradient[i].y() * ui.x() + gradient[i].x() * ui.y();
            }
            const Vector3d& c = zones.stiffness[z];
            Vector3d stress = zones.initial_stress[z] +
                              Vector3d(c[0] * exx + c[1] * eyy, c[1] * exx + c[0] * eyy, c[2] * gxy);
            if (any_yields && zones.yielding_number[z] >= 0)
                stress = stress_of_yielding(zones, z, {exx, eyy, gxy});
            zones.stress[z] = stress;
            Vector3d acting = stress;
            if (damping > 0) {
                acting += damping * (stress - zones.last_stress[z]);
                zones.last_stress[z] = stress;
            }
            for (int i = 0; i < 3; ++i)
                assembly.zone_force[z][i] =
                    -zones.area[z] * Vector2d(acting[0] * gradient[i].x() + acting[2] * gradient[i].y(),
                                              acting[2] * gradient[i].x() + acting[1] * gradient[i].y());
        }
#pragma omp for schedule(static)
        for (Index c = 0; c < n_contacts; ++c) {
            if (contacts.status[c] == ContactStatus::removed)
                continue;
            const auto [a, b] = contacts.gridpoint[c];
            const Vector2d normal = contacts.normal[c], tangent = along(normal);
            const Vector2d jump = u[b] - u[a];
            const joint::Law& law = contacts.law[c];
            const Vector2d last_jump = contacts.jump[c], last = contacts.traction[c];
            contacts.jump[c] = {jump.dot(normal), jump.dot(tangent)};
            const Vector2d sprung = contacts.jump[c] - contacts.offset[c];
            const joint::Response response =
                joint::respond(law, contacts.state[c], contacts.initial_traction[c].x(),
                               contacts.initial_traction[c].y(), sprung.x(), sprung.y());
            const Vector2d traction(response.sigma_n, response.tau);
            contacts.traction[c] = traction;
            contacts.status[c] = response.status;
            const double length = contacts.length[c];
            contacts.dissipated[c] += length * (last + traction).dot(contacts.jump[c] - last_jump) / 2 -
                                      (stored_in(law, traction, length) - stored_in(law, last, length));
            Vector2d acting = traction;
            if (damping > 0 && response.status == ContactStatus::stuck)
                acting += damping * (traction - last); // dashpots; none where it slips or is open
            assembly.contact_force[c] = length * (acting.x() * normal + acting.y() * tangent);
        }
#pragma omp for schedule(static)
        for (Index g = 0; g < n_gridpoints; ++g) {
            Vector2d force = assembly.load[g] + assembly.applied[g];
            for (Index k = incidence.zone_start[g]; k < incidence.zone_start[g + 1]; ++k) {
                const Index corner = incidence.zone_corner[k];
                force += assembly.zone_force[corner / 3][corner % 3];
            }
            for (Index k = incidence.contact_start[g]; k < incidence.contact_start[g + 1]; ++k) {
                const Index side = incidence.contact_side[k];
                if (side % 2 == 0)
                    force += assembly.contact_force[side / 2];
                else
                    force -= assembly.contact_force[side / 2];
            }
            assembly.force[g] = force;
        }
    }
    for (const auto& [follower, leader] : assembly.tied) {
        assembly.force[leader] += assembly.force[follower];
        assembly.force[follower].setZero();
    }
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

double dissipated_energy(const Assembly& assembly)
{
    double sum = 0;
    for (const double lost : assembly.contacts.dissipated)
        sum += lost;
    for (std::size_t z = 0; z < assembly.zones.yielding_number.size(); ++z)
        if (assembly.zones.yielding_number[z] >= 0)
            sum += assembly.zones.area[z] *
                   assembly.zones.yielding[assembly.zones.yielding_number[z]].dissipated;
    return sum;
}

void forget_dissipated_energy(Assembly& assembly)
{
    std::fill(assembly.contacts.dissipated.begin(), assembly.contacts.dissipated.end(), 0.0);
    for (YieldingZone& zone : assembly.zones.yielding)
        zone.dissipated = 0;
}

double stored_energy(const Assembly& assembly)
{
    const Zones& zones = assembly.zones;
    const Contacts& contacts = assembly.contacts;
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
    for (std::size_t k = 0; k < contacts.gridpoint.size(); ++k)
        if (contacts.status[k] != ContactStatus::removed)
            energy += stored_in(contacts.law[k], contacts.traction[k], contacts.length[k]);
    return energy;
}

Balance balance_of(const Assembly& assembly)
{
    const Incidence& incidence = assembly.incidence;
    Balance balance{0, 0, 0};
    double sum = 0;
    Index n = 0;
    for (std::size_t g = 0; g < assembly.position.size(); ++g) {
        const double force = assembly.force[g].cwiseProduct(assembly.is_free[g]).norm();
        if (!std::isfinite(force))
            return {force, static_cast<Index>(g), 1};
        if (force > balance.largest) {
            balance.largest = force;
            balance.worst = static_cast<Index>(g);
        }
        double magnitudes = assembly.load[g].norm() + assembly.applied[g].norm();
        for (Index k = incidence.zone_start[g]; k < incidence.zone_start[g + 1]; ++k) {
            const Index corner = incidence.zone_corner[k];
            magnitudes += assembly.zone_force[corner / 3][corner % 3].norm();
        }
        for (Index k = incidence.contact_start[g]; k < incidence.contact_start[g + 1]; ++k)
            magnitudes += assembly.contact_force[incidence.contact_side[k] / 2].norm();
        if (magnitudes > 0) {
            sum += magnitudes;
            ++n;
        }
    }
    balance.mean = n > 0 ? sum / n : 0.0;
    return balance;
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

std::pair<double, std::size_t> farthest_move(const std::vector<Vector2d>& from,
                                             const std::vector<Vector2d>& to)
{
    std::pair<double, std::size_t> farthest(0, 0);
    for (std::size_t g = 0; g < from.size(); ++g) {
        const double moved = (to[g] - from[g]).norm();
        if (!std::isfinite(moved))
            return {moved, g};
        farthest = std::max(farthest, {moved, g});
    }
    return farthest;
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
                                                     contacts.jump[c].x() - contacts.offset[c].x() -
                                                         contacts.state[c].dilation);
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

State state_of(const Assembly& assembly)
{
    const Contacts& contacts = assembly.contacts;
    return {assembly.displacement, contacts.offset, contacts.traction,     contacts.jump,
            contacts.state,        contacts.status, assembly.zones.stress, assembly.zones.yielding};
}

void go_back(Assembly& assembly, const State& state)
{
    Contacts& contacts = assembly.contacts;
    assembly.displacement = state.displacement;
    contacts.offset = state.offset;
    contacts.traction = state.traction;
    contacts.jump = state.jump;
    contacts.state = state.joint;
    contacts.status = state.status;
    assembly.zones.stress = state.stress;
    assembly.zones.yielding = state.yielding;
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
