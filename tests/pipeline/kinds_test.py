"""Every kind of joint set, with files beside the scene, through the programs."""

import h5py
import numpy as np

from chain import ChainTest, datasets, main

FILES = "scene.toml", "poles.csv", "traces.geojson"
MAPPED_STEP = 1024  # as in libs/sampling/joint_sets.hpp


class Kinds(ChainTest):
    def scene(self, **texts):
        """A folder with the scene and its files; None leaves one out."""
        folder = self.chain.new_folder()
        for name in FILES:
            text = texts.get(name.split(".")[0], self.chain.text(f"tests/pipeline/kinds/{name}"))
            if text is not None:
                (folder / name).write_text(text)
        return folder / "scene.toml"

    def network(self, scene, *arguments):
        return self.chain.run("jointgen", scene, self.chain.new_folder() / "network.h5", *arguments)

    def ends_of(self, network, name):
        data = datasets(network)
        rows = data["/joints/set"] == list(data["/names/joint_set"]).index(name)
        return data["/joints/number"][rows], data["/joints/from"][rows], data["/joints/to"][rows]

    def test_every_set_has_joints_and_edges(self):
        data = datasets(self.network(self.scene()))
        self.assertEqual(list(data["/names/joint_set"]),
                         ["bedding", "cross joints", "coins", "sheets", "map fault", "map joints"])
        on_edges = data["/edges/joint"]
        for index, name in enumerate(data["/names/joint_set"]):
            self.assertIn(index, data["/joints/set"], name)
            self.assertIn(index, data["/joints/set"][on_edges[on_edges >= 0]], name)

    def test_the_report_names_what_it_does_not_look_at(self):
        done = self.chain.answer("jointgen", self.scene(), "--check", "--report")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stdout.splitlines()[-1],
                         'not looked at: "sheets" (in some rocks only); "map fault" (mapped); "map joints" (mapped)')

    def test_what_shows_only_on_sampling_names_the_scene(self):
        text = self.chain.text("tests/pipeline/kinds/scene.toml").replace("P21_per_m = 0.18", "P21_per_m = 1e6", 1)
        scene = self.scene(scene=text)
        done = self.chain.answer("jointgen", scene, "--check")
        self.assertEqual(done.returncode, 2)
        self.assertIn(f'{scene}: joint set "bedding"', done.stderr)

    def test_mapped_joints_keep_their_ids(self):
        network = self.network(self.scene())
        number, start, end = self.ends_of(network, "map fault")
        self.assertEqual(list(number), [17 * MAPPED_STEP + piece for piece in range(3)])
        np.testing.assert_array_equal(start, [[-1, 30], [20, 21], [38, 16]])
        np.testing.assert_array_equal(end, [[20, 21], [38, 16], [61, 5]])
        number, start, _ = self.ends_of(network, "map joints")
        self.assertEqual(list(number), [4 * MAPPED_STEP, 4 * MAPPED_STEP + 1, 5 * MAPPED_STEP])
        np.testing.assert_array_equal(start, [[5, 2], [10, 14], [30, 1]])

    def test_the_network_carries_the_files(self):
        """The scene's copy alone gives the same network, and later programs need no other file."""
        scene = self.scene()
        network = self.network(scene)
        with h5py.File(network) as file:
            held = file["/scene"].asstr()[0]
        self.assertTrue(held.startswith(scene.read_text()))
        alone = self.scene(scene=held, poles=None, traces=None)
        first, second = datasets(network), datasets(self.network(alone))
        for name in first:
            if name != "/provenance/input_sha256":
                np.testing.assert_array_equal(first[name], second[name], err_msg=name)
        for path in scene.parent.iterdir():
            path.unlink()
        joints = self.chain.run("strength-averaging", network, network.with_name("joints.h5"))
        self.chain.run("demsolve", joints, joints.with_name("result.h5"), "--zone-size", 8)

    def test_files_that_are_wrong_or_missing_are_refused(self):
        traces = self.chain.text("tests/pipeline/kinds/traces.geojson")
        cases = {
            "expected the name of a file beside the scene": {"poles": None},
            "line 4: dip_deg is \"x\"": {"poles": "# a\ndip_deg,dip_direction_deg\n1,2\nx,3\n"},
            "is not JSON": {"traces": traces[:-9]},
            "feature 0 has the coordinates": {"traces": traces.replace("[20, 21]", "[20, 21, 0, 1]", 1)},
            "whose set is \"J\"": {"traces": traces.replace('"J"', '"K"')},
        }
        for wanted, texts in cases.items():
            with self.subTest(wanted):
                scene = self.scene(**texts)
                output = scene.with_name("network.h5")
                done = self.chain.answer("jointgen", scene, "-o", output)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertIn(wanted, done.stderr)
                self.assertRegex(done.stderr, r"scene\.toml, line \d+: \[\[")
                self.assertFalse(output.exists())

    def test_a_file_that_is_not_utf_8_is_refused_by_its_name_and_line(self):
        scene = self.scene()
        scene.with_name("poles.csv").write_bytes(b"dip_deg,dip_direction_deg\n1,2\n3,4 # \xe9\n")
        done = self.chain.answer("jointgen", scene, "-o", scene.with_name("network.h5"))
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, r"poles\.csv, line 3: .*UTF-8")

    def test_a_byte_order_mark_is_dropped(self):
        """As editors on Windows write it, before the scene and each of its files: /scene is the same as without."""
        plain, marked = self.scene(), self.scene()
        for name in FILES:
            path = marked.with_name(name)
            path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
        first, second = datasets(self.network(plain)), datasets(self.network(marked))
        for name in first:
            if name != "/provenance/input_sha256":
                np.testing.assert_array_equal(first[name], second[name], err_msg=name)

    def test_utf_16_is_refused_by_its_name(self):
        for name in FILES:
            for code in "utf-16", "utf-16-le", "utf-16-be":
                with self.subTest(name, code=code):
                    scene = self.scene()
                    path = scene.with_name(name)
                    path.write_text(path.read_text(), encoding=code)
                    done = self.chain.answer("jointgen", scene, "-o", scene.with_name("network.h5"))
                    self.assertEqual(done.returncode, 2, done.stderr)
                    self.assertIn(f"{path}: the text is UTF-16; expected UTF-8", done.stderr)
                    self.assertFalse(scene.with_name("network.h5").exists())

    def test_files_are_beside_the_scene(self):
        """In its folder or a folder there. Another place is refused at the key, and nothing is read from it."""
        text = self.chain.text("tests/pipeline/kinds/scene.toml")
        for name in "traces.geojson", "poles.csv":
            line = 1 + text[:text.index(f'"{name}"')].count("\n")
            scene = self.scene()
            folder = scene.parent
            (folder / "map").mkdir()
            (folder.parent / name).write_bytes((folder / name).read_bytes())
            (folder / name).rename(folder / "map" / name)
            for path in f"map/{name}", f"./map/{name}":
                scene.write_text(text.replace(f'"{name}"', f'"{path}"'))
                self.network(scene)
            for path in f"../{name}", f"map/../map/{name}", f"{folder}/map/{name}", "..":
                with self.subTest(path):
                    scene.write_text(text.replace(f'"{name}"', f'"{path}"'))
                    done = self.chain.answer("jointgen", scene, "--check")
                    self.assertEqual(done.returncode, 2, done.stderr)
                    self.assertRegex(done.stderr, rf"scene\.toml, line {line}: .*expected the name of a file in the folder")

    def test_other_sets_stay_the_same(self):
        """Byte for byte, when a set changes, comes, goes or moves; but traces end at other traces."""
        text = self.chain.text("tests/pipeline/kinds/scene.toml")
        network = self.network(self.scene())
        sets = text.split("[[joint_set]]")
        last, rest = sets[4].split("[[mapped]]", 1)
        head, sets = sets[0], ["[[joint_set]]" + one for one in sets[1:4] + [last]]
        variants = {
            "turned round": [*sets[::-1]],
            "another length": [sets[0], sets[1].replace("mean_m = 12", "mean_m = 9"), *sets[2:]],
            "without the last": sets[:3],
            "another diameter": [*sets[:2], sets[2].replace("mean_m = 8", "mean_m = 5"), sets[3]],
        }
        changed = {"another length": "cross joints", "without the last": "sheets", "another diameter": "coins"}
        for what, changed_sets in variants.items():
            other = self.network(self.scene(scene=head + "".join(changed_sets) + "[[mapped]]" + rest))
            for name in "bedding", "cross joints", "coins", "sheets", "map fault", "map joints":
                if what == "without the last" and name == "sheets":
                    continue
                ours, theirs = self.ends_of(network, name), self.ends_of(other, name)
                same = [a.tobytes() for a in ours] == [a.tobytes() for a in theirs]
                self.assertEqual(same, changed.get(what) != name, f"{what}: {name}")
        # A change of the bedding moves the ends of the cross joints, and nothing else of theirs.
        other = self.network(self.scene(scene=text.replace("P21_per_m = 0.18", "P21_per_m = 0.25")))
        ours, theirs = self.ends_of(network, "cross joints"), self.ends_of(other, "cross joints")
        self.assertNotEqual(ours[1].tobytes(), theirs[1].tobytes())
        common = np.intersect1d(ours[0], theirs[0])
        self.assertGreater(len(common), 20)
        angles = []
        for number, start, end in ours, theirs:
            run = (end - start)[np.isin(number, common)]
            angles.append(np.arctan2(run[:, 1], run[:, 0]))
        np.testing.assert_allclose(*angles, atol=1e-9)
        self.assertEqual(self.ends_of(network, "coins")[1].tobytes(), self.ends_of(other, "coins")[1].tobytes())


if __name__ == "__main__":
    main()
