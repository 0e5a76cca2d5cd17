"""What creeps, through the whole chain: Kelvin chains, Maxwell dashpots and rock, by every scheme and both engines,
against closed forms. One block of 10 m x 10 m on a smooth joint; the block above it leaves on day 1."""

import math

from chain import ChainTest, changed, datasets, main

SCENE = """
[section]
outline_m = [[0, 0], [10, 0], [10, 20], [0, 20]]
rock = "rock"
gravity_m_per_s2 = 9.81

[[rock]]
name = "rock"
density_kg_per_m3 = 2750
youngs_modulus_GPa = 40
poissons_ratio = 0.22
# rock creep

[[joint_material]]
name = "smooth"
normal_stiffness_MPa_per_m = 690
shear_stiffness_MPa_per_m = 0
cohesion_MPa = 0
friction_angle_deg = 0
tensile_strength_MPa = 0
# joint creep

[[joint]]
name = "joint"
from_m = [0, 10]
to_m = [10, 10]
material = "smooth"

[[boundary]]
from_m = [0, 0]
to_m = [5, 0]
joint = "smooth"

[[boundary]]
from_m = [5, 0]
to_m = [10, 0]
joint = "smooth"

[in_situ_stress]
elevation_m = 20
compression_xx_MPa = 0
compression_yy_MPa = 0
shear_xy_MPa = 0
compression_xx_gradient_MPa_per_m = 0
compression_yy_gradient_MPa_per_m = 0.0269775
shear_xy_gradient_MPa_per_m = 0

[schedule]
end = 31

[[stage]]
name = "upper block removed"
date = 1
remove_m = [[[0, 10], [10, 10], [10, 20], [0, 20]]]

[[point]]
name = "C"
at_m = [5, 5]

[creep]
step_days = 3

[zones]
size_m = 2.5

[equilibrium]
tolerance = 1e-9
"""

UNITS = ((690e6, 6900e6), (300e6, 9000e6))  # of the chain: E [Pa/m], eta [Pa day/m]
MAXWELL = 4e10
CHAIN = """kelvin_chain = [
    { normal_stiffness_MPa_per_m = 690, normal_viscosity_MPa_day_per_m = 6900, shear_stiffness_MPa_per_m = 1, shear_viscosity_MPa_day_per_m = 1 },
    { normal_stiffness_MPa_per_m = 300, normal_viscosity_MPa_day_per_m = 9000, shear_stiffness_MPa_per_m = 1, shear_viscosity_MPa_day_per_m = 1 },
]
normal_maxwell_viscosity_MPa_day_per_m = 4e4
shear_maxwell_viscosity_MPa_day_per_m = 1"""
ROCK = """kelvin_shear_modulus_GPa = 6
kelvin_shear_viscosity_GPa_day = 60"""

YOUNG, POISSON, LOAD, BELOW = 40e9, 0.22, 2750 * 9.81 * 10, 5.0
SHEAR, BULK = YOUNG / 2 / (1 + POISSON), YOUNG / 3 / (1 - 2 * POISSON)


def joint_rise(days):
    crept = sum(-math.expm1(-days * e / eta) / e for e, eta in UNITS) + days / MAXWELL
    return LOAD * (1 / 690e6 + crept)


def rock_strain(days, modulus=6e9, viscosity=60e9):
    """tests/creep/rock_test.cpp has its derivation."""
    ends = [1 / (3 * BULK + g) for g in (SHEAR, SHEAR * modulus / (SHEAR + modulus))]
    rate = (3 * BULK * (SHEAR + modulus) + SHEAR * modulus) / ((3 * BULK + SHEAR) * viscosity)
    first = (1 / SHEAR - math.expm1(-days * modulus / viscosity) / modulus) / 4
    return LOAD * (first + 3 / 4 * (ends[1] + (ends[0] - ends[1]) * math.exp(-rate * days)))


ELASTIC = LOAD * (1 - POISSON**2) / YOUNG


class Creep(ChainTest):
    def assert_rises(self, text, wanted, relative):
        data = datasets(self.chain.result(text))
        days, rise = data["/history/time"], data["/history/displacement"][:, 0, 1]
        after = [i for i, event in enumerate(data["/history/event"]) if event][0]
        self.assertGreaterEqual(len(days) - after, 5)
        for day, found in zip(days[after:], rise[after:]):
            self.assertAlmostEqual(found / wanted(day - 1), 1, delta=relative, msg=f"day {day}")

    def test_kelvin_chain_and_maxwell(self):
        """Equilibrium fixes the tractions, so every scheme is exact."""
        text = changed(SCENE, "^# joint creep", CHAIN)
        for engine in "relaxation", "implicit":
            for scheme in "published", "backward", "linear force", "fitted":
                with self.subTest(engine=engine, scheme=scheme):
                    this = changed(text, "^tolerance = 1e-9", f'tolerance = 1e-9\nengine = "{engine}"')
                    this = changed(this, "^step_days = 3", f'step_days = 3\nscheme = "{scheme}"')
                    self.assert_rises(this, lambda days: joint_rise(days) + BELOW * ELASTIC, 1e-6)

    def test_rock(self):
        """Plane strain shifts stress from direction to direction as shear creeps, so schemes have an error."""
        text = changed(SCENE, "^# rock creep", ROCK)
        text = changed(text, "^step_days = 3", "step_days = 0.5")
        for engine in "relaxation", "implicit":
            with self.subTest(engine=engine):
                this = changed(text, "^tolerance = 1e-9", f'tolerance = 1e-9\nengine = "{engine}"')
                self.assert_rises(this, lambda days: LOAD / 690e6 + BELOW * rock_strain(days), 3e-5)

    def test_steps_by_tolerance(self):
        text = changed(SCENE, "^# joint creep", CHAIN)
        text = changed(text, "^# rock creep", ROCK)
        text = changed(text, "^step_days = 3", "tolerance_m = 1e-7")
        self.assert_rises(text, lambda days: joint_rise(days) + BELOW * rock_strain(days), 1e-4)


if __name__ == "__main__":
    main()
