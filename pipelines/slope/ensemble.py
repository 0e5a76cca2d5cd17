#!/usr/bin/python3
"""Statistics of the displacement histories of many realizations.

    ensemble.py FOLDER N -o OUT

FOLDER holds NUMBER.h5 or NUMBER.failed for each of the realizations 0000 to N - 1, as realization.sh leaves them. In
OUT it writes
    ensemble.h5   mean, standard deviation, confidence interval of the mean, and quantiles, for each time, point and
                  component; what each realization was like, and which failed
    ensemble.csv  the same statistics as a table
    summary.txt   how many ended in equilibrium, how far the points moved, what each realization was like and what
                  cutting did to it, and which failed, with their reasons
Files whose content has not changed stay as they are.

Only realizations in equilibrium count: those that failed, some because they slide, are named and not averaged. A
realization counts at a time if its point is there then. Where creep steps are chosen (tolerance_m), rows are those of the first
realization in equilibrium, and the others are interpolated on their days (jointcreep/histories.py). The confidence interval is Student's: it holds for means of
many realizations, or if displacements are about normally distributed. Quantiles are interpolated linearly between the
ordered realizations. Everything is added up in the order of numbers, so the same realizations give the same bytes.
"""

import argparse
import csv
import io
import math
import os
import pathlib
import sys
import tomllib
from dataclasses import dataclass, replace

import h5py
import numpy as np
from scipy import special

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from jointcreep import histories, intervals  # noqa: E402

PROBABILITIES = [0.05, 0.25, 0.50, 0.75, 0.95]
CONFIDENCE = intervals.CONFIDENCE
CUTTING = ["shortest_edge", "merged_vertices", "merged_edge_length", "merged_block_area", "largest_move",
           "pruned_length"]
SAME = ["/scene", "/provenance/program", "/provenance/version", "/history/point", "/history/point_position"]
ROWS = ["/history/time", "/history/event", "/history/first_reading_row"]  # differ where creep steps are chosen (tolerance_m)
KINDS = {
    "displacement": "since the in-situ equilibrium",
    "displacement_since_first_reading": "since the first reading of the point",
}
# What is told of each realization: name, unit, heading and format in the summary, description.
OF_EACH = [
    ("blocks", "1", "blocks", "d", "Blocks it has."),
    ("zones", "1", "zones", "d", "Zones it has."),
    ("shortest_edge", "m", "shortest\nedge (m)", ".4g", "Its shortest edge between blocks."),
    ("smallest_zone_altitude", "m", "smallest zone\naltitude (m)", ".4g", "Its smallest zone altitude."),
    ("equilibria", "1", "equi-\nlibria", "d", "Equilibria found."),
    ("by_relaxation", "1", "by\nrelaxation", "d", "Those of them that dynamic relaxation found, and not the implicit engine."),
    ("solver_steps", "1", "solver\nsteps", "d", "Steps of dynamic relaxation, and corrections by the implicit engine."),
    ("largest_unbalanced_force_ratio", "1", "unbalanced\nforce ratio", ".1e",
     "Largest unbalanced force ratio that an equilibrium ended with."),
    ("energy_error", "1", "energy\nbalance", ".1e",
     "Largest error of work = stored + dissipated + damped of all equilibria, over the largest of the four."),
    ("area_error", "1", "area\nbalance", ".1e", "Area of all blocks over the section's, less 1; without its sign."),
    ("merged_vertices", "1", "merged\nvertices", "d", "Vertices that cutting merged with another."),
    ("merged_edge_length", "m", "merged\nedges (m)", ".3g", "Length of edges that vanished so."),
    ("merged_block_area", "m2", "merged\nblocks (m2)", ".3g", "Area of blocks that vanished so."),
    ("largest_move", "m", "largest\nmove (m)", ".3g", "How far cutting moved a vertex at most."),
    ("pruned_length", "m", "cut\nback (m)", ".3g", "Length of joints that ended inside a block and were cut back."),
]


class NotWanted(Exception):
    """A file is not what the statistics need."""


@dataclass
class Realization:
    number: int
    common: dict  # what must be the same in all
    rows: dict  # of its histories
    dates: np.ndarray  # on which something happens [day]
    displacement: np.ndarray  # [time, point, 2] [m]
    present: np.ndarray  # [time, point]
    values: dict  # of OF_EACH, by name


def smallest_altitude(position, zone):
    """The smallest altitude of all zones [m]: twice the area over the longest side."""
    corner = position[zone]
    side = np.roll(corner, -1, axis=1) - corner
    longest = np.linalg.norm(side, axis=2).max(axis=1)
    twice_area = side[:, 0, 0] * side[:, 1, 1] - side[:, 0, 1] * side[:, 1, 0]
    return float((twice_area / longest).min())


def energy_error(file):
    """Largest error of work = stored + dissipated + damped of all equilibria, over the largest of the four [-].

    Dynamic relaxation finds each of the four by itself. By the implicit engine the damped energy is what the others leave, so the sum says
    nothing; but loads that change at once cannot set free less than nothing, and below 0 it counts as an error.
    """
    terms = np.stack([file[f"/equilibria/{name}"][()] for name in
                      ("work_of_loads", "stored_energy", "dissipated_energy", "damped_energy")])
    largest = np.abs(terms).max(axis=0)
    created = np.where(file["/equilibria/is_implicit"][()] == 1, np.maximum(-terms[3], 0), 0)
    error = np.maximum(np.abs(terms[0] - terms[1:].sum(axis=0)), created)
    return float(np.divide(error, largest, out=np.zeros_like(error), where=largest > 0).max())


def area_error(file):
    """How far the area of all blocks is from that of the section, relative to it [-]."""
    corner = np.array(tomllib.loads(text_of(file["/scene"][0]))["section"]["outline_m"], float)
    x, y = (corner - corner[0]).T
    section = abs(math.fsum(x * np.roll(y, -1) - y * np.roll(x, -1))) / 2
    return abs(math.fsum(file["/blocks/area"][()]) / section - 1)


def text_of(value):
    return value.decode() if isinstance(value, bytes) else str(value)


def read(path, number):
    with h5py.File(path, "r") as file:
        if text_of(file.attrs.get("filetype", "")) != "jointcreep result" or "complete" not in file.attrs:
            raise NotWanted("this is not a complete result file")
        if file.attrs["realization"] != number:
            raise NotWanted(f"this is realization {file.attrs['realization']}, not {number}")
        try:
            return Realization(
                number=number,
                common={
                    **{name: file[name][()] for name in SAME},
                    "the options of demsolve": file["/provenance/options"][-1],
                    "the seed": file.attrs["seed"],
                },
                rows={name: file[name][()] for name in ROWS},
                dates=np.unique(file["/states/time"][()]),
                displacement=file["/history/displacement"][()],
                present=file["/history/present"][()],
                values={
                    "blocks": len(file["/blocks/area"]),
                    "zones": len(file["/mesh/zone_block"]),
                    "smallest_zone_altitude": smallest_altitude(
                        file["/mesh/gridpoint_position"][()], file["/mesh/zone_gridpoint"][()]),
                    "equilibria": len(file["/equilibria/steps"]),
                    "by_relaxation": int((file["/equilibria/is_implicit"][()] == 0).sum()),
                    "solver_steps": int(file["/equilibria/steps"][()].sum()),
                    "largest_unbalanced_force_ratio": float(file["/equilibria/unbalanced_force_ratio"][()].max()),
                    "energy_error": energy_error(file),
                    "area_error": area_error(file),
                    **{name: file[f"/cutting/{name}"][0].item() for name in CUTTING},
                },
            )
        except KeyError as error:
            raise NotWanted(f"something is missing: {error}") from error


def stages_of(one):
    """How many stages there have been, by row of its histories."""
    return np.cumsum([bool(text_of(name)) for name in one.rows["/history/event"]])


def on_days_of(first, one):
    """A realization with its histories on the days of another one's rows, where its own are on others."""
    if all(np.array_equal(first.rows[name], one.rows[name]) for name in ROWS):
        return one
    displacement, present = np.zeros_like(first.displacement), np.zeros_like(first.present)
    stages = stages_of(one)
    if stages[-1] != stages_of(first)[-1]:
        raise NotWanted(f"it has {stages[-1]} stages, and {first.number:04d}.h5 has {stages_of(first)[-1]}")
    for row, (day, done) in enumerate(zip(first.rows["/history/time"], stages_of(first))):
        found = histories.at(one.rows["/history/time"], stages, one.dates, one.displacement, one.present, day, done)
        if found is None:
            raise NotWanted(f"it has no displacement on day {day:g}")
        displacement[row], present[row], _ = found
    return replace(one, rows=first.rows, displacement=displacement, present=present)


def read_all(folder, count):
    """The realizations in equilibrium, and the reasons of the others by their number."""
    found, failed = [], {}
    for number in range(count):
        path = folder / f"{number:04d}.h5"
        reason = path.with_suffix(".failed")
        if reason.exists():
            failed[number] = " ".join(reason.read_text(encoding="utf-8", errors="replace").split())
            continue
        try:
            found.append(read(path, number))
            found[-1] = on_days_of(found[0], found[-1])
            for name, value in found[0].common.items():
                if not np.array_equal(value, found[-1].common[name]):
                    raise NotWanted(f"{name} is not the same as in {found[0].number:04d}.h5")
        except (OSError, NotWanted) as error:
            raise NotWanted(f"{path}: {error}") from error
    return found, failed


def statistics_of(displacement, counts):
    """Arrays by their name. displacement [realization, time, point, 2]; counts [realization, time, point]: whether
    the realization counts. What fewer than two realizations have is 0."""
    times, points = displacement.shape[1:3]
    found = {"count": counts.sum(axis=0).astype(np.int32)}
    for name in ("mean", "standard_deviation", "mean_low", "mean_high"):
        found[name] = np.zeros((times, points, 2))
    found["quantile"] = np.zeros((len(PROBABILITIES), times, points, 2))
    t_of = {count: special.stdtrit(count - 1, (1 + CONFIDENCE) / 2) for count in np.unique(found["count"]) if count > 1}
    for row, point in np.argwhere(found["count"] > 1):
        sample = displacement[counts[:, row, point], row, point]
        at = row, point
        found["mean"][at] = mean = sample.mean(axis=0)
        found["standard_deviation"][at] = deviation = sample.std(axis=0, ddof=1)
        half = t_of[len(sample)] * deviation / math.sqrt(len(sample))
        found["mean_low"][at], found["mean_high"][at] = mean - half, mean + half
        found["quantile"][:, row, point] = np.quantile(sample, PROBABILITIES, axis=0)
    return found


def all_statistics(found):
    """The statistics of each kind."""
    displacement = np.stack([one.displacement for one in found])
    present = np.stack([one.present for one in found]) == 1
    first_row = found[0].rows["/history/first_reading_row"]
    at_first = np.stack([displacement[:, row, point] for point, row in enumerate(first_row)], axis=1)
    has_begun = np.arange(displacement.shape[1])[:, None] >= first_row
    return {
        "displacement": statistics_of(displacement, present),
        "displacement_since_first_reading": statistics_of(displacement - at_first[:, None], present & has_begun),
    }


def write_hdf5(path, found, failed, statistics):
    with h5py.File(path, "w") as file:
        def put(name, values, units, description):
            if isinstance(values, list):  # of str
                coded = [value.encode() for value in values]
                values = np.array(coded, h5py.string_dtype("utf-8", max([1, *map(len, coded)])))
            dataset = file.create_dataset(name, data=values, track_times=False)
            dataset.attrs["units"], dataset.attrs["description"] = np.bytes_(units), np.bytes_(description)

        common, rows = found[0].common, found[0].rows
        file.attrs["filetype"] = np.bytes_("jointcreep ensemble")
        file.attrs["format_version"] = np.array([2, 0], np.int32)
        file.attrs["seed"] = common["the seed"]
        put("/scene", [text_of(common["/scene"][0])], "1", "Text of the scene.")
        put("/realization/number", np.array([one.number for one in found]), "1",
            "Number of a realization that ended in equilibrium.")
        for name, units, _, _, what in OF_EACH:
            put(f"/realization/{name}", np.array([one.values[name] for one in found]), units, what)
        put("/failed/number", np.array(list(failed), np.int64), "1", "Number of a realization that failed.")
        put("/failed/reason", list(failed.values()), "1", "Why.")
        put("/history/time", rows["/history/time"], "day", "Time since the start.")
        for of, name, what in ((rows, "event", "Stage that this row is the first after."), (common, "point", "Names of the points.")):
            put(f"/history/{name}", [text_of(text) for text in of[f"/history/{name}"]], "1", what)
        put("/history/point_position", common["/history/point_position"], "m", "Position {x, y}.")
        put("/history/first_reading_row", rows["/history/first_reading_row"], "1", "Row from which readings count.")
        put("/probability", np.array(PROBABILITIES), "1", "Probabilities of the quantiles.")
        for kind, arrays in statistics.items():
            meaning = {
                "count": "Realizations in which the point is there; below 2 there are no statistics, only zeros.",
                "mean": "Mean displacement {x, y}",
                "standard_deviation": "Standard deviation between realizations",
                "mean_low": f"Lower end of the {CONFIDENCE:.0%} confidence interval of the mean",
                "mean_high": f"Upper end of the {CONFIDENCE:.0%} confidence interval of the mean",
                "quantile": "Quantiles [probability, time, point, {x, y}]",
            }
            for name, values in arrays.items():
                what = meaning[name] + ("" if name == "count" else f", displacement {KINDS[kind]}.")
                put(f"/{kind}/{name}", values, "1" if name == "count" else "m", what)
        file.attrs["complete"] = np.int32(1)


def table(found, statistics):
    """The statistics as the text of a CSV file; Python writes numbers so that they read back exactly."""
    points = [text_of(name) for name in found[0].common["/history/point"]]
    time, event = (found[0].rows[f"/history/{name}"] for name in ("time", "event"))
    names = ["mean", "standard_deviation", "mean_low", "mean_high"]
    text = io.StringIO()
    out = csv.writer(text, lineterminator="\n")
    out.writerow(["since", "point", "component", "time_day", "event", "count", *(f"{name}_m" for name in names),
                  *(f"quantile_{round(100 * p):02d}_m" for p in PROBABILITIES)])
    for kind, since in (("displacement", "in situ"), ("displacement_since_first_reading", "first reading")):
        arrays = statistics[kind]
        for point, name in enumerate(points):
            for component in (0, 1):
                for row in np.flatnonzero(arrays["count"][:, point] > 1):
                    at = row, point, component
                    out.writerow([since, name, "xy"[component], float(time[row]), text_of(event[row]), arrays["count"][row, point],
                                  *(float(arrays[name][at]) for name in names),
                                  *(float(value) for value in arrays["quantile"][(slice(None), *at)])])
    return text.getvalue()


def in_columns(headings, rows):
    """Lines of text, the columns aligned on their right; headings may have several lines."""
    headings = [heading.split("\n") for heading in headings]
    height = max(map(len, headings))
    rows = [*zip(*([""] * (height - len(heading)) + heading for heading in headings)), *rows]
    widths = [max(map(len, column)) for column in zip(*rows)]
    return ["  ".join(cell.rjust(width) for cell, width in zip(row, widths)) for row in rows]


def moves_in_the_end(found, statistics):
    """Mean, half of its confidence interval, deviation and middle half of each point's displacement in the end."""
    arrays = statistics["displacement"]
    lower, upper = PROBABILITIES.index(0.25), PROBABILITIES.index(0.75)
    headings = ["point", "", "realizations", "mean\n(mm)", "+-\n(mm)", "standard\ndeviation (mm)", "middle\nhalf (mm)"]
    rows = []
    for point, name in enumerate(found[0].common["/history/point"]):
        for component in (0, 1):
            at = -1, point, component
            count = arrays["count"][-1, point]
            if count < 2:  # it has been removed
                continue
            mean, deviation, high, low_quarter, high_quarter = (
                1e3 * value for value in (arrays["mean"][at], arrays["standard_deviation"][at], arrays["mean_high"][at],
                                          arrays["quantile"][(lower, *at)], arrays["quantile"][(upper, *at)]))
            rows.append([text_of(name), "xy"[component], str(count), f"{mean:.3f}", f"{high - mean:.3f}",
                         f"{deviation:.3f}", f"{low_quarter:.3f} to {high_quarter:.3f}"])
    end = float(found[0].rows["/history/time"][-1])
    return [f"displacement on day {end:g} since the in-situ equilibrium; +-: {CONFIDENCE:.0%} confidence of the mean",
            *in_columns(headings, rows)]


def taken_points(found):
    """Lines of the points that an excavation takes in some realizations and not in others."""
    there = np.stack([one.present[-1] for one in found]) == 1  # [realization, point]
    lines = []
    for point, name in enumerate(found[0].common["/history/point"]):
        numbers = [f"{one.number:04d}" for one, is_there in zip(found, there[:, point]) if not is_there]
        if 0 < len(numbers) < len(found):
            lines.append(f'point "{text_of(name)}": an excavation takes it in {len(numbers)} of {len(found)} realizations: '
                         f"{', '.join(numbers)}")
    return lines


def summary(found, failed, statistics=None):
    """What was computed, in words; without statistics, as far as there is anything."""
    lines = [f"realizations    {len(found) + len(failed)}", f"in equilibrium  {len(found)}"]
    if found:
        rows = [[f"{one.number:04d}", *(format(one.values[name], shown) for name, _, _, shown, _ in OF_EACH)]
                 for one in found]
        for label, of in (("least", min), ("most", max)):
            rows.append([label, *(format(of(one.values[name] for one in found), shown)
                                  for name, _, _, shown, _ in OF_EACH)])
        headings = ["number", *(heading for _, _, heading, _, _ in OF_EACH)]
        lines += ["", *in_columns(headings, rows), "",
                  "unbalanced force ratio: the largest that an equilibrium ended with",
                  "energy balance: largest error of work = stored + dissipated + damped of all equilibria, over the "
                  "largest of the four;",
                  "    by the implicit engine damped is what the others leave, and counts as an error where it is below 0",
                  "area balance: area of all blocks over that of the section, less 1",
                  "merged, moved, cut back: what cutting did to edges too short, angles too small and loose joint ends"]
    if statistics:
        lines += ["", *moves_in_the_end(found, statistics), *taken_points(found)]
    if failed:
        lines += ["", *(f"failed {number:04d}: {reason}" for number, reason in failed.items())]
    return "\n".join(lines) + "\n"


def replace_if_changed(path, write):
    """Calls `write` with the path of a new file, which takes the place of an old one of other content."""
    partial = path.with_name(f"{path.name}.partial-{os.getpid()}")
    try:
        write(partial)
        if not (path.exists() and path.read_bytes() == partial.read_bytes()):
            os.replace(partial, path)
    finally:
        for left in path.parent.glob(f"{path.name}.partial-*"):  # this one, and those of writers that were killed
            writer = left.name.rpartition("-")[2]
            if left == partial or not pathlib.Path("/proc", writer).exists():
                left.unlink(missing_ok=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", metavar="FOLDER", type=pathlib.Path)
    parser.add_argument("count", metavar="N", type=int)
    parser.add_argument("-o", "--output", metavar="OUT", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    out = arguments.output
    try:
        found, failed = read_all(arguments.folder, arguments.count)
        if len(found) < 2:
            print(summary(found, failed), end="", file=sys.stderr)
            raise NotWanted(f"{len(found)} of {arguments.count} realizations are in equilibrium; statistics need 2")
        statistics = all_statistics(found)
        words = summary(found, failed, statistics)
        replace_if_changed(out / "ensemble.csv", lambda path: path.write_text(table(found, statistics), "utf-8"))
        replace_if_changed(out / "summary.txt", lambda path: path.write_text(words, "utf-8"))
        replace_if_changed(out / "ensemble.h5", lambda path: write_hdf5(path, found, failed, statistics))
    except NotWanted as error:
        print(f"ensemble.py: {error}", file=sys.stderr)
        sys.exit(2)
    except OSError as error:
        print(f"ensemble.py: {error}", file=sys.stderr)
        sys.exit(4)


if __name__ == "__main__":
    main()
