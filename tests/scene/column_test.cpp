// The paper's column reads as the numbers it is written with.

#include "model/units.hpp"
#include "scene/scene.hpp"

#include <gtest/gtest.h>

namespace column_test
{

using namespace jointcreep;
using namespace jointcreep::scene;
using namespace jointcreep::unit;

namespace
{

const Scene column = parse_scene(read_scene_text(SOURCE_FOLDER "data/column/scene.toml"), "scene.toml");

TEST(column, section)
{
    EXPECT_EQ(column.title, "The paper's column: four blocks on creeping joints, three of them removed");
    EXPECT_EQ(column.outline, (Polygon{{0, 0}, {10, 0}, {10, 40}, {0, 40}}));
    EXPECT_EQ(column.rock, "rock");
    EXPECT_EQ(column.gravity, 9.81);
    EXPECT_FALSE(column.azimuth);
    EXPECT_TRUE(column.regions.empty());
    EXPECT_TRUE(column.joint_sets.empty());
}

TEST(column, rock)
{
    ASSERT_EQ(column.rocks.size(), 1u);
    EXPECT_EQ(column.rocks[0].name, "rock");
    EXPECT_EQ(column.rocks[0].density, 2750 * kg);
    EXPECT_EQ(column.rocks[0].youngs_modulus, 40 * GPa);
    EXPECT_EQ(column.rocks[0].poissons_ratio, 0.22);
    EXPECT_FALSE(column.rocks[0].strength);
}

TEST(column, joint_materials)
{
    ASSERT_EQ(column.joint_materials.size(), 2u);
    const JointMaterial& joint = column.joint_materials[0];
    EXPECT_EQ(joint.name, "joint");
    EXPECT_EQ(joint.normal_stiffness, 690 * MPa / m);
    EXPECT_EQ(joint.shear_stiffness, 280 * MPa / m);
    EXPECT_EQ(joint.cohesion, 0);
    EXPECT_EQ(joint.friction_angle, 45 * deg);
    EXPECT_EQ(joint.tensile_strength, 0);
    ASSERT_EQ(joint.kelvin.size(), 1u);
    EXPECT_EQ(joint.kelvin[0].normal_stiffness, 690 * MPa / m);
    EXPECT_EQ(joint.kelvin[0].normal_viscosity, 6900 * (MPa * day / m));
    EXPECT_EQ(joint.kelvin[0].shear_stiffness, 690 * MPa / m);
    EXPECT_EQ(joint.kelvin[0].shear_viscosity, 6900 * (MPa * day / m));
    EXPECT_EQ(column.joint_materials[1].name, "base joint");
    EXPECT_EQ(column.joint_materials[1].shear_stiffness, 0);
}

TEST(column, joints_and_boundary)
{
    ASSERT_EQ(column.joints.size(), 3u);
    EXPECT_EQ(column.joints[2].name, "joint under block 3");
    EXPECT_EQ(column.joints[2].material, "joint");
    EXPECT_EQ(column.joints[2].from, Eigen::Vector2d(0, 10));
    EXPECT_EQ(column.joints[2].to, Eigen::Vector2d(10, 10));
    ASSERT_EQ(column.boundaries.size(), 1u);
    EXPECT_EQ(column.boundaries[0].joint, "base joint");
    EXPECT_FALSE(column.boundaries[0].fix_x);
    EXPECT_FALSE(column.boundaries[0].fix_y);
}

TEST(column, stress_is_the_weight_above)
{
    const Eigen::Vector3d at_base = column.in_situ_stress.at({5, 0});
    EXPECT_EQ(at_base[0], 0);
    EXPECT_NEAR(at_base[1], -2750 * 9.81 * 40, 1e-6);
    EXPECT_EQ(at_base[2], 0);
    EXPECT_NEAR(column.in_situ_stress.at({5, 40})[1], 0, 1e-6);
}

TEST(column, times_and_places)
{
    EXPECT_EQ(column.end, 40 * day);
    ASSERT_EQ(column.stages.size(), 3u);
    EXPECT_EQ(column.stages[0].time, 1 * day);
    EXPECT_EQ(column.stages[1].time, 10 * day);
    EXPECT_EQ(column.stages[2].time, 20 * day);
    EXPECT_EQ(column.stages[2].name, "block 3 removed");
    EXPECT_EQ(column.stages[2].remove, (std::vector<Polygon>{{{0, 10}, {10, 10}, {10, 20}, {0, 20}}}));
    ASSERT_EQ(column.points.size(), 3u);
    EXPECT_EQ(column.points[2].name, "C");
    EXPECT_EQ(column.points[2].at, Eigen::Vector2d(5, 5));
    EXPECT_EQ(column.points[2].first_reading, 0);
    ASSERT_EQ(column.gauges.size(), 1u);
    EXPECT_EQ(column.gauges[0].at, Eigen::Vector2d(5, 10));
}

TEST(column, settings_and_their_defaults)
{
    ASSERT_TRUE(column.creep);
    EXPECT_EQ(column.creep->step, 1 * day);
    EXPECT_EQ(column.creep->scheme, CreepScheme::published);
    EXPECT_FALSE(column.creep->stop_rate);
    EXPECT_EQ(column.zone_size, 2.5);
    EXPECT_EQ(column.equilibrium.masses, Masses::real);
    EXPECT_EQ(column.equilibrium.damping, Damping::mass);
    EXPECT_EQ(column.equilibrium.mass_damping, 140);
    EXPECT_EQ(column.equilibrium.tolerance, 1e-6);
    EXPECT_EQ(column.equilibrium.local_damping, 0.8);
    EXPECT_EQ(column.equilibrium.unloading_increments, 1);
    EXPECT_EQ(column.equilibrium.most_steps, 1000000);
    EXPECT_EQ(column.cutting.shortest_edge, 0.02 * 2.5);
    EXPECT_EQ(column.cutting.smallest_angle, 1 * deg);
    EXPECT_EQ(column.seed, 0u);
}

} // namespace

} // namespace column_test
