// A reader that follows the file into the datasets finds each state's own numbers, and hides what is removed.

#include "exchange/xdmf.hpp"

#include "section.hpp"

#include "model/error.hpp"

#include <gtest/gtest.h>

#include <iterator>
#include <map>
#include <sstream>

namespace jointcreep::exchange::xdmf_test
{
namespace
{

using Numbers = std::vector<double>;

Numbers numbers(const std::string& text)
{
    std::istringstream words(text);
    return {std::istream_iterator<double>(words), {}};
}

// The text between `open` and the next `close`, the n-th time that `open` is there.
std::string between(const std::string& text, const std::string& open, const std::string& close, int n = 0)
{
    std::size_t found = text.find(open);
    for (; n > 0 && found != std::string::npos; --n)
        found = text.find(open, found + 1);
    if (found == std::string::npos)
        throw std::runtime_error("there is no " + open);
    const std::size_t start = found + open.size();
    return text.substr(start, text.find(close, start) - start);
}

std::string state_of(const std::string& file, int state)
{
    return between(file, "<Grid Name=\"state " + std::to_string(state) + "\"", "</Grid>");
}

std::string attribute_of(const std::string& file, int state, const std::string& name)
{
    return between(state_of(file, state), "<Attribute Name=\"" + name + "\"", "</Attribute>");
}

template <class Rows>
Numbers flat(const Rows& rows)
{
    Numbers values;
    for (const auto& row : rows)
        for (int i = 0; i < row.size(); ++i)
            values.push_back(row[i]);
    return values;
}

// The datasets that are referred to, as they are in result.h5: their shapes and numbers.
struct Dataset {
    Numbers shape, values;
};

std::map<std::string, Dataset> datasets_of(const Result& result)
{
    const States& states = result.states;
    return {
        {"/states/displacement", {{2, 9, 2}, flat(states.displacement)}},
        {"/states/stress", {{2, 4, 3}, flat(states.stress)}},
        {"/states/traction", {{2, 2, 2}, flat(states.traction)}},
        {"/states/relative_displacement", {{2, 2, 2}, flat(states.relative_displacement)}},
        {"/states/zone_present", {{2, 4}, {states.zone_present.begin(), states.zone_present.end()}}},
        {"/states/contact_status", {{2, 2}, {states.contact_status.begin(), states.contact_status.end()}}}};
}

// What a reader gets for an attribute of a state: the part of the dataset that the hyperslab selects.
Numbers read(const std::string& file, int state, const std::string& name)
{
    const std::string attribute = attribute_of(file, state, name);
    const Numbers slab = numbers(between(attribute, "Dimensions=\"3 ", "</DataItem>").substr(3));
    const std::string source = between(attribute, "<DataItem Format=\"HDF\"", "</DataItem>");
    const Dataset dataset = datasets_of(small_result()).at(source.substr(source.find(":/") + 1));
    EXPECT_EQ(numbers(between(source, "Dimensions=\"", "\"")), dataset.shape) << name;
    const std::size_t rank = dataset.shape.size();
    EXPECT_EQ(slab.size(), 3 * rank) << name;

    Numbers values;
    for (std::size_t i = 0; i < dataset.values.size(); ++i) {
        bool selected = true;
        std::size_t rest = i;
        for (std::size_t d = rank; d-- > 0;) {
            const auto length = static_cast<std::size_t>(dataset.shape[d]);
            const auto at = static_cast<double>(rest % length);
            rest /= length;
            EXPECT_EQ(slab[rank + d], 1) << name; // stride
            selected = selected && at >= slab[d] && at < slab[d] + slab[2 * rank + d];
        }
        if (selected)
            values.push_back(dataset.values[i]);
    }
    double size = 1; // that the attribute and its hyperslab declare
    for (const double length : numbers(between(attribute, "Dimensions=\"", "\"")))
        size *= length;
    EXPECT_EQ(size, static_cast<double>(values.size())) << name;
    EXPECT_EQ(between(attribute, "Dimensions=\"", "\"", 0), between(attribute, "Dimensions=\"", "\"", 1));
    return values;
}

// The values of vtkGhostType in a state.
Numbers ghosts(const std::string& file, int state)
{
    const std::string reference =
        between(attribute_of(file, state, "vtkGhostType"), "/Xdmf/Domain/DataItem[", "]");
    const std::string item =
        between(file.substr(0, file.find("<Grid")), "<DataItem", "</DataItem>", std::stoi(reference) - 1);
    EXPECT_NE(item.find("UChar"), std::string::npos);
    return numbers(item.substr(item.find('>') + 1));
}

double time_of(const std::string& file, int state)
{
    return std::strtod(between(state_of(file, state), "<Time Value=\"", "\"").c_str(), nullptr);
}

TEST(zones_xdmf, finds_displacement_and_stress_of_each_state)
{
    const Result result = small_result();
    const std::string file = zones_xdmf(result, "result.h5");
    const Numbers displacement = flat(result.states.displacement), stress = flat(result.states.stress);
    for (int state = 0; state < 2; ++state) {
        EXPECT_EQ(read(file, state, "displacement"),
                  Numbers(displacement.begin() + 18 * state, displacement.begin() + 18 * (state + 1)));
        for (int column = 0; column < 3; ++column) {
            Numbers wanted;
            for (int zone = 0; zone < 4; ++zone)
                wanted.push_back(stress[static_cast<std::size_t>(12 * state + 3 * zone + column)]);
            const std::string name =
                std::vector{"stress_xx", "stress_yy", "stress_xy"}.at(static_cast<std::size_t>(column));
            EXPECT_EQ(read(file, state, name), wanted);
        }
    }
    EXPECT_EQ(read(file, 1, "zone_present"), (Numbers{0, 0, 1, 1}));
}

TEST(zones_xdmf, hides_removed_zones)
{
    const std::string file = zones_xdmf(small_result(), "result.h5");
    EXPECT_EQ(ghosts(file, 0), (Numbers{0, 0, 0, 0}));
    EXPECT_EQ(ghosts(file, 1), (Numbers{32, 32, 0, 0}));
}

TEST(zones_xdmf, says_what_is_hidden_once_for_all_states_alike)
{
    Result result = small_result();
    States& states = result.states;
    states.time.push_back(5);
    states.event.emplace_back();
    for (int i = 0; i < 4; ++i)
        states.zone_present.push_back(states.zone_present[static_cast<std::size_t>(4 + i)]);
    const std::string file = zones_xdmf(result, "result.h5");
    EXPECT_EQ(ghosts(file, 2), ghosts(file, 1));
    const std::string head = file.substr(0, file.find("<Grid"));
    EXPECT_THROW(between(head, "<DataItem", ">", 2), std::runtime_error);
}

TEST(zones_xdmf, tells_states_at_one_time_apart)
{
    Result result = small_result();
    result.states.time = {31, 31};
    std::string file = zones_xdmf(result, "result.h5");
    EXPECT_EQ(time_of(file, 0), 30.999);
    EXPECT_EQ(time_of(file, 1), 31);
    result.states.time = {30.5, 31};
    file = zones_xdmf(result, "result.h5");
    EXPECT_EQ(time_of(file, 0), 30.5);
    EXPECT_EQ(time_of(file, 1), 31);
}

TEST(zones_xdmf, names_the_result_file)
{
    const std::string file = zones_xdmf(small_result(), "../a & b.h5");
    EXPECT_NE(file.find(">../a &amp; b.h5:/mesh/gridpoint_position<"), std::string::npos);
}

TEST(contacts_xdmf, finds_tractions_displacements_and_status_of_each_state)
{
    const std::string file = contacts_xdmf(small_result(), "result.h5");
    EXPECT_EQ(read(file, 0, "normal_traction"), (Numbers{-1e6, -2e6}));
    EXPECT_EQ(read(file, 0, "shear_traction"), (Numbers{2e5, 0}));
    EXPECT_EQ(read(file, 1, "normal_relative_displacement"), (Numbers{0, -1e-3}));
    EXPECT_EQ(read(file, 1, "shear_relative_displacement"), (Numbers{0, 5e-4}));
    EXPECT_EQ(read(file, 1, "status"), (Numbers{0, 2}));
    EXPECT_EQ(ghosts(file, 0), (Numbers{0, 0}));
    EXPECT_EQ(ghosts(file, 1), (Numbers{32, 0}));
}

TEST(xdmf, of_nothing_is_refused)
{
    EXPECT_THROW(zones_xdmf(Result{}, "result.h5"), input_error);
    EXPECT_THROW(contacts_xdmf(Result{}, "result.h5"), input_error);
    Result result = small_result();
    result.mesh.contact_edge.clear();
    result.states.contact_status.clear();
    EXPECT_THROW(contacts_xdmf(result, "result.h5"), input_error);
}

} // namespace
} // namespace jointcreep::exchange::xdmf_test
