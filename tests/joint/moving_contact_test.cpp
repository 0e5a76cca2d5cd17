// A joint between two faces in one time step: the part that is closed, the part of the step, and energies that close.

#include "joint/moving_contact.hpp"

#include "any_law.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

namespace moving_contact_test
{

using namespace jointcreep;
using namespace jointcreep::joint;
using namespace jointcreep::test;

namespace
{

const Law smooth = Coulomb{.k_n = 1e9, .k_s = 5e8, .cohesion = 0, .tan_phi = 0.5, .tensile_strength = 0};

} // namespace

// Where the closing, linear along the overlap, is positive.
TEST(moving_contact, without_bonds_carries_where_it_is_closed)
{
    ClosedPart part{{-1e-3, 3e-3}};
    part.leave_bonds();
    EXPECT_NEAR(part.ends[0], 0.25, 1e-15);
    EXPECT_EQ(part.ends[1], 1);
    EXPECT_EQ(part.closing[0], 0);
    EXPECT_EQ(part.closing[1], 3e-3);
    part = {{2e-3, -2e-3}};
    part.leave_bonds();
    EXPECT_EQ(part.ends[0], 0);
    EXPECT_NEAR(part.ends[1], 0.5, 1e-15);
    EXPECT_EQ(part.closing[1], 0);
    part = {{2e-3, 1e-3}};
    part.leave_bonds();
    EXPECT_EQ(part.ends[0], 0);
    EXPECT_EQ(part.ends[1], 1);
}

TEST(moving_contact, breaks_where_an_end_is_pulled_beyond_its_tensile_strength)
{
    const Law bonded =
        Coulomb{.k_n = 1e9, .k_s = 5e8, .cohesion = 1e6, .tan_phi = 0.5, .tensile_strength = 2e5};
    EXPECT_FALSE(breaks(bonded, {-1.99e-4, 1e-3}));
    EXPECT_TRUE(breaks(bonded, {-2.01e-4, 1e-3}));
    EXPECT_TRUE(breaks(bonded, {1e-3, -2.01e-4}));
    EXPECT_TRUE(breaks(smooth, {-1e-9, -1e-9}));
}

// A contact that closes in a step, or opens in the next, presses for a part of the time: half a step when it just
// touches, all of it when it has been closed all the while.
TEST(moving_contact, presses_for_the_part_of_the_step_in_which_it_is_closed)
{
    const auto part = [](double opened, double before, bool was_closed, double deep) {
        return NormalMove{{opened, opened}, 0, before, was_closed}.part_of_time(deep);
    };
    EXPECT_NEAR(part(-2e-3, -2e-3, false, 0), 0.5, 1e-15);
    EXPECT_NEAR(part(-2e-3, -2e-3, false, 1e-3), 0.75, 1e-15);
    EXPECT_EQ(part(-2e-3, -2e-3, false, 2e-3), 1);
    EXPECT_EQ(part(-2e-3, -2e-3, true, 1e-3), 1);
    EXPECT_EQ(part(1e-3, 1e-3, true, 2e-3), 1);             // still closed after the next step
    EXPECT_NEAR(part(1e-3, 1e-3, true, 0), 0.5, 1e-15);     // opens now
    EXPECT_NEAR(part(1e-3, 1e-3, true, 5e-4), 0.75, 1e-15); // halfway through the next step
}

// What is done on a shear spring that may slip, and of which a part may open = what it stores more + what slip takes +
// what opening takes. The force is never beyond the strength.
RC_GTEST_PROP(moving_contact, accounts_for_the_work_of_shear, ())
{
    const double last_length = any_in(1, 1000) / 500.0, length = any_in(0, 1001) / 500.0,
                 limit = 1e3 * any_in(0, 2000);
    const double k_s = 5e8, tau = any_number(1e6), slid = any_number(2e-3);
    const double sheared_in = stored_in_shear(smooth, tau * last_length, last_length);
    const ShearMove move = shear_move(smooth, tau, last_length, length, slid);
    State state;
    const double force = shear_force(smooth, state, move, limit);
    RC_ASSERT(std::abs(force) <= limit);
    RC_ASSERT(std::abs(move.trial - (tau * std::min(length, last_length) + k_s * slid * length)) <= 1e-6);
    RC_CLASSIFY(force != move.trial, "slips");
    RC_PRE(length > 0);
    const double stored = stored_in_shear(smooth, force, length), slip = taken_by_slip(smooth, move, force),
                 opening = taken_by_opening(smooth, move, sheared_in), work = (move.last + force) / 2 * slid;
    const double size = stored + sheared_in + std::abs(slip) + std::abs(opening) + std::abs(work);
    RC_ASSERT(std::abs(stored - sheared_in + slip + opening - work) <= 1e-12 * size);
}

// A law that remembers divides the force by the length, and multiplies again. Where it does not slip the force is the trial to the bit: by
// that a step knows that it sticks, and that dashpots hold it.
TEST(moving_contact, sticks_to_the_bit)
{
    const Law wears = WearingDilation{
        {.k_n = 4e9, .k_s = 1e9, .cohesion = 2e5, .tan_phi = 0.6, .tensile_strength = 0, .tan_psi = 0.2},
        2e-4};
    ASSERT_TRUE(remembers(wears));
    int rounded = 0;
    for (int i = 1; i <= 200; ++i) {
        State state;
        const double length = 0.01 * i;
        const ShearMove move = shear_move(wears, 1e4 / 3, length, length, 1e-6 / 7 * i);
        rounded += move.trial / length * length != move.trial;
        const double force = shear_force(wears, state, move, 1e7 * length);
        EXPECT_EQ(force, move.trial);
        EXPECT_GT(shear_held(wears, move, force, 1e7 * length, 0.1), 0);
    }
    EXPECT_GT(rounded, 10);
}

// Dashpots resist the slide, never beyond the strength, and not where it slips.
RC_GTEST_PROP(moving_contact, dashpots_stay_within_the_strength, ())
{
    const double limit = 1e3 * any_in(0, 2000), dashpots = any_in(0, 1000) / 100.0;
    const ShearMove move = shear_move(smooth, any_number(1e6), 1, 1, any_number(1e-3));
    State state;
    const double force = shear_force(smooth, state, move, limit),
                 held = shear_held(smooth, move, force, limit, dashpots);
    RC_ASSERT(std::abs(force + held) <= limit * (1 + 1e-15));
    RC_ASSERT(held * move.slid >= 0);
    RC_ASSERT(force == move.trial || held == 0);
    if (force == move.trial && std::abs(force + dashpots * 5e8 * move.slid) < limit)
        RC_ASSERT(std::abs(held - dashpots * 5e8 * move.slid) <= 1e-9 * limit);
}

// Springs press and dashpots hold in proportion to each end's opening; dashpots of an open joint do not pull.
TEST(moving_contact, dashpots_press_no_less_than_nothing)
{
    const AlongOverlap closed = along_overlap(smooth, State{}, {1e-4, 1e-4}, 2);
    const ClosedPart part{{1e-4, 1e-4}};
    const NormalMove slow{{1e-5, 1e-5}, 0, 0, true}, fast{{1e-2, 1e-2}, 0, 0, true};
    const NormalForce one = normal_force(closed, part, 2, slow, 1, true);
    EXPECT_NEAR(one.pressed[0] + one.pressed[1], 1e9 * 1e-4 * 2, 1e-3);
    EXPECT_NEAR(one.held[0] + one.held[1], 1e9 * 1e-5 * 2, 1e-3);
    const NormalForce other = normal_force(closed, part, 2, fast, 1, false);
    EXPECT_EQ(other.held[0], other.pressed[0]);
    EXPECT_EQ(other.held[1], other.pressed[1]);
}

} // namespace moving_contact_test
