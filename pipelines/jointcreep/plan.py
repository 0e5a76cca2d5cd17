"""The plan of a study in its folder: what every process that works at it reads.

    study.toml    the study file, as it was first given      scene.toml    the scene, with the files that it names in it
    plan.json     what makes the runs what they are, and which runs a group has
    design.csv    what each run is given
    formulas.toml the scene with the formulas of its keys, if a name of [variables] varies; scene.toml has their numbers
"""

import csv
import functools
import json
import os
import subprocess
import tomllib

from . import design, files, quantities, scene_keys, study_file
from .design import draws_with_numpy
from .errors import NotDone, NotWanted

BATCH = 50  # runs from one look at the stop rule to the next
GROUP_SIZES = [25, 10, 5, 2, 1]  # they divide a batch
GROUPS_WANTED = 100  # so that several processors end at about the same time
LINES = 5  # raised when lines of results change
PROGRAMS = ["jointgen", "strength-averaging", "demsolve"]


def damaged(path):
    return NotWanted(f"{path}: is damaged; remove the folder, or choose another one")


def no_number(text):
    raise ValueError(text)


def parsed(text, path):
    """JSON of a file of the folder: an object."""
    try:
        found = json.loads(text, parse_constant=no_number)
    except (ValueError, RecursionError):
        raise damaged(path) from None
    if not isinstance(found, dict):
        raise damaged(path)
    return found


def row_of(text, path):
    """A line of results of a group: of a run, or of a replicate of directional sampling."""
    row = parsed(text, path)
    has_values = isinstance(values := row.get("values"), list) and all(one is None or study_file.is_number(one) for one in values)
    if not isinstance(row.get("run"), int) or not (has_values and "exit_code" in row or study_file.is_number(row.get("probability"))):
        raise damaged(path)
    return row


def answer_of(program, *arguments):
    """What a program writes to stdout; it must succeed."""
    try:
        done = subprocess.run([program, *arguments], capture_output=True, text=True, errors="replace")
    except OSError as error:
        raise NotWanted(f"{program}: cannot be started: {error.strerror}; expected the programs of jointcreep there") from None
    if done.returncode == 4:
        raise NotDone(done.stderr.strip())
    if done.returncode != 0:
        raise NotWanted(done.stderr.strip() or f"{program}: exit code {done.returncode}")
    return done.stdout.strip()


def scene_text(study, programs, out):
    """The text of the scene with the files that it names, as jointgen keeps it: so it is checked, too."""
    import h5py
    network = out / "network.h5.partial-scene"  # always the same, so that what a killed study left goes
    try:
        answer_of(programs / "jointgen", study.scene, "-o", network)
        with h5py.File(network) as file:
            return file["/scene"][0].decode()
    finally:
        network.unlink(missing_ok=True)


def with_formulas(study, scene):
    """The scene with its formulas, and the files that it names in it, as a dict; None if no name of [variables] varies."""
    if not study.varied_names():
        return None
    files_in_it = {"file": scene["file"]} if "file" in scene else {}
    return {**tomllib.loads(study.scene.read_text(encoding="utf-8-sig")), **files_in_it}


def check_keys(study, scene, formulas):
    """Refuses keys that the scene does not have, or that are not numbers where a law wants one. formulas: as with_formulas()."""
    taken = {}
    for one in study.parameters:
        for key in one.keys:
            try:
                value = scene_keys.value_at(scene, key)
            except NotWanted as error:
                raise NotWanted(f"{one.place}key {error}") from None
            parts = tuple(scene_keys.parts_of(key))
            formula = scene_keys.value_at(formulas, key) if formulas else None
            if isinstance(formula, str) and (parts[0] == "variables" or not isinstance(value, str)):
                raise NotWanted(f'{one.place}"{key}" is the formula "{formula}" in the scene; expected a number there, or the names of '
                                "[variables] in the formula as key")
            if parts in taken:
                raise NotWanted(f'{one.place}"{key}" varies in "{taken[parts]}", too; expected it once')
            taken[parts] = one.name
            if (one.law or one.multiplies) and not study_file.is_number(value):
                raise NotWanted(f'{one.place}"{key}" is {study_file.shown(value)} in the scene; expected a number')
            if one.values and not one.multiplies and any(isinstance(new, str) != isinstance(value, str) for new in one.values):
                raise NotWanted(f'{one.place}"{key}" is {study_file.shown(value)} in the scene; expected values of the same kind')


def check_histories(study, formulas):
    """Refuses statistics of histories where what happens, and when, differs between runs. formulas: as with_formulas()."""
    fixed = ("schedule", "stage", "point", "monitoring_line")
    for one in study.parameters if study.histories else []:
        for key in one.keys:
            table, *name = scene_keys.parts_of(key)
            used = formulas and table == "variables" and any(
                scene_keys.names_in(formulas.get(other)) & scene_keys.dependent(formulas, name) for other in fixed)
            if table in fixed or used:
                raise NotWanted(f'{one.place}"{key}" varies, so histories of runs cannot be put beside each other; expected histories = false')


def group_size(runs):
    """Runs in a group: few enough that processors end together, many enough that starting a group costs little."""
    return next(size for size in GROUP_SIZES if size <= max(1, runs // GROUPS_WANTED))


def identity(study, scene, formulas, programs):
    """What makes runs what they are: runs of another study are not mixed in."""
    design = study.design
    sizes = [] if design.kind in study_file.EXTENSIBLE else [design.runs, design.networks, design.parameters, design.points,
                                                             design.replicates, design.directions, design.failure]
    levels = [design.coarse_per_fine, design.fine_options, design.coarse_options] if design.fine_runs else []
    by_numpy = ["by numpy"] * (bool(study.parameters) and draws_with_numpy(study))
    versions = {name: answer_of(programs / name, "--version") for name in PROGRAMS}
    return {
        "the scene": scene,
        "[[vary]]": [study.varies_network, [[one.name, one.keys, one.multiplies, one.law, one.constants, str(one.lowest),
                                             str(one.highest), one.values] for one in study.parameters]],
        "[[correlation]]": study.correlations,
        "[design]": [design.kind, design.seed, *sizes, *levels, *by_numpy, *design.networks_given],
        "[[collect]]": [[one.name, one.what, one.point, *filter(None, [one.relative_to]), one.component, one.since, one.stage,
                         str(one.date), one.statistic] for one in study.quantities],
        "demsolve_options": study.demsolve_options,
        "histories": study.histories,
        "keep": study.keep,
        "the programs' versions": versions,
        "the lines of results": LINES,
        **({"the formulas of the scene": scene_keys.toml_text(formulas)} if formulas else {}),
    }


def make(study, out, programs):
    """Writes the plan into the folder, or checks that the one there is of the same study. Returns the scene as tomllib reads it."""
    text = scene_text(study, programs, out)
    scene = tomllib.loads(text)
    formulas = with_formulas(study, scene)
    check_keys(study, scene, formulas)
    quantities.check(study, scene)
    check_histories(study, formulas)
    networks, values = ([], []) if study.design.directions else design.draw(study)  # directions are drawn as runs are made
    what = json.loads(json.dumps(identity(study, text, formulas, programs)))
    path = out / "plan.json"
    if path.exists():
        old = parsed(path.read_bytes(), path)
        if not isinstance(old.get("identity"), dict) or not all(isinstance(old.get(name), int) for name in ("runs", "group")):
            raise damaged(path)
        changed = [name for name in what if old["identity"].get(name) != what[name]]
        if changed:
            raise NotWanted(f"{out} has runs of another study: {', '.join(changed)} changed. Choose another folder, or remove it")
        if old["runs"] > study.design.runs:
            raise NotWanted(f"{out} has {old['runs']} runs planned, more than the {study.design.runs} of the study now; expected "
                            "as many or more. Choose another folder")
        size = old["group"]
        if old["runs"] < study.design.runs and old["runs"] % size:  # the last group gets more runs
            last = out / "groups" / f"{group_name(old['runs'] // size)}.rows"
            if last.exists():
                os.replace(last, f"{last}.part")
    else:
        size = group_size(study.design.runs)
    files.write_text(out / "scene.toml", text)
    if formulas:
        files.write_text(out / "formulas.toml", scene_keys.toml_text(formulas))
    files.write_text(out / "study.toml", study.path.read_text(encoding="utf-8-sig"))
    files.write_text(out / "design.csv", files.csv_text(["run", study_file.NETWORK, *(one.name for one in study.parameters)],
                                         [[run, network, *of_run] for run, (network, of_run) in enumerate(zip(networks, values))]))
    files.write_text(path, json.dumps({"identity": what, "runs": study.design.runs, "group": size}, indent=1) + "\n")
    planned.cache_clear()
    formulas_in.cache_clear()
    return scene


def group_name(number):
    return f"{number:06d}"


def groups_of(first, end, size):
    """Names of the groups that have the runs from `first` to before `end`."""
    return [group_name(number) for number in range(first // size, -(-end // size))]


def study_in(out):
    """The study of a folder; the runs of a table are in design.csv."""
    return study_file.read(out / "study.toml", out / "design.csv")


@functools.cache
def planned(out):
    """The study, the scene (as tomllib reads it, and its text) and the plan of a folder."""
    study = study_in(out)
    text = (out / "scene.toml").read_text("utf-8")
    return study, tomllib.loads(text), text, parsed((out / "plan.json").read_bytes(), out / "plan.json")


@functools.cache
def formulas_in(out):
    """The scene with its formulas, of the folder of a study that varies a name of [variables]; else None."""
    path = out / "formulas.toml"
    return tomllib.loads(path.read_text("utf-8")) if path.exists() else None


def given(out, study, rows=()):
    """What each run is given, by its number: run, network and values of parameters, as design.csv has them; of directional sampling as
    the lines of results have them."""
    if study.design.directions:
        return {row["run"]: row for row in rows}
    kinds = [str if one.values and isinstance(one.values[0], str) else study_file.number_of for one in study.parameters]
    with open(out / "design.csv", encoding="utf-8", newline="") as file:
        rows = csv.reader(file)
        next(rows)
        return {int(run): {"run": int(run), "network": int(network), "given": [kind(one) for kind, one in zip(kinds, of_run)]}
                for run, network, *of_run in rows}


def of_group(out, number):
    """The study, the scene, its text and the runs of a group."""
    study, scene, text, found = planned(out)
    runs = given(out, study)
    first = number * found["group"]
    return study, scene, text, [runs[run] for run in range(first, first + found["group"]) if run in runs]
