#!/usr/bin/python3
"""The largest displacement over the strength reduction factor: stable runs, runs that fail, and the bracket
of the factor of safety.

Needs a result of demsolve --factor-of-safety. Where rock yields, the runs with zones twice as large are drawn, too. A run without
equilibrium has the displacement when it was ended: before later stages, it can be less than that of stable runs. The dashed line is
the limit at which runs end: a multiple of the displacement of the run with nearly no slip.
"""

import matplotlib.lines
import matplotlib.patches
import numpy as np

import figure

STANDS, FAILS, UNDECIDED = 1, 0, -1
KINDS = [(STANDS, "o", "stable"), (FAILS, "x", "no equilibrium (displacement when the run was ended)"), (UNDECIDED, "s", "undecided")]
DECADES = 2  # of displacements on a linear axis at most


def bracket(factor, stands):
    """The two ends of the bracket: the largest factor of a run that stands, and the smallest factor above it of a run that does not stand.
    None for an end that no run gives."""
    low = factor[stands == STANDS].max(initial=-np.inf)
    high = factor[(stands != STANDS) & (factor > low)].min(initial=np.inf)
    return (low if np.isfinite(low) else None), (high if np.isfinite(high) else None)


def in_words(low, high, is_undecided):
    """Of a bracket: "between 1.2 and 1.25", or without an upper end if the run there is undecided."""
    return f"at least {low:.4g}, undecided at {high:.4g}" if is_undecided else f"between {low:.4g} and {high:.4g}"


def draw_runs(axes, factor, stands, displacement, color):
    """The runs of a search."""
    for kind, marker, _ in KINDS:
        some = np.flatnonzero(stands == kind)[np.argsort(factor[stands == kind])]
        axes.plot(factor[some], displacement[some], color=color, linestyle="-" if kind == STANDS else "none", linewidth=1, marker=marker,
                  markersize=4 if kind == STANDS else 5, zorder=3)


def draw(file, safety_displacement=10):
    """Figure of the displacement over the strength reduction factor. safety_displacement: the same option of demsolve."""
    if "/safety" not in file:
        raise figure.NotWanted("this file has no runs of a factor of safety; demsolve --factor-of-safety writes them")
    plot, axes = figure.plt.subplots(figsize=(figure.ONE_COLUMN * 1.2, 2.6))
    plot.says_factor = True
    entries, brackets, drawn = {}, [], []
    for prefix, color, what in ("", "k", "factor of safety"), ("coarse_", figure.COLORS[2], "with zones twice as large"):
        factor = figure.array(file, f"/safety/{prefix}factor")
        if len(factor) < 2:
            continue
        stands = figure.array(file, f"/safety/{prefix}stands")
        displacement = 1e3 * figure.array(file, f"/safety/{prefix}largest_displacement")
        limit = safety_displacement * displacement[np.argmin(factor)]
        shown = np.arange(len(factor)) != np.argmin(factor)  # the first run has strengths so large that hardly any contact slips
        draw_runs(axes, factor[shown], stands[shown], displacement[shown], color)
        drawn += displacement[shown].tolist()
        if np.any((displacement >= limit) & (displacement < 1.5 * limit)):  # a run was ended there; else the option was another
            entries.setdefault("limit", axes.axhline(limit, color=color, linewidth=0.6, linestyle="--",
                                                     label=f"limit: --safety-displacement {safety_displacement:g}"))
        low, high = bracket(factor, stands)
        if low is not None and high is not None:
            axes.axvspan(low, high, color=color, alpha=0.15, linewidth=0)
            brackets.append(f"{what} {in_words(low, high, UNDECIDED in stands[factor == high])}")
        for kind, marker, label in KINDS:
            if kind in stands[shown]:
                entries.setdefault(kind, matplotlib.lines.Line2D([], [], color="k", linestyle="-" if kind == STANDS else "none", linewidth=1,
                                                                 marker=marker, markersize=4, label=label))
        if prefix:
            entries["zones"] = matplotlib.patches.Patch(color=color, label="zones twice as large")
        else:
            for one in factor[stands == FAILS]:
                axes.axvline(one, color=color, linewidth=0.5, linestyle=":", zorder=1)
    if not drawn:
        raise figure.NotWanted("its search for the factor of safety has only the first run")
    axes.set_title("\n".join(brackets))
    if 0 < 10**DECADES * min(drawn) < max(drawn):
        axes.set_yscale("log")
    else:
        axes.set_ylim(0, 1.08 * max(drawn) or 1)
    axes.set_xlabel("strength reduction factor")
    axes.set_ylabel("largest displacement (mm)")
    figure.legend_below(axes, [entries[key] for key in (STANDS, FAILS, UNDECIDED, "limit", "zones") if key in entries])
    return plot


if __name__ == "__main__":
    figure.run(draw, figure.arguments_of(
        __doc__, (["--safety-displacement"], {"type": float, "default": 10, "help": "the same option of demsolve; default: 10"})))
