// The time left on a line of progress.

#include "program.hpp"

#include <gtest/gtest.h>

namespace time_left_test
{

using namespace jointcreep;

TEST(time_left, is_by_the_rate_so_far)
{
    EXPECT_EQ(time_left(60, 0, 0, 0.5), ", 60 s left");
    EXPECT_EQ(time_left(60, 0, 0, 0.25), ", 3 min left");
    EXPECT_EQ(time_left(3600, 0, 0, 0.25), ", 3 h left");
    EXPECT_EQ(time_left(60, 0, 0.5, 0.75), ", 60 s left"); // a run that continues at a half
    EXPECT_EQ(time_left(4, 0, 0, 0.5), "");
    EXPECT_EQ(time_left(60, 0, 0.5, 0.5), "");
}

// Seven eighths took 70 s, so the last eighth should take 10 s.
TEST(time_left, is_not_known_after_a_standstill)
{
    EXPECT_EQ(time_left(79, 9, 0, 0.875), ", 12 s left");
    EXPECT_EQ(time_left(81, 11, 0, 0.875), ", time left not known");
    EXPECT_EQ(time_left(79, 29, 0, 0.5), ", 79 s left"); // the half before took 50 s
    EXPECT_EQ(time_left(101, 51, 0, 0.5), ", time left not known");
}

} // namespace time_left_test
