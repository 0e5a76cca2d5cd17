"""Rock that yields, through the whole chain: a block squeezed and pulled between smooth plates at several confinements
against Mohr and Coulomb's strength and flow, and a strip load on soft rock."""

import math

from chain import ChainTest, changed, datasets, main

SCENE = """
[section]
outline_m = [[0, 0], [2, 0], [2, 4], [0, 4]]
rock = "marl"
gravity_m_per_s2 = 0

[[rock]]
name = "marl"
density_kg_per_m3 = 2300
youngs_modulus_GPa = 2
poissons_ratio = 0.25
cohesion_MPa = 1
friction_angle_deg = 30
tensile_strength_MPa = 0.5
dilation_angle_deg = 10
law = "Mohr-Coulomb"

[in_situ_stress]
elevation_m = 4
compression_xx_MPa = CONFINED
compression_yy_MPa = CONFINED
shear_xy_MPa = 0
compression_xx_gradient_MPa_per_m = 0
compression_yy_gradient_MPa_per_m = 0
shear_xy_gradient_MPa_per_m = 0

[[boundary]]
from_m = [0, 0]
to_m = [2, 0]
fix = "y"

[[boundary]]
from_m = [0, 0]
to_m = [0, 4]
fix = "x"

[[boundary]]
from_m = [2, 0]
to_m = [2, 4]
traction_MPa = [-CONFINED, 0]

[[boundary]]
from_m = [0, 4]
to_m = [2, 4]
fix = "y"
displacement_mm = [0, MOVED]
load_history = HISTORY

[schedule]
end = 20

[[point]]
name = "corner"
at_m = [2, 4]

[zones]
size_m = 1

[equilibrium]
tolerance = 1e-8
unloading_increments = INCREMENTS
engine = "ENGINE"
"""

N, SHEAR = 3, 2e6 * math.sqrt(3)  # of 30 degrees and 1 MPa
M = (1 + math.sin(math.radians(10))) / (1 - math.sin(math.radians(10)))
PLANE = 2e9 / (1 - 0.25**2)


class Yield(ChainTest):
    def written(self, confined, millimetres, load_history, engine, increments, scene=SCENE):
        for word, value in (("CONFINED", confined), ("MOVED", millimetres), ("HISTORY", load_history), ("ENGINE", engine),
                            ("INCREMENTS", increments)):
            scene = scene.replace(word, str(value))
        return scene

    def moved(self, confined, millimetres, load_history="[[0, 0], [20, 1]]", engine="auto", increments=50):
        return datasets(self.chain.result(self.written(confined, millimetres, load_history, engine, increments)))

    def assert_stress(self, data, wanted, share, state=-1):
        """The mean {xx, yy, xy}, to a share of the strength. What moves overshoots: single zones are a little less loaded."""
        corner = data["/mesh/gridpoint_position"][data["/mesh/zone_gridpoint"]]
        one, other = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
        area = (one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]) / 2
        for found, value in zip(area @ data["/states/stress"][state] / area.sum(), wanted):
            self.assertAlmostEqual(found, value, delta=share * SHEAR)

    def test_squeezed_it_bears_mohr_and_coulombs_strength_and_flows_by_its_dilation(self):
        for confined in 0, 0.5, 3:
            strength = N * confined * 1e6 + SHEAR
            elastic = (strength - confined * 1e6) / PLANE  # strain
            for engine, increments, share in ("relaxation", 200, 5e-3), ("auto", 10, 3e-3), ("auto", 50, 6e-4):
                with self.subTest(confined=confined, engine=engine, increments=increments):
                    data = self.moved(confined, -1000 * 4 * (elastic + 2e-3), engine=engine, increments=increments)
                    self.assert_stress(data, (-confined * 1e6, -strength, 0), share)
                    wider = elastic * 0.25 / 0.75 + M * 2e-3
                    self.assertAlmostEqual(data["/history/displacement"][-1, 0, 0] / (2 * wider), 1, delta=10 * share)
                    plastic = data["/states/plastic_strain"][-1].mean(axis=0)
                    self.assertAlmostEqual(plastic[1] / -2e-3, 1, delta=2 * share)
                    self.assertAlmostEqual(plastic[0] / -plastic[1] / M, 1, delta=1e-3)

    def test_pulled_it_bears_its_tensile_strength(self):
        for engine, increments, share in ("relaxation", 200, 5e-3), ("auto", 50, 6e-4):
            with self.subTest(engine=engine):
                data = self.moved(0.2, 4 * 1.5, engine=engine, increments=increments)
                self.assert_stress(data, (-0.2e6, 0.5e6, 0), share)

    def test_unloaded_and_loaded_again_it_is_elastic_up_to_where_it_was(self):
        strength = N * 0.5e6 + SHEAR
        moved = 4 * ((strength - 0.5e6) / PLANE + 2e-3)  # m
        back = 1 - 4 * (1e6 / PLANE) / moved  # by 1 MPa
        data = self.moved(0.5, -1000 * moved, f"[[0, 0], [10, 1], [12, {back}], [14, 1], [20, 1]]")
        days = data["/states/time"].tolist()
        self.assert_stress(data, (-0.5e6, 1e6 - strength, 0), 1e-3, days.index(12))
        self.assert_stress(data, (-0.5e6, -strength, 0), 1e-3, days.index(14))
        flowed, after = (data["/states/plastic_strain"][days.index(day)] for day in (10, 14))
        self.assertLess(abs(after - flowed).max(), 1e-5)

    def test_the_implicit_engine_finds_it_elastic_or_yielding(self):
        for millimetres, yields in (-4, False), (-20, True):
            data = self.moved(3 if not yields else 0, millimetres, engine="implicit", increments=10)
            self.assertTrue(data["/equilibria/is_implicit"].all())
            self.assertEqual(abs(data["/states/plastic_strain"]).max() > 0, yields)
        self.assert_stress(data, (0, -SHEAR, 0), 1e-9)

    def test_the_account_of_energy_closes_under_a_strip_load(self):
        text = changed(SCENE, r"to_m = \[2, 4\]\nfix = \"y\"\ndisplacement_mm.*",
                       "to_m = [0.8, 4]\ntraction_MPa = [0, -6]")
        text = changed(text, "size_m = 1", "size_m = 0.4")
        for engine in "relaxation", "auto":
            with self.subTest(engine=engine):
                data = datasets(self.chain.result(self.written(0.5, 0, "[[0, 0], [20, 1]]", engine, 10, text)))
                work, stored, dissipated, damped = (
                    data[f"/equilibria/{name}"]
                    for name in ("work_of_loads", "stored_energy", "dissipated_energy", "damped_energy"))
                self.assertLess(abs(work - stored - dissipated - damped).max(), 1e-6 * abs(work).max())
                self.assertGreater(dissipated.sum(), 0)


if __name__ == "__main__":
    main()
