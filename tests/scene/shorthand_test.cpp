// Names of [variables], circles and arcs: what the text of a scene becomes.

#include "scene/shorthand.hpp"

#include "model/error.hpp"
#include "model/polygon.hpp"
#include "scene/scene.hpp"
#include "text.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace shorthand_test
{

using namespace jointcreep;
using namespace jointcreep::scene;

namespace
{

std::string error_of(const std::string& text)
{
    try {
        written_out(text, "scene");
    } catch (const input_error& error) {
        return error.what();
    }
    return "";
}

TEST(shorthand, a_text_without_shorthand_stays_as_it_is)
{
    const std::string text = "title = \"size_m\" # é\n[zones]\nsize_m = 3\n";
    EXPECT_EQ(written_out(text, "scene"), text);
    EXPECT_EQ(written_out("not = [ TOML", "scene"), "not = [ TOML"); // parse_scene refuses it
}

TEST(shorthand, names_stand_for_numbers_and_keys_keep_their_lines)
{
    const std::string variables = "[variables]\nH = 40\ntoe = \"H / 4 - 1.5\" # é\nn = 2\n";
    EXPECT_EQ(written_out(variables + "[zones]\nsize_m = \"H / 20\"\n[section]\nrock = \"H\"\n", "scene"),
              variables + "[zones]\nsize_m = 2\n[section]\nrock = \"H\"\n");
    EXPECT_EQ(
        written_out(variables + "[section]\noutline_m = [[0, \"-(H + toe) * 2\"], # é\n [\"toe\", 1e1]]\n",
                    "scene"),
        variables + "[section]\noutline_m = [[0, -97], # é\n [8.5, 1e1]]\n");
    EXPECT_EQ(
        written_out(variables +
                        "[[joint_set]]\nname = \"é\"\nspacing = { law = \"constant\", mean_m = \"toe/2\" }\n",
                    "scene"),
        variables + "[[joint_set]]\nname = \"é\"\nspacing = { law = \"constant\", mean_m = 4.25 }\n");
    EXPECT_EQ(
        written_out(
            variables +
                "[[stage]]\ndate = \"n\"\nremove_m = [[[0, \"\"\"\nH\"\"\"], [1, 2]]]\n[equilibrium]\nmost_steps = \"n*5\"\n",
            "scene"),
        variables +
            "[[stage]]\ndate = 2\nremove_m = [[[0, 40\n], [1, 2]]]\n[equilibrium]\nmost_steps = 10\n");
    EXPECT_TRUE(
        written_out(
            "[variables]\na = \"1 - 2 - 3\"\nb=\"8/4/2\"\nc=\"2*-3\"\n[zones]\nsize_m = \"a * 100 + b * 10 + c\"",
            "scene")
            .ends_with("size_m = -396"));
}

TEST(shorthand, formulas_have_functions_and_powers)
{
    const auto value_of = [](const std::string& formula) {
        const std::string text = "[variables]\nH = 40\n[zones]\nsize_m = ";
        const std::string written = written_out(text + "\"" + formula + "\"", "scene");
        return std::stod(written.substr(text.size()));
    };
    EXPECT_DOUBLE_EQ(value_of("3 * (1 - exp(-H / 20)) + 0.022 * H"), 3 * (1 - std::exp(-2.0)) + 0.88);
    EXPECT_DOUBLE_EQ(value_of("H / tand(45)"), 40);
    EXPECT_DOUBLE_EQ(value_of("sind(30) + cosd (60) + atand(1)"), 46);
    EXPECT_DOUBLE_EQ(value_of("sqrt(H / 10) + ln(exp(3)) + abs(-H)"), 45);
    EXPECT_DOUBLE_EQ(value_of("min(H, 3, 8) + max(1, -H)"), 4);
    EXPECT_DOUBLE_EQ(value_of("-2 ^ 2 + 2 ^ 3 ^ 2 / 2 + 4 ^ -0.5"), 252.5);
    EXPECT_TRUE(written_out("[zones]\nsize_m = \"sqrt(4)\"\n", "scene").ends_with("size_m = 2\n"));
    EXPECT_TRUE(written_out("[variables]\nexp = 2\n[zones]\nsize_m = \"exp * 3\"\n", "scene")
                    .ends_with("size_m = 6\n"));
}

TEST(shorthand, what_names_and_sums_cannot_be_is_refused)
{
    const std::string head = "[variables]\nheight = 40\n";
    const auto refused = [&](const std::string& value) {
        return error_of(head + "[zones]\nsize_m = " + value);
    };
    EXPECT_TRUE(
        refused("\"hieght\"") ==
        "scene, line 4: [zones] size_m = \"hieght\": [variables] has no hieght; did you mean height? (A "
        "number is written without quotes)");
    expect_part(refused("\"height +\""), "is missing at its end");
    expect_part(refused("\"height 2\""), "\"2\" is no part of a formula");
    expect_part(refused("\"(height\""), "a ( without its )");
    expect_part(refused("\"1 / (height - 40)\""), "not a finite number");
    expect_part(refused("\"height,5\""), "is no part of a formula");
    expect_part(refused("\"sin(height)\""),
                "there is no function sin; expected one of abs, exp, ln, sqrt, sind");
    expect_part(refused("\"exp(height, 2)\""), "exp has 2 values; expected one");
    expect_part(refused("\"max(height)\""), "max has 1 values; expected two or more");
    expect_part(refused("\"max(height, 2\""), "a ( without its )");
    expect_part(refused("\"min(1 / 0, height)\""), "a value of min is not a finite number");
    expect_part(refused("\"min(sqrt(-1), height)\""), "sqrt of -1 is not a finite number");
    expect_part(refused("\"max(height, (-8) ^ 0.5)\""), "a power in it is not a finite number");
    expect_part(refused("\"exp()\""), "does not begin with a number or a name");
    expect_part(refused("\"" + std::string(300, '(') + "height\""), "nested too deep");
    expect_part(error_of("[variables]\na = \"b\"\nb = \"a\"\n"), "depends on itself");
    expect_part(error_of("[variables]\n\"a b\" = 1\n"), "expected a name of letters");
    expect_part(error_of("[variables]\na = true\n"), "expected a number, or a text with names");
    expect_part(error_of("variables = 3\n"), "expected a table [variables]");
    expect_part(error_of("[variables]\n\"\" = 1\n"), "expected a name of letters");
    expect_part(error_of("[variables]\n_a = 1\n"), "begins with a letter");
    expect_part(error_of("[variables]\na = inf\n"), "expected a finite number");
    EXPECT_TRUE(written_out("[variables]\nH = 10\n[random]\nseed = \"H * 1e5\"\n", "scene")
                    .ends_with("seed = 1000000\n"));
    std::string chain = "[variables]\n";
    for (int i = 0; i < 5000; ++i)
        chain += "a" + std::to_string(i) + " = \"a" + std::to_string(i + 1) + "\"\n";
    expect_part(error_of(chain + "a5000 = 1\n"), "nested too deep in other variables");
}

// They are refused by the reader of the key: a date in quotes is no difference, and a number needs no quotes.
TEST(shorthand, sums_of_numbers_need_no_names)
{
    EXPECT_EQ(
        written_out("[zones]\nsize_m = \"3 / 2\"\n[section]\noutline_m = [[\"9 - 1\", \"(2)\"]]\n", "scene"),
        "[zones]\nsize_m = 1.5\n[section]\noutline_m = [[8, 2]]\n");
    const std::string dates = "[[stage]]\ndate = \"1994/06/15\"\n[schedule]\nstart = \"1994 - 6\"\n";
    EXPECT_EQ(written_out(dates, "scene"), dates);
}

TEST(shorthand, texts_without_a_name_stay)
{
    const std::string text =
        "[variables]\nH = 4\n[schedule]\nend = \"1994-06-15\"\n[zones]\nsize_m = \"3\"\n";
    EXPECT_EQ(written_out(text, "scene"), text);
    const std::string plain = every_key_text();
    const std::string quoted =
        "[variables]\nH = 4\n" + replaced(plain, "end = 1994-07-01", "end = \"1994-07-01\"");
    expect_part(refusal(written_out(quoted.substr(quoted.find("[section]")), "scene")),
                "end = \"1994-07-01\": expected a date");
}

TEST(shorthand, quarters_and_halves_of_circles_have_their_share_of_sides)
{
    for (const auto& [x, y] : {std::pair(0.1, 0.7), {1e3, 7e2}, {-0.3, 12.9}})
        for (const int turn : {1, -1}) {
            const auto at = [&, x = x, y = y](double degrees) {
                const double a = degrees * std::numbers::pi / 180;
                return "[" + shown(x + 3.3 * std::cos(a)) + ", " + shown(y + 3.3 * std::sin(a)) + "]";
            };
            const auto sides = [&](double end) {
                const std::string arc = "ground_m = [" + at(10) +
                                        ", { through_m = " + at(10 + turn * end / 2) +
                                        ", to_m = " + at(10 + turn * end) + " }]";
                const std::string out = written_out("[in_situ_stress]\n" + arc + "\n", "scene");
                return std::count(out.begin(), out.end(), '[') - 3; // the table, the list, the first corner
            };
            EXPECT_EQ(sides(90), 8) << x;
            EXPECT_EQ(sides(180), 16) << x;
            EXPECT_EQ(sides(270), 24) << x;
        }
}

TEST(shorthand, circles_and_arcs_have_their_corners_on_the_circle)
{
    std::string text = every_key_text();
    const Scene plain = parse_scene(text, "scene");
    const double left = plain.outline[0].x(), base = plain.outline[0].y();
    text += "[[region]]\nrock = \"" + plain.rock + "\"\noutline_m = { center_m = [" + shown(left) + ", " +
            shown(base) + "], radius_m = 0.5 }\n[[region]]\nrock = \"" + plain.rock +
            "\"\noutline_m = [[1, 0], [3, 0], { through_m = [2, 1], to_m = [1, 0], sides = 50 }]\n";
    const Scene scene = parse_scene(written_out(text, "scene"), "scene");
    ASSERT_TRUE(scene.regions.size() == plain.regions.size() + 2);
    const Polygon &circle = scene.regions[plain.regions.size()].outline, &half = scene.regions.back().outline;
    ASSERT_TRUE(circle.size() == 32);
    for (const Eigen::Vector2d& corner : circle)
        EXPECT_NEAR((corner - Eigen::Vector2d(left, base)).norm(), .5, 1.5e-9);
    // n sides enclose n/2 sin(2 pi/n) of the radius squared.
    EXPECT_NEAR(area_of(circle), .25 * 16 * std::sin(std::numbers::pi / 16), 1e-8);
    ASSERT_TRUE(half.size() == 51); // it ends at the first corner, which is there once
    EXPECT_NEAR(std::abs(area_of(half)), 25 * std::sin(std::numbers::pi / 50), 1e-8);
    for (const Eigen::Vector2d& corner : half) {
        EXPECT_TRUE(corner.y() >= -1.5e-9);
        EXPECT_NEAR((corner - Eigen::Vector2d(2, 0)).norm(), 1, 1.5e-9);
    }
}

TEST(shorthand, an_arc_the_other_way_round_in_a_line_and_inside_a_list_of_polygons)
{
    const std::string text =
        "[in_situ_stress]\nground_m = [[0, 0], { through_m = [1, -1], to_m = [2, 0], sides = 2 }, [9, 0]]\n"
        "[[stage]]\nremove_m = [{ center_m = [0, 0], radius_m = 2, sides = 4 }]\n";
    const std::string out = written_out(text, "scene");
    expect_part(out, "ground_m = [[0, 0], [1, -1], [2, 0], [9, 0]]");
    expect_part(out, "remove_m = [[[2, 0], [");
    expect_part(out, "[-2, ");
}

TEST(shorthand, circles_and_arcs_that_are_none_are_refused)
{
    const auto refused = [](const std::string& shape) { return error_of("[section]\noutline_m = " + shape); };
    expect_part(refused("{ center_m = [0, 0], radius_m = 0 }"), "radius above 0 m");
    expect_part(refused("{ center_m = [0, 0] }"), "has no radius_m: expected a circle");
    expect_part(refused("{ center_m = [0, 0], radius = 1 }"), "has a key radius: expected a circle");
    expect_part(refused("{ center_m = [0, 0], radius_m = 1, sides = 2 }"), "whole number from 3 to 1000");
    expect_part(refused("[{ through_m = [0, 0], to_m = [1, 1] }, [2, 2]]"), "expected a corner before");
    expect_part(refused("[[0, 0], { through_m = [1, 0], to_m = [2, 0] }]"), "on a straight line");
    expect_part(refused("[[0, 0], { through_m = [1, 0], to_m = [0, 0] }]"), "on a straight line");
}

} // namespace

} // namespace shorthand_test
