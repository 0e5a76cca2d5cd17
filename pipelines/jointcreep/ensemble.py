"""Statistics of the displacement histories of all runs of a study, and what each run was like.

    ensemble.h5     mean, standard deviation, confidence interval of the mean, and quantiles, for each time, point and component; what
                    each run was like, and which failed
    ensemble.csv    the same statistics as a table

A run counts at a time if its point is there then; one that failed counts nowhere. Where creep steps are chosen (tolerance_m), rows are
those of the first run, and the others are interpolated on their days (histories.py). Below two runs there are no statistics, only zeros.
"""

import math
import tomllib

import h5py
import numpy as np

from . import files, histories, intervals, reading
from .errors import NotWanted
from .intervals import CONFIDENCE

PROBABILITIES = [0.05, 0.25, 0.50, 0.75, 0.95]
FORMAT_VERSION = [4, 0]  # of ensemble.h5
LISTED = 12  # runs that the summary describes one by one
KINDS = {
    "displacement": "since the in-situ equilibrium",
    "displacement_since_first_reading": "since the first reading of the point",
}
CUTTING = ["shortest_edge", "merged_vertices", "merged_edge_length", "merged_block_area", "largest_move"]
# What is told of each run: name, unit, heading and format in the summary, description.
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
     "Largest error of work = stored + dissipated + damped of all equilibria, over the largest of the four in any."),
    ("area_error", "1", "area\nbalance", ".1e", "Area of all blocks over the section's, less 1; without its sign."),
    ("merged_vertices", "1", "merged\nvertices", "d", "Vertices that cutting merged with another."),
    ("merged_edge_length", "m", "merged\nedges (m)", ".3g", "Length of edges that vanished so."),
    ("merged_block_area", "m2", "merged\nblocks (m2)", ".3g", "Area of blocks that vanished so."),
    ("largest_move", "m", "largest\nmove (m)", ".3g", "How far cutting moved a vertex at most."),
    ("cut_back_length", "m", "cut\nback (m)", ".3g", "Length of joints that ended inside a block and were cut back."),
]
EXPLAINED = [
    "unbalanced force ratio: the largest that an equilibrium ended with",
    "energy balance: largest error of work = stored + dissipated + damped of all equilibria, over the largest of the four in any;",
    "    by the implicit engine damped is what the others leave, and counts as an error where it is below 0",
    "area balance: area of all blocks over that of the section, less 1",
    "merged, moved, cut back: what cutting did to edges too short, angles too small and loose joint ends",
]


# --- Of one run -----------------------------------------------------------------------------------------------------


def smallest_altitude(position, zone):
    """The smallest altitude of all zones [m]: twice the area over the longest side."""
    corner = position[zone]
    side = np.roll(corner, -1, axis=1) - corner
    longest = np.linalg.norm(side, axis=2).max(axis=1)
    twice_area = side[:, 0, 0] * side[:, 1, 1] - side[:, 0, 1] * side[:, 1, 0]
    return float((twice_area / longest).min())


def energy_error(file):
    """Largest error of work = stored + dissipated + damped of all equilibria, over the largest of the four in any equilibrium [-].

    An equilibrium that moves nearly nothing, such as that of an in-situ stress that balances already, has terms that are small
    differences of large sums: compared with its own terms, rounding would count as an error. Dynamic relaxation finds each of the four by itself. By the implicit engine the damped energy is what the others leave, so the sum says
    nothing; but loads that change at once cannot set free less than nothing, and below 0 it counts as an error.
    """
    terms = np.stack([file[f"/equilibria/{name}"][()] for name in
                      ("work_of_loads", "stored_energy", "dissipated_energy", "damped_energy")])
    largest = np.abs(terms).max()
    created = np.where(file["/equilibria/is_implicit"][()] == 1, np.maximum(-terms[3], 0), 0)
    error = np.maximum(np.abs(terms[0] - terms[1:].sum(axis=0)), created)
    return float(error.max() / largest) if largest > 0 else 0.0


def area_error(file):
    """How far the area of all blocks is from that of the section, relative to it [-]."""
    corner = np.array(tomllib.loads(files.texts(file, "/scene")[0])["section"]["outline_m"], float)
    x, y = (corner - corner[0]).T
    section = abs(math.fsum(x * np.roll(y, -1) - y * np.roll(x, -1))) / 2
    return abs(math.fsum(file["/blocks/area"][()]) / section - 1)


def of_run(path):
    """What statistics need of a result file, as JSON takes it: histories, and the values of OF_EACH by name."""
    with h5py.File(path) as file:
        history = reading.history_of(file)
        return {
            "point": history.point,
            "point_position": history.position.tolist(),
            "time": history.time.tolist(),
            "event": history.event,
            "first_reading_row": history.first_reading_row.tolist(),
            "dates": history.dates.tolist(),
            "displacement": history.displacement.tolist(),
            "present": history.present.tolist(),
            "like": {
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
                "cut_back_length": float(file["/fates/dangling_end_length"][()].sum()),
            },
        }


# --- Of all runs ----------------------------------------------------------------------------------------------------


def on_days_of(first, one):
    """Displacement [time, point, 2] and presence [time, point] of a run on the days of the first one's rows."""
    moves, there = np.array(one["displacement"]), np.array(one["present"])
    if all(first[name] == one[name] for name in ("time", "event", "first_reading_row")):
        return moves, there
    stages, wanted = (histories.stages_of(run["event"]) for run in (one, first))
    if stages[-1] != wanted[-1]:
        raise NotWanted(f"it has {stages[-1]} stages, and not {wanted[-1]}")
    time, dates = np.array(one["time"]), np.array(one["dates"])
    found = [histories.at(time, stages, dates, moves, there, day, done) for day, done in zip(first["time"], wanted)]
    missing = [day for day, of_day in zip(first["time"], found) if of_day is None]
    if missing:
        raise NotWanted(f"it has no displacement on day {missing[0]:g}")
    return np.stack([of_day[0] for of_day in found]), np.stack([of_day[1] for of_day in found])


def statistics_of(displacement, counts):
    """Arrays by their name. displacement [run, time, point, 2] [m]; counts [run, time, point]: whether the run counts. What fewer
    than two runs have is 0."""
    times, points = displacement.shape[1:3]
    found = {"count": counts.sum(axis=0).astype(np.int32)}
    for name in ("mean", "standard_deviation", "mean_low", "mean_high"):
        found[name] = np.zeros((times, points, 2))
    found["quantile"] = np.zeros((len(PROBABILITIES), times, points, 2))
    for row, point in np.argwhere(found["count"] > 1):
        sample = displacement[counts[:, row, point], row, point]
        for component in (0, 1):
            at = row, point, component
            found["mean"][at], found["mean_low"][at], found["mean_high"][at] = intervals.mean(sample[:, component])[:3]
        found["standard_deviation"][row, point] = sample.std(axis=0, ddof=1)
        found["quantile"][:, row, point] = np.quantile(sample, PROBABILITIES, axis=0)
    return found


def all_statistics(rows):
    """The statistics of each kind, of the lines of results of runs with a history."""
    first = rows[0]["history"]
    displacement, present = [], []
    for row in rows:
        try:
            moves, there = on_days_of(first, row["history"])
        except NotWanted as error:
            raise NotWanted(f"the history of run {row['run']} cannot be put beside that of run {rows[0]['run']}: {error}") from None
        displacement.append(moves)
        present.append(there)
    displacement, present = np.stack(displacement), np.stack(present)
    first_row = np.array(first["first_reading_row"], int)
    at_first = displacement[:, first_row, np.arange(len(first_row))]
    has_begun = np.arange(displacement.shape[1])[:, None] >= first_row
    return {
        "displacement": statistics_of(displacement, present),
        "displacement_since_first_reading": statistics_of(displacement - at_first[:, None], present & has_begun),
    }


# --- Files ----------------------------------------------------------------------------------------------------------


def fill(file, rows, failed, statistics, scene):
    """Writes ensemble.h5, which is open, but for what tells that it is whole."""
    first = rows[0]["history"]

    def put(name, values, units, description):
        dataset = files.put(file, name, values)
        dataset.attrs["units"], dataset.attrs["description"] = np.bytes_(units), np.bytes_(description)

    file.attrs["filetype"] = np.bytes_("jointcreep ensemble")
    file.attrs["format_version"] = np.array(FORMAT_VERSION, np.int32)
    put("/scene", [scene], "1", "Text of the scene.")
    put("/run/number", np.array([row["run"] for row in rows]), "1", "Number of a run with a history.")
    put("/run/network", np.array([row["network"] for row in rows]), "1", "Number of its network.")
    for name, units, _, _, what in OF_EACH:
        put(f"/run/{name}", np.array([row["history"]["like"][name] for row in rows]), units, what)
    put("/failed/number", np.array([row["run"] for row in failed], np.int64), "1", "Number of a run that failed.")
    put("/failed/reason", [f"{row['program']}, exit code {row['exit_code']} {row['reason']}" for row in failed], "1", "Why.")
    put("/history/time", np.array(first["time"]), "day", "Time since the start.")
    put("/history/event", first["event"], "1", "Stage that this row is the first after.")
    put("/history/point", first["point"], "1", "Names of the points.")
    put("/history/point_position", np.array(first["point_position"]), "m", "Position {x, y}.")
    put("/history/first_reading_row", np.array(first["first_reading_row"]), "1", "Row from which readings count.")
    put("/probability", np.array(PROBABILITIES), "1", "Probabilities of the quantiles.")
    meaning = {
        "count": "Runs in which the point is there; below 2 there are no statistics, only zeros.",
        "mean": "Mean displacement {x, y}",
        "standard_deviation": "Standard deviation between runs",
        "mean_low": f"Lower end of the {CONFIDENCE:.0%} confidence interval of the mean",
        "mean_high": f"Upper end of the {CONFIDENCE:.0%} confidence interval of the mean",
        "quantile": "Quantiles [probability, time, point, {x, y}]",
    }
    for kind, arrays in statistics.items():
        for name, values in arrays.items():
            what = meaning[name] + ("" if name == "count" else f", displacement {KINDS[kind]}.")
            put(f"/{kind}/{name}", values, "1" if name == "count" else "m", what)


def table(first, statistics):
    """The statistics as heads and rows of a table."""
    names = ["mean", "standard_deviation", "mean_low", "mean_high"]
    heads = ["since", "point", "component", "time_day", "event", "count", *(f"{name}_m" for name in names),
             *(f"quantile_{round(100 * p):02d}_m" for p in PROBABILITIES)]
    rows = []
    for kind, since in (("displacement", "in situ"), ("displacement_since_first_reading", "first reading")):
        arrays = statistics[kind]
        for point, name in enumerate(first["point"]):
            for component in (0, 1):
                for row in np.flatnonzero(arrays["count"][:, point] > 1):
                    at = row, point, component
                    rows.append([since, name, "xy"[component], files.day_text(first["time"][row]), first["event"][row], arrays["count"][row, point],
                                 *(float(arrays[name][at]) for name in names),
                                 *(float(value) for value in arrays["quantile"][(slice(None), *at)])])
    return heads, rows


def in_columns(headings, rows):
    """Lines of text, the columns aligned on their right; headings may have several lines."""
    headings = [heading.split("\n") for heading in headings]
    height = max(map(len, headings))
    rows = [*zip(*([""] * (height - len(heading)) + heading for heading in headings)), *rows]
    widths = [max(map(len, column)) for column in zip(*rows)]
    return ["  ".join(cell.rjust(width) for cell, width in zip(row, widths)) for row in rows]


def moves_in_the_end(first, statistics):
    """Mean, half of its confidence interval, deviation and interquartile range of each point's displacement in the end."""
    arrays = statistics["displacement"]
    lower, upper = PROBABILITIES.index(0.25), PROBABILITIES.index(0.75)
    headings = ["point", "", "runs", "mean\n(mm)", "+-\n(mm)", "standard\ndeviation (mm)", "interquartile\nrange (mm)"]
    rows = []
    for point, name in enumerate(first["point"]):
        for component in (0, 1):
            at = -1, point, component
            count = arrays["count"][-1, point]
            if count < 2:  # it has been removed
                continue
            mean, deviation, high, low_quarter, high_quarter = (
                1e3 * value for value in (arrays["mean"][at], arrays["standard_deviation"][at], arrays["mean_high"][at],
                                          arrays["quantile"][(lower, *at)], arrays["quantile"][(upper, *at)]))
            rows.append([name, "xy"[component], str(count), f"{mean:.3f}", f"{high - mean:.3f}", f"{deviation:.3f}",
                         f"{low_quarter:.3f} to {high_quarter:.3f}"])
    return [f"displacement on day {first['time'][-1]:g} since the in-situ equilibrium; +-: {CONFIDENCE:.0%} confidence of the mean",
            *in_columns(headings, rows)]


def taken_points(rows):
    """Lines of the points that an excavation takes in some runs and not in others."""
    lines = []
    for point, name in enumerate(rows[0]["history"]["point"]):
        taken = [row["run"] for row in rows if not row["history"]["present"][-1][point]]
        if 0 < len(taken) < len(rows):
            lines.append(f'point "{name}": an excavation takes it in {len(taken)} of {len(rows)} runs: {files.listed(taken)}')
    return lines


def described(rows):
    """Lines that say what each run was like; of many runs only the extremes."""
    cells = [[str(row["run"]), *(format(row["history"]["like"][name], shown) for name, _, _, shown, _ in OF_EACH)]
             for row in rows if len(rows) <= LISTED]
    cells += [[label, *(format(of(row["history"]["like"][name] for row in rows), shown) for name, _, _, shown, _ in OF_EACH)]
              for label, of in (("least", min), ("most", max))]
    return [*in_columns(["run", *(heading for _, _, heading, _, _ in OF_EACH)], cells), "", *EXPLAINED]


def write(all_rows, scene, out):
    """Writes ensemble.h5 and ensemble.csv from all lines of results. Returns lines for the summary; none if fewer than two runs have a
    history."""
    rows = [row for row in all_rows if "history" in row]
    if len(rows) < 2:
        return []
    statistics = all_statistics(rows)
    first = rows[0]["history"]
    files.write_text(out / "ensemble.csv", files.csv_text(*table(first, statistics)))
    files.write_hdf5(out / "ensemble.h5", lambda file: fill(file, rows, [row for row in all_rows if row["exit_code"] != 0],
                                                            statistics, scene))
    return [*described(rows), "", *moves_in_the_end(first, statistics), *taken_points(rows)]
