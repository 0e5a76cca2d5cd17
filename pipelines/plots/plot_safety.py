#!/usr/bin/python3
"""The largest displacement over the strength reduction factor: stable runs, runs that fail, and the bracket
of the factor of safety.

Needs a result of demsolve --factor-of-safety. Where rock yields, the runs with zones twice as large are drawn, too. A run that
fails has the displacement at its end. The dashed line is the limit at which runs end: a multiple of the displacement of the
run with nearly no slip.
"""

import numpy as np

import figure

STANDS, FAILS, UNDECIDED = 1, 0, -1
KINDS = [(STANDS, "o", "stable"), (FAILS, "x", "fails: ended there"), (UNDECIDED, "s", "undecided")]


def bracket(factor, stands):
    """The two ends of the bracket: the largest factor of a run that stands, and the smallest factor above it of a run that does not stand.
    None for an end that no run gives."""
    low = factor[stands == STANDS].max(initial=-np.inf)
    high = factor[(stands != STANDS) & (factor > low)].min(initial=np.inf)
    return (low if np.isfinite(low) else None), (high if np.isfinite(high) else None)


def draw_runs(axes, factor, stands, displacement, color, label):
    """The runs of a search in the order of their factors, but for the first one, whose strengths are so large that hardly any contact
    slips."""
    order = np.argsort(factor)[1:]
    factor, stands, displacement = factor[order], stands[order], 1e3 * displacement[order]
    stood = stands == STANDS
    axes.plot(factor[stood], displacement[stood], color=color, linewidth=0.8, label=label)
    for kind, marker, _ in KINDS:
        some = stands == kind
        axes.plot(factor[some], displacement[some], color=color, linestyle="none", marker=marker, markersize=4)


def draw(file, safety_displacement=10):
    """Figure of the displacement over the strength reduction factor. safety_displacement: the same option of demsolve."""
    if "/safety" not in file:
        raise figure.NotWanted("this file has no runs of a factor of safety; demsolve --factor-of-safety writes them")
    plot, axes = figure.plt.subplots(figsize=(figure.ONE_COLUMN * 1.2, 2.8))
    plot.says_factor = True
    seen, has_coarse = set(), len(figure.array(file, "/safety/coarse_factor")) > 1
    for prefix, color, label in ("", "k", "zones of the scene"), ("coarse_", figure.COLORS[1], "zones twice as large"):
        if f"/safety/{prefix}factor" in file and len(factor := figure.array(file, f"/safety/{prefix}factor")) > 1:
            stands = figure.array(file, f"/safety/{prefix}stands")
            seen |= set(stands)
            displacement = figure.array(file, f"/safety/{prefix}largest_displacement")
            draw_runs(axes, factor, stands, displacement, color, label if has_coarse else None)
            limit = safety_displacement * displacement[np.argmin(factor)]
            if np.any((displacement >= limit) & (displacement < 1.5 * limit)):  # a run was ended there; else the option was another
                axes.axhline(1e3 * limit, color=color, linewidth=0.6, linestyle="--",
                             label=None if prefix else f"limit: --safety-displacement {safety_displacement:g}")
            low, high = bracket(factor, stands)
            if low is not None and high is not None:
                axes.axvspan(low, high, color=color, alpha=0.15, linewidth=0)
    for kind, marker, label in KINDS:
        if kind in seen:
            axes.plot([], [], color="0.4", linestyle="none", marker=marker, markersize=4, label=label)
    axes.set_yscale("log")
    figure.label_short_log(axes.yaxis)
    axes.set_xlabel("strength reduction factor")
    axes.set_ylabel("largest displacement (mm)")
    axes.legend(fontsize=6)
    return plot


if __name__ == "__main__":
    figure.run(draw, figure.arguments_of(
        __doc__, (["--safety-displacement"], {"type": float, "default": 10, "help": "the same option of demsolve; default: 10"})))
