"""Mutants: N places of the sources in which an operator, a sign or a bound is changed, one at a time. Do the tests find them?

All are compiled into one build of a copy of the sources, and chosen by an environment variable when a test runs: an operator
becomes two with a mark between them (mutant.hpp). Where that does not compile, the place is left out. A mutant is found if
a test of its own folder fails, ends by a signal or takes LONGEST seconds; if none does, the other C++ tests and then the
closed forms of whole programs are tried. Those that no test finds are printed: some change nothing that matters.
"""

import os
import pathlib
import re
import resource
import shutil
import subprocess

from campaign import ROOT, Campaign, chance

LONGEST = 300  # s of the processor, of one test program
GROUPS = {  # sources, and the test programs that are tried first
    "laws": (["libs/joint/*.hpp", "libs/rock/mohr_coulomb.cpp", "libs/rock/mohr_coulomb.hpp"],
             ["joint", "rock", "large_displacements", "creep"]),
    "certificate": (["libs/mechanics/assembly.cpp", "libs/mechanics/rest.cpp", "libs/mechanics/failure.cpp",
                     "libs/relaxation/relax.cpp", "libs/analysis/guards.cpp"],
                    ["mechanics", "implicit", "analysis", "relaxation"]),
    "subdivision": (["libs/blocks/*.cpp"], ["blocks", "zoning"]),
    "statistics": (["libs/statistics/*.cpp"], ["statistics"]),
}
OTHERS = ["joint", "rock", "large_displacements", "mechanics", "creep", "implicit", "sensitivity", "analysis", "blocks", "zoning",
          "statistics", "relaxation", "store", "sampling", "back_analysis"]
WHOLE = ["verification_test", "literature_test", "statistics_test", "joint_laws_test", "blocks_test", "bridges_test"]
OPERATORS = {"+": "plus", "-": "minus", "*": "times", "/": "over", "<": "less", ">": "more", "<=": "at_most", ">=": "at_least",
             "==": "same", "!=": "other"}
PLACE = re.compile(r"(?<=[\w)\]}]) (\+|-|\*|/|<=|>=|==|!=|<|>) (?=[\w(\-{:])|\bstd::(min|max)\(")
ERROR = re.compile(r"^/?\S*?((?:libs)/\S+?):(\d+):", re.MULTILINE)


def places(text):
    """Where a mutant can be: (start, end, operator), outside of comments, strings, preprocessor lines and declarations that are
    computed when compiling."""
    blank = re.sub(r'//[^\n]*|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'|^#[^\n]*|\b(?:constexpr|static_assert|template|#pragma)[^;{]*[;{]',
                   lambda found: re.sub(r"[^\n]", " ", found[0]), text, flags=re.MULTILINE)
    return [(*(found.span(1) if found[1] else found.span(2)), found[1] or found[2]) for found in PLACE.finditer(blank)]


def mutated(text, chosen):
    """The text with marks; chosen: (number, start, end, operator)."""
    for number, start, end, operator in sorted(chosen, key=lambda one: -one[1]):
        if operator in ("min", "max"):
            head = text[:start].removesuffix("std::")
            text = f"{head}mutant::{operator}<{number}>{text[end:]}"
        else:
            text = f"{text[:start]}{operator} mutant::{OPERATORS[operator]}<{number}> {operator}{text[end:]}"
    return text


class Mutants:
    def __init__(self, campaign):
        self.campaign = campaign
        self.tree = campaign.out / "mutants"
        shutil.rmtree(self.tree, ignore_errors=True)
        ignored = shutil.ignore_patterns("build", "out", ".git", "__pycache__")
        shutil.copytree(ROOT, self.tree, ignore=ignored)
        shutil.copy(pathlib.Path(__file__).with_name("mutant.hpp"), self.tree)
        self.chosen = []  # (number, group, path, start, end, operator)
        for group, (patterns, _) in GROUPS.items():
            found = [(path, *place) for pattern in patterns for path in sorted(ROOT.glob(pattern))
                     for place in places(path.read_text())]
            share = campaign.n // len(GROUPS)
            for path, *place in chance("mutants", campaign.seed, group).sample(found, min(2 * share, len(found))):
                self.chosen.append((len(self.chosen) + 1, group, path.relative_to(ROOT), *place))

    def write(self):
        for path in {path for _, _, path, *_ in self.chosen}:
            text = mutated((ROOT / path).read_text(), [(number, *place) for number, _, its, *place in self.chosen if its == path])
            if (self.tree / path).read_text() != text:
                (self.tree / path).write_text(text)

    def build(self):
        """Leaves out the places that do not compile."""
        configure = ["cmake", "--preset", "test", "-D", "JOINTCREEP_WERROR=OFF", "-D", f"CMAKE_CXX_FLAGS=-include {self.tree}/mutant.hpp"]
        subprocess.run(configure, cwd=self.tree, check=True, stdout=subprocess.DEVNULL)
        while True:
            self.write()
            done = subprocess.run(["cmake", "--build", "--preset", "test", "--", "-k", "0"], cwd=self.tree, capture_output=True, text=True,
                                  check=False)
            if done.returncode == 0:
                return
            # All lines that an error names, as templates are at fault where they are called.
            lines = {(path, int(line)) for path, line in ERROR.findall(done.stdout + done.stderr)}
            kept = []
            for one in self.chosen:
                text = (ROOT / one[2]).read_text()
                if (str(one[2]), text.count("\n", 0, one[3]) + 1) not in lines:
                    kept.append(one)
            if len(kept) == len(self.chosen):
                raise SystemExit("mutants: does not compile:\n" + done.stdout[-3000:] + done.stderr[-3000:])
            print(f"mutants: {len(self.chosen) - len(kept)} places do not compile with a mark", flush=True)
            self.chosen = kept

    def choose(self):
        """So many of each group, of those that compile."""
        share, count = self.campaign.n // len(GROUPS), {}
        for one in self.chosen:
            count[one[1]] = count.get(one[1], 0) + 1
            if count[one[1]] <= share:
                yield one

    def found_by(self, number, group):
        """The test that finds it, or None."""
        environment = dict(os.environ, JOINTCREEP_MUTANT=str(number), RC_PARAMS="seed=1", OMP_NUM_THREADS="1")

        def fails(command, longest=LONGEST):
            def limit():
                resource.setrlimit(resource.RLIMIT_CPU, (longest, longest))
                resource.setrlimit(resource.RLIMIT_AS, (8 << 30, 8 << 30))
            try:
                return subprocess.run(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=6 * longest,
                                      preexec_fn=limit, cwd=self.tree).returncode != 0
            except subprocess.TimeoutExpired:
                return True
        first = GROUPS[group][1]
        for folder in [*first, *(other for other in OTHERS if other not in first)]:
            for program in sorted((self.tree / "build/release/tests" / folder).glob("*_tests")):
                if fails([program]):
                    return f"tests/{folder}"
        for name in WHOLE:
            if fails(["python3", f"tests/pipeline/{name}.py", "build/release/apps", "."], 3 * LONGEST):
                return name
        return None


def body(campaign):
    mutants = Mutants(campaign)
    mutants.build()
    for group in GROUPS:
        if by := mutants.found_by(0, group):
            raise SystemExit(f"mutants: {by} fails without a mutant")
        break
    for number, group, path, start, end, operator in mutants.choose():
        text = (ROOT / path).read_text()
        line = text.count("\n", 0, start) + 1
        by = mutants.found_by(number, group)
        campaign.count(group, "found" if by else "lives", f"{path}:{line} {operator}", by or text.splitlines()[line - 1])


if __name__ == "__main__":
    OUTCOMES = ["found", "lives"]
    Campaign("mutants of", OUTCOMES, OUTCOMES[1:], 200).run(body)
