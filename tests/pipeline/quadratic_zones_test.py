"""Quadratic zones through the whole chain: uniform stress, bending, joints, yield, creep, and a run that goes on from a
checkpoint."""


import numpy as np

from chain import ChainTest, changed, datasets, main
from export_test import Grid
from restart_test import SCENE as EVERYTHING
from small_scene import held, joint, material, scene
from yield_test import PLANE, SCENE as SQUEEZED, SHEAR



def quadratic(text):
    return changed(text.replace('kind = "constant strain"\n', ""), r"^\[zones\]$", '[zones]\nkind = "quadratic"')


class QuadraticZones(ChainTest):
    def test_what_a_uniform_stress_does_is_nothing(self):
        """In a random network, with joints at any angle, by both engines."""
        text = quadratic(self.chain.text("tests/pipeline/patch.toml"))
        joints = self.chain.joints(text)
        for engine in "auto", "relaxation":
            data = datasets(self.chain.run("demsolve", joints, joints.with_name(engine), "--engine", engine))
            self.assertLess(np.abs(data["/states/displacement"]).max() * 20e9 / (6e6 * 60), 1e-10)
            self.assertLess(data["/equilibria/unbalanced_force_ratio"].max(), 1e-13)
            self.assertEqual(data["/equilibria/steps"].max(), 0)

    def test_a_cantilever_bends_as_it_should(self):
        """One row of zones, then two; constant strain is 37 and 18 percent too stiff there."""
        text = quadratic(self.chain.text("data/verification/cantilever/scene.toml"))
        deflection = {}
        for size in 1, 0.5, 0.125:
            data = datasets(self.chain.result(changed(text, "^size_m = .*", f"size_m = {size}")))
            deflection[size] = -data["/history/displacement"][-1, 0, 1]
        self.assertAlmostEqual(deflection[1] / deflection[0.125], 1, delta=0.005)
        self.assertAlmostEqual(deflection[0.5] / deflection[0.125], 1, delta=0.001)

    def test_both_engines_find_the_same(self):
        """A block on two joints that is uncovered: what slips and opens is the same."""
        text = quadratic(scene([[0, 0], [10, 0], [10, 10], [0, 10]],
                               [joint("flat", [-1, 4], [11, 5]), joint("steep", [4, -1], [6, 11])],
                               [held([0, 0], [10, 0]), held([0, 0], [0, 10], "x"), held([10, 0], [10, 10], "x")],
                               [material("joint", 500, friction=20)], stages=[[[[-1, 8], [11, 8], [11, 11], [-1, 11]]]],
                               points=[[5, 7]], stress=(-1, -0.5, 0.2), zone=2))
        joints = self.chain.joints(text)
        found = [datasets(self.chain.run("demsolve", joints, joints.with_name(engine), "--engine", engine, "--tolerance",
                                         "1e-8")) for engine in ("implicit", "relaxation")]
        for name in "/states/displacement", "/states/traction", "/states/stress":
            one, other = found[0][name], found[1][name]
            self.assertLess(np.abs(one - other).max(), 1e-4 * np.abs(one).max(), name)

    def test_it_goes_on_from_a_checkpoint_and_by_any_number_of_threads(self):
        joints = self.chain.joints(quadratic(changed(EVERYTHING, "^cohesion_MPa = 0.05\nfriction_angle_deg = 28",
                                                     "cohesion_MPa = 0.2\nfriction_angle_deg = 28")))
        kept = joints.with_name("kept.h5")
        whole = datasets(self.chain.run("demsolve", joints, joints.with_name("whole.h5"), "--checkpoint", kept))
        threads = datasets(self.chain.run("demsolve", joints, joints.with_name("threads.h5"), "--threads", 2))
        resumed = datasets(self.chain.run("demsolve", joints, joints.with_name("resumed.h5"), "--checkpoint", kept))
        for name in whole:
            if "/provenance" not in name:
                np.testing.assert_array_equal(whole[name], resumed[name], name)
                np.testing.assert_array_equal(whole[name], threads[name], name)
        self.assertTrue((whole["/equilibria/is_implicit"] == 1).any())

    def test_rock_yields_at_its_strength_by_the_implicit_engine(self):
        """A block squeezed between smooth plates: Mohr and Coulomb's strength and flow."""
        for confined, kind in (0, "quadratic"), (0.5, "quadratic"), (0.5, "constant strain"):
            strength = 3 * confined * 1e6 + SHEAR
            elastic = (strength - confined * 1e6) / PLANE
            text = SQUEEZED
            for word, value in (("CONFINED", confined), ("MOVED", -1000 * 4 * (elastic + 2e-3)), ("ENGINE", "implicit"),
                                ("HISTORY", "[[0, 0], [20, 1]]"), ("INCREMENTS", 10)):
                text = text.replace(word, str(value))
            data = datasets(self.chain.result(changed(text, r"^\[zones\]$", f'[zones]\nkind = "{kind}"')))
            self.assertEqual(data["/equilibria/is_implicit"].min(), 1)
            np.testing.assert_allclose(data["/states/stress"][-1], np.tile([-confined * 1e6, -strength, 0], (len(
                data["/mesh/zone_block"]), 1)), atol=1e-6 * SHEAR)
            np.testing.assert_allclose(data["/states/plastic_strain"][-1][:, 1], -2e-3, rtol=1e-6)

    def test_creep_of_two_pillars(self):
        """As with zones of constant strain: the cap is rigid, and only its joints move."""
        text = self.chain.text("data/verification/two-pillars/scene.toml")
        one, other = (datasets(self.chain.result(of))["/history/displacement"] for of in (text, quadratic(text)))
        self.assertLess(np.abs(one - other).max(), 1e-3 * np.abs(one).max())

    def test_large_displacements_refuse_them(self):
        text = quadratic(self.chain.text("data/collapse/sliding.toml"))
        path = self.chain.new_folder() / "scene.toml"
        path.write_text(text)
        done = self.chain.answer("jointgen", path, "--check")
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, r'scene.toml, line [0-9]+: \[zones\] kind = "quadratic": expected "constant strain" with '
                                      r'\[large_displacements\]')

    def test_exports_have_their_six_gridpoints(self):
        result = self.chain.result(quadratic(self.chain.text("data/verification/cantilever/scene.toml")))
        out = result.with_name("zones.vtu")
        self.chain.run("jointexport", result, out)
        zones = len(datasets(result)["/mesh/zone_block"])
        self.assertEqual(list(Grid(out).types), [22] * zones)


if __name__ == "__main__":
    main()
