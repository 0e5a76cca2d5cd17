"""What `cmake --install` puts elsewhere: programs that run there, manual pages, completion for bash."""

import os
import re
import subprocess
import unittest

from chain import ChainTest, main

APPS = ["jointgen", "strength-averaging", "demsolve", "jointexport", "creepfit", "jointverify", "jointcreep"]


class Install(ChainTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.prefix = cls.chain.new_folder()
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
        self.assertEqual(files, sorted([f"bin/{app}" for app in APPS] + [module] * has_gdal +
                                       [f"share/jointcreep/{path}" for path in package if path.name != "launcher.py"] +
                                       [f"share/man/man1/{app}.1" for app in APPS] +
                                       [f"share/bash-completion/completions/{app}" for app in APPS]))

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


if __name__ == "__main__":
    main()
