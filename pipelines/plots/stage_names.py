#!/usr/bin/python3
"""What file names and --state call the stages of a scene: plain words, safe in a shell and in a makefile.

    stage_names.py SCENE.toml      prints them, in the order of the scene

A word has letters, digits, "." and "_" of the stage's name, and "-" for all else, 80 characters at most. A word that another stage
has, or that means something else to --state, gets a number after it.
"""

import re
import sys
import tomllib

LONGEST = 80  # characters; names of files have a limit


def plain(names):
    """A word for each name, all different."""
    words = []
    for name in names:
        word = re.sub(r"[^A-Za-z0-9._]+", "-", name)[:LONGEST].strip("-.") or "stage"
        number, unique = 2, "stage-" + word if word.isdecimal() else word
        while unique in [*words, "last"] or (unique != name and unique in names):
            unique, number = f"{word}-{number}", number + 1
        words.append(unique)
    return words


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8-sig") as scene:  # with or without a byte order mark
        print(*plain([str(stage.get("name", "")) for stage in tomllib.loads(scene.read()).get("stage", [])]))
