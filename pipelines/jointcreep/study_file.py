"""The study file: a scene, what varies in it, how runs are drawn, what is collected from each, and when to stop.

Whatever is wrong is refused with a message that names file, line, key and value.
"""

import csv
import dataclasses
import datetime
import difflib
import math
import pathlib
import re
import tomllib

from . import scene_keys
from .errors import NotWanted

DESIGNS = {  # what each needs
    "plain": ["runs"],
    "latin hypercube": ["runs"],
    "sobol sequence": ["runs"],
    "networks x parameters": ["networks", "parameters"],
    "sobol indices": ["points"],
    "directional sampling": ["directions"],
    "two levels": ["fine_runs", "coarse_per_fine"],
    "table": ["file"],
}
REPLICATED = ["latin hypercube", "sobol sequence", "directional sampling"]
EXTENSIBLE = ["plain", "two levels"]  # more runs may be added, and the first of them are a design too
LAWS = {  # parameters of each, in the unit of the key that varies
    "normal": ["mean", "deviation"],
    "lognormal": ["mean", "deviation"],
    "uniform": ["lowest", "highest"],
    "triangular": ["lowest", "most_likely", "highest"],
}
BOUNDED = ["normal", "lognormal"]  # these may be cut off at lowest and highest
ENDS = ["lower end", "upper end"]  # of the bracket of a factor of safety
BLOCKS = {"number": "1", "mean area": "m2", "median area": "m2", "largest area": "m2"}  # statistics and their units
WHAT = ["displacement", "blocks", "factor of safety", "failed"]
NETWORK = "network"  # name of the column of the network's number
RUN = "run"  # and of the run's
LEVEL = "level"  # name of the column that says whether a run of "two levels" is fine or coarse
RESERVED = {RUN, NETWORK, LEVEL, "exit code", "no equilibrium", "program", "reason", "failure stage", "failure day", "moving blocks", "moving area"}
KEPT = ["network.h5", "joints.h5", "result.h5", "result.failed.h5", "safety.h5", "safety.failed.h5"]  # files of a run that may be kept
MOST_RUNS = 1_000_000
BY_STOP_RULE = "by the stop rule"  # why a study ended before all its runs
LIKE = 0.75  # of two keys, by difflib: more than of any two that are known, such as fine_runs and fine_options (0.67)


@dataclasses.dataclass
class Parameter:
    """A key of the scene, or several that share a value, and its law or its list."""
    name: str
    keys: list
    multiplies: bool  # the drawn number multiplies the scene's values
    law: str  # "" for a list
    constants: dict  # of the law
    lowest: float  # -inf, or where a law is cut off
    highest: float
    values: list  # of a list; of the design "table" that of each run
    place: str  # in the study file


@dataclasses.dataclass
class Quantity:
    """What is collected of each run."""
    name: str
    what: str
    unit: str
    point: str
    relative_to: str  # another point, whose displacement is subtracted; "" for none
    component: str
    since: str
    stage: str
    date: object  # datetime.date, number of days, or None: the end
    statistic: str  # of blocks; of a factor of safety one of ENDS
    above: list  # limits of which the probabilities to be above are wanted
    below: list
    place: str

    def label(self):
        """Its name in tables; of a factor of safety also its end."""
        return f"{self.name}, {ENDS[0]}" if self.statistic == ENDS[0] else self.name

    def title(self):
        """Label and unit."""
        return self.label() if self.unit == "1" else f"{self.label()} ({self.unit})"

    def definition(self):
        """What it is, in a sentence."""
        if self.what == "failed":
            return "1 if blocks move and there is no equilibrium, 0 if there is one; runs that end undecided have no value."
        if self.what == "factor of safety":
            has = "an" if self.statistic == ENDS[0] else "no"
            return f"Strength reduction factor at the {self.statistic} of the bracket, with which there is {has} equilibrium."
        if self.what == "blocks":
            return f"{self.statistic.capitalize()} of all blocks before the first stage."
        component = {"x": "to the right (x)", "y": "upward (y)", "length": "as the length of the vector"}[self.component]
        other = f' relative to "{self.relative_to}"' * bool(self.relative_to)
        time = f'just after stage "{self.stage}"' if self.stage else "at the end" if self.date is None else \
            f"on day {self.date:g}" if isinstance(self.date, (int, float)) else f"on {self.date}"
        since = "the in-situ equilibrium" if self.since == "in situ" else f'the first reading of "{self.point}"'
        return f'Displacement of "{self.point}"{other} {component}, {time}, since {since}.'


@dataclasses.dataclass
class Design:
    kind: str
    seed: int
    runs: int  # all of them; of directional sampling the number of replicates, whose runs are not known before
    networks: int  # of "networks x parameters"
    parameters: int
    points: int  # of "sobol indices"
    replicates: int  # independent parts of a design of REPLICATED
    directions: int  # of "directional sampling", in each replicate
    failure: str  # the quantity that says whether a run fails
    fine_runs: int = 0  # of "two levels"
    coarse_per_fine: int = 0
    fine_options: list = dataclasses.field(default_factory=list)  # of demsolve, for fine runs
    coarse_options: list = dataclasses.field(default_factory=list)
    networks_given: list = dataclasses.field(default_factory=list)  # of "table": that of each run

    def block(self):
        """Runs of "two levels" that belong together: a fine one, and coarse ones of which the first has the same network."""
        return 1 + self.coarse_per_fine

    def networks_drawn(self):
        """Networks of a design in which each run, or each coarse run, has its own."""
        return self.fine_runs * self.coarse_per_fine if self.fine_runs else self.runs

    def are_independent(self):
        """Whether runs are independent of each other: not those on one network, nor those of a table, which can have any rows."""
        return self.kind not in ("networks x parameters", "table")

    def counted(self):
        """What values are counted in: runs, of two levels the fine ones."""
        return "fine runs" if self.fine_runs else "runs"

    def level(self, run):
        """What a run is of "two levels"; else nothing."""
        return "" if not self.fine_runs else "coarse" if run % self.block() else "fine"

    def network_place(self, run):
        """Which of the drawn networks and sets of parameters a run of "two levels" has."""
        block, place = divmod(run, self.block())
        return block * self.coarse_per_fine + max(0, place - 1)


@dataclasses.dataclass
class Stop:
    """When runs are enough; the quantity's name is empty where nothing is wanted."""
    of: str
    half_width: float  # of the mean's interval, in the quantity's unit; 0: not wanted
    relative_half_width: float  # over the mean
    probability_half_width: float  # of each probability of the quantity
    hours: float  # of wall time; inf: no limit


@dataclasses.dataclass
class Study:
    path: pathlib.Path
    title: str
    scene: pathlib.Path
    varies_network: bool
    parameters: list
    correlations: list  # of (name, name, coefficient)
    design: Design
    quantities: list
    stop: Stop
    demsolve_options: list
    histories: bool = False  # whether statistics of the histories of all points are wanted
    keep: list = dataclasses.field(default_factory=list)  # files of each run that stay, of KEPT

    def varied_names(self):
        """The names of [variables] that vary."""
        parts = [scene_keys.parts_of(key) for one in self.parameters for key in one.keys]
        return {part[1] for part in parts if part[0] == "variables" and len(part) == 2}

    def options_of(self, run):
        """Options of demsolve for a run."""
        design = self.design
        of_level = {"fine": design.fine_options, "coarse": design.coarse_options}.get(design.level(run), [])
        return [*self.demsolve_options, *of_level]


def shown(value):
    """A value in a message."""
    text = f'"{value}"' if isinstance(value, str) else str(value)
    return text if len(text) < 80 else text[:76] + " ..."


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


class Table:
    """A table of the study file. Its keys are taken one by one; what is left in the end is unknown."""

    def __init__(self, path, text, heading, values, number=0):
        self.path, self.heading, self.left, self.taken = path, heading, dict(values), set()
        self.lines, self.first = text.splitlines(), 0
        if heading:
            rows = [row for row, line in enumerate(self.lines) if re.match(rf"\s*{re.escape(heading)}\s*(#|$)", line)]
            self.first = rows[number] if number < len(rows) else -1

    def place(self, key=""):
        """Where it is, or one of its keys: file and line, as far as they are found."""
        row = self.first if self.heading else -1
        if key and self.first >= 0:
            for at in range(self.first + bool(self.heading), len(self.lines)):
                if re.match(rf"""\s*["']?{re.escape(key)}["']?\s*=""", self.lines[at]):
                    row = at
                    break
                if re.match(r"\s*\[", self.lines[at]):
                    break
        line = f", line {row + 1}" if row >= 0 else ""
        return f"{self.path}{line}: " + (f"{self.heading}: " if self.heading else "")

    def wrong(self, key, expected):
        if key in self.left:
            found = f"{key} is {shown(self.left[key])}"
        else:
            like = difflib.get_close_matches(key, sorted(self.left.keys() - self.taken), 1, LIKE)
            found = f"{key} is missing" + (f" (and {like[0]} is unknown)" if like else "")
        raise NotWanted(f"{self.place(key)}{found}; expected {expected}")

    def get(self, key, default, fits, expected):
        """The value of a key, or the default if it is not there; None as a default: it must be there."""
        if key not in self.left and default is not None:
            return default
        if key not in self.left or not fits(self.left[key]):
            self.wrong(key, expected)
        self.taken.add(key)
        return self.left[key]

    def number(self, key, default=None, above=-math.inf, least=-math.inf, most=math.inf):
        ends = [f"above {above:g}"] * (above > -math.inf) + [f"of at least {least:g}"] * (least > -math.inf) + \
            [f"of at most {most:g}"] * (most < math.inf)
        return float(self.get(key, default, lambda value: is_number(value) and above < value and least <= value <= most,
                              " ".join(["a number", " and ".join(ends)]).strip()))

    def whole(self, key, default=None, least=0, most=MOST_RUNS):
        return self.get(key, default, lambda value: isinstance(value, int) and not isinstance(value, bool) and
                        least <= value <= most, f"a whole number from {least} to {most}")

    def text(self, key, default=None, choices=None):
        expected = "one of " + ", ".join(f'"{one}"' for one in choices) if choices else "a text that is not empty, on one line"
        return self.get(key, default, lambda value: isinstance(value, str) and (value in choices if choices else
                        bool(value.strip()) and value.isprintable()), expected)

    def flag(self, key, default=None):
        return self.get(key, default, lambda value: isinstance(value, bool), "true or false")

    def several(self, key, default, fits, expected, least=1):
        """A list of so many or more."""
        return self.get(key, default, lambda value: isinstance(value, list) and len(value) >= least and all(map(fits, value)), expected)

    def end(self):
        for key in self.left:
            if key not in self.taken:
                raise NotWanted(f"{self.place(key)}{key} is unknown here, or does not go with the other keys")


def read(path, table=None):
    """The study of a file. Scene and its keys are not looked at. table: the file of a design "table", if it is not the one that the study
    names."""
    path = pathlib.Path(path)
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise NotWanted(f"{path}: is not UTF-8 text; expected a study file") from None
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise NotWanted(f"{path}: {error}") from None
    names = {"vary": list, "correlation": list, "design": dict, "collect": list, "stop": dict}
    top = Table(path, text, "", {key: value for key, value in tables.items() if key not in names})
    for key, kind in names.items():
        if not isinstance(tables.get(key, kind()), kind) or kind is list and not \
                all(isinstance(one, dict) for one in tables.get(key, [])):
            raise NotWanted(f"{top.place(key)}{key} is not a table; expected {'[[' + key + ']]' if kind is list else '[' + key + ']'}")

    def each(key):
        return [Table(path, text, f"[[{key}]]", values, number) for number, values in enumerate(tables.get(key, []))]

    title = top.text("title", "")
    scene = path.parent / top.text("scene")
    options = demsolve_options_of(top, "demsolve_options", 0)
    with_histories = top.flag("histories", False)
    kept = top.several("keep", [], lambda one: one in KEPT, "a list of " + ", ".join(f'"{one}"' for one in KEPT))
    top.end()

    varies_network, parameters, is_table = False, [], tables.get("design", {}).get("kind") == "table"
    for one in each("vary"):
        if one.flag("network", False):
            if varies_network:
                one.wrong("network", "it in one [[vary]] only")
            varies_network = True
        else:
            parameters.append(parameter_of(one, is_table))
        one.end()
    if not varies_network and not parameters:
        raise NotWanted(f"{path}: nothing varies; expected a [[vary]], for example with network = true")
    unique(parameters, path)
    correlations = [correlation_of(table, parameters) for table in each("correlation")]
    quantities = [end for table in each("collect") for end in both_ends(quantity_of(table))]
    if not quantities and not with_histories:
        raise NotWanted(f'{path}: nothing is collected; expected a [[collect]], for example with what = "failed"')
    unique([*parameters, *quantities], path)
    for name in ("safety.h5", "safety.failed.h5"):
        if name in kept and all(one.what != "factor of safety" for one in quantities):
            top.wrong("keep", f'a [[collect]] with what = "factor of safety" for {name}')
    design = design_of(Table(path, text, "[design]", tables.get("design", {})), varies_network, parameters, correlations, quantities, table)
    stop = stop_of(Table(path, text, "[stop]", tables.get("stop", {})), quantities, design)
    if with_histories and design.kind != "plain":
        top.wrong("histories", f'false, because the design is "{design.kind}" and not plain')
    return Study(path, title, scene, varies_network, parameters, correlations, design, quantities, stop, options, with_histories, kept)


def demsolve_options_of(table, key, least=1):
    """Options of demsolve that a table gives under a key, so many or more."""
    options = table.several(key, [], lambda one: isinstance(one, str) and one.isprintable(), 'a list of options, such as ["--no-creep"]', least)
    for option in options:
        if option.split("=")[0] in ("-o", "--output", "--checkpoint", "--factor-of-safety", "-h", "--help", "--version"):
            table.wrong(key, f"options without {option}")
    return options


def unique(named, path):
    """Refuses two columns of one name."""
    seen = set()
    for one in named:
        if one.name in seen or one.name in RESERVED:
            why = "the name of a column that every study has" if one.name in RESERVED else "there twice"
            raise NotWanted(f'{one.place}name "{one.name}" is {why}; expected another name')
        seen.add(one.name)


def parameter_of(table, is_in_table=False):
    """Of a [[vary]]. is_in_table: its values are in the file of the design, and no law is."""
    key = table.get("key", None, lambda value: isinstance(value, str) and value or isinstance(value, list) and value and
                    all(isinstance(one, str) and one for one in value), "a key of the scene, or a list of keys, in quotes")
    keys = [key] if isinstance(key, str) else key
    values = [] if is_in_table else table.several("values", [], lambda one: is_number(one) or isinstance(one, str), "a list of numbers or texts")
    law = "" if values or is_in_table else table.text("law", None, list(LAWS))
    constants = {name: table.number(name) for name in LAWS.get(law, [])}
    low, high = (table.number(name, default) if law in BOUNDED else default
                 for name, default in (("lowest", -math.inf), ("highest", math.inf)))
    if "deviation" in constants and constants["deviation"] <= 0:
        table.wrong("deviation", "more than 0")
    if law == "lognormal" and constants["mean"] <= 0:
        table.wrong("mean", "more than 0, because a lognormal law has no others")
    ordered = [constants[name] for name in LAWS.get(law, []) if name not in ("mean", "deviation")]
    if law in BOUNDED and low >= high or ordered != sorted(ordered) or ordered and ordered[0] == ordered[-1]:
        table.wrong("highest", "more than lowest" + (", and most_likely between them" if law == "triangular" else ""))
    multiplies = table.flag("multiplies", False)
    if multiplies and not all(map(is_number, values)):
        table.wrong("values", "numbers, because multiplies is true")
    return Parameter(table.text("name", keys[0]), keys, multiplies, law, constants, low, high, values, table.place())


def correlation_of(table, parameters):
    names = [one.name for one in parameters if one.law]
    between = table.get("between", None, lambda value: isinstance(value, list) and len(value) == 2 and
                        value[0] != value[1] and all(one in names for one in value),
                        "the names of two [[vary]] that have a law")
    coefficient = table.number("coefficient", None, least=-0.99, most=0.99)
    table.end()
    return (*between, coefficient)


def table_of(path, wanted, where):
    """Columns of a CSV file by their names, of which these are wanted: numbers, or texts if one of them is none. where: what names the
    file, in messages."""
    try:
        rows = list(csv.reader(path.read_text(encoding="utf-8-sig").splitlines()))
    except OSError as error:
        raise NotWanted(f"{where}{path}: {error.strerror}; expected a CSV file") from None
    except (UnicodeDecodeError, csv.Error):
        raise NotWanted(f"{path}: is no CSV text; expected a table with a line of names") from None
    rows = [(number, row) for number, row in enumerate(rows, 1) if row]
    if len(rows) < 3:
        raise NotWanted(f"{path}: has {max(0, len(rows) - 1)} runs; expected a line of names, and a line for each of two runs or more")
    names = [name.strip() for name in rows[0][1]]
    for name in wanted:
        if names.count(name) != 1:
            raise NotWanted(f'{path}, line {rows[0][0]}: has {names.count(name) or "no"} columns "{name}"; expected one for each [[vary]]: '
                            f'{", ".join(wanted)}')
    other = [name for name in names if name not in (*wanted, RUN, NETWORK)]
    if other:
        raise NotWanted(f'{path}, line {rows[0][0]}: no [[vary]] has the name "{other[0]}"; expected columns {", ".join(wanted)}')
    for number, row in rows[1:]:
        if len(row) != len(names) or not all(map(str.strip, row)):
            raise NotWanted(f"{path}, line {number}: has {sum(map(bool, map(str.strip, row)))} values; expected {len(names)}, as the first line")
    columns = {}
    for at, name in enumerate(names):
        texts = [row[at].strip() for _, row in rows[1:]]
        numbers = list(map(number_of, texts))
        columns[name] = texts if None in numbers else numbers
    most = 2**31 - 1 if NETWORK in wanted else 0
    for (number, _), one in zip(rows[1:], columns.get(NETWORK, [])):
        if not isinstance(one, int) or not 0 <= one <= most:
            expected = f"a whole number from 0 to {most}" if most else "0, or a [[vary]] with network = true"
            raise NotWanted(f"{path}, line {number}: {NETWORK} is {shown(one)}; expected {expected}")
    return columns


def number_of(text):
    """A number as it is written, a whole one as such; None of other texts."""
    try:
        value = int(text) if text.lstrip("+-").isdecimal() else float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def table_design(table, varies_network, parameters, given):
    """The design of a table of runs, which has the values of the parameters, too. given: its file, or None: the one that the study names."""
    named = table.path.parent / table.text("file")
    table.end()
    path = given or named
    columns = table_of(path, [one.name for one in parameters] + [NETWORK] * varies_network, table.place("file"))
    runs = len(next(iter(columns.values())))
    if runs > MOST_RUNS:
        raise NotWanted(f"{path}: these are {runs} runs; expected at most {MOST_RUNS}")
    for one in parameters:
        one.values = columns[one.name]
        if one.multiplies and any(isinstance(value, str) for value in one.values):
            raise NotWanted(f'{path}: "{one.name}" has texts; expected numbers, because its [[vary]] multiplies')
    return Design("table", 1, runs, 0, 0, 0, 1, 0, "", networks_given=columns.get(NETWORK, [0] * runs))


def design_of(table, varies_network, parameters, correlations, quantities, given):
    """Of [design]. given: as table of read()."""
    kind = table.text("kind", "plain", list(DESIGNS))
    if kind == "table":
        return table_design(table, varies_network, parameters, given)
    counts = {name: table.whole(name, least=2) if name in DESIGNS[kind] else 0
              for name in ("runs", "networks", "parameters", "points", "directions", "fine_runs", "coarse_per_fine")}
    replicates = table.whole("replicates", 10, least=2) if kind in REPLICATED else 1
    failure = ""
    if kind == "directional sampling":
        counts["runs"] = replicates
        failure = table.text("failure", None, [one.name for one in quantities if one.what == "failed" or one.above or one.below])
        if any(not one.law for one in parameters):
            table.wrong("kind", "another one, because a [[vary]] has a list of values")
    if kind == "two levels":
        counts["runs"] = counts["fine_runs"] * (1 + counts["coarse_per_fine"])
        for level in ("fine_options", "coarse_options"):
            counts[level] = demsolve_options_of(table, level)
        if counts["fine_options"] == counts["coarse_options"]:
            table.wrong("coarse_options", 'others than fine_options, such as ["--zone-size", "12"]')
    seed = table.whole("seed", 1, least=0, most=2**32 - 1)
    if kind == "networks x parameters":
        counts["runs"] = counts["networks"] * counts["parameters"]
    if kind == "sobol indices":
        counts["runs"] = counts["points"] * (2 + len(parameters) + varies_network)
    if kind not in ("plain", "sobol indices", "two levels") and not parameters:
        table.wrong("kind", '"plain", because no [[vary]] has a key')
    if kind == "networks x parameters" and not varies_network:
        table.wrong("kind", "another one, or a [[vary]] with network = true")
    if kind == "sobol indices" and correlations:
        table.wrong("kind", "another one, because Sobol indices are of parameters without correlation")
    if kind == "sobol indices" and len(parameters) + varies_network < 2:
        table.wrong("kind", "another one, or two that vary")
    if kind != "directional sampling" and counts["runs"] % replicates:
        table.wrong("runs", f"a multiple of the {replicates} replicates")
    if counts["runs"] > MOST_RUNS:
        raise NotWanted(f"{table.place()}these are {counts['runs']} runs; expected at most {MOST_RUNS}")
    table.end()
    return Design(kind, seed, **counts, replicates=replicates, failure=failure)


def is_day(value):
    return is_number(value) or isinstance(value, datetime.date) and not isinstance(value, datetime.datetime)


def quantity_of(table):
    what = table.text("what", None, WHAT)
    point = relative_to = component = since = stage = statistic = ""
    date = None
    unit = "1"
    if what == "displacement":
        unit = "mm"
        point = table.text("point")
        relative_to = table.text("relative_to", "")
        component = table.text("component", None, ["x", "y", "length"])
        since = table.text("since", "in situ", ["in situ", "first reading"])
        if "stage" in table.left:
            stage = table.text("stage")
        elif "date" in table.left:
            date = table.get("date", None, is_day, "a date, or a number of days since the start")
    elif what == "blocks":
        statistic = table.text("statistic", None, list(BLOCKS))
        unit = BLOCKS[statistic]
    limits = "a list of numbers, in the unit of the quantity"
    above, below = ([] if what == "failed" else list(map(float, table.several(name, [], is_number, limits)))
                    for name in ("above", "below"))
    name = table.text("name", f"{point} {relative_to and f'relative to {relative_to} '}{component}" if what == "displacement" else statistic and f"blocks, {statistic}" or what)
    place = table.place()
    table.end()
    return Quantity(name, what, unit, point, relative_to, component, since, stage, date, statistic, above, below, place)


def both_ends(quantity):
    """A factor of safety is two quantities: both ends of its bracket."""
    if quantity.what != "factor of safety":
        return [quantity]
    return [dataclasses.replace(quantity, name=f"{quantity.name}{more}", statistic=end) for end, more in zip(ENDS, ("", f", {ENDS[1]}"))]


def stop_of(table, quantities, design):
    hours = table.number("hours", math.inf, above=0)
    wanted = {name: table.number(name, 0.0, above=0) for name in
              ("half_width", "relative_half_width", "probability_half_width")}
    of = ""
    if "of" in table.left and not any(wanted.values()):
        raise NotWanted(f'{table.place("of")}of needs half_width, relative_half_width or probability_half_width')
    if any(wanted.values()):
        of = table.text("of", None, [one.name for one in quantities])
        if design.kind not in EXTENSIBLE:
            raise NotWanted(f'{table.place("of")}of goes with a design of {" or ".join(EXTENSIBLE)}; a "{design.kind}" has all of its runs')
        (quantity,) = (one for one in quantities if one.name == of)
        if wanted["probability_half_width"] and quantity.what != "failed" and not quantity.above + quantity.below:
            table.wrong("probability_half_width", f'above or below in the [[collect]] of "{of}"')
    table.end()
    return Stop(of, **wanted, hours=hours)
