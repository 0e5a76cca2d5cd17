"""Joint sets for the plots: their laws in the scene, and what of their joints lies in the section."""

import matplotlib.path
import numpy as np

import figure

PIECE_STEP = 2**25  # a region cuts a line into pieces: /joints/number is line + piece * this


class Joints:
    """The joints of a network file, and the sets they belong to."""

    def __init__(self, file):
        self.scene = figure.scene_of(file)
        self.outline = np.array(self.scene["section"]["outline_m"], float)
        self.sets = self.scene.get("joint_set", [])
        self.names = figure.texts(file, "/names/joint_set")
        self.set = figure.array(file, "/joints/set")
        number = figure.array(file, "/joints/number").astype(np.int64)
        self.line = (number + PIECE_STEP // 2) % PIECE_STEP - PIECE_STEP // 2
        self.ends = np.stack([figure.array(file, "/joints/from"), figure.array(file, "/joints/to")], axis=1)
        self.pole = figure.array(file, "/joints/pole")
        self.point = figure.array(file, "/joints/point")
        self.trace_joint = figure.array(file, "/traces/joint")
        self.traces = np.stack([figure.array(file, "/traces/from"), figure.array(file, "/traces/to")], axis=1)

    def windows(self, i):
        """The polygons in which a set is looked at: the outline, and its region if it has one."""
        polygons = [self.outline]
        if i < len(self.sets) and "region_m" in self.sets[i]:
            polygons.append(np.array(self.sets[i]["region_m"], float))
        return polygons


def stretches(polygon, begin, end):
    """Where the line from `begin` to `end` is inside a polygon: pairs of distances from `begin` (m)."""
    along = (end - begin) / np.linalg.norm(end - begin)
    offset = polygon - begin
    side = along[0] * offset[:, 1] - along[1] * offset[:, 0]
    following, after = np.roll(offset, -1, axis=0), np.roll(side, -1)
    cut = (side < 0) != (after < 0)
    share = side[cut] / (side[cut] - after[cut])
    at = np.sort((offset[cut] + share[:, None] * (following[cut] - offset[cut])) @ along)
    return [(low, high) for low, high in at.reshape(-1, 2)]


def inside(polygons, begin, end):
    """The same for several polygons at once, between the two ends."""
    parts = [(0.0, np.linalg.norm(end - begin))]
    for polygon in polygons:
        parts = [(max(a, low), min(b, high)) for a, b in parts for low, high in stretches(polygon, begin, end)]
        parts = [(low, high) for low, high in parts if low < high]
    return parts


def mean_plane(joint_set):
    """Dip and dip direction of the mean plane (rad), or None for a set that is given by its trace angle."""
    if "orientation" in joint_set:
        law = joint_set["orientation"]
        if "mean_dip_deg" not in law:
            return None
        return np.radians([law["mean_dip_deg"], law["mean_dip_direction_deg"]])
    if "dip" in joint_set:
        return np.radians([joint_set["dip"]["mean_deg"], joint_set["dip_direction"]["mean_deg"]])
    return None


def mean_normal(joint_set, scene):
    """The part in the section of the mean plane's unit normal, {x, y}."""
    if "trace_angle" in joint_set:
        angle = np.radians(joint_set["trace_angle"]["mean_deg"])
        return np.array([-np.sin(angle), np.cos(angle)])
    plane = mean_plane(joint_set)
    if plane is None:
        return None
    azimuth = np.radians(scene["section"]["azimuth_deg"])
    return np.array([np.sin(plane[0]) * np.cos(plane[1] - azimuth), np.cos(plane[0])])


def density(law, x):
    """Density (1/m) of a law of lengths or spacings at x > 0 (m), or None for a constant one."""
    kind = law["law"]
    if kind == "negative exponential":
        return np.exp(-x / law["mean_m"]) / law["mean_m"]
    if kind in ("normal", "lognormal"):
        mean, deviation = law["mean_m"], law["deviation_m"]
        if kind == "normal":
            bell = np.exp(-((x - mean) / deviation) ** 2 / 2)
            return bell / np.trapz(bell, x) if np.any(bell) else bell  # x covers all of it; cut off at 0
        variance = np.log1p((deviation / mean) ** 2)
        z = (np.log(x) - np.log(mean) + variance / 2) / np.sqrt(variance)
        return np.exp(-z**2 / 2) / (x * np.sqrt(2 * np.pi * variance))
    if kind in ("uniform", "power"):
        low, high = law["shortest_m"], law["longest_m"]
        between = (x >= low) & (x <= high)
        if kind == "uniform":
            return between / (high - low)
        q = 1 - law["exponent"]
        total = np.log(high / low) if q == 0 else (high**q - low**q) / q
        return np.where(between, x ** -law["exponent"], 0) / total
    return None


def jointed(file):
    """Which blocks are those between joints: not those that have parts of the border of a region of joint sets (region_m), which belong to
    the rock without joints around it; all, if the sets have no regions or nothing else is left."""
    sets = figure.scene_of(file).get("joint_set", [])
    if not sets or any("region_m" not in one for one in sets):
        return np.ones(len(figure.array(file, "/blocks/area")), bool)
    first, corner = figure.array(file, "/blocks/first_ring"), figure.array(file, "/rings/first_corner")
    position, vertex = figure.array(file, "/vertices/position"), figure.array(file, "/rings/vertex")
    paths = [matplotlib.path.Path(corners) for corners in {tuple(map(tuple, one["region_m"])) for one in sets}]
    small = 1e-6 * np.max(np.ptp(position, axis=0))
    of_vertex = np.any([path.contains_points(position, radius=small) | path.contains_points(position, radius=-small) for path in paths], axis=0)
    inside = np.array([of_vertex[vertex[corner[begin]:corner[end]]].all() for begin, end in zip(first[:-1], first[1:])])
    return inside if inside.any() else ~inside
