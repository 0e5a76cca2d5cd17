#include "scene/scene_checks.hpp"

#include "joint/law.hpp"
#include "model/error.hpp"
#include "model/polygon.hpp"
#include "scene/polygon.hpp"

#include <cmath>
#include <map>
#include <set>

namespace jointcreep::scene
{
namespace
{

constexpr double same_place =
    1e-9; // of the section's size: points and boundaries this near the outline are on it
constexpr double least_trace =
    0.05; // of a joint plane's unit normal in the section's plane: else nearly parallel
constexpr std::size_t most_names_shown = 10;

// The table that a record was read from; knows the lines of its keys.
struct Given {
    const Reading& reading;
    const TomlValue& table;
    std::string title; // "[[rock]] "granite""

    const TomlValue* find(std::string_view key) const { return table.find(key); }

    // "[[joint]] "F1" material = "gouge": what is wrong", at the key's line, or the table's if it is missing.
    [[noreturn]] void refuse(const std::string& key, const std::string& what) const
    {
        const TomlValue* const value = find(key);
        const Place place{reading, title};
        if (value)
            place.refuse(value->line, title + " " + key + " = " + shown(*value) + ": " + what);
        place.refuse(table.line, title + " has no " + key + ": " + what);
    }
};

class Checker
{
public:
    Checker(const Scene& scene, const TomlValue& root, const Reading& reading)
        : scene_(scene), root_(root), reading_(reading)
    {
    }

    void check() const
    {
        check_names();
        check_references();
        check_polygons();
        check_joints();
        check_joint_materials();
        check_rocks();
        check_joint_sets();
        check_in_situ_stress();
        check_boundaries();
        check_times();
        check_places();
        check_numbers();
        check_creep();
        check_large_displacements();
    }

private:
    const Scene& scene_;
    const TomlValue& root_;
    const Reading& reading_;

    Given once(const std::string& name) const
    {
        const TomlValue* const table = root_.find(name);
        return {reading_, table ? *table : root_, "[" + name + "]"};
    }

    Given in_list(const std::string& name, std::size_t i) const
    {
        const TomlValue& table = std::get<TomlValue::List>(root_.find(name)->content)[i];
        const TomlValue* const own_name = table.find("name");
        return {reading_, table, "[[" + name + "]]" + (own_name ? " " + shown(*own_name) : "")};
    }

    // --- Names and references ------------------------------------------------------------------------------

    template <class Record>
    void check_unique(const std::string& table, const std::vector<Record>& records,
                      std::map<std::string, std::int64_t>& line_of) const
    {
        for (std::size_t i = 0; i < records.size(); ++i) {
            const Given given = in_list(table, i);
            const auto [other, is_new] = line_of.try_emplace(records[i].name, given.find("name")->line);
            if (!is_new)
                given.refuse("name", "the name is taken in line " + std::to_string(other->second));
        }
    }

    template <class Record>
    void check_unique(const std::string& table, const std::vector<Record>& records) const
    {
        std::map<std::string, std::int64_t> line_of;
        check_unique(table, records, line_of);
    }

    void check_names() const
    {
        check_unique("rock", scene_.rocks);
        check_unique("joint_material", scene_.joint_materials);
        check_unique("stage", scene_.stages);
        check_unique("point", scene_.points);
        check_unique("gauge", scene_.gauges);
        std::map<std::string, std::int64_t> line_of; // a joint is a set of its own in all files
        check_unique("joint_set", scene_.joint_sets, line_of);
        check_unique("joint", scene_.joints, line_of);
        check_unique("mapped", scene_.mapped, line_of);
    }

    template <class Record>
    static std::set<std::string> names_of(const std::vector<Record>& records)
    {
        std::set<std::string> names;
        for (const Record& record : records)
            names.insert(record.name);
        return names;
    }

    static void check_reference(const Given& given, const std::string& key, const std::string& name,
                                const std::set<std::string>& known, const std::string& what)
    {
        if (known.contains(name))
            return;
        if (known.empty())
            given.refuse(key, "there is no " + what);
        std::string all;
        std::size_t shown_names = 0;
        for (const auto& one : known)
            if (shown_names++ < most_names_shown)
                all += (all.empty() ? "\"" : ", \"") + one + '"';
        if (known.size() > most_names_shown)
            all += ", ...";
        const auto meant = nearest(name, {known.begin(), known.end()});
        const TomlValue* const value = given.find(key);
        const bool is_in_list = value && std::holds_alternative<TomlValue::List>(value->content);
        given.refuse(key, (is_in_list ? "has \"" + name + "\"; " : "") + "wanted the name of a " + what +
                              ": " + all + (meant.empty() ? "" : "; did you mean \"" + meant + "\"?"));
    }

    void check_references() const
    {
        const auto rocks = names_of(scene_.rocks);
        const auto materials = names_of(scene_.joint_materials);
        check_reference(once("section"), "rock", scene_.rock, rocks, "[[rock]]");
        for (std::size_t i = 0; i < scene_.regions.size(); ++i)
            check_reference(in_list("region", i), "rock", scene_.regions[i].rock, rocks, "[[rock]]");
        for (std::size_t i = 0; i < scene_.joints.size(); ++i)
            check_reference(in_list("joint", i), "material", scene_.joints[i].material, materials,
                            "[[joint_material]]");
        for (std::size_t i = 0; i < scene_.joint_sets.size(); ++i)
            check_reference(in_list("joint_set", i), "material", scene_.joint_sets[i].material, materials,
                            "[[joint_material]]");
        for (std::size_t i = 0; i < scene_.joint_sets.size(); ++i) {
            std::set<std::string> known;
            for (const MaterialInRock& in : scene_.joint_sets[i].material_in) {
                check_reference(in_list("joint_set", i), "material_in", in.rock, rocks, "[[rock]]");
                check_reference(in_list("joint_set", i), "material_in", in.material, materials,
                                "[[joint_material]]");
                if (!known.insert(in.rock).second)
                    in_list("joint_set", i)
                        .refuse("material_in",
                                "wanted each rock once, and \"" + in.rock + "\" is there twice");
            }
        }
        for (std::size_t i = 0; i < scene_.mapped.size(); ++i)
            check_reference(in_list("mapped", i), "material", scene_.mapped[i].material, materials,
                            "[[joint_material]]");
        for (std::size_t i = 0; i < scene_.joint_sets.size(); ++i)
            for (const std::string& rock : scene_.joint_sets[i].rocks)
                check_reference(in_list("joint_set", i), "rocks", rock, rocks, "[[rock]]");
        for (std::size_t i = 0; i < scene_.boundaries.size(); ++i)
            if (!scene_.boundaries[i].joint.empty())
                check_reference(in_list("boundary", i), "joint", scene_.boundaries[i].joint, materials,
                                "[[joint_material]]");
        if (scene_.large_displacements)
            check_reference(once("large_displacements"), "new_contacts",
                            scene_.large_displacements->new_contacts, materials, "[[joint_material]]");
        if (scene_.large_displacements)
            for (const std::string& rock : scene_.large_displacements->rigid_rocks)
                check_reference(once("large_displacements"), "rigid_rocks", rock, rocks, "[[rock]]");
    }

    // --- Geometry ------------------------------------------------------------------------------------------

    static void check_polygon(const Given& given, const std::string& key, const Polygon& polygon)
    {
        if (const auto fault = polygon_fault(polygon); !fault.empty())
            given.refuse(key, fault + "; wanted a simple polygon of at least 3 corners, not closed");
    }

    void check_polygons() const
    {
        check_polygon(once("section"), "outline_m", scene_.outline);
        check_holes();
        for (std::size_t i = 0; i < scene_.regions.size(); ++i)
            check_polygon(in_list("region", i), "outline_m", scene_.regions[i].outline);
        for (std::size_t i = 0; i < scene_.joint_sets.size(); ++i)
            if (scene_.joint_sets[i].region)
                check_polygon(in_list("joint_set", i), "region_m", *scene_.joint_sets[i].region);
        if (scene_.fine_zones)
            check_fine_zones(*scene_.fine_zones);
        for (std::size_t i = 0; i < scene_.stages.size(); ++i)
            for (const Polygon& polygon : scene_.stages[i].remove)
                check_polygon(in_list("stage", i), "remove_m", polygon);
    }

    void check_fine_zones(const Polygon& fine) const
    {
        check_polygon(once("zones"), "fine_m", fine);
        const auto apart = [&](const Polygon& other) { return !sides_come_near(other, fine, tolerance()); };
        const auto inside = [&](const Polygon& one, const Polygon& other) {
            return covers(other, one[0], 0);
        };
        bool outside =
            apart(scene_.outline) && !inside(fine, scene_.outline) && !inside(scene_.outline, fine);
        for (const Polygon& hole : scene_.holes)
            outside = outside || (apart(hole) && inside(fine, hole));
        if (outside)
            once("zones").refuse("fine_m",
                                 "it is outside the section; wanted a polygon that has a part of it inside");
    }

    void check_holes() const
    {
        const Given section = once("section");
        const auto& holes = scene_.holes;
        for (std::size_t i = 0; i < holes.size(); ++i) {
            check_polygon(section, "holes_m", holes[i]);
            const std::string which = "hole " + std::to_string(i + 1);
            if (sides_come_near(scene_.outline, holes[i], tolerance()) ||
                !covers(scene_.outline, holes[i][0], 0))
                section.refuse("holes_m", which + " is not inside outline_m; wanted one that is, and does "
                                                  "not touch it");
            for (std::size_t j = 0; j < i; ++j)
                if (sides_come_near(holes[i], holes[j], tolerance()) || covers(holes[i], holes[j][0], 0) ||
                    covers(holes[j], holes[i][0], 0))
                    section.refuse("holes_m", which + " meets hole " + std::to_string(j + 1) +
                                                  "; wanted holes apart from each other");
        }
    }

    double tolerance() const { return same_place * polygon_size(scene_.outline); }

    void check_joint_materials() const
    {
        for (std::size_t i = 0; i < scene_.joint_materials.size(); ++i) {
            const Given given = in_list("joint_material", i);
            if (given.find("kelvin_chain") && given.find("normal_kelvin_stiffness_MPa_per_m"))
                given.refuse("kelvin_chain",
                             "wanted either it, or the four keys of one Kelvin unit, not both");
            const JointMaterial& material = scene_.joint_materials[i];
            const joint::LawInfo& law = joint::laws()[static_cast<std::size_t>(material.law)];
            for (const joint::LawInfo& other : joint::laws())
                for (const std::string_view name : other.own)
                    if (material.own.contains(name) && std::ranges::count(law.own, name) == 0)
                        given.refuse(key_of(name), "wanted keys of one joint law; those of \"" +
                                                       std::string(law.name) + "\" are given, too");
            if (!law.creeps)
                for (const char* const key : {"kelvin_chain", "normal_kelvin_stiffness_MPa_per_m",
                                              "normal_maxwell_viscosity_MPa_day_per_m"})
                    if (given.find(key))
                        given.refuse(key,
                                     "a joint of the law \"" + std::string(law.name) + "\" does not creep");
            const auto complaint =
                law.check([&](const joint::Parameter& parameter) { return parameter.of(material); });
            if (complaint)
                given.refuse(std::string(complaint->parameter.key), complaint->wanted);
        }
    }

    static std::string key_of(std::string_view parameter)
    {
        return std::string(
            std::ranges::find(joint::all_parameters(), parameter, &joint::Parameter::name)->key);
    }

    void check_rocks() const
    {
        for (std::size_t i = 0; i < scene_.rocks.size(); ++i) {
            const Rock& rock = scene_.rocks[i];
            if (rock.law == RockLaw::mohr_coulomb && !rock.strength)
                in_list("rock", i).refuse("law", "it needs cohesion_MPa, friction_angle_deg and "
                                                 "tensile_strength_MPa beside it");
            if (rock.law == RockLaw::mohr_coulomb && (rock.kelvin || rock.maxwell_viscosity))
                in_list("rock", i).refuse("law", "wanted \"elastic\" of rock that creeps");
            if (rock.dilation_angle > 0 && !rock.strength)
                in_list("rock", i).refuse("dilation_angle_deg",
                                          "it needs cohesion_MPa, friction_angle_deg and "
                                          "tensile_strength_MPa beside it");
            if (rock.dilation_angle > 0 && rock.dilation_angle > rock.strength->friction_angle)
                in_list("rock", i).refuse("dilation_angle_deg",
                                          "wanted at most friction_angle_deg, beside it");
        }
    }

    void check_joints() const
    {
        for (std::size_t i = 0; i < scene_.joints.size(); ++i)
            if (scene_.joints[i].from == scene_.joints[i].to)
                in_list("joint", i).refuse("to_m", "wanted another point than from_m");
    }

    void check_in_situ_stress() const
    {
        const Given given = once("in_situ_stress");
        const auto& ground = scene_.in_situ_stress.ground;
        if (given.find("ground_m") && given.find("elevation_m"))
            given.refuse("ground_m", "wanted either it or elevation_m, not both");
        if (!given.find("ground_m") && !given.find("elevation_m"))
            given.refuse("elevation_m", "wanted it, or ground_m");
        if (!given.find("profile") && !given.find("compression_xx_MPa"))
            given.refuse("compression_xx_MPa",
                         "wanted the keys of a linear law (compression_xx_MPa, ...), or a profile");
        if (ground.empty())
            return;
        const auto [left, right] =
            std::minmax_element(scene_.outline.begin(), scene_.outline.end(),
                                [](const auto& one, const auto& other) { return one.x() < other.x(); });
        if (ground.front().x() > left->x() + tolerance() || ground.back().x() < right->x() - tolerance())
            given.refuse("ground_m", "wanted a line across the whole section, from x = " + shown(left->x()) +
                                         " to " + shown(right->x()) + " m");
        check_below_ground(given);
    }

    // Both lines are straight between their corners: where the section is highest above the ground, one of
    // them has one.
    void check_below_ground(const Given& given) const
    {
        const auto& in_situ = scene_.in_situ_stress;
        double highest = tolerance(), at = 0;
        const auto look = [&](const Eigen::Vector2d& place) {
            if (const double above = -in_situ.depth_of(place); above > highest) {
                highest = above;
                at = place.x();
            }
        };
        const Polygon& outline = scene_.outline;
        for (std::size_t i = 0; i < outline.size(); ++i) {
            const Eigen::Vector2d &from = outline[i], &to = outline[(i + 1) % outline.size()];
            look(from);
            for (const Eigen::Vector2d& corner : in_situ.ground)
                if (std::min(from.x(), to.x()) < corner.x() && corner.x() < std::max(from.x(), to.x()))
                    look(from + (to - from) * ((corner.x() - from.x()) / (to.x() - from.x())));
        }
        if (highest > tolerance())
            given.refuse("ground_m", "the section's outline is " + shown(highest) +
                                         " m above it at x = " + shown(at) +
                                         " m; wanted the ground as it is before any excavation, "
                                         "nowhere below the section's top");
    }

    void check_boundaries() const
    {
        const auto& all = scene_.boundaries;
        for (std::size_t i = 0; i < all.size(); ++i) {
            const Given given = in_list("boundary", i);
            if (!given.find("fix") && !given.find("joint") && !given.find("traction_MPa"))
                given.refuse("fix", "wanted fix = \"x\", \"y\" or \"xy\", or joint = a joint material, or "
                                    "traction_MPa");
            if (given.find("joint") && (all[i].traction || all[i].displacement))
                given.refuse("joint", "wanted no traction_MPa or displacement_mm beside joint");
            if (all[i].displacement && (!given.find("fix") || !given.find("load_history")))
                given.refuse("displacement_mm", "wanted fix and load_history beside it");
            if (all[i].displacement && ((!all[i].fix_x && all[i].displacement->x() != 0) ||
                                        (!all[i].fix_y && all[i].displacement->y() != 0)))
                given.refuse("displacement_mm", "wanted 0 in the direction that is not fixed");
            if (all[i].traction &&
                ((all[i].fix_x && all[i].traction->x() != 0) || (all[i].fix_y && all[i].traction->y() != 0)))
                given.refuse("traction_MPa", "wanted 0 in a direction that is fixed");
            if (given.find("load_history") && !all[i].traction && !all[i].displacement)
                given.refuse("load_history", "wanted traction_MPa or displacement_mm beside it");
            if (given.find("fix") && given.find("joint"))
                given.refuse("fix", "wanted either fix or joint, not both");
            const double length = (all[i].to - all[i].from).norm();
            if (!(length > tolerance()))
                given.refuse("to_m", "wanted another point than from_m");
            double on_sides = length_on_sides(scene_.outline, all[i].from, all[i].to, tolerance());
            for (const Polygon& hole : scene_.holes)
                on_sides += length_on_sides(hole, all[i].from, all[i].to, tolerance());
            if (on_sides < length - 2 * tolerance())
                given.refuse("to_m", "wanted from_m and to_m on one straight piece of the section's outline");
            for (std::size_t j = 0; j < i; ++j)
                if (common_length(all[i].from, all[i].to, all[j].from, all[j].to, tolerance()) >
                    2 * tolerance())
                    given.refuse("to_m", "it runs over the boundary of line " +
                                             std::to_string(in_list("boundary", j).table.line));
        }
    }

    void check_places() const
    {
        const auto check = [this](const std::string& table, const auto& records) {
            for (std::size_t i = 0; i < records.size(); ++i) {
                for (const Polygon& hole : scene_.holes)
                    if (covers(hole, records[i].at, 0) &&
                        distance_to_sides(hole, records[i].at) > tolerance())
                        in_list(table, i).refuse(
                            "at_m", "[" + shown(records[i].at.x()) + ", " + shown(records[i].at.y()) +
                                        "] is in a hole of the section; wanted a point in the rock");
                if (!covers(scene_.outline, records[i].at, tolerance()))
                    in_list(table, i).refuse(
                        "at_m", "[" + shown(records[i].at.x()) + ", " + shown(records[i].at.y()) +
                                    "] is outside the section's outline; wanted a point inside");
            }
        };
        check("point", scene_.points);
        check("gauge", scene_.gauges);
    }

    // --- Joint sets ----------------------------------------------------------------------------------------

    void check_orientation(const JointSet& set, const Given& given) const
    {
        const std::string wanted = "wanted one of trace_angle, orientation, or dip and dip_direction";
        const bool by_poles = set.orientation || !set.poles.empty();
        if (set.kind == SetKind::discs && set.trace_angle)
            given.refuse("trace_angle", "discs lie in space: wanted orientation, or dip and dip_direction");
        if ((set.trace_angle || by_poles) && (set.dip || set.dip_direction))
            given.refuse(set.dip ? "dip" : "dip_direction", wanted + ", not both");
        if (set.trace_angle && by_poles)
            given.refuse("orientation", wanted + ", not both");
        if (set.trace_angle)
            return;
        if (!by_poles) {
            if (!set.dip && !set.dip_direction)
                given.refuse("trace_angle", wanted);
            if (!set.dip || !set.dip_direction)
                given.refuse(set.dip ? "dip_direction" : "dip", wanted);
        }
        if (!scene_.azimuth)
            once("section").refuse("azimuth_deg",
                                   "the dip of " + given.title + " needs the bearing of the section");
        if (!set.poles.empty())
            return;
        // The mean plane's unit normal is {sin(dip) cos(a), cos(dip), sin(dip) sin(a)} along x, y and across.
        const double dip = set.orientation ? set.orientation->dip : set.dip->mean;
        const double direction = set.orientation ? set.orientation->dip_direction : set.dip_direction->mean;
        const double across = std::sin(dip) * std::sin(direction - *scene_.azimuth);
        if (std::sqrt(std::max(0.0, 1 - across * across)) <= least_trace)
            given.refuse(set.orientation ? "orientation" : "dip_direction",
                         "the set's mean plane is parallel to the section, or nearly so, and leaves no "
                         "trace; wanted another dip or direction, or no such set");
    }

    // Keys that a kind of set needs, and those it does not take.
    static void check_kind(const JointSet& set, const Given& given)
    {
        struct Kind {
            std::string title;
            std::vector<std::string> needs, refuses;
        };
        const Kind lines{"lines", {"persistence"}, {"diameter", "terminates_at"}},
            segments{"segments", {"length", "density"}, {"spacing", "persistence", "diameter"}},
            discs{"discs", {"diameter", "density"}, {"spacing", "persistence", "length"}};
        const Kind& kind = set.kind == SetKind::lines      ? lines
                           : set.kind == SetKind::segments ? segments
                                                           : discs;
        for (const std::string& key : kind.needs)
            if (!given.find(key))
                given.refuse(key, "a set of " + kind.title + " needs it");
        for (const std::string& key : kind.refuses)
            if (given.find(key))
                given.refuse(key, "a set of " + kind.title + " does not take it");
        if (set.kind == SetKind::lines && !given.find("spacing") && !given.find("density"))
            given.refuse("spacing", "a set of lines needs it, or a density");
    }

    void check_density(const JointSet& set, const Given& given) const
    {
        if (!set.density)
            return;
        using Measure = Density::Measure;
        const Measure measure = set.density->measure;
        if (measure == Measure::p20 && set.kind == SetKind::lines)
            given.refuse("density",
                         "lines have no number per area; wanted P10_per_m, P21_per_m or P32_per_m");
        if (measure == Measure::p30 && set.kind != SetKind::discs)
            given.refuse("density", "only discs have a number per volume");
        const bool in_space =
            measure == Measure::p32 || (measure == Measure::p10 && !set.density->scanline.angle);
        if (set.trace_angle && in_space)
            given.refuse("density",
                         "a set with a trace_angle has no orientation in space, which P32_per_m and "
                         "a scanline in space need");
        if (set.kind == SetKind::lines && set.persistence == 0)
            given.refuse("density", "it is one of joint traces, and a persistence of 0 leaves none");
    }

    void check_terminations(const JointSet& set, const Given& given) const
    {
        if (given.find("termination_probability") && set.terminates_at.empty())
            given.refuse("termination_probability", "wanted terminates_at beside it");
        std::set<std::string> others;
        for (const auto& names :
             {names_of(scene_.joint_sets), names_of(scene_.joints), names_of(scene_.mapped)})
            others.insert(names.begin(), names.end());
        others.erase(set.name);
        for (const std::string& name : set.terminates_at)
            check_reference(given, "terminates_at", name, others, "[[joint_set]], [[joint]] or [[mapped]]");
        // Whatever it ends at, whatever that ends at, and so on.
        std::set<std::string> reached(set.terminates_at.begin(), set.terminates_at.end());
        for (std::size_t before = 0; before != reached.size();) {
            before = reached.size();
            for (const JointSet& other : scene_.joint_sets)
                if (reached.contains(other.name))
                    reached.insert(other.terminates_at.begin(), other.terminates_at.end());
        }
        if (reached.contains(set.name))
            given.refuse("terminates_at", "sets end at each other in a circle; wanted an order in which each "
                                          "ends at earlier ones only");
    }

    void check_joint_sets() const
    {
        for (std::size_t i = 0; i < scene_.joint_sets.size(); ++i) {
            const JointSet& set = scene_.joint_sets[i];
            const Given given = in_list("joint_set", i);
            check_orientation(set, given);
            check_kind(set, given);
            check_density(set, given);
            check_terminations(set, given);
            if (set.region && !set.rocks.empty())
                given.refuse("rocks", "wanted either it or region_m, not both");
            if (set.kind != SetKind::lines)
                continue;
            if (!set.length && set.persistence > 0 && set.persistence < 1)
                given.refuse("length", "a persistence of " + shown(set.persistence) + " needs it");
            for (const Rock& rock : scene_.rocks)
                if (set.persistence < 1 && !rock.strength)
                    given.refuse("persistence", "its rock bridges need cohesion_MPa, friction_angle_deg and "
                                                "tensile_strength_MPa of [[rock]] \"" +
                                                    rock.name + "\"");
        }
        if (!scene_.joint_sets.empty() && !root_.find("random"))
            Place{reading_, ""}.refuse(in_list("joint_set", 0).table.line,
                                       "the scene has no [random] seed: [[joint_set]] needs it");
    }

    // --- Time, and numbers that depend on others -----------------------------------------------------------

    static std::string days(double time) { return shown(time / unit::day) + " days since the start"; }

    void check_times() const
    {
        if (!(scene_.end > 0))
            once("schedule").refuse("end", "it is " + days(scene_.end) + "; wanted an end after the start");
        double before = 0;
        for (std::size_t i = 0; i < scene_.stages.size(); ++i) {
            const double time = scene_.stages[i].time;
            if (!(time > before))
                in_list("stage", i)
                    .refuse("date", "it is " + days(time) + "; wanted later than " +
                                        (i == 0 ? "the start" : "the stage before, " + days(before)));
            if (time > scene_.end)
                in_list("stage", i)
                    .refuse("date",
                            "it is " + days(time) + "; wanted not after the end, " + days(scene_.end));
            before = time;
        }
        for (std::size_t i = 0; i < scene_.points.size(); ++i) {
            const double time = scene_.points[i].first_reading;
            if (!(time >= 0 && time <= scene_.end))
                in_list("point", i)
                    .refuse("first_reading", "it is " + days(time) + "; wanted from the start to the end, " +
                                                 days(scene_.end));
        }
    }

    void check_numbers() const
    {
        const Given cutting = once("cutting");
        if (scene_.cutting.shortest_edge > scene_.zone_size)
            cutting.refuse("shortest_edge_m",
                           "wanted at most [zones] size_m, " + shown(scene_.zone_size) + " m");

        if (scene_.zone_size_at_faces.value_or(0) > scene_.zone_size)
            once("zones").refuse("size_at_faces_m",
                                 "wanted at most size_m, " + shown(scene_.zone_size) + " m");

        if (scene_.cutting.dangling_ends == DanglingEnds::extend)
            for (const Rock& rock : scene_.rocks)
                if (!rock.strength)
                    cutting.refuse("dangling_ends",
                                   "the rock bridges it makes need cohesion_MPa, friction_angle_deg and "
                                   "tensile_strength_MPa of [[rock]] \"" +
                                       rock.name + "\"");

        const Given equilibrium = once("equilibrium");
        const Damping damping = scene_.equilibrium.damping;
        if (damping == Damping::mass && scene_.equilibrium.masses != Masses::real)
            equilibrium.refuse("damping",
                               "wanted masses = \"real\" beside it: scaled masses have no frequency of "
                               "their own");
        if (damping != Damping::mass && equilibrium.find("stiffness_damping_s"))
            equilibrium.refuse("stiffness_damping_s", "wanted damping = \"mass\" beside it");
        if ((damping == Damping::mass) != (equilibrium.find("mass_damping_per_s") != nullptr))
            equilibrium.refuse("mass_damping_per_s", "damping = \"mass\" needs it, and nothing else does");
        if (damping != Damping::local && damping != Damping::combined && equilibrium.find("local_damping"))
            equilibrium.refuse("local_damping", "only damping = \"local\" and \"combined\" use it");
    }

    void check_creep() const
    {
        if (!scene_.creep)
            return;
        const CreepSettings& creep = *scene_.creep;
        const Given given = once("creep");
        if (creep.step && creep.tolerance)
            given.refuse("tolerance_m", "wanted either it or step_days, not both");
        if (!creep.step && !creep.tolerance)
            given.refuse("step_days", "wanted it, or tolerance_m");
        for (const char* key : {"first_step_days", "shortest_step_days", "longest_step_days"})
            if (given.find(key) && !creep.tolerance)
                given.refuse(key, "only tolerance_m uses it; with step_days all steps are that long");
        const double shortest = creep.shortest_step.value_or(0);
        if (creep.longest_step && *creep.longest_step < shortest)
            given.refuse("longest_step_days", "wanted at least shortest_step_days");
        if (creep.first_step && *creep.first_step < shortest)
            given.refuse("first_step_days", "wanted at least shortest_step_days");
        if (creep.first_step && creep.longest_step && *creep.first_step > *creep.longest_step)
            given.refuse("first_step_days", "wanted at most longest_step_days");
    }

    void check_large_displacements() const
    {
        if (!scene_.large_displacements)
            return;
        if (scene_.creep)
            once("large_displacements")
                .refuse("new_contacts", "a scene with [large_displacements] has no [creep]");
        if (scene_.large_displacements->release >= scene_.large_displacements->longest)
            once("large_displacements")
                .refuse("release_s", "wanted less than longest_s, " +
                                         shown(scene_.large_displacements->longest) +
                                         " s: before that there is no rest");
        if (scene_.equilibrium.unloading_increments > 1)
            once("equilibrium")
                .refuse("unloading_increments",
                        "with [large_displacements] a stage takes its rock away at once; wanted 1, and "
                        "[large_displacements] release_s for forces that fade away in time");
        for (std::size_t i = 0; i < scene_.boundaries.size(); ++i)
            for (const char* key : {"displacement_mm", "load_history"})
                if (const Given boundary = in_list("boundary", i); boundary.find(key))
                    boundary.refuse(
                        key, "with [large_displacements], boundaries neither move nor change their traction");
    }
};

} // namespace

void check_scene(const Scene& scene, const TomlValue& root, const Reading& reading)
{
    Checker(scene, root, reading).check();
}

} // namespace jointcreep::scene
