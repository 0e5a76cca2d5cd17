"""Figures of some scenes, as they were: a change that is not meant to change a result changes none of these.

figures.csv has three for each dataset: how many numbers it has, the sum of their sizes, and a sum in which each place has a weight
of its own. They are no truth, and other tests tell what is right. After a change that is meant, write them anew, and say in the
commit why they changed:

    JOINTCREEP_RENEW_FIGURES=1 ctest --preset test -R pipeline/figures
"""

import csv
import os

import h5py
import numpy

from chain import ChainTest, main

CUT = [  # scene, realizations
    ("tests/pipeline/kinds/scene.toml", 2),
    ("tests/pipeline/random_slope.toml", 3),
    ("tests/pipeline/every_key.toml", 1),
    ("pipelines/studies/small.toml", 2),
    ("data/slope/scene.toml", 1),
    ("data/shiplock/section-a.toml", 1),
    ("data/cavern/scene.toml", 1),
    ("data/verification/hole/scene.toml", 1),
]
SOLVED = ["tests/pipeline/benches.toml", "tests/pipeline/random_slope.toml", "tests/pipeline/bonded.toml",
          "data/column/scene.toml", "data/verification/punch/scene.toml", "data/verification/slipping-crack/scene.toml",
          "data/verification/opening-joints/scene.toml"]
# Ways to an equilibrium, and how near to balance it is, may differ where processors round otherwise.
LEFT_OUT = ("provenance/", "equilibria/", "guards/", "names/", "engine/")
CLOSE = {"joints.h5": 1e-9, "result.h5": 1e-6}  # of the sums of sizes


def figures(path):
    """{dataset: (count, sum of sizes, weighted sum)} of all numbers in a file that are finite."""
    found = {}

    def note(name, item):
        if isinstance(item, h5py.Dataset) and item.dtype.kind in "fiu" and not name.startswith(LEFT_OUT):
            values = numpy.asarray(item[:], float).ravel()
            values = values[numpy.isfinite(values)]
            weight = 0.5 + numpy.modf(0.6180339887498949 * numpy.arange(1, values.size + 1))[0]
            found[name] = (values.size, float(numpy.sum(numpy.abs(values))), float(numpy.sum(weight * values)))

    with h5py.File(path) as file:
        file.visititems(note)
    return found


class Figures(ChainTest):
    file = "tests/pipeline/figures.csv"

    def joints(self, scene, *options):
        """Path of the joints file of a scene file; the options are jointgen's."""
        network = self.chain.run("jointgen", self.chain.source / scene, self.chain.new_folder() / "network.h5", "--quiet", *options)
        return self.chain.run("strength-averaging", network, network.with_name("joints.h5"), "--quiet")

    def made(self):
        """(scene, file, dataset) and its figures, of all runs."""
        for scene, realizations in CUT:
            for realization in range(realizations):
                for dataset, values in figures(self.joints(scene, "--report", "--realization", realization)).items():
                    yield (f"{scene} {realization}", "joints.h5", dataset), values
        for scene in SOLVED:
            joints = self.joints(scene)
            result = self.chain.run("demsolve", joints, joints.with_name("result.h5"), "--quiet")
            known = figures(joints)
            for dataset, values in figures(result).items():
                if dataset not in known:
                    yield (scene, "result.h5", dataset), values

    def test_as_they_were(self):
        made = dict(self.made())
        path = self.chain.source / self.file
        if os.environ.get("JOINTCREEP_RENEW_FIGURES"):
            with open(path, "w", newline="") as file:
                writer = csv.writer(file, lineterminator="\n")
                writer.writerow(["scene and realization", "file", "dataset", "count", "sum of sizes", "weighted sum"])
                writer.writerows([*key, count, f"{sizes:.12g}", f"{weighted:.12g}"]
                                 for key, (count, sizes, weighted) in made.items())
        with open(path, newline="") as file:
            known = {tuple(row[:3]): tuple(map(float, row[3:])) for row in list(csv.reader(file))[1:]}
        self.assertGreater(len(known), 500)
        self.assertEqual(set(made), set(known), "datasets of files")
        different = []
        for key, (count, sizes, weighted) in known.items():
            its_count, its_sizes, its_weighted = made[key]
            allowed = CLOSE[key[1]] * sizes
            if count != its_count or abs(its_sizes - sizes) > allowed or abs(its_weighted - weighted) > allowed:
                different.append(f"{' '.join(key)}: {made[key]}, was {known[key]}")
        self.assertFalse(different, "\n" + "\n".join(different))


if __name__ == "__main__":
    main()
