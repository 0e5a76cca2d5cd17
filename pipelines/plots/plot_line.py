#!/usr/bin/python3
"""Displacements along monitoring lines: across the line, as an inclinometer measures, and along it, as an extensometer does.

A curve for each stage, just after its excavation, and one for the end. The distance is from the line's first end. Displacements
count from the in-situ equilibrium, or with --readings from the line's own first reading: earlier stages have no curve. With
--anchor they are those relative to the line's last point, as of an extensometer that is anchored there. Points that are
excavated are left out.
"""

import matplotlib.ticker
import numpy as np

import figure


def lines_of(file, wanted):
    """The monitoring lines of the scene, as tomllib reads them: all, or those of these names."""
    lines = figure.scene_of(file).get("monitoring_line", [])
    if not lines:
        raise figure.NotWanted("its scene has no [[monitoring_line]]")
    names = [line["name"] for line in lines]
    return [lines[figure.name_index(names, name, "monitoring line")] for name in wanted] or lines


def rows_of(file):
    """Rows of the histories just after each stage, and the last one: (row, label)."""
    event = figure.texts(file, "/history/event")
    time = figure.array(file, "/history/time")
    rows = [(row, f"{name}, {figure.day_of(file, time[row])}") for row, name in enumerate(event) if name]
    if not rows or rows[-1][0] != len(event) - 1:
        rows.append((len(event) - 1, f"end, {figure.day_of(file, time[-1])}"))
    return rows


def first_reading(file, line):
    """Row of the histories that is the line's first reading."""
    point = figure.texts(file, "/history/point").index(f"{line['name']} 1")
    return figure.array(file, "/history/first_reading_row")[point]


def displacements(file, line, readings, anchor):
    """Distance of its points from the first end [m], and displacements [row, point, (across, along)] [m]; not finite where a point is
    excavated. Across is to the right of the way from the first end to the other. With `anchor` relative to the last point."""
    names = figure.texts(file, "/history/point")
    first = names.index(f"{line['name']} 1")
    points = slice(first, first + line["points"])
    place = figure.array(file, "/history/point_position")[points]
    along = (place[-1] - place[0]) / np.linalg.norm(place[-1] - place[0])
    moved = figure.array(file, "/history/displacement")[:, points]
    if readings:
        moved = moved - moved[figure.array(file, "/history/first_reading_row")[first]]
    moved = np.where(figure.array(file, "/history/present")[:, points, None] == 1, moved, np.nan)
    if anchor:
        moved = moved - moved[:, -1:]
    across = np.array([along[1], -along[0]])
    return (place - place[0]) @ along, np.stack([moved @ across, moved @ along], axis=-1)


def look(number, of):
    """Of one curve of so many: of a few its own colour, marker and line, of many a colour from dark, early, to light, late."""
    if of > len(figure.COLORS):
        return {"color": figure.plt.get_cmap("viridis")(0.95 * number / (of - 1)), "linewidth": 0.9}
    return {"color": figure.COLORS[number], "marker": figure.MARKERS[number], "markerfacecolor": "white", "markeredgewidth": 0.8,
            "linestyle": figure.LINES[number]}


def draw(file, line=(), readings=False, anchor=False):
    """Figure of monitoring lines: of all, or those that are named; readings: since the line's first; anchor: relative to its last
    point."""
    lines, rows = lines_of(file, line), rows_of(file)
    plot, axes = figure.plt.subplots(len(lines), 2, figsize=(figure.TWO_COLUMNS, 2.6 * len(lines) + 0.5), squeeze=False, sharey="row")
    since = "since the first reading" if readings else "since the in-situ equilibrium"
    for one, pair in zip(lines, axes):
        distance, moved = displacements(file, one, readings, anchor)
        begin = first_reading(file, one) if readings else 0
        for i, ax in enumerate(pair):
            for number, (row, label) in enumerate(rows):
                if row < begin:
                    continue
                ax.plot(1e3 * moved[row, :, i], distance, label=label, **look(number, len(rows)))
            ax.axvline(0, color="0.6", linewidth=0.5, zorder=0)
            ax.xaxis.set_major_locator(matplotlib.ticker.MaxNLocator(5))
            ax.set_xlabel(("across the line, + to the right\nas seen toward its last point (mm)", "along the line,\n+ toward its last point (mm)")[i])
        pair[0].set_title(one["name"], loc="left")
        pair[0].set_ylabel("distance from the first end (m)")
        if one["to_m"][1] - one["from_m"][1] < -abs(one["to_m"][0] - one["from_m"][0]):  # as it goes down
            pair[0].invert_yaxis()
    plot.suptitle(f"displacements {'relative to the last point, ' if anchor else ''}{since}", fontsize=8)
    shown = dict(reversed([(label, line) for pair in axes for line, label in zip(*pair[1].get_legend_handles_labels())]))  # of all lines
    labels = [label for _, label in rows if label in shown]
    axes[0, 1].legend([shown[label] for label in labels], labels, loc="upper left", bbox_to_anchor=(1.02, 1), borderaxespad=0)
    return plot


if __name__ == "__main__":
    figure.run(draw, figure.arguments_of(
        __doc__,
        (["--line"], {"action": "append", "default": [], "help": "only this line; may be given several times"}),
        (["--readings"], {"action": "store_true", "help": "displacements since the line's own first reading"}),
        (["--anchor"], {"action": "store_true", "help": "displacements relative to the line's last point, as of an extensometer"}),
    ))
