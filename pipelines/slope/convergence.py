#!/usr/bin/python3
"""What halving the zone size, the creep step (or its tolerance) and the tolerance changes.

    convergence.py PROGRAMS JOINTS.h5 [--engine ENGINE] [--component x] [--readings] -o OUT

runs demsolve with the scene's own choices and with each of the three halved, and compares the displacements of every
monitoring point on every recorded day, from the first row on which the point is there to the last: vectors, or one component of
them; with --readings also those since each point's first reading, from there on. In OUT it writes
    convergence.md    the largest change of each point, and what the runs cost, as tables
    convergence.csv   the same changes, and where each is largest
Result files are removed. A run that finds no equilibrium, or is refused, is named with its reason in place of its
changes, and does not stop the others; the exit code is then 1.

Rows at dates (stages, first readings, the end), before and after what happens then, are in all runs and are compared as
they are. Between dates, creep steps of another length have rows on other days: what the halved run has on a day of the
scene's own is then interpolated by a cubic through its four nearest rows between the same two dates. How much that is
worth is in the second table: the largest difference to the parabola through three of them. (For creep that takes 60
days, and rows 7 days apart, the cubic is right to 4e-6 of what creeps, the parabola to 8e-5.)
"""

import argparse
import csv
import dataclasses
import io
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

import numpy as np

import jointcreep
from jointcreep import NotWanted, files, histories

HALVED = [  # option of demsolve, table and key of the scene, what it is called, unit
    ("zone-size", "zones", "size_m", "zone size", "m"),
    ("creep-step", "creep", "step_days", "creep step", "day"),  # a scene has this one
    ("creep-tolerance", "creep", "tolerance_m", "creep tolerance", "m"),  # or this one
    ("tolerance", "equilibrium", "tolerance", "tolerance", ""),
]


@dataclasses.dataclass
class Run:
    label: str
    reason: str = ""  # why there is no result
    time: np.ndarray | None = None  # [row] [day]
    displacement: np.ndarray | None = None  # [row, point, 2] [m]
    present: np.ndarray | None = None  # [row, point]
    first: np.ndarray | None = None  # [point] row of its first reading
    points: tuple = ()
    stages: np.ndarray | None = None  # [row] how many there have been
    dates: np.ndarray | None = None  # on which something happens [day]
    zones: int = 0
    contacts: int = 0
    equilibria: int = 0
    steps: int = 0  # of the solver
    seconds: float = 0  # of processor time


def default_of(programs, table, key):
    """The default of a scene's key, as jointgen lists it; None if it has none."""
    listed = subprocess.run([programs / "jointgen", "--scene-keys"], check=True, capture_output=True, text=True).stdout
    for row in csv.DictReader(io.StringIO(listed), delimiter="\t", quoting=csv.QUOTE_NONE):
        if (row["table"], row["key"]) == (table, key):
            try:
                return float(row["default"])
            except ValueError:
                return None
    return None


def read(path, run, component=None):
    file = jointcreep.read(path)
    history, steps = file.history(), file["/equilibria/steps"]
    run.time, run.stages, run.dates, run.points = history.time, history.stages(), history.dates, tuple(history.point)
    run.displacement, run.present, run.first = history.displacement, history.present, history.first_reading_row
    if component:
        run.displacement[:, :, "yx".index(component)] = 0
    run.zones, run.contacts = len(file["/mesh/zone_block"]), len(file["/mesh/contact_edge"])
    run.equilibria, run.steps = len(steps), int(steps.sum())


def since_first_reading(run):
    """The run with displacements that count from each point's first reading, before which there are none."""
    if run.reason:
        return run
    rows = np.arange(len(run.time))[:, None]
    points = np.arange(len(run.points))
    return dataclasses.replace(run, displacement=run.displacement - run.displacement[run.first, points],
                               present=run.present & (rows >= run.first))


def solved(programs, joints, label, options, component=None):
    """A run of demsolve."""
    run = Run(label)
    with tempfile.TemporaryDirectory(prefix="jointcreep-") as folder:
        result = pathlib.Path(folder) / "result.h5"
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run([programs / "demsolve", joints, "-o", result, "--quiet", *options], capture_output=True,
                              text=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        run.seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        if done.returncode == 0:
            read(result, run, component)
        else:
            run.reason = f"exit code {done.returncode}: {' '.join(done.stderr.split())}"
    return run


def row_at(run, stages, day, dates):
    """Displacement [point, 2] of a run on a day, after so many stages, and which points are there; None if the run has
    ended before. Between dates it is interpolated; the last value is the uncertainty of that [m]."""
    return histories.at(run.time, run.stages, dates, run.displacement, run.present, day, stages)


def changes(own, other):
    """Displacement of `other` less that of `own` [row of own, point, 2], where both have one [row, point], and the
    largest uncertainty of interpolation [m]."""
    if own.points != other.points or own.stages[-1] != other.stages[-1]:
        raise NotWanted(f"{other.label}: points or stages are not the scene's")
    found = np.zeros_like(own.displacement)
    both = np.zeros_like(own.present)
    uncertainty = 0.0
    for row, (day, stages) in enumerate(zip(own.time, own.stages)):
        at = row_at(other, stages, day, own.dates)
        if at is not None:
            found[row] = at[0] - own.displacement[row]
            both[row] = at[1] & own.present[row]
            uncertainty = max(uncertainty, at[2])
    return found, both, uncertainty


def size(vectors):
    return np.linalg.norm(vectors, axis=-1)


def largest_move(run, point):
    """How far the point is displaced at most [m]."""
    return float(np.max(size(run.displacement[:, point])[run.present[:, point]], initial=0))


def largest_change(own, other, point):
    """Largest change of the point [m], and its row."""
    found, both, _ = changes(own, other)
    change = np.where(both[:, point], size(found[:, point]), -1)
    row = int(np.argmax(change))
    return float(max(change[row], 0)), row


def percent(change, move):
    return f"{100 * change / move:.2g} %" if move > 0 else "-"


def changes_table(own, others, what):
    """Lines of Markdown: what each run changes at each point."""
    heads = " | ".join(run.label for run in others)
    lines = [f"| point | {what}, largest (mm) | {heads} |", "|---" * (2 + len(others)) + "|"]
    for point, name in enumerate(own.points):
        move = largest_move(own, point)
        cells = []
        for run in others:
            if run.reason:
                cells.append("-")
                continue
            change, _ = largest_change(own, run, point)
            cells.append(f"{1e3 * change:.2g} mm, {percent(change, move)}")
        lines.append(f"| {name} | {1e3 * move:.3f} | {' | '.join(cells)} |")
    return lines


def markdown(own, others, what, readings):
    lines = changes_table(own, others, what)
    if readings:
        lines += ["", *changes_table(since_first_reading(own), [since_first_reading(run) for run in others],
                                     f"{what} since the first reading")]
    lines += ["", "| run | zones | contacts | equilibria | solver steps | processor time (s) | interpolation (mm) |",
              "|---" * 7 + "|"]
    for run in [own, *others]:
        if run.reason:
            lines.append(f"| {run.label} | {run.reason} | | | | | |")
            continue
        uncertainty = 1e3 * changes(own, run)[2]
        lines.append(f"| {run.label} | {run.zones} | {run.contacts} | {run.equilibria} | {run.steps} "
                     f"| {run.seconds:.0f} | {f'{uncertainty:.1g}' if uncertainty > 0 else 'none'} |")
    return "\n".join(lines) + "\n"


def table(own, others):
    text = io.StringIO()
    out = csv.writer(text, lineterminator="\n")
    out.writerow(["changed", "point", "largest_displacement_m", "largest_change_m", "on_day", "after_stages"])
    for run in others:
        for point, name in enumerate(own.points):
            if not run.reason:
                change, row = largest_change(own, run, point)
                out.writerow([run.label, name, largest_move(own, point), change, float(own.time[row]),
                              int(own.stages[row])])
    return text.getvalue()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", metavar="PROGRAMS", type=pathlib.Path)
    parser.add_argument("joints", metavar="JOINTS.h5", type=pathlib.Path)
    parser.add_argument("--engine", help="handed on to demsolve")
    parser.add_argument("--component", choices=["x", "y"], help="of the displacements; default: vectors")
    parser.add_argument("--readings", action="store_true", help="displacements since first readings, too")
    parser.add_argument("-o", "--output", metavar="OUT", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    engine = ["--engine", arguments.engine] if arguments.engine else []
    try:
        scene = jointcreep.read(arguments.joints).scene
        runs = [("the scene's own", [])]
        for option, section, key, name, unit in HALVED:
            if section == "creep" and key not in scene.get("creep", {}):
                continue
            own = scene.get(section, {}).get(key) or default_of(arguments.programs, section, key)
            if own is None:
                raise NotWanted(f"neither the scene nor jointgen --scene-keys has a value of {section} {key}")
            runs.append((f"{name} {own:g} to {own / 2:g} {unit}".strip(), [f"--{option}", repr(own / 2)]))
        found = []
        for label, options in runs:
            start = time.monotonic()
            found.append(solved(arguments.programs, arguments.joints, label, [*engine, *options], arguments.component))
            if found[0].reason:
                raise NotWanted(f"{label}: {found[0].reason}")
            print(f"{label}: {found[-1].reason or f'{time.monotonic() - start:.0f} s'}", flush=True)
        own, *others = found
        what = {None: "displacement", "x": "horizontal displacement", "y": "vertical displacement"}[arguments.component]
        words = markdown(own, others, what, arguments.readings)
        files.write_text(arguments.output / "convergence.md", words)
        files.write_text(arguments.output / "convergence.csv", table(own, others))
    except (NotWanted, subprocess.CalledProcessError) as error:
        sys.exit(f"convergence.py: {error}")
    except (OSError, KeyError) as error:
        print(f"convergence.py: {error}", file=sys.stderr)
        sys.exit(4)
    print(words, end="")
    print(f"in {arguments.output}: convergence.md convergence.csv")
    sys.exit(1 if any(run.reason for run in others) else 0)


if __name__ == "__main__":
    main()
