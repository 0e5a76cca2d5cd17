// Stress before excavation by depth: the ground surface and the profile beside the linear law.

#include "text.hpp"

namespace in_situ_stress_test
{

using namespace jointcreep;
using namespace jointcreep::scene;

namespace
{

const std::string linear = R"(elevation_m = 20
compression_xx_MPa = 0
compression_yy_MPa = 0
shear_xy_MPa = 0
compression_xx_gradient_MPa_per_m = 0.013
compression_yy_gradient_MPa_per_m = 0.026487
shear_xy_gradient_MPa_per_m = 0
)";

InSituStress stress_of(const std::string& keys)
{
    return parse_scene(replaced(every_key_text(), linear, keys), "scene.toml").in_situ_stress;
}

std::string level(double depth, double xx, double yy, double xy)
{
    return "{ depth_m = " + shown(depth) + ", compression_xx_MPa = " + shown(xx) +
           ", compression_yy_MPa = " + shown(yy) + ", shear_xy_MPa = " + shown(xy) + " }";
}

TEST(in_situ_stress, a_ratio_is_the_linear_law_of_the_rock_s_weight)
{
    const Scene scene =
        parse_scene(replaced(every_key_text(), linear, "elevation_m = 25\nhorizontal_stress_ratio = 0.7\n"),
                    "scene.toml");
    const auto rock = std::find_if(scene.rocks.begin(), scene.rocks.end(),
                                   [&](const Rock& one) { return one.name == scene.rock; });
    const double weight = rock->density * scene.gravity;
    for (const double y : {-10.0, 0.0, 25.0}) {
        const Eigen::Vector3d stress = scene.in_situ_stress.at({3, y});
        EXPECT_DOUBLE_EQ(stress[0], -0.7 * weight * (25 - y));
        EXPECT_DOUBLE_EQ(stress[1], -weight * (25 - y));
        EXPECT_EQ(stress[2], 0);
    }
    const auto both = replaced(every_key_text(), linear, linear + "horizontal_stress_ratio = 0.7\n");
    expect_part(refusal(both), "expected either horizontal_stress_ratio or the linear keys");
}

// The linear law from -10 m to 30 m, over ground at 25 m.
TEST(in_situ_stress, flat_ground_and_two_levels_are_the_linear_law)
{
    const auto gradients = "compression_xx_MPa = 1.5\ncompression_yy_MPa = 0.2\nshear_xy_MPa = -0.3\n"
                           "compression_xx_gradient_MPa_per_m = 0.02\n"
                           "compression_yy_gradient_MPa_per_m = 0.027\nshear_xy_gradient_MPa_per_m = 0.01\n";
    const auto profile = "profile = [" + level(5, 1.6, 0.335, -0.25) + ", " + level(15, 1.8, 0.605, -0.15) +
                         "]\n"; // the law at 5 m and 15 m: above and below them it goes straight on
    const auto elevation = "elevation_m = 25\n", ground = "ground_m = [[-3, 25], [17, 25], [40, 25]]\n";
    const InSituStress law = stress_of(elevation + std::string(gradients)),
                       on_ground = stress_of(ground + std::string(gradients)),
                       by_levels = stress_of(elevation + profile), both = stress_of(ground + profile);
    for (const double x : {0.0, 16.9, 17.0, 40.0})
        for (const double y : {-10.0, 8.0, 10.0, 15.0, 20.0, 25.0, 30.0}) {
            const Eigen::Vector3d expected = law.at({x, y});
            EXPECT_NEAR(expected[1], -(0.2e6 + 0.027e6 * (25 - y)), 1e-6);
            for (const InSituStress* other : {&on_ground, &by_levels, &both})
                EXPECT_LT((other->at({x, y}) - expected).norm(), 1e-3) << x << ", " << y; // Pa, of 1e6
        }
}

TEST(in_situ_stress, depth_is_vertical_below_the_ground)
{
    const InSituStress stress = stress_of("ground_m = [[0, 20], [10, 24], [40, 21]]\n"
                                          "profile = [" +
                                          level(0, 0, 0, 0) + ", " + level(2, 3, 0.05, 0.1) + ", " +
                                          level(12, 3.5, 0.35, 0.4) + "]\n");
    EXPECT_DOUBLE_EQ(stress.depth_of({0, 20}), 0);
    EXPECT_DOUBLE_EQ(stress.depth_of({5, 12}), 10);
    EXPECT_DOUBLE_EQ(stress.depth_of({10, 12}), 12);
    EXPECT_DOUBLE_EQ(stress.depth_of({25, 12}), 10.5);
    EXPECT_DOUBLE_EQ(stress.depth_of({40, 12}), 9);
    EXPECT_DOUBLE_EQ(stress.depth_of({41, 12}), 9); // level beyond its ends
    EXPECT_DOUBLE_EQ(stress.depth_of({-1, 12}), 8);
    // Depths of 1, 2, 7 and 22 m, half way down the first piece, at the kink, and beyond.
    EXPECT_LT((stress.at({10, 23}) - Eigen::Vector3d(-1.5e6, -0.025e6, 0.05e6)).norm(), 1e-3);
    EXPECT_LT((stress.at({10, 22}) - Eigen::Vector3d(-3e6, -0.05e6, 0.1e6)).norm(), 1e-3);
    EXPECT_LT((stress.at({10, 17}) - Eigen::Vector3d(-3.25e6, -0.2e6, 0.25e6)).norm(), 1e-3);
    EXPECT_LT((stress.at({10, 2}) - Eigen::Vector3d(-4e6, -0.65e6, 0.7e6)).norm(), 1e-3);
}

TEST(in_situ_stress, either_this_or_that)
{
    const auto text = every_key_text();
    const auto by = [&](const std::string& keys) { return refusal(replaced(text, linear, keys)); };
    const std::string profile = "profile = [" + level(0, 1, 0, 0) + ", " + level(9, 1, 0, 0) + "]\n";
    expect_part(by(linear + "ground_m = [[0, 20], [40, 20]]\n"), "either it or elevation_m");
    expect_part(by(profile), "has no elevation_m: expected it, or ground_m");
    const auto either = "expected either profile or the linear keys (";
    expect_part(by(linear + profile), either);
    expect_part(by("elevation_m = 20\n" + profile + "compression_xx_MPa = 0\n"), either);
    expect_part(by("elevation_m = 20\nshear_xy_gradient_MPa_per_m = 0\n" + profile), either);
    expect_part(by("elevation_m = 20\n"), "expected the keys of a linear law");
    expect_part(by("elevation_m = 20\nshear_xy_MPa = 0\n"), "has no compression_xx_MPa");
    expect_part(by("ground_m = [[0, 20], [39, 20]]\n" + profile),
                "across the whole section, from x = 0 to 40 m");
    expect_part(by("ground_m = [[1, 20], [40, 20]]\n" + profile), "across the whole section");
    expect_part(by("ground_m = [[0, 20], [20, 20], [20, 22], [40, 20]]\n" + profile), "x increasing");
    expect_part(by("ground_m = [[0, 20]]\n" + profile), "at least 2 corners");
    expect_part(by("elevation_m = 20\nprofile = [" + level(0, 1, 0, 0) + "]\n"), "2 of them at least");
    expect_part(by("elevation_m = 20\nprofile = [" + level(2, 1, 0, 0) + ", " + level(2, 1, 0, 0) + "]\n"),
                "depth_m increasing");
    expect_part(by("elevation_m = 20\nprofile = [" + level(-2, 1, 0, 0) + ", " + level(2, 1, 0, 0) + "]\n"),
                "[in_situ_stress] profile depth_m = -2");
    expect_part(by("ground_m = 20\n" + profile),
                "ground_m = 20 m: expected a line [[x, y], [x, y], ...] of numbers");
    expect_part(by("elevation_m = 20\nprofile = 3\n"),
                "profile = 3: expected levels [{ depth_m = 0, compression_xx_MPa");
    EXPECT_EQ(by("ground_m = [[0, 20], [40, 20]]\n" + profile), "accepted");
}

// The section's top is at y = 20 from x = 0 to 40.
TEST(in_situ_stress, no_rock_above_the_ground)
{
    const auto by = [](const std::string& line) {
        return refusal(replaced(every_key_text(), linear,
                                "ground_m = " + line + "\nprofile = [" + level(0, 1, 0, 0) + ", " +
                                    level(9, 1, 0, 0) + "]\n"));
    };
    expect_part(by("[[0, 10], [40, 10]]"), "the section's outline is 10 m above it at x ="); // through it
    expect_part(by("[[0, -9], [40, -9]]"),
                "the section's outline is 29 m above it at x ="); // below all of it
    expect_part(by("[[0, 20], [40, 19]]"), "outline is 1 m above it at x = 40 m");
    expect_part(by("[[0, 21], [16, 18], [40, 21]]"),
                "outline is 2 m above it at x = 16 m"); // between its corners
    expect_part(by("[[0, 20], [40, 19.9999]]"), "above it");
    EXPECT_EQ(by("[[0, 20], [16, 23], [40, 20]]"), "accepted");
    EXPECT_EQ(by("[[-5, 7], [0, 20], [40, 20], [45, 7]]"), "accepted"); // beside the section it may be lower
    EXPECT_EQ(by("[[0, 20], [40, 19.99999999]]"), "accepted");          // rounding
}

} // namespace

} // namespace in_situ_stress_test
