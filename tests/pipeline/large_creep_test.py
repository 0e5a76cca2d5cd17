"""Creep of joints at large displacements: beside closed forms and the implicit engine where displacements are small, and a
block that slides when creep has tilted it far enough, beside the differential equation of rigid blocks."""

import math
import os
import re
import unittest.mock

import numpy as np

from chain import ChainTest, changed, datasets, main
from large_displacements_test import incline
from small_scene import GRAVITY, held, joint, material, scene

LARGE = '[large_displacements]\nnew_contacts = "joint"\nrelease_s = 0.2\n'
RIGID = 'rigid_rocks = ["rock"]\n'


def kelvin(normal, normal_days, shear=None, shear_days=None):
    """Keys of a Kelvin unit: stiffnesses in MPa/m, retardation times in days."""
    shear, shear_days = normal if shear is None else shear, normal_days if shear_days is None else shear_days
    return {"normal_kelvin_stiffness_MPa_per_m": normal, "normal_kelvin_viscosity_MPa_day_per_m": normal * normal_days,
            "shear_kelvin_stiffness_MPa_per_m": shear, "shear_kelvin_viscosity_MPa_day_per_m": shear * shear_days}


class SmallDisplacements(ChainTest):
    def test_the_column_goes_on_rising(self):
        """The paper's column, by its closed form: what is left rises with each block that goes, and creeps on."""
        text = self.chain.text("data/column/scene.toml")
        text = changed(text, r"^\[equilibrium\](.|\n)*", "[equilibrium]\ntolerance = 1e-8\n"
                       + LARGE + "mass_damping_per_s = 20\n")
        data = datasets(self.chain.result(text))
        load, days = 2750 * GRAVITY * 10, data["/history/time"]
        worst = 0
        for row, day in enumerate(days):
            done = list(data["/history/event"][:row + 1])
            for point, (joints, height) in enumerate(((3, 25), (2, 15), (1, 5))):
                rise = 0
                for n, date in enumerate((1, 10, 20)):
                    if n <= point and f"block {n + 1} removed" in done:
                        rise += load * (height * (1 - 0.22**2) / 40e9
                                        + joints / 690e6 * (2 - math.exp(-(day - date) / 10)))
                if data["/history/present"][row, point]:
                    worst = max(worst, abs(data["/history/displacement"][row, point, 1] - rise))
        print(f"column: largest error {worst * 1e3:.2e} mm of {rise * 1e3:.3f} mm")
        self.assertGreater(len(days), 20)
        self.assertLess(worst / rise, 2e-4)


def slope(more, steps="step_days = 2"):
    """Three blocks on a joint that dips out of the slope, held by a fourth that goes on day 1. The joints creep; some slip."""
    creeping = material("joint", 200, 80, friction=24, **kelvin(200, 10, 60, 20))
    return scene([[0, 0], [14, 0], [14, 4], [10, 4], [10, 9], [0, 9]],
                 [joint("dips", [-1, 6.5], [12, 2.0]), joint("back", [3, 4], [3.5, 10]), joint("middle", [6.5, 3], [6.8, 10])],
                 [held([0, 0], [14, 0]), held([0, 0], [0, 9], "x"), held([14, 0], [14, 4], "x")], [creeping],
                 stages=[[[[10, 2.6], [14, 2.6], [14, 4], [10, 4]]]], points=[[2, 8.5], [5, 8.5], [9, 8.5], [9, 5]],
                 zone=0.5, modulus=300, poisson=0.2, end=60, more=f"[creep]\n{steps}\n{more}")


class BesideTheImplicitEngine(ChainTest):
    def test_blocks_of_a_slope(self):
        """Contacts are between faces here, and between gridpoints there: histories agree to 2 percent of the largest
        displacement, and creep to 3 percent of the largest creep."""
        exact = "[equilibrium]\ntolerance = 1e-6\n"
        small = datasets(self.chain.result(slope(exact)))
        large = datasets(self.chain.result(slope(exact + LARGE + RIGID)))
        np.testing.assert_array_equal(small["/history/time"], large["/history/time"])
        after = np.flatnonzero(small["/history/event"] != "")[0]
        of_small, of_large = (data["/history/displacement"][after:] for data in (small, large))
        largest = np.abs(of_small).max()
        off = np.abs(of_large - of_small).max() / largest
        creep_small, creep_large = of_small - of_small[0], of_large - of_large[0]
        creep = np.abs(creep_small).max()
        off_in_creep = np.abs(creep_large - creep_small).max() / creep
        print(f"slope: {largest * 1e3:.3f} mm, creep {creep * 1e3:.3f} mm; apart by {100 * off:.2f} and {100 * off_in_creep:.2f} percent")
        self.assertGreater(creep / largest, 0.3)
        self.assertLess(off, 0.02)
        self.assertLess(off_in_creep, 0.03)


def stack(more="", friction=1.1, floor=-6.0, end=50, steps="tolerance_m = 2e-5\nlongest_step_days = 3"):
    """A block A on a wide block B, on a soft joint that creeps. With its counterweight C gone, B tilts to the left until A slides.

              ___            ___
             | A |          | C |   1 m x 1 m
         ____|___|__________|___|____
        |             B              |  4 m x 2 m
    ____|____________________________|___     and a wall, 4 m to the left
    """
    base = material("joint", 2.0, 10, friction=40, **kelvin(0.092, 100, 500, 100))
    seat = material("seat", 10, 5, friction=friction, **kelvin(10, 50),
                    residual_cohesion_MPa=0, residual_friction_angle_deg=0.5)
    outline = [[floor, -1], [5, -1], [5, 0], [4, 0], [4, 2], [3.7, 2], [3.7, 3], [2.7, 3], [2.7, 2], [1.3, 2], [1.3, 3], [0.3, 3],
               [0.3, 2], [0, 2], [0, 0], [floor + 2, 0], [floor + 2, 1.5], [floor, 1.5]]
    return scene(outline, [joint("base", [0, 0], [4, 0]), joint("seat of A", [0.3, 2], [1.3, 2], "seat"),
                           joint("seat of C", [2.7, 2], [3.7, 2], "seat")],
                 [held([floor, -1], [5, -1])], [base, seat], stages=[[[[2.7, 2], [3.7, 2], [3.7, 3], [2.7, 3]]]],
                 points=[[0.8, 2.9], [0.1, 1.9], [3.9, 1.9]], zone=2.0, end=end,
                 more=f'[creep]\n{steps}\n{LARGE.replace("0.2", "1").replace("joint", "seat")}{RIGID}stiffness_damping_s = 5e-4\nmass_damping_per_s = 1\n{more}'
                      "[equilibrium]\ntolerance = 1e-6\n")


def days_until_it_tilts(angle):
    """Days from the removal of C until B has turned by so much: rigid blocks, with the moment of their weights in the place where
    they are, on a joint with the pressure K (closure - creep), eta creep' = change of pressure - E creep."""
    K, E, tau = 2e6, 0.092e6, 100.0
    weight = 2500 * GRAVITY

    def moment(turned):  # about the middle of the base, to the left
        return weight * (8 * math.sin(turned) * 1 + 1 * (1.2 * math.cos(turned) + 2.5 * math.sin(turned)))

    def resists(turned):
        return (4 * math.cos(turned))**3 / 12

    def turned_at(crept):  # creep is `crept` times the way from the middle
        turned = crept
        for _ in range(100):
            turned = math.atan(crept + moment(turned) / (K * resists(turned)))
        return turned

    def rate(crept):
        turned = turned_at(crept)
        return (moment(turned) / resists(turned) - E * crept) / (E * tau)

    day, crept, step = 0.0, 0.0, 0.05
    while turned_at(crept) < angle:
        last = day, turned_at(crept)
        k1 = rate(crept)
        k2 = rate(crept + step / 2 * k1)
        k3 = rate(crept + step / 2 * k2)
        k4 = rate(crept + step * k3)
        crept += step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        day += step
    return last[0] + step * (angle - last[1]) / (turned_at(crept) - last[1])


class UntilItSlides(ChainTest):
    def answer(self, text):
        joints = self.chain.joints(text)
        output = joints.with_name("result.h5")
        return self.chain.answer("demsolve", joints, "-o", output), output

    def test_a_block_slides_when_creep_has_tilted_it(self):
        """Its friction angle is 1 or 1.1 degrees, and it slides on the day that the differential equation gives, within 1 percent. Then
        it lies on the floor, and what is left creeps on, to less tilt."""
        for friction in (1.0, 1.1):
            expected = 1 + days_until_it_tilts(math.radians(friction))
            done, output = self.answer(stack(friction=friction))
            self.assertEqual(done.returncode, 0, done.stderr)
            slid = re.search(r"warning: rock slid in creep, day ([0-9.]+): block \d+ at \[0\.8", done.stderr)
            self.assertIsNotNone(slid, done.stderr)
            print(f"slides on day {float(slid[1]):.2f}, by the differential equation {expected:.2f}")
            self.assertLess(abs(float(slid[1]) / expected - 1), 0.01)
            data = datasets(output)
            self.assertLess(data["/history/displacement"][-1, 0, 1], -1.5)  # off B
            self.assertGreater(data["/history/time"][-1], 49)
            tilt = (data["/history/displacement"][:, 2, 1] - data["/history/displacement"][:, 1, 1]) / 3.8
            self.assertLess(tilt[-1], tilt.max())
            verified = self.chain.answer("jointverify", output)
            self.assertEqual(verified.returncode, 0, verified.stdout + verified.stderr)

    def test_what_finds_no_rest_is_told_with_its_day(self):
        done, output = self.answer(stack("longest_s = 4\n"))
        expected = 1 + days_until_it_tilts(math.radians(1.1))
        self.assertEqual(done.returncode, 3)
        told = re.search(r"no rest within 4 s\n?.*on day ([0-9.]+); moving blocks: block \d+ at \[0\.8", done.stderr, re.DOTALL)
        self.assertIsNotNone(told, done.stderr)
        self.assertLess(abs(float(told[1]) / expected - 1), 0.01)
        failed = datasets(output.with_name("result.failed.h5"))
        self.assertAlmostEqual(failed["/failure/time"][()].item(), float(told[1]), delta=0.01)

    def test_without_creep_it_stays(self):
        done, output = self.answer(stack().replace(f"[creep]\ntolerance_m = 2e-5\nlongest_step_days = 3\n", ""))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("slid", done.stderr)
        self.assertLess(np.abs(datasets(output)["/history/displacement"]).max(), 0.05)


class SameBytes(ChainTest):
    def test_threads_do_not_change_a_byte(self):
        text = slope(LARGE + RIGID, "step_days = 2")
        text = changed(changed(text, "^size_m = 0.5$", "size_m = 0.25"), "^end = 60$", "end = 5")
        joints = self.chain.joints(text)
        with unittest.mock.patch.dict(os.environ, OMP_WAIT_POLICY="passive"):
            one, two = (datasets(self.chain.run("demsolve", joints, self.chain.new_folder() / "result.h5", "--threads", n)) for n in (1, 2))
        self.assertGreater(len(one["/mesh/zone_block"]), 4000)  # of fewer than 2000 one thread takes all
        self.assertTrue(np.any(one["/states/crept"]))
        for name, values in one.items():
            self.assertTrue(np.array_equal(values, two[name]), name)


class Refused(ChainTest):
    def test_what_does_not_creep(self):
        text = incline(30, 35, more="release_s = 0.2\n") + "[creep]\nstep_days = 1\n"
        unit = "".join(f"{key} = {of}\n" for key, of in kelvin(100, 1).items())
        for scene_text, message in (
                (text.replace("release_s = 0.2", ""), r"release_s.*expected more than 0 with \[creep\]"),
                (text.replace("release_s = 0.2", "release_s = 0.2\nstop_s = 5"), r"stop_s = 5: expected no such key with \[creep\]"),
                (text.replace('poissons_ratio = 0.25', "poissons_ratio = 0.25\nkelvin_shear_modulus_GPa = 5\n"
                              "kelvin_shear_viscosity_GPa_day = 50"), r"joints creep, and rock does not"),
                (text.replace("tensile_strength_MPa = 0\n", "tensile_strength_MPa = 0\ninitial_friction_angle_deg = 40\n"
                              "roughness_length_mm = 10\n" + unit, 1), "a joint that yields continuously does not creep")):
            path = self.chain.new_folder() / "scene.toml"
            path.write_text(scene_text)
            done = self.chain.answer("jointgen", path, "-o", path.with_suffix(".h5"))
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertRegex(done.stderr, message)


if __name__ == "__main__":
    main()
