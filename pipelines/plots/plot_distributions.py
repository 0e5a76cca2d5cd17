#!/usr/bin/python3
"""Histograms of spacing and trace length, set by set, with the law they were drawn from, and of block areas.

Spacing is that of neighbouring lines in space. Lengths are those of traces that begin and end inside the section. Long
traces are less often inside, so each trace has a weight, and the histogram estimates the law itself. Lengths of segments
and discs are those of traces with their midpoint inside. No law is drawn for the traces of discs, for traces that end at
other sets, and for a spacing that follows from a density.
"""

import matplotlib.lines
import matplotlib.patches
import matplotlib.path
import numpy as np

import figure
import joint_sets

BARS = {"facecolor": "#dddddd", "edgecolor": "0.3", "linewidth": 0.5}
LAW = {"color": "k", "linewidth": 1.2}


def spacings(joints, i):
    """True spacings of a set's lines that follow each other by number (m)."""
    normal = joint_sets.mean_normal(joints.sets[i], joints.scene)
    if normal is None:
        return np.zeros(0)
    of_set = joints.set == i
    line, row = np.unique(joints.line[of_set], return_index=True)
    place = joints.point[of_set][row] @ normal  # |n_p| times the distance in the section
    return np.diff(place)[np.diff(line) == 1]


def lengths(joints, i):
    """Lengths of the traces of a set that begin and end inside (m), and what each counts."""
    windows = joints.windows(i)
    if joints.sets[i].get("kind", "lines") != "lines":  # those whose midpoint is inside, however far they reach
        inside = joints.set == i
        for polygon in windows:
            inside &= matplotlib.path.Path(polygon).contains_points(joints.point)
        found = np.linalg.norm(joints.ends[inside, 1] - joints.ends[inside, 0], axis=1)
        return found, np.full(len(found), 1 / max(1, len(found)))
    stretched, found = [], []
    for j in np.flatnonzero(joints.set == i):
        begin, end = joints.ends[j]
        along = (end - begin) / np.linalg.norm(end - begin)
        parts = joint_sets.inside(windows, begin, end)
        stretched += [high - low for low, high in parts]
        for trace in joints.traces[joints.trace_joint == j]:
            a, b = (trace - begin) @ along
            found += [b - a for low, high in parts if low < a and b < high]
    found, stretched = np.array(found), np.array(stretched)
    if len(found) == 0:
        return found, found
    chance = np.clip(stretched[None, :] - found[:, None], 0, None).sum(axis=1) / stretched.sum()
    weight = 1 / chance
    return found, weight / weight.sum()


def draw_law(axes, law, values, weights, what, color):
    """color: of the set."""
    axes.set_xlabel(f"{what} (m)")
    axes.set_ylabel("density (1/m)")
    if len(values) == 0:
        axes.annotate("none inside", (0.5, 0.5), xycoords="axes fraction", ha="center", va="center", color="0.4")
        axes.set_xticks([])
        axes.set_yticks([])
        return
    if law is None:
        law = {"law": "none"}
    if law["law"] == "constant":
        axes.axvline(law["mean_m"], **LAW)
        high = 1.3 * law["mean_m"]
    else:
        high = max(np.quantile(values, 0.98) * 1.2, law.get("mean_m", 0) * 2)
    low = law["shortest_m"] if law["law"] in ("uniform", "power") else 0
    bins = np.linspace(low, high, min(40, max(6, int(2 * len(values) ** 0.5))) + 1)
    bars = {**BARS, "facecolor": figure.pale(color), "edgecolor": color}
    axes.hist(values, bins, weights=weights / np.diff(bins)[0], **bars)
    x = np.linspace(0, 20 * high, 40001)[1:]
    curve = joint_sets.density(law, x)
    if curve is not None:
        seen = x <= high
        axes.plot(x[seen], curve[seen], **LAW)
    axes.set_xlim(0, high)
    axes.set_ylim(bottom=0)
    axes.annotate(f"n = {len(values)}", (1, 1), xycoords="axes fraction", xytext=(-3, -3),
                  textcoords="offset points", ha="right", va="top", fontsize=7)


def draw_areas(axes, area, left_out):
    """left_out: area of rock without joints around the sets, which is not in the histogram [m2]."""
    order = np.sort(area)
    low = order[np.searchsorted(np.cumsum(order), 0.001 * order.sum())]
    bins = np.geomspace(low, order[-1] * 1.0001, 31) if order[-1] > low else np.array([low / 2, low * 2])
    axes.hist(area, bins, weights=np.full(len(area), 100 / len(area)), **BARS)
    look = {"color": figure.COLORS[1], "linewidth": 1.2, "histtype": "step"}
    axes.hist(area, bins, weights=100 * area / area.sum(), **look)
    axes.set_xscale("log")
    without = f"; without {left_out:.0f} m² of blocks outside of region_m" if left_out > 0 else ""
    axes.set_xlabel(f"block area (m²){without}")
    axes.set_ylabel("share of a class (%)")
    axes.legend(handles=[matplotlib.patches.Patch(label=f"of the {len(area)} blocks", **BARS),
                         matplotlib.lines.Line2D([], [], color=look["color"], linewidth=1.2, label="of their area")],
                loc="lower right", bbox_to_anchor=(1, 0.98), ncol=2)


def draw(file):
    """Figure of spacings, trace lengths and block areas, beside their laws."""
    joints = joint_sets.Joints(file)
    area = figure.array(file, "/blocks/area")
    drawn = [i for i, one in enumerate(joints.sets) if one.keys() & {"spacing", "length", "diameter"}]  # others have no law to show
    count = len(drawn)
    plot = figure.plt.figure(figsize=(figure.TWO_COLUMNS, 1.75 * count + 2.1))
    grid = plot.add_gridspec(count + 1, 2, height_ratios=[1] * count + [1.1])
    for line, i in enumerate(drawn):
        joint_set = joints.sets[i]
        has_spacing, has_length = "spacing" in joint_set, "length" in joint_set or "diameter" in joint_set
        panels = [plot.add_subplot(grid[line, place]) for place in ((0, 1) if has_spacing and has_length else (slice(None),))]
        if has_spacing:
            values = spacings(joints, i)
            law = None if "density" in joint_set else joint_set["spacing"]  # else its mean follows from the density
            draw_law(panels[0], law, values, np.full(len(values), 1 / max(1, len(values))), "spacing", figure.set_color(i))
        if has_length:
            law = None if joint_set.get("terminates_at") else joint_set.get("length")
            draw_law(panels[-1], law, *lengths(joints, i), "trace length", figure.set_color(i))
        panels[0].set_title(joint_set["name"], loc="left")
        if line == 0:
            panels[-1].legend(handles=[matplotlib.patches.Patch(label="in the section", **BARS),
                                       matplotlib.lines.Line2D([], [], label="law of the scene", **LAW)],
                              loc="lower right", bbox_to_anchor=(1, 0.98), ncol=2)
    chosen = joint_sets.jointed(file)
    draw_areas(plot.add_subplot(grid[count, :]), area[chosen], area[~chosen].sum())
    return plot


if __name__ == "__main__":
    figure.run(draw, figure.arguments_of(__doc__))
