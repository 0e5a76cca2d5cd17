#!/usr/bin/python3
"""Zones of constant strain and quadratic zones side by side, where rock bends and where it yields: error, zones and time.

    zones.py PROGRAMS DATA OUT [--quick]

Writes OUT/zones.csv and OUT/tables/zones.md, for the page docs/verification.md. Times are processor seconds of the chain on
one thread; a factor of safety is a dozen runs. --quick leaves out the smallest zones.
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
    across: float  # zones over the height, depth or half width
    number: int
    gridpoints: int
    exact: float
    computed: float
    seconds: float

    @property
    def error(self):
        return self.computed / self.exact - 1


@dataclass
class Case:
    name: str
    text: str
    length: float  # that is divided into `across` zones [m]
    exact: float
    answer: object  # from a result
    across: tuple  # of constant strain, quadratic
    options: tuple = ()


def deflection(result):
    return -result.point("tip")[1]


def punch_pressure(result):
    """Mean pressure under the punch over the cohesion; half the punch is 1 m."""
    place = result["/mesh/gridpoint_position"]
    under = (np.abs(place[:, 1] - 3) < 1e-9) & (place[:, 0] < 1 + 1e-9)
    return -result["/states/reaction"][-1][under, 1].sum() / (1e6 * result.scene["rock"][0]["cohesion_MPa"])


def factor(result):
    """The largest factor with which the slope stands."""
    return result["/safety/factor"][result["/safety/stands"] == 1].max()


def all_cases(programs):
    cantilever, punch, cut, slope = (programs.text(name) for name in ("cantilever", "punch", "vertical-cut",
                                                                      "homogeneous-slope"))
    elastic = literature.elastic_of(literature.tomllib.loads(cantilever))
    pressed = changed(punch, '^fix = "xy"\ndisplacement_mm = .*', "traction_MPa = [0, -0.257079632679]")
    pressed = changed(pressed, "^load_history = .*", "load_history = [[0, 0], [1, 1]]")
    safety = "--factor-of-safety", "--safety-width", "0.004"
    return [
        Case("cantilever: deflection of the tip [m]", cantilever, 1,
             closed_forms.cantilever_deflection(10, 1, 0.01e6, *elastic), deflection, ((1, 2, 4, 8, 16), (1, 2, 4))),
        Case("rigid punch: pressure over cohesion", punch, 1, 2 + math.pi, punch_pressure, ((2, 4, 8, 16), (2, 4, 8))),
        Case("punch by pressure: factor of safety", pressed, 1, 2, factor, ((2, 4, 8, 16), (2, 4, 8)), safety),
        Case("vertical cut: factor of safety", cut, 6, 1.199, factor, ((3, 6, 12, 24), (3, 6, 12)), safety),
        Case("slope, psi = phi: factor of safety", slope, 10, 1.368, factor, ((2.5, 5, 10, 20), (2.5, 5, 10)), safety),
        Case("slope, psi = 0: factor of safety", changed(slope, "^dilation_angle_deg = 20", "dilation_angle_deg = 0"), 10,
             1.368, factor, ((2.5, 5, 10, 20), (2.5, 5, 10)), safety)]


def runs_of(case, programs, quick):
    for kind, counts in zip(KINDS, case.across):
        for across in counts[:2] if quick else counts:
            text = changed(case.text, "^size_m = .*", f'kind = "{kind}"\nsize_m = {case.length / across:.12g}')
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            result = programs.result(text, "--threads", 1, *case.options)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            yield Run(case.name, kind, across, len(result["/mesh/zone_block"]), len(result["/mesh/gridpoint_position"]),
                      case.exact, case.answer(result), after.ru_utime - before.ru_utime)


def table(runs):
    lines = ["| case | zones | over the length | number | gridpoints | closed form | computed | error, percent | seconds |",
             "|---|---|---|---|---|---|---|---|---|"]
    last = None
    for run in runs:
        lines.append(f"| {run.case if run.case != last else ''} | {run.zones} | {run.across:g} | {run.number} | "
                     f"{run.gridpoints} | {run.exact:.4g} | {run.computed:.4g} | {100 * run.error:+.1f} | {run.seconds:.2g} |")
        last = run.case
    return "\n".join(lines) + "\n"


def main():
    if len(sys.argv) not in (4, 5) or sys.argv[4:] not in ([], ["--quick"]):
        sys.exit("usage: zones.py PROGRAMS DATA OUT [--quick]")
    out = Path(sys.argv[3])
    (out / "tables").mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="jointcreep-") as folder:
        programs = literature.Programs(Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve(), folder)
        runs = [run for case in all_cases(programs) for run in runs_of(case, programs, sys.argv[4:] != [])]
    with open(out / "zones.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow([field.name for field in fields(Run)])
        writer.writerows(astuple(run) for run in runs)
    (out / "tables/zones.md").write_text(table(runs))


if __name__ == "__main__":
    main()
