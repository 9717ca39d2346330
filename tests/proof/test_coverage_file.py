"""Coverage files: they are read as they were written, and name only files that a result depends on."""

from __future__ import annotations

import sys
from pathlib import Path
from types import ModuleType

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.proof.cover import Drifting, Window, nothing
from periph_sim.proof.coverage_file import Choice, CoverageFile, from_ranges, to_ranges
from periph_sim.proof.dependencies import Dependencies, dependencies
from periph_sim.proof.saved_file import text_of


def a_file(failures: list[str]) -> CoverageFile:
    found = nothing()
    found.failed = {12: frozenset(failures), 7: frozenset()}
    found.drifting = [Drifting(frozenset(failures), 3, 5)]
    return CoverageFile(
        case="small",
        choice=Choice(
            moved="frames",
            start_up=False,
            count=100,
            cycle_ps=6666.666666666667,
            chosen=3,
            near=0,
            step=1,
            rounds=3,
            bounds=(3, 12),
            digest="00",
        ),
        dependencies=Dependencies("3.11", "0", {}, {"small.toml": "1"}),
        finished=1,
        parts=1,
        run_count=3,
        held=[(0, 1)],
        found=found,
        windows=[Window("response", 12, 12, 1, True)],
    )


def test_a_file_with_failures_is_read_as_it_was_written_and_has_one_text(tmp_path: Path):
    names = ["stuck", "response", "data age"]
    (tmp_path / "one.json").write_text(text_of(a_file(names)), encoding="utf-8")
    assert CoverageFile.read(tmp_path / "one.json") == a_file(names)
    assert text_of(a_file(names)) == text_of(a_file(names[::-1]))
    assert text_of(a_file(names)).index('"data age"') < text_of(a_file(names)).index('"response"')


@given(st.sets(st.integers(0, 30)), st.sets(st.integers(0, 30)))
def test_ranges_of_phases_have_the_chosen_phases_that_held(held: set[int], chosen: set[int]):
    """A coverage that is continued begins with these phases."""
    assert from_ranges(to_ranges(sorted(held), sorted(chosen)), sorted(chosen)) == sorted(held & chosen)


def test_the_running_command_is_not_a_dependency(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """In worker processes the module `__main__` also has another name."""
    for name in ("__main__", "__mp_main__", "mine"):
        (tmp_path / f"{name}.py").touch()
        module = ModuleType(name)
        module.__file__ = str(tmp_path / f"{name}.py")
        monkeypatch.setitem(sys.modules, name, module)
    files = dependencies(tmp_path, []).files
    assert [file for file in files if ".." not in file] == ["mine.py"]
