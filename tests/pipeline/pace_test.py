"""Both dynamic engines and a bare loop of the same arithmetic move a slope alike, on one thread and on two; how fast is not asked."""

import csv
import subprocess

from chain import ChainTest, main


class Pace(ChainTest):
    def test_the_engine_moves_as_the_bare_loop(self):
        benchmark = self.chain.programs.parent / "tests/relaxation/pace_benchmark"
        joints = self.chain.joints(self.chain.text("data/slope/scene.toml"))
        done = subprocess.run([benchmark, joints, "3", "80", "1"], capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, 0, done.stderr)
        ways = list(csv.DictReader(done.stdout.splitlines()))
        self.assertEqual([way["threads"] for way in ways], ["1"] * 5 + ["2"] * 5)
        for way in ways:
            self.assertGreater(int(way["zones"]), 5000)


if __name__ == "__main__":
    main()
