"""Mutants of a small project: which are drawn, which tests reach them, what becomes of them, and that they go away."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from tests.mutants import sample
from tests.mutants.equivalents import LIST, arguments
from tests.mutants.reach import Reach, measured
from tests.mutants.sample import Mutant, Room, drawn, mutants_of
from tests.mutants.tree import Tree, commit_of, unpack
from tests.mutants.trial import tried

SOURCE = """
def clamp(x, low, high):
    if x < low:
        return low
    return high if x > high else x

def count(n):
    while n > 0:
        n = n - 1
    return n

def never():
    return 1 + 1
"""
TESTS = """
import pytest
from room.code import clamp, count

@pytest.mark.parametrize("x", [0, 5])
def test_below(x):
    assert clamp(x, 3, 9) == (3 if x < 3 else x)

def test_counts():
    assert count(3) == 0

@pytest.mark.long
def test_above():
    assert clamp(12, 3, 9) == 9
"""


@pytest.fixture
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A repository of a room with one file; changed after its commit."""
    root = tmp_path / "project"
    for path, text in {
        "room/__init__.py": "",
        "room/code.py": SOURCE,
        "tests/room/test_code.py": TESTS,
        "pyproject.toml": '[tool.pytest.ini_options]\nmarkers = ["long"]\n[tool.coverage.run]\nsource = ["room"]\n',
    }.items():
        (root / path).parent.mkdir(parents=True, exist_ok=True)
        (root / path).write_text(text, encoding="utf-8")
    for command in ("init -q", "add -A", "-c user.name=a -c user.email=a@b.c commit -q -m one"):
        subprocess.run(["git", *command.split()], cwd=root, check=True)
    (root / "room" / "code.py").write_text("raise ValueError('not committed')", encoding="utf-8")
    monkeypatch.setattr(sample, "ROOMS", {"room": Room(("room",), ("tests/room",))})
    for module in ("reach", "trial"):
        monkeypatch.setattr(f"tests.mutants.{module}.ROOMS", sample.ROOMS)
    return root


@pytest.fixture
def tree(root: Path, tmp_path: Path) -> Tree:
    tree = Tree(tmp_path / "tree")
    unpack(root, commit_of(root), tree.folder)
    return tree


def mutant(tree: Tree, after: str) -> Mutant:
    every = [one for line in mutants_of("room", "room/code.py", tree.folder) for one in line]
    return next(one for one in every if one.after == after)


def test_the_same_seed_draws_the_same_lines_each_once(tree: Tree) -> None:
    first, again, other = (drawn(("room",), 4, seed, tree.folder) for seed in (1, 1, 2))
    assert first == again != other
    assert len({one.change.line for one in first}) == 4
    assert len(drawn(("room",), 100, 1, tree.folder)) == 7  # lines that can be changed


def test_a_room_without_sources_is_no_pass(tree: Tree, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sample.ROOMS, "empty", Room(("gone",), ()))
    with pytest.raises(SystemExit, match="room 'empty': no sources in gone"):
        drawn(("empty",), 4, 1, tree.folder)


def test_a_commit_that_is_not_there(root: Path) -> None:
    assert commit_of(root, "HEAD") == commit_of(root)
    with pytest.raises(SystemExit, match="there is no commit 'nowhere'"):
        commit_of(root, "nowhere")


def test_a_mutant_stands_in_the_committed_tree_for_a_while(root: Path, tree: Tree) -> None:
    path = tree.folder / "room" / "code.py"
    before = path.stat().st_mtime_ns
    with tree.mutated(mutant(tree, "if x <= low:")):
        assert path.read_text(encoding="utf-8") == SOURCE.replace("x < low", "x <= low")
    assert path.read_text(encoding="utf-8") == SOURCE and path.stat().st_mtime_ns == before
    assert "not committed" in (root / "room" / "code.py").read_text(encoding="utf-8")


@pytest.mark.long
def test_what_becomes_of_mutants(tree: Tree, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tests.mutants.trial.SECONDS_A_TEST", 1)
    measured(tree, ("room",), 1).write(tmp_path / "reach.json")
    reach = Reach.read(tmp_path / "reach.json")
    assert reach.tests_of("room/code.py", 3) == ["tests/room/test_code.py::test_below"]
    assert reach.tests_of("room/code.py", 12 + 1) == []
    came = {
        after: (trial.outcome, trial.reached)
        for after in (
            "if not (x < low):",
            "return high if x >= high else x",
            "return high if not (x > high) else x",
            "return None",
            "n = n + 1",
            "return 1 - 1",
        )
        for trial in [tried(mutant(tree, after), tree, reach)]
    }
    assert came == {
        "if not (x < low):": ("killed", 1),
        "return high if x >= high else x": ("survived", 1),  # an equivalent: both sides are the same there
        "return high if not (x > high) else x": ("killed", 1),
        "return None": ("killed", 1),
        "n = n + 1": ("timeout", 1),
        "return 1 - 1": ("survived", 0),
    }


@pytest.mark.long
def test_only_a_long_test_kills_this_one(tree: Tree) -> None:
    trial = tried(mutant(tree, "return high if not (x > high) else x"), tree, Reach({}))
    assert (trial.outcome, trial.reached) == ("killed", 0)
    (tree.folder / "tests/room/test_code.py").write_text(TESTS.partition("@pytest.mark.long")[0], encoding="utf-8")
    assert tried(mutant(tree, "return high if x >= high else x"), tree, Reach({})).outcome == "survived"


@pytest.mark.long
def test_what_fails_as_it_is_judges_no_mutant(tree: Tree) -> None:
    file = tree.folder / "tests/room/test_code.py"
    broken = "@pytest.mark.parametrize('x', [1, 2])\ndef test_broken(x): assert clamp(1, 0, x) == x - 7 * (x == 2)\n"
    file.write_text(TESTS + broken, encoding="utf-8")
    reach = measured(tree, ("room",), 1)
    assert reach.failing == ["tests/room/test_code.py::test_broken[2]"]
    assert tried(mutant(tree, "return 1 - 1"), tree, reach).outcome == "survived"
    assert tried(mutant(tree, "return high if not (x > high) else x"), tree, reach).outcome == "killed"


@pytest.mark.long
def test_tests_that_cannot_run_end_it(tree: Tree) -> None:
    (tree.folder / "pyproject.toml").write_text("[tool.pytest.ini_options]\naddopts = '--unknown'", encoding="utf-8")
    with pytest.raises(SystemExit, match="pytest could not run the tests as they are"):
        measured(tree, ("room",), 1)


def test_every_equivalent_is_argued_and_its_line_is_there() -> None:
    for (file, before, after), why in arguments().items():
        source = (LIST.parents[2] / file).read_text(encoding="utf-8")
        assert before in (line.strip() for line in source.splitlines()), f"{file}: {before}: it is no longer there"
        assert before != after and len(why) > 20
