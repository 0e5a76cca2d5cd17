#!/usr/bin/python3
"""The probability that a block on a plane slides, by directional sampling, beside its closed form.

    plane.py PROGRAMS OUT [--directions 40] [--replicates 10] [--jobs 1]

The block is that of data/verification/incline: a face that dips b = 25 degrees carries a load of 1 MPa straight down. It slides if
sin b > c + cos b tan(phi), in MPa. The friction angle phi is normal, the cohesion c lognormal; the probability is the integral over c
of the normal distribution of phi. Runs of plain sampling that would give as narrow an interval: p (1 - p) over the squared standard
error. The exit code is 1 if the closed form is not within the interval.
"""

import argparse
import math
import pathlib
import subprocess
import sys

import jointcreep
from scipy import integrate, stats

ROOT = pathlib.Path(__file__).resolve().parents[2]
DIP = math.radians(25)
FRICTION = {"mean": 31.8, "deviation": 2.5}  # degrees
COHESION = {"mean": 0.02, "deviation": 0.01}  # MPa
STUDY = f"""
scene = "{ROOT}/data/verification/incline/scene.toml"
demsolve_options = ["--no-creep"]

[[vary]]
name = "friction angle"
key = "joint_material.joint.friction_angle_deg"
law = "normal"
mean = {FRICTION["mean"]}
deviation = {FRICTION["deviation"]}

[[vary]]
name = "cohesion"
key = "joint_material.joint.cohesion_MPa"
law = "lognormal"
mean = {COHESION["mean"]}
deviation = {COHESION["deviation"]}

[design]
kind = "directional sampling"
directions = {{directions}}
replicates = {{replicates}}
failure = "slides"

[[collect]]
name = "slides"
what = "failed"
"""


def closed_form():
    spread = math.sqrt(math.log(1 + (COHESION["deviation"] / COHESION["mean"]) ** 2))
    cohesion = stats.lognorm(spread, scale=COHESION["mean"] * math.exp(-spread**2 / 2))
    friction = stats.norm(FRICTION["mean"], FRICTION["deviation"])

    def density(c):
        return cohesion.pdf(c) * friction.cdf(math.degrees(math.atan((math.sin(DIP) - c) / math.cos(DIP))))

    return integrate.quad(density, 0, 0.4, points=[0.01, 0.03, 0.1], epsabs=1e-12)[0]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--directions", type=int, default=40)
    parser.add_argument("--replicates", type=int, default=10)
    parser.add_argument("--jobs", type=int, default=1)
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    file = arguments.out / "plane.toml"
    file.write_text(STUDY.format(directions=arguments.directions, replicates=arguments.replicates), "utf-8")
    subprocess.run([arguments.programs / "jointcreep", "study", file, "-o", arguments.out / "plane", "--quiet", "-j",
                    str(arguments.jobs)], check=True)
    study = jointcreep.read(arguments.out / "plane")
    true, (value, low, high), runs = closed_form(), study.answer("probability of failure"), study.runs.rows()
    error = (high - value) / stats.t.ppf(0.975, arguments.replicates - 1)
    plain = value * (1 - value) / error**2
    print(f"probability to slide: closed form {true:.3e}; found {value:.3e}, {low:.3e} to {high:.3e}, in {runs} runs; "
          f"plain sampling as good: {plain:.0f} runs, {plain / runs:.0f} times as many")
    sys.exit(0 if low <= true <= high else 1)


if __name__ == "__main__":
    main()
