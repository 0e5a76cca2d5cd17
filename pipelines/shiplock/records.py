"""What the figures and tables of the shiplock share: curves of the points toward the lock, and the targets.

Curves are those of one result file, or median and 5 to 95 percent of an ensemble.h5 (jointcreep study).
"""

import datetime
import tomllib
from dataclasses import dataclass

import numpy as np

import figure

LOW, MEDIAN, HIGH = 0.05, 0.50, 0.95


@dataclass
class Record:
    """Displacements of all points toward the lock [mm], as arrays [low, median, high][time, point]."""
    names: list
    position: np.ndarray  # [point, 2] [m]
    days: np.ndarray  # [time] since the start
    total: np.ndarray  # [3, time, point]
    recorded: np.ndarray  # since each point's first reading; [3, time, point]
    first: np.ndarray  # row of each point's first reading
    start: datetime.date
    scene: dict
    number: int  # of networks

    def day_of(self, date):
        return (date - self.start).days

    def at(self, curves, date, point):
        """[low, median, high] of a point at the end of a date, straight between rows [mm]."""
        day = self.day_of(date) + 1e-6
        return np.array([np.interp(day, self.days, one[:, point]) for one in curves])


def record_of(file):
    scene = figure.scene_of(file)
    start = scene["schedule"]["start"]
    if not isinstance(start, datetime.date):
        raise figure.NotWanted("its scene counts days, and has no dates")
    position = figure.array(file, "/history/point_position")
    toward = -np.sign(position[:, 0])  # the lock is about x = 0
    first = figure.array(file, "/history/first_reading_row")
    if "/probability" in file:
        rows = [int(np.argmin(np.abs(figure.array(file, "/probability") - p))) for p in (LOW, MEDIAN, HIGH)]

        def curves(name):
            values = 1e3 * figure.array(file, f"/{name}/quantile")[rows, :, :, 0] * toward
            return np.stack([values.min(axis=0), values[1], values.max(axis=0)])

        total, recorded = curves("displacement"), curves("displacement_since_first_reading")
        number = len(figure.array(file, "/run/number"))
    else:
        values = 1e3 * figure.array(file, "/history/displacement")[:, :, 0] * toward
        total = np.stack([values] * 3)
        recorded = total - total[:, first, np.arange(len(first))][:, None, :]
        number = 1
    return Record(figure.texts(file, "/history/point"), position, figure.array(file, "/history/time"), total, recorded,
                  first, start, scene, number)


def targets_of(path):
    """The targets as a dict, its points by name; without a path there are none."""
    if not path:
        return {"point": {}}
    with open(path, "rb") as file:
        targets = tomllib.load(file)
    return {**targets, "point": {point["name"]: point for point in targets["point"]}}


def misfit(medians, targets):
    """Of medians {total, recorded} of points [mm]."""
    return float(misfits(medians, targets))


def misfits(displacements, targets):
    """Of {total, recorded} [..., point] [mm]: the mean over points of the squares of (displacement less the middle of the paper's
    range) over half its width."""
    terms = [((one - np.mean(targets[key])) / (np.ptp(targets[key]) / 2)) ** 2
             for one, key in zip(displacements, ("total_mm", "recorded_mm"))]
    return np.mean(terms, axis=(0, -1))


def standard_error(statistic, number, draws=2000):
    """Of statistic(rows) over a number of networks, by drawing their rows with replacement."""
    draw = np.random.default_rng(1)
    return np.std([statistic(draw.integers(number, size=number)) for _ in range(draws)], axis=0)


def levels_of(scene, side):
    """Dates and elevations of the excavation north or south of the pier's middle: [(date, level), ...]."""
    sign = {"N": 1, "S": -1}[side]
    ground = np.interp(0, *np.array(scene["in_situ_stress"]["ground_m"], float).T)
    levels = [(scene["schedule"]["start"], ground)]
    for stage in scene["stage"]:
        corners = np.concatenate([np.array(polygon, float) for polygon in stage["remove_m"]])
        if np.any(sign * corners[:, 0] > 0):
            levels.append((stage["date"], min(levels[-1][1], corners[:, 1].min())))
    levels.append((scene["schedule"]["end"], levels[-1][1]))
    return levels
