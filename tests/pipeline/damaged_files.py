#!/usr/bin/python3
"""Gives a program damaged copies of a file it reads, and checks that it is never fooled.

    /usr/bin/python3 damaged_files.py PROGRAM FILE.h5 [N] [ARGS...]

runs `PROGRAM COPY.h5 -o OUT ARGS` on N (300) copies, each truncated, with flipped bits or zeroed bytes, with
another type, version or completeness, or without one of its datasets; always the same N copies. Each run must
either answer as for the undamaged file, or refuse with exit code 2 or 4, a message that names the copy, and no
output. Exit code 1 if a run did anything else.
"""

import collections
import concurrent.futures
import pathlib
import shutil
import subprocess
import sys
import tempfile

import h5py
import numpy

LONGEST_RUN = 20  # seconds
FULL_RUN = 600  # seconds, for the undamaged file
SEED = 20260101
DIGEST = "provenance/input_sha256"  # the last row differs with any bit of the input


def truncated(path, random):
    content = path.read_bytes()
    path.write_bytes(content[: random.integers(len(content))])


def flipped(path, random):
    content = bytearray(path.read_bytes())
    for _ in range(random.integers(1, 5)):
        content[random.integers(len(content))] ^= 1 << random.integers(8)
    path.write_bytes(content)


def zeroed(path, random):
    content = bytearray(path.read_bytes())
    start = random.integers(max(1, len(content) - 63))
    content[start : start + 64] = bytes(len(content[start : start + 64]))
    path.write_bytes(content)


def changed(path):
    return h5py.File(path, "r+", libver=("v110", "v110"))


def other_type(path, random):
    with changed(path) as file:
        text = str(random.choice(["jointcreep movie", "statepoint", "", "Jointcreep Network"]))
        file.attrs.create("filetype", text, dtype=h5py.string_dtype("utf-8", max(1, len(text))))


def other_version(path, random):
    with changed(path) as file:
        version = file.attrs["format_version"]
        file.attrs.modify("format_version", [version[0] + random.choice([-version[0], -1, 1, 1000]), 0])


def incomplete(path, random):
    with changed(path) as file:
        if random.integers(2):
            del file.attrs["complete"]
        else:
            file.attrs.modify("complete", 0)


def without_dataset(path, random):
    with changed(path) as file:
        names = sorted(datasets(file))
        del file[names[random.integers(len(names))]]


# Most of the damage is to bytes; only that may go unnoticed, where no program looks or nothing changes.
DAMAGE = [truncated, flipped, flipped, flipped, zeroed, zeroed, without_dataset, other_type, other_version, incomplete]
MUST_BE_REFUSED = [other_type, other_version, incomplete]


def datasets(file):
    names = []
    file.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
    return names


def content(path):
    """Every dataset and root attribute of an HDF5 file; all bytes of another."""
    if path.suffix != ".h5":
        return {"bytes": numpy.frombuffer(path.read_bytes(), numpy.uint8)}
    with h5py.File(path) as file:
        values = {name: file[name][()] for name in datasets(file)}
        values |= {"attribute " + name: numpy.asarray(value) for name, value in file.attrs.items()}
    if DIGEST in values:
        values[DIGEST] = values[DIGEST][:-1]
    return values


def difference(one, other):
    """Name of the first thing that differs, or nothing."""
    for name in sorted(one.keys() | other.keys()):
        if name not in one or name not in other or one[name].dtype != other[name].dtype:
            return name
        if one[name].shape != other[name].shape or one[name].tobytes() != other[name].tobytes():
            return name
    return None


def run(program, arguments, source, folder, limit):
    output = folder / ("out.vtu" if pathlib.Path(program).name == "jointexport" else "out.h5")
    command = [program, str(source), "-o", str(output), *arguments]
    return output, subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=limit)


def verdict(case, program, source, arguments, expected):
    """The kind of damage, what came of it, and what was wrong with that ("" if nothing)."""
    random = numpy.random.default_rng([SEED, case])
    damage = DAMAGE[case % len(DAMAGE)]
    with tempfile.TemporaryDirectory(prefix="damaged-") as name:
        folder = pathlib.Path(name)
        copy = folder / f"copy{case}.h5"
        shutil.copyfile(source, copy)
        damage(copy, random)
        out = folder / "out"
        out.mkdir()
        try:
            output, ended = run(program, arguments, copy, out, LONGEST_RUN)
        except subprocess.TimeoutExpired:
            return damage.__name__, "hangs", f"no end within {LONGEST_RUN} s"
        left = sorted(path.name for path in out.iterdir())
        said = ended.stderr.strip() or "nothing said"
        if ended.returncode in (2, 4):
            if left:
                return damage.__name__, "leaves files", ", ".join(left)
            if copy.name not in ended.stderr:
                return damage.__name__, "does not name the file", said
            return damage.__name__, "refused", ""
        if ended.returncode != 0:
            return damage.__name__, f"exit code {ended.returncode}", said
        if damage in MUST_BE_REFUSED:
            return damage.__name__, "accepted", "it should have been refused"
        if left != [output.name]:
            return damage.__name__, "wrong files", ", ".join(left) or "no output"
        try:
            differing = difference(expected, content(output))
        except (OSError, RuntimeError, KeyError) as error:  # what h5py throws at damage
            differing = f"the output cannot be read: {error}"
        return damage.__name__, "fooled" if differing else "same answer", differing or ""


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    program, source = str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(sys.argv[2])
    rest = sys.argv[3:]
    count = int(rest.pop(0)) if rest and rest[0].isdigit() else 300

    with tempfile.TemporaryDirectory(prefix="damaged-") as folder:
        output, ended = run(program, rest, source, pathlib.Path(folder), FULL_RUN)
        if ended.returncode != 0:
            sys.exit(f"the undamaged file is refused: {ended.stderr}")
        expected = content(output)

    outcomes, failures = collections.Counter(), 0
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        cases = pool.map(lambda case: verdict(case, program, source, rest, expected), range(count))
        for case, (damage, outcome, problem) in enumerate(cases):
            outcomes[damage, outcome] += 1
            if problem:
                failures += 1
                print(f"case {case}, {damage}: {outcome}: {problem}")

    for (damage, outcome), times in sorted(outcomes.items()):
        print(f"{times:6}  {damage:16} {outcome}")
    print(f"{count - failures} of {count} damaged copies of {source.name} handled well by {pathlib.Path(program).name}")
    sys.exit(1 if failures or not count else 0)


if __name__ == "__main__":
    main()
