"""What the implicit engine gives up goes to dynamic relaxation, and comes to a state that the scene has.

The scene is the random slope with joints so weak that blocks come to rest only after they have slid; there Newton's
method finds no way."""

from chain import ChainTest, changed, datasets, main


class Fallback(ChainTest):
    def setUp(self):
        text = self.chain.text("tests/pipeline/random_slope.toml")
        for pattern, replacement, count in ((r"^seed = \d+", "seed = 1", 1), ("^friction_angle_deg = (35|40)",
                                            "friction_angle_deg = 22", 2), ("^cohesion_MPa = .*",
                                            "cohesion_MPa = 0.02", 3)):
            text = changed(text, pattern, replacement, count)
        self.joints = self.chain.joints(text)

    def solve(self, *arguments):
        output = self.chain.new_folder() / "result.h5"
        return output, self.chain.answer("demsolve", self.joints, "-o", output, *arguments)

    def test_dynamic_relaxation_takes_over(self):
        output, done = self.solve()
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, "implicit engine did not converge +1 times: forces do not come into balance")
        data = datasets(output)
        implicit, searches = data["/equilibria/is_implicit"], data["/equilibria/searches"]
        self.assertEqual((implicit == 0).sum(), 1)
        self.assertGreater(len(implicit), 5)
        # Every equilibrium is one, whoever found it.
        self.assertLessEqual(data["/equilibria/unbalanced_force_ratio"].max(), 1e-6)
        self.assertLessEqual(data["/equilibria/contact_force_change"].max(), 1e-6)
        # It is the in-situ one, which there is nothing to take in smaller increments of.
        self.assertEqual((implicit[0], searches[0]), (0, 2))
        # Dynamic relaxation all the way slides about as far: what slips does not come to one state alone.
        output, done = self.solve("--engine", "relaxation")
        self.assertEqual(done.returncode, 0, done.stderr)
        found, wanted = (d["/history/displacement"][-1] for d in (data, datasets(output)))
        self.assertLess(abs(found - wanted).max(), 0.1 * abs(wanted).max())

    def test_the_implicit_engine_alone_says_so(self):
        output, done = self.solve("--engine", "implicit")
        self.assertEqual(done.returncode, 3)
        self.assertIn("--engine auto would continue by dynamic relaxation", done.stderr)
        self.assertFalse(output.exists())


if __name__ == "__main__":
    main()
