#!/usr/bin/python3
"""The section: rocks, joints with their rock bridges, stages, boundary conditions, monitoring points and gauges."""

import matplotlib.lines
import matplotlib.patches
import matplotlib.path
import matplotlib.transforms
import numpy as np
from matplotlib.collections import LineCollection

import figure

STAGE_BORDER = {"edgecolor": "0.25", "linewidth": 0.8, "linestyle": (0, (6, 2, 1, 2))}
SIDES = [(1, 1), (-1, 1), (1, -1), (-1, -1)]  # of a place, where its name can be
AWAY = 11  # a name that has no room beside its place is this much farther off, or a multiple [pt]
CROSSING, FARTHEST = 30, 60  # of lines to numbers of stages; the farthest is of many stages [pt]
AROUND = (0, 6, 12, 20, 30, 42, 56)  # distances of a name from its place, the nearest first [pt]
LETTER, LINE = 4.4, 9  # width of a letter and height of a line [pt]
TICKS = 3  # ticks on a monitoring line are not closer than this [pt]
CLOSE = 16  # names of places that are closer can be taken for each other's: letters stand for all names then [pt]
BESIDE = 5  # a name that is closer to another place than this can be taken for that of the other [pt]
LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
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


def draw_number(number, corners, stages, axes, taken, fonts, farthest):
    """Writes a stage's number inside of its polygon, as near to the middle as nothing is written yet, in the first of these fonts that fits;
    else outside of all stages, as write_outside() does. stages: polygons of all; taken as in free_box(). Returns whether it is there."""
    look = {"ha": "center", "va": "center", "zorder": 4, "bbox": {"boxstyle": "circle,pad=0.2", "facecolor": "white", "linewidth": 0.5}}
    for font in fonts:
        radius = font - 0.5
        for place in inside_of(corners, radius - 1, axes):
            box = points_of(place, axes) - radius, points_of(place, axes) + radius
            if is_free(box, taken):
                taken.append(box)
                axes.annotate(str(number), place, fontsize=font, **look)
                return True
    return write_outside(str(number), corners, stages, axes, np.full(2, 2 * radius), taken, farthest, fontsize=font, **look)


def inside_of(corners, radius, axes):
    """Places of a grid [m] in a polygon that holds a circle [pt] around them, as far as its upper, lower and lateral ends say; those near
    the polygon's middle first."""
    low, high = corners.min(axis=0), corners.max(axis=0)
    middle = (low + high) / 2
    grid = np.stack(np.meshgrid(*(np.linspace(*ends, 25)[1:-1] for ends in zip(low, high))), axis=-1).reshape(-1, 2)
    grid = np.vstack([middle, grid[np.argsort(np.linalg.norm((grid - middle) / (high - low), axis=1), kind="stable")]])
    polygon, reach = matplotlib.path.Path(corners), radius / points_of([1, 0], axes)[0]
    ends = [grid + reach * np.array(side) for side in ((0, 0), (1, 0), (-1, 0), (0, 1), (0, -1))]
    return grid[np.all([polygon.contains_points(end) for end in ends], axis=0)]


def write_outside(text, corners, stages, axes, size, taken, farthest, **look):
    """Text with a line to a stage, where its box of this size overlaps no stage and none of `taken`, to which box and line are added. It is
    near, but the line rather goes CROSSING farther than across another stage, or something written. Nothing is written where this sum is
    more than `farthest`. All in pt. Where stages fill the picture, the text is in its own. Returns whether it is written."""
    paths = [matplotlib.path.Path(points_of(stage, axes)) for stage in stages]
    place = [*inside_of(corners, 2, axes), *inside_of(corners, 0, axes), corners.mean(axis=0)][0]
    middle, best = points_of(place, axes), (farthest, None)
    for away in range(0, 800, 6):
        if away >= best[0]:
            break
        for box in boxes_around(middle, size, away, axes):
            if is_free(box, taken) and not any(path.intersects_bbox(matplotlib.transforms.Bbox(box)) for path in paths):
                line = matplotlib.path.Path([middle, np.mean(box, axis=0)])
                crossed = sum(path.intersects_path(line) for path in paths) - 1  # without its own
                crossed += sum(line.intersects_bbox(matplotlib.transforms.Bbox(other), filled=False) for other in taken)
                best = min(best, (away + CROSSING * crossed, box), key=lambda one: one[0])
    if best[1] is None and farthest < np.inf:
        return False
    box = (middle - size / 2, middle + size / 2) if best[1] is None else best[1]
    along = np.mean(box, axis=0) - middle
    taken += [box, *((at - 1, at + 1) for at in middle + np.linspace(0, 1, 2 + int(np.linalg.norm(along) / 3))[:, None] * along)]
    write(text, place, axes, box, best[1] is not None, **look)
    return True


def draw_stages(scene, axes, inside, taken, crowded=False):
    """Few in shades of grey, with their names below; many in outline, where joints and rocks stay visible. taken as in free_box(); crowded:
    small numbers."""
    entries, all_there = [], True
    stages = scene.get("stage", [])
    few = len(stages) <= FEW
    fonts = [8, 5.5] if few and not crowded else [5.5]
    of_all = [seen for stage in stages for seen in (figure.part_in(axes, corners) for corners in stage["remove_m"]) if len(seen)]
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
            shown = True
            all_there &= draw_number(number, seen, of_all, axes, taken, fonts, np.inf if few else FARTHEST)
        if not shown:
            continue
        when = f"day {stage['date']}" if isinstance(stage["date"], (int, float)) else str(stage["date"])
        entries.append(matplotlib.lines.Line2D([], [], linestyle="none", marker=f"${number}$", color="k",
                                               markeredgewidth=0, markersize=5, label=f"{stage['name']}, {when}"))
    if not few:
        label = "stages, numbered as they follow" if all_there else "stages, some with their numbers"
        return [matplotlib.patches.Patch(facecolor="none", **STAGE_BORDER, label=label)]
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


def points_of(place, axes):
    """A place in the section [m] in the picture [pt], from where x and y are 0."""
    return 72 * (axes.figure.get_figwidth() - 0.8) / np.ptp(axes.get_xlim()) * np.array(place, float)


def is_free(box, taken):
    """Whether a box {low, high} overlaps no other."""
    return not any(np.all(box[0] < high) and np.all(low < box[1]) for low, high in taken)


def free_box(place, size, taken):
    """The box {low, high} of this size beside a place that overlaps none of `taken`, to which it is added, and whether it is farther off.
    All in pt. The first box if there is none."""
    boxes = []
    for away in range(5):
        for side in SIDES:
            gap = np.array([4, 3]) + AWAY * away
            low = np.where(np.array(side) > 0, place + gap, place - gap - size)
            boxes.append((low, low + size))
    chosen = next((i for i, box in enumerate(boxes) if is_free(box, taken)), 0)
    taken.append(boxes[chosen])
    return boxes[chosen], chosen >= len(SIDES)


def write(text, place, axes, box, is_far, **look):
    """Text in a box of free_box(); with a line to its place if it is farther off."""
    line = {"arrowprops": {"arrowstyle": "-", "linewidth": 0.6, "shrinkA": 0, "shrinkB": 2, "path_effects": figure.HALO}} if is_far else {}
    axes.annotate(text, place, xytext=np.mean(box, axis=0) - points_of(place, axes), textcoords="offset points", **look, **line)


def boxes_around(middle, size, away, axes):
    """Boxes {low, high} of this size that are so far from a place, in all directions as far as they are in the picture. All in pt."""
    ends = points_of(np.transpose([axes.get_xlim(), axes.get_ylim()]), axes)
    for angle in np.radians([45, 135, -45, -135, 0, 180, 90, -90, 22, 158, -22, -158, 68, 112, -68, -112]):
        direction = np.array([np.cos(angle), np.sin(angle)])
        centre = middle + direction * (4 + away + np.abs(direction) @ size / 2)
        box = centre - size / 2, centre + size / 2
        if np.all(box[0] > ends[0]) and np.all(box[1] < ends[1]):
            yield box


def write_around(text, place, axes, size, taken, others=(), **look):
    """Text near a place, where its box of this size [pt] overlaps none of `taken`, to which it is added, and is far from other places [pt];
    with a line to the place if it is farther off."""
    middle = points_of(place, axes)
    for away in AROUND:
        free = [(min([20.0, *(np.linalg.norm(np.mean(box, axis=0) - other) for other in others)]), box)
                for box in boxes_around(middle, size, away, axes) if is_free(box, taken)]
        if free:
            box = max(free, key=lambda one: one[0])[1]  # the first of equal ones
            break
    else:
        away, box = 0, (middle + 4, middle + 4 + size)
    taken.append(box)
    write(text, place, axes, box, away > 0, **look)


def is_crowded(names, axes, taken):
    """Whether names of places cannot all stand beside their places, or could be taken for those of others. taken stays as it is."""
    places = np.array([points_of(place, axes) for _, place in names]).reshape(-1, 2)
    apart = np.linalg.norm(places[:, None] - places, axis=2)[np.triu_indices(len(places), 1)]
    if np.any(apart < CLOSE):
        return True
    trial = list(taken)
    for at, (name, _) in enumerate(names):
        box, is_far = free_box(places[at], np.array([LETTER * len(name), LINE]), trial)
        away = np.linalg.norm(np.maximum(0, np.maximum(box[0] - places, places - box[1])), axis=1)
        if is_far or np.any(np.delete(away, at) < BESIDE):
            return True
    return False


def draw_letters(names, axes, taken):
    """Letters in place of the names of places. Returns legend entries that say what they stand for."""
    entries = []
    letters = [*LETTERS, *(first + second for first in LETTERS for second in LETTERS)]
    for letter, (name, place) in zip(letters, names):
        others = [points_of(other, axes) for _, other in names if tuple(other) != tuple(place)]
        write_around(letter, place, axes, np.array([6, 8]), taken, others, ha="center", va="center", zorder=6, fontsize=7,
                     path_effects=figure.HALO)
        entries.append(matplotlib.lines.Line2D([], [], linestyle="none", marker=f"$\\mathrm{{{letter}}}$", color="k", markeredgewidth=0,
                                               markersize=5, label=name))
    return entries


def annotate(name, place, axes, taken):
    """Writes the name of a place beside it; taken as in free_box()."""
    box = free_box(points_of(place, axes), np.array([LETTER * len(name), LINE]), taken)
    write(name, place, axes, *box, ha="center", va="center", zorder=6, path_effects=figure.HALO)


def draw_places(scene, key, label, marker, axes, taken):
    """Monitoring points, or gauges. Returns legend entries, and names with their places."""
    given = scene.get(key, [])
    places = [(place["name"], place["at_m"]) for place in given if figure.is_in(axes, place["at_m"])]
    label += f" ({len(given) - len(places)} outside)" if len(places) < len(given) else ""
    look = {"linestyle": "none", "marker": marker, "color": "k", "markersize": 3.5}
    for _, place in places:
        axes.plot(*place, zorder=5, path_effects=figure.HALO, **look)
        taken.append((points_of(place, axes) - 2, points_of(place, axes) + 2))
    return [matplotlib.lines.Line2D([], [], label=label, **look)] if places else [], places


def draw_lines(scene, axes, taken):
    """Monitoring lines, with ticks at their points, or at some if these are dense. Returns as draw_places()."""
    lines = scene.get("monitoring_line", [])
    look = {"color": "k", "linewidth": 0.6}
    tick = 0.006 * max(np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim()))  # half of its length
    for line in lines:
        ends = np.array([line["from_m"], line["to_m"]], float)
        along = ends[1] - ends[0]
        places = ends[0] + np.linspace(0, 1, line["points"])[:, None] * along
        spacing = np.linalg.norm(points_of(along, axes)) / (line["points"] - 1)
        some = places[::int(np.ceil(TICKS / spacing))]
        across = tick * np.array([-along[1], along[0]]) / np.linalg.norm(along)
        axes.add_collection(LineCollection([ends, *np.stack([some - across, some + across], axis=1)], zorder=5, **look))
        taken += [(points_of(place, axes) - 2, points_of(place, axes) + 2) for place in places]
    entry = matplotlib.lines.Line2D([], [], label="monitoring line", marker="|", markersize=4, markeredgewidth=0.6, **look)
    return [entry] if lines else [], [(line["name"], line["from_m"]) for line in lines if figure.is_in(axes, line["from_m"])]


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
    others = figure.draw_rocks(scene, axes) if "region" in scene else []
    others += draw_boundaries(scene, outline, axes)
    taken, names = [], []
    for entries, more in (draw_places(scene, "point", "monitoring point", "o", axes, taken), draw_lines(scene, axes, taken),
                          draw_places(scene, "gauge", "gauge on a joint", "D", axes, taken)):
        others += entries
        names += more
    crowded, letters = is_crowded(names, axes, taken), []
    if crowded:
        letters = draw_letters(names, axes, taken)
    else:
        for name, place in names:
            annotate(name, place, axes, taken)
    stages = draw_stages(scene, axes, inside, taken, crowded)
    if len(stages) == 1:  # no column of its own
        stages, others = [], stages + others
    figure.legend_below(axes, joints, stages, letters, others)
    return plot


if __name__ == "__main__":
    figure.run(draw, figure.arguments_of(__doc__, figure.WINDOW))
