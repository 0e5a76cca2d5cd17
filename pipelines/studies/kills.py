#!/usr/bin/python3
"""A study killed at random moments by SIGKILL, and gone on each time by the same command: are its results the same bytes?

    kills.py PROGRAMS OUT [--runs 1000] [--kills 3] [--jobs 1] [--seed 1] [--quick]

The undisturbed study is made first. Moments are drawn over its time; every second kill is of the command alone,
the others of all its processes. The exit code is 1 if anything differs.
"""

import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import time

import slope


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
    chance, count = random.Random(arguments.seed), 0
    while count < arguments.kills:
        running = subprocess.Popen(slope.command(arguments, file, killed, arguments.jobs), start_new_session=True)
        try:
            running.wait(chance.uniform(0, seconds / (arguments.kills + 1)))
            break  # it has ended before
        except subprocess.TimeoutExpired:
            count += 1
        if count % 2:
            os.kill(running.pid, signal.SIGKILL)
        else:
            os.killpg(running.pid, signal.SIGKILL)
        running.wait()
        ended = sum(path.read_bytes().count(b"\n") for path in (killed / "groups").glob("*.rows*"))
        print(f"kill {count}: {ended} runs have ended", flush=True)
    slope.made(arguments, file, killed, arguments.jobs)
    different = slope.differing(whole, killed)
    print(f"{count} kills: " + (f"DIFFERENT: {', '.join(different)}" if different else "the same bytes"))
    sys.exit(1 if different else 0)


if __name__ == "__main__":
    main()
