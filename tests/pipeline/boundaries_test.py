"""Supports: a traction in the direction that a support leaves free, and rollers at any angle."""

import numpy as np

from chain import ChainTest, datasets, main
from small_scene import GRAVITY, held, joint, material, scene

MODULUS, POISSON, DENSITY = 10e9, 0.25, 2500  # [Pa], [-], [kg/m3]
SIDE = 10.0  # [m]
BOTH_ENGINES = [(kind, engine) for kind in ("quadratic", "constant strain") for engine in ("implicit", "relaxation")]
LOADED = {"load_history": [[0, 0], [1, 1]]}


class Turned:
    """Axes turned by an angle: x along the base, y up from it."""

    def __init__(self, degrees):
        c, s = np.round([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))], 15)
        self.axes = np.array([[c, -s], [s, c]])

    def __call__(self, x, y):
        return [float(one) for one in self.axes @ (x, y)]

    def back(self, vectors):
        return vectors @ self.axes

    def stress(self, stress):
        """{xx, yy, xy} in the turned axes."""
        xx, yy, xy = np.moveaxis(stress, -1, 0)
        turned = np.einsum("ki,...kl,lj->...ij", self.axes, np.stack([np.stack([xx, xy], -1), np.stack([xy, yy], -1)], -2), self.axes)
        return np.stack([turned[..., 0, 0], turned[..., 1, 1], turned[..., 0, 1]], axis=-1)


def square(at):
    return [at(0, 0), at(SIDE, 0), at(SIDE, SIDE), at(0, SIDE)]


class OfBoundaries(ChainTest):
    def solved(self, text, *options):
        path = self.chain.result(text, "--tolerance", "1e-12", *options)
        done = self.chain.answer("jointverify", path)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return datasets(path)

    def elastic(self, at, boundaries, kind, engine):
        return self.solved(scene(square(at), [], boundaries, [], gravity=0, kind=kind, zone=2.5, modulus=MODULUS / 1e9,
                                 poisson=POISSON, density=DENSITY), "--engine", engine)

    def assert_field(self, data, at, displacement, stress, rounding):
        """At the end: displacement(x, y) [m] of gridpoints and the uniform stress [Pa], in the turned axes."""
        place = at.back(data["/mesh/gridpoint_position"])
        wanted = np.stack(displacement(*place.T), axis=1)
        off = np.abs(at.back(data["/states/displacement"][-1]) - wanted).max() / np.abs(wanted).max()
        self.assertLess(off, rounding)
        off = np.abs(at.stress(data["/states/stress"][-1]) - stress).max() / np.abs(stress).max()
        self.assertLess(off, rounding)


class FixAndTraction(OfBoundaries):
    def test_column_between_rollers(self):
        """Pressed by p through a plate that does not move in x. Its sides do not move in x; they carry no traction in y.
        u_y = -p y / M,  M = E (1 - nu) / (1 + nu) / (1 - 2 nu),  stress_xx = -nu / (1 - nu) p"""
        p, at = 2e6, Turned(0)
        m = MODULUS * (1 - POISSON) / (1 + POISSON) / (1 - 2 * POISSON)
        boundaries = [held(at(0, 0), at(SIDE, 0), "y"), held(at(0, 0), at(0, SIDE), "x", traction_MPa=[0, 0]),
                      held(at(SIDE, 0), at(SIDE, SIDE), "x"),
                      held(at(0, SIDE), at(SIDE, SIDE), "x", traction_MPa=[0, -p / 1e6], **LOADED)]
        for kind, engine in BOTH_ENGINES:
            with self.subTest(kind=kind, engine=engine):
                data = self.elastic(at, boundaries, kind, engine)
                self.assert_field(data, at, lambda x, y: (0 * x, -p * y / m), [-POISSON / (1 - POISSON) * p, -p, 0], 1e-10)

    def test_shear_on_a_roller_face(self):
        """A block held on its left, sheared by a traction tau along its right face. No face moves across itself.
        u_y = tau x / G,  G = E / 2 / (1 + nu). In the turned axes by rollers."""
        tau, g = 0.5e6, MODULUS / 2 / (1 + POISSON)
        for degrees, x, y in ((0, "x", "x"), (0, "normal", "x"), (30, "normal", None), (-75, "normal", None)):
            at = Turned(degrees)
            # Of the top and the base, x is along them: where the axes are turned, nothing of this kind holds them.
            shear = [one * tau / 1e6 for one in at(1, 0)]
            ends = [held(at(0, 0), at(SIDE, 0), y), held(at(0, SIDE), at(SIDE, SIDE), y)] if y else [
                {"from_m": at(0, 0), "to_m": at(SIDE, 0), "traction_MPa": [-one for one in shear], **LOADED},
                {"from_m": at(0, SIDE), "to_m": at(SIDE, SIDE), "traction_MPa": shear, **LOADED}]
            right = held(at(SIDE, 0), at(SIDE, SIDE), x, traction_MPa=[one * tau / 1e6 for one in at(0, 1)], **LOADED)
            for kind, engine in BOTH_ENGINES:
                with self.subTest(degrees=degrees, kind=kind, engine=engine):
                    data = self.elastic(at, [held(at(0, 0), at(0, SIDE)), right, *ends], kind, engine)
                    self.assert_field(data, at, lambda x, y: (0 * x, tau * x / g), [0, 0, tau], 1e-10)


class Rollers(OfBoundaries):
    def test_patch(self):
        """A square on rollers on two sides, loaded on the others: uniform stress. In plane strain
        u_x = (s_x (1 - nu^2) - s_y nu (1 + nu)) x / E, and u_y the same with x and y exchanged."""
        s = np.array([-3e6, 1e6])
        strain = (s * (1 - POISSON**2) - s[::-1] * POISSON * (1 + POISSON)) / MODULUS
        for degrees in 30, 90, 141.3:
            at = Turned(degrees)
            boundaries = [held(at(0, 0), at(SIDE, 0), "normal"), held(at(0, SIDE), at(0, 0), "normal"),
                          {"from_m": at(SIDE, 0), "to_m": at(SIDE, SIDE), "traction_MPa": at(s[0] / 1e6, 0), **LOADED},
                          {"from_m": at(0, SIDE), "to_m": at(SIDE, SIDE), "traction_MPa": at(0, s[1] / 1e6), **LOADED}]
            for kind, engine in BOTH_ENGINES:
                with self.subTest(degrees=degrees, kind=kind, engine=engine):
                    data = self.elastic(at, boundaries, kind, engine)
                    self.assert_field(data, at, lambda x, y: (strain[0] * x, strain[1] * y), [*s, 0], 1e-10)
                    x, y = at.back(data["/mesh/gridpoint_position"]).T
                    reaction = at.back(data["/states/reaction"][-1])
                    rounding = 1e-9 * SIDE * np.abs(s).max()
                    self.assertLess(np.abs(reaction[x > 1][:, 0]).max(), rounding)
                    self.assertLess(np.abs(reaction[y > 1][:, 1]).max(), rounding)
                    self.assertTrue(np.allclose(reaction.sum(axis=0), -s * SIDE, rtol=1e-9))

    def test_damping(self):
        """Forces and velocities stay along the rollers with any damping. Kinetic damping stops at peaks: some steps later it would
        let vibrations of a few steps go on."""
        strain = np.array([-(1 - POISSON**2), POISSON * (1 + POISSON)]) * 1e6 / MODULUS
        for damping, degrees in ("local", 30), ("combined", 30), ("kinetic", 0), ("kinetic", 20), ("kinetic", 30):
            with self.subTest(damping=damping, degrees=degrees):
                at = Turned(degrees)
                boundaries = [held(at(0, 0), at(SIDE, 0), "normal"), held(at(0, SIDE), at(0, 0), "normal"),
                              {"from_m": at(SIDE, 0), "to_m": at(SIDE, SIDE), "traction_MPa": at(-1, 0), **LOADED}]
                data = self.solved(scene(square(at), [], boundaries, [], gravity=0, zone=2.5, modulus=MODULUS / 1e9,
                                         poisson=POISSON, density=DENSITY,
                                         more=f'[equilibrium]\nengine = "relaxation"\ndamping = "{damping}"\n' +
                                         "most_steps = 1000\n" * (damping == "kinetic")))
                self.assert_field(data, at, lambda x, y: (strain[0] * x, strain[1] * y), [-1e6, 0, 0], 1e-9)

    def test_block_on_an_inclined_base(self):
        """It rests on rollers under its base and at its lower end. With nu = 0, x up the base and the slope b:
        stress_xx = -rho g (L - x) sin b,  stress_yy = -rho g (H - y) cos b,  no shear. The upper part stands on steeper
        rollers. Once it is excavated, the gridpoint between them is free along the base of the lower part alone."""
        length, height, at, steep = 5.0, 3.0, Turned(30), Turned(50)
        corner, above = np.array(at(length, 0)), at(length, height)
        far, far_above = (list(map(float, corner + steep(length, y))) for y in (0, height))
        upper = [at(length, 0), far, far_above, above]
        boundaries = [held(at(0, 0), at(length, 0), "normal"), held(at(length, 0), far, "normal"),
                      held(at(0, 0), at(0, height), "normal")]
        alone = [at(0, 0), at(length, 0), above, at(0, height)]
        g = DENSITY * GRAVITY * np.sin(np.radians(30)), DENSITY * GRAVITY * np.cos(np.radians(30))
        joints = [joint("between", at(length, 0), above)]
        rough = [material("joint", 1e4, friction=60)]
        for outline, its_joints, stages in ((alone, [], []), ([*alone[:1], *upper, alone[3]], [], [[upper]]),
                                            ([*alone[:1], *upper, alone[3]], joints, [[upper]])):
            for engine in "implicit", "relaxation":
                with self.subTest(corners=len(outline), joints=len(its_joints), engine=engine):
                    held_by = boundaries if stages else [boundaries[0], boundaries[2]]
                    data = self.solved(scene(outline, its_joints, held_by, rough, stages=stages, kind="quadratic",
                                             density=DENSITY, zone=1.5), "--engine", engine)
                    there = data["/states/zone_present"][-1] == 1 if "/states/zone_present" in data else np.ones(
                        len(data["/mesh/zone_gridpoint"]), bool)
                    corners = at.back(data["/mesh/gridpoint_position"][data["/mesh/zone_gridpoint"]])
                    there &= corners[:, :, 0].max(axis=1) < length + 1e-6
                    x, y = corners[there].mean(axis=1).T
                    stress = at.stress(data["/states/stress"][-1][there])
                    wanted = np.stack([-g[0] * (length - x), -g[1] * (height - y), 0 * x], axis=1)
                    self.assertLess(np.abs(stress - wanted).max(), 1e-8 * g[1] * length)
                    reaction = at.back(data["/states/reaction"][-1]).sum(axis=0)
                    self.assertTrue(np.allclose(reaction, np.array(g) * length * height, rtol=1e-8), reaction)

    def test_nothing_stops_a_block(self):
        """On rollers under its base alone it slides down. It is named before any step."""
        at = Turned(30)
        text = scene(square(at), [], [held(at(0, 0), at(SIDE, 0), "normal")], [], zone=2.5)
        joints = self.chain.joints(text)
        for engine in "implicit", "relaxation":
            done = self.chain.answer("demsolve", joints, "-o", joints.with_name("result.h5"), "--engine", engine)
            self.assertEqual(done.returncode, 3, done.stderr)
            self.assertIn("block 0", done.stderr)


class SlopingGround(OfBoundaries):
    SLOPE, RATIO = np.tan(np.radians(10)), 0.6
    WIDTH, LOW = 120.0, 60.0  # [m]

    def first_equilibrium(self, stress):
        """Steps to the in-situ equilibrium, and what slip dissipates in it. Two sets of joints cross the section."""
        high = self.LOW + self.SLOPE * self.WIDTH
        corners = [[0, 0], [self.WIDTH, 0], [self.WIDTH, high], [0, self.LOW]]
        joints = [joint(f"{name} {n}", [x, -1], [x + 99 / np.tan(np.radians(angle)), 98])
                  for name, angle, distance in (("steep", 50, 8), ("cross", 100, 10))
                  for n, x in enumerate(np.arange(-99.0, 139, distance))]
        text = scene(corners, joints, [held(corners[1], corners[0]), held(corners[0], corners[3]), held(corners[1], corners[2])],
                     [material("joint", 5000, 1500, friction=34, cohesion=0.02)], zone=4.0, density=DENSITY, modulus=8, poisson=POISSON,
                     in_situ={"ground_m": [corners[3], corners[2]], **stress})
        data = datasets(self.chain.result(text))
        return data["/equilibria/steps"][0], data["/equilibria/dissipated_energy"][0]

    def test_stress_in_balance(self):
        """The stress of docs/section.md below ground that rises by SLOPE is in balance with the weight: no joint slips. By the ratio alone
        it is not."""
        gradients = {"compression_xx": self.RATIO, "compression_yy": 1 + self.RATIO * self.SLOPE**2, "shear_xy": -self.RATIO * self.SLOPE}
        weight = DENSITY * GRAVITY / 1e6  # [MPa/m]
        balanced = {**{f"{name}_MPa": 0 for name in gradients},
                    **{f"{name}_gradient_MPa_per_m": weight * one for name, one in gradients.items()}}
        self.assertEqual(self.first_equilibrium(balanced), (0, 0))
        steps, dissipated = self.first_equilibrium({"horizontal_stress_ratio": self.RATIO})
        self.assertGreater(steps, 0)
        self.assertGreater(dissipated, 0)


if __name__ == "__main__":
    main()
