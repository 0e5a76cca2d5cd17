"""Reads what a study collects from the files of one run."""

import datetime

import h5py
import numpy as np

from . import files, histories, reading
from .errors import NotWanted

NO_EQUILIBRIUM = 3  # exit code of demsolve
TO_FAIL = "probability of no equilibrium"  # what a summary calls the statistic "probability" of `failed`
MOVING, UNDECIDED = "blocks move", "undecided"  # what it found then


def check(study, scene):
    """Refuses quantities that the scene cannot have. `scene` as tomllib reads it."""
    points = [str(point.get("name", "")) for point in scene.get("point", [])] + points_on_lines(scene)
    stages = [str(stage.get("name", "")) for stage in scene.get("stage", [])]
    for one in study.quantities:
        for name, there, what in ((one.point, points, "point"), (one.relative_to, points, "relative_to"), (one.stage, stages, "stage")):
            if name and name not in there:
                raise NotWanted(f'{one.place}{what} is "{name}"; expected one that the scene has: {", ".join(there) or "it has none"}')
        if one.point and one.relative_to == one.point:
            raise NotWanted(f'{one.place}relative_to is "{one.relative_to}"; expected another point')
        if one.date is not None and not 0 <= day_of(one, scene) <= days_between(scene, scene["schedule"]["end"]):
            raise NotWanted(f"{one.place}date is {one.date}; expected one within the scene's schedule")


def points_on_lines(scene):
    """Names of the points on the monitoring lines of a scene, which may lack keys yet, as tomllib reads it."""
    return [f"{line.get('name', '')} {number}" for line in scene.get("monitoring_line", []) if isinstance(line.get("points"), int)
            for number in range(1, line["points"] + 1)]


def days_between(scene, date):
    """Days from the start of the schedule to a date, or to a number of days."""
    start = scene["schedule"].get("start", 0)
    if isinstance(date, datetime.date) != isinstance(start, datetime.date):
        raise NotWanted(f"{date} is {'a date' if isinstance(date, datetime.date) else 'a number'}, and the scene's schedule has "
                        f"{'dates' if isinstance(start, datetime.date) else 'numbers of days'}")
    return (date - start).days if isinstance(date, datetime.date) else float(date - start)


def day_of(quantity, scene):
    """The day of a quantity with a date, since the scene's start."""
    if not isinstance(quantity.date, datetime.date):
        return float(quantity.date)
    try:
        return days_between(scene, quantity.date)
    except NotWanted as error:
        raise NotWanted(f"{quantity.place}{error}") from None


def displacement(file, quantity, scene):
    """Displacement of a point at a time [mm], or that relative to another point. None if an excavation has taken a point. Both count from
    the first reading of the first one."""
    history = reading.history_of(file)
    time, moves, there = history.time, history.displacement, history.present
    point = history.point.index(quantity.point)
    other = history.point.index(quantity.relative_to) if quantity.relative_to else None
    first = int(history.first_reading_row[point])
    if quantity.stage:
        row = history.event.index(quantity.stage)
        day, value, is_there = time[row], moves[row], there[row]
    elif quantity.date is None:
        day, value, is_there = time[-1], moves[-1], there[-1]
    else:
        day = day_of(quantity, scene)
        stages = history.stages()
        done = int(stages[time <= day * (1 + histories.SAME_DAY)].max(initial=0))  # after a stage of that day
        found = histories.at(time, stages, history.dates, moves, there, day, done)
        if found is None:
            return None
        value, is_there, _ = found
    if not is_there[point] or other is not None and not is_there[other]:
        return None
    if quantity.since == "first reading":
        if day < time[first]:
            return None
        value = value - moves[first]
    vector = value[point] if other is None else value[point] - value[other]
    return 1e3 * float({"x": vector[0], "y": vector[1], "length": np.hypot(*vector)}[quantity.component])


def blocks(file, statistic):
    """A statistic of the areas of all blocks [m2], or their number."""
    area = file["/blocks/area"][()]
    return float({"number": len, "mean area": np.mean, "median area": np.median, "largest area": np.max}[statistic](area))


def factor_of_safety(file, end):
    """An end of the bracket. "lower end": the largest factor of a stable run. "upper end": the smallest factor of an unstable run, or
    None if all runs are stable."""
    factor, stands = file["/safety/factor"][()], file["/safety/stands"][()]
    if end == "lower end":
        return float(factor[stands == 1].max())
    return float(factor[stands == 0].min()) if (stands == 0).any() else None


def needed(study):
    """Which files of a run are wanted, beside network.h5."""
    what = {one.what for one in study.quantities}
    wanted = {"result.h5": bool(what & {"displacement", "failed"}) or study.histories or "result.failed.h5" in study.keep,
              "safety.h5": "factor of safety" in what}
    return {name: is_wanted or name in study.keep for name, is_wanted in {"joints.h5": any(wanted.values()), **wanted}.items()}


def failure(path):
    """Of the file that demsolve leaves of a run without equilibrium: MOVING or UNDECIDED; and its stage ("" between stages), the day since the
    start, and number and area [m2] of the blocks that move, or moved most if it is undecided. UNDECIDED and nothing if it left none."""
    try:
        with h5py.File(path) as file:
            block = file["/failure/block"][()]
            return MOVING if file["/failure/moves_on"][0] else UNDECIDED, {
                "stage": files.texts(file, "/failure/stage")[0], "day": float(file["/failure/time"][0]),
                "blocks": len(block), "area": float(file["/blocks/area"][()][block].sum())}
    except (OSError, KeyError):
        return UNDECIDED, {}


def ending_of(row):
    """What demsolve found where a run has no equilibrium, MOVING or UNDECIDED, in the first call that found none; "" of other runs."""
    return next(iter(row["no_equilibrium"].values()), "")


def file_of(quantity):
    """The file of a run that has a quantity."""
    return {"blocks": "network.h5", "factor of safety": "safety.h5"}.get(quantity.what, "result.h5")


def of_run(study, scene, folder, codes, endings):
    """Values of all quantities, None where there is none. The files of the run are in `folder`, as far as its programs have made
    them; codes, endings: exit codes of demsolve by the file that it makes, and, of code 3, MOVING or UNDECIDED."""
    values = []
    for one in study.quantities:
        name, value = file_of(one), None
        if one.what == "failed":
            value = 0.0 if codes.get(name) == 0 else 1.0 if endings.get(name) == MOVING else None
        elif (folder / name).exists():
            with h5py.File(folder / name) as file:
                if one.what == "displacement":
                    value = displacement(file, one, scene)
                elif one.what == "blocks":
                    value = blocks(file, one.statistic)
                else:
                    value = factor_of_safety(file, one.statistic)
        values.append(value)
    return values
