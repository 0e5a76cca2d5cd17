"""Makes the runs of a study, group by group, by processes of this machine or by Snakemake wherever its profile says.

The folder is locked while a study works there; the lock is held by all processes that work for it, so that it ends with the
last of them. Whatever has ended stays, and the same command continues from there.
"""

import contextlib
import dataclasses
import fcntl
import itertools
import math
import multiprocessing.connection
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import textwrap
import threading
import time

import numpy as np

from . import files, group, plan, study_file
from .errors import NotDone, NotWanted

PATIENCE = 5  # s to wait for processes of a study that was killed
LOOKS = 0.5  # s between two looks at how far the runs are
SPOKEN = 10  # lines of progress where there is no terminal, or
SILENT = 60  # s, after which there is one in any case
LONG = 10  # s from which something is said of runs that have not ended
CLOCKS = 1  # s by which the clocks of files and of this machine may differ
TIMED_OUT = "timed out"
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}  # for each program
STOPS = {signal.SIGINT, signal.SIGTERM, signal.SIGHUP}
FORKS = multiprocessing.get_context("fork")

SNAKEFILE = """# The groups of runs of a study; jointcreep study calls it. A job is a group.
GROUPS = {groups}

localrules: all

rule all:
    input: expand("groups/{{group}}.rows", group=GROUPS)

rule group:
    output: "groups/{{group}}.rows"
    retries: 1
    shell: 'exec "$JOINTCREEP_PYTHON" -m jointcreep.group {{wildcards.group}}'
"""


class Stopped(KeyboardInterrupt):
    """A signal that stops the study: its exit code, and what is to be said of it."""

    def __init__(self, code, what=""):
        super().__init__()
        self.code, self.what = code, what


def exit_code_of(interrupt):
    """The exit code after a KeyboardInterrupt: 128 and the number of the signal."""
    return interrupt.code if isinstance(interrupt, Stopped) else 128 + signal.SIGINT


def raise_stopped(number, _):
    raise Stopped(128 + number)


@contextlib.contextmanager
def handled(numbers, handler):
    """Signals of these numbers call the handler. Those that are ignored (nohup) stay so. In a thread of another program there is
    nothing to do: signals are for its first one."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.signal(number, handler) for number in numbers if signal.getsignal(number) is not signal.SIG_IGN}
    try:
        yield
    finally:
        for number, earlier in before.items():
            signal.signal(number, earlier)


def stoppable(stop=raise_stopped):
    """SIGTERM and SIGHUP stop a study as Ctrl-C does, or call `stop`."""
    return handled((signal.SIGTERM, signal.SIGHUP), stop)


@contextlib.contextmanager
def unstopped():
    """Signals that stop a study wait until the end of this, which takes some moments only."""
    came = []
    with handled(STOPS, lambda number, _: came.append(number)):
        yield
    if came:
        signal.raise_signal(came[0])


@contextlib.contextmanager
def locked(out, kind="study"):
    """Holds the lock of the folder of a "study" or a "run"; yields its file, which processes inherit. A folder that has something and
    no such file is of someone else. The file, and a folder that is new, go again if the input is refused before anything else is
    written."""
    path, is_new = out / f"{kind}.lock", not out.exists()
    out.mkdir(parents=True, exist_ok=True)
    if any(out.iterdir()) and not path.exists():
        raise NotWanted(f"{out}: has files, and is not the folder of a {kind}; expected a new or empty folder")
    with open(path, "a") as file:
        end = time.monotonic() + PATIENCE
        while True:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            except BlockingIOError:
                if time.monotonic() > end:
                    raise NotWanted(f"another {kind} works in {out}; wait until it has ended, or choose another folder") from None
                time.sleep(0.1)
        os.set_inheritable(file.fileno(), True)
        try:
            yield file
        except NotWanted:
            if list(out.iterdir()) == [path]:
                path.unlink()
                if is_new:
                    out.rmdir()
            raise


def read_rows(out):
    """Lines of results by the number of their run, without one that is cut off."""
    rows = {}
    for path in sorted((out / "groups").glob("*.rows*")):
        if not path.is_file():
            raise plan.damaged(path)
        with open(path, "rb") as file:
            for line in file:
                if line.endswith(b"\n"):
                    row = plan.row_of(line, path)
                    rows[row["run"]] = row
    return rows


def count_ended(out, names, size, in_groups):
    """How many runs of these groups have ended, or how many groups. A group has `size` runs at most."""
    files = {entry.name for entry in os.scandir(out / "groups")}
    groups = sum(f"{name}.rows" in files for name in names)
    if in_groups:
        return groups
    count = groups * size
    for name in names:
        if f"{name}.rows.part" in files:
            with contextlib.suppress(OSError):
                count += (out / "groups" / f"{name}.rows.part").read_bytes().count(b"\n")
    return count


class Ended:
    """How long the runs took that have ended, of a study's folder; what is new in the groups' files is read at each look."""

    def __init__(self, out):
        self.folder, self.read_to, self.seconds, self.complete = out / "groups", {}, {}, set()

    def look(self, names):
        """Seconds of the runs that have ended."""
        for name in names:
            if name in self.complete:
                continue
            for path in (self.folder / f"{name}.rows", self.folder / f"{name}.rows.part"):  # the same file, before and after
                with contextlib.suppress(OSError), open(path, "rb") as file:
                    file.seek(self.read_to.get(name, 0))
                    new = file.read()
                    whole = new[:new.rfind(b"\n") + 1]
                    for row in (plan.row_of(line, path) for line in whole.splitlines()):
                        if "seconds" in row:
                            self.seconds[row["run"]] = row["seconds"]
                    self.read_to[name] = self.read_to.get(name, 0) + len(whole)
                    if path.suffix == ".rows":
                        self.complete.add(name)
                    break
        return list(self.seconds.values())


@dataclasses.dataclass
class Present:
    """The runs that are made at present."""
    ages: list = dataclasses.field(default_factory=list)  # time so far of each [s], the longest first
    bracket: str = ""  # what its search knows of the factor of safety; "" without one

    def __str__(self):
        """ "; 2 runs at present, the longest for 35 min, factor of safety at least 1, below 1.5"; "" where no run takes long."""
        if not self.ages or self.ages[0] < LONG:
            return ""
        runs = "1 run at present, for" if len(self.ages) == 1 else f"{len(self.ages)} runs at present, the longest for"
        return f"; {runs} {duration(self.ages[0])}" + f", factor of safety {self.bracket}" * bool(self.bracket)


def present_runs(out, since):
    """The Present of a study's folder: runs that were begun after `since` [s, as time.time()]; folders of earlier ones were left by a study
    that was killed."""
    begun = []
    for path in (out / "work").glob(f"*{group.BEGUN}"):
        with contextlib.suppress(OSError):
            begun.append((path.stat().st_mtime, path.with_suffix("") / group.SAID))
    begun = sorted(one for one in begun if one[0] >= since)
    if not begun:
        return Present()
    said = ""
    with contextlib.suppress(OSError):
        said = begun[0][1].read_text("utf-8", errors="replace")
    found = re.findall(r"^demsolve: run \d+, strengths .*?; factor of safety ([^;\n]+)", said, re.MULTILINE)
    return Present([time.time() - one for one, _ in begun], found[-1] if found else "")


class Progress:
    """Tells how many runs have ended and how long the rest takes; on a terminal in one line that changes. A run at present takes as long as
    the mean of the ended runs that took longer than it has so far, or twice its time so far if none did. Runs that are not begun yet take the
    mean of all these. Where times of runs are not known, the time left is by the pace of the last half of what has ended. No time left ends
    after the deadline [s, as time.monotonic()]."""

    def __init__(self, total, what, quiet, at_once=1, deadline=math.inf):
        self.total, self.what, self.quiet, self.at_once, self.deadline = total, what, quiet, at_once, deadline
        self.ended, self.told = [], 0  # time and number of runs, at each change
        self.seconds, self.present = [], Present()  # of each run that has ended; runs at present
        self.spoke = time.monotonic()

    def seconds_left(self):
        """None as long as no run has ended."""
        left = self.seconds_of_work()
        return None if left is None else min(left, max(0, self.deadline - time.monotonic()))

    def seconds_of_work(self):
        """The same, without the deadline."""
        (_, first), (_, done) = self.ended[0], self.ended[-1]
        left = self.total - done
        if len(self.seconds) and left > 0:
            took, ages = np.array(self.seconds), np.array(self.present.ages[:left])
            longer = [took[took > age] for age in ages]
            whole = np.array([one.mean() if len(one) else 2 * age for one, age in zip(longer, ages)])
            each, rest, waiting = np.append(took, whole).mean(), whole - ages, left - len(ages)
            return max([*rest, *[each] * (waiting > 0), (rest.sum() + waiting * each) / self.at_once])
        since, before = [one for one in self.ended if one[1] <= (first + done) / 2][-1]
        return (time.monotonic() - since) / (done - before) * left if done > first else None

    def tell(self, done, seconds=(), present=Present()):
        """done: how many have ended; seconds: as Ended.look() has them; present: the runs that are made."""
        self.seconds, self.present = seconds, present
        if not self.ended:
            self.told = done
        if not self.ended or done != self.ended[-1][1]:
            self.ended.append((time.monotonic(), done))
        if self.quiet:
            return
        left = self.seconds_left()
        line = f"{done} of {self.total} {self.what}" + (f", {duration(left)} left" if left is not None and done < self.total else "")
        line += str(present) if done < self.total else ""
        with contextlib.suppress(OSError):  # of a stderr that nobody reads any more
            if sys.stderr.isatty():
                width = shutil.get_terminal_size().columns - 1
                print(f"\r{textwrap.shorten(line, width, placeholder=' ...'):{width}}", end="" if done < self.total else "\n", file=sys.stderr,
                      flush=True)
            elif (done - self.told) * SPOKEN >= self.total or done == self.total > self.told or time.monotonic() - self.spoke > SILENT:
                self.told, self.spoke = done, time.monotonic()
                print(line, file=sys.stderr, flush=True)


def duration(seconds):
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 90 * 60 else f"{seconds / 3600:.1f} h"


def work(name, out, programs, parent):
    """In a new process: makes a group. Ctrl-C ends the study, and that ends this process without words of its own."""
    group.die_with(parent)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for number in STOPS - {signal.SIGINT}:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, STOPS)
    os.environ.update(ONE_THREAD)
    sys.exit(group.exit_code(name, out, programs))


def start(running, name, out, programs):
    """Starts a process that makes a group, and adds it to `running`. Returns whether the system had a process to give."""
    process = FORKS.Process(target=work, args=(name, out, programs, os.getpid()))
    signal.pthread_sigmask(signal.SIG_BLOCK, STOPS)  # until the process ignores them, and is known here
    try:
        process.start()
        running[process] = name
    except OSError as error:
        print(f"jointcreep: no process for a group of runs: {error.strerror}", file=sys.stderr, flush=True)
    finally:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, STOPS)
    return process in running


def by_processes(out, programs, names, jobs):
    """Makes groups, `jobs` of them at a time, or as many as the system has processes for. A generator: it returns to its caller every LOOKS
    seconds and after each group. Processes are forks of this one: they have all modules, which take longer to load than a run of a
    small scene."""
    waiting, running = list(reversed(names)), {}
    try:
        while waiting or running:
            while waiting and len(running) < jobs:
                if start(running, waiting[-1], out, programs):
                    waiting.pop()
                else:
                    jobs = len(running)
            if not running:
                return
            multiprocessing.connection.wait([process.sentinel for process in running], LOOKS)
            for process in [process for process in running if not process.is_alive()]:
                name = running.pop(process)
                if process.exitcode < 0:
                    print(f"jointcreep: group {name} was stopped (signal {-process.exitcode})", file=sys.stderr, flush=True)
            yield
    finally:
        for process in running:
            process.kill()
        for process in running:
            process.join()


def by_snakemake(out, programs, names, jobs, profile, lock):
    """Makes groups by Snakemake, whose processes hold the lock, too. A generator: it returns to its caller every LOOKS seconds."""
    files.write_text(out / "Snakefile", SNAKEFILE.format(groups=names))
    command = ["snakemake", "--snakefile", "Snakefile", "--profile", profile, "--keep-going", "--nolock", "--rerun-incomplete",
               "--rerun-triggers", "mtime", "--quiet", "--jobs", str(jobs)]
    package, parent = pathlib.Path(__file__).resolve().parent.parent, os.getpid()
    paths = [str(package), *filter(None, [os.environ.get("PYTHONPATH")])]
    environment = {**os.environ, **ONE_THREAD, "PYTHONPATH": os.pathsep.join(paths), "PYTHONDONTWRITEBYTECODE": "1",
                   "JOINTCREEP_PYTHON": sys.executable, "JOINTCREEP_PROGRAMS": str(programs)}
    try:
        # In a process group of its own it could outlive Ctrl-C; so it is in this one, and dies with this process.
        running = subprocess.Popen(command, cwd=out, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                   pass_fds=[lock.fileno()], preexec_fn=lambda: group.die_with(parent))
    except FileNotFoundError:
        raise NotWanted(f"{command[0]} is not installed; first run: sh pipelines/setup.sh studies") from None
    try:
        while running.poll() is None:
            yield
            with contextlib.suppress(subprocess.TimeoutExpired):
                running.wait(LOOKS)
    finally:
        running.send_signal(signal.SIGTERM)
        running.wait()


def make_groups(out, programs, names, jobs, profile, lock, deadline, tell):
    """Makes what is missing of these groups. Returns TIMED_OUT if the deadline came first."""
    missing = [name for name in names if not (out / "groups" / f"{name}.rows").exists()]
    if not missing:
        return ""
    working = by_snakemake(out, programs, missing, jobs, profile, lock) if profile else by_processes(out, programs, missing, jobs)

    def look():
        (out / "groups").mkdir(exist_ok=True)  # Snakemake removes an empty folder of a job that failed
        tell()

    with contextlib.closing(working):
        for _ in working:
            look()
            if time.monotonic() > deadline:
                return TIMED_OUT
    look()
    missing = [name for name in names if not (out / "groups" / f"{name}.rows").exists()]
    if missing:
        raise NotDone(f"{len(missing)} of {len(names)} groups of runs in {out / 'groups'} could not be made; messages above say "
                      "why. The same command makes those that are missing")
    return ""


def make(study, out, programs, jobs, profile, quiet, enough, lock):
    """Makes the runs of a study until `enough(rows)` says that they are, at the end of a batch. Returns the lines of results
    in the order of runs, from the first on without a gap, and why it ended: "" with all runs, else a few words. The folder is locked
    by `lock`, whose file all processes inherit."""
    (out / "groups").mkdir(exist_ok=True)
    size = plan.planned(out)[3]["group"]
    total = study.design.runs
    deadline = time.monotonic() + 3600 * study.stop.hours
    in_groups = study.design.directions > 0
    progress = Progress(total, "replicates" if in_groups else "runs", quiet, jobs, deadline)
    durations, begin = Ended(out), time.time() - CLOCKS
    batch = plan.BATCH if study.stop.of else total
    for end in [*range(batch, total, batch), total]:
        before = end - batch if end < total else 0
        names = plan.groups_of(before, end, size)
        ended = make_groups(out, programs, names, jobs, profile, lock, deadline,
                            lambda before=before, names=names, end=end: progress.tell(
                                min(end, before + count_ended(out, names, size, in_groups)),
                                [] if in_groups else durations.look(names), present_runs(out, begin)))
        rows = read_rows(out)
        if in_groups:
            prefix = [rows[run] for run in sorted(rows)]
        else:
            prefix = list(itertools.takewhile(lambda row: row is not None, (rows.get(run) for run in range(end))))
        if ended:
            return prefix, f"after the {study.stop.hours:g} hours of the budget"
        if not in_groups and len(prefix) < end:
            name = plan.group_name(len(prefix) // size)
            raise NotDone(f"{out / 'groups' / name}.rows lacks run {len(prefix)}: remove this file; the same command makes it again")
        if study.stop.of and enough(prefix):
            return prefix, study_file.BY_STOP_RULE
    return prefix, ""
