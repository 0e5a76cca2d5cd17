"""Everything jointexport writes, read back: the same numbers as in the HDF5 file, bit by bit."""

import base64
import csv
import functools
import tomllib
import xml.etree.ElementTree

import h5py
import numpy

from chain import ChainTest, changed, datasets, main

import joint_sets
from safety_test import HANGING

KINDS = ["boundary", "joint", "bonded"]
FATES = ["kept", "clipped", "trimmed", "merged", "dropped"]
TYPES = {"Float64": "<f8", "Int32": "<i4", "Int64": "<i8", "UInt8": "u1"}
LINE, POLYGON, TRIANGLE, VERTEX = 3, 7, 5, 1  # cell types of VTK
EQUIVALENT = {"normal_stiffness": "Pa_per_m", "shear_stiffness": "Pa_per_m", "cohesion": "Pa", "friction_angle": "rad",
              "tensile_strength": "Pa", "dilation_angle": "rad", "law": "", "residual_cohesion": "Pa",
              "residual_friction_angle": "rad", "roughness": "", "wall_strength": "Pa", "largest_closure": "m",
              "dilation_until": "m",
              "normal_kelvin_stiffness": "Pa_per_m", "shear_kelvin_stiffness": "Pa_per_m",
              "normal_kelvin_viscosity": "Pa_s_per_m", "shear_kelvin_viscosity": "Pa_s_per_m",
              "normal_maxwell_viscosity": "Pa_s_per_m", "shear_maxwell_viscosity": "Pa_s_per_m"}


def equivalent(data):
    """Columns of equivalent joints as exported: a name and a number for every Kelvin unit, where there are several."""
    for name, unit in EQUIVALENT.items():
        values = data["/equivalent/" + name]
        if values.ndim == 1:
            yield name, unit, values
        else:
            for u in range(values.shape[1]):
                yield name + (f"_{u + 1}" if values.shape[1] > 1 else ""), unit, values[:, u]


@functools.cache
def solved(scene):
    path = ChainTest.chain.result(ChainTest.chain.text(scene), "--no-creep")
    return path, datasets(path)


class Grid:
    """A VTK XML unstructured grid: its arrays, by name."""

    def __init__(self, path):
        root = xml.etree.ElementTree.parse(path).getroot()
        self.grid, appended = root
        assert appended.get("encoding") == "base64"
        self.appended = appended.text.strip().removeprefix("_")
        assert (root.tag, root.get("type"), self.grid.tag) == ("VTKFile", "UnstructuredGrid", "UnstructuredGrid")
        piece = self.grid.find("Piece")
        n_points, n_cells = int(piece.get("NumberOfPoints")), int(piece.get("NumberOfCells"))
        self.point, self.cell = self.arrays(piece.find("PointData")), self.arrays(piece.find("CellData"))
        assert all(len(array) == n_points for array in self.point.values())
        assert all(len(array) == n_cells for array in self.cell.values())
        (self.points,) = self.arrays(piece.find("Points")).values()
        assert self.points.shape == (n_points, 3) and (self.points[:, 2] == 0).all()
        cells = self.arrays(piece.find("Cells"))
        self.types = cells["types"]
        self.connectivity = numpy.split(cells["connectivity"], cells["offsets"][:-1]) if n_cells else []
        assert len(self.types) == len(self.connectivity) == n_cells
        self.field = self.arrays(self.grid.find("FieldData"))

    def arrays(self, element):
        found = {}
        for array in element if element is not None else []:
            kind, code = array.get("type"), self.appended[int(array.get("offset")):]
            size = int.from_bytes(base64.b64decode(code[:12])[:8], "little")
            data = base64.b64decode(code[:-(-(8 + size) // 3) * 4])[8:8 + size]
            if array.get("Name").endswith("_names"):
                found[array.get("Name")] = data.decode().split("\0")[:-1]
                continue
            values = numpy.frombuffer(data, TYPES[kind])
            components = int(array.get("NumberOfComponents", 1))
            found[array.get("Name")] = values.reshape(-1, components) if components > 1 else values
        return found


class Export(ChainTest):
    def export(self, source, name, *arguments):
        return self.chain.run("jointexport", source, self.chain.new_folder() / name, *arguments)

    def table(self, source, what):
        with open(self.export(source, what + ".csv", "--what", what), newline="") as file:
            return list(csv.DictReader(file))

    def assert_same(self, found, wanted):
        numpy.testing.assert_array_equal(numpy.asarray(found), numpy.asarray(wanted))

    def column(self, table, name, empty=None):
        return [empty if row[name] == "" else float(row[name]) for row in table]

    def test_histories_csv(self):
        for path, data in self.results():
            table = self.table(path, "histories")
            numpy.testing.assert_allclose(self.column(table, "time_day"), data["/history/time"], rtol=1e-12)
            for row in table:  # without what rounding leaves, such as 3.0000000000000004
                self.assertLessEqual(len(row["time_day"].replace(".", "").lstrip("0")), 13, row["time_day"])
            self.assertEqual([row["event"] for row in table], list(data["/history/event"]))
            for p, point in enumerate(data["/history/point"]):
                for axis, letter in enumerate("xy"):
                    wanted = data["/history/displacement"][:, p, axis]
                    self.assert_same(self.column(table, f"{point}_{letter}_m"), wanted)
                self.assert_same(self.column(table, f"{point}_present"), data["/history/present"][:, p])
            self.assertEqual(len(table[0]), 2 + 3 * len(data["/history/point"]))

    def test_failure(self):
        """A table of the blocks that move, and a mark on their zones."""
        joints = self.chain.joints(HANGING)
        done = self.chain.answer("demsolve", joints, "-o", joints.with_name("result.h5"))
        self.assertEqual(done.returncode, 3, done.stderr)
        path = joints.with_name("result.failed.h5")
        data, table = datasets(path), self.table(path, "failure")
        self.assert_same(self.column(table, "block"), data["/failure/block"])
        self.assertGreater(len(table), 0)
        self.assert_same(self.column(table, "area_m2"), data["/blocks/area"][data["/failure/block"]])
        for axis, letter in enumerate("xy"):
            self.assert_same(self.column(table, f"{letter}_m"), data["/failure/place"][:, axis])
            self.assert_same(self.column(table, f"displacement_{letter}_m"), data["/failure/motion"][:, axis])
        for row in table:
            self.assertEqual((row["stage"], float(row["time_day"]), row["reason"]),
                             (data["/failure/stage"][0], data["/failure/time"][0], data["/failure/reason"][0]))
        cells = Grid(self.export(path, "zones.vtu")).cell
        self.assert_same(cells["moving_block"], numpy.isin(cells["block"], data["/failure/block"]))
        self.assertEqual(set(cells["moving_block"]), {0, 1})
        for whole, _ in self.results():
            refused = self.chain.answer("jointexport", whole, "--what", "failure", "-o", joints.with_name("x.csv"))
            self.assertEqual(refused.returncode, 2)
            self.assertIn("did not end early", refused.stderr)
            self.assertNotIn("moving_block", Grid(self.export(whole, "zones.vtu")).cell)

    def test_blocks_csv(self):
        for path, data in self.results():
            table = self.table(path, "blocks")
            self.assert_same(self.column(table, "block"), range(len(data["/blocks/area"])))
            self.assert_same(self.column(table, "area_m2"), data["/blocks/area"])
            self.assertEqual([row["rock"] for row in table], [data["/names/rock"][r] for r in data["/blocks/rock"]])
            stages = [*data["/names/stage"], ""]  # -1, the last one, is none
            self.assertEqual([row["stage"] for row in table], [stages[s] for s in data["/blocks/stage"]])

    def test_joints_csv(self):
        """Every trace, clipped to the section by another method, with its joint, fate and how many ends were cut."""
        cut = 0
        for path, data in self.results():
            table, joint = self.table(path, "joints"), data["/traces/joint"]
            outline = numpy.array(tomllib.loads(data["/scene"][0])["section"]["outline_m"], float)
            rows = []
            for j, begin, end in zip(joint, data["/traces/from"], data["/traces/to"]):
                length, along = numpy.linalg.norm(end - begin), data["/joints/to"][j] - data["/joints/from"][j]
                for low, high in joint_sets.inside([outline], begin, end):
                    if high - low > 1e-9 * numpy.linalg.norm(along):
                        ends = [begin + at / length * (end - begin) for at in (low, high)]
                        rows.append((j, begin @ along + low, *ends[0], *ends[1], int(low > 0) + int(high < length)))
            rows = numpy.array(sorted(rows))
            self.assertEqual(len(rows), len(table))
            cut += rows[:, 6].sum()
            self.assert_same(self.column(table, "joint"), rows[:, 0])
            self.assert_same(self.column(table, "cut_ends"), rows[:, 6])
            for i, name in enumerate(["x1_m", "y1_m", "x2_m", "y2_m"]):
                numpy.testing.assert_allclose(self.column(table, name), rows[:, 2 + i], atol=1e-9)
            lengths = numpy.hypot(rows[:, 4] - rows[:, 2], rows[:, 5] - rows[:, 3])
            numpy.testing.assert_allclose(self.column(table, "length_m"), lengths, atol=1e-9)
            j = rows[:, 0].astype(int)
            self.assertEqual([row["set"] for row in table], list(data["/names/joint_set"][data["/joints/set"][j]]))
            self.assert_same(self.column(table, "number"), data["/joints/number"][j])
            self.assertEqual([row["fate"] for row in table], [FATES[fate] for fate in data["/fates/fate"][j]])
        self.assertGreater(cut, 0, "some traces leave these sections")

    def test_edges_csv(self):
        for path, data in self.results():
            table, joint = self.table(path, "edges"), data["/edges/joint"]
            ends = data["/vertices/position"][data["/edges/vertex"]]
            for n in 1, 2:
                for axis, letter in enumerate("xy"):
                    self.assert_same(self.column(table, f"{letter}{n}_m"), ends[:, n - 1, axis])
            for side, name in enumerate(["left_block", "right_block"]):
                self.assert_same(self.column(table, name, empty=-1), data["/edges/block"][:, side])
            self.assertEqual([row["kind"] for row in table], [KINDS[kind] for kind in data["/edges/kind"]])
            for row, j in zip(table, joint):
                wanted = ("", "") if j < 0 else (data["/names/joint_set"][data["/joints/set"][j]],
                                                str(data["/joints/number"][j]))
                self.assertEqual((row["set"], row["number"]), wanted)
            self.assert_same(self.column(table, "joint_fraction", empty=0), data["/edges/joint_fraction"])
            for name, unit, values in equivalent(data):
                self.assert_same(self.column(table, f"{name}_{unit}".rstrip("_"), empty=0), values)

    def test_blocks_vtu(self):
        for path, data in self.results():
            grid = Grid(self.export(path, "x.vtu", "--what", "blocks"))
            self.assertTrue((grid.types == POLYGON).all())
            self.assert_same(grid.cell["block"], range(len(data["/blocks/area"])))
            for name in "rock", "stage", "area":
                self.assert_same(grid.cell[name], data["/blocks/" + name])
            self.assertEqual(grid.field["rock_names"], list(data["/names/rock"]))
            self.assertEqual(grid.field["stage_names"], list(data["/names/stage"]))
            self.assertTrue((numpy.diff(data["/blocks/first_ring"]) == 1).all(), "these sections have no holes")
            rings = numpy.split(data["/rings/vertex"], data["/rings/first_corner"][1:-1])
            for corners, ring in zip(grid.connectivity, rings):
                self.assert_same(grid.points[corners, :2], data["/vertices/position"][ring])

    def test_edges_vtu(self):
        for path, data in self.results():
            grid = Grid(self.export(path, "x.vtu", "--what", "edges"))
            self.assertTrue((grid.types == LINE).all())
            joint = data["/edges/joint"]
            self.assert_same(grid.cell["edge"], range(len(joint)))
            ends = data["/vertices/position"][data["/edges/vertex"]]
            for cell, e in zip(grid.connectivity, ends):
                self.assert_same(grid.points[cell, :2], e)
            for name in "kind", "joint", "joint_fraction":
                self.assert_same(grid.cell[name], data["/edges/" + name])
            self.assert_same(grid.cell["set"], numpy.where(joint >= 0, data["/joints/set"][joint], -1))
            self.assertEqual(grid.field["set_names"], list(data["/names/joint_set"]))
            for name, _, values in equivalent(data):
                self.assert_same(grid.cell[name], values)

    def test_zones_vtu(self):
        for path, data in self.results():
            for state, day in enumerate(data["/states/time"]):
                grid = Grid(self.export(path, "x.vtu", "--what", "zones", "--state", state))
                zone, gridpoint = grid.cell["zone"], grid.point["gridpoint"]
                self.assertTrue((grid.types == TRIANGLE).all())
                self.assert_same(grid.field["TimeValue"], [day])
                self.assert_same(zone, numpy.flatnonzero(data["/states/zone_present"][state]))
                self.assert_same(grid.points[:, :2], data["/mesh/gridpoint_position"][gridpoint])
                self.assert_same(gridpoint[numpy.array(grid.connectivity)], data["/mesh/zone_gridpoint"][zone])
                self.assert_same(grid.point["displacement"][:, :2], data["/states/displacement"][state][gridpoint])
                for component, name in enumerate(["stress_xx", "stress_yy", "stress_xy"]):
                    self.assert_same(grid.cell[name], data["/states/stress"][state][zone, component])
                block = data["/mesh/zone_block"][zone]
                self.assert_same(grid.cell["block"], block)
                for name in "rock", "stage":
                    self.assert_same(grid.cell[name], data["/blocks/" + name][block])

    def test_contacts_vtu(self):
        for path, data in self.results():
            for state, day in enumerate(data["/states/time"]):
                grid = Grid(self.export(path, "x.vtu", "--what", "contacts", "--state", state))
                contact, status = grid.point["contact"], data["/states/contact_status"][state]
                self.assertTrue((grid.types == VERTEX).all())
                self.assert_same(grid.field["TimeValue"], [day])
                self.assert_same(contact, numpy.flatnonzero(status))
                self.assert_same(grid.points[:, :2], data["/mesh/contact_centre"][contact])
                self.assert_same(grid.point["edge"], data["/mesh/contact_edge"][contact])
                self.assert_same(grid.point["normal"][:, :2], data["/mesh/contact_normal"][contact])
                self.assert_same(grid.point["length"], data["/mesh/contact_length"][contact])
                self.assert_same(grid.point["status"], status[contact])
                for component, direction in enumerate(["normal", "shear"]):
                    for name in "traction", "relative_displacement":
                        wanted = data["/states/" + name][state][contact, component]
                        self.assert_same(grid.point[f"{direction}_{name}"], wanted)

    def test_vtkhdf(self):
        """The same grids as .vtu files have, in VTK's HDF5."""
        for path, _ in self.results():
            for what in "blocks", "edges", "joints", "zones", "contacts":
                grid = Grid(self.export(path, "x.vtu", "--what", what))
                with h5py.File(self.export(path, "x.vtkhdf", "--what", what)) as file:
                    root = file["VTKHDF"]
                    self.assertEqual((root.attrs["Type"], list(root.attrs["Version"])), (b"UnstructuredGrid", [1, 0]))
                    sizes = [len(grid.points), len(grid.types), sum(map(len, grid.connectivity))]
                    names = "NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"
                    self.assertEqual([root[name][()].tolist() for name in names], [[size] for size in sizes])
                    self.assert_same(root["Points"], grid.points)
                    self.assert_same(root["Types"], grid.types)
                    self.assert_same(root["Offsets"], numpy.cumsum([0, *map(len, grid.connectivity)]))
                    self.assert_same(root["Connectivity"], numpy.concatenate(grid.connectivity))
                    for section, arrays in ("PointData", grid.point), ("CellData", grid.cell), ("FieldData", grid.field):
                        self.assertEqual(set(root.get(section, [])), set(arrays))
                        for name, values in arrays.items():
                            found = root[section][name][()]
                            if name.endswith("_names"):
                                self.assertEqual(found.tobytes().decode().split("\0")[:-1], values)
                            else:
                                self.assert_same(found, values)
                                self.assertEqual(found.dtype, values.dtype)

    def test_states_by_name(self):
        """A stage stands for the state after it; the last state is the default."""
        for path, data in self.results():
            for stage in data["/names/stage"]:
                row = list(data["/states/event"]).index(stage)
                by_name = self.export(path, "x.vtu", "--what", "zones", "--state", stage).read_bytes()
                self.assertEqual(by_name, self.export(path, "x.vtu", "--what", "zones", "--state", row).read_bytes())
            last = len(data["/states/time"]) - 1
            by_number = self.export(path, "x.vtu", "--what", "zones", "--state", last).read_bytes()
            self.assertEqual(self.export(path, "x.vtu", "--what", "zones", "--state", "last").read_bytes(), by_number)
            self.assertEqual(self.export(path, "x.vtu").read_bytes(), by_number)

    def test_any_name_is_written_so_that_it_reads_back(self):
        """Names with what is special in XML, CSV and spreadsheets. A field that begins as a formula does is in quotes."""
        rock, joint, stage, point = '-10 m <&">', '@bedding, "upper" ', '=1+1 <&">', "+A"
        text = ChainTest.chain.text("data/column/scene.toml")
        for old, new, count in [('"rock"$', rock, 2), ('"joint under block 1"', joint, 1), ('"block 1 removed"', stage, 1),
                                ('"A"', point, 1)]:
            text = changed(text, old, f"'''{new}'''", count)
        result = ChainTest.chain.result(text, "--no-creep")
        self.assertEqual({row["rock"] for row in self.table(result, "blocks")}, {rock})
        self.assertIn(stage, [row["stage"] for row in self.table(result, "blocks")])
        self.assertIn(joint, [row["set"] for row in self.table(result, "joints")])
        histories = self.table(result, "histories")
        self.assertIn(stage, [row["event"] for row in histories])
        self.assertIn("+A_x_m", histories[0])
        raw = self.export(result, "x.csv", "--what", "histories").read_text()
        self.assertIn(',"+A_x_m",', raw)
        self.assertIn(',"=1+1 <&"">",', raw)
        for numbers in "joints", "histories":
            self.assertNotIn('"-', self.export(result, "x.csv", "--what", numbers).read_text(), "numbers are not names")
        grid = Grid(self.export(result, "x.vtu", "--what", "blocks"))
        self.assertEqual((grid.field["rock_names"], grid.field["stage_names"][0]), ([rock], stage))

    def test_the_name_of_the_file_in_xml(self):
        source = solved("data/column/scene.toml")[0]
        folder = self.chain.new_folder()
        for what in "zones", "contacts":
            name = '<a> & "b" \'c\'.h5'
            (folder / name).write_bytes(source.read_bytes())
            path = self.chain.run("jointexport", folder / name, folder / "x.xdmf2", "--what", what)
            items = [item.text for item in xml.etree.ElementTree.parse(path).iter("DataItem") if item.get("Format") == "HDF"]
            self.assertTrue(items and all(item.startswith(name + ":/") for item in items))
            for name in "bell\a.h5", "line\nbreak.h5", "\x85.h5":
                (folder / name).write_bytes(source.read_bytes())
                done = self.chain.answer("jointexport", folder / name, "-o", folder / "y.xdmf2", "--what", what)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertIn("Rename the file", done.stderr)
                self.assertFalse((folder / "y.xdmf2").exists())

    def test_earlier_files(self):
        """Blocks and joints are the same from every file of the chain."""
        for path, _ in self.results():
            for name, what in ("x.vtu", "blocks"), ("x.csv", "blocks"), ("x.csv", "joints"):
                texts = {self.export(path.with_name(file), name, "--what", what).read_bytes()
                         for file in ("network.h5", "joints.h5", "result.h5")}
                self.assertEqual(len(texts), 1)
            edges = self.table(path.with_name("network.h5"), "edges")
            full = self.table(path.with_name("joints.h5"), "edges")
            self.assertEqual([dict(row) for row in edges], [{name: row[name] for name in edges[0]} for row in full])

    def results(self):
        for scene in "data/column/scene.toml", "tests/pipeline/random_slope.toml":
            yield solved(scene)


if __name__ == "__main__":
    main()
