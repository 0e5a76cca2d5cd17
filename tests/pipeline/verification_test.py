"""The scenes of data/verification against their exact answers, with the defaults, by every engine, in every scheme.

Answers and errors are those of pipelines/accuracy (closed_forms.py, errors.py): relative to the scale of the case,
displacements at the end, tractions over the whole run.
"""

import csv
import math
import re
import sys

import numpy as np
from chain import ChainTest, changed, datasets, main

sys.path.append(sys.argv[2] + "/pipelines/accuracy")
import cases  # noqa: E402
import closed_forms  # noqa: E402
import errors  # noqa: E402

# What equilibria within the default tolerance, 1e-6, leave: a few times that, as in the column.
BALANCE = 2e-5
LAST_STATE = -1


def of_step(scheme, rate, step):
    """The largest error on exp(-rate T), in steps, of the textbook's method of the scheme's order.

    On a joint between fixed walls, where rate = lam (1 + K/E), every scheme does at least as well.
    """
    x = rate * step
    factor = {"published": 1 - x, "backward": 1 / (1 + x)}.get(scheme, (1 - x / 2) / (1 + x / 2))
    return max(abs(factor**n - math.exp(-n * x)) for n in range(1, 2 + math.ceil(5 / x)))


class Verification(ChainTest):
    def setUp(self):
        self.offer = cases.offer_of(self.chain.programs / "demsolve")

    def scene(self, name):
        return self.chain.text(f"data/verification/{name}/scene.toml")

    def ways(self):
        """(scheme that is used, options): the defaults, every engine, every scheme by the fastest engine."""
        default = "fitted"
        yield default, []
        for engine in self.offer.engines if self.offer.names_engines else []:
            yield default, ["--engine", engine]
        for scheme in self.offer.schemes if self.offer.names_schemes else []:
            if scheme != default:
                yield scheme, ["--creep-scheme", scheme]

    def in_every_way(self, text, check):
        """Calls check(scheme, result) for every way to compute the scene."""
        joints = self.chain.joints(text)
        for scheme, options in self.ways():
            with self.subTest(options=options):
                path = joints.with_name("-".join(["result", *options]) + ".h5")
                check(scheme, errors.result_of(self.chain.run("demsolve", joints, path, "--states", 1, *options)))

    def assert_within(self, error, displacement, traction):
        self.assertLess(error.displacement, displacement, "displacement at the end")
        self.assertLess(error.traction, traction, "largest traction error over the run")

    def test_platens(self):
        for ratio in cases.RATIOS:
            # Published steps longer than this, with the joint between rigid walls, would be refused.
            step = min(0.25, 0.5 / cases.RATE / (1 + ratio))
            text = cases.edited(cases.platens_scene(self.scene("platens"), ratio), {("", "step_days"): step})

            def check(scheme, result, ratio=ratio, step=step):
                bound = of_step(scheme, cases.RATE * (1 + ratio), step) * ratio / (1 + ratio) + BALANCE
                if scheme == "fitted":
                    bound = 0.05 * bound + BALANCE  # exact between fixed walls, and the rock gives but 1/20
                error = errors.against_closed_form(result, closed_forms.platens(result.scene))
                # Of the closure held, the rock takes less than 1/20, and that as exactly as the tractions are.
                self.assert_within(error, 0.05 * bound + BALANCE, bound)
                self.assertLess(result.traction[1:, :, 0].max(), 0, "the joint stays closed")

            with self.subTest(ratio=ratio):
                self.in_every_way(text, check)

    def test_two_pillars(self):
        for ratio in 1, 20:
            step = min(0.25, 0.5 / cases.RATE / (1 + ratio))
            text = cases.edited(cases.pillars_scene(self.scene("two-pillars"), ratio), {("", "step_days"): step})

            def check(scheme, result, ratio=ratio, step=step):
                error = errors.against_closed_form(result, closed_forms.two_pillars(result.scene))
                # Between fixed walls the stiff pillar would relax by ratio / (1 + ratio), faster than it does.
                # The cap is 1e5 times stiffer than the joints.
                bound = of_step(scheme, cases.RATE * (1 + ratio), step) * ratio / (1 + ratio) + 1e-5 + BALANCE
                self.assert_within(error, bound, bound)
                stiff = [name == "stiff" for name in result.contacts.material]
                first, last = (-result.traction[i][stiff, 0].mean() for i in (1, LAST_STATE))
                self.assertTrue(first > 1e5 > last, "its share of the load crosses the other's")

            with self.subTest(ratio=ratio):
                self.in_every_way(text, check)

    def test_layered_mass(self):
        # Loads fix the tractions, which no scheme may change; zones hold a uniform stress exactly.
        def check(_, result):
            error = errors.against_closed_form(result, closed_forms.layered_mass(result.scene))
            self.assert_within(error, BALANCE, BALANCE)

        self.in_every_way(self.scene("layered-mass"), check)

    def test_layered_mass_as_a_continuum(self):
        """The strain over whole spacings is the one in the books."""
        b, q, spacing = math.pi / 6, 2e6, 2
        height = 7 * spacing / math.cos(b)
        text = changed(self.scene("layered-mass"), r"^at_m = \[2, 18.5\]", f"at_m = [8, {1 + height}]")
        scene = errors.tomllib.loads(text)
        normal, shear = (closed_forms.joint_of(scene, "joint", direction).compliance(40) for direction in
                         ("normal", "shear"))
        wanted = q * closed_forms.rock_compliance(scene) + q / spacing * (
            math.cos(b) ** 4 * normal + math.sin(b) ** 2 * math.cos(b) ** 2 * shear)
        result = errors.result_of(self.chain.result(text))
        low, high = result.displacement[0], result.displacement[2]
        self.assertAlmostEqual((low - high)[1] / height, wanted, delta=BALANCE * wanted)

    def test_incline(self):
        text = cases.edited(self.scene("incline"), {("", "step_days"): 2.5})

        def check(_, result):
            error = errors.against_closed_form(result, closed_forms.incline(result.scene))
            # The block's bending shifts normal tractions by the order of  K_n L / E_r = 1e-4.
            self.assert_within(error, BALANCE, 1e-4 + BALANCE)

        self.in_every_way(text, check)

    def test_incline_slides_where_it_is_steeper_than_its_friction_angle(self):
        for above in 0.001, -0.001:
            text = cases.edited(self.scene("incline"), {("", "friction_angle_deg"): 25 + above})
            joints = self.chain.joints(text)
            for engine in self.offer.engines:
                options = ["--engine", engine] if self.offer.names_engines else []
                with self.subTest(above=above, engine=engine):
                    slid = joints.with_name("slid.h5")
                    done = self.chain.answer("demsolve", joints, "--no-creep", "-o", slid, *options)
                    self.assertEqual(done.returncode, 0 if above > 0 else 3, done.stderr)
                    if above < 0:
                        self.assertIn("no equilibrium", done.stderr)

    def test_wedge_in_a_groove(self):
        text = cases.edited(self.scene("v-groove"), {("", "step_days"): 0.5})

        def check(scheme, result):
            left = result.contacts.normal[:, 0] > 0
            status = result.status[:, left]
            self.assertEqual({int(s) for s in status.flat}, {1, 2, 3}, "it is stuck, slips and opens")
            opened = [bool(row.all()) for row in status == 3]
            self.assertEqual(sum(a and not b for a, b in zip(opened, opened[1:])), 2, "it closes twice")
            error = cases.groove_error(result)
            # K/E is 1. Errors of the three times in which the left contact bears add up at most. The schemes of first
            # order do not cut a step in which it closes: its shear is from there on as if at the step's end.
            bound = 3 * of_step(scheme, 2 * cases.RATE, 0.5) + BALANCE
            self.assert_within(error, bound, bound)

        self.in_every_way(text, check)

    def test_events_keep_the_second_order(self):
        """A wedge that slips, opens and closes: 4 halvings of the step, 100 times less error (256 without events).
        Dynamic relaxation, which takes long for each step, begins with the double step."""
        joints = self.chain.joints(self.scene("v-groove"))
        for engine in self.offer.engines:
            coarse = 2 if engine == "relaxation" else 1
            for scheme in "linear-force", "fitted":
                with self.subTest(engine=engine, scheme=scheme):
                    def error(step, engine=engine, scheme=scheme):
                        return cases.groove_error(errors.result_of(self.chain.run(
                            "demsolve", joints, joints.with_name("halved.h5"), "--states", 1, "--engine", engine,
                            "--tolerance", "1e-9", "--creep-scheme", scheme, "--creep-step", step))).traction

                    self.assertLess(100 * error(coarse / 16), error(coarse))

    def test_a_single_contact_slips_opens_and_closes(self):
        """Led by displacements, 3 halvings of the step: 29 times less error by the implicit engine (64 without events). The
        dynamic relaxation is of first order here: on its way to the new displacements the joint does not go straight."""
        joints = self.chain.joints(self.scene("single-contact"))
        days = np.arange(8 * 35 + 1) / 8  # those of all steps here
        begun, exact = None, None
        for engine, scheme, at_most, fine, less in (("implicit", "linear-force", 6e-4, 0.125, 25),
                                                    ("implicit", "fitted", 6e-4, 0.125, 25),
                                                    ("relaxation", "fitted", 3e-2, 0.25, 3.5)):
            with self.subTest(engine=engine, scheme=scheme):
                def error(step, engine=engine, scheme=scheme):
                    nonlocal begun, exact
                    result = errors.result_of(self.chain.run(
                        "demsolve", joints, joints.with_name("halved.h5"), "--states", 1, "--engine", engine,
                        "--tolerance", "1e-9", "--creep-scheme", scheme, "--creep-step", step))
                    self.assertLessEqual({1, 3} if engine == "relaxation" else {1, 2, 3}, set(result.status.flat),
                                         "it sticks, slips (during relaxation, and is stuck after it) and opens")
                    if exact is None:
                        begun = result
                        exact = closed_forms.single_contact(result.scene, result.contacts, result.traction[0], days)
                    # What they begin with is the same, so one answer is that of all.
                    np.testing.assert_array_equal(result.traction[0], begun.traction[0])
                    np.testing.assert_array_equal(result.contacts.normal, begun.contacts.normal)
                    self.assertEqual(result.time[LAST_STATE], days[-1])
                    rows = np.searchsorted(days, result.time)
                    np.testing.assert_array_equal(days[rows], result.time)
                    return errors.against_tractions(result, result.displacement[LAST_STATE:], exact[rows]).traction

                coarse = error(1)
                self.assertLess(coarse, at_most)
                self.assertLess(less * error(fine), coarse)

    def test_a_creep_tolerance_is_kept(self):
        """Errors in metres, of points and joints, are below the one allowed to a single step."""
        for name, form in (("platens", closed_forms.platens), ("two-pillars", closed_forms.two_pillars)):
            joints = self.chain.joints(self.scene(name))
            for tolerance in 1e-5, 1e-7:
                with self.subTest(name=name, tolerance=tolerance):
                    result = errors.result_of(self.chain.run(
                        "demsolve", joints, joints.with_name("chosen.h5"), "--states", 1, "--tolerance", "1e-9",
                        "--creep-tolerance", tolerance))
                    self.assertLess(errors.against_closed_form(result, form(result.scene)).metres, tolerance)

    def test_long_steps(self):
        """K/E = 100, a step of lam dT = 10: the default scheme is refused by name, or keeps the joint closed."""
        joints = self.chain.joints(cases.platens_scene(self.scene("platens"), 100, end=200))
        result = joints.with_name("result.h5")
        done = self.chain.answer("demsolve", joints, "--states", 1, "--creep-step", 100, "-o", result)
        if done.returncode != 0:
            self.assertEqual(done.returncode, 2)
            self.assertIn('"joint"', done.stderr)
            return
        found = errors.result_of(result)
        self.assertLess(found.traction[1:, :, 0].max(), 0)
        self.assertAlmostEqual(found.traction[LAST_STATE, 0, 0],
                               closed_forms.platens(found.scene).traction(found.contacts, 200, 0)[0, 0],
                               delta=1e-3 * 1e6)

    def plate_test(self, normal, shear):
        """Displacement of the plate under its load, down, and by the jack, sideways [m], with these stiffnesses of the seam [MPa/m]."""
        text = self.scene("plate-test").replace("normal_stiffness_MPa_per_m = 690 ", f"normal_stiffness_MPa_per_m = {normal} ")
        text = text.replace("shear_stiffness_MPa_per_m = 280 ", f"shear_stiffness_MPa_per_m = {shear} ")
        moved = datasets(self.chain.result(text))["/history/displacement"][:, 0]
        return -moved[1, 1], moved[2, 0] - moved[1, 0]

    def test_stiffness_from_a_plate_test(self):
        """The load over the displacement is too small a stiffness: rock gives way, and the column rocks. Two computations with other
        stiffnesses find the seam's, as displacements are straight over 1 / K."""
        rigid, height, width, pressure, shear = 1e5, 0.2, 0.5, 1.0, 0.3
        down, aside = self.plate_test(690, 280)
        self.assertAlmostEqual(1e3 * down, 1e3 * pressure / 690 + 0.035, delta=0.003)  # the rock's part [mm]
        rocking = 6 * shear * height**2 / (690 * width**2)
        self.assertAlmostEqual(aside, shear / 280 + rocking, delta=0.015 * aside)
        self.assertAlmostEqual(pressure / down, 674, delta=1)
        self.assertAlmostEqual(shear / aside, 199, delta=1)
        (softer, _), (none, _) = self.plate_test(400, 200), self.plate_test(rigid, 200)
        normal = 1 / ((down - none) / (softer - none) * (1 / 400 - 1 / rigid) + 1 / rigid)
        self.assertAlmostEqual(normal, 690, delta=0.005 * 690)
        (_, softer), (_, none) = self.plate_test(normal, 200), self.plate_test(normal, rigid)
        found = 1 / ((aside - none) / (softer - none) * (1 / 200 - 1 / rigid) + 1 / rigid)
        self.assertAlmostEqual(found, 280, delta=0.005 * 280)

    def test_friction_stack_beside_calculix(self):
        """Partial slip, pushed and let go: another code's figures, which change by 1 percent with its own increments and
        bricks (pipelines/accuracy/calculix_stack.py, and the page accuracy)."""
        with open(self.chain.source / "data/verification/friction-stack/calculix.csv") as file:
            rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
        # Places on the outline a little inside it.
        points = "".join(f'[[point]]\nname = "{row["point"]}"\nat_m = [{min(float(row["x_m"]), 4 - 1e-6)}, '
                         f'{min(float(row["y_m"]), 3 - 1e-6)}]\n\n' for row in rows if row["step"] == "pushed")
        text = re.sub(r"(?s)^\[\[point\]\].*?\n\n", points, self.scene("friction-stack"), flags=re.MULTILINE)
        text = changed(text, "^size_m = 0.25", "size_m = 0.125")
        result = datasets(self.chain.result(text))
        names, time = list(result["/history/point"]), result["/history/time"]
        found = np.array([result["/history/displacement"][time == {"pushed": 1, "let go": 2}[row["step"]]][-1][
            names.index(row["point"])] for row in rows])
        wanted = np.array([[float(row["moved_x_m"]), float(row["moved_y_m"])] for row in rows])
        self.assertLess(np.abs(found - wanted).max(), 0.015 * np.abs(wanted).max())

    def test_friction_stack_slips_no_more_when_pushed_at_once(self):
        """Within 3e-4 of its displacements, and 3e-3 of what stays of them; badly damped, it slips twice as far."""
        slow = errors.result_of(self.chain.result(self.scene("friction-stack"), "--tolerance", "1e-8"))
        fast = changed(self.scene("friction-stack"), "^unloading_increments = 16", "unloading_increments = 1")
        joints = self.chain.joints(fast)
        for engine in self.offer.engines:
            options = ["--engine", engine] if self.offer.names_engines else []
            with self.subTest(engine=engine):
                at_once = errors.result_of(self.chain.run("demsolve", joints, joints.with_name(f"{engine}.h5"),
                                                          "--tolerance", "1e-8", *options))
                self.assertLess(abs(at_once.peak - slow.peak).max(), 1e-3 * abs(slow.peak).max(), "pushed")
                self.assertLess(abs(at_once.displacement - slow.displacement).max(),
                                5e-3 * abs(slow.displacement).max(), "let go")
                self.assertGreater((at_once.status[1] == 2).sum(), 40, "most contacts slip")
                slip, slow_slip = errors.slip_of(at_once), errors.slip_of(slow)
                spurious = np.nanmax(abs(slip - slow_slip)) / np.nanmax(abs(slow_slip))
                self.assertLess(spurious, 1e-4 if engine == "implicit" else 2e-2, "slip")


if __name__ == "__main__":
    main()
