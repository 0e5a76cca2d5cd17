"""Reads files of jointcreep into tables with units.

    import jointcreep

    run = jointcreep.read("result.h5")
    run.scene["section"]["outline_m"]           # the scene, as tomllib reads it
    history = run.history()                     # of the monitoring points
    1e3 * history.of("crest")[-1]               # its last displacement {x, y} [mm]
    contacts = run.contacts(stage="bench 3")    # after a stage
    contacts["normal traction"].min(), contacts.units["normal traction"]
    jointcreep.read("out/study").runs["crest (mm)"]

Values are those of the files: SI units (times in days), tension and opening positive. Where pandas is installed, `frame()` makes a
DataFrame of a table; where xarray is, array() makes a DataArray of a dataset.
"""

import contextlib
import csv
import dataclasses
import pathlib
import tomllib

import h5py
import numpy as np

from . import files, histories
from .errors import NotWanted
from .quantities import TO_FAIL

AXES = {2: ["x", "y"], 3: ["xx", "yy", "xy"]}  # parts of a dataset's last dimension
IN_PLANE, IN_SPACE, ALONG_JOINT = ["x", "y"], ["x", "y", "z"], ["normal", "shear"]
COMPONENTS = {"displacement": IN_PLANE, "reaction": IN_PLANE, "point_position": IN_PLANE, "gridpoint_position": IN_PLANE,
              "pole": IN_SPACE, "centre": IN_SPACE, "stress": AXES[3], "traction": ALONG_JOINT,
              "relative_displacement": ALONG_JOINT}  # of datasets of these names
STATUS = ["removed", "sticking", "slipping", "open"]  # of contacts, by number


class Table(dict):
    """Columns by name: arrays of the same length. `units` has the unit of each ("1": none)."""

    def __init__(self, columns=(), units=()):
        super().__init__(columns)
        self.units = dict(units)

    def rows(self):
        """How many rows it has."""
        return len(next(iter(self.values()), ()))

    def frame(self):
        """The same as a DataFrame of pandas, with units in its `attrs`."""
        import pandas
        frame = pandas.DataFrame(dict(self))
        frame.attrs["units"] = self.units
        return frame

    def put(self, name, values, unit="1"):
        """Adds a column; one of several parts as one for each: "displacement x", "displacement y"."""
        if np.ndim(values) == 1:
            self[name], self.units[name] = values, unit
            return
        parts, named = values.shape[1], COMPONENTS.get(name, [])
        for part, axis in enumerate(named if len(named) == parts else AXES[parts]):
            self[f"{name} {axis}"], self.units[f"{name} {axis}"] = values[:, part], unit


@dataclasses.dataclass
class History:
    """Displacements of the monitoring points over time."""
    time: np.ndarray  # [time] days since the schedule's start
    event: list  # [time] stage that the row is the first after; "" for others
    point: list  # names
    position: np.ndarray  # [point, {x, y}] [m]
    displacement: np.ndarray  # [time, point, {x, y}] since the in-situ equilibrium [m]
    present: np.ndarray  # [time, point]: whether the point is there; after its excavation displacements are the last ones
    first_reading_row: np.ndarray  # [point]: row from which its readings count
    dates: np.ndarray  # on which something happens [day]

    def stages(self):
        """[time]: how many stages there have been."""
        return histories.stages_of(self.event)

    def of(self, point):
        """Displacement of a point [time, {x, y}] [m]. Raises NotWanted if there is none of that name."""
        return self.displacement[:, place_of(self.point, point, "point")]

    def relative(self, point, to):
        """Displacement of a point relative to another one [time, {x, y}] [m]; nan where one of them is not there any more."""
        of_both = [place_of(self.point, name, "point") for name in (point, to)]
        there = self.present[:, of_both].all(axis=1)
        return np.where(there[:, None], self.of(point) - self.of(to), np.nan)

    def closure(self, point, other):
        """By how much the distance of two points has become smaller [time] [m], as a tape measures it: positive where they approach."""
        apart = self.position[place_of(self.point, other, "point")] - self.position[place_of(self.point, point, "point")]
        return np.linalg.norm(apart) - np.linalg.norm(apart + self.relative(other, point), axis=1)

    def since_first_reading(self):
        """Displacement since each point's first reading [time, point, {x, y}] [m]; before it, it is minus what came before."""
        return self.displacement - self.displacement[self.first_reading_row, np.arange(len(self.point))]

    def table(self):
        """A row for each time and point."""
        times, points = len(self.time), len(self.point)
        table = Table()
        table.put("time", np.repeat(self.time, points), "day")
        table.put("event", np.repeat(np.array(self.event, str), points))
        table.put("point", np.tile(np.array(self.point, str), times))
        table.put("displacement", self.displacement.reshape(-1, 2), "m")
        table.put("present", self.present.ravel())
        return table


def history_of(file):
    """History of an open result file."""
    return History(file["/history/time"][()], files.texts(file, "/history/event"), files.texts(file, "/history/point"),
                   file["/history/point_position"][()], file["/history/displacement"][()], file["/history/present"][()] == 1,
                   file["/history/first_reading_row"][()], np.unique(file["/states/time"][()]))


class File:
    """A network, joints, result or checkpoint file. Everything is read when asked for."""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        with self.opened() as file:
            kind = files.text_of(file.attrs.get("filetype", ""))
            if not kind.startswith("jointcreep ") or "complete" not in file.attrs:
                raise NotWanted(f"{path}: is not a whole file of jointcreep")
            self.kind = kind.removeprefix("jointcreep ")
            self.version = files.text_of(file.attrs.get("program_version", ""))
            self.scene = tomllib.loads(files.texts(file, "/scene")[0])

    def opened(self):
        """The open HDF5 file, for what has no function here."""
        try:
            return h5py.File(self.path)
        except OSError as error:
            raise NotWanted(f"{self.path}: {error.strerror or error}") from None

    def __getitem__(self, path):
        """A dataset: an array, or a list of str."""
        with self.opened() as file:
            self.check(path, file)
            return files.texts(file, path) if file[path].dtype.kind in "SO" else file[path][()]

    def check(self, path, file):
        """Refuses what is not there."""
        if path not in file:
            raise NotWanted(f"{self.path}: there is no {path} in this {self.kind} file")

    def unit(self, path):
        """Unit of a dataset, "1" if it has none."""
        with self.opened() as file:
            return files.text_of(file[path].attrs["units"])

    def axes(self, path):
        """Names of the axes of a dataset, such as ["time", "point", "component"]; "" of a single value's."""
        with self.opened() as file:
            self.check(path, file)
            return [axis.label for axis in file[path].dims]

    def array(self, path):
        """A dataset as a DataArray of xarray: its axes have names and coordinates (times, points, stages, {x, y}), `attrs` its unit.
        The axis of states has the coordinates "time" and "event"."""
        import xarray
        group, _, name = path.rpartition("/")
        values, axes = self[path], self.axes(path)
        coords = {}
        with self.opened() as file:
            for axis, count in zip(axes, np.shape(values)):
                beside = {axis: f"{group}/{axis}", **({"time": "/states/time", "event": "/states/event"} if axis == "state" else {})}
                for coordinate, other in beside.items() if axis else ():
                    if isinstance(found := file.get(other), h5py.Dataset) and found.shape == (count,):
                        coords[coordinate] = axis, self[other]
        if axes[-1:] == ["component"] and name in COMPONENTS:
            coords["component"] = COMPONENTS[name]
        return xarray.DataArray(values, coords, axes if np.ndim(values) else (), name, {"units": self.unit(path)})

    def table(self, group, count):
        """The datasets of a group that have a row for each of `count` things, such as "/blocks"."""
        table = Table()
        with self.opened() as file:
            for name, dataset in file[group].items():
                if dataset.shape[:1] == (count,) and (dataset.ndim == 1 or dataset.ndim == 2 and dataset.shape[1] in AXES):
                    values = np.array(files.texts(dataset.parent, name)) if dataset.dtype.kind in "SO" else dataset[()]
                    table.put(name.replace("_", " "), values, files.text_of(dataset.attrs["units"]))
        return table

    def blocks(self):
        """Table of the blocks: area (m2), number of the rock, and of the stage that excavates it (-1: none)."""
        return self.table("/blocks", len(self["/blocks/area"]))

    def joints(self):
        """Table of the joints: ends, number of set and material."""
        return self.table("/joints", len(self["/joints/set"]))

    def edges(self):
        """Table of the edges between blocks."""
        return self.table("/edges", len(self["/edges/kind"]))

    def equilibria(self):
        """Table of the equilibria found: time (day), unbalanced force ratio, energies (J/m), steps."""
        return self.table("/equilibria", len(self["/equilibria/steps"]))

    def moving_blocks(self):
        """Table of the blocks that move in the end of a run without equilibrium (NAME.failed.h5): block, its area (m2; the volume in m3 of
        each metre of the section's thickness), its middle (m), motion (m), that is the displacement in the last steps of the solver, the
        fastest first."""
        table = Table()
        order = np.argsort(-np.linalg.norm(self["/failure/motion"], axis=1), kind="stable")
        table.put("block", self["/failure/block"][order])
        table.put("area", self["/blocks/area"][table["block"]], "m2")
        table.put("place", self["/failure/place"][order], "m")
        table.put("motion", self["/failure/motion"][order], "m")
        return table

    def history(self):
        """History of the monitoring points; of result files."""
        with self.opened() as file:
            self.check("/history/displacement", file)
            return history_of(file)

    def states(self):
        """Table of the recorded states: time (day), and the stage that it is the first after."""
        table = Table()
        table.put("time", self["/states/time"], "day")
        table.put("event", np.array(self["/states/event"], str))
        return table

    def state(self, stage=None):
        """Number of the state after a stage; of the last state without a name, or by "last"."""
        return len(self["/states/time"]) - 1 if stage in (None, "last") else place_of(self["/states/event"], stage, "stage")

    def of_state(self, dataset, stage):
        """The row of a dataset [state, ...] after a stage."""
        with self.opened() as file:
            return file[dataset][self.state(stage)]

    def gridpoints(self, stage=None):
        """Table of the gridpoints after a stage, or in the end: position, displacement (m)."""
        table = Table()
        table.put("position", self["/mesh/gridpoint_position"], "m")
        table.put("displacement", self.of_state("/states/displacement", stage), "m")
        return table

    def zones(self, stage=None):
        """Table of the zones after a stage, or in the end: centre (m), block, stress (Pa, tension positive), whether it is present."""
        corners = self["/mesh/gridpoint_position"][self["/mesh/zone_gridpoint"]]
        table = Table()
        table.put("centre", corners.mean(axis=1), "m")
        table.put("block", self["/mesh/zone_block"])
        table.put("stress", self.of_state("/states/stress", stage), "Pa")
        table.put("present", self.of_state("/states/zone_present", stage) == 1)
        return table

    def contacts(self, stage=None):
        """Table of the contacts after a stage, or in the end: centre and length (m), edge, name of the joint set or single joint ("" on
        other edges), tractions (Pa, tension positive), relative displacements (m, opening positive), slip (m), status (of STATUS). A
        contact that is removed keeps its last slip."""
        table = Table()
        table.put("centre", self["/mesh/contact_centre"], "m")
        table.put("length", self["/mesh/contact_length"], "m")
        table.put("edge", self["/mesh/contact_edge"])
        names = np.array([*self["/names/joint_set"], ""], str)  # the last one for -1
        joint = self["/edges/joint"][table["edge"]]
        table.put("set", names[np.append(self["/joints/set"], -1)[joint]])
        for name, unit in (("traction", "Pa"), ("relative_displacement", "m")):
            values = self.of_state(f"/states/{name}", stage)
            for part, direction in enumerate(("normal", "shear")):
                table.put(f"{direction} {name.replace('_', ' ')}", values[:, part], unit)
        table.put("slip", self.of_state("/states/slip", stage), "m")
        table.put("status", np.array(STATUS)[self.of_state("/states/contact_status", stage)])
        return table


class Study:
    """The folder of a study: tables `runs`, `times`, `answers`, `convergence`, `shares`, as their CSV files have them. Numbers are
    float, and nan where a field is empty; numbers of runs, networks and attempts and exit codes are int; columns with words are str."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        if not (self.folder / "runs.csv").exists():
            raise NotWanted(f"{folder}: is not the folder of a study that has ended")

    def __getattr__(self, name):
        path = self.folder / f"{name}.csv"
        if name.startswith("_") or not path.exists():
            raise AttributeError(f"{self.folder} has no {name}.csv")
        return csv_table(path)

    def answer(self, statistic, quantity=None):
        """Value, and ends of the interval, of a statistic; of the study's only quantity without a name. nan where there is none."""
        table = self.answers
        statistic = statistic.replace(TO_FAIL, "probability", 1)
        if quantity and quantity not in table["quantity"] and f"{quantity}, lower end" in table["quantity"]:
            quantity += ", lower end"  # of a factor of safety
        rows = np.flatnonzero((table["statistic"] == statistic) & ((table["quantity"] == quantity) if quantity else True))
        if len(rows) != 1:
            there = ", ".join(sorted(set(table["quantity"])))
            chosen = quantity if quantity in table["quantity"] else f"one of {there}"
            names = sorted(set(table["statistic"][table["quantity"] == quantity] if quantity else table["statistic"]))
            raise NotWanted(f'{self.folder / "answers.csv"}: "{statistic}" is there {len(rows)} times; expected a statistic that is there once: '
                            f"{', '.join(names) or 'none'}; of the quantity: {chosen}")
        return tuple(float(table[name][rows[0]]) for name in ("value", "low", "high"))


TEXTS = ("no equilibrium", "failure stage", "program", "reason")  # columns of text, also where all fields are empty
INTEGERS = ("run", "network", "exit code", "attempts")
UNITS = {"failure day": "day"}  # of columns without a unit in their name


def csv_table(path):
    """A CSV file with a heading as a table. Columns of which all fields are numbers or empty are float, nan where empty, but for those
    of TEXTS, and of INTEGERS; a unit is what stands in brackets at the end of a heading. Text has no unit: ""."""
    with open(path, encoding="utf-8", newline="") as file:
        heads, *rows = csv.reader(file)
    table = Table()
    for name, column in zip(heads, zip(*rows) if rows else [()] * len(heads)):
        values = np.array(column, str)
        if name not in TEXTS:
            with contextlib.suppress(ValueError):
                values = np.array([float(field) if field else np.nan for field in column])
                if name in INTEGERS and np.all(values == np.floor(values)):
                    values = values.astype(int)
        unit = "" if values.dtype.kind == "U" else UNITS.get(name, "1")
        table.put(name, values, name.rpartition(" (")[2].removesuffix(")") if name.endswith(")") else unit)
    return table


def place_of(names, wanted, what):
    """Place of a name in a list."""
    if wanted not in names:
        raise NotWanted(f'there is no {what} "{wanted}"; there are: {", ".join(name for name in names if name) or "none"}')
    return names.index(wanted)


def read(path):
    """A File of an HDF5 file of the chain, or a Study of a study's folder. Raises NotWanted, with a message, if it is neither."""
    return Study(path) if pathlib.Path(path).is_dir() else File(path)
