"""Random networks as jointgen writes them: blocks fill the section, and every edge is accounted for."""

import math
import tomllib

import numpy

from chain import ChainTest, datasets, main

REALIZATIONS = 20
BOUNDARY, JOINT, WELDED = 0, 1, 2  # kinds of edge


def area(corners):
    """By the shoelace formula, about the first corner; counter-clockwise is positive."""
    x, y = (numpy.asarray(corners) - corners[0]).T
    return math.fsum(x * numpy.roll(y, -1) - y * numpy.roll(x, -1)) / 2


def rings(network):
    """Block and vertices of every ring."""
    first_ring, first_corner = network["/blocks/first_ring"], network["/rings/first_corner"]
    for block in range(len(first_ring) - 1):
        for ring in range(first_ring[block], first_ring[block + 1]):
            yield block, network["/rings/vertex"][first_corner[ring] : first_corner[ring + 1]]


def distance_to_segments(points, start, end):
    """Distance of points [n, k, 2] to segments [n, 2]."""
    along = (end - start)[:, None]
    share = ((points - start[:, None]) * along).sum(-1) / (along**2).sum(-1)
    return numpy.linalg.norm(points - start[:, None] - numpy.clip(share, 0, 1)[..., None] * along, axis=-1)


def length_inside(polygon, start, end):
    """Length of a segment inside a polygon."""
    p, q = numpy.asarray(polygon, float), numpy.roll(numpy.asarray(polygon, float), -1, axis=0)

    def cross(a, b):
        return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]

    along, sides = end - start, q - p
    with numpy.errstate(divide="ignore", invalid="ignore"):
        at = cross(p - start, sides) / cross(along, sides)
        side = cross(p - start, along) / cross(along, sides)
    cuts = numpy.sort(numpy.concatenate([[0, 1], at[(at > 0) & (at < 1) & (side >= 0) & (side <= 1)]]))
    inside = 0
    for a, b in zip(cuts, cuts[1:]):
        x, y = start + (a + b) / 2 * along
        crossed = (p[:, 1] > y) != (q[:, 1] > y)
        with numpy.errstate(divide="ignore", invalid="ignore"):
            to_right = x < p[:, 0] + (y - p[:, 1]) / sides[:, 1] * sides[:, 0]
        inside += (b - a) * (numpy.count_nonzero(crossed & to_right) % 2)
    return inside * numpy.linalg.norm(along)


class Blocks(ChainTest):
    def check_all(self, name, *checks):
        text = self.chain.text(f"tests/pipeline/{name}.toml")
        scene = tomllib.loads(text)
        for realization in range(REALIZATIONS):
            with self.subTest(realization=realization):
                network = datasets(self.chain.network(text, "--realization", realization))
                for check in checks:
                    check(network, scene)

    def check_areas(self, network, scene):
        section = abs(area(scene["section"]["outline_m"]))
        areas = network["/blocks/area"]
        self.assertLess(abs(math.fsum(areas) / section - 1), 1e-12)
        found = numpy.zeros(len(areas))
        for block, vertices in rings(network):
            found[block] += area(network["/vertices/position"][vertices])
        self.assertLess(numpy.abs(found / areas - 1).max(), 1e-12)

    def check_edges(self, network, scene):
        """Every edge is a boundary, a joint with its id, or bonded, and is twice in rings: once for each side."""
        kind, joint, block = (network["/edges/" + name] for name in ("kind", "joint", "block"))
        self.assertTrue(numpy.isin(kind, [BOUNDARY, JOINT, WELDED]).all())
        self.assertTrue(((joint >= 0) == (kind == JOINT)).all())
        self.assertTrue(((block >= 0).sum(axis=1) == numpy.where(kind == BOUNDARY, 1, 2)).all())
        self.assertLess(joint.max(), len(network["/joints/set"]))

        on_left = {}  # a block lies on the left of its rings' edges
        for ring_block, vertices in rings(network):
            for a, b in zip(vertices, numpy.roll(vertices, -1)):
                self.assertNotIn((a, b), on_left)
                on_left[a, b] = ring_block
        for (a, b), (left, right) in zip(network["/edges/vertex"], block):
            self.assertEqual(on_left.pop((a, b), -1), left)
            self.assertEqual(on_left.pop((b, a), -1), right)
        self.assertFalse(on_left, "rings have edges that are not in the list of edges")

    def check_joints(self, network, scene):
        """From the edge back to its joint, and on to its set and material."""
        fraction, joint = network["/edges/joint_fraction"], network["/edges/joint"]
        self.assertTrue((fraction >= 0).all() and (fraction <= 1).all())
        self.assertTrue((fraction[joint < 0] == 0).all())

        # The edge lies on its joint's line, but for what cutting reports to have moved. Joints are drawn longer by
        # shortest_edge_m at both ends.
        on_joint = joint >= 0
        ends = network["/vertices/position"][network["/edges/vertex"]][on_joint]
        start, end = (network["/joints/" + name][joint[on_joint]] for name in ("from", "to"))
        shortest_edge = scene.get("cutting", {}).get(
            "shortest_edge_m", 0.02 * scene["zones"].get("size_at_faces_m", scene["zones"]["size_m"]))
        longer = shortest_edge * (end - start) / numpy.linalg.norm(end - start, axis=1)[:, None]
        largest_move = network["/cutting/largest_move"][0]
        self.assertLess(distance_to_segments(ends, start - longer, end + longer).max(), largest_move + 1e-9)

        declared = [*scene.get("joint_set", []), *scene.get("joint", [])]
        self.assertEqual(list(network["/names/joint_set"]), [one["name"] for one in declared])
        materials = [network["/names/joint_material"][m] for m in network["/joints/material"]]
        self.assertEqual(materials, [declared[s]["material"] for s in network["/joints/set"]])
        numbers = list(zip(network["/joints/set"], network["/joints/number"]))
        self.assertEqual(len(numbers), len(set(numbers)))

        # No joint length is made, and none is lost but what is reported, and what moving ends has made shorter.
        length = numpy.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        cut_open = (length * fraction[on_joint]).sum()
        outline = scene["section"]["outline_m"]
        traces = sum(length_inside(outline, a, b) for a, b in zip(network["/traces/from"], network["/traces/to"]))
        lost = sum(network["/cutting/" + name][0] for name in ("merged_edge_length", "pruned_length"))
        moved = largest_move * network["/cutting/merged_vertices"][0]
        self.assertLess(cut_open, traces + moved)
        self.assertGreater(cut_open, traces - lost - moved)

    def check_stages(self, network, scene):
        """A block lies wholly in what its stage removes, or wholly outside all stages: areas tell."""
        names = list(network["/names/stage"])
        self.assertEqual(names, [stage["name"] for stage in scene["stage"]])
        slack = network["/cutting/largest_move"][0]
        for number, stage in enumerate(scene["stage"]):
            (corners,) = stage["remove_m"]
            removed = network["/blocks/area"][network["/blocks/stage"] == number].sum()
            around = sum(math.dist(a, b) for a, b in zip(corners, corners[1:] + corners[:1]))
            self.assertLess(abs(removed - abs(area(corners))), slack * around)
        self.assertTrue((network["/edges/kind"] == WELDED).any())

    def test_patch(self):
        self.check_all("patch", self.check_areas, self.check_edges, self.check_joints)

    def test_random_slope(self):
        self.check_all("random_slope", self.check_areas, self.check_edges, self.check_joints, self.check_stages)

    def test_cgal_cuts_the_same_blocks(self):
        """Bit by bit, with merging, stages, terminations and mapped traces. What became of each metre of a joint is summed in
        other pieces outside the section, where CGAL finds crossings, too: that may differ by rounding."""
        scenes = ["tests/pipeline/random_slope.toml", "tests/pipeline/benches.toml", "tests/pipeline/every_key.toml",
                  "tests/pipeline/patch.toml", "data/slope/scene.toml"]
        for scene in scenes:
            for realization in range(3):
                with self.subTest(scene=scene, realization=realization):
                    text = self.chain.text(scene)
                    if "random_slope" in scene:  # edges on two joints
                        text += '[[joint]]\nname = "again"\nmaterial = "joint"\nfrom_m = [16, 25]\nto_m = [48, 15]\n'
                    own = datasets(self.chain.network(text, "--realization", realization, "--cut-with", "own"))
                    by_cgal = datasets(self.chain.network(text, "--realization", realization, "--cut-with", "cgal"))
                    self.assertEqual(own.keys(), by_cgal.keys())
                    self.assertGreater(len(own["/blocks/area"]), 1)
                    for name, values in own.items():
                        if name.startswith("/fates/") and values.dtype == float:
                            numpy.testing.assert_allclose(values, by_cgal[name], rtol=1e-13, atol=1e-11, err_msg=name)
                        elif name != "/provenance/options":
                            self.assertEqual(values.tobytes() if values.dtype != object else list(values),
                                             by_cgal[name].tobytes() if values.dtype != object else list(by_cgal[name]), name)
        done = self.chain.answer("jointgen", self.chain.source / scenes[0], "--check", "--cut-with", "other")
        self.assertEqual(done.returncode, 2)
        self.assertIn("own or cgal", done.stderr)


if __name__ == "__main__":
    main()
