"""Two joint laws through the whole chain: a joint whose dilation wears off with work, and a continuously yielding joint. A
rigid block is sheared on each by both engines, creeps, slides down an incline, and is brought to failure; against closed
forms and against the laws' equations in small steps."""

import csv
import math

import numpy as np

from chain import ChainTest, changed, datasets, main
from dilation_test import C, HELD, K_N, K_S, SCENE, STEEL, TAN_PHI, TAN_PSI
from export_test import Grid
from large_displacements_test import ACCOUNT, GRAVITY, NO_STRESS, RIGID, box, error_of_energy, incline, scene

WEAR = 4e-4  # m2/J
WEARS = ("^dilation_angle_deg = 10", f"dilation_angle_deg = 10\ndilation_wear_m2_per_MJ = {WEAR * 1e6}")
PHI, PHI_I, ROUGHNESS = math.radians(30), math.radians(45), 2e-3
YIELDS = ("^cohesion_MPa = 0.2\nfriction_angle_deg = 35\ntensile_strength_MPa = 0\ndilation_angle_deg = 10",
          "cohesion_MPa = 0\nfriction_angle_deg = 30\ntensile_strength_MPa = 0\ninitial_friction_angle_deg = 45\n"
          f"roughness_length_mm = {ROUGHNESS * 1e3}")
E_S, ETA_S = 0.8e9, 4e9  # Pa/m, Pa day/m
E_N, ETA_N = 3e9, 9e9
KELVIN = ("^(initial_friction|dilation_wear)", "normal_kelvin_stiffness_MPa_per_m = 3000\n"
          "normal_kelvin_viscosity_MPa_day_per_m = 9000\nshear_kelvin_stiffness_MPa_per_m = 800\n"
          r"shear_kelvin_viscosity_MPa_day_per_m = 4000\n\1")


def to_engine(text, engine, increments=1):
    return changed(text, "^tolerance = 1e-9",
                   f'tolerance = 1e-9\nengine = "{engine}"\nunloading_increments = {increments}')


def mean_traction(data):
    length = data["/mesh/contact_length"]
    return length @ data["/states/traction"][-1] / length.sum()


def down_the_plane(data, dip):
    """Displacement of the block at the end, down the plane and off it [m]."""
    x, y = data["/history/displacement"][-1, 0]
    sin, cos = math.sin(math.radians(dip)), math.cos(math.radians(dip))
    return x * cos - y * sin, x * sin + y * cos


def acceleration(data, after, until):
    time, speed = data["/dynamics/dynamic_time"], np.sqrt(2 * data["/dynamics/kinetic_energy"] / (2700 * 2.0))
    sliding = (time > after) & (time < until)
    return np.polyfit(time[sliding], speed[sliding], 1)[0]


def worn_and_crept(days, top, n, wear=WEAR):
    """Normal and shear traction of the joint with Kelvin units and wearing dilation, fixed in normal direction, after the
    block has moved by `top` [m]: by n steps, of which each finds the slip with the tractions it ends with, and lets the
    Kelvin units follow those (backward Euler)."""
    dt, stiffness = days / n, 1 / (1 / K_N + 1 / STEEL)
    k_n, k_s = 1 / (1 / stiffness + 1 / (E_N + ETA_N / dt)), 1 / (1 / K_S + 1 / (E_S + ETA_S / dt))
    slip = dilation = work = d_n = d_s = 0.0
    for i in range(1, n + 1):
        o_n, o_s = (d * eta / (eta + e * dt) for d, e, eta in ((d_n, E_N, ETA_N), (d_s, E_S, ETA_S)))
        tau, pressed = k_s * (top * i / n - slip - o_s), 1e6 + k_n * (dilation + o_n)
        excess = tau - (C + pressed * TAN_PHI)
        if excess > 0:
            tan_psi = TAN_PSI * math.exp(-wear * work)
            by = excess / (k_s + k_n * TAN_PHI * tan_psi)
            tau, pressed = tau - k_s * by, pressed + k_n * tan_psi * by
            slip, dilation, work = slip + by, dilation + tan_psi * by, work + tau * by
        d_n += (-(pressed - 1e6) - E_N * d_n) * dt / (ETA_N + E_N * dt)
        d_s += (tau - E_S * d_s) * dt / (ETA_S + E_S * dt)
    return -pressed, tau


def strength_in_the_end(factor):
    """Shear traction that the joint with wearing dilation, fixed in normal direction, carries however far it slips, with
    strengths divided by `factor`: the equations in small steps."""
    stiffness, by = 1 / (1 / K_N + 1 / STEEL), 2e-7
    pressed, work, tau, wear = 1e6, 0.0, 0.0, 1.0
    while wear > 1e-6:
        wear = math.exp(-WEAR * work)
        tau = (C + pressed * TAN_PHI) / factor
        pressed += stiffness * TAN_PSI / factor * wear * by
        work += tau * by
    return tau


class WearingDilation(ChainTest):
    def test_under_a_constant_load_it_opens_less_and_less(self):
        """In dynamic relaxation slip overshoots and comes back in each increment, and that works too."""
        tau = 0.2e6 + 1e6 * TAN_PHI
        slip = 4e-3 - tau / K_S
        wanted = TAN_PSI / (WEAR * tau) * (1 - math.exp(-WEAR * tau * slip))
        self.assertLess(wanted, 0.7 * TAN_PSI * slip)
        for engine, increments, delta in ("relaxation", 40, 1e-2), ("implicit", 1, 1e-4), ("auto", 20, 1e-4):
            with self.subTest(engine=engine):
                data = datasets(self.chain.result(to_engine(changed(SCENE, *WEARS), engine, increments)))
                self.assertAlmostEqual(data["/history/displacement"][-1, 0, 1] / wanted, 1, delta=delta)
                self.assertAlmostEqual(mean_traction(data)[1] / tau, 1, delta=1e-3)

    def test_fixed_in_normal_direction_it_follows_its_equations(self):
        stiffness, steps = 1 / (1 / K_N + 1 / STEEL), 100000
        slip = dilation = work = 0.0
        for i in range(1, steps + 1):
            trial, pressed = K_S * (4e-3 * i / steps - slip), 1e6 + stiffness * dilation
            tau = min(trial, 0.2e6 + pressed * TAN_PHI)
            by = (trial - tau) / K_S
            slip, work = slip + by, work + tau * by
            dilation += TAN_PSI * math.exp(-WEAR * work) * by
        for engine, increments, delta in ("relaxation", 400, 1e-2), ("implicit", 400, 2e-3):
            with self.subTest(engine=engine):
                text = changed(changed(SCENE, *HELD), *WEARS)
                data = datasets(self.chain.result(to_engine(text, engine, increments)))
                found = mean_traction(data)
                self.assertAlmostEqual(found[0] / -(1e6 + stiffness * dilation), 1, delta=delta)
                self.assertAlmostEqual(found[1] / tau, 1, delta=delta)

    def test_a_block_slides_and_rises_less_and_less(self):
        """y' = t s' with t = tan(psi) exp(-w W): s'' = g sin - tau / m, tau = tan(phi) m (g cos + y''), m per area. While it
        is all on its joint. The formula has one pressure: below the block it differs by a third, and so does the wear."""
        dip, friction, psi, wear, height = 30, 25, 8, 1e-4, 0.5
        mass = 2700 * height
        text = changed(incline(dip, friction, height=height, length=9, wall=4, more=RIGID, seam=1.5),
                       "^tensile_strength_MPa = 0$",
                       f"tensile_strength_MPa = 0\ndilation_angle_deg = {psi}\ndilation_wear_m2_per_MJ = {wear * 1e6}")
        data = datasets(self.chain.result(text))
        self.assertLess(error_of_energy(data), ACCOUNT)
        sin, cos, tan = math.sin(math.radians(dip)), math.cos(math.radians(dip)), math.tan(math.radians(friction))
        there = data["/states/displacement"][data["/dynamics/state"]]
        there = there[:, np.abs(there[-1]).sum(axis=1) > 1].mean(axis=1)  # of the block
        moved, off = there[:, 0] * cos - there[:, 1] * sin, there[:, 0] * sin + there[:, 1] * cos
        compared = 0
        s = v = y = work = 0.0
        dt = 1e-5
        for at, found in zip(moved, off):
            if at > 1.3:
                break
            while s < at:
                t = math.tan(math.radians(psi)) * math.exp(-wear * work)
                tau = tan * mass * (GRAVITY * cos + t * GRAVITY * sin) / (
                    1 + tan * t + tan * mass * wear * t * v * v)
                v += (GRAVITY * sin - tau / mass) * dt
                s, y, work = s + v * dt, y + t * v * dt, work + tau * v * dt
            if at > 0.2:
                self.assertAlmostEqual(found / y, 1, delta=0.02, msg=at)
                compared += 1
        self.assertGreater(compared, 5)
        self.assertLess(y, 0.85 * math.tan(math.radians(psi)) * s)

    def test_its_wear_goes_with_the_joint(self):
        """Also where rock bridges halve the tangent of the dilation angle; in exports it has a column."""
        joints = self.chain.joints(self.chain.bridged(
            f"dilation_angle_deg = 10\ndilation_wear_m2_per_MJ = {WEAR * 1e6}"))
        table = joints.with_name("edges.csv")
        self.assertEqual(self.chain.answer("jointexport", joints, "-o", table, "--what", "edges").returncode, 0)
        with open(table, encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        worn = [row for row in rows if float(row["dilation_wear_m2_per_J"] or 0) > 0]
        self.assertGreater(len(worn), 3)
        for row in worn:
            self.assertAlmostEqual(float(row["dilation_wear_m2_per_J"]), WEAR, delta=1e-12)

    def test_it_creeps(self):
        fine, wanted = (worn_and_crept(10, 4e-3, n) for n in (20000, 40000))
        self.assertLess(abs(fine[0] / wanted[0] - 1), 1e-4)
        self.assertLess(-wanted[0], 0.98 * -worn_and_crept(10, 4e-3, 20000, wear=0)[0])  # wear counts
        text = changed(changed(changed(SCENE, *HELD), *WEARS), *KELVIN)
        for engine, delta in ("implicit", 2e-2), ("relaxation", 2e-2):
            errors = []
            for days in 0.5, 0.25:
                data = datasets(self.chain.result(to_engine(text, engine) + f"\n[creep]\nstep_days = {days}\n"))
                errors.append(max(abs(found / of - 1) for found, of in zip(mean_traction(data), wanted)))
            with self.subTest(engine=engine, errors=errors):
                self.assertLess(errors[0], delta)
                self.assertLess(errors[1], 0.7 * errors[0])

    def test_factor_of_safety(self):
        """Fixed in normal direction, slip presses the joint together, and it fails where the dilation is worn off before it
        carries the load. Strengths and the tangent of the dilation angle are divided, wear is not."""
        wanted = 1.25
        tau = strength_in_the_end(wanted)
        self.assertGreater(tau, 1.1 * (C + 1e6 * TAN_PHI) / wanted)  # dilation counts
        text = changed(changed(SCENE, *HELD), *WEARS)
        text = changed(text, r'^fix = "x"\ndisplacement_mm = \[4, 0\]', f"traction_MPa = [{tau / 1e6}, 0]", 2)
        joints = self.chain.joints(to_engine(text, "auto", 100))
        output = joints.with_name("safe.h5")
        done = self.chain.answer("demsolve", joints, "--factor-of-safety", "-o", output)
        self.assertEqual(done.returncode, 0, done.stderr)
        data = datasets(output)
        factor, stands = data["/safety/factor"], data["/safety/stands"]
        low, high = factor[stands == 1].max(), factor[stands != 1].min()
        self.assertLess(high - low, 0.02 * low)
        self.assertAlmostEqual(low / wanted, 1, delta=0.02)

    def test_what_does_not_go_together_is_refused(self):
        one_law = "expected keys of one joint law"
        for more, *messages in (
                ("dilation_until_m = 1", "dilation_until_m", "expected 0 of a joint whose dilation wears off"),
                ("residual_cohesion_MPa = 0\nresidual_friction_angle_deg = 30", "residual_cohesion_MPa", one_law),
                ("joint_roughness_coefficient = 8\njoint_wall_strength_MPa = 50\nlargest_closure_mm = 0.3",
                 "joint_roughness_coefficient", one_law),
                ("initial_friction_angle_deg = 45\nroughness_length_mm = 2", "dilation_wear_m2_per_MJ", one_law)):
            scene_file = self.chain.new_folder() / "scene.toml"
            scene_file.write_text(changed(changed(SCENE, *WEARS), "^dilation_wear", more + "\ndilation_wear"))
            done = self.chain.answer("jointgen", scene_file, "-o", scene_file.with_suffix(".h5"))
            self.assertEqual(done.returncode, 2, more)
            for message in messages:
                self.assertIn(message, done.stderr)


def yielded(moves, pressure=1e6, steps=200000, days=0.0):
    """Shear traction of the continuously yielding joint after these moves [m], in small steps; with its Kelvin unit if
    they take so many days in all."""
    tau = u_p = kelvin = r = sense = 0.0
    far = sum(map(abs, moves))
    for move in moves:
        n = int(steps * abs(move) / far)
        for _ in range(n):
            by = move / n
            if days:
                crept = (tau - E_S * kelvin) / ETA_S * days * abs(move) / far / n
                kelvin, by = kelvin + crept, by - crept
            way = math.copysign(1, by)
            most = pressure * math.tan(PHI + (PHI_I - PHI) * math.exp(-u_p / ROUGHNESS))
            if way != sense:
                r, sense = (min(0.75, way * tau / most) if sense else 0.0), way
            share = min(1.0, (1 - sense * tau / most) / (1 - r))
            tau += share * K_S * by
            u_p += (1 - share) * abs(by)
            most = pressure * math.tan(PHI + (PHI_I - PHI) * math.exp(-u_p / ROUGHNESS))
            if abs(tau) > most:
                u_p, tau = u_p + (abs(tau) - most) / K_S, math.copysign(most, tau)
    return tau


def displacement_at(tau, k_s, roughness, pressure=1e6, by=1e-8):
    """Displacement [m] at which the continuously yielding joint first carries that shear traction, in small steps."""
    u = now = u_p = 0.0
    while now < tau:
        share = 1 - now / (pressure * math.tan(PHI + (PHI_I - PHI) * math.exp(-u_p / roughness)))
        u, now, u_p = u + by, now + share * k_s * by, u_p + (1 - share) * by
    return u


class ContinuouslyYielding(ChainTest):
    def sheared(self, text, load_history, engine, increments=1):
        text = text.replace("load_history = [[0, 0], [10, 1]]", f"load_history = {load_history}")
        return datasets(self.chain.result(to_engine(changed(text, *YIELDS), engine, increments)))

    def test_it_follows_its_equations(self):
        """There, and back by a quarter. Dynamic relaxation oscillates about the path, and each time the joint turns."""
        for load_history, moves in (("[[0, 0], [10, 0.5]]", [2e-3]), ("[[0, 0], [10, 1]]", [4e-3]),
                                    ("[[0, 0], [5, 1], [10, 0.75]]", [4e-3, -1e-3])):
            wanted = yielded(moves)
            for engine, increments, delta in (("relaxation", 50, 0.1), ("implicit", 1, 2e-3), ("implicit", 20, 2e-3),
                                              ("auto", 1, 2e-3)):
                with self.subTest(load_history=load_history, engine=engine, increments=increments):
                    found = mean_traction(self.sheared(SCENE, load_history, engine, increments))
                    self.assertAlmostEqual(found[0], -1e6, delta=1e3)
                    self.assertAlmostEqual(found[1], wanted, delta=delta * 1e6 * math.tan(PHI_I))
                    self.assertLess(abs(found[1]), 1e6 * math.tan(PHI_I))

    def test_it_creeps(self):
        wanted, fixed = yielded([4e-3], days=10), yielded([4e-3])
        self.assertGreater(wanted, 1.05 * fixed)  # what creeps need not yield, and wears less
        for engine, delta in ("implicit", 1e-2), ("relaxation", 5e-2):
            errors = []
            for days in 0.5, 0.25:
                text = changed(changed(SCENE, *YIELDS), *KELVIN)
                data = datasets(self.chain.result(to_engine(text, engine) + f"\n[creep]\nstep_days = {days}\n"))
                errors.append(abs(mean_traction(data)[1] / wanted - 1))
            with self.subTest(engine=engine, errors=errors):
                self.assertLess(errors[0], delta)
                if engine == "implicit":  # by relaxation the path adds to the error of the steps
                    self.assertLess(errors[1], 0.7 * errors[0])

    def test_a_block_slides_on_the_smooth_joint(self):
        """Rough enough at first it stands; else it slides as its smooth joint lets it."""
        dip, friction = 30, 25
        for initial, goes in (60, False), (28, True):
            text = changed(incline(dip, friction, more=RIGID), "^tensile_strength_MPa = 0$",
                           f"tensile_strength_MPa = 0\ninitial_friction_angle_deg = {initial}\nroughness_length_mm = 5")
            data = datasets(self.chain.result(text))
            moved = down_the_plane(data, dip)[0]
            if not goes:
                self.assertLess(abs(moved), 1e-3)
                continue
            self.assertGreater(moved, 10)
            wanted = GRAVITY * (math.sin(math.radians(dip))
                                - math.cos(math.radians(dip)) * math.tan(math.radians(friction)))
            self.assertAlmostEqual(acceleration(data, 0.6, 0.95 * math.sqrt(2 * 15 / wanted)) / wanted, 1, delta=2e-3)
            self.assertLess(error_of_energy(data), ACCOUNT)

    def test_with_large_displacements_it_follows_its_equations(self):
        """A block on its joint, below a lid that slides, is pushed by more than its smooth joint would carry once a stage
        has removed the rock beside it. What slides on to the next face has no shear yet: with 3 mm and faces of 1 m, 0.3
        percent of the length at most."""
        pushed, roughness = 1.3e6, 3e-3
        stress = changed(NO_STRESS, r"^compression_(..)_MPa = 0$",
                         lambda found: f"compression_{found[1]}_MPa = {1.3 if found[1] == 'xx' else 1}", 2)
        sides = "\n".join(('[[boundary]]\nfrom_m = [0, 0]\nto_m = [3, 0]\njoint = "joint"',
                           '[[boundary]]\nfrom_m = [0, 1]\nto_m = [3, 1]\nfix = "y"',
                           '[[boundary]]\nfrom_m = [3, 0]\nto_m = [3, 1]\nfix = "x"',
                           f'[[boundary]]\nfrom_m = [0, 0]\nto_m = [0, 1]\ntraction_MPa = [{pushed / 1e6}, 0]'))
        text = scene(box(0, 0, 3, 1), [([2, -1], [2, 2])], [[box(2, 0, 3, 1)]], sides,
                     "release_s = 1\nmass_damping_per_s = 300\nrecord_every_s = 0.1\n" + RIGID, gravity=0, stress=stress,
                     size=1, points='[[point]]\nname = "middle"\nat_m = [1, 0.5]')
        text = changed(text, "^tensile_strength_MPa = 0$", "tensile_strength_MPa = 0\ninitial_friction_angle_deg = 45\n"
                       f"roughness_length_mm = {roughness * 1e3}")
        data = datasets(self.chain.result(text))
        self.assertLess(error_of_energy(data), ACCOUNT)
        tau, k_s = pushed / 2, 0.5e9
        self.assertGreater(tau, 1.1e6 * math.tan(PHI))
        wanted = displacement_at(tau, k_s, roughness)
        self.assertGreater(wanted, 1.07 * displacement_at(tau, k_s, 1e9))  # its roughness wears
        self.assertGreater(wanted, 1.7 * tau / k_s)  # it yields
        self.assertAlmostEqual(data["/history/displacement"][-1, 0, 0] / wanted, 1, delta=2e-2)

    def test_its_result_is_exported(self):
        text = to_engine(changed(SCENE, *YIELDS), "implicit")
        result = self.chain.result(text)
        data = datasets(result)
        edges, contacts = result.with_name("edges.csv"), result.with_name("contacts.vtu")
        self.chain.run("jointexport", result, edges, "--what", "edges")
        with open(edges, encoding="utf-8") as file:
            rows = [row for row in csv.DictReader(file) if row["law"] == "4"]
        self.assertEqual(len(rows), (data["/equivalent/law"] == 4).sum())
        self.assertGreater(len(rows), 0)
        for row in rows:
            self.assertAlmostEqual(float(row["initial_friction_angle_rad"]), PHI_I, delta=1e-12)
            self.assertAlmostEqual(float(row["roughness_length_m"]), ROUGHNESS, delta=1e-12)
            self.assertAlmostEqual(float(row["friction_angle_rad"]), PHI, delta=1e-12)
        self.chain.run("jointexport", result, contacts, "--what", "contacts")
        grid = Grid(contacts)
        np.testing.assert_array_equal(grid.point["shear_traction"], data["/states/traction"][-1, :, 1])
        self.assertGreater(abs(grid.point["shear_traction"]).min(), 0)

    def test_its_sensitivities_are_refused(self):
        joints = self.chain.joints(to_engine(changed(SCENE, *YIELDS), "implicit"))
        readings = joints.with_name("readings.csv")
        readings.write_text("time_day,point,component,displacement_mm\n"
                            + "".join(f"{day},top,x,{0.4 * day}\n" for day in range(1, 10)))
        output = joints.with_name("factors.csv")
        done = self.chain.answer("creepfit", joints, "--measurements", readings, "--fit", "joint-stiffness", "-o", output)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("no sensitivities of continuously yielding joints: their plastic displacement has a shear stiffness "
                      "that is not differentiated; expected a scene without continuously yielding joints", done.stderr)
        self.assertFalse(output.exists())

    def test_factor_of_safety(self):
        """Of a joint that is smooth from the start: tan(35 deg) / tan(25 deg)."""
        text = changed(self.chain.text("data/verification/incline/scene.toml"), "^tensile_strength_MPa = 0",
                       "tensile_strength_MPa = 0\ninitial_friction_angle_deg = 35\nroughness_length_mm = 5")
        joints = self.chain.joints(text)
        output = joints.with_name("safe.h5")
        done = self.chain.answer("demsolve", joints, "--no-creep", "--factor-of-safety", "-o", output)
        self.assertEqual(done.returncode, 0, done.stderr)
        data = datasets(output)
        factor, stands = data["/safety/factor"], data["/safety/stands"]
        wanted = math.tan(math.radians(35)) / math.tan(math.radians(25))
        self.assertLess(factor[stands == 1].max(), wanted)
        self.assertGreater(factor[stands == 1].max(), 0.98 * wanted)
        self.assertGreater(factor[stands != 1].min(), 0.99 * wanted)

    def test_rock_bridges_are_refused(self):
        text = self.chain.bridged("initial_friction_angle_deg = 40\nroughness_length_mm = 3", cohesion=0)
        network = self.chain.network(text)
        done = self.chain.answer("strength-averaging", network, "-o", network.with_name("joints.h5"))
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("continuously yielding", done.stderr)
        self.assertIn("persistence of 1", done.stderr)



if __name__ == "__main__":
    main()
