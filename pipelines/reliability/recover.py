"""Stops every run halfway and recovers it, and restarts every run from its last checkpoint: MOOSE's two habits.

Scenes are all those of data and of tests/pipeline, and those that the tests write: the tests of whole programs run with a
demsolve that keeps its input and options; with --only-calls they are all. N is how many, at most. Checkpoints are written every
EVERY minutes. The bytes have to be those of a run without checkpoints that was not stopped. The calls of a test are kept in
OUT/recorded/VERSION, and are not recorded again.
"""

import json
import shutil
import sys

from campaign import HANGS, LONGEST, ROOT, Campaign, ended
from kills import Job

CHECKPOINT = "kept.h5"
EVERY = "0.0005"
CALLS = "calls by tests"
# Tests of the tests, of pages, of files with other names, and those that wait for programs which they stop.
NOT_RECORDED = ("campaign", "documentation", "install", "run_", "standard_output", "studies")
LONGEST_TEST = 1200  # s
RECORDER = """#!{python}
import hashlib, json, os, pathlib, sys
words = sys.argv[1:]
outputs = [n for n, word in enumerate(words) if word in ("-o", "--output")]
inputs = [n for n, word in enumerate(words) if word.endswith(".h5") and n - 1 not in outputs and os.path.isfile(word)]
if len(outputs) == len(inputs) == 1 and words[outputs[0] + 1] != "-" and not any("checkpoint" in word for word in words):
    content = pathlib.Path(words[inputs[0]]).read_bytes()
    options = [word for n, word in enumerate(words)
               if n not in (inputs[0], outputs[0], outputs[0] + 1) and word not in ("-q", "--quiet")]
    folder = pathlib.Path({kept!r}) / hashlib.sha256(content + json.dumps(options).encode()).hexdigest()[:16]
    if not folder.exists():
        folder.mkdir()
        (folder / "joints.h5").write_bytes(content)
        (folder / "options.json").write_text(json.dumps(options))
os.execv({real!r}, [{real!r}, *words])
"""


def scenes():
    """The scenes of data and of tests, the quickest first as far as known; not those whose runs keep no checkpoints."""
    found = [*ROOT.glob("data/verification/*/scene.toml"), *ROOT.glob("data/c*/*.toml"), *ROOT.glob("tests/pipeline/**/*.toml"),
             *ROOT.glob("data/s*/s*.toml")]
    return [path for path in found if "[section]" in (text := path.read_text()) and "increments_tolerance" not in text]


def recorded(campaign):
    """Folders with the input of demsolve and its options, of each call by the tests of whole programs; a call that several tests
    make is one."""
    tests = [path for path in sorted(ROOT.glob("tests/pipeline/*_test.py")) if not path.name.startswith(NOT_RECORDED)]
    calls = {}
    for folders in campaign.side_by_side(lambda test: recorded_by(campaign, test), tests):
        calls |= {folder.name: folder for folder in folders}
    return [calls[name] for name in sorted(calls)]


def recorded_by(campaign, test):
    """The folders of the calls by one test."""
    kept = campaign.out / "recorded" / campaign.version() / test.stem
    if not kept.exists():
        programs, partial = campaign.chain.new_folder(), kept.with_name(f"{test.stem}.partial")
        shutil.rmtree(partial, ignore_errors=True)
        partial.mkdir(parents=True)
        for path in campaign.programs.iterdir():
            if path.name == "jointcreep":  # which calls the programs beside it
                shutil.copy(path, programs)
            elif path.name != "demsolve":
                (programs / path.name).symlink_to(path)
        recorder = programs / "demsolve"
        recorder.write_text(RECORDER.format(python=sys.executable, kept=str(partial), real=str(campaign.programs / "demsolve")))
        recorder.chmod(0o755)
        done = ended([sys.executable, test, programs, ROOT], LONGEST_TEST)  # what the test says is no part of this
        print(f"recover: {test.stem}: exit code {done.code}, {len(list(partial.iterdir()))} calls of demsolve", flush=True)
        partial.rename(kept)
    return sorted(kept.iterdir())


def recovered(campaign, group, name, joints, options=()):
    """Both habits on one scene, or on one call with these options; counted in the group."""
    chain, solve = campaign.chain, [campaign.programs / "demsolve", "joints.h5", "-o", "result.h5", *options]
    plain = Job(name, solve, [joints], [])
    plain.undisturbed(chain.new_folder())
    job = Job(name, [*solve, "--checkpoint", CHECKPOINT, "--checkpoint-every", EVERY], [joints], ["result.h5"], CHECKPOINT)
    folder = chain.new_folder()
    job.undisturbed(folder)
    kept, half = job.whole.get(CHECKPOINT), job.seconds / 2
    if {path: content for path, content in job.whole.items() if not job.is_checkpoint(path)} != plain.whole:
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
    has_kept = (folder / CHECKPOINT).exists()
    wrong = job.lost(folder, {}) or job.different(folder)
    campaign.count(group, "different" if wrong else "recovered" if has_kept else "from the beginning", f"{name}, stop", wrong, folder)
    shutil.rmtree(folder)


def body(campaign):
    found = [] if campaign.options.only_calls else scenes()
    for path in found[:campaign.n]:
        name = path.relative_to(ROOT)
        folder = campaign.chain.new_folder()
        network = campaign.chain.run("jointgen", path, folder / "network.h5")
        recovered(campaign, "/".join(name.parts[:2]), str(name), campaign.chain.run("strength-averaging", network, folder / "joints.h5"))
    left = campaign.n - len(found)
    calls = recorded(campaign) if left > 0 else []
    campaign.random("calls").shuffle(calls)
    list(campaign.side_by_side(lambda folder: one_call(campaign, folder), calls[:max(left, 0)]))


def one_call(campaign, kept):
    """Both habits on a recorded call."""
    name, options, folder = kept.name, json.loads((kept / "options.json").read_text()), campaign.chain.new_folder()
    solve = [campaign.programs / "demsolve", kept / "joints.h5", "-o", folder / "result.h5", *options]
    tried = ended([*solve, "--checkpoint", folder / CHECKPOINT], LONGEST)
    is_refused = tried.code == 2 or tried.code not in (0, 3, HANGS) and ended(solve, LONGEST).code == tried.code
    shutil.rmtree(folder)
    if tried.code in (0, 3):
        try:
            recovered(campaign, CALLS, name, kept / "joints.h5", options)
        except SystemExit as error:  # of the run that is not disturbed; the others go on
            campaign.count(CALLS, "different", name, str(error))
    elif tried.code == HANGS:
        campaign.count(CALLS, "too long", name)
    elif is_refused:  # as the test wants; or its options do not go with checkpoints
        campaign.count(CALLS, "refused", name, tried.err)
    else:
        campaign.count(CALLS, "different", name, str(tried))


def options(parser):
    parser.add_argument("--only-calls", action="store_true", help="scenes of files are left out")
    parser.add_argument("--jobs", type=int, default=1, help="how many calls at a time (default 1)")


if __name__ == "__main__":
    OUTCOMES = ["recovered", "from the beginning", "restarted", "no checkpoint", "ended before", "too long", "refused", "different"]
    Campaign("runs of", OUTCOMES, OUTCOMES[-1:], 5000, options).run(body)
