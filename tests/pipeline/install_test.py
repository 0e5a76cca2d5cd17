"""What `cmake --install` puts elsewhere: programs that run there, the Python package, scenes, pages, manual pages, completion for
bash. And the Debian package, which has the same files, and archives of the sources."""

import os
import re
import shutil
import stat
import subprocess
import sys
import tarfile
import unittest

import numpy as np
from chain import ChainTest, datasets, main

APPS = ["jointgen", "strength-averaging", "demsolve", "jointexport", "creepfit", "jointverify", "jointcreep"]


class Install(ChainTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.prefix = cls.chain.new_folder()
        (cls.chain.source / "docs/__pycache__").mkdir(exist_ok=True)  # as Python leaves one beside a script that a test imports
        subprocess.run(["cmake", "--install", cls.chain.programs.parent, "--prefix", cls.prefix], check=True,
                       capture_output=True)

    def installed(self, *command, **more):
        path = f"{self.prefix / 'bin'}:{os.environ['PATH']}"
        return subprocess.run(command, capture_output=True, text=True, env=dict(os.environ, PATH=path), **more)

    def test_nothing_else_is_installed(self):
        files = sorted(str(path.relative_to(self.prefix)) for path in self.prefix.rglob("*") if path.is_file())
        pipelines = self.chain.source / "pipelines"
        package = [path.relative_to(pipelines) for folder in ("jointcreep", "plots") for path in (pipelines / folder).glob("*.py")]
        module = "lib/jointcreep/jointcreep_gdal.so"  # where GDAL is
        has_gdal = (self.chain.programs / "jointcreep_gdal.so").exists()
        source = self.chain.source
        data = [path.relative_to(folder) for folder, name in ((source, "data"), (source / "pipelines/studies", "profiles"))
                for path in (folder / name).rglob("*") if path.is_file()]
        pages = [path.relative_to(source) for end in ("md", "png", "svg") for path in (source / "docs").rglob(f"*.{end}")]
        of_doc = ["README.md", "CHANGELOG.md", "CONTRIBUTING.md", "CITATION.cff", "LICENSE", "copyright", *map(str, pages)]
        headers = [path for folder in ("model", "store") for path in (self.prefix / "include/jointcreep" / folder).glob("*.hpp")]
        libraries = ["store", "fields", "keys", "rock", "joint", "boundary", "creep", "model"]
        configs = ["config", "config-version", "targets", "targets-release"]
        self.assertEqual(len(headers), 7)
        self.assertTrue(os.access(self.prefix / "share/jointcreep/profiles/slurm/slurm_status.sh", os.X_OK))
        self.assertEqual(files, sorted([f"bin/{app}" for app in APPS] + [str(path.relative_to(self.prefix)) for path in headers] +
                                       [f"lib/jointcreep/lib{name}.a" for name in libraries] +
                                       [f"lib/cmake/jointcreep/jointcreep-{name}.cmake" for name in configs] + [module] * has_gdal +
                                       [f"share/jointcreep/{path}" for path in package if path.name != "launcher.py"] +
                                       [f"share/jointcreep/{path}" for path in data] +
                                       [f"share/doc/jointcreep/{path}" for path in of_doc] +
                                       [f"share/man/man1/{app}.1" for app in APPS] +
                                       [f"share/bash-completion/completions/{app}" for app in APPS]))

    def test_links_of_pages(self):
        """What the installed README and pages link to is there; what is for developers is in the sources only."""
        folder = self.prefix / "share/doc/jointcreep"
        for page in [folder / "README.md", *(folder / "docs").glob("*.md")]:
            text = re.sub(r"(?ms)^```.*?^```$", "", page.read_text())
            links = {path for path in re.findall(r"\]\(([^):#\s]+)(?:#[^)]*)?\)", text) if not path.endswith("CONTRIBUTING.md")}
            self.assertEqual({path for path in links if not (page.parent / path).exists()}, set(), page.name)

    def test_a_scene_runs_from_any_folder(self):
        """`jointcreep run` makes results, pictures and the report of an installed scene, with what is installed alone."""
        folder = self.chain.new_folder()
        done = self.installed("jointcreep", "run", self.prefix / "share/jointcreep/data/column/scene.toml", "-o", "out", cwd=folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        for name in "result.h5", "section.png", "histories-y.png", "report.html":
            self.assertTrue((folder / "out" / name).is_file(), name)
        self.assertNotIn(str(self.chain.source / "pipelines"), done.stderr)
        self.assertEqual(list(self.prefix.rglob("__pycache__")), [])

    def test_python_package(self):
        """With one folder in PYTHONPATH scripts read and draw."""
        folder = self.chain.new_folder()
        network = self.chain.network(self.chain.text("data/column/scene.toml"))
        script = ("import sys, jointcreep; from jointcreep import plots; print(jointcreep.__file__); "
                  "plots.save('section', sys.argv[1], 'section.png')")
        done = subprocess.run([sys.executable, "-B", "-c", script, network], cwd=folder, capture_output=True, text=True,
                              env=dict(os.environ, PYTHONPATH=str(self.prefix / "share/jointcreep")))
        self.assertEqual((done.returncode, done.stdout), (0, f"{self.prefix}/share/jointcreep/jointcreep/__init__.py\n"), done.stderr)
        self.assertTrue((folder / "section.png").read_bytes().startswith(b"\x89PNG"))

    def test_a_program_of_others(self):
        """The example of docs/installation.md, built with the installed library alone, prints the histories of a result."""
        page = self.chain.text("docs/installation.md")
        (cmake,) = re.findall(r"(?ms)^```cmake\n(.*?)^```$", page)
        (program,) = re.findall(r"(?ms)^```cpp\n(.*?)^```$", page)
        folder = self.chain.new_folder()
        (folder / "CMakeLists.txt").write_text(cmake)
        (folder / "histories.cpp").write_text(program)
        self.installed("cmake", f"-DCMAKE_PREFIX_PATH={self.prefix}", "-B", "build", cwd=folder, check=True)
        built = self.installed("cmake", "--build", "build", "--verbose", cwd=folder)
        self.assertEqual(built.returncode, 0, built.stdout + built.stderr)
        self.assertNotRegex(built.stdout, "-Werror|-Wall|-ffp-contract|-O3")
        self.assertNotIn(str(self.chain.source), built.stdout)
        result = self.chain.result(self.chain.text("data/column/scene.toml"), "--no-creep")
        done = self.installed(folder / "build/histories", result, check=True)
        history = datasets(result)
        wanted = [[time, point, *displacement] for time, row in zip(history["/history/time"], history["/history/displacement"])
                  for point, displacement in zip(history["/history/point"], row)]
        for line, (time, point, x, y) in zip(done.stdout.splitlines(), wanted, strict=True):
            day, name, *uv = line.split()
            self.assertEqual(name, point)
            np.testing.assert_allclose([float(value) for value in (day, *uv)], [time, x, y], rtol=1e-5, atol=1e-12)
        refused = self.installed(folder / "build/histories", "none.h5")
        self.assertEqual((refused.returncode, refused.stderr.startswith("none.h5: ")), (1, True), refused.stderr)

    def version_of(self, commit):
        """What version.cmake says in a folder that is no git checkout."""
        folder = self.chain.new_folder()
        shutil.copy(self.chain.source / "libs/model/version.cmake", folder)
        (folder / "commit.txt").write_text(commit)
        subprocess.run(["cmake", "-D", f"SOURCE={folder}", "-D", "VERSION=1.2.3", "-D", f"OUTPUT={folder}/version.hpp", "-P",
                        folder / "version.cmake"], check=True)
        return re.search('"(.*)"', (folder / "version.hpp").read_text()).group(1)

    def test_version_without_git(self):
        """That of an archive has the commit, if `git archive` made it."""
        self.assertEqual(self.version_of("0123456789abcdef" * 2 + "01234567\n"), "1.2.3+01234567")
        kept = self.chain.text("libs/model/commit.txt")
        self.assertEqual(kept, "$Format:%H$\n")  # which `git archive` replaces
        self.assertEqual(self.chain.text(".gitattributes"), "libs/model/commit.txt export-subst\n")
        self.assertEqual(self.version_of(kept), "1.2.3")

    def test_the_chain_runs_there(self):
        scene = self.chain.new_folder() / "scene.toml"
        scene.write_text(self.chain.text("data/column/scene.toml"))
        for command in (["jointgen", scene, "-o", "n.h5"], ["strength-averaging", "n.h5", "-o", "j.h5"],
                        ["demsolve", "j.h5", "-q", "-o", "r.h5"], ["jointexport", "r.h5", "-q", "-o", "r.csv"],
                        ["jointverify", "r.h5"]):
            done = self.installed(*command, cwd=scene.parent)
            self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue((scene.parent / "r.csv").read_text().startswith("time_day"))

    def test_traces_are_read_there(self):
        """By the module that is installed, not by the one of the build."""
        if not (self.prefix / "lib/jointcreep/jointcreep_gdal.so").exists():
            self.skipTest("built without GDAL")
        path = self.chain.new_folder() / "t.dxf"
        path.write_text("0\nSECTION\n2\nENTITIES\n0\nLINE\n8\na\n10\n0\n20\n0\n11\n1\n21\n1\n0\nENDSEC\n0\nEOF\n")
        done = self.installed("jointgen", path, "--traces")
        self.assertEqual((done.returncode, done.stdout.count("\n")), (0, 3), done.stderr)

    def test_manual_pages(self):
        for app in APPS:
            page = self.prefix / "share/man/man1" / f"{app}.1"
            done = self.installed("groff", "-man", "-ww", "-Tascii", "-P-cbou", "-rLL=120n", str(page))
            self.assertEqual((done.returncode, done.stderr), (0, ""), app)
            text = done.stdout
            for section in ("NAME", "SYNOPSIS", "OPTIONS", "EXIT CODES", "EXAMPLE"):
                self.assertRegex(text, f"(?m)^{section}$")
            self.assertRegex(text, rf"(?m)^ +{app} - [a-z]")
            for line in self.installed(app, "--help").stdout.splitlines()[1:]:
                if line and not re.match(r"usage: |[A-Z][A-Za-z ]*:$", line):
                    self.assertIn(line.rstrip(), text, f"a line of {app} --help is not in its page")

    def completed(self, app, word):
        script = self.prefix / "share/bash-completion/completions" / app
        done = self.installed("bash", "-c", 'source "$1"; COMP_WORDS=("$2" "$3"); COMP_CWORD=1; _jointcreep "$2"; '
                              'printf "%s\\n" "${COMPREPLY[@]}"; complete -p "$2"', "bash", str(script), app, word)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        *words, registered = done.stdout.splitlines()
        self.assertEqual(registered, f"complete -o default -F _jointcreep {app}")
        return [word for word in words if word]

    def test_completion(self):
        self.assertEqual(self.completed("demsolve", "--creep-t"), ["--creep-tolerance"])
        self.assertEqual(self.completed("jointgen", "--real"), ["--realization"])
        self.assertEqual(self.completed("jointexport", "scene"), [])  # a file: bash's own
        for app in APPS:
            options = {"--help", "--version"} if app == "jointverify" else {"--output", "--quiet", "--help", "--version"}
            self.assertLessEqual(options, set(self.completed(app, "--")))

    def test_versions(self):
        versions = {app: self.installed(app, "--version") for app in APPS}
        for app, done in versions.items():
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertRegex(done.stdout, rf"^{app} \d+\.\d+\.\d+")
        of_all = {done.stdout.split()[1].split("+")[0] for done in versions.values()}
        self.assertEqual(len(of_all), 1, of_all)


@unittest.skipUnless(shutil.which("dpkg-shlibdeps") and shutil.which("file"), "needs: sh pipelines/setup.sh package")
class DebianPackage(ChainTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        folder = cls.chain.new_folder()
        subprocess.run(["cpack", "-G", "DEB", "-B", folder, "-D", "CPACK_DEBIAN_COMPRESSION_TYPE=gzip", "--config", cls.chain.programs.parent / "CPackConfig.cmake"], check=True,
                       capture_output=True)
        (cls.package,) = folder.glob("*.deb")
        cls.content = folder / "content.tar"
        with cls.content.open("wb") as file:
            subprocess.run(["dpkg-deb", "--fsys-tarfile", cls.package], check=True, stdout=file)

    def field(self, name):
        return subprocess.run(["dpkg-deb", "--field", self.package, name], check=True, capture_output=True, text=True).stdout.strip()

    def test_fields(self):
        version = re.search(r"VERSION (\S+)", self.chain.text("CMakeLists.txt").split("project(")[1]).group(1)
        self.assertEqual([self.field(name) for name in ("Package", "Version", "Section")], ["jointcreep", version, "science"])
        (author,) = re.findall(r'^  - name: "(.*)"$', self.chain.text("CITATION.cff"), flags=re.MULTILINE)
        self.assertEqual(self.field("Maintainer"), author)
        self.assertRegex(self.field("Description"), r"^Excavation and creep of jointed rock slopes.*\n jointcreep computes")
        depends = {word.split()[0] for word in self.field("Depends").split(", ")}
        self.assertLessEqual({name for name in self.chain.text("pipelines/packages/run.txt").split() if name.startswith("python3")},
                             depends)
        self.assertLessEqual({"libc6", "libstdc++6", "libgomp1", "libcholmod3", "make"}, depends)  # also of shared libraries
        self.assertEqual([name for name in depends if name.endswith("-dev")], [])

    def test_content(self):
        """Files for all users to read, owned by root, in the folders of packages."""
        with tarfile.open(self.content) as content:
            for entry in content:
                name = entry.name.lstrip("./")
                self.assertEqual((entry.uid, entry.gid), (0, 0), name)
                self.assertTrue(name == "" or name == "usr" or name.startswith(("usr/bin", "usr/include", "usr/lib", "usr/share")), name)
                if entry.issym():
                    self.assertEqual((name, entry.linkname),
                                     ("usr/lib/python3/dist-packages/jointcreep", "../../../share/jointcreep/jointcreep"))
                else:
                    runs = entry.isdir() or name.startswith("usr/bin/") or name.endswith(".sh")
                    self.assertEqual(stat.S_IMODE(entry.mode), 0o755 if runs else 0o644, name)
            names = {path.lstrip("./") for path in content.getnames()}
        self.assertLessEqual({f"usr/bin/{app}" for app in APPS} | {"usr/share/jointcreep/data/slope/scene.toml",
                                                                  "usr/share/doc/jointcreep/copyright"}, names)


if __name__ == "__main__":
    main()
