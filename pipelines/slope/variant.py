#!/usr/bin/python3
"""A harder variant of a scene: the same text but for the dip deviations, or the spacings, of its joint sets.

    variant.py SCENE.toml --dip-deviation 8 -o NAME.toml          all dips deviate by 8 degrees
    variant.py SCENE.toml --spacing-times 0.25 -o NAME.toml       spacings a quarter of the scene's

Only numbers inside the laws change, so that comments, order and every other value stay those of the scene.
"""

import argparse
import copy
import re
import tomllib

from scene_text import NotWanted, write_variant

LAW = r"^(?P<before>{law} = {{[^}}]*\b{key} = )(?P<number>[-+.\w]+)(?P<after>[^}}]*}}.*)$"


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


def changed_text(text, arguments):
    if arguments.dip_deviation is not None:
        return variant(text, "dip", ["deviation_deg"], lambda _: arguments.dip_deviation)
    return variant(text, "spacing", ["mean_m", "deviation_m"], lambda number: number * arguments.spacing_times)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--dip-deviation", type=float, metavar="DEGREES", help="of the normal law of every set's dip")
    what.add_argument("--spacing-times", type=float, metavar="FACTOR", help="applied to mean and deviation")
    write_variant(parser, changed_text)


if __name__ == "__main__":
    main()
