#!/usr/bin/python3
"""Which plots suit a scene: all that have something to show.

    suited.py SCENE.toml      prints the names NAME of their scripts plot_NAME.py
"""

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


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8-sig") as file:  # with or without a byte order mark
        print(*suited(tomllib.loads(file.read())))
