#!/usr/bin/python3
"""The blocks, filled by their size, the joint set that makes most of their outline, their rock or the stage that
removes them, and the edges between them.

Colours show the sizes of blocks on a logarithmic scale. The smallest blocks, with 1 percent of the area in all, share the first colour.
Rock outside the regions of joint sets (region_m) is grey. With a window, the scale is for the blocks inside the window. Larger
blocks are grey.
"""

import matplotlib.colors
import matplotlib.lines
import matplotlib.patches
import matplotlib.path
import matplotlib.ticker
import numpy as np
from matplotlib.collections import LineCollection, PathCollection

import figure
import joint_sets

EXTENDED = -1  # of these, joint edges without a part of a joint trace
LARGER = "0.72"  # than the scale has, or without joints


def block_paths(file):
    """The outline of every block with its holes, as one path each."""
    position = figure.array(file, "/vertices/position")
    first_ring = figure.array(file, "/blocks/first_ring")
    first_corner = figure.array(file, "/rings/first_corner")
    vertex = figure.array(file, "/rings/vertex")
    rings = [position[vertex[begin:end]] for begin, end in zip(first_corner[:-1], first_corner[1:])]
    closed = [matplotlib.path.Path(np.vstack([ring, ring[:1]]), closed=True) for ring in rings]
    return [matplotlib.path.Path.make_compound_path(*closed[begin:end])
            for begin, end in zip(first_ring[:-1], first_ring[1:])]


def size_range(area):
    """The range of a colour scale of areas [m2]."""
    ordered = np.sort(area)
    low, high = ordered[np.searchsorted(np.cumsum(ordered), 0.01 * ordered.sum())], ordered[-1]
    return (low, high) if high > 1.0001 * low else (low / 2, high * 2)


def whole_blocks(paths, axes):
    """Which blocks are wholly in what the axes show; all if none is."""
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    boxes = [path.get_extents() for path in paths]
    whole = np.array([left <= box.x0 and box.x1 <= right and bottom <= box.y0 and box.y1 <= top for box in boxes])
    return whole if np.any(whole) else ~whole


def set_of_blocks(file):
    """For each block the joint set with the largest length in its outline, -1 if it has no joint."""
    joint, block = figure.array(file, "/edges/joint"), figure.array(file, "/edges/block")
    ends = figure.array(file, "/vertices/position")[figure.array(file, "/edges/vertex")]
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    of_joint = figure.array(file, "/joints/set")
    total = np.zeros((len(figure.array(file, "/blocks/area")), len(figure.texts(file, "/names/joint_set")) + 1))
    for side in (0, 1):
        chosen = (joint >= 0) & (block[:, side] >= 0)
        np.add.at(total, (block[chosen, side], of_joint[joint[chosen]]), length[chosen])
    return np.where(total.max(axis=1) > 0, total.argmax(axis=1), -1)


def draw_edges(file, axes):
    position = figure.array(file, "/vertices/position")
    vertex = figure.array(file, "/edges/vertex")
    kind = figure.array(file, "/edges/kind")
    few = len(vertex) < 2000
    kind = np.where(figure.untraced_edges(file), EXTENDED, kind)
    looks = {
        EXTENDED: ("no joint trace: extension or rock bridge", {"color": "0.55", "linewidth": 0.5 if few else 0.3, "linestyle": (0, (2, 2))}),
        figure.JOINT: ("joint", {"color": "k", "linewidth": 0.7 if few else 0.3}),
        figure.WELDED: ("bonded edge, no joint", {"color": "k", "linewidth": 0.5, "linestyle": (0, (4, 2))}),
        figure.BOUNDARY: ("outline", {"color": "k", "linewidth": 1.3}),
    }
    entries = []
    for code, (label, look) in looks.items():
        if np.any(kind == code):
            axes.add_collection(LineCollection(position[vertex[kind == code]], capstyle="round", **look))
            entries.append(matplotlib.lines.Line2D([], [], label=label, **look))
    return entries


def draw(file, window=None, by="size"):
    """Figure of the blocks: by "size", "set", "rock" or "stage". window: x0, y0, x1, y1 [m]."""
    paths = block_paths(file)
    position = figure.array(file, "/vertices/position")
    area = figure.array(file, "/blocks/area")
    plot, axes = figure.section_axes(position, window)
    entries = draw_edges(file, axes)

    fills = []
    if by == "size":
        jointed = joint_sets.jointed(file)
        whole = whole_blocks(paths, axes)
        low, high = size_range(area[whole & jointed if np.any(whole & jointed) else whole])
        blocks = PathCollection(paths, cmap=figure.SHADES.with_extremes(over=LARGER, bad=LARGER),
                                norm=matplotlib.colors.LogNorm(low, high), zorder=0)
        blocks.set_array(np.ma.masked_array(area, ~jointed))
        axes.add_collection(blocks)
        scale = plot.colorbar(blocks, ax=axes, label="block area (m²)", shrink=0.6,
                              extend=figure.extension(area[jointed], low, high))
        if not np.all(jointed):
            fills.append(matplotlib.patches.Patch(facecolor=LARGER, edgecolor="k", linewidth=0.5,
                                                  label="blocks outside of region_m: not on the scale"))
        scale.ax.yaxis.set_major_locator(matplotlib.ticker.LogLocator(subs=(1, 2, 5)))
        scale.ax.yaxis.set_major_formatter("{x:g}")
        scale.ax.yaxis.set_minor_locator(matplotlib.ticker.NullLocator())
    else:
        code = set_of_blocks(file) if by == "set" else figure.array(file, f"/blocks/{by}")
        names = figure.texts(file, "/names/joint_set" if by == "set" else f"/names/{by}")
        others = {"stage": "stays", "set": "no joint"}.get(by)
        shades = figure.SHADES(np.linspace(0.1, 0.95, max(len(names), 2)))
        for i in np.unique(code):  # -1 comes first
            shade = "white" if i < 0 else figure.pale(figure.set_color(i)) if by == "set" else shades[i]
            of_code = [path for path, c in zip(paths, code) if c == i]
            axes.add_collection(PathCollection(of_code, facecolor=[shade], zorder=0))
            label = others if i < 0 else f"outline mostly {names[i]}" if by == "set" else names[i]
            fills.append(matplotlib.patches.Patch(facecolor=shade, edgecolor="k", linewidth=0.5, label=label))
    entries.append(matplotlib.lines.Line2D([], [], linestyle="none", label=f"{len(paths)} blocks in the section"))
    figure.legend_below(axes, entries + fills)
    return plot


if __name__ == "__main__":
    figure.run(draw, figure.arguments_of(__doc__, figure.WINDOW, (["--by"], {"choices": ["size", "set", "rock", "stage"],
                                                              "default": "size", "help": "default: size"})))
