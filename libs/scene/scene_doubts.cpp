// Warnings of a scene: values that are allowed but unusual of rock, most often a slip of unit.

#include "scene/scene.hpp"

#include "joint/law.hpp"
#include "keys/polygon.hpp"
#include "keys/source.hpp"
#include "model/polygon.hpp"
#include "model/units.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <string>
#include <vector>

namespace jointcreep::scene
{
namespace
{

using namespace keys;

// What is usual of rock and its joints.
constexpr double least_density = 1500, most_density = 4000;          // [kg/m3]: coal to ores
constexpr double least_modulus = 0.01, most_modulus = 200;           // [GPa]
constexpr double most_rock_cohesion = 100, most_joint_cohesion = 10; // [MPa]
constexpr double most_rock_tension = 50, most_joint_tension = 10;    // [MPa]
constexpr double least_friction = 3, most_friction = 70;             // [deg]
constexpr double least_stiffness = 10,
                 most_stiffness = 1e6; // of joints [MPa/m]: clay filling to tight joints
constexpr double least_persistence = 0.02;
constexpr double least_ratio = 0.2, most_ratio = 4;             // of horizontal to vertical stress
constexpr double least_gravity = 9.5, most_gravity = 10.1;      // [m/s2]
constexpr double least_of_weight = 0.75, most_of_weight = 1.25; // vertical stress over the weight above
constexpr double much_cover = 5; // of rock, whose weight on a free surface is too much [m]
constexpr double most_of_duration = 100,
                 least_of_duration = 1e-4; // retardation time over the duration of the scene
constexpr double most_creep_error = 10;    // of a creep step [mm]

class Doubts
{
public:
    Doubts(const Scene& scene, const Source& source) : scene_(scene), source_(source) {}

    std::vector<std::string> all()
    {
        for (std::size_t i = 0; i < scene_.rocks.size(); ++i)
            look_at(scene_.rocks[i], source_.in_list("rock", i));
        for (std::size_t i = 0; i < scene_.joint_materials.size(); ++i)
            look_at(scene_.joint_materials[i], source_.in_list("joint_material", i));
        look_at_section();
        for (std::size_t i = 0; i < scene_.joint_sets.size(); ++i)
            look_at(scene_.joint_sets[i], source_.in_list("joint_set", i));
        look_at_datum();
        look_at_stress();
        look_at_outline();
        look_at_zones();
        look_at_creep();
        look_at_points();
        return std::move(found_);
    }

private:
    const Scene& scene_;
    const Source& source_;
    std::vector<std::string> found_{};

    static bool usual(double value, double least, double most) { return least <= value && value <= most; }

    void add(const Given& given, const std::string& key, const std::string& what)
    {
        found_.push_back("scene, line " + std::to_string(given.line_of(key)) + ": " + given.told(key, what));
    }

    void look_at_friction(double angle, const Given& given, const std::string& key)
    {
        if (angle > 0 && angle < least_friction * unit::deg)
            add(given, key,
                "the angle is in degrees, and usually above " + shown(least_friction) +
                    " deg; it looks like radians or a tangent");
        if (angle > most_friction * unit::deg)
            add(given, key, "friction angles are usually at most " + shown(most_friction) + " deg");
    }

    // An angle that is not a whole number of degrees, and not above a full circle in radians.
    static bool looks_like_radians(double angle, double most)
    {
        const double degrees = angle / unit::deg;
        return degrees > 0 && degrees <= most && std::abs(degrees - std::round(degrees)) > 1e-6;
    }

    void look_at_section()
    {
        const Given section = source_.once("section");
        if (scene_.gravity > 0 && !usual(scene_.gravity, least_gravity, most_gravity))
            add(section, "gravity_m_per_s2", "on Earth it is 9.81 m/s2");
        if (scene_.gravity == 0 && scene_.in_situ_stress.gradient_yy != 0)
            add(section, "gravity_m_per_s2", "rock has no weight, but the in-situ stress grows with depth");
        if (scene_.azimuth && looks_like_radians(*scene_.azimuth, 2 * std::numbers::pi))
            add(section, "azimuth_deg", "the bearing is in degrees; it looks like radians");
    }

    void look_at(const JointSet& set, const Given& given)
    {
        if (set.dip && looks_like_radians(set.dip->mean, std::numbers::pi / 2))
            add(given, "dip", "the mean dip is in degrees; it looks like radians");
        if (given.find("persistence") && set.persistence > 0 && set.persistence < least_persistence)
            add(given, "persistence",
                "it is the part of the line that is joint, from 0 to 1, and usually above " +
                    shown(least_persistence));
    }

    // Of a joint [Pa/m].
    void look_at_stiffness(double stiffness, const Given& given, const std::string& key)
    {
        const bool is_given = given.find(key) && stiffness > 0; // 0 is a joint without a spring
        if (is_given && !usual(stiffness / (unit::MPa / unit::m), least_stiffness, most_stiffness))
            add(given, key,
                "joints usually have " + shown(least_stiffness) + " to " + shown(most_stiffness) +
                    " MPa/m; is it in the unit of its key?");
    }

    void look_at(const Rock& rock, const Given& given)
    {
        if (!usual(rock.density, least_density, most_density))
            add(given, "density_kg_per_m3",
                "rock usually has " + shown(least_density) + " to " + shown(most_density) + " kg/m3");
        if (!usual(rock.youngs_modulus / unit::GPa, least_modulus, most_modulus))
            add(given, "youngs_modulus_GPa",
                "rock usually has " + shown(least_modulus) + " to " + shown(most_modulus) + " GPa");
        if (rock.kelvin)
            look_at_retardation(rock.kelvin->viscosity / rock.kelvin->modulus, given,
                                "kelvin_shear_viscosity_GPa_day");
        if (!rock.strength)
            return;
        look_at_friction(rock.strength->friction_angle, given, "friction_angle_deg");
        if (rock.strength->cohesion / unit::MPa > most_rock_cohesion)
            add(given, "cohesion_MPa", "rock usually has at most " + shown(most_rock_cohesion) + " MPa");
        if (rock.strength->tensile_strength / unit::MPa > most_rock_tension)
            add(given, "tensile_strength_MPa",
                "rock usually has at most " + shown(most_rock_tension) + " MPa");
    }

    void look_at(const JointMaterial& material, const Given& given)
    {
        for (const joint::Parameter& parameter : joint::all_parameters())
            if (const std::string key(parameter.key); key.ends_with("friction_angle_deg") && given.find(key))
                look_at_friction(parameter.of(material), given, key);
        if (given.find("cohesion_MPa") && material.cohesion / unit::MPa > most_joint_cohesion)
            add(given, "cohesion_MPa", "joints usually have at most " + shown(most_joint_cohesion) + " MPa");
        if (given.find("tensile_strength_MPa") && material.tensile_strength / unit::MPa > most_joint_tension)
            add(given, "tensile_strength_MPa",
                "joints usually have at most " + shown(most_joint_tension) + " MPa");
        const bool is_chain = given.find("kelvin_chain") != nullptr;
        for (const Kelvin& unit : material.kelvin) {
            look_at_retardation(unit.normal_viscosity / unit.normal_stiffness, given,
                                is_chain ? "kelvin_chain" : "normal_kelvin_viscosity_MPa_day_per_m");
            look_at_retardation(unit.shear_viscosity / unit.shear_stiffness, given,
                                is_chain ? "kelvin_chain" : "shear_kelvin_viscosity_MPa_day_per_m");
        }
        look_at_stiffness(material.normal_stiffness, given, "normal_stiffness_MPa_per_m");
        look_at_stiffness(material.shear_stiffness, given, "shear_stiffness_MPa_per_m");
        if (material.normal_stiffness > 0 && material.shear_stiffness > 2 * material.normal_stiffness)
            add(given, "shear_stiffness_MPa_per_m",
                "a joint is usually softer in shear than across, normal_stiffness_MPa_per_m = " +
                    shown(material.normal_stiffness / (unit::MPa / unit::m)));
    }

    // Of a Kelvin unit [s].
    void look_at_retardation(double time, const Given& given, const std::string& key)
    {
        const char* const how = time > most_of_duration * scene_.end    ? "hardly creeps"
                                : time < least_of_duration * scene_.end ? "creeps at once"
                                                                        : nullptr;
        if (scene_.creep && how)
            add(given, key,
                "the retardation time, viscosity over stiffness, is " + shown(rounded(time / unit::day)) +
                    " days, and the scene lasts " + shown(rounded(scene_.end / unit::day)) + ": this unit " +
                    how + "; is the viscosity in the unit of its key?");
    }

    // Above the datum a stress that grows with depth is tension.
    void look_at_datum()
    {
        const InSituStress& stress = scene_.in_situ_stress;
        const auto top = *std::ranges::max_element(scene_.outline, {}, [](const auto& p) { return p.y(); });
        const Eigen::Vector3d at = stress.at(top);
        if (const double above = -stress.depth_of(top); above > 0 && std::max(at[0], at[1]) > 0)
            add(source_.once("in_situ_stress"), "elevation_m",
                "the section reaches " + shown(rounded(above)) + " m above it, where the stress is tension");
    }

    // At the lowest corner of the outline, where the weight above is largest.
    void look_at_stress()
    {
        const InSituStress& stress = scene_.in_situ_stress;
        const auto place = *std::ranges::min_element(scene_.outline, {}, [](const auto& p) { return p.y(); });
        const double depth = stress.depth_of(place);
        if (!(depth > 0) || !(scene_.gravity > 0))
            return;
        const Eigen::Vector3d at = stress.at(place), top = stress.at({place.x(), place.y() + depth});
        const Given given = source_.once("in_situ_stress");
        const std::string key = given.find("profile")                   ? "profile"
                                : given.find("horizontal_stress_ratio") ? "horizontal_stress_ratio"
                                                                        : "compression_yy_gradient_MPa_per_m",
                          where = " at " + shown(depth) + " m of depth";
        const auto [light, heavy] = std::ranges::minmax_element(scene_.rocks, {}, &Rock::density);
        const double vertical = top[1] - at[1], least = light->density * scene_.gravity * depth,
                     most = heavy->density * scene_.gravity * depth;
        if (!usual(vertical, least_of_weight * least, most_of_weight * most))
            add(given, key,
                "the vertical compression grows by " + shown(rounded(vertical / unit::MPa)) + " MPa" + where +
                    ", and the weight of the rock above is " + shown(rounded(least / unit::MPa)) +
                    (most > least ? " to " + shown(rounded(most / unit::MPa)) : "") + " MPa");
        const auto of_key = [&](bool is_vertical) {
            const std::string of = is_vertical ? "compression_yy" : "compression_xx", at_datum = of + "_MPa",
                              gradient = of + "_gradient_MPa_per_m";
            // The gradient, unless it is compression and the stress at the datum is not.
            const double grows = is_vertical ? stress.gradient_yy : stress.gradient_xx;
            return given.find(gradient) == nullptr      ? key
                   : given.find(at_datum) && grows >= 0 ? at_datum
                                                        : gradient;
        };
        if (const bool is_vertical = at[1] > 0; is_vertical || at[0] > 0)
            add(given, of_key(is_vertical),
                std::string("the ") + (is_vertical ? "vertical" : "horizontal") + " stress" + where +
                    " is tension, " + shown(rounded((is_vertical ? at[1] : at[0]) / unit::MPa)) +
                    " MPa; compression is positive here, expected a positive number");
        else if (at[1] < 0 && !usual(at[0] / at[1], least_ratio, most_ratio))
            add(given,
                given.find("compression_xx_gradient_MPa_per_m") ? "compression_xx_gradient_MPa_per_m" : key,
                "the horizontal stress" + where + " is " + shown(rounded(at[0] / at[1])) +
                    " times the vertical one; usual are " + shown(least_ratio) + " to " + shown(most_ratio));
    }

    // Of the in-situ stress on a side of the outline, less what boundaries support [Pa].
    Eigen::Vector2d unsupported(const Eigen::Vector2d& place, const Eigen::Vector2d& normal) const
    {
        const Eigen::Vector3d stress = scene_.in_situ_stress.at(place);
        Eigen::Vector2d traction(stress[0] * normal.x() + stress[2] * normal.y(),
                                 stress[2] * normal.x() + stress[1] * normal.y());
        const double tolerance = outline_tolerance(scene_.outline);
        for (const Boundary& boundary : scene_.boundaries) {
            if (distance_to_sides({boundary.from, boundary.to}, place) > tolerance)
                continue;
            const bool is_loaded = boundary.traction || !boundary.joint.empty();
            if (boundary.fix_x || is_loaded)
                traction.x() = 0;
            if (boundary.fix_y || is_loaded)
                traction.y() = 0;
            if (boundary.fix_normal)
                traction -= normal.dot(traction) * normal;
        }
        return traction;
    }

    // Rock that nothing loads has no stress on its surface.
    void look_at_outline()
    {
        double largest = 0;
        Eigen::Vector2d where;
        const Polygon& outline = scene_.outline;
        for (std::size_t i = 0; i < outline.size(); ++i) {
            const Eigen::Vector2d from = outline[i], along = outline[(i + 1) % outline.size()] - from,
                                  normal = Eigen::Vector2d(along.y(), -along.x()).normalized();
            for (const double share : {0.1, 0.3, 0.5, 0.7, 0.9}) {
                const Eigen::Vector2d place = from + share * along;
                if (scene_.in_situ_stress.depth_of(place) < 0)
                    continue; // look_at_datum() tells it
                if (const double found = unsupported(place, normal).norm(); found > largest) {
                    largest = found;
                    where = place;
                }
            }
        }
        const auto light = std::ranges::min_element(scene_.rocks, {}, &Rock::density);
        if (scene_.gravity == 0 || largest <= much_cover * light->density * scene_.gravity)
            return;
        const Given given = source_.once("in_situ_stress");
        add(given, given.find("ground_m") ? "ground_m" : "elevation_m",
            "the stress on the outline at [" + shown(rounded(where.x())) + ", " + shown(rounded(where.y())) +
                "] m is " + shown(rounded(largest / unit::MPa)) +
                " MPa in a direction in which no [[boundary]] supports or loads it; expected about 0: no stress on a "
                "free surface, no shear stress on rollers");
    }

    void look_at_zones()
    {
        const auto size_along = [this](const Eigen::Vector2d& axis) {
            const Interval sides = extent(scene_.outline, axis);
            return sides.high - sides.low;
        };
        const double size =
            std::min(size_along(Eigen::Vector2d::UnitX()), size_along(Eigen::Vector2d::UnitY()));
        if (scene_.zone_size > size)
            add(source_.once("zones"), "size_m",
                "zones are as large as the section, " + shown(rounded(size)) +
                    " m; usual is at most a tenth of it");
    }

    void look_at_creep()
    {
        if (scene_.creep && scene_.creep->tolerance.value_or(0) > most_creep_error * unit::mm)
            add(source_.once("creep"), "tolerance_m",
                "the allowed error of a step is " + shown(*scene_.creep->tolerance / unit::mm) +
                    " mm; usual are 0.001 to 0.1 mm");
    }

    // To three digits.
    static double rounded(double value)
    {
        std::array<char, 32> text{};
        std::snprintf(text.data(), text.size(), "%.3g", value);
        return std::strtod(text.data(), nullptr);
    }

    // The stage that excavates the rock of a place, if any.
    const Stage* excavated_by(const Eigen::Vector2d& place) const
    {
        const double tolerance = outline_tolerance(scene_.outline);
        for (const Stage& stage : scene_.stages)
            for (const Polygon& removed : stage.remove)
                if (covers(removed, place, 0) && distance_to_sides(removed, place) > tolerance)
                    return &stage;
        return nullptr;
    }

    // Points that are given one by one, and then those of the lines.
    void look_at_points()
    {
        const TomlValue* const list = source_.root.find("point");
        std::size_t point = 0;
        for (; list && point < std::get<TomlValue::List>(list->content).size(); ++point)
            if (const Stage* const stage = excavated_by(scene_.points[point].at))
                add(source_.in_list("point", point), "at_m",
                    "it is in rock that stage \"" + stage->name + "\" excavates; its history ends there");
        for (std::size_t line = 0; line < scene_.lines.size(); ++line) {
            Index excavated = 0;
            for (Index i = 0; i < scene_.lines[line].points; ++i, ++point)
                excavated += excavated_by(scene_.points[point].at) ? 1 : 0;
            if (excavated > 0)
                add(source_.in_list("monitoring_line", line), "from_m",
                    std::to_string(excavated) + " of its " + std::to_string(scene_.lines[line].points) +
                        " points are in rock that is excavated; their histories end there");
        }
    }
};

} // namespace

std::vector<std::string> doubts_about(const Scene& scene, std::string_view text, const std::string& name)
{
    const TomlValue root = parse_toml(text, name);
    const Reading reading{.name = name, .whole = "scene"};
    return Doubts(scene, {root, reading}).all();
}

} // namespace jointcreep::scene
