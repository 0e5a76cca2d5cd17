"""Breaks a valid scene in every way a slip of the hand can, one key at a time, and runs jointgen on each.

    /usr/bin/python3 broken_scenes.py JOINTGEN

The keys come from `JOINTGEN --scene-keys`, the valid scene is every_key.toml beside this file. Each broken scene must
end with exit code 2 and a message that names the file, the line and the key, and must leave no output file behind.
"""

import concurrent.futures
import csv
import io
import pathlib
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).parent
WITH_LOCAL_DAMPING = (
    'damping = "mass"\nmass_damping_per_s = 20\nstiffness_damping_s = 1e-5',
    'damping = "local"\nlocal_damping = 0.8',
)
WITH_TOLERANCE = (
    "step_days = 5",
    "tolerance_m = 1e-5\nfirst_step_days = 0.5\nshortest_step_days = 0.1\nlongest_step_days = 10",
)
LINEAR_STRESS = """elevation_m = 20
compression_xx_MPa = 0
compression_yy_MPa = 0
shear_xy_MPa = 0
compression_xx_gradient_MPa_per_m = 0.013
compression_yy_gradient_MPa_per_m = 0.026487
shear_xy_gradient_MPa_per_m = 0
"""
WITH_GROUND = ("elevation_m = 20\n", "ground_m = [[0, 20], [25, 21], [40, 20]]\n")
WITH_PROFILE = (LINEAR_STRESS, """elevation_m = 20
profile = [{ depth_m = 0, compression_xx_MPa = 1, compression_yy_MPa = 0, shear_xy_MPa = 0 }, \
{ depth_m = 20, compression_xx_MPa = 1.3, compression_yy_MPa = 0.5, shear_xy_MPa = 0.1 }]
""")
WITH_RATIO = (LINEAR_STRESS, "elevation_m = 20\nhorizontal_stress_ratio = 0.5\n")
WITH_LARGE_DISPLACEMENTS = ("""[creep]
step_days = 5
scheme = "published"
stop_rate_mm_per_day = 0.001
""", """[large_displacements]
new_contacts = "gouge"
rigid_rocks = ["hard"]
stiffness_damping_s = 1e-3
mass_damping_per_s = 0.1
release_s = 0.5
longest_s = 20
stop_s = 10
record_every_s = 0.5
energy_tolerance = 0.02
""")
OTHERWISE = {"large_displacements": WITH_LARGE_DISPLACEMENTS, "ground_m": WITH_GROUND, "profile": WITH_PROFILE,
             "in_situ_stress.profile": WITH_PROFILE, "horizontal_stress_ratio": WITH_RATIO,
             "local_damping": WITH_LOCAL_DAMPING, "tolerance_m": WITH_TOLERANCE, "first_step_days": WITH_TOLERANCE,
             "shortest_step_days": WITH_TOLERANCE, "longest_step_days": WITH_TOLERANCE}  # keys not in every_key.toml
CHECK_TIME = 60  # s, far more than any check takes


def keys_of(jointgen):
    text = subprocess.run([jointgen, "--scene-keys"], check=True, capture_output=True, text=True).stdout
    return list(csv.DictReader(io.StringIO(text), delimiter="\t", quoting=csv.QUOTE_NONE))


def find(lines, table, key):
    """Index of the line of the table's header and of the key (for a key of a law: of the law)."""
    outer, _, law = table.partition(".")
    header = 0
    for i, line in enumerate(lines):
        if line.startswith("["):
            header = i
        inside = lines[header].strip("[]") == outer or (outer == "-" and header == 0)
        if inside and line.startswith((law or key) + " =") and (not law or re.search(rf"[{{,] {key} =", line)):
            return header, i
    raise SystemExit(f"every_key.toml has no {table} {key}")


def wrap(kind, number):
    """The number where a value of this kind has one."""
    corners = f"[[{number}, 0], [1, 0], [0, 1]]"
    lists = {"point": f"[0, {number}]", "polyline": f"[[0, {number}], [1, 0]]", "load history": f"[[1, 0], [2, {number}]]", "polygon": corners,
             "polygons": f"[{corners}]"}
    return lists.get(kind, number)


def outside(bound, step):
    """A number outside the bound: the bound itself if it is open."""
    number = float(bound.strip("[]()"))
    return repr(number if bound[0] == "(" or bound[-1] == ")" else number + step * max(1, abs(number)))


def broken_values(key):
    kind = key["kind"]
    wrong_type = {"text": "1", "file text": "1", "names": '"flat"', "number": '"1"', "integer": "1.5", "date": '"1994-06-05"', "point": "[1, 2, 3]",
                  "load history": "[[1, 2, 3]]", "polygon": "[[0, 0], [1, 1]]",
                  "polygons": "[[0, 0], [1, 0], [1, 1]]"}
    yield "wrong type", wrong_type.get(kind, "1")
    yield "a flag", "true"
    yield "a time", "12:00:00"
    yield "a list", "[]"
    for number in ("nan", "inf", "-inf", "1e300", "-1e300"):
        yield number, wrap(kind, number)
    if key["minimum"] != "-":
        yield "below the minimum", wrap(kind, outside(key["minimum"], -1))
        yield "above the maximum", wrap(kind, outside(key["maximum"], 1))
    if kind == "text":
        yield "empty", '""'
        yield "control character", '"a\\u0007"'
        yield "control character beyond ASCII", '"a\\u0085"'
        yield "no character of XML", '"a\\uFFFE"'
    if kind.startswith('"'):
        yield "no such word", '"none of these"'


def variants(key, text):
    """(what, broken text, line to be named, name to be named)"""
    lines = text.split("\n")
    table, name = key["table"], key["key"]
    header, at = find(lines, table, name)
    in_law = "." in table
    entry = rf"(?<=[{{,] ){name} = (\"[^\"]*\"|\[\[.*?\]\]|[^,}}]*[^,}} ])" if in_law else rf"^{name} = .*$"

    def edited(new):
        return "\n".join(lines[:at] + [re.sub(entry, lambda _: new, lines[at])] + lines[at + 1 :])

    for what, value in broken_values(key):
        yield what, edited(f"{name} = {value}"), at + 1, name
    old = re.search(entry, lines[at]).group(0)
    yield "misspelt", edited(old.replace(name, name + "_x", 1)), at + 1, name + "_x"
    if in_law:
        yield "twice", edited(f"{old}, {old}"), at + 1, name
    else:
        yield "twice", edited(f"{old}\n{old}"), at + 2, name
    if key["required"] in ("yes", "together"):
        if in_law:
            yield "missing", edited("").replace("{ , ", "{ ").replace(", , ", ", ").replace(",  }", " }"), at + 1, name
        else:
            yield "missing", "\n".join(lines[:at] + [""] + lines[at + 1 :]), header + 1, name


def wrong_together(text):
    """Values that are wrong beside others: (what, name to be named, its line, broken text)"""
    def edited(*changes):
        new = text
        for old, by in changes:
            if new.count(old) != 1:
                raise SystemExit(f"every_key.toml has '{old}' {new.count(old)} times")
            new = new.replace(old, by)
        return new

    through = "ground_m = [[0, 20], [25, 19], [40, 20]]"
    below = "ground_m = [[0, -5], [40, -5]]"
    for what, line in (("through the section", through), ("below the section", below)):
        yield what, "ground_m", line, edited(("elevation_m = 20\n", line + "\n"))
    fine = "fine_m = [[50, 5], [60, 5], [60, 9]]"
    yield "outside the section", "fine_m", fine, edited(("fine_m = [[5, 5], [35, 5], [35, 20], [5, 20]]", fine))
    yield "above size_m", "size_at_faces_m", "size_at_faces_m = 5", edited(("size_at_faces_m = 2", "size_at_faces_m = 5"))
    profile = WITH_PROFILE[1].split("\n")[1]
    yield "beside one linear key", "profile", profile, edited((LINEAR_STRESS, WITH_PROFILE[1] + "shear_xy_MPa = 0\n"))
    strength = "cohesion_MPa = 0.5\nfriction_angle_deg = 35\ntensile_strength_MPa = 0.2\n"
    dilation = "dilation_angle_deg = 8"
    yield "without a strength", "friction_angle_deg", dilation, edited((strength + dilation, dilation))


def fault(jointgen, folder, number, text, line, name):
    """What is wrong with jointgen's answer to a broken scene, or None."""
    own = pathlib.Path(folder) / str(number)
    own.mkdir()
    scene = own / "broken.toml"
    scene.write_text(text)
    command = [jointgen, str(scene), "-o", str(own / "network.h5"), "--quiet"]
    run = subprocess.run(command, capture_output=True, text=True, timeout=CHECK_TIME)
    left = [path.name for path in own.iterdir() if path != scene]
    if run.returncode != 2:
        return f"exit code {run.returncode}: {run.stderr.strip()}"
    if left:
        return f"left {left}"
    place = re.search(r"broken\.toml\D*(\d+)", run.stderr)
    if not place or int(place.group(1)) != line:
        return f"line {line} is not named: {run.stderr.strip()}"
    if not re.search(rf"(?<![a-zA-Z_]){name}(?![a-zA-Z_])", run.stderr):
        return f"{name} is not named: {run.stderr.strip()}"
    return None


def at_rest(text):
    """Without boundaries that move and unloading increments, which do not go together with [large_displacements]."""
    text = text.replace("displacement_mm = [-0.1, 0]\nload_history = [[1, 0], [4, 1]]\n", "")
    return text.replace("unloading_increments = 2\nincrements_tolerance = 0.02\n", "")


def main():
    jointgen = str(pathlib.Path(sys.argv[1]).resolve())
    text = (HERE / "every_key.toml").read_text()
    broken = []
    for key in keys_of(jointgen):
        otherwise = OTHERWISE.get(key["table"]) or OTHERWISE.get(key["key"])
        base = text.replace(*otherwise) if otherwise else text
        if otherwise is WITH_LARGE_DISPLACEMENTS:
            base = at_rest(base)
        where = f"{key['table']} {key['key']}"
        broken += [(f"{where}, {what}", *rest) for what, *rest in variants(key, base)]
    broken += [(f"{name}, {what}", changed, 1 + changed.split("\n").index(line), name)
               for what, name, line, changed in wrong_together(text)]

    failures = 0
    with tempfile.TemporaryDirectory() as folder:
        for name, valid in (("every_key.toml", text), ("local.toml", text.replace(*WITH_LOCAL_DAMPING)),
                            ("tolerance.toml", text.replace(*WITH_TOLERANCE)),
                            ("ground.toml", text.replace(*WITH_GROUND)),
                            ("large_displacements.toml", at_rest(text).replace(*WITH_LARGE_DISPLACEMENTS)),
                            ("profile.toml", text.replace(*WITH_PROFILE)), ("ratio.toml", text.replace(*WITH_RATIO))):
            scene = pathlib.Path(folder) / name
            scene.write_text(valid)
            command = [jointgen, str(scene), "-o", str(scene) + ".h5", "--check"]
            run = subprocess.run(command, capture_output=True, text=True, timeout=CHECK_TIME)
            if run.returncode != 0:
                raise SystemExit(f"the valid scene {name} is refused: {run.stderr}")
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            answers = pool.map(lambda item: fault(jointgen, folder, item[0], *item[1][1:]), enumerate(broken))
            for (what, *_), wrong in zip(broken, answers):
                if wrong:
                    failures += 1
                    print(f"{what}: {wrong}")
    print(f"{len(broken)} broken scenes, {failures} not refused as they should be")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
