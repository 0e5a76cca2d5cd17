"""The rocks, joints and joint sets of a scene in words and with units, as tables of a report: (heading, heads, rows).

A key of a scene ends with its unit: normal_stiffness_MPa_per_m becomes "normal stiffness" and "MPa/m".
"""

import math

from . import scene_keys

UNITS = {"MPa_day_per_m": "MPa day/m", "GPa_day": "GPa day", "MPa_per_m": "MPa/m", "kg_per_m3": "kg/m3", "m2_per_MJ": "m2/MJ",
         "per_m3": "1/m3", "per_m2": "1/m2", "per_m": "1/m", "MPa": "MPa", "GPa": "GPa", "deg": "degrees", "mm": "mm", "m": "m"}
NAMES = {"youngs_modulus": "Young's modulus E", "poissons_ratio": "Poisson's ratio",
         "joint_roughness_coefficient": "joint roughness coefficient JRC",
         "joint_wall_strength": "joint wall strength JCS"}
LAW_WORDS = {"mean": "mean", "deviation": "standard deviation", "half_width": "half-width", "shortest": "at least", "longest": "at most",
             "exponent": "exponent", "mean_dip": "mean dip", "mean_dip_direction": "mean dip direction", "concentration": "concentration"}


def stem_and_unit(key):
    """A key without the unit at its end, and this unit; "" if it has none."""
    return next(((key.removesuffix(f"_{ending}"), unit) for ending, unit in UNITS.items() if key.endswith(f"_{ending}")), (key, ""))


def name_and_unit(key):
    """Name in words and unit ("" if it has none) of a key."""
    stem, unit = stem_and_unit(key)
    return NAMES.get(stem, stem.replace("_", " ").replace("kelvin", "Kelvin").replace("maxwell", "Maxwell")), unit


def number(value):
    return f"{value:.6g}" if isinstance(value, (int, float)) and not isinstance(value, bool) else str(value)


def with_unit(value, unit):
    return f"{number(value)} {unit}".rstrip()


def law_in_words(law):
    """ "lognormal, mean 12 m, standard deviation 6 m"."""
    words = [law["law"]] if "law" in law else []
    for key, value in law.items():
        if key == "law":
            continue
        stem, unit = stem_and_unit(key)
        if isinstance(value, list):
            words.append(f"{len(value)} {stem.replace('_', ' ')}")
        else:
            words.append(f"{LAW_WORDS.get(stem, stem.replace('_', ' '))} {with_unit(value, unit)}")
    return ", ".join(words)


def in_runs(parameter, value):
    """The values that a key of this value in the scene has in the runs of a study, by the Parameter that changes it: "2000 to 10000"."""
    factor = value if parameter.multiplies else 1
    if any(isinstance(one, str) for one in parameter.values):
        return " or ".join(dict.fromkeys(map(str, parameter.values)))
    has_mean = "mean" in parameter.constants  # a normal or lognormal law, which may be cut off at one end or both
    if parameter.values:
        ends = [min(parameter.values), max(parameter.values)]
    elif has_mean:
        ends = [parameter.lowest, parameter.highest]
    else:
        ends = [parameter.constants["lowest"], parameter.constants["highest"]]
    low, high = sorted(factor * end for end in ends) if factor else (0, 0)
    if not has_mean:
        return number(low) if low == high else f"{number(low)} to {number(high)}"
    cut = [f"at least {number(low)}"] * math.isfinite(low) + [f"at most {number(high)}"] * math.isfinite(high)
    mean, deviation = factor * parameter.constants["mean"], abs(factor * parameter.constants["deviation"])
    return ", ".join([f"{parameter.law}, mean {number(mean)}", f"standard deviation {number(deviation)}", *cut])


def varied(study, scene):
    """Each key of a scene that a study changes: name of the parameter, key, the scene's value, and that of the runs in words."""
    return [(one.name, key, value, in_runs(one, value)) for one in study.parameters for key in one.keys
            for value in [scene_keys.value_at(scene, key)]]


def marked(study, scene, formulas=None):
    """A scene in which the values that a study changes are words that say so, for tables(). formulas: the scene with its formulas, if
    names of [variables] vary."""
    if formulas:
        by_name = {name: scene_keys.dependent(formulas, [name]) for name in study.varied_names()}
        scene = formulas_in_words(scene, formulas, by_name)
    return scene_keys.changed(scene, {key: f'varies by "{name}": {words}' for name, key, _, words in varied(study, scene)
                                      if scene_keys.parts_of(key)[0] != "variables"})


def formulas_in_words(value, formula, by_name):
    """A value of a scene in which numbers whose formula leads to a name that varies are words: "12 = 2 * a, varies by a". by_name: names of
    [variables] that depend on each of these."""
    if isinstance(formula, dict):
        return {key: formulas_in_words(one, formula.get(key), by_name) for key, one in value.items()}
    if isinstance(formula, list) and isinstance(value, list) and len(value) == len(formula):
        return [formulas_in_words(one, inner, by_name) for one, inner in zip(value, formula)]
    used = [name for name, names in by_name.items() if scene_keys.names_in(formula) & names]
    is_number = isinstance(value, (int, float)) and isinstance(formula, str)
    return f'{number(value)} = {formula}, varies by {", ".join(used)}' if used and is_number else value


def flat(table):
    """The keys and values of a rock or joint material; each Kelvin unit of a chain has keys of its own."""
    for key, value in table.items():
        if key == "kelvin_chain":
            for at, unit in enumerate(value, 1):
                yield from ((f"Kelvin unit {at}: {name}", one) for name, one in unit.items())
        elif key != "name":
            yield key, value


def of_materials(tables):
    """Heads and rows of rocks or joint materials: a row for each property, a column for each material."""
    values = [dict(flat(one)) for one in tables]
    keys = list(dict.fromkeys(key for one in values for key in one))
    return ["property", "unit", *(one["name"] for one in tables)], \
        [(*name_and_unit(key), *(one.get(key, "") for one in values)) for key in keys]


def density_in_words(density):
    """ "P21 0.3 1/m"; its scanline, if it has one."""
    named = ((*name_and_unit(key), value) for key, value in density.items())
    return ", ".join(f"{name} {with_unit(value, unit)}" for name, unit, value in named)


def value_in_words(key, value, unit):
    """The value of a key of a joint set."""
    if isinstance(value, dict):
        return density_in_words(value) if key == "density" else law_in_words(value)
    if key.endswith("region_m"):
        return ", ".join(f"({number(x)}, {number(y)})" for x, y in value) + " m"
    if key == "material_in":
        return ", ".join(f"{one['material']} in {one['rock']}" for one in value)
    return ", ".join(map(str, value)) if isinstance(value, list) else with_unit(value, unit)


def of_sets(sets):
    """Heads and rows of joint sets, or of mapped sets: a row for each property, a column for each set."""
    keys = list(dict.fromkeys(key for one in sets for key in one if key != "name"))
    return ["", *(one["name"] for one in sets)], \
        [(name, *(value_in_words(key, one[key], unit) if key in one else "" for one in sets))
         for key in keys for name, unit in [name_and_unit(key)]]


def tables(scene):
    """The tables of a scene: (heading, heads, rows); those that have something."""
    found = []
    for key, heading in (("rock", "Rocks"), ("joint_material", "Joint materials")):
        if scene.get(key):
            found.append((heading, *of_materials(scene[key])))
    for key, heading in (("joint_set", "Joint sets"), ("mapped", "Mapped joint sets")):
        if scene.get(key):
            found.append((heading, *of_sets(scene[key])))
    if scene.get("joint"):
        found.append(("Single joints", ["name", "joint material", "from x (m)", "y (m)", "to x (m)", "y (m)"],
                      [(one["name"], one["material"], *one["from_m"], *one["to_m"]) for one in scene["joint"]]))
    return found
