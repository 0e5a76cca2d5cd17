#!/usr/bin/python3
"""The mean of a slope's displacement to a wanted error, by plain sampling and by two levels: how much time each takes.

    levels.py PROGRAMS OUT [--error 0.01] [--fine 2] [--coarse 12] [--coarse-per-fine 30] [--no-creep] [--jobs 1]

Both studies are of the crest of the bench slope with zones of `fine` m, and end by their stop rule when half of the mean's 95 percent
interval is the wanted part of the mean. Coarse runs have zones of `coarse` m, and no creep if so said. The times are those of the
processor, of all programs. The exit code is 1 if the two intervals do not meet.
"""

import sys

import jointcreep
import slope

STUDY = """
scene = "{scene}"
{options}
[[vary]]
network = true

[design]
{design}

[[collect]]
name = "crest"
what = "displacement"
point = "crest"
component = "x"

[stop]
of = "crest"
relative_half_width = {error}
"""
MOST = 20000  # runs


def main():
    def more(parser):
        parser.add_argument("--error", type=float, default=0.01)
        parser.add_argument("--fine", type=float, default=2)
        parser.add_argument("--coarse", type=float, default=12)
        parser.add_argument("--coarse-per-fine", type=int, default=30)
        parser.add_argument("--no-creep", action="store_true")
        parser.add_argument("--jobs", type=int, default=1)

    arguments = slope.options(__doc__, more)
    arguments.out.mkdir(parents=True, exist_ok=True)
    fine = f'["--zone-size", "{arguments.fine:g}"]'
    coarse = f'["--zone-size", "{arguments.coarse:g}"' + (', "--no-creep"]' if arguments.no_creep else "]")
    designs = {
        "plain": (f"demsolve_options = {fine}\n", f"runs = {MOST}"),
        "two-levels": ("", f'kind = "two levels"\nfine_runs = {MOST // (1 + arguments.coarse_per_fine)}\n'
                       f"coarse_per_fine = {arguments.coarse_per_fine}\nfine_options = {fine}\ncoarse_options = {coarse}"),
    }
    print("| design | runs | mean (mm) | 95 percent interval | processor hours |\n|---|---|---|---|---|")
    hours, ends = {}, {}
    for name, (options, design) in designs.items():
        file, folder = arguments.out / f"levels-{name}.toml", arguments.out / f"levels-{name}"
        file.write_text(STUDY.format(scene=slope.ROOT / "data/slope/scene.toml", options=options, design=design,
                                     error=arguments.error), "utf-8")
        slope.made(arguments, file, folder, arguments.jobs)
        study = jointcreep.read(folder)
        hours[name] = study.times["processor_seconds"].sum() / 3600
        value, low, high = study.answer("mean")
        ends[name] = low, high
        print(f"| {name.replace('-', ' ')} | {study.runs.rows()} | {value:.4f} | {low:.4f} to {high:.4f} | {hours[name]:.3f} |", flush=True)
    print(f"two levels take {hours['two-levels'] / hours['plain']:.2f} of the time")
    (low, high), (other_low, other_high) = ends.values()
    sys.exit(0 if low <= other_high and other_low <= high else 1)


if __name__ == "__main__":
    main()
