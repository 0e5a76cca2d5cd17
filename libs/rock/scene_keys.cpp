#include "rock/scene_keys.hpp"

#include "keys/polygon.hpp"

#include <algorithm>

namespace jointcreep::rock
{
namespace
{

using namespace keys;
using enum Need;
using enum Written;

constexpr KeyUnit kg_per_m3{"kg/m3", unit::kg / (unit::m * unit::m * unit::m)};
constexpr KeyUnit GPa{"GPa", unit::GPa};
constexpr KeyUnit GPa_day{"GPa day", unit::GPa* unit::day};

constexpr Range strength = from(0).to(1e4);      // [MPa]
constexpr Range friction = from(0).below(90);    // [deg]
constexpr Range viscosity = from(1e-9).to(1e12); // [GPa day]
constexpr Range stress_gradient = within(100);   // [MPa/m]

Table<Rock> rock()
{
    return {
        {"rock", in_list, required,
         "Intact rock: plane strain, elastic or yielding. Its strength is that of the rock bridges, and is "
         "needed where a joint set has a persistence below 1, where dangling ends are extended, and where "
         "the rock yields. With a Kelvin unit or a Maxwell dashpot it creeps, in shear only: its volume "
         "stays elastic."},
        {text("name", &Rock::name, "Name, once among the rocks."),
         number("density_kg_per_m3", &Rock::density, kg_per_m3, above(0).to(3e4), "Density."),
         number("youngs_modulus_GPa", &Rock::youngs_modulus, GPa, above(0).to(1e4), "Young's modulus."),
         number("poissons_ratio", &Rock::poissons_ratio, no_unit, from(0).below(0.5), "Poisson's ratio."),
         number<Rock>("cohesion_MPa", in_optional<&Rock::strength, &RockStrength::cohesion>, MPa, strength,
                      "Cohesion.")
             .together("strength"),
         number<Rock>("friction_angle_deg", in_optional<&Rock::strength, &RockStrength::friction_angle>,
                      degrees, friction, "Friction angle.")
             .together("strength"),
         number<Rock>("tensile_strength_MPa", in_optional<&Rock::strength, &RockStrength::tensile_strength>,
                      MPa, strength, "Tensile strength, a positive number.")
             .together("strength"),
         number("dilation_angle_deg", &Rock::dilation_angle, degrees, friction,
                "Dilation angle of rock bridges and of rock that yields, at most the friction angle.")
             .or_else(std::int64_t{0}),
         choice("law", &Rock::law, {{"elastic", RockLaw::elastic}, {"Mohr-Coulomb", RockLaw::mohr_coulomb}},
                "elastic; or Mohr-Coulomb: it yields where its strength is reached, in shear and in "
                "tension, without softening. That needs the strength, and excludes creep of the "
                "rock.")
             .or_else(std::string("elastic")),
         number<Rock>("kelvin_shear_modulus_GPa", in_optional<&Rock::kelvin, &ShearKelvin::modulus>, GPa,
                      above(0).to(1e6), "Kelvin spring, in shear.")
             .together("Kelvin"),
         number<Rock>("kelvin_shear_viscosity_GPa_day", in_optional<&Rock::kelvin, &ShearKelvin::viscosity>,
                      GPa_day, viscosity, "Kelvin dashpot, in shear.")
             .together("Kelvin"),
         number("maxwell_shear_viscosity_GPa_day", &Rock::maxwell_viscosity, GPa_day, viscosity,
                "Maxwell dashpot, in shear: it creeps without end.")
             .optional()}};
}

Table<Region> region()
{
    return {
        {"region", in_list, optional,
         "A part of the section made of another rock. Later ones cover earlier ones."},
        {text("rock", &Region::rock, "Name of its rock."),
         polygon("outline_m", &Region::outline, "Its outline. The part outside the section is cut off.")}};
}

Table<InSituStress::Level> stress_profile()
{
    using L = InSituStress::Level;
    return {{"in_situ_stress.profile", inside, optional,
             "The stress at a depth. Levels are in order of depth, two at least. Between them the stress is "
             "linear; above the first one and below the last one it is extrapolated linearly.",
             once},
            {number("depth_m", &L::depth, metres, from(0).to(farthest_metre), "Depth."),
             number("compression_xx_MPa", &L::compression_xx, MPa, stresses, "Horizontal compression there."),
             number("compression_yy_MPa", &L::compression_yy, MPa, stresses, "Vertical compression there."),
             number("shear_xy_MPa", &L::shear_xy, MPa, stresses, "Shear stress there.")}};
}

std::vector<InSituStress::Level> read_profile(const Table<InSituStress::Level>& table, const KeyInfo& key,
                                              const TomlValue& value, const Place& outer)
{
    std::vector<InSituStress::Level> levels = read_rows(table, 2, 1000, key, value, outer);
    for (std::size_t i = 1; i < levels.size(); ++i)
        if (!(levels[i].depth > levels[i - 1].depth))
            outer.refuse(key, value, "depth_m increasing from level to level");
    return levels;
}

Table<InSituStress> in_situ_stress(const Table<InSituStress::Level>& profile)
{
    using S = InSituStress;
    const auto levels = [profile](const KeyInfo& key, const TomlValue& value, const Place& place) {
        return read_profile(profile, key, value, place);
    };
    return {
        {"in_situ_stress", once, required,
         "Stress before excavation, by depth: below elevation_m, or vertically below ground_m. Either "
         "linear, compression(depth) = compression + gradient x depth, or by a profile. Compression is "
         "positive here; shear_xy is the stress component sigma_xy itself."},
        {number("elevation_m", &S::elevation, metres, coordinates, "Elevation y where the depth is 0.")
             .optional(),
         polyline("ground_m", &S::ground,
                  "In place of elevation_m: the ground surface, a line across the whole section with x "
                  "increasing from corner to corner, nowhere below the section's top.")
             .optional(),
         number("compression_xx_MPa", &S::compression_xx, MPa, stresses, "Horizontal compression at depth 0.")
             .together("linear"),
         number("compression_yy_MPa", &S::compression_yy, MPa, stresses, "Vertical compression at depth 0.")
             .together("linear"),
         number("shear_xy_MPa", &S::shear_xy, MPa, stresses, "Shear stress at depth 0.").together("linear"),
         number("compression_xx_gradient_MPa_per_m", &S::gradient_xx, MPa_per_m, stress_gradient,
                "Increase per metre of depth.")
             .together("linear"),
         number("compression_yy_gradient_MPa_per_m", &S::gradient_yy, MPa_per_m, stress_gradient,
                "Increase per metre of depth.")
             .together("linear"),
         number("shear_xy_gradient_MPa_per_m", &S::gradient_xy, MPa_per_m, stress_gradient,
                "Increase per metre of depth.")
             .together("linear"),
         number(
             "horizontal_stress_ratio", &S::horizontal_ratio, no_unit, from(0).to(20),
             "In place of the linear law: the vertical compression is the weight of the rock above, density x gravity "
             "x depth, with the density of section.rock, and the horizontal compression is this ratio (K0) times "
             "it.")
             .optional()
             .in_place_of("linear"),
         key_of<S>({"profile", "levels", {}, {}, "Stress at some depths, in place of the linear law."},
                   &S::profile, levels)
             .asks_for(
                 "levels [{ depth_m = 0, compression_xx_MPa = 1, compression_yy_MPa = 0, shear_xy_MPa = 0 }, "
                 "...]")
             .optional()
             .in_place_of("linear")}};
}

// --- Checks ---------------------------------------------------------------------------------------------

void check_rocks(const Scene& scene, const Source& source)
{
    for (std::size_t i = 0; i < scene.rocks.size(); ++i) {
        const Rock& rock = scene.rocks[i];
        if (rock.law == RockLaw::mohr_coulomb && !rock.strength)
            source.in_list("rock", i).refuse("law", "it needs cohesion_MPa, friction_angle_deg and "
                                                    "tensile_strength_MPa beside it");
        if (rock.law == RockLaw::mohr_coulomb && (rock.kelvin || rock.maxwell_viscosity))
            source.in_list("rock", i).refuse("law", "expected \"elastic\" of rock that creeps");
        if (rock.dilation_angle > 0 && !rock.strength)
            source.in_list("rock", i).refuse("dilation_angle_deg",
                                             "it needs cohesion_MPa, friction_angle_deg and "
                                             "tensile_strength_MPa beside it");
        if (rock.dilation_angle > 0 && rock.dilation_angle > rock.strength->friction_angle)
            source.in_list("rock", i).refuse("dilation_angle_deg",
                                             "expected at most friction_angle_deg, beside it");
    }
}

void check_rocks_of_regions(const Scene& scene, const Source& source)
{
    const auto rocks = names_of(scene.rocks);
    for (std::size_t i = 0; i < scene.regions.size(); ++i)
        check_reference(source.in_list("region", i), "rock", scene.regions[i].rock, rocks, "[[rock]]");
}

void check_outlines_of_regions(const Scene& scene, const Source& source)
{
    for (std::size_t i = 0; i < scene.regions.size(); ++i)
        check_polygon(source.in_list("region", i), "outline_m", scene.regions[i].outline);
}

// Both lines are straight between their corners. So the largest height above the ground is at a corner of one of them.
void check_below_ground(const Scene& scene, const Given& given)
{
    const double tolerance = outline_tolerance(scene.outline);
    const auto& in_situ = scene.in_situ_stress;
    double highest = tolerance, at = 0;
    const auto look = [&](const Eigen::Vector2d& place) {
        if (const double above = -in_situ.depth_of(place); above > highest) {
            highest = above;
            at = place.x();
        }
    };
    const Polygon& outline = scene.outline;
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const Eigen::Vector2d &from = outline[i], &to = outline[(i + 1) % outline.size()];
        look(from);
        for (const Eigen::Vector2d& corner : in_situ.ground)
            if (std::min(from.x(), to.x()) < corner.x() && corner.x() < std::max(from.x(), to.x()))
                look(from + (to - from) * ((corner.x() - from.x()) / (to.x() - from.x())));
    }
    if (highest > tolerance)
        given.refuse("ground_m", "the section's outline is " + shown(highest) +
                                     " m above it at x = " + shown(at) +
                                     " m; expected the ground as it is before any excavation, "
                                     "nowhere below the section's top");
}

void check_in_situ_stress(const Scene& scene, const Source& source)
{
    const Given given = source.once("in_situ_stress");
    const auto& ground = scene.in_situ_stress.ground;
    if (given.find("ground_m") && given.find("elevation_m"))
        given.refuse("ground_m", "expected either it or elevation_m, not both");
    if (!given.find("ground_m") && !given.find("elevation_m"))
        given.refuse("elevation_m", "expected it, or ground_m");
    if (!given.find("profile") && !given.find("compression_xx_MPa") && !given.find("horizontal_stress_ratio"))
        given.refuse("compression_xx_MPa", "expected the keys of a linear law (compression_xx_MPa, ...), a "
                                           "horizontal_stress_ratio, or a profile");
    if (given.find("profile") && given.find("horizontal_stress_ratio"))
        given.refuse("horizontal_stress_ratio", "expected either it or profile, not both");
    if (ground.empty())
        return;
    const double tolerance = outline_tolerance(scene.outline);
    const auto [left, right] =
        std::minmax_element(scene.outline.begin(), scene.outline.end(),
                            [](const auto& one, const auto& other) { return one.x() < other.x(); });
    if (ground.front().x() > left->x() + tolerance || ground.back().x() < right->x() - tolerance)
        given.refuse("ground_m", "expected a line across the whole section, from x = " + shown(left->x()) +
                                     " to " + shown(right->x()) + " m");
    check_below_ground(scene, given);
}

} // namespace

ForceKeys<Scene> scene_keys()
{
    auto rocks = part_in_list(rock(), &Scene::rocks);
    rocks.has_names = true;
    rocks.values = check_rocks;
    auto regions = part_in_list(region(), &Scene::regions);
    regions.references = check_rocks_of_regions;
    regions.shapes = check_outlines_of_regions;
    const Table<InSituStress::Level> profile = stress_profile();
    const auto read_stress = [table = in_situ_stress(profile)](const TomlValue& root, Reading& reading,
                                                               Scene& scene) {
        InSituStress& stress = scene.in_situ_stress;
        read_once(table, root, reading, stress);
        for (const Rock& rock : scene.rocks)
            if (stress.horizontal_ratio && rock.name == scene.rock) {
                stress.gradient_yy = rock.density * scene.gravity;
                stress.gradient_xx = *stress.horizontal_ratio * stress.gradient_yy;
            }
    };
    auto stress = part_read_by<Scene>(in_situ_stress(profile), read_stress);
    stress.values = check_in_situ_stress;
    return {.materials = {rocks, regions}, .loads = {stress, part_inside<Scene>(profile)}};
}

} // namespace jointcreep::rock
