"""Damage to an HDF5 file of the chain: to its bytes, to what it says it is, to its datasets; and structures made to do harm.

Each kind is a function of the file's path and of random numbers, and changes the file.
"""

import re

import h5py
import numpy
from campaign import ROOT


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
    """Names of all datasets, with their kinds of numbers or text."""
    found = {}
    file.visititems(lambda name, item: found.update({name: item.dtype.kind}) if isinstance(item, h5py.Dataset) else None)
    return found


KINDS = {}  # datasets of the files that are copied, by what tells one from another: to list them takes longer than a program


def datasets_of(copy, kinds="ifS"):
    """Names of the datasets of these kinds in a copy that is undamaged yet, in order."""
    source = copy.attrs["filetype"], copy.id.get_filesize()
    if source not in KINDS:
        KINDS[source] = dict(sorted(datasets(copy).items()))
    return [name for name, kind in KINDS[source].items() if kind in kinds]


def any_dataset(copy, random, kinds="ifS"):
    return random.choice(datasets_of(copy, kinds))


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
        names = [name for name in datasets_of(file, "f") if file[name].size]
        item = file[random.choice(names)]
        values = item[()]
        values.reshape(-1)[random.randrange(values.size)] = random.choice([numpy.nan, numpy.inf, -numpy.inf])
        item[()] = values


BOUNDED = set(re.findall(r"^\| `/(\S+)` \| .* \| int32 \| 1 \| (?:index of|\d+ to \d+|0, not decreasing)",
                         (ROOT / "docs/file-format.md").read_text(), re.MULTILINE))


def out_of_range(path, random):
    """An index or a kind that no file has."""
    with changed(path) as file:
        names = [name for name in datasets_of(file) if name in BOUNDED and file[name].size]
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
