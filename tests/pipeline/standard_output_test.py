"""-o -: the same bytes on standard output as in a file, and nothing else; what is no single text file is refused. And -V, -v."""

import subprocess
import sys

from chain import ChainTest, main

TEXT = {"csv", "xdmf", "geojson", "svg", "yade"}  # formats of one text file
PROGRAMS = ["jointgen", "strength-averaging", "demsolve", "jointexport", "creepfit", "jointcreep", "jointverify"]


class StandardOutput(ChainTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.result = cls.chain.result(cls.chain.text("data/column/scene.toml"))
        cls.folder = cls.result.parent

    def answer(self, program, *arguments, **more):
        """Exit code, stdout and stderr, as bytes."""
        done = subprocess.run([self.chain.programs / program, *arguments], cwd=self.folder, timeout=300,
                              **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **more})
        return done.returncode, done.stdout, done.stderr

    def same(self, name, program, *arguments):
        """Checks that -o - says what -o NAME writes. Returns it."""
        code, _, said = self.answer(program, *arguments, "-o", name)
        self.assertEqual(code, 0, said)
        before = set(self.folder.iterdir())
        code, text, said = self.answer(program, *arguments, "-o", "-")
        self.assertEqual((code, text), (0, (self.folder / name).read_bytes()), said)
        self.assertEqual(set(self.folder.iterdir()), before)
        return text

    def refused(self, words, program, *arguments):
        before = set(self.folder.iterdir())
        code, text, said = self.answer(program, *arguments, "-o", "-")
        self.assertEqual((code, text), (2, b""), said)
        self.assertIn(words, said.decode())
        self.assertEqual(set(self.folder.iterdir()), before)

    def test_formats(self):
        """Every format of jointexport, of the network and, where it has states, of the result."""
        rows = [line.split("\t") for line in self.answer("jointexport", "--formats")[1].decode().splitlines()[1:]]
        self.assertLess(TEXT, {row[0] for row in rows})
        for name, extension, holds, *_, how in rows:
            file = "result.h5" if "zones" in holds.split() else "network.h5"
            arguments = file, "--format", name, *(["--width", "1"] if name in ("fracman", "dfnworks") else [])
            with self.subTest(name):
                if name in TEXT:
                    self.assertGreater(len(self.same(f"out{extension.split()[0]}", "jointexport", *arguments)), 100)
                elif "not in this build" not in how:
                    several = name not in ("vtu", "vtkhdf", "gpkg", "shp")
                    self.refused("is several files" if several else "is binary", "jointexport", *arguments)

    def test_histories(self):
        text = self.same("histories.csv", "jointexport", "result.h5", "--format", "csv", "--what", "histories")
        self.assertTrue(text.startswith(b"time_day"))

    def test_format_is_needed(self):
        self.refused("give the format by --format. Formats that are text: csv,", "jointexport", "result.h5")

    def test_hdf5_is_refused(self):
        for program, source in ("jointgen", "scene.toml"), ("strength-averaging", "network.h5"), ("demsolve", "joints.h5"):
            self.refused("binary file (HDF5)", program, source)
        code, _, said = self.answer("demsolve", "joints.h5", "-o", "other.h5", "--checkpoint", "-")
        self.assertEqual(code, 2)
        self.assertIn(b"--checkpoint is '-'; only -o can be standard output", said)

    def test_a_file_of_that_name(self):
        self.assertEqual(self.answer("jointgen", "scene.toml", "-q", "-o", "./-")[0], 0)
        self.assertEqual((self.folder / "-").read_bytes(), (self.folder / "network.h5").read_bytes())
        (self.folder / "-").unlink()

    def test_stdout_that_is_full(self):
        with open("/dev/full", "wb") as full:
            code, _, said = self.answer("jointexport", "result.h5", "--format", "csv", "-o", "-", stdout=full)
        self.assertEqual(code, 4, said)
        self.assertIn(b"stdout could not be written", said)

    def test_creepfit(self):
        script = self.chain.source / "pipelines/column/measured.py"
        subprocess.run([sys.executable, script, self.folder / "scene.toml", "-o", self.folder / "measured.csv"], check=True)
        (self.folder / "curve.csv").write_text("time_day,displacement_mm\n" + "".join(f"{t},{2 - 2.0**-t}\n" for t in range(9)))
        self.assertTrue(self.same("found.csv", "creepfit", "curve.csv").startswith(b"quantity,"))
        fit = "creepfit", "joints.h5", "--measurements", "measured.csv", "--fit", "kelvin-stiffness,joint-stiffness"
        self.assertTrue(self.same("factors.csv", *fit).startswith(b"factor,"))
        code, text, said = self.answer(*fit, "--runs", "2", "-o", "-")
        self.assertEqual((code, text), (3, b""))
        self.assertIn(b"the best factors are kept in a file only: -o FILE", said)

    def test_jointcreep(self):
        rows = [f"{n},{x},{0.1 * n}\n" for n in range(1, 41) for x in (0.2 * n, 0.2 * n + 1 + n % 3)]
        (self.folder / "traces.csv").write_text("id,x_m,y_m\n" + "".join(rows))
        self.assertIn(b"[[joint_set]]", self.same("sets.toml", "jointcreep", "fit", "traces.csv", "--window", "0,0,10,5"))
        self.assertTrue(self.same("report.html", "jointcreep", "report", "result.h5").startswith(b"<!"))
        for name in "run", "study":
            self.refused(f"{name} makes a folder", "jointcreep", name, "scene.toml")

    def test_version(self):
        for program in PROGRAMS:
            code, short, _ = self.answer(program, "-V")
            self.assertEqual((code, short), (0, self.answer(program, "--version")[1]), program)
            self.assertTrue(short.startswith(program.encode() + b" "))
            code, text, said = self.answer(program, "-v")
            self.assertEqual((code, text), (2, b""))
            self.assertIn(b"-V", said)


if __name__ == "__main__":
    main()
