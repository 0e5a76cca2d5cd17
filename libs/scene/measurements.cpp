#include "scene/measurements.hpp"

#include "model/error.hpp"
#include "model/units.hpp"
#include "scene/csv.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <tuple>

namespace jointcreep::scene
{

namespace
{

struct LengthUnit {
    std::string_view suffix;
    double in_m;
};
constexpr std::array<LengthUnit, 3> units{{{"_m", 1}, {"_cm", 1e-2}, {"_mm", 1e-3}}};

constexpr double largest = 1e4; // [m]

// A column of lengths, named with one of the units.
struct Column {
    std::string name; // empty: there is none
    double in_m = 1;
};

Column column_of(const Csv& csv, const std::string& name)
{
    Column found;
    for (const LengthUnit& unit : units)
        if (const std::string full = name + std::string(unit.suffix); csv.has(full)) {
            if (!found.name.empty())
                refuse_line(csv.head(), "has the columns " + found.name + " and " + full + "; expected one");
            found = {full, unit.in_m};
        }
    return found;
}

double length_of(const Csv& csv, const Csv::Row& row, const Column& column, const Range& range_in_m)
{
    const Range range{range_in_m.least / column.in_m, range_in_m.most / column.in_m, range_in_m.least_open,
                      range_in_m.most_open};
    return csv.number(row, column.name, range) * column.in_m;
}

const Range deviations = above(0).to(largest);

std::string column_names(const std::string& name)
{
    return name + "_m, " + name + "_cm or " + name + "_mm";
}

bool is_empty(const Csv& csv, const Csv::Row& row, const std::string& column)
{
    return row.field[csv.column(column)].empty();
}

double time_in(const Csv& csv, const Csv::Row& row, double end)
{
    return csv.number(row, "time_day", from(0).to(end / unit::day)) * unit::day;
}

// One reading for one point, component, time and event. Times are compared as numbers.
class Readings
{
public:
    void add(const Measurement& measurement, std::string_view event, const Scene& scene)
    {
        const auto [other, is_new] =
            line_.insert({{measurement.point, measurement.component, measurement.time, std::string(event)},
                          measurement.line});
        if (!is_new)
            refuse_line(measurement.line, "point \"" + scene.points[measurement.point].name +
                                              "\" has a reading of " +
                                              (measurement.component == 0 ? "x" : "y") + " on day " +
                                              shown(measurement.time / unit::day) + " in line " +
                                              std::to_string(other->second) + " already; expected one");
        list.push_back(measurement);
    }
    std::vector<Measurement> list;

private:
    std::map<std::tuple<std::size_t, int, double, std::string>, std::size_t> line_;
};

std::string_view event_in(const Csv& csv, const Csv::Row& row)
{
    return csv.has("event") ? row.field[csv.column("event")] : std::string_view();
}

std::vector<Measurement> listed(const Csv& csv, const Scene& scene)
{
    const Column displacement = column_of(csv, "displacement"), sigma = column_of(csv, "sigma");
    if (displacement.name.empty())
        refuse_line(csv.head(), "expected a column " + column_names("displacement"));
    for (const char* needed : {"time_day", "component"})
        csv.column(needed);
    csv.allow_only({"time_day", "event", "point", "component", displacement.name,
                    sigma.name.empty() ? "sigma_mm" : sigma.name});
    Readings readings;
    for (const Csv::Row& row : csv.rows) {
        const std::string_view name = row.field[csv.column("point")],
                               component = row.field[csv.column("component")];
        const auto point = std::find_if(scene.points.begin(), scene.points.end(),
                                        [&](const MonitoringPoint& p) { return p.name == name; });
        if (point == scene.points.end())
            refuse_line(row.line, "point is \"" + std::string(name) + "\"; the scene has no such point");
        if (component != "x" && component != "y")
            refuse_line(row.line, "component is \"" + std::string(component) + "\"; expected x or y");
        Measurement measurement{.point = static_cast<std::size_t>(point - scene.points.begin()),
                                .component = component == "x" ? 0 : 1,
                                .time = time_in(csv, row, scene.end),
                                .is_before_stage = csv.has("event") && is_empty(csv, row, "event"),
                                .displacement = length_of(csv, row, displacement, within(largest)),
                                .deviation = {},
                                .line = row.line};
        if (!sigma.name.empty())
            measurement.deviation = length_of(csv, row, sigma, deviations);
        readings.add(measurement, event_in(csv, row), scene);
    }
    return readings.list;
}

std::vector<Measurement> tabled(const Csv& csv, const Scene& scene)
{
    csv.column("time_day");
    struct Place {
        std::size_t point;
        int component;
        Column displacement, sigma;
        std::string present; // column, or empty
    };
    std::vector<Place> places;
    std::set<std::string, std::less<>> known{"time_day", "event"};
    bool any_sigma = false, all_sigma = true;
    for (std::size_t p = 0; p < scene.points.size(); ++p) {
        const std::string& name = scene.points[p].name;
        known.insert(name + "_present");
        for (const int component : {0, 1}) {
            const std::string column = name + (component == 0 ? "_x" : "_y");
            Place place{p, component, column_of(csv, column), column_of(csv, column + "_sigma"),
                        csv.has(name + "_present") ? name + "_present" : ""};
            if (place.displacement.name.empty())
                continue;
            (place.sigma.name.empty() ? all_sigma = false : any_sigma = true);
            known.insert({place.displacement.name, place.sigma.name});
            places.push_back(std::move(place));
        }
    }
    for (const std::string_view column : csv.columns())
        if (!known.contains(column))
            refuse_line(csv.head(),
                        "has a column \"" + std::string(column) +
                            "\", which is none of a monitoring point of the scene; expected POINT_x_mm, "
                            "POINT_y_mm, POINT_x_sigma_mm, POINT_y_sigma_mm or POINT_present");
    if (places.empty())
        refuse_line(csv.head(),
                    "has no column of a monitoring point; expected POINT_x_mm, say, or the columns point, "
                    "component and displacement_mm");
    if (any_sigma && !all_sigma)
        refuse_line(csv.head(), "has sigma of some displacements only; expected it of all or of none");
    Readings readings;
    for (const Csv::Row& row : csv.rows)
        for (const Place& place : places) {
            if (is_empty(csv, row, place.displacement.name) ||
                (!place.present.empty() && csv.number(row, place.present, from(0).to(1)) == 0))
                continue;
            Measurement measurement{.point = place.point,
                                    .component = place.component,
                                    .time = time_in(csv, row, scene.end),
                                    .is_before_stage = csv.has("event") && is_empty(csv, row, "event"),
                                    .displacement = length_of(csv, row, place.displacement, within(largest)),
                                    .deviation = {},
                                    .line = row.line};
            if (!place.sigma.name.empty())
                measurement.deviation = length_of(csv, row, place.sigma, deviations);
            readings.add(measurement, event_in(csv, row), scene);
        }
    if (readings.list.empty())
        throw input_error("has no readings");
    return readings.list;
}

} // namespace

std::vector<Measurement> measurements_in_csv(std::string_view text, const Scene& scene)
{
    const Csv csv(text);
    return csv.has("point") ? listed(csv, scene) : tabled(csv, scene);
}

std::vector<Measurement> creep_curve_in_csv(std::string_view text)
{
    constexpr double longest = 1e7; // [day]
    const Csv csv(text);
    const Column displacement = column_of(csv, "displacement"), sigma = column_of(csv, "sigma");
    if (displacement.name.empty())
        refuse_line(csv.head(), "expected a column " + column_names("displacement"));
    csv.allow_only({"time_day", displacement.name, sigma.name.empty() ? "sigma_mm" : sigma.name});
    std::vector<Measurement> measurements;
    for (const Csv::Row& row : csv.rows) {
        const double time = csv.number(row, "time_day", within(longest)) * unit::day;
        if (!measurements.empty() && time < measurements.back().time)
            refuse_line(row.line, "time_day is \"" + std::string(row.field[csv.column("time_day")]) +
                                      "\", before that of line " + std::to_string(measurements.back().line) +
                                      "; expected times that rise");
        Measurement measurement{.point = 0,
                                .component = 0,
                                .time = time,
                                .displacement = length_of(csv, row, displacement, within(largest)),
                                .deviation = {},
                                .line = row.line};
        if (!sigma.name.empty())
            measurement.deviation = length_of(csv, row, sigma, deviations);
        measurements.push_back(measurement);
    }
    return measurements;
}

} // namespace jointcreep::scene
