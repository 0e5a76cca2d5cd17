#!/usr/bin/python3
"""Zone and step errors of a study beside its sampling error, and what coarse zones as a control variate save.

    zones.py PROGRAMS OUT [--runs 40] [--sizes 2 3 6 12] [--error 0.01] [--jobs 1]

The same networks of the bench slope are computed with each zone size, the first of which is the reference, once with creep steps of
half their length, and once with the coarsest zones and no creep. For each choice the table has the mean of the crest's displacement, its difference to the reference with the 95 percent
interval of that (networks are the same, so differences are no chance of sampling), the seconds of a run, and the runs and hours on one core
that plain sampling takes for the wanted error of the mean (95 percent).

As a control variate, many runs with coarse zones give the mean, and few runs with fine zones on some of the same networks correct it:
mean of fine + b (mean of all coarse - mean of coarse on these networks). With the correlation r of both and their costs c_f and c_c, the
cheapest numbers of runs cost (sqrt(1 - r^2) + r sqrt(c_c / c_f))^2 of plain sampling (Pasupathy and others 2012). Seconds are those of the
processor.
"""

import math
import subprocess

import numpy as np

import slope

import jointcreep
from jointcreep import intervals

QUANTITY = "crest x (mm)"


def computed(arguments, name, options):
    """Displacements [run] of the crest in the end [mm] and mean seconds of a run, with these options of demsolve."""
    file, folder = arguments.out / f"zones-{name}.toml", arguments.out / f"zones-{name}"
    study = slope.STUDY.format(scene=slope.ROOT / "data/slope/scene.toml", runs=arguments.runs)
    words = ", ".join(f'"{option}"' for option in options)
    file.write_text(f"demsolve_options = [{words}]\n{study}" if options else study, "utf-8")
    subprocess.run(slope.command(arguments, file, folder, arguments.jobs), check=True)
    study = jointcreep.read(folder)
    return study.runs[QUANTITY], float(study.times["processor_seconds"].mean())


def plain_runs(moves, error):
    """Runs that plain sampling takes for an error of the mean, relative to it, with 95 percent."""
    return max(2, math.ceil((1.96 * np.std(moves, ddof=1) / (error * abs(np.mean(moves)))) ** 2))


def main():
    def more(parser):
        parser.add_argument("--sizes", type=float, nargs="+", default=[2, 3, 6, 12])
        parser.add_argument("--error", type=float, default=0.01)
        parser.add_argument("--jobs", type=int, default=1)
        parser.set_defaults(runs=40)

    arguments = slope.options(__doc__, more)
    arguments.out.mkdir(parents=True, exist_ok=True)
    choices = [(f"zones {size:g} m", ["--zone-size", f"{size:g}"]) for size in arguments.sizes]
    choices.append((f"zones {arguments.sizes[0]:g} m, half steps", [*choices[0][1], "--creep-step", "7"]))
    choices.append((f"zones {arguments.sizes[-1]:g} m, no creep", [*choices[len(arguments.sizes) - 1][1], "--no-creep"]))
    found = {}
    for name, options in choices:
        found[name] = computed(arguments, name.replace(" ", "-").replace(",", ""), options)
    there = np.all([np.isfinite(moves) for moves, _ in found.values()], axis=0)
    fine, fine_seconds = found[choices[0][0]]
    fine = fine[there]
    print(f"{there.sum()} networks that all choices have; expected error of the mean: {100 * arguments.error:g} percent\n")
    print("| choice | mean (mm) | difference to the reference (percent) | seconds a run | runs | hours |\n|---|---|---|---|---|---|")
    for name, (moves, seconds) in found.items():
        moves = moves[there]
        difference, low, high = (100 * one / fine.mean() for one in intervals.mean(moves - fine)[:3])
        runs = plain_runs(moves, arguments.error)
        print(f"| {name} | {moves.mean():.3f} | {difference:+.2f} ({low:+.2f} to {high:+.2f}) | {seconds:.2f} | {runs} | "
              f"{runs * seconds / 3600:.2f} |")
    print("\n| fine | coarse | correlation | fine runs | coarse runs | hours | over plain |\n|---|---|---|---|---|---|---|")
    wanted = (arguments.error * abs(fine.mean()) / 1.96) ** 2
    for name, (moves, seconds) in [one for one in found.items() if "half steps" not in one[0]][1:]:
        r = float(np.corrcoef(fine, moves[there])[0, 1])
        ratio = math.sqrt(r * r * fine_seconds / ((1 - r * r) * seconds))  # coarse runs over fine runs
        variance = fine.var(ddof=1)
        n = variance * (1 - r * r + r * r / ratio) / wanted
        hours = n * (fine_seconds + ratio * seconds) / 3600
        plain = plain_runs(fine, arguments.error) * fine_seconds / 3600
        print(f"| {choices[0][0]} | {name} | {r:.3f} | {math.ceil(n)} | {math.ceil(ratio * n)} | {hours:.3f} | {hours / plain:.2f} |")


if __name__ == "__main__":
    main()
