"""One page of HTML for a run or for a study, with its pictures in it: no other file is needed to read it."""

import base64
import csv
import html
import itertools
import os
import pathlib
import re
import subprocess
import tempfile
import tomllib

import h5py
import numpy as np

from . import files, intervals, materials, plan, reading
from .errors import NotWanted
from .quantities import MOVING, UNDECIDED

STYLE = """
body { font: 15px/1.5 sans-serif; color: #222; max-width: 62em; margin: 2em auto; padding: 0 1em; }
h1, h2, h3 { line-height: 1.2; color: #1b2a5c; } h2 { border-bottom: 1px solid #ccd; margin-top: 2em; }
table { border-collapse: collapse; margin: 1em 0; } th, td { padding: .15em .8em; border-bottom: 1px solid #dde; text-align: left; }
td.number { text-align: right; font-variant-numeric: tabular-nums; }
figure { margin: 1.5em 0; } img { max-width: 100%; height: auto; } figcaption { color: #555; font-size: 90%; }
pre { background: #f4f5f8; padding: .8em; overflow-x: auto; font-size: 85%; white-space: pre-wrap; overflow-wrap: anywhere; }
.bad { color: #b5403a; font-weight: bold; }
@media print { body { max-width: none; } figure, tr { break-inside: avoid; } }
"""
MOST_LISTED = 12  # numbers of a list of a study file
MOST_ROWS = 50  # of a table of runs that have no value
MOST_BLOCKS = 10  # of the table of moving blocks
MOST_PAIRS = 15  # of points, in the table of relative displacements
DRAWN_PAIRS = 6  # of them, in its picture
CAPTIONS = {
    "distribution": "Share of runs up to a value.",
    "convergence": "Statistics over the number of runs.",
    "parameters": "The values of the runs over each parameter, and {what}.",
}


def escaped(text):
    return html.escape(str(text).encode("utf-8", "replace").decode())  # a file's name need not be UTF-8


def cell(value):
    """A cell of a table; numbers on the right, with four digits if they are not whole."""
    if isinstance(value, int):
        return f'<td class="number">{value}</td>'
    try:
        number = float(value)
    except (TypeError, ValueError):
        return f"<td>{escaped(value)}</td>"
    return f'<td class="number">{number:.0f}</td>' if number == int(number) and abs(number) < 1e6 else \
        f'<td class="number">{number:.4g}</td>'


def table(heads, rows):
    head = "".join(f"<th>{escaped(one)}</th>" for one in heads)
    return f"<table><tr>{head}</tr>" + "".join(f"<tr>{''.join(map(cell, row))}</tr>" for row in rows) + "</table>"


def picture(path, caption):
    """A PNG file of the plots in the page, 1.5 times as wide as in print."""
    content = path.read_bytes()
    width = int.from_bytes(content[16:20], "big") * 96 * 1.5 / 300  # of a pixel of the page, which is 1/96 inch
    coded = base64.b64encode(content).decode()
    return (f'<figure><img alt="{escaped(caption)}" style="width: {width:.0f}px" src="data:image/png;base64,{coded}">'
            f"<figcaption>{escaped(caption)}</figcaption></figure>")


def drawn(name, source, folder, caption, **options):
    """A picture by one of the plots, as HTML; in its place the plot's message where it has nothing to draw."""
    from . import plots  # matplotlib takes long to load
    try:
        plots.save(name, source, folder / "picture.png", **options)
    except NotWanted as error:
        return f"<p>{escaped(caption)} Not drawn: {escaped(error)}</p>"
    return picture(folder / "picture.png", caption)


def page(title, parts):
    return ("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
            "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
            f"<title>{escaped(title)}</title><style>{STYLE}</style></head>\n<body>\n<h1>{escaped(title)}</h1>\n"
            + "\n".join(parts) + "\n</body></html>\n")


def texts(file, path):
    return [value.decode() if isinstance(value, bytes) else str(value) for value in file[path][()]] if path in file else []


def settings(scene):
    """The tables of a scene that say how it is computed."""
    rows = [(name, key, value) for name in ("zones", "equilibrium", "creep", "cutting", "averaging", "random", "large_displacements")
            for key, value in scene.get(name, {}).items()]
    return "<p>Keys of the scene; all others have their defaults.</p>" + table(["table", "key", "value"], rows)


def materials_of(scene, more=""):
    """Parts of the page about rocks and joints. more: what is said above the tables."""
    parts = ["<h2>Materials and joint sets</h2>",
             "<p>Strengths are those of the scene: a strength factor divides them. Tensile strengths are positive. A property without a value "
             f"has its default, or is not there.{more}</p>"]
    for heading, heads, rows in materials.tables(scene):
        parts += [f"<h3>{heading}</h3>", table(heads, rows)]
    return parts


def failure_in_words(file):
    """Stage, day and reason of a run without equilibrium, of an open result file."""
    import figure
    reason = texts(file, "/failure/reason")[0]
    stage, day = texts(file, "/failure/stage")[0], figure.day_of(file, file["/failure/time"][0])
    when = f'stage "{stage}", {day}' if stage else f"{day}, before the first stage" if not file["/failure/time"][0] else day
    undecided = "" if file["/failure/moves_on"][0] or not figure.has_no_equilibrium(file) else \
        " It is not known whether there is an equilibrium: the search ended without an answer."
    return f"<b>{escaped(when)}</b>: {escaped(reason)}.{undecided}"


def rows_by_stage(events, rows):
    """Of some rows of a history those after a stage, and the last one."""
    return [row for row in rows if events[row] or row == rows[-1]]


def by_stage(file):
    """Parts of the page: displacements of the points after each stage, and in the end. Points of monitoring lines are in their picture."""
    import figure
    from plot_histories import of_no_line
    names, events, time = texts(file, "/history/point"), texts(file, "/history/event"), file["/history/time"][()]
    moves, present = 1e3 * file["/history/displacement"][()], file["/history/present"][()] == 1
    chosen, rows, gone = of_no_line(file, names), [], set()
    for row in rows_by_stage(events, range(len(time))):
        day = figure.day_of(file, time[row])
        for point in chosen:
            if names[point] in gone:
                continue
            note = "" if present[row, point] else "excavated; its last displacement"
            if note:
                gone.add(names[point])
            rows.append((events[row] or "end of the run", day, names[point],
                         *(float(one) for one in moves[row, point]), note))
    return ["<h3>Displacements of the points by stage</h3>",
            "<p>Displacements just after the excavation of each stage, and at the end of the run. They count from the in-situ equilibrium; x is to "
            "the right, y upward. Creep between two stages is a part of the rows of the later one.</p>",
            table(["stage", "date", "point", "x (mm)", "y (mm)", ""], rows)]


def failed_name(source):
    """Name of the file that demsolve --factor-of-safety writes beside a result, of the run without equilibrium."""
    return f"{source.stem}.failed{source.suffix}"


def failed_run(source):
    """The result of the run without equilibrium that demsolve --factor-of-safety writes beside a result; None if there is none."""
    path = source.with_name(failed_name(source))
    if not path.exists():
        return None
    with h5py.File(source) as file, h5py.File(path) as other:
        of_same = "/safety" in other and np.array_equal(file["/safety/factor"], other["/safety/factor"])
        return path if of_same and "/failure" in other else None


def moving_blocks(failed):
    """Parts of the page about the blocks that move in the end of a run without equilibrium: where they are, how large and how fast."""
    moving = reading.File(failed).moving_blocks()
    if not moving.rows():
        return []
    rows = [(int(block), area, x, y, 1e3 * by_x, 1e3 * by_y) for block, area, x, y, by_x, by_y in zip(*moving.values())]
    count = f"the fastest {MOST_BLOCKS} of {len(rows)} moving blocks" if len(rows) > MOST_BLOCKS else "all of them"
    area = moving["area"].sum()
    return [f"<p>{len(rows)} moving block{'s' * (len(rows) > 1)}, area {area:.4g} m2 in all: {area:.4g} m3 for each metre along the "
            f"strike. The table has {count}; displacements are those of the last steps of the solver.</p>",
            table(["moving block", "area (m2)", "x (m)", "y (m)", "displacement x (mm)", "displacement y (mm)"], rows[:MOST_BLOCKS])]


def factor_of_safety(source, folder):
    """Parts of the page about a factor of safety, if the result has one."""
    from figure import strength_factor_of
    from plot_safety import bracket
    with h5py.File(source) as file:
        if "/safety" not in file:
            return []
        low, high = bracket(file["/safety/factor"][()], file["/safety/stands"][()])
    between = f"from {low:.4g} to {high:.4g}" if low and high else f"at least {low:.4g}" if low else f"below {high:.4g}"
    parts = ["<h2>Factor of safety</h2>", f"<p>The factor of safety is <b>{between}</b>.</p>"]
    if low:
        parts.append(f"<p>All other sections are of the run with strengths / {low:.4g}. Displacements with the strengths of the scene come "
                     "from a run without --factor-of-safety.</p>")
    parts.append(drawn("safety", source, folder, "The largest displacement over the strength reduction factor."))
    failed = failed_run(source)
    if failed:
        parts.append("<h3>What moves at failure</h3>")
        with h5py.File(failed) as file:
            parts.append(f"<p>With strengths / {strength_factor_of(file):.4g} the first failure is in {failure_in_words(file)} Later stages "
                         "are not computed with this factor.</p>")
        parts.append(drawn("state", failed, folder, "The run with the smallest factor without equilibrium: moving blocks.",
                           around_failure=True))
        parts += moving_blocks(failed)
    elif high:
        parts.append(f"<p>What moves at failure is in {escaped(failed_name(source))}, which is not beside this result, or is of another "
                     "search: no picture of it.</p>")
    return parts


def of_run(source, programs, folder, pairs=None, window=None, pictures=()):
    """Title and parts of the page of a result file. pairs: of points, in words, as pairs_of() reads them. window: x0, y0, x1, y1 [m], a part of
    the section for pictures of states; None: as section-detail.png and blocks-detail.png have it. pictures: Paths, by name, of pictures
    that `jointcreep run` has drawn of this file; they are not drawn again. (Those of its network have no title with strengths.)"""
    import figure  # matplotlib takes long to load
    from suited import detail, magnified
    with h5py.File(source) as file:
        scene_text = file["/scene"][0].decode()
        scene = tomllib.loads(scene_text)
        chain = list(zip(texts(file, "/provenance/program"), texts(file, "/provenance/version"), texts(file, "/provenance/options")))
        warnings = list(zip(texts(file, "/warnings/program"), texts(file, "/warnings/text")))
        failure = failure_in_words(file) if "/failure" in file else ""
        factor = figure.strength_factor_of(file)
        points = texts(file, "/history/point")
        if pairs and not points:
            raise NotWanted(f"--pairs: {source.name} has no monitoring points")
        wanted = pairs_of(pairs, points) if pairs else None
        displacements = by_stage(file) if points else []
        numbers = [("blocks", len(file["/blocks/area"])), ("zones", len(file["/mesh/zone_block"])),
                   ("contacts", len(file["/mesh/contact_edge"])), ("equilibria", len(file["/equilibria/steps"])),
                   ("largest unbalanced force ratio", file["/equilibria/unbalanced_force_ratio"][()].max(initial=0)),
                   ("seed", int(file.attrs["seed"])), ("realization", int(file.attrs["realization"]))]
    parts = [f'<p class="bad">The run ended early: {failure}</p>'] if failure else []
    parts += [f'<p class="bad">All strengths of this run are divided by {factor:.4g}.</p>'] if factor != 1 else []
    parts += factor_of_safety(source, folder)
    window = window or detail(scene)

    def shown(plot, made, caption, **options):
        return picture(pictures[made], caption) if made in pictures else drawn(plot, source, folder, caption, **options)

    parts += ["<h2>Section and network</h2>", drawn("section", source, folder, "The section, its joints, stages and points.")]
    parts += [drawn("section", source, folder, "Its stages and points.", window=window)] if window else []
    parts += [drawn("blocks", source, folder, "Blocks by size.")]
    parts += [drawn("blocks", source, folder, "Those around the excavation, with a scale of their own.", window=window)] if window else []
    parts += ["<h2>Histories</h2>"]
    if points:
        for component, caption in (("x", "Horizontal displacement of the points, to the right."), ("y", "Vertical displacement, upward.")):
            parts.append(shown("histories", f"histories-{component}.png", caption, component=component))
        parts += displacements
        parts += relative_displacements(source, folder, wanted)
    if "monitoring_line" in scene:
        parts.append(shown("line", "lines.png", "Displacements along monitoring lines."))
    parts.append("<h2>Last state before the run ended early</h2>" if failure else "<h2>State at the end</h2>")
    if failure:
        parts.append(shown("state", "failure.png", "Moving blocks.", around_failure=True, magnify=magnified(scene)))
        parts += moving_blocks(source)
    for field, caption in (("displacement", "Displacements."), ("stress", "Stresses."), ("contacts", "Contacts that slip or open.")):
        parts.append(shown("state", f"last-{field}.png", caption, field=field, window=window, magnify=magnified(scene, field)))
    parts += ["<h2>Numbers</h2>", table(["", ""], numbers), "<h2>Settings</h2>", settings(scene), "<h2>Warnings</h2>",
              table(["program", "warning"], warnings) if warnings else "<p>None.</p>",
              "<h2>Checks</h2>", checks(source, programs),
              "<h2>Versions</h2>", table(["program", "version", "options"], chain), *materials_of(scene),
              "<h2>Scene</h2>", f"<pre>{escaped(scene_text)}</pre>"]
    return scene.get("title") or source.name, parts


def pairs_of(text, points):
    """Pairs of names from --pairs "left wall,right wall; crown,floor". A name may have commas."""
    pairs = []
    for part in filter(None, (one.strip() for one in text.split(";"))):
        words = part.split(",")
        cuts = [(",".join(words[:at]).strip(), ",".join(words[at:]).strip()) for at in range(1, len(words))]
        fitting = [cut for cut in cuts if cut[0] in points and cut[1] in points and cut[0] != cut[1]]
        if not fitting:
            known = ", ".join(f'"{point}"' for point in points)
            raise NotWanted(f'--pairs: "{part}" is not two points of the result, with a comma between; there are: {known}')
        pairs.append(fitting[0])
    if not pairs:
        raise NotWanted('--pairs has no pair; expected such as "left wall,right wall; crown,floor"')
    return pairs


def relative_displacements(source, folder, wanted):
    """Parts of the page about pairs of monitoring points: closure, and displacement of the first relative to the second, by stage. wanted:
    pairs of names; None: pairs of all points that are not on monitoring lines, those that move most against each other."""
    import figure
    from plot_histories import of_no_line
    found = {}
    with h5py.File(source) as file:
        history = reading.history_of(file)
        place, first_row = dict(zip(history.point, history.position)), dict(zip(history.point, history.first_reading_row))
        names = [history.point[at] for at in of_no_line(file, history.point)]
        pairs = wanted or list(itertools.combinations(names, 2))
        has_readings = any(first_row[name] > 0 for pair in pairs for name in pair)
        for one, other in pairs:
            relative, closure = 1e3 * history.relative(one, other), 1e3 * history.closure(one, other)
            rows = np.flatnonzero(np.isfinite(closure))
            if not len(rows):
                continue
            last, first = rows[-1], max(first_row[one], first_row[other])
            is_gone = last < len(history.time) - 1
            found[one, other] = [
                (history.event[row] or ("" if is_gone else "end of the run"), figure.day_of(file, history.time[row]), one, other,
                 float(np.linalg.norm(place[one] - place[other])), float(closure[row]), *map(float, relative[row]),
                 *((float(closure[row] - closure[first]) if first < row else "",) * has_readings),
                 "one of them is excavated next" if is_gone and row == last else "")
                for row in rows_by_stage(history.event, rows)]
    if not found:
        return []
    by_size = list(found) if wanted else sorted(found, key=lambda pair: -np.hypot(*found[pair][-1][6:8]))
    shown = by_size if wanted else by_size[:MOST_PAIRS]
    which = f" The {MOST_PAIRS} of {len(found)} pairs that move most against each other; --pairs of jointcreep report chooses others." \
        if len(shown) < len(found) else "" if wanted else " --pairs of jointcreep report chooses pairs."
    return ["<h3>Relative displacements</h3>",
            "<p>Closure: by how much the distance of two points has become smaller, as a tape measures it; negative where they move apart. "
            "Relative x, y: displacement of the first point less that of the second. All since the in-situ equilibrium"
            f"{', and the closure also since both points have been read' * has_readings}.{escaped(which)}</p>",
            table(["stage", "date", "point", "other point", "distance (m)", "closure (mm)", "relative x (mm)", "relative y (mm)",
                   *["closure since the first readings (mm)"] * has_readings, ""], [row for pair in shown for row in found[pair]]),
            drawn("histories", source, folder, "Closure of pairs of points.", pair=by_size[:DRAWN_PAIRS])]


def checks(source, programs):
    """What jointverify says of a result."""
    try:
        done = subprocess.run([programs / "jointverify", source], capture_output=True, text=True)
    except OSError as error:
        return f'<p class="bad">jointverify cannot be started: {escaped(error.strerror)}</p>'
    lines = (done.stdout or done.stderr).strip().splitlines() or ["nothing said"]
    good = ' class="bad"' if done.returncode != 0 else ""
    columns = [re.split(r"\s{2,}", line.strip(), maxsplit=5) for line in lines]  # names and values have single blanks
    rows = [row for row in columns if len(row) >= 5]
    notes = [line for row, line in zip(columns, lines) if len(row) < 5]
    whole = table(["check", "values", "largest deviation", "allowed", "", "where"], [[*row, ""][:6] for row in rows[1:]]) \
        if len(rows) > 1 else ""
    return f"<p{good}>jointverify: {escaped(lines[-1])}</p>{whole}<pre>{escaped(chr(10).join(notes))}</pre>"


def csv_rows(path):
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def caption_of(kind, quantity, study):
    """The caption of a picture of a quantity."""
    has_shares = study.design.kind in ("networks x parameters", "sobol indices")
    caption = CAPTIONS[kind].format(what="what the variance comes from" if has_shares else "its rank correlation with each")
    if kind == "distribution" and quantity.above + quantity.below:
        caption += " Dashed: limits that the study asks for."
    if kind == "convergence" and study.stop.of == quantity.name and (study.stop.half_width or study.stop.relative_half_width):
        caption += " Dashed: the wanted half-width."
    return caption


def histories_of(out):
    """Parts of the page about statistics of histories, if the study has them."""
    captions = {"ensemble.png": "Horizontal displacement of the points, to the right: quantiles, median and mean.",
                "ensemble-y.png": "Vertical displacement, upward."}
    drawn_ones = [picture(out / name, caption) for name, caption in captions.items() if (out / name).exists()]
    return ["<h2>Histories</h2>", *drawn_ones] if drawn_ones else []


def study_text(text):
    """Parts of the page: the text of a study file, with long lists of numbers in short."""
    def in_short(found):
        try:
            numbers = [float(one) for one in re.sub(r"#.*", "", found[1]).split(",") if one.strip()]
        except ValueError:
            return found[0]
        return f"[{len(numbers)} values, {min(numbers):g} to {max(numbers):g}]" if len(numbers) > MOST_LISTED else found[0]
    short = re.sub(r"\[([^][]*)\]", in_short, text)
    note = ["<p>Long lists of numbers are in short; study.toml in the study's folder has them in full.</p>"] * (short != text)
    return [*note, f"<pre>{escaped(short)}</pre>"]


def what_varies(study, scene):
    """Parts of the page: what the study changes from run to run."""
    parts = ["<h2>What varies</h2>"] + ["<p>The network.</p>"] * study.varies_network
    if study.parameters:
        parts.append(table(["parameter", "key of the scene", "in the scene", "in the runs"], materials.varied(study, scene)))
        factors = ", ".join(one.name for one in study.parameters if one.multiplies)
        parts += [f"<p>Pictures have the factor by which it multiplies the values of the scene: {escaped(factors)}.</p>"] * bool(factors)
    return parts


def of_stable_runs(statistic, quantity, rows):
    """Words of a statistic that leaves out runs without equilibrium, if there are some."""
    leaves_out = quantity.what == "displacement" and not statistic.startswith("probability") and any(row["no equilibrium"] for row in rows)
    return f"{statistic}, of the runs with an equilibrium" if leaves_out else statistic


def of_study(out, programs, folder):
    """Title and parts of the page of a study's folder."""
    from . import answers  # takes long to load
    study = plan.study_in(out)
    found = plan.parsed((out / "plan.json").read_bytes(), out / "plan.json")
    rows, found_answers, shares, times = (csv_rows(out / f"{name}.csv") for name in ("runs", "answers", "shares", "times"))
    failed = [row for row in rows if row["exit code"] != "0"]
    scene = tomllib.loads((out / "scene.toml").read_text("utf-8"))
    hours = sum(float(row["processor_seconds"]) for row in times) / 3600
    is_early = len(rows) < study.design.runs and not study.design.directions
    summary = (out / "summary.txt").read_text("utf-8")
    ended = re.search(r"^runs .*, ended (.*)$", summary, re.MULTILINE)
    parts = ["<h2>The study</h2>", table(["", ""], [
        ("scene", scene.get("title", "")), ("design", study.design.kind), ("runs", f"{len(rows)} of {study.design.runs}" if is_early else len(rows)),
        *((("ended", ended[1]),) if ended else ()),
        ("runs with a result", len(rows) - len(failed)),
        *((f"runs without equilibrium: {what}", sum(row["no equilibrium"] == what for row in rows)) for what in (MOVING, UNDECIDED)),
        ("runs with other failures", sum(row["exit code"] not in ("0", "3") for row in rows)),
        ("runs that were repeated", sum(row["attempts"] != "1" for row in times)), ("processor time of the programs (hours)", hours)])]
    parts += what_varies(study, scene)
    with tempfile.TemporaryDirectory(dir=folder) as work:
        network = pathlib.Path(work) / "network.h5"
        done = subprocess.run([programs / "jointgen", out / "scene.toml", "-o", network], capture_output=True, text=True)
        parts.append(drawn("section", network, folder, "The section with the first network, stages and points.")
                     if done.returncode == 0 else f"<p>The section is not drawn: {escaped(done.stderr)}</p>")
    parts.append("<h2>Answers</h2>")
    parts.append(f"<p>From, to: {100 * intervals.CONFIDENCE:.0f} percent confidence interval; empty where the runs are too few or the "
                 "design has none.</p>")
    pictures = plan.parsed((out / "pictures.json").read_bytes(), out / "pictures.json")
    for quantity in study.quantities:
        of = [row for row in found_answers if row["quantity"] == quantity.label()]
        parts += [f"<h3>{escaped(quantity.title())}</h3>", f"<p>{escaped(quantity.definition())}</p>"]
        if not of:
            parts.append("<p>No run has this value.</p>")
            continue
        statistics = [of_stable_runs(answers.with_unit(row["statistic"], quantity), quantity, rows) for row in of]
        parts.append(table(["", study.design.counted(), "value", "from", "to"],
                           [(words, row["runs"], row["value"], row["low"], row["high"]) for words, row in zip(statistics, of)]))
        of_shares = [(row["input"], row["measure"], row["value"], row["low"], row["high"]) for row in shares
                     if row["quantity"] == quantity.label()]
        if of_shares:
            parts.append(table(["what it depends on", "", "value", "from", "to"], of_shares))
        for name in pictures.get(quantity.name, []):
            kind = name.removesuffix(".png").rpartition("-")[2]
            parts.append(picture(out / name, caption_of(kind, quantity, study)))
    parts += histories_of(out)
    notes = summary.partition("the design has none\n")[2].splitlines()
    warned = [line for line in notes if line.startswith("warning")]
    missing = [line for line in notes if line not in warned and (line.startswith(("run ", "and ")) or " runs: " in line)]
    for heading, lines in (("Warnings", warned), ("Runs without a value", missing)):
        parts.append(f"<h2>{heading}</h2>")
        parts.append("<ul>" + "".join(f"<li>{escaped(line)}</li>" for line in lines[:MOST_ROWS]) + "</ul>" if lines else "<p>None.</p>")
    parts.append("<h2>Checks</h2><p>Each run that has an exit code of 0 satisfied the guards of demsolve in every state that it recorded: "
                 "finite values, areas, weight, penetration, energies, unbalanced forces.</p>")
    marked = materials.marked(study, scene, plan.formulas_in(out))
    parts += ["<h2>Settings</h2>", settings(marked), "<h2>Versions</h2>",
              table(["program", "version"], found["identity"]["the programs' versions"].items()),
              *materials_of(marked, " Values with <i>varies by</i> change from run to run: these are the values in the runs, or that of the scene and its formula."),
              "<h2>Study file</h2>", *study_text((out / "study.toml").read_text("utf-8")),
              "<h2>Scene</h2>", "<p>As it is written, before the study changes values (section What varies).</p>" * bool(study.parameters),
              f"<pre>{escaped((out / ('formulas.toml' if plan.formulas_in(out) else 'scene.toml')).read_text('utf-8'))}</pre>"]
    return study.title or f"Study of {scene.get('title', out.name)}", parts


def of_notes(path):
    """Parts of the page with the user's own text: paragraphs between blank lines, headings after #, lists of lines that begin with -."""
    try:
        text = path.read_text("utf-8-sig")
    except UnicodeDecodeError:
        raise NotWanted(f"{path}: is no text in UTF-8; expected paragraphs, with blank lines between them") from None
    parts = []
    for lines in (paragraph.splitlines() for paragraph in re.split(r"\n\s*\n", text.strip()) if paragraph):
        while lines and lines[0].startswith("#"):
            parts.append(f"<h2>{escaped(lines.pop(0).lstrip('#').strip())}</h2>")
        if lines and all(line.startswith("- ") for line in lines):
            parts.append("<ul>" + "".join(f"<li>{escaped(line[2:])}</li>" for line in lines) + "</ul>")
        elif lines:
            parts.append(f"<p>{escaped(' '.join(lines))}</p>")
    return parts


def write(source, output, programs, pairs=None, window=None, others=(), notes=None, pictures=()):
    """Writes the page of a result file or of a study's folder, or one page of several: those in `others`, too. output: a Path, or "-":
    standard output. pairs: of the points of a result, in words, as pairs_of() reads them. window: of its pictures, as of_run(). notes: a Path of
    the text that comes first. pictures: of `source`, as of_run()."""
    sources = [source, *others]
    for one in sources:
        check(one, pairs, window)
    read = [one for one in [*sources, notes] if one and not one.is_dir()]
    if output != files.STANDARD_OUTPUT and output.exists() and (output.is_dir() or any(os.path.samefile(output, one) for one in read)):
        raise NotWanted(f"{output}: is a folder, or a file that is read; expected the name of a report, such as report.html")
    files.refuse_partial(output, read)
    first = of_notes(notes) if notes else []
    with tempfile.TemporaryDirectory(prefix="jointcreep-") as name:
        folder = pathlib.Path(name)
        found = [of_study(one.resolve(), programs, folder) if one.is_dir() else
                 of_run(one.resolve(), programs, folder, pairs, window, pictures if one is source else ()) for one in sources]
    title, parts = found[0]
    if others:
        titles = [title for title, _ in found]
        found = [(f"{title} ({one})" if titles.count(title) > 1 else title, its_parts) for one, (title, its_parts) in zip(sources, found)]
        title, parts = f"Report of {len(found)} results", ["<ol>" + "".join(f"<li>{escaped(of_one)}</li>" for of_one, _ in found) + "</ol>"]
        for number, (of_one, its_parts) in enumerate(found, 1):
            parts += [f"<h1>{number}. {escaped(of_one)}</h1>", *its_parts]
    files.write_output(output, page(title, [*first, *parts]))


def check(source, pairs, window):
    """Raises NotWanted if there can be no page of it."""
    is_study = source.is_dir()
    if is_study and pairs:
        raise NotWanted("--pairs is for result files; a study collects a displacement with relative_to")
    if is_study and window:
        raise NotWanted("--window is for result files; a study's report has no pictures of states")
    if is_study and (source / "summary.txt").exists() and not (source / "pictures.json").exists():
        raise NotWanted(f"{source}: the study has no pictures yet; the same command draws them: jointcreep study STUDY.toml -o {source}, with "
                        "--finish if runs are missing")
    if is_study and not all((source / name).exists() for name in ("plan.json", "runs.csv", "summary.txt", "pictures.json")):
        raise NotWanted(f"{source}: is not the folder of a study that has ended; first run: jointcreep study STUDY.toml -o {source}; "
                        "with --finish it ends with the runs that it has")
    if not is_study:
        with open(source, "rb"):
            pass
        try:
            with h5py.File(source) as file:
                kind = file.attrs.get("filetype", b"")
        except OSError:
            if source.suffix == ".toml":
                raise NotWanted(f"{source}: is a scene; expected a result file of demsolve, or a study's folder. First run: jointcreep run "
                                f"{source} -o FOLDER, which writes FOLDER/report.html") from None
            raise NotWanted(f"{source}: is no HDF5 file, or a damaged one; expected a result file of demsolve, or a study's folder") \
                from None
        if kind not in (b"jointcreep result", "jointcreep result"):
            raise NotWanted(f"{source}: is not a result file of demsolve; expected one, or a study's folder")
