// What forces give to exports: each name once, and a column that names a dataset has what is in it.

#include "exchange/forces.hpp"

#include "section.hpp"

#include "store/schema.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

namespace jointcreep::exchange::columns_test
{

namespace
{

using fields::Column;
using fields::ForceColumns;

void expect_each_name_once(const std::vector<Column>& columns)
{
    std::set<std::string> names;
    for (const Column& column : columns)
        EXPECT_TRUE(names.insert(column.name).second) << column.name;
}

// The value in the column's dataset.
double stored(const Result& result, const Column& column, std::size_t row_of_all)
{
    for (const fields::Field& field : store::schema::fields_of(fields::reading(result)))
        if (field.path == column.dataset) {
            EXPECT_EQ(fields::components(field.values), column.components) << column.name;
            EXPECT_EQ(field.units, column.units) << column.name;
            const std::size_t at = row_of_all * column.components + column.component;
            if (const auto* const numbers = std::get_if<std::vector<Index>*>(&field.values)) {
                EXPECT_TRUE(column.is_integer) << column.name;
                return (**numbers)[at];
            }
            EXPECT_FALSE(column.is_integer) << column.name;
            return std::get<std::span<double>>(fields::flat(field.values))[at];
        }
    ADD_FAILURE() << column.name << ": there is no dataset " << column.dataset;
    return 0;
}

// Returns how many columns name a dataset.
int expect_values_of_datasets(const Result& result, std::size_t state, std::size_t rows,
                              const std::vector<Column>& columns)
{
    int compared = 0;
    for (const Column& column : columns)
        if (!column.dataset.empty()) {
            ++compared;
            for (std::size_t row = 0; row < rows; ++row)
                EXPECT_EQ(column.value(row), stored(result, column, state * rows + row)) << column.name;
        }
    return compared;
}

} // namespace

TEST(Columns, HaveWhatIsInTheirDatasets)
{
    const Result result = small_result();
    for (const std::size_t state : {0u, 1u}) {
        const auto zones = columns_of(&ForceColumns::of_zones, result, state),
                   contacts = columns_of(&ForceColumns::of_contacts, result, state);
        EXPECT_EQ(expect_values_of_datasets(result, state, 4, zones), 3);    // stress
        EXPECT_EQ(expect_values_of_datasets(result, state, 2, contacts), 5); // traction, displacement, status
    }
}

TEST(Columns, HaveEachNameOnce)
{
    const Result result = small_result();
    expect_each_name_once(columns_of(&ForceColumns::of_edges, small_equivalent()));
    expect_each_name_once(columns_of(&ForceColumns::of_zones, result, 0));
    expect_each_name_once(columns_of(&ForceColumns::of_contacts, result, 0));
}

// Zone 2 alone yields; the others have none of it.
TEST(Columns, SpreadPlasticStrainOverAllZones)
{
    Result result = small_result();
    result.states.yielding_zone = {2};
    result.states.plastic_strain = {{1, 2, 3}, {4, 5, 6}};
    std::map<std::string, std::vector<double>> values;
    const std::vector<Column> columns = columns_of(&ForceColumns::of_zones, result, 1);
    for (const Column& column : columns)
        for (std::size_t zone = 0; zone < 4; ++zone)
            values[column.name].push_back(column.value(zone));
    EXPECT_EQ(values.at("plastic_strain_xx"), (std::vector<double>{0, 0, 4, 0}));
    EXPECT_EQ(values.at("plastic_strain_yy"), (std::vector<double>{0, 0, 5, 0}));
    EXPECT_EQ(values.at("plastic_strain_xy"), (std::vector<double>{0, 0, 6, 0}));
}

} // namespace jointcreep::exchange::columns_test
