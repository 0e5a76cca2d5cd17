"""Sweeps the address space of each program (ulimit -v) in N steps, from the least with which --version runs to enough.

A run gives the bytes of the run without a limit, or ends with code 5, `PROGRAM: out of memory`, and no file. The last
limit is enough, the first is too little. The limit of a study holds for jointcreep and for each program that it starts; it ends with
code 4 or 5 and the same message, and the same command continues it with enough memory.
"""

import resource
import shutil

from campaign import LONGEST, Campaign, contents, ended, scenes
from kills import FIT, files, jobs

MB = 2**20
SCENES = ["tests/pipeline/kinds/scene.toml", "data/column/scene.toml", "data/verification/toppling-columns/scene.toml",
          "data/verification/vertical-cut/scene.toml", "tests/pipeline/random_slope.toml"]
FEW = 10  # limits; with fewer only the first scene is used
SAFETY = "data/verification/toppling-columns/scene.toml"
ENOUGH = 1000 * MB  # for a study
MARGIN = 3 * MB  # from one start of Python to the next the least varies by some 1.5 MB; below, Python fails before the launcher runs


def limited(command, size, **options):
    """Runs a command that has so much address space [bytes]."""
    return ended(command, LONGEST, lambda: resource.setrlimit(resource.RLIMIT_AS, (size, size)), **options)


def least(command, low, high, step):
    """The least size with which it succeeds, to `step`, if all larger ones do."""
    while high - low > step:
        middle = (low + high) // 2
        low, high = (low, middle) if limited(command, middle).code == 0 else (middle, high)
    return high


def sweep(campaign, subject, program, source, name, *options):
    folder = campaign.chain.new_folder()
    wanted = contents(campaign.chain.run(program, source, campaign.chain.new_folder() / name, *options).parent)
    command = [campaign.programs / program, source, "-o", folder / name, *options]
    low = least([campaign.programs / program, "--version"], 0, 2000 * MB, MB // 8)
    high = least(command, low, 4000 * MB, MB)
    for path in folder.iterdir():
        path.unlink()
    for step in range(campaign.n):
        size = low + (high + 2 * MB - low) * step // max(1, campaign.n - 1)
        done, left = limited(command, size), contents(folder)
        if done.code == 0 and left == wanted:
            outcome = "same bytes"
        elif done.code == 5 and not left and done.err.strip() == f"{program}: out of memory":
            outcome = "code 5"
        else:
            outcome = "other"
        if campaign.n > 1 and outcome == {0: "same bytes", campaign.n - 1: "code 5"}.get(step):
            outcome = "other"
        campaign.count(subject, outcome, f"{program} {' '.join(map(str, options))} {size // 1024} kB", f"{done}; {[*left]}")
        for path in folder.iterdir():
            path.unlink()
    shutil.rmtree(folder)


def study(campaign, job):
    """Sweeps a study. One that ends for lack of memory has to continue with enough."""
    job.undisturbed(campaign.chain.new_folder())
    low = least(["/usr/bin/python3", "-c", ""], 0, ENOUGH, MB) + MARGIN
    for step in range(campaign.n):
        size, folder = low + (ENOUGH - low) * step // max(1, campaign.n - 1), campaign.chain.new_folder()
        job.fill(folder)
        done = limited(job.command, size, cwd=folder)
        if done.code == 0 and files(folder) == job.whole:
            outcome = "same bytes"
        elif done.code in (4, 5) and "out of memory" in done.err and not job.different(folder):
            outcome = "continued"
        else:
            outcome = "other"
        campaign.count(job.name, outcome, f"{size // 1024} kB", str(done))
        shutil.rmtree(folder)


def body(campaign):
    for subject, path, joints in scenes(campaign.chain, *SCENES[:None if campaign.n >= FEW else 1]):
        sweep(campaign, subject, "jointgen", path, "network.h5")
        sweep(campaign, subject, "strength-averaging", joints.with_name("network.h5"), "joints.h5")
        sweep(campaign, subject, "demsolve", joints, "result.h5", "--tolerance", 1e-4)
        result = campaign.chain.run("demsolve", joints, joints.with_name("result.h5"), "--tolerance", 1e-4)
        sweep(campaign, subject, "jointexport", result, "zones.vtu")
    for job in jobs(campaign.chain, every=True):
        if job.name == "creepfit":
            small, readings = job.inputs
            sweep(campaign, "creepfit", "creepfit", small, "factors.csv", "--measurements", readings, "--fit", FIT)
        elif job.name == "jointcreep study":
            study(campaign, job)
    for _, _, joints in scenes(campaign.chain, SAFETY):
        sweep(campaign, "demsolve --factor-of-safety", "demsolve", joints, "result.h5", "--factor-of-safety", "--safety-width", 0.1)


if __name__ == "__main__":
    OUTCOMES = ["same bytes", "code 5", "continued", "other"]
    Campaign("memory of programs in", OUTCOMES, OUTCOMES[3:], 100).run(body)
