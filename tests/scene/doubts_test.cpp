// Warnings of values that are allowed but unusual: each slip is told, and a sound scene is not.

#include "text.hpp"

namespace doubts_test
{

using namespace jointcreep;
using namespace jointcreep::scene;

namespace
{

// A slope of granite: nothing to warn of.
const std::string sound = R"([section]
outline_m = [[0, 0], [60, 0], [60, 40], [0, 40]]
rock = "granite"
gravity_m_per_s2 = 9.81
[[rock]]
name = "granite"
density_kg_per_m3 = 2700
youngs_modulus_GPa = 30
poissons_ratio = 0.25
cohesion_MPa = 1.5
friction_angle_deg = 45
tensile_strength_MPa = 1
[[joint_material]]
name = "joint"
normal_stiffness_MPa_per_m = 5000
shear_stiffness_MPa_per_m = 2000
cohesion_MPa = 0.1
friction_angle_deg = 32
tensile_strength_MPa = 0
[[joint]]
name = "F"
material = "joint"
from_m = [0, 10]
to_m = [60, 30]
[in_situ_stress]
elevation_m = 40
compression_xx_MPa = 0
compression_yy_MPa = 0
shear_xy_MPa = 0
compression_xx_gradient_MPa_per_m = 0.02
compression_yy_gradient_MPa_per_m = 0.026487
shear_xy_gradient_MPa_per_m = 0
[[boundary]]
from_m = [0, 0]
to_m = [60, 0]
fix = "xy"
[[boundary]]
from_m = [0, 0]
to_m = [0, 40]
fix = "x"
[[boundary]]
from_m = [60, 0]
to_m = [60, 40]
fix = "x"
[schedule]
end = 10
[[stage]]
name = "cut"
date = 5
remove_m = [[[40, 30], [60, 30], [60, 40], [40, 40]]]
[[point]]
name = "crest"
at_m = [39, 39]
[zones]
size_m = 3
)";

std::vector<std::string> doubts_of(const std::string& text)
{
    return doubts_about(parse_scene(text, "scene.toml"), text, "scene.toml");
}

// One warning, at the line of `by`, with these words.
void expect_doubt(const std::string& old, const std::string& by, const std::string& part)
{
    const std::string text = replaced(sound, old, by);
    const std::vector<std::string> doubts = doubts_of(text);
    ASSERT_EQ(doubts.size(), 1u) << by;
    expect_part(doubts[0], "scene, " + line_of(text, by.substr(0, by.find('\n'))) + " ");
    expect_part(doubts[0], part);
}

TEST(doubts, none_of_a_sound_scene)
{
    EXPECT_TRUE(doubts_of(sound).empty());
}

TEST(doubts, units_of_rock_and_joints)
{
    expect_doubt("youngs_modulus_GPa = 30", "youngs_modulus_GPa = 3000", "usually has 0.01 to 200 GPa");
    expect_doubt("friction_angle_deg = 45", "friction_angle_deg = 0.785",
                 "it looks like radians or a tangent");
    expect_doubt("friction_angle_deg = 32", "friction_angle_deg = 0.62",
                 "it looks like radians or a tangent");
    expect_doubt("friction_angle_deg = 32", "friction_angle_deg = 80", "usually at most 70 deg");
    expect_doubt("normal_stiffness_MPa_per_m = 5000\nshear_stiffness_MPa_per_m = 2000",
                 "normal_stiffness_MPa_per_m = 5\nshear_stiffness_MPa_per_m = 10",
                 "usually have 10 to 1e+06 MPa/m");
    expect_doubt("shear_stiffness_MPa_per_m = 2000", "shear_stiffness_MPa_per_m = 2",
                 "usually have 10 to 1e+06 MPa/m");
    expect_doubt("normal_stiffness_MPa_per_m = 5000", "normal_stiffness_MPa_per_m = 5e6",
                 "usually have 10 to 1e+06 MPa/m");
    expect_doubt("cohesion_MPa = 1.5", "cohesion_MPa = 1500", "at most 100 MPa");
    expect_doubt("cohesion_MPa = 0.1", "cohesion_MPa = 100", "at most 10 MPa");
    expect_doubt("shear_stiffness_MPa_per_m = 2000", "shear_stiffness_MPa_per_m = 20000",
                 "normal_stiffness_MPa_per_m = 5000");
    const auto doubts = doubts_of(replaced(sound, "density_kg_per_m3 = 2700", "density_kg_per_m3 = 2.7"));
    ASSERT_EQ(doubts.size(), 2u); // and the stress is not its weight
    expect_part(doubts[0], "density_kg_per_m3 = 2.7: rock usually has 1500 to 4000 kg/m3");
    expect_part(doubts[1], "the weight of the rock above is 0.00106 MPa");
}

TEST(doubts, gravity_and_stress)
{
    const std::string yy = "compression_yy_gradient_MPa_per_m = 0.026487";
    expect_doubt(yy, "compression_yy_gradient_MPa_per_m = 0.036",
                 "grows by 1.44 MPa at 40 m of depth, and the weight of the rock above is 1.06 MPa");
    expect_doubt("compression_xx_gradient_MPa_per_m = 0.02", "compression_xx_gradient_MPa_per_m = 0.16",
                 "is 6.04 times the vertical one; usual are 0.2 to 4");
    expect_doubt("compression_xx_gradient_MPa_per_m = 0.02", "compression_xx_gradient_MPa_per_m = 0.004",
                 "is 0.151 times the vertical one");
    const auto tension = doubts_of(replaced(sound, yy, "compression_yy_gradient_MPa_per_m = -0.026487"));
    ASSERT_EQ(tension.size(), 2u);
    expect_part(tension[1], "compression_yy_gradient_MPa_per_m = -0.026487: the vertical stress");
    expect_part(tension[1], "is tension, 1.06 MPa; compression is positive here, expected a positive number");
    const auto datum = doubts_of(replaced(sound, "compression_xx_MPa = 0", "compression_xx_MPa = -3"));
    ASSERT_EQ(datum.size(), 1u);
    expect_part(datum[0],
                "compression_xx_MPa = -3: the horizontal stress at 40 m of depth is tension, 2.2 MPa");
    const auto gravity = doubts_of(replaced(sound, "gravity_m_per_s2 = 9.81", "gravity_m_per_s2 = 0.981"));
    ASSERT_EQ(gravity.size(), 2u);
    expect_part(gravity[0], "on Earth it is 9.81 m/s2");
    const auto both = doubts_of(replaced(replaced(sound, "compression_xx_MPa = 0", "compression_xx_MPa = -5"),
                                         "compression_yy_MPa = 0", "compression_yy_MPa = -1.5"));
    ASSERT_FALSE(both.empty());
    expect_part(both[0],
                "compression_yy_MPa = -1.5: the vertical stress at 40 m of depth is tension, 0.441 MPa");
    const std::string weightless = replaced(sound, "gravity_m_per_s2 = 9.81", "gravity_m_per_s2 = 0");
    const auto grows = doubts_of(weightless);
    ASSERT_EQ(grows.size(), 1u);
    expect_part(grows[0],
                "gravity_m_per_s2 = 0: rock has no weight, but the in-situ stress grows with depth");
    EXPECT_TRUE(doubts_of(replaced(weightless, yy, "compression_yy_gradient_MPa_per_m = 0")).empty())
        << "a test of loads";
}

TEST(doubts, a_datum_below_the_top)
{
    expect_doubt("elevation_m = 40", "elevation_m = 25",
                 "the section reaches 15 m above it, where the stress is tension");
}

TEST(doubts, stress_on_a_free_surface)
{
    expect_doubt(
        "elevation_m = 40", "elevation_m = 46",
        "the stress on the outline at [54, 40] m is 0.159 MPa in a direction in which no [[boundary]] supports or loads it");
    EXPECT_TRUE(doubts_of(replaced(sound, "elevation_m = 40", "elevation_m = 44")).empty()) << "little cover";
    const std::string load =
        "[[boundary]]\nfrom_m = [60, 40]\nto_m = [0, 40]\ntraction_MPa = [0, -0.158922]\n[schedule]";
    EXPECT_TRUE(
        doubts_of(replaced(replaced(sound, "elevation_m = 40", "elevation_m = 46"), "[schedule]", load))
            .empty());
}

TEST(doubts, tensile_strength_zones_and_creep)
{
    expect_doubt("tensile_strength_MPa = 1\n", "tensile_strength_MPa = 1000\n", "at most 50 MPa");
    expect_doubt("tensile_strength_MPa = 0\n", "tensile_strength_MPa = 100\n", "at most 10 MPa");
    expect_doubt("size_m = 3", "size_m = 50", "zones are as large as the section, 40 m");
    const std::string creep = "size_m = 3\n[creep]\ntolerance_m = ";
    EXPECT_TRUE(doubts_of(replaced(sound, "size_m = 3", creep + "1e-4")).empty());
    const auto coarse = doubts_of(replaced(sound, "size_m = 3", creep + "0.1"));
    ASSERT_EQ(coarse.size(), 1u);
    expect_part(coarse[0], "the allowed error of a step is 100 mm; usual are 0.001 to 0.1 mm");
    const std::string unit =
        "tensile_strength_MPa = 0\nnormal_kelvin_stiffness_MPa_per_m = 2000\n"
        "normal_kelvin_viscosity_MPa_day_per_m = VISCOSITY\nshear_kelvin_stiffness_MPa_per_m = 2000\n"
        "shear_kelvin_viscosity_MPa_day_per_m = 2e4";
    const std::string creeping =
        replaced(replaced(sound, "tensile_strength_MPa = 0", unit), "size_m = 3", creep + "1e-4");
    EXPECT_TRUE(doubts_of(replaced(creeping, "VISCOSITY", "1e6")).empty());
    const auto slow = doubts_of(replaced(creeping, "VISCOSITY", "8.64e10"));
    ASSERT_EQ(slow.size(), 1u);
    expect_part(slow[0], "is 43200000 days, and the scene lasts 10: this unit hardly creeps");
    const auto fast = doubts_of(replaced(creeping, "VISCOSITY", "1"));
    ASSERT_EQ(fast.size(), 1u);
    expect_part(fast[0], "is 5e-04 days, and the scene lasts 10: this unit creeps at once");
}

TEST(doubts, points_in_rock_that_is_excavated)
{
    expect_doubt("at_m = [39, 39]", "at_m = [41, 39]", "in rock that stage \"cut\" excavates");
    EXPECT_TRUE(doubts_of(replaced(sound, "at_m = [39, 39]", "at_m = [40, 35]")).empty())
        << "on the new face";
    const std::string line =
        "[[monitoring_line]]\nname = \"L\"\nfrom_m = [30, 35]\nto_m = [50, 35]\npoints = 3\n[zones]";
    const auto doubts = doubts_of(replaced(sound, "[zones]", line));
    ASSERT_EQ(doubts.size(), 1u);
    expect_part(
        doubts[0],
        "[[monitoring_line]] \"L\" from_m = [30, 35]: 1 of its 3 points are in rock that is excavated");
}

TEST(doubts, angles_in_radians_and_shares)
{
    const std::string azimuth = "gravity_m_per_s2 = 9.81\nazimuth_deg = ", set = R"([[joint_set]]
name = "S"
material = "joint"
dip = { law = "constant", mean_deg = DIP }
dip_direction = { law = "constant", mean_deg = 90 }
spacing = { law = "constant", mean_m = 5 }
length = { law = "constant", mean_m = 5 }
persistence = SHARE
[random]
seed = 1
[in_situ_stress])";
    const std::string joints = replaced(sound, "[in_situ_stress]", set);
    const auto doubts = [&](const std::string& bearing, const std::string& dip, const std::string& share) {
        return doubts_of(
            replaced(replaced(replaced(joints, "gravity_m_per_s2 = 9.81", azimuth + bearing), "DIP", dip),
                     "SHARE", share));
    };
    EXPECT_TRUE(doubts("90", "55", "0.7").empty());
    EXPECT_TRUE(doubts("5", "1", "0.7").empty());
    for (const auto& [found, part] :
         {std::pair{doubts("1.5708", "55", "0.7"), "azimuth_deg = 1.5708: the bearing is in degrees"},
          {doubts("90", "0.96", "0.7"), "the mean dip is in degrees; it looks like radians"},
          {doubts("90", "55", "0.007"), "the part of the line that is joint"}}) {
        ASSERT_EQ(found.size(), 1u) << part;
        expect_part(found[0], part);
    }
}

} // namespace

} // namespace doubts_test
