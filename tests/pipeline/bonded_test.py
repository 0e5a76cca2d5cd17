"""The outline of a stage through solid rock is not a joint: until its day it changes nothing.

Only the mesh differs. Where the stress is uniform or linear zones are exact for displacements, up to the balance;
where the rock bends, the answers must come together as zones get smaller.
"""

import numpy

from chain import ChainTest, datasets, main

LAST = "last"  # the added stage
WELDED = 2  # kind of edge


def before(result, day):
    """Displacements of all points at the recorded times before the day."""
    return result["/history/displacement"][result["/history/time"] < day]


class Bonded(ChainTest):
    def with_stage(self, text, end, corners):
        """The scene with a stage on its last day that takes away the polygon."""
        stage = f'[[stage]]\nname = "{LAST}"\ndate = {end}\nremove_m = [{corners}]\n\n'
        first_point = text.index("[[point]]")
        return text[:first_point] + stage + text[first_point:]

    def assert_cut(self, result, length):
        """The stage's outline is there, as bonded edges of this length, and takes something away in the end."""
        vertex = result["/vertices/position"][result["/edges/vertex"]]
        lengths = numpy.linalg.norm(vertex[:, 1] - vertex[:, 0], axis=1)
        self.assertAlmostEqual(lengths[result["/edges/kind"] == WELDED].sum(), length, delta=0.01)
        self.assertIn(LAST, list(result["/history/event"]))

    def difference(self, one, other, day):
        """The largest difference of any point before the day, as a fraction of the largest displacement."""
        moves = before(one, day)
        return numpy.abs(before(other, day) - moves).max() / numpy.abs(moves).max()

    def test_column(self):
        text = self.chain.text("data/column/scene.toml")
        plain = datasets(self.chain.result(text, "--tolerance", "1e-8"))
        cuts = {
            "one block": ("[[0, 3], [10, 7], [10, 10], [0, 10]]", 10.770),
            "across the joints": ("[[4.5, 0], [10, 0], [10, 40], [7.5, 40]]", 40.112),
        }
        for name, (corners, length) in cuts.items():
            with self.subTest(name):
                cut = datasets(self.chain.result(self.with_stage(text, 40, corners), "--tolerance", "1e-8"))
                self.assert_cut(cut, length)
                difference = self.difference(plain, cut, 40)
                print(f"column, {name}: {difference:.1e}")
                self.assertLess(difference, 1e-5)  # 4e-7 seen

    def test_bending(self):
        text = self.chain.text("tests/pipeline/bonded.toml")
        cut_text = self.with_stage(text, 10, "[[36, 25], [60, 25], [60, 14], [41, 14]]")
        differences = {}
        for size in 4, 2, 1:
            plain = datasets(self.chain.result(text, "--zone-size", size))
            cut = datasets(self.chain.result(cut_text, "--zone-size", size))
            self.assert_cut(cut, 16.155 + 24 + 12.083 + 19)  # of both benches
            differences[size] = self.difference(plain, cut, 10)
            print(f"bending, zones of {size} m: {differences[size]:.1e}")
        # Seen: 2.5e-3, 3.5e-4, 5.0e-4, and 5e-5 at 0.5 m.
        self.assertLess(max(differences.values()), 5e-3)
        self.assertLess(max(differences[2], differences[1]), differences[4] / 2)

    def test_a_joint_would_show(self):
        """What is compared would differ if the outline were a joint."""
        text = self.chain.text("tests/pipeline/bonded.toml")
        joint = '[[joint]]\nname = "wrong"\nmaterial = "joint"\nfrom_m = [36, 25]\nto_m = [42, 0]\n\n'
        plain = datasets(self.chain.result(text))
        cut = datasets(self.chain.result(text.replace("[in_situ_stress]", joint + "[in_situ_stress]")))
        self.assertGreater(self.difference(plain, cut, 10), 0.02)


if __name__ == "__main__":
    main()
