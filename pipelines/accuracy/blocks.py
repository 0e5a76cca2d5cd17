#!/usr/bin/python3
"""What each program costs over the number of blocks, from 1e2 to 9e4.

    blocks.py BIN DATA OUT

The rock is that of the bench slope of the folder DATA, with its joint sets and without its fault, in sections of the
same shape that grow. One bench is dug at the upper right, as high everywhere. Zones are as large as blocks let them be,
so that a block has about as many everywhere. Writes OUT/blocks.csv, OUT/blocks.png and tables/blocks.md,
tables/block-memory.md and tables/block-powers.md.

Processor times of one thread, with reading and writing; each the least of three, or one where a run takes 3 s or more.
Dynamic relaxation and the dynamic analysis go up to MOST blocks. The error of dynamic relaxation is its largest difference of a
gridpoint's displacement to that by the implicit engine, over the largest displacement. The dynamic analysis, with rigid rock, makes STEPS steps from the stress given,
less what a run of one step costs.
"""

import csv
import math
import re
import sys
import tempfile
from pathlib import Path

import numpy as np

import figure
from jointcreep import chain
from scaling import measured
from speed_against_error import number, table

GROWTH = [0.6, 1, 1.7, 3, 5.3, 9.5, 16.5]  # over the slope's section
MOST, STEPS = {"relaxation": 1e5, "dynamics": 4e4}, 2000
PROGRAMS = ["jointgen", "strength-averaging", "implicit", "relaxation"]
NAMES = {"jointgen": "jointgen", "strength-averaging": "strength-averaging", "implicit": "demsolve, implicit",
         "relaxation": "demsolve, relaxation", "dynamics": f"dynamic, {STEPS} steps"}


def scene_of(slope, growth, added=""):
    width, height = 120 * growth, 70 * growth
    text = re.sub(r"(?ms)^\[(\[joint\]|\[boundary\]|\[stage\]|\[point\]|\[gauge\]|creep\]).*?(?=^\[|\Z)", "", slope)
    for key, value in (("outline_m", f"[[0, 0], [{width}, 0], [{width}, {height}], [0, {height}]]"),
                       ("elevation_m", height), ("size_m", 30)):
        text, found = re.subn(rf"(?m)^{key} = [^#\n]*", f"{key} = {value} ", text)
        assert found == 1, key
    for ends, fix in (([[0, 0], [width, 0]], "xy"), ([[0, 0], [0, height]], "x"), ([[width, 0], [width, height]], "x")):
        text += f'\n[[boundary]]\nfrom_m = {ends[0]}\nto_m = {ends[1]}\nfix = "{fix}"\n'
    bench = [[width - 30, height - 15], [width + 1, height - 15], [width + 1, height + 1], [width - 34, height + 1]]
    return text + f'\n[[stage]]\nname = "bench"\ndate = 2001-04-01\nremove_m = [{bench}]\n' + added


def dynamics_for(seconds):
    return ('\n[large_displacements]\nnew_contacts = "joint"\nrigid_rocks = ["granite"]\nrecord_every_s = 1000\n'
            f"longest_s = {seconds:.17g}\n")


class Chain:
    def __init__(self, programs, slope, scratch):
        self.programs, self.slope = programs, slope
        self.scene, self.network, self.joints, self.result, self.failed = (
            scratch / name for name in ("scene.toml", "network.h5", "joints.h5", "result.h5", "result.failed.h5"))

    def prepare(self, growth, added=""):
        """Time and memory of jointgen and strength-averaging."""
        self.scene.write_text(scene_of(self.slope, growth, added))
        return (measured([self.programs / "jointgen", self.scene, "-q", "-o", self.network]),
                measured([self.programs / "strength-averaging", self.network, "-q", "-o", self.joints]))

    def solve(self, *options):
        return measured([self.programs / "demsolve", self.joints, "-q", "-o", self.result, *options])

    def dynamics(self, growth, seconds):
        """Time and memory [s, MB] of so many seconds of dynamic analysis, which end before there is rest; and a step [s]."""
        chain.joints_of(self.programs, scene_of(self.slope, growth, dynamics_for(seconds)), self.scene.parent)
        taken = measured(["sh", "-c", '"$0" "$@"; [ $? = 3 ]', self.programs / "demsolve", self.joints, "-q", "-o",
                          self.result])
        with figure.opened(self.failed) as file:
            step = figure.array(file, "/failure/seconds")[0] / figure.array(file, "/failure/steps")[0]
        return *taken, step


def row_of(chain, growth):
    averages = dict(zip(PROGRAMS, chain.prepare(growth)))
    with figure.opened(chain.joints) as file:
        row = {"growth": growth, "blocks": len(figure.array(file, "/blocks/area"))}
    for engine in "implicit", "relaxation":
        if row["blocks"] > MOST.get(engine, math.inf):
            continue
        averages[engine] = chain.solve("--engine", engine)
        with figure.opened(chain.result) as file:
            row["zones"] = len(figure.array(file, "/mesh/zone_block"))
            row["contacts"] = len(figure.array(file, "/mesh/contact_edge"))
            row[f"{engine}_steps"] = int(figure.array(file, "/equilibria/steps").sum())
            displacement = figure.array(file, "/states/displacement")[-1]
            if engine == "implicit":
                row["factorisations"] = int(figure.array(file, "/equilibria/factorisations").sum())
                row["back_substitutions"] = int(figure.array(file, "/equilibria/solves").sum())
                by_implicit = displacement
            else:
                row["relaxation_error"] = (np.linalg.norm(displacement - by_implicit, axis=1).max()
                                         / np.linalg.norm(by_implicit, axis=1).max())
    if row["blocks"] <= MOST["dynamics"]:
        start, _, step = chain.dynamics(growth, 1e-12)
        seconds, memory, _ = chain.dynamics(growth, (STEPS - 0.5) * step)
        row["dynamics_step_s"] = step
        averages["dynamics"] = seconds - start, memory
    for program, (seconds, memory) in averages.items():
        row |= {f"{program}_s": seconds, f"{program}_MB": memory}
    return row


def per_block(row, program, unit):
    value = row.get(f"{program}_{unit}")
    return number(value and value / row["blocks"] * 1000, ".3g")


def draw(rows, path):
    plot, axes = figure.plt.subplots(1, 2, figsize=(figure.TWO_COLUMNS, 3))
    for one, unit, label in zip(axes, ("s", "MB"), ("processor time (s)", "peak memory (MB)")):
        for i, (program, name) in enumerate(NAMES.items()):
            those = [row for row in rows if f"{program}_{unit}" in row]
            one.loglog([row["blocks"] for row in those], [row[f"{program}_{unit}"] for row in those],
                       marker=figure.MARKERS[i], linestyle=figure.LINES[i], color=figure.COLORS[i], label=name)
        low, high = one.get_ylim()
        ends = np.array([rows[0]["blocks"], rows[-1]["blocks"]])
        last = rows[-1][f"implicit_{unit}"]
        one.loglog(ends, last * ends / ends[1], color="0.8", linewidth=0.8, zorder=0, label="in proportion to blocks")
        one.set_ylim(low, high)
        one.set_xlabel("blocks")
        one.set_ylabel(label)
        one.grid(color="0.9", linewidth=0.4)
    axes[1].legend(fontsize=6.5)
    figure.save(plot, path)


def write(rows, out):
    (out / "tables").mkdir(parents=True, exist_ok=True)
    columns = list(dict.fromkeys(key for row in rows for key in row))
    with open(out / "blocks.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, columns)
        writer.writeheader()
        writer.writerows(rows)
    tables = out / "tables"
    lines = [[row["blocks"], f"{row['zones'] / row['blocks']:.1f}", *(per_block(row, name, "s") for name in NAMES),
              row["factorisations"], row["back_substitutions"], row.get("relaxation_steps", ""),
              number(row.get("relaxation_error"))] for row in rows]
    head = ["blocks", "zones a block", *NAMES.values(), "factorisations", "back-substitutions", "steps, relaxation",
            "error, relaxation"]
    (tables / "blocks.md").write_text("\n".join(table(head, lines)).rstrip() + "\n")
    lines = [[row["blocks"], *(per_block(row, name, "MB") for name in NAMES)] for row in rows]
    (tables / "block-memory.md").write_text("\n".join(table(["blocks", *NAMES.values()], lines)).rstrip() + "\n")
    lines = []
    for unit, what in ("s", "time"), ("MB", "memory"):
        powers = []
        for program in NAMES:
            those = [row for row in rows if row["blocks"] > 900 and f"{program}_{unit}" in row]
            powers.append(number(np.polyfit(np.log([row["blocks"] for row in those]),
                                            np.log([row[f"{program}_{unit}"] for row in those]), 1)[0], ".2f")
                          if len(those) > 1 else "")
        lines.append([what, *powers])
    (tables / "block-powers.md").write_text("\n".join(table(["", *NAMES.values()], lines)).rstrip() + "\n")
    draw(rows, out / "blocks.png")


def main():
    if len(sys.argv) != 4:
        sys.exit("usage: blocks.py BIN DATA OUT")
    programs, data, out = map(Path, sys.argv[1:])
    slope = (data / "slope/scene.toml").read_text()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        chain = Chain(programs, slope, Path(folder))
        for growth in GROWTH:
            rows.append(row_of(chain, growth))
            print(f"{rows[-1]['blocks']} blocks", flush=True)
    write(rows, out)


if __name__ == "__main__":
    main()
