// The rise of a dilating joint at large displacements, beside the law's response at a point.

#include "joint/rising_joint.hpp"

#include "any_law.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

namespace rising_joint_test
{

using namespace jointcreep;
using namespace jointcreep::joint;
using namespace jointcreep::test;

namespace
{

double rise_of(const std::vector<ClosedPartOfJoint>& parts, const std::vector<Moved>& moved)
{
    RisingJoint joint;
    for (const ClosedPartOfJoint& part : parts)
        joint.count(part);
    for (std::size_t p = 0; p < parts.size(); ++p)
        joint.add(parts[p], [&] { return moved[p]; });
    return joint.rise();
}

} // namespace

// A joint of one part is a point: it rises by the dilation of the law's response. (Laws with a memory dilate by what
// they remember at the start of the step: for a small slip.)
RC_GTEST_PROP(rising_joint, of_one_part_dilates_as_the_response, ())
{
    const Law law = some_law(any_in(0, places()));
    State state;
    state.dilation = 1e-5 * any_in(0, 100);
    const double sigma = -1e6 - 1e3 * any_in(0, 4000);
    const double most = remembers(law) ? 1e-7 : 2e-3;
    const Moved moved{any_number(most / 20), any_number(most)};
    // From a point on the strength, where any slide slips.
    const double limit =
        std::max(0.0, slopes(law, state, sigma).cohesion - sigma * slopes(law, state, sigma).tan_phi);
    const double tau = std::copysign(limit, moved.slid);
    State after = state;
    const double sigma_without_slip = normal_traction(law, sigma, moved.opened);
    RC_PRE(sigma_without_slip < 0);
    // Springs count from the traction now, the state's slip and dilation from before.
    after.slip = after.dilation = 0;
    const bool ends = dilates(law) && std::isfinite(dilation_end(law));
    RC_PRE(!ends || remembers(law));
    const Response response = respond(law, after, sigma, tau, moved.opened, moved.slid);
    RC_PRE(response.status == ContactStatus::slipping);
    const double rise = rise_of({{&law, state, 2.5, sigma, tau}}, {moved});
    RC_ASSERT(std::abs(rise - after.dilation) <=
              1e-18 + 1e-9 * std::abs(moved.slid) + (remembers(law) ? 0.02 * after.dilation : 0.0));
}

// By 0.1 for each metre of slip, until asperities are sheared off after 20 mm.
TEST(rising_joint, rises_until_its_dilation_ends)
{
    const Law law = Coulomb{.k_n = 1e9,
                            .k_s = 5e8,
                            .cohesion = 0,
                            .tan_phi = 0.6,
                            .tensile_strength = 0,
                            .tan_psi = 0.1,
                            .dilation_until = 0.02};
    for (const double before : {0.0, 5e-4, 1.5e-3, 2e-3}) {
        State state;
        state.dilation = before;
        const double rise = rise_of({{&law, state, 2.5, -1e6, 6e5}}, {{0, 0.1}});
        EXPECT_NEAR(rise, 2e-3 - before, 1e-15);
    }
    EXPECT_LT(rise_of({{&law, State{}, 2.5, -1e6, 6e5}}, {{0, 1e-3}}), 1e-4);
}

// The rise does the same work against the pressure as the dilation of each part by its own slip.
TEST(rising_joint, does_the_work_of_its_parts)
{
    const double k_n = 1e9, k_s = 5e8, tan_phi = 0.6, tan_psi = 0.1;
    const Law law = Coulomb{
        .k_n = k_n, .k_s = k_s, .cohesion = 0, .tan_phi = tan_phi, .tensile_strength = 0, .tan_psi = tan_psi};
    const State broken{.slip = 0, .dilation = 0, .is_broken = true, .memory = {}};
    const std::vector<ClosedPartOfJoint> parts{
        {&law, broken, 1, -1e6, 6e5}, {&law, broken, 2, -3e6, 0}, {&law, broken, 1, -2e6, 1e6}};
    const Moved slide{0, 1e-3};
    const double x = rise_of(parts, {slide, slide, slide});
    double work = 0, pressed = 0;
    for (const ClosedPartOfJoint& part : parts) {
        const double excess = part.tau + k_s * slide.slid - tan_phi * (-part.sigma + k_n * x);
        work += part.pressed() * tan_psi * std::max(0.0, excess / k_s);
        pressed += part.pressed();
    }
    EXPECT_GT(x, 1e-6);
    EXPECT_NEAR(x * pressed, work, 1e-12 * work);
}

TEST(rising_joint, does_not_rise_open_or_without_dilation)
{
    const Law flat = Coulomb{.k_n = 1e9, .k_s = 5e8, .cohesion = 0, .tan_phi = 0.6, .tensile_strength = 0};
    const Law rough =
        Coulomb{.k_n = 1e9, .k_s = 5e8, .cohesion = 0, .tan_phi = 0.6, .tensile_strength = 0, .tan_psi = 0.1};
    EXPECT_EQ(rise_of({{&flat, State{}, 1, -1e6, 6e5}}, {{0, 1e-3}}), 0);
    EXPECT_EQ(rise_of({{&rough, State{}, 1, 0, 0}}, {{0, 1e-3}}), 0);
    EXPECT_GT(rise_of({{&rough, State{}, 1, -1e6, 6e5}}, {{0, 1e-3}}), 0);
    EXPECT_EQ(rise_of({{&rough, State{}, 1, -1e6, 0}}, {{0, 1e-4}}), 0); // sticks
}

} // namespace rising_joint_test
