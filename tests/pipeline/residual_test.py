"""A joint that weakens at its first slip, through the whole chain and by both engines: a rigid block that is sheared on it,
by a displacement and by a load that a soft buffer takes over, against closed forms."""

import math

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
name = "brittle"
normal_stiffness_MPa_per_m = 4000
shear_stiffness_MPa_per_m = 1000
cohesion_MPa = 0.2
friction_angle_deg = 35
tensile_strength_MPa = 0
residual_cohesion_MPa = 0.05
residual_friction_angle_deg = 25

[[joint_material]]
name = "buffer"
normal_stiffness_MPa_per_m = 200
shear_stiffness_MPa_per_m = 0
cohesion_MPa = 0
friction_angle_deg = 0
tensile_strength_MPa = 0

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
joint = "brittle"

[[boundary]]
from_m = [0, 1]
to_m = [2, 1]
fix = "y"

[[boundary]]
from_m = [0, 0]
to_m = [0, 1]
DRIVEN

[[boundary]]
from_m = [2, 0]
to_m = [2, 1]
RIGHT

[schedule]
end = 20

[[point]]
name = "side"
at_m = [2, 0.5]

[zones]
size_m = 0.5

[equilibrium]
tolerance = 1e-9
unloading_increments = INCREMENTS
engine = "ENGINE"
"""

K_S, K_BUFFER = 1e9, 0.2e9
PEAK = 0.2e6 + 1e6 * math.tan(math.radians(35))
LEFT = 0.05e6 + 1e6 * math.tan(math.radians(25))


class Residual(ChainTest):
    def run_with(self, driven, right, engine, increments, scene=SCENE):
        for word, text in ("DRIVEN", driven), ("RIGHT", right), ("ENGINE", engine), ("INCREMENTS", str(increments)):
            scene = scene.replace(word, text)
        return datasets(self.chain.result(scene))

    def moved(self, load_history, engine, increments, scene=SCENE):
        side = f'fix = "x"\ndisplacement_mm = [4, 0]\nload_history = {load_history}'
        return self.run_with(side, side, engine, increments, scene)

    def assert_shear(self, data, wanted, delta):
        for found in data["/states/traction"][-1]:
            self.assertAlmostEqual(found[1] / wanted, 1, delta=delta)

    def test_sheared_it_falls_from_the_peak_to_the_residual_strength(self):
        just_below, just_above = 0.98 * PEAK / K_S / 4e-3, 1.02 * PEAK / K_S / 4e-3
        for engine, increments, delta in ("relaxation", 200, 5e-3), ("implicit", 20, 1e-3), ("implicit", 1, 1e-3):
            for load_history, wanted in ((f"[[0, 0], [20, {just_below}]]", 0.98 * PEAK),
                                   (f"[[0, 0], [20, {just_above}]]", LEFT),
                                   ("[[0, 0], [10, 1], [20, 0.9]]", LEFT - K_S * 0.4e-3),
                                   ("[[0, 0], [10, 1], [20, 0.1]]", -LEFT)):
                with self.subTest(engine=engine, increments=increments, load_history=load_history):
                    data = self.moved(load_history, engine, increments)
                    self.assert_shear(data, wanted, delta * LEFT / abs(wanted))

    def test_without_the_keys_slip_weakens_nothing(self):
        scene = changed(changed(SCENE, "^residual_cohesion.*\n", ""), "^residual_friction.*\n", "")
        for engine, increments, delta in ("relaxation", 200, 5e-3), ("implicit", 20, 1e-3):
            with self.subTest(engine=engine):
                self.assert_shear(self.moved("[[0, 0], [20, 1]]", engine, increments, scene), PEAK, delta)

    def test_a_buffer_takes_what_it_no_longer_bears(self):
        """3 MPa on the side: nine tenths of it would come to the joint, which bears 0.6 and then 0.3 of it. By dynamic relaxation,
        which follows the fall, the joint dissipates what is under its curve, less what its spring holds in the end."""
        loaded = "traction_MPa = [3, 0]\nload_history = [[0, 0], [20, 1]]"
        for engine in "relaxation", "implicit", "auto":
            with self.subTest(engine=engine):
                data = self.run_with(loaded, 'joint = "buffer"', engine, 20)
                u = data["/history/displacement"][-1, 0, 0]
                self.assertAlmostEqual(u * K_BUFFER / (3e6 - 2 * LEFT), 1, delta=1e-3)
                work, stored, dissipated, damped = (
                    data[f"/equilibria/{name}"]
                    for name in ("work_of_loads", "stored_energy", "dissipated_energy", "damped_energy"))
                self.assertLess(abs(work - stored - dissipated - damped).max(), 1e-6 * abs(work).max())
                self.assertGreater(dissipated.sum(), 0)
                if engine == "relaxation":
                    wanted = PEAK**2 / K_S / 2 + LEFT * (u - PEAK / K_S) - LEFT**2 / K_S / 2
                    self.assertAlmostEqual(dissipated.sum() / (2 * wanted), 1, delta=0.02)
                self.assertGreaterEqual(dissipated.min(), -1e-6 * dissipated.max())


if __name__ == "__main__":
    main()
