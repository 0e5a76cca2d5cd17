// Creep of rock, in one zone.

#include "joints.hpp"

#include <gtest/gtest.h>

namespace rock_test
{

using namespace jointcreep;
using namespace jointcreep::test;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace
{

constexpr double E = 3e10, nu = .25, G = E / (2 * (1 + nu)), B = E / (3 * (1 - 2 * nu));
constexpr double G_k = 8e9, eta_k = 5e10, eta_m = 4e11;

// A triangle whose strain {xx, yy, gamma} is that of its corners, its stress held or its strain.
struct Zone {
    Scene scene;
    Network network;
    Mesh mesh;
    mechanics::Assembly rock;
    Vector3d strain{0, 0, 0};

    Zone(CreepScheme scheme, bool kelvin, bool maxwell, const Vector3d& in_situ = {-1e6, -3e6, 2e5})
    {
        scene = creeping(scheme);
        scene.rocks = {{"rock", 2700, E, nu, {}}};
        if (kelvin)
            scene.rocks[0].kelvin = ShearKelvin{G_k, eta_k};
        if (maxwell)
            scene.rocks[0].maxwell_viscosity = eta_m;
        network.blocks.block_rock = {0};
        mesh.zone_block = {0};
        rock.position = {{0, 0}, {1, 0}, {0, 1}};
        rock.displacement.assign(3, {0, 0});
        rock.load = rock.applied = rock.force = rock.displacement;
        rock.is_free.assign(3, {1, 1});
        rock.zones.gridpoint = {0, 1, 2};
        rock.zones.area = {.5};
        find_incidence(rock);
        rock.zones.gradient = {Vector2d(-1, -1), Vector2d(1, 0), Vector2d(0, 1)};
        rock.zones.stiffness = {{B + G * 4 / 3, B - G * 2 / 3, G}};
        rock.zones.initial_stress = rock.zones.stress = {in_situ};
        rock.zones.is_present = {1};
    }

    mechanics::Creep creep() const { return {scene, network, {}, mesh, rock}; }

    void deform(const Vector3d& to)
    {
        strain = to;
        rock.displacement = {{0, 0}, {to[0], to[2]}, {0, to[1]}};
        find_forces(rock);
    }
    // Deforms it until it has the stress.
    void load(const Vector3d& stress)
    {
        const Vector3d& c = rock.zones.stiffness[0];
        Eigen::Matrix3d C;
        C << c[0], c[1], 0, c[1], c[0], 0, 0, 0, c[2];
        deform(C.inverse() * (stress - rock.zones.initial_stress[0]));
    }
    Vector3d stress() const { return rock.zones.stress[0]; }
};

// The first part of the strain under a constant axial stress s (yy) beside free sides in plane strain,
//     eyy = s (1 / (4 G) + 3 / (4 (3 B + G))) ,
// with 1 / G + (1 - exp(-t G_k / eta)) / G_k for 1 / G; the second part goes from that with G to that with
// G_inf = G G_k / (G + G_k) at the rate (3 B (G + G_k) + G G_k) / ((3 B + G) eta). By Laplace transform of
// the elastic solution.
double axial_strain(double s, double t)
{
    const double G_inf = G * G_k / (G + G_k);
    const double rate = (3 * B * (G + G_k) + G * G_k) / ((3 * B + G) * eta_k);
    const double at_first = 1 / (3 * B + G), at_last = 1 / (3 * B + G_inf);
    return s / 4 * (1 / G - std::expm1(-t * G_k / eta_k) / G_k) +
           s * 3 / 4 * (at_last + (at_first - at_last) * std::exp(-rate * t));
}

double error_of_axial_strain(CreepScheme scheme, int steps)
{
    Zone zone(scheme, true, false);
    const Vector3d in_situ = zone.stress(), loaded = in_situ + Vector3d(0, -2e6, 0);
    mechanics::Creep creep = zone.creep();
    zone.load(loaded);
    EXPECT_NEAR(zone.strain[1], axial_strain(-2e6, 0), 1e-15);
    double largest = 0;
    const double T = 20;
    for (int i = 1; i <= steps; ++i) {
        creep.begin(T / steps, zone.rock);
        zone.load(loaded);
        creep.end(zone.rock);
        largest = std::max(largest, std::abs(zone.strain[1] - axial_strain(-2e6, T * i / steps)));
    }
    return largest / std::abs(axial_strain(-2e6, T));
}

} // namespace

TEST(rock, axial_load_in_plane_strain)
{
    EXPECT_LT(error_of_axial_strain(CreepScheme::fitted, 10), 2e-3);
    for (const auto& [scheme, order] : {std::pair(CreepScheme::published, 1),
                                        {CreepScheme::backward, 1},
                                        {CreepScheme::linear_force, 2},
                                        {CreepScheme::fitted, 2}})
        EXPECT_NEAR(std::log2(error_of_axial_strain(scheme, 80) / error_of_axial_strain(scheme, 160)), order,
                    .1);
}

// Deviatoric stress 2 G_inf e + 2 (G - G_inf) e exp(-t (G + G_k) / eta), mean stress as it was: by the fitted
// scheme exactly, whatever the step.
TEST(rock, held_strain_relaxes_in_shear_alone)
{
    const Vector3d strain(1e-5, -4e-5, 3e-5);
    Zone zone(CreepScheme::fitted, true, false);
    const Vector3d in_situ = zone.stress();
    mechanics::Creep creep = zone.creep();
    zone.deform(strain);
    const double volume = strain[0] + strain[1];
    const Vector3d e(strain[0] - volume / 3, strain[1] - volume / 3, strain[2] / 2);
    const Vector3d mean(B * volume, B * volume, 0);
    double t = 0;
    for (const double step : {.1, 1.0, 10.0, 3.0}) {
        creep.begin(step, zone.rock);
        zone.deform(strain);
        creep.end(zone.rock);
        t += step;
        const double G_inf = G * G_k / (G + G_k);
        const double G_t = G_inf + (G - G_inf) * std::exp(-t * (G + G_k) / eta_k);
        EXPECT_LT((zone.stress() - in_situ - mean - 2 * G_t * e).norm(), 1e-9 * G * e.norm());
    }
}

TEST(rock, a_maxwell_dashpot_relaxes_all_shear)
{
    const Vector3d strain(0, 0, 3e-5);
    Zone zone(CreepScheme::fitted, false, true);
    const Vector3d in_situ = zone.stress();
    mechanics::Creep creep = zone.creep();
    zone.deform(strain);
    creep.begin(7, zone.rock);
    zone.deform(strain);
    creep.end(zone.rock);
    EXPECT_NEAR(zone.stress()[2] - in_situ[2], G * 3e-5 * std::exp(-7 * G / eta_m), 1e-9 * G * 3e-5);
}

TEST(rock, ends_a_step_as_it_was_found)
{
    for (const CreepScheme scheme : all_schemes) {
        Zone zone(scheme, true, true);
        const Vector3d stiffness = zone.rock.zones.stiffness[0];
        mechanics::Creep creep = zone.creep();
        for (int i = 0; i < 3; ++i) {
            creep.begin(3 + i, zone.rock);
            zone.deform({1e-5 * i, -3e-5, 2e-5});
            const Vector3d stress = zone.stress();
            creep.end(zone.rock);
            find_forces(zone.rock);
            EXPECT_LT((zone.stress() - stress).norm(), 1e-12 * stress.norm());
            EXPECT_LT((zone.rock.zones.stiffness[0] - stiffness).norm(), 1e-14 * stiffness.norm());
        }
    }
}

TEST(rock, in_situ_stress_does_not_creep_and_removed_rock_neither)
{
    Zone zone(CreepScheme::fitted, true, true);
    mechanics::Creep creep = zone.creep();
    EXPECT_TRUE(creep.anything_creeps());
    const Vector3d in_situ = zone.stress();
    creep.begin(1e4, zone.rock);
    zone.deform({0, 0, 0});
    EXPECT_LT(creep.end(zone.rock), 1e-16);
    EXPECT_LT((zone.stress() - in_situ).norm(), 1e-9);
    zone.rock.zones.is_present[0] = 0;
    zone.rock.zones.stress[0] = {1e6, 0, 0};
    creep.begin(10, zone.rock);
    EXPECT_EQ(creep.end(zone.rock), 0);
}

// The error over the size of a zone.
TEST(rock, the_error_estimate_is_of_the_size_of_the_error)
{
    const Vector3d strain(0, 0, 3e-5);
    Zone zone(CreepScheme::backward, true, false);
    mechanics::Creep creep = zone.creep();
    zone.deform(strain);
    const double step = .01 * eta_k / (G + G_k);
    creep.begin(step, zone.rock);
    zone.deform(strain);
    const double estimate = creep.end(zone.rock);
    const double G_inf = G * G_k / (G + G_k);
    const double exact = (G_inf + (G - G_inf) * std::exp(-.01)) * 3e-5 + 2e5;
    // Creep strain {0, 0, xy}: its magnitude is sqrt(2) xy; stress error = 2 G times that of xy.
    const double error = std::abs(zone.stress()[2] - exact) / (2 * G) * std::sqrt(2.0);
    EXPECT_NEAR(estimate / error, 1, .05);
}

} // namespace rock_test
