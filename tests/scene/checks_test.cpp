// Each thing a scene must hold beyond the range of its keys, broken once in a scene that is valid otherwise.

#include "text.hpp"

#include <filesystem>
#include <fstream>

namespace checks_test
{

using namespace jointcreep;
using namespace jointcreep::scene;

namespace
{

const std::string text = every_key_text();

// Replacing `old` by `by` is refused at the line where `by` begins, with `wanted` in the message.
void expect_refused(const std::string& old, const std::string& by, const std::string& wanted,
                    const std::string& at = "")
{
    const auto broken = replaced(text, old, by);
    const auto message = refusal(broken);
    expect_part(message, wanted);
    expect_part(message, "scene.toml, " + line_of(broken, at.empty() ? by : at));
}

std::string without(const std::string& table)
{
    const auto at = text.find(table);
    const auto next = std::min(text.find("\n[", at), text.size());
    return text.substr(0, at) + text.substr(next);
}

TEST(checks, the_scene_is_valid)
{
    EXPECT_EQ(refusal(text), "accepted");
}

TEST(checks, a_value_is_refused_with_its_unit_and_range)
{
    expect_refused("gravity_m_per_s2 = 9.81", "gravity_m_per_s2 = -1",
                   "[section] gravity_m_per_s2 = -1 m/s2: expected a number in [0, 100] m/s2");
    expect_refused("poissons_ratio = 0.3", "poissons_ratio = 0.5",
                   "[[rock]] \"soft\" poissons_ratio = 0.5: expected a number in [0, 0.5)");
    expect_refused("density_kg_per_m3 = 2400", "density_kg_per_m3 = 0",
                   "[[rock]] \"soft\" density_kg_per_m3 = 0 kg/m3: expected a number in (0, 30000] kg/m3");
    expect_refused("mean_deg = 70", "mean_deg = 91",
                   "[[joint_set]] dip mean_deg = 91 deg: expected a number in [0, 90] deg");
}

TEST(checks, an_unknown_key_is_refused_with_the_nearest)
{
    expect_refused("gravity_m_per_s2 = 9.81", "gravity = 9.81\ngravity_m_per_s2 = 9.81",
                   "[section] has no key \"gravity\"");
    expect_refused("density_kg_per_m3", "density_kg_per_m", "did you mean density_kg_per_m3?");
    expect_refused("density_kg_per_m3", "density", "did you mean density_kg_per_m3?");
    expect_refused("poissons_ratio = 0.3", "poissons_ratio = 0,3",
                   "A decimal number has a point: 0.2, not 0,2.");
    expect_refused("[zones]", "[zone]", "the scene has no key \"zone\"; did you mean zones?");
}

TEST(checks, a_word_of_earlier_versions_is_refused_with_its_new_name)
{
    expect_refused("load_history = [[1, 0]", "course = [[1, 0]",
                   "[[boundary]] has no key \"course\": it is now called load_history");
    expect_refused("dangling_ends = ", "dead_ends = ",
                   "[cutting] has no key \"dead_ends\": it is now called dangling_ends");
    expect_refused("[zones]\n", "[motion]\nrelease_s = 0\n\n[zones]\n",
                   "the scene has no key \"motion\": it is now called large_displacements");
    expect_refused("engine = \"relaxation\"", "engine = \"explicit\"",
                   "[equilibrium] engine = \"explicit\": expected \"auto\" | \"relaxation\" | \"implicit\"; "
                   "\"explicit\" is now called \"relaxation\"");
}

TEST(checks, a_missing_key_is_refused_at_its_table)
{
    expect_refused("[zones]\nkind = \"constant strain\"\nsize_m = 4\n", "[zones]\n",
                   "[zones] has no size_m: expected a number");
    expect_refused("cohesion_MPa = 0.5\n", "", "has no cohesion_MPa", "[[rock]]\nname = \"soft\"");
    expect_part(refusal(replaced(text, "shear_kelvin_stiffness_MPa_per_m = 8000\n", "")),
                "comes together with");
}

TEST(checks, missing_tables)
{
    for (const std::string table : {"[section]", "[zones]", "[schedule]", "[in_situ_stress]"})
        expect_part(refusal(without(table)), "the scene has no " + table);
    expect_part(refusal(without("[random]")), "the scene has no [random] seed: [[joint_set]] needs it");
    auto unheld = text;
    while (unheld.find("[[boundary]]") != std::string::npos)
        unheld.erase(unheld.find("[[boundary]]"),
                     unheld.find("\n[", unheld.find("[[boundary]]")) + 1 - unheld.find("[[boundary]]"));
    expect_part(refusal(unheld), "the scene has no [[boundary]]");
}

TEST(checks, tables_in_the_wrong_brackets)
{
    expect_refused("[zones]", "[[zones]]", "[zones] is a list of 1: expected a table");
    expect_refused("[[region]]", "[region]", "region is a table: expected tables under [[region]]");
}

TEST(checks, names)
{
    expect_refused("name = \"soft\"", "name = \"hard\" # again", "the name is taken in line",
                   "name = \"hard\" # again");
    expect_refused("name = \"steep\"", "name = \"flat\"", "the name is taken",
                   "name = \"flat\"\nmaterial = \"joint\"\ntrace");
    expect_refused("name = \"lower\"", "name = \"upper\" # again", "the name is taken");
    expect_refused("name = \"crest\"", "name = \"\"", "expected a text");
    expect_refused("name = \"fault\"", "name = \"flat\" # too", "the name is taken in line");
}

TEST(checks, references)
{
    expect_refused("rock = \"soft\"", "rock = \"sofft\"",
                   "expected the name of a [[rock]]: \"hard\", \"soft\"; did you mean \"soft\"?");
    expect_refused("rock = \"hard\"", "rock = \"marble\"",
                   "expected the name of a [[rock]]: \"hard\", \"soft\"");
    expect_refused("material = \"gouge\"\nfrom", "material = \"guoge\"\nfrom",
                   "[[joint]] \"fault\" material = \"guoge\"");
    expect_refused("material = \"joint\"\nmaterial_in", "material = \"jiont\"\nmaterial_in",
                   "did you mean \"joint\"?");
    const std::string in_soft = "{ rock = \"soft\", material = \"gouge\" }";
    expect_refused(
        in_soft, "{ rock = \"sofft\", material = \"gouge\" }",
        "[[joint_set]] \"steep\" material_in = a list of 1: has \"sofft\"; expected the name of a [[rock]]");
    expect_refused(in_soft, "{ rock = \"soft\", material = \"gauge\" }", "did you mean \"gouge\"?");
    expect_refused(in_soft, in_soft + ", " + in_soft, "expected each rock once, and \"soft\" is there twice");
    expect_refused(in_soft, "{ rock = \"soft\" }", "material");
    expect_refused("[" + in_soft + "]", "[]", "expected rocks and materials; at most 100");
    expect_refused("joint = \"joint\"", "joint = \"jiont\"", "[[boundary]] joint = \"jiont\"");
}

TEST(checks, polygons)
{
    const std::string outline = "outline_m = [[0, 0], [40, 0], [40, 20], [0, 20]]";
    expect_refused(outline, "outline_m = [[0, 0], [40, 0]]", "at least 3 corners");
    expect_refused(outline, "outline_m = [[0, 0], [40, 20], [40, 0], [0, 20]]", "meet");
    expect_refused(outline, "outline_m = [[0, 0], [40, 0], [40, 20], [0, 20], [0, 0]]",
                   "its last corner repeats its first");
    expect_refused(outline, "outline_m = [[0, 0], [40, 0], [20, 0]]", "meet");
    expect_refused("region_m = [[0, 5], [40, 5]", "region_m = [[0, 5], [0, 5]", "comes twice");
    expect_refused("remove_m = [[[25, 15], [40, 15]", "remove_m = [[[25, 15], [25, 21], [40, 15]", "meet");
    const std::string hole = "holes_m = [[[3, 14], [5, 14], [5, 16], [3, 16]]]";
    expect_refused(hole, "holes_m = [[[3, 14], [5, 14], [5, 21], [3, 16]]]", "not inside outline_m");
    expect_refused(hole, "holes_m = [[[0, 14], [5, 14], [5, 16]]]", "not inside outline_m");
    expect_refused(hole, "holes_m = [[[3, 14], [5, 14], [5, 16]], [[4, 14.5], [6, 14], [6, 16]]]",
                   "meets hole 1");
    expect_refused("outline_m = [[0, 0], [40, 0], [40, 5]", "outline_m = [[0, 0], [40, 5], [40, 0]",
                   "[[region]] outline_m");
}

TEST(checks, joints_and_boundaries)
{
    expect_refused("to_m = [40, 8]", "to_m = [0, 12]", "expected another point than from_m");
    expect_refused("to_m = [0, 20]\nfix", "to_m = [0, 0]\nfix", "expected another point than from_m");
    expect_refused("to_m = [0, 20]\nfix", "to_m = [1, 20]\nfix", "one straight piece");
    expect_refused("to_m = [0, 20]\nfix", "to_m = [0, 21]\nfix", "one straight piece");
    expect_refused("to_m = [40, 20]\nfix", "to_m = [20, 0] # over\nfix", "runs over the boundary of line");
    expect_refused("fix = \"x\"", "fix = \"x\"\njoint = \"joint\"", "not both");
    expect_refused("fix = \"x\"\n", "", "expected fix", "[[boundary]]\nfrom_m = [0, 0]\nto_m = [0, 20]");
}

TEST(checks, orientations)
{
    const std::string dip = "dip = { law = \"normal\", mean_deg = 70, deviation_deg = 3 }";
    expect_refused(dip, dip + " # first\ntrace_angle = { law = \"constant\", mean_deg = 1 }", "not both");
    expect_refused(dip + "\n", "", "has no dip: expected one of trace_angle",
                   "[[joint_set]]\nname = \"steep\"");
    expect_refused("trace_angle = { law = \"normal\", mean_deg = 10, deviation_deg = 2 }\n", "",
                   "has no trace_angle", "[[joint_set]]\nname = \"flat\"");
    expect_refused("azimuth_deg = 20\n", "", "the dip of [[joint_set]] \"steep\" needs the bearing",
                   "[section]");
    expect_refused("\"normal\", mean_deg = 70", "\"lognormal\", mean_deg = 70",
                   "expected \"normal\" | \"uniform\" | \"constant\"");
    const std::string pole =
        "orientation = { law = \"Fisher\", mean_dip_deg = 50, mean_dip_direction_deg = 30, "
        "concentration = 60 }";
    expect_refused(pole, pole + "\ndip = { law = \"constant\", mean_deg = 1 }", "not both",
                   "dip = { law = \"constant\", mean_deg = 1 }");
    expect_refused(pole, "trace_angle = { law = \"constant\", mean_deg = 1 }\n" + pole, "not both", pole);
    expect_refused("concentration = 60", "concentration = 4",
                   "[[joint_set]] orientation concentration = 4: expected a number in [5, 1e+06]",
                   "orientation = {");
    expect_refused(pole,
                   "orientation = { law = \"Fisher\", mean_dip_deg = 90, "
                   "mean_dip_direction_deg = 110, concentration = 60 }",
                   "parallel to the section", "orientation = {");
}

TEST(checks, steep_planes_nearly_parallel_to_the_section_are_refused_and_others_are_not)
{
    // Vertical planes: |n_p| = |cos(dip_direction - azimuth)|, and asin(0.05) = 2.866 degrees.
    const auto striking = [](double off) {
        auto all = replaced(text, "mean_deg = 70", "mean_deg = 90");
        return refusal(replaced(all, "mean_deg = 20", "mean_deg = " + shown(110 - off)));
    };
    expect_part(striking(2.86), "parallel to the section");
    EXPECT_EQ(striking(2.87), "accepted");
    EXPECT_EQ(refusal(replaced(text, "mean_deg = 20", "mean_deg = 110")), "accepted")
        << "it dips only 70 degrees";
}

TEST(checks, laws)
{
    const std::string spacing = "spacing = { law = \"normal\", mean_m = 6, deviation_m = 1 }";
    expect_refused(spacing, "spacing = { law = \"normal\", mean_m = 2.9, deviation_m = 1 }",
                   "at least 3 deviations, here 3 m");
    expect_refused(spacing, "spacing = { law = \"normal\", mean_m = 6 }", "has no deviation_m");
    expect_refused(spacing, "spacing = { law = \"lognormal\", mean_m = 6 }", "has no deviation_m");
    for (const std::string law : {"\"constant\"", "\"negative exponential\""})
        expect_refused(spacing, "spacing = { law = " + law + ", mean_m = 6, deviation_m = 1 }",
                       "deviation_m = 1: the law " + law + " does not take it");
    for (const std::string law : {"\"constant\"", "\"negative exponential\"", "\"lognormal\""})
        expect_refused(spacing, "spacing = { law = " + law + ", deviation_m = 1 }",
                       "has no mean_m: the law " + law + " needs it");
    expect_refused(spacing, "spacing = { law = \"uniform\", shortest_m = 2 }", "has no longest_m");
    expect_refused(spacing, "spacing = { law = \"uniform\", longest_m = 2 }", "has no shortest_m");
    expect_refused(spacing, "spacing = { law = \"uniform\", mean_m = 1, shortest_m = 1, longest_m = 2 }",
                   "mean_m = 1: the law \"uniform\" does not take it");
    expect_refused(spacing, "spacing = { law = \"uniform\", shortest_m = 2, longest_m = 2 }",
                   "longest_m = 2 m: expected above shortest_m, 2 m");
    expect_refused(spacing, "spacing = { law = \"constant\", mean_m = 2, longest_m = 2 }",
                   "longest_m = 2: the law \"constant\" does not take it");
    const auto power = [](const std::string& keys) { return "spacing = { law = \"power\", " + keys + " }"; };
    expect_refused(spacing, power("shortest_m = 1, longest_m = 2"),
                   "has no exponent: the law \"power\" needs it");
    expect_refused(spacing, power("exponent = 2, shortest_m = 1, longest_m = 1"),
                   "expected above shortest_m");
    expect_refused(spacing, power("exponent = 2, shortest_m = 0.9e-6, longest_m = 1"),
                   "shortest_m = 9e-07 m: the law \"power\" needs at least 1e-6 of longest_m, here 1e-06 m");
    expect_refused(spacing, power("exponent = 21, shortest_m = 1, longest_m = 2"),
                   "expected a number in [0, 20]");
    expect_refused(spacing, power("exponent = 2, mean_m = 1, shortest_m = 1, longest_m = 2"),
                   "mean_m = 1: the law \"power\" does not take it");
    EXPECT_EQ(
        refusal(replaced(text, spacing, "spacing = { law = \"uniform\", shortest_m = 0, longest_m = 9 }")),
        "accepted");
    expect_refused("half_width_deg = 5", "deviation_deg = 5",
                   "deviation_deg = 5: the law \"uniform\" does not take it",
                   "trace_angle = { law = \"uniform\"");
    expect_refused("deviation_deg = 3", "half_width_deg = 3", "has no deviation_deg",
                   "dip = { law = \"normal\"");
    expect_refused(spacing, "spacing = 6", "[[joint_set]] spacing is 6: expected a table");
    EXPECT_EQ(refusal(replaced(text, spacing, "spacing = { law = \"normal\", mean_m = 3, deviation_m = 1 }")),
              "accepted");
}

TEST(checks, rock_bridges)
{
    auto weak = text;
    for (const char* key : {"cohesion_MPa = 0.5\n", "friction_angle_deg = 35\n",
                            "tensile_strength_MPa = 0.2\n", "dilation_angle_deg = 8\n"})
        weak = replaced(weak, key, "");
    expect_part(refusal(weak), "[[joint_set]] \"steep\" persistence = 0.6");
    expect_part(refusal(weak), "[[rock]] \"soft\"");
    expect_refused("length = { law = \"negative exponential\", mean_m = 8 }\n", "",
                   "a persistence of 0.8 needs it", "[[joint_set]]\nname = \"flat\"");
}

TEST(checks, dilation)
{
    expect_refused(
        "dilation_angle_deg = 5", "dilation_angle_deg = 26",
        "[[joint_material]] \"gouge\" dilation_angle_deg = 26: expected at most friction_angle_deg");
    expect_refused("shear_stiffness_MPa_per_m = 400\n", "shear_stiffness_MPa_per_m = 0\n",
                   "[[joint_material]] \"gouge\" dilation_angle_deg = 5: expected 0 of a smooth joint",
                   "dilation_angle_deg = 5");
    expect_refused("dilation_angle_deg = 8", "dilation_angle_deg = 36",
                   "[[rock]] \"soft\" dilation_angle_deg = 36: expected at most friction_angle_deg");
    auto weak = text;
    for (const char* key :
         {"cohesion_MPa = 0.5\n", "friction_angle_deg = 35\n", "tensile_strength_MPa = 0.2\n"})
        weak = replaced(weak, key, "");
    expect_part(refusal(weak),
                "[[rock]] \"soft\" dilation_angle_deg = 8: it needs cohesion_MPa, friction_angle_deg and "
                "tensile_strength_MPa");
}

TEST(checks, residual_strength)
{
    const std::string gouge = "[[joint_material]] \"gouge\" ";
    expect_refused("residual_cohesion_MPa = 0.05", "residual_cohesion_MPa = 0.11",
                   gouge + "residual_cohesion_MPa = 0.11: expected at most cohesion_MPa");
    expect_refused("residual_friction_angle_deg = 20", "residual_friction_angle_deg = 25.5",
                   gouge + "residual_friction_angle_deg = 25.5: expected at most friction_angle_deg");
    expect_refused("residual_friction_angle_deg = 20", "residual_friction_angle_deg = 4",
                   gouge + "residual_friction_angle_deg = 4: expected at least dilation_angle_deg");
    expect_part(refusal(replaced(text, "residual_cohesion_MPa = 0.05\n", "")), "residual");
    expect_part(refusal(replaced(replaced(text, "dilation_angle_deg = 5\n", ""),
                                 "shear_stiffness_MPa_per_m = 400\n", "shear_stiffness_MPa_per_m = 0\n")),
                gouge + "residual_friction_angle_deg = 20: expected none of a smooth joint");
}

TEST(checks, fine_zones)
{
    const auto by = [](const std::string& corners) {
        return refusal(
            replaced(text, "fine_m = [[5, 5], [35, 5], [35, 20], [5, 20]]", "fine_m = [" + corners + "]"));
    };
    expect_part(by("[50, 5], [60, 5], [60, 9]"), "[zones] fine_m");
    expect_part(by("[50, 5], [60, 5], [60, 9]"), "it is outside the section");
    expect_part(by("[3.5, 14.5], [4.5, 14.5], [4.5, 15.5]"), "it is outside the section"); // in the hole
    EXPECT_EQ(by("[10, 5], [20, 5], [20, 9]"), "accepted");
    EXPECT_EQ(by("[30, 5], [60, 5], [60, 9]"), "accepted");                  // a part of it inside
    EXPECT_EQ(by("[-10, -10], [60, -10], [60, 60], [-10, 60]"), "accepted"); // all around
}

TEST(checks, size_at_faces)
{
    expect_refused("size_at_faces_m = 2", "size_at_faces_m = 4.1",
                   "[zones] size_at_faces_m = 4.1: expected at most size_m, 4 m");
    EXPECT_EQ(refusal(replaced(text, "size_at_faces_m = 2", "size_at_faces_m = 4")), "accepted");
}

TEST(checks, times)
{
    expect_refused("end = 1994-07-01", "end = 1994-06-01", "expected an end after the start");
    expect_refused("date = 1994-06-06", "date = 1994-06-01", "expected later than the start");
    expect_refused("date = 14", "date = 5", "expected later than the stage before, 5 days");
    expect_refused("date = 14", "date = 30.5", "expected not after the end");
    expect_refused("first_reading = 1994-06-07", "first_reading = 1994-05-31",
                   "expected from the start to the end");
    EXPECT_EQ(refusal(replaced(text, "date = 14", "date = 30")), "accepted") << "a stage at the end";
}

TEST(checks, monitoring_lines)
{
    const Scene scene = parse_scene(text, "scene.toml");
    ASSERT_EQ(scene.points.size(), 5u);
    EXPECT_EQ(scene.points[0].name, "crest");
    for (int i = 0; i < 4; ++i) {
        EXPECT_EQ(scene.points[1 + i].name, "inclinometer " + std::to_string(i + 1));
        EXPECT_NEAR((scene.points[1 + i].at - Eigen::Vector2d(2, 2 + 4 * i)).norm(), 0, 1e-14);
    }
    expect_refused("to_m = [2, 14]", "to_m = [2, 26]",
                   "[[monitoring_line]] \"inclinometer\" to_m = [2, 26]: its point \"inclinometer 4\" at "
                   "[2, 26] is outside the section's outline");
    expect_refused("to_m = [2, 14]", "to_m = [2, 2]", "expected another point than from_m");
    expect_part(
        refusal(replaced(text, "name = \"crest\"", "name = \"inclinometer 2\"")),
        "[[monitoring_line]] \"inclinometer\" name = \"inclinometer\": its point \"inclinometer 2\" has the "
        "name of another point");
    expect_refused("first_reading = 7", "first_reading = 31", "expected from the start to the end, 30 days");
    EXPECT_EQ(refusal(replaced(text, "first_reading = 7", "first_reading = 31")).find('\n'),
              std::string::npos)
        << "once";
}

TEST(checks, all_faults_are_told_at_once)
{
    const auto lines = [](const std::string& message) {
        return std::count(message.begin(), message.end(), '\n') + 1;
    };
    // Of keys and values; checks that need them are left out.
    std::string wrong = replaced(text, "poissons_ratio = ", "poissons_ratio = 1");
    wrong = replaced(wrong, "gravity_m_per_s2 = ", "gravity = ");
    wrong = replaced(wrong, "[in_situ_stress]\n", "[in_situ_stress]\nstress = 3\n");
    wrong = replaced(wrong, "seed = 1", "seed = -1");
    const std::string told = refusal(wrong);
    EXPECT_EQ(lines(told), 4) << told; // that gravity is missing is told once
    for (const char* const part : {"poissons_ratio = 1", "no key \"gravity\"; did you mean gravity_m_per_s2?",
                                   "no key \"stress\"", "seed = -1"})
        expect_part(told, part);
    // By line.
    EXPECT_LT(told.find("gravity"), told.find("poissons_ratio"));
    EXPECT_LT(told.find("poissons_ratio"), told.find("seed"));
    // Of references; then of places and times.
    wrong = replaced(text, "at_m = [24, 19]", "at_m = [24, 21]");
    wrong = replaced(wrong, "date = 14", "date = 31");
    const std::string places = refusal(wrong);
    EXPECT_EQ(lines(places), 2) << places;
    expect_part(places, "outside the section's outline");
    expect_part(places, "expected not after the end");
    // Dates mean nothing without the start: those of the same table alone are told.
    EXPECT_EQ(lines(refusal(replaced(text, "start = 1994-06-01", "start = true"))), 2);
}

TEST(checks, places)
{
    expect_refused("at_m = [24, 19]", "at_m = [24, 21]", "[24, 21] is outside the section's outline");
    expect_refused("at_m = [20, 10]", "at_m = [-1, 10]", "[[gauge]] \"on the fault\"");
    EXPECT_EQ(refusal(replaced(text, "at_m = [24, 19]", "at_m = [24, 20]")), "accepted") << "on the outline";
    EXPECT_EQ(refusal(replaced(text, "at_m = [24, 19]", "at_m = [24, 20.00000004]")), "accepted")
        << "1e-9 of 45 m";
    expect_refused("at_m = [24, 19]", "at_m = [24, 20.00000005]", "is outside");
}

TEST(checks, numbers_that_depend_on_others)
{
    expect_refused("shortest_edge_m = 0.2", "shortest_edge_m = 5", "expected at most [zones] size_m, 4 m");
    expect_refused("mass_damping_per_s = 20\n", "", "has no mass_damping_per_s", "[equilibrium]");
    expect_refused("damping = \"mass\"", "damping = \"adaptive\"", "stiffness_damping_s = 1e-05",
                   "stiffness_damping_s = 1e-5");
    expect_refused("damping = \"mass\"\nmass_damping_per_s = 20\nstiffness_damping_s = 1e-5",
                   "damping = \"adaptive\"\nmass_damping_per_s = 20", "mass_damping_per_s = 20",
                   "mass_damping_per_s = 20");
    expect_refused("mass_damping_per_s = 20\nstiffness_damping_s = 1e-5", "mass_damping_per_s = 0",
                   "more than 0", "mass_damping_per_s = 0");
    expect_refused("mass_damping_per_s = 20", "mass_damping_per_s = 20\nlocal_damping = 0.8",
                   "only damping = \"local\"", "local_damping = 0.8");
}

TEST(checks, loads)
{
    expect_refused("traction_MPa = [0, -0.01]", "", "expected fix = ", "[[boundary]]\nfrom_m = [0, 20]");
    expect_refused("load_history = [[1, 0], [4, 1]]", "", "expected fix and load_history",
                   "displacement_mm = [-0.1, 0]");
    expect_refused("displacement_mm = [-0.1, 0]", "displacement_mm = [-0.1, 1]",
                   "expected 0 in the direction", "displacement_mm = [-0.1, 1]");
    expect_refused("load_history = [[1, 0], [4, 1]]", "load_history = [[4, 0], [1, 1]]",
                   "dates in increasing order", "load_history = [[4, 0]");
    expect_refused("joint = \"joint\"\n\n[[boundary]]",
                   "joint = \"joint\"\ntraction_MPa = [1, 0]\n\n[[boundary]]", "beside joint",
                   "joint = \"joint\"\ntraction_MPa");
    expect_refused("traction_MPa = [0, -0.01]", "fix = \"x\"\nload_history = [[0, 1]]", "beside it",
                   "load_history = [[0, 1]]");
    expect_refused("fix = \"x\"\n\n", "fix = \"x\"\ntraction_MPa = [0.1, -1]\n\n",
                   "expected 0 in a direction that is fixed", "traction_MPa = [0.1, -1]");
    const auto fine = replaced(text, "fix = \"x\"\n\n", "fix = \"x\"\ntraction_MPa = [0, -1]\n\n");
    EXPECT_EQ(refusal(fine), "accepted");
}

TEST(checks, rollers)
{
    const std::string left = "fix = \"x\"\n\n";
    EXPECT_EQ(refusal(replaced(text, left, "fix = \"normal\"\n\n")), "accepted");
    EXPECT_EQ(refusal(replaced(text, left, "fix = \"normal\"\ntraction_MPa = [0, -1]\n\n")), "accepted");
    expect_refused(left, "fix = \"normal\"\ntraction_MPa = [0.1, -1]\n\n",
                   "expected a traction along the segment", "traction_MPa = [0.1, -1]");
    expect_refused("fix = \"x\"\ndisplacement_mm", "fix = \"normal\"\ndisplacement_mm",
                   "expected fix = \"x\", \"y\" or \"xy\" beside it", "displacement_mm");
    expect_refused(left, "fix = \"normal\"\n\n[large_displacements]\nnew_contacts = \"joint\"\n\n",
                   "with [large_displacements]", "fix = \"normal\"");
    // Upright and level rollers may meet a support that moves, others not.
    const std::string top = "to_m = [20, 20]\ntraction_MPa = [0, -0.01]",
                      roof = "to_m = [40, 20]\nfix = \"normal\"";
    EXPECT_EQ(refusal(replaced(text, top, roof)), "accepted");
    const auto sloping = replaced(
        replaced(replaced(text, top, roof), "[40, 20], [0, 20]]\nholes", "[40, 20], [0, 21]]\nholes"),
        "from_m = [0, 20]\nto_m = [40, 20]", "from_m = [0, 21]\nto_m = [40, 20]");
    expect_part(refusal(sloping), "expected no common point with the rollers");
}

TEST(checks, files)
{
    const auto folder = std::filesystem::temp_directory_path() / "jointcreep_scene_files";
    std::filesystem::create_directories(folder);
    EXPECT_THROW(read_scene_text(folder.string()), file_error);
    EXPECT_THROW(read_scene_text((folder / "none.toml").string()), file_error);
    std::ofstream(folder / "empty.toml").close();
    EXPECT_THROW(read_scene_text((folder / "empty.toml").string()), input_error);
    std::ofstream(folder / "large.toml") << std::string(16 * 1024 * 1024 + 1, '#');
    EXPECT_THROW(read_scene_text((folder / "large.toml").string()), input_error);
    std::ofstream(folder / "fair.toml", std::ios::binary) << text;
    EXPECT_EQ(read_scene_text((folder / "fair.toml").string()), text);
    std::filesystem::remove_all(folder);
}

TEST(checks, a_joint_has_one_kelvin_unit_or_a_chain)
{
    expect_refused("kelvin_chain = [{",
                   "normal_kelvin_stiffness_MPa_per_m = 1\nnormal_kelvin_viscosity_MPa_day_per_m = 1\n"
                   "shear_kelvin_stiffness_MPa_per_m = 1\nshear_kelvin_viscosity_MPa_day_per_m = 1\n"
                   "kelvin_chain = [{",
                   "expected either it, or the four keys of one Kelvin unit, not both", "kelvin_chain = [{");
    expect_refused("normal_maxwell_viscosity_MPa_day_per_m = 1e6\n", "",
                   "as it comes together with shear_maxwell_viscosity_MPa_day_per_m",
                   "[[joint_material]]\nname = \"gouge\"");
    expect_refused("kelvin_chain = [{", "kelvin_chain = [3, {",
                   "[[joint_material]] kelvin_chain is 3: expected a table");
}

TEST(checks, creep_steps_are_fixed_or_chosen_by_a_tolerance)
{
    expect_refused("step_days = 5", "step_days = 5\ntolerance_m = 1e-5",
                   "expected either it or step_days, not both", "tolerance_m = 1e-5");
    expect_part(refusal(replaced(text, "step_days = 5\n", "")),
                line_of(text, "[creep]") + " [creep] has no step_days: expected it, or tolerance_m");
    expect_refused("step_days = 5", "step_days = 5\nlongest_step_days = 9", "only tolerance_m uses it",
                   "longest_step_days");
    const std::string steps = "tolerance_m = 1e-5\nshortest_step_days = 2\n";
    expect_refused("step_days = 5", steps + "longest_step_days = 1", "expected at least shortest_step_days",
                   "longest_step_days");
    expect_refused("step_days = 5", steps + "first_step_days = 1", "expected at least shortest_step_days",
                   "first_step_days");
    expect_refused("step_days = 5", steps + "longest_step_days = 3\nfirst_step_days = 4",
                   "expected at most longest_step_days", "first_step_days");
    EXPECT_EQ(refusal(replaced(text, "step_days = 5", steps + "first_step_days = 2\nlongest_step_days = 2")),
              "accepted");
}

TEST(checks, kinds_of_sets)
{
    const std::string steep = "name = \"steep\"\nmaterial = \"joint\"\n", persistence = "persistence = 0.6\n";
    expect_refused(persistence, "", "has no persistence: a set of lines needs it",
                   "[[joint_set]]\nname = \"steep\"");
    expect_refused(persistence, persistence + "bridge_length_m = 2\n",
                   "bridge_length_m = 2: expected either it or persistence, not both", "bridge_length_m = 2");
    expect_refused("length = { law = \"uniform\", shortest_m = 1, longest_m = 9 }\n", "",
                   "has no length: a bridge_length_m needs it", "[[joint_set]]\nname = \"even\"");
    expect_refused("density = { P20_per_m2 = 0.004 }",
                   "density = { P20_per_m2 = 0.004 }\nbridge_length_m = 2",
                   "a set of segments does not take it", "bridge_length_m = 2");
    expect_refused("spacing = { law = \"lognormal\", mean_m = 5, deviation_m = 1 }\n", "",
                   "has no spacing: a set of lines needs it, or a density",
                   "[[joint_set]]\nname = \"steep\"");
    expect_refused(steep, steep + "kind = \"segments\"\n", "has no density: a set of segments needs it",
                   "[[joint_set]]\nname = \"steep\"");
    expect_refused("density = { P20_per_m2 = 0.004 }",
                   "density = { P20_per_m2 = 0.004 }\npersistence = 0.123",
                   "a set of segments does not take it", "persistence = 0.123");
    expect_refused("density = { P30_per_m3 = 0.0002 }\ndiameter", "density = { P30_per_m3 = 0.0002 }\nlength",
                   "has no diameter: a set of discs needs it", "[[joint_set]]\nname = \"coins\"");
    expect_refused("orientation = { law = \"bootstrap\", poles = \"poles.csv\" }",
                   "trace_angle = { law = \"constant\", mean_deg = 4 }", "discs lie in space");
    expect_refused("rocks = [\"hard\"]", "rocks = [\"hardd\"]", "did you mean \"hard\"?");
    expect_refused("rocks = [\"hard\"]", "region_m = [[0, 0], [9, 0], [9, 9]]\nrocks = [\"hard\"]",
                   "expected either it or region_m", "rocks = [\"hard\"]");
}

TEST(checks, densities)
{
    const std::string density = "density = { P10_per_m = 0.05, scanline_angle_deg = 0 }";
    expect_refused(density, "density = { P21_per_m = 0.05, scanline_angle_deg = 0 }", "only P10_per_m");
    expect_refused(density, "density = { P10_per_m = 0.05 }", "P10_per_m needs either");
    expect_refused(density, "density = { P10_per_m = 0.05, P21_per_m = 1, scanline_angle_deg = 0 }",
                   "one measure alone");
    expect_refused(density, "density = { scanline_angle_deg = 0 }", "expected one of P10_per_m");
    expect_refused(density, "density = { P20_per_m2 = 1 }", "lines have no number per area");
    expect_refused(density, "density = { P30_per_m3 = 1 }", "only discs");
    expect_refused(density, "density = { P32_per_m = 1 }", "no orientation in space");
    expect_refused(density, "density = { P10_per_m = 1, scanline_trend_deg = 3, scanline_plunge_deg = 3 }",
                   "no orientation in space");
    expect_refused(density, "density = { P10_per_m = 1, scanline_trend_deg = 3 }", "comes together with");
    expect_refused(density + "\npersistence = 1", density + "\npersistence = 0", "leaves none", density);
}

TEST(checks, terminations)
{
    const std::string ends = "terminates_at = [\"fault\", \"flat\"]";
    expect_refused(ends, "terminates_at = [\"fault\", \"flatt\"]", "did you mean \"flat\"?");
    expect_refused(ends, "terminates_at = [\"measured\"]", "expected the name of a [[joint_set]]");
    expect_refused(ends, "terminates_at = [\"flat\", \"flat\"]", "each name once");
    expect_refused(ends + "\n", "", "expected terminates_at beside it", "termination_probability = 0.7");
    expect_refused("persistence = 0.6\n", "persistence = 0.6\nterminates_at = [\"fault\"]\n",
                   "a set of lines does not take it", "terminates_at = [\"fault\"]\n");
    EXPECT_EQ(refusal(replaced(text, ends, "terminates_at = [\"on the map\", \"coins\"]")), "accepted");
    const auto circle =
        replaced(replaced(text, ends, "terminates_at = [\"coins\"]"), "density = { P30_per_m3 = 0.0002 }",
                 "density = { P30_per_m3 = 0.0002 }\nterminates_at = [\"measured\"]");
    expect_part(refusal(circle), "in a circle");
}

TEST(checks, orientation_laws)
{
    const std::string bootstrap = "orientation = { law = \"bootstrap\", poles = \"poles.csv\" }";
    expect_refused(bootstrap, "orientation = { law = \"bootstrap\" }", "needs either poles_deg or poles");
    expect_refused(bootstrap,
                   "orientation = { law = \"bootstrap\", poles = \"poles.csv\", poles_deg = [[1, 2]] }",
                   "has both poles_deg and poles");
    expect_refused(bootstrap, "orientation = { law = \"bootstrap\", poles = \"pole.csv\" }",
                   "expected the name of a file beside the scene");
    expect_refused(bootstrap,
                   "orientation = { law = \"bootstrap\", poles = \"poles.csv\", concentration = 9 }",
                   "does not take it");
    expect_refused(bootstrap,
                   "orientation = { law = \"bootstrap\", poles = \"poles.csv\", blind_zone_deg = 9 }",
                   "expected scanline_trend_deg");
    expect_refused(bootstrap, "orientation = { law = \"Fisher\", concentration = 9 }",
                   "has no mean_dip_deg: the law \"Fisher\" needs it");
    expect_refused("[[60, 40], [64, 52]", "[[60, 40], [94, 52]", "94");
}

TEST(checks, files_that_a_scene_names)
{
    expect_part(refusal(replaced(text, "75,200,1", "95,200,1")),
                "line 2: dip_deg is \"95\"; expected a number in [0, 90]");
    expect_part(refusal(replaced(text, "dip_direction_deg,weight", "dip_direction,weight")),
                "expected a column dip_direction_deg");
    expect_part(refusal(replaced(text, "value = \"F\"", "value = \"H\"")), "has no trace whose set is \"H\"");
    expect_part(refusal(replaced(text, "name = \"poles.csv\"", "name = \"traces.csv\"")), "is taken");

    // Beside the scene, not in it.
    const auto folder = std::filesystem::temp_directory_path() / "jointcreep-scene-files";
    std::filesystem::create_directories(folder);
    const auto write = [&](const std::string& name, const std::string& content) {
        std::ofstream(folder / name) << content;
    };
    const auto file_tables = text.find("[[file]]\nname = \"poles.csv\"");
    const auto rest = text.find("[in_situ_stress]");
    write("scene.toml", text.substr(0, file_tables) + text.substr(rest));
    write("poles.csv", "dip_deg,dip_direction_deg,weight\r\n75,200,1\r\n80,210,2\r\n# \"quoted\" \\ \t");
    write("traces.csv", "x1_m,y1_m,x2_m,y2_m,set\n2,20,12,0,F\n");
    const std::string whole = read_scene_text((folder / "scene.toml").string());
    const Scene scene = parse_scene(whole, "scene.toml"), held = parse_scene(text, "scene.toml");
    EXPECT_EQ(scene.joint_sets.at(6).poles.at(1).weight, held.joint_sets.at(6).poles.at(1).weight);
    EXPECT_EQ(scene.mapped.at(0).traces.at(0).polylines, held.mapped.at(0).traces.at(0).polylines);
    write("again.toml", whole); // says everything itself
    EXPECT_EQ(read_scene_text((folder / "again.toml").string()), whole);
    std::filesystem::remove_all(folder);
}

} // namespace

} // namespace checks_test
