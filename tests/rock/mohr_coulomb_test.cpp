// Rock that yields: strengths by hand, what holds for any return to them, and a path of loading and
// unloading.

#include "rock/mohr_coulomb.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <numbers>

namespace mohr_coulomb_test
{

using namespace jointcreep::rock;
using Eigen::Vector3d, Eigen::Vector4d;

namespace
{

constexpr double deg = std::numbers::pi / 180;
const double E = 1e10, nu = 0.25;
const Elasticity elasticity{E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)), E* nu / ((1 + nu) * (1 - 2 * nu)),
                            E / (2 * (1 + nu))};

Vector3d stress_of(const Vector3d& strain)
{
    return (elasticity[0] - elasticity[1]) * strain + Vector3d::Constant(elasticity[1] * strain.sum());
}

double number(double least, double most)
{
    return least + (most - least) * (*rc::gen::inRange(0, 100001)) / 1e5;
}

// Principal stresses within the strength.
Vector3d admissible(const MohrCoulomb& law)
{
    for (;;) {
        Vector3d s(number(-5e7, law.tension), number(-5e7, law.tension), number(-5e7, law.tension));
        if (!(law.n_phi * s.maxCoeff() - s.minCoeff() > law.shear))
            return s;
    }
}

} // namespace

TEST(mohr_coulomb, strength_by_hand)
{
    const MohrCoulomb law = MohrCoulomb::of(1e6, 30 * deg, 2e5, 0); // N = 3, 2 c sqrt(N) = 3.4641 MPa
    EXPECT_NEAR(law.n_phi, 3, 1e-12);
    EXPECT_NEAR(law.shear, 3.4641016e6, 1);
    EXPECT_EQ(law.excess(-1e6, -6.46e6), 0);
    EXPECT_NEAR(law.excess(-1e6, -6.5e6), 6.5e6 - 6.4641016e6, 1);
    EXPECT_NEAR(law.excess(2.5e5, 0), 5e4, 1);
    EXPECT_NEAR(MohrCoulomb::of(1e6, 30 * deg, 1e9, 0).tension, 1e6 / std::tan(30 * deg), 1); // its apex
}

// It ends within the strength, by elasticity from the plastic strain; and with the dilation angle of the
// friction no stress within the strength would have taken more work (von Mises), which singles that answer
// out.
RC_GTEST_PROP(mohr_coulomb, returns_to_the_strength_with_the_most_work, ())
{
    const double phi = number(0, 50) * deg;
    const bool associated = *rc::gen::arbitrary<bool>();
    const MohrCoulomb law =
        MohrCoulomb::of(number(0, 3e6), phi, number(0, 2e6), associated ? phi : number(0, 1) * phi);
    Vector3d trial(number(-5e7, 3e7), number(-5e7, 3e7), number(-5e7, 3e7));
    const int alike = *rc::gen::inRange(0, 4); // edges and corners are no accident
    if (alike == 1 || alike == 3)
        trial[1] = trial[0];
    if (alike == 2 || alike == 3)
        trial[2] = trial[1];
    std::sort(trial.data(), trial.data() + 3, std::greater<>());
    RC_PRE(law.excess(trial[0], trial[2]) > 0);
    const Returned found = returned(law, elasticity, trial);
    const double scale = 1e-9 * 5e7;
    RC_ASSERT(((trial - stress_of(found.plastic)) - found.stress).cwiseAbs().maxCoeff() < scale);
    RC_ASSERT(found.stress.maxCoeff() - law.tension < scale);
    RC_ASSERT(law.n_phi * found.stress.maxCoeff() - found.stress.minCoeff() - law.shear < scale);
    RC_ASSERT(found.stress.dot(found.plastic) > -scale * found.plastic.norm());
    if (associated)
        for (int i = 0; i < 20; ++i)
            RC_ASSERT((found.stress - admissible(law)).dot(found.plastic) > -scale * found.plastic.norm());
}

// Squeezed along a turned axis between smooth walls: yield by hand in the plane of loading, the axis kept,
// the flow that of the dilation angle; unloaded it is elastic; asked twice nothing more happens.
TEST(mohr_coulomb, squeezed_along_any_axis_and_unloaded)
{
    for (const double angle : {0.0, 20 * deg, 75 * deg}) {
        const double psi = 10 * deg;
        YieldingZone zone{.law = MohrCoulomb::of(1e6, 30 * deg, 2e5, psi), .initial_zz = -2e6};
        const Vector3d initial(-2e6, -2e6, 0);
        const auto strained = [&](double e) { // along the axis, and across by as much the other way
            const double cos2 = std::cos(2 * angle), sin2 = std::sin(2 * angle);
            return Vector3d(e * cos2, -e * cos2, 2 * e * sin2);
        };
        Vector3d s = initial;
        for (int i = 1; i <= 50; ++i)
            s = yielded(zone, elasticity, initial, s, strained(-1e-4 * i));
        const Vector3d p = principal({s[0], s[1], s[2], zone.stress_zz});
        EXPECT_NEAR(3 * p[0] - p[1], zone.law.shear, 1) << angle;
        EXPECT_GT(p[0], zone.stress_zz);
        EXPECT_GT(zone.stress_zz, p[1]);
        EXPECT_NEAR(std::tan(2 * angle) * (s[0] - s[1]) / 2, s[2], 1) << angle;
        const double volume = zone.plastic[0] + zone.plastic[1],
                     shear = std::hypot(zone.plastic[0] - zone.plastic[1], zone.plastic[3]);
        EXPECT_NEAR(volume / shear, std::sin(psi), 1e-9);
        EXPECT_EQ(zone.plastic[2], 0);
        EXPECT_GT(zone.dissipated, 0);

        const YieldingZone before = zone;
        EXPECT_NEAR((yielded(zone, elasticity, initial, s, strained(-5e-3)) - s).norm(), 0, 1e-3);
        EXPECT_EQ(zone.plastic, before.plastic);
        EXPECT_EQ(zone.dissipated, before.dissipated);
        const Vector3d back = yielded(zone, elasticity, initial, s, strained(-4.9e-3));
        EXPECT_EQ(zone.plastic, before.plastic);
        EXPECT_NEAR((back - s -
                     1e-4 * elasticity[2] * 2 *
                         Vector3d(std::cos(2 * angle), -std::cos(2 * angle), std::sin(2 * angle)))
                        .norm(),
                    0, 1);
    }
}

// Of a zone with some plastic strain, on any plane, edge or corner; where the tangent changes within the step of the
// differences there is none to compare.
RC_GTEST_PROP(mohr_coulomb, tangent_is_what_differences_give, ())
{
    const double phi = number(0, 45) * deg;
    const MohrCoulomb law = MohrCoulomb::of(number(1e5, 1e7), phi, number(0, 1e6), number(0, 1) * phi);
    const Vector3d initial = admissible(law);
    YieldingZone zone{.law = law, .initial_zz = (initial[0] + initial[1]) / 2};
    zone.plastic = {number(-1e-3, 1e-3), number(-1e-3, 1e-3), number(-1e-3, 1e-3), number(-1e-3, 1e-3)};
    const Vector3d strain(number(-5e-3, 5e-3), number(-5e-3, 5e-3), number(-5e-3, 5e-3));
    const auto stress_at = [&](const Vector3d& at) {
        YieldingZone copy = zone;
        return yielded(copy, elasticity, initial, initial, at);
    };
    const auto differences = [&](double step) {
        Eigen::Matrix3d all;
        for (int i = 0; i < 3; ++i) {
            const Vector3d by = step * Vector3d::Unit(i);
            all.col(i) = (stress_at(strain + by) - stress_at(strain - by)) / (2 * step);
        }
        return all;
    };
    const Eigen::Matrix3d coarse = differences(2e-8), fine = differences(1e-8);
    RC_PRE((coarse - fine).norm() < 1e-5 * elasticity[0]);
    RC_ASSERT((tangent_of_yield(zone, elasticity, initial, strain) - fine).norm() < 1e-4 * elasticity[0]);
}

// Work = stored + dissipated, along a path of strain that turns round, in many small steps. Where the stress across the section is the
// largest compression, rock yields across it, too.
TEST(mohr_coulomb, energy)
{
    for (const double initial_zz : {-1e6, -7e6}) {
        YieldingZone zone{.law = MohrCoulomb::of(1e6, 35 * deg, 3e5, 12 * deg), .initial_zz = initial_zz};
        zone.stress_zz = initial_zz;
        const Vector3d initial(-1e6, -1.5e6, 2e5);
        Vector3d s = initial, e(0, 0, 0);
        double work = 0;
        const double at_start = stored(elasticity, initial, initial_zz);
        const int n = 4000;
        for (int i = 1; i <= n; ++i) {
            const double t = 2 * std::numbers::pi * i / n;
            const Vector3d next(-1e-3 * std::sin(t), -2e-3 * (1 - std::cos(t)), 1e-3 * std::sin(3 * t));
            const Vector3d now = yielded(zone, elasticity, initial, s, next);
            work += (s + now).dot(next - e) / 2;
            s = now;
            e = next;
        }
        EXPECT_GT(zone.dissipated, 1e3);
        EXPECT_EQ(std::abs(zone.plastic[2]) > 1e-5, initial_zz < -5e6) << zone.plastic[2];
        EXPECT_NEAR(work, stored(elasticity, s, zone.stress_zz) - at_start + zone.dissipated,
                    1e-9 * zone.dissipated);
    }
}

} // namespace mohr_coulomb_test
