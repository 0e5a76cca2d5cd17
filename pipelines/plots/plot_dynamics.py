#!/usr/bin/python3
"""A dynamic analysis: the blocks at moments spread over it, with dots where they touch, in colour where they slip, and
its energies over time. For results of scenes with [large_displacements]; with several stages, of the last stage
in which blocks moved."""

import matplotlib.tri
import numpy as np

import figure

MOMENTS = 6
PARTS = (("kinetic", "kinetic"), ("stored", "stored"), ("friction", "lost to slip"), ("damped", "taken by dashpots"))


def moments_of(file):
    """Rows of /dynamics of the last dynamic analysis."""
    if "/dynamics/dynamic_time" not in file:
        raise figure.NotWanted("this file has no dynamic analysis; its scene has no [large_displacements], or no stage")
    time = figure.array(file, "/dynamics/dynamic_time")
    return np.arange(np.flatnonzero(time == 0)[-1], len(time))


def draw_blocks(axes, file, row):
    state = figure.array(file, "/dynamics/state")[row]
    place = figure.array(file, "/mesh/gridpoint_position") + figure.array(file, "/states/displacement")[state]
    there = figure.array(file, "/states/zone_present")[state] == 1
    zones = figure.array(file, "/mesh/zone_gridpoint")[there]
    block = figure.array(file, "/mesh/zone_block")[there]
    faces = matplotlib.tri.Triangulation(*place.T, zones)
    axes.tripcolor(faces, facecolors=block % 3, cmap=figure.SHADES, vmin=-1, vmax=8)
    # The outlines of blocks: sides of zones that no other zone of the block has.
    sides = np.sort(np.concatenate([zones[:, pair] for pair in ((0, 1), (1, 2), (2, 0))]), axis=1)
    both, count = np.unique(np.column_stack([sides, np.tile(block, 3)]), axis=0, return_counts=True)
    for from_, to in both[count == 1][:, :2]:
        axes.plot(*place[[from_, to]].T, color="black", linewidth=0.5)
    of_moment = slice(*figure.array(file, "/dynamics/first_contact")[row:row + 2].astype(int))
    middle = (figure.array(file, "/dynamics/contact_from") + figure.array(file, "/dynamics/contact_to"))[of_moment] / 2
    slips = figure.array(file, "/dynamics/contact_slips")[of_moment] == 1
    axes.scatter(*middle[~slips].T, s=3, color="black", zorder=3)
    axes.scatter(*middle[slips].T, s=5, color=figure.COLORS[1], zorder=3)
    axes.set_aspect("equal")
    axes.set_title(f"{figure.array(file, '/dynamics/dynamic_time')[row]:.2f} s")


def draw(file):
    """Figure of blocks at six moments, and of energies over time."""
    rows = moments_of(file)
    chosen = rows[np.unique(np.linspace(0, len(rows) - 1, MOMENTS).astype(int))]
    canvas = figure.plt.figure(figsize=(figure.TWO_COLUMNS, 6.6))
    above, below = canvas.subfigures(2, 1, height_ratios=(2.2, 1))
    panels = above.subplots(3, 2, sharex=True, sharey=True).ravel()
    for panel, row in zip(panels, chosen):
        draw_blocks(panel, file, row)
    for panel in panels[len(chosen):]:
        panel.set_visible(False)
    above.supxlabel("x (m)", fontsize=8)
    above.supylabel("y (m)", fontsize=8)

    axes = below.subplots()
    time = figure.array(file, "/dynamics/dynamic_time")[rows]
    work = figure.array(file, "/dynamics/work_of_loads")[rows]
    axes.plot(time, work / 1e6, color="black", linewidth=1.6, label="work of weight")
    for (part, label), color, line in zip(PARTS, figure.COLORS, figure.LINES):
        axes.plot(time, figure.array(file, f"/dynamics/{part}_energy")[rows] / 1e6, color=color, linestyle=line, label=label)
    axes.set_xlabel("time since the stage (s)")
    axes.set_ylabel("energy (MJ/m)")
    axes.legend(loc="center right")
    return canvas


if __name__ == "__main__":
    figure.run(draw, figure.arguments_of(__doc__))
