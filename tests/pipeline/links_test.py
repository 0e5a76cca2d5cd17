"""The link lines are the architecture: a file includes headers of those libraries only that its own CMakeLists.txt links."""

import re

from chain import ChainTest, main

LIBRARY = re.compile(r"add_jointcreep_library\((\w+)(.*?)\)", re.DOTALL)
APP = re.compile(r"add_jointcreep_app\(([\w-]+) USES ([\w ]+)\)")
INCLUDE = re.compile(r'^\s*#\s*include\s*["<](?:\.\./)*(\w+)/', re.MULTILINE)


def words_after(keyword, arguments):
    """The words between a keyword and the next one."""
    found = re.search(rf"\b{keyword}\b((?:\s+[\w.:]+)*?)(?=\s+[A-Z_]+\b|\s*$)", re.sub(r"#.*", "", arguments))
    return found.group(1).split() if found else []


class Links(ChainTest):
    def setUp(self):
        folder = self.chain.source / "libs"
        self.links, self.public = {}, {}
        for page in folder.glob("*/CMakeLists.txt"):
            name, arguments = LIBRARY.search(page.read_text()).groups()
            self.assertEqual(name, page.parent.name)
            uses = [one for one in words_after("USES", arguments) if (folder / one).is_dir()]
            private = [one for one in words_after("PRIVATE_USES", arguments) if (folder / one).is_dir()]
            self.public[name], self.links[name] = uses, uses + private

    def reached(self, libraries):
        """These libraries and what they pass on."""
        all_of_them, new = set(), set(libraries)
        while new:
            all_of_them |= new
            new = {one for library in new for one in self.public[library]} - all_of_them
        return all_of_them

    def check(self, path, allowed):
        for library in set(INCLUDE.findall(path.read_text())) & self.links.keys():
            self.assertIn(library, allowed, f"{path} includes {library}, which its CMakeLists.txt does not link")

    def test_libraries(self):
        self.assertGreaterEqual(len(self.links), 21)
        for library in self.links:
            allowed = self.reached(self.links[library]) | {library}
            for path in (self.chain.source / "libs" / library).glob("*.[ch]pp"):
                with self.subTest(path.name):
                    self.check(path, allowed)

    def test_no_library_comes_round_to_itself(self):
        for library in self.links:
            self.assertNotIn(library, self.reached(self.links[library]))

    def test_picture(self):
        """The arrows in README.md are links, and lead to whatever a library links."""
        readme = (self.chain.source / "README.md").read_text()
        picture = re.search(r"may use only what its own.*?```\n(.*?)```", readme, re.DOTALL).group(1)
        arrows = {library: set() for library in self.links}
        for chain in re.findall(r"\w+(?:, \w+)*(?: --> \w+(?:, \w+)*)+", picture):
            groups = [group.split(", ") for group in chain.split(" --> ")]
            for left, right in zip(groups, groups[1:]):
                for library in left:
                    arrows[library] |= set(right) & self.links.keys()
        for library, to in arrows.items():
            self.assertLessEqual(to, set(self.links[library]), library)
            drawn, new = set(), to
            while new:
                drawn |= new
                new = set().union(*(arrows[one] for one in new)) - drawn
            self.assertLessEqual(set(self.links[library]), drawn, library)

    def test_scenes_files_and_exports_bring_no_force(self):
        """Who links them names the kinds of force that it uses itself."""
        for library in ("scene", "store", "exchange"):
            self.assertIn("joint", self.links[library], library)
            self.assertFalse(self.reached([library]) & {"rock", "joint", "boundary"}, library)

    def test_programs(self):
        """Each with its own files: demsolve.cpp, demsolve_files.cpp, ..."""
        apps = dict(APP.findall((self.chain.source / "apps/CMakeLists.txt").read_text()))
        self.assertEqual(len(apps), 5)
        found = set()
        for path in (self.chain.source / "apps").glob("*.[ch]pp"):
            app = path.stem.split("_")[0]
            found.add(app)
            if app == "program":
                continue
            with self.subTest(path.name):
                self.check(path, self.reached([*apps[app].split(), "model"]))
        self.assertEqual(found - {"program"}, apps.keys())

    def test_all_tests_are_run(self):
        """Every file of a test is in the CMakeLists.txt of its folder, and every folder in that of tests; fuzz targets are no
        tests."""
        folder = self.chain.source / "tests"
        parts = re.search(r"foreach\(part IN ITEMS ([\w ]+)\)", (folder / "CMakeLists.txt").read_text()).group(1).split()
        self.assertEqual(sorted([*parts, "fuzz"]), sorted(path.parent.name for path in folder.glob("*/CMakeLists.txt")))
        for path in [*folder.glob("*/*_test.cpp"), *folder.glob("*/*_test.py")]:
            page = (path.parent / "CMakeLists.txt").read_text()
            name = path.stem.removesuffix("_test")
            listed = r"(?:UNIT|PROPERTY|ANALYTIC|STATISTICAL)[a-z_ ]* " if path.suffix == ".cpp" else r"(?:_test\(|/)"
            self.assertRegex(page, rf"{listed}{name}\b", path)


if __name__ == "__main__":
    main()
