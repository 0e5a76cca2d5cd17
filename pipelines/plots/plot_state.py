#!/usr/bin/python3
"""The section at one state of a result file: displacement, stress or the state of the contacts. Removed rock is not
drawn, and positions are those at the start, unless displacements are magnified.

The state is its number, counted from 0, the name of the stage that it follows, this name as it is in
names of pictures, or "last".

Of a run that found no equilibrium, the last state is that before the stage that found none. Its picture also shows what happened
after it: the rock that was excavated, and the moving blocks, with arrows along their motion. The title says why the run ended.
"""

import re
import textwrap

import matplotlib.colors
import matplotlib.lines
import matplotlib.patches
import matplotlib.patheffects
import matplotlib.tri
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection

import figure
from stage_names import plain
from suited import enlarged

MOVING = "#dfaaa0"  # fill of moving blocks
STUCK, SLIPPING, OPEN = 1, 2, 3  # /states/contact_status
ROUND_A_FORCE = 0.25  # of the section's larger side, of the picture around an unbalanced force
SLIPPED = 1e-3  # of the largest slip; below, a contact counts as one that has not slipped
COMPONENTS = {
    "major": "larger principal stress",
    "minor": "smaller principal stress",
    "mean": "mean stress in the section",
    "xx": "horizontal stress $\\sigma_{xx}$",
    "yy": "vertical stress $\\sigma_{yy}$",
}


def name_of(file, state):
    """ "16 July 1994, after bench 1", "16 July 1994, before bench 1" or "day 548" of a scene that counts days."""
    time, event = figure.array(file, "/states/time"), figure.texts(file, "/states/event")
    name = figure.day_of(file, time[state])
    if event[state]:
        return f"{name}, after {event[state]}"
    if state + 1 < len(time) and event[state + 1] and time[state + 1] == time[state]:
        return f"{name}, before {event[state + 1]}"
    return name


def state_index(file, wanted):
    event = figure.texts(file, "/states/event")
    if not event:
        raise figure.NotWanted("there is no state in this file")
    if wanted == "last":
        return len(event) - 1
    if wanted.isdecimal() and int(wanted) < len(event):
        return int(wanted)
    if wanted and wanted in event:
        return event.index(wanted)
    named = [state for state, name in enumerate(event) if name]
    words = dict(zip(plain([event[state] for state in named]), named))
    if wanted in words:
        return words[wanted]
    names = "\n".join(f"{state}: {name_of(file, state)}" for state in range(len(event)))
    raise figure.NotWanted(f"there is no state '{wanted}'; there are:\n{names}")


class Section:
    """The zones that are there in a state, with their gridpoints where the picture has them."""

    def __init__(self, file, state, magnify, window=None, since_reset=False):
        self.window = window
        self.start = figure.array(file, "/mesh/gridpoint_position")
        self.displacement = figure.array(file, "/states/displacement")[state]
        if since_reset:
            self.displacement = self.displacement - figure.array(file, "/states/displacement")[
                figure.array(file, "/states/reset_state")[state]]
        self.position = self.start + magnify * self.displacement
        self.there = figure.array(file, "/states/zone_present")[state] == 1
        if not np.any(self.there):
            raise figure.NotWanted("nothing is there any more in this state")
        self.zones = figure.array(file, "/mesh/zone_gridpoint")[self.there]
        self.triangles = matplotlib.tri.Triangulation(*self.position.T, self.zones)

        inside = self.is_seen(self.position)[self.zones].any(axis=1)
        self.seen = inside if inside.any() else ~inside  # which of the zones the picture shows, even in part; those make its scale

        # A number for every place; the gridpoints on the sides of a joint share it.
        self.place = np.unique(self.start, axis=0, return_inverse=True)[1].reshape(-1)

    def is_seen(self, places):
        """Which places are in the window; all without one."""
        low, high = np.reshape(self.window, (2, 2)) if self.window else (-np.inf, np.inf)
        return np.all((low <= places) & (places <= high), axis=1)

    def borders(self):
        """Sides of zones on the outline of what is there, and those on joints: pairs of gridpoints [side, 2]."""
        sides = np.vstack([self.zones[:, [i, (i + 1) % 3]] for i in range(3)])

        def met_once(of_sides):
            _, inverse, count = np.unique(np.sort(of_sides, axis=1), axis=0, return_inverse=True, return_counts=True)
            return count[inverse.reshape(-1)] == 1

        outline = met_once(self.place[sides])
        return sides[outline], sides[met_once(sides) & ~outline]

    def on_grid(self, columns):
        """Zones that lie on a coarse grid with so many columns, and the grid's spacing [m]."""
        low, high = np.reshape(self.window, (2, 2)) if self.window else (self.start.min(axis=0), self.start.max(axis=0))
        spacing = np.max(high - low) / columns
        middle = self.start[self.zones].mean(axis=1)
        cell = np.floor((middle - low) / spacing).astype(int)
        off_centre = np.linalg.norm((middle - low) / spacing - cell - 0.5, axis=1)
        order = np.argsort(off_centre)
        _, first = np.unique(cell[order], axis=0, return_index=True)
        chosen = order[first]
        chosen = chosen[np.all((middle[chosen] > low) & (middle[chosen] < high), axis=1)]
        return chosen[off_centre[chosen] < 0.35], spacing


def draw_borders(section, axes, joints=True):
    outline, on_joints = section.borders()
    if joints:
        axes.add_collection(LineCollection(section.position[on_joints], color="0.35", linewidth=0.25, zorder=2))
    axes.add_collection(LineCollection(section.position[outline], color="k", linewidth=1.0, capstyle="round",
                                       zorder=2.5))


def lines_of(label, width):
    """A label in as few lines as this width [characters] permits, about equally long. A unit is on one line with the word before it."""
    kept = label.replace(" (", "\u00a0(")
    broken = [textwrap.wrap(kept, one, break_long_words=False, break_on_hyphens=False) for one in range(max(width, 1), 0, -1)]
    return "\n".join([lines for lines in broken if len(lines) == len(broken[0])][-1]).replace("\u00a0", " ")


def add_scale(axes, colored, label, low, high, values):
    """A colour scale as high as the axes, with a pointed end where values lie beyond it. Beside low axes its label is horizontal."""
    width = axes.figure.get_figwidth() - 1.7  # of the axes [in]
    height = width * np.ptp(axes.get_ylim()) / np.ptp(axes.get_xlim())
    bar = axes.figure.colorbar(colored, cax=axes.inset_axes([1 + 0.12 / width, 0, 0.14 / width, 1]),
                               extend=figure.extension(values, low, high))
    if height < 1.8:
        bar.set_label(lines_of(label, 16), rotation=0, ha="left", va="center")
    else:
        bar.set_label(lines_of(label, int(16 * height)))


def draw_displacement(file, state, section, axes, since_reset, limits):
    size = 1e3 * np.linalg.norm(section.displacement, axis=1)
    seen = size[np.unique(section.zones[section.seen])]
    largest = seen.max()
    if largest == 0 and not limits:
        axes.tripcolor(section.triangles, size, shading="gouraud", cmap=figure.SHADES, vmin=0, vmax=1, rasterized=True)
        draw_borders(section, axes)
        # A picture of a failure may have arrows of moving blocks.
        where = "the last equilibrium" if "/failure" in file else "this part of the section" if section.window else "this state"
        return [matplotlib.patches.Patch(facecolor=figure.plt.get_cmap(figure.SHADES)(0.0), label=f"no displacement in {where}")]
    low, high = limits or (0, largest)
    colored = axes.tripcolor(section.triangles, size, shading="gouraud", cmap=figure.SHADES, vmin=low, vmax=high,
                             rasterized=True)
    since = "reset" if since_reset else "the in-situ equilibrium"
    add_scale(axes, colored, f"displacement since {since} (mm)", low, high, seen)
    draw_borders(section, axes)

    chosen, spacing = section.on_grid(26)
    place = section.position[section.zones[chosen]].mean(axis=1)
    arrow = 1e3 * section.displacement[section.zones[chosen]].mean(axis=1)
    longest = high if limits else max(np.linalg.norm(arrow, axis=1).max(), 1e-12)
    arrows = axes.quiver(*place.T, *arrow.T, angles="xy", scale_units="xy", scale=longest / (1.25 * spacing),
                         units="inches", width=0.012, headwidth=4, headlength=5, headaxislength=4.5, minlength=0.6,
                         zorder=5)
    add_key(axes, arrows, round_below(longest), "mm")
    if figure.ending_of(file) and state == len(figure.array(file, "/states/time")) - 1:  # then there are red arrows, too
        return [matplotlib.lines.Line2D([], [], color="k", linewidth=0.8, marker=5, markevery=[1],
                                        label="black arrows: displacement in the last recorded state")]
    return []


def round_below(value):
    """The largest of 1, 2, 5 times a power of ten that is not above a positive value."""
    power = 10.0 ** np.floor(np.log10(value))
    return max(power * digit for digit in (1, 2, 5) if power * digit <= value * (1 + 1e-9))


def add_key(axes, arrows, value, unit):
    """How long an arrow, or a cross, of some size is: above the axes, under the title, where nothing else is."""
    height = axes.figure.get_figheight() - 0.7  # of the axes, about [in]
    axes.quiverkey(arrows, 0.93, 1 + 0.09 / height, value, f"{value:g} {unit}", labelpos="W", labelsep=0.06).text.set_path_effects(figure.HALO)
    axes.has_key = True


def principal(stress):
    """Principal stresses, compression positive, and the direction of the larger one: {value, value, angle}."""
    xx, yy, xy = -stress.T
    mean, radius = (xx + yy) / 2, np.hypot((xx - yy) / 2, xy)
    return mean + radius, mean - radius, np.arctan2(2 * xy, xx - yy) / 2


def draw_crosses(section, stress, axes):
    """Principal stresses on a coarse grid, as crosses along their directions. Legend entries name the largest of all
    zones in the picture."""
    chosen, spacing = section.on_grid(26)
    major, minor, angle = principal(1e-6 * stress[chosen])  # [MPa]
    place = section.position[section.zones[chosen]].mean(axis=1)
    usual = np.percentile(np.abs([major, minor]), 95)  # a few in corners are much longer
    nothing = 1e-6 * np.max(np.abs([major, minor]))  # rounding
    look = {"angles": "xy", "scale_units": "xy", "scale": (usual or 1) / spacing, "units": "inches", "pivot": "mid",
            "headwidth": 0, "headlength": 0, "headaxislength": 0, "minlength": 0, "zorder": 5}
    values = np.concatenate([major, minor])
    along = np.concatenate([angle, angle + np.pi / 2])
    arms = np.abs(values)[:, None] * np.stack([np.cos(along), np.sin(along)], axis=1)
    places = np.concatenate([place, place])
    entries = []
    for sign, label, color, width in ((1, "compressive", "k", 0.008), (-1, "tensile", figure.COLORS[1], 0.022)):
        of_sign = sign * values > nothing
        drawn = axes.quiver(*places[of_sign].T, *arms[of_sign].T, color=color, width=width, **look)
        if sign > 0 and usual > 0:
            add_key(axes, drawn, round_below(usual), "MPa")
        of_zones = (sign * np.stack(principal(1e-6 * stress[section.seen])[:2])).max(axis=0)
        largest, usually = of_zones.max(), np.percentile(of_zones, 99)
        at_corners = "" if usually > largest / 2 else ", in 99 % of the zones none" if usually <= 0 else \
            f", in 99 % of the zones up to {float(f'{usually:.2g}'):g} MPa"
        if np.any(of_sign):
            entries.append(matplotlib.lines.Line2D([], [], color=color, linewidth=72 * width,
                                                   label=f"{label} principal stress, up to {float(f'{largest:.2g}'):g} MPa{at_corners}"))
    return entries


def draw_stress(file, state, section, axes, component, limits):
    stress = figure.array(file, "/states/stress")[state][section.there]
    major, minor, _ = principal(stress)
    value = 1e-6 * {"major": major, "minor": minor, "mean": (major + minor) / 2,
                    "xx": -stress[:, 0], "yy": -stress[:, 1]}[component]
    # A few zones in corners would take most of the scale.
    low, high = limits or np.percentile(value[section.seen], [0.5, 99.5])
    if not low < high:
        low, high = low - 0.5, high + 0.5
    colored = axes.tripcolor(section.triangles, facecolors=value, cmap=figure.SHADES, vmin=low, vmax=high,
                             edgecolors="face", linewidth=0.1, rasterized=True)
    add_scale(axes, colored, f"{COMPONENTS[component]}, compressive (MPa)", low, high, value[section.seen])
    draw_borders(section, axes)
    return draw_crosses(section, stress, axes) if component in ("major", "minor") else []


def contact_lines(file, section):
    """The pieces of joint that contacts stand for: pairs of places [piece, 2, 2], and the contact of each. A piece is
    half a zone's side, from its end, where the contact is, to its middle. At the face of an excavation two contacts have the
    same gridpoints: one of the rock that stays."""
    contacts, centre = {}, figure.array(file, "/mesh/contact_centre")
    for i, pair in enumerate(figure.array(file, "/mesh/contact_gridpoint").tolist()):
        contacts.setdefault(frozenset(pair), []).append(i)
    outline, on_joints = section.borders()
    in_zones = np.unique(figure.array(file, "/mesh/zone_gridpoint"))
    ground = np.setdiff1d(np.arange(len(section.place)), in_zones)  # that the rock rests on, without zones
    ground_at = dict(zip(section.place[ground], ground))

    walls = {}  # the two sides of a zone's side on a joint, each as {place: gridpoint}
    for side in on_joints:
        walls.setdefault(frozenset(section.place[side]), []).append(dict(zip(section.place[side], side)))
    for side in outline:
        if all(place in ground_at for place in section.place[side]):
            walls[frozenset(section.place[side])] = [dict(zip(section.place[side], side)), ground_at]

    lines, of_contact = [], []
    for one, other in walls.values():
        ends = {place: section.position[[one[place], other[place]]].mean(axis=0) for place in one}
        middle = sum(ends.values()) / 2
        for place, end in ends.items():
            here = contacts.get(frozenset((one[place], other[place])))
            if here:
                lines.append((end, middle))
                of_contact.append(min(here, key=lambda i, at=(end + middle) / 2: np.sum((centre[i] - at) ** 2)))
    return np.reshape(lines, (-1, 2, 2)), np.array(of_contact, int)


def with_gap(entry, size, color):
    """Shows a legend entry as an open contact is drawn: two walls with a gap between them."""
    entry.set(color="w", linewidth=0.45 * size, path_effects=[
        matplotlib.patheffects.Stroke(linewidth=size, foreground=color), matplotlib.patheffects.Normal()])


def draw_contacts(file, state, section, axes):
    status = figure.array(file, "/states/contact_status")[state]
    opening, shear = np.abs(figure.array(file, "/states/relative_displacement")[state].T)  # since the in-situ state
    lines, of_contact = contact_lines(file, section)
    draw_borders(section, axes, joints=False)

    slip = np.abs(figure.array(file, "/states/slip")[state])
    slipped = (status == STUCK) & (slip > SLIPPED * slip.max(initial=0))
    seen = section.is_seen(figure.array(file, "/mesh/contact_centre"))
    entries = []
    no_joint = figure.untraced_edges(file) | (figure.array(file, "/edges/kind") == figure.WELDED)
    extended = no_joint[figure.array(file, "/mesh/contact_edge")]  # of contacts
    for chosen, label, look in (((status == STUCK) & ~slipped & ~extended, "contacts sticking", {"color": "0.65", "linewidth": 0.5}),
                                ((status == STUCK) & ~slipped & extended, "sticking, rock bridge or extension",
                                 {"color": "0.78", "linewidth": 0.5, "linestyle": (0, (2, 2))}),
                                (slipped, "sticking, slipped earlier", {"color": "#87a9cf", "linewidth": 1.2})):
        axes.add_collection(LineCollection(lines[chosen[of_contact]], zorder=2, **look))
        if label == "contacts sticking" or np.any(chosen):
            entries.append(matplotlib.lines.Line2D([], [], label=f"{np.sum(chosen & seen)} {label}", **look))
    if section.window:
        entries[0].set_label(f"{entries[0].get_label()} (numbers: of the window)")
    thin, thick = 2.2, 4.8  # lines without and with the largest relative displacement of their kind [pt]
    for code, label, amount, color in ((SLIPPING, "slipping", shear, figure.COLORS[0]),
                                     (OPEN, "open", opening, figure.COLORS[1])):
        count = np.sum((status == code) & seen)
        largest = amount[(status == code) & seen].max(initial=0)
        chosen = status[of_contact] == code
        width = thin + (thick - thin) * np.minimum(1, amount[of_contact[chosen]] / (largest or 1))
        axes.add_collection(LineCollection(lines[chosen], color=color, linewidth=width, capstyle="round",
                                           zorder=code + 1))
        size = thick if largest > 0 else thin
        kind = "shear displacement" if code == SLIPPING else "opening"
        of_width = f"; this width: {kind} {length_text(largest)} since the in-situ state, thinnest: 0" if largest > 0 else \
            f"; no {kind} since the in-situ state" if count else ""
        entry = matplotlib.lines.Line2D([], [], color=color, linewidth=size, label=f"{count} {label}{of_width}")
        if code == OPEN:  # two walls with a gap between them, in grey print too
            axes.add_collection(LineCollection(lines[chosen], color="w", linewidth=0.45 * width, capstyle="round",
                                               zorder=code + 1.5))
            with_gap(entry, size, color)
        entries.append(entry)
    return entries + figure.draw_region_borders(figure.scene_of(file), axes)


def draw_blocks(section, of_block, axes, zorder, facecolor, **look):
    """Some blocks, filled: of_block says which of the present zones are theirs, as their block's number, and -1 of others. Returns a
    legend entry without a label."""
    chosen = of_block >= 0
    zones = section.zones[chosen]
    axes.add_collection(PolyCollection(section.position[zones], facecolor=facecolor, edgecolor=facecolor, linewidth=0.3, zorder=zorder))
    sides = np.concatenate([zones[:, pair] for pair in ((0, 1), (1, 2), (2, 0))])
    both, count = np.unique(np.column_stack([np.sort(sides, axis=1), np.tile(of_block[chosen], 3)]), axis=0, return_counts=True)
    outline = section.position[both[count == 1][:, :2]]
    axes.add_collection(LineCollection(outline, color=look["edgecolor"], linewidth=look["linewidth"], linestyle=look.get("linestyle", "-"),
                                       zorder=zorder + 0.5))
    return matplotlib.patches.Patch(facecolor=facecolor, **look)


def length_text(metres):
    """A length in m, or in mm if it is shorter than 1 m."""
    return f"{metres:.3g} m" if metres >= 1 else f"{1e3 * metres:.3g} mm"


def with_short_lengths(reason):
    """Why a run ended, with lengths as the legends have them. Places, "[x, y] m", stay."""
    return re.sub(r"(?<!\S)(\d+\.?\d*(?:e[+-]\d+)?) m\b", lambda found: length_text(float(found[1])), reason)


def reason_in_short(file):
    """Why a run ended, for a title. The legend has moving blocks, which need no reason, and the largest unbalanced force of a run that
    ended undecided."""
    reason = figure.texts(file, "/failure/reason")[0].removeprefix("no equilibrium: ")
    if figure.has_no_equilibrium(file) and figure.array(file, "/failure/moves_on")[0]:
        return ""
    undecided = re.match(r"(after \d+ steps) (the unbalanced force ratio is \S+?)[,;]", reason)
    return f"undecided: {undecided[1]} {undecided[2]}" if undecided else with_short_lengths(reason)


def draw_failure(file, section, axes, fills=""):
    """What happened after the last state of a run without equilibrium: rock that was excavated, and the moving blocks. Their
    arrows are in proportion to their motion; the fastest one's is as long as the moving blocks together, within 3 and 10 percent of
    the picture. fills: what the legend says of them in addition. Returns legend entries."""
    entries = []
    block = figure.array(file, "/mesh/zone_block")[section.there]
    stage = figure.texts(file, "/failure/stage")[0]
    number = figure.texts(file, "/names/stage").index(stage) if stage else -1
    excavated = np.where(figure.array(file, "/blocks/stage")[block] == number, block, -1) if stage else np.full(len(block), -1)
    if np.any(excavated >= 0):
        entries.append(draw_blocks(section, excavated, axes, 6, "white", edgecolor="0.25", linewidth=0.6, linestyle=(0, (4, 2))))
        entries[-1].set_label(f"excavated then: {stage}")

    moving, motion = figure.array(file, "/failure/block"), figure.array(file, "/failure/motion")
    of_moving = np.where(np.isin(block, moving), block, -1)
    if not np.any(of_moving >= 0):
        return entries
    entries.append(draw_blocks(section, of_moving, axes, 7, MOVING, edgecolor=figure.COLORS[1], linewidth=1.2))
    label = "blocks that moved most" if figure.array(file, "/failure/moves_on")[0] == 0 else "moving blocks"
    label = f"{len(moving)} {label if len(moving) > 1 else label.replace('blocks', 'block')}"
    area = figure.array(file, "/blocks/area")[moving]
    label += f", {area.sum():.3g} m2" + (" in all" if len(moving) > 1 else "")
    largest = np.linalg.norm(motion, axis=1).max()
    shift = (section.position - section.start)[section.zones].mean(axis=1)
    place = figure.array(file, "/failure/place") + [shift[block == one].mean(axis=0) if one in block else (0, 0) for one in moving]
    if largest > 0:
        size = max(np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim()))
        of_all = np.ptp(section.position[section.zones[of_moving >= 0]].reshape(-1, 2), axis=0).max()
        length = np.clip(of_all, 0.03 * size, 0.1 * size)
        axes.quiver(*place.T, *motion.T, angles="xy", scale_units="xy", scale=largest / length,
                    units="inches", width=0.024, headwidth=4, headlength=5, headaxislength=4.5, minlength=0.6, color=figure.COLORS[1],
                    edgecolor="white", linewidth=0.5, zorder=8)
        seconds, steps = figure.array(file, "/failure/seconds")[0], figure.array(file, "/failure/steps")[0]
        numbers = "with the numbers of the largest; " if len(moving) > 1 else ""
        label += f" ({numbers}red arrows, on a scale of their own; the longest, a block's mean, is {length_text(largest)} in " + (
            f"{seconds:.3g} s)" if seconds > 0 else f"{steps} steps of the solver)")
    name_blocks(axes, place, moving, area)
    entries[-1].set_label(label + fills)
    return entries


def name_blocks(axes, place, block, area, most=12):
    """The numbers of the largest blocks in the picture, each at its own place; a block that is too near to a larger one has none."""
    size = np.ptp([axes.get_xlim(), axes.get_ylim()], axis=1)
    seen = [one for one in np.argsort(-area, kind="stable") if figure.is_in(axes, place[one])]
    named = []
    for one in seen:
        if len(named) < most and all(np.abs((place[one] - other) / size).max() > 0.045 for other in named):
            named.append(place[one])
            axes.text(*place[one], str(block[one]), fontsize=6, ha="center", va="center", zorder=9, path_effects=figure.HALO,
                      clip_on=True)


def largest_unbalanced(file):
    """Place {x, y} of the largest unbalanced force of a run that ended without an answer, from the reason it gives; None if it gives none."""
    reason = figure.texts(file, "/failure/reason")[0] if "/failure" in file else ""
    found = re.search(r"largest unbalanced force is at \[(\S+), (\S+?)\] m", reason)
    return np.array([float(found[1]), float(found[2])]) if found else None


def draw_unbalanced(file, section, axes):
    """Marks that place, if no block is known to move. Returns legend entries."""
    place = largest_unbalanced(file)
    if place is None or len(figure.array(file, "/failure/block")):
        return []
    look = {"marker": "o", "markersize": 11, "markerfacecolor": "none", "markeredgecolor": figure.COLORS[1], "markeredgewidth": 1.4,
            "linestyle": "none", "label": "largest unbalanced force (no block is known to move)"}
    axes.plot(*place, zorder=8, **look)
    return [matplotlib.lines.Line2D([], [], **{**look, "markersize": 6})]


def window_of_failure(file, section):
    """The surroundings of the blocks that move in the end of a run without equilibrium, x0, y0, x1, y1 [m]; where none moves, of the largest
    unbalanced force. None if the blocks fill the section, or nothing is known."""
    block = figure.array(file, "/mesh/zone_block")[section.there]
    moving = np.isin(block, figure.array(file, "/failure/block")) if "/failure" in file else []
    if not np.any(moving):
        place, corners = largest_unbalanced(file), figure.array(file, "/mesh/gridpoint_position")
        if place is None:
            return None
        low, high = corners.min(axis=0), corners.max(axis=0)
        half = ROUND_A_FORCE / 2 * np.max(high - low)
        return [*np.maximum(low, place - half), *np.minimum(high, place + half)]
    return enlarged(section.position[section.zones[moving]].reshape(-1, 2), section.position)


def draw(file, state="last", field="displacement", component="major", since_reset=False, window=None, around_failure=False, magnify=0,
         limits=None):
    """Figure of one state: field "displacement", "stress" or "contacts". state: plain words for a stage, or "last"; component of
    the stress; window: x0, y0, x1, y1 [m]; around_failure: the surroundings of moving blocks, not together with window;
    limits: low, high of the colour scale."""
    if figure.file_type(file) not in ("jointcreep result", "jointcreep checkpoint"):
        raise figure.NotWanted("there are no states in this file; demsolve makes one that has them")
    state = state_index(file, state)
    fills = ""
    if around_failure:
        if window:
            raise figure.NotWanted("--window and --around-failure both choose a part of the section; expected one of them")
        window = window_of_failure(file, Section(file, state, magnify))
        if window is None and "/failure" in file and len(figure.array(file, "/failure/block")):
            fills = "; these fill most of the section"
    section = Section(file, state, magnify, window, since_reset)
    plot, axes = figure.section_axes(section.start, window)
    plot.cuts_margins = True  # scales and legends leave margins of different widths
    plot.set_figheight(plot.get_figheight() + 0.2)  # for the title
    if field == "displacement":
        entries = draw_displacement(file, state, section, axes, since_reset, limits)
    elif field == "stress":
        entries = draw_stress(file, state, section, axes, component, limits)
    else:
        entries = draw_contacts(file, state, section, axes)
    time, ending = figure.array(file, "/states/time"), figure.ending_of(file)
    is_end = bool(ending) and state == len(time) - 1
    title, stages = name_of(file, state), [name for name in figure.texts(file, "/states/event")[:state + 1] if name]
    is_last = state == len(time) - 1
    if is_last and not is_end:
        title += " (end)" if figure.texts(file, "/states/event")[state] else f", end{', after ' + stages[-1] if stages else ''}"
    if is_end:
        day = figure.day_of(file, time[state])
        title = f"{day}, {'after ' + stages[-1] if stages else 'before the first stage'}"
        ending = ending.removesuffix(f" on {day}")  # which the title has already
    if ending:
        title += f"; {ending}"
    if is_last and figure.creep_of(file):
        title += f"; {figure.creep_of(file)}"
    if magnify:
        title += "; positions displaced" + (f" {magnify:g} times" if magnify != 1 else "")
    if file.attrs["realization"]:
        title += f"; realization {file.attrs['realization']} of the network"
    factor = figure.strength_factor_of(file)
    title = f"Strengths / {factor:.4g}: {title}" if factor != 1 else title
    plot.says_factor = True
    if is_end:
        entries += draw_failure(file, section, axes, fills) + draw_unbalanced(file, section, axes)
        title += f"\n{reason_in_short(file)}".rstrip()
    lines = [part for line in title.splitlines() for part in figure.wrapped(line, int(15 * plot.get_figwidth()))]
    plot.set_figheight(plot.get_figheight() + 0.13 * (len(lines) - 1))
    if getattr(axes, "has_key", False):
        plot.set_figheight(plot.get_figheight() + 0.15)
    axes.set_title("\n".join(lines), loc="left", pad=17 if getattr(axes, "has_key", False) else None)
    if entries:
        figure.legend_below(axes, entries)
    return plot


if __name__ == "__main__":
    figure.run(draw, figure.arguments_of(
        __doc__,
        (["--state"], {"default": "last", "help": "default: last"}),
        (["--field"], {"choices": ["displacement", "stress", "contacts"], "default": "displacement",
                       "help": "default: displacement"}),
        (["--component"], {"choices": list(COMPONENTS), "default": "major",
                           "help": "of the stress, compression positive: major is the larger compression, minor the smaller one "
                                   "(both with crosses along their directions), mean, xx, yy; default: major"}),
        (["--since-reset"], {"action": "store_true", "help": "displacements since the last stage that resets them"}),
        figure.WINDOW,
        (["--around-failure"], {"action": "store_true",
                                "help": "draw the surroundings of the moving blocks of a run without equilibrium; "
                                        "of the largest unbalanced force if none is known to move"}),
        (["--magnify"], {"type": float, "default": 0, "metavar": "TIMES",
                         "help": "draw the rock displaced so many times; default: 0"}),
        (["--range"], {"dest": "limits", "nargs": 2, "type": float, "metavar": ("LOW", "HIGH"),
                       "help": "of the colour scale, in its unit, for pictures to compare; default: what is there"}),
    ))
