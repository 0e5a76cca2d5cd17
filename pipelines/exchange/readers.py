"""Reads back what jointexport writes, by readers of other projects, and says what agrees:  readers.py PROGRAMS SCENE OUT

A row for each format: the reader, what it found, and what the HDF5 file has: joint traces are clipped to the section here, by another
method than jointexport's. Ends with exit code 1 where they differ. A
reader that is not installed is named, and its row left out.
"""

import csv
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tomllib

import h5py
import numpy

import joint_sets


def run(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


class Network:
    """What the HDF5 file has."""

    def __init__(self, path):
        with h5py.File(path) as file:
            self.area = file["/blocks/area"][:]
            self.vertex, edge = file["/vertices/position"][:], file["/edges/vertex"][:]
            self.edge_length = numpy.linalg.norm(self.vertex[edge[:, 1]] - self.vertex[edge[:, 0]], axis=1)
            self.kind, self.joint = file["/edges/kind"][:], file["/edges/joint"][:]
            self.sets = list(file["/names/joint_set"].asstr()[:])
            self.set_of = file["/joints/set"][:]
            section = tomllib.loads(file["/scene"].asstr()[0])["section"]
            polygons = [numpy.array(section["outline_m"], float)]
            pieces = [(int(joint), high - low)
                      for joint, begin, end in zip(file["/traces/joint"][:], file["/traces/from"][:], file["/traces/to"][:])
                      for low, high in joint_sets.inside(polygons, begin, end) if high - low > 1e-9]
            self.trace_joint = sorted(joint for joint, _ in pieces)
            self.trace_length = sum(length for _, length in pieces)


class Check:
    def __init__(self, export, network, out):
        self.export, self.network, self.out = export, network, out
        self.rows, self.failed = [], False

    def add(self, name, reader, found, wanted, what, tolerance=1e-9):
        agrees = abs(found - wanted) <= tolerance * abs(wanted)
        self.failed |= not agrees
        self.rows.append((name, reader, what, f"{found:.10g}", f"{wanted:.10g}", "" if agrees else "DIFFERS"))

    def same(self, name, reader, found, wanted, what):
        """Ids, or values by id: how many are the same."""
        found, wanted = numpy.asarray(found, float), numpy.asarray(wanted, float)
        same = int(numpy.isclose(found, wanted, rtol=1e-9, atol=0).sum()) if found.shape == wanted.shape else 0
        self.add(name, reader, same, len(wanted), what)

    def write(self, name, *options):
        self.export(self.out / name, *options)
        return self.out / name

    def ogr(self, name, layer, rows, measure, wanted):
        """Counts rows and sums lengths or areas by GDAL's SQL."""
        path = self.out / name
        geometry = "geom" if path.suffix == ".gpkg" else "geometry"
        text = run("ogrinfo", "-ro", "-q", "-dialect", "SQLite", "-sql",
                   f'SELECT COUNT(*) AS n, SUM({measure}({geometry})) AS s FROM "{layer}"', path)
        count, total = re.search(r"n \(.*\) = (\d+)", text).group(1), re.search(r"s \(.*\) = (\S+)", text).group(1)
        self.add(name, "GDAL", int(count), rows, f"{layer}, rows")
        self.add(name, "GDAL", float(total), wanted, f"{layer}, {'length [m]' if 'Length' in measure else 'area [m2]'}")
        if layer != "entities":
            of = "joint" if layer == "joints" else "block"
            table = run("ogr2ogr", "-f", "CSV", "/vsistdout/", path, "-dialect", "SQLite", "-sql", f'SELECT "{of}" FROM "{layer}"')
            found = sorted(int(row[of]) for row in csv.DictReader(table.splitlines()))
            self.same(name, "GDAL", found, self.network.trace_joint if of == "joint" else range(rows), f"{layer}, same ids")

    def geo(self, joints, length):
        network = self.network
        if not shutil.which("ogrinfo"):
            return print("not installed: ogrinfo (gdal-bin)")
        for name in "all.gpkg", "joints.geojson", "blocks.geojson", "joints.shp", "joints.dxf":
            self.write(name, *(["--what", "blocks"] if name == "blocks.geojson" else []))
        for name, layer in ("all.gpkg", "joints"), ("joints.geojson", "joints"), ("joints.shp", "joints"):
            self.ogr(name, layer, joints, "ST_Length", length)
        blocks = len(network.area)
        self.ogr("all.gpkg", "blocks", blocks, "ST_Area", network.area.sum())
        self.ogr("blocks.geojson", "blocks", blocks, "ST_Area", network.area.sum())
        self.ogr("joints.dxf", "entities", joints + 1, "ST_Length", length + self.outline)

    def dxf(self, joints, length):
        try:
            import ezdxf
        except ImportError:
            return print("not installed: ezdxf (python3-ezdxf)")
        document = ezdxf.readfile(self.write("joints.dxf"))
        lines = list(document.modelspace().query("LINE"))
        self.add("joints.dxf", "ezdxf", len(lines), joints, "lines")
        self.add("joints.dxf", "ezdxf", sum((line.dxf.end - line.dxf.start).magnitude for line in lines), length, "length [m]")
        ids = {row["id"]: row for row in rows_of(self.out / "joints.ids.csv")}
        right = sum(ids[line.dxf.handle.lstrip("0")]["set"] == line.dxf.layer for line in lines)
        self.add("joints.dxf", "ezdxf", right, joints, "lines on the layer of their set")
        found = sorted(int(ids[line.dxf.handle.lstrip("0")]["joint"]) for line in lines)
        self.same("joints.dxf", "ezdxf", found, self.network.trace_joint, "lines, same ids of joints")
        self.add("joints.dxf", "ezdxf", len(document.audit().errors), 0, "errors in its audit")

    def gmsh(self):
        if not shutil.which("gmsh"):
            return print("not installed: gmsh")
        import meshio
        network = self.network
        name, mesh = "blocks.geo", self.out / "blocks.msh"
        run("gmsh", self.write(name), "-2", "-format", "msh22", "-o", mesh, "-v", "0")
        read = meshio.read(mesh)
        triangles = read.cells_dict["triangle"]
        a, b, c = (read.points[triangles[:, i], :2] for i in range(3))
        area = numpy.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2
        self.add(name, "gmsh", area.sum(), network.area.sum(), "area of the mesh [m2]")
        of_block = read.cell_data_dict["gmsh:geometrical"]["triangle"] - 1  # surface b + 1 is block b
        self.same(name, "gmsh", numpy.bincount(of_block, area, len(network.area)), network.area, "blocks with their area")
        lines = read.points[read.cells_dict["line"]][:, :, :2]
        group = read.cell_data_dict["gmsh:physical"]["line"]
        lengths = numpy.linalg.norm(lines[:, 1] - lines[:, 0], axis=1)
        for label, (number, dimension) in read.field_data.items():
            if dimension == 1 and label in network.sets:
                of_set = (network.joint >= 0) & (network.set_of[network.joint] == network.sets.index(label))
                self.add(name, "gmsh", lengths[group == number].sum(), network.edge_length[of_set].sum(), f"edges of {label} [m]")

    def vtu(self):
        network, path = self.network, self.write("blocks.vtu")
        try:
            import meshio
            read = meshio.read(path)
            areas = numpy.concatenate(read.cell_data["area"]).sum()
            self.add("blocks.vtu", "meshio", sum(len(block.data) for block in read.cells), len(network.area), "cells")
            self.add("blocks.vtu", "meshio", areas, network.area.sum(), "area [m2]")
            by_block = numpy.zeros(len(network.area))
            by_block[numpy.concatenate(read.cell_data["block"])] = numpy.concatenate(read.cell_data["area"])
            self.same("blocks.vtu", "meshio", by_block, network.area, "blocks with their area")
        except ImportError:
            print("not installed: meshio (python3-meshio)")
        try:
            from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
            from vtkmodules.util.numpy_support import vtk_to_numpy
        except ImportError:
            return print("not installed: VTK (python3-vtk9)")
        for name, what in ("blocks.vtu", "blocks"), ("edges.vtu", "edges"):
            reader = vtkXMLUnstructuredGridReader()
            reader.SetFileName(str(self.write(name, "--what", what)))
            reader.Update()
            grid = reader.GetOutput()
            points = vtk_to_numpy(grid.GetPoints().GetData())
            if what == "blocks":
                self.add(name, "VTK", vtk_to_numpy(grid.GetCellData().GetArray("area")).sum(), network.area.sum(), "area [m2]")
            else:
                ends = points[vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 2)]
                self.add(name, "VTK", numpy.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum(), network.edge_length.sum(),
                         "length [m]")

    def vtkhdf(self):
        path = self.write("blocks.vtkhdf")
        try:
            from vtkmodules.vtkIOHDF import vtkHDFReader
            from vtkmodules.util.numpy_support import vtk_to_numpy
        except ImportError:
            return print("not installed: VTK (python3-vtk9)")
        reader = vtkHDFReader()
        reader.SetFileName(str(path))
        reader.Update()
        grid = reader.GetOutput()
        self.add("blocks.vtkhdf", "VTK", grid.GetNumberOfCells(), len(self.network.area), "cells")
        by_block = numpy.zeros(len(self.network.area))
        by_block[vtk_to_numpy(grid.GetCellData().GetArray("block"))] = vtk_to_numpy(grid.GetCellData().GetArray("area"))
        self.same("blocks.vtkhdf", "VTK", by_block, self.network.area, "blocks with their area")
        self.add("blocks.vtkhdf", "VTK", vtk_to_numpy(grid.GetCellData().GetArray("area")).sum(), self.network.area.sum(), "area [m2]")

    def yade(self):
        if not shutil.which("yade"):
            return print("not installed: yade")
        script, found = self.write("blocks.py"), self.out / "yade.json"
        script.with_name("count.py").write_text(
            script.read_text() + "\nimport json\nfrom yade import polyhedra_utils\n"
            f"json.dump([[block_of[b.id], b.state.mass / b.material.density] for b in O.bodies], open({str(found)!r}, 'w'))\n")
        run("yade", "-n", "-x", script.with_name("count.py"))
        blocks, volumes = zip(*json.loads(found.read_text()))
        self.add("blocks.py", "YADE", len(set(blocks)), len(self.network.area), "blocks")
        self.add("blocks.py", "YADE", sum(volumes), self.network.area.sum(), "volume of a slice of 1 m [m3]", 1e-6)
        of_block = numpy.bincount(blocks, volumes, len(self.network.area))
        self.add("blocks.py", "YADE", int(numpy.isclose(of_block, self.network.area, rtol=1e-6).sum()), len(self.network.area),
                 "blocks with their volume")


def main():
    programs, scene, out = (pathlib.Path(word).resolve() for word in sys.argv[1:4])
    out.mkdir(parents=True, exist_ok=True)
    source = out / "network.h5"
    run(programs / "jointgen", scene, "-q", "-o", source)

    def export(path, *options):
        run(programs / "jointexport", source, "-q", "-o", path, *options)

    network = Network(source)
    check = Check(export, network, out)
    traces, length = len(network.trace_joint), network.trace_length
    check.outline = network.edge_length[network.kind == 0].sum()
    check.geo(traces, length)
    check.dxf(traces, length)
    check.gmsh()
    check.vtu()
    check.vtkhdf()
    check.yade()
    lines = ["| file | reader | what | read back | in the HDF5 file | |", "|---|---|---|---|---|---|"]
    lines += ["| " + " | ".join(row) + " |" for row in check.rows]
    (out / "readers.md").write_text("\n".join(lines) + "\n")
    print("\n".join(lines))
    sys.exit(check.failed)


if __name__ == "__main__":
    main()
