#include "scene/scene_checks.hpp"

#include "joint/law.hpp"
#include "keys/polygon.hpp"
#include "model/error.hpp"
#include "model/polygon.hpp"
#include "scene/forces.hpp"

#include <cmath>
#include <map>
#include <numeric>
#include <set>

namespace jointcreep::scene
{
namespace
{

using namespace keys;

// Of a joint plane's unit normal in the section's plane: below it the two are nearly parallel.
constexpr double least_trace = 0.05;

class Checker
{
public:
    Checker(const Scene& scene, const Source& source, Refusals& refusals)
        : scene_(scene), source_(source), refusals_(refusals)
    {
    }

    // Names and shapes, then all else, which may rely on them. Faults of one step are told together, the first of each of
    // its checks.
    void check() const
    {
        using C = Checker;
        for (const std::vector<void (C::*)() const>& step :
             {std::vector{&C::check_names, &C::check_references, &C::check_polygons},
              {&C::check_joints, &C::check_values_of_materials, &C::check_joint_sets,
               &C::check_values_of_loads, &C::check_times, &C::check_places, &C::check_cutting,
               &C::check_zones, &C::check_equilibrium, &C::check_creep, &C::check_large_displacements}}) {
            for (const auto check : step)
                refusals_.attempt([&] { (this->*check)(); });
            refusals_.end();
        }
    }

private:
    const Scene& scene_;
    const Source& source_;
    Refusals& refusals_;

    // For every i below n: a fault of one does not hide those of the others.
    template <class Check>
    void for_each(std::size_t n, Check check) const
    {
        for (std::size_t i = 0; i < n; ++i)
            refusals_.attempt([&] { check(i); });
    }

    using Check = Part<Scene>::Check Part<Scene>::*;

    Given once(const std::string& table) const { return source_.once(table); }
    Given in_list(const std::string& table, std::size_t i) const { return source_.in_list(table, i); }

    // What concerns one kind of force alone.
    void check_materials(Check check) const
    {
        for (const ForceKeys<Scene>& force : forces())
            check_parts(force.materials, check, scene_, source_);
    }
    void check_loads(Check check) const
    {
        for (const ForceKeys<Scene>& force : forces())
            check_parts(force.loads, check, scene_, source_);
    }
    void check_values_of_materials() const { check_materials(&Part<Scene>::values); }
    void check_values_of_loads() const { check_loads(&Part<Scene>::values); }

    // --- Names and references ------------------------------------------------------------------------------

    void check_names() const
    {
        for (const ForceKeys<Scene>& force : forces()) {
            keys::check_names(force.materials, source_);
            keys::check_names(force.loads, source_);
        }
        for (const char* const table : {"stage", "point", "monitoring_line", "gauge"})
            source_.check_unique({table});
        source_.check_unique({"joint_set", "joint", "mapped"}); // a joint is a set of its own in all files
    }

    void check_references() const
    {
        const auto rocks = names_of(scene_.rocks);
        const auto materials = names_of(scene_.joint_materials);
        check_reference(once("section"), "rock", scene_.rock, rocks, "[[rock]]");
        check_materials(&Part<Scene>::references);
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
                        .report("material_in",
                                "expected each rock once, and \"" + in.rock + "\" is there twice");
            }
        }
        for (std::size_t i = 0; i < scene_.mapped.size(); ++i)
            check_reference(in_list("mapped", i), "material", scene_.mapped[i].material, materials,
                            "[[joint_material]]");
        for (std::size_t i = 0; i < scene_.joint_sets.size(); ++i)
            for (const std::string& rock : scene_.joint_sets[i].rocks)
                check_reference(in_list("joint_set", i), "rocks", rock, rocks, "[[rock]]");
        check_loads(&Part<Scene>::references);
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

    void check_polygons() const
    {
        check_polygon(once("section"), "outline_m", scene_.outline);
        refusals_.attempt([this] { check_holes(); });
        check_materials(&Part<Scene>::shapes);
        for_each(scene_.joint_sets.size(), [this](std::size_t i) {
            if (scene_.joint_sets[i].region)
                check_polygon(in_list("joint_set", i), "region_m", *scene_.joint_sets[i].region);
        });
        check_loads(&Part<Scene>::shapes);
        if (scene_.fine_zones)
            refusals_.attempt([this] { check_fine_zones(*scene_.fine_zones); });
        for_each(scene_.stages.size(), [this](std::size_t i) {
            for (const Polygon& polygon : scene_.stages[i].remove)
                check_polygon(in_list("stage", i), "remove_m", polygon);
        });
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
            once("zones").refuse(
                "fine_m", "it is outside the section; expected a polygon that has a part of it inside");
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
                section.refuse("holes_m", which + " is not inside outline_m; expected one that is, and does "
                                                  "not touch it");
            for (std::size_t j = 0; j < i; ++j)
                if (sides_come_near(holes[i], holes[j], tolerance()) || covers(holes[i], holes[j][0], 0) ||
                    covers(holes[j], holes[i][0], 0))
                    section.refuse("holes_m", which + " meets hole " + std::to_string(j + 1) +
                                                  "; expected holes apart from each other");
        }
    }

    double tolerance() const { return outline_tolerance(scene_.outline); }

    void check_joints() const
    {
        for (std::size_t i = 0; i < scene_.joints.size(); ++i)
            if (scene_.joints[i].from == scene_.joints[i].to)
                in_list("joint", i).report("to_m", "expected another point than from_m");
    }

    // Refuses a place that is not in the rock.
    void check_place(const Given& given, const std::string& key, const Eigen::Vector2d& at,
                     const std::string& whose) const
    {
        const std::string place = whose + "[" + shown(at.x()) + ", " + shown(at.y()) + "] is ";
        for (const Polygon& hole : scene_.holes)
            if (covers(hole, at, 0) && distance_to_sides(hole, at) > tolerance())
                return given.report(key, place + "in a hole of the section; expected a point in the rock");
        if (!covers(scene_.outline, at, tolerance()))
            given.report(key, place + "outside the section's outline; expected a point inside");
    }

    // Points that are given one by one, and then those of the lines.
    template <class OfPoint, class OfLine>
    void for_each_point(OfPoint of_point, OfLine of_line) const
    {
        std::size_t point = 0;
        const TomlValue* const given = source_.root.find("point");
        for (; given && point < std::get<TomlValue::List>(given->content).size(); ++point)
            of_point(in_list("point", point), scene_.points[point]);
        for (std::size_t line = 0; line < scene_.lines.size(); ++line)
            for (Index i = 0; i < scene_.lines[line].points; ++i, ++point)
                of_line(in_list("monitoring_line", line), scene_.points[point]);
    }

    void check_places() const
    {
        std::set<std::string> names;
        for_each_point(
            [&](const Given& given, const MonitoringPoint& point) {
                names.insert(point.name);
                check_place(given, "at_m", point.at, "");
            },
            [&](const Given& given, const MonitoringPoint& point) {
                if (!names.insert(point.name).second)
                    given.report("name", "its point \"" + point.name + "\" has the name of another point");
                check_place(given, "to_m", point.at, "its point \"" + point.name + "\" at ");
            });
        for (std::size_t line = 0; line < scene_.lines.size(); ++line)
            if (!((scene_.lines[line].to - scene_.lines[line].from).norm() > tolerance()))
                in_list("monitoring_line", line).report("to_m", "expected another point than from_m");
        for (std::size_t i = 0; i < scene_.gauges.size(); ++i)
            check_place(in_list("gauge", i), "at_m", scene_.gauges[i].at, "");
    }

    // --- Joint sets ----------------------------------------------------------------------------------------

    void check_orientation(const JointSet& set, const Given& given) const
    {
        const std::string wanted = "expected one of trace_angle, orientation, or dip and dip_direction";
        const bool by_poles = set.orientation || !set.poles.empty();
        if (set.kind == SetKind::discs && set.trace_angle)
            given.refuse("trace_angle", "discs lie in space: expected orientation, or dip and dip_direction");
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
                         "trace; expected another dip or direction, or no such set");
    }

    // Keys that a kind of set needs, and those it does not take.
    static void check_kind(const JointSet& set, const Given& given)
    {
        struct Kind {
            std::string title;
            std::vector<std::string> needs, refuses;
        };
        const Kind lines{"lines", {}, {"diameter", "terminates_at"}},
            segments{
                "segments", {"length", "density"}, {"spacing", "persistence", "bridge_length_m", "diameter"}},
            discs{"discs", {"diameter", "density"}, {"spacing", "persistence", "bridge_length_m", "length"}};
        const Kind& kind = set.kind == SetKind::lines      ? lines
                           : set.kind == SetKind::segments ? segments
                                                           : discs;
        for (const std::string& key : kind.needs)
            if (!given.find(key))
                given.refuse(key, "a set of " + kind.title + " needs it");
        for (const std::string& key : kind.refuses)
            if (given.find(key))
                given.refuse(key, "a set of " + kind.title + " does not take it");
        if (set.kind != SetKind::lines)
            return;
        if (!given.find("spacing") && !given.find("density"))
            given.refuse("spacing", "a set of lines needs it, or a density");
        if (!given.find("persistence") && !given.find("bridge_length_m"))
            given.refuse("persistence", "a set of lines needs it, or bridge_length_m");
        if (given.find("persistence") && given.find("bridge_length_m"))
            given.refuse("bridge_length_m", "expected either it or persistence, not both");
        if (given.find("bridge_length_m") && !set.length)
            given.refuse("length", "a bridge_length_m needs it");
    }

    void check_density(const JointSet& set, const Given& given) const
    {
        if (!set.density)
            return;
        using Measure = Density::Measure;
        const Measure measure = set.density->measure;
        if (measure == Measure::p20 && set.kind == SetKind::lines)
            given.refuse("density",
                         "lines have no number per area; expected P10_per_m, P21_per_m or P32_per_m");
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
            given.refuse("termination_probability", "expected terminates_at beside it");
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
            given.refuse("terminates_at",
                         "sets end at each other in a circle; expected an order in which each "
                         "ends at earlier ones only");
    }

    void check_joint_sets() const
    {
        for_each(scene_.joint_sets.size(), [this](std::size_t i) {
            const JointSet& set = scene_.joint_sets[i];
            const Given given = in_list("joint_set", i);
            check_orientation(set, given);
            check_kind(set, given);
            check_density(set, given);
            check_terminations(set, given);
            if (set.region && !set.rocks.empty())
                given.refuse("rocks", "expected either it or region_m, not both");
            if (set.kind != SetKind::lines)
                return;
            if (!set.length && set.persistence > 0 && set.persistence < 1)
                given.refuse("length", "a persistence of " + shown(set.persistence) + " needs it");
            for (const Rock& rock : scene_.rocks)
                if (set.persistence < 1 && !rock.strength)
                    given.refuse(given.find("persistence") ? "persistence" : "bridge_length_m",
                                 "its rock bridges need cohesion_MPa, friction_angle_deg and "
                                 "tensile_strength_MPa of [[rock]] \"" +
                                     rock.name + "\"");
        });
        if (!scene_.joint_sets.empty() && !source_.root.find("random"))
            Place{source_.reading, ""}.refuse(in_list("joint_set", 0).table.line,
                                              "the scene has no [random] seed: [[joint_set]] needs it");
    }

    // --- Time, and numbers that depend on others -----------------------------------------------------------

    static std::string days(double time) { return shown(time / unit::day) + " days since the start"; }

    void check_times() const
    {
        if (!(scene_.end > 0))
            once("schedule").report("end", "it is " + days(scene_.end) + "; expected an end after the start");
        double before = 0;
        for (std::size_t i = 0; i < scene_.stages.size(); ++i) {
            const double time = scene_.stages[i].time;
            if (!(time > before))
                in_list("stage", i)
                    .report("date", "it is " + days(time) + "; expected later than " +
                                        (i == 0 ? "the start" : "the stage before, " + days(before)));
            if (time > scene_.end)
                in_list("stage", i)
                    .report("date",
                            "it is " + days(time) + "; expected not after the end, " + days(scene_.end));
            before = time;
        }
        const auto check_reading = [this](const Given& given, double time) {
            if (!(time >= 0 && time <= scene_.end))
                given.report("first_reading", "it is " + days(time) +
                                                  "; expected from the start to the end, " +
                                                  days(scene_.end));
        };
        for_each_point([&](const Given& given,
                           const MonitoringPoint& point) { check_reading(given, point.first_reading); },
                       [](const Given&, const MonitoringPoint&) {});
        for (std::size_t line = 0; line < scene_.lines.size(); ++line)
            check_reading(in_list("monitoring_line", line), scene_.lines[line].first_reading);
    }

    // What is smaller than the shortest edge is merged: the whole section, where that is.
    void check_shortest_edge(const Given& cutting) const
    {
        const auto along = [this](const Eigen::Vector2d& axis) {
            const Interval sides = extent(scene_.outline, axis);
            return sides.high - sides.low;
        };
        const double extent_of_section =
                         std::min(along(Eigen::Vector2d::UnitX()), along(Eigen::Vector2d::UnitY())),
                     shortest = scene_.cutting.shortest_edge;
        if (shortest < extent_of_section)
            return;
        const std::string wanted = "less than the extent of the section, " + shown(extent_of_section) + " m";
        if (cutting.find("shortest_edge_m"))
            cutting.refuse("shortest_edge_m", "expected " + wanted);
        const std::string size = scene_.zone_size_at_faces ? "size_at_faces_m" : "size_m";
        once("zones").refuse(size, "edges shorter than 0.02 x " + size + ", " + shown(shortest) +
                                       " m, are merged; expected " + wanted + ". Set a smaller " + size +
                                       ", or [cutting] shortest_edge_m");
    }

    void check_cutting() const
    {
        const Given cutting = once("cutting");
        check_shortest_edge(cutting);
        if (scene_.cutting.shortest_edge > scene_.zone_size)
            cutting.refuse("shortest_edge_m",
                           "expected at most [zones] size_m, " + shown(scene_.zone_size) + " m");

        if (scene_.cutting.dangling_ends == DanglingEnds::extend)
            for (const Rock& rock : scene_.rocks)
                if (!rock.strength)
                    cutting.refuse("dangling_ends",
                                   "the rock bridges it makes need cohesion_MPa, friction_angle_deg and "
                                   "tensile_strength_MPa of [[rock]] \"" +
                                       rock.name + "\"");
    }

    void check_zones() const
    {
        if (scene_.zones_are_quadratic() && scene_.large_displacements)
            once("zones").report("kind", "expected \"constant strain\" with [large_displacements]");
        if (scene_.zone_size_at_faces.value_or(0) > scene_.zone_size)
            once("zones").report("size_at_faces_m",
                                 "expected at most size_m, " + shown(scene_.zone_size) + " m");
    }

    void check_equilibrium() const
    {
        const Given equilibrium = once("equilibrium");
        const Damping damping = scene_.equilibrium.damping;
        if (damping == Damping::mass && scene_.equilibrium.masses != Masses::real)
            equilibrium.refuse("damping",
                               "expected masses = \"real\" beside it: scaled masses have no frequency of "
                               "their own");
        if (damping != Damping::mass && equilibrium.find("stiffness_damping_s"))
            equilibrium.refuse("stiffness_damping_s", "expected damping = \"mass\" beside it");
        if ((damping == Damping::mass) != (equilibrium.find("mass_damping_per_s") != nullptr))
            equilibrium.refuse("mass_damping_per_s", "damping = \"mass\" needs it, and nothing else does");
        if (damping == Damping::mass &&
            scene_.equilibrium.mass_damping + scene_.equilibrium.stiffness_damping == 0)
            equilibrium.refuse("mass_damping_per_s",
                               "expected more than 0, or stiffness_damping_s beside it");
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
            given.refuse("tolerance_m", "expected either it or step_days, not both");
        if (!creep.step && !creep.tolerance)
            given.refuse("step_days", "expected it, or tolerance_m");
        for (const char* key : {"first_step_days", "shortest_step_days", "longest_step_days"})
            if (given.find(key) && !creep.tolerance)
                given.refuse(key, "only tolerance_m uses it; with step_days all steps are that long");
        const double shortest = creep.shortest_step.value_or(0);
        if (creep.longest_step && *creep.longest_step < shortest)
            given.refuse("longest_step_days", "expected at least shortest_step_days");
        if (creep.first_step && *creep.first_step < shortest)
            given.refuse("first_step_days", "expected at least shortest_step_days");
        if (creep.first_step && creep.longest_step && *creep.first_step > *creep.longest_step)
            given.refuse("first_step_days", "expected at most longest_step_days");
    }

    void check_large_displacements() const
    {
        if (!scene_.large_displacements)
            return;
        for (std::size_t i = 0; i < scene_.boundaries.size(); ++i)
            if (scene_.boundaries[i].fix_normal)
                in_list("boundary", i)
                    .refuse("fix", "expected \"x\", \"y\" or \"xy\" with [large_displacements]");
        if (scene_.creep)
            check_creep_at_large_displacements();
        if (scene_.large_displacements->release >= scene_.large_displacements->longest)
            once("large_displacements")
                .refuse("release_s", "expected less than longest_s, " +
                                         shown(scene_.large_displacements->longest) +
                                         " s; no rest is possible before");
        if (scene_.large_displacements->stop && scene_.stages.empty())
            once("large_displacements")
                .refuse("stop_s", "expected a [[stage]]: this key ends the dynamic analysis of the last one");
        if (scene_.large_displacements->stop > scene_.large_displacements->longest)
            once("large_displacements")
                .refuse("stop_s",
                        "expected at most longest_s, " + shown(scene_.large_displacements->longest) + " s");
        if (scene_.large_displacements->stop &&
            *scene_.large_displacements->stop <= scene_.large_displacements->release)
            once("large_displacements")
                .refuse("stop_s", "expected more than release_s, " +
                                      shown(scene_.large_displacements->release) +
                                      " s, in which the forces of the excavated rock decrease to 0");
        if (scene_.equilibrium.unloading_increments > 1)
            once("equilibrium")
                .refuse("unloading_increments",
                        "with [large_displacements] a stage excavates its rock at once; expected 1, and "
                        "[large_displacements] release_s for forces that decrease to 0 slowly");
        if (scene_.equilibrium.increments_tolerance)
            once("equilibrium")
                .refuse("increments_tolerance", "a scene with [large_displacements] has no increments");
        for (std::size_t i = 0; i < scene_.boundaries.size(); ++i)
            for (const char* key : {"displacement_mm", "load_history"})
                if (const Given boundary = in_list("boundary", i); boundary.find(key))
                    boundary.refuse(
                        key,
                        "with [large_displacements], boundaries must neither move nor change their traction");
    }

    // Joints creep there, by contacts whose springs have no memory of their path.
    void check_creep_at_large_displacements() const
    {
        const LargeDisplacements& large = *scene_.large_displacements;
        const Given given = once("large_displacements");
        if (!(large.release > 0))
            given.refuse("release_s",
                         "expected more than 0 with [creep]: the creep of a step is added in this time");
        if (large.stop)
            given.refuse("stop_s",
                         "expected no such key with [creep]: creep begins when the rock is at rest");
        for (std::size_t i = 0; i < scene_.rocks.size(); ++i)
            if (scene_.rocks[i].kelvin || scene_.rocks[i].maxwell_viscosity)
                in_list("rock", i).refuse("name",
                                          "with [large_displacements] joints creep, and rock does not: "
                                          "expected no creep of rock");
        for (std::size_t i = 0; i < scene_.joint_materials.size(); ++i) {
            const JointMaterial& material = scene_.joint_materials[i];
            if ((!material.kelvin.empty() || material.maxwell) && joint::remembers(joint::law_of(material)))
                in_list("joint_material", i)
                    .refuse("name",
                            "with [large_displacements] a joint that yields continuously does not creep");
        }
    }
};

constexpr const char* other_scene = ". The file was made from another scene; make it again from this one";

// The names of the scene's tables, in this order, beside those of the file.
void check_names(const Source& source, const std::vector<std::string>& tables, const std::string& dataset,
                 const std::vector<std::string>& of_file)
{
    std::size_t row = 0;
    for (const std::string& table : tables) {
        const TomlValue* const list = source.root.find(table);
        const std::size_t count = list ? std::get<TomlValue::List>(list->content).size() : 0;
        for (std::size_t i = 0; i < count; ++i, ++row) {
            const Given given = source.in_list(table, i);
            const std::string wanted = row < of_file.size() ? '"' + of_file[row] + '"' : "no more of them";
            if (row >= of_file.size() || std::get<std::string>(given.find("name")->content) != of_file[row])
                given.refuse("name",
                             "expected " + wanted + ", as " + dataset + " of the file has" + other_scene);
        }
    }
    if (row < of_file.size())
        Place{source.reading, ""}.refuse(1, "the scene has no \"" + of_file[row] + "\", which " + dataset +
                                                " of the file has" + other_scene);
}

} // namespace

void check_scene(const Scene& scene, const Source& source, Refusals& refusals)
{
    Checker(scene, source, refusals).check();
}

void check_network(const Scene& scene, const Source& source, const Network& network)
{
    check_names(source, {"rock"}, "/names/rock", network.names.rock);
    check_names(source, {"joint_material"}, "/names/joint_material", network.names.joint_material);
    check_names(source, {"joint_set", "joint", "mapped"}, "/names/joint_set", network.names.joint_set);
    check_names(source, {"stage"}, "/names/stage", network.names.stage);

    const Blocks& blocks = network.blocks;
    const auto last = std::ranges::max_element(blocks.edge_boundary);
    if (last != blocks.edge_boundary.end() && *last >= static_cast<Index>(scene.boundaries.size()))
        source.in_list("boundary", scene.boundaries.size() - 1)
            .refuse("from_m", "this is the last [[boundary]], and /edges/boundary of the file has " +
                                  std::to_string(*last + 1) + " of them" + other_scene);
    double section = area_of(scene.outline);
    for (const Polygon& hole : scene.holes)
        section -= area_of(hole);
    const double all_blocks = std::accumulate(blocks.block_area.begin(), blocks.block_area.end(), 0.0);
    if (!(std::abs(section - all_blocks) <= 1e-6 * section))
        source.once("section").refuse("outline_m", "the section has " + shown(section) +
                                                       " m2, and the blocks of the file have " +
                                                       shown(all_blocks) + " m2" + other_scene);
}

} // namespace jointcreep::scene
