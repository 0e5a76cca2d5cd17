"""A part of a joint with its own material: a shorter joint that is drawn over a longer one, at angles whose lines do not
quite agree in the last digits, or in the centimetres."""

import math

from chain import ChainTest, datasets, main

HEAD = """
[section]
outline_m = [[0, 0], [40, 0], [40, 30], [0, 30]]
rock = "rock"
gravity_m_per_s2 = 9.81

[[rock]]
name = "rock"
density_kg_per_m3 = 2700
youngs_modulus_GPa = 20
poissons_ratio = 0.25

[in_situ_stress]
elevation_m = 30
compression_xx_MPa = 0
compression_yy_MPa = 0
shear_xy_MPa = 0
compression_xx_gradient_MPa_per_m = 0.01
compression_yy_gradient_MPa_per_m = 0.0265
shear_xy_gradient_MPa_per_m = 0

[[boundary]]
from_m = [0, 0]
to_m = [40, 0]
fix = "xy"

[schedule]
end = 1

[zones]
size_m = 5
"""


def material(name, cohesion):
    return f"""
[[joint_material]]
name = "{name}"
normal_stiffness_MPa_per_m = 5000
shear_stiffness_MPa_per_m = 2000
cohesion_MPa = {cohesion}
friction_angle_deg = 30
tensile_strength_MPa = 0
"""


def joint(name, of, start, end):
    return f"""
[[joint]]
name = "{name}"
material = "{of}"
from_m = [{start[0]!r}, {start[1]!r}]
to_m = [{end[0]!r}, {end[1]!r}]
"""


class Patch(ChainTest):
    def test_the_later_one_counts(self):
        for degrees in -31, -7.3, 0, 12.7, 33:
            along = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))

            def at(s, digits=17):
                return round(20 + s * along[0], digits), round(15 + s * along[1], digits)

            coarse = joint("patch", "rough", at(-4, 2), at(3, 2))
            long, patch = joint("long", "clay", at(-50), at(50)), joint("patch", "rough", at(-4), at(3))
            turned = joint("patch", "rough", at(3), at(-4))
            for joints, wanted in (long + patch, 7), (long + turned, 7), (long + coarse, 7), (patch + long, 0):
                with self.subTest(degrees=degrees, wanted=wanted):
                    data = datasets(self.chain.joints(HEAD + material("clay", 0.1) + material("rough", 0.5) + joints))
                    position, of = data["/vertices/position"], data["/equivalent/cohesion"]
                    rough, all_of_it = 0, 0
                    for (a, b), kind, cohesion in zip(data["/edges/vertex"], data["/edges/kind"], of):
                        if kind == 1:
                            length = math.dist(position[a], position[b])
                            all_of_it += length
                            rough += length if cohesion == 0.5e6 else 0
                    self.assertAlmostEqual(rough, wanted, delta=0.02 if coarse in joints else 1e-6)
                    self.assertGreater(all_of_it, 30)


if __name__ == "__main__":
    main()
