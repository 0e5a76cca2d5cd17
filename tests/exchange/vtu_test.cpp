// What a reader of the grids gets back is what was in the records.

#include "exchange/grids.hpp"

#include "section.hpp"

#include "model/error.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cstdint>
#include <cstring>

namespace jointcreep::exchange::vtu_test
{
namespace
{

std::string attribute(const std::string& grid, const std::string& name, std::size_t from = 0)
{
    const std::size_t start = grid.find(name + "=\"", from) + name.size() + 2;
    return grid.substr(start, grid.find('"', start) - start);
}

std::string bytes_of(const std::string& base64)
{
    const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string bytes;
    unsigned bits = 0;
    int held = 0;
    for (const char c : base64) {
        const std::size_t value = letters.find(c);
        if (value == std::string::npos)
            break; // padding: the array's end
        bits = bits << 6 | static_cast<unsigned>(value);
        held += 6;
        if (held >= 8)
            bytes += static_cast<char>(bits >> (held -= 8) & 255);
    }
    return bytes;
}

template <class Value>
std::vector<double> numbers_of(const std::string& bytes)
{
    std::vector<Value> values(bytes.size() / sizeof(Value));
    if (!values.empty())
        std::memcpy(values.data(), bytes.data(), values.size() * sizeof(Value));
    return {values.begin(), values.end()};
}

// The numbers of a data array, as any reader of base64 would take them.
std::vector<double> array_of(const std::string& grid, const std::string& name)
{
    const std::size_t found = grid.find(" Name=\"" + name + "\"");
    if (found == std::string::npos)
        throw std::runtime_error("there is no array " + name);
    const std::size_t begin = grid.find("encoding=\"base64\">\n_") + 20;
    const std::string bytes = bytes_of(grid.substr(begin + std::stoul(attribute(grid, "offset", found))));
    std::uint64_t size = 0;
    std::memcpy(&size, bytes.data(), sizeof size);
    const std::string type = attribute(grid, "type", grid.rfind('<', found)), own = bytes.substr(8, size);
    return type == "Float64" ? numbers_of<double>(own)
           : type == "Int32" ? numbers_of<std::int32_t>(own)
           : type == "Int64" ? numbers_of<std::int64_t>(own)
                             : numbers_of<unsigned char>(own);
}

std::vector<std::string> names_of(const std::string& grid, const std::string& name)
{
    std::vector<std::string> names(1);
    for (const double byte : array_of(grid, name)) {
        if (byte == 0)
            names.emplace_back();
        else
            names.back() += static_cast<char>(byte);
    }
    names.pop_back();
    return names;
}

using Numbers = std::vector<double>;

std::string blocks_vtu(const Section& section)
{
    return vtu_of(layer_grid(layer_of(section, "blocks")));
}

std::string edges_vtu(const Section& section)
{
    return vtu_of(layer_grid(layer_of(section, "edges")));
}

TEST(blocks_vtu, has_one_polygon_a_block_with_its_area)
{
    const Section section = small_section();
    const Network& network = section.network;
    const std::string grid = blocks_vtu(section);
    EXPECT_EQ(attribute(grid, "NumberOfPoints"), "10");
    EXPECT_EQ(attribute(grid, "NumberOfCells"), "3");
    EXPECT_EQ(array_of(grid, "types"), Numbers(3, 7));

    const Numbers position = array_of(grid, "position"), offsets = array_of(grid, "offsets"),
                  connectivity = array_of(grid, "connectivity");
    ASSERT_EQ(position.size(), 30u);
    ASSERT_EQ(offsets.size(), 3u);
    ASSERT_EQ(offsets.back(), static_cast<double>(connectivity.size()));
    std::size_t first = 0;
    for (std::size_t block = 0; block < 3; ++block) { // the hole's area must be missing from block 1
        const auto end = static_cast<std::size_t>(offsets[block]);
        double twice_area = 0;
        for (std::size_t i = first; i < end; ++i) {
            const auto p = 3 * static_cast<std::size_t>(connectivity[i]);
            const auto q = 3 * static_cast<std::size_t>(connectivity[i + 1 < end ? i + 1 : first]);
            twice_area += position[p] * position[q + 1] - position[p + 1] * position[q];
        }
        EXPECT_EQ(twice_area / 2, network.blocks.block_area[block]) << "block " << block;
        first = end;
    }
}

TEST(blocks_vtu, joins_a_hole_by_a_bridge_from_its_rightmost_corner)
{
    const Numbers connectivity = array_of(blocks_vtu(small_section()), "connectivity");
    // Block 1: from corner 2 over the bridge to 8, round the hole, and back.
    EXPECT_EQ(Numbers(connectivity.begin() + 4, connectivity.begin() + 14),
              (Numbers{0, 1, 2, 8, 7, 6, 9, 8, 2, 3}));
}

TEST(blocks_vtu, says_rock_and_stage_by_codes_with_names)
{
    Section section = small_section();
    Network& network = section.network;
    network.names.stage = {"Fu\u00dfstrecke <1> & \"2\""}; // must neither break the XML nor change
    const std::string grid = blocks_vtu(section);
    EXPECT_EQ(array_of(grid, "rock"), (Numbers{0, 1, 0}));
    EXPECT_EQ(array_of(grid, "stage"), (Numbers{0, -1, -1}));
    EXPECT_EQ(names_of(grid, "rock_names"), network.names.rock);
    EXPECT_EQ(names_of(grid, "stage_names"), network.names.stage);
}

TEST(edges_vtu, has_all_edges_and_without_equivalent_joints_no_strengths)
{
    const std::string grid = edges_vtu(small_section());
    EXPECT_EQ(array_of(grid, "edge"), (Numbers{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10}));
    EXPECT_EQ(array_of(grid, "types"), Numbers(11, 3));
    EXPECT_EQ(array_of(grid, "kind"), (Numbers{0, 0, 1, 0, 0, 0, 0, 2, 2, 2, 2}));
    EXPECT_EQ(array_of(grid, "set"), (Numbers{-1, -1, 1, -1, -1, -1, -1, -1, -1, -1, -1}));
    EXPECT_EQ(names_of(grid, "set_names"), small_network().names.joint_set);
    EXPECT_EQ(names_of(grid, "fate_names").size(), 5u);
    EXPECT_EQ(array_of(grid, "joint_fraction")[2], 0.7);
    EXPECT_EQ(array_of(grid, "realization"), Numbers(11, 4));
    const Numbers connectivity = array_of(grid, "connectivity");
    EXPECT_EQ(Numbers(connectivity.begin() + 4, connectivity.begin() + 6), (Numbers{3, 2}));
    EXPECT_THROW(array_of(grid, "cohesion"), std::runtime_error);
    EXPECT_EQ(grid.find("String"), std::string::npos) << "meshio ends at arrays of this type";
}

TEST(edges_vtu, has_the_strengths_once_they_are_known)
{
    const std::string grid = edges_vtu(small_section(true));
    const auto array_of = [](const std::string& of, const std::string& name) { // of the base and the joint
        const Numbers all = vtu_test::array_of(of, name);
        return Numbers{all.at(0), all.at(2)};
    };
    EXPECT_EQ(array_of(grid, "normal_stiffness"), (Numbers{6.9e8, 1e9 / 3}));
    EXPECT_EQ(array_of(grid, "shear_stiffness"), (Numbers{0, 2.8e8}));
    EXPECT_EQ(array_of(grid, "cohesion"), (Numbers{0, 1e5}));
    EXPECT_EQ(array_of(grid, "friction_angle"), (Numbers{0.5, 0.6}));
    EXPECT_EQ(array_of(grid, "tensile_strength"), (Numbers{0, 1e4}));
    EXPECT_EQ(array_of(grid, "dilation_angle"), (Numbers{0, 0.1}));
    EXPECT_EQ(array_of(grid, "normal_kelvin_stiffness"), (Numbers{6.9e8, 7e8}));
    EXPECT_EQ(array_of(grid, "shear_kelvin_stiffness"), (Numbers{1e8, 2e8}));
    EXPECT_EQ(array_of(grid, "normal_kelvin_viscosity"), (Numbers{5e13, 6e13}));
    EXPECT_EQ(array_of(grid, "shear_kelvin_viscosity"), (Numbers{7e13, 8e13}));
}

TEST(zones_vtu, has_only_what_is_present_in_that_state)
{
    const Result result = small_result();
    const std::string before = vtu_of(zones_grid(small_network(), result, 0)),
                      after = vtu_of(zones_grid(small_network(), result, 1));
    EXPECT_EQ(array_of(before, "zone"), (Numbers{0, 1, 2, 3}));
    EXPECT_EQ(array_of(after, "zone"), (Numbers{2, 3}));
    EXPECT_EQ(array_of(after, "gridpoint"), (Numbers{4, 5, 6, 7})); // those of removed rock are gone
    EXPECT_EQ(array_of(after, "connectivity"), (Numbers{0, 1, 2, 0, 2, 3}));
    EXPECT_EQ(array_of(after, "offsets"), (Numbers{3, 6}));
    EXPECT_EQ(array_of(after, "position"), (Numbers{0, 0, 0, 10, 0, 0, 10, 5, 0, 0, 5, 0}));
    EXPECT_EQ(array_of(after, "TimeValue"), Numbers{1});
}

TEST(zones_vtu, takes_displacement_and_stress_of_that_state)
{
    const Result result = small_result();
    const std::string after = vtu_of(zones_grid(small_network(), result, 1));
    const Numbers displacement = array_of(after, "displacement");
    ASSERT_EQ(displacement.size(), 12u);
    for (std::size_t point = 0; point < 4; ++point) {
        EXPECT_EQ(displacement[3 * point], result.states.displacement[9 + 4 + point].x());
        EXPECT_EQ(displacement[3 * point + 1], result.states.displacement[9 + 4 + point].y());
    }
    EXPECT_EQ(array_of(after, "stress_xx"), (Numbers{6e6 / 3, 7e6 / 3}));
    EXPECT_EQ(array_of(after, "stress_yy"), (Numbers{-6e5, -7e5}));
    EXPECT_EQ(array_of(after, "stress_xy"), (Numbers{60, 70}));
    EXPECT_EQ(array_of(after, "block"), (Numbers{1, 1}));
    EXPECT_EQ(array_of(after, "rock"), (Numbers{1, 1}));
    EXPECT_EQ(array_of(after, "stage"), (Numbers{-1, -1}));
    EXPECT_THROW(zones_grid(small_network(), result, 2), input_error);
}

TEST(zones_vtu, counts_displacements_anew_from_a_state_that_resets)
{
    Result result = small_result();
    EXPECT_EQ(vtu_of(zones_grid(small_network(), result, 1)).find("since_reset"), std::string::npos);
    for (std::size_t g = 0; g < 9; ++g) // a third state, moved on by [1, 2] m since the second
        result.states.displacement.push_back(result.states.displacement[9 + g] + Eigen::Vector2d(1, 2));
    const auto again = [](auto& values, std::size_t n) {
        const auto last = std::vector(values.end() - static_cast<std::ptrdiff_t>(n), values.end());
        values.insert(values.end(), last.begin(), last.end());
    };
    again(result.states.time, 1);
    again(result.states.event, 1);
    again(result.states.stress, 4);
    again(result.states.zone_present, 4);
    result.states.reset_state = {0, 1, 1};
    EXPECT_EQ(array_of(vtu_of(zones_grid(small_network(), result, 1)), "displacement_since_reset"),
              Numbers(12, 0.0));
    const Numbers since =
        array_of(vtu_of(zones_grid(small_network(), result, 2)), "displacement_since_reset");
    ASSERT_EQ(since.size(), 12u);
    for (std::size_t point = 0; point < 4; ++point) {
        EXPECT_NEAR(since[3 * point], 1, 1e-12);
        EXPECT_NEAR(since[3 * point + 1], 2, 1e-12);
    }
}

TEST(contacts_vtu, leaves_out_removed_contacts)
{
    const Result result = small_result();
    const std::string before = vtu_of(contacts_grid(result, 0)), after = vtu_of(contacts_grid(result, 1));
    EXPECT_EQ(array_of(before, "contact"), (Numbers{0, 1}));
    EXPECT_EQ(array_of(before, "position"), (Numbers{7.5, 5, 0, 2.5, 0, 0}));
    EXPECT_EQ(array_of(before, "displacement"),
              (Numbers{(6 / 3.0 + 1 / 3.0) / 2, (-6 / 7.0 - 1 / 7.0) / 2, 0, (8 / 3.0 + 4 / 3.0) / 2,
                       (-8 / 7.0 - 4 / 7.0) / 2, 0}));
    EXPECT_EQ(array_of(after, "contact"), Numbers{1});
    EXPECT_EQ(array_of(after, "edge"), Numbers{0});
    EXPECT_EQ(array_of(after, "normal"), (Numbers{0, 1, 0}));
    EXPECT_EQ(array_of(after, "length"), Numbers{5});
    EXPECT_EQ(array_of(after, "normal_traction"), Numbers{-1e6});
    EXPECT_EQ(array_of(after, "shear_traction"), Numbers{3e5});
    EXPECT_EQ(array_of(after, "normal_relative_displacement"), Numbers{-1e-3});
    EXPECT_EQ(array_of(after, "shear_relative_displacement"), Numbers{5e-4});
    EXPECT_EQ(array_of(after, "status"), Numbers{2});
    EXPECT_EQ(array_of(after, "types"), Numbers{1});
}

TEST(vtu, of_nothing_is_still_a_grid)
{
    EXPECT_EQ(attribute(blocks_vtu(Section{}), "NumberOfCells"), "0");
    EXPECT_EQ(attribute(edges_vtu(Section{}), "NumberOfCells"), "0");
}

RC_GTEST_PROP(vtu, every_double_reads_back_as_itself, (const std::vector<double>& values))
{
    Section section;
    for (const double value : values)
        section.network.blocks.vertex.emplace_back(value, -value / 3);
    const Numbers position = array_of(blocks_vtu(section), "position");
    RC_ASSERT(position.size() == 3 * values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        RC_ASSERT(position[3 * i] == values[i]);
        RC_ASSERT(position[3 * i + 1] == -values[i] / 3);
    }
}

} // namespace
} // namespace jointcreep::exchange::vtu_test
