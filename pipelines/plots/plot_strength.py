#!/usr/bin/python3
"""Strength of each joint set: the joint's own, that of its rock bridges, and that of the equivalent joints between.

The lines are Coulomb's criterion with a tensile strength; of a joint with residual strength, before its bonds break. A set whose
law has another criterion has no line, but the law's name.
"""

import numpy as np

import figure

CURVES = [("joint_", "joint", "-", 0.8, "0.45"), ("bridge_", "rock bridges", "--", 0.8, "0.45"),
          ("", "equivalent", "-", 1.6, None)]  # in the colour of the set
# Numbers of /equivalent/law: with Coulomb's criterion, and the names of others.
COULOMB, OTHERS = {0, 1, 3}, {2: "Barton-Bandis", 4: "continuously yielding"}


def strength_of(file, prefix, row):
    """{cohesion, friction angle, tensile strength} of a set [MPa, rad, MPa]."""
    cohesion, angle, tension = (figure.array(file, f"/sets/{prefix}{name}")[row]
                                for name in ("cohesion", "friction_angle", "tensile_strength"))
    return cohesion / 1e6, angle, tension / 1e6


def other_laws(file, row):
    """Names of the laws without Coulomb's criterion that edges of a set have."""
    joint = figure.array(file, "/edges/joint")
    of_set = (joint >= 0) & (figure.array(file, "/joints/set")[joint] == row)
    laws = np.unique(figure.array(file, "/equivalent/law")[of_set]).tolist()
    return [OTHERS.get(law, f"law {law}") for law in laws if law not in COULOMB]


def draw_set(file, row, name, axes, most):
    """tau over sigma_n, tension positive, cut off at the tensile strength."""
    others = other_laws(file, row)
    if others:
        axes.set_title(name)
        axes.annotate(f"{' and '.join(others)}:\nno line of Coulomb's criterion", (0.5, 0.5), xycoords="axes fraction", ha="center",
                      va="center", color="0.4")
        axes.set_xlabel(r"normal traction $\sigma_n$, tension positive (MPa)")
        return []
    persistence = figure.array(file, "/sets/edge_persistence")[row]
    entries = []
    for prefix, label, style, width, color in CURVES:
        cohesion, angle, tension = strength_of(file, prefix, row)
        if prefix == "bridge_" and persistence > 1 - 1e-9:
            continue
        end = min(tension, cohesion / np.tan(angle)) if angle > 0 else tension
        tau_end = max(0.0, cohesion - end * np.tan(angle))
        entries += axes.plot([-most, end, end], [cohesion + most * np.tan(angle), tau_end, 0], linestyle=style,
                             linewidth=width, color=color or figure.set_color(row), label=label)
    axes.set_title(f"{name} (persistence {persistence:.3g} on edges)")
    axes.axhline(0, color="0.6", linewidth=0.6, zorder=0)
    axes.axvline(0, color="0.6", linewidth=0.6, zorder=0)
    axes.set_xlabel(r"normal traction $\sigma_n$, tension positive (MPa)")
    return entries


def draw(file, compression=None):
    """Figure of the strength of each joint set, up to a compression [MPa]."""
    names = figure.texts(file, "/names/joint_set")
    sets = [row for row in range(len(names)) if figure.array(file, "/sets/edge_length")[row] > 0]
    if not sets:
        raise figure.NotWanted("no joint set has edges")
    largest = max(figure.array(file, f"/sets/{prefix}cohesion")[sets].max() for prefix, *_ in CURVES) / 1e6
    most = compression or max(1, 2 * largest)
    columns = min(2, len(sets))
    rows = -(-len(sets) // columns)
    plot, all_axes = figure.plt.subplots(
        rows, columns, squeeze=False, sharex=True, sharey=True,
        figsize=(figure.ONE_COLUMN if columns == 1 else figure.TWO_COLUMNS, 0.4 + 2.2 * rows))
    for axes in all_axes.flat[len(sets):]:
        axes.set_visible(False)
    entries = [draw_set(file, row, names[row], axes, most) for row, axes in zip(sets, all_axes.flat)]
    fullest = max(range(len(sets)), key=lambda i: len(entries[i]))
    if entries[fullest]:
        all_axes.flat[fullest].legend(handles=entries[fullest], loc="upper right")
    for axes in all_axes.flat[:len(sets)]:  # each has its label, so its numbers, too
        axes.tick_params(labelbottom=True)
    for axes in all_axes[:, 0]:
        axes.set_ylabel(r"shear strength $\tau$ (MPa)")
    return plot


if __name__ == "__main__":
    figure.run(draw, figure.arguments_of(__doc__, (["--compression"], {
        "type": float, "metavar": "MPa",
        "help": "how far the curves go; default: twice the largest cohesion, and at least 1"})))
