// Every table and key of a scene.

#pragma once

#include "scene/keys.hpp"

namespace jointcreep::scene
{

struct Schedule {
    Calendar& calendar; // filled by the first key, and used by all later dates
    double end = 0;     // since start [s]
};

// A law as a scene writes it. Every law has its own keys; the others stay 0.
struct WrittenLaw {
    ProbabilityLaw::Kind kind = ProbabilityLaw::Kind::constant;
    double mean = 0, deviation = 0;
    double half_width = 0;            // of a uniform law of angles
    double shortest = 0, longest = 0; // of a uniform law of lengths, and of a power law
    double exponent = 0;
};

// A law of poles as a scene writes it.
struct WrittenOrientation {
    bool bootstrap = false;
    FisherLaw fisher{};
    std::vector<MeasuredPole> poles{};
    std::string file{}; // of poles
    Scanline scanline{};
    double blind_zone = 0; // [rad]
};

// A density as a scene writes it: one of five measures.
struct WrittenDensity {
    std::optional<double> p10{}, p20{}, p21{}, p30{}, p32{};
    Scanline scanline{};
};

// A mapped set before its file is read.
struct WrittenMapped {
    std::string name, material, file, property, value;
};

// A file that the scene holds.
struct HeldFile {
    std::string name, text;
};

// The tables in the order they are read and documented.
struct SceneTables {
    Table<Scene> top; // keys outside any table
    Table<Scene> section;
    Table<Rock> rock;
    Table<Region> region;
    Table<JointMaterial> joint_material;
    Table<Kelvin> kelvin_chain;        // inside joint_material
    Table<MaterialInRock> material_in; // inside joint_set
    Table<SingleJoint> joint;
    Table<JointSet> joint_set;
    Table<WrittenLaw> trace_angle, dip, dip_direction, spacing, length, diameter; // inside joint_set
    Table<WrittenOrientation> orientation;                                        // inside joint_set
    Table<WrittenDensity> density;                                                // inside joint_set
    Table<WrittenMapped> mapped;
    Table<InSituStress> in_situ_stress;
    Table<InSituStress::Level> profile; // inside in_situ_stress
    Table<Boundary> boundary;
    Table<Schedule> schedule;
    Table<Stage> stage;
    Table<MonitoringPoint> point;
    Table<Gauge> gauge;
    Table<CreepSettings> creep;
    Table<LargeDisplacements> large_displacements;
    Table<Scene> zones;
    Table<Cutting> cutting;
    Table<Averaging> averaging;
    Table<Equilibrium> equilibrium;
    Table<Scene> random;
    Table<HeldFile> file;

    // Calls visit(table) for each, in order.
    template <class Visit>
    void each(Visit visit) const
    {
        visit(top), visit(section), visit(rock), visit(region), visit(joint_material);
        visit(kelvin_chain), visit(joint), visit(joint_set), visit(material_in), visit(trace_angle),
            visit(dip), visit(dip_direction), visit(orientation), visit(spacing), visit(length),
            visit(diameter), visit(density), visit(mapped);
        visit(in_situ_stress), visit(profile), visit(boundary), visit(schedule), visit(stage), visit(point),
            visit(gauge);
        visit(creep), visit(zones), visit(cutting), visit(averaging), visit(equilibrium),
            visit(large_displacements), visit(random), visit(file);
    }
};

const SceneTables& scene_tables();

// The mapped set that a table of the scene, at `place`, stands for, from the file that it names.
MappedSet mapped_set(const WrittenMapped& written, const TomlValue& table, const Place& place);

} // namespace jointcreep::scene
