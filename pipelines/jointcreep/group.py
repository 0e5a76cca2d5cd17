"""Makes the runs of one group, one after another; of Snakemake's:  python3 -m jointcreep.group NUMBER  in the folder of a study.

A run is the chain of programs with one network and one set of parameters. Its line of results is appended to
groups/NUMBER.rows.part as soon as it has ended, and the file is called groups/NUMBER.rows once the group is complete. So a
group that was killed continues after its last whole line. Files of a run are in a folder of the group, which goes with it.

A run that fails is made once more, unless it is asked for whether it finds an equilibrium, and it does not. If it fails again, that is
its result: exit code, program and message. If a program was
stopped from outside (by a signal of those that users and systems send), could not read or write (exit code 4), or had too little memory, that is no
result: the run is made when the study is continued, and the exit code of the group is 4.
"""

import ctypes
import fcntl
import itertools
import json
import os
import pathlib
import re
import resource
import shutil
import signal
import subprocess
import sys
import time

from . import ensemble, plan, quantities, reading, scene_keys, study_file
from .chain import CANNOT_WRITE, FAILED_INSIDE, was_stopped, without
from .errors import NotDone, NotWanted, lacks_memory

LONGEST_REASON = 2000  # characters
SEARCH_OPTIONS = ("--safety-width", "--safety-displacement", "--runs-at-once")  # of demsolve --factor-of-safety
UP_TO_THERE = "the run up to there is "  # where demsolve has left a file, which goes with the others of the run
PR_SET_PDEATHSIG = 1  # linux/prctl.h
# A program that dies with the process of this number. Three programs start in a third of the time of a function that is called in a copy of
# this process (preexec_fn). The parent may have died before setpriv asked the kernel: the shell looks.
DYING_WITH_PARENT = ["setpriv", "--pdeathsig", "KILL", "sh", "-c", '[ "$PPID" = "$0" ] || exit 127; exec "$@"']
CANNOT_START = (126, 127)  # exit codes of setpriv and the shell
LIBC = ctypes.CDLL(None)
BEGUN = ".begun"  # ending of a file beside the folder of a run, which is as old as the run, also if the run is made twice
SAID = "said.txt"  # in the folder of a run: what the program that works there has written to stderr
# Progress there, which is no message: "run 4, strengths / 1.5: fails; ...", "33%, 8 s left: ...", "strengths / 1.5 (...", "2000 joints with".
PROGRESS = re.compile(r"demsolve: (run \d+, strengths |strengths [/x] |\d+%(, \d+ (s|min|h) left)?: )|jointgen: \d+ joints with about ")


def die_with(parent):
    """Called in a new process: asks the kernel to kill it when its parent dies."""
    LIBC.prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:
        os._exit(143)


class Interrupted(Exception):
    """A program was stopped from outside, or could not read or write."""


def programs_of(study, run):
    """The programs of a run in their order: name and arguments."""
    needs, options = quantities.needed(study), study.options_of(run)
    chain = [("jointgen", ["scene.toml", "-o", "network.h5"])]
    if any(needs.values()):
        chain.append(("strength-averaging", ["network.h5", "-o", "joints.h5"]))
    if needs["result.h5"]:
        chain.append(("demsolve", ["joints.h5", *without(options, SEARCH_OPTIONS)[0], "-o", "result.h5"]))
    if needs["safety.h5"]:
        chain.append(("demsolve", ["joints.h5", *options, "--factor-of-safety", "--no-mesh-estimate", "-o", "safety.h5"]))
    return chain


def processor_seconds():
    """Time of the processor that all programs took which this process has called."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def called(program, arguments, folder):
    """Exit code, message, warnings and wall time [s] of a program. What it says is in SAID, where the study can read it meanwhile."""
    begin = time.monotonic()
    try:
        with open(folder / SAID, "w+b") as said:
            done = subprocess.run([*DYING_WITH_PARENT, str(os.getpid()), program, *arguments], cwd=folder, stdin=subprocess.DEVNULL,
                                  stdout=subprocess.DEVNULL, stderr=said)
            said.seek(0)
            lines = [line for line in said.read().decode("utf-8", "replace").splitlines() if not PROGRESS.match(line)]
    except OSError as error:
        raise Interrupted(f"{error.filename or program} cannot be started: {error.strerror}") from None
    if done.returncode in CANNOT_START or done.returncode and lines[:1] and lines[0].startswith("setpriv: "):
        said = " ".join(re.sub(r"^\d+: (\d+: )?(exec: )?", "", line) for line in lines)
        raise Interrupted(f"{program} cannot be started, or ended with exit code {done.returncode}: {said}")
    warnings = [line.replace(": warning: ", ": ", 1) for line in lines if ": warning: " in line]
    lines = [line for line in lines if ": warning: " not in line and not line.removeprefix(f"{program.name}: ").startswith(UP_TO_THERE)]
    lines = lines[:1] + [line.removeprefix(f"{program.name}: ") for line in lines[1:]]
    return done.returncode, " ".join("; ".join(lines).split())[:LONGEST_REASON], warnings, time.monotonic() - begin


def made(study, scene, text, run, programs, folder):
    """One try of a run: its line of results. Raises Interrupted if there is none."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    values, formulas = {}, plan.formulas_in(folder.parent.parent)
    for parameter, value in zip(study.parameters, run["given"]):
        for key in parameter.keys:
            values[key] = scene_keys.value_at(scene, key) * value if parameter.multiplies else value
    (folder / "scene.toml").write_text(scene_keys.toml_text(scene_keys.changed(formulas or scene, values)) if values else text, "utf-8")
    row = {"run": run["run"], "exit_code": 0, "program": "", "reason": "", "warnings": []}
    seconds, processor_before, codes, endings = 0.0, processor_seconds(), {}, {}
    for name, arguments in programs_of(study, run["run"]):
        if name == "jointgen":
            arguments = [*arguments, "--realization", str(run["network"])]
        code, message, warnings, took = called(programs / name, ["--quiet", *arguments] if "result.h5" in arguments else arguments, folder)
        seconds += took
        row["warnings"] += warnings
        if was_stopped(code) or code == FAILED_INSIDE and "out of memory" in message:
            why = f"exit code {code}" if code > 0 else f"signal {-code}"
            raise Interrupted(f"run {run['run']}: {name} was stopped ({why}){': ' if message else ''}{message}")
        if name == "demsolve":
            made_file = arguments[-1]
            codes[made_file] = code
            if code == quantities.NO_EQUILIBRIUM:
                endings[made_file], found = quantities.failure(folder / made_file.replace(".h5", ".failed.h5"))
                row.setdefault("failure", found)  # of the first one, as quantities.ending_of()
        if code != 0 and row["exit_code"] == 0:
            row.update(exit_code=code, program=name, reason=message)
        if code != 0 and name != "demsolve":
            break
        if name == "jointgen" and formulas:  # dates can be numbers by a formula
            scene = reading.File(folder / "network.h5").scene
    row.update(network=run["network"], given=run["given"])
    row["no_equilibrium"] = endings
    row["values"] = quantities.of_run(study, scene, folder, codes, endings)
    if study.histories and codes.get("result.h5") == 0:
        row["history"] = ensemble.of_run(folder / "result.h5")
    keep_files(study, row["run"], folder)
    row["program_seconds"] = seconds
    row["processor_seconds"] = processor_seconds() - processor_before
    return row


def keep_files(study, run, folder):
    """Moves what is to be kept of a run to kept/RUN-NAME in the study's folder; what an earlier try left there goes."""
    kept = folder.parent.parent / "kept"
    for name in study.keep:
        if (folder / name).exists():
            kept.mkdir(exist_ok=True)
            os.replace(folder / name, kept / f"{run:06d}-{name}")
        else:
            (kept / f"{run:06d}-{name}").unlink(missing_ok=True)


def result_of(study, scene, text, run, programs, folder):
    """The line of results of a run, made once more if it fails; but not if it finds no equilibrium and that is asked for."""
    begin = time.monotonic()
    folder.with_suffix(BEGUN).touch()
    answer = quantities.NO_EQUILIBRIUM if any(one.what == "failed" for one in study.quantities) else 0
    for attempt in (1, 2):
        try:
            row = made(study, scene, text, run, programs, folder)
        except Interrupted:
            if attempt == 2:
                raise
            continue
        if row["exit_code"] in (0, answer):
            break
    return {**row, "attempts": attempt, "seconds": time.monotonic() - begin}


def whole_lines(file, path):
    """Lines of results that a group has; a last line that was cut off is removed from the file."""
    file.seek(0)
    content = file.read()
    end = content.rfind(b"\n") + 1
    file.truncate(end)
    return [plan.row_of(line, path) for line in content[:end].splitlines()]


def guarded(make):
    """Calls make(); the exit code for the group."""
    try:
        make()
    except Interrupted as error:
        print(f"jointcreep: {error}; the same command of the study makes it", file=sys.stderr, flush=True)
        return CANNOT_WRITE
    return 0


def follow_directions(study, replicate, done, make, keep):
    """Makes the runs that directional sampling asks for in a replicate; those that are done are asked for again in the same order.
    Keeps the estimate as a line of its own, run -1 - replicate. Returns the exit code."""
    from . import failure
    asked = itertools.count(replicate * study_file.MOST_RUNS)

    def run(values):
        number = next(asked)
        if number in done:
            if done[number]["given"] != values:
                raise NotDone(f"run {number} was made with {done[number]['given']}, not with {values}: another version of OpenTURNS?")
            return done[number]
        return make({"run": number, "network": replicate if study.varies_network else 0, "given": values})

    if -1 - replicate in done:
        return 0
    return guarded(lambda: keep({"run": -1 - replicate, "probability": failure.estimate(study, replicate, run)}))


def make_group(number, out, programs):
    """Makes the runs that a group lacks. Returns the exit code."""
    rows = out / "groups" / f"{number}.rows"
    part = rows.with_name(rows.name + ".part")
    study, scene, text, runs = plan.of_group(out, int(number))
    with open(part, "a+b") as file:
        fcntl.flock(file, fcntl.LOCK_EX)  # whoever else works at this group has to end first
        if rows.exists():
            part.unlink(missing_ok=True)
            return 0
        if not part.exists():  # whoever worked at it has removed or renamed it
            return make_group(number, out, programs)
        done = {row["run"]: row for row in whole_lines(file, part)}
        folder = out / "work" / number
        folder.parent.mkdir(exist_ok=True)

        def keep(row):
            file.write(json.dumps(row).encode() + b"\n")
            file.flush()

        def make(run):
            row = result_of(study, scene, text, run, programs, folder)
            keep(row)
            return row

        code = 0
        if study.design.directions:
            code = follow_directions(study, int(number), done, make, keep)
        for run in runs:
            if run["run"] not in done:
                code = max(code, guarded(lambda run=run: make(run)))
        shutil.rmtree(folder, ignore_errors=True)
        folder.with_suffix(BEGUN).unlink(missing_ok=True)
        if code == 0:
            os.fsync(file.fileno())
            os.replace(part, rows)
        return code


def exit_code(number, out, programs):
    """Makes a group, and says what went wrong. Returns the exit code of the process that does it."""
    try:
        return make_group(number, out, programs)
    except KeyboardInterrupt:  # said by the study
        return 128 + signal.SIGINT
    except (NotDone, NotWanted) as error:
        print(f"jointcreep: {error}", file=sys.stderr)
    except Exception as error:
        if not lacks_memory(error) and not isinstance(error, OSError):
            raise
        print("jointcreep: out of memory" if lacks_memory(error) else f"jointcreep: {out}: {error}", file=sys.stderr)
    return CANNOT_WRITE


if __name__ == "__main__":
    sys.exit(exit_code(sys.argv[1], pathlib.Path.cwd(), pathlib.Path(os.environ["JOINTCREEP_PROGRAMS"])))
