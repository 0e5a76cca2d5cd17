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
