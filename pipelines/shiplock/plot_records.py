#!/usr/bin/python3
"""Displacements of the points of one slope toward the lock, and the excavation's level beneath: the paper's Figs 13
and 14. With a run without creep beside, and the ranges inferred from the paper, if wanted.

FILE.h5 is a result of demsolve, or an ensemble.h5: then median and 5 to 95 percent of the networks are drawn.
"""

import datetime

import matplotlib.dates
import matplotlib.lines
import matplotlib.patches
import numpy as np

import records
from records import figure

TOTAL, RECORDED = figure.COLORS[0], figure.COLORS[1]
SHADES = {TOTAL: "#c3c9dd", RECORDED: "#ecccc9"}
WITHOUT = {"linestyle": (0, (3, 2)), "linewidth": 0.8}


def draw_curves(axes, record, dates, curves, point, color, label_band):
    low, median, high = curves[:, :, point]
    if label_band:
        axes.fill_between(dates, low, high, facecolor=SHADES[color], linewidth=0, alpha=0.8, zorder=1)
    axes.plot(dates, median, color=color, linewidth=1.1, zorder=3)


def draw_bands(axes, targets, end, days):
    """Boxes at the right: the ranges inferred from the paper, at the end of the record."""
    for i, (key, color) in enumerate((("total_mm", TOTAL), ("recorded_mm", RECORDED))):
        low, high = targets[key]
        left = matplotlib.dates.date2num(end) + days * (0.02 + 0.035 * i)
        axes.add_patch(matplotlib.patches.Rectangle((left, low), 0.03 * days, high - low, facecolor="white",
                                                    edgecolor=color, hatch="/////", linewidth=0.8, zorder=4))


def draw(file, side, without=None, targets=None):
    record = records.record_of(file)
    other = None
    if without:
        with figure.checked(without) as other_file:
            other = records.record_of(other_file)
        if other.names != record.names:
            raise figure.NotWanted(f"{without} has other points")
    targets = records.targets_of(targets)
    chosen = [i for i, name in enumerate(record.names) if name.startswith(side)]
    if not chosen:
        raise figure.NotWanted(f"no point's name begins with {side}")
    chosen.sort(key=lambda i: -record.position[i, 1])
    dates_of = lambda one: [datetime.datetime.combine(one.start, datetime.time()) + datetime.timedelta(float(day))
                            for day in one.days]
    dates = np.array(dates_of(record))
    end = targets.get("end_of_record", record.scene["schedule"]["end"])
    span = record.days[-1]

    rows = -(-len(chosen) // 2)
    plot, panels = figure.plt.subplots(rows + 1, 2, sharex=True, figsize=(figure.TWO_COLUMNS, 1.9 + 1.45 * rows),
                                       height_ratios=[1.45] * rows + [0.9], squeeze=False)
    top = max(record.total[:, :, chosen].max(), 90)
    for axes, i in zip(panels[:rows].ravel(), chosen):
        several = record.number > 1
        draw_curves(axes, record, dates, record.total, i, TOTAL, several)
        since = slice(record.first[i], None)
        draw_curves(axes, record, dates[since], record.recorded[:, since], i, RECORDED, several)
        if other:
            other_dates = np.array(dates_of(other))
            axes.plot(other_dates, other.total[1, :, i], color=TOTAL, zorder=2, **WITHOUT)
            since = slice(other.first[i], None)
            axes.plot(other_dates[since], other.recorded[1, since, i], color=RECORDED, zorder=2, **WITHOUT)
        if record.names[i] in targets["point"]:
            draw_bands(axes, targets["point"][record.names[i]], record.scene["schedule"]["end"], span)
            axes.axvline(end, color="0.5", linewidth=0.5, linestyle=":", zorder=0)
        axes.set_ylim(min(0, record.total[:, :, chosen].min()) - 3, 1.05 * top)
        axes.axhline(0, color="0.8", linewidth=0.5, zorder=0)
        axes.annotate(record.names[i], (0, 1), xycoords="axes fraction", xytext=(5, -5), textcoords="offset points",
                      ha="left", va="top", path_effects=figure.HALO)
    for axes in panels[:rows].ravel()[len(chosen):]:
        axes.set_visible(False)
    panels[0, 0].set_xlim(dates[0], dates[-1] + datetime.timedelta(0.1 * span))
    for axes in panels[:rows, 0]:
        axes.set_ylabel("toward the lock\n(mm)")

    levels = records.levels_of(record.scene, side)
    for axes in panels[rows]:
        axes.plot([date for date, _ in levels], [level for _, level in levels], drawstyle="steps-post", color="k",
                  linewidth=1.0)
        axes.xaxis.set_major_locator(matplotlib.dates.YearLocator())
        axes.xaxis.set_major_formatter(matplotlib.dates.DateFormatter("%Y"))
        axes.set_xlabel("beginning of the year")
        axes.margins(y=0.12)
    panels[rows, 0].set_ylabel("excavated to\n(m)")

    line = matplotlib.lines.Line2D
    several = record.number > 1
    entries = [line([], [], color=TOTAL, linewidth=1.1, label="since mid 1994" + (", median" if several else "")),
               line([], [], color=RECORDED, linewidth=1.1, label="since the first reading")]
    if several:
        entries.append(matplotlib.patches.Patch(facecolor="#d5cdd3", label="5 to 95 percent of the networks"))
    if other:
        entries.append(line([], [], color="0.3", label="without creep", **WITHOUT))
    if targets["point"]:
        entries.append(matplotlib.patches.Patch(facecolor="white", edgecolor="0.3", hatch="/////",
                                                label="range inferred from the paper, end of 1999"))
    columns = min(len(entries), 3)
    below = (0.14 + 0.15 * -(-len(entries) // columns)) / plot.get_figheight()
    plot.get_layout_engine().set(rect=(0, below, 1, 1 - below))
    plot.legend(handles=entries, loc="lower center", ncol=columns, columnspacing=1.2, handlelength=1.8)
    return plot


if __name__ == "__main__":
    figure.run(draw, figure.arguments_of(
        __doc__,
        (["--side"], {"choices": ["N", "S"], "required": True, "help": "north or south: how names of points begin"}),
        (["--without"], {"metavar": "FILE.h5", "help": "the same without creep"}),
        (["--targets"], {"metavar": "TARGETS.toml", "help": "ranges of the points"}),
    ))
