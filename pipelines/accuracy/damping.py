#!/usr/bin/python3
"""What each way to equilibrium costs: steps of dynamic relaxation by each kind of damping, and the implicit engine.

    damping.py BIN DATA OUT

runs demsolve of the folder BIN on the bench slope and the paper's column of the folder DATA, with 2e4 and 2e5 zones,
and writes OUT/damping.csv, OUT/tables/damping.md and OUT/tables/damping-slip.md. Loads are put on at once: the weight
of rock without any stress in situ, and rock excavated under the in-situ stress (the first bench, the first block), both
on joints that hold whatever comes, so that all is linear; and the bench with the scene's joints, which slip and open.
There the displacements of the points by the bench are compared with those of the implicit engine.

Seconds are processor time of one thread, less that of a run that differs by the load alone.
"""

import csv
import re
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import cases
import figure
from jointcreep import chain
from scaling import measured
from speed_against_error import number, table

SIZES = {"slope": {"2e4": 1.6, "2e5": 0.45}, "column": {"2e4": 0.3, "2e5": 0.1}}  # of zones [m]
TOLERANCE = 1e-5
MOST_STEPS = 30000
IMPLICIT = ("implicit engine", "")
BEST = [("adaptive", "scaled"), ("kinetic", "scaled"), ("kinetic", "real"), IMPLICIT]  # with 2e5 zones, too
WAYS = [*((damping, masses) for masses in ("scaled", "real")
          for damping in ("adaptive", "kinetic", "local", "combined")), ("mass", "real"), IMPLICIT]
MASS_DAMPING = 140  # of the column, its scene's [1/s]


@dataclass
class Load:
    name: str
    text: str  # the scene with it
    without: str  # and without
    is_all: bool  # there is no load at all without it


def with_equilibrium(text, damping, masses):
    settings = f'tolerance = {TOLERANCE}\nmost_steps = {MOST_STEPS}\n'
    settings += (f'engine = "relaxation"\ndamping = "{damping}"\nmasses = "{masses}"\n' if masses
                 else 'engine = "implicit"\n')
    if damping == "mass":
        settings += f"mass_damping_per_s = {MASS_DAMPING}\n"
    text = text.replace("\n[zones]\n", '\n[zones]\nkind = "constant strain"\n')  # by default only for dynamic relaxation
    return f"{cases.with_default_equilibrium(text)}\n[equilibrium]\n{settings}"


def without_stages(text, but=0):
    """The scene without stages, but for so many at the beginning, and without creep."""
    stages = re.findall(r"(?ms)^\[\[stage\]\].*?(?=^\[|\Z)", text)
    for stage in stages[but:]:
        text = text.replace(stage, "")
    return re.sub(r"(?ms)^\[creep\].*?(?=^\[|\Z)", "", text)


def loads_of(name, text):
    stress = {("", f"{part}_{unit}"): 0 for part in ("compression_xx", "compression_yy", "shear_xy")
              for unit in ("MPa", "gradient_MPa_per_m")}
    materials = re.findall(r'(?m)^\[\[joint_material\]\]\nname = "([^"]*)"', text)
    strong = cases.edited(text, {(material, f"{strength}_MPa"): 1000 for material in materials
                                 for strength in ("cohesion", "tensile_strength")})
    weight = cases.edited(without_stages(strong), stress)
    yield Load("gravity", weight, cases.edited(weight, {("", "gravity_m_per_s2"): 0}), True)
    yield Load("unloading", without_stages(strong, but=1), without_stages(strong), False)
    if name == "slope":
        yield Load("unloading with slip", without_stages(text, but=1), without_stages(text), False)


def solve(text, way, size, programs, scratch):
    """Seconds and the result's file; nothing where no equilibrium was found."""
    joints, result = chain.joints_of(programs, with_equilibrium(text, *way), scratch), scratch / "result.h5"
    try:
        return measured([programs / "demsolve", joints, "-q", "--zone-size", size, "-o", result])[0], result
    except SystemExit as given_up:
        if "exit code 3" not in str(given_up):
            raise
        return None, None


def row_of(section, zones_about, load, way, size, programs, scratch):
    row = {"section": section, "zones_about": zones_about, "load": load.name, "damping": way[0], "masses": way[1]}
    seconds, result = solve(load.text, way, size, programs, scratch)
    if not result:
        return row
    with figure.opened(result) as file:
        row |= {name: int(figure.array(file, f"/equilibria/{name}")[-1])
                for name in ("steps", "factorisations", "solves")}
        row |= {"zones": len(figure.array(file, "/mesh/zone_block")),
                "moved": figure.array(file, "/history/displacement")[-1]}
    # Without any load the implicit engine factorises all the same, and dynamic relaxation does not begin.
    without, _ = solve(load.without, BEST[0] if load.is_all else way, size, programs, scratch)
    return row | {"seconds": seconds - without}


def cell(row, found="steps"):
    if "steps" not in row:
        return f"more than {MOST_STEPS}"
    return f"{row[found]} ({number(row['seconds'], '.2g')})"


def write(rows, out):
    found = {(row["section"], row["zones_about"], row["load"], row["damping"], row["masses"]): row for row in rows}
    slip = [row for row in rows if "slip" in row["load"]]
    for row in slip:
        exact = found[row["section"], row["zones_about"], row["load"], *IMPLICIT]["moved"]
        if "moved" in row and row["masses"]:
            row["difference"] = abs(row["moved"] - exact).max() / abs(exact).max()
    names = ["section", "zones_about", "load", "damping", "masses", "zones", "steps", "factorisations", "solves",
             "seconds", "difference"]
    with open(out / "damping.csv", "w", newline="") as file:
        lines = csv.DictWriter(file, names, extrasaction="ignore")
        lines.writeheader()
        lines.writerows(rows)
    columns = [key for key in dict.fromkeys((row["section"], row["zones_about"], row["load"]) for row in rows)
               if "slip" not in key[2]]
    lines = [[damping, masses, *(cell(found[*column, damping, masses], "solves" if not masses else "steps")
                                 if (*column, damping, masses) in found else "" for column in columns)]
             for damping, masses in WAYS]
    head = ["damping", "masses", *(f"{section}, {zones}: {load}" for section, zones, load in columns)]
    (out / "tables/damping.md").write_text("\n".join(table(head, lines)).rstrip() + "\n")
    (out / "tables/damping-slip.md").write_text("\n".join(table(
        ["damping", "masses", "steps (seconds)", "difference to the implicit engine"],
        [[row["damping"], row["masses"], cell(row, "solves" if not row["masses"] else "steps"),
          number(row.get("difference"))] for row in slip])).rstrip() + "\n")


def main():
    if len(sys.argv) != 4:
        sys.exit("usage: damping.py BIN DATA OUT")
    programs, data, out = map(Path, sys.argv[1:])
    (out / "tables").mkdir(parents=True, exist_ok=True)
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for section, sizes in SIZES.items():
            text = (data / section / "scene.toml").read_text()
            for zones_about, size in sizes.items():
                for load in loads_of(section, text):
                    if zones_about == "2e5" and "slip" in load.name:
                        continue
                    for way in WAYS if zones_about == "2e4" else BEST:
                        if section == "slope" and (way[0] == "mass" or zones_about == "2e5" and way[1] == "real"):
                            continue  # too slow by far
                        rows.append(row_of(section, zones_about, load, way, size, programs, Path(folder)))
                        print({key: value for key, value in rows[-1].items() if key != "moved"}, flush=True)
    write(rows, out)


if __name__ == "__main__":
    main()
