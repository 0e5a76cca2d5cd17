"""A run that goes on from a checkpoint gives the bytes of the run that was never interrupted."""

import json
import math
import os
import pathlib
import re
import resource
import shutil
import signal
import subprocess
import time

import h5py
import numpy as np

from chain import ChainTest, changed, datasets, main
from large_creep_test import LARGE, RIGID, slope, stack
from large_displacements_test import incline
from small_scene import held, joint, material, scene

SCENE = pathlib.Path(__file__).with_name("benches.toml").read_text()


def sliding_block(more):
    """A block slides down to a ledge, rests there, and slides on to a wall when the ledge goes."""
    text = incline(30, 25, length=9, more=more)
    outline = re.search(r"^outline_m = (.*)$", text, re.MULTILINE).group(1)
    corners = json.loads(outline)

    def place(down, off):
        c, s = math.cos(math.radians(30)), math.sin(math.radians(30))
        return [round(down * c + off * s, 9), round((9 - down) * s + off * c, 9)]

    ledge = [place(7, 0), place(7, 1), place(6, 1), place(6, 0)]
    foot = corners.index(place(8, 0)) + 1
    text = text.replace(outline, str(corners[:foot] + ledge + corners[foot:]))
    stage = f'[[stage]]\nname = "ledge removed"\ndate = 1.5\nremove_m = [{ledge}]\n[[point]]'
    return changed(text, r"^\[\[point\]\]", stage)


class Restart(ChainTest):
    def run_all(self, text, days, *arguments, threads=()):
        """Bytes of the result, of the last checkpoint, and the summary: in one go, and in runs that end on these
        days and a last one, each of which goes on from where the one before had its last stage."""
        joints = self.chain.joints(text)

        def run(output, *more):
            done = self.chain.answer("demsolve", joints, "-o", output, "--checkpoint", output.with_name("kept.h5"),
                                     *arguments, *more)
            self.assertEqual(done.returncode, 0, done.stderr)
            return done.stdout

        whole, parts = self.chain.new_folder() / "result.h5", self.chain.new_folder() / "result.h5"
        told = [run(whole)]
        for day in days:
            run(parts, "--until", day)
            self.assertNotEqual(parts.read_bytes(), whole.read_bytes())
        went_on, told_after = run(parts, *threads).split("\n", 1)
        self.assertRegex(went_on, r'^continued from +stage ".*", day ')
        told.append(told_after)
        return [(path.read_bytes(), path.with_name("kept.h5").read_bytes(), screen.split())
                for path, screen in zip((whole, parts), told)]

    def assert_same(self, text, days, *arguments, threads=()):
        whole, parts = self.run_all(text, days, *arguments, threads=threads)
        for what, one, other in zip(("result", "checkpoint", "summary"), whole, parts):
            self.assertTrue(one == other, f"{what} of a run in parts differs, {arguments}")
        return whole

    def test_small_displacements(self):
        """The run stops after each stage. Steps of creep are cut at first and grow, are fixed, are recorded."""
        slow_start = changed(SCENE, "^tolerance_m = 1e-5", "tolerance_m = 2e-6\nfirst_step_days = 3")
        for text, *arguments in ((SCENE, "--states", 3),
                                 (SCENE, "--engine", "relaxation", "--creep-scheme", "linear-force", "--step-history", 300),
                                 (slow_start, "--creep-scheme", "backward"),
                                 (SCENE, "--creep-scheme", "published", "--creep-step", 1)):
            with self.subTest(arguments=arguments):
                self.assert_same(text, (6, 17, 30), *arguments)

    def test_the_scene_has_it_all(self):
        """Otherwise the test above would say little: what a stage begins with is not what a section begins with."""
        joints = self.chain.joints(SCENE)
        kept = joints.with_name("kept.h5")
        self.chain.run("demsolve", joints, joints.with_name("result.h5"), "--checkpoint", kept)
        values = datasets(kept)
        for name in ("slip", "dilation", "is_broken", "offset", "crept", "rock_crept", "plastic_strain", "remark_count"):
            self.assertTrue(np.any(values["/checkpoint/" + name]), name)
        self.assertEqual(set(values["/checkpoint/contact_status"]), {0, 1, 2, 3})
        self.assertGreater(len(values["/mesh/tie_stage"]), 0)
        self.assertGreater(values["/states/reset_state"].max(), 0)

    def test_threads(self):
        text = changed(SCENE, "^size_m = 2$", "size_m = 1.4")
        text = changed(text, '^law = "Mohr-Coulomb"$', 'law = "elastic"')
        result = self.assert_same(text, (17,), "--creep-step", 5, threads=("--threads", 2))[0]
        path = self.chain.new_folder() / "result.h5"
        path.write_bytes(result)
        self.assertGreater(len(datasets(path)["/mesh/zone_block"]), 2000)  # fewer are one thread's

    def test_dynamic_analysis(self):
        for more, psi in (('rigid_rocks = ["rock"]', 0), ("stiffness_damping_s = 3e-5\nrelease_s = 0.05", 0),
                          ('rigid_rocks = ["rock"]', 5)):
            with self.subTest(more=more, psi=psi):  # dilation ends beyond the ledge
                text = changed(sliding_block(more), "^tensile_strength_MPa = 0$", "tensile_strength_MPa = 0\n"
                               f"dilation_angle_deg = {psi}\ndilation_until_m = 3")
                result = self.assert_same(text, (1, 1.5))[0]
                path = self.chain.new_folder() / "result.h5"
                path.write_bytes(result)
                moved = np.linalg.norm(datasets(path)["/history/displacement"][:, 0], axis=1)
                self.assertAlmostEqual(moved.max(), 4, delta=0.05)
                self.assertLess(abs(moved - 2).min(), 0.05)  # at rest on the ledge

    def test_dynamic_analysis_of_rock_that_yields(self):
        """It is crushed a little where it comes down on the ledge, before the last stage, and again at the wall."""
        text = changed(sliding_block("stiffness_damping_s = 3e-5"), '^name = "rock"$',
                       'name = "rock"\nlaw = "Mohr-Coulomb"\ncohesion_MPa = 1\nfriction_angle_deg = 30\n'
                       "tensile_strength_MPa = 0.5\ndilation_angle_deg = 5")
        result, checkpoint, _ = self.assert_same(text, (1, 1.5))
        path, kept = (self.chain.new_folder() / "result.h5" for _ in range(2))
        path.write_bytes(result)
        kept.write_bytes(checkpoint)
        before, after = abs(datasets(kept)["/checkpoint/plastic_strain"]), abs(datasets(path)["/states/plastic_strain"][-1])
        self.assertGreater(before.max(), 1e-4)
        self.assertGreater(after.sum(), 1.01 * before.sum())

    def test_a_tie_that_has_parted_on_a_held_gridpoint(self):
        """A wedge goes, and the rock left and right of it meets only where it stands on the ground; then more goes."""
        text = scene([[0, 0], [6, 0], [6, 2], [0, 2]], [joint("flat", [-1, 1.2], [7, 1.3])], [held([0, 0], [6, 0])],
                     [material("joint", 1000)], stages=[[[[3, 0], [4, 2], [2, 2]]], [[[5, 0], [6, 0], [6, 2], [5, 2]]]],
                     points=[[1.5, 1.9]], end=4)
        for engine in "implicit", "relaxation":
            result = self.assert_same(text, (1, 2), "--engine", engine)[0]
            path = self.chain.new_folder() / "result.h5"
            path.write_bytes(result)
            data = datasets(path)
            at = data["/mesh/gridpoint_position"][data["/mesh/tie_gridpoint"]]
            is_held = (data["/mesh/gridpoint_fixed"][data["/mesh/tie_gridpoint"]] == 3).all(axis=1)
            self.assertTrue(((abs(at - [3, 0]) < 1e-9).all(axis=(1, 2)) & is_held & (data["/mesh/tie_stage"] == 0)).any())

    def assert_killed_goes_on(self, text, *arguments, kills):
        """A run that writes all checkpoints it can is killed after so many of them, at some moment, and goes on to the same
        files and summary. Returns what the runs that went on say of where they do so."""
        joints = self.chain.joints(text)

        def files_of(name):
            files = (joints.with_name(f"{name}{end}.h5") for end in ("", ".failed"))
            return [file.read_bytes() if file.exists() else None for file in files]

        whole = self.chain.answer("demsolve", joints, "-o", joints.with_name("whole.h5"), *arguments)
        self.assertEqual(whole.returncode, 0, whole.stderr)
        went_on = []
        for n in kills:
            kept, result = joints.with_name(f"kept{n}.h5"), joints.with_name(f"result{n}.h5")
            command = [self.chain.programs / "demsolve", joints, "-o", result, "--checkpoint", kept, *map(str, arguments)]
            running = subprocess.Popen([*command, "--checkpoint-every", "1e-9"], stdout=subprocess.DEVNULL,
                                       stderr=subprocess.DEVNULL)
            seen = set()
            while len(seen) < n and running.poll() is None:
                if kept.exists():
                    seen.add(kept.stat().st_mtime_ns)
                time.sleep(0.001)
            running.kill()
            running.wait()
            self.assertFalse(result.exists(), "it was not killed in time")
            done = subprocess.run(command, capture_output=True, text=True, timeout=300)
            self.assertEqual(done.returncode, 0, done.stderr)
            place, summary = done.stdout.split("\n", 1)
            self.assertRegex(place, "^continued from ")
            went_on.append(place)
            self.assertEqual(summary.replace(f"result{n}.failed", "whole.failed").split(), whole.stdout.split())
            self.assertTrue(files_of(f"result{n}") == files_of("whole"), place)
        return went_on

    def test_a_run_that_is_killed_goes_on(self):
        self.assert_killed_goes_on(changed(SCENE, "^size_m = 2$", "size_m = 1.4"), kills=(1, 2))

    def test_in_the_middle_of_a_dynamic_relaxation(self):
        went_on = self.assert_killed_goes_on(SCENE, "--engine", "relaxation", kills=(3, 40, 90))
        self.assertTrue(any("in the middle of a search" in place for place in went_on), went_on)

    def test_in_the_middle_of_the_in_situ_equilibrium(self):
        """Its steps are recorded before the first row of the history."""
        options = ("--engine", "relaxation", "--no-creep", "--step-history", 20, "--tolerance", 1e-6)
        went_on = self.assert_killed_goes_on(SCENE, *options, kills=(3,))
        self.assertIn("in-situ", went_on[0])

    def test_in_the_middle_of_a_stage(self):
        """Between two increments by dynamic relaxation: these are not made again."""
        text = changed(SCENE, "^tolerance = 1e-4", "tolerance = 1e-4\nunloading_increments = 40")
        self.assert_killed_goes_on(text, "--engine", "relaxation", "--no-creep", kills=(40,))

    def test_between_creep_steps(self):
        went_on = self.assert_killed_goes_on(SCENE, "--creep-step", 0.05, kills=(3, 9))
        self.assertTrue(any("stage" not in place for place in went_on), went_on)

    def test_between_creep_steps_at_large_displacements(self):
        """Some steps are rejected, a block slides in one, and contacts form after it."""
        went_on = self.assert_killed_goes_on(stack(), kills=(3, 12, 25))
        self.assertTrue(any("stage" not in place for place in went_on), went_on)

    def test_in_the_middle_of_a_dynamic_analysis(self):
        for more in 'rigid_rocks = ["rock"]', "stiffness_damping_s = 3e-5\nrelease_s = 0.05":
            went_on = self.assert_killed_goes_on(sliding_block(more), kills=(40,))
            self.assertTrue(all("in the middle of a search" in place for place in went_on), went_on)

    def test_contacts_that_are_excavated_keep_their_creep(self):
        """Also where the run is killed in the dynamic analysis of the stage that excavates them."""
        text = changed(slope(LARGE + RIGID), "^end = 60", "end = 2")
        went_on = self.assert_killed_goes_on(text, kills=(8, 15, 20))
        self.assertTrue(any("in the middle of a search" in place and "stage 1" in place for place in went_on), went_on)

    def test_in_the_middle_of_a_search_for_a_factor_of_safety(self):
        """The runs that are decided are not made again."""
        search = ("--factor-of-safety", "--safety-width", 0.2, "--no-creep", "--engine", "relaxation")
        self.assert_killed_goes_on(SCENE, *search, kills=(10, 60))
        joints = self.chain.joints(SCENE)
        command = [joints, "-o", joints.with_name("result.h5"), *search, "--checkpoint", joints.with_name("kept.h5")]
        whole = self.chain.answer("demsolve", *command)
        self.assertEqual(whole.returncode, 0, whole.stderr)
        factors = datasets(joints.with_name("result.h5"))["/safety/factor"]
        kept = datasets(joints.with_name("kept.h5"))
        np.testing.assert_array_equal(kept["/safety/factor"], factors[:-1])  # before the run under way
        with h5py.File(joints.with_name("kept.h5"), "r+", libver=("v110", "v110")) as file:
            file["/safety/largest_displacement"][1] = 7  # of a run that is decided
        again = self.chain.answer("demsolve", *command)
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual(datasets(joints.with_name("result.h5"))["/safety/largest_displacement"][1], 7)

    def assert_stopped_goes_on(self, text, *arguments, when):
        """A run that SIGTERM stops, when `when` says so of its stderr so far and its checkpoint, keeps its state at once and ends by the
        signal. The same command continues from there to the same bytes. Returns what it says first, and the factors that were kept."""
        joints = self.chain.joints(text)
        whole = self.chain.run("demsolve", joints, joints.with_name("whole.h5"), *arguments)
        kept, result = joints.with_name("kept.h5"), joints.with_name("result.h5")
        command = [self.chain.programs / "demsolve", joints, "-o", result, "--checkpoint", kept, *map(str, arguments)]
        with subprocess.Popen([*command, "--checkpoint-every", "0"], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as running:
            os.set_blocking(running.stderr.fileno(), False)
            said = b""
            while not when(said, kept) and running.poll() is None:
                said += running.stderr.read() or b""
                time.sleep(0.001)
            running.send_signal(signal.SIGTERM)
            os.set_blocking(running.stderr.fileno(), True)
            said = (said + running.stderr.read()).decode()
        self.assertEqual(running.returncode, -signal.SIGTERM, said)
        self.assertRegex(said, "demsolve: stops when its state is kept in the checkpoint; a second signal stops it at once\n"
                         rf"(.*\n)*demsolve: stopped; the same command continues from {re.escape(str(kept))}\n$")
        self.assertFalse(result.exists())
        factors = datasets(kept).get("/safety/factor", ())
        done = subprocess.run(command, capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(result.read_bytes() == whole.read_bytes(), said)
        return done.stdout.split("\n")[0], done.stderr, factors

    def test_stopped_by_a_signal(self):
        place, *_ = self.assert_stopped_goes_on(sliding_block('rigid_rocks = ["rock"]'), when=lambda said, kept: kept.exists() and time.time() > kept.stat().st_mtime + 0.03)
        self.assertIn("in the middle of a search", place)
        for at_once in 1, 2:
            _, said, factors = self.assert_stopped_goes_on(
                SCENE, "--factor-of-safety", "--safety-width", 0.02, "--no-creep", "--engine", "relaxation", "--runs-at-once", at_once,
                when=lambda said, kept: b"run 3, " in said)
            self.assertGreaterEqual(len(factors), 3)
            self.assertRegex(said, rf"^demsolve: from .*/kept.h5: run {len(factors)}, strengths / {factors[-1]:.15g}: ")
            self.assertRegex(said, rf"\ndemsolve: run {len(factors) + 1}, ")

    def test_a_checkpoint_stays_if_the_next_cannot_be_written(self):
        joints = self.chain.joints(SCENE)
        kept = joints.with_name("kept.h5")
        arguments = [joints, "-o", joints.with_name("result.h5"), "--checkpoint", kept, "--no-creep"]
        self.assertEqual(self.chain.answer("demsolve", *arguments, "--until", 6).returncode, 0)
        before, names = kept.read_bytes(), sorted(path.name for path in joints.parent.iterdir())
        limit = len(before) + 1000  # bytes that a file may have
        command = [self.chain.programs / "demsolve", *map(str, arguments)]
        done = subprocess.run(command, capture_output=True, text=True, timeout=300,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
        self.assertEqual(done.returncode, 4)
        self.assertIn(f"{kept}: cannot write", done.stderr)
        self.assertTrue(kept.read_bytes() == before)
        self.assertEqual(sorted(path.name for path in joints.parent.iterdir()), names)

    def refusal(self, joints, kept, *arguments, code=2):
        """The message; nothing is written, and what was kept stays."""
        output, before = self.chain.new_folder() / "result.h5", kept.read_bytes()
        done = self.chain.answer("demsolve", joints, "-o", output, "--checkpoint", kept, *arguments)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertEqual(list(output.parent.iterdir()), [])
        self.assertTrue(kept.read_bytes() == before)
        return done.stderr

    def test_what_is_not_this_runs_checkpoint_is_refused(self):
        joints = self.chain.joints(SCENE)
        kept, result = joints.with_name("kept.h5"), joints.with_name("result.h5")
        self.chain.run("demsolve", joints, result, "--checkpoint", kept, "--no-creep", "--until", 17)
        other = self.chain.joints(changed(SCENE, "^date = 25", "date = 26"))
        self.assertRegex(self.refusal(other, kept, "--no-creep"), r"kept.h5: /provenance/input_sha256 is .*; expected that of ")
        self.assertRegex(self.refusal(joints, kept), r'kept.h5: /provenance/options is "--no-creep"; expected the same')
        self.assertRegex(self.refusal(joints, kept, "--no-creep", "--until", 15.5),
                         r"kept.h5: /checkpoint/time is day 16; expected not after --until 15.5")
        self.assertIn('this is a "jointcreep result" file; expected a "jointcreep checkpoint" file',
                      self.refusal(joints, result, "--no-creep", "--until", 17))
        self.assertRegex(self.refusal(joints, kept, "--no-creep", "--factor-of-safety"), "/provenance/options is .*; expected the same")
        alone = self.chain.answer("demsolve", joints, "-o", result, "--checkpoint-every", 5)
        self.assertEqual(alone.returncode, 2)
        self.assertIn("--checkpoint-every goes with --checkpoint only", alone.stderr)
        self.assertIn("--until is 0 day", self.refusal(joints, kept, "--until", 0))
        same = self.chain.answer("demsolve", joints, "-o", result, "--checkpoint", joints)
        self.assertEqual(same.returncode, 2)
        self.assertIn(f"--checkpoint {joints} is the same file as the input {joints}; give it another name", same.stderr)
        with h5py.File(kept, "r+", libver=("v110", "v110")) as file:
            version = file["/provenance/version"]
            version[-1] = b"0.0.1"
        self.assertRegex(self.refusal(joints, kept, "--no-creep"), r"/provenance/version is .*0.0.1.*; expected .*version of this program")

    def test_a_damaged_checkpoint_is_refused(self):
        joints = self.chain.joints(SCENE)
        kept = joints.with_name("kept.h5")
        self.chain.run("demsolve", joints, joints.with_name("result.h5"), "--checkpoint", kept, "--no-creep")
        copy = kept.with_name("copy.h5")
        with h5py.File(kept) as file:
            offset = {name: file[name].id.get_chunk_info(0).byte_offset
                      for name in ("checkpoint/displacement", "checkpoint/slip", "checkpoint/is_broken")}
        for name, place in offset.items():
            content = bytearray(kept.read_bytes())
            content[place] ^= 1
            copy.write_bytes(content)
            self.assertRegex(self.refusal(joints, copy, "--no-creep", code=4), f"copy.h5: .*/{name}")
        copy.write_bytes(kept.read_bytes()[:-1000])
        self.assertIn("copy.h5", self.refusal(joints, copy, "--no-creep", code=4))
        for name in "checkpoint/slip", "checkpoint/crept":
            shutil.copyfile(kept, copy)
            with h5py.File(copy, "r+", libver=("v110", "v110")) as file:
                del file[name]
            self.assertRegex(self.refusal(joints, copy, "--no-creep"), f"copy.h5: .*/{name}")
        shutil.copyfile(kept, copy)
        with h5py.File(copy, "r+", libver=("v110", "v110")) as file:
            file["checkpoint/slip"][3] = np.nan
        self.assertRegex(self.refusal(joints, copy, "--no-creep"), r"copy.h5: /checkpoint/slip\[3\] is nan; expected finite")
        self.chain.run("demsolve", joints, joints.with_name("with-creep.h5"), "--checkpoint", creeping := kept.with_name("creeping.h5"))
        shutil.copyfile(creeping, copy)
        with h5py.File(copy, "r+", libver=("v110", "v110")) as file:
            reference = file["checkpoint/reference"][()]
            attributes = dict(file["checkpoint/reference"].attrs)
            del file["checkpoint/reference"]
            file["checkpoint/reference"] = reference[:1]
            file["checkpoint/reference"].attrs.update(attributes)
        self.assertIn("copy.h5: the state kept is that of another section", self.refusal(joints, copy))


if __name__ == "__main__":
    main()
