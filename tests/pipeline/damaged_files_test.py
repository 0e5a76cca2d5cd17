"""Damaged copies of the files of the chain, by damaged_files.py, to the programs that read them."""

import pathlib
import subprocess
import sys

from chain import ChainTest, changed, main

COPIES = 300
COARSE = [  # changes that make the column quick
    ("^end = 40", "end = 21"),
    ("^step_days = 1", "step_days = 10"),
    (r"^size_m = 2\.5", "size_m = 10"),
    (r"(?s)^\[equilibrium\].*", ""),
]


class DamagedFiles(ChainTest):
    @classmethod
    def setUpClass(cls):
        text = cls.chain.text("data/column/scene.toml")
        for pattern, replacement in COARSE:
            text = changed(text, pattern, replacement)
        cls.folder = cls.chain.result(text).parent

    def assert_never_fooled(self, program, file, *arguments):
        script = pathlib.Path(__file__).with_name("damaged_files.py")
        command = [sys.executable, script, self.chain.programs / program, self.folder / file, COPIES, *arguments]
        done = subprocess.run([*map(str, command)], capture_output=True, text=True, timeout=600)
        print(done.stdout)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_strength_averaging(self):
        self.assert_never_fooled("strength-averaging", "network.h5")

    def test_demsolve(self):
        self.assert_never_fooled("demsolve", "joints.h5")

    def test_jointexport(self):
        for what in "zones", "contacts":
            self.assert_never_fooled("jointexport", "result.h5", "--what", what)


if __name__ == "__main__":
    main()
