// The format version follows its rule (docs/file-format.md): an addition raises the minor number, any other change the
// major number. tests/store/file_format.txt lists the kinds of file, attributes and datasets of the version that was
// recorded last.
//
//     RENEW_FILE_FORMAT=1 build/release/tests/store/store_tests format_version
//
// writes the list anew, if the version (libs/store/schema.hpp) has been raised as the rule wants it.

#include "store/files.hpp"
#include "store/schema.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>

namespace jointcreep::store::format_version_test
{

namespace
{

struct Format {
    std::array<Index, 2> version; // major, minor
    std::set<std::string> lines;  // a kind of file, an attribute or a dataset each

    bool operator==(const Format&) const = default;
};

std::vector<std::string> cells_of(const std::string& row)
{
    std::vector<std::string> cells;
    std::istringstream rest(row.substr(1));
    for (std::string cell; std::getline(rest, cell, '|');)
        cells.push_back(cell.size() > 2 ? cell.substr(1, cell.size() - 2) : "");
    return cells;
}

// Of the page docs/file-format.md, without its prose: names, shapes, types, units, and the part of a file that has a
// dataset.
std::set<std::string> lines_of(const std::string& page)
{
    std::set<std::string> lines;
    std::istringstream rest(page);
    std::string title;
    for (std::string row; std::getline(rest, row);) {
        if (row.starts_with("## "))
            title = row.substr(3);
        if (!row.starts_with("| `"))
            continue;
        const std::vector<std::string> cells = cells_of(row);
        if (row.starts_with("| `jointcreep "))
            lines.insert("file " + cells[0] + " of " + cells[1]);
        else if (row.starts_with("| `/"))
            lines.insert(cells[0] + " " + cells[1] + " " + cells[2] + ", " + cells[3] + ", " + title);
        else if (title == "Attributes of the file" && cells[0] != "`filetype`")
            lines.insert("attribute " + cells[0] + " " + cells[1].substr(0, cells[1].find_first_of(":;")));
        else if (title == "Attributes of the file")
            lines.insert("attribute " + cells[0] + " text");
    }
    return lines;
}

Format present()
{
    return {{schema::major_version, schema::minor_version}, lines_of(schema_markdown())};
}

Format recorded()
{
    std::ifstream file(RECORDED_FILE_FORMAT);
    Format format{};
    std::string word;
    char point = 0;
    file >> word >> format.version[0] >> point >> format.version[1] >> std::ws;
    for (std::string line; std::getline(file, line);)
        format.lines.insert(line);
    return format;
}

void record(const Format& format)
{
    std::ofstream file(RECORDED_FILE_FORMAT);
    file << "format_version " << format.version[0] << "." << format.version[1] << "\n";
    for (const std::string& line : format.lines)
        file << line << "\n";
}

std::string those_only_in(const std::set<std::string>& lines, const std::set<std::string>& others,
                          const std::string& mark)
{
    std::string text;
    for (const std::string& line : lines)
        if (!others.contains(line))
            text.append("\n  " + mark + " ").append(line);
    return text;
}

// What the rule asks for, and the version does not give; empty if it does.
std::string fault_of(const Format& before, const Format& now)
{
    const std::string gone = those_only_in(before.lines, now.lines, "-"),
                      added = those_only_in(now.lines, before.lines, "+");
    const auto raise = [](const std::string& number) {
        return "\nRaise " + number +
               " in libs/store/schema.hpp; then record the format anew (CONTRIBUTING.md).";
    };
    if (!gone.empty() && now.version[0] <= before.version[0])
        return "The file format was changed by more than additions:" + gone + added + raise("major_version");
    if (!added.empty() && now.version <= before.version)
        return "There are additions to the file format:" + added + raise("minor_version");
    if (now.version < before.version)
        return "The format version is below the recorded one." + raise("it");
    return "";
}

Format changed(Format format, Index major, Index minor, const std::string& without, const std::string& with)
{
    format.version = {major, minor};
    format.lines.erase(without);
    if (!with.empty())
        format.lines.insert(with);
    return format;
}

} // namespace

TEST(FormatVersion, RisesWithEveryChange)
{
    const std::string fault = fault_of(recorded(), present());
    ASSERT_TRUE(fault.empty()) << fault;
    if (std::getenv("RENEW_FILE_FORMAT"))
        record(present());
    EXPECT_TRUE(recorded() == present())
        << "The version is raised, but its list is not recorded:"
        << those_only_in(recorded().lines, present().lines, "-")
        << those_only_in(present().lines, recorded().lines, "+")
        << "\nRun: RENEW_FILE_FORMAT=1 build/release/tests/store/store_tests format_version";
}

TEST(FormatVersion, HasARule)
{
    const std::string edge = "`/edges/vertex` [edge, 2] int32, 1, Network",
                      more = "`/more` [edge] int32, 1, Network",
                      length = "`/edges/vertex` [edge, 2] int32, m, Network";
    const Format before{{2, 3}, {edge, "attribute `seed` uint64"}};
    const auto asks_for = [&](const char* number, const Format& now) {
        return fault_of(before, now).find(number) != std::string::npos;
    };
    EXPECT_EQ(fault_of(before, before), "");
    EXPECT_EQ(fault_of(before, changed(before, 2, 4, "", "")), "");
    EXPECT_NE(fault_of(before, changed(before, 2, 2, "", "")), "");
    // An addition.
    EXPECT_TRUE(asks_for("minor_version", changed(before, 2, 3, "", more)));
    EXPECT_EQ(fault_of(before, changed(before, 2, 4, "", more)), "");
    EXPECT_EQ(fault_of(before, changed(before, 3, 0, "", more)), "");
    EXPECT_NE(fault_of(before, changed(before, 1, 9, "", more)), "");
    // A removal, and another unit.
    for (const std::string& with : {std::string(), length}) {
        EXPECT_TRUE(asks_for("major_version", changed(before, 2, 3, edge, with)));
        EXPECT_TRUE(asks_for("major_version", changed(before, 2, 4, edge, with)));
        EXPECT_EQ(fault_of(before, changed(before, 3, 0, edge, with)), "");
    }
}

// Every dataset and attribute, with shape, type and unit.
TEST(FormatVersion, ListsTheWholeFormat)
{
    const std::set<std::string> lines = present().lines;
    for (const char* const line :
         {"file `jointcreep network` of jointgen", "attribute `filetype` text", "attribute `seed` uint64",
          "attribute `format_version` two int32 {major, minor}",
          "`/edges/vertex` [edge, 2] int32, 1, Network", "`/history/time` [time] float64, day, Result",
          "`/safety/factor` [trial] float64, 1, Factor of safety"})
        EXPECT_TRUE(lines.contains(line)) << line;
    CheckpointFile file;
    for (const fields::Field& field : schema::fields_of(file.checkpoint))
        EXPECT_TRUE(std::ranges::any_of(lines, [&](const std::string& line) {
            return line.starts_with("`" + field.path + "` ");
        })) << field.path;
}

} // namespace jointcreep::store::format_version_test
