"""Lines of real joints and rock bridges, zoned, against what strength-averaging makes of them.

A cell of half a period stands between planes of symmetry (normal load) or antisymmetry (shear load). Each line is cut
as a bonded border, with a joint along a part of it, so that the rest is bridge: gridpoints are shared there, and rock
holds together. What the lines add to the displacement is sigma / K_eq.
"""

import math

import numpy

from chain import ChainTest, datasets, main

E, NU = 30e9, 0.2
PLANE = E / (1 - NU**2)
CONFINED, SHEAR = E * (1 - NU) / ((1 + NU) * (1 - 2 * NU)), E / (2 * (1 + NU))
HALF = 1.0  # b, half a period [m]

SCENE = """
[section]
outline_m = [[0, {low}], [1, {low}], [1, {high}], [0, {high}]]
rock = "rock"
gravity_m_per_s2 = 0

[[rock]]
name = "rock"
density_kg_per_m3 = 2700
youngs_modulus_GPa = 30
poissons_ratio = 0.2

[[joint_material]]
name = "joint"
normal_stiffness_MPa_per_m = {stiffness}
shear_stiffness_MPa_per_m = {stiffness}
cohesion_MPa = 1e4
friction_angle_deg = 30
tensile_strength_MPa = 1e4
{kelvin}
{regions}

[[boundary]]
from_m = [0, {low}]
to_m = [1, {low}]
fix = "{base}"

[[boundary]]
from_m = [0, {high}]
to_m = [1, {high}]
traction_MPa = {load}
load_history = [[0, 0], [1e-6, 1]]

[[boundary]]
from_m = [0, {low}]
to_m = [0, {high}]
fix = "{sides}"

[[boundary]]
from_m = [1, {low}]
to_m = [1, {high}]
fix = "{sides}"

[in_situ_stress]
elevation_m = 0
compression_xx_MPa = 0
compression_yy_MPa = 0
shear_xy_MPa = 0
compression_xx_gradient_MPa_per_m = 0
compression_yy_gradient_MPa_per_m = 0
shear_xy_gradient_MPa_per_m = 0

[schedule]
start = 0
end = 40
{creep}
[zones]
size_m = {size}

[cutting]
shortest_edge_m = 1e-5

[equilibrium]
tolerance = 1e-9
"""


KELVIN = """
normal_kelvin_stiffness_MPa_per_m = 10000
normal_kelvin_viscosity_MPa_day_per_m = 100000
shear_kelvin_stiffness_MPa_per_m = 10000
shear_kelvin_viscosity_MPa_day_per_m = 100000
"""


def mean_displacement(result, height, component, state=-1):
    """Mean along a level of gridpoints, at the end or in another state."""
    place = result["/mesh/gridpoint_position"]
    row = numpy.flatnonzero(abs(place[:, 1] - height) < 1e-9)
    row = row[numpy.argsort(place[row, 0])]
    moved = result["/states/displacement"][state][row, component]
    return ((moved[1:] + moved[:-1]) / 2 * numpy.diff(place[row, 0])).sum() / HALF


def line_alone(persistence):
    """K_0 of empty traces."""
    return math.pi * PLANE / (8 * HALF * math.log(1 / math.cos(math.pi * persistence / 2)))


def creeping(bridges, share, joint, time):
    """Displacement over traction of a spring beside `share` times a joint with the unit of KELVIN [m/Pa]."""
    kelvin, viscosity = 1e10, 1e11
    first, last = bridges + share * joint, bridges + share * joint * kelvin / (joint + kelvin)
    rate = (bridges * (joint + kelvin) + share * joint * kelvin) / (viscosity * first)
    return 1 / first + (1 / last - 1 / first) * (1 - math.exp(-rate * time))


class Bridges(ChainTest):
    def stiffness(self, persistence, joint, shear, size, spacing=None):
        """K_eq [Pa/m] of one line, or of the middle two of six staggered ones with that spacing [m]."""
        return 1 / self.compliances(persistence, joint, shear, size, spacing)[1][-1]

    def compliances(self, persistence, joint, shear, size, spacing=None, creeps=False):
        """Times [day] and 1 / K_eq in the states of a run [m/Pa]."""
        ends = 2.0 if spacing is None else 3 * spacing + 1
        heights = [0.0] if spacing is None else [(i - 2.5) * spacing for i in range(6)]
        levels = [-spacing, spacing] if spacing else [-ends, ends]
        borders = sorted({-ends, *heights, *levels, ends})
        regions = "".join(
            f'[[region]]\nrock = "rock"\noutline_m = [[0, {low!r}], [1, {low!r}], [1, {high!r}], [0, {high!r}]]\n\n'
            for low, high in zip(borders, borders[1:]))
        for i, y in enumerate(heights):
            start, end = (0, persistence) if i % 2 == 0 else (1 - persistence, 1)
            regions += (f'[[joint]]\nname = "{i}"\nmaterial = "joint"\nfrom_m = [{start!r}, {y!r}]\n'
                        f'to_m = [{end!r}, {y!r}]\n\n')
        text = SCENE.format(low=-ends, high=ends, stiffness=joint / 1e6, regions=regions, size=size,
                            base="xy" if shear else "y", sides="y" if shear else "x",
                            load=[1, 0] if shear else [0, 1], kelvin=KELVIN if creeps else "",
                            creep="\n[creep]\nstep_days = 1\n" if creeps else "")
        result = datasets(self.chain.result(text, "--states", 10))
        vertex = result["/vertices/position"][result["/edges/vertex"]]
        on_joints = numpy.linalg.norm(vertex[:, 1] - vertex[:, 0], axis=1)[result["/edges/kind"] == 1].sum()
        self.assertAlmostEqual(on_joints, len(heights) * persistence, delta=1e-4)
        component = 0 if shear else 1
        rock = (levels[1] - levels[0]) / (SHEAR if shear else CONFINED)
        moved = [mean_displacement(result, levels[1], component, state) - mean_displacement(
            result, levels[0], component, state) for state in range(len(result["/states/time"]))]
        return result["/states/time"], (numpy.array(moved) / 1e6 - rock) / (1 if spacing is None else 2)

    def test_a_line_is_between_the_bounds(self):
        """Within them but for the zones, which are too stiff by the order of their size: halving halves that."""
        for persistence, joint in ((0.5, 1e6), (0.5, 2e10), (0.8, 5e9)):
            for shear in (False, True):
                with self.subTest(persistence=persistence, joint=joint, shear=shear):
                    lower, upper = (line_alone(persistence) + share * joint / persistence for share in (1, 1.081))
                    coarse, fine = (self.stiffness(persistence, joint, shear, size) for size in (0.05, 0.025))
                    extrapolated = 2 * fine - coarse
                    print(f"k {persistence}, K_j {joint:.0e}, shear {shear}: {coarse / lower:.4f}, {fine / lower:.4f}, "
                          f"{extrapolated / lower:.4f} of the lower bound; the upper is {upper / lower:.4f} of it")
                    self.assertGreater(coarse, fine)
                    self.assertGreater(extrapolated, 0.99 * lower)  # 0.996 seen
                    self.assertLess(extrapolated, 1.005 * upper)  # 1.0001 seen

    def test_a_line_creeps_between_the_bounds(self):
        """A joint with K/E = 2 in its traces; while it creeps, the bridges take over."""
        persistence, joint = 0.5, 2e10
        for shear in (False, True):
            with self.subTest(shear=shear):
                times, coarse = self.compliances(persistence, joint, shear, 0.05, creeps=True)
                _, fine = self.compliances(persistence, joint, shear, 0.025, creeps=True)
                extrapolated = 2 * fine - coarse
                rows = numpy.flatnonzero(times > 1e-3)
                for row in rows:
                    upper, lower = (creeping(line_alone(persistence), share / persistence, joint, times[row])
                                    for share in (1, 1.081))
                    print(f"day {times[row]:.0f}, shear {shear}: {extrapolated[row] / upper:.4f} of the upper bound; "
                          f"the lower is {lower / upper:.4f} of it")
                    self.assertLess(extrapolated[row], 1.01 * upper)
                    self.assertGreater(extrapolated[row], 0.99 * lower)
                self.assertGreater(len(rows), 3)
                self.assertGreater(extrapolated[-1], 1.5 * extrapolated[rows[0] - 1], "it crept")

    def test_staggered_lines(self):
        """Against the values that tests/joint/bridged_test.cpp has by dislocations, in K_eq 2 b / E'."""
        unit = PLANE / (2 * HALF)
        for persistence, spacing, joint, shear, wanted in (
                (0.5, 0.5, 0.5, False, 2.80816), (0.5, 0.5, 0.5, True, 3.60417), (0.75, 0.25, 0.5, False, 1.00265)):
            with self.subTest(persistence=persistence, spacing=spacing, shear=shear):
                coarse, fine = (self.stiffness(persistence, joint * unit, shear, size, 2 * HALF * spacing) / unit
                                for size in (0.1, 0.05))
                print(f"k {persistence}, S/2b {spacing}, shear {shear}: {coarse / wanted:.4f}, {fine / wanted:.4f}, "
                      f"{(2 * fine - coarse) / wanted:.4f} of the estimate")
                self.assertGreater(coarse, fine)
                self.assertAlmostEqual((2 * fine - coarse) / wanted, 1, delta=0.01)  # 0.0053 seen


if __name__ == "__main__":
    main()
