"""A Barton-Bandis joint, through the whole chain and by both engines: a rigid block that is pressed on it and sheared along
it, against the formulas."""

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
name = "rough"
normal_stiffness_MPa_per_m = 10000
shear_stiffness_MPa_per_m = 1000
cohesion_MPa = 0
friction_angle_deg = 30
tensile_strength_MPa = 0
joint_roughness_coefficient = 10
joint_wall_strength_MPa = 100
largest_closure_mm = 0.2

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
displacement_mm = [3, 0]
load_history = [[0, 0], [10, 0], [20, 1]]

[[boundary]]
from_m = [2, 0]
to_m = [2, 1]
fix = "x"
displacement_mm = [3, 0]
load_history = [[0, 0], [10, 0], [20, 1]]

[[boundary]]
from_m = [0, 1]
to_m = [2, 1]
traction_MPa = [0, -1]
load_history = [[0, 1], [10, LOAD], [20, LOAD]]

[schedule]
end = 20

[[point]]
name = "top"
at_m = [1, 1]

[zones]
size_m = 0.5

[equilibrium]
tolerance = 1e-9
unloading_increments = 40
engine = "ENGINE"
"""

K_NI, V_M, STEEL = 1e10, 2e-4, 1e13


def closure(p):
    return p * V_M / (K_NI * V_M + p)


def strength(p):
    return p * math.tan(math.radians(30 + 10 * math.log10(1e8 / p)))


class BartonBandis(ChainTest):
    def pressed(self, load, engine, scene=SCENE):
        return datasets(self.chain.result(scene.replace("LOAD", str(load)).replace("ENGINE", engine)))

    def test_it_closes_and_slips_by_the_formulas(self):
        """Loaded to 5 and to 60 MPa, where it is 900 times as stiff as without load, and unloaded to 0.2 MPa; then moved."""
        for load in 5, 60, 0.2:
            for engine, delta in ("relaxation", 3e-2), ("implicit", 1e-3), ("auto", 1e-3):
                with self.subTest(load=load, engine=engine):
                    data = self.pressed(load, engine)
                    days = data["/history/time"].tolist()
                    down = -data["/history/displacement"][days.index(10), 0, 1]
                    wanted = closure(load * 1e6) - closure(1e6) + (load - 1) * 1e6 / STEEL
                    self.assertAlmostEqual(down / wanted, 1, delta=1e-3)
                    limit = min(strength(load * 1e6), 1e9 * 3e-3)
                    length = data["/mesh/contact_length"]
                    sigma_n, tau = length @ data["/states/traction"][-1] / length.sum()
                    self.assertAlmostEqual(-sigma_n / (load * 1e6), 1, delta=1e-6)
                    self.assertAlmostEqual(tau / limit, 1, delta=delta)

    def test_the_account_of_energy_closes_where_it_stiffens_at_once(self):
        scene = changed(SCENE, "^unloading_increments = 40", "unloading_increments = 1")
        data = self.pressed(60, "relaxation", changed(scene, "^displacement_mm = .*", "displacement_mm = [0, 0]", 2))
        work, *parts = (data[f"/equilibria/{name}_energy"] if name != "work" else data["/equilibria/work_of_loads"]
                        for name in ("work", "stored", "dissipated", "damped"))
        self.assertLess(abs(work - sum(parts)).max(), 1e-6 * abs(work).max())
        self.assertGreater(parts[2].max(), 0.1 * abs(work).max())

    def test_rock_bridges_are_refused(self):
        scene = self.chain.bridged("joint_roughness_coefficient = 8\njoint_wall_strength_MPa = 50\nlargest_closure_mm = 0.3",
                                   cohesion=0, creeps=False)
        network = self.chain.network(scene)
        answer = self.chain.answer("strength-averaging", network, "-o", network.with_name("joints.h5"))
        self.assertNotEqual(answer.returncode, 0)
        self.assertIn("Barton-Bandis", answer.stderr)
        self.assertIn("persistence of 1", answer.stderr)


if __name__ == "__main__":
    main()
