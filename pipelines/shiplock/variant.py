#!/usr/bin/python3
"""A variant of a scene of the shiplock: the same text but for what the options change.

    variant.py SCENE.toml --stress high --spacing-times 2 -o NAME.toml

Comments, order and every other value stay those of the scene.
"""

import argparse
import datetime
import json
import math
import re
import tomllib

import numpy as np

from scene_text import NotWanted, write_variant

WIDTH = 118  # of a line of the scene, in characters
DECAY = 20  # of the tectonic stress towards the surface [m]
STRESSES = {"low": (2.0, 0.020), "mid": (3.0, 0.022), "high": (5.0, 0.025)}  # a [MPa], b [MPa/m]
BY_ROCK = {"fresh": (1400.0, 168000.0), "weathered": (480.0, 57600.0)}  # E [MPa], eta [MPa day]: Table 2 by rock
YOUNGS_MODULI = {"fresh": (20, 40), "weak": (12, 17)}  # Table 1's ranges [GPa]
LINEAR = 1e4  # a strength that no joint reaches [MPa]
SPRINGS = ("normal_stiffness_MPa_per_m", "shear_stiffness_MPa_per_m")
KELVIN = ("normal_kelvin_stiffness_MPa_per_m", "normal_kelvin_viscosity_MPa_day_per_m",
          "shear_kelvin_stiffness_MPa_per_m", "shear_kelvin_viscosity_MPa_day_per_m")
STRENGTHS = ("cohesion_MPa", "tensile_strength_MPa")
PLACES = ("outline_m", "region_m", "ground_m", "from_m", "to_m", "remove_m", "at_m", "fine_m")
UPDATED = """
[large_displacements]
new_contacts = "fresh, k 0.2"                  # assumed: the middle one
release_s = 0.25                               # assumed: slow enough that little slips in the overshoot
stiffness_damping_s = 1e-6                     # assumed: so small that steps are not shorter for it
mass_damping_per_s = 15                        # assumed: about that of the slowest vibration of a small section
"""
# Chamber 3, the candidate for section B-B, by the elevations of chamber 2: floor, wall top, and 20 m less above.
CHAMBER_3 = ((112, 92.2), (160, 139), (170, 150), (1000, 980))


# --- A scene's text, with some values changed -----------------------------------------------------------------------------


def shown(value):
    """A value as TOML."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, (int, float)):
        return f"{value:.12g}"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, datetime.date):
        return value.isoformat()
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {shown(one)}" for key, one in value.items()) + " }"
    return "[" + ", ".join(map(shown, value)) + "]"


def line_of(key, value, comment):
    """`key = value  # comment`; a list too long for a line has several lines."""
    line = f"{key} = {shown(value)}"
    if len(line) + 2 + len(comment) <= WIDTH or not isinstance(value, list):
        return f"{line:<46} {comment}".rstrip()
    nested = key == "remove_m"  # a list of polygons, of which a stage has one
    items = value[0] if nested and len(value) == 1 else value
    lines, row = [], "   "
    for item in items:
        text = f" {shown(item)},"
        if len(row) + len(text) > WIDTH or (isinstance(item, dict) and row.strip()):
            lines.append(row)
            row = "   "
        row += text
    opening, closing = ("[[", "]]") if items is not value else ("[", "]")
    return "\n".join([f"{f'{key} = {opening}':<46} {comment}".rstrip(), *lines, row, closing])


def edited(text, change):
    """The text with change(table, record, key, value) in place of every value; None leaves it."""
    lines, out, at = text.split("\n"), [], 0
    counts, table, record = {}, "", {}
    scene = tomllib.loads(text)
    while at < len(lines):
        line = lines[at]
        header = re.fullmatch(r"\[(\[?)([a-z_]+)\]\]?\s*(#.*)?", line)
        if header:
            table = header[2]
            if header[1]:
                record = scene[table][counts.get(table, 0)]
                counts[table] = counts.get(table, 0) + 1
            else:
                record = scene[table]
        entry = re.match(r"([a-z_A-Z0-9]+) = ", line)
        if not entry:
            out.append(line)
            at += 1
            continue
        end = at + 1
        while True:
            written = "\n".join(lines[at:end])
            try:
                value = tomllib.loads(written)[entry[1]]
                break
            except tomllib.TOMLDecodeError:
                if end == len(lines):
                    raise
                end += 1
        new = change(table, record, entry[1], value)
        comment = re.search(r"#.*$", line)
        out.append(written if new is None or new == value else line_of(entry[1], new, comment[0] if comment else ""))
        at = end
    return "\n".join(out)


# --- The changes -------------------------------------------------------------------------------------------------------------


def horizontal_stress(depth, a, b, decay):
    """sigma_x = a (1 - exp(-h / decay)) + b h [MPa]."""
    return a * (1 - math.exp(-depth / decay)) + b * depth


def stress_profile(levels, a, b, decay=DECAY):
    """The horizontal stress at the levels of the scene, all else as there."""
    return [{**level, "compression_xx_MPa": round(horizontal_stress(level["depth_m"], a, b, decay), 4)} for level in levels]


def stress(which):
    if which in STRESSES:
        a, b, decay = *STRESSES[which], DECAY
    else:
        try:
            a, b, decay = map(float, which.split(","))
        except ValueError:
            raise NotWanted(f"--stress {which}: expected low, mid, high or A,B,DECAY") from None

    def change(table, _, key, value):
        return stress_profile(value, a, b, decay) if (table, key) == ("in_situ_stress", "profile") else None

    return change


def spacing(times):
    def change(table, _, key, value):
        if (table, key) == ("joint_set", "spacing"):
            return {**value, "mean_m": value["mean_m"] * times}

    return change


def stiffness(times):
    """K, E and eta alike, so that creep keeps its share and its time."""
    def change(table, _, key, value):
        return value * times if table == "joint_material" and key in SPRINGS + KELVIN else None

    return change


def kelvin(times):
    """E and eta alike: the share of creep, in the same time."""
    def change(table, _, key, value):
        return value * times if table == "joint_material" and key in KELVIN else None

    return change


def persistence_of(material):
    found = re.search(r", k ([0-9.]+)$", material["name"])
    if not found:
        raise NotWanted(f"the joint material {material['name']} does not say its persistence: NAME, k 0.25")
    return float(found[1])


def rule(name):
    """K / k, as in the scene; K itself; or K / k beside rock bridges, for which the material has K itself."""
    def change(table, record, key, value):
        if name != "K/k" and table == "joint_material" and key in SPRINGS + KELVIN:
            return value * persistence_of(record)
        if name == "bridges" and (table, key) == ("averaging", "stiffness"):
            return "lower bound"

    return change


def realized(path):
    """K / k with the persistence of a network, whose file it is, in place of the sets' own: the length of its traces over that of their
    lines, of all sets with the same k."""
    import h5py
    with h5py.File(path) as file:
        set_of, start, end = (file[f"/joints/{name}"][:] for name in ("set", "from", "to"))
        line, first, last = (file[f"/traces/{name}"][:] for name in ("joint", "from", "to"))
        names = [name.decode() for name in file["/names/joint_set"][:]]
        sets = {one["name"]: one["persistence"] for one in tomllib.loads(file["/scene"][0].decode())["joint_set"]}
    k = np.array([sets[name] for name in names])[set_of]  # of each line
    lines, traces = np.linalg.norm(end - start, axis=1), np.linalg.norm(last - first, axis=1)
    found = {one: traces[k[line] == one].sum() / lines[k == one].sum() for one in set(k)}

    def change(table, record, key, value):
        if table == "joint_material" and key in SPRINGS + KELVIN:
            return value * persistence_of(record) / found[persistence_of(record)]

    return change


def table_2(reading):
    """As printed: normal 480, tangential 1400. By rock: fresh 1400, weathered 480, in both directions."""
    def change(table, record, key, value):
        if reading == "by rock" and table == "joint_material" and key in KELVIN:
            return BY_ROCK[record["name"].split(",")[0]]["viscosity" in key] / persistence_of(record)

    return change


def line_at(corners, x):
    for (x0, y0), (x1, y1) in zip(corners, corners[1:]):
        if x0 <= x <= x1:
            return y0 + (y1 - y0) * (x - x0) / (x1 - x0)
    raise NotWanted(f"x = {x} m is outside the section")


def box(scene, half, bottom):
    """Joints in |x| < half, y > bottom, up to the ground."""
    ground = scene["in_situ_stress"]["ground_m"]
    ends = {x: [x, round(line_at(ground, x), 3)] for x in (-half, half)}
    top = [ends[half], *[corner for corner in reversed(ground) if -half < corner[0] < half], ends[-half]]

    def change(table, _, key, __):
        return [[-half, bottom], [half, bottom], *top] if (table, key) == ("joint_set", "region_m") else None

    return change


def domain(scene, half, bottom):
    """Sides and base of the section elsewhere; the ground is level there."""
    left = min(x for x, _ in scene["section"]["outline_m"])
    lowest = min(y for _, y in scene["section"]["outline_m"])

    def moved(value):
        if isinstance(value[0], list):
            corners = [moved(one) for one in value]
            return [one for one, before in zip(corners, [None, *corners]) if one != before]
        return [math.copysign(half, value[0]) if abs(value[0]) == -left else value[0],
                bottom if value[1] == lowest else value[1]]

    def change(_, __, key, value):
        return moved(value) if key in PLACES else None

    return change


def setting(of_table, of_key):
    """Gives one key of the scene another value."""
    def make(value):
        def change(table, _, key, __):
            return value if (table, key) == (of_table, of_key) else None

        return change

    return make


def first_reading(days):
    def change(table, _, key, value):
        return value + datetime.timedelta(days) if (table, key) == ("point", "first_reading") else None

    return change


def loads(times):
    """Weight, stress and strengths alike: at small displacements everything moves as many times as far."""
    def change(table, _, key, value):
        if (table, key) == ("section", "gravity_m_per_s2") or key in STRENGTHS:
            return value * times
        if (table, key) == ("in_situ_stress", "profile"):
            return [{name: one * (1 if name == "depth_m" else times) for name, one in level.items()} for level in value]

    return change


def linear(_):
    """Joints that neither slip nor open."""
    def change(table, _, key, __):
        if table in ("joint_material", "rock") and key in STRENGTHS:
            return LINEAR

    return change


# Name, ends on the north side, points, first reading: that of the point at its head. Assumed, as the paper has none.
LINES = [("inclinometer", [140, 231], [140, 111], 25, "1995-07-31"), ("extensometer", [66.5, 145], [96.5, 145], 16, "1997-10-31")]


def monitoring_lines():
    """Tables [[monitoring_line]] of both sides."""
    return "".join(
        f'\n[[monitoring_line]]\nname = "{name} {side}"\nfrom_m = [{sign * x0:g}, {y0:g}]\nto_m = [{sign * x1:g}, {y1:g}]\n'
        f"points = {points}\nfirst_reading = {date}\n"
        for name, (x0, y0), (x1, y1), points, date in LINES for side, sign in (("N", 1), ("S", -1)))


def youngs_modulus(which):
    """The ends of Table 1's ranges."""
    def change(table, record, key, _):
        if (table, key) == ("rock", "youngs_modulus_GPa") and record["name"] in YOUNGS_MODULI:
            return YOUNGS_MODULI[record["name"]][which == "high"]

    return change


def in_section_b(y):
    """The elevation in section B-B of what is at y in section A-A."""
    for (y0, new0), (y1, new1) in zip(CHAMBER_3, CHAMBER_3[1:]):
        if y0 <= y <= y1:
            return round(new0 + (new1 - new0) * (y - y0) / (y1 - y0), 3)
    return round(y - CHAMBER_3[0][0] + CHAMBER_3[0][1], 3)


def named_in_section_b(name):
    """The name of a point or stage, which ends with its elevation."""
    return re.sub(r"\d+$", lambda y: f"{in_section_b(float(y[0])):.0f}", name)


def section_b(scene):
    """Chamber 3 in place of chamber 2: the same section with its elevations moved."""
    lowest = min(y for _, y in scene["section"]["outline_m"])

    def moved(value):
        if isinstance(value[0], list):
            return [moved(one) for one in value]
        return [value[0], value[1] if value[1] == lowest else in_section_b(value[1])]

    def change(table, _, key, value):
        if key in PLACES:
            return moved(value)
        if table in ("point", "stage") and key == "name":
            return named_in_section_b(value)
        if key == "title":
            return value.replace("section A-A", "section B-B (chamber 3)")

    return change


# --- What is asked for ------------------------------------------------------------------------------------------------------


def changes_of(arguments, scene):
    """The changes that the command line asks for, in its order of meaning."""
    given = vars(arguments)
    for name, make in (("section_b", lambda _: section_b(scene)), ("stress", stress), ("spacing_times", spacing),
                       ("rule", rule), ("realized", realized), ("table_2", table_2), ("stiffness_times", stiffness),
                       ("kelvin_times", kelvin), ("youngs_modulus", youngs_modulus),
                       ("box", lambda of: box(scene, *of)), ("domain", lambda of: domain(scene, *of)),
                       ("zone_size", setting("zones", "size_m")), ("first_reading_days", first_reading), ("loads_times", loads),
                       ("creep_step", setting("creep", "step_days")), ("end", setting("schedule", "end")), ("linear", linear)):
        if given[name] not in (None, False):
            yield make(given[name])


def variant(text, arguments):
    for change in list(changes_of(arguments, tomllib.loads(text))):
        text = edited(text, change)
    if arguments.no_creep:
        text = re.sub(r"^\[creep\]\n(?:[a-z].*\n)*", "", text, flags=re.MULTILINE)
    if arguments.cutting:
        edge, angle = arguments.cutting
        text = re.sub(r"^shortest_edge_m = .*", f"shortest_edge_m = {edge:g}\nsmallest_angle_deg = {angle:g}", text, flags=re.MULTILINE)
    if arguments.large_displacements:
        text += UPDATED
    if arguments.monitoring_lines:
        text += monitoring_lines()
    if arguments.section_b:
        text = ("# Section B-B (chamber 3): the scene of section A-A, below, with its elevations moved. What comments say of places\n"
                "# and sources is section A-A's.\n#\n" + text)
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--section-b", action="store_true", help="chamber 3, the candidate for section B-B")
    parser.add_argument("--stress", metavar="NAME", help="low, mid, high; or A,B,DECAY in MPa, MPa/m and m")
    parser.add_argument("--spacing-times", type=float, metavar="FACTOR", help="of all sets")
    parser.add_argument("--rule", choices=["K/k", "K", "bridges"], help="joint stiffness: bridges is K/k beside them")
    parser.add_argument("--realized", metavar="NETWORK.h5", help="joint stiffness K/k with the persistence of this network")
    parser.add_argument("--table-2", choices=["as printed", "by rock"], help="reading of the Kelvin constants")
    parser.add_argument("--stiffness-times", type=float, metavar="FACTOR", help="K, E and eta of all joints")
    parser.add_argument("--kelvin-times", type=float, metavar="FACTOR", help="E and eta of all joints")
    parser.add_argument("--youngs-modulus", choices=["low", "high"], help="ends of Table 1's ranges")
    parser.add_argument("--box", type=float, nargs=2, metavar=("HALF", "BOTTOM"), help="where joints are, in m")
    parser.add_argument("--domain", type=float, nargs=2, metavar=("HALF", "BOTTOM"), help="sides and base, in m")
    parser.add_argument("--zone-size", type=float, metavar="M", help="at the faces that are dug")
    parser.add_argument("--first-reading-days", type=int, metavar="DAYS", help="later than in the scene")
    parser.add_argument("--loads-times", type=float, metavar="FACTOR", help="weight, stress and strengths")
    parser.add_argument("--creep-step", type=float, metavar="DAYS", help="largest creep step")
    parser.add_argument("--end", type=datetime.date.fromisoformat, metavar="DATE", help="of the computation, such as 1999-12-31")
    parser.add_argument("--cutting", type=float, nargs=2, metavar=("EDGE", "ANGLE"), help="shortest edge in m, smallest angle in degrees")
    parser.add_argument("--large-displacements", action="store_true", help="geometry updated: [large_displacements]")
    parser.add_argument("--linear", action="store_true", help="joints that neither slip nor open")
    parser.add_argument("--monitoring-lines", action="store_true", help="inclinometers behind the crests, extensometers behind the walls")
    parser.add_argument("--no-creep", action="store_true", help="without the table [creep]")
    write_variant(parser, variant)


if __name__ == "__main__":
    main()
