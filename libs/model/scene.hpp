// A scene: everything a user says about one section of jointed rock. Read from TOML by libs/scene; every key
// is declared with its unit and range (libs/keys). SI units and the signs of model/signs.hpp; angles in
// radians.

#pragma once

#include "model/polygon.hpp"
#include "model/probability_law.hpp"
#include "model/statistics.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace jointcreep
{

struct RockStrength {
    double cohesion;         // [Pa]
    double friction_angle;   // [rad]
    double tensile_strength; // [Pa]
};

// One Kelvin unit of rock in shear, spring beside dashpot.
struct ShearKelvin {
    double modulus;   // [Pa]
    double viscosity; // [Pa s]
};

enum class RockLaw {
    elastic,
    mohr_coulomb // elastic up to its strength, then perfectly plastic (libs/rock/mohr_coulomb.hpp)
};

// Intact rock, in plane strain. Its strength is that of the rock bridges, and its own where it yields. It
// creeps in shear only: its volume stays elastic.
struct Rock {
    std::string name;
    double density;                       // [kg/m3]
    double youngs_modulus;                // [Pa]
    double poissons_ratio;                // [-]
    std::optional<RockStrength> strength; // needed where a joint set leaves rock bridges
    std::optional<ShearKelvin> kelvin{};
    std::optional<double> maxwell_viscosity{}; // of a dashpot in series, in shear [Pa s]
    double dilation_angle = 0;                 // beside the strength [rad]
    RockLaw law = RockLaw::elastic;
};

// One Kelvin unit, spring beside dashpot, per direction.
struct Kelvin {
    double normal_stiffness; // [Pa/m]
    double normal_viscosity; // [Pa s/m]
    double shear_stiffness;  // [Pa/m]
    double shear_viscosity;  // [Pa s/m]
};

// A dashpot in series, per direction: it creeps without end.
struct Maxwell {
    double normal_viscosity; // [Pa s/m]
    double shear_viscosity;  // [Pa s/m]
};

// The open part of a joint.
struct JointMaterial {
    std::string name;
    double normal_stiffness;          // [Pa/m]
    double shear_stiffness;           // [Pa/m]
    double cohesion;                  // [Pa]
    double friction_angle;            // [rad]
    double tensile_strength;          // [Pa]
    std::vector<Kelvin> kelvin{};     // units in series with the springs; one and a Maxwell: Burgers
    std::optional<Maxwell> maxwell{}; // without either the joint does not creep
    double dilation_angle = 0;        // [rad]
    double dilation_until = 0;        // slip at which dilation ends; 0: it does not [m]
    Index law = 0;                    // into joint::laws() (libs/joint/law.hpp)
    // Parameters of that law alone, by their names, in SI units.
    std::map<std::string, double, std::less<>> own{};
    double strength_divisor = 1; // of all strengths, for a run with strengths divided; no key [-]
};

// What the joints of a set are (libs/sampling/joint_sets.hpp).
enum class SetKind {
    lines,    // lines through the whole section: joint traces and rock bridges alternate along each line
    segments, // traces about Poisson points of the section
    discs     // the traces of Poisson discs in space
};

// A plane measured in the field.
struct MeasuredPole {
    double dip;           // below the horizontal [rad]
    double dip_direction; // clockwise from north [rad]
    double weight;        // among the set's poles, bias of the scanline taken out; > 0 [-]
};

// The direction of a scanline or borehole: by its angle in the section, or by trend and plunge in space.
struct Scanline {
    std::optional<double> angle{}; // counter-clockwise from +x [rad]
    double trend = 0;              // of its lower end, clockwise from north [rad]
    double plunge = 0;             // below the horizontal [rad]
};

// How much of a set there is to be, its joint traces alone.
struct Density {
    enum class Measure {
        p10, // joint traces met by a scanline, per length [1/m]
        p20, // trace midpoints per area of section [1/m2]
        p21, // trace length per area of section [1/m]
        p30, // disc centres per volume [1/m3]
        p32  // joint area per volume [1/m]
    };
    Measure measure = Measure::p21;
    double value = 0;    // in the unit of its measure
    Scanline scanline{}; // of p10
};

// What joints of a set are made of where they run through one of the rocks.
struct MaterialInRock {
    std::string rock;     // name of a Rock
    std::string material; // name of a JointMaterial
};

// Joints sharing their statistics.
struct JointSet {
    std::string name;
    std::string material;                      // name of a JointMaterial: in all rocks but
    std::vector<MaterialInRock> material_in{}; // these
    SetKind kind = SetKind::lines;
    // One of four:
    // Of the trace in the section, counter-clockwise from +x [rad].
    std::optional<ProbabilityLaw> trace_angle{};
    std::optional<ProbabilityLaw> dip{};           // below the horizontal [rad], with
    std::optional<ProbabilityLaw> dip_direction{}; // clockwise from north [rad]
    std::optional<FisherLaw> orientation{};
    std::vector<MeasuredPole> poles{}; // drawn from by weight

    std::optional<Density> density{}; // with lines it sets the mean of `spacing`, which gives the shape alone
    // Of lines, along the set's mean normal in space [m].
    ProbabilityLaw spacing{ProbabilityLaw::Kind::negative_exponential, 1, 1};
    // Of traces [m]; of lines it is needed unless persistence is 0 or 1.
    std::optional<ProbabilityLaw> length{};
    std::optional<ProbabilityLaw> diameter{}; // of discs [m]
    double persistence = 0;                   // of lines: fraction of a line that is joint [-]

    std::vector<std::string> terminates_at{}; // sets, single joints or mapped sets, sampled before this one
    double termination_probability = 1;       // at each crossing of a trace with one of these [-]

    // Where the set exists; without either, the whole section:
    std::optional<Polygon> region{};
    std::vector<std::string> rocks{}; // names of Rocks
};

// One joint or fault given by its ends: all of it joint, no bridges.
struct SingleJoint {
    std::string name;
    std::string material;
    Eigen::Vector2d from, to; // [m]
};

// A joint trace from a map of the section.
struct MappedTrace {
    std::int32_t id;                // as the map says, or its place in the file
    std::vector<Polygon> polylines; // each of two places at least
};

// The traces of one set on a map: all of them joint, each straight piece a joint.
struct MappedSet {
    std::string name;
    std::string material;
    std::vector<MappedTrace> traces{};
};

// A part of the section made of another rock. Later ones cover earlier ones.
struct Region {
    std::string rock;
    Polygon outline;
};

// Stress before excavation as a function of depth: below one elevation, or vertically below a ground surface;
// linear, or straight between the levels of a profile.
struct InSituStress {
    double elevation = 0;                  // where the depth is 0 [m], without `ground`
    std::vector<Eigen::Vector2d> ground{}; // line from left to right across the section [m]

    // Without a profile: stress(depth) = at depth 0 + gradient * depth.
    double compression_xx = 0, compression_yy = 0, shear_xy = 0; // at depth 0 [Pa]; shear_xy is sigma_xy
    double gradient_xx = 0, gradient_yy = 0, gradient_xy = 0;    // per metre of depth [Pa/m]

    // Of the horizontal to the vertical compression, where the scene gives that in place of the gradients: these follow
    // from it and the weight of the rock.
    std::optional<double> horizontal_ratio{};

    struct Level {
        double depth = 0;                                            // [m]
        double compression_xx = 0, compression_yy = 0, shear_xy = 0; // [Pa]
    };
    std::vector<Level> profile{}; // none, or two at least, in order of depth

    // Vertically below the ground, which continues level beyond its ends; or below the elevation [m].
    double depth_of(const Eigen::Vector2d& place) const;
    // {sigma_xx, sigma_yy, sigma_xy}, tension positive [Pa]. Above its first level and below its last one a
    // profile continues in a straight line.
    Eigen::Vector3d at(const Eigen::Vector2d& place) const;

    // Makes sigma_xx a factor times what it is, everywhere.
    void multiply_horizontal(double factor);
};

// A factor that is linear between (time since start [s], factor) pairs, and constant before and after them. Without
// pairs it is 1.
struct LoadHistory {
    std::vector<std::pair<double, double>> points; // in order of time

    double at(double time) const
    {
        if (points.empty())
            return 1;
        const auto after =
            std::find_if(points.begin(), points.end(), [&](const auto& p) { return p.first > time; });
        if (after == points.begin() || after == points.end())
            return after == points.begin() ? points.front().second : points.back().second;
        const auto& [t0, f0] = *(after - 1);
        return f0 + (after->second - f0) * (time - t0) / (after->first - t0);
    }
};

// Boundary condition on the outline from `from` to `to`, a straight piece of it. Elsewhere the outline is free.
struct Boundary {
    Eigen::Vector2d from, to; // [m]
    bool fix_x = false, fix_y = false;
    std::string joint{}; // or: rests on fixed ground through a joint of this material

    // Both times the factor of the load history:
    std::optional<Eigen::Vector2d> traction{};     // total force on the rock per area, {x, y} [Pa]
    std::optional<Eigen::Vector2d> displacement{}; // where fixed: prescribed displacement {x, y} [m]
    LoadHistory load_history{};

    bool fix_normal = false; // or, in place of fix_x and fix_y: free only along the segment
};

// One excavation step.
struct Stage {
    std::string name;
    double time = 0;                  // since start [s]
    std::vector<Polygon> remove;      // the rock inside these is excavated
    bool reset_displacements = false; // from its equilibrium on, displacements are to count from there
};

// A place whose displacement is recorded.
struct MonitoringPoint {
    std::string name;
    Eigen::Vector2d at;       // [m]
    double first_reading = 0; // since start [s]
};

// Monitoring points at equal distances on a line, as on an inclinometer or an extensometer: "NAME 1" at its first end to
// "NAME n" at its other end. They are among the scene's points, behind those given one by one.
struct MonitoringLine {
    std::string name;
    Eigen::Vector2d from, to; // [m]
    Index points = 0;         // at least 2
    double first_reading = 0; // since start [s]
};

// A place on a joint whose traction is recorded in the step history: the nearest contact.
struct Gauge {
    std::string name;
    Eigen::Vector2d at; // [m]
};

// What a creep step takes the force to be during the step (libs/creep/scheme.hpp).
enum class CreepScheme { automatic, published, backward, linear_force, fitted };

struct CreepSettings {
    std::optional<double> step;      // fixed, between dates [s]; or else
    std::optional<double> tolerance; // of the error of one step, by which its length is chosen [m]
    // With a tolerance:
    std::optional<double> first_step;    // the first one tried after every event [s]
    std::optional<double> shortest_step; // [s]
    std::optional<double> longest_step;  // [s]
    CreepScheme scheme = CreepScheme::automatic;
    std::optional<double> stop_rate; // ends creep after the last stage once no point moves faster [m/s]
};

enum class Damping { adaptive, kinetic, local, combined, mass };
enum class Masses { scaled, real };
enum class EngineChoice { automatic, relaxation, implicit };

// How equilibrium is found. Numerical, so it has defaults; they are declared with the keys.
struct Equilibrium {
    EngineChoice engine = EngineChoice::automatic;
    double tolerance = 0; // of the unbalanced force ratio [-]
    Masses masses = Masses::scaled;
    Damping damping = Damping::adaptive;
    double mass_damping = 0;      // alpha of the paper's Eq. 1, with damping "mass" [1/s]
    double stiffness_damping = 0; // beta of zones and of the joints' dashpots, with damping "mass" [s]
    double local_damping = 0;     // with damping "local" or "combined" [-]
    std::int32_t unloading_increments = 1; // increments of excavation, and of loads that change between dates
    std::optional<double>
        increments_tolerance{};  // they are doubled until results change by less than this [-]
    std::int32_t most_steps = 0; // largest number of steps for an equilibrium
    // Rock that has moved farther since the in-situ state fails; no key: analysis::Trial sets it [m].
    double largest_displacement = std::numeric_limits<double>::infinity();
};

// Dynamic analysis with large displacements: Newton's law with real masses, in place of the search for
// equilibrium nearby.
struct LargeDisplacements {
    std::string new_contacts;               // name of the JointMaterial of contacts that form
    std::vector<std::string> rigid_rocks{}; // names of Rocks whose blocks do not deform then
    double stiffness_damping = 0;           // dashpots of zones and closed joints over their springs [s]
    double mass_damping = 0;                // [1/s]
    double release = 0;                     // time in which the forces of a stage's rock go to 0 [s]
    double longest = 0;                     // of one dynamic analysis [s]
    std::optional<double> stop{};           // that of the last stage ends then, at rest or not [s]
    double record_every = 0;                // [s]
    double energy_tolerance = 0.01;         // error of the energy balance, over its largest energy [-]
};

// Over what the joint fraction is taken that strengths and stiffnesses are averaged with.
enum class AverageOver { edge, line, set };

// Springs and Kelvin constants of a joint with rock bridges (libs/joint/bridged.hpp).
enum class StiffnessRule { joint, lower_bound, upper_bound, staggered };

// How joints and rock bridges become equivalent joints.
struct Averaging {
    AverageOver over = AverageOver::edge;
    StiffnessRule stiffness = StiffnessRule::joint;
};

// What is done with a joint that ends inside a block.
enum class DanglingEnds {
    prune, // it is cut back to the last block edge it met
    extend // it is extended to the next one, as rock bridge
};

struct Cutting {
    double shortest_edge = 0;  // vertices closer than this, or than half of it to an edge, are merged [m]
    double smallest_angle = 0; // narrower wedges between edges are closed where that moves nothing far [rad]
    DanglingEnds dangling_ends = DanglingEnds::prune;
};

struct Scene {
    std::string title;

    Polygon outline;
    std::vector<Polygon> holes{};  // inside the outline, where there is no rock from the start
    std::string rock;              // name of the Rock that no region covers
    double gravity = 0;            // downward [m/s2]
    std::optional<double> azimuth; // bearing of +x, clockwise from north [rad]

    std::vector<Rock> rocks;
    std::vector<Region> regions;
    std::vector<JointMaterial> joint_materials;
    std::vector<SingleJoint> joints;
    std::vector<JointSet> joint_sets;
    std::vector<MappedSet> mapped;
    InSituStress in_situ_stress;
    std::vector<Boundary> boundaries;

    double end = 0; // since start [s]
    std::vector<Stage> stages;
    std::vector<MonitoringPoint> points;
    std::vector<MonitoringLine> lines{};
    std::vector<Gauge> gauges;

    std::uint64_t seed = 0; // needed by joint sets only
    std::optional<CreepSettings> creep;
    bool has_rock_that_yields() const;
    std::optional<bool> asks_for_quadratic_zones{};
    // Six gridpoints a zone; else three, and constant strain. If the scene does not say: where rock yields, or where no
    // joint sets and mapped traces divide it into small blocks. Not with large displacements, and not where equilibrium is
    // by dynamic relaxation alone, which overshoots more with them.
    bool zones_are_quadratic() const;
    double zone_size = 0;                // longest zone side aimed at [m]
    std::optional<Polygon> fine_zones{}; // where zones have that size, or else everywhere
    double zone_coarsening = 0;          // distance from there in which the size grows by `zone_size` [m]
    std::optional<double> zone_size_at_faces{}; // and where something is measured; at most `zone_size` [m]
    double smallest_zone_size() const { return zone_size_at_faces.value_or(zone_size); } // aimed at [m]
    Cutting cutting;
    Averaging averaging;
    Equilibrium equilibrium;
    std::optional<LargeDisplacements> large_displacements;
};

} // namespace jointcreep
