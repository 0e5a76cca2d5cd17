#include "mechanics/assembly.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>

namespace jointcreep::mechanics
{

namespace
{

// Directions that are parallel within this angle are the same [rad].
constexpr double same_direction = 1e-6;

std::vector<Assembly::Roller> rollers_of(const Scene& scene, const Mesh& mesh)
{
    std::vector<Assembly::Roller> rollers;
    for (std::size_t s = 0; s < mesh.side_zone.size(); ++s) {
        const Boundary& boundary = scene.boundaries[mesh.side_boundary[s]];
        if (!boundary.fix_normal)
            continue;
        const Vector2d along = (boundary.to - boundary.from).normalized();
        const auto stress_point = static_cast<std::size_t>(mesh.side_zone[s]) * mesh.stress_points_of_zone();
        for (const Index g : mesh.side_gridpoint[s])
            rollers.push_back({g, along, stress_point});
        if (mesh.is_quadratic())
            rollers.push_back({mesh.side_middle[s], along, stress_point});
    }
    return rollers;
}

// What rollers under rock leave free. `leader_of`: a gridpoint's leader by ties, or itself.
template <class Leader>
void put_on_rollers(Assembly& assembly, const Leader& leader_of)
{
    assembly.along.clear();
    if (assembly.rollers.empty())
        return;
    assembly.along.assign(assembly.position.size(), Vector2d::Zero());
    for (const auto& [gridpoint, along, stress_point] : assembly.rollers) {
        if (!assembly.zones.is_present[stress_point])
            continue;
        const Index g = leader_of(gridpoint);
        Vector2d &here = assembly.along[g], &is_free = assembly.is_free[g];
        if (along.x() == 0)
            is_free.x() = 0;
        else if (along.y() == 0)
            is_free.y() = 0;
        else if (here.isZero(0))
            here = along;
        else if (std::abs(here.x() * along.y() - here.y() * along.x()) > same_direction)
            is_free.setZero();
    }
    for (std::size_t g = 0; g < assembly.along.size(); ++g)
        if (!assembly.along[g].isZero(0) && assembly.is_free[g].minCoeff() == 0) {
            assembly.is_free[g].setZero();
            assembly.along[g].setZero();
        }
    for (const auto& [follower, leader] : assembly.tied)
        assembly.along[follower] = assembly.along[leader];
}

// The order is the same for any number of threads.
void add_up_forces(Assembly& assembly)
{
    const auto n = static_cast<Index>(assembly.position.size());
    const Index n_chunks = chunks_of(assembly);
#pragma omp for schedule(static) nowait
    for (Index k = 0; k < n_chunks; ++k)
        for (Index g = k * chunk; g < std::min(n, (k + 1) * chunk); ++g) {
            Vector2d force = assembly.load[g] + assembly.applied[g];
            for_each_force([&](const auto& one) { add_force_on(one, g, force); }, assembly);
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
    for (const Index fixed : mesh.gridpoint_fixed)
        assembly.is_free_untied.emplace_back((fixed & 1) != 0 ? 0.0 : 1.0, (fixed & 2) != 0 ? 0.0 : 1.0);
    assembly.rollers = rollers_of(scene, mesh);
    assembly.zones = rock::zones_of(scene, network, mesh);
    assembly.contacts = joint::contacts_of(scene, equivalent, mesh);
    find_incidence(assembly);
    for (std::size_t z = 0; z < assembly.zones.size(); ++z)
        rock::add_weight(assembly.zones, z, 1, assembly.load);
    for (std::size_t t = 0; t < mesh.tie_stage.size(); ++t)
        assembly.ties.push_back({mesh.tie_gridpoint[t], mesh.tie_stage[t]});
    part_ties(assembly, -1);
    return assembly;
}

void find_incidence(Assembly& assembly)
{
    for_each_force([&](auto& one) { find_incidence(one, assembly.position.size()); }, assembly);
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
    put_on_rollers(assembly, root);
}

void give_forces_to_leaders(const Assembly& assembly, std::vector<Vector2d>& force)
{
    for (const auto& [follower, leader] : assembly.tied) {
        force[leader] += force[follower];
        force[follower].setZero();
    }
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
    const double damping = assembly.stiffness_damping_rate;
    for_each_force([&](auto& one) { find_forces_in_team(one, assembly.displacement, damping, forces_alone); },
                   assembly);
#pragma omp barrier
    add_up_forces(assembly);
    if (!assembly.tied.empty()) {
#pragma omp barrier
#pragma omp single
        give_forces_to_leaders(assembly, assembly.force);
    }
}

Index chunks_of(const Assembly& assembly)
{
    return (static_cast<Index>(assembly.position.size()) + chunk - 1) / chunk;
}

double stored_energy(const Assembly& assembly)
{
    double energy = 0;
    for_each_force([&](const auto& one) { energy += stored_energy(one); }, assembly);
    return energy;
}

Balance balance_of(const Assembly& assembly)
{
    struct OfChunk {
        double largest = 0, sum = 0;
        Index worst = 0, n = 0;
    };
    const auto n = static_cast<Index>(assembly.position.size());
    const Index n_chunks = chunks_of(assembly);
    std::vector<OfChunk> chunks(n_chunks);
#pragma omp parallel for schedule(static) num_threads(assembly.threads) if (assembly.threads > 1)
    for (Index k = 0; k < n_chunks; ++k) {
        OfChunk here;
        for (Index g = k * chunk; g < std::min(n, (k + 1) * chunk); ++g) {
            const double force = free_part(assembly, g, assembly.force[g]).norm();
            if (!(force <= here.largest)) { // also what is no number, and stays so
                here.largest = force;
                here.worst = g;
                if (!std::isfinite(force))
                    break;
            }
            double magnitudes = assembly.load[g].norm() + assembly.applied[g].norm();
            for_each_force([&](const auto& one) { add_magnitudes_on(one, g, magnitudes); }, assembly);
            if (magnitudes > 0) {
                here.sum += magnitudes;
                ++here.n;
            }
        }
        chunks[k] = here;
    }
    OfChunk all;
    for (const OfChunk& one : chunks) {
        if (!std::isfinite(one.largest))
            return {one.largest, one.worst, 1};
        if (one.largest > all.largest) {
            all.largest = one.largest;
            all.worst = one.worst;
        }
        all.sum += one.sum;
        all.n += one.n;
    }
    return {all.largest, all.worst, all.n > 0 ? all.sum / all.n : 0.0};
}

Balance balance_of(const Assembly& assembly, double stiffest, double largest, double tolerance)
{
    for (const Vector2d& u : assembly.displacement)
        largest = std::max(largest, u.norm());
    Balance balance = balance_of(assembly);
    balance.mean = std::max(balance.mean, 1e-15 * stiffest * largest / tolerance);
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
static std::pair<double, std::size_t> largest_of(std::size_t n, const Length& length)
{
    std::pair<double, std::size_t> largest(0, 0);
    for (std::size_t g = 0; g < n; ++g) {
        const double moved = length(g);
        if (!std::isfinite(moved))
            return {moved, g};
        largest = std::max(largest, {moved, g});
    }
    return largest;
}

std::pair<double, std::size_t> largest_move(const std::vector<Vector2d>& from,
                                            const std::vector<Vector2d>& to)
{
    return largest_of(from.size(), [&](std::size_t g) { return (to[g] - from[g]).norm(); });
}

std::pair<double, std::size_t> largest_displacement(const Assembly& assembly)
{
    return largest_of(assembly.displacement.size(),
                      [&](std::size_t g) { return assembly.displacement[g].norm(); });
}

double work_of_loads(const Assembly& assembly, const std::vector<Vector2d>& start)
{
    double work = 0;
    for (std::size_t g = 0; g < start.size(); ++g)
        work += (assembly.load[g] + assembly.applied[g]).dot(assembly.displacement[g] - start[g]);
    return work;
}

void start_from_here(Assembly& assembly)
{
    find_forces(assembly);
    for_each_force([](auto& one) { start_from_here(one); }, assembly);
    assembly.displacement.assign(assembly.displacement.size(), Vector2d::Zero());
    find_forces(assembly);
}

bool yields(const Assembly& assembly)
{
    bool any = false;
    for_each_force([&](const auto& one) { any = any || yields(one); }, assembly);
    return any;
}

double returned_energy(const Assembly& assembly, const State& start)
{
    double energy = 0;
    for_each_force([&](const auto& one, const auto& its_start) { energy += returned_energy(one, its_start); },
                   assembly, start);
    return energy;
}

void begin_search(Assembly& assembly, bool damps_stiffness)
{
    for_each_force([&](auto& one) { begin_search(one, damps_stiffness); }, assembly);
}

double dissipated(const Assembly& assembly)
{
    double energy = 0;
    for_each_force([&](const auto& one) { energy += dissipated(one); }, assembly);
    return energy;
}

double dissipated(const Assembly& assembly, const State& start)
{
    double energy = 0;
    for_each_force([&](const auto& one, const auto& its_start) { energy += dissipated(one, its_start); },
                   assembly, start);
    return energy;
}

State state_of(const Assembly& assembly)
{
    State state;
    state.displacement = assembly.displacement;
    state.force = assembly.force;
    for_each_force([](const auto& one, auto& its_state) { its_state = state_of(one); }, assembly, state);
    return state;
}

void go_back(Assembly& assembly, const State& state)
{
    assembly.displacement = state.displacement;
    assembly.force = state.force;
    for_each_force([](auto& one, const auto& its_state) { go_back(one, its_state); }, assembly, state);
}

// What is not passed on is as in a new assembly, or found anew before it is used.
void transfer(const Transfer& to, Assembly& assembly, Checkpoint& kept)
{
    to.values(assembly.displacement, kept.displacement);
    to.values(assembly.is_free_untied, kept.is_free);
    to.values(assembly.load, kept.load);
    to.values(assembly.force, kept.force);
    for_each_force([&](auto& one) { transfer(to, one, kept); }, assembly);
    if (to.restores())
        part_ties(assembly, kept.unloaded > 0 ? kept.stage : kept.stage - 1);
}

void pass(Tape& tape, Assembly& assembly)
{
    tape(assembly.displacement, assembly.force);
    for_each_force([&](auto& one) { pass(tape, one); }, assembly);
}

void record_state(const Assembly& assembly, States& states)
{
    for_each_force([&](const auto& one) { record_state(one, states); }, assembly);
}

Stiffening stiffening_of(const Assembly& assembly)
{
    Stiffening all;
    for_each_force(
        [&](const auto& force, auto& of_force) { of_force = stiffening_of(force, assembly.displacement); },
        assembly, all);
    return all;
}

bool has_any(const Stiffening& stiffening)
{
    bool any = false;
    for_each_force([&](const auto& of_force) { any = any || !of_force.empty(); }, stiffening);
    return any;
}

bool are_beyond(const Assembly& assembly, const Stiffening& stiffening)
{
    bool any = false;
    for_each_force(
        [&](const auto& force, const auto& of_force) {
            any = any || are_beyond(force, assembly.displacement, of_force);
        },
        assembly, stiffening);
    return any;
}

void pass(Tape& tape, Stiffening& stiffening)
{
    for_each_force([&](auto& of_force) { pass(tape, of_force); }, stiffening);
}

std::vector<double> stiffness_row_sums(const Assembly& assembly)
{
    std::vector<Vector2d> sums(assembly.position.size(), Vector2d::Zero());
    for_each_force([&](const auto& one) { add_row_sums(one, assembly.displacement, sums); }, assembly);
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
    rock::add_masses(assembly.zones, mass);
    for (const auto& [follower, leader] : assembly.tied)
        mass[leader] += mass[follower];
    return mass;
}

} // namespace jointcreep::mechanics
