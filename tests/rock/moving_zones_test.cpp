// Zones at large displacements: forces that are the slope of their energy, whatever turns them, and energies that close.

#include "rock/finite_strain.hpp"
#include "rock/moving_zones.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numbers>

namespace moving_zones_test
{

using namespace jointcreep;
using namespace jointcreep::rock;

namespace
{

double any_number(double low, double high)
{
    return low + (high - low) * *rc::gen::resize(rc::kNominalSize, rc::gen::inRange(0, 1001)) / 1000;
}

Matrix2d turn(double angle)
{
    return (Matrix2d() << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle)).finished();
}

// Symmetric, near to no stretch.
Matrix2d any_stretch(double most)
{
    const double shear = any_number(-most, most);
    return (Matrix2d() << 1 + any_number(-most, most), shear, shear, 1 + any_number(-most, most)).finished();
}

constexpr double youngs_modulus = 1e10;

// One zone with the in-situ stress {xx, yy, xy} [Pa].
struct One {
    Zones zones;
    MovingZones moving;
    std::vector<Vector2d> place{{0, 0}, {3, 0.5}, {1, 2}};

    explicit One(const Vector3d& in_situ, double cohesion = 0)
    {
        Mesh mesh;
        mesh.gridpoint = place;
        mesh.zone_gridpoint = {{0, 1, 2}};
        mesh.zone_block = {0};
        Scene scene;
        scene.gravity = 9.81;
        scene.in_situ_stress = {
            .compression_xx = -in_situ[0], .compression_yy = -in_situ[1], .shear_xy = in_situ[2]};
        Rock rock{.name = "rock",
                  .density = 2700,
                  .youngs_modulus = youngs_modulus,
                  .poissons_ratio = 0.25,
                  .strength = {}};
        if (cohesion > 0) {
            rock.strength = {.cohesion = cohesion, .friction_angle = 0.5, .tensile_strength = cohesion};
            rock.dilation_angle = 0.1;
            rock.law = RockLaw::mohr_coulomb;
        }
        scene.rocks = {rock};
        Network network;
        network.blocks.block_rock = {0};
        zones = zones_of(scene, network, mesh);
        moving = moving_zones_of(zones, place);
        moving.corner_force.assign(3, Vector2d::Zero());
    }

    // Energies of one step to these places.
    ZoneSums move_to(const std::vector<Vector2d>& to, double viscosity = 0)
    {
        place = to;
        ZoneSums sums;
        find_force(zones, moving, 0, place, viscosity, sums);
        return sums;
    }
    std::vector<Vector2d> places_by(const Matrix2d& gradient) const
    {
        std::vector<Vector2d> all;
        for (const Vector2d& p : place)
            all.emplace_back(gradient * p + Vector2d(5, -7));
        return all;
    }
    Vector3d stress()
    {
        put_back(moving, 0, place, zones);
        return zones.stress[0];
    }
};

Vector3d any_stress(double most)
{
    return {any_number(-most, most), any_number(-most, most), any_number(-most, most)};
}

} // namespace

// F = R U with R a rotation and U symmetric.
RC_GTEST_PROP(moving_zones, polar_decomposition_is_one, ())
{
    const Matrix2d rotation = turn(any_number(-std::numbers::pi, std::numbers::pi)),
                   stretch = any_stretch(0.4);
    const One one({0, 0, 0});
    const Polar polar =
        polar_of({0, 1, 2}, one.places_by(rotation * stretch), edges_of({0, 1, 2}, one.place).inverse());
    RC_ASSERT((polar.rotation() - rotation).norm() < 1e-12);
    RC_ASSERT((polar.stretch() - stretch).norm() < 1e-12);
}

// W U + U W = U T - T U, and W is skew.
RC_GTEST_PROP(moving_zones, skew_part_keeps_stress_symmetric, ())
{
    const Matrix2d stretch = any_stretch(0.4), stress = tensor(any_stress(1e7)),
                   w = skew_part(stretch, stress);
    RC_ASSERT((w + w.transpose()).norm() == 0);
    RC_ASSERT((w * stretch + stretch * w - (stretch * stress - stress * stretch)).norm() < 1e-7);
}

// At the start it has the in-situ stress; turned, the same stress turned with it, and no more energy.
RC_GTEST_PROP(moving_zones, turned_only_keep_their_stress, ())
{
    const Vector3d in_situ = any_stress(5e7);
    One one(in_situ);
    const double at_start = one.move_to(one.place).stored;
    RC_ASSERT((one.stress() - in_situ).norm() < 1e-8 * 5e7);
    const Matrix2d rotation = turn(any_number(-std::numbers::pi, std::numbers::pi)),
                   wanted = rotation * tensor(in_situ) * rotation.transpose();
    RC_ASSERT(std::abs(one.move_to(one.places_by(rotation)).stored - at_start) <= 1e-9 * std::abs(at_start));
    RC_ASSERT((tensor(one.stress()) - wanted).norm() < 1e-8 * 5e7);
}

// At the start its forces are those of the zone at small strain: -area times stress times the gradient.
RC_GTEST_PROP(moving_zones, start_with_the_forces_at_small_strain, ())
{
    const Vector3d in_situ = any_stress(5e7);
    One one(in_situ);
    one.move_to(one.place);
    for (int corner = 0; corner < 3; ++corner) {
        const Vector2d wanted = -one.zones.area[0] * tensor(in_situ) * one.zones.gradients(0)[corner];
        RC_ASSERT((one.moving.corner_force[corner] - wanted).norm() < 1e-8 * 5e7);
    }
}

// A step of a strain e against dashpots: they begin with no stress and end with `viscosity` C e, and take the mean of it.
// Another such step takes all of it.
TEST(moving_zones, dashpots_take_the_mean_of_their_stress)
{
    One one({0, 0, 0});
    one.move_to(one.place);
    const std::vector<Vector2d> start = one.place;
    constexpr double e = 1e-4, viscosity = 2;
    const auto strained = [&](double strain) {
        std::vector<Vector2d> all = start;
        for (Vector2d& p : all)
            p.x() *= 1 + strain;
        return all;
    };
    const double all = one.zones.area[0] * viscosity * one.zones.stiffness[0][0] * e * e;
    EXPECT_NEAR(one.move_to(strained(e), viscosity).damped, all / 2, 1e-9 * all);
    EXPECT_NEAR(one.move_to(strained(2 * e), viscosity).damped, all, 1e-9 * all);
    EXPECT_NEAR(one.move_to(strained(2 * e), viscosity).damped, 0, 1e-9 * all);
}

// Forces on the corners are the slope of the stored energy; they have no resultant and no moment.
RC_GTEST_PROP(moving_zones, forces_are_the_slope_of_stored_energy, ())
{
    One one(any_stress(5e7));
    const std::vector<Vector2d> at =
        one.places_by(turn(any_number(-std::numbers::pi, std::numbers::pi)) * any_stretch(0.2));
    one.move_to(at);
    const std::vector<Vector2d> force = one.moving.corner_force;
    constexpr double h = 1e-5;
    for (int corner = 0; corner < 3; ++corner)
        for (int i = 0; i < 2; ++i) {
            std::vector<Vector2d> more = at, less = at;
            more[corner][i] += h;
            less[corner][i] -= h;
            const double slope = (one.move_to(more).stored - one.move_to(less).stored) / (2 * h);
            RC_ASSERT(std::abs(force[corner][i] + slope) < 1e-6 * youngs_modulus);
        }
    double moment = 0;
    for (int corner = 0; corner < 3; ++corner)
        moment += at[corner].x() * force[corner].y() - at[corner].y() * force[corner].x();
    RC_ASSERT((force[0] + force[1] + force[2]).norm() < 1e-6 * youngs_modulus / 1e6);
    RC_ASSERT(std::abs(moment) < 1e-9 * youngs_modulus);
}

// Along any path: work done on the corners = stored + lost by yielding + damped. The stress stays within the strength.
RC_GTEST_PROP(moving_zones, account_for_their_work, ())
{
    const bool yields = *rc::gen::inRange(0, 2) == 1;
    const double viscosity = any_number(0, 1) * (yields ? 0 : 3); // of yielding rock dashpots act by stress
    One one({-2e6, -3e6, 1e5}, yields ? 2e6 : 0);
    double stored = one.move_to(one.place).stored, lost = 0, work = 0, exchanged = 0; // to and fro
    const double at_start = stored;
    const Matrix2d end = turn(any_number(-1, 1)) * any_stretch(2e-3);
    const std::vector<Vector2d> from = one.place, to = one.places_by(end);
    constexpr int steps = 4000;
    std::vector<Vector2d> force = one.moving.corner_force, at = from;
    for (int step = 1; step <= steps; ++step) {
        std::vector<Vector2d> next = from;
        const Matrix2d now = turn(std::atan2(end(1, 0), end(0, 0)) * step / steps) *
                             (Matrix2d::Identity() +
                              static_cast<double>(step) / steps *
                                  (turn(-std::atan2(end(1, 0), end(0, 0))) * end - Matrix2d::Identity()));
        for (int corner = 0; corner < 3; ++corner)
            next[corner] = now * from[corner];
        const ZoneSums sums = one.move_to(next, viscosity);
        for (int corner = 0; corner < 3; ++corner) {
            const double done =
                -(force[corner] + one.moving.corner_force[corner]).dot(next[corner] - at[corner]) / 2;
            work += done;
            exchanged += std::abs(done);
        }
        force = one.moving.corner_force;
        at = next;
        stored = sums.stored;
        lost += sums.friction + sums.damped;
        RC_ASSERT(sums.friction >= 0);
    }
    RC_ASSERT(std::abs(work - (stored - at_start) - lost) <= 2e-3 * exchanged);
    if (!yields)
        return;
    put_back(one.moving, 0, one.place, one.zones);
    const Vector3d& s = one.zones.stress[0];
    RC_CLASSIFY(lost > 1e-3 * exchanged, "yields");
    RC_ASSERT(excess(one.zones.yielding[0].law, {s[0], s[1], s[2], one.zones.yielding[0].stress_zz}) <
              2e-2 * 2e6);
}

// Strained by more than half it is said to be torn.
TEST(moving_zones, that_are_torn_are_named)
{
    One one({-2e6, -3e6, 0}, 2e6);
    EXPECT_EQ(one.move_to(one.places_by(Eigen::Vector2d(1.4, 1).asDiagonal())).torn, -1);
    One torn({-2e6, -3e6, 0}, 2e6);
    EXPECT_EQ(torn.move_to(torn.places_by(Eigen::Vector2d(1.6, 1).asDiagonal())).torn, 0);
}

} // namespace moving_zones_test
