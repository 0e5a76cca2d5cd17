"""A joint that dilates, through the whole chain and by both engines: direct shear of a block on a joint, under a
constant load and between plates that hold it down, against closed forms and against tiny steps of its own."""

import math
import re

import numpy as np

from chain import ChainTest, changed, datasets, main

SCENE = """
[section]
outline_m = [[0, 0], [2, 0], [2, 1], [0, 1]]
rock = "steel"
gravity_m_per_s2 = 0

[[rock]]
name = "steel"
density_kg_per_m3 = 7800
youngs_modulus_GPa = 10000
poissons_ratio = 0

[[joint_material]]
name = "rough"
normal_stiffness_MPa_per_m = 4000
shear_stiffness_MPa_per_m = 1000
cohesion_MPa = 0.2
friction_angle_deg = 35
tensile_strength_MPa = 0
dilation_angle_deg = 10

[in_situ_stress]
elevation_m = 1
compression_xx_MPa = 0
compression_yy_MPa = 1
shear_xy_MPa = 0
compression_xx_gradient_MPa_per_m = 0
compression_yy_gradient_MPa_per_m = 0
shear_xy_gradient_MPa_per_m = 0

[[boundary]]
from_m = [0, 0]
to_m = [2, 0]
joint = "rough"

[[boundary]]
from_m = [0, 0]
to_m = [0, 1]
fix = "x"
displacement_mm = [4, 0]
load_history = [[0, 0], [10, 1]]

[[boundary]]
from_m = [2, 0]
to_m = [2, 1]
fix = "x"
displacement_mm = [4, 0]
load_history = [[0, 0], [10, 1]]

[[boundary]]
from_m = [0, 1]
to_m = [2, 1]
traction_MPa = [0, -1]

[schedule]
end = 10

[[point]]
name = "top"
at_m = [1, 1]

[zones]
size_m = 0.5

[equilibrium]
tolerance = 1e-9
"""

HELD = ("^traction_MPa = .*", 'fix = "y"')
KELVIN = """dilation_angle_deg = 10
normal_kelvin_stiffness_MPa_per_m = 3000
normal_kelvin_viscosity_MPa_day_per_m = 9000
shear_kelvin_stiffness_MPa_per_m = 800
shear_kelvin_viscosity_MPa_day_per_m = 4000"""

K_N, K_S, C = 4e9, 1e9, 0.2e6
TAN_PHI, TAN_PSI = math.tan(math.radians(35)), math.tan(math.radians(10))
STEEL = 1e13  # Pa over 1 m of height: beside the joint's normal spring


def sheared(displacement, stiffness):
    """Slip [m], normal and shear traction [Pa] of a joint under 1 MPa, behind springs of this stiffness [Pa/m]."""
    elastic = (C + 1e6 * TAN_PHI) / K_S
    slip = (displacement - elastic) / (1 + stiffness * TAN_PHI * TAN_PSI / K_S)
    sigma_n = -1e6 - stiffness * TAN_PSI * slip
    return slip, sigma_n, C - sigma_n * TAN_PHI


def crept(days, top, n):
    """The same with Kelvin units, held down, while the block moves on to 4 mm by `days`: by n steps, of which each finds
    the slip with the tractions it ends with and lets the Kelvin units follow those (backward Euler)."""
    dt = days / n
    e_n, eta_n, e_s, eta_s = 3e9, 9e9, 0.8e9, 4e9
    stiffness = 1 / (1 / K_N + 1 / STEEL)
    slip = d_n = d_s = 0.0
    for i in range(1, n + 1):
        moved = top * i / n
        k_n = 1 / (1 / stiffness + 1 / (e_n + eta_n / dt))
        k_s = 1 / (1 / K_S + 1 / (e_s + eta_s / dt))
        o_n, o_s = (d * eta / (eta + e * dt) for d, e, eta in ((d_n, e_n, eta_n), (d_s, e_s, eta_s)))
        trial = k_s * (moved - slip - o_s)
        pressed = 1e6 + k_n * (slip * TAN_PSI + o_n)
        excess = trial - (C + pressed * TAN_PHI)
        if excess > 0:
            more = excess / (k_s + k_n * TAN_PHI * TAN_PSI)
            slip, trial, pressed = slip + more, trial - k_s * more, pressed + k_n * TAN_PSI * more
        d_n += (-(pressed - 1e6) - e_n * d_n) * dt / (eta_n + e_n * dt)
        d_s += (trial - e_s * d_s) * dt / (eta_s + e_s * dt)
    return slip, -pressed, trial


class Dilation(ChainTest):
    def shear(self, text, engine, *options):
        text = changed(text, "^tolerance = 1e-9", f'tolerance = 1e-9\nengine = "{engine}"')
        return datasets(self.chain.result(text, *options))

    def test_under_a_constant_load_it_rises_by_slip_times_tan_psi(self):
        slip, sigma_n, tau = sheared(4e-3, 0)
        for engine in "relaxation", "implicit":
            with self.subTest(engine=engine):
                data = self.shear(SCENE, engine)
                self.assertAlmostEqual(data["/history/displacement"][-1, 0, 1] / (slip * TAN_PSI), 1, delta=1e-4)
                for found in data["/states/traction"][-1]:
                    self.assertAlmostEqual(found[0] / sigma_n, 1, delta=1e-3)
                    self.assertAlmostEqual(found[1] / tau, 1, delta=1e-3)

    def test_held_down_it_grows_stronger(self):
        """Dynamic relaxation needs many increments: slip that overshoots opens the joint for good."""
        slip, sigma_n, tau = sheared(4e-3, 1 / (1 / K_N + 1 / STEEL))
        self.assertGreater(-sigma_n, 1.7e6)
        for engine, increments, delta in ("relaxation", 200, 5e-3), ("implicit", 1, 1e-3), ("implicit", 20, 1e-3):
            with self.subTest(engine=engine, increments=increments):
                text = changed(changed(SCENE, *HELD), "^tolerance", f"unloading_increments = {increments}\ntolerance")
                data = self.shear(text, engine)
                for found in data["/states/traction"][-1]:
                    self.assertAlmostEqual(found[0] / sigma_n, 1, delta=delta)
                    self.assertAlmostEqual(found[1] / tau, 1, delta=delta)

    def test_increments_chosen_by_error(self):
        """Twice as many each time, until little changes; the file is that of the last number alone."""
        _, sigma_n, tau = sheared(4e-3, 1 / (1 / K_N + 1 / STEEL))
        text = changed(changed(SCENE, *HELD), "^tolerance = 1e-9", 'tolerance = 1e-9\nengine = "relaxation"')
        joints = self.chain.joints(text)

        def error(path):
            off = datasets(path)["/states/traction"][-1] - [sigma_n, tau]
            return (np.sqrt((off**2).mean(axis=0)) / [abs(sigma_n + 1e6), tau]).max()  # over the change since the start

        once = self.chain.run("demsolve", joints, joints.with_name("once.h5"), "-q")
        self.assertGreater(error(once), 0.02)
        numbers = []
        for tolerance in 0.02, 0.005:
            chosen = self.chain.run("demsolve", joints, joints.with_name("chosen.h5"), "-q", "--increments-tolerance", tolerance)
            self.assertLess(error(chosen), tolerance)
            options = datasets(chosen)["/provenance/options"][-1]
            alone = self.chain.run("demsolve", joints, joints.with_name("alone.h5"), "-q", *options.split())
            self.assertEqual(chosen.read_bytes(), alone.read_bytes())
            numbers.append(int(re.fullmatch(r"--increments (\d+)", options)[1]))
        self.assertLess(*numbers)
        others = "-q", "--engine", "relaxation", "--tolerance", "1e-8"
        chosen = self.chain.run("demsolve", joints, joints.with_name("chosen.h5"), *others, "--increments-tolerance", "0.02")
        given = datasets(chosen)["/provenance/options"][-1].split()
        self.assertIn("--engine", given)
        alone = self.chain.run("demsolve", joints, joints.with_name("alone.h5"), "-q", *given)
        self.assertEqual(chosen.read_bytes(), alone.read_bytes())
        # The key of a scene does the same as the option.
        by_key = self.chain.result(changed(text, "^tolerance", "increments_tolerance = 0.02\ntolerance"))
        self.assertEqual(datasets(by_key)["/provenance/options"][-1], f"--increments {numbers[0]}")
        self.assertLess(error(by_key), 0.02)
        for option in "--factor-of-safety", "--checkpoint=kept.h5", "--increments=2":
            done = self.chain.answer("demsolve", joints, "--increments-tolerance", "0.1", option, "-o", joints.with_name("no.h5"))
            self.assertEqual(done.returncode, 2)
            self.assertIn("increments", done.stderr)

    def test_it_ends_at_the_slip_that_is_given(self):
        """Beyond it the block rises no farther, and held down it is pressed no more."""
        until = 2e-3
        ending = ("^dilation_angle_deg = 10", f"dilation_angle_deg = 10\ndilation_until_m = {until}")
        stiffness = 1 / (1 / K_N + 1 / STEEL)
        for engine in "relaxation", "implicit":
            with self.subTest(engine=engine):
                self.assertGreater(sheared(4e-3, stiffness)[0], until)
                data = self.shear(changed(SCENE, *ending), engine)
                self.assertAlmostEqual(data["/history/displacement"][-1, 0, 1] / (until * TAN_PSI), 1, delta=1e-4)
                text = changed(changed(SCENE, *ending), *HELD)
                data = self.shear(changed(text, "^tolerance", "unloading_increments = 200\ntolerance"), engine)
                sigma_n = -1e6 - stiffness * until * TAN_PSI
                for found in data["/states/traction"][-1]:
                    self.assertAlmostEqual(found[0] / sigma_n, 1, delta=1e-3)
                    self.assertAlmostEqual(found[1] / (C - sigma_n * TAN_PHI), 1, delta=1e-3)

    def test_creeps_as_by_tiny_steps(self):
        fine = crept(10, 4e-3, 20000)
        again = crept(10, 4e-3, 40000)
        self.assertLess(abs(fine[1] / again[1] - 1), 1e-4)
        text = changed(changed(SCENE, *HELD), "^dilation_angle_deg = 10", KELVIN)
        for engine in "relaxation", "implicit":
            errors = []
            for days in 1, 0.5:
                data = self.shear(text + f"\n[creep]\nstep_days = {days}\n", engine)
                found = data["/states/traction"][-1].mean(axis=0)
                errors.append(max(abs(found[0] / again[1] - 1), abs(found[1] / again[2] - 1)))
            with self.subTest(engine=engine, errors=errors):
                self.assertLess(errors[0], 2e-2)
                self.assertLess(errors[1], 0.6 * errors[0])

    def test_energy(self):
        data = self.shear(changed(SCENE, *HELD), "implicit")
        work = data["/equilibria/dissipated_energy"]
        slip, sigma_n, tau = sheared(4e-3, 1 / (1 / K_N + 1 / STEEL))
        self.assertGreater(slip, 0)
        self.assertAlmostEqual(work.sum() / (2 * slip * (tau + sigma_n * TAN_PSI)), 1, delta=1e-3)


if __name__ == "__main__":
    main()
