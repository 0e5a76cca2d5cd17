"""Mutants: N places of the sources in which an operator, a sign or a bound is changed, one at a time. Do the tests find them?

All are compiled into one build of a copy of the sources, and chosen by an environment variable when a test runs: an operator
becomes two with a mark between them (mutant.hpp). Where that does not compile, the place is left out. First each test runs
without a mutant, and tells which places it reaches and how long it takes. Then the tests that reach a mutant run, the fastest
first, until one fails, ends by a signal or takes far longer than before. Mutants that no test finds are printed: some change
nothing that matters. The tests are the C++ tests, and those of WHOLE, which run the programs; of the subdivision and the
statistics only those of NEAR, as nearly all others come through these places, too. --only laws --target joint_tests --target rock_tests
is a short form: mutants of one group, and the tests of these programs.
"""

import concurrent.futures
import json
import os
import pathlib
import re
import resource
import shutil
import subprocess
import time

from campaign import ROOT, Campaign, chance

GROUPS = {  # sources
    "laws": ["libs/joint/*.hpp", "libs/rock/mohr_coulomb.cpp", "libs/rock/mohr_coulomb.hpp"],
    "convergence criteria": ["libs/mechanics/assembly.cpp", "libs/mechanics/rest.cpp", "libs/mechanics/failure.cpp",
                             "libs/relaxation/relax.cpp", "libs/analysis/guards.cpp"],
    "subdivision": ["libs/blocks/*.cpp"],
    "statistics": ["libs/statistics/*.cpp"],
}
DRAWN_AS = {"convergence criteria": "certificate"}  # the name by which a seed draws places: seeds keep their places
WHOLE = ["figures", "verification", "literature", "statistics", "joint_laws", "blocks", "bridges", "boundaries", "restart"]
NEAR = ("blocks/", "statistics/", "sampling/", "zoning/", "exchange/", "pipeline/figures", "pipeline/statistics", "pipeline/blocks")
LONGEST = 600  # s of the processor, of a test without a mutant
SLOWER = 5  # times as long as without a mutant, and MARGIN, a test may take with one
MARGIN = 10  # s
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
    """The text with marks, its lines numbered as before; chosen: (number, start, end, operator)."""
    for number, start, end, operator in sorted(chosen, key=lambda one: -one[1]):
        if operator in ("min", "max"):
            head = text[:start].removesuffix("std::")
            text = f"{head}mutant::{operator}<{number}>{text[end:]}"
        else:
            text = f"{text[:start]}{operator} mutant::{OPERATORS[operator]}<{number}> {operator}{text[end:]}"
    return f'#include "mutant.hpp"\n#line 1\n{text}' if chosen else text


class Test:
    """A test of the copy: how it is run, how long it takes, the numbers of the mutants that it reaches."""

    def __init__(self, tree, name, command):
        self.tree, self.name, self.command, self.seconds, self.reached = tree, name, command, None, set()

    def fails(self, number, seconds, **variables):
        def limit():
            resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
            resource.setrlimit(resource.RLIMIT_AS, (8 << 30, 8 << 30))
        paths = ":".join(str(self.tree / path) for path in ("pipelines", "pipelines/plots", "tests/pipeline"))
        environment = dict(os.environ, JOINTCREEP_MUTANT=str(number), RC_PARAMS="seed=20030501 noshrink=1", OMP_NUM_THREADS="1",
                           GTEST_FAIL_FAST="1", PYTHONPATH=paths, **variables)
        try:
            return subprocess.run(self.command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=self.tree,
                                  timeout=6 * seconds, preexec_fn=limit, check=False).returncode != 0
        except subprocess.TimeoutExpired:
            return True

    def first_run(self):
        """Without a mutant. Each process adds a file of the places that it came through."""
        seen = self.tree / "seen" / self.name
        seen.mkdir(parents=True)
        begin = time.monotonic()
        if self.fails(0, LONGEST, JOINTCREEP_MUTANTS_SEEN=str(seen)):
            raise SystemExit(f"mutants: {self.name} fails without a mutant")
        self.seconds = time.monotonic() - begin
        self.reached = {int(number) for path in seen.iterdir() for number in path.read_text().split()}


class Mutants:
    def __init__(self, campaign):
        self.campaign = campaign
        self.tree = campaign.out / "mutants"
        shutil.rmtree(self.tree, ignore_errors=True)
        ignored = shutil.ignore_patterns("build", "out", ".git", "__pycache__")
        shutil.copytree(ROOT, self.tree, ignore=ignored)
        shutil.copy(pathlib.Path(__file__).with_name("mutant.hpp"), self.tree / "libs")
        self.chosen = []  # (number, group, path, start, end, operator)
        self.groups = {group: patterns for group, patterns in GROUPS.items() if campaign.options.only in (None, group)}
        share = campaign.n // len(self.groups)
        for group, patterns in self.groups.items():
            found = [(path, *place) for pattern in patterns for path in sorted(ROOT.glob(pattern))
                     for place in places(path.read_text())]
            for path, *place in chance("mutants", campaign.seed, DRAWN_AS.get(group, group)).sample(found, min(2 * share, len(found))):
                self.chosen.append((len(self.chosen) + 1, group, path.relative_to(ROOT), *place))
        # Of the sources, by path: they may change while the campaign runs.
        self.text = {path: (ROOT / path).read_text() for _, _, path, *_ in self.chosen}

    def write(self):
        for path in sorted(self.text):
            text = mutated(self.text[path], [(number, *place) for number, _, its, *place in self.chosen if its == path])
            if (self.tree / path).read_text() != text:
                (self.tree / path).write_text(text)

    def build(self):
        """Leaves out the places that do not compile."""
        configure = ["cmake", "--preset", "test", "-D", "JOINTCREEP_WERROR=OFF"]
        subprocess.run(configure, cwd=self.tree, check=True, stdout=subprocess.DEVNULL)
        while True:
            self.write()
            targets = [word for target in self.campaign.options.target for word in ("--target", target)]
            done = subprocess.run(["cmake", "--build", "--preset", "test", *targets, "--", "-k", "0"], cwd=self.tree, capture_output=True,
                                  text=True, check=False)
            if done.returncode == 0:
                return
            # All lines that an error names, as templates are at fault where they are called.
            lines = {(path, int(line)) for path, line in ERROR.findall(done.stdout + done.stderr)}
            kept = [one for one in self.chosen if (str(one[2]), self.line(one)) not in lines]
            if len(kept) == len(self.chosen):
                raise SystemExit("mutants: does not compile:\n" + done.stdout[-3000:] + done.stderr[-3000:])
            print(f"mutants: {len(self.chosen) - len(kept)} places do not compile with a mark", flush=True)
            self.chosen = kept

    def line(self, one):
        return self.text[one[2]].count("\n", 0, one[3]) + 1

    def choose(self):
        """So many of each group, of those that compile."""
        share, count = self.campaign.n // len(self.groups), {}
        for one in self.chosen:
            count[one[1]] = count.get(one[1], 0) + 1
            if count[one[1]] <= share:
                yield one

    def tests(self):
        """The fastest first."""
        told = subprocess.run(["ctest", "--preset", "test", "--show-only=json-v1"], cwd=self.tree, check=True, capture_output=True).stdout
        tests = [Test(self.tree, test["name"], test["command"]) for test in json.loads(told)["tests"]
                 if "command" in test and (not test["name"].startswith("pipeline/") or test["name"].removeprefix("pipeline/") in WHOLE)]
        if self.campaign.options.target:
            tests = [test for test in tests if pathlib.Path(test.command[0]).name in self.campaign.options.target]
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            for _ in pool.map(Test.first_run, tests):
                pass
        return sorted(tests, key=lambda test: test.seconds)


def found_by(number, group, tests):
    """The name of the first test that finds a mutant, or None."""
    return next((test.name for test in tests if number in test.reached
                 and (group in ("laws", "convergence criteria") or test.name.startswith(NEAR))
                 and test.fails(number, int(SLOWER * test.seconds + MARGIN))), None)


def body(campaign):
    mutants = Mutants(campaign)
    mutants.build()
    tests, chosen = mutants.tests(), list(mutants.choose())
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for one, by in zip(chosen, pool.map(lambda one: found_by(one[0], one[1], tests), chosen)):
            number, group, path, start, _, operator = one
            line, column = mutants.line(one), start - mutants.text[path].rfind("\n", 0, start)
            reaching = sum(number in test.reached for test in tests)
            campaign.count(group, "found" if by else "lives", f"{path}:{line}:{column} {operator}",
                           by or f"{mutants.text[path].splitlines()[line - 1].strip()} (mutant {number}, reached by {reaching} tests)")


def options(parser):
    parser.add_argument("--only", choices=GROUPS, help="mutants of this group")
    parser.add_argument("--target", action="append", default=[], help="build and use the tests of this program; can be given several times")


if __name__ == "__main__":
    OUTCOMES = ["found", "lives"]
    Campaign("mutants of", OUTCOMES, OUTCOMES[1:], 200, options).run(body)
