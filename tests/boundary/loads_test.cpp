// Tractions and displacements of the outline over time, worked out by hand.

#include "boundary/loads.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <optional>

namespace loads_test
{

using namespace jointcreep;
using boundary::Loads;
using Eigen::Vector2d;

namespace
{

// 3 ______________ 2
//  |           /  |      4 m x 3 m of two zones; the right side is on the first boundary, the top on the
//  |  1    /      |      second one
//  |    /    0    |
//  |/_____________|
// 0                1
Mesh two_zones()
{
    Mesh mesh;
    mesh.gridpoint = {{0, 0}, {4, 0}, {4, 3}, {0, 3}};
    mesh.zone_gridpoint = {{0, 1, 2}, {0, 2, 3}};
    mesh.side_gridpoint = {{1, 2}, {2, 3}};
    mesh.side_zone = {0, 1};
    mesh.side_boundary = {0, 1};
    return mesh;
}

const Vector2d anywhere(0, 0); // the mesh knows where they are

Boundary pushed(const Vector2d& traction, const LoadHistory& history = {})
{
    return {.from = anywhere, .to = anywhere, .traction = traction, .load_history = history};
}
Boundary fixed(bool x, bool y, const std::optional<Vector2d>& displacement = {},
               const LoadHistory& history = {})
{
    return {.from = anywhere,
            .to = anywhere,
            .fix_x = x,
            .fix_y = y,
            .displacement = displacement,
            .load_history = history};
}
const Boundary nothing = fixed(false, false);

Loads loads(const Boundary& right, const Boundary& top = nothing)
{
    Scene scene;
    scene.boundaries = {right, top};
    return {scene, two_zones()};
}

const std::vector<char> all_there{1, 1};

std::vector<Vector2d> forces(const Loads& loads, double time, const std::vector<char>& is_present = all_there)
{
    std::vector<Vector2d> force(4, Vector2d::Zero());
    loads.add_forces(force, is_present, time);
    return force;
}

std::vector<Vector2d> displaced(const Loads& loads, double time,
                                const std::vector<char>& is_present = all_there)
{
    std::vector<Vector2d> displacement(4, Vector2d(7, 7));
    loads.displace(displacement, is_present, time);
    return displacement;
}

using All = std::vector<Vector2d>;

} // namespace

TEST(loads, tractions_follow_their_history)
{
    const Loads right = loads(pushed({1e3, -2e3}, {{{10, 0}, {20, 1}, {40, -0.5}}}));
    const Vector2d none(0, 0), whole(1500, -3000); // half of 3 m at each end
    EXPECT_EQ(forces(right, 0), (All{none, none, none, none}));
    EXPECT_EQ(forces(right, 15), (All{none, 0.5 * whole, 0.5 * whole, none}));
    EXPECT_EQ(forces(right, 20), (All{none, whole, whole, none}));
    EXPECT_EQ(forces(right, 30), (All{none, 0.25 * whole, 0.25 * whole, none}));
    EXPECT_EQ(forces(right, 1e9), (All{none, -0.5 * whole, -0.5 * whole, none}));
}

TEST(loads, tractions_add_up)
{
    const Loads both = loads(pushed({1e3, 0}), pushed({0, -1e2}));
    All force(4, Vector2d(1, 1));
    both.add_forces(force, all_there, 0);
    EXPECT_EQ(force, (All{{1, 1}, {1501, 1}, {1501, -199}, {1, -199}}));
}

TEST(loads, displacements_count_from_the_start)
{
    const Loads right = loads(fixed(true, false, Vector2d(2e-3, 0), {{{0, 0.25}, {10, 1.25}}}));
    EXPECT_EQ(displaced(right, 0), (All{{7, 7}, {0, 7}, {0, 7}, {7, 7}})); // y is free
    EXPECT_EQ(displaced(right, 5), (All{{7, 7}, {1e-3, 7}, {1e-3, 7}, {7, 7}}));
    EXPECT_EQ(displaced(right, 20), (All{{7, 7}, {2e-3, 7}, {2e-3, 7}, {7, 7}}));
    const Loads top = loads(nothing, fixed(false, true, Vector2d(0, -1e-3), {{{0, 0}, {10, 1}}}));
    EXPECT_EQ(displaced(top, 10), (All{{7, 7}, {7, 7}, {7, -1e-3}, {7, -1e-3}}));
    EXPECT_EQ(displaced(loads(fixed(true, true)), 5), All(4, Vector2d(7, 7))); // only held
}

TEST(loads, a_side_without_rock_has_none)
{
    const Loads with_tractions = loads(pushed({1e3, 0}), pushed({0, -1e2}));
    const Vector2d none(0, 0);
    EXPECT_EQ(forces(with_tractions, 0, {0, 1}), (All{none, none, {0, -200}, {0, -200}}));
    EXPECT_EQ(forces(with_tractions, 0, {1, 0}), (All{none, {1500, 0}, {1500, 0}, none}));
    const LoadHistory ramp{{{0, 0}, {10, 1}}};
    const Loads with_displacements =
        loads(fixed(true, false, Vector2d(1, 0), ramp), fixed(false, true, Vector2d(0, 2), ramp));
    EXPECT_EQ(displaced(with_displacements, 10, {0, 1}), (All{{7, 7}, {7, 7}, {7, 2}, {7, 2}}));
    EXPECT_EQ(displaced(with_displacements, 10, {1, 0}), (All{{7, 7}, {1, 7}, {1, 7}, {7, 7}}));
}

TEST(loads, sides_with_rock_fix)
{
    const Vector2d none(0, 0);
    const Loads both = loads(fixed(true, false), fixed(false, true));
    EXPECT_EQ(both.fixed(4, all_there), (All{none, {1, 0}, {1, 1}, {0, 1}}));
    EXPECT_EQ(both.fixed(4, {0, 1}), (All{none, none, {0, 1}, {0, 1}}));
    EXPECT_EQ(both.fixed(4, {1, 0}), (All{none, {1, 0}, {1, 0}, none}));
    EXPECT_EQ(loads(pushed({1e3, 0})).fixed(4, all_there), All(4, none));
}

TEST(loads, change_where_a_history_does)
{
    const LoadHistory history{{{10, 0}, {20, 1}, {40, 1}, {50, 0}}};
    const Boundary steady = pushed({1, 0});
    for (const Loads& some :
         {loads(pushed({1, 0}, history)), loads(steady, fixed(true, false, Vector2d(1, 0), history))}) {
        EXPECT_FALSE(some.changes(0, 10));
        EXPECT_TRUE(some.changes(0, 11));
        EXPECT_TRUE(some.changes(12, 19));
        EXPECT_FALSE(some.changes(20, 40));
        EXPECT_TRUE(some.changes(39, 41));
        EXPECT_FALSE(some.changes(50, 60));
    }
    EXPECT_FALSE(
        loads(fixed(true, false, {}, history), steady).changes(0, 20)); // nothing that the factor acts on
}

TEST(loads, have_the_corners_of_all_histories)
{
    const Loads both =
        loads(pushed({1, 0}, {{{10, 0}, {30, 1}}}), pushed({1, 0}, {{{5, 0}, {30, 2}, {40, 1}}}));
    EXPECT_EQ(both.corners(), (std::set<double>{5, 10, 30, 40}));
    EXPECT_TRUE(loads(pushed({1, 0})).corners().empty());
}

// Between neighbouring corners all goes straight: whoever takes steps from corner to corner sees every extreme.
RC_GTEST_PROP(loads, go_straight_between_corners, ())
{
    const auto history = [] {
        LoadHistory some;
        double time = 0;
        for (int n = *rc::gen::inRange(0, 5); n > 0; --n) {
            time += *rc::gen::inRange(1, 100);
            some.points.emplace_back(time, *rc::gen::inRange(-1000, 1001) / 500.0);
        }
        return some;
    };
    const Loads both =
        loads(pushed({1e3, -2e3}, history()), fixed(true, true, Vector2d(1e-3, 2e-3), history()));
    std::set<double> times = both.corners();
    times.insert({-50, 0, 600}); // beyond all of them, too
    for (auto after = std::next(times.begin()); after != times.end(); ++after) {
        const double from = *std::prev(after), to = *after, share = *rc::gen::inRange(0, 101) / 100.0,
                     time = from + share * (to - from);
        const auto between = [&](const All& first, const All& second, const All& there, double rounding) {
            for (std::size_t g = 0; g < there.size(); ++g)
                RC_ASSERT((first[g] + share * (second[g] - first[g]) - there[g]).norm() < rounding);
        };
        between(forces(both, from), forces(both, to), forces(both, time), 1e-9);
        between(displaced(both, from), displaced(both, to), displaced(both, time), 1e-14);
        if (!both.changes(from, to))
            RC_ASSERT(forces(both, from) == forces(both, to) && displaced(both, from) == displaced(both, to));
        else
            RC_ASSERT(forces(both, from) != forces(both, to) || displaced(both, from) != displaced(both, to));
    }
}

} // namespace loads_test
