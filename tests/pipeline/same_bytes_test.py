"""The same scene and seed give the same bytes, whatever files are called and however many threads work."""

import h5py

from chain import ChainTest, changed, main

# Coarse in everything but zones: the solver uses a second thread from 2000 zones on.
QUICK = ["--zone-size", "2", "--tolerance", "1e-3"]


class SameBytes(ChainTest):
    def setUp(self):
        self.text = self.chain.text("tests/pipeline/random_slope.toml")

    def network_bytes(self, text, *arguments):
        return self.chain.network(text, *arguments).read_bytes()

    def run_to(self, name, program, source, *arguments):
        """Bytes of the program's output under this name in a folder of its own."""
        return self.chain.run(program, source, self.chain.new_folder() / name, *arguments).read_bytes()

    def test_jointgen(self):
        network = self.network_bytes(self.text)
        self.assertEqual(self.network_bytes(self.text), network)
        self.assertEqual(self.network_bytes(self.text, "--seed", 7), network)  # the scene's
        self.assertEqual(self.network_bytes(self.text, "--realization", 0, "--quiet"), network)
        others = [
            self.network_bytes(self.text, "--seed", 8),
            self.network_bytes(self.text, "--realization", 1),
            self.network_bytes(changed(self.text, '^title = "Slope', 'title = "A slope')),
        ]
        self.assertEqual(len({network, *others}), 4)

    def test_another_seed_is_another_network(self):
        """Not only other attributes: other joints."""
        ends = set()
        for arguments in [], ["--seed", 8], ["--realization", 1]:
            with h5py.File(self.chain.network(self.text, *arguments)) as file:
                ends.add(file["/joints/from"][:].tobytes())
        self.assertEqual(len(ends), 3)

    def test_whole_chain(self):
        network = self.chain.network(self.text)
        joints = self.chain.run("strength-averaging", network, network.with_name("joints.h5"))
        self.assertEqual(self.run_to("other name.h5", "strength-averaging", network, "-q"), joints.read_bytes())

        for engine, fewest_steps in ("relaxation", 500), ("implicit", 5):
            with self.subTest(engine=engine):
                self.same_for_names_and_threads(joints, fewest_steps, *QUICK, "--engine", engine)

    def same_for_names_and_threads(self, joints, fewest_steps, *arguments):
        result = self.chain.run("demsolve", joints, joints.with_name("result.h5"), *arguments)
        with h5py.File(result) as file:
            self.assertGreater(len(file["/mesh/zone_block"]), 4000)
            self.assertGreater(sum(file["/equilibria/steps"]), fewest_steps)
        result = result.read_bytes()
        copy = self.chain.new_folder() / "copy of joints.h5"
        copy.write_bytes(joints.read_bytes())
        self.assertEqual(self.run_to("other name.h5", "demsolve", copy, *arguments), result)
        for threads in 1, 2, 3, 7:
            with self.subTest(threads=threads):
                self.assertEqual(self.run_to("result.h5", "demsolve", joints, *arguments, "--threads", threads), result)
        self.assertNotEqual(self.run_to("result.h5", "demsolve", joints, *arguments, "--no-creep"), result)

    def test_export(self):
        network = self.chain.network(self.text)
        for name in "blocks.vtu", "joints.csv":
            self.assertEqual(self.run_to(name, "jointexport", network), self.run_to("x" + name, "jointexport", network))


if __name__ == "__main__":
    main()
