"""The same scenes by programs that other compilers and options made: g++ -O2 and clang++ 16 against the given programs, g++ -O3's.

Scenes are all those of data and of tests/pipeline; N is how many of them, at most. -O2 and -O3 of g++ have to give the same
bytes. clang++ may round otherwise: every dataset has to agree to CLOSE of its largest number. With --built the programs of a folder
are compared, in place of those that it would build: they have to give the same bytes.
"""

import pathlib
import shutil
import subprocess

import h5py
import numpy as np
from campaign import HANGS, LONGEST, ROOT, Campaign, ended
from recover import scenes

BUILDS = {"g++ -O2": ("g++", "-O2"), "clang++ -O3": ("clang++-16", "-O3")}
CHAIN = ["jointgen", "strength-averaging", "demsolve"]
CLOSE = 1e-6
NOTHING = 1e-30  # numbers below it, in SI units, are 0


def build(compiler, optimisation):
    """Folder of the programs that this compiler made."""
    folder = ROOT / "build" / f"{compiler}{optimisation}"
    configure = ["cmake", "-S", ROOT, "-B", folder, "-G", "Ninja", "-D", f"CMAKE_CXX_COMPILER={compiler}",
                 "-D", "CMAKE_BUILD_TYPE=Release", "-D", f"CMAKE_CXX_FLAGS_RELEASE={optimisation} -DNDEBUG",
                 "-D", "BUILD_TESTING=OFF", "-D", "JOINTCREEP_WERROR=OFF"]
    for command in configure, ["cmake", "--build", folder, "--target", *CHAIN]:
        if subprocess.run([*map(str, command)], stdout=subprocess.DEVNULL, check=False).returncode:
            raise SystemExit(f"compilers: {compiler} {optimisation} does not build it; first: sh pipelines/setup.sh fuzz")
    return folder / "apps"


def results(campaign, programs, scene, joints):
    """The files of a scene's chain; joints of another compiler's averaging if given, so that programs are compared one by one."""
    folder = campaign.chain.new_folder()
    codes = [ended([programs / program, source, "-q", "-o", folder / name], 10 * LONGEST).code for program, source, name in zip(
        CHAIN, (scene, folder / "network.h5", joints or folder / "joints.h5"), ("network.h5", "joints.h5", "result.h5"))]
    return folder, codes


def farthest(one, other):
    """Largest difference over the largest value, of any dataset of numbers; infinite if one lacks or has another shape. How an
    equilibrium was found, and how near to balance it is, is not looked at: it may take other steps."""
    far = [0.0]

    def compare(name, item):
        if not isinstance(item, h5py.Dataset) or item.dtype.kind not in "fiu" or name.startswith(("equilibria/", "guards/")):
            return
        if name not in b or b[name].shape != item.shape:
            far.append(np.inf)
        elif item.size:
            x, y = np.asarray(item, float), np.asarray(b[name], float)
            far.append(np.abs(x - y).max() / max(np.abs(x).max(), NOTHING))

    with h5py.File(one) as a, h5py.File(other) as b:
        a.visititems(compare)
    return max(far)


def body(campaign):
    built = campaign.options.built
    others = {f"programs in {built}": built.resolve()} if built else {name: build(*of) for name, of in BUILDS.items()}
    for scene in scenes()[:campaign.n]:
        case = str(scene.relative_to(ROOT))
        first, codes = results(campaign, campaign.programs, scene, None)
        for name, programs in others.items():
            folder, its_codes = results(campaign, programs, scene, first / "joints.h5")
            outcome, what = "same bytes", ""
            for path in sorted(first.glob("*.h5")):
                if its_codes != codes or HANGS in codes or not (folder / path.name).exists():
                    outcome, what = "different", f"exit codes {its_codes}, not {codes}"
                elif path.read_bytes() != (folder / path.name).read_bytes() and outcome != "different":
                    far = farthest(path, folder / path.name)
                    what = f"{path.name}: {far:.1e}"
                    outcome = "close" if name.startswith("clang") and far <= CLOSE else "different"
            campaign.count(f"{name} beside g++ -O3", outcome, case, what)
            shutil.rmtree(folder)
        shutil.rmtree(first)


if __name__ == "__main__":
    OUTCOMES = ["same bytes", "close", "different"]
    Campaign("results by", OUTCOMES, OUTCOMES[2:], 1000,
             lambda parser: parser.add_argument("--built", type=pathlib.Path, help="folder of the other programs")).run(body)
