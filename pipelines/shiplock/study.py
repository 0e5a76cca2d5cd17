#!/usr/bin/python3
"""What each uncertain choice does to the points of the shiplock: a table and a tornado plot.

    study.py PROGRAMS SCENE.toml TARGETS.toml -n NETWORKS [--realizations FOLDER] -o OUT

Each choice is changed alone, on the same NETWORKS networks (realizations 0, 1, ...) as the scene's own run. In OUT it
writes study.md, study.csv and tornado.png. Every run leaves OUT/runs/CHOICE-NUMBER.json and is not made again until scene
or programs are newer: stopped at any time, the study continues from there.

The numbers are of the points below the crest: for every point the median over networks, and of these the mean. First
readings and the network itself change without further runs: the former by reading the same histories on other days, the
latter as the standard deviation over networks, of one point (the mean of the points' own) and of the mean over points. The
networks are the results in FOLDER, or else the scene's own.

A scene whose points are not those of the targets (section B-B) is summed up over all its points, and has no misfit.
"""

import argparse
import concurrent.futures
import csv
import datetime
import io
import json
import pathlib
import sys
import tempfile
import tomllib

import matplotlib.lines
import matplotlib.patches
import numpy as np

import records
from jointcreep import chain, files
from jointcreep.chain import Failed, run
from records import figure

HERE = pathlib.Path(__file__).resolve().parent
TUNED = 2.15  # the scene's factor on the spacings of its sets
CHOICES = {  # name: (what is changed, its value, options of variant.py)
    "scene": ("", "", []),
    "stress-low": ("horizontal stress", "2 MPa + 0.020 h", ["--stress", "low"]),
    "stress-high": ("horizontal stress", "5 MPa + 0.025 h", ["--stress", "high"]),
    "decay-none": ("decay of the stress to the surface", "none", ["--stress", "3,0.022,0.01"]),
    "spacing-less": ("factor on the spacing (tuned)", f"{TUNED - 0.2:.2f}", ["--spacing-times", f"{1 - 0.2 / TUNED}"]),
    "spacing-more": ("factor on the spacing (tuned)", f"{TUNED + 0.2:.2f}", ["--spacing-times", f"{1 + 0.2 / TUNED}"]),
    "stiffness-less": ("factor on K, E and eta", "1/2", ["--stiffness-times", "0.5"]),
    "stiffness-more": ("factor on K, E and eta", "2", ["--stiffness-times", "2"]),
    "rule-own": ("stiffness rule", "K itself", ["--rule", "K"]),
    "rule-realized": ("stiffness rule", "K over realized k", ["--realized"]),  # of each network
    "rule-bridges": ("stiffness rule", "K/k beside rock bridges", ["--rule", "bridges"]),
    "table-2-by-rock": ("reading of Table 2", "by rock, E = 2 K_n", ["--table-2", "by rock"]),
    "box-small": ("jointed box", "150 m to each side, above 90 m", ["--box", "150", "90"]),
    "box-large": ("jointed box", "330 m to each side, above 0 m", ["--box", "330", "0"]),
    "rock-soft": ("Young's modulus of the rock", "20 and 12 GPa", ["--youngs-modulus", "low"]),
    "rock-stiff": ("Young's modulus of the rock", "40 and 17 GPa", ["--youngs-modulus", "high"]),
    "domain-half": ("domain", "900 m to each side, down to -400 m", ["--domain", "900", "-400"]),
    "domain-double": ("domain", "3600 m to each side, down to -2200 m", ["--domain", "3600", "-2200"]),
    "zones-half": ("zone size", "2 m", ["--zone-size", "2"]),
    "linear": ("contacts", "neither slip nor open", ["--linear"]),
    "no-creep": ("creep", "none", ["--no-creep"]),
    "no-creep-soft": ("creep", "none, and K times 0.65", ["--no-creep", "--stiffness-times", "0.65"]),
}
BAR, SPREAD = figure.COLORS[4], figure.COLORS[5]  # of the tornado plot
SHIFTS = {"reading-earlier": -60, "reading-later": 60}  # of the first readings [days]


def joints_of(programs, scene, options, number, folder):
    """The joints file of one network of a variant, made in the folder."""
    if "--realized" in options:  # joint lines and traces do not depend on what changes
        run(programs / "jointgen", scene, "--realization", number, "--quiet", "-o", folder / "own.h5")
        options = [*options, folder / "own.h5"]
    run(sys.executable, HERE / "variant.py", scene, *options, "-o", folder / "scene.toml")
    return chain.joints_of(programs, folder / "scene.toml", folder, "--realization", number)


def computed(programs, scene, options, number):
    """Days and curves of one network, as JSON takes them."""
    with tempfile.TemporaryDirectory(prefix="jointcreep-") as folder:
        folder = pathlib.Path(folder)
        return solved(programs, joints_of(programs, scene, options, number, folder), folder)


def solved(programs, joints, folder):
    """Days and curves of a joints file, by a result in the folder."""
    run(programs / "demsolve", joints, "--quiet", "-o", folder / "r.h5")
    return read(folder / "r.h5")


def side_by_side(jobs, function, todo):
    """[function(one) for one in todo], so many at a time, begun in this order; what has not begun is left where one fails."""
    pool = concurrent.futures.ThreadPoolExecutor(jobs)
    try:
        return list(pool.map(function, todo))
    finally:
        pool.shutdown(cancel_futures=True)


def read(path):
    with figure.opened(path) as file:
        record = records.record_of(file)
        there = figure.array(file, "/history/present")[-1] == 1
        zones = len(figure.array(file, "/mesh/zone_block"))
    return {"names": record.names, "days": record.days.tolist(), "total": record.total[1].round(4).tolist(),
            "first": [int(record.days[row]) for row in record.first], "there": there.tolist(), "zones": zones,
            "start": record.start.isoformat()}


def result_of(programs, scene, out, name, options, number):
    """One run, from its file if that is newer than all that it depends on."""
    path = out / "runs" / f"{name}-{number:02d}.json"
    sources = [scene, HERE / "variant.py", *(programs / name for name in ("jointgen", "strength-averaging", "demsolve"))]
    if path.exists() and all(path.stat().st_mtime >= source.stat().st_mtime for source in sources):
        return json.loads(path.read_text())
    try:
        result = computed(programs, scene, options, number)
    except Failed as error:
        result = {"failed": str(error)}
    print(f"{name}, network {number}: {result.get('failed', 'equilibrium')}", flush=True)
    files.write_text(path, json.dumps(result))
    return result


def results_of(arguments, options):
    """{name: results of all networks} of {name: options of variant.py}: network by network, so that what is stopped has
    all of them on fewer networks."""
    (arguments.output / "runs").mkdir(parents=True, exist_ok=True)
    todo = [(name, number) for number in range(arguments.networks) for name in options]
    done = side_by_side(arguments.jobs, lambda one: result_of(arguments.programs, arguments.scene, arguments.output, one[0],
                                                              options[one[0]], one[1]), todo)
    return {name: [result for (other, _), result in zip(todo, done) if other == name] for name in options}


def values_of(result, targets, shift=0):
    """Total and recorded displacement at the end of the record of each point, not a number where it is gone [mm]."""
    days, total = np.array(result["days"]), np.array(result["total"])
    end = (targets["end_of_record"] - datetime.date.fromisoformat(result["start"])).days + 1e-6
    at = lambda day, point: np.interp(day, days, total[:, point])
    gone = np.where(result["there"], 0.0, np.nan)
    points = range(len(result["names"]))
    whole = np.array([at(end, i) for i in points]) + gone
    # On the day of a stage the reading is after it.
    before = np.array([at(max(0, result["first"][i] + shift) + 1e-6, i) for i in points])
    return whole, whole - before


def summary(results, targets, below, shift=0):
    """Of the networks with a result: medians of each point and their mean, total and recorded [mm]."""
    kept = [values_of(result, targets, shift) for result in results if "failed" not in result]
    if not kept:
        return None
    every = np.array([one[0] for one in kept])
    total, recorded = (np.array([one[i] for one in kept])[:, below] for i in (0, 1))
    medians = np.nanmedian(total, axis=0), np.nanmedian(recorded, axis=0)
    names = next(result["names"] for result in results if "failed" not in result)
    found = {"networks": len(kept), "failed": len(results) - len(kept), "total": float(medians[0].mean()),
             "recorded": float(medians[1].mean()), "each": (total, recorded), "points": dict(zip(names, np.nanmedian(every, axis=0)))}
    if not all(name in targets["point"] for name in names):
        return found
    return {**found, "misfit": records.misfit(medians, targets)}


def spread(own, each):
    """Rows of the network: what a point, and the mean of the points, differ by from network to network."""
    number = len(each[0])
    for what, deviations in (("network realization: a point", [np.nanmean(np.nanstd(one, axis=0, ddof=1)) for one in each]),
                             ("network realization: mean", [np.std(np.nanmean(one, axis=1), ddof=1) for one in each])):
        for sign, words in ((-1, "less"), (1, "plus")):
            yield what, f"{words} one standard deviation of {number}", {
                key: own[key] + sign * float(deviation) for key, deviation in zip(("total", "recorded"), deviations)}


def misfit_of(found):
    return f"{found['misfit']:.2f}" if "misfit" in found else ""


def largest_change(own, found):
    """Of the median total of a point, crests too, in words; of a row without points nothing."""
    changes = {name: value / own["points"][name] - 1 for name, value in found.get("points", {}).items()}
    name = max(changes, key=lambda name: abs(changes[name]), default=None)
    return f"{100 * changes[name]:+.1f} % ({name})" if name else ""


def markdown(own, rows, networks, points):
    lines = ["| what is changed | to | total (mm) | change | largest at a point | recorded (mm) | change | misfit |",
             "|---|---|---|---|---|---|---|---|",
             f"| nothing | | {own['total']:.1f} | | | {own['recorded']:.1f} | | {misfit_of(own)} |"]
    for what, to, found in rows:
        if isinstance(found, str):
            lines.append(f"| {what} | {to} | {found} | | | | | |")
            continue
        lost = found.get("failed", 0)
        cells = [what, f"{to} ({found['networks']} networks)" if lost else to]
        for key in ("total", "recorded"):
            cells += [f"{found[key]:.1f}", f"{found[key] - own[key]:+.1f}"]
        cells.insert(4, largest_change(own, found))
        cells.append(misfit_of(found))
        lines.append("| " + " | ".join(cells) + " |")
    lines += ["", "Horizontal, toward the lock, at the end of 1999. Each point has its median over the networks with an equilibrium "
                  f"({own['networks']}, or the number in the row). The table has the mean of these medians over {points}."]
    if any(what.startswith("network") for what, *_ in rows):
        lines.append(f"Rows of the network: {networks} networks.")
    return "\n".join(lines) + "\n"


def ordered(own, rows, targets):
    """[(what is changed, [(its value, found)])], the largest change last: of totals or of records, over the width of the
    paper's range."""
    groups = {}
    for what, to, found in rows:
        if not isinstance(found, str):
            of = f" ({found['networks']} networks)" if found.get("failed", 0) else ""
            groups.setdefault(what, []).append((to + of, found))

    def change(group):
        return max(abs(found[key] - own[key]) / np.ptp(targets[f"{key}_mm"])
                   for _, found in group[1] for key in ("total", "recorded"))
    return sorted(groups.items(), key=change)


def lines_of(groups):
    """What stands at the left, from below: (text, whether it names what is changed, found or None over several values)."""
    for what, group in groups:
        if len(group) == 1:
            ((to, found),) = group
            yield f"{what}: {to}", True, found
            continue
        for to, found in reversed(group):
            yield to, False, found
        yield what, True, None


def tornado(own, rows, targets, path):
    """Bars from the scene's own value to that of each choice, the largest on top; total and recorded beside each other."""
    lines = list(lines_of(ordered(own, rows, targets)))
    plot, panels = figure.plt.subplots(1, 2, sharey=True, figsize=(figure.TWO_COLUMNS, 1.0 + 0.135 * len(lines)))
    for axes, key, label in ((panels[0], "total", "total"), (panels[1], "recorded", "since the first reading")):
        low, high = targets[f"{key}_mm"]
        if "misfit" in own:
            axes.axvspan(low, high, color="#d5eadb", linewidth=0, zorder=0)
        longest = 1.5 * high  # what goes beyond is cut, and says its value
        for y, (*_, found) in enumerate(lines):
            if found is None:
                continue
            value = min(found[key], longest)
            axes.barh(y, value - own[key], height=0.7, left=own[key], zorder=2, linewidth=0.4, edgecolor="k",
                      color=BAR if "networks" in found else SPREAD)
            if found[key] > longest:
                for back in (0.04, 0.07):  # two white strokes across the bar
                    axes.plot([value - (back + 0.015) * high, value - back * high], [y - 0.4, y + 0.4], color="w",
                              linewidth=1.2, zorder=3)
                axes.annotate(f"to {found[key]:.0f}", (value, y), xytext=(2, 0), textcoords="offset points", va="center",
                              fontsize=5.5, zorder=4)
        axes.axvline(own[key], color="k", linewidth=0.8, zorder=3)
        axes.set_xlabel(f"{label} (mm)")
        axes.set_xlim(0, 1.75 * high)  # room for the words
    panels[0].set_yticks(range(len(lines)), [text for text, *_ in lines])
    panels[0].set_ylim(-0.7, len(lines) - 0.3)
    for axes in panels:
        axes.tick_params(axis="y", length=0)
    for tick, (_, names, _) in zip(panels[0].get_yticklabels(), lines):
        tick.set(fontsize=6, weight="bold" if names else "normal")
    number = f"{own['networks']} network{'s' if own['networks'] > 1 else ''}"
    entries = [matplotlib.lines.Line2D([], [], color="k", linewidth=0.8, label="the scene as it is"),
               matplotlib.patches.Patch(facecolor=BAR, edgecolor="k", linewidth=0.4, label=f"changed, {number}")]
    if any(found and "networks" not in found for *_, found in lines):
        entries.append(matplotlib.patches.Patch(facecolor=SPREAD, edgecolor="k", linewidth=0.4, label="spread of the networks"))
    if "misfit" in own:
        entries.append(matplotlib.patches.Patch(facecolor="#d5eadb", label="the paper's range"))
    below = 0.3 / plot.get_figheight()
    plot.get_layout_engine().set(rect=(0, below, 1, 1 - below))
    plot.legend(handles=entries, loc="lower center", ncol=len(entries))
    figure.save(plot, path)


def add_arguments(parser):
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("scene", type=pathlib.Path)
    parser.add_argument("targets", type=pathlib.Path)
    parser.add_argument("-n", "--networks", type=int, default=6)
    parser.add_argument("-j", "--jobs", type=int, default=1)
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True)


def below_the_crest(scene, targets):
    """Places, in the scene's list, of the points below the crest, and how many points there are."""
    with open(scene, "rb") as file:
        names = [point["name"] for point in tomllib.load(file)["point"]]
    return [i for i, name in enumerate(names) if not targets["point"].get(name, {}).get("crest", False)], len(names)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add_arguments(parser)
    parser.add_argument("--choice", action="append", choices=list(CHOICES), help="only these, beside the scene's own")
    parser.add_argument("--realizations", type=pathlib.Path, metavar="FOLDER",
                        help="results of more networks, for their spread")
    arguments = parser.parse_args()
    targets = records.targets_of(arguments.targets)
    choices = [name for name in CHOICES if not arguments.choice or name in ("scene", *arguments.choice)]
    below, number = below_the_crest(arguments.scene, targets)
    points = "all points" if len(below) == number else "the points below the crest"
    results = results_of(arguments, {choice: CHOICES[choice][2] for choice in choices})

    own = summary(results["scene"], targets, below)
    if own is None:
        sys.exit(f"study.py: no run of the scene itself has a result: {results['scene'][0]['failed']}")
    rows = []
    for choice in choices[1:]:
        found = summary(results[choice], targets, below)
        rows.append((*CHOICES[choice][:2], found or results[choice][0]["failed"]))
    for days in [] if arguments.choice else SHIFTS.values():
        rows.append(("first readings", f"{abs(days)} days {'later' if days > 0 else 'earlier'}",
                     summary(results["scene"], targets, below, days)))
    several = ([read(path) for path in sorted(arguments.realizations.glob("*.h5"))] if arguments.realizations
               else results["scene"])
    each = summary(several, targets, below)["each"]
    if len(each[0]) > 1 and not arguments.choice:
        rows += spread(own, each)
    text = io.StringIO()
    out = csv.writer(text, lineterminator="\n")
    out.writerow(["changed", "to", "networks", "total_mm", "recorded_mm", "misfit"])
    for what, to, found in [("nothing", "", own), *rows]:
        if not isinstance(found, str):
            out.writerow([what, to, found.get("networks", ""), round(found["total"], 3), round(found["recorded"], 3),
                          round(found["misfit"], 4) if "misfit" in found else ""])
    (arguments.output / "study.csv").write_text(text.getvalue())
    (arguments.output / "study.md").write_text(markdown(own, rows, len(each[0]), points))
    tornado(own, rows, targets, arguments.output / "tornado.png")


if __name__ == "__main__":
    main()
