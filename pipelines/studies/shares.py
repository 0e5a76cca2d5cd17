#!/usr/bin/python3
"""Shares of the variance of a small slope in two ways that share no runs: Sobol indices, and all pairs of networks and parameters.

    shares.py PROGRAMS OUT [--networks 40] [--parameters 30] [--points 300]

Two inputs vary: the network, and the stiffness of the joints. The variance of the means over one input, found from all pairs, is
that input's first-order index times the variance; this is brute force, and the reference. `jointcreep study` gives the same indices
from its design "sobol indices". A line is an input: both values, the interval, and whether the reference is in it.
"""

import argparse
import pathlib
import subprocess
import sys

import jointcreep

HERE = pathlib.Path(__file__).resolve().parent

STUDY = """
scene = "{scene}"

[[vary]]
network = true

[[vary]]
name = "stiffness"
key = ["joint_material.joint.normal_stiffness_MPa_per_m", "joint_material.joint.shear_stiffness_MPa_per_m"]
law = "lognormal"
mean = 1
deviation = 0.2
multiplies = true

[design]
{design}

[[collect]]
name = "floor"
what = "displacement"
point = "floor"
component = "y"
"""


def made(arguments, name, design):
    """Makes a study, and reads it."""
    (arguments.out / f"{name}.toml").write_text(STUDY.format(scene=HERE / "small.toml", design=design), "utf-8")
    subprocess.run([arguments.programs / "jointcreep", "study", arguments.out / f"{name}.toml", "-o", arguments.out / name, "--quiet",
                    "-j", str(arguments.jobs)], check=True)
    return jointcreep.read(arguments.out / name)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--networks", type=int, default=40)
    parser.add_argument("--parameters", type=int, default=30)
    parser.add_argument("--points", type=int, default=300)
    parser.add_argument("--jobs", type=int, default=1)
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)

    pairs = made(arguments, "pairs", f'kind = "networks x parameters"\nnetworks = {arguments.networks}\n'
                         f"parameters = {arguments.parameters}\nseed = 7").runs
    values = pairs["floor (mm)"].reshape(arguments.networks, arguments.parameters)
    rest = values - values.mean(axis=1)[:, None] - values.mean(axis=0)[None, :] + values.mean()
    noise = (rest**2).sum() / ((arguments.networks - 1) * (arguments.parameters - 1))
    of_networks = values.mean(axis=1).var(ddof=1) - noise / arguments.parameters  # of the means over parameters
    of_parameters = values.mean(axis=0).var(ddof=1) - noise / arguments.networks
    total = of_networks + of_parameters + noise
    wanted = {"network": of_networks / total, "stiffness": of_parameters / total}

    bad = 0
    shares = made(arguments, "indices", f'kind = "sobol indices"\npoints = {arguments.points}').shares
    for name, measure, value, low, high in zip(*(shares[column] for column in ("input", "measure", "value", "low", "high"))):
        if measure == "first order index":
            is_in = low <= wanted[name] <= high
            bad += not is_in
            print(f"{name}: all pairs {wanted[name]:.3f}; Sobol index {value:.3f}, {low:.3f} to {high:.3f}"
                  f"{'' if is_in else ': NOT in the interval'}")
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
