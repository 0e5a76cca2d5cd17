#!/usr/bin/python3
"""Finds constants of the lock's joints back by creepfit, from noisy readings of the lock itself with other constants.

    back_analysis.py PROGRAMS SCENE.toml [--slip] -o OUT
    back_analysis.py PROGRAMS SCENE.toml --sites 1 4 --networks 0 2 3 5 6 -o OUT

The readings are those of a run of the same network whose joints have K times 1.2, and E and eta over K times 0.7:
horizontal, about every 28 days from each point's first reading to the end, less the first one, with normal noise of
1 mm (standard deviation) in each. Joints neither slip nor open, there and in the fit; with --slip they do both. In OUT:
readings.csv, factors.csv, fitted.csv (for plot_fit.py), creepfit.txt and creepfit.md.

With --sites the readings are of these networks, one after the other, and the fit does not know them: it has the first of
--networks alone, and then all of them. OUT/sites.md has the factors found.
"""

import argparse
import csv
import itertools
import os
import pathlib
import random
import resource
import sys
import tempfile
import tomllib

import study
from jointcreep import files

MADE = {"joint-stiffness": 1.2, "kelvin-stiffness": 0.7, "kelvin-viscosity": 0.7}  # as creepfit's factors
WORDS = {"joint-stiffness": "on K, E and eta together", "kelvin-stiffness": "on E, in addition",
         "kelvin-viscosity": "on eta, in addition"}
SHORT = {"joint-stiffness": "K", "kelvin-stiffness": "E", "kelvin-viscosity": "eta"}
SIGMA = 1.0  # of a reading [mm]


def readings(result, position, seed=1):
    """(day, point, x [mm]) of every reading, since the point's first one; none on the days of stages."""
    noise = random.Random(seed)
    days = result["days"]
    for i, name in enumerate(result["names"]):
        first, away = result["first"][i], -1 if position[name] > 0 else 1  # x points north, total toward the lock
        start = max(row for row, day in enumerate(days) if day == first)  # after the stage of that day
        error = noise.gauss(0, SIGMA)
        for row, day in enumerate(days):
            if day > first and days.count(day) == 1:
                moved = away * (result["total"][row][i] - result["total"][start][i])
                yield day, name, moved + noise.gauss(0, SIGMA) - error


def processor_time():
    """Of all programs that have been run so far [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def markdown(factors, number, seconds):
    lines = ["| factor | made with | found | 95 percent |", "|---|---|---|---|"]
    for row in factors:
        low, high = float(row["low_95"]), float(row["high_95"])
        lines.append(f"| {WORDS[row['factor']]} | {MADE[row['factor']]} | {float(row['value']):.3f} "
                     f"| {low:.3f} to {high:.3f} |")
    fit = factors[0]  # what is of the whole fit is the same in each
    pairs = ", ".join(f"{SHORT[a['factor']]} and {SHORT[b['factor']]} {float(a['correlation_' + b['factor']]):.2f}"
                      for a, b in itertools.combinations(factors, 2))
    told = [f"{number} readings with noise of {SIGMA:g} mm; chi squared {float(fit['chi_squared']):.0f} of "
            f"{fit['degrees_of_freedom']} degrees of freedom.", f"Correlation of the factors' logarithms: {pairs}."]
    if fit["weak_combination_times"]:
        together = " with ".join(f"{SHORT[row['factor']]} x {float(row['weak_combination_times']):.3f}" for row in factors)
        told.append(f"`creepfit` warns of {together}, which these readings hardly tell.")
    told.append(f"{fit['runs']} runs, {seconds:.0f} s of processor time.")
    return "\n".join([*lines, "", *told]) + "\n"


def written_readings(programs, scene, law, number, path):
    """Writes the readings of a network as creepfit reads them. Returns how many there are."""
    result = study.computed(programs, scene, [*law, "--stiffness-times", MADE["joint-stiffness"],
                                              "--kelvin-times", MADE["kelvin-stiffness"]], number)
    with open(scene, "rb") as file:
        position = {point["name"]: point["at_m"][0] for point in tomllib.load(file)["point"]}
    rows = list(readings(result, position))
    with open(path, "w", encoding="utf-8") as file:
        print("time_day,point,component,displacement_mm,sigma_mm", file=file)
        for day, name, value in rows:
            print(f"{day:.12g},{name},x,{value:.4f},{SIGMA:g}", file=file)
    return len(rows)


def rows_in(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def found_words(row):
    """A factor with its interval, and whether that has the true one."""
    if not row["low_95"] or not row["high_95"]:
        return "not resolved"
    value, low, high = (float(row[name]) for name in ("value", "low_95", "high_95"))
    return f"{value:.2f} ({low:.2f} to {high:.2f}){'' if low <= MADE[row['factor']] <= high else ', true factor outside'}"


def sites_markdown(found, networks):
    """found: {site: (rows of the fit with one network, rows of that with all)}."""
    words = "networks " + ", ".join(map(str, networks))
    lines = [f"| readings of network | factor | made with | found with network {networks[0]} | found with {words} |", "|---|---|---|---|---|"]
    for site, fits in found.items():
        for one, several in zip(*fits, strict=True):
            lines.append(f"| {site} | {WORDS[one['factor']]} | {MADE[one['factor']]} | {found_words(one)} | {found_words(several)} |")
    return "\n".join(lines) + "\n"


def analyse_sites(programs, scene, sites, networks, out):
    """Readings of some networks, fitted with others."""
    found = {}
    with tempfile.TemporaryDirectory(dir=out, prefix="sites.partial-") as folder:
        folder, joints = pathlib.Path(folder), []
        for number in networks:
            (folder / str(number)).mkdir()
            joints.append(study.joints_of(programs, scene, ["--linear"], number, folder / str(number)))
        for site in sites:
            written_readings(programs, scene, ["--linear"], site, folder / "readings.csv")
            fits = []
            for some in (joints[:1], joints):
                study.run(programs / "creepfit", *some, "--measurements", folder / "readings.csv", "--since-first-reading",
                          "--fit", ",".join(MADE), "-o", folder / "factors.csv")
                fits.append(rows_in(folder / "factors.csv"))
            found[site] = fits
            print(sites_markdown({site: fits}, networks), flush=True)
    files.write_text(out / "sites.md", sites_markdown(found, networks))


def analyse(programs, scene, slip, out):
    law = [] if slip else ["--linear"]
    with tempfile.TemporaryDirectory(dir=out, prefix="creepfit.partial-") as folder:
        folder = pathlib.Path(folder)
        (folder / "chain").mkdir()
        joints = study.joints_of(programs, scene, law, 0, folder / "chain")
        number = written_readings(programs, scene, law, 0, folder / "readings.csv")
        before = processor_time()
        said = study.run(programs / "creepfit", joints, "--measurements", folder / "readings.csv",
                         "--since-first-reading", "--fit", ",".join(MADE), "--readings", folder / "fitted.csv",
                         "-o", folder / "factors.csv")
        seconds = processor_time() - before
        (folder / "creepfit.md").write_text(markdown(rows_in(folder / "factors.csv"), number, seconds))
        (folder / "creepfit.txt").write_text(said)
        for path in filter(pathlib.Path.is_file, folder.iterdir()):
            os.replace(path, out / path.name)
    print(said, end="")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("scene", type=pathlib.Path)
    parser.add_argument("--slip", action="store_true", help="joints slip and open")
    parser.add_argument("--sites", type=int, nargs="+", metavar="NUMBER", help="networks of the readings, which the fit does not know")
    parser.add_argument("--networks", type=int, nargs="+", default=[0, 2, 3, 5, 6], metavar="NUMBER", help="of the fit, with --sites")
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    try:
        if arguments.sites:
            analyse_sites(arguments.programs, arguments.scene, arguments.sites, arguments.networks, arguments.output)
        else:
            analyse(arguments.programs, arguments.scene, arguments.slip, arguments.output)
    except study.Failed as error:
        sys.exit(f"back_analysis.py: {error}")


if __name__ == "__main__":
    main()
