#!/usr/bin/python3
"""A stack of rigid blocks by demsolve and by YADE.

    stack.py BIN OUT

Cubes of 1 m on joints, the lowest one on fixed ground, under their weight. The top one is removed, and the others
rise: block i by i times the weight over the joints' stiffness. Both programs have real masses and rigid blocks,
demsolve by [large_displacements] with rigid rock; beside it its two engines of small displacements, where blocks deform, with their
closed form. Writes OUT/stack.csv and OUT/tables/stack.md. On two threads it measures wall time, so it wants an idle
machine.

YADE (Debian's package yade, yade_stack.py) is asked for `ENOUGH` and for at most LIMIT seconds, demsolve for its
convergence criteria, TOLERANCE.
"""

import csv
import json
import math
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import figure
from jointcreep import chain
from scaling import measured
from speed_against_error import number, table

HERE = Path(__file__).resolve().parent
BLOCKS = [4, 16, 64, 256, 1000]
DENSITY, GRAVITY, NORMAL, SHEAR, FRICTION = 2700, 9.81, 5e9, 2e9, 40  # [kg/m3], [m/s2], [Pa/m], [Pa/m], [deg]
YOUNG = 20e9  # of blocks that deform; their Poisson's ratio is 0 [Pa]
TOLERANCE, ENOUGH, LIMIT = 1e-6, 1e-3, 60
SHORTEST = 0.03  # what a difference of two runs can tell [s]
WAYS = {"rigid, dynamic analysis": ("", '[large_displacements]\nnew_contacts = "joint"\nrigid_rocks = ["rock"]\nlongest_s = 1000\n'
                                 "record_every_s = 1000\n"),
        "elastic, dynamic relaxation": ('engine = "relaxation"\n', ""),
        "elastic, implicit engine": ('engine = "implicit"\n', "")}

SCENE = """
title = "A stack of {blocks} blocks"
[section]
outline_m = [[0, 0], [1, 0], [1, {blocks}], [0, {blocks}]]
rock = "rock"
gravity_m_per_s2 = {gravity}
[[rock]]
name = "rock"
density_kg_per_m3 = {density}
youngs_modulus_GPa = {young}
poissons_ratio = 0
[[joint_material]]
name = "joint"
normal_stiffness_MPa_per_m = {normal}
shear_stiffness_MPa_per_m = {shear}
cohesion_MPa = 0
friction_angle_deg = {friction}
tensile_strength_MPa = 0
[[boundary]]
from_m = [0, 0]
to_m = [1, 0]
joint = "joint"
[in_situ_stress]
elevation_m = {blocks}
compression_xx_MPa = 0
compression_yy_MPa = 0
shear_xy_MPa = 0
compression_xx_gradient_MPa_per_m = 0
compression_yy_gradient_MPa_per_m = {gradient}
shear_xy_gradient_MPa_per_m = 0
[schedule]
end = 2
[zones]
size_m = 2
[equilibrium]
tolerance = {tolerance}
"""
STAGE = """
[[stage]]
name = "top removed"
date = 1
remove_m = [[[0, {below}], [1, {below}], [1, {blocks}], [0, {blocks}]]]
"""


def scene_of(blocks, way, with_stage):
    equilibrium, dynamics = WAYS[way]
    text = SCENE.format(blocks=blocks, gravity=GRAVITY, density=DENSITY, young=YOUNG / 1e9, normal=NORMAL / 1e6,
                        shear=SHEAR / 1e6, friction=FRICTION, gradient=DENSITY * GRAVITY / 1e6, tolerance=TOLERANCE)
    text += equilibrium + dynamics
    text += "".join(f'[[joint]]\nname = "{i}"\nfrom_m = [0, {i}]\nto_m = [1, {i}]\nmaterial = "joint"\n'
                    for i in range(1, blocks))
    text += "".join(f'[[point]]\nname = "{i}"\nat_m = [0.5, {i + 0.5}]\n' for i in range(blocks - 1))
    return text + (STAGE.format(blocks=blocks, below=blocks - 1) if with_stage else "")


def wall_time(command):
    """The least of three runs [s]."""
    taken = []
    for _ in range(3):
        before = time.perf_counter()
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        taken.append(time.perf_counter() - before)
    return min(taken)


def ours(programs, blocks, way, scratch):
    result = scratch / "result.h5"
    seconds, wall = [], []
    for with_stage in False, True:
        joints = chain.joints_of(programs, scene_of(blocks, way, with_stage), scratch)
        command = [programs / "demsolve", joints, "-q", "-o", result]
        seconds.append(measured(command)[0])
        wall.append(wall_time([*command, "--threads", "2"]))
    with figure.opened(result) as file:
        rise = figure.array(file, "/history/displacement")[-1, :, 1]
        steps = int(figure.array(file, "/equilibria/steps")[-1])
        ratio = figure.array(file, "/equilibria/unbalanced_force_ratio")[-1]
        contacts = len(figure.array(file, "/mesh/contact_edge"))
    pull = DENSITY * GRAVITY
    exact = np.array([(i + 1) * pull / NORMAL + (0 if "rigid" in way else (i + 0.5) * pull / YOUNG)
                      for i in range(blocks - 1)])
    if "rigid" in way:
        contacts = blocks  # pairs of faces
    pace = [steps * contacts / (taken[1] - taken[0]) if steps > 1 and taken[1] - taken[0] > 2 * SHORTEST else None
            for taken in (seconds, wall)]
    return {"blocks": blocks, "way": way, "error": abs(rise - exact).max() / exact.max(), "unbalanced_force_ratio": ratio,
            "steps": steps, "seconds": seconds[1] - seconds[0], "contact_steps_per_s": pace[0],
            "on_two_threads": pace[1]}


def yades(yade, blocks, turns, scratch):
    case, out = scratch / "case.json", scratch / "out.json"
    found = []
    for threads in 1, 2:
        case.write_text(json.dumps({
            "blocks": blocks, "turns": turns, "density": DENSITY, "gravity": GRAVITY, "normal_stiffness": NORMAL,
            "shear_stiffness": SHEAR, "friction_angle": math.radians(FRICTION), "enough": ENOUGH,
            "seconds": LIMIT if threads == 1 else 0}))
        subprocess.run([yade, "-n", "-x", f"-j{threads}", HERE / "yade_stack.py", case, out], check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        found.append(json.loads(out.read_text()))
    alone, both = found
    steps, seconds = alone["within"] or (None, None)
    return {"blocks": blocks, "way": f"YADE, {'free in the plane' if turns else 'rotations fixed'}",
            "error": alone["error"], "unbalanced_force_ratio": alone["unbalanced_force_ratio"], "steps": steps, "seconds": seconds,
            "contact_steps_per_s": alone["steps_per_s"] * alone["contacts"],
            "on_two_threads": both["steps_per_s"] * both["contacts"]}


def main():
    if len(sys.argv) != 3:
        sys.exit("usage: stack.py BIN OUT")
    programs, out = map(Path, sys.argv[1:])
    yade = shutil.which("yade")
    if not yade:
        sys.exit("stack.py: there is no program yade to compare with; Debian's package yade has it")
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for blocks in BLOCKS:
            rows += [ours(programs, blocks, way, Path(folder)) for way in WAYS]
            rows += [yades(yade, blocks, turns, Path(folder)) for turns in (True, False)]
            print(f"{blocks} blocks", flush=True)
    write(rows, out)


def write(rows, out):
    (out / "tables").mkdir(parents=True, exist_ok=True)
    with open(out / "stack.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)
    lines = [[row["blocks"], row["way"], number(row["error"]), number(row["unbalanced_force_ratio"]),
              row["steps"] or f"not in {LIMIT} s",
              f"below {SHORTEST}" if row["seconds"] and row["seconds"] < SHORTEST else number(row["seconds"], ".2g"),
              number(row["contact_steps_per_s"]), number(row["on_two_threads"])] for row in rows]
    head = ["blocks", "method", "error of the rise", "unbalanced force ratio", "steps", "seconds", "contact-steps per s",
            "on two threads"]
    (out / "tables/stack.md").write_text("\n".join(table(head, lines)).rstrip() + "\n")


if __name__ == "__main__":
    main()
