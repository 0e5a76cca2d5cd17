"""What README and docs say of the programs is so."""

import importlib
import importlib.util
import inspect
import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
import unittest

import h5py
import jsonschema
import numpy as np

from chain import ChainTest, main

CHAIN = ["jointgen", "strength-averaging", "demsolve", "jointexport"]
PROGRAMS = [*CHAIN, "creepfit"]
BUILD_AND_RUN = "sh pipelines/setup.sh && make -j2 -C pipelines/slope"
PATH = 'export PATH="$PWD/build/release/apps:$PATH"\n'
HAS_SPHINX = all(importlib.util.find_spec(name) for name in ("sphinx", "myst_parser", "furo"))
BUILD_AND_TEST = 'sh pipelines/setup.sh test && ctest --preset test -j "$(nproc)"'


def code_blocks(text, language):
    return re.findall(rf"^```{language}\n(.*?)^```$", text, flags=re.MULTILINE | re.DOTALL)


class Documentation(ChainTest):
    def output_of(self, program, *arguments):
        done = self.chain.answer(program, *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_generated_pages(self):
        self.assertEqual(self.output_of("jointgen", "--scene-keys-markdown"), self.chain.text("docs/scene.md"))
        self.assertEqual(self.output_of("jointexport", "--file-format"), self.chain.text("docs/file-format.md"))

    def test_schema(self):
        """All scenes of the project keep to the schema, and a key that is wrong does not."""
        validator = jsonschema.Draft7Validator(json.loads(self.output_of("jointgen", "--scene-schema")))
        jsonschema.Draft7Validator.check_schema(validator.schema)
        scenes = [path for folder in ("data", "tests") for path in (self.chain.source / folder).rglob("*.toml")
                  if "[section]" in path.read_text(encoding="utf-8")]
        self.assertGreater(len(scenes), 20)
        for path in scenes:
            scene = json.loads(json.dumps(tomllib.loads(path.read_text(encoding="utf-8")), default=str))  # dates as text
            errors = [error.message for error in validator.iter_errors(scene)]
            self.assertEqual(errors, [], path)
        in_short = tomllib.loads("""
            variables = { H = 40, B = "2 * H" }
            section = { outline_m = [[0, 0], ["B", 0], { through_m = [1, 2], to_m = [0, "-H / 4"] }] }
            region = [{ outline_m = { center_m = ["H", 0], radius_m = 3, sides = 8 } }]""")
        for table, keys in in_short.items():
            schema = {**validator.schema["$defs"][table], "required": [], "$defs": validator.schema["$defs"]}
            for one in keys if isinstance(keys, list) else [keys]:
                self.assertEqual([e.message for e in jsonschema.Draft7Validator(schema).iter_errors(one)], [], table)
        for table, key, value, says in [("section", "gravity", 9.81, "'gravity' was unexpected"),
                                        ("rock", "poissons_ratio", 0.5, "0.5"), ("rock", "poissons_ratio", "0.2", "'0.2' does not match"),
                                        ("rock", "poissons_ratio", [], "is not of type 'number'"),
                                        ("point", "at_m", [1, 2, 3], "too long"), ("stage", "date", [1], "is not of type"),
                                        ("joint_set", "spacing", {"law": "normals"}, "'normals' is not one of"),
                                        ("zones", "kind", "cubic", "'cubic' is not one of")]:
            scene = json.loads(json.dumps(tomllib.loads(self.chain.text("data/slope/scene.toml")), default=str))
            (scene[table][0] if isinstance(scene[table], list) else scene[table])[key] = value
            self.assertIn(says, " ".join(error.message for error in validator.iter_errors(scene)), (table, key))

    def test_two_commands(self):
        commands = [block.strip() for block in code_blocks(self.chain.text("README.md"), "sh")]
        self.assertEqual(commands[:2], [BUILD_AND_RUN, BUILD_AND_TEST])
        run = self.chain.text(".ci/run").splitlines()
        self.assertEqual([line for line in run if "pipelines" in line],
                         [f"{BUILD_AND_TEST} || exit", "sh pipelines/check.sh --changed", "sh pipelines/setup.sh docs",
                          "sh pipelines/setup.sh develop", "sh pipelines/tidy.sh"])
        for path in "pipelines/setup.sh", "pipelines/check.sh", "pipelines/slope/Makefile", ".ci/run":
            self.assertTrue((self.chain.source / path).is_file(), path)

    def planned(self, command):
        """What a make command would run."""
        built = self.chain.programs / "jointgen"  # stands for benchmarks, not all of which are built
        done = subprocess.run([*command.split(), "-n", f"BIN={self.chain.programs}", f"OUT={self.chain.new_folder()}",
                               f"BENCHMARK={built}"],
                              cwd=self.chain.source, capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_make_commands(self):
        """Those in README and on the pages are possible, and the pictures that README speaks of are made."""
        readme = self.chain.text("README.md")
        pages = [self.chain.text(f"docs/{name}.md") for name in ("programs", "slope", "gallery", "verification")]
        commands = re.findall(r"make (?:-j2 )?-C pipelines/[^\n`#]*", readme + "".join(pages))
        commands = [command for command in commands if "/path/to/" not in command]
        plans = {command: self.planned(command) for command in sorted(set(commands))}
        self.assertGreaterEqual(len(plans), 7)
        made = set(re.findall(r" -o \S+/([\w-]+\.png)$", "\n".join(plans.values()), flags=re.MULTILINE))
        made.add("ensemble.png")  # by a study
        named = set(re.findall(r"`(?:out/column/)?([\w-]+\.png)`", readme))
        self.assertGreaterEqual(len(named), 5)
        self.assertLessEqual(named, made)

    def test_pictures(self):
        """All of them are shown, in README or on a page of docs, and all that are shown exist."""
        picture = re.compile(r"^!\[.+\]\((.+)\)$", flags=re.MULTILINE)
        shown = picture.findall(self.chain.text("README.md"))
        for page in (self.chain.source / "docs").glob("*.md"):
            shown += [f"docs/{path}" for path in picture.findall(page.read_text())]
        self.assertEqual(set(shown), {f"docs/pictures/{path.name}" for path in
                                      (self.chain.source / "docs" / "pictures").iterdir()})

    def test_stale_pictures(self):
        """Pictures of scenes are those of the scenes as they are, in the look that plots have (docs/pictures.py)."""
        sys.path.append(str(self.chain.source / "docs"))
        import pictures
        make = {"slope": "-C pipelines/slope docs-picture", "column": "-C pipelines/column docs-picture", "cavern": "-C docs cavern"}
        found, recorded = 0, pictures.recorded()
        for name, command in make.items():
            for path in (self.chain.source / "docs/pictures").glob(f"{name}-*.png"):
                wanted, found = pictures.made_of(f"data/{name}/scene.toml"), found + 1
                self.assertEqual(recorded.get(path.name), wanted, f"{path.name} is stale: make {command}")
        self.assertEqual(found, len(recorded))

    def run_commands(self, page, folder, *changes):
        """Runs all commands of a page, with changes of what and by what, in a folder that has the scenes and the plots, and finds this
        build's programs."""
        for name in "data", "pipelines":
            (folder / name).symlink_to(self.chain.source / name)
        commands = "".join(code_blocks(page, "sh"))
        self.assertIn(PATH, commands)
        for what, by in changes:
            self.assertEqual(commands.count(what), 1)
            commands = commands.replace(what, by)
        script = f'set -eu\nPATH="{self.chain.programs}:$PATH"\n' + commands.replace(PATH, "")
        done = subprocess.run(["sh", "-c", script], cwd=folder, capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def test_first_scene(self):
        """The scene of docs/first-scene.md runs through the commands of the page, and rises as the page says."""
        page = self.chain.text("docs/first-scene.md")
        (scene,) = code_blocks(page, "toml")
        one, chain = (block.splitlines() for block in code_blocks(page, "sh")[:2])
        self.assertEqual(one, [PATH.strip(), "jointcreep run two.toml -o two"])
        self.assertEqual([command.split()[0] for command in chain], [*CHAIN, "jointverify"])
        folder = self.chain.new_folder()
        (folder / "two.toml").write_text(scene)
        done = self.run_commands(page, folder)
        self.assertIn("factor of safety, at least                   64\n", done.stdout)
        self.assertEqual((folder / "two/result.h5").read_bytes(), (folder / "result.h5").read_bytes())
        for name in "section.png", "upper-block-removed-displacement.png", "histories.csv", "states.xdmf2", "report.html":
            self.assertTrue((folder / "two" / name).is_file(), name)
        with h5py.File(folder / "result.h5") as file:
            # Below C are 5 m of rock and the base's joint: dF (z (1 - nu^2) / E_r + 1 / K) at once. Later 1 / E comes
            # on top. The base is rough, which the formula leaves out.
            at_once = 2750 * 9.81 * 10 * (5 * (1 - 0.22**2) / 40e9 + 1 / 690e6)
            rise = file["/history/displacement"][:, 0, 1]
            self.assertAlmostEqual(rise[2] / at_once, 1, delta=1e-2)
            self.assertGreater(rise[-1], 1.8 * at_once)
        self.assertIn(f"{at_once * 1e3:.2f}\\ \\mathrm{{mm}}", page)

    def test_slope_and_cavern(self):
        """The commands of both pages run, their figures are those of the runs, and the scenes are as quoted."""
        for name, blocks, point in ("slope", 372, 3), ("cavern", 228, 1):
            with self.subTest(name):
                page, folder = self.chain.text(f"docs/{name}.md"), self.chain.new_folder()
                done = self.run_commands(page, folder)
                self.assertIn("verified: ", done.stdout)
                with h5py.File(folder / "result.h5") as file:
                    self.assertEqual(len(file["blocks/area"]), blocks)
                    moved = file["/history/displacement"][-1, point, 0] * 1e3
                self.assertRegex(page, rf"by {moved:.1f} mm|by {moved:.0f} mm")
                quoted = re.findall(r"^    (\[.*|\w+ = .*)$", page, flags=re.MULTILINE)
                self.assertGreaterEqual(len(quoted), 7)
                scene = self.chain.text(f"data/{name}/scene.toml").splitlines()
                self.assertEqual([line for line in quoted if line not in scene], [])
                if name == "slope":
                    self.assertIn("28 pass, 0 fail, 14 without verdict", done.stdout)
                else:
                    self.assertNotIn("warning", done.stderr)
                    self.check_cavern(page, folder)

    def check_cavern(self, page, folder):
        """The counts of the page, and the closure of the walls that its Python prints, are those of the result."""
        example, stress = code_blocks(page, "python")
        done = subprocess.run([sys.executable, "-c", f"{example}\n{stress}"], cwd=folder, capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        with h5py.File(folder / "result.h5") as file:
            slipping = (file["/states/contact_status"][-1] == 2).sum()
            self.assertIn(f"{len(file['/mesh/zone_block'])} zones, {len(file['/equilibria/time'])} equilibria", page)
            self.assertIn(f"At the end {slipping} contacts slip and one is open.", page)
            names = file["/history/point"].asstr()[:].tolist()
            last = file["/history/displacement"][-1] * 1e3
        closure, largest = done.stdout.strip().splitlines()
        self.assertIn(f"# {float(largest):.1f} MPa", page)
        x, y = map(float, closure.strip(" []").split())
        self.assertAlmostEqual(x, last[names.index("south wall"), 0] - last[names.index("north wall"), 0], places=3)
        self.assertAlmostEqual(y, last[names.index("south wall"), 1] - last[names.index("north wall"), 1], places=3)
        self.assertRegex(page, rf"approach, by {x:.0f} mm")

    def test_links(self):
        """Files that pages name in links exist. (Sphinx looks at headings, too, of pages in docs.)"""
        source = self.chain.source
        for page in [*source.glob("*.md"), *(source / "docs").glob("*.md")]:
            text = re.sub(r"(?ms)^```.*?^```$", "", page.read_text())
            for path in re.findall(r"\]\(([^):#\s]+)(?:#[^)]*)?\)", text):
                self.assertTrue((page.parent / path).exists(), f"{page.name}: {path}")

    def test_concept_figures(self):
        """They are those that the script draws."""
        folder = self.chain.new_folder()
        subprocess.run([sys.executable, self.chain.source / "docs" / "concept_figures.py", folder], check=True)
        drawn = {path.name: path.read_bytes() for path in folder.iterdir()}
        kept = {path.name: path.read_bytes() for path in (self.chain.source / "docs" / "pictures").glob("concept-*")}
        self.assertEqual(sorted(drawn), sorted(kept))
        for name in drawn:
            self.assertTrue(drawn[name] == kept[name], f"{name} is not what make -C docs figures draws")

    @unittest.skipUnless(HAS_SPHINX, "needs Sphinx: sh pipelines/setup.sh docs")
    def test_site(self):
        """It has all pages, formulas and pictures, and needs nothing from the network; a link that leads nowhere is an error."""
        source = self.chain.new_folder()
        shutil.copytree(self.chain.source / "docs", source / "docs", ignore=shutil.ignore_patterns("__pycache__"))
        shutil.copy(self.chain.source / "CMakeLists.txt", source)

        def made():
            return subprocess.run(["make", "-C", source / "docs", f"OUT={source}/site"], capture_output=True, text=True,
                                  timeout=300)

        done = made()
        self.assertEqual(done.returncode, 0, done.stderr)
        pages = {path.stem for path in (source / "docs").glob("*.md")}
        self.assertEqual(pages - {path.stem for path in (source / "site").glob("*.html")}, set())
        for page in (source / "site").glob("*.html"):
            with self.subTest(page.name):
                self.assertEqual(re.findall(r'<(?:script|link|img)[^>]*(?:src|href)="(?:https?:)?//', page.read_text()), [])
        theory = (source / "site" / "method.html").read_text()
        self.assertGreater(theory.count('class="math"'), 300)
        for name in "katex.min.js", "katex.min.css", "fonts/KaTeX_Main-Regular.woff2":
            self.assertTrue((source / "site" / "_static" / name).is_file(), name)

        for path in (source / "docs").glob("*.md"):
            path.unlink()
        (source / "docs" / "index.md").write_text("# Index\n\n```{toctree}\nlimits\n```\n")
        (source / "docs" / "limits.md").write_text("# Limits\n\n[here](index.md)\n")
        done = made()
        self.assertEqual(done.returncode, 0, done.stderr)
        with (source / "docs" / "limits.md").open("a") as page:
            page.write("\n[nowhere](index.md#nowhere)\n")
        done = made()
        self.assertNotEqual(done.returncode, 0)
        self.assertRegex(done.stderr, r"limits\.md.*nowhere")

    def test_studies_example(self):
        """The first study of docs/studies.md runs by its commands."""
        page = self.chain.text("docs/studies.md")
        study, path, commands = code_blocks(page, "toml")[0], *code_blocks(page, "sh")[0].split("\n", 1)
        self.assertEqual(path, 'export PATH="$PWD/build/release/apps:$PATH"')
        folder = self.chain.new_folder()
        (folder / "data").symlink_to(self.chain.source / "data")
        (folder / "first.toml").write_text(study)
        script = f'set -eu\nPATH="{self.chain.programs}:$PATH"\n{commands}'
        done = subprocess.run(["sh", "-c", script], cwd=folder, capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("crest (mm), 8 runs", done.stdout)
        self.assertIn("crest (mm)", (folder / "first.html").read_text())

    def test_path_to_other_programs(self):
        """The commands of docs/exchange.md make the files that it says, and its table has the formats that there are."""
        page = self.chain.text("docs/exchange.md")
        (commands,) = (block for block in code_blocks(page, "sh") if "jointgen" in block)
        folder = self.chain.new_folder()
        (folder / "data").symlink_to(self.chain.source / "data")
        script = f'set -eu\nPATH="{self.chain.programs}:$PATH"\n{commands}'
        done = subprocess.run(["sh", "-c", script], cwd=folder, capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, 0, done.stderr)
        with h5py.File(folder / "network.h5") as file:
            blocks = len(file["blocks/area"])
            sets = set(file["names/joint_set"].asstr()[:])
        self.assertEqual((folder / "blocks.geo").read_text().count("Plane Surface("), blocks)
        self.assertIn(f'NumberOfCells="{blocks}"'.encode(), (folder / "blocks.vtu").read_bytes())
        traces = json.loads((folder / "joints.geojson").read_text())["features"]
        self.assertEqual({trace["properties"]["set"] for trace in traces}, sets)
        rows = re.findall(r"^\| `(\w+)` \| (\.[^|]*) \|", page, flags=re.MULTILINE)
        listed = [line.split("\t")[:2] for line in self.output_of("jointexport", "--formats").splitlines()[1:]]
        self.assertEqual([list(row) for row in rows], listed)

    def test_python_page(self):
        """The examples of docs/python.md run one after another, on its run and a small study; its table has the plots and options."""
        from jointcreep import plots
        page, folder = self.chain.text("docs/python.md"), self.chain.new_folder()
        (shell,) = code_blocks(page, "sh")
        self.assertIn('export PYTHONPATH="$PWD/pipelines"\n', shell)
        self.run_commands(page, folder, ("-o out/slope\n", "-o out/slope --makefile\nmake -C out/slope result.h5\n"))  # no pictures
        (folder / "scene.toml").write_text(self.chain.small())
        (folder / "study.toml").write_text('scene = "scene.toml"\n[[vary]]\nnetwork = true\n[design]\nruns = 3\n[[collect]]\nname = "crest"\n'
                                           'what = "displacement"\npoint = "crest"\ncomponent = "x"\n')
        subprocess.run([self.chain.programs / "jointcreep", "study", "study.toml", "-o", "out/first", "-q"], check=True, cwd=folder)
        blocks = code_blocks(page, "python")
        self.assertEqual(len(blocks), 9)
        for package in "pandas", "xarray":
            if not importlib.util.find_spec(package):
                blocks = [block for block in blocks if f"python3-{package}" not in block]
        checks = ("import numpy, h5py, pathlib, sys\n"
                  "assert [path for path in sys.path if path.endswith('/plots')] == [str(pathlib.Path('pipelines/plots').resolve())]\n"
                  "file = h5py.File('out/slope/result.h5')\n"
                  "assert (history.displacement == file['/history/displacement'][()]).all() and table.units['displacement x'] == 'm'\n"
                  "place = dict(zip(history.point, history.position))\n"
                  "apart = place['crest'] - place['toe']\n"
                  "assert closure[0] == 0 and abs(closure[-1] + relative[-1] @ apart / numpy.linalg.norm(apart)) < 1e-6 < abs(closure[-1])\n"
                  "assert abs(network.blocks()['area'].sum() - 120 * 70) < 1e-6\n"
                  "assert 'frame' not in globals() or frame.attrs['units']['length'] == 'm' and len(frame) == contacts.rows()\n"
                  "assert 'moved' not in globals() or moved.sel(point='toe', component='y').values.tolist() == history.of('toe')[:, 1].tolist()\n"
                  "assert 'stress' not in globals() or stress.sel(state=3, component='yy').values.tolist() == run.zones('bench 3')['stress yy'].tolist()\n"
                  "assert study.runs.units['crest (mm)'] == 'mm' and low < value < high\n")
        done = subprocess.run([sys.executable, "-c", "\n".join([*blocks, checks])], cwd=folder, capture_output=True, text=True,
                              env=dict(os.environ, PYTHONPATH="pipelines"))
        self.assertEqual((done.returncode, done.stdout), (0, 'there is no stage "bench 9"; there are: bench 1, bench 2, bench 3\n'), done.stderr)
        self.assertEqual((folder / "stress.png").read_bytes()[:4], b"\x89PNG")

        rows = re.findall(r"^\| `(\w+)` \| .* \| (.*)\|$", page, flags=re.MULTILINE)
        documented = {name: re.findall(r"`(\w+)`", options) for name, options in rows}
        self.assertEqual(list(documented), plots.NAMES)
        for name, options in documented.items():
            drawn = importlib.import_module(f"plot_{name}").draw
            self.assertEqual(sorted(options), sorted(list(inspect.signature(drawn).parameters)[1:]), name)

    def test_scene_page_example(self):
        for number, scene in enumerate(code_blocks(self.chain.text("docs/scene.md"), "toml")):
            path = self.chain.new_folder() / f"{number}.toml"
            path.write_text(scene)
            self.output_of("jointgen", path, "--check")

    def test_scene_keys_on_pages(self):
        """Parts of scenes on pages have keys of the schema, and each key with a unit that a page names exists."""
        schema = json.loads(self.output_of("jointgen", "--scene-schema"))
        known = set(re.findall(r'"(\w+)": ?\{', json.dumps(schema)))
        validator = jsonschema.Draft7Validator(schema)
        units = re.compile(r"`(\w+_(?:deg|m|m2|MPa|GPa|per_m|days|kg_per_m3|MPa_per_m|MPa_day_per_m|GPa_per_m|m_per_s2))(?: = [^`]*)?`")
        found = 0
        for name in "slope", "cavern", "joint-data", "values", "section", "no-equilibrium", "factor-of-safety", "studies":
            page = self.chain.text(f"docs/{name}.md")
            self.assertEqual({key for key in units.findall(page) if key not in known}, set(), name)
            for part in code_blocks(page, "toml"):
                for table, ones in tomllib.loads(part).items():
                    if table not in schema["$defs"]:  # of a study file
                        self.assertIn(table, ("title", "scene", "vary", "design", "collect", "stop"), name)
                        continue
                    for one in ones if isinstance(ones, list) else [ones]:
                        rules = {**schema["$defs"][table], "required": [], "$defs": schema["$defs"]}
                        errors = validator.evolve(schema=rules).iter_errors(json.loads(json.dumps(one, default=str)))
                        self.assertEqual([error.message for error in errors], [], f"{name}: {table}")
                        found += 1
        self.assertGreaterEqual(found, 9)

    def test_bolted_cavern(self):
        """The keys of the page on bolts, in the scene of the cavern: joints without bridges are stronger in the region, and only there."""
        (keys,) = code_blocks(self.chain.text("docs/no-equilibrium.md"), "toml")
        tables, of_set = keys.split("[[joint_set]]\n")
        of_set = next(line for line in of_set.splitlines() if line.startswith("material_in"))
        scene = self.chain.text("data/cavern/scene.toml")
        creep = [line for line in scene.splitlines() if "_kelvin_" in line]
        tables = tables.replace("tensile_strength_MPa = 0.09\n", "\n".join(["tensile_strength_MPa = 0.09", *creep, ""]))
        scene = re.sub(r"^\[\[joint_set\]\]$", f"[[joint_set]]\n{of_set}", scene, flags=re.MULTILINE)
        result = self.chain.result(scene + "\n" + tables, "--no-creep")
        with h5py.File(result) as file:
            traced = (file["/edges/kind"][:] == 1) & (file["/edges/joint_fraction"][:] == 1)
            middle = np.abs(file["/vertices/position"][:][file["/edges/vertex"][:]].mean(axis=1) - [0, 4])  # of the region's middle
            inside = traced & (middle < [13.9, 15.9]).all(axis=1)
            outside = traced & (middle > [14.1, 16.1]).any(axis=1)
            strength = file["/equivalent/tensile_strength"][:], file["/equivalent/cohesion"][:]
        self.assertGreater(min(inside.sum(), outside.sum()), 20)
        for edges, wanted in (inside, (0.09e6, 0.165e6)), (outside, (0, 0.1e6)):
            for found, value in zip(strength, wanted):
                np.testing.assert_allclose(found[edges], value)

    def test_file_format_example(self):
        (example,) = code_blocks(self.chain.text("docs/file-format.md"), "python")
        result = self.chain.result(self.chain.text("data/column/scene.toml"), "--no-creep")
        check = example + "\nassert len(time) == 8 and list(points) == ['A', 'B', 'C'] and units == 'm'\n"
        check += "assert displacement.shape == (8, 3, 2) and '[section]' in scene\n"
        subprocess.run([sys.executable, "-c", check], cwd=result.parent, check=True)

    def test_options(self):
        """docs/programs.md and --help have the same options."""
        common, *sections = re.split(r"^## ", self.chain.text("docs/programs.md"), flags=re.MULTILINE)[1:]
        pages = {section.split("\n")[0].strip(): section for section in sections}

        def documented(section):
            rows = re.findall(r"^\| (`-.*?) \|", section, flags=re.MULTILINE)
            return {option for row in rows for option in re.findall(r"`(-[^` ]+)", row)}

        def listed(program):
            text = self.output_of(program, "--help").split("Options:\n")[1].split("\n\n")[0]
            found = set()
            for line in text.splitlines():
                short_and_long = re.match(r"  (?:(-\w) \[ (--[\w-]+) \]|(--[\w-]+))", line)
                found |= {option for option in short_and_long.groups() if option} if short_and_long else set()
            return found

        for program in PROGRAMS:
            with self.subTest(program):
                self.assertEqual(documented(common) | documented(pages[program]), listed(program))
                self.assertGreaterEqual(len(listed(program)), 7)

    def test_exit_codes(self):
        documented = re.findall(r"^\| (\d) \| (.*?) \|$", self.chain.text("docs/programs.md"), flags=re.MULTILINE)
        for program in PROGRAMS:
            listed = re.findall(r"^  (\d)  (.*)$", self.output_of(program, "--help"), flags=re.MULTILINE)
            self.assertEqual([code for code, _ in listed], [code for code, _ in documented])
            self.assertEqual([code for code, _ in listed], ["0", "2", "3", "4", "5"])

    def test_version(self):
        version = re.search(r"VERSION (\S+)", self.chain.text("CMakeLists.txt").split("project(")[1]).group(1)
        self.assertIn(f"\nversion: {version}\n", self.chain.text("CITATION.cff"))
        for program in PROGRAMS:
            self.assertRegex(self.output_of(program, "--version"), rf"^{program} {re.escape(version)}(\+[\w.]+)?\n$")


if __name__ == "__main__":
    main()
