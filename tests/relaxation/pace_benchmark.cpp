// pace_benchmark: how fast the dynamic engines go beside a bare loop of the same arithmetic.
//
//   pace_benchmark joints.h5 ZONE_SIZE_M [STEPS] [ROUNDS]
//
// The section after its first stage, whose load comes off at once, moves by so many steps (STEPS, default
// 200) with real masses and damping in proportion to them: by the engine (relaxation/relax.hpp), and by the
// plainest loop over flat arrays that does the same to the same mesh. Both must arrive at the same
// displacements, to rounding. A third way is the engine with its own masses and damping, scaled and adaptive,
// held to the same bare loop. The last two are the dynamic analysis with large displacements
// (large_displacements/dynamics.hpp), of rock that deforms and of rigid blocks, which finds out what touches
// what, and so is about other springs with a step of its own: that all of them come to the same bits on two
// threads is all that is asked. Prints CSV, a line for each way, on one thread and on two. `s_per_step` is
// the least of ROUNDS (default 5) runs [s], processor time on one thread and wall time on two; all ways take
// turns, so that what else goes on in the machine falls on all. What a run takes before its first steps is
// left out. `over_bare` is the pace over that of the bare loop on as many threads, the median over the
// rounds, and `gain` that on two threads over that on one.

#include "large_displacements/dynamics.hpp"
#include "mechanics/excavation.hpp"
#include "model/error.hpp"
#include "relaxation/relax.hpp"
#include "scene/scene.hpp"
#include "store/files.hpp"
#include "zoning/zone.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

using namespace jointcreep;
using mechanics::Assembly;
using mechanics::Vector2d;

namespace
{

constexpr double alpha = 20; // of damping [1/s]
constexpr int before = 20;   // steps that do not count

// Triangles, Coulomb contacts without dilation, gridpoints with damping in proportion to their mass.
struct Bare {
    int zones = 0, contacts = 0, gridpoints = 0;
    double dt = 0;                               // [s]
    std::vector<int> zone, contact;              // gridpoints [3 zones], [2 contacts]
    std::vector<double> slope, modulus, in_situ; // [6 zones], [3 zones], [3 zones]
    std::vector<double> area;                    // [zones]
    std::vector<double> normal, start;           // [2 contacts]
    std::vector<double> length, k_n, k_s, cohesion, friction, tensile, slip; // [contacts]
    std::vector<char> broken;
    std::vector<double> load, free, u, v;   // [2 gridpoints]
    std::vector<double> gain;               // of velocity by a force [gridpoints]
    std::vector<std::vector<double>> force; // of each thread [2 gridpoints]

    Bare(const Assembly& a, int threads)
    {
        gridpoints = static_cast<int>(a.position.size());
        for (std::size_t z = 0; z < a.zones.size(); ++z) {
            if (!a.zones.is_present[z])
                continue;
            for (int i = 0; i < 3; ++i) {
                zone.push_back(a.zones.gridpoints(z)[i]);
                slope.insert(slope.end(), a.zones.gradients(z)[i].begin(), a.zones.gradients(z)[i].end());
                modulus.push_back(a.zones.stiffness[z][i]);
                in_situ.push_back(a.zones.initial_stress[z][i]);
            }
            area.push_back(a.zones.area[z]);
            ++zones;
        }
        for (std::size_t c = 0; c < a.contacts.law.size(); ++c) {
            if (a.contacts.status[c] == ContactStatus::removed)
                continue;
            for (int i = 0; i < 2; ++i) {
                contact.push_back(a.contacts.gridpoint[c][i]);
                normal.push_back(a.contacts.normal[c][i]);
                start.push_back(a.contacts.initial_traction[c][i]);
            }
            const joint::Coulomb& law = std::get<joint::Coulomb>(a.contacts.law[c]);
            length.push_back(a.contacts.length[c]);
            k_n.push_back(law.k_n);
            k_s.push_back(law.k_s);
            cohesion.push_back(law.cohesion);
            friction.push_back(law.tan_phi);
            tensile.push_back(law.tensile_strength);
            slip.push_back(a.contacts.state[c].slip);
            broken.push_back(a.contacts.state[c].is_broken);
            ++contacts;
        }
        const std::vector<double> row_sums = stiffness_row_sums(a), mass = lumped_masses(a);
        double highest = 0; // frequency squared
        for (int g = 0; g < gridpoints; ++g)
            if (mass[g] > 0)
                highest = std::max(highest, row_sums[g] / mass[g]);
        dt = 0.9 * 2 / std::sqrt(highest);
        for (int g = 0; g < gridpoints; ++g) {
            for (int i = 0; i < 2; ++i) {
                load.push_back(a.load[g][i] + a.applied[g][i]);
                free.push_back(a.is_free[g][i]);
                u.push_back(a.displacement[g][i]);
            }
            gain.push_back(mass[g] > 0 ? dt / mass[g] / (1 + alpha * dt / 2) : 0.0);
        }
        v.assign(u.size(), 0.0);
        force.assign(threads, v);
    }

    void find_forces()
    {
        double* const f = force[omp_get_thread_num()].data();
#pragma omp for schedule(static) nowait
        for (int z = 0; z < zones; ++z) {
            const int* g = &zone[3 * z];
            const double *b = &slope[6 * z], *c = &modulus[3 * z], *s = &in_situ[3 * z];
            const double *p = &u[2 * g[0]], *q = &u[2 * g[1]], *r = &u[2 * g[2]];
            const double exx = b[0] * p[0] + b[2] * q[0] + b[4] * r[0];
            const double eyy = b[1] * p[1] + b[3] * q[1] + b[5] * r[1];
            const double gxy =
                b[1] * p[0] + b[0] * p[1] + b[3] * q[0] + b[2] * q[1] + b[5] * r[0] + b[4] * r[1];
            const double A = -area[z];
            const double sxx = A * (s[0] + c[0] * exx + c[1] * eyy),
                         syy = A * (s[1] + c[1] * exx + c[0] * eyy), sxy = A * (s[2] + c[2] * gxy);
            for (int i = 0; i < 3; ++i) {
                f[2 * g[i]] += sxx * b[2 * i] + sxy * b[2 * i + 1];
                f[2 * g[i] + 1] += sxy * b[2 * i] + syy * b[2 * i + 1];
            }
        }
#pragma omp for schedule(static)
        for (int k = 0; k < contacts; ++k) {
            const int a = 2 * contact[2 * k], b = 2 * contact[2 * k + 1];
            const double nx = normal[2 * k], ny = normal[2 * k + 1], dx = u[b] - u[a],
                         dy = u[b + 1] - u[a + 1];
            double sigma = start[2 * k] + k_n[k] * (nx * dx + ny * dy);
            const double trial = start[2 * k + 1] + k_s[k] * (ny * dx - nx * dy - slip[k]);
            if (sigma > (broken[k] ? 0.0 : tensile[k]))
                broken[k] = 1;
            const double limit = std::max(0.0, (broken[k] ? 0.0 : cohesion[k]) - sigma * friction[k]);
            double tau = trial;
            if (broken[k] && sigma > 0)
                sigma = tau = 0;
            else if (std::abs(trial) > limit)
                tau = std::copysign(limit, trial);
            if (tau != trial && k_s[k] > 0)
                slip[k] += (trial - tau) / k_s[k];
            const double x = length[k] * (sigma * nx + tau * ny), y = length[k] * (sigma * ny - tau * nx);
            f[a] += x;
            f[a + 1] += y;
            f[b] -= x;
            f[b + 1] -= y;
        }
    }

    void move(double share)
    {
        const double keep = (1 - alpha * dt / 2) / (1 + alpha * dt / 2);
        double* const own = force[0].data();
#pragma omp for schedule(static)
        for (int g = 0; g < gridpoints; ++g) {
            double x = load[2 * g] + own[2 * g], y = load[2 * g + 1] + own[2 * g + 1];
            own[2 * g] = own[2 * g + 1] = 0;
            for (std::size_t t = 1; t < force.size(); ++t) {
                x += force[t][2 * g];
                y += force[t][2 * g + 1];
                force[t][2 * g] = force[t][2 * g + 1] = 0;
            }
            v[2 * g] = keep * v[2 * g] + share * gain[g] * free[2 * g] * x;
            v[2 * g + 1] = keep * v[2 * g + 1] + share * gain[g] * free[2 * g + 1] * y;
            u[2 * g] += dt * v[2 * g];
            u[2 * g + 1] += dt * v[2 * g + 1];
        }
    }

    // From rest, so that the first step gets half a step's gain of velocity.
    void run(int steps, int threads)
    {
#pragma omp parallel num_threads(threads) if (threads > 1)
        for (int i = 0; i < steps; ++i) {
            find_forces();
            move(i == 0 ? 0.5 : 1.0);
        }
    }
};

// Processor time on one thread, wall time on more [s].
double seconds(int threads)
{
    timespec now{};
    clock_gettime(threads == 1 ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

enum class Kind { bare, relaxation, dynamics, rigid_dynamics };

struct Way {
    const char* name;
    Kind kind;
    Damping damping; // of the engine for small displacements
    int threads;
    std::vector<double> taken{}; // of each round [s a step]
    std::vector<Vector2d> u{};   // where it came to
};

// Moves a copy of the section by so many steps; returns what that took with all before it [s].
double run(const Assembly& section, const Mesh& mesh, Way& way, int steps)
{
    Assembly moving = section;
    moving.threads = way.threads;
    double start = 0, end = 0;
    if (way.kind == Kind::dynamics || way.kind == Kind::rigid_dynamics) {
        joint::Coulomb found = std::get<joint::Coulomb>(moving.contacts.law.at(0));
        found.cohesion = found.tensile_strength = 0;
        large_displacements::Dynamics dynamics(
            moving, mesh, std::vector<Index>(mesh.contact_edge.size(), 0),
            std::vector<char>(mesh.zone_gridpoint.size(), way.kind == Kind::rigid_dynamics ? 1 : 0), found,
            {.mass_damping = alpha});
        start = seconds(way.threads);
        for (int i = 0; i < steps; ++i)
            dynamics.step();
        end = seconds(way.threads);
        dynamics.put_back();
        way.u = moving.displacement;
    } else if (way.kind == Kind::relaxation) {
        Equilibrium settings{.tolerance = 1e-300, .damping = way.damping, .mass_damping = alpha};
        settings.masses = way.damping == Damping::mass ? Masses::real : Masses::scaled;
        settings.most_steps = steps;
        start = seconds(way.threads);
        try {
            relaxation::relax(moving, settings);
            throw std::runtime_error("the section rests, and should not");
        } catch (const equilibrium_error&) { // after so many steps
        }
        end = seconds(way.threads);
        way.u = moving.displacement;
    } else {
        Bare bare(moving, way.threads);
        start = seconds(way.threads);
        bare.run(steps, way.threads);
        end = seconds(way.threads);
        for (std::size_t g = 0; g < way.u.size(); ++g)
            way.u[g] = {bare.u[2 * g], bare.u[2 * g + 1]};
    }
    return end - start;
}

double median(std::vector<double> values)
{
    std::ranges::nth_element(values, values.begin() + static_cast<long>(values.size() / 2));
    return values[values.size() / 2];
}

// Of the rounds' ratios of the times a step took.
double median_ratio(const Way& slow, const Way& quick)
{
    std::vector<double> ratios;
    for (std::size_t i = 0; i < slow.taken.size(); ++i)
        ratios.push_back(slow.taken[i] / quick.taken[i]);
    return median(std::move(ratios));
}

void measure(const std::string& path, double zone_size, int steps, int rounds)
{
    const store::JointsFile file = store::read_joints(path);
    Scene scene = scene::parse_scene(file.provenance.scene, path + ": /scene");
    scene.zone_size = zone_size;
    const Mesh mesh = zoning::zone(scene, file.network.blocks);
    Assembly section = mechanics::assemble(scene, file.network, file.equivalent, mesh);
    if (!section.tied.empty())
        throw std::runtime_error("the bare loop knows no tied gridpoints; expected a section without");
    mechanics::excavate(section, file.network.blocks, mesh, mechanics::Loading(scene, mesh), 0);

    std::vector<Way> ways;
    for (const int threads : {1, 2}) {
        ways.push_back({"bare loop", Kind::bare, Damping::mass, threads});
        ways.push_back({"engine", Kind::relaxation, Damping::mass, threads});
        ways.push_back({"engine as by default", Kind::relaxation, Damping::adaptive, threads});
        ways.push_back({"dynamics, deformable", Kind::dynamics, Damping::mass, threads});
        ways.push_back({"dynamics, rigid", Kind::rigid_dynamics, Damping::mass, threads});
    }
    const std::size_t n = ways.size() / 2; // on each number of threads
    for (Way& way : ways)
        way.u = section.displacement;
    for (int round = 0; round < rounds; ++round)
        for (Way& way : ways) {
            const double start = run(section, mesh, way, before);
            way.taken.push_back((run(section, mesh, way, before + steps) - start) / steps);
        }

    double farthest = 0;
    for (const Vector2d& u : ways[0].u)
        farthest = std::max(farthest, u.norm());
    for (std::size_t i = 0; i < ways.size(); ++i) {
        const Way& alone = ways[i % n]; // the same on one thread
        if (ways[i].kind != Kind::bare && ways[i].u != alone.u)
            throw std::runtime_error(std::string(ways[i].name) + ": the bits are others on two threads");
        const bool is_dynamic = ways[i].kind == Kind::dynamics || ways[i].kind == Kind::rigid_dynamics;
        const Way& same = is_dynamic ? alone : ways[ways[i].damping == Damping::mass ? 0 : 2];
        const double apart = mechanics::largest_move(same.u, ways[i].u).first;
        if (!(apart <= 1e-9 * farthest))
            throw std::runtime_error(std::string(ways[i].name) + ", " + std::to_string(ways[i].threads) +
                                     " thread(s): arrives elsewhere than the " + same.name + ", by " +
                                     std::to_string(apart / farthest) + " of the farthest displacement");
    }
    const auto zones = std::ranges::count(section.zones.is_present, 1);
    std::cout << "way,threads,zones,contacts,s_per_step,zone_steps_per_s,over_bare,gain\n";
    for (std::size_t i = 0; i < ways.size(); ++i) {
        const double least = *std::ranges::min_element(ways[i].taken);
        std::cout << '"' << ways[i].name << "\"," << ways[i].threads << ',' << zones << ','
                  << section.contacts.law.size() << ',' << least << ',' << static_cast<double>(zones) / least
                  << ',' << median_ratio(ways[i / n * n], ways[i]) << ','
                  << median_ratio(ways[i % n], ways[i]) << '\n';
    }
}

} // namespace

int main(int argc, char** argv)
{
    try {
        if (argc < 3 || argc > 5)
            throw std::runtime_error("usage: pace_benchmark JOINTS.h5 ZONE_SIZE_M [STEPS] [ROUNDS]");
        measure(argv[1], std::stod(argv[2]), argc > 3 ? std::stoi(argv[3]) : 200,
                argc > 4 ? std::stoi(argv[4]) : 5);
    } catch (const std::exception& error) {
        std::cerr << "pace_benchmark: " << error.what() << '\n';
        return 1;
    }
}
