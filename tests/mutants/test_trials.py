"""Mutants of a small project: sampling, the tests that reach them, their outcomes, and restored sources."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.mutants import sample
from tests.mutants.equivalents import LIST, arguments
from tests.mutants.reach import Reach, measured
from tests.mutants.runner import Runner
from tests.mutants.sample import Mutant, Room, drawn, every
from tests.mutants.tree import Tree, commit_of, unpack
from tests.mutants.trial import tried

SOURCE = """
TOP = 9

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
from room.code import TOP, clamp, count

@pytest.mark.parametrize("x", [0, 5])
def test_below(x):
    assert clamp(x, 3, 9) == (3 if x < 3 else x)

def test_counts():
    assert count(3) == 0

@pytest.mark.long
def test_above():
    assert clamp(12, 3, TOP) == 9
"""


@pytest.fixture
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A repository with one room of one file, which is changed after its commit."""
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
    for module in ("reach", "runner", "trial"):
        monkeypatch.setattr(f"tests.mutants.{module}.ROOMS", sample.ROOMS)
    return root


@pytest.fixture
def tree(root: Path, tmp_path: Path) -> Tree:
    tree = Tree(tmp_path / "tree")
    unpack(root, commit_of(root), tree.folder)
    return tree


@pytest.fixture
def runner(tree: Tree) -> Iterator[Runner]:
    with Runner(tree, a_test=1) as running:
        yield running


def mutant(tree: Tree, after: str) -> Mutant:
    return next(one for one in every("room/code.py", tree.folder) if one.after == after)


def test_the_same_seed_draws_the_same_lines_each_once(tree: Tree) -> None:
    first, again, other = (drawn(("room",), 4, seed, tree.folder) for seed in (1, 1, 2))
    assert first == again != other
    assert len({one.change.line for one in first}) == 4
    assert len(drawn(("room",), 100, 1, tree.folder)) == 8  # there are 8 lines that can be changed


def test_a_room_without_sources_is_an_error(tree: Tree, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sample.ROOMS, "empty", Room(("gone",), ()))
    with pytest.raises(SystemExit, match="room 'empty': gone: not there"):
        drawn(("empty",), 4, 1, tree.folder)
    monkeypatch.setitem(sample.ROOMS, "moved", Room(("room",), (), without=("room/gone.py",)))
    with pytest.raises(SystemExit, match=r"room 'moved': room, room/gone.py: not there"):
        drawn(("moved",), 4, 1, tree.folder)


def test_files_left_out_are_not_sampled(tree: Tree, monkeypatch: pytest.MonkeyPatch) -> None:
    assert sample.files_of("room", tree.folder) == ["room/__init__.py", "room/code.py"]
    monkeypatch.setitem(sample.ROOMS, "part", Room(("room",), (), without=("room/code.py",)))
    assert sample.files_of("part", tree.folder) == ["room/__init__.py"]


def test_a_missing_commit_is_an_error(root: Path) -> None:
    assert commit_of(root, "HEAD") == commit_of(root)
    with pytest.raises(SystemExit, match="there is no commit 'nowhere'"):
        commit_of(root, "nowhere")


def test_a_mutant_is_in_the_tree_only_inside_its_context(root: Path, tree: Tree) -> None:
    path = tree.folder / "room" / "code.py"
    before = path.stat().st_mtime_ns
    with tree.mutated(mutant(tree, "if x <= low:")):
        assert path.read_text(encoding="utf-8") == SOURCE.replace("x < low", "x <= low")
    assert path.read_text(encoding="utf-8") == SOURCE and path.stat().st_mtime_ns == before
    assert "not committed" in (root / "room" / "code.py").read_text(encoding="utf-8")


@pytest.mark.long
def test_outcomes_of_mutants(tree: Tree, runner: Runner, tmp_path: Path) -> None:
    measured(tree, ("room",), 1).write(tmp_path / "reach.json")
    reach = Reach.read(tmp_path / "reach.json")
    assert reach.tests_of("room/code.py", 5) == ["tests/room/test_code.py::test_below"]
    assert reach.tests_of("room/code.py", 15) == []
    result = {
        after: (trial.outcome, trial.by.rpartition("::")[2], trial.reached)
        for after in (
            "if not (x < low):",
            "return high if x >= high else x",
            "return high if not (x > high) else x",
            "return None",
            "n = n + 1",
            "return 1 - 1",
            "TOP = 10",
        )
        for trial in [tried(mutant(tree, after), runner, reach)]
    }
    assert result == {
        "if not (x < low):": ("killed", "test_below[0]", 1),
        "return high if x >= high else x": ("survived", "", 1),  # equivalent: both branches give the same
        "return high if not (x > high) else x": ("killed", "test_below[5]", 1),
        "return None": ("killed", "test_below[0]", 1),
        "n = n + 1": ("timeout", "test_counts", 1),
        "return 1 - 1": ("survived", "", 0),
        "TOP = 10": ("killed", "test_above", 0),  # is executed at import, outside of all tests
    }
    assert (tree.folder / "room" / "code.py").read_text(encoding="utf-8") == SOURCE


@pytest.mark.long
def test_a_long_test_kills_a_mutant(tree: Tree, runner: Runner) -> None:
    trial = tried(mutant(tree, "return high if not (x > high) else x"), runner, Reach({}))
    assert (trial.outcome, trial.reached) == ("killed", 0)
    (tree.folder / "tests/room/test_code.py").write_text(TESTS.partition("@pytest.mark.long")[0], encoding="utf-8")
    assert tried(mutant(tree, "return high if x >= high else x"), runner, Reach({})).outcome == "survived"


@pytest.mark.long
def test_a_test_that_is_not_in_the_map_kills_a_mutant(tree: Tree, runner: Runner) -> None:
    """The map has only the first row of each table; here a later row of another file runs the line by a helper."""
    helped = "from helper import below\n@pytest.mark.parametrize('x', [0, 5])\ndef test_row(x): below(x)\n"
    helper = "from room import code\ndef below(x): assert code.clamp(x, 3, 9) == max(3, x)\n"
    folder = tree.folder / "tests/room"
    (folder / "helper.py").write_text(helper, encoding="utf-8")
    (folder / "test_table.py").write_text(f"import pytest\n{helped}", encoding="utf-8")
    (folder / "test_code.py").write_text("def test_runs_it(): pass", encoding="utf-8")
    reach = Reach({"room/code.py": {7: ["tests/room/test_code.py::test_runs_it"]}})
    trial = tried(mutant(tree, "return high if not (x > high) else x"), runner, reach)
    assert (trial.outcome, trial.by) == ("killed", "tests/room/test_table.py::test_row[5]")


@pytest.mark.long
@pytest.mark.parametrize("known", [True, False], ids=["found when reach was measured", "found when it kills"])
def test_a_test_that_fails_without_a_mutant_judges_none(
    tree: Tree, runner: Runner, known: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tree.folder / "tests/room/test_code.py"
    broken = "@pytest.mark.parametrize('x', [1, 2])\ndef test_broken(x): assert clamp(1, 0, x) == x - 7 * (x == 2)\n"
    file.write_text(TESTS + broken, encoding="utf-8")
    reach = measured(tree, ("room",), 1) if known else Reach({})
    assert reach.failing == (["tests/room/test_code.py::test_broken[2]"] if known else [])
    assert tried(mutant(tree, "return 1 - 1"), runner, reach).outcome == "survived"
    assert reach.failing == ["tests/room/test_code.py::test_broken[2]"]
    assert capsys.readouterr().out.count("fails without a mutant, so it judges none") == 1
    assert tried(mutant(tree, "return high if not (x > high) else x"), runner, reach).outcome == "killed"


@pytest.mark.long
def test_tests_that_cannot_run_are_an_error(tree: Tree, runner: Runner) -> None:
    (tree.folder / "pyproject.toml").write_text("[tool.pytest.ini_options]\naddopts = '--unknown'", encoding="utf-8")
    with pytest.raises(SystemExit, match="pytest could not run the tests as they are"):
        measured(tree, ("room",), 1)
    with pytest.raises(SystemExit, match="pytest could not run the tests as they are: pytest ended with status 4"):
        tried(mutant(tree, "return 1 - 1"), runner, Reach({}))


@pytest.mark.long
def test_an_endless_run_is_a_timeout_and_its_processes_are_ended(tree: Tree) -> None:
    loops = "import subprocess, sys\ndef test_loops(): subprocess.run([sys.executable, '-c', 'while True: pass'])\n"
    (tree.folder / "tests/room/test_loops.py").write_text(loops, encoding="utf-8")
    with Runner(tree, a_test=60, a_run=3) as runner:
        ran = runner.run("room", ["tests/room/test_loops.py"], [])
        assert (ran.outcome, ran.by) == ("timeout", "3 s of tests")
        assert runner.run("room", ["tests/room/test_code.py"], []).outcome == "survived"


@pytest.mark.long
def test_a_warm_process_that_breaks_down_is_an_error(tree: Tree, runner: Runner, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("tests.mutants.runner.WARM", tree.folder / "gone.py")
    with pytest.raises(SystemExit, match="the warm process of room 'room' broke down"):
        runner.run("room", ["tests/room/test_code.py"], [])


def test_a_file_that_is_in_no_room_is_an_error(tree: Tree) -> None:
    with pytest.raises(SystemExit, match="a file of no room; rooms are room"):
        every("tests/room/test_code.py", tree.folder)


def test_every_equivalent_mutant_has_an_argument_and_its_line_exists() -> None:
    for (file, before, after), why in arguments().items():
        source = (LIST.parents[2] / file).read_text(encoding="utf-8")
        assert before in (line.strip() for line in source.splitlines()), f"{file}: {before}: it is no longer there"
        assert before != after and len(why) > 20


@pytest.mark.long
def test_a_mutant_that_is_not_killed_in_time_survives(tree: Tree, runner: Runner) -> None:
    reach = Reach({"room/code.py": {11: ["tests/room/test_code.py::test_counts"]}})
    endless = mutant(tree, "n = n + 1")
    with Runner(tree, a_test=30) as patient:
        impatient = tried(endless, patient, reach, patience=1)
    assert (impatient.outcome, impatient.by) == ("survived", "")
    assert tried(endless, runner, reach, patience=20).outcome == "timeout"
