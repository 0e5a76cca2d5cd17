"""Programs of the chain, called by scripts: scene, network, joints, result."""

import pathlib
import signal
import subprocess

CANNOT_WRITE = 4  # exit code: a file could not be read or written
FAILED_INSIDE = 5  # exit code: internal error, or out of memory
STOPPING = {signal.SIGHUP, signal.SIGINT, signal.SIGKILL, signal.SIGTERM}  # sent by users and systems


class Failed(Exception):
    """A program gave no result."""


def was_stopped(code):
    """Whether an exit code is no answer: a file could not be written, or the program was stopped from outside. A signal is negative
    (subprocess), or has 128 added (shells)."""
    return code == CANNOT_WRITE or -code in STOPPING or code - 128 in STOPPING


def without(words, names):
    """Options without those that have these names, each with a value; and these."""
    left, taken, rest = [], [], list(words)
    while rest:
        word = rest.pop(0)
        if word in names and rest:
            taken += [word, rest.pop(0)]
        else:
            (taken if word.partition("=")[0] in names else left).append(word)
    return left, taken


def run(program, *arguments):
    """What a program writes to stdout. Raises Failed with its message; ends this script where it was stopped, which is no result."""
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True)
    words = f"{pathlib.Path(program).name}, exit code {done.returncode}: {done.stderr.strip()}"
    if was_stopped(done.returncode):
        raise SystemExit(f"{words}; it was stopped; the same command runs it again")
    if done.returncode != 0:
        raise Failed(words)
    return done.stdout


def joints_of(programs, scene, folder, *options):
    """Path of the joints file of a scene, made in a folder as joints.h5 beside network.h5.

    programs: their folder. scene: the path of a file, or the text of a scene as str, which is written to scene.toml. options:
    jointgen's. Raises Failed.
    """
    programs, folder = pathlib.Path(programs), pathlib.Path(folder)
    if isinstance(scene, str):
        (folder / "scene.toml").write_text(scene, encoding="utf-8")
        scene = folder / "scene.toml"
    run(programs / "jointgen", scene, *options, "--quiet", "-o", folder / "network.h5")
    run(programs / "strength-averaging", folder / "network.h5", "--quiet", "-o", folder / "joints.h5")
    return folder / "joints.h5"
