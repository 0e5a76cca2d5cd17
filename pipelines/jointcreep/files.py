"""Files: how text in HDF5 files is read, and how files are written: whole or not at all."""

import contextlib
import csv
import glob
import io
import os
import pathlib
import sys

import h5py
import numpy as np

from .errors import NotWanted

NAMED = 20  # numbers that a line lists


def text_of(value):
    """Text of an HDF5 dataset or attribute as str."""
    return value.decode() if isinstance(value, bytes) else str(value)


def texts(file, path):
    """A dataset of an open HDF5 file as a list of str."""
    return [text_of(value) for value in np.ravel(file[path][()])]


def put(file, path, values):
    """Writes a dataset into an open HDF5 file and returns it: an array, or a list of str as UTF-8 of a fixed length. The same values
    have the same bytes."""
    if isinstance(values, list):
        coded = [value.encode() for value in values]
        values = np.array(coded, h5py.string_dtype("utf-8", max([1, *map(len, coded)])))
    return file.create_dataset(path, data=values, track_times=False)


@contextlib.contextmanager
def replaced(path):
    """A file that takes the place of another one once it is whole. Yields the path to write to.

        with files.replaced(out / "table.csv") as partial:
            partial.write_text(text)

    Where writing fails, or the process is killed, the old file stays as it is; so it does if the new one has the same bytes. What
    writers left that were killed is removed.
    """
    path = pathlib.Path(path)
    partial = path.with_name(f"{path.name}.partial-{os.getpid()}")
    try:
        yield partial
        if not (path.exists() and path.read_bytes() == partial.read_bytes()):
            with open(partial, "rb") as file:
                os.fsync(file.fileno())
            os.replace(partial, path)
    finally:
        for left in path.parent.glob(f"{glob.escape(path.name)}.partial-*"):
            is_left = is_partial_of(path, left) and not left.is_symlink() and left.is_file()
            if left == partial or is_left and not pathlib.Path("/proc", left.name.rpartition("-")[2]).exists():
                left.unlink(missing_ok=True)


def is_partial_of(output, path):
    """Whether a path is called as a partial file of an output: NAME.partial- and a number, beside it."""
    begin = f"{pathlib.Path(output).name}.partial-"
    return path.name.startswith(begin) and path.name[len(begin):].isdecimal() and \
        path.parent.resolve() == pathlib.Path(output).parent.resolve()


def refuse_partial(output, inputs):
    """Refuses inputs that are called as partial files of an output, because these are removed."""
    for one in inputs:
        if any(is_partial_of(output, path) for path in (pathlib.Path(one), pathlib.Path(one).resolve())):
            raise NotWanted(f"-o {output}: the input {one} is called as an unfinished file of it, which would be removed; rename it")


def write_text(path, text):
    """Writes a text file as UTF-8, by replaced()."""
    with replaced(path) as partial:
        partial.write_text(text, encoding="utf-8", newline="")


STANDARD_OUTPUT = "-"  # as the value of -o


def write_output(output, text):
    """Writes a text where -o says: a file, by replaced(), or standard output."""
    if output == STANDARD_OUTPUT:
        sys.stdout.flush()
        sys.stdout.buffer.write(text.encode("utf-8"))
        sys.stdout.buffer.flush()
    else:
        write_text(output, text)


def write_hdf5(path, fill):
    """Writes an HDF5 file, by replaced(): fill(file) puts everything into the open file, whose attribute `complete` is then 1."""
    with replaced(path) as partial, h5py.File(partial, "w") as file:
        fill(file)
        file.attrs["complete"] = np.int32(1)


def csv_text(heads, rows):
    """A table as the text of a CSV file; an empty field where there is no value (None). Numbers read back exactly."""
    text = io.StringIO()
    out = csv.writer(text, lineterminator="\n")
    out.writerow(heads)
    out.writerows([["" if value is None else value for value in row] for row in rows])
    return text.getvalue()


SAME_TIME = 1e-12  # relative


def day_text(days):
    """A time without the digits that rounding leaves, 3 for 3.0000000000000004: the shortest decimal within SAME_TIME of it."""
    days = float(days)
    near = next((near for near in (float(f"{days:.{digits}g}") for digits in range(1, 17)) if abs(near - days) <= SAME_TIME * abs(days)), days)
    return repr(int(near)) if near == int(near) and abs(near) < 1e15 else repr(near)


def listed(numbers):
    """Numbers in words, the first of them if there are many."""
    return ", ".join(map(str, numbers[:NAMED])) + (f" and {len(numbers) - NAMED} more" if len(numbers) > NAMED else "")
