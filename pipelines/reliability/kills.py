"""Kills programs at random moments and runs them again.

After a kill no file may be there under a name of an output but the one from before, or the whole new one; and no input may
have changed. The same command then has to give the bytes of a run that was never disturbed, and leave no file besides; it goes
on from a checkpoint if there is one. Half of the kills are at any time of a run, half at a system call that writes, of those of
a run undisturbed (strace). Several kills may precede the run that ends. With fewer kills than programs only some are killed.
"""

import collections
import os
import re
import shutil
import signal
import subprocess
import time

import h5py
from campaign import LONGEST, ROOT, Campaign, contents, ended
from large_displacements_test import incline

SMALL = "data/verification/two-pillars/scene.toml"  # for what runs many times: a factor of safety, a fit
FIT = "kelvin-stiffness,joint-stiffness"
OLD = b"a file from before"
OF_A_STUDY = re.compile(r"/out/(realizations/)?(groups/|work/|study\.lock$|times\.csv$)")  # differ between runs
UNFINISHED = re.compile(r"\.partial-\w+$|\.work/|\.new$|/(checkpoint\.h5|run\.json)$")  # of programs, realizations, jointcreep run
OF_A_FILE = ["write", "pwrite64", "ftruncate", "fsync"]  # system calls that write: with the number of a file, or with its name
OF_A_NAME = ["openat", "rename", "unlink", "unlinkat", "link"]
AT_A_WRITE, AT_A_TIME = "same bytes, killed at a write", "same bytes, killed at a time"  # what came of a kill
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
TRACES = "x1_m,y1_m,x2_m,y2_m\n" + "".join(f"{x},{y},{x + 3},{y + 1 + 0.05 * x}\n" for x in range(2, 28) for y in range(x % 3, 20, 3))


class Job:
    """A command in a folder of its own, where its inputs are; and the files that it leaves undisturbed."""

    def __init__(self, name, command, inputs, outputs, checkpoint=None):
        self.name, self.command, self.inputs = name, [*map(str, command)], inputs
        self.outputs, self.checkpoint = outputs, checkpoint
        self.seconds = LONGEST  # of a run

    def fill(self, folder):
        for path in self.inputs:
            shutil.copyfile(path, folder / path.name)

    def run(self, folder, behind=()):
        begin = time.monotonic()
        done = ended([*behind, *self.command], LONGEST, cwd=folder)
        self.seconds = min(self.seconds, time.monotonic() - begin)
        return done

    def undisturbed(self, folder, log=None):
        """Runs it, and notes its files and its time; and its system calls that write, if they are to be logged."""
        self.fill(folder)
        given = contents(folder)
        done = self.run(folder, traced(log) if log else [])
        self.calls = calls(log, folder) if log else []
        self.code = done.code
        if done.code not in (0, 3):
            raise SystemExit(f"{self.name} {done}")
        self.given, self.whole = given, files(folder)

    def started(self, folder, behind=()):
        return subprocess.Popen([*behind, *self.command], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                start_new_session=True)

    def killed(self, folder, moment, alone=False):
        """Kills it after these seconds; `alone`: not its children. Says whether it still ran."""
        running = self.started(folder)
        try:
            running.wait(moment)
        except subprocess.TimeoutExpired:
            os.kill(running.pid, signal.SIGKILL) if alone else os.killpg(running.pid, signal.SIGKILL)
        return is_killed(running)

    def killed_at_a_write(self, folder, log, random, alone=False):
        """Kills it at one of the system calls that write; `alone`: one of its own, and not its children. Says whether it came
        to that, and whether what was killed wrote then: the other processes of a study make as many calls, too."""
        call, number, _ = random.choice([one for one in self.calls if one[2] or not alone])
        running = self.started(folder, traced(log, alone) + [f"--inject={call}:signal=KILL:when={number}"])
        while running.poll() is None:
            if not alone and log.exists() and b"+++ killed by SIGKILL" in log.read_bytes():
                os.killpg(running.pid, signal.SIGKILL)
                break
            time.sleep(0.001)
        return is_killed(running), any(calls(log, folder, of_the_killed=True))

    def is_checkpoint(self, name):
        """Also of those of the last factor with equilibrium and of the last one without."""
        return bool(self.checkpoint) and name in [self.checkpoint.replace(".h5", end) for end in (".h5", ".stands.h5", ".falls.h5")]

    def lost(self, folder, old):
        """What is not whole after a kill."""
        for name, content in files(folder).items():
            if name in self.given:
                if content != self.given[name]:
                    return f"{name}, an input, has changed"
            elif self.is_checkpoint(name):
                with h5py.File(folder / name) as file:
                    if file.attrs["complete"] != 1:
                        return f"{name} is not complete"
            elif UNFINISHED.search(name):
                continue
            elif name not in self.whole:
                return f"{name} is there"
            elif content not in (self.whole[name], old.get(name)):
                return f"{name} is there, and is not whole"
        missing = [name for name in (*self.given, *old) if not (folder / name).exists()]
        return f"{missing[0]} is gone" if missing else ""

    def different(self, folder):
        """What the run after it gives otherwise."""
        kept = self.checkpoint and (folder / self.checkpoint).exists()
        done = self.run(folder)
        if done.code != self.code:
            return str(done)
        if kept and done.code == 0 and "continued from" not in done.out:
            return "it did not go on from its checkpoint"
        found = files(folder)
        names = [name for name in sorted(found.keys() | self.whole.keys()) if found.get(name) != self.whole.get(name)]
        if "--checkpoint-every" in self.command:  # when they were written last is a matter of time
            names = [name for name in names if not self.is_checkpoint(name)]
        return f"not as in a run undisturbed: {', '.join(names)}" if names else ""


def can_trace():
    """Whether this machine lets programs trace others; some containers do not. Without it all kills are at a time."""
    traces = shutil.which("strace") and subprocess.run(["strace", "-o", "/dev/null", "true"], stderr=subprocess.DEVNULL, check=False).returncode == 0
    if not traces:
        print("kills: strace cannot trace programs here: all kills are at a time")
    return bool(traces)


def traced(log, alone=False):
    """What a command stands behind whose system calls are logged; `alone`: not those of its children."""
    return ["strace", *([] if alone else ["-f"]), "-y", "-s", "0", "-o", str(log),
            "-e", f"trace={','.join(OF_A_FILE + OF_A_NAME)}"]


def calls(log, folder, of_the_killed=False):
    """The system calls of a log that write in a folder: name, number among the process's calls of that name, and whether it is the
    first process. `of_the_killed`: of these only the last call of the process that was killed."""
    numbers, found, last, first = collections.Counter(), [], {}, None
    for line in log.read_text(errors="replace").splitlines():
        process, call, arguments = re.match(r"(\d*) *(?:(\w+)\((.*))?", line).groups()
        if of_the_killed and "+++ killed by SIGKILL" in line:
            return [last.get(process)]
        if call:
            first = first or process
            numbers[process, call] += 1
            last[process] = (call, numbers[process, call], process == first) if writes(call, arguments, folder) else None
            found += [last[process]] if last[process] else []
    return [] if of_the_killed else found


def writes(call, arguments, folder):
    """Whether a system call writes in a folder."""
    at, name = re.match(r'[^"<,]*<([^>]*)>', arguments), re.search(r'"([^"]*)"', arguments)
    if call == "openat" and not re.search("O_WRONLY|O_CREAT|O_TRUNC", arguments):
        return False
    path = os.path.join(at[1] if at else folder, name[1] if call in OF_A_NAME and name else "")
    return path.startswith(f"{folder}/")


def is_killed(running):
    """Waits for it and its children; whether it was killed."""
    killed = running.wait() == -signal.SIGKILL
    while killed and runs(running.pid):  # its children end with it
        time.sleep(0.01)
    return killed


def runs(group):
    """Whether a process of a group still runs."""
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True


def files(folder):
    """Bytes of every file below, by name; without the state from which a study continues, its times, and pictures, which come last."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*"))
            if path.is_file() and path.suffix != ".png" and not OF_A_STUDY.search(str(path))}


def jobs(chain, every=False):
    """Every program of the chain, in scenes that take it some tenths of a second. `every`: and what writes several times, and studies."""
    folder = chain.new_folder()
    network = chain.run("jointgen", ROOT / "tests/pipeline/benches.toml", folder / "network.h5")
    joints = chain.run("strength-averaging", network, folder / "joints.h5")
    result = chain.run("demsolve", joints, folder / "result.h5")
    small = chain.joints(chain.text(SMALL))
    slides = chain.joints(incline(30, 25, length=9, more='rigid_rocks = ["rock"]'))
    slides = slides.rename(slides.with_name("slides.h5"))
    readings = chain.run("jointexport", chain.run("demsolve", small, small.with_name("r.h5")), small.with_name("readings.csv"))
    head, *rows = readings.read_text().splitlines()
    readings.write_text("\n".join([f"{head},cap_x_sigma_m,cap_y_sigma_m", *(f"{row},1e-5,1e-5" for row in rows)]) + "\n")
    slope = folder / "slope.toml"
    shutil.copyfile(ROOT / "tests/pipeline/random_slope.toml", slope)
    programs = chain.programs
    solve = [programs / "demsolve", "joints.h5", "-o", "result.h5"]
    often = ["--checkpoint", "kept.h5", "--checkpoint-every", "0.0005"]  # minutes
    safety = ["--factor-of-safety", "--safety-width", "0.1"]
    fit = [programs / "creepfit", "joints.h5", "--measurements", "readings.csv", "--fit", FIT, "-o", "factors.csv"]
    result_only, fitted = ["result.h5"], ["factors.csv", "fitted.csv"]
    yield Job("jointgen", [programs / "jointgen", "slope.toml", "-o", "out.h5"], [slope], ["out.h5"])
    yield Job("strength-averaging", [programs / "strength-averaging", "network.h5", "-o", "out.h5"], [network], ["out.h5"])
    yield Job("demsolve", solve, [joints], result_only)
    yield Job("demsolve --checkpoint", [*solve, "--checkpoint", "kept.h5"], [joints], result_only, "kept.h5")
    yield Job("demsolve --factor-of-safety", [*solve, *safety], [small], result_only)
    yield Job("creepfit", [*fit, "--readings", "fitted.csv"], [small, readings], fitted)
    yield Job("jointexport", [programs / "jointexport", "result.h5", "-o", "zones.vtu"], [result], ["zones.vtu"])
    if not every:
        return
    yield Job("demsolve, relaxation, checkpoints", [*solve, *often, "--engine", "relaxation", "--zone-size", "8"], [joints],
              result_only, "kept.h5")
    yield Job("demsolve, large displacements, checkpoints", [programs / "demsolve", "slides.h5", "-o", "result.h5", *often],
              [slides], result_only, "kept.h5")
    yield Job("demsolve, factor of safety, checkpoints", [*solve, *safety, *often], [small], result_only, "kept.h5")
    yield Job("creepfit --ensemble", [*fit, "--ensemble", "10"], [small, readings], fitted[:1])
    yield Job("creepfit --profile-intervals", [*fit, "--profile-intervals"], [small, readings], fitted[:1])
    (folder / "study.toml").write_text(STUDY)
    yield Job("jointcreep study", [programs / "jointcreep", "study", "study.toml", "-o", "out", "--quiet"],
              [slope, folder / "study.toml"], [])
    run = [programs / "jointcreep", "run", "slope.toml", "-o", "out", "--quiet", "--", "--no-creep", "--zone-size", "8"]
    yield Job("jointcreep run", run, [slope], [])
    yield Job("jointcreep report", [programs / "jointcreep", "report", "result.h5", "-o", "report.html"], [result], ["report.html"])
    (folder / "traces.csv").write_text(TRACES)
    yield Job("jointcreep fit", [programs / "jointcreep", "fit", "traces.csv", "-o", "sets.toml", "--window", "0,0,30,20", "--quiet"],
              [folder / "traces.csv"], ["sets.toml"])
    make = ["sh", "-c", 'exec make OUT="$PWD/out" "$@"', "make", "-s", "-C", ROOT / "pipelines/slope", "realizations", "N=3",
            f"BIN={programs}", f"SCENE={slope}", "SOLVE=--no-creep --zone-size 8"]
    yield Job("make realizations", make, [], [])


def trial(campaign, job, case):
    """Kills once at least; counts each kill, and what came of it."""
    random, folder = campaign.random(job.name, case), campaign.chain.new_folder()
    job.fill(folder)
    old = {name: OLD for name in job.outputs} if random.random() < 0.5 else {}
    for name, content in old.items():
        (folder / name).write_bytes(content)
    kills, wrong, has_children = [], "", "jointcreep" in job.name
    while not wrong and (not kills or random.random() < 0.3):
        alone = has_children and random.random() < 0.5
        if random.random() < 0.5 and job.calls:
            hit, writing = job.killed_at_a_write(folder, campaign.chain.new_folder() / "log", random, alone)
        else:
            hit, writing = job.killed(folder, random.uniform(0, job.seconds), alone), False
        if not hit:
            campaign.count(job.name, "ended before", case)
            break
        kills.append(AT_A_WRITE if writing else AT_A_TIME)
        wrong = job.lost(folder, old)
    if wrong:
        campaign.count(job.name, "lost", case, f"{wrong}; killed {kills[-1]}", folder)
    else:
        wrong = job.different(folder)
        if wrong:
            campaign.count(job.name, "different", case, f"{wrong}; killed {', '.join(kills)}", folder)
    for kill in kills[:-1] if wrong else kills:
        campaign.count(job.name, kill, case)
    shutil.rmtree(folder)
    return len(kills)


def body(campaign):
    every = list(jobs(campaign.chain, every=True))
    few, traces = campaign.n < len(every), can_trace()
    for job in campaign.random("programs").sample(every[:-1], campaign.n) if few else every:  # strace slows studies down
        is_traced = traces and not (few and "study" in job.name)
        job.undisturbed(campaign.chain.new_folder(), campaign.chain.new_folder() / "log" if is_traced else None)
        kills = case = 0
        while kills < campaign.n / len(every):
            kills += trial(campaign, job, case)
            case += 1


if __name__ == "__main__":
    OUTCOMES = [AT_A_WRITE, AT_A_TIME, "ended before", "lost", "different"]
    Campaign("kills of", OUTCOMES, OUTCOMES[3:], 1000).run(body)
