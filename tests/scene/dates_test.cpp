// Dates and numbers of days become seconds since the start.

#include "model/units.hpp"
#include "text.hpp"

namespace dates_test
{

using namespace jointcreep;
using namespace jointcreep::scene;
using unit::day;

namespace
{

const std::string text = every_key_text();

std::string with_numbers(const std::string& start)
{
    auto all = replaced(text, "start = 1994-06-01\n", start);
    all = replaced(all, "end = 1994-07-01", "end = 130");
    all = replaced(all, "date = 1994-06-06", "date = 105.5");
    all = replaced(all, "date = 14", "date = 114");
    all = replaced(all, "first_reading = 7", "first_reading = 107");
    return replaced(all, "first_reading = 1994-06-07", "first_reading = 106");
}

TEST(dates, with_a_date_as_start)
{
    const Scene scene = parse_scene(text, "scene.toml");
    EXPECT_EQ(scene.end, 30 * day);
    EXPECT_EQ(scene.stages[0].time, 5 * day);
    EXPECT_EQ(scene.stages[1].time, 14 * day) << "a number of days since the start";
    EXPECT_EQ(scene.points[0].first_reading, 6 * day);
    EXPECT_EQ(scene.points.back().first_reading, 7 * day) << "of a monitoring line";
}

TEST(dates, with_a_number_as_start)
{
    const Scene scene = parse_scene(with_numbers("start = 100\n"), "scene.toml");
    EXPECT_EQ(scene.end, 30 * day);
    EXPECT_EQ(scene.stages[0].time, 5.5 * day);
    EXPECT_EQ(scene.stages[1].time, 14 * day);
    EXPECT_EQ(scene.points[0].first_reading, 6 * day);
    EXPECT_EQ(scene.points.back().first_reading, 7 * day) << "of a monitoring line";
}

TEST(dates, without_start)
{
    const Scene scene = parse_scene(with_numbers(""), "scene.toml");
    EXPECT_EQ(scene.end, 130 * day);
    EXPECT_EQ(scene.stages[0].time, 105.5 * day);
}

TEST(dates, over_a_leap_day_and_a_century)
{
    const auto from = [](const std::string& start, const std::string& end) {
        auto all = replaced(text, "start = 1994-06-01", "start = " + start);
        all = replaced(all, "end = 1994-07-01", "end = " + end);
        all.erase(all.find("[[stage]]"), all.find("[creep]") - all.find("[[stage]]"));
        return parse_scene(all, "scene.toml").end;
    };
    EXPECT_EQ(from("1996-02-28", "1996-03-01"), 2 * day);
    EXPECT_EQ(from("1995-02-28", "1995-03-01"), 1 * day);
    EXPECT_EQ(from("1899-12-31", "2000-03-01"), 36585 * day);
}

TEST(dates, a_date_needs_a_date_as_start)
{
    const auto broken = replaced(with_numbers("start = 100\n"), "date = 114", "date = 1994-06-14");
    expect_part(refusal(broken), "[schedule] start");
}

TEST(dates, no_such_day)
{
    const auto broken = replaced(text, "date = 1994-06-06", "date = 1994-02-29");
    expect_part(refusal(broken), line_of(broken, "date = 1994-02-29"));
    expect_part(refusal(replaced(text, "date = 1994-06-06", "date = 1994-06-06T12:00:00")),
                "date = a time: expected a date");
}

TEST(dates, too_far_away)
{
    expect_part(refusal(replaced(text, "end = 1994-07-01", "end = 9999-07-01")),
                "end = 9999-07-01: expected");
}

} // namespace

} // namespace dates_test
