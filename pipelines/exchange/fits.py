"""Are laws found back from windows that cut their traces?  fits.py PROGRAMS OUT [--n WINDOWS]

jointgen makes many sections of each of some sets, whose traces the section cuts. Each is fitted as `jointcreep fit` does. A row a constant: the
truth, the median fit, the share of 95 percent intervals that contain the truth, and the same of the naive fit, which takes every length
seen as whole and every trace as met alike. Ends with exit code 1 where the share is off by more than three binomial standard errors.
"""

import argparse
import math
import pathlib
import sys

import h5py
import numpy as np

from jointcreep import chain, files, length_laws, orientation_laws, traces

WINDOW = [[0, 0], [30, 0], [30, 20], [0, 20]]  # m
ANGLE = {"mean_deg": 50, "deviation_deg": 12}
P20 = 0.12  # 1/m2
# law, its constants in the scene, shortest length mapped [m]
SETS = [(length_laws.exponential(), {"mean_m": 8}, 0), (length_laws.exponential(), {"mean_m": 20}, 2),
        (length_laws.lognormal(), {"mean_m": 8, "deviation_m": 5}, 0), (length_laws.normal(), {"mean_m": 10, "deviation_m": 2}, 0),
        (length_laws.power(2, 40), {"exponent": 2.5, "shortest_m": 2, "longest_m": 40}, 2)]


def keys(values):
    return ", ".join(f"{name} = {value!r}" for name, value in values.items())


def scene(law, constants):
    return f"""[section]
outline_m = {WINDOW}
rock = "rock"
gravity_m_per_s2 = 9.81
[[rock]]
name = "rock"
density_kg_per_m3 = 2700
youngs_modulus_GPa = 30
poissons_ratio = 0.25
[[joint_material]]
name = "joint"
normal_stiffness_MPa_per_m = 5000
shear_stiffness_MPa_per_m = 2000
cohesion_MPa = 0.2
friction_angle_deg = 35
tensile_strength_MPa = 0
[[joint_set]]
name = "set"
material = "joint"
kind = "segments"
trace_angle = {{ law = "normal", {keys(ANGLE)} }}
length = {{ law = "{law.word}", {keys(constants)} }}
density = {{ P20_per_m2 = {P20} }}
[in_situ_stress]
elevation_m = 20
compression_xx_MPa = 0
compression_yy_MPa = 0
shear_xy_MPa = 0
compression_xx_gradient_MPa_per_m = 0.013
compression_yy_gradient_MPa_per_m = 0.026487
shear_xy_gradient_MPa_per_m = 0
[[boundary]]
from_m = [0, 0]
to_m = [30, 0]
fix = "xy"
[schedule]
end = 1
[zones]
size_m = 5
[equilibrium]
tolerance = 1e-5
[random]
seed = 2003
"""


def seen_in(programs, path, network, realization, shortest):
    chain.run(programs / "jointgen", path, "-q", "--realization", realization, "-o", network)
    with h5py.File(network) as file:
        return traces.Seen(traces.Window(WINDOW), file["/joints/from"][:], file["/joints/to"][:], 0.0, shortest)


def rows_of(law, constants, seen):
    """Of one window: {name: (truth, fit, interval, naive fit, interval)}."""
    found, naive = length_laws.fit(law, seen), length_laws.fit(law, seen, length_laws.naive_log_likelihoods)
    none = (math.nan, math.nan)
    rows = {}
    for i, name in enumerate(law.constants):
        rows[name] = (constants[name], *((one.constants[i], one.intervals[i]) if one else (math.nan, none) for one in (found, naive)))
    if found:
        p20, p21, interval = length_laws.density(found, seen)
        truth = P20 * law.mean([constants[name] for name in law.constants])
        rows["P21_per_m"] = (truth, (p21, interval), (math.nan, none))
        shortest = np.array([seen.shortest])
        chance = seen.chord_area * law.survival(found.constants, shortest) + seen.chord_width * law.beyond(found.constants, shortest)
        angle = orientation_laws.trace_angle(seen, chance)
        rows["trace angle, mean_deg"] = (ANGLE["mean_deg"], (angle.mean, angle.mean_interval), (math.nan, none))
        rows["trace angle, deviation_deg"] = (ANGLE["deviation_deg"], (angle.deviation, angle.deviation_interval), (math.nan, none))
    return rows


def share_held(rows, which):
    """How often the interval holds the truth; windows without a fit do not."""
    return sum(row[which][1][0] <= row[0] <= row[which][1][1] for row in rows) / len(rows)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--n", type=int, default=500)
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    lines = ["| law | shortest mapped, m | traces seen, whole | constant | truth | median fit | intervals that contain it | naive fit | its intervals "
             "| |", "|---|---|---|---|---|---|---|---|---|---|"]
    failed = False
    for law, constants, shortest in SETS:
        path = given.out / "fits.toml"
        path.write_text(scene(law, constants))
        windows = [seen_in(given.programs, path, given.out / "fits.h5", r, shortest) for r in range(given.n)]
        of_windows = [rows_of(law, constants, seen) for seen in windows]
        counts = f"{np.mean([len(seen) for seen in windows]):.0f}, {np.mean([(seen.cut_ends == 0).sum() for seen in windows]):.0f}"
        for name in max(of_windows, key=len):
            rows = [of_window[name] for of_window in of_windows if name in of_window]
            share = share_held(rows, 1) * len(rows) / given.n
            is_right = abs(share - 0.95) <= 3 * math.sqrt(0.95 * 0.05 / given.n)
            failed |= not is_right
            has_naive = not math.isnan(rows[0][2][0])
            naive = f"{np.nanmedian([row[2][0] for row in rows]):.3g} | {share_held(rows, 2):.3f}" if has_naive else "- | -"
            lines.append(f"| {law.word} | {shortest} | {counts} | {name} | {rows[0][0]:.3g} | {np.nanmedian([row[1][0] for row in rows]):.3g} | "
                         f"{share:.3f} | {naive} | {'' if is_right else 'OFF'} |")
            print(lines[-1], flush=True)
    files.write_text(given.out / "fits.md", "\n".join(lines) + "\n")
    sys.exit(failed)


if __name__ == "__main__":
    main()
