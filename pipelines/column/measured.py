#!/usr/bin/python3
"""Readings of a column whose joints have other constants than its scene says, made by its closed form, with noise.

    measured.py SCENE.toml -o readings.csv [--kelvin-stiffness 0.7] [--kelvin-viscosity 1.6] [--joint-stiffness 1.2]

The factors are those that creepfit finds: one on E, one on eta, and one on K, which E and eta follow. A point is
read every other day from the first removal until it goes, upward displacements, on days of a removal just after it.
"""

import argparse
import random
import tomllib

import column_closed_form


def readings(column, sigma, seed):
    """(day, point, displacement [mm]) of every reading."""
    noise = random.Random(seed)
    last = max(removal.day for removal in column.removals) + 20
    for name, height in column.points.items():
        gone = min((removal.day for removal in column.removals if removal.bottom < height), default=last + 1)
        for day in range(1, int(last) + 1, 2):
            if column.removals[0].day <= day < gone:
                rise = 1e3 * column_closed_form.rise(column, height, day)
                yield day, name, rise + noise.gauss(0, sigma)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", metavar="SCENE.toml")
    parser.add_argument("-o", "--output", metavar="readings.csv", required=True)
    for factor, default in ("kelvin-stiffness", 0.7), ("kelvin-viscosity", 1.6), ("joint-stiffness", 1.2):
        parser.add_argument(f"--{factor}", metavar="FACTOR", type=float, default=default, help=f"default {default}")
    parser.add_argument("--sigma-mm", metavar="MM", type=float, default=0.02, help="of the noise; default 0.02")
    parser.add_argument("--seed", metavar="N", type=int, default=1, help="of the noise; default 1")
    arguments = parser.parse_args()
    with open(arguments.scene, "rb") as file:
        column = column_closed_form.column_of(tomllib.load(file))
    for joint in column.joints:
        joint.stiffness *= arguments.joint_stiffness
        joint.kelvin_stiffness *= arguments.joint_stiffness * arguments.kelvin_stiffness
        joint.kelvin_viscosity *= arguments.joint_stiffness * arguments.kelvin_viscosity
    with open(arguments.output, "w") as file:
        print("time_day,point,component,displacement_mm,sigma_mm", file=file)
        for day, name, value in readings(column, arguments.sigma_mm, arguments.seed):
            print(f"{day},{name},y,{value:.6f},{arguments.sigma_mm}", file=file)


if __name__ == "__main__":
    main()
