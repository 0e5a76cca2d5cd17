#!/usr/bin/python3
"""What each way of damping costs: steps of motion to equilibrium on the bench slope, with 9e3 zones.

    damping.py BIN DATA OUT

runs demsolve of the folder BIN on the slope of the folder DATA, and writes OUT/damping.csv and OUT/tables/damping.md.
Two loads are put on at once: the weight of rock without any stress in situ, on joints that hold whatever comes (all is
linear then); and the first bench's rock taken away, with the scene's joints, which slip and open. There the
displacements of the points by the bench are compared with those of the implicit engine.
"""

import csv
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import cases
import figure
from scaling import measured_once
from speed_against_error import number, table

ZONES = 3  # [m]
MOST_STEPS = 50000
WAYS = [(damping, masses) for masses in ("scaled", "real") for damping in ("adaptive", "kinetic", "local", "combined")]


def with_equilibrium(text, settings):
    return re.sub(r"(?ms)^\[equilibrium\].*?(?=^\[|\Z)", "", text) + f"\n[equilibrium]\n{settings}\n"


def without_stages(text, but=0):
    """The scene without stages, but for so many at the beginning, and without creep."""
    stages = re.findall(r"(?ms)^\[\[stage\]\].*?(?=^\[|\Z)", text)
    for stage in stages[but:]:
        text = text.replace(stage, "")
    return re.sub(r"(?ms)^\[creep\].*?(?=^\[|\Z)", "", text)


def loads_of(text):
    """The scenes, and the row of the equilibrium in question."""
    stress = [f"{name}_{unit}" for name in ("compression_xx", "compression_yy", "shear_xy")
              for unit in ("MPa", "gradient_MPa_per_m")]
    strong = {(joint, f"{strength}_MPa"): 1000 for joint in ("joint", "fault") for strength in ("cohesion", "tensile_strength")}
    yield "gravity", cases.edited(without_stages(text), {("", key): 0 for key in stress} | strong), 0
    yield "bench 1 removed", without_stages(text, but=1), 1


def main():
    if len(sys.argv) != 4:
        sys.exit("usage: damping.py BIN DATA OUT")
    programs, data, out = map(Path, sys.argv[1:])
    (out / "tables").mkdir(parents=True, exist_ok=True)
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        scratch = Path(folder)
        scene, network, joints, result = (scratch / name for name in ("scene.toml", "network.h5", "joints.h5",
                                                                      "result.h5"))
        for load, text, row in loads_of((data / "slope/scene.toml").read_text()):
            exact = None
            for damping, masses in [("", "scaled"), *WAYS]:
                settings = f'masses = "{masses}"\nmost_steps = {MOST_STEPS}\n'
                settings += f'engine = "explicit"\ndamping = "{damping}"' if damping else 'engine = "implicit"'
                scene.write_text(with_equilibrium(text, settings))
                subprocess.run([programs / "jointgen", scene, "-q", "-o", network], check=True)
                subprocess.run([programs / "strength-averaging", network, "-q", "-o", joints], check=True)
                try:
                    seconds, _ = measured_once([programs / "demsolve", joints, "-q", "--zone-size", ZONES, "-o", result])
                except SystemExit as given_up:
                    if "exit code 3" not in str(given_up):
                        raise
                    rows.append([load, damping, masses, None, f"more than {MOST_STEPS}", None, None])
                    continue
                with figure.opened(result) as file:
                    steps = int(figure.array(file, "/equilibria/steps")[row])
                    zones = len(figure.array(file, "/mesh/zone_block"))
                    moved = figure.array(file, "/history/displacement")[-1]
                exact = moved if exact is None else exact
                off = abs(moved - exact).max() / abs(exact).max() if row else None
                rows.append([load, damping or "(implicit engine)", masses, zones, steps, seconds, off])
    with open(out / "damping.csv", "w", newline="") as file:
        lines = csv.writer(file)
        lines.writerow(["load", "damping", "masses", "zones", "steps", "seconds", "difference"])
        lines.writerows(rows)
    by_way = {(load, damping, masses): rest for load, damping, masses, *rest in rows}
    one = by_way["bench 1 removed", "adaptive", "scaled"][2]
    lines = []
    for damping, masses in WAYS:
        gravity, bench = (by_way[load, damping, masses] for load in ("gravity", "bench 1 removed"))
        lines.append([damping, masses, gravity[1], bench[1], number(bench[2] and bench[2] / one, ".2f"),
                      number(bench[3])])
    head = ["damping", "masses", "steps: gravity", "steps: bench 1 removed", "time of the latter run",
            "difference to the implicit engine"]
    (out / "tables/damping.md").write_text("\n".join(table(head, lines)[:-1]) + "\n")


if __name__ == "__main__":
    main()
