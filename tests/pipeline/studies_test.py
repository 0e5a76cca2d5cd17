"""jointcreep study: designs, runs that are interrupted or fail, tables and answers.

Runs are of a small scene, and take some hundredths of a second. What needs OpenTURNS is skipped where
it is not installed.
"""

import base64
import contextlib
import csv
import ctypes
import html
import importlib.util
import io
import os
import pathlib
import random
import re
import shlex
import shutil
import signal
import subprocess
import time
import tomllib
import types
import unittest
import unittest.mock
import warnings

import h5py
import numpy as np

from chain import LONGEST_RUN, ChainTest, alive, datasets, in_a_copy, main

import jointcreep
from jointcreep import answers, failure, intervals, materials, pictures, plan, plots, report, runs, scene_keys, study_file
from jointcreep import command as command_line
from jointcreep import design as draw_design
from jointcreep.errors import NotWanted

SCENE = (pathlib.Path(__file__).resolve().parents[2] / "pipelines/studies/small.toml").read_text()
HAS_OPENTURNS = importlib.util.find_spec("openturns") is not None
needs_openturns = unittest.skipUnless(HAS_OPENTURNS, "python3-openturns is not installed: sh pipelines/setup.sh studies")

NETWORKS = """
scene = "scene.toml"

[[vary]]
network = true

[design]
runs = {runs}

[[collect]]
what = "displacement"
point = "floor"
component = "y"
above = [0.1]

[[collect]]
name = "of the point dug away"
what = "displacement"
point = "dug away"
component = "x"

[[collect]]
name = "after the bench"
what = "displacement"
point = "floor"
component = "y"
stage = "bench"

[[collect]]
what = "blocks"
statistic = "number"

[[collect]]
what = "failed"
"""

FRICTION = """
[[vary]]
name = "friction"
key = "joint_material.joint.friction_angle_deg"
law = "normal"
mean = 35
deviation = 3
"""

WRAPPER = """#!/bin/sh
echo "$*" >>"{calls}"
{case}
exec "{program}" "$@"
"""
RESULTS = ["runs.csv", "runs.h5", "answers.csv", "convergence.csv", "shares.csv", "summary.txt"]


class Studies(ChainTest):
    """Tools to make studies of the small scene."""

    def setUp(self):
        self.folder = self.chain.new_folder()
        (self.folder / "scene.toml").write_text(SCENE)

    def written(self, text, name="study.toml"):
        (self.folder / name).write_text(text)
        return self.folder / name

    def command(self, study, out, *more, programs=None):
        return [self.chain.programs / "jointcreep", "study", study, "-o", out, "--programs", programs or self.chain.programs, *more]

    def study(self, study, out, *more, programs=None):
        return in_a_copy(*self.command(study, out, *more, programs=programs))

    def made(self, study, out, *more, programs=None):
        done = self.study(study, out, *more, programs=programs)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return out

    def refused(self, text, expected):
        done = self.study(self.written(text), self.folder / "refused")
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        self.assertRegex(done.stderr, expected)
        self.assertNotIn("Traceback", done.stderr)

    def programs(self, case, program="demsolve"):
        """A folder of programs of which one is a script that notes its call, does `case`, and then hands on."""
        folder = self.chain.new_folder()
        for name in ("jointgen", "strength-averaging", "demsolve"):
            (folder / name).symlink_to(self.chain.programs / name)
        (folder / program).unlink()
        (folder / program).write_text(WRAPPER.format(calls=folder / "calls", case=case.format(folder=folder),
                                                     program=self.chain.programs / program))
        (folder / program).chmod(0o755)
        return folder

    def assert_same(self, one, other):
        for name in RESULTS:
            self.assertEqual((one / name).read_bytes(), (other / name).read_bytes(), name)

    def assert_early(self, out, summary, runs_planned, why):
        """What a study says and keeps that ended before all its runs."""
        values = [float(row["floor y (mm)"]) for row in rows_of(out)]
        self.assertIn(f"\nruns                 {len(values)} of {runs_planned}, ended {why}\n", summary)
        self.assertIn(f"\nwarning: the answers are of {len(values)} of {runs_planned} runs. ", summary)
        self.assertEqual((out / "summary.txt").read_text(), summary)
        with open(out / "answers.csv", encoding="utf-8") as file:
            row = next(row for row in csv.DictReader(file) if (row["quantity"], row["statistic"]) == ("floor y", "mean"))
        self.assertEqual(row["runs"], str(len(values)))
        self.assertEqual([float(row[name]) for name in ("value", "low", "high")], list(intervals.mean(values)[:3]))


def left_by_failure(path, moves_on, block=(), stage="bench"):
    """Writes what a study reads of the file that demsolve leaves of a run without equilibrium on day 2. Blocks have 0.5, 1.5, 2.5 ... m2."""
    with h5py.File(path, "w") as file:
        for name, value in (("moves_on", [moves_on]), ("stage", [stage.encode()]), ("time", [2.0]), ("block", np.array(block, int))):
            file[f"/failure/{name}"] = value
        file["/blocks/area"] = 0.5 + np.arange(9)


def rows_of(out):
    with open(out / "runs.csv", encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


class Runs(Studies):
    def test_values_are_those_of_the_files(self):
        out = self.made(self.written(NETWORKS.format(runs=3)), self.folder / "out")
        rows = rows_of(out)
        self.assertEqual([row["run"] for row in rows], ["0", "1", "2"])
        for row in rows:
            network = self.chain.network(SCENE, "--realization", row["network"])
            joints = self.chain.run("strength-averaging", network, network.with_name("j.h5"))
            result = datasets(self.chain.run("demsolve", joints, network.with_name("r.h5")))
            floor = 1e3 * result["/history/displacement"][:, 2, 1]
            self.assertEqual(float(row["floor y (mm)"]), floor[-1])
            self.assertEqual(float(row["after the bench (mm)"]), floor[list(result["/history/event"]).index("bench")])
            self.assertEqual(float(row["blocks, number"]), len(result["/blocks/area"]))
            self.assertEqual(row["of the point dug away (mm)"], "")
            self.assertEqual((row["exit code"], row["failed"]), ("0", "0.0"))
        self.assertIn('an excavation takes the point "dug away" before, or it is not read yet, in 3 of 3 runs: 0, 1, 2',
                      (out / "summary.txt").read_text())
        with h5py.File(out / "runs.h5") as file:
            table = file["runs"][()]
            self.assertEqual(list(table["floor y (mm)"]), [float(row["floor y (mm)"]) for row in rows])
            self.assertEqual(list(table["of the point dug away (mm), is there"]), [0, 0, 0])
            self.assertEqual(file["scene"].asstr()[0], SCENE)
        self.assertFalse(list((out / "work").iterdir()))

    def test_relative_to_another_point(self):
        """Points of a monitoring line less another point, from the in-situ state or the first reading of the first."""
        text = SCENE + '[[monitoring_line]]\nname = "E"\nfrom_m = [24, 10]\nto_m = [24, 2]\npoints = 3\n'
        (self.folder / "scene.toml").write_text(text)
        collect = '[[collect]]\nname = "{0}"\nwhat = "displacement"\npoint = "floor"\nrelative_to = "E 3"\ncomponent = "{0}"\n{1}\n'
        study = NETWORKS.split("[[collect]]")[0].format(runs=2) + collect.format("y", "") + collect.format(
            "length", 'since = "first reading"')
        for row in rows_of(self.made(self.written(study), self.folder / "out")):
            joints = self.chain.joints(text, "--realization", row["network"])
            result = datasets(self.chain.run("demsolve", joints, joints.with_name("r.h5")))
            names = list(result["/history/point"])
            moves = 1e3 * result["/history/displacement"]
            between = moves[:, names.index("floor")] - moves[:, names.index("E 3")]
            first = result["/history/first_reading_row"][names.index("floor")]
            self.assertAlmostEqual(float(row["y (mm)"]), between[-1, 1], delta=1e-12)
            self.assertAlmostEqual(float(row["length (mm)"]), np.hypot(*(between[-1] - between[first])), delta=1e-12)
        self.refused(study.replace('"E 3"', '"E 4"'), r'relative_to is "E 4"; expected one that the scene has: .*floor, E 1, E 2, E 3')
        self.refused(study.replace('"E 3"', '"floor"'), 'relative_to is "floor"; expected another point')

    def test_on_a_day_between_steps(self):
        """Runs whose creep steps are chosen have rows on other days; values are of the same day all the same."""
        text = SCENE.replace('step_days = 2\nscheme = "published"', "tolerance_m = 1e-8")
        (self.folder / "scene.toml").write_text(text)
        day = NETWORKS.split("[[collect]]")[0].format(runs=3) + (
            '[[collect]]\nname = "day 7"\nwhat = "displacement"\npoint = "floor"\ncomponent = "y"\ndate = 7.3\n')
        rows = rows_of(self.made(self.written(day), self.folder / "out"))
        days = set()
        for row in rows:
            joints = self.chain.joints(text, "--realization", row["network"])
            one, fine = (datasets(self.chain.run("demsolve", joints, joints.with_name(f"{name}.h5"), *options))
                         for name, options in (("one", []), ("fine", ["--creep-step", "0.1", "--creep-scheme", "fitted"])))
            days.add(tuple(one["/history/time"]))
            moves = fine["/history/displacement"][:, 2, 1]
            wanted = 1e3 * moves[np.argmin(np.abs(fine["/history/time"] - 7.3))]
            crept = 1e3 * abs(moves[-1] - moves[2])
            self.assertLess(abs(float(row["day 7 (mm)"]) - wanted), 0.02 * crept + 1e-3)
        self.assertGreater(len(days), 1)

    def test_one_at_a_time_or_two(self):
        study = self.written(NETWORKS.format(runs=8))
        one = self.made(study, self.folder / "one out", "-j", "1")
        two = self.made(study, self.folder / 'two "out"', "-j2")
        self.assert_same(one, two)

    def test_more_runs_keep_those_that_are_there(self):
        programs = self.programs("")
        out = self.made(self.written(NETWORKS.format(runs=3)), self.folder / "out", programs=programs)
        self.made(self.written(NETWORKS.format(runs=6)), out, programs=programs)
        self.assertEqual((programs / "calls").read_text().count("joints.h5"), 6)
        self.assert_same(self.made(self.folder / "study.toml", self.folder / "at once", programs=programs), out)
        done = self.study(self.written(NETWORKS.format(runs=5)), out, programs=programs)
        self.assertEqual(done.returncode, 2)
        self.assertIn("has 6 runs planned", done.stderr)

    def test_killed_and_gone_on(self):
        """By SIGKILL at random moments, of the command alone or of all its processes; and by Ctrl-C."""
        study = self.written(NETWORKS.format(runs=8))
        whole = self.made(study, self.folder / "whole")
        out, chance = self.folder / "out", random.Random(1)
        kills = 0
        for stop in ("alone", "all", "alone", "interrupt", "all", "alone"):
            running = subprocess.Popen([*map(str, self.command(study, out, "-j2"))], stdout=subprocess.DEVNULL,
                                       stderr=subprocess.DEVNULL, start_new_session=True)
            try:
                running.wait(chance.uniform(0.2, 0.7))
            except subprocess.TimeoutExpired:
                kills += 1
                if stop == "alone":
                    os.kill(running.pid, signal.SIGKILL)
                else:
                    os.killpg(running.pid, signal.SIGKILL if stop == "all" else signal.SIGINT)
            running.wait()
            end = time.monotonic() + 10
            while alive(running.pid):
                self.assertLess(time.monotonic(), end, "something works on after the study was stopped")
                time.sleep(0.01)
        self.assertGreater(kills, 2)
        self.assert_same(whole, self.made(study, out, "-j2"))

    def test_stopped(self):
        """Ctrl-C or SIGTERM: the tables and answers have the runs that have ended, and the message has the command that continues."""
        study = self.written(NETWORKS.format(runs=6))
        with open(self.made(study, self.folder / "whole") / "runs.csv", encoding="utf-8") as file:
            whole = list(csv.reader(file))
        for number in signal.SIGINT, signal.SIGTERM:
            out = self.folder / f"out {number}"
            programs = self.programs(f'[ "$1" = --version ] || [ "$(grep -c joints.h5 "{{folder}}/calls")" -lt 5 ] || '
                                     f'[ -e "{{folder}}/go" ] || {{{{ touch "{{folder}}/hangs"; exec sleep {LONGEST_RUN}; }}}}')
            command = [*map(str, self.command(study, out, "-j2", programs=programs))]
            running = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True)
            end = time.monotonic() + LONGEST_RUN
            while not (programs / "hangs").exists():
                self.assertLess(time.monotonic(), end)
                time.sleep(0.01)
            os.kill(running.pid, number)
            summary, said = running.communicate(timeout=LONGEST_RUN)
            self.assertEqual(running.returncode, 128 + number, said)
            self.assert_early(out, summary, 6, "by a signal")
            with open(out / "runs.csv", encoding="utf-8") as file:
                rows = list(csv.reader(file))
            self.assertGreaterEqual(len(rows), 4)
            self.assertEqual(rows[0], whole[0])
            self.assertLess(len(rows), len(whole))
            for row in rows[1:]:
                self.assertIn(row, whole)
            self.assertIn(f"{len(rows) - 1} of 6 runs have ended; their results are in {out / 'runs.csv'}, the answers of these runs in "
                          f"{out / 'summary.txt'}\n", said)
            continues = said.splitlines()[-1].removeprefix("jointcreep: to continue: ")
            self.assertEqual(shlex.split(continues), ["jointcreep", *command[1:]])
            refused = self.chain.jointcreep("report", out, "-o", self.folder / "r.html")
            self.assertEqual(refused.returncode, 2)
            self.assertIn("--finish", refused.stderr)
            if number == signal.SIGINT:
                self.check_finished(command, out, rows, summary)
            (programs / "go").touch()
            subprocess.run(command, check=True, timeout=LONGEST_RUN, stdout=subprocess.DEVNULL)
            self.assert_same(self.folder / "whole", out)

    def check_finished(self, command, out, rows, summary):
        """--finish makes no run, keeps the tables, and makes pictures for a report."""
        done = subprocess.run([*command, "--finish"], check=True, timeout=LONGEST_RUN, capture_output=True, text=True)
        self.assertEqual((done.stdout, done.stderr), (summary.replace("ended by a signal", "ended by --finish"), ""))
        with open(out / "runs.csv", encoding="utf-8") as file:
            self.assertEqual(list(csv.reader(file)), rows)
        self.assertEqual(self.chain.jointcreep("report", out, "-o", self.folder / "r.html").returncode, 0)
        self.assertIn(f"warning: the answers are of {len(rows) - 1} of 6 runs", (self.folder / "r.html").read_text())

    def test_stopped_after_the_last_run(self):
        """Tables and answers are there; the same command draws the pictures."""
        study, out = self.written(NETWORKS.format(runs=3)), self.folder / "out"
        words = ["study", str(study), "-o", str(out), "-q"]
        write, is_stopped = command_line.write_answers, []

        def write_and_stop(*arguments):
            if not is_stopped:
                is_stopped.append(signal.raise_signal(signal.SIGTERM))
            return write(*arguments)

        said = io.StringIO()
        with unittest.mock.patch.object(command_line, "write_answers", write_and_stop), contextlib.redirect_stderr(said):
            self.assertEqual(command_line.main(words, "0.1.0", self.chain.programs), 128 + signal.SIGTERM)
        self.assertIn(f"interrupted: all answers are in {out / 'summary.txt'}; the same command draws the pictures\n", said.getvalue())
        self.assertIn("runs                 3\n", (out / "summary.txt").read_text())
        self.assertEqual((len(rows_of(out)), list(out.glob("*.png")), (out / "pictures.json").exists()), (3, [], False))
        self.assertEqual(command_line.main(words, "0.1.0", self.chain.programs), 0)
        self.assertTrue((out / "pictures.json").exists())

    def test_stopped_with_more_runs(self):
        """Pictures and bands of the runs of an earlier call go, as the tables are of more runs; --finish makes them again."""
        text = "histories = true\n" + NETWORKS.split("[[collect]]\nname")[0]
        out = self.made(self.written(text.format(runs=3)), self.folder / "out")
        names = {path.name for path in out.iterdir()}
        old = {name for name in names if name.endswith(".png") or name.startswith("ensemble")} | {"pictures.json"}
        self.assertGreater(len(old), 5)
        programs = self.programs('case "$PWD" in *work/00000[45]*) exec sleep 60 ;; esac')
        study = self.written(text.format(runs=6))
        running = subprocess.Popen([*map(str, self.command(study, out, programs=programs))], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        end = time.monotonic() + LONGEST_RUN
        while not (out / "groups" / "000003.rows").exists():
            self.assertLess(time.monotonic(), end)
            time.sleep(0.01)
        running.send_signal(signal.SIGINT)
        running.communicate(timeout=LONGEST_RUN)
        self.assertEqual(running.returncode, 130)
        self.assertIn("runs                 4 of 6, ended by a signal\n", (out / "summary.txt").read_text())
        self.assertEqual(names - {path.name for path in out.iterdir()}, old)
        self.made(study, out, "--finish")
        self.assertLessEqual(old, {path.name for path in out.iterdir()})
        self.assertIn("runs                 4 of 6, ended by --finish\n", (out / "summary.txt").read_text())
        self.assertIn(",4,", (out / "ensemble.csv").read_text().splitlines()[1])

    def test_finish_of_nothing(self):
        study, out = self.written(NETWORKS.format(runs=2)), self.folder / "out"
        done = self.study(study, out, "--finish")
        self.assertEqual((done.returncode, out.exists()), (2, False), done.stderr)
        self.assertIn(f"--finish: {out} is not the folder of a study", done.stderr)
        self.made(study, out)
        summary = (out / "summary.txt").read_text()
        self.assertNotIn("--finish", summary)
        self.made(study, out, "--finish")  # of all runs: the study has ended as it does without
        self.assertEqual((out / "summary.txt").read_text(), summary)
        shutil.rmtree(out / "groups")
        (out / "groups").mkdir()
        done = self.study(study, out, "--finish")
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn(f"--finish: no run has ended in {out}", done.stderr)

    def test_a_cut_off_line(self):
        """What a full disk leaves of a line of results is made again."""
        study = self.written(NETWORKS.format(runs=2))
        whole = self.made(study, self.folder / "whole")
        out = shutil.copytree(whole, self.folder / "out")
        rows = out / "groups" / "000001.rows"
        rows.with_name("000001.rows.part").write_bytes(rows.read_bytes()[:-9])
        rows.unlink()
        self.assert_same(whole, self.made(study, out))

    def hanging(self, study, out):
        """A study whose first run hangs."""
        programs = self.programs(f'[ "$1" = --version ] || exec sleep {LONGEST_RUN}')
        running = subprocess.Popen([*map(str, self.command(study, out, programs=programs))], start_new_session=True,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        end = time.monotonic() + LONGEST_RUN
        while not (out / "work" / "000000" / "joints.h5").exists():
            self.assertLess(time.monotonic(), end)
            time.sleep(0.01)
        return running

    def test_nothing_works_on_after_a_kill(self):
        running = self.hanging(self.written(NETWORKS.format(runs=2)), self.folder / "out")
        time.sleep(0.3)
        os.kill(running.pid, signal.SIGKILL)
        running.wait()
        end = time.monotonic() + 30  # its run hangs longer
        while alive(running.pid):
            self.assertLess(time.monotonic(), end, "something works on after the study was killed")
            time.sleep(0.01)

    def test_a_group_that_is_killed(self):
        """The message names it and the signal; the same command makes it."""
        study, out = self.written(NETWORKS.format(runs=2)), self.folder / "out"
        programs = self.programs(f'[ "$1" = --version ] || {{{{ echo "$PPID" >> "{{folder}}/workers"; exec sleep {LONGEST_RUN}; }}}}')
        running = subprocess.Popen([*map(str, self.command(study, out, programs=programs))], stdout=subprocess.DEVNULL,
                                   stderr=subprocess.PIPE, text=True)
        end, workers = time.monotonic() + LONGEST_RUN, programs / "workers"
        for count in 1, 2:  # one at a time
            while not workers.exists() or len(workers.read_text().splitlines()) < count:
                self.assertLess(time.monotonic(), end)
                time.sleep(0.01)
            os.kill(int(workers.read_text().split()[-1]), signal.SIGKILL)
        said = running.communicate(timeout=LONGEST_RUN)[1]
        self.assertEqual(running.returncode, 4, said)
        for name in "000000", "000001":
            self.assertIn(f"jointcreep: group {name} was stopped (signal 9)\n", said)
        self.assert_same(self.made(study, self.folder / "whole"), self.made(study, out))

    def test_without_enough_processes(self):
        """As many groups at a time as the system has processes for; without any the study says that runs are missing."""
        study = self.written(NETWORKS.format(runs=6))
        real, calls = runs.start, []

        def start(*of_work):
            calls.append(of_work)
            return len(calls) not in (3, 5) and real(*of_work)

        words = ["study", str(study), "-o", str(self.folder / "few"), "-q", "-j6"]
        with unittest.mock.patch.object(runs, "start", start):
            self.assertEqual(command_line.main(words, "0.1.0", self.chain.programs), 0)
        self.assertEqual(len(calls), 8)
        self.assert_same(self.made(study, self.folder / "whole"), self.folder / "few")
        words[3] = str(self.folder / "none")
        with unittest.mock.patch.object(runs, "start", lambda *_: False), contextlib.redirect_stderr(io.StringIO()) as said:
            self.assertEqual(command_line.main(words, "0.1.0", self.chain.programs), 4)
        self.assertIn("6 of 6 groups of runs in ", said.getvalue())

    def test_a_folder_that_is_made_anew(self):
        """In the same process: nothing is kept of the study that was there."""
        study, out = self.written(NETWORKS.format(runs=2)), self.folder / "out"
        found = []
        for text in SCENE, SCENE.replace("youngs_modulus_GPa = 10", "youngs_modulus_GPa = 1"):
            (self.folder / "scene.toml").write_text(text)
            shutil.rmtree(out, ignore_errors=True)
            self.assertEqual(command_line.main(["study", str(study), "-o", str(out), "-q"], "0.1.0", self.chain.programs), 0)
            found.append((out / "runs.csv").read_bytes())
        self.made(study, self.folder / "whole")
        self.assertEqual(found[1], (self.folder / "whole" / "runs.csv").read_bytes())
        self.assertNotEqual(*found)

    def test_two_studies_in_one_folder(self):
        study, out = self.written(NETWORKS.format(runs=2)), self.folder / "out"
        running = self.hanging(study, out)
        try:
            done = self.study(study, out)
            self.assertEqual(done.returncode, 2)
            self.assertIn("another study works in", done.stderr)
        finally:
            os.killpg(running.pid, signal.SIGKILL)
            running.wait()

    def test_other_studies_are_not_mixed_in(self):
        out = self.made(self.written(NETWORKS.format(runs=2)), self.folder / "out")
        before = {path.name: path.read_bytes() for path in out.iterdir() if path.is_file()}
        (self.folder / "scene.toml").write_text(SCENE.replace("cohesion_MPa = 1", "cohesion_MPa = 2"))
        done = self.study(self.folder / "study.toml", out)
        self.assertEqual(done.returncode, 2)
        self.assertIn("has runs of another study: the scene changed", done.stderr)
        self.assertEqual(before, {path.name: path.read_bytes() for path in out.iterdir() if path.is_file()})

    def test_read_only_and_impossible_folders(self):
        study = self.written(NETWORKS.format(runs=2))
        (self.folder / "file").write_text("")
        done = self.study(study, self.folder / "file" / "out")
        self.assertEqual(done.returncode, 4, done.stderr)
        self.assertRegex(done.stderr, "^jointcreep: .*file")
        before = (self.folder / "scene.toml").read_bytes()
        done = self.study(study, self.folder)  # whose inputs have the names of outputs
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("has files, and is not the folder of a study", done.stderr)
        self.assertEqual((self.folder / "scene.toml").read_bytes(), before)

    def test_a_damaged_folder(self):
        study = self.written(NETWORKS.format(runs=2))
        whole = self.made(study, self.folder / "whole")
        for name in ("plan.json", "groups/000001.rows"):
            with self.subTest(name):
                out = shutil.copytree(whole, self.folder / name.replace("/", "-"))
                (out / name).write_text("nothing of use\n")
                done = self.study(study, out)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertIn(f"{out / name}: is damaged", done.stderr)


class Failures(Studies):
    def test_a_failed_run(self):
        """It is kept with code and reason, does not stop the others, and counts where failure is the answer; where it is not, it is
        made twice. Blocks that move are told from a search without an answer by the file that is left."""
        left_by_failure(self.folder / "moving.h5", 1, [3, 0])
        case = 'case "$PWD" in *work/000001*) echo "demsolve: warning: soon" >&2; echo "demsolve: no equilibrium: on purpose" >&2; ' \
               f'echo "demsolve: the run up to there is in result.failed.h5" >&2; cp "{self.folder}/moving.h5" result.failed.h5; exit 3 ;; esac'
        programs = self.programs(case)
        out = self.made(self.written('keep = ["result.failed.h5"]\n' + NETWORKS.format(runs=4)), self.folder / "out", programs=programs)
        self.assertEqual([path.name for path in (out / "kept").iterdir()], ["000001-result.failed.h5"])
        rows = rows_of(out)
        self.assertEqual([row["exit code"] for row in rows], ["0", "3", "0", "0"])
        self.assertEqual([row["no equilibrium"] for row in rows], ["", "blocks move", "", ""])
        self.assertEqual((rows[1]["program"], rows[1]["reason"]), ("demsolve", "demsolve: no equilibrium: on purpose"))
        self.assertEqual((rows[1]["floor y (mm)"], rows[1]["failed"]), ("", "1.0"))
        of_failure = ["failure stage", "failure day", "moving blocks", "moving area (m2)"]
        self.assertEqual([[row[name] for name in of_failure] for row in rows[:2]], [[""] * 4, ["bench", "2.0", "2", "4.0"]])
        with h5py.File(out / "runs.h5") as file:
            table = file["runs"][()]
            self.assertEqual([list(table[name]) for name in of_failure], [[b"", b"bench", b"", b""], [0, 2, 0, 0], [0, 2, 0, 0], [0, 4, 0, 0]])
            self.assertEqual(list(table["moving area (m2), is there"]), [0, 1, 0, 0])
            self.assertEqual(dict(zip(table.dtype.names, file["runs"].attrs["units"]))["moving area (m2)"], b"m2")
        found = jointcreep.read(out).runs
        self.assertEqual((list(found["failure stage"])[:2], found["moving area (m2)"][1], found.units["moving area (m2)"]), (["", "bench"], 4, "m2"))
        self.assertGreater(float(rows[1]["blocks, number"]), 1)  # which the network has all the same
        other = self.made(self.written(NETWORKS.format(runs=4).replace('[[collect]]\nwhat = "failed"\n', "")), self.folder / "other",
                          programs=programs)
        for folder, attempts in ((out, "1"), (other, "2")):
            with open(folder / "times.csv", encoding="utf-8") as file:
                self.assertEqual([row["attempts"] for row in csv.DictReader(file)], ["1", attempts, "1", "1"])
        text = (out / "summary.txt").read_text()
        self.assertIn("without equilibrium  1\n  blocks move        1\n  undecided          0\n", text)
        self.assertIn("\nwarning in 1 of 4 runs: demsolve: soon\n", text)
        self.assertTrue(text.endswith("run 1 failed: stage \"bench\", 2 moving blocks, 4 m2: demsolve: no equilibrium: on purpose\n"
                                      "of the point dug away (mm): an excavation takes the point \"dug away\" before, or it is not read yet, "
                                      "in 3 of 4 runs: 0, 2, 3\n"), text)
        with open(out / "answers.csv", encoding="utf-8") as file:
            found = {(row["quantity"], row["statistic"]): row for row in csv.DictReader(file)}
        self.assertEqual(found["floor y", "mean"]["runs"], "3")
        above = [float(row["floor y (mm)"]) > 0.1 for row in rows if row["floor y (mm)"]]
        for name, n, count in (("probability above 0.1, of stable runs", 3, sum(above)),
                               ("probability above 0.1 or no equilibrium", 4, sum(above) + 1)):
            row = found["floor y", name]
            self.assertEqual((int(row["runs"]), *(float(row[key]) for key in ("value", "low", "high"))),
                             (n, *intervals.probability(count, n)))
        row = found["floor y", "standard error of the mean"]
        values = [float(row["floor y (mm)"]) for row in rows if row["floor y (mm)"]]
        self.assertAlmostEqual(float(row["value"]), np.std(values, ddof=1) / np.sqrt(3), delta=1e-12)
        self.assertEqual(float(found["failed", "probability"]["value"]), 0.25)

    def test_panels_of_convergence(self):
        """Two probabilities of the same limit that are the same have one panel; those of different limits have two."""
        text = NETWORKS.format(runs=20).replace("above = [0.1]", "above = [0.1, 0.2]")
        study = study_file.read(self.written(text))
        rows = [{"run": run, "exit_code": 0, "program": "", "reason": "", "values": [0.01 * run, None, None, None, 0.0], "no_equilibrium": {}}
                for run in range(20)]
        above = ["probability above 0.1", "probability above 0.2"]
        self.assertEqual(list(pictures.panels_of(answers.convergence(study, rows, 0))), ["mean", *above])
        picture = pictures.convergence(study.quantities[0], answers.convergence(study, rows, 0), study.stop, "runs")
        self.assertEqual([axes.get_ylabel().replace("\n", " ") for axes in picture.axes],
                         ["mean of floor y (mm)", *(f"{name} mm (percent)" for name in above)])
        rows[7].update(exit_code=3, values=[None] * 4 + [1.0], no_equilibrium={"result.h5": "blocks move"})
        both = [name + end for name in above for end in (", of stable runs", " or no equilibrium")]
        self.assertEqual(list(pictures.panels_of(answers.convergence(study, rows, 0))), ["mean", *both])

    def test_an_undecided_run(self):
        """It is neither stable nor failed: probabilities that depend on it have two rows."""
        left_by_failure(self.folder / "undecided.h5", 0, [1], "")
        left_by_failure(self.folder / "moving.h5", 1, [2])
        case = f'case "$PWD" in *work/000001*) cp "{self.folder}/undecided.h5" result.failed.h5 ;; *work/000002*) ;; *work/000003*) ' \
               f'cp "{self.folder}/moving.h5" result.failed.h5 ;; *) exec "{self.chain.programs}/demsolve" "$@" ;; esac; ' \
               '[ "$1" = --version ] && exec "{{folder}}/demsolve" "$@"; echo "demsolve: no equilibrium: why" >&2; exit 3'
        out = self.made(self.written(NETWORKS.format(runs=6)), self.folder / "out", programs=self.programs(case))
        rows = rows_of(out)
        self.assertEqual([row["exit code"] for row in rows], ["0", "3", "3", "3", "0", "0"])
        self.assertEqual([row["no equilibrium"] for row in rows], ["", "undecided", "undecided", "blocks move", "", ""])
        self.assertEqual([row["failed"] for row in rows], ["0.0", "", "", "1.0", "0.0", "0.0"])
        with h5py.File(out / "runs.h5") as file:
            self.assertEqual(list(file["runs"]["no equilibrium"]), [row["no equilibrium"].encode() for row in rows])
        study = jointcreep.read(out)
        self.assertEqual(list(study.runs["no equilibrium"]), [row["no equilibrium"] for row in rows])
        self.assertEqual(study.answer("probability, at least", "failed"), intervals.probability(1, 6))
        self.assertEqual(study.answer("probability of no equilibrium, at least", "failed"), intervals.probability(1, 6))
        self.assertEqual(study.answer("probability, at most", "failed"), intervals.probability(3, 6))
        above = sum(float(row["floor y (mm)"]) > 0.1 for row in rows if row["floor y (mm)"])
        self.assertEqual(study.answer("probability above 0.1, of stable runs", "floor y"), intervals.probability(above, 3))
        self.assertEqual(study.answer("probability above 0.1 or no equilibrium, at least", "floor y"), intervals.probability(above + 1, 6))
        self.assertEqual(study.answer("probability above 0.1 or no equilibrium, at most", "floor y"), intervals.probability(above + 3, 6))
        text = (out / "summary.txt").read_text()
        self.assertIn("without equilibrium  3\n  blocks move        1\n  undecided          2\n", text)
        self.assertIn("warning: 2 of 6 runs ended undecided: whether they have an equilibrium is not known. They have no value; ", text)
        self.assertRegex(text, "probability of no equilibrium, at least +6 ")
        self.assertIn("run 1 undecided: day 2, 1 block that moved most, 1.5 m2: demsolve: no equilibrium: why\n", text)
        self.assertIn("run 2 undecided: demsolve: no equilibrium: why\n", text)  # which left no file
        self.assertIn('run 3 failed: stage "bench", 1 moving block, 2.5 m2: demsolve: no equilibrium: why\n', text)
        self.assertEqual(self.chain.jointcreep("report", out, "-o", self.folder / "r.html").returncode, 0)
        page = (self.folder / "r.html").read_text()
        for what, count in (("blocks move", 1), ("undecided", 2)):
            self.assertRegex(page, f"runs without equilibrium: {what}</td><td[^>]*>{count}<")

    def test_a_run_that_fails_once(self):
        """Its results are those of a run that never did."""
        study = self.written(NETWORKS.format(runs=3))
        case = 'case "$PWD" in *work/000001*) if [ ! -e "{folder}/once" ]; then touch "{folder}/once"; kill -SEGV $$; fi ;; esac'
        self.assert_same(self.made(study, self.folder / "whole"),
                         self.made(study, self.folder / "out", programs=self.programs(case)))

    def test_failures_over_few_values(self):
        """Classes of a parameter without a run have no share; the numbers of runs are above."""
        axes = pictures.figure.plt.figure().add_subplot()
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            pictures.share_in_classes(axes, np.array([30.0, 30, 30, 30, 37, 38]), np.array([0.0, 1, 0, 0, 1, 1]), True)
        counts = [int(text.get_text()) for text in axes.texts]
        self.assertEqual(sum(counts), 6)
        self.assertEqual(len(counts), len(axes.patches))
        self.assertIn(0, counts)
        pictures.figure.plt.close(axes.figure)

    def test_lines_of_failures(self):
        """Short ones, twenty at most, and of both kinds of runs without equilibrium; warnings of one kind are counted together."""
        study = study_file.read(self.written(NETWORKS.format(runs=30)))
        moving = "demsolve: no equilibrium: the rock is moving; on day 2; moving blocks: block 73 at [1, 2] m by [0.1, 0.2] m; and more"
        undecided = "demsolve: no equilibrium: after 1000000 steps the unbalanced force ratio is 0.00016; " + "word " * 300
        rows = [{"run": run, "exit_code": 3 if run < 24 else 0, "program": "demsolve" if run < 24 else "", "values": [None] * 4 + [1.0],
                 "reason": "" if run >= 24 else moving if run % 4 else undecided,
                 "no_equilibrium": {"result.h5": "blocks move" if run % 4 else "undecided"} if run < 24 else {},
                 "warnings": [f'jointgen: {50 + run}.5 percent of joint set "J1" are cut back'] * (run % 2)} for run in range(30)]
        text = answers.summary(study, rows, "", [], [])
        self.assertIn("without equilibrium  24\n  blocks move        18\n  undecided          6\n", text)
        self.assertIn('\nwarning in 15 of 30 runs: jointgen: 51.5 percent of joint set "J1" are cut back\n', text)
        lines = [line for line in text.splitlines() if line.startswith("run ")]
        self.assertEqual(lines[:2], ["run 0 undecided: demsolve: no equilibrium: after 1000000 steps the unbalanced force ratio is 0.00016",
                                     "run 1 failed: demsolve: no equilibrium: the rock is moving"])
        self.assertEqual(text.splitlines()[text.splitlines().index(lines[-1]) + 1], "and 4 more in runs.csv")
        small_ratio = undecided.replace("0.00016;", "3e-07, expected 1e-06, and by estimate 1.27 m of displacement remain, expected 2e-05 m;")
        self.assertEqual(answers.failure_words({**rows[0], "reason": small_ratio}),
                         "run 0 undecided: demsolve: no equilibrium: after 1000000 steps by estimate 1.27 m of displacement remain")
        self.assertEqual(len([line for line in lines if " failed: " in line or " undecided: " in line]), 20)
        many = answers.failure_words({**rows[0], "reason": "demsolve: " + "word " * 300})
        self.assertLess(len(many), 130)
        for more, words in (({"stage": "", "day": 0.0}, "before the first stage, 2 moving blocks, 12.35 m2"), ({"stage": "", "day": 548.5}, "day 548.5, 2"),
                            ({"stage": "bench 3", "day": 2.0}, 'stage "bench 3", 2 moving')):
            self.assertIn(f"run 1 failed: {words}", answers.failure_words({**rows[1], "failure": {"blocks": 2, "area": 12.3456, **more}}))

    def test_moving_blocks(self):
        """Their number and area are those of the files that the runs leave."""
        text = re.sub(r"(?m)^cohesion_MPa.*", "cohesion_MPa = 0", SCENE).replace("mean_deg = 5,", "mean_deg = -25,")
        text = re.sub(r"(?m)^tensile_strength_MPa.*", "tensile_strength_MPa = 0", text).replace("friction_angle_deg = 35", "friction_angle_deg = 8")
        (self.folder / "scene.toml").write_text(text)
        out = self.made(self.written('keep = ["result.failed.h5"]\n' + NETWORKS.format(runs=3)), self.folder / "out", "-j2")
        failed = [row for row in rows_of(out) if row["no equilibrium"]]
        self.assertGreater(len(failed), 1)
        for row in failed:
            of = jointcreep.read(out / "kept" / f"{int(row['run']):06d}-result.failed.h5").moving_blocks()
            self.assertEqual(int(row["moving blocks"]), of.rows())
            self.assertAlmostEqual(float(row["moving area (m2)"]), np.sum(of["area"]), places=9)
            self.assertIn(f"run {row['run']} failed: stage \"bench\", {of.rows()} moving block", (out / "summary.txt").read_text())

    def test_chance_correlation(self):
        """Of few sets of values; more than 2 / sqrt(N) is a warning. Pairs with a [[correlation]] do not count."""
        self.assertEqual(answers.chance_words((("a", "b"), 1.0, 3)), (["chance correlation   not judged: 3 sets of values only"], []))
        vary = "".join(f'[[vary]]\nname = "{name}"\nkey = "{key}"\nvalues = [1, 2, 3, 4, 5, 6]\n' for name, key in (
            ("a", "joint_material.joint.cohesion_MPa"), ("b", "rock.rock.youngs_modulus_GPa"), ("c", "joint_material.joint.tensile_strength_MPa")))
        study = study_file.read(self.written(NETWORKS.format(runs=8) + vary))
        values = [(1, 1, 3), (2, 2, 1), (3, 3, 6), (4, 4, 2), (5, 5, 5), (6, 6, 4), (1, 2, 3), (4, 3, 1)]
        given = {run: {"run": run, "network": run, "given": list(of)} for run, of in enumerate(values)}
        rows = [{"run": run, "exit_code": 0, "program": "", "reason": "", "values": [0.1, 0.2, 0.3, 9, 0],
                 "no_equilibrium": {}, "warnings": []} for run in given]
        pair, r, n = answers.chance_correlation(study, rows, given)
        self.assertEqual((pair, n), (("a", "b"), 8))
        self.assertGreater(r, 0.9)
        text = answers.summary(study, rows, "", [], [], (pair, r, n))
        self.assertIn(f"chance correlation   {r:.2f}, the largest of two parameters (a; b); usual bound 0.71\n", text)
        self.assertIn(f'\nwarning: by chance "a" and "b" have a rank correlation of {r:.2f} in 8 sets of values, more than the usual', text)
        self.assertNotIn("by chance", answers.summary(study, rows, "", [], [], (pair, 0.7, n)))
        study.correlations = [("b", "a", 0.9)]
        self.assertNotEqual(answers.chance_correlation(study, rows, given)[0], ("a", "b"))
        self.assertIsNone(answers.chance_correlation(study_file.read(self.written(NETWORKS.format(runs=8))), rows, given))

    def test_warnings_of_the_programs(self):
        """A warning that the programs print is in the summary and in the report, with the number of runs."""
        case = 'case "$PWD" in *work/*) echo "jointgen: warning: 7 percent are gone" >&2 ;; esac'
        out = self.made(self.written(NETWORKS.format(runs=2)), self.folder / "out", programs=self.programs(case, "jointgen"))
        self.assertIn("warning in 2 of 2 runs: jointgen: 7 percent are gone\n", (out / "summary.txt").read_text())
        self.assertEqual(self.chain.jointcreep("report", out, "-o", self.folder / "r.html").returncode, 0)
        self.assertIn("<li>warning in 2 of 2 runs: jointgen: 7 percent are gone</li>", (self.folder / "r.html").read_text())

    def test_time_left(self):
        """By the mean of all runs that have ended, failed ones too, and how many are made at once. A run at present that takes longer than
        they did counts by its time so far."""
        now = [0.0]
        with unittest.mock.patch.object(runs.time, "monotonic", lambda: now[0]):
            progress = runs.Progress(100, "runs", True, 4)
            progress.tell(0)
            self.assertIsNone(progress.seconds_left())
            ended = [20.0] * 11 + [40.0] * 5 + [1.0] * 24
            mean = np.mean(ended)
            progress.tell(40, ended)
            self.assertAlmostEqual(progress.seconds_left(), 60 / 4 * mean)
            progress.tell(99, ended)  # one is not made in a quarter of its time
            self.assertAlmostEqual(progress.seconds_left(), mean)
            progress.tell(40, ended, runs.Present([30.0, 10.0]))  # they take 40 s, and the mean of 20 s and 40 s
            whole = [40.0, (20 * 11 + 40 * 5) / 16]
            self.assertAlmostEqual(progress.seconds_left(), (sum(whole) - 40 + 58 * np.mean([*ended, *whole])) / 4)
            progress.tell(98, ended, runs.Present([600.0, 300.0]))  # both take longer than any that has ended
            self.assertAlmostEqual(progress.seconds_left(), 600)
            progress.tell(98, [*ended, 900.0], runs.Present([600.0, 300.0]))
            self.assertAlmostEqual(progress.seconds_left(), 600)
            progress.tell(99, [*ended, 900.0], runs.Present([600.0]))
            self.assertAlmostEqual(progress.seconds_left(), 300)
            progress.deadline = time.monotonic() + 20
            self.assertAlmostEqual(progress.seconds_left(), 20)
            progress = runs.Progress(100, "replicates", True)  # by the pace of the last half
            progress.tell(0)
            for done in range(1, 41):
                now[0] += 20 if done <= 10 else 1
                progress.tell(done)
            self.assertAlmostEqual(progress.seconds_left(), 60)
            now[0] += 20  # nothing has ended since
            self.assertAlmostEqual(progress.seconds_left(), 120)

    def test_runs_at_present(self):
        """How many there are, since when the longest is made, and what its search knows; runs of a killed study do not count."""
        out = self.chain.new_folder()
        now = time.time()
        self.assertEqual(str(runs.present_runs(out, now)), "")
        for name, age in (("000000", 9000), ("000001", 2100), ("000002", 20)):
            folder = out / "work" / name
            folder.mkdir(parents=True)
            folder.with_suffix(".begun").touch()
            os.utime(folder.with_suffix(".begun"), (now - age, now - age))
        self.assertEqual(str(runs.present_runs(out, now - 5000)), "; 2 runs at present, the longest for 35 min")
        said = ["demsolve: run 1, strengths x 64: stable, for comparison", "demsolve: run 2, strengths / 1: stable; factor of safety at least 1"]
        for lines, words in ((said[:1], ""), (said, ", factor of safety at least 1"), ([*said, "demsolve: 33%, 8 s left: strengths / 2 (factor "
                             "of safety at least 1), bench 3"], ", factor of safety at least 1"), ([*said, "demsolve: run 3, strengths / 2: "
                             "fails; factor of safety at least 1, below 2; at most 5 more runs"], ", factor of safety at least 1, below 2")):
            (out / "work" / "000001" / "said.txt").write_text("\n".join(lines) + "\n")
            self.assertEqual(str(runs.present_runs(out, now - 5000)), f"; 2 runs at present, the longest for 35 min{words}")
        self.assertEqual(str(runs.present_runs(out, now - 50)), "; 1 run at present, for 20 s")
        self.assertEqual(str(runs.present_runs(out, now - 5)), "")

    def test_a_long_search(self):
        """Its bracket is in the line of progress; the lines of its progress are no message of a run that fails."""
        case = 'case "$*" in *--factor-of-safety*) echo "demsolve: run 1, strengths x 64: stable, for comparison" >&2; ' \
               'echo "demsolve: run 2, strengths / 1: stable; factor of safety at least 1" >&2; echo "demsolve: 33%: strengths / 2 (factor of ' \
               'safety at least 1), bench 3" >&2; sleep 2; echo "demsolve: on purpose" >&2; exit 5 ;; esac'
        text = NETWORKS.split("[[collect]]")[0].format(runs=2) + '[[collect]]\nwhat = "blocks"\nstatistic = "number"\n' \
            '[[collect]]\nname = "F"\nwhat = "factor of safety"\n'
        study, out = study_file.read(self.written(text)), self.folder / "out"
        programs, told = self.programs(case), io.StringIO()
        with unittest.mock.patch.object(runs, "LONG", 0.5), unittest.mock.patch.object(runs, "SILENT", 0.5), \
                contextlib.redirect_stderr(told), runs.locked(out) as lock:
            plan.make(study, out, programs)
            rows, _ = runs.make(study, out, programs, 2, None, False, None, lock)
        self.assertRegex(told.getvalue(), r"0 of 2 runs; 2 runs at present, the longest for \d s, factor of safety at least 1\n")
        self.assertEqual(rows[0]["reason"], "demsolve: on purpose")

    def test_a_run_that_is_repeated_is_one_run(self):
        """Its time at present is since its first try, as its seconds in the end."""
        case = 'case "$PWD" in *work/000000*) sleep 1.5; exit 5 ;; esac'
        told, longest, present_runs = io.StringIO(), [], runs.present_runs

        def noted(out, since):
            found = present_runs(out, since)
            longest.append(max(found.ages, default=0))
            return found
        study, out = study_file.read(self.written(NETWORKS.format(runs=2))), self.folder / "out"
        programs = self.programs(case)
        with unittest.mock.patch.object(runs, "present_runs", noted), unittest.mock.patch.object(runs, "LOOKS", 0.1), \
                contextlib.redirect_stderr(told), runs.locked(out) as lock:
            plan.make(study, out, programs)
            rows, _ = runs.make(study, out, programs, 1, None, False, None, lock)
        self.assertEqual(rows[0]["attempts"], 2)
        self.assertGreater(max(longest), 2.5)
        self.assertFalse(list((out / "work").iterdir()))

    def test_times_of_runs(self):
        """They are read as they come, each once, also where the file of a group gets its final name."""
        out = self.chain.new_folder()
        (out / "groups").mkdir()
        part, line = out / "groups" / "000000.rows.part", '{{"run": {0}, "seconds": {0}.5, "exit_code": 0, "values": []}}\n'
        ended = runs.Ended(out)
        self.assertEqual(ended.look(["000000", "000001"]), [])
        part.write_text(line.format(0) + line.format(1)[:9])
        self.assertEqual(ended.look(["000000", "000001"]), [0.5])
        part.write_text(line.format(0) + line.format(1))
        part.rename(out / "groups" / "000000.rows")
        self.assertEqual(ended.look(["000000", "000001"]), [0.5, 1.5])

    def test_a_failed_search(self):
        """Its message is in the table, and the state of its failed run can be kept."""
        case = 'case "$*" in *--factor-of-safety*) echo "demsolve: with strengths 64 times as large there is still no equilibrium: on ' \
               'purpose" >&2; echo "demsolve: the run up to there is in safety.failed.h5" >&2; touch safety.failed.h5; exit 3 ;; esac'
        text = NETWORKS.split("[[collect]]")[0].format(runs=2) + '[[collect]]\nwhat = "blocks"\nstatistic = "number"\n' \
            '[[collect]]\nname = "F"\nwhat = "factor of safety"\n'
        out = self.made(self.written('keep = ["safety.failed.h5"]\n' + text), self.folder / "out", programs=self.programs(case))
        self.assertEqual(sorted(path.name for path in (out / "kept").iterdir()), ["000000-safety.failed.h5", "000001-safety.failed.h5"])
        for row in rows_of(out):
            self.assertEqual((row["exit code"], row["program"], row["F, lower end"]), ("3", "demsolve", ""))
            self.assertEqual(row["reason"], "demsolve: with strengths 64 times as large there is still no equilibrium: on purpose")
        self.assertIn("run 1 undecided: demsolve: with strengths 64 times as large", (out / "summary.txt").read_text())
        self.refused('keep = ["safety.failed.h5"]\n' + NETWORKS.format(runs=2), "for safety.failed.h5")

    def test_what_is_no_result(self):
        """A full disk, or a program that is killed: the run is made when the study goes on."""
        study = self.written(NETWORKS.format(runs=3))
        whole = self.made(study, self.folder / "whole")
        for what in ("exit 4", "kill -9 $$"):
            with self.subTest(what):
                out = self.folder / what.replace(" ", "")
                done = self.study(study, out, programs=self.programs(f'case "$PWD" in *work/000001*) {what} ;; esac'))
                self.assertEqual(done.returncode, 4)
                self.assertIn("run 1: demsolve was stopped", done.stderr)
                self.assert_early(out, done.stdout, 3, "without runs that could not be made")
                self.assertIn(f"\n2 of 3 runs have ended; their results are in {out / 'runs.csv'}", done.stderr)
                self.assert_same(whole, self.made(study, out))

    def test_a_program_that_is_removed(self):
        """It cannot be started: no result of a run, and the study goes on where it is there again."""
        study, out = self.written(NETWORKS.format(runs=2)), self.folder / "out"
        done = self.study(study, out, programs=self.programs('[ "$1" = --version ] || rm -f "{folder}/demsolve"', "strength-averaging"))
        self.assertEqual(done.returncode, 4, done.stderr)
        self.assertRegex(done.stderr, "/demsolve cannot be started, or ended with exit code 127: .*not found")
        self.assertEqual(rows_of(self.made(study, out))[0]["exit code"], "0")

    def test_all_failed(self):
        study = self.written(NETWORKS.format(runs=2).split("[[collect]]\nname")[0])
        done = self.study(study, self.folder / "out", programs=self.programs('[ "$1" = --version ] || exit 5'))
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn("run 0 failed: demsolve: exit code 5", done.stdout)
        self.assertNotIn("Traceback", done.stderr)


class Designs(Studies):
    """What OpenTURNS draws."""

    def drawn(self, design, more=FRICTION):
        text = re.sub(r"\[design\]\nruns = .*\n", f"[design]\n{design}\n", NETWORKS) + more
        study = study_file.read(self.written(text))
        return study, *draw_design.draw(study)

    @needs_openturns
    def test_laws(self):
        """Mean, deviation and ends of each law, in each design; means of Latin hypercubes are nearer than chance."""
        more = """
[[vary]]
key = "b"
law = "lognormal"
mean = 5
deviation = 2
[[vary]]
key = "c"
law = "triangular"
lowest = 0
most_likely = 1
highest = 5
[[vary]]
key = "d"
law = "uniform"
lowest = -1
highest = 1
[[vary]]
key = "e"
law = "normal"
mean = 0
deviation = 1
lowest = 0
[[vary]]
key = "f"
values = [1, 2, 6]
"""
        mean = np.array([35, 5, 2, 0, np.sqrt(2 / np.pi), 3])
        deviation = np.array([3, 2, np.sqrt((25 + 1 - 5) / 18), np.sqrt(1 / 3), np.sqrt(1 - 2 / np.pi), np.sqrt(14 / 3)])
        for design, runs, within in [("runs = 4000", 4000, 4), ('kind = "latin hypercube"\nruns = 4000', 4000, 1),
                                     ('kind = "sobol sequence"\nruns = 5120', 5120, 1),
                                     ('kind = "networks x parameters"\nnetworks = 3\nparameters = 4000', 12000, 4),
                                     ('kind = "sobol indices"\npoints = 512', 512 * 9, 10)]:
            with self.subTest(design):
                _, networks, values = self.drawn(design, FRICTION + more)
                values = np.array(values)
                self.assertEqual(values.shape, (runs, 6))
                error = deviation / np.sqrt(4000)
                self.assertTrue((np.abs(values.mean(axis=0) - mean) < within * error).all())
                self.assertTrue((np.abs(values.std(axis=0) / deviation - 1) < 0.1).all())
                self.assertGreaterEqual(values[:, 4].min(), 0)

    @needs_openturns
    def test_a_longer_design_begins_with_the_shorter_one(self):
        more = '\n[[vary]]\nkey = "b"\nlaw = "uniform"\nlowest = 0\nhighest = 1\n[[correlation]]\nbetween = ["b", "friction"]\n' \
               "coefficient = -0.5\n"
        _, _, long = self.drawn("runs = 2000", FRICTION + more)
        _, _, short = self.drawn("runs = 500", FRICTION + more)
        self.assertEqual(long[:500], short)
        ranks = np.argsort(np.argsort(np.array(long), axis=0), axis=0)
        self.assertAlmostEqual(np.corrcoef(ranks.T)[0, 1], -0.5, delta=4 * 0.75 / np.sqrt(2000))

    @needs_openturns
    def test_networks(self):
        _, networks, values = self.drawn('kind = "networks x parameters"\nnetworks = 3\nparameters = 4')
        self.assertEqual(list(networks), [0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2])
        self.assertEqual(values[:4], values[8:])
        _, networks, values = self.drawn('kind = "sobol indices"\npoints = 8')  # A, B, A with friction of B, A with networks of B
        networks, friction = np.array(networks).reshape(4, 8), np.array(values).reshape(4, 8)
        self.assertEqual(len(set(networks[:2].ravel())), 16)
        self.assertTrue((networks[2] == networks[0]).all() and (friction[2] == friction[1]).all())
        self.assertTrue((networks[3] == networks[1]).all() and (friction[3] == friction[0]).all())

    @needs_openturns
    def test_sobol_indices_of_ishigami(self):
        """Of sin(a) + 7 sin^2(b) + 0.1 c^4 sin(a) with a, b, c between -pi and pi (Ishigami and Homma 1990)."""
        uniform = '\n[[vary]]\nkey = "{}"\nlaw = "uniform"\nlowest = -3.141592653589793\nhighest = 3.141592653589793\n'
        text = re.sub(r"\[design\]\nruns = .*\n", '[design]\nkind = "sobol indices"\npoints = 2000\n', NETWORKS)
        text = text.replace("network = true", "network = false", 1).replace('[[vary]]\nnetwork = false\n', "")
        study = study_file.read(self.written(text + "".join(map(uniform.format, "abc"))))
        networks, values = draw_design.draw(study)
        rows = [{"run": run, "values": [np.sin(a) + 7 * np.sin(b) ** 2 + 0.1 * c**4 * np.sin(a)]}
                for run, (a, b, c) in enumerate(values)]
        given = [{"run": run, "network": 0, "given": of_run} for run, of_run in enumerate(values)]
        rows[17]["values"] = [None]  # a run that failed takes its point with it
        found = answers.shares(study, rows, given, 0)
        variance = 0.1 * np.pi**4 / 5 + 0.01 * np.pi**8 / 18 + 0.5 + 49 / 8
        first_a, b = 0.5 * (1 + 0.1 * np.pi**4 / 5) ** 2 / variance, 49 / 8 / variance
        with_c = 0.01 * np.pi**8 * (1 / 18 - 1 / 50) / variance
        wanted = [first_a, b, 0, first_a + with_c, b, with_c]
        self.assertEqual([row[:2] for row in found], [(name, measure) for measure in ("first order index", "total index") for name in "abc"])
        for (name, measure, value, low, high), true in zip(found, wanted):
            with self.subTest(f"{measure} of {name}"):
                self.assertAlmostEqual(value, true, delta=0.06)
                self.assertTrue(low - 0.02 <= true <= high + 0.02, (low, true, high))

    def test_shares_of_a_crossed_design(self):
        """Of a sum whose parts have known variances."""
        networks, parameters = 60, 50
        chance = np.random.default_rng(3)
        parts = [np.sqrt(share) * chance.normal(size=size) for share, size in
                 zip((0.6, 0.3, 0.1), ((networks, 1), (1, parameters), (networks, parameters)))]
        true = [part.var() for part in parts]
        text = re.sub(r"\[design\]\nruns = .*\n", f'[design]\nkind = "networks x parameters"\nnetworks = {networks}\n'
                      f"parameters = {parameters}\n", NETWORKS) + FRICTION
        study = study_file.read(self.written(text))
        rows = [{"run": run, "values": [value]} for run, value in enumerate(sum(parts).ravel())]
        rows[7]["values"] = [None]
        found = answers.crossed_shares(study, rows, {}, 0)
        for (name, _, value, low, high), share in zip(found, np.array(true) / sum(true)):
            with self.subTest(name):
                self.assertAlmostEqual(value, share, delta=0.03)
                self.assertTrue(low <= share <= high)

    def test_shares_of_each_parameter(self):
        """Of a linear function of independent parameters the parts are known; they add up to the share of all parameters. A curved
        function of one has a rest; correlated parameters are not divided."""
        networks, parameters, chance = 25, 40, np.random.default_rng(4)
        text = re.sub(r"\[design\]\nruns = .*\n", f'[design]\nkind = "networks x parameters"\nnetworks = {networks}\n'
                      f"parameters = {parameters}\n", NETWORKS)
        text += "".join(f"\n[[vary]]\nkey = '{name}'\nlaw = 'uniform'\nlowest = 0\nhighest = 1\n" for name in "abc")
        study = study_file.read(self.written(text))
        x = chance.normal(size=(parameters, 3))
        x -= x.mean(axis=0)
        x = np.linalg.qr(x)[0] * np.sqrt(parameters - 1)  # without correlation, of variance 1
        of_network = 2 * chance.normal(size=(networks, 1))
        given = [{"given": list(x[run % parameters])} for run in range(networks * parameters)]
        curved = x[:, 0] ** 2 - (x[:, 0] ** 2).mean()
        curved -= x @ (x.T @ curved) / (parameters - 1)
        curved /= curved.std(ddof=1)
        for more, rest in ((0, 0.0), (curved, 1.0)):
            values = (of_network + x @ [2, 1, 0] + more).ravel()
            rows = [{"run": run, "values": [value], "exit_code": 0} for run, value in enumerate(values)]
            found = {name: value for name, _, value, _, _ in answers.crossed_shares(study, rows, given, 0)}
            total = of_network.var(ddof=1) + 5 + rest
            degrees = (parameters - 1) / (parameters - 4)  # of the adjusted coefficient
            wanted = (1 - rest / (5 + rest) * degrees) * (5 + rest) / total
            for name, share in (("a", 0.8 * wanted), ("b", 0.2 * wanted), ("c", 0), (answers.NOT_LINEAR, rest * degrees / total)):
                self.assertAlmostEqual(found[name], share, places=9)
            self.assertAlmostEqual(found["all parameters"], (5 + rest) / total, places=9)
        study.correlations = [("a", "b", 0.5)]
        self.assertEqual(len(answers.crossed_shares(study, rows, given, 0)), 3)

    def test_parts_of_all_parameters_follow_it(self):
        rows = [(name, "share of variance", 0.1, 0, 1) for name in ("network", answers.ALL_PARAMETERS, "network with parameters", "a", "b")]
        self.assertEqual([(row[0], is_part) for row, is_part in answers.with_parts([*rows, ("a", answers.CORRELATION, 0.1, 0, 1)])],
                         [("network", False), (answers.ALL_PARAMETERS, False), ("a", True), ("b", True), ("network with parameters", False)])

    def test_incomplete_networks(self):
        """All runs with a value count, the rank correlations are of the parameters' effects, and the summary says so."""
        networks, parameters, chance = 6, 12, np.random.default_rng(8)
        text = re.sub(r"\[design\]\nruns = .*\n", f'[design]\nkind = "networks x parameters"\nnetworks = {networks}\n'
                      f"parameters = {parameters}\n", NETWORKS) + FRICTION
        study = study_file.read(self.written(text))
        friction = chance.normal(size=parameters)
        table = 5 * chance.normal(size=(networks, 1)) + np.arange(parameters)[np.argsort(np.argsort(friction))]
        rows = [{"run": run, "values": [value, None, None, None, 0.0], "exit_code": 0, "reason": "", "program": "", "no_equilibrium": {}}
                for run, value in enumerate(table.ravel().tolist())]
        for run in (0, 3, 14):
            rows[run].update(values=[None] * 4 + [1.0], exit_code=3, program="demsolve", reason="demsolve: no equilibrium",
                             no_equilibrium={"result.h5": "blocks move"})
        given = [{"given": [friction[run % parameters]]} for run in range(len(rows))]
        values, run = answers.values_of(study, rows, 0)
        others = answers.no_value(study, rows, 0)
        self.assertEqual((list(others.moving), others.undecided), ([0, 3, 14], None))
        found = {name: row for name, *row in answers.statistics(study, study.quantities[0], values, run, None, others)}
        there = np.delete(table.ravel(), [0, 3, 14])
        self.assertEqual(found["mean"][0], 69)
        self.assertAlmostEqual(found["mean"][1], there.mean(), places=12)
        self.assertEqual(found["probability above 0.1, of stable runs"][:2], [69, (there > 0.1).mean()])
        self.assertEqual(found["probability above 0.1 or no equilibrium"][:2], [72, ((there > 0.1).sum() + 3) / 72])
        (_, _, r, _, _), = answers.rank_correlations(study, rows, given, 0)
        self.assertAlmostEqual(r, 1, places=12)
        self.assertIn("warning: floor y (mm): 3 of 72 runs, of 2 networks, have no value; answers are of the other runs\n",
                      answers.summary(study, rows, "", [], []))

    def test_snakemake_that_makes_nothing(self):
        """It removes the empty folder of groups, as after jobs that failed; the message says what is missing."""
        programs = self.folder / "bin"
        programs.mkdir()
        (programs / "snakemake").write_text("#!/bin/sh\nrmdir groups\n")
        (programs / "snakemake").chmod(0o755)
        (self.folder / "config.yaml").write_text("")
        done = subprocess.run([*map(str, self.command(self.written(NETWORKS.format(runs=2)), self.folder / "out", "--snakemake", self.folder))],
                              env={**os.environ, "PATH": f"{programs}:{os.environ['PATH']}"}, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 4, done.stderr)
        self.assertIn("2 of 2 groups of runs in", done.stderr)

    def test_interrupts_after_openturns(self):
        """A call of OpenTURNS puts a handler in the place of Python's, here the system's; Ctrl-C is heard all the same."""
        before = signal.signal(signal.SIGINT, signal.default_int_handler)  # it may be ignored, as in the background of a shell
        self.addCleanup(signal.signal, signal.SIGINT, before)

        @draw_design.calls_openturns
        def replaces_the_handler():
            ctypes.CDLL(None).signal(signal.SIGINT, 0)

        replaces_the_handler()
        with self.assertRaises(KeyboardInterrupt):
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(10)

    def test_lists_of_values_need_no_openturns(self):
        lists = "\n[[vary]]\nname = 'angle'\nkey = 'joint_material.joint.friction_angle_deg'\nvalues = [30, 35, 40, 45]\n"
        missing = unittest.mock.Mock(side_effect=NotWanted("no openturns"))
        for of_design in ("runs = 40", 'kind = "latin hypercube"\nruns = 40', 'kind = "networks x parameters"\nnetworks = 3\nparameters = 12'):
            with self.subTest(of_design), unittest.mock.patch.object(draw_design, "openturns", missing), \
                    unittest.mock.patch.object(answers, "openturns", missing):
                text = NETWORKS.replace("runs = {runs}", of_design) + lists
                study = study_file.read(self.written(text))
                networks, given = draw_design.draw(study)
                self.assertEqual(len(networks), study.design.runs)
                self.assertEqual(len({value for value, in given}), 4)
                if "latin" in of_design:
                    self.assertEqual([[value for value, in given].count(angle) for angle in (30, 35, 40, 45)], [10, 10, 10, 10])
                rows = [{"run": run, "values": [float(value)] * 5} for run, (value,) in enumerate(given)]
                found = answers.rank_correlations(study, rows, [{"given": one} for one in given], 0)
                self.assertEqual([(one[0], round(one[2], 9)) for one in found], [("angle", 1)])
                if of_design == "runs = 40":  # a longer design begins with the shorter one
                    longer = study_file.read(self.written(text.replace("40", "60", 1)))
                    self.assertEqual(draw_design.draw(longer)[1][:40], given)
                    self.assertIn("by numpy", plan.identity(study, "", None, self.chain.programs)["[design]"])
                    self.assertIn("probability above 0.1 mm ", answers.summary(study, [], "", [
                        (study.quantities[0], {"statistics": [("probability above 0.1", 2, 0.5, 0.1, 0.9)]}, [])], []))

    @needs_openturns
    def test_a_study_with_parameters(self):
        """A key of the scene is changed in each run, as by hand; the scene with dates and laws is kept otherwise."""
        text = NETWORKS.format(runs=2) + FRICTION + '\n[[vary]]\nname = "K"\nlaw = "uniform"\nlowest = 0.5\nhighest = 2\n' \
            'multiplies = true\nkey = ["joint_material.joint.normal_stiffness_MPa_per_m", "joint_material.joint.shear_stiffness_MPa_per_m"]\n'
        out = self.made(self.written(text), self.folder / "out")
        for row in rows_of(out):
            factor = float(row["K"])
            scene = SCENE.replace("friction_angle_deg = 35", f"friction_angle_deg = {row['friction']}")
            scene = scene.replace("\nnormal_stiffness_MPa_per_m = 5000", f"\nnormal_stiffness_MPa_per_m = {5000 * factor!r}")
            scene = scene.replace("\nshear_stiffness_MPa_per_m = 2000", f"\nshear_stiffness_MPa_per_m = {2000 * factor!r}")
            joints = self.chain.joints(scene, "--realization", row["network"])
            result = datasets(self.chain.run("demsolve", joints, joints.with_name("r.h5")))
            self.assertEqual(float(row["floor y (mm)"]), 1e3 * result["/history/displacement"][-1, 2, 1])

    @needs_openturns
    def test_directional_sampling(self):
        """Of a plane in the space of two laws, whose probability is known; the estimate has no bias."""
        text = re.sub(r"\[design\]\nruns = .*\n", '[design]\nkind = "directional sampling"\ndirections = 40\nfailure = "failed"\n', NETWORKS)
        study = study_file.read(self.written(text + FRICTION + '\n[[vary]]\nkey = "b"\nlaw = "normal"\nmean = 0\ndeviation = 1\n'))
        at = [one.name for one in study.quantities].index("failed")
        for distance, probability in ((3.0902323, 1e-3), (3.7190165, 1e-4)):
            runs = []

            def run(values, distance=distance, runs=runs):
                runs.append(values)
                fails = (values[0] - 35) / 3 * 0.6 - values[1] * 0.8 > distance
                return {"run": 0, "exit_code": 3 if fails else 0, "values": [1.0 if place == at else None for place in range(at + 1)]
                        if fails else [0.0] * (at + 1), "reason": ""}

            estimates = np.array([failure.estimate(study, replicate, run) for replicate in range(60)])
            value, low, high = failure.probability(estimates)
            with self.subTest(probability):
                self.assertTrue(low <= probability <= high, (low, high))
                self.assertAlmostEqual(value, probability, delta=0.25 * probability)
                plain = probability / (np.std(estimates, ddof=1) ** 2 / len(estimates))
                self.assertGreater(plain, 20 * len(runs))

    @needs_openturns
    def test_directional_sampling_of_runs(self):
        """Of a study, also one that was stopped and goes on."""
        design = '[design]\nkind = "directional sampling"\ndirections = 4\nreplicates = 2\nfailure = "floor y"\n'
        text = re.sub(r"\[design\]\nruns = .*\n", design, NETWORKS) + FRICTION
        study = self.written(text)
        whole = self.made(study, self.folder / "whole")
        self.assertIn("probability of failure", (whole / "answers.csv").read_text())
        self.assertEqual({row["network"] for row in rows_of(whole)}, {"0", "1"})
        out = shutil.copytree(whole, self.folder / "out")
        rows = out / "groups" / "000001.rows"
        lines = rows.read_bytes().splitlines(keepends=True)
        rows.with_name("000001.rows.part").write_bytes(b"".join(lines[:2]))
        rows.unlink()
        self.assert_same(whole, self.made(study, out))

    def test_stop_rule(self):
        """A study ends by its stop rule after the same runs, whether made at once or not. It looks at the rule every 10 runs here."""
        self.enterContext(unittest.mock.patch.object(plan, "BATCH", 10))
        text = NETWORKS.format(runs=30)
        text = text[: text.index("[[collect]]")] + '[[collect]]\nname = "blocks"\nwhat = "blocks"\nstatistic = "number"\n'
        stop = '[stop]\nof = "blocks"\nhalf_width = {}\n'
        width = 2.0
        out = self.made(self.written(text + stop.format(width)), self.folder / "out", "-j2")
        self.assertEqual(len(rows_of(out)), 20)
        values = np.array([float(row["blocks, number" if "blocks, number" in row else "blocks"]) for row in rows_of(out)])
        halves = [np.diff(intervals.mean(values[:end])[1:3])[0] / 2 for end in (10, 20)]
        self.assertGreater(halves[0], width)
        self.assertLess(halves[1], width)
        self.made(self.written(text), out)
        self.assertEqual(len(rows_of(out)), 30)
        self.made(self.written(text + stop.format(width)), out)
        self.assertEqual(len(rows_of(out)), 20)

        # The budget of time: the end says nothing of processes that are ended.
        slow = self.programs('case "$PWD" in */timed/work/*) exec sleep 20 ;; esac', "jointgen")
        done = self.study(self.written(text + "[stop]\nhours = 2e-4\n"), self.folder / "timed", programs=slow)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertEqual(done.stderr, "")

        # Runs behind one that has not ended do not count; summary and report say which one that is.
        slow = self.programs('case "$PWD" in */late/work/000001*) exec sleep 60 ;; esac', "jointgen")
        done = self.study(self.written(text + "[stop]\nhours = 1.5e-3\n"), self.folder / "late", "-j2", programs=slow)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"\nruns +1 of 30, ended after the 0.0015 hours of the budget; \d+ more, behind run 1, which has not ended")
        done = self.chain.jointcreep("report", self.folder / "late", "-o", self.folder / "page.html")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("<td>ended</td><td>after the 0.0015 hours of the budget; ", (self.folder / "page.html").read_text())

    def test_axes_of_parameters(self):
        """Logarithmic for a parameter that varies by more than a factor of eight."""
        study = study_file.read(self.written(NETWORKS.format(runs=3) + (
            '[[vary]]\nname = "{}"\nkey = "joint_material.joint.{}"\nvalues = {}\n' * 2).format(
                "stiffness", "normal_stiffness_MPa_per_m", [1000, 2000, 9000], "friction", "friction_angle_deg", [10, 20, 80])))
        given = [{"given": values} for values in ([1000, 10], [2000, 20], [9000, 80])]
        for quantity in study.quantities[0], study.quantities[-1]:
            picture = pictures.parameters(quantity, study, np.array([1.0, 0.0, 1.0]), [0, 1, 2], given, [])
            self.assertEqual([axes.get_xscale() for axes in picture.axes], ["log", "linear"], quantity.name)
            plots.figure.plt.close(picture)
        for largest in 9e3, 1e5, 1e7, 1e9, 1e12:  # some labels, and none over another
            given = [{"given": values} for values in ([1000, 10], [2000, 20], [largest, 80])]
            picture = pictures.parameters(study.quantities[0], study, np.array([1.0, 0.0, 1.0]), [0, 1, 2], given, [])
            picture.canvas.draw()
            axes, renderer = picture.axes[0], picture.canvas.get_renderer()
            low, high = axes.get_xlim()
            boxes = [label.get_window_extent(renderer) for place, label in zip(axes.get_xticks(), axes.get_xticklabels()) if low <= place <= high]
            self.assertIn(len(boxes), range(2, 8), largest)
            self.assertTrue(all(one.x1 < other.x0 for one, other in zip(boxes, boxes[1:])), largest)
            plots.figure.plt.close(picture)


LEVELS = """
scene = "scene.toml"

[[vary]]
network = true

[design]
kind = "two levels"
fine_runs = {fine}
coarse_per_fine = 3
fine_options = ["--zone-size", "2.5"]
coarse_options = ["--zone-size", "9", "--no-creep"]

[[collect]]
name = "floor"
what = "displacement"
point = "floor"
component = "y"
above = [0.1]
"""


def by_straight_lines(fine, control):
    """Mean of fine values less the control times the slope of the straight line through all other pairs, and its standard error."""
    others = [np.arange(len(fine)) != place for place in range(len(fine))]
    left = [value - np.polyfit(control[other], fine[other], 1)[0] * one for value, one, other in zip(fine, control, others)]
    return np.mean(left), np.std(left, ddof=1) / np.sqrt(len(fine))


class TwoLevels(Studies):
    def test_by_the_programs(self):
        """Runs have the zones and networks that they should, and the mean is that of straight lines through them."""
        out = self.made(self.written(LEVELS.format(fine=5)), self.folder / "out", "-j2")
        rows = rows_of(out)
        self.assertEqual([row["level"] for row in rows], ["fine", "coarse", "coarse", "coarse"] * 5)
        self.assertEqual([int(row["network"]) for row in rows[:8]], [0, 0, 1, 2, 3, 3, 4, 5])
        for row, options in ((rows[4], ["--zone-size", "2.5"]), (rows[6], ["--zone-size", "9", "--no-creep"])):
            joints = self.chain.joints(SCENE, "--realization", row["network"])
            result = datasets(self.chain.run("demsolve", joints, joints.with_name("r.h5"), *options))
            self.assertEqual(float(row["floor (mm)"]), 1e3 * result["/history/displacement"][-1, 2, 1])
        table = np.array([float(row["floor (mm)"]) for row in rows]).reshape(5, 4)
        fine, coarse = table[:, 0], table[:, 1:]
        wanted, error = by_straight_lines(fine, coarse.mean(axis=1) - coarse[:, 0])
        with open(out / "answers.csv", encoding="utf-8") as file:
            found = {row["statistic"]: row for row in csv.DictReader(file)}
        self.assertAlmostEqual(float(found["mean"]["value"]), wanted, delta=1e-9 * abs(wanted))
        self.assertAlmostEqual(float(found["mean"]["high"]) - wanted, 3.1824463 * error, delta=1e-6 * error)  # Student's, 3 degrees
        self.assertAlmostEqual(float(found["mean of fine runs alone"]["value"]), fine.mean(), delta=1e-9)
        self.assertAlmostEqual(float(found["fine less coarse"]["value"]), (fine - coarse[:, 0]).mean(), delta=1e-9)
        self.assertAlmostEqual(float(found["correlation of fine and coarse"]["value"]), np.corrcoef(fine, coarse[:, 0])[0, 1], delta=1e-9)
        self.assertEqual(found["mean"]["runs"], "5")
        with open(out / "costs.csv", encoding="utf-8") as file:
            (cost,) = csv.DictReader(file)
        self.assertGreater(float(cost["fine_seconds"]), 0)
        more = self.made(self.written(LEVELS.format(fine=6)), out)
        self.assertEqual(rows_of(more)[:20], rows)
        self.assert_same(self.made(self.folder / "study.toml", self.folder / "at once"), more)

    def test_intervals(self):
        """The mean is not biased, its interval covers, and it is as much narrower as the correlation says: over 1000 studies of a
        known law, without the solver."""
        n, fine_runs, per_fine, r = 1000, 30, 8, 0.95
        study = study_file.read(self.written(LEVELS.format(fine=fine_runs).replace("coarse_per_fine = 3", f"coarse_per_fine = {per_fine}")))
        chance, estimates, hits, halves, alone = np.random.default_rng(5), [], 0, [], []
        for _ in range(n):
            coarse = chance.normal(size=(fine_runs, per_fine))
            fine = 7 + 3 * (r * coarse[:, 0] + np.sqrt(1 - r * r) * chance.normal(size=fine_runs))
            values = np.concatenate([fine[:, None], 50 + coarse], axis=1).ravel()
            rows = [{"run": run, "values": [value]} for run, value in enumerate(values)]
            found, run = answers.values_of(study, rows, 0)
            self.assertEqual(list(found), list(fine))
            value, low, high, _ = answers.mean_with_interval(study, found, run, answers.coarse_of(study, rows, 0, run))
            estimates.append(value)
            halves.append((high - low) / 2)
            alone.append(np.std(fine, ddof=1) / np.sqrt(fine_runs))
            hits += low <= 7 <= high
        self.assertLess(abs(np.mean(estimates) - 7), 4 * np.std(estimates) / np.sqrt(n))
        self.assertAlmostEqual(hits / n, 0.95, delta=4 * np.sqrt(0.95 * 0.05 / n))
        wanted = 3 * np.sqrt((1 - r * r * (1 - 1 / per_fine)) / fine_runs)
        self.assertAlmostEqual(np.std(estimates) / wanted, 1, delta=0.12)
        self.assertAlmostEqual(np.mean(halves) / (2.048407 * wanted), 1, delta=0.05)  # Student's, 28 degrees
        self.assertLess(np.std(estimates), 0.5 * np.mean(alone))

    def test_no_bias(self):
        """Of a skewed law too: beside the estimate with the true factor, which has none, over 2000 studies."""
        chance, more = np.random.default_rng(6), []
        for _ in range(2000):
            normal = chance.normal(size=(20, 6))
            coarse = np.exp(0.3 * normal)
            fine = np.exp(0.33 * normal[:, 0]) * (1 + 0.05 * chance.normal(size=20))
            control = coarse.mean(axis=1) - coarse[:, 0]
            more.append(intervals.mean_by_control(fine, control)[0] - (fine + 1.16 * control).mean())
        self.assertLess(abs(np.mean(more)), 4 * np.std(more) / np.sqrt(2000))

    def test_runs_without_a_value(self):
        """A fine run counts with the coarse one of its network; other coarse runs that are missing leave the rest of the block."""
        study = study_file.read(self.written(LEVELS.format(fine=4)))
        rows = [{"run": run, "values": [float(run)]} for run in range(14)]  # the last block is not whole
        rows[4]["values"] = rows[2]["values"] = [None]
        values, run = answers.values_of(study, rows, 0)
        self.assertEqual((list(values), list(run)), ([0.0, 8.0], [0, 8]))
        self.assertEqual(answers.coarse_of(study, rows, 0, run).tolist(), [[1.0, 2.0], [9.0, 10.0]])
        rows[1]["values"] = [None]
        self.assertEqual(list(answers.values_of(study, rows, 0)[1]), [8])

    def test_stop_rule(self):
        text = LEVELS.format(fine=40).replace("--no-creep", "--creep-step=5") + '[stop]\nof = "floor"\nrelative_half_width = 0.2\n'
        out = self.made(self.written(text), self.folder / "out", "-j2")
        with open(out / "answers.csv", encoding="utf-8") as file:
            mean = next(row for row in csv.DictReader(file) if row["statistic"] == "mean")
        self.assertLess((float(mean["high"]) - float(mean["low"])) / 2, 0.2 * float(mean["value"]))
        self.assertEqual((len(rows_of(out)), mean["runs"]), (50, "12"))  # twelve blocks of four, and two runs
        with open(out / "convergence.csv", encoding="utf-8") as file:
            self.assertEqual([row["runs"] for row in csv.DictReader(file) if row["statistic"] == "mean"], ["10", "11", "12"])
        study = study_file.read(self.folder / "study.toml")
        rows = [{"run": run, "values": [5 + 1e-6 * (run * 7 % 5)]} for run in range(40)]
        self.assertFalse(answers.enough(study, rows[:39]))  # nine blocks, whose mean is known well enough by chance
        self.assertTrue(answers.enough(study, rows))

    def test_messages(self):
        good = LEVELS.format(fine=5)
        for text, expected in [
            (good.replace("coarse_per_fine = 3", "coarse_per_fine = 1"), "coarse_per_fine is 1; expected a whole number from 2 to"),
            (good.replace("fine_runs = 5\n", "", 1), "fine_runs is missing"),
            (good.replace('["--zone-size", "2.5"]', "[]"), r"fine_options is \[\]; expected a list of options"),
            (good.replace('"9", "--no-creep"', '"2.5"'), 'coarse_options is .* expected others than fine_options'),
            (good.replace('"--no-creep"', '"--output=a"'), "expected options without --output=a"),
            (good.replace('kind = "two levels"\n', "runs = 4\n"), "fine_runs is unknown here"),
            (good.replace("\n[[vary]]", "histories = true\n[[vary]]", 1), 'histories is True; expected false, because the design is "two levels"'),
        ]:
            with self.subTest(expected):
                self.refused(text, expected)


class FactorOfSafety(Studies):
    def test_of_a_block_on_a_plane(self):
        """The factor of each run is that of demsolve, and holds the closed form: cos b tan(phi) / sin b of the plane's dip b, here also
        with cohesion c: (c + cos b tan(phi)) / sin b for a load of 1 MPa."""
        shutil.copy(self.chain.source / "data/verification/incline/scene.toml", self.folder / "scene.toml")
        scene = (self.folder / "scene.toml").read_text()
        text = ('scene = "scene.toml"\ndemsolve_options = ["--no-creep"]\n[[vary]]\nname = "phi"\n'
                'key = "joint_material.joint.friction_angle_deg"\nvalues = [28, 33, 40]\n[[vary]]\nname = "c"\n'
                'key = "joint_material.joint.cohesion_MPa"\nvalues = [0, 0.05]\n[design]\nruns = 4\n[[collect]]\nname = "F"\n'
                'what = "factor of safety"\nbelow = [1.4]\n')
        out = self.made(self.written(text), self.folder / "out", "-j2")
        rows, dip = rows_of(out), np.radians(25)
        self.assertGreater(len({(row["phi"], row["c"]) for row in rows}), 1)
        for row in rows:
            phi, c, factor = (float(row[name]) for name in ("phi", "c", "F, lower end"))
            true = (c + np.cos(dip) * np.tan(np.radians(phi))) / np.sin(dip)
            self.assertTrue(factor <= true < 1.011 * factor, (factor, true))
            self.assertTrue(true <= float(row["F, upper end"]) <= 1.0101 * factor, (row, true))
        row = rows[0]
        changed = re.sub(r"(?m)^friction_angle_deg = .*", f"friction_angle_deg = {row['phi']}", scene)
        changed = re.sub(r"(?m)^cohesion_MPa = .*", f"cohesion_MPa = {row['c']}", changed)
        joints = self.chain.joints(changed)
        safety = datasets(self.chain.run("demsolve", joints, joints.with_name("s.h5"), "--no-creep", "--factor-of-safety"))
        self.assertEqual(float(row["F, lower end"]), safety["/safety/factor"][safety["/safety/stands"] == 1].max())
        with open(out / "answers.csv", encoding="utf-8") as file:
            below = next(one for one in csv.DictReader(file) if one["statistic"] == "probability below 1.4")
        self.assertEqual(float(below["value"]), sum(float(one["F, lower end"]) < 1.4 for one in rows) / 4)


@unittest.skipUnless(shutil.which("snakemake"), "snakemake is not installed: sh pipelines/setup.sh studies")
class BySnakemake(Studies):
    def profile(self, name):
        return self.chain.source / "pipelines" / "studies" / "profiles" / name

    def test_on_this_machine(self):
        study = self.written(NETWORKS.format(runs=6))
        self.assert_same(self.made(study, self.folder / "whole"),
                         self.made(study, self.folder / "out", "-j2", "--snakemake", self.profile("local")))

    @unittest.skipUnless(all(map(shutil.which, ("slurmctld", "slurmd", "munged", "sbatch"))) and os.getuid() == 0 and
                         os.path.ismount("/sys/fs/cgroup"),
                         "no Slurm here (apt-get install slurm-wlm munge), not root, or /sys/fs/cgroup is not mounted")
    def test_on_slurm(self):
        """On one node, by a Slurm of this test."""
        script, folder = self.chain.source / "pipelines" / "studies" / "one_node_slurm.sh", self.folder / "slurm"
        study = self.written(NETWORKS.format(runs=6))
        whole = self.made(study, self.folder / "whole")
        started = subprocess.run(["sh", script, "start", folder], capture_output=True, text=True, timeout=60)
        try:
            self.assertEqual(started.returncode, 0, started.stderr)
            os.environ["SLURM_CONF"] = str(folder / "slurm.conf")
            out = self.made(study, self.folder / "out", "-j4", "--snakemake", self.profile("slurm"))
            self.assert_same(whole, out)
        finally:
            os.environ.pop("SLURM_CONF", None)
            subprocess.run(["sh", script, "stop", folder], timeout=60)


class Reports(Studies):
    def report(self, source, name="report.html"):
        done = self.chain.jointcreep("report", source, "-o", self.folder / name)
        self.assertEqual(done.returncode, 0, done.stderr)
        page = (self.folder / name).read_text()
        self.assertNotRegex(page, r"(src|href)=.(?!data:)")  # it needs no other file
        self.assertNotIn("Not drawn", page)
        for picture in re.findall(r'src="data:image/png;base64,([^"]*)"', page):
            self.assertEqual(base64.b64decode(picture)[:4], b"\x89PNG")
        return page

    def test_of_a_run(self):
        joints = self.chain.joints(SCENE.replace("[section]", 'title = "A <b>ench & more"\n[section]', 1))
        page = self.report(self.chain.run("demsolve", joints, joints.with_name("r.h5")))
        self.assertIn("<h1>A &lt;b&gt;ench &amp; more</h1>", page)
        self.assertRegex(page, r"jointverify: verified: (\d+) checks of \1<")
        self.assertGreaterEqual(page.count("<img"), 7)
        self.assertIn("excavated; its last displacement", page)
        self.check_displacements(page, joints.with_name("r.h5"))
        for row in ("<td>normal stiffness</td><td>MPa/m</td>", "<td>Young&#x27;s modulus E</td><td>GPa</td>",
                    "<td>spacing</td><td>", "<h3>Joint sets</h3>"):
            self.assertIn(row, page)
        self.assertLess(page.index("<h2>Materials and joint sets</h2>"), page.index("<h2>Scene</h2>"))
        self.check_units(page, joints.with_name("r.h5"))

    def check_displacements(self, page, result):
        """The table by stage has the displacements [mm] of each point after each stage and in the end."""
        data = datasets(result)
        part = page[page.index("Displacements of the points by stage"):]
        part = part[:part.index("</table>")]
        names, events = list(data["/history/point"]), list(data["/history/event"])
        point = names.index("floor")
        for stage, row in [*((stage, at) for at, stage in enumerate(events) if stage), ("end of the run", -1)]:
            x, y = 1e3 * data["/history/displacement"][row, point]
            self.assertRegex(part, f"<td>{stage}</td><td>[^<]*</td><td>floor</td>" + re.escape(
                f'<td class="number">{x:.4g}</td><td class="number">{y:.4g}</td><td></td>'))
        self.assertEqual(part.count("<td>dug away</td>"), 1)

    def check_units(self, page, result):
        """The table of checks has whatever jointverify says, with whole units."""
        done = subprocess.run([self.chain.programs / "jointverify", result], capture_output=True, text=True)
        part = page[page.index("<h2>Checks</h2>"):]
        part = html.unescape(part[:part.index("<h2>Versions</h2>")])
        for unit in re.findall(r"\d (N/m|J/m|Pa|m2)\b", done.stdout):
            self.assertIn(f" {unit}</td>", part)
        for line in done.stdout.splitlines()[1:]:
            for field in re.split(r"\s{2,}", line.strip(), maxsplit=5):
                self.assertTrue(f">{field}<" in part or field in part, field)

    def test_of_every_key(self):
        """The tables of rocks and joints have all values of a scene that has every key."""
        scene = tomllib.loads(self.chain.text("tests/pipeline/every_key.toml"))
        found = {heading: (heads, rows) for heading, heads, rows in materials.tables(scene)}
        self.assertEqual(list(found), ["Rocks", "Joint materials", "Joint sets", "Mapped joint sets", "Single joints"])
        heads, rows = found["Joint materials"]
        self.assertIn(("Kelvin unit 1: normal stiffness", "MPa/m", "", 900), [row[:4] for row in rows])
        self.assertIn(("normal Kelvin viscosity", "MPa day/m", 1e5), [row[:3] for row in rows])
        heads, rows = found["Joint sets"]
        at = heads.index("flat")
        wanted = {"trace angle": "normal, mean 10 degrees, standard deviation 2 degrees", "persistence": "0.8",
                  "region": "(0, 5), (40, 5), (40, 20), (0, 20) m"}
        self.assertEqual(wanted, {row[0]: row[at] for row in rows if row[0] in wanted})
        for heads, rows in found.values():
            for row in rows:
                self.assertEqual(len(row), len(heads))
                self.assertFalse([one for one in row if isinstance(one, (dict, list))], row)
                self.assertNotRegex(" ".join(map(str, row)), r"_(m|deg|MPa|per|GPa|mm)\b|[{}\[\]]")

    def test_relative_displacements(self):
        """Closure and relative displacement of pairs of points: of all, or of those that are asked for."""
        joints = self.chain.joints(SCENE)
        result = self.chain.run("demsolve", joints, joints.with_name("r.h5"))
        data = datasets(result)
        names, moves = list(data["/history/point"]), data["/history/displacement"]
        one, other = names.index("crest"), names.index("floor")
        before = data["/history/point_position"][one] - data["/history/point_position"][other]
        relative = (moves[:, one] - moves[:, other])[-1]
        closure = np.linalg.norm(before) - np.linalg.norm(before + relative)
        row = "".join(f'<td class="number">{value:.4g}</td>' for value in (1e3 * closure, *1e3 * relative))
        page = self.report(result)
        self.assertIn("<td>crest</td><td>floor</td>", page)
        self.assertIn(row, page)
        self.assertIn('alt="Closure of pairs of points."', page)
        table = page[page.index("Relative displacements"):page.index("Closure of pairs of points.")]
        self.assertRegex(table, "<tr><td></td><td>day 2</td>(?:(?!<tr>).)*<td>one of them is excavated next</td>")
        stages = re.findall(r"<tr><td>([^<]*)</td><td>[^<]*</td><td>crest</td><td>floor</td>", table)
        self.assertEqual(stages, [*filter(None, data["/history/event"]), "end of the run"])
        drawn = plots.draw("histories", result, pair=[("crest", "floor")]).axes[0].lines[0].get_ydata()
        self.assertAlmostEqual(drawn[-1], 1e3 * closure, places=12)
        for pairs, code in (("floor,crest", 0), ("floor,none", 2), ("floor", 2), (" ; ", 2), ("floor,floor", 2)):
            done = self.chain.jointcreep("report", result, "--pairs", pairs, "-o", self.folder / "p.html")
            self.assertEqual(done.returncode, code, done.stderr)
        page = (self.folder / "p.html").read_text()
        self.assertIn("<td>floor</td><td>crest</td>", page)
        self.assertNotIn("<td>crest</td><td>floor</td>", page)

    def test_of_a_study(self):
        out = self.made(self.written(NETWORKS.format(runs=12)), self.folder / "out")
        page = self.report(out)
        with open(out / "answers.csv", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                if row["statistic"] == "mean":
                    self.assertIn(f">{float(row['value']):.4g}<", page)
        self.assertGreaterEqual(page.count("<img"), 6)
        self.assertIn("in 12 of 12 runs", page)

    def test_values_that_vary(self):
        """Each value that a parameter changes is marked, with its values in the runs in place of the scene's."""
        vary = '[[vary]]\nname = "stiffness & more"\nmultiplies = true\nvalues = [2, 10, 5]\nkey = ["joint_material.joint.normal_stiffness_MPa_per_m", ' \
            '"joint_material.joint.shear_stiffness_MPa_per_m"]\n[[vary]]\nname = "spacing"\nkey = "joint_set.steep.spacing.mean_m"\n' \
            'values = [5, 7]\n[[vary]]\nkey = "zones.size_m"\nvalues = [4, 5]\n'
        page = self.report(self.made(self.written(NETWORKS.format(runs=2) + vary), self.folder / "out"))
        part = page[page.index("<h2>Materials and joint sets</h2>"):]
        part = html.unescape(part[:part.index("<h2>Study file</h2>")])
        self.assertIn('<td>normal stiffness</td><td>MPa/m</td><td>varies by "stiffness & more": 10000 to 50000</td>', part)
        self.assertIn('<td>shear stiffness</td><td>MPa/m</td><td>varies by "stiffness & more": 4000 to 20000</td>', part)
        self.assertIn('mean varies by "spacing": 5 to 7 m, standard deviation 2 m', part)
        self.assertIn('<td>friction angle</td><td>degrees</td><td class="number">35</td>', part)
        self.assertIn("change from run to run", part)
        self.assertIn('<td>zones</td><td>size_m</td><td>varies by "zones.size_m": 4 to 5</td>', html.unescape(page))
        self.assertIn('<td>spacing</td><td>joint_set.steep.spacing.mean_m</td><td class="number">6</td><td>5 to 7</td>', page)

    def test_long_lists(self):
        """Of numbers, in the study file of a report."""
        numbers = [str(1 + 0.01 * ((7 * n) % 100)) for n in range(100)]
        long = "values = [" + ", ".join(numbers[:40]) + ",  # and, so on\n" + ",\n  ".join(numbers[40:]) + ",\n]\n"
        for text, shown in ((long, "values = [100 values, 1 to 1.99]\n"), ("values = [1, 2, 3]\n[design]\n", None),
                            ('keep = ["result.h5"]\nvalues = [' + '"a", ' * 20 + "]\n", None)):
            parts = report.study_text("[[vary]]\n" + text)
            self.assertEqual(html.unescape(parts[-1]), f"<pre>[[vary]]\n{shown or text}</pre>")
            self.assertEqual(len(parts), 2 if shown else 1)

    def test_values_in_runs(self):
        study = NETWORKS.format(runs=2) + "[[vary]]\nkey = 'a'\n"
        for law, value, words in (("values = ['x', 'y', 'x']", "x", "x or y"), ("values = [0.5, 2]\nmultiplies = true", -3, "-6 to -1.5"),
                                  ("law = 'uniform'\nlowest = 1\nhighest = 2\nmultiplies = true", 1000, "1000 to 2000"),
                                  ("law = 'triangular'\nlowest = 1\nmost_likely = 2\nhighest = 4", 9, "1 to 4"),
                                  ("law = 'normal'\nmean = 1\ndeviation = 0.1\nmultiplies = true", 50, "normal, mean 50, standard deviation 5"),
                                  ("law = 'lognormal'\nmean = 2\ndeviation = 1\nlowest = 0.5", 9, "lognormal, mean 2, standard deviation 1, at least 0.5"),
                                  ("law = 'normal'\nmean = 1\ndeviation = 1\nlowest = 0.5\nmultiplies = true", -2,
                                   "normal, mean -2, standard deviation 2, at most -1"),
                                  ("law = 'normal'\nmean = 2\ndeviation = 1\nlowest = 0.5\nhighest = 3", 9,
                                   "normal, mean 2, standard deviation 1, at least 0.5, at most 3")):
            with self.subTest(words):
                (parameter,) = study_file.read(self.written(study + law)).parameters
                self.assertEqual(materials.in_runs(parameter, value), words)

    def test_of_several_with_notes(self):
        """One page, in the order of the command line; what comes first is text."""
        joints = self.chain.joints(SCENE.replace("[section]", 'title = "The bench"\n[section]', 1))
        result = self.chain.run("demsolve", joints, joints.with_name("r.h5"))
        out = self.made(self.written('title = "Three networks"\n' + NETWORKS.format(runs=3)), self.folder / "out")
        notes, made = self.folder / "notes.txt", self.folder / "all.html"
        notes.write_text("# Summary\n\nThe slope <stands>\nwith both cohesions.\n\n- first\n- second & last\n")
        words = ["report", out, result, "-o", made, "--notes", notes]
        done = self.chain.jointcreep(*words)
        self.assertEqual(done.returncode, 0, done.stderr)
        page = made.read_text()
        self.assertNotRegex(page, r"(src|href)=.(?!data:)")
        at = [page.index(text) for text in ("<h1>Report of 2 results</h1>", "<h2>Summary</h2>", "<p>The slope &lt;stands&gt; with both cohesions.</p>",
                                            "<ul><li>first</li><li>second &amp; last</li></ul>", "<ol><li>Three networks</li><li>The bench</li></ol>",
                                            "<h1>1. Three networks</h1>", "<h2>Answers</h2>", "<h1>2. The bench</h1>", "<h2>Histories</h2>")]
        self.assertEqual(at, sorted(at))
        notes.write_bytes(b"\xff\xfe")
        for more, expected in ((["-o", notes, "--notes", notes], "a file that is read"), (["-o", result], "a file that is read"),
                               (["-o", made, "--notes", notes], "is no text in UTF-8"), (["-o", made, "--pairs", "crest,floor"], "is for result files")):
            done = self.chain.jointcreep(*words[:3], *more)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(expected, done.stderr)
        self.assertEqual(made.read_text(), page)

    def test_refusals(self):
        for source, code in ((self.folder / "scene.toml", 2), (self.folder, 2), (self.folder / "none.h5", 4),
                             (self.chain.network(SCENE), 2)):
            done = self.chain.jointcreep("report", source, "-o", self.folder / "r.html")
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertRegex(done.stderr, "^jointcreep: ")
            self.assertFalse((self.folder / "r.html").exists())


class FactorsOfSafety(Studies):
    """Answers of factors of safety, which are known by brackets and bounds only."""

    def answers_of(self, brackets, **more):
        """Answers of a study of these brackets {lower end, upper end}, by statistic of the lower end; and its folder."""
        text = NETWORKS.split("[[collect]]")[0].format(runs=len(brackets)) + '[[collect]]\nname = "F"\nwhat = "factor of safety"\n' \
            'above = [2]\nbelow = [1.4]\n'
        study, out = study_file.read(self.written(text)), self.chain.new_folder()
        rows = [{"run": run, "network": run, "exit_code": 0, "program": "", "reason": "", "values": list(ends), "warnings": [],
                 "no_equilibrium": {}}
                for run, ends in enumerate(brackets)]
        given = {row["run"]: {"run": row["run"], "network": row["run"], "given": []} for row in rows}
        found = answers.write(study, rows, given, "", [], [], out)
        pictures.write(study, rows, given, found, out)
        with open(out / "answers.csv", encoding="utf-8") as file:
            return {row["statistic"]: row for row in csv.DictReader(file) if row["quantity"] == "F, lower end"}, out

    def test_equal_brackets(self):
        """The scatter is only known to be less than the width of the brackets."""
        found, out = self.answers_of([(1.5, 1.53125)] * 12)
        self.assertNotIn("standard deviation", found)
        for name in "standard deviation, less than", "standard error of the mean, less than":
            self.assertEqual((found[name]["value"], found[name]["low"]), ("0.03125", ""))
        self.assertEqual((found["mean"]["value"], found["mean"]["low"], found["mean"]["high"]), ("1.5", "", ""))
        self.assertRegex((out / "summary.txt").read_text(), "standard deviation, less than +12 +0.03125\n")
        self.assertEqual(found["probability below 1.4"]["value"], "0.0")
        found, _ = self.answers_of([(1.5, 1.53125)] * 11 + [(1.53125, 1.5625)])
        self.assertGreater(float(found["standard deviation"]["value"]), 0)

    def test_bounds(self):
        """A run that is stable at 64 is in no mean; it is above all limits, and above all other values."""
        brackets = [(1 + 0.1 * n, 1.05 + 0.1 * n) for n in range(10)]
        found, out = self.answers_of([*brackets, (64.0, None), (64.0, None)])
        lower = [low for low, _ in brackets]
        self.assertAlmostEqual(float(found["mean"]["value"]), np.mean(lower), places=12)
        self.assertAlmostEqual(float(found["standard deviation"]["value"]), np.std(lower, ddof=1), places=12)
        self.assertEqual((found["mean"]["runs"], found["quantile 0.5"]["runs"]), ("10", "12"))
        self.assertAlmostEqual(float(found["quantile 0.5"]["value"]), 1.55, places=12)
        self.assertEqual(found["quantile 0.95"]["value"], "")
        for name, count in (("probability above 2", 2), ("probability below 1.4", sum(low < 1.4 for low in lower))):
            self.assertEqual((found[name]["runs"], float(found[name]["value"])), ("12", count / 12))
        summary = (out / "summary.txt").read_text()
        self.assertIn("F, lower end, 10 runs with a value, and 2 at least 64\n", summary)
        self.assertIn("F, lower end: at least 64, the largest factor that is tried, in 2 of 12 runs: 10, 11; they are not in mean", summary)
        self.assertIn("F, upper end: at least 64, the largest factor that is tried, in 2 of 12 runs", summary)
        self.assertEqual(len(re.findall("probability above 2 +12 ", summary)), 2)
        self.assertTrue((out / "F-distribution.png").exists())
        found, out = self.answers_of([(64.0, None)] * 3)
        self.assertEqual((found["probability below 1.4"]["value"], found["quantile 0.5"]["value"]), ("0.0", ""))
        self.assertNotIn("mean", found)
        self.assertIn("F, lower end, 0 runs with a value, and 3 at least 64\n", (out / "summary.txt").read_text())


class StudyFile(Studies):
    def test_messages(self):
        """What is wrong is refused by file, line, key and value."""
        good = NETWORKS.format(runs=3)
        cases = [
            (good.replace("runs = 3", "runs = 1"), r"study\.toml, line 8: \[design\]: runs is 1; expected a whole number from 2 to"),
            (good.replace("runs = 3", 'runs = "many"'), r'runs is "many"; expected a whole number'),
            (good.replace("runs = 3", ""), r"line 7: \[design\]: runs is missing; expected a whole number"),
            (good.replace("runs = 3", "runs = 3\nseeds = 4"), r"line 9: \[design\]: seeds is unknown here"),
            (good.replace("runs = 3", 'runs = 3\nkind = "poor"'), r'kind is "poor"; expected one of "plain", "latin hypercube"'),
            (good.replace('point = "floor"', 'point = "flor"', 1), r'line 10: \[\[collect\]\]: point is "flor"; expected one that the '
             "scene has: crest, dug away, floor"),
            ('keep = ["safety.h5"]\n' + good, r"keep is .*safety\.h5.*; expected a \[\[collect\]\] with what = \"factor of safety\""),
            (good.replace('"bench"', '"banch"'), r'stage is "banch"; expected one that the scene has: bench'),
            (good.replace('stage = "bench"', "date = 2000-01-01"), "2000-01-01 is a date, and the scene's schedule has numbers of days"),
            (good.replace('stage = "bench"', "date = 11"), "date is 11; expected one within the scene's schedule"),
            (good.replace("above = [0.1]", "above = 0.1"), r"line 14: .*above is 0\.1; expected a list of numbers"),
            (good.replace("above = [0.1]", "above = [nan]"), r"above is \[nan\]; expected a list of numbers"),
            (good.replace('"of the point dug away"', '"floor y"'), 'name "floor y" is there twice'),
            (good.replace('"of the point dug away"', '"run"'), 'name "run" is the name of a column that every study has'),
            (good.replace("network = true", "network = 1"), "line 5: .*network is 1; expected true or false"),
            (good.replace("[[vary]]", "[vary]"), r"vary is not a table; expected \[\[vary\]\]"),
            (good + "[stop]\nhalf_width = 0.1\n", r'of is missing; expected one of "floor y"'),
            (good + '[stop]\nof = "floor y"\nhalf_width = -1\n', "half_width is -1; expected a number above 0"),
            (good + '[stop]\nhours = 1\nof = "floor y"\n', "of needs half_width, relative_half_width or probability_half_width"),
            (good + '[stop]\nhours = 1\nminutes = 1\n', "minutes is unknown here"),
            (good.split("[[collect]]")[0], "nothing is collected"),
            (good.replace("network = true", ""), r"\[\[vary\]\]: key is missing; expected a key of the scene"),
            (good.replace("network = true", "network = false\nkey = 'x.y'"), r"law is missing; expected one of .normal"),
            (good.replace("runs = 3", "rums = 3"), r"line 7: \[design\]: runs is missing \(and rums is unknown\); expected a whole"),
            (good.replace("runs = 3", 'kind = "two levels"\nfine_options = ["--no-creep"]'), "fine_runs is missing; expected a whole number"),
            (good + 'a = [', "study.toml: "),
        ]
        for text, expected in cases:
            with self.subTest(expected):
                self.refused(text, expected)

    def test_keys_of_the_scene(self):
        good = NETWORKS.format(runs=3)
        for key, expected in [
            ("joint_material.jont.friction_angle_deg", 'joint_material has no "jont"; it has: joint'),
            ("joint_material.joint.friction", 'joint has no "friction"; it has: name, normal_stiffness'),
            ("section.rock", r'"section.rock" is "rock" in the scene; expected a number'),
            ("section.", "is not a path of keys"),
            ("boundary.4.fix", 'boundary has no "4"; it has: 1, 2, 3'),
        ]:
            with self.subTest(key):
                self.refused(good + FRICTION.replace("joint_material.joint.friction_angle_deg", key), expected)
        for line, expected in [("deviation = 0", "deviation is 0; expected more than 0"), ("mean = inf", "mean is inf; expected a"),
                               ("lowest = 40\nhighest = 30", "highest is 30; expected more than lowest")]:
            with self.subTest(line):
                key = line.split()[0]
                self.refused(good + re.sub(rf"(?m)^{key} = .*\n", "", FRICTION) + line, expected)

    def named(self, variables, key, formula):
        """A study of the small scene, in which a key has a formula."""
        scene = re.sub(rf"(?m)^{key} = .*$", f'{key} = "{formula}"', self.chain.small())
        self.assertIn(formula, scene)
        (self.folder / "named.toml").write_text(f"{scene}\n[variables]\n{variables}\n")
        return re.sub(r'(?m)^scene = .*$', 'scene = "named.toml"', NETWORKS.format(runs=3))

    def test_formulas(self):
        """Names of [variables] vary if they are numbers, and keys that are formulas do not vary beside them."""
        study = self.named('phi = "2 * half"\nhalf = 15', "friction_angle_deg", "phi + 0")
        vary = "\n[[vary]]\nname = '{}'\nkey = '{}'\nvalues = [20, 30]\n"
        self.refused(study + vary.format("phi", "variables.phi"), '"variables.phi" is the formula "2 \\* half" in the scene; expected a number')
        self.refused(study + vary.format("half", "variables.half") + vary.format("friction", "joint_material.joint.friction_angle_deg"),
                     'is the formula "phi \\+ 0" in the scene')
        self.refused(study + vary.format("h", "variables.third"), '"variables.third": variables has no "third"')

    def test_the_folder_stays_clean(self):
        self.refused(NETWORKS.format(runs=1), "runs is 1")
        self.assertFalse((self.folder / "refused").exists())
        self.refused(NETWORKS.format(runs=3).replace('"bench"', '"last"'), 'stage is "last"; expected')  # seen with the scene
        self.assertFalse((self.folder / "refused").exists())

    def test_command_line(self):
        for name in ("run", "study", "report", "fit"):
            done = subprocess.run([self.chain.programs / "jointcreep", name, "--help"], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertIn(f"usage: jointcreep {name} ", done.stdout)
        for arguments, expected in [([], "usage: "), (["studdy"], "unknown subcommand"), (["study"], "needs an input"),
                                    (["study", "a.toml", "-o", "o", "-j", "0"], "--jobs is \"0\""),
                                    (["study", "a.toml", "-o"], "has no value"), (["study", "a", "b", "-o", "o"], "second input"),
                                    (["study", "none.toml", "-o", "o"], "none.toml")]:
            done = subprocess.run([self.chain.programs / "jointcreep", *arguments], capture_output=True, text=True, cwd=self.folder)
            self.assertIn(done.returncode, (2, 4), arguments)
            self.assertIn(expected, done.stderr)


class DamagedFolders(Studies):
    def test_rows_that_are_none(self):
        """Named with their file; a run's values are finite numbers or nothing."""
        study = self.written(NETWORKS.format(runs=3))
        out = self.made(study, self.folder / "out")
        path = next((out / "groups").glob("*.rows"))
        good = path.read_text()
        line = good.splitlines()[0]
        for bad in ('{"run": 0}', "[1, 2]", "[" * 100000, '"text"', line.replace('"values": [', '"values": [NaN, ', 1),
                    line.replace('"values": [', '"values": [1e999, ', 1), line.replace('"values": [', '"values": ["a", ', 1)):
            path.write_text(bad + "\n" + good.partition("\n")[2])
            done = self.study(study, out)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(f"{path}: is damaged; remove the folder", done.stderr)
        path.unlink()
        os.mkfifo(path)
        self.assertIn(f"{path}: is damaged", self.study(study, out).stderr)
        path.unlink()
        path.write_text(good)
        for bad in "{}", "[]", '{"identity": 3, "runs": 3, "group": 1}':
            (out / "plan.json").write_text(bad)
            done = self.study(study, out)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(f"{out / 'plan.json'}: is damaged", done.stderr)

    def test_a_file_whose_name_is_no_text(self):
        source = self.chain.result(SCENE)
        odd = os.fsdecode(os.fsencode(source.parent) + b"/r\xff.h5")
        shutil.copy(source, odd)
        done = self.chain.jointcreep("report", odd, "-o", self.folder / "page.html")
        self.assertEqual(done.returncode, 0, done.stderr)
        (self.folder / "page.html.partial-notes").mkdir()  # no leftover of a program
        self.assertEqual(self.chain.jointcreep("report", source, "-o", self.folder / "page.html").returncode, 0)


TABLE = """
scene = "scene.toml"

[[vary]]
network = true

[[vary]]
name = "friction"
key = "joint_material.joint.friction_angle_deg"

[design]
kind = "table"
file = "points.csv"

[[collect]]
name = "floor"
what = "displacement"
point = "floor"
component = "y"
above = [0.1]

[[collect]]
what = "blocks"
statistic = "number"
"""


class Tables(Studies):
    """Designs that a file has."""

    def test_runs_of_a_table_are_those_of_a_plain_study(self):
        """The design.csv of a study is a table, in any order of runs; a run has the same values then. Nothing has an interval."""
        plain = TABLE.replace('kind = "table"\nfile = "points.csv"', "runs = 8").replace("_deg\"\n", "_deg\"\nvalues = [30, 35.5, 41]\n")
        first = self.made(self.written(plain), self.folder / "plain")
        lines = (first / "design.csv").read_text().splitlines()
        (self.folder / "points.csv").write_text("\n".join([lines[0], *reversed(lines[1:])]) + "\n")
        out = self.made(self.written(TABLE), self.folder / "out", "-j", "2")
        rows, again = ((one / "runs.csv").read_text().splitlines()[1:] for one in (first, out))
        self.assertEqual([row.split(",", 1)[1] for row in again], [row.split(",", 1)[1] for row in reversed(rows)])
        one, other = jointcreep.read(first), jointcreep.read(out)
        self.assertTrue(np.isnan(other.answers["low"]).all() and np.isnan(other.answers["high"]).all())
        self.assertEqual(set(other.answers["runs"]), {8})
        self.assertAlmostEqual(one.answer("mean", "floor")[0], other.answer("mean", "floor")[0], delta=1e-12)
        self.assertAlmostEqual(one.answer("probability above 0.1, of stable runs", "floor")[0],
                               other.answer("probability above 0.1, of stable runs", "floor")[0])
        for name in ("input", "measure", "value"):
            self.assertEqual(other.shares[name].tolist(), one.shares[name].tolist())
        self.assertTrue(np.isfinite(one.shares["low"]).all() and np.isnan(other.shares["low"]).all())
        (self.folder / "points.csv").unlink()  # the folder has its own
        done = self.chain.jointcreep("report", out, "-o", self.folder / "page.html")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("30 to 41", (self.folder / "page.html").read_text())

    def test_a_table_without_the_network(self):
        (self.folder / "points.csv").write_text("friction\n35\n36\n37\n")
        out = self.made(self.written(TABLE.replace("[[vary]]\nnetwork = true\n", "")), self.folder / "out")
        self.assertEqual((out / "design.csv").read_text(), "run,network,friction\n0,0,35\n1,0,36\n2,0,37\n")
        (self.folder / "points.csv").write_text("friction\n35\n36\n38\n")
        done = self.study(self.folder / "study.toml", out)
        self.assertEqual(done.returncode, 2)
        self.assertIn("has runs of another study: [[vary]] changed", done.stderr)

    def test_tables_that_are_none_are_refused(self):
        self.refused(TABLE, r"points.csv: No such file")
        for text, expected in (
                ("network,friction\n1,30\n", "points.csv: has 1 runs; expected a line of names, and a line for each of two"),
                ("network\n1\n2\n", 'points.csv, line 1: has no columns "friction"; expected one for each'),
                ("network,friction,friction\n1,2,3\n1,2,3\n", 'line 1: has 2 columns "friction"'),
                ("network,friction,cohesion\n1,2,3\n1,2,3\n", r'line 1: no \[\[vary\]\] has the name "cohesion"; expected columns friction, network'),
                ("network,friction\n1,30\n2\n", "line 3: has 1 values; expected 2"),
                ("network,friction\n1,30\n2,\n", "line 3: has 1 values; expected 2"),
                ("network,friction\n1,30\n-2,31\n", "line 3: network is -2; expected a whole number from 0"),
                ("network,friction\n1,30\n1.5,31\n", "line 3: network is 1.5; expected a whole number from 0"),
                ("network,friction\n1,30\n1,steep\n", "friction_angle_deg\" is 35 in the scene; expected values of the same kind")):
            (self.folder / "points.csv").write_text(text)
            self.refused(TABLE, expected)
        (self.folder / "points.csv").write_text("network,friction\n1,30\n2,31\n")
        self.refused(TABLE.replace("network = true", 'key = "joint_material.joint.cohesion_MPa"\nname = "c"'), 'has no columns "c"')
        self.refused(TABLE.replace("[[vary]]\nnetwork = true\n", ""), r"network is 1; expected 0, or a \[\[vary\]\] with network = true")
        self.refused(TABLE.replace('_deg"', '_deg"\nvalues = [1, 2]'), "values is unknown here, or does not go with the other keys")
        self.refused(TABLE.replace('file = "points.csv"', ""), "file is missing")
        self.refused(TABLE.replace('file = ', 'runs = 3\nfile = '), "runs is unknown here")


class SceneKeys(unittest.TestCase):
    def test_a_scene_comes_back(self):
        import tomllib
        for path in [*ChainTest.chain.source.glob("data/**/*.toml"), ChainTest.chain.source / "tests/pipeline/every_key.toml"]:
            scene = tomllib.loads(path.read_text("utf-8-sig"))
            self.assertEqual(tomllib.loads(scene_keys.toml_text(scene)), scene, path)
        hard = {"a b": 'quote " back \\ tab \t end \x7f é', "table": {"x.y": [1, 2.5, True], "inner": {"k": "v"}},
                "list": [{"name": 'a "b"'}, {"name": "c"}], "empty": [], "none": {}}
        self.assertEqual(tomllib.loads(scene_keys.toml_text(hard)), hard)

    def test_paths(self):
        scene = {"material": [{"name": "a.b c", "k": 1}, {"k": 2}], "t": {"u": {"v": 3}}}
        self.assertEqual(scene_keys.value_at(scene, 'material."a.b c".k'), 1)
        self.assertEqual(scene_keys.value_at(scene, "material.2.k"), 2)
        new = scene_keys.changed(scene, {'material."a.b c".k': 7, "t.u.v": 8})
        self.assertEqual((new["material"][0]["k"], new["t"]["u"]["v"], scene["t"]["u"]["v"]), (7, 8, 3))
        for path in ("material.k", "t", "t.u.w", "", "a b", "material.1.k"):
            with self.subTest(path), self.assertRaises(NotWanted):
                scene_keys.value_at(scene, path) if path != "t" else scene_keys.value_at(scene, "t.")


class SearchOptions(Studies):
    def test_only_the_search_has_them(self):
        """A study of the factor of safety and of a displacement: the option of the search does not go to the other run."""
        text = NETWORKS.format(runs=3) + '\n[[collect]]\nwhat = "factor of safety"\n'
        text = 'demsolve_options = ["--no-creep", "--safety-width=0.2", "--runs-at-once", "1"]\n' + text
        with open(self.made(self.written(text), self.folder / "out") / "runs.csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["exit code"] for row in rows], ["0"] * 3)
        self.assertTrue(all(float(row["floor y (mm)"]) != 0 and float(row["factor of safety, lower end"]) > 1 for row in rows))
        for row in rows:  # one that stands with the largest factor that is tried has no upper end
            low, high = row["factor of safety, lower end"], row["factor of safety, upper end"]
            self.assertTrue(float(low) == 64 if high == "" else float(high) > float(low), (low, high))

    def test_no_option(self):
        text = "demsolve_options = []\n" + NETWORKS.format(runs=3)
        self.assertEqual(study_file.read(self.written(text)).demsolve_options, [])


class Variables(Studies):
    def test_a_name_of_a_number_varies(self):
        """All keys with a formula of it change: each run is that of the scene with these numbers. The report says so."""
        scene = re.sub(r"(?m)^friction_angle_deg = .*$", 'friction_angle_deg = "2 * half"', self.chain.small())
        scene = re.sub(r"(?m)^youngs_modulus_GPa = .*$", 'youngs_modulus_GPa = "1 / (1 / intact + 1 / 100)"', scene)
        self.assertTrue("2 * half" in scene and "1 / intact" in scene)
        (self.folder / "named.toml").write_text(scene + '\n[variables]\nhalf = 15\nintact = "2 * E"\nE = 10\n')
        vary = ("\n[[vary]]\nname = 'half'\nkey = 'variables.half'\nvalues = [10, 20]\n"
                "[[vary]]\nname = 'E'\nkey = 'variables.E'\nmultiplies = true\nvalues = [0.5, 2]\n")
        text = re.sub(r'(?m)^scene = .*$', 'scene = "named.toml"\nkeep = ["network.h5"]', NETWORKS.format(runs=6)) + vary
        out = self.made(self.written(text), self.folder / "out", "-j2")
        rows = rows_of(out)
        self.assertGreater(len({(row["half"], row["E"]) for row in rows}), 2)
        for row in rows:
            of_run = jointcreep.read(out / "kept" / f"{int(row['run']):06d}-network.h5").scene
            self.assertEqual(of_run["joint_material"][0]["friction_angle_deg"], 2 * float(row["half"]))
            self.assertAlmostEqual(of_run["rock"][0]["youngs_modulus_GPa"], 1 / (1 / (20 * float(row["E"])) + 1 / 100), places=12)
        # The same as by hand.
        row = next(row for row in rows if row["exit code"] == "0")
        by_hand = scene + f"\n[variables]\nhalf = {row['half']}\nintact = \"2 * E\"\nE = {10 * float(row['E'])!r}\n"
        joints = self.chain.run("strength-averaging", self.chain.network(by_hand, "--realization", row["network"]), self.folder / "j.h5")
        moved = datasets(self.chain.run("demsolve", joints, self.folder / "r.h5"))
        floor = list(moved["/history/point"]).index("floor")
        self.assertEqual(float(row["floor y (mm)"]), 1e3 * moved["/history/displacement"][-1, floor, 1])
        self.assertEqual(self.chain.jointcreep("report", out, "-o", self.folder / "r.html").returncode, 0)
        page = html.unescape((self.folder / "r.html").read_text())
        for words in "30 = 2 * half, varies by half", "16.6667 = 1 / (1 / intact + 1 / 100), varies by E", '"intact" = "2 * E"':
            self.assertIn(words, page)
        self.assertIn("<td>variables.half</td>", page)

    def test_histories(self):
        """Where stages or points depend on a name that varies, histories cannot be put beside each other."""
        formulas = {"variables": {"a": 1, "b": "a * 2", "c": 3}, "stage": [{"date": 1, "remove_m": [[["b", 0], [1, 1], [2, 2]]]}]}
        for key, is_refused in ("variables.a", True), ("variables.b", True), ("variables.c", False):
            study = types.SimpleNamespace(histories=True, parameters=[types.SimpleNamespace(keys=[key], place="")])
            with self.subTest(key), self.assertRaises(NotWanted) if is_refused else contextlib.nullcontext():
                plan.check_histories(study, formulas)


class Definitions(Studies):
    def test_of_quantities(self):
        """A report says what each quantity is."""
        collected = """
            [[collect]]
            name = "a"
            what = "displacement"
            point = "crest"
            relative_to = "behind"
            component = "x"
            stage = "bench 1"
            [[collect]]
            name = "b"
            what = "displacement"
            point = "crest"
            component = "length"
            since = "first reading"
            date = 12.5
            [[collect]]
            what = "factor of safety"
            [[collect]]
            what = "blocks"
            statistic = "largest area"
            [[collect]]
            what = "failed"
            """
        study = study_file.read(self.written('scene = "scene.toml"\n[[vary]]\nnetwork = true\n[design]\nruns = 2\n' + collected))
        self.assertEqual([one.definition() for one in study.quantities], [
            'Displacement of "crest" relative to "behind" to the right (x), just after stage "bench 1", since the in-situ equilibrium.',
            'Displacement of "crest" as the length of the vector, on day 12.5, since the first reading of "crest".',
            "Strength reduction factor at the lower end of the bracket, with which there is an equilibrium.",
            "Strength reduction factor at the upper end of the bracket, with which there is no equilibrium.",
            "Largest area of all blocks before the first stage.",
            "1 if blocks move and there is no equilibrium, 0 if there is one; runs that end undecided have no value."])


class Intervals(unittest.TestCase):
    def test_by_tables(self):
        values = np.arange(1.0, 11.0)  # mean 5.5, deviation 3.02765
        for found, wanted in zip(intervals.mean(values), (5.5, 5.5 - 2.262157 * 0.957427, 5.5 + 2.262157 * 0.957427)):
            self.assertAlmostEqual(found, wanted, places=5)
        # Median of 10: between the 2nd and the 9th value with 97.85 percent; 3rd and 8th have 89.06.
        self.assertEqual(intervals.quantile(values, 0.5), (5.5, 2.0, 9.0))
        self.assertEqual(intervals.quantile(values, 0.05)[1], None)
        # Clopper and Pearson, 0 of 10: 1 - 0.025^(1/10)
        self.assertAlmostEqual(intervals.probability(0, 10)[2], 1 - 0.025 ** 0.1, places=12)
        self.assertAlmostEqual(intervals.probability(10, 10)[1], 0.025 ** 0.1, places=12)

    def test_by_scipy(self):
        """The same as by the distributions of scipy.stats."""
        from scipy import stats
        for n in (2, 10, 59, 60, 1000):
            for part in (0.05, 0.5, 0.95):
                low, high = stats.binom(n, part).ppf([0.025, 0.975])
                self.assertEqual(intervals.ranks(n, part), (low, high + 1))
            for count in (0, 1, n // 2, n):
                ends = stats.binomtest(count, n).proportion_ci(0.95, method="exact")
                np.testing.assert_allclose(intervals.probability(count, n)[1:], ends, atol=1e-12)
            self.assertAlmostEqual(intervals.student_factor(n), stats.t.ppf(0.975, n), places=11)

    def test_crossed(self):
        """Of networks alone, the interval is Student's of the networks' means; of independent cells it is near that of all."""
        random_numbers = np.random.default_rng(1)
        of_network = random_numbers.normal(size=8)
        table = np.repeat(of_network[:, None], 5, axis=1)
        for found, wanted in zip(intervals.mean_of_crossed(table), intervals.mean(of_network)):
            self.assertAlmostEqual(found, wanted, places=9)

    def test_crossed_without_scatter(self):
        """Where no run of a crossed design hits, or all do, the interval is that of as many runs as the fewer of its two sides; also
        where runs have no value."""
        crossed = types.SimpleNamespace(design=study_file.Design("networks x parameters", 1, 40, 8, 5, 0, 1, 0, ""))
        for run in (np.arange(40), np.arange(3, 38)):
            for hits, count in ((np.zeros(len(run), bool), 0), (np.ones(len(run), bool), 5)):
                self.assertEqual(answers.share_with_interval(crossed, hits, run), intervals.probability(count, 5))

    def test_components(self):
        """Of a full table those of the analysis of variance. Where values are missing: none of both together of a sum, and no bias."""
        chance = np.random.default_rng(2)
        table = chance.normal(size=(7, 1)) + chance.normal(size=(7, 5))
        middle, rows, columns = table.mean(), table.mean(axis=1, keepdims=True), table.mean(axis=0, keepdims=True)
        of_both = ((table - rows - columns + middle) ** 2).sum() / 24
        wanted = ((rows.var(ddof=1) * 5 - of_both) / 5, (columns.var(ddof=1) * 7 - of_both) / 7, of_both)
        np.testing.assert_allclose(intervals.components(table), wanted, atol=1e-12)
        there = chance.random((12, 9)) < 0.7
        found = []
        for _ in range(2000):
            both = 3 * chance.normal(size=(12, 1)) + 2 * chance.normal(size=(1, 9))
            self.assertLess(intervals.components(np.where(there, both, np.nan))[2], 1e-20)
            found.append(intervals.components(np.where(there, both + chance.normal(size=(12, 9)), np.nan)))
        error = np.std(found, axis=0) / np.sqrt(2000)
        self.assertTrue((np.abs(np.mean(found, axis=0) - [9, 4, 1]) < 4 * error).all(), (np.mean(found, axis=0), error))

    def test_additive_by_least_squares(self):
        """Where values are missing, by numpy's least squares with a column for each network and each set of parameters."""
        chance = np.random.default_rng(3)
        table = np.where(chance.random((6, 5)) < 0.7, chance.normal(size=(6, 5)), np.nan)
        row, column = np.nonzero(np.isfinite(table))
        matrix = np.concatenate([np.eye(6)[row], np.eye(5)[column]], axis=1)
        of = table[row, column]
        wanted = of - matrix @ np.linalg.lstsq(matrix, of, rcond=None)[0]
        networks, parameters, rest, freedom = intervals.additive(table)
        np.testing.assert_allclose(rest[row, column], wanted, atol=1e-12)
        np.testing.assert_allclose(of - of.mean() - networks[row] - parameters[column], wanted, atol=1e-12)
        self.assertEqual(freedom, len(of) - np.linalg.matrix_rank(matrix))

    def test_crossed_with_failures(self):
        """Coverage where the runs with the largest values fail, so that networks have few or many values: 1000 studies, without the
        solver. The mean of complete networks alone is far off."""
        chance, n, limit = np.random.default_rng(7), 1000, 1.2
        true = -np.exp(-limit**2 / 2) / np.sqrt(2 * np.pi) / intervals.special().ndtr(limit)
        above = 1 - intervals.special().ndtr(0.8) / intervals.special().ndtr(limit)
        hits, of_complete = np.zeros(2), []
        for _ in range(n):
            table = sum(np.sqrt(share) * chance.normal(size=size) for share, size in zip((0.6, 0.2, 0.2), ((20, 1), (1, 20), (20, 20))))
            table[table > limit] = np.nan
            there = np.isfinite(table)
            of_complete.append(table[there.all(axis=1)].mean() if there.all(axis=1).any() else np.nan)
            table = table[there.any(axis=1)][:, there.any(axis=0)]
            shares = np.where(np.isfinite(table), table > 0.8, np.nan)
            for place, (wanted, found) in enumerate(((true, intervals.mean_of_crossed(table)),
                                                     (above, intervals.probability_of_crossed(shares)))):
                hits[place] += found[1] <= wanted <= found[2]
        self.assertAlmostEqual(hits[0] / n, 0.95, delta=0.025)
        self.assertGreater(hits[1] / n, 0.93)
        self.assertLess(np.nanmean(of_complete), true - 0.2)

    def test_parts(self):
        values = np.array([1.0, 2, 3, 4, 5, 9])
        middle, low, high, error = intervals.mean_of_parts(values, np.array([0, 0, 1, 1, 2, 2]))
        _, wanted_low, wanted_high, _ = intervals.mean(np.array([1.5, 3.5, 7]))
        wanted_error = np.std([1.5, 3.5, 7], ddof=1) / np.sqrt(3)
        for found, wanted in zip((middle, low, high, error), (4.0, wanted_low, wanted_high, wanted_error)):
            self.assertAlmostEqual(found, wanted, places=12)


class StrengthFactors(unittest.TestCase):
    def test_the_summary_names_what_strengths_are_divided_by(self):
        design = types.SimpleNamespace(fine_options=["--strength-factor", "1.0"], coarse_options=["--strength-factor=1.2"])
        quantities = [types.SimpleNamespace(what="displacement")]
        study = types.SimpleNamespace(demsolve_options=["--strength-factor", "1.1", "--no-creep"], design=design, quantities=quantities)
        self.assertEqual(answers.strength_factors(study), ["1.1", "1.2"])  # 1.0 changes nothing
        self.assertIn("divided by 1.1, 1.2 (--strength-factor)", answers.reduced_words(study)[0])


if __name__ == "__main__":
    main()
