#!/usr/bin/python3
"""The benchmark of the shiplock: five networks as they are cut, in plain files, and scenes of them.

    benchmark.py freeze PROGRAMS SECTION-A.toml FOLDER      writes FOLDER/section.json and network-0.json to network-4.json
    benchmark.py scene FOLDER NUMBER VARIANT -o DIRECTORY   writes DIRECTORY/scene.toml and joints.csv, for jointgen
    benchmark.py reference PROGRAMS FOLDER -o REFERENCE.csv computes the reference: some minutes
    benchmark.py compare HISTORY.csv FOLDER NUMBER VARIANT  a table of another program beside the reference
    benchmark.py table FOLDER VARIANT                       displacements at the end, as on the page

VARIANT is elastic, creep or slip. The page docs/benchmark.md says what is in the files and what the variants are.
"""

import argparse
import csv
import io
import json
import pathlib
import sys
import tempfile
import tomllib

import h5py
import numpy as np

from jointcreep import chain, files
from variant import LINEAR, shown

NETWORKS = 5
VARIANTS = ("elastic", "creep", "slip")
SHORTEST_EDGE = 0.1  # of blocks [m]: below that of the frozen networks, so that nothing is merged again
SMALLEST_ANGLE = 0.1  # [deg], the same
COLUMNS = ("network", "variant", "zone_size_m", "creep_step_days", "increments")
ZONES, STEP = 8, 28  # of the reference [m], [day]
RUNS = [  # of the reference, by these columns; the last five show what smaller zones, steps and increments change
    *((number, "elastic", ZONES, STEP, 1) for number in range(NETWORKS)),
    (0, "creep", ZONES, STEP, 1),
    (0, "slip", ZONES, STEP, 1),
    (0, "elastic", 4, STEP, 1),
    (0, "slip", 4, STEP, 1),
    (0, "creep", 4, STEP, 1),
    (0, "slip", ZONES, STEP // 2, 1),
    (0, "slip", ZONES, STEP, 2),
]
TOLERANCE = {"elastic": 0.005, "creep": 0.005, "slip": 0.02}  # of the largest displacement of a run
MPA, DAY = 1e6, 86400.0
MATERIAL = {  # key: (dataset of /equivalent, its unit in SI)
    "normal_stiffness_MPa_per_m": ("normal_stiffness", MPA),
    "shear_stiffness_MPa_per_m": ("shear_stiffness", MPA),
    "cohesion_MPa": ("cohesion", MPA),
    "friction_angle_deg": ("friction_angle", np.pi / 180),
    "tensile_strength_MPa": ("tensile_strength", MPA),
    "normal_kelvin_stiffness_MPa_per_m": ("normal_kelvin_stiffness", MPA),
    "normal_kelvin_viscosity_MPa_day_per_m": ("normal_kelvin_viscosity", MPA * DAY),
    "shear_kelvin_stiffness_MPa_per_m": ("shear_kelvin_stiffness", MPA),
    "shear_kelvin_viscosity_MPa_day_per_m": ("shear_kelvin_viscosity", MPA * DAY),
}
NOTE = ("Section A-A of the Three Gorges shiplock, reconstructed: places, dates, stresses and joints are largely assumed. "
        "x in m from the middle of the pier to the north, y the elevation in m, days since 1994-06-15. Compression is "
        "positive in keys that say so.")


# --- Freezing ---------------------------------------------------------------------------------------------------------------


def section_of(scene):
    """What all networks share, as plain numbers."""
    start = scene["schedule"]["start"]
    return {
        "note": NOTE,
        "start": start.isoformat(),
        "end_day": (scene["schedule"]["end"] - start).days,
        "gravity_m_per_s2": scene["section"]["gravity_m_per_s2"],
        "outline_m": scene["section"]["outline_m"],
        "rock": scene["section"]["rock"],
        "rocks": [{key: rock[key] for key in ("name", "density_kg_per_m3", "youngs_modulus_GPa", "poissons_ratio")}
                  for rock in scene["rock"]],
        "layers": scene["region"],
        "ground_m": scene["in_situ_stress"]["ground_m"],
        "in_situ_stress": scene["in_situ_stress"]["profile"],
        "boundaries": scene["boundary"],
        "stages": [{"name": one["name"], "day": (one["date"] - start).days, "remove_m": one["remove_m"]}
                   for one in scene["stage"]],
        "points": [{"name": one["name"], "at_m": one["at_m"], "first_reading_day": (one["first_reading"] - start).days}
                   for one in scene["point"]],
        "zones": {**scene["zones"], "size_m": ZONES},
        "creep_step_days": STEP,
    }


def loops_around(is_in, file, places):
    """Outlines, counter-clockwise, of the blocks for which is_in holds. Two that touch in a place are two loops."""
    inside = np.append(is_in, False)  # outside the section, which is -1
    left, right = (inside[file["/edges/block"][:, side]] for side in (0, 1))
    ends = file["/edges/vertex"][:]
    following = {}
    for first, second in np.concatenate([ends[left & ~right], ends[right & ~left][:, ::-1]]).tolist():
        following.setdefault(first, []).append(second)
    left_over = {(first, second): None for first, seconds in following.items() for second in seconds}

    def direction(first, second):
        return np.arctan2(*(places[second] - places[first])[::-1])

    loops = []
    while left_over:
        step, loop = next(iter(left_over)), []
        while step in left_over:
            del left_over[step]
            loop.append(step[0])
            back = direction(step[1], step[0])
            step = step[1], min(following[step[1]], key=lambda one: (back - direction(step[1], one)) % (2 * np.pi))
        x, y = places[loop].T
        if np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) <= 0:
            raise SystemExit("benchmark.py: a layer or stage has a hole; expected none")
        loops.append(loop)
    return loops


def rounded_places(file, section):
    """Positions of the vertices in whole millimetres. On the ground they are not above it."""
    places = file["/vertices/position"][:]
    on_outline = np.unique(file["/edges/vertex"][:][file["/edges/kind"][:] == 0])
    rounded = np.round(places, 3)
    ground = np.array(section["ground_m"], float).T
    for v in on_outline:
        if abs(np.interp(places[v, 0], *ground) - places[v, 1]) < 1e-6:
            rounded[v, 1] = np.floor(np.interp(rounded[v, 0], *ground) * 1000 + 1e-6) / 1000
    return rounded


def polylines(file, places, names, materials):
    """Joints as polylines along block edges, split where the material changes."""
    joint, ends = file["/edges/joint"][:], file["/edges/vertex"][:]
    set_of, start, end = (file[f"/joints/{name}"][:] for name in ("set", "from", "to"))
    where = file["/vertices/position"][:]
    found = []
    for j in np.unique(joint[joint >= 0]):
        edges = np.flatnonzero(joint == j)
        way = np.sum((where[ends[edges]] - start[j]) * (end[j] - start[j]), axis=2)
        chain_of = None
        for i in np.argsort(way.min(axis=1)):
            e = edges[i]
            first, second = ends[e] if way[i, 0] < way[i, 1] else ends[e][::-1]
            if chain_of and chain_of["corners"][-1] == first and chain_of["material"] == materials[e]:
                chain_of["corners"].append(second)
            else:
                chain_of = {"set": names[set_of[j]], "material": materials[e], "corners": [first, second]}
                found.append(chain_of)
    return [{"id": number, "set": one["set"], "material": one["material"], "corners_m": places[one["corners"]].tolist()}
            for number, one in enumerate(found)]


def materials_of(file, names):
    """Names of the materials of the edges (None if there is no joint), and the materials, to six digits."""
    rock_names = files.texts(file, "/names/rock")  # the scene's order: from the strongest to the weakest
    rock = np.append(file["/blocks/rock"][:], -1)[file["/edges/block"][:]].max(axis=1)
    joint, set_of = file["/edges/joint"][:], file["/joints/set"][:]
    values = np.stack([np.ravel(file[f"/equivalent/{name}"][:]) / unit for name, unit in MATERIAL.values()], axis=1)
    found, of_edge = {}, [None] * len(joint)
    for e in np.flatnonzero(joint >= 0):
        name = f"{names[set_of[joint[e]]]} {rock_names[rock[e]]}"
        own = [float(f"{value:.6g}") for value in values[e]]
        if found.setdefault(name, own) != own:
            raise SystemExit(f"benchmark.py: joints of {name} differ: {own}, {found[name]}; expected one material")
        of_edge[e] = name
    return of_edge, [{"name": name, **dict(zip(MATERIAL, own))} for name, own in sorted(found.items())]


def network_of(file, section, number):
    """A cut network as plain numbers."""
    names = files.texts(file, "/names/joint_set")
    places = rounded_places(file, section)
    of_edge, materials = materials_of(file, names)
    rock, stage = file["/blocks/rock"][:], file["/blocks/stage"][:]

    def outlines(is_in):
        return [places[loop].tolist() for loop in loops_around(is_in, file, places)]

    rocks = files.texts(file, "/names/rock")
    return {
        "network": number,
        "joint_materials": materials,
        "outline_m": outlines(np.ones(len(rock), bool))[0],
        "layers": [{"rock": name, "outline_m": outline} for r, name in enumerate(rocks) if name != section["rock"]
                   for outline in outlines(rock == r)],
        "stages": [{"name": name, "remove_m": outlines(stage == s)}
                   for s, name in enumerate(files.texts(file, "/names/stage"))],
        "joints": polylines(file, places, names, of_edge),
    }


def text_of(data):
    """JSON with a line for each entry of each list of the file."""
    parts = []
    for key, value in data.items():
        if isinstance(value, list) and value and isinstance(value[0], dict):
            rows = ",\n".join(json.dumps(one) for one in value)
            parts.append(f"{json.dumps(key)}: [\n{rows}\n]")
        else:
            parts.append(f"{json.dumps(key)}: {json.dumps(value)}")
    return "{\n" + ",\n".join(parts) + "\n}\n"


def freeze(programs, scene, folder, numbers=range(NETWORKS)):
    """Writes the section and the networks into the folder."""
    text = pathlib.Path(scene).read_text(encoding="utf-8")
    section = section_of(tomllib.loads(text))
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    files.write_text(folder / "section.json", text_of(section))
    for number in numbers:
        with tempfile.TemporaryDirectory() as place:
            joints = chain.joints_of(programs, text, place, "--realization", number)
            with h5py.File(joints) as file:
                files.write_text(folder / f"network-{number}.json", text_of(network_of(file, section, number)))


# --- Scenes -----------------------------------------------------------------------------------------------------------------


def read(path):
    return json.loads(pathlib.Path(path).read_text(encoding="utf-8"))


def table(heading, keys):
    return heading + "\n" + "".join(f"{key} = {shown(value)}\n" for key, value in keys.items())


def scene_of(section, network, variant, kind="quadratic", zone_size=None, creep_step=None, increments=1):
    """Text of the scene of a network."""
    def material(one):
        kept = {key: value for key, value in one.items() if variant != "elastic" or "kelvin" not in key}
        return {**kept, **({"cohesion_MPa": LINEAR, "tensile_strength_MPa": LINEAR} if variant != "slip" else {})}

    rocks = section["rocks"]
    stages = {one["name"]: one["day"] for one in section["stages"]}
    zones = {"kind": kind, **section["zones"], **({"size_m": zone_size} if zone_size else {})}
    parts = [
        table("[section]", {"outline_m": network["outline_m"], "rock": section["rock"],
                            "gravity_m_per_s2": section["gravity_m_per_s2"]}),
        *(table("[[rock]]", rock) for rock in rocks),
        *(table("[[region]]", layer) for layer in network["layers"]),
        *(table("[[joint_material]]", material(one)) for one in network["joint_materials"]),
        *(table("[[mapped]]", {"name": f"joints {one['name']}", "material": one["name"], "file": "joints.csv",
                               "property": "material", "value": one["name"]}) for one in network["joint_materials"]),
        table("[in_situ_stress]", {"ground_m": section["ground_m"], "profile": section["in_situ_stress"]}),
        *(table("[[boundary]]", one) for one in section["boundaries"]),
        table("[schedule]", {"start": 0, "end": section["end_day"]}),
        *(table("[[stage]]", {"name": one["name"], "date": stages[one["name"]], "remove_m": one["remove_m"]})
          for one in network["stages"]),
        *(table("[[point]]", {"name": one["name"], "at_m": one["at_m"], "first_reading": one["first_reading_day"]})
          for one in section["points"]),
        *([] if variant == "elastic" else
          [table("[creep]", {"step_days": creep_step or section["creep_step_days"]})]),
        table("[zones]", zones),
        table("[cutting]", {"shortest_edge_m": SHORTEST_EDGE, "smallest_angle_deg": SMALLEST_ANGLE}),
        table("[equilibrium]", {"unloading_increments": increments})]
    return "\n".join(parts)


def joints_csv(network):
    """The joints as [[mapped]] reads them."""
    rows = [f"{one['id']},{one['set']},{one['material']},{x},{y}" for one in network["joints"] for x, y in one["corners_m"]]
    return "\n".join(["id,set,material,x_m,y_m", *rows, ""])


def write_scene(folder, number, variant, output, **options):
    """Writes scene.toml and joints.csv into the folder output; the path of the scene."""
    section, network = (read(pathlib.Path(folder) / f"{name}.json") for name in ("section", f"network-{number}"))
    output = pathlib.Path(output)
    output.mkdir(parents=True, exist_ok=True)
    files.write_text(output / "joints.csv", joints_csv(network))
    files.write_text(output / "scene.toml", scene_of(section, network, variant, **options))
    return output / "scene.toml"


# --- Results ----------------------------------------------------------------------------------------------------------------


def run(programs, folder, number, variant, place, **options):
    """Path of the result of a network, made in the folder place."""
    scene, programs = write_scene(folder, number, variant, place, **options), pathlib.Path(programs)
    joints = chain.joints_of(programs, scene, place)
    chain.run(programs / "demsolve", joints, "--quiet", "-o", joints.with_name("result.h5"))
    return joints.with_name("result.h5")


def rows_of(section, run_of, days, events, displacement):
    """Rows of reference.csv: of each stage, after it, and of the last day. run_of: the first columns; displacement [m]."""
    chosen = [row for row, event in enumerate(events) if event] + [len(days) - 1]
    names = [f"{point['name']}_{axis}_mm" for point in section["points"] for axis in "xy"]
    return [{**run_of, "day": f"{days[row]:g}", "event": events[row] or "end",
             **dict(zip(names, (f"{1e3 * value:.4f}" for value in np.ravel(displacement[row]))))} for row in chosen]


def rows_in(path):
    with open(path, encoding="utf-8") as file:
        return list(csv.DictReader(file))


def reference_of(folder, number, variant, zone_size=ZONES, creep_step=STEP, increments=1):
    """Rows of a run of the reference."""
    wanted = dict(zip(COLUMNS, map(str, (number, variant, zone_size, creep_step, increments))))
    return [row for row in rows_in(pathlib.Path(folder) / "reference.csv")
            if all(row[key] == value for key, value in wanted.items())]


def values_of(rows):
    """Displacements in rows of a table [row, component of a point] [mm]."""
    return np.array([[float(row[key]) for key in rows[0] if key.endswith("_mm")] for row in rows])


def comparison(path, folder, number, variant):
    """What a table of another program says beside the reference: largest difference of each point, and the verdict."""
    wanted = reference_of(folder, number, variant)
    if not wanted:
        raise ValueError(f"the reference has no network {number} of the variant {variant}")
    found = {row["event"]: row for row in rows_in(path)}
    keys = [key for key in wanted[0] if key.endswith("_mm")]
    for row in wanted:
        if row["event"] not in found or any(key not in found[row["event"]] for key in keys):
            raise ValueError(f"{path}: expected a row \"{row['event']}\" with the columns {', '.join(keys)}")
    wanted, found = (values_of([{key: row[key] for key in keys} for row in rows])
                     for rows in (wanted, [found[row["event"]] for row in wanted]))
    difference, largest = np.abs(found - wanted), np.abs(wanted).max()
    lines = [f"{keys[2 * i].removesuffix('_x_mm')}: {difference[:, 2 * i:2 * i + 2].max():.4f} mm" for i in range(len(keys) // 2)]
    share = difference.max() / largest
    return "\n".join([*lines, f"largest: {share:.2g} of {largest:.2f} mm, "
                      f"{'within' if share <= TOLERANCE[variant] else 'beyond'} {TOLERANCE[variant]:g}"])


def table_of(folder, variant):
    """Markdown of the horizontal displacements at the end."""
    runs = {run[0]: reference_of(folder, *run)[-1] for run in RUNS if run[1:] == (variant, ZONES, STEP, 1)}
    names = [key.removesuffix("_x_mm") for key in runs[0] if key.endswith("_x_mm")]
    return "\n".join(["| network | " + " | ".join(names) + " |", "|---" * (len(names) + 1) + "|",
                      *(f"| {n} | " + " | ".join(f"{float(row[name + '_x_mm']):.2f}" for name in names) + " |"
                        for n, row in runs.items())])


def write_reference(programs, folder, output):
    """Computes all runs of the reference, and writes the table."""
    section, rows = read(pathlib.Path(folder) / "section.json"), []
    for number, variant, zone_size, creep_step, increments in RUNS:
        with tempfile.TemporaryDirectory() as place:
            result = run(programs, folder, number, variant, place, zone_size=zone_size, creep_step=creep_step,
                         increments=increments)
            with h5py.File(result) as file:
                rows += rows_of(section, dict(zip(COLUMNS, (number, variant, zone_size, creep_step, increments))),
                                file["/history/time"][:], files.texts(file, "/history/event"), file["/history/displacement"][:])
    text = io.StringIO()
    writer = csv.DictWriter(text, rows[0], lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    files.write_text(output, text.getvalue())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    one = commands.add_parser("freeze")
    for name in ("programs", "scene", "folder"):
        one.add_argument(name)
    one = commands.add_parser("scene")
    one.add_argument("folder")
    one.add_argument("number", type=int)
    one.add_argument("variant", choices=VARIANTS)
    one.add_argument("--kind", choices=["constant strain", "quadratic"], default="quadratic")
    one.add_argument("--zone-size", type=float, metavar="M")
    one.add_argument("--creep-step", type=float, metavar="DAYS")
    one.add_argument("--increments", type=int, default=1, metavar="N")
    one.add_argument("-o", "--output", required=True)
    one = commands.add_parser("compare")
    for name in ("history", "folder"):
        one.add_argument(name)
    one.add_argument("number", type=int)
    one.add_argument("variant", choices=VARIANTS)
    one = commands.add_parser("table")
    one.add_argument("folder")
    one.add_argument("variant", choices=VARIANTS)
    one = commands.add_parser("reference")
    one.add_argument("programs")
    one.add_argument("folder")
    one.add_argument("-o", "--output", required=True)
    arguments = parser.parse_args()
    try:
        if arguments.command == "freeze":
            freeze(arguments.programs, arguments.scene, arguments.folder)
        elif arguments.command == "compare":
            print(comparison(arguments.history, arguments.folder, arguments.number, arguments.variant))
        elif arguments.command == "table":
            print(table_of(arguments.folder, arguments.variant))
        elif arguments.command == "reference":
            write_reference(arguments.programs, arguments.folder, arguments.output)
        else:
            write_scene(arguments.folder, arguments.number, arguments.variant, arguments.output, kind=arguments.kind,
                        zone_size=arguments.zone_size, creep_step=arguments.creep_step, increments=arguments.increments)
    except (OSError, ValueError, chain.Failed) as error:
        print(f"benchmark.py: {error}", file=sys.stderr)
        sys.exit(2)


if __name__ == "__main__":
    main()
