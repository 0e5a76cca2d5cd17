#!/usr/bin/python3
"""Does creepfit survive the faults of real readings?  fits.py PROGRAMS SCENE.toml OUT [--n FITS] [--wrong FITS] [--jobs N]

Readings of a column whose joints are ten times softer than the scene's, with other constants than these, by the closed
form (column_closed_form.py), with noise of .5 mm and a fault. creepfit finds the factors through the solver, --n times for
each fault with the option that models it: a row has the share of 95 percent intervals that hold the truth. Then --wrong
times without the option: how many are warned of. Writes fits.md and wrong.md into OUT. Ends with exit code 1 where a
share is off 95 percent by more than three binomial standard errors, or fewer than 95 percent of the wrong ones are warned of.
"""

import argparse
import concurrent.futures
import copy
import csv
import math
import pathlib
import random
import re
import subprocess
import sys
import tomllib

import column_closed_form

TRUTH = {"kelvin-stiffness": 0.8, "kelvin-viscosity": 1.25, "joint-stiffness": 1.1}
SIGMA = 0.5  # mm
LAST = 40
EVEN = [1 + 0.5 * i for i in range(78)]
STEP = 30  # day
# name: what is done to readings, and the options that know of it
CASES = {
    "even readings": ({}, []),
    "uneven readings": ({"days": "uneven"}, []),
    "late first reading": ({"days": "late"}, []),
    "missing readings": ({"days": "missing"}, []),
    "an outlier of 10 sigma": ({"outlier": 10}, ["--robust"]),
    "no outlier": ({}, ["--robust"]),
    "a step of 2 mm": ({"step": 2}, ["--steps", str(STEP)]),
    "one load": ({"scene": "one load"}, []),
    "drift of 0.1 mm/day": ({"drift": 0.1}, ["--drift"]),
    "unknown zeros of 2 mm": ({"offset": 2}, ["--offset"]),
    "correlated noise": ({"correlation": 0.7}, ["--correlated-noise"]),
}
# What the fit does not know of. The last: readings of three loads, a scene with one.
WRONG = ["an outlier of 10 sigma", "a step of 2 mm", "drift of 0.1 mm/day", "unknown zeros of 2 mm", "correlated noise", "loads that the scene does not have"]


def softer(text):
    """The scene with joints ten times softer, so that it moves by tens of mm."""
    return re.sub(r"(?m)^((?:normal|shear)_\w+_MPa\w* = )(\d+)", lambda found: f"{found[1]}{int(found[2]) / 10:g}", text)


def with_one_load(text):
    """Only block 1 is removed."""
    begins = [found.start() for found in re.finditer(r"(?m)^\[\[stage\]\]", text)]
    after = re.compile(r"(?m)^\[(?!\[stage\]\])").search(text, begins[-1]).start()
    return text[: begins[1]] + text[after:]


def column_with(text):
    column = column_closed_form.column_of(tomllib.loads(text))
    for joint in column.joints:
        joint.stiffness *= TRUTH["joint-stiffness"]
        joint.kelvin_stiffness *= TRUTH["joint-stiffness"] * TRUTH["kelvin-stiffness"]
        joint.kelvin_viscosity *= TRUTH["joint-stiffness"] * TRUTH["kelvin-viscosity"]
    return column


def days_of(kind, chance):
    if kind == "uneven":
        return [1 + (LAST - 1) * ((i + chance.random()) / 60) ** 2 for i in range(60)]  # ever less often
    if kind == "late":
        return [day for day in EVEN if day >= 5]
    if kind == "missing":
        return [day for day in EVEN if chance.random() > 0.4 and not 22 < day < 27]
    return EVEN


def readings(column, seed, days=None, outlier=0, step=0, drift=0, offset=0, correlation=0):
    """Rows of time_day, point, component, displacement_mm."""
    chance = random.Random(seed)
    rows = []
    for place, (name, height) in enumerate(sorted(column.points.items(), reverse=True)):  # C first
        gone = min((removal.day for removal in column.removals if removal.bottom < height), default=LAST + 1)
        times = [day for day in days_of(days, chance) if day < gone]
        lasting, last = chance.gauss(0, 1), None
        for day in times:
            if last is not None:
                share = correlation ** ((day - last) / 0.5) if correlation else 0
                lasting = share * lasting + math.sqrt(1 - share * share) * chance.gauss(0, 1)
            last = day
            value = 1e3 * column_closed_form.rise(column, height, day) + SIGMA * lasting
            if place == 0:  # the fault is of one instrument, except noise and zeros
                value += (step if day >= STEP else 0) + drift * (day - times[0])
            rows.append([day, name, "y", value + offset * (-1) ** place])
    if outlier:
        rows[chance.randrange(len(rows))][3] += outlier * SIGMA * chance.choice((-1, 1))
    return rows


def fit(programs, joints, folder, seed, rows, options):
    """Whether each factor's interval holds the truth, and whether there was a warning."""
    path, found = folder / f"readings-{seed}.csv", folder / f"factors-{seed}.csv"
    with open(path, "w", newline="") as file:
        csv.writer(file).writerows([["time_day", "point", "component", "displacement_mm", "sigma_mm"],
                                    *([*row, SIGMA] for row in rows)])
    done = subprocess.run([programs / "creepfit", joints, "-q", "--measurements", path, "--fit", ",".join(TRUTH), *options, "-o", found],
                          capture_output=True, text=True)
    path.unlink()
    if done.returncode:
        return None
    with open(found, newline="") as file:
        table = {row["factor"]: row for row in csv.DictReader(file)}
    found.unlink()
    held = [float(table[name]["low_95"] or 0) <= truth <= float(table[name]["high_95"] or math.inf) for name, truth in TRUTH.items()]
    return held, "no noise" in done.stderr or "worse than the readings' sigma" in done.stderr


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("scene", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--n", type=int, default=2000)
    parser.add_argument("--wrong", type=int, default=200)
    parser.add_argument("--jobs", type=int, default=1)
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    joints, columns = {}, {}
    for name, text in ("three loads", softer(given.scene.read_text())), ("one load", with_one_load(softer(given.scene.read_text()))):
        path = given.out / f"{name.replace(' ', '-')}.toml"
        path.write_text(text)
        network, joints[name] = path.with_suffix(".network.h5"), path.with_suffix(".joints.h5")
        for program, read, write in ("jointgen", path, network), ("strength-averaging", network, joints[name]):
            subprocess.run([given.programs / program, "-q", read, "-o", write], check=True)
        columns[name] = column_with(text)
    pool = concurrent.futures.ThreadPoolExecutor(given.jobs)

    def fits(case, options, n, made="three loads", known=None):
        case = copy.copy(case)
        made = case.pop("scene", made)
        return list(pool.map(lambda seed: fit(given.programs, joints[known or made], given.out, seed,
                                              readings(columns[made], seed, **case), options), range(n)))

    failed = []
    most = 3 * math.sqrt(0.95 * 0.05 / given.n)
    lines = [f"| readings | options | fits | {' | '.join(TRUTH)} | warned of | no fit |", "|---|---|---|" + "---|" * (len(TRUTH) + 2)]
    for name, (case, options) in CASES.items():
        found = fits(case, options, given.n)
        done = [one for one in found if one]
        shares = [sum(held[i] for held, _ in done) / len(found) for i in range(len(TRUTH))]
        if any(abs(share - 0.95) > most for share in shares):
            failed.append(name)
        lines.append(f"| {name} | {' '.join(options)} | {len(found)} | {' | '.join(f'{share:.4f}' for share in shares)} | "
                     f"{sum(warned for _, warned in done) / len(found):.3f} | {len(found) - len(done)} |")
        print(lines[-1], flush=True)
    (given.out / "fits.md").write_text("\n".join([*lines, ""]))

    lines = ["| readings | fits | warned of |", "|---|---|---|"]
    for name in WRONG:
        if name == "loads that the scene does not have":
            found = fits({}, [], given.wrong, made="three loads", known="one load")
        else:
            found = fits(CASES[name][0], [], given.wrong)
        # No fit is no wrong fit.
        warned = sum(one is None or one[1] for one in found) / len(found)
        if warned < 0.95:
            failed.append(f"{name}, not known")
        lines.append(f"| {name} | {len(found)} | {warned:.3f} |")
        print(lines[-1], flush=True)
    (given.out / "wrong.md").write_text("\n".join([*lines, ""]))
    if failed:
        sys.exit("fits.py: not as wanted: " + "; ".join(failed))


if __name__ == "__main__":
    main()
