#!/usr/bin/python3
"""Time and memory of cutting, over the number of blocks: jointgen beside other ways to cut the same joints.

    cutting.py JOINTGEN BENCHMARK OUT [--most BLOCKS]

Scenes are squares of 1000 m with three joint sets at 15, 75 and 130 degrees, lines through the whole section.
Processor times; each the least of three, or one where a run is long. Writes cutting.csv, cutting.md and cutting.png.
"""

import argparse
import csv
import math
import subprocess
import sys
from pathlib import Path

from figure import COLORS, LINES, MARKERS, TWO_COLUMNS, plt

ANGLES = 15, 75, 130  # [deg]
METHODS = {"jointgen": "jointgen, all of it", "subdivision": "subdivision alone", "cgal": "CGAL insertion",
           "geos": "GEOS union, polygonize"}
LIMIT = 0.5e-6  # a bare half-edge tracer in doubles on one core, out of cache [s per face]
LONG = 5  # [s]

HEAD = """title = "Cutting"

[section]
outline_m = [[0, 0], [1000, 0], [1000, 1000], [0, 1000]]
rock = "rock"
gravity_m_per_s2 = 9.81

[random]
seed = 1

[[rock]]
name = "rock"
density_kg_per_m3 = 2700
youngs_modulus_GPa = 20
poissons_ratio = 0.25

[[joint_material]]
name = "joint"
normal_stiffness_MPa_per_m = 5000
shear_stiffness_MPa_per_m = 2000
cohesion_MPa = 0.05
friction_angle_deg = 38
tensile_strength_MPa = 0

[in_situ_stress]
elevation_m = 1000
compression_xx_MPa = 0
compression_yy_MPa = 0
shear_xy_MPa = 0
compression_xx_gradient_MPa_per_m = 0
compression_yy_gradient_MPa_per_m = 0.026487
shear_xy_gradient_MPa_per_m = 0

[[boundary]]
from_m = [0, 0]
to_m = [1000, 0]
fix = "xy"

[schedule]
start = 0
end = 1
"""


def lines(blocks):
    """Of a scene: sets of persistent joints that make about so many blocks."""
    spacing = math.sqrt(2.59e6 / blocks)  # the sum of sines over the sets, times the area
    text = HEAD + f"\n[zones]\nsize_m = {spacing:.6g}\n"
    for angle in ANGLES:
        text += f"""
[[joint_set]]
name = "at {angle}"
material = "joint"
trace_angle = {{ law = "normal", mean_deg = {angle}, deviation_deg = 2 }}
spacing = {{ law = "negative exponential", mean_m = {spacing:.6g} }}
persistence = 1
"""
    return text


def output_of(command):
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True)
    if done.returncode != 0:
        sys.exit(f"cutting.py: {' '.join(map(str, command))} ended with {done.returncode}")
    return done.stdout


def least(run):
    """The run of least time, of three if they are short."""
    runs = [run()]
    while len(runs) < 3 and runs[0][0] < LONG:
        runs.append(run())
    return min(runs)


def number_of_blocks(output):
    for line in output.splitlines():
        if line.startswith("blocks "):
            return int(line.split()[1])
    sys.exit("cutting.py: jointgen says no number of blocks")


def rows(jointgen, benchmark, out, most):
    start = float(output_of([benchmark, "run", jointgen, "--version"]).splitlines()[-1].split(",")[1])
    for blocks in (1e3, 1e4, 1e5, 1e6):
        if blocks > most:
            break
        scene, network = out / f"lines-{blocks:.0e}.toml", out / "network.h5"
        scene.write_text(lines(blocks))

        def whole():
            output = output_of([benchmark, "run", jointgen, scene, "-o", network])
            time, memory = map(float, output.splitlines()[-1].split(","))
            return time, memory - start, number_of_blocks(output)

        time, memory, faces = least(whole)
        yield {"method": "jointgen", "blocks": faces, "faces": faces, "time_s": time, "bytes": memory,
               "file_bytes": network.stat().st_size}
        network.unlink()
        for method in list(METHODS)[1:]:
            def other():
                fields = output_of([benchmark, method, scene]).split(",")
                return float(fields[3]), float(fields[4]), int(fields[2])

            time, memory, others = least(other)
            yield {"method": method, "blocks": faces, "faces": others, "time_s": time, "bytes": memory,
                   "file_bytes": ""}


def table(results):
    text = "| blocks | method | faces | time, s | us a face | of CGAL's time | bytes a face |\n|---|---|---|---|---|---|---|\n"
    cgal = {row["blocks"]: row["time_s"] for row in results if row["method"] == "cgal"}
    for row in results:
        text += (f"| {row['blocks']} | {METHODS[row['method']]} | {row['faces']} | {row['time_s']:.3g} | "
                 f"{1e6 * row['time_s'] / row['faces']:.2g} | {row['time_s'] / cgal[row['blocks']]:.2g} | "
                 f"{row['bytes'] / row['faces']:.0f} |\n")
    return text


def plot(results, path):
    figure, (time, memory) = plt.subplots(1, 2, figsize=(TWO_COLUMNS, 2.6), layout="constrained")
    for method, color, line, marker in zip(METHODS, COLORS, LINES, MARKERS):
        own = [row for row in results if row["method"] == method]
        blocks = [row["blocks"] for row in own]
        style = {"color": color, "linestyle": line, "marker": marker, "markersize": 3, "label": METHODS[method]}
        time.plot(blocks, [1e6 * row["time_s"] / row["faces"] for row in own], **style)
        memory.plot(blocks, [row["bytes"] / row["faces"] for row in own], **style)
    time.axhline(1e6 * LIMIT, color="0.5", linewidth=0.8)
    time.annotate("limit", (results[0]["blocks"], 1e6 * LIMIT), color="0.4", va="bottom")
    for axes, label in (time, "processor time, µs a face"), (memory, "memory, bytes a face"):
        axes.set(xscale="log", yscale="log", xlabel="blocks", ylabel=label)
    memory.legend(fontsize=6)
    figure.savefig(path, dpi=200)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("jointgen")
    parser.add_argument("benchmark")
    parser.add_argument("out", type=Path)
    parser.add_argument("--most", type=float, default=1e6, help="blocks")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    results = list(rows(arguments.jointgen, arguments.benchmark, arguments.out, arguments.most))
    with open(arguments.out / "cutting.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, results[0])
        writer.writeheader()
        writer.writerows(results)
    (arguments.out / "cutting.md").write_text(table(results))
    plot(results, arguments.out / "cutting.png")


if __name__ == "__main__":
    main()
