#!/usr/bin/python3
"""The blocks, filled by their size, their rock or the stage that removes them, and the edges between them."""

import matplotlib.colors
import matplotlib.lines
import matplotlib.patches
import matplotlib.path
import numpy as np
from matplotlib.collections import LineCollection, PathCollection

import figure

BOUNDARY, JOINT, WELDED = 0, 1, 2  # /edges/kind


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


def draw_edges(file, axes):
    position = figure.array(file, "/vertices/position")
    vertex = figure.array(file, "/edges/vertex")
    kind = figure.array(file, "/edges/kind")
    few = len(vertex) < 2000
    looks = {
        JOINT: ("joint", {"color": "k", "linewidth": 0.7 if few else 0.3}),
        WELDED: ("welded edge, no joint", {"color": "k", "linewidth": 0.5, "linestyle": (0, (4, 2))}),
        BOUNDARY: ("outline", {"color": "k", "linewidth": 1.3}),
    }
    entries = []
    for code, (label, look) in looks.items():
        if np.any(kind == code):
            axes.add_collection(LineCollection(position[vertex[kind == code]], capstyle="round", **look))
            entries.append(matplotlib.lines.Line2D([], [], label=label, **look))
    return entries


def draw(file, arguments):
    paths = block_paths(file)
    position = figure.array(file, "/vertices/position")
    area = figure.array(file, "/blocks/area")
    plot, axes = figure.section_axes(position)
    entries = draw_edges(file, axes)

    if arguments.by == "size":
        low, high = np.min(area), np.max(area)
        if high < 1.0001 * low:  # a colour scale needs a range
            low, high = low / 2, high * 2
        blocks = PathCollection(paths, cmap="cividis", norm=matplotlib.colors.LogNorm(low, high), zorder=0)
        blocks.set_array(area)
        axes.add_collection(blocks)
        plot.colorbar(blocks, ax=axes, label="block area (m²)", shrink=0.6)
    else:
        code = figure.array(file, f"/blocks/{arguments.by}")
        names = figure.texts(file, f"/names/{arguments.by}")
        present = np.unique(code)  # in order; -1 stays
        # Paled, so that the edges stay visible.
        shades = 0.4 + 0.6 * matplotlib.colormaps["cividis"](np.linspace(0.15, 1, max(len(names), 2)))[:, :3]
        for i in present:
            shade = "white" if i < 0 else shades[i]
            of_code = [path for path, c in zip(paths, code) if c == i]
            axes.add_collection(PathCollection(of_code, facecolor=[shade], zorder=0))
            entries.append(matplotlib.patches.Patch(facecolor=shade, edgecolor="k", linewidth=0.5,
                                                    label="stays" if i < 0 else names[i]))
    entries.append(matplotlib.lines.Line2D([], [], linestyle="none", label=f"{len(paths)} blocks"))
    figure.legend_below(axes, entries)
    return plot


if __name__ == "__main__":
    figure.run(draw, figure.arguments_of(__doc__, (["--by"], {"choices": ["size", "rock", "stage"],
                                                              "default": "size", "help": "default: size"})))
