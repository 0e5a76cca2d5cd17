"""Factors of safety against closed forms, and what is left of a run that finds no equilibrium."""

import math
import re

import h5py
import numpy as np
from chain import ChainTest, changed, datasets, main
from events_test import WEDGE
from small_scene import held, joint, material, scene

DIP = math.radians(25)  # of data/verification/incline: a block of 10 m x 1 m, loaded by 1 MPa straight down
SMOOTH = """
[[joint_material]]
name = "smooth"
normal_stiffness_MPa_per_m = 100
shear_stiffness_MPa_per_m = 1
cohesion_MPa = 0
friction_angle_deg = 0
tensile_strength_MPa = 0

[[joint]]
name = "between"
from_m = [4.531538935183, 2.113091308703]
to_m = [4.10892067344, 3.01939909574]
material = "smooth"
"""
FIRM = """
[[joint_material]]
name = "firm"
normal_stiffness_MPa_per_m = 100
shear_stiffness_MPa_per_m = 40
cohesion_MPa = 0
friction_angle_deg = 45
tensile_strength_MPa = 0
"""
# A stage that takes the support away from under a block; the next stage would have taken the block, too.
HANGING = """
[section]
outline_m = [[0, 0], [10, 0], [10, 30], [0, 30]]
rock = "rock"
gravity_m_per_s2 = 9.81
[[rock]]
name = "rock"
density_kg_per_m3 = 2700
youngs_modulus_GPa = 20
poissons_ratio = 0.25
[[joint_material]]
name = "joint"
normal_stiffness_MPa_per_m = 5000
shear_stiffness_MPa_per_m = 2000
cohesion_MPa = 0
friction_angle_deg = 35
tensile_strength_MPa = 0
[[joint]]
name = "low"
from_m = [0, 10]
to_m = [10, 10]
material = "joint"
[[joint]]
name = "high"
from_m = [0, 20]
to_m = [10, 20]
material = "joint"
[in_situ_stress]
elevation_m = 30
compression_xx_MPa = 0
compression_yy_MPa = 0
shear_xy_MPa = 0
compression_xx_gradient_MPa_per_m = 0
compression_yy_gradient_MPa_per_m = 0.026487
shear_xy_gradient_MPa_per_m = 0
[[boundary]]
from_m = [0, 0]
to_m = [10, 0]
fix = "xy"
[schedule]
end = 3
[[stage]]
name = "the middle one"
date = 1
remove_m = [[[0, 10], [10, 10], [10, 20], [0, 20]]]
[[stage]]
name = "the upper one"
date = 2
remove_m = [[[0, 20], [10, 20], [10, 30], [0, 30]]]
[[point]]
name = "floor"
at_m = [5, 5]
[zones]
size_m = 4
"""


class Safety(ChainTest):
    def bracket(self, text, *options):
        """Lower and upper end of the factor of safety, and the names of the files at these."""
        joints = self.chain.joints(text)
        output = joints.with_name("result.h5")
        done = self.chain.answer("demsolve", joints, "--no-creep", "--factor-of-safety", "-o", output, *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        factor, stands = (datasets(output)[f"/safety/{name}"] for name in ("factor", "stands"))
        low, high = factor[stands == 1].max(), factor[stands != 1].min()
        self.assertTrue((stands >= 0).all())
        if "-q" not in options:
            self.assertRegex(done.stdout, f"factor of safety, at least +{low:.15g}\n")
            self.assertRegex(done.stdout, f"factor of safety, below +{high:.15g}\n")
        return low, high, output, output.with_name("result.failed.h5")

    def assert_factor(self, wanted, text, *options, width=0.01):
        low, high, *files = self.bracket(text, *options)
        self.assertLessEqual(low, wanted)
        self.assertLess(wanted, high)
        self.assertLessEqual(high - low, width * low)
        return files

    def incline(self, *changes):
        text = self.chain.text("data/verification/incline/scene.toml")
        for pattern, replacement in changes:
            text = changed(text, pattern, replacement)
        return text

    def test_a_block_on_an_incline(self):
        """F = (c + q cos(b) tan(phi)) / (q sin(b)), q = 1 MPa"""
        for cohesion in 0, 0.1:
            wanted = (cohesion + math.cos(DIP) * math.tan(math.radians(35))) / math.sin(DIP)
            text = self.incline(*[("^cohesion_MPa = 0", f"cohesion_MPa = {cohesion}")] * (cohesion > 0))
            stands, failed = self.assert_factor(wanted, text, "--safety-width", "0.001", width=0.001)
        # Each file is what a run with its factor alone would have been.
        with h5py.File(stands) as file:
            options = file["/provenance/options"].asstr()[-1]
        self.assertRegex(options, "--strength-factor [0-9.]+ --no-creep")
        alone = stands.with_name("alone.h5")
        self.chain.run("demsolve", stands.with_name("joints.h5"), alone, *options.split())
        alone, found = datasets(alone), datasets(stands)
        for name in (name for name in found if not name.startswith("/safety/")):
            np.testing.assert_array_equal(found[name], alone[name], name)
        self.assertNotIn("/failure/reason", found)
        self.assertEqual(datasets(failed)["/failure/block"].tolist(), [0])

    def test_a_vertical_cut_in_clay(self):
        """F = 1.20. Zones that lock would stand on, far beyond: what ends the search is displacement without bound. With three
        zones over the height quadratic ones are 9 percent above, constant strain 38."""
        text = self.chain.text("data/verification/vertical-cut/scene.toml")
        for kind, above in ("quadratic", 0.10), ("constant strain", 0.42):
            with self.subTest(kind=kind):
                low, high, stands, failed = self.bracket(changed(text, r"^\[zones\]$", f'[zones]\nkind = "{kind}"'), "-q")
                self.assertGreater(low, 1.20)
                self.assertLess(high, 1.20 * (1 + above))
                data = datasets(stands)
                firm, *others = data["/safety/largest_displacement"]
                for displacement, plastic, has_stood in zip(others, data["/safety/largest_plastic_strain"][1:],
                                                            data["/safety/stands"][1:]):
                    self.assertEqual(displacement <= 10 * firm, has_stood == 1)
                    self.assertGreater(plastic, 0)
                self.assertIn("grows without bound", datasets(failed)["/failure/reason"][0])
                if kind == "constant strain":  # they lock whatever their size: 34 percent above with three zones and with six
                    self.assertEqual(len(data["/safety/coarse_factor"]), 0)
                    self.assertRegex(data["/warnings/text"][0], "^zones of constant strain lock where rock yields")
                    continue
                # The error is proportional to the size of zones: what they add is estimated by zones twice as large.
                factor, coarse_stands = data["/safety/coarse_factor"], data["/safety/coarse_stands"]
                coarse = (factor[coarse_stands == 1].max() + factor[coarse_stands != 1].min()) / 2
                fine = (low + high) / 2
                self.assertAlmostEqual((2 * fine - coarse) / 1.20, 1, delta=0.04)
                self.assertRegex(data["/warnings/text"][0], "^the factor of safety is too high by about [0-9.]+ percent")

    def test_runs_side_by_side(self):
        """The same bytes as one by one, with and without checkpoints. Each run is told with the bracket so far."""
        joints = self.chain.joints(self.incline())
        cut = self.chain.joints(self.chain.text("data/verification/vertical-cut/scene.toml"))
        for path, *options in (joints, "--no-creep"), (joints, "--no-creep", "--engine", "relaxation", "--tolerance", 1e-5), (cut,):
            files = {}
            for at_once, *more in ("1",), ("2",), ("3", "--checkpoint", path.with_name("kept.h5")):
                path.with_name("kept.h5").unlink(missing_ok=True)
                done = self.chain.answer("demsolve", path, "--factor-of-safety", "-o", path.with_name("result.h5"), *options,
                                         "--safety-width", 0.02, "--runs-at-once", at_once, *more)
                self.assertEqual(done.returncode, 0, done.stderr)
                files[at_once] = [path.with_name(name).read_bytes() for name in ("result.h5", "result.failed.h5")]
                files[at_once] += [done.stdout, done.stderr]
            for at_once in "2", "3":
                self.assertTrue(files[at_once] == files["1"], (path, options, at_once))
            data = datasets(path.with_name("result.h5"))
            self.assertIn("demsolve: run 1, strengths x 64: stable, for comparison\n", done.stderr)
            said = re.findall(r"^demsolve: run (\d+), strengths / (\S+): (\w+); factor of safety at least (.*)$", done.stderr, re.MULTILINE)
            self.assertEqual([[1, 1 / 64, "stable"], *([int(number), float(factor), stands] for number, factor, stands, _ in said)],
                             [[number, factor, "stable" if stands else "fails"] for number, (factor, stands) in
                              enumerate(zip(data["/safety/factor"], data["/safety/stands"]), start=1)])
            low, high = said[-1][3].split(", below ")
            self.assertEqual((float(low), float(high)), (data["/safety/factor"][data["/safety/stands"] == 1].max(),
                                                         data["/safety/factor"][data["/safety/stands"] == 0].min()))
            left = [re.search(r"; at most (\d+) more runs?$", bracket) for _, _, _, bracket in said]
            self.assertTrue(all(n is None or int(n[1]) >= len(left) - i for i, n in enumerate(left, start=1)), said)
            self.assertTrue(any(left) and left[-1] is None, said)
            self.assertEqual("demsolve: with zones twice as large, run 1, " in done.stderr, path == cut)
        self.assertEqual(self.chain.answer("demsolve", joints, "-q", "--no-creep", "--factor-of-safety", "-o",
                                           joints.with_name("quiet.h5")).stderr, "")

    def test_warnings_are_said_and_kept(self):
        """Also with --quiet: too large a plastic strain, in the file with the name of the program."""
        text = changed(self.chain.text("data/verification/vertical-cut/scene.toml"), r"^\[zones\]$",
                       '[zones]\nkind = "quadratic"')
        joints = self.chain.joints(text)
        output = joints.with_name("result.h5")
        done = self.chain.answer("demsolve", joints, "-q", "--strength-factor", "1.304", "-o", output)
        self.assertEqual((done.returncode, done.stdout), (0, ""))
        said = re.fullmatch("demsolve: warning: (plastic shear strain of .*)\n", done.stderr)
        self.assertIsNotNone(said, done.stderr)
        data = datasets(output)
        self.assertEqual((data["/warnings/program"].tolist(), data["/warnings/text"].tolist()), (["demsolve"], [said[1]]))
        quiet = self.chain.run("demsolve", joints, joints.with_name("quiet.h5"), "-q")
        self.assertNotIn("/warnings/text", datasets(quiet))

    def test_large_displacements_are_warned_of(self):
        """Of the section of 30 by 20 m: its diagonal is 36 m."""
        joints = self.chain.joints(changed(self.chain.small(), "^youngs_modulus_GPa = .*$", "youngs_modulus_GPa = 0.0015"))
        done = self.chain.answer("demsolve", joints, "-q", "-o", joints.with_name("result.h5"))
        self.assertEqual(done.returncode, 0, done.stderr)
        said = re.fullmatch(r"demsolve: warning: displacement of (\S+) m, (\S+) percent of the section's size: too much .*\n", done.stderr)
        self.assertIsNotNone(said, done.stderr)
        with h5py.File(joints.with_name("result.h5")) as file:
            largest = np.linalg.norm(file["/states/displacement"][-1], axis=-1).max()
        self.assertAlmostEqual(float(said[1]), largest, delta=2e-3)
        self.assertAlmostEqual(float(said[2]), 100 * float(said[1]) / np.hypot(30, 20), delta=5e-3)

    def test_warnings_are_counted(self):
        """At the end of each summary, those of earlier programs apart; the file has both."""
        text = changed(self.chain.text("data/verification/incline/scene.toml"), "^.*_kelvin_.*\n", "", count=4)  # nothing creeps
        folder = self.chain.new_folder()
        (folder / "scene.toml").write_text(text)
        last = None
        for program, source, output, count in (("jointgen", "scene.toml", "network.h5", "1"),
                                               ("strength-averaging", "network.h5", "joints.h5", "0, and 1 of earlier programs"),
                                               ("demsolve", "joints.h5", "result.h5", "1, and 1 of earlier programs")):
            done = self.chain.answer(program, folder / source, "-o", folder / output)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertRegex(done.stdout.splitlines()[-1], f"^warnings +{count}$")
            self.assertEqual(done.stderr.count(": warning: "), int(count[0]))
            last = datasets(folder / output)
        self.assertEqual(last["/warnings/program"].tolist(), ["jointgen", "demsolve"])

    def test_two_blocks_on_an_incline(self):
        """The upper one pushes the lower one where it is the weaker of the two; it cannot pull it."""
        for upper, lower in ("joint", "firm"), ("firm", "joint"):
            text = self.incline(
                (r'^to_m = \[9.063077870367, 4.226182617407\]\njoint = "joint"',
                 f'to_m = [4.531538935183, 2.113091308703]\njoint = "{lower}"\n\n[[boundary]]\n'
                 f'from_m = [4.531538935183, 2.113091308703]\nto_m = [9.063077870367, 4.226182617407]\njoint = "{upper}"'))
            weak, firm = math.tan(math.radians(35)), math.tan(math.radians(45))
            wanted = ((weak + firm) / 2 if upper == "joint" else weak) / math.tan(DIP)
            with self.subTest(upper=upper):
                _, failed = self.assert_factor(wanted, text + SMOOTH + FIRM)
                place = datasets(failed)["/failure/place"]
                self.assertEqual(len(place), 2 if upper == "joint" else 1)
                self.assertTrue((place[-1] if upper != "joint" else place.min(axis=0))[0] < 4.3)

    def test_a_wedge_with_a_tension_crack(self):
        """Plane failure: the crack 2 m behind the joint's outcrop bears no tension, what is before it goes by itself."""
        steep = math.atan2(10, 7)
        text = changed(WEDGE.format(end="[21, 14]"), "^friction_angle_deg = 35", "friction_angle_deg = 60")
        self.assert_factor(math.tan(math.radians(60)) / math.tan(steep), text, "--zone-size", "4")
        crack = '[[joint]]\nname = "crack"\nfrom_m = [16, 24]\nto_m = [16, 21.142857]\nmaterial = "clay"\n'
        text = changed(text, r"^\[in_situ_stress\]", crack + "[in_situ_stress]")
        self.assert_factor(math.tan(math.radians(60)) / math.tan(steep), text, "--zone-size", "4")

    def test_strength_that_decides_nothing(self):
        done = self.chain.answer("demsolve", self.chain.joints(HANGING), "--factor-of-safety", "-o",
                                 self.chain.new_folder() / "result.h5")
        self.assertEqual(done.returncode, 3)
        self.assertIn("with strengths 64 times as large there is still no equilibrium", done.stderr)
        stack = HANGING[:HANGING.index("[[stage]]")] + HANGING[HANGING.index("[[point]]"):]
        output = self.chain.new_folder() / "result.h5"
        done = self.chain.answer("demsolve", self.chain.joints(stack), "--factor-of-safety", "-o", output)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, "factor of safety, at least +64\nruns +8\nfactor of safety, below +none found")
        self.assertFalse(output.with_name("result.failed.h5").exists())

    def test_merged_blocks_are_told(self):
        """Only runs with reduced strengths tell them, and only if their area is not small."""
        text = self.chain.text("tests/pipeline/random_slope.toml")
        for shortest in 0.6, 0.1:
            network = self.chain.network(changed(text, "^shortest_edge_m = .*", f"shortest_edge_m = {shortest}"))
            joints = self.chain.run("strength-averaging", network, network.with_name("joints.h5"))
            area = datasets(network)["/cutting/merged_block_area"][0]
            told = (f"blocks of {area:.4g} m2, [0-9.]+ thousandths of the jointed rock, are merged into others, which can change the factor "
                    f"of safety. Compare with a third of .cutting. shortest_edge_m, {shortest} m")
            for options in ("--strength-factor", "1.01"), ("--factor-of-safety", "--safety-width", "1"), ():
                with self.subTest(shortest=shortest, options=options):
                    done = self.chain.answer("demsolve", joints, "-q", "--no-creep", *options, "-o", joints.with_name("result.h5"))
                    self.assertEqual(done.returncode, 0, done.stderr)
                    (self.assertRegex if shortest == 0.6 and options else self.assertNotRegex)(done.stderr, told)

    def test_refusals(self):
        joints = self.chain.joints(HANGING)
        for options, said in ((("--strength-factor", "0"), "must be at least"),
                              (("--strength-factor", "2", "--factor-of-safety"), "do not go together"),
                              (("--safety-width", "0.1"), "goes with --factor-of-safety only"),
                              (("--factor-of-safety", "--safety-width", "1e-4", "--tolerance", "1e-5"), "100 times"),
                              (("--factor-of-safety", "--engine", "implicit"), "cannot show")):
            done = self.chain.answer("demsolve", joints, "-o", joints.with_name("result.h5"), *options)
            self.assertEqual(done.returncode, 2, options)
            self.assertIn(said, done.stderr)

    def test_a_block_on_a_rough_incline(self):
        """F = tan(phi_r + JRC log10(JCS / p)) / tan(b), with the pressure p = q cos(b) that does not depend on F. A block
        as thin as 0.1 m, lest the pressure be larger downhill: friction falls with it."""
        rough = "joint_roughness_coefficient = 8\njoint_wall_strength_MPa = 50\nlargest_closure_mm = 1"
        text = self.incline(("^friction_angle_deg = 35", f"friction_angle_deg = 28\n{rough}"),
                            ("(?:^(?:normal|shear)_kelvin_.*\n){4}", ""))
        thin = (9.063077870367 - 0.0422618261741, 4.226182617407 + 0.0906307787037), (-0.0422618261741, 0.0906307787037)
        for thick, (x, y) in zip((r"8.640459608626, 5.132490404444", r"-0.422618261741, 0.906307787037"), thin):
            text = changed(text, re.escape(f"[{thick}]"), f"[{x}, {y}]", 2)
        pressure = math.cos(DIP)  # [MPa]: 1 MPa straight down, per area of the joint, has this part across it
        wanted = math.tan(math.radians(28 + 8 * math.log10(50 / pressure))) / math.tan(DIP)
        stands, _ = self.assert_factor(wanted, text, "--safety-width", "0.001", width=0.001)
        data = datasets(stands)
        length = data["/mesh/contact_length"]
        sigma_n, tau = length @ data["/states/traction"][-1] / length.sum()
        self.assertAlmostEqual(-sigma_n / 1e6 / pressure, 1, delta=1e-4)
        self.assertAlmostEqual(abs(tau / sigma_n) / math.tan(DIP), 1, delta=1e-4)

    def test_rock_that_yields(self):
        """A block squeezed from above, free at its sides, bears 2 c (t + sqrt(1 + t^2)), t = tan(phi); with c / F and t / F
        for c and t as much as the load q, from which F = 2 c sqrt(1 + q t / c) / q."""
        cohesion, friction, load = 1.0, math.tan(math.radians(30)), 2.0  # [MPa]
        strength = (f'law = "Mohr-Coulomb"\ncohesion_MPa = {cohesion}\nfriction_angle_deg = 30\ntensile_strength_MPa = 1\n'
                    "dilation_angle_deg = 0\n")
        text = scene([[0, 0], [1, 0], [1, 2], [0, 2]], [],
                     [held([0, 0], [1, 0], "y"), held([0, 0], [0, 2], "x"),
                      {"from_m": [1, 2], "to_m": [0, 2], "traction_MPa": [0, -load], "load_history": [[0, 0], [1, 1]]}],
                     [material("joint", 1000)], gravity=0, poisson=0.2)
        text = changed(text, r"^poissons_ratio = 0.2\n", "poissons_ratio = 0.2\n" + strength)
        factor = 2 * cohesion * math.sqrt(1 + load * friction / cohesion) / load
        reduced = friction / factor  # the load by the other formula
        self.assertAlmostEqual(2 * cohesion / factor * (reduced + math.hypot(1, reduced)), load)
        self.assert_factor(factor, text)


class NoEquilibrium(ChainTest):
    def failed(self, text, *options, code=3):
        """The message, and what is left."""
        joints = self.chain.joints(text)
        output = joints.with_name("result.h5")
        output.write_text("what was here before")
        done = self.chain.answer("demsolve", joints, "-o", output, *options)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertEqual(output.read_text(), "what was here before")
        return done.stderr, output.with_name("result.failed.h5")

    def test_a_wedge_that_slides_is_named_with_its_displacement(self):
        for engine in "auto", "relaxation":
            message, path = self.failed(WEDGE.format(end="[21, 14]") + '[[point]]\nname = "A"\nat_m = [20, 22]\n',
                                        "--engine", engine)
            left = datasets(path)
            self.assertEqual(left["/failure/block"].size, 1)
            block = left["/failure/block"][0]
            np.testing.assert_allclose(left["/failure/place"][0], [56 / 3, 62 / 3], atol=0.02)
            motion = left["/failure/motion"][0]
            self.assertAlmostEqual(motion[1] / motion[0], -10 / 7, delta=0.05)
            self.assertEqual((left["/failure/stage"][0], left["/failure/time"][0], left["/failure/moves_on"][0]),
                             ("cut", 1, 1))
            self.assertIn(f'stage "cut"; moving blocks: block {block} at [18.6', message)
            self.assertIn(str(path), message)
            # Up to the last equilibrium: the state before the stage, at rest.
            self.assertEqual(left["/states/time"].tolist(), [0, 1])
            self.assertEqual(set(left["/states/event"]), {""})
            self.assertEqual(left["/history/displacement"].shape[0], 2)
            self.assertLess(abs(left["/states/displacement"]).max(), 1e-3)

    def test_with_real_masses_it_says_how_fast(self):
        _, path = self.failed(WEDGE.format(end="[21, 14]") + '[equilibrium]\nmasses = "real"\ndamping = "mass"\n'
                              "mass_damping_per_s = 0.01\nstiffness_damping_s = 1e-4\ntolerance = 1e-3\n", "--zone-size", "4")
        left = datasets(path)
        # From rest it slides with g (sin b - cos b tan(phi)) along the joint, until it has moved by a tenth of the
        # section; the mean speed of the last steps is that in the middle of their time.
        steep, far, seconds = math.atan2(10, 7), math.hypot(40, 24) / 10, left["/failure/seconds"][0]
        acceleration = 9.81 * (math.sin(steep) - math.cos(steep) * math.tan(math.radians(35)))
        wanted = math.sqrt(2 * acceleration * far) - acceleration * seconds / 2
        self.assertGreater(seconds, 0)
        self.assertAlmostEqual(np.linalg.norm(left["/failure/motion"][0]) / seconds / wanted, 1, delta=0.03)

    def test_rock_that_nothing_holds_is_named_before_any_step(self):
        message, path = self.failed(HANGING)
        left = datasets(path)
        self.assertEqual(left["/failure/steps"].tolist(), [0])
        np.testing.assert_allclose(left["/failure/place"], [[5, 25]], atol=1e-9)
        self.assertIn("no boundary and no contact supports", message)
        self.assertIn('on day 1, stage "the middle one"', message)
        # Nothing was sought after the stage: only the in-situ equilibrium is there.
        self.assertEqual(left["/equilibria/time"].tolist(), [0])

    def test_without_an_in_situ_equilibrium_there_is_the_state_given(self):
        text = changed(HANGING, 'fix = "xy"', 'fix = "x"')
        _, path = self.failed(text)
        left = datasets(path)
        self.assertEqual(left["/failure/block"].size, 3)
        self.assertEqual((left["/equilibria/time"].size, left["/states/time"].tolist()), (0, [0]))
        self.assertEqual(abs(left["/states/displacement"]).max(), 0)
        exported = path.with_name("zones.vtu")
        done = self.chain.answer("jointexport", path, "-o", exported)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stderr, "warning: the run of .* ended early: no equilibrium")

    def test_small_displacements_end_at_a_tenth_of_the_section(self):
        """A joint would close by 10 m in a section of 6 m. No increment is large where they are halved."""
        loaded = {"from_m": [2, 6], "to_m": [0, 6], "traction_MPa": [0, -0.1], "load_history": [[0, 0], [1, 1]]}
        text = scene([[0, 0], [2, 0], [2, 6], [0, 6]], [joint("soft", [-1, 2], [3, 2])], [held([0, 0], [2, 0]), loaded],
                     [material("joint", 0.01)], gravity=0)
        for engine, said in (("auto", "since the in-situ state, by more than a tenth of the section"),
                             ("implicit", "more than a tenth of the section"), ("relaxation", "is still moving")):
            message, path = self.failed(text, "--engine", engine)
            self.assertIn(said, message)
            found = abs(datasets(path)["/states/displacement"]).max()
            self.assertLess(found, math.hypot(2, 6) / 10)
            if engine == "auto":
                self.assertGreater(found, 0.3, "it goes as far as that")
                self.assertEqual(datasets(path)["/failure/moves_on"].tolist(), [0])

    def test_rock_that_comes_to_rest_slowly_is_not_said_to_fall(self):
        """The first quarter of a slow swing; next to no motion for damping; joints of 1 and 1e9 MPa/m in one stack."""
        stack = [[0, 0], [2, 0], [2, 6], [0, 6]]
        loaded = {"from_m": [2, 6], "to_m": [0, 6], "traction_MPa": [0, -0.1], "load_history": [[0, 0], [1, 1]]}
        two = scene(stack, [joint("one", [-1, 2], [3, 2], "soft"), joint("other", [-1, 4], [3, 4], "hard")],
                    [held([0, 0], [2, 0]), loaded], [material("soft", 1), material("hard", 1e9)], gravity=0)
        corner = scene([[0, 0], [10, 0], [10, 10], [0, 10]], [joint("corner", [9.98, 10.01], [10.01, 9.98])],
                       [{"from_m": [0, 0], "to_m": [10, 0], "joint": "joint"}, held([0, 0], [0, 10], "x"),
                        held([10, 0], [10, 10], "x")], [material("joint", 10)], zone=5,
                       more="[cutting]\nshortest_edge_m = 1e-4\n")
        column = re.sub(r"(?s)^\[(equilibrium|creep)\].*?(?=^\[|\Z)", "", self.chain.text("data/column/scene.toml"),
                        flags=re.MULTILINE)
        steps = "[equilibrium]\nengine = \"relaxation\"\nmost_steps = 60000\n"
        damped = steps + 'masses = "real"\ndamping = "mass"\nmass_damping_per_s = '
        for name, text in (("swing", corner + damped + "20\n"), ("damped", column + damped + "1e6\n"),
                           ("soft and hard", two + steps)):
            with self.subTest(name=name):
                message, path = self.failed(text)
                self.assertIn("after 60000 steps", message)
                self.assertEqual(datasets(path)["/failure/moves_on"].tolist(), [0])

    def test_what_ends_without_an_answer_says_so(self):
        """Also where the last step is one at which the solver looks for moving blocks, and begins to count anew."""
        for steps in 3000, 5000:
            with self.subTest(steps=steps):
                _, path = self.failed(WEDGE.format(end="[21, 14]") + f'[equilibrium]\nengine = "relaxation"\nmost_steps = {steps}\n')
                found = datasets(path)
                self.assertEqual((found["/failure/moves_on"].tolist(), found["/failure/steps"].tolist()), ([0], [steps]))
                self.assertTrue((np.linalg.norm(found["/failure/motion"], axis=1) > 0).all())
                self.assertGreater(len(found["/failure/block"]), 0)


if __name__ == "__main__":
    main()
