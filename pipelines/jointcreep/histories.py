"""Displacements of monitoring points at any time, from rows that may be on other days in each run.

Rows at dates, before and after what happens then, are in every run. Between dates a value is interpolated by a cubic through
the four nearest rows between the same two dates.
"""

import numpy as np

SAME_DAY = 1e-9  # of a day's number: runs may differ in the last digit


def stages_of(event):
    """How many stages there have been, by row; event: the stage that a row is the first after, "" for others."""
    return np.cumsum([bool(name) for name in event])


def polynomial(time, values, wanted):
    """At a wanted time, the polynomial through values [row, ...] at these times."""
    weight = [np.prod([(wanted - other) / (one - other) for other in time if other != one]) for one in time]
    return np.tensordot(weight, values, axes=1)


def interpolated(time, values, wanted):
    """Values [row, ...] at a wanted time between ascending times, by the four nearest rows; and by three of them."""
    first = max(min(int(np.searchsorted(time, wanted)) - 2, len(time) - 4), 0)
    near, of_near = time[first : first + 4], values[first : first + 4]
    fewer = np.argsort(np.abs(near - wanted))[:3]
    return polynomial(near, of_near, wanted), polynomial(near[fewer], of_near[fewer], wanted)


def at(time, stages, dates, displacement, present, day, wanted_stages):
    """Displacement [point, 2] on a day [m], after so many stages, and which points are there; None if the run has ended before.
    The last value is the uncertainty of interpolation [m].

    time [row] [day]; stages [row]: how many there have been; dates on which something happens [day]; displacement
    [row, point, 2] [m]; present [row, point].
    """
    rows = np.flatnonzero(stages == wanted_stages)
    exact = rows[np.abs(time[rows] - day) <= SAME_DAY * max(1.0, day)]
    if len(exact):
        return displacement[exact[0]], present[exact[0]], 0.0
    low, high = dates[dates < day].max(initial=0), dates[dates > day].min(initial=np.inf)
    rows = rows[(time[rows] >= low) & (time[rows] <= high)]
    days, first = np.unique(time[rows], return_index=True)
    if len(days) == 0 or not days[0] < day < days[-1]:
        return None
    rows = rows[first]
    cubic, parabola = interpolated(days, displacement[rows], day)
    difference = np.linalg.norm(cubic - parabola, axis=-1).max(initial=0)
    return cubic, present[rows[np.searchsorted(days, day)]], float(difference)
