"""Text of small scenes: one rock, a few joints and boundaries, no stress in situ unless given."""

import json

import numpy as np

from chain import datasets

GRAVITY = 9.81
STUCK, SLIPPING, OPEN = 1, 2, 3  # status of a contact


def value(of):
    """As TOML writes it; numbers with all their digits."""
    if isinstance(of, str):
        return json.dumps(of)
    if isinstance(of, dict):
        return "{ " + ", ".join(f"{key} = {value(one)}" for key, one in of.items()) + " }"
    if isinstance(of, (list, tuple, np.ndarray)):
        return "[" + ", ".join(map(value, of)) + "]"
    return repr(float(of)) if isinstance(of, (float, np.floating)) else str(of)


def table(heading, keys):
    return heading + "\n" + "".join(f"{key} = {value(of)}\n" for key, of in keys.items())


def material(name, normal, shear=None, friction=30, cohesion=0, tension=0, **more):
    """A joint material: stiffnesses in MPa/m, strengths in MPa and degrees."""
    return {"name": name, "normal_stiffness_MPa_per_m": normal,
            "shear_stiffness_MPa_per_m": normal / 2 if shear is None else shear, "cohesion_MPa": cohesion,
            "friction_angle_deg": friction, "tensile_strength_MPa": tension, **more}


def held(start, end, how="xy", **more):
    """A boundary that does not move in the directions `how`."""
    return {"from_m": start, "to_m": end, "fix": how, **more}


def joint(name, start, end, of="joint"):
    return {"name": name, "from_m": start, "to_m": end, "material": of}


def scene(outline, joints, boundaries, materials, *, gravity=GRAVITY, stages=(), points=(), zone=1.0,
          kind="constant strain", density=2500, modulus=10, poisson=0, stress=(0, 0, 0), in_situ=None, end=None, more=""):
    """A scene. `stages` are lists of polygons, removed on days 1, 2 ...; `points` are places, named by their number;
    `modulus` is in GPa, `stress` the uniform {xx, yy, xy} in MPa, tension positive; `in_situ` has the keys of
    [in_situ_stress] in its place."""
    xx, yy, xy = stress
    parts = [
        table("[section]", {"outline_m": outline, "rock": "rock", "gravity_m_per_s2": gravity}),
        table("[[rock]]", {"name": "rock", "density_kg_per_m3": density, "youngs_modulus_GPa": modulus,
                           "poissons_ratio": poisson}),
        *(table("[[joint_material]]", of) for of in materials),
        *(table("[[joint]]", of) for of in joints),
        table("[in_situ_stress]", in_situ or {"elevation_m": 0, "compression_xx_MPa": -xx, "compression_yy_MPa": -yy,
                                              "shear_xy_MPa": xy, "compression_xx_gradient_MPa_per_m": 0,
                                              "compression_yy_gradient_MPa_per_m": 0, "shear_xy_gradient_MPa_per_m": 0}),
        *(table("[[boundary]]", of) for of in boundaries),
        table("[schedule]", {"start": 0, "end": end or 1 + len(stages)}),
        *(table("[[stage]]", {"name": f"stage {n}", "date": n, "remove_m": list(polygons)})
          for n, polygons in enumerate(stages, 1)),
        *(table("[[point]]", {"name": str(n), "at_m": place}) for n, place in enumerate(points)),
        table("[zones]", {"kind": kind, "size_m": zone}),
        more]
    return "\n".join(parts)


def forces_on(data, contacts, state=-1):
    """Force {x, y} of each of these contacts on its side a, in a state [N/m]."""
    normal = data["/mesh/contact_normal"][contacts]
    along = np.stack([normal[:, 1], -normal[:, 0]], axis=1)
    traction = data["/states/traction"][state][contacts]
    length = data["/mesh/contact_length"][contacts]
    return length[:, None] * (traction[:, :1] * normal + traction[:, 1:] * along)


def contacts_between(data, start, end):
    """Numbers of the contacts that lie on the line from one place to the other."""
    start, end = np.array(start, float), np.array(end, float)
    way = end - start
    off = data["/mesh/contact_centre"] - start
    beside = np.abs(off[:, 0] * way[1] - off[:, 1] * way[0]) / np.linalg.norm(way)
    along = off @ way / (way @ way)
    return np.flatnonzero((beside < 1e-6 * np.linalg.norm(way)) & (along > 0) & (along < 1))


def solved(chain, text, *options):
    """The result's datasets, all finite."""
    data = datasets(chain.result(text, *options))
    for name, values in data.items():
        if values.dtype.kind == "f":
            assert np.isfinite(values).all(), name
    return data
