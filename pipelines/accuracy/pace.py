#!/usr/bin/python3
"""The pace of dynamic relaxation and of the dynamic analysis beside a bare loop of the same arithmetic, on one thread and on two.

    pace.py BIN PACE_BENCHMARK DATA OUT

runs PACE_BENCHMARK (tests/relaxation/pace_benchmark.cpp) on the bench slope of the folder DATA with 2e4 and 2e5 zones,
and writes OUT/pace.csv and OUT/tables/pace.md. On two threads it measures wall time, so it wants an idle machine.
"""

import csv
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from jointcreep import chain
from speed_against_error import table

SIZES = {1.6: (400, 9), 0.45: (60, 9)}  # of zones [m]: steps and rounds


def main():
    if len(sys.argv) != 5:
        sys.exit("usage: pace.py BIN PACE_BENCHMARK DATA OUT")
    programs, benchmark, data, out = map(Path, sys.argv[1:])
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        joints = chain.joints_of(programs, data / "slope/scene.toml", folder)
        for size, (steps, rounds) in SIZES.items():
            # Threads wait for each other as those of demsolve do.
            done = subprocess.run([benchmark, joints, *map(str, (size, steps, rounds))], check=True, text=True,
                                  stdout=subprocess.PIPE, env=os.environ | {"GOMP_SPINCOUNT": "1000"})
            rows += csv.DictReader(done.stdout.splitlines())
    (out / "tables").mkdir(parents=True, exist_ok=True)
    with open(out / "pace.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)
    lines = [[row["zones"], row["contacts"], row["way"], row["threads"], f"{float(row['zone_steps_per_s']):.1e}",
              f"{float(row['over_bare']):.2f}", f"{float(row['gain']):.2f}"] for row in rows]
    head = ["zones", "contacts", "way", "threads", "zone-steps per s", "over bare loop", "over one thread"]
    (out / "tables/pace.md").write_text("\n".join(table(head, lines)))


if __name__ == "__main__":
    main()
