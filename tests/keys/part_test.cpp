// Tables of a whole that is no scene: read in their turns, refused by line, and checked.

#include "keys/part.hpp"

#include "keys/polygon.hpp"

#include <gtest/gtest.h>

namespace part_test
{

using namespace jointcreep;
using namespace jointcreep::keys;

namespace
{

struct Bolt {
    std::string name;
    double length = 0, installed = 0; // [m], since start [s]
    Polygon plate{};
};

struct Works {
    std::vector<Bolt> bolts{};
    std::optional<Bolt> spare{};
};

struct Begin {
    Calendar& calendar;
};

Table<Bolt> bolt(const std::string& name, Written written)
{
    return {{name, written, Need::optional, "A bolt.", Written::in_list, "old_" + name},
            {text("name", &Bolt::name, "Name."),
             number("length_mm", &Bolt::length, millimetres, above(0).to(1e4), "Length.").formerly("size_mm"),
             date("installed", &Bolt::installed, "When.").or_else(std::int64_t{0}),
             polygon("plate_m", &Bolt::plate, "Its plate.").optional()}};
}

// The calendar stands behind the bolts, whose dates need it.
std::vector<Part<Works>> parts()
{
    const KeyInfo start{"start", "date", days, within(farthest_day), "Start."};
    const auto calendar = [](Begin& all) -> Calendar& { return all.calendar; };
    const Table<Begin> begin{{"begin", Written::once, Need::required, "Start of time."},
                             {key_of<Begin>(start, calendar, read_start)}};
    auto bolts = part_in_list(bolt("bolt", Written::in_list), &Works::bolts);
    bolts.turn = Turn::dated;
    bolts.has_names = true;
    bolts.shapes = [](const Works& works, const Source& source) {
        for (std::size_t i = 0; i < works.bolts.size(); ++i)
            if (!works.bolts[i].plate.empty())
                check_polygon(source.in_list("bolt", i), "plate_m", works.bolts[i].plate);
    };
    auto spare = part_if_given(bolt("spare", Written::once), &Works::spare);
    spare.turn = Turn::settings;
    auto schedule = part_read_by<Works>(begin, [begin](const TomlValue& root, Reading& reading, Works&) {
        Begin record{reading.calendar};
        read_once(begin, root, reading, record);
    });
    schedule.turn = Turn::calendar;
    return {bolts, spare, schedule};
}

Works works_of(const std::string& text)
{
    const TomlValue root = parse_toml(text, "works.toml");
    Reading reading{.name = "works.toml", .whole = "plan"};
    Works works;
    read_parts(parts(), root, reading, works);
    const Source source{root, reading};
    check_names(parts(), source);
    check_parts(parts(), &Part<Works>::shapes, works, source);
    return works;
}

std::string refusal(const std::string& text)
{
    try {
        works_of(text);
        return "accepted";
    } catch (const input_error& error) {
        return error.what();
    }
}

const std::string begin = "[begin]\nstart = 2020-01-01\n";

TEST(part, tables_are_read_in_their_turns)
{
    const Works works = works_of("[[bolt]]\nname = \"a\"\nlength_mm = 2500\ninstalled = 2020-01-03\n"
                                 "[[bolt]]\nname = \"b\"\nlength_mm = 10\n" +
                                 begin);
    ASSERT_EQ(works.bolts.size(), 2u);
    EXPECT_DOUBLE_EQ(works.bolts[0].length, 2.5);
    EXPECT_DOUBLE_EQ(works.bolts[0].installed, 2 * unit::day);
    EXPECT_DOUBLE_EQ(works.bolts[1].installed, 0);
    EXPECT_FALSE(works.spare);
}

TEST(part, a_record_is_there_only_if_its_table_is_given)
{
    const Works works = works_of("[spare]\nname = \"c\"\nlength_mm = 1\n" + begin);
    ASSERT_TRUE(works.spare);
    EXPECT_EQ(works.spare->name, "c");
}

TEST(part, messages_name_the_whole)
{
    EXPECT_EQ(refusal("[[bolt]]\nname = \"a\"\nlength_mm = 1\n"),
              "works.toml, line 1: the plan has no [begin]");
    EXPECT_EQ(refusal("[bult]\n" + begin),
              "works.toml, line 1: the plan has no key \"bult\"; did you mean bolt?");
}

TEST(part, former_names_are_refused_with_the_new_ones)
{
    EXPECT_EQ(refusal("[[old_bolt]]\n" + begin),
              "works.toml, line 1: the plan has no key \"old_bolt\": it is now "
              "called bolt. Rename it in the plan");
    EXPECT_EQ(
        refusal("[spare]\nname = \"c\"\nsize_mm = 1\n" + begin),
        "works.toml, line 3: [spare] has no key \"size_mm\": it is now called length_mm. Rename it in the "
        "plan");
}

TEST(part, checks_name_line_and_table)
{
    const std::string a = "[[bolt]]\nname = \"a\"\nlength_mm = 1\n";
    EXPECT_EQ(refusal(begin + a + a),
              "works.toml, line 7: [[bolt]] \"a\" name = \"a\": the name is taken in line 4");
    EXPECT_EQ(refusal(begin + a + "plate_m = [[0, 0], [1, 1], [1, 0], [0, 1]]\n").substr(0, 45),
              "works.toml, line 6: [[bolt]] \"a\" plate_m = a ");
}

} // namespace

} // namespace part_test
