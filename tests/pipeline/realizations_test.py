"""Realizations through pipelines/slope/Makefile: a study of networks, with statistics of all histories.

    realizations_test.py PROGRAMS SOURCE Small      of a small scene, in every way
    realizations_test.py PROGRAMS SOURCE Slope      of the bench slope: one at a time, two, and interrupted

The Makefile gets a folder of programs of its own (BIN), in which demsolve is a script that notes its call, and then hands on to the
real program, gives up on purpose, or hangs until it is killed. What else may stop a study is in studies_test.py.
"""

import csv
import math
import os
import shutil
import signal
import subprocess
import time

import h5py
import numpy

from chain import LONGEST_RUN, ChainTest, alive, datasets, main

from jointcreep import ensemble, files

N = 4
STUDENT_97_5_PERCENT = {3: 3.182446305}  # by degrees of freedom, from tables
FAILS = "demsolve: no equilibrium: on purpose"
RESULTS = ["ensemble.h5", "ensemble.csv", "summary.txt"]
WRAPPER = """#!/bin/sh
echo "$PWD $*" >>{calls}
case "$PWD" in {cases} esac
exec {program} "$@"
"""


class Realizations(ChainTest):
    """Tools to make realizations of the scene `text`."""

    text: str
    count: int

    def setUp(self):
        self.folder = self.chain.new_folder()
        self.scene = self.folder / "scene.toml"
        self.scene.write_text(self.text)

    def programs(self, cases=""):
        """A folder of programs; "*/000002) exit 3 ;;" is a case of demsolve's working folder, which has the number of the realization."""
        folder = self.chain.new_folder()
        for name in ("jointcreep", "jointgen", "strength-averaging"):
            (folder / name).symlink_to(self.chain.programs / name)
        script = folder / "demsolve"
        script.write_text(WRAPPER.format(calls=folder / "calls", cases=cases, program=self.chain.programs / "demsolve"))
        script.chmod(0o755)
        return folder

    def command(self, out, programs, *more):
        return ["make", "-C", self.chain.source / "pipelines" / "slope", f"OUT={out}", f"SCENE={self.scene}", f"BIN={programs}",
                f"N={self.count}", *more, "realizations"]

    def environment(self):
        return {name: value for name, value in os.environ.items() if name not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL")}

    def make(self, out, programs=None, *more):
        """What make does."""
        return subprocess.run(self.command(out, programs or self.chain.programs, *more), capture_output=True, text=True,
                              timeout=LONGEST_RUN, env=self.environment())

    def made(self, out, programs=None, *more):
        """The folder of the realizations, which must succeed."""
        done = self.make(out, programs, *more)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return out / "realizations"

    def stopped(self, out, programs, stop, called, ended=()):
        """Two at a time, until demsolve of realization `called` is called and these have ended; then stops make, and waits until nothing
        works any more."""
        running = subprocess.Popen(self.command(out, programs, "-j2"), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                   env=self.environment(), start_new_session=True)
        calls = programs / "calls"
        try:
            wait_until(lambda: calls.exists() and f"/{called:06d} --quiet joints.h5" in calls.read_text() and
                       all((out / "realizations" / "groups" / f"{number:06d}.rows").exists() for number in ended))
            stop(running.pid)
            self.assertNotEqual(running.wait(LONGEST_RUN), 0)
            wait_until(lambda: not alive(running.pid), "something works on after make was stopped")
        finally:
            for process in alive(running.pid):  # only if the test has failed
                os.kill(process, signal.SIGKILL)
            running.wait()
        self.assertFalse((out / "realizations" / "ensemble.h5").exists())

    def assert_same(self, one, other):
        for name in RESULTS:
            self.assertEqual((one / name).read_bytes(), (other / name).read_bytes(), name)


def hangs(number):
    """A case for programs(): this realization hangs."""
    return f"*/{number:06d}) exec sleep {10 * LONGEST_RUN} ;; "


class Small(Realizations):
    count = N
    made_once = None

    def setUp(self):
        self.text = self.chain.small()
        super().setUp()

    def whole(self):
        """Realizations of the scene, made one at a time by the first test that asks for them. Only to be read."""
        if not Small.made_once:
            Small.made_once = self.made(self.chain.new_folder() / "whole")
        return Small.made_once

    def rows(self):
        """The histories of the kept results, as lines of results have them."""
        return [{"run": number, "network": number, "exit_code": 0, "history": ensemble.of_run(path)}
                for number, path in enumerate(self.kept())]

    def kept(self, name="result.h5"):
        return [self.whole() / "kept" / f"{number:06d}-{name}" for number in range(N)]

    def test_statistics(self):
        """They are what the result files say, by another way of computing them."""
        out = self.whole()
        results = [datasets(path) for path in self.kept()]
        moves = numpy.stack([result["/history/displacement"] for result in results])
        self.assertGreater(moves[:, -1, 0].std(axis=0).min(), 1e-6)  # [m]; they differ
        found = datasets(out / "ensemble.h5")
        times, points = moves.shape[1:3]
        compared = 0
        for kind in ("displacement", "displacement_since_first_reading"):
            for point in range(points):
                first = results[0]["/history/first_reading_row"][point]
                zero = moves[:, first, point] if "first" in kind else 0
                for row in range(times):
                    there = sum(result["/history/present"][row, point] for result in results)
                    there = 0 if "first" in kind and row < first else there
                    self.assertEqual(found[f"/{kind}/count"][row, point], there)
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
                        self.assertTrue(numpy.allclose(found[f"/{kind}/quantile"][:, row, point], quantiles,
                                                       rtol=1e-9, atol=1e-15))
                        compared += 1
                    for name, value in wanted.items():
                        self.assertTrue(numpy.allclose(found[f"/{kind}/{name}"][row, point], value, rtol=1e-9,
                                                       atol=1e-15), (kind, name, row, point))
        self.assertGreater(compared, 20)
        with open(out / "ensemble.csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 2 * compared)
        last = rows[-1]
        self.assertEqual((last["since"], last["point"], last["component"]), ("first reading", "floor", "y"))
        self.assertEqual(float(last["time_day"]), found["/history/time"][-1])
        for days, text in ((3.0000000000000004, "3"), (10 + 1 / 3, "10.33333333333"), (0.1 + 0.2, "0.3"), (0, "0"), (1e6, "1000000"),
                           (3.00000000001, "3.00000000001")):
            self.assertEqual(files.day_text(days), text)
        self.assertEqual(float(last["mean_m"]), found["/displacement_since_first_reading/mean"][-1, -1, 1])
        for name in ("ensemble.png", "ensemble-y.png"):
            self.assertEqual((out / name).read_bytes()[:4], b"\x89PNG")

    def test_one_at_a_time_or_two(self):
        two = self.made(self.folder / "two", None, "-j2", "KEEP=network.h5 joints.h5", "SOLVE=--no-creep")
        one = self.made(self.folder / "one", None, "KEEP=network.h5 joints.h5", "SOLVE=--no-creep")
        self.assert_same(one, two)
        self.assertEqual(sorted(path.name for path in (two / "kept").iterdir()),
                         sorted(f"{number:06d}-{name}" for number in range(N) for name in ("network.h5", "joints.h5")))
        self.assertLess(len(datasets(two / "ensemble.h5")["/history/time"]),
                        len(datasets(self.whole() / "ensemble.h5")["/history/time"]))
        for given, jobs in ((["-j2"], 2), ([], 1)):
            said = subprocess.run([*self.command(self.folder / "out", self.chain.programs, *given), "-n"], capture_output=True, text=True,
                                  env=self.environment()).stdout
            self.assertIn(f" -j {jobs} ", said)

    def test_killed(self):
        """Make alone, or all of its processes; what has ended is not made again."""
        whole, out, calls = self.whole(), self.folder / "out", []
        for number, stop in ((1, lambda pid: os.kill(pid, signal.SIGKILL)), (3, lambda pid: os.killpg(pid, signal.SIGKILL)),
                             (3, lambda pid: os.killpg(pid, signal.SIGINT))):
            programs = self.programs(hangs(number))
            self.stopped(out, programs, stop, number, ended=[0])
            calls += (programs / "calls").read_text().splitlines()
        programs = self.programs()
        self.assert_same(whole, self.made(out, programs, "-j2"))
        calls += (programs / "calls").read_text().splitlines()
        self.assertEqual(sum("/000000 --quiet joints.h5" in call for call in calls), 1)
        for number, path in enumerate(self.kept()):
            with h5py.File(path) as file, h5py.File(out / "realizations" / "kept" / path.name) as other:
                self.assertEqual((other.attrs["complete"], other.attrs["realization"]), (1, number))
                self.assertTrue((file["/history/displacement"][()] == other["/history/displacement"][()]).all())

    def test_what_a_killed_writer_left_goes(self):
        left = self.folder / "ensemble.csv.partial-4194305"  # more than a process's number can be
        left.write_text("half")
        files.write_text(self.folder / "ensemble.csv", "whole")
        self.assertFalse(left.exists())

    def test_balances(self):
        """The summary and ensemble.h5 name the errors of energy and area of each realization, here after results have
        been falsified; and what cutting did."""
        values = datasets(self.whole() / "ensemble.h5")
        self.assertLess(values["/run/energy_error"].max(), 1e-6)
        self.assertLess(values["/run/area_error"].max(), 1e-12)
        results = [datasets(path) for path in self.kept()]
        for name in ("merged_vertices", "merged_edge_length", "merged_block_area", "largest_move"):
            self.assertEqual(list(values[f"/run/{name}"]), [result[f"/cutting/{name}"][0] for result in results])
        self.assertEqual(list(values["/run/cut_back_length"]), [result["/fates/dangling_end_length"].sum() for result in results])
        text = (self.whole() / "summary.txt").read_text()
        self.assertIn(f"{values['/run/smallest_zone_altitude'][3]:.4g}", text)
        false = [shutil.copy(path, self.folder / f"{place}.h5") for place, path in enumerate(self.kept()[1:3])]
        work = results[1]["/equilibria/work_of_loads"]
        terms = [work, *(results[1][f"/equilibria/{name}_energy"] for name in ("stored", "dissipated", "damped"))]
        row = int(numpy.argmax(numpy.abs(work)))
        with h5py.File(false[0], "r+") as file:
            file["/equilibria/work_of_loads"][row] = 1.5 * work[row]
        with h5py.File(false[1], "r+") as file:
            file["/blocks/area"][0] = results[2]["/blocks/area"][0] + 6.0  # of 600 m2
        largest = max(1.5 * abs(work[row]), *(abs(term).max() for term in terms[1:]))
        self.assertAlmostEqual(ensemble.of_run(false[0])["like"]["energy_error"], 0.5 * abs(work[row]) / largest, delta=1e-6)
        self.assertAlmostEqual(ensemble.of_run(false[1])["like"]["area_error"], 0.01, delta=1e-9)

    def test_an_equilibrium_that_moves_nothing(self):
        """Its terms are rounding; compared with those of the run they are no error. What the run itself misses is one."""
        path = self.folder / "result.h5"
        for stored, damped, is_implicit, expected in (([0.49, 2e6], [0, 0], 0, 0.51 / 2e6), ([1.51, 2e6], [-0.51, 0], 1, 0.51 / 2e6),
                                                      ([1, 1e6], [0, 0], 0, 0.5)):
            with h5py.File(path, "w") as file:
                for name, values in (("work_of_loads", [1, 2e6]), ("stored_energy", stored), ("dissipated_energy", [0, 0]),
                                     ("damped_energy", damped), ("is_implicit", [is_implicit] * 2)):
                    file[f"/equilibria/{name}"] = numpy.array(values, float)
                self.assertAlmostEqual(ensemble.energy_error(file) / expected, 1, delta=1e-9)

    def test_a_failed_one(self):
        """It is named with its reason, and does not stop the others."""
        out = self.made(self.folder / "out", self.programs(f"*/000001) echo '{FAILS}' >&2; exit 3 ;;"))
        self.assertIn(f"run 1 undecided: {FAILS}\n", (out / "summary.txt").read_text())
        found = datasets(out / "ensemble.h5")
        self.assertEqual((list(found["/run/number"]), list(found["/failed/number"])), ([0, 2, 3], [1]))
        self.assertIn(FAILS, found["/failed/reason"][0])

    def test_all_failed(self):
        done = self.make(self.folder / "out", self.programs('*/realizations/work/*) echo "demsolve: no" >&2; exit 3 ;;'))
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("run 0 undecided: demsolve: no\n", done.stdout)
        self.assertFalse((self.folder / "out" / "realizations" / "ensemble.h5").exists())

    def test_names(self):
        """Names of stages and points are only names, whatever a shell or a makefile would make of them."""
        bad = "`touch bad` $(touch bad) ; touch bad # $X %"
        self.scene.write_text(self.text.replace('"bench"', f'"{bad}"').replace('"floor"', f'"{bad} floor"'))
        out = self.made(self.folder / "out", None, "SOLVE=--no-creep")
        self.assertIn(bad, datasets(out / "ensemble.h5")["/history/event"])
        self.assertFalse(list(self.folder.rglob("bad")) + list((self.chain.source / "pipelines" / "slope").glob("bad")))

    def test_chosen_creep_steps(self):
        """Realizations with rows on other days are brought to common days: their statistics are those of short steps."""
        chosen = 'tolerance_m = 1e-8'
        text = self.text.replace('step_days = 2\nscheme = "published"', chosen)
        self.scene.write_text(text)
        out = self.made(self.folder / "out")
        results = [datasets(path) for path in (out / "kept").iterdir()]
        self.assertGreater(len({len(result["/history/time"]) for result in results} |
                               {tuple(result["/history/time"]) for result in results}), 2)
        self.scene.write_text(text.replace(chosen, 'step_days = 0.125\nscheme = "fitted"'))
        fine = self.made(self.folder / "fine")
        found, wanted = datasets(out / "ensemble.h5"), datasets(fine / "ensemble.h5")
        crept = numpy.abs(wanted["/displacement/mean"][-1] - wanted["/displacement/mean"][2]).max()
        last = wanted["/history/time"] > 4  # after the last date, with a row every eighth of a day
        compared = 0
        for row, day in enumerate(found["/history/time"]):
            if day > 4:
                for point, component in ((0, 0), (0, 1), (2, 0), (2, 1)):
                    near = numpy.interp(day, wanted["/history/time"][last], wanted["/displacement/mean"][last, point, component])
                    self.assertLess(abs(found["/displacement/mean"][row, point, component] - near), 0.002 * crept)
                compared += 1
        self.assertGreater(compared, 2)

    def test_a_point_that_is_taken_in_some(self):
        """It is named with its realizations, and counts in the others; here after a history has been falsified."""
        rows = self.rows()
        for present in rows[2]["history"]["present"][-3:]:
            present[0] = False
        lines = ensemble.write(rows, self.text, self.folder)
        self.assertIn('point "crest": an excavation takes it in 1 of 4 runs: 2', lines)
        self.assertEqual(datasets(self.folder / "ensemble.h5")["/displacement/count"][-1, 0], 3)

    def test_a_changed_scene(self):
        """Results of another scene are not mixed in."""
        out = self.folder / "out"
        self.made(out, None, "SOLVE=--no-creep")
        self.scene.write_text(self.text.replace("end = 10", "end = 12"))
        done = self.make(out, None, "SOLVE=--no-creep")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("has runs of another study: the scene changed", done.stderr)

    def test_days_that_vary(self):
        """Histories of other stages cannot be put beside each other; that is said before anything is computed."""
        study = self.folder / "study.toml"
        study.write_text('scene = "scene.toml"\nhistories = true\n[design]\nruns = 2\n[[vary]]\nkey = "stage.bench.date"\nvalues = [1, 2]\n')
        done = subprocess.run([self.chain.programs / "jointcreep", "study", study, "-o", self.folder / "out"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn('"stage.bench.date" varies, so histories of runs cannot be put beside each other', done.stderr)


class Slope(Realizations):
    """The real slope, for a few realizations: programs are killed at work."""

    count = 3

    def setUp(self):
        self.text = self.chain.text("data/slope/scene.toml")
        super().setUp()

    def test_same_statistics(self):
        one = self.made(self.folder / "one")
        self.assert_same(one, self.made(self.folder / "two", None, "-j2"))
        out = self.folder / "out"
        self.stopped(out, self.programs(), lambda pid: os.kill(pid, signal.SIGKILL), 1)
        self.stopped(out, self.programs(hangs(2)), lambda pid: os.killpg(pid, signal.SIGINT), 2)
        self.assert_same(one, self.made(out, None, "-j2"))


def wait_until(condition, what="nothing happened"):
    end = time.monotonic() + LONGEST_RUN
    while not condition():
        if time.monotonic() > end:
            raise AssertionError(what)
        time.sleep(0.01)


if __name__ == "__main__":
    main()
