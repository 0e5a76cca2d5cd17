#!/usr/bin/python3
"""Which plots suit a scene: all that have something to show.

    suited.py SCENE.toml      prints the names NAME of their scripts plot_NAME.py
"""

import ast
import math
import operator
import sys
import tomllib


def suited(scene):
    """Names of plots, of a scene as tomllib reads it. step_history needs a run that records it."""
    sets = scene.get("joint_set", [])
    shows = {
        "section": True,
        "blocks": True,
        "stereonet": any("dip" in one or "orientation" in one for one in sets),
        "rose": sets != [],
        "distributions": sets != [],
        "strength": any(one.get("persistence", 1) < 1 or "bridge_length_m" in one for one in sets),
        "histories": "point" in scene or "monitoring_line" in scene,
        "line": "monitoring_line" in scene,
        "state": True,
        "step_history": "gauge" in scene,
        "dynamics": "large_displacements" in scene and "stage" in scene,
    }
    return [name for name, is_shown in shows.items() if is_shown]


def state_fields(scene):
    """What plot_state.py shows of it: stresses unless all rock is rigid, contacts if there are joints."""
    rigid = scene.get("large_displacements", {}).get("rigid_rocks", [])
    shows = {
        "displacement": True,
        "stress": any(rock["name"] not in rigid for rock in scene["rock"]),
        "contacts": any(name in scene for name in ("joint", "joint_set", "mapped")) or
                    any("joint" in boundary for boundary in scene.get("boundary", [])),
    }
    return [name for name, is_shown in shows.items() if is_shown]


AROUND = (1.0, 0.5, 0.25, 0.1)  # rock on each side of moving blocks, over their larger side; the first that gives a small part, else the last
FILLED = 0.8  # share of the section's area from which a part of it is no enlargement
SMALL = 0.25  # share of the section's area up to which moving blocks, with the rock around them, are a small part of it
LARGEST_DETAIL = 0.6  # of the section's width or height; the faces of stages have pictures of their own if they, with rock around, are at most so large


OPERATIONS = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv, ast.Pow: math.pow}
FUNCTIONS = {"exp": math.exp, "ln": math.log, "sqrt": math.sqrt, "abs": abs, "min": min, "max": max,
             "sind": lambda angle: math.sin(math.radians(angle)), "cosd": lambda angle: math.cos(math.radians(angle)),
             "tand": lambda angle: math.tan(math.radians(angle)), "atand": lambda value: math.degrees(math.atan(value))}


def magnified(scene, field=""):
    """How many times displacements are drawn: 1 with [large_displacements], where the rock is then, but not of contacts; else 0."""
    return int("large_displacements" in scene and field != "contacts")


def number(value, variables):
    """A number of a scene, or of a formula such as "2 * H / tand(dip)" with names of its table [variables]; None of anything else."""
    if isinstance(value, str):
        if "**" in value:  # a power is a^b
            return None
        try:
            return computed(ast.parse(value.strip().replace("^", "**"), mode="eval").body, variables)
        except (SyntaxError, ArithmeticError, ValueError, TypeError, RecursionError):
            return None
    return value if isinstance(value, (int, float)) and not isinstance(value, bool) else None


def computed(node, variables):
    """The value of a parsed formula; None if it is something else."""
    if isinstance(node, ast.Constant):
        return number(node.value, {}) if not isinstance(node.value, str) else None
    if isinstance(node, ast.Name):  # a variable may be a text of others, not of itself
        return number(variables.get(node.id), {name: other for name, other in variables.items() if name != node.id})
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.UAdd)):
        value = computed(node.operand, variables)
        return -value if value is not None and isinstance(node.op, ast.USub) else value
    if isinstance(node, ast.BinOp) and type(node.op) in OPERATIONS:
        function, values = OPERATIONS[type(node.op)], [node.left, node.right]
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in FUNCTIONS and not node.keywords:
        function, values = FUNCTIONS[node.func.id], node.args
    else:
        return None
    values = [computed(value, variables) for value in values]
    return None if None in values else function(*values)


def places_of(value, variables):
    """All {x, y} and circles in nested lists and tables of a scene, as places; None where a number is missing."""
    if isinstance(value, dict):
        if "radius_m" in value and "center_m" in value:
            radius, *centre = (number(one, variables) for one in (value["radius_m"], *value["center_m"]))
            return None if None in (radius, *centre) else [tuple(one - radius for one in centre), tuple(one + radius for one in centre)]
        return places_of([one for one in value.values() if isinstance(one, (list, dict))], variables)
    if isinstance(value, list):
        if len(value) == 2 and not any(isinstance(one, (list, dict)) for one in value):
            place = tuple(number(one, variables) for one in value)
            return None if None in place else [place]
        found = [places_of(one, variables) for one in value]
        return None if None in found else [place for one in found for place in one]
    return None


def surroundings(places, section, share=1.0):
    """Window {x0, y0, x1, y1} [m] of some places, with this share of their larger side as rock on each side, as far as the section reaches;
    and its width and height over those of the section."""
    (x0, y0), (x1, y1) = map(min, zip(*section)), map(max, zip(*section))
    (left, low), (right, high) = map(min, zip(*places)), map(max, zip(*places))
    around = share * max(right - left, high - low)
    window = [max(x0, left - around), max(y0, low - around), min(x1, right + around), min(y1, high + around)]
    return window, ((window[2] - window[0]) / (x1 - x0), (window[3] - window[1]) / (y1 - y0))


def enlarged(places, section):
    """Window {x0, y0, x1, y1} [m] around moving blocks: with less rock around large ones. None if they fill the section."""
    for share in AROUND:
        window, (width, height) = surroundings(places, section, share)
        if width * height <= SMALL:
            return window
    return window if width * height <= FILLED else None


def faces(corners, section):
    """Places of excavations that say where their faces are: corners as far as they are in the section [m], without those at or beyond its
    left and right side, which an excavation reaches where the terrain goes on. All of them if there are no others."""
    (x0, y0), (x1, y1) = map(min, zip(*section)), map(max, zip(*section))
    return [(min(max(x, x0), x1), min(max(y, y0), y1)) for x, y in
            [corner for corner in corners if x0 < corner[0] < x1] or corners]


def detail(scene):
    """The surroundings of the faces of stages. None if there are none, if they are large, or not known before jointgen has read the scene."""
    try:
        variables = scene.get("variables", {})
        section = places_of(scene["section"]["outline_m"], variables)
        corners = places_of([stage["remove_m"] for stage in scene.get("stage", [])], variables)
        window, shares = surroundings(faces(corners, section), section)
        return window if 0 < min(shares) <= LARGEST_DETAIL else None
    except (KeyError, TypeError, ValueError, ZeroDivisionError):  # no stage, or a scene that nobody has checked; jointgen says it
        return None


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8-sig") as file:  # with or without a byte order mark
        print(*suited(tomllib.loads(file.read())))
