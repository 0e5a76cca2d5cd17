// A joint whose dilation wears off, along paths worked out by hand, and along any path.

#include "joint/law.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

namespace wearing_dilation_test
{

using namespace jointcreep;
using namespace jointcreep::joint;

namespace
{

WearingDilation rough(double wear)
{
    return {{.k_n = 4e9,
             .k_s = 1e9,
             .cohesion = 2e5,
             .tan_phi = std::tan(0.6),
             .tensile_strength = 0,
             .tan_psi = std::tan(0.2)},
            wear};
}

// What slip opens in all under the constant shear traction tau.
double opened(const WearingDilation& law, double slip, double tau)
{
    return law.tan_psi / (law.wear * tau) * (1 - std::exp(-law.wear * tau * slip));
}

} // namespace

// Slip that wears hardly anything: on both sides of the wear from which the formula is a series, opening is that of the other.
TEST(wearing_dilation, opens_by_a_series_where_little_wears)
{
    const DilationThatWears<double> dilation{0.2, 2e-4, 0};
    for (const double worn : {1e-12, 2e-9, 9.9e-9, 1.1e-8, 1e-7}) {
        const double slip = 1e-6, tau = worn / (dilation.wear * slip);
        const double wanted = 0.2 * slip * (1 - worn / 2 + worn * worn / 6);
        EXPECT_NEAR(dilation.opening_by(slip, tau) / wanted, 1, 1e-15);
    }
}

// Slip by 3 mm, back by 5, and on by 4, under a pressure of 1 MPa: the joint opens by what the formula says, so
// that the pressure stays as it is.
TEST(wearing_dilation, opens_less_and_less_under_a_constant_pressure)
{
    const WearingDilation law = rough(2e-4);
    const double tau = 2e5 + 1e6 * law.tan_phi, elastic = tau / law.k_s;
    State state;
    double slip = 0, work = 0;
    for (const auto& [by, to] :
         {std::pair{3e-3, 3e-3 + elastic}, {5e-3, -2e-3 - elastic}, {4e-3, 2e-3 + elastic}}) {
        slip += by;
        work += tau * by;
        const double rises = opened(law, slip, tau);
        for (int again = 0; again < 2; ++again) {
            const Response now = respond(law, state, -1e6, 0, rises, to);
            EXPECT_NEAR(now.sigma_n, -1e6, 1e-3);
            EXPECT_NEAR(now.tau, to > 0 ? tau : -tau, 1e-3);
            EXPECT_EQ(now.status, ContactStatus::slipping);
            EXPECT_NEAR(state.dilation, rises, 1e-14);
            EXPECT_NEAR(state.memory[0], work, 1e-6 * work);
        }
    }
    EXPECT_LT(state.dilation, 0.8 * law.tan_psi * slip);
    EXPECT_LT(state.dilation, law.tan_psi / (law.wear * tau)); // however far it slips
}

// Held so that it cannot open it is pressed more and more, up to a limit: beside the equations integrated by a
// million small steps.
TEST(wearing_dilation, held_it_follows_its_equations)
{
    const WearingDilation law = rough(5e-4);
    const double end = 8e-3;
    double slip = 0, dilation = 0, work = 0, tau = 0;
    constexpr int steps = 1000000;
    for (int i = 1; i <= steps; ++i) {
        const double trial = law.k_s * (end * i / steps - slip), p = 1e6 + law.k_n * dilation;
        tau = std::min(trial, law.cohesion + p * law.tan_phi);
        const double by = (trial - tau) / law.k_s;
        slip += by;
        dilation += law.tan_psi * std::exp(-law.wear * work) * by;
        work += tau * by;
    }
    // Backward Euler: of the first order.
    std::vector<double> errors;
    for (const int parts : {100, 200, 400}) {
        State state;
        Response now{};
        for (int i = 1; i <= parts; ++i)
            now = respond(law, state, -1e6, 0, 0, end * i / parts);
        errors.push_back(std::max(std::abs(now.tau / tau - 1), std::abs(state.dilation / dilation - 1)));
    }
    EXPECT_LT(errors.front(), 0.01);
    EXPECT_NEAR(errors[0] / errors[1], 2, 0.1);
    EXPECT_NEAR(errors[1] / errors[2], 2, 0.1);
}

// Without wear it is Coulomb's joint.
RC_GTEST_PROP(wearing_dilation, without_wear_it_is_coulombs, ())
{
    const WearingDilation law = rough(1e-30);
    const Coulomb& coulomb = law;
    State worn, plain;
    for (int i = 0; i < 5; ++i) {
        const double u_n = 2e-4 * (*rc::gen::inRange(-1000, 500)) / 1000.0,
                     u_s = 5e-3 * (*rc::gen::inRange(-1000, 1001)) / 1000.0;
        const Response one = respond(law, worn, -1e6, 0, u_n, u_s),
                       other = respond(coulomb, plain, -1e6, 0, u_n, u_s);
        RC_ASSERT(one.status == other.status);
        RC_ASSERT(std::abs(one.tau - other.tau) < 1);
        RC_ASSERT(std::abs(one.sigma_n - other.sigma_n) < 1);
    }
}

// For any path: never beyond its strength, never closing by slip, never more open than without wear, and the same
// when asked twice.
RC_GTEST_PROP(wearing_dilation, any_path_is_within_its_bounds, ())
{
    const WearingDilation law = rough(1e-5 * (*rc::gen::inRange(1, 1001)));
    State state;
    double slipped = 0;
    for (int i = 0; i < 20; ++i) {
        const State before = state;
        const double u_n = 1e-3 * (*rc::gen::inRange(-1000, 1001)) / 1000.0,
                     u_s = 1e-2 * (*rc::gen::inRange(-1000, 1001)) / 1000.0;
        const Response now = respond(law, state, -1e6, 0, u_n, u_s);
        const double cohesion = law.cohesion_of(state.is_broken);
        RC_ASSERT(std::abs(now.tau) <=
                  std::max(0.0, cohesion - now.sigma_n * law.tan_phi) * (1 + 1e-9) + 1e-3);
        RC_ASSERT(now.sigma_n <= (state.is_broken ? 0.0 : law.tensile_strength));
        RC_ASSERT(state.dilation >= before.dilation);
        RC_ASSERT(state.memory[0] >= before.memory[0]);
        slipped += std::abs(state.slip - before.slip);
        RC_ASSERT(state.dilation <= law.tan_psi * slipped * (1 + 1e-12));
        const State kept = state;
        const Response again = respond(law, state, -1e6, 0, u_n, u_s);
        RC_ASSERT(std::abs(again.tau - now.tau) < 1);
        RC_ASSERT(std::abs(again.sigma_n - now.sigma_n) < 1);
        RC_ASSERT(std::abs(state.dilation - kept.dilation) < 1e-12);
    }
}

} // namespace wearing_dilation_test
