// The schema is whole: every member of every record once, every dimension known, and the page in docs made
// from it.

#include "random_records.hpp"

#include "joint/law.hpp"

#include <set>

namespace jointcreep::store::schema_test
{

namespace
{

std::vector<fields::Field> all_fields(CheckpointFile& file)
{
    std::vector<fields::Field> all;
    for (const auto& fields :
         {schema::fields_of(file.provenance), schema::fields_of(file.provenance.warnings),
          schema::fields_of(file.network), schema::fields_of(file.equivalent), schema::fields_of(file.result),
          schema::fields_of(file.result.step_history), schema::fields_of(file.result.failure),
          schema::fields_of(file.result.dynamics), schema::fields_of(file.result.guards),
          schema::fields_of(file.safety), schema::fields_of(file.checkpoint),
          schema::fields_of(file.checkpoint.dynamics)})
        all.insert(all.end(), fields.begin(), fields.end());
    return all;
}

std::string without_one(const std::string& dimension)
{
    return dimension.ends_with("+1") ? dimension.substr(0, dimension.size() - 2) : dimension;
}

} // namespace

// Bytes that no field covers would be a member that files forget. Small members fill 8 bytes each.
TEST(Schema, CoversEveryMember)
{
    CheckpointFile file;
    std::size_t covered = sizeof file.provenance.seed + 8; // these two and the realization are attributes
    covered += sizeof EquivalentJoints::strength_divisor +
               sizeof(decltype(EquivalentJoints::material)); // in no file
    std::set<const void*> places;
    for (const fields::Field& field : all_fields(file))
        std::visit(
            [&](auto* place) {
                covered += (sizeof *place + 7) / 8 * 8;
                EXPECT_TRUE(places.insert(place).second) << field.path << " has the place of another field";
            },
            field.values);
    // The parameters of single laws are in a map, and not in the record.
    covered += sizeof(decltype(file.equivalent.own));
    covered -= file.equivalent.own.size() * sizeof(std::vector<double>);
    std::size_t own = 0;
    for (const joint::Parameter& parameter : joint::all_parameters())
        own += parameter.in_joints == nullptr;
    EXPECT_EQ(file.equivalent.own.size(), own);
    EXPECT_EQ(own, joint::all_parameters().size() - joint::parameters::of_all_joints().size());
    EXPECT_EQ(covered, sizeof(CheckpointFile));
}

TEST(Schema, NamesEveryDatasetOnce)
{
    CheckpointFile file;
    std::set<std::string> paths;
    for (const fields::Field& field : all_fields(file)) {
        EXPECT_TRUE(paths.insert(field.path).second) << field.path;
        EXPECT_FALSE(field.units.empty()) << field.path;
        EXPECT_TRUE(field.description.ends_with(".")) << field.path;
    }
}

// Days only for times since the start, text without a unit.
TEST(Schema, UsesSiUnits)
{
    const std::set<std::string> si = {"1",    "m",      "m2",  "m2/J", "rad", "s",  "Pa",
                                      "Pa/m", "Pa s/m", "J/m", "m/s",  "N/m", "1/m"};
    CheckpointFile file;
    for (const fields::Field& field : all_fields(file)) {
        EXPECT_TRUE(si.contains(field.units) || (field.units == "day" && field.path.ends_with("/time")))
            << field.path;
        const bool is_real = std::holds_alternative<std::span<double>>(fields::flat(field.values));
        EXPECT_TRUE(is_real || field.units == "1") << field.path;
    }
}

// The size of a dimension must be known from an array that has only that one, or all before it sized so.
TEST(Schema, KnowsItsDimensions)
{
    std::set<std::string> described, sized;
    for (const fields::Described& dimension : schema::dimensions())
        described.insert(dimension.name);
    CheckpointFile file;
    for (const fields::Field& field : all_fields(file)) {
        if (field.dimensions.size() == 1)
            sized.insert(without_one(field.dimensions[0]));
        if (field.dimensions == std::vector<std::string>{"edge", "kelvin_unit"})
            sized.insert("kelvin_unit");
        for (const std::string& dimension : field.dimensions)
            EXPECT_TRUE(sized.contains(without_one(dimension))) << field.path << ": " << dimension;
    }
    for (const fields::Field& field : all_fields(file))
        for (const std::string& dimension : {field.limits.index_of, field.limits.rows_of})
            EXPECT_TRUE(dimension.empty() || sized.contains(dimension)) << field.path << ": " << dimension;
    EXPECT_EQ(described, sized);
}

TEST(Schema, KeepsThePathsThatScriptsRelyOn)
{
    CheckpointFile file;
    std::map<std::string, fields::Field> fields;
    for (const fields::Field& field : all_fields(file))
        fields.emplace(field.path, field);
    EXPECT_EQ(fields.at("/history/time").units, "day");
    EXPECT_TRUE(fields.contains("/history/event"));
    EXPECT_TRUE(fields.contains("/history/point"));
    const std::vector<std::string> time_point = {"time", "point"};
    EXPECT_EQ(fields.at("/history/displacement").dimensions, time_point);
    EXPECT_EQ(fields::components(fields.at("/history/displacement").values), 2u);
    EXPECT_EQ(fields.at("/history/present").dimensions, time_point);
}

TEST(Schema, IsDescribedInDocs)
{
    EXPECT_EQ(bytes_of(FILE_FORMAT_PAGE), schema_markdown())
        << "The page is out of date; make it again: jointexport --file-format > docs/file-format.md";
}

} // namespace jointcreep::store::schema_test
