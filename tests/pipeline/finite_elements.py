"""Another program for the linear variants of the shiplock's benchmark: finite elements with zero-thickness joint elements.

    finite_elements.py BENCHMARK NUMBER RESULT.h5 [--creep-step DAYS] -o HISTORY.csv

It shares no code with the programs. Section and joints are read from data/shiplock/benchmark; of a result of demsolve it
reads the corners of triangles alone, so that both programs have the same mesh. Triangles have six nodes, plane strain.
Elements are connected where no joint is between them: this follows from the joints, not from the nodes of the file. Joint
elements have springs at the three nodes of their side, with the weights of Simpson's rule. Displacements are total ones:
for every stage the equilibrium of the rock that is left, with its weight and its stress at the start. Joints creep by one
Kelvin unit in each direction, with forces that are linear in a step.

Tension and opening are positive. SI units, days.
"""

import argparse
import csv
import json
import pathlib

import h5py
import numpy as np
import scipy.sparse
import scipy.sparse.csgraph
import scipy.sparse.linalg
import scipy.spatial

MPA = 1e6
NEAR = 1e-6  # m
NODES = 6  # of an element: corners, then the middles of the sides from corner 0 to 1, 1 to 2 and 2 to 0
NODES_OF_SIDE = np.array([[0, 3, 1], [1, 4, 2], [2, 5, 0]])
WEIGHTS = np.array([1, 4, 1]) / 6
STRESS_POINTS = np.array([[4, 1, 1], [1, 4, 1], [1, 1, 4]]) / 6


def is_inside(polygon, places):
    """Which of the places are in a polygon, by the number of its sides to the right of them."""
    inside = np.zeros(len(places), bool)
    corners = np.array(polygon, float)
    for (x0, y0), (x1, y1) in zip(corners, np.roll(corners, -1, axis=0)):
        if y0 != y1:
            crosses = (y0 > places[:, 1]) != (y1 > places[:, 1])
            inside ^= crosses & (places[:, 0] < x0 + (places[:, 1] - y0) * (x1 - x0) / (y1 - y0))
    return inside


def shape_functions(share):
    """Of the nodes at a place given by its shares of the corners."""
    a, b, c = share
    return np.array([a * (2 * a - 1), b * (2 * b - 1), c * (2 * c - 1), 4 * a * b, 4 * b * c, 4 * c * a])


def derivatives(share):
    """Of the shape functions by the three shares; [node, share]."""
    a, b, c = share
    return np.array([[4 * a - 1, 0, 0], [0, 4 * b - 1, 0], [0, 0, 4 * c - 1], [4 * b, 4 * a, 0], [0, 4 * c, 4 * b],
                     [4 * c, 0, 4 * a]])


class Model:
    """A network on a mesh of triangles. `corners` are places of their corners, [element, 3, {x, y}], counter-clockwise."""

    def __init__(self, section, network, corners):
        self.section, self.corners = section, corners
        middle = corners.mean(axis=1)
        rock = np.full(len(corners), [one["name"] for one in section["rocks"]].index(section["rock"]))
        for layer in network["layers"]:
            rock[is_inside(layer["outline_m"], middle)] = [one["name"] for one in section["rocks"]].index(layer["rock"])
        self.rock = [section["rocks"][r] for r in range(len(section["rocks"]))], rock
        self.days = [one["day"] for one in section["stages"]]
        self.stage = np.full(len(corners), len(network["stages"]))  # in which an element is excavated
        for s, one in enumerate(network["stages"]):
            for polygon in one["remove_m"]:
                self.stage[is_inside(polygon, middle)] = s
        self.find_nodes()
        self.find_joints(network)
        self.find_elements()
        self.find_points()

    # --- the mesh

    def find_nodes(self):
        """Numbers of places [element, node], places, and sides that two elements share."""
        n = len(self.corners)
        self.places, number = np.unique(self.corners.reshape(-1, 2), axis=0, return_inverse=True)
        number = number.reshape(n, 3)
        sides = np.sort(np.stack([number, np.roll(number, -1, axis=1)], axis=2), axis=2).reshape(-1, 2)
        ends, side = np.unique(sides, axis=0, return_inverse=True)
        self.number = np.concatenate([number, len(self.places) + side.reshape(n, 3)], axis=1)
        self.places = np.concatenate([self.places, self.places[ends].mean(axis=1)])
        order = np.argsort(side, kind="stable")
        same = np.flatnonzero(side[order][1:] == side[order][:-1])
        self.pairs = np.stack([order[same], order[same + 1]], axis=1)  # positions 3 * element + side of both
        self.ends = ends[side[order[same]]]

    def find_joints(self, network):
        """The material of each pair of sides, or -1."""
        self.materials = network["joint_materials"]
        names = [one["name"] for one in self.materials]
        tree = scipy.spatial.cKDTree(self.places)
        of_side = {tuple(ends): i for i, ends in enumerate(self.ends.tolist())}
        self.material = np.full(len(self.pairs), -1)
        is_corner = np.zeros(len(self.places), bool)
        is_corner[self.number[:, :3]] = True
        for joint in network["joints"]:
            line = np.array(joint["corners_m"])
            for start, end in zip(line, line[1:]):
                length = np.linalg.norm(end - start)
                along = (end - start) / length
                near = np.array(tree.query_ball_point((start + end) / 2, length / 2 + NEAR), int)
                near = near[is_corner[near]]
                way = self.places[near] - start
                near = near[np.abs(way @ [-along[1], along[0]]) < NEAR]
                near = near[np.argsort((self.places[near] - start) @ along)].tolist()
                if len(near) < 2 or np.linalg.norm(self.places[near[0]] - start) > NEAR or \
                        np.linalg.norm(self.places[near[-1]] - end) > NEAR:
                    raise ValueError(f"joint {joint['id']}: no sides of the mesh from {start} to {end}")
                for first, second in zip(near, near[1:]):
                    self.material[of_side[min(first, second), max(first, second)]] = names.index(joint["material"])

    # --- matrices

    def stress_in_situ(self, places):
        """{xx, yy, xy} at places [..., {x, y}] [Pa]."""
        x, y = places[..., 0], places[..., 1]
        depth = np.interp(x, *np.array(self.section["ground_m"], float).T) - y
        levels = self.section["in_situ_stress"]
        depths = np.array([one["depth_m"] for one in levels], float)

        def at(key):
            values = np.array([one[key] for one in levels], float) * MPA
            i = np.clip(np.searchsorted(depths, depth) - 1, 0, len(depths) - 2)
            return values[i] + (values[i + 1] - values[i]) * (depth - depths[i]) / (depths[i + 1] - depths[i])

        return np.stack([-at("compression_xx_MPa"), -at("compression_yy_MPa"), at("shear_xy_MPa")], axis=-1)

    def find_elements(self):
        """Stiffness of each element, and force on its nodes by weight and stress in situ."""
        rocks, rock = self.rock
        n_e, n = len(self.corners), NODES
        x, y = self.corners[..., 0], self.corners[..., 1]
        twice = (x[:, 1] - x[:, 0]) * (y[:, 2] - y[:, 0]) - (x[:, 2] - x[:, 0]) * (y[:, 1] - y[:, 0])
        slopes = np.stack([np.roll(y, -1, axis=1) - np.roll(y, 1, axis=1),
                           np.roll(x, 1, axis=1) - np.roll(x, -1, axis=1)], axis=2) / twice[:, None, None]  # of the shares
        elasticity = np.zeros((len(rocks), 3, 3))
        for c, one in zip(elasticity, rocks):
            modulus, nu = one["youngs_modulus_GPa"] * 1e9, one["poissons_ratio"]
            c[:] = modulus / ((1 + nu) * (1 - 2 * nu)) * np.array([[1 - nu, nu, 0], [nu, 1 - nu, 0], [0, 0, (1 - 2 * nu) / 2]])
        weight = np.array([one["density_kg_per_m3"] for one in rocks])[rock] * self.section["gravity_m_per_s2"]
        self.stiffness = np.zeros((n_e, 2 * n, 2 * n))
        self.load = np.zeros((n_e, n, 2))
        for share in STRESS_POINTS:
            area = twice / 2 / len(STRESS_POINTS)
            slope = np.einsum("ns,esk->enk", derivatives(share), slopes)
            strain = np.zeros((n_e, 3, n, 2))
            strain[:, 0, :, 0], strain[:, 1, :, 1] = slope[..., 0], slope[..., 1]
            strain[:, 2, :, 0], strain[:, 2, :, 1] = slope[..., 1], slope[..., 0]
            strain = strain.reshape(n_e, 3, 2 * n)
            self.stiffness += np.einsum("e,eai,eab,ebj->eij", area, strain, elasticity[rock], strain, optimize=True)
            stress = self.stress_in_situ(np.einsum("s,esk->ek", share, self.corners))
            self.load -= np.einsum("e,eai,ea->ei", area, strain, stress).reshape(n_e, n, 2)
            self.load[:, :, 1] -= (area * weight)[:, None] * shape_functions(share)
        # joint elements: nodes of both sides [joint, spring, {a, b}] as element and node, and springs
        joint = np.flatnonzero(self.material >= 0)
        first, second = self.pairs[joint].T
        self.joint_element = np.stack([first // 3, second // 3], axis=1)
        self.joint_node = np.stack([NODES_OF_SIDE[first % 3], NODES_OF_SIDE[second % 3][:, ::-1]], axis=2)
        at = self.places[self.number[self.joint_element[:, :1], self.joint_node[:, :, 0]]]
        start, end = at[:, 0], at[:, 2]
        length = np.linalg.norm(end - start, axis=1)
        along = (end - start) / length[:, None]
        normal = np.stack([along[:, 1], -along[:, 0]], axis=1)  # outward from the first element
        self.frame = np.stack([normal, along], axis=1)  # [joint, {normal, shear}, {x, y}]
        self.joint_weight = length[:, None] * WEIGHTS
        xx, yy, xy = np.moveaxis(self.stress_in_situ(at), -1, 0)
        pull = np.stack([xx * normal[:, None, 0] + xy * normal[:, None, 1],
                         xy * normal[:, None, 0] + yy * normal[:, None, 1]], axis=-1)
        self.traction_in_situ = np.einsum("jdk,jik->jid", self.frame, pull)  # [joint, spring, {normal, shear}]

        def constants(key):
            return np.array([[one.get(f"{way}_{key}", 0) * MPA for way in ("normal", "shear")]
                             for one in self.materials])[self.material[joint]][:, None, :]

        self.spring, self.kelvin, self.viscosity = map(constants, ("stiffness_MPa_per_m", "kelvin_stiffness_MPa_per_m",
                                                                   "kelvin_viscosity_MPa_day_per_m"))

    def find_points(self):
        """Element of each point and the shape functions there."""
        a, b, c = np.moveaxis(self.corners, 1, 0)
        whole = np.cross(b - a, c - a)
        self.at_points = []
        for point in self.section["points"]:
            place = np.array(point["at_m"], float)
            share = np.stack([np.cross(b - place, c - place), np.cross(c - place, a - place),
                              np.cross(a - place, b - place)], axis=1) / whole[:, None]
            element = np.argmax(np.where(self.stage == len(self.days), share.min(axis=1), -1))
            self.at_points.append((element, shape_functions(share[element])))

    # --- equilibrium

    def connected(self, there):
        """Number of the free or fixed node [element, node] while the elements `there` are."""
        pairs = self.pairs[(self.material < 0) & there[self.pairs // 3].all(axis=1)]
        first, second = (pairs[:, k] // 3 * NODES + NODES_OF_SIDE[pairs[:, k] % 3].T for k in (0, 1))
        second = second[::-1]  # neighbours run along their side in opposite directions
        size = self.number.size
        graph = scipy.sparse.coo_matrix((np.ones(first.size), (first.ravel(), second.ravel())), shape=(size, size))
        return scipy.sparse.csgraph.connected_components(graph, directed=False)[1].reshape(self.number.shape)

    def fixed(self, number, there):
        """Directions [node, {x, y}] in which nodes are fixed."""
        held = np.zeros((number.max() + 1, 2), bool)
        for one in self.section["boundaries"]:
            start, end = np.array(one["from_m"], float), np.array(one["to_m"], float)
            way, off = end - start, self.places - start
            on = (np.abs(np.cross(way, off)) < NEAR * np.linalg.norm(way)) & (off @ way >= 0) & (off @ way <= way @ way)
            nodes = number[on[self.number]]
            for k, axis in enumerate("xy"):
                if axis in one["fix"]:
                    held[nodes, k] = True
        held[np.setdiff1d(np.arange(len(held)), number[there])] = True  # of excavated rock
        return held

    def system(self, there, compliance):
        """A function of the joints' known tractions [joint, spring, {normal, shear}] that solves for displacements
        [element, node, {x, y}], with joint springs softer by a compliance in series."""
        number = self.connected(there)
        held = self.fixed(number, there)
        unknown = np.cumsum(~held.ravel()) - 1
        unknown[held.ravel()] = -1
        dof = unknown[2 * number[..., None] + np.arange(2)]  # [element, node, {x, y}]
        is_there = there[self.joint_element].all(axis=1)
        jump = np.stack([dof[self.joint_element[:, None, k], self.joint_node[..., k]] for k in (0, 1)], axis=2)
        jump = jump.reshape(*jump.shape[:2], 4)  # {a x, a y, b x, b y}
        stiff = self.spring / (1 + self.spring * compliance)
        two = np.einsum("ji,jid,jdk,jdl->jikl", self.joint_weight, np.broadcast_to(stiff, self.traction_in_situ.shape),
                        self.frame, self.frame, optimize=True)
        four = np.concatenate([np.concatenate([two, -two], axis=3), np.concatenate([-two, two], axis=3)], axis=2)
        rows, columns, values = [], [], []
        for numbers, matrix in ((dof[there].reshape(-1, 2 * NODES), self.stiffness[there]),
                                (jump[is_there].reshape(-1, 4), four[is_there].reshape(-1, 4, 4))):
            rows.append(np.repeat(numbers, numbers.shape[1], axis=1).ravel())
            columns.append(np.tile(numbers, (1, numbers.shape[1])).ravel())
            values.append(matrix.ravel())
        rows, columns, values = map(np.concatenate, (rows, columns, values))
        free = (rows >= 0) & (columns >= 0)
        size = unknown.max() + 1
        matrix = scipy.sparse.coo_matrix((values[free], (rows[free], columns[free])), shape=(size, size)).tocsc()
        factor = scipy.sparse.linalg.splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0,
                                          options={"SymmetricMode": True})
        load = np.zeros(size + 1)  # the last one is of fixed directions
        np.add.at(load, dof[there], self.load[there])

        def solve(traction):
            pull = np.einsum("ji,jid,jdk->jik", self.joint_weight, traction, self.frame)
            right = load.copy()
            np.add.at(right, jump[is_there], np.concatenate([pull, -pull], axis=2)[is_there])
            displacement = np.append(factor.solve(right[:-1]), 0)[dof]
            displacement[~there] = 0
            return displacement

        return solve

    def jumps(self, displacement):
        """Displacement of the second side minus that of the first one [joint, spring, {normal, shear}]."""
        sides = [displacement[self.joint_element[:, None, k], self.joint_node[..., k]] for k in (0, 1)]
        return np.einsum("jdk,jik->jid", self.frame, sides[1] - sides[0])

    def at(self, displacement):
        return np.array([shape @ displacement[element] for element, shape in self.at_points])

    def history(self, step=None, stages=None):
        """Days, and displacements of the points since the equilibrium in situ [row, point, {x, y}], after each stage and at the
        end. Joints creep if a longest step is given [day]."""
        elastic = 0 * self.spring
        solve = self.system(self.stage >= 0, elastic)
        at_start = solve(self.traction_in_situ)
        jump_at_start = self.jumps(at_start)
        in_situ = self.traction_in_situ + self.spring * jump_at_start
        crept, change = np.zeros_like(in_situ), np.zeros_like(in_situ)  # in situ nothing creeps
        days, found, day = [], [], 0
        if step:
            rate = self.kelvin / self.viscosity
        for s, date in enumerate([*self.days, self.section["end_day"]][:stages]):
            there = self.stage >= s
            if step and s > 0:  # before the first stage nothing changes
                number = int(np.ceil((date - day) / step))
                x = rate * (date - day) / number
                stay = np.exp(-x)
                late = (1 - (1 - stay) / x) / self.kelvin
                early = (1 - stay) / self.kelvin - late
                solve = self.system(there, late)
                softer = self.spring / (1 + self.spring * late)
                for _ in range(number):
                    offset = stay * crept + early * change
                    displacement = solve(in_situ - softer * (jump_at_start + offset))
                    change = softer * (self.jumps(displacement) - jump_at_start - offset)
                    crept = offset + late * change
            day = date
            if s < len(self.days):
                there = self.stage > s
                displacement = self.system(there, elastic)(in_situ - self.spring * (jump_at_start + crept))
                change = self.spring * (self.jumps(displacement) - jump_at_start - crept)
            days.append(day)
            found.append(self.at(displacement) - self.at(at_start))
        return np.array(days), np.array(found)


def corners_of(result):
    """Places of the corners of the triangles of a result file."""
    with h5py.File(result) as file:
        return file["/mesh/gridpoint_position"][:][file["/mesh/zone_gridpoint"][:]]


def read(folder, name):
    return json.loads((pathlib.Path(folder) / f"{name}.json").read_text(encoding="utf-8"))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("benchmark", "number", "result"):
        parser.add_argument(name)
    parser.add_argument("--creep-step", type=float, metavar="DAYS", help="longest; without it joints do not creep")
    parser.add_argument("-o", "--output", required=True)
    arguments = parser.parse_args()
    section = read(arguments.benchmark, "section")
    model = Model(section, read(arguments.benchmark, f"network-{arguments.number}"), corners_of(arguments.result))
    days, displacement = model.history(arguments.creep_step)
    with open(arguments.output, "w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["day", "event", *(f"{point['name']}_{axis}_mm" for point in section["points"] for axis in "xy")])
        for day, event, row in zip(days, [*(stage["name"] for stage in section["stages"]), "end"], displacement):
            writer.writerow([day, event, *(f"{1e3 * value:.4f}" for value in row.ravel())])


if __name__ == "__main__":
    main()
