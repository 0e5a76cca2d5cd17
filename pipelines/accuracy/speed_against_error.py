#!/usr/bin/python3
"""Speed against error: what every engine, creep scheme, step, tolerance and zone size costs, and what it gives.

    speed_against_error.py BIN DATA OUT [--quick]

runs the programs in BIN on scenes of the folder DATA and writes into OUT
    runs.csv                     one row a run: options, cost, errors
    cases.md                     the same as tables, one a case
    tables/*.md                  what follows from them, for docs/accuracy.md and docs/verification.md
    creep-steps.png              force error over equilibria, platens and two pillars, every K/E
    force-time.png, displacement-time.png, force-equilibria.png      every case, one panel each

Time is processor time of demsolve, user and system, over that of the unit: the column as its scene says, run by the
dynamic relaxation. The files that demsolve writes are part of it.
"""

import csv
import datetime
import functools
import math
import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import cases as of
import errors
import pillars
import speed_plots
from jointcreep import chain

OUTCOMES = {2: "refused", 3: "no equilibrium"}  # exit codes of demsolve


@dataclass
class Row:
    case: str
    run: of.Run
    outcome: str  # "done", or one of OUTCOMES
    time: float = math.nan  # of the unit's
    zones: int = 0
    equilibria: int = 0
    steps: int = 0
    factorisations: int = 0
    solves: int = 0
    displacement: float = math.nan
    traction: float = math.nan
    traction_at_the_end: float = math.nan
    metres: float = math.nan  # the largest error of a point's displacement or a joint's elastic one [m]
    opens: bool = False  # a contact, at some state


def processor_seconds(command):
    """Seconds of user and system, exit code and message of a program."""
    with tempfile.TemporaryFile() as message:
        one_thread = dict(os.environ, OMP_NUM_THREADS="1")  # threads that wait for others count as processor time
        child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=message, env=one_thread)
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)  # or Popen waits for it again
        message.seek(0)
        return usage.ru_utime + usage.ru_stime, child.returncode, message.read().decode().strip()


class Programs:
    def __init__(self, folder, data, scratch):
        self.folder, self.data, self.scratch = folder, data, scratch
        self.offer = of.offer_of(folder / "demsolve")

    def prepare(self, scene):
        """The joints file of a scene's text."""
        return chain.joints_of(self.folder, scene, self.scratch)

    def solve(self, joints, options, every_state=False):
        """Seconds, exit code, message and result of demsolve."""
        result = self.scratch / "result.h5"
        states = ["--states", "1"] if every_state else []
        seconds, code, message = processor_seconds(
            [self.folder / "demsolve", joints, "-q", "-o", result, *options, *states])
        return seconds, code, message, errors.result_of(result) if code == 0 else None


def errors_of(case, programs, joints):
    """The case's measure of error, by engine: its closed form, or its converged solution, which is computed here.

    Each engine has its own converged solution: where joints slip, the answer depends on the way (slip_table).
    """
    if case.error:
        return {engine: case.error for engine in programs.offer.engines}
    found = {}
    for engine in programs.offer.engines:
        run = next(run for run in case.references if run.engine == engine and programs.offer.has(run))
        _, code, message, reference = programs.solve(joints, run.options(programs.offer), case.every_state)
        if code != 0:
            sys.exit(f"speed_against_error.py: {case.name}, converged solution: {message}")
        found[engine] = functools.partial(errors.against, reference=reference)
    return found


def finest_zones(rows_and_results):
    """With other zones the converged solution is that of the finest, by the last engine that computed it."""
    return min(reversed(rows_and_results), key=lambda pair: pair[0].run.zone_size)[1]


def rows_of(case, programs, unit):
    joints = programs.prepare(case.scene)
    error = errors_of(case, programs, joints)
    rows, zoned = [], []
    for run in case.runs:
        if not programs.offer.has(run):
            continue
        seconds, code, message, result = programs.solve(joints, run.options(programs.offer), case.every_state)
        if code != 0:
            if code not in OUTCOMES:
                sys.exit(f"speed_against_error.py: {case.name}, {run}: exit code {code}: {message}")
            rows.append(Row(case.name, run, OUTCOMES[code], seconds / unit))
            continue
        row = Row(case.name, run, "done", seconds / unit, result.zones, result.equilibria, result.steps,
                  result.factorisations, result.solves, opens=bool((result.status == 3).any()))
        if run.study == "zone size" and not case.error:
            zoned.append((row, result))
        else:
            found = error[run.engine or programs.offer.fastest](result)
            row.displacement, row.traction = found.displacement, found.traction
            row.traction_at_the_end, row.metres = found.traction_at_the_end, found.metres
        rows.append(row)
    for row, result in zoned:
        if result is not finest_zones(zoned):
            row.displacement = errors.against(result, finest_zones(zoned)).displacement
    print(f"{case.name}: {len(rows)} runs, {unit * sum(row.time for row in rows):.1f} s", flush=True)
    return rows


# Tables


def number(value, form=".1e"):
    return "" if value is None or not math.isfinite(value) else f"{value:{form}}"


def table(head, lines):
    return ["| " + " | ".join(head) + " |", "|" + "---|" * len(head),
            *("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines), ""]


def write_csv(rows, path):
    with open(path, "w", newline="") as file:
        out = csv.writer(file)
        out.writerow(["case", "study", "engine", "scheme", "step_days", "creep_tolerance_m", "tolerance", "zone_size_m",
                      "outcome", "zones", "equilibria", "steps", "factorisations", "back_substitutions", "time",
                      "displacement_error", "force_error", "force_error_at_the_end", "error_m"])
        for row in rows:
            run = row.run
            out.writerow([row.case, run.study, run.engine, run.scheme, run.step, run.creep_tolerance, run.tolerance,
                          run.zone_size, row.outcome, row.zones, row.equilibria, row.steps, row.factorisations,
                          row.solves, row.time, row.displacement, row.traction, row.traction_at_the_end, row.metres])


def case_table(case, rows):
    lines = []
    for row in rows:
        run = row.run
        varied = {"creep step": f"dT {run.step or 0:g} day", "creep tolerance": f"{run.creep_tolerance or 0:g} m",
                  "tolerance": f"tolerance {run.tolerance or 0:g}", "zone size": f"zones {run.zone_size or 0:g} m",
                  "default": "nothing: the defaults"}[run.study]
        cells = [row.equilibria, row.steps, row.factorisations, row.solves, number(row.time, ".2g"),
                 number(row.displacement), number(row.traction)]
        lines.append([varied, run.engine, run.scheme, *([row.zones, *cells] if row.outcome == "done"
                                                        else [row.outcome, *[""] * 7])])
    return [f"## {case.title}", "", *table(["varied", "engine", "scheme", "zones", "equilibria", "steps",
                                            "factorisations", "back-substitutions", "time", "displacement error",
                                            "force error"], lines)]


def at_step(rows, case, scheme, step, engine):
    found = [row for row in rows if row.case == case and row.run.scheme == scheme and row.run.engine == engine
             and row.run.step is not None and math.isclose(row.run.step, step)]
    return found[0] if found else None


def steps_table(rows, offer, steps, suffix):
    """Force error of every scheme at these steps, K/E by K/E."""
    def cell(row):
        if row is None:
            return ""
        return row.outcome if row.outcome != "done" else number(row.traction) + (" opens" if row.opens else "")

    lines = []
    for kind in ("platens", "two pillars"):
        for ratio in of.RATIOS:
            found = [[at_step(rows, f"{kind} {ratio:g}{suffix}", scheme, step, offer.fastest) for step in steps]
                     for scheme in offer.schemes]
            if any(row is not None for of_scheme in found for row in of_scheme):
                lines.append([kind, f"{ratio:g}", *(" / ".join(cell(row) for row in of_scheme) for of_scheme in found)])
    return table(["case", "K/E", *offer.schemes], lines)


def cheapest_table(rows, cases, levels=(1e-2, 1e-3, 1e-4, 1e-5)):
    """The cheapest run of each engine whose errors, displacement and force, are both below a level."""
    lines = []
    for case in cases:
        engines = sorted({row.run.engine for row in rows if row.case == case.name and row.run.engine})
        for engine in engines:
            cells = []
            for level in levels:
                good = [row for row in rows if row.case == case.name and row.run.engine == engine
                        and row.run.study != "zone size" and max(row.displacement, row.traction) <= level]
                best = min(good, key=lambda row: row.time, default=None)
                cells.append("" if best is None else f"{best.time:.2g} ({best.equilibria})")
            lines.append([case.title, engine, *cells])
    return table(["case", "engine", *(f"{level:g}" for level in levels)], lines)


def defaults_table(rows, cases):
    """What demsolve gives without options."""
    lines = []
    for case in cases:
        for row in rows:
            if row.case == case.name and row.run.study == "default" and row.outcome == "done":
                lines.append([case.title, row.zones, row.equilibria, row.factorisations, row.solves,
                              number(row.time, ".2g"), number(row.displacement), number(row.traction)])
    return table(["case", "zones", "equilibria", "factorisations", "back-substitutions", "time", "displacement error",
                  "force error"], lines)


def zones_table(rows, cases):
    """What zones change where stress is not uniform."""
    lines = []
    for case in (case for case in cases if case.references):
        for row in rows:
            if row.case == case.name and row.run.study == "zone size":
                lines.append([case.title, row.run.engine, f"{row.run.zone_size:g}", row.zones, row.equilibria,
                              number(row.time, ".2g"), number(row.displacement)])
    return table(["case", "engine", "zone size (m)", "zones", "equilibria", "time", "difference to the finest"], lines)


def slip_table(programs, data, unit):
    """What overshooting and long increments change where joints slip.

    Spurious slip is the largest difference of a contact's slip, at the states of the file, to the slowest way.
    """
    damped = 'masses = "real"\ndamping = "mass"\nmass_damping_per_s = '
    ways = [("adaptive damping", ""), ("local damping", 'damping = "local"'), ("real masses, 800 /s", damped + "800"),
            ("real masses, 80 /s", damped + "80")]
    lines = []
    for title, scene, most in (("friction stack", "verification/friction-stack", 256),
                               ("slope with opening joints", "verification/opening-joints", 256),
                               ("slope with slip", "slope", 64)):
        text = of.with_default_equilibrium((data / scene / "scene.toml").read_text())
        found = []
        for engine in reversed(programs.offer.engines):
            for way, settings in ways if engine == "relaxation" and title == "friction stack" else [("", "")]:
                for increments in (most, 16, 1) if way in ("", "adaptive damping") else (16, 1):
                    joints = programs.prepare(f"{text}\n[equilibrium]\nunloading_increments = {increments}\n"
                                              f"most_steps = 20000000\n{settings}\n")
                    options = [*of.Run("slip", engine, tolerance=1e-8).options(programs.offer), "--no-creep"]
                    seconds, code, message, result = programs.solve(joints, options)
                    if code not in (0, *OUTCOMES):
                        sys.exit(f"speed_against_error.py: {title}, {engine}, {way}: {message}")
                    found.append((engine, way, increments, seconds / unit, OUTCOMES.get(code, ""), result))
        slow = next(result for *_, result in found if result)
        for engine, way, increments, time, outcome, result in found:
            apart = [number(np.abs(now - then).max() / np.abs(then).max())
                     for now, then in ((result.peak, slow.peak), (result.displacement, slow.displacement))
                     ] if result else [outcome, "", ""]
            if result:
                slip, slow_slip = errors.slip_of(result), errors.slip_of(slow)
                apart.append(number(np.nanmax(np.abs(slip - slow_slip)) / np.nanmax(np.abs(slow_slip))))
            lines.append([title, engine, way, increments, result.steps if result else "", number(time, ".2g"), *apart])
    return table(["case", "engine", "damping", "increments", "steps", "time", "largest displacements",
                  "displacements at the end", "spurious slip"], lines)


def pillars_table(programs):
    """The published and the fitted step at equally many equilibria: what a pair of pillars makes of it."""
    def force_error(ratio, scheme, steps):
        text = of.stated_pillars_scene((programs.data / "verification/two-pillars/scene.toml").read_text(), ratio)
        run = of.Run("pillars", programs.offer.fastest, scheme, step=1 / of.RATE / steps, tolerance=1e-11)
        _, code, message, result = programs.solve(programs.prepare(text), run.options(programs.offer), True)
        if code == 2:
            return math.nan
        if code != 0:
            sys.exit(f"speed_against_error.py: pillars, {ratio:g}, {scheme}: {message}")
        return errors.against_closed_form(result, of.closed_forms.two_pillars(result.scene)).traction

    lines = []
    for ratio, stated, of_scene, worst, median, growth in pillars.rows():
        cells = []
        for steps in 8, 10:
            published, fitted = (force_error(ratio, scheme, steps) for scheme in ("published", "fitted"))
            cells.append(number(published / fitted, ".0f") or "refused")
        lines.append([f"{ratio:g}", f"{stated:.0f}", *cells, f"{growth:.2f}",
                      f"{pillars.gain(pillars.stated_pair(ratio), 10):.0f}", f"{of_scene:.0f}",
                      f"{median:.0f}", f"{worst:.0f}"])
    return table(["K/E", "stated pair", "by demsolve", "by demsolve, 10 steps", "published grows by",
                  "stated pair, 10 steps", "the scene's pair", "random pairs, median", "worst of 400"], lines)


def halving_table(rows, offer):
    """Force error of the wedge at every step, and the order between the last ones."""
    lines = []
    for engine in offer.engines:
        found = {scheme: [at_step(rows, "V-groove", scheme, step, engine) for step in of.HALVED]
                 for scheme in offer.schemes}
        for n, step in enumerate(of.HALVED):
            cells = []
            for scheme in offer.schemes:
                row, before = found[scheme][n], found[scheme][n - 1] if n else None
                order = "" if not before else number(math.log2(before.traction / row.traction), ".1f")
                cells.append(row.outcome if row.outcome != "done" else
                             number(row.traction) + (f" ({order})" if order else ""))
            lines.append([engine, f"{step:g}", *cells])
    return table(["engine", "dT (days)", *offer.schemes], lines)


def steps_by_error_table(rows, cases, levels=(1e-2, 1e-3, 1e-4)):
    """Equilibria that fixed steps and steps by their error take to both errors below a level, and what a tolerance is worth.

    Of the fastest engine, in the fitted scheme.
    """
    lines = []
    for case in cases:
        those = [row for row in rows if row.case == case.name and row.run.engine == "implicit"
                 and row.run.scheme == "fitted" and row.outcome == "done"]
        fixed, chosen = ([row for row in those if row.run.study == study] for study in ("creep step", "creep tolerance"))
        if not chosen:
            continue
        cells = []
        for level in levels:
            best = [min((row.equilibria for row in some if max(row.displacement, row.traction) <= level), default=None)
                    for some in (fixed, chosen)]
            cells.append(" / ".join("-" if n is None else str(n) for n in best))
        worth = [row.metres / row.run.creep_tolerance for row in chosen if math.isfinite(row.metres)]
        lines.append([case.title, *cells, *(f"{pick(worth):.2g}" for pick in (min, max))])
    return table(["case", *(f"{level:g}: fixed / chosen" for level in levels), "error / tolerance, least", "most"],
                 lines)


def write_tables(rows, cases, offer, slip, of_pillars, column_seconds, version, folder):
    shown = [case for case in cases if not case.is_long]
    tables = {"computed": [f"Computed on {datetime.date.today()} with version {version}."],
              "defaults": defaults_table(rows, shown),
              "cheapest": cheapest_table(rows, shown),
              "eight-steps": steps_table(rows, offer, [1 / of.RATE / 8], ""),
              "long-steps": steps_table(rows, offer, of.LONG_STEPS, ", long"),
              "zone-sizes": zones_table(rows, shown),
              "slip": slip,
              "pillars": of_pillars,
              "steps-by-error": steps_by_error_table(rows, shown),
              "halving": halving_table(rows, offer) if any(row.case == "V-groove" for row in rows) else [],
              "column-implicit": [column_line(rows, column_seconds)]}
    (folder / "tables").mkdir(exist_ok=True)
    for name, lines in tables.items():
        (folder / "tables" / f"{name}.md").write_text("\n".join(lines).rstrip() + "\n")
    lines = [*tables["computed"], ""]
    for case in shown:
        lines += case_table(case, [row for row in rows if row.case == case.name])
    (folder / "cases.md").write_text("\n".join(lines))


def column_line(rows, unit):
    """The column by the implicit engine, at its default tolerance."""
    row = next((row for row in rows if row.case == "column" and row.run.study == "default"), None)
    if row is None:
        return ""
    return (f"With the implicit engine the column's displacements at the end are within {number(row.displacement)} of the closed "
            f"form, its tractions at all steps within {number(row.traction)} (both relative to the largest). This takes "
            f"{unit * row.time:.2g} s with reading and writing; dynamic relaxation, as the scene says, takes {unit:.2g} s.")


def main():
    quick = "--quick" in sys.argv
    arguments = [a for a in sys.argv[1:] if a != "--quick"]
    if len(arguments) != 3:
        sys.exit("usage: speed_against_error.py BIN DATA OUT [--quick]")
    binaries, data, out = (Path(a).resolve() for a in arguments)
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        programs = Programs(binaries, data, Path(scratch))
        joints = programs.prepare((data / "column/scene.toml").read_text())
        unit, code, message, result = programs.solve(joints, of.Run("unit", "relaxation").options(programs.offer))
        if code != 0:
            sys.exit(f"speed_against_error.py: the column: {message}")
        cases = (of.quick_cases if quick else of.all_cases)(data, programs.offer)
        rows = [row for case in cases for row in rows_of(case, programs, unit)]
        slip = [] if quick else slip_table(programs, data, unit)
        of_pillars = [] if quick else pillars_table(programs)
        write_csv(rows, out / "runs.csv")
        write_tables(rows, cases, programs.offer, slip, of_pillars, unit, result.version, out)
        speed_plots.draw(rows, [case for case in cases if not case.is_long], programs.offer, out)


if __name__ == "__main__":
    main()
