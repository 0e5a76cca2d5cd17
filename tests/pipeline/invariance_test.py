"""The same section turned, mirrored, written in another order, in other units: the same answer. And what a dynamic analysis keeps:
momentum and energy, where nothing acts from outside. (Threads: same_bytes_test.py and large_displacements_test.py.)"""

import math
import random
import re

import numpy as np

from chain import ChainTest, changed, datasets, main
from hard_cases_test import error_of_forces, line, moved, patch
from large_displacements_test import RIGID, missing_energy
from small_scene import OPEN, SLIPPING, held, joint, material, scene, solved

IDENTITY = np.eye(2)
MIRROR = np.diag([-1.0, 1.0])
OUTLINE = [[0.0, 0.0], [21.0, -1.0], [19.0, 11.0], [2.0, 9.0]]
JOINTS = [([-3, 3.1], [23, 5.2]), ([6, -2], [9.3, 12]), ([23, 6.4], [-3, 7.5]), ([13.4, -2], [14.1, 13])]
GONE = [[[14.9, 4.3], [22, 6], [19, 12], [15.4, 11.5]], [[-3, 6.2], [-3, 8], [4.2, 8], [3.7, 6.1]]]
LOAD = np.array([0.15, -0.5])  # [MPa]
POINTS = [[4.1, 6.7], [11.2, 8.3], [17.1, 3.2], [8.6, 2.1]]


def turned(degrees):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return np.array([[c, -s], [s, c]])


def plate(length=1.0, stress=1.0, bonded=False, order=None):
    """A weightless plate, held at its lower side and loaded at its upper one. All places times `length`, stiffnesses,
    strengths and loads times `stress`. Joints slip and open; or they are bonded, there is a stress in situ that
    the sides do not bear, and two parts go. With an order (a random.Random) every list of the scene is shuffled."""

    def at(places):
        return [list(np.array(place, float) * length) for place in places]

    strength = {"cohesion": 100 * stress, "tension": 100 * stress} if bonded else {}
    materials = [material(name, k * stress / length, k * stress / length / 2, 30, **strength)
                 for name, k in (("stiff", 4000), ("soft", 1000))]
    joints = [joint(f"joint {i}", *at(ends), of=("stiff", "soft")[i % 2]) for i, ends in enumerate(JOINTS)]
    low, high = at(OUTLINE[:2]), at(OUTLINE[2:])
    load = LOAD * stress
    boundaries = [held(*low), {"from_m": high[0], "to_m": high[1], "traction_MPa": list(load), "load_history": [[0, 0], [1, 1]]}]
    in_situ = np.array([-0.6, -0.4, 0.1]) * (stress if bonded else 0)
    gone, named = [at(polygon) for polygon in GONE], [at([place])[0] for place in POINTS]
    if order:
        for of in materials, joints, boundaries, gone:
            order.shuffle(of)
    return scene(at(OUTLINE), joints, boundaries, materials, gravity=0, stages=[gone] if bonded else [], points=named,
                 zone=1.7 * length, modulus=10 * stress, poisson=0.2, stress=in_situ, end=2)


class Turned(ChainTest):
    """A stress that is uniform is so in any mesh, so that only the solver can make a difference: other meshes come of turned
    places. What joints do is turned with them; each turn is held to the closed form of hard_cases_test.py, too."""

    LINES = [line((1, 0.5), angle) for angle in (100, 122, 144, 166)]

    def test_uniform_stress(self):
        for name, turn in (("37", turned(37)), ("90", turned(90)), ("200", turned(200)), ("mirror", MIRROR),
                           ("mirror and 63", turned(63) @ MIRROR)):
            for engine in "implicit", "relaxation", "dynamic":
                with self.subTest(turn=name, engine=engine):
                    self.check(turn, engine)

    def check(self, turn, engine):
        is_dynamic = engine == "dynamic"
        text = patch(self.LINES, 1000, 500, nub=is_dynamic, turn=turn, more=(
            '[large_displacements]\nnew_contacts = "joint"\nmass_damping_per_s = 100\n' if is_dynamic else ""))
        data = solved(self.chain, text, *([] if is_dynamic else ["--engine", engine, "--tolerance", "1e-8"]))
        # As in UniformStress there: balance times gridpoints in a row; strains of 1e-5 and openings of 1e-4 m in a dynamic analysis.
        self.assertLess(error_of_forces(data, -1, turn), 1e-3 if is_dynamic else 1e-6)
        if not is_dynamic:
            wanted = np.array([moved(place, self.LINES, 1000, 500, turn) for place in data["/history/point_position"]])
            self.assertLess(np.abs(data["/history/displacement"][-1] - wanted).max() / np.abs(wanted).max(), 1e-4)


class Plate(ChainTest):
    """A section without symmetry. Balanced to 1e-9, forces in a row of some hundred gridpoints leave 1e-6 of the
    displacements: by the implicit engine where joints slip, by dynamic relaxation where none does, as slip is path dependent."""

    def found(self, text, engine):
        return solved(self.chain, text, "--engine", engine, "--tolerance", "1e-9")

    def assert_same(self, one, other, length=1.0):
        """Displacements of points, the second's over the length."""
        self.assertEqual(len(one["/mesh/zone_block"]), len(other["/mesh/zone_block"]))
        wanted, found = one["/history/displacement"], other["/history/displacement"] / length
        self.assertGreater(np.abs(wanted).max(), 1e-5)
        self.assertLess(np.abs(found - wanted).max() / np.abs(wanted).max(), 1e-6)

    def test_the_plate_slips_and_opens(self):
        """Only then do the others say anything."""
        status = self.found(plate(), "implicit")["/states/contact_status"][-1]
        self.assertGreater((status == SLIPPING).sum(), 3)
        self.assertGreater((status == OPEN).sum(), 3)

    def test_other_units(self):
        """Times powers of two no digit changes: what does is a length, a stress or a force that the programs take for small
        or large. Displacements and tractions are the same to the last bit but for what is converted in decimal units."""
        for engine, bonded in ("implicit", False), ("relaxation", True):
            one = self.found(plate(bonded=bonded), engine)
            for length, stress in (2**-10, 1), (2**10, 1), (1, 2**-10), (1, 2**6), (2**-7, 2**-7), (2**7, 2**3):
                with self.subTest(engine=engine, length=length, stress=stress):
                    other = self.found(plate(length=length, stress=stress, bonded=bonded), engine)
                    self.assert_same(one, other, length)
                    np.testing.assert_array_equal(one["/states/contact_status"], other["/states/contact_status"])
                    np.testing.assert_array_equal(one["/equilibria/steps"], other["/equilibria/steps"])

    def test_order_in_the_scene(self):
        """The same blocks to the bit, whatever the order; the same answer but for rounding."""
        for engine in "implicit", "relaxation":
            one = self.found(plate(bonded=engine == "relaxation"), engine)
            for seed in 1, 2, 3:
                with self.subTest(engine=engine, seed=seed):
                    other = self.found(plate(bonded=engine == "relaxation", order=random.Random(seed)), engine)
                    for name in "/vertices/position", "/blocks/area", "/rings/vertex", "/mesh/gridpoint_position":
                        np.testing.assert_array_equal(one[name], other[name], name)
                    self.assert_same(one, other)

    def test_order_of_joint_sets(self):
        """Random numbers are those of a set's name: other sets before it change nothing."""
        text = self.chain.text("tests/pipeline/random_slope.toml")
        head, *sets = text.split("[[joint_set]]")
        sets[-1], tail = sets[-1].split("\n[", 1)
        self.assertGreater(len(sets), 1)
        swapped = head + "".join(f"[[joint_set]]{one.rstrip()}\n\n" for one in reversed(sets)) + "[" + tail
        one, other = (datasets(self.chain.network(scene_text)) for scene_text in (text, swapped))
        for name in "/vertices/position", "/blocks/area", "/rings/vertex":
            np.testing.assert_array_equal(one[name], other[name], name)

    def test_what_work_the_loads_do_is_accounted_for(self):
        for engine in "implicit", "relaxation":
            data = self.found(plate(), engine)
            parts = sum(data[f"/equilibria/{part}_energy"] for part in ("stored", "dissipated", "damped"))
            work = data["/equilibria/work_of_loads"]
            turned_over = np.abs(work) + np.abs(data["/equilibria/stored_energy"])
            self.assertGreater(data["/equilibria/dissipated_energy"].sum(), 0)
            # The energy balance of dynamic relaxation is by the trapezoidal rule, step by step: what is left is the last movement.
            self.assertLess(np.abs(work - parts).max() / turned_over.max(), 1e-6)


def notched(mirrored, moved=0, more=""):
    """A section of 10 m by 5 m on whose lower side the left half is held, and the right end; a notch down to where the held
    half ends parts the two. Or the half is moved, on the day before."""

    def at(*places):
        return [[10 - x if mirrored else x, y] for x, y in places]

    outline = at([0, 0], [10, 0], [10, 5], [0, 5])
    load_history = {"displacement_mm": [0, moved], "load_history": [[0, 0], [0.5, 1]]} if moved else {}
    return scene(outline[::-1] if mirrored else outline, [], [held(*at([0, 0], [5, 0]), **load_history), held(*at([10, 0], [10, 5]))],
                 [material("joint", 1000)], points=at([5.2, 0.3], [4.8, 0.3], [5.4, 1.5]),
                 more=more, stages=[[at([5, 0], [4.5, 5.5], [5.5, 5.5])], [at([0, 4], [1, 4], [1, 5], [0, 5])]])


class Notch(ChainTest):
    """What is parted from rock that is held is held no longer, whichever of the two the scene has first."""

    RESTS = '[large_displacements]\nnew_contacts = "joint"\nmass_damping_per_s = 300\n'

    def both(self, **given):
        engine = ["--tolerance", "1e-8"] + (["--engine", given.pop("engine")] if "engine" in given else [])
        one, other = (solved(self.chain, notched(mirrored, **given), *engine) for mirrored in (False, True))
        self.assertGreater(len(one["/mesh/tie_stage"]), 0)
        return one["/history/displacement"], other["/history/displacement"] * [-1, 1]

    def test_parts_alike(self):
        for name, given in (("implicit", {"engine": "implicit"}), ("relaxation", {"engine": "relaxation"}),
                            ("dynamic", {"more": self.RESTS})):
            with self.subTest(engine=name):
                one, other = self.both(**given)
                self.assertLess(one[-1, 0, 1], -9e-5)  # the tip, 5 m from where it is clamped, goes down
                # Meshes are not each other's mirror images, and zones are a fifth of the height.
                self.assertLess(np.abs(one - other).max() / np.abs(one).max(), 0.05)

    def test_moves_alike(self):
        one, other = self.both(engine="implicit", moved=2)
        self.assertLess(np.abs(one - other).max() / np.abs(one).max(), 0.05)


def pushed(turn=IDENTITY, length=1.0, rigid=True, more=""):
    """Weightless: a block on a plate, pressed on it and pushed along it, stopped by another block that a stage takes; it
    slides on to a wall. In other units stresses go with lengths, and times with roots of lengths."""

    def at(*places):
        return [list(turn @ np.array(place, float) * length) for place in places]

    # Blocks are a little askew, so that no side is as long as another.
    outline = [[0, 0], [14, 0], [14, 3.5], [12.6, 3.5], [12.6, 2], [6, 2], [6, 3.3], [4, 3.3], [4, 4], [1, 4.1], [1, 2], [0, 2]]
    joints = [joint("plane", *at([0.9, 2], [4.1, 2])), joint("stop", *at([4, 1.9], [4, 3.4]))]
    push = 0.02 * length
    press = 0.02 * length
    top, back = at([4, 4], [1, 4.1]), at([1, 4.1], [1, 2])
    boundaries = [held(*at([0, 0], [14, 0])),
                  {"from_m": top[0], "to_m": top[1], "traction_MPa": list(turn @ [0, -press])},
                  {"from_m": back[0], "to_m": back[1], "traction_MPa": list(turn @ [push, 0])}]
    root = math.sqrt(length)
    return scene(at(*outline), joints, boundaries, [material("joint", 200, 100, 20)], gravity=0, modulus=5 * length,
                 stages=[[at([4, 2], [6, 2], [6, 3.3], [4, 3.3])]], points=at([2.5, 3], [3.5, 3.7]), zone=2 * length,
                 more=f"""[large_displacements]
new_contacts = "joint"
{RIGID if rigid else ""}
stiffness_damping_s = {0.001 * root}
mass_damping_per_s = {0.5 / root}
record_every_s = {0.1 * root}
longest_s = {20 * root}
{more}""")


# The block in two, of different rock, with a joint of its own material between them.
IN_TWO = """
[[rock]]
name = "heavy"
density_kg_per_m3 = 3000
youngs_modulus_GPa = 20
poissons_ratio = 0.2
[[region]]
rock = "heavy"
outline_m = [[-1, 2], [3.9, 2], [3.9, 5], [-1, 5]]
[[joint_material]]
name = "soft"
normal_stiffness_MPa_per_m = 100
shear_stiffness_MPa_per_m = 50
cohesion_MPa = 0
friction_angle_deg = 25
tensile_strength_MPa = 0
[[joint]]
name = "upper"
from_m = [0.9, 3.1]
to_m = [4.1, 3]
material = "soft"
"""


def in_another_order(text, seed):
    """The scene with the tables of every list in which order means nothing in another order."""
    tables = re.split(r"(?m)^(?=\[)", text)
    order = random.Random(seed)
    for name in "rock", "joint_material", "joint", "boundary":
        places = [place for place, one in enumerate(tables) if one.startswith(f"[[{name}]]")]
        others = list(places)
        while others == places:
            order.shuffle(others)
        for place, one in zip(places, [tables[other] for other in others]):
            tables[place] = one
    return "".join(tables)


class Dynamics(ChainTest):
    def test_order_in_the_scene(self):
        """The same blocks to the bit; they slide, bump and rest alike, but for rounding."""
        text = changed(pushed(more=IN_TWO), r"^rigid_rocks = .*", 'rigid_rocks = ["rock", "heavy"]')
        one = solved(self.chain, text)
        self.assertEqual(len(one["/blocks/area"]), 6)
        self.assertGreater(one["/history/displacement"][-1, 0, 0], 8)
        for seed in 1, 2, 3:
            with self.subTest(seed=seed):
                other = solved(self.chain, in_another_order(text, seed))
                for name in "/names/rock", "/names/joint_material":
                    self.assertFalse(np.array_equal(one[name], other[name]), name)
                np.testing.assert_array_equal(one["/mesh/gridpoint_position"], other["/mesh/gridpoint_position"])
                self.check_same(one, other, 1e-9)

    def test_a_block_that_is_pushed_comes_to_the_same_place(self):
        """It bumps into a wall and rocks; rounding grows there, but where it rests is the joints' and the loads' doing, to what
        friction leaves open: some closings of joints, 1e-4 of the way."""
        one = solved(self.chain, pushed())["/history/displacement"][-1]
        self.assertAlmostEqual(one[0, 0], 12.6 - 4, delta=0.01)
        for name, turn in (("37", turned(37)), ("90", turned(90)), ("mirror", MIRROR)):
            with self.subTest(turn=name):
                other = solved(self.chain, pushed(turn))["/history/displacement"][-1]
                self.assertLess(np.abs(other - one @ turn.T).max() / np.abs(one).max(), 1e-4)

    def test_in_other_units(self):
        one = solved(self.chain, pushed())["/history/displacement"][-1]
        for length in 1e-2, 1e2:
            with self.subTest(length=length):
                other = solved(self.chain, pushed(length=length))["/history/displacement"][-1]
                self.assertLess(np.abs(other / length - one).max() / np.abs(one).max(), 1e-3)

    def check_same(self, one, other, share):
        way = np.abs(one["/history/displacement"]).max()
        self.assertLess(np.abs(one["/history/displacement"] - other["/history/displacement"]).max(), share * way)

    # What zones there are changes with places in their last digits, and moves the answer by 6e-5.
    def test_far_from_the_origin(self):
        def section(x, y, more):
            def at(*places):
                return [[px + x, py + y] for px, py in places]

            return scene(at((0, 0), (4, 0), (4, 6), (0, 6)),
                         [joint("low", *at((-4, 1.75), (8, 2.5))), joint("high", *at((-4, 4.25), (8, 3.5)))],
                         [held(*at((0, 0), (4, 0)))], [material("joint", 1000)], points=at((2, 3), (2, 4.5)),
                         stages=[[at((-1, 5), (5, 5), (5, 7), (-1, 7))]],
                         more=f'[large_displacements]\nnew_contacts = "joint"\nmass_damping_per_s = 200\n{more}')

        for more in "", RIGID:
            one = solved(self.chain, section(0, 0, more))
            for x, y in (2**17, -2**17), (2**19, 2**19):
                with self.subTest(more=more, x=x):
                    other = solved(self.chain, section(x, y, more))
                    self.check_same(one, other, 2e-4)
                    self.assertLess(np.abs(one["/equilibria/steps"] / other["/equilibria/steps"] - 1).max(), 0.1)


# Two blocks in a row between walls, under a stress along the row. All goes but the left wall and the blocks, which do not
# quite face each other; the joint to the wall throws the first one against the second.
COLLISION = dict(
    outline=[[0, 0], [5, 0], [5, 2], [0, 2]],
    joints=[*(joint(f"x {x}", [x, -1], [x, 3]) for x in (1, 2, 3, 4)), joint("above", [1, 1.2], [2, 1.2]),
            joint("below", [3, 0.8], [4, 0.8])],
    boundaries=[held([0, 2], [0, 0]), held([5, 0], [5, 2])],
    materials=[material("joint", 1000, 500)],
    stages=[[[[2, 0], [3, 0], [3, 2], [2, 2]], [[4, 0], [5, 0], [5, 2], [4, 2]], [[1, 1.2], [2, 1.2], [2, 2], [1, 2]],
             [[3, 0], [4, 0], [4, 0.8], [3, 0.8]]]],
    points=[[1.5, 0.6], [3.5, 1.4]], gravity=0, stress=(-1, 0, 0))


class FreeCollision(ChainTest):
    """Nothing acts on two blocks once the first has left the wall: their momentum is kept by every step, whatever happens
    between them; the moment of momentum, too; energy to the error of steps."""

    def flight(self, rigid, damping):
        text = scene(**COLLISION, zone=0.5, more=f"""[large_displacements]
new_contacts = "joint"
{RIGID if rigid else ""}
stiffness_damping_s = {damping}
record_every_s = 0.05
longest_s = 4
""")
        joints = self.chain.joints(text)
        output = joints.with_name("result.h5")
        done = self.chain.answer("demsolve", joints, "-o", output)
        self.assertEqual(done.returncode, 3, done.stderr)  # nothing ever stops them
        self.assertIn("no rest within 4 s", done.stderr)
        return datasets(output.with_name("result.failed.h5"))

    def momenta(self, data):
        """Of each block, at the middles between recorded moments: momentum over density, and place [m]; times."""
        state, time = data["/dynamics/state"], data["/dynamics/dynamic_time"]
        corners = data["/mesh/zone_gridpoint"]
        x = data["/mesh/gridpoint_position"][corners]
        edge = x[:, 1:] - x[:, :1]
        area = (edge[:, 0, 0] * edge[:, 1, 1] - edge[:, 0, 1] * edge[:, 1, 0]) / 2
        place = {}
        for point in (0, 1):
            at = data["/history/point_position"][point]
            centre = x.mean(axis=1)
            block = data["/mesh/zone_block"][np.linalg.norm(centre - at, axis=1).argmin()]
            zones = data["/mesh/zone_block"] == block
            moved = data["/states/displacement"][state][:, corners[zones]].mean(axis=2)  # of zones
            place[point] = (area[zones], centre[zones] + moved)
        return time, place

    def check(self, rigid, damping):
        data = self.flight(rigid, damping)
        time, place = self.momenta(data)
        mean = sum((area[:, None] * at).sum(axis=1) for area, at in place.values())  # over density
        # It leaves the wall within a few hundredths of a second, and meets the other after a metre's way.
        gap = place[1][1][..., 0].min(axis=1) - place[0][1][..., 0].max(axis=1)
        speed = np.gradient(place[0][1][..., 0].mean(axis=1), time)
        first = np.flatnonzero(time > 0.2)[0]
        meets = np.flatnonzero(speed < 0.9 * speed[first])
        meets = meets[meets > first][0]
        before, after = (first, meets - 3), (meets + 3, len(time) - 1)
        self.assertGreater(gap[first], 0)
        momentum = [(mean[b] - mean[a]) / (time[b] - time[a]) for a, b in (before, after)]
        self.assertGreater(np.abs(momentum[0][0]), 0.1)
        # Places add up 4e5 moves without rounding, and are given to 1e-16 of 5 m, over a way of half a metre.
        self.assertLess(np.abs(momentum[1] - momentum[0]).max() / np.abs(momentum[0]).max(), 1e-13)
        energy = data["/dynamics/kinetic_energy"]
        self.assertLess(np.abs(missing_energy(data)).max() / energy.max(), 0.01)
        return data, time, place, before, after

    def test_of_rigid_blocks(self):
        data, time, place, before, after = self.check(True, 1e-4)
        # Moment of momentum about the origin, over density: of the centres, and of the turning.
        moments = []
        for a, b in before, after:
            total = 0
            for area, at in place.values():
                mass = area.sum()
                centre = (area[:, None] * at).sum(axis=1) / mass
                velocity = (centre[b] - centre[a]) / (time[b] - time[a])
                arm = at - centre[:, None]
                one, two = arm[a], arm[b]
                turn = np.arctan2((one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]).sum(), (one * two).sum())
                side = 1.2, 1.0
                inertia = mass * (side[0]**2 + side[1]**2) / 12
                total += mass * (centre[a, 0] * velocity[1] - centre[a, 1] * velocity[0])
                total += inertia * turn / (time[b] - time[a])
            moments.append(total)
        # Velocities are half a step behind places: forces and moments of one step act a step apart.
        self.assertLess(abs(moments[1] / moments[0] - 1), 1e-3)
        spin = place[0][1][after[1]]
        self.assertGreater(np.ptp(spin[:, 1]), 0)

    def test_of_blocks_that_deform(self):
        self.check(False, 1e-5)


if __name__ == "__main__":
    main()
