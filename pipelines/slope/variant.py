#!/usr/bin/python3
"""A harder variant of a scene: the same text but for the dip deviations, or the spacings, of its joint sets.

    variant.py SCENE.toml --dip-deviation 8 -o NAME.toml          all dips deviate by 8 degrees
    variant.py SCENE.toml --spacing-times 0.25 -o NAME.toml       spacings a quarter of the scene's

Only numbers inside the laws change, so that comments, order and every other value stay those of the scene.
"""

import argparse
import copy
import os
import re
import sys
import tomllib

LAW = r"^(?P<before>{law} = {{[^}}]*\b{key} = )(?P<number>[-+.\w]+)(?P<after>[^}}]*}}.*)$"


class NotWanted(Exception):
    """The scene cannot be changed as asked."""


def with_number(text, law, key, change):
    """The text with `change` applied to this key of this law, in every joint set that has it."""
    def edited(match):
        return f"{match['before']}{change(float(match['number'])):g}{match['after']}"

    return re.sub(LAW.format(law=law, key=key), edited, text, flags=re.MULTILINE)


def changed(scene, law, keys, change):
    """What the changed text must say, as tomllib reads it."""
    wanted = copy.deepcopy(scene)
    for joint_set in wanted.get("joint_set", []):
        for key in keys:
            if key in joint_set.get(law, {}):
                joint_set[law][key] = float(f"{change(joint_set[law][key]):g}")
    return wanted


def variant(text, law, keys, change):
    scene = tomllib.loads(text)
    for key in keys:
        text = with_number(text, law, key, change)
    if tomllib.loads(text) == scene:
        raise NotWanted(f"no joint set has a {law} with {' or '.join(keys)} that this would change")
    if tomllib.loads(text) != changed(scene, law, keys, change):
        raise NotWanted(f"a joint set's {law} is not written as one line: {law} = {{ law = ..., {keys[0]} = ... }}")
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", metavar="SCENE.toml")
    parser.add_argument("-o", "--output", metavar="NAME.toml", required=True)
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--dip-deviation", type=float, metavar="DEGREES", help="of the normal law of every set's dip")
    what.add_argument("--spacing-times", type=float, metavar="FACTOR", help="applied to mean and deviation")
    arguments = parser.parse_args()

    try:
        with open(arguments.scene, encoding="utf-8") as file:
            text = file.read()
        if arguments.dip_deviation is not None:
            text = variant(text, "dip", ["deviation_deg"], lambda _: arguments.dip_deviation)
        else:
            text = variant(text, "spacing", ["mean_m", "deviation_m"], lambda number: number * arguments.spacing_times)
        partial = f"{arguments.output}.partial-{os.getpid()}"
        with open(partial, "w", encoding="utf-8") as file:
            file.write(text)
        os.replace(partial, arguments.output)
    except (OSError, NotWanted, tomllib.TOMLDecodeError) as error:
        print(f"variant.py: {arguments.scene}: {error}", file=sys.stderr)
        sys.exit(2)


if __name__ == "__main__":
    main()
