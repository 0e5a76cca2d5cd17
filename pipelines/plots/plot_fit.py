#!/usr/bin/python3
"""What creepfit was given and what it found: measured displacements as markers, computed ones as lines.

Reads what `creepfit --readings` writes, of a curve or of a section's points; with points, thin dashed lines are the displacements with the
constants of the scene, before the fit. The lines include the errors of instruments that were found. Lines are broken at stages.
Residuals are below.
"""

import csv
import math
import sys
from pathlib import Path

import figure


def rows_of(path):
    """(name of the curve, day, stages done, measured, computed, computed at start or None) of every reading, in mm."""
    with open(path, newline="") as file:
        table = csv.DictReader(file)
        if not {"time_day", "measured_mm", "computed_mm"} <= set(table.fieldnames or []):
            raise figure.NotWanted("this is no table of readings from creepfit")
        for row in table:
            name = f"{row['point']}, {row['component']}" if "point" in row else "curve"
            start = row.get("computed_at_start_mm")
            yield (name, float(row["time_day"]), int(row.get("stages") or 0), float(row["measured_mm"]),
                   float(row["computed_mm"]) + float(row.get("instrument_mm") or 0), None if start is None else float(start))


def broken(stages, values):
    """Values with a gap, NaN, before each that has more stages behind it than the one before."""
    with_gaps = []
    for i, value in enumerate(values):
        if i > 0 and stages[i] != stages[i - 1]:
            with_gaps.append(math.nan)
        with_gaps.append(value)
    return with_gaps


def draw(rows):
    curves = {}
    for name, *values in rows:
        curves.setdefault(name, []).append(values)
    plot, (axes, below) = figure.plt.subplots(2, 1, sharex=True, figsize=(figure.TWO_COLUMNS, 4.2),
                                              gridspec_kw={"height_ratios": [3, 1]})
    for i, (name, values) in enumerate(curves.items()):
        day, stages, measured, computed, start = zip(*sorted(values))
        color, marker = figure.COLORS[i % 6], figure.MARKERS[i % 6]
        face = color if i // 6 % 2 else "white"
        axes.plot(day, measured, marker, color=color, markerfacecolor=face, markeredgewidth=0.8, label=name)
        axes.plot(broken(stages, day), broken(stages, computed), color=color, linewidth=1.0)
        if start[0] is not None:
            axes.plot(broken(stages, day), broken(stages, start), color=color, linewidth=0.7, linestyle=(0, (4, 2)))
        below.plot(day, [c - m for c, m in zip(computed, measured)], marker, color=color, markerfacecolor=face,
                   markeredgewidth=0.8)
    below.axhline(0, color="0.3", linewidth=0.7)
    axes.set_ylabel("displacement (mm)")
    below.set_ylabel("computed less\nmeasured (mm)")
    below.set_xlabel("time (days)")
    has_start = any(values[0][-1] is not None for values in curves.values())
    axes.legend(title="markers: measured\nlines: fitted" + ("\ndashed: with the scene's\nconstants" if has_start else ""),
                title_fontsize=7, alignment="left", loc="upper left", bbox_to_anchor=(1.01, 1), borderaxespad=0)
    return plot


def main():
    arguments = figure.arguments_of(__doc__)
    try:
        plot = draw(rows_of(arguments.file))
    except (OSError, ValueError, figure.NotWanted) as error:
        print(f"{Path(sys.argv[0]).name}: {arguments.file}: {error}", file=sys.stderr)
        sys.exit(2)
    try:
        figure.save(plot, Path(arguments.output))
    except (OSError, ValueError) as error:
        print(f"{Path(sys.argv[0]).name}: {arguments.output}: {error}", file=sys.stderr)
        sys.exit(4)


if __name__ == "__main__":
    main()
