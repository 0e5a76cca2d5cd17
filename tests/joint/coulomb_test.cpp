// The joint law against its own definition, on paths worked out by hand.

#include "joint/law.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace coulomb_test
{

using namespace jointcreep;
using namespace jointcreep::joint;

namespace
{

const Coulomb law{.k_n = 1e9, .k_s = 5e8, .cohesion = 1e5, .tan_phi = 0.5, .tensile_strength = 5e4};

} // namespace

TEST(coulomb, springs_within_its_strength)
{
    State state;
    const Response r = respond(law, state, -1e6, 2e5, -1e-4, 3e-4);
    EXPECT_DOUBLE_EQ(r.sigma_n, -1e6 - 1e5);
    EXPECT_DOUBLE_EQ(r.tau, 2e5 + 1.5e5);
    EXPECT_EQ(r.status, ContactStatus::stuck);
    EXPECT_EQ(state.slip, 0);
}

TEST(coulomb, slips_at_cohesion_plus_friction_and_unloads_elastically)
{
    State state;
    const double limit = 1e5 + 1e6 * 0.5;
    const Response r = respond(law, state, -1e6, 0, 0, 2e-3);
    EXPECT_DOUBLE_EQ(r.tau, limit);
    EXPECT_EQ(r.status, ContactStatus::slipping);
    EXPECT_NEAR(state.slip, 2e-3 - limit / law.k_s, 1e-15);
    const Response back = respond(law, state, -1e6, 0, 0, 1.9e-3);
    EXPECT_NEAR(back.tau, limit - 1e-4 * law.k_s, 1e-6);
    EXPECT_EQ(back.status, ContactStatus::stuck);
}

TEST(coulomb, opening_breaks_the_bond_for_good)
{
    State state;
    EXPECT_EQ(respond(law, state, 0, 0, 4e-5, 0).status, ContactStatus::stuck); // 40 kPa of tension
    const Response open = respond(law, state, 0, 0, 6e-5, 1e-3);
    EXPECT_EQ(open.status, ContactStatus::open);
    EXPECT_EQ(open.sigma_n, 0);
    EXPECT_EQ(open.tau, 0);
    EXPECT_EQ(respond(law, state, 0, 0, 4e-5, 1e-3).status, ContactStatus::open); // no tension any more
    const Response closed = respond(law, state, 0, 0, -1e-3, 1e-3);
    EXPECT_DOUBLE_EQ(closed.sigma_n, -1e6);
    EXPECT_NEAR(closed.tau, 0, 1e-6); // closes without shear
    const Response slipping = respond(law, state, 0, 0, -1e-3, 1e-2);
    EXPECT_DOUBLE_EQ(slipping.tau, 5e5); // no cohesion any more
}

TEST(coulomb, a_smooth_joint_without_shear_stiffness)
{
    Coulomb smooth = law;
    smooth.k_s = 0;
    State state;
    const Response r = respond(smooth, state, -1e6, 0, 0, 1);
    EXPECT_EQ(r.tau, 0);
    EXPECT_EQ(r.status, ContactStatus::stuck);
}

// Slip of 4 mm along a joint that is held apart: k_n tan(psi) slip of normal stress comes to it, and tan(phi)
// times that of shear stress.
TEST(coulomb, dilates_by_slip)
{
    Coulomb dilatant = law;
    dilatant.tan_psi = 0.1;
    State state;
    const double start = 6e5, slip = 4e-3; // cohesion and friction
    const double sigma_n = -1e6 - 1e9 * 0.1 * slip, tau = start + 1e9 * 0.1 * slip * 0.5;
    const Response r = respond(dilatant, state, -1e6, 0, 0, slip + tau / 5e8);
    EXPECT_EQ(r.status, ContactStatus::slipping);
    EXPECT_NEAR(state.slip, slip, 1e-15);
    EXPECT_NEAR(state.dilation, 0.1 * slip, 1e-16);
    EXPECT_NEAR(r.sigma_n, sigma_n, 1e-6);
    EXPECT_NEAR(r.tau, tau, 1e-6);
    // Unloaded it keeps that; on the way back it does not come together again, but rises further.
    const double unloaded = respond(dilatant, state, -1e6, 0, 0, slip).tau;
    EXPECT_NEAR(unloaded, 0, 1e-6);
    EXPECT_NEAR(state.dilation, 0.1 * slip, 1e-16);
    respond(dilatant, state, -1e6, 0, 0, 0);
    EXPECT_LT(state.slip, 0.9 * slip);
    EXPECT_NEAR(state.dilation, 0.1 * (slip + slip - state.slip), 1e-12);
}

TEST(coulomb, dilates_the_same_in_one_step_and_in_many_one_way)
{
    Coulomb dilatant = law;
    dilatant.tan_psi = 0.2;
    State once, often;
    const Response r = respond(dilatant, once, -1e6, 0, 1e-4, 1e-2);
    Response last{};
    for (int i = 1; i <= 1000; ++i)
        last = respond(dilatant, often, -1e6, 0, 1e-7 * i, 1e-5 * i);
    EXPECT_NEAR(last.tau, r.tau, 1e-5 * std::abs(r.tau));
    EXPECT_NEAR(often.dilation, once.dilation, 1e-5 * once.dilation);
}

// At a slip of 1 mm dilation ends: held apart, the joint is pressed by 1e9 0.1 1e-3 Pa more, and no farther.
TEST(coulomb, dilation_ends)
{
    Coulomb dilatant = law;
    dilatant.tan_psi = 0.1;
    dilatant.dilation_until = 1e-3;
    const double sigma_n = -1e6 - 1e9 * 1e-4, tau = 1e5 - 0.5 * sigma_n, slip = 4e-3;
    for (const int steps : {1, 3, 400}) { // the third of three, and the first, are on both sides of the end
        State state;
        Response r{};
        for (int i = 1; i <= steps; ++i)
            r = respond(dilatant, state, -1e6, 0, 0, (slip + tau / 5e8) * i / steps);
        EXPECT_EQ(r.status, ContactStatus::slipping);
        EXPECT_NEAR(state.slip, slip, 1e-12) << steps;
        EXPECT_EQ(state.dilation, 0.1 * 1e-3) << steps;
        EXPECT_NEAR(r.sigma_n, sigma_n, 1e-6) << steps;
        EXPECT_NEAR(r.tau, tau, 1e-6) << steps;
        EXPECT_EQ(slopes(dilatant, state, r.sigma_n).tan_psi, 0);
        // Slip back opens it no more.
        respond(dilatant, state, -1e6, 0, 0, 0);
        EXPECT_LT(state.slip, 0.9 * slip);
        EXPECT_EQ(state.dilation, 0.1 * 1e-3);
    }
    State before;
    respond(dilatant, before, -1e6, 0, 0, 1.5e-3);
    ASSERT_GT(before.slip, 0);
    EXPECT_EQ(slopes(dilatant, before, -1e6).tan_psi, 0.1);
}

// Peak 1e5 + 0.5 1e6, residual 2e4 + 0.3 1e6 Pa: the peak holds up to 1.2 mm and is gone for good beyond.
TEST(coulomb, weakens_by_slip)
{
    Coulomb brittle = law;
    brittle.weakens = true;
    brittle.residual_cohesion = 2e4;
    brittle.residual_tan_phi = 0.3;
    State state;
    EXPECT_DOUBLE_EQ(respond(brittle, state, -1e6, 0, 0, 1.2e-3).tau, 6e5);
    EXPECT_FALSE(state.is_broken);
    for (int again = 0; again < 2; ++again) {
        const Response r = respond(brittle, state, -1e6, 0, 0, 1.21e-3);
        EXPECT_TRUE(state.is_broken);
        EXPECT_EQ(r.status, ContactStatus::slipping);
        EXPECT_DOUBLE_EQ(r.tau, 3.2e5);
        EXPECT_NEAR(state.slip, 1.21e-3 - 3.2e5 / 5e8, 1e-15);
    }
    // Back, and on again: at the residual strength now, and so under another pressure.
    EXPECT_NEAR(respond(brittle, state, -1e6, 0, 0, 1e-3).tau, 3.2e5 - 2.1e-4 * 5e8, 1e-6);
    EXPECT_DOUBLE_EQ(respond(brittle, state, -1e6, 0, 0, 5e-3).tau, 3.2e5);
    EXPECT_DOUBLE_EQ(respond(brittle, state, -1e6, 0, -1e-3, 9e-3).tau, 2e4 + 0.3 * 2e6);
    // No tension is left, either.
    EXPECT_EQ(respond(brittle, state, -1e6, 0, 1.01e-3, 9e-3).status, ContactStatus::open);
}

TEST(coulomb, weakens_by_opening)
{
    Coulomb brittle = law;
    brittle.weakens = true;
    brittle.residual_cohesion = 2e4;
    brittle.residual_tan_phi = 0.3;
    State state;
    EXPECT_EQ(respond(brittle, state, 0, 0, 6e-5, 0).status, ContactStatus::open);
    EXPECT_DOUBLE_EQ(respond(brittle, state, 0, 0, -1e-3, 1e-2).tau, 2e4 + 0.3 * 1e6);
}

// Pulled by less than its tensile strength it slips, breaks, and so opens.
TEST(coulomb, opens_where_it_weakens_under_tension)
{
    Coulomb brittle = law;
    brittle.weakens = true;
    brittle.residual_tan_phi = 0.3;
    State state;
    EXPECT_EQ(respond(brittle, state, 0, 0, 4e-5, 1e-3).status, ContactStatus::open);
    State tough;
    EXPECT_EQ(respond(law, tough, 0, 0, 4e-5, 1e-3).status, ContactStatus::slipping);
}

// Held apart it is pressed together as it dilates, with the residual strength from the first slip on.
TEST(coulomb, dilates_with_its_residual_strength)
{
    Coulomb brittle = law;
    brittle.weakens = true;
    brittle.residual_tan_phi = 0.3;
    brittle.tan_psi = 0.1;
    State state;
    const double slip = 4e-3, sigma_n = -1e6 - 1e9 * 0.1 * slip, tau = -0.3 * sigma_n;
    const Response r = respond(brittle, state, -1e6, 0, 0, slip + tau / 5e8);
    EXPECT_NEAR(state.slip, slip, 1e-15);
    EXPECT_NEAR(r.sigma_n, sigma_n, 1e-6);
    EXPECT_NEAR(r.tau, tau, 1e-6);
}

// Traction follows displacement without jumps, also where a joint that dilates opens.
TEST(coulomb, opens_without_a_jump)
{
    Coulomb dilatant = law;
    dilatant.cohesion = dilatant.tensile_strength = 0;
    dilatant.tan_psi = 0.1;
    Response last{};
    bool was_open = false, has_slipped_under_tension = false;
    for (int i = -1000; i <= 1000; ++i) {
        State state;
        const double u_n = 1e-7 * i;
        const Response r = respond(dilatant, state, 0, 0, u_n, 5e-4);
        if (i > -1000) {
            EXPECT_LT(std::abs(r.sigma_n - last.sigma_n), 1.1e-7 * dilatant.k_n) << i;
            EXPECT_LT(std::abs(r.tau - last.tau), 1.1e-7 * dilatant.k_n) << i;
        }
        last = r;
        was_open = was_open || r.status == ContactStatus::open;
        has_slipped_under_tension =
            has_slipped_under_tension || (u_n > 0 && r.status == ContactStatus::slipping && r.sigma_n < 0);
    }
    EXPECT_TRUE(was_open);
    EXPECT_TRUE(has_slipped_under_tension);
}

// Raised by its own dilation, a bond does not break: it is under compression all the way.
TEST(coulomb, keeps_its_bond_while_dilation_raises_it)
{
    Coulomb dilatant = law;
    dilatant.tensile_strength = 0;
    dilatant.tan_psi = 0.2;
    State state;
    const double slip = 5e-3, tau = 1e5 + 1e6 * 0.5;
    const Response r = respond(dilatant, state, -1e6, 0, 0.2 * slip, slip + tau / 5e8); // at once
    EXPECT_FALSE(state.is_broken);
    EXPECT_NEAR(r.sigma_n, -1e6, 1e-5);
    EXPECT_NEAR(r.tau, tau, 1e-5);
    EXPECT_NEAR(state.slip, slip, 1e-14);
}

// Pulled apart beyond where friction bears anything, but not beyond the bond's tension.
TEST(coulomb, dilates_under_tension_too)
{
    Coulomb dilatant = law;
    dilatant.cohesion = 1e4;
    dilatant.tan_psi = 0.1;
    State state;
    const Response little = respond(dilatant, state, 4e4, 1e3, 0, 0); // no strength at 40 kPa: all shear goes
    EXPECT_NEAR(little.tau, 0, 1e-9);
    EXPECT_NEAR(state.slip, 1e3 / 5e8, 1e-20);
    EXPECT_NEAR(little.sigma_n, 4e4 - 1e9 * 0.1 * 2e-6, 1e-8);
    state = {};
    const Response much = respond(dilatant, state, 4e4, 1e6, 0, 0); // slip presses it together again
    EXPECT_NEAR(much.tau, 1e4 - 0.5 * much.sigma_n, 1e-6);
    EXPECT_LT(much.sigma_n, 0);
}

RC_GTEST_PROP(coulomb, never_beyond_its_strength_and_the_same_when_asked_twice, ())
{
    Coulomb law = coulomb_test::law;
    law.tan_psi = *rc::gen::element(0.0, 0.1, 0.5);
    law.dilation_until = *rc::gen::element(0.0, 1e-3, 1e-2);
    State state;
    const auto number = [](double scale) { return scale * (*rc::gen::inRange(-1000, 1001)) / 1000.0; };
    for (int i = 0; i < 10; ++i) {
        const double u_n = number(1e-2), u_s = number(1e-2);
        const State start = state;
        const Response r = respond(law, state, -1e6, 1e5, u_n, u_s);
        if (r.status == ContactStatus::slipping) { // slip takes energy, never gives it
            const double slip = state.slip - start.slip, dilation = state.dilation - start.dilation;
            const double left = law.dilation_end() - start.dilation;
            RC_ASSERT(std::abs(dilation - std::min(law.tan_psi * std::abs(slip), left)) <= 1e-15);
            RC_ASSERT(r.tau * slip + r.sigma_n * dilation >= -1e-9 * std::abs(r.tau * slip));
        }
        RC_ASSERT(r.sigma_n <= (state.is_broken ? 0.0 : law.tensile_strength));
        const double cohesion = state.is_broken ? 0 : law.cohesion;
        RC_ASSERT(std::abs(r.tau) <= std::max(0.0, cohesion - r.sigma_n * law.tan_phi) + 1e-6);
        if (std::abs(r.sigma_n - law.tensile_strength) <= 1e-6)
            return; // at the very strength rounding decides whether the bond breaks
        const State before = state;
        const Response again = respond(law, state, -1e6, 1e5, u_n, u_s);
        RC_ASSERT(std::abs(again.tau - r.tau) <= 1e-6);
        RC_ASSERT(std::abs(again.sigma_n - r.sigma_n) <= 1e-6);
        RC_ASSERT(std::abs(state.dilation - before.dilation) <= 1e-14);
        RC_ASSERT(std::abs(state.slip - before.slip) <= 1e-14);
    }
}

} // namespace coulomb_test
