"""The shiplock's scene, its variants and the page: sources of every value, a coarse run, tables as their scripts write them."""

import datetime
import math
import re
import subprocess
import sys
import tomllib
import unittest.mock

import h5py
import numpy

from chain import ChainTest, changed, datasets, main
from jointcreep import scene_keys, study_file

TAG = re.compile(r"# (paper|published|inferred|assumed)\b")
SCENE = "data/shiplock/section-a.toml"


class Shiplock(ChainTest):
    def setUp(self):
        self.folder = self.chain.source / "pipelines" / "shiplock"
        sys.path.insert(0, str(self.folder))
        self.addCleanup(sys.path.remove, str(self.folder))

    def variant(self, *options):
        """Text of a variant of the scene."""
        path = self.chain.new_folder() / "scene.toml"
        done = subprocess.run([sys.executable, self.folder / "variant.py", self.chain.source / SCENE, *options, "-o", path],
                              capture_output=True, text=True, timeout=100)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return path.read_text()

    def test_every_value_says_its_source(self):
        for path in sorted((self.chain.source / "data" / "shiplock").glob("*.toml")):
            for number, line in enumerate(path.read_text().split("\n"), 1):
                if re.match(r"\w+ = ", line):
                    self.assertRegex(line, TAG, f"{path.name}, line {number}")

    def test_scene(self):
        """The dates, stages and points that the paper has; weight as vertical stress; the horizontal one by its law."""
        scene = tomllib.loads(self.chain.text(SCENE))
        self.assertEqual(len(scene["stage"]), 17)
        self.assertEqual(len(scene["point"]), 12)
        self.assertEqual((scene["schedule"]["start"].year, scene["stage"][-1]["date"].year), (1994, 1999))
        self.assertTrue(all(a["date"] < b["date"] for a, b in zip(scene["stage"], scene["stage"][1:])))
        targets = tomllib.loads(self.chain.text("data/shiplock/targets.toml"))
        self.assertEqual([point["name"] for point in targets["point"]], [point["name"] for point in scene["point"]])
        levels = scene["in_situ_stress"]["profile"]
        density = {rock["name"]: rock["density_kg_per_m3"] for rock in scene["rock"]}
        for level in levels:
            h = level["depth_m"]
            weight = 9.81e-6 * (density["cover"] * min(h, 17) + density["weak"] * min(max(h - 17, 0), 15)
                                + density["fresh"] * max(h - 32, 0))
            self.assertAlmostEqual(level["compression_yy_MPa"], weight, delta=6e-5)
            self.assertAlmostEqual(level["compression_xx_MPa"], 3 * (1 - math.exp(-h / 20)) + 0.022 * h, delta=6e-5)
        tables = {("fresh", 0): (690, 280), ("weathered", 0): (240, 96)}
        for material in scene["joint_material"]:
            rock, k = re.fullmatch(r"(\w+), k ([\d.]+)", material["name"]).groups()
            wanted = (*tables[rock, 0], 480, 57600, 1400, 168000)
            keys = ("normal_stiffness_MPa_per_m", "shear_stiffness_MPa_per_m", "normal_kelvin_stiffness_MPa_per_m",
                    "normal_kelvin_viscosity_MPa_day_per_m", "shear_kelvin_stiffness_MPa_per_m",
                    "shear_kelvin_viscosity_MPa_day_per_m")
            for key, value in zip(keys, wanted):
                self.assertAlmostEqual(material[key] * float(k) / value, 1, delta=1e-5, msg=f"{material['name']} {key}")
        sets = {one["name"]: one for one in scene["joint_set"]}
        import study
        for name, spacing in (("J1", 6), ("J2", 6), ("J3", 8), ("J4", 12)):
            self.assertAlmostEqual(sets[name]["spacing"]["mean_m"], spacing * study.TUNED, delta=1e-9)
        for name, one in sets.items():
            materials = {"fresh": one["material"], **{each["rock"]: each["material"] for each in one["material_in"]}}
            self.assertEqual(materials, {rock: f"{of}, k {one['persistence']}" for rock, of in
                                         (("fresh", "fresh"), ("weak", "weathered"), ("cover", "weathered"))}, name)

    def test_variants_are_scenes(self):
        """Each choice of the study changes the scene, and what it makes is one; section B-B too."""
        import study
        own = tomllib.loads(self.chain.text(SCENE))
        network = self.chain.network(self.chain.text(SCENE))
        for options in [["--section-b"], ["--monitoring-lines"], *(choice[2] for name, choice in study.CHOICES.items() if name != "scene")]:
            with self.subTest(options):
                options = [*options, network] if options == ["--realized"] else options
                text = self.variant(*options)
                self.assertNotEqual(tomllib.loads(text), own)
                self.chain.network(text)

    def test_what_variants_change(self):
        self.assertEqual(self.variant(), self.chain.text(SCENE))
        own, text = tomllib.loads(self.chain.text(SCENE)), self.variant("--stiffness-times", "2")
        new = tomllib.loads(text)
        for one, other in zip(own["joint_material"], new["joint_material"]):
            for key, value in one.items():
                factor = 2 if "stiffness" in key or "viscosity" in key else None
                self.assertEqual(other[key], value * factor if factor else value)
        self.assertEqual({**own, "joint_material": 0}, {**new, "joint_material": 0})
        by_rock = {one["name"]: one for one in tomllib.loads(self.variant("--table-2", "by rock"))["joint_material"]}
        self.assertAlmostEqual(by_rock["fresh, k 0.2"]["shear_kelvin_stiffness_MPa_per_m"], 1400 / 0.2)
        self.assertAlmostEqual(by_rock["weathered, k 0.2"]["shear_kelvin_stiffness_MPa_per_m"], 480 / 0.2)
        bridges = tomllib.loads(self.variant("--rule", "bridges"))
        self.assertEqual(bridges["averaging"]["stiffness"], "lower bound")
        self.assertAlmostEqual(bridges["joint_material"][0]["normal_stiffness_MPa_per_m"], 690)
        lower = tomllib.loads(self.variant("--section-b"))
        self.assertEqual([point["name"] for point in lower["point"]][:6], ["N212", "N195", "N180", "N165", "N150", "N139"])
        floor = min(y for stage in lower["stage"] for polygon in stage["remove_m"] for _, y in polygon)
        self.assertEqual(floor, 92.2)

    def test_stiffness_by_the_realized_persistence(self):
        """Set by set, where a set has its persistence alone: K and creep of its materials times k over that of the network."""
        network = self.chain.network(self.chain.text(SCENE), "--realization", "3")
        data, own = datasets(network), tomllib.loads(self.chain.text(SCENE))
        new = {one["name"]: one for one in tomllib.loads(self.variant("--realized", network))["joint_material"]}
        for name, k in (("J1", 0.25), ("J4", 0.15)):
            lines = numpy.flatnonzero(data["/joints/set"] == list(data["/names/joint_set"]).index(name))
            traces = numpy.isin(data["/traces/joint"], lines)
            length = [sum(math.dist(a, b) for a, b in zip(data[f"/{table}/from"][rows], data[f"/{table}/to"][rows]))
                      for table, rows in (("joints", lines), ("traces", traces))]
            for one in own["joint_material"]:
                if one["name"].endswith(f"k {k}"):
                    for key, value in one.items():
                        factor = k * length[0] / length[1] if "stiffness" in key or "viscosity" in key else None
                        if factor:
                            self.assertAlmostEqual(new[one["name"]][key] / value, factor, delta=1e-9)
                        else:
                            self.assertEqual(new[one["name"]][key], value)
            self.assertTrue(0.5 < length[1] / length[0] / k < 1.5)

    def test_monitoring_lines(self):
        """Inclinometers behind the crests, extensometers into the walls; the same on both sides."""
        lines = {one["name"]: one for one in tomllib.loads(self.variant("--monitoring-lines"))["monitoring_line"]}
        self.assertEqual(sorted(lines), ["extensometer N", "extensometer S", "inclinometer N", "inclinometer S"])
        for name, line in lines.items():
            other = lines[name[:-1] + ("S" if name.endswith("N") else "N")]
            for end in ("from_m", "to_m"):
                self.assertEqual([-line[end][0], line[end][1]], other[end])
        self.assertEqual(math.dist(lines["inclinometer N"]["from_m"], lines["inclinometer N"]["to_m"]), 120)
        self.assertEqual(math.dist(lines["extensometer N"]["from_m"], lines["extensometer N"]["to_m"]), 30)

    def test_rows_of_the_tuning(self):
        """Two networks and three points, of which the first is a crest."""
        import tuning
        def result(*totals):
            return {"names": ["N232", "N215", "S160"], "days": [0.0, 100.0, 2025.0], "total": [[0.0] * 3, [20.0] * 3, list(totals)],
                    "first": [100] * 3, "there": [True] * 3, "start": "1994-06-15", "zones": 9}
        point = {"N232": {"crest": True}, "N215": {}, "S160": {}}
        targets = {"total_mm": [60, 90], "recorded_mm": [20, 40], "point": point, "end_of_record": datetime.date(1999, 12, 31)}
        results = [result(44.0, 60.0, 100.0), result(46.0, 50.0, 80.0), {"failed": "falls"}]
        cells = [cell.strip() for cell in tuning.row_of("spacings times 2", results, targets, [1, 2]).split("|")[1:-1]]
        # medians 55 and 90, records 35 and 70: squares of -4/3, 1, 0.5 and 4
        self.assertEqual(cells[:2], ["spacings times 2", "2"])
        self.assertEqual(cells[2].split(" ± ")[0], f"{(16 / 9 + 1 + 0.25 + 16) / 4:.2f}")
        self.assertEqual(cells[3:], ["72.5 (55.0 to 90.0; 24.7)", "N215 55.0", "52.5 (35.0 to 70.0; 24.7)", "S160 70.0", "N232 45.0",
                                     "0 of 2 (0 to 84 %)"])
        both = result(80.0, 62.0, 75.0)
        both["total"][1] = [30.0, 30.0, 40.0]
        self.assertTrue(tuning.row_of("", [both], targets, [1, 2]).endswith("| 1 of 1 (3 to 100 %) |"))
        self.assertIn("| 0 | falls |", tuning.row_of("", results[2:], targets, [1, 2]))

    def test_facts_of_the_networks(self):
        """Of three networks whose numbers are easy: medians, standard deviations, and words that have a direction."""
        import facts
        names = ["N232", "N215", "N170", "N160", "S215", "S160"]
        def network(shift):
            total = numpy.array([50.0, 62, 70, 85, 61, 80]) + shift
            return {"names": names, "pier": [20 + shift, -10.0], "tension": [0.1, 0.01, 2e6], "total": total, "recorded": total - 40,
                    "other": [30.0 + shift, 50.0], "after": [0.5] * 6, "before": [1.0, 2, 3, 4, 5, 6 + shift]}
        targets = {"total_mm": [60, 90], "recorded_mm": [20, 40], "wall_top_limit_mm": 50, "slope_top_limit_mm": 80, "after_1999_mm": 5,
                   "point": {"N232": {"crest": True}}}
        text = facts.markdown([network(-2.0), network(0.0), network(2.0)], targets)
        self.assertRegex(text, r"total: the median nearest to an end of 60-90 mm is that of S215, 61\.0 mm, with a standard error of 1\.\d mm")
        self.assertIn("recorded: the median nearest to an end of 20-40 mm is that of N160, 45.0 mm", text)
        self.assertIn("the largest total of wall tops is 85 mm; the published limit, by another model, is 50 mm", text)
        self.assertIn("the largest total of all other points is 70 mm; the published limit, by another model, is 80 mm", text)
        self.assertIn("moved by 1 to 6 mm (medians; at most 8 mm in any network)", text)
        self.assertIn("N170 30.0 mm from 1997-04-30, S160 50.0 mm from 1997-10-31", text)
        self.assertIn("the north has moved more than the south in 3 of the 3 networks", text)
        self.assertIn("the pier widens at 150 m by 30 (28 to 32) mm, in 3 of 3 networks; its middle moves by 5 mm to the north on average, "
                      "with a standard deviation of 1 mm", text)
        self.assertIn("10 percent of the rock in the jointed box is in tension, 1.0 percent above 1.5 MPa, up to 2 MPa", text)

    def test_loads_times(self):
        """Weight, stress and strengths, and nothing else; the scene of the updated geometry is one."""
        import updated_geometry
        own, new = tomllib.loads(self.chain.text(SCENE)), tomllib.loads(self.variant("--loads-times", "0.01"))
        keys = set()
        for one, other in ((own["section"], new["section"]), *zip(own["rock"], new["rock"]), *zip(own["joint_material"], new["joint_material"]),
                           *zip(own["in_situ_stress"]["profile"], new["in_situ_stress"]["profile"])):
            for key, value in one.items():
                if other[key] != value:
                    keys.add(key)
                    self.assertAlmostEqual(other[key], 0.01 * value)
        self.assertEqual(keys, {"gravity_m_per_s2", "cohesion_MPa", "tensile_strength_MPa", "compression_xx_MPa", "compression_yy_MPa"})
        text = self.variant(*map(str, [*updated_geometry.COARSE, *updated_geometry.RUNS["tiny"][0]]))
        scene = tomllib.loads(text)
        self.assertEqual((scene["creep"]["step_days"], str(scene["schedule"]["end"]), scene["cutting"]["smallest_angle_deg"]),
                         (400, "1999-12-31", 20))
        self.assertIn("large_displacements", scene)
        self.chain.network(text)

    def test_table_of_the_updated_geometry(self):
        """Parts of a difference: of the geometry, and of the engine, whose displacements at tiny loads are multiplied."""
        import updated_geometry
        def result(first, last):
            return {"names": ["N215"], "days": [0.0, 100.0, 2025.0], "total": [[0.0], [first], [last]], "first": [100],
                    "there": [True], "start": "1994-06-15", "zones": 9}
        targets = {"end_of_record": datetime.date(1999, 12, 31)}
        rows = updated_geometry.rows_of({"small": result(20.0, 60.0), "updated": result(21.0, 63.0), "tiny": result(0.202, 0.61)}, targets)
        numpy.testing.assert_allclose(rows[0][1]["total"], [60, 3, 2, 1], atol=1e-9)
        numpy.testing.assert_allclose(rows[0][1]["recorded"], [40, 2, 1.2, 0.8], atol=1e-9)
        text = updated_geometry.markdown(rows, 9, "1999-12-31")
        self.assertIn("| N215 | 60.00 | +3.00 (+5.0 %) | +2.000 (+3.3 %) | +1.00 (+1.7 %) | 40.00 |", text)
        self.assertIn("total +2.000 mm (N215)", text)
        early = {"end_of_record": datetime.date(1994, 9, 1)}
        rows = updated_geometry.rows_of({name: result(20.0, 60.0) for name in ("small", "updated", "tiny")}, early)
        text = updated_geometry.markdown(rows, 9, "1994-09-01")
        self.assertNotIn("nan", text)
        self.assertRegex(text, r"\| N215 \| 15\.60 \|.*\|  \|  \|  \|  \|\n", "not read yet")

    def test_scene_of_the_shares(self):
        """With the scene's own values it is the scene; each input is in a formula."""
        import shares
        text = self.chain.text(SCENE)
        named = shares.with_variables(text)
        with h5py.File(self.chain.network(named)) as file:
            same = tomllib.loads(file["/scene"][0].decode())
        scene, start = tomllib.loads(text), tomllib.loads(text)["schedule"]["start"]
        del same["variables"]
        for one, other in zip(scene["in_situ_stress"].pop("profile"), same["in_situ_stress"].pop("profile"), strict=True):
            for key, value in one.items():
                self.assertAlmostEqual(other[key], value, delta=1e-4)
        for one in (*scene["stage"], *scene["point"]):  # dates are days in formulas
            one.update({key: (value - start).days for key, value in one.items() if key in ("date", "first_reading")})
        for one in scene["joint_set"]:  # the ground cuts the joints off, whatever is above it
            one["region_m"] = [[-220, 60], [220, 60], [220, 300], [-220, 300]]
        self.assert_same_numbers(same, scene)
        used = tomllib.loads(named)
        for key, one in shares.INPUTS.items():
            self.assertAlmostEqual(one.value(one.share(one.own)), one.own)
            self.assertTrue(one.low < one.own < one.high, key)
            self.assertTrue(any(key in scene_keys.names_in(value) for table, value in used.items() if table != "variables"), key)
        rows = shares.shares_of_range(16)
        self.assertTrue(((rows >= 0) & (rows < 1)).all())
        numpy.testing.assert_array_equal(shares.shares_of_range(5), rows[:5])

    def assert_same_numbers(self, one, other):
        """Of two scenes that differ in the last digits only."""
        if isinstance(other, dict):
            self.assertEqual(one.keys(), other.keys())
        if isinstance(other, (dict, list)):
            self.assertEqual(len(one), len(other))
            for key in other if isinstance(other, dict) else range(len(other)):
                self.assert_same_numbers(one[key], other[key])
        elif isinstance(other, float):
            self.assertAlmostEqual(one, other, delta=1e-12 * abs(other))
        else:
            self.assertEqual(one, other)

    def test_runs_of_the_shares(self):
        """Sets of values and pairs of networks, by a study: horizontal stress and the days of the readings are those of the set."""
        import shares
        folder = self.chain.new_folder()
        (folder / "scene.toml").write_text(shares.with_variables(self.variant("--cutting", "2", "5", "--end", "1999-12-31")))
        rows = shares.shares_of_range(4)
        (folder / "points.csv").write_text(shares.table_of(rows))
        (folder / "study.toml").write_text(shares.study_of(["N185", "S160"], datetime.date(1999, 12, 31)))
        study = study_file.read(folder / "study.toml")
        self.assertEqual(study.design.networks_given, list(range(8)))
        self.assertEqual(len(study.quantities), 4)
        values = shares.values_of_set(rows[3])
        scene = scene_keys.changed(tomllib.loads((folder / "scene.toml").read_text()),
                                              {f"variables.{one.name}": one.values[7] for one in study.parameters})
        with h5py.File(self.chain.network(scene_keys.toml_text(scene))) as file:
            made = tomllib.loads(file["/scene"][0].decode())
        own = tomllib.loads(self.chain.text(SCENE))
        level = made["in_situ_stress"]["profile"][4]
        self.assertAlmostEqual(level["depth_m"], values["cover"] + values["weak"])
        self.assertAlmostEqual(level["compression_xx_MPa"], shares.variant.horizontal_stress(
            level["depth_m"], values["tectonic"], values["gradient"], values["decay"]))
        self.assertAlmostEqual(level["compression_yy_MPa"], 9.81e-6 * (2550 * values["cover"] + 2700 * values["weak"]))
        self.assertAlmostEqual(made["point"][0]["first_reading"] - values["readings"],
                               (own["point"][0]["first_reading"] - own["schedule"]["start"]).days)
        self.assertAlmostEqual(made["section"]["outline_m"][1][0], values["domain"])
        positions = {"N185": 94.0, "S160": -66.5}
        runs = {"total N185 (mm)": [-3.0, -4, -5, float("nan")], "total S160 (mm)": [5.0, 6, 7, 8],
                "recorded N185 (mm)": [-1.0, -2, -3, -4], "recorded S160 (mm)": [3.0, 4, 5, 6]}
        kept, pairs = shares.pairs_of({name: numpy.array(column) for name, column in runs.items()}, list(positions), positions)
        self.assertEqual(kept.tolist(), [0])
        self.assertEqual(pairs.tolist(), [[[3, 5, 1, 3], [4, 6, 2, 4]]])

    def test_shares_of_a_closed_form(self):
        """Logarithms linear in two inputs and in the network: shares of the logarithm's variance are known, and for small ones
        those of the displacement are the same. The misfit far from its least value is linear too."""
        import shares
        number, inputs, draw = 64, 6, numpy.random.default_rng(1)
        rows = shares.shares_of_range(number)[:, :inputs]
        networks = 0.03 * draw.normal(size=(number, 2, 1))
        x = math.sqrt(3) * (2 * rows - 1)
        logs = math.log(50) + (0.06 * x[:, 0] + 0.04 * x[:, 3])[:, None, None] + networks + numpy.zeros((1, 1, 4))
        targets = {"total_mm": [60, 90], "recorded_mm": [200, 400]}
        indices, fit = shares.shares(rows, numpy.exp(logs), targets, power=11)
        deviation = ((networks[:, 0] - networks[:, 1]) ** 2).mean() / 2
        whole = 0.06**2 + 0.04**2 + deviation
        for i, variance in ((0, 0.06**2), (3, 0.04**2), (1, 0), (inputs, deviation)):
            for j in range(2):
                numpy.testing.assert_allclose(indices[j, i, :2], variance / whole, atol=0.03)
        own = shares.straight(numpy.exp(logs), targets)
        self.assertAlmostEqual(own[2, 0], deviation / whole, delta=0.04)
        for lack in shares.lack_of_fit(rows, numpy.exp(logs)):
            self.assertAlmostEqual(lack, 0, delta=0.03)
        cubic = 0.06 * math.sqrt(7) * (5 * (2 * rows[:, 0] - 1) ** 3 - 3 * (2 * rows[:, 0] - 1)) / 2  # no polynomial of degree 2
        for lack in shares.lack_of_fit(rows, numpy.exp(logs + cubic[:, None, None])):
            self.assertAlmostEqual(lack, 0.06**2 / (whole + 0.06**2), delta=0.12)
        square = numpy.exp(logs + 0.1 * (x[:, 0] * x[:, 3])[:, None, None])
        self.assertTrue({(0,), (3,), (0, 3)} <= set(shares.fit_of(rows, square).terms))
        number = 400
        values = draw.normal(size=number)
        self.assertAlmostEqual(shares.errors_of(lambda which: values[which].mean(), number) * math.sqrt(number), 1, delta=0.5)
        answers = shares.answers_of(numpy.array([[60.0, 90, 200, 500]]), targets)
        numpy.testing.assert_allclose(answers, [[75, 350, (1 + 1 + 1 + 4) / 4]])

    def test_tables_and_pictures_of_the_shares(self):
        import shares
        names = [("a", "1 to 2"), ("network", "two")]
        indices = numpy.array([[[0.1, 0.1, 0.1], [0.6, 0.6, 0.6]], [[0.2, 0.2, 0.2], [0.8, 0.8, 0.8]]])
        text = shares.markdown(names, indices, 0.01 + 0 * indices, ["Two runs."])
        self.assertLess(text.index("| network | two | 0.600 ± 0.010 | 0.800 ± 0.010 |"), text.index("| a | 1 to 2 |"))
        rows = shares.shares_of_range(64)
        pairs = numpy.exp(4 + 0.3 * rows[:, :1, None] + 0.01 * numpy.random.default_rng(1).normal(size=(64, 2, 4)))
        targets = {"total_mm": [60, 90], "recorded_mm": [20, 40]}
        with unittest.mock.patch.object(shares.figure, "save") as save:
            shares.picture(names, indices, 0 * indices, "shares.png")
            told = shares.ridge(rows, pairs, shares.fit_of(rows, pairs), targets, "ridge.png")
        self.assertEqual([call.args[1] for call in save.call_args_list], ["shares.png", "ridge.png"])
        self.assertEqual(told[2], 13)
        for call in save.call_args_list:
            shares.figure.plt.close(call.args[0])

    def coarse(self, *variant):
        """A result of few large blocks in few creep steps."""
        text = changed(self.variant("--spacing-times", "3.1", *variant), r"^step_days = \S+", "step_days = 180")
        return self.chain.result(text, "--zone-size", "25")

    def test_numbers_of_the_page(self):
        """Realization 0 moves as in the page's table, with creep farther than without at every point."""
        scene = self.chain.text(SCENE)
        crept, at_once = (datasets(self.chain.result(scene, *options)) for options in ([], ["--no-creep"]))
        page = self.chain.text("docs/shiplock.md")
        table = re.search(r"<!-- convergence.md -->\n\n(.*?)\n\n", page, flags=re.DOTALL)[1]
        rows = dict(re.findall(r"\n\| ([NS]\d+) \| ([\d.]+) \|", table))
        self.assertEqual(sorted(rows), sorted(crept["/history/point"]))
        largest = numpy.abs(crept["/history/displacement"][:, :, 0]).max(axis=0)
        for name, value in zip(crept["/history/point"], largest):
            self.assertAlmostEqual(1e3 * value / float(rows[name]), 1, delta=1e-3, msg=name)
        toward = -numpy.sign(crept["/history/point_position"][:, 0])
        ends = [toward * one["/history/displacement"][-1, :, 0] for one in (crept, at_once)]
        self.assertTrue((ends[0] > ends[1]).all(), ends)

    def test_section_b_comes_to_rest(self):
        result = datasets(self.coarse("--section-b"))
        self.assertTrue((result["/equilibria/unbalanced_force_ratio"] <= 1e-6).all())
        self.assertTrue((-numpy.sign(result["/history/point_position"][:, 0]) * result["/history/displacement"][-1, :, 0]
                         > 0.01).all())

    def test_pictures_and_table_of_one_network(self):
        result = self.coarse()
        targets = self.chain.source / "data" / "shiplock" / "targets.toml"
        for script, *options in (["plot_lock"], ["plot_lock", "--plan"],
                                 ["plot_records", "--side", "S", "--targets", targets, "--without", result],
                                 ["plot_records", "--side", "N"]):
            picture = self.chain.new_folder() / "picture.png"
            done = subprocess.run([sys.executable, self.folder / f"{script}.py", result, *options, "-o", picture],
                                  capture_output=True, text=True, timeout=200)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertEqual(picture.read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        table = result.with_name("points.md")
        done = subprocess.run([sys.executable, self.folder / "points.py", result, result, targets, "-o", table],
                              capture_output=True, text=True, timeout=100)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        history = datasets(result)
        lines = [line for line in table.read_text().split("\n") if re.match(r"\| [NS]\d", line)]
        rows = {cells[1].split()[0]: cells for cells in (line.split("|") for line in lines)}
        self.assertEqual(set(rows), set(history["/history/point"]))
        end = 2025 + 1e-6  # 1999-12-31, days since 1994-06-15
        for i, name in enumerate(history["/history/point"]):
            toward = -1e3 * numpy.sign(history["/history/point_position"][i, 0]) * history["/history/displacement"][:, i, 0]
            total = numpy.interp(end, history["/history/time"], toward)
            self.assertAlmostEqual(float(rows[name][2]), total, delta=0.06)
            recorded = total - toward[history["/history/first_reading_row"][i]]
            self.assertAlmostEqual(float(rows[name][5]), recorded, delta=0.06)

    def test_points_without_ranges_have_no_misfit(self):
        """Section B-B's points are not those of the targets."""
        import points
        import study
        row = {"crest": False, **{key: numpy.array([50.0, 60, 70]) for key in
                                  ("total", "recorded", "before", "total_without", "recorded_without")}, "year": 0, "later": 0}
        ranges = {"total_mm": [60, 90], "recorded_mm": [20, 40]}
        own = {"N215": {"crest": False, "before_mm": [15, 40], **ranges}}
        for name, misfit in (("N215", "misfit 5.00."), ("N195", "no misfit")):  # squares of -1 and 3
            text = points.markdown([{**row, "name": name}], {"point": own, **ranges}, 2)
            self.assertIn(misfit, text)
            self.assertNotIn("Not among them", text)
            lines = [line.count("|") for line in text.split("\n") if line.startswith("|")]
            self.assertEqual(set(lines), {16 if name == "N215" else 10}, "columns of ranges where there are some")
        text = points.markdown([{**row, "name": "N215"}], {"point": own, **ranges}, 2, {8: "it slides"})
        self.assertIn("\nNot among them, network 8: it slides\n", text)
        start = study.datetime.date(1994, 6, 15)
        result = {"names": ["N215"], "days": [0.0, 2025.0], "total": [[0.0], [60.0]], "first": [0], "there": [True],
                  "start": start.isoformat()}
        targets = {"point": own, "end_of_record": start + study.datetime.timedelta(2025), **ranges}
        self.assertAlmostEqual(study.summary([result], targets, [0])["misfit"], 5)
        self.assertNotIn("misfit", study.summary([{**result, "names": ["N195"]}], targets, [0]))

    def test_a_run_that_was_stopped_is_no_result(self):
        """Killed or interrupted, a run leaves no file, and is made again; one that gave up leaves its reason."""
        import study
        for signal in ("INT", "KILL"):
            with self.assertRaisesRegex(SystemExit, "stopped"):
                study.run("/bin/sh", "-c", f"kill -{signal} $$")
        with self.assertRaisesRegex(study.Failed, "exit code 3: falls"):
            study.run("/bin/sh", "-c", "echo falls >&2; exit 3")
        out = self.chain.new_folder()
        (out / "runs").mkdir()
        scene = self.chain.source / SCENE
        programs = self.chain.new_folder()
        for name in ("jointgen", "strength-averaging", "demsolve"):
            (programs / name).write_text("#!/bin/sh\nkill -INT $$\n")
            (programs / name).chmod(0o755)
        with self.assertRaises(SystemExit):
            study.result_of(programs, scene, out, "scene", [], 0)
        self.assertEqual(list((out / "runs").iterdir()), [])
        (programs / "jointgen").write_text("#!/bin/sh\necho no joints >&2\nexit 2\n")
        with unittest.mock.patch("builtins.print"):
            self.assertIn("no joints", study.result_of(programs, scene, out, "scene", [], 0)["failed"])
        self.assertEqual(len(list((out / "runs").iterdir())), 1)

    def test_networks_without_result(self):
        """The others are summed up, whichever it is that has none, and the table says how many they are."""
        import study
        result = {"names": ["N215"], "days": [0, 3000], "total": [[0], [60.0]], "first": [0], "there": [True],
                  "start": "1994-06-15"}
        targets = {"point": {"N215": {}}, "total_mm": [60, 90], "recorded_mm": [20, 40],
                   "end_of_record": datetime.date(2002, 1, 1)}
        found = study.summary([{"failed": "falls"}, result], targets, [0])
        self.assertEqual((found["networks"], found["failed"]), (1, 1))
        own = study.summary([result, result], targets, [0])
        text = study.markdown(own, [("creep", "none", found)], 2, "the points")
        self.assertIn("| creep | none (1 networks) |", text)
        self.assertIn("| +0.0 % (N215) |", text)

    def test_spread_of_networks(self):
        import study
        each = (numpy.array([[1.0, 4], [3, 8]]), numpy.array([[0.0, 0], [0, 2]]))  # [network, point]
        rows = list(study.spread({"total": 50.0, "recorded": 30.0}, each))
        self.assertEqual([len(rows), len({what for what, _, _ in rows})], [4, 2])
        root = math.sqrt(2)
        for (_, _, found), total, recorded in zip(rows, (-1.5 * root, 1.5 * root, -1.5 * root, 1.5 * root),
                                                  (-root / 2, root / 2, -root / 2, root / 2)):
            self.assertAlmostEqual(found["total"], 50 + total)
            self.assertAlmostEqual(found["recorded"], 30 + recorded)

    def test_tornado(self):
        """Ordered by the larger of both changes over the widths of the ranges; a bar for every choice that has a result."""
        import matplotlib.pyplot
        import study
        targets = {"total_mm": [60, 90], "recorded_mm": [20, 40]}
        own = {"total": 70.0, "recorded": 40.0, "networks": 4, "misfit": 1.0}
        row = lambda total, recorded, **more: {"total": total, "recorded": recorded, "networks": 4, "failed": 0, **more}
        rows = [("box", "small", row(61.0, 40.0)), ("box", "large", row(75.0, 42.0)),  # 9 of 30
                ("readings", "later", row(70.0, 48.0)),  # 8 of 20
                ("stress", "none", "it slides"),
                ("stress", "high", row(200.0, 41.0, networks=3, failed=1)),
                ("network", "plus", {"total": 71.0, "recorded": 41.0})]
        groups = study.ordered(own, rows, targets)
        self.assertEqual([what for what, _ in groups], ["network", "box", "readings", "stress"])
        lines = list(study.lines_of(groups))
        self.assertEqual([text for text, *_ in lines], ["network: plus", "large", "small", "box", "readings: later",
                                                        "stress: high (3 networks)"])
        with unittest.mock.patch.object(study.figure, "save") as save:
            study.tornado(own, rows, targets, "tornado.png")
        plot, path = save.call_args.args
        self.assertEqual(path, "tornado.png")
        for axes, key, cut in zip(plot.axes, ("total", "recorded"), (135, 60)):
            bars = [bar for container in axes.containers for bar in container]
            wanted = [min(found[key], cut) for *_, found in lines if found]
            for bar, value in zip(bars, wanted, strict=True):
                self.assertAlmostEqual(bar.get_x(), own[key])
                self.assertAlmostEqual(bar.get_x() + bar.get_width(), value)
            self.assertEqual([text.get_text() for text in axes.texts], ["to 200"] if key == "total" else [])
        self.assertIn("changed, 4 networks", [text.get_text() for text in plot.legends[0].texts])
        matplotlib.pyplot.close(plot)

    def test_readings_of_the_back_analysis(self):
        """They count from the row after the first reading's day's stage, share its error, and leave out days of stages."""
        import back_analysis
        days = [0.0, 10.0, 10.0, 20.0, 30.0, 30.0, 40.0]
        result = {"names": ["N1", "S1"], "days": days, "first": [10, 20],
                  "total": [[row, 2 * row * row] for row in range(7)]}
        position = {"N1": 100, "S1": -100}
        with unittest.mock.patch.object(back_analysis, "SIGMA", 0):
            exact = list(back_analysis.readings(result, position))
        self.assertEqual(exact, [(20, "N1", -1), (40, "N1", -4), (40, "S1", 54)])
        many = {"names": ["N1"], "days": [float(day) for day in range(2001)], "first": [0], "total": [[0.0]] * 2001}
        errors = [[value for _, _, value in back_analysis.readings(many, position, seed)] for seed in range(50)]
        for one in errors:
            self.assertAlmostEqual(numpy.std(one), 1, delta=0.08)  # five standard errors
        self.assertTrue(0.6 < numpy.std([numpy.mean(one) for one in errors]) < 1.4)  # of the first reading; four of them

    def test_table_of_sites_of_other_networks(self):
        import back_analysis
        def row(factor, value, low, high):
            return {"factor": factor, "value": value, "low_95": low, "high_95": high}
        one = [row("joint-stiffness", "1.25", "1.1", "1.3"), row("kelvin-viscosity", "9", "8", "10")]
        several = [row("joint-stiffness", "1.2", "1", "1.4"), row("kelvin-viscosity", "", "", "")]
        lines = back_analysis.sites_markdown({4: (one, several)}, [0, 2]).splitlines()
        self.assertEqual(lines[0].split(" | ")[3:], ["found with network 0", "found with networks 0, 2 |"])
        self.assertEqual(lines[2:], ["| 4 | on K, E and eta together | 1.2 | 1.25 (1.10 to 1.30) | 1.20 (1.00 to 1.40) |",
                                     "| 4 | on eta, in addition | 0.7 | 9.00 (8.00 to 10.00), true factor outside | not resolved |"])

    def test_table_of_the_back_analysis(self):
        """Correlations are those of pairs, each once; a weak combination is told where there is one."""
        import back_analysis
        correlation = {("joint-stiffness", "kelvin-stiffness"): -0.96, ("joint-stiffness", "kelvin-viscosity"): -0.53,
                       ("kelvin-stiffness", "kelvin-viscosity"): 0.72}
        def rows(weak):
            return [{"factor": a, "value": "1.1", "low_95": "1", "high_95": "1.2", "chi_squared": "667.6",
                     "degrees_of_freedom": "703", "runs": "5", "weak_combination_times": weak,
                     **{f"correlation_{b}": str(correlation.get((a, b), correlation.get((b, a), 1)))
                        for b in back_analysis.MADE}} for a in back_analysis.MADE]
        told = back_analysis.markdown(rows(""), 706, 61.2)
        for words in ("| on E, in addition | 0.7 | 1.100 | 1.000 to 1.200 |", "706 readings", "chi squared 668 of 703",
                      "K and E -0.96, K and eta -0.53, E and eta 0.72.", "5 runs, 61 s of processor time"):
            self.assertIn(words, told)
        self.assertNotIn("warns", told)
        self.assertIn("warns of K x 1.050 with E x 1.050", back_analysis.markdown(rows("1.05"), 706, 61.2))

    def test_tables_of_the_page(self):
        """The page's tables have the columns that the scripts write, and a row for every point and choice."""
        import points
        import study
        page = self.chain.text("docs/shiplock.md")
        tables = dict(re.findall(r"<!-- ([\w/-]+\.md) -->\n(.*?)<!-- end of \1 -->", page, flags=re.DOTALL))
        head = points.markdown([{"crest": False, "name": "N1", **{key: numpy.array([1.0, 2, 3]) for key in
                                                                 ("total", "recorded", "before", "total_without",
                                                                  "recorded_without")}, "year": 0.0, "later": 0.0}],
                               {"point": {"N1": {"crest": False, "total_mm": [60, 90], "recorded_mm": [20, 40],
                                                 "before_mm": [15, 40]}},
                                "total_mm": [60, 90], "recorded_mm": [20, 40]}, 2).split("\n")[0]
        self.assertIn(head, tables["networks.md"])
        for point in tomllib.loads(self.chain.text(SCENE))["point"]:
            self.assertRegex(tables["networks.md"], rf"\n\| {point['name']}\b")
        for name, (what, to, _) in study.CHOICES.items():
            if name != "scene":
                self.assertRegex(tables["study/study.md"], rf"\n\| {re.escape(what)} \| {re.escape(to)} (\(\d+ networks\) )?\|")


if __name__ == "__main__":
    main()
