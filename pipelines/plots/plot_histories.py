#!/usr/bin/python3
"""Displacement histories of the measuring points against days; with --closed-form column beside the exact answer.

A point's history ends when it is removed. Displacements count from the in-situ equilibrium.
"""

import matplotlib.lines
import numpy as np

import column_closed_form
import figure

LABELS = {
    "x": "horizontal displacement, to the right (mm)",
    "y": "vertical displacement, upward (mm)",
    "toward": "horizontal displacement, toward the excavation (mm)",
}


def component_of(file, displacement, component):
    """One component of the displacements [time, point]; "toward" is positive toward the middle of what is removed."""
    if component != "toward":
        return displacement[:, :, "xy".index(component)]
    corners = [np.mean(polygon, axis=0) for stage in figure.scene_of(file).get("stage", [])
               for polygon in stage["remove_m"]]
    if not corners:
        raise figure.NotWanted("nothing is removed in this scene: --component toward has no direction")
    middle = np.mean(corners, axis=0)[0]
    place = figure.array(file, "/history/point_position")[:, 0]
    return displacement[:, :, 0] * np.where(middle >= place, 1.0, -1.0)


def before_an_event(time, event):
    """Which rows are readings just before what happens at the same time."""
    return np.array([any(time[j] == time[i] and event[j] for j in range(i + 1, len(time)))
                     for i in range(len(time))])


def draw_exact(axes, column, names, time, event, present, values):
    """The closed form as lines; returns the largest relative difference of what was computed [-]."""
    largest = 0.0
    before = before_an_event(time, event)
    for i, name in enumerate(names):
        height = column.points[name]
        exact = np.array([column_closed_form.rise(column, height, t, b) for t, b in zip(time, before)])
        compared = (present[:, i] == 1) & (exact != 0)
        if np.any(compared):
            largest = max(largest, np.max(np.abs(values[compared, i] / exact[compared] - 1)))

        end = time[present[:, i] == 1].max()
        days = np.linspace(0, end, 400)
        jumps = [r.day for r in column.removals if r.day <= end]
        samples = sorted([(t, False) for t in days] + [(t, b) for t in jumps for b in (True, False)],
                         key=lambda sample: (sample[0], not sample[1]))
        samples = [(t, b) for t, b in samples if not (t == end and not b and end in jumps)]
        curve = [1e3 * column_closed_form.rise(column, height, t, b) for t, b in samples]
        axes.plot([t for t, _ in samples], curve, color=figure.COLORS[i % 6], linewidth=0.9,
                  linestyle=figure.LINES[i % 6])
    return largest


def draw(file, arguments):
    time = figure.array(file, "/history/time")
    event = figure.texts(file, "/history/event")
    names = figure.texts(file, "/history/point")
    present = figure.array(file, "/history/present")
    values = component_of(file, figure.array(file, "/history/displacement"), arguments.component)
    chosen = [figure.name_index(names, name, "point") for name in arguments.point] or range(len(names))
    if not names:
        raise figure.NotWanted("there is no measuring point in this file")
    names, present, values = [names[i] for i in chosen], present[:, chosen], values[:, chosen]

    plot, axes = figure.plt.subplots(figsize=(figure.TWO_COLUMNS * 0.8, 3.4))
    exact = arguments.closed_form == "column"
    entries, title = [], None
    if exact:
        if arguments.component != "y":
            raise figure.NotWanted("the column's closed form is vertical: --component y")
        try:
            column = column_closed_form.column_of(figure.scene_of(file))
        except (KeyError, column_closed_form.NotAColumn) as error:
            raise figure.NotWanted(f"the scene is not the closed form's column: {error}") from error
        largest = draw_exact(axes, column, names, time, event, present, values)
        title = ("markers: computed\nlines: exact, the column's closed form\n"
                 f"largest relative difference: {largest:.1e}")
    for i, name in enumerate(names):
        there = present[:, i] == 1
        look = {"color": figure.COLORS[i % 6], "marker": figure.MARKERS[i % 6], "markerfacecolor": "white",
                "markeredgewidth": 0.8, "linewidth": 1.0, "linestyle": figure.LINES[i % 6]}
        shown = {**look, "linestyle": "none"} if exact else {**look, "markevery": max(1, len(time) // 25)}
        axes.plot(time[there], 1e3 * values[there, i], zorder=3, **shown)
        entries.append(matplotlib.lines.Line2D([], [], label=f"point {name}", **look))

    axes.margins(x=0.02, y=0.05)
    for row, name in enumerate(event):
        if name:
            axes.axvline(time[row], color="0.6", linewidth=0.6, zorder=0)
            axes.annotate(name, (time[row], 1.01), xycoords=("data", "axes fraction"), rotation=25, ha="left",
                          va="bottom", rotation_mode="anchor", fontsize=6.5)
    axes.set_xlabel("time since the start (days)")
    axes.set_ylabel(LABELS[arguments.component])
    axes.legend(handles=entries, title=title, title_fontsize=7, alignment="left", loc="best")
    return plot


if __name__ == "__main__":
    figure.run(draw, figure.arguments_of(
        __doc__,
        (["--component"], {"choices": list(LABELS), "default": "y", "help": "default: y"}),
        (["--point"], {"action": "append", "default": [], "help": "only this point; may be given several times"}),
        (["--closed-form"], {"choices": ["column"], "help": "draw the exact answer beside"}),
    ))
