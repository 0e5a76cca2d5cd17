// The joint law against its own definition, on paths worked out by hand.

#include "joint/coulomb.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

using namespace jointcreep;
using namespace jointcreep::joint;

namespace
{

const Coulomb law{.k_n = 1e9, .k_s = 5e8, .cohesion = 1e5, .tan_phi = 0.5, .tensile_strength = 5e4};

} // namespace

TEST(coulomb, springs_within_its_strength)
{
    CoulombState state;
    const Response r = respond(law, state, -1e6, 2e5, -1e-4, 3e-4);
    EXPECT_DOUBLE_EQ(r.sigma_n, -1e6 - 1e5);
    EXPECT_DOUBLE_EQ(r.tau, 2e5 + 1.5e5);
    EXPECT_EQ(r.status, ContactStatus::stuck);
    EXPECT_EQ(state.slip, 0);
}

TEST(coulomb, slips_at_cohesion_plus_friction_and_unloads_elastically)
{
    CoulombState state;
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
    CoulombState state;
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
    CoulombState state;
    const Response r = respond(smooth, state, -1e6, 0, 0, 1);
    EXPECT_EQ(r.tau, 0);
    EXPECT_EQ(r.status, ContactStatus::stuck);
}

RC_GTEST_PROP(coulomb, never_beyond_its_strength_and_the_same_when_asked_twice, ())
{
    CoulombState state;
    const auto number = [](double scale) { return scale * (*rc::gen::inRange(-1000, 1001)) / 1000.0; };
    for (int i = 0; i < 10; ++i) {
        const double u_n = number(1e-2), u_s = number(1e-2);
        const Response r = respond(law, state, -1e6, 1e5, u_n, u_s);
        RC_ASSERT(r.sigma_n <= (state.is_broken ? 0.0 : law.tensile_strength));
        const double cohesion = state.is_broken ? 0 : law.cohesion;
        RC_ASSERT(std::abs(r.tau) <= std::max(0.0, cohesion - r.sigma_n * law.tan_phi) + 1e-6);
        const CoulombState before = state;
        const Response again = respond(law, state, -1e6, 1e5, u_n, u_s);
        RC_ASSERT(std::abs(again.tau - r.tau) <= 1e-6);
        RC_ASSERT(again.sigma_n == r.sigma_n);
        RC_ASSERT(std::abs(state.slip - before.slip) <= 1e-14);
    }
}
