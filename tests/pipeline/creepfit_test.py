"""creepfit finds constants back: of a curve by its formula, of the column by its closed form; and what it refuses."""

import csv
import math
import random
import subprocess
import sys

from chain import ChainTest, changed, main

TRUTH = {"kelvin-stiffness": 0.7, "kelvin-viscosity": 1.6, "joint-stiffness": 1.2}


def table(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


class Creepfit(ChainTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.joints = cls.chain.joints(cls.chain.text("data/column/scene.toml"))

    def readings(self, *options):
        """Readings of the column with other constants than the scene's."""
        path = self.chain.new_folder() / "readings.csv"
        script = self.chain.source / "pipelines" / "column" / "measured.py"
        subprocess.run([sys.executable, script, self.chain.source / "data/column/scene.toml", "-o", path, *options],
                       check=True)
        return path

    def found(self, measurements, *options, fit=",".join(TRUTH), joints=None):
        """Rows of the table that is written, by factor; and stdout."""
        folder = self.chain.new_folder()
        done = self.chain.answer("creepfit", joints or self.joints, "--measurements", measurements, "--fit", fit,
                                 *options, "-o", folder / "factors.csv", "--readings", folder / "fitted.csv")
        self.assertEqual(done.returncode, 0, done.stderr)
        return {row["factor"]: row for row in table(folder / "factors.csv")}, done.stdout, table(folder / "fitted.csv")

    def test_column_without_noise(self):
        """The readings are exact, so the factors are, to what the solver is off the closed form."""
        rows, _, fitted = self.found(self.readings("--sigma-mm", "1e-9"))
        for name, truth in TRUTH.items():
            self.assertAlmostEqual(float(rows[name]["value"]) / truth, 1, delta=2e-4)
            self.assertEqual(rows[name]["at_bound"], "no")
        for row in fitted:
            self.assertEqual(int(row["stages"]), sum(float(row["time_day"]) >= day for day in (1, 10, 20)))
            self.assertAlmostEqual(float(row["computed_mm"]), float(row["measured_mm"]), delta=1e-5)
            self.assertGreater(abs(float(row["computed_at_start_mm"]) - float(row["measured_mm"])), 0.03)

    def test_column_with_noise(self):
        """Of 10 sets of readings, 3 intervals each: 30 chances of 95 percent."""
        held = 0
        for seed in range(10):
            rows, text, _ = self.found(self.readings("--seed", str(seed)))
            held += sum(float(rows[name]["low_95"]) <= truth <= float(rows[name]["high_95"])
                        for name, truth in TRUTH.items())
        self.assertGreaterEqual(held, 26)
        self.assertIn("with the readings' sigma", text)
        self.assertIn("factor on Kelvin stiffness E", text)

    def test_histories_are_measurements(self):
        """What jointexport writes is read as it is: the scene's own history has factors of 1."""
        result = self.chain.run("demsolve", self.joints, self.chain.new_folder() / "result.h5")
        histories = self.chain.run("jointexport", result, result.with_name("histories.csv"))
        rows, _, _ = self.found(histories)
        for row in rows.values():
            self.assertAlmostEqual(float(row["value"]), 1, delta=1e-5)

    def test_what_has_not_converged_is_no_fit(self):
        """It is refused, quiet or not; the best so far is kept under another name, and says so."""
        folder = self.chain.new_folder()
        files = "-o", folder / "factors.csv", "--readings", folder / "fitted.csv"
        command = [self.joints, "--measurements", self.readings(), "--fit", ",".join(TRUTH), *files]
        for more in [], ["-q"]:
            done = self.chain.answer("creepfit", *command, "--runs", "2", *more)
            self.assertEqual((done.returncode, done.stdout), (3, ""))
            for words in "no fit was found in 2 runs", "expected more --runs", str(folder / "factors.failed.csv"):
                self.assertIn(words, done.stderr)
            self.assertEqual({path.name for path in folder.iterdir()}, {"factors.failed.csv", "fitted.failed.csv"})
            for row in table(folder / "factors.failed.csv"):
                self.assertEqual((row["converged"], row["runs"]), ("no", "2"))
        rows, _, _ = self.found(command[2])
        for name, row in rows.items():
            self.assertEqual(row["converged"], "yes")
            self.assertLess(float(row["chi_squared"]), 2 * float(row["degrees_of_freedom"]))
            self.assertLess(abs(float(row["value"]) / TRUTH[name] - 1), 0.5)
        named = folder / "other.failed.csv"
        named.write_bytes(command[2].read_bytes())
        done = self.chain.answer("creepfit", self.joints, "--measurements", named, "--fit", "joint-stiffness",
                                 "-o", folder / "other.csv")
        self.assertEqual(done.returncode, 2)
        self.assertIn(f"{named}, which a search that fails writes, is the same file as --measurements {named}", done.stderr)

    def test_bounds(self):
        rows, text, _ = self.found(self.readings(), fit="joint-stiffness=0.9:1.1,kelvin-viscosity")
        self.assertEqual((rows["joint-stiffness"]["at_bound"], rows["joint-stiffness"]["low_95"]), ("high", ""))
        self.assertAlmostEqual(float(rows["joint-stiffness"]["value"]), 1.1)
        self.assertIn("at its upper bound", text)

    def test_what_has_no_effect_is_named(self):
        """The column is free at its sides."""
        rows, text, _ = self.found(self.readings(), fit="kelvin-stiffness,horizontal-stress")
        self.assertEqual(rows["horizontal-stress"]["low_95"], "")
        self.assertIn("does not change these readings", text)

    def test_constants_that_are_not_resolved(self):
        """The column has no shear: warned of, without values for the scene if it has an effect at all; the exit code is 0."""
        names = "normal-kelvin-stiffness,normal-kelvin-viscosity,normal-joint-stiffness"
        rows, text, _ = self.found(self.readings("--sigma-mm", "1e-3"), fit=names)
        for name, row in rows.items():
            self.assertEqual(row["resolved"], "yes")
            self.assertLess(abs(float(row["value"]) / TRUTH[name.removeprefix("normal-")] - 1), 0.05)
        self.assertIn('joint material "base joint" by', text)
        self.assertIn("multiply all normal stiffnesses", text)
        self.assertNotIn("shear stiffnesses", text)
        folder = self.chain.new_folder()
        done = self.chain.answer("creepfit", self.joints, "--measurements", self.readings(), "--fit",
                                 f"{names},shear-kelvin-stiffness", "-o", folder / "f.csv")
        self.assertEqual(done.returncode, 0)
        self.assertIn("not resolved by these readings: shear-kelvin-stiffness", done.stderr)
        self.assertNotIn("In the scene", done.stdout)
        self.assertEqual([row["resolved"] for row in table(folder / "f.csv")], ["yes", "yes", "yes", "no"])

    def test_profile_intervals_and_an_ensemble(self):
        """Both are near the intervals by standard errors: readings determine the factors."""
        readings = self.readings("--sigma-mm", "1e-3")
        names = "kelvin-stiffness=0.5:2,joint-stiffness=0.5:2"
        exact, _, _ = self.found(readings, fit=names)
        for option, said in ("--profile-intervals", "runs of profile intervals"), ("--ensemble=6", ", by an ensemble of 6"):
            rows, text, _ = self.found(readings, option, fit=names)
            self.assertIn(said, text)
            for name, row in rows.items():
                width = math.log(float(exact[name]["high_95"]) / float(exact[name]["low_95"]))
                for column in "value", "low_95", "high_95":
                    self.assertLess(abs(math.log(float(row[column]) / float(exact[name][column]))), 0.1 * width, (option, name, column))

    def two_valleys(self):
        """Readings soon after the load that say that creep is over, and one late that says that it has not begun: eta has two minima. The
        search from 1 goes to the upper one, which is the worse."""
        path = self.chain.new_folder() / "readings.csv"
        path.write_text("time_day,point,component,displacement_mm,sigma_mm\n"
                        "2.9,C,y,0.815,0.1\n3.1,C,y,0.815,0.1\n9.9,C,y,0.423,0.08\n")
        return path

    def test_profiles_that_find_a_better_fit(self):
        """Said also with -q; no intervals and no values for the scene; from where it says the fit is better."""
        readings = self.two_valleys()
        name, fit = "kelvin-viscosity", "kelvin-viscosity=0.01:100"
        for more in [], ["-q"]:
            found = self.chain.new_folder() / "f.csv"
            done = self.chain.answer("creepfit", self.joints, "--measurements", readings, "--fit", fit, "--profile-intervals", "-o", found, *more)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("this fit is not the best: its sum of squares is 28.25", done.stderr)
            self.assertNotIn("In the scene", done.stdout)
            row, = table(found)
            self.assertEqual((row["low_95"], row["high_95"], row["low_95_all"], row["high_95_all"], row["resolved"]), ("", "", "", "", "no"))
            self.assertGreater(float(row["value"]), 1)
            self.assertLess(float(row["better_value"]), 0.5)
            start = done.stderr.split('Start from there: --fit "')[1].split('"')[0]
        rows, _, _ = self.found(readings, "--profile-intervals", fit=start)
        self.assertLess(float(rows[name]["chi_squared"]), 0.9 * float(row["chi_squared"]))
        self.assertEqual(rows[name]["better_value"], "")

    def test_readings_and_bounds_of_an_ensemble_that_do_not_agree(self):
        """K is 1.2; bounds of 0.8:0.9 do not contain it."""
        folder = self.chain.new_folder()
        done = self.chain.answer("creepfit", self.joints, "--measurements", self.readings(), "--fit",
                                 "kelvin-stiffness=0.4:3,kelvin-viscosity=0.4:6,joint-stiffness=0.8:0.9", "--ensemble", "8", "-o", folder / "f.csv")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("readings and bounds do not agree: the readings want joint-stiffness above", done.stderr)
        self.assertNotIn("In the scene", done.stdout)
        self.assertEqual([row["at_bound"] for row in table(folder / "f.csv")][2], "high")

    def test_an_ensemble_without_enough_answers(self):
        """With low viscosities the scene's creep step is too long for its scheme: no fit, and the best run is kept."""
        folder = self.chain.new_folder()
        done = self.chain.answer("creepfit", self.joints, "--measurements", self.readings(), "--fit",
                                 "kelvin-stiffness=0.05:0.2,kelvin-viscosity=0.01:2", "--ensemble", "6", "-o", folder / "f.csv", "--readings", folder / "r.csv")
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn("of 6 members have an answer; expected 6 or more", done.stderr)
        self.assertIn(str(folder / "f.failed.csv"), done.stderr)
        self.assertEqual({path.name for path in folder.iterdir()}, {"f.failed.csv", "r.failed.csv"})
        for row in table(folder / "f.failed.csv"):
            self.assertEqual(row["converged"], "no")

    def test_constants_of_a_material(self):
        """The closed form with another E of the base joint."""
        text = self.chain.text("data/column/scene.toml")
        base = text.index('name = "base joint"')
        other = text[:base] + changed(text[base:], "normal_kelvin_stiffness_MPa_per_m = 690", "normal_kelvin_stiffness_MPa_per_m = 460")
        rows, said, _ = self.found(self.history(other), fit="kelvin-stiffness@joint,kelvin-stiffness@base joint")
        self.assertAlmostEqual(float(rows["kelvin-stiffness@joint"]["value"]), 1, delta=1e-4)
        self.assertAlmostEqual(float(rows["kelvin-stiffness@base joint"]["value"]), 2 / 3, delta=1e-4)
        self.assertIn('of joint material "base joint" by 1, their Kelvin stiffnesses by 0.6666', said)

    def test_several_networks(self):
        """Intervals have the scatter of the networks; each network's own fit is in the table. Sameness and mistakes are refused."""
        text = self.chain.text("pipelines/reliability/small.toml")
        text = changed(changed(changed(text, "cohesion_MPa = 0.02", "cohesion_MPa = 2"), "tensile_strength_MPa = 0$", "tensile_strength_MPa = 2"),
                       "end = 10", "end = 20")
        scene = self.chain.new_folder() / "scene.toml"
        scene.write_text(text)
        joints = []
        for realization in range(5):
            network = self.chain.run("jointgen", scene, scene.with_name(f"n{realization}.h5"), "--realization", str(realization))
            joints.append(self.chain.run("strength-averaging", network, scene.with_name(f"j{realization}.h5")))
        result = self.chain.run("demsolve", joints[0], scene.with_name("r.h5"))
        history = self.chain.run("jointexport", result, scene.with_name("h.csv"))
        found = scene.with_name("found.csv")
        command = ["--measurements", history, "--fit", "joint-stiffness", "-o", found]
        done = self.chain.answer("creepfit", *joints[1:], *command)
        self.assertEqual(done.returncode, 0, done.stderr)
        row, = table(found)
        each = [math.log(float(row[f"value_{k}"])) for k in range(1, 5)]
        mean = sum(each) / 4
        self.assertAlmostEqual(math.log(float(row["value"])), mean, places=9)
        scatter = math.sqrt(sum((one - mean) ** 2 for one in each) / 3)
        self.assertAlmostEqual(float(row["scatter_of_logarithm"]), scatter, places=9)
        self.assertGreaterEqual(float(row["standard_error_of_logarithm"]), scatter * math.sqrt(5 / 4))
        self.assertEqual((row["networks"], row["resolved"]), ("4", "yes"))
        self.assertLess(float(row["low_95"]), 1)
        self.assertGreater(float(row["high_95"]), 1)
        self.assertIn("between networks x/", done.stdout)
        self.refused([*joints[1:], *command[:-2], "--readings", scene.with_name("x.csv")], "--readings is of one network")
        self.refused([joints[1], self.joints, *command[:-2]], "its scene is not that of")
        copy = scene.with_name("copy.h5")
        copy.write_bytes(joints[1].read_bytes())
        self.refused([*joints[1:4], copy, *command[:-2]], f"{copy}: the same network as {joints[1]}")
        self.refused(joints[1:3], "several files are given")

    def spoilt(self, spoil):
        """Readings of the column with `spoil(row, number)` mm added."""
        path = self.readings("--seed", "2")
        rows = table(path)
        for i, row in enumerate(rows):
            row["displacement_mm"] = float(row["displacement_mm"]) + spoil(row, i)
        with open(path, "w", newline="") as file:
            writer = csv.DictWriter(file, rows[0])
            writer.writeheader()
            writer.writerows(rows)
        return path

    def warned(self, path, *options):
        folder = self.chain.new_folder()
        done = self.chain.answer("creepfit", self.joints, "--measurements", path, "--fit", ",".join(TRUTH), "-o", folder / "f.csv", *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stderr, done.stdout, table(folder / "f.csv")

    def test_faults_of_readings(self):
        """Each is warned of and named where the fit does not know it; with its option it is found, and nothing is said."""
        for spoil, word, options, said in [
            (lambda row, i: 0.3 * (row["point"] == "C" and float(row["time_day"]) >= 31), "step",
             ["--steps", "31"], r"step on day 31, C, y +0\.(2[5-9]|3[0-5])"),
            (lambda row, i: 0.02 * (row["point"] == "C") * float(row["time_day"]), "drift", ["--drift"], r"drift, C, y +0\.0(1|2)"),
            (lambda row, i: 0.4 * (i == 20), "outlier", ["--robust"], r"outlier +C, y on day 11: residual 1?-?[0-9.]+ sigma"),
            (lambda row, i: 0.3 * (row["point"] == "B"), "offset", ["--offset"], r"offset, B, y +0\.(2[5-9]|3[0-5])"),
        ]:
            path = self.spoilt(spoil)
            with self.subTest(word):
                err, out, rows = self.warned(path)
                self.assertIn("residuals are no noise", err)
                self.assertIn("the fit is worse than the readings' sigma allow", err)
                self.assertNotIn("In the scene", out)
                self.assertTrue(all(row["doubt"] and float(row["doubt_p_value"]) < 0.01 for row in rows))
                err, out, rows = self.warned(path, *options)
                self.assertEqual(err, "")
                self.assertRegex(out, said)
                self.assertIn("In the scene", out)
                for row in rows:
                    self.assertLessEqual(float(row["low_95_all"]), TRUTH[row["factor"]])
                    self.assertGreaterEqual(float(row["high_95_all"]), TRUTH[row["factor"]])

    def test_faults_of_a_curve(self):
        curve = self.curve(730, noise=0.1)
        rows = [[float(row["time_day"]), float(row["displacement_mm"])] for row in table(curve)]
        for i, row in enumerate(rows):
            row[1] += (2 if row[0] >= 300 else 0) + (5 if i == 20 else 0)
        curve.write_text("".join(["time_day,displacement_mm\n", *(f"{day},{value}\n" for day, value in rows)]))
        out = curve.with_name("out.csv")
        done = self.chain.answer("creepfit", curve, "-o", out)
        self.assertIn("residuals are no noise", done.stderr)
        done = self.chain.answer("creepfit", curve, "-o", out, "--steps", "300", "--robust", "--stiffness", "690")
        self.assertNotIn("no noise", done.stderr)
        self.assertIn("on day 140: residual", done.stdout)
        found = {row["quantity"]: row for row in table(out)}
        for quantity, truth in ("Kelvin stiffness E", 480), ("retardation time", 120), ("step on day 300", 2):
            self.assertLessEqual(float(found[quantity]["low_95"]), truth)
            self.assertGreaterEqual(float(found[quantity]["high_95"]), truth)
        # Eq. 14 knows nothing of steps.
        self.assertEqual(found["E by Eq. 14"]["low_95"], "")

    def test_late_first_reading_has_no_interval_by_eq_14(self):
        curve = self.curve(1100, noise=0.1, seed=4)
        lines = curve.read_text().splitlines(keepends=True)
        curve.write_text("".join([lines[0], *lines[4:]]))  # from day 21 on
        out = curve.with_name("out.csv")
        done = self.chain.answer("creepfit", curve, "-o", out, "--load-day", "0", "--stiffness", "690")
        self.assertIn("first reading late", done.stderr)
        self.assertIn("it leaves out more than its noise", done.stdout)
        rows = {row["quantity"]: row for row in table(out)}
        for quantity in "E by Eq. 14", "eta by least squares with that E":
            self.assertEqual((rows[quantity]["low_95"], rows[quantity]["high_95"]), ("", ""))
        self.assertLess(float(rows["Kelvin stiffness E"]["low_95"]), 480)
        self.assertGreater(float(rows["Kelvin stiffness E"]["high_95"]), 480)

    def test_stress_for_the_scene(self):
        """A bench held at its sides: its horizontal stress is found, and how to write it, be it a law or a profile."""
        law = self.chain.text("tests/pipeline/bonded.toml")
        for rule in "joint", "lower bound":
            with_rule = law + f'\n[averaging]\nstiffness = "{rule}"\n'
            cut_at = with_rule.index("[in_situ_stress]"), with_rule.index("[[boundary]]")
            profile = (with_rule[:cut_at[0]] + "[in_situ_stress]\nelevation_m = 40\nprofile = [\n"
                       "  { depth_m = 0, compression_xx_MPa = 0.1, compression_yy_MPa = 0, shear_xy_MPa = 0 },\n"
                       "  { depth_m = 40, compression_xx_MPa = 0.5, compression_yy_MPa = 1.05948, shear_xy_MPa = 0 },\n"
                       "]\n\n" + with_rule[cut_at[1]:])
            stronger = changed(changed(profile, "xx_MPa = 0.1,", "xx_MPa = 0.125,"), "xx_MPa = 0.5,", "xx_MPa = 0.625,")
            history = self.history(stronger)
            text = self.found(history, fit="horizontal-stress,kelvin-stiffness", joints=self.chain.joints(profile))[1]
            self.assertIn("multiply all compression_xx_MPa of the profile of [in_situ_stress] by 1.25: 0.125 0.625.", text)
            self.assertIn("does not change these readings", text)
            self.assertNotIn("Kelvin stiffnesses", text)
        stronger = changed(law, "xx_gradient_MPa_per_m = 0.013", "xx_gradient_MPa_per_m = 0.01625")
        text = self.found(self.history(stronger), fit="horizontal-stress", joints=self.chain.joints(law))[1]
        self.assertIn("compression_xx_gradient_MPa_per_m = 0.01625\n", text)

    def history(self, scene):
        result = self.chain.result(scene)
        return self.chain.run("jointexport", result, result.with_name("history.csv"))

    def curve(self, days, step=7, noise=0.1, seed=3):
        """The paper's Table 2, normal direction, K 690 MPa/m: E 480 MPa/m, eta 57600 MPa day/m."""
        path = self.chain.new_folder() / "curve.csv"
        chance = random.Random(seed)
        lines = [f"{day},{4 + 4 * 690 / 480 * (1 - math.exp(-day / 120)) + chance.gauss(0, noise):.4f}"
                 for day in range(0, days, step)]
        path.write_text("\n".join(["time_day,displacement_mm", *lines, ""]))
        return path

    def test_curve(self):
        curve = self.curve(730)
        out = self.chain.run("creepfit", curve, curve.with_name("out.csv"), "--stiffness", "690")
        rows = {row["quantity"]: row for row in table(out)}
        for quantity, truth in ("Kelvin stiffness E", 480), ("Kelvin viscosity eta", 57600), ("retardation time", 120):
            self.assertLessEqual(float(rows[quantity]["low_95"]), truth)
            self.assertGreaterEqual(float(rows[quantity]["high_95"]), truth)
            self.assertAlmostEqual(float(rows[quantity]["value"]) / truth, 1, delta=0.1)
        # Eq. 14, from the file's own first and last readings.
        first, last = (float(row["displacement_mm"]) for row in (table(curve)[0], table(curve)[-1]))
        self.assertAlmostEqual(float(rows["E by Eq. 14"]["value"]), 690 * first / (last - first), places=6)

    def test_short_record(self):
        curve = self.curve(40, step=2, noise=0.1)
        done = self.chain.answer("creepfit", curve, "-o", curve.with_name("out.csv"))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("record too short", done.stderr)
        # The end that Eq. 14 takes is none: no interval.
        self.assertIn("too much for Eq. 14", done.stderr)
        rows = {row["quantity"]: row for row in table(curve.with_name("out.csv"))}
        self.assertEqual((rows["E by Eq. 14"]["low_95"], rows["E by Eq. 14"]["high_95"]), ("", ""))
        long = self.chain.answer("creepfit", self.curve(730), "-o", curve.with_name("out.csv"))
        self.assertNotIn("record too short", long.stderr)
        year = self.chain.answer("creepfit", self.curve(366, noise=1e-4), "-o", curve.with_name("out.csv"))
        self.assertIn("its E is too high, by a factor of about 1.05", year.stderr)
        noisy = self.chain.answer("creepfit", self.curve(730, step=60, noise=2.5), "-o", curve.with_name("out.csv"))
        self.assertIn("warning: E hardly known", noisy.stderr)
        self.assertNotIn("too short", noisy.stderr)

    def test_readings_before_the_load(self):
        """Their mean is the zero; without them, and zeroed after the load, the elastic part is lost."""
        curve = self.curve(730, noise=0.01)
        rows = [(float(row["time_day"]), float(row["displacement_mm"])) for row in table(curve)]
        def written(rows):
            path = self.chain.new_folder() / "curve.csv"
            path.write_text("".join(["time_day,displacement_mm\n", *(f"{day},{value:+.4f}\n" for day, value in rows)]))
            return path
        def found(rows, *options):
            path = written(rows)
            done = self.chain.answer("creepfit", path, "-o", path.with_name("out.csv"), *options)
            self.assertEqual(done.returncode, 0, done.stderr)
            return {row["quantity"]: float(row["value"]) for row in table(path.with_name("out.csv"))}, done.stdout + done.stderr
        plain, _ = found(rows)
        moved = [(-3, 99.9), (-2, 100.1), *((day, value + 100) for day, value in rows)]
        with_zero, text = found(moved, "--load-day", "0")
        for quantity, value in plain.items():
            self.assertAlmostEqual(with_zero[quantity] / value, 1, delta=1e-3)
        self.assertIn("2, mean 100 mm: subtracted from the others", text)
        self.assertNotIn("first reading late", text)
        _, text = found(rows[2:], "--load-day", "0")  # day 14 of 120
        self.assertIn("warning: first reading late", text)
        for seed in range(1, 9):
            noise = random.Random(seed)
            zeroed = [(day, value - 4 + noise.gauss(0, 0.2)) for day, value in rows]
            path = written(zeroed)
            done = self.chain.answer("creepfit", path, "-o", path.with_name("out.csv"))
            self.assertIn(done.returncode, (0, 2))
            said = done.stderr
            self.assertIn("count displacements from before the load", " ".join(said.split()))

    def refused(self, arguments, *wanted, code=2):
        out = self.chain.new_folder() / "out.csv"
        done = self.chain.answer("creepfit", *arguments, "-o", out)
        self.assertEqual(done.returncode, code, done.stderr)
        for text in wanted:
            self.assertIn(text, done.stderr)
        self.assertEqual(list(out.parent.iterdir()), [])

    def test_refusals_of_readings(self):
        head = "time_day,point,component,displacement_mm,sigma_mm"
        good = [f"{day},C,y,{day},0.1" for day in range(1, 9)]
        for line, *wanted in [
            ("1,Z,y,1,0.1", "line 2", 'point is "Z"'), ("1,C,z,1,0.1", "line 2", 'component is "z"'),
            ("41,C,y,1,0.1", "line 2", 'time_day is "41"', "40"), ("1,C,y,one,0.1", "line 2", 'displacement_mm is "one"'),
            ("1,C,y,1,0", "line 2", 'sigma_mm is "0"'), ("1,C,y,nan,0.1", "line 2", 'displacement_mm is "nan"'),
            ("1,C,y,1", "line 2", "4 fields"), ("15,A,y,1,0.1", "line 2", "has been removed"), ("1,C,y,+-1,0.1", "line 2", "+-1"),
            ("3.0,C,y,+1.5,0.1", "line 5", '"C" has a reading of y on day 3 in line 2 already'),
        ]:
            path = self.chain.new_folder() / "readings.csv"
            path.write_text("\n".join([head, line, *good, ""]))
            with self.subTest(line):
                self.refused([self.joints, "--measurements", path, "--fit", "joint-stiffness"], str(path), *wanted)
        for text, wanted in [("time_day,C_z_mm\n1,2\n", '"C_z_mm"'), ("time_day,event\n1,\n", "no column of a monitoring"),
                             ("", "expected a line of column names"), (f"{head}\n{good[0]}\n", "expected more readings"),
                             ("time_day,C_x_mm,C_y_mm,C_y_sigma_mm\n1,2,3,4\n", "sigma of some")]:
            path = self.chain.new_folder() / "readings.csv"
            path.write_text(text)
            with self.subTest(text):
                self.refused([self.joints, "--measurements", path, "--fit", "joint-stiffness"], str(path), wanted)

    def test_too_few_readings_for_errors_of_instruments(self):
        """Refused before the search: three factors, and of each of three points an offset, a drift and a step."""
        path = self.chain.new_folder() / "readings.csv"
        rows = [f"{day},{point},y,{day},0.1" for point in "ABC" for day in (2, 4, 6, 8)]
        path.write_text("\n".join(["time_day,point,component,displacement_mm,sigma_mm", *rows, ""]))
        fit = ["--fit", ",".join(TRUTH), "--offset", "--drift", "--steps", "6"]
        self.refused([self.joints, "--measurements", path, *fit],
                     "12 readings for 3 factors and 9 unknown errors of instruments; expected more readings")
        curve = self.chain.new_folder() / "curve.csv"
        curve.write_text("time_day,displacement_mm\n" + "".join(f"{day},{1 + day / 10}\n" for day in range(5)))
        self.refused([curve, "--drift", "--steps", "3"], f"{curve}: 5 readings for 5 unknowns, 2 of them errors of instruments")

    def test_refusals_of_options(self):
        readings, curve = self.readings(), self.curve(100)
        for options, wanted in [
            ([], "--fit is not given"), (["--fit", "stiffness"], '"stiffness" is none of'), (["--fit", ""], "--fit is empty"),
            (["--fit", "joint-stiffness,joint-stiffness"], "twice"), (["--fit", "joint-stiffness=2:1"], "LOW:HIGH"),
            (["--fit", "joint-stiffness=1"], "LOW:HIGH"), (["--fit", "joint-stiffness=1:2:"], "LOW:START:HIGH"),
            (["--fit", "joint-stiffness=1:2:3:4"], "LOW:START:HIGH"), (["--fit", "joint-stiffness=1:4:3"], "outside its bounds"),
            (["--fit", "joint-stiffness,"], "before or after a comma"), (["--fit", ",joint-stiffness"], "a comma"), (["--fit", "joint-stiffness=0:2"], "LOW:HIGH"),
            (["--fit", "joint-stiffness", "--stiffness", "3"], "--stiffness goes with"),
            (["--fit", "joint-stiffness@none"], 'no joint material "none"'), (["--fit", "joint-stiffness@"], "no joint material behind @"),
            (["--fit", "normal-horizontal-stress"], "is none of"), (["--fit", "joint-stiffness", "--steps", "1,,2"], '--steps is "1,,2"'),
            (["--fit", "joint-stiffness", "--steps", ""], '--steps is ""'), (["--fit", "joint-stiffness", "--steps", "3,x"], "--steps is"),
            (["--fit", "joint-stiffness", "--steps", "3,3"], "twice"),
            (["--fit", "joint-stiffness", "--steps", "39.5"], "no point has readings before and after the step on day 39.5"),
            (["--fit", "joint-stiffness", "--robust", "--correlated-noise"], "do not go together"),
            (["--fit", "joint-stiffness", "--since-first-reading", "--robust"], "expected --offset"),
            (["--fit", "joint-stiffness", "--readings", readings], f"--readings {readings} is the same file as --measurements"),
        ]:
            with self.subTest(options):
                self.refused([self.joints, "--measurements", readings, *options], wanted)
        for options, wanted in [(["--fit", "joint-stiffness"], "--fit goes with"), (["--stiffness", "-1"], "--stiffness is -1"),
                                (["--load-day", "200"], "no reading from then on"), (["--elastic-mm", "0"], "must not be 0"),
                                (["--converged-day", "500"], "taken to be over"), (["--offset"], "expected --elastic-mm"),
                                (["--steps", "500"], "no readings before and after the step on day 500")]:
            with self.subTest(options):
                self.refused([curve, *options], wanted)
        self.refused([curve.with_name("none.csv")], "none.csv", code=4)
        self.refused([self.joints, "--measurements", curve.with_name("none.csv"), "--fit", "joint-stiffness"],
                     "none.csv", code=4)
        self.refused([self.joints], "--measurements is not given", "is no curve")

    def test_refusals_of_an_ensemble(self):
        readings = self.readings("--sigma-mm", "0.1")
        bare = self.chain.new_folder() / "bare.csv"
        with open(readings) as file, open(bare, "w") as other:
            other.writelines(",".join(line.rstrip("\n").split(",")[:4]) + "\n" for line in file)
        for path, options, wanted in ((readings, ["--ensemble", "5"], "--ensemble is 5; expected at least 6"),
                                      (readings, ["--ensemble", "8", "--robust"], "does not go with --robust"),
                                      (readings, ["--ensemble", "8", "--fit", "joint-stiffness=0.5:0.9:2"], "joint-stiffness has a start"),
                                      (bare, ["--ensemble", "8"], "bare.csv: no sigma_mm")):
            fit = [] if "--fit" in options else ["--fit", "kelvin-stiffness,joint-stiffness"]
            done = self.chain.answer("creepfit", self.joints, "--measurements", path, *fit, *options, "-o", bare.with_name("f.csv"))
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(wanted, done.stderr)
            self.assertFalse(bare.with_name("f.csv").exists())

    def test_nothing_to_fit(self):
        """Before the first removal, on day 1, nothing moves. Spaces after commas and plus signs are read."""
        path = self.chain.new_folder() / "readings.csv"
        path.write_text("time_day,point,component,displacement_mm\n" + "".join(f"0.{n},C,y,+0.0{n}\n" for n in range(1, 9)))
        self.refused([self.joints, "--measurements", path, "--fit", "joint-stiffness, kelvin-stiffness"],
                     "no factor changes any of the readings")

    def test_dynamic_relaxation_has_no_sensitivities(self):
        text = changed(self.chain.text("data/column/scene.toml"), r"^\[equilibrium\]", '[equilibrium]\nengine = "relaxation"')
        self.refused([self.chain.joints(text), "--measurements", self.readings(), "--fit", "joint-stiffness"],
                     "sensitivities are found by the implicit engine")

    def test_picture(self):
        """Of both tables of readings."""
        _, _, _ = self.found(self.readings())
        folder = self.chain.new_folder()
        for command in ([self.curve(365)], [self.joints, "--measurements", self.readings(), "--fit", "joint-stiffness"]):
            done = self.chain.answer("creepfit", *command, "-q", "-o", folder / "o.csv", "--readings", folder / "r.csv")
            self.assertEqual(done.returncode, 0, done.stderr)
            subprocess.run([sys.executable, self.chain.source / "pipelines/plots/plot_fit.py", folder / "r.csv", "-o",
                            folder / "fit.png"], check=True)
            self.assertEqual((folder / "fit.png").read_bytes()[:4], b"\x89PNG")
        done = subprocess.run([sys.executable, self.chain.source / "pipelines/plots/plot_fit.py", folder / "o.csv", "-o",
                               folder / "none.png"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertFalse((folder / "none.png").exists())


if __name__ == "__main__":
    main()
