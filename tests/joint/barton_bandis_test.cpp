// Barton and Bandis's joint against its formulas, worked out by hand, and against their integral and
// derivative.

#include "joint/barton_bandis.hpp"

#include <gtest/gtest.h>

namespace barton_bandis_test
{

using namespace jointcreep;
using namespace jointcreep::joint;

namespace
{

constexpr double deg = std::numbers::pi / 180;

// k_ni V_m is 2 MPa.
const BartonBandis law{.k_n = 1e10,
                       .k_s = 1e9,
                       .largest_closure = 2e-4,
                       .residual_angle = 30 * deg,
                       .roughness = 10,
                       .wall_strength = 1e8};

} // namespace

TEST(barton_bandis, closes_along_a_hyperbola)
{
    EXPECT_NEAR(law.pressure(1e-4), 2e6, 1e-6);
    EXPECT_NEAR(law.pressure(1.5e-4), 6e6, 1e-6);
    EXPECT_NEAR(law.stiffness(2e6), 4e10, 1e-3);
    EXPECT_NEAR(law.closure(1e8), 2e-4 * 100 / 102, 1e-15);
    // Crushed, it goes straight on: at 51 squared times k_ni.
    EXPECT_NEAR(law.pressure(2e-4 * 100 / 102 + 1e-6), 1e8 + 2601e10 * 1e-6, 1);
    for (const double p : {-3e5, 0.0, 1e3, 1e6, 3e7, 9.9e7, 2e8})
        EXPECT_NEAR(law.pressure(law.closure(p)), p, 1e-9 * std::abs(p));
}

TEST(barton_bandis, friction_falls_with_pressure)
{
    EXPECT_NEAR(law.friction_angle(1e6), 50 * deg, 1e-12); // two decades below JCS
    EXPECT_NEAR(law.friction_angle(1e3), 70 * deg, 1e-12); // 80 would be too steep
    EXPECT_NEAR(law.friction_angle(1e8), 30 * deg, 1e-12);
    EXPECT_NEAR(law.friction_angle(5e8), 30 * deg, 1e-12);
    EXPECT_NEAR(law.strength(1e6), 1e6 * 1.1917535925942, 1);
    EXPECT_EQ(law.strength(0), 0);
}

TEST(barton_bandis, slope_and_energy_are_those_of_the_curves)
{
    for (const double p : {1e3, 1e5, 1e6, 4e7, 2e8}) {
        const double h = 1e-4 * p;
        EXPECT_NEAR(law.friction(p), (law.strength(p + h) - law.strength(p - h)) / (2 * h), 1e-6) << p;
        EXPECT_NEAR(law.stiffness(p) * (law.closure(p + h) - law.closure(p - h)) / (2 * h), 1, 1e-6) << p;
        double work = 0; // midpoint rule
        const int n = 20000;
        for (int i = 0; i < n; ++i)
            work += law.pressure((i + 0.5) / n * law.closure(p)) * law.closure(p) / n;
        EXPECT_NEAR(law.stored(p) / work, 1, 1e-4) << p;
    }
}

TEST(barton_bandis, responds)
{
    State state;
    // Closed by 0.1 mm under 2 MPa, by half of that more; 44.2 degrees there.
    const double limit = 6e6 * std::tan((30 + 10 * std::log10(100. / 6)) * deg);
    const Response stuck = respond(law, state, -2e6, 0, -0.5e-4, 0.9 * limit / 1e9);
    EXPECT_NEAR(stuck.sigma_n, -6e6, 1e-3);
    EXPECT_NEAR(stuck.tau, 0.9 * limit, 1e-3);
    EXPECT_EQ(stuck.status, ContactStatus::stuck);
    for (int again = 0; again < 2; ++again) {
        const Response slips = respond(law, state, -2e6, 0, -0.5e-4, -1e-2);
        EXPECT_EQ(slips.status, ContactStatus::slipping);
        EXPECT_NEAR(slips.tau, -limit, 1e-3);
        EXPECT_NEAR(state.slip, -1e-2 + limit / 1e9, 1e-12);
    }
    // Unloaded along the same curve, opened, and closed again without shear.
    EXPECT_NEAR(respond(law, state, -2e6, 0, 0, -1e-2).sigma_n, -2e6, 1e-6);
    EXPECT_EQ(respond(law, state, -2e6, 0, 1.01e-4, 0.5).status, ContactStatus::open);
    const Response closed = respond(law, state, -2e6, 0, -0.5e-4, 0.5);
    EXPECT_NEAR(closed.sigma_n, -6e6, 1e-3);
    EXPECT_NEAR(closed.tau, 0, 1e-6);
    // Open in situ by 0.03 mm, which counts as k_n times that.
    State gaping;
    EXPECT_EQ(respond(law, gaping, 3e5, 0, -2.9e-5, 0).status, ContactStatus::open);
    EXPECT_NEAR(respond(law, gaping, 3e5, 0, -1.3e-4, 0).sigma_n, -2e6, 1e-3);
}

} // namespace barton_bandis_test
