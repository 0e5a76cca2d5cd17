// docs/scene.md and the key list, from the declarations of the keys.

#include "scene/scene.hpp"
#include "scene/scene_keys.hpp"

namespace jointcreep::scene
{
namespace
{

using namespace keys;

constexpr const char* head = R"(# The scene

A scene is one TOML file that describes a section of jointed rock: its outline, rocks, joints, stress,
boundary conditions, stages of excavation, and monitoring points. A scene may name other files in its folder or in
a folder there: measured poles, and mapped traces. The programs read nothing else.

This page is made from the declarations in the files `scene_keys.cpp` of `libs`:
`jointgen --scene-keys-markdown > docs/scene.md`. The same keys as a table for scripts: `jointgen --scene-keys`.

## Rules

* Every key has its unit in its name. A key that the programs do not know is an error, and so is a value of
  another type, one that is not finite, or one outside the range given here. A round bracket excludes its limit:
  [0, 0.5) is from 0 to below 0.5.
* Most keys that describe the ground have no default; the column *needed* shows those that have one. Most numerical settings
  have one.
* The section lies in the plane of x (to the right) and y (up). Angles in it run counter-clockwise from x. Bearings
  run clockwise from north.
* **Signs.** Tension, extension and opening are positive in all programs and files. Keys with compression
  in their name are positive in compression. Strengths are positive numbers.
* If `start` is a TOML date such as `1994-06-15`, all dates are TOML dates. If `start` is a number, all dates are numbers
  on the same scale of days: with `start = 100`, `date = 130` is 30 days after it.
* A polygon lists its corners in order, in either direction. It is not closed: the last corner differs from the
  first.
* A circle can replace a polygon: `{ center_m = [0, 8], radius_m = 4 }`. It has 32 corners on the circle, or `sides = n`.
  A polygon of 32 sides encloses 0.64 percent less than the circle.
* An arc can replace a corner of a polygon or line: `{ through_m = [5, 12], to_m = [10, 8] }`. It begins at the corner
  before it. A full circle has 32 sides; an arc has its part of them, at least 2, or `sides = n`.
* `[table]` occurs once in a scene. `[[table]]` may occur many times: each one describes one joint, one stage, and
  so on.
* A law is written on one line: `spacing = { law = "lognormal", mean_m = 2.5, deviation_m = 1 }`.

## An example

A slope of one rock, 40 m high, that rests on a fixed base. One set of joints dips out of the slope at 55 degrees.
Its joint traces are 6 m long on average and make up 70 percent of each joint line; the rest is rock bridges. The
rock in front of the slope is excavated on 15 June 1994, and a point on the crest is measured from ten days later.

```toml
title = "A slope"

[section]                    # 100 m of ground, 60 m high; x runs towards the east
outline_m = [[0, 0], [100, 0], [100, 60], [0, 60]]
rock = "granite"
gravity_m_per_s2 = 9.81
azimuth_deg = 90

[[rock]]                     # its strength is that of the rock bridges
name = "granite"
density_kg_per_m3 = 2700
youngs_modulus_GPa = 30
poissons_ratio = 0.25
cohesion_MPa = 1.5
friction_angle_deg = 45
tensile_strength_MPa = 1

[[joint_material]]           # without its Kelvin unit this joint would not creep
name = "joint"
normal_stiffness_MPa_per_m = 5000
shear_stiffness_MPa_per_m = 2000
cohesion_MPa = 0.1
friction_angle_deg = 32
tensile_strength_MPa = 0
normal_kelvin_stiffness_MPa_per_m = 20000
normal_kelvin_viscosity_MPa_day_per_m = 1e6
shear_kelvin_stiffness_MPa_per_m = 8000
shear_kelvin_viscosity_MPa_day_per_m = 4e5

[[joint_set]]                # planes that dip 55 degrees towards the east: to the right in the section
name = "J1"
material = "joint"
dip = { law = "normal", mean_deg = 55, deviation_deg = 4 }
dip_direction = { law = "constant", mean_deg = 90 }
spacing = { law = "negative exponential", mean_m = 8 }
length = { law = "lognormal", mean_m = 6, deviation_m = 2 }
persistence = 0.7

[in_situ_stress]             # the rock's own weight, and half of it sideways, from 0 at the surface
elevation_m = 60
compression_xx_MPa = 0
compression_yy_MPa = 0
shear_xy_MPa = 0
compression_xx_gradient_MPa_per_m = 0.0132435
compression_yy_gradient_MPa_per_m = 0.026487
shear_xy_gradient_MPa_per_m = 0

[[boundary]]                 # the sides slide up and down, the base is fixed
from_m = [0, 0]
to_m = [0, 60]
fix = "x"

[[boundary]]
from_m = [100, 0]
to_m = [100, 60]
fix = "x"

[[boundary]]
from_m = [0, 0]
to_m = [100, 0]
fix = "xy"

[schedule]
start = 1994-06-01
end = 1995-06-01

[[stage]]
name = "cut"
date = 1994-06-15
remove_m = [[[60, 20], [100, 20], [100, 60], [40, 60]]]

[[point]]
name = "crest"
at_m = [39, 59]
first_reading = 1994-06-25

[creep]
tolerance_m = 1e-5           # of a time step's error, which chooses the steps

[zones]
size_m = 3

[random]
seed = 1
```

## Keys
)";

// The allowed words of a key stand between bars, which a Markdown table cannot hold.
std::string without_bars(std::string text)
{
    for (auto at = text.find(" | "); at != std::string::npos; at = text.find(" | "))
        text.replace(at, 3, " or ");
    return text;
}

std::string needed(const KeyInfo& key)
{
    if (key.need == Need::required)
        return "yes";
    if (key.need == Need::together)
        return "all " + key.group + " keys or none";
    return key.otherwise.empty() ? "no" : "default " + key.otherwise;
}

std::string needed(const TableInfo& table)
{
    if (table.written == Written::inside || table.name.empty())
        return "";
    const bool required = table.need == Need::required;
    if (table.written == Written::once)
        return required ? " Needed." : " Optional.";
    return required ? " One at least." : " Any number.";
}

std::string heading(const TableInfo& table)
{
    return table.name.empty() ? "Top" : "`" + table.shown() + "`";
}

} // namespace

std::string scene_keys_markdown()
{
    std::string page = head;
    for (const Part<Scene>& table : scene_parts()) {
        page += "\n### " + heading(table.info) + "\n\n" + table.info.doc + needed(table.info) + "\n\n";
        if (table.keys.empty())
            continue;
        page += "| key | kind | range | needed | meaning |\n|---|---|---|---|---|\n";
        for (const KeyInfo& key : table.keys) {
            const auto range = key.range ? shown(*key.range, key.unit) : "";
            page += "| `" + key.name + "` | " + without_bars(key.kind) + " | " + range + " | " + needed(key) +
                    " | " + key.doc + " |\n";
        }
    }
    return page;
}

std::string scene_keys_tsv()
{
    std::string rows = "table\tkey\tkind\tunit\trequired\tminimum\tmaximum\tdefault\n";
    const auto or_none = [](const std::string& text) { return text.empty() ? "-" : text; };
    for (const Part<Scene>& table : scene_parts())
        for (const KeyInfo& key : table.keys) {
            const auto required = key.need == Need::required   ? "yes"
                                  : key.need == Need::optional ? "no"
                                                               : "together";
            rows += or_none(table.info.name) + '\t' + key.name + '\t' + key.kind + '\t' +
                    or_none(std::string(key.unit.symbol)) + '\t' + required + '\t' +
                    (key.range ? lower_bound(*key.range) : "-") + '\t' +
                    (key.range ? upper_bound(*key.range) : "-") + '\t' + or_none(key.otherwise) + '\n';
        }
    return rows;
}

} // namespace jointcreep::scene
