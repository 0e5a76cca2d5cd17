"""Rock that moves far, through the whole chain: blocks that slide, rest and topple against closed forms, and two slopes
that collapse and come to rest, with their balance of energy."""

import math

import numpy as np

from chain import ChainTest, changed, datasets, main

GRAVITY = 9.81


def incline(dip, friction, width=2.0, height=1.0, length=20, wall=1.5, more=""):
    """A block, held by a piece of rock until day 1, on a plane with a wall at its lower end. Angles in degrees."""
    c, s = math.cos(math.radians(dip)), math.sin(math.radians(dip))

    def place(down, off):  # along the plane from its upper end, and off it
        return [round(down * c + off * s, 9), round((length - down) * s + off * c, 9)]

    at, toe = 2.0, 2.0 + width
    top = max(height, 0.5)
    outline = [[0, -1], [length * c, -1], place(length, 0), place(length, wall), place(length - 1, wall),
               place(length - 1, 0), place(toe + 1, 0), place(toe + 1, top), place(toe, top), place(at, top), place(at, 0),
               place(0, 0)]
    outline = [corner for corner, last in zip(outline, outline[-1:] + outline) if corner != last]
    return f"""
[section]
outline_m = {outline}
rock = "rock"
gravity_m_per_s2 = {GRAVITY}
[[rock]]
name = "rock"
density_kg_per_m3 = 2700
youngs_modulus_GPa = 5
poissons_ratio = 0.25
[[joint_material]]
name = "plane"
normal_stiffness_MPa_per_m = 2000
shear_stiffness_MPa_per_m = 1000
cohesion_MPa = 0
friction_angle_deg = {friction}
tensile_strength_MPa = 0
[[joint]]
name = "plane"
from_m = {place(-1, 0)}
to_m = {place(toe, 0)}
material = "plane"
[[joint]]
name = "end"
from_m = {place(toe, 0)}
to_m = {place(toe, top + 1)}
material = "plane"
[in_situ_stress]
elevation_m = 0
compression_xx_MPa = 0
compression_yy_MPa = 0
shear_xy_MPa = 0
compression_xx_gradient_MPa_per_m = 0
compression_yy_gradient_MPa_per_m = 0
shear_xy_gradient_MPa_per_m = 0
[[boundary]]
from_m = [0, -1]
to_m = [{length * c}, -1]
fix = "xy"
[schedule]
start = 0
end = 2
[[stage]]
name = "stop removed"
date = 1
remove_m = [{[place(toe, 0), place(toe + 1, 0), place(toe + 1, top), place(toe, top)]}]
[[point]]
name = "block"
at_m = {place(at + width / 2, top / 2)}
[zones]
size_m = 1
[motion]
new_contacts = "plane"
record_every_s = 0.1
{more}
"""


RIGID = 'rigid_rocks = ["rock"]'


def error_of_energy(data):
    """What is missing from the balance, at every recorded moment [J/m]."""
    parts = ("kinetic", "stored", "friction", "damped")
    return data["/motions/work_of_loads"] - sum(data[f"/motions/{part}_energy"] for part in parts)


class Blocks(ChainTest):
    def along(self, data, dip):
        """Displacement of the block at the end, down the plane [m]."""
        x, y = data["/history/displacement"][-1, 0]
        return x * math.cos(math.radians(dip)) - y * math.sin(math.radians(dip))

    def test_a_block_slides_with_the_acceleration_that_friction_leaves(self):
        dip, friction = 30, 25
        for more, close in ((RIGID, 1e-3), ("stiffness_damping_s = 3e-5", 2e-3)):  # vibration has energy, too
            length = 20 if more == RIGID else 7
            data = datasets(self.chain.result(incline(dip, friction, length=length, more=more)))
            acceleration = GRAVITY * (math.sin(math.radians(dip))
                                      - math.cos(math.radians(dip)) * math.tan(math.radians(friction)))
            way = length - 1 - 2 - 2.0
            until = math.sqrt(2 * way / acceleration)
            time = data["/motions/motion_time"]
            sliding = (time > 0.3) & (time < 0.95 * until)
            speed = np.sqrt(2 * data["/motions/kinetic_energy"] / (2700 * 2.0))
            self.assertGreater(sliding.sum(), 10)
            found = np.polyfit(time[sliding], speed[sliding], 1)[0]
            self.assertLess(abs(found / acceleration - 1), close, more)
            # It ends at the wall, at rest, and the account of its energy closes all the way.
            self.assertAlmostEqual(self.along(data, dip), way, delta=0.02)
            self.assertLessEqual(data["/equilibria/out_of_balance_ratio"].max(), 1e-6)
            work = np.maximum.accumulate(data["/motions/work_of_loads"])
            self.assertLess(abs(error_of_energy(data)[1:] / work[1:]).max(), 0.01, more)

    def test_a_block_at_rest_stays_at_rest(self):
        for more in (RIGID, ""):
            text = incline(30, 30.01, more=more) + "[equilibrium]\ntolerance = 1e-10\n"
            data = datasets(self.chain.result(text))
            self.assertLess(abs(self.along(data, 30)), 2e-4)
            self.assertLessEqual(data["/equilibria/out_of_balance_ratio"].max(), 1e-10)

    # A block on a rough plane tips over its lower edge if it is slimmer than the tangent of the dip; on a joint that
    # gives way under the edge a little before.
    def test_a_slim_block_topples(self):
        dip, width = 20, 1.0
        slim = width / math.tan(math.radians(dip))
        for height, topples in ((0.9 * slim, False), (1.02 * slim, True)):
            text = incline(dip, 60, width=width, height=height, wall=4, more=RIGID + "\nrelease_s = 2")
            data = datasets(self.chain.result(text))
            moved = np.linalg.norm(data["/history/displacement"][-1, 0])
            self.assertEqual(moved > 0.5, topples, f"{height}: {moved}")

    def test_threads_do_not_change_a_byte(self):
        for text in (incline(30, 35), incline(30, 25, more=RIGID)):  # zones that deform; contacts found anew
            joints = self.chain.joints(changed(text, "^size_m = 1$", "size_m = 0.3"))
            files = [self.chain.run("demsolve", joints, self.chain.new_folder() / "result.h5", "--threads", n)
                     for n in (1, 2)]
            one, two = map(datasets, files)
            self.assertGreater(len(one["/mesh/zone_block"]), 4000)
            for name, values in one.items():
                self.assertTrue(np.array_equal(values, two[name]), name)

    def test_what_goes_on_moving_is_named(self):
        joints = self.chain.joints(incline(30, 25, more=RIGID + "\nlongest_s = 1"))
        output = joints.with_name("result.h5")
        done = self.chain.answer("demsolve", joints, "-o", output)
        self.assertEqual(done.returncode, 3)
        self.assertRegex(done.stderr, r'no rest within 1 s\n?.*stage "stop removed"; what moves: block \d+ at .* m by ')
        self.assertFalse(output.exists())
        failed = datasets(output.with_name("result.failed.h5"))
        self.assertAlmostEqual(failed["/motions/motion_time"][-1], 1, delta=0.01)
        moved = np.linalg.norm(failed["/failure/motion"][0])
        speed = GRAVITY * (math.sin(math.radians(30)) - math.cos(math.radians(30)) * math.tan(math.radians(25)))
        self.assertAlmostEqual(moved / failed["/failure/seconds"][()].item(), speed, delta=0.02)
        done = self.chain.answer("demsolve", joints, "-o", output, "--factor-of-safety")
        self.assertEqual(done.returncode, 2)
        self.assertIn("the scene has [motion]", done.stderr)

    def test_what_does_not_go_together_is_refused(self):
        text = incline(30, 25)
        for more, message in (('[creep]\nstep_days = 1\n', r"a scene with \[motion\] has no \[creep\]"),
                              ("", r"rigid_rocks.*wanted the name of a \[\[rock\]\]"), ("", "new_contacts = .clay"),
                              ("", "wanted .elastic. of all rock"),
                              ("", "residual_cohesion_MPa.*neither a residual strength"),
                              ("", "joint_roughness_coefficient.*nor Barton and Bandis's law")):
            scene = text + more
            if "rigid" in message:
                scene = scene.replace("record_every_s", 'rigid_rocks = ["granite"]\nrecord_every_s')
            if "clay" in message:
                scene = scene.replace('new_contacts = "plane"', 'new_contacts = "clay"')
            if "elastic" in message:
                scene = scene.replace("[[rock]]", '[[rock]]\nlaw = "Mohr-Coulomb"\ncohesion_MPa = 1\n'
                                      'friction_angle_deg = 40\ntensile_strength_MPa = 1')
            if "residual" in message:
                scene = scene.replace("[[joint_material]]", "[[joint_material]]\nresidual_cohesion_MPa = 0\n"
                                      "residual_friction_angle_deg = 20")
            if "Bandis" in message:
                scene = scene.replace("[[joint_material]]", "[[joint_material]]\njoint_roughness_coefficient = 5\n"
                                      "joint_wall_strength_MPa = 50\nlargest_closure_mm = 1")
            path = self.chain.new_folder() / "scene.toml"
            path.write_text(scene)
            done = self.chain.answer("jointgen", path, "-o", path.with_suffix(".h5"))
            self.assertEqual(done.returncode, 2)
            self.assertRegex(done.stderr, message)


class SmallDisplacements(ChainTest):
    """The paper's column: what is left rises by dF z (1 - nu^2) / E_r + m dF / K with each block that goes."""

    def test_the_column_rises(self):
        text = self.chain.text("data/column/scene.toml")
        text = changed(text, r"^\[creep\]\n(.+\n)+", '[motion]\nnew_contacts = "joint"\nmass_damping_per_s = 20\n')
        text = changed(text, r"^\[equilibrium\](.|\n)*", "[equilibrium]\ntolerance = 1e-8\n")
        data = datasets(self.chain.result(text))
        after = [row for row, event in enumerate(data["/history/event"]) if event]
        load = 2750 * GRAVITY * 10
        for removed, row in enumerate(after, 1):
            for point, (joints, height) in enumerate(((3, 25), (2, 15), (1, 5))):
                times = min(removed, point + 1)  # it goes with the next one
                rise = times * load * (height * (1 - 0.22**2) / 40e9 + joints / 690e6)
                self.assertAlmostEqual(data["/history/displacement"][row, point, 1] / rise, 1, delta=1e-5)


    def test_a_bond_holds_a_block_that_hangs(self):
        text = """
[section]
outline_m = [[0, 0], [2, 0], [2, 3], [0, 3]]
rock = "rock"
gravity_m_per_s2 = 9.81
[[rock]]
name = "rock"
density_kg_per_m3 = 2700
youngs_modulus_GPa = 5
poissons_ratio = 0
[[joint_material]]
name = "bonded"
normal_stiffness_MPa_per_m = 1000
shear_stiffness_MPa_per_m = 500
cohesion_MPa = 1
friction_angle_deg = 30
tensile_strength_MPa = 1
[[joint]]
name = "roof"
from_m = [0, 2]
to_m = [2, 2]
material = "bonded"
[in_situ_stress]
elevation_m = 3
compression_xx_MPa = 0
compression_yy_MPa = 0
shear_xy_MPa = 0
compression_xx_gradient_MPa_per_m = 0
compression_yy_gradient_MPa_per_m = 0
shear_xy_gradient_MPa_per_m = 0
[[boundary]]
from_m = [0, 3]
to_m = [2, 3]
fix = "xy"
[schedule]
start = 0
end = 2
[[stage]]
name = "half of it cut off"
date = 1
remove_m = [[[0, 0], [2, 0], [2, 1], [0, 1]]]
[[point]]
name = "lower end"
at_m = [1, 1]
[zones]
size_m = 0.5
[motion]
new_contacts = "bonded"
"""
        weight = 2700 * GRAVITY  # per metre of height and width
        for more in ("", "release_s = 0.2\n"):
            data = datasets(self.chain.result(text + more))
            rise = weight * (1 / 1e9 + 2 / 5e9)  # a metre less hangs on the joint and on 2 m of rock
            self.assertAlmostEqual(data["/history/displacement"][-1, 0, 1] / rise, 1, delta=1e-3)


class Collapse(ChainTest):
    """Both slopes fall and come to rest; at every moment the energies add up to 1 percent of the work so far."""

    def collapse(self, name):
        data = datasets(self.chain.result(self.chain.text(f"data/collapse/{name}.toml")))
        work = np.maximum.accumulate(data["/motions/work_of_loads"])
        self.assertLess(abs(error_of_energy(data)[1:] / work[1:]).max(), 0.01)
        self.assertLess(data["/motions/fastest"][-1], 1e-5)
        self.assertGreater(data["/motions/fastest"].max(), 5)
        self.assertLessEqual(data["/equilibria/out_of_balance_ratio"][-1], 1e-6)
        return data

    def test_sliding(self):
        data = self.collapse("sliding")
        moved = np.linalg.norm(data["/history/displacement"][-1], axis=1)
        self.assertGreater(moved.min(), 10)

    def test_toppling(self):
        data = self.collapse("toppling")
        moved = np.linalg.norm(data["/history/displacement"][-1], axis=1)
        self.assertGreater(moved[0], 5)  # the column at the toe falls
        self.assertGreater(moved[1:].min(), 0.5)  # the others lean on each other


if __name__ == "__main__":
    main()
