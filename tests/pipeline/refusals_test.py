"""A program that cannot do what is asked says why, ends with the documented exit code, and writes nothing; but for what
comes before a lack of equilibrium, which is written beside the output."""

import functools
import os
import pathlib
import random
import resource
import shutil
import subprocess
import time

import h5py

from chain import ChainTest, changed, datasets, main

BAD_INPUT, NO_EQUILIBRIUM, BAD_FILE = 2, 3, 4  # exit codes, docs/programs.md
PROGRAMS = ["jointgen", "strength-averaging", "demsolve", "jointexport"]
OLD = b"what was there before\n"
COLUMN = "data/column/scene.toml"
RANDOM = "tests/pipeline/random_slope.toml"


class Refusals(ChainTest):
    @functools.cached_property
    def files(self):
        """What each program reads, by the program's name, and the result; all of the column."""
        files = {"jointgen": self.chain.source / COLUMN}
        files["result"] = self.chain.result(self.chain.text(COLUMN), "--no-creep")
        files["strength-averaging"] = files["result"].with_name("network.h5")
        files["demsolve"] = files["result"].with_name("joints.h5")
        files["jointexport"] = files["result"]
        return files

    def assert_refuses(self, code, program, source, *arguments, says=(), output=None, limit=None):
        """Refuses, names `says`, and leaves its folder as it was: empty, then with a file of the output's name. Where
        there is no equilibrium, out.failed.h5 is new."""
        name = output or ("out.vtu" if program == "jointexport" else "out.h5")
        for old in None, OLD:
            folder = self.chain.new_folder()
            path = folder / name
            if old and path.parent.exists() and not path.exists():
                path.write_bytes(old)
            before = {p: p.read_bytes() for p in folder.rglob("*") if p.is_file()}
            command = [self.chain.programs / program, source, "-o", path, *arguments]
            done = subprocess.run([*map(str, command)], capture_output=True, text=True, timeout=300, preexec_fn=limit)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertEqual(done.stdout, "")
            self.assertTrue(all(line.startswith(program + ": ") for line in done.stderr.splitlines()), done.stderr)
            for word in [says] if isinstance(says, str) else says:
                self.assertIn(word, done.stderr)
            self.assertNotEqual(done.stderr, "")
            self.assertNotIn("internal error", done.stderr)
            if code == NO_EQUILIBRIUM:
                (folder / "out.failed.h5").unlink()
            self.assertEqual({p: p.read_bytes() for p in folder.rglob("*") if p.is_file()}, before)

    def test_the_tests_own_files_are_accepted(self):
        for program in PROGRAMS:
            name = "out.vtu" if program == "jointexport" else "out.h5"
            self.chain.run(program, self.files[program], self.chain.new_folder() / name)

    def test_wrong_kind_of_file(self):
        """Earlier files lack something; jointgen wants a scene, the others HDF5."""
        for program in PROGRAMS[1:]:
            self.assert_refuses(BAD_INPUT, program, self.files["jointgen"], says=["scene.toml: is a scene", "First run: jointgen"])
        self.assert_refuses(BAD_INPUT, "demsolve", self.files["strength-averaging"],
                            says=["network.h5", "jointcreep network", "jointcreep joints"])
        for name in "strength-averaging", "demsolve", "result":
            self.assert_refuses(BAD_INPUT, "jointgen", self.files[name], says=self.files[name].name)
        self.assert_refuses(BAD_INPUT, "jointexport", self.files["demsolve"], "--what", "zones", says="joints.h5")

    def test_text_in_place_of_hdf5(self):
        for program in PROGRAMS[1:]:
            for content in b"", b"not HDF5\n", b"\x89HDF\r\n\x1a\n" + bytes(1000):
                file = self.chain.new_folder() / "nonsense.h5"
                file.write_bytes(content)
                self.assert_refuses(BAD_FILE, program, file, says="nonsense.h5")

    def test_missing_input(self):
        for program in PROGRAMS:
            self.assert_refuses(BAD_FILE, program, self.chain.folder / "is-not-there", says="is-not-there")

    def test_folder_as_input(self):
        for program in PROGRAMS:
            self.assert_refuses(BAD_FILE, program, self.chain.new_folder(), says=str(self.chain.folder))

    def test_missing_output_folder(self):
        for program in PROGRAMS:
            name = "missing/out.vtu" if program == "jointexport" else "missing/out.h5"
            self.assert_refuses(BAD_FILE, program, self.files[program], output=name, says="missing")

    def test_folder_as_output(self):
        for program in PROGRAMS:
            folder = self.chain.new_folder() / "folder.vtu"
            folder.mkdir()
            done = self.chain.answer(program, self.files[program], "-o", folder)
            self.assertEqual(done.returncode, BAD_FILE, done.stderr)
            self.assertIn("folder.vtu", done.stderr)
            self.assertEqual(list(folder.iterdir()), [])
            self.assertEqual(list(folder.parent.iterdir()), [folder])

    def test_disk_full(self):
        """A file size limit stands in for a full disk."""
        for program in PROGRAMS:
            self.assert_refuses(BAD_FILE, program, self.files[program], says="out.",
                                limit=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000)))

    def test_output_is_input(self):
        for program in PROGRAMS:
            folder = self.chain.new_folder()
            source = shutil.copy(self.files[program], folder / "file.vtu")
            content = pathlib.Path(source).read_bytes()
            done = self.chain.answer(program, source, "-o", folder / "." / "file.vtu")
            self.assertEqual(done.returncode, BAD_INPUT, done.stderr)
            self.assertEqual(pathlib.Path(source).read_bytes(), content)
            self.assertEqual(list(folder.iterdir()), [pathlib.Path(source)])

    def test_no_file_is_written_over_another(self):
        """Whatever the path to it, also where neither file is there yet; the message names both."""
        joints = self.files["demsolve"]
        for program, *arguments, written, other in [
            ("jointgen", "scene.toml", "-o", "./traces.geojson", "-o ./traces.geojson", "traces.geojson, which the scene names"),
            ("jointgen", "scene.toml", "-o", "here/scene.toml", "-o here/scene.toml", "the input scene.toml"),
            ("creepfit", joints, "--fit", "joint-stiffness", "--measurements", "traces.geojson", "-o", "./traces.geojson",
             "-o ./traces.geojson", "--measurements traces.geojson"),
            ("creepfit", "traces.geojson", "-o", "z.csv", "--readings", "./z.csv", "--readings ./z.csv", "-o z.csv"),
            ("creepfit", "traces.geojson", "-o", "z.csv", "--readings", "here/z.csv", "--readings here/z.csv", "-o z.csv"),
            ("creepfit", "curve.failed.csv", "-o", "curve.csv", "--readings", "./curve.failed.csv",
             "--readings ./curve.failed.csv", "the input curve.failed.csv"),
            ("creepfit", joints, "--fit", "joint-stiffness", "--measurements", "curve.failed.csv", "-o", "curve.csv",
             "curve.failed.csv, which a search that fails writes,", "--measurements curve.failed.csv"),
            ("creepfit", joints, "--fit", "joint-stiffness", "--measurements", "traces.geojson", "-o", "a.csv",
             "--readings", "a.failed.csv", "a.failed.csv, which a search that fails writes,", "--readings a.failed.csv"),
            ("demsolve", joints, "-o", "q.h5", "--checkpoint", "FOLDER/q.h5", "--checkpoint FOLDER/q.h5", "-o q.h5"),
            ("demsolve", joints, "-o", "q.h5", "--checkpoint", "here/q.failed.h5",
             "q.failed.h5, which a run without equilibrium writes,", "--checkpoint here/q.failed.h5"),
            ("demsolve", "q.failed.h5", "-o", "q.h5",
             "q.failed.h5, which a run without equilibrium writes,", "the input q.failed.h5"),
            ("demsolve", "q.failed.h5", "-o", "r.h5", "--checkpoint", "./q.failed.h5",
             "--checkpoint ./q.failed.h5", "the input q.failed.h5"),
        ]:
            folder = self.chain.new_folder()
            for name in "scene.toml", "poles.csv", "traces.geojson":
                shutil.copy(self.chain.source / "tests/pipeline/kinds" / name, folder)
            shutil.copy(folder / "traces.geojson", folder / "curve.failed.csv")
            shutil.copy(joints, folder / "q.failed.h5")
            (folder / "here").symlink_to(folder)
            before = {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}
            command = [self.chain.programs / program, *(str(one).replace("FOLDER", str(folder)) for one in arguments)]
            with self.subTest(command=command[1:]):
                done = subprocess.run(command, capture_output=True, text=True, timeout=300, cwd=folder)
                self.assertEqual(done.returncode, BAD_INPUT, done.stderr)
                message = f"{program}: {written} is the same file as {other}; give it another name\n"
                self.assertEqual(done.stderr, message.replace("FOLDER", str(folder)))
                after = {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}
                self.assertEqual(after, before)

    def test_a_file_of_another_program(self):
        """The message says what the file is, what was wanted, and what to do."""
        scene = self.chain.source / COLUMN
        result = self.files["result"]
        text = self.chain.new_folder() / "text.h5"
        text.write_text("time_day,displacement_mm\n0,1\n")
        self.assert_refuses(BAD_INPUT, "jointgen", result, says=f"{result}: this is an HDF5 file; expected a scene file (.toml), which is text\n")
        self.assert_refuses(BAD_INPUT, "creepfit", scene, output="out.csv",
                            says=["scene.toml: this is a scene; expected a table of readings (.csv). Run jointgen and strength-averaging first"])
        self.assert_refuses(BAD_INPUT, "creepfit", self.files["demsolve"], "--fit", "joint-stiffness", "--measurements", result,
                            output="out.csv", says="this is an HDF5 file; expected a table of measurements (.csv)")
        self.assert_refuses(BAD_FILE, "demsolve", text, says="text.h5: this is a text file; expected a file of the chain, which is HDF5")
        self.assert_refuses(BAD_INPUT, "demsolve", scene, says="is a scene; expected a file of the chain. First run: jointgen ")
        done = self.chain.answer("jointcreep", "report", scene, "-o", text.with_name("report.html"))
        self.assertEqual(done.returncode, BAD_INPUT, done.stderr)
        self.assertIn(f"is a scene; expected a result file of demsolve, or a study's folder. First run: jointcreep run {scene} -o FOLDER",
                      done.stderr)

    def test_options_that_are_misspelt(self):
        for program, option, says in [("demsolve", "--tolerence=1", "there is no option --tolerence; did you mean --tolerance?\n"),
                                      ("jointgen", "--realisation", "there is no option --realisation; did you mean --realization?\n"),
                                      ("jointexport", "--outptu", "did you mean --output?\n"),
                                      ("demsolve", "--no-such-option", "there is no option --no-such-option; --help shows all\n"),
                                      ("demsolve", "-x", "there is no option -x; --help shows all\n")]:
            self.assert_refuses(BAD_INPUT, program, self.files[program], option, says=says)
        done = self.chain.answer("jointcreep", "run", "scene.toml", "--realisation", "3", "-o", "out")
        self.assertIn('unknown option or second input "--realisation"; did you mean --realization?\n', done.stderr)

    def test_command_line(self):
        cases = [
            ("jointgen", ["--seed", "-1"], "--seed"),
            ("jointgen", ["--seed", "1.5"], "--seed"),
            ("jointgen", ["--seed", "9007199254740993"], "--seed"),
            ("jointgen", ["--realization", "4294967296"], "--realization"),
            ("jointgen", ["--seed", "1", "--seed", "2"], "seed"),
            ("demsolve", ["--threads", "0"], "--threads"),
            ("demsolve", ["--threads", "two"], "--threads"),
            ("demsolve", ["--threads"], "threads"),
            ("demsolve", ["--tolerance", "0"], "--tolerance"),
            ("demsolve", ["--tolerance", "nan"], "--tolerance"),
            ("demsolve", ["--zone-size", "0"], "--zone-size"),
            ("demsolve", ["--zone-size", "-1"], "--zone-size"),
            ("demsolve", ["--creep-step", "0"], "--creep-step"),
            ("demsolve", ["--creep-step", "inf"], "--creep-step"),
            ("demsolve", ["--step-history", "0"], "--step-history"),
            ("demsolve", ["--step-hist", "1"], "step-hist"),
            ("demsolve", ["--trace", "20"], "--trace is now called --step-history"),
            ("demsolve", ["--trace=20"], "--trace is now called --step-history"),
            ("demsolve", ["--engine", "explicit"], "--engine explicit is now called --engine relaxation"),
            ("demsolve", ["--engine=explicit"], "--engine explicit is now called --engine relaxation"),
            ("demsolve", ["--engine", "newton"], '"newton" is none of auto, relaxation, implicit'),
            ("demsolve", ["--creep-scheme", "linear force"], "is none of auto, published, backward, linear-force, fitted"),
            ("jointexport", ["--what", "nothing"], "nothing"),
            ("jointexport", ["--state", "99"], "99"),
            ("jointexport", ["--what", "blocks", "--state", "0"], "--state"),
            *((program, ["--no-such-option"], "no-such-option") for program in PROGRAMS),
            *((program, ["another file"], "more than one") for program in PROGRAMS if program != "jointexport"),
            ("jointexport", ["another file"], "several are given"),
            ("jointexport", ["--format", "nothing"], ["nothing", "dfnworks"]),
            ("jointexport", ["--format", "dxf"], [".dxf", "out.vtu"]),
            ("jointexport", ["--what", "blocks,edges"], "holds one of them"),
        ]
        for program, arguments, says in cases:
            with self.subTest(program=program, arguments=arguments):
                self.assert_refuses(BAD_INPUT, program, self.files[program], *arguments, says=says)
        self.assert_refuses(BAD_INPUT, "jointexport", self.files["result"], output="out.png", says=["out.png", ".vtu"])
        self.assert_refuses(BAD_INPUT, "jointexport", self.files["result"], output="out.dat", says=["--format", "udec"])
        for program in PROGRAMS:
            for arguments in [], [self.files[program]], ["-o", "out.h5"], [self.files[program], "-o", ""]:
                done = self.chain.answer(program, *arguments)
                self.assertEqual(done.returncode, BAD_INPUT, done.stderr)
                self.assertNotEqual(done.stderr, "")

    def test_inputs_that_are_called_as_unfinished_files(self):
        """They would be removed as what a killed program has left; also through a link, and where another program reads them."""
        folder = self.chain.new_folder()
        for name in "scene.toml", "poles.csv", "traces.geojson":
            shutil.copy(self.chain.source / "tests/pipeline/kinds" / name, folder)
        text = (folder / "scene.toml").read_text().replace("traces.geojson", "n.h5.partial-12")
        (folder / "mapped.toml").write_text(text)
        shutil.copy(folder / "traces.geojson", folder / "n.h5.partial-12")
        for output in "z.h5", "z.csv", "z.toml", "z.html":
            shutil.copy(self.files["demsolve"], folder / f"{output}.partial-7")
        (folder / "link.h5").symlink_to("z.h5.partial-7")
        before = {path.name: path.read_bytes() for path in folder.iterdir()}
        for program, *arguments, named in [
            ("jointgen", "mapped.toml", "-o", "n.h5", "n.h5.partial-12"),
            ("strength-averaging", "z.h5.partial-7", "-o", "z.h5", "z.h5.partial-7"),
            ("demsolve", "link.h5", "-o", "z.h5", "link.h5"),
            ("jointexport", "z.csv.partial-7", "-o", "./z.csv", "z.csv.partial-7"),
            ("creepfit", self.files["demsolve"], "--fit", "joint-stiffness", "--measurements", "z.csv.partial-7", "-o", "z.csv", "z.csv.partial-7"),
            ("jointcreep", "report", "z.html.partial-7", "-o", "z.html", ""),
            ("jointcreep", "fit", "z.toml.partial-7", "--window", "0,0,1,1", "-o", "z.toml", "z.toml.partial-7"),
        ]:
            with self.subTest(program):
                done = subprocess.run([self.chain.programs / program, *arguments], cwd=folder, capture_output=True, text=True)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertIn(named, done.stderr)
                self.assertTrue("is called as an unfinished file" in done.stderr or not named, done.stderr)
                self.assertEqual({path.name: path.read_bytes() for path in folder.iterdir()}, before)

    def test_names_that_cannot_be_outputs(self):
        """Before the work: too long with the ending of an unfinished file; a folder where a failed run would be; /dev, however spelled."""
        folder = self.chain.new_folder()
        (folder / "d.failed.h5").mkdir()
        (folder / "link").symlink_to("/dev")
        for output, says in (("a" * 235 + ".h5", "the name is longer than the 255 bytes that the folder allows; expected one that is 2 shorter"),
                             ("d.h5", "d.failed.h5: cannot write: there is a folder of this name"),
                             ("//dev/stdout", "names in /dev and /proc are no files"), ("link/stdout", "names in /dev and /proc are no files")):
            done = subprocess.run([self.chain.programs / "demsolve", self.files["demsolve"], "-o", output], cwd=folder, capture_output=True,
                                  text=True)
            self.assertEqual(done.returncode, 4, done.stderr)
            self.assertIn(says, done.stderr)

    def test_closed_descriptors_are_not_those_of_files(self):
        """A message would go into the file that is opened next."""
        text = self.chain.text("data/slope/scene.toml")
        joints = self.chain.joints(text)
        def close():
            for number in 0, 1, 2:
                os.close(number)
        with subprocess.Popen([self.chain.programs / "demsolve", joints, "-o", joints.with_name("r.h5"), "-q"], preexec_fn=close) as running:
            deadline = time.monotonic() + 60
            while not (folder := pathlib.Path(f"/proc/{running.pid}/fd") / "2").exists() and time.monotonic() < deadline:
                time.sleep(0.01)
            found = [os.readlink(folder.with_name(str(number))) for number in (0, 1, 2)]
            running.kill()
        self.assertEqual(found, ["/dev/null"] * 3)

    def test_help_that_cannot_be_written(self):
        for program in "jointgen", "demsolve", "jointcreep", "jointverify":
            for option in "--help", "--version":
                with open("/dev/full", "w") as full:
                    done = subprocess.run([self.chain.programs / program, option], stdout=full, stderr=subprocess.PIPE, text=True)
                self.assertEqual((done.returncode, len(done.stderr.splitlines())), (4, 1), done.stderr)
                self.assertIn("stdout could not be written", done.stderr)

    def test_stacks_of_threads(self):
        """OpenMP's, as the environment has it: it would end the program without a name."""
        def answer(size):
            return subprocess.run([self.chain.programs / "demsolve", self.files["demsolve"], "--threads", "3", "-q", "-o",
                                   self.chain.new_folder() / "r.h5"], capture_output=True, text=True, env={**os.environ, "OMP_STACKSIZE": size})
        for size in "16k", "16384b", " 16":
            done = answer(size)
            self.assertEqual(done.returncode, BAD_INPUT, done.stderr)
            self.assertIn("--threads 3: only 1 could be started here", done.stderr)
            self.assertIn("expected fewer, or another OMP_STACKSIZE", done.stderr)
        self.assertEqual(answer("8M").returncode, 0)

    def test_threads_that_cannot_start(self):
        def little_memory():
            resource.setrlimit(resource.RLIMIT_AS, (500 * 2**20, 500 * 2**20))
        says = ["--threads 1000: only ", " could be started here (", "); expected fewer"]
        self.assert_refuses(BAD_INPUT, "demsolve", self.files["demsolve"], "--threads", "1000", says=says, limit=little_memory)

    def test_zones_without_end(self):
        """Refused before they are made, with a size that would do; by jointgen when it is asked to check."""
        scene = self.chain.new_folder() / "scene.toml"
        scene.write_text(changed(self.chain.text(COLUMN), "^size_m = 2.5 ", "size_m = 1e-9 "))
        refusal = ["size_m is 1e-09 m", "about 2e+21 zones", "at most 2e+07", "Set size_m to 0.011 m or more"]
        self.assert_refuses(BAD_INPUT, "jointgen", scene, "--check", says=["scene.toml: [zones]", *refusal])
        joints = self.chain.joints(scene.read_text())
        self.assert_refuses(BAD_INPUT, "demsolve", joints, says=["joints.h5: /scene: [zones]", *refusal])
        self.assert_refuses(BAD_INPUT, "demsolve", self.files["demsolve"], "--zone-size", "1e-9",
                            says=["joints.h5, --zone-size: [zones]", *refusal])
        warnings = datasets(joints)["/warnings/text"]
        self.assertTrue(any(refusal[0] in str(warning) for warning in warnings), warnings)

    def test_many_zones_are_warned_of(self):
        scene = self.chain.new_folder() / "scene.toml"
        scene.write_text(changed(self.chain.text(COLUMN), "^size_m = 2.5 ", "size_m = 0.02 "))
        done = self.chain.answer("jointgen", scene, "--check")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("jointgen: warning: ", done.stderr)
        self.assertIn("about 5e+06 zones", done.stderr)
        self.assertIn("GB of memory", done.stderr)

    def test_crossings_without_end(self):
        """Refused before they are found."""
        text = self.chain.text(RANDOM)
        for spacing in 'law = "lognormal", mean_m = 7, deviation_m = 2', 'law = "normal", mean_m = 8, deviation_m = 1.5':
            text = changed(text, f"^spacing = {{ {spacing} }}$", 'spacing = { law = "constant", mean_m = 0.002 }')
        scene = self.chain.new_folder() / "scene.toml"
        scene.write_text(text)
        self.assert_refuses(BAD_INPUT, "jointgen", scene,
                            says=["scene.toml: about ", "crossings of joints", "at most 5e+07", "Increase its spacing"])

    def test_long_cutting_is_announced(self):
        """Before it begins, and not with -q."""
        text = self.chain.text(RANDOM)
        for spacing in 'law = "lognormal", mean_m = 7, deviation_m = 2', 'law = "normal", mean_m = 8, deviation_m = 1.5':
            text = changed(text, f"^spacing = {{ {spacing} }}$", 'spacing = { law = "constant", mean_m = 0.02 }')
        folder = self.chain.new_folder()
        (folder / "scene.toml").write_text(text)
        for more in [], ["-q"]:
            command = [self.chain.programs / "jointgen", "scene.toml", "-o", "n.h5", *more]
            with subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as running:
                if more:
                    time.sleep(1)  # longer than it took to say it above
                else:
                    said = running.stderr.readline()
                running.kill()
                if more:
                    said = running.stderr.read()
            self.assertRegex(said, "^$" if more else r"^jointgen: \d+ joints with about \S+ crossings: cutting may take [1-9]\d+ s\n$")

    def band(self, count):
        """A scene with so many joints whose ends are within 1 cm, half of the shortest edge, of a line."""
        chance = random.Random(1)
        return self.chain.small() + "".join(
            f'\n[[joint]]\nname = "line {i}"\nmaterial = "joint"\nfrom_m = [0, {5.013 + chance.uniform(-.01, .01)}]\n'
            f"to_m = [30, {5.013 + chance.uniform(-.01, .01)}]\n" for i in range(count))

    def test_joints_beside_each_other_are_announced_or_refused(self):
        """A few hundred joints in a band as narrow as the shortest edge take minutes, some thousand hours."""
        folder = self.chain.new_folder()
        (folder / "scene.toml").write_text(self.band(700))
        command = [self.chain.programs / "jointgen", "scene.toml", "-o", "n.h5"]
        with subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as running:
            said = running.stderr.readline()
            running.kill()
        self.assertRegex(said, r"^jointgen: \d+ joints with about \S+ crossings: cutting may take [1-9]\d+ s\n$")
        (folder / "scene.toml").write_text(self.band(3000))
        self.assert_refuses(BAD_INPUT, "jointgen", folder / "scene.toml",
                            says=["scene.toml: joints come closer to each other than shortest_edge_m", "hours", "nearly parallel"])

    def test_creep_step_beyond_the_limit(self):
        """(1 - exp(-lam dT)) (1 + K/E) < 2 with K/E = 10 and lam = 0.01 per day: dT < 20.067 days."""
        text = changed(self.chain.text(COLUMN), r'(^name = "joint"\n(.+\n)*?normal_kelvin_stiffness_MPa_per_m = )690',
                       r"\g<1>69")
        says = ["creep step of 25 day", "20.067", '"joint under block']
        self.assert_refuses(BAD_INPUT, "demsolve", self.chain.joints(text), "--creep-step", "25", says=says)
        text = changed(text, "^step_days = 1", "step_days = 25")
        self.assert_refuses(BAD_INPUT, "demsolve", self.chain.joints(text), says=says)
        text = changed(text, "^step_days = 25", "step_days = 20.06")
        self.chain.result(text)

    def test_free_fall(self):
        """A base that is held only sideways."""
        text = changed(self.chain.text(COLUMN), '^joint = "base joint"', 'fix = "x"')
        self.assert_refuses(NO_EQUILIBRIUM, "demsolve", self.chain.joints(text), says=["no contact supports", "] m"])

    def test_sizes_larger_than_what_they_divide(self):
        """The message names the key that is too large, not a stage whose rock is merged away."""
        def refused(text, *says):
            scene = self.chain.new_folder() / "scene.toml"
            scene.write_text(text)
            done = self.chain.answer("jointgen", scene, "--check")
            self.assertEqual(done.returncode, BAD_INPUT, done.stderr)
            for one in says:
                self.assertIn(one, done.stderr)

        text = self.chain.text(COLUMN)
        line = 1 + text.split("\n").index(next(one for one in text.split("\n") if one.startswith("size_m")))
        for size in "1e9", "1e6", "2000":
            refused(changed(text, "^size_m = 2.5 +#.*", f"size_m = {size}"), f"scene.toml, line {line}: [zones] size_m")
        large = changed(text, "^size_m = 2.5", "size_m = 100")
        end = len(large.split("\n")) + 1
        for edge in "1e9", "10":
            refused(f"{large}\n[cutting]\nshortest_edge_m = {edge}\n",
                    f"scene.toml, line {end + 1}: [cutting] shortest_edge_m")
        # A stage that is small beside the shortest edge, and one without rock.
        small = changed(large, r"\[\[\[0, 30\], \[10, 30\], \[10, 40\], \[0, 40\]\]\]",
                        "[[[4, 39], [5, 39], [5, 40], [4, 40]]]")
        refused(small, 'scene.toml: stage "block 1 removed" removes nothing', "[cutting] shortest_edge_m is 2 m")
        again = changed(text, r"\[\[\[0, 20\], \[10, 20\], \[10, 30\], \[0, 30\]\]\]",
                        "[[[0, 30], [10, 30], [10, 40], [0, 40]]]")
        refused(again, 'stage "block 2 removed" removes nothing: its remove_m contains no rock')

    def test_a_scene_that_does_not_fit_its_file(self):
        """A /scene that was changed after the file was made: the message names file, /scene and line."""
        column = self.chain.text(COLUMN)
        two_boundaries = changed(column, r"^\[in_situ_stress\].*", "[[boundary]]\nfrom_m = [0, 0]\nto_m = [0, 10]\n"
                                                                   'fix = "x"\n\n[in_situ_stress]')
        joints = self.chain.joints(two_boundaries + "\n#" + 500 * " room for longer texts")
        files = {"strength-averaging": joints.with_name("network.h5"), "demsolve": joints}
        for what, old, new, at, says in [
            ("not TOML", '^rock = "rock"', 'rock = "rock', 'rock = "rock', "without its closing quote"),
            ("an unknown key", "^density_kg_per_m3", "densty_kg_per_m3", "densty", "did you mean"),
            ("another rock", '"rock"$', '"stone"', 'name = "stone"', '[[rock]] "stone" name = "stone": expected "rock", as /names/rock'),
            ("another material", '"base joint"', '"base"', 'name = "base"', 'expected "base joint", as /names/joint_material'),
            ("another joint", '^name = "joint under block 2"', 'name = "F1"', 'name = "F1"',
             'expected "joint under block 2", as /names/joint_set'),
            ("a joint less", r'\[\[joint\]\]\nname = "joint under block 3" .*\n(.+\n)+\n', "", "", 'has no "joint under block 3", which /names/joint_set'),
            ("a stage less", r'\[\[stage\]\]\nname = "block 3 removed"\n(.+\n)+\n', "", "", '"block 3 removed"'),
            ("another stage", '^name = "block 3 removed"', 'name = "3"', 'name = "3"', 'expected "block 3 removed"'),
            ("a stage more", r"^\[\[gauge\]\]", '[[stage]]\nname = "4"\ndate = 30\nremove_m = [[[0, 0], [9, 0], [9, 9]]]\n\n[[gauge]]',
             'name = "4"', "expected no more of them"),
            ("a boundary less", r'\[\[boundary\]\]\nfrom_m = \[0, 0\]\nto_m = \[0, 10\]\n.*\n', "", "from_m = [0, 0]",
             "/edges/boundary of the file has 2"),
            ("a wider section", r"^outline_m = .*", "outline_m = [[0, 0], [12, 0], [12, 40], [0, 40]]", "outline_m = ",
             "480 m2, and the blocks of the file have 400 m2"),
        ]:
            count = 2 if what in ("another rock", "another material") else 1
            text = changed(two_boundaries, old, new, count)
            line = 1 + text[:text.index(at)].count("\n") if at else 1
            for program, file in files.items():
                with self.subTest(what, program=program):
                    copy = shutil.copy(file, self.chain.new_folder() / "changed.h5")
                    with h5py.File(copy, "r+", libver=("v110", "v110")) as opened:
                        opened["scene"][0] = text
                    self.assert_refuses(BAD_INPUT, program, copy, says=[f"{copy}: /scene, line {line}: ", says])

    def test_values_in_another_file(self):
        """Whatever HDF5 would read there, it is not what the file says."""
        joints = self.chain.joints(self.chain.text(COLUMN))
        name, values = "/vertices/position", datasets(joints)["/vertices/position"]

        def elsewhere(file):
            return file.create_dataset(name, values.shape, values.dtype, external=[("/dev/zero", 0, values.nbytes)])

        def virtual(file):
            layout = h5py.VirtualLayout(values.shape, values.dtype)
            layout[...] = h5py.VirtualSource(str(joints), name, values.shape)
            return file.create_virtual_dataset(name, layout)

        def linked(file):
            file[name] = h5py.ExternalLink(str(joints), name)
        for make in elsewhere, virtual, linked:
            with self.subTest(make.__name__):
                copy = shutil.copy(joints, self.chain.new_folder() / "changed.h5")
                with h5py.File(copy, "r+", libver=("v110", "v110")) as file:
                    attributes = dict(file[name].attrs)
                    del file[name]
                    for key, value in attributes.items() if make(file) else ():
                        file[name].attrs[key] = value
                self.assert_refuses(BAD_INPUT, "demsolve", copy, says=f"{copy}: {name} ")
                self.assert_refuses(BAD_INPUT, "demsolve", copy, says=" another file; expected ")

    def test_corners_that_do_not_enclose_a_blocks_area(self):
        joints = self.chain.joints(self.chain.text(COLUMN))
        for at, place in ((slice(None), 0), (2, [3, 7])):
            copy = shutil.copy(joints, self.chain.new_folder() / "changed.h5")
            with h5py.File(copy, "r+", libver=("v110", "v110")) as file:
                file["/vertices/position"][at] = place
            self.assert_refuses(BAD_INPUT, "demsolve", copy, says=[f"{copy}: /blocks/area[", " m2; expected "])

    def test_what_shows_only_in_a_run_names_the_file(self):
        text = changed(self.chain.text(COLUMN), "^step_days = 1", "step_days = 1e-6")
        joints = self.chain.joints(text)
        self.assert_refuses(BAD_INPUT, "demsolve", joints, says=f"demsolve: {joints}: creep step of 1e-06 day")

    def test_a_stage_whose_name_is_there_twice(self):
        """Every program that reads a file refuses it, and writes nothing."""
        folder = self.chain.new_folder()
        network = self.chain.run("jointgen", self.chain.source / "pipelines/reliability/small.toml", folder / "network.h5")
        joints, kept = self.chain.run("strength-averaging", network, folder / "joints.h5"), folder / "kept.h5"
        result = self.chain.run("demsolve", joints, folder / "result.h5", "--no-creep", "--checkpoint", kept)
        readings = self.chain.run("jointexport", result, folder / "readings.csv")
        for path in (network, joints, result, kept):
            path.with_suffix(".whole").write_bytes(path.read_bytes())
            with h5py.File(path, "r+", libver=("v110", "v110")) as file:
                file["names/stage"][1] = file["names/stage"][0]
        undamaged = folder / "undamaged.h5"
        joints.with_suffix(".whole").rename(undamaged)
        for damaged, program, *arguments in (
                (network, "strength-averaging", network, "-o", "out.h5"),
                (joints, "demsolve", joints, "-o", "out.h5"),
                (joints, "creepfit", joints, "--measurements", readings, "--fit", "joint-stiffness", "-o", "out.csv"),
                (kept, "demsolve", undamaged, "--no-creep", "--checkpoint", kept, "-o", "out.h5"),
                (joints, "jointexport", joints, "-o", "out.geojson"),
                (result, "jointexport", result, "-o", "out.csv"),
                (result, "jointexport", result, "-o", "out.vtu")):
            with self.subTest(program=program, damaged=damaged.name):
                done = self.chain.answer(program, *arguments)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertIn(f"{damaged.name}: /names/stage, row 1: it must hold that all names differ", done.stderr)
                self.assertEqual([*self.chain.folder.glob("out.*")], [])

    def test_too_few_steps(self):
        text = changed(self.chain.text(COLUMN), '^damping = "mass"', 'damping = "mass"\nmost_steps = 50')
        says = ["after 50 steps", "the largest unbalanced force is at ["]
        self.assert_refuses(NO_EQUILIBRIUM, "demsolve", self.chain.joints(text), says=says)


if __name__ == "__main__":
    main()
