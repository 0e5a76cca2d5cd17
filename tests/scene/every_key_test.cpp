// What the column leaves out: sets and their laws, regions, dates, and every table that may be left out.

#include "model/units.hpp"
#include "text.hpp"

namespace every_key_test
{

using namespace jointcreep;
using namespace jointcreep::scene;
using namespace jointcreep::unit;

namespace
{

TEST(every_key, sets_and_laws)
{
    const Scene scene = parse_scene(every_key_text(), "scene.toml");
    EXPECT_EQ(scene.azimuth, 20 * deg);
    ASSERT_EQ(scene.joint_sets.size(), 11u);
    const JointSet &steep = scene.joint_sets[0], &flat = scene.joint_sets[1];

    EXPECT_FALSE(steep.trace_angle);
    ASSERT_TRUE(steep.dip && steep.dip_direction);
    EXPECT_EQ(steep.dip->kind, ProbabilityLaw::Kind::normal);
    EXPECT_EQ(steep.dip->mean, 70 * deg);
    EXPECT_EQ(steep.dip->deviation, 3 * deg);
    EXPECT_EQ(steep.dip_direction->mean, 20 * deg);
    EXPECT_EQ(steep.spacing.kind, ProbabilityLaw::Kind::lognormal);
    EXPECT_EQ(steep.spacing.mean, 5);
    EXPECT_EQ(steep.spacing.deviation, 1);
    EXPECT_EQ(steep.persistence, 0.6);
    EXPECT_FALSE(steep.region);
    ASSERT_EQ(steep.material_in.size(), 1u);
    EXPECT_EQ(steep.material_in[0].rock, "soft");
    EXPECT_EQ(steep.material_in[0].material, "gouge");
    EXPECT_TRUE(flat.material_in.empty());

    ASSERT_TRUE(flat.trace_angle && flat.length && flat.region);
    EXPECT_EQ(flat.trace_angle->mean, 10 * deg);
    EXPECT_EQ(flat.spacing.kind, ProbabilityLaw::Kind::normal);
    EXPECT_EQ(flat.length->kind, ProbabilityLaw::Kind::negative_exponential);
    EXPECT_EQ(flat.length->mean, 8);
    EXPECT_EQ(flat.length->deviation, 8) << "the mean, by its law";
    EXPECT_EQ(flat.region->size(), 4u);
    EXPECT_EQ(scene.seed, 1u);
}

TEST(every_key, uniform_and_fisher_laws)
{
    const Scene scene = parse_scene(every_key_text(), "scene.toml");
    const JointSet &even = scene.joint_sets.at(2), &in_space = scene.joint_sets.at(3),
                   &about = scene.joint_sets.at(4);
    EXPECT_EQ(even.persistence, 0.5) << "5 m of 5 m + 5 m";
    const auto expect_uniform = [](const std::optional<ProbabilityLaw>& law, double least, double most) {
        ASSERT_TRUE(law);
        EXPECT_EQ(law->kind, ProbabilityLaw::Kind::uniform);
        EXPECT_DOUBLE_EQ(law->least, least);
        EXPECT_DOUBLE_EQ(law->most, most);
        EXPECT_DOUBLE_EQ(law->mean, (least + most) / 2);
        EXPECT_NEAR(law->deviation, (most - least) / std::sqrt(12), 1e-15);
    };
    expect_uniform(even.trace_angle, -65 * deg, -55 * deg);
    expect_uniform(even.spacing, 12, 18);
    expect_uniform(even.length, 1, 9);
    expect_uniform(in_space.dip, 34 * deg, 46 * deg);
    expect_uniform(in_space.dip_direction, 185 * deg, 215 * deg);
    ASSERT_TRUE(about.orientation);
    EXPECT_EQ(about.orientation->dip, 50 * deg);
    EXPECT_EQ(about.orientation->dip_direction, 30 * deg);
    EXPECT_EQ(about.orientation->concentration, 60);
    EXPECT_EQ(about.spacing.kind, ProbabilityLaw::Kind::power);
    EXPECT_EQ(about.spacing.exponent, 2);
    EXPECT_EQ(about.spacing.least, 10);
    EXPECT_EQ(about.spacing.most, 30);
    EXPECT_DOUBLE_EQ(about.spacing.mean, 15 * std::log(3)); // log(r) / (1 - 1/r) x shortest
    EXPECT_EQ(about.length->exponent, 2.5);
    EXPECT_FALSE(about.trace_angle || about.dip || about.dip_direction);
}

TEST(every_key, kinds_densities_and_terminations)
{
    const Scene scene = parse_scene(every_key_text(), "scene.toml");
    using Measure = Density::Measure;
    EXPECT_EQ(scene.joint_sets.at(0).kind, SetKind::lines);
    EXPECT_FALSE(scene.joint_sets.at(0).density);
    const JointSet& measured = scene.joint_sets.at(5);
    EXPECT_EQ(measured.kind, SetKind::segments);
    EXPECT_EQ(measured.terminates_at, (std::vector<std::string>{"fault", "flat"}));
    EXPECT_EQ(measured.termination_probability, .7);
    EXPECT_EQ(measured.rocks, std::vector<std::string>{"hard"});
    ASSERT_EQ(measured.poles.size(), 3u);
    EXPECT_EQ(measured.poles[1].dip, 64 * deg);
    EXPECT_EQ(measured.poles[1].dip_direction, 52 * deg);
    // Pole and scanline by east, north and up.
    const auto direction = [](double bearing, double inclination) {
        return Eigen::Vector3d(std::cos(inclination) * std::sin(bearing),
                               std::cos(inclination) * std::cos(bearing), -std::sin(inclination));
    };
    const Eigen::Vector3d pole = -direction((52 + 180) * deg, (90 - 64) * deg);
    EXPECT_NEAR(measured.poles[1].weight, 1 / std::abs(pole.dot(direction(30 * deg, 10 * deg))), 1e-12);
    const JointSet& coins = scene.joint_sets.at(6);
    EXPECT_EQ(coins.kind, SetKind::discs);
    ASSERT_EQ(coins.poles.size(), 2u);
    EXPECT_EQ(coins.poles[1].weight, 2);
    EXPECT_EQ(coins.density->measure, Measure::p30);
    EXPECT_EQ(coins.density->value, .0002);
    EXPECT_EQ(coins.diameter->deviation, 3);
    EXPECT_EQ(scene.joint_sets.at(7).density->measure, Measure::p10);
    EXPECT_EQ(scene.joint_sets.at(7).density->scanline.angle, 0);
    EXPECT_EQ(scene.joint_sets.at(7).spacing.kind, ProbabilityLaw::Kind::negative_exponential);
    EXPECT_FALSE(scene.joint_sets.at(8).density->scanline.angle);
    EXPECT_EQ(scene.joint_sets.at(8).density->scanline.trend, 25 * deg);
    EXPECT_EQ(scene.joint_sets.at(8).density->scanline.plunge, 5 * deg);
    EXPECT_EQ(scene.joint_sets.at(9).density->measure, Measure::p21);
    EXPECT_EQ(scene.joint_sets.at(10).density->measure, Measure::p32);

    ASSERT_EQ(scene.mapped.size(), 2u);
    EXPECT_EQ(scene.mapped[0].name, "on the map");
    ASSERT_EQ(scene.mapped[0].traces.size(), 1u);
    EXPECT_EQ(scene.mapped[0].traces[0].polylines[0][1], Eigen::Vector2d(12, 0));
    EXPECT_EQ(scene.mapped[1].traces.at(0).polylines.at(0).at(1), Eigen::Vector2d(36, 7)); // of its layer
}

TEST(every_key, all_else)
{
    const Scene scene = parse_scene(every_key_text(), "scene.toml");
    ASSERT_TRUE(scene.rocks[1].strength);
    EXPECT_EQ(scene.rocks[1].strength->cohesion, 0.5 * MPa);
    EXPECT_EQ(scene.rocks[1].strength->friction_angle, 35 * deg);
    EXPECT_EQ(scene.rocks[1].strength->tensile_strength, 0.2 * MPa);
    EXPECT_EQ(scene.rocks[1].dilation_angle, 8 * deg);
    EXPECT_EQ(scene.rocks[0].dilation_angle, 0);
    EXPECT_EQ(scene.joint_materials.at(1).dilation_angle, 5 * deg);
    EXPECT_EQ(scene.joint_materials.at(1).dilation_until, 0.02);
    EXPECT_EQ(scene.joint_materials.at(0).dilation_until, 0);
    EXPECT_EQ(scene.joint_materials.at(0).law, 0);
    ASSERT_EQ(scene.joint_materials.at(1).law, 1); // residual strength
    EXPECT_EQ(scene.joint_materials.at(1).own.at("residual_cohesion"), 0.05 * MPa);
    EXPECT_EQ(scene.joint_materials.at(1).own.at("residual_friction_angle"), 20 * deg);
    ASSERT_EQ(scene.joint_materials.at(3).law, 3);                                // wearing dilation
    EXPECT_DOUBLE_EQ(scene.joint_materials.at(3).own.at("dilation_wear"), 20e-6); // m2/J
    ASSERT_EQ(scene.joint_materials.at(4).law, 4);                                // continuously yielding
    EXPECT_EQ(scene.joint_materials.at(4).own.at("initial_friction_angle"), 45 * deg);
    EXPECT_EQ(scene.joint_materials.at(4).own.at("roughness_length"), 0.002);
    ASSERT_TRUE(scene.rocks[0].kelvin && scene.rocks[0].maxwell_viscosity);
    EXPECT_EQ(scene.rocks[0].kelvin->modulus, 20 * GPa);
    EXPECT_EQ(scene.rocks[0].kelvin->viscosity, 2000 * (GPa * day));
    EXPECT_EQ(scene.rocks[0].maxwell_viscosity, 1e6 * (GPa * day));
    EXPECT_FALSE(scene.rocks[1].kelvin || scene.rocks[1].maxwell_viscosity);
    const JointMaterial& gouge = scene.joint_materials.at(1);
    ASSERT_EQ(gouge.kelvin.size(), 1u);
    EXPECT_EQ(gouge.kelvin[0].normal_stiffness, 900 * MPa / m);
    EXPECT_EQ(gouge.kelvin[0].shear_viscosity, 1e4 * (MPa * day / m));
    ASSERT_TRUE(gouge.maxwell);
    EXPECT_EQ(gouge.maxwell->normal_viscosity, 1e6 * (MPa * day / m));
    EXPECT_EQ(gouge.maxwell->shear_viscosity, 5e5 * (MPa * day / m));
    EXPECT_FALSE(scene.joint_materials[0].maxwell);
    EXPECT_EQ(scene.regions.at(0).rock, "soft");
    EXPECT_TRUE(scene.boundaries.at(1).fix_x);
    EXPECT_FALSE(scene.boundaries.at(1).fix_y);
    EXPECT_EQ(scene.creep->stop_rate, 0.001 * (mm / day));
    EXPECT_EQ(scene.creep->step, 5 * day);
    EXPECT_EQ(scene.creep->scheme, CreepScheme::published);
    EXPECT_FALSE(scene.creep->tolerance);
    EXPECT_EQ(scene.equilibrium.engine, EngineChoice::relaxation);
    ASSERT_TRUE(scene.fine_zones);
    EXPECT_EQ((*scene.fine_zones)[1], Eigen::Vector2d(35, 5));
    EXPECT_EQ(scene.zone_coarsening, 10);
    EXPECT_EQ(scene.zone_size_at_faces, 2);
    EXPECT_EQ(scene.cutting.shortest_edge, 0.2);
    EXPECT_EQ(scene.cutting.smallest_angle, 3 * deg);
    EXPECT_EQ(scene.averaging.over, AverageOver::line);
    EXPECT_EQ(scene.averaging.stiffness, StiffnessRule::lower_bound);
    EXPECT_EQ(scene.cutting.dangling_ends, DanglingEnds::extend);
    ASSERT_EQ(scene.holes.size(), 1u);
    EXPECT_EQ(scene.holes[0][2], Eigen::Vector2d(5, 16));
    EXPECT_EQ(scene.equilibrium.tolerance, 1e-5);
    EXPECT_EQ(scene.equilibrium.unloading_increments, 2);
    EXPECT_EQ(scene.equilibrium.increments_tolerance, 0.02);
    EXPECT_EQ(scene.equilibrium.most_steps, 100000);
    EXPECT_FALSE(scene.stages.at(0).reset_displacements);
    EXPECT_TRUE(scene.stages.at(1).reset_displacements);
}

TEST(every_key, creep_by_tolerance)
{
    const auto text = replaced(every_key_text(), "step_days = 5\nscheme = \"published\"",
                               "tolerance_m = 1e-5\nfirst_step_days = 0.5\nshortest_step_days = 0.1\n"
                               "longest_step_days = 10");
    const Scene scene = parse_scene(text, "scene.toml");
    EXPECT_FALSE(scene.creep->step);
    EXPECT_EQ(scene.creep->scheme, CreepScheme::automatic);
    EXPECT_EQ(scene.creep->tolerance, 1e-5);
    EXPECT_EQ(scene.creep->first_step, 0.5 * day);
    EXPECT_EQ(scene.creep->shortest_step, 0.1 * day);
    EXPECT_EQ(scene.creep->longest_step, 10 * day);
}

TEST(every_key, kelvin_units_of_a_chain_keep_their_order)
{
    const auto text = replaced(every_key_text(), "kelvin_chain = [{",
                               "kelvin_chain = [{ normal_stiffness_MPa_per_m = 1, "
                               "normal_viscosity_MPa_day_per_m = 2, shear_stiffness_MPa_per_m = 3, "
                               "shear_viscosity_MPa_day_per_m = 4 }, {");
    const JointMaterial gouge = parse_scene(text, "scene.toml").joint_materials.at(1);
    ASSERT_EQ(gouge.kelvin.size(), 2u);
    EXPECT_EQ(gouge.kelvin[0].normal_stiffness, 1 * MPa / m);
    EXPECT_EQ(gouge.kelvin[0].normal_viscosity, 2 * (MPa * day / m));
    EXPECT_EQ(gouge.kelvin[0].shear_stiffness, 3 * MPa / m);
    EXPECT_EQ(gouge.kelvin[0].shear_viscosity, 4 * (MPa * day / m));
    EXPECT_EQ(gouge.kelvin[1].normal_stiffness, 900 * MPa / m);
}

TEST(every_key, optional_tables_may_be_left_out)
{
    auto text = every_key_text();
    text.erase(text.find("[cutting]"), text.find("[random]") - text.find("[cutting]"));
    text.erase(text.find("[creep]"), text.find("[zones]") - text.find("[creep]"));
    text.erase(text.find("[[stage]]"), text.find("[zones]") - text.find("[[stage]]"));
    const Scene scene = parse_scene(text, "scene.toml");
    EXPECT_FALSE(scene.creep);
    EXPECT_TRUE(scene.stages.empty() && scene.points.empty() && scene.gauges.empty());
    EXPECT_EQ(scene.cutting.shortest_edge, 0.02 * 2) << "of size_at_faces_m";
    EXPECT_EQ(scene.averaging.over, AverageOver::edge);
    EXPECT_EQ(scene.averaging.stiffness, StiffnessRule::joint);
    EXPECT_EQ(scene.equilibrium.tolerance, 1e-6);
    EXPECT_EQ(scene.equilibrium.damping, Damping::adaptive);
    EXPECT_EQ(scene.equilibrium.masses, Masses::scaled);
    EXPECT_EQ(scene.equilibrium.engine, EngineChoice::automatic);
}

TEST(every_key, a_fully_persistent_set_needs_neither_length_nor_strength)
{
    auto text = every_key_text();
    for (const char* key :
         {"cohesion_MPa = 1.5\n", "friction_angle_deg = 45\n", "tensile_strength_MPa = 1\n",
          "length = { law = \"lognormal\", mean_m = 6, deviation_m = 2 }\n", "dangling_ends = \"extend\"\n"})
        text = replaced(text, key, "");
    text = replaced(text, "persistence = 0.6", "persistence = 1");
    text = replaced(text, "persistence = 0.8", "persistence = 1");
    text = replaced(text, "bridge_length_m = 5", "persistence = 1");
    text = replaced(text, "persistence = 0.9", "persistence = 1");
    const Scene scene = parse_scene(text, "scene.toml");
    EXPECT_FALSE(scene.rocks[0].strength);
    EXPECT_FALSE(scene.joint_sets[0].length);
}

} // namespace

} // namespace every_key_test
