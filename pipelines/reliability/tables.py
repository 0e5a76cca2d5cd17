#!/usr/bin/python3
"""Makes the tables of docs/reliability.md of what the campaigns have counted.

    tables.py OUT

reads every OUT/CAMPAIGN.csv and writes OUT/tables/CAMPAIGN.md, for pipelines/accuracy/page.py.
"""

import csv
import pathlib
import sys

ABOUT = ("n", "seed", "seconds", "version", "date", "machine")


def markdown(rows):
    """A row for each subject and one for all, with the outcomes that occurred or are faults; then how it was run."""
    subject, *outcomes = [name for name in rows[0] if name not in ABOUT]
    counts = [[row[subject], *(int(row[name]) for name in outcomes)] for row in rows]
    total = ["all", *(sum(column) for column in list(zip(*counts))[1:])]
    lines = [[subject, *outcomes], ["---"] * (1 + len(outcomes)), *counts, *([total] if len(counts) > 1 else [])]
    text = "".join("| " + " | ".join(map(str, line)) + " |\n" for line in lines)
    about = {name: rows[0][name] for name in ABOUT}
    return text + ("\nN = {n}, seed {seed}; {seconds} s; version {version}, {date}; {machine}.\n").format(**about)


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: tables.py OUT")
    out = pathlib.Path(sys.argv[1])
    (out / "tables").mkdir(parents=True, exist_ok=True)
    for path in sorted(out.glob("*.csv")):
        with path.open(newline="") as file:
            rows = list(csv.DictReader(file))
        if rows:
            (out / "tables" / f"{path.stem}.md").write_text(markdown(rows))


if __name__ == "__main__":
    main()
