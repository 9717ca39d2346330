"""The text of a written case: it has the given contents, and its paths lead to the same files."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.interfaces.reports.case_text import move_files, toml
from periph_sim.scene.case.toml_file import read
from tests.scene.runs import TIMING

TEXTS = st.text(st.characters(exclude_categories=["Cs"]), max_size=8)
PLAIN = st.booleans() | st.integers(-(2**63), 2**63 - 1) | st.floats(allow_nan=False, allow_infinity=False) | TEXTS
VALUES = st.recursive(PLAIN, lambda each: st.lists(each, max_size=3) | st.dictionaries(TEXTS, each, max_size=3))


@given(st.dictionaries(TEXTS, VALUES, max_size=4))
def test_the_text_of_any_tree_parses_to_that_tree(tree: dict[str, Any]) -> None:
    assert tomllib.loads(toml(tree)) == tree


@pytest.mark.parametrize("file", sorted(TIMING.glob("*.toml")), ids=lambda file: file.stem)
def test_the_text_of_a_shipped_case_parses_to_that_case(file: Path) -> None:
    _, tree = read(file, "case")
    assert tomllib.loads(toml(tree)) == tree


def test_plain_values_come_before_tables_and_tables_have_one_line_between_them() -> None:
    tree = {"unit": {"dsp": {"firmware": "a.py"}}, "name": "x", "budget": [{"name": "a", "max": 0}]}
    assert toml(tree) == 'name = "x"\n\n[unit.dsp]\nfirmware = "a.py"\n\n[[budget]]\nname = "a"\nmax = 0\n'


@pytest.mark.parametrize("is_relative", [False, True])
def test_only_paths_of_existing_files_are_changed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, is_relative: bool
) -> None:
    for folder in ("one", "two"):
        (tmp_path / folder).mkdir()
    (tmp_path / "one" / "a.py").write_text("")
    tree = {"firmware": "a.py", "about": "b.py", "files": [{"path": "a.py"}]}
    monkeypatch.chdir(tmp_path)
    base = Path() if is_relative else tmp_path
    move_files(tree, base / "one", base / "two")
    assert tree == {"firmware": "../one/a.py", "about": "b.py", "files": [{"path": "../one/a.py"}]}
