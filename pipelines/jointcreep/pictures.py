"""Pictures of a study: of each quantity its distribution, how its statistics converge, and what it depends on.

Names of files are those of the quantities in plain words: NAME-distribution.png, NAME-convergence.png, NAME-parameters.png.
pictures.json lists them by quantity.
"""

import json
import textwrap

import matplotlib.ticker
import numpy as np

from . import answers, files, intervals, plots


import figure
from stage_names import plain

BAND = "#c9d8ea"
MOST_PANELS = 6
BAND_POINTS = 60
LABEL = 22  # characters in a line of a label; more are longer than a panel of convergence() is high
FEWEST_BARS = 3  # that a panel has room for, so that one is not broad
CLASSES = 5  # of a parameter, for the share of failed runs
LOGARITHMIC = 8  # the axis of a parameter is logarithmic if its largest value is more than so many times the smallest


def distribution(quantity, study, values, beyond=0):
    """Share of runs up to a value, with the interval of each share. beyond: how many runs more have a larger value, which is not known."""
    plot, axes = figure.plt.subplots(figsize=(figure.ONE_COLUMN, 2.6))
    ordered, n = np.sort(values), len(values) + beyond
    if study.design.are_independent():
        counts = np.unique(np.linspace(1, len(values), min(len(values), BAND_POINTS)).astype(int))
        ends = np.array([intervals.probability(int(count), n)[1:] for count in counts])
        axes.fill_between(ordered[counts - 1], 100 * ends[:, 0], 100 * ends[:, 1], step="post", facecolor=BAND,
                          linewidth=0, label="95 % confidence")
    more = f" ({beyond} at least {answers.LARGEST_FACTOR})" if beyond else ""
    axes.step(ordered, 100 * np.arange(1, len(values) + 1) / n, where="post", color=figure.COLORS[0],
              label=f"{n} {study.design.counted()}{more}")
    limits = [*((limit, "above") for limit in quantity.above), *((limit, "below") for limit in quantity.below)]
    for place, (limit, side) in enumerate(limits):
        axes.axvline(limit, color=figure.COLORS[1], linewidth=0.8, linestyle="--", label="limit" if place == 0 else None)
        axes.annotate(f"{side} {limit:g}", (limit, 50), xytext=(3 if side == "above" else -3, 0), textcoords="offset points", rotation=90,
                      ha="left" if side == "above" else "right", va="center", fontsize=7, color=figure.COLORS[1], path_effects=figure.HALO)
    axes.set_xlabel(quantity.title())
    axes.set_ylabel("runs up to this value (percent)")
    axes.set_ylim(0, 100)
    axes.legend(loc="lower center", bbox_to_anchor=(0.45, 1.0), ncol=3, columnspacing=1, handlelength=1.5)
    return plot


def panels_of(rows):
    """Rows (runs, value, low, high) of the panels of convergence() by their names. Without runs that have no equilibrium a probability of
    stable runs is that of all runs, and has one panel."""
    of = {}
    for name, *row in rows:
        of.setdefault(name, []).append(row)
    for name in [name for name in of if name.endswith(answers.OF_STABLE)]:
        limit = name.removesuffix(answers.OF_STABLE)
        if of.get(limit + answers.OR_NONE) == of[name]:
            of = {limit if one == name else one: own for one, own in of.items() if one != limit + answers.OR_NONE}
    return of


def make_logarithmic(axes, numbers=(1, 2, 5), most=None, ticks=None):
    """Makes the horizontal axis logarithmic, with plain numbers at these multiples of powers of ten, `most` in all or as many as there is
    room for, and ticks at other multiples, or the usual ones."""
    axes.set_xscale("log", subs=ticks)
    axes.xaxis.set_major_locator(matplotlib.ticker.LogLocator(subs=numbers, numticks=most))
    axes.xaxis.set_major_formatter(matplotlib.ticker.StrMethodFormatter("{x:g}"))
    axes.xaxis.set_minor_formatter(matplotlib.ticker.NullFormatter())


def convergence(quantity, rows, stop, counted, order=""):
    """Statistics over the number of runs, each with its interval. order: words on the order of the runs."""
    of_panels = panels_of(rows)
    names = list(of_panels)
    plot, panels = figure.plt.subplots(len(names), 1, figsize=(figure.ONE_COLUMN, 0.6 + 1.7 * len(names)), squeeze=False, sharex=True)
    for axes, name in zip(panels[:, 0], names):
        of = [(runs, value, low, high) for runs, value, low, high in of_panels[name] if low is not None]
        if not of:
            continue
        runs, value, low, high = map(np.array, zip(*of))
        scale = 1 if name == "mean" else 100
        axes.fill_between(runs, scale * low, scale * high, facecolor=BAND, linewidth=0, label="95 % confidence")
        axes.plot(runs, scale * value, color=figure.COLORS[0], marker="o", markersize=2.2, label="value")
        if name == "mean" and quantity.name == stop.of and (stop.half_width or stop.relative_half_width):
            wanted = stop.half_width or stop.relative_half_width * abs(value[-1])
            for end in (value[-1] - wanted, value[-1] + wanted):
                axes.axhline(end, color=figure.COLORS[1], linewidth=0.8, linestyle="--",
                             label="wanted" if end < value[-1] else None)
        if runs[-1] > 5 * runs[0]:
            make_logarithmic(axes)
        else:
            axes.xaxis.set_major_locator(matplotlib.ticker.MaxNLocator(integer=True))
        label = f"mean of {quantity.title()}" if name == "mean" else f"{answers.with_unit(name, quantity)} (percent)"
        axes.set_ylabel("\n".join(textwrap.wrap(label, LABEL)))
        if axes is panels[0, 0]:
            axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=3)
    of_what = "" if quantity.what == "failed" else " with a value" + " (or no equilibrium)" * any("no equilibrium" in name for name in names)
    panels[-1, 0].set_xlabel("\n".join(textwrap.wrap(f"number of {counted}{of_what}{order}", 44)))
    return plot


def parameters(quantity, study, values, run, given, of_shares):
    """The quantity over each parameter, and the shares of the variance or the rank correlations as bars."""
    numeric = [column for column, one in enumerate(study.parameters) if not any(isinstance(value, str) for value in one.values)]
    numeric = numeric[:MOST_PANELS]
    correlations = [one for one in of_shares if one[1] == answers.CORRELATION]
    kinds = [kind for kind in (answers.with_parts(of_shares), [(one, False) for one in correlations]) if kind]
    lines = [numeric[i : i + 3] for i in range(0, len(numeric), 3)]
    if kinds and lines and len(lines[-1]) + len(kinds) <= 3:
        lines[-1] = lines[-1] + kinds
    elif kinds:
        lines.append(kinds)
    plot = figure.plt.figure(figsize=(figure.TWO_COLUMNS, 0.4 + 2.1 * len(lines)))
    of_lines = plot.subfigures(len(lines), 1, squeeze=False)[:, 0]  # labels of one line do not move the panels of another
    panels = [axes for part, line in zip(of_lines, lines) for axes in part.subplots(1, len(line), squeeze=False)[0]]
    for axes, column in zip(panels, numeric):
        of_runs = np.array([given[one]["given"][column] for one in run], float)
        if of_runs.min() > 0 and of_runs.max() > LOGARITHMIC * of_runs.min():
            is_short = of_runs.max() < 30 * of_runs.min()
            make_logarithmic(axes, (1, 2, 5) if is_short else (1,), 8 if is_short else 5, ticks=())
        if quantity.what == "failed":
            share_in_classes(axes, of_runs, values, study.design.are_independent())
        else:
            axes.plot(of_runs, values, linestyle="none", marker="o", markersize=1.8, color=figure.COLORS[0], alpha=0.6, markeredgewidth=0)
        axes.set_xlabel(study.parameters[column].name + "\n(above: number of runs)" * (quantity.what == "failed"))
        axes.set_ylabel(f"{quantity.title()} (percent of runs)" if quantity.what == "failed" else quantity.title())
    for axes, rows in zip(panels[len(numeric):], kinds):
        bars(axes, rows)
    return plot


def share_in_classes(axes, of_runs, failed, are_independent):
    """Share of failed runs in classes of a parameter that have about as many runs each, with their number, and the interval of the share if
    runs are independent."""
    edges = np.unique(np.quantile(of_runs, np.linspace(0, 1, CLASSES + 1)))
    place = np.clip(np.searchsorted(edges, of_runs, side="right") - 1, 0, max(0, len(edges) - 2))
    of_classes = [failed[place == one] for one in range(len(edges) - 1)]
    shares = [100 * each.mean() if len(each) else 0.0 for each in of_classes]
    axes.bar(edges[:-1], shares, np.diff(edges), align="edge", color=figure.COLORS[0], edgecolor="w", linewidth=0.5)
    middles = np.sqrt(edges[1:] * edges[:-1]) if axes.get_xscale() == "log" else (edges[1:] + edges[:-1]) / 2
    for middle, each in zip(middles, of_classes):
        axes.text(middle, 1.0, f"{len(each)}", transform=axes.get_xaxis_transform(), ha="center", va="bottom", fontsize=5, color="0.35")
        if not are_independent or not len(each):
            continue
        _, low, high = intervals.probability(int(each.sum()), len(each))
        axes.plot([middle, middle], [100 * low, 100 * high], color=figure.COLORS[1], linewidth=1.0, marker="_", markersize=4)
    axes.set_ylim(bottom=0)


def bars(axes, rows):
    """Shares of the variance, indices or correlations, with their intervals, as bars. rows: (input, measure, value, low, high), and whether
    this is a part of the bar above."""
    parts = [is_part for _, is_part in rows]
    rows = [row for row, _ in rows]
    for place, ((_, measure, value, low, high), is_part) in enumerate(zip(rows, parts)):
        axes.barh(place, value, color=figure.COLORS[0 if "total" not in measure and not is_part else 4], height=0.35 if is_part else 0.6)
        if low is not None:
            axes.plot([low, high], [place, place], color=figure.COLORS[1], linewidth=1.0, marker="|", markersize=4)
    measures = list(dict.fromkeys(measure for _, measure, *_ in rows))
    labels = [name if len(measures) == 1 else f"{name},\n{measure}" for name, measure, *_ in rows]
    labels = [f"of these: {label}" if is_part else label for label, is_part in zip(labels, parts)]
    axes.set_yticks(range(len(rows)), ["\n".join(textwrap.wrap(label, 24)) for label in labels], fontsize=6)
    for tick, is_part in zip(axes.get_yticklabels(), parts):
        tick.set(color="0.35" if is_part else "k", style="italic" if is_part else "normal")
    middle, half = (len(rows) - 1) / 2, max(len(rows), FEWEST_BARS) / 2
    axes.set_ylim(middle + half, middle - half)
    axes.axvline(0, color="0.6", linewidth=0.6)
    axes.set_xlim((-1, 1) if measures == [answers.CORRELATION] else (min(0, axes.get_xlim()[0]), max(1, axes.get_xlim()[1])))
    axes.set_xlabel(f"{measures[0] if len(measures) == 1 else 'index'},\n95 % confidence", fontsize=7)


def of_histories(out):
    """Draws ensemble.png and ensemble-y.png, the histories of the points over time."""
    for component, name in (("x", "ensemble.png"), ("y", "ensemble-y.png")):
        plots.save("ensemble", out / "ensemble.h5", out / name, component=component)


def write(study, rows, given, found, out):
    """Draws all pictures into the folder."""
    words, written = plain([quantity.name for quantity, _, _ in found]), {}
    if study.histories and (out / "ensemble.h5").exists():
        of_histories(out)
    for word, (quantity, of, of_shares) in zip(words, found if not study.design.directions else []):
        values, run = answers.values_of(study, rows, of["at"])
        if len(values) == 0:  # only bounds of it are known
            continue
        drawn = {}
        if quantity.what != "failed":
            drawn["distribution"] = distribution(quantity, study, values, of.get("beyond", 0))
        over_runs = answers.convergence(study, rows, of["at"])
        if len({runs for name, runs, *_ in over_runs if name == over_runs[0][0]}) > 1:
            order = ", network by network" * (study.design.kind == "networks x parameters")
            drawn["convergence"] = convergence(quantity, over_runs, study.stop, study.design.counted(), order)
        if of_shares:
            drawn["parameters"] = parameters(quantity, study, values, run, given, of_shares)
            counted = len(answers.counted_runs(study, rows, lambda row: True))
            if left := counted - len(values):
                why = "undecided, or without a result" if quantity.what == "failed" else "no value"
                drawn["parameters"].suptitle(f"{left} of {counted} runs are left out: {why}", fontsize=7)
        for name, picture in drawn.items():
            figure.draw_names_as_they_are(picture)
            figure.save(picture, out / f"{word}-{name}.png")
            figure.plt.close(picture)
            written.setdefault(quantity.name, []).append(f"{word}-{name}.png")
    files.write_text(out / "pictures.json", json.dumps(written, indent=1) + "\n")
