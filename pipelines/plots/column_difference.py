#!/usr/bin/python3
"""How far a computed column is from its closed form.

    column_difference.py RESULT.h5 [--within 1e-3]

compares the rise of every monitoring point at every recorded time with column_closed_form.py, from the first removal
until the point is removed itself, and prints the largest relative difference and where it is. Exit code 1 if that is
not within the bound, or if a point moves before anything is removed.
"""

import argparse
import sys
from dataclasses import dataclass

import numpy as np

import column_closed_form
import figure


@dataclass
class Reading:
    point: str
    row: int  # of the histories
    day: float
    side: str  # of what happens on that day: "before", "after", or "" if nothing does
    computed: float  # rise since the in-situ equilibrium [m]
    exact: float  # [m]

    @property
    def difference(self):
        """Relative to the exact rise [-]."""
        return abs(self.computed / self.exact - 1)

    def place(self):
        return f"{self.point}, {f'just {self.side} ' if self.side else ''}day {self.day:g}"


def sides(time, event):
    """Of every row: "before" or "after" an event of the same time, or ""."""
    return ["after" if event[i] else
            "before" if any(time[j] == time[i] and event[j] for j in range(i + 1, len(time))) else ""
            for i in range(len(time))]


def column_of(file):
    try:
        return column_closed_form.column_of(figure.scene_of(file))
    except (KeyError, column_closed_form.NotAColumn) as error:
        raise figure.NotWanted(f"the scene is not the closed form's column: {error}") from error


def readings(file):
    """All readings of points that are there and should have moved."""
    column = column_of(file)
    time = figure.array(file, "/history/time")
    present = figure.array(file, "/history/present")
    rise = figure.array(file, "/history/displacement")[:, :, 1]
    found = []
    for row, side in enumerate(sides(time, figure.texts(file, "/history/event"))):
        for i, point in enumerate(figure.texts(file, "/history/point")):
            exact = column_closed_form.rise(column, column.points[point], time[row], side == "before")
            if present[row, i] and exact != 0:
                found.append(Reading(point, row, float(time[row]), side, float(rise[row, i]), exact))
    if not found:
        raise figure.NotWanted("no monitoring point moves in this file")
    return found


def early_motion(file):
    """Largest displacement before the first removal, when there must be none [m]."""
    before = figure.array(file, "/history/time") < min(r.day for r in column_of(file).removals)
    return float(np.max(np.abs(figure.array(file, "/history/displacement")[before]), initial=0.0))


def largest(of):
    return max(of, key=lambda reading: reading.difference)


def main():
    parser = argparse.ArgumentParser(description="How far a computed column is from its closed form.")
    parser.add_argument("file", metavar="RESULT.h5")
    parser.add_argument("--within", metavar="BOUND", type=float, help="exit code 1 beyond it")
    arguments = parser.parse_args()
    with figure.opened(arguments.file) as file:
        found = readings(file)
        worst, early = largest(found), early_motion(file)
    print(f"largest relative difference to the closed form: {worst.difference:.1e} "
          f"({worst.place()}; of {len(found)} readings)")
    if arguments.within is None:
        return
    if not worst.difference <= arguments.within:
        sys.exit(f"column_difference.py: {arguments.file}: that is not within {arguments.within:g}")
    if not early <= arguments.within * abs(worst.exact):
        sys.exit(f"column_difference.py: {arguments.file}: a point moves by {early:g} m before anything is removed")


if __name__ == "__main__":
    main()
