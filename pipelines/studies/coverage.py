#!/usr/bin/python3
"""How often confidence intervals of studies contain the true value: many studies of known distributions, without the solver.

    coverage.py [--studies 4000] [--runs 100] [--seed 1] [-o coverage.csv]

A study has so many runs, of which each has a value by a known law in place of a result; its statistics are those of
jointcreep study. A row of the table is a statistic of a design and a law: in how many studies its 95 percent interval
contained the true value, and what is allowed. Means of plain designs have to cover in 94 to 96 percent of 4000 studies,
quantiles and probabilities in 94 at least; for fewer studies what is allowed is wider by chance (3 standard errors). The other
rows say how well intervals of other designs do. The exit code is 1 if a row is not within what is allowed.
"""

import argparse
import csv
import dataclasses
import math
import pathlib
import sys

import numpy as np
from scipy import stats

from jointcreep import answers, study_file

LAWS = {"normal": stats.norm(10, 2), "uniform": stats.uniform(0, 1), "lognormal": stats.lognorm(0.5), "exponential": stats.expon()}
MEAN, AT_LEAST = (0.94, 0.96), (0.94, 1.0)
OF_4000 = 3 * math.sqrt(0.95 * 0.05 / 4000)  # chance, in what is allowed for 4000 studies
NETWORKS, PARAMETERS = 12, 10  # of a crossed design
SHARES = (0.6, 0.3, 0.1)  # of its variance: networks, parameters, both
STOP_AT = 0.25  # wanted half-width, over the deviation
MOST = 400  # runs of a study with a stop rule
BATCH = 50


def study_of(design, limit=None, stop=""):
    """A study with one quantity; its scene is never read."""
    quantity = study_file.Quantity("value", "displacement", "1", "", "", "", "", "", None, "", [limit] if limit is not None else [], [], "")
    return study_file.Study(pathlib.Path(), "", pathlib.Path(), True, [], [], design, [quantity],
                            study_file.Stop(stop, STOP_AT if stop else 0.0, 0.0, 0.0, math.inf), [])


def plain(runs):
    return study_file.Design("plain", 1, runs, 0, 0, 0, 1, 0, "")


def covers(low, high, true):
    return (low is None or low <= true) and (high is None or true <= high)


def plain_studies(law, name, n_studies, runs, random):
    """Coverage of each statistic of plain designs."""
    limit = float(law.ppf(0.9))
    study = study_of(plain(runs), limit)
    true = {"mean": float(law.mean()), f"probability above {limit:g}, of stable runs": 0.1,
            **{f"quantile {part:g}": float(law.ppf(part)) for part in answers.QUANTILES}}
    hits = dict.fromkeys(true, 0)
    for _ in range(n_studies):
        values = law.rvs(runs, random_state=random)
        for statistic, _, _, low, high in answers.statistics(study, study.quantities[0], values, np.arange(runs)):
            if statistic in true:
                hits[statistic] += covers(low, high, true[statistic])
    for statistic, count in hits.items():
        allowed = MEAN if statistic == "mean" and name != "exponential" else AT_LEAST if statistic != "mean" else None
        yield "plain", name, "probability 0.1" if "probability" in statistic else statistic, count, allowed


def crossed_studies(n_studies, random):
    """Coverage of the mean of networks x parameters and of the probability of 0.1, whose values are not independent: of all runs, and
    without those above 1.5, which fail."""
    design = study_file.Design("networks x parameters", 1, NETWORKS * PARAMETERS, NETWORKS, PARAMETERS, 0, 1, 0, "")
    study = study_of(design)
    for name, highest in (("normal", math.inf), ("normal, failures", 1.5)):
        below = stats.truncnorm(-math.inf, highest)
        hits = dict.fromkeys(("mean", "probability 0.1"), 0)
        for _ in range(n_studies):
            of_network, of_parameters, of_both = (math.sqrt(share) * random.normal(size=size) for share, size in
                                                  zip(SHARES, ((NETWORKS, 1), (1, PARAMETERS), (NETWORKS, PARAMETERS))))
            values = (of_network + of_parameters + of_both).ravel()
            run = np.flatnonzero(values <= highest)
            values = values[run]
            hits["mean"] += covers(*answers.mean_with_interval(study, values, run)[1:3], float(below.mean()))
            hits["probability 0.1"] += covers(*answers.share_with_interval(study, values > below.ppf(0.9), run)[1:], 0.1)
        for statistic, count in hits.items():
            yield design.kind, name, statistic, count, None


def latin_studies(n_studies, random):
    """Coverage of the mean of Latin hypercubes of ten replicates: of a curved function of two parameters with noise."""
    design = study_file.Design("latin hypercube", 1, 100, 0, 0, 0, 10, 0, "")
    study = study_of(design)
    size, run, hits = 10, np.arange(100), 0
    for _ in range(n_studies):
        columns = [np.concatenate([(random.permutation(size) + random.random(size)) / size for _ in range(10)]) for _ in range(2)]
        values = np.exp(columns[0]) + columns[1] ** 2 + 0.2 * random.normal(size=100)
        _, low, high, _ = answers.mean_with_interval(study, values, run)
        hits += covers(low, high, math.e - 1 + 1 / 3)
    yield design.kind, "curved with noise", "mean", hits, None


def stopped_studies(n_studies, random):
    """Coverage of the mean where the study ends as soon as the interval is narrow enough."""
    study = study_of(plain(MOST), stop="value")
    hits = 0
    for _ in range(n_studies):
        values = random.normal(size=MOST)
        rows = [{"values": [value], "run": run} for run, value in enumerate(values)]
        end = next((end for end in range(BATCH, MOST, BATCH) if answers.enough(study, rows[:end])), MOST)
        _, low, high, _ = answers.mean_with_interval(study, values[:end], np.arange(end))
        hits += covers(low, high, 0.0)
    yield "plain, stop rule", "normal", "mean", hits, None


def two_level_studies(name, n_studies, random):
    """Coverage of the mean of two levels. Normal: both are, with a correlation of 0.965. Lognormal: coarse values x are, and fine ones
    are x to the power 1.1 with 5 percent of noise."""
    fine_runs, per_fine, shape = 25, 10, 0.3
    design = dataclasses.replace(plain(fine_runs * (1 + per_fine)), kind="two levels", fine_runs=fine_runs, coarse_per_fine=per_fine)
    study, hits, estimates = study_of(design), 0, []
    fine_numbers = np.arange(fine_runs) * design.block()
    true = 12.0 if name == "normal" else math.exp((1.1 * shape) ** 2 / 2)
    for _ in range(n_studies):
        normal = random.normal(size=(fine_runs, per_fine))
        noise = 0.05 * random.normal(size=fine_runs)
        coarse = 10 + 2 * normal if name == "normal" else np.exp(shape * normal)
        fine = 12 + 2.2 * normal[:, 0] + 12 * noise if name == "normal" else coarse[:, 0] ** 1.1 * (1 + noise)
        values = np.concatenate([fine[:, None], coarse], axis=1).ravel()
        rows = [{"run": run, "values": [float(value)]} for run, value in enumerate(values)]
        found, run = answers.values_of(study, rows, 0)
        assert (run == fine_numbers).all()
        value, low, high, _ = answers.mean_with_interval(study, found, run, answers.coarse_of(study, rows, 0, run))
        estimates.append(value)
        hits += covers(low, high, true)
    yield design.kind, name, "mean", hits, MEAN if name == "normal" else None
    bias = (np.mean(estimates) - true) / (np.std(estimates, ddof=1) / math.sqrt(n_studies))
    print(f"two levels, {name}: mean of the estimates less the true one, over its standard error: {bias:+.2f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--studies", type=int, default=4000)
    parser.add_argument("--runs", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("-o", "--output", metavar="coverage.csv")
    arguments = parser.parse_args()
    n, random = arguments.studies, np.random.Generator(np.random.Philox(arguments.seed))
    chance = 3 * math.sqrt(0.95 * 0.05 / n)
    wider = max(0.0, chance - OF_4000)
    rows = [row for name, law in LAWS.items() for row in plain_studies(law, name, n, arguments.runs, random)]
    rows += [*crossed_studies(n, random), *latin_studies(n, random), *stopped_studies(n, random),
             *(row for name in ("normal", "lognormal") for row in two_level_studies(name, n, random))]
    table, bad = [["design", "law", "statistic", "studies", "covered", "allowed"]], 0
    for design, law, statistic, count, allowed in rows:
        share = count / n
        is_bad = allowed is not None and not allowed[0] - wider <= share <= allowed[1] + wider
        bad += is_bad
        table.append([design, law, statistic, n, f"{share:.4f}",
                      ("" if allowed is None else f"{allowed[0] - wider:.3f} to {min(1, allowed[1] + wider):.3f}") +
                      (" NOT MET" if is_bad else "")])
    print("\n".join("  ".join(str(cell).ljust(22) for cell in row).rstrip() for row in table))
    if arguments.output:
        with open(arguments.output, "w", encoding="utf-8", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows(table)
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
