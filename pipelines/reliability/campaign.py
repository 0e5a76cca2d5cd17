"""What the campaigns share: their command line, programs under limits, and tables of counts.

    CAMPAIGN.py PROGRAMS OUT [--n N] [--seed S]

A campaign makes N trials, chosen by the seed S; one that is interrupted counts those that it has made. It writes
OUT/CAMPAIGN.csv: a row for each subject, a column for each outcome; each minute, and at its end. A fault is printed with what it
takes to see it again, and its files are kept in OUT/faults. The exit code is 1 if there was any fault.
"""

import argparse
import collections
import concurrent.futures
import csv
import datetime
import os
import pathlib
import platform
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

from chain import Chain
from jointcreep import files

ROOT = pathlib.Path(__file__).resolve().parents[2]

LONGEST = 120  # s of the processor; a run that takes longer hangs
WAITING = 10  # times as long, for a program that waits
WRITING = 60  # s, between tables of what has been counted so far
MEMORY = pathlib.Path("/dev/shm")  # files there cost no disk
HANGS = "hangs"  # in place of an exit code


class Ended:
    """How a program ended: exit code, or minus the signal, or HANGS; and what it said."""

    def __init__(self, code, out="", err=""):
        self.code, self.out, self.err = code, out, err

    def is_refusal(self, program, codes):
        """It refused by a message that begins with its name."""
        return self.code in codes and f"{program}: " in self.err

    def __str__(self):
        return f"exit code {self.code}: {self.err.strip()[-300:] or 'nothing said'}"


def ended(command, longest, limit=None, **options):
    """Runs a command for at most this many seconds of the processor; `limit`, if any, is called in its process first."""
    with subprocess.Popen([*map(str, command)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace",
                          preexec_fn=limit, stdin=subprocess.DEVNULL, **options) as process:
        # From here: with a function to be called in the new process Python could not start it by vfork.
        resource.prlimit(process.pid, resource.RLIMIT_CPU, (longest, longest))
        try:
            out, err = process.communicate(timeout=WAITING * longest)
        except subprocess.TimeoutExpired:
            process.kill()
            return Ended(HANGS, err=f"no end within {WAITING * longest} s")
        except BaseException:
            process.kill()
            raise
    if process.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        return Ended(HANGS, err=f"no end within {longest} s of the processor")
    return Ended(process.returncode, out, err)


def chance(*trial):
    """Random numbers of a trial, the same whatever else is tried."""
    return random.Random("/".join(map(str, trial)))


def contents(folder):
    """Bytes of every file in a folder, by name."""
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir()) if path.is_file()}


def scenes(chain, *names):
    """Joints files of scenes of the project, by the name of the scene's file or folder."""
    for name in names:
        path, folder = ROOT / name, chain.new_folder()
        network = chain.run("jointgen", path, folder / "network.h5")
        yield (path.parent.name if path.stem == "scene" else path.stem), path, \
            chain.run("strength-averaging", network, folder / "joints.h5")


class Campaign:
    """A campaign's programs, folder, chance and counts. `outcomes` are the columns of its table, those in `faults` faults."""

    def __init__(self, subject, outcomes, faults, n, options=lambda parser: None):
        self.name = pathlib.Path(sys.argv[0]).stem
        parser = argparse.ArgumentParser(prog=self.name, description=sys.modules["__main__"].__doc__,
                                         formatter_class=argparse.RawDescriptionHelpFormatter)
        parser.add_argument("programs", type=pathlib.Path, help="folder of the programs")
        parser.add_argument("out", type=pathlib.Path, help="folder to write to")
        parser.add_argument("--n", type=int, default=n, help=f"number of trials (default {n})")
        parser.add_argument("--seed", type=int, default=1, help="of all chance (default 1)")
        options(parser)
        self.options = arguments = parser.parse_args()
        self.about_n = arguments.n  # how many, or how long
        self.n, self.seed, self.out = arguments.n, arguments.seed, arguments.out.resolve()
        self.programs = arguments.programs.resolve()
        self.subject, self.outcomes, self.faults = subject, outcomes, faults
        self.counts, self.lock = {}, threading.Lock()
        self.folder = tempfile.mkdtemp(prefix="jointcreep-", dir=MEMORY if os.access(MEMORY, os.W_OK) else None)
        self.chain = Chain(self.programs, ROOT, self.folder)
        self.out.mkdir(parents=True, exist_ok=True)
        self.log = (self.out / f"{self.name}.log").open("w")  # every trial
        self.begin = self.written = time.monotonic()

    def random(self, *case):
        return chance(self.name, self.seed, *case)

    def side_by_side(self, work, things):
        """Calls work(thing) for each, as many at a time as the option --jobs says; yields what it returns, in their order."""
        with concurrent.futures.ThreadPoolExecutor(self.options.jobs) as pool:
            yield from pool.map(work, things)

    def version(self):
        """Of the programs."""
        return ended([self.programs / "jointgen", "--version"], 60).out.split()[-1]

    def count(self, subject, outcome, case="", what="", files=None, times=1):
        """Counts a trial. Of a fault says which and what; `files` is a folder to be kept."""
        with self.lock:
            self.counts.setdefault(subject, collections.Counter())[outcome] += times
            print(f"{subject}\t{case}\t{outcome}\t{what.strip()}", file=self.log, flush=True)
            if outcome in self.faults:
                print(f"{subject}, trial {case} of seed {self.seed}: {outcome}: {what}", flush=True)
                if files:
                    shutil.copytree(files, self.out / "faults" / re.sub(r"\W+", "-", f"{self.name}-{subject}-{case}"),
                                    dirs_exist_ok=True, symlinks=True)
            if time.monotonic() - self.written > WRITING:
                self.write(f"{self.about_n}, not ended")

    def run(self, body):
        """Runs the campaign: calls body(self), writes the table, ends the program."""
        signal.signal(signal.SIGTERM, signal.default_int_handler)
        try:
            body(self)
        except KeyboardInterrupt:
            self.about_n = f"{self.about_n}, interrupted"
            print(f"{self.name}: interrupted; what follows was counted until then")
        finally:
            shutil.rmtree(self.folder, ignore_errors=True)
        self.write(self.about_n)
        found = sum(count[outcome] for count in self.counts.values() for outcome in self.faults)
        for subject, count in self.counts.items():
            print(f"{subject}: " + ", ".join(f"{count[outcome]} {outcome}" for outcome in self.outcomes if count[outcome]))
        print(f"{self.name}: {sum(map(sum, (count.values() for count in self.counts.values())))} counted, {found} faults")
        sys.exit(1 if found or not self.counts else 0)

    def write(self, about_n):
        about = {"n": about_n, "seed": self.seed, "seconds": round(time.monotonic() - self.begin), "version": self.version(),
                 "date": datetime.date.today().isoformat(), "machine": machine()}
        with files.replaced(self.out / f"{self.name}.csv") as partial, partial.open("w", newline="") as file:
            rows = csv.writer(file, lineterminator="\n")
            rows.writerow([self.subject, *self.outcomes, *about])
            for subject, count in self.counts.items():
                rows.writerow([subject, *(count[outcome] for outcome in self.outcomes), *about.values()])
        self.written = time.monotonic()


def machine():
    """Processor, how many of them, memory."""
    models = re.findall(r"^model name\s*: (.*)$", pathlib.Path("/proc/cpuinfo").read_text(), re.MULTILINE)
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    return f"{os.cpu_count()} x {models[0] if models else platform.machine()}, {memory:.0f} GB"
