"""The report of jointgen: in the file, on the screen, and without a trace of it where it was not asked for."""

import re

import numpy

from chain import ChainTest, changed, datasets, main

VERDICTS = {"": 0, "too few": 1, "pass": 2, "FAIL": 3}


class Report(ChainTest):
    def setUp(self):
        self.text = self.chain.text("data/slope/scene.toml")

    def report(self, text, *arguments):
        """Datasets of the network file, and what was printed."""
        folder = self.chain.new_folder()
        (folder / "scene.toml").write_text(text)
        done = self.chain.answer("jointgen", folder / "scene.toml", "-o", folder / "network.h5", "--report", *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return folder / "network.h5", datasets(folder / "network.h5"), done.stdout

    def test_on_request(self):
        path, with_report, _ = self.report(self.text)
        without = datasets(self.chain.network(self.text))
        self.assertEqual(set(with_report), set(without))
        for name, values in without.items():
            if name.startswith("/statistics"):
                self.assertIn(values.size, (0, 1), name)
            elif name != "/provenance/options":
                numpy.testing.assert_array_equal(values, with_report[name], name)
        # It goes along, and is the same the next time.
        joints = datasets(self.chain.run("strength-averaging", path, path.with_name("joints.h5")))
        for name in with_report:
            if name.startswith("/statistics"):
                numpy.testing.assert_array_equal(joints[name], with_report[name], name)
        self.assertEqual(self.report(self.text, "--quiet")[0].read_bytes(), path.read_bytes())

    def test_screen_and_file_agree(self):
        _, found, printed = self.report(self.text)
        rows = {key.split("/")[-1]: values for key, values in found.items() if key.startswith("/statistics")}
        self.assertEqual(list(dict.fromkeys(rows["subject"])), ["bedding", "steep", "cross", "blocks", "nodes"])
        lines = [line for line in printed.split("95% from")[1].splitlines() if line.startswith("  ")][:]
        shown = [line for line in lines if re.match(r"  \S", line)]
        self.assertEqual(len(shown), len(rows["quantity"]))
        self.assertIn("rad", rows["unit"])
        for line, unit, achieved in zip(shown, rows["unit"], rows["achieved"]):
            if unit == "rad":
                self.assertRegex(line, rf"\b{re.escape(f'{numpy.degrees(achieved):.4g}')}", "degrees on the screen")
        for line, quantity, verdict in zip(shown, rows["quantity"], rows["verdict"]):
            self.assertTrue(line.startswith("  " + quantity), line)
            ending = next((word for word in VERDICTS if word and line.endswith("  " + word)), "")
            self.assertEqual(VERDICTS[ending], verdict, line)
        passed = int(re.search(r"^(\d+) pass", printed, flags=re.MULTILINE).group(1))
        self.assertEqual(passed, numpy.sum(rows["verdict"] == 2))
        self.assertGreater(passed, 20)
        has = rows["has_interval"] == 1
        self.assertTrue(numpy.all(rows["low"][has] <= rows["achieved"][has]))
        self.assertTrue(numpy.all(rows["high"][has] >= rows["achieved"][has]))
        # A second way to some of them.
        value = dict(zip(zip(rows["subject"], rows["quantity"]), rows["achieved"]))
        area = found["/blocks/area"]
        self.assertAlmostEqual(value["blocks", "area, mean weighted by area"], numpy.sum(area**2) / numpy.sum(area))
        self.assertAlmostEqual(value["blocks", "area, quantile 50 %"], numpy.sort(area)[(len(area) - 1) // 2])

    def test_poles(self):
        """Upward unit normals across the traces; zero for the fault, which has none."""
        found = datasets(self.chain.network(self.text))
        pole, from_, to = found["/joints/pole"], found["/joints/from"], found["/joints/to"]
        single = found["/names/joint_set"][found["/joints/set"]] == "fault"
        self.assertEqual(numpy.sum(single), 1)
        self.assertTrue(numpy.all(pole[single] == 0))
        numpy.testing.assert_allclose(numpy.linalg.norm(pole[~single], axis=1), 1)
        self.assertTrue(numpy.all(pole[~single, 1] >= 0))
        along = (to - from_)[~single]
        numpy.testing.assert_allclose(numpy.sum(along * pole[~single, :2], axis=1), 0, atol=1e-9)
        # And every line goes through its own point.
        offset = found["/joints/point"][~single] - from_[~single]
        numpy.testing.assert_allclose(along[:, 0] * offset[:, 1], along[:, 1] * offset[:, 0], rtol=0, atol=1e-6)

    def test_without_joint_sets(self):
        """A scene whose joints are all given has blocks and nodes to report, and nothing to judge."""
        _, found, printed = self.report(self.chain.text("data/column/scene.toml"))
        self.assertEqual(set(found["/statistics/subject"]), {"blocks", "nodes"})
        self.assertTrue(numpy.all(found["/statistics/verdict"] == 0))
        self.assertIn("0 pass, 0 fail", printed)

    def test_a_set_outside_the_section(self):
        text = changed(self.text, r'^name = "cross".*$', 'name = "cross"\nregion_m = [[900, 0], [950, 0], [950, 50]]')
        _, found, _ = self.report(text)
        self.assertNotIn("cross", found["/statistics/subject"])


if __name__ == "__main__":
    main()
