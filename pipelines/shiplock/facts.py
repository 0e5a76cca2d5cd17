#!/usr/bin/python3
"""What the page of the shiplock says of its networks beside the table of points.

    facts.py REALIZATIONS TARGETS.toml -o facts.md

Of the results in the folder REALIZATIONS: by how much medians of the points clear their ranges and what chance does to
them, the motion of a point before its bench is dug, both slopes, the pier, and rock in tension.
"""

import argparse
import datetime
import pathlib

import numpy as np

import records
from records import figure

PIER_HALF_WIDTH, PIER_LEVEL = 28.5, 150.0  # of the places by which the pier is judged [m]
WALL_TOPS = ("N160", "S160")
BOX = (-220, 220, 60)  # joints are between these x, and above this y [m]
OTHER_READINGS = {"N170": datetime.date(1997, 4, 30), "S160": datetime.date(1997, 10, 31)}
TENSILE_STRENGTH = 1.5e6  # assumed of fresh rock [Pa]


def day_dug(record, point):
    """Day on which the bench of a point is dug: that of the first stage that reaches below it on its side."""
    x, y = record.position[point]
    return next(record.day_of(date) for date, level in records.levels_of(record.scene, "N" if x > 0 else "S") if level < y + 2)


def pier(file):
    """Displacement of the north and the south wall of the pier in the end, +x [mm]."""
    places = figure.array(file, "/mesh/gridpoint_position")
    zones = figure.array(file, "/mesh/zone_gridpoint")[figure.array(file, "/states/zone_present")[-1] == 1]
    there = np.unique(zones)
    moved = 1e3 * figure.array(file, "/states/displacement")[-1, :, 0]
    walls = np.array([[PIER_HALF_WIDTH, PIER_LEVEL], [-PIER_HALF_WIDTH, PIER_LEVEL]])
    return [moved[there[np.argmin(np.hypot(*(places[there] - wall).T))]] for wall in walls]


def tension(file):
    """Shares of the jointed box's rock whose largest principal stress is above 0 and above its strength, and that stress."""
    places = figure.array(file, "/mesh/gridpoint_position")[figure.array(file, "/mesh/zone_gridpoint")]
    a, b = places[:, 1] - places[:, 0], places[:, 2] - places[:, 0]
    area = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2
    x, y = places.mean(axis=1).T
    inside = (figure.array(file, "/states/zone_present")[-1] == 1) & (x > BOX[0]) & (x < BOX[1]) & (y > BOX[2])
    xx, yy, xy = figure.array(file, "/states/stress")[-1][inside].T
    largest = (xx + yy) / 2 + np.hypot((xx - yy) / 2, xy)
    area = area[inside] / area[inside].sum()
    return area[largest > 0].sum(), area[largest > TENSILE_STRENGTH].sum(), largest.max()


def facts_of(path, end):
    with figure.opened(path) as file:
        record = records.record_of(file)
        points = range(len(record.names))
        return {"names": record.names, "pier": pier(file), "tension": tension(file),
                "total": [record.at(record.total, end, i)[1] for i in points],
                "recorded": [record.at(record.recorded, end, i)[1] for i in points],
                "other": [record.at(record.total, end, i)[1] - record.at(record.total, date, i)[1]
                          for i, date in ((record.names.index(name), date) for name, date in OTHER_READINGS.items())],
                "after": [record.total[1, -1, i] - record.at(record.total, end, i)[1] for i in points],
                "before": [np.interp(day_dug(record, i) - 1e-6, record.days, record.total[1, :, i]) for i in points]}


def spread(values, digits=0):
    low, median, high = np.quantile(values, (records.LOW, records.MEDIAN, records.HIGH))
    return f"{median:.{digits}f} ({low:.{digits}f} to {high:.{digits}f})"


def markdown(facts, targets):
    names, number = facts[0]["names"], len(facts)
    values = {key: np.array([one[key] for one in facts], float) for key in ("pier", "tension", "total", "recorded", "other", "after", "before")}
    lines = []
    for key in ("total", "recorded"):
        low, high = targets[f"{key}_mm"]
        error = records.standard_error(lambda rows, of=values[key]: np.median(of[rows], axis=0), number)
        median = np.median(values[key], axis=0)
        room = np.minimum(median - low, high - median)
        room[[targets["point"].get(name, {}).get("crest", False) for name in names]] = np.inf
        i = int(np.argmin(room))
        lines.append(f"- {key}: the median nearest to an end of {low}-{high} mm is that of {names[i]}, {median[i]:.1f} mm, "
                     f"with a standard error of {error[i]:.1f} mm (by bootstrap over networks);")
    total = dict(zip(names, np.median(values["total"], axis=0)))
    wall = max(value for name, value in total.items() if name in WALL_TOPS)
    slope = max(value for name, value in total.items() if name not in WALL_TOPS)
    for words, value, key in (("wall tops", wall, "wall_top_limit_mm"), ("all other points", slope, "slope_top_limit_mm")):
        lines.append(f"- the largest total of {words} is {value:.0f} mm; the published limit, by another model, is {targets[key]} mm;")
    lines.append(f"- after 1999 the median of no point moves by more than {np.median(values['after'], axis=0).max():.1f} mm (range: at "
                 f"most {targets['after_1999_mm']} mm);")
    before = np.median(values["before"], axis=0)
    lines.append(f"- just before its bench is excavated a point has moved by {before.min():.0f} to {before.max():.0f} mm (medians; at "
                 f"most {values['before'].max():.0f} mm in any network);")
    others = ", ".join(f"{name} {median:.1f} mm from {date}"
                       for (name, date), median in zip(OTHER_READINGS.items(), np.median(values["other"], axis=0)))
    lines.append(f"- records with other first readings: {others};")
    north, south = (values["total"][:, names.index(name)] for name in ("N215", "S215"))
    lines.append(f"- at 215 the north has moved more than the south in {np.sum(north > south)} of the {number} networks;")
    to_north, to_south = values["pier"].T
    mean = (to_north + to_south) / 2
    widening = to_north - to_south
    lines.append(f"- the pier widens at {PIER_LEVEL:.0f} m by {spread(widening)} mm, in {np.sum(widening > 0)} of {number} networks; "
                 f"its middle moves by {abs(mean.mean()):.0f} mm to the {'north' if mean.mean() > 0 else 'south'} on average, "
                 f"with a standard deviation of {mean.std(ddof=1):.0f} mm;")
    any_tension, beyond, largest = np.median(values["tension"], axis=0)
    lines.append(f"- at the end {100 * any_tension:.0f} percent of the rock in the jointed box is in tension, "
                 f"{100 * beyond:.1f} percent above {TENSILE_STRENGTH / 1e6:g} MPa, up to {largest / 1e6:.0f} MPa (medians).")
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("realizations", type=pathlib.Path)
    parser.add_argument("targets", type=pathlib.Path)
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    targets = records.targets_of(arguments.targets)
    paths = sorted(arguments.realizations.glob("[0-9]*.h5"))
    if not paths:
        parser.error(f"no results in {arguments.realizations}")
    facts = [facts_of(path, targets["end_of_record"]) for path in paths]
    arguments.output.write_text(markdown(facts, targets), encoding="utf-8")


if __name__ == "__main__":
    main()
