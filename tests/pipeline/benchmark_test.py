"""The benchmark of the shiplock: frozen networks, and its linear variants by two programs that share no code."""

import json
import sys

import numpy as np

import finite_elements
from chain import ChainTest, datasets, main

FOLDER = "data/shiplock/benchmark"
COARSE = 16  # size of zones [m]
AGREED = 1e-4  # of the largest displacement: difference of two programs


def numbers_of(data):
    """All numbers of what JSON has, in order, and everything else."""
    numbers, rest = [], []

    def note(one):
        if isinstance(one, dict):
            for key, value in one.items():
                rest.append(key)
                note(value)
        elif isinstance(one, list):
            rest.append(len(one))
            for value in one:
                note(value)
        elif isinstance(one, (int, float)):
            numbers.append(one)
        else:
            rest.append(one)

    note(data)
    return np.array(numbers, float), rest


def values_of(rows):
    """Displacements of rows of a table [mm]."""
    return np.array([[float(value) for key, value in row.items() if key.endswith("_mm")] for row in rows])


def area_of(polygon):
    x, y = np.array(polygon).T
    return np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) / 2


def corners_of(network):
    """All places of a network that are corners of blocks."""
    lines = [network["outline_m"], *(layer["outline_m"] for layer in network["layers"]),
             *(polygon for stage in network["stages"] for polygon in stage["remove_m"]),
             *(joint["corners_m"] for joint in network["joints"])]
    return {tuple(corner) for line in lines for corner in line}


class Benchmark(ChainTest):
    @classmethod
    def setUpClass(cls):
        sys.path.insert(0, str(cls.chain.source / "pipelines" / "shiplock"))
        cls.addClassCleanup(sys.path.remove, str(cls.chain.source / "pipelines" / "shiplock"))
        import benchmark
        cls.benchmark, cls.folder = benchmark, cls.chain.source / FOLDER
        cls.section = benchmark.read(cls.folder / "section.json")

    def network(self, number):
        return self.benchmark.read(self.folder / f"network-{number}.json")

    def result(self, number, variant, **options):
        """Path of the result of a network."""
        folder = self.chain.new_folder()
        scene = self.benchmark.write_scene(self.folder, number, variant, folder, **options)
        return self.solved(scene)

    def solved(self, scene):
        """Path of the result of a scene, in its folder."""
        folder = scene.parent
        self.chain.run("jointgen", scene, folder / "network.h5")
        self.chain.run("strength-averaging", folder / "network.h5", folder / "joints.h5")
        return self.chain.run("demsolve", folder / "joints.h5", folder / "result.h5")

    def reference(self):
        """Rows of reference.csv."""
        return self.benchmark.rows_in(self.folder / "reference.csv")


class Frozen(Benchmark):
    def test_files_are_those_of_the_scene(self):
        """Places to 1 mm, of which they are rounded; all else as it is."""
        folder = self.chain.new_folder()
        self.benchmark.freeze(self.chain.programs, self.chain.source / "data/shiplock/section-a.toml", folder)
        names = sorted(path.name for path in folder.iterdir())
        self.assertEqual(names, [*(f"network-{n}.json" for n in range(5)), "section.json"])
        for name in names:
            found, wanted = (numbers_of(json.loads((one / name).read_text())) for one in (folder, self.folder))
            self.assertEqual(found[1], wanted[1], name)
            np.testing.assert_allclose(found[0], wanted[0], rtol=1e-5, atol=1.01e-3, err_msg=name)

    def test_polylines_are_edges_of_blocks(self):
        """Cut again nothing moves, and edges have the joints, lengths and materials of the file."""
        for number in range(5):
            with self.subTest(number):
                network = self.network(number)
                folder = self.chain.new_folder()
                scene = self.benchmark.write_scene(self.folder, number, "slip", folder)
                self.chain.run("jointgen", scene, folder / "network.h5")
                data = datasets(self.chain.run("strength-averaging", folder / "network.h5", folder / "joints.h5"))
                self.assertLess(data["/cutting/largest_move"][0], 1e-6)
                self.assertEqual(len(data["/vertices/position"]), len(corners_of(network)))
                self.assertGreater(data["/cutting/shortest_edge"][0], 0.8)
                is_joint = data["/edges/kind"] == 1
                ends = data["/vertices/position"][data["/edges/vertex"][is_joint]]
                length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
                sets = data["/joints/set"][data["/edges/joint"][is_joint]]
                names = data["/names/joint_set"]
                for material in network["joint_materials"]:
                    wanted = sum(np.sum(np.linalg.norm(np.diff(one["corners_m"], axis=0), axis=1))
                                 for one in network["joints"] if one["material"] == material["name"])
                    own = sets == list(names).index(f"joints {material['name']}")
                    self.assertAlmostEqual(length[own].sum(), wanted, delta=1e-6, msg=material["name"])
                    for key, (name, unit) in self.benchmark.MATERIAL.items():
                        values = np.ravel(data[f"/equivalent/{name}"][is_joint][own]) / unit
                        np.testing.assert_allclose(values, material[key], rtol=1e-9, err_msg=key)
                for s, stage in enumerate(network["stages"]):
                    area = sum(area_of(polygon) for polygon in stage["remove_m"])
                    self.assertAlmostEqual(data["/blocks/area"][data["/blocks/stage"] == s].sum(), area, delta=1e-4)

    def test_a_layer_with_a_hole_is_refused(self):
        """A square block inside a larger one: the larger one alone has a hole, the smaller one and both have none."""
        places = np.array([[0, 0], [9, 0], [9, 9], [0, 9], [3, 3], [6, 3], [6, 6], [3, 6]], float)
        file = {"/edges/vertex": np.array([[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4]]),
                "/edges/block": np.array([[0, -1]] * 4 + [[1, 0]] * 4)}
        self.assertEqual(self.benchmark.loops_around(np.array([True, True]), file, places), [[0, 1, 2, 3]])
        self.assertEqual(self.benchmark.loops_around(np.array([False, True]), file, places), [[4, 5, 6, 7]])
        with self.assertRaisesRegex(SystemExit, "hole"):
            self.benchmark.loops_around(np.array([True, False]), file, places)


class FiniteElements(Benchmark):
    """The independent program, by closed forms and beside the programs."""

    def test_column(self):
        """A column between smooth walls with two joints; its upper half is excavated. The rest rises by the weight of that over the
        stiffness of rock, joint and Kelvin unit, at a point by its share of the rock below."""
        rock = {"name": "rock", "density_kg_per_m3": 2500, "youngs_modulus_GPa": 10, "poissons_ratio": 0.25}
        gravity, modulus, weight = 10, 12e9, 2500 * 10 * 10  # modulus: of rock that cannot widen, E (1 - nu) / ((1 + nu)(1 - 2 nu))
        section = {
            "rocks": [rock], "rock": "rock", "gravity_m_per_s2": gravity, "ground_m": [[0, 20], [4, 20]],
            "stages": [{"name": "top", "day": 10}], "end_day": 60,
            "in_situ_stress": [{"depth_m": h, "compression_xx_MPa": 0.3, "compression_yy_MPa": 0.025 * h, "shear_xy_MPa": 0}
                               for h in (0, 20)],
            "boundaries": [{"from_m": [0, 0], "to_m": [4, 0], "fix": "y"}, {"from_m": [0, 0], "to_m": [0, 20], "fix": "x"},
                           {"from_m": [4, 0], "to_m": [4, 20], "fix": "x"}],
            "points": [{"name": "low", "at_m": [1.5, 2]}, {"name": "high", "at_m": [2.5, 8]}]}
        network = {
            "layers": [], "stages": [{"name": "top", "remove_m": [[[0, 10], [4, 10], [4, 20], [0, 20]]]}],
            "joint_materials": [{"name": "joint", "normal_stiffness_MPa_per_m": 500, "shear_stiffness_MPa_per_m": 200,
                                 "normal_kelvin_stiffness_MPa_per_m": 400, "normal_kelvin_viscosity_MPa_day_per_m": 8000,
                                 "shear_kelvin_stiffness_MPa_per_m": 100, "shear_kelvin_viscosity_MPa_day_per_m": 2000}],
            "joints": [{"id": 0, "set": "J", "material": "joint", "corners_m": [[0, y], [4, y]]} for y in (4.0, 14.0)]}
        x, y = np.linspace(0, 4, 3), np.linspace(0, 20, 11)
        corners = np.array([[(x[i + a], y[j + b]) for a, b in half] for i in range(2) for j in range(10)
                            for half in (((0, 0), (1, 0), (1, 1)), ((0, 0), (1, 1), (0, 1)))])
        for step, last in ((None, 0), (5, weight / 400e6 * (1 - np.exp(-50 * 400 / 8000)))):
            days, found = finite_elements.Model(section, network, corners).history(step)
            self.assertEqual(days.tolist(), [10, 60])
            joint = weight / 500e6
            np.testing.assert_allclose(1e3 * found[:, :, 0], 0, atol=1e-9)
            np.testing.assert_allclose(found[:, 0, 1], 2 * weight / modulus, rtol=1e-9)
            np.testing.assert_allclose(found[:, 1, 1], 8 * weight / modulus + joint + np.array([0, last]), rtol=1e-9)

    def test_joint_off_the_mesh_is_refused(self):
        section = self.benchmark.read(self.folder / "section.json")
        corners = np.array([[[0, 0], [4, 0], [0, 4]]], float)
        with self.assertRaisesRegex(ValueError, "joint 0: no sides of the mesh"):
            finite_elements.Model(section, self.network(0), corners)

    def test_elastic(self):
        """Network 0: the programs compute the reference, and the other program does with the first stages."""
        result = self.result(0, "elastic", zone_size=8)
        data = datasets(result)
        rows = self.benchmark.rows_of(self.section, {}, data["/history/time"], data["/history/event"], data["/history/displacement"])
        wanted = self.benchmark.reference_of(self.folder, 0, "elastic")
        self.assertEqual([row["event"] for row in wanted], [*(stage["name"] for stage in self.section["stages"]), "end"])
        self.assertEqual([(row["day"], row["event"]) for row in rows], [(row["day"], row["event"]) for row in wanted])
        largest = np.abs(values_of(wanted)).max()
        self.assertGreater(largest, 50)
        np.testing.assert_allclose(values_of(rows), values_of(wanted), rtol=0, atol=1e-5 * largest)
        model = finite_elements.Model(self.section, self.network(0), finite_elements.corners_of(result))
        _, found = model.history(stages=2)
        wanted = values_of(wanted)[:2]
        np.testing.assert_allclose(1e3 * found.reshape(2, -1), wanted, rtol=0, atol=AGREED * np.abs(wanted).max())

    def test_creep(self):
        """Network 0, with all slopes excavated at once and then all chambers: both programs, elastic and creeping."""
        section = {**self.section, "stages": [{"name": "slopes", "day": 100}, {"name": "chambers", "day": 300}], "end_day": 400,
                   "points": [{**point, "first_reading_day": 1} for point in self.section["points"]]}
        stages = self.network(0)["stages"]
        network = {**self.network(0), "stages": [{"name": name, "remove_m": [one for stage in some for one in stage["remove_m"]]}
                                                 for name, some in (("slopes", stages[:5]), ("chambers", stages[5:]))]}
        folder = self.chain.new_folder()
        (folder / "scene.toml").write_text(self.benchmark.scene_of(section, network, "creep", zone_size=COARSE, creep_step=14))
        (folder / "joints.csv").write_text(self.benchmark.joints_csv(network))
        data = datasets(self.solved(folder / "scene.toml"))
        rows = [*np.flatnonzero(data["/history/event"] != ""), -1]
        model = finite_elements.Model(section, network, finite_elements.corners_of(folder / "result.h5"))
        days, found = model.history(14)
        self.assertEqual(days.tolist(), [100, 300, 400])
        wanted = data["/history/displacement"][rows]
        largest = np.abs(wanted).max()
        self.assertGreater(largest, 0.07)
        np.testing.assert_allclose(found, wanted, rtol=0, atol=AGREED * largest)

    def test_tables(self):
        """What both programs computed of network 0 with all stages agrees."""
        for variant in ("elastic", "creep"):
            found = self.benchmark.rows_in(self.folder / f"finite-elements-{variant}.csv")
            wanted = self.benchmark.reference_of(self.folder, 0, variant)
            self.assertEqual([row["event"] for row in found], [row["event"] for row in wanted])
            np.testing.assert_allclose(values_of(found), values_of(wanted), rtol=0, atol=AGREED * np.abs(values_of(wanted)).max())


class Page(Benchmark):
    def test_numbers(self):
        page = self.chain.text("docs/benchmark.md")
        rows = []
        for number in range(self.benchmark.NETWORKS):
            joints = [one["corners_m"] for one in self.network(number)["joints"]]
            length = sum(np.linalg.norm(np.diff(line, axis=0), axis=1).sum() for line in joints)
            rows.append(f"| {number} | {len(joints)} | {sum(map(len, joints)) - len(joints)} | {length:.0f} | "
                        f"{len(corners_of(self.network(number)))} |")
        self.assertIn("\n".join(rows), page)
        for variant in self.benchmark.VARIANTS:
            self.assertIn("\n" + self.benchmark.table_of(self.folder, variant) + "\n", page)
            self.assertRegex(page, rf"\| `{variant}` \| [^|]* \| {self.benchmark.TOLERANCE[variant]:g} \|")

    def test_reference_has_the_runs(self):
        """Each run with each stage; and refinement changes less than the tolerance."""
        for run in self.benchmark.RUNS:
            rows = self.benchmark.reference_of(self.folder, *run)
            self.assertEqual([row["event"] for row in rows], [*(one["name"] for one in self.section["stages"]), "end"], run)
            number, variant, *_ = run
            wanted = values_of(self.benchmark.reference_of(self.folder, number, variant))
            difference = np.abs(values_of(rows) - wanted).max() / np.abs(wanted).max()
            self.assertLess(difference, self.benchmark.TOLERANCE[variant], run)
        self.assertEqual(len(self.reference()), 18 * len(self.benchmark.RUNS))

    def test_compare(self):
        """A table with one displacement changed: where and by how much is said, and whether it is within the tolerance."""
        text = (self.folder / "finite-elements-elastic.csv").read_text()
        path = self.chain.new_folder() / "history.csv"
        value = float(text.strip().split("\n")[-1].split(",")[2])
        for change, verdict in ((0.2, "within 0.005"), (2, "beyond 0.005")):
            lines = text.strip().split("\n")
            cells = lines[-1].split(",")
            lines[-1] = ",".join([*cells[:2], f"{value + change}", *cells[3:]])
            path.write_text("\n".join(lines))
            said = self.benchmark.comparison(path, self.folder, 0, "elastic")
            self.assertIn(f"N232: {change:.4f} mm\nN215: 0.0000 mm", said)
            self.assertIn(verdict, said)
        path.write_text("\n".join(lines[:-1]))
        with self.assertRaisesRegex(ValueError, 'expected a row "end"'):
            self.benchmark.comparison(path, self.folder, 0, "elastic")
        with self.assertRaisesRegex(ValueError, "no network 3 of the variant slip"):
            self.benchmark.comparison(path, self.folder, 3, "slip")


if __name__ == "__main__":
    main()
