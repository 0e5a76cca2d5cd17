"""The paper's column against its closed form."""

import functools
import re
import tomllib

import numpy

from chain import ChainTest, changed, datasets, main

import column_closed_form

# Relative. Unbalanced forces of 1e-6, the default tolerance, leave 5e-6 at most; 1e-3 is asked for.
REACHED = 2e-5

# (point, day, before what happens on that day): rise [mm], with g = 9.81 m/s2. Worked out by hand.
PRINTED = {
    ("A", 5, True): 1.72008,
    ("B", 10, False): 2.22049,
    ("B", 20, True): 2.91574,
    ("C", 10, False): 1.07815,
    ("C", 20, False): 1.84885,
    ("C", 40, True): 2.36185,
}

EQUILIBRIUM = r"(?s)^\[equilibrium\].*"  # the last table of the scene, the paper's way


@functools.cache
def solved(text, *options):
    return datasets(ChainTest.chain.result(text, *options))


def rises(result):
    """(point, day, before): rise [m]; on a stage's day once before it and once after."""
    return {
        (point, float(day), event == ""): result["/history/displacement"][row, column, 1]
        for row, (day, event) in enumerate(zip(result["/history/time"], result["/history/event"]))
        for column, point in enumerate(result["/history/point"])
    }


class Column(ChainTest):
    def setUp(self):
        self.text = self.chain.text("data/column/scene.toml")

    def test_pulses_of_the_stress(self):
        """A creep step of a day is a pulse of the stress under B's block, which dies out: nine between the removals on days 1 and 10,
        ten between those on 10 and 20 (the paper's Fig. 7)."""
        steps = solved(self.text, "--step-history", 20)
        day, stress = steps["/step_history/time"], steps["/step_history/traction"][:, 0, 0]
        level = lambda d: stress[day == d][-1]
        pulses = [d for d in range(2, 21) if stress[day == d].min() < 1.01 * level(d - 1)]  # compression is negative
        self.assertEqual([sum(low < d <= high for d in pulses) for low, high in ((1, 10), (10, 20))], [9, 10])
        for d in pulses:
            if d not in (10, 20):
                self.assertAlmostEqual(level(d) / level(d - 1), 1, delta=1e-5)
        self.assertAlmostEqual(level(10) / level(9), 0.5, delta=1e-4)

    def assert_closed_form(self, text, *options, creeps=True):
        """Every point is on the closed form at every recorded time, and there are as many as there should be."""
        column = column_closed_form.column_of(tomllib.loads(text))
        if not creeps:
            for joint in column.joints:
                joint.kelvin_stiffness = 0
        found = rises(solved(text, *options))
        self.assertGreaterEqual(len(found), 3 * (44 if creeps else 8))
        for (point, day, before), rise in found.items():
            wanted = column_closed_form.rise(column, column.points[point], day, before)
            self.assertAlmostEqual(rise, wanted, delta=REACHED * abs(wanted), msg=f"{point}, day {day}, {before=}")

    def test_printed_figures(self):
        column = column_closed_form.column_of(tomllib.loads(self.text))
        found = rises(solved(self.text))
        for (point, day, before), printed in PRINTED.items():
            exact = 1e3 * column_closed_form.rise(column, column.points[point], day, before)
            self.assertAlmostEqual(exact, printed, delta=0.6e-5)  # printed to five decimal places
            self.assertAlmostEqual(1e3 * found[point, day, before], printed, delta=0.6e-5 + REACHED * printed)

    def test_every_point_and_day(self):
        self.assert_closed_form(self.text)

    def test_without_lateral_strain(self):
        self.assert_closed_form(changed(self.text, "^poissons_ratio = 0.22", "poissons_ratio = 0"))

    def test_fixed_base(self):
        self.assert_closed_form(changed(self.text, '^joint = "base joint"', 'fix = "y"'))

    def test_mesh_does_not_matter(self):
        self.assert_closed_form(self.text, "--zone-size", "5")

    def test_without_creep(self):
        self.assert_closed_form(self.text, "--no-creep", creeps=False)

    def test_every_damping(self):
        for masses in "real", "scaled":
            for damping in "adaptive", "local":
                with self.subTest(masses=masses, damping=damping):
                    way = f'[equilibrium]\nmasses = "{masses}"\ndamping = "{damping}"'
                    self.assert_closed_form(changed(self.text, EQUILIBRIUM, way))

    def test_default_damping_with_large_zones(self):
        self.assert_closed_form(changed(self.text, EQUILIBRIUM, ""), "--zone-size", "10")

    def test_shear_stiffness_does_not_matter(self):
        # So near the exact balance that what the tolerance leaves is below what is looked for.
        one = solved(self.text, "--tolerance", "1e-11")
        other = solved(changed(self.text, "^shear_stiffness_MPa_per_m = 280", "shear_stiffness_MPa_per_m = 560"),
                       "--tolerance", "1e-11")
        rise = one["/history/displacement"][..., 1]
        difference = one["/history/displacement"] - other["/history/displacement"]
        self.assertLess(numpy.abs(difference).max(), 1e-9 * rise.max())

    def test_history(self):
        text = changed(self.text, r"^at_m = \[5, 5\]", "at_m = [5, 5]\nfirst_reading = 10")
        result = solved(text)
        time, event, present = (result["/history/" + name] for name in ("time", "event", "present"))
        displacement = result["/history/displacement"]

        # Day 0, every creep step, and a second row on the day of a stage, which carries its name.
        stages = {1: "block 1 removed", 10: "block 2 removed", 20: "block 3 removed"}
        wanted = [(day, name) for day in range(41) for name in ("", stages.get(day)) if name is not None]
        self.assertEqual([(float(t), e) for t, e in zip(time, event)], wanted)
        self.assertEqual(list(result["/history/point"]), ["A", "B", "C"])
        self.assertEqual(result["/history/point_position"].tolist(), [[5, 25], [5, 15], [5, 5]])
        self.assertEqual(displacement.shape, (44, 3, 2))
        self.assertTrue((displacement[0] == 0).all())

        # A leaves with block 2, B with block 3; their last displacement is held.
        for column, stage in enumerate(["block 2 removed", "block 3 removed"]):
            gone = list(event).index(stage)
            self.assertTrue((present[:gone, column] == 1).all() and (present[gone:, column] == 0).all())
            self.assertTrue((displacement[gone:, column] == displacement[gone - 1, column]).all())
            self.assertGreater(displacement[gone - 1, column, 1], displacement[gone - 2, column, 1])
        self.assertTrue((present[:, 2] == 1).all())

        # C is read first on day 10, after that day's stage.
        self.assertEqual(result["/history/first_reading_row"].tolist(), [0, 0, wanted.index((10, stages[10]))])

        # The state of the whole section: the start, before and after each stage, the end.
        self.assertEqual(result["/states/time"].tolist(), [0, 1, 1, 10, 10, 20, 20, 40])
        self.assertEqual([name for name in result["/states/event"] if name], list(stages.values()))


class UnderItsWeight(ChainTest):
    """The column without stress in situ settles on its way to the first equilibrium, which the step history of dynamic relaxation shows."""

    BLOCK, WEIGHT, STIFFNESS = 10, 2750 * 9.81, 6.9e8  # [m], [N/m3], [Pa/m]
    # Of the centres, from the lowest: by CalculiX 2.20 [mm], with a joint under the lowest block.
    CALCULIX = (1.684726, 3.050373, 3.960688, 4.415845)

    def settlements(self, base, poisson):
        """By closed form, from the lowest block up, and computed [m]."""
        text = changed(self.chain.text("data/column/scene.toml"), "^compression_yy_gradient_MPa_per_m = 0.0269775",
                       "compression_yy_gradient_MPa_per_m = 0")
        text = text.replace("poissons_ratio = 0.22", f"poissons_ratio = {poisson}")
        text = changed(text, "^end = 40", "end = 0.5")
        text = re.sub(r"(?s)^\[\[stage\]\].*?(?=^\[\[point)", "", text, flags=re.MULTILINE)
        text += '[[point]]\nname = "top block"\nat_m = [5, 35]\n'
        if base == "fixed":
            text = changed(text, '^joint = "base joint"', 'fix = "y"')
        steps = datasets(self.chain.result(text, "--no-creep", "--step-history", 20, "--tolerance", "1e-8"))
        settled = -steps["/step_history/displacement"][-1, [2, 1, 0, 3], 1]
        young = 40e9 / (1 - poisson**2)
        wanted = []
        for n in range(4):
            joints = sum(self.BLOCK * (4 - m) for m in range(0 if base == "joint" else 1, n + 1)) / self.STIFFNESS
            z, top = self.BLOCK * (n + 0.5), 4 * self.BLOCK
            wanted.append(self.WEIGHT * (joints + (top * z - z**2 / 2) / young))
        return numpy.array(wanted), settled

    def test_without_sideways_strain(self):
        for base in "joint", "fixed":
            wanted, settled = self.settlements(base, 0)
            # Zones of 2.5 m hold the curve of displacements to rho g h^2 / 8 E = 5e-7 m at worst; less at these places.
            numpy.testing.assert_allclose(settled, wanted, rtol=0, atol=1e-7, err_msg=base)

    def test_as_the_paper_has_it(self):
        """Sides bulge more the deeper they are, so that level planes bend; joints and base hold them flat, which the closed
        form leaves out: 7e-7 m. CalculiX has it, with other zones."""
        printed = {"joint": (1.684250, 3.049723, 3.960038, 4.415196), "fixed": (0.120337, 1.485810, 2.396125, 2.851283)}
        for base, millimetres in printed.items():
            wanted, settled = self.settlements(base, 0.22)
            numpy.testing.assert_allclose(1e3 * wanted, millimetres, atol=1e-6)
            self.assertLess(abs(settled - wanted).max(), 1e-6, base)
            if base == "joint":
                self.assertLess(abs(1e3 * settled - self.CALCULIX).max(), 4e-4)


if __name__ == "__main__":
    main()
