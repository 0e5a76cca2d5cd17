"""Realizations through pipelines/slope/Makefile: their statistics do not depend on how they were run.

    realizations_test.py PROGRAMS SOURCE Small      of a small scene, in every way
    realizations_test.py PROGRAMS SOURCE Slope      of the bench slope: one at a time, two, and interrupted

The Makefile gets a folder of programs of its own (BIN), in which each is a script that notes its call, and then hands
on to the real program, gives up on purpose, or hangs until it is killed. A run in which one realization hangs cannot
end by itself. So it does not depend on the load of the machine what an interrupt meets.
"""

import csv
import math
import os
import pathlib
import shutil
import signal
import subprocess
import time

import h5py
import numpy

from chain import LONGEST_RUN, ChainTest, datasets, main

N = 4
STUDENT_97_5_PERCENT = {3: 3.182446305}  # by degrees of freedom, from tables
FAILS = "demsolve: no equilibrium: on purpose"

SCENE = """
# A bench is dug into about 30 random blocks, computed roughly. All numbers are made up.

[section]
outline_m = [[0, 0], [30, 0], [30, 20], [0, 20]]
rock = "rock"
gravity_m_per_s2 = 9.81

[[rock]]
name = "rock"
density_kg_per_m3 = 2700
youngs_modulus_GPa = 10
poissons_ratio = 0.25

[[joint_material]]
name = "joint"
normal_stiffness_MPa_per_m = 5000
shear_stiffness_MPa_per_m = 2000
cohesion_MPa = 1
friction_angle_deg = 35
tensile_strength_MPa = 0.1
normal_kelvin_stiffness_MPa_per_m = 5000
normal_kelvin_viscosity_MPa_day_per_m = 50000
shear_kelvin_stiffness_MPa_per_m = 2000
shear_kelvin_viscosity_MPa_day_per_m = 20000

[[joint_set]]
name = "steep"
material = "joint"
trace_angle = { law = "normal", mean_deg = 70, deviation_deg = 5 }
spacing = { law = "lognormal", mean_m = 6, deviation_m = 2 }
persistence = 1

[[joint_set]]
name = "flat"
material = "joint"
trace_angle = { law = "normal", mean_deg = 5, deviation_deg = 4 }
spacing = { law = "lognormal", mean_m = 7, deviation_m = 2 }
persistence = 1

[in_situ_stress]
elevation_m = 20
compression_xx_MPa = 0
compression_yy_MPa = 0
shear_xy_MPa = 0
compression_xx_gradient_MPa_per_m = 0.013
compression_yy_gradient_MPa_per_m = 0.026487
shear_xy_gradient_MPa_per_m = 0

[[boundary]]
from_m = [0, 0]
to_m = [30, 0]
fix = "xy"

[[boundary]]
from_m = [0, 0]
to_m = [0, 20]
fix = "x"

[[boundary]]
from_m = [30, 0]
to_m = [30, 20]
fix = "x"

[schedule]
start = 0
end = 10

[[stage]]
name = "bench"
date = 2
remove_m = [[[16, 20], [30, 20], [30, 12], [19, 12]]]

[[point]]
name = "crest"
at_m = [14, 19]

[[point]]
name = "dug away"
at_m = [25, 17]

[[point]]
name = "floor"
at_m = [24, 11]
first_reading = 4

[creep]
step_days = 2
scheme = "published"

[zones]
size_m = 5

[equilibrium]
tolerance = 1e-4

[random]
seed = 3
"""

WRAPPER = """#!/bin/sh
echo "$0 $*" >>{calls}
case "$*" in {cases} esac
exec {program} "$@"
"""


def hangs(*numbers):
    """A case of a program's arguments: for these realizations it hangs."""
    return "".join(f"*{number:04d}*) exec sleep {10 * LONGEST_RUN} ;; " for number in numbers)


# Ways to stop make; it leads a process group.
def kill_make(running):  # alone, without those that work for it
    os.kill(running.pid, signal.SIGKILL)


def kill_all(running):
    os.killpg(running.pid, signal.SIGKILL)


def interrupt(running):  # what Ctrl-C does
    os.killpg(running.pid, signal.SIGINT)


def terminate(running):
    os.kill(running.pid, signal.SIGTERM)


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


class Runs(ChainTest):
    """Tools to run realizations of the scene `text`, and to stop them."""

    text: str
    count: int
    plots = None  # a folder of other plots than those of the sources

    def setUp(self):
        self.folder = self.chain.new_folder()
        self.scene = self.folder / "scene.toml"
        self.scene.write_text(self.text)
        os.utime(self.scene, (0, 0))  # so that results of the same scene from another folder are not old
        self.calls = self.folder / "calls"

    def programs(self, **cases):
        """A folder of programs; `demsolve="*0002*) exit 3 ;;"` is a case of its arguments, strength stands for
        strength-averaging."""
        folder = self.chain.new_folder()
        for name in ("jointgen", "strength-averaging", "demsolve"):
            script = folder / name
            script.write_text(WRAPPER.format(calls=self.calls, cases=cases.get(name.split("-")[0], ""),
                                             program=self.chain.programs / name))
            script.chmod(0o755)
            os.utime(script, (0, 0))  # so that another folder of programs does not make results old
        return folder

    def command(self, out, programs, *more):
        plots = [f"PLOTS={self.plots}"] if self.plots else []
        return ["make", "-C", self.chain.source / "pipelines" / "slope", f"OUT={out}", f"SCENE={self.scene}",
                f"BIN={programs}", f"N={self.count}", *plots, *more]

    def environment(self):
        return {name: value for name, value in os.environ.items() if name not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL")}

    def make(self, out, programs, *more):
        """What make does."""
        return subprocess.run(self.command(out, programs, *more), capture_output=True, text=True, timeout=LONGEST_RUN,
                              env=self.environment())

    def made(self, out, programs, *more):
        done = self.make(out, programs, *more)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return out

    def number_of_calls(self):
        """Of all programs; a realization needs three."""
        return self.calls.read_text().count("\n") if self.calls.exists() else 0

    def is_called(self, program, number, since):
        """Whether a realization's program has been called since so many calls."""
        calls = self.calls.read_text().splitlines()[since:] if self.calls.exists() else []
        return any(f"/{program} " in call and f"{number:04d}" in call for call in calls)

    def stopped(self, out, programs, stop, meets, ended=(), wait=0):
        """Runs two at once until these (program, number) are called, these results are there, and so many seconds more;
        then stops make, and waits until nothing works any more. Returns names and times of the results."""
        before = self.number_of_calls()
        running = subprocess.Popen(self.command(out, programs, "-j2", "realizations"), stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL, env=self.environment(), start_new_session=True)
        try:
            wait_until(lambda: all(self.is_called(*call, before) for call in meets) and
                       all((out / "realizations" / name).exists() for name in ended))
            time.sleep(wait)
            stop(running)
            self.assertNotEqual(running.wait(LONGEST_RUN), 0)
            wait_until(lambda: not alive(running.pid), "something works on after make was stopped")
        finally:
            for process in alive(running.pid):  # only if the test has failed
                os.kill(process, signal.SIGKILL)
            running.wait()
        self.assertFalse((out / "ensemble.h5").exists())
        self.assertFalse(list((out / "realizations").glob("*.failed")), "an interrupt is taken for a failure")
        return {path.name: path.stat().st_mtime_ns for path in (out / "realizations").glob("*.h5")}

    def assert_same(self, one, other):
        for name in ("ensemble.h5", "ensemble.csv", "summary.txt"):
            self.assertEqual((one / name).read_bytes(), (other / name).read_bytes(), name)

    def assert_nothing_half_written(self, out):
        """Every file under its final name is whole, and nothing else is left."""
        names = {path.name for path in (out / "realizations").iterdir()}
        for number in range(self.count):
            self.assertEqual({name for name in names if name.startswith(f"{number:04d}")},
                             {f"{number:04d}.h5", f"{number:04d}.log"})
            with h5py.File(out / "realizations" / f"{number:04d}.h5") as file:
                self.assertEqual((file.attrs["complete"], file.attrs["realization"]), (1, number))


class Small(Runs):
    text = SCENE
    count = N
    made_once = None

    def setUp(self):
        """Most tests do without a drawn picture, which takes longer than all four realizations."""
        super().setUp()
        self.plots = self.chain.new_folder()
        for name, text in (("plot_ensemble.py", "import sys\nopen(sys.argv[-1], 'w').close()\n"), ("figure.py", "")):
            (self.plots / name).write_text(text)
            os.utime(self.plots / name, (0, 0))

    def whole(self):
        """Realizations of the scene and their picture, made one at a time by the first test that asks for them. Only
        to be read."""
        if not Small.made_once:
            stand_in, self.plots = self.plots, None
            Small.made_once = self.made(self.chain.new_folder() / "whole", self.programs(), "-j1", "realizations")
            self.plots = stand_in
            self.calls.unlink()
            self.assertEqual((Small.made_once / "ensemble.png").read_bytes()[:4], b"\x89PNG")
        return Small.made_once

    def copy_of_whole(self):
        """As made for this test, with the same times of files."""
        return shutil.copytree(self.whole(), self.folder / "out")

    def test_statistics(self):
        """They are what the result files say, by another way of computing them."""
        out = self.whole()
        results = [datasets(out / "realizations" / f"{number:04d}.h5") for number in range(N)]
        moves = numpy.stack([result["/history/displacement"] for result in results])
        self.assertGreater(moves[:, -1, 0].std(axis=0).min(), 1e-6)  # [m]; they differ
        ensemble = datasets(out / "ensemble.h5")
        times, points = moves.shape[1:3]
        compared = 0
        for kind in ("displacement", "displacement_since_first_reading"):
            for point in range(points):
                first = results[0]["/history/first_reading_row"][point]
                zero = moves[:, first, point] if "first" in kind else 0
                for row in range(times):
                    there = sum(result["/history/present"][row, point] for result in results)
                    there = 0 if "first" in kind and row < first else there
                    self.assertEqual(ensemble[f"/{kind}/count"][row, point], there)
                    values = moves[:, row, point] - zero
                    mean = values.sum(axis=0) / N
                    deviation = numpy.sqrt(((values - mean) ** 2).sum(axis=0) / (N - 1))
                    half = STUDENT_97_5_PERCENT[N - 1] * deviation / math.sqrt(N)
                    inner = numpy.sort(values, axis=0)
                    wanted = {"mean": mean, "standard_deviation": deviation, "mean_low": mean - half,
                              "mean_high": mean + half}
                    if there == 0:
                        wanted = dict.fromkeys(wanted, 0)
                    else:
                        self.assertEqual(there, N)
                        # of four values, the quantiles 0.05, ... lie at 0.15, 0.75, 1.5, 2.25, 2.85 between them
                        quantiles = [inner[k] + part * (inner[k + 1] - inner[k])
                                     for k, part in ((0, 0.15), (0, 0.75), (1, 0.5), (2, 0.25), (2, 0.85))]
                        self.assertTrue(numpy.allclose(ensemble[f"/{kind}/quantile"][:, row, point], quantiles,
                                                       rtol=1e-9, atol=1e-15))
                        compared += 1
                    for name, value in wanted.items():
                        self.assertTrue(numpy.allclose(ensemble[f"/{kind}/{name}"][row, point], value, rtol=1e-9,
                                                       atol=1e-15), (kind, name, row, point))
        self.assertGreater(compared, 20)
        with open(out / "ensemble.csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 2 * compared)
        last = rows[-1]
        self.assertEqual((last["since"], last["point"], last["component"]), ("first reading", "floor", "y"))
        self.assertEqual(float(last["mean_m"]), ensemble["/displacement_since_first_reading/mean"][-1, -1, 1])

    def test_one_at_a_time_or_two(self):
        two = self.made(self.folder / "two", self.programs(), "-j2", "realizations")
        self.assert_same(self.whole(), two)
        self.assert_nothing_half_written(self.whole())
        self.assert_nothing_half_written(two)

    def test_nothing_is_done_twice(self):
        programs = self.programs()
        out = self.made(self.folder / "out", programs, "realizations")
        when = (out / "ensemble.h5").stat().st_mtime_ns
        self.made(out, programs, "realizations")
        self.assertEqual(self.number_of_calls(), 3 * N)
        self.assertEqual((out / "ensemble.h5").stat().st_mtime_ns, when)

    def test_what_a_killed_writer_left_goes(self):
        out = self.copy_of_whole()
        left = out / "ensemble.csv.partial-4194305"  # more than a process's number can be
        left.write_text("half")
        self.made(out, self.programs(), "realizations")
        self.assertFalse(left.exists())

    def test_interrupts(self):
        """At the beginning, in the middle and at the end of chains. What has ended is not made again."""
        whole = self.whole()
        out = self.folder / "out"
        rounds = [  # how make is stopped; which programs hang, and are met there; what has ended by then
            (kill_make, {"strength": [0, 1]}, []),
            (interrupt, {"demsolve": [1, 2]}, ["0000.h5"]),
            (kill_all, {"jointgen": [3], "demsolve": [2]}, ["0000.h5", "0001.h5"]),
            (terminate, {"strength": [2], "demsolve": [3]}, ["0000.h5", "0001.h5"]),
            (kill_make, {"demsolve": [3]}, ["0000.h5", "0001.h5", "0002.h5"]),
        ]
        before = {}
        for stop, hanging, ended in rounds:
            with self.subTest(stop.__name__, hanging=hanging):
                cases = {program: hangs(*numbers) for program, numbers in hanging.items()}
                meets = [(program.replace("strength", "strength-averaging"), number)
                         for program, numbers in hanging.items() for number in numbers]
                now = self.stopped(out, self.programs(**cases), stop, meets, ended)
                self.assertEqual(sorted(now), ended)
                self.assertLessEqual(before.items(), now.items(), "what had ended is made again")
                before = now
        self.made(out, self.programs(), "-j2", "realizations")
        self.assert_same(whole, out)
        self.assert_nothing_half_written(out)

    def test_a_parent_that_is_gone(self):
        """A realization whose make has died before the kernel was asked to watch it does nothing."""
        folder = self.chain.new_folder()
        script = self.chain.source / "pipelines" / "slope" / "realization.sh"
        for parent, code in ((0, 143), (os.getpid(), 0)):
            done = subprocess.run(["sh", script, self.programs(), self.scene, folder, "0000", str(parent)],
                                  capture_output=True, text=True, timeout=LONGEST_RUN)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertEqual(sorted(path.name for path in folder.iterdir()),
                             [] if code else ["0000.h5", "0000.log"])

    def test_balances(self):
        """The summary and ensemble.h5 name the errors of energy and area of each realization, here after results have
        been falsified; and what cutting did."""
        out = self.copy_of_whole()
        values = datasets(out / "ensemble.h5")
        self.assertLess(values["/realization/energy_error"].max(), 1e-6)
        self.assertLess(values["/realization/area_error"].max(), 1e-12)
        results = [datasets(out / "realizations" / f"{number:04d}.h5") for number in range(N)]
        for name in ("merged_vertices", "merged_edge_length", "merged_block_area", "largest_move", "pruned_length"):
            self.assertEqual(list(values[f"/realization/{name}"]), [result[f"/cutting/{name}"][0] for result in results])

        work = results[1]["/equilibria/work_of_loads"]
        terms = [work, *(results[1][f"/equilibria/{name}_energy"] for name in ("stored", "dissipated", "damped"))]
        row = int(numpy.argmax(numpy.abs(work)))
        with h5py.File(out / "realizations" / "0001.h5", "r+") as file:
            file["/equilibria/work_of_loads"][row] = 1.5 * work[row]
        area = results[2]["/blocks/area"]
        with h5py.File(out / "realizations" / "0002.h5", "r+") as file:
            file["/blocks/area"][0] = area[0] + 6.0  # of 600 m2
        self.made(out, self.programs(), "realizations")
        values = datasets(out / "ensemble.h5")
        largest = max(1.5 * abs(work[row]), *(abs(term[row]) for term in terms[1:]))
        self.assertAlmostEqual(values["/realization/energy_error"][1], 0.5 * abs(work[row]) / largest, delta=1e-6)
        self.assertAlmostEqual(values["/realization/area_error"][2], 0.01, delta=1e-9)
        lines = (out / "summary.txt").read_text().splitlines()
        line = {number: next(text.split() for text in lines if text.split()[:1] == [f"{number:04d}"])
                for number in range(N)}
        self.assertIn(f"{values['/realization/energy_error'][1]:.1e}", line[1])
        self.assertIn("1.0e-02", line[2])
        self.assertIn(f"{values['/realization/smallest_zone_altitude'][3]:.4g}", line[3])

    def test_a_failed_one(self):
        """It is named with its reason, does not stop the others, and is tried again only when asked."""
        bad = f"*0001*) echo '{FAILS}' >&2; exit 3 ;;"
        good, failing = self.programs(), self.programs(demsolve=bad)
        whole = self.whole()
        self.plots = None  # a picture also of those that are left
        out = self.folder / "out"
        done = self.make(out, failing, "realizations")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn(f"failed 0001: demsolve, exit code 3 {FAILS}\n", done.stdout)
        self.assertEqual(list(datasets(out / "ensemble.h5")["/realization/number"]), [0, 2, 3])
        self.assertEqual(list(datasets(out / "ensemble.h5")["/failed/number"]), [1])
        self.assertIn(FAILS, (out / "realizations" / "0001.log").read_text())
        self.assertFalse((out / "realizations" / "0001.h5").exists())

        first = self.folder / "first"
        first.mkdir()
        for name in ("ensemble.h5", "ensemble.csv", "summary.txt"):
            (first / name).write_bytes((out / name).read_bytes())
        calls = self.number_of_calls()
        again = self.make(out, good, "realizations")
        self.assertNotEqual(again.returncode, 0)
        self.assertIn("failed 0001", again.stdout)
        self.assertEqual(self.number_of_calls(), calls)
        self.assert_same(first, out)

        self.made(out, good, "retry")
        self.assertEqual(self.number_of_calls(), calls + 3)
        self.assert_same(whole, out)
        self.assert_nothing_half_written(out)

    def test_all_failed(self):
        done = self.make(self.folder / "out", self.programs(jointgen="*) echo jointgen: no >&2; exit 2 ;;"),
                         "realizations")
        self.assertNotEqual(done.returncode, 0)
        for number in range(N):
            self.assertIn(f"failed {number:04d}: jointgen, exit code 2 jointgen: no\n", done.stderr)
        self.assertFalse((self.folder / "out" / "ensemble.h5").exists())

    def test_what_is_no_reason(self):
        """A full disk, or a program that is killed: it is tried again, without being asked."""
        for what, code in (("echo full >&2; exit 4", 4), ("kill -9 $$", 137), ("kill -TERM $$", 143)):
            with self.subTest(what):
                out = self.folder / f"out-{code}"
                done = self.make(out, self.programs(demsolve=f"*0001*) {what} ;;"), "realizations")
                self.assertNotEqual(done.returncode, 0)
                self.assertIn(f"realization 0001: demsolve was stopped (exit code {code})", done.stderr)
                self.made(out, self.programs(), "realizations")
                self.assert_nothing_half_written(out)

    def test_a_crash_is_a_reason(self):
        done = self.make(self.folder / "out", self.programs(jointgen="*0001*) kill -SEGV $$ ;;"), "realizations")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("failed 0001: jointgen, exit code 139", done.stdout)

    def test_chosen_creep_steps(self):
        """Realizations with rows on other days are brought to common days: their statistics are those of short steps."""
        chosen = 'tolerance_m = 1e-8'
        text = SCENE.replace('step_days = 2\nscheme = "published"', chosen)
        self.scene.write_text(text)
        out = self.made(self.folder / "out", self.programs(), "realizations")
        results = [datasets(out / "realizations" / f"{number:04d}.h5") for number in range(N)]
        self.assertGreater(len({len(result["/history/time"]) for result in results} |
                               {tuple(result["/history/time"]) for result in results}), 2)
        self.scene.write_text(text.replace(chosen, 'step_days = 0.125\nscheme = "fitted"'))
        fine = self.made(self.folder / "fine", self.programs(), "realizations")
        ensemble, wanted = datasets(out / "ensemble.h5"), datasets(fine / "ensemble.h5")
        crept = numpy.abs(wanted["/displacement/mean"][-1] - wanted["/displacement/mean"][2]).max()
        last = wanted["/history/time"] > 4  # after the last date, with a row every eighth of a day
        compared = 0
        for row, day in enumerate(ensemble["/history/time"]):
            if day > 4:
                for point, component in ((0, 0), (0, 1), (2, 0), (2, 1)):
                    near = numpy.interp(day, wanted["/history/time"][last], wanted["/displacement/mean"][last, point, component])
                    self.assertLess(abs(ensemble["/displacement/mean"][row, point, component] - near), 0.002 * crept)
                compared += 1
        self.assertGreater(compared, 2)

    def test_a_point_that_is_taken_in_some(self):
        """It is named with its realizations, here after a result has been falsified."""
        out = self.copy_of_whole()
        with h5py.File(out / "realizations" / "0002.h5", "r+") as file:
            file["/history/present"][-3:, 0] = 0
        self.made(out, self.programs(), "realizations")
        self.assertIn('point "crest": an excavation takes it in 1 of 4 realizations: 0002\n', (out / "summary.txt").read_text())

    def test_a_changed_scene(self):
        """Results of another scene are not mixed in, be they old or put there."""
        programs = self.programs()
        out = self.copy_of_whole()
        other = self.folder / "other"
        self.scene.write_text(SCENE.replace("end = 10", "end = 12"))
        later = time.time() + 1
        os.utime(self.scene, (later, later))
        self.made(other, programs, "realizations")
        strange = (other / "realizations" / "0002.h5").read_bytes()
        self.scene.write_text(SCENE)
        os.utime(self.scene, (0, 0))
        (out / "realizations" / "0002.h5").write_bytes(strange)
        done = self.make(out, programs, "realizations")
        self.assertNotEqual(done.returncode, 0)
        self.assertRegex(done.stderr, r"0002\.h5: /scene is not the same as in 0000\.h5")


class Slope(Runs):
    """The real slope, for a few realizations: programs are killed at work."""

    count = 3

    def setUp(self):
        self.text = self.chain.text("data/slope/scene.toml")
        super().setUp()

    def test_same_statistics(self):
        one = self.made(self.folder / "one", self.programs(), "-j1", "realizations")
        two = self.made(self.folder / "two", self.programs(), "-j2", "realizations")
        self.assert_same(one, two)

        out = self.folder / "out"
        self.stopped(out, self.programs(jointgen=hangs(2)), kill_make, [("demsolve", 0), ("demsolve", 1)], wait=1)
        left = [number for number in (0, 1) if not (out / "realizations" / f"{number:04d}.h5").exists()]
        meets = [("demsolve", number) for number in left] or [("jointgen", 2)]
        self.stopped(out, self.programs(jointgen=hangs(2)), interrupt, meets, wait=0.5)
        self.stopped(out, self.programs(demsolve=hangs(2)), kill_all, [("demsolve", 2)], wait=0.2)
        self.made(out, self.programs(), "-j2", "realizations")
        self.assert_same(one, out)
        self.assert_nothing_half_written(out)


def wait_until(condition, what="nothing happened"):
    end = time.monotonic() + LONGEST_RUN
    while not condition():
        if time.monotonic() > end:
            raise AssertionError(what)
        time.sleep(0.01)


if __name__ == "__main__":
    main()
