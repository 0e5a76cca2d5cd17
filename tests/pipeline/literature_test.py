"""Problems of the literature through the whole chain, against closed forms: pipelines/accuracy/literature.py.

Each figure is held to the error that is stated beside it, and the page docs/accuracy.md has the same table.
"""

import sys

from chain import ChainTest, main

sys.path.append(sys.argv[2] + "/pipelines/accuracy")
import literature  # noqa: E402


class Literature(ChainTest):
    def setUp(self):
        self.programs = literature.Programs(self.chain.programs, self.chain.source / "data", self.chain.new_folder())
        self.page = self.chain.text("docs/accuracy.md")

    def hold(self, rows):
        for row in rows:
            with self.subTest(problem=row.problem, what=row.what):
                self.assertLessEqual(row.error, row.allowed, f"{row.computed}, not {row.exact}")  # nan is not
                self.assertIn(f" | {row.what} | {row.unit} | {literature.shown(row.exact)} | ", self.page)

    def test_hole_in_a_plate(self):
        self.hold(literature.kirsch(self.programs))

    def test_cantilever(self):
        found = literature.cantilevers(self.programs)
        self.hold(literature.cantilever_rows(found))
        self.assertIn(literature.cantilever_table(found), self.page)
        for coarse, fine in zip(found, found[1:]):  # too stiff, less and less
            self.assertLess(coarse.share, fine.share)

    def test_plane_of_weakness(self):
        self.hold(literature.weakness(self.programs))

    def test_roof_wedge(self):
        self.hold(literature.roof_wedge(self.programs))

    def test_toppling_columns(self):
        self.hold(literature.toppling(self.programs))

    def test_slipping_crack(self):
        self.hold(literature.crack(self.programs))

    def test_sheared_layers(self):
        self.hold(literature.sheared_layers(self.programs))

    def test_friction(self):
        self.hold(literature.friction(self.programs))

    def test_wave(self):
        self.hold(literature.wave(self.programs))

    def test_free_fall(self):
        self.hold(literature.free_fall(self.programs))


if __name__ == "__main__":
    main()
