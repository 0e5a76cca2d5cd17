#include "boundary/scene_keys.hpp"

#include "keys/polygon.hpp"

namespace jointcreep::boundary
{
namespace
{

using namespace keys;
using enum Need;
using enum Written;

// Pairs of a date and a factor.
LoadHistory read_load_history(const KeyInfo& key, const TomlValue& value, const Place& place)
{
    const auto* const list = std::get_if<TomlValue::List>(&value.content);
    if (!list || list->empty())
        place.refuse(key, value);
    KeyInfo when = key;
    when.unit = days;
    LoadHistory load_history;
    for (const TomlValue& pair : *list) {
        const auto* const both = std::get_if<TomlValue::List>(&pair.content);
        if (!both || both->size() != 2)
            place.refuse(key, value);
        const double time = read_date(when, both->front(), place);
        if (!load_history.points.empty() && time <= load_history.points.back().first)
            place.refuse(key, value, "dates in increasing order");
        load_history.points.emplace_back(time, read_number(key, both->back(), place));
    }
    return load_history;
}

Table<Boundary> boundary()
{
    struct Fixed {
        bool x, y, normal = false;
    };
    const auto fix = [](Boundary& held, Fixed fixed) {
        held.fix_x = fixed.x;
        held.fix_y = fixed.y;
        held.fix_normal = fixed.normal;
    };
    return {
        {"boundary", in_list, required,
         "Supports and loads of a straight piece of the outline. It has fix, joint, or traction. With fix it "
         "can also have a traction in the free direction, or a displacement. The outline is free where there "
         "is no [[boundary]]."},
        {point("from_m", &Boundary::from, "One end, on the outline."),
         point("to_m", &Boundary::to, "The other end, on the same straight piece of the outline."),
         choice<Boundary, Fixed>("fix", fix,
                                 {{"x", {true, false}},
                                  {"y", {false, true}},
                                  {"xy", {true, true}},
                                  {"normal", {false, false, true}}},
                                 "Directions in which it does not move. normal: rollers, which move only "
                                 "along the segment. A gridpoint where rollers of two directions meet does "
                                 "not move.")
             .optional(),
         text("joint", &Boundary::joint, "It rests on fixed ground through a joint of this joint material.")
             .optional(),
         vector(
             "traction_MPa", &Boundary::traction, MPa, stresses,
             "Total force on the rock per area {x, y}, 0 in a fixed direction. In a direction that is not fixed, "
             "nothing else holds the rock there: the force must be the traction of the in-situ stress, plus the load. (On "
             "rollers this is the shear traction, usually 0.)")
             .optional(),
         vector("displacement_mm", &Boundary::displacement, millimetres, within(1e6),
                "Imposed displacement {x, y}, 0 in a direction that is not fixed. It needs fix and "
                "load_history.")
             .optional(),
         key_of<Boundary>(
             {"load_history",
              "load history",
              {},
              within(farthest_day),
              "Multiplier of traction and displacement over time: pairs of a date and a multiplier, linear "
              "between dates. Examples are a ramp and cycles. Without it a traction acts from the start, and "
              "the in-situ equilibrium is found under it."},
             &Boundary::load_history, read_load_history)
             .asks_for("pairs of a date and a number, [[date, factor], ...]")
             .formerly("course")
             .optional()}};
}

// --- Checks ---------------------------------------------------------------------------------------------

bool is_along(const Eigen::Vector2d& vector, const Eigen::Vector2d& direction)
{
    const double across = vector.x() * direction.y() - vector.y() * direction.x();
    return std::abs(across) <= 1e-9 * vector.norm() * direction.norm();
}

bool is_on_inclined_rollers(const Boundary& boundary)
{
    const Eigen::Vector2d along = boundary.to - boundary.from;
    return boundary.fix_normal && along.x() != 0 && along.y() != 0;
}

bool have_a_common_end(const Boundary& a, const Boundary& b, double tolerance)
{
    for (const auto& p : {a.from, a.to})
        for (const auto& q : {b.from, b.to})
            if ((p - q).norm() <= tolerance)
                return true;
    return false;
}

void check_boundaries(const Scene& scene, const Source& source)
{
    const auto& all = scene.boundaries;
    const double tolerance = outline_tolerance(scene.outline);
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Given given = source.in_list("boundary", i);
        if (!given.find("fix") && !given.find("joint") && !given.find("traction_MPa"))
            given.refuse("fix",
                         "expected fix = \"x\", \"y\", \"xy\" or \"normal\", or joint = a joint material, or "
                         "traction_MPa");
        if (given.find("joint") && (all[i].traction || all[i].displacement))
            given.refuse("joint", "expected no traction_MPa or displacement_mm beside joint");
        if (all[i].displacement && (!given.find("fix") || !given.find("load_history")))
            given.refuse("displacement_mm", "expected fix and load_history beside it");
        if (all[i].displacement && all[i].fix_normal)
            given.refuse("displacement_mm", "expected fix = \"x\", \"y\" or \"xy\" beside it");
        if (all[i].displacement && ((!all[i].fix_x && all[i].displacement->x() != 0) ||
                                    (!all[i].fix_y && all[i].displacement->y() != 0)))
            given.refuse("displacement_mm", "expected 0 in the direction that is not fixed");
        if (all[i].traction &&
            ((all[i].fix_x && all[i].traction->x() != 0) || (all[i].fix_y && all[i].traction->y() != 0)))
            given.refuse("traction_MPa", "expected 0 in a direction that is fixed");
        if (all[i].traction && all[i].fix_normal && !is_along(*all[i].traction, all[i].to - all[i].from))
            given.refuse("traction_MPa", "expected a traction along the segment, whose normal is fixed");
        if (given.find("load_history") && !all[i].traction && !all[i].displacement)
            given.refuse("load_history", "expected traction_MPa or displacement_mm beside it");
        if (given.find("fix") && given.find("joint"))
            given.refuse("fix", "expected either fix or joint, not both");
        const double length = (all[i].to - all[i].from).norm();
        if (!(length > tolerance))
            given.refuse("to_m", "expected another point than from_m");
        double on_sides = length_on_sides(scene.outline, all[i].from, all[i].to, tolerance);
        for (const Polygon& hole : scene.holes)
            on_sides += length_on_sides(hole, all[i].from, all[i].to, tolerance);
        if (on_sides < length - 2 * tolerance)
            given.refuse("to_m", "expected from_m and to_m on one straight piece of the section's outline");
        // Their common gridpoint would be moved off the rollers.
        for (std::size_t j = 0; j < all.size(); ++j)
            if (all[i].displacement && is_on_inclined_rollers(all[j]) &&
                have_a_common_end(all[i], all[j], tolerance))
                given.refuse("displacement_mm",
                             "expected no common point with the rollers (fix = \"normal\") of line " +
                                 std::to_string(source.in_list("boundary", j).table.line));
        for (std::size_t j = 0; j < i; ++j)
            if (common_length(all[i].from, all[i].to, all[j].from, all[j].to, tolerance) > 2 * tolerance)
                given.refuse("to_m", "it runs over the boundary of line " +
                                         std::to_string(source.in_list("boundary", j).table.line));
    }
}

} // namespace

ForceKeys<Scene> scene_keys()
{
    auto boundaries = part_in_list(boundary(), &Scene::boundaries);
    boundaries.turn = Turn::dated;
    boundaries.values = check_boundaries;
    return {.loads = {boundaries}};
}

} // namespace jointcreep::boundary
