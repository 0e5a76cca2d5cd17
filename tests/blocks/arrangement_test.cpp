// The planar subdivision against CGAL's exact arrangement, edge for edge and face for face, on networks of
// all kinds.

#include "blocks/cgal_arrangement.hpp"
#include "blocks/predicates.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <set>

namespace arrangement_test
{

using namespace jointcreep;
using blocks::CgalArrangement;
using blocks::EdgeLines;
using blocks::Graph;
using blocks::insert_lines;
using blocks::nearest;
using Eigen::Vector2d;

namespace
{

void add_line(Graph& lines, const Vector2d& a, const Vector2d& b)
{
    const auto n = static_cast<Index>(lines.vertex.size());
    lines.vertex.push_back(a);
    lines.vertex.push_back(b);
    lines.edge.push_back({n, n + 1, static_cast<Index>(lines.edge.size())});
}

blocks::Sources sources_for(const Graph& lines)
{
    std::vector<blocks::Source> all;
    for (std::size_t i = 0; i < lines.edge.size(); ++i)
        all.push_back({blocks::Source::Kind::joint, static_cast<Index>(i)});
    return blocks::Sources(all);
}

EdgeLines edges_of(const Graph& graph, const blocks::Sources& sources)
{
    EdgeLines edges;
    for (const blocks::Edge& e : graph.edge) {
        const Vector2d &a = graph.vertex[e.first], &b = graph.vertex[e.second];
        const auto on = sources.lines_of(e.sources);
        edges[{a.x(), a.y(), b.x(), b.y()}] = {on.begin(), on.end()};
    }
    return edges;
}

// A face as the directed edges with it on the left, without those that have it on both sides.
using Place = std::pair<double, double>;
using Border = std::set<std::pair<Place, Place>>;

std::multiset<Border> faces_of(const Graph& graph)
{
    const blocks::Faces faces = blocks::trace_faces(graph);
    std::vector<Border> border(faces.size());
    for (std::size_t e = 0; e < graph.edge.size(); ++e) {
        const Vector2d &a = graph.vertex[graph.edge[e].first], &b = graph.vertex[graph.edge[e].second];
        const Place p(a.x(), a.y()), q(b.x(), b.y());
        const auto [left, right] = faces.sides[e];
        if (left == right)
            continue;
        if (left >= 0)
            border[left].emplace(p, q);
        if (right >= 0)
            border[right].emplace(q, p);
    }
    return {border.begin(), border.end()};
}

std::multiset<Border> faces_of(const CgalArrangement& arrangement)
{
    std::map<const void*, Place> place;
    for (auto v = arrangement.vertices_begin(); v != arrangement.vertices_end(); ++v)
        place[&*v] = {nearest(v->point().x()), nearest(v->point().y())};
    std::map<const void*, Border> border;
    for (auto f = arrangement.faces_begin(); f != arrangement.faces_end(); ++f)
        if (!f->is_unbounded())
            border[&*f] = {};
    for (auto h = arrangement.halfedges_begin(); h != arrangement.halfedges_end(); ++h)
        if (h->face() != h->twin()->face() && !h->face()->is_unbounded())
            border[&*h->face()].emplace(place.at(&*h->source()), place.at(&*h->target()));
    std::multiset<Border> all;
    for (const auto& [face, its] : border)
        all.insert(its);
    return all;
}

// "" if both methods agree.
std::string difference(const Graph& lines)
{
    CgalArrangement exact;
    insert_lines(exact, lines);
    blocks::Sources sources = sources_for(lines);
    const Graph ours = blocks::arrange(lines, sources);
    if (edges_of(ours, sources) != blocks::edges_of(exact, lines))
        return "other edges";
    for (std::size_t v = 1; v < ours.vertex.size(); ++v)
        if (!blocks::is_before(ours.vertex[v - 1], ours.vertex[v]))
            return "vertices out of order";
    if (ours.edge.size() != exact.number_of_edges() || ours.vertex.size() != exact.number_of_vertices() ||
        !blocks::crosses_nowhere(ours))
        return ""; // rounding has joined vertices or edges, or made edges cross: no face for each of CGAL's
    return faces_of(ours) == faces_of(exact) ? "" : "other faces";
}

} // namespace

RC_GTEST_PROP(arrangement, agrees_with_cgal, ())
{
    const int n = *rc::gen::inRange(1, 40), kind = *rc::gen::inRange(0, 7);
    std::mt19937 random(*rc::gen::arbitrary<unsigned>());
    std::uniform_real_distribution<double> unit(0, 1);
    const auto anywhere = [&] { return Vector2d(100 * unit(random), 100 * unit(random)); };
    const auto lattice = [&](int steps) {
        return Vector2d(std::floor(steps * unit(random)), std::floor(steps * unit(random)));
    };
    Graph lines;
    for (int i = 0; i < n; ++i) {
        Vector2d a, b;
        switch (kind) {
        case 0: // lines across
            a = {-1, 102 * unit(random) - 1};
            b = {101, 102 * unit(random) - 1};
            break;
        case 1: // short ones
            a = anywhere();
            b = a + 0.2 * (anywhere() - Vector2d(50, 50));
            break;
        case 2: // meeting and overlapping
            a = lattice(6);
            b = lattice(6);
            break;
        case 3: // on a lattice that doubles do not hold
            a = lattice(8) / 3;
            b = lattice(8) / 3;
            break;
        case 4: // through one place that doubles hold, or but for rounding
        {
            const Vector2d d = (anywhere() - Vector2d(50, 50)) / 7;
            const Vector2d centre = i % 3 == 0 ? Vector2d(0.1, 0.3) : Vector2d(0.25, 0.75);
            a = centre - d * unit(random);
            b = centre + d;
            break;
        }
        case 5: // nearly parallel, far from the origin
            a = {1e5, 2e5 + 1e-9 * unit(random)};
            b = {1e5 + 100, 2e5 + 1e-9 * unit(random)};
            break;
        default: // ends of others, moved by a hair or not at all
            if (lines.vertex.empty() || unit(random) < 0.3) {
                a = anywhere();
                b = anywhere();
            } else {
                const auto one = [&] {
                    const Vector2d v = lines.vertex[random() % lines.vertex.size()];
                    return unit(random) < 0.5 ? v : Vector2d(v + 1e-14 * anywhere());
                };
                a = one();
                b = unit(random) < 0.5 ? one() : anywhere();
            }
        }
        if (a != b)
            add_line(lines, a, b);
    }
    RC_CLASSIFY(kind == 3);
    const std::string what = difference(lines);
    RC_ASSERT(what == "");
}

TEST(arrangement, agrees_with_cgal_on_a_large_network)
{
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(0, 1);
    std::normal_distribution<double> normal;
    Graph lines;
    for (const double mean : {15.0, 75.0, 130.0})
        for (int i = 0; i < 60; ++i) {
            const double angle = (mean + 5 * normal(random)) * std::numbers::pi / 180;
            const Vector2d d(std::cos(angle), std::sin(angle)), a(100 * unit(random), 100 * unit(random));
            add_line(lines, a - 200 * unit(random) * d, a + 200 * unit(random) * d);
        }
    EXPECT_EQ(difference(lines), "");
}

// Crowded corners are divided further: all lines in a thousandth of the area, but for one that makes it
// large.
TEST(arrangement, agrees_with_cgal_on_a_crowd_in_a_corner)
{
    std::mt19937 random(4);
    std::uniform_real_distribution<double> unit(0, 1);
    Graph lines;
    add_line(lines, {0, 0}, {1000, 1000});
    for (int i = 0; i < 150; ++i) {
        const Vector2d a(unit(random), unit(random)), b(unit(random), unit(random));
        add_line(lines, a, b);
    }
    for (int i = 0; i < 100; ++i)
        add_line(lines, {0, 2 + 1e-3 * i}, {1, 2 + 1e-3 * i});
    EXPECT_EQ(difference(lines), "");
}

TEST(arrangement, many_islands_are_holes_of_the_faces_around_them)
{
    Graph lines;
    const auto square = [&](double x, double y, double size) {
        const std::array<Vector2d, 4> c = {
            Vector2d(x, y), {x + size, y}, {x + size, y + size}, {x, y + size}};
        for (int i = 0; i < 4; ++i)
            add_line(lines, c[i], c[(i + 1) % 4]);
    };
    square(0, 0, 100);
    for (int i = 0; i < 9; ++i)
        for (int j = 0; j < 9; ++j) {
            square(10 * i + 6, 10 * j + 6, 6); // each with one in it, and one in that
            square(10 * i + 7, 10 * j + 7, 3);
            square(10 * i + 8, 10 * j + 8, 1);
        }
    EXPECT_EQ(difference(lines), "");
    blocks::Sources sources = sources_for(lines);
    const blocks::Faces faces = blocks::trace_faces(blocks::arrange(lines, sources));
    EXPECT_EQ(faces.size(), 1u + 3 * 81);
    std::map<double, int> by_area;
    for (const double area : faces.area)
        ++by_area[area];
    EXPECT_EQ(by_area, (std::map<double, int>{{1, 81}, {9 - 1, 81}, {36 - 9, 81}, {1e4 - 81 * 36, 1}}));
}

// Whether two lines cross; then the crossing is rounded to the nearest doubles.
static bool cross_as_rationals(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d)
{
    if (blocks::turn(a, b, c) * blocks::turn(a, b, d) >= 0 ||
        blocks::turn(c, d, a) * blocks::turn(c, d, b) >= 0)
        return false;
    EXPECT_EQ(blocks::crossing(a, b, c, d), blocks::rational_crossing(a, b, c, d));
    return true;
}

// The nearer to parallel the more digits cancel, until twice the precision of doubles leaves the last bit
// open.
TEST(arrangement, a_crossing_is_rounded_to_the_nearest_doubles)
{
    std::mt19937 random(6);
    std::uniform_real_distribution<double> unit(-100, 100);
    const auto anywhere = [&] { return Vector2d(unit(random), unit(random)); };
    int crossings = 0;
    for (int i = 0; i < 40000 && !HasFailure(); ++i) {
        const double spread = std::pow(10, -(i % 16) - 0.9);
        const Vector2d a = anywhere(), b = anywhere();
        const Vector2d c = a + spread * anywhere(), d = b + spread * anywhere();
        crossings += cross_as_rationals(a, b, c, d);
    }
    EXPECT_GT(crossings, 10000);
}

// Two long lines that begin near the origin: their differences need more than one double, and nearly all digits of the products cancel.
TEST(arrangement, a_crossing_of_long_nearly_parallel_lines_is_rounded_to_the_nearest_doubles)
{
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(-1, 1);
    const auto anywhere = [&] { return Vector2d(unit(random), unit(random)); };
    int crossings = 0;
    for (int i = 0; i < 20000 && !HasFailure(); ++i) {
        const double far = std::pow(10, 1 + i % 8), apart = far * std::numeric_limits<double>::epsilon();
        const Vector2d a = anywhere(), b = far * anywhere();
        const Vector2d c = a + apart * anywhere(), d = b + 3 * apart * anywhere();
        crossings += cross_as_rationals(a, b, c, d);
    }
    EXPECT_GT(crossings, 3000);
}

// A crossing that is off the middle between two doubles by 1e-32 and less: twice the precision of doubles puts it into the middle,
// or on its wrong side.
TEST(arrangement, a_crossing_beside_the_middle_between_two_doubles_is_rounded_to_its_own_side)
{
    const double unit = std::numeric_limits<double>::epsilon(); // between 1 and the next double
    std::mt19937 random(8);
    std::uniform_int_distribution<std::int64_t> units(0, std::int64_t{1} << 40),
        more(0, std::int64_t{1} << 50);
    int to_odd = 0, to_even = 0;
    for (int i = 0; i < 3000; ++i)
        for (const double side : {-1.0, 0.0, 1.0})
            for (const double from : {1.0, 1 + unit}) {
                // The second line crosses the first one at a share of it of about (1 - side * 2^-104) / 2.
                const double width =
                    4503599627370496.0 + 2 * static_cast<double>(more(random)); // 2^52 and more
                const double height = 1 + static_cast<double>(units(random)) * unit;
                const Vector2d p0(from, 0), p1(from + unit, 2 * height), q0(from, height + unit),
                    q1(from + width / 2, height + unit - (width + side));
                const Vector2d place = blocks::crossing(p0, p1, q0, q1);
                ASSERT_EQ(place, blocks::rational_crossing(p0, p1, q0, q1))
                    << i << ' ' << side << ' ' << from;
                ++(place.x() == 1 + unit ? to_odd : to_even);
            }
    EXPECT_GT(to_odd, 1000);
    EXPECT_GT(to_even, 1000);
}

// The face around an island is that beside the nearest edge to the left: here the first edge of all, which goes up or down. Also
// below the level 0.
TEST(arrangement, the_first_edge_may_be_the_one_left_of_an_island)
{
    for (const double low : {0.0, -1000.0, 1000.0})
        for (const double lean : {-1.0, 0.0, 1.0}) {
            Graph lines;
            const std::array<Vector2d, 4> corner = {
                Vector2d(0, low), {10, low}, {10, low + 10}, {lean, low + 10}};
            for (int i = 0; i < 4; ++i)
                add_line(lines, corner[i], corner[(i + 1) % 4]);
            for (int i = 0; i < 3; ++i) {
                const Vector2d a(2, low + 1 + 3 * i), b(4, low + 1 + 3 * i), c(3, low + 3 + 3 * i);
                add_line(lines, a, b);
                add_line(lines, b, c);
                add_line(lines, a, c);
            }
            EXPECT_EQ(difference(lines), "");
            blocks::Sources sources = sources_for(lines);
            const Graph graph = blocks::arrange(lines, sources);
            const blocks::Edge& first = graph.edge[0];
            EXPECT_LE(graph.vertex[first.first].x() + graph.vertex[first.second].x(), 1) << "the left side";
            const blocks::Faces faces = blocks::trace_faces(graph);
            EXPECT_EQ(faces.area, (std::vector<double>{100 - 5 * lean - 3 * 2, 2, 2, 2}));
        }
}

// Two edges to the left of an island, of which the nearer one is the first of all.
TEST(arrangement, an_island_is_in_the_face_beside_the_nearest_edge)
{
    Graph lines;
    const std::array<Vector2d, 5> corner = {Vector2d(0, 0), {1, 1}, {10, 1}, {2, 10}, {10, -2}};
    add_line(lines, corner[0], corner[1]);
    add_line(lines, corner[1], corner[2]);
    add_line(lines, corner[2], corner[3]);
    add_line(lines, corner[3], corner[0]);
    add_line(lines, corner[0], corner[4]);
    add_line(lines, corner[4], corner[2]);
    const std::array<Vector2d, 3> island = {Vector2d(3, 0.25), {4, 0.25}, {4, 0.75}};
    for (int i = 0; i < 3; ++i)
        add_line(lines, island[i], island[(i + 1) % 3]);
    EXPECT_EQ(difference(lines), "");
    blocks::Sources sources = sources_for(lines);
    const blocks::Faces faces = blocks::trace_faces(blocks::arrange(lines, sources));
    EXPECT_EQ(faces.size(), 3u);
}

} // namespace arrangement_test
