"""Memory that is too little for the solver: the bytes of a run without a limit, or code 5 and `out of memory`, within a time."""

import pathlib
import resource
import subprocess

from chain import ChainTest, main

MB = 2**20
LONGEST = 60  # s, for a run of some tenths of a second


class Memory(ChainTest):
    def run_within(self, joints, output, size, *options):
        """A run of demsolve that has so much address space [bytes], or any."""
        def limit():
            if size:
                resource.setrlimit(resource.RLIMIT_AS, (size, size))

        return subprocess.run([self.chain.programs / "demsolve", joints, "-q", "-o", output, *options],
                              capture_output=True, text=True, timeout=LONGEST, preexec_fn=limit)

    def test_sizes_at_which_libraries_run_out(self):
        """About 105 MB are too little for CHOLMOD, whose error is not that of a matrix which is not positive definite. About
        108 MB are too little for OpenBLAS, which asked for its buffer for ever. The sizes go from too little for the program's
        own allocations to enough."""
        scene = pathlib.Path(__file__).with_name("kinds") / "scene.toml"
        network = self.chain.run("jointgen", scene, self.chain.new_folder() / "network.h5")
        joints = self.chain.run("strength-averaging", network, network.with_name("joints.h5"))
        self.sweep(joints, (*range(90, 130, 2), 150, 200, 300, 600), "--zone-size", "1.2")

    def test_rock_that_yields(self):
        """UMFPACK factorises then; its analysis and its solution can be what runs out, too."""
        joints = self.chain.joints(self.chain.text("data/verification/punch/scene.toml"))
        self.sweep(joints, (*range(200, 300, 6), 400, 600))

    def test_small_limits_at_the_start(self):
        """A small stack is enough for small work. Where address space ends before the program has its stack, that is told."""
        def codes(limit, sizes):
            return [subprocess.run([self.chain.programs / "jointgen", "--version"], capture_output=True, timeout=LONGEST,
                                   preexec_fn=lambda size=size: resource.setrlimit(limit, (size, size))).returncode for size in sizes]

        self.assertEqual(codes(resource.RLIMIT_STACK, (MB // 2, MB, 2 * MB, 3 * MB)), [0] * 4)
        found = codes(resource.RLIMIT_AS, range(10 * MB, 40 * MB, MB // 8))
        self.assertEqual(found, sorted(found, key=[127, 1, 5, 0].index))  # 127 and 1: of the loader and of OpenMP, before the program
        self.assertLessEqual({5, 0}, set(found))

    def sweep(self, joints, sizes, *options):
        output = joints.with_name("result.h5")
        self.assertEqual(self.run_within(joints, output, None, *options).returncode, 0)
        wanted, codes = output.read_bytes(), []
        for size in sizes:
            output.unlink(missing_ok=True)
            with self.subTest(megabytes=size):
                done = self.run_within(joints, output, size * MB, *options)
                codes.append(done.returncode)
                if done.returncode == 0:
                    self.assertTrue(output.read_bytes() == wanted)
                else:
                    self.assertEqual((done.returncode, done.stderr.strip().splitlines()[-1:]), (5, ["demsolve: out of memory"]))
                    self.assertEqual([*output.parent.glob("result*")], [])
        self.assertEqual({0, 5}, set(codes))


if __name__ == "__main__":
    main()
