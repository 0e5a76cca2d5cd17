#!/usr/bin/python3
"""The section: rocks, joints with their rock bridges, stages, boundary conditions, monitoring points and gauges."""

import matplotlib.lines
import matplotlib.patches
import matplotlib.path
import numpy as np
from matplotlib.collections import LineCollection

import figure

STAGE_BORDER = {"edgecolor": "0.25", "linewidth": 0.8, "linestyle": (0, (6, 2, 1, 2))}
# Of a point, where its name can be [pt].
SIDES = [(4, 3, "left", "bottom"), (-4, 3, "right", "bottom"), (4, -3, "left", "top"), (-4, -3, "right", "top")]
LETTER, LINE = 4.4, 9  # width of a letter and height of a line [pt]
FEW = 8  # entries of one kind in the legend; of more there is one for all


def clip(artist, inside):
    artist.set_clip_path(inside)
    artist.set_in_layout(False)  # layout fails on what is clipped and outside of the window


def draw_joints(file, axes, inside):
    """Joint lines dotted, and over them, solid, what of them is joint: the dots left are rock bridges. Returns legend
    entries."""
    sets = figure.texts(file, "/names/joint_set")
    joint_set = figure.array(file, "/joints/set")
    lines = np.stack([figure.array(file, "/joints/from"), figure.array(file, "/joints/to")], axis=1)
    traces = np.stack([figure.array(file, "/traces/from"), figure.array(file, "/traces/to")], axis=1)
    trace_joint = figure.array(file, "/traces/joint")

    joint_length = np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1)
    trace_length = np.linalg.norm(traces[:, 1] - traces[:, 0], axis=1)
    open_length = np.bincount(trace_joint, trace_length, len(lines))
    has_bridges = open_length < joint_length * (1 - 1e-9)

    width = min(1, max(0.4, (80 / max(1, len(lines))) ** 0.5))  # the more lines, the thinner
    entries = []
    if np.any(has_bridges):
        dots = {"color": "0.3", "linewidth": 0.6 * width, "linestyle": (0, (1, 2.2))}
        bridges = LineCollection(lines[has_bridges], **dots)
        clip(bridges, inside)
        axes.add_collection(bridges)
        entries.append(matplotlib.lines.Line2D([], [], label="rock bridge", **dots))
    for i, name in enumerate(sets):
        of_set = joint_set[trace_joint] == i
        if not np.any(of_set):
            continue
        style = {"color": figure.set_color(i), "linewidth": width * figure.WIDTHS[i % 6]}
        collection = LineCollection(traces[of_set], capstyle="butt", zorder=2, **style)
        clip(collection, inside)
        axes.add_collection(collection)
        entries.append(matplotlib.lines.Line2D([], [], **style, label=name))
    bridge = entries[:1] if np.any(has_bridges) else []
    if len(entries) - len(bridge) > FEW:  # single joints
        entries = [*bridge, matplotlib.lines.Line2D([], [], color=figure.COLORS[0], label="joints")]
    return entries


def number_place(corners, points, size):
    """Where a stage's number goes: in the middle, or aside of it where a monitoring point is there already."""
    corners = np.array(corners, float)
    middle = corners.mean(axis=0)
    for place in [middle, *(middle + corners) / 2]:
        if all(np.linalg.norm(place - point) > 0.06 * size for point in points):
            return place
    return middle


def draw_stages(scene, axes, inside):
    """Few in shades of grey, with their names below; many in outline, where joints and rocks stay visible."""
    entries = []
    points = [np.array(point["at_m"], float) for point in scene.get("point", [])]
    size = max(np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim()))
    stages = scene.get("stage", [])
    few = len(stages) <= FEW
    for number, stage in enumerate(stages, 1):
        shown = False
        for corners in stage["remove_m"]:
            patch = matplotlib.patches.Polygon(corners, facecolor=str(0.8 + 0.13 * (number % 2)) if few else "none",
                                               **STAGE_BORDER, zorder=0.5)
            axes.add_patch(patch)
            clip(patch, inside)
            seen = figure.part_in(axes, corners)
            if len(seen) == 0:
                continue
            shown, place = True, number_place(seen, points, size)
            axes.annotate(str(number), place, ha="center", va="center", zorder=4, fontsize=8 if few else 5.5,
                          bbox={"boxstyle": "circle,pad=0.2", "facecolor": "white", "linewidth": 0.5})
        if not shown:
            continue
        when = f"day {stage['date']}" if isinstance(stage["date"], (int, float)) else str(stage["date"])
        entries.append(matplotlib.lines.Line2D([], [], linestyle="none", marker=f"${number}$", color="k",
                                               markeredgewidth=0, markersize=5, label=f"{stage['name']}, {when}"))
    if not few:
        return [matplotlib.patches.Patch(facecolor="none", **STAGE_BORDER, label="stages, numbered as they follow")]
    return entries


def draw_boundaries(scene, outline, axes):
    """Signs along the outside of the outline: triangles where it is fixed, circles where it can slide, squares
    where it rests on a joint, diamonds where it is free and loaded."""
    size = np.max(np.ptp(outline, axis=0))
    inside = matplotlib.path.Path(outline)
    entries = {}
    for boundary in scene.get("boundary", []):
        first, second = np.array(boundary["from_m"], float), np.array(boundary["to_m"], float)
        along = second - first
        length = np.linalg.norm(along)
        outward = np.array([along[1], -along[0]]) / length
        if inside.contains_point((first + second) / 2 + 1e-6 * size * outward):
            outward = -outward
        if "joint" in boundary:
            marker, label = "s", f"rests on '{boundary['joint']}'"
        elif "fix" not in boundary:
            marker, label = "D", "loaded"
        elif boundary["fix"] == "xy":
            marker, label = "^", "fixed"
        else:
            marker, label = "o", "fixed across, free along"
        count = max(2, round(14 * length / size))
        places = first + np.outer((np.arange(count) + 0.5) / count, along) + 0.018 * size * outward
        if not any(figure.is_in(axes, place) for place in places):
            continue
        axes.plot(*places.T, linestyle="none", marker=marker, markersize=3.5, markerfacecolor="white",
                  markeredgecolor="k", markeredgewidth=0.6)
        entries[marker, label] = matplotlib.lines.Line2D([], [], linestyle="none", marker=marker,
                                                         markerfacecolor="white", markeredgecolor="k", label=label)
    return list(entries.values())


def side_of(place, name, taken):
    """The side of a place [pt] on which its name overlaps no other; the first if there is none. taken: corners of the boxes [pt] of the
    names so far, to which this one is added."""
    boxes = []
    for dx, dy, across, _ in SIDES:
        width = LETTER * len(name)
        low = np.array([place[0] + dx - (width if across == "right" else 0), place[1] + dy - (LINE if dy < 0 else 0)])
        boxes.append((low, low + [width, LINE]))
    free = [i for i, (low, high) in enumerate(boxes) if not any(np.all(low < other[1]) and np.all(other[0] < high) for other in taken)]
    chosen = free[0] if free else 0
    taken.append(boxes[chosen])
    return SIDES[chosen]


def annotate(name, place, axes, taken):
    """Writes the name of a place beside it; taken as in side_of()."""
    scale = 72 * (axes.figure.get_figwidth() - 0.8) / np.ptp(axes.get_xlim())  # [pt/m]
    dx, dy, across, up = side_of(scale * np.array(place, float), name, taken)
    axes.annotate(name, place, xytext=(dx, dy), textcoords="offset points", zorder=6, path_effects=figure.HALO, ha=across,
                  va="baseline" if dy > 0 else up)


def draw_places(scene, key, label, marker, axes, taken):
    """Monitoring points, or gauges, with their names; taken as in side_of()."""
    places = {place["name"]: place["at_m"] for place in scene.get(key, [])}
    look = {"linestyle": "none", "marker": marker, "color": "k", "markersize": 3.5}
    for name, place in places.items():
        if not figure.is_in(axes, place):
            continue
        axes.plot(*place, zorder=5, path_effects=figure.HALO, **look)
        annotate(name, place, axes, taken)
    return [matplotlib.lines.Line2D([], [], label=label, **look)] if places else []


def draw_lines(scene, axes, taken):
    """Monitoring lines, with their names; taken as in side_of()."""
    lines = scene.get("monitoring_line", [])
    look = {"color": "k", "linewidth": 0.8, "marker": "|", "markersize": 4}
    for line in lines:
        ends = np.array([line["from_m"], line["to_m"]], float)
        places = ends[0] + np.linspace(0, 1, line["points"])[:, None] * (ends[1] - ends[0])
        axes.plot(*places.T, zorder=5, **look)
        annotate(line["name"], ends[0], axes, taken)
    return [matplotlib.lines.Line2D([], [], label="monitoring line", **look)] if lines else []


def draw(file, window=None):
    """Figure of the section. window: x0, y0, x1, y1 [m]."""
    scene = figure.scene_of(file)
    outline = np.array(scene["section"]["outline_m"], float)
    plot, axes = figure.section_axes(outline, window)
    inside = matplotlib.patches.Polygon(outline, facecolor="none", edgecolor="k", linewidth=1.0, zorder=3)
    for hole in scene["section"].get("holes_m", []):
        axes.add_patch(matplotlib.patches.Polygon(hole, facecolor="w", edgecolor="k", linewidth=1.0, zorder=3))
    axes.add_patch(inside)

    joints = draw_joints(file, axes, inside)
    stages = draw_stages(scene, axes, inside)
    others = figure.draw_rocks(scene, axes) if "region" in scene else []
    others += draw_boundaries(scene, outline, axes)
    taken = []
    others += draw_places(scene, "point", "monitoring point", "o", axes, taken)
    others += draw_lines(scene, axes, taken)
    others += draw_places(scene, "gauge", "gauge on a joint", "D", axes, taken)
    if len(stages) == 1:  # no column of its own
        stages, others = [], stages + others
    figure.legend_below(axes, joints, stages, others)
    return plot


if __name__ == "__main__":
    figure.run(draw, figure.arguments_of(__doc__, figure.WINDOW))
