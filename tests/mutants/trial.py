"""Trial of one mutant with the tests that reach it: killed, killed by timeout, or survived.

a few tests that run the line --> its namesake --> the others that run it --> files that import it --> all files
         | one fails                 | one fails       | one fails              | one fails           |       | pass
         +----> killed <-------------+-----------------+----------------------+---------------------+    survived
                                                                          at a time limit: timeout, counted separately

The namesake is the test file named after the mutated one. Files are run whole, long tests included. The last step runs
the files with a short test that runs the line, then the folders of the room in the order of its entry, the quickest
first: coverage counts no long tests and only the first row of a table of parameters, so its map misses tests. A test
that killed a mutant must pass without it in the same process; one that fails judges none and is reported.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

from .reach import Reach
from .runner import Outcome, Ran, Runner
from .sample import ROOMS, Mutant

NEAREST = 6  # number of tests that run before the others are collected


@dataclass(frozen=True)
class Trial:
    """Result of a trial. by: the failed test, or another reason. reached: number of test functions that run the line.

    cpu: seconds of processor time. seconds: wall time.
    """

    mutant: Mutant
    outcome: Outcome
    by: str
    reached: int
    cpu: float
    seconds: float


def tried(mutant: Mutant, runner: Runner, reach: Reach, patience: float = 3600) -> Trial:
    """Try a mutant for `patience` seconds of processor time, after which it has survived."""
    begin = perf_counter()
    near = reach.tests_of(mutant.path, mutant.change.line)
    ran, cpu = Ran("survived"), 0.0
    named, importing = _own_files(mutant, runner.tree.folder)
    own = ROOMS[mutant.room].tests
    files = sorted({test.partition("::")[0] for test in near if test.startswith(own)})
    for tests in (near[:NEAREST], named, near[NEAREST:], importing, files, *([folder] for folder in own)):
        if tests and ran.outcome == "survived" and cpu < patience:
            ran = _ran(mutant, runner, reach, tests, patience - cpu)
            cpu += ran.cpu
    return Trial(mutant, ran.outcome, ran.by, len(near), cpu, perf_counter() - begin)


def _own_files(mutant: Mutant, root: Path) -> tuple[list[str], list[str]]:
    """Return the test files named after the mutated one, and the others that import it."""
    module = Path(mutant.path).with_suffix("")
    package, name = ".".join(module.parent.parts), re.escape(module.name)
    imports = re.compile(rf"^from {re.escape(package)}(\.{name} import| import .*\b{name}\b)", re.MULTILINE)
    files = [path for folder in ROOMS[mutant.room].tests for path in sorted((root / folder).rglob("test_*.py"))]
    named = [path for path in files if path.stem == f"test_{module.name}"]
    importing = [path for path in files if path not in named and imports.search(path.read_text(encoding="utf-8"))]
    return [str(path.relative_to(root)) for path in named], [str(path.relative_to(root)) for path in importing]


def _ran(mutant: Mutant, runner: Runner, reach: Reach, tests: list[str], patience: float) -> Ran:
    """Run tests that pass without the mutant; those that fail without it are left out of all later runs."""
    while True:
        with runner.tree.mutated(mutant):
            ran = runner.run(mutant.room, tests, reach.failing, patience)
        if ran.outcome == "survived" or ran.by in reach.passing:
            return ran
        one = "::" in ran.by
        as_it_is = runner.run(mutant.room, [ran.by] if one else ["--collect-only", *tests], [])
        if as_it_is.outcome == "survived":
            reach.passing |= {ran.by} if one else set()
            return ran
        if not one:
            raise SystemExit(f"pytest could not run the tests as they are: {as_it_is.by}")
        reach.fails(ran.by)
