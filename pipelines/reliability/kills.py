"""Kills programs at random moments and runs them again.

After a kill no file may be there under a name of an output but the one from before, or the whole new one; and no input may
have changed. The same command then has to give the bytes of a run that was never disturbed, and leave no file besides. Half of
the moments are any in a run's time, half are while a file is written. Several kills may precede the run that ends.
"""

import os
import re
import shutil
import signal
import subprocess
import time

import h5py
from campaign import LONGEST, ROOT, Campaign, contents, ended

SMALL = "data/verification/two-pillars/scene.toml"  # for what runs many times: a factor of safety, a fit
FIT = "kelvin-stiffness,joint-stiffness"
OLD = b"a file from before"
OF_A_STUDY = re.compile(r"/out/(groups/|work/|Makefile$|study\.lock$|times\.csv$)")  # differ between runs
STUDY = """
scene = "slope.toml"
histories = true
keep = ["result.h5"]
demsolve_options = ["--no-creep", "--zone-size", "8"]
[[vary]]
network = true
[design]
runs = 3
[[collect]]
what = "failed"
"""


class Job:
    """A command in a folder of its own, where its inputs are; and the files that it leaves undisturbed."""

    def __init__(self, name, command, inputs, outputs, checkpoint=None):
        self.name, self.command, self.inputs = name, [*map(str, command)], inputs
        self.outputs, self.checkpoint = outputs, checkpoint
        self.seconds = LONGEST  # of a run

    def fill(self, folder):
        for path in self.inputs:
            shutil.copyfile(path, folder / path.name)

    def run(self, folder):
        begin = time.monotonic()
        done = ended(self.command, LONGEST, cwd=folder)
        self.seconds = min(self.seconds, time.monotonic() - begin)
        return done

    def undisturbed(self, folder):
        """Runs it, and notes its files and its time."""
        self.fill(folder)
        given = contents(folder)
        done = self.run(folder)
        self.code = done.code
        if done.code not in (0, 3):
            raise SystemExit(f"{self.name} {done}")
        self.given, self.whole = given, files(folder)

    def killed(self, folder, moment, while_writing=False, alone=False):
        """Kills it after these seconds, or so long after it began to write a file; `alone`: not its children. Says whether
        it still ran."""
        running = subprocess.Popen(self.command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                   start_new_session=True)
        while while_writing and running.poll() is None and not writes(folder):
            pass
        try:
            running.wait(moment)
        except subprocess.TimeoutExpired:
            os.kill(running.pid, signal.SIGKILL) if alone else os.killpg(running.pid, signal.SIGKILL)
        is_killed = running.wait() == -signal.SIGKILL
        while is_killed and runs(running.pid):  # its children end with it
            time.sleep(0.01)
        return is_killed

    def lost(self, folder, old):
        """What is not whole after a kill."""
        for name, content in files(folder).items():
            if name in self.given:
                if content != self.given[name]:
                    return f"{name}, an input, has changed"
            elif name == self.checkpoint:
                with h5py.File(folder / name) as file:
                    if file.attrs["complete"] != 1:
                        return f"{name} is not complete"
            elif name in self.whole:
                if content not in (self.whole[name], old.get(name)):
                    return f"{name} is there, and is not whole"
            elif not re.search(r"\.partial-\w+$|\.work/|\.new$", name):  # of programs, of realizations
                return f"{name} is there"
        missing = [name for name in (*self.given, *old) if not (folder / name).exists()]
        return f"{missing[0]} is gone" if missing else ""

    def different(self, folder):
        """What the run after it gives otherwise."""
        done = self.run(folder)
        if done.code != self.code:
            return str(done)
        found = files(folder)
        names = [name for name in sorted(found.keys() | self.whole.keys()) if found.get(name) != self.whole.get(name)]
        return f"not as in a run undisturbed: {', '.join(names)}" if names else ""


def writes(folder):
    """Whether a program writes a file there."""
    try:
        return any(folder.rglob("*.partial-*"))
    except FileNotFoundError:  # a folder below is gone already
        return False


def runs(group):
    """Whether a process of a group still runs."""
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True


def files(folder):
    """Bytes of every file below, by name; not what a study goes on from, nor its times, nor pictures, which come last."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*"))
            if path.is_file() and path.suffix != ".png" and not OF_A_STUDY.search(str(path))}


def jobs(chain):
    """Every program of the chain, and a study, in scenes that take it some tenths of a second."""
    folder = chain.new_folder()
    network = chain.run("jointgen", ROOT / "tests/pipeline/benches.toml", folder / "network.h5")
    joints = chain.run("strength-averaging", network, folder / "joints.h5")
    result = chain.run("demsolve", joints, folder / "result.h5")
    small = chain.joints(chain.text(SMALL))
    readings = chain.run("jointexport", chain.run("demsolve", small, small.with_name("r.h5")), small.with_name("readings.csv"))
    slope = folder / "slope.toml"
    shutil.copyfile(ROOT / "tests/pipeline/random_slope.toml", slope)
    programs = chain.programs
    solve = [programs / "demsolve", "joints.h5", "-o", "result.h5"]
    yield Job("jointgen", [programs / "jointgen", "slope.toml", "-o", "out.h5"], [slope], ["out.h5"])
    yield Job("strength-averaging", [programs / "strength-averaging", "network.h5", "-o", "out.h5"], [network], ["out.h5"])
    yield Job("demsolve", solve, [joints], ["result.h5"])
    yield Job("demsolve --checkpoint", [*solve, "--checkpoint", "kept.h5"], [joints], ["result.h5"], "kept.h5")
    yield Job("demsolve --factor-of-safety", [*solve, "--factor-of-safety", "--safety-width", "0.1"], [small], ["result.h5"])
    yield Job("creepfit", [programs / "creepfit", "joints.h5", "--measurements", "readings.csv", "--fit", FIT, "-o",
                           "factors.csv", "--readings", "fitted.csv"], [small, readings], ["factors.csv", "fitted.csv"])
    yield Job("jointexport", [programs / "jointexport", "result.h5", "-o", "zones.vtu"], [result], ["zones.vtu"])
    (folder / "study.toml").write_text(STUDY)
    yield Job("jointcreep study", [programs / "jointcreep", "study", "study.toml", "-o", "out", "--quiet"], [slope, folder / "study.toml"], [])


def trial(campaign, job, case):
    """Kills once at least; counts each kill, and what came of it."""
    random, folder = campaign.random(job.name, case), campaign.chain.new_folder()
    job.fill(folder)
    old = {name: OLD for name in job.outputs} if random.random() < 0.5 else {}
    for name, content in old.items():
        (folder / name).write_bytes(content)
    hit, wrong = 0, ""
    while not wrong and (hit == 0 or random.random() < 0.3):
        writing = random.random() < 0.5
        moment = random.uniform(0, 0.002) if writing else random.uniform(0, job.seconds)
        if job.killed(folder, moment, writing, "study" in job.name and random.random() < 0.5):
            hit += 1
            wrong = job.lost(folder, old)
            if wrong:
                campaign.count(job.name, "lost", case, wrong, folder)
            elif hit > 1:
                campaign.count(job.name, "same bytes", case, "killed again")
        else:
            campaign.count(job.name, "ended before", case)
            break
    if not wrong:
        wrong = job.different(folder)
        if hit or wrong:
            campaign.count(job.name, "different" if wrong else "same bytes", case, wrong, folder)
    shutil.rmtree(folder)
    return hit


def body(campaign):
    every = list(jobs(campaign.chain))
    for job in every:
        job.undisturbed(campaign.chain.new_folder())
        kills = case = 0
        while kills < campaign.n / len(every):
            kills += trial(campaign, job, case)
            case += 1


if __name__ == "__main__":
    OUTCOMES = ["same bytes", "ended before", "lost", "different"]
    Campaign("kills of", OUTCOMES, OUTCOMES[2:], 1000).run(body)
