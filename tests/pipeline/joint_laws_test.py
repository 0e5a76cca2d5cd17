"""A joint whose dilation wears off with work, through the whole chain: a rigid block is sheared on it by both engines, and
slides down an incline; against closed forms and against the law's equations in small steps."""

import csv
import math

import numpy as np

from chain import ChainTest, changed, datasets, main
from dilation_test import HELD, K_N, K_S, SCENE, STEEL, TAN_PHI, TAN_PSI
from large_displacements_test import ACCOUNT, GRAVITY, RIGID, error_of_energy, incline

WEAR = 4e-4  # m2/J
WEARS = ("^dilation_angle_deg = 10", f"dilation_angle_deg = 10\ndilation_wear_m2_per_MJ = {WEAR * 1e6}")


def to_engine(text, engine, increments=1):
    return changed(text, "^tolerance = 1e-9",
                   f'tolerance = 1e-9\nengine = "{engine}"\nunloading_increments = {increments}')


def mean_traction(data):
    length = data["/mesh/contact_length"]
    return length @ data["/states/traction"][-1] / length.sum()


def down_the_plane(data, dip):
    """Displacement of the block at the end, down the plane and off it [m]."""
    x, y = data["/history/displacement"][-1, 0]
    sin, cos = math.sin(math.radians(dip)), math.cos(math.radians(dip))
    return x * cos - y * sin, x * sin + y * cos


class WearingDilation(ChainTest):
    def test_under_a_constant_load_it_opens_less_and_less(self):
        """In dynamic relaxation slip overshoots and comes back in each increment, and that works too."""
        tau = 0.2e6 + 1e6 * TAN_PHI
        slip = 4e-3 - tau / K_S
        wanted = TAN_PSI / (WEAR * tau) * (1 - math.exp(-WEAR * tau * slip))
        self.assertLess(wanted, 0.7 * TAN_PSI * slip)
        for engine, increments, delta in ("relaxation", 40, 1e-2), ("implicit", 1, 1e-4), ("auto", 20, 1e-4):
            with self.subTest(engine=engine):
                data = datasets(self.chain.result(to_engine(changed(SCENE, *WEARS), engine, increments)))
                self.assertAlmostEqual(data["/history/displacement"][-1, 0, 1] / wanted, 1, delta=delta)
                self.assertAlmostEqual(mean_traction(data)[1] / tau, 1, delta=1e-3)

    def test_fixed_in_normal_direction_it_follows_its_equations(self):
        stiffness, steps = 1 / (1 / K_N + 1 / STEEL), 100000
        slip = dilation = work = 0.0
        for i in range(1, steps + 1):
            trial, pressed = K_S * (4e-3 * i / steps - slip), 1e6 + stiffness * dilation
            tau = min(trial, 0.2e6 + pressed * TAN_PHI)
            by = (trial - tau) / K_S
            slip, work = slip + by, work + tau * by
            dilation += TAN_PSI * math.exp(-WEAR * work) * by
        for engine, increments, delta in ("relaxation", 400, 1e-2), ("implicit", 400, 2e-3):
            with self.subTest(engine=engine):
                text = changed(changed(SCENE, *HELD), *WEARS)
                data = datasets(self.chain.result(to_engine(text, engine, increments)))
                found = mean_traction(data)
                self.assertAlmostEqual(found[0] / -(1e6 + stiffness * dilation), 1, delta=delta)
                self.assertAlmostEqual(found[1] / tau, 1, delta=delta)

    def test_a_block_slides_and_rises_less_and_less(self):
        """y' = t s' with t = tan(psi) exp(-w W): s'' = g sin - tau / m, tau = tan(phi) m (g cos + y''), m per area. While it
        is all on its joint. The formula has one pressure: below the block it differs by a third, and so does the wear."""
        dip, friction, psi, wear, height = 30, 25, 8, 1e-4, 0.5
        mass = 2700 * height
        text = changed(incline(dip, friction, height=height, length=9, wall=4, more=RIGID, seam=1.5),
                       "^tensile_strength_MPa = 0$",
                       f"tensile_strength_MPa = 0\ndilation_angle_deg = {psi}\ndilation_wear_m2_per_MJ = {wear * 1e6}")
        data = datasets(self.chain.result(text))
        self.assertLess(error_of_energy(data), ACCOUNT)
        sin, cos, tan = math.sin(math.radians(dip)), math.cos(math.radians(dip)), math.tan(math.radians(friction))
        there = data["/states/displacement"][data["/dynamics/state"]]
        there = there[:, np.abs(there[-1]).sum(axis=1) > 1].mean(axis=1)  # of the block
        moved, off = there[:, 0] * cos - there[:, 1] * sin, there[:, 0] * sin + there[:, 1] * cos
        compared = 0
        s = v = y = work = 0.0
        dt = 1e-5
        for at, found in zip(moved, off):
            if at > 1.3:
                break
            while s < at:
                t = math.tan(math.radians(psi)) * math.exp(-wear * work)
                tau = tan * mass * (GRAVITY * cos + t * GRAVITY * sin) / (
                    1 + tan * t + tan * mass * wear * t * v * v)
                v += (GRAVITY * sin - tau / mass) * dt
                s, y, work = s + v * dt, y + t * v * dt, work + tau * v * dt
            if at > 0.2:
                self.assertAlmostEqual(found / y, 1, delta=0.02, msg=at)
                compared += 1
        self.assertGreater(compared, 5)
        self.assertLess(y, 0.85 * math.tan(math.radians(psi)) * s)

    def test_its_wear_goes_with_the_joint(self):
        """Also where rock bridges halve the tangent of the dilation angle; in exports it has a column."""
        scene = changed(self.chain.text("tests/pipeline/every_key.toml"), "^tensile_strength_MPa = 0\n"
                        "(normal_kelvin_.*\nnormal_kelvin_.*\nshear_kelvin_.*\nshear_kelvin_.*\n)",
                        f"tensile_strength_MPa = 0\n\\1dilation_angle_deg = 10\ndilation_wear_m2_per_MJ = {WEAR * 1e6}\n")
        joints = self.chain.joints(scene)
        table = joints.with_name("edges.csv")
        self.assertEqual(self.chain.answer("jointexport", joints, "-o", table, "--what", "edges").returncode, 0)
        with open(table, encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        worn = [row for row in rows if float(row["dilation_wear_m2_per_J"] or 0) > 0]
        self.assertGreater(len(worn), 3)
        for row in worn:
            self.assertAlmostEqual(float(row["dilation_wear_m2_per_J"]), WEAR, delta=1e-12)

    def test_what_does_not_go_together_is_refused(self):
        for more, message in (("dilation_until_m = 1", "dilation_until_m"), ("residual_cohesion_MPa = 0", "residual_"),
                              ("joint_wall_strength_MPa = 10", "joint_")):
            scene = self.chain.new_folder() / "scene.toml"
            scene.write_text(changed(changed(SCENE, *WEARS), "^dilation_wear", more + "\ndilation_wear"))
            done = self.chain.answer("jointgen", scene, "-o", scene.with_suffix(".h5"))
            self.assertEqual(done.returncode, 2, more)
            self.assertIn(message, done.stderr)


if __name__ == "__main__":
    main()
