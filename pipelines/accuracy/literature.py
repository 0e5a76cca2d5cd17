#!/usr/bin/python3
"""Problems of the literature: what whole programs compute of them, beside closed forms.

    literature.py PROGRAMS DATA OUT

Writes the tables literature.md and cantilever.md into OUT/tables, for the page docs/verification.md. Each problem is a
function that runs its scene of data/verification and gives Rows: a figure by closed form, the same computed, and the
error that is to be expected, with its reason. Each is run by the implicit engine and by dynamic relaxation, where both mean something.
tests/pipeline/literature_test.py holds each row to its error.
"""

import math
import re
import subprocess
import sys
import tempfile
import tomllib
from dataclasses import dataclass, replace
from pathlib import Path

import closed_forms
import numpy as np

import figure
from jointcreep import chain


@dataclass
class Row:
    problem: str
    what: str
    unit: str
    exact: float
    computed: float | tuple[float, float]  # or the two ends of a bracket
    allowed: float  # error that is expected, over `scale`
    why: str  # it is
    scale: float = math.nan  # what the error is relative to; by default the exact figure
    engine: str = ""

    @property
    def error(self):
        """Of a bracket, that of the worse end."""
        off = np.abs(np.atleast_1d(self.computed) - self.exact).max()
        return off / abs(self.exact if math.isnan(self.scale) else self.scale)


BALANCE = "equilibria within 1e-6"  # of the mean force on a gridpoint; a few times that is left in single ones


class Programs:
    """The chain, run on scenes of data/verification."""

    def __init__(self, programs, data, folder, engine="auto"):
        self.programs, self.data, self.folder = Path(programs), Path(data), Path(folder)
        self.engine = engine

    def by(self, engine):
        return Programs(self.programs, self.data, self.folder, engine)

    def text(self, name):
        return (self.data / "verification" / name / "scene.toml").read_text()

    def joints(self, text):
        """Path of the joints file of a scene, in a folder of its own."""
        return chain.joints_of(self.programs, text, Path(tempfile.mkdtemp(dir=self.folder)))

    def solved(self, joints, *options):
        """Path of the result, and of what is left where there is none; exit code and message of demsolve."""
        done = subprocess.run([self.programs / "demsolve", "joints.h5", "-q", "-o", "result.h5", "--engine", self.engine,
                               *map(str, options)], cwd=joints.parent, capture_output=True, text=True)
        return joints.with_name("result.h5" if done.returncode == 0 else "result.failed.h5"), done.returncode, done.stderr

    def answer(self, text, *options):
        """The same of a scene."""
        return self.solved(self.joints(text), *options)

    def result(self, text, *options):
        path, code, message = self.answer(text, *options)
        if code != 0:
            raise RuntimeError(f"demsolve ended with exit code {code}: {message}")
        return Result(path)


class Result:
    """The datasets of a result file, read when asked for."""

    def __init__(self, path):
        with figure.opened(path) as file:
            self.values = {}
            file.visititems(lambda name, item: self.values.update({"/" + name: item[()]})
                            if hasattr(item, "shape") else None)
            self.scene = tomllib.loads(figure.text_of(file["/scene"][0]))
            self.joints = [joint["name"] for joint in self.scene.get("joint", [])]

    def __getitem__(self, name):
        return self.values[name]

    def point(self, name, row=-1):
        """Displacement {x, y} of a point [m]."""
        names = [point["name"] for point in self.scene["point"]]
        return self["/history/displacement"][row, names.index(name)]

    def state_at(self, day):
        return int(np.flatnonzero(self["/states/time"] == day)[-1])

    def contacts_of(self, joint):
        return self["/edges/joint"][self["/mesh/contact_edge"]] == self.joints.index(joint)

    def force(self, contacts, state=-1):
        """What side a of these contacts is pulled with, {x, y} [N/m]."""
        normal = self["/mesh/contact_normal"][contacts]
        tangent = np.stack([normal[:, 1], -normal[:, 0]], axis=1)
        traction = self["/states/traction"][state][contacts]
        return (self["/mesh/contact_length"][contacts, None]
                * (traction[:, :1] * normal + traction[:, 1:] * tangent)).sum(axis=0)

    def zone_areas(self):
        a, b, c = np.moveaxis(self["/mesh/gridpoint_position"][self["/mesh/zone_gridpoint"]], 1, 0)
        (x, y), (u, v) = (b - a).T, (c - a).T
        return (x * v - y * u) / 2

    def mean_stress(self, state=-1):
        """{xx, yy, xy} over all of the section [Pa]."""
        area = self.zone_areas()
        return area @ self["/states/stress"][state] / area.sum()


def changed(text, pattern, replacement, count=1):
    new, found = re.subn(pattern, replacement, text, flags=re.MULTILINE)
    if found != count:
        raise ValueError(f"{pattern!r} is found {found} times, not {count} times")
    return new


def material_of(scene, name):
    """K_n, K_s, cohesion, friction angle."""
    m = next(m for m in scene["joint_material"] if m["name"] == name)
    return (m["normal_stiffness_MPa_per_m"] * 1e6, m["shear_stiffness_MPa_per_m"] * 1e6, m["cohesion_MPa"] * 1e6,
            math.radians(m["friction_angle_deg"]))


def elastic_of(scene):
    rock = scene["rock"][0]
    return rock["youngs_modulus_GPa"] * 1e9, rock["poissons_ratio"]


# Kirsch


def hole_scene(text, size, uniaxial):
    """With zones of this size about the hole, and as many sides of the polygon as fit."""
    sides = round(1.6 / size)  # of a quarter; those of the scene are 16, zones 0.1
    corners = [[round(math.cos(i * math.pi / 2 / sides), 9), round(math.sin(i * math.pi / 2 / sides), 9)]
               for i in range(sides + 1)]
    text = re.sub(r"(?s)remove_m = .*?\]\]\]", f"remove_m = [{[[0, 0], *corners]}]", text)
    text = changed(text, "^size_m = .*", f"size_m = {size}")
    if uniaxial:
        text = changed(text, "^compression_yy_MPa = 10", "compression_yy_MPa = 0")
        text = changed(text, r"^traction_MPa = \[0, -10\]", "traction_MPa = [0, 0]")
    return text


@dataclass
class HoleErrors:
    size: float
    displacement: float  # root of the mean square at the wall, over the largest
    stress: float  # around the hole, root of the mean square within 3 radii, over the pressure
    wall: float  # mean displacement of the wall inward [m]
    peak: float  # compression in the roof, extrapolated to the wall, over the pressure


def hole_errors(programs, size, uniaxial):
    result = programs.result(hole_scene(programs.text("hole"), size, uniaxial))
    young, nu = elastic_of(result.scene)
    pressure = (10e6, 0 if uniaxial else 10e6)
    there = result["/states/zone_present"][-1] != 0
    zones = result["/mesh/zone_gridpoint"][there]
    position, moved = result["/mesh/gridpoint_position"], result["/states/displacement"][-1]
    wall = np.intersect1d(np.unique(zones), np.flatnonzero(abs(np.hypot(*position.T) - 1) < 1e-6))
    exact = closed_forms.kirsch_displacement(position[wall], pressure, young, nu)
    apart = np.linalg.norm(moved[wall] - exact, axis=1)
    centre = position[zones].mean(axis=1)
    near = np.hypot(*centre.T) < 3
    stress, area = result["/states/stress"][-1][there][near], result.zone_areas()[there][near]
    angle = np.arctan2(centre[near, 1], centre[near, 0])
    c, s = np.cos(angle), np.sin(angle)
    hoop = -(stress[:, 0] * s**2 + stress[:, 1] * c**2 - 2 * stress[:, 2] * s * c)
    off = hoop - closed_forms.kirsch_hoop(centre[near], pressure)
    # The roof: zones within 10 degrees of it and 1.5 radii; what they are off by, as a straight line in the radius.
    roof = (angle > math.radians(80)) & (np.hypot(*centre[near].T) < 1.5)
    off_at_wall = np.polyval(np.polyfit(np.hypot(*centre[near][roof].T) - 1, off[roof], 1), 0)
    at_roof = closed_forms.kirsch_hoop(np.array([[0.0, 1.0]]), pressure)[0]
    return HoleErrors(size, math.sqrt((apart**2).mean()) / np.linalg.norm(exact, axis=1).max(),
                      math.sqrt(area @ off**2 / area.sum()) / pressure[0],
                      -(moved[wall] * position[wall]).sum(axis=1).mean(), (at_roof + off_at_wall) / pressure[0])


HOLE_SIZES = [0.2, 0.1, 0.05]


def kirsch(programs):
    name = "hole in a plate (Kirsch 1898)"
    found = {uniaxial: [hole_errors(programs, size, uniaxial) for size in HOLE_SIZES] for uniaxial in (False, True)}

    def order(errors, what):
        first, last = getattr(errors[0], what), getattr(errors[-1], what)
        return math.log2(first / last) / math.log2(errors[0].size / errors[-1].size)

    all_round, along_x = found[False], found[True]
    return [
        Row(name, "inward displacement of the wall, pressure from all sides, zones of 0.05 a", "mm", 1.25, all_round[-1].wall * 1e3,
            0.0025, "second order in zones: (0.05 a)^2, and the plate's end"),
        Row(name, "compression in the roof over the pressure, pressure along x", "1", 3, along_x[-1].peak,
            0.05, "first order in zones: 0.05 a"),
        Row(name, "order of displacements, pressure from all sides", "1", 2, order(all_round, "displacement"), 0.15,
            "second: corners on the circle"),
        Row(name, "order of displacements, pressure along x", "1", 2, order(along_x, "displacement"), 0.15, "second"),
        Row(name, "order of stresses, pressure along x", "1", 1, order(along_x, "stress"), 0.2,
            "constant-strain zones: first"),
    ]


# The price of the element


CANTILEVER_SIZES = [1, 0.5, 0.25, 0.125, 0.0625]
QUADRATIC_SIZES = CANTILEVER_SIZES[:4]


@dataclass
class Cantilever:
    kind: str  # of zones
    size: float
    gridpoints: int
    zones: int
    share: float  # of the exact deflection


def cantilevers(programs, kind="constant strain", sizes=tuple(CANTILEVER_SIZES)):
    found = []
    for size in sizes:
        result = programs.result(changed(programs.text("cantilever"), '^kind = "constant strain"\nsize_m = 0.25',
                                         f'kind = "{kind}"\nsize_m = {size}'))
        exact = closed_forms.cantilever_deflection(10, 1, 0.01e6, *elastic_of(result.scene))
        found.append(Cantilever(kind, size, len(result["/mesh/gridpoint_position"]), len(result["/mesh/zone_block"]),
                                -result.point("tip")[1] / exact))
    return found


def cantilevers_of_both_kinds(programs):
    return cantilevers(programs) + cantilevers(programs, "quadratic", QUADRATIC_SIZES)


def cantilever(programs):
    return cantilever_rows(cantilevers(programs))


def cantilever_rows(found):
    name = "cantilever (Timoshenko)"
    last, before = found[-1].share, found[-2].share
    return [
        Row(name, "deflection of the tip over the closed form, zones extrapolated to 0 from h/8 and h/16", "1", 1,
            last + (last - before) / 3, 0.01, "the clamped end, of the order (h / L)^2 = 0.01"),
        Row(name, "order in zones, from h/4 to h/16", "1", 2,
            math.log2((before - found[-3].share) / (last - before)), 0.25,
            "second; meshes are not each other's halves"),
    ]


# Jaeger


def weakness_scene(text, dip):
    """With the joint at another dip [degrees]; at 0 it is level."""
    half = math.tan(math.radians(dip)) / 2
    text = text.replace("[1, 2.866025404]", f"[1, {2 + half:.9f}]")
    return text.replace("[0, 1.133974596]", f"[0, {2 - half:.9f}]")


def weakness(programs):
    rows = []
    for dip in 0, 20, 30, 45, 60, 75:
        text = weakness_scene(programs.text("plane-of-weakness"), dip)
        increments = 50
        if programs.engine == "relaxation":
            increments = 1000 if dip < 30 else 400
            text = changed(text, "^unloading_increments = 50", f"unloading_increments = {increments}")
        result = programs.result(text)
        rock = result.scene["rock"][0]
        strength, fails = closed_forms.plane_of_weakness(
            math.radians(dip), 1e6, material_of(result.scene, "joint")[2:],
            (rock["cohesion_MPa"] * 1e6, math.radians(rock["friction_angle_deg"])))
        # Dynamic relaxation of rock that yields overshoots: method, section 4. A joint slips in exact proportion.
        overshoot = 4e-3, f"overshoot of rock that yields, in {increments} increments"
        allowed, why = overshoot if fails == "rock" and programs.engine == "relaxation" else (2e-5, BALANCE)
        rows.append(Row("plane of weakness (Jaeger 1960)", f"axial strength, joint at {dip} degrees ({fails} fails)",
                        "MPa", strength / 1e6, -result.mean_stress()[1] / 1e6, allowed, why))
    return rows


# Crawford and Bray


def wedge_given(scene):
    k_n, k_s, _, phi = material_of(scene, "joint")
    return 1e6, 4.0, math.radians(30), k_n, k_s, phi


def roof_wedge(programs):
    name = "roof wedge (Crawford and Bray 1983)"
    text, soft = programs.text("roof-wedge"), "rock is 1e5 times stiffer than joints"
    if programs.engine == "relaxation":
        text, soft = text + "\n[equilibrium]\nunloading_increments = 300\n", f"{soft}; 300 increments between readings"
    result = programs.result(text)
    given = wedge_given(result.scene)
    limit, reached = closed_forms.roof_wedge_limit(*given)
    load_history = result.scene["boundary"][-1]["load_history"]
    sides = result.contacts_of("left") | result.contacts_of("right")
    # Its normals point from side a to side b: the wedge is side a where they point away from its middle.
    outward = ((result["/mesh/contact_centre"] - [0, 1]) * result["/mesh/contact_normal"]).sum(axis=1) > 0
    rows = []
    for day, factor in load_history[1:]:
        state = result.state_at(day)
        held = result.force(sides & outward, state)[1] - result.force(sides & ~outward, state)[1]
        rows.append(Row(name, f"force that moves the wedge {factor:g} mm down", "MN/m",
                        closed_forms.roof_wedge(factor * 1e-3, *given) / 1e6, held / 1e6, 2e-4, soft, limit / 1e6))
    pressure = limit / (2 * 4 * math.tan(given[2]))
    ends = bracket(limit / 1e6, 1e-3, lambda force: stands(programs, wedge_loaded(
        programs.text("roof-wedge"), pressure * force * 1e6 / limit)))
    rows.append(Row(name, f"the largest load, at {reached * 1e3:.3f} mm: stable, and not stable", "MN/m",
                    limit / 1e6, ends, 1.001e-3, "checked 0.1 percent on both sides"))
    return rows


def wedge_loaded(text, pressure):
    return changed(text, r'^fix = "xy"\ndisplacement_mm.*\nload_history.*',
                   f"traction_MPa = [0, {-pressure / 1e6:.12g}]\nload_history = [[0, 0], [50, 1]]")


def stands(programs, text, *options):
    _, code, message = programs.answer(text, *options)
    if code not in (0, 3):
        raise RuntimeError(f"demsolve ended with exit code {code}: {message}")
    return code == 0


def bracket(limit, width, holds_at):
    """The figures this share below the limit and above it; not a number in place of one that does not end as the limit
    says."""
    low, high = limit * (1 - width), limit * (1 + width)
    return low if holds_at(low) else math.nan, high if not holds_at(high) else math.nan


# Goodman and Bray


HEIGHTS = [4.0 * n for n in range(1, 11)] + [40 - 6.0 * n for n in range(1, 7)]


def columns_given(tan_phi):
    return HEIGHTS, 10, 5, 9, 25e3, math.radians(30), tan_phi


def toppling(programs):
    name = "toppling columns (Goodman and Bray 1976)"
    rows, toes = [], {}
    for tan_phi in 0.65, 0.75, 0.77, 0.78:
        text = changed(programs.text("toppling-columns"), "^friction_angle_deg = 33.*",
                       f"friction_angle_deg = {math.degrees(math.atan(tan_phi)):.12g}")
        result = programs.result(text)
        forces, toe, sliding = closed_forms.toppling_columns(*columns_given(tan_phi))
        along, most = np.array([math.cos(math.pi / 6), math.sin(math.pi / 6)]), max(forces)
        toes[tan_phi] = abs(result.force(result.contacts_of("toe")) @ along)
        why = "equilibria within 1e-6, passed through 16 columns"
        rows.append(Row(name, f"force on the toe, tan(phi) = {tan_phi}", "MN/m", toe / 1e6, toes[tan_phi] / 1e6, 1e-4,
                        why, most / 1e6))
        computed = [abs(result.force(result.contacts_of(f"side {i + 1}")) @ along) for i in range(15)]
        off = max(abs(computed[i] - forces[i]) for i in range(sliding, 15)) / most
        rows.append(Row(name, f"forces between columns that topple, tan(phi) = {tan_phi}: largest difference, over the "
                        "largest force", "1", 0, off, 1e-4, why, 1))
    # From 0.784 on columns stop behind a toe that moves away: more than one distribution of friction is in equilibrium.
    last = list(toes.items())[1:]
    parabola = np.polyfit([force for _, force in last], [tan_phi for tan_phi, _ in last], 2)
    rows.append(Row(name, "tan(phi) with which the toe needs no force (published: 0.7855)", "1", columns_limit(),
                    parabola[-1], 1e-4, "the last three forces, extrapolated by 0.0055 as a parabola"))
    return rows


def columns_alone(text):
    """The scene without the block at the toe."""
    text = changed(text, r",\s*\[-5\.464101615,\s*1\.464101615\],\s*\[-3\.464101615,\s*-2\.0\]\]\nrock", "]\nrock")
    for table in (r"\[\[region\]\]", r'\[\[rock\]\]\nname = "toe"', r'\[\[joint_material\]\]\nname = "smooth"',
                  r'\[\[joint\]\]\nname = "toe"', r"\[\[boundary\]\]\nfrom_m = \[-3"):
        text = changed(text, rf"(?s)^{table}.*?(?=^\[)", "")
    return text


def least_friction_in_balance(text, width):
    """A bracket of the least tan(phi) with which some forces between columns and base, within friction, balance all
    weights: without any law of how contacts give way."""
    scene = tomllib.loads(text)
    low, high = 0.5, 0.8
    while high - low > width:
        middle = (low + high) / 2
        low, high = (low, middle) if columns_can_stand(scene, middle) else (middle, high)
    return low, high


def columns_can_stand(scene, tan_phi):
    """Forces at the ends of each joint and of each column's base are sums of the two edges of the friction cone, none
    negative."""
    up, along = np.array([-0.5, math.sqrt(0.75)]), np.array([math.sqrt(0.75), 0.5])
    bases = [np.array([held["from_m"], held["to_m"]]) for held in scene["boundary"]]
    sides = [np.array([joint["from_m"], joint["to_m"]]) for joint in scene["joint"]]
    centres = [ends.mean(axis=0) + up * height / 2 for ends, height in zip(bases, HEIGHTS, strict=True)]
    weights = np.zeros((len(centres), 3))  # {x, y, moment}, over the unit weight
    weights[:, 1] = [10 * height for height in HEIGHTS]
    pushes = [(place, up, {i: 1}) for i, ends in enumerate(bases) for place in ends]
    pushes += [(place, -along, {i: 1, i + 1: -1}) for i, ends in enumerate(sides) for place in ends]
    columns = []
    for place, normal, on in pushes:
        for edge in tan_phi, -tan_phi:
            force, balance = normal + edge * np.array([-normal[1], normal[0]]), np.zeros_like(weights)
            for i, sign in on.items():
                arm = place - centres[i]
                balance[i] = sign * np.array([*force, arm[0] * force[1] - arm[1] * force[0]])
            columns.append(balance.ravel())
    return closed_forms.is_sum_of(np.array(columns).T, weights.ravel())


def columns_limit():
    """tan(phi) with which the force on the toe vanishes."""
    low, high = 0.7, 0.8
    while high - low > 1e-12:
        middle = (low + high) / 2
        low, high = (middle, high) if closed_forms.toppling_columns(*columns_given(middle))[1] > 0 else (low, middle)
    return low


# Olsson's crack


def crack(programs):
    name = "slipping crack (Olsson 1982)"
    text = programs.text("slipping-crack")
    result = programs.result(text)
    k_n, k_s, _, phi = material_of(result.scene, "slipping")
    compliances = closed_forms.slipping_crack(math.pi / 4, math.sqrt(2), 0.54, k_n, k_s, phi)
    load_history = result.scene["boundary"][-1]["load_history"][1:]
    forces = closed_forms.cyclic_force([factor * 1e-3 for _, factor in load_history], compliances)
    rows = []
    for (day, factor), force, part in zip(load_history, forces, ("load", "load", "unloading", "unloading", "unloading, slips back",
                                                           "unloading, slips back", "reloading", "reloading, slips",
                                                           "reloading, slips")):
        found = axial_force(result, result.state_at(day))
        rows.append(Row(name, f"force at {factor:g} mm ({part})", "kN/m", force / 1e3, found / 1e3, 1e-4,
                        "rock that is not rigid: H k / E = 5e-5", max(forces) / 1e3))
    return rows + crack_in_elastic_rock(programs)


def crack_in_elastic_rock(programs):
    """With the rock and the stiff joints of UDEC's verification problem, against the slopes of Brady and others."""
    text = changed(programs.text("slipping-crack"), "^youngs_modulus_GPa = 10000", "youngs_modulus_GPa = 88.9")
    text = changed(text, "stiffness_MPa_per_m = 220", "stiffness_MPa_per_m = 220000", count=4)
    result = programs.result(changed(text, "^size_m = 0.1", "size_m = 0.05"))
    young, nu = elastic_of(result.scene)
    k_n, k_s, _, phi = material_of(result.scene, "slipping")
    slopes = closed_forms.brady_slopes(math.pi / 4, math.sqrt(2), 0.54, k_n, k_s, phi, (2, 1, young / (1 - nu**2)))
    force = {0: 0.0} | {day: axial_force(result, result.state_at(day)) for day in (2, 3, 6)}
    found = [(force[last] - force[first]) / (millimetres * 1e-3)
             for first, last, millimetres in ((0, 2, 1), (2, 3, -0.1), (0, 6, 0.15))]
    return [Row("the same in elastic rock (Brady and others 1985)", f"slope, {part}", "GN/m/m", 1e-9 / compliance,
                slope / 1e9, 0.01, "a model of springs, not an exact answer")
            for part, compliance, slope in zip(("load", "unloading", "slips back"), slopes, found)]


def axial_force(result, state):
    """On a section of 1 m by 2 m, from the mean stress: the mean over the height of the force on level cuts."""
    return -result.mean_stress(state)[1] * 1.0


# Amadei and Goodman, in shear


def sheared_layers(programs):
    result = programs.result(programs.text("sheared-layers"))
    young, nu = elastic_of(result.scene)
    modulus = closed_forms.layers_shear_modulus(young / (2 * (1 + nu)), material_of(result.scene, "joint")[1], 2)
    return [Row("layered rock in shear (Amadei and Goodman 1981)", "shear modulus along the joints", "GPa",
                modulus / 1e9, 1e6 / (result.point("top")[0] / 8) / 1e9, 2e-5, BALANCE)]


# Waves and falls


def step_history(programs, text):
    """The step history of a run of dynamic relaxation that ends without equilibrium."""
    path, code, message = programs.answer(text, "--step-history", 1)
    if code != 3:
        raise RuntimeError(f"demsolve ended with exit code {code}, not 3: {message}")
    return Result(path)


def transform(time, displacement, rate):
    """Fourier transform of the acceleration of what moves steadily from 3/4 of the time on, at a circular frequency."""
    late = time > time[0] + 0.75 * (time[-1] - time[0])
    speed, reach = np.polyfit(time[late], displacement[late], 1)
    end = np.exp(-1j * rate * time[-1])
    integral = np.trapz(displacement * np.exp(-1j * rate * time), time)
    # by parts, twice
    return speed * end + 1j * rate * ((speed * time[-1] + reach) * end + 1j * rate * integral)


def wave(programs):
    name = "P-wave through a joint (Schoenberg 1980)"
    text = programs.text("wave-in-a-bar")
    whole = re.sub(r"(?s)\[\[(joint|gauge)\]\]\n.*?\n\n", "", text)
    with_joint, without = step_history(programs, text), step_history(programs, whole)
    young, nu = elastic_of(without.scene)
    speed, impedance = closed_forms.p_wave(young, nu, without.scene["rock"][0]["density_kg_per_m3"])
    pressure, stiffness = 1e6, material_of(without.scene, "joint")[0]
    lag = impedance / (2 * stiffness)
    until = 140 / speed  # then the ends come in
    time = with_joint["/step_history/solver_time"]
    seen = time < until
    time = time[seen]
    with_joint, without = (-result["/step_history/displacement"][seen, :, 0].T for result in (with_joint, without))
    # Without the joint: a straight line from the arrival on.
    lines = [np.polyfit(time[time > 1.2 * x / speed], u[time > 1.2 * x / speed], 1)
             for x, u in zip((40, 60), without)]
    arrivals = [-b / a for a, b in lines]
    zone = "zones of 0.25 m: a few hundredths of a zone over 20 m"
    behind = closed_forms.step_through_a_joint(time - 60 / speed, pressure, impedance, stiffness)
    rows = [
        Row("P-wave in a bar", "speed between 40 m and 60 m", "m/s", speed, 20 / (arrivals[1] - arrivals[0]), 1e-3,
            zone),
        Row("P-wave in a bar", "speed of the rock behind a step of 1 MPa", "m/s", pressure / impedance, lines[0][0],
            1e-3, zone),
        Row(name, "displacement behind the joint, during 19 ms: largest difference over displacement at the end", "1", 0,
            abs(with_joint[1] - behind).max() / behind[-1], 2e-3,
            "the joint spreads the wave front over 4 m, zones are 0.25 m: (0.25 / 4)^2 / 2", 1)]
    for share in 0.5, 1, 2:
        rate = share / lag
        came, went, back = (abs(transform(time, u, rate)) for u in
                            (without[1], with_joint[1], with_joint[0] - without[0]))
        rows += [
            Row(name, f"transmitted share at w z / 2 K_n = {share:g}", "1", 1 / math.hypot(1, share), went / came, 2e-3,
                "the same"),
            Row(name, f"transmitted plus reflected share of energy, w z / 2 K_n = {share:g}", "1", 1,
                (went**2 + back**2) / came**2, 4e-3, "twice that")]
    return rows


def free_fall(programs):
    rows = []
    for rigid in True, False:
        text = programs.text("free-fall") + ('rigid_rocks = ["rock"]\n' if rigid else "")
        result = programs.result(text)
        kind = "rigid" if rigid else "zones that deform"
        time, energy = result["/dynamics/dynamic_time"], result["/dynamics/kinetic_energy"]
        falls = (time > 0.1) & (time < 0.95 * math.sqrt(2 * 5 / 9.81))
        acceleration = np.polyfit(time[falls], np.sqrt(2 * energy[falls] / (2700 * 4)), 1)[0]
        # Zones spring back when the weight that pressed them goes: p^2 / 2 E over m g^2 t^2 / 2 at 0.1 s is 3e-6.
        rows.append(Row(f"free fall by [large_displacements] ({kind})", "acceleration", "m/s2", 9.81, acceleration, 1e-4,
                        "steps of central differences; in zones, vibration"))
        # Joint and rock give way by less under the block than they did under the prop.
        rows.append(Row(f"free fall by [large_displacements] ({kind})", "final position", "m", -5, result.point("block")[1], 1e-4,
                        "joints and rock close by less than 0.1 mm"))
    return rows


def friction(programs):
    """data/verification/incline stands with a friction angle 0.001 degree above its dip, and falls with one below."""
    text = programs.text("incline")

    def falls(angle):
        return not stands(programs, changed(text, "^friction_angle_deg = 35", f"friction_angle_deg = {angle:.12g}"),
                          "--no-creep")

    return [Row("block on an incline", "required friction angle: too small, and sufficient", "degrees",
                25, bracket(25, 0.001 / 25, falls), 1.001 * 0.001 / 25, "checked 0.001 degree on both sides")]


# By which engines: the implicit one, with dynamic relaxation where it gives up (auto), and dynamic relaxation alone.
PROBLEMS = {kirsch: ("auto", "relaxation"), cantilever: ("auto", "relaxation"), weakness: ("auto", "relaxation"),
            roof_wedge: ("auto", "relaxation"), toppling: ("auto",), crack: ("auto", "relaxation"),
            sheared_layers: ("auto", "relaxation"), friction: ("auto", "relaxation"), wave: ("relaxation",),
            free_fall: ("auto",)}


def rows_of(problem, programs):
    return [replace(row, engine=engine) for engine in PROBLEMS[problem] for row in problem(programs.by(engine))]


def shown(figure):
    return " to ".join(f"{number:.6g}" for number in np.atleast_1d(figure))


def table(rows):
    lines = ["| problem | engine | what is compared | unit | closed form | computed | error | allowed error | reason |",
             "|---|---|---|---|---|---|---|---|---|"]
    last = "", ""
    for row in rows:
        problem = row.problem if (row.problem, row.engine) != last else ""
        lines.append(f"| {problem} | {row.engine} | {row.what} | {row.unit} | {shown(row.exact)} | "
                     f"{shown(row.computed)} | {row.error:.1e} | {row.allowed:.1e} | {row.why} |")
        last = row.problem, row.engine
    return "\n".join(lines) + "\n"


def cantilever_table(found):
    lines = ["| zones | size over depth | number | gridpoints | deflection over the closed form |", "|---|---|---|---|---|"]
    lines += [f"| {one.kind} | 1/{1 / one.size:g} | {one.zones} | {one.gridpoints} | {one.share:.4f} |" for one in found]
    return "\n".join(lines) + "\n"


def main():
    if len(sys.argv) != 4:
        sys.exit("usage: literature.py PROGRAMS DATA OUT")
    tables = Path(sys.argv[3]) / "tables"
    tables.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="jointcreep-") as folder:
        programs = Programs(Path(sys.argv[1]).resolve(), sys.argv[2], folder)
        (tables / "literature.md").write_text(table([row for problem in PROBLEMS for row in rows_of(problem, programs)]))
        (tables / "cantilever.md").write_text(cantilever_table(cantilevers_of_both_kinds(programs)))


if __name__ == "__main__":
    main()
