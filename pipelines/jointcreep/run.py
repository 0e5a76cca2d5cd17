"""One scene from its file to results, pictures and a report, in a folder.

A step is one command. It is made if what it made is not there as it was, or if its command or the content of one of its inputs has
changed; run.json in the folder keeps digests of them. So what is there already is not computed again, and the same command continues an interrupted run.
"""

import collections
import dataclasses
import datetime
import glob
import hashlib
import importlib.util
import json
import os
import pathlib
import shlex
import shutil
import signal
import subprocess
import sys
import tomllib

import h5py

from . import files, group, plan, runs
from .chain import CANNOT_WRITE, was_stopped, without
from .errors import NotDone, NotWanted

PROGRAMS = ["jointgen", "strength-averaging", "demsolve", "jointexport"]
SET_HERE = ["-o", "--output", "-q", "--quiet", "-h", "--help", "-V", "--version", "--checkpoint"]  # of demsolve's options
NO_CHANGE = ["--threads", "--checkpoint-every"]  # they do not change its result
NO_EQUILIBRIUM = 3  # exit code
CHECKPOINTS = ["checkpoint.h5", "checkpoint.stands.h5", "checkpoint.falls.h5"]
RECORD, LAYOUT = "run.json", 1  # the number is raised when what it has changes
RESULT, FAILED = "result.h5", "result.failed.h5"
PYTHON = pathlib.Path(sys.executable)
PLOTS = pathlib.Path(importlib.util.find_spec("figure").origin).resolve().parent
MAKEFILE = "# The files of a scene, in this folder: jointcreep run --makefile wrote these commands."
NOT_IN_MAKE = set("\n\r\t:;=|\\~*?[]")  # in names of files that others depend on


@dataclasses.dataclass
class Step:
    """A command. Relative paths are in the folder, absolute ones elsewhere."""
    makes: str  # name of its file in the folder
    command: list  # words: str, or Path of a file
    needs: list = dataclasses.field(default_factory=list)  # Paths of inputs that the command does not name
    options: list = dataclasses.field(default_factory=list)  # at the end of the command: such as do not change what it makes
    draw: object = None  # draw(Folder) does in this process what the command does, which saves loading
    solves: bool = False  # is demsolve, which may find no equilibrium and keeps checkpoints

    def inputs(self):
        """Paths of all inputs."""
        named = [word for word in self.command if isinstance(word, pathlib.Path) and word != PYTHON and str(word) != self.makes]
        return [path for path in named if not path.is_dir()] + self.needs


def typed(path):
    """A path as a word of a command line, which no program takes for an option."""
    return f"./{path}" if str(path).startswith("-") else str(path)


def value_of(words, name):
    """The value of an option, or None."""
    taken = without(words, [name])[1]
    return (taken[-1] if taken[0] == name else taken[0].partition("=")[2]) if taken else None


def tables(scene, name):
    """The tables of this name, as far as a scene that nobody has checked has them."""
    found = scene.get(name)
    return [one for one in found if isinstance(one, dict)] if isinstance(found, list) else []


def named_files(scene, folder):
    """Paths of the files that a scene names, where they are read from the folder of the scene; of a Shapefile all its parts."""
    kept = [one.get("name") for one in tables(scene, "file")]
    names = [one.get("file") for one in tables(scene, "mapped")]
    names += [one["orientation"].get("poles") for one in tables(scene, "joint_set") if isinstance(one.get("orientation"), dict)]
    paths = {folder / name for name in names if isinstance(name, str) and "\0" not in name and name not in kept}
    for path in [path for path in paths if path.suffix.lower() == ".shp"]:
        paths.update(path.parent.glob(f"{glob.escape(path.stem)}.*"))
    return sorted(paths)


def is_before(date, until, start):
    """Whether a stage's date, or day, is not after the day `until`."""
    day = (date - start).days if isinstance(date, datetime.date) else date - start
    return until is None or day <= until


class Plan:
    """The steps of a scene in their order. scene: as tomllib reads it; source: its path; options: of demsolve; programs: their folder;
    launcher: path of jointcreep; realization: of the network, None for jointgen's default; window: x0, y0, x1, y1 [m] of the part of the
    section in pictures of states, None: the surroundings of the faces of stages."""

    def __init__(self, scene, source, options, programs, launcher, realization, window=None):
        self.scene, self.source, self.programs, self.launcher = scene, source, programs, launcher
        self.window = window
        self.of_network = [] if realization is None else ["--realization", realization]
        self.options, self.harmless = without(options, NO_CHANGE)

    def chain(self):
        scene, network, joints, result = self.source, *map(pathlib.Path, ("network.h5", "joints.h5", RESULT))
        by_error = "increments_tolerance" in self.scene.get("equilibrium", {}) or value_of(self.options, "--increments-tolerance")
        keeps = [] if by_error else ["--checkpoint", CHECKPOINTS[0]]  # demsolve keeps none of runs that it makes again
        return [Step("network.h5", [self.programs / "jointgen", scene, *self.of_network, "-o", network], named_files(self.scene, scene.parent)),
                Step("joints.h5", [self.programs / "strength-averaging", network, "-o", joints]),
                Step(RESULT, [self.programs / "demsolve", joints, *self.options, *keeps, "-o", result],
                     options=self.harmless, solves=True)]

    def changes_between_stages(self):
        """Whether rock moves other than at stages: by creep, or by loads over time."""
        creeps = "creep" in self.scene and "--no-creep" not in self.options
        return creeps or any("load_history" in one for one in tables(self.scene, "boundary"))

    def states(self, failed):
        """States that are drawn, as the word in names of files and the one for --state: those after each stage, and the last one. The
        state after the last stage is left out if it is the last one. failed: the events of the states of a run without equilibrium; None for others."""
        from stage_names import plain
        stages = self.scene.get("stage", [])
        names = [str(stage.get("name", "")) for stage in stages]
        words = plain(names)
        if failed is not None:
            by_name = dict(zip(names, words))
            return [(by_name[event], str(number)) for number, event in enumerate(failed) if event in by_name] + [("last", "last")]
        until, start = value_of(self.options, "--until"), self.scene.get("schedule", {}).get("start", 0)
        try:
            until = None if until is None else float(until)
        except ValueError:  # demsolve says it
            until = None
        reached = [(word, word) for word, stage in zip(words, stages) if is_before(stage.get("date", 0), until, start)]
        return (reached if self.changes_between_stages() else reached[:-1]) + [("last", "last")]

    def pictures(self, failed=None):
        from suited import detail, magnified, state_fields, suited
        window = self.window or detail(self.scene)
        result = pathlib.Path(RESULT if failed is None else FAILED)
        network, joints = pathlib.Path("network.h5"), pathlib.Path("joints.h5")
        wanted = set(suited(self.scene))
        if not value_of(self.options, "--step-history"):
            wanted.discard("step_history")
        of = {"section": network, "blocks": network, "stereonet": network, "rose": network, "distributions": network,
              "strength": joints, "step_history": result, "dynamics": result}
        for name, source in of.items():
            if name in wanted:
                yield self.picture(name, source, name.replace("_", "-"))
        if window:
            for name in ("section", "blocks"):
                yield self.picture(name, network, f"{name}-detail", window=window)
        for component in "xy" if "histories" in wanted else "":
            yield self.picture("histories", result, f"histories-{component}", component=component)
        if "line" in wanted:
            yield self.picture("line", result, "lines")
        for word, state in self.states(failed):
            for field in state_fields(self.scene):
                yield self.picture("state", result, f"{word}-{field}", state=state, field=field, window=window,
                                   magnify=magnified(self.scene, field) or None)
        if failed is not None:
            yield self.moving_blocks()

    def moving_blocks(self):
        from suited import magnified
        return self.picture("state", pathlib.Path(FAILED), "failure", around_failure=True, magnify=magnified(self.scene) or None)

    def picture(self, name, source, picture, **options):
        """The step that draws a plot; options that are None are left out."""
        options = {option: value for option, value in options.items() if value is not None}

        def draw(folder):
            from . import plots  # matplotlib takes long to load
            plots.save(name, folder.out / source, folder.out / output, **options)

        output = pathlib.Path(f"{picture}.png")
        words = [word for option, value in options.items()
                 for word in (f"--{option.replace('_', '-')}",
                              *([] if value is True else map(str, value if isinstance(value, list) else [value])))]
        script = PLOTS / f"plot_{name}.py"
        return Step(str(output), [PYTHON, script, source, *words, "-o", output], draw=draw)

    def rest(self, failed=None, falls=False):
        """The steps after demsolve: pictures, tables and the report. failed: as in states(). falls: there is also a result.failed.h5, of the
        run with the smallest strength factor that found no equilibrium."""
        result = pathlib.Path(RESULT if failed is None else FAILED)
        steps = list(self.pictures(failed))
        if failed is None and "--factor-of-safety" in self.options:
            times = value_of(self.options, "--safety-displacement")
            steps.append(self.picture("safety", result, "safety", **({"safety_displacement": float(times)} if times else {})))
        if falls:
            steps.append(self.moving_blocks())
        for name in ["histories.csv"] * ("point" in self.scene or "monitoring_line" in self.scene) + ["states.xdmf2"]:
            steps.append(Step(name, [self.programs / "jointexport", result, "--quiet", "-o", pathlib.Path(name)]))

        def write(folder):
            from . import report
            pictures = {step.makes: folder.out / step.makes for step in steps
                        if step.draw and result in step.command and folder.has_made(step)}
            report.write(folder.out / result, folder.out / "report.html", self.programs, window=self.window, pictures=pictures)

        page = [self.launcher, "report", result, "-o", pathlib.Path("report.html")]
        page += ["--programs", self.programs] if self.programs != self.launcher.parent else []
        page += ["--window", ",".join(map(str, self.window))] if self.window else []
        needs = [self.programs / "jointverify", *[pathlib.Path(FAILED)] * falls]
        return [*steps, Step("report.html", page, needs, draw=write)]


class Folder:
    """The folder of a run, its record, and how far it is."""

    def __init__(self, out, source, scene_path, quiet, lock):
        self.out, self.quiet, self.lock = out, quiet, lock
        self.words = {scene_path: typed(source)}  # paths as the user typed them
        self.shown = lambda path: typed(out / path)
        self.known = {}  # digests of this call
        self.made, self.kept = [], []
        try:
            self.record = json.loads((out / RECORD).read_bytes())
        except (FileNotFoundError, ValueError):
            self.record = None
        if not isinstance(self.record, dict) or self.record.get("layout") != LAYOUT:  # then nothing is known of what is there
            self.record = {"layout": LAYOUT, "steps": {}, "files": {}}

    def save(self):
        files.write_text(self.out / RECORD, json.dumps(self.record, indent=1) + "\n")

    def digest(self, path):
        """SHA-256 of a file's content, "" if it cannot be read."""
        path = self.out / path
        if path not in self.known:
            try:
                with open(path, "rb") as file:
                    self.known[path] = hashlib.file_digest(file, "sha256").hexdigest()
            except OSError:
                return ""
        return self.known[path]

    def identity(self, step):
        """What makes a step's file what it is: its words, and digests of its inputs. Names of files elsewhere do not count."""
        outside = [path for path in step.inputs() if path.is_absolute()]
        inputs = [[path.name if path in step.needs else "", self.digest(path)] for path in outside]
        inputs += [[str(path), self.digest(path)] for path in step.inputs() if not path.is_absolute()]
        if step.draw:
            own = pathlib.Path(__file__).parent
            code = sorted([*PLOTS.glob("*.py"), *(own.glob("*.py") if step.makes == "report.html" else [own / "plots.py"])])
            inputs.append(["plots", hashlib.sha256("".join(map(self.digest, code)).encode()).hexdigest()])
        words = [str(word) if not (isinstance(word, pathlib.Path) and word.is_absolute()) else "" for word in step.command]
        return {"command": words, "inputs": inputs}

    def line(self, step):
        """The command as one can type it here, as a list of words."""
        def word_of(word):
            if not isinstance(word, pathlib.Path):
                return str(word)
            if not word.is_absolute():
                return self.shown(word)
            found = shutil.which(word.name)
            return self.words.get(word) or (word.name if found and os.path.realpath(found) == str(word) else str(word))

        words = [word_of(word) for word in [*step.command, *step.options]]
        if CHECKPOINTS[0] in words:
            place = words.index(CHECKPOINTS[0])
            words[place] = self.shown(CHECKPOINTS[0])
        return words

    def is_there(self, step, identity):
        """Whether what a step makes is there, made of the same."""
        old = self.record["steps"].get(step.makes)
        return old is not None and old["of"] == identity and all(self.digest(name) == self.record["files"].get(name) != ""
                                                                for name in old["makes"])

    def has_made(self, step):
        """Whether the step has made its file: it makes no picture of what the result does not have."""
        return bool(self.record["steps"].get(step.makes, {"makes": []})["makes"])

    def make(self, step):
        """Makes a step, if need be. Returns the exit code of its program."""
        identity = self.identity(step)
        if self.is_there(step, identity):
            self.kept.append(step.makes)
            old = self.record["steps"][step.makes]
            if old["said"]:
                self.say(old["said"])
            return old["code"]
        if step.solves:
            self.remove(FAILED)
            if "begun" in self.record:  # then a run that was stopped may have left one
                (self.out / FAILED).unlink(missing_ok=True)
            if self.record.get("begun") != identity:
                self.remove_checkpoints()
            self.record["begun"] = identity
            self.save()
        if not self.quiet:
            print(shlex.join(self.line(step)), file=sys.stderr, flush=True)
        code, said, makes = 0, "", [step.makes]
        if step.draw:
            load_plots()
            try:
                step.draw(self)
            except NotWanted as error:
                makes, said = [], f"{self.shown(step.makes)} is not made: {error}"
                self.say(said)
        else:
            code = self.call(self.line(step), step)
        if code == NO_EQUILIBRIUM and step.solves:
            makes = [FAILED]
        elif code != 0:
            return code
        elif step.solves and "--factor-of-safety" in step.command and (self.out / FAILED).exists():
            makes.append(FAILED)
        for name in makes:
            self.known.pop(self.out / name, None)
            self.record["files"][name] = self.digest(name)
        self.record["steps"][step.makes] = {"of": identity, "makes": makes, "code": code, "said": said}
        self.made.append(step.makes)
        if step.solves:
            self.record.pop("begun", None)
        self.save()
        if step.solves:
            self.remove_checkpoints()
        return code

    def call(self, words, step):
        """The exit code of a program, which writes to the same screen."""
        words = [str(step.command[0]), *words[1:], *(["--quiet"] if self.quiet and "--quiet" not in words else [])]
        sys.stdout.flush()
        code = until_ended(words, self.lock)
        if was_stopped(code) and code != CANNOT_WRITE:
            raise NotDone(f"{step.command[0].name} was stopped (exit code {code}); the same command continues")
        return code if code >= 0 else 128 - code

    def say(self, words):
        print(f"jointcreep: {words}", file=sys.stderr, flush=True)

    def remove_checkpoints(self):
        for name in CHECKPOINTS:
            (self.out / name).unlink(missing_ok=True)

    def remove(self, name):
        """Removes a file that an earlier call made, if it is still as it was."""
        if name in self.record["files"] and self.digest(name) == self.record["files"].pop(name):
            (self.out / name).unlink(missing_ok=True)
            self.known.pop(self.out / name, None)

    def tidy(self, steps):
        """Removes what an earlier call made and this one would not: the folder shows one scene."""
        wanted = {name for step in steps for name in self.record["steps"].get(step.makes, {"makes": []})["makes"]}
        for name in set(self.record["files"]) - wanted:
            self.remove(name)
        names = {step.makes for step in steps}
        self.record["steps"] = {name: step for name, step in self.record["steps"].items() if name in names}
        self.save()


def until_ended(words, lock):
    """The exit code of a program. A signal to stop is passed on to it, once: demsolve then keeps its state in a checkpoint. It ignores
    Ctrl-C, which a terminal sends to it, too: a second signal would end it at once. Signals that are ignored here (nohup) stay so."""
    def stop(signal_number, _):
        print("jointcreep: stopped; the same command continues", file=sys.stderr, flush=True)
        raise SystemExit(128 + signal_number)

    def prepared():
        group.die_with(parent)
        signal.signal(signal.SIGINT, signal.SIG_IGN)

    parent = os.getpid()
    with runs.stoppable(stop), subprocess.Popen(words, stdin=subprocess.DEVNULL, pass_fds=[lock.fileno()], preexec_fn=prepared) as running:
        try:
            return running.wait()
        except BaseException:
            running.terminate()
            running.wait()
            raise


def load_plots():
    """Loads matplotlib. Ctrl-C waits until it is loaded: inside, it may be taken for an error of a file, or be lost."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        from . import plots  # noqa: F401
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def in_make(path):
    """A path as a target or prerequisite of GNU Make."""
    if NOT_IN_MAKE & set(str(path)):
        raise NotWanted(f'--makefile: make cannot depend on a file called "{path}"; expected a path without line breaks, tabs, and the '
                        f"characters {' '.join(sorted(NOT_IN_MAKE - set(chr(9) + chr(10) + chr(13))))}")
    return str(path).replace("$", "$$").replace("#", "\\#").replace(" ", "\\ ")


def makefile_text(steps):
    """A Makefile of these steps, for the folder itself."""
    lines = [MAKEFILE, ".DELETE_ON_ERROR:", ".SUFFIXES:", "MAKEFLAGS += --no-builtin-rules", ".PHONY: all",
             "all: " + " ".join(in_make(step.makes) for step in steps)]
    for step in steps:
        words = shlex.join([str(word) for word in [*step.command, *step.options]])
        if step.solves:
            words += f" && rm -f {shlex.join(CHECKPOINTS)}"
        if "\n" in words or "\r" in words:
            raise NotWanted(f"--makefile: a command of make has no line breaks, and {words!r} has some")
        lines += ["", f"{in_make(step.makes)}: {' '.join(map(in_make, step.inputs()))}", "\t" + words.replace("$", "$$")]
    return "\n".join(lines) + "\n"


def write_makefile(folder, steps, quiet):
    """Writes it into the folder, over nothing but an earlier one."""
    path = folder.out / "Makefile"
    if path.exists() and not path.read_text("utf-8", errors="replace").startswith(MAKEFILE):
        raise NotWanted(f"{path}: is not of jointcreep run; expected no such file, or another folder")
    files.write_text(path, makefile_text(steps))
    if not quiet:
        print(f"{path} has the commands; now: make -C {shlex.quote(typed(folder.out))}")


def check_options(words):
    """Refuses options of demsolve that are set here."""
    for word in words:
        if word.partition("=")[0] in SET_HERE or word[:1] == "-" and word[1:2] in ("o", "q", "h") and word[1:2] != "-":
            raise NotWanted(f'"{word}" after --: jointcreep run sets this option of demsolve; expected others')


def run(source, options, programs, launcher):
    """Makes what is missing. Returns the exit code: that of the program that failed, if one did."""
    check_options(options["rest"])
    for name in PROGRAMS:
        if not (programs / name).exists():
            raise NotWanted(f"{programs / name}: is not there; expected the programs of jointcreep in {programs}")
    try:
        scene, why = tomllib.loads(source.read_bytes().decode("utf-8-sig")), ""
    except ValueError as error:  # jointgen says it better
        scene, why = {}, str(error)
    quiet, out, path = options.get("quiet", False), pathlib.Path(options["output"]), source.resolve()
    for read in [path, *named_files(scene, path.parent)]:
        if read.parent == out.resolve():
            raise NotWanted(f"{read}: is read, and is in the folder of the run; expected another folder")
    with runs.locked(out, "run") as lock:
        folder = Folder(out, source, path, quiet, lock)
        of_scene = Plan(scene, path, options["rest"], programs, launcher, options.get("realization"), options.get("window"))
        if options.get("makefile"):
            plan.answer_of(programs / "jointgen", typed(source), "--check")
            write_makefile(folder, [*of_scene.chain(), *of_scene.rest()], quiet)
            return 0
        return make(folder, of_scene, why)


def warnings_in(path):
    """How many warnings a file has, and of which programs: "3, of jointgen 2, demsolve 1; the report lists them"."""
    with h5py.File(path) as file:
        count = collections.Counter(files.texts(file, "/warnings/program") if "warnings" in file else [])
    words = ", ".join(f"{program} {number}" for program, number in count.items())
    return f"{count.total()}, of {words}; the report lists them" if count else "none"


def make(folder, of_scene, why):
    """Makes the steps of a plan. why: the scene cannot be read, of which jointgen says more."""
    chain = of_scene.chain()
    for step in chain:
        code = folder.make(step)
        if code != 0 and not (step.solves and code == NO_EQUILIBRIUM):
            return code
        if why:
            raise NotWanted(f"{of_scene.source}: {why}")
    events, reason = None, ""
    if code != 0:
        with h5py.File(folder.out / FAILED) as file:
            events, reason = files.texts(file, "/states/event"), files.texts(file, "/failure/reason")[0]
    steps = of_scene.rest(events, code == 0 and FAILED in folder.record["steps"][RESULT]["makes"])
    for step in steps:
        of_step = folder.make(step)
        if of_step != 0 and code == 0:
            return of_step
    folder.tidy([*chain, *steps])
    if not folder.quiet:
        print(f"{folder.out}: {len(folder.made)} files made, {len(folder.kept)} were there; report: {folder.out / 'report.html'}",
              flush=True)
        print(f"warnings: {warnings_in(folder.out / (RESULT if events is None else FAILED))}", flush=True)
    if reason:
        folder.say(f"{folder.out / FAILED}: {reason}")
    return code
