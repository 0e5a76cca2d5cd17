#!/usr/bin/python3
"""Processor time of demsolve on a scene of the shiplock, with contact states and with linear joints, by both engines.

    timing.py PROGRAMS SCENE.toml [--zone-size M] -o OUT

writes OUT/timing.md. With creep dynamic relaxation takes some minutes.
"""

import argparse
import pathlib
import resource
import subprocess
import sys
import tempfile

from jointcreep import chain, files
from records import figure

HERE = pathlib.Path(__file__).resolve().parent


def timed(command):
    """Processor seconds of a command that must succeed."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        sys.exit(f"timing.py: {command[0]}: {done.stderr.strip()}")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def solved(programs, joints, result, *options):
    seconds = timed([programs / "demsolve", joints, "--quiet", *options, "-o", result])
    with figure.opened(result) as file:
        return seconds, len(figure.array(file, "/mesh/zone_block")), len(figure.array(file, "/equilibria/steps"))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("scene")
    parser.add_argument("--zone-size", metavar="M", help="default: the scene's")
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    programs, size = arguments.programs, ["--zone-size", arguments.zone_size] if arguments.zone_size else []
    lines = ["| joints | computed | engine | zones | equilibria | processor time (s) |", "|---|---|---|---|---|---|"]
    with tempfile.TemporaryDirectory(prefix="jointcreep-") as folder:
        folder = pathlib.Path(folder)
        for words, options in (("linear", ["--linear"]), ("slip and open", [])):
            scene, result = folder / "s.toml", folder / "r.h5"
            timed([sys.executable, HERE / "variant.py", arguments.scene, *options, "-o", scene])
            joints = chain.joints_of(programs, scene, folder)
            for computed, what in (("excavation", ["--no-creep"]), ("excavation and creep", [])):
                for engine in "implicit", "relaxation":
                    seconds, zones, equilibria = solved(programs, joints, result, *size, *what, "--engine", engine)
                    lines.append(f"| {words} | {computed} | {engine} | {zones} | {equilibria} | {seconds:.1f} |")
    path = arguments.output / "timing.md"
    files.write_text(path, "\n".join(lines) + "\n")
    print(path.read_text(), end="")


if __name__ == "__main__":
    main()
