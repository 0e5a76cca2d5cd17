"""Traces from files of GIS and CAD programs, as [[mapped]] takes them, and joint sets fitted to traces."""

import csv
import io
import json
import math
import re
import sqlite3
import struct
import subprocess
import tomllib
import unittest

import h5py
import numpy as np

from chain import ChainTest, main

SCENE = "tests/pipeline/kinds/scene.toml"
PLAIN, NONE, DEGREES, FEET = -1, 0, 4326, 2263  # reference systems: of a plane, none at all, WGS 84, US survey feet
WKT = {PLAIN: "undefined", NONE: "undefined", DEGREES: 'GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],'
       'UNIT["degree",0.0174532925199433]]',
       FEET: 'PROJCS["in feet",GEOGCS["NAD83",DATUM["North_American_Datum_1983",SPHEROID["GRS 1980",6378137,298.257222101]],'
       'PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],'
       'PARAMETER["central_meridian",-74],UNIT["US survey foot",0.304800609601219]]'}


def wkb(kind, places):
    """A line (2), a line with heights (1002), a point (1) or several lines (5), as GeoPackage has it."""
    if kind == 5:
        return struct.pack("<BII", 1, 5, len(places)) + b"".join(wkb(2, part) for part in places)
    head = struct.pack("<BI", 1, kind) + (b"" if kind == 1 else struct.pack("<I", len(places)))
    return head + b"".join(struct.pack(f"<{len(place)}d", *place) for place in places)


def write_geopackage(path, layers):
    """Layers {name: (reference system, [(id, set, WKB or None)])}, by SQLite alone."""
    with sqlite3.connect(path) as file:
        file.executescript("""PRAGMA application_id = 0x47504B47; PRAGMA user_version = 10300;
            CREATE TABLE gpkg_spatial_ref_sys (srs_name TEXT NOT NULL, srs_id INTEGER PRIMARY KEY, organization TEXT NOT NULL,
                organization_coordsys_id INTEGER NOT NULL, definition TEXT NOT NULL, description TEXT);
            CREATE TABLE gpkg_contents (table_name TEXT PRIMARY KEY, data_type TEXT NOT NULL, identifier TEXT, description TEXT,
                last_change DATETIME, min_x DOUBLE, min_y DOUBLE, max_x DOUBLE, max_y DOUBLE, srs_id INTEGER);
            CREATE TABLE gpkg_geometry_columns (table_name TEXT PRIMARY KEY, column_name TEXT, geometry_type_name TEXT,
                srs_id INTEGER, z TINYINT, m TINYINT);""")
        for system, text in WKT.items():
            file.execute("INSERT INTO gpkg_spatial_ref_sys VALUES (?, ?, 'EPSG', ?, ?, '')", (str(system), system, system, text))
        for name, (system, rows) in layers.items():
            file.execute(f'CREATE TABLE "{name}" (fid INTEGER PRIMARY KEY, geom BLOB, "set" TEXT)')
            file.execute("INSERT INTO gpkg_contents (table_name, data_type, identifier, last_change, srs_id) "
                         "VALUES (?, 'features', ?, '2020-01-01T00:00:00Z', ?)", (name, name, system))
            file.execute("INSERT INTO gpkg_geometry_columns VALUES (?, 'geom', 'GEOMETRY', ?, 2, 0)", (name, system))
            for number, of_set, geometry in rows:
                blob = None if geometry is None else b"GP\0\1" + struct.pack("<i", system) + geometry
                file.execute(f'INSERT INTO "{name}" VALUES (?, ?, ?)', (number, blob, of_set))
    file.close()
    return path


def write_dxf(path, lines, units=None):
    """Lines [(layer, places)], of places with or without height."""
    pairs = []
    if units is not None:
        pairs += [(0, "SECTION"), (2, "HEADER"), (9, "$INSUNITS"), (70, units), (0, "ENDSEC")]
    pairs += [(0, "SECTION"), (2, "ENTITIES")]
    for layer, places in lines:
        if len(places) == 1:
            pairs += [(0, "POINT"), (8, layer), (10, places[0][0]), (20, places[0][1])]
        elif len(places) == 2:
            pairs += [(0, "LINE"), (8, layer)]
            for end, place in enumerate(places):
                pairs += [(10 * (axis + 1) + end, value) for axis, value in enumerate(place)]
        else:
            pairs += [(0, "POLYLINE"), (8, layer), (66, 1), (70, 0)]
            for place in places:
                pairs += [(0, "VERTEX"), (8, layer), (10, place[0]), (20, place[1])]
            pairs += [(0, "SEQEND")]
    pairs += [(0, "ENDSEC"), (0, "EOF")]
    path.write_text("".join(f"{code}\n{value}\n" for code, value in pairs))
    return path


class TracesTest(ChainTest):
    @classmethod
    def setUpClass(cls):
        if not (cls.chain.programs / "jointcreep_gdal.so").exists():
            raise unittest.SkipTest("built without GDAL")

    def new(self, name):
        return self.chain.new_folder() / name

    def traces(self, path, *options):
        """{(id, part): places} and {id: value} as jointgen reads them."""
        done = self.chain.answer("jointgen", path, "--traces", *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        places, values = {}, {}
        for row in csv.DictReader(io.StringIO(done.stdout)):
            places.setdefault((int(row["id"]), int(row["part"])), []).append((float(row["x_m"]), float(row["y_m"])))
            values[int(row["id"])] = row["value"]
        return places, values

    def assert_refused(self, path, *says, options=()):
        done = self.chain.answer("jointgen", path, "--traces", *options)
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        for word in path.name, *says:
            self.assertIn(word, done.stderr)
        self.assertNotIn("internal", done.stderr)


class Files(TracesTest):
    GEOPACKAGE = {"faults": (PLAIN, [(7, "F", wkb(2, [(1, 2), (3, 4.5), (6, 5)])), (9, "G, \"1\"", wkb(5, [[(0, 0), (1, 1)], [(5, 5), (6, 7)]])),
                                     (12, "F", wkb(1002, [(8, 8, 300), (9, 9, 301)]))]),
                  "blocks": (DEGREES, [(1, "", wkb(1, [(1, 1)]))])}

    def test_geopackage(self):
        """Polylines, several parts, heights, ids, names; a layer without lines is no matter, whatever its reference system."""
        places, values = self.traces(write_geopackage(self.new("t.gpkg"), self.GEOPACKAGE), "--property", "set")
        self.assertEqual(places, {(7, 0): [(1, 2), (3, 4.5), (6, 5)], (9, 0): [(0, 0), (1, 1)], (9, 1): [(5, 5), (6, 7)],
                                  (12, 0): [(8, 8), (9, 9)]})
        self.assertEqual(values, {7: "F", 9: "G, \"1\"", 12: "F"})

    def test_a_geopackage_without_a_reference_system_is_taken(self):
        """GDAL calls it geographic."""
        path = write_geopackage(self.new("t.gpkg"), {"l": (NONE, [(1, "", wkb(2, [(1, 2), (3, 4)]))])})
        self.assertEqual(self.traces(path)[0], {(1, 0): [(1, 2), (3, 4)]})

    def test_a_file_that_ends_early_is_refused(self):
        """Not read as far as it goes."""
        whole = self.chain.run("jointexport", self.chain.network(self.chain.text("tests/pipeline/random_slope.toml")), self.new("x.shp"))
        whole.write_bytes(whole.read_bytes()[:whole.stat().st_size // 2])
        self.assert_refused(whole)
        path = write_dxf(self.new("t.dxf"), [("a", [(0, 0), (1, 1)])] * 20)
        path.write_text(path.read_text()[:path.stat().st_size // 2 + 3])
        self.assert_refused(path)

    def test_layers(self):
        more = {**self.GEOPACKAGE, "dykes": (PLAIN, [(1, "D", wkb(2, [(1, 1), (2, 2)]))])}
        path = write_geopackage(self.new("t.gpkg"), more)
        self.assert_refused(path, 'several layers; expected layer = one of "dykes", "faults"')
        self.assert_refused(path, 'no lines in a layer "blocks"; it has some in "dykes", "faults"', options=["--layer", "blocks"])
        self.assertEqual(self.traces(path, "--layer", "dykes")[0], {(1, 0): [(1, 1), (2, 2)]})

    def test_dxf(self):
        """Layers are those of entities; ids are places in the layer."""
        path = write_dxf(self.new("T.DXF"), [("a", [(0, 0), (1, 1)]), ("b", [(5, 5, 2), (6, 7, 3)]), ("a", [(1, 0), (2, 0), (3, 1)])], 6)
        self.assertEqual(self.traces(path, "--layer", "a")[0], {(0, 0): [(0, 0), (1, 1)], (1, 0): [(1, 0), (2, 0), (3, 1)]})
        self.assertEqual(self.traces(path, "--layer", "b")[0], {(0, 0): [(5, 5), (6, 7)]})
        self.assert_refused(path, '"a", "b"')

    def test_what_jointexport_writes_comes_back(self):
        network = self.chain.network(self.chain.text("tests/pipeline/random_slope.toml"))
        table = self.chain.run("jointexport", network, self.new("x.csv"))
        with open(table, newline="") as file:
            rows = list(csv.DictReader(file))
        wanted = np.array([[float(row[name]) for name in ("x1_m", "y1_m", "x2_m", "y2_m")] for row in rows])
        for name, options in ("x.gpkg", ["--layer", "joints"]), ("x.shp", []):
            places, values = self.traces(self.chain.run("jointexport", network, self.new(name)), "--property", "set", *options)
            np.testing.assert_array_equal(np.array(list(places.values())).reshape(-1, 4), wanted)
            self.assertEqual(list(values.values()), [row["set"] for row in rows])
        path = self.chain.run("jointexport", network, self.new("x.dxf"))
        for of_set in {row["set"] for row in rows}:
            places, _ = self.traces(path, "--layer", of_set.replace(" ", "_"))  # as DXF has it
            np.testing.assert_array_equal(np.array(list(places.values())).reshape(-1, 4),
                                          wanted[[row["set"] == of_set for row in rows]])

    def test_refusals(self):
        line = wkb(2, [(1, 2), (3, 4)])
        cases = [({"l": (DEGREES, [(1, "", line)])}, ['layer "l"', "degrees", "metres"]),
                 ({"l": (FEET, [(1, "", line)])}, ['layer "l"', "foot", "metres"]),
                 ({"l": (PLAIN, [(1, "", line), (2, "", wkb(1, [(1, 1)]))])}, ['layer "l", feature 1', "POINT", "LineString"]),
                 ({"l": (PLAIN, [(1, "", line), (2, "", None)])}, ['layer "l", feature 1', "null"]),
                 ({"l": (PLAIN, [(1, "", line), (2, "", wkb(2, [(1, 2), (math.nan, 4)]))])}, ['layer "l", feature 1', "coordinates"]),
                 ({"l": (PLAIN, [(1, "", wkb(2, [(1, 2), (5e6, 4)]))])}, ['layer "l", feature 0', "5000000"]),
                 ({"l": (PLAIN, [(1, "", wkb(2, [(1, 2), (1, 2)]))])}, ['layer "l", feature 0', "two places"]),
                 ({"l": (PLAIN, [])}, ["no lines"])]
        for layers, says in cases:
            with self.subTest(says=says):
                self.assert_refused(write_geopackage(self.new("t.gpkg"), layers), *says)
        self.assert_refused(write_dxf(self.new("t.dxf"), [("a", [(0, 0), (1, 1)])], 4), "$INSUNITS 4, millimetres", "metres")
        self.assert_refused(write_dxf(self.new("t.dxf"), [("a", [(0, 0), (1, 1)]), ("a", [(3, 3)])]), 'layer "a", feature 1', "POINT")
        for name in "t.gpkg", "t.shp", "t.dxf":
            for content in b"", b"no such file", b"{}", bytes(range(256)) * 8:
                path = self.new(name)
                path.write_bytes(content)
                self.assert_refused(path)

    def test_damaged_files_end_with_a_message(self):
        whole = write_geopackage(self.new("t.gpkg"), self.GEOPACKAGE).read_bytes()
        random = np.random.default_rng(5)
        for _ in range(30):
            damaged = bytearray(whole)
            for at in random.integers(0, len(whole), 20):
                damaged[at] = random.integers(0, 256)
            path = self.new("t.gpkg")
            path.write_bytes(damaged[:random.integers(1, len(whole))] if random.random() < 0.3 else damaged)
            done = self.chain.answer("jointgen", path, "--traces")
            self.assertIn(done.returncode, (0, 2), done.stderr)

    def test_a_scene_takes_them(self):
        """[[mapped]] file = "traces.gpkg" gives the joints of the same traces in GeoJSON, and the network carries them."""
        kinds = self.chain.source / "tests/pipeline/kinds"
        folder = self.chain.new_folder()
        for name in "poles.csv", "traces.geojson":
            (folder / name).write_bytes((kinds / name).read_bytes())
        text = self.chain.text(SCENE)
        (folder / "scene.toml").write_text(text)
        plain = self.chain.run("jointgen", folder / "scene.toml", folder / "plain.h5")
        rows = []
        for feature in json.loads((folder / "traces.geojson").read_text())["features"]:
            geometry, properties = feature["geometry"], feature["properties"]
            if geometry["type"] in ("LineString", "MultiLineString"):
                parts = geometry["coordinates"]
                number = feature.get("id", properties.get("id"))
                rows.append((number, properties["set"], wkb(5, parts if geometry["type"] == "MultiLineString" else [parts])))
        write_geopackage(folder / "traces.gpkg", {"map": (PLAIN, rows), "other": (PLAIN, [(1, "J", wkb(2, [(0, 0), (50, 30)]))])})
        text = text.replace('file = "traces.geojson"', 'file = "traces.gpkg"\nlayer = "map"')
        (folder / "scene.toml").write_text(text)
        network = self.chain.run("jointgen", folder / "scene.toml", folder / "network.h5")
        with h5py.File(plain) as one, h5py.File(network) as other:
            for name in "joints/from", "joints/to", "joints/number", "blocks/area", "edges/joint":
                np.testing.assert_array_equal(one[name][:], other[name][:], err_msg=name)
            held = other["scene"].asstr()[0]
        alone = self.new("scene.toml")
        alone.write_text(held)
        again = self.chain.run("jointgen", alone, alone.with_name("n.h5"))
        with h5py.File(again) as one, h5py.File(network) as other:
            np.testing.assert_array_equal(one["joints/from"][:], other["joints/from"][:])
        self.chain.run("strength-averaging", network, folder / "joints.h5")
        (folder / "scene.toml").write_text(text.replace('layer = "map"\n', "", 1))
        done = self.chain.answer("jointgen", folder / "scene.toml", "--check")
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, r'scene\.toml, line \d+: \[\[mapped\]\] "map fault" file = "traces\.gpkg": has lines in several layers')


class WithoutGdal(ChainTest):
    def test_a_message_names_what_is_missing(self):
        folder = self.chain.new_folder()
        (folder / "jointgen").write_bytes((self.chain.programs / "jointgen").read_bytes())
        (folder / "jointgen").chmod(0o755)
        write_geopackage(folder / "t.gpkg", Files.GEOPACKAGE)
        done = subprocess.run([folder / "jointgen", folder / "t.gpkg", "--traces"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        for word in "t.gpkg", "GDAL", "setup.sh exchange":
            self.assertIn(word, done.stderr)

    def test_jointgen_starts_without_it(self):
        libraries = subprocess.run(["ldd", self.chain.programs / "jointgen"], capture_output=True, text=True, check=True).stdout
        self.assertNotIn("gdal", libraries)


class Fits(ChainTest):
    """The command; coverage of its intervals is tested by pipelines/exchange/fits.py."""

    WINDOW = "0,0,30,20"

    def traces(self, number=400, mean=8.0):
        """Traces of two sets around the window, of negative exponential lengths: CSV, whole, not cut."""
        random = np.random.default_rng(11)
        rows = []
        for name, angle in ("flat", 10), ("steep", 80):
            middle = random.uniform((-40, -40), (70, 60), (number * 18, 2))
            way = np.radians(random.normal(angle, 5, len(middle)))
            half = random.exponential(mean, len(middle)) / 2
            along = np.column_stack([np.cos(way), np.sin(way)]) * half[:, None]
            rows += [f"{a:.6f},{b:.6f},{c:.6f},{d:.6f},{name}" for (a, b), (c, d) in zip(middle - along, middle + along)]
        path = self.chain.new_folder() / "traces.csv"
        path.write_text("x1_m,y1_m,x2_m,y2_m,set\n" + "\n".join(rows) + "\n")
        return path

    def fit(self, path, *options):
        return self.chain.answer("jointcreep", "fit", path, "-o", path.with_name("sets.toml"), *options)

    def test_sets_are_found_and_jointgen_reads_them(self):
        path = self.traces()
        done = self.fit(path, "--window", self.WINDOW, "--property", "set", "--law", "negative exponential")
        self.assertEqual(done.returncode, 0, done.stderr)
        text = path.with_name("sets.toml").read_text()
        sets = tomllib.loads(text)["joint_set"]
        self.assertEqual([one["name"] for one in sets], ["flat", "steep"])
        for one, angle in zip(sets, (10, 80)):
            self.assertEqual(one["length"]["law"], "negative exponential")
            self.assertAlmostEqual(one["length"]["mean_m"], 8, delta=0.8)  # 3 standard errors of some 600 traces
            self.assertAlmostEqual(one["trace_angle"]["mean_deg"], angle, delta=0.8)
            self.assertAlmostEqual(one["density"]["P21_per_m"], 7200 / 11000 * 8, delta=0.9)
        self.assertIn("as if nothing were cut", done.stdout)
        scene = self.chain.text(SCENE).split("[[joint_set]]")[0] + text + "\n[in_situ_stress]" + self.chain.text(SCENE).split(
            "[in_situ_stress]")[1]
        network = self.chain.network(scene)
        with h5py.File(network) as file:
            self.assertEqual(list(file["names/joint_set"].asstr()[:]), ["flat", "steep"])

    def clip(self, path, short=0.0):
        """Clips the traces of a file to the window; where it cuts them they end so far inside [m]."""
        rows = list(csv.reader(path.read_text().splitlines()))
        kept = [rows[0]]
        for row in rows[1:]:
            a, b = np.array(row[:2], float), np.array(row[2:4], float)
            with np.errstate(divide="ignore"):
                ends = np.sort(np.array([(np.zeros(2) - a) / (b - a), (np.array([30, 20]) - a) / (b - a)]), axis=0)
            low, high = ends[0].max(), ends[1].min()
            share = short / np.linalg.norm(b - a)
            low, high = low + share if low > 0 else 0, high - share if high < 1 else 1
            if low < high:
                kept.append([*map(repr, map(float, [*(a + low * (b - a)), *(a + high * (b - a))])), row[4]])
        path.write_text("\n".join(",".join(row) for row in kept) + "\n")

    def test_an_edge_that_is_not_exact(self):
        """Traces that were mapped to 5 mm before the edge count as cut there with --edge, and as whole without."""
        path = self.traces()
        options = "--window", self.WINDOW, "--property", "set", "--law", "negative exponential"

        def whole(*more):
            done = self.fit(path, *options, *more)
            self.assertEqual(done.returncode, 0, done.stderr)
            return [tuple(map(int, found)) for found in
                    re.findall(r": (\d+) traces in the window, (\d+) whole, (\d+) cut at one end, (\d+) at both", done.stdout)]

        wanted = whole()
        self.assertEqual(len(wanted), 2)
        self.clip(path, 0.005)
        for one, other in zip(whole("--edge", "0.02"), wanted):
            np.testing.assert_allclose(one, other, atol=3)  # ends of whole traces within 2 cm of the edge; bits of traces
        for traces, uncut, *_ in whole():
            self.assertEqual(traces, uncut)

    def test_the_window_may_cut_the_file(self):
        """Traces clipped to the window give the same sets as whole ones."""
        path = self.traces()
        whole = self.fit(path, "--window", self.WINDOW, "--property", "set", "-q")
        self.assertEqual(whole.returncode, 0, whole.stderr)
        before = path.with_name("sets.toml").read_text()
        self.clip(path)
        cut = self.fit(path, "--window", self.WINDOW, "--property", "set", "-q")
        self.assertEqual(cut.returncode, 0, cut.stderr)
        numbers = [np.array([float(word) for word in text.replace(",", " ").split() if word.replace(".", "", 1).isdecimal()])
                   for text in (before, path.with_name("sets.toml").read_text())]
        np.testing.assert_allclose(numbers[0], numbers[1], rtol=2e-4)

    def test_refusals(self):
        path = self.traces(20)
        steep = ["--window", self.WINDOW, "--property", "set"]
        for options, says in (([], "--window"), (["--window", "0,0,1"], "--window"), (["--window", "nothing.toml"], "nothing.toml"),
                              (["--window", "0,0,9,0,1,1,0,9"], "not convex"), (["--window", "0,0,1,1"], "0 traces"),
                              ([*steep, "--law", "gamma"], "negative exponential"), ([*steep, "--azimuth", "20"], "--poles"),
                              ([*steep, "--property", "no"], "twice"), (["--window", self.WINDOW, "--property", "no"], "expected a column no"),
                              ([*steep, "--law", "power"], "--shortest"), ([*steep, "--shortest", "5", "--longest", "2"], "--longest"),
                              (["--window", self.WINDOW, "--layer", "a"], "no layers")):
            with self.subTest(options=options):
                done = self.fit(path, *options)
                self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
                self.assertIn(says, done.stderr)
                self.assertFalse(path.with_name("sets.toml").exists())

    def test_poles_by_terzaghi(self):
        """Poles about a mean, of which a scanline meets some by their angle to it: the mean and concentration of all are found."""
        random = np.random.default_rng(3)
        kappa, n = 20.0, 40000
        cosine = 1 + np.log1p(-random.random(n) * (1 - math.exp(-2 * kappa))) / kappa
        turn, sine = random.uniform(0, 2 * math.pi, n), np.sqrt(1 - cosine**2)
        mean = np.array([math.sin(math.radians(60)) * math.sin(math.radians(120)), math.sin(math.radians(60)) * math.cos(math.radians(120)),
                         math.cos(math.radians(60))])
        one = np.cross(mean, [0, 0, 1])
        one /= np.linalg.norm(one)
        normals = (cosine[:, None] * mean + (sine * np.cos(turn))[:, None] * one
                   + (sine * np.sin(turn))[:, None] * np.cross(mean, one))
        line = np.array([math.sin(math.radians(155)), math.cos(math.radians(155)), 0])
        normals = normals[random.random(n) < np.abs(normals @ line)]
        normals *= np.where(normals[:, 2] < 0, -1, 1)[:, None]
        path = self.traces(40)
        rows = zip(np.degrees(np.arccos(normals[:, 2])), np.degrees(np.arctan2(normals[:, 0], normals[:, 1])) % 360)
        path.with_name("poles.csv").write_text("dip_deg,dip_direction_deg\n" + "".join(f"{dip!r},{way!r}\n" for dip, way in rows))
        words = ["--window", self.WINDOW, "--poles", path.with_name("poles.csv")]
        found = {}
        for name, options in ("all", ["--scanline-trend", "155", "--scanline-plunge", "0"]), ("met", []):
            done = self.fit(path, *words, *options)
            self.assertEqual(done.returncode, 0, done.stderr)
            (found[name],) = (one["orientation"] for one in tomllib.loads(path.with_name("sets.toml").read_text())["joint_set"])
        self.assertAlmostEqual(found["all"]["mean_dip_deg"], 60, delta=0.6)
        self.assertAlmostEqual(found["all"]["mean_dip_direction_deg"], 120, delta=0.6)
        self.assertAlmostEqual(found["all"]["concentration"], kappa, delta=1)
        self.assertGreater(abs(found["met"]["mean_dip_direction_deg"] - 120), 2, "without weights the mean is off")


if __name__ == "__main__":
    main()
