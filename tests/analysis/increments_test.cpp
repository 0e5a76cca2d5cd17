// How far two results differ, by hand.

#include "analysis/increments.hpp"

#include <gtest/gtest.h>

namespace increments_test
{

using namespace jointcreep;
using analysis::change_between;

namespace
{

// Two gridpoints, a contact of 2 m, and two states.
Result result(double moved, double shear, double normal = -1e6)
{
    Result made;
    made.mesh.gridpoint = {{0, 0}, {1, 0}};
    made.mesh.contact_length = {2};
    made.states.time = {0, 1};
    made.states.displacement = {{0, 0}, {0, 0}, {0, 0.5}, {0, moved}};
    made.states.traction = {{-1e6, 0}, {normal, shear}};
    return made;
}

} // namespace

TEST(change_between, is_the_larger_of_displacements_and_tractions)
{
    EXPECT_NEAR(change_between(result(1.1, 2e5), result(1, 2e5)), 0.1, 1e-12);
    EXPECT_NEAR(change_between(result(1, 2.5e5), result(1, 2e5)), 0.25, 1e-12);
    EXPECT_NEAR(change_between(result(0.9, 2.1e5), result(1, 2e5)), 0.1, 1e-12);
    EXPECT_EQ(change_between(result(1, 2e5), result(1, 2e5)), 0);
}

TEST(change_between, has_normal_and_shear_tractions_apart)
{
    EXPECT_NEAR(change_between(result(1, 2e5, -3.3e6), result(1, 2e5, -3e6)), 0.15, 1e-12);
    EXPECT_NEAR(change_between(result(1, 5.2e5, -3e6), result(1, 5e5, -3e6)), 0.04, 1e-12);
    // Shear that hardly changes counts as a tenth of both.
    EXPECT_NEAR(change_between(result(1, 3e4, -3e6), result(1, 0, -3e6)), 0.15, 1e-12);
}

TEST(change_between, compares_the_last_states_where_there_are_more_of_one)
{
    Result longer = result(1, 2e5);
    longer.states.time.insert(longer.states.time.begin() + 1, 0.5);
    longer.states.displacement.insert(longer.states.displacement.begin() + 2, 2, {9, 9});
    longer.states.traction.insert(longer.states.traction.begin() + 1, {-5e6, 0});
    EXPECT_NEAR(change_between(longer, result(1, 1.6e5)), 0.25, 1e-12);
}

TEST(change_between, something_and_nothing_differ)
{
    EXPECT_EQ(change_between(result(1, 0), result(1, 0)), 0);
    EXPECT_EQ(change_between(result(1, 1), result(1, 0)), 1);
}

} // namespace increments_test
