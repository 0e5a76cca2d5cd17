"""jointcreep run: what it makes of a scene, and what it does not make again."""

import base64
import html
import json
import os
import shlex
import shutil
import signal
import subprocess
import time
import tomllib

import h5py
import matplotlib.quiver
import numpy as np
from matplotlib.collections import PolyCollection

from chain import ChainTest, alive, changed, datasets, main
from jointcreep import plots
from jointcreep import run as of_scene
from suited import magnified, state_fields, suited

ODD = "it's a `touch x` $(touch y) \"$z\" #%&"  # of a folder, and of a stage
OF_SMALL = {"network.h5", "joints.h5", "result.h5", "section.png", "blocks.png", "rose.png", "distributions.png", "histories-x.png",
            "histories-y.png", "histories.csv", "states.xdmf2", "report.html",
            *(f"{state}-{field}.png" for state in ("bench", "last") for field in ("displacement", "stress", "contacts"))}
OF_LAST = {name for name in OF_SMALL if not name.startswith("bench-")}  # where nothing changes after the last stage
OF_RUN = {"run.json", "run.lock"}
OF_NETWORK = {"network.h5", "joints.h5", "section.png", "blocks.png", "rose.png", "distributions.png"}


def mapped(stage):
    """A scene with one joint in a file, without points and joint sets."""
    return f"""
[section]
outline_m = [[0, 0], [10, 0], [10, 10], [0, 10]]
rock = "rock"
gravity_m_per_s2 = 9.81
[[rock]]
name = "rock"
density_kg_per_m3 = 2700
youngs_modulus_GPa = 10
poissons_ratio = 0.25
[[joint_material]]
name = "joint"
normal_stiffness_MPa_per_m = 5000
shear_stiffness_MPa_per_m = 2000
cohesion_MPa = 0
friction_angle_deg = 35
tensile_strength_MPa = 0
[[mapped]]
name = "traces"
material = "joint"
file = "traces.csv"
[in_situ_stress]
elevation_m = 10
compression_xx_MPa = 0
compression_yy_MPa = 0
shear_xy_MPa = 0
compression_xx_gradient_MPa_per_m = 0.013
compression_yy_gradient_MPa_per_m = 0.026487
shear_xy_gradient_MPa_per_m = 0
[[boundary]]
from_m = [0, 0]
to_m = [10, 0]
fix = "xy"
[schedule]
start = 0
end = 2
[[stage]]
name = {json.dumps(stage)}
date = 1
remove_m = [[[0, 7], [10, 7], [10, 10], [0, 10]]]
[[stage]]
name = "after it"
date = 2
remove_m = [[[0, 5], [10, 5], [10, 7], [0, 7]]]
[zones]
size_m = 5
"""


class Run(ChainTest):
    def setUp(self):
        self.folder = self.chain.new_folder()
        self.scene = self.folder / "scene.toml"
        self.out = self.folder / "out"

    def called(self, *arguments, scene="scene.toml", out="out", cwd=None):
        """What jointcreep run does in the folder of the test."""
        return self.chain.jointcreep("run", scene, "-o", out, *arguments, cwd=cwd or self.folder)

    def made(self, *arguments, code=0, **more):
        """Names of the files that a call made, by the commands that it shows."""
        done = self.called(*arguments, **more)
        self.assertEqual(done.returncode, code, done.stderr)
        commands = [shlex.split(line) for line in done.stderr.splitlines() if " -o " in line]
        return {os.path.basename(words[words.index("-o") + 1]) for words in commands}

    def assert_report_as_typed(self, result, *options):
        """The report, which takes pictures from the folder, is the one that `jointcreep report` draws anew."""
        page = self.folder / "typed.html"
        done = self.chain.jointcreep("report", self.out / result, *options, "-o", page)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(page.read_bytes(), (self.out / "report.html").read_bytes())

    def names(self, folder=None):
        return {path.name for path in (folder or self.out).iterdir()}

    def test_only_what_is_missing_or_has_changed_is_made(self):
        self.scene.write_text(self.chain.small())
        done = self.called()
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.names(), OF_SMALL | OF_RUN)
        self.assertIn("largest unbalanced force ratio", done.stdout)  # the summary of demsolve
        self.assertTrue(done.stdout.endswith("report: out/report.html\nwarnings: 1, of jointgen 1; the report lists them\n"), done.stdout)
        for name in OF_SMALL:
            self.assertIn(f"-o out/{name}\n", done.stderr)

        # Commands can be typed, and make the same.
        (self.folder / "typed").mkdir()
        lines = [line for line in done.stderr.splitlines() if line.endswith((".h5", "histories.csv"))]
        self.assertEqual(len(lines), 4)
        lines += [line for line in done.stderr.splitlines() if line.endswith(".html")]  # draws pictures that `run` takes from its folder
        script = "\n".join(lines).replace("out/", "typed/")
        subprocess.run(["sh", "-ec", script], cwd=self.folder, check=True, capture_output=True)
        for path in (self.folder / "typed").glob("*.*"):
            if path.name != "checkpoint.h5":
                self.assertEqual(path.read_bytes(), (self.out / path.name).read_bytes(), path.name)

        # Nothing is made again, whatever the times of files and the folder that it is called from.
        times = {name: (self.out / name).stat().st_mtime_ns for name in OF_SMALL}
        os.utime(self.scene)
        self.assertEqual(self.made(), set())
        self.assertEqual(self.made("-q", scene=str(self.scene), out=".", cwd=self.out), set())
        self.assertEqual(self.made("--", "--threads", "2", "--checkpoint-every=1"), set())  # no change of the result
        self.assertEqual(times, {name: (self.out / name).stat().st_mtime_ns for name in OF_SMALL})

        # What is missing, or not as it was made.
        (self.out / "blocks.png").unlink()
        (self.out / "histories.csv").write_text("something else")
        self.assertEqual(self.made(), {"blocks.png", "histories.csv"})

        # Other options. Pictures of a stage that is not reached go.
        self.assertEqual(self.made("--", "--no-creep", "--until", "1"), OF_LAST - OF_NETWORK)
        self.assertEqual(self.names(), OF_LAST | OF_RUN)
        self.assertEqual(max(datasets(self.out / "result.h5")["/history/time"]), 1)
        self.assertTrue(of_scene.is_before(7, 3, 5))  # days count from the start
        self.assertFalse(of_scene.is_before(9, 3, 5))

        # Another realization of the joints: all is made again. Increments chosen by error go without checkpoints.
        options = ["--", "--no-creep", "--until", "1", "--increments-tolerance", "0.5"]
        self.assertEqual(self.made("--realization", "3", *options), OF_LAST)
        with h5py.File(self.out / "result.h5") as file:
            self.assertEqual(file.attrs["realization"], 3)
        self.assertRegex(datasets(self.out / "result.h5")["/provenance/options"][-1], "--increments [0-9]+ ")
        self.assertEqual(self.made("--realization=3", *options), set())

    def failing(self):
        """The text of a scene in which a block slides once the bench is excavated."""
        text = self.chain.small()
        for pattern, new in (("^friction_angle_deg = 35", "friction_angle_deg = 20"), ("^cohesion_MPa = 1", "cohesion_MPa = 0"),
                             ("^tensile_strength_MPa = 0.1", "tensile_strength_MPa = 0"),
                             ("mean_deg = 5, deviation_deg = 4", "mean_deg = -35, deviation_deg = 4")):
            text = changed(text, pattern, new)
        return text

    def test_no_equilibrium(self):
        self.scene.write_text(self.failing())
        done = self.called()
        self.assertEqual(done.returncode, 3, done.stderr)
        wanted = OF_LAST - {"result.h5"} | {"result.failed.h5", "failure.png"}
        self.assertEqual(self.names(), wanted | OF_RUN)
        failure = datasets(self.out / "result.failed.h5")
        reason = failure["/failure/reason"][0]
        self.assertTrue(done.stderr.endswith(f"jointcreep: out/result.failed.h5: {reason}\n"))
        page = (self.out / "report.html").read_text()
        day = f"day {failure['/failure/time'][0]:.5g}"
        self.assertIn(f"The run ended early: <b>stage &quot;bench&quot;, {day}</b>: {html.escape(reason)}.", page)

        # The picture: moving blocks are filled, an arrow each from the middle of the block, and the reason is in the title.
        plots.save("state", self.out / "result.failed.h5", self.folder / "picture.png")
        self.assertEqual((self.folder / "picture.png").read_bytes(), (self.out / "last-displacement.png").read_bytes())
        picture = plots.draw("state", self.out / "result.failed.h5")
        axes = picture.axes[0]
        import plot_state
        filled = [one for one in axes.collections if type(one) is PolyCollection and one.get_zorder() == 7]
        self.assertEqual(len(filled), 1)
        self.assertEqual(plot_state.matplotlib.colors.to_hex(filled[0].get_facecolor()[0]), plot_state.MOVING)
        corners = np.array([path.vertices[:3] for path in filled[0].get_paths()])
        one, other = (corners[:, i] - corners[:, 0] for i in (1, 2))
        area = np.abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]).sum() / 2
        self.assertAlmostEqual(area, failure["/blocks/area"][failure["/failure/block"]].sum(), places=9)
        arrows = [one for one in axes.collections if isinstance(one, matplotlib.quiver.Quiver)]
        self.assertEqual(len(arrows), 1)
        np.testing.assert_allclose(arrows[0].XY, failure["/failure/place"])
        np.testing.assert_allclose(np.column_stack([arrows[0].U, arrows[0].V]), failure["/failure/motion"])
        title = axes.get_title(loc="left").replace("\n", " ")
        self.assertIn("is moving", reason)
        self.assertNotIn("moving", title)  # the legend has the blocks
        self.assertNotIn("realization", title)
        labels = [text.get_text().replace("\n", " ") for text in axes.get_legend().get_texts()]
        self.assertIn("excavated then: bench", labels)
        longest = f"{1e3 * np.linalg.norm(failure['/failure/motion']):.3g} mm in 5000 steps of the solver"
        (moving,) = failure["/failure/block"]
        area = failure["/blocks/area"][moving]
        self.assertIn(f"1 moving block, {area:.3g} m2 (red arrows, on a scale of their own; the longest, a block's mean, is {longest})", labels)
        (number,) = [text for text in axes.texts if text.get_text() == str(moving)]
        np.testing.assert_allclose(number.get_position(), failure["/failure/place"][0])
        plots.figure.plt.close(picture)

        # The moving block is enlarged; where all blocks move the picture says so.
        picture = plots.draw("state", self.out / "result.failed.h5", around_failure=True)
        self.assertLess(np.prod(np.ptp([picture.axes[0].get_xlim(), picture.axes[0].get_ylim()], axis=1)), 200)
        shutil.copy(self.out / "result.failed.h5", self.folder / "all.h5")
        with h5py.File(self.folder / "all.h5", "r+") as file:
            number = len(file["/blocks/area"])
            for name, values in (("block", np.arange(number)), ("place", np.zeros((number, 2))), ("motion", np.ones((number, 2)))):
                del file[f"/failure/{name}"]
                file[f"/failure/{name}"] = values
            file["/failure/moves_on"][0] = 0
            del file["/failure/reason"]
            file["/failure/reason"] = ["no equilibrium: after 4000 steps the unbalanced force ratio is 0.002976, expected 1e-06; the largest"]
        title = plots.draw("state", self.folder / "all.h5", around_failure=True).axes[0].get_title(loc="left")
        self.assertTrue(title.endswith("\nundecided: after 4000 steps the unbalanced force ratio is 0.002976"), title)
        with h5py.File(self.folder / "all.h5", "r+") as file:
            file["/failure/moves_on"][0] = 1
        axes = plots.draw("state", self.folder / "all.h5", around_failure=True).axes[0]
        self.assertIn(f"{number} moving blocks, ", axes.get_legend().get_texts()[-1].get_text())
        self.assertIn("; these fill most of the section", axes.get_legend().get_texts()[-1].get_text())
        self.assertLess(axes.get_xlim()[0], 0)

        # Arrows of an earlier state are not those of the last one.
        with h5py.File(self.folder / "all.h5", "r+") as file:
            file["/states/displacement"][...] = 0.001
            file.attrs["realization"] = 7
        title = plots.draw("state", self.folder / "all.h5").axes[0].get_title(loc="left")
        self.assertIn("realization 7 of the network", title.replace("\n", " "))
        for state, has_label in ("last", True), ("0", False):
            legend = plots.draw("state", self.folder / "all.h5", state=state).axes[0].get_legend()
            labels = [text.get_text() for text in legend.get_texts()] if legend else []
            self.assertEqual("black arrows: displacement in the last recorded state" in labels, has_label)
        plots.figure.plt.close("all")

        # The answer is known the next time, and how many warnings there were.
        count = len(failure["/warnings/program"])
        self.assertTrue((failure["/warnings/program"] == "jointgen").all())
        self.assertIn(f"\nwarnings: {count}, of jointgen {count}; the report lists them\n", self.called().stdout)
        self.assertEqual(self.made(code=3), set())

        # A factor of safety below 1: the result is that of the largest factor with equilibrium, and the other run has a picture.
        self.assertEqual(self.made("--", "--factor-of-safety", "--no-creep"), OF_LAST - OF_NETWORK | {"failure.png", "safety.png"})
        self.assertEqual(self.names(), OF_LAST | OF_RUN | {"failure.png", "result.failed.h5", "safety.png"})
        safety = datasets(self.out / "result.h5")
        low = safety["/safety/factor"][safety["/safety/stands"] == 1].max()
        page = (self.out / "report.html").read_text()
        self.assertIn("<h2>Factor of safety</h2>", page)
        self.assertIn(f"All strengths of this run are divided by {low:.4g}.", page)
        self.assertIn('alt="The run with the smallest factor without equilibrium: moving blocks."', page)
        failed = datasets(self.out / "result.failed.h5")
        self.assertIn(f"the first failure is in <b>stage &quot;bench&quot;, day {failed['/failure/time'][0]:.5g}</b>: "
                      f"{html.escape(failed['/failure/reason'][0])}.", page)
        area = failed["/blocks/area"][failed["/failure/block"]]
        self.assertIn(f"area {area.sum():.4g} m2 in all: {area.sum():.4g} m3 for each metre along the strike", page)
        self.assertIn(f'<td class="number">{failed["/failure/block"][0]}</td><td class="number">{area[0]:.4g}</td>', page)
        self.assert_report_as_typed("result.h5")
        os.rename(self.out / "result.failed.h5", self.folder / "away.h5")
        self.assertEqual(self.chain.jointcreep("report", self.out / "result.h5", "-o", self.folder / "r.html").returncode, 0)
        self.assertIn("What moves at failure is in result.failed.h5, which is not beside this result", (self.folder / "r.html").read_text())
        os.rename(self.folder / "away.h5", self.out / "result.failed.h5")
        self.assertEqual(plots.draw("histories", self.out / "result.h5")._suptitle.get_text(), f"strengths / {low:.4g}")
        title = plots.draw("state", self.out / "result.failed.h5").axes[0].get_title(loc="left").replace("\n", " ")
        self.assertRegex(title, r'^Strengths / 0\.\d+: day \S+, before the first stage; stage "bench" found no equilibrium; without creep$')
        plots.figure.plt.close("all")

    def test_a_window(self):
        """--window is that of pictures of states, section-detail.png and the report. Another one draws these again."""
        self.scene.write_text(self.chain.small())
        self.assertIn("section-detail.png", self.made("--window", "5,2.5,25,15", "--", "--no-creep"))
        result, network = self.out / "result.h5", self.out / "network.h5"
        for name, file, options in (("last-stress", result, {"field": "stress"}), ("section-detail", network, {}), ("blocks-detail", network, {})):
            plots.save(name.split("-", maxsplit=1)[0].replace("last", "state"), file, self.folder / "p.png", window=(5, 2.5, 25, 15), **options)
            self.assertEqual((self.folder / "p.png").read_bytes(), (self.out / f"{name}.png").read_bytes())
        report = (self.out / "report.html").read_text()
        self.assertIn(base64.b64encode((self.out / "blocks-detail.png").read_bytes()).decode(), report)
        self.assertIn(base64.b64encode((self.out / "section-detail.png").read_bytes()).decode(), report)
        self.assertIn(base64.b64encode((self.out / "last-stress.png").read_bytes()).decode(), report)
        self.assert_report_as_typed("result.h5", "--window", "5,2.5,25,15")
        self.assertEqual(self.made("--window=5,2.5,25,15", "--", "--no-creep"), set())
        self.assertEqual(self.made("--window", "5", "2.5", "25", "15", "--", "--no-creep"), set())
        drawn_in_it = {"section-detail.png", "blocks-detail.png", "last-displacement.png", "last-stress.png", "last-contacts.png", "report.html"}
        self.assertEqual(self.made("--window", "-5,-5,25,15", "--", "--no-creep"), drawn_in_it)
        self.assertEqual(self.made("--", "--no-creep"), drawn_in_it - {"section-detail.png", "blocks-detail.png"})
        self.assertFalse((self.out / "section-detail.png").exists())
        done = self.called("--window", "500,0,600,10", "--", "--no-creep")
        self.assertRegex(done.stderr, r"section-detail.png is not made: .*--window shows nothing of the section, which is from \[0, 0\] to ")

    def fakes(self, script):
        """A folder of programs in which demsolve is this script."""
        folder = self.folder / "fakes"
        folder.mkdir(exist_ok=True)
        for name in of_scene.PROGRAMS:
            (folder / name).unlink(missing_ok=True)
            (folder / name).symlink_to(self.chain.programs / name)
        (folder / "demsolve").unlink()
        (folder / "demsolve").write_text(f"#!/bin/sh\n{script}\n")
        (folder / "demsolve").chmod(0o755)
        return str(folder)

    def begun(self, *arguments, before=(), **options):
        """`jointcreep run` of the scene, whose demsolve has begun: it touches the file `begun`."""
        (self.folder / "begun").unlink(missing_ok=True)
        running = subprocess.Popen([*before, self.chain.programs / "jointcreep", "run", "scene.toml", "-o", "out", *arguments],
                                   cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, **options)
        end = time.monotonic() + 60
        while not (self.folder / "begun").exists() and time.monotonic() < end:
            time.sleep(0.02)
        return running

    def test_interrupted(self):
        """What has ended stays when a program fails or is killed, and the same command goes on."""
        (self.folder / "traces.csv").write_text("x1_m,y1_m,x2_m,y2_m\n0,3,10,4\n")
        self.scene.write_text(mapped("top"))
        breaks = "echo demsolve: no memory >&2; exit 5"
        for script, code, words in (breaks, 5, "demsolve: no memory\n"), ("kill -9 $$", 4, "jointcreep: demsolve was stopped"):
            done = self.called("--programs", self.fakes(script))
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn(words, done.stderr)
            self.assertEqual(self.names(), {"network.h5", "joints.h5"} | OF_RUN)
        made = self.made()
        self.assertFalse({"network.h5", "joints.h5"} & made)
        self.assertTrue({"result.h5", "last-contacts.png", "report.html"} <= made)
        self.assertEqual(self.made(), set())

        # A key of the scene is in all files, and a file that the scene names is an input. What fails leaves what was made.
        before = self.names()
        self.fakes(breaks)
        self.assertEqual(self.made("--programs", "fakes", code=5), {"result.h5"})
        for path, content in (self.scene, mapped("other")), (self.folder / "traces.csv", "x1_m,y1_m,x2_m,y2_m\n0,3,10,4.5\n"):
            path.write_text(content)
            self.assertEqual(self.made("--programs", "fakes", code=5), {"network.h5", "joints.h5", "result.h5"})
            self.assertEqual(self.names(), before)
        for wrong, words in (("[section", "jointgen: scene.toml"), ("mapped = 1\nfile = 2\n", "jointgen: scene.toml"),
                             (mapped("top") + "\n[wrong]\n", "jointgen: scene.toml, line ")):
            self.scene.write_text(wrong)
            done = self.called()
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(words, done.stderr)
            self.assertNotIn("Traceback", done.stderr)
            self.assertEqual(self.names(), before)

    def test_checkpoint(self):
        """A run of demsolve that was killed is continued, one of other options is not."""
        self.scene.write_text(self.chain.small())
        calls = shlex.quote(f"{self.folder}/calls")
        fakes = self.fakes(f"ls out/checkpoint.h5 >>{calls} 2>&1\necho kept >out/checkpoint.h5\nkill -9 $$")
        for options in [], [], ["--", "--no-creep"], ["--", "--no-creep", "--threads", "2"]:
            self.assertEqual(self.called("--programs", fakes, *options).returncode, 4)
        lines = (self.folder / "calls").read_text().splitlines()
        self.assertEqual(["cannot access" in line for line in lines], [True, False, True, False], lines)

    def test_killed(self):
        """With it dies the program that it called; the same command goes on."""
        self.scene.write_text(self.chain.small())
        fakes = self.fakes(f"touch {shlex.quote(str(self.folder))}/begun; exec sleep 100")
        running = self.begun("--programs", fakes, start_new_session=True)
        running.kill()
        running.wait()
        end = time.monotonic() + 10
        while alive(running.pid) and time.monotonic() < end:
            time.sleep(0.02)
        left = alive(running.pid)
        for process in left:
            os.kill(process, signal.SIGKILL)
        self.assertEqual(left, [])
        self.assertEqual(self.made("--programs", self.fakes("exit 5"), code=5), {"result.h5"})

    def test_stopped(self):
        """A signal to stop goes to the program, which may keep its state, and is waited for."""
        self.scene.write_text(self.chain.small())
        here = shlex.quote(str(self.folder))
        fakes = self.fakes(f"trap 'sleep 0.3; touch {here}/kept; exit 143' TERM; touch {here}/begun; while true; do sleep 0.05; done")
        for number in signal.SIGTERM, signal.SIGINT, signal.SIGHUP:
            with self.subTest(number):
                (self.folder / "kept").unlink(missing_ok=True)
                running = self.begun("--programs", fakes)
                running.send_signal(number)
                self.assertEqual(running.wait(60), 128 + number)
                self.assertTrue((self.folder / "kept").exists())
        # What is ignored stays ignored: after nohup the end of a session ends nothing.
        fakes = self.fakes(f"touch {here}/begun; sleep 1; exit 5")
        running = self.begun("--programs", fakes, before=["nohup"])
        running.send_signal(signal.SIGHUP)
        self.assertEqual(running.wait(60), 5)

    def test_odd_names_and_makefile(self):
        """Whatever names have, nothing of them is a command; make makes the same files as run."""
        folder = self.folder / ODD
        folder.mkdir()
        (folder / "traces.csv").write_text("x1_m,y1_m,x2_m,y2_m\n0,3,10,4\n")
        scene, stage = f"-{ODD}.toml", ODD + "/../" + 150 * "x"
        (folder / scene).write_text(mapped(stage))
        self.assertEqual(len(self.made(scene=f"./{scene}", out=f"./-{ODD}", cwd=folder)), 13)
        out = folder / f"-{ODD}"
        word = "it-s-a-touch-x-touch-y-z-..-" + 52 * "x"  # 80 characters
        wanted = {"network.h5", "joints.h5", "result.h5", "section.png", "blocks.png", "states.xdmf2", "report.html",
                  *(f"{state}-{field}.png" for state in (word, "last") for field in ("displacement", "stress", "contacts"))}
        self.assertEqual(self.names(out), wanted | OF_RUN)

        done = self.called("--makefile", scene=f"./{scene}", out="./made", cwd=folder)
        self.assertEqual((done.returncode, done.stdout), (0, "made/Makefile has the commands; now: make -C made\n"), done.stderr)
        self.assertEqual(self.names(folder / "made"), {"Makefile", "run.lock"})
        make = ["make", "-j2", "-C", folder / "made"]
        some = ["result.h5", f"{word}-stress.png", "section.png", "states.xdmf2", "report.html"]
        done = subprocess.run([*make, *some], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        some += ["network.h5", "joints.h5"]
        self.assertEqual(self.names(folder / "made"), {*some, "Makefile", "run.lock"})
        for name in some:
            if name != "report.html":  # it has names of files
                self.assertEqual((folder / "made" / name).read_bytes(), (out / name).read_bytes(), name)
        done = subprocess.run([*make, "-n"], capture_output=True, text=True)
        self.assertEqual({line.split(" -o ")[1] for line in done.stdout.splitlines() if " -o " in line}, wanted - set(some))
        future = time.time() + 10
        os.utime(folder / "traces.csv", (future, future))
        done = subprocess.run([*make, "-n"], capture_output=True, text=True)
        self.assertIn("jointgen", done.stdout)
        self.assertEqual(self.names(folder), {scene, "traces.csv", out.name, "made"})  # no x, no y

        # Names that make cannot have are refused.
        shutil.copy(folder / scene, folder / "a:b.toml")
        done = self.called("--makefile", scene="a:b.toml", out="made", cwd=folder)
        self.assertEqual(done.returncode, 2)
        self.assertIn("a:b.toml", done.stderr)

    def test_refusals(self):
        self.scene.write_text(self.chain.small())
        other = self.folder / "other"
        other.mkdir()
        (other / "study.lock").touch()
        (self.folder / "file").touch()
        mine = self.folder / "mine"
        mine.mkdir()
        (mine / "run.lock").touch()
        (mine / "Makefile").write_text("all:\n")
        for arguments, code, words in [
            (["scene.toml", "-o", "other"], 2, "other: has files, and is not the folder of a run; expected a new or empty folder"),
            (["scene.toml", "-o", "."], 2, "scene.toml: is read, and is in the folder of the run"),
            (["scene.toml", "-o", "file"], 4, "file: File exists"),
            (["none.toml", "-o", "out"], 4, "none.toml: No such file"),
            (["scene.toml", "-o", "out", "-q", "-q"], 2, "-q is given twice"),
            (["scene.toml", "scene.toml", "-o", "out"], 2, 'second input "scene.toml"'),
            (["scene.toml", "-o", "out", "--no-creep"], 2, 'unknown option or second input "--no-creep"; options of demsolve follow "--"'),
            (["scene.toml", "-o", "out", "--", "--output=x.h5"], 2, '"--output=x.h5" after --: jointcreep run sets this option'),
            (["scene.toml", "-o", "out", "--", "-ox.h5"], 2, '"-ox.h5" after --'),
            (["scene.toml", "-o", "out", "--", "--checkpoint", "x.h5"], 2, '"--checkpoint" after --'),
            (["scene.toml", "-o", "out", "--programs", "other"], 2, "jointgen: is not there"),
            (["scene.toml", "-o", "mine", "--makefile"], 2, "Makefile: is not of jointcreep run"),
            (["scene.toml", "-o", "out", "--window", "1,2,3"], 2, '--window is "1,2,3"; expected x0,y0,x1,y1 in metres (or four words)'),
            (["scene.toml", "-o", "out", "--window", "1", "2", "3"], 2, '--window is "1,2,3"; expected x0,y0,x1,y1 in metres'),
            (["scene.toml", "-o", "out", "--window", "9,2,3,4"], 2, '--window is "9,2,3,4"; expected x0,y0,x1,y1 in metres (or four words), with x0 below'),
            (["scene.toml", "-o", "new", "--makefile", "--", "--until", "1\n2"], 2, "no line breaks"),
        ]:
            with self.subTest(arguments):
                done = subprocess.run([self.chain.programs / "jointcreep", "run", *arguments], capture_output=True, text=True, cwd=self.folder)
                self.assertEqual(done.returncode, code, done.stderr)
                self.assertRegex(done.stderr, "^jointcreep: ")
                self.assertIn(words, done.stderr)
        self.assertFalse(self.out.exists())
        self.assertEqual((mine / "Makefile").read_text(), "all:\n")
        done = self.called("--", "--no-such")
        self.assertEqual(done.returncode, 2)
        self.assertIn("demsolve: ", done.stderr)
        done = subprocess.run([self.chain.programs / "jointcreep", "study", "x.toml", "-o", "out", "--", "--no-creep"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)

    def test_suited(self):
        """Which plots suit the scenes of data."""
        always = ["section", "blocks", "state"]
        for path, wanted, fields in [
            ("data/slope/scene.toml", {"stereonet", "rose", "distributions", "strength", "histories", "step_history"}, 3),
            ("data/column/scene.toml", {"histories", "step_history"}, 3),
            ("data/collapse/toppling.toml", {"histories", "dynamics"}, 2),
            ("pipelines/studies/small.toml", {"rose", "distributions", "histories"}, 3)]:
            scene = tomllib.loads(self.chain.text(path))
            self.assertEqual(set(suited(scene)), wanted | set(always), path)
            self.assertEqual(len(state_fields(scene)), fields, path)
            is_large = "toppling" in path
            self.assertEqual([magnified(scene), magnified(scene, "stress"), magnified(scene, "contacts")], [is_large, is_large, False])


if __name__ == "__main__":
    main()
