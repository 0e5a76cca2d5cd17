// Zones cover the blocks, joints split gridpoints, bonded edges do not.

#include "zoning/zone.hpp"

#include "../blocks/section.hpp"

#include <gtest/gtest.h>

#include <random>

namespace zone_test
{

using namespace jointcreep;
using namespace jointcreep::test;
using Eigen::Vector2d;

namespace
{

double zone_area(const Mesh& mesh, std::size_t z)
{
    const auto& g = mesh.zone_gridpoint[z];
    const Vector2d a = mesh.gridpoint[g[1]] - mesh.gridpoint[g[0]],
                   b = mesh.gridpoint[g[2]] - mesh.gridpoint[g[0]];
    return (a.x() * b.y() - a.y() * b.x()) / 2;
}

// Zones of every block add up to it, all the right way round; contacts carry the whole length of their edge.
void expect_sound(const Blocks& blocks, const Mesh& mesh)
{
    std::vector<double> area(blocks.block_area.size(), 0.0);
    for (std::size_t z = 0; z < mesh.zone_block.size(); ++z) {
        EXPECT_GT(zone_area(mesh, z), 0);
        area[mesh.zone_block[z]] += zone_area(mesh, z);
    }
    for (std::size_t b = 0; b < area.size(); ++b)
        EXPECT_NEAR(area[b], blocks.block_area[b], 1e-9 * blocks.block_area[b]);

    std::vector<double> length(blocks.edge_vertex.size(), 0.0);
    for (std::size_t c = 0; c < mesh.contact_edge.size(); ++c) {
        length[mesh.contact_edge[c]] += mesh.contact_length[c];
        EXPECT_NE(mesh.contact_gridpoint[c][0], mesh.contact_gridpoint[c][1]);
        EXPECT_EQ(mesh.gridpoint[mesh.contact_gridpoint[c][0]], mesh.gridpoint[mesh.contact_gridpoint[c][1]]);
    }
    for (std::size_t e = 0; e < length.size(); ++e)
        if (blocks.edge_kind[e] == static_cast<Index>(EdgeKind::joint)) {
            const auto [a, b] = blocks.edge_vertex[e];
            EXPECT_NEAR(length[e], (blocks.vertex[a] - blocks.vertex[b]).norm(), 1e-9);
        }
}

// Pieces of rock that hold together: gridpoints linked by zones.
std::size_t pieces(const Mesh& mesh)
{
    std::vector<Index> same(mesh.gridpoint.size());
    for (std::size_t g = 0; g < same.size(); ++g)
        same[g] = static_cast<Index>(g);
    const auto root = [&](Index g) {
        while (same[g] != g)
            g = same[g] = same[same[g]];
        return g;
    };
    for (const auto& g : mesh.zone_gridpoint) {
        same[root(g[1])] = root(g[0]);
        same[root(g[2])] = root(g[0]);
    }
    std::set<Index> roots;
    for (const auto& g : mesh.zone_gridpoint)
        roots.insert(root(g[0]));
    return roots.size();
}

} // namespace

TEST(zone, blocks_on_joints_share_no_gridpoint)
{
    Scene scene = section({{0, 0}, {10, 0}, {10, 10}, {0, 10}}, 0.1);
    scene.zone_size = 2;
    Joints joints;
    add_joint(joints, {-1, 4}, {11, 4});
    add_joint(joints, {3, -1}, {3, 11});
    const Blocks blocks = blocks::cut(scene, joints);
    const Mesh mesh = zoning::zone(scene, blocks);
    expect_sound(blocks, mesh);
    EXPECT_EQ(pieces(mesh), 4u);
    for (std::size_t c = 0; c < mesh.contact_edge.size(); ++c) { // side b is above a level joint
        const Vector2d n = mesh.contact_normal[c];
        const Index j = blocks.edge_joint[mesh.contact_edge[c]];
        EXPECT_NEAR((n - (j == 0 ? Vector2d(0, 1) : Vector2d(-1, 0))).norm(), 0, 1e-12);
    }
}

TEST(zone, bonded_blocks_share_their_gridpoints)
{
    Scene scene = section({{0, 0}, {10, 0}, {10, 10}, {0, 10}}, 0.1);
    scene.zone_size = 2;
    scene.stages.push_back({"cut", 1, {{{5, 3}, {12, 3}, {12, 12}, {5, 12}}}});
    const Blocks blocks = blocks::cut(scene, {});
    const Mesh mesh = zoning::zone(scene, blocks);
    expect_sound(blocks, mesh);
    EXPECT_EQ(blocks.block_area.size(), 2u);
    EXPECT_EQ(pieces(mesh), 1u);
    EXPECT_TRUE(mesh.contact_edge.empty());
}

TEST(zone, a_joint_that_ends_on_a_bonded_edge_leaves_its_tip_whole)
{
    // A level joint from the left side to the middle of a stage outline: the outline holds the two sides
    // together.
    Scene scene = section({{0, 0}, {10, 0}, {10, 10}, {0, 10}}, 0.1);
    scene.zone_size = 2;
    scene.stages.push_back({"cut", 1, {{{5, -1}, {12, -1}, {12, 12}, {5, 12}}}});
    Joints joints;
    add_joint(joints, {-1, 5}, {5, 5});
    const Blocks blocks = blocks::cut(scene, joints);
    const Mesh mesh = zoning::zone(scene, blocks);
    EXPECT_EQ(blocks.block_area.size(), 3u);
    for (const auto& [a, b] : mesh.contact_gridpoint)
        EXPECT_NE(a, b);
    // Here the tip is whole only until the stage: two gridpoints, tied.
    EXPECT_EQ(mesh.tie_stage, (std::vector<Index>{0}));
}

TEST(zone, what_rock_to_be_removed_holds_together_at_one_gridpoint_is_tied_until_then)
{
    // A joint that ends on the outline of a stage, in the face that the stage leaves: when the rock at its
    // tip has gone, nothing may hold its two sides together any more.
    Scene scene = section({{0, 0}, {10, 0}, {10, 10}, {0, 10}}, 0.1);
    scene.zone_size = 2;
    scene.stages.push_back({"cut", 1, {{{5, -1}, {12, -1}, {12, 12}, {5, 12}}}});
    Joints joints;
    add_joint(joints, {-1, 5}, {5, 5});
    const Mesh mesh = zoning::zone(scene, blocks::cut(scene, joints));
    ASSERT_EQ(mesh.tie_gridpoint.size(), 1u);
    EXPECT_EQ(mesh.tie_stage[0], 0);
    for (const Index g : mesh.tie_gridpoint[0])
        EXPECT_EQ(mesh.gridpoint[g], Vector2d(5, 5));
    // With a contact between them that carries the last bit of the joint.
    bool has_contact = false;
    for (const auto& [a, b] : mesh.contact_gridpoint)
        has_contact |= std::minmax(a, b) == std::minmax(mesh.tie_gridpoint[0][0], mesh.tie_gridpoint[0][1]);
    EXPECT_TRUE(has_contact);

    // Without the stage its tip stays whole.
    scene.stages[0].remove = {{{7, -1}, {12, -1}, {12, 12}, {7, 12}}};
    scene.stages.push_back({"never", 2, {{{5, -1}, {5.5, -1}, {5.5, 0.5}, {5, 0.5}}}});
    EXPECT_TRUE(zoning::zone(scene, blocks::cut(scene, joints)).tie_gridpoint.empty());
}

TEST(zone, zones_grow_outside_where_they_are_fine)
{
    Scene scene = section({{0, 0}, {200, 0}, {200, 100}, {0, 100}}, 0.1);
    scene.zone_size = 2;
    const auto longest_and_count = [&scene] {
        Joints joints;
        add_joint(joints, {-1, 40}, {201, 60});
        const Blocks blocks = blocks::cut(scene, joints);
        const Mesh mesh = zoning::zone(scene, blocks);
        expect_sound(blocks, mesh);
        double worst = 0; // longest side over the size that the scene asks for at the zone's middle
        for (const auto& g : mesh.zone_gridpoint) {
            const Vector2d &a = mesh.gridpoint[g[0]], &b = mesh.gridpoint[g[1]], &c = mesh.gridpoint[g[2]];
            const double side = std::max({(a - b).norm(), (b - c).norm(), (c - a).norm()});
            const double x = (a.x() + b.x() + c.x()) / 3; // fine for x below 20
            worst = std::max(worst, side / (2 * (1 + std::max(0.0, x - 20) / 30)));
        }
        return std::pair(worst, mesh.zone_gridpoint.size());
    };
    const auto [even, all] = longest_and_count();
    scene.fine_zones = Polygon{{-5, -5}, {20, -5}, {20, 105}, {-5, 105}};
    scene.zone_coarsening = 30;
    const auto [graded, fewer] = longest_and_count();
    EXPECT_LE(even, 1);
    EXPECT_LE(graded, 1);
    EXPECT_GT(graded, 0.8); // no finer than asked for
    // Zones over an area dA are dA over the size squared: 20 m and 30 (1 - 1 / 7) m of 200 m.
    EXPECT_NEAR(static_cast<double>(fewer) / static_cast<double>(all), (20 + 30 * 6 / 7.0) / 200, 0.06);
}

TEST(zone, zones_are_small_at_faces_that_stages_dig_and_where_something_is_measured)
{
    Scene scene = section({{0, 0}, {100, 0}, {100, 50}, {0, 50}}, 0.1);
    scene.zone_size = 5;
    scene.zone_size_at_faces = 1;
    Joints joints;
    add_joint(joints, {-1, 30}, {101, 35});
    add_joint(joints, {30, -1}, {80, 51});
    // Level and upright stretches that zones are to be small at: {lower left, upper right}.
    using Stretches = std::vector<std::array<Vector2d, 2>>;
    const auto expect_sizes = [&](const Stretches& stretches, const auto& others) {
        const auto size_at = [&](const Vector2d& p) {
            double size = others(p);
            for (const auto& [low, high] : stretches)
                size = std::min(size, 1 + 0.3 * (low - p).cwiseMax(p - high).cwiseMax(0.0).norm());
            return size;
        };
        const Blocks blocks = blocks::cut(scene, joints);
        const Mesh mesh = zoning::zone(scene, blocks);
        expect_sound(blocks, mesh);
        double small = 0, middle = 0, large = 0; // longest side over the size asked for, where that is so
        double wanted = 0;                       // zones, but for a factor: area over the size squared
        for (std::size_t z = 0; z < mesh.zone_gridpoint.size(); ++z) {
            const auto& g = mesh.zone_gridpoint[z];
            const Vector2d &a = mesh.gridpoint[g[0]], &b = mesh.gridpoint[g[1]], &c = mesh.gridpoint[g[2]];
            const double side = std::max({(a - b).norm(), (b - c).norm(), (c - a).norm()});
            const double size = size_at((a + b + c) / 3);
            double& worst = size < 1.2 ? small : size < 5 ? middle : large;
            worst = std::max(worst, side / size);
            wanted += zone_area(mesh, z) / (size * size);
        }
        for (const double worst : {small, middle, large}) {
            EXPECT_LE(worst, 1);
            EXPECT_GT(worst, 0.8);
        }
        return static_cast<double>(mesh.zone_gridpoint.size()) / wanted;
    };
    const auto even = [](const Vector2d&) { return 5.0; };

    // Of the stages' outlines only what is inside the section, without the top; the floor of the first, too.
    scene.stages.push_back({"upper", 1, {{{60, 30}, {110, 30}, {110, 60}, {60, 60}}}});
    scene.stages.push_back({"lower", 2, {{{60, 20}, {110, 20}, {110, 30}, {60, 30}}}});
    Stretches stretches{{{{60, 20}, {60, 50}}}, {{{60, 20}, {100, 20}}}, {{{60, 30}, {100, 30}}}};
    const double at_faces = expect_sizes(stretches, even);

    scene.points = {{"on a side", {0, 10}}};
    scene.gauges = {{"inside", {20, 31}}};
    stretches.push_back({{{0, 10}, {0, 10}}});
    stretches.push_back({{{20, 31}, {20, 31}}});
    expect_sizes(stretches, even);

    // Beside zones that grow of themselves the smaller size counts.
    scene.fine_zones = Polygon{{-5, -5}, {20, -5}, {20, 55}, {-5, 55}};
    scene.zone_coarsening = 30;
    expect_sizes(stretches, [](const Vector2d& p) { return 5 * (1 + std::max(0.0, p.x() - 20) / 30); });
    scene.fine_zones.reset();

    scene.stages.clear();
    stretches.erase(stretches.begin(), stretches.end() - 2);
    const double at_places = expect_sizes(stretches, even);

    scene.points.clear();
    scene.gauges.clear();
    const auto zones = [&] { return zoning::zone(scene, blocks::cut(scene, joints)).zone_gridpoint; };
    const auto nothing_to_be_small_at = zones();
    scene.zone_size_at_faces.reset();
    EXPECT_EQ(nothing_to_be_small_at, zones());

    // About as many zones as if they were all of one size, for what is asked for.
    scene.zone_size = 1;
    const double all = static_cast<double>(zones().size());
    EXPECT_NEAR(at_faces, all / (100 * 50), 0.1 * at_faces); // 5 percent more seen
    EXPECT_NEAR(at_places, all / (100 * 50), 0.1 * at_places);
}

TEST(zone, boundaries_are_held_or_rest_on_the_ground)
{
    Scene scene = section({{0, 0}, {10, 0}, {10, 10}, {0, 10}}, 0.1);
    scene.zone_size = 2;
    scene.boundaries = {{{0, 0}, {10, 0}, false, false, "joint"}, {{0, 0}, {0, 10}, true, false, ""}};
    const Blocks blocks = blocks::cut(scene, {});
    const Mesh mesh = zoning::zone(scene, blocks);
    double length = 0;
    for (std::size_t c = 0; c < mesh.contact_edge.size(); ++c) {
        const auto [ground, rock] = mesh.contact_gridpoint[c];
        EXPECT_EQ(mesh.gridpoint_fixed[ground], 3);
        EXPECT_EQ(mesh.gridpoint[ground], mesh.gridpoint[rock]);
        EXPECT_NEAR(mesh.contact_normal[c].y(), 1, 1e-12); // side b, the rock, is above
        length += mesh.contact_length[c];
    }
    EXPECT_NEAR(length, 10, 1e-12);
    for (std::size_t g = 0; g < mesh.gridpoint.size(); ++g)
        if (mesh.gridpoint_fixed[g] != 3) {
            EXPECT_EQ(mesh.gridpoint_fixed[g], mesh.gridpoint[g].x() == 0 ? 1 : 0);
        }
}

TEST(zone, random_networks)
{
    std::mt19937 random(11);
    std::uniform_real_distribution<double> x(-10, 110);
    for (int i = 0; i < 10; ++i) {
        Scene scene = section({{0, 0}, {100, 0}, {100, 37}, {71.3, 39.1}, {52.7, 80.9}, {0, 83.3}}, 0.1);
        scene.zone_size = 5;
        Joints joints;
        for (int j = 0; j < 25; ++j)
            add_joint(joints, {x(random), -10}, {x(random), 110});
        const Blocks blocks = blocks::cut(scene, joints);
        const Mesh mesh = zoning::zone(scene, blocks);
        expect_sound(blocks, mesh);
        EXPECT_EQ(pieces(mesh), blocks.block_area.size());
        EXPECT_GT(zoning::quality_of(mesh).smallest_altitude, 1e-3);
    }
}

} // namespace zone_test
