#!/usr/bin/python3
"""What pictures in docs/pictures were drawn from, so that a test notices stale ones (tests/pipeline/documentation_test.py).

    pictures.py SCENE.toml PREFIX      records it for docs/pictures/PREFIX-*.png, in docs/pictures.txt

A line has the picture, its scene from the project's folder, a digest of what the scene says (comments and layout do not count), and
the number LOOK of pipelines/plots/figure.py.
"""

import hashlib
import json
import pathlib
import sys
import tomllib

ROOT = pathlib.Path(__file__).resolve().parents[1]
RECORD = ROOT / "docs" / "pictures.txt"


def digest_of(scene):
    """Of the values of a scene file."""
    values = tomllib.loads((ROOT / scene).read_text(encoding="utf-8"))
    return hashlib.sha256(json.dumps(values, sort_keys=True, default=str).encode()).hexdigest()[:16]


def recorded():
    """{picture: [scene, digest, look]}"""
    lines = RECORD.read_text().splitlines() if RECORD.exists() else []
    return {line.split()[0]: line.split()[1:] for line in lines}


def made_of(scene):
    """What a line says of a picture that is drawn now."""
    sys.path.append(str(ROOT / "pipelines" / "plots"))
    import figure
    return [str(scene), digest_of(scene), str(figure.LOOK)]


if __name__ == "__main__":
    scene, prefix = pathlib.Path(sys.argv[1]).resolve().relative_to(ROOT), sys.argv[2]
    lines = recorded() | {path.name: made_of(scene) for path in (ROOT / "docs" / "pictures").glob(f"{prefix}-*.png")}
    RECORD.write_text("".join(f"{name} {' '.join(line)}\n" for name, line in sorted(lines.items())))
