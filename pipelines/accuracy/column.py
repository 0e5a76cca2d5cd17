#!/usr/bin/python3
"""The paper's column against its closed form, over everything that could make a difference.

    column.py BIN SCENE.toml OUT

runs the programs in BIN on SCENE.toml and on variants of it, and writes into OUT
    column.csv      one row a run: what was changed, largest relative difference, zones, solver steps, cost
    readings.csv    one row a run and reading: computed and exact rise
    tables/column.md, tables/readings.md      the same as tables, the readings of the scene's own settings only
    column.png      the difference over zone size, tolerance and creep step
"""

import csv
import os
import subprocess
import sys
import tempfile
import tomllib
from dataclasses import dataclass, field
from pathlib import Path

import column_difference
import figure
from jointcreep import chain
from speed_against_error import processor_seconds

ZONE_SIZES = [5, 2.5, 1.25, 0.625]  # [m]
TOLERANCES = [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9]
CREEP_STEPS = [0.25, 0.5, 1, 2, 5]  # [day]
NAMED = [("A", 5, ""), ("A", 10, "before"), ("B", 1, "after"), ("B", 10, "before"), ("B", 10, "after"),
         ("B", 20, "before"), ("C", 10, "after"), ("C", 20, "after"), ("C", 40, "")]  # readings in readings.md


@dataclass
class Run:
    study: str
    value: str
    scene: str  # text
    options: list[str] = field(default_factory=list)  # of demsolve
    number: float = 0.0  # the value, for the picture


@dataclass
class Answer:
    readings: list
    zones: int
    steps: int  # of the solver, in all equilibria
    seconds: float  # of processor time
    version: str

    @property
    def worst(self):
        return column_difference.largest(self.readings)


def edited(text, old, new, times=1):
    """The scene's text with a change that must apply exactly so often."""
    if text.count(old) != times:
        sys.exit(f"column.py: the scene has '{old}' {text.count(old)} times, not {times}: mend this script")
    return text.replace(old, new)


def with_equilibrium(text, settings):
    """The scene with other keys in its last table, [equilibrium]."""
    head, _, tail = text.rpartition("[equilibrium]")
    if not head or "\n[" in tail:
        sys.exit("column.py: [equilibrium] is not the scene's last table: mend this script")
    return f"{head}[equilibrium]\n{settings}\n"


def runs_of(text):
    """The scene as it is, then every run that differs from it in one thing."""
    scene = tomllib.loads(text)
    own_size, own_step = scene["zones"]["size_m"], scene["creep"]["step_days"]
    own_tolerance = scene["equilibrium"].get("tolerance", 1e-6)
    runs = [Run("the scene's own settings",
                f"zones {own_size:g} m, tolerance {own_tolerance:g}, dT {own_step:g} day", text)]
    for study, option, unit, own, values in [("zone size", "--zone-size", "m", own_size, ZONE_SIZES),
                                             ("tolerance", "--tolerance", "", own_tolerance, TOLERANCES),
                                             ("creep step dT", "--creep-step", "day", own_step, CREEP_STEPS)]:
        for value in values:
            options = [] if value == own else [option, f"{value:g}"]
            runs.append(Run(study, f"{value:g} {unit}".strip(), text, options, value))

    damping = scene["equilibrium"]["mass_damping_per_s"]
    for factor in (0.2, 0.5, 2):
        runs.append(Run("engine and damping", f"real masses, mass damping {factor * damping:g} /s",
                        edited(text, f"mass_damping_per_s = {damping:g}", f"mass_damping_per_s = {factor * damping:g}")))
    for kind in ("adaptive", "local"):
        settings = f'engine = "relaxation"\nmasses = "scaled"\ndamping = "{kind}"\nmost_steps = 20000000'
        runs.append(Run("engine and damping", f"scaled masses, {kind} damping", with_equilibrium(text, settings)))
    runs.append(Run("engine and damping", "implicit engine", with_equilibrium(text, 'engine = "implicit"')))

    runs.append(Run("variant", "nu = 0", edited(text, "poissons_ratio = 0.22", "poissons_ratio = 0")))
    runs.append(Run("variant", 'base fixed in y (`fix = "y"`), no joint under it',
                    edited(text, 'joint = "base joint"', 'fix = "y"')))
    runs.append(Run("variant", "K_s doubled",
                    edited(text, "shear_stiffness_MPa_per_m = 280", "shear_stiffness_MPa_per_m = 560")))
    return runs


def answer_of(run, programs, folder):
    joints, result = chain.joints_of(programs, run.scene, folder), folder / "result.h5"
    seconds, code, message = processor_seconds([programs / "demsolve", joints, "-q", "-o", result, *run.options])
    if code != 0:
        raise SystemExit(message)
    with figure.opened(result) as file:
        return Answer(column_difference.readings(file), len(figure.array(file, "/mesh/zone_block")),
                      int(figure.array(file, "/equilibria/steps").sum()), seconds,
                      figure.text_of(file.attrs["program_version"]))


def write_tables(answers, own, folder):
    with open(folder / "column.csv", "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["study", "value", "largest_relative_difference", "point", "day", "side", "readings", "zones",
                        "solver_steps", "cost_ratio"])
        for run, answer in answers:
            worst = answer.worst
            table.writerow([run.study, run.value, worst.difference, worst.point, worst.day, worst.side,
                            len(answer.readings), answer.zones, answer.steps, answer.seconds / own.seconds])
    with open(folder / "readings.csv", "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["study", "value", "point", "day", "side", "computed_m", "exact_m", "relative_difference"])
        for run, answer in answers:
            for r in answer.readings:
                table.writerow([run.study, run.value, r.point, r.day, r.side, r.computed, r.exact, r.difference])


def write_markdown(answers, own, folder):
    lines = ["| changed | to | largest relative difference | zones | solver steps | cost |",
             "|---|---|---|---|---|---|"]
    for run, answer in answers:
        lines.append(f"| {run.study} | {run.value} | {answer.worst.difference:.1e} | {answer.zones} | {answer.steps} "
                     f"| {answer.seconds / own.seconds:.2g} |")
    (folder / "tables").mkdir(exist_ok=True)
    (folder / "tables/column.md").write_text("\n".join(lines) + "\n")
    lines = ["| point | day | computed (mm) | exact (mm) | relative difference |", "|---|---|---|---|---|"]
    for r in own.readings:
        if (r.point, r.day, r.side) in NAMED:
            day = f"{f'just {r.side} ' if r.side else ''}{r.day:g}"
            lines.append(f"| {r.point} | {day} | {1e3 * r.computed:.6f} | {1e3 * r.exact:.6f} | {r.difference:.1e} |")
    (folder / "tables/readings.md").write_text("\n".join(lines) + "\n")


def draw(answers, folder):
    studies = [("zone size", "zone size (m)"), ("tolerance", "equilibrium tolerance (-)"),
               ("creep step dT", "creep step dT (days)")]
    plot, all_axes = figure.plt.subplots(1, 3, sharey=True, figsize=(figure.TWO_COLUMNS, 2.4))
    for axes, (study, label) in zip(all_axes, studies):
        values, differences = zip(*[(run.number, answer.worst.difference) for run, answer in answers
                                    if run.study == study])
        axes.loglog(values, differences, color=figure.COLORS[0], marker="o", markerfacecolor="white")
        if study != "tolerance":
            axes.set_xticks(values, [f"{value:g}" for value in values])
            axes.set_xticks([], minor=True)
        axes.axhline(1e-3, color="0.5", linewidth=0.6, linestyle="--")
        axes.set_xlabel(label)
        axes.grid(color="0.9", linewidth=0.4)
    tolerances = [run.number for run, _ in answers if run.study == "tolerance"]
    all_axes[1].loglog(tolerances, tolerances, color="0.5", linewidth=0.6, linestyle=":")
    all_axes[1].annotate("the tolerance itself", (tolerances[-2], tolerances[-2]), xytext=(6, -2), fontsize=6.5,
                         textcoords="offset points", va="top")
    all_axes[0].annotate("wanted", (0.03, 1.15e-3), xycoords=("axes fraction", "data"), fontsize=6.5)
    all_axes[0].set_ylabel("largest relative difference\nto the closed form (-)")
    plot.savefig(folder / "column.png")


def main():
    if len(sys.argv) != 4:
        sys.exit("usage: column.py BIN SCENE.toml OUT")
    programs, folder = Path(sys.argv[1]).resolve(), Path(sys.argv[3])
    answers, known = [], {}
    with tempfile.TemporaryDirectory() as scratch:
        for run in runs_of(Path(sys.argv[2]).read_text()):
            key = (run.scene, *run.options)
            if key not in known:  # the scene's own settings are part of three studies
                try:
                    known[key] = answer_of(run, programs, Path(scratch))
                except subprocess.CalledProcessError as error:
                    sys.exit(f"column.py: {run.study}, {run.value}: "
                             f"{os.path.basename(error.cmd[0])} ended with exit code {error.returncode}")
            answers.append((run, known[key]))
            print(f"{run.study}, {run.value}: {known[key].worst.difference:.1e}", flush=True)
    own = answers[0][1]
    write_tables(answers, own, folder)
    write_markdown(answers, own, folder)
    draw(answers, folder)


if __name__ == "__main__":
    main()
