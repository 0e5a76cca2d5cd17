"""The plots as functions.

    from jointcreep import plots

    figure = plots.draw("state", "result.h5", field="stress")     # of matplotlib
    plots.save("histories", "result.h5", "histories.png", component="x")

Names are those of the scripts plot_NAME.py; options are those of their command lines, as arguments of their function draw().
"""

import importlib
import inspect
import pathlib

import figure

from .errors import NotWanted

NAMES = ["section", "blocks", "stereonet", "rose", "distributions", "strength", "histories", "line", "state", "step_history", "dynamics",
         "safety", "ensemble"]


def draw(name, path, **options):
    """A figure of matplotlib. path: the file that it is drawn of. Raises NotWanted if the file does not have what the plot needs."""
    if name not in NAMES:
        raise NotWanted(f'there is no plot "{name}"; there are: {", ".join(NAMES)}')
    function = importlib.import_module(f"plot_{name}").draw
    takes = inspect.signature(function).parameters
    for option, value in options.items():  # one word in place of a list of words
        if isinstance(value, str) and option in takes and isinstance(takes[option].default, tuple):
            options[option] = [value]
    try:
        return figure.drawn(function, path, **options)
    except figure.NotWanted as error:
        raise NotWanted(str(error)) from None


def save(name, path, output, **options):
    """Draws a picture into the file `output`, which appears once it is whole."""
    picture = draw(name, path, **options)
    try:
        figure.save(picture, pathlib.Path(output))
    finally:
        figure.plt.close(picture)
