#!/usr/bin/python3
"""The points of the shiplock at the end of the record against the paper's ranges, as a Markdown table.

    points.py ENSEMBLE.h5 WITHOUT-CREEP.h5 TARGETS.toml -o points.md

Both are ensemble.h5 of as many networks, or single results. Numbers are medians over the networks, and in brackets 5
and 95 percent. The share of creep is of the median recorded displacement. Networks without equilibrium are named, and
count in nothing else.
"""

import argparse
import datetime
import re
import sys

import numpy as np

import records
from records import figure


def in_range(value, low, high):
    return "in" if low <= value <= high else f"{value - (low if value < low else high):+.1f}"


def shown(three):
    low, median, high = three
    return f"{median:.0f} ({low:.0f} to {high:.0f})" if high - low > 0.05 else f"{median:.1f}"


def misfit(rows, targets):
    """Over the points below the crest. None if a point is not one that the ranges are for."""
    if any(row["name"] not in targets["point"] for row in rows):
        return None
    return records.misfit([np.array([row[key][1] for row in rows if not row["crest"]]) for key in ("total", "recorded")],
                          targets)


def rows_of(record, without, targets):
    end = targets["end_of_record"]
    last = max(stage["date"] for stage in record.scene["stage"])
    year = last + datetime.timedelta(targets["settled_within_days"])
    rows = []
    for point in sorted(range(len(record.names)), key=lambda i: (record.position[i, 0] < 0, -record.position[i, 1])):
        name = record.names[point]
        total, recorded = (record.at(curves, end, point) for curves in (record.total, record.recorded))
        rows.append({
            "name": name, "crest": targets["point"].get(name, {}).get("crest", False),
            "total": total, "recorded": recorded,
            "before": record.total[:, record.first[point], point],
            "total_without": without.at(without.total, end, point),
            "recorded_without": without.at(without.recorded, end, point),
            "year": record.at(record.total, year, point)[1] - record.at(record.total, last, point)[1],
            "later": record.total[1, -1, point] - record.at(record.total, year, point)[1],
        })
    return rows


def words_for(below, rows):
    return "all points" if len(below) == len(rows) else "the points below the crest"


def failures(file):
    """{number: reason} of the networks of an ensemble that have no result; of what demsolve says, why and when."""
    if "failed" not in file:
        return {}
    reasons = ("; ".join(part.strip() for part in reason.split("demsolve: ")[1:3]) or reason
               for reason in figure.texts(file, "/failed/reason"))
    return dict(zip(figure.array(file, "/failed/number").tolist(), reasons))


def markdown(rows, targets, number, failed=None, without=None):
    """The table of `number` networks with creep and `without` without it (as many by default)."""
    failed = failed or {}
    has_ranges = any(row["name"] in targets["point"] for row in rows)
    heads = ["point"]
    for head in ("total", "recorded", "before"):
        heads += [head, "its range", ""] if has_ranges else [head]
    heads += ["total without creep", "recorded without", "creep in the record", "year after the end", "later"]
    lines = [re.sub(" +", " ", "| " + " | ".join(heads) + " |"), "|---" * len(heads) + "|"]
    for row in rows:
        target = targets["point"].get(row["name"])
        cells = [row["name"] + (" (crest)" if row["crest"] else "")]
        for key in ("total", "recorded", "before"):
            cells.append(shown(row[key]))
            cells += [f"{target[key + '_mm'][0]}-{target[key + '_mm'][1]}",
                      in_range(row[key][1], *target[key + "_mm"])] if target else ["", ""] * has_ranges
        share = 1 - row["recorded_without"][1] / row["recorded"][1] if row["recorded"][1] else 0
        cells += [shown(row["total_without"]), shown(row["recorded_without"]),
                  f"{100 * share:.0f} %", f"{row['year']:.1f}", f"{row['later']:.1f}"]
        lines.append("| " + " | ".join(cells) + " |")
    below = [row for row in rows if not row["crest"]]

    def spread(values):
        return f"{np.mean(values):.1f} ({np.min(values):.1f} to {np.max(values):.1f})"

    lines += ["", f"Horizontal, toward the lock, in mm, at the end of 1999; {number} network{'s' if number > 1 else ''}."]
    for words, values in (
            (f"Medians of {words_for(below, rows)}, mean, and in brackets smallest and largest: total", [row["total"][1] for row in below]),
            ("recorded", [row["recorded"][1] for row in below]),
            ("recorded with creep minus recorded without creep", [row["recorded"][1] - row["recorded_without"][1] for row in below])):
        lines.append(f"{words} {spread(values)};")
    found = misfit(rows, targets)
    lines.append("no misfit: these points have no ranges." if found is None else f"misfit {found:.2f}.")
    if without not in (None, number):
        lines.append(f"Without creep: {without} networks.")
    lines += [f"Not among them, network {number}: {reason}" for number, reason in failed.items()]
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("file", "without", "targets"):
        parser.add_argument(name)
    parser.add_argument("-o", "--output", required=True)
    arguments = parser.parse_args()
    with figure.opened(arguments.file) as file, figure.opened(arguments.without) as other:
        record, without, failed = records.record_of(file), records.record_of(other), failures(file)
    targets = records.targets_of(arguments.targets)
    try:
        text = markdown(rows_of(record, without, targets), targets, record.number, failed, without.number)
        with open(arguments.output, "w", encoding="utf-8") as file:
            file.write(text)
    except OSError as error:
        print(f"points.py: {error}", file=sys.stderr)
        sys.exit(4)


if __name__ == "__main__":
    main()
