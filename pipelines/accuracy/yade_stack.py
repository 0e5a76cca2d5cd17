"""The stack of stack.py by YADE:  yade -n -x -jTHREADS yade_stack.py CASE.json OUT.json

Rigid cubes of 1 m with a joint beneath each, the lowest one on a fixed cube. They start where they rest. The top one is
taken away, and the others rise, until they have long been as near to where they should be as the case wants, or for so
many seconds at most. Then the pace of steps is measured. The case says whether cubes turn. All is in SI units.

YADE's polyhedra push each other apart with a stiffness times the volume that they share: on an area of 1 m2 that is a
joint's stiffness per area. Steps are a fraction of a chain's stable one, found by trying: with twice longer ones cubes
that may turn never rest. The damping is local.
"""

import json
import sys
import time

from yade import polyhedra_utils

STEP = {True: 0.2, False: 0.5}  # where cubes turn, and where they do not
DAMPING = 0.8
LOOK = 20  # steps between looks
PACE_SECONDS = 3

with open(sys.argv[1]) as file:
    case = json.load(file)
blocks, stiffness, turns = case["blocks"], case["normal_stiffness"], case["turns"]
weight = case["density"] * case["gravity"]
material = PolyhedraMat()
material.density = case["density"]
material.young = 2 * stiffness  # in series with the neighbour's
material.poisson = case["shear_stiffness"] / stiffness
material.frictionAngle = case["friction_angle"]


def add_cube(middle, fixed):
    corners = [(x, y, middle + z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
    body = polyhedra_utils.polyhedra(material, v=corners, fixed=fixed)
    if not fixed:
        body.state.blockedDOFs = "yXZ" if turns else "yXYZ"
    return O.bodies.append(body)


def unbalanced_force_ratio():
    """Largest unbalanced force on a cube, over the mean of the sum of the magnitudes of all."""
    sums = dict.fromkeys(ids, weight)
    for contact in O.interactions:
        for i in (contact.id1, contact.id2):
            if i in sums:
                sums[i] += (contact.phys.normalForce + contact.phys.shearForce).norm()
    worst = max((O.forces.f(i) - Vector3(0, 0, weight)).norm() for i in ids)
    return worst * len(sums) / sum(sums.values())


class Watch:
    """How the cubes rise; looking does not count as time."""

    def __init__(self):
        self.exact = [(i + 1) * weight / stiffness for i in range(len(ids))]
        self.start = [O.bodies[i].state.pos[2] for i in ids]
        self.first, self.within, self.seconds, self.since = O.iter, None, 0, time.time()

    def look(self):
        self.seconds += time.time() - self.since
        self.steps = O.iter - self.first
        rises = [O.bodies[i].state.pos[2] - start for i, start in zip(ids, self.start)]
        self.error = max(abs(rise - exact) for rise, exact in zip(rises, self.exact)) / self.exact[-1]
        if self.error > case["enough"]:
            self.within = None
        elif not self.within:
            self.within = self.steps, self.seconds
        if self.seconds > case["seconds"] or self.within and self.steps > 2 * self.within[0]:
            O.pause()
        self.since = time.time()


def pace():
    """Steps per second, of so many that their time is that of steps."""
    steps = 10
    while True:
        before = time.time()
        O.run(steps, True)
        taken = time.time() - before
        if taken > PACE_SECONDS:
            return steps / taken
        steps = int(steps * max(2, min(10, 1.2 * PACE_SECONDS / taken)))


add_cube(-0.5, True)
ids, top = [], 0
for i in range(blocks):
    top += 1 - (blocks - i) * weight / stiffness
    ids.append(add_cube(top - 0.5, False))
steps = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Polyhedra_Aabb()]),
    InteractionLoop([Ig2_Polyhedra_Polyhedra_PolyhedraGeom()], [Ip2_PolyhedraMat_PolyhedraMat_PolyhedraPhys()],
                    [Law2_PolyhedraGeom_PolyhedraPhys_Volumetric()]),
    NewtonIntegrator(damping=DAMPING, gravity=(0, 0, -case["gravity"])),
]
O.engines = steps
O.dt = STEP[turns] * (case["density"] / stiffness) ** 0.5
O.run(LOOK, True)
O.bodies.erase(ids.pop())
watch = Watch()
O.engines = steps + [PyRunner(command="watch.look()", iterPeriod=LOOK, firstIterRun=O.iter + LOOK)]
O.run()
O.wait()
O.engines = steps
found = {"steps": watch.steps, "seconds": watch.seconds, "error": watch.error, "within": watch.within,
         "unbalanced_force_ratio": unbalanced_force_ratio(), "steps_per_s": pace(),
         "contacts": sum(1 for contact in O.interactions if contact.isReal)}
with open(sys.argv[2], "w") as file:
    json.dump(found, file)
