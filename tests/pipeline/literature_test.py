"""Problems of the literature through the whole chain, against closed forms: pipelines/accuracy/literature.py.

Each figure is held to the error that is stated beside it, and the page docs/verification.md has the same table.
"""

import re
import sys

from chain import ChainTest, main

sys.path.append(sys.argv[2] + "/pipelines/accuracy")
import literature  # noqa: E402


class Literature(ChainTest):
    def setUp(self):
        self.programs = literature.Programs(self.chain.programs, self.chain.source / "data", self.chain.new_folder())
        self.page = self.chain.text("docs/verification.md")

    def hold(self, problem):
        for row in literature.rows_of(problem, self.programs):
            with self.subTest(problem=row.problem, engine=row.engine, what=row.what):
                self.assertLessEqual(row.error, row.allowed, f"{row.computed}, not {row.exact}")  # nan is not
                same = re.escape(f"| {row.engine} | {row.what} | {row.unit} | {literature.shown(row.exact)} | ")
                on_page = [float(error) for error in re.findall(rf"(?m)^\|.* {same}[^|]* \| ([^|]*) \|", self.page)]
                self.assertTrue(any(self.same_order(row.error, error) for error in on_page), (row.error, on_page))

    @staticmethod
    def same_order(one, other):
        """Of errors that are above those of balance to 1e-6."""
        one, other = max(one, 1e-6), max(other, 1e-6)
        return max(one, other) <= 10 * min(one, other)

    def test_hole_in_a_plate(self):
        self.hold(literature.kirsch)

    def test_cantilever(self):
        self.hold(literature.cantilever)
        found = literature.cantilevers_of_both_kinds(self.programs)
        self.assertIn(literature.cantilever_table(found), self.page)
        for coarse, fine in zip(found, found[1:]):  # too stiff, less and less
            if coarse.kind == fine.kind:
                self.assertLess(coarse.share, fine.share)

    def test_plane_of_weakness(self):
        self.hold(literature.weakness)

    def test_roof_wedge(self):
        self.hold(literature.roof_wedge)

    def test_toppling_columns(self):
        self.hold(literature.toppling)

    def test_columns_left_alone(self):
        """How far they stand is the program's own number: with another law of slip it would be another. What stands
        has to be able to, by statics."""
        text = literature.columns_alone(self.programs.text("toppling-columns"))
        for tan_phi, stands in (0.7716, True), (0.7704, False):
            _, code, message = self.programs.answer(text, "--strength-factor", 0.65 / tan_phi)
            with self.subTest(tan_phi=tan_phi):
                self.assertEqual(code, 0 if stands else 3, message)
        low, high = literature.least_friction_in_balance(text, 2e-4)
        self.assertLess(high, 0.7704)
        self.assertLess(low, 0.6605)
        self.assertGreater(high, 0.6605)
        self.assertIn(r"are stable for $\tan\varphi$ of 0.771 and more.", self.page)
        self.assertIn("stable for 0.6605 and more ", self.page)

    def test_slipping_crack(self):
        self.hold(literature.crack)

    def test_sheared_layers(self):
        self.hold(literature.sheared_layers)

    def test_friction(self):
        self.hold(literature.friction)

    def test_wave(self):
        self.hold(literature.wave)

    def test_free_fall(self):
        self.hold(literature.free_fall)


if __name__ == "__main__":
    main()
