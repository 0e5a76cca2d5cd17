#!/usr/bin/python3
"""The lock's section with weathering, stages and monitoring points (the paper's Fig. 9), or with --plan the points of both sections
seen from above (Fig. 8). FILE.h5 is any file of the chain of section A-A.
"""

import matplotlib.lines
import matplotlib.patches
import numpy as np

import variant
from records import figure

NAMES = {"fresh": "fresh and microweathered", "weak": "weak (minor-weathered)", "cover": "full and strong"}
WINDOW = (-190, 85, 190, 250)  # [m]


def draw_section(scene):
    plot, axes = figure.section_axes(None, WINDOW)
    entries = figure.draw_rocks(scene, axes, NAMES)
    axes.plot(*np.array(scene["in_situ_stress"]["ground_m"]).T, color="0.35", linewidth=0.8, zorder=2)
    inside = matplotlib.patches.Polygon(scene["section"]["outline_m"], transform=axes.transData)
    for stage in scene["stage"]:
        for polygon in stage["remove_m"]:
            corners = np.array(polygon, float)
            for look in ({"facecolor": "white", "alpha": 0.6, "zorder": 0.5, "linewidth": 0},
                         {"facecolor": "none", "edgecolor": "0.25", "linewidth": 0.5, "linestyle": (0, (5, 2))}):
                patch = matplotlib.patches.Polygon(corners, **look)
                axes.add_patch(patch)
                patch.set_clip_path(inside)
            low, high = corners[:, 1].min(), corners[:, 1].max()
            wide = np.ptp(corners[:, 0]) > 60
            middle = corners[:, 0].min() / 2 + corners[:, 0].max() / 2
            date = stage["date"]
            text = f"to {low:.0f} m, {date:%B %Y}" if wide else f"{low:.0f}, {date:%m/%Y}"
            axes.annotate(text, (middle, (low + high) / 2), ha="center", va="center", fontsize=6 if wide else 5, zorder=4)
    depths = [y for stage in scene["stage"] for polygon in stage["remove_m"] if np.ptp(np.array(polygon)[:, 0]) <= 60
              for _, y in polygon]  # of the chambers
    axes.annotate("pier", (0, (min(depths) + max(depths)) / 2), ha="center", va="center", fontsize=7)
    for point in scene["point"]:
        x, y = point["at_m"]
        axes.plot(x, y, "o", color="k", markersize=3, zorder=5)
        axes.annotate(point["name"], (x, y), xytext=(4 * np.sign(x), 3), textcoords="offset points", zorder=5,
                      ha="left" if x > 0 else "right", path_effects=figure.HALO)
    entries.append(matplotlib.lines.Line2D([], [], linestyle="none", marker="o", color="k", markersize=3,
                                           label="monitoring point"))
    entries.append(matplotlib.lines.Line2D([], [], color="0.25", linewidth=0.6, linestyle=(0, (5, 2)),
                                           label="excavation stage"))
    axes.annotate("south", (WINDOW[0], WINDOW[1]), xytext=(5, 5), textcoords="offset points", fontsize=7)
    axes.annotate("north", (WINDOW[2], WINDOW[1]), xytext=(-5, 5), textcoords="offset points", fontsize=7, ha="right")
    axes.set_xlabel("across the lock (m)")
    axes.set_ylabel("elevation (m)")
    figure.legend_below(axes, entries[:3], entries[3:])
    return plot


def draw_plan(scene):
    """Edges of benches, walls and pier along the lock, as they are at the end, and the points on both sections. Section B-B has the
    same benches 20 m lower; how far apart the sections are is not known."""
    edges = {}  # the widest that is dug away at each elevation
    for stage in scene["stage"]:
        for polygon in stage["remove_m"]:
            for x, y in polygon:
                edges.setdefault(round(x, 3), y)
    walls = [x for x, y in edges.items() if abs(x) <= 140]
    plot, axes = figure.section_axes(None, (-170, -60, 170, 60))
    for x in walls:
        axes.axvline(x, color="0.6", linewidth=0.6)
    for sign in (-1, 1):
        chamber = sorted(x for x in walls if sign * x > 0 and abs(x) < 70)
        axes.axvspan(chamber[0], chamber[-1], color="#dfe9f3", linewidth=0)
        axes.annotate("chamber", (sum(chamber) / len(chamber), -54), ha="center", fontsize=7)
    axes.annotate("pier", (0, -54), ha="center", fontsize=7)
    points = sorted(scene["point"], key=lambda one: one["at_m"][0])
    for along, title, named in ((22, "A-A, chamber 2", str), (-26, "B-B, chamber 3", variant.named_in_section_b)):
        axes.axhline(along, color="k", linewidth=0.8, linestyle=(0, (8, 3, 2, 3)))
        axes.annotate(title, (-168, along - 6), fontsize=7, path_effects=figure.HALO)
        for i, point in enumerate(points):
            x = point["at_m"][0]
            axes.plot(x, along, "o", color="k", markersize=3.5, zorder=5)
            axes.annotate(named(point["name"]), (x, along), xytext=(0, 6 + 9 * (i % 2)), textcoords="offset points", ha="center",
                          fontsize=6.5, path_effects=figure.HALO)
    axes.set_xlabel("across the lock, toward the north (m)")
    axes.set_ylabel("along the lock, not to scale")
    axes.set_yticks([])
    return plot


def draw(file, plan=False):
    scene = figure.scene_of(file)
    return draw_plan(scene) if plan else draw_section(scene)


if __name__ == "__main__":
    figure.run(draw, figure.arguments_of(
        __doc__, (["--plan"], {"action": "store_true", "help": "the points seen from above"})))
