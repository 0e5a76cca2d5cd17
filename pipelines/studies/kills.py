#!/usr/bin/python3
"""A study killed at random moments by SIGKILL, and gone on each time by the same command: are its results the same bytes?

    kills.py PROGRAMS OUT [--runs 1000] [--kills 3] [--jobs 1] [--seed 1] [--quick]

The undisturbed study is made first. A kill comes up to a second after so many runs have ended as is drawn; every second kill is of the
command alone, the others of all its processes. The exit code is 1 if anything differs.
"""

import contextlib
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import time

import slope


def ended(folder):
    """How many runs of a study have ended."""
    count = 0
    for path in (folder / "groups").glob("*.rows*"):
        with contextlib.suppress(FileNotFoundError):  # it has another name meanwhile
            count += path.read_bytes().count(b"\n")
    return count


def main():
    def more(parser):
        parser.add_argument("--kills", type=int, default=3)
        parser.add_argument("--jobs", type=int, default=1)
        parser.add_argument("--seed", type=int, default=1)

    arguments = slope.options(__doc__, more)
    file, whole = slope.written(arguments, "undisturbed")
    begin = time.monotonic()
    slope.made(arguments, file, whole, arguments.jobs)
    seconds = time.monotonic() - begin
    print(f"undisturbed: {arguments.runs} runs in {seconds:.0f} s", flush=True)

    killed = pathlib.Path(arguments.out) / "killed"
    shutil.rmtree(killed, ignore_errors=True)
    chance = random.Random(arguments.seed)
    moments = sorted(chance.randrange(arguments.runs * 9 // 10) for _ in range(arguments.kills))
    for number, wanted in enumerate(moments, 1):
        running = subprocess.Popen(slope.command(arguments, file, killed, arguments.jobs), start_new_session=True)
        while ended(killed) < wanted and running.poll() is None:
            time.sleep(0.05)
        time.sleep(chance.random())
        if running.poll() is not None:
            sys.exit(f"kill {number}: the study has ended before")
        if number % 2:
            os.kill(running.pid, signal.SIGKILL)
        else:
            os.killpg(running.pid, signal.SIGKILL)
        running.wait()
        print(f"kill {number}: {ended(killed)} runs have ended", flush=True)
    slope.made(arguments, file, killed, arguments.jobs)
    different = slope.differing(whole, killed)
    print(f"{arguments.kills} kills: " + (f"DIFFERENT: {', '.join(different)}" if different else "the same bytes"))
    sys.exit(1 if different else 0)


if __name__ == "__main__":
    main()
