#!/usr/bin/python3
"""Does creepfit survive the faults of real readings?  fits.py PROGRAMS DATA OUT [--only column,slope,lock,ensemble,networks,apart,curve]

Readings are made with other constants than the scene's, noise of .5 mm and a fault. The fits are those of creepfit, many in one
process (apps/creepfit_trials.cpp). Writes the tables of docs/back-analysis.md into OUT. Ends with exit code 1 where a
share of intervals is off 95 percent by more than three binomial standard errors, or fewer than 95 percent of wrong models
are warned of.

column    readings of the column by its closed form (column_closed_form.py), with joints ten times softer; each step of a fit is a run
slope     of the bench slope by the solver, horizontal; a fit takes displacements from polynomials in the factors, found from runs
lock      of the shiplock with joints that neither slip nor open, the same
ensemble  of the column, by an ensemble in place of sensitivities
networks  of small sections, each fitted with other networks
apart     normal and shear constants
"""

import argparse
import collections
import csv
import functools
import itertools
import math
import pathlib
import random
import re
import subprocess
import statistics
import sys
import tempfile
import tomllib

import h5py
import numpy as np

import column_closed_form
from jointcreep import chain

TRUTH = {"kelvin-stiffness": 0.8, "kelvin-viscosity": 1.25, "joint-stiffness": 1.1}
SIGMA = 0.5  # mm
PRECISE = 0.05  # mm; by such readings of the slope factors are resolved also where the first reading is late


# --- Scenes -----------------------------------------------------------------------------------------------------------------


CHANGES = {"stiffness": {"joint-stiffness"}, "kelvin_stiffness": {"joint-stiffness", "kelvin-stiffness"},
           "kelvin_viscosity": {"joint-stiffness", "kelvin-viscosity"}}  # the factors on each constant of a joint


def with_factors(text, factors):
    """The scene with constants of its joints times these factors, as creepfit has them."""
    def times(found):
        directions = {f"{found[2]}-{name}" for name in CHANGES[found[3]]} | CHANGES[found[3]]
        by = math.prod(factor for name, factor in factors.items() if name in directions)
        return f"{found[1]}{float(found[4]) * by!r}"
    return re.sub(r"(?m)^((normal|shear)_(kelvin_stiffness|kelvin_viscosity|stiffness)_MPa\w* = )([\d.e+]+)", times, text)


def with_one_load(text):
    """Only the first stage."""
    begins = [found.start() for found in re.finditer(r"(?m)^\[\[stage\]\]", text)]
    after = re.compile(r"(?m)^\[(?!\[stage\]\])").search(text, begins[-1]).start()
    return text[: begins[1]] + text[after:]


def changed(text, pattern, replacement):
    new, found = re.subn(rf"(?m){pattern}", replacement, text)
    if not found:
        raise ValueError(f"{pattern} is not in the scene")
    return new


def run(*command):
    subprocess.run([*map(str, command)], check=True)


def joints_of(programs, text, folder, realization=0):
    """Path of the joints file of a scene, in a folder of its own."""
    folder.mkdir(exist_ok=True)
    return chain.joints_of(programs, text, folder, "--realization", realization)


class Column:
    """Displacements by the closed form."""

    def __init__(self, text):
        self.column = column_closed_form.column_of(tomllib.loads(with_factors(text, TRUTH)))
        self.last, self.step, self.every, self.dates = 40, 30, 0.5, []
        self.series = [(name, "y") for name in sorted(self.column.points, reverse=True)]  # C, which stays longest, first

    def days(self, series):
        """From which day on to which."""
        height = self.column.points[series[0]]
        return 1, min((removal.day for removal in self.column.removals if removal.bottom < height), default=self.last + 1)

    @functools.cache
    def value(self, series, day):
        return 1e3 * column_closed_form.rise(self.column, self.column.points[series[0]], day)


class Solved:
    """Displacements by the solver. A point counts from its first reading."""

    def __init__(self, programs, joints, components, every):
        self.every = every
        result = joints.with_suffix(".result.h5")
        run(programs / "demsolve", "-q", joints, "-o", result)
        with h5py.File(result) as file:
            history = file["history"]
            self.time = history["time"][:].tolist()
            names = [name.decode() for name in history["point"][:]]
            first = history["first_reading_row"][:].tolist()
            moved = 1e3 * history["displacement"][:].reshape(len(self.time), len(names), 2)
            present = history["present"][:].reshape(len(self.time), len(names))
        self.dates = [day for day, n in collections.Counter(self.time).items() if n > 1]
        self.last = self.time[-1]
        self.step = round(0.75 * self.last)
        kept = [i for i in range(len(names)) if present[-1][i]]
        self.series = [(names[i], component) for i in kept for component in components]
        self.moved = {(names[i], component): moved[:, i, "xy".index(component)].tolist() for i in kept for component in components}
        for series in self.series:
            zero = self.moved[series][first[names.index(series[0])]]
            self.moved[series] = [value - zero for value in self.moved[series]]
        self.first = {names[i]: self.time[first[i]] for i in kept}

    def days(self, series):
        return self.first[series[0]], self.last

    @functools.cache
    def value(self, series, day):
        after = next(row for row, time in enumerate(self.time) if time > day or row == len(self.time) - 1)
        time, moved = self.time, self.moved[series]
        share = (day - time[after - 1]) / (time[after] - time[after - 1])
        return moved[after - 1] + share * (moved[after] - moved[after - 1])


# --- Readings ---------------------------------------------------------------------------------------------------------------


def days_of(kind, first, last, every, chance):
    n = int((last - first) / every)
    even = [first + every * i for i in range(n)]
    if kind == "uneven":
        return [first + (last - first) * ((i + chance.random()) / n) ** 2 for i in range(n)]  # ever less often
    if kind == "late":
        return [day for day in even if day >= first + 0.1 * (last - first)]
    if kind == "missing":
        return [day for day in even if chance.random() > 0.4 and not 0.55 < (day - first) / (last - first) < 0.67]
    return even


def readings(site, seed, days=None, outlier=0, step=0, drift=0, offset=0, correlation=0, sigma=SIGMA):
    """Rows of time_day, point, component, displacement_mm. Faults are of one series, except noise and zeros."""
    chance, every = random.Random(seed), site.every
    rows = []
    for place, series in enumerate(site.series):
        first, gone = site.days(series)
        lasting, before = chance.gauss(0, 1), None
        for day in days_of(days, first, site.last, every, chance):
            if day >= gone or any(abs(day - date) < 0.01 for date in site.dates):
                continue
            if before is not None:
                share = correlation ** ((day - before) / every) if correlation else 0
                lasting = share * lasting + math.sqrt(1 - share * share) * chance.gauss(0, 1)
            value = site.value(series, day) + sigma * lasting
            if place == 0:
                value += (step if day >= site.step else 0) + drift * (day - first)
            rows.append([day, *series, value + offset * (-1) ** place])
            before = day
    if outlier:
        rows[chance.randrange(len(rows))][3] += outlier * sigma * chance.choice((-1, 1))
    return rows


def write(path, rows, sigma=SIGMA):
    with open(path, "w", newline="") as file:
        csv.writer(file).writerows([["time_day", "point", "component", "displacement_mm", "sigma_mm"],
                                    *([f"{day:.9g}", point, component, f"{value:.7g}", sigma] for day, point, component, value in rows)])


# --- Fits -------------------------------------------------------------------------------------------------------------------


def fits(programs, factors, response, joints, trials, folder):
    """Yields (key, number of networks, {factor: row}) of trials (key, rows, sigma, networks, options)."""
    with tempfile.TemporaryDirectory(dir=folder) as place:
        place = pathlib.Path(place)
        keys = {}
        with open(place / "list", "w") as file:
            for number, (key, rows, sigma, networks, options) in enumerate(trials):
                path = place / f"{number}.csv"
                write(path, rows, sigma)
                keys[str(path)] = key
                print(path, networks, *options, file=file)
        with open(place / "list") as file:
            command = [programs / "creepfit_trials", ",".join(factors), response, *joints]
            with subprocess.Popen(command, stdin=file, stdout=subprocess.PIPE, text=True) as process:
                for (path, networks), rows in itertools.groupby(csv.DictReader(process.stdout),
                                                                lambda row: (row["readings"], row["networks"])):
                    yield keys[path], int(networks), {row["factor"]: row for row in rows}
            if process.returncode:
                raise subprocess.CalledProcessError(process.returncode, "creepfit_trials")


def holds(row, truth):
    return float(row["low_95"] or 0) <= truth <= float(row["high_95"] or math.inf)


def is_95(share, n):
    return abs(share - 0.95) <= 3 * math.sqrt(0.95 * 0.05 / n)


class Table:
    """Rows of a table as they come."""

    def __init__(self, path, head):
        self.path, self.lines = path, [f"| {' | '.join(head)} |", "|" + "---|" * len(head)]

    def add(self, *row):
        self.lines.append(f"| {' | '.join(map(str, row))} |")
        print(self.lines[-1], flush=True)
        self.path.write_text("\n".join([*self.lines, ""]))


def cases_of(drift, base):
    """name: what is done to readings, and the options that know of it."""
    return {
        "even readings": ({}, base),
        "uneven readings": ({"days": "uneven"}, base),
        "late first reading": ({"days": "late"}, base),
        "missing readings": ({"days": "missing"}, base),
        "an outlier of 10 sigma": ({"outlier": 10}, [*base, "--robust"]),
        "no outlier": ({}, [*base, "--robust"]),
        "a step of 2 mm": ({"step": 2}, [*base, "--steps"]),
        f"drift of {drift:g} mm/day": ({"drift": drift}, [*base, "--drift"]),
        "unknown zeros of 2 mm": ({"offset": 2}, ["--offset"]),
        "correlated noise": ({"correlation": 0.7}, [*base, "--correlated-noise"]),
    }


def without(name, cases):
    """Cases whose fit has the options of even readings alone: what it does not know of."""
    return {case: (faults, cases["even readings"][1]) for case, (faults, _) in cases.items() if case.startswith(name)}


def chosen(given, cases):
    """Those that are wanted: all, or those of --cases."""
    return {name: case for name, case in cases.items() if not given.cases or name in given.cases}


WRONG = "an outlier", "a step", "drift", "unknown zeros", "correlated noise"


def trials_of(site, cases, n):
    for name, (faults, options) in cases.items():
        sigma = faults.get("sigma", SIGMA)
        words = [word for option in options for word in (f"--steps {site.step:g}" if option == "--steps" else option).split()]
        for seed in range(n):
            yield name, readings(site, seed, **faults), sigma, "0", words


def groups_of(found, n):
    """(name, its n groups), as soon as they are there. None where there is no fit."""
    groups = collections.defaultdict(list)
    for name, _, group in found:
        groups[name].append(group if "" not in group else None)
        if len(groups[name]) == n:
            yield name, groups.pop(name)


def is_warned(group):
    return next(iter(group.values()))["warned"] == "yes"


def add_coverage(table, site, cases, found, n, failed, names_unresolved=False):
    """Shares of the fits with a result. A factor at a bound has the interval from 0 to infinity, and is named as not resolved or as at
    its bound."""
    for name, groups in groups_of(found, n):
        done = [group for group in groups if group]
        shares = [sum(holds(group[factor], truth) for group in done) / max(1, len(done)) for factor, truth in TRUTH.items()]
        if not done or not all(is_95(share, len(done)) for share in shares):
            failed.append(f"{site}, {name}")
        warned = sum(is_warned(group) for group in done)
        unresolved = [sum(group[factor]["resolved"] == "no" or not group[factor]["high_95"] for group in done) / max(1, len(done))
                      for factor in TRUTH]
        table.add(site, name, " ".join(cases[name][1]), n, *(f"{share:.4f}" for share in shares), f"{warned / n:.3f}", n - len(done),
                  *([" ".join(f"{share:.3f}" for share in unresolved)] if names_unresolved else []))


def add_wrong(table, site, found, n, failed):
    for name, groups in groups_of(found, n):
        warned = sum(group is None or is_warned(group) for group in groups) / n  # no fit is no wrong fit
        if warned < 0.95:
            failed.append(f"{site}, {name}, not known")
        table.add(site, name, n, f"{warned:.3f}")


# --- Tables -----------------------------------------------------------------------------------------------------------------


def softer(text):
    """The column with joints ten times softer, so that it moves by tens of mm."""
    return with_factors(text, {"joint-stiffness": 0.1})


def column(given, tables, failed):
    text = softer((given.data / "column/scene.toml").read_text())
    three, one = (joints_of(given.programs, its, given.out / name)
                  for name, its in (("three-loads", text), ("one-load", with_one_load(text))))
    site, single = Column(text), Column(with_one_load(text))
    all_cases = cases_of(0.1, [])
    cases, wrong = chosen(given, all_cases), chosen(given, without(WRONG, all_cases))
    one_load, no_loads = chosen(given, {"one load": ({}, [])}), chosen(given, {"loads that the scene does not have": ({}, [])})

    def found(joints, site, cases, n):
        return fits(given.programs, TRUTH, response_of(given.runs, 4, NEAR), [joints], trials_of(site, cases, n), given.out) if cases else ()

    add_coverage(tables["fits"], "column", cases, found(three, site, cases, given.n), given.n, failed)
    add_coverage(tables["fits"], "column", one_load, found(one, single, one_load, given.n), given.n, failed)
    add_wrong(tables["wrong"], "column", found(three, site, wrong, given.wrong), given.wrong, failed)
    add_wrong(tables["wrong"], "column", found(one, site, no_loads, given.wrong), given.wrong, failed)
    if cases:
        compare(given, tables["checks"], "column", three, trials_of(site, cases, 5), 5 * len(cases))


NEAR = {"kelvin-stiffness": (0.5, 1.4), "kelvin-viscosity": (0.7, 2.2), "joint-stiffness": (0.75, 1.6)}  # around truth and start
WIDE = {"kelvin-stiffness": (0.35, 2), "kelvin-viscosity": (0.4, 4.5), "joint-stiffness": (0.55, 2)}


def response_of(runs, checks, bounds):
    """Polynomials of degree 5 from so many runs, for creepfit_trials."""
    return ",".join(["5", str(runs), str(checks), *(f"{low}:{high}" for low, high in bounds.values())])


def ensemble(given, tables, failed):
    """The column by --ensemble, every step a run: without sensitivities, with a prior that the truth is near."""
    text = softer((given.data / "column/scene.toml").read_text())
    joints, site = joints_of(given.programs, text, given.out / "three-loads"), Column(text)
    cases = chosen(given, {name: (faults, [*options, f"--ensemble {MEMBERS}"]) for name, (faults, options) in cases_of(0.1, []).items()
                           if name in ("even readings", "late first reading", "drift of 0.1 mm/day")})
    factors = [f"{factor}=0.25:4" for factor in TRUTH]
    found = fits(given.programs, factors, "runs", [joints], trials_of(site, cases, given.n_ensemble), given.out)
    groups = ((name, number, {factor.partition("=")[0]: row for factor, row in group.items()}) for name, number, group in found)
    add_coverage(tables["fits"], "column", cases, groups, given.n_ensemble, failed)


MEMBERS = 24  # of an ensemble


def compare(given, table, site, joints, trials, n):
    """How far fits are from those whose every step is a run, as creepfit's."""
    trials = [(number, *one[1:]) for number, one in zip(range(n), trials)]
    ours, exact = ({number: group for number, _, group in fits(given.programs, TRUTH, response, [joints], trials, given.out)}
                   for response in (response_of(given.runs, 4, NEAR), "runs"))
    add_difference(table, site, ours, exact)


def add_difference(table, site, ours, exact):
    """In standard errors, of factors whose intervals have two ends. An end that is there once only is infinitely far off."""
    off = 0
    for number, group in exact.items():
        for factor, row in group.items():
            value, *ends = ([float(one[name] or math.inf) for one in (row, ours[number][factor])] for name in ("value", "low_95", "high_95"))
            (low, our_low), (high, our_high) = ends
            if math.isinf(low) != math.isinf(our_low) or math.isinf(high) != math.isinf(our_high):
                off = math.inf
            elif not math.isinf(low) and not math.isinf(high):
                error = math.log(high / low) / 3.92
                off = max(off, *(abs(math.log(our / end)) / error for end, our in (value, (low, our_low), (high, our_high))))
    table.add(site, len(exact), f"{off:.3f}")


def by_solver(given, tables, failed, name, text, components, every, drift, n, bounds, intervals=(), more=None):
    """A section whose readings count from each point's first one: all fits have --offset. Displacements are polynomials within `bounds`;
    steps beyond are runs. `intervals` are options of the fits whose coverage is counted. more: cases beside those of cases_of()."""
    joints = joints_of(given.programs, text, given.out / name)
    made = joints_of(given.programs, with_factors(text, TRUTH), given.out / f"{name}-made")
    site = Solved(given.programs, made, components, every)
    cases = {**cases_of(drift, ["--offset"]), **(more or {})}
    del cases["unknown zeros of 2 mm"]  # as all fits
    wrong = chosen(given, without(WRONG, cases))
    cases = {case: (faults, [*options, *intervals]) for case, (faults, options) in chosen(given, cases).items()}
    known = [((one[0], True), *one[1:]) for one in trials_of(site, cases, n)]
    unknown = [((one[0], False), *one[1:]) for one in trials_of(site, wrong, n)]
    # Readings leave the factors open by more than those of the column do.
    factors = [f"{factor}={low}:{high}" for factor, (low, high) in WIDE.items()]
    found = fits(given.programs, factors, response_of(given.runs_solver, 1, bounds), [joints], known + unknown, given.out)
    first = {}

    def kept(groups):
        for (case, _), number, group in groups:
            first.setdefault(case, group)
            yield case, number, group

    for knows, groups in itertools.groupby(found, lambda one: one[0][1]):
        if knows:
            add_coverage(tables["fits"], name, cases, kept(groups), n, failed, names_unresolved=True)
        else:
            add_wrong(tables["wrong"], name, ((key[0], *rest) for key, *rest in groups), n, failed)
    if given.checks:
        trials = [(case, *rest) for (case, _), *rest in known[:n * given.checks:n]]
        exact = {case: group for case, _, group in fits(given.programs, factors, "runs", [joints], trials, given.out)}
        add_difference(tables["checks"], name, first, exact)


def slope(given, tables, failed):
    by_solver(given, tables, failed, "slope", (given.data / "slope/scene.toml").read_text(), "x", 7, 0.01, given.n_slope, WIDE,
              ["--profile-intervals"], {f"late first reading, sigma {PRECISE:g} mm": ({"days": "late", "sigma": PRECISE}, ["--offset"])})


def lock(given, tables, failed):
    """With joints that neither slip nor open: where they do, polynomials are off by more than the noise."""
    scene = given.out / "lock.toml"
    subprocess.run([sys.executable, pathlib.Path(__file__).parents[1] / "shiplock/variant.py", given.data / "shiplock/section-a.toml",
                    "--linear", "-o", scene], check=True)
    by_solver(given, tables, failed, "lock", scene.read_text(), "x", 28, 0.01, given.n_lock, NEAR)


def small(given, text):
    """A section of a few blocks, whose joints neither slip nor open, with more points."""
    text = changed(changed(changed(text, "^cohesion_MPa = 0.02", "cohesion_MPa = 2"), "^tensile_strength_MPa = 0$", "tensile_strength_MPa = 2"),
                   "^end = 10", "end = 20")
    more = {"behind": [2, 9.5], "wall": [5.5, 7], "floor": [8, 5.7], "inside": [3, 5.5]}
    return changed(text, r"^step_days = 2", "step_days = 1") + "".join(
        f'\n[[point]]\nname = "{name}"\nat_m = {place}\n' for name, place in more.items())


def networks(given, tables, failed):
    """Each network once that of the site, fitted with others drawn by chance."""
    text = small(given, given.small.read_text())
    # A network in which nothing of what is dug or read is cut is as good as any other; one that cannot be made is left out.
    joints = [joints_of(given.programs, text, given.out / f"site-{k}", k) for k in range(given.n_networks)]
    sites = [Solved(given.programs, joints_of(given.programs, with_factors(text, TRUTH), given.out / f"site-{k}-made", k), "xy", 1)
             for k in range(given.n_networks)]
    chance = random.Random(1)
    trials = []
    for a_day in 1, 10:
        for k, site in enumerate(sites):
            others = chance.sample([other for other in range(given.n_networks) if other != k], 20)
            site.every, site.first = 1 / a_day, dict.fromkeys(site.first, 4.05)
            trials.append(((a_day, k), readings(site, k, sigma=0.02), 0.02, ",".join(map(str, others)), []))
    groups = collections.defaultdict(list)
    for (a_day, _), n, group in fits(given.programs, TRUTH, "runs", joints, trials, given.out):
        groups[a_day, n].append(group)
    for (a_day, n), found in sorted(groups.items()):
        # No interval, because the scatter is too large, is one to infinity.
        wide = [math.log(float(row["high_95"]) / float(row["low_95"])) if row["low_95"] and row["high_95"] else math.inf
                for group in found if "" not in group for row in [group["kelvin-viscosity"]]]
        shares = [sum("" not in group and holds(group[factor], truth) for group in found) / len(sites) for factor, truth in TRUTH.items()]
        error = [abs(math.log(float(group["kelvin-viscosity"]["value"]) / TRUTH["kelvin-viscosity"])) for group in found
                 if "" not in group and group["kelvin-viscosity"]["value"]]
        if n > 1 and not all(is_95(share, len(sites)) for share in shares):
            failed.append(f"{n} networks, {a_day} readings a day")
        tables["networks"].add(a_day, n, len(sites), *(f"{share:.3f}" for share in shares), f"{math.exp(statistics.median(error)):.3f}",
                               f"{math.exp(statistics.median(wide)):.2f}", len(sites) - sum("" not in group for group in found))


APART = {"normal-kelvin-stiffness": 0.8, "shear-kelvin-stiffness": 1.2, "normal-kelvin-viscosity": 1.25, "shear-kelvin-viscosity": 0.8,
         "normal-joint-stiffness": 1.1, "shear-joint-stiffness": 0.9}


def apart(given, tables, failed):
    """Normal and shear constants, where readings hold both, and in the column, which has no shear."""
    block = small(given, given.small.read_text())
    rise = softer((given.data / "column/scene.toml").read_text())
    normal = {name: TRUTH[name.removeprefix("normal-")] for name in APART if name.startswith("normal")}
    for name, text, truth, sigma in (
            ("few blocks", block, APART, 0.002), ("few blocks", block, APART, 0.02),
            ("column", rise, {**normal, "shear-kelvin-stiffness": 1}, SIGMA)):
        joints = joints_of(given.programs, text, given.out / "apart")
        site = (Column(text) if name == "column"
                else Solved(given.programs, joints_of(given.programs, with_factors(text, truth), given.out / "apart-made"), "xy", 0.5))
        trials = [(name, readings(site, seed, sigma=sigma), sigma, "0", []) for seed in range(given.n_apart)]
        groups = [group for _, _, group in fits(given.programs, truth, "runs", [joints], trials, given.out)]
        done = [group for group in groups if "" not in group]
        for factor, value in truth.items():
            rows = [group[factor] for group in done]
            resolved = [row for row in rows if row["resolved"] == "yes"]
            held = sum(holds(row, value) for row in rows) / len(done)
            if len(resolved) == len(done) and not is_95(held, len(done)):
                failed.append(f"{factor}, {name}")
            widths = [math.sqrt(float(row["high_95"]) / float(row["low_95"])) for row in resolved if row["low_95"] and row["high_95"]]
            tables["apart"].add(name, sigma, factor, value, len(groups), f"{held:.3f}", f"x/ {statistics.median(widths):.3f}" if widths else "-",
                                f"{1 - len(resolved) / len(done):.3f}", len(groups) - len(done))


def curve(given, tables, failed):
    """A drift in one curve of one joint: how often creepfit warns of it, and how often the best test could."""
    elastic, crept, time = 10, 12.5, 15.6  # mm, mm, days
    days = np.arange(0, 40.25, 0.5)

    def crept_by(tau):
        return 1 - np.exp(-days / tau)

    def distance(moved, tau):
        """From the curves with this retardation time."""
        basis, _ = np.linalg.qr(np.column_stack([np.ones_like(days), crept_by(tau)]))
        return np.linalg.norm(moved - basis @ (basis.T @ moved))

    normal = statistics.NormalDist()
    for drift in 0, 0.1, 0.2, 0.4, 0.8:
        exact = elastic + crept * crept_by(time) + drift * days
        # Of all tests of a level, that of Neyman and Pearson between this curve and the nearest without drift is right most often.
        nearest = min(distance(exact, tau) for tau in np.geomspace(1, 1e4, 2001)) / SIGMA
        bound = 1 - normal.cdf(normal.inv_cdf(0.99) - nearest)
        warned = 0
        for seed in range(given.n_curve):
            noise = np.random.default_rng(seed).standard_normal(len(days)) * SIGMA
            path = given.out / "curve.csv"
            with open(path, "w", newline="") as file:
                csv.writer(file).writerows([["time_day", "displacement_mm", "sigma_mm"],
                                            *zip(days, exact + noise, itertools.repeat(SIGMA))])
            done = subprocess.run([given.programs / "creepfit", "-q", path, "-o", given.out / "found.csv"], capture_output=True, text=True)
            warned += "no noise" in done.stderr or "worse than the readings' sigma" in done.stderr
        tables["curve"].add(drift, f"{nearest:.2f}", f"{bound:.3f}", given.n_curve, f"{warned / given.n_curve:.3f}")


TABLES = {
    "apart": ["section", "sigma, mm", "factor", "truth", "fits", "intervals that contain it", "median interval", "named as not resolved", "no fit"],
    "curve": ["drift, mm/day", "distance from the nearest curve without drift, sigma", "no test warns more often than", "fits", "warned of"],
    "networks": ["readings a day", "networks", "sites", *TRUTH, "half of eta within x/", "interval of eta, high over low", "no fit"],
    "fits": ["section", "readings", "options", "fits", *TRUTH, "warned of", "no fit"],
    "checks": ["section", "fits", "largest difference, standard errors"],
    "wrong": ["section", "readings", "fits", "warned of"],
}
SECTIONS = {one.__name__: one for one in (column, slope, lock, ensemble, networks, apart, curve)}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("data", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--only", default=",".join(SECTIONS))
    parser.add_argument("--cases", type=lambda text: text.split(","), help="of the readings, by name; all by default")
    parser.add_argument("--n", type=int, default=2000)
    parser.add_argument("--n-slope", type=int, default=200)
    parser.add_argument("--n-lock", type=int, default=20)
    parser.add_argument("--n-ensemble", type=int, default=200)
    parser.add_argument("--n-networks", type=int, default=100)
    parser.add_argument("--n-apart", type=int, default=200)
    parser.add_argument("--n-curve", type=int, default=500)
    parser.add_argument("--wrong", type=int, default=200)
    parser.add_argument("--runs", type=int, default=45, help="of the column for its polynomials")
    parser.add_argument("--runs-solver", type=int, default=30, help="of the slope and the lock")
    parser.add_argument("--checks", type=int, default=2, help="cases of the slope and the lock of which a fit is repeated by runs")
    given = parser.parse_args()
    given.small = pathlib.Path(__file__).parents[1] / "reliability/small.toml"
    given.out.mkdir(parents=True, exist_ok=True)
    failed = []
    for name in given.only.split(","):
        heads = TABLES | ({"fits": [*TABLES["fits"], "not resolved: E, eta, K"]} if name in ("slope", "lock") else {})
        SECTIONS[name](given, {table: Table(given.out / f"{table}-{name}.md", head) for table, head in heads.items()}, failed)
    if failed:
        sys.exit("fits.py: not as expected: " + "; ".join(failed))


if __name__ == "__main__":
    main()
