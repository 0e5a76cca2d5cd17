#!/usr/bin/python3
"""data/verification/friction-stack by CalculiX, another code: where the top goes as it is pushed and let go.

    calculix_stack.py OUT.csv [--size M] [--increments N]

Writes the input of CalculiX, runs it (Debian's calculix-ccx 2.20, which nothing else wants) and puts the displacement of
points into OUT.csv. data/verification/friction-stack/calculix.csv is from the defaults. With 16 increments the top goes 0.7
percent less far; with bricks of 0.25 m, 1 percent; 128 increments it does not get through.

Blocks are bricks with incompatible modes, one layer between planes that do not move across: plane strain. Between them is
contact from face to face by penalty, of slope K_n closing and K_s sticking, with friction: the same law as a joint without
cohesion. Blocks overlap by p / K_n and start with the stress in situ, so that they start in balance.
"""

import argparse
import re
import subprocess
import tempfile
from pathlib import Path

YOUNGS_MODULUS, POISSONS_RATIO = 10e9, 0.2  # [Pa], [-]
K_N, K_S, FRICTION = 20e9, 8e9, 0.5773502691896258  # [Pa/m], [Pa/m], tan(30 degrees)
PRESSED, PUSHED = 1e6, 2.07e6  # [Pa]
WIDTH, HEIGHT, BLOCKS = 4, 1, 3  # of a block [m]
POINTS = {"top": (2, 3), "middle": (2, 1.5), "lower": (2, 0.5), "toe": (4, 1.5)}  # [m]


class Deck:
    def __init__(self, size):
        self.size = size
        self.across, self.up = round(WIDTH / size), round(HEIGHT / size)
        self.in_block = 2 * (self.across + 1) * (self.up + 1)

    def node(self, block, i, j, k):
        return 1 + block * self.in_block + (j * (self.across + 1) + i) * 2 + k

    def node_at(self, place):
        x, y = place
        block = min(int(y / HEIGHT), BLOCKS - 1)
        return self.node(block, round(x / self.size), round((y - block * HEIGHT) / self.size), 0)

    def element(self, block, i, j):
        return 1 + (block * self.up + j) * self.across + i

    def text(self, increments):
        overlap = PRESSED / K_N
        nodes, elements, layer = [], [], range(BLOCKS)
        for b in layer:
            for j in range(self.up + 1):
                for i in range(self.across + 1):
                    nodes += [f"{self.node(b, i, j, k)}, {i * self.size:.9g}, "
                              f"{b * (HEIGHT - overlap) + j * self.size:.12g}, {k * self.size:.9g}" for k in (0, 1)]
            for j in range(self.up):
                for i in range(self.across):
                    corners = [self.node(b, i + x, j + y, k) for k in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
                    elements.append(", ".join(map(str, [self.element(b, i, j), *corners])))
        columns, rows = range(self.across), range(self.up)
        surfaces = {f"low{b}": [f"{self.element(b, i, 0)}, S3" for i in columns] for b in layer}
        surfaces |= {f"high{b}": [f"{self.element(b, i, self.up - 1)}, S5" for i in columns] for b in layer}
        faces = "\n".join(f"*SURFACE, NAME={name}, TYPE=ELEMENT\n" + "\n".join(of) for name, of in surfaces.items())
        pairs = "\n".join("*CONTACT PAIR, INTERACTION=joint, TYPE=SURFACE TO SURFACE\n" f"low{b + 1}, high{b}"
                          for b in range(BLOCKS - 1))
        base = "\n".join(str(self.node(0, i, 0, k)) for i in range(self.across + 1) for k in (0, 1))
        press = "\n".join(f"{self.element(BLOCKS - 1, i, self.up - 1)}, P5, {PRESSED}" for i in columns)
        push = "\n".join(f"{self.element(BLOCKS - 1, 0, j)}, P6, {PUSHED}" for j in rows)
        points = "\n".join(str(self.node_at(place)) for place in POINTS.values())
        lines = "\n".join
        steps = "\n".join(f"""*STEP, INC=100000
*STATIC, DIRECT
{1 / increments:.12g}, 1
*DLOAD, OP=NEW
{press}
*DLOAD, AMPLITUDE={course}
{push}
*NODE PRINT, NSET=points, FREQUENCY={increments}
U
*END STEP""" for course in ("on", "off"))
        return f"""*NODE, NSET=all
{lines(nodes)}
*ELEMENT, TYPE=C3D8I, ELSET=rock
{lines(elements)}
*NSET, NSET=base
{base}
*NSET, NSET=points
{points}
{faces}
*MATERIAL, NAME=rock
*ELASTIC
{YOUNGS_MODULUS}, {POISSONS_RATIO}
*SOLID SECTION, ELSET=rock, MATERIAL=rock
*SURFACE INTERACTION, NAME=joint
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
{K_N}
*FRICTION
{FRICTION}, {K_S}
{pairs}
*BOUNDARY
base, 1, 2
all, 3, 3
*INITIAL CONDITIONS, TYPE=STRESS
{lines(f"{e}, {p}, 0, {-PRESSED}, 0, 0, 0, 0" for e in range(1, BLOCKS * self.up * self.across + 1) for p in range(1, 9))}
*AMPLITUDE, NAME=on
0, 0, 1, 1
*AMPLITUDE, NAME=off
0, 1, 1, 0
{steps}
"""


def displacements(printed):
    """{x, y} of each node that is printed at the end of each step [m]."""
    tables = re.findall(r"displacements \(vx,vy,vz\) for set POINTS and time\s+\S+\n\n((?:.+\n)+)", printed)
    rows = [[line.split() for line in table.splitlines()] for table in tables]
    return [{int(node): (float(x), float(y)) for node, x, y, _ in table} for table in rows]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("out")
    parser.add_argument("--size", type=float, default=0.125, help="of bricks [m]")
    parser.add_argument("--increments", type=int, default=32, help="of the push, and of letting go")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="jointcreep-") as folder:
        deck = Deck(given.size)
        (Path(folder) / "stack.inp").write_text(deck.text(given.increments))
        done = subprocess.run(["ccx", "stack"], cwd=folder, capture_output=True, text=True)
        if done.returncode != 0 or "Job finished" not in done.stdout:
            raise SystemExit(done.stdout[-2000:])
        found = displacements((Path(folder) / "stack.dat").read_text())
    lines = ["# by pipelines/accuracy/calculix_stack.py: CalculiX 2.20, "
             f"bricks of {given.size:g} m, {given.increments} increments a step", "point,x_m,y_m,step,moved_x_m,moved_y_m"]
    for step, moved in zip(("pushed", "let go"), found, strict=True):
        for name, place in POINTS.items():
            x, y = moved[deck.node_at(place)]
            lines.append(f"{name},{place[0]:g},{place[1]:g},{step},{x:.6e},{y:.6e}")
    Path(given.out).write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
