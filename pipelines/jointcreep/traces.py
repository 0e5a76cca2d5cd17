"""Joint traces as a window shows them: what of each is inside, and which ends the window's edge cuts.

A trace is the straight line from its first place to its last. A length that the edge cuts is censored: the trace is longer than what is
seen. So is one whose end comes as near to the edge as the mapping is exact. Coordinates are metres of the section.
"""

import csv
import io
import pathlib
import subprocess
import tomllib

import numpy as np

from .errors import NotWanted

LEAST_EDGE = 1e-6  # of the window's size: an end nearer to the edge is at it


class Window:
    """A convex polygon, by its corners in order [m]."""

    def __init__(self, corners):
        corners = np.array(corners, float)
        after = np.roll(corners, -1, axis=0)
        twice = (corners[:, 0] * after[:, 1] - corners[:, 1] * after[:, 0]).sum()
        if twice < 0:
            corners, after = corners[::-1], np.roll(corners[::-1], -1, axis=0)
        self.corners, self.area = corners, abs(twice) / 2  # counter-clockwise; [m2]
        self.size = np.linalg.norm(corners.max(axis=0) - corners.min(axis=0))
        sides = after - corners
        turns = sides[:, 0] * np.roll(sides, -1, axis=0)[:, 1] - sides[:, 1] * np.roll(sides, -1, axis=0)[:, 0]
        if self.area <= 1e-9 * self.size**2 or (turns < -1e-9 * self.size**2).any():
            raise NotWanted("the window is not convex, or has no area; expected a convex one: give one inside it by --window")
        lengths = np.linalg.norm(sides, axis=1)
        sides, self.corner = sides[lengths > 0] / lengths[lengths > 0, None], corners[lengths > 0]
        self.inward = np.column_stack([-sides[:, 1], sides[:, 0]])  # unit normals of the sides

    def stretches(self, start, along):
        """Of lines start + s along, the s at which they enter and leave; they miss the window where that is not the order."""
        depth = ((start[:, None, :] - self.corner) * self.inward).sum(axis=2)  # [line, side]
        rate = along @ self.inward.T
        with np.errstate(divide="ignore", invalid="ignore"):
            at = -depth / rate
        enter = np.where(rate > 0, at, np.where((rate == 0) & (depth < 0), np.inf, -np.inf)).max(axis=1)
        leave = np.where(rate < 0, at, np.inf).min(axis=1)
        return enter, leave

    def depth(self, places):
        """Distance from the nearest side, inside [m]."""
        return ((places[:, None, :] - self.corner) * self.inward).sum(axis=2).min(axis=1)

    def chords(self, direction, shortest):
        """Of all lines in a direction: the integral of what their chords have beyond `shortest` [m2], and the width in which
        they have that much [m]. Without a shortest: area and width of the window."""
        across = np.array([-direction[1], direction[0]])
        offsets = np.unique(self.corners @ across)
        start = offsets[:, None] * across
        enter, leave = self.stretches(start, np.tile(direction, (len(offsets), 1)))
        beyond = np.maximum(leave - enter, 0.0) - shortest
        # A chord of the lowest or highest corner may be a side or nothing: it is the limit from inside.
        inside = offsets[[0, -1]] + [1e-9 * self.size, -1e-9 * self.size]
        enter, leave = self.stretches(inside[:, None] * across, np.tile(direction, (2, 1)))
        beyond[[0, -1]] = leave - enter - shortest
        area = width = 0.0
        for step, a, b in zip(np.diff(offsets), beyond[:-1], beyond[1:]):  # chords are linear between corners
            if a <= 0 and b <= 0:
                continue
            share = 1.0 if min(a, b) >= 0 else max(a, b) / abs(a - b)
            width += share * step
            area += share * step * (max(a, 0) + max(b, 0)) / 2
        return area, width


class Seen:
    """The traces that a window shows, a row each."""

    def __init__(self, window, start, end, edge=0.0, shortest=0.0):
        along = end - start
        length = np.linalg.norm(along, axis=1)
        some = length > 0
        start, end, along = start[some], end[some], along[some] / length[some, None]
        turned = along[:, 0] < 0
        start[turned], end[turned], along[turned] = end[turned], start[turned], -along[turned]
        length = length[some]
        enter, leave = window.stretches(start, along)
        low, high = np.maximum(enter, 0), np.minimum(leave, length)
        edge = max(edge, LEAST_EDGE * window.size)
        met = high - low > max(shortest, LEAST_EDGE * window.size)
        start, along, length, enter, leave, low, high = (
            values[met] for values in (start, along, length, enter, leave, low, high))
        self.window, self.shortest = window, shortest
        self.along, self.length = along, high - low  # [m], as seen
        first, last = start + low[:, None] * along, start + high[:, None] * along
        self.cut = np.column_stack([(low > 0) | (window.depth(first) < edge),
                                    (high < length) | (window.depth(last) < edge)])  # at its first end, at its last
        self.cut_ends = self.cut.sum(axis=1)
        self.room = leave - low  # from the first end along the trace to the window's edge [m]
        self.angle = np.degrees(np.arctan2(along[:, 1], along[:, 0]))  # in (-90, 90]
        # of lines like each trace, for its chance to be met
        chords = np.array([window.chords(direction, shortest) for direction in along]).reshape(-1, 2)
        self.chord_area, self.chord_width = chords.T

    def __len__(self):
        return len(self.length)

    def part(self, rows):
        """Some of the rows."""
        some = object.__new__(Seen)
        some.window, some.shortest = self.window, self.shortest
        for name in ("along", "length", "cut", "cut_ends", "room", "angle", "chord_area", "chord_width"):
            setattr(some, name, getattr(self, name)[rows])
        return some


def window_of(text):
    """The window that --window names: corners x1,y1,x2,y2,.. (two are those of a rectangle), or a scene file's outline."""
    try:
        numbers = [float(word) for word in text.split(",")]
    except ValueError:
        return Window(outline_of(pathlib.Path(text)))
    if len(numbers) < 4 or len(numbers) % 2 or not np.isfinite(numbers).all():
        raise NotWanted(f'--window is "{text}"; expected x1,y1,x2,y2, or three corners or more, in metres')
    corners = np.reshape(numbers, (-1, 2))
    if len(corners) == 2:
        (a, b), (c, d) = corners
        corners = [(a, b), (c, b), (c, d), (a, d)]
    return Window(corners)


def outline_of(path):
    """The outline of a scene."""
    try:
        scene = tomllib.loads(path.read_text("utf-8-sig"))
        return np.array(scene["section"]["outline_m"], float).reshape(-1, 2)
    except OSError as error:
        raise NotWanted(f"--window is \"{path}\": {error.strerror}; expected x1,y1,x2,y2 in metres, or a scene file") from None
    except (ValueError, KeyError, TypeError):
        raise NotWanted(f"--window: {path} has no [section] outline_m; expected a scene file") from None


def read(path, programs, layer=None, by=None):
    """The traces of a file by the values of their property `by`: {value: (first places, last places)}, one entry "" without
    it. jointgen reads and checks the file, as it does those of [[mapped]]. Parts of one line are traces of their own."""
    command = [programs / "jointgen", path, "--traces"]
    command += ["--layer", layer] if layer else []
    command += ["--property", by] if by else []
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode != 0:
        raise NotWanted(done.stderr.strip().removeprefix("jointgen: "))
    parts = {}
    for row in csv.DictReader(io.StringIO(done.stdout)):
        parts.setdefault((row["value"], row["id"], row["part"]), []).append((float(row["x_m"]), float(row["y_m"])))
    sets = {}
    for (value, _, _), places in parts.items():
        sets.setdefault(value, []).append((places[0], places[-1]))
    return {value: tuple(np.array(ends).reshape(-1, 2, 2).transpose(1, 0, 2)) for value, ends in sets.items()}
