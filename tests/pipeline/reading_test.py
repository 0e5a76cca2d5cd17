"""jointcreep.read: tables of files and studies, against the datasets themselves."""

import math
import re
import subprocess

import h5py
import jointcreep
import numpy as np
from jointcreep import chain as programs_of_the_chain
from jointcreep import reading

from chain import LONGEST_RUN, ChainTest, datasets, main


class Files(ChainTest):
    made = None

    def result(self):
        """A result of the small scene."""
        if not Files.made:
            Files.made = self.chain.result(self.chain.small())
        return Files.made

    def test_history(self):
        run, wanted = jointcreep.read(self.result()), datasets(self.result())
        history = run.history()
        self.assertEqual(run.scene["stage"][0]["name"], "bench")
        self.assertEqual(history.point, ["crest", "dug away", "floor"])
        self.assertTrue((history.of("floor") == wanted["/history/displacement"][:, 2]).all())
        row = list(wanted["/history/event"]).index("bench")
        self.assertEqual((history.stages()[row - 1], history.stages()[row], history.stages()[-1]), (0, 1, 1))
        self.assertFalse(history.present[row, 1])
        first = history.first_reading_row[2]
        self.assertGreater(first, 0)
        self.assertTrue((history.since_first_reading()[first, 2] == 0).all())
        self.assertTrue((history.since_first_reading()[-1, 2] == history.of("floor")[-1] - history.of("floor")[first]).all())
        table = history.table()
        self.assertEqual(table.rows(), len(history.time) * 3)
        at = np.flatnonzero((table["point"] == "floor") & (table["event"] == "bench"))
        self.assertEqual((table["displacement y"][at[0]], table.units["displacement y"]), (history.of("floor")[row, 1], "m"))
        self.assertEqual(table["time"][at[0]], history.time[row])

    def test_tables(self):
        """Zones carry the section's area and weight; contacts their tractions; all with the units of the file."""
        run, wanted = jointcreep.read(self.result()), datasets(self.result())
        blocks, contacts, zones = run.blocks(), run.contacts(), run.zones(stage="bench")
        self.assertAlmostEqual(blocks["area"].sum(), 600, delta=1e-9)
        self.assertEqual((blocks.units["area"], contacts.units["normal traction"], zones.units["stress xy"]), ("m2", "Pa", "Pa"))
        state = list(wanted["/states/event"]).index("bench")
        self.assertTrue((zones["stress xy"] == wanted["/states/stress"][state, :, 2]).all())
        self.assertTrue((contacts["shear traction"] == wanted["/states/traction"][-1, :, 1]).all())
        self.assertTrue(((contacts["status"] == "removed") == (wanted["/states/contact_status"][-1] == 0)).all())
        # A contact is on a joint of its set, within what cutting moves it.
        joints, names = run.joints(), run["/names/joint_set"]
        self.assertEqual(set(contacts["set"]), {names[number] for number in set(joints["set"])})
        for name, at in zip(contacts["set"], np.stack([contacts["centre x"], contacts["centre y"]], axis=1)):
            of_set = joints["set"] == names.index(name)
            start, end = (np.stack([joints[f"{which} {axis}"][of_set] for axis in "xy"], axis=1) for which in ("from", "to"))
            along = (end - start) / np.linalg.norm(end - start, axis=1)[:, None]
            self.assertLess(np.abs(along[:, 0] * (at - start)[:, 1] - along[:, 1] * (at - start)[:, 0]).min(), 0.3, name)
        self.assertTrue((zones["block"][~zones["present"]] != zones["block"][zones["present"]][0]).all())
        moved = run.gridpoints()
        self.assertTrue((moved["displacement x"] == wanted["/states/displacement"][-1, :, 0]).all())
        for table in run.contacts, run.zones, run.gridpoints:
            for name, values in table("last").items():
                np.testing.assert_array_equal(values, table()[name])
        self.assertEqual(run.equilibria().rows(), len(wanted["/equilibria/steps"]))
        joints = run.joints()
        self.assertEqual(joints.rows(), len(wanted["/joints/set"]))
        for part, axis in enumerate("xyz"):
            np.testing.assert_array_equal(joints[f"pole {axis}"], wanted["/joints/pole"][:, part])
            np.testing.assert_array_equal(joints[f"centre {axis}"], wanted["/joints/centre"][:, part])
        self.assertEqual(run.edges()["joint fraction"].shape, wanted["/edges/joint_fraction"].shape)
        self.assertEqual((run.states().rows(), run.unit("/history/time")), (len(wanted["/states/time"]), "day"))

    def test_what_is_not_there(self):
        network = jointcreep.read(self.chain.network(self.chain.small()))
        self.assertEqual(network.kind, "network")
        text = self.chain.new_folder() / "text.h5"
        text.write_text("no HDF5 file")
        for call, expected in [
            (network.history, "there is no /history/displacement in this network file"),
            (lambda: jointcreep.read(self.result()).history().of("creast"), 'no point "creast"; there are: crest, dug away, floor'),
            (lambda: jointcreep.read(self.result()).contacts(stage="banch"), 'no stage "banch"; there are: bench'),
            (lambda: jointcreep.read(text), "text.h5: "), (lambda: jointcreep.read(text.with_name("none.h5")), "none.h5: "),
            (lambda: jointcreep.read(text.parent), "is not the folder of a study that has ended"),
        ]:
            with self.assertRaisesRegex(jointcreep.NotWanted, expected):
                call()

    def test_labels_of_axes(self):
        """Every axis of every dataset has the name of its dimension on the page of the file format, and axes of one name one length."""
        rows = re.findall(r"^\| `(/[^`]+)` \| \[([^\]]*)\]", self.chain.text("docs/file-format.md"), flags=re.MULTILINE)
        pages = {path: [name.strip() for name in names.split(",") if not name.strip().isdecimal()] for path, names in rows}
        lengths, labelled = {}, 0
        with h5py.File(self.result()) as file:
            self.assertEqual([axis.label for axis in file["/history/displacement"].dims], ["time", "point", "component"])
            self.assertEqual([axis.label for axis in file["/states/time"].dims], ["state"])
            for path in datasets(self.result()):
                found = [axis.label for axis in file[path].dims]
                wanted = pages[path] + ["component"] * (len(found) - len(pages[path]) if pages[path] else 0)
                self.assertEqual(found, wanted or [""] * len(found), path)
                for name, length in zip(pages[path], file[path].shape):
                    self.assertEqual(lengths.setdefault(name, length), length, (path, name))
                    labelled += 1
        self.assertGreater(labelled, 100)
        self.assertEqual(jointcreep.read(self.result()).axes("/states/stress"), ["state", "zone", "component"])
        self.assertEqual(lengths["edge+1"], lengths["edge"] + 1)

    def test_scales_of_the_history(self):
        """The library of HDF5 finds the dimension scales, all of a dataset: else readers of netCDF refuse it."""
        with h5py.File(self.result()) as file:
            history = file["history"]
            for name, dataset in history.items():
                is_scale = name in ("time", "point", "component")
                self.assertEqual(h5py.h5ds.is_scale(dataset.id), is_scale, name)
                found = [[scale.name for scale in axis.values()] for axis in dataset.dims]
                self.assertEqual(found, [[] if is_scale else ["/history/" + axis.label] for axis in dataset.dims], name)
                if is_scale:
                    self.assertEqual(h5py.h5ds.get_scale_name(dataset.id), name.encode())
            self.assertEqual(list(history["component"].asstr()), ["x", "y"])
            users = sum(len(dataset.dims) for name, dataset in history.items() if not h5py.h5ds.is_scale(dataset.id))
            self.assertEqual(sum(len(history[name].attrs["REFERENCE_LIST"]) for name in ("time", "point", "component")), users)

    def test_frame(self):
        """The DataFrame of a table, where pandas is there."""
        try:
            import pandas
        except ImportError:
            self.skipTest("without python3-pandas")
        contacts = jointcreep.read(self.result()).contacts()
        frame = contacts.frame()
        self.assertIsInstance(frame, pandas.DataFrame)
        self.assertEqual((list(frame), len(frame), frame.attrs["units"]), (list(contacts), contacts.rows(), contacts.units))
        self.assertTrue((frame["normal traction"].to_numpy() == contacts["normal traction"]).all())

    def test_csv(self):
        path = self.chain.new_folder() / "table.csv"
        path.write_text('run,name,crest (mm),failed\n0,a,1.5,0\n1,"b, c",,1\n')
        table = reading.csv_table(path)
        self.assertEqual((list(table["run"]), list(table["name"]), table["crest (mm)"][0]), ([0, 1], ["a", "b, c"], 1.5))
        self.assertTrue(math.isnan(table["crest (mm)"][1]))
        self.assertEqual((table["run"].dtype.kind, table["failed"].dtype.kind), ("i", "f"))
        self.assertEqual((table.units["crest (mm)"], table.units["run"], table.units["name"], table.rows()), ("mm", "1", "", 2))
        path.write_text("run,exit code,attempts\n0,,1.5\n1,3,2\n")
        table = reading.csv_table(path)
        self.assertEqual((table["exit code"].dtype.kind, list(table["attempts"])), ("f", [1.5, 2.0]))
        path.write_text("run,name\n")
        self.assertEqual(reading.csv_table(path).rows(), 0)

    def test_study(self):
        folder = self.chain.new_folder()
        (folder / "scene.toml").write_text(self.chain.small())
        (folder / "study.toml").write_text('scene = "scene.toml"\n[[vary]]\nnetwork = true\n[design]\nruns = 3\n[[collect]]\n'
                                           'name = "n"\nwhat = "blocks"\nstatistic = "number"\n[[collect]]\nname = "crest"\n'
                                           'what = "displacement"\npoint = "crest"\ncomponent = "x"\n')
        subprocess.run([self.chain.programs / "jointcreep", "study", folder / "study.toml", "-o", folder / "out", "-q"], check=True,
                       timeout=LONGEST_RUN)
        study = jointcreep.read(folder / "out")
        self.assertEqual(study.runs.rows(), 3)
        value, low, high = study.answer("mean", "n")
        self.assertAlmostEqual(value, study.runs["n"].mean(), delta=1e-12)
        self.assertLess(low, value)
        with self.assertRaisesRegex(jointcreep.NotWanted, '"mean" is there 2 times'):
            study.answer("mean")
        with self.assertRaisesRegex(jointcreep.NotWanted, '"mode" is there 0 times'):
            study.answer("mode")
        with self.assertRaisesRegex(AttributeError, "has no moons.csv"):
            study.moons

        # The example of docs/studies.md.
        page = self.chain.text("docs/studies.md")
        (example,) = re.findall(r"```python\n(.*?)```", page, flags=re.DOTALL)
        for path, ours in (("out/first", folder / "out"), ("out/slope/result.h5", self.result()), ("stress.png", folder / "stress.png")):
            self.assertIn(f'"{path}"', example)
            example = example.replace(f'"{path}"', repr(str(ours)))
        names = {}
        exec(example, names)
        self.assertEqual(names["mean"], study.answer("mean", "crest")[0])
        self.assertEqual((folder / "stress.png").read_bytes()[:4], b"\x89PNG")

    def test_the_example(self):
        """That at the head of reading.py runs, on the folder of a study and the bench slope's result."""
        example = [line[4:] for line in reading.__doc__.splitlines() if line.startswith("    ")]
        names = {}
        for line in example[:-1]:
            exec(line.replace('"result.h5"', repr(str(self.result()))).replace("bench 3", "bench"), names)
        self.assertEqual(names["contacts"].units["normal traction"], "Pa")

    def test_a_program_that_fails(self):
        """Failed with its message; the end of the script where it was stopped."""
        folder = self.chain.new_folder()
        with self.assertRaisesRegex(programs_of_the_chain.Failed, "jointgen, exit code 2: jointgen: .*no_scene"):
            programs_of_the_chain.joints_of(self.chain.programs, "no_scene = 1", folder)
        joints = programs_of_the_chain.joints_of(self.chain.programs, self.chain.small(), folder, "--realization", 3)
        self.assertEqual(joints.read_bytes(), self.chain.joints(self.chain.small(), "--realization", "3").read_bytes())
        for code, is_stopped in ((4, True), (-9, True), (137, True), (130, True), (3, False), (-11, False), (0, False), (2, False)):
            self.assertEqual(programs_of_the_chain.was_stopped(code), is_stopped, code)


if __name__ == "__main__":
    main()
