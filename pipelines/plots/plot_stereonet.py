#!/usr/bin/python3
"""Poles of the joints in a lower-hemisphere equal-area net: one point a joint, lines of equal density, the mean pole
of each set and its target.

Density is that of all poles, in multiples of an even one, smoothed over about 8 degrees. Joints whose set is given by
its trace angle have no pole.
"""

import matplotlib.lines
import numpy as np

import figure
import joint_sets

KERNEL = 50  # concentration of the Fisher law that smooths


def downward(poles, azimuth):
    """Of upward unit normals in the section's frame, the other end: {east, north, down}."""
    east = poles[:, 0] * np.sin(azimuth) + poles[:, 2] * np.cos(azimuth)
    north = poles[:, 0] * np.cos(azimuth) - poles[:, 2] * np.sin(azimuth)
    return np.stack([-east, -north, poles[:, 1]], axis=1)


def net(vectors):
    """Schmidt's projection of unit vectors {east, north, down}; the horizontal ones are on the unit circle."""
    return vectors[:, :2] / np.sqrt(1 + vectors[:, 2:])


def pole_of(plane):
    dip, direction = plane
    return np.array([[-np.sin(dip) * np.sin(direction), -np.sin(dip) * np.cos(direction), np.cos(dip)]])


def mean_axis(vectors):
    """Of axes near each other: eigenvector of the largest eigenvalue, downward."""
    axis = np.linalg.eigh(vectors.T @ vectors)[1][:, -1]
    return (axis if axis[2] >= 0 else -axis)[None, :]


def draw_density(axes, vectors):
    x, y = np.meshgrid(np.linspace(-1, 1, 121), np.linspace(-1, 1, 121))
    square = x**2 + y**2
    within = square <= 1
    scale = np.sqrt(np.clip(2 - square, 0, None))
    grid = np.stack([x * scale, y * scale, 1 - square], axis=-1)[within]
    value = np.zeros(len(grid))
    for part in np.array_split(vectors, 1 + len(vectors) // 1000):
        value += np.exp(KERNEL * (np.abs(grid @ part.T) - 1)).sum(axis=1)
    value *= KERNEL / (len(vectors) * -np.expm1(-KERNEL))
    everywhere = np.full(x.shape, np.nan)
    everywhere[within] = value
    levels = [level for level in (1, 2, 4, 8, 16, 32, 64) if level < value.max()]
    if len(levels) < 2:
        return
    filled = axes.contourf(x, y, everywhere, levels=[*levels, value.max()], cmap=figure.SHADES, alpha=0.75, zorder=0)
    scale = axes.figure.colorbar(filled, ax=axes, shrink=0.55, ticks=levels, label="density, multiples of an even one")
    scale.ax.tick_params(length=0)


def draw(file):
    """Figure of the poles of the joints."""
    joints = joint_sets.Joints(file)
    azimuth = joints.scene["section"].get("azimuth_deg")
    has_pole = np.any(joints.pole != 0, axis=1)
    if azimuth is None or not np.any(has_pole):
        raise figure.NotWanted("no joint has a pole: the sets are given by their trace angles")
    azimuth = np.radians(azimuth)
    _, first = np.unique(np.stack([joints.set, joints.line]), axis=1, return_index=True)  # a line's pieces are one
    chosen = np.zeros(len(has_pole), bool)
    chosen[first] = True
    chosen &= has_pole
    vectors = downward(joints.pole, azimuth)

    plot, axes = figure.plt.subplots(figsize=(4.4, 4.6))
    axes.set_aspect("equal")
    axes.set_axis_off()
    draw_density(axes, vectors[chosen])
    around = np.linspace(0, 2 * np.pi, 361)
    axes.plot(np.cos(around), np.sin(around), color="k", linewidth=0.8)
    for bearing in range(0, 360, 10):
        end = np.array([np.sin(np.radians(bearing)), np.cos(np.radians(bearing))])
        length = 0.04 if bearing % 90 == 0 else 0.02
        axes.plot(*np.outer([1, 1 + length], end).T, color="k", linewidth=0.6)
        if bearing % 90 == 0:
            axes.annotate("NESW"[bearing // 90], 1.1 * end, ha="center", va="center")
    axes.plot([0], [0], marker="+", color="0.4", markersize=4)
    section = np.array([np.sin(azimuth), np.cos(azimuth)])
    look = {"color": "0.35", "linewidth": 0.7, "linestyle": (0, (5, 3))}
    axes.plot(*np.outer([-1, 1], section).T, zorder=1, **look)

    entries = [matplotlib.lines.Line2D([], [], label="the section", **look)]
    size = min(3.0, max(1.0, 40 / np.sqrt(chosen.sum())))
    means = {"linestyle": "none", "color": "k", "markersize": 8, "zorder": 5}
    shown = set()
    for i, name in enumerate(joints.names):
        of_set = chosen & (joints.set == i)
        if not np.any(of_set):
            continue
        look = {"linestyle": "none", "marker": figure.MARKERS[i % 6], "color": figure.set_color(i),
                "markeredgewidth": 0}
        axes.plot(*net(vectors[of_set]).T, markersize=size, zorder=3, **look)
        entries.append(matplotlib.lines.Line2D([], [], markersize=4, label=f"{name}, {of_set.sum()} poles", **look))
        axes.plot(*net(mean_axis(vectors[of_set])).T, marker="x", markeredgewidth=1.4, path_effects=figure.HALO,
                  **means)
        shown.add("mean pole")
        plane = joint_sets.mean_plane(joints.sets[i]) if i < len(joints.sets) else None
        if plane is not None:
            axes.plot(*net(pole_of(plane)).T, marker="o", markerfacecolor="none", markeredgewidth=1.0,
                      path_effects=figure.HALO, **means)
            shown.add("target")
    for label, marker in (("mean pole", "x"), ("target", "o")):
        if label in shown:
            entries.append(matplotlib.lines.Line2D([], [], marker=marker, markerfacecolor="none", label=label,
                                                   linestyle="none", color="k", markersize=6))
    plot.suptitle("poles, lower hemisphere, equal-area projection;\neach joint counts once (no weights)", fontsize=7)
    axes.legend(handles=entries, loc="upper center", bbox_to_anchor=(0.5, 0), ncol=2)
    return plot


if __name__ == "__main__":
    figure.run(draw, figure.arguments_of(__doc__))
