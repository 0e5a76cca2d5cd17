"""Plots draw what files of the chain hold, and a picture is there whole or not at all."""

import itertools
import os
import re
import subprocess
import sys
import unittest.mock
import xml.etree.ElementTree

import h5py
import numpy

from chain import ChainTest, changed, datasets, in_a_copy, main

PNG = b"\x89PNG\r\n\x1a\n"


class Plots(ChainTest):
    def setUp(self):
        self.plots = self.chain.source / "pipelines" / "plots"

    def test_joints_reach_the_face(self):
        """Where a stage cuts a joint, two contacts have the same gridpoints. The one of the rock that stays is drawn."""
        import figure
        import plot_state
        with figure.opened(self.chain.result(self.chain.small())) as file:
            pairs = [frozenset(pair) for pair in figure.array(file, "/mesh/contact_gridpoint").tolist()]
            status = figure.array(file, "/states/contact_status")[-1]
            drawn = plot_state.contact_lines(file, plot_state.Section(file, len(figure.array(file, "/states/time")) - 1, 0))[1]
        cut = {pair for pair, one in zip(pairs, status) if one == 0} & {pair for pair, one in zip(pairs, status) if one != 0}
        self.assertGreater(len(cut), 0)
        self.assertTrue((status[drawn] != 0).all())

    def test_contacts_that_slipped_earlier(self):
        """They stick again, and are drawn apart from those that never slipped."""
        import h5py
        from jointcreep import plots
        result = self.chain.result(self.chain.small())
        with h5py.File(result, "r+") as file:
            slip, status = file["/states/slip"], file["/states/contact_status"]
            closed = numpy.flatnonzero(status[-1] == 1)
            slip[-1, :] = numpy.where(status[-1] == 1, 1e-9, slip[-1])
            slip[-1, closed[:3]] = (0.001, -0.002, 0.003)
        legend = plots.draw("state", result, field="contacts").axes[0].get_legend()
        labels = [text.get_text() for text in legend.get_texts()]
        self.assertEqual(labels[:2], [f"{len(closed) - 3} contacts sticking", "3 sticking, slipped earlier"])

    def test_labels_of_a_small_cut(self):
        """Names of points that are close are letters with a key, and no two texts in the section overlap; in a window names stay."""
        import figure
        from jointcreep import plots
        text = self.chain.small()
        for pattern, new in ((r"\[\[0, 0\], \[30, 0\], \[30, 20\], \[0, 20\]\]", "[[0, 0], [120, 0], [120, 70], [0, 70]]"),
                             (r"\[30, 0\]$", "[120, 0]"), (r"\[30, 20\]$", "[120, 70]"), (r"\[0, 20\]$", "[0, 70]")):
            text = changed(text, pattern, new, len(re.findall(pattern, text, flags=re.MULTILINE)))
        bench = '[[stage]]\nname = "bench {}"\ndate = {}\nremove_m = [[[{}, {}], [70, {}], [70, {}], [{}, {}]]]\n'
        places = {"crest": (49.5, 69.9), "behind": (47, 69.9), "toe 1": (51, 67.2), "toe 2": (52.3, 64.8), "toe 3": (53.5, 62.3),
                  "toe": (54.7, 59.7), "floor": (57, 59.7), "floor middle": (60, 59.7)}
        schedule = "[schedule]\nstart = 0\nend = 10\n" + "".join(
            bench.format(n, n, 50 + 1.2 * n, 72.5 - 2.5 * n, 72.5 - 2.5 * n, 70 - 2.5 * n, 51.2 + 1.2 * n, 70 - 2.5 * n)
            for n in range(1, 5)) + "".join(f'[[point]]\nname = "{name}"\nat_m = [{x}, {y}]\n' for name, (x, y) in places.items())
        before, rest = text.split("[schedule]")
        network = self.chain.network(before + schedule + rest[rest.index("[creep]"):])
        picture = plots.draw("section", network)
        picture.canvas.draw()
        axes = picture.axes[0]
        boxes = {text.get_text(): text.get_window_extent() for text in axes.texts}
        self.assertEqual(sorted(boxes), sorted([*"ABCDEFGH", *"1234"]))
        for one in boxes:
            for other in boxes:
                self.assertFalse(one < other and boxes[one].overlaps(boxes[other]), (one, other))
        labels = [text.get_text() for text in axes.get_legend().get_texts()]
        self.assertLessEqual(set(places), set(labels))
        axes = plots.draw("section", network, window=(45, 55, 65, 72)).axes[0]
        self.assertLessEqual(set(places), {text.get_text() for text in axes.texts})
        figure.plt.close("all")

    def test_borders_of_joint_sets(self):
        """Pictures of contacts have the borders of region_m as one dashed line, if the window shows a part of it."""
        import figure
        from jointcreep import plots
        region = [[2, 2], [28, 2], [28, 18], [2, 18]]
        text = changed(self.chain.small(), "^persistence = 1$", f"persistence = 1\nregion_m = {region}", 2)
        result = self.chain.result(text, "--no-creep")
        for window, count in ((None, 1), ((1, 1, 10, 10), 1), ((5, 5, 25, 15), 0)):
            axes = plots.draw("state", result, field="contacts", window=window).axes[0]
            labels = [one.get_text() for one in axes.get_legend().get_texts()]
            self.assertEqual(sum("region_m" in label for label in labels), count, labels)
            dashed = [line for line in axes.lines if line.get_color() == figure.BORDER["color"]]
            self.assertEqual([line.get_xydata().tolist() for line in dashed], [[*region, region[0]]])
        # Not along the outline, where excavated rock leaves nothing that they could be seen on.
        top = max(y for _, y in figure.scene_of(h5py.File(result))["section"]["outline_m"])
        text = changed(text, "^region_m = .*", f"region_m = [[2, 2], [28, 2], [28, {top}], [2, {top}]]", 2)
        axes = plots.draw("state", self.chain.result(text, "--no-creep"), field="contacts").axes[0]
        (dashed,) = [line for line in axes.lines if line.get_color() == figure.BORDER["color"]]
        self.assertLess(numpy.nanmax(dashed.get_ydata()), top)
        self.assertLess(numpy.nanmin(dashed.get_ydata()), 3)
        axes = plots.draw("state", self.chain.result(self.chain.small(), "--no-creep"), field="contacts").axes[0]
        self.assertFalse([line for line in axes.lines if line.get_color() == figure.BORDER["color"]])
        figure.plt.close("all")

    def test_functions(self):
        """What the functions draw is what the scripts draw, also one after another; what a file lacks is an exception."""
        from jointcreep import NotWanted, plots
        result = self.chain.result(self.chain.small())
        folder = result.parent
        for name, words, options in [
            ("state", ["--field", "stress", "--window", "5", "5", "25", "15"], {"field": "stress", "window": (5, 5, 25, 15)}),
            ("section", ["--window", "-5,-5,25,15"], {"window": (-5, -5, 25, 15)}), ("blocks", ["--window=5,5,25,15"], {"window": (5, 5, 25, 15)}),
            ("histories", ["--component", "x", "--point", "floor"], {"component": "x", "point": ["floor"]}),
            ("blocks", ["--by", "set"], {"by": "set"}), ("section", [], {}), ("rose", ["--width", "20"], {"width": 20})]:
            with self.subTest(name):
                subprocess.run([sys.executable, self.plots / f"plot_{name}.py", result, *words, "-o", folder / "script.png"], check=True)
                plots.save(name, result, folder / "function.png", **options)
                self.assertEqual((folder / "script.png").read_bytes(), (folder / "function.png").read_bytes())
        safety = self.chain.run("demsolve", self.chain.joints(self.chain.text("data/verification/vertical-cut/scene.toml")),
                                folder / "safety.h5", "--factor-of-safety", "-q")
        subprocess.run([sys.executable, self.plots / "plot_safety.py", safety, "-o", folder / "script.png"], check=True)
        plots.save("safety", safety, folder / "function.png")
        self.assertEqual((folder / "script.png").read_bytes(), (folder / "function.png").read_bytes())
        axes = plots.draw("safety", safety).axes[0]
        limit = next(line for line in axes.lines if line.get_label().startswith("limit")).get_ydata()[0]
        with h5py.File(safety) as file:
            self.assertAlmostEqual(limit, 1e4 * file["/safety/largest_displacement"][()][numpy.argmin(file["/safety/factor"][()])])
        self.assertEqual({f"plot_{name}.py" for name in plots.NAMES} | {"plot_fit.py"}, {path.name for path in self.plots.glob("plot_*.py")})
        network = result.with_name("network.h5")
        for call, expected in [(lambda: plots.draw("state", network), "network.h5: there are no states in this file"),
                               (lambda: plots.draw("state", result, window=(0, 0, 9, 9), around_failure=True), "; expected one of them"),
                               (lambda: plots.draw("states", result), 'no plot "states"; there are: section, '),
                               (lambda: plots.draw("histories", result, without=network), "network.h5: "),
                               (lambda: plots.draw("safety", result), "no runs of a factor of safety"),
                               (lambda: plots.draw("section", folder / "none.h5"), "none.h5: ")]:
            with self.assertRaisesRegex(NotWanted, expected):
                call()

    started = set()

    def plot(self, name, source, picture, *options):
        """What a plot does; the first time it is started as a program, later in a copy of this process, which has
        loaded already what takes longer to load than a picture to draw."""
        command = [sys.executable, self.plots / f"plot_{name}.py", source, "-o", picture, *options]
        if name in self.started:
            return in_a_copy(*command[1:])
        self.started.add(name)
        return subprocess.run(command, capture_output=True, text=True, timeout=300)

    def column(self):
        """Path of a result file of the column, which is short and has every solver step recorded."""
        text = changed(self.chain.text("data/column/scene.toml"), r"^size_m = \S+", "size_m = 10")
        return self.chain.result(text, "--tolerance", "1e-3", "--step-history", "1")

    def test_pictures(self):
        result = self.column()
        wanted = {
            "section": ([],), "strength": ([], ["--compression", "3"]), "histories": ([], ["--closed-form", "column"], ["--readings"]),
            "blocks": (["--by", "size"], ["--by", "set"], ["--by", "rock"], ["--by", "stage"]),
            "step_history": ([], ["--point", "B"]),
            "state": (["--field", "displacement"], ["--field", "stress"], ["--field", "contacts"],
                      ["--state", "block-1-removed"], ["--state", "block 1 removed"], ["--state", "0"]),
        }
        for name, choices in wanted.items():
            for options in choices:
                with self.subTest(name, options=options):
                    picture = self.chain.new_folder() / "picture.png"
                    done = self.plot(name, result, picture, *options)
                    self.assertEqual((done.returncode, done.stderr), (0, ""))
                    self.assertEqual([path.name for path in picture.parent.iterdir()], ["picture.png"])
                    self.assertEqual(picture.read_bytes()[:8], PNG)

    def test_names_in_svg(self):
        """Whatever the names of a scene have, a picture is XML, and has the names as they are."""
        text = changed(self.chain.text("data/column/scene.toml"), r"^size_m = \S+", "size_m = 10")
        text = changed(text, '"rock"$', "'<rock> & \"$x^$\"'", 2)
        text = changed(text, '"block 1 removed"', "'<stage> & \"$x_$\"'")
        text = changed(text, '"joint under block 1"', "'<joint> & \"$x^$\"'")
        result = self.chain.result(changed(text, '"A"', "'<A> & \"$x^$\"'"), "--no-creep")
        for name, *options in [("section",), ("strength",), ("histories",), ("blocks", "--by", "set"), ("blocks", "--by", "rock"),
                               ("blocks", "--by", "stage"), ("state", "--field", "displacement", "--state", "1"), ("state", "--field", "contacts")]:
            with self.subTest(name, options=options):
                picture = self.chain.new_folder() / "picture.svg"
                done = self.plot(name, result, picture, *options)
                self.assertEqual((done.returncode, done.stderr), (0, ""))
                xml.etree.ElementTree.parse(picture)

    def test_names_of_stages_in_makefiles(self):
        """A makefile knows a stage by a plain word: no name of a scene is part of a command."""
        from stage_names import plain

        self.assertEqual(plain(["bench 1", "bench-1", "last", "2", "`touch x`", "", "-f"]),
                         ["bench-1-2", "bench-1", "last-2", "stage-2", "touch-x", "stage", "f"])
        folder = self.chain.new_folder()
        scene = folder / "scene.toml"
        scene.write_text(changed(self.chain.text("data/slope/scene.toml"), '^name = "bench 1"',
                                 "name = 'bench `touch a` $(touch b) \"1'"))
        done = subprocess.run(["make", "-n", "-C", self.chain.source / "pipelines/slope", f"SCENE={scene}", f"OUT={folder}",
                               f"BIN={self.chain.programs}"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("--state bench-touch-a-touch-b-1 ", done.stdout)
        self.assertNotRegex(done.stdout, "`|\\$\\(")
        self.assertEqual([path.name for path in folder.iterdir()], ["scene.toml"])
        names = [sys.executable, self.plots / "stage_names.py", scene]
        first = subprocess.run(names, capture_output=True, text=True)
        scene.write_bytes(b"\xef\xbb\xbf" + scene.read_bytes())
        self.assertEqual(subprocess.run(names, capture_output=True, text=True).stdout, first.stdout)
        self.assertIn("bench-touch-a", first.stdout)

    def test_monitoring_line(self):
        """The line's displacements are those of its points, turned into the line's directions; the other plots know it."""
        import figure
        import plot_histories
        import plot_line
        line = ['[[monitoring_line]]', 'name = "L"', 'from_m = [3, 2]', 'to_m = [9, 10]', 'points = 5', '[[stage]]']
        result = self.chain.result(self.chain.small().replace("[[stage]]", "\n".join(line), 1))
        with figure.checked(result) as file:
            names = figure.texts(file, "/history/point")
            points = [names.index(f"L {i}") for i in range(1, 6)]
            moved = figure.array(file, "/history/displacement")[:, points]
            distance, turned = plot_line.displacements(file, plot_line.lines_of(file, [])[0], False, False)
            anchored = plot_line.displacements(file, plot_line.lines_of(file, [])[0], False, True)[1]
            numpy.testing.assert_allclose(anchored[..., 1], (moved - moved[:, -1:]) @ [0.6, 0.8], atol=1e-15)
            numpy.testing.assert_allclose(distance, [0, 2.5, 5, 7.5, 10], atol=1e-12)
            numpy.testing.assert_allclose(turned[..., 0], moved @ [0.8, -0.6], atol=1e-15)  # to the right of the way up
            numpy.testing.assert_allclose(turned[..., 1], moved @ [0.6, 0.8], atol=1e-15)
            self.assertGreater(abs(turned[-1]).max(), 1e-6)
            self.assertEqual(plot_line.rows_of(file)[-1][0], len(moved) - 1)
            others = plot_histories.of_no_line(file, names)
            self.assertEqual([names[i] for i in others], [name for name in names if not name.startswith("L ")])
        for name, *options in [("line",), ("line", "--readings", "--line", "L"), ("line", "--anchor"), ("section",)]:
            picture = result.with_name("picture.png")
            done = self.plot(name, result, picture, *options)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertEqual(picture.read_bytes()[:8], PNG)
        import matplotlib
        from jointcreep import plots
        drawn = plots.draw("line", result)
        self.assertTrue(drawn.axes[0].get_xlabel().startswith("across the line, + to the right"))
        self.assertEqual(drawn._suptitle.get_text(), "displacements since the in-situ equilibrium")
        drawn.canvas.draw()
        self.assertFalse(matplotlib.transforms.Bbox.intersection(*(axes.xaxis.label.get_window_extent() for axes in drawn.axes)))
        self.assertEqual(plots.draw("line", result, anchor=True)._suptitle.get_text(),
                         "displacements relative to the last point, since the in-situ equilibrium")
        with unittest.mock.patch.object(plot_line, "first_reading", return_value=len(moved) - 1):
            self.assertEqual(len(plots.draw("line", result, readings=True).axes[0].lines), 2)  # the last row, and the line at 0
        self.assertEqual(drawn.axes[0].get_ylabel(), "distance from the first end (m)")
        figure.plt.close("all")
        done = self.plot("line", self.column(), result.with_name("none.png"))
        self.assertEqual(done.returncode, 2)
        self.assertIn("its scene has no [[monitoring_line]]", done.stderr)

    def test_help_and_relative_paths_of_makefiles(self):
        pipelines = self.chain.source / "pipelines"
        for makefile in sorted(pipelines.glob("*/Makefile")):
            with self.subTest(makefile.parent.name):
                done = subprocess.run(["make", "-s", "-C", makefile.parent, "help"], capture_output=True, text=True)
                top = makefile.read_text().split("\n\n")[0]
                self.assertEqual((done.returncode, done.stdout), (0, re.sub("^# ?", "", top, flags=re.MULTILINE) + "\n"))
        folder = self.chain.new_folder()
        (folder / "scene.toml").write_text(self.chain.text("data/slope/scene.toml"))
        environment = dict(os.environ, PWD=str(folder))
        environment.pop("CALLED_FROM", None)
        for names in (["SCENE=scene.toml", "OUT=results"], [f"SCENE={folder}/scene.toml", f"OUT={folder}/results"]):
            done = subprocess.run(["make", "-n", "-C", pipelines / "slope", *names, f"BIN={self.chain.programs}"], cwd=folder,
                                  env=environment, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn(f"jointgen {folder}/scene.toml -o {folder}/results/network.h5", done.stdout)

    def test_share_of_creep_in_a_closure(self):
        """A pair of points is drawn with and without creep."""
        import figure
        from jointcreep import plots, read

        result, without = (self.chain.result(self.chain.small(), *options) for options in ((), ("--no-creep",)))
        for component, of in (None, lambda history: history.closure("crest", "floor")), ("y", lambda history: history.relative(
                "crest", "floor")[:, 1]):
            picture = plots.draw("histories", result, pair=[("crest", "floor")], without=without, component=component)
            drawn = [line.get_ydata() for line in picture.axes[0].lines if len(line.get_ydata()) > 2]
            self.assertEqual(len(drawn), 2)
            for curve, path in zip(drawn, (result, without)):
                wanted = 1e3 * of(read(path).history())
                numpy.testing.assert_allclose(curve, wanted[numpy.isfinite(wanted)], atol=1e-9)
            self.assertGreater(abs(drawn[0][-1] - drawn[1][-1]), 1e-6)
            self.assertIn("without creep", [text.get_text() for text in picture.axes[0].get_legend().get_texts()])
            figure.plt.close(picture)

    def test_pairs_since_their_first_readings(self):
        """The curve of a pair, and the closure in a report, count from the later of both first readings."""
        import figure
        from jointcreep import plots, read

        result = self.chain.result(self.chain.small())
        history = read(result).history()
        first = max(int(history.first_reading_row[history.point.index(name)]) for name in ("crest", "floor"))
        self.assertGreater(first, 0)
        closure, across = history.closure("crest", "floor"), history.relative("crest", "floor")[:, 0]
        for component, values in ("closure", closure), ("x", across):
            picture = plots.draw("histories", result, pair=[("crest", "floor")], readings=True, component=component)
            curve = next(line for line in picture.axes[0].lines if len(line.get_ydata()) > 2)
            numpy.testing.assert_allclose(curve.get_ydata(), 1e3 * (values - values[first])[first:], atol=1e-9)
            self.assertEqual(curve.get_xdata()[0], history.time[first])
            self.assertIn("since the first reading of both", picture.axes[0].get_ylabel())
            figure.plt.close(picture)
        self.assertGreater(abs(closure[first]), 1e-6)
        page = result.with_name("page.html")
        self.assertEqual(self.chain.jointcreep("report", result, "--pairs", "crest,floor", "-o", page).returncode, 0)
        numbers = [1e3 * value for value in (closure[-1], *history.relative("crest", "floor")[-1], closure[-1] - closure[first])]
        self.assertIn("".join(f'<td class="number">{value:.4g}</td>' for value in numbers), page.read_text())
        self.assertIn("<th>closure since the first readings (mm)</th>", page.read_text())

    def test_picture_of_a_dynamic_analysis(self):
        result = self.chain.result(self.chain.text("data/collapse/toppling.toml"))
        picture = result.with_name("picture.png")
        done = self.plot("dynamics", result, picture)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(picture.read_bytes()[:8], PNG)
        done = self.plot("dynamics", self.column(), result.with_name("none.png"))
        self.assertEqual(done.returncode, 2)
        self.assertIn("its scene has no [large_displacements]", done.stderr)

    def test_names_of_points_do_not_overlap(self):
        import plot_section
        taken, size = [], numpy.array([22, 9])
        boxes = [plot_section.free_box(numpy.array(place, float), size, taken) for place in [(100, 0), (90, 0), (300, 0)] + 3 * [(100, 0)]]
        self.assertEqual([low[0] > place for (low, _), place in zip([box for box, _ in boxes], (100, 90, 300))], [True, False, True])
        self.assertEqual([is_far for _, is_far in boxes], [False] * 5 + [True])
        for i, box in enumerate(taken):
            self.assertTrue(plot_section.is_free(box, taken[:i]))

    def test_a_name_beside_another_place_is_a_letter(self):
        """The name of a middle point would stand over the next one, without an overlap."""
        import figure
        import plot_section
        _, axes = figure.section_axes(numpy.array([[-94, -90], [90, -90], [90, 15], [-94, 15]], float), None)
        self.addCleanup(figure.plt.close, axes.figure)
        for apart, crowded in (15, True), (40, False):
            names = [("crest", (-4, 15)), ("15 m behind", (-4 - apart, 15)), ("30 m behind", (-4 - 1.9 * apart, 15))]
            taken = []
            for _, place in names:
                taken.append((plot_section.points_of(place, axes) - 2, plot_section.points_of(place, axes) + 2))
            with self.subTest(apart=apart):
                self.assertEqual(plot_section.is_crowded(names, axes, taken), crowded)

    def test_pictures_of_joint_sets(self):
        import plot_rose
        border = 55 * (1 + numpy.array([-1e-15, 0, 1e-15]))  # equal angles but for rounding
        self.assertEqual(plot_rose.class_of(border, 10).tolist(), [6, 6, 6])
        self.assertEqual(plot_rose.class_of(numpy.array([0.0, 54.9, 174.9, 175]), 10).tolist(), [0, 5, 17, 0])
        self.assertEqual((plot_rose.class_of(numpy.array([145, 142.6, 147.4, 75]), 5) * 5).tolist(), [145, 145, 145, 75])
        scenes = {"data/slope/scene.toml": ["stereonet", "rose", "distributions"],
                  "tests/pipeline/random_slope.toml": ["rose", "distributions"]}
        for scene, names in scenes.items():
            network = self.chain.network(self.chain.text(scene))
            for name in names:
                with self.subTest(name, scene=scene):
                    picture = network.with_name(f"{name}.png")
                    done = self.plot(name, network, picture)
                    self.assertEqual((done.returncode, done.stderr), (0, ""))
                    self.assertEqual(picture.read_bytes()[:8], PNG)
        done = self.plot("stereonet", network, network.with_name("none.png"))  # of trace angles only
        self.assertEqual(done.returncode, 2)
        self.assertIn("no joint has a pole", done.stderr)
        self.assertFalse(network.with_name("none.png").exists())

    def test_pictures_say_what_they_show(self):
        """One colour for a set in all pictures; projection, hemisphere and weights; numbers on all axes of strengths; dates; widths."""
        import figure
        import matplotlib.dates
        from jointcreep import plots

        result = self.chain.result(self.chain.text("data/slope/scene.toml"), "--no-creep")
        network, joints = (result.with_name(f"{name}.h5") for name in ("network", "joints"))
        rgb = matplotlib.colors.to_hex
        wanted = dict(zip(["bedding", "steep", "cross", "fault"], figure.COLORS))

        def in_legends(picture):
            return {entry.get_text().partition(",")[0]: handle for axes in picture.axes if axes.get_legend()
                    for entry, handle in zip(axes.get_legend().get_texts(), axes.get_legend().legendHandles)}

        def words(picture):
            return "\n".join(text.get_text() for text in picture.findobj(matplotlib.text.Text))

        for name, sets in ("section", 4), ("stereonet", 3), ("rose", 4):
            found = {label: rgb(handle.get_facecolor() if hasattr(handle, "get_facecolor") else handle.get_color())
                     for label, handle in in_legends(plots.draw(name, network)).items() if label in wanted}
            self.assertEqual(found, {label: wanted[label] for label in list(wanted)[:sets]}, name)
        found = {label.removeprefix("outline mostly "): rgb(handle.get_facecolor())
                 for label, handle in in_legends(plots.draw("blocks", network, by="set")).items() if label.startswith("outline mostly")}
        self.assertEqual(found, {label: rgb(figure.pale(wanted[label])) for label in found})
        self.assertGreaterEqual(len(found), 3)
        bars = {axes.get_title(loc="left"): axes.patches[0].get_edgecolor() for axes in plots.draw("distributions", network).axes[:6:2]}
        self.assertEqual({name: rgb(color) for name, color in bars.items()}, {name: wanted[name] for name in list(wanted)[:3]})

        strengths = plots.draw("strength", joints).axes
        found = {axes.get_title().partition(" (")[0]: rgb(line.get_color()) for axes in strengths for line in axes.lines
                 if line.get_label() == "equivalent"}
        self.assertEqual(found, wanted)
        self.assertTrue(all(axes.xaxis.get_major_ticks()[0].label1.get_visible() for axes in strengths))

        self.assertRegex(words(plots.draw("stereonet", network)), "lower hemisphere, equal-area projection;\neach joint counts once")
        self.assertRegex(words(plots.draw("rose", network)), "weighted by their length")

        (axes,) = plots.draw("histories", result).axes
        axes.figure.canvas.draw()
        labels = [label.get_text() for label in axes.get_xticklabels()]
        self.assertEqual(axes.get_xlabel(), "date (start: 2001-03-01)")
        self.assertGreaterEqual(len(labels), 3)
        for day, label in zip(axes.get_xticks(), labels):
            self.assertRegex(label, r"^200[12]-\d\d-01$")  # where months begin
            self.assertEqual(matplotlib.dates.datestr2num(label) - matplotlib.dates.datestr2num("2001-03-01"), day)

        picture = plots.draw("state", result, field="contacts")
        drawn = [width for lines in picture.axes[0].collections for width in numpy.ravel(lines.get_linewidth())]
        said = {label: handle.get_linewidth() for label, handle in in_legends(picture).items()}
        slips = next(width for label, width in said.items() if "slipping; this width: shear displacement" in label)
        self.assertEqual(slips, max(drawn))  # that of the largest slip
        self.assertTrue(all("this width" in label for label in said if "thinnest" in label), said)  # no sign of its own

    def test_scale_of_a_window(self):
        """Colours are those of what the window shows; so are the numbers of the legend. Units stand beside a word."""
        import figure
        import plot_state
        from jointcreep import plots

        result, window = self.chain.result(self.chain.small(), "--no-creep"), (1, 1, 9, 9)
        found = datasets(result)
        zones = found["/mesh/zone_gridpoint"][found["/states/zone_present"][-1] == 1]
        inside = ((found["/mesh/gridpoint_position"] > 1) & (found["/mesh/gridpoint_position"] < 9)).all(axis=1)[zones].any(axis=1)
        size = 1e3 * numpy.linalg.norm(found["/states/displacement"][-1], axis=1)
        drawn = {}
        for field in "displacement", "stress":
            picture = plots.draw("state", result, window=window, field=field)
            picture.canvas.draw()
            drawn[field] = next(one.norm for one in picture.axes[0].collections if one.get_array() is not None)
            labels = [text.get_text() for text in picture.findobj(figure.matplotlib.text.Text) if "(" in text.get_text()]
            self.assertFalse([label for label in labels for line in label.splitlines() if line in ("(mm)", "(MPa)")], labels)
            figure.plt.close(picture)
        self.assertAlmostEqual(drawn["displacement"].vmax, size[zones[inside]].max())
        self.assertLess(drawn["displacement"].vmax, size[zones].max())
        stress = found["/states/stress"][-1][found["/states/zone_present"][-1] == 1][inside]
        wanted = numpy.percentile(1e-6 * plot_state.principal(stress)[0], [0.5, 99.5])
        numpy.testing.assert_allclose([drawn["stress"].vmin, drawn["stress"].vmax], wanted)
        label = "displacement since the in-situ equilibrium (mm)"
        self.assertEqual(plot_state.lines_of(label, 46), "displacement since the\nin-situ equilibrium (mm)")
        self.assertEqual(plot_state.lines_of(label, 47), label)
        self.assertEqual(plot_state.lines_of(label, 16).splitlines()[-1], "equilibrium (mm)")

    def test_other_criteria_have_no_line(self):
        """Barton and Bandis's strength is no line of Coulomb's criterion."""
        from jointcreep import plots

        law = "joint_roughness_coefficient = 8\njoint_wall_strength_MPa = 50\nlargest_closure_mm = 0.3\n"
        text = changed(self.chain.text("data/column/scene.toml"), "^(tensile_strength_MPa = 0).*$", rf"\1\n{law}", count=2)
        text = changed(text, "^(normal|shear)_kelvin.*\n", "", count=8)
        joints = self.chain.joints(text)
        shown = [axes for axes in plots.draw("strength", joints).axes if axes.get_visible()]
        self.assertEqual(len(shown), 3)
        for axes in shown:
            self.assertIn("Barton-Bandis", axes.texts[0].get_text())
            self.assertEqual([line for line in axes.lines if line.get_label() == "equivalent"], [])

    def test_stereonet_places_poles(self):
        """A plane that dips steeply to the east has its pole far west, in the lower hemisphere."""
        import plot_stereonet

        dip, direction, azimuth = numpy.radians([80, 90, 30])
        upward = numpy.array([[numpy.sin(dip) * numpy.cos(direction - azimuth), numpy.cos(dip),
                               numpy.sin(dip) * numpy.sin(direction - azimuth)]])
        ((east, north, down),) = plot_stereonet.downward(upward, azimuth)
        numpy.testing.assert_allclose([east, north, down], [-numpy.sin(dip), 0, numpy.cos(dip)], atol=1e-12)
        numpy.testing.assert_allclose(plot_stereonet.pole_of((dip, direction)), [[east, north, down]], atol=1e-12)
        ((x, y),) = plot_stereonet.net(numpy.array([[east, north, down]]))
        self.assertAlmostEqual(x, -2**0.5 * numpy.sin(dip / 2))  # Schmidt's projection
        self.assertAlmostEqual(y, 0)

    def test_laws_are_densities(self):
        import joint_sets

        x = numpy.linspace(0, 400, 400001)[1:]
        for law in [{"law": "negative exponential", "mean_m": 6}, {"law": "lognormal", "mean_m": 6, "deviation_m": 4},
                    {"law": "normal", "mean_m": 6, "deviation_m": 2},
                    {"law": "uniform", "shortest_m": 2, "longest_m": 9},
                    {"law": "power", "exponent": 2.5, "shortest_m": 2, "longest_m": 50},
                    {"law": "power", "exponent": 1, "shortest_m": 2, "longest_m": 50}]:
            curve = joint_sets.density(law, x)
            self.assertAlmostEqual(numpy.trapz(curve, x), 1, places=2)
            if law["law"] in ("lognormal", "negative exponential"):
                self.assertAlmostEqual(numpy.trapz(x * curve, x), law["mean_m"], places=2)

    def test_whole_or_not_at_all(self):
        import figure

        class Fails:
            def savefig(self, path):
                path.write_bytes(PNG)
                raise OSError("disk full")

        picture = self.chain.new_folder() / "picture.png"
        picture.write_text("the old one")
        with self.assertRaises(OSError):
            figure.save(Fails(), picture)
        self.assertEqual([path.name for path in picture.parent.iterdir()], ["picture.png"])
        self.assertEqual(picture.read_text(), "the old one")
        done = self.plot("section", self.column(), picture.with_name("picture.unknown"))
        self.assertEqual(done.returncode, 4)
        self.assertEqual(len(list(picture.parent.iterdir())), 1)

    def test_stages_in_the_trace(self):
        """Each begins after the solver steps of all equilibria before it."""
        import figure
        import plot_step_history

        result = self.column()
        found = datasets(result)
        before = numpy.concatenate([[0], numpy.cumsum(found["/equilibria/steps"])])
        with figure.opened(result) as file:
            rows = plot_step_history.stage_rows(file)
        self.assertEqual(len(rows), 3)
        for day, row in zip((1, 10, 20), rows.values()):
            last = numpy.flatnonzero(found["/equilibria/time"] == day)[-1]
            self.assertEqual(row, before[last])

    def test_bracket_of_a_factor_of_safety(self):
        from plot_safety import bracket, in_words

        factor = numpy.array([1 / 64, 1, 2, 1.5, 1.25, 1.125])
        self.assertEqual(bracket(factor, numpy.array([1, 1, 0, -1, 0, 1])), (1.125, 1.25))
        self.assertEqual(bracket(factor, numpy.array([1, 1, 0, -1, 1, 1])), (1.25, 1.5))
        self.assertEqual(bracket(factor[:2], numpy.array([1, 1])), (1, None))
        self.assertEqual(bracket(factor[:2], numpy.array([0, 0])), (None, 1 / 64))
        self.assertEqual(in_words(1.125, 1.25, False), "between 1.125 and 1.25")
        self.assertEqual(in_words(1.25, 1.5, True), "at least 1.25, undecided at 1.5")

    def test_slivers_do_not_rule_the_scale(self):
        import plot_blocks

        area = numpy.array([1e-9] * 50 + [10.0] * 10 + [400.0])
        low, high = plot_blocks.size_range(area)
        self.assertEqual((low, high), (10, 400))
        low, high = plot_blocks.size_range(numpy.array([7.0, 7.0]))
        self.assertLess(low, 7)
        self.assertGreater(high, 7)

    def test_blocks_wholly_in_the_window(self):
        """They make the scale of sizes; if there is none, all blocks do."""
        import figure
        import plot_blocks

        def square(x, y, side):
            return figure.matplotlib.path.Path([[x, y], [x + side, y], [x + side, y + side], [x, y + side], [x, y]])

        squares = [square(1, 1, 2), square(0, 0, 10), square(8, 1, 3), square(-100, -100, 300), square(20, 20, 1)]
        for window, whole in (((0, 0, 10, 10), [True, True, False, False, False]), ((4, 4, 5, 5), [True] * 5)):
            _, axes = figure.section_axes(None, window)
            self.assertEqual(plot_blocks.whole_blocks(squares, axes).tolist(), whole)

    def test_rock_outside_of_regions_is_not_on_the_scale(self):
        """It is grey, the legend says it, and the largest block between joints has the last colour."""
        import figure
        import plot_blocks
        from jointcreep import plots

        text = changed(self.chain.small(), "^persistence = 1$", "persistence = 1\nregion_m = [[10, 8], [20, 8], [20, 14], [10, 14]]", 2)
        picture = plots.draw("blocks", self.chain.network(text))
        self.addCleanup(figure.plt.close, picture)
        (blocks,) = [one for one in picture.axes[0].collections if one.get_array() is not None]
        area = numpy.asarray(blocks.get_array())
        self.assertGreater(len(area), 2)
        self.assertLess(blocks.norm.vmax, 60)  # of the region
        self.assertGreater(area.max(), 60)
        picture.canvas.draw()
        grey = figure.matplotlib.colors.to_rgba(plot_blocks.LARGER)
        self.assertTrue(numpy.allclose(blocks.get_facecolors()[area.argmax()], grey))
        labels = [one.get_text() for one in picture.axes[0].get_legend().get_texts()]
        self.assertIn("blocks outside of region_m: not on the scale", labels)
        self.assertFalse([one for one in plots.draw("blocks", self.chain.network(self.chain.small())).axes[0].get_legend().get_texts()
                          if "region_m" in one.get_text()])

    def test_lengths_in_titles(self):
        """As in legends; places stay in metres."""
        from plot_state import with_short_lengths
        for reason, title in (("the rock at [-9, -1.436] m is moving: 0.000965 m in the last 5000 steps", "the rock at [-9, -1.436] m is moving: "
                               "0.965 mm in the last 5000 steps"), ("has moved 2.5 m and is still moving", "has moved 2.5 m and is still moving"),
                              ("by estimate 3.1e-05 m remain; 4 m2", "by estimate 0.031 mm remain; 4 m2"),
                              ("at [5, 7] m; stopped by a signal", "at [5, 7] m; stopped by a signal")):
            self.assertEqual(with_short_lengths(reason), title)

    def test_names_of_close_stages_and_dates_in_titles(self):
        """Stages within a small part of the axis share one name; a line of a title does not break inside a date."""
        import figure
        axes = figure.plt.figure().add_subplot()
        axes.set_xlim(0, 3650)
        figure.mark_stages(axes, [10, 60, 120, 2000], ["heading", "bench 1", "bench 2", "lining"])
        self.assertEqual([text.get_text() for text in axes.texts], ["heading, bench 1, bench 2", "lining"])
        for width, places in itertools.product((6.9, 5.5, 3.5), ([0, 220, 440, 660], [0, 100, 300, 1500], [0, 172, 344, 516], [0, 1000, 2000, 3000])):
            plot = figure.plt.figure(figsize=(width, 3))  # as histories, and those of a study
            self.addCleanup(figure.plt.close, plot)
            axes = plot.add_subplot()
            axes.set_xlim(0, 3650)
            figure.mark_stages(axes, places, ["top heading", "bench 1", "bench 2", "bench 3"])
            plot.canvas.draw()
            for one, other in zip(axes.texts, axes.texts[1:]):  # distance of the lines of text, over their height
                across = numpy.diff(axes.transData.transform([(one.xy[0], 0), (other.xy[0], 0)])[:, 0])[0] * numpy.sin(
                    numpy.radians(one.get_rotation()))
                self.assertGreater(across, 1.2 * one.get_fontsize() * plot.dpi / 72, places)
        for width in range(20, 40):
            lines = figure.wrapped("stage found no equilibrium on 31 August 2002, after bench 3, day 548", width)
            self.assertEqual((sum("31 August 2002" in line for line in lines), sum("day 548" in line for line in lines)), (1, 1))

    def test_many_stages_share_an_entry_of_the_legend(self):
        import figure
        import plot_section

        for count, entries in ((8, 8), (9, 1)):
            stages = [{"name": f"lift {i}", "date": i, "remove_m": [[[0, i], [5, i], [5, i + 1], [0, i + 1]]]}
                      for i in range(count)]
            _, axes = figure.section_axes(None, (0, 0, 5, 9))
            inside = axes.add_patch(figure.matplotlib.patches.Polygon([[0, 0], [5, 0], [5, 9], [0, 9]]))
            self.assertEqual(len(plot_section.draw_stages({"stage": stages}, axes, inside, [])), entries)
            self.assertEqual([text.get_text() for text in axes.texts], [str(i + 1) for i in range(count)])


    def test_numbers_of_stages_stand_in_no_other_stage(self):
        """A number that does not fit in its stage is outside of all stages, with a line to its own."""
        import figure
        import plot_section

        levels = [15, 6, -1, -8, -15]
        stages = [{"name": f"bench {i}", "date": i, "remove_m": [[[-9, low], [9, low], [9, high], [-9, high]]]}
                  for i, (high, low) in enumerate(zip(levels, levels[1:]), 1)]
        for window, beside in (((-160, -165, 160, 185), 4), ((-400, -400, 400, 400), 4), ((-60, -60, 60, 75), 0), ((-8, -14, 8, 14), 0)):
            for crowded in True, False:
                plot, axes = figure.section_axes(None, window)
                self.addCleanup(figure.plt.close, plot)
                inside = axes.add_patch(figure.matplotlib.patches.Polygon([[-500, -500], [500, -500], [500, 500], [-500, 500]]))
                taken = [(plot_section.points_of(place, axes) - 3, plot_section.points_of(place, axes) + 8)
                         for place in ((-9, 0), (0, 15), (9, 0), (0, -15))]
                plot_section.draw_stages({"stage": stages}, axes, inside, taken, crowded)
                plot.canvas.draw()
                with self.subTest(window=window, crowded=crowded):
                    self.assertEqual([text.get_text() for text in axes.texts], ["1", "2", "3", "4"])
                    self.assertEqual(sum(text.arrow_patch is not None for text in axes.texts), beside)
                    for text in axes.texts:
                        box = text.get_bbox_patch().get_window_extent()
                        stands_in = [str(i) for i, stage in enumerate(stages, 1) if figure.matplotlib.path.Path(
                            axes.transData.transform(stage["remove_m"][0])).intersects_bbox(box)]
                        self.assertEqual(stands_in, [] if text.arrow_patch else [text.get_text()])
                        ends = figure.matplotlib.path.Path(stages[int(text.get_text()) - 1]["remove_m"][0])
                        self.assertTrue(ends.contains_point(text.xy))

    def test_numbers_of_many_small_stages(self):
        """Where they have no room, some are left out, and the legend says it."""
        import figure
        import plot_section

        stages = [{"name": f"lift {i}", "date": i, "remove_m": [[[-40, 4 * i], [40, 4 * i], [40, 4 * i + 4], [-40, 4 * i + 4]]]}
                  for i in range(15)]
        for half, label, least in (1000, "stages, some with their numbers", 2), (60, "stages, numbered as they follow", 15):
            plot, axes = figure.section_axes(None, (-half, -half / 3, half, half / 3 + 60))
            self.addCleanup(figure.plt.close, plot)
            inside = axes.add_patch(figure.matplotlib.patches.Polygon([[-2e3, -2e3], [2e3, -2e3], [2e3, 2e3], [-2e3, 2e3]]))
            entries = plot_section.draw_stages({"stage": stages}, axes, inside, [])
            self.assertEqual([entry.get_label() for entry in entries], [label])
            self.assertGreaterEqual(len(axes.texts), least)
            plot.canvas.draw()
            for text in axes.texts:
                box = text.get_bbox_patch().get_window_extent()
                for other in axes.texts:
                    if text is not other:
                        self.assertFalse(box.overlaps(other.get_bbox_patch().get_window_extent()))


class Suited(ChainTest):
    def test_the_part_of_a_large_section_is_found_by_names_of_numbers(self):
        sys.path.append(str(self.chain.source / "pipelines/plots"))
        from suited import detail, number
        stage = {"remove_m": [[["-B", 0], ["B", 0], {"through_m": [0, "H"], "to_m": ["-B", "2*H/3"], "sides": 12}]]}
        scene = {"variables": {"B": 10, "H": "3 * B"}, "section": {"outline_m": [[-300, -300], [300, -300], [300, 300], [-300, 300]]},
                 "stage": [stage], "point": [{"at_m": ["B", "H / 2"]}]}
        self.assertEqual(detail(scene), [-40, -30, 40, 60])
        self.assertAlmostEqual(number("B / tand(45) + max(1, 2^3) - abs(-atand(0))", {"B": 12}), 20, places=12)
        for text in ("H", "x", "a b", "1 / 0", "'a'", "H.real", "[1]", "2 ** 9", "", "ln(0)", "min()", "tand", "open('x')", "max(1, x)"):
            self.assertIsNone(number(text, {"H": "H"}), text)

    def test_an_excavation_that_reaches_the_side(self):
        """The part that is drawn is around the faces, however far the excavation is beyond the side of the section or above it."""
        sys.path.append(str(self.chain.source / "pipelines/plots"))
        from suited import detail
        scene = {"section": {"outline_m": [[0, 0], [500, 0], [500, 200], [0, 200]]}, "point": [{"at_m": [380, 200]}],
                 "stage": [{"remove_m": [[[400, 185], [600, 185], [600, 230], [395, 230]]]},
                           {"remove_m": [[[410, 170], [500, 170], [500, 185], [406, 185]]]}]}
        self.assertEqual(detail(scene), [365, 140, 440, 200])
        scene["stage"] = [{"remove_m": [[[-5, 190], [505, 190], [505, 210], [-5, 210]]]}]  # from side to side
        self.assertIsNone(detail(scene))
        scene["section"]["outline_m"][2:] = [[500, 9000], [0, 9000]]
        self.assertEqual(detail(scene), [0, 0, 500, 710])

    def test_points_do_not_change_the_part(self):
        """A point far above the crown or behind the crest is outside of the part, and the legend says it."""
        sys.path.append(str(self.chain.source / "pipelines/plots"))
        from suited import detail
        cavern = {"section": {"outline_m": [[-160, -165], [160, -165], [160, 185], [-160, 185]]}, "point": [{"at_m": [0, 44]}],
                  "stage": [{"remove_m": [[[-9, -15], [9, -15], [9, 15], [-9, 15]]]}]}
        cut = {"section": {"outline_m": [[-94, -90], [90, -90], [90, 15], [-94, 15]]}, "point": [{"at_m": [-34, 15]}],
               "stage": [{"remove_m": [[[-4, 15], [0, 0], [90, 0], [90, 15]]]}]}
        self.assertEqual(detail(cavern), [-39, -45, 39, 45])
        self.assertEqual(detail(cut), [-19, -15, 15, 15])
        self.assertEqual(detail({**cavern, "point": []}), detail(cavern))
        for stages in [], [{"remove_m": [[[200, 200], [205, 200], [200, 205]]]}]:  # none, and one outside of the section
            self.assertIsNone(detail({**cavern, "stage": stages}))
        for half, part in ((65.1, [-39, -45, 39, 45]), (64.9, None)):  # 0.6 times as wide as the section, nearly
            self.assertEqual(detail({**cavern, "section": {"outline_m": [[-half, -60], [half, 60]]}}), part)
        import plot_section
        import figure
        plot, axes = figure.section_axes(None, (-39, -45, 39, 45))
        self.addCleanup(figure.plt.close, plot)
        scene = {"point": [{"name": "crown", "at_m": [0, 15]}, {"name": "above", "at_m": [0, 60]}]}
        entries, names = plot_section.draw_places(scene, "point", "monitoring point", "o", axes, [])
        self.assertEqual(([entry.get_label() for entry in entries], names), (["monitoring point (1 outside)"], [("crown", [0, 15])]))

    def test_moving_blocks_are_enlarged(self):
        """Small ones with as much rock around them, large ones with less; there is no part of the section if they fill it."""
        sys.path.append(str(self.chain.source / "pipelines/plots"))
        from suited import enlarged
        section = [(0, 0), (120, 0), (120, 70), (0, 70)]
        for low, high, window in (((40, 40), (50, 45), [30, 30, 60, 55]), ((30, 40), (70, 70), [26, 36, 74, 70]),
                                  ((10, 20), (90, 70), [2, 12, 98, 70]), ((5, 5), (115, 65), None)):
            self.assertEqual(enlarged([low, high], section), window)


if __name__ == "__main__":
    main()
