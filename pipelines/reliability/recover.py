"""Stops every run halfway and recovers it, and restarts every run from its last checkpoint: MOOSE's two habits.

Scenes are all those of data and of tests/pipeline; N is how many of them, at most. The bytes have to be those of a run without
checkpoints that was not stopped.
"""

import shutil

from campaign import ROOT, Campaign
from kills import Job

CHECKPOINT = "kept.h5"


def scenes():
    """The scenes of data and of tests, the quickest first as far as known; not those whose runs keep no checkpoints."""
    found = [*ROOT.glob("data/verification/*/scene.toml"), *ROOT.glob("data/c*/*.toml"), *ROOT.glob("tests/pipeline/**/*.toml"),
             *ROOT.glob("data/s*/s*.toml")]
    return [path for path in found if "[section]" in (text := path.read_text()) and "increments_tolerance" not in text]


def recovered(campaign, name, joints):
    """Both habits on one scene."""
    group = "/".join(name.split("/")[:2])
    chain, solve = campaign.chain, [campaign.programs / "demsolve", "joints.h5", "-o", "result.h5"]
    plain = Job(name, solve, [joints], [])
    plain.undisturbed(chain.new_folder())
    job = Job(name, [*solve, "--checkpoint", CHECKPOINT], [joints], ["result.h5"], CHECKPOINT)
    folder = chain.new_folder()
    job.undisturbed(folder)
    kept, half = job.whole.get(CHECKPOINT), job.seconds / 2
    if {**job.whole, CHECKPOINT: kept} != {**plain.whole, CHECKPOINT: kept}:
        campaign.count(group, "different", f"{name}, with checkpoints", "not as without", folder)
    restarted = job.different(folder)
    outcome = "different" if restarted else "restarted" if kept else "no checkpoint"
    campaign.count(group, outcome, f"{name}, restart", restarted, folder)
    shutil.rmtree(folder)

    folder = chain.new_folder()
    job.fill(folder)
    if not job.killed(folder, half):
        campaign.count(group, "ended before", f"{name}, stop")
        return
    wrong = job.lost(folder, {}) or job.different(folder)
    campaign.count(group, "different" if wrong else "recovered", f"{name}, stop", wrong, folder)
    shutil.rmtree(folder)


def body(campaign):
    for path in scenes()[:campaign.n]:
        name = str(path.relative_to(ROOT))
        folder = campaign.chain.new_folder()
        network = campaign.chain.run("jointgen", path, folder / "network.h5")
        recovered(campaign, name, campaign.chain.run("strength-averaging", network, folder / "joints.h5"))


if __name__ == "__main__":
    OUTCOMES = ["recovered", "restarted", "no checkpoint", "ended before", "different"]
    Campaign("runs of", OUTCOMES, OUTCOMES[4:], 1000).run(body)
