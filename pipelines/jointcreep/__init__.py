"""Files of jointcreep as tables, runs of one scene, and Monte Carlo studies: one study file in, many runs of the programs, statistics
and a report out.

In the order in which a study passes through them:

    command.py      the command line
    study_file.py   reads and checks the study file
    scene_keys.py   finds and changes the keys of a scene
    plan.py         what a study's folder has before runs are made
    design.py       what each run is given: its network and its parameters
    runs.py         makes all groups of runs, by processes or Snakemake, and continues where it was interrupted
    group.py        makes the runs of one group, one after another, and keeps a line of results for each
    quantities.py   reads what is collected from the files of a run
    histories.py    displacements of points at any time
    failure.py      the probability of a rare failure
    table.py        runs.csv, runs.h5 and times.csv: a row a run
    intervals.py    means, quantiles and probabilities with their confidence intervals
    answers.py      these of a study, how they converge, and shares of the variance
    pictures.py     pictures of them
    reading.py      files and studies as tables with units: jointcreep.read(PATH)
    chain.py        programs of the chain, for scripts
    files.py        text in HDF5 files; files that are written whole or not at all
    ensemble.py     statistics of the histories of all runs
    plots.py        the plots of pipelines/plots as functions
    report.py       one page of HTML
    run.py          one scene from its file to results, pictures and a report
    errors.py       what ends a command with a message

Joint sets from mapped traces:

    fit.py               the command, and what it writes
    traces.py            traces as a window shows them
    length_laws.py       laws of their length, cut ones as censored
    orientation_laws.py  laws of their angle, and of poles
"""

import pathlib
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent / "plots"))  # modules of plots.py, beside the package

from .errors import NotWanted  # noqa: E402
from .reading import read  # noqa: E402

__all__ = ["NotWanted", "read"]
