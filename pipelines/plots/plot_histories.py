#!/usr/bin/python3
"""Displacement histories of the monitoring points over time; with --closed-form column beside the exact answer.

All points that are not on monitoring lines are drawn; if all are on lines,
these (plot_line.py). A point's history ends when it is removed. Displacements count from the in-situ equilibrium, or with --readings from
each point's own first reading, where its curve begins.

With --pair the curves are of pairs of points: the closure, or a component of the displacement of the first point relative to the second;
with --readings since both points have had their first reading.
With --without both runs are drawn, so that the difference is the share of creep, also of a closure.
"""

import matplotlib.lines
import numpy as np

import column_closed_form
import column_difference
import figure

LABELS = {
    "x": "horizontal displacement, to the right",
    "y": "vertical displacement, upward",
    "toward": "horizontal displacement, toward the excavation",
}
OF_PAIRS = {
    "closure": "closure: decrease of the distance",
    "x": "displacement relative to the second point, to the right",
    "y": "displacement relative to the second point, upward",
}


class Histories:
    """Times, names and curves of the chosen points, as rows in which a point is there and has been read."""

    def __init__(self, file, component, point, readings, since_reset):
        self.time = figure.array(file, "/history/time")
        self.event = figure.texts(file, "/history/event")
        names = figure.texts(file, "/history/point")
        if not names:
            raise figure.NotWanted("there is no monitoring point in this file")
        chosen = [figure.name_index(names, name, "point") for name in point] or of_no_line(file, names)
        self.names = [names[i] for i in chosen]
        first = figure.array(file, "/history/first_reading_row")
        values = component_of(file, figure.array(file, "/history/displacement"), component)
        if readings:
            values = values - values[first, np.arange(len(names))]
        if since_reset:
            values = values - values[figure.array(file, "/history/reset_row")]
        self.values = 1e3 * values[:, chosen]  # [mm]
        self.shown = figure.array(file, "/history/present")[:, chosen] == 1
        if readings:
            self.shown &= np.arange(len(self.time))[:, None] >= first[chosen]


class OfPairs:
    """The same of pairs of points: their closure, or the displacement of the first relative to the second, where both are there and, with
    `readings`, have been read."""

    def __init__(self, file, component, pairs, readings):
        self.time = figure.array(file, "/history/time")
        self.event = figure.texts(file, "/history/event")
        names = figure.texts(file, "/history/point")
        place = figure.array(file, "/history/point_position")
        moves = figure.array(file, "/history/displacement")
        present = figure.array(file, "/history/present") == 1
        first_reading = figure.array(file, "/history/first_reading_row")
        self.names, values, shown = [], [], []
        for pair in pairs:
            one, other = (figure.name_index(names, name, "point") for name in pair)
            if one == other:
                raise figure.NotWanted(f"--pair: '{pair[0]}' is there twice; expected two points")
            relative = moves[:, one] - moves[:, other]
            apart = place[one] - place[other]
            of_pair = np.linalg.norm(apart) - np.linalg.norm(apart + relative, axis=1) if component == "closure" else \
                relative[:, "xy".index(component)]
            first = max(first_reading[one], first_reading[other]) if readings else 0
            values.append(of_pair - of_pair[first] if readings else of_pair)
            shown.append(present[:, one] & present[:, other] & (np.arange(len(self.time)) >= first))
            self.names.append(f"{pair[0]} - {pair[1]}")
        self.values, self.shown = 1e3 * np.transpose(values), np.transpose(shown)  # [mm]


def of_no_line(file, names):
    """The points that are given one by one; all if there are none."""
    of_lines = {f"{line['name']} {number}" for line in figure.scene_of(file).get("monitoring_line", [])
                for number in range(1, line["points"] + 1)}
    return [i for i, name in enumerate(names) if name not in of_lines] or list(range(len(names)))


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


def draw_exact(file, axes, names, looks):
    """The closed form as lines, each until its point is removed."""
    column = column_difference.column_of(file)
    time = figure.array(file, "/history/time")
    present = figure.array(file, "/history/present")
    all_names = figure.texts(file, "/history/point")
    for name, look in zip(names, looks):
        end = time[present[:, all_names.index(name)] == 1].max()
        removals = [removal.day for removal in column.removals if removal.day <= end]
        days = sorted([(day, 1) for day in np.linspace(0, end, 400)] + [(day, side) for day in removals for side in (0, 1)])
        if column.points[name] > min((r.bottom for r in column.removals if r.day <= end), default=np.inf):
            days = [(day, side) for day, side in days if (day, side) < (end, 1)]  # it goes with the last removal
        axes.plot([day for day, _ in days],
                  [1e3 * column_closed_form.rise(column, column.points[name], day, side == 0) for day, side in days],
                  color=look["color"], linewidth=0.9, linestyle=look["linestyle"])


def histories_without(path, file, histories):
    """The histories of the result file without creep. histories(file): those that are drawn."""
    with figure.checked(path) as other:
        if figure.texts(other, "/scene") != figure.texts(file, "/scene"):
            raise figure.NotWanted(f"this was made from another scene than {file.filename}; expected a result of the same joints.h5, "
                                   "made by demsolve --no-creep")
        if "creep" in figure.scene_of(file) and "--no-creep" not in figure.texts(other, "/provenance/options")[-1].split():
            raise figure.NotWanted("this run has creep; expected one of demsolve --no-creep")
        if figure.strength_factor_of(other) != figure.strength_factor_of(file):
            raise figure.NotWanted(f"this run has strengths / {figure.strength_factor_of(other):.4g}, and {file.filename} has strengths / "
                                   f"{figure.strength_factor_of(file):.4g}; expected the same")
        return histories(other)


def draw(file, component=None, point=(), readings=False, since_reset=False, without=None, closed_form=None, pair=()):
    """Figure of histories: component "x", "y" (the default) or "toward"; of all points, or those that are named; readings: since each
    point's first, or that of both points of a pair; without: path of a result of the same scene without creep. pair: pairs of points in
    their place, component "closure" (the default), "x" or "y"."""
    component = component or ("closure" if pair else "y")
    if component not in (OF_PAIRS if pair else LABELS):
        raise figure.NotWanted(f"--component {component} is not of {'pairs' if pair else 'single points'}; expected "
                               f"{', '.join(OF_PAIRS if pair else LABELS)}")
    if pair and (point or since_reset or closed_form):
        raise figure.NotWanted("--pair goes with --component, --readings and --without only")

    def histories_of(result):
        return OfPairs(result, component, pair, readings) if pair else Histories(result, component, point, readings, since_reset)

    histories = histories_of(file)
    names = histories.names
    plot, axes = figure.plt.subplots(figsize=(figure.TWO_COLUMNS * 0.8, 3.4))
    looks = [{"color": figure.COLORS[i % 6], "marker": figure.MARKERS[i % 6], "markerfacecolor": "white",
              "markeredgewidth": 0.8, "linewidth": 1.0,
              "linestyle": "-" if without else figure.LINES[i % 6]} for i in range(len(names))]
    exact, title = closed_form == "column", "pair of points" if pair else "monitoring point"
    if exact:
        if component != "y" or readings or since_reset or without:
            raise figure.NotWanted("the column's closed form is vertical, with creep and since the in-situ "
                                   "equilibrium: --component y, and neither --readings nor --without")
        draw_exact(file, axes, names, looks)
        compared = [reading for reading in column_difference.readings(file) if reading.point in names]
        worst = column_difference.largest(compared)
        title = ("markers: computed\nlines: exact, the column's closed form\n"
                 f"largest relative difference: {worst.difference:.1e}\n"
                 f"({worst.place()}; of {len(compared)} readings)")
    entries = []
    for i, (name, look) in enumerate(zip(names, looks)):
        shown = histories.shown[:, i]
        drawn = {**look, "linestyle": "none"} if exact else {**look, "markevery": max(1, len(shown) // 25)}
        axes.plot(histories.time[shown], histories.values[shown, i], zorder=3, **drawn)
        entries.append(matplotlib.lines.Line2D([], [], label=f"point {name}" if exact else name, **look))
    if without:
        other = histories_without(without, file, histories_of)
        thin = {"linestyle": (0, (4, 2)), "linewidth": 0.7}
        for i, look in enumerate(looks):
            shown = other.shown[:, i]
            axes.plot(other.time[shown], other.values[shown, i], zorder=2, **{**look, **thin, "marker": "none"})
        entries.append(matplotlib.lines.Line2D([], [], color="0.3", label="without creep", **thin))

    axes.margins(x=0.02, y=0.05)
    stages = [row for row, name in enumerate(histories.event) if name]
    figure.mark_stages(axes, histories.time[stages], [histories.event[row] for row in stages])
    since = "since the in-situ equilibrium"
    if readings or since_reset:
        since = "since the last reset" if since_reset else "since the first reading of both" if pair else "since each point's first reading"
    if readings and since_reset:
        raise figure.NotWanted("expected either --readings or --since-reset, not both")
    figure.label_time(file, axes, figure.ending_of(file))
    axes.set_ylabel(f"{(OF_PAIRS if pair else LABELS)[component]},\n{since} (mm)")
    if exact:  # its title is long
        place = {"loc": "best", "frameon": True, "framealpha": 1, "edgecolor": "none"}
    else:
        plot.set_figwidth(figure.TWO_COLUMNS)
        place = {"loc": "upper left", "bbox_to_anchor": (1.01, 1), "borderaxespad": 0}
    axes.legend(handles=entries, title=title, title_fontsize=7, alignment="left", **place)
    return plot


if __name__ == "__main__":
    figure.run(draw, figure.arguments_of(
        __doc__,
        (["--component"], {"choices": [*LABELS, "closure"],
                           "help": "toward: horizontal, toward the middle of what is removed; closure: of pairs; default: y, of pairs closure"}),
        (["--point"], {"action": "append", "default": [], "help": "only this point; may be given several times"}),
        (["--pair"], {"action": "append", "nargs": 2, "default": [], "metavar": ("POINT", "OTHER"),
                      "help": "two points in place of one: closure, or displacement of POINT relative to OTHER; may be given several times"}),
        (["--readings"], {"action": "store_true", "help": "displacements since each point's own first reading, of pairs since both have been read"}),
        (["--since-reset"], {"action": "store_true", "help": "displacements since the last stage that resets them"}),
        (["--without"], {"metavar": "RESULT.h5", "help": "the same scene without creep, drawn thin and dashed"}),
        (["--closed-form"], {"choices": ["column"], "help": "draw the exact answer beside"}),
    ))
