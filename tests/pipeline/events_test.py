"""What happens at dates: loads after an early end of creep, removed points, stages that part rock, creep steps."""

import numpy as np
from chain import ChainTest, changed, datasets, main
from small_scene import held, scene

COLUMN = "data/column/scene.toml"
FAST = ('^masses = "real"\ndamping = "mass"\nmass_damping_per_s = 140 .*', 'damping = "adaptive"')

# A wedge on a joint that dips 55 degrees out of a face, weaker than it is steep. {end} is where the joint ends.
WEDGE = """
[section]
outline_m = [[0, 0], [40, 0], [40, 24], [0, 24]]
rock = "rock"
gravity_m_per_s2 = 9.81
[[rock]]
name = "rock"
density_kg_per_m3 = 2700
youngs_modulus_GPa = 20
poissons_ratio = 0.25
[[joint_material]]
name = "clay"
normal_stiffness_MPa_per_m = 5000
shear_stiffness_MPa_per_m = 2000
cohesion_MPa = 0
friction_angle_deg = 35
tensile_strength_MPa = 0
[[joint]]
name = "steep"
from_m = [14, 24]
to_m = {end}
material = "clay"
[in_situ_stress]
elevation_m = 24
compression_xx_MPa = 0.3
compression_yy_MPa = 0
shear_xy_MPa = 0
compression_xx_gradient_MPa_per_m = 0.026487
compression_yy_gradient_MPa_per_m = 0.026487
shear_xy_gradient_MPa_per_m = 0
[[boundary]]
from_m = [0, 0]
to_m = [40, 0]
fix = "xy"
[[boundary]]
from_m = [0, 0]
to_m = [0, 24]
fix = "x"
[[boundary]]
from_m = [40, 0]
to_m = [40, 24]
fix = "x"
[schedule]
end = 2
[[stage]]
name = "cut"
date = 1
remove_m = [[[21, 10], [41, 10], [41, 25], [21, 25]]]
[zones]
size_m = 2
"""


class Events(ChainTest):
    def column(self, *changes):
        text = changed(self.chain.text(COLUMN), *FAST)
        for pattern, replacement in changes:
            text = changed(text, pattern, replacement)
        return text

    def refusal(self, text, *arguments):
        """Exit code and message of demsolve on a scene that jointgen accepts."""
        joints = self.chain.joints(text)
        done = self.chain.answer("demsolve", joints, "-o", joints.with_name("result.h5"), *arguments)
        self.assertFalse(joints.with_name("result.h5").exists())
        return done.returncode, done.stderr

    def test_a_wedge_slides_wherever_in_the_rock_that_goes_its_joint_ends(self):
        """The joint ends on the face (at its tip only the rock that goes holds the wedge), a little beyond, and far."""
        for end in "[21, 14]", "[21.4, 13.43]", "[22.5, 11.857]":
            code, message = self.refusal(WEDGE.format(end=end))
            self.assertEqual(code, 3, end)
            self.assertIn("no equilibrium", message)

    def test_a_wedge_on_a_strong_joint_stays_wherever_its_joint_ends(self):
        ends = "[21, 14]", "[22.5, 11.857]"
        moves = []
        for end in ends:
            text = changed(WEDGE.format(end=end), "^friction_angle_deg = 35", "friction_angle_deg = 80")
            text = changed(text, "^cohesion_MPa = 0", "cohesion_MPa = 1")
            text += '[[point]]\nname = "wedge"\nat_m = [20, 22]\n'
            moves.append(datasets(self.chain.result(text))["/history/displacement"][-1, 0])
        self.assertLess(abs(moves[0] - moves[1]).max(), 0.02 * abs(moves[0]).max())

    def test_creep_does_not_end_before_the_last_load(self):
        text = self.column((r"^joint = \"base joint\"", 'joint = "base joint"\n\n[[boundary]]\nfrom_m = [0, 40]\n'
                            "to_m = [10, 40]\ntraction_MPa = [0, -1]\nload_history = [[30, 0], [32, 1]]"),
                           (r'^scheme = "published"', 'scheme = "published"\nstop_rate_mm_per_day = 100'))
        text = text[: text.index("[[stage]]")] + text[text.index("[[point]]"):]
        history = datasets(self.chain.result(text))
        self.assertGreaterEqual(history["/history/time"][-1], 32)
        self.assertLess(history["/history/displacement"][-1, 0, 1], -1e-3)

    def test_a_point_in_rock_that_goes_goes_with_it(self):
        """0.05 m above a joint, inside the block that is removed on day 20."""
        text = self.column((r"^at_m = \[5, 15\]", "at_m = [5, 10.02]"))
        values = datasets(self.chain.result(text, "--step-history", "2000"))
        self.assertEqual(values["/history/present"][-1].tolist(), [0, 0, 1])
        # Both in the histories and in the step history it keeps its last displacement.
        last = values["/history/displacement"][-1, 1]
        self.assertGreater(last[1], 1e-3)
        self.assertEqual(values["/step_history/displacement"][-1, 1].tolist(), last.tolist())

    def test_displacements_count_anew_from_a_stage_that_resets_them(self):
        text = self.column((r'^name = "block 2 removed"', 'name = "block 2 removed"\ndisplacements = "reset"'))
        plain, path = self.chain.result(self.column()), self.chain.result(text)
        values, without = datasets(path), datasets(plain)
        row = values["/history/event"].tolist().index("block 2 removed")
        state = values["/states/event"].tolist().index("block 2 removed")
        reset_row, reset_state = values.pop("/history/reset_row"), values.pop("/states/reset_state")
        self.assertEqual(reset_row.tolist(), [0] * row + [row] * (len(reset_row) - row))
        self.assertEqual(reset_state.tolist(), [0] * state + [state] * (len(reset_state) - state))
        # Nothing else changes, but the lines that warnings name.
        for name in values.keys() - {"/scene", "/provenance/input_sha256", "/warnings/text"}:
            self.assertEqual(values[name].tolist(), without[name].tolist(), name)

    def test_an_excavated_boundary_holds_nothing(self):
        """The upper right quarter goes, without stress. Its side is fixed or not: what is left deforms alike."""
        pushed = {"from_m": [0, 10], "to_m": [0, 5], "traction_MPa": [1, 0], "load_history": [[2, 0], [3, 1]]}
        side = [held([10, 5], [10, 10], "x")]
        for kind in "constant strain", "quadratic":
            with_side, without = (datasets(self.chain.result(scene(
                [[0, 0], [10, 0], [10, 10], [0, 10]], [], [held([0, 0], [10, 0]), pushed, *more], [], gravity=0,
                stages=[[[[5, 5], [10, 5], [10, 10], [5, 10]]]], points=[[9.9, 4.9], [1, 9]], end=3,
                kind=kind))) for more in (side, []))
            moved = without["/history/displacement"][-1]
            self.assertGreater(abs(moved).min(), 1e-5)
            np.testing.assert_allclose(with_side["/history/displacement"][-1], moved, atol=1e-9)
            self.assertEqual(abs(with_side["/states/reaction"][-1][with_side["/mesh/gridpoint_position"][:, 1] > 0]).max(), 0)

    def test_too_many_creep_steps_are_refused(self):
        code, message = self.refusal(self.column(), "--creep-step", "1e-12")
        self.assertEqual(code, 2)
        self.assertIn("expected at most 1e+06", message)

    def test_a_stage_that_removes_nothing_is_refused(self):
        text = self.column((r"^remove_m = \[\[\[0, 10\].*", "remove_m = [[[20, 0], [30, 0], [30, 10]]]"))
        scene = self.chain.new_folder() / "scene.toml"
        scene.write_text(text)
        done = self.chain.answer("jointgen", scene, "-o", scene.with_name("network.h5"))
        self.assertEqual(done.returncode, 2)
        self.assertIn('"block 3 removed" removes nothing', done.stderr)


if __name__ == "__main__":
    main()
