// Which places are inside a polygon of many corners, held to a look at every side.

#include "blocks/graph.hpp"
#include "blocks/predicates.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace inside_test
{

using namespace jointcreep;
using Eigen::Vector2d;

namespace
{

// By the winding number about the place, exactly; the border counts as inside.
bool winds_around(const Polygon& polygon, const Vector2d& place)
{
    int winding = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vector2d &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
        const int side = blocks::turn(p, q, place);
        if (p == place || q == place || (side == 0 && blocks::is_between(p, q, place)))
            return true;
        if (p.y() <= place.y() && place.y() < q.y() && side > 0)
            ++winding;
        if (q.y() <= place.y() && place.y() < p.y() && side < 0)
            --winding;
    }
    return winding != 0;
}

// Corners, middles of sides, and places at the height of a corner or anywhere in the box and around.
void expect_right(const Polygon& polygon, std::mt19937& random)
{
    const blocks::Inside inside(polygon);
    std::uniform_real_distribution<double> place(-1.2, 1.2);
    int holds = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i)
        for (const Vector2d& at :
             {polygon[i], Vector2d((polygon[i] + polygon[(i + 1) % polygon.size()]) / 2),
              Vector2d(place(random), polygon[i].y()), Vector2d(place(random), place(random))}) {
            ASSERT_EQ(inside.holds(at), winds_around(polygon, at)) << at.transpose();
            holds += inside.holds(at);
        }
    EXPECT_GT(holds, 0);
}

} // namespace

TEST(inside, star)
{
    std::mt19937 random(5);
    std::uniform_real_distribution<double> reach(0.5, 1);
    for (const int corners : {3, 4, 7, 50, 1000}) {
        Polygon polygon;
        for (int i = 0; i < corners; ++i) {
            const double angle = 2 * std::numbers::pi * i / corners;
            polygon.push_back(reach(random) * Vector2d(std::cos(angle), std::sin(angle)));
        }
        expect_right(polygon, random);
        std::reverse(polygon.begin(), polygon.end());
        expect_right(polygon, random);
    }
}

// Every side as high as the polygon, or level.
TEST(inside, comb)
{
    std::mt19937 random(6);
    Polygon polygon;
    for (int tooth = 0; tooth < 200; ++tooth) {
        const double x = -1 + tooth / 100.;
        polygon.insert(polygon.end(), {{x, -0.5}, {x, 1}, {x + 0.005, 1}, {x + 0.005, -0.5}});
    }
    polygon.insert(polygon.end(), {{1, -1}, {-1, -1}});
    expect_right(polygon, random);
}

// Of faces with corners that reach far in, a place that is well inside.
TEST(inside, place_inside_a_face)
{
    std::mt19937 random(9);
    std::uniform_real_distribution<double> reach(0.05, 1);
    for (int round = 0; round < 2000; ++round) {
        const int corners = 5 + round % 12;
        Polygon polygon;
        blocks::Graph graph;
        for (Index i = 0; i < corners; ++i) {
            const double angle = 2 * std::numbers::pi * i / corners;
            polygon.push_back(reach(random) * Vector2d(std::cos(angle), std::sin(angle)));
            graph.edge.push_back({std::min(i, (i + 1) % corners), std::max(i, (i + 1) % corners), 0});
        }
        graph.vertex = polygon;
        const blocks::Faces faces = blocks::trace_faces(graph);
        ASSERT_EQ(faces.size(), 1u);
        const Vector2d place = blocks::place_inside(graph.vertex, faces, 0);
        ASSERT_TRUE(winds_around(polygon, place)) << round;
        for (int i = 0; i < corners; ++i)
            ASSERT_NE(blocks::turn(polygon[i], polygon[(i + 1) % corners], place), 0) << round;
    }
}

// Two spikes of the outside between the lowest corner and its neighbours. The first hides the tip of the second: half-way there is
// outside.
TEST(inside, place_inside_a_corner_with_two_spikes)
{
    const Polygon polygon{{0, 0},  {10, 0},  {10, 0.5}, {0.5, 1.2}, {10, 4},
                          {10, 5}, {3, 2.6}, {10, 9},   {0, 10}};
    ASSERT_FALSE(winds_around(polygon, {1.5, 1.3}));
    blocks::Graph graph{.vertex = polygon, .edge = {}};
    for (Index i = 0; i + 1 < 9; ++i)
        graph.edge.push_back({i, i + 1, 0});
    graph.edge.push_back({0, 8, 0});
    const Vector2d place = blocks::place_inside(polygon, blocks::trace_faces(graph), 0);
    EXPECT_TRUE(winds_around(polygon, place)) << place.transpose();
}

TEST(inside, level_line_of_no_height)
{
    const Polygon polygon{{0, 0}, {1, 0}, {2, 0}};
    EXPECT_TRUE(blocks::Inside(polygon).holds({0.5, 0}));
    EXPECT_FALSE(blocks::Inside(polygon).holds({0.5, 0.1}));
}

} // namespace inside_test
