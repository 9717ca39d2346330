"""Run the tests that a change reaches: the test files that import a file that differs from a commit.

    git diff, git status --> files --> modules --importers, at any distance--> tests, nearest first

    python -m tests.touched [COMMIT] [pytest arguments ...]     COMMIT: main if none is given

import-linter's grimp reads the imports from the sources. A module without importers is loaded by its package, which
searches a folder (lints, formats, commands), so it counts as imported by it; a conftest.py counts as imported by the
tests beside and below it. A file that is no module (a case, a trace, a page) counts as used by every test file that
names it, and so does firmware, which cases load by path. Pages and pictures, whose commands use everything, are left
to `make test`, unless one of them changed.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from functools import cache
from pathlib import Path

import grimp
import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = ("periph_sim", "firmware", "tests")
FOUND_BY = dict.fromkeys(
    ("periph_sim.interfaces.commands", "periph_sim.imu.commands"), "periph_sim.cli"
)  # other modules are found by their package
WHOLE_PAGES = ("tests/docs/test_pages.py", "tests/docs/test_pictures.py")
PAGES = (".md", ".svg", ".png")


def changed_files(commit: str) -> list[Path]:
    """Return the files that differ from a commit, in the work tree or untracked, relative to the repository."""
    differs = _git("diff", "--name-only", "--merge-base", commit)
    new = _git("ls-files", "--others", "--exclude-standard")
    return [Path(line) for line in sorted({*differs, *new})]


def _git(*arguments: str) -> list[str]:
    done = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(done.stderr.strip())
    return done.stdout.splitlines()


def touched(changed: Sequence[Path]) -> list[Path]:
    """Return the test files that these files reach, those at the least distance first."""
    graph = _graph()
    all_tests = {path.relative_to(ROOT): module_of(path.relative_to(ROOT)) for path in ROOT.glob("tests/**/test_*.py")}
    distances: dict[Path, int] = {}

    def reached(file: Path, distance: int) -> None:
        distances[file] = min(distance, distances.get(file, distance))

    for path in changed:
        nearest = _distances(graph, module_of(path)) if path.suffix == ".py" else {}
        fixtures = {module.rpartition(".")[0]: far for module, far in nearest.items() if module.endswith(".conftest")}
        if path != Path("tests/conftest.py"):
            fixtures.pop("tests", None)  # it formats differing diagrams, which changes no outcome
        word = path.name if path.suffix in PAGES else path.stem
        for file, module in all_tests.items():
            if module in nearest:
                reached(file, nearest[module])
            for folder, far in fixtures.items():
                if module.startswith(f"{folder}."):
                    reached(file, far + 1)
            if _is_data(path) and word in (ROOT / file).read_text(encoding="utf-8"):
                reached(file, 1)
    for name in WHOLE_PAGES:
        distances.pop(Path(name), None)
        if any(path.suffix in PAGES or path == Path(name) for path in changed):
            distances[Path(name)] = 1
    return sorted(distances, key=lambda file: (distances[file], file))


@cache
def _graph() -> grimp.ImportGraph:
    return grimp.build_graph(*PACKAGES, cache_dir=None)


def module_of(path: Path) -> str:
    """Return the name of the module of a file, such as "periph_sim.core.wire"."""
    parts = path.with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _is_data(path: Path) -> bool:
    return path.suffix != ".py" or path.parts[0] == "firmware"


def _distances(graph: grimp.ImportGraph, changed: str) -> dict[str, int]:
    """Return the number of imports between each module and the changed one, which has 0."""
    found = {changed: 0} if changed in graph.modules else {}
    edge = list(found)
    while edge:
        following = []
        for module in edge:
            importers = graph.find_modules_that_directly_import(module)
            package = module.rpartition(".")[0]
            if not any(importer.startswith("periph_sim.") for importer in importers) and "." in package:
                importers = {*importers, FOUND_BY.get(package, package)}
            for importer in sorted(importers - found.keys()):
                found[importer] = found[module] + 1
                following.append(importer)
        edge = following
    return found


def main(arguments: list[str]) -> int:
    commit = arguments[0] if arguments and not arguments[0].startswith("-") else "main"
    changed = changed_files(commit)
    files = touched(changed)
    print(f"{len(changed)} files differ from {commit}; these reach {len(files)} test files", flush=True)
    if not files:
        return 0
    return int(pytest.main([*map(str, files), *arguments[arguments[:1] == [commit] :]]))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
