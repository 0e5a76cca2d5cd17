#!/usr/bin/python3
"""The history of the solver's steps: displacement of a point and normal stress at a gauge against accumulated solver time.

Needs a result of demsolve --step-history. Every equilibrium (in situ, stage, creep step) is one piece
of solver time; the axis between the curves says which day it belongs to, and dark lines are where stages begin. A curve
ends when its point or joint is removed.
"""

import re

import numpy as np

import figure


def is_removed(file, point, gauge):
    """Whether the point, and whether the gauge's joint, is gone in the end."""
    contact = figure.array(file, "/step_history/gauge_contact")[gauge]
    return (figure.array(file, "/history/present")[-1, point] == 0,
            figure.array(file, "/states/contact_status")[-1, contact] == 0)


def draw_until_removed(axes, solver_time, values, removed):
    """A curve, without the constant end that a removed thing leaves. Returns the time it ends [s]."""
    changes = np.flatnonzero(values != values[-1])
    rows = changes[-1] + 1 if removed and len(changes) > 0 else len(values)
    axes.plot(solver_time[:rows], values[:rows], color="k", linewidth=0.8)
    return solver_time[rows - 1]


def stage_rows(file):
    """Row of the step history in which each stage begins, by the stage's name. Equilibria share the rows in proportion to
    their solver steps; a stage's are the last ones of its day."""
    steps, at = figure.array(file, "/equilibria/steps"), figure.array(file, "/equilibria/time")
    before = np.concatenate([[0], np.cumsum(steps)])
    rows = len(figure.array(file, "/step_history/time"))
    increments = figure.scene_of(file).get("equilibrium", {}).get("unloading_increments", 1)
    if given := re.search(r"--increments (\d+)", figure.texts(file, "/provenance/options")[-1]):
        increments = int(given[1])
    of_day = {}
    for day, name in zip(figure.array(file, "/history/time"), figure.texts(file, "/history/event")):
        if name:
            of_day.setdefault(day, []).append(name)
    begins = {}
    for day, names in of_day.items():
        after = np.flatnonzero(at == day)[-1] + 1
        for place, name in enumerate(names):
            first = before[after - (len(names) - place) * increments]
            begins[name] = min(rows - 1, round(rows * first / max(1, before[-1])))
    return begins


def spread(places, apart):
    """Which of the ascending places to label, so that labels are so far apart."""
    chosen = []
    for i, place in enumerate(places):
        if not chosen or place - places[chosen[-1]] >= apart:
            chosen.append(i)
    return chosen


def draw(file, point=None, gauge=None, days=(-np.inf, np.inf)):
    """Figure of the steps of dynamic relaxation, at a point and a gauge; the first of each without names."""
    if "/step_history" not in file:
        raise figure.NotWanted("this file has no step history; demsolve --step-history N writes one")
    day = figure.array(file, "/step_history/time")
    solver_time = figure.array(file, "/step_history/solver_time")
    points, gauges = figure.texts(file, "/history/point"), figure.texts(file, "/step_history/gauge")
    point = figure.name_index(points, point, "point")
    gauge = figure.name_index(gauges, gauge, "gauge")
    shown = (day >= days[0]) & (day <= days[1])
    if not np.any(shown):
        raise figure.NotWanted(f"the step history has no row from day {days[0]} to {days[1]}")
    rise = 1e3 * figure.array(file, "/step_history/displacement")[shown, point, 1]
    stress = -1e-6 * figure.array(file, "/step_history/traction")[shown, gauge, 0]
    stages = {name: solver_time[row] for name, row in stage_rows(file).items() if shown[row]}
    day, solver_time = day[shown], solver_time[shown]

    plot, (above, below) = figure.plt.subplots(2, 1, sharex=True, figsize=(figure.TWO_COLUMNS * 0.8, 4.6))
    end = max(draw_until_removed(axes, solver_time, values, removed) for axes, values, removed
              in zip((above, below), (rise, stress), is_removed(file, point, gauge)))
    day, solver_time = day[solver_time <= end], solver_time[solver_time <= end]
    above.set_ylabel(f"vertical displacement\nof point {points[point]}, upward (mm)")
    below.set_ylabel(f"normal stress at {gauges[gauge]},\ncompressive (MPa)")
    below.set_xlabel("accumulated solver time (s)")
    for axes in (above, below):
        axes.margins(x=0.01)

    days, first = np.unique(day, return_index=True)
    for row in first:
        for axes in (above, below):
            axes.axvline(solver_time[row], color="0.88", linewidth=0.5, zorder=-1)
    for axes in (above, below):
        figure.mark_stages(axes, [t for t in stages.values() if t <= end],
                           [name for name, t in stages.items() if t <= end], axes is above)
    labelled = spread(solver_time[first], 0.065 * np.ptp(solver_time))
    between = below.secondary_xaxis("top")
    between.set_xticks(solver_time[first[labelled]], [f"{days[i]:.4g}" for i in labelled])
    between.set_xlabel("time since the start (days)")  # the axis itself is the solver's time
    return plot


if __name__ == "__main__":
    figure.run(draw, figure.arguments_of(
        __doc__,
        (["--point"], {"help": "default: the first"}),
        (["--gauge"], {"help": "default: the first"}),
        (["--days"], {"nargs": 2, "type": float, "default": [-np.inf, np.inf], "metavar": ("FROM", "TO"),
                      "help": "default: all"}),
    ))
