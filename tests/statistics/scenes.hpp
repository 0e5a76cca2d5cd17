// Small scenes of one joint set each, for tests of what the report says of many realizations.

#pragma once

#include "model/scene.hpp"
#include "model/statistics.hpp"
#include "model/units.hpp"

#include <stdexcept>
#include <string>

namespace jointcreep::statistics
{

using Kind = ProbabilityLaw::Kind;

inline Scene scene_of(const JointSet& set, const Polygon& outline)
{
    Scene scene;
    scene.outline = outline;
    scene.azimuth = 30 * unit::deg;
    scene.joint_materials = {{"clay", 1e8, 1e8, 0, .3, 0, {}}};
    scene.joint_sets = {set};
    return scene;
}

// The row of a quantity, of any subject if this is "".
inline std::size_t row_of(const Statistics& rows, const std::string& subject, const std::string& quantity)
{
    for (std::size_t i = 0; i < rows.quantity.size(); ++i)
        if ((subject.empty() || rows.subject[i] == subject) && rows.quantity[i] == quantity)
            return i;
    throw std::runtime_error("no row " + quantity);
}

inline Polygon box()
{
    return {{10, -20}, {110, -20}, {110, 40}, {10, 40}};
}

inline Polygon slope()
{
    return {{0, 0}, {100, 0}, {100, 30}, {60, 30}, {40, 70}, {0, 70}};
}

struct Example {
    std::string name;
    Scene scene;
};

inline std::vector<Example> examples()
{
    using unit::deg;
    std::vector<Example> all;
    JointSet set;
    set.name = "joints";
    set.material = "clay";

    set.trace_angle = {Kind::normal, 20 * deg, 5 * deg};
    set.spacing = {Kind::negative_exponential, 3, 3};
    set.length = {Kind::lognormal, 6, 4};
    set.persistence = .6;
    all.push_back({"normal angles", scene_of(set, box())});

    set.trace_angle = {Kind::constant, -50 * deg, 0};
    set.spacing = {Kind::lognormal, 3, 1.5};
    set.length = {Kind::negative_exponential, 5, 5};
    set.persistence = .8;
    all.push_back({"parallel", scene_of(set, slope())});

    set.trace_angle = uniform_law(60 * deg, 100 * deg);
    set.spacing = {Kind::constant, 2.5, 0};
    set.length = power_law(2.5, 2, 40);
    set.persistence = .5;
    all.push_back({"uniform angles", scene_of(set, box())});

    set.trace_angle.reset();
    set.orientation = FisherLaw{50 * deg, 60 * deg, 40};
    set.spacing = {Kind::normal, 2, .8};
    set.length.reset();
    set.persistence = 1;
    all.push_back({"Fisher", scene_of(set, slope())});

    set.orientation.reset();
    set.dip = {Kind::normal, 60 * deg, 6 * deg};
    set.dip_direction = uniform_law(190 * deg, 230 * deg);
    set.spacing = power_law(2.5, 1, 30);
    set.length = uniform_law(2, 12);
    set.persistence = .7;
    set.region = Polygon{{-20, 10}, {80, 0}, {90, 100}, {0, 60}};
    all.push_back({"planes in a region", scene_of(set, slope())});
    return all;
}

// Segments, discs, densities and measured poles.
inline std::vector<Example> other_kinds()
{
    using unit::deg;
    using Measure = Density::Measure;
    std::vector<Example> all;
    JointSet set;
    set.name = "joints";
    set.material = "clay";

    set.kind = SetKind::segments;
    set.trace_angle = ProbabilityLaw{Kind::normal, 20 * deg, 15 * deg};
    set.length = ProbabilityLaw{Kind::lognormal, 6, 4};
    set.density = Density{Measure::p21, .25};
    all.push_back({"segments", scene_of(set, slope())});

    set.trace_angle.reset();
    set.orientation = FisherLaw{50 * deg, 60 * deg, 15};
    set.length = power_law(2.5, 2, 40);
    set.density = Density{Measure::p20, .04};
    all.push_back({"segments of Fisher's poles", scene_of(set, box())});

    set.kind = SetKind::discs;
    set.length.reset();
    set.diameter = ProbabilityLaw{Kind::negative_exponential, 8, 8};
    set.density = Density{Measure::p32, .3};
    all.push_back({"discs", scene_of(set, slope())});

    set.kind = SetKind::lines;
    set.diameter.reset();
    set.spacing = {Kind::lognormal, 1, .5};
    set.length = ProbabilityLaw{Kind::lognormal, 6, 4};
    set.persistence = .7;
    set.density = Density{Measure::p21, .25};
    all.push_back({"lines by P21", scene_of(set, box())});

    set.orientation.reset();
    set.poles = {{50 * deg, 60 * deg, 1}, {60 * deg, 70 * deg, 2}, {40 * deg, 30 * deg, 1}};
    all.push_back({"measured poles", scene_of(set, box())});
    return all;
}

} // namespace jointcreep::statistics
