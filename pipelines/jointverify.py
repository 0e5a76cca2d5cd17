#!/usr/bin/python3
"""jointverify: Recomputes equilibrium, stresses and joint laws of a result from the file alone.

usage: jointverify RESULT.h5

Description:
Reads a result file of demsolve (format 2.3 or later) and computes with formulas of its own what the states must
fulfil. It shares no code with the solver. It writes nothing but a table: a line for each check, with the largest
deviation, what is allowed, and where it is.

At large displacements, elastic stresses are verified, and at rest equilibrium of gridpoints inside blocks and of every
piece of rock between its contacts. Of the joint laws only the largest strength of all joints is verified. Lines "not
verified" say what else is not. Lines "not checked" name datasets that no check uses, such as the network's.

Creep of joints is verified where each creep step has a state: demsolve --states 1.

What is allowed:
  equilibrium    the run's tolerance of the unbalanced force ratio
  energies       1e-8 of the sum of their magnitudes; in a dynamic analysis the scene's energy_tolerance, or 1 percent
  creep          1e-9 of the terms that are added
  stresses at large displacements
                 Hooke's, of 100 times the strain between the first two states, times the gradient of displacements:
                 the equilibrium in situ is found again, and how far rock moves and turns for that is not in the file
  all others     rounding: 1e-12 of the terms that are added, some thousand times the rounding of one number

Options:
  -h [ --help ]     show this text
  -V [ --version ]  show the version

Exit codes:
  0  verified: every check passed
  2  the command line or the file is not as expected
  3  a check failed
  4  the file cannot be read
  5  internal error, or out of memory

Example:
  jointverify result.h5
"""

import datetime
import os
import sys
import tomllib

import h5py
import numpy as np

VERSION = "@PROJECT_VERSION@"  # CMake knows it
MAJOR, MINOR = 2, 3  # of the format; older files lack what is checked
BEST_COMPRESSION = 1100  # deflating stores a byte for up to 1032
ROUNDING = 1e-12
NOT_IN_FILE = 100  # times the strain between the first two states: at large displacements the in-situ equilibrium is found again
FIRST_ROTATION = 0.005  # of a block, while it is found again
MOVING_FORCE = 2  # times the mean force, in which contacts count by their sum on a gridpoint
ENERGY_OF_DYNAMICS = 0.01  # where the scene does not say
ENERGY = 1e-8  # of other searches, with which only rounding is missing
AT_STRENGTH = 1e-6  # a contact this near its strength counts as slipping
REMOVED, STUCK, SLIPPING, OPEN = range(4)
COULOMB, RESIDUAL, BARTON_BANDIS, WEARING, YIELDING = LAWS = range(5)
DEGREE = np.pi / 180


class NotWanted(Exception):
    """The file is not as expected: exit code 2."""


class NotReadable(Exception):
    """Exit code 4."""


# --- The file -------------------------------------------------------------------------------------------------------


class File:
    """Datasets of an HDF5 file. Sizes of dimensions are those of the first dataset that has them."""

    def __init__(self, path):
        try:
            with open(path, "rb"):
                pass
        except OSError as error:
            raise NotReadable(f"{path}: cannot be opened: {error.strerror}") from None
        self.path, self.size, self.used = path, {}, set()
        try:
            self.file = h5py.File(path, "r")
        except OSError:
            if str(path).endswith(".toml"):
                raise NotWanted(f"{path}: is a scene; expected a result file of demsolve. First run: jointcreep run {path} -o OUT/") from None
            raise NotWanted(f"{path}: is no HDF5 file, or a damaged one; expected a result file of demsolve") from None
        kind = self.attribute("filetype")
        kind = kind.decode("utf-8", "replace") if isinstance(kind, bytes) else str(kind)
        if kind not in ("jointcreep result", "jointcreep checkpoint"):
            raise NotWanted(f'{path}: is a "{kind}" file; expected a "jointcreep result" file, which demsolve makes')
        version = [int(part) for part in self.integers_of("format_version", 2)]
        if version[0] != MAJOR or version[1] < MINOR:
            raise NotWanted(f"{path}: has format version {version[0]}.{version[1]}; expected {MAJOR}.{MINOR} or a later "
                            f"{MAJOR}. Run demsolve again.")
        if self.integers_of("complete", 1)[0] != 1:
            raise NotWanted(f"{path}: is not complete")

    def attribute(self, name):
        try:
            return self.file.attrs[name]
        except (KeyError, OSError, TypeError, ValueError, RuntimeError):
            raise NotWanted(f"{self.path}: has no attribute {name} that can be read; expected a result file of demsolve") \
                from None

    def integers_of(self, name, count):
        values = np.atleast_1d(self.attribute(name))
        if values.dtype.kind not in "iu" or values.shape != (count,):
            raise NotWanted(f"{self.path}: attribute {name}: expected {count} whole numbers")
        return values

    def has(self, group):
        return group in self.file

    def read(self, name):
        try:
            item = self.file[name]
        except (KeyError, OSError, RuntimeError):
            raise NotWanted(f"{self.path}: {name}: is missing; expected a result file of format {MAJOR}.{MINOR}") from None
        if not isinstance(item, h5py.Dataset):
            raise NotWanted(f"{self.path}: {name}: is no dataset")
        stored, size = item.id.get_storage_size(), item.size * item.dtype.itemsize
        if size > BEST_COMPRESSION * stored:
            raise NotReadable(f"{self.path}: {name}: cannot be read: {stored} bytes are stored for {size}; the file is damaged")
        try:
            if h5py.check_string_dtype(item.dtype) is not None:
                texts = np.atleast_1d(item.asstr()[...])
                return np.array([text.rstrip("\0") for text in texts.ravel()], dtype=object).reshape(texts.shape)
            return np.asarray(item[...])
        except UnicodeDecodeError:
            raise NotWanted(f"{self.path}: {name}: is not UTF-8") from None
        except (OSError, RuntimeError) as error:
            raise NotReadable(f"{self.path}: {name}: cannot be read: {error}") from None
        except (TypeError, ValueError) as error:
            raise NotWanted(f"{self.path}: {name}: {error}") from None

    def array(self, name, kind, *shape):
        """Of these dimensions, each a name or a number; kind "f", "i" or "text"."""
        self.used.add(name)
        values = self.read(name)
        is_kind = {"f": values.dtype == np.float64, "i": values.dtype.kind == "i", "text": values.dtype == object}[kind]
        if not is_kind:
            what = {"f": "64-bit floating-point numbers", "i": "whole numbers", "text": "text"}[kind]
            raise NotWanted(f"{self.path}: {name}: has the type {values.dtype}; expected {what}")
        if values.ndim != len(shape):
            raise NotWanted(f"{self.path}: {name}: has {values.ndim} dimensions; expected {len(shape)}")
        for found, dimension in zip(values.shape, shape):
            more = 0
            if isinstance(dimension, str) and dimension.endswith("+1"):
                dimension, more = dimension[:-2], 1
            wanted = dimension if isinstance(dimension, int) else self.size.setdefault(dimension, found - more) + more
            if found != wanted or wanted < more:
                raise NotWanted(f"{self.path}: {name}: has {found} rows of {dimension}; expected {wanted}")
        return values.astype(np.int64) if kind == "i" else values

    def numbers(self, name, *shape):
        return self.array(name, "f", *shape)

    def index(self, name, of, *shape, least=0):
        """Whole numbers from `least` up to the size of a dimension, or to a number."""
        values = self.array(name, "i", *shape)
        end = of if isinstance(of, int) else self.size[of]
        wrong = np.argwhere((values < least) | (values >= end))
        if len(wrong):
            place = tuple(wrong[0])
            raise NotWanted(f"{self.path}: {name}{list(map(int, place))}: is {values[place]}; expected {least} to {end - 1}")
        return values

    def texts(self, name, *shape):
        return self.array(name, "text", *shape)

    def all_datasets(self):
        names = []
        try:
            self.file.visititems(lambda name, item: names.append("/" + name) if isinstance(item, h5py.Dataset) else None)
        except (OSError, RuntimeError) as error:
            raise NotReadable(f"{self.path}: cannot be read: {error}") from None
        return names


# --- The scene ------------------------------------------------------------------------------------------------------


class Scene:
    """What the scene's text and the options of the run say. Stresses in Pa, lengths in m, angles in rad, times in days."""

    def __init__(self, file):
        self.place = f"{file.path}: /scene"
        try:
            self.tables = tomllib.loads("\n".join(file.texts("/scene", 1)))
        except (tomllib.TOMLDecodeError, RecursionError) as error:
            raise NotWanted(f"{self.place}: {error}") from None
        program = file.texts("/provenance/program", "program")
        options = file.texts("/provenance/options", "program")
        if "demsolve" not in program:
            raise NotWanted(f"{file.path}: /provenance/program: has no demsolve")
        words = str(options[list(program).index("demsolve")]).split()
        self.options = {}
        for word, value in zip(words, [*words[1:], ""]):
            if word.startswith("--"):
                self.options[word] = "" if value.startswith("--") else value

        self.gravity = self.number(self.table("section"), "gravity_m_per_s2")
        equilibrium = self.table("equilibrium", {})
        self.tolerance = self.option("--tolerance", self.number(equilibrium, "tolerance", 1e-6))
        self.divisor = self.option("--strength-factor", 1.0)
        self.increments = self.option("--increments", equilibrium.get("unloading_increments", 1)) != 1 or \
            "increments_tolerance" in equilibrium or "--increments-tolerance" in self.options
        self.has_dashpots = "stiffness_damping_s" in equilibrium  # which the report's forces have, too
        self.large_displacements = "large_displacements" in self.tables
        large = self.table("large_displacements", {})
        self.rigid, self.new_contacts = large.get("rigid_rocks", []), large.get("new_contacts")
        self.stop, self.energy_tolerance = large.get("stop_s"), large.get("energy_tolerance", ENERGY_OF_DYNAMICS)
        creep = self.table("creep", {})
        self.creeps = "creep" in self.tables and "--no-creep" not in self.options
        self.scheme = self.options.get("--creep-scheme", str(creep.get("scheme", "auto"))).replace("-", " ")
        if not self.tolerance > 0 or not self.divisor > 0:
            raise NotWanted(f"{self.place}: tolerance {self.tolerance}, strength factor {self.divisor}; expected more than 0")
        self.rocks = {rock.get("name"): rock for rock in self.list("rock")}
        self.start = self.table("schedule").get("start", 0)
        self.boundaries = [self.boundary(table) for table in self.list("boundary")]

    def friction_of_new_contacts(self):
        """Of contacts that form at large displacements: the largest tangent of friction, and rows of {angle, roughness, wall strength}."""
        of = next((one for one in self.list("joint_material") if one.get("name") == self.new_contacts), {})
        angle = self.number(of, "friction_angle_deg", 0) * DEGREE
        tangent = np.tan(max(angle, self.number(of, "initial_friction_angle_deg", 0) * DEGREE)) / self.divisor
        if "joint_roughness_coefficient" not in of:
            return tangent, np.zeros((0, 3))
        return tangent, np.array([[angle, self.number(of, "joint_roughness_coefficient"), 1e6 * self.number(of, "joint_wall_strength_MPa")]])

    def table(self, name, default=None):
        value = self.tables.get(name, default)
        if not isinstance(value, dict):
            raise NotWanted(f"{self.place}: [{name}]: expected this table")
        return value

    def list(self, name):
        value = self.tables.get(name, [])
        if not isinstance(value, list) or not all(isinstance(one, dict) for one in value):
            raise NotWanted(f"{self.place}: [[{name}]]: expected a list of tables")
        return value

    def number(self, table, key, default=None):
        value = table.get(key, default)
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise NotWanted(f"{self.place}: {key}: expected a number")
        return float(value)

    def pair(self, value, key):
        if not isinstance(value, list) or len(value) != 2:
            raise NotWanted(f"{self.place}: {key}: expected two numbers")
        return np.array([self.number({key: part}, key) for part in value])

    def option(self, name, default):
        if name not in self.options:
            return default
        try:
            return float(self.options[name])
        except ValueError:
            raise NotWanted(f"{self.place}: option {name} of demsolve: expected a number") from None

    def day(self, value, key):
        """Days since the start, of a date or a number."""
        if isinstance(value, datetime.date) and isinstance(self.start, datetime.date):
            return float((value - self.start).days)
        start = 0.0 if isinstance(self.start, datetime.date) else self.number({"start": self.start}, "start")
        return self.number({key: value}, key) - start

    def boundary(self, table):
        history = table.get("load_history")
        points = None
        if history is not None:
            if not isinstance(history, list) or not history or \
                    not all(isinstance(pair, list) and len(pair) == 2 for pair in history):
                raise NotWanted(f"{self.place}: load_history: expected pairs of a date and a number")
            points = np.array([[self.day(pair[0], "load_history"), self.number({"load_history": pair[1]}, "load_history")]
                               for pair in history])
        normal = None
        if table.get("fix") == "normal":
            along = self.pair(table.get("to_m"), "to_m") - self.pair(table.get("from_m"), "from_m")
            normal = np.array([along[1], -along[0]]) / np.hypot(*along)
        return {"fix": str(table.get("fix", "")), "normal": normal,
                "traction": 1e6 * self.pair(table["traction_MPa"], "traction_MPa") if "traction_MPa" in table else None,
                "displacement": 1e-3 * self.pair(table["displacement_mm"], "displacement_mm")
                if "displacement_mm" in table else None,
                "factor": lambda day: 1.0 if points is None else float(np.interp(day, points[:, 0], points[:, 1]))}

    def scheme_between(self, day, other):
        """The creep scheme of a step between two days: "auto" is linear force where loads change."""
        if self.scheme != "auto":
            return self.scheme
        loads = [one["factor"] for one in self.boundaries if one["traction"] is not None or one["displacement"] is not None]
        return "linear force" if any(factor(day) != factor(other) for factor in loads) else "fitted"

    def of_rock(self, name, key, default=None):
        if name not in self.rocks:
            raise NotWanted(f'{self.place}: has no [[rock]] "{name}", which /names/rock has')
        return self.number(self.rocks[name], key, default)


# --- Checks ---------------------------------------------------------------------------------------------------------


class Checks:
    """The worst of what each check has seen."""

    def __init__(self):
        self.rows, self.left_out, self.outside = {}, [], []

    def see(self, name, unit, deviation, allowed, where):
        """Deviations that must be at most the allowed ones; where(i) says what value i is."""
        deviation, allowed = np.broadcast_arrays(np.asarray(deviation, float), np.asarray(allowed, float))
        deviation, allowed = deviation.ravel(), allowed.ravel()
        if not len(deviation):
            return
        share = np.where(deviation <= 0, 0.0, np.divide(deviation, allowed, out=np.full(len(deviation), np.inf),
                                                       where=allowed > 0))
        share[np.isnan(deviation) | np.isnan(allowed)] = np.inf
        worst = int(np.argmax(share))
        row = self.rows.setdefault(name, {"share": -1.0, "count": 0})
        row["count"] += len(share)
        if share[worst] > row["share"]:
            row.update(share=share[worst], deviation=deviation[worst], allowed=allowed[worst], unit=unit,
                       where=where(worst))

    def leave_out(self, what):
        if what not in self.left_out:
            self.left_out.append(what)

    def report(self):
        """Whether all passed; prints the table."""
        heads = ("check", "values", "largest deviation", "allowed", "verdict", "where")
        table = [heads]
        for name, row in self.rows.items():
            passed = row["share"] <= 1
            off = row["deviation"] if row["share"] > 0 else 0.0
            table.append((name, str(row["count"]), f"{off:.3g} {row['unit']}".strip(),
                          f"{row['allowed']:.3g} {row['unit']}".strip(), "ok" if passed else "FAILED",
                          row["where"] if row["share"] > 0 else ""))
        widths = [max(len(line[i]) for line in table) for i in range(len(heads) - 1)]
        for line in table:
            print(("  ".join(cell.ljust(width) for cell, width in zip(line, widths)) + "  " + line[-1]).rstrip())
        for what in self.left_out:
            print(f"not verified: {what}")
        for what in self.outside:
            print(f"not checked: {what}")
        good = sum(row["share"] <= 1 for row in self.rows.values())
        print(f"verified: {good} checks of {len(self.rows)}")
        return good == len(self.rows)


# --- The section ----------------------------------------------------------------------------------------------------


def norm(vectors):
    return np.hypot(vectors[..., 0], vectors[..., 1])


def in_matrices(components):
    """Symmetric matrices of {xx, yy, xy}."""
    xx, yy, xy = np.moveaxis(components, -1, 0)
    return np.stack([np.stack([xx, xy], axis=-1), np.stack([xy, yy], axis=-1)], axis=-2)


def cross(a, b):
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def inverse(matrices):
    """Of 2 x 2 matrices; without an exception where there is none, as of zones that a wrong file makes flat."""
    (a, b), (c, d) = np.moveaxis(matrices, (-2, -1), (0, 1))
    adjugate = np.stack([np.stack([d, -b], axis=-1), np.stack([-c, a], axis=-1)], axis=-2)
    return adjugate / (a * d - b * c)[..., None, None]


def polar(gradient):
    """Rotation and stretch of displacement gradients."""
    turn = np.stack([gradient[:, 0, 0] + gradient[:, 1, 1], gradient[:, 1, 0] - gradient[:, 0, 1]], axis=1)
    cos, sin = (turn / norm(turn)[:, None]).T
    rotation = np.stack([np.stack([cos, -sin], axis=-1), np.stack([sin, cos], axis=-1)], axis=-2)
    return rotation, rotation.transpose(0, 2, 1) @ gradient


def linear_shapes(corner):
    """Areas of zones with these corners [zone, 3, 2], and slopes of the shape functions of their corners [zone, corner, 2]."""
    opposite = np.roll(corner, -2, axis=1) - np.roll(corner, -1, axis=1)  # the side across from each corner
    area = cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]) / 2
    return area, np.stack([-opposite[..., 1], opposite[..., 0]], axis=-1) / (2 * area)[:, None, None]


class Section:
    """Mesh, rocks and joints."""

    def __init__(self, file, scene):
        number, index = file.numbers, file.index
        self.position = number("/mesh/gridpoint_position", "gridpoint", 2)
        self.fixed = index("/mesh/gridpoint_fixed", 4, "gridpoint")
        rock_names = file.texts("/names/rock", "rock")
        file.texts("/names/stage", "stage")
        self.block_rock = index("/blocks/rock", "rock", "block")
        self.rigid_block = np.isin(rock_names, scene.rigid)[self.block_rock]
        self.block_stage = index("/blocks/stage", "stage", "block", least=-1)
        self.block_area = number("/blocks/area", "block")
        self.zone = index("/mesh/zone_gridpoint", "gridpoint", "zone", 3)
        self.zone_block = index("/mesh/zone_block", "block", "zone")
        self.zone_stage = self.block_stage[self.zone_block]
        self.tie = index("/mesh/tie_gridpoint", "gridpoint", "tie", 2)
        self.tie_stage = index("/mesh/tie_stage", "stage", "tie")
        self.side = index("/mesh/side_gridpoint", "gridpoint", "side", 2)
        self.side_zone = index("/mesh/side_zone", "zone", "side")
        self.side_boundary = index("/mesh/side_boundary", len(scene.boundaries), "side")
        vertex = number("/vertices/position", "vertex", 2)
        edge_vertex = index("/edges/vertex", "vertex", "edge", 2)
        self.edge_block = index("/edges/block", "block", "edge", 2, least=-1)
        self.contact = index("/mesh/contact_gridpoint", "gridpoint", "contact", 2)
        self.edge = index("/mesh/contact_edge", "edge", "contact")
        self.normal = number("/mesh/contact_normal", "contact", 2)
        self.tangent = np.stack([self.normal[:, 1], -self.normal[:, 0]], axis=1)
        self.length = number("/mesh/contact_length", "contact")
        self.centre = number("/mesh/contact_centre", "contact", 2)
        if not len(self.position) or not len(self.zone):
            raise NotWanted(f"{file.path}: /mesh/zone_gridpoint: has no zones")

        corner = self.position[self.zone]
        self.area, of_corners = linear_shapes(corner)
        # Of each stress point the slopes of the shape functions, [zone, point, gridpoint, 2], and of a zone their mean.
        middle = index("/mesh/zone_middle", "gridpoint", "quadratic_zone", 3)
        self.side_middle = index("/mesh/side_middle", "gridpoint", "quadratic_side")
        self.is_quadratic = len(middle) > 0
        if self.is_quadratic and (len(middle) != len(self.zone) or len(self.side_middle) != len(self.side)):
            raise NotWanted(f"{file.path}: /mesh/zone_middle, /mesh/side_middle: expected a row a zone and a row a side, or none")
        self.node = np.concatenate([self.zone, middle], axis=1) if self.is_quadratic else self.zone
        self.slopes = of_corners[:, None]
        if self.is_quadratic:
            share = np.full((3, 3), 1 / 6) + np.eye(3) / 2  # of corners, at each stress point
            after = np.roll(np.arange(3), -1)
            self.slopes = np.concatenate([
                (4 * share - 1)[None, :, :, None] * of_corners[:, None],
                4 * (share[None, :, :, None] * of_corners[:, None, after] + share[None, :, after, None] * of_corners[:, None])],
                axis=2)
        self.gradient = self.slopes.mean(axis=1)
        self.perimeter = norm(np.roll(corner, -1, axis=1) - corner).sum(axis=1)
        self.zone_centre = corner.mean(axis=1)
        self.has_zones = np.zeros(len(self.position), bool)
        self.has_zones[self.node] = True

        def of_zones(key, unit=1.0, default=None):
            used = np.unique(self.block_rock[self.zone_block])
            values = np.zeros(len(rock_names))
            for rock in used:
                values[rock] = unit * scene.of_rock(rock_names[rock], key, default)
            return values[self.block_rock[self.zone_block]]

        modulus, poisson = of_zones("youngs_modulus_GPa", 1e9), of_zones("poissons_ratio")
        self.weight = of_zones("density_kg_per_m3") * self.area * scene.gravity
        factor = modulus / ((1 + poisson) * (1 - 2 * poisson))
        self.c11, self.c12, self.c33 = factor * (1 - poisson), factor * poisson, modulus / (2 * (1 + poisson))
        # Mohr-Coulomb; 0 of rock without strength, which does not yield.
        friction = np.arctan(np.tan(of_zones("friction_angle_deg", DEGREE, 0)) / scene.divisor)
        cohesion = of_zones("cohesion_MPa", 1e6, 0) / scene.divisor
        self.n_phi = (1 + np.sin(friction)) / (1 - np.sin(friction))
        self.uniaxial = 2 * cohesion * np.sqrt(self.n_phi)
        apex = np.divide(self.uniaxial, self.n_phi - 1, out=np.full(len(friction), np.inf), where=self.n_phi > 1)
        self.tension = np.minimum(of_zones("tensile_strength_MPa", 1e6, 0) / scene.divisor, apex)

        # Joints, of every edge and then of every contact.
        def of_edges(name):
            return number("/equivalent/" + name, "edge")[self.edge]

        def divided(name):
            return np.tan(of_edges(name)) / scene.divisor

        self.law = index("/equivalent/law", len(LAWS), "edge")[self.edge]
        self.k_n, self.k_s = of_edges("normal_stiffness"), of_edges("shear_stiffness")
        self.cohesion, self.strength_in_tension = (of_edges(name) / scene.divisor for name in ("cohesion", "tensile_strength"))
        self.tan_phi, self.tan_psi = divided("friction_angle"), divided("dilation_angle")
        self.dilation_until = of_edges("dilation_until")
        self.residual_cohesion = of_edges("residual_cohesion") / scene.divisor
        self.residual_tan_phi = divided("residual_friction_angle")
        self.initial_tan_phi = divided("initial_friction_angle")
        self.residual_angle = of_edges("friction_angle")  # of Barton and Bandis, whose strength is divided as a whole
        self.roughness, self.wall = of_edges("roughness"), of_edges("wall_strength")
        self.largest_closure = of_edges("largest_closure")
        self.divisor = scene.divisor
        self.tan_of_new, self.rough_of_new = scene.friction_of_new_contacts()
        self.units = {}
        for direction in ("normal", "shear"):
            kelvin = [number(f"/equivalent/{direction}_kelvin_{what}", "edge", "kelvin_unit")[self.edge]
                      for what in ("stiffness", "viscosity")]
            maxwell = number(f"/equivalent/{direction}_maxwell_viscosity", "edge")[self.edge]
            stiffness = np.column_stack([kelvin[0], np.zeros(len(maxwell))])
            viscosity = np.column_stack([np.where(kelvin[0] > 0, kelvin[1], 0), maxwell])
            self.units[direction] = stiffness, viscosity  # a viscosity of 0 is no unit

        run = vertex[edge_vertex[:, 1]] - vertex[edge_vertex[:, 0]]
        self.edge_length = norm(run)[self.edge]
        self.normal_of_edge = np.stack([-run[:, 1], run[:, 0]], axis=1)[self.edge]
        self.reach = np.abs(self.position).max()  # of coordinates, which rounding goes with
        self.size = float(norm(np.ptp(self.position, axis=0)))

    # Laws.

    def stress_of(self, strain):
        """Hooke's, of matrices [zone, 2, 2]."""
        xx, yy, xy = strain[:, 0, 0], strain[:, 1, 1], strain[:, 0, 1]
        return in_matrices(np.stack([self.c11 * xx + self.c12 * yy, self.c12 * xx + self.c11 * yy, 2 * self.c33 * xy], axis=1))

    def strain_of(self, stress):
        xx, yy, xy = stress[:, 0, 0], stress[:, 1, 1], (stress[:, 0, 1] + stress[:, 1, 0]) / 2
        determinant = self.c11**2 - self.c12**2
        return in_matrices(np.stack([(self.c11 * xx - self.c12 * yy) / determinant, (self.c11 * yy - self.c12 * xx) / determinant,
                                     xy / (2 * self.c33)], axis=1))

    def is_barton_bandis(self):
        return self.law == BARTON_BANDIS

    def closure(self, p):
        """Closure at a pressure, of Barton and Bandis's law; a negative one is a gap."""
        p = np.asarray(p, float)
        scale = self.k_n * self.largest_closure
        on_curve = np.clip(p, 0, self.wall)
        stiffest = self.k_n * (1 + self.wall / scale) ** 2
        closed = on_curve * self.largest_closure / (scale + on_curve) + np.maximum(p - self.wall, 0) / stiffest
        return np.where(p < 0, p / self.k_n, closed)

    def pressure(self, v):
        scale = self.k_n * self.largest_closure
        crushed = self.wall * self.largest_closure / (scale + self.wall)
        stiffest = self.k_n * (1 + self.wall / scale) ** 2
        on_curve = self.k_n * v / (1 - np.minimum(v, crushed) / self.largest_closure)
        return np.where(v < 0, self.k_n * v, np.where(v < crushed, on_curve, self.wall + stiffest * (v - crushed)))

    def largest_strength(self, pressure):
        """Largest mean shear traction that any joint of the section, or a new contact, can have under a mean pressure that may
        vary along the contact."""
        tangent = max([self.tan_of_new, *(np.max(each, initial=0) for each in (self.tan_phi, self.residual_tan_phi, self.initial_tan_phi))])
        # Where bonds are in tension, the strength of a part may be 0, not below.
        cohesion = np.max([np.max(self.cohesion, initial=0), np.max(self.strength_in_tension, initial=0) * tangent])
        limit = cohesion + pressure * tangent
        rough = np.unique(np.stack([self.residual_angle, self.roughness, self.wall], axis=1)[self.is_barton_bandis()], axis=0)
        for residual, roughness, wall in np.vstack([rough, self.rough_of_new]):
            steepest = np.minimum(np.maximum(70 * DEGREE, residual), residual + roughness * DEGREE * np.maximum(
                0, np.log10(wall / np.maximum(pressure, 1e-300))))
            limit = np.maximum(limit, pressure * np.tan(steepest) / self.divisor)
        return limit

    def strength(self, normal, broken):
        """Largest shear traction under a normal traction. Of a continuously yielding joint that before it has slipped."""
        weakened = broken & (self.law == RESIDUAL)
        cohesion = np.where(broken, np.where(self.law == RESIDUAL, self.residual_cohesion, 0.0), self.cohesion)
        tan_phi = np.where(weakened, self.residual_tan_phi, self.tan_phi)
        limit = np.maximum(0, cohesion - normal * tan_phi)
        p = np.maximum(-normal, 0)
        angle = self.residual_angle + self.roughness * DEGREE * np.maximum(0, np.log10(self.wall / np.maximum(p, 1e-300)))
        steepest = np.maximum(70 * DEGREE, self.residual_angle)
        limit = np.where(self.is_barton_bandis(), p * np.tan(np.minimum(angle, steepest)) / self.divisor, limit)
        return np.where(self.law == YIELDING, p * self.initial_tan_phi, limit)


class States:
    def __init__(self, file):
        number, index = file.numbers, file.index
        self.time = number("/states/time", "state")
        self.event = file.texts("/states/event", "state")
        self.displacement = number("/states/displacement", "state", "gridpoint", 2)
        self.reaction = number("/states/reaction", "state", "gridpoint", 2)
        self.stress = number("/states/stress", "state", "zone", 3)
        self.point_stress = number("/states/point_stress", "state", "quadratic_point", 3)
        if self.point_stress.shape[1] not in (0, 3 * self.stress.shape[1]):
            raise NotWanted(f"{file.path}: /states/point_stress: expected three rows a zone, or none")
        self.present = index("/states/zone_present", 2, "state", "zone") > 0
        self.traction = number("/states/traction", "state", "contact", 2)
        self.relative = number("/states/relative_displacement", "state", "contact", 2)
        self.status = index("/states/contact_status", 4, "state", "contact")
        self.slip = number("/states/slip", "state", "contact")
        self.dilation = number("/states/dilation", "state", "contact")
        self.broken = index("/states/bond_broken", 2, "state", "contact") > 0
        self.crept = number("/states/crept", "state", "contact", 2)
        self.initial_gap = number("/states/initial_gap", "contact")
        self.yielding = index("/states/yielding_zone", "zone", "yielding_zone")
        self.plastic = number("/states/plastic_strain", "state", "yielding_zone", 3)
        self.stress_zz = number("/states/stress_zz", "state", "yielding_zone")
        self.creeping = index("/states/creeping_zone", "zone", "creeping_zone")
        self.crept_strain = number("/states/crept_strain", "state", "creeping_zone", 3)
        if not len(self.time):
            raise NotWanted(f"{file.path}: /states/time: has no states")


    def stress_at_points(self, s):
        """Of the zones, [zone, point, 3]."""
        return self.point_stress[s].reshape(-1, 3, 3) if self.point_stress.shape[1] else self.stress[s][:, None]


class MovingContacts:
    """Contacts at the moments of dynamic analyses."""

    def __init__(self, file):
        blocks, first = file.array("/dynamics/contact_block", "i", "moving_contact", 2), file.array("/dynamics/first_contact", "i", "moment+1")
        self.block, self.moment_of = blocks, file.index("/dynamics/state", "state", "moment")
        self.normal = file.numbers("/dynamics/contact_normal", "moving_contact", 2)
        self.traction = file.numbers("/dynamics/contact_traction", "moving_contact", 2)
        ends = [file.numbers(f"/dynamics/contact_{end}", "moving_contact", 2) for end in ("from", "to")]
        self.tangent = np.stack([self.normal[:, 1], -self.normal[:, 0]], axis=1)
        self.middle = (ends[0] + ends[1]) / 2
        self.length = np.abs(((ends[1] - ends[0]) * self.tangent).sum(axis=1))
        if len(first) and (first[0] != 0 or (np.diff(first) < 0).any() or first[-1] != len(blocks)):
            raise NotWanted(f"{file.path}: /dynamics/first_contact: expected rows from 0 to {len(blocks)}, not decreasing")
        if blocks.size and (blocks.min() < -1 or blocks.max() >= file.size["block"]):
            raise NotWanted(f"{file.path}: /dynamics/contact_block: expected numbers of blocks, or -1")
        self.first = first

    def of_state(self, s):
        """The rows of a state's contacts; None if it is at no moment."""
        moments = np.flatnonzero(self.moment_of == s)
        return slice(*self.first[moments[-1]:moments[-1] + 2]) if len(moments) else None

    def force_on_a(self, rows):
        return self.length[rows, None] * (self.traction[rows, :1] * self.normal[rows] + self.traction[rows, 1:] * self.tangent[rows])


class Verification:
    def __init__(self, path):
        self.file = File(path)
        self.scene = Scene(self.file)
        self.section = Section(self.file, self.scene)
        self.states = States(self.file)
        self.checks = Checks()
        self.stage_names = list(self.file.texts("/names/stage", "stage"))
        self.equilibria = {name: self.file.numbers("/equilibria/" + name, "equilibrium") for name in (
            "time", "unbalanced_force_ratio", "contact_force_change", "work_of_loads", "stored_energy", "dissipated_energy",
            "damped_energy")}
        self.equilibria["is_implicit"] = self.file.index("/equilibria/is_implicit", 2, "equilibrium")
        # The state of equilibrium in situ is at small displacements in any scene.
        self.unit_crept, self.all_steps_known = {}, True
        self.n_small = 1 if self.scene.large_displacements else len(self.states.time)
        # Moments of a dynamic analysis have no row of the history and are not at rest, but for its end.
        moments = self.file.index("/dynamics/state", "state", "moment") if self.file.has("/dynamics") else []
        self.moving = {int(s) for s in moments if not self.states.event[s]}
        self.moving_contacts = MovingContacts(self.file) if self.file.has("/dynamics") else None
        # The last analysis may end when the scene asks for it: then it has no equilibrium.
        self.is_ended = self.scene.stop is not None and len(self.equilibria["time"]) <= sum(map(bool, self.states.event[moments]))
        self.moving |= set(range(int(moments[-1]), len(self.states.time))) if self.is_ended else set()
        self.is_at_rest = len(self.equilibria["time"]) > 0 or not self.file.has("/failure")
        self.row_time, self.row_event = self.file.numbers("/history/time", "time"), self.file.texts("/history/event", "time")
        self.points = self.file.texts("/history/point", "point")

    # Where a value is.

    def day(self, s):
        event = f', after "{self.states.event[s]}"' if self.states.event[s] else ""
        return f"day {self.states.time[s]:.6g}{event}"

    def in_state(self, dataset, s, places, what, numbers=None, beside=""):
        """Says where value i of a state is: numbers[i], or i itself, at one of the places; and what it was held against."""
        def where(i):
            n = i if numbers is None else int(numbers[i])
            x, y = places[n]
            return f"{dataset}[{s}, {n}]{beside and ' by ' + beside}: {what} {n} at [{x:.6g}, {y:.6g}] m, {self.day(s)}"
        return where

    def run(self):
        with np.errstate(all="ignore"):
            self.check_finite()
            self.check_mesh()
            self.check_excavation()
            for s in range(len(self.states.time)):
                self.check_kinematics(s)
                if s < self.n_small and self.is_at_rest:
                    self.check_stress(s)
                    self.check_joints(s)
                    self.check_equilibrium(s)
                else:
                    self.check_moving(s)
            for s in range(1, self.n_small):
                self.check_history_of_contacts(s)
                self.check_creep(s)
            self.check_points()
            self.check_times()
            self.check_names()
            self.check_report()
            if self.file.has("/safety"):
                self.check_safety()
            if self.file.has("/dynamics"):
                self.check_dynamics()
        self.say_what_is_left_out()
        return self.checks.report()

    def check_finite(self):
        for name in self.file.all_datasets():
            values = self.file.read(name)
            if values.dtype.kind != "f":
                continue
            wrong = ~np.isfinite(values)

            def where(i, name=name, shape=values.shape):
                return f"{name}{list(map(int, np.unravel_index(i, shape)))}"
            if values.size:
                self.checks.see("values are finite", "", wrong.ravel(), 0.5, where)

    def check_mesh(self):
        m, see = self.section, self.checks.see
        see("zones have an area, counter-clockwise", "m2", np.where(m.area > 0, 0, np.maximum(-m.area, 1e-300)), 0,
            lambda z: f"/mesh/gridpoint_position: zone {z}")
        sums = np.bincount(m.zone_block, m.area, len(m.block_area))
        rounding = np.bincount(m.zone_block, m.area + m.reach * m.perimeter, len(m.block_area))
        see("areas of a block's zones sum to its own", "m2", np.abs(sums - m.block_area),
            ROUNDING * (m.block_area + rounding), lambda b: f"/blocks/area[{b}] by /mesh/gridpoint_position")
        if len(m.edge):
            off = np.abs(norm(m.normal) - 1) + np.abs(cross(m.normal, m.normal_of_edge)) / m.edge_length + \
                np.where((m.normal * m.normal_of_edge).sum(axis=1) > 0, 0, 1)
            see("normals of contacts are those of their edges", "", off, ROUNDING * (1 + m.reach / m.edge_length),
                lambda c: f"/mesh/contact_normal[{c}]")
            sums = np.bincount(m.edge, m.length)
            lengths = np.zeros(len(sums))
            lengths[m.edge] = m.edge_length
            see("contacts are no longer than their edge", "m", np.where(sums > 0, sums - lengths, 0),
                ROUNDING * (lengths + m.reach), lambda e: f"/mesh/contact_length: on edge {e}")
            see("contacts have a length", "m", np.where(m.length > 0, 0, np.maximum(-m.length, 1e-300)), 0,
                lambda c: f"/mesh/contact_length[{c}]")

    def check_excavation(self):
        """Which stages have been excavated; zones go with their stage, and contacts with their zones."""
        m, st, see = self.section, self.states, self.checks.see
        self.gone = []  # for each state the last stage excavated so far
        last = -1
        for s in range(len(st.time)):
            if st.event[s] and st.event[s] in self.stage_names:
                last = max(last, self.stage_names.index(st.event[s]))
            elif self.scene.large_displacements and not st.present[s].all():
                last = max(last, int(m.zone_stage[~st.present[s]].max()))
            self.gone.append(last)
            expected = (m.zone_stage < 0) | (m.zone_stage > last)
            see("zones are removed by their stage, and no others", "", st.present[s] != expected, 0.5,
                self.in_state("/states/zone_present", s, m.zone_centre, "zone"))
            side_stage = np.where(m.edge_block >= 0, m.block_stage[m.edge_block], -1)[m.edge]
            lost_a_side = ((side_stage >= 0) & (side_stage <= last)).any(axis=1)
            see("contacts are removed with the rock of a side", "", (st.status[s] == REMOVED) != lost_a_side, 0.5,
                self.in_state("/states/contact_status", s, m.centre, "contact"))

    def leaders(self, s):
        """The gridpoint that holds the sums of each one: the lowest of those that ties hold together."""
        m = self.section
        leader = np.arange(len(m.position))

        def root(g):
            while leader[g] != g:
                g = leader[g]
            return g
        for (a, b), stage in zip(m.tie, m.tie_stage):
            if stage > self.gone[s]:
                low, high = sorted((root(a), root(b)))
                leader[high] = low
        for g in np.unique(m.tie):
            leader[g] = root(g)
        return leader

    def fixed_in(self, s):
        """1 for each gridpoint that is fixed in x, 2 in y, 3 in both: not where all rock on its boundary has been removed."""
        m, there = self.section, self.states.present[s][self.section.side_zone]
        by_boundaries, by_present = np.zeros((2, len(m.fixed)), int)
        ends = m.side if not m.is_quadratic else np.column_stack([m.side, m.side_middle])
        for number, boundary in enumerate(self.scene.boundaries):
            bits = sum(1 << axis for axis in (0, 1) if "xy"[axis] in boundary["fix"])
            on = m.side_boundary == number
            by_boundaries[ends[on]] |= bits
            by_present[ends[on & there]] |= bits
        return m.fixed & ~(by_boundaries & ~by_present)

    def on_rollers(self, s):
        """Gridpoints on rollers beside rock, and the normal: of each segment with fix = "normal"."""
        m = self.section
        ends = m.side if not m.is_quadratic else np.column_stack([m.side, m.side_middle])
        for number, boundary in enumerate(self.scene.boundaries):
            if boundary["normal"] is not None:
                yield np.unique(ends[(m.side_boundary == number) & self.states.present[s][m.side_zone]]), boundary["normal"]

    def check_kinematics(self, s):
        m, st, see = self.section, self.states, self.checks.see
        u = st.displacement[s]
        if s == 0:
            see("displacements count from the in-situ equilibrium", "m", norm(u), 0,
                self.in_state("/states/displacement", s, m.position, "gridpoint"))
        # Fixed gridpoints are where the boundaries put them; the last one counts. Where rock has been removed they stay.
        for axis in (0, 1):
            wanted = np.where(self.fixed_in(s) & (1 << axis), 0.0, np.nan)
            stays = np.zeros(len(wanted), bool)
            for number, boundary in enumerate(self.scene.boundaries):
                if boundary["displacement"] is None or "xy"[axis] not in boundary["fix"]:
                    continue
                value = (boundary["factor"](st.time[s]) - boundary["factor"](0.0)) * boundary["displacement"][axis]
                on = m.side_boundary == number
                there = st.present[s][m.side_zone]
                ends = m.side if not m.is_quadratic else np.column_stack([m.side, m.side_middle])
                stays[ends[on & ~there]] = True
                wanted[ends[on & there]] = value
            held = ~np.isnan(wanted) & ~stays
            see("fixed gridpoints are where supports hold them", "m", np.abs(u[held, axis] - wanted[held]),
                ROUNDING * (np.abs(wanted[held]) + m.reach * self.scene.large_displacements),
                self.in_state("/states/displacement", s, m.position, "gridpoint", np.flatnonzero(held)))
        for at, normal in self.on_rollers(s):
            see("gridpoints on rollers move along them", "m", np.abs(u[at] @ normal), ROUNDING * norm(u[at]),
                self.in_state("/states/displacement", s, m.position, "gridpoint", at))
        here = np.flatnonzero(st.status[s] != REMOVED)
        apart = (u[m.contact[:, 1]] - u[m.contact[:, 0]])[here]
        relative = np.stack([(apart * m.normal[here]).sum(axis=1), (apart * m.tangent[here]).sum(axis=1)], axis=1)
        scale = norm(u)[m.contact[here]].sum(axis=1)
        see("relative displacements are those of the gridpoints", "m", np.abs(relative - st.relative[s][here]).max(axis=1,
            initial=0), ROUNDING * scale,
            self.in_state("/states/relative_displacement", s, m.centre, "contact", here, "/states/displacement"))
        removed = ~st.present[s]
        see("removed zones have no stress", "Pa", np.abs(st.stress[s][removed]).max(axis=1, initial=0), 0,
            self.in_state("/states/stress", s, m.zone_centre, "zone", np.flatnonzero(removed)))
        nothing = np.flatnonzero((st.status[s] == OPEN) | (st.status[s] == REMOVED))
        see("open and removed contacts carry no traction", "Pa", np.abs(st.traction[s][nothing]).max(axis=1, initial=0), 0,
            self.in_state("/states/traction", s, m.centre, "contact", nothing))

    def strain(self, s):
        """Strain {xx, yy, 2 xy} of the zones, and the sum of the magnitudes that it is made of."""
        m = self.section
        u, b = self.states.displacement[s][m.node], m.gradient
        parts = [b[..., 0] * u[..., 0], b[..., 1] * u[..., 1], b[..., 1] * u[..., 0], b[..., 0] * u[..., 1]]
        strain = np.stack([parts[0].sum(axis=1), parts[1].sum(axis=1), (parts[2] + parts[3]).sum(axis=1)], axis=1)
        return strain, sum(np.abs(part).sum(axis=1) for part in parts)

    def check_stress(self, s):
        m, st, see = self.section, self.states, self.checks.see
        strain, terms = self.strain(s)
        offset = np.zeros_like(strain)  # what of it is crept or plastic, {xx, yy, 2 xy}
        across = np.zeros(len(strain))  # and its zz where that counts
        factors = np.array([1.0, 1.0, 2.0])
        # Crept strain is deviatoric; the solver takes 2 G times it off the stress.
        change = np.zeros_like(strain)
        change[st.creeping] = -2 * m.c33[st.creeping, None] * st.crept_strain[s]
        # The stress across the section shows the plastic strain there: zz = zz_0 - C11 e_zz + C12 (e_xx + e_yy).
        y = st.yielding
        offset[y] = factors * st.plastic[s]
        elastic = strain - offset
        across[y] = (m.c12[y] * (elastic[y, 0] + elastic[y, 1]) - (st.stress_zz[s] - st.stress_zz[0])) / m.c11[y]
        volume = elastic[:, 0] + elastic[:, 1] - across
        stress = st.stress[0] + change
        for i in (0, 1):
            stress[:, i] += (m.c11 - m.c12) * elastic[:, i] + m.c12 * volume
        stress[:, 2] += m.c33 * elastic[:, 2]
        scale = np.abs(st.stress[0]).max(axis=1) + np.abs(change).max(axis=1) + (m.c11 + m.c12) * (
            terms + np.abs(offset).sum(axis=1) + np.abs(across))
        off = np.abs(stress - st.stress[s]).max(axis=1)
        there = st.present[s]
        if m.is_quadratic:
            self.check_stress_points(s)
        yields = np.zeros(len(there), bool)
        yields[y] = True
        for chosen, name, beside in (
                (there & ~yields, "stress of elastic zones is Hooke's", "/states/displacement, /states/crept_strain"),
                (there & yields, "stress of yielding zones is Hooke's, less plastic strain",
                 "/states/displacement, /states/plastic_strain, /states/stress_zz")):
            see(name, "Pa", off[chosen], ROUNDING * scale[chosen],
                self.in_state("/states/stress", s, m.zone_centre, "zone", np.flatnonzero(chosen), beside))
        if len(y):
            chosen = there[y]
            xx, yy, xy = st.stress[s][y].T
            mean, radius = (xx + yy) / 2, np.hypot((xx - yy) / 2, xy)
            high, low = np.maximum(mean + radius, st.stress_zz[s]), np.minimum(mean - radius, st.stress_zz[s])
            beyond = np.maximum(m.n_phi[y] * high - low - m.uniaxial[y], high - m.tension[y])
            # The solver calls less than 1e-10 of it rounding.
            see("stress is within Mohr and Coulomb's strength", "Pa", beyond[chosen],
                (1e-10 + ROUNDING) * (np.abs(high) + np.abs(low) + m.uniaxial[y])[chosen],
                self.in_state("/states/stress", s, m.zone_centre, "zone", y[chosen], "/states/stress_zz"))
        if s == 0:
            see("nothing has crept or yielded at the in-situ equilibrium", "", np.abs(np.concatenate(
                [st.crept_strain[0].ravel(), st.plastic[0].ravel()])), 0,
                lambda i: "/states/crept_strain[0]" if i < st.crept_strain[0].size else "/states/plastic_strain[0]")

    def check_stress_points(self, s):
        """The stress points of quadratic zones: their mean is the zone's stress, and elastic ones follow Hooke's law."""
        m, st, see = self.section, self.states, self.checks.see
        stress = st.stress_at_points(s)
        size = np.abs(stress).max(axis=(1, 2))
        there = np.flatnonzero(st.present[s])
        where = self.in_state("/states/point_stress", s, m.zone_centre, "zone", there, "/states/stress")
        see("stresses at points have the zone's mean", "Pa", np.abs(stress.mean(axis=1) - st.stress[s]).max(axis=1)[there],
            ROUNDING * size[there], where)
        special = np.zeros(len(m.zone), bool)
        special[st.yielding] = special[st.creeping] = True
        u, b = st.displacement[s][m.node][:, None], m.slopes
        parts = [b[..., 0] * u[..., 0], b[..., 1] * u[..., 1], b[..., 1] * u[..., 0] + b[..., 0] * u[..., 1]]
        xx, yy, xy = (part.sum(axis=2) for part in parts)
        c11, c12, c33 = (c[:, None] for c in (m.c11, m.c12, m.c33))
        change = np.stack([c11 * xx + c12 * yy, c12 * xx + c11 * yy, c33 * xy], axis=2)
        off = np.abs(st.stress_at_points(0) + change - stress).max(axis=(1, 2))
        terms = sum(np.abs(part).sum(axis=2) for part in parts).max(axis=1)
        chosen = there[~special[there]]
        see("stress at points of elastic zones is Hooke's", "Pa", off[chosen], (ROUNDING * (
            size + np.abs(st.stress_at_points(0)).max(axis=(1, 2)) + (m.c11 + m.c12) * terms))[chosen],
            self.in_state("/states/point_stress", s, m.zone_centre, "zone", chosen, "/states/displacement"))

    def opening_at_start(self):
        """Of every contact: its gap in situ, or minus the closure of its spring."""
        m, st = self.section, self.states
        normal = st.traction[0, :, 0]
        closed = np.where(m.is_barton_bandis(), -m.closure(-normal), normal / m.k_n)
        return np.where(st.status[0] == OPEN, st.initial_gap, closed)

    def check_joints(self, s):
        m, st, see = self.section, self.states, self.checks.see
        status, traction, broken = st.status[s], st.traction[s], st.broken[s]
        closed = (status == STUCK) | (status == SLIPPING)
        here = status != REMOVED
        bb = m.is_barton_bandis()
        spring = st.relative[s] - st.crept[s]
        spring[:, 0] -= st.dilation[s]
        spring[:, 1] -= st.slip[s]
        size = np.abs(st.relative[s]) + np.abs(st.crept[s]) + np.stack([st.dilation[s], np.abs(st.slip[s])], axis=1)
        opening_0 = self.opening_at_start()
        opening = opening_0 + spring[:, 0]
        p = np.maximum(-traction[:, 0], 0)
        p_0 = np.maximum(-st.traction[0, :, 0], 0)

        def at(dataset, chosen, beside=""):
            return self.in_state(dataset, s, m.centre, "contact", np.flatnonzero(chosen), beside)

        # Springs. A Barton-Bandis joint is k_n (1 + p / (k_n V_m))^2 stiff, and rounding of a displacement counts so often.
        stiff = np.where(bb, m.k_n * (1 + np.minimum(np.maximum(p, p_0), m.wall) / (m.k_n * m.largest_closure)) ** 2, m.k_n)
        normal = np.where(bb, -m.pressure(-opening), m.k_n * opening)
        rounding_n = ROUNDING * (np.abs(traction[:, 0]) + np.abs(st.traction[0, :, 0]) +
                                 stiff * (size[:, 0] + np.abs(opening_0)))
        see("normal traction is that of the springs' closing", "Pa", np.abs(normal - traction[:, 0])[closed],
            rounding_n[closed], at("/states/traction", closed,
                                   "/states/relative_displacement, /states/crept, /states/dilation, /states/initial_gap"))
        shear = st.traction[0, :, 1] + m.k_s * spring[:, 1]
        # A traction may be the difference of two that cancel but for their last digits.
        rounding_s = ROUNDING * (np.abs(st.traction[0, :, 1]) + m.k_s * size[:, 1] + ROUNDING * np.abs(traction).max(initial=0))
        sheared = here & ((m.k_s > 0) | closed)
        see("shear traction is that of the springs, less slip", "Pa", np.abs(shear - traction[:, 1])[sheared],
            rounding_s[sheared], at("/states/traction", sheared,
                                    "/states/relative_displacement, /states/crept, /states/slip"))
        is_open = status == OPEN
        see("open contacts have a gap", "m", -opening[is_open], (rounding_n / stiff)[is_open],
            at("/states/contact_status", is_open, "/states/relative_displacement, /states/initial_gap"))
        if s == 0:
            see("gaps in situ are of open contacts alone", "m", np.where(is_open, 0, np.abs(st.initial_gap)), 0,
                lambda c: f"/states/initial_gap[{c}]")
            counted = np.abs(st.slip[0]) + np.abs(st.dilation[0]) + np.abs(st.crept[0]).sum(axis=1)
            least = np.divide(ROUNDING * norm(traction), m.k_s, out=np.zeros_like(m.k_s), where=m.k_s > 0)  # by rounding
            see("nothing has slipped, dilated or crept at the in-situ equilibrium", "m", counted, least,
                lambda c: f"/states/slip, dilation or crept[0, {c}]")

        # Strength.
        limit = m.strength(traction[:, 0], broken)
        slope = np.maximum(np.maximum(m.tan_phi, m.residual_tan_phi), np.where(bb, np.tan(70 * DEGREE), m.initial_tan_phi))
        rounding = rounding_s + slope * rounding_n + ROUNDING * m.cohesion
        tau = np.abs(traction[:, 1])
        see("shear traction is within the strength", "Pa", (tau - limit)[closed], rounding[closed],
            at("/states/traction", closed, "/states/bond_broken"))
        tension = np.where(broken | bb | (m.law == YIELDING), 0.0, m.strength_in_tension)
        see("normal traction is within the tensile strength", "Pa", (traction[:, 0] - tension)[closed], rounding_n[closed],
            at("/states/traction", closed, "/states/bond_broken"))
        known = m.law != YIELDING  # whose strength is between two bounds
        stuck = (status == STUCK) & known & (traction[:, 1] != 0)
        see("sticking contacts are below their strength", "Pa", (tau - (1 - AT_STRENGTH) * limit)[stuck], rounding[stuck],
            at("/states/contact_status", stuck, "/states/traction"))
        slips = status == SLIPPING
        least = np.where(known, (1 - AT_STRENGTH) * limit, 0.999 * p * m.tan_phi)
        see("slipping contacts are at their strength", "Pa", (least - tau)[slips], rounding[slips],
            at("/states/contact_status", slips, "/states/traction"))

        # Bonds, dilation.
        bonded = np.isin(m.law, (COULOMB, RESIDUAL, WEARING))
        breaks = is_open | ((m.law == RESIDUAL) & (st.slip[s] != 0))
        must = here & bonded & breaks
        see("bonds of contacts that opened, or slipped with a residual strength, are broken", "", ~broken[must], 0.5,
            at("/states/bond_broken", must, "/states/contact_status, /states/slip"))
        see("only joints that dilate have dilation", "m", np.abs(st.dilation[s])[here & ~(m.tan_psi > 0)], 0,
            at("/states/dilation", here & ~(m.tan_psi > 0)))
        ends = here & (m.tan_psi > 0) & (m.dilation_until > 0)
        most = m.tan_psi * m.dilation_until
        see("dilation ends", "m", (st.dilation[s] - most)[ends], ROUNDING * most[ends], at("/states/dilation", ends))

    def check_history_of_contacts(self, s):
        m, st, see = self.section, self.states, self.checks.see
        here = st.status[s] != REMOVED
        if not self.is_at_rest:
            return

        def at(dataset, chosen, beside=""):
            return self.in_state(dataset, s, m.centre, "contact", np.flatnonzero(chosen), beside)
        see("broken bonds stay broken", "", (st.broken[s - 1] & ~st.broken[s])[here], 0.5, at("/states/bond_broken", here))
        more = st.dilation[s] - st.dilation[s - 1]
        scale = np.abs(st.dilation[s]) + np.abs(st.slip[s]) + np.abs(st.slip[s - 1])
        see("dilation does not go back", "m", -more[here], ROUNDING * scale[here], at("/states/dilation", here))
        # While a joint stays closed, every slip dilates it: Coulomb's by tan(psi) times the slip at least.
        until = np.where(m.dilation_until > 0, m.tan_psi * m.dilation_until, np.inf)
        slip = np.abs(st.slip[s] - st.slip[s - 1])
        least = np.minimum(m.tan_psi * slip, until - st.dilation[s - 1])
        coulomb = here & (m.law == COULOMB) & (m.tan_psi > 0) & ~st.broken[s]
        see("slip dilates", "m", (least - more)[coulomb], ROUNDING * scale[coulomb], at("/states/dilation", coulomb, "/states/slip"))

    # Creep of joints: d' = (F - E d) / eta of each unit, during a step F = F_0 + (F_1 - F_0) phi.

    def weights(self, stiffness, viscosity, spring, days, scheme):
        """decay, first and last of d_1 = decay d_0 + first F_0 + last F_1 of each unit in a step."""
        time = 86400 * days
        is_unit = viscosity > 0
        fluidity = np.divide(1.0, viscosity, out=np.zeros_like(viscosity), where=is_unit)
        rate = spring * fluidity.sum(axis=1) + (stiffness * fluidity**2).sum(axis=1) / fluidity.sum(axis=1)
        x, r = stiffness * fluidity * time, np.broadcast_to((rate * time)[:, None], stiffness.shape)
        x, r = np.minimum(x, 1e12), np.minimum(r, 1e12)
        flow = np.where(stiffness > 0, x / np.where(stiffness > 0, stiffness, 1), fluidity * time)

        def mean_decay(y):
            return np.where(y == 0, 1, -np.expm1(-y) / np.where(y == 0, 1, y))

        def exactly(phi):  # the mean of exp(-x (1 - s)) phi(s) where neither x nor r is large
            points, weight = np.polynomial.legendre.leggauss(48)
            return sum(w / 2 * np.exp(-x * (1 - s)) * phi(s) for s, w in zip((points + 1) / 2, weight))
        whole = mean_decay(x)
        if scheme == "published":
            last = 0 * x
        elif scheme == "backward":
            last = whole
        else:
            large = np.maximum(x, 20)
            straight_of_large = (1 - mean_decay(large)) / large
            straight = np.where(x < 20, exactly(lambda s: s), straight_of_large)
            if scheme == "linear force":
                last = straight
            elif scheme == "fitted":
                closed = (whole - np.exp(-np.minimum(x, r)) * mean_decay(np.abs(x - r))) / -np.expm1(-r)
                near = exactly(lambda s: np.where(r == 0, s, np.expm1(-r * s) / np.expm1(-np.where(r == 0, 1, r))))
                nearly_straight = straight_of_large + r / 2 * (straight_of_large - (1 - 2 * straight_of_large) / large)
                last = np.where((x < 20) & (r < 20), near, np.where(r < 1e-5, nearly_straight, closed))
            else:
                raise NotWanted(f'{self.scene.place}: creep scheme "{scheme}" is not known')
        return np.exp(-x), flow * (whole - last), flow * last

    def check_creep(self, s):
        m, st, see = self.section, self.states, self.checks.see
        if not self.is_at_rest:
            return
        here = st.status[s] != REMOVED
        days = st.time[s] - st.time[s - 1]
        times = self.equilibria["time"]
        is_one_step = not ((times > st.time[s - 1]) & (times < st.time[s])).any()
        for axis, direction in enumerate(("normal", "shear")):
            spring = m.k_n if axis == 0 else m.k_s
            stiffness, viscosity = m.units[direction]
            creeps = (viscosity > 0).any(axis=1) & (spring > 0) & self.scene.creeps
            still = here & ~creeps if days > 0 else here
            see("only joints with Kelvin units or dashpots creep, and only in time", "m",
                np.abs(st.crept[s] - st.crept[s - 1])[still, axis], 0,
                self.in_state("/states/crept", s, m.centre, "contact", np.flatnonzero(still)))
            moving = np.flatnonzero(here & creeps)
            if not len(moving) or days <= 0:
                continue
            # What each unit has crept; of several the file has the sum, but they are known while all steps are.
            units = self.unit_crept.setdefault(direction, np.zeros(stiffness.shape))
            single = (viscosity > 0).sum(axis=1) == 1
            units[single] = np.where(viscosity[single] > 0, st.crept[s - 1][single, axis, None], 0)
            if not is_one_step:
                self.all_steps_known = False
            if not is_one_step or not (self.all_steps_known or single[moving].all()):
                self.checks.leave_out("displacement that joints have crept, where the file has no state between creep steps "
                                      "(demsolve --states 1 records all)")
            if not is_one_step:
                continue
            if not self.all_steps_known:
                moving = moving[single[moving]]
            scheme = self.scene.scheme_between(st.time[s - 1], st.time[s])
            decay, first, last = self.weights(stiffness[moving], viscosity[moving], spring[moving], days, scheme)
            since = st.traction[:, moving, axis, None] - st.traction[0, moving, axis, None]
            parts = [decay * units[moving], first * since[s - 1], last * since[s]]
            units[moving] = sum(parts)
            # Rounding of tractions, which the change since the start is small beside; the closed form loses some digits.
            force = np.abs(st.traction[0, moving, axis, None]) + np.abs(since[s]) + np.abs(since[s - 1])
            scale = (sum(np.abs(part) for part in parts) * 1e-9 + (first + last) * ROUNDING * force).sum(axis=1)
            see("crept displacement of a step is that of the Kelvin units and dashpots", "m",
                np.abs(units[moving].sum(axis=1) - st.crept[s][moving, axis]),
                scale + ROUNDING * np.abs(st.crept[s][moving, axis]),
                self.in_state("/states/crept", s, m.centre, "contact", moving, "/states/traction"))

    # Equilibrium.

    def stiffest_row(self, s):
        """Largest sum of the magnitudes in a row of the stiffness matrix."""
        m = self.section
        sums = np.zeros((len(m.position), 2))
        b, c11, c12, c33 = m.slopes, m.c11[:, None, None], m.c12[:, None, None], m.c33[:, None, None]
        for i in range(m.node.shape[1]):
            p = b[:, :, i, None, :]
            x = np.abs(c11 * p[..., 0] * b[..., 0] + c33 * p[..., 1] * b[..., 1]) + \
                np.abs(c12 * p[..., 0] * b[..., 1] + c33 * p[..., 1] * b[..., 0])
            y = np.abs(c12 * p[..., 1] * b[..., 0] + c33 * p[..., 0] * b[..., 1]) + \
                np.abs(c11 * p[..., 1] * b[..., 1] + c33 * p[..., 0] * b[..., 0])
            row = m.area[:, None] * np.stack([x.sum(axis=2).mean(axis=1), y.sum(axis=2).mean(axis=1)], axis=1)
            np.add.at(sums, m.node[self.states.present[s], i], row[self.states.present[s]])
        n, t = np.abs(m.normal), np.abs(m.tangent)
        row = 2 * m.length[:, None] * (m.k_n[:, None] * n * n.sum(axis=1)[:, None] + m.k_s[:, None] * t * t.sum(axis=1)[:, None])
        for side in (0, 1):
            np.add.at(sums, m.contact[:, side], row)
        return sums.max()

    def loads(self, s):
        """Weight, and tractions on the outline, on every gridpoint."""
        m, st = self.section, self.states
        load, applied = np.zeros((len(m.position), 2)), np.zeros((len(m.position), 2))
        there = st.present[s]
        for i in (-3, -2, -1):  # on all gridpoints of a zone, or on the middles of its sides
            np.add.at(load[:, 1], m.node[there, i], -m.weight[there] / 3)
        for number, boundary in enumerate(self.scene.boundaries):
            if boundary["traction"] is None:
                continue
            on = (m.side_boundary == number) & there[m.side_zone]
            ends = m.side[on]
            length = norm(m.position[ends[:, 1]] - m.position[ends[:, 0]])
            whole = boundary["factor"](st.time[s]) * length[:, None] * boundary["traction"]
            for end in (0, 1):
                np.add.at(applied, ends[:, end], whole / (6 if m.is_quadratic else 2))
            if m.is_quadratic:
                np.add.at(applied, m.side_middle[on], whole * 4 / 6)
        return load, applied

    def zone_forces(self, s, slopes, area):
        """Gridpoints and the forces that present zones exert on them, for each stress point and gridpoint of a zone."""
        m, st = self.section, self.states
        there, points = st.present[s], slopes.shape[1]
        for point in range(points):
            xx, yy, xy = st.stress_at_points(s)[there, point].T
            for i in range(m.node.shape[1]):
                bx, by = slopes[there, point, i].T
                yield m.node[there, i], -area[there, None] / points * np.stack([xx * bx + xy * by, xy * bx + yy * by], axis=1)

    def check_whole(self, s, allowed):
        """The balance of all rock."""
        load, applied = self.loads(s)
        whole = (load + applied + self.states.reaction[s]).sum(axis=0)
        self.checks.see("weight and tractions are held by reactions and ground", "N/m", norm(whole), allowed,
                        lambda _: f"/states/reaction[{s}]: sum over all gridpoints, {self.day(s)}")

    def check_equilibrium(self, s):
        m, st, see = self.section, self.states, self.checks.see
        n = len(m.position)
        force, magnitude = np.zeros((n, 2)), np.zeros(n)

        def add(gridpoints, forces):
            np.add.at(force, gridpoints, forces)
            np.add.at(magnitude, gridpoints, norm(forces))
        there = st.present[s]
        load, applied = self.loads(s)
        force += load + applied
        magnitude += norm(load) + norm(applied)
        for gridpoints, forces in self.zone_forces(s, m.slopes, m.area):
            add(gridpoints, forces)
        on_a = m.length[:, None] * (st.traction[s][:, :1] * m.normal + st.traction[s][:, 1:] * m.tangent)
        add(m.contact[:, 0], on_a)
        add(m.contact[:, 1], -on_a)
        mean = magnitude[magnitude > 0].mean() if (magnitude > 0).any() else 0.0

        leader = self.leaders(s)
        follows = np.flatnonzero(leader != np.arange(n))
        fixed = self.fixed_in(s)
        held = np.zeros((n, 2, 2))  # sum of n n' over directions n in which a gridpoint does not move
        for axis in (0, 1):
            held[:, axis, axis] = (fixed >> axis) & 1
        for at, normal in self.on_rollers(s):
            held[at] += np.outer(normal, normal)
        has_rock = ~m.has_zones
        has_rock[m.node[there]] = True
        held[~has_rock] = np.eye(2)
        carried = magnitude.copy()
        for f in follows:
            force[leader[f]] += force[f]
            force[f] = 0
            carried[leader[f]] += magnitude[f]
            held[leader[f]] += held[f]
        held, direction = np.linalg.eigh(held)
        free = held < 1e-12  # these directions
        free_part = lambda of: (direction @ (free * (of[:, None] @ direction)[:, 0])[..., None])[..., 0]
        reaction = st.reaction[s]
        rounding = ROUNDING * carried
        see("reactions hold the forces on fixed gridpoints, and there are no others", "N/m",
            norm(reaction + force - free_part(force)), rounding,
            self.in_state("/states/reaction", s, m.position, "gridpoint", beside="/states/stress, /states/traction"))
        # What is below the rounding of stiffness times displacement is in balance.
        tolerance = self.scene.tolerance
        unbalanced = norm(free_part(force))
        floor = 1e-15 * self.stiffest_row(s) / tolerance  # times a displacement
        worst = int(np.argmax(np.where(np.isnan(unbalanced), np.inf, unbalanced)))
        base = max(mean, floor * norm(st.displacement[s]).max())
        ratio = unbalanced[worst] / base if base > 0 else unbalanced[worst]
        rounding = ROUNDING * (1 + magnitude.max() / base) if base > 0 else 0.0
        # The report is of the last equilibrium before the last state of a time. It may count displacements on the way, which
        # are a tenth of the section at most.
        before = np.flatnonzero(self.equilibria["time"] <= st.time[s])
        is_last = s + 1 == len(st.time) or st.time[s + 1] > st.time[s]
        # A stage that fails may have found equilibria under a part of its load, which have no states.
        if s + 1 == len(st.time) and self.file.has("/failure") and len(before):
            is_last = self.equilibria["time"][before[-1]] < st.time[s]
        if len(before) and is_last and not self.scene.has_dashpots and mean > floor * m.size / 10:
            reported = self.equilibria["unbalanced_force_ratio"][before[-1]]
            see("unbalanced force ratio is the reported one", "", abs(ratio - reported), 1e-9 * tolerance + rounding,
                lambda _: f"/equilibria/unbalanced_force_ratio[{before[-1]}], {self.day(s)}")
        see("forces are in equilibrium: unbalanced force ratio", "", ratio, tolerance * (1 + 1e-9) + rounding,
            lambda _: self.in_state("/states/stress", s, m.position, "gridpoint", beside="/states/traction and /mesh")(worst))
        self.mean_in_situ = mean if s == 0 else self.mean_in_situ
        self.check_whole(s, tolerance * base * np.count_nonzero(free.any(axis=1)) + ROUNDING * magnitude.sum())

    def check_moving(self, s):
        """What holds at large displacements."""
        m, st = self.section, self.states
        corner = (m.position + st.displacement[s])[m.zone]
        area, slopes = linear_shapes(corner)
        chosen = np.flatnonzero(st.present[s])
        self.checks.see("displaced zones have an area, counter-clockwise", "m2", np.where(area > 0, 0, np.maximum(
            -area, 1e-300))[chosen], 0, self.in_state("/states/displacement", s, m.zone_centre, "zone", chosen))
        if not self.is_at_rest:
            return
        self.check_moving_stress(s, np.stack([corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]], axis=-1))
        if s not in self.moving:  # the largest mean force so far counts, as the in-situ one
            self.check_whole(s, (self.scene.tolerance + ROUNDING) * self.mean_in_situ * len(m.position))
            self.check_pieces(s, slopes[:, None], area)

    def without_first_rotation(self, stress, rotation):
        """Stress that is off, without what a rotation a of a block makes which is not in the file, as it comes from the in-situ equilibrium
        that is found again: the displacements of a further rotation b then look like the strain -a b in all directions."""
        m = self.section
        of_unit = m.stress_of(np.broadcast_to(np.eye(2), stress.shape))[:, 0, 0]
        blocks, zone_area = len(m.rigid_block), m.area
        area = np.bincount(m.zone_block, zone_area, blocks)
        strain = np.bincount(m.zone_block, zone_area * np.trace(stress, axis1=1, axis2=2) / 2 / of_unit, blocks) / area
        turned = np.abs(np.bincount(m.zone_block, zone_area * np.arctan2(rotation[:, 1, 0], rotation[:, 0, 0]), blocks) / area)
        strain = np.clip(strain, -FIRST_ROTATION * turned, FIRST_ROTATION * turned)
        return stress - (strain[m.zone_block] * of_unit)[:, None, None] * np.eye(2)

    def check_moving_stress(self, s, edges):
        """Elastic zones: Biot's stress is Hooke's of Biot's strain U - 1, where R U takes edges without stress to the present ones
        (two of each zone, as columns). Those without stress follow from the first state, but for a rotation, which changes nothing."""
        m, st = self.section, self.states
        if s == 1:
            stress = in_matrices(st.stress[1])
            stretch = np.broadcast_to(np.eye(2), stress.shape)
            for _ in range(30):  # converges by the strain in each step
                biot = np.linalg.det(stretch)[:, None, None] * stress @ inverse(stretch)
                stretch = np.eye(2) + m.strain_of(biot)
            self.to_no_stress, self.to_first = inverse(inverse(stretch) @ edges), inverse(edges)
            self.moved_before = NOT_IN_FILE * np.abs(m.strain_of(stress - in_matrices(st.stress[0]))[st.present[1]]).max(initial=0)
        gradient = edges @ self.to_no_stress
        rotation, stretch = polar(gradient)
        stress = rotation @ m.stress_of(stretch - np.eye(2)) @ stretch @ rotation.transpose(0, 2, 1) / \
            np.linalg.det(gradient)[:, None, None]
        chosen = st.present[s] & ~m.rigid_block[m.zone_block]
        chosen[st.yielding] = False
        chosen = np.flatnonzero(chosen)
        if len(chosen):
            off = np.abs(self.without_first_rotation(stress - in_matrices(st.stress[s]), rotation))[chosen].max(axis=(1, 2))
            moved = np.abs(edges @ self.to_first - np.eye(2)).max(axis=(1, 2))
            allowed = m.c11 * (self.moved_before * moved + 2e-15 * m.reach * m.perimeter / m.area)
            self.checks.see("displaced elastic zones: stress is Hooke's of the stretch", "Pa", off, allowed[chosen],
                self.in_state("/states/stress", s, m.zone_centre, "zone", chosen, "/states/displacement"))

    def check_pieces(self, s, slopes, area):
        """Equilibrium in displaced positions: of gridpoints that no contact can reach, and of all rock that hangs together. slopes and
        area: those of displaced zones."""
        m, st, see = self.section, self.states, self.checks.see
        n, leader, there = len(m.position), self.leaders(s), st.present[s]
        load, applied = self.loads(s)
        force, magnitude = load + applied + st.reaction[s], norm(load) + norm(applied)
        for gridpoints, forces in self.zone_forces(s, slopes, area):
            np.add.at(force, gridpoints, forces)
            np.add.at(magnitude, gridpoints, norm(forces))
        sums, carried = np.zeros((n, 2)), np.bincount(leader, magnitude, n)
        np.add.at(sums, leader, force)
        zone = leader[m.zone[there]]
        sides = np.sort(np.concatenate([zone[:, [0, 1]], zone[:, [1, 2]], zone[:, [2, 0]]]), axis=1)
        sides, count = np.unique(sides, axis=0, return_counts=True)
        inside = np.zeros(n, bool)
        inside[zone] = True
        inside[sides[count == 1]] = False
        rigid = m.rigid_block[m.zone_block[there]]
        inside[zone[rigid]] = False
        # On gridpoints of faces contacts carry what is missing.
        mean = (carried + np.where(inside, 0, norm(sums)))[carried > 0].mean() if (carried > 0).any() else 0.0
        allowed = MOVING_FORCE * self.scene.tolerance * mean
        of_place = 1e-15 * self.stiffest_row(s) * m.reach  # force by rounding of positions
        rounding = ROUNDING * carried + of_place
        at = np.flatnonzero(inside)
        rows = self.moving_contacts.of_state(s) if self.moving_contacts else None
        see("displaced gridpoints without contacts are in equilibrium", "N/m", norm(sums)[at],
            allowed + rounding[at],
            self.in_state("/states/stress", s, m.position, "gridpoint", at, "/states/displacement"))

        if rows is None:
            self.checks.leave_out("contacts of states at large displacements that are at no moment of a dynamic analysis")
            return
        piece = np.arange(n)  # the lowest gridpoint that it hangs together with
        while True:
            lowest = piece[sides].min(axis=1)
            before = piece.copy()
            np.minimum.at(piece, sides.ravel(), np.repeat(lowest, 2))
            piece = piece[piece]
            if (piece == before).all():
                break
        of_block = np.full(len(m.block_area), -1)
        of_block[m.zone_block[there]] = piece[zone[:, 0]]
        whole, parts = np.zeros((n, 2)), np.bincount(piece[leader], magnitude, n)
        np.add.at(whole, piece[leader], force)
        contacts, on_a = self.moving_contacts, self.moving_contacts.force_on_a(rows)
        for side, sign in ((0, 1), (1, -1)):
            block = contacts.block[rows, side]
            if (of_block[block[block >= 0]] < 0).any():
                raise NotWanted(f"{self.file.path}: /dynamics/contact_block: has a block that has been removed, {self.day(s)}")
            np.add.at(whole, of_block[block[block >= 0]], sign * on_a[block >= 0])
            np.add.at(parts, of_block[block[block >= 0]], norm(on_a[block >= 0]))
        which = np.unique(piece[zone])
        size = np.bincount(piece[np.unique(zone)], minlength=n)[which]
        see("displaced pieces of rock are in equilibrium with their contacts", "N/m", norm(whole)[which], allowed * size +
            ROUNDING * parts[which] + of_place * size,
            lambda i: f"/dynamics/contact_traction by /states/reaction and weight: piece of rock at [{m.position[which[i], 0]:.6g}, "
            f"{m.position[which[i], 1]:.6g}] m, {self.day(s)}")

    # Histories and reports.

    def check_points(self):
        """Histories are the states' displacements at the points, where there is a state of a row's time."""
        m, st, file = self.section, self.states, self.file
        time, event, names = self.row_time, self.row_event, self.points
        places = file.numbers("/history/point_position", "point", 2)
        history = file.numbers("/history/displacement", "time", "point", 2)
        present = file.index("/history/present", 2, "time", "point")
        # Cutting may have moved the face that a point lies on by so much.
        cutting, zones = self.scene.table("cutting", {}), self.scene.table("zones")
        shortest = self.scene.number(cutting, "shortest_edge_m", 0.02 * self.scene.number(zones, "size_m"))
        self.checks.see("displacement of removed points is held", "m", np.where(present[1:] == 0, norm(
            history[1:] - history[:-1]), 0), 0, lambda i: f"/history/displacement[{i // max(len(names), 1) + 1}, "
            f"{i % max(len(names), 1)}]")
        corner = m.position[m.zone]
        side = np.roll(corner, -2, axis=1) - np.roll(corner, -1, axis=1)
        stages_of_rows, stages_of_states = (np.cumsum([bool(name) for name in names]) for names in (event, st.event))
        unmatched = set(range(len(time)))
        for p, place in enumerate(places):
            share = np.stack([cross(side[:, i], place - np.roll(corner, -1, axis=1)[:, i]) for i in range(3)], axis=1) / \
                (2 * m.area)[:, None]
            outside = np.maximum(-share * (2 * m.area)[:, None] / norm(side), 0).max(axis=1)
            near = np.flatnonzero(outside <= max(1e-6 * m.size, shortest))
            for s in range(len(st.time)):
                if s in self.moving:
                    continue
                # A run that failed keeps its last state once more, without the name of the stage.
                rows = np.flatnonzero((time == st.time[s]) & (stages_of_rows == stages_of_states[s]) &
                                      ((event == st.event[s]) | (st.event[s] == "")))
                unmatched -= set(rows)
                rows = [row for row in rows if present[row, p]]
                if not rows:
                    continue
                zones = near[st.present[s][near]]
                if not len(zones):
                    self.checks.see("points are where there is rock", "", [1.0], 0.5,
                                    lambda _, s=s, p=p, row=rows[0]: f"/history/present[{row}, {p}]: point {names[p]}")
                    continue
                shape = share[zones]
                if m.is_quadratic:
                    after = np.roll(np.arange(3), -1)
                    shape = np.concatenate([shape * (2 * shape - 1), 4 * shape * shape[:, after]], axis=1)
                u = (shape[:, :, None] * st.displacement[s][m.node[zones]]).sum(axis=1)
                off = norm(history[rows][:, p][:, None, :] - u[None]).min()
                self.checks.see("histories are the states' displacements at the points", "m", off,
                                ROUNDING * norm(st.displacement[s][m.node[zones]]).max() * (
                                    1 + np.abs(share[zones]).max() * m.reach / np.sqrt(m.area[zones].min())),
                                lambda _, s=s, p=p, row=rows[0]: f"/history/displacement[{row}, {p}]: point {names[p]}, "
                                f"{self.day(s)}")
        if unmatched and len(places):
            self.checks.leave_out(f"{len(unmatched)} of {len(time)} rows of the history, which have no state of their time")

    def check_times(self):
        """Times do not go back, are within the schedule, and each stage is on its day; states have a row of the history."""
        st, scene = self.states, self.scene
        schedule = scene.table("schedule")
        end = scene.day(schedule["end"], "end") if "end" in schedule else np.inf
        days = {stage.get("name"): scene.day(stage.get("date"), "date") for stage in scene.list("stage")}
        event = {"history": self.row_event, "states": st.event}
        times = {"history": self.row_time, "states": st.time}
        for group, time in (*times.items(), ("equilibria", self.equilibria["time"])):
            self.checks.see("times do not go back", "day", np.maximum(0, time[:-1] - time[1:]), 0,
                            lambda i, group=group: f"/{group}/time[{i + 1}]")
            self.checks.see("times are within the schedule", "day", np.maximum(np.maximum(-time, time - end), 0), ROUNDING * abs(end),
                            lambda i, group=group: f"/{group}/time[{i}]")
        for group, names in event.items():
            rows = np.flatnonzero([bool(name) for name in names])
            known = [days.get(name) for name in names[rows]]
            self.checks.see("stages are those of the scene, in its order", "", [
                one is None or list(days).index(name) < i * (group == "history") or name in names[rows[:i]]
                for i, (name, one) in enumerate(zip(names[rows], known))], 0.5,
                lambda i, group=group, rows=rows, names=names: f'/{group}/event[{rows[i]}]: "{names[rows[i]]}"')
            self.checks.see("stages are on their days", "day", [abs(times[group][row] - day) for row, day in zip(rows, known) if day is not None],
                            ROUNDING * abs(end), lambda i, group=group: f"/{group}/time, stage {i}")
        at_rest = [s for s in range(len(st.time)) if s not in self.moving]
        self.checks.see("states have a row of the history", "", ~np.isin(st.time[at_rest], times["history"]), 0.5,
                        lambda i: f"/states/time[{at_rest[i]}]")

    def check_names(self):
        """Monitoring points are those of the scene, and their first readings are on its days."""
        scene = self.scene
        wanted = [(point, str(point.get("name"))) for point in scene.list("point")]
        for line in scene.list("monitoring_line"):
            wanted += [(line, f"{line.get('name')} {i + 1}") for i in range(int(scene.number(line, "points", 0)))]
        self.checks.see("monitoring points are those of the scene", "", [one != name for one, (_, name) in zip(self.points, wanted)] +
                        [len(self.points) != len(wanted)], 0.5, lambda i: f"/history/point[{i}]")
        time, first = self.row_time, self.file.array("/history/first_reading_row", "i", "point")
        for p, (row, (point, _)) in enumerate(zip(first, wanted)):
            day = scene.day(point["first_reading"], "first_reading") if "first_reading" in point else 0.0
            if 0 <= row < len(time) and day <= time[-1]:  # else it was not reached
                self.checks.see("first readings are on their days", "day", abs(time[row] - day), ROUNDING * max(1.0, abs(day)),
                                lambda _, p=p: f"/history/first_reading_row[{p}]")

    def check_safety(self):
        """The factor of this run is one of those tried, and ended as they say; stable factors are below the others."""
        file, st = self.file, self.states
        factor = file.numbers("/safety/factor", "trial")
        stands = file.array("/safety/stands", "i", "trial")
        largest = file.numbers("/safety/largest_displacement", "trial")
        stable, unstable = factor[stands == 1], factor[stands == 0]
        if len(stable) and len(unstable):
            self.checks.see("stable strength reduction factors are below the unstable ones", "", max(0.0, stable.max() - unstable.min()), 0,
                            lambda _: "/safety/factor, /safety/stands")
        own = np.flatnonzero(factor == self.scene.divisor)
        if len(own) and self.is_at_rest:
            self.checks.see("this run ended as its strength reduction factor says", "", (stands[own] == 1) == file.has("/failure"), 0.5,
                            lambda i: f"/safety/stands[{own[i]}]")
            if not self.scene.large_displacements:
                moved = norm(st.displacement[-1] - st.displacement[0]).max(initial=0.0)
                self.checks.see("this run moved as far as its strength reduction factor says", "m", np.abs(largest[own] - moved),
                                1e-9 * moved, lambda i: f"/safety/largest_displacement[{own[i]}]")
        self.checks.leave_out("runs with other strength reduction factors, which are not in the file")

    def check_report(self):
        e, tolerance = self.equilibria, self.scene.tolerance
        for name in ("unbalanced_force_ratio", "contact_force_change"):
            self.checks.see(f"report: {name.replace('_', ' ')} is within the tolerance", "", e[name], tolerance,
                            lambda i, name=name: f"/equilibria/{name}[{i}], day {e['time'][i]:.6g}")
        parts = [e[name] for name in ("stored_energy", "dissipated_energy", "damped_energy")]
        size = np.abs(e["work_of_loads"]) + sum(np.abs(part) for part in parts)
        # What is stored is a small difference of all that rock and joints have stored.
        whole = self.stored_energy()
        chosen = np.flatnonzero(~self.ends_creep_step())
        self.checks.see("report: work of loads is stored, dissipated or damped", "J/m", np.abs(e["work_of_loads"] - sum(parts))[chosen],
                        ((self.scene.energy_tolerance if self.scene.large_displacements else ENERGY) * size + ROUNDING * whole)[chosen],
                        lambda i: f"/equilibria/work_of_loads[{chosen[i]}], day {e['time'][chosen[i]]:.6g}")
        if len(chosen) < len(size):
            self.checks.leave_out(f"energy of {len(size) - len(chosen)} creep steps at large displacements")
        self.check_stored_energy()
        implicit = np.flatnonzero(e["is_implicit"])
        if len(implicit) and not np.any(self.section.law == YIELDING):  # slip of that law is against the traction where it shears back
            self.checks.see("report: dissipated energy is not negative, implicit engine", "J/m",
                            np.maximum(0, -e["dissipated_energy"][implicit]), (ENERGY * size + ROUNDING * whole)[implicit],
                            lambda i: f"/equilibria/dissipated_energy[{implicit[i]}], day {e['time'][implicit[i]]:.6g}")

    def ends_creep_step(self):
        """Whether an equilibrium is the end of a creep step at large displacements: all but the in-situ one and those of stages."""
        time, st = self.equilibria["time"], self.states
        ends = np.full(len(time), self.scene.large_displacements and self.scene.creeps)
        ends[:1] = False
        days = st.time[[bool(event) for event in st.event]]
        for day in np.unique(days):
            ends[np.flatnonzero(time == day)[-np.count_nonzero(days == day):]] = False
        return ends

    def stored_energies(self, s):
        """Energy that zones and contacts have stored in a state, of each [J/m]; along the curve of Barton and Bandis it is less."""
        m, st = self.section, self.states
        points = [in_matrices(stress) for stress in np.moveaxis(st.stress_at_points(s), 1, 0)]
        density = sum((stress * m.strain_of(stress)).sum(axis=(1, 2)) for stress in points) / (2 * len(points))
        normal, shear = st.traction[s].T
        sheared = np.divide(shear**2, m.k_s, out=np.zeros_like(shear), where=m.k_s > 0)
        return m.area * density, m.length / 2 * (normal**2 / m.k_n + sheared)

    def stored_energy(self):
        """Largest energy that all have stored in a state."""
        return max(sum(part.sum() for part in self.stored_energies(s)) for s in range(len(self.states.time)))

    def check_stored_energy(self):
        """Of stages: what rock and joints that remain have stored after, less before."""
        st, e = self.states, self.equilibria
        stages = [s for s in range(1, self.n_small) if st.event[s] and st.time[s - 1] == st.time[s]]
        if not stages or not self.is_at_rest:
            return
        if self.scene.increments or len(st.yielding) or self.section.is_barton_bandis().any():
            self.checks.leave_out("stored energy of stages, that it is the states' (increments, rock that yields, or joints of Barton and "
                                  "Bandis's law)")
            return
        searches = self.file.index("/equilibria/searches", 1 << 31, "equilibrium")
        for s in stages:
            later = sum(1 for other in stages if other > s and st.time[other] == st.time[s])
            rows = np.flatnonzero(e["time"] == st.time[s])
            if later >= len(rows):
                continue
            # One of each stage, and that of the creep step before it. A stage can be divided after a search that failed.
            n_stages = sum(1 for other in stages if st.time[other] == st.time[s])
            is_divided = bool(np.any(searches[rows] > 1))
            if len(rows) > (n_stages if is_divided else n_stages + 1):
                self.checks.leave_out(f"stored energy of stages on day {st.time[s]:.6g}, which have several increments")
                continue
            row = rows[-1 - later]
            present, touching = st.present[s], st.status[s] != REMOVED
            after, before = (zones[present].sum() + contacts[touching].sum() for zones, contacts in map(self.stored_energies, (s, s - 1)))
            self.checks.see("report: stored energy of a stage is that of its states", "J/m", abs(after - before - e["stored_energy"][row]),
                            ROUNDING * (after + before), lambda _, row=row, s=s: f"/equilibria/stored_energy[{row}] by "
                            f"/states/stress and /states/traction, {self.day(s)}")

    def check_dynamics(self):
        file, st = self.file, self.states
        time = file.numbers("/dynamics/time", "moment")
        state = file.index("/dynamics/state", "state", "moment")
        self.checks.see("moments of a dynamic analysis have their states", "day", np.abs(time - st.time[state]), 0,
                        lambda i: f"/dynamics/time[{i}]")
        energy = {name: file.numbers(f"/dynamics/{name}", "moment") for name in (
            "work_of_loads", "kinetic_energy", "stored_energy", "friction_energy", "damped_energy")}
        dynamic_time = file.numbers("/dynamics/dynamic_time", "moment")
        fastest = file.numbers("/dynamics/fastest", "moment")
        if self.is_ended:
            self.checks.see("the last dynamic analysis ends when the scene asks for it", "s",
                            np.maximum(0, self.scene.stop - dynamic_time[-1:]), 0, lambda i: "/dynamics/dynamic_time[-1]")
        begins = np.flatnonzero(np.concatenate([[True], dynamic_time[1:] <= dynamic_time[:-1]])) if len(time) else []
        for first, end in zip(begins, [*begins[1:], len(time)]):
            rows = slice(first, end)
            parts = [values[rows] for values in energy.values()]
            largest = max(np.abs(part).max() for part in parts)
            if not fastest[rows].max() > 0.01:
                self.checks.leave_out(f"energy of the dynamic analysis on day {time[first]:.6g}, in which nothing was faster "
                                      "than 0.01 m/s")
                continue
            self.checks.see("dynamics: work of loads is kinetic, stored, lost or damped", "J/m",
                            np.abs(parts[0] - sum(parts[1:])), self.scene.energy_tolerance * largest,
                            lambda i, first=first: f"/dynamics/work_of_loads[{first + i}], day {time[first + i]:.6g}, "
                            f"{dynamic_time[first + i]:.3g} s")
        c, m = self.moving_contacts, self.section
        where = lambda dataset: lambda i: f"{dataset}[{i}]: between blocks {c.block[i, 0]} and {c.block[i, 1]} at " \
            f"[{c.middle[i, 0]:.6g}, {c.middle[i, 1]:.6g}] m"
        self.checks.see("normals of moving contacts are unit vectors", "", np.abs(norm(c.normal) - 1), ROUNDING,
                        where("/dynamics/contact_normal"))
        pressure = np.maximum(-c.traction[:, 0], 0)
        limit = m.largest_strength(pressure)
        self.checks.see("moving contacts carry no more shear than the strongest joint", "Pa", np.abs(c.traction[:, 1]) - limit,
                        1e-9 * (limit + pressure), where("/dynamics/contact_traction"))

    def say_what_is_left_out(self):
        m, st, leave_out = self.section, self.states, self.checks.leave_out
        if not self.is_at_rest:
            leave_out("equilibrium, stresses and joint laws: the run found no equilibrium in situ")
        if self.n_small < len(st.time):
            leave_out(f"of {len(st.time) - self.n_small} states at large displacements: forces of contacts on single gridpoints, the "
                      "joint law of each contact" + (", stress of zones that yield" if len(st.yielding) else ""))
        if (m.law == YIELDING).any():
            leave_out("strength of continuously yielding joints beyond its bounds: the file has no plastic displacement")
        if (m.law == WEARING).any():
            leave_out("dilation that wears off, but that it does not go back: the file has no work of slip")
        if len(st.creeping):
            leave_out("strain that rock has crept, but that the stress fits it")
        groups = {}
        for name in self.file.all_datasets():
            if name not in self.file.used:
                groups.setdefault("/" + name.split("/")[1], []).append(name)
        self.checks.outside = ["that equivalent joints follow from the scene and its network", "datasets that no check uses: " + ", ".join(
            names[0] if len(names) == 1 else f"{len(names)} of {group}" for group, names in groups.items())]


def verify(path):
    """Exit code of the verification of a file, which prints its table."""
    try:
        return 0 if Verification(path).run() else 3
    except NotWanted as error:
        print(f"jointverify: {error}", file=sys.stderr)
        return 2
    except NotReadable as error:
        print(f"jointverify: {error}", file=sys.stderr)
        return 4
    except MemoryError:
        print(f"jointverify: {path}: out of memory", file=sys.stderr)
        return 5
    except Exception as error:  # whatever a damaged file may bring about
        print(f"jointverify: {path}: internal error: {type(error).__name__}: {error}", file=sys.stderr)
        return 5


def main(arguments):
    if arguments in (["-h"], ["--help"], ["-V"], ["--version"]):
        try:
            print(__doc__ if arguments[0] in ("-h", "--help") else f"jointverify {VERSION}\n", end="", flush=True)
        except OSError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # Python would try again as it ends
            print("jointverify: stdout could not be written", file=sys.stderr)
            return 4
        return 0
    if len(arguments) != 1 or arguments[0].startswith("-"):
        hint = "-v is no option; -V shows the version\n" if arguments == ["-v"] else ""
        print(f"jointverify: {hint}expected one result file\nusage: jointverify RESULT.h5\nMore: jointverify --help", file=sys.stderr)
        return 2
    # In a process of its own: a damaged file can end the HDF5 library, and Python with it.
    child = os.fork()
    if child == 0:
        code = 4
        try:
            code = verify(arguments[0])
            sys.stdout.flush()
        except OSError:
            print("jointverify: the table cannot be written", file=sys.stderr)
            code = 4
        finally:
            os._exit(code)
    status = os.waitpid(child, 0)[1]
    if os.WIFSIGNALED(status):
        print(f"jointverify: {arguments[0]}: cannot be read: the HDF5 library ended by signal {os.WTERMSIG(status)}; the file "
              "is damaged", file=sys.stderr)
        return 4
    return os.WEXITSTATUS(status)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
