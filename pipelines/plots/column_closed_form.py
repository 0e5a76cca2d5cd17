#!/usr/bin/python3
"""The exact rise of points in a column of blocks on creeping joints, taken down from the top.

    column_closed_form.py SCENE.toml DAY...      prints day and rise [m] of every point of the scene, as CSV

A DAY is a number; with a minus behind it ("20-") it means just before what happens on that day. A point that has
been removed keeps its last value.

Every removal r, at T_r <= T, takes a pressure dF = rho g h off what is below it. A point with the length z of rock
and m joints between it and the fixed ground then rises by

    dF z (1 - nu^2) / E_r  +  sum over the m joints of  dF (1/K + (1 - exp(-lam (T - T_r))) / E),    lam = E / eta

(plane strain, free sides, a base that slides freely; Kelvin constants E, eta and stiffness K per area of joint).
The joints are those of the scene below the point, and the one that the base rests on, if it does.
"""

import argparse
import datetime
import math
import sys
import tomllib
from dataclasses import dataclass


class NotAColumn(Exception):
    """The scene is not one that the formula holds for."""


@dataclass
class Joint:
    height: float  # [m]
    stiffness: float  # K [Pa/m]
    kelvin_stiffness: float  # E [Pa/m]; 0 does not creep
    kelvin_viscosity: float  # eta [Pa day/m]


@dataclass
class Removal:
    day: float
    pressure: float  # dF [Pa]
    bottom: float  # of what it removes [m]


@dataclass
class Column:
    base: float  # [m]
    compliance: float  # of the rock, (1 - nu^2) / E_r [1/Pa]
    joints: list[Joint]
    removals: list[Removal]
    points: dict[str, float]  # name -> height [m]


def days_since(start, when):
    """A scene's date or day number as days since its start. With a date as the start, numbers are days since it."""
    if isinstance(when, (int, float)):
        return float(when - start) if isinstance(start, (int, float)) else float(when)
    midnight = datetime.time()
    times = [t if isinstance(t, datetime.datetime) else datetime.datetime.combine(t, midnight) for t in (start, when)]
    return (times[1] - times[0]) / datetime.timedelta(days=1)


def joint_at(scene, name, height):
    material = next(m for m in scene["joint_material"] if m["name"] == name)
    return Joint(
        height,
        material["normal_stiffness_MPa_per_m"] * 1e6,
        material.get("normal_kelvin_stiffness_MPa_per_m", 0) * 1e6,
        material.get("normal_kelvin_viscosity_MPa_day_per_m", 0) * 1e6,
    )


def span(corners, axis):
    """Lowest and highest coordinate of an upright rectangle, which the polygon must be."""
    values = sorted({float(corner[axis]) for corner in corners})
    if len(corners) != 4 or len(values) != 2:
        raise NotAColumn("the section and what is removed must be upright rectangles")
    return values


def column_of(scene):
    """The column that a scene (a dict, as tomllib reads it) describes."""
    section = scene["section"]
    left, right = span(section["outline_m"], 0)
    base, top = span(section["outline_m"], 1)
    if len(scene["rock"]) != 1 or scene.get("joint_set"):
        raise NotAColumn("there must be one rock, and no joint set")
    rock = scene["rock"][0]
    weight = rock["density_kg_per_m3"] * section["gravity_m_per_s2"]

    joints = []
    for joint in scene.get("joint", []):
        (x1, y1), (x2, y2) = joint["from_m"], joint["to_m"]
        if y1 != y2 or min(x1, x2) > left or max(x1, x2) < right:
            raise NotAColumn(f"joint '{joint['name']}' does not cut straight across the column")
        joints.append(joint_at(scene, joint["material"], float(y1)))
    for boundary in scene.get("boundary", []):
        if boundary["from_m"][1] == base == boundary["to_m"][1] and "joint" in boundary:
            joints.append(joint_at(scene, boundary["joint"], base))

    removals = []
    for stage in sorted(scene.get("stage", []), key=lambda s: days_since(scene["schedule"]["start"], s["date"])):
        for corners in stage["remove_m"]:
            bottom, upper = span(corners, 1)
            if span(corners, 0)[0] > left or span(corners, 0)[1] < right or upper < top:
                raise NotAColumn(f"stage '{stage['name']}' does not take the top off the column")
            day = days_since(scene["schedule"]["start"], stage["date"])
            removals.append(Removal(day, weight * (top - bottom), bottom))
            top = bottom

    points = {point["name"]: float(point["at_m"][1]) for point in scene.get("point", [])}
    compliance = (1 - rock["poissons_ratio"] ** 2) / (rock["youngs_modulus_GPa"] * 1e9)
    return Column(base, compliance, joints, removals, points)


def rise(column, height, day, before=False):
    """Rise [m] since the in-situ equilibrium of what is at `height` [m]; `before` what happens on that day."""
    total = 0.0
    for removal in column.removals:
        if removal.bottom < height:  # the point itself goes
            if removal.day <= day:
                day, before = removal.day, True
            break
    for removal in column.removals:
        if removal.day > day or (before and removal.day == day):
            break
        total += removal.pressure * (height - column.base) * column.compliance
        for joint in column.joints:
            if joint.height >= height:
                continue
            crept = 0.0
            if joint.kelvin_stiffness > 0:
                rate = joint.kelvin_stiffness / joint.kelvin_viscosity
                crept = -math.expm1(-rate * (day - removal.day)) / joint.kelvin_stiffness
            total += removal.pressure * (1 / joint.stiffness + crept)
    return total


def main():
    parser = argparse.ArgumentParser(description="The exact rise of points in a column of blocks on creeping joints.")
    parser.add_argument("scene", metavar="SCENE.toml")
    parser.add_argument("days", metavar="DAY", nargs="+", help='a number; "20-" means just before day 20')
    arguments = parser.parse_args()
    try:
        with open(arguments.scene, "rb") as file:
            column = column_of(tomllib.load(file))
        days = [(float(day.removesuffix("-")), day.endswith("-")) for day in arguments.days]
    except (OSError, KeyError, ValueError, NotAColumn) as error:
        sys.exit(f"column_closed_form.py: {arguments.scene}: {error}")

    print("day", *column.points, sep=",")
    for text, (day, before) in zip(arguments.days, days):
        print(text, *(repr(rise(column, height, day, before)) for height in column.points.values()), sep=",")


if __name__ == "__main__":
    main()
