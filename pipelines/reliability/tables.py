#!/usr/bin/python3
"""Makes the tables of docs/reliability.md from all runs of the campaigns that are kept.

    tables.py OUT COUNTS

adds each OUT/CAMPAIGN.csv to the runs in COUNTS/CAMPAIGN.csv, in place of counts there of the same subject and seed, and writes
OUT/tables/CAMPAIGN.md, for pipelines/accuracy/page.py: the sums of all runs, and a line for each run.
"""

import csv
import pathlib
import sys

ABOUT = ("n", "seed", "seconds", "version", "date", "machine")


def rows_of(path):
    """The names of the columns, and the rows."""
    if not path.exists():
        return [], []
    with path.open(newline="") as file:
        table = csv.DictReader(file)
        return list(table.fieldnames), list(table)


def added(counts, out):
    """All runs that are kept, with those of `out`; COUNTS/CAMPAIGN.csv as it is then."""
    names, rows = rows_of(out)
    before, kept = rows_of(counts)
    if not rows:
        return before, kept
    outcomes = [name for name in before[1:] if name not in ABOUT and name not in names]
    names = [*names[:-len(ABOUT)], *outcomes, *ABOUT]
    subject, new = names[0], {(row[names[0]], row["seed"]) for row in rows}
    kept = [row for row in kept if (row[subject], row["seed"]) not in new] + rows
    with counts.open("w", newline="") as file:
        table = csv.DictWriter(file, names, restval=0, lineterminator="\n")
        table.writeheader()
        table.writerows(kept)
    return rows_of(counts)


def markdown(names, rows):
    """A row for each subject and one for all, with the outcomes that occurred or are faults; then how it was run."""
    subject, *outcomes = [name for name in names if name not in ABOUT]
    counts = {}
    for row in rows:
        sums = counts.setdefault(row[subject], [0] * len(outcomes))
        counts[row[subject]] = [total + int(row[name]) for total, name in zip(sums, outcomes)]
    counts = [[name, *sums] for name, sums in counts.items()]
    total = ["all", *(sum(column) for column in list(zip(*counts))[1:])]
    lines = [[subject, *outcomes], ["---"] * (1 + len(outcomes)), *counts, *([total] if len(counts) > 1 else [])]
    text = "".join("| " + " | ".join(map(str, line)) + " |\n" for line in lines)
    runs = list(dict.fromkeys(tuple(row[name] for name in ABOUT) for row in rows))
    begin = "- " if len(runs) > 1 else ""
    return text + "\n" + "".join(f"{begin}N = {n}, seed {seed}; {seconds} s; version {version}, {date}; {machine}.\n"
                                 for n, seed, seconds, version, date, machine in runs)


def main():
    if len(sys.argv) != 3:
        sys.exit("usage: tables.py OUT COUNTS")
    out, counts = map(pathlib.Path, sys.argv[1:])
    (out / "tables").mkdir(parents=True, exist_ok=True)
    for name in sorted({path.name for folder in (out, counts) for path in folder.glob("*.csv")}):
        names, rows = added(counts / name, out / name)
        if rows:
            (out / "tables" / f"{pathlib.Path(name).stem}.md").write_text(markdown(names, rows))


if __name__ == "__main__":
    main()
