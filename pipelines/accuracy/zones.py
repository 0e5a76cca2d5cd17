#!/usr/bin/python3
"""Zones of constant strain and quadratic zones side by side, where rock bends and where it yields: error, zones and time.

    zones.py PROGRAMS DATA OUT [--quick]

Writes OUT/zones.csv, and OUT/tables/zones.md and zones-equal-error.md, for the page docs/verification.md. Times are
processor seconds of demsolve on one thread, the shorter of two runs where they are below a second; a factor of safety is a
dozen runs. --quick leaves out the smallest zones, and the cases that are compared with a run of still smaller ones.
"""

import csv
import math
import resource
import sys
import tempfile
from dataclasses import astuple, dataclass, fields
from pathlib import Path

import closed_forms
import literature
import numpy as np
from literature import changed

KINDS = "constant strain", "quadratic"


@dataclass
class Run:
    case: str
    zones: str
    across: float  # zones over the length of the case
    number: int
    gridpoints: int
    exact: float
    computed: float
    error: float
    seconds: float


@dataclass
class Case:
    """exact: the closed form, or None where the quadratic zones `finest` over the length give the answer."""

    name: str
    text: str
    length: float  # that is divided into `across` zones [m]
    exact: float | None
    answer: object  # from a result: a number, or an array of them
    across: tuple  # of constant strain, quadratic
    options: tuple = ()
    finest: float = 0


def tip(result):
    return -result.point("tip")[1]


def points(result):
    """Displacements of all points in all recorded states [m]."""
    return result["/history/displacement"]


def punch_pressure(result):
    """Mean pressure under the punch over the cohesion; half the punch is 1 m."""
    place = result["/mesh/gridpoint_position"]
    under = (np.abs(place[:, 1] - 3) < 1e-9) & (place[:, 0] < 1 + 1e-9)
    return -result["/states/reaction"][-1][under, 1].sum() / (1e6 * result.scene["rock"][0]["cohesion_MPa"])


def factor(result):
    """The largest factor with which the slope stands."""
    return result["/safety/factor"][result["/safety/stands"] == 1].max()


LENGTH, DEPTH, FORCE = 10, 1, 0.01e6  # of the cantilever: m, m, N/m


def with_strong_joint(text, k_n, k_s):
    """The scene with the material of a joint that neither opens nor slips; stiffnesses in Pa/m."""
    return changed(text, r"^\[in_situ_stress\]", f"""[[joint_material]]
name = "joint"
normal_stiffness_MPa_per_m = {k_n / 1e6:g}
shear_stiffness_MPa_per_m = {k_s / 1e6:g}
cohesion_MPa = 100
friction_angle_deg = 30
tensile_strength_MPa = 100

[in_situ_stress]""")


def column_on_a_joint(cantilever, elastic):
    """The cantilever on a joint in place of the clamp, which lets it rotate and move, with its exact deflection [m]."""
    k_n, k_s = 5e9, 2e9
    text = with_strong_joint(changed(cantilever, '^fix = "xy"', 'joint = "joint"'), k_n, k_s)
    return text, (closed_forms.cantilever_deflection(LENGTH, DEPTH, FORCE, *elastic)
                  + FORCE / (k_s * DEPTH) + FORCE * LENGTH**2 / (k_n * DEPTH**3 / 12))


def two_slabs(cantilever, elastic):
    """Two of the cantilevers, one on the other, with a joint between them, and their exact deflection [m]."""
    k_n, k_s = 50e9, 0.2e9
    text = with_strong_joint(cantilever, k_n, k_s)
    text = changed(text, r"^outline_m = .*", f"outline_m = [[0, 0], [{LENGTH}, 0], [{LENGTH}, 2], [0, 2]]")
    text = changed(text, r"^to_m = \[0, 1\]", "to_m = [0, 2]")
    text = changed(text, rf"^to_m = \[{LENGTH}, 1\]", f"to_m = [{LENGTH}, 2]")
    text = changed(text, r"^\[\[boundary\]\]\nfrom_m = \[0, 0\]", f"""[[joint]]
name = "between the slabs"
from_m = [0, 1]
to_m = [{LENGTH}, 1]
material = "joint"

[[boundary]]
from_m = [0, 0]""")
    return text, closed_forms.two_slabs_deflection(LENGTH, DEPTH, 2 * FORCE, *elastic, k_s)


def elastic_cases(programs):
    cantilever, hole, slabs = (programs.text(name) for name in ("cantilever", "hole", "opening-joints"))
    slope, lock = ((programs.data / name).read_text() for name in ("slope/scene.toml", "shiplock/section-a.toml"))
    # Half a radius inside the rock: at the corners of the polygon displacements depend on the zones there.
    hole = changed(changed(hole, r"^at_m = \[1\.000001, 0\]", "at_m = [1.5, 0]"), r"^at_m = \[0, 1\.000001\]", "at_m = [0, 1.5]")
    elastic = literature.elastic_of(literature.tomllib.loads(cantilever))
    column, column_exact = column_on_a_joint(cantilever, elastic)
    slabs_of_two, slabs_exact = two_slabs(cantilever, elastic)
    beam = 1, 2, 4
    return [
        Case("cantilever: deflection of the tip", cantilever, 1, None, tip, ((1, 2, 4, 8, 16), beam), finest=16),
        Case("column on an elastic joint: deflection of the tip", column, 1, column_exact, tip, ((1, 2, 4, 8, 16), beam)),
        Case("two slabs with a joint between them: deflection of the tip", slabs_of_two, 1, slabs_exact, tip,
             ((1, 2, 4, 8, 16), beam)),
        Case("hole: displacements half a radius beside and above it", hole, 1, None, points, ((5, 10, 20, 40), (2.5, 5, 10)),
             finest=40),
        Case("slabs that lean and bend on opening joints: displacements of the points", slabs, 10, None, points,
             ((2, 4, 8, 16), (1, 2, 4, 8)), finest=16),
        Case("bench slope: displacements of the points", slope, 12, None, points, ((1, 2, 4, 8, 16), (1, 2, 4, 8)), finest=16),
        Case("shiplock: displacements of the points", lock, 16, None, points, ((1, 2, 4, 8), (0.5, 1, 2, 4)),
             finest=8)]


def yielding_cases(programs):
    punch, cut, slope = (programs.text(name) for name in ("punch", "vertical-cut", "homogeneous-slope"))
    pressed = changed(punch, '^fix = "xy"\ndisplacement_mm = .*', "traction_MPa = [0, -0.257079632679]")
    pressed = changed(pressed, "^load_history = .*", "load_history = [[0, 0], [1, 1]]")
    safety = "--factor-of-safety", "--safety-width", "0.004", "--no-mesh-estimate"
    soft = changed(slope, "^dilation_angle_deg = 20", "dilation_angle_deg = 0")
    return [
        Case("rigid punch: pressure over cohesion", punch, 1, 2 + math.pi, punch_pressure, ((2, 4, 8, 16), (2, 4, 8))),
        Case("punch by pressure: factor of safety", pressed, 1, 2, factor, ((2, 4, 8), (2, 4)), safety),
        Case("vertical cut: factor of safety", cut, 6, 1.199, factor, ((3, 6, 12, 24), (3, 6, 12, 24)), safety),
        Case("slope, psi = phi: factor of safety", slope, 10, 1.368, factor, ((2.5, 5, 10, 20), (2.5, 5, 10, 20)),
             safety),
        Case("slope, psi = 0: factor of safety", soft, 10, 1.368, factor, ((2.5, 5, 10, 20), (2.5, 5, 10)),
             safety)]


def solved(case, kind, across, programs):
    """The result, and processor seconds of demsolve."""
    text = changed(case.text, r"^\[zones\]\n(kind = .*\n)?size_m = [0-9.]+",
                   f'[zones]\nkind = "{kind}"\nsize_m = {case.length / across:.12g}')

    joints = programs.joints(text)

    def once():
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        path, code, message = programs.solved(joints, "--threads", 1, *case.options)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        if code != 0:
            raise RuntimeError(f"{case.name}, {kind}, {across:g}: exit code {code}: {message}")
        return literature.Result(path), after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    result, seconds = once()
    return result, seconds if seconds > 1 else min(seconds, once()[1])


def runs_of(case, programs, quick):
    if case.finest and quick:
        return
    exact = case.exact if case.exact is not None else case.answer(solved(case, KINDS[1], case.finest, programs)[0])
    for kind, counts in zip(KINDS, case.across):
        for across in counts[:2] if quick else counts:
            result, seconds = solved(case, kind, across, programs)
            computed = case.answer(result)
            off, scale = np.abs(computed - exact).max(), np.abs(exact).max()
            error = off / scale if np.ndim(exact) else computed / exact - 1
            run = Run(case.name, kind, across, len(result["/mesh/zone_block"]), len(result["/mesh/gridpoint_position"]),
                      float(scale), float(np.abs(computed).max()), float(error), seconds)
            print(f"{case.name}, {kind}, {across:g}: error {100 * run.error:+.2g} percent, {seconds:.2g} s", file=sys.stderr)
            yield run


def table(runs):
    lines = ["| case | zones | over the length | number | gridpoints | error, percent | seconds |", "|---|---|---|---|---|---|---|"]
    last = None
    for run in runs:
        lines.append(f"| {run.case if run.case != last else ''} | {run.zones} | {run.across:g} | {run.number} | "
                     f"{run.gridpoints} | {100 * run.error:+.2g} | {run.seconds:.2g} |")
        last = run.case
    return "\n".join(lines) + "\n"


def seconds_for(error, runs):
    """Time of a kind for an error: between two runs along a line in the logarithms. (seconds, what it is)."""
    runs = sorted(runs, key=lambda run: run.seconds)
    runs = [run for i, run in enumerate(runs) if all(abs(run.error) < abs(faster.error) for faster in runs[:i])]
    good = [i for i, run in enumerate(runs) if abs(run.error) <= error]
    if not good:
        return runs[-1].seconds, "above "
    i = good[0]
    if i == 0:
        return runs[0].seconds, "below " if abs(runs[0].error) < error else ""
    worse, better = runs[i - 1], runs[i]
    share = math.log(abs(worse.error) / error) / math.log(abs(worse.error) / abs(better.error))
    return worse.seconds * (better.seconds / worse.seconds)**share, ""


def equal_error(runs):
    """For each case: what the zones of constant strain cost with the error of each of their runs, and quadratic zones with the
    same error."""
    lines = ["| case | error, percent | constant strain, s | quadratic, s | ratio |", "|---|---|---|---|---|"]
    for case in dict.fromkeys(run.case for run in runs):
        of_kind = [[run for run in runs if (run.case, run.zones) == (case, kind)] for kind in KINDS]
        for run in of_kind[0]:
            seconds, about = seconds_for(abs(run.error), of_kind[1])
            sign = {"below ": "above ", "above ": "below ", "": ""}[about]
            lines.append(f"| {case if run is of_kind[0][0] else ''} | {100 * abs(run.error):.2g} | {run.seconds:.2g} | "
                         f"{about}{seconds:.2g} | {sign}{run.seconds / seconds:.2g} |")
    return "\n".join(lines) + "\n"


def main():
    if len(sys.argv) not in (4, 5) or sys.argv[4:] not in ([], ["--quick"]):
        sys.exit("usage: zones.py PROGRAMS DATA OUT [--quick]")
    out = Path(sys.argv[3])
    (out / "tables").mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="jointcreep-") as folder:
        programs = literature.Programs(Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve(), folder)
        runs = [run for case in elastic_cases(programs) + yielding_cases(programs)
                for run in runs_of(case, programs, sys.argv[4:] != [])]
    with open(out / "zones.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow([field.name for field in fields(Run)])
        writer.writerows(astuple(run) for run in runs)
    (out / "tables/zones.md").write_text(table(runs))
    (out / "tables/zones-equal-error.md").write_text(equal_error(runs))


if __name__ == "__main__":
    main()
