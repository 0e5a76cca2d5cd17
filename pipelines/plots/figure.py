"""What the plots share: one look, the way files are opened, and the scene inside them.

The look is for print: widths of one or two columns, 8-point text, and sets, stages and points told apart by line
style, width, marker or shade, so that nothing is lost in grey.
"""

import argparse
import contextlib
import datetime
import os
import re
import sys
import textwrap
import tomllib
from pathlib import Path

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.axis
import matplotlib.colors
import matplotlib.dates
import matplotlib.lines
import matplotlib.patches
import matplotlib.path
import matplotlib.patheffects
import matplotlib.pyplot as plt
import matplotlib.text
import matplotlib.ticker
import matplotlib.transforms
import numpy as np

LOOK = 6  # one more when pictures look different: those of docs/pictures are stale then (docs/pictures.py)

BOUNDARY, JOINT, WELDED = 0, 1, 2  # /edges/kind
ONE_COLUMN = 3.35  # [in]
TWO_COLUMNS = 6.9  # [in]

# Different shades in grey too; where shades are not enough, markers and line styles repeat the distinction.
COLORS = ["#1b2a5c", "#b5403a", "#2f9e77", "#d9a22b", "#6fb1e0", "#8a8a8a"]
SET_COLORS = [*COLORS, "#8e4f9f", "#5d3b1e"]
WIDTHS = [1.2, 0.8, 1.7, 2.3, 0.6, 1.4]  # of lines that have no markers [pt]
LINES = ["-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 3))]
MARKERS = ["o", "s", "^", "D", "v", "P"]
HALO = [matplotlib.patheffects.withStroke(linewidth=2, foreground="white")]
ROCKS = ["#dfe3e8", "#e6d3c4", "#f1e6b8", "#dce8d6", "#e5dcec"]  # pale, in the scene's order
FORMULAS = [r"$\sigma_{xx}$", r"$\sigma_{yy}$", r"$\sigma_n$", r"$\tau$"]  # in labels of the plots
# Pale where there is little, so that black lines and arrows stay visible over it.
SHADES = matplotlib.colors.ListedColormap(
    0.2 + 0.8 * matplotlib.colormaps["YlGnBu"](np.linspace(0, 0.95, 256))[:, :3])

plt.rcParams.update({
    "font.size": 8,
    "axes.labelsize": 8,
    "axes.titlesize": 8,
    "legend.fontsize": 7,
    "xtick.labelsize": 7,
    "ytick.labelsize": 7,
    "axes.linewidth": 0.6,
    "lines.linewidth": 1.0,
    "lines.markersize": 3.5,
    "legend.frameon": False,
    "figure.constrained_layout.use": True,
    "savefig.dpi": 300,
})


def set_color(i):
    """Colour of a joint set, by its number in the file: the same in all pictures."""
    return SET_COLORS[i % len(SET_COLORS)]


def pale(color):
    """The same colour for an area under black lines."""
    return tuple(0.45 * part + 0.55 for part in matplotlib.colors.to_rgb(color))


class NotWanted(Exception):
    """The file, or an option, is not what the plot needs."""


class Named(NotWanted):
    """The same, with the name of the file."""


def arguments_of(description, *options):
    """The command line FILE.h5 -o NAME.png and `options`, each a pair (names, keywords) for argparse."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("file", metavar="FILE.h5")
    parser.add_argument("-o", "--output", metavar="NAME.png", required=True, help="or .pdf, .svg")
    for names, keywords in options:
        parser.add_argument(*names, **keywords)
    return parser.parse_args(window_as_words(sys.argv[1:]))


def window_as_words(arguments):
    """Arguments with --window X0,Y0,X1,Y1, as jointcreep has it, as four words."""
    words = []
    for word in arguments:
        if word.startswith("--window="):
            words += ["--window", *word.removeprefix("--window=").split(",")]
        else:
            words += word.split(",") if words[-1:] == ["--window"] else [word]
    return words


@contextlib.contextmanager
def checked(path):
    """A file of jointcreep. Whatever is not as wanted in it raises Named."""
    try:
        with h5py.File(path, "r") as file:
            if not file_type(file).startswith("jointcreep"):
                raise NotWanted("this is not a file of jointcreep")
            yield file
    except Named:  # of another file that was opened in between
        raise
    except (OSError, NotWanted) as error:
        raise Named(f"{path}: {error}") from error


@contextlib.contextmanager
def opened(path):
    """The same for a script: whatever is not as wanted ends in one line on stderr and exit code 2."""
    try:
        with checked(path) as file:
            yield file
    except Named as error:
        print(f"{Path(sys.argv[0]).name}: {error}", file=sys.stderr)
        sys.exit(2)


def drawn(draw, path, **options):
    """The figure that draw(file, **options) makes of a file. Raises Named."""
    with checked(path) as file:
        figure = draw(file, **options)
        add_strengths(file, figure)
    draw_names_as_they_are(figure)
    return figure


def run(draw, arguments):
    """A script's work: opens the file, draws with its options, saves."""
    options = {name: value for name, value in vars(arguments).items() if name not in ("file", "output")}
    try:
        figure = drawn(draw, arguments.file, **options)
    except Named as error:
        print(f"{Path(sys.argv[0]).name}: {error}", file=sys.stderr)
        sys.exit(2)
    try:
        save(figure, Path(arguments.output))
    except (OSError, ValueError) as error:
        print(f"{Path(sys.argv[0]).name}: {arguments.output}: {error}", file=sys.stderr)
        sys.exit(4)


def draw_names_as_they_are(figure):
    """A name with dollar signs is no formula. Formulas are in the plots' own labels, and in ticks."""
    of_ticks = {id(label) for tick in figure.findobj(matplotlib.axis.Tick) for label in (tick.label1, tick.label2)}
    of_ticks |= {id(axis.offsetText) for axis in figure.findobj(matplotlib.axis.Axis)}
    for text in figure.findobj(matplotlib.text.Text):
        if id(text) not in of_ticks and not any(symbol in text.get_text() for symbol in FORMULAS):
            text.set_parse_math(False)


def save(figure, path):
    """The picture appears under its name only once it is whole."""
    partial = path.with_name(f"{path.stem}.partial-{os.getpid()}{path.suffix}")
    try:
        cut = {"bbox_inches": "tight", "pad_inches": 0.03} if getattr(figure, "cuts_margins", False) else {}
        figure.savefig(partial, **cut)
        os.replace(partial, path)
    finally:
        partial.unlink(missing_ok=True)


def text_of(value):
    return value.decode() if isinstance(value, bytes) else str(value)


def file_type(file):
    """"jointcreep network", "jointcreep joints", "jointcreep result" or "jointcreep checkpoint"."""
    return text_of(file.attrs.get("filetype", ""))


def array(file, path):
    """A dataset as an array of numbers."""
    if path not in file:
        raise NotWanted(f"there is no {path} in this {file_type(file)} file")
    return file[path][()]


def untraced_edges(file):
    """Which edges are joint edges without a part of a joint trace: rock bridges, and extensions of joints."""
    return (array(file, "/edges/kind") == JOINT) & (array(file, "/edges/joint_fraction") == 0)


def texts(file, path):
    """A dataset as a list of str."""
    return [text_of(text) for text in np.ravel(array(file, path))]


def scene_of(file):
    """The scene that the file was made from, as tomllib reads it."""
    return tomllib.loads(texts(file, "/scene")[0])


def day_of(file, time):
    """ "16 July 1994", or "day 548" of a scene that counts days."""
    start = scene_of(file)["schedule"].get("start", 0)
    if isinstance(start, datetime.date):
        date = start + datetime.timedelta(float(time))
        return f"{date.day} {date:%B %Y}"
    return f"day {time:.5g}"


def wrapped(text, width):
    """Lines of a text, without a break inside of a date as day_of() has it."""
    kept = re.sub(r"\b(\d{1,2}) ([A-Z][a-z]+) (\d{4})\b|\b(day) (\d)", lambda found: found[0].replace(" ", "\u00a0"), text)
    return [line.replace("\u00a0", " ") for line in textwrap.wrap(kept, width, break_on_hyphens=False)]


def ending_of(file):
    """What a title says of a run that found no equilibrium; nothing of others."""
    if "/failure" not in file:
        return ""
    stage, day = texts(file, "/failure/stage")[0], day_of(file, array(file, "/failure/time")[0])
    if not has_no_equilibrium(file):
        return f'ended in stage "{stage}" on {day}' if stage else f"ended on {day}"
    return f'stage "{stage}" found no equilibrium on {day}' if stage else f"no equilibrium on {day}"


def has_no_equilibrium(file):
    """Whether a run that did not end found no equilibrium; others were stopped, or a guard ended them."""
    return not texts(file, "/failure/reason")[0].startswith(("stopped by a signal", "the energy balance", "the result is wrong"))


def creep_of(file):
    """"with creep" or "without creep" of a run whose scene has creep; nothing of others."""
    options = texts(file, "/provenance/options") if "/provenance/options" in file else [""]
    if "creep" not in scene_of(file):
        return ""
    return "without creep" if "--no-creep" in options[-1].split() else "with creep"


def strength_factor_of(file):
    """The factor that the strengths of a run were divided by; 1 if none was."""
    options = texts(file, "/provenance/options") if "/provenance/options" in file else []
    found = re.search(r"--strength-factor (\S+)", options[-1] if options else "")
    return float(found[1]) if found else 1.0


def add_strengths(file, figure):
    """A title of each picture of a run with reduced strengths, unless the picture says it already (says_factor)."""
    factor = strength_factor_of(file)
    if factor == 1 or getattr(figure, "says_factor", False):
        return
    above = figure._suptitle.get_text() + "; " if figure._suptitle else ""
    figure.suptitle(f"{above}strengths / {factor:.4g}", fontsize=8)


def name_index(names, wanted, what):
    """Row of a name, the first one if none is wanted."""
    if not names:
        raise NotWanted(f"there is no {what} in this file")
    if wanted is None:
        return 0
    if wanted not in names:
        raise NotWanted(f"there is no {what} '{wanted}'; there are: {', '.join(names)}")
    return names.index(wanted)


WINDOW = (["--window"], {"nargs": 4, "type": float, "metavar": ("X0", "Y0", "X1", "Y1"),
                         "help": "part of the section to draw, in m, as four words or with commas; default: all of it"})


def section_axes(outline, window=None):
    """A figure for a section, or for the window x0, y0, x1, y1 of it, with equal scales. outline: places of the section, None of one that is
    not known."""
    if window:
        section, outline = outline, np.reshape(window, (2, 2))
        if not np.all(outline[0] < outline[1]):
            raise NotWanted("--window: expected X0 below X1, and Y0 below Y1")
        ends = outline if section is None else (np.min(section, axis=0), np.max(section, axis=0))
        if np.any(outline[1] <= ends[0]) or np.any(outline[0] >= ends[1]):
            raise NotWanted(f"--window shows nothing of the section, which is from [{ends[0][0]:g}, {ends[0][1]:g}] to "
                            f"[{ends[1][0]:g}, {ends[1][1]:g}] m; expected a part of it")
    low, high = np.min(outline, axis=0), np.max(outline, axis=0)
    width, height = high - low
    scale = min((TWO_COLUMNS - 0.8) / width, 5.5 / height)
    figure, axes = plt.subplots(figsize=(max(ONE_COLUMN, width * scale + 0.8), height * scale + 0.5))
    figure.cuts_margins = window is not None  # it has no margins of its own, into which a legend could reach
    margin = 0 if window else 0.05 * max(width, height)
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin, high[1] + margin)
    axes.set_aspect("equal")
    axes.set_xlabel("x (m)")
    axes.set_ylabel("y (m)")
    return figure, axes


def extension(values, low, high):
    """Which ends of a colour scale are pointed, since values lie beyond it."""
    ends = {(0, 0): "neither", (1, 0): "min", (0, 1): "max", (1, 1): "both"}
    return ends[int(np.min(values) < low), int(np.max(values) > high)]


def part_in(axes, corners):
    """The corners of what the axes show of a polygon; none if it is outside."""
    if all(is_in(axes, corner) for corner in corners):
        return np.array(corners, float)
    box = matplotlib.transforms.Bbox(np.transpose([axes.get_xlim(), axes.get_ylim()]))
    parts = matplotlib.path.Path([*corners, corners[0]], closed=True).clip_to_bbox(box).to_polygons()
    return parts[0][:-1] if parts else np.empty((0, 2))


def is_in(axes, place):
    """Whether a place is in what the axes show."""
    return all(low <= at <= high for at, (low, high) in zip(place, (axes.get_xlim(), axes.get_ylim())))


def draw_rocks(scene, axes, names=None):
    """The section and its regions in the colours of their rocks. Returns legend entries, by other names if wanted."""
    rocks = [rock["name"] for rock in scene["rock"]]
    color = {rock: ROCKS[i % len(ROCKS)] for i, rock in enumerate(rocks)}
    inside = matplotlib.patches.Polygon(scene["section"]["outline_m"], transform=axes.transData)
    for place in (scene["section"], *scene.get("region", [])):
        patch = axes.add_patch(matplotlib.patches.Polygon(place["outline_m"], facecolor=color[place["rock"]], linewidth=0,
                                                          zorder=0.1))
        patch.set_clip_path(inside)
        patch.set_in_layout(False)  # layout fails on what is clipped and outside of the window
    return [matplotlib.patches.Patch(facecolor=color[rock], label=(names or {}).get(rock, rock)) for rock in rocks]


BORDER = {"color": "0.4", "linewidth": 0.7, "linestyle": (0, (5, 3))}  # of what joint sets are generated in


def is_on(outline, places):
    """Which places are on an outline, to a thousandth of its size."""
    corners = np.array(outline, float)
    start, run = corners[:, None], (np.roll(corners, -1, axis=0) - corners)[:, None]
    share = np.clip(((places - start) * run).sum(axis=2) / (run**2).sum(axis=2), 0, 1)
    return np.linalg.norm(places - start - share[..., None] * run, axis=2).min(axis=0) < 1e-3 * np.ptp(corners, axis=0).max()


def draw_region_borders(scene, axes):
    """Borders of the regions that joint sets are generated in (region_m), each once, where they are not on the outline: joints end there.
    Returns a legend entry, if the axes show one."""
    regions = {tuple(map(tuple, one["region_m"])): one["name"] for one in reversed(scene.get("joint_set", [])) if "region_m" in one}
    inside, seen = matplotlib.patches.Polygon(scene["section"]["outline_m"], transform=axes.transData), False
    for corners in regions:
        closed = np.array([*corners, corners[0]], float)
        low, high = np.transpose([axes.get_xlim(), axes.get_ylim()])
        places = np.concatenate([start + np.linspace(0, 1, 201)[:, None] * (end - start) for start, end in zip(closed, closed[1:])])
        on_outline = is_on(scene["section"]["outline_m"], places)
        drawn = np.where(on_outline[:, None], np.nan, places) if np.any(on_outline) else closed
        (line,) = axes.plot(*drawn.T, zorder=2.4, **BORDER)
        line.set_clip_path(inside)
        line.set_in_layout(False)
        seen |= bool(np.any(np.all((low < places) & (places < high), axis=1) & ~on_outline))
    return [matplotlib.lines.Line2D([], [], label="border of joint sets (region_m): no joints beyond", **BORDER)] if seen else []


def legend_below(axes, *groups):
    """A legend under the axes, a column for each group of entries if there is room; the figure grows by its height. Labels that are
    longer than the figure is wide have several lines: the layout would make the axes smaller."""
    width, height = axes.figure.get_size_inches()
    groups = [group for group in groups if group]
    for entry in (entry for group in groups for entry in group):
        entry.set_label("\n".join(wrapped(entry.get_label(), int((width - 0.5) / 0.056)) or [" "]))
    longest = max(len(line) for group in groups for entry in group for line in entry.get_label().splitlines())
    columns = int(width / (0.5 + 0.048 * longest))  # a sign and the text [in]
    if 1 < len(groups) <= columns:
        columns, rows = len(groups), max(len(group) for group in groups)
        nothing = matplotlib.lines.Line2D([], [], linestyle="none", label=" ")
        entries = [entry for group in groups for entry in [*group, *[nothing] * (rows - len(group))]]
    else:
        entries = [entry for group in groups for entry in group]
        columns = max(1, min(len(entries), columns))
        rows = -(-len(entries) // columns)
    lines = rows + sum(entry.get_label().count("\n") for entry in entries)
    axes.figure.set_size_inches(width, height + 0.22 + 0.16 * lines)
    axes.figure.cuts_margins = True  # of a high picture the legend would reach beyond its lower edge
    axes.legend(handles=entries, loc="upper center", bbox_to_anchor=(0.5, -0.52 / (height - 0.5)), ncol=columns,
                borderaxespad=0)


CLOSE, NEAR = 12, 20  # names of stages that are closer have one label, or are steep, so that they do not touch [pt]


def mark_stages(axes, places, names, with_names=True):
    """Lines across the axes where stages are, and their names over the axes: steep ones if they are near, and one for stages that are too
    close for a name each."""
    point = np.ptp(axes.get_xlim()) / (72 * axes.figure.get_figwidth() * axes.get_position().width)  # on the axis
    groups = []
    for place, name in sorted(zip(places, names), key=lambda one: one[0]):
        axes.axvline(place, color="0.6", linewidth=0.6, zorder=0)
        if groups and place - groups[-1][-1][0] < CLOSE * point and place - groups[-1][0][0] < 2 * CLOSE * point:
            groups[-1].append((place, name))
        else:
            groups.append([(place, name)])
    is_near = any(other[0][0] - one[0][0] < NEAR * point for one, other in zip(groups, groups[1:]))
    for group in groups:
        place, name = group[0]
        if len(group) > 1:
            name = ", ".join(one for _, one in group) if len(group) < 4 else f"{name} to {group[-1][1]} ({len(group)} stages)"
        if with_names:
            axes.annotate(name, (place, 1.01), xycoords=("data", "axes fraction"), rotation=45 if is_near else 25, ha="left",
                          va="bottom", rotation_mode="anchor", fontsize=6.5)


class DateTicks(matplotlib.ticker.Locator):
    """Ticks of an axis of days since a date, where months or years begin; at most `most`, if given."""

    def __init__(self, start, most):
        self.first, self.dates = matplotlib.dates.date2num(start), matplotlib.dates.AutoDateLocator(minticks=3, maxticks=7)
        self.most = most

    def tick_values(self, low, high):
        ends = [matplotlib.dates.num2date(self.first + day) for day in (low, max(high, low + 1))]
        ticks = np.array([day - self.first for day in self.dates.tick_values(*ends) if low <= day - self.first <= high])
        return ticks[:: -(-len(ticks) // self.most)] if self.most and len(ticks) else ticks

    def __call__(self):
        return self.tick_values(*sorted(self.axis.get_view_interval()))


def label_time(file, axes, more="", most_dates=None):
    """Names an x axis of days; where the scene has a date of the start, its ticks are dates. more: a line below."""
    start = scene_of(file)["schedule"].get("start", 0)
    label = "time since the start (days)"
    if not isinstance(start, (int, float)):
        label = f"date (start: {start})"
        axes.xaxis.set_major_locator(DateTicks(start, most_dates))
        axes.xaxis.set_major_formatter(lambda day, _: str(start + datetime.timedelta(days=round(day))))
    axes.set_xlabel("\n".join(filter(None, (label, more))))
