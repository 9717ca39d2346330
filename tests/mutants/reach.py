"""Map from lines to the tests that reach them, from a run of the tests under coverage.

    pytest -m "not long" --cov --cov-context=test --> .coverage --> {file: {line: [test, ...]}}
                          failures --> failing

Tests are named without their parameters, because those of one function reach nearly the same lines. Tests marked `long`
are not in the map. A test that fails without a mutant judges no mutant: it is left out and reported.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections import Counter
from pathlib import Path

from coverage import CoverageData

from .sample import ROOMS
from .tree import Tree

Lines = dict[int, list[str]]
FAILED = re.compile(r"^(?:FAILED|ERROR) (\S+?::.+?|\S+?)(?: - .*)?$", re.MULTILINE)
ORDINARY = (0, 1, 5)  # exit statuses of pytest: all passed, some failed, none collected


class Reach:
    """The tests that reach each line of each file, and those known to fail or pass without a mutant, with parameters.

    The most specific tests, which reach the fewest lines, are first.
    """

    def __init__(self, lines: dict[str, Lines], failing: list[str] | None = None) -> None:
        self.failing: list[str] = []
        self.passing: set[str] = set()
        for test in failing or []:
            self.fails(test)
        self._lines = lines
        self._weight = Counter(test for tests in lines.values() for each in tests.values() for test in each)

    def tests_of(self, path: str, line: int) -> list[str]:
        """Return the tests that run this line of a file."""
        return sorted(self._lines.get(path, {}).get(line, []), key=lambda test: (self._weight[test], test))

    def fails(self, test: str) -> None:
        print(f"fails without a mutant, so it judges none: {test}", flush=True)
        self.failing.append(test)

    @classmethod
    def read(cls, path: Path) -> Reach:
        contents = json.loads(path.read_text(encoding="utf-8"))
        lines = {name: {int(line): tests for line, tests in each.items()} for name, each in contents["lines"].items()}
        return cls(lines, contents["failing"])

    def write(self, path: Path) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps({"lines": self._lines, "failing": self.failing}), encoding="utf-8")


def measured(tree: Tree, rooms: tuple[str, ...], workers: int) -> Reach:
    """Run the short tests of the rooms without a mutant, under coverage. Raise SystemExit if pytest cannot run them."""
    folders = sorted({folder for room in rooms for folder in (*ROOMS[room].tests, *ROOMS[room].also)})
    command = [sys.executable, "-m", "pytest", "-q", "-m", "not long", "-n", str(workers), "-p", "no:cacheprovider"]
    command += ["--cov", "--cov-context=test", "--cov-report=", "--cov-fail-under=0", *folders]
    ran = subprocess.run(command, cwd=tree.folder, env=tree.environment(), capture_output=True, text=True, check=False)
    if ran.returncode not in ORDINARY:
        raise SystemExit(f"pytest could not run the tests as they are:\n{ran.stdout[-3000:]}{ran.stderr[-2000:]}")
    return Reach(contexts(tree.folder / ".coverage", tree.folder), sorted({*FAILED.findall(ran.stdout)}))


def contexts(data_file: Path, root: Path) -> dict[str, Lines]:
    """Read coverage's data: context "tests/x.py::test_y[3]|run" of a line is test "tests/x.py::test_y"."""
    data = CoverageData(str(data_file))
    data.read()
    found: dict[str, Lines] = {}
    for name in data.measured_files():
        lines: Lines = {}
        for line, reached in data.contexts_by_lineno(name).items():
            tests = {context.partition("|")[0].partition("[")[0] for context in reached if context}
            if tests:
                lines[line] = sorted(tests)
        if lines:
            found[str(Path(name).resolve().relative_to(root.resolve()))] = lines
    return found
