"""jointcreep: Runs scenes, and studies of many networks, writes reports, and fits joint sets to mapped traces.

usage: jointcreep run SCENE.toml -o OUT/ [options] [-- OPTIONS OF DEMSOLVE]
usage: jointcreep study STUDY.toml -o OUT/ [options]
usage: jointcreep report OUT/ ... -o REPORT.html [options]
usage: jointcreep report RESULT.h5 ... -o REPORT.html [options]
usage: jointcreep fit TRACES -o SETS.toml --window WINDOW [options]

Description:
run makes network.h5, joints.h5 and result.h5 of a scene, pictures, histories.csv, states.xdmf2 (for ParaView) and report.html. It
shows each command. Files are made only if they are missing, or if the scene, options or programs have changed. The same
command continues an interrupted run. A run without equilibrium has pictures of the moving blocks, and a report.
study makes the runs of a study file, and writes their results and statistics: runs.csv and runs.h5 (a row a run),
answers.csv (means, quantiles and probabilities with confidence), convergence.csv, shares.csv, summary.txt and pictures. The
same command continues an interrupted study; until then tables and answers have the runs that have ended. Two studies never work in one
folder at once.
report writes one page of HTML, with all pictures in it, for studies and result files of demsolve, one or several.
fit finds the laws of joint sets from the traces in a convex window (GeoJSON, CSV, GeoPackage, Shapefile, DXF), and writes them as
[[joint_set]]. Traces that the window cuts are censored. The laws are those of all joints, not of the traces in the window.

Options:
  -o [ --output ] OUT       the folder of a run or study, or the report or sets to write; - is standard output
  -j [ --jobs ] N           study: runs at a time (default 1)
  --finish                  study: make no more runs; answers, pictures and report are of those that have ended
  --snakemake PROFILE       study: make runs by Snakemake with this profile, a folder with config.yaml
  --realization R           run: which of the seed's networks (default 0)
  --pairs PAIRS             report: pairs of points for closures: "left wall,right wall; crown,floor" (default: all)
  --notes TEXT              report: a text file that comes first: paragraphs between blank lines, # headings, - lists
  --makefile                run: write OUT/Makefile with these commands, and make nothing else
  --programs FOLDER         where jointgen, strength-averaging and demsolve are (default: beside jointcreep, then PATH)
  -q [ --quiet ]            run, study, fit: no commands, no progress and no summary
  --window WINDOW           run, report: x0,y0,x1,y1 or four words, the part of the section in pictures of states and the two details, in metres
                            fit: x1,y1,x2,y2 of a rectangle in metres, or more corners, or a scene file whose outline it is
  --layer NAME              fit: layer of the file
  --property NAME           fit: a set for each value of this property, in CSV a column
  --name NAME               fit: name of the set (default: the file's)
  --material NAME           fit: joint material of the sets (default: joint)
  --law NAME                fit: law of lengths (default: the one with the largest likelihood in cross-validation)
  --shortest M              fit: shortest length that was mapped; shorter ones are left out
  --longest M               fit: longest trace, for a power law, which also needs --shortest
  --edge M                  fit: ends nearer than this to the window's edge count as cut (default: 1e-6 of its size)
  --poles POLES.csv         fit: orientation from measured planes, by Fisher's law
  --azimuth DEG             fit: the planes are those of traces in a section with this bearing; Terzaghi's weights
  --scanline-trend DEG      fit: the planes were met by a scanline with this bearing; Terzaghi's weights
  --scanline-plunge DEG     fit: its inclination below the horizontal
  -h [ --help ]             show this text
  -V [ --version ]          show the version

Exit codes:
  0  done
  2  the command line, the study, the scene or a file is not as expected
  3  run: no equilibrium was found; study: no run ended with a value, so there are no answers
  4  a file could not be read or written, or programs of runs were stopped; the same command continues
  5  internal error, or out of memory
  130, 143  stopped by Ctrl-C, by SIGTERM; the same command continues

Example:
  jointcreep run scene.toml -o out/ -- --no-creep
  jointcreep study slope.toml -o out/ -j 2
"""

import dataclasses
import difflib
import itertools
import math
import os
import pathlib
import shlex
import shutil
import signal
import sys
import traceback

from . import files, plan, runs, study_file, table
from .errors import NotDone, NotWanted, have_linear_algebra, lacks_memory

FIT_OPTIONS = ("window", "layer", "property", "name", "material", "law", "shortest", "longest", "edge", "poles", "azimuth",
               "scanline-trend", "scanline-plunge")
OF_ALL = {"-o": "output", "--output": "output", "--programs": "programs"}  # options of every subcommand
FLAGS = {"quiet", "makefile", "finish"}  # options without a value


@dataclasses.dataclass
class Subcommand:
    """One of SUBCOMMANDS, below."""
    run: object  # run(source, options, beside) makes it, and returns the exit code
    words: dict  # its own options: word on the command line, name in `options`
    writes_text: bool = False  # -o - is possible: standard output
    takes_many: bool = False  # inputs; those after the first as options["others"]
    passes_on: bool = False  # what follows "--" to demsolve, as options["rest"]


def options_of(arguments):
    """The subcommand, its input and its options by name."""
    if not arguments:
        raise NotWanted(usage())
    name, *rest = arguments
    if name == "-v":
        raise NotWanted("-v is no option; -V shows the version, -q is without the summary")
    if name not in SUBCOMMANDS:
        raise NotWanted(f'unknown subcommand "{name}"; expected {" or ".join(SUBCOMMANDS)}\n{usage()}')
    known = {**OF_ALL, **SUBCOMMANDS[name].words}
    found, source, others = {}, None, []
    if SUBCOMMANDS[name].passes_on:
        end = rest.index("--") if "--" in rest else len(rest)
        rest, found["rest"] = rest[:end], rest[end + 1:]
    while rest:
        word = rest.pop(0)
        word, equals, value = word.partition("=") if word.startswith("--") else (word, "", "")
        if word.startswith("-j") and word[2:].isdecimal() and "-j" in known:  # -j4, as Make has it
            word, equals, value = "-j", "=", word[2:]
        if word in known:
            option = known[word]
            if option in found:
                raise NotWanted(f"{word} is given twice")
            if option in FLAGS and not equals:
                found[option] = True
            elif equals or rest:
                found[option] = value if equals else rest.pop(0)
                if option == "window" and all(map(is_number, [found[option], *rest[:3]])):  # four words, as plots have it
                    found[option], rest = ",".join([found[option], *rest[:3]]), rest[3:]
            else:
                raise NotWanted(f"{word} has no value")
        elif source is not None and not word.startswith("-") and SUBCOMMANDS[name].takes_many:
            others.append(pathlib.Path(word))
        elif word.startswith("-") or source is not None:
            near = difflib.get_close_matches(word, known, 1) if word.startswith("--") else []
            of_demsolve = '; options of demsolve follow "--"' if SUBCOMMANDS[name].passes_on and word.startswith("--") else ""
            raise NotWanted(f'unknown option or second input "{word}"' + (f"; did you mean {near[0]}?" if near else of_demsolve) + f"\n{usage()}")
        else:
            source = word
    if source is None or not found.get("output"):
        raise NotWanted(f"{name} needs an input, and an output with -o\n{usage()}")
    if found["output"] == files.STANDARD_OUTPUT and not SUBCOMMANDS[name].writes_text:
        raise NotWanted(f"-o -: {name} makes a folder, not standard output; expected its name")
    jobs = found.get("jobs", "1")
    if not jobs.isdecimal() or not 1 <= int(jobs) <= 10000:
        raise NotWanted(f'--jobs is "{jobs}"; expected a whole number from 1 to 10000')
    return SUBCOMMANDS[name], pathlib.Path(source), {**found, "jobs": int(jobs), "others": others}


def is_number(word):
    try:
        return math.isfinite(float(word))
    except ValueError:
        return False


def usage():
    return "\n".join(line for line in __doc__.splitlines() if line.startswith("usage: ")) + "\nMore: jointcreep --help"


def programs_in(folder, beside):
    """The folder of the programs."""
    if folder:
        return pathlib.Path(folder).resolve()
    if (beside / "jointgen").exists():
        return beside
    found = shutil.which("jointgen")
    if not found:
        raise NotWanted("jointgen is neither beside jointcreep nor in the PATH; expected --programs FOLDER")
    return pathlib.Path(found).resolve().parent


def window_of(options):
    """[x0, y0, x1, y1] [m] of --window, a part of the section to draw; None without it."""
    text = options.get("window")
    if text is None:
        return None
    words = text.split(",")
    window = [float(word) for word in words] if all(map(is_number, words)) else []
    if len(window) != 4 or window[0] >= window[2] or window[1] >= window[3]:
        raise NotWanted(f'--window is "{text}"; expected x0,y0,x1,y1 in metres (or four words), with x0 below x1 and y0 below y1')
    return window


def run(source, options, beside):
    """Makes the results, pictures and report of a scene."""
    from . import run as of_scene
    options = {**options, "window": window_of(options)}
    return of_scene.run(source, options, programs_in(options.get("programs"), beside), beside / "jointcreep")


def study(source, options, beside):
    """Makes a study."""
    programs = programs_in(options.get("programs"), beside)
    of_study = study_file.read(source)
    profile = options.get("snakemake")
    if profile and not (pathlib.Path(profile) / "config.yaml").exists():
        raise NotWanted(f"--snakemake: {profile} has no config.yaml; expected the folder of a profile")
    out, quiet = pathlib.Path(options["output"]).resolve(), options.get("quiet", False)
    with runs.stoppable(), runs.locked(out) as lock:
        if options.get("finish") and not (out / "plan.json").exists():
            raise NotWanted(f"--finish: {out} is not the folder of a study; expected one that was stopped")
        plan.make(of_study, out, programs)
        if options.get("finish"):
            rows = ended_rows(of_study, out)
            if not rows:
                raise NotWanted(f"--finish: no run has ended in {out}; the same command without --finish makes the runs")
            ended = sum((row["run"] < 0) == (of_study.design.directions > 0) for row in rows)  # replicates, or runs
            return finish(of_study, out, rows, "by --finish" * (ended < of_study.design.runs), quiet)
        from . import answers  # after the study is known to be right: it takes longer to load
        try:
            rows, why = runs.make(of_study, out, programs, options["jobs"], profile and str(pathlib.Path(profile).resolve()),
                                  quiet, lambda rows: answers.enough(of_study, rows), lock)
            behind = len(ended_rows(of_study, out)) - len(rows) if why not in ("", study_file.BY_STOP_RULE) else 0
            if behind > 0:
                why += f"; {behind} more, behind run {len(rows)}, which has not ended: --finish counts them"
        except KeyboardInterrupt as error:
            for number in runs.STOPS:
                signal.signal(number, signal.SIG_IGN)  # what follows takes a moment only, and then all ends
            raise runs.Stopped(runs.exit_code_of(error), finish_early(of_study, out, "by a signal", quiet)) from None
        except NotDone as error:
            raise NotDone(f"{error}\n{finish_early(of_study, out, 'without runs that could not be made', quiet)}") from None
        return finish(of_study, out, rows, why, quiet)


def ended_rows(of_study, out):
    """The lines of results of the runs that have ended, in the order of runs."""
    return [row for run, row in sorted(runs.read_rows(out).items()) if run < of_study.design.runs or of_study.design.directions]


def remove_pictures(out):
    """Removes pictures and bands of histories, which are of fewer runs, from an earlier call: a reader would mix the two."""
    path, names = out / "pictures.json", ["ensemble.h5", "ensemble.csv", "ensemble.png", "ensemble-y.png"]
    if path.exists():
        names += [name for of_quantity in plan.parsed(path.read_bytes(), path).values() for name in of_quantity]
    for name in ["pictures.json", *names]:
        (out / name).unlink(missing_ok=True)


def finish_early(of_study, out, why, quiet):
    """Tables and answers of the runs that have ended in a study that was stopped, or lacks runs; says how many. Without bands of
    histories and pictures, so that a report waits until the study has ended."""
    rows = ended_rows(of_study, out)
    count = sum(row["run"] >= 0 for row in rows)
    if not count:
        return "no run has ended"
    remove_pictures(out)
    write_answers(of_study, out, rows, why, quiet, False)
    of = "" if of_study.design.directions else f" of {of_study.design.runs}"
    return f"{count}{of} runs have ended; their results are in {out / 'runs.csv'}, the answers of these runs in {out / 'summary.txt'}\n" \
        "to end the study with these runs, with pictures and for a report: the same command with --finish"


def write_answers(of_study, out, rows, why, quiet, with_histories):
    """Writes tables and answers of the runs, and prints the summary. Returns rows and design as pictures.write() takes them, what was
    found, and whether the study has answers. why: it ended before all runs, "" with all; with_histories: also statistics of histories."""
    from . import answers, ensemble
    estimates = [row["probability"] for row in rows if row["run"] < 0]
    rows = [row for row in rows if row["run"] >= 0]
    given, text = plan.given(out, of_study, rows), (out / "scene.toml").read_text("utf-8")
    table.write(of_study, rows, given, text, out)
    of_histories = ensemble.write(rows, text, out) if with_histories else []
    found = answers.write(of_study, rows, given, why, estimates, of_histories, out)
    costs = answers.write_costs(of_study, rows, out) if of_study.design.fine_runs else []
    if not quiet:
        print((out / "summary.txt").read_text("utf-8"), *costs, sep="", end="", flush=True)
    return rows, given, found, bool(of_histories if with_histories else found)


def finish(of_study, out, rows, why, quiet):
    """Tables, answers and pictures of the runs. Returns the exit code. A signal waits until the answers are there."""
    try:
        with runs.unstopped():
            rows, given, found, has_answers = write_answers(of_study, out, rows, why, quiet, of_study.histories)
        from . import pictures
        pictures.write(of_study, rows, given, found, out)
    except KeyboardInterrupt as error:
        remove_pictures(out)
        raise runs.Stopped(runs.exit_code_of(error), f"all answers are in {out / 'summary.txt'}; the same command draws the pictures") from None
    return 0 if has_answers else 3


def report(source, options, beside):
    """Writes a report."""
    from . import report as page
    output = options["output"]
    page.write(source, output if output == files.STANDARD_OUTPUT else pathlib.Path(output), programs_in(options.get("programs"), beside),
               options.get("pairs"), window_of(options), options["others"], pathlib.Path(options["notes"]) if "notes" in options else None)
    return 0


def fit(source, options, beside):
    """Fits joint sets to mapped traces."""
    from . import fit as sets  # scipy takes long to load
    return sets.run(source, options, programs_in(options.get("programs"), beside), options["version"])


SUBCOMMANDS = {
    "run": Subcommand(run, {"--realization": "realization", "--window": "window", "--makefile": "makefile", "-q": "quiet", "--quiet": "quiet"}, passes_on=True),
    "study": Subcommand(study, {"-j": "jobs", "--jobs": "jobs", "--finish": "finish", "--snakemake": "snakemake", "-q": "quiet", "--quiet": "quiet"}),
    "report": Subcommand(report, {"--pairs": "pairs", "--window": "window", "--notes": "notes"}, writes_text=True, takes_many=True),
    "fit": Subcommand(fit, {"-q": "quiet", "--quiet": "quiet", **{f"--{name}": name for name in FIT_OPTIONS}}, writes_text=True),
}


def asks_for_help(arguments):
    """Whether this is a call for help, of a subcommand or of all. What follows -- is for demsolve."""
    own = list(itertools.takewhile(lambda word: word != "--", arguments))
    return own in (["-h"], ["--help"]) or own[:1] and own[0] in SUBCOMMANDS and ("-h" in own or "--help" in own)


def say(text):
    """Writes a text to standard output. The exit code."""
    try:
        print(text, end="", flush=True)
        return 0
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # Python would try again as it ends
        print(f"jointcreep: stdout could not be written: {error.strerror}", file=sys.stderr)
        return 4


def main(arguments, version, beside):
    """The exit code of the command line."""
    sys.stderr = sys.stderr or open(os.devnull, "w", encoding="utf-8")  # it was closed
    if asks_for_help(arguments) or arguments in (["-V"], ["--version"]):
        return say(__doc__ if asks_for_help(arguments) else f"jointcreep {version}\n")
    try:
        subcommand, source, options = options_of(arguments)
        have_linear_algebra()
        return subcommand.run(source, {**options, "version": version}, beside)
    except NotWanted as error:
        print(f"jointcreep: {error}", file=sys.stderr)
        return 2
    except NotDone as error:
        print(f"jointcreep: {error}", file=sys.stderr)
        return 4
    except Exception as error:
        if lacks_memory(error):
            print("jointcreep: out of memory", file=sys.stderr)
            return 5
        if isinstance(error, OSError):
            print(f"jointcreep: {error.filename or options['output']}: {error.strerror or error}", file=sys.stderr)
            return 4
        traceback.print_exc()
        print("jointcreep: internal error", file=sys.stderr)
        return 5
    except KeyboardInterrupt as error:
        what = f": {error.what}" if isinstance(error, runs.Stopped) and error.what else ""
        print(f"jointcreep: interrupted{what}", f"jointcreep: to continue: {shlex.join(['jointcreep', *map(str, arguments)])}", sep="\n",
              file=sys.stderr)
        return runs.exit_code_of(error)
