"""The line of progress on a terminal, and what a run that is stopped leaves."""

import fcntl
import os
import pathlib
import pty
import re
import select
import signal
import struct
import subprocess
import termios
import time

from chain import ChainTest, changed, datasets, main
from restart_test import SCENE, sliding_block

COLUMNS = 80
LONGEST = 300  # s, far more than any run here takes
RATIO = r", ratio \de-\d+ of 1e-4$"
SEARCH = ("--factor-of-safety", "--safety-width", "0.02", "--no-creep", "--engine", "relaxation")


class Progress(ChainTest):
    def lines_of(self, *command):
        """All lines that a program shows on a terminal of 80 columns, without those that it says for good."""
        terminal, its = pty.openpty()
        fcntl.ioctl(its, termios.TIOCSWINSZ, struct.pack("HHHH", 24, COLUMNS, 0, 0))
        with subprocess.Popen([self.chain.programs / "demsolve", *map(str, command)], stderr=its, stdout=subprocess.DEVNULL) as running:
            os.close(its)
            shown, end = b"", time.monotonic() + LONGEST
            while time.monotonic() < end:
                if not select.select([terminal], [], [], 1)[0]:
                    continue
                try:
                    shown += os.read(terminal, 65536)
                except OSError:  # it has ended
                    break
        os.close(terminal)
        self.assertEqual(running.returncode, 0)
        lines = re.split("[\r\n]+", shown.decode().replace("\x1b[K", ""))
        return [line for line in lines if line and not line.startswith("demsolve: ")]

    def test_search(self):
        """Factor, bracket, stage, day, and ratio of 1e-4 are on the line, whatever the name of the stage."""
        text = changed(SCENE, "^size_m = 2$", "size_m = 1.2")
        text = text.replace('"upper"', '"benchmark height, all of the upper part of the slope on the northern side"')
        joints = self.chain.joints(text)
        lines = self.lines_of(joints, "-o", joints.with_name("result.h5"), *SEARCH)
        self.assertTrue(all(len(line) < COLUMNS for line in lines), max(lines, key=len))
        self.assertFalse(any("strengths x 64 (" in line or "0.015625" in line or "0.01563" in line for line in lines), lines)
        runs = [line for line in lines if re.search(r"F [\d.]+ \((at least [\d.]+|[\d.]+ to [\d.]+|below [\d.]+)\), ", line)]
        self.assertGreater(len(runs), 3, lines)
        stages = [line for line in lines if re.search(r", benchmark[^,]*(, [^,]*)*\u2026, day \d+" + RATIO, line)]
        self.assertTrue(stages, lines)
        self.assertTrue(all(re.search(RATIO, line) for line in lines if "ratio" in line), lines)

    def test_dynamic_analysis(self):
        joints = self.chain.joints(sliding_block('rigid_rocks = ["rock"]'))
        lines = self.lines_of(joints, "-o", joints.with_name("result.h5"))
        self.assertTrue(all(len(line) < COLUMNS for line in lines), lines)
        self.assertTrue(any(re.search(r"day 1.5, [\d.]+ s, largest velocity [\d.e-]+ m/s$", line) for line in lines), lines)

    def stopped(self, joints, *options, when):
        """What demsolve says when SIGINT comes as soon as `when` says so of its stderr so far."""
        result = joints.with_name("result.h5")
        command = [self.chain.programs / "demsolve", joints, "-o", result, *options]
        with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as running:
            os.set_blocking(running.stderr.fileno(), False)
            said = b""
            begin = time.monotonic()
            while not when(said, time.monotonic() - begin) and running.poll() is None:
                said += running.stderr.read() or b""
                time.sleep(0.001)
            running.send_signal(signal.SIGINT)
            os.set_blocking(running.stderr.fileno(), True)
            said = (said + running.stderr.read()).decode()
        return running.returncode, said, result.with_name("result.failed.h5")

    def check_stopped(self, code, said, failed):
        self.assertEqual(code, -signal.SIGINT, said)
        self.assertIn("demsolve: stops at the next possible moment; a second signal stops it at once\n", said)
        self.assertFalse(failed.with_name("result.h5").exists())

    def test_search_that_is_stopped(self):
        """It says the bracket that is known, and what to do."""
        for at_once in "12":
            code, said, failed = self.stopped(self.chain.joints(SCENE), *SEARCH, "--runs-at-once", at_once,
                                              when=lambda said, _: b"run 3, " in said)
            self.check_stopped(code, said, failed)
            known = re.findall("^demsolve: run .*; factor of safety ([^;\n]*)", said, re.MULTILINE)[-1]
            self.assertTrue(said.endswith(f"\ndemsolve: stopped; the factor of safety is {known}. "
                                          "With --checkpoint FILE a stopped search can continue\n"), said)
            self.assertFalse(failed.exists())

    def test_dynamic_analysis_that_is_stopped(self):
        """The states so far are in the file of a run that failed."""
        joints = self.chain.joints(sliding_block('rigid_rocks = ["rock"]'))
        for later in (0.05, 0.1, 0.25, 0.5, 1, 2, 4, 8):  # s; one of them is after its beginning and before its end
            code, said, failed = self.stopped(joints, when=lambda _, seconds, later=later: seconds > later)
            if failed.exists() and len(datasets(failed)["/states/time"]) > 1:
                break
        self.check_stopped(code, said, failed)
        self.assertTrue(said.endswith(f"\ndemsolve: stopped; the run up to there is in {failed}. "
                                      "With --checkpoint FILE a stopped run can continue\n"), said)
        data = datasets(failed)
        self.assertEqual(data["/failure/reason"], ["stopped by a signal"])
        self.assertEqual(len(data["/failure/block"]), 0)
        self.assertGreater(len(data["/states/time"]), 1)
        self.chain.run("jointexport", failed, pathlib.Path(failed).with_name("zones.vtu"))


if __name__ == "__main__":
    main()
