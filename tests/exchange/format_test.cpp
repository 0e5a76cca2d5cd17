// The table of formats, names that other programs can have, and blocks with holes as convex parts.

#include "exchange/convex.hpp"
#include "exchange/format.hpp"
#include "exchange/text.hpp"

#include "section.hpp"

#include "model/error.hpp"

#include <gtest/gtest.h>

#include <set>

namespace jointcreep::exchange::format_test
{
namespace
{

TEST(convex_parts, of_a_block_with_an_island_are_convex_and_have_its_area)
{
    const Layer layer = layer_of(small_section(), "blocks");
    double area = 0;
    const std::vector<std::vector<Index>> parts = convex_parts(layer, 1);
    EXPECT_GT(parts.size(), 1u);
    for (const std::vector<Index>& part : parts) {
        double twice = 0;
        for (std::size_t i = 0, n = part.size(); i < n; ++i) {
            const Eigen::Vector2d a = layer.point[part[i]].head<2>(),
                                  b = layer.point[part[(i + 1) % n]].head<2>(),
                                  c = layer.point[part[(i + 2) % n]].head<2>();
            EXPECT_GE(cross(b - a, c - b), 0);
            twice += cross(a, b);
        }
        area += twice / 2;
    }
    EXPECT_NEAR(area, 46, 1e-12);
    EXPECT_EQ(convex_parts(layer, 0).size(), 1u);
}

// A square with holes, each by its corners, clockwise.
Layer block_with_holes(const std::vector<std::vector<Eigen::Vector3d>>& holes)
{
    Layer layer{.name = "blocks", .shape = Shape::polygons};
    layer.add_ring({{0, 0, 0}, {20, 0, 0}, {20, 20, 0}, {0, 20, 0}});
    for (const std::vector<Eigen::Vector3d>& hole : holes)
        layer.add_ring(hole);
    layer.end_row();
    return layer;
}

double area_of_parts(const Layer& layer)
{
    double area = 0;
    for (const std::vector<Index>& part : convex_parts(layer, 0))
        for (std::size_t i = 1; i + 1 < part.size(); ++i) {
            const Eigen::Vector3d &a = layer.point[part[0]], &b = layer.point[part[i]],
                                  &c = layer.point[part[i + 1]];
            const double twice = (b - a).cross(c - a).z();
            EXPECT_GE(twice, 0);
            area += twice / 2;
        }
    return area;
}

// The first hole is near the outline, but the long second one, whose corners are far, is between.
TEST(convex_parts, of_a_block_whose_holes_hide_each_other)
{
    const std::vector<Eigen::Vector3d> small{{9, 17, 0}, {9, 18, 0}, {10, 18, 0}, {10, 17, 0}},
        thin{{1, 18.5, 0}, {1, 19, 0}, {19, 19, 0}, {19, 18.5, 0}};
    for (const auto& holes : {std::vector{small, thin}, std::vector{thin, small}})
        EXPECT_NEAR(area_of_parts(block_with_holes(holes)), 400 - 1 - 9, 1e-9);
}

// Bridges from several holes begin at one corner.
TEST(convex_parts, of_a_block_with_many_holes)
{
    std::vector<std::vector<Eigen::Vector3d>> holes;
    double area = 400;
    for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) {
            const double x = 1 + 3 * i + 0.1 * j, y = 1 + 3 * j, size = 1 + 0.1 * ((i * 7 + j * 3) % 5);
            holes.push_back({{x, y, 0}, {x, y + size, 0}, {x + size, y + size, 0}, {x + size, y, 0}});
            area -= size * size;
        }
    EXPECT_NEAR(area_of_parts(block_with_holes(holes)), area, 1e-9);
}

TEST(convex_parts, that_do_not_add_up_are_refused_by_the_name_of_the_block)
{
    const auto message = [](const std::vector<std::vector<Eigen::Vector3d>>& holes) -> std::string {
        try {
            convex_parts(block_with_holes(holes), 0);
        } catch (const input_error& error) {
            return error.what();
        }
        return "accepted";
    };
    // A hole across the outline; one that runs the wrong way round.
    EXPECT_EQ(message({{{-1, 5, 0}, {-1, 6, 0}, {10, 6, 0}, {10, 5, 0}}}).substr(0, 8), "block 0 ");
    EXPECT_EQ(message({{{4, 4, 0}, {9, 4, 0}, {9, 9, 0}, {4, 9, 0}}}).substr(0, 50),

              "block 0 could not be divided into convex parts: th");
}

TEST(planes, of_traces_are_rectangles_of_a_width)
{
    const Section section = small_section();
    EXPECT_THROW(planes_of(section, {}), input_error);
    const std::vector<Plane> planes = planes_of(section, 3);
    ASSERT_EQ(planes.size(), 2u);
    EXPECT_TRUE(planes[0].centre.isApprox(Eigen::Vector3d(2, 0, 5))); // x east, y up
    EXPECT_NEAR(planes[0].dip(), 0, 1e-12);
    EXPECT_NEAR(layer_of(section, "planes", 3).area(), 3 * (4 + 3 + 1.0 / 3), 1e-12);
}

TEST(plain_names, are_plain_short_and_each_given_once)
{
    PlainNames names(10);
    const std::set<std::string> all{names.of("bedding"),           names.of("Bedding"),
                                    names.of("b\u00e4nke, \"1\""), names.of("a very long name"),
                                    names.of("a very long one"),   names.of("")};
    EXPECT_EQ(all.size(), 6u);
    for (const std::string& name : all) {
        EXPECT_LE(name.size(), 10u);
        EXPECT_FALSE(name.empty());
    }
    EXPECT_EQ(names.of("b\u00e4nke, \"1\""), "b_nke___1_");
    EXPECT_EQ(names.of("bedding"), "bedding");
}

TEST(names, are_escaped_or_refused)
{
    EXPECT_EQ(json_text("a \"b\"\\\n"), "\"a \\\"b\\\"\\\\\\u000a\"");
    EXPECT_EQ(xml_text("<a & \"b\">"), "&lt;a &amp; &quot;b&quot;&gt;");
    EXPECT_THROW(xml_text("bell\a"), input_error);
}

TEST(formats, are_found_by_name_or_by_an_extension_of_their_own)
{
    EXPECT_EQ(format_of("x.csv", {}).name, "csv");
    EXPECT_EQ(format_of("x.geojson", {}).name, "geojson");
    EXPECT_EQ(format_of("x.csv", "porepy").name, "porepy");
    EXPECT_EQ(format_of("x.xdmf", {}).name, "xdmf");
    EXPECT_THROW(format_of("x.dat", {}), input_error);
    EXPECT_THROW(format_of("x.png", {}), input_error);
    EXPECT_THROW(format_of("x.csv", "dxf"), input_error);
    EXPECT_THROW(format_of("x.csv", "none"), input_error);
    std::set<std::string_view> names;
    for (const Format& format : formats())
        EXPECT_TRUE(names.insert(format.name).second) << format.name;
}

} // namespace
} // namespace jointcreep::exchange::format_test
