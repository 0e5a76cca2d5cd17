"""What jointexport writes for other programs, by the grammar of each program's reader: counts, lengths, areas and ids are
those of the HDF5 file. Programs that read these files in earnest: make -C pipelines/exchange readers."""

import ast
import csv
import json
import math
import re
import xml.etree.ElementTree

import numpy

from chain import ChainTest, datasets, main

NAME = '''a "b" <c>, d=e; 'f' ü'''  # what is special in one format or another


def ring_area(ring):
    x, y = numpy.array(ring, float).T
    return (x * numpy.roll(y, -1) - y * numpy.roll(x, -1)).sum() / 2


def polygon_area(corners):
    """Area of a plane polygon in space, and its normal."""
    corners = numpy.array(corners)
    twice = sum(numpy.cross(a - corners[0], b - corners[0]) for a, b in zip(corners[1:-1], corners[2:]))
    return numpy.linalg.norm(twice) / 2, twice / numpy.linalg.norm(twice)


class Formats(ChainTest):
    @classmethod
    def setUpClass(cls):
        text = ChainTest.chain.text("tests/pipeline/random_slope.toml")
        cls.network = ChainTest.chain.network(text)
        cls.data = datasets(cls.network)
        discs = re.sub(r"azimuth_deg = .*\n", "", text).replace("[section]\n", "[section]\nazimuth_deg = 40\n", 1)
        material = re.search(r'\[\[joint_material\]\]\nname = "(.*?)"', text).group(1)
        discs += f"""
[[joint_set]]
name = '''{NAME}'''
material = "{material}"
kind = "discs"
dip = {{ law = "normal", mean_deg = 60, deviation_deg = 5 }}
dip_direction = {{ law = "normal", mean_deg = 50, deviation_deg = 10 }}
diameter = {{ law = "lognormal", mean_m = 12, deviation_m = 5 }}
density = {{ P32_per_m = 0.3 }}
region_m = [[2, 2], [78, 2], [78, 12], [50, 12], [50, 6], [25, 6], [25, 45], [2, 45]]
"""
        cls.discs = ChainTest.chain.network(discs)
        cls.disc_data = datasets(cls.discs)
        head, one_set = discs.rsplit("[[joint_set]]", 1)
        one_set = "[[joint_set]]" + one_set
        second = one_set.replace(NAME, "second").replace("mean_deg = 50", "mean_deg = 230")
        others = re.sub(r"(?ms)^\[\[joint(_set)?\]\].*?(?=^\[\[joint|^\[in_situ)", "", head)
        cls.only_discs = ChainTest.chain.network(others + one_set + second)

    def export(self, name, *options, source=None):
        return self.chain.run("jointexport", source or self.network, self.chain.new_folder() / name, *options)

    def ids(self, path):
        with open(path.with_name(path.stem + ".ids.csv"), newline="", encoding="utf-8") as file:
            return list(csv.DictReader(line for line in file if not line.startswith("#")))

    def joints(self):
        with open(self.export("joints.csv"), newline="") as file:
            return list(csv.DictReader(file))

    def test_dxf(self):
        path = self.export("x.dxf")
        lines = path.read_text().splitlines()
        self.assertEqual(len(lines) % 2, 0)
        pairs = [(int(code), value) for code, value in zip(lines[::2], lines[1::2])]
        self.assertEqual(pairs[-1], (0, "EOF"))
        self.assertIn((1, "AC1009"), pairs)
        starts = [i for i, pair in enumerate(pairs) if pair[0] == 0] + [len(pairs)]
        entities = [pairs[a:b] for a, b in zip(starts, starts[1:])]
        layers = {dict(entity)[2] for entity in entities if entity[0] == (0, "LAYER")}
        found, ids = [dict(entity) for entity in entities if entity[0] == (0, "LINE")], {row["id"]: row for row in self.ids(path)}
        table = self.joints()
        self.assertEqual(len(found), len(table))
        for line, row in zip(found, table):
            self.assertEqual([float(line[code]) for code in (10, 20, 11, 21)],
                             [float(row[name]) for name in ("x1_m", "y1_m", "x2_m", "y2_m")])
            self.assertRegex(line[8], "^[A-Za-z0-9_-]{1,31}$")
            self.assertIn(line[8], layers)
            for name in "set", "number", "joint", "fate", "realization":
                self.assertEqual(ids[line[5]][name], row[name])

    def test_geojson(self):
        read = json.loads(self.export("x.geojson", "--what", "blocks").read_text())
        self.assertIsNone(read["crs"])
        area = sum(sum(ring_area(ring[:-1]) for ring in feature["geometry"]["coordinates"]) for feature in read["features"])
        self.assertAlmostEqual(area, self.data["/blocks/area"].sum(), delta=1e-9 * area)
        self.assertTrue(all(ring[0] == ring[-1] for f in read["features"] for ring in f["geometry"]["coordinates"]))
        read = json.loads(self.export("x.geojson").read_text())
        for feature, row in zip(read["features"], self.joints(), strict=True):
            self.assertEqual(feature["geometry"]["coordinates"], [[float(row["x1_m"]), float(row["y1_m"])],
                                                                  [float(row["x2_m"]), float(row["y2_m"])]])
            self.assertEqual({name: str(feature["properties"][name]) for name in ("set", "number", "fate", "realization")},
                             {name: row[name] for name in ("set", "number", "fate", "realization")})

    def test_fractopo(self):
        path = self.export("x.geojson", "--format", "fractopo")
        traces = json.loads(path.read_text())["features"]
        self.assertEqual({feature["geometry"]["type"] for feature in traces}, {"LineString"})
        self.assertEqual([feature["geometry"]["coordinates"] for feature in traces],
                         [[[float(row["x1_m"]), float(row["y1_m"])], [float(row["x2_m"]), float(row["y2_m"])]]
                          for row in self.joints()])
        (area,) = json.loads(path.with_name("x.area.geojson").read_text())["features"]
        self.assertEqual(area["geometry"]["type"], "Polygon")
        self.assertAlmostEqual(ring_area(area["geometry"]["coordinates"][0][:-1]), self.data["/blocks/area"].sum(), places=6)

    def test_porepy(self):
        path = self.export("x.csv", "--format", "porepy")
        rows = list(csv.reader(path.read_text().splitlines()))
        self.assertEqual(rows[0], ["FID", "START_X", "START_Y", "END_X", "END_Y"])
        table = self.joints()
        self.assertEqual([row[1:] for row in rows[1:]], [[row[n] for n in ("x1_m", "y1_m", "x2_m", "y2_m")] for row in table])
        self.assertEqual([row["joint"] for row in self.ids(path)], [row["joint"] for row in table])

    def test_gmsh(self):
        text = self.export("x.geo").read_text()
        points = {int(n): (float(x), float(y)) for n, x, y in re.findall(r"Point\((\d+)\) = \{(\S+), (\S+), 0\};", text)}
        curves = {int(n): (int(a), int(b)) for n, a, b in re.findall(r"^Line\((\d+)\) = \{(\d+), (\d+)\};", text, re.M)}
        loops = {int(n): [int(c) for c in body.split(",")] for n, body in re.findall(r"Curve Loop\((\d+)\) = \{(.*?)\};", text)}
        surfaces = re.findall(r"Plane Surface\((\d+)\) = \{(.*?)\};", text)
        self.assertEqual(len(curves), len(self.data["/edges/vertex"]))
        for (number, body), wanted in zip(surfaces, self.data["/blocks/area"], strict=True):
            area = 0
            for loop in body.split(","):
                ends = [curves[abs(c)][:: 1 if c > 0 else -1] for c in loops[int(loop)]]
                self.assertTrue(all(a[1] == b[0] for a, b in zip(ends, ends[1:] + ends[:1])), "loops are closed")
                area += ring_area([points[a] for a, _ in ends])
            self.assertAlmostEqual(area, wanted, delta=1e-9 * wanted)
        groups = {name: {int(c) - 1 for c in body.split(",")}
                  for name, body in re.findall(r'(?s)Physical Curve\("(.*?)", \d+\) = \{(.*?)\};', text)}
        joint = self.data["/edges/joint"]
        for index, name in enumerate(self.data["/names/joint_set"]):
            self.assertEqual(groups.get(name, set()),
                             set(numpy.flatnonzero((joint >= 0) & (self.data["/joints/set"][joint] == index))))
        ids = self.ids(self.export("x.geo"))
        self.assertEqual([row["joint"] for row in ids if row["layer"] == "edges"], [str(j) if j >= 0 else "" for j in joint])

    def test_svg(self):
        root = xml.etree.ElementTree.parse(self.export("x.svg", "--what", "joints,blocks")).getroot()
        lines, paths = (list(root.iter("{http://www.w3.org/2000/svg}" + tag)) for tag in ("line", "path"))
        self.assertEqual(len(paths), len(self.data["/blocks/area"]))
        found = sorted((int(line.get("data-joint")), float(line.get("x1")), -float(line.get("y1"))) for line in lines)
        self.assertEqual(found, sorted((int(row["joint"]), float(row["x1_m"]), float(row["y1_m"])) for row in self.joints()))

    def test_udec(self):
        path = self.export("x.dat", "--format", "udec")
        area = numpy.zeros(len(self.data["/blocks/area"]))
        commands = [line for line in path.read_text().splitlines() if not line.startswith(";")]
        self.assertEqual(commands.pop(0), "model new")
        for line, row in zip(commands, self.ids(path), strict=True):
            self.assertTrue(line.startswith("block create polygon "))
            ring = [tuple(map(float, place.split(","))) for place in line.split()[3:]]
            self.assertLess(ring_area(ring), 0, "clockwise")
            area[int(row["block"])] -= ring_area(ring)
        numpy.testing.assert_allclose(area, self.data["/blocks/area"], rtol=1e-9)

    def parts(self, rings):
        """Convex parts add up to their blocks."""
        area = numpy.zeros(len(self.data["/blocks/area"]))
        for block, ring in rings:
            ring = numpy.array(ring)
            sides = numpy.roll(ring, -1, axis=0) - ring
            after = numpy.roll(sides, -1, axis=0)
            turn = (sides[:, 0] * after[:, 1] - sides[:, 1] * after[:, 0]) / numpy.linalg.norm(sides, axis=1)
            self.assertGreater((turn / numpy.linalg.norm(after, axis=1)).min(), -1e-11, "convex")
            area[block] += ring_area(ring)
        numpy.testing.assert_allclose(area, self.data["/blocks/area"], rtol=1e-9)

    def test_3dec_blocks(self):
        path = self.export("x.dat", "--format", "3dec", "--width", 4)
        rings = []
        commands = path.read_text().splitlines()[2:]
        for number, (line, row) in enumerate(zip(commands, self.ids(path), strict=True), start=1):
            self.assertEqual(int(row["prism"]), number)
            self.assertTrue(line.endswith(f" group 'block {row['block']}'"), line)
            one, two = (numpy.array([[float(v) for v in place.split(",")] for place in re.findall(r"\((.*?)\)", face)])
                        for face in re.fullmatch(r"block create prism face-1(.*) face-2(.*) group 'block \d+'", line).groups())
            self.assertTrue((one[:, 1] == -2).all() and (two[:, 1] == 2).all())
            numpy.testing.assert_array_equal(one[:, [0, 2]], two[:, [0, 2]])
            rings.append((int(row["block"]), one[:, [0, 2]]))
        self.parts(rings)

    def test_3dec_fractures(self):
        """Discs as they were sampled, inside the domain, each in the network of its set."""
        path = self.export("x.dat", "--format", "3dec", "--what", "planes", source=self.only_discs)
        (domain,) = [line for line in path.read_text().splitlines() if line.startswith("model domain extent ")]
        low, high = numpy.array(domain.split()[3:], float).reshape(3, 2).T
        commands = [line for line in path.read_text().splitlines() if line.startswith("fracture create ")]
        data = datasets(self.only_discs)
        discs = self.planes(data)
        self.assertEqual(len(set(data["/joints/set"][discs[0]])), 2)
        pattern = r"fracture create position \((.*)\) dip (\S+) dip-direction (\S+) size (\S+) dfn '(.*)'"
        for line, row, j, d, c, n in zip(commands, self.ids(path), *discs, strict=True):
            place, dip, direction, size, name = re.fullmatch(pattern, line).groups()
            place, dip, direction = numpy.array(place.split(","), float), math.radians(float(dip)), math.radians(float(direction))
            self.assertEqual(float(size), d)
            numpy.testing.assert_allclose(place, c, atol=1e-9)
            own = [math.sin(dip) * math.sin(direction), math.sin(dip) * math.cos(direction), math.cos(dip)]
            numpy.testing.assert_allclose(own, n, atol=1e-9)
            of_set = data["/names/joint_set"][data["/joints/set"][j]]
            self.assertEqual((name, row["set"], int(row["joint"])), (of_set.replace("'", '"'), of_set, j))
            reach = d / 2 * numpy.sqrt(1 - n**2)  # of a disc along each axis
            self.assertTrue((place - reach > low).all() and (place + reach < high).all())

    def test_yade(self):
        tree = ast.parse(self.export("x.py", "--width", 3).read_text())
        (width,) = [ast.literal_eval(node.value) for node in tree.body
                    if isinstance(node, ast.Assign) and node.targets[0].id == "width"]
        self.assertEqual(width, 3)
        (parts,) = [ast.literal_eval(node.value) for node in tree.body
                    if isinstance(node, ast.Assign) and node.targets[0].id == "parts"]
        self.parts((block, ring) for block, *_, ring in parts)
        for block, rock, stage, realization, _ in parts:
            of = self.data["/blocks/stage"][block]
            self.assertEqual((rock, stage, realization), (self.data["/names/rock"][self.data["/blocks/rock"][block]],
                                                          self.data["/names/stage"][of] if of >= 0 else "", 0))

    def planes(self, data=None):
        """Of each disc: its first joint, diameter, centre and unit normal in {east, north, up}, from the HDF5 file. The region
        divides the chords of some into several joints."""
        data, azimuth = data or self.disc_data, math.radians(40)
        is_disc = data["/joints/diameter"] > 0
        _, first = numpy.unique(data["/joints/centre"], axis=0, return_index=True)
        is_first = numpy.isin(numpy.arange(len(is_disc)), first)
        self.assertTrue((is_disc & ~is_first).any(), "some discs are several joints")
        is_disc &= is_first
        turn = numpy.array([[math.sin(azimuth), 0, math.cos(azimuth)], [math.cos(azimuth), 0, -math.sin(azimuth)], [0, 1, 0]])
        return (numpy.flatnonzero(is_disc), data["/joints/diameter"][is_disc], data["/joints/centre"][is_disc] @ turn.T,
                data["/joints/pole"][is_disc] @ turn.T)

    def test_discs_are_those_that_the_section_meets(self):
        """The chord of each disc in the section is its trace: the plane holds it, and its ends are on the rim."""
        data, (joint, diameter, _, _) = self.disc_data, self.planes()
        self.assertGreater(len(joint), 20)
        centre, pole = data["/joints/centre"][joint], data["/joints/pole"][joint]
        for end in "from", "to":
            place = numpy.column_stack([data["/joints/" + end][joint], numpy.zeros(len(joint))])
            numpy.testing.assert_allclose(numpy.einsum("ij,ij->i", place - centre, pole), 0, atol=1e-9)
            self.assertTrue((numpy.linalg.norm(place - centre, axis=1) < diameter / 2 * (1 + 1e-9)).all())
        middle = (data["/joints/from"][joint] + data["/joints/to"][joint]) / 2
        length = numpy.linalg.norm(data["/joints/to"][joint] - data["/joints/from"][joint], axis=1)
        off = numpy.abs(centre[:, 2]) / numpy.sqrt(1 - pole[:, 2] ** 2)
        chord = 2 * numpy.sqrt(numpy.maximum(0, diameter**2 / 4 - off**2))
        whole = (abs(middle - [13.5, 25]) < [11, 18]).all(axis=1) & (chord < 0.9 * (11 - abs(middle[:, 0] - 13.5)))  # by the region
        self.assertGreater(whole.sum(), 5)
        numpy.testing.assert_allclose(length[whole], chord[whole], rtol=1e-6)
        across = numpy.abs(centre[:, 2])
        self.assertGreater(across.max(), 1, "centres are on both sides of the section")
        self.assertTrue((centre[:, 2] > 0).any() and (centre[:, 2] < 0).any())

    def test_fracman(self):
        data = self.disc_data
        joint, diameter, centre, normal = self.planes()
        lines = self.export("x.fab", "--width", 5, source=self.discs).read_text().splitlines()
        self.assertNotIn("", lines)
        self.assertIn("    Format = Ascii", lines)
        sets = [line.split("=") for line in lines[lines.index("BEGIN SETS") + 1:lines.index("END SETS")]]
        self.assertTrue(all(len(words) == 2 and words[1].count('"') == 2 for words in sets))
        rows, found = iter(lines[lines.index("BEGIN FRACTURE") + 1:lines.index("END FRACTURE")]), {}
        for row in rows:
            _, nodes, joint_set, of, number, size = row.split()
            self.assertEqual((int(joint_set), int(number)), (data["/joints/set"][int(of)] + 1, data["/joints/number"][int(of)]))
            corners = [[float(word) for word in next(rows).split()[1:]] for _ in range(int(nodes))]
            zero, *own = next(rows).split()
            self.assertEqual(zero, "0")
            if float(size) > 0:
                found[int(of)] = float(size), corners, numpy.array(own, float)
        self.assertEqual(list(found), list(joint))
        for (size, corners, own), d, c, n in zip(found.values(), diameter, centre, normal):
            self.assertEqual(size, d)
            area, across = polygon_area(corners)
            self.assertAlmostEqual(area, math.pi / 4 * d * d, delta=1e-9 * area)
            numpy.testing.assert_allclose(numpy.mean(corners, axis=0), c, atol=1e-9)
            numpy.testing.assert_allclose(own, n, atol=1e-12)
            self.assertAlmostEqual(abs(across @ n), 1, places=9)

    def test_dfnworks(self):
        path = self.export("x.dat", "--format", "dfnworks", "--width", 5, source=self.discs)
        first, *lines = path.read_text().splitlines()
        self.assertEqual(first, f"nPolygons: {len(lines)}")
        corners = [numpy.array(re.findall(r"\{(\S+), (\S+), (\S+)\}", line), float) for line in lines]
        self.assertEqual([int(line.split()[0]) for line in lines], [len(ring) for ring in corners])
        self.assertGreaterEqual(min(map(len, corners)), 4)
        every = numpy.concatenate(corners)
        numpy.testing.assert_allclose(every.min(axis=0) + every.max(axis=0), 0, atol=1e-9)
        # Each polygon is the plane of the joint that the table of ids names, in its place and direction.
        ids = self.ids(path)
        self.assertEqual(len(ids), len(lines))
        first = path.with_name("x.ids.csv").read_text().splitlines()[0]
        middle = numpy.array(first.partition("[m]: ")[2].split(","), float)
        discs = {j: (c, n) for j, _, c, n in zip(*self.planes())}
        seen = [int(row["joint"]) for row, ring in zip(ids, corners) if len(ring) == 16]
        self.assertEqual(seen, list(discs))
        for row, ring in zip(ids, corners):
            if len(ring) == 16:
                centre, normal = discs[int(row["joint"])]
                numpy.testing.assert_allclose(ring.mean(axis=0) + middle, centre, atol=1e-9)
                self.assertAlmostEqual(abs(polygon_area(ring)[1] @ normal), 1, places=9)
        areas = sum(polygon_area(ring)[0] for ring in corners if len(ring) == 16)
        self.assertAlmostEqual(areas, (math.pi / 4 * self.planes()[1] ** 2).sum(), delta=1e-9 * areas)

    def test_joints_without_a_size_across_need_a_width(self):
        done = self.chain.answer("jointexport", self.network, "-o", "x.fab")
        self.assertEqual(done.returncode, 2)
        self.assertIn("--width", done.stderr)

    def test_many_realizations(self):
        """In one file, or a file each; two of the same number are not written over one another."""
        text = self.chain.text("tests/pipeline/random_slope.toml")
        files = [self.chain.network(text, "--realization", r) for r in (2, 5)]
        folder = self.chain.new_folder()
        done = self.chain.answer("jointexport", *files, "-o", folder / "all.csv")
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(folder / "all.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        each = {}
        done = self.chain.answer("jointexport", *files, "-o", folder / "one-{realization}.csv")
        self.assertEqual(done.returncode, 0, done.stderr)
        for number in 2, 5:
            with open(folder / f"one-{number}.csv", newline="") as file:
                each[number] = list(csv.DictReader(file))
        self.assertEqual(rows, each[2] + each[5])
        self.assertEqual({row["realization"] for row in each[5]}, {"5"})
        for names in ["x.dxf"], ["x.svg"]:
            done = self.chain.answer("jointexport", *files, "-o", folder / names[0])
            self.assertEqual(done.returncode, 2)
            self.assertIn("{realization}", done.stderr)
        done = self.chain.answer("jointexport", files[0], files[0], "-o", folder / "same-{realization}.csv")
        self.assertEqual(done.returncode, 2, done.stdout)
        self.assertFalse((folder / "same-2.csv").exists())

    def test_formats_are_listed(self):
        rows = [line.split("\t") for line in self.chain.answer("jointexport", "--formats").stdout.splitlines()]
        self.assertEqual(rows[0], ["format", "extension", "holds", "by default", "in one file", "as"])
        self.assertEqual({len(row) for row in rows}, {6})
        page = self.chain.text("docs/exchange.md")
        self.assertGreater(len(rows), 15)
        for name, extension, _, default, *_ in rows[1:]:
            of_page = re.search(rf"^\| `{name}` \| {re.escape(extension)} \|[^|]*\|([^|]*)\|", page, flags=re.MULTILINE)
            self.assertEqual(of_page[1].replace(",", "").strip(), default, name)

    def test_no_file_is_written_over_an_input(self):
        folder = self.chain.new_folder()
        source = folder / "x.ids.csv"  # what the table of ids would be called
        source.write_bytes(self.network.read_bytes())
        done = self.chain.answer("jointexport", source, "-o", folder / "x.dxf")
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertEqual(source.read_bytes(), self.network.read_bytes())


if __name__ == "__main__":
    main()
