"""Supports, and a traction in the direction that a support leaves free."""

import numpy as np

from chain import ChainTest, datasets, main
from small_scene import held, scene

MODULUS, POISSON = 10e9, 0.25  # [Pa], [-]
SIDE = 10.0  # [m]
BOTH_ENGINES = [(kind, engine) for kind in ("quadratic", "constant strain") for engine in ("implicit", "relaxation")]
SQUARE = [[0, 0], [SIDE, 0], [SIDE, SIDE], [0, SIDE]]
LOADED = {"load_history": [[0, 0], [1, 1]]}


class FixAndTraction(ChainTest):
    def assert_field(self, boundaries, displacement, stress):
        """At the end displacement(x, y) [m] and the uniform stress [Pa], by both engines and in both kinds of zones."""
        for kind, engine in BOTH_ENGINES:
            with self.subTest(kind=kind, engine=engine):
                text = scene(SQUARE, [], boundaries, [], gravity=0, kind=kind, zone=2.5, modulus=MODULUS / 1e9, poisson=POISSON)
                path = self.chain.result(text, "--tolerance", "1e-12", "--engine", engine)
                data = datasets(path)
                wanted = np.stack(displacement(*data["/mesh/gridpoint_position"].T), axis=1)
                self.assertLess(np.abs(data["/states/displacement"][-1] - wanted).max() / np.abs(wanted).max(), 1e-10)
                self.assertLess(np.abs(data["/states/stress"][-1] - stress).max() / np.abs(stress).max(), 1e-10)
                done = self.chain.answer("jointverify", path)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_column_between_rollers(self):
        """Pressed by p through a plate that does not move in x. Its sides do not move in x; they carry no traction in y.
        u_y = -p y / M,  M = E (1 - nu) / (1 + nu) / (1 - 2 nu),  stress_xx = -nu / (1 - nu) p"""
        p, m = 2e6, MODULUS * (1 - POISSON) / (1 + POISSON) / (1 - 2 * POISSON)
        boundaries = [held([0, 0], [SIDE, 0], "y"), held([0, 0], [0, SIDE], "x", traction_MPa=[0, 0]),
                      held([SIDE, 0], [SIDE, SIDE], "x"),
                      held([0, SIDE], [SIDE, SIDE], "x", traction_MPa=[0, -p / 1e6], **LOADED)]
        self.assert_field(boundaries, lambda x, y: (0 * x, -p * y / m), [-POISSON / (1 - POISSON) * p, -p, 0])

    def test_shear_on_a_roller_face(self):
        """A block fixed on its left, sheared by a traction tau along its right face. Its other faces do not move in x.
        u_y = tau x / G,  G = E / 2 / (1 + nu)"""
        tau, g = 0.5e6, MODULUS / 2 / (1 + POISSON)
        boundaries = [held([0, 0], [0, SIDE]), held([SIDE, 0], [SIDE, SIDE], "x", traction_MPa=[0, tau / 1e6], **LOADED),
                      held([0, 0], [SIDE, 0], "x"), held([0, SIDE], [SIDE, SIDE], "x")]
        self.assert_field(boundaries, lambda x, y: (0 * x, tau * x / g), [0, 0, tau])


if __name__ == "__main__":
    main()
