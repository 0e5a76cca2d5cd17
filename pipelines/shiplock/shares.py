#!/usr/bin/python3
"""33 assumed inputs of the shiplock at once, and the network: whose variance is it?

    shares.py PROGRAMS SCENE.toml TARGETS.toml -n SETS [-j JOBS] -o OUT

SETS sets of the inputs below are drawn by a scrambled Sobol sequence, each evenly in its range (those given as factors in the
logarithm), and each is computed with two networks that no other run has. Quantities are the mean total and the mean recorded
displacement of the points below the crest, and the misfit of the run.

The share of the network in all is half the mean square of the differences of the pairs, over the variance (Jansen). Other
shares are of a polynomial fitted to the pairs' means of the logarithms of every total and record, with linear terms, squares and
products as long as they make the error of sets left out smaller. From it, with the pairs' own differences as the
network's deviations, come totals, records and misfit of as many samples as wanted, and their indices (Saltelli, Jansen).
Standard errors are by leaving out one in twenty of the sets after the other (jackknife). An input without a term has the share
0: it is too small to be seen. What the polynomial does not explain, and the network does not either, is the
lack of fit.

The runs are those of a study (jointcreep study): the inputs are [variables] of a scene, of which its keys have formulas, and the
design is a table. In OUT it writes scene, points and study, shares.md, shares.csv, shares.png and ridge.png; the runs are in
OUT/study. Blocks and zones are coarser than the scene's: COARSE.
"""

import argparse
import csv
import datetime
import io
import math
import pathlib
import subprocess
import sys
import tempfile
import tomllib
from dataclasses import dataclass

import matplotlib.colors
import numpy as np
from scipy.stats import qmc

import jointcreep
import records
import study
import variant
from jointcreep import files, scene_keys
from jointcreep.chain import run
from records import figure

HERE = pathlib.Path(__file__).resolve().parent
COARSE = ["--cutting", "2", "5", "--zone-size", "12", "--creep-step", "60", "--end", "1999-12-31"]
SEED = 24
SETS = ("J1", "J2", "J3", "J4")


@dataclass(frozen=True)
class Input:
    name: str  # in tables
    low: float
    high: float
    unit: str = ""  # a factor has none, and is even in its logarithm
    own: float = 1  # the scene's

    def value(self, share):
        """At a share of the range, from 0 to 1."""
        return self.low + share * (self.high - self.low) if self.unit else self.low * (self.high / self.low) ** share

    def share(self, value):
        if self.unit:
            return (value - self.low) / (self.high - self.low)
        return math.log(value / self.low) / math.log(self.high / self.low)


INPUTS = {
    "tectonic": Input("stress at depth, tectonic part", 1.5, 4.5, "MPa", 3),
    "gradient": Input("stress, gradient", 0.018, 0.026, "MPa/m", 0.022),
    "decay": Input("depth of decay of the tectonic stress", 5, 40, "m", 20),
    "spacing": Input("spacing of all sets, times", 0.75, 1.4),
    **{f"spacing_{name}": Input(f"spacing of {name} alone, times", 0.67, 1.5) for name in SETS},
    **{f"dip_{name}": Input(f"dip of {name}", -10, 10, "deg", 0) for name in SETS},
    **{f"direction_{name}": Input(f"dip direction of {name}", -15, 15, "deg", 0) for name in SETS},
    "scatter": Input("scatter of dip and direction, times", 0.5, 1.5),
    "persistence": Input("persistence, times", 0.67, 1.5),
    "stiffness": Input("K over its rule K/k, times", 0.5, 2),
    "kelvin": Input("E over K, times", 0.5, 2),
    "time": Input("time of creep eta/E, times", 0.5, 2),
    "cohesion": Input("cohesion of joints, times", 0.5, 2),
    "friction": Input("friction angle of joints", 30, 40, "deg", 35),
    "bridges": Input("cohesion of rock bridges, times", 0.67, 1.5),
    "tension": Input("tensile strength of rock bridges, times", 0.67, 1.5),
    "cover": Input("thickness of the cover", 13, 20, "m", 17),
    "weak": Input("thickness of the weak rock", 10, 20, "m", 15),
    "box": Input("jointed box, to each side", 150, 330, "m", 220),
    "domain": Input("domain, to each side", 900, 3600, "m", 1800),
    "rock": Input("Young's modulus of the rock, in Table 1's ranges", 0, 1, "of 1", 0.5),
    "azimuth": Input("azimuth of the section", 11, 31, "deg", 21),
    "dates": Input("days of all stages", -60, 60, "days", 0),
    "readings": Input("days of first readings", -60, 60, "days", 0),
}


# --- The runs -----------------------------------------------------------------------------------------------------------------

SHIFTED = {"-1800": "-domain", "1800": "domain", "-1000": "200 - domain * 2 / 3"}  # coordinates at sides and base of the section
BEHIND = 300  # above the ground everywhere [m]: a joint set's region is cut off at the outline


def placed(value):
    """Coordinates, where those of sides and base follow the domain."""
    return [placed(one) for one in value] if isinstance(value, list) else SHIFTED.get(f"{value:g}", value)


def at_depth(ground, depth):
    """A rock above a depth: the ground, and the line below it."""
    return placed(ground) + [[x, f"{y!r} - ({depth})"] for x, y in reversed(placed(ground))]


def horizontal_stress(depth):
    """The formula of variant.horizontal_stress() [MPa]."""
    return f"tectonic * (1 - exp(-({depth}) / decay)) + gradient * ({depth})"


def stress_profile(scene):
    """sigma_x by its law, sigma_y the weight; levels at the bottoms of cover and weak rock, too."""
    density = {rock["name"]: rock["density_kg_per_m3"] for rock in scene["rock"]}
    gravity = scene["section"]["gravity_m_per_s2"]
    levels = []
    for h in (0, 5, 10, "cover", "cover + weak", 50, 75, 100, 150, 300):
        weight = (f"{density['cover']} * min({h}, cover) + {density['weak']} * min(max({h} - cover, 0), weak) "
                  f"+ {density['fresh']} * max({h} - cover - weak, 0)")
        levels.append({"depth_m": h, "compression_xx_MPa": horizontal_stress(h),
                       "compression_yy_MPa": f"{1e-6 * gravity!r} * ({weight})", "shear_xy_MPa": 0})
    return levels


def with_variables(text):
    """The scene with formulas of the inputs, which are its [variables], as TOML."""
    scene = tomllib.loads(text)
    start, ground = scene["schedule"]["start"], scene["in_situ_stress"]["ground_m"]
    scene["variables"] = {key: one.own for key, one in INPUTS.items()}

    def change(table, key, formula):
        """formula: with {} where the scene's own value is."""
        if key in table:
            value = table[key]
            table[key] = formula.format((value - start).days if isinstance(value, datetime.date) else repr(value))

    section = scene["section"]
    section.update(outline_m=placed(section["outline_m"]), azimuth_deg="azimuth")
    for rock in scene["rock"]:
        change(rock, "cohesion_MPa", "{} * bridges")
        change(rock, "tensile_strength_MPa", "{} * tension")
        if rock["name"] in variant.YOUNGS_MODULI:
            low, high = variant.YOUNGS_MODULI[rock["name"]]
            rock["youngs_modulus_GPa"] = f"{low} + rock * {high - low}"
    for region in scene["region"]:
        region["outline_m"] = at_depth(ground, "cover" if region["rock"] == "cover" else "cover + weak")
    for material in scene["joint_material"]:
        for key in variant.SPRINGS:
            change(material, key, "{} * stiffness / persistence")
        for key in variant.KELVIN:
            change(material, key, "{} * stiffness / persistence * kelvin" + " * time" * ("viscosity" in key))
        change(material, "cohesion_MPa", "{} * cohesion")
        material["friction_angle_deg"] = "friction"
    for one in scene["joint_set"]:
        change(one["spacing"], "mean_m", f"{{}} * spacing * spacing_{one['name']}")
        for key, words in (("dip", "dip"), ("dip_direction", "direction")):
            change(one[key], "mean_deg", f"{{}} + {words}_{one['name']}")
            change(one[key], "deviation_deg", "{} * scatter")
        change(one, "persistence", "{} * persistence")
        bottom = "60 - 0.5 * (box - 220)"  # about the extents of study.py
        one["region_m"] = [["-box", bottom], ["box", bottom], ["box", BEHIND], ["-box", BEHIND]]
    scene["in_situ_stress"].update(ground_m=placed(ground), profile=stress_profile(scene))
    for boundary in scene["boundary"]:
        boundary.update(from_m=placed(boundary["from_m"]), to_m=placed(boundary["to_m"]))
    for stage in scene["stage"]:
        change(stage, "date", "{} + dates")
    for point in scene["point"]:
        change(point, "first_reading", "{} + readings")
    return scene_keys.toml_text(scene)


def shares_of_range(number):
    """[set, input], from 0 to 1; the first sets do not depend on their number."""
    return qmc.Sobol(len(INPUTS), seed=SEED).random_base2(math.ceil(math.log2(number)))[:number]


def values_of_set(row):
    return {key: one.value(share) for (key, one), share in zip(INPUTS.items(), row)}


def table_of(rows):
    """The design as CSV: runs 2 i and 2 i + 1 are those of set i, on networks of these numbers."""
    return files.csv_text(["network", *INPUTS], [[2 * place + which, *values_of_set(row).values()] for place, row in enumerate(rows)
                                                 for which in range(2)])


QUANTITIES = (("total", "in situ"), ("recorded", "first reading"))


def study_of(points, end):
    """The study file: displacements of the points across the lock at the end of the records."""
    vary = "".join(f'\n[[vary]]\nname = "{key}"\nkey = "variables.{key}"\n' for key in INPUTS)
    collect = "".join(f'\n[[collect]]\nname = "{name} {point}"\nwhat = "displacement"\npoint = "{point}"\ncomponent = "x"\n'
                      f'since = "{since}"\ndate = {end}\n' for name, since in QUANTITIES for point in points)
    return f'scene = "scene.toml"\n\n[[vary]]\nnetwork = true\n{vary}\n[design]\nkind = "table"\nfile = "points.csv"\n{collect}'


def runs_of(arguments, points, end):
    """Rows of the design, and the table of its runs, by `jointcreep study`."""
    rows = shares_of_range(arguments.sets)
    arguments.output.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="jointcreep-") as folder:
        base = pathlib.Path(folder) / "base.toml"
        run(sys.executable, HERE / "variant.py", arguments.scene, *COARSE, "-o", base)
        files.write_text(arguments.output / "scene.toml", with_variables(base.read_text(encoding="utf-8")))
    files.write_text(arguments.output / "points.csv", table_of(rows))
    files.write_text(arguments.output / "study.toml", study_of(points, end))
    out = arguments.output / "study"
    subprocess.run([arguments.programs / "jointcreep", "study", arguments.output / "study.toml", "-o", out, "-j", str(arguments.jobs)],
                   check=True)
    return rows, jointcreep.read(out).runs


# --- The fit ------------------------------------------------------------------------------------------------------------------


def legendre(rows):
    """Of degree 1 and 2, each of variance 1 over the range; [row, input]."""
    x = 2 * rows - 1
    return math.sqrt(3) * x, math.sqrt(5) * (3 * x * x - 1) / 2


def columns_of(rows, terms):
    """A 1, then the terms: (i,) linear, (i, i) the square, (i, j) the product of two."""
    one, two = legendre(rows)
    return np.column_stack([np.ones(len(rows)), *(one[:, term[0]] if len(term) == 1 else two[:, term[0]] if term[0] == term[1]
                                                  else one[:, term[0]] * one[:, term[1]] for term in terms)])


def error_left_out(columns, values):
    """Mean square of the errors at rows left out one by one, summed over quantities of variance 1."""
    q, _ = np.linalg.qr(columns)
    leverage = np.minimum((q * q).sum(axis=1), 1 - 1e-9)
    return float(np.sum(np.mean(((values - q @ (q.T @ values)) / (1 - leverage)[:, None]) ** 2, axis=0)))


def terms_of(rows, values, most=12):
    """Terms, one by one, that make the error of rows left out smallest, as long as it becomes 3 percent smaller: linear ones, then
    squares and products of the inputs that these have."""
    values = (values - values.mean(axis=0)) / values.std(axis=0)
    terms = []

    def chosen(wanted, most):
        error = error_left_out(columns_of(rows, terms), values)
        while wanted and len(terms) < min(most, len(rows) // 2):
            errors = [error_left_out(columns_of(rows, [*terms, term]), values) for term in wanted]
            best = int(np.argmin(errors))
            if errors[best] > 0.97 * error:
                return
            error = errors[best]
            terms.append(wanted.pop(best))

    chosen([(i,) for i in range(rows.shape[1])], rows.shape[1])
    first = sorted(i for i, in terms)
    chosen([(i, j) for i in first for j in first if i <= j], len(terms) + most)
    return terms


def halves(values):
    """Means over the points [..., total or record], of [..., quantity]: totals, then records."""
    half = values.shape[-1] // 2
    return np.stack([values[..., :half].mean(axis=-1), values[..., half:].mean(axis=-1)], axis=-1)


@dataclass
class Fit:
    """Logarithms of totals and records of a network, at any point of the inputs."""
    terms: list
    coefficients: np.ndarray  # [term, quantity]
    deviations: np.ndarray  # of a network from the mean of networks: [number, quantity]

    def __call__(self, rows, network):
        """[row, quantity] in mm; network: from 0 to 1, which of the deviations."""
        which = np.minimum((network * len(self.deviations)).astype(int), len(self.deviations) - 1)
        return np.exp(columns_of(rows, self.terms) @ self.coefficients + self.deviations[which])


def fit_of(rows, pairs):
    """pairs: [set, network of two, quantity] in mm."""
    logs = np.log(pairs)
    means = logs.mean(axis=1)
    terms = terms_of(rows, halves(means))
    coefficients = np.linalg.lstsq(columns_of(rows, terms), means, rcond=None)[0]
    half_differences = (logs[:, 0] - logs[:, 1]) / math.sqrt(2)
    return Fit(terms, coefficients, np.concatenate([half_differences, -half_differences]))


def answers_of(values, targets):
    """[row, total, recorded and misfit] of [row, quantity]: totals, then records, of the points below the crest."""
    half = values.shape[1] // 2
    parts = values[:, :half], values[:, half:]
    return np.column_stack([*(part.mean(axis=1) for part in parts), records.misfits(parts, targets)])


def indices_of(model, inputs, power, seed=1):
    """First-order and total indices [first or total, input, answer] of model(samples), by 2^power samples of a Sobol sequence."""
    samples = qmc.Sobol(2 * inputs, seed=seed).random_base2(power)
    a, b = samples[:, :inputs], samples[:, inputs:]
    at_a, at_b = model(a), model(b)
    variance = np.concatenate([at_a, at_b]).var(axis=0)
    indices = np.empty((2, inputs, at_a.shape[1]))
    for i in range(inputs):
        mixed = a.copy()
        mixed[:, i] = b[:, i]
        at_mixed = model(mixed)
        indices[0, i] = ((at_b - at_b.mean(axis=0)) * (at_mixed - at_a)).mean(axis=0) / variance
        indices[1, i] = ((at_a - at_mixed) ** 2).mean(axis=0) / (2 * variance)
    return indices


def shares(rows, pairs, targets, power=12):
    """Indices of all inputs, the network last: [first or total, input, answer]; and the fit."""
    fit = fit_of(rows, pairs)
    number = rows.shape[1]
    return indices_of(lambda x: answers_of(fit(x[:, :number], x[:, number]), targets), number + 1, power), fit


def straight(pairs, targets):
    """Of the runs themselves: [mean, standard deviation, total share of the network] of the answers."""
    answers = answers_of(pairs.reshape(-1, pairs.shape[2]), targets)
    each = answers.reshape(len(pairs), 2, -1)
    return np.stack([answers.mean(axis=0), answers.std(axis=0, ddof=1),
                     ((each[:, 0] - each[:, 1]) ** 2).mean(axis=0) / 2 / answers.var(axis=0, ddof=1)])


def errors_of(statistic, number, groups=20):
    """Standard errors of statistic(places of sets), by leaving out one group of sets after the other (jackknife)."""
    groups = min(groups, number)
    found = [statistic(np.flatnonzero(np.arange(number) % groups != left)) for left in range(groups)]
    return np.sqrt((groups - 1) * np.var(found, axis=0))


def lack_of_fit(rows, pairs, folds=10):
    """Share of the variance of the logarithms, of the mean total and the mean record, that neither polynomial nor network
    explains: the mean square of the pair means' errors at a tenth of the sets, by a polynomial whose terms and coefficients are of the
    others, less half the networks' variance."""
    both = halves(np.log(pairs))  # [set, network, total or record]
    means, errors = both.mean(axis=1), np.empty((len(rows), 2))
    for fold in range(folds):
        left = np.arange(len(rows)) % folds == fold
        fit = fit_of(rows[~left], pairs[~left])
        errors[left] = means[left] - halves(columns_of(rows[left], fit.terms) @ fit.coefficients)
    networks = ((both[:, 0] - both[:, 1]) ** 2).mean(axis=0) / 2
    return ((errors**2).mean(axis=0) - networks / 2) / both.reshape(-1, 2).var(axis=0, ddof=1)


# --- What it shows ------------------------------------------------------------------------------------------------------------

ANSWERS = ("mean total", "mean recorded", "misfit")


SMALL = 0.005  # a total share below it, of all three answers, has no row


def by_size(indices):
    """Numbers of the inputs, the largest total shares of total and record first."""
    return np.argsort(-indices[1, :, :2].sum(axis=1), kind="stable")


def markdown(names, indices, errors, facts):
    """A row for each input; those whose shares are small only by name."""
    order = by_size(indices)
    is_small = (indices[1] < SMALL).all(axis=1)
    lines = ["| input | range | " + " | ".join(f"{answer}: alone | in all" for answer in ANSWERS) + " |", "|---|---|" + "---|" * 6]
    for i in order[~is_small[order]]:
        name, span = names[i]
        cells = [f"{indices[j, i, k]:.3f} ± {errors[j, i, k]:.3f}" for k in range(3) for j in range(2)]
        lines.append(f"| {name} | {span} | " + " | ".join(cells) + " |")
    small = "; ".join(f"{names[i][0]} ({names[i][1]})" for i in order[is_small[order]])
    if small:
        lines += ["", f"Without a term in the polynomial, or with shares below {SMALL}: {small}."]
    return "\n".join([*lines, "", *facts]) + "\n"


def range_of(one):
    if one.unit == "of 1":
        return "20 to 40 GPa (fresh), 12 to 17 GPa (weak)"
    change = one.unit in ("deg", "days") and one.own == 0
    return f"{one.low:{'+' if change else ''}g} to {one.high:{'+' if change else ''}g}{' ' + one.unit if one.unit else ''}"


def picture(names, indices, errors, path, most=16):
    order = by_size(indices)[:most][::-1]
    plot, panels = figure.plt.subplots(1, 3, sharey=True, figsize=(figure.TWO_COLUMNS, 0.8 + 0.19 * len(order)))
    for k, (axes, answer) in enumerate(zip(panels, ANSWERS)):
        for j, (shift, color, label) in enumerate(((0.2, figure.COLORS[4], "alone (first order)"),
                                                   (-0.2, figure.COLORS[0], "in all (total)"))):
            axes.barh(np.arange(len(order)) + shift, indices[j, order, k], 0.38, xerr=errors[j, order, k], color=color, label=label,
                      error_kw={"linewidth": 0.6, "ecolor": "#555555"})
        axes.set_xlabel(f"share of {answer}")
        axes.set_xlim(left=min(0, axes.get_xlim()[0]))
        axes.tick_params(axis="y", length=0)
    panels[0].set_yticks(range(len(order)), [names[i][0] for i in order], fontsize=6)
    panels[2].legend(loc="lower right")
    figure.save(plot, path)


def stress_60(values):
    """Horizontal stress 60 m below the ground [MPa]."""
    return variant.horizontal_stress(60, values["tectonic"], values["gradient"], values["decay"])


def ridge(rows, pairs, fit, targets, path):
    """Misfit over horizontal stress and joint stiffness times spacing: of the runs, and of the polynomial with all other inputs
    as in the scene."""
    keys = list(INPUTS)
    values = [values_of_set(row) for row in rows]
    stiffness = np.array([v["stiffness"] / v["persistence"] * v["spacing"] for v in values])
    stress = np.array([stress_60(v) for v in values])
    misfit = answers_of(np.exp(np.log(pairs).mean(axis=1)), targets)[:, 2]
    plot, (left, right) = figure.plt.subplots(1, 2, figsize=(figure.TWO_COLUMNS, 2.9), sharey=True)
    limits = [0.25, 0.5, 1, 2, 4, 8, 16]
    colors = matplotlib.colors.BoundaryNorm(limits, 256, extend="both")
    order = np.argsort(-misfit)  # small ones on top
    dots = left.scatter(stiffness[order], stress[order], c=misfit[order], norm=colors, cmap="viridis", s=14, edgecolor="k", linewidth=0.3)
    left.set_xlabel("joint stiffness times spacing, over the scene's")
    left.set_ylabel("horizontal stress 60 m below the ground (MPa)")
    left.set_title("runs: all inputs changed")
    own = np.array([one.share(one.own) for one in INPUTS.values()])
    i, j = keys.index("stiffness"), keys.index("tectonic")
    x, y = np.meshgrid(np.linspace(0, 1, 41), np.linspace(0, 1, 41))
    grid = np.tile(own, (x.size, 1))
    grid[:, i], grid[:, j] = x.ravel(), y.ravel()
    at = np.exp(columns_of(grid, fit.terms) @ fit.coefficients)
    found = answers_of(at, targets)
    scene = {key: one.own for key, one in INPUTS.items()}
    across = [INPUTS["stiffness"].value(one) for one in x[0]]
    up = [stress_60({**scene, "tectonic": INPUTS["tectonic"].value(one)}) for one in y[:, 0]]
    right.contourf(across, up, found[:, 2].reshape(x.shape), limits, norm=colors, cmap="viridis", extend="both")
    lines = right.contour(across, up, found[:, 0].reshape(x.shape), [45, 60, 75, 90, 120], colors="w", linewidths=0.8)
    right.clabel(lines, fmt="%g mm", fontsize=6)
    right.plot(1, stress_60(scene), "k*", markersize=7)
    right.set_xlabel("joint stiffness, over the scene's")
    right.set_title("polynomial: others as in the scene; mean total")
    for axes in (left, right):
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter(matplotlib.ticker.ScalarFormatter())
        axes.xaxis.set_minor_formatter(matplotlib.ticker.NullFormatter())
        axes.set_xticks([0.5, 1, 2])
    plot.colorbar(dots, ax=[left, right], label="misfit", ticks=limits)
    figure.save(plot, path)
    small = misfit < np.quantile(misfit, 0.2)
    return (float(np.corrcoef(np.log(stiffness), np.log(stress))[0, 1]),
            float(np.corrcoef(np.log(stiffness[small]), np.log(stress[small]))[0, 1]), int(small.sum()))


def pairs_of(runs, points, positions):
    """Places of the sets with two results, and [set, network, quantity] of the runs: totals, then records, of these points, toward the
    lock. A run without equilibrium, or in which a point is excavated with its rock, has none."""
    toward = [-math.copysign(1, positions[point]) for point in points] * 2
    values = np.array([runs[f"{name} {point} (mm)"] for name, _ in QUANTITIES for point in points]).T * toward
    pairs = values.reshape(-1, 2, values.shape[1])
    kept = np.flatnonzero((pairs > 0).all(axis=(1, 2)))
    return kept, pairs[kept]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("scene", type=pathlib.Path)
    parser.add_argument("targets", type=pathlib.Path)
    parser.add_argument("-n", "--sets", type=int, default=128, help="of inputs, two runs each")
    parser.add_argument("-j", "--jobs", type=int, default=1)
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    targets = records.targets_of(arguments.targets)
    scene = tomllib.loads(arguments.scene.read_text(encoding="utf-8"))
    names = [point["name"] for point in scene["point"]]
    points = [names[place] for place in study.below_the_crest(arguments.scene, targets)[0]]
    rows, runs = runs_of(arguments, points, targets["end_of_record"])
    kept, pairs = pairs_of(runs, points, {point["name"]: point["at_m"][0] for point in scene["point"]})
    rows = rows[kept]
    if len(rows) < 10:
        sys.exit(f"shares.py: {len(rows)} sets have two results; at least 10 are wanted, a larger --sets")

    indices, fit = shares(rows, pairs, targets)
    errors = errors_of(lambda which: shares(rows[which], pairs[which], targets, power=10)[0], len(rows))
    own, own_errors = straight(pairs, targets), errors_of(lambda which: straight(pairs[which], targets), len(rows))
    lack = lack_of_fit(rows, pairs)

    names = [(one.name, range_of(one)) for one in INPUTS.values()] + [("network", "two for each set of values")]
    told = ridge(rows, pairs, fit, targets, arguments.output / "ridge.png")
    number, failed = len(runs["run"]), int((runs["exit code"] != 0).sum())
    factor = [f"({name.removesuffix(', times')})" for name, _ in names]
    more = [f"{factor[i]}²" if i == j else f"{factor[i]} · {factor[j]}" for i, j in (term for term in fit.terms if len(term) == 2)]
    facts = [
        f"{number} runs, two networks for each of {number // 2} sets of values; {failed} runs without equilibrium; {len(rows)} sets with two "
        "results are used.",
        "Mean and standard deviation: " + "; ".join(
            f"{name} {own[0, k]:.1f} and {own[1, k]:.1f}{' mm' if k < 2 else ''}" for k, name in enumerate(ANSWERS)) + ".",
        "The network's total share (*in all*), computed without the polynomial, from the differences of the pairs of runs: " + ", ".join(
            f"{own[2, k]:.3f} ± {own_errors[2, k]:.3f} ({name})" for k, name in enumerate(ANSWERS)) + ".",
        "Share of the variance of the logarithm of each result that neither polynomial nor network explains (lack of fit): "
        f"{lack[0]:.3f} (mean total), {lack[1]:.3f} (mean recorded).",
        "Squares and products in the polynomial: " + ("; ".join(more) or "none") + ".",
        f"Logarithms of stress, and of joint stiffness times spacing: their correlation is {told[0]:.2f} in all sets. In the {told[2]} sets "
        f"that fit best it is {told[1]:.2f}.",
    ]
    files.write_text(arguments.output / "shares.md", markdown(names, indices, errors, facts))
    picture(names, indices, errors, arguments.output / "shares.png")
    text = io.StringIO()
    out = csv.writer(text, lineterminator="\n")
    out.writerow(["input", "answer", "first_order", "first_order_error", "total", "total_error"])
    for i, (name, _) in enumerate(names):
        for k, answer in enumerate(ANSWERS):
            out.writerow([name, answer, *(f"{value:.4f}" for j in range(2) for value in (indices[j, i, k], errors[j, i, k]))])
    files.write_text(arguments.output / "shares.csv", text.getvalue())


if __name__ == "__main__":
    main()
