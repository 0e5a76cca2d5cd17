"""jointverify: results of the solver verify, every check finds a value that is wrong, and no file leads it astray."""

import contextlib
import importlib.machinery
import importlib.util
import io
import pathlib
import random
import re
import shutil
import sys
import types

import h5py
import numpy as np

import barton_bandis_test
import creep_test
import dilation_test
import joint_laws_test
import residual_test
import yield_test
from chain import ChainTest, changed, in_a_copy, main
from small_scene import held, joint, material, scene

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "pipelines" / "reliability"))

from damage import DAMAGE, MUST_BE_REFUSED  # noqa: E402

REMOVED, STUCK, SLIPPING, OPEN = range(4)
RAMP = ("^load_history = .*", "load_history = [[0, 0], [4, 0.4], [8, 0.8], [10, 1]]", 2)


def slipping(text, *changes):
    """The scene of a joint that is sheared, with some states more."""
    for change in (RAMP, *changes):
        text = changed(text, *change)
    return text


def filled(text, **words):
    for word, value in words.items():
        text = text.replace(word, value)
    return text


def with_stage():
    """Two blocks on a creeping joint and rock that creeps; the upper one goes, and a monitoring point with it."""
    text = creep_test.SCENE.replace("# rock creep", "kelvin_shear_modulus_GPa = 30\nkelvin_shear_viscosity_GPa_day = 90")
    return text + '\n[[point]]\nname = "goes"\nat_m = [5, 15]\n'


BASE = held([0, 0], [6, 0])
UPPER_LEFT, UPPER_RIGHT = [[0, 4.4], [2, 4.4], [2, 6], [0, 6]], [[2, 4.4], [6, 4.4], [6, 6], [2, 6]]


def four_blocks(bases=(BASE,), stages=((UPPER_LEFT,), (UPPER_RIGHT,)), right=0):
    """Blocks that stages unload: joints open and slip, points leave with the rock. The right side is fixed from y = `right` up."""
    return scene([[0, 0], [6, 0], [6, 6], [0, 6]],
                 [joint("across", [0, 3], [6, 3]), joint("upright", [3, 0], [3, 6])],
                 [held([0, 0], [0, 6], "x"), held([6, right], [6, 6], "x"), *bases],
                 [material("joint", 1000, friction=20)], stress=(-0.05, -0.05, 0.02), stages=stages,
                 points=[[1, 5.5], [3, 5.9]])


class Verify(ChainTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        loader = importlib.machinery.SourceFileLoader("jointverify", str(cls.chain.programs / "jointverify"))
        spec = importlib.util.spec_from_loader("jointverify", loader)
        cls.script = importlib.util.module_from_spec(spec)
        loader.exec_module(cls.script)
        cls.made, cls.said = {}, {}

    def result(self, name):
        """A result file, made once."""
        if name not in self.made:
            self.made[name] = self.make(name)
        return self.made[name]

    def of_result(self, name):
        """What verified() finds in a result file, once."""
        if name not in self.said:
            self.said[name] = self.verified(self.result(name))
        return self.said[name]

    def make(self, name):
        run, text = self.chain.result, self.chain.text
        if name == "slope":
            return run(text("data/slope/scene.toml"), "--zone-size", 6)
        if name == "weaker slope":
            return run(text("data/slope/scene.toml"), "--zone-size", 6, "--no-creep", "--strength-factor", 1.1,
                       "--engine", "relaxation", "--tolerance", 1e-5)
        if name == "column":
            return run(text("data/column/scene.toml"), "--states", 1)
        if name == "creeping rock":
            return run(with_stage(), "--states", 1)
        if name == "chain":
            return run(creep_test.SCENE.replace("# joint creep", creep_test.CHAIN), "--states", 1)
        if name == "quadratic zones":
            return run(changed(four_blocks(), "^kind = .*", 'kind = "quadratic"'))
        if name == "kinds":
            folder = self.chain.new_folder()
            for file in "scene.toml", "poles.csv", "traces.geojson":
                (folder / file).write_text(text(f"tests/pipeline/kinds/{file}"))
            network = self.chain.run("jointgen", folder / "scene.toml", folder / "network.h5")
            joints = self.chain.run("strength-averaging", network, folder / "joints.h5")
            return self.chain.run("demsolve", joints, folder / "result.h5", "--zone-size", 8)
        if name == "collapse":
            return run(text("data/collapse/sliding.toml"))
        if name == "short step":  # of creep, 1e-6 day
            return run(text("data/verification/incline/scene.toml"))
        if name == "excavated boundary":
            return run(four_blocks(right=4.4))
        if name == "displaced":
            return run(four_blocks() + '\n[large_displacements]\nnew_contacts = "joint"\nrelease_s = 0.1\n')
        if name == "opening":
            return run(four_blocks())
        if name == "dilation":
            return run(slipping(dilation_test.SCENE))
        if name == "dilation that ends":
            return run(slipping(dilation_test.SCENE, ("^dilation_angle_deg = 10",
                                                      "dilation_angle_deg = 10\ndilation_until_m = 0.001")))
        if name == "wearing":
            return run(slipping(dilation_test.SCENE, joint_laws_test.WEARS))
        if name == "continuously yielding":
            return run(slipping(dilation_test.SCENE, joint_laws_test.YIELDS))
        if name == "residual":
            side = 'fix = "x"\ndisplacement_mm = [4, 0]\nload_history = [[0, 0], [5, 0.1], [15, 0.5], [20, 1]]'
            return run(filled(residual_test.SCENE, DRIVEN=side, RIGHT=side, ENGINE="auto", INCREMENTS="1"))
        if name == "Barton-Bandis":
            return run(filled(barton_bandis_test.SCENE, LOAD="5", ENGINE="auto"))
        if name == "yield":
            return run(filled(yield_test.SCENE, CONFINED="1", MOVED="-20", HISTORY="[[0, 0], [10, 0.5], [20, 1]]",
                              ENGINE="auto", INCREMENTS="4"))
        if name == "rollers":
            return run(scene([[0, 0], [6, 3], [3, 9], [-3, 6]], [],
                             [held([0, 0], [6, 3], "normal"), held([-3, 6], [0, 0], "normal"),
                              {"from_m": [3, 9], "to_m": [-3, 6], "traction_MPa": [0, -1], "load_history": [[0, 0], [1, 1]]}],
                             [], points=[[0, 3]]))
        if name == "factor of safety":
            return run(text("data/verification/vertical-cut/scene.toml"), "--zone-size", 2, "--factor-of-safety")
        raise KeyError(name)

    RESULTS = ("slope", "weaker slope", "column", "creeping rock", "quadratic zones", "chain", "short step", "kinds",
               "collapse", "displaced", "opening", "excavated boundary", "dilation", "dilation that ends", "wearing", "continuously yielding", "residual", "Barton-Bandis", "yield",
               "rollers", "factor of safety")

    def verified(self, path):
        """Exit code, lines of the table by the name of the check, and all that was said."""
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            code = self.script.verify(str(path))
        checks = {}
        for line in out.getvalue().splitlines():
            cells = re.split(r"  +", line)
            if len(cells) >= 5 and cells[4] in ("ok", "FAILED"):
                checks[cells[0]] = cells[4], "".join(cells[5:])
        return code, checks, out.getvalue() + err.getvalue()

    def test_results_of_the_solver_verify(self):
        for name in self.RESULTS:
            with self.subTest(name):
                code, checks, said = self.of_result(name)
                self.assertEqual(code, 0, said)
                self.assertRegex(said.splitlines()[-1], rf"^verified: {len(checks)} checks of {len(checks)}$")
                self.assertGreater(len(checks), 15)

    def test_what_is_not_verified_is_said(self):
        for name, part in (("collapse", "at large displacements"), ("slope", "displacement that joints have crept"),
                           ("continuously yielding", "plastic displacement"), ("wearing", "work of slip"),
                           ("creeping rock", "rock has crept")):
            self.assertRegex(self.of_result(name)[2], f"not verified: .*{part}")
        for name in "column", "chain":
            self.assertNotIn("not verified", self.of_result(name)[2])

    # The name of the check, the result, the dataset, where (a function of the file), and the value that is put there (of
    # the one that was).
    def mutations(self):
        def last(dataset, chosen):
            """The first item of the last state that is chosen, by the number of its row."""
            return lambda file: (len(file["/states/time"]) - 1, int(np.flatnonzero(chosen(file))[0]))

        def x(where):
            return lambda file: (*where(file), 0)

        def y(where):
            return lambda file: (*where(file), 1)

        def times(factor):
            return lambda old: old * factor

        def put(value):
            return lambda old: value

        def more(by):
            return lambda old: old + by

        def status(*wanted):
            return lambda file: np.isin(file["/states/contact_status"][-1], wanted)

        def at(*index):
            return lambda file: index
        here, gone = (lambda file: file["/states/zone_present"][-1] == 1), (lambda file: file["/states/zone_present"][-1] == 0)
        fixed = lambda file: file["/mesh/gridpoint_fixed"][:] == 3
        touching, stuck, slips = status(STUCK, SLIPPING), status(STUCK), status(SLIPPING)
        crept = lambda file: (3, int(np.argmax(np.abs(file["/states/crept"][3, :, 0]))), 0)
        yields = lambda file: (len(file["/states/time"]) - 1, int(np.argmax(np.abs(file["/states/plastic_strain"][-1, :, 0]))), 0)
        held = lambda file: (len(file["/states/time"]) - 1, int(np.argmax(np.abs(file["/states/reaction"][-1, :, 1]))), 1)
        rolls = lambda file: (len(file["/states/time"]) - 1, 1 + int(np.argmax(np.abs(file["/states/reaction"][-1, 1:, 0]))), 1)
        away = lambda file: tuple(int(i) for i in np.argwhere(file["/history/present"][:] == 0)[0])
        staged = lambda name: lambda file: int(np.argmax([bool(one.strip(b"\0")) for one in file[name][:]]))
        tried = lambda file: int(np.argmax(file["/safety/factor"][:] * (file["/safety/stands"][:] == 1)))
        s = "/states/"
        return [
            ("values are finite", "dilation", s + "slip", at(1, 0), put(np.nan)),
            ("zones have an area, counter-clockwise", "dilation", "/mesh/gridpoint_position", at(0, 0), put(50.0)),
            ("areas of a block's zones sum to its own", "dilation", "/blocks/area", at(0), times(1.0001)),
            ("normals of contacts are those of their edges", "dilation", "/mesh/contact_normal", at(0, 0), more(1e-3)),
            ("contacts are no longer than their edge", "dilation", "/mesh/contact_length", at(1), times(1.01)),
            ("contacts have a length", "dilation", "/mesh/contact_length", at(1), put(0.0)),
            ("zones are removed by their stage, and no others", "slope", s + "zone_present", last(s, here), put(0)),
            ("contacts are removed with the rock of a side", "slope", s + "contact_status", last(s, stuck), put(REMOVED)),
            ("displacements count from the in-situ equilibrium", "slope", s + "displacement", at(0, 3, 1), put(1e-6)),
            ("fixed gridpoints are where supports hold them", "slope", s + "displacement", y(last(s, fixed)), put(1e-6)),
            ("gridpoints on rollers move along them", "rollers", s + "displacement", rolls, more(1e-6)),
            ("relative displacements are those of the gridpoints", "slope", s + "relative_displacement",
             x(last(s, touching)), times(1.0001)),
            ("removed zones have no stress", "slope", s + "stress", x(last(s, gone)), put(1.0)),
            ("open and removed contacts carry no traction", "slope", s + "traction", x(last(s, status(REMOVED))), put(1.0)),
            ("displaced zones have an area, counter-clockwise", "collapse", s + "displacement", y(last(s, here)), put(900.0)),
            ("displaced elastic zones: stress is Hooke's of the stretch", "displaced", s + "stress", x(last(s, here)), times(1.001)),
            ("displaced gridpoints without contacts are in equilibrium", "displaced", s + "stress", x(last(s, here)), times(1.1)),
            ("displaced pieces of rock are in equilibrium with their contacts", "displaced", "/dynamics/contact_traction", at(-1, 0),
             times(1.01)),
            ("normals of moving contacts are unit vectors", "collapse", "/dynamics/contact_normal", at(-1, 0), more(1e-3)),
            ("moving contacts carry no more shear than the strongest joint", "collapse", "/dynamics/contact_traction", at(-1, 1),
             put(1e9)),
            ("stress of elastic zones is Hooke's", "slope", s + "stress", x(last(s, here)), times(1.0001)),
            ("stress of elastic zones is Hooke's", "slope", s + "displacement", at(-1, 40, 0), times(1.01)),
            ("stress of elastic zones is Hooke's", "creeping rock", s + "crept_strain", at(-1, 0, 0), times(1.01)),
            ("stresses at points have the zone's mean", "quadratic zones", s + "point_stress", at(0, 0, 1), times(1.0001)),
            ("stress at points of elastic zones is Hooke's", "quadratic zones", s + "point_stress", at(-1, 0, 1), times(1.0001)),
            ("stress of yielding zones is Hooke's, less plastic strain", "yield", s + "plastic_strain", yields, times(1.01)),
            ("stress of yielding zones is Hooke's, less plastic strain", "yield", s + "stress_zz",
             lambda file: yields(file)[:2], times(1.01)),
            ("stress is within Mohr and Coulomb's strength", "yield", s + "stress",
             lambda file: (*yields(file)[:2], 1), times(1.1)),
            ("nothing has crept or yielded at the in-situ equilibrium", "yield", s + "plastic_strain", at(0, 0, 0), put(1e-6)),
            ("normal traction is that of the springs' closing", "slope", s + "traction", x(last(s, touching)), times(1.0001)),
            ("normal traction is that of the springs' closing", "dilation", s + "dilation", at(-1, 0), times(1.0001)),
            ("normal traction is that of the springs' closing", "Barton-Bandis", s + "relative_displacement",
             at(-1, 0, 0), times(1.0001)),
            ("normal traction is that of the springs' closing", "slope", s + "crept", x(last(s, touching)), times(1.0001)),
            ("shear traction is that of the springs, less slip", "slope", s + "slip", last(s, slips), more(1e-6)),
            ("open contacts have a gap", "slope", s + "contact_status", last(s, stuck), put(OPEN)),
            ("gaps in situ are of open contacts alone", "dilation", s + "initial_gap", at(0), put(1e-6)),
            ("nothing has slipped, dilated or crept at the in-situ equilibrium", "dilation", s + "slip", at(0, 0), put(1e-6)),
            ("shear traction is within the strength", "slope", s + "traction", y(last(s, slips)), times(1.001)),
            ("normal traction is within the tensile strength", "slope", s + "traction", x(last(s, touching)), put(1e4)),
            ("sticking contacts are below their strength", "slope", s + "contact_status", last(s, slips), put(STUCK)),
            ("slipping contacts are at their strength", "slope", s + "contact_status", last(s, stuck), put(SLIPPING)),
            ("bonds of contacts that opened, or slipped with a residual strength, are broken", "residual",
             s + "bond_broken", at(-1, 0), put(0)),
            ("only joints that dilate have dilation", "slope", s + "dilation", last(s, touching), put(1e-6)),
            ("dilation ends", "dilation that ends", s + "dilation", at(-1, 0), times(2)),
            ("broken bonds stay broken", "residual", s + "bond_broken", at(0, 0), put(1)),
            ("dilation does not go back", "dilation", s + "dilation", at(2, 0), times(100)),
            ("slip dilates", "dilation", s + "slip", at(-1, 0), times(1.01)),
            ("only joints with Kelvin units or dashpots creep, and only in time", "dilation", s + "crept", at(1, 0, 0),
             put(1e-6)),
            ("crept displacement of a step is that of the Kelvin units and dashpots", "column", s + "crept", crept, times(1.0001)),
            ("crept displacement of a step is that of the Kelvin units and dashpots", "chain", s + "crept", crept, times(1.0001)),
            ("reactions hold the forces on fixed gridpoints, and there are no others", "slope", s + "reaction", held,
             times(1.0001)),
            ("reactions hold the forces on fixed gridpoints, and there are no others", "rollers", s + "reaction", rolls,
             times(1.0001)),
            ("forces are in equilibrium: unbalanced force ratio", "slope", "/mesh/contact_length",
             lambda file: int(np.argmin(file["/states/traction"][-1, :, 0])), times(1.01)),
            ("unbalanced force ratio is the reported one", "slope", "/equilibria/unbalanced_force_ratio", at(-1), times(0.99)),
            ("weight and tractions are held by reactions and ground", "slope", s + "reaction", held, times(2)),
            ("displacement of removed points is held", "opening", "/history/displacement", lambda f: (*away(f), 0), more(1e-6)),
            ("points are where there is rock", "opening", "/history/present", away, put(1)),
            ("histories are the states' displacements at the points", "slope", "/history/displacement", at(-1, 1, 0),
             times(1.0001)),
            ("report: unbalanced force ratio is within the tolerance", "slope", "/equilibria/unbalanced_force_ratio", at(1),
             put(1e-3)),
            ("report: contact force change is within the tolerance", "slope", "/equilibria/contact_force_change", at(1),
             put(1e-3)),
            ("report: work of loads is stored, dissipated or damped", "slope", "/equilibria/work_of_loads",
             lambda file: int(np.argmax(np.abs(file["/equilibria/work_of_loads"]))), times(1.01)),
            ("report: stored energy of a stage is that of its states", "slope", "/equilibria/stored_energy",
             lambda file: int(np.argmin(file["/equilibria/stored_energy"])), times(1.0001)),
            ("report: dissipated energy is not negative, implicit engine", "slope", "/equilibria/dissipated_energy", at(-1), put(-1)),
            ("times do not go back", "slope", "/history/time", at(-1), put(0.0)),
            ("times are within the schedule", "slope", "/history/time", at(-1), more(1e4)),
            ("times are within the schedule", "slope", "/equilibria/time", at(-1), more(1e4)),
            ("stages are those of the scene, in its order", "slope", "/history/event", staged("/history/event"), put(b"x")),
            ("stages are on their days", "slope", "/history/time", staged("/history/event"), more(1e-3)),
            ("stages are on their days", "slope", s + "time", staged(s + "event"), more(1e-3)),
            ("states have a row of the history", "slope", s + "time", at(-1), more(-1e-3)),
            ("monitoring points are those of the scene", "slope", "/history/point", at(0), put(b"x")),
            ("first readings are on their days", "slope", "/history/first_reading_row", at(0), put(6)),
            ("stable strength reduction factors are below the unstable ones", "factor of safety", "/safety/factor",
             at(0), put(60.0)),
            ("this run ended as its strength reduction factor says", "factor of safety", "/safety/stands", tried, put(0)),
            ("this run moved as far as its strength reduction factor says", "factor of safety", "/safety/largest_displacement", tried,
             times(1.001)),
            ("moments of a dynamic analysis have their states", "collapse", "/dynamics/time", at(0), more(0.5)),
            ("dynamics: work of loads is kinetic, stored, lost or damped", "collapse", "/dynamics/work_of_loads", at(-1),
             times(1.1)),
        ]

    def test_every_check_finds_a_wrong_value(self):
        found = set()
        for check, result, dataset, where, change in self.mutations():
            with self.subTest(check, dataset=dataset):
                copy = self.chain.new_folder() / "copy.h5"
                shutil.copyfile(self.result(result), copy)
                with h5py.File(copy, "r+", libver=("v110", "v110")) as file:
                    index = where(file)
                    old = file[dataset][index]
                    file[dataset][index] = change(old)
                    self.assertNotEqual(str(old), str(file[dataset][index]))
                code, checks, said = self.verified(copy)
                copy.unlink()
                self.assertEqual(code, 3, said)
                self.assertEqual(checks[check][0], "FAILED", said)
                self.assertTrue(any(dataset in where for verdict, where in checks.values() if verdict == "FAILED"), said)
                found.add(check)
        shown = set()
        for name in self.RESULTS:
            shown |= set(self.of_result(name)[1])
        self.assertEqual(shown - found, set(), "checks that no wrong value is tried on")

    def test_a_block_that_has_rotated_before(self):
        """What a first rotation a of a block makes of a second one b is left out: the strain -a b, of the whole block; nothing larger."""
        section = types.SimpleNamespace(stress_of=lambda strain: 3.0 * strain, rigid_block=np.zeros(2, bool), zone_block=np.array([0, 0, 1]),
                                        area=np.array([1.0, 2.0, 1.0]))
        b = np.array([0.1, 0.1, 0])
        rotation = np.moveaxis(np.array([[np.cos(b), -np.sin(b)], [np.sin(b), np.cos(b)]]), 2, 0)
        verification = self.script.Verification.__new__(self.script.Verification)
        verification.section = section
        for a, is_left_out in (0.002, True), (-0.004, True), (0.1, False):
            stress = -3.0 * a * b[:, None, None] * np.eye(2)
            stress[2, 0, 1] = stress[2, 1, 0] = 7e-5  # of the other block, which has not rotated
            left = verification.without_first_rotation(stress, rotation)
            self.assertLess(abs(np.abs(left[:2]).max() - (0 if is_left_out else 0.95 * np.abs(stress[:2]).max())), 1e-15)
            np.testing.assert_array_equal(left[2], stress[2])

    def test_displaced_zones_without_a_shape(self):
        """Displacements that are no numbers, or make zones flat, fail checks in any state at large displacements."""
        for state in (1, -1):
            for wrong in (np.nan, 0.0):
                copy = self.chain.new_folder() / "copy.h5"
                shutil.copyfile(self.result("displaced"), copy)
                with h5py.File(copy, "r+", libver=("v110", "v110")) as file:
                    place = file["/mesh/gridpoint_position"][:]
                    file["/states/displacement"][state] = -place + wrong  # all in one point
                code, checks, said = self.verified(copy)
                self.assertEqual(code, 3, said)
                self.assertEqual(checks["displaced zones have an area, counter-clockwise"][0], "FAILED", said)

    def test_slip_by_rounding_in_situ(self):
        """The solver may find a contact at its strength by a last digit beyond it."""
        copy = self.chain.new_folder() / "copy.h5"
        shutil.copyfile(self.result("slope"), copy)
        with h5py.File(copy, "r+", libver=("v110", "v110")) as file:
            traction, edge = file["/states/traction"][0, :, 1], file["/mesh/contact_edge"][:]
            slip = np.spacing(np.abs(traction)) / file["/equivalent/shear_stiffness"][:][edge]
            file["/states/slip"][0] = slip
        self.assertGreater(slip.max(), 0)
        code, _, said = self.verified(copy)
        self.assertEqual(code, 0, said)

    def test_a_run_without_equilibrium(self):
        """What came before it verifies; without an equilibrium in situ there is little to verify."""
        floor = [[0, 0], [6, 0], [6, 3], [0, 3]]
        for text, in_situ in (four_blocks(stages=[[UPPER_LEFT], [floor]]), False), (four_blocks(bases=()), True):
            joints = self.chain.joints(text)
            done = self.chain.answer("demsolve", joints, "-o", joints.with_name("r.h5"))
            self.assertEqual(done.returncode, 3, done.stderr)
            code, checks, said = self.verified(joints.with_name("r.failed.h5"))
            self.assertEqual(code, 0, said)
            self.assertEqual("no equilibrium in situ" in said, in_situ, said)
            self.assertEqual("stress of elastic zones is Hooke's" in checks, not in_situ)
            if not in_situ:
                failed = joints.with_name("r.failed.h5")
        with h5py.File(failed, "r+", libver=("v110", "v110")) as file:  # as if a part of the last load had an equilibrium
            for name in [*file["/equilibria"]]:
                name = "/equilibria/" + name
                old, attributes = file[name][:], dict(file[name].attrs)
                del file[name]
                row = {"/equilibria/time": file["/states/time"][-1:], "/equilibria/unbalanced_force_ratio": old[-1:] / 2}
                file[name] = np.concatenate([old, row.get(name, old[-1:])])
                file[name].attrs.update(attributes)
        code, _, said = self.verified(failed)
        self.assertEqual(code, 0, said)

    def test_a_run_that_fails_after_a_stage(self):
        """It keeps the state after the stage once more, as its last one. The history has one row for both, and another one before the
        stage, of the same time."""
        copy = self.chain.new_folder() / "copy.h5"
        shutil.copyfile(self.result("slope"), copy)
        with h5py.File(copy, "r+", libver=("v110", "v110")) as file:
            event, rows = file["/states/event"].asstr()[:], file["/history/event"].asstr()[:]
            state = next(i for i, name in enumerate(event) if name)
            kept = {"states": [*range(state + 1), state], "history": [*range(list(rows).index(event[state]) + 1)]}
            counts = {"states": len(event), "history": len(rows)}
            for group, chosen in kept.items():
                for name, dataset in [*file[group].items()]:
                    if dataset.shape[:1] == (counts[group],):
                        values, attributes = dataset[:][chosen], dict(dataset.attrs)
                        values = np.where(np.arange(len(chosen)) > state, b"", values) if name == "event" and group == "states" else values
                        del file[group][name]
                        file[group].create_dataset(name, data=values.astype(dataset.dtype) if name != "event" else list(values))
                        file[group][name].attrs.update({key: value for key, value in attributes.items() if key in ("units", "description")})
        self.assertEqual(self.verified(copy)[1]["histories are the states' displacements at the points"][0], "ok")

    def test_it_runs_as_a_program(self):
        good = self.result("column")
        done = self.chain.answer("jointverify", good)
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
        self.assertRegex(done.stdout, r"(?m)^verified: (\d+) checks of \1$")
        done = self.chain.answer("jointverify", "--help")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        for code in "0", "2", "3", "4", "5":
            self.assertRegex(done.stdout, f"(?m)^  {code}  ")
        for arguments in ((), ("--whatever",), (good, good)):
            done = self.chain.answer("jointverify", *arguments)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertIn("usage: jointverify RESULT.h5", done.stderr)
        done = self.chain.answer("jointverify", self.chain.folder / "none.h5")
        self.assertEqual(done.returncode, 4)
        self.assertIn("none.h5", done.stderr)
        done = self.chain.answer("jointverify", good.with_name("joints.h5"))
        self.assertEqual(done.returncode, 2)
        self.assertIn('expected a "jointcreep result" file', done.stderr)

    def refused(self, change, *parts):
        """A copy that is changed is refused with code 2, and a message that has these parts."""
        copy = self.chain.new_folder() / "copy.h5"
        shutil.copyfile(self.result("dilation"), copy)
        with h5py.File(copy, "r+", libver=("v110", "v110")) as file:
            change(file)
        code, _, said = self.verified(copy)
        self.assertEqual(code, 2, said)
        self.assertEqual(len(said.strip().splitlines()), 1, said)
        for part in ("copy.h5", *parts):
            self.assertIn(part, said)

    def test_wrong_datasets_are_refused_by_name(self):
        with h5py.File(self.result("dilation")) as file:
            names = [f"/{group}/{name}" for group in ("states", "mesh", "equivalent", "history", "equilibria")
                     for name in file[group]]

        def replaced(name, values):
            def change(file):
                del file[name]
                file[name] = values
            return change
        for name in "/states/slip", "/states/reaction", "/mesh/zone_gridpoint", "/equivalent/law", "/history/displacement":
            self.assertIn(name, names)
            self.refused(lambda file, name=name: file.__delitem__(name), name)
            self.refused(replaced(name, "text"), name)
            self.refused(replaced(name, np.zeros((3, 5, 7))), name)
            self.refused(replaced(name, np.zeros(0)), name)
            self.refused(lambda file, name=name: (file.__delitem__(name), file.create_group(name)), name)
        self.refused(lambda file: file["/mesh/zone_gridpoint"].__setitem__((0, 0), 10**6), "/mesh/zone_gridpoint[0, 0]")
        self.refused(lambda file: file["/states/contact_status"].__setitem__((0, 0), -1), "/states/contact_status[0, 0]")

    def test_wrong_scenes_are_refused(self):
        with h5py.File(self.result("dilation")) as file:
            text = file["/scene"].asstr()[0]

        def scene_is(new):
            def change(file):
                del file["/scene"]
                file.create_dataset("/scene", data=[new], dtype=h5py.string_dtype("utf-8", max(1, len(new.encode()))))
            return change
        for new in ("", "x = [", text.replace("gravity_m_per_s2 = 0", 'gravity_m_per_s2 = "much"'),
                    text.replace("[[rock]]", "[rock]"), text.replace('name = "steel"', 'name = "lead"'),
                    text.replace("[[0, 0], [4, 0.4], [8, 0.8], [10, 1]]", "[[0, 0], 4]"),
                    text.replace("traction_MPa = [0, -1]", "traction_MPa = 1"),
                    text.replace("[[boundary]]", "[[border]]"), "a = " + "[" * 5000):
            self.assertNotEqual(new, text)
            self.refused(scene_is(new), "/scene" if "border" not in new else "/mesh/side_boundary")

    def test_damaged_files(self):
        """As for the programs: the same answer, or a refusal that names the file."""
        good = self.result("residual")
        for case in range(60):
            damage = DAMAGE[case % len(DAMAGE)]
            with self.subTest(damage.__name__, case=case):
                copy = self.chain.new_folder() / "copy.h5"
                shutil.copyfile(good, copy)
                damage(copy, random.Random(case))
                done = in_a_copy(self.chain.programs / "jointverify", copy)
                code, said = done.returncode, done.stdout + done.stderr
                self.assertIn(code, (2, 4) if damage in MUST_BE_REFUSED else (0, 2, 3, 4), said)
                if code in (2, 4):
                    self.assertIn("jointverify: " + str(copy), said)


if __name__ == "__main__":
    main()
