"""Runs the programs for the tests in this folder, on scenes written as changes to a scene.

A test is started as `TEST.py PROGRAMS SOURCE`: the folder of the programs and that of the sources.
"""

import os
import pathlib
import re
import runpy
import signal
import subprocess
import sys
import tempfile
import traceback
import unittest

import h5py

LONGEST_RUN = 300  # s; a program that takes longer hangs


class Chain:
    """The programs, the sources, and a folder for the files of a test."""

    def __init__(self, programs, source, folder):
        self.programs, self.source, self.folder = (pathlib.Path(path).resolve() for path in (programs, source, folder))

    def new_folder(self):
        return pathlib.Path(tempfile.mkdtemp(dir=self.folder))

    def text(self, path):
        """The text of a file in the source folder."""
        return (self.source / path).read_text()

    def small(self):
        """The text of a scene of some 30 random blocks, which takes some hundredths of a second."""
        return self.text("pipelines/studies/small.toml")

    def bridged(self, keys, cohesion=0.1, creeps=True):
        """The scene every_key.toml, whose joints with rock bridges have that cohesion [MPa], a Kelvin unit if they creep, and
        these keys in addition."""
        kelvin = "(normal_kelvin_.*\nnormal_kelvin_.*\nshear_kelvin_.*\nshear_kelvin_.*\n)"
        return changed(self.text("tests/pipeline/every_key.toml"),
                       "^cohesion_MPa = 0.1\n(friction.*\ntensile_strength_MPa = 0\n)" + kelvin,
                       rf"cohesion_MPa = {cohesion}\n\1" + (r"\2" if creeps else "") + keys + "\n")

    def answer(self, program, *arguments):
        """What the program does, whatever its exit code."""
        command = [self.programs / program, *map(str, arguments)]
        return subprocess.run(command, capture_output=True, text=True, timeout=LONGEST_RUN, cwd=self.folder)

    def jointcreep(self, *arguments, cwd=None):
        """What jointcreep does in a copy of this process, whatever its exit code."""
        return in_a_copy(self.programs / "jointcreep", *arguments, cwd=cwd)

    def run(self, program, source, output, *arguments):
        """The output of a program that must succeed."""
        done = self.answer(program, source, "-o", output, *arguments)
        if done.returncode != 0:
            raise AssertionError(f"{program} ended with exit code {done.returncode}: {done.stderr}")
        return output

    def network(self, text, *arguments):
        """Path of the network file of a scene's text."""
        folder = self.new_folder()
        scene = folder / "scene.toml"
        scene.write_text(text)
        return self.run("jointgen", scene, folder / "network.h5", *arguments)

    def joints(self, text, *arguments):
        """Path of the joints file of a scene's text; the arguments are jointgen's."""
        network = self.network(text, *arguments)
        return self.run("strength-averaging", network, network.with_name("joints.h5"))

    def result(self, text, *arguments):
        """Path of the result file of a scene's text; the arguments are demsolve's."""
        joints = self.joints(text)
        return self.run("demsolve", joints, joints.with_name("result.h5"), *arguments)


def in_a_copy(*command, cwd=None):
    """What a Python script does that is run in a copy of this process, which has the modules that take long to load. It is ended if
    it takes too long."""
    import jointcreep.command
    import jointcreep.pictures
    import jointcreep.report  # noqa: F401

    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
        sys.stdout.flush()
        sys.stderr.flush()
        copy = os.fork()
        if copy == 0:
            code = 1
            try:
                signal.alarm(LONGEST_RUN)
                os.dup2(out.fileno(), 1)
                os.dup2(err.fileno(), 2)
                os.chdir(cwd or ".")
                sys.argv = [*map(str, command)]
                runpy.run_path(sys.argv[0], run_name="__main__")
                code = 0
            except SystemExit as end:
                if isinstance(end.code, str):
                    print(end.code, file=sys.stderr)
                code = end.code if isinstance(end.code, int) else int(end.code is not None)
            except BaseException:
                traceback.print_exc()
            finally:
                sys.stdout.flush()
                sys.stderr.flush()
                os._exit(code)
        code = os.waitstatus_to_exitcode(os.waitpid(copy, 0)[1])
        texts = []
        for file in out, err:
            file.seek(0)
            texts.append(file.read())
    return subprocess.CompletedProcess(command, code, *texts)


def changed(text, pattern, replacement, count=1):
    """The text with `pattern`, a regular expression, replaced wherever it is found: `count` times, or it fails."""
    new, found = re.subn(pattern, replacement, text, flags=re.MULTILINE)
    if found != count or new == text:
        raise AssertionError(f"{pattern!r} is found {found} times in the scene, not {count} times")
    return new


def datasets(path):
    """Every dataset of a file, by its name; text as str."""
    values = {}

    def note(name, item):
        if isinstance(item, h5py.Dataset):
            is_text = h5py.check_string_dtype(item.dtype) is not None
            values["/" + name] = item.asstr()[:] if is_text else item[:]

    with h5py.File(path) as file:
        file.visititems(note)
    return values


def alive(session):
    """Processes of a session, without those that are dead and only not yet waited for."""
    found = []
    for path in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            state, _, _, its_session = path.read_text().rpartition(")")[2].split()[:4]
        except (OSError, ValueError):  # it has ended meanwhile
            continue
        if int(its_session) == session and state not in "ZX":
            found.append(int(path.parent.name))
    return found


class ChainTest(unittest.TestCase):
    """A test of whole programs, which it finds in `chain`."""

    chain: Chain


def main():
    """Runs the tests of the script it is called from."""
    if len(sys.argv) < 3:
        sys.exit(f"usage: {sys.argv[0]} PROGRAMS SOURCE [unittest options]")
    programs, source = sys.argv[1:3]
    with tempfile.TemporaryDirectory(prefix="jointcreep-") as folder:
        ChainTest.chain = Chain(programs, source, folder)
        unittest.main(module="__main__", argv=[sys.argv[0], *sys.argv[3:]])
