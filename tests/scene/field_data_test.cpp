#include "scene/field_data.hpp"

#include "model/error.hpp"
#include "model/units.hpp"
#include "scene/measurements.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace field_data_test
{

using namespace jointcreep;
using namespace jointcreep::scene;
using namespace jointcreep::unit;
using Eigen::Vector2d;

namespace
{

std::string refusal(const std::function<void()>& read)
{
    try {
        read();
    } catch (const input_error& error) {
        return error.what();
    }
    return "accepted";
}

void expect_refused(const std::string& text, const std::string& part, const TraceFilter& filter = {})
{
    const std::string message = refusal([&] { mapped_traces(text, filter); });
    EXPECT_NE(message.find(part), std::string::npos) << message << "\nexpected in it: " << part;
}

std::string feature(const std::string& geometry, const std::string& more = "\"properties\": {}")
{
    return R"({"type": "Feature", )" + more + R"(, "geometry": )" + geometry + "}";
}

std::string collection(const std::vector<std::string>& features)
{
    std::string all;
    for (const std::string& one : features)
        all += (all.empty() ? "" : ",\n") + one;
    return R"({"type": "FeatureCollection", "features": [)" + all + "]}";
}

const std::string line = R"({"type": "LineString", "coordinates": [[0, 1], [2, 3.5], [4, 4]]})";

} // namespace

TEST(MappedTraces, AreReadFromGeoJson)
{
    const std::string lines =
        R"({"type": "MultiLineString", "coordinates": [[[0, 0], [1, 1]], [[5, 5], [6, 7]]]})";
    const auto traces = mapped_traces(collection({feature(line, R"("id": 7, "properties": {"set": "A"})"),
                                                  feature(lines, R"("properties": {"set": "A", "id": 3})")}),
                                      {});
    ASSERT_EQ(traces.size(), 2u);
    EXPECT_EQ(traces[0].id, 7);
    EXPECT_EQ(traces[0].polylines, (std::vector<Polygon>{{{0, 1}, {2, 3.5}, {4, 4}}}));
    EXPECT_EQ(traces[1].id, 3);
    EXPECT_EQ(traces[1].polylines, (std::vector<Polygon>{{{0, 0}, {1, 1}}, {{5, 5}, {6, 7}}}));
    EXPECT_EQ(mapped_traces(line, {}).at(0).id, 0); // a geometry alone
    EXPECT_EQ(mapped_traces(feature(line), {}).size(), 1u);
}

TEST(MappedTraces, MayBeginWithAByteOrderMark)
{
    const std::string mark = "\xef\xbb\xbf", csv = "x1_m,y1_m,x2_m,y2_m\n0,0,1,1\n";
    EXPECT_EQ(mapped_traces(mark + line, {}).size(), 1u);
    EXPECT_EQ(mapped_traces(mark + csv, {}).size(), 1u);
    EXPECT_EQ(poles_in_csv(mark + "dip_deg,dip_direction_deg\n1,2\n").size(), 1u);
    EXPECT_EQ(creep_curve_in_csv(mark + "time_day,displacement_mm\n1,2\n").size(), 1u);
}

TEST(MappedTraces, AreNotReadFromUtf16)
{
    const std::string wanted = "the text is UTF-16; expected UTF-8";
    for (const std::string& text : {std::string("\xff\xfe{\0", 4), std::string("\xfe\xff\0{", 4),
                                    std::string("{\0\"\0", 4), std::string("\0{\0\"", 4)}) {
        expect_refused(text, wanted);
        EXPECT_EQ(refusal([&] { poles_in_csv(text); }).substr(0, wanted.size()), wanted);
        EXPECT_EQ(refusal([&] { creep_curve_in_csv(text); }).substr(0, wanted.size()), wanted);
    }
}

TEST(MappedTraces, TakesThoseOfAProperty)
{
    const std::string point = feature(R"({"type": "Point", "coordinates": [1, 1]})");
    const std::string text = collection({point, feature(line, R"("properties": {"set": "A"})"),
                                         feature(line, R"("properties": {"set": 2})")});
    EXPECT_EQ(mapped_traces(text, {"set", "A"}).at(0).id, 1); // its place in the file
    EXPECT_EQ(mapped_traces(text, {"set", "2"}).at(0).id, 2);
    expect_refused(text, "feature 0 is of the type \"Point\"");
    expect_refused(text, "has no trace whose set is \"B\"", {"set", "B"});
}

TEST(MappedTraces, AreReadFromCsv)
{
    const auto pieces =
        mapped_traces("x1_m,y1_m,x2_m,y2_m,set\n# a remark\n1,2,3,4,A\n\n5,6,7,-8e1,\"B\"\n", {});
    ASSERT_EQ(pieces.size(), 2u);
    EXPECT_EQ(pieces[1].id, 1);
    EXPECT_EQ(pieces[1].polylines, (std::vector<Polygon>{{{5, 6}, {7, -80}}}));
    const std::string places = "id, x_m, y_m, set\r\n4,0,0,A\r\n4,1,1,A\r\n4,2,1,A\r\n9,5,5,B\r\n9,6,6,B\r\n";
    const auto polylines = mapped_traces(places, {});
    ASSERT_EQ(polylines.size(), 2u);
    EXPECT_EQ(polylines[0].id, 4);
    EXPECT_EQ(polylines[0].polylines[0], (Polygon{{0, 0}, {1, 1}, {2, 1}}));
    EXPECT_EQ(mapped_traces(places, {"set", "B"}).at(0).id, 9);
    // Ids that are no numbers: by place.
    EXPECT_EQ(mapped_traces("id,x_m,y_m\nF1,0,0\nF1,1,1\nF2,1,0\nF2,2,1\n", {}).at(1).id, 1);
}

TEST(MappedTraces, RefusesWhatIsWrong)
{
    expect_refused("", "expected a line of column names");
    expect_refused("x1_m,y1_m,x2_m,y2_m\n", "and rows");
    expect_refused("x1_m,y1_m,x2_m\n1,2,3\n", "expected a column y2_m");
    expect_refused("x_m,y_m\n1,2\n", "expected a column id");
    expect_refused("x1_m,y1_m,x2_m,y2_m\n1,2,3\n", "line 2: has 3 fields; expected 4");
    for (const std::string wrong : {"nan", "inf", "1e7", "3 m", "", "1.5.2"})
        expect_refused("x1_m,y1_m,x2_m,y2_m\n1,2,3," + wrong + "\n", "line 2: y2_m is \"" + wrong + "\"");
    expect_refused("id,x_m,y_m\n1,0,0\n1,1,1\n2,0,0\n2,3,3\n1,5,5\n", "line 6: id \"1\" comes again");
    expect_refused("id,x_m,y_m\n1,0,0\n", "two places");
    expect_refused("id,x_m,y_m,s\n1,0,0,A\n1,1,1,B\n", "more than one s", {"s", "A"});
    expect_refused("x1_m,y1_m,x2_m,y2_m,id\n1,2,3,4,8\n1,2,3,5,8\n", "has the id 8, too");
    expect_refused("x1_m,y1_m,x2_m,y2_m,x1_m\n1,2,3,4,5\n", "has the column x1_m more than once");
    expect_refused(R"({"features": )" + std::string(200000, '[') + std::string(200000, ']') + "}",
                   "nested too deeply");
    expect_refused("{\"type\": ", "is not JSON");
    expect_refused("{}", "feature 0 is of the type null");
    expect_refused(collection({}), "has no traces");
    for (const std::string wrong : {"[1, 2, 3, 4]", "[1]", "[1, \"2\"]", "5", "[1, 1e300]", "null"})
        expect_refused(R"({"type": "LineString", "coordinates": [[0, 0], )" + wrong + "]}",
                       "feature 0 has the coordinates");
    expect_refused(R"({"type": "LineString", "coordinates": []})", "two places");
    expect_refused(R"({"type": "MultiLineString"})", "no coordinates");
    expect_refused(R"({"type": "MultiLineString", "coordinates": []})", "no coordinates");
}

// Ids that are no numbers of a joint are not used at all; heights are not, either.
TEST(MappedTraces, HaveTheirPlacesWhereIdsAreNoNumbersOfJoints)
{
    for (const std::string id : {"-8", "2097152", "18446744073709551615"}) {
        const auto in_csv = mapped_traces("x1_m,y1_m,x2_m,y2_m,id\n1,2,3,4,5\n1,2,3,5," + id + "\n", {});
        EXPECT_EQ(in_csv.at(0).id, 0);
        EXPECT_EQ(in_csv.at(1).id, 1);
        const std::string high = R"({"type": "LineString", "coordinates": [[0, 1, 300], [2, 3.5, 301]]})";
        const auto in_json =
            mapped_traces(collection({feature(line, R"("id": 7)"), feature(high, R"("id": )" + id)}), {});
        EXPECT_EQ(in_json.at(0).id, 0);
        EXPECT_EQ(in_json.at(1).id, 1);
        EXPECT_EQ(in_json.at(1).polylines.at(0).at(1), Eigen::Vector2d(2, 3.5));
    }
}

TEST(MappedTraces, AreThoseOfALayer)
{
    const std::string two =
        R"({"layers": {"a": )" + line + R"(, "b": )" + collection({feature(line), feature(line)}) + "}}";
    EXPECT_EQ(mapped_traces(two, {.layer = "a"}).size(), 1u);
    EXPECT_EQ(mapped_traces(two, {.layer = "b"}).size(), 2u);
    EXPECT_EQ(mapped_traces(R"({"layers": {"a": )" + line + "}}", {}).size(), 1u);
    expect_refused(two, R"(several layers; expected layer = one of "a", "b")");
    expect_refused(two, R"(no lines in a layer "c"; it has some in "a", "b")", {.layer = "c"});
    expect_refused(line, "is GeoJSON, which has no layers", {.layer = "a"});
    expect_refused("x1_m,y1_m,x2_m,y2_m\n1,2,3,4\n", "is CSV, which has no layers", {.layer = "a"});
    expect_refused(R"({"layers": {}})", "several layers");
    expect_refused(R"({"layers": {"a": {"type": "Point"}}})",
                   R"(layer "a", feature 0 is of the type "Point")");
}

TEST(MappedTraces, CarryTheValueOfTheirProperty)
{
    const TraceFilter filter{.property = "set"};
    const auto json = traces_of_file(collection({feature(line, R"("properties": {"set": "A"})"),
                                                 feature(line, R"("properties": {"set": 2})")}),
                                     filter);
    EXPECT_EQ(json.value, (std::vector<std::string>{"A", "2"}));
    const auto csv = traces_of_file("id,x_m,y_m,set\n1,0,0,A\n1,1,1,A\n2,5,5,B\n2,6,6,B\n", filter);
    EXPECT_EQ(csv.value, (std::vector<std::string>{"A", "B"}));
    EXPECT_EQ(csv.trace.size(), 2u);
    expect_refused("id,x_m,y_m,s\n1,0,0,A\n1,1,1,B\n", "more than one s", {.property = "s"});
    expect_refused("x1_m,y1_m,x2_m,y2_m\n1,2,3,4\n", "expected a column s", {.property = "s"});
}

TEST(MeasuredPoles, HaveNoColumnsBesideTheirOwn)
{
    const std::string message = refusal([] { poles_in_csv("dip_deg,dip_direction_deg,wieght\n10,20,3\n"); });
    EXPECT_NE(message.find("line 1: has a column wieght; expected none but dip_deg"), std::string::npos)
        << message;
}

TEST(ScanlineCorrection, WeighsByTerzaghi)
{
    // Along a level scanline to the east: a vertical plane across it, one at 60 degrees to its normal, one
    // along.
    std::vector<MeasuredPole> poles{{90 * deg, 90 * deg, 1}, {90 * deg, 30 * deg, 2}, {90 * deg, 0, 1}};
    correct_for_scanline(poles, {{}, 90 * deg, 0}, 10 * deg);
    EXPECT_NEAR(poles[0].weight, 1, 1e-12);
    EXPECT_NEAR(poles[1].weight, 4, 1e-12);
    EXPECT_NEAR(poles[2].weight, 1 / std::sin(10 * deg), 1e-12);
    // Down a hole: a level plane, and one that dips 60 degrees.
    poles = {{0, 0, 1}, {60 * deg, 123 * deg, 1}};
    correct_for_scanline(poles, {{}, 0, 90 * deg}, 10 * deg);
    EXPECT_NEAR(poles[0].weight, 1, 1e-12);
    EXPECT_NEAR(poles[1].weight, 2, 1e-12);
}

} // namespace field_data_test
