// The tables hold the records' numbers, and names survive their quotes.

#include "exchange/csv.hpp"

#include "joint/law.hpp"
#include "section.hpp"

#include "model/error.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include <cstdlib>

namespace jointcreep::exchange::csv_test
{
namespace
{

using Row = std::vector<std::string>;

// Rows and fields by RFC 4180.
std::vector<Row> rows_of(const std::string& table)
{
    std::vector<Row> rows(1, Row(1));
    bool quoted = false;
    for (std::size_t i = 0; i < table.size(); ++i) {
        const char c = table[i];
        if (quoted && c == '"' && i + 1 < table.size() && table[i + 1] == '"')
            rows.back().back() += table[++i];
        else if (c == '"')
            quoted = !quoted;
        else if (!quoted && c == ',')
            rows.back().emplace_back();
        else if (!quoted && c == '\n')
            rows.emplace_back(1);
        else
            rows.back().back() += c;
    }
    rows.pop_back();
    for (const Row& row : rows)
        EXPECT_EQ(row.size(), rows.front().size());
    return rows;
}

double number(const std::string& text)
{
    return std::strtod(text.c_str(), nullptr);
}

std::string csv_of(const Section& section, std::string_view name)
{
    const std::vector<Layer> layers{layer_of(section, name)};
    return layers_csv(layers);
}

TEST(joints_csv, has_a_row_a_trace_inside_the_section)
{
    Section section = small_section();
    const auto rows = rows_of(csv_of(section, "joints"));
    ASSERT_EQ(rows.size(), 3u);
    EXPECT_EQ(rows[0], (Row{"set", "number", "x1_m", "y1_m", "x2_m", "y2_m", "length_m", "cut_ends", "joint",
                            "fate", "realization"}));
    EXPECT_EQ(rows[1], (Row{"the \"other\" set", "7", "0", "5", "4", "5", "4", "0", "0", "kept", "4"}));
    EXPECT_NEAR(number(rows[2][4]), 1.0 / 3.0 + 9, 1e-14);

    section.outline = {
        {1, 0}, {9, 0}, {9, 10}, {1, 10}}; // cuts off 1 m of the first trace, a third of the second
    const auto cut = rows_of(csv_of(section, "joints"));
    EXPECT_EQ(cut[1][2], "1");
    EXPECT_EQ(cut[1][6], "3");
    EXPECT_EQ(cut[1][7], "1");
    EXPECT_EQ(cut[2][4], "9");
    EXPECT_EQ(cut[2][7], "1");
    section.outline = {{1, 0}, {3, 0}, {3, 10}, {1, 10}};
    EXPECT_EQ(rows_of(csv_of(section, "joints"))[1][7], "2");
    EXPECT_EQ(rows_of(csv_of(section, "joints")).size(), 2u);

    const auto bridges = rows_of(csv_of(small_section(), "bridges"));
    ASSERT_EQ(bridges.size(), 3u);
    EXPECT_EQ(bridges[1][2], "4");
    EXPECT_EQ(bridges[1][4], "6");
}

TEST(csv_field, is_in_quotes_where_it_begins_as_a_formula_does)
{
    for (const std::string name : {"=1+1", "+A", "-10 m", "@x", "\tx"})
        EXPECT_EQ(csv_field(name), '"' + name + '"');
    for (const std::string name : {"A", "1", "a=b", " =1", ""})
        EXPECT_EQ(csv_field(name), name);
}

TEST(blocks_csv, has_area_and_centroid_with_holes_taken_out)
{
    Section section = small_section();
    for (const double offset : {0.0, 1e7}) { // as accurate in a national grid
        for (Eigen::Vector2d& vertex : section.network.blocks.vertex)
            vertex.x() += offset;
        const auto rows = rows_of(csv_of(section, "blocks"));
        ASSERT_EQ(rows.size(), 4u);
        EXPECT_EQ(rows[1], (Row{"0", "upper", "dig", "50", shown(5 + offset), "7.5", "4", "0", "4"}));
        EXPECT_EQ(rows[2][1], "lower");
        EXPECT_EQ(rows[2][2], "");
        EXPECT_NEAR(number(rows[2][4]), 5 + offset, 1e-8);
        EXPECT_NEAR(number(rows[2][5]), (50 * 2.5 - 4 * 2) / 46, 1e-12);
        EXPECT_EQ(rows[2][6], "8");
        EXPECT_EQ(rows[2][7], "1");
        EXPECT_EQ(rows[3][3], "4");
    }
}

TEST(edges_csv, names_sides_joint_and_kind)
{
    const auto rows = rows_of(csv_of(small_section(), "edges"));
    ASSERT_EQ(rows.size(), 12u);
    EXPECT_EQ(rows[1], (Row{"0", "0", "0", "10", "0", "1", "", "boundary", "", "", "", "", "", "4"}));
    EXPECT_EQ(rows[3], (Row{"2", "0", "5", "10", "5", "0", "1", "joint", "the \"other\" set", "7", "0.7", "0",
                            "kept", "4"}));
    EXPECT_EQ(rows[8][7], "bonded");
}

TEST(edges_csv, adds_the_equivalent_joints)
{
    const auto rows = rows_of(csv_of(small_section(true), "edges"));
    const auto column = [&](const std::string& name) {
        const auto found = std::ranges::find(rows[0], name);
        EXPECT_NE(found, rows[0].end()) << name;
        return found - rows[0].begin();
    };
    const std::pair<const char*, double> values[] = {{"normal_stiffness_Pa_per_m", 1e9 / 3},
                                                     {"friction_angle_rad", 0.6},
                                                     {"dilation_angle_rad", 0.1},
                                                     {"shear_kelvin_viscosity_Pa_s_per_m", 8e13},
                                                     {"shear_maxwell_viscosity_Pa_s_per_m", 3e15},
                                                     {"law", 1},
                                                     {"residual_cohesion_Pa", 2e4},
                                                     {"residual_friction_angle_rad", 0.4},
                                                     {"roughness", 8},
                                                     {"wall_strength_Pa", 5e7},
                                                     {"largest_closure_m", 2e-4},
                                                     {"dilation_until_m", 0.03}};
    for (const auto& [name, value] : values)
        EXPECT_EQ(number(rows[3][column(name)]), value) << name;
    std::set<std::string> names(rows[0].begin(), rows[0].end());
    EXPECT_EQ(names.size(), rows[0].size());
    const std::vector<std::string> of_joints{"normal_stiffness_Pa_per_m",
                                             "shear_stiffness_Pa_per_m",
                                             "cohesion_Pa",
                                             "friction_angle_rad",
                                             "tensile_strength_Pa",
                                             "dilation_angle_rad",
                                             "dilation_until_m",
                                             "residual_cohesion_Pa",
                                             "residual_friction_angle_rad",
                                             "roughness",
                                             "wall_strength_Pa",
                                             "largest_closure_m",
                                             "dilation_wear_m2_per_J",
                                             "initial_friction_angle_rad",
                                             "roughness_length_m"};
    const std::vector<joint::Parameter>& all = joint::all_parameters();
    ASSERT_EQ(rows[0].size(), 14 + all.size() + 4 + 2 + 1);
    ASSERT_GE(all.size(), of_joints.size());
    for (std::size_t i = 0; i < all.size(); ++i)
        EXPECT_TRUE(rows[0][14 + i].starts_with(all[i].name)) << rows[0][14 + i];
    for (std::size_t i = 0; i < of_joints.size(); ++i)
        EXPECT_EQ(rows[0][14 + i], of_joints[i]);
    EXPECT_EQ(number(rows[2][14]), 0);
}

TEST(edges_csv, numbers_kelvin_units_where_there_are_several)
{
    Section section = small_section(true);
    EquivalentJoints& equivalent = *section.equivalent;
    const std::size_t edges = equivalent.normal_stiffness.size();
    equivalent.normal_kelvin_stiffness.assign(2 * edges, 0);
    equivalent.normal_kelvin_stiffness[2 * 2 + 1] = 5e8; // of edge 2 the second unit
    equivalent.shear_kelvin_stiffness.assign(2 * edges, 0);
    equivalent.normal_kelvin_viscosity.assign(2 * edges, 0);
    equivalent.shear_kelvin_viscosity.assign(2 * edges, 0);
    const auto rows = rows_of(csv_of(section, "edges"));
    const std::size_t first = 14 + joint::all_parameters().size();
    EXPECT_EQ(rows[0][first + 0], "normal_kelvin_stiffness_1_Pa_per_m");
    EXPECT_EQ(rows[0][first + 4], "normal_kelvin_stiffness_2_Pa_per_m");
    EXPECT_EQ(number(rows[3][first]), 0);
    EXPECT_EQ(number(rows[3][first + 4]), 5e8);
    EXPECT_EQ(rows[0][first + 9], "shear_maxwell_viscosity_Pa_s_per_m");
}

TEST(histories_csv, has_a_row_a_time_and_three_columns_a_point)
{
    const auto rows = rows_of(histories_csv(small_result().history));
    ASSERT_EQ(rows.size(), 4u);
    EXPECT_EQ(rows[0], (Row{"time_day", "event", "A_x_m", "A_y_m", "A_present", "B, deep_x_m", "B, deep_y_m",
                            "B, deep_present"}));
    EXPECT_EQ(rows[1], (Row{"0", "", "0", "0", "1", "0", "0", "1"}));
    EXPECT_EQ(rows[3][1], "dig");
    EXPECT_EQ(rows[3][4], "0");
    EXPECT_EQ(number(rows[3][5]), 0.1 + 0.2);
    EXPECT_EQ(number(rows[3][6]), -1.0 / 3.0);
    EXPECT_EQ(rows[3][7], "1");
}

TEST(histories_csv, counts_anew_from_a_stage_that_resets)
{
    History history = small_result().history;
    history.reset_row = {0, 1, 1};
    const auto rows = rows_of(histories_csv(history));
    EXPECT_EQ(rows[0][8], "A_since_reset_x_m");
    EXPECT_EQ(rows[0][11], "B, deep_since_reset_y_m");
    for (std::size_t column = 8; column < 12; ++column) {
        const std::size_t of = column < 10 ? column - 6 : column - 5; // A_x_m is column 2, B_x_m column 5
        EXPECT_EQ(number(rows[1][column]), number(rows[1][of]));
        EXPECT_EQ(number(rows[2][column]), 0);
        EXPECT_EQ(number(rows[3][column]), number(rows[3][of]) - number(rows[2][of]));
    }
}

TEST(failure_csv, has_a_row_for_each_block_or_the_reason_alone)
{
    Blocks blocks;
    blocks.block_area = {2, 3, 0.1 + 0.2};
    Failure failure{
        .reason = "blocks move, and fall", .stage = "dig", .time = 1.5, .moves_on = 1, .steps = 5000};
    const Row alone{"", "", "", "", "", "", "5000", "1", "dig", "1.5", "blocks move, and fall"};
    auto rows = rows_of(failure_csv(failure, blocks));
    EXPECT_EQ(rows[0].size(), alone.size());
    EXPECT_EQ(rows[1], alone);

    failure.block = {2, 0};
    failure.place = {{1, 2}, {3, 4}};
    failure.motion = {{0, -0.5}, {0.25, 0}};
    rows = rows_of(failure_csv(failure, blocks));
    EXPECT_EQ(rows[1],
              (Row{"2", "1", "2", shown(0.1 + 0.2), "0", "-0.5", "5000", "1", "dig", "1.5", failure.reason}));
    EXPECT_EQ(rows[2][0], "0");
    EXPECT_EQ(rows[2][3], "2");
}

} // namespace
} // namespace jointcreep::exchange::csv_test
