#!/usr/bin/python3
"""The shiplock with its geometry updated beside small displacements: a table of the twelve points.

    updated_geometry.py PROGRAMS SCENE.toml TARGETS.toml [--until DATE] -o OUT

Three runs of realization 0 on the same blocks and zones, which are coarser than the scene's:

    small    small displacements, the implicit engine
    updated  [large_displacements]: each stage and each creep step is a dynamic analysis in the geometry of the one before
    tiny     the same with weight, stress and strengths times 0.01. Times 100 its displacements are those at which geometry
             does not matter, by the same engine

So updated less tiny is the effect of geometry, and tiny less small that of the engine: contacts between faces in place of
gridpoints, and slip in the overshoot of motion. With --until the table is of that date, and a later date continues the
same runs. Runs go on where they were stopped (OUT/NAME.checkpoint.h5); a run is made again if the text of its scene or demsolve
changes. In OUT it writes updated-geometry.md and updated-geometry.csv.
"""

import argparse
import csv
import datetime
import io
import pathlib
import sys
import tempfile
import tomllib

import numpy as np

import records
import study
from jointcreep import chain, files
from jointcreep.chain import run

HERE = pathlib.Path(__file__).resolve().parent
TIMES = 0.01  # loads of the run "tiny"
# A step of the dynamic analysis is as short as the smallest zone allows. So there are fewer and larger blocks, without narrow
# wedges, on softer joints, for displacements of the same size; zones as large as blocks; a smaller section; and one creep
# step between two stages.
COARSE = ["--spacing-times", 2.5, "--stiffness-times", 0.3, "--cutting", 5, 20, "--zone-size", 40, "--domain", 500, -100,
          "--creep-step", 400, "--end", "1999-12-31"]
TOLERANCE = 3e-6  # of the dynamic analysis
RUNS = {  # name: (options of variant.py, options of demsolve)
    "small": ([], []),
    "updated": (["--large-displacements"], ["--tolerance", TOLERANCE]),
    "tiny": (["--large-displacements", "--loads-times", TIMES], ["--tolerance", TOLERANCE]),
}


def computed(arguments, name, start):
    """The result of one run until a date, as study.py reads it, made unless it is there."""
    variant, options = RUNS[name]
    scene, result = arguments.output / f"{name}.toml", arguments.output / f"{name}.h5"
    solver, until = arguments.programs / "demsolve", (arguments.until - start).days
    with tempfile.TemporaryDirectory(prefix="jointcreep-") as folder:
        folder = pathlib.Path(folder)
        run(sys.executable, HERE / "variant.py", arguments.scene, *COARSE, *variant, "-o", folder / "scene.toml")
        text = (folder / "scene.toml").read_text(encoding="utf-8")
        same = scene.exists() and scene.read_text(encoding="utf-8") == text
        is_made = same and result.exists() and result.stat().st_mtime >= solver.stat().st_mtime
        if not is_made or study.read(result)["days"][-1] < until:
            kept = arguments.output / f"{name}.checkpoint.h5"
            if not same:
                kept.unlink(missing_ok=True)
                result.unlink(missing_ok=True)
            files.write_text(scene, text)
            run(solver, chain.joints_of(arguments.programs, scene, folder, "--realization", 0), *options, "--quiet", "--until", until,
                "--checkpoint", kept, "--checkpoint-every", 1, "-o", result)
    print(f"{name}: done", flush=True)
    return study.read(result)


def rows_of(results, targets):
    """[(point, {total, recorded: [small, updated less small, its part of geometry, its part of the engine] in mm})]"""
    values = {name: np.array(study.values_of(result, targets)) for name, result in results.items()}
    first = np.array(results["small"]["first"])
    end = (targets["end_of_record"] - datetime.date.fromisoformat(results["small"]["start"])).days
    for one in values.values():
        one[1, first >= end] = np.nan  # read later
    values["tiny"] = values["tiny"] / TIMES
    small, updated, tiny = (values[name] for name in RUNS)
    columns = np.stack([small, updated - small, updated - tiny, tiny - small], axis=-1)  # [total or recorded, point, column]
    return [(name, {"total": columns[0, i], "recorded": columns[1, i]}) for i, name in enumerate(results["small"]["names"])]


def markdown(rows, zones, date):
    lines = ["| point | total (mm) | updated minus small | geometry | engine | recorded (mm) | updated minus small | geometry | engine |",
             "|---|---|---|---|---|---|---|---|---|"]
    for name, values in rows:
        cells = [name]
        for key in ("total", "recorded"):
            small, change, geometry, engine = values[key]
            if np.isnan(small):
                cells += ["", "", "", ""]
                continue
            share = lambda part: f" ({100 * part / small:+.1f} %)" if small >= 1 else ""
            cells += [f"{small:.2f}", f"{change:+.2f}{share(change)}", f"{geometry:+.3f}{share(geometry)}", f"{engine:+.2f}{share(engine)}"]
        lines.append("| " + " | ".join(cells) + " |")
    largest = {key: max(rows, key=lambda row: np.nan_to_num(abs(row[1][key][2]))) for key in ("total", "recorded")}
    told = "; ".join(f"{key} {values[key][2]:+.3f} mm ({name})" for key, (name, values) in largest.items() if not np.isnan(values[key][2]))
    return "\n".join([*lines, "", f"Realization 0, horizontal, toward the lock, on {date}; {zones} zones in all runs.",
                      f"Largest effect of geometry: {told}."]) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("scene", type=pathlib.Path)
    parser.add_argument("targets", type=pathlib.Path)
    parser.add_argument("--until", type=datetime.date.fromisoformat, metavar="DATE", help="of the table; default: the end of the record")
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    targets = records.targets_of(arguments.targets)
    arguments.until = arguments.until or targets["end_of_record"]
    with open(arguments.scene, "rb") as file:
        start = tomllib.load(file)["schedule"]["start"]
    results = {name: computed(arguments, name, start) for name in RUNS}
    rows = rows_of(results, {**targets, "end_of_record": arguments.until})
    text = io.StringIO()
    out = csv.writer(text, lineterminator="\n")
    out.writerow(["point", "quantity", "small_mm", "updated_less_small_mm", "geometry_mm", "engine_mm"])
    for name, values in rows:
        for key, columns in values.items():
            out.writerow([name, key, *(f"{value:.4f}" for value in columns)])
    files.write_text(arguments.output / "updated-geometry.csv", text.getvalue())
    files.write_text(arguments.output / "updated-geometry.md", markdown(rows, results["small"]["zones"], arguments.until))


if __name__ == "__main__":
    main()
