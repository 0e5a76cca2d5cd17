// The number of zones is known before they are made.

#include "zoning/cost.hpp"

#include "blocks/cut.hpp"
#include "model/error.hpp"
#include "sampling/joint_sets.hpp"
#include "scene/scene.hpp"
#include "zoning/zone.hpp"

#include "../blocks/section.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <tuple>

namespace cost_test
{

using namespace jointcreep;
using namespace jointcreep::test;

namespace
{

Blocks blocks_of(const Scene& scene)
{
    return blocks::cut(scene, sampling::sample_joints(scene, scene.seed, 0));
}

// Expected over made.
double ratio(const Scene& scene, const Blocks& blocks)
{
    const auto made = static_cast<double>(zoning::zone(scene, blocks).zone_block.size());
    return zoning::expected_zones(scene, blocks) / made;
}

std::string refusal_of(const Scene& scene, const Blocks& blocks)
{
    try {
        zoning::check_cost(scene, blocks, "scene.toml");
    } catch (const input_error& error) {
        return error.what();
    }
    return "";
}

Scene square(double zone_size)
{
    Scene scene = section({{0, 0}, {10, 0}, {10, 20}, {0, 20}}, 0.01);
    scene.zone_size = zone_size;
    return scene;
}

} // namespace

// Zones along strips are as short as the strips are thin.
TEST(cost, number_of_zones_of_strips)
{
    for (const double thickness : {0.5, 1.0}) {
        Scene scene = section({{0, 0}, {100, 0}, {100, 50}, {0, 50}}, 0.01);
        scene.zone_size = 10;
        Joints joints;
        for (int i = 0; i < 40; ++i)
            add_joint(joints, {-1, 10 + thickness * i}, {101, 10 + thickness * i});
        EXPECT_NEAR(ratio(scene, blocks::cut(scene, joints)), 1, 0.4) << thickness;
    }
}

// Where there are enough of them that it matters. Seen: 0.87 to 1.15.
TEST(cost, number_of_zones_in_the_sections_of_data)
{
    int sections = 0;
    for (const auto& file : std::filesystem::recursive_directory_iterator(SOURCE_FOLDER "data")) {
        if (file.path().extension() != ".toml" || file.path().filename() == "targets.toml" ||
            file.path().filename() == "study.toml")
            continue;
        SCOPED_TRACE(file.path().string());
        Scene scene = scene::parse_scene(scene::read_scene_text(file.path().string()), file.path().string());
        const Blocks blocks = blocks_of(scene);
        for (int halving = 0; halving < 3; ++halving) {
            if (zoning::expected_zones(scene, blocks) > 1000) {
                ++sections;
                EXPECT_NEAR(ratio(scene, blocks), 1, 0.2) << scene.zone_size;
            }
            scene.zone_size /= 2;
            if (scene.zone_size_at_faces)
                *scene.zone_size_at_faces /= 2;
        }
    }
    EXPECT_GT(sections, 20);
}

TEST(cost, number_of_zones_of_changing_size)
{
    Scene scene = square(1);
    scene.points = {{"point", {3, 4}}};
    scene.stages = {{"stage", 0, {{{0, 15}, {10, 15}, {10, 20}, {0, 20}}}}};
    const Blocks blocks = blocks_of(scene);
    scene.zone_size_at_faces = 0.02;
    EXPECT_NEAR(ratio(scene, blocks), 1, 0.25);
    scene.zone_size_at_faces.reset();
    scene.zone_size = 0.1;
    scene.fine_zones = Polygon{{2, 2}, {6, 2}, {6, 6}, {2, 6}};
    scene.zone_coarsening = 0.5;
    EXPECT_NEAR(ratio(scene, blocks), 1, 0.25);
}

TEST(cost, number_of_zones_in_blocks_smaller_than_zones)
{
    const Scene scene = square(1);
    Joints joints;
    for (int i = 1; i < 40; ++i) {
        add_joint(joints, {0.25 * i, 0}, {0.25 * i, 20});
        add_joint(joints, {0, 0.5 * i}, {10, 0.5 * i});
    }
    const double found = ratio(scene, blocks::cut(scene, joints));
    EXPECT_GT(found, 0.7);
    EXPECT_LT(found, 2);
}

TEST(cost, too_many_zones_are_refused_with_a_size_that_is_not)
{
    const Scene tiny = square(1e-9);
    const Blocks blocks = blocks_of(tiny);
    EXPECT_EQ(refusal_of(tiny, blocks),
              "scene.toml: [zones] size_m is 1e-09 m: about 1e+21 zones; expected at most 2e+07. Set size_m "
              "to 0.0075 m or more");
    EXPECT_EQ(refusal_of(square(0.0075), blocks), "");
    EXPECT_NE(refusal_of(square(0.007), blocks), "");
}

TEST(cost, a_size_at_faces_counts)
{
    Scene scene = square(1);
    scene.stages = {{"stage", 0, {{{0, 15}, {10, 15}, {10, 20}, {0, 20}}}}};
    const Blocks blocks = blocks_of(scene);
    scene.zone_size_at_faces = 1e-7;
    const std::string refusal = refusal_of(scene, blocks);
    EXPECT_NE(refusal.find("size_at_faces_m 1e-07 m"), std::string::npos) << refusal;
    scene.zone_size_at_faces = 0.01;
    EXPECT_EQ(refusal_of(scene, blocks), "");
}

TEST(cost, many_zones_are_warned_of)
{
    const Blocks blocks = blocks_of(square(1));
    for (const auto& [is_quadratic, size, few, words] :
         {std::tuple(false, 0.02, 0.04, "about 2.5e+06 zones. They need about 5.8 GB"),
          std::tuple(true, 0.05, 0.1, "about 4e+05 zones. They need about 4.4 GB")}) {
        Scene scene = square(few);
        scene.asks_for_quadratic_zones = is_quadratic;
        EXPECT_EQ(zoning::check_cost(scene, blocks, "scene.toml"), "");
        scene.zone_size = size;
        const std::string warning = zoning::check_cost(scene, blocks, "scene.toml");
        EXPECT_NE(warning.find(words), std::string::npos) << warning;
    }
}

} // namespace cost_test
