"""A uniform stress in a random network of blocks whose joints can carry it: nothing moves."""

import numpy

from chain import ChainTest, changed, datasets, main

STRESS = 6e6  # the largest principal one, about [Pa]
YOUNGS_MODULUS, SIZE = 20e9, 60  # [Pa], [m]

STAGE_AT_THE_END = """
[[stage]]
name = "at the end"
date = 3
remove_m = [[[20, 0], [45, 0], [33, 27]]]
"""


class InSituPatch(ChainTest):
    def moved(self, path):
        """The largest displacement of all gridpoints and recorded times, as a multiple of sigma L / E."""
        result = datasets(path)
        largest = max(numpy.abs(result[f"/{what}/displacement"]).max() for what in ("states", "history"))
        return largest * YOUNGS_MODULUS / (STRESS * SIZE), result

    def assert_rests(self, path):
        moved, result = self.moved(path)
        self.assertLess(moved, 1e-10)
        self.assertEqual(result["/equilibria/steps"].max(), 0)
        self.assertLess(result["/equilibria/unbalanced_force_ratio"].max(), 1e-13)
        return result

    def test_random_network(self):
        text = self.chain.text("tests/pipeline/patch.toml")
        for realization in range(4):
            with self.subTest(realization=realization):
                joints = self.chain.joints(text, "--realization", realization)
                for engine, tolerance in ("auto", "1e-6"), ("implicit", "1e-12"), ("relaxation", "1e-12"):
                    result = self.assert_rests(self.chain.run(
                        "demsolve", joints, joints.with_name(engine), "--tolerance", tolerance, "--engine", engine))
                blocks = len(result["/blocks/area"])
                self.assertTrue(210 <= blocks <= 390, f"{blocks} blocks, not 300 by and large")
                fraction = result["/edges/joint_fraction"][result["/edges/kind"] == 1]
                self.assertTrue((fraction < 0.99).any(), "there are no rock bridges")

                # Displacements count from the in-situ equilibrium, so no steps to it is the half of the matter. The
                # stress is the scene's in every zone, and every joint carries its share of it.
                stress = result["/states/stress"]
                self.assertTrue(numpy.allclose(stress, [-6e6, -4e6, 1.5e6], rtol=1e-9))
                normal = result["/mesh/contact_normal"]
                tensor = numpy.array([[-6e6, 1.5e6], [1.5e6, -4e6]])
                across = numpy.einsum("ci,ij,cj->c", normal, tensor, normal)
                self.assertTrue(numpy.allclose(result["/states/traction"][:, :, 0], across, rtol=1e-9))

    def test_dynamic_analysis(self):
        """Its displacements count from where it has come to, so it is stresses that tell: a way u in a length L would be
        u E / L of them. Contacts are other ones, between faces, and have to find the same tractions."""
        text = changed(self.chain.text("tests/pipeline/patch.toml"), r'^\[creep\]\nstep_days = 1\nscheme = "published"\n', "")
        text = changed(text, r"^(normal|shear)_kelvin_.*\n", "", count=4)
        text += '\n[large_displacements]\nnew_contacts = "joint"\nmass_damping_per_s = 100\n'
        for realization in range(2):
            with self.subTest(realization=realization):
                joints = self.chain.joints(text, "--realization", realization)
                result = self.assert_rests(self.chain.run("demsolve", joints, joints.with_name("result.h5")))
                self.assertLess(numpy.abs(result["/states/stress"] - [-6e6, -4e6, 1.5e6]).max() / STRESS, 1e-10)
                normal = result["/mesh/contact_normal"]
                tangent = numpy.stack([normal[:, 1], -normal[:, 0]], axis=1)
                tensor = numpy.array([[-6e6, 1.5e6], [1.5e6, -4e6]])
                for part, on in enumerate((normal, tangent)):
                    wanted = numpy.einsum("ci,ij,cj->c", normal, tensor, on)
                    self.assertLess(numpy.abs(result["/states/traction"][:, :, part] - wanted).max() / STRESS, 1e-9)

    def test_free_surface(self):
        """Where the stress leaves it, a surface is not held at all."""
        text = self.chain.text("tests/pipeline/patch.toml")
        text = changed(text, "^compression_yy_MPa = 4", "compression_yy_MPa = 0")
        text = changed(text, "^shear_xy_MPa = 1.5", "shear_xy_MPa = 0")
        text = changed(text, r'^\[\[boundary\]\]\nfrom_m = \[60, 40\]\nto_m = \[0, 40\]\nfix = "xy"\n', "")
        self.assert_rests(self.chain.result(text))

    def test_a_load_comes_and_goes(self):
        """On the free surface, and joints hold: an engine moves, and comes back to where nothing had moved."""
        text = changed(self.chain.text("tests/pipeline/patch.toml"), "^compression_yy_MPa = 4", "compression_yy_MPa = 0")
        text = changed(text, "^shear_xy_MPa = 1.5", "shear_xy_MPa = 0")
        text = changed(text, "^tensile_strength_MPa = 0", "tensile_strength_MPa = 10")
        text = changed(text, r'^from_m = \[60, 40\]\nto_m = \[0, 40\]\nfix = "xy"\n',
                       "from_m = [60, 40]\nto_m = [0, 40]\ntraction_MPa = [0.3, -0.5]\nload_history = [[0, 0], [1, 1], [2, 0]]\n")
        for engine in "implicit", "relaxation":
            with self.subTest(engine=engine):
                result = datasets(self.chain.result(text, "--no-creep", "--engine", engine, "--tolerance", "1e-8"))
                loaded, back = (numpy.abs(result["/states/displacement"][result["/states/time"] == day]).max()
                                for day in (1, 2))
                self.assertGreater(loaded, 1e-4)
                self.assertLess(back, 1e-5 * loaded)

    def test_uniform_by_a_profile_below_uneven_ground(self):
        level = "{ depth_m = %d, compression_xx_MPa = 6, compression_yy_MPa = 4, shear_xy_MPa = 1.5 }"
        text = changed(self.chain.text("tests/pipeline/patch.toml"), r"^elevation_m = 40\n(compression|shear)_(.*\n)*?\n",
                       "ground_m = [[0, 44], [20, 51], [60, 40]]\n"
                       f"profile = [{level % 0}, {level % 5}, {level % 50}]\n\n")
        self.assert_rests(self.chain.result(text))

    def test_linear_law_by_flat_ground_and_profile(self):
        """A slope under its weight, excavated: the same to rounding by either way of writing the stress."""
        text = self.chain.text("tests/pipeline/random_slope.toml")
        level = "{ depth_m = %g, compression_xx_MPa = %.9g, compression_yy_MPa = %.9g, shear_xy_MPa = 0 }"
        levels = ", ".join(level % (h, 0.013 * h, 0.026487 * h) for h in (0, 50))
        by_profile = changed(text, r"^elevation_m = 50\n(compression|shear)_(.*\n)*?\n",
                             f"ground_m = [[-1000, 50], [10, 50], [1000, 50]]\nprofile = [{levels}]\n\n")
        one, other = (datasets(self.chain.result(scene))["/history/displacement"] for scene in (text, by_profile))
        self.assertGreater(numpy.abs(one).max(), 1e-4)
        self.assertLess(numpy.abs(one - other).max(), 1e-6 * numpy.abs(one).max())

    def test_with_a_stage_at_the_end(self):
        """Stage outlines cut through solid rock change nothing before their day."""
        text = changed(self.chain.text("tests/pipeline/patch.toml"), r"^end = 3$", "end = 3\n" + STAGE_AT_THE_END)
        _, result = self.moved(self.chain.result(text, "--tolerance", "1e-4"))
        before = list(result["/states/event"]).index("at the end")
        self.assertTrue((result["/edges/kind"] == 2).any())
        self.assertLess(numpy.abs(result["/states/displacement"][:before]).max() * YOUNGS_MODULUS,
                        1e-10 * STRESS * SIZE)
        self.assertGreater(numpy.abs(result["/states/displacement"][before]).max(), 1e-5)

    def test_weak_joints_slip(self):
        """Joints that cannot carry the stress do move, which the steps of the first equilibrium show."""
        text = changed(self.chain.text("tests/pipeline/patch.toml"), "^cohesion_MPa = 10", "cohesion_MPa = 0")
        text = changed(text, "^friction_angle_deg = 30", "friction_angle_deg = 5")
        _, result = self.moved(self.chain.result(text, "--tolerance", "1e-3"))
        self.assertGreater(result["/equilibria/steps"][0], 0)
        self.assertFalse(numpy.allclose(result["/states/stress"], [-6e6, -4e6, 1.5e6], rtol=1e-9))


if __name__ == "__main__":
    main()
