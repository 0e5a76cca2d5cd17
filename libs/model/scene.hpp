// A scene: everything a user says about one section of jointed rock. Read from TOML by libs/scene, where
// every key is declared with its unit and range. SI units and the signs of model/signs.hpp; angles in
// radians.

#pragma once

#include "model/law.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace jointcreep
{

using Polygon = std::vector<Eigen::Vector2d>; // corners in order, either way round, not closed [m]

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

// Intact rock: elastic, plane strain. Its strength is that of the rock bridges. It creeps in shear only: its
// volume stays elastic.
struct Rock {
    std::string name;
    double density;                       // [kg/m3]
    double youngs_modulus;                // [Pa]
    double poissons_ratio;                // [-]
    std::optional<RockStrength> strength; // needed where a joint set leaves rock bridges
    std::optional<ShearKelvin> kelvin{};
    std::optional<double> maxwell_viscosity{}; // of a dashpot in series, in shear [Pa s]
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
};

// Joints sharing their statistics: lines of one orientation law, along each of which joint traces and rock
// bridges alternate.
struct JointSet {
    std::string name;
    std::string material; // name of a JointMaterial
    // One of three:
    std::optional<Law> trace_angle;   // of the trace in the section, counter-clockwise from +x [rad]
    std::optional<Law> dip;           // below the horizontal [rad], with
    std::optional<Law> dip_direction; // clockwise from north [rad]
    std::optional<FisherLaw> orientation;

    Law spacing;                   // along the set's mean normal in space [m]
    std::optional<Law> length;     // of the joint traces [m]; needed unless persistence is 0 or 1
    double persistence = 0;        // fraction of a line that is joint [-]
    std::optional<Polygon> region; // where the set exists; without it, the whole section
};

// One joint or fault given by its ends: all of it joint, no bridges.
struct SingleJoint {
    std::string name;
    std::string material;
    Eigen::Vector2d from, to; // [m]
};

// A part of the section made of another rock. Later ones cover earlier ones.
struct Region {
    std::string rock;
    Polygon outline;
};

// Initial stress, linear in depth below `elevation`: compression(y) = at_elevation + gradient * (elevation -
// y).
struct InSituStress {
    double elevation = 0;                                        // [m]
    double compression_xx = 0, compression_yy = 0, shear_xy = 0; // at `elevation` [Pa]; shear_xy is sigma_xy
    double gradient_xx = 0, gradient_yy = 0, gradient_xy = 0;    // per metre of depth [Pa/m]

    // {sigma_xx, sigma_yy, sigma_xy}, tension positive [Pa].
    Eigen::Vector3d at(const Eigen::Vector2d& place) const
    {
        const double depth = elevation - place.y();
        return {-(compression_xx + gradient_xx * depth), -(compression_yy + gradient_yy * depth),
                shear_xy + gradient_xy * depth};
    }
};

// A factor that goes piecewise straight through (time since start [s], factor) pairs, and stays what it is at
// the ends. Without pairs it is 1.
struct Course {
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

// What holds or moves the outline from `from` to `to`, a straight piece of it. Elsewhere the outline is free.
struct Boundary {
    Eigen::Vector2d from, to; // [m]
    bool fix_x = false, fix_y = false;
    std::string joint{}; // or: rests on fixed ground through a joint of this material

    // On top of the in-situ stress, both times the factor of the course:
    std::optional<Eigen::Vector2d> traction{};     // force on the rock per area, {x, y} [Pa]
    std::optional<Eigen::Vector2d> displacement{}; // where fixed, the displacement it is held at, {x, y} [m]
    Course course{};
};

// One excavation step.
struct Stage {
    std::string name;
    double time = 0;             // since start [s]
    std::vector<Polygon> remove; // the rock inside these leaves
};

// A place whose displacement is recorded.
struct MeasuringPoint {
    std::string name;
    Eigen::Vector2d at;       // [m]
    double first_reading = 0; // since start [s]
};

// A place on a joint whose traction is recorded in the trace: the nearest contact.
struct Gauge {
    std::string name;
    Eigen::Vector2d at; // [m]
};

// What a creep step takes the force to be during the step (libs/creep/scheme.hpp).
enum class CreepScheme { published, backward, linear_force, fitted };

struct Creep {
    std::optional<double> step;      // fixed, between dates [s]; or else
    std::optional<double> tolerance; // of the error of one step, by which its length is chosen [m]
    // With a tolerance:
    std::optional<double> first_step;    // the first one tried after every event [s]
    std::optional<double> shortest_step; // [s]
    std::optional<double> longest_step;  // [s]
    CreepScheme scheme = CreepScheme::fitted;
    std::optional<double> stop_rate; // ends creep after the last stage once no point moves faster [m/s]
};

enum class Damping { adaptive, local, mass };
enum class Masses { scaled, real };
enum class Engine { automatic, explicit_engine, implicit_engine };

// How equilibrium is found. Numerical, so it has defaults; they are declared with the keys.
struct Equilibrium {
    Engine engine = Engine::automatic;
    double tolerance = 0; // of the out-of-balance ratio [-]
    Masses masses = Masses::scaled;
    Damping damping = Damping::adaptive;
    double mass_damping = 0;      // alpha of the paper's Eq. 1, with damping "mass" [1/s]
    double stiffness_damping = 0; // beta of zones and of the joints' dashpots, with damping "mass" [s]
    double local_damping = 0;     // with damping "local" [-]
    std::int32_t unloading_increments =
        1;                       // in which a stage's rock is taken away, and loads change between dates
    std::int32_t most_steps = 0; // without equilibrium after so many, the program gives up
};

// What is done with a joint that ends inside a block.
enum class DeadEnds {
    prune, // it is cut back to the last block edge it met
    extend // it is carried on to the next one, as rock bridge
};

struct Cutting {
    double shortest_edge = 0;  // vertices closer than this, or than half of it to an edge, are merged [m]
    double smallest_angle = 0; // narrower wedges between edges are closed where that moves nothing far [rad]
    DeadEnds dead_ends = DeadEnds::prune;
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
    InSituStress in_situ_stress;
    std::vector<Boundary> boundaries;

    double end = 0; // since start [s]
    std::vector<Stage> stages;
    std::vector<MeasuringPoint> points;
    std::vector<Gauge> gauges;

    std::uint64_t seed = 0; // needed by joint sets only
    std::optional<Creep> creep;
    double zone_size = 0; // longest zone side aimed at [m]
    Cutting cutting;
    Equilibrium equilibrium;
};

} // namespace jointcreep
