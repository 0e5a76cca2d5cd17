#!/usr/bin/python3
"""What speaks for creep in the shiplock: the model with creep and the model without it, each with one tuned number, over the same
networks.

    tuning.py PROGRAMS SCENE.toml TARGETS.toml -n NETWORKS --factors 2.15 --without-creep 0.55 0.60 0.65 -o OUT

With creep the number is a factor on the spacing of all joint sets; each factor draws other networks. Without creep it is a factor on
the stiffness K of all joints, at the scene's spacings. For every number it solves realizations 0, 1, ..., NETWORKS - 1 and writes
OUT/tuning.md, a row each: the misfit of the medians (as in points.py) with its standard error, by drawing networks with replacement;
mean and extremes of the medians of the points below the crest, and their standard deviation from point to point; which of them are
not in the paper's ranges; the medians of the crest; and the share of single networks in which all points below the crest are in both
ranges, with its 95 percent interval (Clopper and Pearson). Runs are kept, and gone on with, as those of study.py.
"""

import argparse

import numpy as np

import records
import study
from jointcreep import intervals


def standard_error(each, targets):
    """Of the misfit over the networks of `each`, {total, recorded} arrays [network, point] [mm]."""
    return records.standard_error(
        lambda rows: records.misfit([np.nanmedian(one[rows], axis=0) for one in each], targets), len(each[0]))


def outside(names, medians, low, high):
    """Points whose median is not in the range, in words."""
    found = [f"{name} {value:.1f}" for name, value in zip(names, medians) if not low <= value <= high]
    return ", ".join(found) or "none"


def in_both(each, targets):
    """Of how many networks all points are in both of the paper's ranges, and of how many not."""
    inside = np.ones(len(each[0]), bool)
    for one, key in zip(each, ("total_mm", "recorded_mm")):
        low, high = targets[key]
        inside &= ((one >= low) & (one <= high)).all(axis=1)
    return int(inside.sum()), len(inside)


def share_words(number, of):
    _, low, high = intervals.probability(number, of)
    return f"{number} of {of} ({100 * low:.0f} to {100 * high:.0f} %)"


def row_of(words, results, targets, below):
    found = study.summary(results, targets, below)
    if found is None:
        return f"| {words} | 0 | {results[0]['failed']} | | | | | | |"
    all_names = next(one for one in results if "failed" not in one)["names"]
    names = [all_names[i] for i in below]
    cells = [words, str(found["networks"]), f"{found['misfit']:.2f} ± {standard_error(found['each'], targets):.2f}"]
    for one, key in zip(found["each"], ("total_mm", "recorded_mm")):
        medians = np.nanmedian(one, axis=0)
        cells += [f"{medians.mean():.1f} ({medians.min():.1f} to {medians.max():.1f}; {medians.std(ddof=1):.1f})",
                  outside(names, medians, *targets[key])]
    crest = [f"{name} {found['points'][name]:.1f}" for name in all_names if name not in names]
    cells += [", ".join(crest), share_words(*in_both(found["each"], targets))]
    return "| " + " | ".join(cells) + " |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    study.add_arguments(parser)
    parser.add_argument("--factors", type=float, nargs="*", default=[], metavar="FACTOR", help="on the spacings, with creep")
    parser.add_argument("--without-creep", type=float, nargs="*", default=[], metavar="FACTOR", help="on K, without creep")
    arguments = parser.parse_args()
    targets = records.targets_of(arguments.targets)
    below, _ = study.below_the_crest(arguments.scene, targets)
    options = {f"with creep, spacings times {factor:g}": ["--spacing-times", f"{factor / study.TUNED}"] for factor in arguments.factors}
    options |= {f"without creep, K times {factor:g}": ["--no-creep", "--stiffness-times", f"{factor}"]
                for factor in arguments.without_creep}
    files = {words: words.replace(",", "").replace(" ", "-") for words in options}
    results = study.results_of(arguments, {files[words]: each for words, each in options.items()})
    total, recorded = ("-".join(map(str, targets[key])) for key in ("total_mm", "recorded_mm"))
    lines = [f"| model, tuned number | networks | misfit | totals (mm) | not in {total} | records (mm) | not in {recorded} "
             "| totals of the crest (mm) | single networks with all points in both ranges |",
             "|---|---|---|---|---|---|---|---|---|",
             *(row_of(words, results[files[words]], targets, below) for words in options),
             "", "Medians of the points below the crest: mean, and in brackets least and largest, and the standard deviation of the ten."]
    (arguments.output / "tuning.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
