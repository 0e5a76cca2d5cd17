#!/usr/bin/python3
"""Strength of each joint set: the joint's own, that of its rock bridges, and that of the equivalent joints between.

The lines are Coulomb's criterion with a tensile strength; of a joint with residual strength, before its bonds break. A set whose
law has another criterion has no line, but the law's name. Compressions go up to the largest in-situ compression in the section, or twice
the largest cohesion of a joint's own, whichever is more.
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


def in_situ_compression(scene):
    """The largest normal stress on a vertical or horizontal plane at the lowest place of the section [MPa], compression positive."""
    law, heights = scene["in_situ_stress"], [y for _, y in scene["section"]["outline_m"]]
    depth = max([y for _, y in law["ground_m"]] if "ground_m" in law else [law["elevation_m"]]) - min(heights)
    if "horizontal_stress_ratio" in law:
        density = next(rock["density_kg_per_m3"] for rock in scene["rock"] if rock["name"] == scene["section"]["rock"])
        return 1e-6 * density * scene["section"]["gravity_m_per_s2"] * depth * max(1, law["horizontal_stress_ratio"])
    components = [f"compression_{component}" for component in ("xx", "yy")]
    if "profile" in law:
        one, other = sorted(law["profile"], key=lambda level: abs(level["depth_m"] - depth))[:2]  # the levels around it, or near
        share = (depth - one["depth_m"]) / (other["depth_m"] - one["depth_m"])
        return max((1 - share) * one[f"{name}_MPa"] + share * other[f"{name}_MPa"] for name in components)
    return max(law[f"{name}_MPa"] + law[f"{name}_gradient_MPa_per_m"] * depth for name in components)


def draw_set(file, row, name, axes, most):
    """tau over sigma_n, tension positive, cut off at the tensile strength. Legend: cohesion, friction angle, tensile strength."""
    others = other_laws(file, row)
    axes.set_xlabel(r"normal traction $\sigma_n$, tension positive (MPa)")
    if others:
        axes.set_title(name)
        axes.annotate(f"{' and '.join(others)}:\nno line of Coulomb's criterion", (0.5, 0.5), xycoords="axes fraction", ha="center",
                      va="center", color="0.4")
        return
    persistence = figure.array(file, "/sets/edge_persistence")[row]
    lines, labels = [], []
    for prefix, label, style, width, color in CURVES:
        cohesion, angle, tension = strength_of(file, prefix, row)
        if prefix == "bridge_" and persistence > 1 - 1e-9:
            continue
        end = min(tension, cohesion / np.tan(angle)) if angle > 0 else tension
        tau_end = max(0.0, cohesion - end * np.tan(angle))
        lines += axes.plot([-most, end, end], [cohesion + most * np.tan(angle), tau_end, 0], linestyle=style,
                           linewidth=width, color=color or figure.set_color(row), label=label)
        labels.append(f"{label}: {cohesion:.3g} MPa, {np.degrees(angle):.3g}°, {end:.3g} MPa")
    axes.set_title(f"{name} (persistence {persistence:.3g} on edges)")
    axes.set_ylim(0, 1.5 * axes.get_ylim()[1])  # the legend is above the lines
    axes.axvline(0, color="0.6", linewidth=0.6, zorder=0)
    axes.legend(lines, labels, loc="upper right", fontsize=6, frameon=True, framealpha=1, edgecolor="none")


def draw(file, compression=None):
    """Figure of the strength of each joint set, up to a compression [MPa]."""
    names = figure.texts(file, "/names/joint_set")
    sets = [row for row in range(len(names)) if figure.array(file, "/sets/edge_length")[row] > 0]
    if not sets:
        raise figure.NotWanted("no joint set has edges")
    most = compression or max(in_situ_compression(figure.scene_of(file)), 2e-6 * figure.array(file, "/sets/joint_cohesion")[sets].max()) or 1
    columns = min(2, len(sets))
    rows = -(-len(sets) // columns)
    plot, all_axes = figure.plt.subplots(
        rows, columns, squeeze=False, sharex=True,
        figsize=(figure.ONE_COLUMN if columns == 1 else figure.TWO_COLUMNS, 0.5 + 2.3 * rows))
    for axes in all_axes.flat[len(sets):]:
        axes.set_visible(False)
    for row, axes in zip(sets, all_axes.flat):
        draw_set(file, row, names[row], axes, most)
    low, high = all_axes[0, 0].get_xlim()
    high = max(high, 0.1 * most)
    for axes in all_axes.flat[:len(sets)]:
        axes.tick_params(labelbottom=True)  # each has its label, so its numbers, too
        axes.axvspan(0, high, facecolor="0.93", zorder=-1)
        axes.set_xlim(-most, high)
    for axes in all_axes[:, 0]:
        axes.set_ylabel(r"shear strength $\tau$ (MPa)")
    plot.suptitle("cohesion, friction angle, tensile strength; grey: tension" +
                  ("" if compression else "; compression up to the largest in-situ one"), fontsize=7)
    return plot


if __name__ == "__main__":
    figure.run(draw, figure.arguments_of(__doc__, (["--compression"], {
        "type": float, "metavar": "MPa",
        "help": "how far the curves go; default: the largest in-situ compression in the section"})))
