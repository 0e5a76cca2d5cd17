"""With too little memory a program says so: it neither hangs, nor crashes, nor finds something else."""

import os
import resource
import subprocess

from chain import ChainTest, main

MB = 2**20
LONGEST = 60  # s; the run takes less than one
STEPS = 12


class Memory(ChainTest):
    def limited(self, program, limit, *arguments):
        """The exit code of a program that has this much address space [MB]."""
        command = [self.chain.programs / program, *map(str, arguments)]
        environment = dict(os.environ, OPENBLAS_NUM_THREADS="1")  # else the limit depends on the number of processors
        done = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST, env=environment,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit * MB, limit * MB)))
        return done.returncode, done.stderr

    def least(self, program):
        """The least address space in which the program starts [MB]."""
        low, high = 0, 1000
        while high - low > 1:
            middle = (low + high) // 2
            code, _ = self.limited(program, middle, "--version")
            low, high = (low, middle) if code == 0 else (middle, high)
        return high

    def sweep(self, program, source, options, most):
        """Every run ends as the one without a limit, or with code 5; returns the codes."""
        folder = self.chain.new_folder()
        wanted = self.chain.run(program, source, folder / "wanted", *options).read_bytes()
        least = self.least(program)
        codes = []
        for step in range(STEPS + 1):
            limit = least + step * (most - least) // STEPS
            output = folder / "limited"
            code, message = self.limited(program, limit, source, "-o", output, *options)
            codes.append(code)
            with self.subTest(program=program, limit=limit):
                self.assertIn(code, (0, 5), message)
                if code == 0:
                    self.assertEqual(output.read_bytes(), wanted)
                else:
                    self.assertEqual(message.strip(), f"{program}: out of memory")
                    self.assertFalse(output.exists())
            output.unlink(missing_ok=True)
            self.assertEqual(list(folder.glob("limited*")), [])
        return codes

    def test_threads_that_cannot_start(self):
        joints = self.chain.joints(self.chain.text("data/column/scene.toml"))
        output = joints.with_name("result.h5")
        code, message = self.limited("demsolve", 500, joints, "-o", output, "--threads", "1000")
        self.assertEqual(code, 2)
        self.assertRegex(message, r"^demsolve: --threads 1000: only \d+ could be started here \(.+\); wanted fewer\n$")
        self.assertFalse(output.exists())

    def test_memory_swept(self):
        folder = self.chain.new_folder()
        scene = self.chain.source / "tests/pipeline/kinds/scene.toml"
        network = self.chain.run("jointgen", scene, folder / "network.h5")
        joints = self.chain.run("strength-averaging", network, folder / "joints.h5")
        for program, source, options, most in (("jointgen", scene, (), 120),
                                               ("strength-averaging", network, (), 120),
                                               ("demsolve", joints, ("--zone-size", "1.2"), 420)):
            codes = self.sweep(program, source, options, most)
            self.assertEqual(codes[-1], 0, "the last limit is enough")
            if program != "strength-averaging":  # which needs hardly more than to start
                self.assertIn(5, codes, "the least limit is too little")


if __name__ == "__main__":
    main()
