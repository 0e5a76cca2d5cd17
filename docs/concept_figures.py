#!/usr/bin/python3
"""Draws the concept figures of the theory manual, and the problems of the verification manual from their scenes.

    concept_figures.py [FOLDER]        default: the folder pictures beside this script

The same version of matplotlib gives the same bytes. Lines differ by style and label, not by colour alone.
"""

import sys
import tomllib
from pathlib import Path

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import numpy as np

BLUE, RED, GREEN, OCHRE, GREY, ROCK = "#1b2a5c", "#b5403a", "#2f9e77", "#d9a22b", "#8a8a8a", "#dfe3e8"

plt.rcParams.update({
    "font.size": 10, "axes.linewidth": 0.8, "lines.linewidth": 1.6, "axes.spines.top": False, "axes.spines.right": False,
    "legend.frameon": False, "figure.constrained_layout.use": True, "svg.hashsalt": "jointcreep", "svg.fonttype": "path",
    "mathtext.fontset": "dejavusans", "savefig.facecolor": "white",
})


def arrow(axes, start, end, style="<->", color="black"):
    axes.annotate("", end, start, arrowprops={"arrowstyle": style, "color": color, "lw": 1, "shrinkA": 0, "shrinkB": 0})


def without_frame(axes, x, y):
    axes.set(xlim=x, ylim=y, aspect="equal")
    axes.axis("off")


def schematic(axes, x="", y=""):
    """Axes without numbers: only the shape of a curve matters."""
    axes.set(xlabel=x, ylabel=y, xticks=[], yticks=[])


def joint_line():
    """Two parallel lines of traces and bridges in a section."""
    figure, axes = plt.subplots(figsize=(7, 3.3))
    without_frame(axes, (-0.6, 12.6), (-0.5, 5.8))
    axes.add_patch(plt.Rectangle((0, 0), 12, 5.4, facecolor=ROCK, edgecolor="black", lw=0.8))
    angle = np.radians(20)
    along, normal = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    for origin, pieces in (((0.8, 0.3), [(0, 3), (4.2, 7.4), (8.6, 11.2)]), ((0.35, 2.1), [(0, 1.5), (2.9, 5.9), (7.1, 9.2)])):
        origin = np.array(origin)
        ends = [origin + s * along for s in (0, pieces[-1][1])]
        axes.plot(*np.transpose(ends), ":", color=GREY, lw=1.2)
        for start, end in pieces:
            axes.plot(*np.transpose([origin + start * along, origin + end * along]), "-", color=BLUE, lw=2.6,
                      solid_capstyle="butt")
    first = np.array((0.8, 0.3))
    below = -0.28 * normal
    for start, end, text in ((4.2, 7.4, "joint trace  $L$"), (7.4, 8.6, "rock bridge  $G$")):
        arrow(axes, first + start * along + below, first + end * along + below)
        axes.text(*(first + (start + end) / 2 * along + 2.1 * below), text, rotation=20, ha="center", va="center",
                  rotation_mode="anchor")
    foot = first + 1.4 * along
    second = np.array((0.35, 2.1))
    head = foot + ((second - foot) @ normal) * normal
    arrow(axes, foot, head)
    axes.text(*((foot + head) / 2 + (0.12, 0.05)), "spacing  $s\\,/\\,|n_p|$", ha="left", va="center")
    corner = first + 8.6 * along
    axes.plot([corner[0], corner[0] + 2.2], [corner[1]] * 2, "-", color="black", lw=0.8)
    arc = np.radians(np.linspace(0, 20, 20))
    axes.plot(corner[0] + 1.7 * np.cos(arc), corner[1] + 1.7 * np.sin(arc), "-", color="black", lw=0.8)
    axes.text(corner[0] + 2.3, corner[1] + 0.1, "trace\nangle", ha="left", va="center", fontsize=9)
    axes.text(0.25, 4.95, "persistence  $k$ = sum of $L$ / sum of ($L + G$)", ha="left", va="center")
    arrow(axes, (-0.4, -0.35), (0.8, -0.35), "->")
    arrow(axes, (-0.4, -0.35), (-0.4, 0.85), "->")
    axes.text(0.9, -0.35, "$x$", va="center")
    axes.text(-0.4, 0.95, "$y$", ha="center")
    return figure


def coulomb():
    """Shear traction over displacement, strength over pressure, dilation over slip."""
    figure, (shear, strength, dilation) = plt.subplots(1, 3, figsize=(9, 2.9))
    u = np.array([0, 1, 3.4])
    shear.plot(u, [0, 1, 1], "-", color=BLUE, label="Coulomb")
    shear.plot([0, 1, 1, 3.4], [0, 1, 0.62, 0.62], "--", color=RED, label="with residual strength")
    shear.plot([2.4, 1.8], [1, 0.4], ":", color=GREY, lw=1.4)
    shear.text(2.02, 0.38, "unloading", color="black", fontsize=8, ha="left")
    shear.text(0.36, 0.5, "$k_s$", ha="right")
    shear.set(xlim=(0, 3.6), ylim=(0, 1.35))
    shear.legend(loc="upper left", fontsize=8, borderaxespad=0)
    schematic(shear, "shear displacement  $u_s$", "shear traction  $\\tau$")

    p = np.array([-0.35, 2.4])
    strength.plot(p, 0.45 + 0.6 * p, "-", color=BLUE, label="$c - \\sigma_n \\tan\\varphi$")
    strength.plot([-0.35, -0.35], [0, 0.45 - 0.21], "-", color=BLUE)
    strength.plot([0, 2.4], [0.12, 0.12 + 0.45 * 2.4], "--", color=RED, label="$c_{res} - \\sigma_n \\tan\\varphi_{res}$")
    strength.axvline(0, ymax=0.75, color="black", lw=0.6)
    strength.text(-0.38, 0.32, "$T$", ha="right")
    strength.text(0.05, 0.52, "$c$", ha="left")
    strength.set(xlim=(-0.7, 2.5), ylim=(0, 2.5))
    strength.legend(loc="upper left", fontsize=8, borderaxespad=0)
    schematic(strength, "pressure  $-\\sigma_n$", "shear strength  $|\\tau|$")

    p = np.linspace(0, 3, 100)
    dilation.plot([0, 3], [0, 1.5], "-", color=BLUE, label="$\\psi$ constant")
    dilation.plot([0, 1.6, 3], [0, 0.8, 0.8], "--", color=RED, label="with an end of dilation")
    dilation.plot(p, 0.5 / 1.1 * (1 - np.exp(-1.1 * p)), "-.", color=GREEN, label="with wear")
    dilation.text(1.05, 0.66, "$\\tan\\psi$", ha="right")
    dilation.set(xlim=(0, 3.1), ylim=(0, 2.1))
    dilation.legend(loc="upper left", fontsize=8, borderaxespad=0)
    schematic(dilation, "slip", "dilation  $w$")
    return figure


def spring(axes, start, end, y, turns=6, height=0.16):
    x = np.linspace(start, end, 2 * turns + 3)[1:-1]
    zigzag = y + height * np.where(np.arange(len(x)) % 2, 1, -1)
    zigzag[0] = zigzag[-1] = y
    axes.plot([start, *x, end], [y, *zigzag, y], "-", color="black", lw=1.2)


def dashpot(axes, start, end, y, height=0.17):
    middle = (start + end) / 2
    axes.plot([start, middle], [y, y], "-", color="black", lw=1.2)
    axes.plot([middle, middle], [y - 0.7 * height, y + 0.7 * height], "-", color="black", lw=2)
    axes.plot([middle - 0.15, middle + 0.2, middle + 0.2, middle - 0.15], [y + height, y + height, y - height, y - height], "-",
              color="black", lw=1.2)
    axes.plot([middle + 0.2, end], [y, y], "-", color="black", lw=1.2)


def kelvin():
    """Spring and Kelvin unit in series; displacement under a constant traction."""
    figure, (model, curve) = plt.subplots(1, 2, figsize=(8, 2.7), gridspec_kw={"width_ratios": [1.15, 1]})
    without_frame(model, (-0.6, 5.3), (-1.1, 1.1))
    model.plot([0, 0], [-0.45, 0.45], "-", color="black", lw=2.5)
    spring(model, 0, 1.6, 0)
    model.plot([1.6, 1.9], [0, 0], "-", color="black", lw=1.2)
    for x in (1.9, 3.7):
        model.plot([x, x], [-0.4, 0.4], "-", color="black", lw=1.2)
    spring(model, 1.9, 3.7, 0.4)
    dashpot(model, 1.9, 3.7, -0.4)
    model.plot([3.7, 4.1], [0, 0], "-", color="black", lw=1.2)
    arrow(model, (4.1, 0), (4.8, 0), "->", RED)
    model.text(4.9, 0, "$F$", va="center", color=RED)
    model.text(0.8, 0.32, "$K$", ha="center")
    model.text(2.8, 0.68, "$E$", ha="center")
    model.text(2.8, -0.85, "$\\eta$", ha="center")
    model.text(0.8, -1.0, "instantaneous", ha="center", fontsize=9)
    model.text(2.8, 0.98, "Kelvin unit: displacement $d$", ha="center", fontsize=9)

    t = np.linspace(0, 4, 200)
    curve.plot([0, 0], [0, 1], "-", color=BLUE)
    curve.plot(t, 1 + 1.2 * (1 - np.exp(-t)), "-", color=BLUE)
    curve.axhline(2.2, color=GREY, lw=0.8, ls=":")
    curve.axhline(1, color=GREY, lw=0.8, ls=":")
    arrow(curve, (3.75, 0), (3.75, 1))
    curve.text(3.65, 0.5, "$F/K$", ha="right", va="center")
    arrow(curve, (3.75, 1), (3.75, 2.2))
    curve.text(3.65, 1.6, "$F/E$", ha="right", va="center")
    curve.plot([1, 1], [0, 1 + 1.2 * (1 - np.exp(-1))], ":", color=GREY, lw=0.8)
    curve.text(1.05, 0.1, "$T = \\eta / E$", ha="left")
    curve.set(xlim=(0, 4), ylim=(0, 2.6))
    schematic(curve, "time  $T$", "displacement  $\\delta_0(T)$")
    return figure


def schemes():
    """The force during a creep step by each scheme."""
    figure, axes = plt.subplots(figsize=(5.2, 2.9))
    s = np.linspace(0, 1, 100)
    axes.plot([0, 1, 1], [0, 0, 1], "-", color=GREY, label="published: $\\phi = 0$")
    axes.plot([0, 0, 1], [0, 1, 1], "--", color=RED, label="backward: $\\phi = 1$")
    axes.plot(s, s, "-.", color=GREEN, label="linear force: $\\phi = s$")
    axes.plot(s, (1 - np.exp(-3 * s)) / (1 - np.exp(-3)), "-", color=BLUE, label="fitted, $\\rho\\,\\Delta T = 3$")
    axes.set(xlim=(-0.04, 1.04), ylim=(-0.06, 1.1), xticks=[0, 1], yticks=[0, 1], yticklabels=["$F_n$", "$F$"],
             xticklabels=["start of the step", "end of the step"], ylabel="force")
    axes.legend(loc="center left", bbox_to_anchor=(1.02, 0.5), fontsize=9)
    return figure


def zones_and_contacts():
    """Zones of two blocks, drawn apart; contacts between split gridpoints."""
    figure, axes = plt.subplots(figsize=(7, 3.4))
    without_frame(axes, (-1.2, 9.4), (-2.7, 3.1))
    x, gap = np.array([0, 2, 4, 6]), 0.7
    top, bottom = np.array([1, 3, 5]), np.array([1, 3, 5])
    for side, middle in ((1, top), (-1, bottom)):
        y0, y1 = side * gap / 2, side * (gap / 2 + 1.6)
        points = [(a, y0) for a in x] + [(a, y1) for a in middle]
        triangles = [(0, 1, 4), (1, 2, 5), (2, 3, 6), (1, 5, 4), (2, 6, 5)]
        for triangle in triangles:
            axes.add_patch(plt.Polygon([points[i] for i in triangle], facecolor=ROCK, edgecolor=BLUE, lw=0.9))
        axes.plot([a for a, _ in points], [b for _, b in points], "o", color=BLUE, ms=4.5)
    for a in x:
        axes.plot([a, a], [-gap / 2, gap / 2], ":", color=RED, lw=2)
    arrow(axes, (1, -0.02), (3, -0.02), "<->", RED)
    axes.text(2.5, 0.04, "$l$", ha="center", va="bottom", color=RED)
    axes.text(6.3, gap / 2 + 0.9, "side b: zones of one block", va="center", fontsize=9)
    axes.text(6.3, -gap / 2 - 0.9, "side a: zones of the other block", va="center", fontsize=9)
    axes.annotate("contact: normal and shear\nspring between the two\ngridpoints of a split pair", (6, 0), (7, 0), va="center", fontsize=9,
                  arrowprops={"arrowstyle": "-", "color": RED, "lw": 0.8}, color=RED)
    arrow(axes, (-0.75, -0.35), (-0.75, 0.75), "->")
    axes.text(-0.75, 0.9, "$n$", ha="center")
    axes.text(3, 2.55, "gridpoints (dots) on a joint are split; the gap is drawn only to show them;\n$l$ is the contact length of a contact", ha="center", fontsize=9)
    return figure


def problem(axes, name, title, window=None):
    """The scene of a problem: rock, joints, excavation, fixed borders, loads and monitoring points."""
    scene = tomllib.loads((DATA / name / "scene.toml").read_text())
    outline = np.array(scene["section"]["outline_m"], float)
    axes.add_patch(plt.Polygon(outline, facecolor=ROCK, edgecolor="none"))
    for hole in scene["section"].get("holes_m", []):
        axes.add_patch(plt.Polygon(hole, facecolor="white", edgecolor=GREY, lw=0.6))
    for stage in scene.get("stage", []):
        for polygon in stage["remove_m"]:
            axes.add_patch(plt.Polygon(polygon, facecolor="white", edgecolor=GREY, lw=0.6, ls="--", hatch="///", alpha=0.8))
    axes.add_patch(plt.Polygon(outline, facecolor="none", edgecolor="black", lw=0.8))
    for joint in scene.get("joint", []):
        axes.plot(*zip(joint["from_m"], joint["to_m"]), "-", color=BLUE, lw=1)
    size = np.ptp(outline, axis=0).max() if window is None else window[1] - window[0]
    for border in scene["boundary"]:
        ends = np.array([border["from_m"], border["to_m"]], float)
        if "fix" in border:
            axes.plot(*ends.T, "-", color="black", lw=2.5)
        if "joint" in border:
            axes.plot(*ends.T, "-", color=BLUE, lw=2.5)
        load = np.array(border.get("traction_MPa", border.get("displacement_mm", [0, 0])), float)
        if load.any():
            step = 0.14 * size * load / np.hypot(*load)
            axes.annotate("", ends.mean(axis=0), ends.mean(axis=0) - step, arrowprops={"arrowstyle": "->", "color": RED, "lw": 1.4})
    for point in scene.get("point", []):
        axes.plot(*point["at_m"], "o", color=GREEN, ms=2.5)
    axes.set_aspect("equal")
    axes.set_title(title, pad=14)
    if window:
        axes.set(xlim=window[:2], ylim=window[2:])
    else:
        axes.margins(0.12)
    axes.axis("off")


def problems():
    """Scenes of data/verification, each to its own scale."""
    figure, places = plt.subplots(3, 4, figsize=(9, 7))
    for axes, arguments in zip(places.flat, PROBLEMS):
        problem(axes, *arguments)
    return figure


PROBLEMS = [("column", "column"), ("verification/platens", "platens"), ("verification/two-pillars", "two pillars"),
            ("verification/incline", "incline"), ("verification/layered-mass", "layered mass"),
            ("verification/v-groove", "wedge in a groove"), ("verification/hole", "hole in a plate", (-0.2, 3, -0.2, 3)),
            ("verification/plane-of-weakness", "plane of weakness"), ("verification/roof-wedge", "roof wedge"),
            ("verification/toppling-columns", "toppling columns"), ("verification/slipping-crack", "slipping crack"),
            ("verification/sheared-layers", "layered rock in shear")]
DATA = Path(__file__).resolve().parents[1] / "data"

FIGURES = {"joint-line": joint_line, "coulomb": coulomb, "kelvin": kelvin, "schemes": schemes,
           "zones-contacts": zones_and_contacts, "problems": problems}


def main():
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent / "pictures"
    for name, draw in FIGURES.items():
        figure = draw()
        figure.savefig(folder / f"concept-{name}.svg", metadata={"Date": None, "Creator": None})
        plt.close(figure)


if __name__ == "__main__":
    main()
