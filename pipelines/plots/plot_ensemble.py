#!/usr/bin/python3
"""Displacement histories of many realizations: bands of quantiles, the median, and the mean with its confidence.

One panel a monitoring point; those of monitoring lines only if there are no others. Needs ensemble.h5, which jointcreep study writes.
"""

import matplotlib.lines
import matplotlib.patches
import numpy as np

import figure
from plot_histories import of_no_line

LABELS = {"x": "horizontal displacement, to the right (mm)", "y": "vertical displacement, upward (mm)"}
BANDS = [(0.05, 0.95, "#c9d8ea"), (0.25, 0.75, "#87a9cf")]
MEDIAN = {"color": figure.COLORS[0], "linewidth": 1.0}
MEAN = {"color": figure.COLORS[1], "linestyle": "none", "marker": "o", "markersize": 2.6, "markerfacecolor": "white",
        "markeredgewidth": 0.8, "elinewidth": 0.8, "capsize": 1.8, "capthick": 0.8}


def draw_point(axes, time, statistics, probabilities, there, every):
    """Bands, median and mean of one point; `statistics` by name, the quantiles [probability, time], all in mm."""
    row = {round(100 * p): i for i, p in enumerate(probabilities)}
    quantile = statistics["quantile"][:, there]
    for low, high, shade in BANDS:
        axes.fill_between(time[there], quantile[row[round(100 * low)]], quantile[row[round(100 * high)]],
                          facecolor=shade, linewidth=0)
    axes.plot(time[there], quantile[row[50]], **MEDIAN)
    shown = np.flatnonzero(there)[::-every][::-1]  # with the last one
    mean, low, high = (statistics[name][shown] for name in ("mean", "mean_low", "mean_high"))
    axes.errorbar(time[shown], mean, yerr=[mean - low, high - mean], zorder=3, **MEAN)


def draw(file, component="x", point=(), since_first_reading=False):
    """A figure of an open ensemble.h5: one component ("x", "y"), of the points that are named, else of all that are not on lines."""
    kind = "/displacement_since_first_reading" if since_first_reading else "/displacement"
    time = figure.array(file, "/history/time")
    event = figure.texts(file, "/history/event")
    names = figure.texts(file, "/history/point")
    chosen = [figure.name_index(names, name, "point") for name in point] or of_no_line(file, names)
    if not chosen:
        raise figure.NotWanted("there is no monitoring point in this file")
    probabilities = figure.array(file, "/probability")
    count = figure.array(file, kind + "/count")
    of_component = "xy".index(component)
    statistics = {name: 1e3 * figure.array(file, f"{kind}/{name}")[..., of_component]
                  for name in ("mean", "mean_low", "mean_high", "quantile")}

    columns = min(2, len(chosen))
    rows = -(-len(chosen) // columns)
    plot, panels = figure.plt.subplots(rows, columns, sharex=True, squeeze=False,
                                       figsize=(figure.TWO_COLUMNS, max(3.2, 1.0 + 1.6 * rows)))
    panels = panels.ravel()
    stages = [row for row, name in enumerate(event) if name]
    for axes, point in zip(panels, chosen):
        of_point = {name: values[..., point] for name, values in statistics.items()}
        draw_point(axes, time, of_point, probabilities, count[:, point] > 1, max(1, len(time) // 12))
        figure.mark_stages(axes, time[stages], [event[row] for row in stages], axes in panels[:columns])
        axes.axhline(0, color="0.8", linewidth=0.5, zorder=0)
        axes.margins(x=0.02, y=0.06)
        axes.legend(handles=[], title=names[point], loc="best", borderpad=0, title_fontsize=8)  # where it hides least
    for axes in panels[len(chosen):]:
        axes.set_visible(False)
    for axes in panels[max(0, len(chosen) - columns):len(chosen)]:
        figure.label_time(file, axes, most_dates=4 if columns > 1 else None)
        axes.tick_params(labelbottom=True)
    since = ", since the first reading" if since_first_reading else ""
    plot.supylabel(LABELS[component].replace(" (mm)", since + " (mm)"), fontsize=8)

    number = len(figure.array(file, "/run/number"))
    failed = len(figure.array(file, "/failed/number"))
    entries = [matplotlib.patches.Patch(facecolor=shade, label=f"{100 * low:.0f} to {100 * high:.0f} percent")
               for low, high, shade in BANDS]
    entries.append(matplotlib.lines.Line2D([], [], label="median", **MEDIAN))
    entries.append(panels[0].errorbar([], [], yerr=[], label="mean with its 95 percent confidence interval", **MEAN))
    title = f"{number} runs" + (f" ({failed} more failed or undecided)" if failed else "")
    below = 0.42 / plot.get_figheight()  # for the legend
    plot.get_layout_engine().set(rect=(0, below, 1, 1 - below))
    plot.legend(handles=entries, title=title, title_fontsize=7, loc="lower center", ncol=4)
    return plot


if __name__ == "__main__":
    figure.run(draw, figure.arguments_of(
        __doc__,
        (["--component"], {"choices": list(LABELS), "default": "x", "help": "default: x"}),
        (["--point"], {"action": "append", "default": [], "help": "only this point; may be given several times"}),
        (["--since-first-reading"], {"action": "store_true", "help": "count from each point's own first reading"}),
    ))
