#!/usr/bin/python3
"""Rose of the joint traces in the section: the share of the trace length in each direction. Sets are
stacked.

Areas are to scale: the radius is the square root of the share. Angles count counter-clockwise from the section's x
axis. Classes are centred on multiples of their width. Traces count with their length inside the section.
"""

import matplotlib.patches
import numpy as np

import figure
import joint_sets


ROUNDING = 1e-6  # of a class: equal angles at its border are all in the same one


def class_of(angle, width):
    """Classes of angles [degrees]; they are centred on 0, width, 2 width ..."""
    return np.floor((angle + width / 2) / width + ROUNDING).astype(int) % round(180 / width)


def draw(file, width=5):
    """Figure of the directions of joint traces, in classes of `width` degrees."""
    joints = joint_sets.Joints(file)
    if not 1 <= width <= 90 or 180 % width != 0:
        raise figure.NotWanted(f"--width {width}: expected a part of 180 degrees, from 1 to 90")
    bins = round(180 / width)
    length = np.array([sum(high - low for low, high in joint_sets.inside([joints.outline], *ends))
                       if np.any(ends[0] != ends[1]) else 0.0 for ends in joints.traces])
    if not np.any(length > 0):
        raise figure.NotWanted("there is no joint trace in the section")
    along = joints.traces[:, 1] - joints.traces[:, 0]
    angle = np.degrees(np.arctan2(along[:, 1], along[:, 0])) % 180
    of_class = class_of(angle, width)
    of_set = joints.set[joints.trace_joint]

    plot = figure.plt.figure(figsize=(figure.ONE_COLUMN, figure.ONE_COLUMN))
    axes = plot.add_subplot(projection="polar")
    base = np.zeros(bins)
    entries = []
    for i, name in enumerate(joints.names):
        share = np.bincount(of_class[of_set == i], length[of_set == i], bins) / length.sum()
        if not np.any(share > 0):
            continue
        top = base + share
        for half in (0, 180):
            axes.bar(np.radians(np.arange(bins) * width + half), np.sqrt(top) - np.sqrt(base), np.radians(width),
                     np.sqrt(base), facecolor=figure.set_color(i), edgecolor="white", linewidth=0.4, zorder=2)
        base = top
        entries.append(matplotlib.patches.Patch(facecolor=figure.set_color(i), label=name))
    highest = base.max()
    step = next(step for step in (0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5) if highest / step <= 4)
    ticks = np.arange(step, highest * 1.0001, step)
    axes.set_ylim(0, np.sqrt(highest) * 1.04)
    axes.set_yticks(np.sqrt(ticks), [f"{100 * tick:g} %" for tick in ticks], fontsize=6, path_effects=figure.HALO,
                    zorder=4)
    emptiest = np.argmin(base + 0.5 * np.roll(base, 1) + 0.5 * np.roll(base, -1))
    place = emptiest * width
    if place % 30 == 0:  # where the angles have their labels
        place = min((45, 75, 105, 135), key=lambda one: base[round(one / width) % bins])
    axes.set_rlabel_position(place)
    axes.set_xticks(np.radians(np.arange(0, 360, 30)))
    axes.grid(linewidth=0.4, color="0.75")
    axes.spines["polar"].set_linewidth(0.6)
    axes.set_title(f"traces in the section, weighted by their length in it;\nclasses of {width:g} degrees, area in proportion to the share",
                   fontsize=7, pad=14)
    if len(entries) > 8:
        entries = []
    if entries:
        figure.legend_below(axes, entries)
    return plot


if __name__ == "__main__":
    figure.run(draw, figure.arguments_of(
        __doc__, (["--width"], {"type": float, "default": 5, "help": "of a class, in degrees; default: 5"})))
