// Simple polygons are told from others, and points inside from those outside.

#include "keys/polygon.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numbers>

namespace polygon_test
{

using namespace jointcreep;
using namespace jointcreep::keys;

namespace
{

// A star around the origin: simple whatever its radii.
Polygon random_star()
{
    const int n = *rc::gen::inRange(3, 40);
    Polygon star;
    for (int i = 0; i < n; ++i) {
        const double radius = *rc::gen::inRange(1, 1000) / 100.0;
        const double angle = 2 * std::numbers::pi * i / n;
        star.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    return star;
}

RC_GTEST_PROP(polygon, stars_are_simple_and_hold_their_centre, ())
{
    const Polygon star = random_star();
    RC_ASSERT(polygon_fault(star).empty());
    RC_ASSERT(covers(star, {0, 0}, 0));
    RC_ASSERT(!covers(star, {10.5, 0}, 0));
}

RC_GTEST_PROP(polygon, swapping_two_corners_apart_of_a_convex_one_crosses, ())
{
    const int n = *rc::gen::inRange(5, 40);
    Polygon circle;
    for (int i = 0; i < n; ++i)
        circle.emplace_back(std::cos(2 * std::numbers::pi * i / n), std::sin(2 * std::numbers::pi * i / n));
    RC_ASSERT(polygon_fault(circle).empty());
    const auto first = *rc::gen::inRange(0, n);
    std::swap(circle[first], circle[(first + *rc::gen::inRange(1, n - 1)) % n]);
    RC_ASSERT(!polygon_fault(circle).empty());
}

TEST(polygon, touching_is_a_fault)
{
    EXPECT_TRUE(polygon_fault({{0, 0}, {4, 0}, {4, 4}, {0, 4}}).empty());
    EXPECT_TRUE(polygon_fault({{0, 0}, {2, 0}, {4, 0}, {4, 4}, {0, 4}}).empty())
        << "a corner on a straight side";
    EXPECT_FALSE(polygon_fault({{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}}).empty())
        << "a corner on another side";
    EXPECT_FALSE(polygon_fault({{0, 0}, {4, 0}, {4, 4}, {4, -1}, {0, 4}}).empty()) << "a side along another";
    EXPECT_FALSE(polygon_fault({{0, 0}, {4, 0}, {2, 0}}).empty()) << "no area";
    EXPECT_FALSE(polygon_fault({{0, 0}, {4, 0}, {4, 4}, {0, 0}, {-4, 4}}).empty()) << "a corner twice";
    EXPECT_FALSE(polygon_fault({{0, 0}, {4, 0}}).empty());
}

TEST(polygon, many_corners_take_little_time)
{
    Polygon comb; // tall teeth: all sides side by side
    for (int i = 0; i < 5000; ++i) {
        comb.emplace_back(2 * i, 0);
        comb.emplace_back(2 * i + 1, 1000);
    }
    comb.emplace_back(10000, -1);
    comb.emplace_back(-1, -1);
    EXPECT_EQ(polygon_fault(comb), "");
}

TEST(polygon, common_length)
{
    EXPECT_DOUBLE_EQ(common_length({0, 0}, {3, 4}, {0.6, 0.8}, {6, 8}, 1e-9), 4);
    EXPECT_DOUBLE_EQ(common_length({0, 0}, {3, 4}, {6, 8}, {0.6, 0.8}, 1e-9), 4) << "either way round";
    EXPECT_EQ(common_length({0, 0}, {3, 4}, {6, 8}, {9, 12}, 1e-9), 0) << "beyond";
    EXPECT_EQ(common_length({0, 0}, {3, 4}, {0.6, 0.9}, {6, 8}, 1e-9), 0) << "not along";
    EXPECT_DOUBLE_EQ(length_on_sides({{0, 0}, {2, 0}, {4, 0}, {4, 4}}, {1, 0}, {4, 0}, 1e-9), 3)
        << "two sides in line";
}

} // namespace

} // namespace polygon_test
