"""Gives each program damaged copies of a file that it reads.

Copies are truncated, have flipped bits or zeroed bytes, lack a dataset, or say another type or version; their datasets have
another size, type or rank, numbers that are not finite, indices out of range, other numbers, other units; or they have a
structure made to do harm: links in circles, links to other files, groups in place of datasets, huge sizes, foreign filters. Each run has
to answer as for the file undamaged, or refuse with code 2 or 4, a message that names the copy, and no output. A copy with other
numbers is another file, which need not be that of any section: what it gives may differ, no equilibrium (code 3) is an answer,
and so is an internal error (code 5), which is counted apart.
"""

import multiprocessing
import os
import pathlib
import shutil
import signal
import tempfile

import h5py
import numpy
from campaign import HANGS, MEMORY, ROOT, Campaign, chance, contents, ended
from damage import DAMAGE, MUST_BE_REFUSED, datasets, other_values

LONGEST = 20  # s; undamaged, each run takes less than half a second
DIGEST = "provenance/input_sha256"  # the last row differs with any bit of the input
REFUSED = (2, 4)
FAULTS = ["signal", "hang", "wrong", "files left", "not named", "other code"]


def content(path):
    """Every dataset and root attribute of an HDF5 file; all bytes of another."""
    if path.suffix != ".h5":
        return {"bytes": path.read_bytes()}
    with h5py.File(path) as file:
        values = {name: file[name][()] for name in datasets(file)}
        values |= {"attribute " + name: numpy.asarray(value) for name, value in file.attrs.items()}
    if DIGEST in values:
        values[DIGEST] = values[DIGEST][:-1]
    return {name: (str(value.dtype), value.shape, value.tobytes()) for name, value in values.items()}


class Reader:
    """A program that reads a file, and what it makes of it undamaged."""

    def __init__(self, name, command, source, output):
        self.name, self.command, self.source, self.output = name, [*map(str, command)], source, output

    def run(self, copy, folder):
        return ended([str(copy) if word == "FILE" else word for word in self.command], LONGEST, cwd=folder)

    def verdict(self, random, keep):
        """The kind of damage, what came of it, and what was wrong with that. A copy that led astray is kept under a name."""
        damage = random.choice(DAMAGE)
        with tempfile.TemporaryDirectory(prefix="damaged-", dir=MEMORY) as name:
            folder = pathlib.Path(name)
            copy = folder / "copy.h5"
            shutil.copyfile(self.source, copy)
            damage(copy, random)
            out = folder / "out"
            out.mkdir()
            outcome, wrong = self.answer(damage, self.run(copy, out), out)
            if outcome in FAULTS:
                keep.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(copy, keep)
            return damage.__name__, outcome, wrong

    def answer(self, damage, done, out):
        left = [*contents(out)]
        if done.code == HANGS:
            return "hang", str(done)
        if done.code == 3 and damage is other_values:
            return "other output", ""
        if done.code in REFUSED or done.code == 5 and damage is other_values:
            if left:
                return "files left", ", ".join(left)
            if damage is other_values:
                return ("internal error" if done.code == 5 else "refused"), str(done)
            return ("refused", "") if "copy.h5" in done.err else ("not named", str(done))
        if done.code < 0:
            return "signal", str(done)
        if done.code != 0:
            return "other code", str(done)
        if damage is other_values:
            return "other output", ""
        if damage in MUST_BE_REFUSED:
            return "wrong", "it should have been refused"
        if left != ([self.output] if self.output else []):
            return "wrong", f"files: {', '.join(left)}"
        try:
            found = content(out / self.output) if self.output else {}
        except (OSError, RuntimeError, KeyError) as error:  # what h5py throws at damage
            return "wrong", f"the output cannot be read: {error}"
        differing = [name for name in sorted(found.keys() | self.wanted.keys()) if found.get(name) != self.wanted.get(name)]
        return ("wrong", f"other output: {', '.join(differing)}") if differing else ("same output", "")


def readers(chain):
    """Each program, and the file that it reads, of a small scene."""
    folder = chain.new_folder()
    network = chain.run("jointgen", ROOT / "pipelines/reliability/small.toml", folder / "network.h5")
    joints = chain.run("strength-averaging", network, folder / "joints.h5")
    kept = folder / "kept.h5"
    result = chain.run("demsolve", joints, folder / "result.h5", "--checkpoint", kept)
    histories = chain.run("jointexport", result, folder / "histories.csv")
    programs = chain.programs
    yield Reader("strength-averaging", [programs / "strength-averaging", "FILE", "-o", "out.h5"], network, "out.h5")
    yield Reader("demsolve", [programs / "demsolve", "FILE", "-o", "out.h5", "--no-creep"], joints, "out.h5")
    yield Reader("demsolve --checkpoint", [programs / "demsolve", joints, "--checkpoint", "FILE", "-o", "out.h5"], kept, "out.h5")
    yield Reader("creepfit", [programs / "creepfit", "FILE", "--measurements", histories, "--fit", "joint-stiffness", "-o",
                              "out.csv", "-q"], joints, "out.csv")
    for what in "zones", "contacts":
        yield Reader(f"jointexport --what {what}", [programs / "jointexport", "FILE", "-o", "out.vtu", "--what", what], result,
                     "out.vtu")
    yield Reader("jointexport, histories", [programs / "jointexport", "FILE", "-o", "out.csv"], result, "out.csv")


def as_by_default():
    """What ends a campaign ends its processes."""
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def judged(batch):
    reader, campaign, out, numbers = batch
    return [(number, reader.name, *reader.verdict(chance(*campaign, number), out / f"{number}.h5")) for number in numbers]


def body(campaign):
    every = list(readers(campaign.chain))
    for reader in every:
        folder = campaign.chain.new_folder()
        done = reader.run(reader.source, folder)
        if done.code:
            raise SystemExit(f"{reader.name}: the undamaged file is refused: {done}")
        reader.wanted = content(folder / reader.output)
    size = 50 * len(every)
    faults = campaign.out / "faults" / "damaged"
    batches = ((reader, (campaign.name, campaign.seed), faults, range(first + i, min(first + size, campaign.n), len(every)))
               for first in range(0, campaign.n, size) for i, reader in enumerate(every))
    with multiprocessing.Pool(len(os.sched_getaffinity(0)), as_by_default) as pool:
        for answers in pool.imap(judged, batches):
            for number, name, damage, outcome, what in answers:
                campaign.count(name, outcome, number, f"{damage}: {what}" if what else damage)


if __name__ == "__main__":
    Campaign("damaged files to", ["refused", "same output", "other output", "internal error", *FAULTS], FAULTS, 100000).run(body)
