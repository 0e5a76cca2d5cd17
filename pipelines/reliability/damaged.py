"""Gives each program damaged copies of a file that it reads.

Copies are truncated, have flipped bits or zeroed bytes, lack a dataset, or say another type or version; their datasets have
another size, type or rank, numbers that are not finite, indices out of range, other numbers, other units; or they have a structure
made to do harm: links in circles, links to other files, groups in place of datasets, huge sizes, foreign filters. Each run has
to answer as for the file undamaged, or refuse with code 2 or 4, a message that names the copy, and no output. A copy with other
numbers is another file, which need not be that of any section: what it gives may differ, no equilibrium (code 3) is an answer,
and so is an internal error (code 5), which is counted apart.
"""

import multiprocessing
import pathlib
import re
import shutil
import tempfile

import h5py
import numpy
from campaign import HANGS, MEMORY, ROOT, Campaign, chance, contents, ended

LONGEST = 20  # s; undamaged, each run takes less than half a second
DIGEST = "provenance/input_sha256"  # the last row differs with any bit of the input
REFUSED = (2, 4)
FAULTS = ["signal", "hang", "wrong", "files left", "not named", "other code"]


def changed(path):
    return h5py.File(path, "r+", libver=("v110", "v110"))


# --- Damage to bytes, and to what a file says it is -----------------------------------------------------------------


def truncated(path, random):
    content = path.read_bytes()
    path.write_bytes(content[: random.randrange(len(content))])


def flipped(path, random):
    content = bytearray(path.read_bytes())
    for _ in range(random.randrange(1, 5)):
        content[random.randrange(len(content))] ^= 1 << random.randrange(8)
    path.write_bytes(content)


def zeroed(path, random):
    content = bytearray(path.read_bytes())
    start = random.randrange(max(1, len(content) - 63))
    content[start : start + 64] = bytes(len(content[start : start + 64]))
    path.write_bytes(content)


def other_type(path, random):
    with changed(path) as file:
        text = random.choice(["jointcreep movie", "statepoint", "", "Jointcreep Network"])
        file.attrs.create("filetype", text, dtype=h5py.string_dtype("utf-8", max(1, len(text))))


def other_version(path, random):
    with changed(path) as file:
        version = file.attrs["format_version"]
        file.attrs.modify("format_version", [version[0] + random.choice([-version[0], -1, 1, 1000]), 0])


def incomplete(path, random):
    with changed(path) as file:
        if random.random() < 0.5:
            del file.attrs["complete"]
        else:
            file.attrs.modify("complete", 0)


# --- Damage to datasets ---------------------------------------------------------------------------------------------


def datasets(file):
    names = []
    file.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
    return names


def any_dataset(file, random, kinds="ifS"):
    return random.choice([name for name in sorted(datasets(file)) if file[name].dtype.kind in kinds])


def replaced(file, name, values, units=True, **options):
    """Another dataset of that name, with the same attributes."""
    attributes = dict(file[name].attrs) if units else {}
    del file[name]
    item = file.create_dataset(name, data=values, **options)
    for key, value in attributes.items():
        item.attrs[key] = value
    return item


def without_dataset(path, random):
    with changed(path) as file:
        del file[any_dataset(file, random)]


def other_size(path, random):
    with changed(path) as file:
        name = any_dataset(file, random)
        values = file[name][()]
        keep = random.choice([values[:0], values[:-1], values[: len(values) // 2], numpy.concatenate([values, values[:1]])])
        replaced(file, name, keep)


def other_number_type(path, random):
    with changed(path) as file:
        name = any_dataset(file, random, "if")
        with numpy.errstate(all="ignore"):
            values = file[name][()].astype(random.choice(["i1", "u4", "i8", ">i4", "f2", "f4", "S8", ">f8"]))
        replaced(file, name, values)


def other_rank(path, random):
    with changed(path) as file:
        name = any_dataset(file, random)
        values = file[name][()]
        replaced(file, name, random.choice([values.reshape(-1), values[..., None], values[None], values.reshape(-1)[:1]]))


def not_finite(path, random):
    with changed(path) as file:
        names = [name for name in sorted(datasets(file)) if file[name].dtype.kind == "f" and file[name].size]
        item = file[random.choice(names)]
        values = item[()]
        values.reshape(-1)[random.randrange(values.size)] = random.choice([numpy.nan, numpy.inf, -numpy.inf])
        item[()] = values


BOUNDED = set(re.findall(r"^\| `/(\S+)` \| .* \| int32 \| 1 \| (?:index of|\d+ to \d+|0, not decreasing)",
                         (ROOT / "docs/file-format.md").read_text(), re.MULTILINE))


def out_of_range(path, random):
    """An index or a kind that no file has."""
    with changed(path) as file:
        names = [name for name in sorted(datasets(file)) if name in BOUNDED and file[name].size]
        item = file[random.choice(names)]
        values = item[()]
        values.reshape(-1)[random.randrange(values.size)] = random.choice([-(2**31), -2, 2**31 - 1, 10**7])
        item[()] = values


def other_values(path, random):
    """Numbers that a file may have, but not this one."""
    with changed(path) as file:
        item = file[any_dataset(file, random, "if")]
        values = item[()]
        if values.size:
            flat = values.reshape(-1)
            kind = random.randrange(4)
            if kind == 0:
                flat[:] = 0
            elif kind == 1:
                flat[:] = flat[::-1].copy()
            elif kind == 2:
                flat[random.randrange(flat.size)] = flat[random.randrange(flat.size)]
            else:
                flat[random.randrange(flat.size)] *= random.choice([-1, 2, 1e3, 1e-9] if values.dtype.kind == "f" else [-1, 2])
            item[()] = values


def other_units(path, random):
    with changed(path) as file:
        item = file[any_dataset(file, random)]
        if random.random() < 0.5:
            del item.attrs["units"]
        else:
            item.attrs["units"] = random.choice([numpy.bytes_(b"ft"), 3, "Pa/m2", numpy.zeros(3), ""])


# --- Structures made to do harm -------------------------------------------------------------------------------------


def links_in_a_circle(path, random):
    with changed(path) as file:
        name = any_dataset(file, random)
        del file[name]
        other = name + " again"
        file[name], file[other] = h5py.SoftLink("/" + other), h5py.SoftLink("/" + name)


def linked_elsewhere(path, random):
    with changed(path) as file:
        name = any_dataset(file, random)
        del file[name]
        file[name] = h5py.ExternalLink(random.choice(["nowhere.h5", path.name, "/dev/zero"]), "/" + name)


def group_in_place(path, random):
    with changed(path) as file:
        name = any_dataset(file, random)
        del file[name]
        if random.random() < 0.5:
            file.create_group(name)
        else:
            file[name] = file[name.rsplit("/", 1)[0]] if "/" in name else file["/"]  # a circle of groups


def dataset_in_place_of_a_group(path, random):
    with changed(path) as file:
        name = random.choice(sorted(file.keys()))
        del file[name]
        file[name] = numpy.zeros(3)


def huge(path, random):
    """Sizes that no memory has, with nothing stored."""
    with changed(path) as file:
        name = any_dataset(file, random)
        item, rows = file[name], random.choice([2**31, 2**40, 2**62])
        kind, shape = item.dtype, (rows, *item.shape[1:])
        attributes = dict(item.attrs)
        del file[name]
        try:
            item = file.create_dataset(name, shape, kind, chunks=tuple(min(1024, size) or 1 for size in shape))
        except (ValueError, OSError):
            return  # beyond what HDF5 writes
        for key, value in attributes.items():
            item.attrs[key] = value


def foreign_type(path, random):
    with changed(path) as file:
        name = any_dataset(file, random)
        size = max(1, file[name].size)
        values = random.choice([numpy.zeros(size, [("a", "f8"), ("b", "i4")]), numpy.zeros(size, "V8"),
                                numpy.zeros(size, complex), numpy.zeros(size, "(3,)f8"), numpy.zeros(size, bool)])
        replaced(file, name, values)


def text_of_any_length(path, random):
    with changed(path) as file:
        name = any_dataset(file, random)
        replaced(file, name, ["x" * random.randrange(100)] * max(1, len(file[name])), dtype=h5py.string_dtype())


def foreign_filter(path, random):
    with changed(path) as file:
        name = any_dataset(file, random)
        values = file[name][()]
        if values.size:
            filters = [{"compression": "lzf"}, {"shuffle": True}] + [{"scaleoffset": 0}] * (values.dtype.kind == "i")
            replaced(file, name, values, chunks=values.shape, **random.choice(filters))


def stored_elsewhere(path, random):
    with changed(path) as file:
        name = any_dataset(file, random, "if")
        values = file[name][()]
        elsewhere = [(random.choice(["/dev/zero", "nowhere.bin"]), 0, max(1, values.nbytes))]
        attributes = dict(file[name].attrs)
        del file[name]
        item = file.create_dataset(name, values.shape, values.dtype, external=elsewhere)
        for key, value in attributes.items():
            item.attrs[key] = value


# Half of the damage is to bytes; only that may go unnoticed, where no program looks or nothing changes.
BYTES = [truncated, flipped, flipped, flipped, zeroed, zeroed]
SAYING = [other_type, other_version, incomplete]
DATASETS = [without_dataset, other_size, other_number_type, other_rank, not_finite, out_of_range, other_values, other_values,
            other_units]
HOSTILE = [links_in_a_circle, linked_elsewhere, group_in_place, dataset_in_place_of_a_group, huge, foreign_type,
           text_of_any_length, foreign_filter, stored_elsewhere]
MUST_BE_REFUSED = SAYING
DAMAGE = [one for pair in zip((BYTES * 4)[: len(SAYING + DATASETS + HOSTILE)], SAYING + DATASETS + HOSTILE) for one in pair]


# --- The campaign ---------------------------------------------------------------------------------------------------


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
    with multiprocessing.Pool(2) as pool:
        for answers in pool.imap(judged, batches):
            for number, name, damage, outcome, what in answers:
                campaign.count(name, outcome, number, f"{damage}: {what}" if what else damage)


if __name__ == "__main__":
    Campaign("damaged files to", ["refused", "same output", "other output", "internal error", *FAULTS], FAULTS, 100000).run(body)
