"""The table of a study: a row a run, as runs.csv and as /runs in runs.h5; times and retries in times.csv.

The first two depend on nothing but the study, so they have the same bytes however the runs were made. Of a study that was stopped they
have the runs that have ended.
"""

import h5py
import numpy as np

from . import files
from .quantities import ending_of
from .study_file import LEVEL, NETWORK

WORDS = (LEVEL, "no equilibrium", "failure stage", "program", "reason")  # columns of text, also where all are empty
OF_FAILURE = [("failure day", "day", "day"), ("moving blocks", "1", "blocks"), ("moving area (m2)", "m2", "area")]  # column, unit, key of a row

FORMAT_VERSION = [1, 2]  # of runs.h5


def columns_of(study, rows, given):
    """Columns of the table: name, unit, values; None where there is none."""
    numbers = [row["run"] for row in rows]
    columns = [("run", "1", numbers), (NETWORK, "1", [given[run]["network"] for run in numbers])]
    columns += [(LEVEL, "1", [study.design.level(run) for run in numbers])] if study.design.fine_runs else []
    columns += [(one.name, "as the key", [given[run]["given"][at] for run in numbers])
                for at, one in enumerate(study.parameters)]
    columns += [("exit code", "1", [row["exit_code"] for row in rows]),
                ("no equilibrium", "1", [ending_of(row) for row in rows]),
                ("program", "1", [row["program"] for row in rows]), ("reason", "1", [row["reason"] for row in rows]),
                ("failure stage", "1", [row.get("failure", {}).get("stage", "") for row in rows])]
    columns += [(name, unit, [row.get("failure", {}).get(key) for row in rows]) for name, unit, key in OF_FAILURE]
    columns += [(one.title(), one.unit, [row["values"][at] for row in rows]) for at, one in enumerate(study.quantities)]
    return columns


def hdf5_columns(columns, n_values):
    """The columns of the dataset /runs: name, unit, type, values. The last `n_values` have one more each, which says whether there
    is a value; without one it is 0."""
    for place, (name, unit, values) in enumerate(columns):
        if any(isinstance(value, str) for value in values) or name in WORDS:
            coded = [str(value).encode() for value in values]
            yield name, unit, h5py.string_dtype("utf-8", max([1, *map(len, coded)])), coded
        elif place < len(columns) - n_values:
            yield name, unit, np.float64 if any(isinstance(value, float) for value in values) else np.int64, values
        else:
            yield name, unit, np.float64, [0.0 if value is None else value for value in values]
            yield f"{name}, is there", "1", np.int8, [value is not None for value in values]


def write_hdf5(path, study, columns, scene):
    """The table as one dataset of records."""
    found = list(hdf5_columns(columns, len(OF_FAILURE) + len(study.quantities)))
    records = np.zeros(len(columns[0][2]), np.dtype([(name, kind) for name, _, kind, _ in found]))
    for name, _, _, values in found:
        records[name] = values
    texts = (("scene", scene), ("study", study.path.read_text(encoding="utf-8-sig")))

    def fill(file):
        file.attrs["filetype"] = np.bytes_("jointcreep study")
        file.attrs["format_version"] = np.array(FORMAT_VERSION, np.int32)
        dataset = files.put(file, "runs", records)
        dataset.attrs["description"] = np.bytes_("A row a run. A value that is not there is 0, and its column \", is there\" is 0.")
        dataset.attrs["units"] = np.array([unit.encode() for _, unit, _, _ in found])
        for name, text in texts:
            files.put(file, name, [text])

    files.write_hdf5(path, fill)


def write(study, rows, given, scene, out):
    """Writes the three files. Times are wall times, and of the last try the processor time of its programs."""
    columns = columns_of(study, rows, given)
    files.write_text(out / "runs.csv", files.csv_text([name for name, _, _ in columns], zip(*(values for _, _, values in columns))))
    times = ["seconds", "program_seconds", "processor_seconds"]
    files.write_text(out / "times.csv", files.csv_text(["run", "attempts", *times], [
        [row["run"], row["attempts"], *(f"{row[name]:.3f}" for name in times)] for row in rows]))
    write_hdf5(out / "runs.h5", study, columns, scene)
