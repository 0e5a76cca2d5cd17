"""The keys of a scene: found by a path such as joint_material.joint.friction_angle_deg, changed, and written as TOML.

A path has the parts of a dotted TOML key. Where a table is one of several, the part after it is the name of one of them, or,
where they have no names, its number, counted from 1. A part with blanks or dots is put in quotes, as in TOML:
joint_material."crushed rock".friction_angle_deg
"""

import copy
import datetime
import re
import tomllib

from .errors import NotWanted

SHOWN = 8  # names that a message lists


def parts_of(path):
    """The parts of a path, a list of str."""
    try:
        inner, parts = tomllib.loads(f"{path} = 0"), []
    except tomllib.TOMLDecodeError:
        raise NotWanted(f'"{path}" is not a path of keys, such as joint_material.joint.friction_angle_deg') from None
    while isinstance(inner, dict):
        (key, inner), = inner.items()
        parts.append(key)
    return parts


def named(tables, part):
    """The table of a list that has this name, or this number; None if there is none."""
    for number, table in enumerate(tables, 1):
        if not isinstance(table, dict):
            return None
        if part == str(table.get("name", number)):
            return table
    return None


def holder_of(scene, path):
    """The table of a scene that has the key at the end of a path, and that key."""
    *way, key = parts_of(path)
    place, passed = scene, "the scene"
    for part in [*way, key]:
        is_list = isinstance(place, list)
        inner = named(place, part) if is_list else place.get(part) if isinstance(place, dict) else None
        if inner is None:
            there = [str(table.get("name", number)) for number, table in enumerate(place, 1) if isinstance(table, dict)] \
                if is_list else list(place) if isinstance(place, dict) else []
            has = f"; it has: {', '.join(there[:SHOWN])}{', ...' if len(there) > SHOWN else ''}" if there else ""
            raise NotWanted(f'"{path}": {passed} has no "{part}"{has}')
        holder, place, passed = place, inner, part
    if isinstance(holder, list):
        raise NotWanted(f'"{path}" is a table; expected a key in it')
    return holder, key


def value_at(scene, path):
    """The value at the end of a path."""
    holder, key = holder_of(scene, path)
    return holder[key]


def changed(scene, values):
    """A scene with other values, by their paths."""
    scene = copy.deepcopy(scene)
    for path, value in values.items():
        holder, key = holder_of(scene, path)
        holder[key] = value
    return scene


def names_in(value):
    """The names of [variables] in a value of a scene with formulas: "H - 2 * B" has H and B. Words of texts are among them."""
    if isinstance(value, str):
        return set(re.findall(r"[A-Za-z_]\w*", value))
    inner = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return set().union(*map(names_in, inner))


def dependent(scene, names):
    """These names of [variables], and all whose formulas lead to one of them."""
    formulas, found = {name: names_in(value) for name, value in scene.get("variables", {}).items()}, set(names)
    while more := {name for name, inside in formulas.items() if inside & found} - found:
        found |= more
    return found


def quoted(text):
    """A basic string of TOML."""
    escapes = {'"': '\\"', "\\": "\\\\"}
    return '"' + "".join(escapes.get(one) or (f"\\u{ord(one):04x}" if ord(one) < 32 or ord(one) == 127 else one)
                         for one in text) + '"'


def value_text(value):
    """A value as TOML; numbers with all their digits."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return quoted(value)
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, (datetime.date, datetime.time)):
        return value.isoformat()
    if isinstance(value, list):
        return "[" + ", ".join(map(value_text, value)) + "]"
    return "{ " + ", ".join(f"{quoted(key)} = {value_text(one)}" for key, one in value.items()) + " }"


def toml_text(scene):
    """A scene as TOML: tables of its first level with headings, inner ones inline."""
    lines = [f"{quoted(key)} = {value_text(value)}" for key, value in scene.items() if not is_table(value)]
    for name, value in scene.items():
        if is_table(value):
            several = isinstance(value, list)
            for table in value if several else [value]:
                lines += ["", f"[[{quoted(name)}]]" if several else f"[{quoted(name)}]"]
                lines += [f"{quoted(key)} = {value_text(one)}" for key, one in table.items()]
    return "\n".join(lines) + "\n"


def is_table(value):
    """Whether a value of the first level is a table, or several."""
    return isinstance(value, dict) or isinstance(value, list) and value != [] and all(isinstance(one, dict) for one in value)
