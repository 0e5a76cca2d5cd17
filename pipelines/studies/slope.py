"""Studies of the bench slope's networks, and the command that makes them: what kills.py and pace.py share."""

import argparse
import pathlib
import shutil
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
RESULTS = ["runs.csv", "runs.h5", "answers.csv", "convergence.csv", "shares.csv", "summary.txt"]
STUDY = """
scene = "{scene}"

[[vary]]
network = true

[design]
runs = {runs}

[[collect]]
what = "displacement"
point = "crest"
component = "x"

[[collect]]
what = "failed"
"""


def options(description, more=lambda parser: None):
    """The command line PROGRAMS OUT --runs N --quick, and what `more` adds."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--quick", action="store_true", help="with large zones and without creep")
    more(parser)
    return parser.parse_args()


def written(arguments, name):
    """Writes the study file and removes what an earlier trial left. Returns its path and the study's folder."""
    arguments.out.mkdir(parents=True, exist_ok=True)
    folder, file = arguments.out / name, arguments.out / f"{name}.toml"
    shutil.rmtree(folder, ignore_errors=True)
    quick = 'demsolve_options = ["--zone-size", "12", "--no-creep"]\n' if arguments.quick else ""
    file.write_text(quick + STUDY.format(scene=ROOT / "data/slope/scene.toml", runs=arguments.runs), "utf-8")
    return file, folder


def command(arguments, file, folder, jobs):
    return [str(arguments.programs / "jointcreep"), "study", str(file), "-o", str(folder), "-j", str(jobs), "--quiet"]


def made(arguments, file, folder, jobs):
    """Makes a study, which must succeed."""
    subprocess.run(command(arguments, file, folder, jobs), check=True)


def differing(one, other):
    """Names of results whose bytes differ."""
    return [name for name in RESULTS if (one / name).read_bytes() != (other / name).read_bytes()]
