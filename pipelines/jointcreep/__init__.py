"""Monte Carlo studies of jointcreep: one study file in, many runs of the programs, their statistics and a report out.

    command.py      the command line
    study_file.py   reads and checks the study file
    scene_keys.py   finds and changes the keys of a scene
    design.py       what each run is given: its network and its parameters
    group.py        makes the runs of one group, one after another, and keeps a line of results for each
    runs.py         makes all groups, by GNU Make or Snakemake, and goes on where it was interrupted
    table.py        runs.csv, runs.h5 and times.csv: a row a run
    quantities.py   reads what is collected from the files of a run
    histories.py    displacements of points at any time
    answers.py      means, quantiles and probabilities with confidence, shares of the variance
    pictures.py     pictures of them
    report.py       one page of HTML
"""
