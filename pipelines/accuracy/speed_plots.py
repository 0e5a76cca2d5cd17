"""Pictures of error against cost, one panel a case. See speed_against_error.py."""

import math

import matplotlib.ticker

import figure

COLORS = {"published": figure.COLORS[1], "backward": figure.COLORS[3], "linear-force": figure.COLORS[2],
          "fitted": figure.COLORS[0], "": "black"}
MARKERS = {"published": "o", "backward": "s", "linear-force": "^", "fitted": "D"}
LINES = {"relaxation": "--", "implicit": "-", "": ""}


def label_of(run, offer):
    """What a line of the picture is called, and how it looks."""
    engine = f"{run.engine}: " if len(offer.engines) > 1 and run.engine else ""
    look = {"linestyle": LINES[run.engine], "markersize": 3.5,
            "markerfacecolor": "white" if run.engine == "relaxation" else None}
    if run.study == "creep step":
        return f"{engine}{run.scheme}, dT", look | {"color": COLORS[run.scheme], "marker": MARKERS[run.scheme]}
    if run.study == "creep tolerance":
        return f"{engine}steps by error", look | {"color": "black", "marker": "v"}
    if run.study == "tolerance":
        return f"{engine}tolerance", look | {"color": figure.COLORS[4], "marker": "x"}
    if run.study == "zone size":
        return f"{engine}zone size", look | {"color": figure.COLORS[5], "marker": "+"}
    return "defaults", {"color": "black", "marker": "*", "linestyle": "", "markersize": 7}


def drawn(axes, rows, offer, cost, error):
    """Lines of one panel: {label: line}."""
    lines = {}
    for row in rows:
        label, look = label_of(row.run, offer)
        value = getattr(row, error)
        if math.isfinite(value) and value > 0 and getattr(row, cost) > 0:
            lines.setdefault(label, (look, []))[1].append((getattr(row, cost), value))
    made = {}
    for label, (look, places) in lines.items():
        made[label], = axes.loglog(*zip(*places), linewidth=0.8, **look)
    axes.grid(color="0.9", linewidth=0.4)
    axes.xaxis.set_minor_formatter(matplotlib.ticker.NullFormatter())
    return made


def panels(rows, cases, offer, cost, error, columns, size, labels, path, bottom=1e-10):
    n_rows = -(-len(cases) // columns)
    plot, all_axes = figure.plt.subplots(n_rows, columns, figsize=size, squeeze=False, sharex=True, sharey=True)
    made = {}
    for axes, case in zip(all_axes.flat, cases):
        made |= drawn(axes, [row for row in rows if row.case == case.name], offer, cost, error)
        axes.set_title(case.title, fontsize=7)
    for axes in all_axes.flat[len(cases):]:
        axes.set_axis_off()
    low, high = all_axes.flat[0].get_ylim()
    all_axes.flat[0].set_ylim(max(low, bottom), min(high, 10))
    for axes in all_axes[-1]:
        axes.set_xlabel(labels[0])
    for axes in all_axes[:, 0]:
        axes.set_ylabel(labels[1])
    columns = min(4, max(1, len(made)))
    legend = 0.17 * -(-len(made) // columns) / size[1]  # its height, kept free below the panels
    plot.get_layout_engine().set(rect=(0, legend, 1, 1 - legend))
    plot.legend(made.values(), made.keys(), loc="lower center", ncol=columns, fontsize=6.5, borderaxespad=0)
    plot.savefig(path)
    figure.plt.close(plot)


def draw(rows, cases, offer, out):
    redundant = [case for case in cases if case.name.startswith(("platens", "two pillars"))]
    others = [case for case in cases if case not in redundant or case.name.endswith(" 1.44")]
    steps = [row for row in rows if row.run.engine == offer.fastest and row.run.study.startswith("creep")]
    wide = figure.TWO_COLUMNS
    panels(steps, redundant, offer, "equilibria", "traction", min(5, len(redundant)),
           (wide, 2.0 + 1.5 * (len(redundant) > 5)), ("equilibria", "largest force error"), out / "creep-steps.png")
    for cost, cost_label in (("time", "time (column = 1)"), ("equilibria", "equilibria")):
        for error, error_label in (("traction", "largest force error"),
                                   ("displacement", "displacement error")):
            if (cost, error) == ("equilibria", "displacement"):
                continue
            name = f"{'force' if error == 'traction' else error}-{cost}.png"
            panels(rows, others, offer, cost, error, min(4, len(others)), (wide, 2.2 + 1.7 * (len(others) > 4)),
                   (cost_label, error_label), out / name)
