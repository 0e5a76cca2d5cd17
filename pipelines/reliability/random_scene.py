"""Random legal scenes: sections, rocks, joints of every law, joint sets of every kind and law, stress, boundaries, stages,
zones and engines. All numbers are made up, within what an engineer might write."""

import math

from small_scene import table


def chance(random, probability):
    return random.random() < probability


def log_uniform(random, low, high):
    return float(f"{math.exp(random.uniform(math.log(low), math.log(high))):.4g}")


def uniform(random, low, high):
    return float(f"{random.uniform(low, high):.4g}")


def length_law(random, mean):
    """A law of spacings, lengths or diameters with about this mean [m]."""
    law = random.choice(["normal", "lognormal", "negative exponential", "uniform", "power", "constant"])
    mean = float(f"{mean:.4g}")
    return {"law": law, **{"normal": {"mean_m": mean, "deviation_m": mean / random.choice([4, 8])},
                           "lognormal": {"mean_m": mean, "deviation_m": mean * uniform(random, 0.1, 1)},
                           "uniform": {"shortest_m": mean / 2, "longest_m": mean * 1.5},
                           "power": {"exponent": uniform(random, 0, 4), "shortest_m": mean / 2, "longest_m": mean * 3},
                           }.get(law, {"mean_m": mean})}


def angle_law(random, low, high):
    law = random.choice(["normal", "uniform", "constant"])
    more = {"normal": {"deviation_deg": uniform(random, 0.5, 10)}, "uniform": {"half_width_deg": uniform(random, 1, 15)}}
    return {"law": law, "mean_deg": uniform(random, low, high), **more.get(law, {})}


def orientation(random, kind):
    """How the joints of a set lie."""
    how = random.choice(["in space", "Fisher", "bootstrap"] + ["trace"] * (3 * (kind != "discs")))
    if how == "trace":
        return {"trace_angle": angle_law(random, -90, 90)}
    if how == "in space":
        return {"dip": angle_law(random, 5, 85), "dip_direction": angle_law(random, 70, 110)}
    if how == "Fisher":
        return {"orientation": {"law": "Fisher", "mean_dip_deg": uniform(random, 5, 85), "mean_dip_direction_deg":
                                random.choice([80, 100, 260, 280]), "concentration": log_uniform(random, 20, 500)}}
    dip, direction = random.uniform(10, 80), random.choice([85, 265])
    return {"orientation": {"law": "bootstrap", "poles_deg": [
        [min(90, max(0, round(dip + random.gauss(0, 6), 1))), round(direction + random.gauss(0, 8), 1)] for _ in range(6)]}}


def bridged(material):
    """Its law has an average with rock bridges."""
    return not {"joint_roughness_coefficient", "initial_friction_angle_deg"} & material.keys()


def joint_set(random, name, materials, rocks, others, size, width):
    """About as many joints as give some ten blocks across."""
    kind = random.choice(["lines", "lines", "segments", "discs"])
    material = random.choice(materials)
    keys = {"name": name, "material": material["name"], "kind": kind, **orientation(random, kind)}
    spacing = size * uniform(random, 0.2, 0.8)
    if kind == "lines":
        keys["spacing"] = length_law(random, spacing)
        keys["persistence"] = random.choice([1, 1, 1, 0.9, 0.7, 0.5, 0.2, 0]) if bridged(material) else 1
        if keys["persistence"] not in (0, 1):
            keys["length"] = length_law(random, size * uniform(random, 0.2, 0.8))
        if chance(random, 0.2):
            keys["density"] = {"P21_per_m": float(f"{1 / spacing:.4g}")}
    else:
        mean = size * uniform(random, 0.3, 1)
        keys["diameter" if kind == "discs" else "length"] = length_law(random, mean)
        keys["density"] = random.choice([{"P21_per_m": float(f"{1 / spacing:.4g}")}, {
            "P10_per_m": float(f"{1 / spacing:.4g}"), "scanline_angle_deg": uniform(random, -180, 180)}])
        if others and chance(random, 0.4):
            keys["terminates_at"] = random.sample(others, 1)
            keys["termination_probability"] = uniform(random, 0.2, 1)
    if chance(random, 0.2):
        keys["rocks"] = random.sample(rocks, 1)
    elif chance(random, 0.2):
        keys["region_m"] = [[0, 0], [width, 0], [width, size / 2], [0, size]]
    if chance(random, 0.2):
        others = [one["name"] for one in materials if bridged(one) or not bridged(material)]
        keys["material_in"] = [{"rock": random.choice(rocks), "material": random.choice(others)}]
    return keys


def kelvin(random, stiffness, prefix="", viscosity="viscosity"):
    """One Kelvin unit, whose retardation time is some days."""
    keys = {}
    for way, share in (("normal", 1), ("shear", 0.4)):
        spring = float(f"{stiffness * share * random.uniform(0.5, 3):.4g}")
        keys[f"{way}_{prefix}stiffness_MPa_per_m"] = spring
        keys[f"{way}_{prefix}{viscosity}_MPa_day_per_m"] = float(f"{spring * random.uniform(2, 30):.4g}")
    return keys


def joint_material(random, name, stress, size, creeps):
    """Stiffness and strength by the stress in the section [MPa] and its height [m]."""
    stiffness = log_uniform(random, 30, 3000) * stress / size * 20
    law = random.choice(["Coulomb", "Coulomb", "residual", "Barton-Bandis", "wearing", "yielding"])
    friction = uniform(random, 20, 50)
    with_cohesion = law in ("Coulomb", "residual", "wearing")
    cohesion = random.choice([0, 0.02, 0.1, 0.5]) * stress if with_cohesion else 0
    keys = {"name": name, "normal_stiffness_MPa_per_m": stiffness,
            "shear_stiffness_MPa_per_m": stiffness * random.choice([0.2, 0.4, 1]), "cohesion_MPa": cohesion,
            "friction_angle_deg": friction, "tensile_strength_MPa": cohesion * random.choice([0, 0.5])}
    if with_cohesion and chance(random, 0.4 if law != "wearing" else 1):
        keys["dilation_angle_deg"] = friction * uniform(random, 0.1, 0.4)
        if law != "wearing" and chance(random, 0.5):
            keys["dilation_until_m"] = log_uniform(random, 1e-4, 0.1)
    keys |= {"residual": {"residual_cohesion_MPa": cohesion / 2, "residual_friction_angle_deg": friction * 0.8},
             "Barton-Bandis": {"joint_roughness_coefficient": uniform(random, 0, 20), "joint_wall_strength_MPa":
                               uniform(random, 20, 150), "largest_closure_mm": log_uniform(random, 0.05, 5)},
             "wearing": {"dilation_wear_m2_per_MJ": log_uniform(random, 1, 1000)},
             "yielding": {"initial_friction_angle_deg": min(85, friction * uniform(random, 1, 1.4)),
                          "roughness_length_mm": log_uniform(random, 0.1, 50)}}.get(law, {})
    if creeps and with_cohesion and chance(random, 0.8):
        if chance(random, 0.3):
            units = [kelvin(random, stiffness) for _ in range(random.randint(1, 3))]
            keys["kelvin_chain"] = units
        else:
            keys |= kelvin(random, stiffness, "kelvin_")
        if chance(random, 0.2):
            keys |= {f"{way}_maxwell_viscosity_MPa_day_per_m": stiffness * 1e3 for way in ("normal", "shear")}
    return keys


def rock(random, name, creeps, stiffest):
    keys = {"name": name, "density_kg_per_m3": uniform(random, 1900, 2900), "youngs_modulus_GPa": log_uniform(random, 0.5, stiffest),
            "poissons_ratio": uniform(random, 0, 0.45), "cohesion_MPa": log_uniform(random, 0.1, 5),
            "friction_angle_deg": uniform(random, 20, 55), "tensile_strength_MPa": log_uniform(random, 0.05, 1)}
    if chance(random, 0.3):
        keys["dilation_angle_deg"] = keys["friction_angle_deg"] * uniform(random, 0, 0.5)
    if chance(random, 0.2):
        keys["law"] = "Mohr-Coulomb"
    elif creeps and chance(random, 0.3):
        shear = keys["youngs_modulus_GPa"]
        keys |= {"kelvin_shear_modulus_GPa": shear, "kelvin_shear_viscosity_GPa_day": shear * uniform(random, 5, 50)}
    return keys


def in_situ(random, density, height, ground):
    """About the rock's weight, and a share of it sideways."""
    weight = density * 9.81e-6
    keys = random.choice([{"elevation_m": height}, {"ground_m": ground}])
    if chance(random, 0.2):
        return keys | {"horizontal_stress_ratio": uniform(random, 0.3, 1.2)}
    stress = {"compression_xx_MPa": uniform(random, 0.3, 1.2) * weight, "compression_yy_MPa": weight, "shear_xy_MPa": 0}
    if chance(random, 0.7):
        return keys | {key: 0 for key in stress} | {key.replace("_MPa", "_gradient_MPa_per_m"): value
                                                    for key, value in stress.items()}
    return keys | {"profile": [{"depth_m": depth, **{key: value * depth for key, value in stress.items()}}
                               for depth in (0, height / 3, 2 * height)]}


def boundaries(random, width, right, height, material, days, large, rise):
    """The base, which rises to the right, both sides, and sometimes a load on the top."""
    rollers = {"fix": "normal"}  # meet no side that is moved, and do not go with large displacements
    base = random.choice([{"fix": "xy"}, {"fix": "xy"}, {"fix": "y"}, {"joint": material}, *([] if large else [rollers])])
    moved = chance(random, 0.15) and not large and base != rollers
    history = [[0, 0], [days / 2, 1], [days, uniform(random, 0.5, 1)]]
    yield {"from_m": [0, 0], "to_m": [width, rise], **base}
    yield {"from_m": [0, 0], "to_m": [0, height], "fix": "x",
           **({"displacement_mm": [uniform(random, -1, 1), 0], "load_history": history} if moved else {})}
    yield {"from_m": [width, rise], "to_m": [width, right], "fix": "x" if large else random.choice(["x", "normal"])}
    if chance(random, 0.2):
        yield {"from_m": [0, height], "to_m": [width / 4, height], "traction_MPa": [0, -uniform(random, 0, 0.1)],
               **({"load_history": history} if chance(random, 0.5) and not large else {})}


def creep(random, days):
    scheme = random.choice(["auto", "fitted", "backward", "linear force", "published"])
    if chance(random, 0.5):
        return {"scheme": scheme, "step_days": days / random.choice([4, 10, 20])}
    return {"scheme": scheme, "tolerance_m": log_uniform(random, 1e-5, 1e-3)}


def equilibrium(random, large):
    """Mostly what an engineer takes; at times damping by hand, real masses, increments."""
    keys = {"engine": random.choice(["auto", "auto", "relaxation", "implicit"]), "tolerance": random.choice([1e-4, 1e-5]),
            "most_steps": 30000}
    if chance(random, 0.3) and not large:
        keys["unloading_increments"] = random.randint(2, 4)
    if keys["engine"] != "implicit" and chance(random, 0.4):
        keys["damping"] = random.choice(["kinetic", "local", "combined", "mass"])
        if keys["damping"] == "mass":
            keys["mass_damping_per_s"] = log_uniform(random, 10, 500)
            keys["masses"] = "real"
    return keys


def random_scene(random):
    """The text of a scene."""
    large, quick = chance(random, 0.12), chance(random, 0.5)
    height = log_uniform(random, 20 if large else 3, 80)  # time steps of small or stiff zones are short
    width, days = float(f"{height * random.uniform(1, 2.5):.4g}"), random.choice([10, 60, 400])
    creeps = chance(random, 0.5)
    right = height if chance(random, 0.5) else float(f"{height * random.uniform(0.3, 0.8):.4g}")
    rise = float(f"{height * random.choice([0, 0, 0.02, 0.1]):.4g}")
    top = [[width, height]] if right == height else [[width, right], [width * 0.7, right], [width * 0.5, height]]
    section = {"outline_m": [[0, 0], [width, rise], *top, [0, height]], "rock": "rock 0", "gravity_m_per_s2": 9.81,
               "azimuth_deg": 90}
    if chance(random, 0.15):
        x, y, r = width * 0.2, height * 0.4, height * 0.1
        section["holes_m"] = [[[x - r, y - r], [x + r, y - r], [x + r, y + r], [x, y + 1.5 * r], [x - r, y + r]]]
    rocks = [rock(random, f"rock {i}", creeps and not large, 5 if large else 60) for i in range(random.randint(1, 3))]
    names = [one["name"] for one in rocks]
    stress = rocks[0]["density_kg_per_m3"] * 9.81e-6 * height
    materials = [joint_material(random, f"material {i}", stress, height, creeps) for i in range(random.randint(1, 3))]
    kinds = [one["name"] for one in materials]
    parts = [table("[section]", section), *(table("[[rock]]", one) for one in rocks)]
    for name in names[1:]:
        low, high = sorted(float(f"{random.uniform(0, height):.4g}") for _ in range(2))
        parts.append(table("[[region]]", {"rock": name, "outline_m": [[-1, low], [width + 1, low], [width + 1, high + 0.1],
                                                                     [-1, high + 0.2]]}))
    parts += [table("[[joint_material]]", one) for one in materials]
    others = []
    for i in range(random.randint(0, 2)):
        y = [float(f"{random.uniform(-0.2, 1.2) * height:.4g}") for _ in range(2)]
        others.append(f"joint {i}")
        parts.append(table("[[joint]]", {"name": others[-1], "material": random.choice(kinds), "from_m": [-1, y[0]],
                                         "to_m": [width + 1, y[1]]}))
    for i in range(random.randint(0 if others else 1, 1 if large else 3)):
        keys = joint_set(random, f"set {i}", materials, names, others, height, width)
        others.append(keys["name"])
        parts.append(table("[[joint_set]]", keys))
    if chance(random, 0.2):
        parts += [table("[[mapped]]", {"name": "mapped", "material": kinds[0], "file": "traces.csv"}),
                  table("[[file]]", {"name": "traces.csv", "text": "x1_m,y1_m,x2_m,y2_m\n" + "".join(
                      ",".join(f"{random.uniform(0, 1) * size:.3f}" for size in (width, height) * 2) + "\n"
                      for _ in range(3))})]
    parts.append(table("[in_situ_stress]", in_situ(random, rocks[0]["density_kg_per_m3"], height,
                                                   [[-1, height], [width / 2, height * 1.05], [width + 1, height]])))
    parts += [table("[[boundary]]", one) for one in boundaries(random, width, right, height, kinds[0], days, large, rise)]
    start = random.choice([0, 100])
    parts.append(table("[schedule]", {"start": start, "end": start + days}))
    benches = random.randint(0, 3)
    for i in range(benches):
        upper, lower = height * (1 - 0.2 * i), height * (0.8 - 0.2 * i)
        parts.append(table("[[stage]]", {
            "name": f"bench {i}", "date": start + days * (i + 1) / (benches + 1), "remove_m": [
                [[width * (0.55 + 0.08 * i), lower], [width, lower], [width, upper], [width * (0.48 + 0.08 * i), upper]]],
            **({"displacements": "reset"} if chance(random, 0.2) else {})}))
    parts += [table("[[point]]", {"name": f"point {i}", "at_m": [width * random.uniform(0.32, 0.45), height * y]})
              for i, y in enumerate((0.98, 0.55, 0.3)[:random.randint(0, 3)])]
    if creeps:
        parts.append(table("[creep]", creep(random, days)))
    zones = {"size_m": float(f"{math.sqrt(width * height / log_uniform(random, 10, 25 if large else 200)):.4g}")}
    if not large and chance(random, 0.3):
        zones["kind"] = "quadratic"
    if chance(random, 0.2):
        zones["size_at_faces_m"] = zones["size_m"] * uniform(random, 0.4, 1)
    parts.append(table("[zones]", zones))
    if chance(random, 0.3):
        parts.append(table("[cutting]", {"dangling_ends": random.choice(["prune", "extend"]), "smallest_angle_deg":
                                         uniform(random, 0, 10)}))
    if chance(random, 0.3):
        parts.append(table("[averaging]", {"over": random.choice(["edge", "line", "set"]), "stiffness": random.choice(
            ["joint", "lower bound", "upper bound", "staggered"])}))
    parts.append(table("[equilibrium]", equilibrium(random, large)))
    if large:
        parts.append(table("[large_displacements]", {
            "new_contacts": kinds[0], "longest_s": 0.5, **({"release_s": 0.05} if creeps else {}),
            **({"rigid_rocks": [names[0]]} if quick else {"mass_damping_per_s": 1})}))
    parts.append(table("[random]", {"seed": random.randrange(2**31)}))
    return "\n".join(parts)
