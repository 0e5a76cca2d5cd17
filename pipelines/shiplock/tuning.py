#!/usr/bin/python3
"""The one number of the shiplock that is tuned, a factor on the spacing of all joint sets: what others would have made.

    tuning.py PROGRAMS SCENE.toml TARGETS.toml -n NETWORKS --factors 2.0 2.1 2.2 -o OUT

For every factor it solves realizations 0, 1, ..., NETWORKS - 1 and writes OUT/tuning.md: the misfit of the medians (as in
points.py) and its standard error, by drawing networks with replacement; mean and extremes of the medians of the points
below the crest; and which of their medians are not in their ranges. Runs are kept, and gone on with, as those of
study.py. A factor draws other networks, so factors differ by chance too: that is what the standard error is for.
"""

import argparse

import numpy as np

import records
import study


def standard_error(each, targets):
    """Of the misfit over the networks of `each`, {total, recorded} arrays [network, point] [mm]."""
    return records.standard_error(
        lambda rows: records.misfit([np.nanmedian(one[rows], axis=0) for one in each], targets), len(each[0]))


def outside(names, medians, low, high):
    """Points whose median is not in the range, in words."""
    found = [f"{name} {value:.1f}" for name, value in zip(names, medians) if not low <= value <= high]
    return ", ".join(found) or "none"


def row_of(factor, results, targets, below):
    found = study.summary(results, targets, below)
    if found is None:
        return f"| {factor:g} | 0 | {results[0]['failed']} | | | | |"
    names = [next(one for one in results if "failed" not in one)["names"][i] for i in below]
    cells = [f"{factor:g}", str(found["networks"]),
             f"{found['misfit']:.2f} ± {standard_error(found['each'], targets):.2f}"]
    for one, key in zip(found["each"], ("total_mm", "recorded_mm")):
        medians = np.nanmedian(one, axis=0)
        cells += [f"{medians.mean():.1f} ({medians.min():.1f} to {medians.max():.1f})", outside(names, medians, *targets[key])]
    return "| " + " | ".join(cells) + " |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    study.add_arguments(parser)
    parser.add_argument("--factors", type=float, nargs="+", required=True, metavar="FACTOR")
    arguments = parser.parse_args()
    targets = records.targets_of(arguments.targets)
    below, _ = study.below_the_crest(arguments.scene, targets)
    options = {f"spacing-{factor:g}": ["--spacing-times", f"{factor / study.TUNED}"] for factor in arguments.factors}
    results = study.results_of(arguments, options)
    total, recorded = ("-".join(map(str, targets[key])) for key in ("total_mm", "recorded_mm"))
    lines = [f"| factor | networks | misfit | totals (mm) | not in {total} | records (mm) | not in {recorded} |",
             "|---|---|---|---|---|---|---|",
             *(row_of(factor, results[name], targets, below) for factor, name in zip(arguments.factors, options)),
             "", "Medians of the points below the crest: mean, and in brackets least and largest."]
    (arguments.output / "tuning.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
