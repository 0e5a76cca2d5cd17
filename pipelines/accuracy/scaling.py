#!/usr/bin/python3
"""Time and memory against the number of zones, and the implicit engine beside dynamic relaxation at equal error.

    scaling.py BIN FACTOR_BENCHMARK DATA OUT

runs demsolve of the folder BIN on the bench slope and the column of the folder DATA, and CHOLMOD alone on the matrices
of the same sections (FACTOR_BENCHMARK, tests/implicit/factor_benchmark.cpp), and writes into OUT
    scaling.csv, tables/scaling.md, scaling.png     time and memory, from 1e3 to 2e5 zones
    equal-error.csv, tables/equal-error.md          the slope with 2e4 zones, a year in 52 creep steps, by both engines

Times are processor time, of one thread. What a run can cost at least is taken to be
    one factorisation for each equilibrium in which a contact changes its state, and one analysis for each stage,
    + one back-substitution for each equilibrium,
each as long as CHOLMOD takes for it alone. What a run takes beside its equilibria (reading, zoning, writing) is
measured by the same section with neither stages nor creep, less its own one analysis and factorisation.
"""

import csv
import json
import math
import os
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import cases as of
import errors
import figure
from jointcreep import chain
from speed_against_error import number, table

SIZES = {"slope": [6, 3, 1.6, 1, 0.7, 0.45], "column": [1.25, 0.6, 0.3, 0.17, 0.1]}  # of zones [m]
FINE, WEEK = 1.6, 7  # zones [m] and creep step [day] of the comparison of engines
TIGHT = {"implicit": 1e-9, "relaxation": 1e-8}
TOLERANCES = {"implicit": [1e-3, 1e-4, 1e-5, 1e-6, 1e-7], "relaxation": [1e-3, 1e-4, 1e-5, 1e-6, 1e-7]}
# In a process of its own, small: a child starts with its parent's size as the most memory that it ever had.
MEASURE = """import json, os, subprocess, sys
child = subprocess.Popen(sys.argv[1:], stdout=subprocess.DEVNULL, env=dict(os.environ, OMP_NUM_THREADS="1"))
_, status, usage = os.wait4(child.pid, 0)
print(json.dumps([os.waitstatus_to_exitcode(status), usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024]))"""


def measured(command):
    """Processor time [s], of short runs the least of three, and peak memory [MB] of a program."""
    runs = [measured_once(command)]
    while len(runs) < 3 and runs[0][0] < 3:
        runs.append(measured_once(command))
    return min(runs)


def measured_once(command):
    done = subprocess.run([sys.executable, "-S", "-c", MEASURE, *map(str, command)], check=True, capture_output=True,
                          text=True)
    code, seconds, memory = json.loads(done.stdout)
    if code != 0:
        sys.exit(f"scaling.py: {' '.join(map(str, command))}: exit code {code}: {done.stderr}")
    return seconds, memory


class Section:
    """A scene's joints file, and that of the same section with neither stages nor creep."""

    def __init__(self, name, text, programs, benchmark, scratch):
        self.name, self.demsolve, self.benchmark = name, programs / "demsolve", benchmark
        self.result = scratch / "result.h5"
        self.joints = self.prepared(text, programs, scratch / name)
        nothing = re.sub(r"(?ms)^\[(\[stage\]|creep)\].*?(?=^\[|\Z)", "", text)
        self.unchanged = self.prepared(nothing, programs, scratch / f"{name}-unchanged")

    @staticmethod
    def prepared(text, programs, folder):
        folder.mkdir()
        return chain.joints_of(programs, text, folder)

    def solve(self, *options, joints=None):
        return measured([self.demsolve, joints or self.joints, "-q", "-o", self.result, *options])

    def cholmod(self, size):
        done = subprocess.run([self.benchmark, self.joints, f"{size:g}"], check=True, capture_output=True, text=True,
                              env=dict(os.environ, OMP_NUM_THREADS="1"))
        return {key: float(value) for key, value in next(csv.DictReader(done.stdout.splitlines())).items()}

    def beside(self, size, alone):
        """What a run takes beside its equilibria [s]."""
        seconds, _ = self.solve("--zone-size", size, "--engine", "implicit", joints=self.unchanged)
        return seconds - alone["analyse_s"] - alone["factorise_s"] - alone["solve_s"]


def changes_of(path):
    """In how many equilibria a contact changed its state (of a run with --states 1), and how many there were."""
    with figure.opened(path) as file:
        status = figure.array(file, "/states/contact_status")
        equilibria = len(figure.array(file, "/equilibria/time"))
    changed = [((now != before) & (now != 0)).any() for before, now in zip(status, status[1:])]
    return int(sum(changed)), equilibria


@dataclass
class Least:
    """What the equilibria of a run can cost at least [s]."""

    changes: int
    equilibria: int
    seconds: float


def least_of(path, alone, stages):
    changes, equilibria = changes_of(path)
    first = 1  # the in-situ equilibrium
    seconds = ((changes + first) * alone["factorise_s"] + (stages + first) * alone["analyse_s"]
               + equilibria * alone["solve_s"])
    return Least(changes + first, equilibria, seconds)


def scaling_rows(section, stages):
    for size in SIZES[section.name]:
        alone = section.cholmod(size)
        options = ["--zone-size", size, "--engine", "implicit"]
        seconds, memory = section.solve(*options)
        result = errors.result_of(section.result)
        beside = section.beside(size, alone)
        section.solve(*options, "--states", "1")
        least = least_of(section.result, alone, stages)
        print(f"{section.name}, {result.zones} zones: {seconds:.1f} s, {memory:.0f} MB", flush=True)
        yield {"section": section.name, "zone_size_m": size, **alone, "run_s": seconds, "beside_s": beside,
               "memory_MB": memory, "equilibria": result.equilibria, "changes": least.changes,
               "factorisations": result.factorisations, "back_substitutions": result.solves,
               "least_s": least.seconds}


def scaling_table(rows):
    lines = []
    for row in rows:
        solver = row["run_s"] - row["beside_s"]
        lines.append([row["section"], f"{row['zones']:.0f}", f"{row['factor_entries'] / row['unknowns']:.0f}",
                      row["equilibria"], row["changes"], row["factorisations"], row["back_substitutions"],
                      f"{row['run_s'] / row['factorise_s']:.0f}", f"{row['run_s'] / row['solve_s']:.0f}",
                      f"{100 * row['beside_s'] / row['run_s']:.0f}", f"{solver / row['least_s']:.1f}",
                      f"{row['memory_MB']:.0f}", f"{row['cholmod_MB']:.0f}"])
    return table(["section", "zones", "entries of the factor per unknown", "equilibria", "with changed contacts",
                  "factorisations", "back-substitutions", "run / factorisation", "run / back-substitution",
                  "beside equilibria (%)", "equilibria / least", "memory (MB)", "of CHOLMOD alone (MB)"], lines)


def powers_table(rows):
    """With which power of the number of zones things grow, over all sizes of a section."""
    lines = []
    for name in SIZES:
        those = [row for row in rows if row["section"] == name]
        zones = np.log([row["zones"] for row in those])
        lines.append([name, f"{those[0]['zones']:.0f} to {those[-1]['zones']:.0f}", *(
            f"{np.polyfit(zones, np.log([row[key] for row in those]), 1)[0]:.2f}" for key in
            ("run_s", "beside_s", "analyse_s", "factorise_s", "solve_s", "memory_MB", "cholmod_MB"))])
    return table(["section", "zones", "run", "beside equilibria", "analysis", "factorisation", "back-substitution",
                  "memory", "of CHOLMOD alone"], lines)


def draw(rows, path):
    plot, axes = figure.plt.subplots(1, 2, figsize=(figure.TWO_COLUMNS, 3.2))
    looks = {"slope": "-", "column": "--"}
    for name, line in looks.items():
        those = [row for row in rows if row["section"] == name]
        unit = min(row["factorise_s"] for row in rows)
        for key, label, color in (("run_s", "demsolve", 0), ("beside_s", "beside equilibria", 2),
                                  ("factorise_s", "CHOLMOD: factorisation", 1),
                                  ("solve_s", "CHOLMOD: back-substitution", 3)):
            axes[0].loglog([row["zones"] for row in those], [row[key] / unit for row in those], line, marker="o",
                           color=figure.COLORS[color], label=f"{name}: {label}", markersize=3, linewidth=0.8)
        for key, label, color in (("memory_MB", "demsolve", 0), ("cholmod_MB", "CHOLMOD", 1)):
            axes[1].loglog([row["zones"] for row in those], [row[key] for row in those], line, marker="o",
                           color=figure.COLORS[color], label=f"{name}: {label}", markersize=3, linewidth=0.8)
    axes[0].set_ylabel("processor time\n(smallest factorisation = 1)")
    axes[1].set_ylabel("peak memory (MB)")
    for one in axes:
        one.set_xlabel("zones")
        one.grid(color="0.9", linewidth=0.4)
        one.legend(fontsize=6, ncol=2, loc="upper center", bbox_to_anchor=(0.5, -0.22))
    plot.savefig(path)


# Equal error


def engine_runs(section, creep):
    """{engine: [(tolerance, seconds, error)]}, each beside its own tight solution, with the same creep steps."""
    options = ["--zone-size", FINE, *(["--creep-step", WEEK] if creep else ["--no-creep"])]
    found = {}
    for engine, tight in TIGHT.items():
        section.solve(*options, "--engine", engine, "--tolerance", tight)
        exact = errors.result_of(section.result)
        for tolerance in TOLERANCES[engine]:
            seconds, _ = section.solve(*options, "--engine", engine, "--tolerance", tolerance)
            result = errors.result_of(section.result)
            error = errors.against(result, exact)
            found.setdefault(engine, []).append((tolerance, seconds, max(error.displacement, error.traction), result))
            print(f"{engine}, {'creep' if creep else 'no creep'}, tolerance {tolerance:g}: {seconds:.1f} s, "
                  f"error {error.displacement:.1e} {error.traction:.1e}", flush=True)
    return found


def seconds_at(runs, error):
    """Time for an error, between runs by its logarithms."""
    runs = sorted((math.log(found), math.log(seconds)) for _, seconds, found, _ in runs)
    return math.exp(np.interp(math.log(error), *zip(*runs)))


def equal_error(section, out):
    alone, stages = section.cholmod(FINE), 3
    beside = section.beside(FINE, alone)
    lines, rows = [], []
    for creep in True, False:
        found = engine_runs(section, creep)
        section.solve("--zone-size", FINE, "--engine", "implicit", "--states", "1",
                      *(["--creep-step", WEEK] if creep else ["--no-creep"]))
        least = least_of(section.result, alone, stages)
        name = "a year and a half of creep" if creep else "no creep"
        for engine, runs in found.items():
            for tolerance, seconds, error, result in runs:
                rows.append([name, engine, tolerance, seconds, error, result.equilibria, result.steps,
                             result.factorisations, result.solves, beside, least.changes, least.seconds])
        for tolerance, seconds, error, result in found["implicit"]:
            reached = min(run[2] for run in found["relaxation"]) <= error <= max(run[2] for run in found["relaxation"])
            relaxation = seconds_at(found["relaxation"], error) if reached else math.nan
            lines.append([name, f"{tolerance:g}", number(error), result.equilibria, least.changes,
                          result.factorisations, result.solves,
                          number(relaxation / seconds, ".0f"), number((relaxation - beside) / (seconds - beside), ".0f"),
                          f"{(seconds - beside) / least.seconds:.1f}", f"{seconds / (least.seconds + beside):.1f}"])
    with open(out / "equal-error.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["run", "engine", "tolerance", "seconds", "error", "equilibria", "steps", "factorisations",
                         "back_substitutions", "beside_s", "changes", "least_s"])
        writer.writerows(rows)
    (out / "tables/equal-error.md").write_text("\n".join(table(
        ["slope, 2e4 zones", "tolerance", "error", "equilibria", "with changed contacts", "factorisations",
         "back-substitutions", "relaxation / implicit", "of equilibria only", "equilibria / least", "run / least run"],
        lines)).rstrip() + "\n")


def main():
    if len(sys.argv) != 5:
        sys.exit("usage: scaling.py BIN FACTOR_BENCHMARK DATA OUT")
    programs, benchmark, data, out = (Path(a).resolve() for a in sys.argv[1:])
    (out / "tables").mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        sections = [Section(name, of.with_default_equilibrium((data / name / "scene.toml").read_text()), programs,
                            benchmark, Path(folder)) for name in SIZES]
        rows = [row for section in sections for row in scaling_rows(section, 3)]
        with open(out / "scaling.csv", "w", newline="") as file:
            writer = csv.DictWriter(file, rows[0])
            writer.writeheader()
            writer.writerows(rows)
        (out / "tables/scaling.md").write_text("\n".join(scaling_table(rows)).rstrip() + "\n")
        (out / "tables/scaling-powers.md").write_text("\n".join(powers_table(rows)).rstrip() + "\n")
        draw(rows, out / "scaling.png")
        equal_error(sections[0], out)


if __name__ == "__main__":
    main()
